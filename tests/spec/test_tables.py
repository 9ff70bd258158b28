"""Tables: one list that every walker reads, and no imports that turn back."""

import ast
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest
from pydantic import Field

import coadjoint.spec
from coadjoint.cli.new import STARTER
from coadjoint.errors import SpecError
from coadjoint.spec import consistency, reader, schema, validate
from coadjoint.spec.core.components import Components
from coadjoint.spec.core.formulas import Formula, make_scope, read_formula
from coadjoint.spec.core.parts import TextPart
from coadjoint.spec.core.reading import Table, name_each
from coadjoint.spec.routes import ROUTES
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.tables import BY_KEY, TABLES, list_formulas
from tests.specs import RIGID_BODY, spec

PACKAGE = Path(coadjoint.spec.__file__).parent
DOCS = Path(__file__).parents[2] / "docs" / "specs.md"


# -- a table of its own: gains, numbers made of parameters that formulas may name ----------------


class GainPart(TextPart):
    """A gain."""

    alone = "value"

    value: str = Field(description="its value")


@dataclass(frozen=True)
class Gain(Components):
    """A number that is made of parameters."""

    role: ClassVar[str] = "parameter"
    shape: ClassVar[tuple[int, ...]] = ()

    name: str
    value: Formula


def read_gains(reading, parts: Mapping[str, GainPart]):
    """The gains; a scope of parameters alone, since gains are among the quantities."""
    scope = make_scope("a gain", (), PARAMETERS.of(reading))
    found = []
    for name, part in parts.items():
        key = reading.source.place_of(("gains", name), "value")
        found.append(Gain(name, read_formula(reading.source, key, part.value, scope)))
    return tuple(found)


GAINS = Table(
    "gains",
    GainPart,
    "numbers made of parameters",
    read_gains,
    many=True,
    quantities=True,
    names=name_each,
    acts=True,
)
GAINED = RIGID_BODY.replace("[claims]", '[gains]\ngain = "2*I1"\n[claims]')


@pytest.fixture
def gains(monkeypatch):
    """The list of tables with one more, where walkers look it up."""
    more = (*TABLES, GAINS)
    for module in (consistency, reader):
        monkeypatch.setattr(module, "TABLES", more)
    monkeypatch.setattr(validate, "SpecFile", schema.compose(more))
    start = ROUTES["euler-poincare"]
    knowing = type(start)(**{**vars(start), "options": (*start.options, "gains")})
    monkeypatch.setattr(consistency, "ROUTES", {**ROUTES, "euler-poincare": knowing})


ALONE = ('routes = ["euler-poincare", "lie-poisson"]', 'routes = ["euler-poincare"]')


def test_a_new_table_is_one_record_in_the_list(gains):
    """Its keys are read, its name is a name in formulas, and its formulas are found."""
    found = spec(GAINED, ALONE, ("dot(Omega, diag(I)*Omega)/2", "gain*dot(Omega, Omega)/2"))
    (gain,) = found.records["gains"]
    assert (gain.name, gain.value.text) == ("gain", "2*I1")
    assert gain.value in list_formulas(found)
    assert found.lagrangian in list_formulas(found)


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ([ALONE, ("gain =", "I =")], "gains.I", "parameters.I has that name too"),
        ([ALONE, ("gain =", "state =")], "gains.state", "Call it 'state_0'."),
        ([ALONE, ('"2*I1"', '"2*Omega1"')], "gains.gain", "'Omega1' is not declared"),
        ([ALONE, ('"2*I1"', "{ valu = 'I1' }")], "gains.gain.valu", "Did you mean 'value'?"),
        ([ALONE, ("[gains]", "[gain]")], "gain", "Did you mean 'gains'?"),
        ([], "routes[2]", "the route lie-poisson does not accept [gains]"),
    ],
)
def test_every_check_knows_the_new_table(gains, changes, key, said):
    """Names, formulas, keys and routes are checked as those of the other tables."""
    with pytest.raises(SpecError) as caught:
        spec(GAINED, *changes)
    assert caught.value.key == key
    assert said in str(caught.value)


def test_without_its_line_the_table_is_unknown():
    """The checks above can fail."""
    with pytest.raises(SpecError, match="unknown key 'gains'"):
        spec(GAINED, ALONE)


# -- the shipped list ------------------------------------------------------------------------------


def test_every_table_is_in_the_schema_and_in_the_docs():
    """No table stands in one of them alone."""
    keys = set(schema.json_schema()["properties"]) - set(schema.Head.model_fields)
    assert keys == set(BY_KEY)
    assert len(BY_KEY) == len(TABLES)
    text = DOCS.read_text(encoding="utf-8")
    assert [key for key in BY_KEY if f"[{key}]" not in text and f"[{key}." not in text] == []


def test_the_starter_shows_tables_of_the_list():
    """What `coadjoint new` writes, also in comments, is read by some table."""
    shown = re.findall(r"^#? ?\[(\w+)\]", STARTER, re.MULTILINE)
    assert len(shown) > 5
    assert set(shown) <= set(BY_KEY)


def test_routes_name_tables_of_the_list():
    """What a route starts from, or may take, is a table."""
    named = {n for s in ROUTES.values() for n in (*s.energies, *s.options, s.table) if n}
    assert named <= set(BY_KEY)
    acting = {table.key for table in TABLES if table.acts}
    assert acting <= {name for start in ROUTES.values() for name in start.options}


def test_examples_of_tables_are_read():
    """What a message shows as a line of a table is TOML that its keys accept."""
    shown = 0
    for table in TABLES:
        if table.example:
            value = tomllib.loads(table.example.replace('" and ', '"\n'))
            entries = value.values() if table.many else [value]
            shown += len([table.part.model_validate(entry) for entry in entries])
    assert shown >= 4


# -- imports --------------------------------------------------------------------------------------


def imports_of(path):
    """The modules of spec that a module imports, also for types alone."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("coadjoint.spec"):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            files = {name: PACKAGE.parents[1] / (name.replace(".", "/") + ".py") for name in inner}
            found |= {name if path.exists() else node.module for name, path in files.items()}
    return found


def graph():
    """The imports of each module of spec."""
    root = PACKAGE.parents[1]
    names = {p: ".".join(p.relative_to(root).with_suffix("").parts) for p in PACKAGE.rglob("*.py")}
    return {name.removesuffix(".__init__"): imports_of(path) for path, name in names.items()}


def find_circle(imports):
    """Modules that import each other in a circle; empty if there are none."""
    left = {name: set(found) & imports.keys() for name, found in imports.items()}
    while free := [name for name, found in left.items() if not found]:
        left = {name: found - set(free) for name, found in left.items() if name not in free}
    return sorted(left)


def test_no_imports_of_spec_turn_back():
    """There is no circle, and the core knows nothing of tables."""
    imports = graph()
    assert len(imports) > 40
    assert find_circle(imports) == []
    core = {name: found for name, found in imports.items() if ".core" in name}
    assert all(".core" in each for found in core.values() for each in found)


def test_a_circle_would_be_found():
    """The check above can fail."""
    assert find_circle({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}) == ["a", "b", "c"]
