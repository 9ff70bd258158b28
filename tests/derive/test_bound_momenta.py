"""Singular Lagrangians over an algebra, and forces on those over coordinates: motions by hand."""

import math

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics import bound_momenta, first_order
from coadjoint.errors import SpecError
from coadjoint.prove import Verdict
from tests.derive.test_first_order import FOLLOWS, PINNED, THREE, VORTICES, rates, refuse
from tests.specs import spec, verdicts_of

#: A top of which the axis alone has a moment of inertia; its closed form is below.
TOP = """
title = "A fast top"
routes = ["first-order"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum", follows = ["Pi1", "Pi2"], default = [0, 0, 2] }
Omega = { role = "velocity" }
Gamma = { role = "advected", representation = "vector", default = ["0.6", 0, "0.8"] }
[parameters]
I = { positive = true, default = 1 }
w = { positive = true, default = "0.3" }
c = { default = 1 }
[lagrangian]
l = "I*Omega3^2/2 - w*Gamma3"
[claims]
casimirs = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
conserved = ["energy", "Gamma3", "Pi3"]
"""
FORCED = (
    ('conserved = ["energy", "Gamma3", "Pi3"]', ""),
    (
        "[lagrangian]",
        '[inputs]\nu = { default = 0 }\n[forces]\nOmega = "vector(0, 0, u)"\n'
        '[dissipation]\nR = "c*dot(Omega, Omega)/2"\n[lagrangian]',
    ),
)
#: A thin rod has no inertia about itself, and hangs by a weight at its side.
ROD = (
    ('follows = ["Pi1", "Pi2"], default = [0, 0, 2]', 'follows = ["Pi3"], default = [1, 2, 0]'),
    ('"vector", default', '"vector", follows = ["Gamma2"], default'),
    ("I*Omega3^2/2 - w*Gamma3", "I*(Omega1^2 + Omega2^2)/2 - w*Gamma1"),
    (', "Gamma3", "Pi3"', ""),
)
POINT = {"Pi3": 1.7, "Gamma1": 0.3, "Gamma2": -0.4, "Gamma3": 0.8, "I": 1.3, "w": 0.6}
STATIONARY = "d/dt dl/dxi = ad*_xi dl/dxi + dl/da <> a"
LOADED = (
    'l = "(G1*(y1*u1 - x1*v1) + G2*(y2*u2 - x2*v2))/2 + G1*G2*log((x1 - x2)^2 + (y1 - y2)^2)/4"'
)
DRAG = (
    LOADED,
    'l = "G1*(y1*u1 - x1*v1)/2 + G2*(y2*u2 - x2*v2)/2 - (dot(x, x) + dot(y, y))/2"\n'
    '[dissipation]\nR = "(dot(u, u) + dot(v, v))*G1/4"',
)


def test_a_fast_top_precesses_as_in_the_limit_of_no_transverse_inertia():
    """Gamma turns about the axis of the body by Pi3/I - w Gamma3/Pi3: in space that is w/Pi3."""
    turned = POINT["Pi3"] / POINT["I"] - POINT["w"] * POINT["Gamma3"] / POINT["Pi3"]
    expected = [0, POINT["Gamma2"] * turned, -POINT["Gamma1"] * turned, 0]
    equations = derive(spec(TOP))
    assert [str(name) for name in equations.state] == ["Pi3", "Gamma1", "Gamma2", "Gamma3"]
    np.testing.assert_allclose(rates(equations, **POINT), expected, rtol=1e-14, atol=1e-16)


def test_what_follows_is_emitted_and_shown():
    """Pi1 = 0 and Pi2 = 0 are observables, and steps."""
    equations = derive(spec(TOP))
    assert equations.observables["Pi1"] == equations.observables["Pi2"] == 0
    (step,) = [each for each in equations.steps if "singular" in each.title]
    assert [left.text for left, _ in step.lines] == ["0", "Pi1", "0", "Pi2"]


