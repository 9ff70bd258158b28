"""Rates that are many products of two values: loops over one table of coefficients.

The expected values are those of dM/dt = [M, Omega] with Omega_ij = M_ij/(a_i + a_j), written with
matrices of NumPy (Holm 2011, Geometric Mechanics II, sections 2.4.2 to 2.4.5).
"""

import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from coadjoint.crosscheck.ladder import crosscheck
from coadjoint.crosscheck.parse_back import check_text
from coadjoint.derive import derive
from coadjoint.derive.formulas import rows_of
from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError, KernelArgumentError, LimitError
from coadjoint.lower import check, lowering
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import Program
from coadjoint.prove.declaration import kernel_context
from coadjoint.render.kernels import render_system
from coadjoint.render.targets import TARGETS
from coadjoint.solve.folders import load_folder
from coadjoint.spec import read_spec, read_spec_text
from tests.specs import emitted

EXAMPLE = Path(__file__).parents[2] / "examples" / "so9_body.toml"
SPEC = """
title = "Free body"
routes = ["euler-poincare"]

[algebra]
name = "so({n})"

[variables]
Omega = {{ role = "velocity", form = "antisymmetric" }}
M = {{ role = "momentum", form = "antisymmetric" }}

[parameters]
a = {{ shape = [{n}], positive = true, default = {default} }}

[lagrangian]
l = "trace(transpose(Omega)*diag(a)*Omega)/2"
"""


@cache
def equations(n):
    """A free body in R^n, by the quadratic form of its kinetic energy."""
    text = SPEC.format(n=n, default=list(range(1, n + 1)))
    return derive(read_spec_text(text, Path(f"body{n}.toml")))


