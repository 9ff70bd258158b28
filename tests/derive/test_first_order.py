"""Singular Lagrangians: motions by their form of first order, constraints in steps, refusals."""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive, make_setting
from coadjoint.derive.mechanics import bound, first_order
from coadjoint.derive.mechanics.bound import Form, invert
from coadjoint.derive.reference import Reference
from coadjoint.errors import DerivationError, SpecError
from coadjoint.prove import Verdict
from tests.specs import prove_claims, spec, verdicts_of

VORTICES = """
title = "Two point vortices"
routes = ["first-order"]
[variables]
x = { role = "coordinate", shape = [2], default = [0, 1] }
y = { role = "coordinate", shape = [2], default = [0, "0.5"] }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
[parameters]
G = { shape = [2], positive = true, default = [1, 2] }
[lagrangian]
l = "(G1*(y1*u1 - x1*v1) + G2*(y2*u2 - x2*v2))/2 + G1*G2*log((x1 - x2)^2 + (y1 - y2)^2)/4"
[claims]
conserved = ["energy", "G1*x1 + G2*x2", "G1*(x1^2 + y1^2) + G2*(x2^2 + y2^2)"]
"""
#: Only the sum of the velocities of x and y*z' has a kinetic energy.
MIXED = """
title = "A charge on a screw"
routes = ["first-order"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
p = { role = "momentum", of = "x" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[parameters]
m = { positive = true, default = 2 }
b = { positive = true, default = 1 }
[lagrangian]
l = "m*(u + y*w)^2/2 + b*y*w - (x^2 + y^2 + z^2)/2"
[claims]
conserved = ["energy"]
"""
THREE = """
title = "Three coordinates"
routes = ["first-order"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[parameters]
a = { default = 1 }
[lagrangian]
l = "x*v - (x^2 + y^2)/2 + REST"
"""
FOLLOWS = ('z = { role = "coordinate" }', 'z = { role = "coordinate", follows = true }')
HEISENBERG = """
title = "Horizontal curves of Heisenberg's group"
routes = ["euler-poincare"]
[algebra]
name = "h(1)"
[variables]
mu = { role = "momentum" }
xi = { role = "velocity" }
[lagrangian]
l = "(xi1^2 + xi2^2)/2"
"""
BODY = """
title = "A rotor without some moments of inertia"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
Omega = { role = "velocity" }
[lagrangian]
l = "KINETIC"
"""


def rates(equations, **point):
    """The rates of the state at a point, in doubles."""

    def call(function, *arguments):
        return getattr(math, function)(*arguments)

    return Reference(equations).evaluate("rhs", point, float, call)


def refuse(text, *changes):
    """The message that refuses a spec."""
    with pytest.raises(DerivationError) as caught:
        derive(spec(text, *changes))
    return str(caught.value)


def test_vortices_turn_about_one_another_as_helmholtz_says():
    """dx_j/dt = -sum G_k (y_j - y_k)/r^2 and dy_j/dt = sum G_k (x_j - x_k)/r^2, times 1/2."""
    equations = derive(spec(VORTICES))
    x, y, strength = [0.3, -0.7], [0.2, 0.9], [1.5, 0.4]
    square = (x[0] - x[1]) ** 2 + (y[0] - y[1]) ** 2
    point = {"x1": x[0], "x2": x[1], "y1": y[0], "y2": y[1], "G1": strength[0], "G2": strength[1]}
    expected = [-strength[1 - j] * (y[j] - y[1 - j]) / square / 2 for j in (0, 1)]
    expected += [strength[1 - j] * (x[j] - x[1 - j]) / square / 2 for j in (0, 1)]
    np.testing.assert_allclose(rates(equations, **point), expected, rtol=1e-14)


def test_everything_about_vortices_is_proved():
    """Lagrange's equations, the bracket, the energy, the centre and the moment."""
    certificate = prove_claims(spec(VORTICES))
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}
    statements = {claim.statement for claim in certificate.claims}
    assert "d/dt dl/dv = dl/dq along the motion" in statements
    assert "the Poisson bracket satisfies the Jacobi identity" in statements


