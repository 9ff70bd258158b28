"""Films: whole files, a mark that is where the motion is, and clear refusals."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import pytest
from matplotlib import animation as films
from matplotlib.colors import to_hex
from PIL import Image

from coadjoint.errors import KernelArgumentError
from coadjoint.solve import animation
from coadjoint.solve.panels import COLOURS
from coadjoint.solve.plot import draw
from coadjoint.systems import chaplygin_ball, euler_2d, heavy_top, kepler, zeitlin_su_n

TOP = ({"Pi": [0, 0, 3], "Gamma": [0.6, 0, 0.8]}, (0, 2), {"I": [1, 1, 0.6], "m": 0.3})


def test_a_gif_has_a_picture_for_each_part_of_its_time(tmp_path):
    """Of one second, and progress is told of each; pictures differ."""
    told = []
    top = heavy_top.simulate(*TOP, samples=201)
    path = tmp_path / "top.gif"
    top.animate(path, seconds=0.2, progress=lambda done, total: told.append((done, total)))
    with Image.open(path) as film:
        assert film.n_frames == 5
        frames = []
        for n in range(5):
            film.seek(n)
            frames.append(np.asarray(film.convert("RGB")))
    assert all((a != b).any() for a, b in pairwise(frames))
    assert [done for done, _ in told] == list(range(5))
    assert {total for _, total in told} == {5}


def test_marks_are_where_the_motion_is():
    """A point of the path at its time, and a line at the time; a point of another time differs."""
    orbit = kepler.simulate({"r": [1, 0.5, 0.8], "v": [0.5, 0.8, 0.2]}, (0, 4), samples=401)
    figure = draw(orbit)
    moves = list(animation._list_moves(figure, orbit))
    assert len(moves) == 2  # the orbit, and the drift below it
    for move in moves:
        move(1.0)
    space = next(axes for axes in figure.axes if hasattr(axes, "coadjoint_path"))
    place = np.array([float(each[0]) for each in space.lines[-1].get_data_3d()])
    assert np.abs(place - orbit["r"][:, 100]).max() < 1e-12
    assert np.abs(place - orbit["r"][:, 200]).max() > 0.1
    drift = next(axes for axes in figure.axes if hasattr(axes, "coadjoint_time"))
    assert list(drift.lines[-1].get_xdata()) == [1.0, 1.0]


def test_what_moves_has_a_colour_that_no_mark_has():
    """Neither that of the start nor that of the end, on a sphere and on an orbit."""
    top = heavy_top.simulate(*TOP, samples=51)
    figure = draw(top)
    space = next(axes for axes in figure.axes if hasattr(axes, "coadjoint_path"))
    marks = {to_hex(colour) for each in space.collections for colour in each.get_facecolor()}
    list(animation._list_moves(figure, top))
    assert {to_hex(COLOURS[1]), "#000000"} <= marks
    assert to_hex(space.lines[-1].get_color()) not in marks


def test_a_film_of_a_body_tells_of_one_body():
    """That it is pale where it was before is said of a picture alone."""
    ball = chaplygin_ball.simulate(None, (0, 1), samples=21, reconstruct=True)
    figure = draw(ball)
    told = [axes.get_title() for axes in figure.axes]
    assert any("pale" in each for each in told)
    list(animation._list_moves(figure, ball))
    shown = [axes.get_title() for axes in figure.axes]
    assert not any("pale" in each for each in shown)
    assert any("blue sectors: the body" in each for each in shown)


def test_a_page_plays_without_a_network(tmp_path):
    """Its pictures stand in it."""
    path = tmp_path / "top.html"
    heavy_top.simulate(*TOP, samples=21).animate(path, seconds=0.1)
    text = path.read_text()
    assert text.count("data:image/png;base64") == 2
    assert not re.findall("https?:", text)
    assert "fa-play" not in text
    assert "&#9654;" in text


@pytest.mark.parametrize(
    ("name", "message"),
    [("top.avi", r"ending is '.avi'. Expected one of .gif, .mp4, .html"), ("top", "ending is ''")],
)
def test_another_ending_is_refused(name, message, tmp_path):
    """Before anything is drawn."""
    with pytest.raises(KernelArgumentError, match=message):
        heavy_top.simulate(*TOP, samples=3).animate(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_mp4_without_ffmpeg_says_what_to_do(tmp_path, monkeypatch):
    """Install it, or take what needs none."""
    monkeypatch.setattr(films.writers, "is_available", lambda name: name != "ffmpeg")
    top = heavy_top.simulate(*TOP, samples=3)
    with pytest.raises(KernelArgumentError, match=r"apt install ffmpeg`, or take .gif or .html"):
        top.animate(tmp_path / "top.mp4")
    top.animate(tmp_path / "top.gif", seconds=0.1)
    assert (tmp_path / "top.gif").is_file()


def test_one_sample_does_not_move(tmp_path):
    """And nothing is written."""
    with pytest.raises(KernelArgumentError, match="Ask for more, samples=200"):
        heavy_top.simulate(*TOP, samples=1).animate(tmp_path / "top.gif")
    assert not list(tmp_path.iterdir())


def test_a_field_in_a_plane_moves_in_its_last_panel():
    """Its colours at a time are those of the latest sample, at four times as many points."""
    x = 2 * np.pi * np.arange(8) / 8
    w = np.cos(x)[:, None] + np.sin(2 * x)[None, :]
    run = euler_2d.system.resize({"x": 8, "y": 8}).simulate({"w": w}, (0, 4), samples=5)
    figure = draw(run)
    (panel,) = (each for each in figure.axes if hasattr(each, "coadjoint_field"))
    colours, _ = panel.coadjoint_field
    (move,) = (
        each
        for each in animation._list_moves(figure, run)
        if each.__qualname__.startswith("_move_field")
    )
    for now, at in ((0.0, 0), (1.5, 1), (4.0, 4)):
        move(now)
        shown = np.asarray(colours.get_array()).reshape(32, 32).T
        np.testing.assert_allclose(shown[::4, ::4], run["w"][..., at], atol=1e-12)
        assert panel.get_title().startswith(f"t = {run.time[at]:.4g}")
    assert np.abs(run["w"][..., 4] - run["w"][..., 0]).max() > 0.1


def test_a_fluid_on_the_sphere_moves_in_its_last_panel():
    """A map of the sphere, whose colours are those of the function of the matrix at a time."""
    fluid = zeitlin_su_n.system.resize({"N": 3})
    run = fluid.simulate({"W": [0, 1, 0, 2, 0, 1, 0, 0.5, 0]}, (0, 4), samples=5, target="numpy")
    figure = draw(run)
    maps = [each for each in figure.axes if each.name == "mollweide"]
    assert len(maps) == 4
    colours, show = maps[-1].coadjoint_field
    (move,) = (
        each
        for each in animation._list_moves(figure, run)
        if each.__qualname__.startswith("_move_field")
    )
    for now, at in ((0.0, 0), (1.5, 1), (4.0, 4)):
        move(now)
        shown = np.asarray(colours.get_array()).reshape(12, 24)
        np.testing.assert_array_equal(shown, show(at))
        mean = np.cos(np.pi * ((np.arange(12) + 0.5) / 12 - 0.5)) @ shown
        np.testing.assert_allclose(mean.mean(), run["W"].reshape(9, -1)[::4, at].sum(), atol=0.02)
        assert maps[-1].get_title().startswith(f"t = {run.time[at]:.4g}")
    assert np.abs(show(4) - show(0)).max() > 0.1
    assert colours.norm.vmin == -colours.norm.vmax
