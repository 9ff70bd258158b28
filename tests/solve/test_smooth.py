"""Paths of pictures have no corners where a motion is fast."""

import numpy as np
import pytest

from coadjoint.solve.plot import _smooth, draw, find_scene
from coadjoint.solve.smooth import add_times, has_corners
from coadjoint.systems import kepler, rigid_body

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")

ORBIT = {"r": [1, 0, 0], "v": [0, 0.4, 0]}  # at an eccentricity of 0.84


def test_a_fast_passage_gets_more_times():
    """Of a long ellipse by few samples: its conserved vectors hold at the times between them."""
    orbit = kepler.simulate(ORBIT, (0, 4), {"mu": 1}, samples=60)
    scene = find_scene(orbit)
    assert has_corners(scene.members)
    fine = _smooth(orbit, scene)
    members = find_scene(fine).members
    assert not has_corners(members)
    assert len(orbit) < len(fine) < 1500
    assert (np.diff(fine.time) > 0).all()
    assert {fine.time[0], fine.time[-1]} == {orbit.time[0], orbit.time[-1]}
    np.testing.assert_allclose(fine["energy"], orbit["energy"][0], rtol=1e-6)
    straight = [np.interp(fine.time, orbit.time, row) for row in orbit["r"]]
    assert np.abs(straight - fine["r"]).max() > 0.05, "lines between samples would do"
    space = next(axes for axes in draw(orbit).axes if hasattr(axes, "coadjoint_path"))
    np.testing.assert_array_equal(space.coadjoint_path[1], members)


def test_a_smooth_path_stays_as_it_is():
    """Many samples of a slow motion are drawn as they are."""
    motion = rigid_body.simulate([1, 0.3, -0.8], (0, 4), samples=401)
    assert _smooth(motion, find_scene(motion)) is motion
    same = add_times(motion, lambda found: found["Pi"][None])
    assert set(same.time) <= set(motion.time)
