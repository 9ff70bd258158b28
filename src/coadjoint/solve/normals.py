"""Normal numbers by their place: words of Philox, and a fixed map of each to a normal number.

A number has a seed, a member, a step and a Wiener process, and knows of no other: any batch, any
number of threads and any order give the same paths. The map has + - * / and sqrt alone, so that
generated solvers in C have the same bits.
Comes in: seeds and places. Goes out: normal numbers. Read next: `coadjoint.solve.stochastic`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.lower.normals import FAR, LOG2, MIDDLE, MULTIPLIERS, ROUNDS, SERIES, TAIL, WEYL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from coadjoint.array_types import Array

    Words = NDArray[np.uint64]

_WORD: Final = np.uint64(0xFFFFFFFF)
_HALF: Final = np.uint64(32)


def philox(counter: Sequence[Words | int], key: tuple[int, int]) -> list[Words]:
    """Philox4x32-10: four words of 32 bits from four words of a counter and two of a key.

    >>> [hex(int(word)) for word in philox([0, 0, 0, 0], (0, 0))]
    ['0x6627e8d5', '0xe169c58d', '0xbc57ac4c', '0x9b00dbd8']
    """
    a, b, c, d = (np.asarray(word, np.uint64) for word in counter)
    key_a, key_b = key
    for _ in range(ROUNDS):
        one, two = np.uint64(MULTIPLIERS[0]) * a, np.uint64(MULTIPLIERS[1]) * c
        a, b, c, d = (
            (two >> _HALF) ^ b ^ np.uint64(key_a),
            two & _WORD,
            (one >> _HALF) ^ d ^ np.uint64(key_b),
            one & _WORD,
        )
        key_a, key_b = (key_a + WEYL[0]) & 0xFFFFFFFF, (key_b + WEYL[1]) & 0xFFFFFFFF
    return [a, b, c, d]


def draw_normals(seed: int, member: Words, step: Words, process: int | Words) -> Array:
    """A normal number for each member.

    Args:
        seed: From 0 to 2^64 - 1, the key.
        member: Its place in the whole batch, below 2^32.
        step: How many steps it has made, below 2^64.
        process: The number of the Wiener process; or those of some, ``(w, 1)``, for a number of
            each, ``(w, N)``.
    """
    counter = (step & _WORD, step >> _HALF, member, process)
    low, high, *_ = philox(counter, (seed & 0xFFFFFFFF, seed >> 32))
    return normal_of(as_probability(low, high))


def as_probability(low: Words, high: Words) -> Array:
    """Two words as a number between 0 and 1, never either: 52 bits and a half."""
    bits = (high << _HALF | low) >> np.uint64(12)
    return np.asarray((bits.astype(np.float64) + 0.5) * 2.0**-52)


def normal_of(probability: Array) -> Array:
    """The normal number below which others are with a probability, within 1e-15 of its size.

    >>> normal_of(np.array([0.5, 0.975])).round(6).tolist()
    [0.0, 1.959964]
    """
    middle = probability - 0.5
    least = np.where(probability < 1.0 - probability, probability, 1.0 - probability)
    root = np.sqrt(minus_log(least))
    tail = np.where(root <= 5.0, _divide(TAIL, root - 1.6), _divide(FAR, root - 5.0))
    tail = np.where(middle < 0.0, -tail, tail)
    r = 0.180625 - middle * middle
    inner = middle * _horner(MIDDLE[0], r) / _horner(MIDDLE[1], r)
    return np.where(np.abs(middle) <= 0.425, inner, tail)


def minus_log(a: Array) -> Array:
    """Minus the natural logarithm, by operations that round alike everywhere.

    >>> float(minus_log(np.array([0.5]))[0])
    0.6931471805599453
    """
    bits = a.view(np.int64)
    exponent = ((bits >> 52) | 0x4330000000000000).view(np.float64) - 4503599627371519.0
    m = ((bits & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000).view(np.float64)
    large = m > 1.4142135623730951
    m, exponent = np.where(large, m * 0.5, m), np.where(large, exponent + 1.0, exponent)
    s = (m - 1.0) / (m + 1.0)
    log = 2.0 * s * _horner(SERIES, s * s)
    return np.asarray(-(exponent * LOG2[0]) - (exponent * LOG2[1] + log))


def _divide(pair: tuple[tuple[float, ...], ...], r: Array) -> Array:
    """A quotient of polynomials."""
    return _horner(pair[0], r) / _horner(pair[1], r)


def _horner(coefficients: Sequence[float], r: Array) -> Array:
    """A polynomial, its last coefficient first."""
    total = np.full(r.shape, coefficients[-1])
    for each in reversed(coefficients[:-1]):
        total = total * r + each
    return total
