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
from decimal import Decimal
from fractions import Fraction
from itertools import combinations, permutations
from typing import Any, Final

import numpy as np

from coadjoint.crosscheck.solver_motion import Motion
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


def gauss4(
    rates: Rates, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The method of Gauss with two stages by so many sweeps; between its ends as `rk4`.

    E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, II.7: nodes
    ``1/2 -+ sqrt(3)/6`` and shares ``a_ij/b_j = 1/2, 1/2 -+ sqrt(3)/3``, as doubles.
    """
    part, root = h * number(Fraction(1, 2)), 3.0**0.5
    shares = [[0.5, 0.5 - root / 3], [0.5 + root / 3, 0.5]]
    times = [number(Fraction(0.5 + sign * root / 6)) * h for sign in (-1.0, 1.0)]
    stages = [list(x), list(x)]
    for _ in range(sweeps):
        rises = [[part * k for k in rates(y, t)] for y, t in zip(stages, times, strict=True)]
        last, stages = (
            stages,
            [
                [
                    a + number(Fraction(own[0])) * one + number(Fraction(own[1])) * other
                    for a, one, other in zip(x, *rises, strict=True)
                ]
                for own in shares
            ],
        )
        if all(map(_has_settled, last, stages)):
            break
    rises = [[part * k for k in rates(y, t)] for y, t in zip(stages, times, strict=True)]
    end = [a + (one + other) for a, one, other in zip(x, *rises, strict=True)]
    return _draw_cubic(rates, (x, end), h, after, number), end


def coadjoint_mean(
    motion: Motion, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The coadjoint mean by so many sweeps, its series summed as it stands; a line with noise.

    ``exp(h A) x`` with ``A`` that of the gradient at ``phi(h A) x``, ``phi(z) = (exp(z) - 1)/z``:
    N. Bou-Rabee and J. E. Marsden, Foundations of Computational Mathematics 9 (2009) 197.
    """
    half, middle, end = h * number(Fraction(1, 2)), list(x), list(x)
    for _ in range(sweeps):
        xi, last = motion.find_gradient(middle, half), middle
        term, mean, end = list(x), list(x), list(x)
        for k in range(1, min(sweeps, MEAN_TERMS) + 1):
            turned = motion.turn(term, xi, last, half)
            share = h * number(Fraction(1, k))
            term = [share * each for each in turned]  # (h A)^k x / k!
            end = [a + each for a, each in zip(end, term, strict=True)]
            share = number(Fraction(1, k + 1))
            mean = [a + share * each for a, each in zip(mean, term, strict=True)]
        middle = mean
        if _has_settled(last, middle):
            break
    if motion.is_noisy:
        return _draw_line(x, end, h, after), end
    return _draw_cubic(motion, (x, end), h, after, number), end


def discrete_gradient(
    motion: Motion, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The discrete gradient by so many sweeps: its mean along the chord, corrected along it.

    ``y - x = h (J(m) g + f(m))`` with ``g = mean + c (y - x)`` and ``g.(y - x) = H(y) - H(x)``.
    """

    def find_rates(middle: Row, slopes: Row, added: Row) -> Row:
        half = h * number(Fraction(1, 2))
        turned = motion.turn(middle, added, middle, half)
        return [a + b for a, b in zip(motion(middle, half), turned, strict=True)]

    return _follow_gradients(motion, ("energy",), find_rates, x, h, after, number, sweeps)


def nambu_gradient(
    motion: Motion, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """Nambu's product of discrete gradients of the energy and of the distinguished functions.

    ``x_i' = -e_ijk.. g_j c_k ..``, a sum over the permutations of all places; it is ``c x g`` of
    three coordinates. R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions
    A 357 (1999) 1021.
    """

    def find_rates(middle: Row, slopes: Row, added: Row) -> Row:
        n = len(middle)
        gradients = [a + b for a, b in zip(slopes, added, strict=True)]
        rates = [number(Fraction(0))] * n
        for i, *others in permutations(range(n)):
            swaps = sum(a > b for a, b in combinations((i, *others), 2))
            term = number(Fraction(-1 if swaps % 2 == 0 else 1))
            for row, column in enumerate(others):
                term = term * gradients[row * n + column]
            rates[i] = rates[i] + term
        return rates

    functions = ("energy", "distinguished")
    return _follow_gradients(motion, functions, find_rates, x, h, after, number, sweeps)


def metriplectic_gradient(
    motion: Motion, x: Row, h: Any, after: Any, number: Number, sweeps: int
) -> tuple[Row, Row]:
    """The bracket with the energy and G with the entropy, each projected along the other gradient.

    ``y - x = h (R P(m) R g + Q G(m) Q s)`` with discrete gradients g and s,
    ``Q = 1 - g g^T/(g.g)`` and ``R = 1 - s s^T/(s.s)``.
    """

    def project(vector: Row, along: Row) -> Row:
        product = square = number(Fraction(0))
        for one, other in zip(vector, along, strict=True):
            product, square = product + one * other, square + other * other
        part = product / square
        return [minus(one, part * other) for one, other in zip(vector, along, strict=True)]

    def find_rates(middle: Row, slopes: Row, added: Row) -> Row:
        half = h * number(Fraction(1, 2))
        gradients = [a + b for a, b in zip(slopes, added, strict=True)]
        g, s = gradients[: len(middle)], gradients[len(middle) :]
        moved = project(motion.turn(middle, project(g, s), middle, half), s)
        relaxed = project(motion.relax(middle, project(s, g), half), g)
        return [a + b for a, b in zip(moved, relaxed, strict=True)]

    functions = ("energy", "entropy")
    return _follow_gradients(motion, functions, find_rates, x, h, after, number, sweeps)


def _follow_gradients(
    motion: Motion,
    functions: Sequence[str],
    find_rates: Callable[[Row, Row, Row], Row],
    x: Row,
    h: Any,
    after: Any,
    number: Number,
    sweeps: int,
) -> tuple[Row, Row]:
    """A step by discrete gradients of functions, by so many sweeps; between its ends as `rk4`.

    Rates follow from the middle, the gradients there, and what discrete ones have in addition.
    """
    half = h * number(Fraction(1, 2))
    first = motion.find_values(functions, x, half)
    rise = [h * k for k in motion(x, half)]
    for _ in range(sweeps):
        chord, last = rise, rise
        middle = [a + each * number(Fraction(1, 2)) for a, each in zip(x, chord, strict=True)]
        slopes = motion.find_gradients(functions, middle, half)
        excess = [number(Fraction(0))] * len(slopes)
        for node, weight in NODES:
            for part in (node, 1.0 - node):
                at = [a + number(Fraction(part)) * b for a, b in zip(x, chord, strict=True)]
                other = motion.find_gradients(functions, at, half)
                excess = [
                    total + number(Fraction(weight)) * minus(a, b)
                    for total, a, b in zip(excess, other, slopes, strict=True)
                ]
        given = [each.settled() for each in chord]  # the number c moves with it in a higher order
        end = [a + each for a, each in zip(x, given, strict=True)]
        ends = zip(first, motion.find_values(functions, end, half), strict=True)
        added = Row()
        for place, (before, behind) in enumerate(ends):
            own = slice(place * len(x), (place + 1) * len(x))
            factor = _find_factor(slopes[own], excess[own], given, minus(behind, before), number)
            added += [a + factor * step for a, step in zip(excess[own], chord, strict=True)]
        rise = [h * each for each in find_rates(middle, slopes, added)]
        if _has_settled(last, rise):
            break
    end = [a + each for a, each in zip(x, rise, strict=True)]
    return _draw_cubic(motion, (x, end), h, after, number), end


def _find_factor(slope: Row, excess: Row, chord: Row, change: Any, number: Number) -> Any:
    """c, by which the chord is multiplied for what gradients along it miss of a change.

    Gradients are means by Gauss's formula of five nodes (Abramowitz and Stegun, table 25.4).
    """
    missing, square = change, number(Fraction(0))
    for a, b, step in zip(slope, excess, chord, strict=True):
        missing = minus(missing, (a.settled() + b.settled()) * step)
        square = square + step * step
    return missing / square


def _has_settled(last: Row, following: Row) -> bool:
    """Whether a sweep changed next to nothing; never where values are counts."""
    pairs = [
        (a.value, b.value) for a, b in zip(last, following, strict=True) if hasattr(a, "value")
    ]
    top = max((abs(b) for _, b in pairs), default=0)
    return bool(pairs) and all(abs(a - b) <= top * SETTLED for a, b in pairs)


#: The part of the largest component by which the last sweep of an exact step may change it.
SETTLED: Final = Decimal("1e-32")
#: Terms of the series of a coadjoint action.
MEAN_TERMS: Final = 30
#: Gauss's formula with five nodes on (0, 1): nodes below 1/2, and their weights.
NODES: Final = (
    (0.5 - 0.906179845938663992798 / 2, 0.236926885056189087514 / 2),
    (0.5 - 0.538469310105683091036 / 2, 0.478628670499366468041 / 2),
)


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
