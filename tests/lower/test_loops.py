"""Solves that are loops: the same as written out, in texts, in recurrences, against truths."""

import random
from dataclasses import replace
from decimal import localcontext
from functools import partial

import numpy as np
import pytest

import coadjoint
from coadjoint.crosscheck import recurrences
from coadjoint.crosscheck.oracle import CONTEXT, call, exact
from coadjoint.crosscheck.parse_back import check_text
from coadjoint.crosscheck.replay import Replayed
from coadjoint.crosscheck.series import solve
from coadjoint.crosscheck.solver_text import SolverTexts, check_solver_texts
from coadjoint.derive import derive
from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError
from coadjoint.exact.residues import Residue, call_modulo, residue
from coadjoint.lower.check import call_residue, check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Add, Factors, Negate, Solution
from coadjoint.prove.certificate import Verdict
from coadjoint.render.solvers import arrange, select_programs
from coadjoint.render.targets import TARGETS
from coadjoint.solve.folders import load_texts
from coadjoint.solver_kinds import SOLVER
from coadjoint.spec import read_spec
from tests.derive.test_routes import COUPLED
from tests.specs import lowered, render_claims, shipped, spec

#: What says from how many unknowns on a solve is a loop.
WRITTEN = "coadjoint.derive.mechanics.solver.WRITTEN"
PRIME = 2**61 - 1


@pytest.fixture(scope="module")
def chain():
    """Four links by a loop of four rows."""
    plain = lowered("n_link_chain")
    assert not plain["rhs"].solves_by_loop
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WRITTEN, 3)
        yield render_claims(read_spec(shipped("n_link_chain").path))


