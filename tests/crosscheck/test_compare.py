"""What k may be: 4 for short formulas, and for long ones the number of their roundings."""

from __future__ import annotations

from dataclasses import replace

import pytest

from coadjoint.crosscheck.compare import Subject, most_roundings
from tests.kernels import ProgramReference
from tests.programs import PENDULUM, TOP_ENERGY, TOP_RHS, program


@pytest.mark.parametrize(
    ("value", "roundings"),
    [("x", 0), ("-x", 0), ("x + y", 1), ("x*y*x", 2), ("(x + y)*(x + y)/(x + y)", 5)],
)
def test_roundings_are_counted(value, roundings):
    """A sum counts its longer side, a product or quotient both sides, and each operation one."""
    assert most_roundings(program("f", "x y", "", "", value, ())) == roundings


def threshold(*programs):
    """The k that a system of these functions is allowed."""
    by_name = {each.name: each for each in programs}
    return Subject(by_name, ProgramReference(programs), None, ("numpy",)).threshold


def test_short_formulas_are_held_to_4():
    """The rates and the energy of the heavy top, typed from the book, are short."""
    assert most_roundings(TOP_ENERGY) == 6
    assert threshold(TOP_RHS, TOP_ENERGY) == 4


def test_a_long_formula_may_have_a_k_of_its_roundings():
    """A right formula of 20 factors is not called wrong for the rounding of 19 products."""
    long = program("f", "x y", "", "", "*".join(["x"] * 20), ())
    assert threshold(long, replace(TOP_RHS, name="g")) == 19
    assert threshold(*PENDULUM.programs) == 16
