"""su(N) by spherical harmonics: the Laplacian, polynomials, and the limit of large N."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.harmonics import find_entries, spin_matrices
from coadjoint.algebra.matrices import combination, commutator, realify
from tests.sources.fluids import HARMONICS, matrix_of
from tests.truncated import POLYNOMIALS, harmonic, pack, unpack
from tests.truncated import laplacian as apply_laplacian


def laplacian(matrix, n):
    """``-sum_a [S_a, [S_a, E]]``, with ``S_x^2 + S_y^2 = (S_+ S_- + S_- S_+)/2``."""
    up, down, level = (realify(each, {}, n) for each in spin_matrices(n))
    pairs = [(Fraction(1, 2), up, down), (Fraction(1, 2), down, up), (1, level, level)]
    return combination((-c, commutator(a, commutator(b, matrix))) for c, a, b in pairs)


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_each_degree_is_an_eigenspace_of_the_laplacian(n):
    """Of -l (l + 1), 2 l + 1 times (Hoppe and Yau 1998); another degree is seen."""
    algebra = algebra_by_name(f"harmonics({n})")
    for name, matrix in zip(algebra.basis, algebra.matrices, strict=True):
        degree = int(name[1])
        turned = laplacian(matrix, n)
        assert turned == combination([(-degree * (degree + 1), matrix)])
        assert turned != combination([(-(degree + 1) * (degree + 2), matrix)])
    sizes = [len(algebra.blocks[f"degree_{d}"]) for d in range(1, n)]
    assert sizes == [2 * d + 1 for d in range(1, n)]


@pytest.mark.parametrize("n", [4, 5])
def test_the_basis_is_that_of_symmetrized_polynomials(n):
    """Each matrix up to degree 3 is a positive multiple of that of its harmonic."""
    algebra = algebra_by_name(f"harmonics({n})")
    assert tuple(HARMONICS) == algebra.basis[:15]
    for name, matrix in zip(HARMONICS, algebra.matrices, strict=False):
        known = matrix_of(name, n)
        place = next(iter(known))
        factor = Fraction(matrix[place]) / known[place]
        assert factor > 0
        assert dict(matrix) == combination([(factor, known)])


@pytest.mark.parametrize("n", [2, 3, 4])
def test_it_is_a_compact_form_with_all_casimirs(n):
    """su(n): a negative definite Killing form, rank n^2 - n."""
    algebra = algebra_by_name(f"harmonics({n})")
    assert algebra.killing_signature() == (0, n * n - 1, 0)
    assert algebra.generic_rank() == n * n - n


def parts_of_commutator(n):
    """The parts of ``[F, G]/(i hbar)`` along three harmonics, F and G for x^2 - y^2 and y z.

    Matrices here are i F and i G, whose commutator is -[F, G].
    """
    hbar = 2 / np.sqrt(n**2 - 1)
    dense = {}
    for name in ("C2_2", "S2_1", "C1_1", "C3_1", "C3_3"):
        matrix = np.zeros((2 * n, 2 * n))
        for place, value in matrix_of(name, n).items():
            matrix[place] = value
        dense[name] = matrix * hbar ** int(name[1])
    a, b, *others = dense.values()
    bracket = -(a @ b - b @ a) / hbar
    found = [np.trace(bracket @ E) / np.trace(E @ E) for E in others]
    return np.array(found)


def sphere_parts():
    """The same parts of ``{f, g} = x . grad f x grad g``, by means over the sphere.

    Along x, 4 x z^2 - x^3 - x y^2 and x^3 - 3 x y^2; Gauss's rule is exact here.
    """
    z, weight = np.polynomial.legendre.leggauss(12)
    phi = 2 * np.pi * np.arange(12) / 12
    z, phi = np.meshgrid(z, phi)
    rho = np.sqrt(1 - z**2)
    x, y = rho * np.cos(phi), rho * np.sin(phi)
    f, g = (2 * x, -2 * y, 0 * x), (0 * x, z, y)
    turned = np.cross(np.moveaxis(f, 0, -1), np.moveaxis(g, 0, -1))
    bracket = x * turned[..., 0] + y * turned[..., 1] + z * turned[..., 2]
    harmonics = [x, 4 * x * z**2 - x**3 - x * y**2, x**3 - 3 * x * y**2]
    mean = lambda values: (weight * values).sum()  # noqa: E731
    return np.array([mean(bracket * h) / mean(h * h) for h in harmonics])


def test_the_bracket_tends_to_that_of_the_sphere():
    """Its structure constants between fixed harmonics differ by O(N^-2)."""
    exact = sphere_parts()
    assert np.abs(exact).min() > 0.1
    errors = [np.abs(parts_of_commutator(n) - exact).max() for n in (9, 18, 36)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 2, atol=0.1)


@pytest.mark.parametrize("n", [4, 7])
def test_entries_are_those_of_symmetrized_polynomials(n):
    """Each harmonic up to degree 3, with its sign and size, as i times a Hermitian matrix."""
    for place, name in enumerate(POLYNOMIALS):
        found = np.array(find_entries(n, [0.0] * place + [1.0]))
        np.testing.assert_allclose(found.ravel(), pack(1j * harmonic(name, n)), atol=1e-13)
    assert place == 14


@pytest.mark.parametrize(("degree", "order"), [(1, 0), (9, 4), (30, 30), (39, 0), (39, 17)])
def test_entries_of_high_degree_are_unit_vectors_of_the_laplacian(degree, order):
    """For 40 rows, of the eigenvalue ``-l (l + 1)``; of another degree that is not so."""
    n, parts = 40, [0.0] * (degree * degree - 1 + 2 * order) + [1.0]
    W = unpack(np.array(find_entries(n, parts)).ravel())
    assert -np.trace(W @ W).real * 4 * np.pi / n == pytest.approx(1, rel=1e-12)
    size = degree * (degree + 1)
    np.testing.assert_allclose(apply_laplacian(W), -size * W, atol=1e-12 * size)
    assert np.abs(apply_laplacian(W) + (size + 1) * W).max() > 0.01
