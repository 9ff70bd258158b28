r"""Operators: matrices of differential operators in space, such as the bracket of fields.

An entry is a sum of terms :math:`f\, \partial^k\, g`, each of which multiplies by g,
differentiates k times and multiplies by f. So the order in which things are done is kept: on a
grid, where Leibniz' rule fails, :math:`m \partial + \partial m` is antisymmetric and
:math:`2 m \partial + m_s` is not.
In a plane a term has derivatives along both coordinates, :math:`f\, \partial_x^i \partial_y^j\, g`.
The adjoint of a term is :math:`(-1)^k g\, \partial^k f`. Comes in: terms. Goes out: what they do,
exactly. Read next: `coadjoint.derive.fields.structure`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from math import comb

from coadjoint.derive.fields.jets import Jets
from coadjoint.exact import Element


@dataclass(frozen=True)
class Term:
    """``left * D^order * right``, to be applied to what follows; across: along the second one."""

    left: Element
    order: int
    right: Element
    across: int = 0

    @property
    def adjoint(self) -> Term:
        """Integration by parts over the circle."""
        sign = (-1) ** (self.order + self.across)
        return Term(self.right * sign, self.order, self.left, self.across)


#: A sum of terms.
Entry = tuple[Term, ...]
#: Rows of entries.
Operator = tuple[tuple[Entry, ...], ...]


def apply(
    operator: Operator,
    vector: Sequence[Element],
    differentiate: Callable[[Element, int, int], Element],
) -> tuple[Element, ...]:
    """What an operator makes of a vector.

    Args:
        operator: Its entries.
        vector: One value for each column.
        differentiate: ``D_x^i D_y^j`` of a value, `Jets.total`.
    """
    rows = list[Element]()
    for row in operator:
        values = [
            term.left * differentiate(term.right * value, term.order, term.across)
            for entry, value in zip(row, vector, strict=True)
            for term in entry
        ]
        rows.append(sum(values, 0 * vector[0]))
    return tuple(rows)


def adjoint(operator: Operator) -> Operator:
    """The adjoint of a square operator."""
    return tuple(
        tuple(tuple(term.adjoint for term in row[i]) for row in operator)
        for i in range(len(operator))
    )


def expand(entry: Iterable[Term], jets: Jets) -> dict[tuple[int, int], Element]:
    """The coefficients of ``D_x^i D_y^j`` of an entry by Leibniz' rule, zeros left out."""
    found = dict[tuple[int, int], Element]()
    for term in entry:
        for i, j in product(range(term.order + 1), range(term.across + 1)):
            moved = jets.total(term.right, term.order - i, term.across - j)
            part = term.left * moved * (comb(term.order, i) * comb(term.across, j))
            found[i, j] = found.get((i, j), jets.field.zero) + part
    return {place: value for place, value in sorted(found.items()) if value}


def skew_defects(operator: Operator, jets: Jets) -> dict[tuple[int, int], list[Element]]:
    """Coefficients of the operator plus its adjoint that are not zero, by row and column."""
    turned = adjoint(operator)
    sums = {
        (i, j): expand((*operator[i][j], *turned[i][j]), jets)
        for i in range(len(operator))
        for j in range(len(operator))
    }
    return {place: list(found.values()) for place, found in sums.items() if found}


def order_of(operator: Operator) -> int:
    """The highest order of its terms."""
    return max((t.order + t.across for row in operator for entry in row for t in entry), default=0)
