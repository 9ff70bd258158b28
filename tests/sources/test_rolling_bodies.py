"""Holm (2011), 12.2.3: disks and other bodies that roll, typed by hand, and changes refuted."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from coadjoint.derive import derive
from coadjoint.resources import derivations_folder
from coadjoint.systems import euler_disk, rattleback, rolling_disk
from tests.sources.components import cross, dot, hat, plus, times
from tests.sources.disks import ROLLING
from tests.sources.test_equations import emitted, values
from tests.sources.test_rolling_balls import followed, motion_at, rate_at
from tests.specs import spec

R = sympy.Rational
OMEGA, GAMMA = sympy.symbols("Omega1:4"), sympy.symbols("Gamma1:4")
I1, I3, M_, RADIUS, G = sympy.symbols("I1 I3 m r g")
SINE = sympy.sqrt(GAMMA[0] ** 2 + GAMMA[1] ** 2)
COSINE = GAMMA[2]
#: Angular velocities of the disk: along the horizontal part of Gamma, about the axis, of tilting.
P = (GAMMA[0] * OMEGA[0] + GAMMA[1] * OMEGA[1]) / SINE
W = OMEGA[2]
TILTING = (GAMMA[1] * OMEGA[0] - GAMMA[0] * OMEGA[1]) / SINE
#: Unit vectors and parameters for which the roots are rational.
AT = {
    "rolling_disk": {"Gamma1": R(3, 13), "Gamma2": R(4, 13), "Gamma3": R(12, 13)},
    "rolling_ellipsoid": {
        **{"Gamma1": R(2, 7), "Gamma2": R(3, 7), "Gamma3": R(6, 7)},
        **{"axes1": R(1, 2), "axes2": R(2, 3), "axes3": R(1, 3)},
    },
    "body_of_revolution": {
        **{"Gamma1": R(2, 7), "Gamma2": R(3, 7), "Gamma3": R(6, 7), "A": R(6), "C": R(2, 3)}
    },
}
AT["euler_disk"] = AT["rolling_disk"]
AT["rattleback"] = AT["rolling_ellipsoid"]


def arm(name):
    """From the point of contact to the centre of mass, in symbols."""
    A, C, offset, *axes = sympy.symbols("A C l axes1:4")
    if name in ("rolling_ellipsoid", "rattleback"):
        bent = [a**2 * x for a, x in zip(axes, GAMMA, strict=True)]
        return times(1 / sympy.sqrt(dot(bent, GAMMA)), bent)
    if name == "body_of_revolution":
        h = sympy.sqrt(A**2 * (1 - COSINE**2) + C**2 * COSINE**2)
        along = (C**2 - A**2) * COSINE / h + offset
        return plus(times(A**2 / h, GAMMA), [0, 0, along])
    return times(RADIUS / SINE, [GAMMA[0], GAMMA[1], 0])


def check_balance(name, sign=1, share=1):
    """``M' + Omega x M = m s' x (Omega x s) + m g Gamma x s`` at an exact point."""
    equations = emitted(name)
    point, rates = motion_at(equations, AT[name])
    s, inertia = arm(name), inertia_of(name)
    Y = cross(OMEGA, s)
    M = plus([dot(row, OMEGA) for row in inertia], times(M_, cross(s, Y)))
    found = rate_at(point, rates, M)
    s_rate = rate_at(point, rates, s)
    spun, Y_now, weight = (
        values(each, point) for each in (cross(M, OMEGA), Y, times(M_ * G, cross(GAMMA, s)))
    )
    gained = times(share * point["m"], cross(s_rate, Y_now))
    assert any(found)
    assert found == plus(spun, plus(gained, times(sign, weight)))


def inertia_of(name):
    """The inertia about the centre of mass in symbols."""
    if name == "rolling_ellipsoid":
        a, b, c, d, e, f = sympy.symbols("I11 I12 I13 I22 I23 I33")
        return [[a, b, c], [b, d, e], [c, e, f]]
    if name == "rattleback":
        I2, skew = sympy.symbols("I2 skew")
        return [[I1, skew, 0], [skew, I2, 0], [0, 0, I3]]
    return [[I1, 0, 0], [0, I1, 0], [0, 0, I3]]


@pytest.mark.parametrize("name", ROLLING)
def test_12_2_3_balance_of_angular_momentum(name):
    """M' + Omega x M = m s' x (Omega x s) + m g Gamma x s with M = I Omega + m s x (Omega x s).

    Not with s x Gamma, nor without the motion of the point of contact.
    """
    check_balance(name)
    for wrong in ({"sign": -1}, {"share": 0}):
        with pytest.raises(AssertionError):
            check_balance(name, **wrong)


# -- the disk in theta, p, w -----------------------------------------------------------------------


def scalar_laws(turned=1):
    """The three equations of the disk, each as a pair of a quantity and its rate."""
    cot = COSINE / SINE
    drive = I1 * P**2 * cot - turned * (I3 + M_ * RADIUS**2) * P * W - M_ * G * RADIUS * COSINE
    return [
        ((I1 + M_ * RADIUS**2) * TILTING, drive),
        (I1 * P, (turned * I3 * W - I1 * P * cot) * TILTING),
        ((I3 + M_ * RADIUS**2) * W, turned * M_ * RADIUS**2 * P * TILTING),
    ]


def test_12_2_3_scalar_form():
    """(I1 + m r^2) theta'' = I1 p^2 cot theta - (I3 + m r^2) p w - m g r cos theta, and p', w'.

    With theta from the vertical to the axis, p along the line from the contact to the centre; not
    with the axis turned round in p and w alone.
    """
    point, rates = motion_at(emitted("rolling_disk"), AT["rolling_disk"])
    assert rate_at(point, rates, [COSINE]) == values([-SINE * TILTING], point)
    for turned in (1, -1):
        for quantity, rate in scalar_laws(turned):
            right = rate_at(point, rates, [quantity]) == values([rate], point)
            assert right == (turned == 1)


def steady_spin(p, cosine, sine, at):
    """The spin w of steady precession, from theta'' = 0."""
    inertia, mass = at["I1"], at["m"] * at["r"] ** 2
    fall = at["m"] * at["g"] * at["r"] * cosine
    return (inertia * p**2 * cosine / sine - fall) / ((at["I3"] + mass) * p)


def test_12_2_3_steady_precession():
    """Where theta' = theta'' = 0 the disk keeps theta, p and w; with another w it does not."""
    equations = emitted("rolling_disk")
    point, _ = motion_at(equations, AT["rolling_disk"])
    p, (c, d) = R(5, 3), (R(3, 5), R(4, 5))
    w = steady_spin(p, R(12, 13), R(5, 13), point)
    state = {"Omega1": p * c, "Omega2": p * d, "Omega3": w}
    inputs = {str(x): point[str(x)] for x in (*equations.state, *equations.parameters)}
    for spin in (w, w + 1):
        at, rates = followed(equations, inputs | state | {"Omega3": spin})
        moved = rate_at(at, rates, [COSINE, P, W, TILTING])
        assert any(rates.values())
        assert (moved == [0, 0, 0, 0]) == (spin == w)


