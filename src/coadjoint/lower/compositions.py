"""Compositions: how much of each flow stands where in a step of a method.

Comes in: a number of parts and an order. Goes out: a `Schedule`, pairs of a flow and the part of
the step that it takes, from the first that acts to the last one.

Those of Blanes and Moan are published with 15 digits, from which the conditions of order are solved
again in 50; the tests hold them to their order in the free algebra. In doubles the coefficient of
each flow in the middle is what the others leave, so that a step has its length to a rounding.
Read next: `coadjoint.lower.flows`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import mpmath

#: Flows, by their places, and parts of a step, in the order in which they act.
Schedule = tuple[tuple[int, float], ...]
Coefficients = tuple[Any, ...]
DIGITS: Final = 50


def blanes_moan4() -> tuple[Coefficients, Coefficients]:
    """Parts of two flows in turn that make order 4, the first one first and last.

    S. Blanes and P. C. Moan, Journal of Computational and Applied Mathematics 142 (2002) 313, S6.
    """
    a = ("0.0792036964311957", "0.353172906049774", "-0.0420650803577195")
    return _solve_pairs(a, ("0.209515106613362", "-0.143851773179818"), 4)


def blanes_moan6() -> tuple[Coefficients, Coefficients]:
    """The same of order 6: their S10."""
    a = ("0.0502627644003922", "0.413514300428344", "0.0450798897943977", "-0.188054853819569")
    b = ("0.148816447901042", "-0.132385865767784", "0.067307604692185", "0.432666402578175")
    return _solve_pairs((*a, "0.541960678450780"), b, 6)


def strang() -> tuple[Coefficients, Coefficients]:
    """The symmetric product of two flows, of order 2. G. Strang, SIAM J. Numer. Anal. 5 (1968)."""
    half = mpmath.mpf(1) / 2
    return (half, half), (mpmath.mpf(1),)


#: Parts of two flows in turn, by the order of their product.
PAIRS: Final = {2: strang, 4: blanes_moan4, 6: blanes_moan6}


def find_sweeps(a: Coefficients, b: Coefficients) -> Coefficients:
    """The lengths of sweeps through the flows, forth and back in turn, whose pairs are a and b.

    With ``a_1 = c_1, b_1 = c_1 + c_2, a_2 = c_2 + c_3`` a product of two flows is one of sweeps
    ``exp(c A) exp(c B)`` and ``exp(c B) exp(c A)``. It has the same order for sweeps through any
    number of flows: R. I. McLachlan, SIAM Journal on Scientific Computing 16 (1995) 151.
    """
    sweeps: list[Any] = []
    for n in range(len(a) + len(b) - 1):
        whole = (a, b)[n % 2][n // 2]
        sweeps.append(whole - sweeps[-1] if sweeps else whole)
    return tuple(sweeps)


@cache
def schedule(parts: int, order: int) -> Schedule:
    """A step of Strang, or of Blanes and Moan, for any number of parts.

    >>> schedule(3, 2)
    ((0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5))
    """
    with mpmath.workdps(DIGITS):
        sweeps = find_sweeps(*PAIRS[order]())
        forth = range(parts)
        flows = [(n, c) for k, c in enumerate(sweeps) for n in (forth, forth[::-1])[k % 2]]
        return _round(_merge(flows))


def _merge(flows: Sequence[tuple[int, Any]]) -> list[tuple[int, Any]]:
    """Flows of one part that follow one another, as one."""
    merged: list[tuple[int, Any]] = []
    for part, time in flows:
        if merged and merged[-1][0] == part:
            time = merged.pop()[1] + time
        merged.append((part, time))
    return merged


def _round(flows: Sequence[tuple[int, Any]]) -> Schedule:
    """Coefficients as doubles, symmetric, those of each part with the sum 1 to a rounding.

    The one in the middle is what the others leave; of a part that has none there, two are.
    """
    rounded = [float(time) for _, time in flows]
    for part in {part for part, _ in flows}:
        places = [n for n, (own, _) in enumerate(flows) if own == part]
        middle = {places[(len(places) - 1) // 2], places[len(places) // 2]}
        with mpmath.workdps(DIGITS):
            rest = 1 - mpmath.fsum(rounded[n] for n in places if n not in middle)
            for n in middle:
                rounded[n] = float(rest / len(middle))
    return tuple((part, time) for (part, _), time in zip(flows, rounded, strict=True))


# -- conditions of order ---------------------------------------------------------------------------


def _mirror(outer: Sequence[Any]) -> Coefficients:
    """Symmetric coefficients with the sum 1."""
    return (*outer, 1 - 2 * mpmath.fsum(outer), *reversed(outer))


def _solve_pairs(
    a: Sequence[str], b: Sequence[str], order: int
) -> tuple[Coefficients, Coefficients]:
    """Coefficients of two flows from approximate outer ones."""
    size = len(a)

    def complete(c: Sequence[Any]) -> tuple[Coefficients, Coefficients]:
        one, two = c[:size], c[size:]
        last = mpmath.mpf(1) / 2 - mpmath.fsum(two)
        return _mirror(one), (*two, last, last, *reversed(two))

    with mpmath.workdps(DIGITS):
        start = list(map(mpmath.mpf, (*a, *b)))
        return complete(_solve(start, lambda c: find_pair_errors(*complete(c), order)))


def _solve(start: list[Any], errors: Callable[[list[Any]], list[Any]]) -> list[Any]:
    """The nearest solution of conditions, by Newton's method with the least change."""
    here = start
    for _ in range(6):
        residuals, small = errors(here), mpmath.mpf(10) ** (-DIGITS // 2)
        if max(map(abs, residuals)) < mpmath.mpf(10) ** (5 - DIGITS):
            return here
        columns = []
        for n in range(len(here)):
            moved = [each + small * (k == n) for k, each in enumerate(here)]
            columns.append([(b - a) / small for a, b in zip(residuals, errors(moved), strict=True)])
        independent = _choose_rows(columns, len(residuals))
        slopes = mpmath.matrix([[column[r] for column in columns] for r in independent])
        change = slopes.T * mpmath.lu_solve(
            slopes * slopes.T, mpmath.matrix([residuals[r] for r in independent])
        )
        here = [each - change[n] for n, each in enumerate(here)]
    raise AssertionError("conditions of order that Newton's method does not solve")


def _choose_rows(columns: Sequence[Sequence[Any]], count: int) -> list[int]:
    """Conditions that do not follow from those before, by Gram and Schmidt."""
    chosen: list[int] = []
    basis: list[list[Any]] = []
    for row in range(count):
        rest = [column[row] for column in columns]
        size = mpmath.fsum(each * each for each in rest)
        for other in basis:
            part = mpmath.fdot(rest, other)
            rest = [a - part * b for a, b in zip(rest, other, strict=True)]
        norm = mpmath.fsum(each * each for each in rest)
        if norm > mpmath.mpf(10) ** (-DIGITS // 4) * max(size, 1):
            basis.append([each / mpmath.sqrt(norm) for each in rest])
            chosen.append(row)
    return chosen


#: Coefficients of words in letters that do not commute.
Series = dict[tuple[int, ...], Any]


def find_pair_errors(a: Sequence[Any], b: Sequence[Any], order: int) -> list[Any]:
    """What a product of ``exp(a_i A) exp(b_i B)`` differs by from ``exp(A + B)``, word by word."""
    flows = [(n % 2, (a, b)[n % 2][n // 2]) for n in range(len(a) + len(b))]
    found = multiply_exponentials([{(letter,): time} for letter, time in flows], (1, 1), order)
    return compare_series(found, {(0,): 1, (1,): 1}, (1, 1), order)


def find_sweep_errors(sweeps: Sequence[Any], order: int) -> list[Any]:
    """The same of sweeps ``exp(c X + c^2 Y + c^3 Z + ...)`` and their adjoints, in turn."""
    weights = tuple(range(1, order + 1))
    logs: list[Series] = [
        {(n,): c**weight * (-1) ** (k * (weight - 1)) for n, weight in enumerate(weights)}
        for k, c in enumerate(sweeps)
    ]
    return compare_series(multiply_exponentials(logs, weights, order), {(0,): 1}, weights, order)


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
