"""Laws of Hamiltonian motion, for every shipped system and route, by arithmetic of this file alone.

What the engine proves with its own normal forms is checked here once more at exact points, with
derivatives by SymPy and sums of plain fractions. A route in variables of its own has no bracket of
the declared state, and neither has a restricted motion: there it is asked that invariants stay.
"""

from fractions import Fraction

import mpmath
import pytest
import sympy

from coadjoint.spec.core.components import component_names
from tests.conftest import SYSTEMS, rational_points
from tests.sources import classical, textbook
from tests.sources.test_equations import (
    BY_ROUTE,
    carried,
    derived,
    digits,
    emitted,
    in_chart,
    same,
    solved,
    values,
)
from tests.specs import shipped

#: Of the state itself: brackets of constrained motions move momenta.
WITH_BRACKET = sorted(set(textbook.TENSORS) - set(textbook.CONSTRAINED))
#: The largest system has 3276 triples of coordinates; the laws of so(6) are those of so(8).
ALMOST = sorted(set(textbook.TENSORS) & set(textbook.CONSTRAINED))
WITHOUT_SO8 = [name for name in WITH_BRACKET if name != "so8_body"]


def equations_with_bracket(name):
    """The equations by every route that moves the declared state, which has a bracket."""
    found = [equations for equations in derived(name).values() if equations.chart is None]
    assert found
    assert all(equations.poisson_tensor is not None for equations in found)
    return found


def point_of(equations):
    """A random point of state and parameters, with what the kernel solves for there."""
    names = [*map(str, equations.state), *textbook.GIVEN[equations.spec.name]]
    (point,) = rational_points(names, 1, seed=7)
    point = textbook.rational(equations.spec.name, point)
    return solved(equations, classical.allowed(equations.spec.name, point))


def evaluate_at_point(equations, expressions):
    """Values of expressions at that point."""
    return values(expressions, point_of(equations))


def matrix_of(equations, expressions):
    """Values as rows of as many entries as the state has."""
    n = len(equations.state)
    flat = evaluate_at_point(equations, expressions)
    return [flat[start : start + n] for start in range(0, len(flat), n)]


def tensor_of(equations):
    """The Poisson tensor at a point."""
    return matrix_of(equations, list(equations.poisson_tensor))


def gradient_of(equations, function, point=None):
    """A gradient by the state at a point, through what the kernel solves for."""
    return gradients_of(equations, [function], point)[0]


def gradients_of(equations, functions, point=None):
    """The gradients of several functions there."""
    at = point or point_of(equations)
    n = range(len(equations.state))
    slopes = {x: [Fraction(i == j) for j in n] for i, x in enumerate(equations.state)}

    def chained(expression):
        inner = sorted(expression.free_symbols & set(slopes), key=str)
        outer = values([sympy.diff(expression, x) for x in inner], at)
        rows = [slopes[x] for x in inner]
        return [dot(outer, [row[j] for row in rows]) for j in n]

    functions = list(map(sympy.sympify, functions))
    needed = set[sympy.Symbol]().union(*(function.free_symbols for function in functions))
    for name in reversed(equations.kept):
        if sympy.Symbol(name) in needed:
            needed |= equations.velocities[name].free_symbols
    for name in equations.kept:
        if sympy.Symbol(name) in needed:
            slopes[sympy.Symbol(name)] = chained(equations.velocities[name])
    return list(map(chained, functions))


def slopes_of(equations):
    """``slopes[m][b][c]``, the derivative of the tensor by each coordinate."""
    entries = list(equations.poisson_tensor)
    return [matrix_of(equations, [sympy.diff(e, x) for e in entries]) for x in equations.state]


