"""Paths between samples: lengths of closed form, also where the point turns back at a cusp."""

from __future__ import annotations

import math

import numpy as np
import pytest

from coadjoint.declared import KernelContext, Quantity
from coadjoint.solve.paths import Path
from coadjoint.solve.solution import Solution
from coadjoint.systems import rolling_disk_vertical
from tests.programs import program
from tests.solve.systems import build


def roll(name, state, rhs, observables):
    """A point on the rim of a wheel of radius 1 that rolls with the angle phi = t."""
    shown = tuple(Quantity(each, (), "m", (each,)) for each, _ in observables)
    texts = "; ".join(text for _, text in observables)
    names = tuple(state.split())
    return KernelContext(
        name=name,
        spec=f"derivations/{name}.toml",
        license="",
        routes=("Typed by hand.",),
        equations=("dphi/dt = 1",),
        state=tuple(Quantity(each, (), "m", (each,)) for each in names),
        parameters=(),
        observables=shown,
        programs=(
            program("rhs", state, "", "", rhs, (len(names),)),
            program("observables", state, "", "", texts, (len(shown),)),
        ),
    )


#: x and y in the state, and as observables of the angle alone.
INTEGRATED = roll("wheel", "x y phi", "1 - cos(phi); sin(phi); 1", [("size", "phi")])
OBSERVED = roll("angle", "phi", "1", [("x", "phi - sin(phi)"), ("y", "1 - cos(phi)")])


@pytest.fixture(params=[INTEGRATED, OBSERVED], ids=lambda context: context.name)
def cycloid(request, tmp_path):
    """Three turns of the wheel, sampled so that the cusps fall between samples."""
    system = build(request.param, tmp_path)
    start = np.zeros(system.STATE.size)
    return system.simulate(start, (0, 6 * math.pi), samples=14, target="numpy")


def chords(solution):
    """The length of the polygon through the samples."""
    return float(np.hypot(np.diff(solution["x"]), np.diff(solution["y"])).sum())


def test_a_cycloid_is_8_radii_long(cycloid):
    """For each turn; the polygon through the samples is too short by more than 1 percent."""
    way = Path(cycloid)
    assert way.find_length() == pytest.approx(24, rel=1e-5)
    assert way.is_close
    assert chords(cycloid) < 0.99 * 24


def test_the_curve_reaches_the_cusps_and_the_tops(cycloid):
    """Points lie on the cycloid: y = 1 - cos(phi) at x = phi - sin(phi), with no straight spike."""
    x, y = Path(cycloid).find_points()
    angle = np.linspace(0, 6 * math.pi, len(x))
    np.testing.assert_allclose(x, angle - np.sin(angle), atol=1e-5)
    np.testing.assert_allclose(y, 1 - np.cos(angle), atol=1e-5)
    assert len(x) > len(cycloid)


def test_a_disk_that_rolls_on_a_circle_goes_radius_times_angle():
    """2 m/s for 10 s, of a radius of 1 m and a rate of 2/s: 20 m, from 11 samples."""
    found = rolling_disk_vertical.simulate([0, 0, 0, 0, 2, 1], (0, 10), samples=11, target="numpy")
    assert Path(found).find_length() == pytest.approx(20, rel=1e-7)
    assert chords(found) < 19.2


def test_members_have_lengths_of_their_own():
    """A batch of two axes: speeds 1 to 6; a member that has ended counts as far as it came."""
    speeds = np.arange(1.0, 7.0).reshape(3, 2)
    time = np.linspace(0, 2, 5)
    ones, turned = np.ones((3, 2, 5)), np.multiply.outer(speeds, time)
    state = np.stack([turned, 0 * ones, turned, 0 * ones, speeds[..., np.newaxis] * ones, 0 * ones])
    state[:, 2, 1, 3:] = np.nan
    system = rolling_disk_vertical.system
    found = Path(Solution(system, time, state, system.pack(), "OK", ""))
    expected = 2 * speeds
    expected[2, 1] = 6  # two of four intervals, 1 s at 6 m/s
    np.testing.assert_allclose(found.find_length(), expected, rtol=1e-12)


def test_samples_that_are_too_far_apart_are_noticed():
    """Samples of another motion are no path of this system, which the title tells."""
    system = rolling_disk_vertical.system
    state = np.array([[0, 0, 0, 0, 2, 1], [9, 9, 9, 9, 9, 9]], dtype=float).T
    way = Path(Solution(system, np.array([0.0, 1.0]), state, system.pack(), "OK", ""))
    assert not way.is_close


def test_one_sample_is_no_path():
    """Its length is 0."""
    system = rolling_disk_vertical.system
    way = Path(Solution(system, np.zeros(1), np.ones((6, 1)), system.pack(), "OK", ""))
    assert way.find_length() == 0
    assert way.find_points().shape == (2, 1)
