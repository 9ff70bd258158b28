"""Source: a spec's text with its positions, and how to point at the characters at fault.

Comes in: a file path and its text. Goes out: errors of one form,

    derivations/top.toml:12:10: lagrangian.l: 'Omgea' is not declared; expected a velocity, ...
        l = "dot(Omgea, Omega)/2"
                 ^^^^^

with the parts as attributes. Read next: `coadjoint.spec.schema`, the first step that needs it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from coadjoint import limits
from coadjoint.errors import CoadjointError, LimitError, SpecError, make_printable
from coadjoint.spec.core.faults import ExpressionError, did_you_mean, list_names
from coadjoint.spec.core.members import Members
from coadjoint.spec.core.positions import KeyPath, Positions, Span

#: Characters of a source line that a message shows at the most.
_SHOWN = 96


def write_key(path: KeyPath) -> str:
    """A path as messages write it, array entries counted from 1.

    >>> write_key(("claims", "casimirs", 0))
    'claims.casimirs[1]'
    """
    text = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{_key(part)}" for part in path)
    return text.removeprefix(".") or "the file"


def _key(part: str) -> str:
    """A key for a message; one with control characters could draw on the reader's terminal."""
    return part if part.isascii() and part.isprintable() and len(part) <= 60 else show_value(part)


def show_value(value: object, most: int = 60) -> str:
    r"""A found value for a message, on one line and cut where it is long.

    >>> show_value("spin\nner"), show_value(True), show_value("x" * 99, most=8)
    ("'spin\\nner'", 'true', "'xxxx...")
    """
    if isinstance(value, int) and value.bit_length() > 1000:
        return f"an integer of {value.bit_length()} bits"
    if isinstance(value, (dict, list)):
        kind = "table" if isinstance(value, dict) else "list"
        return f"a {kind} of {len(value)}" if value else f"an empty {kind}"
    text = str(value).lower() if isinstance(value, bool) else ascii(value)
    text = str(value) if type(value).__name__ in ("Decimal", "Fraction") else text
    return text if len(text) <= most else text[: most - 3] + "..."


def _plain(found: object) -> object:
    """A found value as JSON can carry it."""
    short = isinstance(found, int) and found.bit_length() <= 64
    return found if short or isinstance(found, str) else show_value(found)


@dataclass(frozen=True)
class Place:
    """Where something stands in a spec, for messages after it was read.

    Attributes:
        path: Its key in the spec, e.g. ``("lagrangian", "l")``.
        line: Its line in the file, counted from 1.
        excerpt: That line, and carets under what stands there.
    """

    path: KeyPath
    line: int
    excerpt: str = field(compare=False, repr=False)

    @property
    def key(self) -> str:
        """Its dotted key, e.g. ``lagrangian.l``."""
        return write_key(self.path)

    def locate(self, path: object, message: str) -> str:
        """A message with the place in a file before it, and its line below."""
        return f"{path}:{self.line}: {self.key}: {message}\n{self.excerpt}".rstrip()