DISK = {"I1": 0.0025, "I3": 0.005, "m": 1.0, "r": 0.1, "g": 9.81}


def spin_by_legendre(theta, start, slope, factor):
    """w(theta) from ``w'' + cot(theta) w' = factor w``."""
    found = solve_ivp(
        lambda t, y: [y[1], factor * y[0] - y[1] / np.tan(t)],
        (theta[0], theta[-1]),
        [start, slope],
        method="DOP853",
        t_eval=theta,
        rtol=1e-12,
        atol=1e-12,
    )
    return found.y[0]


def test_12_2_3_the_spin_obeys_an_equation_of_legendre():
    """Along a motion w'' + cot(theta) w' = m r^2 I3/(I1 (I3 + m r^2)) w; not with factor 1.

    Eliminate p from I1 (dp/dtheta + p cot theta) = I3 w and (I3 + m r^2) dw/dtheta = m r^2 p.
    """
    inertia, axial, mass = DISK["I1"], DISK["I3"], DISK["m"] * DISK["r"] ** 2
    start = {"Omega": [3.0, 0.0, -6.0], "Gamma": [0.8, 0.0, 0.6]}
    run = rolling_disk.simulate(start, (0, 0.2), DISK, rtol=1e-11, atol=1e-12)
    theta = np.arccos(run["Gamma"][2])
    steps = np.diff(theta)
    turn = int(np.argmax(steps * steps[1] < 0)) or len(theta)  # while theta moves one way
    theta, w = theta[1:turn], run["Omega"][2][1:turn]
    assert abs(theta[-1] - theta[0]) > 0.05
    slope = mass * run["p"][1] / (axial + mass)
    factor = mass * axial / (inertia * (axial + mass))
    right, wrong = (spin_by_legendre(theta, w[0], slope, f) for f in (factor, 1.0))
    assert np.abs(right - w).max() < 1e-8  # integrator's tolerance, much amplified
    assert np.abs(wrong - w).max() > 1e-3


