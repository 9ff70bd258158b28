"""Coefficients: combinations and polynomials are read exactly, and nothing else is."""

import subprocess
import sys
from fractions import Fraction

import pytest

from coadjoint.errors import LimitError, SpecError
from coadjoint.limits import PARAMETRIC_TERMS
from coadjoint.spec.core.coefficients import Scalars, read_coefficient, read_combination
from coadjoint.spec.core.positions import scan
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import Parameter

KEY = ("k",)
BASIS = ("e1", "e2", "e3")


def source(text):
    """A file with one text."""
    line = f'k = "{text}"'
    return Source("a.toml", line, scan(line))


def scalars():
    """A scalar, a vector and a matrix of parameters."""
    shapes = {"a": (), "I": (3,), "A": (2, 2), "w1": (2,)}
    plain = [Parameter(name, shape, positive=name == "I") for name, shape in shapes.items()]
    forms = {"N": "antisymmetric", "S": "symmetric"}
    return Scalars([*plain, *(Parameter(name, (3,), form=form) for name, form in forms.items())])


def combination(text, known=None):
    """The coefficients of a text."""
    return read_combination(source(text), KEY, text, BASIS, known or scalars())


def test_plain_numbers_need_no_field():
    """SymPy is not loaded where no parameter occurs."""
    code = (
        "import sys\n"
        "from coadjoint.spec import read_spec\n"
        "from coadjoint.resources import derivations_folder\n"
        "for name in ('so4_body', 'bargmann', 'sl2_r2', 'so8_body', 'sp2_momentum'):\n"
        "    read_spec(derivations_folder() / f'{name}.toml')\n"
        "print({'sympy', 'numpy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_numbers_stay_fractions():
    """So that specs without parameters are as quick as before."""
    assert combination("2*e1 - e3/3") == {0: 2, 2: Fraction(-1, 3)}
    assert all(isinstance(c, Fraction) for c in combination("2*e1 - e3/3").values())
    assert read_coefficient(source(""), KEY, Fraction(3), scalars()) == 3
    assert read_coefficient(source("2*3"), KEY, "2*3", scalars()) == 6


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a*e1", "a"),
        ("e1*a^2/2 + e1/2", "a**2/2 + 1/2"),
        ("I[2]*e1", "I2"),
        ("I2*e1", "I2"),
        ("A[1, 2]*e1 - A21*e1", "A12 - A21"),
        ("w1[2]*e1", "w1_2"),
        ("N[1, 2]*e1 + N13*e1", "N12 + N13"),
        ("N[3, 2]*e1 + N[2, 2]*e1", "-N23"),
        ("S[2, 1]*e1 + S[2, 2]*e1", "S12 + S22"),
        ("-(e1 + 0*e2)*(a - 1)", "1 - a"),
    ],
)
def test_coefficients_are_polynomials_of_parameters(text, expected):
    """By component name or by subscript; the parameters of one spec share a field."""
    found = combination(text)
    assert list(found) == [0]
    assert str(found[0]) == expected


def test_what_cancels_is_not_there():
    """A zero is decided exactly, so that no constant is kept that is none."""
    assert combination("(a + 1)^2*e1 - (a^2 + 2*a + 1)*e1") == {}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("e1/a", "not a linear combination"),
        ("e1/(a - a)", "not a linear combination"),
        ("a^-1*e1", "not a linear combination"),
        ("I*e1", "not a linear combination"),
        ("sin(a)*e1", "not a linear combination"),
        ("a + e1", "not a linear combination"),
        ("e1^1*a", "not a linear combination"),
        ("b*e1", "'b' is not declared"),
        ("I[4]*e1", "1 to 3"),
        ("N[2]*e1", "not a linear combination"),
        ("N21*e1", "'N21' is not declared"),
        ("a[1]*e1", "without a subscript"),
    ],
)
def test_what_is_no_combination_is_refused(text, said):
    """Quotients of parameters, which may be 0, functions, whole vectors, unknown names."""
    with pytest.raises(SpecError, match=r"a\.toml:1:") as caught:
        combination(text)
    assert said in str(caught.value)
    assert str(caught.value).endswith("^")


@pytest.mark.parametrize("text", ["1/a", "e1", "I", "sqrt(a)", "a^", ""])
def test_what_is_no_polynomial_is_refused(text):
    """An entry of a matrix is a polynomial of parameters alone."""
    with pytest.raises(SpecError, match=r"a\.toml:1:"):
        read_coefficient(source(text), KEY, text, scalars())


def test_name_of_a_parameter_and_of_the_basis_is_refused():
    """The text would have two meanings."""
    known = Scalars([Parameter("e1", ())])
    assert combination("e2", known) == {1: 1}
    with pytest.raises(SpecError, match="'e1' is both a parameter and in the basis"):
        combination("e1*e2", known)


def test_too_many_parametric_terms_are_refused():
    """The limit is over all coefficients of a spec, and numbers are not counted."""
    known = scalars()
    for _ in range(PARAMETRIC_TERMS // 2):
        combination("a*e1 + 2*I2*e2", known)
        combination("e1 + e2 + e3", known)
    with pytest.raises(LimitError) as caught:
        combination("e1 + a*e2", known)
    assert caught.value.limit == "PARAMETRIC_TERMS"
    assert caught.value.found == str(PARAMETRIC_TERMS + 2)
