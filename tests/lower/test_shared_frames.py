"""Names of definitions such as ``y = transpose(R)*x``: found, kept where they save, and exact."""

import pytest

from coadjoint.derive import derive
from coadjoint.derive.frame_names import symbols
from coadjoint.errors import CrossCheckError
from coadjoint.lower import shared_frames
from coadjoint.lower.check import check_programs
from coadjoint.lower.evaluation import run
from coadjoint.lower.lowering import lower
from coadjoint.lower.shared_frames import name_frames
from coadjoint.lower.shared_frames import shared_frames as relations_of
from coadjoint.resources import derivations_folder
from tests.specs import spec

BODY = (derivations_folder() / "orbiting_body.toml").read_text(encoding="utf-8")
#: The torque of gravity's gradient on a satellite, by its quaternion.
SATELLITE = """
title = "A satellite by its quaternion"
routes = ["euler-poincare"]
[algebra]
name = "so(3)"
[variables]
q = { role = "quaternion" }
Omega = { role = "velocity" }
Pi = { role = "momentum" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[definitions]
down = "rotate(conjugate(q), vector(0, 0, 1))"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - dot(down, diag(I)*down)/2"
"""
NAMED = ["_y1", "_y2", "_y3", "_z1", "_z2", "_z3"]
#: The same potential with y written out.
PLAIN = (
    ('y = "transpose(rotation(g))*x"\n', ""),
    ('z = "rotation(g)*diag(I)*y"\n', ""),
    ("dot(x, z)", "dot(x, rotation(g)*diag(I)*transpose(rotation(g))*x)"),
)


@pytest.fixture(scope="module")
def equations():
    """Of the body in the field of another one."""
    return derive(spec(BODY))


def count(equations, *names):
    """Operations of functions for one member."""
    programs = lower(equations)
    check_programs(equations, programs)
    return [sum(programs[name].operation_counts().values()) for name in names]


def test_a_potential_of_turned_vectors_is_not_multiplied_out(equations):
    """It was 504 operations; by hand it is 172 (tests/lower/test_lowering.py)."""
    assert {*NAMED} <= {*symbols(spec(BODY))}
    rates, jacobian = count(equations, "rhs", "jacobian")
    plain_rates, plain_jacobian = count(derive(spec(BODY, *PLAIN)), "rhs", "jacobian")
    assert rates <= 172 < 400 < plain_rates
    assert jacobian * 2 < plain_jacobian


def test_a_polynomial_of_the_names_is_found(equations):
    """``y1^2*y3 + y2`` multiplied out has 18 + 3 terms; with x^2 next to it, these stay."""
    equations = name_frames(equations)
    frames, field = relations_of(equations), equations.setting.field
    y1, y2, y3, x = (field[name] for name in ("_y1", "_y2", "_y3", "g14"))
    wanted = y1**2 * y3 + y2 + x**2 * y3 / (1 + x)
    multiplied = equations.close(wanted)
    assert len(field.terms(multiplied)) > 20
    assert field.is_zero(frames.rewrite(field, multiplied) - wanted)


def test_what_is_no_polynomial_of_the_names_stays(equations):
    """One entry of R, and a function of x alone."""
    equations = name_frames(equations)
    frames, field = relations_of(equations), equations.setting.field
    for element in (field["g11"], field["g14"] ** 2 + field["g24"] * field["m"]):
        assert frames.rewrite(field, element) == element


def test_definitions_with_other_arguments_have_no_names(equations):
    """Of functions, of the state without an attitude, and of one term."""
    assert [*shared_frames._find_values(equations)] == NAMED
    assert "_V" in symbols(spec(BODY))
    none = derive(spec(BODY, *PLAIN))
    assert relations_of(none) is None
    assert name_frames(none) is none


@pytest.mark.parametrize("factor", [2, -1])
def test_a_spoiled_remainder_is_caught(equations, factor, monkeypatch):
    """Lowering is undone exactly."""
    true = shared_frames.SharedFrames._element
    monkeypatch.setattr(
        shared_frames.SharedFrames,
        "_element",
        lambda self, field, polynomial: factor * true(self, field, polynomial),
    )
    with pytest.raises(CrossCheckError, match="lowering changed"):
        count(equations, "rhs")


@pytest.mark.parametrize("spoiled", [False, True])
def test_no_terms_cancel_that_the_polynomial_does_not_have(spoiled, monkeypatch):
    """The slope by q2 where q0 = q1 = 0 is 2 q2 (2 I2 q3^2 + I3 (q2^2 - q3^2)), without I1."""
    if spoiled:
        monkeypatch.setattr(shared_frames.SharedFrames, "_cancels", lambda *_: False)
    program = lower(derive(spec(SATELLITE)))["energy_gradient"]
    point = dict.fromkeys(program.names, 0.0) | {"q2": 0.7, "q3": 0.9, "I1": 1e9 / 3, "I2": 2.0}
    point["I3"] = 3.0
    found = run(program, point, float, None)[2]
    expected = 1.4 * (4 * 0.9**2 + 3 * (0.7**2 - 0.9**2))
    assert (abs(found - expected) < 1e-14) is not spoiled
