"""Rods at rest: equilibria of the strand, the heavy top, and shapes in closed form."""

from fractions import Fraction

import numpy as np
import pytest
import sympy
from scipy.special import ellipj

from tests.sources.rods import rod_rates
from tests.sources.test_fields import system
from tests.specs import emitted

SYMBOLS = {x: sympy.symbols(f"{x}1:4") for x in "mnKA"}


def rates_of(name, new):
    """The rates of a shipped system with other names or values, multiplied out."""
    replaced = {sympy.Symbol(old): value for old, value in new.items()}
    return [sympy.expand(rate.xreplace(replaced)) for rate in emitted(name).rates]


def forces_on_sections(sign):
    """The rates of the strand `se3_strand` at rest, where it has the strains of the rod.

    Args:
        sign: Of the forces in the strains: 1 for those of the rod.
    """
    m, n, K, A = SYMBOLS.values()
    rod = rates_of("cosserat_rod", {})
    strains = [x / y for x, y in zip((*m, *n), (*K, *A), strict=True)]
    slopes = [x / y for x, y in zip(rod, (*K, *A), strict=True)]
    still = {f"{x}{k}{s}": 0 for x in ("Pi", "P") for k in (1, 2, 3) for s in ("", "_s")}
    bent = {f"X{k}": sign * x + int(k == 6) for k, x in enumerate(strains, 1)}
    bent |= {f"X{k}_s": sign * x for k, x in enumerate(slopes, 1)}
    return rates_of("se3_strand", still | bent)


def test_the_rod_is_the_strand_in_equilibrium():
    """No section is pushed, and no strain changes: identically in m, n, K and A."""
    assert forces_on_sections(1) == [0] * 12


def test_moments_and_forces_of_the_other_sign_hold_no_equilibrium():
    """(m, n) = -dl/d(k, e) of the strand, and not +: with the other sign sections are pushed."""
    assert any(forces_on_sections(-1)[:6])


def test_kirchhoffs_rod_is_the_limit_of_the_elastic_rod():
    """A = a/c for c -> 0; with c = 1 there is shear in addition."""
    A, c = SYMBOLS["A"], sympy.Symbol("c")
    soft = rates_of("cosserat_rod", {f"A{k}": A[k - 1] / c for k in (1, 2, 3)})
    rigid = rates_of("kirchhoff_rod", {})
    assert [rate.subs(c, 0) for rate in soft] == rigid
    assert [rate.subs(c, 1) for rate in soft] != rigid


def test_kirchhoffs_rod_is_the_heavy_top():
    """K for I, m for Pi and n for Gamma, of weight 1 at e3 (Kirchhoff's analogy)."""
    m, n, K, _ = SYMBOLS.values()
    rows = {"Pi": m, "Gamma": n, "I": K, "chi": (0, 0, 1)}
    new = {f"{name}{k}": row[k - 1] for name, row in rows.items() for k in (1, 2, 3)}
    rod, top = rates_of("kirchhoff_rod", {}), {"m": 1, "g": 1}
    assert rates_of("heavy_top", new | top) == rod
    assert rates_of("heavy_top", new | top | {"chi3": -1}) != rod


def test_the_heavy_top_is_the_rod_on_every_route():
    """Each route of both specs, for names and values as above."""
    m, n, K, _ = SYMBOLS.values()
    rows = {"Pi": m, "Gamma": n, "I": K, "chi": (0, 0, 1)}
    new = {f"{name}{k}": row[k - 1] for name, row in rows.items() for k in (1, 2, 3)}
    new = {sympy.Symbol(name): value for name, value in (new | {"m": 1, "g": 1}).items()}
    rod = rates_of("kirchhoff_rod", {})
    for route in ("lie-poisson", "hamilton-pontryagin", "newton-euler"):
        top = emitted("heavy_top", route).rates
        assert [sympy.expand(rate.xreplace(new)) for rate in top] == rod


def test_a_plane_rod_under_compression_is_eulers_elastica():
    """``K1 theta'' = -F sin theta``: ``sin(theta/2) = k sn(w s | k^2)``, ``w^2 = F/K1``.

    n = -F (0, sin theta, cos theta) and m1 = K1 theta'. The rod starts straight, and its length of
    wave for small k is that of Euler's load, ``F = K1 (2 pi/length)^2``.
    """
    F, k, K = 1.7, 0.6, np.array([1.3, 0.9, 0.8])
    w = np.sqrt(F / K[0])
    state = [2 * k * w * K[0], 0, 0, 0, 0, -F]
    rod = system("kirchhoff_rod").simulate(
        state, (0.0, 9.0), parameters={"K": K}, rtol=1e-12, atol=1e-12
    )
    sn, cn, dn, _ = ellipj(w * rod.time, k**2)
    sine, cosine = 2 * k * sn * dn, 1 - 2 * (k * sn) ** 2
    np.testing.assert_allclose(rod["n"], [0 * sine, -F * sine, -F * cosine], atol=1e-10)
    np.testing.assert_allclose(rod["m"][0], 2 * k * w * K[0] * cn, atol=1e-10)
    assert np.abs(sine).max() > 0.9


@pytest.mark.parametrize("change", [0, Fraction(1, 100)])
def test_uniform_helices_are_equilibria(change):
    """N = lambda k with (m - lambda e) x k = 0 is the same all along the rod; near by it is not.

    For K1 = K2, A1 = A2 and k = (a, 0, b) the torsion b follows from the force lambda.
    """
    K, A, a, force = (3, 3, 2), (20, 20, 50), Fraction(2, 7), Fraction(1, 5)
    b = force / (K[2] - K[0] + force**2 * (Fraction(1, A[0]) - Fraction(1, A[2])))
    k = (a, 0, b + change)
    state = [*(x * y for x, y in zip(K, k, strict=True)), *(force * x for x in k)]
    values = dict(zip(("m1", "m2", "m3", "n1", "n2", "n3"), state, strict=True))
    values |= {f"{x}{i}": y for x, row in (("K", K), ("A", A)) for i, y in enumerate(row, 1)}
    exact = {name: sympy.Rational(value) for name, value in values.items()}
    found = rates_of("cosserat_rod", exact)
    assert found == [sympy.Rational(x) for x in rod_rates(state, [*map(Fraction, (*K, *A))])]
    assert any(found) is bool(change)
