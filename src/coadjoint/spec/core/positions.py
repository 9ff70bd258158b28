"""Positions: where each key and value of a TOML text stands, which tomllib does not tell.

Comes in: a text. Goes out: a span for every key and value, and for every string a map from the
characters of its value to the characters of the file, through escapes and line joins. Values are
read by `tomllib` alone. The scanner accepts a little more than TOML; where it is lost it stops, and
there the text is no TOML either. Read next: `coadjoint.spec.core.source`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from coadjoint.limits import SPEC_NESTING

#: Keys and array indices (from 0) on the way from the top to a value.
KeyPath = tuple[str | int, ...]
#: Offsets of the first character and of the one after the last.
Span = tuple[int, int]

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SPACE = re.compile(r"[ \t]*")
_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
# Numbers, booleans and dates; a date and its time may stand apart.
_SCALAR = re.compile(r"[^\s,\]}#]+(?: \d[^\s,\]}#]*)?")
_LINE_JOIN = re.compile(r"\\[ \t]*\n[ \t\n]*")
_ESCAPE = re.compile(r'\\(?:([btnfr"\\])|u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8}))')
_ESCAPED = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r", '"': '"', "\\": "\\"}


@dataclass
class Positions:
    """Where things stand in a TOML text, as offsets.

    Attributes:
        keys: Span of each key where it is first written; tables that dots imply are there too.
        values: Span of each value; of a table with a header, the header.
        characters: For each string, the offset of every character of its value, and of its end.
        doubled: A key that is given twice, with the span of the second, or None.
        too_deep: Offset at which tables and arrays nest deeper than the limit, or None.
        repeated: Of keys that are written out for each member, the one key in the text.
    """

    keys: dict[KeyPath, Span] = field(default_factory=dict)
    values: dict[KeyPath, Span] = field(default_factory=dict)
    characters: dict[KeyPath, Sequence[int]] = field(default_factory=dict)
    doubled: tuple[KeyPath, Span] | None = None
    too_deep: int | None = None
    repeated: dict[KeyPath, KeyPath] = field(default_factory=dict)

    def written(self, path: KeyPath) -> KeyPath:
        """A key as it stands in the text."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.repeated:
                return self.repeated[path[:length]] + path[length:]
        return path

    def key(self, path: KeyPath) -> Span:
        """Span of a key, or of the nearest thing around it that is written out."""
        return self._nearest(path, [self.keys, self.values])

    def value(self, path: KeyPath) -> Span:
        """Span of a value, or of the nearest thing around it that is written out."""
        return self._nearest(path, [self.values, self.keys])

    def _nearest(self, path: KeyPath, tables: Sequence[dict[KeyPath, Span]]) -> Span:
        for length in range(len(path), 0, -1):
            for table in tables:
                if path[:length] in table:
                    return table[path[:length]]
        return (0, 0)


def scan(text: str) -> Positions:
    r"""Positions of everything in a TOML text with plain newlines, in time linear in its length.

    >>> positions = scan('a = 1\nb.c = ["x", "y"]')
    >>> positions.keys[("b", "c")], positions.values[("b", "c", 1)]
    ((8, 9), (18, 21))
    """
    scanner = _Scanner(text)
    try:
        scanner.document()
    except _LostError:
        pass  # tomllib says what is wrong, and where
    except _TooDeepError:
        scanner.positions.too_deep = scanner.at
    return scanner.positions


class _LostError(Exception):
    """The text at this place is not TOML."""


class _TooDeepError(Exception):
    """Tables and arrays nest too deep."""


