"""A picture shows what the system is: orbits in space, or a sphere seen from the near side."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_texts
from coadjoint.solve.illustrate import illustrate
from coadjoint.solve.linkages import find_pendulum
from coadjoint.solve.plot import draw
from coadjoint.solve.scenes import (
    choose_view,
    energy_levels,
    faces_viewer,
    find_paths,
    find_sphere,
    find_spheres,
)
from coadjoint.spec import read_spec
from coadjoint.systems import (
    heavy_top,
    heisenberg,
    kepler,
    lorenz_gyrostat,
    metriplectic_body,
    monopole_kepler,
    n_body,
    n_link_chain,
    n_particles,
    orbiting_body,
    rigid_body,
    so4_body,
    sphere_vortices,
    stochastic_rigid_body,
)
from tests.specs import render_claims, spec

#: Rows of the state of a body on an orbit: its place, after two momenta.
POSE = [[9, 13, 17]]
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")

#: Two particles in a plane, one row of a matrix each, on a spring.
PAIR = """
title = "Two particles on a spring"
source = "Newton"
routes = ["euler-lagrange"]

[variables]
r = { role = "coordinate", shape = [4], form = "matrix", default = [1, 0, 0, 1], unit = "m" }
v = { role = "velocity", of = "r", default = [0, 1, 0, -1], unit = "m/s" }

[parameters]
m = { positive = true, default = 1, unit = "kg" }
k = { positive = true, default = 1, unit = "kg/s^2" }

[lagrangian]
l = "m*trace(transpose(v)*v)/2 - k*norm(r[1] - r[2])^2/2"
"""


def test_orbits_are_found_by_their_unit():
    """Kepler's in space; three bodies in a plane, without the axis along which none moves."""
    orbit = kepler.simulate({"r": [1, 0, 0.2], "v": [0, 1, 0.1]}, (0, 3), samples=50)
    assert find_paths(orbit).members.shape == (1, 3, 50)
    bodies = n_body.simulate(None, (0, 3), samples=20)
    paths = find_paths(bodies)
    assert (paths.names, paths.members.shape) == (("r1", "r2"), (3, 2, 20))
    assert find_paths(rigid_body.simulate([1, 0.3, -0.8], (0, 1), samples=5)) is None


def test_a_centre_is_where_the_force_points_to():
    """Of Kepler's problem; a force that is not along the place has no centre there."""
    orbit = kepler.simulate({"r": [1, 0, 0.2], "v": [0, 1, 0.1]}, (0, 3), samples=50)
    assert find_paths(orbit).central
    beside = monopole_kepler.simulate([1, 0, 0.2, 0, 1, 0.1], (0, 3), samples=50)
    assert not find_paths(beside).central  # a magnetic force is across the velocity
    assert not find_paths(n_body.simulate(None, (0, 1), samples=20)).central


def test_links_in_the_plane_are_found_by_the_place_of_the_last_mass():
    """Each mass by hand from the angles; without the observables there are no links."""
    motion = n_link_chain.simulate({"theta_2": -0.3}, (0, 2), {"l": 0.7}, samples=60)
    paths = find_paths(motion)
    assert (paths.linked, paths.unit, paths.names) == (True, "m", ("x", "y"))
    x = np.cumsum([0.7 * np.sin(motion[f"theta_{n}"]) for n in (1, 2, 3, 4)], axis=0)
    y = np.cumsum([-0.7 * np.cos(motion[f"theta_{n}"]) for n in (1, 2, 3, 4)], axis=0)
    np.testing.assert_allclose(paths.members, np.stack([x, y], axis=1), rtol=0, atol=1e-12)
    names = ("theta_1", "theta_2", "theta_3", "theta_4", "x", "y")
    known = {name: motion[name] for name in names}
    assert find_pendulum(_Known(motion.system, known)) is not None
    known["y"] = known["y"] + 1e-6
    assert find_pendulum(_Known(motion.system, known)) is None


class _Known(dict):
    """Values of a motion by name."""

    def __init__(self, system, values):
        super().__init__(values)
        self.system, self.batch = system, ()

    def __len__(self):
        return len(self["x"])


def test_vectors_of_few_members_share_a_sphere():
    """Three vortices on one sphere; of one that leaves it there is none."""
    motion = sphere_vortices.simulate(None, (0, 1), samples=9)
    (sphere,) = find_spheres(motion)
    assert (sphere.radius, sphere.labels) == (pytest.approx(1), ("x[0]", "x[1]", "x[2]"))
    np.testing.assert_array_equal(sphere.paths[2], motion["x"][:, 2])
    motion.state[0] *= 1.1
    assert find_spheres(motion) == ()