@pytest.fixture(scope="module")
def fluid():
    """A body in a fluid, whose six velocities a loop finds of its momenta."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WRITTEN, 3)
        yield render_claims(spec(COUPLED))


def at_random(program, seed=1):
    """Residues for all inputs."""
    source = random.Random(seed)
    return {name: Residue(source.randrange(1, PRIME)) for name in program.names}


@pytest.mark.parametrize("name", ["rhs", "jacobian", "parameter_jacobian"])
def test_loops_compute_what_is_written_out(chain, name):
    """Modulo a prime; each column of a Jacobian is one solve more, but that of the mass is zero."""
    looped, written = chain.programs[name], lowered("n_link_chain")[name]
    kinds = [type(each.value) for each in looped.statements]
    assert kinds.count(Factors) == 1
    assert kinds.count(Solution) == {"rhs": 1, "jacobian": 9, "parameter_jacobian": 3}[name]
    number, apply = partial(residue, prime=PRIME), partial(call_residue, prime=PRIME)
    inputs = at_random(looped)
    found, wanted = (run(each, inputs, number, apply) for each in (looped, written))
    assert found == wanted
    assert any(each.value for each in found)


def test_loops_solve_for_multipliers_too(monkeypatch):
    """Accelerations with the multiplier of a constraint that is kept, and the signs of pivots."""
    written = lowered("knife_edge_cvt")
    for module in ("solver", "kinematics"):
        monkeypatch.setattr(f"coadjoint.derive.mechanics.{module}.WRITTEN", 1)
    equations = derive(read_spec(shipped("knife_edge_cvt").path))
    looped = lower(equations)  # what is written out knows that sin^2 + cos^2 = 1
    for name in ("rhs", "jacobian", "projection", "domain"):
        assert looped[name].solves_by_loop
        check_inverse(equations, looped[name])
        inputs = at_random(looped[name])
        found, wanted = (
            run(each[name], inputs, residue, call_modulo) for each in (looped, written)
        )
        assert found == wanted


def spoil_statement(program, kind, change):
    """The Program with one loop changed."""
    statements = [
        replace(each, value=change(each.value)) if isinstance(each.value, kind) else each
        for each in program.statements
    ]
    assert statements != [*program.statements]
    return replace(program, statements=tuple(statements))


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        (Factors, lambda value: replace(value, entries=(*value.entries[1:], value.entries[0]))),
        (Solution, lambda value: replace(value, known=value.known[::-1])),
        (Solution, lambda value: replace(value, known=(Negate(value.known[0]), *value.known[1:]))),
    ],
)
def test_a_loop_over_other_numbers_is_caught(chain, kind, change):
    """Lowering undone: the Program against the equations, modulo primes."""
    program = chain.programs["rhs"]
    check_inverse(chain.equations, program)
    with pytest.raises(CrossCheckError, match="lowering changed rhs"):
        check_inverse(chain.equations, spoil_statement(program, kind, change))


def test_the_certificate_says_that_it_is_a_loop(chain, fluid):
    """With the theorem it rests on; the energy is proved without an inverse, on both roads."""
    claims = {each.statement: each for each in chain.certificate.claims}
    text = "the kernel solves for the accelerations: L D L^T = B^T M B, by a loop over 4 rows"
    assert text + ", for n = 4" in claims
    assert "Golub and Van Loan" in claims[text + ", for n = 4"].method
    for rendered in (chain, fluid):
        assert all(each.verdict is Verdict.PROVED for each in rendered.certificate.claims)
        assert rendered.equations.loops
    assert claims["the energy is conserved, for n = 4"].verdict is Verdict.PROVED


# -- texts ----------------------------------------------------------------------------------------


def check_kernels(rendered, texts, system="n_link_chain"):
    """Rung 3 of every target and function."""
    return sum(
        check_text(program, target, texts[target.kernel], system)
        for program in rendered.programs.values()
        for target in TARGETS.values()
    )


KERNELS = [
    ("kernel.c", "row[k] -= column[i] * lower[k];", "row[k] += column[i] * lower[k];"),
    ("kernel.c", "enum { COUPLED = 4 };", "enum { COUPLED = 3 };"),
    ("kernel.c", "x[i] -= entries[k * (k + 1) / 2 + i] * last;", "x[i] -= last;"),
    ("kernel.c", "coadjoint_solve(", "coadjoint_factor("),
    ("kernel.c", ", 4);", ", 3);"),
    ("kernel.c", "[10];", "[9];"),
    ("kernel.c", "[9] = ", "[8] = "),
    ("kernel.py", "column[i] * rows[below[k]]", "column[k] * rows[below[k]]"),
    ("kernel.py", "x /= rows[starts + np.arange(size)]", "x /= rows[starts]"),
    ("kernel.py", "[0.0] * 10", "[0.0] * 11"),
    ("kernel.py", "_factor(_", "_solve(_"),
    ("kernel_python.py", "known[i] /= factors[i * (i + 3) // 2]", "known[i] /= factors[i]"),
    ("kernel_python.py", "entries[place + k + 1] -= column[i]", "entries[place + k] -= column[i]"),
]


def test_texts_of_loops_read_back(chain):
    """Every function of every target."""
    assert check_kernels(chain, chain.texts) > 300


@pytest.mark.parametrize(("file", "good", "bad"), KERNELS)
def test_a_wrong_loop_in_a_kernel_is_caught(chain, file, good, bad):
    """In the part that all share, and in the lines of the system."""
    at = chain.texts[file].index("(\n", 0) if good.startswith(("[", ",", "_factor(_")) else 0
    text = chain.texts[file]
    place = text.index(good, text.index("_rhs(") if at else 0)
    wrong = text[:place] + bad + text[place + len(good) :]
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_kernels(chain, {**chain.texts, file: wrong})


SOLVERS = [
    ("solver.c", "row[k] -= column[i] * lower[k];", "row[k] -= column[k] * lower[i];"),
    ("solver.c", "coadjoint_solve(_", "coadjoint_factor(_"),
    ("solver.py", "x[:k] -= rows[starts[k] : starts[k] + k] * x[k]", "x[:k] -= x[k]"),
    ("solver.py", "_solve(_", "_factor(_"),
]


def solver_texts(rendered, texts):
    """The solvers of a system as texts."""
    programs = hold_sides(select_programs(rendered.programs.values()))
    return SolverTexts(
        programs=programs,
        recurrences=arrange(programs),
        strict=(),
        files={file: texts[file] for file in SOLVER.files},
        system="n_link_chain",
    )


def test_solvers_with_loops_read_back(chain):
    """Recurrences and rates, with the loops themselves."""
    assert check_solver_texts(solver_texts(chain, chain.texts)) > 300


@pytest.mark.parametrize(("file", "good", "bad"), SOLVERS)
def test_a_wrong_loop_in_a_solver_is_caught(chain, file, good, bad):
    """In the part that all share, and in the lines of the system."""
    assert good in chain.texts[file]
    wrong = {**chain.texts, file: chain.texts[file].replace(good, bad, 1)}
    with pytest.raises(CrossCheckError, match=r"rung 3|line"):
        check_solver_texts(solver_texts(chain, wrong))


def test_kernels_have_equal_bits(fluid):
    """NumPy, C and plain Python, for one member and for some."""
    source = np.random.default_rng(1)
    state, parameters = source.standard_normal((6, 5)), 0.1 * source.standard_normal(9)
    with load_texts(fluid.texts) as system:
        results = [
            system.rhs(state, parameters, target=target) for target in ("numpy", "c", "python")
        ]
        alone = system.rhs(state[:, 2], parameters, target="numpy")
    assert np.isfinite(results[0]).all()
    assert np.ptp(results[0]) > 0.1
    for other in results[1:]:
        np.testing.assert_array_equal(results[0], other)
    np.testing.assert_array_equal(results[0][:, 2], alone)


# -- recurrences ----------------------------------------------------------------------------------


def series_defect(rendered, text, order=5):
    """The largest difference of coefficients from the power series of the equations."""
    program = rendered.programs["rhs"]
    state = {name: 0.3 * (n + 1) - 0.7 for n, name in enumerate(program.state)}
    given = {name: (1.0 + 0.25 * n,) for n, name in enumerate(program.parameters)}
    reference = Replayed(Reference(rendered.equations))
    wanted = solve(partial(reference.evaluate, "rhs"), state, given, order)
    with localcontext(CONTEXT):
        start = {name: exact(value) for name, value in state.items()}
        fixed = {name: tuple(map(exact, values)) for name, values in given.items()}
        found = recurrences.run_recurrences(text, start, fixed, order, exact, call)
        return max(
            abs(one.value - other)
            for name in state
            for one, other in zip(found[name], wanted[name], strict=True)
        )


def test_recurrences_are_the_power_series(chain):
    """Each order solves with the factors of order 0; a sum of the wrong sign is seen."""
    text = arrange(select_programs(chain.programs.values()))
    assert text.unknowns == 4
    lines = [line for stage in text.stages for line in stage.lines]
    assert not any(isinstance(line.value, Factors) for line in lines)
    assert sum(isinstance(line.value, Solution) for line in lines) == 1
    assert series_defect(chain, text) < 1e-45
    stages = [replace(stage, lines=tuple(map(turn_sum, stage.lines))) for stage in text.stages]
    assert series_defect(chain, replace(text, stages=tuple(stages))) > 1e-3


def turn_sum(line):
    """A right side to which the sums are added."""
    if not isinstance(line.value, Solution):
        return line
    first, *rest = line.value.known
    assert isinstance(first, Add)
    assert isinstance(first.right, Negate)
    turned = Add(first.left, first.right.operand)
    return replace(line, value=replace(line.value, known=(turned, *rest)))


# -- truths ---------------------------------------------------------------------------------------

LINKS = 13


@pytest.fixture(scope="module")
def links():
    """Thirteen links, whose solve is a loop."""
    equations = derive(read_spec(shipped("n_link_chain").path, {"i": LINKS}))
    assert equations.loops
    return Reference(equations)


def float_call(function, *arguments):
    """A function of floats."""
    return getattr(np, function)(*arguments)


def evaluate(reference, function, state, parameters):
    """A function of the kernel by the equations, in floats."""
    names = (*reference.state, *reference.parameters)
    inputs = dict(zip(names, map(float, (*state, *parameters)), strict=True))
    return np.array(reference.evaluate(function, inputs, float, float_call))


def test_thirteen_links_hang_with_the_roots_of_laguerre(links):
    """Squares of the frequencies are ``(g/l)`` times the roots of ``L_13``, by small angles."""
    small, size = 1e-5, range(LINKS)
    columns = [
        evaluate(links, "rhs", [small * (k == n) for k in range(2 * LINKS)], (1.3, 0.7, 9.0))
        for n in size
    ]
    squares = np.sort(np.linalg.eigvals(-np.array(columns).T[LINKS:] / small).real)
    roots = np.polynomial.laguerre.lagroots([0] * LINKS + [1])
    assert np.allclose(squares, roots * 9.0 / 0.7, rtol=1e-6)
    assert not np.allclose(squares, roots * 9.1 / 0.7, rtol=1e-6)


def cartesian_accelerations(theta, omega, m, length, g):
    """Of the angles: masses pulled by their weights and by tensions along links of fixed length."""
    n = len(theta)
    along = np.array([np.sin(theta), -np.cos(theta)])  # (2, n): from the upper end to the lower one
    # r_k - r_(k-1) = length along_k; its second derivative along the link is -length omega_k^2
    gram, sides = np.zeros((n, n)), np.zeros(n)
    weight = np.array([0.0, -g])
    for k in range(n):
        # m r_k'' = m g - T_k along_k + T_(k+1) along_(k+1)
        below = {k: -along[:, k]} | ({k + 1: along[:, k + 1]} if k + 1 < n else {})
        above = {k - 1: -along[:, k - 1], k: along[:, k]} if k else {}
        for row, force in below.items():
            gram[k, row] += force @ along[:, k] / m
        for row, force in above.items():
            gram[k, row] -= force @ along[:, k] / m
        free = 0 if k else weight @ along[:, k]
        sides[k] = -length * omega[k] ** 2 - free
    tensions = np.linalg.solve(gram, sides)
    pulls = -tensions * along
    pulls[:, :-1] += (tensions * along)[:, 1:]
    moved = pulls / m + weight[:, np.newaxis]
    relative = np.diff(moved, axis=1, prepend=0)
    across = np.array([np.cos(theta), np.sin(theta)])
    return np.sum(relative * across, axis=0) / length


def test_thirteen_links_move_as_masses_with_tensions(links):
    """In Cartesian coordinates; a mass that is another is noticed."""
    source = np.random.default_rng(2)
    theta, omega = source.uniform(-1, 1, LINKS), source.uniform(-1, 1, LINKS)
    rates = evaluate(links, "rhs", (*theta, *omega), (1.3, 0.7, 9.0))
    wanted = cartesian_accelerations(theta, omega, 1.3, 0.7, 9.0)
    assert np.allclose(rates[LINKS:], wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
    other = cartesian_accelerations(theta, omega, 1.3, 0.7, 9.1)
    assert not np.allclose(rates[LINKS:], other, rtol=1e-6)


@pytest.mark.campaign  # 4 to 6 minutes of processor time
def test_thirty_links_are_loaded_and_move_as_masses_with_tensions():
    """With more time than a load takes by itself, every rung of the ladder included."""
    count = 30
    system = coadjoint.load(shipped("n_link_chain").path, sizes={"i": count}, seconds=900)
    source = np.random.default_rng(3)
    theta, omega = source.uniform(-1, 1, count), source.uniform(-1, 1, count)
    rates = system.rhs([*theta, *omega], {"m": 1.3, "l": 0.7, "g": 9.0})
    wanted = cartesian_accelerations(theta, omega, 1.3, 0.7, 9.0)
    assert np.allclose(rates[count:], wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
    assert rates[:count].tolist() == omega.tolist()
