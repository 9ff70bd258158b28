"""Driven bodies: equations of Newton and Euler written apart, and motions in closed form."""

from __future__ import annotations

import importlib
from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.conftest import rational_points
from tests.sources.bodies import heavy_top_rates
from tests.sources.components import cross, dot, minus, over, plus, times
from tests.sources.driven import (
    quadrotor_rates,
    satellite_observables,
    satellite_rates,
    shaken,
    wheels_rates,
)
from tests.sources.textbook import GIVEN, STATES
from tests.specs import spec, unitless, verdicts_of


def system(name):
    """A shipped system."""
    return importlib.import_module(f"coadjoint.systems.{name}")


def random_point(name):
    """State and what else is given, as fractions."""
    (point,) = rational_points((*STATES[name], *GIVEN[name]), 1, seed=3)
    return [point[n] for n in STATES[name]], [point[n] for n in GIVEN[name]]


def times_each(a, b):
    """Products of components."""
    return [x * y for x, y in zip(a, b, strict=True)]


# -- a quadrotor ----

#: A rotation with rational entries: its rows are axes of space in the body.
ROTATION = [
    [Fraction(9, 25), Fraction(12, 25), Fraction(-20, 25)],
    [Fraction(-20, 25), Fraction(15, 25), Fraction(0)],
    [Fraction(12, 25), Fraction(16, 25), Fraction(15, 25)],
]


def in_world(state, given):
    """``(m dv/dt, dx3/dt, J dOmega/dt)`` by Lee, Leok and McClamroch, v and x in axes of space."""
    inertia, (m, g, f), M = given[:3], given[3:6], given[6:]
    omega = over(state[:3], inertia)
    thrust = [f * row[2] for row in ROTATION]  # f R e3
    force = minus([0, 0, m * g], thrust)
    velocity = [dot(row, state[3:6]) / m for row in ROTATION]
    return force, velocity[2], minus(M, cross(omega, state[:3]))


def body_in_world(rates, state, given):
    """The same of rates in body axes: ``d(R P)/dt = R (dP/dt + Omega x P)``."""
    omega = over(state[:3], given[:3])
    moved = plus(rates[3:6], cross(omega, state[3:6]))
    return [dot(row, moved) for row in ROTATION], rates[9], rates[:3]


def test_a_quadrotor_moves_as_in_axes_of_space():
    """The published form is in axes of space, ours in body axes; without P x Omega it differs."""
    state, given = random_point("quadrotor")
    state[6:9] = ROTATION[2]
    rates = quadrotor_rates(state, given)
    assert body_in_world(rates, state, given) == in_world(state, given)
    spoiled = [
        *rates[:3],
        *minus(rates[3:6], cross(state[3:6], over(state[:3], given[:3]))),
        *rates[6:],
    ]
    assert body_in_world(spoiled, state, given) != in_world(state, given)


HOVERING = np.array([0, 0, 0, 0, 0, 0, 0, 0, 1, -5.0])


def test_a_quadrotor_hovers_by_a_thrust_of_its_weight():
    """By default the thrust is the weight; a tenth more lifts it with a tenth of g."""
    quadrotor = system("quadrotor")
    assert np.abs(quadrotor.rhs(HOVERING)).max() < 1e-14
    m, g = 2.0, 9.0
    rates = quadrotor.rhs(HOVERING, {"m": m, "g": g}, {"f": 1.1 * m * g})
    assert np.allclose(rates, [0, 0, 0, 0, 0, -0.1 * m * g, 0, 0, 0, 0])
    climb = quadrotor.simulate(HOVERING, (0, 2), {"m": m, "g": g}, {"f": 1.1 * m * g}, samples=9)
    assert np.allclose(climb["Gamma"][3], -5 - 0.1 * g * np.linspace(0, 2, 9) ** 2 / 2)


def test_a_hovering_quadrotor_is_controlled_by_thrust_and_torque():
    """Its linearisation by hand: tilting makes it drift, and the inputs reach all but |Gamma|."""
    quadrotor, m, g = system("quadrotor"), 2.0, 9.0
    J = np.array([0.5, 1.0, 2.0])
    arguments = HOVERING, {"m": m, "g": g, "J": J}, {"f": m * g}
    A, B = quadrotor.jacobian(*arguments), quadrotor.input_jacobian(*arguments)
    expected = np.zeros((10, 10))
    expected[3:6, 6:9] = m * g * np.eye(3)
    expected[6, 1], expected[7, 0] = -1 / J[1], 1 / J[0]  # e3 x Omega
    expected[9, 5] = 1 / m
    assert np.allclose(A, expected)
    inputs = np.zeros((10, 4))
    inputs[5, 0] = -1
    inputs[:3, 1:] = np.eye(3)
    assert np.allclose(B, inputs)
    reached = np.hstack([np.linalg.matrix_power(A, k) @ B for k in range(4)])
    assert np.linalg.matrix_rank(reached) == 9