def test_a_wrong_sign_of_the_bracket_refutes_lagranges_equations(monkeypatch):
    """The claim reads the declared Lagrangian alone, and energy would not see it."""
    right = first_order.invert
    wrong = lambda *given: tuple(tuple(-x for x in row) for row in right(*given))  # noqa: E731
    monkeypatch.setattr(first_order, "invert", wrong)
    verdicts = verdicts_of(VORTICES)
    assert verdicts["d/dt dl/dv = dl/dq along the motion"] is Verdict.REFUTED
    assert verdicts["the energy is conserved"] is Verdict.PROVED


def test_a_momentum_that_is_no_derivative_refutes_lagranges_equations(monkeypatch):
    """So is ``p = dl/dv`` of the momenta that are declared."""
    statement = "d/dt dl/dv = dl/dq along the motion, with p = dl/dv of the declared momenta"
    verdicts = verdicts_of(MIXED)
    assert verdicts[statement] is Verdict.PROVED
    right = first_order._whole_form

    def wrong(setting):
        solved, form = right(setting)
        return solved, Form(form.names, form.theta, form.energy + setting.field["p"])

    monkeypatch.setattr(first_order, "_whole_form", wrong)
    verdicts = verdicts_of(MIXED)
    assert verdicts[statement] is Verdict.REFUTED


def test_a_momentum_gives_what_is_regular_and_the_form_gives_the_rest():
    """By hand: theta = p dx + (p + b) y dz, h = p^2/(2 m) + V, with p = m (u + y w)."""
    x, y, z, p, m, b = 0.3, -0.8, 0.5, 1.2, 2.0, 0.7
    w = y / (p + b)  # along y: (p + b) w = y
    v = (x * y - z) / (p + b)  # along z: d/dt((p + b) y) = -z, with dp/dt = -x
    found = rates(derive(spec(MIXED)), x=x, y=y, z=z, p=p, m=m, b=b)
    np.testing.assert_allclose(found, [p / m - y * w, v, w, -x], rtol=1e-14)


def test_a_constraint_gives_a_coordinate_that_is_declared_to_follow():
    """By hand: z = y - x, and what is left is x y' - x y, so that x' = -x and y' = y."""
    sample = spec(THREE, ("REST", "z*(y - x) - z^2/2"), FOLLOWS)
    equations = derive(sample)
    x, y = equations.state
    assert equations.rates == (-x, y)
    assert equations.velocities["z"] == y - x
    assert equations.velocities["w"] == x + y
    assert equations.observables["z"] == y - x
    certificate = prove_claims(sample)
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}
    (step,) = [each for each in equations.steps if "Constraints" in each.title]
    field = equations.setting.field
    a, b, c = (field[name] for name in "xyz")
    assert [left.text for left, _ in step.lines] == ["0", "z"]
    assert [value for _, value in step.lines] == [a - b + c, b - a]


def test_what_follows_moves_with_time_too():
    """Of z = y - x + sin(t) the velocity is x + y + cos(t), as u = -x - sin(t) and v = y."""
    rest = ("REST", "z*(y - x + sin(t)) - z^2/2")
    equations = derive(spec(THREE, rest, FOLLOWS, ("[lagrangian]", "[time]\n[lagrangian]")))
    field, point = equations.setting.field, {"x": 0.3, "y": -0.8, "t": 0.6}

    def value(name):
        closed = equations.close(field[name])
        return field.evaluate(closed, point, float, lambda called, u: getattr(math, called)(u))

    x, y, t = point.values()
    z = y - x + math.sin(t)
    u, v = -y + z, x + z  # along y: u = z - y; along x: v = x + z
    np.testing.assert_allclose([value(name) for name in "zuv"], [z, u, v], rtol=1e-14)
    np.testing.assert_allclose(value("w"), v - u + math.cos(t), rtol=1e-14)


def test_what_follows_needs_the_rate_of_an_input():
    """Nobody knows it, unless it is declared."""
    rest = ("REST", "z*(y - x + f) - z^2/2")
    driven = ("[lagrangian]", "[inputs]\nf = { default = 0 }\n[lagrangian]")
    assert "needs the rate of f" in refuse(THREE, rest, FOLLOWS, driven)
    known = ("f = { default = 0 }", 'f = { default = 0, rate = "g" }\ng = { default = 0 }')
    assert derive(spec(THREE, rest, FOLLOWS, driven, known)).rates


