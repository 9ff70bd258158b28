"""Lax pairs and brackets of matrices in a spec: what they may be, and each fault at its place."""

import pytest

from coadjoint.errors import AlgebraError, SpecError
from tests.spec.texts import BY_MATRICES
from tests.specs import shipped, spec


def text_of(name):
    """The text of a shipped spec."""
    return shipped(name).path.read_text(encoding="utf-8")


def test_a_pair_is_read():
    """Two square matrices that may name the spectral parameter, a keyword of Python."""
    lax = shipped("manakov_so4").lax
    assert (lax.spectral, lax.L.shape, lax.M.shape) == ("lambda", (4, 4), (4, 4))
    assert lax.L.key == "lax.L"
    assert shipped("so4_body").lax is None


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (('"M + lambda*diag(a)^2"', '"dot(a, a)"'), "lax.L", "a scalar", "a square matrix"),
        (('"M + lambda*diag(a)^2"', '"a"'), "lax.L", "a 4-vector", "a square matrix"),
        (('"Omega + lambda*diag(a)"', '"hat(rows(a, a)*a)"'), "lax.M", "", "hat"),
        (('"Omega + lambda*diag(a)"', '"diag(rows(a, a)*a)"'), "lax.M", "2 by 2", "as L is"),
        (('"M + lambda*diag(a)^2"', '"Omega + M"'), "lax.L", "Omega", "is a velocity"),
        (('"Omega + lambda*diag(a)"', '"Omega + mu*M"'), "lax.M", "mu", "not declared"),
        (('= "lambda"', '= "Omega"'), "lax.spectral", "Omega", "spectral parameter"),
        (('= "lambda"', '= "M12"'), "lax.spectral", "M12", "spectral parameter"),
        (('= "lambda"', '= "a b"'), "lax.spectral", "a b", "spectral parameter"),
        (('= "lambda"', '= "trace"'), "lax.spectral", "trace", "spectral parameter"),
        (('"lax", ', ""), "lax", "lax", "no route uses the table [lax]"),
    ],
)
def test_a_fault_of_a_pair_is_shown(change, key, found, said):
    """Shapes, names out of scope, the spectral parameter, and a pair that no route reads."""
    with pytest.raises(SpecError) as caught:
        spec(text_of("manakov_so4"), change)
    assert caught.value.parts["key"] == key
    assert found in str(caught.value.parts["found"])
    assert said in str(caught.value)
    assert caught.value.exit_status == 2


def test_the_route_lax_needs_a_pair():
    """Without [lax] the route says which table is missing."""
    text = text_of("manakov_so4")
    with pytest.raises(SpecError, match=r"the route lax has no table \[lax\]"):
        spec(text, (text[text.index("[lax]") : text.index("[claims]")], ""))


def test_integrals_have_names_of_their_own():
    """A spec cannot declare what its kernels call the integrals of a pair."""
    with pytest.raises(SpecError, match=r"'integral1'.*Call it 'my_integral1'"):
        spec(text_of("manakov_so4"), ("[claims]", '[observables]\nintegral1 = "M12"\n[claims]'))


# -- brackets of matrices -------------------------------------------------------------------------


def test_the_matrix_in_the_middle_of_a_bracket_is_found():
    """N of ``X N Y - Y N X``; there is none of another bracket, and 1 of the commutator."""
    algebra = shipped("bloch_iserles_3").algebra
    rows = ((0, 1, "N12"), (0, 2, "N13"), (1, 2, "N23"))
    wanted = {(i, j): name for i, j, name in rows} | {(j, i): f"-{name}" for i, j, name in rows}
    assert {place: str(value) for place, value in algebra.middle.items()} == wanted
    text = text_of("bloch_iserles_2")
    twice = spec(text, (BRACKET, f"2*({BRACKET})")).algebra
    assert {place: str(value) for place, value in twice.middle.items()} == {
        (0, 1): "2*N12",
        (1, 0): "-2*N12",
    }
    other = spec(text, (BRACKET, "X*Y*N - Y*X*N + transpose(X*Y*N - Y*X*N)")).algebra
    assert other.elements
    assert not other.middle


