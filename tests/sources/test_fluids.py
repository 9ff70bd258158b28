"""The truncated fluid on the sphere: waves in closed form, and what its steps keep."""

from fractions import Fraction

import numpy as np
import pytest
import sympy

from coadjoint.algebra import algebra_by_name
from coadjoint.derive import derive
from coadjoint.lower import lowering
from coadjoint.lower.check import check_sizes
from coadjoint.prove import Verdict
from coadjoint.spec import read_spec_text
from tests.sources.fluids import (
    HARMONICS,
    add,
    basis,
    commute,
    fluid_rates,
    half_trace,
    multiply,
    vorticity,
)
from tests.sources.test_fields import system
from tests.specs import emitted, prove_claims, shipped, spec, verdicts_of

PAIRS = [name for name in HARMONICS if name[0] == "S"]


def rates_at(state):
    """The rates of the shipped system at rational numbers, with hbar = 1."""
    values = dict(zip(emitted("zeitlin_su_4").variables, state, strict=True)) | {"hbar": 1}
    exact = {name: sympy.Rational(value) for name, value in values.items()}
    equations = emitted("zeitlin_su_4")
    rates, field = map(equations.close, equations.exact.rates), equations.setting.field
    number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
    return [field.evaluate(rate, exact, number) for rate in rates]


@pytest.mark.parametrize("name", PAIRS)
def test_waves_of_rossby_and_haurwitz_turn_about_the_axis(name):
    """W = i (2 a S_z + Y): Y of degree l and order m turns at ``m a (1 - 2/(l (l + 1)))``.

    It is exact for every N (Hoppe and Yau 1998), with a in the place of w hbar; degree 1 stays.
    """
    names, a = list(HARMONICS), Fraction(3, 2)
    degree, order = int(name[1]), int(name[3:])
    cosine, sine = names.index("C" + name[1:]), names.index(name)
    state = [Fraction(0)] * 15
    state[0] = 20 * a  # C1_0 is 2 S_z, and w_1/g_1 with g_1 = 20 its coefficient
    state[cosine], state[sine] = Fraction(2), Fraction(5)
    speed = order * a * (1 - Fraction(2, degree * (degree + 1)))
    expected = [Fraction(0)] * 15
    expected[cosine], expected[sine] = -speed * 5, speed * 2
    assert rates_at(state) == expected
    assert any(expected) is (degree > 1)
    assert fluid_rates(state, [1]) == expected


def test_all_three_casimirs_are_found_and_no_more():
    """N - 1 of them; the last one, of degree 4, is found by the engine."""
    claims = verdicts_of(shipped("zeitlin_su_4"))
    proved = [s for s in claims if s.endswith("is a Casimir")]
    assert len(proved) == 3
    assert "every Casimir is a function of the 3 known, near almost every point" in claims
    assert set(claims.values()) == {Verdict.PROVED}


def test_a_wrong_sign_in_the_cubic_casimir_is_refuted():
    """Tr B^3 + 3 tr A^2 B is none."""
    text = shipped("zeitlin_su_4").path.read_text(encoding="utf-8")
    old = "trace(B^3) - 3*trace(A*A*B)"
    assert text.count(old) == 1
    certificate = prove_claims(spec(text, (old, old.replace("-", "+"))))
    wrong = [each.statement for each in certificate.claims if each.verdict is Verdict.REFUTED]
    assert wrong == ["trace(B^3) + 3*trace(A*A*B) is a Casimir"]


def spectrum(w):
    """The eigenvalues of W, in order: they are imaginary, and each one twice."""
    whole = np.zeros((8, 8))
    for place, value in vorticity(list(w)).items():
        whole[place] = value
    return np.sort(np.linalg.eigvals(whole).imag)


