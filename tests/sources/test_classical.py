"""Closed forms and published facts of classical nonholonomic motions, each with its source."""

import importlib
from fractions import Fraction

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import KernelArgumentError
from coadjoint.prove import Verdict
from tests.sources.test_multipliers import closed, written_out
from tests.specs import prove_claims, spec, verdicts_of

#: tanh and 1/cosh of ``q t``, and cosine and sine of ``q t``.
T, S, C, D, q = sympy.symbols("T S C D q")
HYPERBOLIC = ({T: q * S**2, S: -q * S * T}, S**2 + T**2 - 1)
CIRCULAR = ({C: -q * D, D: q * C}, C**2 + D**2 - 1)


def check_curve(rates, curve, along, fixed):
    """A curve obeys derived equations.

    Args:
        rates: By component, as `tests.sources.test_multipliers.closed` gives them.
        curve: The state by component, in symbols that move.
        along: How those symbols move, and the relation that they keep.
        fixed: Values of parameters.
    """
    moving, relation = along
    at = {sympy.Symbol(n): e for n, e in (fixed | curve).items()}
    assert any(sympy.diff(e, s) != 0 for e in map(sympy.sympify, curve.values()) for s in moving)
    for name, value in curve.items():
        moved = sum(sympy.diff(value, s) * rate for s, rate in moving.items())
        known = rates[name].subs(
            {sympy.sin(sympy.Symbol("xi")): D, sympy.cos(sympy.Symbol("xi")): C}
        )
        defect = sympy.numer(sympy.together(moved - known.subs(at, simultaneous=True)))
        assert sympy.rem(sympy.expand(defect), relation, *moving) == 0, name


def simulated(name, *arguments, **options):
    """A trajectory of a shipped system."""
    module = importlib.import_module(f"coadjoint.systems.{name}")
    found = module.simulate(*arguments, **options)
    assert found.status == "OK"
    return module, found


# -- Chaplygin's sleigh: Chaplygin (1911), Bloch (2003), section 1.7 -------------------------------

m, a, V, W = sympy.symbols("m a V W", positive=True)
#: ``2 E = m V^2 = (I + m a^2) W^2``.
INERTIA = m * V**2 / W**2 - m * a**2


@pytest.mark.parametrize("side", [1, -1])
def test_the_sleigh_comes_to_the_speed_root_of_2E_over_m(side):
    """V = V tanh(q t), omega = W/cosh(q t), q = a W^2/V, V = sqrt(2 E/m); not to the other side."""
    curve = {"v": side * V * T, "omega": W * S}
    moving = {s: e.subs(q, a * W**2 / V) for s, e in HYPERBOLIC[0].items()}, HYPERBOLIC[1]
    fixed = {"m": m, "a": a, "I": INERTIA}
    if side == 1:
        check_curve(closed("chaplygin_sleigh"), curve, moving, fixed)
    else:
        with pytest.raises(AssertionError):
            check_curve(closed("chaplygin_sleigh"), curve, moving, fixed)


def test_a_run_of_the_sleigh_follows_the_closed_form():
    """From slowly backwards, blade first, the sleigh turns round and goes on straight."""
    speed, turn, arm = 2.0, 1.0, 0.5
    given = {"m": 1.0, "a": arm, "I": speed**2 / turn**2 - arm**2}
    t = np.linspace(0, 40, 81)
    phase = arm * turn**2 / speed * (t - 20)
    _, found = simulated(
        "chaplygin_sleigh", [speed * np.tanh(phase[0]), turn / np.cosh(phase[0])], t, given
    )
    np.testing.assert_allclose(found["v"], speed * np.tanh(phase), atol=1e-8)
    np.testing.assert_allclose(found["omega"], turn / np.cosh(phase), atol=1e-8)
    limit = np.sqrt(2 * found["energy"][0] / given["m"])
    assert abs(found["v"][-1] - limit) < 1e-3 < abs(found["v"][40] - limit)
    assert found.drift["energy"] < 1e-9


def test_the_track_of_the_sleigh_turns_by_the_closed_form():
    """Theta = (W/q) (gd(q t) - gd(q t0)), and the blade moves along its direction."""
    t = np.linspace(-10, 10, 41)
    given = {"m": 1.0, "a": 0.5, "I": 3.75}  # V = 2, W = 1, q = 1/4
    start = [2 * np.tanh(t[0] / 4), 1 / np.cosh(t[0] / 4)]
    _, found = simulated("chaplygin_sleigh", start, t, given, reconstruct=True)
    angle = 4 * (np.arctan(np.sinh(t / 4)) - np.arctan(np.sinh(t[0] / 4)))
    np.testing.assert_allclose(found["theta"], angle, atol=1e-8)
    assert np.abs(found["theta"] + angle).max() > 1