def test_a_momentum_along_a_section_is_one_of_velocities():
    """Along x it is dl/du = p; along z it is (p + b) y."""
    sections = '[momenta.J]\nsection = { u = "1" }\n[momenta.K]\nsection = { w = "1" }\n'
    equations = derive(spec(MIXED + sections))
    p, y, b = (equations.setting.field[name] for name in ("p", "y", "b"))
    closed = {name: equations.close(value) for name, value in equations.exact.observables}
    assert equations.setting.field.is_zero(closed["J"] - p)
    assert equations.setting.field.is_zero(closed["K"] - (p + b) * y)


PINNED = """
title = "A point that is held at an oscillator"
routes = ["first-order"]
[variables]
x = { role = "coordinate", follows = true }
z = { role = "coordinate", follows = true }
y = { role = "coordinate", default = 1 }
s = { role = "coordinate", default = 0 }
p = { role = "momentum", of = "x", follows = true }
u = { role = "velocity", of = "x" }
f = { role = "velocity", of = "z" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "s" }
[lagrangian]
l = "u^2/2 + 3*x - z*(x - y) + y*w - s^2/2"
"""


def test_constraints_of_constraints_give_momenta_and_multipliers():
    """By hand: x = y lasts for p = x' = y' = -s, and that for 3 - z = p' = -s' = z."""
    equations = derive(spec(PINNED))
    y, s = equations.state
    assert equations.velocities["x"] == y
    assert equations.velocities["p"] == -s
    half = sympy.Rational(3, 2)
    assert [equations.velocities["z"], *equations.rates] == [half, -s, -half]
    assert {c.verdict for c in prove_claims(spec(PINNED)).claims} == {Verdict.PROVED}


CHAINS = [
    ("0", "nothing gives the velocity along d/dz", "in their order: none"),
    ("z", "no motion satisfies -1 = 0", "(1) -1 = 0"),
    ("z*(y - x) - z^2/2", "constraints give z", "follows = true for z"),
    ("z*x*y - z^3/3", "the motion is bound to", "Solve it by hand"),
    ("z*(2*y - x)", "nothing moves", "(1) x - 2*y = 0, so x = 2*y; (2) 5*y = 0, so y = 0; (3)"),
]


@pytest.mark.parametrize(("rest", "problem", "steps"), CHAINS)
def test_steps_end_in_what_is_wrong(rest, problem, steps):
    """Each constraint is shown, in the order in which it was found."""
    said = refuse(THREE, ("REST", rest))
    assert problem in said
    assert steps in said


def test_a_multiplier_is_given_by_what_keeps_its_constraint():
    """Putting x = 2 y into the Lagrangian would lose z, which keeps it: that is step (3)."""
    assert "(3) -z = 0, so z = 0" in refuse(THREE, ("REST", "z*(2*y - x)"))


def test_advice_about_what_follows_is_followed():
    """A coordinate that constraints give, one that none gives, and a term that was missing."""
    bound_ = ("REST", "z*(y - x) - z^2/2")
    assert "Write follows = true for z" in refuse(THREE, bound_)
    assert derive(spec(THREE, bound_, FOLLOWS)).rates
    needless = ("shape = [2], default = [0, 1]", "shape = [2], follows = true")
    assert "Remove follows of x." in refuse(VORTICES, needless)
    assert derive(spec(VORTICES)).rates
    assert "Add the term that determines it" in refuse(THREE, ("REST", "0"))
    assert derive(spec(THREE, ("REST", "-z^2/2"), FOLLOWS)).rates


def test_advice_about_momenta_is_followed():
    """A velocity with a kinetic energy has a momentum, of which one says so."""
    without = ('p = { role = "momentum", of = "x" }\n', "")
    assert "Declare the momentum of x" in refuse(MIXED, without)
    assert derive(spec(MIXED)).rates
    quartic = spec(MIXED, without, ("m*(u + y*w)^2/2", "u^2/2 + u^4/4 + v^2/2 + w^2/2"))
    with pytest.raises(DerivationError, match="Take euler-lagrange if it is regular"):
        derive(quartic)
    regular = ("m*(u + y*w)^2/2", "u^2/2 + u^4/4 + v^2/2 + w^2/2")
    assert derive(spec(MIXED.replace("first-order", "euler-lagrange"), without, regular)).rates


