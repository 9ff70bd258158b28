r"""Casimirs of algebras whose structure constants are algebraic numbers, by restriction of scalars.

Over a number field K with the basis b_1, ..., b_d over the rationals, ``C = sum x_ma b_a m`` over
the monomials m has rational unknowns x_ma. ``{x_i, C} = 0`` is linear over K: d rational conditions
for each coefficient. The same exact solver as for rational constants finds all solutions.
Comes in: an algebra with exact constants. Goes out: homogeneous polynomials in the coordinates of
its dual, as elements of the field of a structure. Read next: `coadjoint.exact.numbers`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.exact import Element
from coadjoint.exact.ansatz import Exponents, conditions_on, monomials, solve_exactly
from coadjoint.exact.numbers import Numbers, algebraic
from coadjoint.poisson.structure import PoissonStructure

#: Unknowns of one degree, at most: monomials times the degree of the number field.
UNKNOWNS = 2000


def numbers_of(algebra: LieAlgebra) -> Numbers | None:
    """The field of irrational constants; None where all are rational, or hold parameters or pi."""
    held = [c for *_, c in algebra.structure() if not isinstance(c, int | Fraction)]
    if not held or any(algebraic(c) is None for c in held):
        return None
    numbers: Numbers = held[0].factors.numbers
    return numbers


class AlgebraicCasimirs:
    """The search in one algebra.

    Args:
        algebra: Its constants are numbers, exactly.
        structure: The Lie-Poisson structure of its dual, in the order of its basis.
        numbers: The field of its constants.
    """

    def __init__(self, algebra: LieAlgebra, structure: PoissonStructure, numbers: Numbers) -> None:
        self.algebra, self.structure, self.numbers = algebra, structure, numbers
        self._rows: dict[tuple[int, int, int, int], dict[int, Fraction]] = {}

    @cached_property
    def _acting(self) -> list[list[tuple[int, int, Any]]]:
        """For each i all ``(j, k, c_ij^k)``."""
        one = self.numbers.domain.one
        result: list[list[tuple[int, int, Any]]] = [[] for _ in self.algebra.basis]
        for i, j, k, c in self.algebra.structure():
            rational = isinstance(c, int | Fraction)
            value = one * c.numerator / c.denominator if rational else algebraic(c)
            result[i].append((j, k, value))
        return result

    def find(self, degree: int) -> Iterator[Element]:
        """A basis over the rationals of the Casimirs of a degree."""
        size, count = self.algebra.dimension, self.numbers.degree
        members = [(m, a) for m in monomials(size, degree, least=degree) for a in range(count)]
        for solution in solve_exactly(members, conditions_on(map(self._image, members))):
            yield self._element(solution)

    def fits(self, degree: int) -> bool:
        """Whether there are few enough unknowns of a degree."""
        size = self.algebra.dimension
        return sum(1 for _ in monomials(size, degree, least=degree)) * self.numbers.degree <= (
            UNKNOWNS
        )

    def _image(self, member: tuple[Exponents, int]) -> dict[Any, Fraction]:
        """All ``{x_i, b_a m}``, by i, by monomial and by coordinate along the basis."""
        monomial, a = member
        result: dict[Any, Fraction] = {}
        for i, row in enumerate(self._acting):
            for n, (j, k, c) in enumerate(row):
                if not monomial[j]:
                    continue
                raised = list(monomial)
                raised[j] -= 1
                raised[k] += 1
                for place, x in self._product(i, n, a, c).items():
                    at = i, tuple(raised), place
                    result[at] = result.get(at, Fraction(0)) + x * monomial[j]
        return {at: x for at, x in result.items() if x}

    def _product(self, i: int, n: int, a: int, c: Any) -> dict[int, Fraction]:
        """Coordinates of a constant times a member of the basis, remembered."""
        key = i, n, a, 0
        if key not in self._rows:
            self._rows[key] = self.numbers.coordinates(c * self.numbers.basis[a])
        return self._rows[key]

    def _element(self, solution: Mapping[tuple[Exponents, int], Fraction]) -> Element:
        """A solution in the field of the structure."""
        field, names = self.structure.field, self.structure.names
        numbers = [self.numbers.evaluate(b, field.arithmetic) for b in self.numbers.basis]
        return field.sum(
            field.polynomial(names, {m: x}) * numbers[a] for (m, a), x in solution.items()
        )
