"""The kernels written by hand for the benchmarks compute what the generated ones do."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import sympy

from coadjoint.cli.arguments import load_system
from coadjoint.solve.methods import midpoint

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.fixture
def c_kernels(monkeypatch):
    """The benchmark of C kernels."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import c_kernels

    return c_kernels


def compare_by_hand(c_kernels, name, folder):
    """Compare C by hand, and the equations of the peers in SymPy, with generated C."""
    repeat = c_kernels.compiled("repeat", folder).repeat
    contest = c_kernels.Contest(name, folder, repeat)
    competitors = {"exact": contest.generated("exact"), "sympy": contest.by_sympy()}
    for n, flags in enumerate((c_kernels.FUSED[0], c_kernels.UNFUSED[0])):
        competitors[f"hand {n}"] = contest.by_hand(flags, f"hand{n}")
    c_kernels.check_equal(contest, competitors)


@pytest.mark.parametrize(
    "name",
    [
        *("rigid_body", "heavy_top", "kirchhoff", "chaplygin_ball"),
        *("so4_body", "so6_body", "so8_body"),
    ],
)
def test_generated_c_agrees_with_c_by_hand(name, c_kernels, tmp_path):
    """Rates typed from the book in C and generated ones differ by rounding alone."""
    compare_by_hand(c_kernels, name, tmp_path)
    assert name in c_kernels.SYSTEMS


@pytest.mark.parametrize(
    ("file", "name", "good", "bad"),
    [
        ("heavy_top.c", "heavy_top", "g2 * x3 - g3 * x2", "g2 * x3 + g3 * x2"),
        ("chaplygin_ball.c", "chaplygin_ball", "w1 * along - x1", "w1 * along + x1"),
        ("so_body.h", "so6_body", "sum -= w[i][k] * w[j][k]", "sum += w[i][k] * w[j][k]"),
    ],
)
def test_a_wrong_sign_by_hand_is_noticed(c_kernels, tmp_path, monkeypatch, file, name, good, bad):
    """The comparison can fail: turn one sign in the kernel by hand and it does."""
    shutil.copytree(c_kernels.HAND, tmp_path / "hand")
    kernel = tmp_path / "hand" / file
    text = kernel.read_text()
    assert good in text
    kernel.write_text(text.replace(good, bad))
    monkeypatch.setattr(c_kernels, "HAND", tmp_path / "hand")
    with pytest.raises(AssertionError, match="hand"):
        compare_by_hand(c_kernels, name, tmp_path)


PEER_SYSTEMS = ("rigid_body", "heavy_top", "kirchhoff", "chaplygin_ball", "so8_body")


@pytest.mark.parametrize("name", PEER_SYSTEMS)
def test_equations_of_the_peers_agree_with_generated_rates(name, monkeypatch):
    """Rates typed from the books for heyoka are those of the kernels, and a spoiled one is not."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import peers
    from ensembles import SYSTEMS as CASES

    states, values = peers.initial_states(name, 4), np.array(CASES[name][1], float)
    generated = load_system(name).rhs(states, values, target="numpy")
    by_hand = np.array(peers.EQUATIONS[name](states, values))
    assert np.abs(generated - by_hand).max() <= 1e-15 * 10
    values[1] *= 1.5
    assert np.abs(generated - peers.EQUATIONS[name](states, values)).max() > 1e-3


def test_equal_error_is_read_between_points_in_logarithms(monkeypatch):
    """From (1e-4, 1) to (1e-8, 100) the curve passes 10 at 1e-6; finer than all is None."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    from ensembles import Point, time_at

    points = [Point("x", 0.0, 0, (t, t, t), e, e) for t, e in ((1.0, 1e-4), (100.0, 1e-8))]
    assert time_at(points, 1e-6) == pytest.approx(10.0)
    assert time_at(points, 1e-3) == 1.0
    assert time_at(points, 1e-9) is None


@pytest.fixture
def ensembles(monkeypatch):
    """The benchmark of ensembles."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("ensembles")


@pytest.mark.parametrize(
    "name",
    [
        "rigid_body",
        "heavy_top",
        "kirchhoff",
        "chaplygin_ball",
        "so4_body",
        "so6_body",
        "so8_body",
    ],
)
def test_peers_have_the_equations_of_the_systems(name, ensembles, monkeypatch):
    """Rates typed from books are those of the systems; a sign that is turned is noticed."""
    peers = import_module("peers")
    states = peers.initial_states(name, 3)
    ensembles.check_equations(name, states)
    right = peers.EQUATIONS[name]
    monkeypatch.setitem(peers.EQUATIONS, name, lambda x, p: [-right(x, p)[0], *right(x, p)[1:]])
    with pytest.raises(AssertionError, match=name):
        ensembles.check_equations(name, states)


def test_times_are_read_between_points_of_the_curve(ensembles):
    """At equal error in logarithms; none where no point is so accurate."""
    point = import_module("results").Point
    points = [
        point(who="x", tolerance=None, order=0, microseconds=(t, t, t), error=e, worst=e)
        for t, e in ((1.0, 1e-4), (4.0, 1e-8))
    ]
    assert ensembles.time_at(points, 1e-6) == pytest.approx(2.0)
    assert ensembles.time_at(points, 1e-2) == 1.0
    assert ensembles.time_at(points, 1e-9) is None


@pytest.fixture
def benchmark_run(monkeypatch):
    """The script that runs all benchmarks."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("run")