def upright(p, w):
    """The disk upright, turned by p about its vertical diameter and by w about its axis."""
    return {"Omega": [p, 0.0, w], "Gamma": [1.0, 0.0, 0.0]}


def growth(state):
    """The largest growth rate by the emitted Jacobian, seen from axes that do not spin.

    A disk that rolls upright rests in axes turned back about its own by w: that adds w e3 x.
    """
    matrix = np.array(rolling_disk.jacobian(state, DISK)).reshape(6, 6)
    spin = state["Omega"][2] * np.array(hat([0, 0, 1]))
    matrix += np.kron(np.eye(2), spin)
    return np.linalg.eigvals(matrix).real.max()


def leaning(state):
    """How far from upright the disk comes within four seconds when it leans a little."""
    start = {"Omega": state["Omega"], "Gamma": [(1 - 1e-8) ** 0.5, 0.0, 1e-4]}
    run = rolling_disk.simulate(start, (0, 4), DISK, rtol=1e-10, atol=1e-12)
    return np.abs(run["Gamma"][2]).max()


def thresholds():
    """The speeds at which upright motion becomes stable, by hand.

    With theta = pi/2 + x: p = I3 w x/I1 where p = 0 at first, and (I1 + m r^2) x'' =
    (m g r - (I3 + m r^2) I3 w^2/I1) x; or w = m r^2 p x/(I3 + m r^2) where w = 0 at first, and
    (I1 + m r^2) x'' = (m g r - (I1 + m r^2) p^2) x.
    """
    inertia, axial, mass = DISK["I1"], DISK["I3"], DISK["m"] * DISK["r"] ** 2
    fall = DISK["m"] * DISK["g"] * DISK["r"]
    rolling = (inertia * fall / (axial * (axial + mass))) ** 0.5
    spinning = (fall / (inertia + mass)) ** 0.5
    return rolling, spinning


def test_12_2_3_thresholds_of_a_thin_disk_are_the_published_ones():
    """v^2 > g r/3 of rolling and p^2 > 4 g/(5 r) of spinning (O'Reilly 1996; Routh 1905)."""
    rolling, spinning = thresholds()
    assert (rolling * DISK["r"]) ** 2 == pytest.approx(DISK["g"] * DISK["r"] / 3, rel=1e-14)
    assert spinning**2 == pytest.approx(4 * DISK["g"] / (5 * DISK["r"]), rel=1e-14)


@pytest.mark.parametrize("kind", ["rolling", "spinning"])
def test_12_2_3_upright_motion_is_stable_above_its_threshold(kind):
    """5 % above it the disk stays upright, 5 % below it falls: Jacobian and motion agree."""
    rolling, spinning = thresholds()
    for factor in (1.05, 0.95):
        speeds = (0.0, factor * rolling) if kind == "rolling" else (factor * spinning, 0.0)
        state = upright(*speeds)
        # three eigenvalues are zero, found to the cube root of the rounding error at worst
        assert (growth(state) < 1e-3) == (factor > 1)
        assert (leaning(state) < 1e-2) == (factor > 1)


# -- cases of the body of revolution ---------------------------------------------------------------


def body_with(u, v):
    """The rolling body with another profile."""
    text = (derivations_folder() / "body_of_revolution.toml").read_text(encoding="utf-8")
    changes = [('"A^2/h(z)"', f'"{u}"'), ('"(C^2 - A^2)*z/h(z) + l"', f'"{v}"')]
    return derive(spec(text, *changes))


def check_case(u, v, other, names):
    """A body of revolution with the profile u, v moves as another system does."""
    body, equations = body_with(u, v), emitted(other)
    at = {"Gamma1": R(3, 13), "Gamma2": R(4, 13), "Gamma3": R(12, 13)}
    point, rates = motion_at(body, at)
    renamed = {ours: point[theirs] for ours, theirs in names.items()}
    inputs = {str(x): point[str(x)] for x in equations.state} | renamed
    _, expected = followed(equations, inputs)
    assert any(rates.values())
    assert rates == expected


COMMON = {name: name for name in ("I1", "I3", "m", "g")} | {"r": "A"}


def test_12_2_3_the_ball_is_a_case():
    """(u, v) = (r, l) is the sphere of Routh; not (r, -l)."""
    check_case("A", "l", "routh_sphere", COMMON | {"l": "l"})
    with pytest.raises(AssertionError):
        check_case("A", "-l", "routh_sphere", COMMON | {"l": "l"})


