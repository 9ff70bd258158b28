"""Coordinates with momenta next to an algebra: the bracket of a product, and the same motion."""

import pytest
import sympy

from coadjoint.derive import derive, structure
from coadjoint.derive.routes import euler_poincare
from coadjoint.errors import SpecError
from coadjoint.prove import Verdict
from tests.specs import spec, verdicts_of

#: A body with a mass on a spring that slides along its first axis.
BODY = """
title = "A body with an oscillator inside"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
v = { role = "velocity", of = "q" }
Pi = { role = "momentum" }
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[hamiltonian]
h = "Pi1^2/(2*I1) + Pi2^2/(2*(I2 + m*q^2)) + Pi3^2/(2*(I3 + m*q^2)) + p^2/(2*m) + k*q^2/2"
[claims]
casimirs = ["dot(Pi, Pi)"]
conserved = ["energy"]
brackets = { "{q, p}" = "1", "{Pi, Pi}" = "hat(Pi)", "{Pi, q}" = "0*Pi" }
"""
#: The same by its Lagrangian, with velocities as the state.
LAGRANGIAN = """
title = "A body with an oscillator inside"
routes = ["nonholonomic"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*(v^2 + q^2*(Omega2^2 + Omega3^2))/2 - k*q^2/2"
"""
I1, I2, I3, m, k, q, p, v = sympy.symbols("I1 I2 I3 m k q p v")
Pi, Omega = (sympy.Matrix(sympy.symbols(f"{name}1:4")) for name in ("Pi", "Omega"))
INERTIA = sympy.diag(I1, I2 + m * q**2, I3 + m * q**2)


def test_the_rates_and_the_bracket_are_typed_by_hand():
    """``dPi/dt = Pi x Omega``, ``dq/dt = p/m``, and the centrifugal force on the mass."""
    found = derive(spec(BODY))
    omega = INERTIA.inv() * Pi
    force = m * q * (omega[1] ** 2 + omega[2] ** 2) - k * q
    expected = [*Pi.cross(omega), p / m, force]
    assert tuple(map(str, found.state)) == ("Pi1", "Pi2", "Pi3", "q", "p")
    assert all(sympy.simplify(a - b) == 0 for a, b in zip(found.rates, expected, strict=True))
    tensor = sympy.Matrix(found.poisson_tensor)
    assert tensor[3:, 3:] == sympy.Matrix([[0, 1], [-1, 0]])
    assert tensor[:3, 3:] == sympy.zeros(3, 2)
    assert tensor[:3, :3] == Pi.hat()
    assert found.observables["v"] == p / m


def test_it_is_the_motion_of_the_lagrangian():
    """Through ``Pi = dl/dOmega, p = dl/dv``: two routes that share no formula."""
    first, other = derive(spec(BODY)), derive(spec(LAGRANGIAN))
    rates = dict(zip(map(str, other.state), other.rates, strict=True))
    momenta = [*(INERTIA * Omega), q, m * v]
    map_ = dict(zip([*Pi, q, p], momenta, strict=True))
    moved = [sum(sympy.diff(each, name) * rates[name] for name in rates) for each in momenta]
    there = [rate.subs(map_, simultaneous=True) for rate in first.rates]
    assert all(sympy.simplify(a - b) == 0 for a, b in zip(moved, there, strict=True))
    assert any(sympy.simplify(each) != 0 for each in moved)


def test_the_bracket_of_the_product_is_proved():
    """Jacobi's identity, the motion, the Casimir and claimed brackets."""
    found = verdicts_of(BODY)
    assert set(found.values()) == {Verdict.PROVED}
    jacobi = "the Poisson bracket satisfies the Jacobi identity"
    assert {jacobi, "the motion by lie-poisson is {x, h}", "{q, p} = 1"} <= found.keys()


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        (('"{q, p}" = "1"', '"{q, p}" = "-1"'), "{q, p} = -1"),
        (('"dot(Pi, Pi)"', '"q^2"'), "q^2 is a Casimir"),
        (('conserved = ["energy"]', 'conserved = ["p"]'), "p is conserved"),
    ],
)
def test_wrong_claims_are_refuted(change, statement):
    """With a point."""
    assert verdicts_of(BODY, change)[statement] is Verdict.REFUTED


@pytest.mark.parametrize("factor", [0, 2])
def test_a_spoiled_pair_is_caught(factor, monkeypatch):
    """By a claimed bracket: another one is Poisson, and gives another motion by the same law."""
    true = structure.canonical_pairs

    def spoil(setting):
        return tuple((x, y, factor * weight) for x, y, weight in true(setting))

    monkeypatch.setattr(structure, "canonical_pairs", spoil)
    assert verdicts_of(BODY)["{q, p} = 1"] is Verdict.REFUTED


#: What makes a symmetric matrix of the coordinate; its velocity may be named.
SYMMETRIC = (
    ('q = { role = "coordinate" }', 'q = { role = "coordinate", shape = [3], form = "symmetric" }'),
    ("p^2/(2*m) + k*q^2/2", "trace(p*p)/(2*m) + k*trace(q*q)/2"),
    ("(I2 + m*q^2)", "I2"),
    ("(I3 + m*q^2)", "I3"),
    ('"{q, p}" = "1", ', ""),
    (', "{Pi, q}" = "0*Pi"', ""),
)


