"""Extensions and subalgebras: what they must equal, and what is refused."""

import pytest

from coadjoint.algebra import (
    CATALOGUE,
    algebra_by_name,
    central_extension,
    complexification,
    from_brackets,
    leibniz_extension,
    same_constants,
    subalgebra,
)
from coadjoint.errors import AlgebraError, LimitError
from tests.algebra.laws import vector

MASS = {(3 + i, 6 + i): 1 for i in range(3)}  # omega(K_i, P_j) = delta_ij


def unit(n, i, value=1):
    """A basis vector."""
    return [value if j == i else 0 for j in range(n)]


def test_bargmann_is_the_central_extension_of_the_galilei_algebra_by_the_mass():
    """Same constants, same names, and matrices of the same size are found, which are faithful."""
    built = central_extension(algebra_by_name("g(3)"), MASS, "M", "bargmann")
    bargmann = algebra_by_name("bargmann")
    assert (built.constants, built.basis) == (bargmann.constants, bargmann.basis)
    assert max(max(place) for m in built.matrices for place in m) == 5
    built.check_matrices()


def test_heisenberg_is_the_central_extension_of_the_plane():
    """[P1, P2] = Z; either order of the pair declares it."""
    plane = algebra_by_name("R^2")
    built = central_extension(plane, {(0, 1): 1}, "C")
    assert same_constants(built, algebra_by_name("h(1)"))
    assert central_extension(plane, {(1, 0): -1}, "C").constants == built.constants
    built.check_matrices()


def test_a_form_that_is_no_cocycle_is_refused():
    """The mass with one sign turned: the triple and the defect are named."""
    refusal = r"not a 2-cocycle: omega\(J\d, \[K\d, P\d\]\) M"
    with pytest.raises(AlgebraError, match=refusal) as caught:
        central_extension(algebra_by_name("g(3)"), {**MASS, (3, 6): -1}, "M")
    assert caught.value.defect in ("(2) M", "(-2) M")


def test_a_form_given_twice_or_not_antisymmetric_is_refused():
    """Each pair of different vectors once."""
    plane = algebra_by_name("R^2")
    with pytest.raises(AlgebraError, match=r"omega\(P2, P1\) = 4 is given"):
        central_extension(plane, {(0, 1): 1, (1, 0): 4})
    with pytest.raises(AlgebraError, match=r"omega\(P1, P1\) = 3 is given"):
        central_extension(plane, {(0, 0): 3})


def test_an_extension_without_matrices_of_its_shape_has_none():
    """A trivial extension of so(3) by a free line has no row that sees Z."""
    built = central_extension(algebra_by_name("so(3)"), {})
    assert (built.dimension, built.matrices) == (4, ())


@pytest.mark.parametrize("name", [n for n in CATALOGUE if algebra_by_name(n).dimension <= 6])
def test_leibniz_and_complex_extensions_keep_their_laws(name):
    """[x eps^a, y eps^b] = [x, y] eps^(a+b) and i i = -1; matrices stay faithful."""
    algebra = algebra_by_name(name)
    d = algebra.dimension
    x, y = vector(d, 1), vector(d, 2)
    bracket, zero = algebra.bracket(x, y), (0,) * d
    cubic = leibniz_extension(algebra, 3)
    assert cubic.bracket((*zero, *x, *zero), (*zero, *y, *zero)) == (*zero, *zero, *bracket)
    assert cubic.bracket((*x, *zero, *zero), (*zero, *y, *zero)) == (*zero, *bracket, *zero)
    assert not any(cubic.bracket((*zero, *x, *zero), (*zero, *zero, *y)))
    cubic.check_matrices()
    complexified = complexification(algebra)
    minus = tuple(-value for value in bracket)
    assert complexified.bracket((*zero, *x), (*zero, *y)) == (*minus, *zero)
    assert complexified.bracket((*x, *zero), (*zero, *y)) == (*zero, *bracket)
    complexified.check_matrices()


def test_complex_rotations_are_the_lorentz_algebra():
    """so(3) (x) C is so(3,1): J = -(E23, E31, E12), and i J are the boosts E_i4."""
    lorentz = algebra_by_name("so(3,1)")
    assert lorentz.basis == ("E12", "E13", "E14", "E23", "E24", "E34")
    places = {
        "J1": (3, -1),
        "J2": (1, 1),
        "J3": (0, -1),
        "iJ1": (2, 1),
        "iJ2": (4, 1),
        "iJ3": (5, 1),
    }
    same = subalgebra(lorentz, {name: unit(6, i, s) for name, (i, s) in places.items()})
    assert complexification(algebra_by_name("so(3)")).constants == same.constants
    turned = {name: unit(6, i, abs(s)) for name, (i, s) in places.items()}
    assert not same_constants(subalgebra(lorentz, turned), same)


def test_an_order_below_one_and_an_explosion_are_refused():
    """The offending numbers are in the messages."""
    so3 = algebra_by_name("so(3)")
    with pytest.raises(AlgebraError, match="of order 0 is empty"):
        leibniz_extension(so3, 0)
    with pytest.raises(LimitError, match="has 3000000 generators"):
        leibniz_extension(so3, 10**6)


def test_a_subalgebra_inherits_brackets_and_matrices():
    """The rotations and translations of g(3) are se(3)."""
    g3, se3 = algebra_by_name("g(3)"), algebra_by_name("se(3)")
    places = (*g3.blocks["rotation"], *g3.blocks["translation"])
    inner = subalgebra(g3, {g3.basis[i]: unit(10, i) for i in places}, "se(3)")
    assert (inner.constants, inner.basis) == (se3.constants, se3.basis)
    inner.check_matrices()
    bare = from_brackets("bare", se3.basis, se3.constants)
    assert subalgebra(bare, {"P": unit(6, 3)}).matrices == ()


def test_vectors_that_do_not_close_are_refused():
    """J1 and J2 bracket to J3, which is not in their span."""
    so3 = algebra_by_name("so(3)")
    with pytest.raises(AlgebraError, match=r"\[a, b\] = \(6\) J3 is not in the span of a, b"):
        subalgebra(so3, {"a": [2, 0, 0], "b": [0, 3, 0]})
    with pytest.raises(AlgebraError, match="b depends on the vectors before"):
        subalgebra(so3, {"a": [2, 0, 0], "b": [3, 0, 0]})
    with pytest.raises(AlgebraError, match="a has 2 components; expected 3"):
        subalgebra(so3, {"a": [2, 0]})