@cache
def programs(n, most=lowering.UNROLLED_PRODUCTS):
    """Its Programs, as if products were written out up to a number of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lowering, "UNROLLED_PRODUCTS", most)
        return lowering.lower(equations(n))


@cache
def texts(n, most=lowering.UNROLLED_PRODUCTS):
    """Its generated files."""
    return render_system(kernel_context(equations(n), programs(n, most)))


def load(n, most, folder):
    """Its System."""
    folder = folder / f"body{n}"
    folder.mkdir()
    for file, text in texts(n, most).items():
        (folder / file).write_text(text)
    return load_folder(folder)


@pytest.fixture(scope="module")
def nine(tmp_path_factory):
    """The body in nine dimensions, the smallest that has loops."""
    return load(9, lowering.UNROLLED_PRODUCTS, tmp_path_factory.mktemp("loops"))


def rates(state, a):
    """[M, Omega] of one member above the diagonal, by matrices."""
    places = np.triu_indices(len(a), 1)
    M = np.zeros((len(a), len(a)), dtype=np.asarray(state).dtype)
    M[places] = state
    M = M - M.T
    Omega = M / np.add.outer(a, a)
    return (M @ Omega - Omega @ M)[places]


def points(n, members, seed=1):
    """States, vectors and parameters of some members."""
    source, size = np.random.default_rng(seed), n * (n - 1) // 2
    state, vector = source.normal(size=(2, size, members))
    return state, vector, source.uniform(1, 2, size=(n, members))


# -- which systems have loops ---------------------------------------------------------------------


def test_rates_are_loops_from_so9_on():
    """so(n) has n(n-1)(n-2) products: 336 for so(8), which is written out, and 504 for so(9)."""
    assert programs(8)["rhs"].table is None
    assert "jacobian" in programs(8)
    table = programs(9)["rhs"].table
    assert len(table.entries) == 9 * 8 * 7
    assert {abs(c) for *_, c in table.entries} == {Fraction(1)}
    assert list(programs(9)) == ["rhs", "jacobian_vector", "energy", "observables"]


def test_energy_and_observables_are_loops_over_the_same_values():
    """M Omega/2 for each plane, and velocities times 1; the example has its Casimir, too."""
    own = programs(9)
    values = own["rhs"].table.vectors
    assert own["energy"].table.vectors == own["observables"].table.vectors == values
    assert own["energy"].table.entries == tuple((0, 36 + k, k, Fraction(1, 2)) for k in range(36))
    assert (1, 36, len(values[0]), 1) in own["observables"].table.entries
    body = lowering.lower(derive(read_spec(EXAMPLE)))
    assert body["rhs"].table.entries == own["rhs"].table.entries
    rows = {row for row, j, k, c in body["observables"].table.entries if j == k < 36 and c == 1}
    assert [body["observables"].outputs[row].label for row in rows] == ["casimir1"]


def test_an_observable_of_another_form_is_written_out():
    """A power of four is no product of two values; the energy is a loop all the same."""
    text = SPEC.format(n=4, default=[1, 2, 3, 4]) + '\n[observables]\nfour = "M12^4"\n'
    other = derive(read_spec_text(text, Path("four.toml")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lowering, "UNROLLED_PRODUCTS", 0)
        found = lowering.lower(other)
    assert found["energy"].table
    assert found["observables"].table is None
    check.check_programs(other, found)


@pytest.mark.parametrize("name", ["heavy_top", "so8_body", "kirchhoff", "n_particles"])
def test_other_rates_are_written_out(name):
    """Terms with other factors, and few products, stay formulas."""
    assert lowering._loop(emitted(name)) is None


def test_a_velocity_of_another_form_is_written_out():
    """A kinetic energy that couples velocities makes sums of them, for which there is no loop."""
    text = SPEC.format(n=4, default=[1, 2, 3, 4]).replace(
        "*Omega)/2", "*Omega)/2 + Omega12*Omega34/8"
    )
    coupled = derive(read_spec_text(text, Path("coupled.toml")))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lowering, "UNROLLED_PRODUCTS", 0)
        assert lowering._loop(coupled) is None
        assert lowering._loop(equations(4)) is not None


def test_a_table_that_is_too_large_is_refused_before_it_is_proved(monkeypatch):
    """The message names the limit; the pipeline checks sizes between lowering and proving."""
    monkeypatch.setattr(check, "TABLE_ENTRIES", 500)
    with pytest.raises(LimitError, match=r"rhs takes 504 entries .* at most 500 \(TABLE_ENTRIES\)"):
        check.check_sizes(equations(9), programs(9))


# -- what they compute ----------------------------------------------------------------------------


@pytest.mark.parametrize("n", [4, 12, pytest.param(20, marks=pytest.mark.campaign)])
def test_loops_compute_the_bracket_of_matrices(n):
    """The Program of so(12), and that of so(20), at a point; so(4) by loops, too."""
    found = programs(n, 0)["rhs"]
    assert found.table is not None
    check.check_sizes(equations(n), {"rhs": found})
    check.check_inverse(equations(n), found)
    state, _, a = (part[:, 0] for part in points(n, 1))
    given = dict(zip(found.names, map(float, (*state, *a)), strict=True))
    values = run(found, given, float, None)
    np.testing.assert_allclose(values, rates(state, a), atol=1e-13)


def test_both_forms_are_one_function():
    """so(5) by loops and written out, and its Jacobian times a vector."""
    looped, written = programs(5, 0), programs(5)
    assert looped["rhs"].table
    assert "jacobian" in written
    assert "jacobian_vector" in looped
    state, vector, a = (part[:, 0] for part in points(5, 1))
    given = dict(zip(written["rhs"].names, map(float, (*state, *a)), strict=True))
    values = [run(each["rhs"], given, float, None) for each in (looped, written)]
    np.testing.assert_allclose(*values, atol=1e-14)
    matrix = np.array(run(written["jacobian"], given, float, None)).reshape(10, 10)
    along = looped["jacobian_vector"]
    given |= dict(zip(along.state[10:], map(float, vector), strict=True))
    found = run(along, given, float, None)
    np.testing.assert_allclose(found, matrix @ vector, atol=1e-13)


@pytest.mark.parametrize("target", ["c", "c-fast", "numpy", "python"])
def test_kernels_compute_the_bracket(nine, target):
    """All targets, an odd number of members, parameters of each and shared ones."""
    state, vector, a = points(9, 19)
    expected = np.stack([rates(x, p) for x, p in zip(state.T, a.T, strict=True)], axis=1)
    np.testing.assert_allclose(nine.rhs(state, a, target=target), expected, atol=1e-14)
    shared = np.stack([rates(x, a[:, 0]) for x in state.T], axis=1)
    np.testing.assert_allclose(nine.rhs(state, a[:, 0], target=target), shared, atol=1e-14)
    step = 1e-20  # the rates are quadratic, so that a complex step has no error but rounding
    pairs = zip(state.T, vector.T, a.T, strict=True)
    slopes = np.stack([rates(x + 1j * step * v, p).imag / step for x, v, p in pairs], axis=1)
    found = nine.jacobian_vector(state, vector, a, target=target)
    np.testing.assert_allclose(found, slopes, atol=1e-13)
    i, j = np.triu_indices(9, 1)
    omega = state / (a[i] + a[j])
    energy = (state * omega).sum(axis=0) / 2
    np.testing.assert_allclose(nine.energy(state, a, target=target), energy, rtol=1e-14)
    found = nine.observables(state, a, target=target)
    np.testing.assert_allclose(found, [energy, *omega], rtol=1e-14)


def test_the_ladder_holds_loops(tmp_path):
    """Rungs 2 to 5 run and pass for so(5) by loops, its solvers among them."""
    system, reference = load(5, 0, tmp_path), Reference(equations(5))
    report = crosscheck(programs(5, 0), texts(5, 0), reference, system, bit_points=300)
    assert report.passed
    assert report.lines["jacobian_vector"]
    assert report.solvers["solver"].coefficients
    assert set(report.solvers["solver"].equal) == {"taylor", "dop853", "rk4", "midpoint"}


# -- what is caught -------------------------------------------------------------------------------


def spoil(program: Program, **changes):
    """A Program with another table."""
    table = replace(program.table, **changes)
    outputs = zip(program.outputs, table.sums(), strict=True)
    values = tuple(replace(output, value=value) for output, value in outputs)
    return replace(program, outputs=values, table=table)


WRONG = [(each, change) for each in ("rhs", "jacobian_vector") for change in ("sign", "row")]
WRONG += [(each, "factor") for each in ("rhs", "jacobian_vector", "energy", "observables")]


@pytest.mark.parametrize(("function", "change"), [*WRONG, ("energy", "sign")])
def test_a_wrong_entry_is_caught(function, change):
    """One coefficient, one factor or one row in the table of so(5)."""
    program = programs(5, 0)[function]
    check.check_inverse(equations(5), program)
    first, *others = program.table.entries
    i, j, k, c = first
    wrong = {"sign": (i, j, k, -c), "factor": (i, j + 1, k, c), "row": (i + 1, j, k, c)}[change]
    with pytest.raises(CrossCheckError, match=f"lowering changed {function}"):
        check.check_inverse(equations(5), spoil(program, entries=(wrong, *others)))


def test_a_wrong_order_of_passes_is_caught():
    """Both passes with the slopes on the left give another function."""
    along = programs(5, 0)["jacobian_vector"]
    with pytest.raises(CrossCheckError, match="lowering changed jacobian_vector"):
        check.check_inverse(equations(5), spoil(along, passes=((1, 0), (1, 0))))


def _replace_entry(text, table, old, new):
    """A text with the first number of a table changed."""
    found = re.search(rf"table_{table}\W.*?[{{(]\s*({re.escape(old)}),", text, re.S | re.I)
    return text[: found.start(1)] + new + text[found.end(1) :]


@pytest.mark.parametrize("target", TARGETS.values(), ids=lambda target: target.kernel)
def test_a_text_with_another_table_is_caught(target):
    """Each part of the table, and a scale, in the texts of so(5)."""
    rhs, text = programs(5, 0)["rhs"], texts(5, 0)[target.kernel]
    assert check_text(rhs, target, text, "body5")
    entry, sign = rhs.table.entries[0], {1: "1.0", -1: "-1.0"}
    wrong = [
        _replace_entry(text, "coefficients", sign[entry[3]], sign[-entry[3]]),
        _replace_entry(text, "left", str(entry[1]), str(entry[1] + 1)),
        _replace_entry(text, "right", str(entry[2]), str(entry[2] - 1)),
        _replace_entry(text, "starts", "0", "1"),
        _replace_entry(text, "scaled", "0", "1"),
    ]
    for spoiled in wrong:
        assert spoiled != text
        with pytest.raises(CrossCheckError, match="rung 3"):
            check_text(rhs, target, spoiled, "body5")


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernel.c", "coefficients[entry] * left[n]", "coefficients[entry] * right[n]"),
        ("kernel.c", "scales[place][n] *", "scales[place][0] *"),
        ("kernel.c", "{_vector0, _vector0},", "{_vector0, _vector1},"),
        ("kernel.c", "state + 0 * ROWS", "state + 1 * ROWS"),
        ("kernel.c", "add_products(0, 10, 1, _passes", "add_products(0, 10, 0, _passes"),
        ("kernel.c", "add_products(0, 10, 1, _passes", "add_products(1, 10, 1, _passes"),
        ("kernel.c", "vector[VALUES][n] = 1.0", "vector[VALUES][n] = 2.0"),
        ("kernel.c", "_scales[1][_n] = _p", "_scales[1][_n] = 2.0 * _p"),
        ("kernel.c", "ROWS = 10", "ROWS = 9"),
        ("kernel.py", "entries = starts[rows] + place", "entries = starts[rows]"),
        ("kernel.py", "[(vector0, vector0)]", "[(vector0, vector0), (vector0, vector0)]"),
        ("kernel.py", "_fill_vector(state[0:10]", "_fill_vector(state[1:11]"),
        ("kernel.py", "TABLE_SCALED, strict", "TABLE_LEFT, strict"),
        ("kernel_python.py", "total += ", "total -= "),
        ("kernel_python.py", "scales = (\n        _p", "scales = (\n        2.0 * _p"),
    ],
)
def test_a_text_that_loops_otherwise_is_caught(file, old, new):
    """The loops themselves are those of the template, letter by letter."""
    target = next(each for each in TARGETS.values() if each.kernel == file)
    text = texts(5, 0)[file]
    assert old in text
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_text(programs(5, 0)["rhs"], target, text.replace(old, new), "body5")


# -- what a person meets --------------------------------------------------------------------------


def test_a_matrix_is_refused_with_what_is_there(nine):
    """The Jacobian of so(9) is not written out; the message says what to call."""
    state = np.ones(36)
    for name in ("jacobian", "poisson_tensor", "parameter_jacobian"):
        with pytest.raises(KernelArgumentError, match=r"take jacobian_vector\(state, vector\)"):
            getattr(nine, name)(state)
    with pytest.raises(KernelArgumentError, match=r"no function 'projection'; .*observables\.$"):
        nine.projection(state)


def test_the_vector_is_of_the_shape_of_the_state(nine):
    """Another shape is refused; a batch, a mapping and `evaluate` give the same numbers."""
    state, vector, a = points(9, 3)
    with pytest.raises(KernelArgumentError, match=r"the vector \(36,\); expected the same"):
        nine.jacobian_vector(state, vector[:, 0])
    with pytest.raises(KernelArgumentError, match=r"shape of vector of body9 is \(35, 3\)"):
        nine.jacobian_vector(state, vector[1:])
    found = nine.jacobian_vector({"M": state}, {"M": vector}, a)
    stacked = np.concatenate([state, vector])
    assert (found == nine.evaluate("jacobian_vector", stacked, a)).all()
    assert not nine.jacobian_vector(state, 0 * vector, a).any()


def test_integrators_of_others_get_a_matrix(nine):
    """`ode` and the implicit methods of SciPy put the Jacobian together, column by column."""
    state, vector, a = (part[:, 0].copy() for part in points(9, 1))
    matrix = nine.ode(a).jac(0.0, state)
    np.testing.assert_allclose(matrix @ vector, nine.jacobian_vector(state, vector, a), atol=1e-13)
    run = nine.simulate(state, (0, 0.1), a, method="scipy:Radau", samples=3, rtol=1e-8)
    assert run.drift["energy"] < 1e-7


def test_generated_solvers_follow_the_motion(nine):
    """`auto` is the generated Taylor method, for one and for many; SciPy and matrices agree."""
    state, _, a = points(9, 19)
    alone = nine.simulate(state[:, 0], (0, 1), a[:, 0], samples=3, rtol=1e-12)
    assert alone.method == "taylor"
    assert alone.drift["energy"] < 1e-12
    many = nine.simulate(state, (0, 1), a, samples=3, rtol=1e-12, target="numpy")
    np.testing.assert_array_equal(many.state[:, 0], alone.state)
    for method in ("dop853", "scipy:DOP853"):
        run = nine.simulate(state[:, 0], (0, 1), a[:, 0], samples=3, rtol=1e-11, method=method)
        np.testing.assert_allclose(run.state, alone.state, atol=1e-8)
    known = np.linalg.eigvalsh(1j * _matrix(state[:, 0], 9))  # the motion is isospectral
    found = np.linalg.eigvalsh(1j * _matrix(alone.state[:, -1], 9))
    np.testing.assert_allclose(found, known, atol=1e-11)


def _matrix(state, n):
    """An antisymmetric matrix from what is above its diagonal."""
    M = np.zeros((n, n))
    M[np.triu_indices(n, 1)] = state
    return M - M.T


def test_rows_name_the_vector():
    """The first argument of the function holds the state, and the vector below it."""
    rows = rows_of(equations(4), "jacobian_vector")
    assert rows.state[:6] == equations(4).setting.state
    assert rows.state[6:] == rows.along
    assert len(rows.lines) == 6
    assert rows.shape == (6,)
