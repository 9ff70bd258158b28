r"""Matrices of N rows, N odd, in the place of functions on the torus: sums of waves.

With :math:`g = \mathrm{diag}(1, \zeta, \zeta^2, \dots)`, :math:`\zeta = e^{4 \pi i/N}`, and the
shift h of rows, which goes on round, the wave :math:`e^{i k \cdot x}` has the matrix

.. math:: T_k = e^{2 \pi i k_1 k_2/N} g^{k_1} h^{k_2}, \qquad
    (T_k)_{ij} = e^{2 \pi i k_1 (i + j)/N} \text{ for } j - i = k_2 \bmod N,

with :math:`[T_m, T_n] = -2 i \sin(2 \pi\, m \times n/N)\, T_{m + n}` (Zeitlin, Physica D 49 (1991)
353). So a diagonal has the waves of one k2 at N points along the first coordinate, which it meets
in steps of two. Residues k1 and k2 are taken from -(N - 1)/2 to (N - 1)/2.
Comes in: N. Goes out: entries for `coadjoint.spec.surfaces`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import cos, pi, sin


def residue(k: int, n: int) -> int:
    """The one from -(n - 1)/2 to (n - 1)/2.

    >>> [residue(k, 5) for k in range(5)]
    [0, 1, 2, -2, -1]
    """
    return (k + n // 2) % n - n // 2


def list_waves(n: int) -> list[tuple[int, int]]:
    """One of each pair k and -k, by the size of k, those with larger k1 first.

    >>> list_waves(3)
    [(1, 0), (0, 1), (1, 1), (1, -1)]
    """
    most = n // 2
    half = [(k, m) for k in range(most + 1) for m in range(-most, most + 1) if (k, m) > (0, 0)]
    return sorted(half, key=lambda k: (k[0] ** 2 + k[1] ** 2, -k[0], -k[1]))


def find_entries(n: int, parts: Sequence[float]) -> list[list[float]]:
    r"""The real matrix X of :math:`(X - X^T)/2 + \mathrm{i} (X + X^T)/2` for some waves.

    Args:
        n: Rows of the matrix.
        parts: Of the cosine and the sine of each of `list_waves`; waves behind them have none.
    """
    whole = [[0.0] * n for _ in range(n)]
    for place, (k, m) in enumerate(list_waves(n)[: (len(parts) + 1) // 2]):
        cosine, sine = (*parts[2 * place : 2 * place + 2], 0.0)[:2]
        for i in range(n):
            for sign in (1, -1):
                j = (i + sign * m) % n
                angle = 2 * pi * (k * (i + j) % n) / n
                # of i T the entry Re + Im is that of T's Re - Im
                real = cosine * cos(angle) + sine * sin(angle)
                turned = cosine * sin(angle) - sine * cos(angle)
                whole[i][j] += (real - sign * turned) / 2
    return whole


def find_weight(n: int, k2: int, step: int) -> dict[int, Fraction]:
    """What an entry adds to V, so many points along the diagonal of k2: factors of cosines by t.

    ``V = (1/n) sum over k1 of cos(2 pi t/n) W/(k1^2 + k2^2)``, where t is the size of the residue
    of ``k1 step``.

    >>> find_weight(3, 0, 1)
    {1: Fraction(2, 3)}
    """
    found = dict[int, Fraction]()
    for k1 in range(n):
        square = residue(k1, n) ** 2 + residue(k2, n) ** 2
        if square:
            t = abs(residue(k1 * step, n))
            found[t] = found.get(t, Fraction(0)) + Fraction(1, n * square)
    return found


def write_cosine(t: int, n: int) -> str:
    """``cos(2 pi t/n)`` as a formula, whose value the exact field has.

    >>> write_cosine(2, 5), write_cosine(0, 5)
    ('cos(2*pi*2/5)', '1')
    """
    return f"cos(2*pi*{t}/{n})" if t else "1"


def write_sine(t: int, n: int) -> str:
    """``sin(2 pi t/n)`` as a formula.

    >>> write_sine(1, 5), write_sine(0, 5)
    ('sin(2*pi*1/5)', '0')
    """
    return f"sin(2*pi*{t}/{n})" if t else "0"
