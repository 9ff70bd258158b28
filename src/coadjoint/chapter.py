"""Chapters: a derivation with what was proved of it, what its code costs, and a picture.

Comes in: the record of a derivation, and the folder of its generated system if there is one. Goes
out: the same record with further sections. No SymPy is loaded here: what is added stands in the
generated folder. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import starmap
from pathlib import Path
from typing import Any, Final

from coadjoint.elementary import ELEMENTARY
from coadjoint.methods import OF_PATHS, list_fitting, list_kept, list_unfit, tell_order
from coadjoint.notation.numbers import shorten_numbers

#: What the kinds of claims are about, as headings of sentences.
_ABOUT: Final = {
    "equivalence": "Equality of the routes",
    "algebra": "The algebra",
    "jacobi": "The bracket",
    "bracket": "Brackets",
    "legendre": "The Legendre transform",
    "casimir": "Casimirs",
    "conserved": "Conserved quantities",
    "constraint": "The constraints",
    "rolling": "Rolling",
    "integrability": "Integrability of the constraints",
    "measure": "Invariant measure",
    "transformation": "Symmetries in time and space",
    "symmetry": "Symmetries",
    "lax": "The Lax pair",
    "momentum": "Momenta",
    "reduction": "Invariant submanifold",
    "noise": "Noise",
    "dissipation": "Dissipation",
    "attitude": "Attitudes",
    "galilean": "Galilean relativity",
    "posed": "Well-posedness",
    "integrals": "Further integrals",
}
_SIGNS: Final = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "powers"}
#: Claims from which on a method that they share is told once, and not with each.
REPEATED: Final = 3
_ON_ROUTE: Final = " on the route "
#: Before the name of an observable that is a word: a driver is conserved only as a quantity.
_WORD: Final = re.compile(r"^(?=[a-z]{2,}\w* is conserved\b)")


def complete(
    record: Mapping[str, Any], certificate: Mapping[str, Any], folder: Path | None
) -> dict[str, Any]:
    """The record of a derivation with its proofs, its cost and its references.

    Args:
        record: The fields of a `coadjoint.derive.document.Document`.
        certificate: ``claims`` and ``findings``; empty where they are not known.
        folder: Where the generated system stands, if it does.
    """
    sections = [*record["sections"]]
    if "claims" in certificate:
        sections += proof_sections(certificate)
    if folder is not None and (folder / "kernel_python.py").is_file():
        sections += _cost(folder, certificate)
    sections += _references(record)
    return {**record, "sections": sections}


def section(title: str, kind: str, **parts: Any) -> dict[str, Any]:
    """A section of words."""
    return {"title": title, "law": "", "law_latex": "", "kind": kind, **parts}


def proof_sections(certificate: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """What was proved and how: in sentences by subject, then claim by claim.

    Args:
        certificate: ``claims`` and ``findings`` as records.
    """
    claims = certificate["claims"]
    counts = Counter(claim["verdict"] for claim in claims)
    total = ", ".join(f"{number} {verdict}" for verdict, number in counts.items())
    usual = _find_usual(claims)
    if usual:
        total += f". Method, unless a claim names its own: {usual}"
    words = [
        ("" if place else about, sentence)  # the first claim names the subject
        for about, sentences in _sentences(claims, usual)
        for place, sentence in enumerate(sentences)
    ]
    for n, each in enumerate(certificate.get("findings", ())):
        how = "; ".join(filter(None, [shorten_numbers(each["method"]), each.get("scope", "")]))
        words.append(("" if n else "Found", f"{each['statement']} ({how})"))
    yield section("What was proved", "proofs", law=f"{len(claims)} claims: {total}", words=words)
    rows = [("claim", "verdict", "method")]
    rows += [
        (_WORD.sub("the quantity ", e["statement"]), e["verdict"], shorten_numbers(e["method"]))
        for e in claims
    ]
    yield section("Table of verdicts", "verdicts", rows=rows)


def _find_usual(claims: Iterable[Mapping[str, Any]]) -> str:
    """The method of most claims, which is told once; "" where there are few claims of each."""
    methods = Counter(each["method"] for each in claims).most_common(1)
    return methods[0][0] if methods and methods[0][1] >= REPEATED else ""


def _sentences(claims: Iterable[Mapping[str, Any]], usual: str) -> Iterator[tuple[str, list[str]]]:
    """For each subject its sentences; claims that differ by the route alone are one sentence."""
    subjects: dict[str, dict[tuple[str, str, str, str], list[str]]] = {}
    for claim in claims:
        statement, route, behind = _split_route(claim["statement"])
        about = _ABOUT.get(claim.get("kind", ""), claim.get("kind", "claims").capitalize())
        statement = _WORD.sub("the quantity ", statement)
        key = (statement, behind, claim["verdict"], claim["method"])
        subjects.setdefault(about, {}).setdefault(key, []).extend([route] if route else [])
    for about, entries in subjects.items():
        sentences = [
            _sentence(f"{statement}{_tell_routes(routes)}{behind}", verdict, method, usual)
            for (statement, behind, verdict, method), routes in entries.items()
        ]
        yield about, sentences


def _split_route(statement: str) -> tuple[str, str, str]:
    """What a statement says before it names a route, the route, and what it says behind it.

    >>> _split_route("it solves on the route nonholonomic: A x = b")
    ('it solves', 'nonholonomic', ': A x = b')
    """
    lead, _, rest = statement.partition(_ON_ROUTE)
    route = re.match(r"[\w-]*", rest)
    assert route is not None, "which may be empty"
    return lead, route[0], rest[route.end() :]


def _tell_routes(routes: Sequence[str]) -> str:
    """On which routes a claim holds."""
    if not routes:
        return ""
    listed = ", ".join(routes[:-1]) + " and " * (len(routes) > 1) + routes[-1]
    return f" on the route{'s' * (len(routes) > 1)} {listed}"


def _sentence(statement: str, verdict: str, method: str, usual: str) -> str:
    """A claim with its verdict and its method, unless that is the usual one."""
    told = "supported by numbers, and not proved" if verdict == "numerically supported" else verdict
    # statements are sentences, or what there is: "an invariant measure: dPi dGamma"
    how = "" if method == usual else f" Method: {shorten_numbers(method)}."
    return f"{told.capitalize()}: {statement}.{how}"


def _cost(folder: Path, certificate: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Operations of the generated code, counted in its text, and what methods keep."""
    over = certificate.get("structure", {}).get("over", "")
    words = [
        (function, "; ".join(starmap(partial(_tell_cost, over), parts.items())))
        for function, parts in count_operations(folder / "kernel_python.py").items()
    ]
    yield section(
        "Cost of the kernel",
        "cost",
        law="operations in the text of the generated functions; those of a loop count once",
        words=words,
    )
    judged = certificate.get("methods", ())
    rows = [("method", "order", "keeps exactly", "cost of a step")]
    rows += [
        (
            m["name"],
            tell_order(m["name"], m["order"]),
            ", ".join(list_kept(m)) or "nothing",
            m["cost"],
        )
        for m in list_fitting(judged)
    ]
    if rows[1:]:
        law = "those that apply, with steps of one length"
        if "noise" in certificate.get("structure", {}).get("acts", ()):
            law += f"; {OF_PATHS}"
        unfit = [(", ".join(names), why) for why, names in list_unfit(judged).items()]
        unfit = [("method", "reason"), *unfit] if unfit else []
        yield section("Methods of integration", "methods", law=law, rows=rows)
        if unfit:
            yield section("Methods that do not apply", "unfit", rows=unfit)