def test_12_2_3_the_disk_is_a_case():
    """(u, v) = (r/sqrt(1 - z^2), -r z/sqrt(1 - z^2)) is the disk; not with another sign of v."""
    u, v = "A/sqrt(1 - z^2)", "A*z/sqrt(1 - z^2)"
    check_case(u, f"-{v}", "rolling_disk", COMMON)
    with pytest.raises(AssertionError):
        check_case(u, v, "rolling_disk", COMMON)


# -- the rattleback, and motions -------------------------------------------------------------------


@pytest.mark.parametrize("turned", [True, False])
@pytest.mark.parametrize("name", ["rolling_ellipsoid", "rattleback"])
def test_12_2_a_rattleback_and_its_mirror_image_move_alike(name, turned):
    """At Gamma1 -> -Gamma1, Omega2,3 -> -Omega2,3 with I12, I13 -> -I12, -I13; not with I12 kept.

    So it is the sign of I12 that chooses the spin that turns round.
    """
    equations, chiral = emitted(name), "skew" if name == "rattleback" else "I12"
    inputs = [str(x) for x in (*equations.state, *equations.parameters)]
    point, rates = motion_at(equations, AT[name])
    odd = ["Gamma1", "Omega2", "Omega3", "I13", *([chiral] if turned else [])]
    mirrored = {name: -point[name] if name in odd else point[name] for name in inputs}
    _, found = followed(equations, mirrored)
    expected = {x: -rate if str(x) in odd else rate for x, rate in rates.items()}
    assert (found == expected) == turned


@pytest.mark.parametrize("sense", [1, -1])
def test_12_2_a_rattleback_turns_its_spin_round(sense):
    """A spin of -5/s comes back as one of 4.997/s, its opposite stays; the mirror image mirrors.

    The inertia has the moments 0.0025, 0.02 and 0.0225, turned by 0.1 about the third axis.
    """
    (c, s), (A, B) = (np.cos(0.1), np.sin(0.1)), (0.0025, 0.02)
    inertia = {"I": [A * c**2 + B * s**2, A * s**2 + B * c**2, 0.0225]}
    skew = {"skew": sense * (A - B) * c * s}
    ends = {}
    for spin in (-5.0, 5.0):
        start = {"Omega": [0.01, sense * 0.01, sense * spin], "Gamma": [0.0, 0.0, 1.0]}
        run = rattleback.simulate(start, (0, 8), parameters=inertia | skew, rtol=1e-8, atol=1e-9)
        ends[spin] = sense * run["Omega"][2][-1]
        assert run["normal_force"].min() > 4
    # within what the rattling that is left and the tolerance take of 5
    assert ends[-5.0] == pytest.approx(5, abs=0.01)
    assert ends[5.0] == pytest.approx(5, abs=0.01)


def test_12_2_without_skew_no_spin_is_preferred():
    """A body with axes of inertia along those of its surface keeps either spin."""
    for spin in (-5.0, 5.0):
        start = {"Omega": [0.01, 0.01, spin], "Gamma": [0.0, 0.0, 1.0]}
        run = rattleback.simulate(start, (0, 8), parameters={"skew": 0.0}, rtol=1e-8, atol=1e-9)
        assert run["Omega"][2][-1] == pytest.approx(spin, abs=0.01)


def test_12_2_3_euler_s_disk_keeps_its_energy():
    """To the tolerance of the integrator, and the plane presses all the time."""
    start = {"Omega": [8.5, 0.0, 0.0], "Gamma": [0.07584, 0.0, 0.99712]}
    run = euler_disk.simulate(start, (0, 2), rtol=1e-10, atol=1e-12)
    assert run.drift["energy"] < 1e-8
    assert np.ptp(run["Gamma"][2]) > 1e-4
    assert run["normal_force"].min() > 0
    assert euler_disk.simulate(start, (0, 2), rtol=1e-3, atol=1e-3).drift["energy"] > 1e-7


def test_12_2_3_numpy_and_c_have_the_same_bits():
    """Of a thousand states, to the last bit."""
    states = np.random.default_rng(3).normal(size=(6, 1001))
    found = euler_disk.rhs(states, DISK, target="numpy")
    assert np.isfinite(found).all()
    assert (found == euler_disk.rhs(states, DISK, target="c")).all()
    assert (found != euler_disk.rhs(states, DISK | {"r": 0.1000001}, target="c")).any()
