"""What the structure constants say about an algebra: Killing form, center, series, rank.

Comes in: sparse exact constants. Goes out: methods of every `LieAlgebra`, which inherits them.
Constants with parameters are taken as they are in general; at special values of the parameters a
center may be larger and a series shorter.
Read next: `coadjoint.algebra.lie_algebra`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, islice
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact.linear import Span, primes, quotient, rank_modulo

#: Points at which a rank is taken.
POINTS = 2


class Invariants:
    """Methods that read `name`, `basis` and `constants` and nothing else."""

    name: str
    basis: tuple[str, ...]
    constants: Mapping[tuple[int, int], Mapping[int, Any]]

    @property
    def dimension(self) -> int:
        """Number of basis vectors."""
        return len(self.basis)

    def structure(self) -> Iterator[tuple[int, int, int, Any]]:
        """Every nonzero ``(i, j, k, c_ij^k)``, both orders of i and j, sorted by the pair."""
        for (i, j), row in self.constants.items():
            for k, c in row.items():
                yield i, j, k, c
                yield j, i, k, -c

    # -- the Killing form -----------------------------------------------------------------

    def killing_form(self) -> tuple[tuple[Any, ...], ...]:
        """``K_ij = tr(ad_i ad_j) = c_ik^l c_jl^k``, a symmetric matrix.

        >>> from coadjoint.algebra import algebra_by_name
        >>> algebra_by_name("so(3)").killing_form()
        ((-2, 0, 0), (0, -2, 0), (0, 0, -2))
        """
        entries: dict[tuple[int, int], list[tuple[int, Any]]] = {}
        for i, k, m, c in self.structure():
            entries.setdefault((m, k), []).append((i, c))  # row m, column k of ad_i
        form: list[list[Any]] = [[0] * self.dimension for _ in self.basis]
        for (m, k), here in entries.items():
            for i, a in here:
                for j, b in entries.get((k, m), ()):
                    form[i][j] = form[i][j] + a * b
        return tuple(map(tuple, form))

    def killing_signature(self) -> tuple[int, int, int]:
        """How many squares of the Killing form are positive, negative and zero (Sylvester).

        Raises:
            AlgebraError: The constants have parameters, whose signs are unknown.

        >>> from coadjoint.algebra import algebra_by_name
        >>> algebra_by_name("sl(2,R)").killing_signature()
        (2, 1, 0)
        """
        for i, j, k, c in self.structure():
            if not isinstance(c, int | Fraction) and not _is_number(c):
                pair = f"[{self.basis[i]}, {self.basis[j]}]"
                raise AlgebraError(
                    f"{self.name}: {pair} has the coefficient {c} of {self.basis[k]}, so the "
                    "signature of the Killing form has no definite value; expected "
                    "numbers. Replace the parameters by numbers with `over`.",
                    found=str(c),
                )
        return signature(self.killing_form())

    # -- ideals ---------------------------------------------------------------------------

    def center(self) -> tuple[tuple[Any, ...], ...]:
        """A basis of the vectors that commute with all others, in reduced row echelon form.

        >>> from coadjoint.algebra import algebra_by_name
        >>> algebra_by_name("h(1)").center()
        ((0, 0, 1),)
        """
        images: list[dict[tuple[int, int], Any]] = [{} for _ in self.basis]
        for i, j, k, c in self.structure():
            images[i][j, k] = c  # e_i -> all [e_i, e_j] at once; the center is its kernel
        span, kernel = Span(), Span()
        kept: list[int] = []
        for i, image in enumerate(images):
            known = span.coordinates(image)
            if known is None:
                span.add(image)
                kept.append(i)
            else:
                kernel.add({i: 1} | {kept[n]: -value for n, value in known.items()})
        places = range(self.dimension)
        return tuple(tuple(row.get(i, 0) for i in places) for row in kernel.rows)

    def derived_series(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [[g, g], [g, g]], ... until they repeat or vanish.

        >>> from coadjoint.algebra import algebra_by_name
        >>> algebra_by_name("aff(1)").derived_series(), algebra_by_name("so(3)").derived_series()
        ((2, 1, 0), (3,))
        """
        return self._series(lower_central=False)

    def lower_central_series(self) -> tuple[int, ...]:
        """Dimensions of g, [g, g], [g, [g, g]], ... until they repeat or vanish."""
        return self._series(lower_central=True)

    def _series(self, lower_central: bool) -> tuple[int, ...]:
        whole: list[dict[int, Any]] = [{i: 1} for i in range(self.dimension)]
        members, dimensions = whole, [self.dimension]
        while members:
            pairs = (
                ((x, y) for x in whole for y in members)
                if lower_central
                else combinations(members, 2)
            )
            members = self._span_of_brackets(pairs)
            if len(members) == dimensions[-1]:
                break
            dimensions.append(len(members))
        return tuple(dimensions)

    def _span_of_brackets(
        self, pairs: Iterable[tuple[dict[int, Any], dict[int, Any]]]
    ) -> list[dict[int, Any]]:
        """A basis of the span of the brackets of pairs of sparse vectors."""
        span = Span()
        for x, y in pairs:
            bracket = self.sparse_bracket(x, y)
            if bracket:
                span.add(bracket)
        return span.rows

    def sparse_bracket(self, x: Mapping[int, Any], y: Mapping[int, Any]) -> dict[int, Any]:
        """``[x, y]`` of vectors given by their nonzero components."""
        result: dict[int, Any] = {}
        for i, a in x.items():
            for j, b in y.items():
                if i == j:
                    continue
                pair, sign = ((i, j), 1) if i < j else ((j, i), -1)
                for k, c in self.constants.get(pair, {}).items():
                    result[k] = result.get(k, 0) + sign * a * b * c
        return {k: value for k, value in result.items() if value != 0}

    # -- kinds ----------------------------------------------------------------------------

    @property
    def is_abelian(self) -> bool:
        """All brackets vanish."""
        return not self.constants

    @property
    def is_solvable(self) -> bool:
        """The derived series ends at zero."""
        return self.derived_series()[-1] == 0

    @property
    def is_nilpotent(self) -> bool:
        """The lower central series ends at zero."""
        return self.lower_central_series()[-1] == 0

    @property
    def is_semisimple(self) -> bool:
        """The Killing form has no kernel (Cartan's criterion)."""
        rows = ({j: x for j, x in enumerate(row) if x != 0} for row in self.killing_form())
        return self.dimension > 0 and Span(rows).rank == self.dimension

    @property
    def is_unimodular(self) -> bool:
        """``tr ad_xi = 0`` for every xi: the flow of a Lie-Poisson system keeps volume."""
        traces: list[Any] = [0] * self.dimension
        for i, j, k, c in self.structure():
            if j == k:
                traces[i] = traces[i] + c
        return all(trace == 0 for trace in traces)

    # -- coadjoint orbits -----------------------------------------------------------------

    def generic_rank(self) -> int:
        """Rank of the Lie-Poisson tensor at almost all points: the dimension of generic orbits.

        It is computed at random integer points, each modulo a prime. Such a rank is never too
        large. It is too small only if every point is a zero of a certain minor, of degree at most
        the dimension d: a probability below (d / 2^60)^2, unless a prime divides the constants, and
        then below d / 2^60 (Schwartz and Zippel). The points are the same in every run. With
        parameters the elimination is done in their field, at one point.

        >>> from coadjoint.algebra import algebra_by_name
        >>> algebra_by_name("se(3)").generic_rank()
        4
        """
        source, largest = random.Random(1), 0  # noqa: S311 - a point of a test, not a secret
        rational = all(isinstance(c, int | Fraction) for *_, c in self.structure())
        for prime in islice(primes(), POINTS if rational else 1):
            mu = [source.randrange(prime) for _ in self.basis]
            rows: list[dict[int, Any]] = [{} for _ in self.basis]
            for i, j, k, c in self.structure():
                rows[i][j] = rows[i].get(j, 0) + c * mu[k]
            largest = max(largest, rank_modulo(rows, prime) if rational else Span(rows).rank)
        return largest


