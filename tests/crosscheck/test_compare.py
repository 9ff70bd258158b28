"""What k may be: 4 for short formulas, and for long ones the number of their levels."""

from __future__ import annotations

from dataclasses import replace

import pytest

from coadjoint.crosscheck.subject import Subject, depth
from tests.kernels import ProgramReference
from tests.programs import PENDULUM, TOP_ENERGY, TOP_RHS, program


@pytest.mark.parametrize(
    ("value", "levels"),
    [("x", 0), ("-x", 0), ("x + y", 1), ("x*y*x", 2), ("(x + y)*(x + y)/(x + y)", 3), ("x/3", 1)],
)
def test_levels_are_counted(value, levels):
    """Each operation is one more than the deeper of its operands."""
    assert depth(program("f", "x y", "", "", value, ())) == levels


def test_a_constant_that_is_not_a_double_counts_as_a_rounding():
    """A tenth is rounded when it is printed, a half is not."""
    assert depth(program("f", "x", "", "", "0.1", ())) == 1
    assert depth(program("f", "x", "", "", "0.5", ())) == 0


def threshold(*programs):
    """The k that a system of these functions is allowed."""
    by_name = {each.name: each for each in programs}
    return Subject(by_name, ProgramReference(programs), None, ("numpy",)).threshold


def test_short_formulas_have_the_threshold_4():
    """A cross product is short; the heavy top, typed from the book, is longer."""
    assert threshold(program("f", "x y", "", "", "x*y - y*x", ())) == 4
    assert threshold(TOP_RHS) == depth(TOP_RHS) == 5
    assert threshold(TOP_ENERGY) == depth(TOP_ENERGY) == 6


def test_a_long_formula_has_a_threshold_by_its_depth():
    """A correct product of 20 factors passes in spite of 19 roundings."""
    long = program("f", "x y", "", "", "*".join(["x"] * 20), ())
    assert threshold(long, replace(TOP_RHS, name="g")) == 19
    assert threshold(*PENDULUM.programs) == 16
