"""Curves of strands, of chains of bodies, and of vectors on spheres."""

import numpy as np
import pytest

from coadjoint.solve.curves import find_curves
from coadjoint.solve.illustrate import describe
from coadjoint.solve.plot import draw
from coadjoint.systems import elastic_chain, kdv, landau_lifshitz, se3_strand, spin_chain

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")


def test_a_bent_strand_is_an_arc_in_space():
    """Constant bending k about the first axis, and steps along the third: a circle of 1/k."""
    size, k = 128, 0.2
    start = np.zeros((12, size))
    start[6], start[11] = k, 1.0
    strand = se3_strand.simulate(start.ravel(), (0, 0.01), samples=3)
    curves = find_curves(strand)
    s = 10 * np.arange(size + 1) / size
    arc = np.stack([0 * s, (np.cos(k * s) - 1) / k, np.sin(k * s) / k])
    np.testing.assert_allclose(curves.points[0], arc, rtol=0, atol=1e-10)
    assert curves.radius == 0
    assert "in space" in describe(strand)


def test_the_sections_of_a_spin_chain_are_on_a_sphere():
    """Turned about the second axis by a constant strain, third axes run along a great circle."""
    size, k = 256, 0.3
    start = np.zeros((6, size))
    start[4] = k
    chain = spin_chain.simulate(start.ravel(), (0, 0.01), samples=3)
    curves = find_curves(chain)
    s = 10 * np.arange(size + 1) / size
    circle = np.stack([np.sin(k * s), 0 * s, np.cos(k * s)])
    np.testing.assert_allclose(curves.points[0], circle, rtol=0, atol=1e-10)
    assert curves.radius == 1


def test_a_strand_that_turns_as_one_body_turns_in_space():
    """About the second axis by w t; as its first section sees it, it would stand still."""
    size, w = 64, 0.7
    start = np.zeros((6, size))
    start[1] = 2.0 * w
    options = {"parameters": {"I": [1.0, 2.0, 3.0]}, "samples": 21}
    chain = spin_chain.system.resize({"s": size}).simulate(start.ravel(), (0, 4), **options)
    curves = find_curves(chain)
    for at in (0, 7, 20):
        angle = w * chain.time[at]
        known = np.array([np.sin(angle), 0.0, np.cos(angle)])
        np.testing.assert_allclose(curves.show(at), np.tile(known, (size + 1, 1)).T, atol=1e-9)
    assert "seen from" not in curves.title
    alone = chain.system.simulate(start.ravel(), (0, 4), samples=1)
    assert "seen from" in find_curves(alone).title


def test_a_magnet_is_a_closed_curve_on_its_sphere():
    """The vectors themselves; of vectors of several lengths there is no curve."""
    magnet = landau_lifshitz.simulate(None, (0, 0.1), samples=3)
    curves = find_curves(magnet)
    assert (len(curves.points), curves.times[-1]) == (3, "t = 0.1 s")
    np.testing.assert_array_equal(curves.points[1][:, :-1], magnet["S"][..., 1])
    np.testing.assert_array_equal(curves.points[:, :, -1], curves.points[:, :, 0])
    magnet.state[:, 1] *= np.linspace(1, 2, 768)
    assert find_curves(magnet) is None
    assert find_curves(kdv.simulate(None, (0, 0.01), samples=3)) is None


def test_a_chain_of_rods_stands_where_its_places_are():
    """The last columns of the frames, which then have no panels."""
    chain = elastic_chain.simulate(None, (0, 1), samples=5)
    curves = find_curves(chain)
    np.testing.assert_array_equal(curves.points[-1], chain["g"][:, 3, :, -1])
    assert (curves.drawn, curves.radius, curves.names[0]) == (("g",), 0, "x [m]")
    figure = draw(chain)
    assert len([axes for axes in figure.axes if axes.name == "3d"]) == 1
    assert len(figure.axes) == 1 + 6 + 1
