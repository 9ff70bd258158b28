"""[domain]: inequalities of scalars, each fault shown with its place."""

import pytest

from coadjoint.errors import SpecError
from tests.solve.domains import STONE
from tests.specs import RIGID_BODY, spec

ABOVE = 'above = "h > 0"'


def test_conditions_are_read_in_declared_order():
    """Name, both sides and sign; a condition may have the name of a variable."""
    found = spec(STONE, (ABOVE, 'h = "h/2 <   3*m"')).domain
    assert [(each.name, each.sign, each.in_one_line) for each in found] == [
        ("h", "<", "h/2 < 3*m"),
        ("heavy", ">=", "m >= g"),
    ]


def test_any_kind_of_spec_may_have_a_domain():
    """A body with momenta: conditions may name velocities, momenta and parameters."""
    (found,) = spec(RIGID_BODY + '\n[domain]\nslow = "dot(Pi, Omega) < I[1]"\n').domain
    assert found.name == "slow"


@pytest.mark.parametrize(
    ("line", "message", "marked"),
    [
        ('above = "h"', "there is no >, >=, <, <=", "h"),
        ('above = "h == 0"', "there is no >, >=, <, <=", "=="),
        ('above = "h > 0 > v"', "there are two signs", ">"),
        ('above = "0 < h < 3"', "there are two signs", "<"),
        ('above = "h >"', "the expression is empty", ""),
        ('above = "vector(h, v, 1) > 0"', "both sides are a 3-vector", '"vector(h, v, 1) > 0"'),
        ('above = "vector(h, v, 1) > h"', "the left side is a 3-vector", ">"),
        ('above = "height > 0"', "'height' is not declared", "height"),
        ('"a b" = "h > 0"', "'a b' is not a name", '"a b"'),
        ('rhs = "h > 0"', "'rhs' is a name that generated code or results use", "rhs"),
        ('"*/" = "h > 0"', "'*/' is not a name", '"*/"'),
    ],
)
def test_faults_are_shown_where_they_are(line, message, marked):
    """With the line, a caret below the offending piece, and what is expected."""
    with pytest.raises(SpecError) as caught:
        spec(STONE, (ABOVE, line))
    text = str(caught.value)
    assert message in text
    assert "expected" in text
    *_, shown, carets = text.splitlines()
    assert line in shown
    start, length = carets.index("^"), carets.count("^")
    assert not marked or shown[start : start + length] == marked


def test_nothing_else_may_be_called_domain():
    """It is a function of the kernels."""
    with pytest.raises(SpecError, match="'domain' is a name that generated code"):
        spec(STONE, ("h = {", "domain = {"), ('of = "h"', 'of = "domain"'))
