"""Equations of motion as sections: complete without the steps of a derivation."""

from dataclasses import replace

import pytest

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.derive.motion import LONGEST_SOLVE, motion_sections
from tests.specs import shipped


def test_rates_that_are_solved_for_are_shown_as_what_is_solved():
    """Bloch (2003), 1.7: (I + m a^2) omega' = -m a omega v, v' = a omega^2."""
    (motion,) = motion_sections(derive(shipped("chaplygin_sleigh")))
    assert [line.text for line in motion.lines] == [
        "(m*a^2 + I) domega_dt = -v*omega*m*a",
        "m dv_dt = omega^2*m*a",
    ]
    assert motion.law == "in components, as the linear equations that the kernel solves"


@pytest.mark.parametrize("name", ["tippe_top", "snakeboard", "chaplygin_sleigh", "appell_machine"])
def test_a_law_names_what_follows(name):
    """Where lines are announced, there are some; what is left to the steps has none."""
    (motion,) = motion_sections(derive(shipped(name)))
    assert motion.lines
    assert "the linear equations that the kernel solves" in motion.law
    assert all("follow" not in part.law for part in (motion,))


def test_long_linear_equations_are_left_to_the_steps(monkeypatch):
    """And the law says so."""
    equations = derive(shipped("chaplygin_sleigh"))
    monkeypatch.setattr("coadjoint.derive.motion.LONGEST_SOLVE", 20)
    (motion,) = motion_sections(replace(equations))
    assert LONGEST_SOLVE > 20
    assert motion.lines == ()
    assert "sets up step by step" in motion.law


@pytest.mark.parametrize(
    ("name", "steps"), [("heisenberg_lattice", "members"), ("zeitlin_su_n", "rows")]
)
def test_the_number_of_members_stands_where_the_steps_are(name, steps):
    """With the principle, and not with the motion, which pages show without steps."""
    sections = document(derive(shipped(name))).sections
    assert not any("follow" in part.law for part in sections if part.kind in ("motion", "members"))
    principle = next(part for part in sections if part.kind == "principle")
    assert steps in dict(principle.words)["steps"]