class _Scanner:
    """One walk over a text; every method starts at ``self.at`` and leaves it after what it read."""

    def __init__(self, text: str) -> None:
        self.text, self.at, self.positions = text, 0, Positions()
        self._tables_in: dict[KeyPath, int] = {}  # how many [[path]] headers so far

    def document(self) -> None:
        """Headers and statements up to the end."""
        table: KeyPath = ()
        self._skip(_BLANK)
        while self.at < len(self.text):
            if self.text.startswith("[", self.at):
                table = self._header()
            else:
                self._statement(table)
            self._skip(_BLANK)

    def _header(self) -> KeyPath:
        """``[path]`` or ``[[path]]``."""
        start, several = self.at, self.text.startswith("[[", self.at)
        self.at += 2 if several else 1
        path: KeyPath = ()
        for part, span in self._dotted_key():
            if path in self._tables_in:
                path = (*path, self._tables_in[path] - 1)
            path = self._enter(path, part, span)
        if several:
            self._tables_in[path] = self._tables_in.get(path, 0) + 1
            path = (*path, self._tables_in[path] - 1)
        elif path in self._tables_in:
            path = (*path, self._tables_in[path] - 1)
        self._expect("]]" if several else "]")
        self._note(path, (start, self.at))
        return path

    def _statement(self, table: KeyPath) -> None:
        """``key = value``."""
        path = table
        for part, span in self._dotted_key():
            path = self._enter(path, part, span)
            last = span
        self._expect("=")
        self._skip(_SPACE)
        self._value(path, last)

    def _dotted_key(self) -> list[tuple[str, Span]]:
        """The parts of a dotted key with their spans."""
        parts = []
        while True:
            self._skip(_SPACE)
            start = self.at
            if self.text.startswith(("'", '"'), self.at):
                part = self._string()[0]
            else:
                part = self._match(_BARE_KEY)
            parts.append((part, (start, self.at)))
            self._skip(_SPACE)
            if not self._take("."):
                return parts
            if len(parts) >= SPEC_NESTING:
                raise _TooDeepError

    def _value(self, path: KeyPath, key: Span | None = None) -> None:
        """A value, of which ``key`` is the last part of the key."""
        start = self.at
        if key is not None and path in self.positions.values:
            self.positions.doubled = self.positions.doubled or (path, key)
        self.positions.values[path] = (start, start)
        if self.text.startswith(("'", '"'), start):
            self.positions.characters[path] = self._string()[1]
        elif self._take("["):
            self._array(path)
        elif self._take("{"):
            self._inline_table(path)
        else:
            self._match(_SCALAR)
        self.positions.values[path] = (start, self.at)

    def _array(self, path: KeyPath) -> None:
        for index in range(len(self.text)):
            self._skip(_BLANK)
            if self._take("]"):
                return
            self._value(self._below(path, index))
            self._skip(_BLANK)
            if not self._take(","):
                self._expect("]")
                return

    def _inline_table(self, path: KeyPath) -> None:
        self._skip(_BLANK)
        while not self._take("}"):
            self._statement(path)
            self._skip(_BLANK)
            if not self._take(","):
                self._expect("}")
                return
            self._skip(_BLANK)

    def _string(self) -> tuple[str, list[int]]:
        """A string of any of the four kinds: its value, and where each character of it stands."""
        quote = self.text[self.at]
        mark = quote * 3 if self.text.startswith(quote * 3, self.at) else quote
        self.at += len(mark)
        if len(mark) == 3:
            self._take("\n")
        letters: list[str] = []
        offsets: list[int] = []
        while not self.text.startswith(mark, self.at):
            letter, width = self._letter(quote, mark)
            if letter:
                letters.append(letter)
                offsets.append(self.at)
            self.at += width
        while len(mark) == 3 and self.text.startswith(mark + quote, self.at):
            letters.append(quote)  # quotes before the closing three belong to the string
            offsets.append(self.at)
            self.at += 1
        offsets.append(self.at)
        self.at += len(mark)
        return "".join(letters), offsets

    def _letter(self, quote: str, mark: str) -> tuple[str, int]:
        """The next character of a string's value ("" for a line join) and its width in the file."""
        letter = self.text[self.at : self.at + 1]
        if not letter or (letter == "\n" and len(mark) == 1):
            raise _LostError
        if letter != "\\" or quote == "'":
            return letter, 1
        if len(mark) == 3 and (join := _LINE_JOIN.match(self.text, self.at)):
            return "", len(join[0])
        escape = _ESCAPE.match(self.text, self.at)
        if escape is None:
            raise _LostError
        code = int(escape[2] or escape[3] or "0", 16)
        if code > 0x10FFFF:
            raise _LostError
        return _ESCAPED[escape[1]] if escape[1] else chr(code), len(escape[0])

    # -- steps --------------------------------------------------------------------------

    def _enter(self, path: KeyPath, part: str, span: Span) -> KeyPath:
        """The path below ``path``, with its key noted where it is first written."""
        path = self._below(path, part)
        self.positions.keys.setdefault(path, span)
        return path

    def _below(self, path: KeyPath, part: str | int) -> KeyPath:
        if len(path) >= SPEC_NESTING:
            raise _TooDeepError
        return (*path, part)

    def _note(self, path: KeyPath, span: Span) -> None:
        """Note the header of a table."""
        if path in self.positions.values:
            self.positions.doubled = self.positions.doubled or (path, span)
        self.positions.values[path] = span

    def _skip(self, pattern: re.Pattern[str]) -> None:
        match = pattern.match(self.text, self.at)
        assert match is not None, pattern
        self.at = match.end()

    def _match(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.at)
        if match is None:
            raise _LostError
        self.at = match.end()
        return match[0]

    def _take(self, mark: str) -> bool:
        if not self.text.startswith(mark, self.at):
            return False
        self.at += len(mark)
        return True

    def _expect(self, mark: str) -> None:
        if not self._take(mark):
            raise _LostError
