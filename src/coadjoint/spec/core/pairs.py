"""Pairs: the keys ``[e1, e2]`` and ``{X1, X2}`` of tables of brackets.

Comes in: the keys, and the names that may stand in them. Goes out: each key by the places of its
names. Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from coadjoint.errors import CoadjointError, SpecError
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source


def read_pairs(
    source: Source,
    key: KeyPath,
    texts: Iterable[str],
    pattern: str,
    names: Sequence[str],
    kind: type[CoadjointError] = SpecError,
) -> dict[tuple[int, int], str]:
    """The keys of a table of brackets by the places of their names, each pair once.

    Args:
        source: The text of the spec.
        key: Where the table stands.
        texts: Its keys.
        pattern: What they look like, with a group for each name.
        names: What they may name.
        kind: Class of the error for a pair that is declared twice.

    Raises:
        SpecError: A key does not name two of these names, or names a pair that is declared already.
    """
    pairs: dict[tuple[int, int], str] = {}
    for text in texts:
        match = re.fullmatch(pattern, text, re.ASCII)
        unknown = [name for name in match.groups() if name not in names] if match else [text]
        if match is None or unknown:
            first, second = names[:2] if len(names) > 1 else ("X1", "X2")
            example = f"[{first}, {second}]" if "[" in pattern[:3] else f"{{{first}, {second}}}"
            expected = f"a key such as '{example}' with names among {list_names(names)}"
            problem = f"{text!a} is not a bracket of these names"
            hint = did_you_mean(unknown[0], names)
            raise source.at_key((*key, text), problem, unknown[0], expected, hint)
        i, j = names.index(match[1]), names.index(match[2])
        if i == j or (i, j) in pairs or (j, i) in pairs:
            problem = f"{text!a} is {'declared twice' if i != j else '0 and needs no declaration'}"
            expected = "each pair of different names once, in either order"
            raise source.at_key((*key, text), problem, text, expected, "Remove it.", kind=kind)
        pairs[i, j] = text
    return pairs
