"""Three unknowns by minors: exact in fractions, accurate in doubles, two quotients not three."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from random import Random

import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.errors import CrossCheckError
from coadjoint.exact import Field
from coadjoint.lower.check import check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.graph import Graph
from coadjoint.lower.lowering import lower
from coadjoint.lower.minors import entries_of, find_solve, solve_by_minors
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Add, Negate, Statement
from coadjoint.render.solvers import arrange, select_programs
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec

NAMES = ("A", "B", "C", "D", "E", "F", "u", "v", "w")
ROWS = ("A", "BC", "DEF")


@cache
def program():
    """The Program that solves a symmetric system of symbols."""
    field = Field([*NAMES, "x", "y", "z"])
    matrix = [[field[ROWS[max(i, j)][min(i, j)]] for j in range(3)] for i in range(3)]
    solve = Solve(matrix, [field[name] for name in "uvw"], (0, 1, 2), "xyz")
    rows = [(f"row {name}", field[name]) for name in "xyz"]
    graph = Graph()
    entries = {label: graph.symbol(str(value)) for label, value in entries_of(solve, rows)}
    lines, results = solve_by_minors(graph, solve, entries, rows)
    return Naming(graph, lines, results, ()).program("rhs", (3,), state=NAMES, parameters=())


def solve_numbers(matrix, known, number=Fraction):
    """What the Program makes of numbers."""
    given = [matrix[i][j] for i in range(3) for j in range(i + 1)] + list(known)
    values = dict(zip(NAMES, map(number, given), strict=True))
    return run(program(), values, number, lambda function, argument: None)


def draw_ball(source, arm, inertia):
    """``I + m (s^2 - s s^T)`` and a known side: diag(I) and a form that is singular along s."""
    s = [arm * source.uniform(-1, 1) for _ in range(3)]
    square = sum(each * each for each in s)
    matrix = [[-s[i] * s[j] for j in range(3)] for i in range(3)]
    for i in range(3):
        matrix[i][i] += square + inertia * source.uniform(0.5, 2)
    return matrix, [source.uniform(-1, 1) for _ in range(3)]


def determinant(m):
    """By the rule of Sarrus."""
    return sum(
        m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3])
        for i in range(3)
    )


def invert(matrix):
    """The inverse by cofactors, in fractions."""
    m = [[Fraction(each) for each in row] for row in matrix]
    whole = determinant(m)
    unit = [[Fraction(int(i == j)) for j in range(3)] for i in range(3)]
    return [
        [determinant([unit[j] if k == i else m[k] for k in range(3)]) / whole for i in range(3)]
        for j in range(3)
    ]


def test_fractions_solve_exactly():
    """A x = b holds without a rounding, for random symmetric systems."""
    source = Random(1)
    for _ in range(20):
        known = [Fraction(source.randint(-9, 9), source.randint(1, 9)) for _ in range(3)]
        entry = {(i, j): Fraction(source.randint(1, 99), 7) for i in range(3) for j in range(i + 1)}
        matrix = [[entry[max(i, j), min(i, j)] for j in range(3)] for i in range(3)]
        x = solve_numbers(matrix, known)
        for row, expected in zip(matrix, known, strict=True):
            assert sum(a * b for a, b in zip(row, x, strict=True)) == expected


def test_there_are_two_quotients_and_none_waits_for_the_other():
    """The first quotient has no quotient in it, and the second neither."""
    assert program().operation_counts()["divide"] == 2
    lines = {each.name: str(each.value) for each in program().statements}
    quotients = [name for name, value in lines.items() if "Divide" in value]
    assert quotients == ["_h1", "z"]
    assert "_h1" not in lines["z"]


def error(matrix, known):
    """Largest error in units of 2^-53 times what rounding A and b may change."""
    inverse = invert(matrix)
    exact = [sum(inverse[i][j] * Fraction(known[j]) for j in range(3)) for i in range(3)]
    found = solve_numbers(matrix, known, float)
    sizes = [
        sum(abs(Fraction(matrix[i][j]) * exact[j]) for j in range(3)) + abs(Fraction(known[i]))
        for i in range(3)
    ]
    bounds = [sum(abs(inverse[i][j]) * sizes[j] for j in range(3)) for i in range(3)]
    return (
        max(abs(Fraction(f) - e) / b for f, e, b in zip(found, exact, bounds, strict=True)) * 2**53
    )


@pytest.mark.parametrize("arm", [1e-3, 1.0, 1e3, 1e6])
def test_digits_are_those_that_the_matrix_has(arm):
    """Errors are a few roundings of A and b, however close to singular A is."""
    source = Random(2)
    assert max(error(*draw_ball(source, arm, 1.0)) for _ in range(100)) < 8


def test_moments_of_inertia_of_molecules_are_in_range():
    """At 1e-47 no product of minors underflows."""
    source = Random(3)
    for _ in range(20):
        matrix, known = draw_ball(source, 1e-23, 1e-47)
        assert error(matrix, [1e-47 * each for each in known]) < 8


@cache
def ball():
    """The equations of Chaplygin's ball and the Program of its rates."""
    equations = derive(read_spec(derivations_folder() / "chaplygin_ball.toml"))
    return equations, lower(equations)["rhs"]


def test_rates_of_the_ball_and_their_factored_form_are_the_equations():
    """Two quotients and three; both are undone exactly, and a sign that is turned is noticed."""
    equations, rates = ball()
    counts = [each.operation_counts()["divide"] for each in (rates, rates.factored)]
    assert counts == [2, 3]
    for each in (rates, rates.factored):
        check_inverse(equations, each)
        name = next(s.name for s in each.statements if s.name in ("_n2", "_d2"))
        spoiled = tuple(
            Statement(s.name, Add(s.value, Negate(s.value.right)), s.level) if s.name == name else s
            for s in each.statements
        )
        with pytest.raises(CrossCheckError, match="lowering changed rhs"):
            check_inverse(equations, replace(each, statements=spoiled))


def test_solvers_share_what_depends_on_parameters_alone():
    """Both forms begin with the same statements, so that a solver computes them once."""
    _, rates = ball()
    fixed = rates.statements_at("parameters")
    assert fixed
    assert rates.factored.statements_at("parameters")[: len(fixed)] == fixed
    text = arrange(select_programs([rates]))
    assert text.products < arrange(select_programs([replace(rates, factored=None)])).products


@pytest.mark.parametrize("name", ["veselova", "heavy_top"])
def test_other_systems_of_equations_keep_their_factors(name):
    """Where there are more unknowns, or nothing is solved for, nothing is taken."""
    equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
    programs = lower(equations)
    assert programs["rhs"].factored is None
    rows = [(label, equations.setting.field.one) for label in "abc"]
    assert find_solve(equations, rows) is None
