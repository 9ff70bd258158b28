"""Functions for which matrices stand, against harmonic polynomials."""

import numpy as np
import pytest

from coadjoint.solve.matrix_functions import show_on_sphere
from tests.truncated import POLYNOMIALS, harmonic, pack

#: Points of Gauss and of even longitudes, by which integrals of polynomials are exact.
HEIGHTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
LONGITUDES = 2 * np.pi * np.arange(16) / 16


def evaluate(name):
    """A harmonic polynomial on the sphere, with squares that have the integral 1."""
    across = np.sqrt(1 - HEIGHTS**2)[:, None]
    known = {
        "x": across * np.cos(LONGITUDES),
        "y": across * np.sin(LONGITUDES),
        "z": np.repeat(HEIGHTS[:, None], len(LONGITUDES), axis=1),
    }
    values = sum(
        factor * np.prod([known[each] for each in letters], axis=0)
        for factor, letters in POLYNOMIALS[name]
    )
    return values / np.sqrt(integrate(values**2))


def integrate(values):
    """Over the unit sphere."""
    return 2 * np.pi * np.mean(WEIGHTS @ values)


def show(W):
    """The function of a skew-Hermitian matrix at these points."""
    return show_on_sphere(pack(W).reshape(W.shape), HEIGHTS, LONGITUDES)


@pytest.mark.parametrize("name", POLYNOMIALS)
@pytest.mark.parametrize("n", [4, 9])
def test_matrices_of_harmonics_are_shown_as_these(name, n):
    """With their signs, and with longitudes that go the right way round."""
    np.testing.assert_allclose(show(1j * harmonic(name, n)), evaluate(name), atol=1e-13)


def test_squares_of_matrices_are_squares_of_functions():
    """``4 pi/N tr W* W`` is the integral of the square: no part is lost, of whatever degree."""
    source = np.random.default_rng(1)
    A = source.normal(size=(7, 7)) + 1j * source.normal(size=(7, 7))
    W = A - A.conj().T
    expected = 4 * np.pi / 7 * np.trace(W.conj().T @ W).real
    assert integrate(show(W) ** 2) == pytest.approx(expected, rel=1e-12)


def test_a_turned_matrix_is_a_turned_function():
    """``exp(-i a S_z) W exp(i a S_z)`` is the function carried eastwards by a."""
    angle, levels = 2 * np.pi / 16, 2.0 - np.arange(5)
    W = 1j * (harmonic("C2_1", 5) + 0.3 * harmonic("S3_2", 5))
    turned = np.exp(-1j * angle * levels)[:, None] * W * np.exp(1j * angle * levels)
    np.testing.assert_allclose(show(turned), np.roll(show(W), 1, axis=1), atol=1e-13)
    assert np.abs(show(turned) - np.roll(show(W), -1, axis=1)).max() > 0.1
