r"""Casimirs, found: polynomial ones up to a degree, then rational ones and matrix invariants.

Comes in: a Poisson structure, or an algebra for its Lie-Poisson bracket. Goes out: a
`CasimirSearch`, which says how many there must be, which were found and why others were not.
Read next: `coadjoint.poisson.search`, then `coadjoint.poisson.invariants`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import comb

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.exact import Element, Field
from coadjoint.limits import INVARIANT_TERMS, MONOMIALS
from coadjoint.poisson.brackets import lie_poisson
from coadjoint.poisson.invariants import has_trace_form, matrix_invariants
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.polynomials import Polynomial
from coadjoint.poisson.ranks import generic_rank
from coadjoint.poisson.search import independent, polynomial_casimirs, quotients
from coadjoint.poisson.structure import PoissonStructure


@dataclass(frozen=True)
class CasimirSearch:
    """What was found.

    Attributes:
        structure: The Poisson structure that was searched.
        generators: Functionally independent Casimirs, by degree; every polynomial Casimir up to
            the degree is a function of them.
        expected: How many independent ones there are near almost every point: dimension - rank.
        method: How they were found.
        missing: How many were not found and why; empty if none is missing.
    """

    structure: PoissonStructure
    generators: tuple[Element, ...]
    expected: int
    method: str
    missing: str


def casimirs(of: PoissonStructure | LieAlgebra, degree: int = 4) -> CasimirSearch:
    """The Casimirs of a structure, or of the minus Lie-Poisson bracket of an algebra.

    Args:
        of: Entries must be polynomials with rational coefficients.
        degree: The largest degree of the polynomials that are searched.

    Raises:
        AlgebraError: An entry of the tensor is not a polynomial over the rationals, or a structure
            constant is no number.
        LimitError: More than `MONOMIALS` monomials would be searched, and no matrices help.

    >>> from coadjoint.algebra import algebra_by_name
    >>> casimirs(algebra_by_name("se(3)"), 2).generators
    (J1*P1 + J2*P2 + J3*P3, P1**2 + P2**2 + P3**2)
    """
    structure = lie_poisson_dual(of) if isinstance(of, LieAlgebra) else of
    matrices = of if isinstance(of, LieAlgebra) and has_trace_form(of) else None
    expected = structure.dimension - structure.generic_rank()
    count = comb(structure.dimension + degree, degree) - 1
    if count > MONOMIALS and matrices is None:
        raise LimitError(_too_many(structure, degree, count), found=count, limit=MONOMIALS)
    bracket = PolynomialBracket(structure)
    found: list[Polynomial] = []
    ways: list[str] = []
    if count <= MONOMIALS:
        found = polynomial_casimirs(bracket, degree, expected)
        ways += [f"exact linear solve over the monomials up to degree {degree}"] if found else []
    if len(found) < expected and matrices is not None:
        more = independent([*found, *matrix_invariants(matrices, bracket)], bracket.size, expected)
        ways += ["invariants of the matrix dual by the trace form"] if more != found else []
        found = more
    generators = [p.element(structure.field, structure.names) for p in found]
    if len(found) < expected and count <= MONOMIALS:
        rational = _rational(structure, bracket, degree, generators)
        generators += rational
        ways += ["quotients of semi-invariants"] if rational else []
    missing = _missing(expected - len(generators), degree, count <= MONOMIALS, matrices is not None)
    return CasimirSearch(structure, tuple(generators), expected, ", then ".join(ways), missing)


def lie_poisson_dual(algebra: LieAlgebra) -> PoissonStructure:
    """The minus Lie-Poisson structure in coordinates named like the basis.

    Raises:
        AlgebraError: A structure constant holds parameters; the message names its bracket.
    """
    for (i, j), row in algebra.constants.items():
        for constant in row.values():
            if not isinstance(constant, int | Fraction):
                pair = f"[{algebra.basis[i]}, {algebra.basis[j]}]"
                raise AlgebraError(
                    f"{algebra.name}: {pair} has the coefficient {constant}; expected rational "
                    "numbers. Put numbers for the parameters.",
                    pair=[algebra.basis[i], algebra.basis[j]],
                    found=str(constant),
                )
    field = Field(algebra.basis)
    return lie_poisson(algebra, field, algebra.basis)


def _rational(
    structure: PoissonStructure, bracket: PolynomialBracket, degree: int, known: list[Element]
) -> list[Element]:
    """Quotients of semi-invariants whose gradients are independent of those of all before them."""
    kept: list[Element] = []
    for quotient in quotients(structure, bracket, degree):
        slopes = [structure.gradient(f) for f in (*known, *kept, quotient)]
        if generic_rank(structure.field, slopes) == len(slopes):
            kept.append(quotient)
    return kept


def _too_many(structure: PoissonStructure, degree: int, count: int) -> str:
    return (
        f"{structure.label}: a search for Casimirs up to degree {degree} in "
        f"{structure.dimension} coordinates has {count} monomials; expected at most {MONOMIALS} "
        "(MONOMIALS). Ask for a lower degree, or give the algebra with its matrices."
    )


def _missing(number: int, degree: int, searched: bool, matrices: bool) -> str:
    """How many Casimirs were not found, and where they were looked for."""
    if not number:
        return ""
    places = [f"no more polynomials up to degree {degree}", "no quotients of semi-invariants"]
    where = places if searched else [f"degree {degree} has more than {MONOMIALS} monomials"]
    if matrices:
        where.append(f"no more invariants of matrices within {INVARIANT_TERMS} products of terms")
    return f"{number} not found: {', '.join(where)}; they have a higher degree or are not rational"
