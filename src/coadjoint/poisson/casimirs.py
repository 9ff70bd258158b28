r"""The search for Casimirs: polynomials up to a degree, quotients, and matrix invariants.

Comes in: a Poisson structure, or an algebra for its Lie-Poisson bracket. Goes out: a
`CasimirSearch`, which says how many there can be, which were found and what was searched. Each
direct summand is searched for itself: its Casimirs are shorter than those of the whole.
Read next: `coadjoint.poisson.summands`, `coadjoint.poisson.search`, `coadjoint.poisson.invariants`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb

from sympy.polys.rings import PolyElement

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.numbers import Numbers
from coadjoint.exact.ranks import independent_rows
from coadjoint.limits import INVARIANT_TERMS, MONOMIALS
from coadjoint.poisson.brackets import lie_poisson
from coadjoint.poisson.invariants import has_trace_form, matrix_invariants
from coadjoint.poisson.irrational import UNKNOWNS, AlgebraicCasimirs, numbers_of
from coadjoint.poisson.parametric import (
    MONOMIALS_OF_ONE,
    find_constants,
    parametric_casimirs,
)
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.search import independent_polynomials, polynomial_casimirs, quotients
from coadjoint.poisson.structure import PoissonStructure
from coadjoint.poisson.summands import restrict_algebra, restrict_structure, summands

#: Coordinates that name a direct summand.
NAMED = 3


@dataclass(frozen=True)
class SummandSearch:
    """What was found in one direct summand.

    Attributes:
        structure: The summand.
        known: How many independent ones were known before.
        generators: Casimirs independent of those and of each other, by degree.
        expected: How many independent ones there can be: dimension - rank.
        ways: How those that were found were found.
        searched: Sets of functions that were searched in full.
        degree: Up to which degree all polynomials were; 0 if they were not.
        skipped: What was asked for and not searched, and why; else empty.
        obstacle: Why nothing was searched; None if something was.
    """

    structure: PoissonStructure
    known: int
    generators: tuple[Element, ...]
    expected: int
    ways: tuple[str, ...] = ()
    searched: tuple[str, ...] = ()
    degree: int = 0
    skipped: str = ""
    obstacle: AlgebraError | None = None

    @property
    def missing(self) -> str:
        """How many were not found, and among what; empty if none is missing."""
        number = self.expected - self.known - len(self.generators)
        if not number:
            return ""
        if self.obstacle is not None:
            return f"{number} not searched for: {self.obstacle}"
        where = " and ".join([", ".join(self.searched[:-1])] * (len(self.searched) > 1))
        text = f"{number} not found among {where}{' and ' * bool(where)}{self.searched[-1]}"
        return f"{text}; {self.skipped}" if self.skipped else text


@dataclass(frozen=True)
class CasimirSearch:
    """What was found.

    Attributes:
        structure: The Poisson structure that was searched.
        summands: The search in each direct summand.
    """

    structure: PoissonStructure
    summands: tuple[SummandSearch, ...]

    @property
    def generators(self) -> tuple[Element, ...]:
        """Functionally independent Casimirs, by summand and degree."""
        return tuple(c for part in self.summands for c in part.generators)

    @property
    def expected(self) -> int:
        """How many independent ones there can be near almost every point: dimension - rank."""
        return sum(part.expected for part in self.summands)

    @property
    def method(self) -> str:
        """How they were found."""
        return ", then ".join(dict.fromkeys(way for part in self.summands for way in part.ways))

    @property
    def degree(self) -> int:
        """Up to which degree every polynomial Casimir is a function of those found; 0 if none is.

        A polynomial Casimir of the whole is a sum of products of such of the summands, whose
        degrees are no larger.
        """
        return min((part.degree for part in self.summands if part.missing), default=0)

    @property
    def missing(self) -> str:
        """How many were not found and what was searched; empty if none is missing."""
        places: dict[str, list[str]] = {}
        for part in self.summands:
            if part.missing:
                names = part.structure.names
                label = ", ".join(names[:NAMED]) + ", ..." * (len(names) > NAMED)
                places.setdefault(part.missing, []).append(label)
        if len(self.summands) == 1:
            return "".join(places)
        return "; ".join(f"{_parts(labels)} {text}" for text, labels in places.items())


def _parts(labels: list[str]) -> str:
    """``of the part x1, x2``, or that there are several like it."""
    if len(labels) == 1:
        return f"of the direct summand ({labels[0]})"
    return f"of each of {len(labels)} direct summands such as ({labels[0]})"


def casimirs(of: PoissonStructure | LieAlgebra, degree: int = 4) -> CasimirSearch:
    """The Casimirs of a structure, or of the minus Lie-Poisson bracket of an algebra.

    Args:
        of: Entries must be polynomials with rational coefficients.
        degree: The largest degree of the polynomials that are searched; a lower one is taken where
            there are more than `MONOMIALS` monomials.

    Raises:
        AlgebraError: An entry of the tensor is not a polynomial over the rationals, or a structure
            constant is not a number.

    >>> from coadjoint.algebra import algebra_by_name
    >>> casimirs(algebra_by_name("se(3)"), 2).generators
    (J1*P1 + J2*P2 + J3*P3, P1**2 + P2**2 + P3**2)
    """
    if isinstance(of, LieAlgebra):
        result = search_summands(lie_poisson_dual(of), of, degree)
    else:
        result = search_summands(of, None, degree)
    for part in result.summands:
        if part.obstacle is not None:
            raise part.obstacle
    return result


def search_summands(
    structure: PoissonStructure,
    algebra: LieAlgebra | None,
    degree: int,
    known: Sequence[Element] = (),
) -> CasimirSearch:
    """The Casimirs of each direct summand that can be searched; nothing is raised for the others.

    Args:
        structure: A Poisson structure.
        algebra: That whose basis gives its coordinates, in their order; None if there is none.
        degree: The largest degree of the polynomials that are searched.
        known: Independent Casimirs; a summand that has all of its own among them is not searched.
    """
    result = list[SummandSearch]()
    for places in summands(structure):
        part = restrict_structure(structure, places)
        expected = part.dimension - part.generic_rank()
        given = [f for f in known if set(structure.gradient(f)) <= set(places)]
        own = None if algebra is None else restrict_algebra(algebra, places)
        if len(given) >= expected:
            result.append(
                SummandSearch(structure=part, known=len(given), generators=(), expected=expected)
            )
            continue
        try:
            result.append(_search(part, own, degree, expected, given))
        except AlgebraError as error:
            result.append(
                SummandSearch(
                    structure=part,
                    known=len(given),
                    generators=(),
                    expected=expected,
                    obstacle=error,
                )
            )
    return CasimirSearch(structure, tuple(result))


def select_independent(structure: PoissonStructure, functions: Iterable[Element]) -> list[Element]:
    """Those functions whose gradients are independent of all before them at a generic point."""
    whole = list(functions)
    slopes = [structure.gradient(function) for function in whole]
    return [whole[place] for place in independent_rows(structure.field, slopes)]


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
                    "numbers. Replace the parameters by numbers.",
                    pair=[algebra.basis[i], algebra.basis[j]],
                    found=str(constant),
                )
    field = Field(algebra.basis)
    return lie_poisson(algebra, field, algebra.basis)


# -- one summand ----------------------------------------------------------------------------------


def _search(
    structure: PoissonStructure,
    algebra: LieAlgebra | None,
    degree: int,
    expected: int,
    known: Sequence[Element],
) -> SummandSearch:
    """The Casimirs of a structure without direct summands.

    Matrices come first where the polynomials of the degree that is asked for are too many.

    Raises:
        AlgebraError: An entry of the tensor is not a polynomial over the rationals.
    """
    numbers = None if algebra is None else numbers_of(algebra)
    if algebra is not None and numbers is not None:
        return _search_over_numbers(structure, algebra, numbers, degree, expected, known)
    if constants := find_constants(structure):
        return _search_with_parameters(structure, constants, degree, expected, known)
    bracket = PolynomialBracket(structure)
    reached = _reduce_degree(structure.dimension, degree)
    polynomials, ways, searched = list[PolyElement](), list[str](), list[str]()
    steps: list[tuple[str, str, Callable[[], list[PolyElement]]]] = [
        (
            f"exact linear solve over the monomials up to degree {reached}",
            f"all polynomials of degree <= {reached}",
            lambda: polynomial_casimirs(bracket, reached, expected),
        )
    ]
    if algebra is not None and has_trace_form(algebra):
        matrices = algebra, bracket
        bound = f"at most {INVARIANT_TERMS} products of terms (INVARIANT_TERMS)"
        steps.append(
            (
                "invariants of the matrix dual by the trace form",
                f"traces of powers or Pfaffians of its matrix dual that take {bound}",
                lambda: matrix_invariants(*matrices),
            )
        )
    for way, family, search in steps if reached == degree else reversed(steps):
        if len(polynomials) < expected:
            before = len(polynomials)
            candidates = [*polynomials, *search()]
            polynomials = independent_polynomials(candidates, bracket.size, expected)
            ways += [way] * (len(polynomials) > before)
            searched.append(family)
    generators = [structure.field.polynomial(structure.names, p) for p in polynomials]
    if len(polynomials) < expected and bracket.scalings:
        count = len(generators)
        rational = quotients(structure, bracket, reached)
        generators = select_independent(structure, [*generators, *rational])
        ways += ["quotients of semi-invariants"] * (len(generators) > count)
        searched.append(f"products of powers of semi-invariants of degree <= {reached}")
    skipped = "" if reached == degree else _explain_skipped(structure.dimension, degree, reached)
    if known:  # long functions; these are independent of each other by now
        generators = select_independent(structure, [*known, *generators])[len(known) :]
    return SummandSearch(
        structure=structure,
        known=len(known),
        generators=tuple(generators),
        expected=expected,
        ways=tuple(ways),
        searched=tuple(searched),
        degree=reached,
        skipped=skipped,
    )


def _search_with_parameters(
    structure: PoissonStructure,
    constants: Sequence[str],
    degree: int,
    expected: int,
    known: Sequence[Element],
) -> SummandSearch:
    """The same for entries with parameters and pi: short polynomials up to a degree."""
    reached = _reduce_degree(structure.dimension, degree)
    found = parametric_casimirs(structure, constants, reached, expected)
    generators = select_independent(structure, [*known, *found])[len(known) :]
    way = "monomials at random parameters, and coefficients that are functions of these"
    most = f"of at most {MONOMIALS_OF_ONE} monomials"
    return SummandSearch(
        structure=structure,
        known=len(known),
        generators=tuple(generators),
        expected=expected,
        ways=(way,) * bool(generators),
        searched=(f"polynomials of degree <= {reached} {most} at random parameters",),
    )


def _search_over_numbers(
    structure: PoissonStructure,
    algebra: LieAlgebra,
    numbers: Numbers,
    degree: int,
    expected: int,
    known: Sequence[Element],
) -> SummandSearch:
    """The same for constants that are algebraic numbers: all polynomials up to a degree."""
    search, found = AlgebraicCasimirs(algebra, structure, numbers), list(known)
    reached, skipped = 0, ""
    for power in range(1, degree + 1):
        if len(found) == expected:
            break
        if not search.fits(power):
            skipped = (
                f"degree {power} not searched: more than {UNKNOWNS} unknowns (UNKNOWNS) over a "
                f"number field of degree {numbers.degree}"
            )
            break
        found = select_independent(structure, [*found, *search.find(power)])[:expected]
        reached = power
    generators = tuple(found[len(known) :])
    way = "exact linear solve over the coordinates in the number field of the constants"
    return SummandSearch(
        structure=structure,
        known=len(known),
        generators=generators,
        expected=expected,
        ways=(way,) * bool(generators),
        searched=(f"all polynomials of degree <= {reached}",),
        degree=reached,
        skipped=skipped,
    )


def _reduce_degree(dimension: int, degree: int) -> int:
    """The largest degree up to the one that is asked for with at most `MONOMIALS` monomials."""
    while degree > 1 and _monomials(dimension, degree) > MONOMIALS:
        degree -= 1
    return degree


def _monomials(dimension: int, degree: int) -> int:
    return comb(dimension + degree, degree) - 1


def _explain_skipped(dimension: int, degree: int, reached: int) -> str:
    """What was not searched, and why."""
    count = _monomials(dimension, reached + 1)
    text = f"degree {reached + 1}" + (f" to {degree}" if degree > reached + 1 else "")
    return (
        f"polynomials of {text} were not searched: {count} monomials up to degree {reached + 1}, "
        f"more than {MONOMIALS} (MONOMIALS)"
    )
