"""Pictures: drawn, on the sphere where there is one, and errors that say what to do."""

import sys

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve.plot import _choose_limits, plot
from coadjoint.solve.scenes import faces_viewer
from coadjoint.solve.solution import Solution
from coadjoint.systems import (
    elastic_chain,
    heavy_top,
    heisenberg_lattice,
    kdv,
    n_body,
    rigid_body,
    so8_body,
)

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")


@pytest.fixture(scope="module")
def body():
    """A free body on its momentum sphere."""
    return rigid_body.simulate([1.0, 0.3, -0.8], (0, 20), samples=200)


def test_a_picture_is_written(body, tmp_path):
    """A PNG of some size, and no temporary file beside it."""
    body.plot(tmp_path / "body.png")
    assert (tmp_path / "body.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert len(list(tmp_path.iterdir())) == 1


def test_the_body_is_drawn_on_its_sphere_and_the_top_by_its_vertical(body):
    """Pi of the free body and Gamma of the top have constant length; Pi of the top has not."""
    from matplotlib.figure import Figure

    assert isinstance(plot_figure(body), Figure)
    titles = [axes.get_title() for axes in plot_figure(body).axes]
    assert any("Π" in title and "sphere" in title for title in titles)
    top = heavy_top.simulate([0.3, 0, 2.0, 0.6, 0, 0.8], (0, 5), samples=100)
    assert any("Γ" in axes.get_title() for axes in plot_figure(top).axes)


def plot_figure(solution):
    """The figure, without a display."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure = plot(solution)
    plt.close(figure)
    return figure


def test_components_are_drawn_where_there_is_no_sphere(body, tmp_path):
    """A body whose momentum is not conserved in length, by hand."""
    spoiled = rigid_body.simulate([1.0, 0.3, -0.8], (0, 20), samples=50)
    spoiled.state[0] *= np.linspace(1, 2, 50)
    labels = [text.get_text() for axes in plot_figure(spoiled).axes for text in legend(axes)]
    assert {"Π$_{1}$", "Π$_{2}$", "Π$_{3}$"} <= set(labels)


def legend(axes):
    """Texts of a legend, if there is one."""
    return axes.get_legend().get_texts() if axes.get_legend() else []


def test_many_components_have_lines_of_their_own(tmp_path):
    """28 components differ by colour or dashes, their legend columns of at most 14."""
    state = np.linspace(-1, 1, 28)
    axes = plot_figure(so8_body.simulate(state, (0, 1), samples=20)).axes[0]
    lines = axes.get_lines()
    strokes = {(line.get_color(), line.get_linestyle()) for line in lines}
    assert len(lines) == len(strokes) == 28
    assert axes.get_legend()._ncols == 2


def test_many_members_are_colours_over_time():
    """A panel for each component, with a row for each member and a column for each sample."""
    spins = heisenberg_lattice.system.resize({"i": 30})
    state = np.vstack([np.cos(np.arange(30)), np.sin(np.arange(30)), np.zeros(30)]).ravel()
    motion = spins.simulate(state, (0, 1), samples=7)
    figure = plot_figure(motion)
    drawn = [axes.collections[0].get_array() for axes in figure.axes[:6:2]]
    assert np.array_equal(drawn, motion["S"])
    assert [axes.get_ylabel() for axes in figure.axes[:6:2]] == ["member"] * 3


def test_each_component_has_its_own_unit():
    """Of attitudes and places of rods: directions have none, and places are in metres."""
    chain = elastic_chain.simulate(None, (0, 0.1), samples=5)
    labels = [axes.get_ylabel() for axes in plot(chain).axes if axes.get_ylabel().startswith("g$")]
    assert len(labels) == 12
    assert [label.endswith("[m]") for label in labels] == [False, False, False, True] * 3


def test_points_of_a_field_are_no_members():
    """Rows of a field are points along its coordinate."""
    wave = kdv.simulate(None, (0, 0.01), samples=3)
    assert plot(wave).axes[0].get_ylabel() == "point s"


def test_the_drift_of_what_begins_at_zero_is_drawn_as_it_is():
    """Momenta of the figure eight are 0: their roundings are small, and no ratio of themselves."""
    eight = n_body.simulate(None, (0, 1), samples=21)
    strip = plot(eight).axes[-1]
    labels = [line.get_label() for line in strip.lines]
    assert [label.endswith("absolute)") for label in labels] == [False, True, True]
    assert max(np.nanmax(line.get_ydata()) for line in strip.lines) < 1e-9


def test_only_the_near_side_is_drawn_strong(body):
    """Points toward the viewer are near, those opposite are not, and the parts touch."""
    toward = np.array([0.6, -0.71, 0.37])
    path = np.stack([toward, toward, -toward, -toward, -toward, toward], axis=1)
    assert faces_viewer(path, toward).tolist() == [True, True, True, False, True, True]


def test_a_trajectory_of_one_sample_and_one_that_is_not_finite_are_drawn(body, tmp_path):
    """No warning, no exception."""
    for n, state in enumerate(([[1.0], [0.0], [0.0]], [[1e200], [1e200], [0.0]])):
        arguments = (body.time[:1], np.array(state), body.parameters, "NONFINITE", "")
        Solution(body.system, *arguments).plot(tmp_path / f"{n}.png")
        assert (tmp_path / f"{n}.png").stat().st_size > 10_000


def test_an_unknown_ending_is_refused(body, tmp_path):
    """The message names file and endings."""
    with pytest.raises(KernelArgumentError, match=r"body\.docx.*\.png"):
        body.plot(tmp_path / "body.docx")


def test_a_folder_that_is_not_there_is_named(body, tmp_path):
    """Nothing is written elsewhere."""
    with pytest.raises(OutputError, match="missing"):
        body.plot(tmp_path / "missing" / "body.png")


def test_without_matplotlib_the_pip_command_is_shown(body, monkeypatch, tmp_path):
    """The extra is named."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(KernelArgumentError, match=r"coadjoint\[plot\]"):
        body.plot(tmp_path / "body.png")


def test_what_is_constant_has_one_colour():
    """Its roundings have none; what changes by more has all of them."""
    constant = 2.5 + 1e-12 * np.random.default_rng(0).normal(size=(4, 5))
    low, high = _choose_limits(constant)
    assert low < 1.3
    assert high > 3.7
    assert _choose_limits(np.zeros((2, 2))) == (-0.5, 0.5)
    assert _choose_limits(np.array([[1.0, 1.001]])) == (1.0, 1.001)
