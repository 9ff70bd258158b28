"""Conditions of order of products of flows, word by word in the free algebra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath

#: Coefficients of words in letters that do not commute.
Series = dict[tuple[int, ...], Any]


def find_pair_errors(a: Sequence[Any], b: Sequence[Any], order: int) -> list[Any]:
    """What a product of ``exp(a_i A) exp(b_i B)`` differs by from ``exp(A + B)``, word by word."""
    flows = [(n % 2, _read((a, b)[n % 2][n // 2])) for n in range(len(a) + len(b))]
    found = multiply_exponentials([{(letter,): time} for letter, time in flows], (1, 1), order)
    return compare_series(found, {(0,): 1, (1,): 1}, (1, 1), order)


def find_sweep_errors(sweeps: Sequence[Any], order: int) -> list[Any]:
    """The same of sweeps ``exp(c X + c^2 Y + c^3 Z + ...)`` and their adjoints, in turn."""
    weights = tuple(range(1, order + 1))
    logs: list[Series] = [
        {(n,): c**weight * (-1) ** (k * (weight - 1)) for n, weight in enumerate(weights)}
        for k, c in enumerate(map(_read, sweeps))
    ]
    return compare_series(multiply_exponentials(logs, weights, order), {(0,): 1}, weights, order)


def _read(coefficient: Any) -> Any:
    """A decimal in the arithmetic of the conditions."""
    return mpmath.mpf(str(coefficient))


def multiply_exponentials(logs: Sequence[Series], weights: Sequence[int], order: int) -> Series:
    """A product of exponentials up to words of some weight, the first one to act on the left."""
    total: Series = {(): mpmath.mpf(1)}
    for log in logs:
        total = _multiply(total, _exponential(log, weights, order), weights, order)
    return total


def _exponential(log: Series, weights: Sequence[int], order: int) -> Series:
    """The exponential of a series without constant term."""
    total: Series = {(): mpmath.mpf(1)}
    power = total
    for n in range(1, order + 1):
        power = {w: c / n for w, c in _multiply(power, log, weights, order).items()}
        for word, value in power.items():
            total[word] = total.get(word, 0) + value
    return total


def _multiply(a: Series, b: Series, weights: Sequence[int], order: int) -> Series:
    """The product of two series, longer words left out."""
    result: Series = {}
    for one, left in a.items():
        for two, right in b.items():
            if sum(weights[letter] for letter in one + two) <= order:
                result[one + two] = result.get(one + two, 0) + left * right
    return result


def compare_series(found: Series, log: Series, weights: Sequence[int], order: int) -> list[Any]:
    """What two series differ by, in the order of words."""
    expected = _exponential(log, weights, order)
    words = sorted(found.keys() | expected.keys(), key=lambda word: (len(word), word))
    return [found.get(word, mpmath.mpf(0)) - expected.get(word, 0) for word in words]
