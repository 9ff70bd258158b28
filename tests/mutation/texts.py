"""Changes of what is no Python: a formula of a spec by the path of its key, a line of a template.

A formula has the operators of `tests.mutation.addresses`, after the path of its key:

    lax.L: flip S
    claims.casimirs[1]: flip X3

A template has two, after a name in a block that stands around the line, or ``anywhere``:

    state_inputs: flip _n in state_stride           the sign before a name, on the line with these
    of_member: use name ~ '-' for name in to        another text in the place of a word

Comes in: the text of a file and a line. Goes out: the changed text.
"""

from __future__ import annotations

import ast
import json
import re
import tomllib

from coadjoint.spec.core.positions import scan
from coadjoint.spec.core.source import write_key
from tests.mutation.addresses import AddressError, find_edit, source_with, split_once

_WORD = re.compile(r"\w+|[^\w\s]+")
_BLOCK = re.compile(r"{%-? *(end)?(?:for|if|macro|block)\b(.*?)-?%}")


def changed_spec(text: str, line: str) -> str:
    """A spec with changed formulas; changes that are made together stand apart by semicolons."""
    for each in line.split("; "):
        path, change = split_once(each, ": ")
        positions = scan(text)
        named = {write_key(found): found for found in positions.characters}
        if path not in named:
            raise AddressError(f"no formula stands at {path!r}; there are: {', '.join(named)}")
        value: object = tomllib.loads(text)
        for part in named[path]:
            value = value[part]  # type: ignore[index]
        start, end = positions.values[named[path]]
        text = f"{text[:start]}{json.dumps(_changed_formula(str(value), change))}{text[end:]}"
    return text


def _changed_formula(formula: str, change: str) -> str:
    """A formula with one change, by way of Python's syntax."""
    tree = ast.parse(f"({_to_python(formula.strip())})")
    source = source_with(tree, find_edit(tree, f"module: {_to_python(change)}"))
    return re.sub(r"\blambda_\b", "lambda", source)


def _to_python(formula: str) -> str:
    """Powers and names as Python reads them."""
    return re.sub(r"\blambda\b", "lambda_", formula.replace("^", "**"))


def changed_template(text: str, line: str) -> str:
    """A template with one change of the only line that has its words and what it changes, once."""
    block, what = split_once(line, ": ")
    what, words = split_once(what, " in ")
    lines, around = text.split("\n"), list[str]()
    fitting, changed = list[int](), list[int]()
    for place, each in enumerate(lines):
        for end, opened in _BLOCK.findall(each):
            if end:
                around.pop()
            else:
                around.append(opened)
        known = _WORD.findall(_BLOCK.sub("", each))
        inside = block == "anywhere" or block in _WORD.findall(" ".join(around))
        if inside and {*words.split()} <= {*known}:
            fitting.append(place)
            changed += [place] * (_changed_line(each, what) is not None)
    if len(changed) != 1:
        listed = "\n".join(lines[place] for place in changed or fitting)
        raise AddressError(f"{line!r} fits {len(changed)} lines:\n{listed}")
    (place,) = changed
    lines[place] = _changed_line(lines[place], what) or ""
    return "\n".join(lines)


def _changed_line(text: str, what: str) -> str | None:
    """A line with another sign or word; None where that is not at one place of it."""
    operator, rest = split_once(what, " ")
    if operator == "flip":
        pattern = re.compile(rf"([+-])(?= *\b{re.escape(rest)}\b)")
        new = {"+": "-", "-": "+"}[pattern.search(text)[1]] if pattern.search(text) else ""
    else:
        new, old = split_once(rest, " for ")
        first, last = (r"\b" if re.match(r"\w", old[n]) else "" for n in (0, -1))
        pattern = re.compile(f"{first}{re.escape(old)}{last}")
    changed, count = pattern.subn(lambda _: new, text)
    return changed if count == 1 else None