@dataclass(frozen=True)
class Source:
    """The text of a spec.

    Attributes:
        path: The file as the user named it.
        text: Its text with plain newlines.
        positions: Where its keys and values stand.
        spent: What its formulas took so far of limits that hold for all of them together.
        members: The members that an index counts, in a spec with one.
    """

    path: str
    text: str
    positions: Positions
    spent: Counter[str] = field(default_factory=Counter, compare=False)
    members: Members | None = None

    def line(self, span: Span) -> int:
        """Line of a place, counted from 1."""
        return self.text.count("\n", 0, span[0]) + 1

    def place(self, key: KeyPath) -> Place:
        """Where the value of a key stands."""
        span = self.positions.value(key)
        return Place(key, self.line(span), self.excerpt(span))

    def fault(
        self,
        key: KeyPath,
        problem: str,
        found: Any = "",
        expected: str = "",
        hint: str = "",
        *,
        at: Span | None = None,
        kind: type[CoadjointError] = SpecError,
        **parts: Any,
    ) -> CoadjointError:
        """An error that points into the file.

        Args:
            key: The key concerned.
            problem: What was found, as a clause.
            found: The value at fault.
            expected: What would have been accepted.
            hint: The likely fix, as a sentence.
            at: The characters at fault; by default the value of the key.
            kind: Class of the error.
            parts: Further attributes.
        """
        span = self.positions.value(key) if at is None else at
        line, key = self.line(span), self.positions.written(key)
        column = span[0] - self.text.rfind("\n", 0, span[0])
        message = f"{self.path}:{line}:{column}: {write_key(key)}: {problem}"
        message += f"; expected {expected}." if expected else "." * (problem[-1] not in ".?")
        message += f" {hint}" if hint else ""
        return kind(
            f"{message}\n{self.excerpt(span)}".rstrip(),
            path=self.path,
            line=line,
            column=column,
            key=write_key(key),
            found=_plain(found),
            expected=expected,
            hint=hint,
            **parts,
        )

    def at_key(
        self,
        key: KeyPath,
        problem: str,
        found: Any,
        expected: str,
        hint: str = "",
        kind: type[CoadjointError] = SpecError,
    ) -> CoadjointError:
        """An error that points at a key and not at its value."""
        at = self.positions.key(key)
        return self.fault(key, problem, found, expected, hint, at=at, kind=kind)

    def unknown(
        self,
        key: KeyPath,
        problem: str,
        name: str,
        known: Iterable[str],
        otherwise: str = "",
        *,
        is_key: bool = False,
    ) -> CoadjointError:
        """An error for a name that nothing has, as a value or a key, with the nearest known one."""
        names = list(known)
        expected = f"one of {list_names(names)}" if names else "a declared one"
        point = self.at_key if is_key else self.fault
        return point(key, problem, name, expected, did_you_mean(name, names, otherwise))

    def too_many(
        self, key: KeyPath, problem: str, found: object, limit: str, **options: Any
    ) -> CoadjointError:
        """An error that names the limit of `coadjoint.limits` that is passed."""
        expected = f"at most {getattr(limits, limit)} ({limit})"
        options |= {"found": found, "expected": expected, "kind": LimitError, "limit": limit}
        return self.fault(key, problem, **options)

    def expression_fault(self, key: KeyPath, error: ExpressionError) -> CoadjointError:
        """The error that a fault inside the expression at ``key`` is."""
        return self.fault(
            key,
            error.problem,
            found=error.found,
            expected=error.expected,
            hint=error.hint,
            at=self.within(key, error.start, error.end),
            kind=LimitError if error.limit else SpecError,
            limit=error.limit,
        )

    def place_of(self, key: KeyPath, *inner: str) -> KeyPath:
        """Where an entry stands: at its key, or at one of some keys of the table there."""
        places = ((*key, name) for name in inner)
        return next((each for each in places if each in self.positions.values), key)

    def within(self, key: KeyPath, start: int, end: int) -> Span:
        """Where the characters ``start`` to ``end`` of a string's value stand in the file."""
        characters = self.positions.characters.get(key)
        if characters is None:
            return self.positions.value(key)
        first = min(start, len(characters) - 1)
        last = min(max(end - 1, first), len(characters) - 1)
        return characters[first], characters[last] + 1

    def excerpt(self, span: Span) -> str:
        """The line of a place, and a caret line under it."""
        first = self.text.rfind("\n", 0, span[0]) + 1
        last = self.text.find("\n", first)
        line = self.text[first:] if last < 0 else self.text[first:last]
        column = span[0] - first
        cut = max(0, column - _SHOWN // 2) if len(line) > _SHOWN else 0
        window = make_printable(line[cut : cut + _SHOWN])
        carets = max(1, min(span[1] - span[0], len(window) - (column - cut)))
        indent = len(window) - len(window.lstrip())  # the line is shown without its indentation
        return f"    {window.strip()}\n    {' ' * (column - cut - indent)}{'^' * carets}"


def join_faults(faults: Sequence[CoadjointError], more: int = 0) -> CoadjointError:
    """Several errors as one: every message, the parts of the first, and all parts as ``faults``.

    Args:
        faults: At least one error.
        more: How many further faults there are that are not shown.
    """
    first = faults[0]
    if len(faults) == 1:
        return first
    messages = [str(fault) for fault in faults] + [f"... and {more} more faults."] * (more > 0)
    kept = [fault.parts for fault in faults]
    return type(first)("\n".join(messages), **first.parts, faults=kept)
