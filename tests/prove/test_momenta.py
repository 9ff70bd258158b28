"""Momentum equations against those written by hand."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import SpecError
from coadjoint.prove import Verdict, momenta
from coadjoint.prove.momenta import _changes, about_momenta, momentum_law
from tests.constrained import BALL, PARTICLE, SLEIGH, motion
from tests.specs import spec, verdicts_of

JELLETT = '[momenta]\njellett = { section = { Omega = "s" } }\n'
#: The ball with an axis of symmetry through its centre of mass: Routh's sphere.
AXIAL = (
    ("diag(I)*Omega", "vector(I1*Omega1, I1*Omega2, I3*Omega3)"),
    ("dot(Gamma, chi)", "chi3*Gamma3"),
    ('s = "r*Gamma + chi"', 's = "r*Gamma + vector(0, 0, chi3)"'),
)


def examined(text, *changes):
    """Statement and verdict of each momentum equation."""
    rates = motion(text, *changes)
    claims = list(about_momenta(rates))
    assert {kind for _, kind, _ in claims} <= {"momentum"}
    return [(statement, examine().verdict) for statement, _, examine in claims]


def test_jelletts_integral_is_a_momentum():
    """M . s of Routh's sphere is conserved by its momentum equation (Routh 1905, article 243)."""
    assert examined(BALL + JELLETT, *AXIAL) == [
        ("jellett is conserved, by its momentum equation", Verdict.PROVED)
    ]


def test_without_an_axis_jelletts_momentum_changes():
    """The generic ball has the same momentum, and it is not conserved."""
    ((statement, verdict),) = examined(BALL + JELLETT)
    assert statement == "djellett/dt = Sigma l + <dl/dxi, [xi, Sigma]>"
    assert verdict is Verdict.PROVED


def test_the_momentum_of_the_particle_by_hand():
    """Along D_u the momentum m (u + y w) = m (1 + y^2) u changes by m w v = m y u v."""
    section = '[momenta]\nalong = { section = { u = "1" } }\n'
    assert examined(PARTICLE + section) == [("dalong/dt = y*u*v*m", Verdict.PROVED)]


def test_forces_work_along_a_section():
    """A force k along v of the sleigh enters the momentum of v: m v' = m a omega^2 + k."""
    section = '[momenta]\nahead = { section = { v = "1" } }\n[forces]\nv = "k"\n'
    assert examined(SLEIGH + section) == [("dahead/dt = omega^2*m*a + k", Verdict.PROVED)]


def test_a_claim_may_name_a_momentum():
    """A momentum is an observable, so that a claim conserved = ["jellett"] may name it."""
    rates = motion(BALL + JELLETT + '[claims]\nconserved = ["jellett"]\n', *AXIAL)
    observables = dict(rates.equations.exact.observables)
    assert rates.field.is_zero(rates.rate(observables["jellett"]))


@pytest.mark.parametrize("changes", [(), AXIAL])
def test_a_wrong_law_is_refuted(changes):
    """A law with the work of gravity counted twice is not that of the momentum."""
    rates = motion(BALL + JELLETT, *changes)
    (section,) = rates.equations.spec.sections
    law = momentum_law(rates.equations, section)
    weight = rates.field["m"] * rates.field["g"] * rates.field["Gamma1"]
    assert _changes(rates, section, law).verdict is Verdict.PROVED
    assert _changes(rates, section, law + weight).verdict is Verdict.REFUTED


#: A symmetric heavy top with the spin and the vertical momentum as sections, nothing bound.
FREE_TOP = """
title = "Heavy top with momenta"
routes = ["euler-poincare", "lie-poisson", "poincare"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
A = { positive = true, default = 1 }
C = { positive = true, default = 2 }
[lagrangian]
l = "(A*Omega1^2 + A*Omega2^2 + C*Omega3^2)/2 - Gamma3"
[momenta]
vertical = { section = { Omega = "Gamma" } }
spin = { section = { Omega = "vector(0, 0, 1)" } }
[claims]
conserved = ["spin"]
"""
#: A particle in the plane under a central force, in velocities, with its angular momentum.
CENTRAL = """
title = "Central force"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[parameters]
m = { positive = true, default = 2 }
[lagrangian]
l = "m*dot(v, v)/2 - dot(q, q)^2"
[momenta]
turning = { section = { v = "vector(-q2, q1)" } }
"""


