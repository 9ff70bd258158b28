"""Bodies that roll: their surface by closed forms, their height over the plane, and the picture."""

from dataclasses import replace

import numpy as np
import pytest

from coadjoint.solve.plot import draw
from coadjoint.solve.rolling_bodies import (
    CAP,
    COLUMNS,
    ROWS,
    _count_cap,
    draw_rolling,
    find_rolling,
)
from coadjoint.systems import chaplygin_ball, euler_disk, rattleback, roller_racer

CENTRE = np.array([0.1, 0.2, 0.3])


def roll(module, **options):
    """A motion from the default start."""
    given = {"samples": 1001, "reconstruct": True, "progress": False, **options}
    return module.simulate(None, (0, 4), **given)


@pytest.fixture(scope="module")
def ball():
    """A ball of radius 1 whose centre of mass is off its centre."""
    return roll(chaplygin_ball)


def test_a_ball_is_a_sphere_around_its_centre_and_rolls_at_the_height_of_it(ball):
    """By s = r Gamma + chi: the surface has radius r about -chi, the centre is s.Gamma high."""
    body = find_rolling(ball)
    radii = np.linalg.norm(body.surface + CENTRE[:, None, None], axis=0)
    assert radii.shape == (26, 49)
    np.testing.assert_allclose(radii[1:-1], 1.0, atol=1e-12)
    # Holm II (2011), 12.2: the centre of mass is chi above the centre of the ball, which is r high
    height = 1.0 + CENTRE @ ball["Gamma"]
    assert np.ptp(height) > 0.1
    np.testing.assert_allclose(body.centre[2], height, atol=1e-10)
    np.testing.assert_allclose(body.contact[:2], [ball["x"], ball["y"]], atol=0)


def test_a_disk_is_flat_and_a_rattleback_an_ellipsoid():
    """All points of the rim are r from the centre; (x/a)^2 + (y/b)^2 + (z/c)^2 = 1."""
    disk = find_rolling(roll(euler_disk))
    radius = float(euler_disk.system.PARAMETERS["r"].default[0])
    assert disk.is_flat
    np.testing.assert_allclose(np.linalg.norm(disk.surface[:, 1:-1], axis=0), radius, rtol=1e-12)
    motion = roll(rattleback)
    stone = find_rolling(motion)
    axes = np.array(rattleback.system.PARAMETERS["axes"].default)
    assert not stone.is_flat
    form = ((stone.surface[:, 1:-1] / axes[:, None, None]) ** 2).sum(axis=0)
    np.testing.assert_allclose(form, 1.0, rtol=1e-12)


def test_the_lowest_point_of_a_body_is_its_contact(ball):
    """No point of the surface is below the plane; one is close to the contact."""
    body = find_rolling(ball)
    for at in (0, 333, 1000):
        surface = body.surface_at(at).reshape(3, -1)
        near = np.linalg.norm(surface - body.contact[:, [at]], axis=0).min()
        assert surface[2].min() > -1e-10
        assert near < 0.15  # rings are 0.13 apart


def test_a_contact_that_does_not_go_with_the_velocity_is_no_rolling(ball):
    """With the plane mirrored, the centre would move against the velocity that is known of it."""
    other = roll(chaplygin_ball)
    assert find_rolling(other) is not None
    other.reconstructed[4] *= -1
    assert find_rolling(other) is None


def test_a_vehicle_in_the_plane_is_no_rolling_body():
    """It has a place and a direction, and no attitude in space."""
    motion = roll(roller_racer, samples=101)
    assert motion.reconstructed is not None
    assert find_rolling(motion) is None


def test_without_a_place_there_is_no_body():
    """Nothing was reconstructed."""
    assert find_rolling(roll(chaplygin_ball, samples=101, reconstruct=False)) is None


def test_a_picture_has_one_scale_and_its_body_moves(ball):
    """Lengths of the box are those of its limits; a film draws the body elsewhere, and once."""
    pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    axes = draw(ball).axes[0]
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    sides = np.ptp(limits, axis=1) / axes._box_aspect
    np.testing.assert_allclose(sides, sides[0], rtol=1e-12)
    count, last = len(axes.collections), axes.collections[-1]
    axes.coadjoint_body(0)
    assert len(axes.collections) == count
    assert last not in axes.collections


def draw_last(motion, spoil=lambda body: body):
    """The surface of the body in a picture of a motion, which may be spoiled before."""
    pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    from matplotlib.figure import Figure

    axes = Figure().add_subplot(projection="3d")
    draw_rolling(axes, spoil(find_rolling(motion)))
    return axes.collections[-1]


def count_orange(surface):
    """Faces whose red is above their blue, whatever the light on them."""
    colours = surface.get_facecolor()
    assert len(colours) == (ROWS + 1) * COLUMNS
    return int((colours[:, 0] > colours[:, 2]).sum())


def test_the_cap_is_where_the_third_axis_leaves_the_body(ball):
    """Its rings are those of a ball that are farthest along that axis; a disk has none."""
    assert count_orange(draw_last(ball)) == CAP * COLUMNS
    heights = find_rolling(ball).surface[2].mean(axis=1)
    assert heights[-CAP - 1 :].min() > heights[: -CAP - 1].max()
    assert count_orange(draw_last(roll(euler_disk))) == 0
    flat = {"surface": find_rolling(ball).surface * np.array([1, 1, 1e-3])[:, None, None]}
    assert count_orange(draw_last(ball, lambda body: replace(body, **flat))) == 0


@pytest.mark.parametrize(
    ("widths", "count"),
    [(np.sin(np.linspace(0, np.pi, 31)), CAP), ([1.0] * 28 + [0.9, 0.3, 0.0], 1)],
    ids=["ball", "flat top"],
)
def test_the_cap_is_at_most_half_as_wide_as_the_body(widths, count):
    """Of a ball it has all its rings, 24 degrees; of a body whose top is three rings, the inner."""
    angle = np.linspace(0, 2 * np.pi, COLUMNS, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle])
    surface = np.asarray(widths)[None, :, None] * circle[:, None, :]
    assert _count_cap(surface) == count
    assert widths[-1 - count] <= 0.5


def test_no_body_is_cut_at_the_border_of_its_box(ball):
    """Seen from near it stands out over the sides of the box, which would cut a part of it."""
    assert not draw_last(ball).get_clip_on()
