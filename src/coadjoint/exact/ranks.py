"""Ranks of matrices of functions: never above the true rank at almost every point.

Comes in: sparse rows of elements, or square matrices. Goes out: a rank, which is a certain bound
from below; for square matrices a rational point of the domain at which every pivot excludes zero.

Rational entries are taken at a random point modulo a prime. Where no denominator is zero there,
this is a homomorphism of rings: a minor with a nonzero value is a nonzero function. Entries with
elementary functions are taken at a real point where they are defined, with bounds of all values
(`coadjoint.exact.witness`): a minor whose bounds exclude zero is not zero there, hence at almost
every point of the connected set around it on which the entries are analytic.

From above nothing is certain. Rational minors of degree d that are not zero vanish at a random
point with a probability below d/p, about 1e-15, and not at both of two points with two primes;
values of functions bound no such probability. A caller that needs the rank itself bounds it from
above by other means, as Casimirs do for a bracket, or says how likely it is wrong
(`error_of_ranks`). Points and primes are the same in every run.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import islice

import mpmath

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.linear import SpanModulo, primes, rank_modulo
from coadjoint.exact.witness import TRIES as REAL_POINTS
from coadjoint.exact.witness import (
    UNDEFINED,
    Enclosure,
    Point,
    enclosure,
    enclosures,
    points_inside,
)

#: A square matrix of elements.
Matrix = Sequence[Sequence[Element]]
#: Points at which a rank is taken; the largest counts.
POINTS = 2
#: Points without a pole are searched for that often, each modulo another prime.
TRIES = 50
#: How ranks are known, in words.
MODULO = "at random points modulo a prime"
ENCLOSED = "at a real point, with bounds that exclude zero"
#: How likely it is that a rank is larger than the one found, in words.
CHANCE = "the ranks are certain from below; each is too small with a probability below 1e-12"
NO_CHANCE = (
    "the ranks are certain from below; that none is larger rests on computed values, and no "
    "bound on the probability of an error is known"
)
#: Characters of an entry that a message shows.
SHOWN = 60


def generic_rank(field: Field, rows: Sequence[Mapping[int, Element]]) -> int:
    """The rank of a sparse matrix at random points: never above that at almost every point.

    Raises:
        AlgebraError: No real point was found at which all entries are defined.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> generic_rank(field, [{0: x, 1: y}, {0: x * y, 1: y**2}])
    1
    """
    largest, most = 0, _most(rows)
    if not most:
        return 0
    exact = is_exact(field, _entries(rows))
    modular = (rank_modulo(numbers, prime) for prime, numbers in _sample(field, rows))
    ranks = modular if exact else map(len, _enclose(field, rows))
    for rank in islice(ranks, POINTS):
        largest = max(largest, rank)
        if largest == most:
            break
    return largest


def source_of_ranks(field: Field, *ranks: tuple[Sequence[Mapping[int, Element]], int]) -> str:
    """How the ranks of some matrices are known from below: `MODULO` or `ENCLOSED`.

    >>> field = Field(["x"], slots=2)
    >>> source_of_ranks(field, ([{0: field.call("cos", field["x"])}], 1))
    'at a real point, with bounds that exclude zero'
    """
    exact = all(is_exact(field, _entries(rows)) for rows, _ in ranks)
    return MODULO if exact else ENCLOSED


def error_of_ranks(field: Field, *matrices: Sequence[Mapping[int, Element]]) -> str:
    """How likely it is that the rank of one of some matrices is larger than found, in words."""
    return CHANCE if all(is_exact(field, _entries(rows)) for rows in matrices) else NO_CHANCE


def independent_rows(field: Field, rows: Sequence[Mapping[int, Element]]) -> list[int]:
    """Places of the rows that do not depend on those before them, at almost every point.

    That these rows are independent is certain, that the others depend on them is not.

    Raises:
        AlgebraError: No real point was found at which all entries are defined.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> independent_rows(field, [{0: x}, {0: x * y}, {0: x, 1: y}])
    [0, 2]
    """
    if not _most(rows):
        return []
    if not is_exact(field, _entries(rows)):
        return max(islice(_enclose(field, rows), POINTS), key=len)
    spans = ((SpanModulo(prime), numbers) for prime, numbers in _sample(field, rows))
    chosen = (span.add_independent(numbers) for span, numbers in islice(spans, POINTS))
    return max(chosen, key=len)


def is_exact(field: Field, elements: Iterable[Element]) -> bool:
    """Whether no elementary function occurs, so that ranks modulo a prime make sense.

    A square root modulo a prime has no sign: that of x^2 may be -x there, which it is nowhere for
    positive x.
    """
    return not field.adjoined or all(map(field.is_function_free, elements))


def _entries(rows: Sequence[Mapping[int, Element]]) -> Iterator[Element]:
    return (entry for row in rows for entry in row.values())


def _most(rows: Sequence[Mapping[int, Element]]) -> int:
    """The largest rank that the places of nonzero entries allow."""
    columns = {place for row in rows for place, entry in row.items() if entry}
    return min(sum(any(row.values()) for row in rows), len(columns))


# -- modulo primes --------------------------------------------------------------------------------


def _sample(
    field: Field, rows: Sequence[Mapping[int, Element]]
) -> Iterator[tuple[int, list[dict[int, int]]]]:
    """The matrix at random points, each modulo a prime of its own; poles are passed over.

    A factor or a denominator that is one of the primes can mislead at one point only.
    """
    source = random.Random(1)  # noqa: S311 (not for secrets)
    for prime in islice(primes(), TRIES):
        point = {name: source.randrange(1, prime) for name in field.names}
        with suppress(ZeroDivisionError):
            yield prime, _take_modulo(field, rows, point, prime)


def _take_modulo(
    field: Field, rows: Sequence[Mapping[int, Element]], point: Mapping[str, int], prime: int
) -> list[dict[int, int]]:
    """The matrix at a point."""
    known = dict[int, int]()
    return [
        {j: field.evaluate_modulo(e, point, prime, known) for j, e in row.items()} for row in rows
    ]


# -- at real points -------------------------------------------------------------------------------


def _enclose(field: Field, rows: Sequence[Mapping[int, Element]]) -> Iterator[list[int]]:
    """Places of rows that are certainly independent, at several real points.

    Raises:
        AlgebraError: No real point was found.
    """
    result = False
    for point in points_inside(field, list(_entries(rows))):
        with suppress(*UNDEFINED):
            values = [{j: enclosure(field, e, point) for j, e in row.items()} for row in rows]
            result = True
            yield certain_rows(values)
    if not result:
        entry = next(e for e in _entries(rows) if not field.is_function_free(e))
        text = element_text(field, entry)
        shown = text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
        raise AlgebraError(
            f"no point was found where {shown} and the other entries are real; expected formulas "
            "that are defined together somewhere. State in [domain] where they are.",
            found=text,
        )


#: Chooses the pivot of a row by its place; None where no entry is certainly not zero.
Choice = Callable[[int, Mapping[int, Enclosure]], int | None]


def on_diagonal(place: int, row: Mapping[int, Enclosure]) -> int | None:
    """The diagonal entry as a pivot, so that leading minors are looked at."""
    return place if place in row and row[place].sign else None


def largest_pivot(place: int, row: Mapping[int, Enclosure]) -> int | None:
    """The place of the entry that is farthest from zero."""
    certain = {column: abs(value.bounds.mid) for column, value in row.items() if value.sign}
    return max(certain, key=lambda column: mpmath.mpf(certain[column].a), default=None)


def certain_rows(
    rows: Sequence[Mapping[int, Enclosure]], choose: Choice = largest_pivot
) -> list[int]:
    """Places of rows that are independent of those before, by bounds that exclude zero.

    This eliminates exact numbers of which only bounds are known: a pivot is certainly
    not zero, so that every row that has one raises the rank.
    """
    pivots: list[tuple[int, dict[int, Enclosure]]] = []
    places, minus = [], Enclosure.of(-1)
    for place, row in enumerate(rows):
        rest = dict(row)
        for column, pivot in pivots:
            if column in rest:
                factor = rest.pop(column) / pivot[column]
                for other, value in pivot.items():
                    if other != column:
                        change = minus * factor * value
                        rest[other] = rest[other] + change if other in rest else change
        chosen = choose(place, rest)
        if chosen is not None:
            pivots.append((chosen, rest))
            places.append(place)
    return places


# -- regular matrices ---------------------------------------------------------------------------


def witness_regular(field: Field, *matrices: Matrix) -> Point | None:
    """A point of the domain at which the determinants of matrices are certainly not zero.

    Returns:
        Values of the symbols in the matrices; None where no point was found, which proves nothing.

    >>> field = Field(["x"], slots=1)
    >>> exp = field.call("exp", field["x"])
    >>> witness_regular(field, [[exp, field.one], [exp**2, exp]])
    >>> witness_regular(field, [[exp, field.one], [field.one, exp]])
    {'x': Fraction(-3, 5)}
    """
    for point, result in _values(field, matrices):
        if all(len(certain_rows(rows)) == len(rows) for rows in result):
            return point
    return None


def certain_minors(field: Field, matrix: Matrix) -> int:
    """How many leading minors of a square matrix, one after the other, are not identically zero.

    >>> field = Field(["x"])
    >>> certain_minors(field, [[field["x"], field.one], [field.one, field.zero]])
    2
    >>> certain_minors(field, [[field.zero, field.one], [field.one, field["x"]]])
    0
    """
    most = 0
    for _, (rows,) in _values(field, [matrix]):
        pivots = certain_rows(rows, on_diagonal)
        count = next((n for n, place in enumerate(pivots) if n != place), len(pivots))
        most = max(most, count)
        if most == len(matrix):
            break
    return most


def _values(
    field: Field, matrices: Sequence[Matrix]
) -> Iterator[tuple[Point, list[list[dict[int, Enclosure]]]]]:
    """Points of the domain with bounds of the entries of matrices."""
    entries = [entry for matrix in matrices for row in matrix for entry in row]
    names = frozenset[str]().union(*map(field.reach, entries))
    for point in islice(points_inside(field, entries), REAL_POINTS):
        with suppress(*UNDEFINED):
            values = iter(enclosures(field, entries, point))
            shown = {name: value for name, value in point.items() if name in names}
            yield (
                shown,
                [[{j: next(values) for j in range(len(row))} for row in m] for m in matrices],
            )
