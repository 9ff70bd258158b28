"""Time reversal of constrained motions, found or refuted."""

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.reversibility import about_reversal
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, motion

FRICTION = ("[constraints]", '[dissipation]\nR = "k*v^2/2"\n[constraints]')
MOVING = ("u == 0", "u == k")
#: A term linear in a velocity that is no time derivative: a magnetic force.
MAGNETIC = ("(u^2 + v^2 + w^2)/2", "(u^2 + v^2 + w^2)/2 + k*x*v")


def found(text, *changes):
    """Whether the motion is found to be reversible; what is found must be proved."""
    ((statement, kind, examine),) = about_reversal(motion(text, *changes))
    assert kind == "transformation"
    decision = examine()
    assert decision.verdict is Verdict.PROVED
    assert ("not time reversible" in statement) == decision.method.startswith("the value ")
    return "not time reversible" not in statement


@pytest.mark.parametrize("text", [PARTICLE, SLEIGH, PENDULUM, BALL])
def test_motions_without_dissipation_run_back(text):
    """Quadratic Lagrangians under linear constraints have reversible motions."""
    assert found(text)


@pytest.mark.parametrize(
    ("text", "change"),
    [(SLEIGH, FRICTION), (SLEIGH, MOVING), (PARTICLE, MAGNETIC)],
    ids=["friction", "moving constraint", "magnetic force"],
)
def test_what_tells_the_direction_of_time_is_found(text, change):
    """Friction, a moving constraint and a magnetic force: each is told by a point."""
    assert not found(text, change)


def test_a_constraint_that_is_kept_must_be_turned_too():
    """The constraint x u + y v = k drives the particle outwards, and not back."""
    assert not found(
        PENDULUM, ("x*u + y*v == 0", "x*u + y*v == k"), ("g = {", "k = { default = 1 }\ng = {")
    )
