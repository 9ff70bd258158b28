"""Bodies that slide: the tippe top by closed forms, its attitude by another integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from coadjoint.solve.rolling_bodies import find_rolling
from coadjoint.systems import tippe_top

RADIUS, EXCESS = 1.0, 0.2


def slide(samples=801, end=20.0):
    """The top from its default start, which spins fast."""
    return tippe_top.simulate(None, (0, end), samples=samples, progress=False)


@pytest.fixture(scope="module")
def motion():
    """Over the time in which it turns over."""
    return slide()


@pytest.fixture(scope="module")
def top(motion):
    """Its body."""
    return find_rolling(motion)


def check_touches(body):
    """In each frame the contact is on the plane and on the ball, which is its radius high.

    The centre of the ball is e along the axis of symmetry from the centre of mass.
    """
    ball = body.centre + EXCESS * body.turned[:, 2]
    np.testing.assert_allclose(ball[2], RADIUS, atol=1e-9)
    np.testing.assert_array_equal(body.contact[2], 0.0)
    np.testing.assert_allclose(np.linalg.norm(ball - body.contact, axis=0), RADIUS, atol=1e-9)
    np.testing.assert_allclose(ball[:2], body.contact[:2], atol=1e-9)


def test_the_contact_is_on_the_plane_and_on_the_ball_in_each_frame(top):
    """And the surface is the ball."""
    assert top.contact.shape == (3, 801)
    assert top.unit == "m"
    check_touches(top)
    surface = top.surface[:, 1:-1] - np.array([0, 0, EXCESS])[:, None, None]
    np.testing.assert_allclose(np.linalg.norm(surface, axis=0), RADIUS, atol=1e-12)


def test_a_contact_beside_the_ball_is_seen(top):
    """The check above can fail."""
    top.contact[0, 400] += 1e-6
    with pytest.raises(AssertionError):
        check_touches(top)
    top.contact[0, 400] -= 1e-6


def test_the_top_turns_over_and_sleeps(motion, top):
    """The centre of mass rises from r - e to r + e; at the end it spins about the vertical.

    What is left of the horizontal part of the spin is that of a ball which rolls straight on.
    """
    assert top.centre[2, 0] < RADIUS - 0.99 * EXCESS
    assert top.centre[2, -1] > RADIUS + 0.99 * EXCESS
    np.testing.assert_allclose(top.turned[:, :, 0] @ motion["Gamma"][:, 0], [0, 0, 1], atol=1e-9)
    spin = top.turned[:, :, -1] @ motion["Omega"][:, -1]
    assert spin[2] > 10
    assert np.hypot(*spin[:2]) < 0.06 * spin[2]
    last = np.diff(top.contact[:, -40:], axis=1) / np.diff(motion.time)[0]
    assert np.linalg.norm(last - last.mean(axis=1, keepdims=True), axis=0).max() < 0.05
    np.testing.assert_allclose(last.mean(axis=1), RADIUS * np.cross(spin, [0, 0, 1]), atol=0.05)


def test_the_attitude_is_that_of_another_integration(motion, top):
    """With q' = q (0, Omega)/2 beside the state, by SciPy at tight tolerances."""

    def rates(_, x):
        change = tippe_top.rhs(x[:9], target="numpy")
        q, omega = Rotation.from_quat(x[9:13]), x[:3]
        w, v = x[12], x[9:12]
        turned = [*(w * omega + np.cross(v, omega)) / 2, -v @ omega / 2]
        return [*change, *turned, *q.apply(x[3:6])]

    first = Rotation.from_matrix(top.turned[:, :, 0]).as_quat()
    start = [*motion.state[:, 0], *first, *top.centre[:, 0]]
    times = motion.time[[0, 40, 120]]
    found = solve_ivp(rates, (0, times[-1]), start, "DOP853", times, rtol=1e-10, atol=1e-10).y
    for n, at in enumerate((0, 40, 120)):
        pose = Rotation.from_quat(found[9:13, n]).as_matrix()
        np.testing.assert_allclose(top.turned[:, :, at], pose, atol=2e-3)
        np.testing.assert_allclose(top.centre[2, at], found[15, n], atol=1e-8)
        np.testing.assert_allclose(top.centre[:2, at], found[13:15, n], atol=2e-3)


def test_too_few_samples_are_no_body():
    """Between them it turns farther than is told by what is known there."""
    assert find_rolling(slide(samples=101)) is None


def test_a_slip_that_leaves_the_plane_is_no_body(motion):
    """As where a motion does not keep its constraint."""
    other = slide(samples=401, end=2.0)
    assert find_rolling(other) is not None
    rows = tippe_top.system.STATE.rows
    other.state[rows("Y")] += 1e-3 * other.state[rows("Gamma")]
    assert find_rolling(other) is None
