"""A Poisson bracket whose entries are polynomials over the rationals, made ready for searches.

Comes in: a Poisson structure. Goes out: a `PolynomialBracket`: the entries as plain polynomials,
``{x_i, m}`` of a monomial, the coordinates that scale all others, and the few that generate the
others. Read next: `coadjoint.poisson.gradings`.
"""

from __future__ import annotations

from functools import cached_property

from sympy.polys.rings import PolyElement

from coadjoint.errors import AlgebraError
from coadjoint.exact.ansatz import Exponents
from coadjoint.poisson.polynomials import Number, read_terms
from coadjoint.poisson.structure import PoissonStructure, find_generators


class PolynomialBracket:
    """A bracket as a table of polynomials.

    Args:
        structure: Its entries must be polynomials over the rationals.

    Attributes:
        size: Number of coordinates.
        entries: The entries ``{x_i, x_j}`` that are not zero, both orders of i and j.

    Raises:
        AlgebraError: An entry is not such a polynomial, or the Jacobi identity fails.
    """

    def __init__(self, structure: PoissonStructure) -> None:
        structure.check_jacobi()
        self.size = structure.dimension
        self.entries = {
            (i, j): _read(structure, i, j)
            for i, row in enumerate(structure.tensor)
            for j, entry in enumerate(row)
            if entry
        }
        self._acting = [
            [(j, self.entries[i, j]) for j in range(self.size) if (i, j) in self.entries]
            for i in range(self.size)
        ]

    def along(self, i: int, monomial: Exponents) -> dict[Exponents, Number]:
        """``{x_i, m}`` of a monomial: ``sum_j {x_i, x_j} dm/dx_j``."""
        result: dict[Exponents, Number] = {}
        for j, terms in self._acting[i]:
            power = monomial[j]
            if power:
                lowered = (*monomial[:j], power - 1, *monomial[j + 1 :])
                for term, value in terms.items():
                    product = tuple(map(int.__add__, lowered, term))
                    result[product] = result.get(product, 0) + value * power
        return result

    def is_casimir(self, p: PolyElement) -> bool:
        """Whether a polynomial commutes with the generating coordinates, hence with all."""
        for i in self.generating:
            total: dict[Exponents, Number] = {}
            for monomial, factor in p.items():
                for product, value in self.along(i, monomial).items():
                    total[product] = total.get(product, 0) + factor * value
            if any(total.values()):
                return False
        return True

    @cached_property
    def generating(self) -> list[int]:
        """Coordinates that generate the others."""
        single = {
            pair: next(iter(entry)).index(1)
            for pair, entry in self.entries.items()
            if [sum(exponents) for exponents in entry] == [1]
        }
        return find_generators(single, self.size)

    @cached_property
    def scalings(self) -> dict[int, dict[int, Number]]:
        """The coordinates with ``{x_i, x_j} = a_ij x_j`` for every j, and their factors."""
        result = {}
        for i, entries in enumerate(self._acting):
            single = all(
                len(terms) == 1 and sum(e) == e[j] == 1 for j, terms in entries for e in terms
            )
            if entries and single:
                result[i] = {j: value for j, terms in entries for value in terms.values()}
        return result

    def character(self, monomial: Exponents) -> tuple[Number, ...]:
        """``chi_i`` with ``{x_i, m} = chi_i m``, for each coordinate that scales all others."""
        return tuple(
            sum(factor * monomial[j] for j, factor in factors.items())
            for factors in self.scalings.values()
        )


def _read(structure: PoissonStructure, i: int, j: int) -> dict[Exponents, Number]:
    """An entry as a polynomial, by its terms.

    Raises:
        AlgebraError: It is none; the message names the pair of coordinates.
    """
    try:
        return read_terms(structure.field, structure.tensor[i][j], structure.names)
    except AlgebraError as error:
        a, b = structure.names[i], structure.names[j]
        raise AlgebraError(f"{{{a}, {b}}}: {error}", pair=[a, b], **error.parts) from None