# -- Suslov (1946), section 53; a = e3, I12 = 0 ----------------------------------------------------

A, B, kappa = sympy.symbols("A B kappa", positive=True)


def suslov_curve(side=1):
    """``(A cos, B sin)`` of an angle that goes from ``phi0 - pi/2`` to ``phi0 + pi/2`` as gd(q t).

    On the ellipse ``I11 A^2 = I22 B^2`` of the energy the angle moves by the speed
    ``I13 Omega1 + I23 Omega2``, which is ``A B kappa/cosh(q t)``.
    """
    c, s = sympy.Rational(3, 5), sympy.Rational(4, 5)
    curve = {"Omega1": A * (c * S - side * s * T), "Omega2": B * (s * S + side * c * T)}
    fixed = {
        "I11": q_inertia(B),
        "I12": 0,
        "I13": B * c * kappa,
        "I22": q_inertia(A),
        "I23": A * s * kappa,
        "I33": sympy.Symbol("I33"),
        **{"a1": 0, "a2": 0, "a3": 1},
    }
    return curve | {"Omega3": sympy.S.Zero}, fixed


def q_inertia(other):
    """``I11 = B^2 kappa/q`` and ``I22 = A^2 kappa/q``."""
    return other**2 * kappa / q


@pytest.mark.parametrize("side", [1, -1])
def test_suslov_goes_from_one_steady_rotation_to_the_opposite_one(side):
    """The closed form in tanh and 1/cosh; run backwards it does not pass."""
    curve, fixed = suslov_curve(side)
    if side == 1:
        check_curve(closed("suslov"), curve, HYPERBOLIC, fixed)
    else:
        with pytest.raises(AssertionError):
            check_curve(closed("suslov"), curve, HYPERBOLIC, fixed)
    ends = [[e.subs({T: end, S: 0}) for e in curve.values()] for end in (-1, 1)]
    assert ends[0] == [-e for e in ends[1]]
    assert any(ends[0])


def test_a_run_of_suslov_keeps_its_constraint_and_ends_opposite():
    """Along a run: the closed form, the constraint to rounding, energy as the method has it."""
    curve, fixed = suslov_curve()
    at = {A: 1, B: 1.5, kappa: 0.4, q: 0.5, sympy.Symbol("I33"): 3}
    given = {n: float(sympy.sympify(e).subs(at)) for n, e in fixed.items()}
    packed = {"I": [given[f"I{n}"] for n in (11, 12, 13, 22, 23, 33)], "a": [0, 0, 1]}
    t = np.linspace(-20, 20, 41)
    exact = np.array(
        [np.broadcast_to(sympy.lambdify((T, S), e.subs(at))(np.tanh(t / 2), 1 / np.cosh(t / 2)), 41)
         for e in curve.values()]
    )  # fmt: skip
    module, found = simulated("suslov", exact[:, 0], t, packed)
    np.testing.assert_allclose(found["Omega"], exact, atol=1e-6)
    np.testing.assert_allclose(found["Omega"][:, -1], -found["Omega"][:, 0], atol=1e-3)
    residual = module.constraint_residual(np.ascontiguousarray(found["Omega"]), packed)
    assert np.abs(residual).max() < 1e-15
    assert found.drift["energy"] < 1e-9
    off = module.constraint_residual(found["Omega"] + np.array([[0], [0], [0.1]]), packed)
    assert np.abs(off).min() > 0.05


# -- Veselov and Veselova (1988) -------------------------------------------------------------------

NAMES = ("Omega1", "Omega2", "Omega3", "Gamma1", "Gamma2", "Gamma3")
STATE = sympy.symbols(NAMES)
OMEGA, GAMMA = sympy.Matrix(STATE[:3]), sympy.Matrix(STATE[3:])
MOMENTS = sympy.symbols("I1 I2 I3")


def vanishes(expression):
    """Whether a rational expression is zero where ``Omega . Gamma = 0``."""
    root = sympy.solve(OMEGA.dot(GAMMA), STATE[2])[0]
    return sympy.expand(sympy.numer(sympy.together(expression.subs(STATE[2], root)))) == 0


