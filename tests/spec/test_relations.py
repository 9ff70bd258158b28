"""Relations: two sides and the sign between them, or what is wrong, with its place."""

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec.model import Formula
from tests.constrained import BALL, PARTICLE
from tests.specs import spec

BLADE = '"w == y*u"'


def sides(text, relation=BLADE):
    """Both sides of the first constraint of a changed particle."""
    constraint = spec(PARTICLE, (relation, text)).constraints[0]
    return constraint.left, constraint.right


def test_both_sides_are_formulas_of_the_whole_text():
    """Either side is read as an expression, and both show the text as it was written."""
    left, right = sides('"2*w - y*u == k"')
    assert isinstance(left, Formula)
    assert left.text == right.text == "2*w - y*u == k"
    assert (left.tree, right.tree) == tuple(f.tree for f in sides('"2*w - y*u==k"'))
    assert left.tree != right.tree


def test_zero_has_the_shape_of_the_other_side():
    """A vector may be said to vanish with a plain 0, on either side; 1 is no vector."""
    for text in ('"Y - cross(Omega, s) == 0"', '"0 == Y - cross(Omega, s)"'):
        found = spec(BALL, ('"Y == cross(Omega, s)"', text)).constraints[0]
        assert found.left.shape == found.right.shape == found.shape == (3,)
    with pytest.raises(SpecError, match="the left side is a 3-vector and the right side a scalar"):
        spec(BALL, ('"Y == cross(Omega, s)"', '"Y - cross(Omega, s) == 1"'))


@pytest.mark.parametrize(
    ("text", "column", "found", "said"),
    [
        ('"w = y*u"', 12, "=", "there is no ==; expected two expressions with == between them"),
        ('"w == y*u == 0"', 19, "==", "there are two signs"),
        ('"w >= y*u"', 12, ">=", "there is no =="),
        ('"w - y*u"', 10, "w - y*u", "'Y == cross(Omega, s)'"),
        ('""', 10, "", "there is no =="),
        ('"w == "', 10, "", "the expression is empty"),
        ('"w == q*u"', 15, "q", "'q' is not declared"),
        ('"q*u == w"', 10, "q", "'q' is not declared"),
        ('"w == y*energy"', 17, "energy", "'energy' is not declared"),
        ('"w == blade_reaction"', 15, "blade_reaction", "'blade_reaction' is not declared"),
    ],
)
def test_what_is_no_equation_is_shown_at_its_place(text, column, found, said):
    """The caret is below the sign or the name, on the right side of the sign too."""
    with pytest.raises(SpecError) as caught:
        sides(text)
    message, parts = str(caught.value), caught.value.parts
    assert message.startswith(f"sample.toml:17:{column}: constraints.blade: ")
    assert said in message
    assert parts["found"] == found


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('"Y == dot(Omega, s)"', "the left side is a 3-vector and the right side a scalar"),
        ('"dot(Y, s) == Omega"', "the left side is a scalar and the right side a 3-vector"),
        ('"Y == vector(Omega1, 0)"', "the right side a 2-vector"),
    ],
)
def test_sides_of_different_shapes_are_refused(text, said):
    """Both shapes are named, and the caret is below the sign."""
    with pytest.raises(SpecError, match="two sides of one shape, or 0 on one of them") as caught:
        spec(BALL, ('"Y == cross(Omega, s)"', text))
    assert said in str(caught.value)
    assert caught.value.parts["found"] == text.strip('"')
    assert str(caught.value).splitlines()[-1].strip() == "^^"
