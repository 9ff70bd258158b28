"""The examination of a Lie algebra: its table, its invariants, and a proof of each.

Comes in: a `LieAlgebra`. Goes out: what it is (Killing signature, solvable or semisimple, rank of
its Lie-Poisson tensor) and a Certificate: the Jacobi identity, the matrices, every Casimir found,
and whether these are all. Systems claim the same of their algebra in `coadjoint.prove.claims`.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.derive.document import Document, Section, formula_line
from coadjoint.derive.equations import algebra_bracket, symbol
from coadjoint.exact import Element, Field, element_text
from coadjoint.poisson import PoissonStructure, lie_poisson
from coadjoint.poisson.casimirs import casimirs
from coadjoint.prove.certificate import Certificate, Claim, Verdict
from coadjoint.prove.completeness import DEGREE, METHOD, Completeness, described
from coadjoint.prove.zero import CONSTANTS, Decision, decide_zero


@dataclass(frozen=True)
class Examination:
    """What was found out about an algebra.

    Attributes:
        algebra: The algebra; its constants are numbers or elements of the field.
        field: Rational functions on the dual, whose coordinates bear the names of the basis.
        signature: Signs of the Killing form (plus, minus, zero); None if parameters occur.
        properties: ``abelian``, ``nilpotent``, ``solvable``, ``semisimple``, ``unimodular``.
        rank: Rank of the Lie-Poisson tensor at a generic point.
        casimirs: Those found, and whether these are all.
        certificate: What was proved.
    """

    algebra: LieAlgebra
    field: Field
    signature: tuple[int, int, int] | None
    properties: tuple[str, ...]
    rank: int
    casimirs: Completeness
    certificate: Certificate

    def as_record(self) -> dict[str, Any]:
        """The examination as JSON values."""
        algebra = self.algebra
        return {
            "name": algebra.name,
            "dimension": algebra.dimension,
            "basis": list(algebra.basis),
            "blocks": {name: [algebra.basis[i] for i in b] for name, b in algebra.blocks.items()},
            "brackets": [
                {"pair": [algebra.basis[i], algebra.basis[j]], "value": self._text(row)}
                for (i, j), row in algebra.constants.items()
            ],
            "killing_signature": None if self.signature is None else list(self.signature),
            "properties": list(self.properties),
            "rank": self.rank,
            "casimirs": {
                "expected": self.casimirs.expected,
                "found": [element_text(self.field, c) for c in self.casimirs.found],
                "missing": self.casimirs.missing,
            },
            "claims": self.certificate.as_record()["claims"],
        }

    def document(self) -> Document:
        """The examination for people, in the formats of derivations."""
        return Document(
            f"Lie algebra {self.algebra.name}",
            f"{self.algebra.dimension} generators: {', '.join(self.algebra.basis)}.",
            "",
            "",
            (self._table(), self._invariants(), self._casimirs(), self._verdicts()),
        )

    # -- sections -------------------------------------------------------------------------

    def _table(self) -> Section:
        """The nonzero brackets."""
        basis = self.algebra.basis
        lines = tuple(
            formula_line(self.field, algebra_bracket(basis[i], basis[j]), self._element(row))
            for (i, j), row in self.algebra.constants.items()
        )
        law = "[e_i, e_j] = c_ij^k e_k, other pairs commute"
        return Section("Brackets", law, r"[e_i, e_j] = c_{ij}^k e_k", lines)

    def _invariants(self) -> Section:
        """Numbers and words."""
        signature = (
            "depends on the parameters"
            if self.signature is None
            else "{} plus, {} minus, {} zero".format(*self.signature)
        )
        facts = {
            "Killing form": signature,
            "properties": ", ".join(self.properties) or "none of those looked for",
            "rank of the Lie-Poisson tensor": f"{self.rank}, so {self.casimirs.expected} "
            "independent Casimirs",
        }
        law = "K_ij = tr(ad e_i ad e_j)"
        return Section(
            "Invariants",
            law,
            r"K_{ij} = \operatorname{tr}(\mathrm{ad}_{e_i} \mathrm{ad}_{e_j})",
            (),
            tuple(facts.items()),
        )

    def _casimirs(self) -> Section:
        """The Casimirs, written in the coordinates that the basis gives the dual."""
        lines = tuple(
            formula_line(self.field, symbol(f"C{n}"), casimir)
            for n, casimir in enumerate(self.casimirs.found, 1)
        )
        law = "{mu_i, C} = c_ij^k mu_k dC/dmu_j = 0"
        latex = r"c_{ij}^k \mu_k \, \partial C / \partial \mu_j = 0"
        return Section("Casimirs", law, latex, lines)

    def _verdicts(self) -> Section:
        """The claims with their verdicts."""
        words = tuple(
            (str(claim.verdict), f"{claim.statement} ({claim.method})")
            for claim in self.certificate.claims
        )
        return Section("Proofs", "every claim and how it was decided", "", (), words)

    def _element(self, row: Any) -> Element:
        """A bracket as an element: a sum of basis names."""
        terms = (self.field[self.algebra.basis[k]] * c for k, c in row.items())
        return sum(terms, self.field.zero)

    def _text(self, row: Any) -> str:
        return element_text(self.field, self._element(row))


def examine(algebra: LieAlgebra, degree: int = DEGREE) -> Examination:
    """Find out what an algebra is, and prove it.

    Args:
        algebra: Named or declared; constants may hold parameters.
        degree: Up to which degree polynomial Casimirs are looked for.

    Raises:
        LimitError: The search would take more than docs/limits.md allows.

    >>> from coadjoint.algebra import algebra_by_name
    >>> found = examine(algebra_by_name("se(3)"))
    >>> [element_text(found.field, casimir) for casimir in found.casimirs.found]
    ['P1^2 + P2^2 + P3^2', 'J1*P1 + J2*P2 + J3*P3']
    """
    field = Field([*algebra.basis, *_parameters(algebra)])
    local = algebra.over(field.adopt)
    structure = lie_poisson(local, field, local.basis)
    known = _search(algebra, structure, degree)
    return Examination(
        local,
        field,
        None if _parameters(algebra) else local.killing_signature(),
        _properties(local),
        structure.generic_rank(),
        known,
        Certificate(algebra.name, tuple(_claims(local, structure, known))),
    )


def _search(algebra: LieAlgebra, structure: PoissonStructure, degree: int) -> Completeness:
    """The Casimirs of an algebra; with parameters in the constants there is no search."""
    expected = structure.dimension - structure.generic_rank()
    if _parameters(algebra):
        return Completeness(
            (), 0, expected, "the constants hold parameters, so none was looked for"
        )
    search = casimirs(algebra, degree)
    found = tuple(map(structure.field.adopt, search.generators))
    return Completeness(found, len(found), expected, search.missing)


def _parameters(algebra: LieAlgebra) -> list[str]:
    """Names of the parameters in the constants."""
    held = (
        value
        for row in (*algebra.constants.values(), *algebra.matrices)
        for value in row.values()
        if not isinstance(value, int | Fraction)
    )
    names = {str(symbol): None for value in held for symbol in value.factors.ring.symbols}
    return list(names)


def _properties(algebra: LieAlgebra) -> tuple[str, ...]:
    """What books call such an algebra."""
    tests = {
        "abelian": algebra.is_abelian,
        "nilpotent": algebra.is_nilpotent,
        "solvable": algebra.is_solvable,
        "semisimple": algebra.is_semisimple,
        "unimodular": algebra.is_unimodular,
    }
    return tuple(name for name, test in tests.items() if test())


def _claims(
    algebra: LieAlgebra, structure: PoissonStructure, known: Completeness
) -> Iterator[Claim]:
    """The claims about an algebra, examined one after the other."""
    yield _timed(f"{algebra.name} satisfies the Jacobi identity", "algebra", algebra.check_jacobi)
    if algebra.matrices:
        yield _timed(
            f"the matrices of {algebra.name} commute like its basis",
            "algebra",
            algebra.check_matrices,
        )
    for casimir in known.found:
        start = perf_counter()
        decision = decide_zero(structure.casimir_defects(casimir), structure.field)
        yield _claim(
            f"{described(structure.field, casimir)} is a Casimir",
            "casimir",
            decision,
            perf_counter() - start,
        )
    yield _claim(known.statement, "casimir", Decision(Verdict.PROVED, METHOD), 0.0)


def _timed(statement: str, kind: str, check: Any) -> Claim:
    """A claim whose check raises if it fails."""
    start = perf_counter()
    check()
    seconds = perf_counter() - start
    return _claim(statement, kind, Decision(Verdict.PROVED, CONSTANTS), seconds)


def _claim(statement: str, kind: str, decision: Decision, seconds: float) -> Claim:
    return Claim(
        statement,
        kind,
        decision.verdict,
        decision.method,
        seconds,
        decision.point,
        decision.defect,
    )
