"""Runs of bodies that touch surfaces begin in contact, and are kept there."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from tests.contacts import BALL_INSIDE
from tests.rolling import built

#: omega, c, X.
START = np.array([0, 1.0, 5, 2, 0, 0, 3, 0, 0])


def test_a_ball_in_a_cylinder_swings_as_the_closed_form():
    """The height swings about z_c with nu^2 = (2/7) phi'^2; it stays in contact to roundings."""
    ball, times = built(BALL_INSIDE), np.linspace(0, 20, 41)
    run = ball.simulate(START, t=times, rtol=1e-9, atol=1e-11)
    turn = -5 / 2
    nu, centre = 2.5 * np.sqrt(2 / 7), -9.81 / (0.4 * turn**2)
    z = centre * (1 - np.cos(nu * times)) + np.sin(nu * times) / nu
    np.testing.assert_allclose(run["c"][2], z, atol=1e-6)
    left = ball.constraint_residual(run.state, run.parameters, target="numpy")[3:]
    assert np.abs(left).max() < 1e-13  # without the projection 1e-9


@pytest.mark.parametrize(
    ("moved", "constraint"),
    [({6: 2.9}, "constraint 4"), ({3: 1.9}, "constraint 5")],
    ids=["off the surface", "a centre too close"],
)
def test_surfaces_that_do_not_touch_are_no_start(moved, constraint):
    """What does not hold is said, with a state in contact near by."""
    state = START.copy()
    for place, value in moved.items():
        state[place] = value
    with pytest.raises(KernelArgumentError, match=constraint) as caught:
        built(BALL_INSIDE).simulate(state, t=(0, 1))
    text = str(caught.value)
    assert "does not hold at the given state" in text
    nearest = dict(
        part.split(" = ") for part in text.split("has ")[-1].split(": begin")[0].split(", ")
    )
    assert float(nearest.get("X1", 3)) == pytest.approx(3, abs=1e-11)
    assert float(nearest.get("c1", 2)) == pytest.approx(2, abs=1e-11)


def test_a_ball_larger_than_the_cylinder_is_no_start():
    """Its curvature is less than that of the cylinder: the surfaces cross."""
    state = START.copy()
    state[3] = 3 - 4
    ball = built(BALL_INSIDE)
    with pytest.raises(KernelArgumentError, match=r"rolling_(apart|outside)") as caught:
        ball.simulate(state, t=(0, 1), parameters={"r": 4.0})
    text = str(caught.value)
    assert "the body is too large for the surface at the point of contact" in text
    assert "a ball whose radius is less than the radii of curvature" in text
    advised = START.copy()
    advised[3] = 3 - 2.9  # a radius below that of the cylinder, 3
    assert ball.simulate(advised, t=(0, 0.1), parameters={"r": 2.9}).status == "OK"
