"""Machines and balls with constraints against motions in closed form, and wrong twins."""

import importlib
from fractions import Fraction

import numpy as np
import pytest

from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.constrained import derived as constrained
from tests.sources.test_equations import solved, values
from tests.specs import derived, prove_claims, shipped, spec, verdicts_of


def system(name):
    """A shipped system."""
    return importlib.import_module(f"coadjoint.systems.{name}").system


def test_suslovs_body_comes_to_rest_against_k():
    """``theta' = |k| |w| sin(theta)/c`` for K + j = c: tan(theta/2) grows by e^{|k| |w| t/c}."""
    k, c, theta = 0.5, 3.0, 0.3
    w0, speed = [np.cos(theta), np.sin(theta), 0, 0], 1.0
    given = {"K": [c - 1] * 4, "j": 1.0, "k": [k, 0, 0, 0]}
    motion = system("suslov_so5").simulate(w0, (0, 20), given, samples=41)
    turned = 2 * np.arctan(np.tan(theta / 2) * np.exp(k * speed * motion.time / c))
    assert np.allclose(motion["w"][0], np.cos(turned), atol=1e-8)
    assert motion.drift["energy"] < 1e-8


def test_a_roller_racer_whose_carriages_start_in_line_goes_straight():
    """With phi = 0 and no swing it keeps its speed; Newton's laws are those of tests.sources."""
    racer = system("roller_racer")
    motion = racer.simulate([0.7, 0, 0], (0, 3), samples=4)
    assert np.allclose(motion["v"], 0.7)
    assert np.allclose(motion["phi"], 0)


def test_a_roller_racer_on_a_circle():
    """Phi stays where ``omega (d1 cos phi - d2) = v sin phi``: then it is at rest in phi."""
    racer, phi, d1, d2 = system("roller_racer"), 0.4, 1.0, 0.2
    omega = 0.5 * np.sin(phi) / (d1 * np.cos(phi) - d2)
    names = list(racer.OBSERVABLES.components)
    found = racer.observables(np.array([0.5, omega, phi]), {"d1": d1, "d2": d2})
    assert found[names.index("vphi")] == pytest.approx(0, abs=1e-15)


def test_appells_machine_without_offset_falls_evenly():
    """Rho = 0: the wheel turns at a constant rate, and the weight falls as on a pulley."""
    machine = system("appell_machine")
    given = {"rho": 0.0, "M": 2.0, "m": 0.5, "a": 0.1, "b": 0.3, "C": 0.05, "g": 9.0}
    fall = 0.5 * 9.0 * 0.1 / (2.5 * 0.09 + 0.5 * 0.01 + 0.05)
    motion = machine.simulate([0.7, 0, 0, 0], (0, 2), given, samples=21)
    assert np.allclose(motion["omega"], 0.7)
    assert np.allclose(motion["phi"], fall * motion.time**2 / 2, atol=1e-9)


def test_appells_machine_turns_by_the_exponential_of_its_way():
    """``theta'' = b phi' theta'/rho`` without A: theta' = theta'(0) exp(b phi/rho)."""
    given = {"A": 1e-12, "rho": 0.5, "b": 0.2}
    motion = system("appell_machine").simulate([0.1, 0, 0, 0.5], (0, 2), given, samples=21)
    assert np.allclose(motion["omega"], 0.1 * np.exp(0.2 * motion["phi"] / 0.5), rtol=1e-7)


def test_a_double_pendulum_hangs_with_the_frequencies_of_the_book():
    """Equal masses and rods: ``(2 +- sqrt 2) g/l``, each twice (Marsden and Scheurle 1993)."""
    pendulum = system("double_spherical_pendulum")
    state = np.array([0, 0, -1.0, 0, 0, -1.0, *[0] * 6])
    slopes = pendulum.jacobian(state, {"m1": 1.3, "m2": 1.3, "l1": 0.7, "l2": 0.7, "g": 9.0})
    across = [0, 1, 3, 4, 6, 7, 9, 10]
    squares = np.sort(-(np.linalg.eigvals(slopes[np.ix_(across, across)]) ** 2).real)
    expected = np.repeat((2 + np.array([-1, 1]) * np.sqrt(2)) * 9.0 / 0.7, 4)
    assert np.allclose(squares, expected, rtol=1e-9)


def test_the_rods_of_a_double_pendulum_keep_their_length():
    """Over twenty seconds, to the accuracy of the projection and of the steps."""
    start = [0.6, 0, -0.8, 0, 0.28, -0.96, 0, 1, 0, 1, 0, 0]
    motion = system("double_spherical_pendulum").simulate(start, (0, 20), samples=201)
    assert motion.status == "OK"
    assert np.abs(np.sum(motion["gamma1"] ** 2, axis=0) - 1).max() < 1e-7
    assert max(motion.drift.values()) < 1e-6


def test_a_chain_of_links_hangs_with_the_roots_of_laguerre():
    """Squares of the frequencies are ``(g/l)`` times the roots of ``L_4``, from a table."""
    slopes = system("n_link_chain").jacobian(np.zeros(8), {"m": 1.3, "l": 0.7, "g": 9.0})
    squares = np.sort(np.linalg.eigvals(-slopes[4:, :4]).real)
    roots = [0.322547689619392, 1.745761101158347, 4.536620296921128, 9.395070912301133]
    assert np.allclose(squares, np.array(roots) * 9.0 / 0.7, rtol=1e-12)


