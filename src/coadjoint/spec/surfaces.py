"""Surfaces on which functions have matrices of N rows in their place.

Comes in: N. Goes out: what a Laplacian does to the entries, as an energy for a few N; how modes of
functions are named and ordered. Read next: `coadjoint.spec.truncated`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt, prod
from types import MappingProxyType
from typing import Final

from coadjoint.algebra import harmonics, waves
from coadjoint.exact.dense import inverse


@dataclass(frozen=True)
class Surface:
    """A surface.

    Attributes:
        modes: What an inertia calls the numbers of a mode of functions, with those of a first mode.
        laplacian: Minus the Laplacian of a mode, as text in these names.
        inertia: An inertia by which motions tend to those of an ideal fluid, in N.
        least: The fewest rows with which anything moves.
        written: The numbers of rows that are written out.
        list_terms: Of the energy, over the inertia of the first mode, for so many rows and the
            names of the entries.
        find_entries: The rows of the real matrix of a function, from its parts.
        is_odd: Whether there are matrices of odd numbers of rows alone.
        parts: What the parts of a function are, in words.
    """

    modes: Mapping[str, int]
    laplacian: str
    inertia: str
    least: int
    written: tuple[int, ...]
    list_terms: Callable[[int, Sequence[str]], Iterator[str]]
    find_entries: Callable[[int, Sequence[float]], list[list[float]]]
    is_odd: bool
    parts: str


def _list_on_sphere(n: int, names: Sequence[str]) -> Iterator[str]:
    """``sum W_ij V_ij`` over the inertia of degree 1, where ``L V = W``, term by term.

    On a diagonal the couplings are square roots of whole numbers b. With rows i over the product of
    the roots before them L is rational, and so is its inverse.
    """
    for diagonal in range(1 - n, n):
        rows = [i for i in range(n) if 0 <= i + diagonal < n]
        own = [names[i * n + i + diagonal] for i in rows]
        squares = [
            (i + 1) * (n - 1 - i) * (j + 1) * (n - 1 - j) for i in rows for j in [i + diagonal]
        ]
        matrix = [[Fraction(0)] * len(rows) for _ in rows]
        for a, i in enumerate(rows):
            z, w = (Fraction(n - 1 - 2 * k, 2) for k in (i, i + diagonal))
            matrix[a][a] = 2 * (Fraction(n * n - 1, 4) - z * w)
            if a + 1 < len(rows):
                matrix[a][a + 1], matrix[a + 1][a] = Fraction(-squares[a]), Fraction(-1)
        if not diagonal:  # its couplings are whole numbers: the inverse but for multiples of 1
            mean = Fraction(1, n)
            whole = [[mean] * n for _ in rows]
            for a in range(n):
                for b in range(n):
                    step = abs(a - b)
                    root = isqrt(squares[min(a, b)]) if step == 1 else 0
                    whole[a][b] += matrix[a][a] if a == b else -root
            found = [[x - mean for x in row] for row in inverse(tuple(map(tuple, whole)))]
            squares = [1] * n
        else:
            found = [list(row) for row in inverse(tuple(map(tuple, matrix)))]
        for a in range(len(rows)):
            for b in range(a, len(rows)):
                # (1/2) 2 for b > a, and L = l (l + 1) is 2 in degree 1
                value = found[a][b] * (2 if b > a else 1)
                root = prod(squares[a:b])
                if value:
                    yield _write_term(value, root, own[a], own[b])


def _list_on_torus(n: int, names: Sequence[str]) -> Iterator[str]:
    """The same on the torus: V is a sum over the entries of its diagonal, which goes on round.

    Both diagonals of k2 and -k2 have the same sums, and so have steps ahead and back.
    """
    for k2 in range(n // 2 + 1):
        for step in range(n // 2 + 1):
            pairs = [
                f"{names[i * n + (i + d) % n]}*{names[(i + step) % n * n + (i + d + step) % n]}"
                for d in sorted({k2, -k2})
                for i in range(n)
            ]
            parts = [
                f"({value.numerator}/{value.denominator})*{waves.write_cosine(t, n)}"
                for t, value in waves.find_weight(n, k2, 2 * step).items()
            ]
            share = "" if step else "1/2*"
            yield f"{share}({' + '.join(parts)})*({' + '.join(pairs)})"


def _write_term(value: Fraction, root: int, one: str, other: str) -> str:
    """A number over a square root times two names."""
    below = "" if root == 1 else f"/sqrt({root})"
    if isqrt(root) ** 2 == root and root > 1:
        value, below = value / isqrt(root), ""
    return f"({value.numerator}/{value.denominator}){below}*{one}*{other}"


#: The surfaces by their names in specs.
SURFACES: Final[Mapping[str, Surface]] = MappingProxyType(
    {
        "sphere": Surface(
            modes=MappingProxyType({"l": 1}),
            laplacian="l*(l + 1)",
            inertia="2*l*(l + 1)/sqrt(N^2 - 1)",
            least=2,
            written=(3, 4),
            list_terms=_list_on_sphere,
            find_entries=harmonics.find_entries,
            is_odd=False,
            parts="harmonics, degree by degree from 1 on",
        ),
        "torus": Surface(
            modes=MappingProxyType({"k1": 1, "k2": 0}),
            laplacian="k1^2 + k2^2",
            inertia="4*pi*(k1^2 + k2^2)/N",
            least=3,
            written=(3, 5),
            list_terms=_list_on_torus,
            find_entries=waves.find_entries,
            is_odd=True,
            parts="waves, cosine and sine of each, by k1^2 + k2^2",
        ),
    }
)