def along(function):
    """The rate of a function along the motion."""
    rates = closed("veselova")
    return sum(sympy.diff(function, x) * rates[str(x)] for x in STATE)


def test_veselova_keeps_the_horizontal_momentum_of_space():
    """(I Omega x Gamma)' = (I Omega x Gamma) x Omega: fixed in space, and so is its square.

    That of I Omega itself does not stay: the reaction turns the body about the vertical.
    """
    M = sympy.diag(*MOMENTS) * OMEGA
    K = M.cross(GAMMA)
    assert all(vanishes(along(e) - moved) for e, moved in zip(K, K.cross(OMEGA), strict=True))
    assert vanishes(along(K.dot(K)))
    assert not vanishes(along(M.dot(M)))


@pytest.mark.parametrize("power", [Fraction(1, 2), Fraction(-1, 2)])
def test_veselova_has_an_invariant_measure(power):
    """The density ``(Gamma . I^-1 Gamma)^(1/2)``, and not its inverse, has no divergence."""
    rates = closed("veselova")
    weight = sum(x**2 / i for x, i in zip(GAMMA, MOMENTS, strict=True))
    exponent = sympy.Rational(power.numerator, power.denominator)
    spread = sum(sympy.diff(rates[str(x)], x) for x in STATE)
    spread += exponent * sum(sympy.diff(weight, x) * rates[str(x)] for x in STATE) / weight
    assert vanishes(spread) is (power > 0)


def test_a_round_body_of_veselova_turns_steadily():
    """With equal moments Omega stays, where one that differs makes it move."""
    rates = [closed("veselova")[name] for name in NAMES[:3]]
    even = dict.fromkeys(MOMENTS, MOMENTS[0])
    assert all(vanishes(rate.subs(even)) for rate in rates)
    assert not all(vanishes(rate.subs(MOMENTS[1], MOMENTS[0])) for rate in rates)


# -- disk that rolls upright: Bloch (2003), section 1.4 --------------------------------------------


def test_an_upright_disk_goes_round_a_circle():
    """Of radius r theta'/phi', and after one turn of phi it is back where it began."""
    t = np.linspace(0, 2 * np.pi, 41)
    _, found = simulated("rolling_disk_vertical", [0, 0, 0, 0, 3, 1], t, {"r": 0.5})
    np.testing.assert_allclose(found["x"], 1.5 * np.sin(t), atol=1e-9)
    np.testing.assert_allclose(found["y"], 1.5 * (1 - np.cos(t)), atol=1e-9)
    assert np.abs(found["x"] + 1.5 * np.sin(t)).max() > 1


# -- snakeboard: Bloch, Krishnaprasad, Marsden and Murray (1996), section 8.4 ----------------------


def momentum_defect(inertia):
    """``p' - (2 J0 cos^2(phi) phi' psi' - tan(phi) phi' p)`` at an allowed point, 50 digits."""
    names = "v1 v2 omega psi phi vpsi vphi m J J0 J1 l"
    v1, v2, omega, psi, phi, vpsi, vphi, mass, J, J0, J1, arm = sympy.symbols(names)
    found = closed("snakeboard")
    p = found["p"]
    rate = sum(sympy.diff(p, x) * found[str(x)] for x in (v1, v2, omega, psi, phi, vpsi, vphi))
    law = 2 * J0 * sympy.cos(phi) ** 2 * vphi * vpsi - sympy.tan(phi) * vphi * p
    at = {omega: 2, psi: 1, phi: sympy.Rational(1, 3), vpsi: 3, vphi: 5, mass: 7, J0: 2, J1: 3}
    at |= {arm: 4, J: inertia}
    at |= {v1: -4 * at[omega] * sympy.cos(at[phi]) / sympy.sin(at[phi]), v2: 0}
    return abs((rate - law).subs(at).evalf(50))


def test_the_snakeboard_obeys_its_momentum_equation():
    """``p' = 2 J0 cos^2(phi) phi' psi' - tan(phi) phi' p`` for ``J + J0 + 2 J1 = m l^2`` alone."""
    assert momentum_defect(7 * 4**2 - 2 - 2 * 3) < 1e-40
    assert momentum_defect(1) > 1