def test_the_momenta_of_four_dimensions_move_on_two_spheres():
    """M + N and M - N, since so(4) is two copies of so(3); M and N alone change their lengths."""
    motion = so4_body.simulate([1, 0.2, -0.4, 0.3, 0.5, 0.6], (0, 5), samples=50)
    assert find_sphere(motion) == ""
    both = find_spheres(motion)
    for sphere, sign in zip(both, (1, -1), strict=True):
        np.testing.assert_array_equal(sphere.paths[0], motion["M"] + sign * motion["N"])
    motion.state[:3] *= 1.01
    assert find_spheres(motion) == ()


def test_a_vector_that_stands_still_is_no_scene():
    """A body at rest in its frame is drawn in components."""
    assert find_sphere(rigid_body.simulate([0, 0, 1], (0, 1), samples=5)) == ""


def test_a_vector_that_grows_moves_between_two_spheres():
    """The momentum of a body that relaxes; of one that does not relax there is one sphere."""
    motion = metriplectic_body.simulate([1.0, 0.3, -0.8], (0, 20), samples=50)
    paths = find_paths(motion)
    size = np.linalg.norm(motion["Pi"], axis=0)
    assert paths.radii == (size[0], size[-1])
    assert size[0] < size[-1]
    assert find_paths(rigid_body.simulate([1, 0.3, -0.8], (0, 1), samples=5)) is None


def test_orbits_without_a_unit_are_found_by_their_rates(tmp_path):
    """Kepler's without units: p is a multiple of the rate of r. A vector on a sphere is none."""
    text = (derivations_folder() / "kepler.toml").read_text()
    (tmp_path / "plain.toml").write_text(re.sub(r'unit( *)= "[^"]*"', r'unit\1= "1"', text))
    with load_texts(render_claims(read_spec(tmp_path / "plain.toml")).texts) as system:
        (place, _) = system.STATE
        assert system.STATE[place].unit == "1"
        orbit = system.simulate([1, 0, 0.2, 0, 1, 0.1], (0, 3), samples=50)
        paths = find_paths(orbit)
        assert (paths.names, paths.unit, paths.linked) == (("r1", "r2", "r3"), "1", False)
        np.testing.assert_array_equal(paths.members[0], orbit["r"])
    free = rigid_body.simulate([1, 0.3, -0.8], (0, 1), samples=5)
    assert find_paths(free) is None


def test_a_sphere_is_a_leaf_of_the_bracket():
    """Heisenberg's group moves in planes mu3 = const, though its energy keeps |mu| as well."""
    motion = heisenberg.simulate([0.6, 0.0, 0.8], (0, 3), samples=50)
    assert np.ptp(np.linalg.norm(motion["mu"], axis=0)) < 1e-6
    assert find_spheres(motion) == ()
    assert find_paths(motion).names == ("mu1", "mu2", "mu3")
    assert find_sphere(rigid_body.simulate([1, 0.3, -0.8], (0, 1), samples=5)) == "Pi"


@pytest.mark.parametrize(
    ("module", "state", "count", "rows"),
    [
        (lorenz_gyrostat, None, 1, [[0, 1, 2]]),
        (n_particles, None, 3, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]),
        (orbiting_body, [0.3, 0.5, 0.8, 0, 1, 0, 1, 0, 0, 10, 0, 1, 0, 0, 0, 0, 1, 0], 1, POSE),
    ],
)
def test_places_are_found_in_scalars_rows_and_poses(module, state, count, rows):
    """x, y and z are one place; rows of a matrix are, and the last column of a pose."""
    motion = module.simulate(state, (0, 1), samples=20)
    paths = find_paths(motion)
    assert len(paths.members) == count
    for member, own in zip(paths.members, rows, strict=True):
        np.testing.assert_array_equal(member, motion.state[own])


@pytest.mark.parametrize(
    ("stretch", "count"), [("r[1] - r[2]", 2), ("r[1] - 2*r[2]", None)], ids=["between", "held"]
)
def test_rows_of_a_plane_are_places_where_a_shift_changes_no_rate(stretch, count):
    """Two particles with a spring between them; with one end in space the rows are no places."""
    declared = spec(PAIR, ("r[1] - r[2]", stretch)) if count is None else spec(PAIR)
    with load_texts(render_claims(declared).texts) as system:
        paths = find_paths(system.simulate(None, (0, 1), samples=20))
    assert (paths and len(paths.members)) == count


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_curve_around_an_axis_is_on_the_near_side(axis, sign):
    """A small circle about each axis is seen, from no axis itself; from behind it is not."""
    angle = np.linspace(0, 2 * np.pi, 60)
    curve = np.roll([np.full(60, 0.9 * sign), 0.4 * np.cos(angle), 0.4 * np.sin(angle)], axis, 0)
    toward = choose_view(curve)
    if (axis, sign) != (2, -1):  # from below nobody looks; the view is from as far down as it goes
        assert faces_viewer(curve, toward).all()
        assert not faces_viewer(curve, -toward).all()
    assert abs(toward).max() < 0.97
    assert np.linalg.norm(toward) == pytest.approx(1)


