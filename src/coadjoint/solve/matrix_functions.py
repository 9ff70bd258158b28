r"""Functions on a surface that skew-Hermitian matrices stand for.

On the sphere a matrix is a sum of matrices of spherical harmonics, ``i T_lm`` with a trace of
squares of N/(4 pi), and stands for the sum of the harmonics with the same parts, whose squares have
the integral 1: what `coadjoint.algebra.harmonics.find_entries` does, the other way. On the torus it
is a sum of matrices of waves, ``i T_k``, and stands for that of the waves
(`coadjoint.algebra.waves`).
Comes in: entries. Goes out: values at points. Read next: `coadjoint.solve.maps`.
"""

from __future__ import annotations

from functools import cache
from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.algebra.harmonics import list_towers

if TYPE_CHECKING:
    from coadjoint.array_types import Array


def show_on_sphere(entries: Array, heights: Array, longitudes: Array) -> Array:
    """Values of the function that a matrix stands for.

    Args:
        entries: The real matrix X of ``(X - X^T)/2 + i (X + X^T)/2``, ``(N, N)``.
        heights: Sines of latitudes, ``(a,)``.
        longitudes: In radians, ``(b,)``.

    Returns:
        ``(a, b)``, in the unit of the entries.

    >>> import numpy as np
    >>> from coadjoint.algebra.harmonics import find_entries
    >>> z = np.array([-1.0, 0.0, 0.5])
    >>> X = np.array(find_entries(5, [1]))  # the harmonic of degree 1 about the axis
    >>> shown = show_on_sphere(X, z, np.zeros(1))[:, 0]
    >>> bool(np.allclose(shown, np.sqrt(3 / (4 * np.pi)) * z))
    True
    """
    n = len(entries)
    values = np.zeros((len(heights), len(longitudes)))
    for order, towers in enumerate(find_towers(n)):
        above, below = np.diagonal(entries, order), np.diagonal(entries, -order)
        waves = _list_legendre(heights, order, n - order)  # (degrees, a)
        cosine, sine = (4 * pi / n * towers @ part for part in (above + below, above - below))
        if not order:
            values += (cosine / 2 @ waves)[:, None]
            continue
        angles = order * longitudes
        values += np.outer(cosine @ waves, np.cos(angles)) + np.outer(sine @ waves, np.sin(angles))
    return values


def show_on_torus(entries: Array) -> Array:
    """Values of the function that a matrix stands for, at as many points as it has entries.

    Args:
        entries: The real matrix X of ``(X - X^T)/2 + i (X + X^T)/2``, ``(N, N)``, N odd.

    Returns:
        ``(N, N)``, in the unit of the entries, at multiples of ``2 pi/N`` along x, then along y.

    >>> import numpy as np
    >>> from coadjoint.algebra.waves import find_entries
    >>> X = np.array(find_entries(5, [0, 0, 0, 1]))  # the sine of y
    >>> bool(np.allclose(show_on_torus(X), np.sin(2 * np.pi * np.arange(5) / 5)))
    True
    """
    n = len(entries)
    i, k2 = np.arange(n)[:, None], np.arange(n)
    turned = entries.T
    over_i = (entries + turned) / 2 - 1j * (entries - turned) / 2
    waves = np.empty((n, n), complex)  # by x and by k2
    waves[(2 * i + k2) % n, np.broadcast_to(k2, (n, n))] = over_i[i, (i + k2) % n]
    found: Array = np.fft.ifft(waves, axis=1, norm="forward").real
    return found


@cache
def find_towers(n: int) -> tuple[Array, ...]:
    """By order m the diagonals of T_lm, l = m, m + 1, ...: ``(n - m, n - m)``."""
    degrees = [list_towers(n, degree) for degree in range(n)]
    return tuple(
        np.array([degrees[degree][order] for degree in range(order, n)]) for order in range(n)
    )


def _list_legendre(z: Array, order: int, count: int) -> Array:
    """Harmonics of an order at the longitude 0, degree by degree: ``(count, len(z))``.

    The squares of ``f(z)`` over the sphere have the integral 1 for the order 0; of others those of
    ``sqrt(2) f(z) cos(m phi)`` have it. By the recurrence over degrees, which is stable (Press and
    others, Numerical Recipes, 3rd ed., 6.7.1).
    """
    first = np.full_like(z, sqrt(1 / (4 * pi)))
    for m in range(1, order + 1):
        first = first * sqrt((2 * m + 1) / (2 * m)) * np.sqrt(1 - z * z)
    found = [first, sqrt(2 * order + 3) * z * first]
    for degree in range(order + 2, order + count):
        a, b = (sqrt((4 * k * k - 1) / (k * k - order * order)) for k in (degree, degree - 1))
        found.append(a * (z * found[-1] - found[-2] / b))
    return np.array(found[:count])