def test_a_run_of_the_snakeboard_keeps_its_constraints():
    """Both to rounding, as they turn with the wheels, and the energy as the method has it."""
    turn, angle = 0.3, 0.4
    arm = 0.2
    start = [-arm * turn / np.tan(angle), 0, turn, 0, angle, 2.0, 0.05]
    module, found = simulated("snakeboard", start, (0, 10))
    state = np.array([found[name] for name in ["v1", "v2", "omega", "psi", "phi", "vpsi", "vphi"]])
    assert np.abs(module.constraint_residual(state)).max() < 1e-15
    assert found.drift["energy"] < 1e-9
    assert np.ptp(found["p"]) > 1e-3  # it is no integral
    assert np.abs(module.constraint_residual(state + 0.1)).max() > 1e-3


def test_the_snakeboard_stops_where_a_constraint_is_lost():
    """With wheels that turn steadily the run ends as they come to lie across, at phi = pi/2."""
    start = [-0.2 * 0.3 / np.tan(0.4), 0, 0.3, 0, 0.4, 2.0, 0.5]
    module = importlib.import_module("coadjoint.systems.snakeboard")
    found = module.simulate(start, (0, 10))
    assert found.status == "DOMAIN"
    assert abs(found.time[-1] - (np.pi / 2 - 0.4) / 0.5) < 1e-6
    assert np.isfinite(found["v1"]).all()
    with pytest.raises(KernelArgumentError, match=r"steered, cos.phi. > 0, .* phi = 2"):
        module.simulate([1, 0, 0, 0, 2.0, 1, 0.1], (0, 1))


# -- knife edge on an inclined plane: Bloch (2003), section 1.6 ------------------------------------


@pytest.mark.parametrize("side", [1, -1])
def test_a_knife_edge_on_an_inclined_plane_goes_round_a_cycloid(side):
    """With xi = q t its speed is ``(g/q) sin(q t)``: it drifts across the slope and stays up."""
    g = sympy.Symbol("g")
    speed = side * g / q * D
    xi = sympy.Symbol("xi")
    curve = {"vxi": q, "vx": speed * C, "vz": speed * D}
    curve |= {"x": side * g / (2 * q**2) * D**2}
    fixed = {"k": 0, "eps": 0, "kx": 0, "kz": 0, "g": g, "xi": xi, "z": sympy.Symbol("z")}
    if side == 1:
        check_curve(closed("knife_edge_cvt"), curve, CIRCULAR, fixed)
    else:
        with pytest.raises(AssertionError):
            check_curve(closed("knife_edge_cvt"), curve, CIRCULAR, fixed)


def test_a_run_of_the_driven_blade_keeps_its_constraint():
    """The blade to rounding, and energy and the driver's own, along two hundred oscillations."""
    start = {"xi": 0.5, "x": 1, "z": 0, "vxi": 1, "vx": 0, "vz": 0}
    module, found = simulated("knife_edge_cvt", start, (0, 200), {"eps": 0.1})
    state = np.array([found[name] for name in start])
    assert np.abs(module.constraint_residual(state)).max() < 1e-15
    assert found.drift["energy"] < 1e-7
    assert found.drift["driver"] < 1e-7
    assert np.ptp(found["vz"]) > 0.1
    assert np.abs(module.constraint_residual(state + 0.1)).max() > 1e-2


# -- forces, dissipation and constraints that move -------------------------------------------------

DRAGGED = """
title = "Sleigh with drag"
routes = ["nonholonomic", "hamel"]

[algebra]
name = "se(2)"

[variables]
v = { role = "velocity", block = ["P1"], unit = "m/s" }
u = { role = "velocity", block = ["P2"], unit = "m/s" }
omega = { role = "velocity", block = "rotation", unit = "1/s" }

[parameters]
m = { default = 1, unit = "kg" }
I = { default = 1, unit = "kg m^2" }
a = { default = 1, unit = "m" }
k = { default = "0.1", unit = "1/s" }

[lagrangian]
l = "m*(v^2 + (u + a*omega)^2)/2 + I*omega^2/2"

[constraints]
blade = "u == 0"

[forces]
v = "-k*m*v"
omega = "-k*(I + m*a^2)*omega"
"""
FORCES = DRAGGED[DRAGGED.index("[forces]") :]
RAYLEIGH = '[dissipation]\nR = "k*(m*v^2 + (I + m*a^2)*omega^2)/2"\n'


