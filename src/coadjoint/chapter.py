"""Chapters: a derivation with what was proved of it, what its code costs, and a picture.

Comes in: the record of a derivation, and the folder of its generated system if there is one. Goes
out: the same record with further sections. No SymPy is loaded here: what is added stands in the
generated folder. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from coadjoint.elementary import ELEMENTARY

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
_ON_ROUTE: Final = " on the route "


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
        sections += _proofs(certificate)
    if folder is not None and (folder / "kernel_python.py").is_file():
        sections += _cost(folder, certificate)
    sections += _references(record)
    return {**record, "sections": sections}


def section(title: str, kind: str, **parts: Any) -> dict[str, Any]:
    """A section of words."""
    return {"title": title, "law": "", "law_latex": "", "kind": kind, **parts}


def _proofs(certificate: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """What was proved and how: in sentences by subject, then claim by claim."""
    claims = certificate["claims"]
    counts = Counter(claim["verdict"] for claim in claims)
    total = ", ".join(f"{number} {verdict}" for verdict, number in counts.items())
    words = [(about, " ".join(sentences)) for about, sentences in _sentences(claims)]
    words += [
        (
            "Found",
            f"{each['statement']} ({each['method']}; {each.get('scope', '')})".replace("; )", ")"),
        )
        for each in certificate.get("findings", ())
    ]
    yield section("What was proved", "proofs", law=f"{len(claims)} claims: {total}", words=words)
    rows = [("claim", "verdict", "method")]
    rows += [(each["statement"], each["verdict"], each["method"]) for each in claims]
    yield section("Table of verdicts", "verdicts", rows=rows)


def _sentences(claims: Iterable[Mapping[str, Any]]) -> Iterator[tuple[str, list[str]]]:
    """For each subject its sentences; claims that differ by the route alone are one sentence."""
    subjects: dict[str, dict[tuple[str, str, str], list[str]]] = {}
    for claim in claims:
        statement, _, route = claim["statement"].partition(_ON_ROUTE)
        about = _ABOUT.get(claim.get("kind", ""), claim.get("kind", "claims").capitalize())
        key = (statement, claim["verdict"], claim["method"])
        subjects.setdefault(about, {}).setdefault(key, []).extend([route] if route else [])
    for about, entries in subjects.items():
        yield about, [_sentence(*key, routes) for key, routes in entries.items()]


def _sentence(statement: str, verdict: str, method: str, routes: Sequence[str]) -> str:
    """A claim with its verdict and its method."""
    lead = {
        "proved": "It is proved that",
        "refuted": "It is refuted that",
        "numerically supported": "It is supported by numbers, and not proved, that",
    }.get(verdict, f"It is {verdict} that")
    where = ""
    if routes:
        listed = ", ".join(routes[:-1]) + " and " * (len(routes) > 1) + routes[-1]
        where = f" on the route{'s' * (len(routes) > 1)} {listed}"
    return f"{lead} {statement}{where}. Method: {method}."


def _cost(folder: Path, certificate: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Operations of the generated code, counted in its text, and what methods keep."""
    words = list[tuple[str, str]]()
    for function, operations in count_operations(folder / "kernel_python.py").items():
        listed = ", ".join(f"{number} {sign}" for sign, number in operations.items())
        words.append((function, f"{sum(operations.values())} operations: {listed}"))
    yield section(
        "Cost of the kernel",
        "cost",
        law="operations in the text of the generated functions; those of a loop count once",
        words=words,
    )
    rows = [("method", "order", "keeps exactly", "cost of a step")]
    rows += [
        (m["name"], str(m["order"]), ", ".join(m["exactly"]) or "nothing", m["cost"])
        for m in certificate.get("methods", ())
    ]
    if rows[1:]:
        yield section("Methods of integration", "methods", rows=rows)


def count_operations(path: Path) -> dict[str, dict[str, int]]:
    """Operations by function, from the text of a module of plain Python."""
    module = ast.parse(path.read_text(encoding="utf-8"))
    counts: dict[str, dict[str, int]] = {}
    for function in module.body:
        if not isinstance(function, ast.FunctionDef) or function.name.startswith("_"):
            continue
        signs = Counter[str]()
        for node in ast.walk(function):
            if isinstance(node, ast.BinOp) and type(node.op) in _SIGNS:
                signs[_SIGNS[type(node.op)]] += 1
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
                label = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
                if label in ELEMENTARY:
                    signs[label] += 1
        if signs:
            counts[function.name] = dict(sorted(signs.items()))
    return counts


def _references(record: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The sources of the system and the theorems of its routes."""
    words = [("system", each.strip()) for each in str(record["source"]).split(";") if each.strip()]
    for part in record["sections"]:
        if part.get("kind") == "principle":
            words += [("theorem", text) for name, text in part["words"] if name == "theorem"]
    if words:
        yield section("References", "references", words=words)
