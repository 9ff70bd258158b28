"""Every step of a derivation names the theorem that it rests on, from one table."""

from __future__ import annotations

import ast
import re
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

import pytest

import coadjoint.derive
from coadjoint.derive.document import document
from coadjoint.derive.records import write_step
from coadjoint.derive.theorems import _OF_ROUTES, THEOREMS, find_theorem
from coadjoint.render.document import render_document
from coadjoint.render.prose import ESCAPES
from coadjoint.spec.routes import ROUTES
from tests.render.test_document import FORMATS
from tests.specs import emitted

#: Keys that are computed: of the route at hand, and of what a spec adds to the rates.
COMPUTED = {
    "route": {"poisson", "lie-poisson"},
    "relaxation": {"double-bracket", "metriplectic"},
    "rests": {"advection", "euler-poincare"},
}


def steps_of(folder):
    """Every call that writes a step: file, line and the expression of its key."""
    for path in sorted(Path(folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "write_step":
                key = next((each.value for each in node.keywords if each.arg == "by"), None)
                yield f"{path.name}:{node.lineno}", key


def check_keys(steps):
    """Every step has a key of the table, and no key of a step's theorem is left over."""
    used, number = set(), 0
    for place, key in steps:
        assert key is not None, f"{place} rests on nothing"
        constants = [c.value for c in ast.walk(key) if isinstance(c, ast.Constant)]
        names = [n.id for n in ast.walk(key) if isinstance(n, ast.Name)]
        found = {c for c in constants if len(c) > 1} | {k for n in names for k in COMPUTED[n]}
        assert found, f"{place} rests on nothing"
        assert found <= set(THEOREMS), f"{place} rests on {found - set(THEOREMS)}"
        used |= found
        number += 1
    assert used | {"chart"} >= set(THEOREMS) - set(_OF_ROUTES), set(THEOREMS) - used
    return number


def test_every_step_of_every_route_rests_on_a_theorem():
    """All calls in the package that write steps, those of routes and of what they share."""
    assert check_keys(steps_of(Path(coadjoint.derive.__file__).parent)) > 120


@pytest.mark.parametrize("key", ["", ', by="legnedre"', ", by=''"])
def test_a_step_without_a_theorem_is_seen(key):
    """The check above sees a key that is missing, one that the table lacks, and an empty one."""
    (call,) = (each.value for each in ast.parse(f'write_step("Momenta", "mu"{key})').body)
    found = next((each.value for each in call.keywords), None)
    with pytest.raises(AssertionError, match="rests on"):
        check_keys([("spoiled.py:1", found)])


def test_an_unknown_theorem_is_an_error():
    """With what was found, and the nearest key of the table."""
    with pytest.raises(LookupError, match=r"'legnedre'.*Did you mean 'legendre'"):
        write_step("Momenta", "mu", by="legnedre")
    with pytest.raises(
        LookupError, match=r"rests on 'x'; expected a key of THEOREMS. Add it there"
    ):
        find_theorem("x")


@pytest.mark.parametrize("route", sorted(ROUTES))
def test_the_table_and_the_module_of_a_route_cite_the_same(route):
    """The docstring of each route's module states the theorem with the source of the table."""
    module = import_module(f"coadjoint.derive.routes.{route.replace('-', '_')}")
    cited = re.search(r"(?:Theorem|Law|Principle) \((.*?)\):", module.__doc__, re.DOTALL)
    assert " ".join(cited[1].split()) == find_theorem(route).source


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("route", ["euler-poincare", "clebsch"])
def test_documents_show_the_theorem_of_each_step(form, route):
    """In every format; the record of JSON has it as a field."""
    found = emitted("heavy_top", route)
    record = asdict(document(found))
    steps = [each for each in record["sections"] if each["kind"] == "step"]
    assert len(steps) == len(found.steps) > 3
    assert all(each["theorem"] for each in steps)
    text = " ".join(render_document(record, form).split())
    shown = ESCAPES.get(form, str)
    for each in steps:
        assert text.count(f"By: {shown(each['theorem'])}") == sum(
            other["theorem"] == each["theorem"] for other in steps
        )


def test_numbers_are_those_of_sections_and_equations():
    """A source in the book begins with what its number counts."""
    places = [each.source for each in THEOREMS.values() if "Holm 2011, " in each.source]
    assert len(places) > 30
    for place in places:
        assert re.search(r"Holm 2011, (sections?|appendix|definition) [0-9A-D]", place), place
