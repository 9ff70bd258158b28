"""Waves, charges and tops against motions in closed form, and wrong twins that are refuted."""

import importlib

import numpy as np
import pytest

from coadjoint.derive.reference import Reference
from coadjoint.errors import AlgebraError
from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.specs import derived, prove_claims, spec, verdicts_of


def system(name):
    """A shipped system."""
    return importlib.import_module(f"coadjoint.systems.{name}").system


def verdicts(name, *changes):
    """The verdicts of a shipped spec with some changes, by statement."""
    text = (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")
    return verdicts_of(text, *changes)


# -- three waves ----


def test_two_waves_of_one_size_are_pumped_by_the_third():
    """``a1 = a2 = A sech(A t)``, ``a3 = -i A tanh(A t)`` (Alber and others 1998)."""
    A, t0 = 1.3, -2.0
    start = {"q": [A / np.cosh(A * t0)] * 2 + [0], "p": [0, 0, -A * np.tanh(A * t0)]}
    motion = system("three_wave").simulate(start, (t0, 3.0), samples=26, rtol=1e-11, atol=1e-12)
    assert np.allclose(motion["q"][:2], A / np.cosh(A * motion.time), atol=1e-9)
    assert np.allclose(motion["p"][2], -A * np.tanh(A * motion.time), atol=1e-9)


def test_waves_of_which_one_has_the_other_sign_have_another_pair():
    """``da3/dt = +i a1 a2`` is the explosive case: a sign in L or in h refutes the pair."""
    found = verdicts("three_wave", ("(q1*q2 - p1*p2)*q3 +", "(q1*q2 - p1*p2)*q3 -"))
    assert Verdict.REFUTED in found.values()


# -- Steklov and Hess ----


@pytest.mark.parametrize("change", ["kappa^2*a1*(a2 - a3)^2", "2*kappa^2*a1*(a2 - a3)^2"])
def test_steklovs_integral_holds_for_his_masses_alone(change):
    """With another mass along one axis F is no integral; the energy and the Casimirs are kept."""
    change = (('c1 = "kappa^2*a1*(a2 - a3)^2', f'c1 = "{change}'),)
    found = verdicts("steklov", *change)
    right = change[0][0] == change[0][1]
    assert (found["F is conserved"] is Verdict.PROVED) == right
    assert found["the energy is conserved"] is Verdict.PROVED


def test_the_momentum_of_hess_is_no_integral_where_it_is_not_zero():
    """``dPi3/dt`` is a multiple of Pi3, of the size (d/D) Pi2 with the determinant D."""
    text = 'conserved = ["energy", { claim = "Pi3", where = ["Pi3"] }]'
    found = verdicts("hess_appelrot", (text, 'conserved = ["energy", "Pi3"]'))
    assert found["Pi3 is conserved"] is Verdict.REFUTED
    state, D = np.array([0.7, -1.2, 0.4, 0.2, 0.3, 0.9]), 3 * 2 - 1
    rates = system("hess_appelrot").rhs(state)
    assert rates[2] == pytest.approx(1 / D * state[1] * state[2])


@pytest.mark.parametrize(("middle", "kept"), [("I1 - d^2/I3", True), ("I1", False)])
def test_the_relation_of_hess_rests_on_the_second_moment(middle, kept):
    """Another moment about the second axis breaks it."""
    found = verdicts("hess_appelrot", ("(I1 - d^2/I3)*Omega2^2", f"({middle})*Omega2^2"))
    (statement,) = [each for each in found if each.startswith("Pi3 is conserved")]
    assert (found[statement] is Verdict.PROVED) == kept


# -- a top in two fields ----


def test_a_top_in_two_fields_swings_about_its_third_axis():
    """R = exp(s hat(e3)): ``I s'' = -(a + b) sin s``, as both fields pull on the angle."""
    c, s, p, (a, b) = 0.8, 0.6, 0.3, (1.0, 0.6)
    equations = derived("two_field_top")["euler-poincare"]
    point = dict(zip(equations.setting.state, [c, -s, 0, s, c, 0, 0, 0, 1, 0, 0, p], strict=True))
    slopes = [-s * p, -c * p, 0, c * p, -s * p, 0, 0, 0, 0, 0, 0, -(a + b) * s]
    found = Reference(equations).evaluate("rhs", point | {"I": 1.0, "a": a, "b": b}, float, None)
    assert np.allclose(found, slopes, atol=1e-15)


def test_the_integral_of_kovalevskaya_rests_on_the_ratio_of_the_moments():
    """Its other name is the square of a complex number; with 3 in the place of 2 it changes."""
    found = verdicts(
        "two_field_top",
        ("2*Omega1^2 + 2*Omega2^2", "3*Omega1^2 + 3*Omega2^2"),
        ("(Pi1^2 + Pi2^2)/(4*I)", "(Pi1^2 + Pi2^2)/(6*I)"),
    )
    where = "where R*transpose(R) = 1, det(R) = 1"
    assert found[f"K is conserved {where}"] is found[f"G is conserved {where}"] is Verdict.REFUTED
    assert found["the energy is conserved"] is Verdict.PROVED
    found = verdicts("two_field_top")
    assert set(found.values()) == {Verdict.PROVED}
    assert {"K is conserved", f"G is conserved {where}"} <= found.keys()


# -- Maxwell and Bloch ----


def test_a_pulse_of_light_in_closed_form():
    """``x1 = 2 k sech(k t)``, ``x3 = k^2 - x1^2/2``: the separatrix of the pendulum."""
    k, t0 = 0.9, -3.0

    def pulse(t):
        x1 = 2 * k / np.cosh(k * t)
        return np.array([x1, -k * x1 * np.tanh(k * t), k**2 - x1**2 / 2])

    motion = system("maxwell_bloch").simulate(pulse(t0), (t0, 4.0), rtol=1e-11, atol=1e-12)
    assert np.allclose(motion["x"], pulse(motion.time), atol=1e-8)
    assert motion.drift["casimir1"] < 1e-9


# -- charges ----


def test_a_charge_gyrates_in_the_middle_plane():
    """At z = 0 the field is uniform: a circle of the frequency q B0/m, counter-clockwise if < 0."""
    m, q, B0, v = 2.0, 1.5, 4.0, 0.7
    w = -q * B0 / m
    motion = system("magnetic_bottle").simulate(
        {"x": [0.3, 0, 0], "v": [0, v, 0]}, (0, 5), {"m": m, "q": q, "B0": B0}, samples=101
    )
    t = motion.time
    expected = [0.3 - v / w * (1 - np.cos(w * t)), v / w * np.sin(w * t), 0 * t]
    assert np.allclose(motion["x"], expected, atol=1e-7)
    assert np.ptp(motion["moment"]) < 1e-9


def test_a_guiding_centre_on_the_axis_is_an_oscillator():
    """``d2z/dt2 = -2 mu B0 z/(m L^2)`` for any amplitude, since b is upright there."""
    given = {"m": 2.0, "mu": 0.3, "B0": 4.0, "L": 1.5, "q": 3.0}
    w = np.sqrt(2 * 0.3 * 4.0 / 2.0) / 1.5
    motion = system("guiding_centre").simulate([0, 0, 0, 0.8], (0, 6), given, samples=61)
    assert np.allclose(motion["X"][2], 0.8 / w * np.sin(w * motion.time), atol=1e-7)


def test_a_guiding_centre_follows_the_charge():
    """Both turn at the mirror where the gyration is fast; the moment is nearly constant."""
    m, q, B0, L, u = 1.0, 1.0, 400.0, 2.0, 0.3
    x, across = np.array([0.5, 0, 0]), 0.4
    radius = m * across / (q * B0)
    start = {"x": x + radius * np.array([1, 0, 0]), "v": [0, -across, u]}
    given = {"m": m, "q": q, "B0": B0, "L": L}
    whole = system("magnetic_bottle").simulate(start, (0, 12), given, samples=241)
    mu = m * across**2 / (2 * B0)
    centre = system("guiding_centre").simulate([*x, u], (0, 12), given | {"mu": mu}, samples=241)
    assert 1 < centre["X"][2].argmax() < 240  # it has turned at the mirror
    assert np.abs(whole["x"] - centre["X"]).max() < 0.02
    assert np.ptp(whole["moment"]) < 0.02 * mu


@pytest.mark.parametrize(
    ("name", "old", "new", "right"),
    [
        ("guiding_centre", "m*u/q*kappa", "m*u/q*kappa", True),
        ("guiding_centre", "m*u/q*kappa", "0*u", False),
        ("guiding_centre_twisted", "B0*s + 2*m*u*k", "B0*s + 2*m*u*k", True),
        ("guiding_centre_twisted", "B0*s + 2*m*u*k", "B0*s + 0*m*u*k", False),
    ],
)
def test_a_bracket_without_the_curl_of_b_is_none(name, old, new, right):
    """B in the place of ``B* = B + (m u/q) curl b``, or of its part along b, breaks Jacobi's."""
    text = (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")
    declared = spec(text, (old, new))
    if not right:
        with pytest.raises(AlgebraError, match="Jacobi"):
            prove_claims(declared)
    else:
        assert {each.verdict for each in prove_claims(declared).claims} == {Verdict.PROVED}
