"""Cross-check, methods: one step of each method in any arithmetic, as textbooks write it.

Comes in: rates or coefficients in some arithmetic, and the length of a step. Goes out: the state
after a part of the step, and at its end. Run in 60 digits on the equations this is the exact step;
run on the Program in numbers with envelopes, and in numbers that count operations, it bounds what
rounding does to a step in doubles: to first order no more than depth * 2^-53 * envelope, as for
kernels.
Read next: `coadjoint.crosscheck.solver_steps`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, Final

import numpy as np

from coadjoint.lower.tableau import load_dop853

#: Values in some arithmetic, row by row.
Row = list[Any]
#: Rates at a state, some time after the start.
Rates = Callable[[Row, Any], Row]
#: Takes a number into the arithmetic.
Number = Callable[[Fraction], Any]


def minus(a: Any, b: Any) -> Any:
    """A difference, in arithmetics that have a sign."""
    return a + -b


def taylor(coefficients: Sequence[Sequence[Any]], after: Any) -> Row:
    """A polynomial by Horner, row by row."""
    state = []
    for row in coefficients:
        total = row[-1]
        for each in reversed(row[:-1]):
            total = total * after + each
        state.append(total)
    return state


def rk4(rates: Rates, x: Row, h: Any, after: Any, number: Number) -> tuple[Row, Row]:
    """The classical method, and between its ends the cubic with their states and rates.

    E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, II.1, II.6.
    """
    half, two = number(Fraction(1, 2)), number(Fraction(2))
    zero = number(Fraction(0))
    middle = h * half
    k1 = rates(x, zero)
    k2 = rates([a + middle * k for a, k in zip(x, k1, strict=True)], middle)
    k3 = rates([a + middle * k for a, k in zip(x, k2, strict=True)], middle)
    k4 = rates([a + h * k for a, k in zip(x, k3, strict=True)], h)
    sums = [a + two * b + two * c + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
    end = [a + h * number(SIXTH) * each for a, each in zip(x, sums, strict=True)]
    return _draw_cubic(rates, (x, end), h, after, number), end


def _draw_cubic(rates: Rates, ends: tuple[Row, Row], h: Any, after: Any, number: Number) -> Row:
    """The cubic with the states and rates of both ends of a step, after a part of it."""
    one = number(Fraction(1))
    part, state = after / h, list[Any]()
    slopes = rates(ends[0], number(Fraction(0))), rates(ends[1], h)
    for a, b, first, final in zip(*ends, *slopes, strict=True):
        chord = minus(b, a)
        start = minus(h * first, chord)
        both = h * minus(final, first) + number(Fraction(2)) * start
        state.append(a + part * (chord + minus(one, part) * minus(start, part * both)))
    return state


def composed(
    maps: Sequence[tuple[Callable[[Row, Any], Row], Any]],
    rates: Rates,
    x: Row,
    h: Any,
    after: Any,
    number: Number,
) -> tuple[Row, Row]:
    """A sequence of maps, each for its part of the step; between its ends the cubic of `rk4`."""
    end = x
    for move, part in maps:
        end = move(end, h if part is None else h * part)
    return _draw_cubic(rates, (x, end), h, after, number), end


def heun(rates: Rates, x: Row, h: Any, after: Any, number: Number) -> tuple[Row, Row]:
    """Heun's method, and between its ends a straight line."""
    first = rates(x, number(Fraction(0)))
    later = rates([a + h * k for a, k in zip(x, first, strict=True)], h)
    half = h * number(Fraction(1, 2))
    end = [a + half * (b + c) for a, b, c in zip(x, first, later, strict=True)]
    return _draw_line(x, end, h, after), end


def midpoint(
    rates: Rates, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The implicit midpoint by so many sweeps, and between its ends a straight line."""
    middle = _find_middle(rates, x, h, number, sweeps)
    two = number(Fraction(2))
    end = [minus(two * m, a) for a, m in zip(x, middle, strict=True)]
    return _draw_line(x, end, h, after), end


def structured_midpoint(
    rates: Rates, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The same with the rates at the middle, and between its ends the cubic of `rk4`."""
    middle = _find_middle(rates, x, h, number, sweeps)
    rises = rates(middle, h * number(Fraction(1, 2)))
    end = [a + h * k for a, k in zip(x, rises, strict=True)]
    return _draw_cubic(rates, (x, end), h, after, number), end


def _find_middle(rates: Rates, x: Row, h: Any, number: Number, sweeps: int) -> Row:
    """The middle of an implicit step by so many sweeps, or until they change it no more."""
    half, middle = h * number(Fraction(1, 2)), list(x)
    for _ in range(sweeps):
        last, middle = middle, [a + half * k for a, k in zip(x, rates(middle, half), strict=True)]
        if last == middle:
            break
    return middle


def _draw_line(x: Row, end: Row, h: Any, after: Any) -> Row:
    """A straight line from one state to another, after a part of the step."""
    part = after / h
    return [a + part * minus(b, a) for a, b in zip(x, end, strict=True)]


#: What the text has for a sixth, which is no double.
SIXTH: Final = Fraction(float(Fraction(1, 6)))


def dop853(rates: Rates, x: Row, h: Any, after: Any, number: Number) -> tuple[Row, Row]:
    """The method of order 8 and its path of order 7, from the dense tables of SciPy.

    E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, II.5, II.6.
    """
    DOP853 = load_dop853()

    def weigh(weights: Any, ks: list[Row]) -> Row:
        chosen = [(number(Fraction(float(w))), k) for w, k in zip(weights, ks, strict=False) if w]
        sums = [number(Fraction(0))] * len(x)
        for weight, k in chosen:
            sums = [total + weight * each for total, each in zip(sums, k, strict=True)]
        return sums

    def moved(weights: Any, ks: list[Row]) -> Row:
        return [a + h * each for a, each in zip(x, weigh(weights, ks), strict=True)]

    def at(node: Any) -> Any:
        return number(Fraction(float(node))) * h

    ks = [rates(x, number(Fraction(0)))]
    for row, node in zip(DOP853.A[1:12], DOP853.C[1:12], strict=True):
        ks.append(rates(moved(row, ks), at(node)))
    end = moved(DOP853.B, ks)
    ks.append(rates(end, h))
    for row, node in zip(DOP853.A_EXTRA, DOP853.C_EXTRA, strict=True):
        ks.append(rates(moved(row, ks), at(node)))
    chords = [minus(b, a) for a, b in zip(x, end, strict=True)]
    two, one = number(Fraction(2)), number(Fraction(1))
    path = [
        chords,
        [minus(h * k, c) for k, c in zip(ks[0], chords, strict=True)],
        [minus(two * c, h * (a + b)) for c, a, b in zip(chords, ks[12], ks[0], strict=True)],
        *([h * each for each in weigh(row, ks)] for row in np.asarray(DOP853.D)),
    ]
    part = after / h
    total = [number(Fraction(0))] * len(x)
    for place in range(6, -1, -1):
        factor = minus(one, part) if place % 2 else part
        total = [(t + p) * factor for t, p in zip(total, path[place], strict=True)]
    return [a + t for a, t in zip(x, total, strict=True)], end