def test_momenta_of_free_motions():
    """<Pi, Gamma> and Pi3 of a symmetric top; m (q1 v2 - q2 v1) under a central force."""
    found = verdicts_of(FREE_TOP)
    assert set(found.values()) == {Verdict.PROVED}
    assert "vertical is conserved, by its momentum equation" in found
    assert "spin is conserved" in found
    values = derive(spec(FREE_TOP)).observables
    symbols = {name: sympy.Symbol(name) for name in ("Pi1", "Pi2", "Pi3", *"ABC")}
    gamma = [sympy.Symbol(f"Gamma{n}") for n in (1, 2, 3)]
    dot = sum(symbols[f"Pi{n}"] * g for n, g in enumerate(gamma, 1))
    assert sympy.expand(values["vertical"] - dot) == 0
    assert values["spin"] == symbols["Pi3"]
    q1, q2, v1, v2, m = sympy.symbols("q1 q2 v1 v2 m")
    turning = derive(spec(CENTRAL)).observables["turning"]
    assert sympy.expand(turning - m * (q1 * v2 - q2 * v1)) == 0
    assert verdicts_of(CENTRAL)["turning is conserved, by its momentum equation"]


def test_momentum_equations_with_forces():
    """A torque -d Omega loses d Gamma . Omega; gravity beside the centre moves q x p."""
    torque = ("[momenta]", '[forces]\nOmega = "-2*Omega"\n[momenta]')
    found = verdicts_of(FREE_TOP, torque, ('"spin"', ""))
    assert set(found.values()) == {Verdict.PROVED}
    assert "dspin/dt = -2*Pi3/C" in found
    pulled = ("- dot(q, q)^2", "- dot(q, q)^2 - m*q2")
    found = verdicts_of(CENTRAL, pulled)
    assert found["dturning/dt = -q1*m"] is Verdict.PROVED


@pytest.mark.parametrize("factor", [-1, 0, 2])
@pytest.mark.parametrize("text", [FREE_TOP, CENTRAL])
def test_spoiled_momentum_equations_of_free_motions_are_refuted(text, factor, monkeypatch):
    """A force that the equation counts with another size, or not at all."""
    whole = momenta.external_forces
    wrong = lambda setting, names: tuple(factor * f for f in whole(setting, names))  # noqa: E731
    monkeypatch.setattr(momenta, "external_forces", wrong)
    name = "Omega" if "Omega" in text else "v"
    size = 'vector(1, 2, 3)"' if name == "Omega" else 'vector(1, 2)"'
    pushed = ("[momenta]", f'[forces]\n{name} = "{size}\n[momenta]')
    found = verdicts_of(text, pushed, *([('"spin"', "")] if name == "Omega" else []))
    names = ("dvertical", "dturning", "vertical is", "turning is")
    laws = [verdict for statement, verdict in found.items() if statement.startswith(names)]
    assert laws == [Verdict.REFUTED]


def test_momenta_ask_for_a_lagrangian():
    """A Hamiltonian names no velocities; the advice names what to write."""
    text = FREE_TOP.replace("[lagrangian]\nl =", "[hamiltonian]\nh =").replace("Omega", "Pi")
    text = text.replace('Pi = { role = "velocity" }\n', "")
    text = text.replace('["euler-poincare", "lie-poisson", "poincare"]', '["lie-poisson"]')
    with pytest.raises(SpecError, match="without a Lagrangian") as caught:
        spec(text)
    assert "claims.conserved" in str(caught.value)