def dot(a, b):
    """Sum of products."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def check_antisymmetric(tensor):
    """``J_ij = -J_ji``, not all zero."""
    n = range(len(tensor))
    assert any(map(any, tensor)), "a tensor of zeros satisfies every law"
    assert all(tensor[i][j] == -tensor[j][i] for i in n for j in n)


def check_jacobi(tensor, slopes):
    """``J_am d_m J_bc + cyclic = 0`` for every triple."""
    n = range(len(tensor))
    assert any(any(map(any, slope)) for slope in slopes), "constant tensors satisfy it"
    columns = [[[slopes[m][b][c] for m in n] for c in n] for b in n]
    for a in n:
        for b in range(a):
            for c in range(b):
                cycle = ((a, b, c), (b, c, a), (c, a, b))
                assert sum(dot(tensor[i], columns[j][k]) for i, j, k in cycle) == 0, (a, b, c)


def check_commutes(tensor, gradient):
    """``J grad C = 0`` for a function that is not constant."""
    assert any(gradient), "constants commute with everything"
    assert not any(dot(row, gradient) for row in tensor)


def check_hamiltonian(tensor, gradient, rates):
    """``dx/dt = J grad h``, which is not rest, and ``dh/dt = 0``."""
    assert any(rates)
    assert same([dot(row, gradient) for row in tensor], map(digits, rates))
    check_conserved(gradient, rates)


def check_conserved(gradient, rates):
    """``df/dt = grad f . dx/dt = 0`` for a function that is not constant, where there is motion."""
    assert any(gradient)
    assert any(rates)
    assert same([dot(gradient, rates)], [0])


def casimirs_of(equations):
    """The observables that are Casimirs."""
    return [f for name, f in equations.observables.items() if name.startswith("casimir")]


def image_of(equations, name):
    """A point of the declared state and how a route moves it, through its chart if it has one."""
    if equations.chart is None:
        point = point_of(equations)
        return point, values(equations.rates, point)
    ((own, x, _),) = in_chart(equations, name, 1)
    point = own | dict(zip(textbook.STATES[name], map(digits, x), strict=True))
    return point, values(carried(equations), own)


@pytest.mark.parametrize(
    ("name", "route"),
    [
        pytest.param(name, route, marks=[pytest.mark.campaign] * (route != shipped(name).routes[0]))
        for name, route in BY_ROUTE
    ],
)
def test_energy_and_casimirs_are_conserved(name, route):
    """Conserved quantities of the emitted route are constant along every route, also in charts.

    Other routes than that one come in campaigns: `tests.sources.test_equations` finds the rates by
    every route, also in charts, equal to the same formulas of books.
    """
    first = emitted(name)
    point, rates = image_of(derived(name)[route], name)
    if first.spec.is_driven:  # what survives is a claim; a double bracket keeps all Casimirs
        metric = first.spec.relaxation
        kept = casimirs_of(first) if metric is not None and metric.S is None else []
    else:  # of the bracket alone, where the energy depends on time or constraints do work
        constraints = first.distribution
        works = first.setting.time or (constraints is not None and not constraints.is_linear)
        kept = [*([] if works else [first.energy]), *casimirs_of(first)]
    assert None not in kept
    for function in kept:
        check_conserved(gradient_of(first, function, solved(first, point)), rates)


@pytest.mark.parametrize("name", [n for n in WITH_BRACKET if not shipped(n).is_driven])
def test_motions_are_hamiltonian(name):
    """The tensor is antisymmetric, the rates are tensor times grad h, and h is constant."""
    for equations in equations_with_bracket(name):
        tensor = tensor_of(equations)
        check_antisymmetric(tensor)
        rates = evaluate_at_point(equations, equations.rates)
        check_hamiltonian(tensor, gradient_of(equations, equations.energy), rates)


def are_equal(a, b):
    """Exactly for rational numbers; to 40 digits where there are roots."""
    if a.is_Rational and b.is_Rational:
        return a == b
    return abs(digits(a - b)) <= Fraction(1, 10**40) * max(1, abs(digits(b)))


def in_digits(matrix):
    """A matrix of rational numbers as it is; one with sines to 80 digits."""
    return matrix if all(entry.is_Rational for entry in matrix) else matrix.evalf(80)


def solution(matrix, right):
    """``matrix^-1 right``: exactly, or to 80 digits with rows in the order of the largest pivot."""
    if all(entry.is_Rational for entry in (*matrix, *right)):
        return matrix.solve(right)
    with mpmath.workdps(80):
        rows = [[mpmath.mpf(str(x)) for x in row] for row in matrix.tolist()]
        found = mpmath.lu_solve(mpmath.matrix(rows), [mpmath.mpf(str(x)) for x in right])
        return sympy.Matrix([sympy.Float(str(x), 80) for x in found])


def check_almost_hamiltonian(equations, tensor):
    """``d phi/dt = J dE/dphi`` for phi, the state with momenta in the place of velocities."""
    declared = [name for each in equations.spec.reduced_momenta for name in each.components]
    velocities = [
        name
        for variable in equations.spec.state
        if variable.role == "velocity"
        for name in variable.components
    ]
    names = [name for variable in equations.spec.state for name in variable.components]
    # without names of momenta, these are slopes of an energy with a quadratic form of velocities
    momenta = declared or [sympy.diff(equations.energy, name) for name in velocities]
    moved = dict(zip(velocities, momenta, strict=True))
    phi = [equations.observables.get(p := moved.get(n, n), sympy.sympify(p)) for n in names]
    *slopes, energy = map(sympy.Matrix, gradients_of(equations, [*phi, equations.energy]))
    slopes = sympy.Matrix.hstack(*slopes).T
    rates = sympy.Matrix(evaluate_at_point(equations, equations.rates))
    assert any(rates)
    slopes, energy, rates, tensor = map(in_digits, (slopes, energy, rates, sympy.Matrix(tensor)))
    assert all(map(are_equal, slopes * rates, tensor * solution(slopes.T, energy)))


@pytest.mark.parametrize("name", ALMOST)
def test_constrained_motions_are_almost_hamiltonian(name):
    """The tensor is antisymmetric and gives the rates; a tensor with one wrong sign does not."""
    for equations in equations_with_bracket(name):
        tensor = tensor_of(equations)
        check_antisymmetric(tensor)
        check_almost_hamiltonian(equations, tensor)
        with pytest.raises(AssertionError):
            check_almost_hamiltonian(equations, [[-entry for entry in row] for row in tensor])


@pytest.mark.parametrize("name", WITHOUT_SO8)
def test_brackets_satisfy_jacobi(name):
    """Every triple of coordinates, at a point; two coordinates have no triple."""
    different = {equations.poisson_tensor: equations for equations in equations_with_bracket(name)}
    for tensor, equations in different.items():
        if tensor.free_symbols.isdisjoint(equations.state):
            # canonical: nothing to differentiate, and no Casimir
            assert sympy.Matrix(tensor_of(equations)).det() != 0
        else:
            check_jacobi(tensor_of(equations), slopes_of(equations))


@pytest.mark.parametrize("name", SYSTEMS)
def test_casimirs_commute(name):
    """As many as the spec claims."""
    equations = emitted(name)
    casimirs = casimirs_of(equations)
    claimed = [name for each in shipped(name).casimirs for name in component_names("c", each.shape)]
    assert len(casimirs) == len(claimed)
    for casimir in casimirs:
        check_commutes(tensor_of(equations), gradient_of(equations, casimir))


@pytest.mark.parametrize(
    "pairs",
    [
        pytest.param({route: (name, route) for name, route in BY_ROUTE}.values(), id="one by each"),
        pytest.param(BY_ROUTE, id="all", marks=pytest.mark.campaign),
    ],
)
def test_routes_without_a_bracket_are_few(pairs):
    """Only routes in charts and restricted motions have no bracket."""
    found = {(name, route): emitted(name, route) for name, route in pairs}
    without = {pair for pair, each in found.items() if each.exact.poisson_tensor is None}
    charts = {pair for pair, each in found.items() if each.chart is not None}
    assert charts < without
    declared = {name for name, _ in found.keys() - charts}
    assert {name for name, _ in without - charts} == declared - set(textbook.TENSORS)
    assert declared == set(SYSTEMS) or len(found) < len(BY_ROUTE)
    assert len(WITH_BRACKET) > len(SYSTEMS) / 2


# -- the checks can fail --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def top():
    """The heavy top, its tensor and the slopes of it."""
    equations = emitted("heavy_top")
    return equations, tensor_of(equations), slopes_of(equations)


def test_a_flipped_entry_is_not_antisymmetric(top):
    """One of the two halves."""
    spoiled = [list(row) for row in top[1]]
    spoiled[0][1] = -spoiled[0][1]
    with pytest.raises(AssertionError):
        check_antisymmetric(spoiled)
    with pytest.raises(AssertionError, match="zeros"):
        check_antisymmetric([[Fraction(0)] * 2] * 2)


def test_a_flipped_pair_violates_jacobi(top):
    """{Pi1, Gamma2} and {Gamma2, Pi1} of the other sign, antisymmetric as before."""
    tensor = [list(row) for row in top[1]]
    slopes = [[list(row) for row in slope] for slope in top[2]]
    for table in (tensor, *slopes):
        table[0][4], table[4][0] = -table[0][4], -table[4][0]
    check_antisymmetric(tensor)
    with pytest.raises(AssertionError):
        check_jacobi(tensor, slopes)


def test_a_function_that_changes_is_not_a_casimir(top):
    """The energy."""
    equations, tensor, _ = top
    with pytest.raises(AssertionError):
        check_commutes(tensor, gradient_of(equations, equations.energy))
    with pytest.raises(AssertionError, match="constants"):
        check_commutes(tensor, [Fraction(0)] * 6)


def test_reversed_rates_are_rejected(top):
    """The energy is constant, but the rates differ."""
    equations, tensor, _ = top
    gradient = gradient_of(equations, equations.energy)
    backwards = [-rate for rate in evaluate_at_point(equations, equations.rates)]
    assert dot(gradient, backwards) == 0
    with pytest.raises(AssertionError):
        check_hamiltonian(tensor, gradient, backwards)


def test_wrong_rates_in_a_chart_are_detected():
    """With one rate of the opposite sign, neither the energy nor the last Casimir is constant."""
    first, other = emitted("heavy_top"), derived("heavy_top")["kaluza-klein"]
    point, rates = image_of(other, "heavy_top")
    for function in (first.energy, casimirs_of(first)[-1]):
        gradient = gradient_of(first, function, point)
        check_conserved(gradient, rates)
        with pytest.raises(AssertionError):
            check_conserved(gradient, [-rates[0], *rates[1:]])


def test_gradients_include_the_solved_velocities():
    """At the velocities that it solves for, dl/dxi is mu itself, whose gradient has one entry."""
    equations = emitted("coupled_bodies")
    setting, field = equations.setting, equations.setting.field
    lagrangian = setting.formula(setting.spec.lagrangian)
    for mu, xi in zip(setting.momenta, setting.velocities, strict=True):
        slope = field.to_sympy(field.derivative(lagrangian, xi))
        assert sympy.Symbol(mu) not in slope.free_symbols
        assert gradient_of(equations, slope) == [Fraction(mu == name) for name in setting.state]
