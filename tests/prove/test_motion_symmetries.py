"""Symmetries of motions that have no bracket: by Newton's law, by a Lax pair, on a section."""

import pytest

from coadjoint.errors import CoadjointError, SpecError
from coadjoint.prove import Verdict
from tests.prove.test_reductions import IN_STEP, UNFORCED
from tests.specs import spec, verdicts_of

NEWTON = """
title = "A particle about a centre"
routes = ["newton"]
[variables]
x = { role = "coordinate", shape = [3] }
u = { role = "velocity", of = "x" }
[parameters]
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[newton]
x = { mass = "m", force = "-k*x/norm(x)^3" }
[domain]
apart = "norm(x) > 0"
[symmetries.J]
algebra = "so(3)"
vector = "s"
generators = { x = "cross(s, x)" }
map = "m*dot(s, cross(x, u))"
"""
LAX = """
title = "A Lax pair alone"
routes = ["lax"]
[variables]
x = { role = "coordinate", shape = [3] }
[lax]
L = "hat(x)"
M = "hat(vector(x1, x2, 3*x3))"
[symmetries.J]
algebra = "so(2)"
vector = "s"
generators = { x = "s*vector(-x2, x1, 0)" }
map = "s*x3"
"""
#: On the section two oscillators in step are one.
SECTION = (
    IN_STEP.replace(*UNFORCED)
    .replace('[inputs]\nu = { default = 0 }\n[time]\nname = "t"\n', "")
    .replace('c = { positive = true, default = "0.1" }\n', "")
    .replace(
        "[reduction]",
        """[reconstruction]
X = "p1*q2"
[transformations.flip]
map = { q1 = "-q2", p1 = "-p1" }
[symmetries.J]
algebra = "so(2)"
vector = "s"
map = "s*(q1^2 + p2^2)/2"
generators = { q1 = "s*p2", p1 = "-s*q1" }
[reduction]""",
    )
)
MOVES = "the flow of J takes motions to motions"


@pytest.mark.parametrize(
    ("text", "kept"),
    [(NEWTON, "J1 is conserved"), (LAX, "J is conserved"), (SECTION, "J is conserved")],
)
def test_a_symmetry_of_the_motion_is_proved(text, kept):
    """That it is an action, that it moves motions to motions, and that its function is kept."""
    found = verdicts_of(text)
    assert set(found.values()) == {Verdict.PROVED}
    assert MOVES in found
    assert kept in found
    assert any(each.startswith("the generators of J act as so(") for each in found)


WRONG = [
    (NEWTON, ('force = "-k*x/', 'force = "-k*vector(x1, x2, 2*x3)/'), MOVES),
    (NEWTON, ('"cross(s, x)"', '"cross(x, s)"'), "the generators of J act as so(3) from the left"),
    (LAX, ("x1, x2, 3*x3", "x1, 2*x2, 3*x3"), MOVES),
    (SECTION, ('p1 = "-s*q1" }', 'p1 = "s*q1" }'), MOVES),
    (SECTION, ('"-q2", p1 = "-p1"', '"-q2", p1 = "p1"'), "flip takes the motion to itself"),
]


@pytest.mark.parametrize(("text", "change", "statement"), WRONG)
def test_wrong_symmetries_of_a_motion_are_refuted(text, change, statement):
    """With a point."""
    assert verdicts_of(text, change)[statement] is Verdict.REFUTED


def test_a_function_that_no_symmetry_keeps_is_said_not_to_be_kept():
    """X . u in place of the angular momentum; the flow is what it was."""
    found = verdicts_of(NEWTON, ("m*dot(s, cross(x, u))", "m*s[1]*dot(x, u)"))
    assert found["J1 is not conserved"] is Verdict.PROVED
    assert found[MOVES] is Verdict.PROVED


def test_a_symmetry_may_move_time():
    """A constant shift is one, and J is minus the energy; a shift by q1 is none."""
    shift = [
        ('map = "s*(q1^2 + p2^2)/2"', 'map = "0*s"\ntime = "s"'),
        ('q1 = "s*p2", p1 = "-s*q1"', 'q1 = "0*s"'),
    ]
    found = verdicts_of(SECTION, *shift)
    assert set(found.values()) == {Verdict.PROVED}
    assert "J is conserved" in found
    found = verdicts_of(SECTION, *shift, ('time = "s"', 'time = "s*q1"'))
    assert found[MOVES] is Verdict.REFUTED
    free = [
        ("(q1^2 + q2^2)/2 + ", ""),
        ("[hamiltonian]", '[time]\nname = "t"\n[hamiltonian]'),
        ('map = "s*(q1^2 + p2^2)/2"', 'map = "0*s"\ntime = "s*t"'),
        ('q1 = "s*p2", p1 = "-s*q1"', 'q1 = "s*q1"'),
    ]
    found = verdicts_of(SECTION, *free)  # q/t is p, which keeps its value
    assert found[f"{MOVES}, at all times"] is Verdict.PROVED
    found = verdicts_of(SECTION, *free, ('time = "s*t"', 'time = "-s*t"'))
    assert found[f"{MOVES}, at all times"] is Verdict.REFUTED
    with pytest.raises(CoadjointError, match="Leave time out"):
        verdicts_of(NEWTON, ('"cross(s, x)" }', '"cross(s, x)" }\ntime = "s[1]"'))


def test_what_follows_on_a_section_is_not_moved():
    """q2 is q1 there; the rest of the refusals name what to do, which is done above."""
    with pytest.raises(SpecError, match="expected one of q1, p1"):
        spec(SECTION, ('map = { q1 = "-q2"', 'map = { q2 = "-q2", q1 = "-q2"'))
    linear = ('generators = { q1 = "s*p2", p1 = "-s*q1" }', 'linear = ["q1", "q2"]')
    with pytest.raises(SpecError, match="'q2' is not a variable of the state"):
        spec(SECTION, linear)
    with pytest.raises(CoadjointError, match="Declare the momentum map as map"):
        verdicts_of(SECTION, ('map = "s*(q1^2 + p2^2)/2"\n', ""))


FORCED = """
title = "A particle that is driven"
routes = ["euler-lagrange"]
[variables]
x = { role = "coordinate" }
u = { role = "velocity", of = "x" }
[parameters]
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[lagrangian]
l = "m*u^2/2 - k*x^2/2"
[forces]
u = "-k*u"
[symmetries.E]
algebra = "so(2)"
vector = "s"
generators = { x = "0*s" }
time = "s"
"""


def test_a_shift_of_time_is_generated_by_the_energy_also_where_forces_act():
    """X = -{x, h}: forces are no part of what the bracket makes of the energy."""
    found = verdicts_of(FORCED)
    assert set(found.values()) == {Verdict.PROVED}
    assert found["E is their momentum map: {x, E} = dx/ds"] is Verdict.PROVED
    assert "dE/dt = u^2*k, since its flow keeps h" in found
