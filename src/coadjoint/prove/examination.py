"""The examination of a Lie algebra: its table, its invariants, and a proof of each.

Comes in: a `LieAlgebra`. Goes out: what it is (Killing signature, solvable or semisimple, rank of
its Lie-Poisson tensor) and a Certificate: the Jacobi identity, the matrices, every Casimir found,
and whether these are all. Systems claim the same of their algebra in `coadjoint.prove.claims`.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.algebra.matrices import convert_entries
from coadjoint.derive.document import Document
from coadjoint.derive.lines import Line, Section, formula, formula_line, whole_line
from coadjoint.derive.records import algebra_bracket, symbol
from coadjoint.errors import check_type
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.numbers import parameters_in, room_for
from coadjoint.exact.ranks import CHANCE
from coadjoint.poisson import PoissonStructure, lie_poisson
from coadjoint.poisson.casimirs import search_summands
from coadjoint.prove.certificate import Certificate, Claim, Finding, Verdict
from coadjoint.prove.completeness import DEGREE, Completeness, describe, scope_of
from coadjoint.prove.zero import CONSTANTS, Decision, decide_zero, make_entry, prove_by_normal_form

#: Columns of text that a table of brackets may take.
TABLE = 94
#: Terms of a Casimir that a document shows; those of so(8) have up to 3360, and to set them as
#: formulas takes longer than to find them.
TERMS = 60
#: The bracket of two members of the basis that commute.
COMMUTE = Line(".", r"\cdot", "<math><mo>&#xB7;</mo></math>", "dot.op")


@dataclass(frozen=True)
class Examination:
    """What was found out about an algebra.

    Attributes:
        algebra: The algebra; its constants are numbers or elements of the field.
        field: Rational functions on the dual, whose coordinates bear the names of the basis.
        signature: Signs of the Killing form (plus, minus, zero); None if parameters occur.
        properties: ``abelian``, ``nilpotent``, ``solvable``, ``semisimple``, ``unimodular``.
        center: A basis of what commutes with everything, written as the brackets are.
        derived_series: Dimensions of g, [g, g], ... until they repeat or vanish.
        rank: Rank of the Lie-Poisson tensor at a generic point.
        casimirs: Those found, and whether these are all.
        certificate: What was proved.
    """

    algebra: LieAlgebra
    field: Field
    signature: tuple[int, int, int] | None
    properties: tuple[str, ...]
    center: tuple[Element, ...]
    derived_series: tuple[int, ...]
    rank: int
    casimirs: Completeness
    certificate: Certificate

    def __repr__(self) -> str:
        facts = f"Lie-Poisson rank {self.rank}, {len(self.casimirs.found)} Casimirs found"
        return f"<Examination of {self.algebra.name}: {facts}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_examination

        return show_examination(self)

    def as_record(self) -> dict[str, Any]:
        """The examination as JSON values; the README says what each key holds."""
        algebra = self.algebra
        return {
            "name": algebra.name,
            "dimension": algebra.dimension,
            "basis": list(algebra.basis),
            "blocks": {name: [algebra.basis[i] for i in b] for name, b in algebra.blocks.items()},
            "brackets": [
                {"pair": [algebra.basis[i], algebra.basis[j]], "value": self._text(value)}
                for (i, j), value in self.brackets().items()
            ],
            "killing_signature": None if self.signature is None else list(self.signature),
            "properties": list(self.properties),
            "center": list(map(self._text, self.center)),
            "derived_series": list(self.derived_series),
            "rank": self.rank,
            "casimirs": {
                "expected": self.casimirs.expected,
                "found": list(map(self._text, self.casimirs.found)),
                "missing": self.casimirs.missing,
            },
            "claims": self.certificate.as_record()["claims"],
            "findings": self.certificate.as_record()["findings"],
        }

    def brackets(self) -> dict[tuple[int, int], Element]:
        """The nonzero brackets ``[e_i, e_j]``, i < j, as sums of names of the basis."""
        return _list_brackets(self.algebra, self.field)

    def document(self) -> Document:
        """The examination for people, in the formats of derivations."""
        algebra = self.algebra
        blocks = "; ".join(
            f"{name} = {', '.join(algebra.basis[i] for i in members)}"
            for name, members in algebra.blocks.items()
            if len(members) < algebra.dimension
        )
        return Document(
            title=f"Lie algebra {algebra.name}",
            about=f"{_count_in_words(algebra.dimension, 'generator')}: {', '.join(algebra.basis)}.",
            source="",
            description=f"Blocks: {blocks}." if blocks else "",
            sections=(
                write_brackets(self.algebra, self.field),
                self._invariants(),
                self._casimirs(),
                self._verdicts(),
            ),
        )

    # -- sections -------------------------------------------------------------------------

    def _invariants(self) -> Section:
        """Numbers and words, each with the way it was found."""
        signature = (
            "not counted, since the constants contain parameters"
            if self.signature is None
            else "{} positive, {} negative, {} zero (squares of its diagonal form)".format(
                *self.signature
            )
        )
        generic = "" if self.signature else ", for almost all values of the parameters"
        center = ", ".join(map(self._text, self.center)) or "zero"
        properties = ", ".join(self.properties) or "not abelian, solvable or unimodular"
        facts = {
            "Killing form": signature,
            "properties": properties + generic,
            "center": f"{center} (exact kernel of ad{generic})",
            "derived series": f"dimensions {', '.join(map(str, self.derived_series))}"
            f"{', [g, g] = g' if len(self.derived_series) == 1 else ''}{generic}",
            "Lie-Poisson rank": self._rank(),
        }
        law = "K_ij = tr(ad_e_i ad_e_j) is the Killing form; ad_xi eta = [xi, eta]"
        latex = r"K_{ij} = \operatorname{tr}(\mathrm{ad}_{e_i} \, \mathrm{ad}_{e_j})"
        return Section(
            title="Invariants", law=law, law_latex=latex, lines=(), words=tuple(facts.items())
        )

    def _rank(self) -> str:
        """The rank: certain where there are as many Casimirs as it leaves room for."""
        count = _count_in_words(self.casimirs.expected, "independent Casimir")
        if isinstance(self.casimirs.decision, Decision):
            return f"{self.rank}, so {count} {self.casimirs.scope}"
        return (
            f"{self.rank} {self.casimirs.source}, so {count} {self.casimirs.scope} "
            f"({self.casimirs.error})"
        )

    def _casimirs(self) -> Section:
        """The Casimirs, written in the coordinates that the basis gives the dual."""
        law = "c_ij^k mu_k dC/dmu_j = 0; the coordinate mu_i of the dual bears the name of e_i"
        latex = r"c_{ij}^k \, \mu_k \, \partial C / \partial \mu_j = 0"
        lines, words = [], []
        for n, casimir in enumerate(self.casimirs.found, 1):
            name = symbol(f"casimir{n}")
            if len(self.field.terms(casimir)) > TERMS:
                told = f"{describe(self.field, casimir)}; as JSON it is there in full"
                words.append((name.text, told))
            else:
                lines.append(formula_line(self.field, name, casimir))
        if not self.casimirs.found:
            words.append(("none", self.casimirs.statement))
        return Section(
            title="Casimirs", law=law, law_latex=latex, lines=tuple(lines), words=tuple(words)
        )

    def _verdicts(self) -> Section:
        """The claims with their verdicts, then what was found."""
        claims = (
            (str(claim.verdict), f"{claim.statement} ({claim.method})")
            for claim in self.certificate.claims
        )
        findings = (
            ("found", f"{each.statement}, {each.scope} ({each.method}; {each.error})")
            for each in self.certificate.findings
        )
        law = "every claim and how it was decided, and what was found without a proof"
        return Section(title="Proofs", law=law, law_latex="", lines=(), words=(*claims, *findings))

    def _text(self, element: Element) -> str:
        return element_text(self.field, element)


def write_brackets(algebra: LieAlgebra, field: Field) -> Section:
    """The brackets: as a table where that fits on a page, else one by one.

    Args:
        algebra: With constants in the field.
        field: As of an `Examination`.
    """
    title, law = "Brackets", "[e_i, e_j] = c_ij^k e_k"
    latex = r"[e_i, e_j] = c_{ij}^k \, e_k"
    values, basis = _list_brackets(algebra, field), algebra.basis
    if not values:
        words = (("abelian", "all brackets are zero"),)
        return Section(title=title, law=law, law_latex=latex, lines=(), words=words)
    turned = {(j, i): -value for (i, j), value in values.items()}
    cells = {pair: formula(field, value) for pair, value in {**values, **turned}.items()}
    heads = tuple(map(_head, basis))
    widest = max(len(cell.text) for cell in (*(cells[pair] for pair in values), *heads)) + 2
    if (len(basis) + 1) * widest <= TABLE:
        law += ", e_i at the left of a row, e_j above a column"
        places = range(len(basis))
        rows = [(heads[i], *(cells.get((i, j), COMMUTE) for j in places)) for i in places]
        table = ((Line("", "", "", ""), *heads), *rows)
        return Section(title=title, law=law, law_latex=latex, lines=(), table=table)
    lines = tuple(
        formula_line(field, algebra_bracket(basis[i], basis[j]), value)
        for (i, j), value in values.items()
    )
    law += "; pairs left out commute"
    return Section(title=title, law=law, law_latex=latex, lines=lines)


def _list_brackets(algebra: LieAlgebra, field: Field) -> dict[tuple[int, int], Element]:
    """The nonzero brackets ``[e_i, e_j]``, i < j, as sums of names of the basis."""
    rows = algebra.constants.items()
    return {pair: _vector(field, algebra.basis, row) for pair, row in rows}


def take_field(algebra: LieAlgebra) -> tuple[LieAlgebra, Field]:
    """An algebra with its constants in the field of rational functions on its dual."""
    field = Field([*algebra.basis, *_parameters(algebra)], slots=_room(algebra))
    return algebra.over(field.adopt), field


def _head(name: str) -> Line:
    """A name of the basis at the edge of the table."""
    return whole_line(symbol(name))


def _count_in_words(number: int, noun: str) -> str:
    """A count in words."""
    return f"{number or 'no'} {noun}{'' if number == 1 else 's'}"


def _vector(field: Field, basis: Sequence[str], row: Mapping[int, Any]) -> Element:
    """A vector of the algebra as a sum of names of its basis."""
    own = convert_entries(row, field.adopt)
    return field.sum(field[basis[k]] * c for k, c in own.items())


def examine(algebra: LieAlgebra, degree: int = DEGREE) -> Examination:
    """Find out what an algebra is, and prove it.

    Args:
        algebra: Named or declared; constants may hold parameters.
        degree: Up to which degree polynomial Casimirs are searched for.

    >>> from coadjoint.algebra import algebra_by_name
    >>> found = examine(algebra_by_name("se(3)"))
    >>> [element_text(found.field, casimir) for casimir in found.casimirs.found]
    ['J1*P1 + J2*P2 + J3*P3', 'P1^2 + P2^2 + P3^2']
    """
    check_type("examine", algebra, LieAlgebra, 'coadjoint.algebra_by_name("so(3)")')
    local, field = take_field(algebra)
    structure = lie_poisson(local, field, local.basis)
    known = _search(algebra, structure, degree)
    claims, findings = _entries(algebra, structure, known)
    return Examination(
        algebra=local,
        field=field,
        signature=None if _parameters(algebra) else algebra.killing_signature(),
        properties=_properties(algebra),
        center=tuple(
            _vector(field, algebra.basis, dict(enumerate(row))) for row in algebra.center()
        ),
        derived_series=algebra.derived_series(),
        rank=structure.generic_rank(),
        casimirs=known,
        certificate=Certificate(algebra.name, claims, findings),
    )


def _search(algebra: LieAlgebra, structure: PoissonStructure, degree: int) -> Completeness:
    """The Casimirs of an algebra; a summand whose constants hold parameters is not searched."""
    search = search_summands(structure, algebra, degree)
    known = len(search.generators)
    scope = scope_of(structure, search.generators)
    return Completeness(
        found=search.generators,
        known=known,
        expected=search.expected,
        missing=search.missing,
        error=CHANCE if search.missing else "",
        degree=search.degree,
        scope=scope,
    )


def _irrational(algebra: LieAlgebra) -> list[Any]:
    """The constants and entries of matrices that are not rational."""
    rows: list[Mapping[Any, Any]] = [*algebra.constants.values(), *algebra.matrices]
    values = (value for row in rows for value in row.values())
    return [value for value in values if not isinstance(value, int | Fraction)]


def _parameters(algebra: LieAlgebra) -> list[str]:
    """Names of the parameters in the constants."""
    held = map(parameters_in, _irrational(algebra))
    return list(dict.fromkeys(name for names in held for name in names))


def _room(algebra: LieAlgebra) -> int:
    """How many functions a field needs for the irrational numbers in the constants."""
    return max(map(room_for, _irrational(algebra)), default=0)


def _properties(algebra: LieAlgebra) -> tuple[str, ...]:
    """What books call such an algebra."""
    tests = {
        "abelian": algebra.is_abelian,
        "nilpotent": algebra.is_nilpotent,
        "solvable": algebra.is_solvable,
        "semisimple": algebra.is_semisimple,
        "unimodular": algebra.is_unimodular,
    }
    return tuple(name for name, holds in tests.items() if holds)


def _entries(
    algebra: LieAlgebra, structure: PoissonStructure, known: Completeness
) -> tuple[tuple[Claim, ...], tuple[Finding, ...]]:
    """Claims and findings about an algebra."""
    entries = list(_examine(algebra, structure, known))
    claims = tuple(entry for entry in entries if isinstance(entry, Claim))
    return claims, tuple(entry for entry in entries if isinstance(entry, Finding))


def _examine(
    algebra: LieAlgebra, structure: PoissonStructure, known: Completeness
) -> Iterator[Claim | Finding]:
    """Everything about an algebra, examined one after the other."""
    yield _time_check(f"{algebra.name} satisfies the Jacobi identity", algebra.check_jacobi)
    if algebra.matrices:
        yield _time_check(
            f"the matrices of {algebra.name} commute like its basis", algebra.check_matrices
        )
    refuted = 0
    for casimir in known.found:
        start = perf_counter()
        decision = _is_casimir(structure, casimir)
        refuted += decision.verdict is not Verdict.PROVED
        statement = f"{describe(structure.field, casimir)} is a Casimir"
        yield make_entry(statement, "casimir", decision, perf_counter() - start)
    if not refuted:
        yield make_entry(known.statement, "casimir", known.decision, 0.0)


def _is_casimir(structure: PoissonStructure, function: Element) -> Decision:
    """Whether a function commutes with all; the point where it does not is searched for if so."""
    if structure.is_casimir(function):
        return prove_by_normal_form(structure.field)
    return decide_zero(structure.casimir_defects(function), structure.field)


def _time_check(statement: str, check: Callable[[], object]) -> Claim | Finding:
    """A claim about constants whose check raises if it fails."""
    start = perf_counter()
    check()
    decision = Decision(verdict=Verdict.PROVED, method=CONSTANTS)
    return make_entry(statement, "algebra", decision, perf_counter() - start)
