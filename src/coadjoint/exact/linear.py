"""Exact linear algebra for sparse vectors: coordinates in a span, null spaces, ranks.

Comes in: vectors as dictionaries of their nonzero entries. Goes out: coordinates, bases, ranks, all
exact. `Span` works with any exact values (integers, fractions, elements of a function field);
`nullspace` is for large systems over the rationals. SciPy has no exact solver, SymPy
must stay out of everything that the spec reader imports.
Read next: `coadjoint.algebra.invariants`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from fractions import Fraction
from heapq import heappop, heappush
from math import gcd, isqrt, lcm
from typing import Any, TypeVar

from coadjoint.errors import AlgebraError, LimitError

#: Exponents e of prime numbers 2^e - 1.
_MERSENNE = (61, 127, 521, 1279, 4423)
#: The first prime that random ranks are taken by.
PRIME = 2**61 - 1

Row = dict[int, int]
Place = TypeVar("Place")


def exact(value: Any) -> Any:
    """The value with integral fractions as `int`, which is ten times as fast.

    Raises:
        AlgebraError: A float, which is not exact.
    """
    if isinstance(value, Fraction):
        return value.numerator if value.denominator == 1 else value
    if isinstance(value, float):
        raise AlgebraError(
            f"{value!r} is a floating-point number; expected an exact one. "
            "Write an integer or a Fraction.",
            found=value,
        )
    return value


def quotient(a: Any, b: Any) -> Any:
    """``a / b`` without rounding, for integers too."""
    return exact((Fraction(a) if isinstance(a, int) else a) / b)


def add_multiple(total: dict[Any, Any], factor: Any, vector: Mapping[Any, Any]) -> None:
    """``total += factor * vector`` in place, zeros left out."""
    for place, value in vector.items():
        new = exact(total.get(place, 0) + factor * value)
        if new == 0:
            total.pop(place, None)
        else:
            total[place] = new


class Span:
    """The span of sparse vectors, in which coordinates of any number of targets are looked up.

    Args:
        vectors: ``{place: value}`` each; places may be anything that sorts, such as (row, column).

    Attributes:
        dependent: Numbers of the vectors that lie in the span of those before them.

    >>> plane = Span([{"x": 1, "y": 2}, {"y": 4}])
    >>> plane.coordinates({"x": 3, "y": 4}), plane.coordinates({"z": 1})
    ({0: 3, 1: Fraction(-1, 2)}, None)
    """

    def __init__(self, vectors: Iterable[Mapping[Any, Any]] = ()) -> None:
        # Reduced row echelon form: pivot -> (vector, the combination of given vectors that it is).
        self._rows: dict[Hashable, tuple[dict[Any, Any], dict[int, Any]]] = {}
        self._count = 0
        self.dependent: list[int] = []
        for vector in vectors:
            self.add(vector)

    @property
    def rank(self) -> int:
        """Dimension of the span."""
        return len(self._rows)

    @property
    def rows(self) -> list[dict[Any, Any]]:
        """The reduced row echelon basis, sorted by pivots."""
        return [self._rows[pivot][0] for pivot in sorted(self._rows)]  # type: ignore[type-var]

    def add(self, vector: Mapping[Any, Any]) -> bool:
        """Take in one more vector; False if it lay in the span already."""
        number, self._count = self._count, self._count + 1
        rest, combination = self._reduce(vector)
        if not rest:
            self.dependent.append(number)
            return False
        combination = {k: -value for k, value in combination.items()} | {number: 1}
        pivot = min(rest)
        scale = rest[pivot]
        new = {place: quotient(value, scale) for place, value in rest.items()}
        combined = {k: quotient(value, scale) for k, value in combination.items()}
        for row, known in self._rows.values():
            factor = row.get(pivot)
            if factor is not None:
                add_multiple(row, -factor, new)
                add_multiple(known, -factor, combined)
        self._rows[pivot] = new, combined
        return True

    def coordinates(self, target: Mapping[Any, Any]) -> dict[int, Any] | None:
        """Nonzero coefficients of the vectors given, by their numbers; None outside the span."""
        rest, combination = self._reduce(target)
        return None if rest else dict(sorted(combination.items()))

    def _reduce(self, vector: Mapping[Any, Any]) -> tuple[dict[Any, Any], dict[int, Any]]:
        """What is left of a vector, and the combination that was taken away."""
        rest = {place: exact(value) for place, value in vector.items() if value != 0}
        combination: dict[int, Any] = {}
        # A reduced row has no pivot but its own, so one pass over the entries is enough.
        for pivot in [place for place in rest if place in self._rows]:
            factor = rest[pivot]
            row, combined = self._rows[pivot]
            add_multiple(rest, -factor, row)
            add_multiple(combination, factor, combined)
        return rest, combination


# -- large systems over the rationals -------------------------------------------------------------


def nullspace(
    rows: Iterable[Mapping[int, Fraction | int]], unknowns: int
) -> list[dict[int, Fraction]]:
    """All x with ``sum_j row[j] x[j] = 0``: the reduced row echelon basis, which is unique.

    The elimination is done modulo a prime, where numbers stay small; the basis is then written over
    the rationals and multiplied by every row. This proves it: modulo a prime a rank can only fall,
    so the true null space is no larger than the one found, and what is found lies in it. Should the
    proof fail, a larger prime is taken.

    Args:
        rows: Equations, sparse; entries integers or fractions.
        unknowns: How many unknowns there are; those in no equation are free.

    Raises:
        LimitError: The solution has numbers of more than 2000 bits.

    >>> nullspace([{0: 1, 1: -2}, {1: 1, 2: Fraction(1, 3)}], 3)
    [{0: Fraction(1, 1), 1: Fraction(1, 2), 2: Fraction(-3, 2)}]
    """
    equations = _integral(rows)
    for exponent in _MERSENNE:
        prime = 2**exponent - 1
        residues = nullspace_modulo(equations, unknowns, prime)
        basis = [rational_vector(row, prime) for row in residues]
        result = [vector for vector in basis if vector is not None]
        if len(result) == len(basis) and _solves(equations, result):
            return result
    raise LimitError(
        f"the null space of {len(equations)} equations has numbers of more than 2000 bits; "
        "expected coefficients that fit. Scale the equations.",
        found=len(equations),
    )


def primes() -> Iterator[int]:
    """Endless primes that are 3 modulo 4, `PRIME` first: an input may hold any one of them.

    >>> from itertools import islice
    >>> [2**61 - prime for prime in islice(primes(), 3)]
    [1, 45, 229]
    """
    from sympy import isprime  # reading a spec does not load SymPy

    yield from filter(isprime, range(PRIME, 0, -4))


def rank_modulo(rows: Iterable[Mapping[int, Fraction | int]], prime: int = PRIME) -> int:
    """The rank modulo a prime: never above the rank over the rationals, nearly always equal.

    Rows are made integral first, so that minors over the rationals are integers, up to a factor
    for each row, and those that are zero stay so modulo the prime.
    """
    return SpanModulo(prime, _integral(rows)).rank


def whole_numbers(vector: Mapping[Place, Fraction | int]) -> dict[Place, int]:
    """The positive multiple of a nonzero rational vector with whole numbers of no common factor.

    >>> whole_numbers({"x": Fraction(1, 2), "y": Fraction(-2, 3)})
    {'x': 3, 'y': -4}
    """
    common = lcm(*(value.denominator for value in vector.values()))
    whole = {place: int(value * common) for place, value in vector.items()}
    shared = gcd(*whole.values())
    return {place: value // shared for place, value in whole.items()}


def _integral(rows: Iterable[Mapping[int, Fraction | int]]) -> list[Row]:
    """Distinct rows in integers without common factor, the short ones first."""
    distinct: dict[tuple[tuple[int, int], ...], None] = {}
    for row in rows:
        entries = dict(sorted((column, value) for column, value in row.items() if value))
        if entries:
            sign = 1 if next(iter(entries.values())) > 0 else -1
            whole = whole_numbers(entries)
            distinct[tuple((column, sign * value) for column, value in whole.items())] = None
    return [dict(row) for row in sorted(distinct, key=len)]


class SpanModulo:
    """The span of sparse rows modulo a prime, to which rows are added one by one.

    Args:
        prime: The prime.
        rows: Rows to begin with.
        choose: Which column of a row becomes its pivot; by default the first.

    Attributes:
        pivots: The rows by their pivots, pivot entries 1; a row has none of the pivots before it.

    >>> plane = SpanModulo(7)
    >>> plane.add_independent([{0: 1, 1: 2}, {0: 2, 1: 4}, {0: 1}])
    [0, 2]
    """

    def __init__(
        self,
        prime: int = PRIME,
        rows: Iterable[Mapping[int, int]] = (),
        choose: Callable[[Iterable[int]], int] = min,
    ) -> None:
        self.prime, self._choose = prime, choose
        self.pivots: dict[int, Row] = {}
        self._order: list[int] = []
        self._age: dict[int, int] = {}
        self.add_independent(rows)

    @property
    def rank(self) -> int:
        """Dimension of the span."""
        return len(self.pivots)

    def add_independent(self, rows: Iterable[Mapping[int, int]]) -> list[int]:
        """Places of the rows that do not depend on those before them; each of these is added."""
        return [place for place, row in enumerate(rows) if self.add(row)]

    def add(self, row: Mapping[int, int]) -> bool:
        """Add one more row; False, and nothing changes, if it lies in the span already."""
        age, prime = self._age, self.prime
        rest = {column: value % prime for column, value in row.items()}
        # Old rows have pivots that came later, never the other way round: with the oldest first,
        # nothing that was cleared comes back (the rank of so(20) took 12 times as long).
        waiting = sorted(age[column] for column in rest if column in age)
        while waiting:
            filled = _clear(rest, self._order[heappop(waiting)], self.pivots, prime)
            for column in filled:
                if column in age:
                    heappush(waiting, age[column])
        rest = {column: value for column, value in rest.items() if value}
        if not rest:
            return False
        pivot = self._choose(rest)
        inverse = pow(rest[pivot], -1, prime)
        self.pivots[pivot] = {column: value * inverse % prime for column, value in rest.items()}
        age[pivot] = len(self._order)
        self._order.append(pivot)
        return True

    def reduce(self) -> dict[int, Row]:
        """The rows, each with no pivot but its own: the last one has none, so go backwards."""
        done: dict[int, Row] = {}
        for pivot, row in reversed(self.pivots.items()):
            done[pivot] = dict(row)
            for column in [c for c in row if c in done and c != pivot]:
                _clear(done[pivot], column, done, self.prime)
        return done


def _clear(row: Row, column: int, pivots: Mapping[int, Row], prime: int) -> list[int]:
    """Clear a column that is a pivot of another row; the columns that have become nonzero."""
    factor = row.pop(column, 0)
    filled: list[int] = []
    if not factor:
        return filled
    for other, value in pivots[column].items():
        if other == column:
            continue
        if other not in row:
            filled.append(other)
        new = (row.get(other, 0) - factor * value) % prime
        if new:
            row[other] = new
        else:
            row.pop(other, None)
    return filled


def echelon_modulo(rows: Iterable[Row], prime: int = PRIME) -> dict[int, Row]:
    """The reduced rows modulo a prime by their pivots, each the first column of its row.

    >>> echelon_modulo([{0: 1, 1: 2}, {0: 2, 1: 4, 2: 3}], 7)
    {2: {2: 1}, 0: {0: 1, 1: 2}}
    """
    return SpanModulo(prime, rows).reduce()


def nullspace_modulo(equations: list[Row], unknowns: int, prime: int = PRIME) -> list[Row]:
    """The reduced row echelon basis of the null space modulo a prime, sorted by pivots."""
    # A pivot in a column that few rows have keeps the others sparse.
    frequency = Counter(column for row in equations for column in row)
    solved = SpanModulo(
        prime, equations, lambda columns: min(columns, key=lambda c: (frequency[c], c))
    ).reduce()
    vectors: dict[int, Row] = {free: {free: 1} for free in range(unknowns) if free not in solved}
    for pivot, row in solved.items():
        for column, value in row.items():
            if column != pivot:
                vectors[column][pivot] = -value % prime
    basis = echelon_modulo(vectors.values(), prime)
    return [basis[pivot] for pivot in sorted(basis)]


def rational_vector(row: Row, prime: int = PRIME) -> dict[int, Fraction] | None:
    """The rational vector that a row modulo a prime is the image of, if it is small enough."""
    result = {}
    bound = isqrt(prime // 2)
    for column, value in sorted(row.items()):
        # The half extended Euclidean algorithm (Wang 1981): u = v * value modulo the prime.
        u, last, v, before = value, prime, 1, 0
        while u > bound:
            step = last // u
            u, last, v, before = last - step * u, u, before - step * v, v
        if v == 0 or abs(v) > bound:
            return None
        result[column] = Fraction(u, v)
    return result


def _solves(equations: list[Row], vectors: list[dict[int, Fraction]]) -> bool:
    """Whether every vector satisfies every equation, in exact arithmetic."""
    whole = map(whole_numbers, vectors)
    return not any(
        sum(value * vector.get(column, 0) for column, value in row.items())
        for vector in whole
        for row in equations
    )