def test_the_depth_has_a_unit_of_its_own():
    """So that the energy has one, too."""
    quadrotor = system("quadrotor")
    assert quadrotor.OBSERVABLES["energy"].unit == "kg m^2/s^2"
    motion = quadrotor.simulate(HOVERING, (0, 1), samples=2)
    assert [motion.unit(name) for name in ("Gamma1", "Gamma4", "P1")] == ["1", "m", "kg m/s"]


# -- a spacecraft with wheels ----


def torques_on_carrier(state, given, rates):
    """``I dOmega/dt - (I Omega + J (Omega + w)) x Omega`` and ``J d(Omega + w)/dt``."""
    inertia = given[:3]
    omega = over(minus(state[4:7], state[7:]), inertia)
    turning = over(minus(rates[4:7], rates[7:]), inertia)
    held = minus(times_each(inertia, turning), cross(state[4:7], omega))
    return held, rates[7:]


def test_motors_act_on_wheels_and_back_on_the_body():
    """Euler's law of the carrier: wheels turn with it, and their motors push it with -u."""
    state, given = random_point("spacecraft_wheels")
    u, rates = given[6:], wheels_rates(state, given)
    assert torques_on_carrier(state, given, rates) == (times(-1, u), u)
    spoiled = [*rates[:4], *plus(rates[4:7], u), *rates[7:]]  # as if u came from outside
    assert torques_on_carrier(state, given, spoiled) != (times(-1, u), u)


def test_motors_keep_the_angular_momentum_in_space():
    """Any torque: the whole momentum stays, and the energy changes by the work of u on w."""
    spacecraft = system("spacecraft_wheels")
    start = {"q": [0.5, 0.5, 0.5, 0.5], "Pi": [1, 0.5, -0.3], "L": [0.1, 0, 0.2]}
    motion = spacecraft.simulate(
        start, (0, 5), None, lambda t: [np.sin(t), 0.5 * np.cos(3 * t), 0.2], samples=2001
    )
    assert set(motion.drift) == {"casimir1", "Pi_spatial"}
    assert max(motion.drift.values()) < 1e-8
    work = np.trapezoid(np.sum(motion["u"] * motion["w"], axis=0), motion.time)
    gained = motion["energy"][-1] - motion["energy"][0]
    assert abs(gained) > 0.1
    assert gained == pytest.approx(work, abs=1e-4)


@pytest.mark.parametrize(
    ("acting", "kept"),
    [
        ('[forces]\nw = "u"\n[dissipation]\nR = "dot(w, w)"', True),
        ('[forces]\nOmega = "u"', False),
        ('[forces]\nw = "u"\n[dissipation]\nR = "Omega1^2"', False),
    ],
)
def test_what_acts_inside_keeps_the_momentum_in_space(acting, kept):
    """Friction in the bearings does; a torque from outside does not, and nothing says it did."""
    text = unitless((derivations_folder() / "spacecraft_wheels.toml").read_text(encoding="utf-8"))
    claimed = 'conserved = ["dot(q, q)", "dot(Pi, Pi)"]'
    declared = spec(text, ('[forces]\nw = "u"', acting), (claimed, 'conserved = ["dot(q, q)"]'))
    found = verdicts_of(declared)
    assert ("Pi_spatial is conserved" in found) == kept
    assert set(found.values()) == {Verdict.PROVED}


def test_a_spacecraft_turns_itself_and_comes_to_rest():
    """A wheel spun up and down turns the body back by ``u T^2/I``."""
    spacecraft, torque, T, inertia = system("spacecraft_wheels"), 0.4, 2.0, 3.0
    samples = [0, T, 2 * T], [[0, 0, 0], [0, 0, 0], [torque, -torque, 0]], "previous"
    motion = spacecraft.simulate([1, *[0] * 9], (0, 2 * T), None, samples, samples=5)
    angle = -torque * T**2 / inertia
    assert np.allclose(motion["q"][:, -1], [np.cos(angle / 2), 0, 0, np.sin(angle / 2)])
    assert np.allclose(motion["Omega"][:, -1], 0)
    assert motion["Omega"][2].min() == pytest.approx(-torque * T / inertia)


# -- a satellite in the gradient of gravity ----


