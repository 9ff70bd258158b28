"""Kinematics by hand: rates through square roots, signs of entries, velocities that stay zero."""

from __future__ import annotations

import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.constrained import start_motion
from coadjoint.exact.roots import simplify_roots
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Call, Symbol, walk
from tests.constrained import BALL, PARTICLE, SLEIGH, derived, motion
from tests.rolling import FOLLOWED_SLEIGH

BLADE = 'blade = "w == y*u"'
#: h = sqrt(1 + y^2) in the entry of B, alone and beside what is not over it.
OVER_ROOT = (BLADE, 'blade = "w == u/sqrt(1 + y^2)"')
BESIDE_ROOT = (BLADE, 'blade = "w == u*(k + 1/sqrt(1 + y^2))"')
SQUARED = (BLADE, 'blade = "w == u/(sqrt(1 + y^2)*sqrt(1 + y^2)) + u*sqrt(1 + y^2)"')


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
@pytest.mark.parametrize("change", [OVER_ROOT, BESIDE_ROOT], ids=["alone", "beside"])
def test_an_entry_over_a_root_moves_by_the_quotient_rule(change, route):
    """For b = k + 1/h: b' = -y v/h^3, du/dt = -b b' u/(1 + b^2) and dw/dt = b du/dt + b' u."""
    of = motion(PARTICLE, change, route=route)
    u, v, y, k = (of.field[name] for name in ("u", "v", "y", "k"))
    h = of.field.call("sqrt", 1 + y**2)
    b, slope = 1 / h + (k if change is BESIDE_ROOT else 0), -y * v / h**3
    push = -b * slope * u / (1 + b**2)
    values = {"du_dt": push, "dw_dt": b * push + slope * u}
    for name, value in values.items() if route == "nonholonomic" else [("du_dt", push)]:
        assert of.field.is_zero(of.value(of.field[name]) - value)
        assert not of.field.is_zero(of.value(of.field[name]) - value - slope * u)


def test_the_rate_of_a_root_is_computed_once():
    """The rate h' = y v/h has a name, and b' = -b h'/h reads it with the name of b."""
    known = dict(derived(PARTICLE, OVER_ROOT)["nonholonomic"].exact.definitions)
    of = motion(PARTICLE, OVER_ROOT)
    y, v, b, g = (of.field[name] for name in ("y", "v", "_b1", "_g1"))
    h = of.field.call("sqrt", 1 + y**2)
    assert known["_g1"] == y * v / h
    assert known["_e1"] == -b * g / h


def test_other_powers_of_a_root_move_too():
    """For b = 1/h^2 + h: b' = (h - 2/h^2) h'/h."""
    of = motion(PARTICLE, SQUARED)
    y, v = of.field["y"], of.field["v"]
    h = of.field.call("sqrt", 1 + y**2)
    definitions = dict(of.equations.exact.definitions)
    found = of.close(definitions["_e1"])
    assert of.field.is_zero(found - (1 - 2 / h**3) * y * v / h)


def test_entries_begin_with_no_minus_sign():
    """Of s = r Gamma + chi turned, with entries of both signs, s itself is named."""
    of = motion(BALL)
    definitions = dict(of.equations.exact.definitions)
    r = of.field["r"]
    named = [definitions[f"_b{n}"] for n in (1, 2, 3)]
    assert named == [r * of.field[f"Gamma{n}"] + of.field[f"chi{n}"] for n in (3, 2, 1)]


def test_a_velocity_that_stays_zero_is_computed_with_nowhere():
    """Across the blade u = 0, so no operation of the sleigh reads it; its observable shows it."""
    equations = derived(SLEIGH)["nonholonomic"]
    assert equations.numbers == {"u": 0, "du_dt": 0}
    for program in lower(equations).values():
        read = [n for s in program.statements for n in walk(s.value)]
        assert Symbol("u") not in [*read, *(n for o in program.outputs for n in walk(o.value))]


def test_a_function_that_a_definition_is_has_no_second_call():
    """With w = u sin y the entry is sin y, which its rate and the solve read by name."""
    equations = derived(PARTICLE, (BLADE, 'blade = "w == u*sin(y)"'))["nonholonomic"]
    rhs = lower(equations)["rhs"]
    calls = [n for s in rhs.statements for n in walk(s.value) if isinstance(n, Call)]
    assert sorted(call.function for call in calls) == ["cos", "sin"]


def test_roots_are_simplified_only_where_that_is_shorter():
    """(x^2 + y)/h is h; what has no such factor stays as it was written."""
    of = motion(PARTICLE, OVER_ROOT)
    ring, y, u = of.field, of.field["y"], of.field["u"]
    h = ring.call("sqrt", 1 + y**2)
    slope = u * (1 + y**2) / h**3
    assert simplify_roots(ring, slope) == u / h
    assert simplify_roots(ring, u * y / h**3) == u * y / h**3
    assert simplify_roots(ring, u + y) == u + y


def test_the_document_ends_with_brackets_and_what_is_reconstructed():
    """Of the sleigh {M_omega, M_v} = -m (u + a omega), by hand, and the rates of its place."""
    sleigh = motion(FOLLOWED_SLEIGH)
    steps = {step.title: dict(step.lines) for step in sleigh.equations.steps}
    (brackets,) = (lines for title, lines in steps.items() if title.startswith("Almost-Poisson"))
    ring = sleigh.field
    m, a, u, omega = (ring[name] for name in ("m", "a", "u", "omega"))
    ((left, value),) = brackets.items()
    assert left.text == "{M_omega, M_v}"
    assert value == -m * (u + a * omega)
    followed = {
        left.text: value for left, value in steps["Reconstruction, after the motion"].items()
    }
    assert list(followed) == ["dtheta/dt", "dx/dt", "dy/dt"]
    assert followed["dtheta/dt"] == omega


def test_routes_share_the_kinematics_and_not_what_each_adds():
    """Kinematics is built once in a Setting, and a route gives after others what it gives alone."""
    together = derived(BALL)
    setting = together["hamel"].setting
    first, second = start_motion(setting), start_motion(setting)
    assert first.kinematics is second.kinematics
    first.decided.define("_k1", setting.field.one)
    assert second.decided.value(setting.field["_k1"]) == setting.field["_k1"]
    for route in reversed(together):
        alone = derive(together[route].spec, route)
        assert alone.latex() == together[route].latex()
        assert alone.steps != ()
