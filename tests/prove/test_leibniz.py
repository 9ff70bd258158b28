"""How far the Jacobi identity fails at N points: orders, formulas by hand, and an exact ring."""

import json
from functools import partial
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
from sympy.combinatorics.permutations import Permutation

from coadjoint.derive import derive
from coadjoint.derive.fields import generic
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.fields.operators import Term
from coadjoint.derive.fields.rings import Rings
from coadjoint.poisson.jacobi import schouten_bracket, slopes_by
from coadjoint.prove.grids import about_grid
from coadjoint.prove.leibniz import FUNCTIONS, list_terms, measure_defect, wave_matrices
from coadjoint.solve.spectral import Waves
from coadjoint.systems import spin_chain_lattice
from tests.bodies.lattices import strand
from tests.fields import fields_by_order, grid_of


@pytest.mark.parametrize(
    ("name", "order"),
    [
        ("kdv", 6),
        ("camassa_holm", 4),
        ("sp2_strand", 4),
        *(("spin_chain", p) for p in (2, 4, 6, 8)),
    ],
)
def test_the_defect_falls_with_the_order_of_the_differences(name, order):
    """By a factor of 2^p from 48 to 96 points, and it is not rounding."""
    grid = make_grid(fields_by_order(name, order))
    few, many = (measure_defect(grid, N) for N in (48, 96))
    assert many > 1e-12
    assert np.log2(few / many) == pytest.approx(order, abs=0.25)


def test_brackets_of_points_have_none():
    """Of a magnet, whatever stands for derivatives: rounding alone."""
    for by_waves in (False, True):
        assert measure_defect(grid_of("landau_lifshitz"), 24, by_waves=by_waves) < 1e-14


def test_a_strand_misses_by_half_h_squared_at_order_two():
    """D(f g) - f D g - g D f = h^2 (f' g')'/2 + O(h^4), by Taylor's expansion of both."""
    N, length = 256, 10.0
    theta, k = 2 * np.pi * np.arange(N) / N, 2 * np.pi / length
    f = [F(theta) for F in FUNCTIONS]
    slopes = [-k * np.sin(theta - n**2) * F for n, F in enumerate(f, 1)]
    h, waves = length / N, Waves(N, np.array([length]))
    bent = waves.differentiate((slopes[0] * slopes[1])[:, np.newaxis], 1)[:, 0]
    expected = h**3 / 2 * np.sum(f[2] * bent)
    found = sum(list_terms(make_grid(fields_by_order("spin_chain", 2)), N, FUNCTIONS))
    for a, b, c in product(range(3), repeat=3):  # of Pi_a, Pi_b and Xi_c
        sign = Permutation([a, b, c]).signature() if len({a, b, c}) == 3 else 0
        assert abs(found[a, b, 3 + c]) == pytest.approx(abs(sign * expected), rel=2e-3, abs=1e-12)


@pytest.mark.parametrize("name", ["spin_chain", "kdv"])
def test_the_sum_is_that_of_the_schouten_bracket_of_a_ring(name):
    """Rings are derived exactly, by a matrix for the bracket; seen at the same fields."""
    ring, names = grid_of(name).windows[0], grid_of(name).equations.setting.state
    field, state = ring.setting.field, ring.setting.state
    N, width = len(state) // len(names), 3 if name == "spin_chain" else 1
    # all of a vector at the first point, then at the next one, and so on
    blocks = range(0, len(names), width)
    places = [(first + c, i) for first in blocks for i in range(N) for c in range(width)]
    theta = 2 * np.pi * np.arange(N) / N
    values = {x: float(field.region.defaults[x]) for x in ring.setting.parameters}
    u = [np.exp(np.sin(theta[i] + a + 1)) for a, i in places]
    h, phi = values["L"] / N, [F(theta) for F in FUNCTIONS]
    values |= zip(state, u, strict=True)
    expected = np.zeros((len(names),) * 3)
    found = schouten_bracket(ring.exact.poisson_tensor, slopes_by(field, state))
    for triple, element in found.items():
        value = field.evaluate(element, values, float) * h**3
        for order in permutations(range(3)):
            (a, i), (b, j), (c, k) = (places[triple[n]] for n in order)
            sign = Permutation(order).signature()
            expected[a, b, c] += sign * value * phi[0][i] * phi[1][j] * phi[2][k]
    assert np.abs(expected).max() > 1e-4
    own = sum(list_terms(grid_of(name), N, FUNCTIONS))
    np.testing.assert_allclose(own, expected, atol=1e-12 * np.abs(expected).max(), rtol=1e-9)