@pytest.mark.parametrize("named", [True, False])
def test_entries_of_symmetric_matrices_are_paired_by_the_trace(named):
    """``{S12, P12} = 1/2``, and 1 on the diagonal, as without an algebra; ``dS/dt = P/m``."""
    unnamed = [] if named else [('v = { role = "velocity", of = "q" }\n', "")]
    found = derive(spec(BODY, *SYMMETRIC, *unnamed))
    assert sympy.Matrix(found.poisson_tensor)[3:6, 6:] == sympy.diag(1, sympy.Rational(1, 2), 1)
    entries = [sympy.symbols(f"{name}11 {name}12 {name}22") for name in "qp"]
    expected = [*(x / m for x in entries[1]), *(-k * x for x in entries[0])]
    assert [sympy.simplify(a - b) for a, b in zip(found.rates[3:], expected, strict=True)] == [
        0
    ] * 6
    if named:
        assert found.observables["v12"] == entries[1][1] / m


def test_a_coordinate_without_a_momentum_is_refused():
    """The advice works; with a Lagrangian the state has velocities."""
    bare = ('p = { role = "momentum", of = "q" }\n', "")
    flat = ("p^2/(2*m) + ", "")
    brackets = ('"{q, p}" = "1", ', "")
    with pytest.raises(SpecError, match="the coordinate 'q' has no momentum"):
        spec(BODY, bare, flat, brackets)


#: The same with momenta of both as the state, by its Lagrangian.
BOTH = (
    BODY.split("[hamiltonian]")[0].replace('["lie-poisson"]', '["euler-poincare", "lie-poisson"]')
    + LAGRANGIAN[LAGRANGIAN.index("[lagrangian]") :]
    + BODY[BODY.index("[claims]") :]
)
#: A mass that slides in a plane, a vertical, and kinetic energies that are not quadratic.
CURVED = """
title = "A heavy body with a mass inside"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Gamma = { role = "advected", representation = "vector" }
Omega = { role = "velocity" }
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
Pi = { role = "momentum" }
[parameters]
m = { positive = true, default = 1 }
b = { positive = true, default = 1 }
[inputs]
u = { default = 0 }
[forces]
v = "vector(u, 0)"
Omega = "vector(0, 0, u)"
[dissipation]
R = "dot(v, v)/2"
[lagrangian]
l = '''
dot(Omega, Omega)/2 + m*((v1 + Omega3*q2)^2 + (v2 - Omega3*q1)^2)/2 + b*(v1^4 + Omega3^4)/4
- dot(q, q)/2 - Gamma3*q1
'''
"""


def test_a_lagrangian_of_both_gives_the_same_rates():
    """Those typed by hand above, on both routes."""
    omega = INERTIA.inv() * Pi
    force = m * q * (omega[1] ** 2 + omega[2] ** 2) - k * q
    expected = [*Pi.cross(omega), p / m, force]
    for route in ("euler-poincare", "lie-poisson"):
        found = derive(spec(BOTH), route)
        assert tuple(map(str, found.state)) == ("Pi1", "Pi2", "Pi3", "q", "p")
        assert all(sympy.simplify(a - b) == 0 for a, b in zip(found.rates, expected, strict=True))
    assert set(verdicts_of(BOTH).values()) == {Verdict.PROVED}


def test_velocities_of_both_may_need_an_iteration():
    """Coupled, with forces, friction, an input and an advected vector; every claim is proved."""
    found = verdicts_of(CURVED)
    assert set(found.values()) == {Verdict.PROVED}
    same = "euler-poincare and lie-poisson give the same motion, through the Legendre transform"
    assert same in found
    assert any("in Newton's iteration" in each for each in found)


def test_another_force_of_coordinates_is_refuted(monkeypatch):
    """With -dl/dq in place of dl/dq."""
    true = euler_poincare._rates_of_coordinates

    def spoil(setting):
        return {x: -rate if x == "p" else rate for x, rate in true(setting).items()}

    monkeypatch.setattr(euler_poincare, "_rates_of_coordinates", spoil)
    same = "euler-poincare and lie-poisson give the same motion, through the Legendre transform"
    assert verdicts_of(BOTH)[same] is Verdict.REFUTED


def test_a_force_along_a_velocity_of_a_coordinate_acts():
    """``dp/dt = ... - c v``, and the balance of energy, with either energy."""
    for text in (BODY, BOTH):
        forced = text.split("[claims]")[0] + '[forces]\nv = "-k*v"\n'
        free, found = derive(spec(text)), derive(spec(forced))
        added = [a - b for a, b in zip(found.rates, free.rates, strict=True)]
        assert [sympy.simplify(each) for each in added] == [0, 0, 0, 0, -k * p / m]
        assert set(verdicts_of(forced).values()) == {Verdict.PROVED}


def test_a_coordinate_of_a_lagrangian_needs_its_velocity():
    """The message writes it, and what it writes is accepted."""
    line = 'v = { role = "velocity", of = "q" }\n'
    changes = ((line, ""), ("m*(v^2 + q^2*(", "m*(q^2*("))
    with pytest.raises(SpecError, match=r"coordinate 'q' has no velocity.*v = { role") as caught:
        spec(BOTH, *changes)
    assert line.strip() in str(caught.value)
    spec(BOTH, changes[1])


@pytest.mark.parametrize("role", ["attitude", "quaternion"])
def test_an_attitude_may_stand_in_the_state_too(role):
    """The momentum in space is that of the algebra alone, and the weight of the mass turns it."""
    text = BOTH.replace("[variables]", f'[variables]\nR = {{ role = "{role}" }}')
    up = "R[3, 3]" if role == "attitude" else "rotate(R, vector(0, 0, 1))[3]"
    text = text.replace('- k*q^2/2"', f'- k*q^2/2 - {up}*q"').split("[claims]")[0]
    assert set(verdicts_of(text).values()) == {Verdict.PROVED}
    names = derive(spec(text)).observables
    assert {"Pi_spatial1", "Pi_spatial2", "Pi_spatial3"} <= set(names)
    assert not any(name.startswith("p_spatial") for name in names)