def frequencies(inertia, n):
    """Squares of the frequencies of pitch, and of roll with yaw (Hughes 1986): yaw along gamma."""
    yaw, roll, pitch = inertia
    k1, k3 = (pitch - yaw) / roll, (pitch - roll) / yaw
    b, c = 1 + 3 * k1 + k1 * k3, 4 * k1 * k3
    return np.array([3 * n**2 * (roll - yaw) / pitch, *(n**2 * np.roots([1, -b, c]).real)])


@pytest.mark.parametrize("n", [1.0, 2.5])
def test_a_satellite_librates_with_the_frequencies_of_hughes(n):
    """About the equilibrium with beta and gamma on principal axes, in Lagrange's region."""
    satellite, inertia = system("gravity_gradient_satellite"), np.array([1.0, 2.0, 2.5])
    state = [0, 0, n * inertia[2], 0, 0, 1, 1, 0, 0]
    assert np.abs(satellite.rhs(state, {"I": inertia, "n": n})).max() == 0
    found = np.linalg.eigvals(satellite.jacobian(state, {"I": inertia, "n": n}))
    squares = np.sort(-(found**2).real)
    expected = [0, 0, 0, *np.repeat(np.sort(frequencies(inertia, n)), 2)]
    assert np.allclose(squares, expected, atol=1e-6)
    assert np.abs((found**2).imag).max() < 1e-6


def test_a_satellite_with_its_short_axis_along_the_radius_is_unstable():
    """With the moments of yaw and roll exchanged pitch grows."""
    satellite = system("gravity_gradient_satellite")
    state = [0, 0, 2.5, 0, 0, 1, 1, 0, 0]
    growing = np.linalg.eigvals(satellite.jacobian(state, {"I": [2, 1, 2.5]})).real.max()
    assert growing == pytest.approx(np.sqrt(3 * (2 - 1) / 2.5))


def test_pitch_of_any_size_keeps_the_integral_of_jacobi():
    """``theta'^2/2 + (3/2) n^2 k sin^2 theta`` with ``k = (I2 - I1)/I3``, and the general form."""
    satellite, n, k = system("gravity_gradient_satellite"), 1.5, 1 / 2.5
    theta, rate = 0.7, 0.4
    state = [0, 0, 2.5 * (n + rate), 0, 0, 1, np.cos(theta), -np.sin(theta), 0]
    motion = satellite.simulate(state, (0, 10), {"n": n}, samples=201)
    assert max(motion.drift[name] for name in ("energy", "jacobi")) < 1e-8
    sine = motion["gamma"][1]
    assert np.ptp(sine) > 1  # far from small
    integral = motion["omega"][2] ** 2 / 2 + 1.5 * n**2 * k * sine**2
    assert np.allclose(integral, integral[0], atol=1e-8)


def test_the_torque_is_that_of_gravity_on_points_of_mass():
    """Newton's attraction ``-n^2 r/|r|^3`` of six points, the planet at the distance 1."""
    size, masses, n = 1e-3, np.array([3.0, 1.0, 2.0]), 1.7
    gamma = np.array([2.0, 3.0, 6.0]) / 7
    torque = np.zeros(3)
    for axis, mass in zip(np.eye(3), masses, strict=True):
        for side in (1, -1):
            X = side * size * axis
            r = gamma + X
            torque += np.cross(X, -mass / 2 * n**2 * r / np.linalg.norm(r) ** 3)
    inertia = size**2 * (masses.sum() - masses)
    rates = satellite_rates([0, 0, 0, 0, 0, 1, *gamma], [*inertia, n])
    assert np.allclose(rates[:3], torque, rtol=1e-4, atol=0)
    assert not np.allclose(times(-1, rates[:3]), torque, rtol=1e-4, atol=0)


def test_the_radius_turns_against_the_orbit():
    """With ``gamma x Omega`` in the place of ``gamma x omega`` the integral of Jacobi drifts."""
    state, given = random_point("gravity_gradient_satellite")

    def slope(rates):
        h = Fraction(1, 10**20)
        up, down = (plus(state, times(s * h, rates)) for s in (1, -1))
        difference = [satellite_observables(x, given)["jacobi"] for x in (up, down)]
        return abs(difference[0] - difference[1]) / (2 * h)

    rates = satellite_rates(state, given)
    assert slope(rates) < Fraction(1, 10**15)
    assert slope([*rates[:6], *cross(state[6:], over(state[:3], given[:3]))]) > 1


# -- a top on a pivot that vibrates ----


