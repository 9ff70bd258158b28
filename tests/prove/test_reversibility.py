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


def test_a_force_along_a_constraint_tells_no_direction_of_time():
    """A force k v (x, y) on a particle at a rod is odd in velocities, and the rod takes it."""
    k = ("g = {", "k = { default = 1 }\ng = {")
    along = ("[constraints]", '[forces]\nu = "k*x*v"\nv = "k*y*v"\n[constraints]')
    across = ("[constraints]", '[forces]\nu = "-k*y*v"\nv = "k*x*v"\n[constraints]')
    assert found(PENDULUM, along, k)
    assert not found(PENDULUM, across, k)


def test_that_a_motion_does_not_run_back_has_the_scope_of_its_parameters():
    """With friction k of any value but 0."""
    ((statement, _, _),) = about_reversal(motion(SLEIGH, FRICTION))
    assert "not time reversible under" in statement
    assert ", for almost all parameters: " in statement
