"""Roots of functions along steps: pieces on which a function has a known form, and root finding.

Comes in: a function of the part of a step, 0 to 1, for many steps. Goes out: `Knots`, between which
the function is monotone, keeps its sign or has one root, so that no other root and no double root
lies unseen between two of them.

On each piece the function is interpolated at Chebyshev points, ``g = c_0 + c_1 T_1 + ... + c_N
T_N`` on [-1, 1]. There ``|T_k| <= 1``, ``|T_k'| <= k^2`` and ``|T_k''| <= k^2 (k^2 - 1) / 3``. So g
keeps its sign if ``|c_0|`` is more than the sum of the others, it is monotone if ``|c_1|`` is more
than the sum of ``k^2 |c_k|``, and it is convex or concave, with one turning point at the most, if
``4 |c_2|`` is more than the sum of the bounds of the other second derivatives. A piece for which
none of that can be said is halved. For a polynomial of degree N at most the interpolation is exact.
Otherwise its error is taken as twice the two last coefficients, and a piece is halved until that
error is known as well.
Read next: `coadjoint.solve.crossings`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Mask, Places

#: The value and the size of its terms, ``(..., R)``, at parts ``(..., R)`` of the steps ``(R,)``.
Function = Callable[["Places"], Callable[["Array"], tuple["Array", "Array"]]]
#: The least degree of an interpolation.
DEGREE: Final = 16
#: Halvings of a step at the most, at kinks and poles: a piece is then a 10^-13 of it.
DEPTH: Final = 43
#: Pieces of one step that are open at a time, at the most: a function that is noise has no end.
OPEN: Final = 256
#: Variation of a function that is rounding, relative to the size of its terms.
NOISE: Final = 64 * np.finfo(float).eps
#: The error of an interpolation up to which its sign is believed, relative to its first term.
RESOLVED: Final = 0.01
#: Steps that are looked at together.
TOGETHER: Final = 4096


@dataclass
class Knots:
    """Points of steps, in the order of steps and parts.

    Attributes:
        row: The step, ``(K,)``.
        part: The part of it that has passed.
        value: The function there; NaN where it is not finite.
        piece: A number for each piece: between two knots of one piece the function is monotone,
            keeps its sign, or has one root.
    """

    row: Places
    part: Array
    value: Array
    piece: Places


class _Pieces(NamedTuple):
    """Parts of steps."""

    row: Places
    left: Array
    width: Array


def find_knots(
    function: Function, count: int, degree: int, band_of: Callable[[Array], Array]
) -> tuple[Knots, Array]:
    """The knots of a function along steps.

    Args:
        function: The function.
        count: How many steps there are.
        degree: Of the polynomials of the state.
        band_of: What is as good as zero, by the largest size of the terms on a step.

    Returns:
        The knots, and what is as good as zero on each step, ``(count,)``.
    """
    lots, bands = [], [np.empty(0)]
    for first in range(0, count, TOGETHER):
        rows = np.arange(first, min(first + TOGETHER, count))
        pieces, band = _divide(function, rows, max(degree, DEGREE), band_of)
        lots += pieces
        bands.append(band)
    if not lots:
        lots = [Knots(np.empty(0, np.intp), np.empty(0), np.empty(0), np.empty(0, np.intp))]
    row, part, value = (
        np.concatenate([getattr(each, name) for each in lots]) for name in ("row", "part", "value")
    )
    starts = np.cumsum([0, *(int(each.piece.max(initial=-1)) + 1 for each in lots)])
    piece = np.concatenate([each.piece + s for each, s in zip(lots, starts, strict=False)])
    left = _left_of_pieces(part, piece)
    order = np.lexsort((part, left, row))
    return Knots(row[order], part[order], value[order], piece[order]), np.concatenate(bands)


def _left_of_pieces(part: Array, piece: Places) -> Array:
    """Where the piece of each knot begins, so that a knot that two share stands with each."""
    left = np.full(int(piece.max(initial=-1)) + 1, np.inf)
    np.minimum.at(left, piece, part)
    return left[piece]


def _divide(
    function: Function, rows: Places, degree: int, band_of: Callable[[Array], Array]
) -> tuple[list[Knots], Array]:
    """The knots of a few steps, piece by piece, and their bands."""
    nodes, matrix = _chebyshev(degree)
    first = int(rows[0])
    band = largest = np.empty(0)
    lots = []
    open_ = _Pieces(rows, np.zeros(len(rows)), np.ones(len(rows)))
    for depth in range(DEPTH + 1):
        if not open_.row.size:
            break
        row, left, width = open_
        values, sizes = function(row)(left + width * nodes[:, np.newaxis])
        if not depth:
            largest = np.fmax.reduce(sizes, axis=0, initial=0.0)
            band = band_of(largest)
        finite: Mask = np.asarray(np.isfinite(values).all(axis=0))
        with np.errstate(all="ignore"):
            forms = _Forms(_transform(values, matrix))
            known = np.asarray(forms.size <= band[row - first])
            known |= forms.variation <= NOISE * largest[row - first]
            known |= forms.is_clear(band[row - first]) | forms.is_monotone | forms.is_bent
        many = np.bincount(row - first)[row - first] > OPEN
        lost = ~np.isfinite(values).any(axis=0)
        done = (finite & known) | lost | many | (depth == DEPTH)
        chosen = _Pieces(row[done], left[done], width[done])
        bent = (finite & forms.is_bent & ~forms.is_monotone)[done]
        ends = np.where(finite, values[[0, -1]], np.nan)[:, done]
        beyond = np.abs(ends) > band[row - first][done]
        bent &= ~(beyond.all(axis=0) & (np.sign(ends[0]) == -np.sign(ends[1])))  # one root
        lots.append(_list_knots(function, chosen, ends, forms.coefficients[:, done], bent))
        open_ = _halve(_Pieces(row[~done], left[~done], width[~done]))
    return lots, band


def _halve(pieces: _Pieces) -> _Pieces:
    """Both halves of pieces."""
    half = pieces.width / 2
    return _Pieces(
        np.concatenate([pieces.row, pieces.row]),
        np.concatenate([pieces.left, pieces.left + half]),
        np.concatenate([half, half]),
    )


def _list_knots(
    function: Function, pieces: _Pieces, ends: Array, coefficients: Array, bent: Mask
) -> Knots:
    """Both ends of pieces, and the turning points of those that are bent."""
    row, left, width = pieces
    number = np.arange(len(row))
    turns = bent.copy()
    slopes = _end_slopes(coefficients)
    turns[bent] = slopes[0, bent] * slopes[1, bent] < 0
    place = np.flatnonzero(turns)
    inner, values = np.empty(0), np.empty(0)
    if place.size:
        own = coefficients[:, place]
        minus, plus = np.full(place.size, -1.0), np.ones(place.size)

        def slope(active: Places) -> Callable[[Array], Array]:
            return partial(_slope, own[:, active])

        found, _ = find_roots(slope, minus, plus, slopes[0, place], slopes[1, place], plus * 0.0)
        inner = left[place] + width[place] * ((found + 1.0) / 2.0)
        values = function(row[place])(inner)[0]
    return Knots(
        np.concatenate([row, row, row[place]]),
        np.concatenate([left, left + width, inner]),
        np.concatenate([ends[0], ends[1], values]),
        np.concatenate([number, number, place]),
    )


# -- interpolation --------------------------------------------------------------------------------
# Sums are written out, so that a step has the same bits among any number of others.


@cache
def _chebyshev(degree: int) -> tuple[Array, Array]:
    """The nodes on [0, 1], and the matrix from values there to coefficients."""
    k = np.arange(degree + 1)
    nodes = np.sin(np.pi * k / (2 * degree)) ** 2
    halves = np.where((k == 0) | (k == degree), 0.5, 1.0)
    # the cosine of k times the angle, which runs from pi to 0
    angles = np.cos(np.pi * ((k[:, np.newaxis] * (degree - k)) % (2 * degree)) / degree)
    return nodes, 2.0 / degree * angles * halves * halves[:, np.newaxis]


def _transform(values: Array, matrix: Array) -> Array:
    """Coefficients ``(N + 1, R)`` of values ``(N + 1, R)``."""
    total = np.zeros(values.shape)
    for value, column in zip(values, matrix.T, strict=True):
        total += column[:, np.newaxis] * value
    return total


class _Forms:
    """What coefficients say of pieces.

    Args:
        coefficients: ``(N + 1, R)``.
    """

    def __init__(self, coefficients: Array) -> None:
        self.coefficients = coefficients
        size = np.abs(coefficients)
        self._first = size[0]
        self._error = 2.0 * (size[-1] + size[-2])
        self.variation = _add(size, 1, lambda _: 1.0)
        self.size = size[0] + self.variation
        n = float(len(size) - 1)
        most = n * n
        self.is_monotone = size[1] > _add(size, 2, lambda k: k * k) + most * self._error
        bend = most * (most - 1.0) / 3.0
        rest = _add(size, 3, lambda k: k * k * (k * k - 1.0) / 3.0)
        self.is_bent = 4.0 * size[2] > rest + bend * self._error

    def is_clear(self, band: Array) -> Mask:
        """Whether a function stays away from zero by more than a band."""
        resolved = self._error <= RESOLVED * self._first
        return np.asarray(resolved & (self._first > self.variation + self._error + band))


def _add(size: Array, first: int, weight: Callable[[float], float]) -> Array:
    """A weighted sum of rows."""
    total = np.zeros(size.shape[1])
    for k in range(first, len(size)):
        total += weight(float(k)) * size[k]
    return total


def _end_slopes(coefficients: Array) -> Array:
    """The derivative at -1 and at 1."""
    left, right = np.zeros((2, coefficients.shape[1]))
    for k in range(1, len(coefficients)):
        right += float(k * k) * coefficients[k]
        left += (1.0 if k % 2 else -1.0) * float(k * k) * coefficients[k]
    return np.stack([left, right])


def _slope(coefficients: Array, x: Array) -> Array:
    """The derivative, the sum of ``k c_k U_{k-1}``."""
    total, before, here = np.zeros(x.shape), np.zeros(x.shape), np.ones(x.shape)
    for k in range(1, len(coefficients)):
        total += float(k) * coefficients[k] * here
        before, here = here, 2.0 * x * here - before
    return total


# -- root finding ---------------------------------------------------------------------------------


def find_roots(
    function: Callable[[Places], Callable[[Array], Array]],
    left: Array,
    right: Array,
    at_left: Array,
    at_right: Array,
    close: Array,
) -> tuple[Array, Array]:
    """The roots of functions in intervals at whose ends they have other signs, or are zero.

    By the method of T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145: inverse
    quadratic interpolation where that is safe, else bisection. The first place is that of a line.

    Args:
        function: Some of the functions, by number, each of a place.
        left: Where the intervals begin, ``(R,)``.
        right: Where they end.
        at_left: The values there.
        at_right: Likewise.
        close: How close the place has to be, at the least to the last digits.

    Returns:
        The roots, and the values there.
    """
    nearer = np.abs(at_left) < np.abs(at_right)
    root, value = np.where(nearer, left, right), np.where(nearer, at_left, at_right)
    active = np.flatnonzero((at_left != 0) & (at_right != 0) & np.isfinite(at_left * at_right))
    # the best interval ends at a and b, and c was an end before
    a, b, fa, fb, near = (each[active] for each in (right, left, at_right, at_left, close))
    evaluate, going = function(active), np.ones(a.shape, bool)
    with np.errstate(all="ignore"):
        t = np.minimum(np.maximum(fa / (fa - fb), 2.0**-10), 1.0 - 2.0**-10)
        while active.size:
            x = a + t * (b - a)
            fx = evaluate(x)
            same = (fx > 0) == (fa > 0)
            c, fc = np.where(same, a, b), np.where(same, fa, fb)
            b, fb = np.where(same, b, a), np.where(same, fb, fa)
            a, fa = x, fx
            nearer = np.abs(fx) < np.abs(fb)
            found, there = np.where(nearer, x, b), np.where(nearer, fx, fb)
            root[active[going]], value[active[going]] = found[going], there[going]
            digits = 4.0 * np.finfo(float).eps * np.maximum(np.abs(found), 2.0**-40)
            limit = np.maximum(digits, near) / np.abs(b - a)
            t = _next_part((a, b, c), (fa, fb, fc), limit)
            going &= (limit < 0.5) & (fx != 0) & np.isfinite(fx)
            if 2 * int(going.sum()) < going.size:  # those that are found cost no more
                a, b, fa, fb, near, t = (each[going] for each in (a, b, fa, fb, near, t))
                active, going = active[going], going[going]
                evaluate = function(active)
    return root, value


def _next_part(
    places: tuple[Array, Array, Array], values: tuple[Array, Array, Array], limit: Array
) -> Array:
    """The part of each interval at which the next value is taken."""
    (a, b, c), (fa, fb, fc) = places, values
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    safe = (phi * phi < xi) & ((1.0 - phi) * (1.0 - phi) < 1.0 - xi)
    guess = fa / (fb - fa) * (fc / (fb - fc))
    guess = guess + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
    part = np.where(safe & np.isfinite(guess), guess, 0.5)
    return np.minimum(np.maximum(part, limit), 1.0 - limit)