def growth(a, w, spin=0.0, *, inertia=(0.7, 0.7, 0.2), m=1.3, length=0.6, g=9.81, steps=200):
    """Largest multiplier of Floquet of the upright top, by Runge and Kutta's method."""
    top = system("kapitza_top")
    state = [0, 0, inertia[2] * spin, 0, 0, 1]
    given = {"I": inertia, "m": m, "g": g, "chi": [0, 0, length], "a": a, "w": w}
    h = 2 * np.pi / w / steps
    halves = top.jacobian(
        np.repeat(np.array(state, float)[:, None], 2 * steps + 1, axis=1),
        given,
        time=np.arange(2 * steps + 1) * h / 2,
    )
    whole = np.eye(6)
    for n in range(0, 2 * steps, 2):
        A, B, C = (halves[:, :, n + i] for i in range(3))
        k1 = A @ whole
        k2 = B @ (whole + h / 2 * k1)
        k3 = B @ (whole + h / 2 * k2)
        k4 = C @ (whole + h * k3)
        whole = whole + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.abs(np.linalg.eigvals(whole)).max()


@pytest.mark.parametrize(("share", "stable"), [(0.95, False), (1.05, True)])
def test_vibration_holds_a_top_upright(share, stable):
    """Without spin above ``a^2 w^2 = 2 g I/(m l)``, in the limit of fast vibration."""
    w = 400.0
    a = np.sqrt(share * 2 * 9.81 * 0.7 / (1.3 * 0.6)) / w
    assert (growth(a, w) < 1 + 1e-4) == stable


@pytest.mark.parametrize(("share", "stable"), [(0.9, False), (1.1, True)])
def test_spin_and_vibration_add_up(share, stable):
    """``(I3 s)^2/(4 I1) + m^2 l^2 a^2 w^2/(2 I1) > m g l`` with half from each."""
    w, weight = 400.0, 1.3 * 9.81 * 0.6
    spin = np.sqrt(share * weight / 2 * 4 * 0.7) / 0.2
    a = np.sqrt(share * weight / 2 * 2 * 0.7) / (1.3 * 0.6 * w)
    assert (growth(a, w, spin) < 1 + 1e-4) == stable
    assert growth(a, w) > 1 + 1e-3
    assert growth(0.0, w, spin) > 1 + 1e-3


@pytest.mark.parametrize(("a", "least"), [(0.1, 0.9), (0.05, -1.0)])
def test_a_shaken_top_stays_up_and_a_calmer_one_falls(a, least):
    """With the parameters of the spec, where the threshold is ``a = sqrt(2 g)/60 = 0.074``."""
    tilted = [0, 0, 0, np.sin(0.1), 0, np.cos(0.1)]
    motion = system("kapitza_top").simulate(tilted, (0, 3), {"a": a})
    assert (motion["Gamma"][2].min() > 0.9) == (least > 0)
    assert set(motion.drift) == {"casimir1", "casimir2"}
    assert max(motion.drift.values()) < 1e-8


@pytest.mark.parametrize(("sign", "same"), [(1, True), (-1, False)])
def test_the_pivot_takes_gravity_with_it(sign, same):
    """Euler and Poincare with the velocity of the pivot, whose momentum is another one.

    Of ``Omega . I Omega/2 + m z' Gamma . (Omega x chi) - m g Gamma . chi`` the momentum is ``p = Pi
    + m z' chi x Gamma``, and its rate is ``p x Omega + dl/dGamma x Gamma``.
    """
    point = random_point("kapitza_top")
    state, (*top, speed, acceleration, _) = point
    inertia, (m, g), chi = top[:3], top[3:5], top[5:8]
    Pi, Gamma = state[:3], state[3:]
    omega = over(Pi, inertia)
    p = plus(Pi, times(m * speed, cross(chi, Gamma)))
    slope = minus(times(m * speed, cross(omega, chi)), times(m * g, chi))
    moved = plus(cross(p, omega), cross(slope, Gamma))
    carried = times(m * speed, cross(chi, cross(Gamma, omega)))
    own = times(sign * m * acceleration, cross(chi, Gamma))
    felt = heavy_top_rates(state, [*inertia, m, g + acceleration, *chi])[:3]
    assert (minus(minus(moved, carried), own) == felt) == same


def test_a_weight_that_changes_is_no_cyclic_momentum():
    """The route of Kaluza and Klein keeps ``p = -m g chi``; the message says what to do."""
    text = (derivations_folder() / "kapitza_top.toml").read_text(encoding="utf-8")
    declared = spec(text, ('"newton-euler",', '"newton-euler", "kaluza-klein",'))
    with pytest.raises(DerivationError, match=r"depends on t.*Remove \"kaluza-klein\""):
        derive(declared, "kaluza-klein")


def test_the_pivot_is_highest_when_time_begins():
    """Its acceleration there points down: the body feels ``g - a w^2``."""
    *_, g, _, _, chi3 = shaken([1, 1, 1, 2, 10, 0, 0, 1, 3.0, 1.5, 0.0])
    assert (g, chi3) == (10 - 3 * 1.5**2, 1)