def test_a_bracket_that_is_none_misses_at_any_number_of_points(monkeypatch):
    """With the other sign of Pi x alone the defect does not fall."""
    operator = GenericPoint(grid_of("spin_chain").equations).operator
    wrong = tuple(
        tuple(
            tuple(Term(-t.left, t.order, t.right) if i < 3 and j < 3 else t for t in entry)
            for j, entry in enumerate(row)
        )
        for i, row in enumerate(operator)
    )
    monkeypatch.setattr(generic, "field_operator", lambda _: wrong)
    assert measure_defect(grid_of("spin_chain"), 64) > 0.1


@pytest.mark.parametrize("name", ["kdv", "spin_chain"])
def test_fourier_derivatives_miss_by_aliases_alone(name):
    """Of waves up to the second one nothing at 16 points; of all waves at 12, less at 20."""
    few = [partial(lambda n, x: 1 + np.cos(x - n**2) + np.sin(2 * x + n), n) for n in (1, 2, 3)]
    parts = list_terms(grid_of(name), 16, few, by_waves=True)
    assert np.abs(sum(parts)).max() < 1e-13 * max(np.abs(part).max() for part in parts)
    for grid_size, least, most in ((12, 1e-9, 1e-4), (24, 0, 1e-12)):
        assert least < measure_defect(grid_of(name), grid_size, by_waves=True) < most


@pytest.mark.parametrize("N", [8, 9])
def test_matrices_of_waves_are_their_derivatives(N):
    """Of random numbers, at even and odd numbers of points."""
    values = np.random.default_rng(0).normal(size=(N, 1))
    matrices = wave_matrices(Rings(GenericPoint(grid_of("kdv").equations)), N, N / 7.0)
    for order in (1, 2, 3):
        expected = Waves(N, np.array([7.0])).differentiate(values, order)
        np.testing.assert_allclose(matrices(order, 0) @ values, expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("ends", ["free", "clamped"])
def test_between_ends_the_defect_falls_too(ends):
    """More slowly, since differences near ends have a lower order."""
    grid = make_grid(derive(strand(("order = 4", f'order = 4, ends = "{ends}"'), (', "P"', ""))))
    few, many = (measure_defect(grid, N) for N in (64, 128))
    assert 1e-12 < many < few / 3


def test_the_certificate_says_by_how_much():
    """Of differences and of Fourier derivatives, with the functions and numbers of points."""
    examined = about_grid(grid_of("spin_chain"))
    (fails, own), (by_waves, other) = ((s, f()) for s, kind, f in examined if kind == "jacobi")
    assert fails == "the Jacobi identity of the bracket fails at N points by O(h^4)"
    assert by_waves == f"{fails.removesuffix(' by O(h^4)')} with Fourier derivatives"
    told = "is 9.5e-06 of its largest term at 32 points and 5.9e-07 at 64"
    assert told in own.method
    assert "exp(cos(2*pi*s/L - n^2))*u_a" in own.method
    assert own.scope == "for these functions and fields, in doubles"
    assert "2.8e-08 of its largest term at 12 points and less than 1e-12 at 24" in other.method


def test_a_lattice_of_bodies_has_none():
    """Its identity is proved, and nothing is said to fail."""
    told = json.loads(Path(spin_chain_lattice.__file__).with_name("certificate.json").read_bytes())
    verdicts = [c["verdict"] for c in told["claims"] if "satisfies the Jacobi" in c["statement"]]
    assert verdicts
    assert {*verdicts} == {"proved"}
    assert not any("Jacobi" in each["statement"] for each in told["findings"])
