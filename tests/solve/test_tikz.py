"""Figures as TikZ have what the figure has, at its place, and compile."""

from __future__ import annotations

import re
import shutil
import subprocess

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")
from matplotlib.figure import Figure

from coadjoint.solve import tikz
from coadjoint.solve.tikz import write_tikz

PLACE = re.compile(r"\(([-\d.]+),([-\d.]+)\)")


def lines_of(text, width):
    """The lines of a width, each as an array of points."""
    found = [line for line in text.splitlines() if f"line width={width}pt" in line]
    return [np.array(PLACE.findall(line), float) for line in found]


def test_a_line_is_where_the_figure_has_it():
    """Points of data, carried by the figure's own transform, to a tenth of a point."""
    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    x, y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, -1.0])
    axes.plot(x, y, linewidth=3.5)
    text = write_tikz(figure)
    (found,) = lines_of(text, 3.5)
    assert np.abs(found - axes.transData.transform(np.column_stack([x, y]))).max() <= 0.051
    assert found[:, 0].min() >= 0.1 * 4 * 72 - 0.1


def test_segments_of_one_colour_are_one_line():
    """Of two colours there are two."""
    from matplotlib.collections import LineCollection

    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, 9), ylim=(-1, 1))
    points = np.column_stack([np.arange(9.0), np.sin(np.arange(9.0))])
    colours = ["red"] * 4 + ["blue"] * 4
    segments = np.stack([points[:-1], points[1:]], axis=1)
    axes.add_collection(LineCollection(segments, colors=colours, linewidths=3.5))
    found = lines_of(write_tikz(figure), 3.5)
    assert [len(each) for each in found] == [5, 5]


def test_a_field_has_the_colours_of_its_cells():
    """Cells of one colour are one strip, and cover what the cells do."""
    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.pcolormesh(np.array([[0, 0, 1, 1, 1], [0, 1, 1, 1, 1]]), cmap="gray")
    strips = re.findall(r"\\fill\[(\w+)\](.*);", write_tikz(figure))
    assert len(strips) == 4
    corners = [np.array(PLACE.findall(box), float) for _, box in strips]
    areas = [abs(np.prod(b - a)) for a, b in corners]
    assert np.isclose(sum(areas), 4 * 72 * 3 * 72, rtol=1e-2)
    assert np.isclose(areas[0] / areas[1], 2 / 3, rtol=1e-2)


def test_what_would_be_too_long_is_left_out(monkeypatch):
    """A limit, and no broken picture."""
    figure = Figure(figsize=(4, 3))
    figure.add_axes((0, 0, 1, 1)).plot([0, 1], [0, 1])
    assert write_tikz(figure)
    monkeypatch.setattr(tikz, "LONGEST", 100)
    assert write_tikz(figure) == ""


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="LaTeX is not installed")
def test_words_of_a_figure_compile(tmp_path):
    """Whatever a unit or a title may have, and what LaTeX knows as commands."""
    figure = Figure(figsize=(4, 3))
    axes = figure.add_axes((0.2, 0.2, 0.7, 0.7), title="φ̇ 100 % of a_1 & #2 {x} ~ ^ \\end$1$")
    axes.plot([0, 1], [-1, 1], "--", label="Ω₁")
    axes.fill_between([0, 1], [0, 1], alpha=0.3)
    axes.set_ylabel("v [m/s²]")
    axes.legend()
    head = "\\documentclass{article}\\usepackage{tikz}\\begin{document}"
    (tmp_path / "a.tex").write_text(f"{head}{write_tikz(figure)}\\end{{document}}")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "a.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-600:]
