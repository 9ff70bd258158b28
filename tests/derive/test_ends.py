"""Strands with two ends: differences that sum by parts, their orders, waves, and the energy."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import expm_multiply

from coadjoint.derive import derive
from coadjoint.derive.fields.ends import CLOSURES, find_place, find_row, find_weight
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.fields.rings import Rings
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict, prove
from coadjoint.prove.grids import about_grid
from coadjoint.spec import read_spec_text
from tests.fields import compile_rates
from tests.specs import shipped

ORDERS = (2, 4)
ENDS = ("free", "clamped")
STRAND = shipped("spin_chain").path.read_text(encoding="utf-8").replace(', "P"]', "]")


def spec_of(ends, order, text=STRAND):
    """The spin chain between two ends."""
    return read_spec_text(text.replace("order = 4", f'order = {order}, ends = "{ends}"'), "c.toml")


def matrix_of(order, N, *, meets=False, exact=False):
    """The matrix of h D."""
    found = np.zeros((N, N), dtype=object)
    for i in range(N):
        for r, c in find_row(order, find_place(order, i, N), meets=meets).items():
            found[i, i + r] = c
    return found if exact else found.astype(float)


def weights_of(order, N):
    """The weights over h."""
    return np.array([find_weight(order, find_place(order, i, N)) for i in range(N)])


@pytest.mark.parametrize("order", ORDERS)
def test_differences_sum_by_parts(order):
    """Q + Q^T is diag(-1, 0, ..., 0, 1), exactly, and the other derivative is -H^-1 Q^T."""
    N = 13
    H, D = np.diag(weights_of(order, N)), matrix_of(order, N, exact=True)
    Q = H.dot(D)
    ends = np.zeros((N, N), dtype=object)
    ends[0, 0], ends[-1, -1] = -1, 1
    assert not (Q + Q.T - ends).any()
    other = matrix_of(order, N, meets=True, exact=True)
    assert (H.dot(other) == -Q.T).all()


@pytest.mark.parametrize("order", ORDERS)
def test_differences_are_exact_for_polynomials(order):
    """Of degree p inside and p/2 near ends, the weights to degree p - 1 (Strand 1994)."""
    N, half = 14, order // 2
    x, D = np.array([Fraction(n) for n in range(N)]), matrix_of(order, N, exact=True)
    near = len(CLOSURES[order].rows)
    for degree in range(1, order + 1):
        defect = D.dot(x**degree) - degree * x ** (degree - 1)
        assert not defect[near:-near].any()
        assert bool(defect[:near].any()) == bool(defect[-near:].any()) == (degree > half)
    for degree in range(order):
        whole = Fraction((N - 1) ** (degree + 1), degree + 1)
        assert weights_of(order, N).dot(x**degree) == whole


def find_orders(order, *, meets):
    """Fitted orders of a derivative inside, near the ends, and of its norm with the weights.

    Of sin(3 pi s) exp(s), which is 0 at both ends of the line from 0 to 1.
    """
    near, spacings, errors = len(CLOSURES[order].rows), [], []
    for N in (321, 641, 1281):
        h, s = 1 / (N - 1), np.linspace(0, 1, N)
        wave, turned = np.sin(3 * np.pi * s) * np.exp(s), np.cos(3 * np.pi * s) * np.exp(s)
        error = np.abs(matrix_of(order, N, meets=meets) @ wave / h - wave - 3 * np.pi * turned)
        inside = error[near:-near].max()
        ends = max(error[:near].max(), error[-near:].max())
        spacings.append(h)
        errors.append((inside, ends, np.sqrt(h * weights_of(order, N).astype(float) @ error**2)))
    return np.polyfit(np.log(spacings), np.log(errors), 1)[0]


@pytest.mark.parametrize("meets", [False, True])
@pytest.mark.parametrize("order", ORDERS)
def test_derivatives_have_the_orders_that_are_claimed(order, meets):
    """2 p inside, p in rows near ends, and p + 1/2 in the norm of the weights, within 0.1.

    A few rows of order p in a sum with weights h add half a power.
    """
    half = order // 2
    found = find_orders(order, meets=meets)
    np.testing.assert_allclose(found, [order, half, half + 0.5], atol=0.1)


@pytest.mark.parametrize("n", range(4))
def test_a_row_of_lower_order_is_seen(n, monkeypatch):
    """A row of order 1 in the place of one of order 2 lowers the order near ends to 1."""
    rows = list(CLOSURES[4].rows)
    rows[n] = {n: Fraction(-1), n + 1: Fraction(1)}
    monkeypatch.setitem(CLOSURES, 4, replace(CLOSURES[4], rows=tuple(rows)))
    inside, ends, norm = find_orders(4, meets=False)
    assert abs(inside - 4) < 0.1
    assert 0.9 < ends < 1.25
    assert 1.4 < norm < 1.75


#: Waves between the ends of a line from 0 to 1 by their half waves, sizes and phases.
WAVES = ((1, 1.0, 0.3), (2, 0.5, 1.1), (3, 0.3, 2.0))


def standing_waves(ends, s, t):
    """Velocities and strains of an angle that obeys phi_tt = phi_ss, one after the other.

    The strain is 0 at free ends, the velocity at clamped ones.
    """
    velocity, strain = np.zeros((2, s.size))
    for n, size, phase in WAVES:
        k = n * np.pi
        turn, share = k * t + phase, size * k
        c, z = np.cos(k * s), np.sin(k * s)
        velocity -= share * np.sin(turn) * (c if ends == "free" else z)
        strain += share * np.cos(turn) * (-z if ends == "free" else c)
    return np.concatenate([velocity, strain])


def find_wave_orders(ends, order):
    """Fitted orders of the largest error at all points and times, and of the root mean square.

    Waves come as far as the line is long; the exponential of the matrix has no error of time.
    """
    spacings, errors = [], []
    for N in (65, 129, 257, 513):
        h, s, times = 1 / (N - 1), np.linspace(0, 1, N), np.linspace(0, 1, 201)
        of_strain, of_velocity = (
            csr_array(matrix_of(order, N, meets=each == ends)) / h for each in ("free", "clamped")
        )
        motion = block_array([[None, of_strain], [of_velocity, None]], format="csc")
        begun = standing_waves(ends, s, 0.0)
        found = expm_multiply(motion, begun, start=0, stop=1, num=201, endpoint=True)
        error = found - [standing_waves(ends, s, t) for t in times]
        squares = error**2 @ np.tile(weights_of(order, N).astype(float), 2)
        spacings.append(h)
        errors.append((np.abs(error).max(), np.sqrt(h * squares.max())))
    return np.polyfit(np.log(spacings), np.log(errors), 1)[0]


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("order", ORDERS)
def test_errors_of_waves_fall_with_the_orders_that_are_claimed(ends, order):
    """The largest error with p + 1 within 0.1, one more than near ends (Gustafsson 1975).

    Its root mean square falls with 2 for p = 1. For p = 2 it is between 3.5, of an error of order
    3 in a layer of a few h, and 4, of what is inside.
    """
    largest, mean = find_wave_orders(ends, order)
    assert abs(largest - (order // 2 + 1)) < 0.1
    assert (abs(mean - 2) < 0.1) if order == 2 else (3.45 < mean < 4)


@pytest.mark.parametrize("ends", ENDS)
def test_a_row_of_lower_order_makes_waves_less_right(ends, monkeypatch):
    """A row of order 1 in the place of 2: the largest error falls with 2 at most, and not 3."""
    first, _, *others = CLOSURES[4].rows
    rows = (first, {0: Fraction(-1), 1: Fraction(1)}, *others)
    monkeypatch.setitem(CLOSURES, 4, replace(CLOSURES[4], rows=rows))
    assert find_wave_orders(ends, 4)[0] < 2.2


@pytest.mark.parametrize("order", ORDERS)
def test_the_largest_wave_is_one_near_an_end(order):
    """The spectral radius of both derivatives together, which is more than that of a circle."""
    N = 48
    zero, D, other = np.zeros((N, N)), matrix_of(order, N), matrix_of(order, N, meets=True)
    values = np.linalg.eigvals(np.block([[zero, other], [D, zero]]))
    assert np.abs(values.real).max() < 1e-12
    assert abs(np.abs(values).max() - CLOSURES[order].largest) < 1e-5


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("ends", ENDS)
def test_every_claim_of_a_strand_with_ends_is_proved(ends, order):
    """The energy at N points, among others, by lines of two numbers of points."""
    certificate = prove(spec_of(ends, order)).require()
    statements = [claim.statement for claim in certificate.claims]
    kind = f"differences of order {order} and of order {order // 2} near {ends} ends"
    assert any(kind in each for each in statements)
    assert any(f"conserved between {ends} ends" in each for each in statements)
    assert certificate.count(Verdict.PROVED) == len(certificate.claims) >= 9


def test_without_the_boundary_terms_the_energy_is_lost():
    """With the same derivative in both rows the claim is refuted, at the ends alone."""
    point = GenericPoint(derive(spec_of("free", 2)))
    point.meets = (False,) * 6
    grid = make_grid(point.equations)
    lines = tuple(Rings(point).make(n, {}) for n in (4, 5))
    found = {s: decide() for s, _, decide in about_grid(replace(grid, windows=lines))}
    (energy,) = (d for s, d in found.items() if s.startswith("the energy"))
    assert energy.verdict is Verdict.REFUTED
    (same,) = (d for s, d in found.items() if "generic point" in s)
    assert same.verdict is Verdict.REFUTED


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("ends", ENDS)
def test_rates_are_those_of_matrices(ends, order):
    """Pi_t = Pi x Omega + D(K Xi) + Xi x K Xi, Xi_t = D Omega + Xi x Omega, with two D.

    For random fields, by matrices and vector products of NumPy.
    """
    N, L = 14, 3.0
    I, K = np.array([1.0, 2.0, 3.0]), np.array([3.0, 2.0, 1.0])  # noqa: E741
    source = np.random.default_rng(0)
    Pi, Xi = source.normal(size=(2, 3, N))
    Omega, stress = Pi / I[:, None], K[:, None] * Xi
    h = L / (N - 1)
    of_stress, of_velocity = (
        matrix_of(order, N, meets=each == ends) / h for each in ("free", "clamped")
    )
    expected = [
        *np.cross(Pi.T, Omega.T).T + stress @ of_stress.T + np.cross(Xi.T, stress.T).T,
        *Omega @ of_velocity.T + np.cross(Xi.T, Omega.T).T,
    ]
    family = GenericPoint(derive(spec_of(ends, order))).family
    fields = dict(zip(family.states, [*Pi, *Xi], strict=True))
    for i in range(N):
        trees = family.ends.get(i, family.ends.get(i - N, family.rates))
        near = [fields[c][(i + r) % N] for c, r in family.neighbours]
        own = [fields[c][i] for c in family.states]
        rates = compile_rates(replace(family, rates=trees))(*own, *near, *I, *K, L, N)
        np.testing.assert_allclose(rates, np.array(expected)[:, i], rtol=1e-12, atol=1e-12)


def test_densities_with_derivatives_are_refused():
    """Near ends there is no direct difference of these; the advice is followed."""
    text = STRAND.replace('"dot(Pi, Xi)"', '"dot(Pi, Xi_s)"')
    with pytest.raises(DerivationError, match=r"P has the derivative Xi1_s.*free ends") as error:
        make_grid(derive(spec_of("free", 2, text)))
    assert 'ends = "periodic"' in str(error.value)
    assert make_grid(derive(read_spec_text(text, "c.toml"))).family
