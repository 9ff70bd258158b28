"""The same spec with other names and in another order: nothing that is true changes.

Comes in: the text of a spec. Goes out: its text with variables and parameters renamed, so that the
alphabet runs the other way, and with declarations and claims in reverse order.
"""

from __future__ import annotations

import re
import tomllib

_FUNCTIONS = {"sin", "cos", "tan", "exp", "log", "sqrt", "dot", "vector", "diag", "cross"}
#: Keys whose values are words of the language.
_KEYS = re.compile(r'((?:role|representation) = "\w+"|block = (?:"\w+"|\[[^]]*\]))')


def rename_variables(text):
    """The text with every name of a variable or parameter replaced."""
    table = tomllib.loads(text)
    names = sorted({*table["variables"], *table.get("parameters", {})}, reverse=True)
    new = {name: f"{chr(ord('b') + place)}x" for place, name in enumerate(names)}
    assert not set(new) & _FUNCTIONS

    def change(piece):
        found = re.compile(rf"\b({'|'.join(names)})(\d*)\b")
        return found.sub(lambda match: new[match[1]] + match[2], piece)

    lines, inside = [], False
    for line in text.splitlines():
        if line.startswith("["):
            inside = True
        plain = line.startswith(("title", "routes", "name", "invariance", "[algebra", "direct_sum"))
        lines.append(_kept(line, change) if inside and not plain else line)
    return "\n".join(lines) + "\n"


def _kept(line, change):
    """A line renamed, but for the keys and words of the language that look like names."""
    words = re.split(
        r"(role = \"\w+\"|representation = \"\w+\"|block = (?:\"\w+\"|\[[^]]*\]))", line
    )
    return "".join(word if n % 2 else change(word) for n, word in enumerate(words))


def permute_variables(text):
    """The text with parameters, variables and claims in reverse order.

    Formulas and names stay, so that every statement does. Variables keep their order where it
    matters: the sign of a Nambu bracket is that of the order of the coordinates.
    """
    parts = re.split(r"(?m)^(?=\[[a-z])", text)
    turned = ["[parameters]"]
    if "nambu" not in text:
        turned.append("[variables]")
    for place, part in enumerate(parts):
        head, *lines = part.splitlines()
        if head in turned:
            parts[place] = "\n".join([head, *reversed(lines)]) + "\n"
        if head == "[claims]":
            own = [line for line in lines if line.startswith("  ")]
            rest = iter(own[::-1])
            lines = [next(rest) if line.startswith("  ") else line for line in lines]
            parts[place] = "\n".join([head, *lines]) + "\n"
    return "".join(parts)