def test_a_bracket_of_matrices_gives_constants_with_parameters():
    """``[E11, E12] = N12 E11``, since E11 N E12 has the entry N12/2 twice, by the parameter N."""
    algebra = shipped("bloch_iserles_2").algebra
    assert algebra.basis == ("E11", "E12", "E22")
    found = {pair: {k: str(c) for k, c in row.items()} for pair, row in algebra.constants.items()}
    assert found == {(0, 1): {0: "N12"}, (0, 2): {1: "2*N12"}, (1, 2): {2: "N12"}}
    assert not algebra.matrices  # whose commutators would be the brackets
    assert len(algebra.elements) == 3


def test_the_commutator_is_the_default():
    """Writing the commutator out gives the same algebra as leaving it out."""
    text = BY_MATRICES.replace('Gamma = { role = "advected", representation = "vector" }', "")
    text = text.replace(" + Gamma1", "")
    bracket = '[algebra]\nbracket = "X*Y - Y*X"\n[algebra.matrices]'
    declared, known = spec(text, ("[algebra.matrices]", bracket)), spec(text)
    assert declared.algebra.constants == known.algebra.constants
    assert declared.algebra.elements == known.algebra.matrices


BRACKET = "X*N*Y - Y*N*X"


@pytest.mark.parametrize(
    ("bracket", "kind", "said"),
    [
        ("X*N*Y", AlgebraError, "[E11, E22] + [E22, E11] is not zero"),
        ("X*Y - Y*X", AlgebraError, "the bracket of E11 and E12 is not in the span"),
        ("X*N*Y - Y*X", SpecError, "N"),
        ("X*N*X - X*N*X", SpecError, "not linear in X and in Y"),
        ("X*N*Y - N", SpecError, "not linear in 'X'"),
        ("X*N - N*X", SpecError, "not linear in X and in Y"),
        ("trace(X*N*Y)", SpecError, "the value is a scalar"),
        ("inverse(X)*Y", SpecError, "not linear in 'X'"),
        ("X*K*Y - Y*K*X", SpecError, "'K' is not declared"),
        ("X*N*Y - ", SpecError, "bracket"),
    ],
)
def test_a_fault_of_a_bracket_is_shown(bracket, kind, said):
    """No antisymmetry, no closure, not bilinear, no matrix, unknown names: each says what it is."""
    if said == "N":
        kind, said = AlgebraError, "is not zero"
    with pytest.raises(kind) as caught:
        spec(text_of("bloch_iserles_2"), (BRACKET, bracket))
    assert said in str(caught.value)
    assert "algebra.bracket" in caught.value.parts["key"]


def test_a_bracket_stands_beside_matrices_alone():
    """so(3) by name has its bracket already."""
    with pytest.raises(SpecError, match="a bracket of X and Y only with matrices"):
        spec(text_of("manakov_so4"), ('name       = "so(4)"', 'name = "so(4)"\nbracket = "X*Y"'))


def test_a_parameter_cannot_be_called_x():
    """X and Y are the two matrices."""
    text = text_of("bloch_iserles_2").replace("[parameters.N]", "[parameters.Y]\n[parameters.N]")
    with pytest.raises(SpecError, match="'Y' is a parameter"):
        spec(text)


def test_a_form_fits_the_matrices_of_the_algebra():
    """Antisymmetric variables over symmetric matrices are refused, naming the matrix."""
    with pytest.raises(SpecError, match="the matrix of E11 is not of the form 'antisymmetric'"):
        spec(
            text_of("bloch_iserles_2"),
            ('role = "momentum", form = "symmetric"', 'role = "momentum", form = "antisymmetric"'),
        )
