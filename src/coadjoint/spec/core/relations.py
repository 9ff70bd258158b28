"""Relations: equations and inequalities between two expressions, such as ``Y == cross(Omega, s)``.

Comes in: the text at a key, and the scope of its formulas. Goes out: both sides as formulas of one
shape, and the sign between them. The language of expressions itself knows no relation.
Read next: `coadjoint.spec.sections.constraints`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import Formula, Scope, read_formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Number

EQUATION = ("==",)
INEQUALITIES = (">", ">=", "<", "<=")
_SIGN = re.compile(r"==|>=|<=|!=|=|>|<")


def read_relation(
    source: Source, key: KeyPath, text: str, signs: tuple[str, ...], scope: Scope
) -> tuple[Formula, str, Formula]:
    """The two sides of a relation and its sign.

    A side that is the number 0 has the shape of the other one.

    Raises:
        SpecError: No sign of those allowed, or two; sides of different shapes, or a fault in one.
    """
    matches = list(_find_signs(text)) if source.members else list(_SIGN.finditer(text))
    if len(matches) != 1 or matches[0].group() not in signs:
        raise _no_relation(source, key, text, signs, matches)
    sign = matches[0]
    left, right = (
        read_formula(source, key, side, scope, any_shape=True)
        for side in (text[: sign.start()], " " * sign.end() + text[sign.end() :])
    )
    left, right = (
        replace(side, text=text, shape=other.shape)
        if isinstance(side.tree, Number) and side.tree.value == 0
        else replace(side, text=text)
        for side, other in ((left, right), (right, left))
    )
    if left.shape != right.shape:
        problem = f"the left side is {words(left.shape)} and the right side {words(right.shape)}"
        expected = "two sides of one shape, or 0 on one of them"
        raise source.fault(
            key, problem, text, expected, at=source.within(key, sign.start(), sign.end())
        )
    return left, sign.group(), right


def _find_signs(text: str) -> Iterator[re.Match[str]]:
    """Signs that stand in no parentheses, as those in the condition of a sum do."""
    for each in _SIGN.finditer(text):
        before = text[: each.start()]
        if before.count("(") <= before.count(")"):
            yield each


def split_sides(text: str) -> list[str]:
    """What stands around the signs of a relation.

    >>> split_sides("v[i] == sum(j, j <= i, q[j])")
    ['v[i] ', ' sum(j, j <= i, q[j])']
    """
    sides, at = list[str](), 0
    for sign in _find_signs(text):
        sides.append(text[at : sign.start()])
        at = sign.end()
    return [*sides, text[at:]]


def _no_relation(
    source: Source, key: KeyPath, text: str, signs: tuple[str, ...], matches: list[re.Match[str]]
) -> CoadjointError:
    """Why a text is not a relation."""
    wanted = matches[1] if len(matches) > 1 else matches[0] if matches else None
    problem = "there are two signs" if len(matches) > 1 else f"there is no {list_names(signs)}"
    example = "Y == cross(Omega, s)" if signs == EQUATION else "1 - Gamma3^2 > 0"
    return source.fault(
        key,
        problem,
        wanted.group() if wanted else text,
        f"two expressions with {list_names(signs)} between them",
        f"Write for instance {example!r}.",
        at=source.within(key, *(wanted.span() if wanted else (0, len(text)))),
    )
