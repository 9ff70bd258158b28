"""A chapter tells what was proved, what the code costs, and where it comes from."""

from __future__ import annotations

from coadjoint.chapter import complete, count_operations
from coadjoint.files import read_certificate
from coadjoint.resources import systems_folder

RECORD = {
    "title": "T",
    "about": "A.",
    "source": "Holm (2011); Euler (1765)",
    "description": "",
    "sections": [
        {"title": "Principle", "kind": "principle", "words": [("theorem", "Holm 2011, 9.1")]}
    ],
}


def by_kind(record):
    """The sections by their kinds."""
    return {part["kind"]: part for part in record["sections"]}


def test_claims_that_differ_by_the_route_are_one_sentence():
    """With the routes listed, and another verdict in other words."""
    claim = {"kind": "legendre", "verdict": "proved", "method": "normal form"}
    claims = [claim | {"statement": f"dh/dmu = xi on the route {r}"} for r in ("a", "b", "c")]
    claims.append(claim | {"statement": "q > 0", "verdict": "refuted"})
    shown = by_kind(complete(RECORD, {"claims": claims}, None))
    ((about, text),) = shown["proofs"]["words"]
    assert about == "The Legendre transform"
    assert "It is proved that dh/dmu = xi on the routes a, b and c. Method: normal form." in text
    assert "It is refuted that q > 0" in text
    assert shown["proofs"]["law"] == "4 claims: 3 proved, 1 refuted"
    assert len(shown["verdicts"]["rows"]) == 5


def test_references_are_sources_and_theorems():
    """Each source by itself."""
    words = by_kind(complete(RECORD, {}, None))["references"]["words"]
    assert words == [
        ("system", "Holm (2011)"),
        ("system", "Euler (1765)"),
        ("theorem", "Holm 2011, 9.1"),
    ]


def test_the_cost_is_counted_in_the_text(tmp_path):
    """Operations of a module that was written by hand, and of a generated one."""
    module = tmp_path / "kernel_python.py"
    module.write_text("def rhs(a, b):\n    c = sqrt(a) * b\n    return c - asin(a) / b\n")
    assert count_operations(module) == {"rhs": {"*": 1, "-": 1, "/": 1, "asin": 1, "sqrt": 1}}
    folder = systems_folder() / "heavy_top"
    shown = by_kind(complete(RECORD, read_certificate(folder / "certificate.json"), folder))
    assert "rhs" in dict(shown["cost"]["words"])
    assert shown["methods"]["rows"][0][0] == "method"