@pytest.mark.parametrize(("method", "keeps"), [("isospectral_midpoint", True), ("rk4", False)])
def test_the_isospectral_midpoint_keeps_the_spectrum(method, keeps):
    """And so all N - 1 Casimirs, to rounding; Runge and Kutta's steps do not."""
    start = np.array([4, 0, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 2, 0, 0, 0.7])
    motion = system("zeitlin_su_4").simulate(
        start, (0.0, 12.0), samples=3, step=0.3, method=method, target="numpy"
    )
    assert motion.status == "OK"
    change = np.abs(spectrum(motion.state[:, -1]) - spectrum(start)).max()
    assert bool(change < 1e-13) is keeps
    assert np.abs(motion.state[:, -1] - start).max() > 0.3


def test_the_square_of_a_vorticity_has_no_imaginary_trace():
    """So that Casimirs are tr W^2, i tr W^3 and tr W^4: matrices stand for antihermitian ones."""
    (E, F), i = basis()[3:5], range(4)
    square = multiply(E, F)
    assert sum(square.get((k, k + 4), 0) for k in i) == 0


# -- other numbers of rows ----------------------------------------------------------------


def generators(n):
    """The degree and the matrix of each generator, with entries that are fractions."""
    algebra = algebra_by_name(f"harmonics({n})")
    for name, matrix in zip(algebra.basis, algebra.matrices, strict=True):
        yield int(name[1]), {place: Fraction(x) for place, x in matrix.items()}


def fluid_of(n):
    """The truncated fluid of n rows with hbar = 1, as a spec without claims."""
    terms = []
    for place, (degree, E) in enumerate(generators(n), 1):
        terms.append(f"w{place}^2/{-2 * half_trace(E, E) * degree * (degree + 1)}")
    return f"""
title = "Truncated fluid"
routes = ["lie-poisson"]
[algebra]
name = "harmonics({n})"
invariance = "left"
[variables]
w = {{ role = "momentum" }}
[hamiltonian]
h = "{" + ".join(terms)}"
"""


@pytest.mark.parametrize("n", [3, 5, 7])
def test_rates_by_structure_constants_are_the_commutator_of_matrices(n):
    """``dW/dt = [P, W]`` at random integers, P found by the Laplacian's inverse in each degree.

    With the stream function of another degree they are not.
    """
    degrees, matrices = zip(*generators(n), strict=True)
    equations = derive(read_spec_text(fluid_of(n), "fluid.toml"))
    numbers = np.random.default_rng(n).integers(-9, 9, n * n - 1).tolist()
    norms = [-half_trace(E, E) for E in matrices]
    parts = [Fraction(w) / g for w, g in zip(numbers, norms, strict=True)]
    W = add(zip(parts, matrices, strict=True))
    values = dict(zip(equations.variables, map(sympy.Integer, numbers), strict=True))
    number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
    field = equations.setting.field
    found = [field.evaluate(equations.close(r), values, number) for r in equations.exact.rates]
    for shift, is_right in ((0, True), (1, False)):
        eigenvalues = [-(d + shift) * (d + shift + 1) for d in degrees]
        stream = (x / e for x, e in zip(parts, eigenvalues, strict=True))
        turned = commute(add(zip(stream, matrices, strict=True)), W)
        expected = [-half_trace(turned, E) for E in matrices]
        assert (found == [number(Fraction(x)) for x in expected]) is is_right


@pytest.mark.parametrize(
    ("n", "most", "has_product"),
    [(4, None, True), (4, 300, False), pytest.param(5, None, False, marks=pytest.mark.campaign)],
)
def test_a_product_that_is_too_long_is_left_out(n, most, has_product, monkeypatch):
    """The system is there without the isospectral midpoint, and within all limits."""
    if most is not None:
        monkeypatch.setattr(lowering, "C_STATEMENTS", most)
    equations = derive(read_spec_text(fluid_of(n), "fluid.toml"))
    programs = lowering.lower(equations)
    check_sizes(equations, programs)
    assert ("sandwich" in programs) is has_product
    assert "bracket_vector" in programs