def _tell_cost(over: str, where: str, operations: Mapping[str, int]) -> str:
    """Operations, where they are made, in loops over equal members or over points."""
    where = where.replace("member", "point") if over == "points" else where
    if not operations:
        return where
    listed = ", ".join(f"{number} {sign}" for sign, number in sorted(operations.items()))
    total = sum(operations.values())
    return f"{total} operation{'s' * (total != 1)}{where}: {listed}"


#: Parts of functions of equal members, by the ends of their names, and for what they are made.
_PARTS: Final = (
    (re.compile(r"_(member|partners|terms_\d+)"), " for each member"),
    (re.compile(r"_end_\d+"), " at each end"),
    (re.compile(r"_factors"), " for each entry"),
    (re.compile(r"_finish"), " at last"),
)
#: What a function of entries of matrices does in addition, whose loops have no end to count to.
_PRODUCTS: Final = "products of matrices"


def count_operations(path: Path) -> dict[str, dict[str, Counter[str]]]:
    """Operations by function, and by where they are made, from the text of a module of Python.

    Of equal members the parts count that a function calls for each of them; its own operations, and
    those in places of arrays, find members and are left out.
    """
    module = ast.parse(path.read_text(encoding="utf-8"))
    functions = {each.name: each for each in module.body if isinstance(each, ast.FunctionDef)}
    counts = dict[str, dict[str, Counter[str]]]()
    for name, function in functions.items():
        if name.startswith("_"):
            continue
        found = dict[str, Counter[str]]()
        for part in functions.values():
            if where := _tell_where(name, part):
                found.setdefault(where, Counter()).update(_count(part))
        counts[name] = {w: c for w, c in (found or {"": _count(function)}).items() if c}
        if any(
            isinstance(each, ast.Name) and each.id == "_multiply" for each in ast.walk(function)
        ):
            counts[name][_PRODUCTS] = Counter()
    return {name: parts for name, parts in counts.items() if parts}


def _tell_where(name: str, part: ast.FunctionDef) -> str:
    """For what a part of a function is made; "" of another function."""
    end = part.name.removeprefix(f"_{name}")
    if end == part.name:
        return ""
    where = next((told for known, told in _PARTS if known.fullmatch(end)), "")
    has_partner = any(each.arg == "j" for each in part.args.args)
    return " for each pair" if where and has_partner else where


def _count(function: ast.FunctionDef) -> Counter[str]:
    """Operations of a function."""
    signs, left = Counter[str](), list[ast.AST]([function])
    while left:
        node = left.pop()
        left += [node.value] if isinstance(node, ast.Subscript) else ast.iter_child_nodes(node)
        if isinstance(node, ast.BinOp) and isinstance(node.left, ast.List):
            continue  # a row of zeros, of that many
        if isinstance(node, ast.BinOp) and type(node.op) in _SIGNS:
            signs[_SIGNS[type(node.op)]] += 1
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
            label = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
            if label in ELEMENTARY:
                signs[label] += 1
    return signs


def _references(record: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The sources of the system and the theorems of its routes."""
    words = [("system", each.strip()) for each in str(record["source"]).split(";") if each.strip()]
    for part in record["sections"]:
        if part.get("kind") == "principle":
            words += [("theorem", text) for name, text in part["words"] if name == "theorem"]
    if words:
        yield section("References", "references", words=words)
