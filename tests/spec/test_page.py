"""docs/specs.md is made from what is read: current, complete, and with examples that are read."""

import re
import tomllib
from functools import cache
from itertools import chain
from pathlib import Path
from typing import get_args

import pytest

import coadjoint
from coadjoint.algebra.catalogue import MEANINGS, REPRESENTATIONS
from coadjoint.errors import SpecError
from coadjoint.spec import read_spec_text
from coadjoint.spec.core.parts import Part, TextPart
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.page import find_part, find_parts, list_keys, write_page
from coadjoint.spec.schema import SpecFile
from coadjoint.spec.tables import TABLES

DOCS = Path(__file__).parents[2] / "docs"
PROSE = (DOCS / "specs.in.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```toml(?: (on )?(\w+))?\n(.*?)^```$", PROSE, re.DOTALL | re.MULTILINE)
BASES = {name: tomllib.loads(text, parse_float=str) for on, name, text in BLOCKS if name and not on}


def merge(base, more):
    """Tables joined; what both have, the second gives."""
    joined = dict(base)
    for key, value in more.items():
        both = isinstance(value, dict) and isinstance(base.get(key), dict)
        joined[key] = merge(base[key], value) if both else value
    return joined


def write(value):
    """A value in TOML; names of keys stand in quotes."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f'"{key}" = {write(each)}' for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(write, value)) + "]"
    return str(value).lower() if isinstance(value, bool | int) else f"'''{value}'''"


@cache
def examples():
    """Each example as the data of a whole spec, and as its text shows it alone."""
    found = []
    for on, name, text in BLOCKS:
        shown = tomllib.loads(text, parse_float=str)
        found.append((merge(BASES[name], shown) if on else shown, shown))
    return found


def list_used(part, data):
    """The keys that data uses, with the model that has them."""
    if isinstance(part, type) and issubclass(part, TextPart) and not isinstance(data, dict):
        data = {part.alone: data}
    for key, value in data.items():
        if key not in part.model_fields:
            continue  # where a table of names may have a value that is no table
        yield part, key
        for inner in find_parts(part.model_fields[key].annotation):
            entries = value if isinstance(value, list) else [value]
            whole = "dict[" not in repr(part.model_fields[key].annotation)
            for entry in entries:
                tables = [entry] if whole else entry.values() if isinstance(entry, dict) else []
                for table in tables:
                    if isinstance(table, dict) or issubclass(inner, TextPart):
                        yield from list_used(inner, table)


def list_marked(prose):
    """The tables whose keys a prose shows, in order; "" for the head."""
    return re.findall(r"^\{\{ keys ?([\w.]*) \}\}$", prose, re.MULTILINE)


def find_unshown(shown):
    """The keys of the page that no example has."""
    used = {pair for each in shown for pair in list_used(SpecFile, each)}
    return {
        (table, key)
        for table in list_marked(PROSE)
        for key in list_keys(table)
        if not any(key == name and key in part.model_fields and _alike(part, table)
                   for part, name in used)
    }  # fmt: skip


def _alike(part, table):
    """Whether a model is that of a table, or one with keys of it, as an operand has."""
    own = find_part(table)
    return part is own or (table.startswith("algebra") and part.__name__ == "OperandPart")


def test_the_page_is_current():
    """`make docs` writes it again."""
    assert (DOCS / "specs.md").read_text(encoding="utf-8") == write_page(PROSE)


def test_a_page_that_is_out_of_date_would_be_seen():
    """A changed description changes the page, and a mark that means nothing is an error."""
    with pytest.raises(KeyError):
        write_page("{{ kyes }}")
    with pytest.raises(KeyError):
        write_page("{{ keys variabels }}")
    assert write_page(PROSE.replace("{{ keys time }}", "")) != write_page(PROSE)


def test_every_table_and_every_key_is_on_the_page():
    """Each table is marked once, and so is each model that a key leads to, or a larger one."""
    marked = list_marked(PROSE)
    assert len(set(marked)) == len(marked)
    assert {table.key for table in TABLES} <= set(marked)
    parts, pending = set(), [SpecFile]
    while pending:
        part = pending.pop()
        parts.add(part)
        inner = chain(*(find_parts(each.annotation) for each in part.model_fields.values()))
        pending += [each for each in inner if each not in parts]
    shown = [find_part(table).model_fields.keys() for table in marked]
    missing = [p.__name__ for p in parts if not any(p.model_fields.keys() <= s for s in shown)]
    assert missing == []
    index = re.findall(r"^\|.*\| \[`\[(\w+).*\]\(#([\w-]+)\) \|", write_page(PROSE), re.MULTILINE)
    assert sorted(name for name, _ in index) == sorted(table.key for table in TABLES)
    headings = re.findall(r"^## (.*)$", PROSE, re.MULTILINE)
    assert {place for _, place in index} <= {
        h.lower().replace(" ", "-").replace("'", "") for h in headings
    }
    assert len(parts) > 30


def test_every_function_and_representation_is_on_the_page():
    """Rows as well."""
    page = write_page(PROSE)
    assert all(f"| `{name}(" in page for name in FUNCTIONS)
    assert MEANINGS.keys() == set(REPRESENTATIONS)
    assert all(f'| `"{name}"` |' in page for name in REPRESENTATIONS)


def test_every_key_has_an_example():
    """In the part that is shown."""
    shown = [each for _, each in examples()]
    assert find_unshown(shown) == set()
    fewer = [each for each in shown if "metriplectic" not in each]
    assert ("metriplectic", "S") in find_unshown(fewer)


def test_every_key_has_a_description():
    """A key without one would have an empty row."""
    for table in list_marked(PROSE):
        assert all(each.description for each in list_keys(table).values()), table
    assert issubclass(find_part("variables"), Part)
    assert get_args(find_part("variables").model_fields["role"].annotation)


def text_of(data):
    """A spec as a text."""
    return "".join(f"{key} = {write(value)}\n" for key, value in data.items())


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_an_example_is_proved(number):
    """Every example of the page is a spec, alone or with what it is added to, and holds."""
    whole, shown = examples()[number]
    if whole is shown:
        assert read_spec_text(BLOCKS[number][2], "sample.toml").title == whole["title"]
    certificate = coadjoint.prove(read_spec_text(text_of(whole), "sample.toml"))
    assert certificate.holds, str(certificate)


def test_a_wrong_example_would_be_seen():
    """The text that is made of an example is checked as any other."""
    whole, _ = examples()[0]
    with pytest.raises(SpecError, match="unknown key"):
        read_spec_text(text_of(merge(whole, {"variables": {"Pi": {"rol": "momentum"}}})), "x.toml")


def test_a_comment_of_an_example_is_no_title():
    """The index of tables has titles of the page alone."""
    page = write_page("{{ tables }}\n\n# Motion\n\n```toml\n# not a title\n```\n\n{{ keys time }}")
    assert "| Motion | [`[time]`](#) |" in page
