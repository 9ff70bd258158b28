"""Double and metriplectic brackets where velocities are the state, against those of momenta."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.relaxed import Relaxed
from coadjoint.errors import CoadjointError
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import motion_of
from tests.specs import spec, verdicts_of

#: With Pi = I Omega, a metric G of Pi is I G I of Omega.
BODY = """
title = "A body in velocities"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
a = { positive = true, default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[double_bracket]
G = "a*diag(I)*diag(I)"
[claims]
casimirs = ["dot(diag(I)*Omega, diag(I)*Omega)"]
"""
#: The metriplectic body of Morrison: in momenta G is ``|Omega|^2 - Omega Omega^T``.
ENTROPY = (
    '[double_bracket]\nG = "a*diag(I)*diag(I)"',
    '[metriplectic]\nS = "dot(diag(I)*Omega, diag(I)*Omega)/2"\nG = "a*inverse(diag(I))*(dot(Omega,'
    ' Omega)*diag(vector(1, 1, 1)) - outer(Omega, Omega))*inverse(diag(I))"',
)
#: A metric that mixes coordinates and velocities, on three routes that compute it apart.
POLAR = """
title = "A particle in polar coordinates"
routes = ["nonholonomic", "euler-lagrange", "canonical", "hamel"]
[variables]
r = { role = "coordinate", default = 1 }
f = { role = "coordinate" }
u = { role = "velocity", of = "r" }
w = { role = "velocity", of = "f" }
[parameters]
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[lagrangian]
l = "m*(u^2 + r^2*w^2)/2 - k*r^2/2"
[domain]
away = "r > 0"
[double_bracket]
G = "k*diag(vector(1, 0, 2, 0)) + k*outer(vector(1, 0, 1, 1), vector(1, 0, 1, 1))"
[claims]
conserved = []
"""
TIMED = ('[lagrangian]\nl = "m*(u^2', '[time]\nname = "t"\n[lagrangian]\nl = "(1 + t^2)*m*(u^2')
FORCED = ("[double_bracket]", '[forces]\nu = "k - k*u"\n[double_bracket]')
LAGRANGE = (
    '"nonholonomic", "euler-lagrange", "canonical", "hamel"',
    '"euler-lagrange", "canonical"',
)


def rates(text, *changes, at):
    """The rates of the state at a point, in floats."""
    motion = motion_of(derive(spec(text, *changes)))
    numbers = {name: Fraction(x) for name, x in at.items()}
    closed = motion.decidable_rates.values()
    return np.array([float(motion.field.evaluate(x, numbers, Fraction, None)) for x in closed])


AT = {"I1": 1, "I2": 2, "I3": 4, "a": 3, "Omega1": 5, "Omega2": -2, "Omega3": 7}


def test_a_body_in_velocities_has_the_double_bracket_of_its_momenta():
    """dPi/dt = Pi x Omega + a Pi x (Pi x Omega), of Bloch, Krishnaprasad, Marsden and Ratiu."""
    inertia, omega = np.array([1.0, 2.0, 4.0]), np.array([5.0, -2.0, 7.0])
    Pi = inertia * omega
    free = np.cross(Pi, omega)
    expected = (free + 3 * np.cross(Pi, free)) / inertia
    np.testing.assert_allclose(rates(BODY, at=AT), expected, rtol=1e-14, atol=0)
    wrong = (free - 3 * np.cross(Pi, free)) / inertia
    assert np.abs(wrong - expected).max() > 1


def test_a_body_in_velocities_has_the_metriplectic_bracket_of_its_momenta():
    """dPi/dt = Pi x Omega + a (|Omega|^2 Pi - (Omega . Pi) Omega), of Morrison."""
    inertia, omega = np.array([1.0, 2.0, 4.0]), np.array([5.0, -2.0, 7.0])
    Pi = inertia * omega
    gained = 3 * (omega @ omega * Pi - (omega @ Pi) * omega)
    expected = (np.cross(Pi, omega) + gained) / inertia
    np.testing.assert_allclose(rates(BODY, ENTROPY, at=AT), expected, rtol=1e-14, atol=0)


def test_what_is_claimed_in_momenta_is_proved_in_velocities():
    """The laws of the energy, of the entropy and of the Casimir."""
    found = verdicts_of(BODY)
    assert set(found.values()) == {Verdict.PROVED}
    assert "dh/dt = -<P dh, G P dh>: the energy never grows" in found
    assert "the rates are {x, h} + P G P dh" in found
    square = "dot(diag(I)*Omega, diag(I)*Omega)"
    assert f"{square} is conserved: forces and dissipation do not change it" in found
    found = verdicts_of(BODY, ENTROPY)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the energy is conserved" in found
    assert "dS/dt = <dS, G dS>: the entropy never falls" in found


WRONG = [
    ((('G = "a*', 'G = "-a*'),), "G is positive semidefinite"),
    ((('G = "a*', 'G = "hat(Omega)*'),), "G is symmetric"),
    ((ENTROPY, ('S = "dot(diag(I)*Omega,', 'S = "dot(Omega,')), "P dS = 0: S is a Casimir"),
    ((ENTROPY, ("- outer(Omega, Omega)", "+ outer(Omega, Omega)")), "G dh = 0"),
]


@pytest.mark.parametrize(("changes", "statement"), WRONG)
def test_wrong_conditions_are_refuted_in_velocities(changes, statement):
    """Each with a point."""
    assert verdicts_of(BODY, *changes)[statement] is Verdict.REFUTED


@pytest.mark.parametrize("changes", [(), (TIMED,), (FORCED,), (LAGRANGE,), (LAGRANGE, TIMED)])
def test_routes_agree_on_a_double_bracket_of_velocities(changes):
    """Along the frame by T and J, in (q, v) by the bracket there, in (q, p) by the chain rule."""
    found = verdicts_of(POLAR, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    agree = sum("give the same motion" in text for text in found)
    assert agree == (1 if LAGRANGE in changes else 3)
    assert any(text.startswith("the rates are {x, h} + P G P dh") for text in found)


@pytest.mark.parametrize("part", ["_mixed", "_inverse"])
def test_a_spoiled_double_bracket_is_caught(part, monkeypatch):
    """With a wrong sign in T the routes differ, and the rates are not the double bracket."""
    right = getattr(Relaxed, part).func

    def wrong(self):
        return tuple(tuple(-x for x in row) for row in right(self))

    monkeypatch.setattr(Relaxed, part, property(wrong))
    found = verdicts_of(POLAR)
    assert found["nonholonomic and euler-lagrange give the same motion"] is Verdict.REFUTED
    assert found["the rates are {x, h} + P G P dh"] is Verdict.REFUTED


def test_a_momentum_along_a_section_gains_what_the_bracket_adds():
    """J = w Omega.(I Omega) is no symmetry: its law has the double bracket in it."""
    along = ("[claims]", '[momenta.J]\nsection = { Omega = "vector(1, 2, 3)" }\n[claims]')
    found = verdicts_of(BODY, along)
    assert set(found.values()) == {Verdict.PROVED}
    (law,) = (text for text in found if text.startswith("dJ/dt"))
    assert law == "dJ/dt = Sigma l + <dl/dxi, [xi, Sigma]>"


def test_more_coupled_velocities_than_can_be_inverted_are_refused():
    """A double bracket needs the inverse mass matrix; a metriplectic one does not."""
    text = POLAR.replace('f = { role = "coordinate" }', 'f = { role = "coordinate", shape = [3] }')
    text = text.replace("m*(u^2 + r^2*w^2)/2", "m*(u^2 + dot(w, w) + (u + w1 + w2 + w3)^2)/2")
    text = text[: text.index("[double_bracket]")] + '[double_bracket]\nG = "k"\n'
    with pytest.raises(CoadjointError, match="couples 4 of them") as caught:
        derive(spec(text))
    advice = "Write dissipation of velocities in [dissipation]."
    assert advice in str(caught.value)
    followed = ('[double_bracket]\nG = "k"', '[dissipation]\nR = "k*dot(w, w)/2"')
    assert derive(spec(text, followed, ('"euler-lagrange", "canonical", ', ""))).exact.rates
