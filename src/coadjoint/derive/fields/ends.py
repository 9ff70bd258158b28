r"""Ends: differences on a line with two ends, by which sums are summed by parts.

.. math:: D = H^{-1} Q, \qquad Q + Q^T = \mathrm{diag}(-1, 0, \ldots, 0, 1),

with weights H of a quadrature, h times a diagonal matrix. Inside D is central; near the ends rows
have other coefficients and half of the order (Strand 1994, J. Comput. Phys. 110, 47). So
:math:`u^T H D v + (D u)^T H v = u_N v_N - u_1 v_1`, the discrete form of integration by parts.

A strand has free ends, where :math:`l_\Xi = 0`, or clamped ones, where :math:`\Omega = 0`. These
conditions hold weakly: the derivative of what is 0 there is :math:`D - H^{-1} (Q + Q^T) =
-H^{-1} Q^T`, which is minus the adjoint of the other one, D. Then the matrix of the bracket is
antisymmetric with the weights of the energy, and the energy is kept in continuous time.
Comes in: an order. Goes out: rows and weights, exactly.
Read next: `coadjoint.derive.fields.generic`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final

from coadjoint.derive.fields.lattice import Calculus, Lattice, LatticeTerm
from coadjoint.derive.fields.stencils import stencil


def _row(text: str) -> dict[int, Fraction]:
    """A row by its columns.

    >>> _row("-1 1")
    {0: Fraction(-1, 1), 1: Fraction(1, 1)}
    """
    return {n: Fraction(x) for n, x in enumerate(text.split()) if x != "0"}


@dataclass(frozen=True)
class Closure:
    """What is special near an end.

    Attributes:
        weights: Of the first points, over h; all others have 1.
        rows: Of h D, of these points, by columns.
        largest: The most by which h D and its counterpart multiply a wave, which is one near an
            end; to 6 digits.
    """

    weights: tuple[Fraction, ...]
    rows: tuple[Mapping[int, Fraction], ...]
    largest: float


#: By the order inside.
CLOSURES: Final = {
    2: Closure((Fraction(1, 2),), (_row("-1 1"),), 1.41421),
    4: Closure(
        tuple(Fraction(n, 48) for n in (17, 59, 43, 49)),
        (
            _row("-24/17 59/34 -4/17 -3/34"),
            _row("-1/2 0 1/2"),
            _row("4/43 -59/86 0 59/86 -4/43"),
            _row("3/98 0 -59/98 0 32/49 -4/49"),
        ),
        1.93633,
    ),
}


def find_row(order: int, place: int | None, *, meets: bool) -> dict[int, Fraction]:
    """A row of h D by the distance of its columns.

    Args:
        order: Inside.
        place: The number of the point, from the end if it is negative; None inside.
        meets: Whether the row is of the derivative of what is 0 at the ends.

    >>> find_row(2, 0, meets=False), find_row(2, 0, meets=True)
    ({0: Fraction(-1, 1), 1: Fraction(1, 1)}, {0: Fraction(1, 1), 1: Fraction(1, 1)})
    """
    if place is None:
        return dict(stencil(1, order))
    closure, own = CLOSURES[order], place if place >= 0 else -1 - place
    row = {column - own: c for column, c in closure.rows[own].items()}
    if meets and own == 0:
        row[0] = row.get(0, Fraction(0)) + 1 / closure.weights[0]
    return row if place >= 0 else {-r: -c for r, c in sorted(row.items(), reverse=True)}


def find_place(order: int, i: int, size: int) -> int | None:
    """The number of a point near an end, from the end if it is negative; None inside."""
    some = len(CLOSURES[order].rows)
    return i if i < some else i - size if i >= size - some else None


def find_weight(order: int, place: int | None) -> Fraction:
    """The weight of a point over h."""
    if place is None:
        return Fraction(1)
    return CLOSURES[order].weights[place if place >= 0 else -1 - place]


@dataclass(frozen=True)
class EndCalculus(Calculus):
    """Differences near an end, of expressions without derivatives.

    Attributes:
        meets: Of each row of an operator, whether it differentiates what is 0 at the ends.
        place: Of the point i, the number that `find_row` takes.
    """

    meets: tuple[bool, ...] = ()
    place: Callable[[int], int | None] = lambda _: None

    def compose(
        self, operator: Sequence[Sequence[Any]], slopes: Sequence[Lattice]
    ) -> list[Lattice]:
        """What an operator of first order makes of slopes."""
        return [
            self._compose_row(entries, slopes, meets=meets)
            for entries, meets in zip(operator, self.meets, strict=True)
        ]

    def _compose_row(
        self, entries: Sequence[Any], slopes: Sequence[Lattice], *, meets: bool
    ) -> Lattice:
        def at(i: int) -> Any:
            terms = [
                self._apply(term, slope, i, meets=meets)
                for entry, slope in zip(entries, slopes, strict=True)
                for term in entry
            ]
            return sum(terms, self.number(Fraction(0)))

        return at

    def _apply(self, term: LatticeTerm, slope: Lattice, i: int, *, meets: bool) -> Any:
        """``left * D(right * slope)`` at a point, or without D."""
        left, order, right = term
        if not order:
            return left(i) * right(i) * slope(i)
        assert order == 1, "a strand has first derivatives"
        known = find_row(self.order, self.place(i), meets=meets).items()
        parts = [self.number(c) * self.inverse * (right(i + r) * slope(i + r)) for r, c in known]
        return left(i) * sum(parts[1:], parts[0])
