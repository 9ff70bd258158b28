"""Frobenius' theorem on constraints whose brackets are computed by hand."""

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.findings import NUMBERS, finding, first_nonzero
from coadjoint.prove.integrability import Basis, Growth, about_integrability, brackets_of
from coadjoint.prove.zero import Decision, Discovery
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, derived

#: A disk on a line: its place follows from its angle (Holm 2011, section 12.1).
ON_A_LINE = """
title = "A disk on a line"
routes = ["nonholonomic"]
[variables]
theta = { role = "coordinate" }
x = { role = "coordinate" }
omega = { role = "velocity", of = "theta" }
v = { role = "velocity", of = "x" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
r = { default = 1 }
[lagrangian]
l = "m*v^2/2 + I*omega^2/2"
[constraints]
rolling = "v == r*omega"
"""
#: The same disk upright on a plane: growth (2, 3, 4), and all places are reached.
ON_A_PLANE = """
title = "A disk on a plane"
routes = ["nonholonomic"]
[variables]
theta = { role = "coordinate" }
phi = { role = "coordinate" }
x = { role = "coordinate" }
y = { role = "coordinate" }
vtheta = { role = "velocity", of = "theta" }
vphi = { role = "velocity", of = "phi" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }
[parameters]
m = { positive = true, default = 1 }
r = { default = 1 }
I = { positive = true, default = 1 }
J = { positive = true, default = 1 }
[lagrangian]
l = "m*(vx^2 + vy^2)/2 + I*vtheta^2/2 + J*vphi^2/2"
[constraints]
rolling_x = "vx == r*cos(phi)*vtheta"
rolling_y = "vy == r*sin(phi)*vtheta"
"""


def found(text, *changes):
    """Statements and verdicts about a text's constraints."""
    (equations, *_) = derived(text, *changes).values()
    findings = list(about_integrability(equations))
    assert {kind for _, kind, _ in findings} == {"integrability"}
    return [(statement, examine().verdict) for statement, _, examine in findings]


def values(text, *changes):
    """The brackets of the fields in the constraints, as text."""
    (equations, *_) = derived(text, *changes).values()
    return {name: str(value) for name, value in brackets_of(Basis(equations.distribution)).items()}


def test_a_disk_on_a_line_is_holonomic_and_on_a_plane_it_is_not():
    """On a line x = r theta; on a plane (2, 3, 4), so that a disk can be rolled to any place."""
    ((line, verdict),) = found(ON_A_LINE)
    assert "the constraint is integrable" in line
    assert verdict is Verdict.PROVED
    (plane, first), (growth, second) = found(ON_A_PLANE)
    assert plane == (
        "the constraints are not integrable on any open set, for almost all parameters: "
        "rolling_x([D_vtheta, D_vphi]) = r*sin(phi)"
    )
    assert growth == (
        "growth vector (2, 3, 4) near almost every point, for almost all parameters: the "
        "constraints are completely nonholonomic there"
    )
    assert first is second is Verdict.PROVED


def test_the_bracket_of_the_particle_is_that_of_heisenberg():
    """[d/dx + y d/dz, d/dy] = -d/dz, so dw - y du on it is -1."""
    assert values(PARTICLE) == {"blade([D_u, D_v])": "-1"}
    assert found(PARTICLE)[1][0].startswith(
        "growth vector (2, 3) near almost every point: the constraint is completely"
    )


def test_the_bracket_of_a_sleigh_is_that_of_the_plane():
    """[J, P1] = P2 in se(2), which the blade forbids; turned about, the sign turns too."""
    assert values(SLEIGH) == {"blade([D_omega, D_v])": "1"}
    right = ('name = "se(2)"', 'name = "se(2)"\ninvariance = "right"')
    assert values(SLEIGH, right) == {"blade([D_omega, D_v])": "-1"}


def test_the_bracket_of_suslovs_body_is_that_of_rotations():
    """[J1, J2] = J3, the direction that does not turn."""
    assert values(SUSLOV) == {"wheel([D_turn1, D_turn2])": "1"}


def test_a_ball_keeps_its_height_alone():
    """Of the three rolling constraints of a ball the height is one on positions: growth (3, 5)."""
    assert found(BALL)[1] == (
        "growth vector (3, 5) near almost every point, for almost all parameters: 1 combination of "
        "the 3 constraints is holonomic there, and no more",
        Verdict.PROVED,
    )


def test_constraints_that_are_kept_are_solved_for_a_velocity():
    """A rod on one particle leaves one field, which has no bracket: holonomic, as it should be."""
    ((statement, verdict),) = found(PENDULUM)
    assert statement.startswith("the constraint is integrable")
    assert verdict is Verdict.PROVED
    kept = ("w == y*u", "w - y*u == 0")
    assert set(values(PARTICLE, kept)) == {"blade([D_u, D_v])"}  # w has the coefficient 1
    poles = ("w == y*u", "x*w == x*y*u")
    assert set(values(PARTICLE, poles)) == {"blade([D_v, D_w])"}
    assert found(PARTICLE, kept)[0][0].startswith("the constraint is not integrable")


def test_a_moving_blade_has_the_brackets_of_one_at_rest():
    """Of an affine constraint the linear part is spoken of."""
    (statement, _), _ = found(SLEIGH, ("u == 0", "u == k"))
    assert statement.startswith("of the linear parts, the constraint is not integrable")


def test_integrability_is_refuted_where_one_bracket_is_spoiled():
    """What vanishes for the disk on a line does not once a field is changed."""
    (equations,) = derived(ON_A_LINE).values()
    basis = Basis(equations.distribution)
    field = equations.setting.field
    basis.__dict__["fields"] = {
        "omega": (field.one, field["r"] * field["theta"]),
        "v": (field.zero, field["theta"]),
    }
    name, decision = first_nonzero(brackets_of(basis), field)
    assert (name, decision.verdict) == ("rolling([D_omega, D_v])", Verdict.REFUTED)


@pytest.mark.parametrize("part", ["_minors", "_zeros"])
def test_growth_is_not_proved_by_wrong_minors(part):
    """A minor that vanishes leaves a finding, a bordered one that does not refutes the bound."""
    (equations, *_) = derived(BALL).values()
    growth, field = Growth(Basis(equations.distribution)), equations.setting.field
    assert growth.vector == (3, 5)
    setattr(growth, part, [field.zero if part == "_minors" else field["r"]])
    if part == "_minors":
        assert isinstance(growth.decision, Discovery)
        assert growth.decision.error == NUMBERS
    else:
        assert growth.decision.verdict is Verdict.REFUTED


def test_what_numbers_alone_support_is_a_finding():
    """A bracket that is neither proved zero nor refuted claims nothing."""
    unsure = Decision(Verdict.SUPPORTED, "50-digit values")
    statement, _, examine = finding("integrability", unsure, "it is", "it is not")
    assert statement == "it is"
    assert examine() == Discovery("50-digit values", error=NUMBERS)
