"""Completeness: whether the Casimirs that are known are all that there are.

Comes in: Equations with the Casimirs that their spec claims. Goes out: further ones, found and
still to be proved, and how many are missing of the number that dimension and rank predict. A
claimed Casimir is known once it is proved.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from coadjoint.derive import Equations
from coadjoint.derive.structure import (
    canonical_pairs,
    exact_momentum_algebra,
    poisson_structure,
)
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.ranks import MODULO, error_of_ranks, generic_rank, source_of_ranks
from coadjoint.exact.witness import is_entire
from coadjoint.poisson import PoissonStructure
from coadjoint.poisson.casimirs import CasimirSearch, search_summands, select_independent
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.summands import restrict_algebra
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.identities import casimir_defects
from coadjoint.prove.zero import Decision, Discovery, decide_zero

#: Casimirs are searched for up to this degree unless told otherwise: every algebra of dimension 11
#: or less that books treat has all of its polynomial ones there.
DEGREE = 4
#: Characters of a Casimir that a statement shows; longer ones are described.
SHOWN = 120
#: How a statement tells of a longer one.
UNWRITTEN = "a function with"
#: What a Casimir does not change along, for a Poisson bracket and on constraints.
BRACKET, FIELDS = "the bracket", "the Hamiltonian vector fields with their commutators"
#: Where a count of independent functions holds.
ALMOST = "near almost every point"
#: Where it holds if roots or logarithms occur, which one analytic function is in such a part alone.
IN_PART = f"{ALMOST} of a connected part of the domain"


#: The entries of a row that are not zero, by place.
SparseRow = Mapping[int, Element]


def drop_zeros(row: Sequence[Element]) -> SparseRow:
    """The entries that are not zero, by place."""
    return {n: entry for n, entry in enumerate(row) if entry}


@dataclass(frozen=True)
class Reach:
    """What bounds the number of Casimirs of an almost-Poisson bracket.

    Attributes:
        rows: By the number of known Casimirs, independent rows of the fields and their commutators:
            no more than these Casimirs leave room for.
        is_poisson: Whether no point is known where the Jacobi identity fails.
    """

    rows: Callable[[int], Sequence[SparseRow]]
    is_poisson: bool


@dataclass(frozen=True)
class Completeness:
    """What is known of the Casimirs of a bracket.

    Attributes:
        found: Casimirs beyond the claimed ones, independent of them.
        known: How many independent ones are known: proved or found.
        expected: How many there are near almost every point: dimension - rank of `directions`.
        missing: How many of these are not known, and what was searched; empty if none is missing.
        generating: Places of coordinates whose brackets give all others.
        source: How the ranks are known.
        error: How likely a rank is larger, in words; empty where the two ranks bound each other.
        degree: Where some are missing: every polynomial Casimir up to this degree is a function of
            those known; 0 if this was not found out.
        scope: Where all of this holds.
        directions: The rank of what bounds the number of Casimirs from above.
    """

    found: tuple[Element, ...]
    known: int
    expected: int
    missing: str
    generating: tuple[int, ...] = ()
    source: str = MODULO
    error: str = ""
    degree: int = 0
    scope: str = ALMOST
    directions: str = BRACKET

    @property
    def decision(self) -> Decision | Discovery:
        """How the number is known.

        Gradients of some rank at a point bound the number of Casimirs from below, and the rank of
        the bracket bounds it from above: where the two meet, both are proved. Where Casimirs are
        missing, a rank may be larger than at the points where it was taken, so that it is found.
        """
        ranks = f"ranks of the gradients and of {self.directions}"
        if self.error:
            return Discovery(f"{ranks} {self.source}", self.scope, self.error)
        method = f"{ranks} that add up to the dimension, {self.source}"
        return Decision(verdict=Verdict.PROVED, method=method)

    @property
    def statement(self) -> str:
        """What is known, in words."""
        if self.known == self.expected:
            certain = isinstance(self.decision, Decision)  # a finding has a scope of its own
            text = (
                _all(self.known, "Casimir") if self.known else "there are no Casimirs but constants"
            )
            return f"{text}, {self.scope}" if certain else text
        text = f"{self.known} of {self.expected} independent Casimirs are known: {self.missing}"
        follows = _all(self.known, f"polynomial Casimir of degree <= {self.degree}")
        return f"{text}; {follows}" if self.degree else text


def _all(known: int, noun: str) -> str:
    """That there are no functions beyond those known."""
    what = {0: "constant", 1: "a function of the one known"}
    return f"every {noun} is {what.get(known, f'a function of the {known} known')}"


def bracket_of(equations: Equations) -> PoissonStructure:
    """The emitted Poisson tensor as a structure; on constraints, in what these leave free."""
    setting, emitted = equations.setting, equations.exact.poisson_tensor
    assert emitted is not None, f"the route {equations.route} knows no bracket"
    given = dict(equations.exact.definitions)
    places = [n for n, name in enumerate(setting.state) if name not in given]
    tensor = tuple(tuple(equations.close(emitted[i][j]) for j in places) for i in places)
    names = tuple(setting.state[n] for n in places)
    return PoissonStructure(setting.field, names, tensor, f"bracket of {setting.spec.name}")


def is_proved_casimir(equations: Equations, function: Element) -> bool:
    """Whether ``{x_i, C} = 0`` is proved for every component of the state."""
    defects = casimir_defects(equations, function)
    return decide_zero(defects, equations.setting.field).verdict is Verdict.PROVED


def completeness(
    equations: Equations,
    degree: int = DEGREE,
    proved: Sequence[Element] | None = None,
    reach: Reach | None = None,
) -> Completeness:
    """Count the proved Casimirs, and look for others where some are missing.

    A claim that is refuted, or only supported by numbers, counts for nothing. The
    distinguished functions of a Nambu bracket are known without a search.

    Args:
        equations: The motion with its bracket.
        degree: Up to which degree polynomials are searched.
        proved: Claimed Casimirs that are proved; by default they are proved here.
        reach: Of an almost-Poisson bracket.
    """
    setting, structure = equations.setting, bracket_of(equations)
    if proved is None:
        claimed = [c for casimir in setting.spec.casimirs for c in setting.components(casimir)]
        proved = [c for c in claimed if is_proved_casimir(equations, c)]
    known = select_independent(structure, map(equations.close, proved))
    rows = [*map(drop_zeros, structure.tensor)] if reach is None else reach.rows(len(known))
    expected = structure.dimension - generic_rank(setting.field, rows)
    declared = setting.spec.poisson.functions if setting.spec.poisson is not None else ()
    given = [setting.formula(function) for function in declared]
    given = [function for function in given if is_proved_casimir(equations, function)]
    further = select_independent(structure, [*known, *given])[len(known) :]
    missing, reached = "", 0
    generating: Sequence[int] = range(structure.dimension)
    if len(known) + len(further) < expected:
        if reach is not None and not reach.is_poisson:
            missing = f"{expected - len(known)} not searched for, since the Jacobi identity fails"
        else:
            search = _search(equations, structure, degree, [*known, *further])
            together = select_independent(structure, [*known, *further, *search.generators])
            further = together[len(known) :]
            missing, reached = search.missing, search.degree
            generating = _generating(structure) if search.generators else generating
    whole = len(known) + len(further)
    if whole == expected:
        missing, reached = "", 0
    source, error = _source(structure, (*known, *further), rows)
    scope = scope_of(structure, (*known, *further))
    return Completeness(
        found=tuple(further),
        known=whole,
        expected=expected,
        missing=missing,
        generating=tuple(generating),
        source=source,
        error=error,
        degree=reached,
        scope=scope,
        directions=BRACKET if reach is None else FIELDS,
    )


def _source(
    structure: PoissonStructure, known: Sequence[Element], rows: Sequence[SparseRow]
) -> tuple[str, str]:
    """How the ranks are known, and how likely one is larger.

    Ranks at a point bound each other where they add up to the dimension. Modulo a prime each holds
    at almost every point; with functions both are taken at one point, as one matrix.
    """
    field, size = structure.field, structure.dimension
    gradients = [structure.gradient(casimir) for casimir in known]
    both = [*gradients, *({size + n: x for n, x in row.items()} for row in rows)]
    source = source_of_ranks(field, (both, size))
    met = len(known) + generic_rank(field, rows) == size
    if met and source != MODULO:
        met = generic_rank(field, both) == size
    return source, "" if met else error_of_ranks(field, both)


def scope_of(structure: PoissonStructure, functions: Sequence[Element]) -> str:
    """Where a count of Casimirs holds: for almost all parameters, too, if it rests on such."""
    entries = {id(entry): entry for row in structure.tensor for entry in row if entry}
    field, present = structure.field, (*entries.values(), *functions)
    free = frozenset[str]().union(*map(field.reach, present)) <= {*structure.names}
    where = ALMOST if is_entire(field, present) else IN_PART
    return where if free else f"{where}, for almost all parameters"


def _generating(structure: PoissonStructure) -> Sequence[int]:
    """Places of coordinates whose brackets give all others; all where there is no table of it."""
    with suppress(AlgebraError):
        return PolynomialBracket(structure).generating
    return range(structure.dimension)


def _search(
    equations: Equations, emitted: PoissonStructure, degree: int, known: Sequence[Element]
) -> CasimirSearch:
    """Casimirs beyond those known, in the coordinates of the state."""
    setting = equations.setting
    spec = setting.spec
    others = spec.is_first_order or canonical_pairs(setting) or not setting.momenta  # or velocities
    if spec.algebra is None or others:
        return search_summands(emitted, None, degree, known)
    advected = [name for variable in setting.advected for name in variable.components]
    coordinates = [*setting.momenta, *advected]
    order = [coordinates.index(name) for name in setting.state]
    algebra = restrict_algebra(exact_momentum_algebra(setting), order)
    return search_summands(poisson_structure(setting), algebra, degree, known)


def describe(field: Field, casimir: Element) -> str:
    """A Casimir as a statement shows it."""
    terms = field.terms(casimir)
    text = element_text(field, casimir) if len(terms) < SHOWN else ""
    if text and len(text) <= SHOWN:
        return text
    return f"{UNWRITTEN} {len(terms)} terms that begins with {element_text(field, terms[0])}"
