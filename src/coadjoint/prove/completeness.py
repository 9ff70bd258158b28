"""Completeness: whether the Casimirs that are known are all that there are.

Comes in: Equations with the Casimirs that their spec claims. Goes out: further ones, found and
still to be proved, and how many are missing of the number that dimension and rank predict.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coadjoint.derive import Equations
from coadjoint.derive.structure import momentum_algebra
from coadjoint.errors import CoadjointError
from coadjoint.exact import Element, Field, element_text
from coadjoint.poisson import PoissonStructure
from coadjoint.poisson.casimirs import CasimirSearch, casimirs
from coadjoint.poisson.polynomial_bracket import PolynomialBracket
from coadjoint.poisson.ranks import BY_VALUES, MODULO, generic_rank, source_of_ranks
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.zero import Decision

#: Casimirs are looked for up to this degree unless told otherwise: every algebra of dimension 11 or
#: less that books treat has all of its polynomial ones there.
DEGREE = 4
#: Characters of a Casimir that a statement shows; longer ones are described.
SHOWN = 120
#: What decides the number of independent Casimirs.
RANKS = "rank of the gradients and of the bracket"


@dataclass(frozen=True)
class Completeness:
    """What is known of the Casimirs of a bracket.

    Attributes:
        found: Casimirs beyond the claimed ones, independent of them.
        known: How many independent ones are known, claimed or found.
        expected: How many there are near almost every point: dimension - rank.
        missing: Why some are missing; empty if none is.
        generating: Places of coordinates whose brackets give all others.
        source: How the ranks are known.
    """

    found: tuple[Element, ...]
    known: int
    expected: int
    missing: str
    generating: tuple[int, ...] = ()
    source: str = MODULO

    @property
    def decision(self) -> Decision:
        """Whether the number is proved.

        Gradients of some rank at a point bound the number of Casimirs from below, and the rank of
        the bracket bounds it from above: where the two meet, both are proved. Where Casimirs are
        missing, the rank may be larger elsewhere, though that is most unlikely.
        """
        proved = self.known == self.expected and self.source != BY_VALUES
        return Decision(Verdict.PROVED if proved else Verdict.SUPPORTED, f"{RANKS} {self.source}")

    @property
    def statement(self) -> str:
        """The claim in words."""
        if self.known == self.expected:
            return {
                0: "there are no Casimirs but constants",
                1: "every Casimir is a function of the one known",
            }.get(self.known, f"every Casimir is a function of the {self.known} known")
        return f"{self.known} of {self.expected} independent Casimirs are known: {self.missing}"


def bracket_of(equations: Equations) -> PoissonStructure:
    """The emitted Poisson tensor as a structure."""
    setting, emitted = equations.setting, equations.exact.poisson_tensor
    assert emitted is not None, f"the route {equations.route} knows no bracket"
    tensor = tuple(tuple(map(equations.closed, row)) for row in emitted)
    return PoissonStructure(setting.field, setting.state, tensor, f"bracket of {setting.spec.name}")


def completeness(equations: Equations, degree: int = DEGREE) -> Completeness:
    """Count the claimed Casimirs, and look for others where some are missing.

    The distinguished functions of a Nambu bracket are known without a search.
    """
    setting, structure = equations.setting, bracket_of(equations)
    claimed = [c for casimir in setting.spec.casimirs for c in setting.components(casimir)]
    known = independent(structure, claimed)
    expected = structure.dimension - structure.generic_rank()
    declared = setting.spec.poisson.functions if setting.spec.poisson is not None else ()
    given = [setting.formula(function) for function in declared]
    found = independent(structure, [*known, *given])[len(known) :]
    missing, generating = "", list(range(structure.dimension))
    if len(known) + len(found) < expected:
        results, missing = _search(equations, structure, degree)
        found = independent(structure, [*known, *found, *results])[len(known) :]
        # what could be searched has rational coefficients; other tensors have no such table
        generating = PolynomialBracket(structure).generating if results else generating
    whole = len(known) + len(found)
    missing = missing if whole < expected else ""
    source = source_of_ranks(
        structure.field,
        ([structure.gradient(casimir) for casimir in (*known, *found)], whole),
        ([dict(enumerate(row)) for row in structure.tensor], structure.dimension - expected),
    )
    return Completeness(tuple(found), whole, expected, missing, tuple(generating), source)


def independent(structure: PoissonStructure, functions: Sequence[Element]) -> list[Element]:
    """Those functions whose gradients are independent of all before them at a generic point."""
    kept: list[Element] = []
    slopes: list[dict[int, Element]] = []
    for function in functions:
        slope = structure.gradient(function)
        if generic_rank(structure.field, [*slopes, slope]) == len(slopes) + 1:
            slopes.append(slope)
            kept.append(function)
    return kept


def _search(
    equations: Equations, structure: PoissonStructure, degree: int
) -> tuple[list[Element], str]:
    """Casimirs of the state, and why others are missing."""
    setting = equations.setting
    try:
        if setting.spec.algebra is None:
            search = casimirs(structure, degree)
            return list(search.generators), search.missing
        search = casimirs(momentum_algebra(setting), degree)
    except CoadjointError as error:
        return [], f"they were not looked for: {error}"
    return [_renamed(search, equations, c) for c in search.generators], search.missing


def _renamed(search: CasimirSearch, equations: Equations, casimir: Element) -> Element:
    """A function of the algebra's dual in the names of the state."""
    setting = equations.setting
    advected = [name for variable in setting.advected for name in variable.components]
    names = zip(search.structure.names, (*setting.momenta, *advected), strict=True)
    return setting.field.adopt(casimir, dict(names))


def described(field: Field, casimir: Element) -> str:
    """A Casimir as a statement shows it."""
    terms = field.terms(casimir)
    text = element_text(field, casimir) if len(terms) < SHOWN else ""
    if text and len(text) <= SHOWN:
        return text
    return f"a function with {len(terms)} terms that begins with {element_text(field, terms[0])}"