def test_a_singular_lagrangian_of_momenta_is_sent_to_this_route():
    """The kernel of the Hessian, the constraints and the way out are told."""
    text = MIXED.replace('"first-order"', '"canonical"').replace("p = { role", PARTNERS)
    said = refuse(text)
    assert "is 0; expected every velocity in the kinetic energy" in said
    assert "take the route first-order" in said
    assert derive(spec(MIXED)).rates


PARTNERS = 's = { role = "momentum", of = "y" }\nr = { role = "momentum", of = "z" }\np = { role'


def test_momenta_that_time_moves_are_refused():
    """In the potential time may act."""
    time = ("[lagrangian]", "[time]\n[lagrangian]")
    said = refuse(THREE, ("REST", "t*x*w - z^2/2"), time)
    assert "Let time and inputs act in the potential" in said
    assert derive(spec(THREE, ("REST", "t*z - z^2/2"), time, FOLLOWS)).rates


def test_follows_belongs_to_this_route():
    """On other routes a coordinate is part of the state."""
    changed = VORTICES.replace('"first-order"', '"euler-lagrange"')
    with pytest.raises(SpecError, match=r"only the route first-order finds.*Remove follows"):
        spec(changed, ("shape = [2], default = [0, 1]", "shape = [2], follows = true"))


def test_the_inverse_of_a_two_form_is_one():
    """omega^-1 omega = 1 for six coupled components, by Pfaffians; one of more is refused."""
    text = VORTICES[: VORTICES.index("[parameters]")].replace("shape = [2]", "shape = [3]")
    text = text.replace(", default = [0, 1]", "").replace(', default = [0, "0.5"]', "")
    setting = make_setting(spec(text + '[lagrangian]\nl = "x1*v1"\n'))
    field, names = setting.field, setting.state
    x = setting.elements(names)
    theta = tuple(
        field.sum(
            (7 * i + 11 * j * j + i * j * j) % 13 * x[j] * (x[i] if j == 5 else 1) for j in range(6)
        )
        for i in range(6)
    )
    form = Form(names, theta, field.zero)
    inverse, omega = invert(setting, form), form.two_form(field)
    for i in range(6):
        for j in range(6):
            entry = field.sum(inverse[i][k] * omega[k][j] for k in range(6))
            assert field.is_zero(entry - (1 if i == j else 0))


def test_a_long_two_form_is_refused(monkeypatch):
    """The inverse is written out, up to a limit."""
    monkeypatch.setattr(bound, "LARGEST", 1)
    assert "Choose coordinates that decouple them" in refuse(VORTICES)


def test_horizontal_curves_have_a_free_velocity():
    """The last step gives mu3 = 0 and leaves xi3 free: shown, and refused."""
    said = refuse(HEISENBERG)
    assert "(1) mu3 = 0; then nothing gives the velocity along xi3" in said


@pytest.mark.parametrize(
    ("kinetic", "steps"),
    [
        ("Omega1^2/2", "(1) Pi2 = 0; (2) Pi3 = 0; then all velocities are given"),
        ("(Omega1^2 + Omega2^2)/2", "(1) Pi3 = 0; then nothing gives the velocity along Omega3"),
        ("Omega1^2/2 + Omega2^2/6", "(1) Pi3 = 0; (2) -2*Pi1*Pi2 = 0; no component"),
    ],
)
def test_bodies_without_moments_of_inertia_are_bound(kinetic, steps):
    """Euler's equation of Pi3 = 0 is Pi1 Omega2 = Pi2 Omega1: a further constraint or none."""
    assert steps in refuse(BODY, ("KINETIC", kinetic))


def test_exact_numbers_of_a_chain():
    """A step by hand: z = y - x at x = 1/3, y = 2 is 5/3."""
    equations = derive(spec(THREE, ("REST", "z*(y - x) - z^2/2"), FOLLOWS))
    point = {"x": Fraction(1, 3), "y": Fraction(2), "a": Fraction(1)}
    field = equations.setting.field
    value = equations.close(field["z"])
    assert field.evaluate(value, point, Fraction, None) == Fraction(5, 3)
