"""The examination of an algebra agrees with books, and finds what was spoiled."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from coadjoint.algebra import LieAlgebra, algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact import element_text
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.examination import TERMS, examine

#: name: (Killing signature, properties, center, derived series, rank, Casimirs), from books.
KNOWN = {
    "so(3)": ((0, 3, 0), {"semisimple", "unimodular"}, [], (3,), 2, ["J1^2 + J2^2 + J3^2"]),
    "se(2)": ((0, 1, 2), {"solvable", "unimodular"}, [], (3, 2, 0), 2, ["P1^2 + P2^2"]),
    "sl(2,R)": ((2, 1, 0), {"semisimple", "unimodular"}, [], (3,), 2, ["H^2 + 4*X*Y"]),
    "h(1)": ((0, 0, 3), {"nilpotent", "solvable", "unimodular"}, ["C"], (3, 1, 0), 2, ["C"]),
    "aff(1)": ((1, 0, 1), {"solvable"}, [], (2, 1, 0), 2, []),
    "R^2": (
        (0, 0, 2),
        {"abelian", "nilpotent", "solvable", "unimodular"},
        ["P1", "P2"],
        (2, 0),
        0,
        ["P1", "P2"],
    ),
}


@pytest.fixture(scope="module")
def so8():
    """The examination of so(8)."""
    return examine(algebra_by_name("so(8)"))


@pytest.mark.parametrize("name", KNOWN)
def test_invariants_are_those_of_books(name):
    """Signature, properties, center, series, rank and Casimirs of the small algebras."""
    signature, properties, center, series, rank, casimirs = KNOWN[name]
    found = examine(algebra_by_name(name))
    assert found.signature == signature
    assert set(found.properties) == properties
    assert [element_text(found.field, vector) for vector in found.center] == center
    assert found.derived_series == series
    assert found.rank == rank
    assert [element_text(found.field, c) for c in found.casimirs.found] == casimirs
    assert found.casimirs.expected == found.algebra.dimension - rank


@pytest.mark.parametrize("name", ["so(4)", "se(3)", "su(3)", "sp(4)", "g(3)", "gl(2)"])
def test_every_claim_is_proved(name):
    """Jacobi identity, matrices, each Casimir and their number, none refuted and none left out."""
    found = examine(algebra_by_name(name))
    claims = found.certificate.claims
    assert found.certificate.holds
    assert {claim.verdict for claim in claims} == {Verdict.PROVED}
    assert len(claims) == 3 + len(found.casimirs.found)
    assert len(found.casimirs.found) == found.casimirs.expected
    assert found.casimirs.missing == ""


def test_one_changed_constant_is_refused():
    """se(3) with [J1, P2] = -P3 violates the Jacobi identity: triple and defect are named."""
    se3 = algebra_by_name("se(3)")
    pair = se3.basis.index("J1"), se3.basis.index("P2")
    spoiled = {**se3.constants, pair: {se3.basis.index("P3"): -1}}
    with pytest.raises(AlgebraError, match=r"\[J1, \[J2, P2\]\] \+ cyclic = \(2\) P1") as caught:
        LieAlgebra("spoiled", se3.basis, spoiled)
    assert caught.value.triple == [0, 1, 4]


def test_matrices_of_another_algebra_are_refused():
    """An algebra whose matrices commute otherwise is not examined."""
    so3 = algebra_by_name("so(3)")
    swapped = (so3.matrices[1], so3.matrices[0], so3.matrices[2])
    with pytest.raises(AlgebraError, match="J1 and J2") as caught:
        examine(replace(so3, matrices=swapped))
    assert caught.value.pair == ["J1", "J2"]


def test_a_false_casimir_is_refuted(monkeypatch):
    """The check of Casimirs can fail: one that the search should not have found is refuted."""
    from coadjoint.prove import examination

    def liar(structure, algebra, degree):
        true = search(structure, algebra, degree)
        wrong = replace(true.summands[0], generators=(true.structure.field["J1"],))
        return replace(true, summands=(wrong,))

    search = examination.search_summands
    monkeypatch.setattr(examination, "search_summands", liar)
    certificate = examine(algebra_by_name("so(3)")).certificate
    (refuted,) = certificate.refuted
    assert refuted.statement == "J1 is a Casimir"
    assert refuted.counterexample
    assert refuted.defect != "0"
    assert not any("every Casimir" in claim.statement for claim in certificate.claims)


def test_missing_casimirs_are_told():
    """What a search to degree 1 leaves out is found and not proved, with what was searched."""
    found = examine(algebra_by_name("se(3)"), 1)
    assert found.casimirs.found == ()
    (finding,) = found.certificate.findings
    assert finding.statement.startswith("0 of 2 independent Casimirs are known: 2 not found")
    assert found.casimirs.missing in finding.statement
    assert "probability below" in finding.error
    assert ("found", finding.statement) in [
        (head, text.partition(", near")[0]) for head, text in found.document().sections[-1].words
    ]


def test_table_and_list_hold_the_same_brackets():
    """The table of so(4) has each bracket twice, with both signs, and zero elsewhere."""
    found = examine(algebra_by_name("so(4)"), 2)
    table = found.document().sections[0].table
    heads = [cell.text for cell in table[0][1:]]
    values = {
        (row[0].text, head): cell.text
        for row in table[1:]
        for head, cell in zip(heads, row[1:], strict=True)
    }
    assert len(values) == 36
    for entry in found.as_record()["brackets"]:
        a, b = entry["pair"]
        negative = entry["value"][1:] if entry["value"][0] == "-" else f"-{entry['value']}"
        assert (values[a, b], values[b, a]) == (entry["value"], negative)
    assert sum(value != "." for value in values.values()) == 2 * len(found.algebra.constants)


def test_long_casimirs_are_described_in_documents_and_whole_in_records(so8):
    """Casimirs of so(8) have up to 3360 terms: the page says so, the record has them all."""
    section = so8.document().sections[2]
    record = so8.as_record()["casimirs"]["found"]
    terms = [len(re.split(" [+-] ", casimir)) for casimir in record]
    assert len(terms) == 4
    assert len(section.lines) == sum(count <= TERMS for count in terms)
    told = [f"a function with {count} terms" for count in terms if count > TERMS]
    assert len(told) == len(section.words) > 0
    for text, (_, words) in zip(told, section.words, strict=True):
        assert text in words


def test_large_algebras_are_listed(so8):
    """The 168 brackets of so(8) are lines, since a table of 28 columns fits no page."""
    section = so8.document().sections[0]
    assert (len(section.lines), section.table) == (168, ())
    assert "pairs left out commute" in section.law