@pytest.mark.parametrize("changes", [(), FORCED, ROD])
def test_everything_about_bound_momenta_is_proved(changes):
    """The law of Euler and Poincare, Dirac's bracket, its Casimirs and the energy."""
    found = verdicts_of(TOP, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    assert any(each.startswith(STATIONARY) for each in found)
    assert "the Poisson bracket satisfies the Jacobi identity" in found
    assert "dot(Pi, Gamma) is a Casimir" in found


def test_friction_on_momenta_that_follow_gives_their_velocities():
    """0 = -Pi3 Omega2 + w Gamma2 - c Omega1 and 0 = Pi3 Omega1 - w Gamma1 - c Omega2, by hand."""
    a, b, c, p, w = POINT["Gamma1"], POINT["Gamma2"], 0.9, POINT["Pi3"], POINT["w"]
    first, second = np.linalg.solve([[c, p], [p, -c]], [w * b, w * a])
    third, g = p / POINT["I"], POINT["Gamma3"]
    turned = np.cross([a, b, g], [first, second, third])
    expected = [0.5 - c * third, *turned]
    found = rates(derive(spec(TOP, *FORCED)), **POINT, c=c, u=0.5)
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_a_rod_moves_as_a_spherical_pendulum():
    """Gamma1 = cos(a): I a'' = -V' with V = w cos(a) + J^2/(2 I cos(a)^2), J = Pi1 Gamma1."""
    a, moment, w, J, p = 0.7, 1.3, 0.6, 0.5, -0.8
    point = {"Gamma1": math.cos(a), "Gamma3": math.sin(a), "I": moment, "w": w}
    point |= {"Pi1": J / math.cos(a), "Pi2": p}
    slope = p / moment  # of a
    force = w * math.sin(a) - J**2 * math.sin(a) / (moment * math.cos(a) ** 3)
    moved = J * math.sin(a) / math.cos(a) ** 2 * slope
    expected = [moved, force, -math.sin(a) * slope, math.cos(a) * slope]
    np.testing.assert_allclose(rates(derive(spec(TOP, *ROD)), **point), expected, rtol=1e-13)


def test_a_constraint_is_divided_by_positive_parameters_alone():
    """w*Gamma2 = 0 gives Gamma2 only where w is not 0."""
    said = refuse(TOP, *ROD, ("w = { positive = true,", "w = {"))
    assert "no component has a factor that is a number or of positive parameters" in said


def test_a_velocity_that_nothing_gives_is_named():
    """Without the weight at its side a rod may turn about itself as it likes."""
    hanging = ("Omega2^2)/2 - w*Gamma1", "Omega2^2)/2 - w*Gamma3")
    upright = ('follows = ["Gamma2"], ', "")
    said = refuse(TOP, *ROD, hanging, upright)
    assert "nothing gives the velocity along Omega3. Constraints in their order: (1)" in said


def test_advice_about_components_that_follow_is_followed():
    """What constraints give is written as advised; what none gives is removed."""
    bare = ('follows = ["Pi1", "Pi2"], ', "")
    said = refuse(TOP, bare)
    assert 'Write follows = ["Pi1", "Pi2"] for Pi.' in said
    assert derive(spec(TOP)).rates
    needless = ('"vector", default', '"vector", follows = ["Gamma2"], default')
    assert "Remove follows of Gamma." in refuse(TOP, needless)
    euler = TOP.replace("first-order", "euler-poincare")
    assert "Or take the route first-order, on which Pi1 and Pi2 follow." in refuse(euler, bare)


def test_forces_over_an_algebra_are_linear_in_velocities():
    """Otherwise nothing solves for the velocities of momenta that follow."""
    cubic = ('R = "c*dot(Omega, Omega)/2"', 'R = "c*dot(Omega, Omega)^2"')
    said = refuse(TOP, *FORCED, cubic)
    assert "Give the energy of the velocities in simpler terms" in said


def test_a_wrong_law_or_bracket_is_refuted(monkeypatch):
    """The claim about the law uses none of it, and the bracket has to give the motion."""
    right = bound_momenta.laws
    monkeypatch.setattr(
        bound_momenta, "laws", lambda of: {x: -rate for x, rate in right(of).items()}
    )
    found = verdicts_of(TOP)
    assert Verdict.REFUTED in {v for text, v in found.items() if text.startswith(STATIONARY)}
    monkeypatch.undo()
    monkeypatch.setattr(bound_momenta, "add", lambda tensor, lost: tensor)
    assert verdicts_of(TOP)["the motion by first-order is {x, h}"] is Verdict.REFUTED


def test_forces_that_are_pushed_wrongly_are_refuted(monkeypatch):
    """What constraints take up of the forces belongs to the motion."""
    monkeypatch.setattr(bound_momenta, "apply", lambda matrix, a: (0 * matrix[0][0],) * len(matrix))
    statement = "the motion by first-order is {x, h} and the forces"
    assert verdicts_of(TOP, *FORCED)[statement] is Verdict.REFUTED


# -- a bracket of the spec, and one of the form ---------------------------------------------------

OSCILLATOR = """
title = "An oscillator, by its bracket and by its form"
routes = ["poisson", "first-order"]
[variables]
q = { role = "coordinate", default = 1 }
p = { role = "coordinate" }
v = { role = "velocity", of = "q" }
f = { role = "velocity", of = "p" }
[poisson]
canonical = [["q", "p"]]
[lagrangian]
l = "p*v - p^2/2 - q^2/2"
[hamiltonian]
h = "p^2/2 + q^2/2"
"""
SAME = "the bracket (d theta)^-1 of the Lagrangian is that of [poisson]"
LAW = "d/dt dl/dv = dl/dq along the motion"
EQUAL = "poisson and first-order give the same motion"


def test_a_declared_bracket_and_that_of_the_form_have_to_agree():
    """Both give the same motion; velocities are emitted by either."""
    found = verdicts_of(OSCILLATOR)
    assert set(found.values()) == {Verdict.PROVED}
    assert {SAME, LAW, EQUAL} <= found.keys()
    equations = derive(spec(OSCILLATOR))
    q, p = equations.state
    assert (equations.observables["v"], equations.observables["f"]) == (p, -q)


@pytest.mark.parametrize(
    ("change", "refuted"),
    [
        (("p*v", "2*p*v"), {SAME, LAW, EQUAL}),
        (("p*v - p^2/2", "p*v - p^2"), {LAW, EQUAL}),
        (('routes = ["poisson", "first-order"]', 'routes = ["first-order"]'), set()),
    ],
)
def test_a_form_of_another_bracket_or_energy_is_refuted(change, refuted):
    """With one route alone the bracket is compared all the same."""
    changes = [change, ("[hamiltonian]\nh = ", "#")] if not refuted else [change]
    found = verdicts_of(OSCILLATOR, *changes)
    assert {text for text, verdict in found.items() if verdict is Verdict.REFUTED} == refuted
    assert SAME in found


def test_a_declared_bracket_leaves_nothing_to_follow_and_no_forces():
    """They are refused where the spec is read."""
    with pytest.raises(SpecError, match="is one of all coordinates"):
        spec(
            OSCILLATOR,
            ('p = { role = "coordinate" }', 'p = { role = "coordinate", follows = true }'),
        )
    forced = ("[hamiltonian]", '[forces]\nv = "-v"\n[hamiltonian]')
    with pytest.raises(SpecError, match=r"poisson does not accept \[forces\]"):
        spec(OSCILLATOR, forced)
    alone = ('"poisson", "first-order"', '"first-order"')
    damped = ("[hamiltonian]", '[forces]\nv = "-v"\n#')
    assert verdicts_of(OSCILLATOR, alone, damped, ('h = "p^2', '# "p^2'))[SAME] is Verdict.PROVED


# -- forces over coordinates ----------------------------------------------------------------------


def test_charges_in_a_strong_field_with_drag_spiral_inwards():
    """G i z' + z = -(G1/2) z' for z = x + i y, by hand: z' = -z/(G1/2 - i G)."""
    z, strength = [0.3 - 0.2j, -0.7 + 0.9j], [1.5, 0.4]
    point = {"x1": 0.3, "x2": -0.7, "y1": -0.2, "y2": 0.9, "G1": 1.5, "G2": 0.4}
    moved = [-w / (strength[0] / 2 - 1j * g) for w, g in zip(z, strength, strict=True)]
    expected = [*(each.real for each in moved), *(each.imag for each in moved)]
    claims = VORTICES[VORTICES.index("[claims]") :]
    changes = (DRAG, (claims, ""))
    np.testing.assert_allclose(rates(derive(spec(VORTICES, *changes)), **point), expected)
    found = verdicts_of(VORTICES, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    assert "d/dt dl/dv = dl/dq - dR/dv along the motion" in found
    assert "the energy changes by -2 R" in found


HELD = ("[lagrangian]", '[forces]\nu = "-3*u"\n[lagrangian]')


def test_friction_enters_the_constraints_of_constraints():
    """By hand: p = -s, and 3 - z - 3 u = p' = -s' = z with u = -s, so z = 3 (1 + s)/2."""
    equations = derive(spec(PINNED, HELD))
    _, s = equations.state
    assert (equations.velocities["z"] - 3 * (1 + s) / 2).expand() == 0
    assert (equations.rates[1] + 3 * (1 + s) / 2).expand() == 0
    assert equations.rates[0] == -s
    found = verdicts_of(PINNED, HELD)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the motion by first-order is {x, h} and the forces" in found


def test_a_force_with_the_wrong_sign_is_refuted(monkeypatch):
    """By Lagrange's equations, and by the balance of energy."""
    right = first_order._forces
    monkeypatch.setattr(first_order, "_forces", lambda *given: tuple(-f for f in right(*given)))
    found = verdicts_of(PINNED, HELD)
    law = "d/dt dl/dv = dl/dq + f along the motion, with p = dl/dv of the declared momenta"
    assert found[law] is Verdict.REFUTED
    assert found["the energy changes by the power of the forces"] is Verdict.REFUTED


def test_advice_about_forces_of_first_order_is_followed():
    """Linear ones are taken; friction alone has no bracket."""
    curved = ("[lagrangian]", '[dissipation]\nR = "v^4"\n[lagrangian]')
    linear = ("[lagrangian]", '[dissipation]\nR = "v^2"\n[lagrangian]')
    rest = ("REST", "z*(y - x) - z^2/2")
    assert "expected forces that are linear in such velocities" in refuse(
        THREE, rest, FOLLOWS, curved
    )
    assert derive(spec(THREE, rest, FOLLOWS, linear)).rates
    alone = ("[lagrangian]", '[dissipation]\nR = "w^2"\n[lagrangian]')
    said = refuse(THREE, ("REST", "-z^2/2"), alone)
    assert "Add the kinetic energy of these velocities" in said
    momentum = ("[parameters]", 'p = { role = "momentum", of = "z" }\n[parameters]')
    assert derive(spec(THREE, ("REST", "w^2/2 - z^2/2"), momentum, alone)).rates