@pytest.mark.parametrize("table", [FORCES, RAYLEIGH], ids=["forces", "dissipation"])
@pytest.mark.parametrize("wrong", [False, True])
def test_a_dragged_sleigh_goes_the_same_way_more_slowly(table, wrong):
    """Drag in proportion to momenta: ``e^-kt`` times the free motion at the time (1 - e^-kt)/k.

    Its symbols: ``E = e^-kt``, ``E' = -k E``, and tanh and 1/cosh move by E times their rates.
    """
    E, k = sympy.symbols("E k")
    text = spec(
        DRAGGED, (FORCES, table.replace("-k", "k").replace('"k*(m', '"-k*(m') if wrong else table)
    )
    curve = {"v": E * V * T, "omega": E * W * S}
    turning = E * a * W**2 / V
    moving = {T: turning * S**2, S: -turning * S * T, E: -k * E}, S**2 + T**2 - 1
    rates = written_out(derive(text))
    fixed = {"m": m, "a": a, "I": INERTIA, "k": k}
    if wrong:
        with pytest.raises(AssertionError):
            check_curve(rates, curve, moving, fixed)
    else:
        check_curve(rates, curve, moving, fixed)


@pytest.mark.parametrize("table", [FORCES, RAYLEIGH], ids=["forces", "dissipation"])
def test_drag_takes_its_power_from_the_energy(table):
    """The certificate proves the balance; by hand, ``E' = -2 k E``; that E stays is refuted."""
    text = spec(DRAGGED, (FORCES, table + '\n[claims]\nconserved = ["energy"]\n'))
    verdicts = verdicts_of(text)
    gain = "the power of the forces" if table == FORCES else "-2 R"
    assert verdicts[f"the energy changes by {gain}"] is Verdict.PROVED
    assert verdicts["energy is conserved"] is Verdict.REFUTED
    rates = written_out(derive(text))
    energy = rates["energy"]
    changed = sum(sympy.diff(energy, sympy.Symbol(n)) * rates[n] for n in ("v", "omega"))
    assert sympy.simplify(changed + 2 * sympy.Symbol("k") * energy) == 0


TURNTABLE = """
title = "Ball on a turntable"
routes = ["nonholonomic", "hamel"]

[algebra]
name = "so(3)"
invariance = "right"

[variables]
Omega = { role = "velocity", unit = "1/s" }
x = { role = "coordinate", unit = "m" }
y = { role = "coordinate", unit = "m" }
vx = { role = "velocity", of = "x", unit = "m/s" }
vy = { role = "velocity", of = "y", unit = "m/s" }

[parameters]
m = { positive = true, default = 1, unit = "kg" }
r = { positive = true, default = 1, unit = "m" }
share = { positive = true, default = "0.4" }
w = { default = 1, unit = "1/s" }

[lagrangian]
l = "share*m*r^2*dot(Omega, Omega)/2 + m*(vx^2 + vy^2)/2"

[constraints]
slip_x = "vx == r*Omega2 - w*y"
slip_y = "vy == w*x - r*Omega1"
"""


@pytest.mark.parametrize(
    ("share", "expected"), [("2/5", "2/7"), ("2/3", "2/5")], ids=["solid", "hollow"]
)
def test_a_ball_on_a_turntable_goes_round_a_circle(share, expected):
    """``(vx, vy)' = (2/7) w (-vy, vx)`` of a solid ball, whatever its start; 2/5 of a hollow one.

    A classical result, for instance of Routh (1884), Advanced Rigid Dynamics.
    """
    equations = derive(spec(TURNTABLE))
    rates = written_out(equations)
    part, w = sympy.Rational(expected) * sympy.Symbol("w"), {"share": sympy.Rational(share)}
    assert [*equations.setting.state] == ["Omega1", "Omega2", "Omega3", "x", "y"]
    names = sympy.symbols(equations.setting.state)
    turned = {"vx": -part * rates["vy"], "vy": part * rates["vx"]}
    for name, value in turned.items():
        moved = sum(sympy.diff(rates[name], n) * rates[str(n)] for n in names)
        assert sympy.simplify((moved - value).subs(w)) == 0
        assert sympy.simplify((moved + value).subs(w)) != 0


def test_a_turntable_does_work():
    """The energy changes by what the moving constraints do; at rest they do none."""
    statements = verdicts_of(TURNTABLE)
    assert statements["the energy changes by the work of the moving constraints"] is Verdict.PROVED
    still = spec(TURNTABLE, (" - w*y", ""), ("w*x - ", "-"))
    assert "the energy is conserved" in {claim.statement for claim in prove_claims(still).claims}
