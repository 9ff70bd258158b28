"""Captions of pictures say what each colour is."""

import io
import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from coadjoint.cli.simulate import find_start
from coadjoint.solve.illustrate import (
    _has_colours_of_values,
    _take_colours,
    describe,
    find_loss,
    illustrate,
    write_svg,
)
from coadjoint.solve.panels import COLOURS
from coadjoint.solve.plot import draw
from coadjoint.solve.scenes import TIME_MAP
from coadjoint.systems import (
    burgers,
    chaplygin_ball,
    euler_disk,
    kdv,
    kepler,
    knife_edge_cvt,
    n_body,
    rigid_body,
    roller_racer,
    so8_body,
    spd_motion,
)

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
from matplotlib.figure import Figure

STARTS = {rigid_body: [1, 0.3, -0.8], kepler: [1, 0, 0, 0, 1.1, 0], so8_body: [0.1] * 28}
TIME = "Colour is time, dark at the start."


@pytest.mark.parametrize(
    ("module", "told", "untold"),
    [
        (rigid_body, (TIME,), ("cap", "member")),
        (kepler, (TIME,), ("cap", "member")),
        (n_body, ("Each member has a colour of its own.",), ("time,",)),
        (chaplygin_ball, ("coloured by time", "gray line", "two blues", "orange cap"), ("member",)),
        (euler_disk, ("coloured by time", "gray line", "two blues"), ("cap",)),
        (roller_racer, ("coloured by time", "vehicle is black"), ("cap", "blue")),
        (so8_body, ("by the generated code.",), ("olour", "cap")),
    ],
)
def test_a_caption_tells_the_colours_of_its_picture(module, told, untold):
    """Of spheres, orbits, members, bodies that roll and vehicles; components have a legend."""
    options = {"reconstruct": True} if module.system.RECONSTRUCTED else {}
    motion = module.simulate(STARTS.get(module), (0, 4), samples=1001, progress=False, **options)
    caption = describe(motion)
    assert [each for each in told if each not in caption] == []
    assert [each for each in untold if each in caption] == []
    assert np.isfinite(motion.state).all()


def test_a_time_without_a_unit_is_a_number():
    """The unit 1 of what has no dimension does not stand behind it."""
    motion = knife_edge_cvt.simulate(
        find_start(knife_edge_cvt.system, ()), (0, 1), samples=20, progress=False
    )
    assert "over a time of 1, by" in describe(motion)


def test_a_caption_tells_how_far_a_motion_came_and_why_it_stopped():
    """Not how long it should have been."""
    motion = rigid_body.simulate([1, 0.3, -0.8], (0, 4), samples=401, max_steps=3, progress=False)
    assert motion.status == "MAX_STEPS"
    assert f"over {motion.time_reached:.3g} s, by" in describe(motion)
    assert "largest number of steps" in describe(motion)
    whole = rigid_body.simulate([1, 0.3, -0.8], (0, 4), samples=41, progress=False)
    assert "over 4 s, by" in describe(whole)
    assert "stops" not in describe(whole)


def test_values_as_colours_have_more_colours():
    """Bars of a field would have steps; a path on a sphere has no such bar."""
    wave = kdv.simulate(None, (0, 0.01), samples=3, progress=False)
    assert _has_colours_of_values(draw(wave))
    assert not _has_colours_of_values(draw(rigid_body.simulate([1, 0.3, -0.8], (0, 4), samples=9)))


def test_lines_keep_their_colours_among_those_of_a_surface():
    """A thin line has too few dots for a colour of its own, among all those of a surface."""
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb
    from PIL import Image

    orange = tuple(round(255 * part) for part in to_rgb(COLOURS[1]))
    picture = Image.effect_noise((300, 300), 200).convert("RGB")
    picture.paste(orange, (10, 150, 290, 151))
    place = io.BytesIO()
    picture.save(place, format="png")
    with Image.open(io.BytesIO(_take_colours(place))) as small:
        colours = small.convert("RGB").getcolors()
        assert (280, orange) in colours
        assert 20 < len(colours) <= 96
        palette = np.reshape(small.getpalette(), (-1, 3)).tolist()
    ends = np.round(255 * colormaps[TIME_MAP]([0.0, 1.0])[:, :3]).astype(int).tolist()
    assert all(each in palette for each in ends), "the first and the last time"
    few = np.reshape(picture.quantize(64).getpalette(), (-1, 3)).tolist()
    assert not any(each in few for each in ends)
    plain = {colour for _, colour in picture.quantize(64).convert("RGB").getcolors()}
    assert orange not in plain


def test_a_picture_of_typst_is_whole_and_the_same_each_time():
    """A string of Typst with an SVG picture, whose places are those of the figure to 0.01 pt."""
    system, start = rigid_body.system, STARTS[rigid_body]
    first, again = (illustrate(system, start, "typst")["picture"] for _ in range(2))
    assert first == again
    text = first[1:-1].replace('\\"', '"').replace("\\\\", "\\")
    root = ET.fromstring(text.partition("?>")[2].partition('dtd">')[2])
    assert root.tag.endswith("svg")
    paths = [each.get("d") for each in root.iter() if each.get("d")]
    assert len(paths) > 20
    assert not [each for each in paths if re.search(r"\.\d{3}", each)]


def test_a_line_of_an_svg_picture_is_where_the_figure_has_it():
    """Points of data, carried by the figure's own transform."""
    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    x, y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, -1.0])
    axes.plot(x, y, linewidth=3.5)
    line = re.search(r'd="([^"]*)"[^>]*stroke-width: 3.5', write_svg(figure))[1]
    found = np.array(re.findall(r"[-\d.]+", line), float).reshape(-1, 2)
    expected = axes.transData.transform(np.column_stack([x, y])) * 72 / figure.dpi
    expected[:, 1] = 3 * 72 - expected[:, 1]
    assert np.abs(found - expected).max() < 0.02


def test_a_picture_ends_where_waves_break():
    """Of a sine at 1/3, by its characteristics s + 3 u t; one that falls nowhere goes on."""
    system, s = burgers.system, 2 * np.pi * np.arange(128) / 128
    assert "over 0.333 s, by" in illustrate(system, np.sin(s))["caption"]
    assert illustrate(system, np.sin(s))["caption"].endswith("It ends where the waves break.")
    still = illustrate(system, np.ones(128))["caption"]
    assert "over 20 s, by" in still
    assert "break" not in still


def test_a_picture_ends_before_its_digits_are_lost():
    """A geodesic of symmetric matrices comes so near to their edge that doubles do not suffice."""
    system, start = spd_motion.system, find_start(spd_motion.system, ())
    whole = system.simulate(start, (0, 20), samples=1500, progress=False)
    assert max(whole.drift.values()) > 0.1
    end = find_loss(whole)
    assert 5 < end < 20
    before = system.simulate(start, (0, end), samples=1500, progress=False)
    assert max(before.drift.values()) < 1e-3
    assert find_loss(system.simulate(start, (0, 1), samples=50, progress=False)) is None
    assert illustrate(system, start)["caption"].endswith("invariants drift beyond it.")
