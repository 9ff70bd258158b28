"""Joined Programs: each row is what it is in the Program that it is of; what both have, is once."""

from fractions import Fraction

from coadjoint.lower.evaluation import run
from coadjoint.lower.joined import join, widen
from tests.programs import program

RATES = program("rhs", "q p", "r", "_p1 = r*r; _t1 = q*p; _t2 = _t1*_p1", "_t2 + p; _t1 - q", (2,))
BELOW = program(
    "reconstruction",
    "q p x y",
    "r",
    "_p1 = r + 1; _p2 = r*r; _t1 = p*x; _t2 = q*p; _t3 = _t2*_p2",
    "_t1*_p1 + y; _t3 - x; _t2",
    (3,),
)
POINT = {"q": 3, "p": -5, "x": 7, "y": 2, "r": 11}


def values(each, names):
    """The rows of a Program at the point, exactly."""
    known = {name: Fraction(POINT[name]) for name in names}
    return run(each, known, Fraction, None)


def test_rows_are_those_of_both():
    """By hand: q p = -15, r^2 = 121; -1820, -18; p x (r + 1) + y = -418, -1815 - 7, -15."""
    joined = join(RATES, BELOW)
    assert values(joined, POINT) == [-1820, -18, -418, -1822, -15]
    assert values(joined, POINT) == values(RATES, "qpr") + values(BELOW, POINT)
    assert (joined.name, joined.state, joined.shape) == ("rhs", ("q", "p", "x", "y"), (5,))


def test_what_both_compute_is_there_once():
    """r*r, q*p and their product have two names each; what is named alike keeps apart."""
    joined = join(RATES, BELOW)
    names = [each.name for each in joined.statements]
    assert names == ["_p1", "_r1", "_t1", "_t2", "_r2"]
    assert [each.level for each in joined.statements] == ["parameters"] * 2 + ["member"] * 3


def test_names_of_the_other_that_the_first_does_not_have_are_kept():
    """A row below may have the name of a statement above."""
    below = program("reconstruction", "q p _r1", "r", "_t1 = p*_r1; u = q + p", "_t1*u", (1,))
    joined = join(RATES, below)
    assert [each.name for each in joined.statements] == ["_p1", "_t1", "_t2", "_r2", "u"]
    known = {"q": Fraction(3), "p": Fraction(-5), "r": Fraction(1), "_r1": Fraction(2)}
    assert run(joined, known, Fraction, None)[2] == 20


def test_a_projection_leaves_what_is_below():
    """The rows of the state, then the rest as they are; a domain has rows of its own."""
    moved = program("projection", "q p", "r", "", "q/r; p/r", (2,))
    whole = widen(moved, BELOW.state, moves=True)
    assert values(whole, POINT) == [Fraction(3, 11), Fraction(-5, 11), 7, 2]
    bounds = widen(moved, BELOW.state, moves=False)
    assert (bounds.state, bounds.shape, values(bounds, POINT)) == (
        BELOW.state,
        (2,),
        [Fraction(3, 11), Fraction(-5, 11)],
    )
