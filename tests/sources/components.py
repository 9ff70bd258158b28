"""Vectors and matrices in components, in any arithmetic, as the book's formulas use them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Any

import sympy

Vector = Sequence[Any]


def cross(a: Vector, b: Vector) -> list[Any]:
    """``a x b`` in components."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Vector, b: Vector) -> Any:
    """``a . b`` in components."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def root(value: Any) -> Any:
    """The square root, exact for fractions."""
    return math.sqrt(value) if isinstance(value, float) else sympy.sqrt(sympy.Rational(value))


def plus(a: Vector, b: Vector) -> list[Any]:
    """``a + b`` in components."""
    return [x + y for x, y in zip(a, b, strict=True)]


def minus(a: Vector, b: Vector) -> list[Any]:
    """``a - b`` in components."""
    return [x - y for x, y in zip(a, b, strict=True)]


def hat(a: Vector) -> list[list[Any]]:
    """``hat(a) b = a x b``."""
    return [[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]]


def times(factor: Any, a: Vector) -> list[Any]:
    """``factor a`` in components."""
    return [factor * x for x in a]


def over(a: Vector, b: Vector) -> list[Any]:
    """Components of a divided by those of b: a momentum by its inertia."""
    return [x / y for x, y in zip(a, b, strict=True)]


def minus_bracket(ad_star: Callable[[Vector, Vector], list[Any]], mu: Vector) -> list[list[Any]]:
    """``{mu_i, mu_j} = -<mu, [e_i, e_j]> = -(ad*_{e_i} mu)_j`` (Holm 2011, section 9.4)."""
    units = ([int(i == k) for k in range(len(mu))] for i in range(len(mu)))
    return [times(-1, ad_star(unit, mu)) for unit in units]


def product(a: Sequence[Vector], b: Sequence[Vector]) -> list[list[Any]]:
    """Matrix product."""
    return [[sum(x * y for x, y in zip(row, c, strict=True)) for c in turned(b)] for row in a]


def turned(a: Sequence[Vector]) -> list[list[Any]]:
    """Transpose of a matrix."""
    return [list(column) for column in zip(*a, strict=True)]


def commutator(a: Sequence[Vector], b: Sequence[Vector]) -> list[list[Any]]:
    """``a b - b a``."""
    ab, ba = product(a, b), product(b, a)
    return [[x - y for x, y in zip(*rows, strict=True)] for rows in zip(ab, ba, strict=True)]


def antisymmetric(entries: Vector, size: int) -> list[list[Any]]:
    """The matrix with the given entries above its diagonal."""
    matrix = [[0 * entries[0]] * size for _ in range(size)]
    for (i, j), entry in zip(combinations(range(size), 2), entries, strict=True):
        matrix[i][j], matrix[j][i] = entry, -entry
    return matrix


def pfaffian(M: Sequence[Vector]) -> Any:
    """By expansion along the first row."""
    if not M:
        return 1
    total = 0 * M[0][0]
    for j in range(1, len(M)):
        rest = [k for k in range(1, len(M)) if k != j]
        inner = pfaffian([[M[r][c] for c in rest] for r in rest])
        total += (-1) ** (j - 1) * M[0][j] * inner
    return total
