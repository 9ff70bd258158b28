"""A chapter tells what was proved, what the code costs, and where it comes from."""

from __future__ import annotations

import re

from coadjoint.chapter import complete, count_operations
from coadjoint.files import read_certificate
from coadjoint.render.document import render_document
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
    """With the routes listed, and another verdict in other words; the subject stands once."""
    claim = {"kind": "legendre", "verdict": "proved", "method": "normal form"}
    claims = [claim | {"statement": f"dh/dmu = xi on the route {r}"} for r in ("a", "b", "c")]
    claims.append(claim | {"statement": "q > 0", "verdict": "refuted"})
    claims[-1]["method"] = "the value 7 at x = 1/3"
    shown = by_kind(complete(RECORD, {"claims": claims}, None))
    assert shown["proofs"]["words"] == [
        (
            "The Legendre transform",
            "Proved: dh/dmu = xi on the routes a, b and c.",
        ),
        ("", "Refuted: q > 0. Method: the value 7 at x = 1/3."),
    ]
    claims = [claim | {"verdict": "numerically supported", "statement": "q is kept"}]
    ((_, text),) = by_kind(complete(RECORD, {"claims": claims}, None))["proofs"]["words"]
    assert text == "Supported by numbers, and not proved: q is kept. Method: normal form."
    assert shown["proofs"]["law"] == (
        "4 claims: 3 proved, 1 refuted. Method, unless a claim names its own: normal form"
    )
    assert len(shown["verdicts"]["rows"]) == 5


def test_numbers_of_methods_are_told_in_few_digits():
    """In sentences, in the table and of findings; the certificate keeps all of them."""
    own = {"method": "the value 0.0977644349517698 at x = -3.0000000001", "verdict": "refuted"}
    claim = own | {"statement": "q = 0", "kind": "algebra"}
    shown = by_kind(complete(RECORD, {"claims": [claim], "findings": [claim]}, None))
    told = "a value of about 0.09776 at x ~= -3"
    assert shown["proofs"]["words"] == [
        ("The algebra", f"Refuted: q = 0. Method: {told}."),
        ("Found", f"q = 0 ({told})"),
    ]
    assert shown["verdicts"]["rows"][1] == ("q = 0", "refuted", told)
    assert "0.0977644349517698" in claim["method"]


def test_an_observable_that_is_a_word_is_told_to_be_a_quantity():
    """A driver is not conserved, but the quantity of this name; symbols and "the energy" stay."""
    claim = {"kind": "conserved", "verdict": "proved", "method": "normal form"}
    given = ["driver is conserved", "the energy is conserved", "J is conserved", "dot(m, m) is one"]
    claims = [claim | {"statement": each} for each in given]
    shown = by_kind(complete(RECORD, {"claims": claims}, None))
    told = [text.split(": ")[1].rstrip(".") for _, text in shown["proofs"]["words"]]
    assert told == ["the quantity driver is conserved", *given[1:]]
    assert [row[0] for row in shown["verdicts"]["rows"][1:]] == told


def test_what_stands_behind_a_route_is_no_name_of_it():
    """The routes are listed, and what is said of both comes once."""
    claim = {"kind": "legendre", "verdict": "proved", "method": "normal form"}
    claims = [claim | {"statement": f"it solves on the route {r}: A x = b"} for r in "ab"]
    ((_, text),) = by_kind(complete(RECORD, {"claims": claims}, None))["proofs"]["words"]
    assert text == "Proved: it solves on the routes a and b: A x = b. Method: normal form."


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
    operations = {"*": 1, "-": 1, "/": 1, "asin": 1, "sqrt": 1}
    assert count_operations(module) == {"rhs": {"": operations}}
    folder = systems_folder() / "heavy_top"
    shown = by_kind(complete(RECORD, read_certificate(folder / "certificate.json"), folder))
    assert "rhs" in dict(shown["cost"]["words"])
    assert shown["methods"]["rows"][0][0] == "method"


def test_the_cost_of_members_is_that_of_their_parts(tmp_path):
    """Places of arrays and the loop are no cost; a part of two members is that of a pair."""
    module = tmp_path / "kernel_python.py"
    module.write_text(
        "def rhs(state, parameters, sizes):\n    return [0.0] * (2 * sizes[0] - 1)\n"
        "def _rhs_member(state, parameters, sums, i, size):\n"
        "    x = state[2 * size + (i - 1) % size]\n    return x * x + sums[0][i]\n"
        "def _rhs_partners(state, parameters, i, j, size):\n    return state[i] - state[j]\n"
        "def _rhs_finish(state, parameters, sums, i, size):\n    return (sums[0][0] / 2.0,)\n"
        "def _add(sums, i, terms):\n    return terms + 1\n"
    )
    assert count_operations(module) == {
        "rhs": {
            " for each member": {"*": 1, "+": 1},
            " for each pair": {"-": 1},
            " at last": {"/": 1},
        }
    }
    (words,) = (part["words"] for part in complete(RECORD, {}, tmp_path)["sections"][1:2])
    told = "2 operations for each member: 1 *, 1 +; 1 operation for each pair: 1 -; "
    assert words == [("rhs", told + "1 operation at last: 1 /")]
    field = complete(RECORD, {"structure": {"over": "points"}}, tmp_path)["sections"]
    ((_, told),) = field[1]["words"]
    assert told.startswith("2 operations for each point: 1 *, 1 +;")


WORDS = {"add": "+-", "multiply": "*", "divide": "/"}


def test_counts_are_those_of_what_was_lowered():
    """Of each function without ends, pairs and sums: the docstring of the kernel has them."""
    compared = 0
    for path in sorted(systems_folder().glob("*/kernel_python.py")):
        counts, text = count_operations(path), path.read_text()
        for name, told in re.findall(
            r'^def ([a-z]\w*)\([^)]*\):\n    """(.*?)"""', text, re.M | re.S
        ):
            parts = counts.get(name, {"": {}})
            if set(parts) not in ({""}, {" for each member"}) or "Operations" not in told:
                continue
            (own,) = parts.values()
            for word, signs in WORDS.items():
                lowered = sum(map(int, re.findall(rf"(\d+) {word}", told)))
                assert sum(own.get(sign, 0) for sign in signs) == lowered, (path, name, word)
                compared += lowered > 0
    assert compared > 300


def test_methods_that_do_not_apply_are_told_apart():
    """They keep nothing, which is no news; those that apply come in the order of preference."""
    judged = {
        "order": 2,
        "exactly": [],
        "is_poisson": False,
        "rank": 0,
        "decides": "no",
        "cost": "",
    }
    methods = [
        judged | {"name": "kahan"},
        judged | {"name": "rk", "cost": "a stage"},
        judged | {"name": "midpoint", "cost": "a sweep", "rank": 1, "is_poisson": True},
        judged | {"name": "gauss4"},
    ]
    shown = by_kind(complete(RECORD, {"methods": methods}, systems_folder() / "heavy_top"))
    assert shown["methods"]["rows"][1:] == [
        ("midpoint", "2", "Poisson tensor", "a sweep"),
        ("rk", "2", "nothing", "a stage"),
    ]
    assert shown["unfit"]["rows"][1:] == [("kahan, gauss4", "no")]
    record = RECORD | {"sections": []}
    text = render_document(complete(record, {"methods": methods}, systems_folder() / "heavy_top"))
    assert "midpoint  2      Poisson tensor  a sweep" in text
