"""Driven motions: rates typed by hand, and inputs whose rates would be needed."""

import pytest
import sympy

from coadjoint.derive import derive, make_setting
from coadjoint.errors import DerivationError
from tests.driven_specs import BELT, PENDULUM, ROD, SUSLOV, TOP, VELOCITIES
from tests.specs import spec


def rates(text, *changes, route=None):
    """The rates of a spec by the names of the state, and the symbols by name."""
    found = derive(spec(text, *changes), route)
    names = [*found.variables, *found.setting.parameters, *found.setting.driving]
    symbols = {name: sympy.Symbol(name) for name in names}
    return dict(zip(found.variables, found.rates, strict=True)), symbols


def equal(found, expected):
    """Whether two expressions are the same function."""
    return sympy.simplify(found - expected) == 0


def test_a_pendulum_on_a_moving_pivot():
    """L^2 phi'' = -L (g - a w^2 cos(w t)) sin(phi) + u, in momenta."""
    found, s = rates(PENDULUM)
    phi, p, L, g, a, w, t, u = (s[name] for name in ("phi", "p", "L", "g", "a", "w", "t", "u"))
    v = found["phi"]
    acceleration = (
        sympy.diff(v, phi) * found["phi"] + sympy.diff(v, p) * found["p"] + sympy.diff(v, t)
    )
    expected = (-L * (g - a * w**2 * sympy.cos(w * t)) * sympy.sin(phi) + u) / L**2
    assert equal(acceleration, expected)


@pytest.mark.parametrize("i", [1, 2])
def test_velocities_feel_the_growth_of_a_mass(i):
    """d/dt (exp(c t) v + (t, 0)) = u: v' = exp(-c t) (u - (1, 0)) - c v."""
    found, s = rates(VELOCITIES)
    pull = s[f"u{i}"] - (1 if i == 1 else 0)
    expected = sympy.exp(-s["c"] * s["t"]) * pull - s["c"] * s[f"v{i}"]
    assert equal(found[f"v{i}"], expected)


def test_a_body_with_torques():
    """I1 Omega1' = u1, I2 Omega2' = u2 about principal axes, where Omega3 = 0."""
    found = derive(spec(SUSLOV))
    field = found.setting.field
    for i, solve in ((1, found.exact.solves[0]), (2, found.exact.solves[1])):
        assert solve.names == [f"dOmega{i}_dt"]
        acceleration = field.substitute(solve.known[0] / solve.matrix[0][0], {"Omega3": field.zero})
        assert field.is_zero(acceleration - field[f"u{i}"] / field[f"I{i}"])


def test_a_top_in_a_field_that_is_an_input():
    """dPi/dt = Pi x Omega + Gamma x u: the torque of the potential dot(u, Gamma)."""
    found, s = rates(TOP)
    Pi, Gamma, u = (sympy.Matrix([s[f"{n}{i}"] for i in (1, 2, 3)]) for n in ("Pi", "Gamma", "u"))
    Omega = sympy.Matrix([s[f"Pi{i}"] / s[f"I{i}"] for i in (1, 2, 3)])
    expected = Pi.cross(Omega) + Gamma.cross(u)
    assert all(equal(found[f"Pi{i + 1}"], expected[i]) for i in range(3))


def test_a_constraint_that_moves():
    """M (1 + t^4) vx' = f - m t^2 (2 t vx + cos t): virtual displacements are along (1, t^2)."""
    for route in ("nonholonomic", "hamel"):
        setting = make_setting(spec(ROD))
        found = derive(setting.spec, route, setting=setting)
        field = setting.field
        (solve,) = found.exact.solves
        t, vx, m, f = (field[name] for name in ("t", "vx", "m", "f"))
        cosine = field.call("cos", t)
        assert field.is_zero(found.close(solve.matrix[0][0]) - m * (1 + t**4))
        known = f - m * t**2 * (2 * t * vx + cosine)
        assert field.is_zero(found.close(solve.known[0]) - known)


@pytest.mark.parametrize(
    ("text", "change", "name"),
    [
        (VELOCITIES, ("t*v[1]", "u[1]*v[1]"), "u1"),
        (ROD, ("sin(t)", "f*sin(t)"), "f"),
        (ROD, ("t^2*vx", "f*vx"), "f"),
    ],
)
def test_inputs_act_without_their_rates(text, change, name):
    """Where the motion would need du/dt, which nobody knows, the message says what to declare."""
    with pytest.raises(DerivationError, match=rf"input {name}, so .* rate of {name}; expected"):
        derive(spec(text, change))


def test_an_input_with_a_rate_moves_a_constraint():
    """M (1 + t^4) vx' = f - m t^2 (2 t vx + db): what was cos(t) is the rate."""
    for route in ("nonholonomic", "hamel"):
        found = derive(spec(BELT), route)
        field = found.setting.field
        (solve,) = found.exact.solves
        t, vx, m, f, db = (field[name] for name in ("t", "vx", "m", "f", "db"))
        assert field.is_zero(found.close(solve.known[0]) - f + m * t**2 * (2 * t * vx + db))


def test_the_advice_leads_somewhere():
    """With its rate, as a function of time, or as a parameter, the same term is derived."""
    rate = (
        "u = { shape = [2], default = 0 }",
        ('u = { shape = [2], default = 0, rate = "a" }\na = { shape = [2], default = 0 }'),
    )
    derive(spec(VELOCITIES, ("t*v[1]", "u[1]*v[1]"), rate))
    derive(spec(ROD, ("sin(t)", "cos(2*t)*sin(t)")))
    derive(spec(ROD, ("sin(t)", "b*sin(t)"), ("m = {", "b = { default = 1 }\nm = {")))