def test_a_chain_of_links_without_weight_keeps_its_angular_momentum():
    """``sum_ij M_ij theta_j'``; with weight it does not."""
    start = [0.3, 1.0, -0.4, 2.0, 1.0, -0.5, 0.2, 0.7]
    free, heavy = (
        system("n_link_chain").simulate(start, (0, 5), {"g": g}, samples=51)["L"] for g in (0, 9.81)
    )
    assert np.ptp(free) < 1e-9 * np.abs(free).max()
    assert np.ptp(heavy) > 1


def test_a_ball_on_a_turntable_goes_round_a_circle():
    """At 2/7 of the rate of the table if it is solid; the moving energy is kept, the energy not."""
    m, r, W = 1.5, 0.2, 3.0
    given = {"m": m, "r": r, "I": 2 * m * r**2 / 5, "W": W}
    motion = system("ball_on_turntable").simulate([1, 2, 3, 0.4, 0.1], (0, 8), given, samples=201)
    nu = 2 / 7 * W
    x0, v0 = motion["x"][:, :1], motion["v"][:, :1]
    c, s = np.cos(nu * motion.time), np.sin(nu * motion.time)
    moved = np.array([v0[0] * s - v0[1] * (1 - c), v0[1] * s + v0[0] * (1 - c)]) / nu
    assert np.allclose(motion["x"], x0 + moved, atol=1e-7)
    assert np.ptp(motion["energy"]) > 0.1
    assert set(motion.drift) == {"moving", "centre"}
    assert max(motion.drift.values()) < 1e-7


def test_the_energy_on_a_turntable_is_not_conserved():
    """The wrong twin."""
    text = (derivations_folder() / "ball_on_turntable.toml").read_text(encoding="utf-8")
    declared = spec(text, ('conserved = ["moving"', 'conserved = ["energy", "moving"'))
    found = verdicts_of(declared)
    assert found["energy is conserved"] is Verdict.REFUTED
    assert found["moving is conserved"] is Verdict.PROVED


def test_a_ball_in_a_sphere_swings_at_the_bottom():
    """Without spin as a pendulum, of the frequency ``5 g/(7 a)`` squared if it is solid."""
    m, r, a, g = 1.2, 0.5, 2.0, 9.0
    given = {"m": m, "r": r, "I": 2 * m * r**2 / 5, "a": a, "g": g}
    slopes = system("ball_in_sphere").jacobian(np.array([0, 0, 0, 0, 0, -1.0]), given)
    squares = np.sort(-(np.linalg.eigvals(slopes) ** 2).real)
    assert np.allclose(squares, [0, 0, *[5 * g / (7 * a)] * 4], atol=1e-7)


def test_a_ball_in_a_sphere_moves_as_lagranges_top():
    """``(I + m r^2) a n x n'' = I sigma r n' - m g r^2 n x e3`` along a motion."""
    ball, given = system("ball_in_sphere"), {"m": 1.2, "r": 0.5, "I": 0.3, "a": 2.0, "g": 9.0}
    h, start = 1e-3, {"omega": [1, -2, 4], "n": [0.48, 0.6, -0.64]}
    motion = ball.simulate(start, (0, 2 * h), given, samples=3, rtol=1e-13, atol=1e-14)
    before, n, after = motion["n"].T
    moved, second = (after - before) / (2 * h), (after - 2 * n + before) / h**2
    left = (0.3 + 1.2 * 0.25) * 2.0 * np.cross(n, second)
    sigma = motion["spin"][1]
    right = 0.3 * sigma * 0.5 * moved - 1.2 * 9.0 * 0.25 * np.cross(n, [0, 0, 1])
    assert np.allclose(left, right, atol=1e-4)


DISK = """
title = "A disk that rocks, by its constraint"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
algebra.name = "R^2"
[variables]
v = { role = "velocity" }
phi = { role = "coordinate" }
phidot = { role = "velocity", of = "phi" }
[parameters]
m = { positive = true, default = 1 }
r = { positive = true, default = 1 }
l = { positive = true, default = "0.5" }
I = { positive = true, default = "0.25" }
g = { positive = true, default = "9.81" }
[lagrangian]
l = "m*dot(v, v)/2 + I*phidot^2/2 + m*g*l*cos(phi)"
[constraints]
rolling = "v == vector((r - l*cos(phi))*phidot, l*sin(phi)*phidot)"
"""


@pytest.mark.parametrize(("way", "same"), [("r - l*cos(phi)", True), ("r", False)])
def test_the_rocking_disk_follows_from_its_constraint(way, same):
    """The body in the plane, its point of contact at rest: the shipped motion."""
    whole = constrained(DISK, ("(r - l*cos(phi))", f"({way})"))["nonholonomic"]
    free = derived("rocking_disk")["euler-lagrange"]
    assert (acceleration(whole) == pytest.approx(acceleration(free))) == same


@pytest.mark.parametrize(
    "change",
    [
        ("l*sin(q)*w^2)", "2*l*sin(q)*w^2)"),
        ("-(l*sin(angle)*pressure", "(l*sin(angle)*pressure"),
        ('phidot = "w"', 'phidot = "-w"'),
    ],
)
def test_wrong_forces_of_the_line_are_refuted(change):
    """The chart of the body in the plane, with another friction, moment or angle."""
    text = shipped("rocking_disk").path.read_text(encoding="utf-8")
    assert change[0] in text
    claims = prove_claims(spec(text, change)).claims
    assert any(c.verdict is Verdict.REFUTED and "the chart bound" in c.statement for c in claims)


def acceleration(equations):
    """The second derivative of the angle at a point."""
    numbers = {"m": 3, "r": 4, "l": 1, "I": 2, "g": 9, "phi": 1, "phidot": 5}
    point = {name: Fraction(value, 2) for name, value in numbers.items()}
    rate = equations.rates[equations.setting.state.index("phidot")]
    return float(values([rate], solved(equations, point))[0])
