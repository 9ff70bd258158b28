"""Pictures: drawn, on the sphere where there is one, and errors that say what to do."""

import sys

import numpy as np
import pytest

from coadjoint.cli.simulate import find_start
from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve.panels import PARTS, _choose_limits, draw_drift, list_panels
from coadjoint.solve.plot import plot
from coadjoint.solve.scenes import faces_viewer
from coadjoint.solve.solution import Solution
from coadjoint.systems import (
    elastic_chain,
    heavy_top,
    heisenberg_lattice,
    kdv,
    manakov_so6,
    n_body,
    rigid_body,
    se3_strand,
    so8_body,
    spin_chain_chiral,
    toda_lattice,
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


def test_components_are_drawn_where_there_is_no_sphere():
    """A top whose vertical is not conserved in length, by hand."""
    spoiled = heavy_top.simulate([0.3, 0, 2.0, 0.6, 0, 0.8], (0, 5), samples=50)
    spoiled.state[3:] *= np.linspace(1, 2, 50)
    labels = [text.get_text() for axes in plot_figure(spoiled).axes for text in legend(axes)]
    assert {"Π$_{1}$", "Γ$_{2}$", "Γ$_{3}$"} <= set(labels)


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


def test_many_names_of_drifts_leave_the_width_to_the_motion(monkeypatch):
    """Nine of them stand below; at the right they would take half of the width."""
    start = find_start(manakov_so6.system, ())
    motion = manakov_so6.simulate(start, (0, 1), samples=20, progress=False)
    assert len(motion.conserved) > 8

    def width():
        figure = plot_figure(motion)
        figure.draw_without_rendering()
        return figure.axes[0].get_position().width

    assert width() > 0.65
    given = draw_drift
    at_right = lambda axes, solution, **_: given(axes, solution, is_wide=True)  # noqa: E731
    monkeypatch.setattr("coadjoint.solve.panels.draw_drift", at_right)
    assert width() < 0.5


def test_many_members_are_colours_over_time():
    """A panel for each component, with a row for each member and a column for each sample."""
    spins = heisenberg_lattice.system.resize({"i": 30})
    state = np.vstack([np.cos(np.arange(30)), np.sin(np.arange(30)), np.zeros(30)]).ravel()
    motion = spins.simulate(state, (0, 1), samples=7)
    figure = plot_figure(motion)
    drawn = [axes.collections[0].get_array() for axes in figure.axes[:3]]
    assert np.array_equal(drawn, motion["S"])
    assert [axes.get_ylabel() for axes in figure.axes[:3]] == ["member"] * 3


def test_numbers_of_many_members_are_lines_in_the_order_of_members():
    """The particles of Toda's lattice: where most do not move yet, colours would be all alike."""
    start = find_start(toda_lattice.system, ())
    motion = toda_lattice.simulate(start, (0, 1), samples=5)
    (lines,) = plot(motion).axes[0].collections
    assert np.array_equal([piece[:, 1] for piece in lines.get_segments()], motion["q"])
    assert lines.get_array().tolist() == list(range(100))


@pytest.mark.parametrize("module", [spin_chain_chiral, se3_strand, toda_lattice])
def test_panels_and_the_strip_share_one_axis_of_time(module):
    """In each column all begin and end at the same places, and show the same times."""
    start = find_start(module.system, ())
    figure = plot(module.simulate(start, (0, 0.1), samples=5))
    figure.draw_without_rendering()
    panels = [axes for axes in figure.axes if hasattr(axes, "coadjoint_time")]
    assert len(panels) >= 3
    ends = {tuple(np.round(axes.get_position().intervalx, 6)) for axes in panels}
    assert len(ends) == 1 + (module is se3_strand)  # of thirteen panels, in two columns
    assert {axes.get_xlim() for axes in panels} == {(0.0, 0.1)}


def test_each_component_has_its_own_unit():
    """Of twelve rows of frames each third one is a place, in metres."""
    chain = elastic_chain.simulate(None, (0, 0.1), samples=5)
    labels = [each.label for each in list_panels(chain) if each.label.startswith("g$")]
    assert len(labels) == 12
    assert [label.endswith("[m]") for label in labels] == [False, False, False, True] * 3


def test_points_of_a_field_stand_at_their_places():
    """Rows are at s = 0, L/N, ...; below them is the energy per length, m^2/2."""
    wave = kdv.simulate(None, (0, 0.01), samples=3)
    field, energy = (axes for axes in plot(wave).axes[:2])
    assert field.get_ylabel() == energy.get_ylabel() == "s"
    (_, density) = list_panels(wave)
    np.testing.assert_allclose(density.places, 2 * np.arange(256) / 256, rtol=1e-15)
    np.testing.assert_allclose(density.values, wave["m"] ** 2 / 2, rtol=1e-14)
    np.testing.assert_allclose(density.values.sum(axis=0) * 2 / 256, wave["energy"], rtol=1e-14)


def test_a_strip_shows_the_largest_change_of_each_part_and_zero_at_its_edge(body):
    """No line is broken, and the axis has numbers, where the change is 0 at times."""
    motion = rigid_body.simulate([1.0, 0.3, -0.8], (0, 20), samples=2001)
    strip = plot(motion).axes[-1]
    line = strip.lines[0]
    change = np.abs(motion.change("energy")) / np.abs(motion["energy"]).max()
    floor, above = strip.get_ylim()
    assert (change == 0).any()
    assert len(line.get_ydata()) == PARTS
    assert np.isfinite(line.get_ydata()).all()
    assert line.get_ydata().max() == change.max() < above
    assert line.get_ydata().min() >= floor
    labels = [label.get_text() for label in strip.get_yticklabels()]
    assert labels[0] == "0"
    assert len(labels) >= 2
    rest = rigid_body.simulate([0.0, 0.0, 1.0], (0, 1), samples=5)  # nothing changes at all
    strip = plot(rest).axes[-1]
    assert set(strip.lines[0].get_ydata()) == {strip.get_ylim()[0]}
    assert "no change" in strip.lines[0].get_label()


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
