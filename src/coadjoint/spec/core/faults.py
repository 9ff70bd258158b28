"""A fault at a place of an expression, before it is known in which file the expression stands.

Comes in: nothing. Goes out: the exception that the steps on expressions raise, which
`coadjoint.spec.core.source` turns into a `SpecError` with file, line, column and a caret.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from coadjoint import limits
from coadjoint.spec.core.tree import Node


class ExpressionError(Exception):
    """An expression is not what it may be.

    Attributes:
        problem: What was found, as a clause: ``'Omgea' is not declared``.
        start: Offset of the characters at fault in the expression.
        end: Offset after them.
        found: The text at fault.
        expected: What would have been accepted; with a limit, its value.
        hint: The likely fix, as a sentence.
        limit: Name of the constant in `coadjoint.limits` that was passed, or "".
    """

    def __init__(
        self,
        problem: str,
        start: int,
        end: int,
        found: str = "",
        expected: str = "",
        hint: str = "",
        limit: str = "",
    ) -> None:
        super().__init__(problem)
        self.problem, self.start, self.end = problem, start, end
        self.found, self.hint, self.limit = found, hint, limit
        self.expected = f"at most {getattr(limits, limit)} ({limit})" if limit else expected


def fault_at(
    node: Node, problem: str, found: str = "", expected: str = "", hint: str = "", limit: str = ""
) -> ExpressionError:
    """A fault at a node; where a definition was expanded, it is the definition that has it."""
    where = f"in the definition of {node.within}: " if node.within else ""
    parts = {"found": found, "expected": expected, "hint": hint, "limit": limit}
    return ExpressionError(where + problem, node.start, node.end, **parts)


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A sentence with the known name nearest to a wrong one, if one is near.

    >>> did_you_mean("Omgea", ["Gamma", "Omega"])
    "Did you mean 'Omega'?"
    """
    near = find_near(name, known)
    return f"Did you mean {near[0]!r}?" if near else otherwise


def find_near(name: str, known: Iterable[str]) -> list[str]:
    """The known names like a wrong one, the nearest first; `r` is like `R`.

    >>> find_near("r", ["R", "S"])
    ['R']
    """
    names = sorted(known)
    alike = [each for each in names if each.casefold() == name.casefold()]
    return alike or get_close_matches(name, names)


def list_names(names: Iterable[str], most: int = 12) -> str:
    """Names for a message, in the given order and not too many.

    >>> list_names(["a", "b"])
    'a, b'
    """
    listed = list(names)
    return ", ".join(listed[:most]) + (", ..." if len(listed) > most else "")
