"""A motion shows where the axles of a vehicle are, and the picture draws them there."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.solve.animation import animate
from coadjoint.solve.plot import draw
from coadjoint.solve.vehicles import find_vehicle
from coadjoint.systems import roller_racer

TIME = np.linspace(0.0, 6.0, 601)


class Motion(dict):
    """What `find_vehicle` reads of a solution, with rows by name."""

    batch, reconstructed = (), np.zeros(1)

    def __init__(self, **rows):
        super().__init__(rows)
        scalar = {name: SimpleNamespace(unit="m", shape=()) for name in ("x", "y")}
        scalar["theta"] = SimpleNamespace(unit="1", shape=())
        state = {"phi": SimpleNamespace(unit="1", shape=())} if "phi" in rows else {}
        self.time = TIME
        self.system = SimpleNamespace(RECONSTRUCTED=scalar, STATE=state)

    def __len__(self):
        return len(TIME)


def car(ahead=0.0, skid=0.0):
    """A rear axle along (t, sin t), seen from a point ahead of it; with a skid it slides."""
    theta = np.arctan(np.cos(TIME)) + skid * np.sin(3 * TIME)
    x, y = TIME + ahead * np.cos(theta), np.sin(TIME) + ahead * np.sin(theta)
    return Motion(x=x, y=y, theta=theta)


@pytest.mark.parametrize("ahead", [0.0, 0.7, -0.4])
def test_an_axle_is_found_where_nothing_moves_sideways(ahead):
    """It is behind the point whose place is known, by as much as that is ahead of it."""
    found = find_vehicle(car(ahead))
    assert abs(found.wheel + ahead) < 1e-4
    assert found.trailers == ()


def test_a_body_that_slides_has_no_axle():
    """The condition holds nowhere on it; a fit by least squares alone would find a place."""
    assert find_vehicle(car(0.7, skid=0.2)) is None


def test_a_body_that_runs_straight_has_no_axle():
    """Each of its points moves straight ahead."""
    assert find_vehicle(Motion(x=TIME, y=0 * TIME, theta=0 * TIME)) is None


def test_joint_and_trailer_of_the_roller_racer_are_found():
    """By their lengths in the spec, d1 = 1 m and d2 = 0.2 m, and by others that are set."""
    for lengths in ((1.0, 0.2), (0.8, 0.3)):
        parameters = [1.0, 0.2, 1.0, 0.1, *lengths]
        solution = roller_racer.simulate(
            None, (0.0, 5.0), parameters, samples=801, reconstruct=True, progress=False
        )
        found = find_vehicle(solution)
        assert abs(found.wheel) < 1e-3
        (trailer,) = found.trailers
        np.testing.assert_allclose([trailer.joint, trailer.length], lengths, rtol=1e-3)


def test_the_vehicle_is_drawn_and_moves(tmp_path):
    """Its lines are at its place in the picture, and at another one later in the film."""
    solution = roller_racer.simulate(
        None, (0.0, 2.0), samples=201, reconstruct=True, progress=False
    )
    figure = draw(solution)
    (axes,) = (each for each in figure.axes if hasattr(each, "coadjoint_body"))
    vehicle, last = find_vehicle(solution), axes.lines[-1]
    for at in (0, 200):
        axes.coadjoint_body(at)
        *_, expected = vehicle.list_lines(at)
        np.testing.assert_allclose(last.get_xydata().T, expected)
    animate(solution, tmp_path / "racer.gif", seconds=0.2)
    assert (tmp_path / "racer.gif").stat().st_size > 1000