def _is_number(value: Any) -> bool:
    """Whether a constant that is not rational is a number."""
    from coadjoint.exact.numbers import is_number  # rationals need no SymPy

    return is_number(value)


def _sign(value: Any) -> int:
    """The sign of a number."""
    if isinstance(value, int | Fraction):
        return (value > 0) - (value < 0)
    from coadjoint.exact.numbers import sign  # rationals need no SymPy

    return sign(value)


def signature(form: Sequence[Sequence[Any]]) -> tuple[int, int, int]:
    """How many squares of a symmetric form are positive, negative and zero.

    >>> signature([[0, 1, 0], [1, 0, 0], [0, 0, 0]])
    (1, 1, 1)
    """
    squares = _diagonal(form)
    plus = sum(_sign(x) > 0 for x in squares)
    return plus, len(squares) - plus, len(form) - len(squares)


def _diagonal(form: Sequence[Sequence[Any]]) -> list[Any]:
    """Coefficients of a sum of squares that a symmetric form is congruent to; zeros left out."""
    rows = {i: {j: x for j, x in enumerate(row) if x} for i, row in enumerate(form)}
    squares = []
    while rows := {i: row for i, row in rows.items() if row}:
        pivot = next((i for i, row in rows.items() if i in row), None)
        if pivot is None:
            # All squares are gone: 2 x y = ((x + y)^2 - (x - y)^2) / 2, so put x + y for x.
            i, row = next(iter(rows.items()))
            _add_row_and_column(rows, i, min(row), 1)
            continue
        squares.append(rows[pivot][pivot])
        scale = rows[pivot][pivot]
        for i, x in list(rows[pivot].items()):
            if i != pivot:
                _add_row_and_column(rows, i, pivot, -quotient(x, scale))
        rows.pop(pivot)
    return squares


def _add_row_and_column(rows: dict[int, dict[int, Any]], i: int, j: int, factor: Any) -> None:
    """The congruence that adds ``factor`` times row j to row i, and the same for columns."""
    for column, value in list(rows[j].items()):
        _put(rows[i], column, rows[i].get(column, 0) + factor * value)
    for row in rows.values():
        if j in row:
            _put(row, i, row.get(i, 0) + factor * row[j])


def _put(row: dict[int, Any], column: int, value: Any) -> None:
    if value:
        row[column] = value
    else:
        row.pop(column, None)