def test_a_benchmark_that_fails_is_a_line_of_the_table(benchmark_run, capfd):
    """Others go on; the line has the exit status, and counts as missed."""
    (figure,) = benchmark_run.run("nothing_of_this_name")
    assert figure.met is False
    assert "exit status 1" in figure.measured
    assert "No module named 'nothing_of_this_name'" in capfd.readouterr().err


def test_names_of_benchmarks_are_checked_first(benchmark_run, capsys):
    """A name that is none is told with those that there are, each of which is a script."""
    assert benchmark_run.main(("rolling", "roling")) == 2
    told = capsys.readouterr().err
    assert "unknown: roling; expected" in told
    for name in benchmark_run.BENCHMARKS:
        assert name in told
        assert (BENCHMARKS / f"{name}.py").exists()


def test_operations_of_peers_are_those_that_move(monkeypatch):
    """What rests on parameters alone is left out, and a product that is shared counts once."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    operations = import_module("operations")
    x, y, p, q, a, b, c = sympy.symbols("x y p q a b c")
    lines = [(a, p * q), (b, x * y + a), (c, x * y * p + b**2)]
    # x*y; its sum with a; x*y*p, b*b and their sum
    assert operations.count(lines, {x, y}, sympy.cse) == 5
    assert operations.count(lines, {x, y, p}, sympy.cse) == 6


@pytest.mark.parametrize("name", ["heisenberg_lattice", "point_vortices"])
def test_kernels_of_families_by_hand_compute_the_same(monkeypatch, tmp_path, name):
    """For a number of members that fills no vector, in each way."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    families = import_module("families")
    contest = families.Contest(name, 21, tmp_path)
    found = contest.competitors(families.FUSED[:1])
    assert len(found) == 2 + len(families.WAYS[name])
    families.check_equal(contest, found)


@pytest.fixture
def methods(monkeypatch):
    """The benchmark of every method of every system."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return import_module("methods")


@pytest.mark.parametrize(
    ("name", "names", "compared"),
    [
        ("rigid_body", ("coadjoint_mean", "exact_body"),
         {"orders": 1, "maps": 2, "integrals": 3, "reversals": 2}),
        ("kepler", ("gauss8", "splitting"),
         {"orders": 2, "maps": 2, "integrals": 2, "reversals": 2}),
        ("chaplygin_ball", ("discrete_gradient",),
         {"orders": 1, "integrals": 1, "reversals": 1, "growths": 1}),
    ],
)  # fmt: skip
def test_methods_of_three_kinds_of_systems_do_what_is_claimed(methods, name, names, compared):
    """A momentum of a group, a canonical motion, and one with constraints."""
    rows = list(methods.measure_system(name, names))
    assert [row.found.method.name for row in rows] == [*names]
    assert [row.failures for row in rows] == [()] * len(rows)
    assert +sum((row.compared for row in rows), methods.Counter()) == compared


@pytest.mark.parametrize(
    ("half", "longer", "seen"),
    [
        (0.4, 0.0, ["its order is 1.0, and 2"]),
        (0.5, 0.1, ["its order is 1.0, and 2"]),
        (0.0, 0.0, []),
    ],
)
def test_a_spoiled_method_is_a_failure_of_the_table(methods, monkeypatch, half, longer, seen):
    """The midpoint short of the middle, in steps that are too long, and at the start: Euler's."""

    def sweep(self, arc, middle, kept):
        rise = arc.length * self.rates(arc.lanes, arc.middle, middle)
        following = arc.state + (arc.low + half * rise)
        return midpoint.Sweep(following, rise * (1 + longer * arc.length), False)

    monkeypatch.setattr(midpoint.Midpoint, "sweep", sweep)
    (row,) = methods.measure_system("rigid_body", ("midpoint",))
    for each in (*seen, "energy drifts by", "casimir1 drifts by", "leads back with an error"):
        assert [failure for failure in row.failures if each in failure], each
    assert row.list_cells()[-1] == "; ".join(row.failures)


def test_a_false_claim_of_a_poisson_map_is_a_failure(methods, monkeypatch):
    """Of the midpoint; maps that are similar to Poisson maps are told from them."""
    system = load_system("rigid_body")
    wrong = tuple(replace(x, is_poisson=x.name == "midpoint") for x in system.METHODS)
    monkeypatch.setattr(system, "METHODS", wrong)
    monkeypatch.setattr(methods, "load_system", lambda name: system)
    (row,) = methods.measure_system("rigid_body", ("midpoint",))
    assert [each for each in row.failures if "from a Poisson map" in each]
    assert min(methods.measure_controls().values()) > methods.SEEN


def test_constraints_that_are_eliminated_are_told_from_those_that_are_kept(monkeypatch):
    """Of velocities that are solved for no state is off them, so that nothing is measured."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    structure = import_module("structure")
    found = {name: structure.is_eliminated(load_system(name), None) for name in structure.ROLLING}
    assert [name for name, so in found.items() if not so] == ["suslov"]


def test_the_midpoint_with_plain_sums_is_another_text(monkeypatch, tmp_path):
    """Its energy drifts by more, which is asked before the times; without the text nothing runs."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    structure = import_module("structure")
    monkeypatch.setattr(structure, "TIMED", 1000)
    monkeypatch.setattr(structure, "MEMBERS", 512)
    (figure,) = structure.measure_compensation()
    assert re.search(r"energy: .* and 1[01]\.\d+ sweeps", figure.measured)
    monkeypatch.setattr(structure, "PLAIN", (("no such text", ""),))
    with pytest.raises(AssertionError, match="no such text"):
        structure.write_plain(tmp_path / "x")
