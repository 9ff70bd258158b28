"""Laws of Hamiltonian motion, for every shipped system and route, by arithmetic of this file alone.

What the engine proves with its own normal forms is checked here once more at exact points, with
derivatives by SymPy and sums of plain fractions.
"""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import derive
from tests.conftest import SYSTEMS, rational_points
from tests.sources.test_equations import BY_ROUTE, values
from tests.specs import shipped

#: The largest system has 3276 triples of coordinates; the laws of so(6) are those of so(8).
WITHOUT_SO8 = [pair for pair in BY_ROUTE if pair[0] != "so8_body"]


def at_a_point(equations, expressions):
    """Values of expressions at a random point of state and parameters."""
    names = [str(symbol) for symbol in (*equations.state, *equations.parameters)]
    (point,) = rational_points(names, 1, seed=7)
    return values(expressions, point)


def matrix_of(equations, expressions):
    """Values as rows of as many entries as the state has."""
    n = len(equations.state)
    flat = at_a_point(equations, expressions)
    return [flat[start : start + n] for start in range(0, len(flat), n)]


def tensor_of(equations):
    """The Poisson tensor at a point."""
    return matrix_of(equations, list(equations.poisson_tensor))


def gradient_of(equations, function):
    """A gradient at the same point."""
    return at_a_point(equations, [sympy.diff(function, x) for x in equations.state])


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


def check_moves(tensor, gradient, rates):
    """``dx/dt = J grad h``, which is not rest, and ``dh/dt = 0``."""
    assert any(rates)
    assert [dot(row, gradient) for row in tensor] == rates
    assert dot(gradient, rates) == 0


def casimirs_of(equations):
    """The observables that are Casimirs."""
    return [f for name, f in equations.observables.items() if name.startswith("casimir")]


@pytest.mark.parametrize(("name", "route"), BY_ROUTE)
def test_motions_are_hamiltonian(name, route):
    """The tensor is antisymmetric, the rates are its product with grad h, and h stays."""
    equations = derive(shipped(name), route)
    tensor = tensor_of(equations)
    check_antisymmetric(tensor)
    rates = at_a_point(equations, equations.rates)
    check_moves(tensor, gradient_of(equations, equations.energy), rates)


@pytest.mark.parametrize(("name", "route"), WITHOUT_SO8)
def test_brackets_satisfy_jacobi(name, route):
    """Every triple of coordinates, at a point; two coordinates have no triple."""
    equations = derive(shipped(name), route)
    tensor = equations.poisson_tensor
    if not any(entry.free_symbols for entry in tensor):
        assert tensor.det() != 0  # canonical: nothing to differentiate, and no Casimir
        return
    check_jacobi(tensor_of(equations), slopes_of(equations))


@pytest.mark.parametrize("name", SYSTEMS)
def test_casimirs_commute(name):
    """As many as the spec claims."""
    equations = derive(shipped(name))
    casimirs = casimirs_of(equations)
    assert len(casimirs) == len(shipped(name).casimirs)
    for casimir in casimirs:
        check_commutes(tensor_of(equations), gradient_of(equations, casimir))


# -- the checks can fail --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def top():
    """The heavy top, its tensor and the slopes of it."""
    equations = derive(shipped("heavy_top"))
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


def test_a_function_that_moves_is_no_casimir(top):
    """The energy."""
    equations, tensor, _ = top
    with pytest.raises(AssertionError):
        check_commutes(tensor, gradient_of(equations, equations.energy))
    with pytest.raises(AssertionError, match="constants"):
        check_commutes(tensor, [Fraction(0)] * 6)


def test_reversed_motion_is_not_that_of_the_tensor(top):
    """The energy stays, the rates differ."""
    equations, tensor, _ = top
    gradient = gradient_of(equations, equations.energy)
    backwards = [-rate for rate in at_a_point(equations, equations.rates)]
    assert dot(gradient, backwards) == 0
    with pytest.raises(AssertionError):
        check_moves(tensor, gradient, backwards)