def test_level_curves_have_one_energy_each():
    """Evaluated by hand at their points, which lie on the sphere."""
    motion = rigid_body.simulate([1.0, 0.3, -0.8], (0, 2), samples=20)
    name = find_sphere(motion)
    radius = float(np.linalg.norm(motion[name][:, 0]))
    levels = energy_levels(motion, name, radius)
    inertia = np.array([1.0, 2.0, 3.0])[:, None]
    assert len(levels) >= 8
    for level in levels:
        assert np.linalg.norm(level, axis=0) == pytest.approx(1.002 * radius)
        energy = (level**2 / inertia).sum(axis=0) / 2
        assert np.ptp(energy) < 0.02 * energy.max()  # the grid is 4 degrees wide


def test_level_curves_are_those_of_what_stays():
    """With a rotor that keeps its momentum L the energy has (Pi2 - L)^2/2 I2 in it."""
    with load_texts(render_claims(read_spec(EXAMPLES / "gyrostat.toml")).texts) as system:
        motion = system.simulate([0.2, 1.0, 0.1, 0.4], (0, 2), samples=20)
        (sphere,) = find_spheres(motion)
    assert np.ptp(motion["L"]) == 0
    inertia, rotor = np.array([1.0, 2.0, 3.0])[:, None], np.array([0.0, 0.4, 0.0])[:, None]
    assert len(sphere.levels) >= 8
    for level in sphere.levels:
        energy = ((level - rotor) ** 2 / inertia).sum(axis=0) / 2
        assert np.ptp(energy) < 0.02 * energy.max()  # the grid is 4 degrees wide
    moving = heavy_top.simulate([0, 0, 3, 0.6, 0, 0.8], (0, 2), samples=20)
    assert find_spheres(moving)[0].levels == ()  # the energy depends on the momentum, which moves


def test_paths_with_noise_are_drawn_by_their_seeds(monkeypatch):
    """Three paths from one start on one sphere, each that of its seed; the caption names them."""
    drawn = []
    monkeypatch.setattr("coadjoint.solve.plot.draw", lambda *s: drawn.append(draw(*s)) or drawn[0])
    start = [0.6, 0.0, -0.8]
    told = illustrate(stochastic_rigid_body.system, start)
    assert told["picture"].startswith("data:image/png;base64,")
    assert "3 paths from one start" in told["caption"]
    assert "over 6 s" in told["caption"]
    assert "the seeds 1, 2, 3" in told["caption"]
    (paths,) = (axes.coadjoint_path[1] for axes in drawn[0].axes if hasattr(axes, "coadjoint_path"))
    np.testing.assert_allclose((paths**2).sum(axis=1), 1.0, rtol=1e-12)
    for seed, path in enumerate(paths, start=1):
        run = stochastic_rigid_body.simulate(
            start, (0.0, 6.0), step=1 / 64, seed=seed, samples=3, progress=False
        )
        np.testing.assert_array_equal(path[:, [0, 192, 384]], run["Pi"])
    assert len({tuple(path[:, -1]) for path in paths}) == 3


def test_drift_is_a_small_strip():
    """Less than a quarter of the height of the motion."""
    figure = draw(rigid_body.simulate([1.0, 0.3, -0.8], (0, 2), samples=20))
    figure.draw_without_rendering()
    motion, drift = figure.axes[0].get_position(), figure.axes[-1].get_position()
    strips = [axes for axes in figure.axes if axes.get_yscale() == "log"]
    assert len(strips) == 1
    assert strips[0].get_position().height < 0.25 * motion.height
    assert drift.width > 0


def test_a_picture_for_a_page_is_data():
    """No address, and the caption says what it is."""
    shown = illustrate(rigid_body.system, [1.0, 0.3, -0.8])
    assert shown["picture"].startswith("data:image/png;base64,")
    assert "20 s" in shown["caption"]


@pytest.mark.parametrize("turn", np.linspace(-3.1, 3.1, 13))
def test_nobody_looks_along_an_axis(turn):
    """Ticks of two axes would lie on each other; the curve is on the near side all the same."""
    curve = np.array([[np.cos(turn)] * 2, [np.sin(turn)] * 2, [0.1, -0.1]])
    toward = choose_view(curve)
    azimuth = np.degrees(np.arctan2(toward[1], toward[0])) % 90
    assert 22.4 < azimuth < 67.6
    assert (toward @ curve > 0).all()
