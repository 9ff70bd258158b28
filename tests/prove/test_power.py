"""Power: the law of the energy in each combination of what acts, and terms that spoil it."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive.mechanics import external
from coadjoint.derive.routes import hamel, nonholonomic
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.energy import Balance
from coadjoint.prove.integrals import about_energy
from coadjoint.prove.zero import decide_zero
from tests.driven_specs import ROD
from tests.specs import RIGID_BODY, spec

CLAIMS = "[claims]"
ON_BODY = (
    CLAIMS,
    '[forces]\nOmega = "cross(Omega, Pi) - Pi1*Omega"\n[dissipation]\n'
    'R = "Omega1^2 + Omega1*Omega2 + 2*Omega2^2"\n[claims]',
)
SWINGING = ("dot(Omega, diag(I)*Omega)/2", "(2 + sin(t))*dot(Omega, diag(I)*Omega)/2")
CLOCK = ("[parameters]", "[time]\nname = 't'\n[parameters]")
PUSHED = ("[parameters]", "[inputs]\nu = { shape = [3], default = 0 }\n[parameters]")
MOTOR = ("cross(Omega, Pi)", "u")
OSCILLATOR = """
title = "Two masses"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "v1^2 + v1*v2 + v2^2 - dot(q, q)/2"
[forces]
v = "vector(q2, v1*q2 - 3*v2)"
[dissipation]
R = "(v1 - v2)^4"
"""
PLANAR = """
title = "A particle in the plane"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2 + q1^4 + q1*q2"
[forces]
p = "vector(q2 - p1, q1*p2)"
"""
BRACKET = """
title = "Numbers with a bracket"
routes = ["poisson"]
[variables]
x = { role = "coordinate", shape = [3] }
[poisson]
brackets = { "{x1, x2}" = "x3", "{x2, x3}" = "x1", "{x3, x1}" = "x2" }
[hamiltonian]
h = "x1^2 + 2*x2^2 + 3*x3^2"
[forces]
x = "vector(x2 - x1, x1*x2, -2*x3)"
"""
FRAME = (
    RIGID_BODY.replace('["euler-poincare", "lie-poisson"]', '["nonholonomic", "hamel"]')
    .replace('Pi = { role = "momentum" }\n', "")
    .replace('casimirs = ["dot(Pi, Pi)"]\n', "")
)
ON_FRAME = (
    CLAIMS,
    '[forces]\nOmega = "vector(Omega2 - Omega1, Omega1*Omega3, -3*Omega3)"\n'
    '[dissipation]\nR = "Omega1^2 + 2*Omega2^2"\n[claims]',
)
KNIFE = (CLAIMS, '[constraints]\nknife = "Omega1 + 2*Omega2 == 0"\n[claims]')
SPUN = (CLAIMS, '[constraints]\nknife = "Omega1 + 2*Omega2 == 1 + I1"\n[claims]')
BY_FORCES = "the energy changes by the power of the forces"
OWN = "its explicit dependence on time"
MOVING = "the work of the moving constraints"

#: Text, changes, and the law that the balance has to state.
COMBINATIONS = {
    "momenta": (RIGID_BODY, (ON_BODY,), f"{BY_FORCES} and -2 R"),
    "momenta, inputs": (RIGID_BODY, (ON_BODY, MOTOR, PUSHED), f"{BY_FORCES} and -2 R"),
    "momenta, time": (RIGID_BODY, (ON_BODY, SWINGING, CLOCK), f"{BY_FORCES}, -2 R and {OWN}"),
    "velocities": (OSCILLATOR, (), f"{BY_FORCES} and -<dR/dxi, xi>"),
    "canonical": (PLANAR, (), BY_FORCES),
    "bracket": (BRACKET, (), BY_FORCES),
    "frame": (FRAME, (ON_FRAME,), f"{BY_FORCES} and -2 R"),
    "frame, time": (FRAME, (ON_FRAME, SWINGING, CLOCK), f"{BY_FORCES}, -2 R and {OWN}"),
    "constraint": (FRAME, (ON_FRAME, KNIFE), f"{BY_FORCES} and -2 R"),
    "affine constraint": (FRAME, (ON_FRAME, SPUN), f"{BY_FORCES}, -2 R and {MOVING}"),
    "moving constraint": (ROD, (), f"{BY_FORCES} and {MOVING}"),
}
IN_FRAME = [name for name in COMBINATIONS if "frame" in name or "constraint" in name]
SPOILED = {
    "twice": lambda added: tuple(2 * f for f in added),
    "turned": lambda added: (*added[1:], added[0]),
    "lost": lambda added: tuple(0 * f for f in added),
}


def balance(name, route=0):
    """The law of the energy of a combination, and whether it is proved."""
    text, changes, _ = COMBINATIONS[name]
    declared = spec(text, *changes)
    along = motion_of(derive(declared, declared.routes[route], setting=make_setting(declared)))
    ((statement, _, examine),) = about_energy(along)
    found = examine()
    found = found if hasattr(found, "verdict") else decide_zero(found, along.field)
    return statement, found.verdict


@pytest.mark.parametrize("name", COMBINATIONS)
def test_each_law_is_stated_and_proved(name):
    """Power of forces, minus <dR/dxi, xi>, work of constraints that move, and what time adds."""
    assert balance(name) == (COMBINATIONS[name][2], Verdict.PROVED)


@pytest.mark.parametrize("spoil", SPOILED.values(), ids=SPOILED)
@pytest.mark.parametrize("name", COMBINATIONS)
def test_spoiled_forces_break_each_law(name, spoil, monkeypatch):
    """What routes add to the rates is not where the balance takes its power from."""
    added, along = external.added_rates, external.external_forces
    if name in IN_FRAME:
        wrong = lambda setting, names: spoil(along(setting, names))  # noqa: E731
        for route in (nonholonomic, hamel):
            monkeypatch.setattr(route, "external_forces", wrong)
    else:
        monkeypatch.setattr(external, "added_rates", lambda setting: spoil(added(setting)))
    assert balance(name) == (COMBINATIONS[name][2], Verdict.REFUTED)


TERMS = {
    "_lost": ("momenta", "velocities", "frame", "constraint"),
    "_work_of_constraints": ("affine constraint", "moving constraint"),
}


@pytest.mark.parametrize("factor", [-1, 0, 2])
@pytest.mark.parametrize(("term", "name"), [(t, n) for t, names in TERMS.items() for n in names])
def test_each_other_term_counts_as_it_is(term, name, factor, monkeypatch):
    """Dissipation and moving constraints with another sign or size are refuted."""
    found = getattr(Balance, term)
    if term == "_lost":
        wrong = property(lambda self: factor * found.func(self))
    else:
        wrong = lambda self: [factor * each for each in found(self)]  # noqa: E731
    monkeypatch.setattr(Balance, term, wrong)
    assert balance(name)[1] is Verdict.REFUTED


@pytest.mark.parametrize("name", ["momenta, time", "frame, time"])
@pytest.mark.parametrize("factor", [-1, 0, 2])
def test_what_time_adds_counts_as_it_is(name, factor, monkeypatch):
    """dh/dt at fixed momenta, -dl/dt at fixed velocities."""
    from coadjoint.prove import energy

    own = energy.own_change
    monkeypatch.setattr(energy, "own_change", lambda equations: factor * own(equations))
    assert balance(name)[1] is Verdict.REFUTED
