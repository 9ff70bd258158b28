"""Tokens: the numbers, names and operators of an expression, each with its place.

Comes in: the text of one formula. Goes out: its tokens, or an `ExpressionError` for a character
that is not part of the language, with what was probably meant.
Read next: `coadjoint.spec.core.expressions`.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from coadjoint import limits
from coadjoint.spec.core.faults import ExpressionError

_TOKEN = re.compile(
    r"(?P<space>[ \t\n]+)"
    r"|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*)"
    r"|(?P<operator>\*\*|[<>=!]=|[-+*/^(),<>\[\]])",
    re.ASCII,
)
_SCIENTIFIC = re.compile(r"\d+(?:\.\d+)?[eE][-+]?\d{1,3}(?![\w.])", re.ASCII)

#: What may stand between the two sides of the condition of a sum.
RELATIONS = ("<", "<=", ">", ">=", "==", "!=")
#: What people mean by characters that the language does not have.
_MEANT = {
    "=": "Write only the right-hand side; of what is 0 somewhere the difference of both sides.",
    ".": "A name has no attributes; a number has digits on both sides of its point, as 0.5.",
    "'": "There is no text in an expression; a transposed matrix is transpose(A).",
    '"': "There is no text in an expression.",
    "|": "The length of a vector is norm(a).",
    ";": "An expression is one formula.",
    "@": "Write * for products of matrices.",
    "_": "Names begin and end with a letter or digit and have single underscores inside.",
    "{": "Group with round parentheses.",
    "}": "Group with round parentheses.",
    "%": "Write a fraction as a/b.",
    "!": "Write products out.",
    "#": "Comments stand outside the quotes.",
    "\u00d7": "The cross product is cross(a, b).",
    "\u00b7": "The dot product is dot(a, b), a product *.",
    "\u2212": "Write the minus sign of the keyboard, -.",
}


@dataclass(frozen=True)
class Token:
    """One token."""

    kind: str  # "number", "name", an operator, or "" at the end
    text: str
    start: int
    end: int


def read_tokens(text: str) -> Iterator[Token]:
    """The tokens of a text, and an empty one at its end."""
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise unknown_character(text, at)
        kind, token = str(match.lastgroup), match[0]
        if kind == "number":
            _check_number(text, at)
        if kind == "name" and text.startswith("_", match.end()):
            raise unknown_character(text, match.end())
        if kind == "name" and len(token) > limits.NAME_CHARACTERS:
            problem = f"the name {token[:40]!r} has {len(token)} characters"
            raise refuse_by_limit("NAME_CHARACTERS", problem, at, match.end())
        if kind != "space":
            yield Token(token if kind == "operator" else kind, token, at, match.end())
        at = match.end()
    yield Token("", "", len(text), len(text))


def _check_number(text: str, at: int) -> None:
    """Refuse 1e5, which is not exact arithmetic's way to write a number."""
    match = _SCIENTIFIC.match(text, at)
    if match is not None:
        value = Fraction(match[0]) if abs(int(re.split("[eE]", match[0])[1])) <= 20 else None
        shown = f"Write {_decimal(value)}." if value is not None else "Write the digits out."
        problem = f"{match[0]!r} has an exponent"
        raise ExpressionError(problem, at, match.end(), match[0], "a decimal number", shown)


def _decimal(value: Fraction) -> str:
    """A decimal fraction without an exponent."""
    if value.denominator == 1:
        return str(value.numerator)
    places = next(n for n in range(1, 100) if (value * 10**n).denominator == 1)
    digits = str(int(value * 10**places)).rjust(places + 1, "0")
    return f"{digits[:-places]}.{digits[-places:]}"


def unknown_character(text: str, at: int) -> ExpressionError:
    """A character outside the language, with what was probably meant."""
    letter = text[at]
    if letter == "_":
        start = at - len(text[:at]) + len(text[:at].rstrip(_WORD))
        end = at + len(text[at:]) - len(text[at:].lstrip(_WORD))
        word = text[start:end]
        return ExpressionError(
            f"{word[:40]!r} is not a name", start, end, word, "a name", _MEANT["_"]
        )
    hint, problem = _MEANT.get(letter, ""), f"{letter!r} is not part of the language"
    if not letter.isascii():
        problem = f"{letter!r} ({_character_name(letter)}) is not ASCII"
        hint = hint or _plain_letter(letter)
    return ExpressionError(
        problem, at, at + 1, letter, "letters, digits and + - * / ^ ( ) [ ] , .", hint
    )


_WORD = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"


def _character_name(letter: str) -> str:
    return unicodedata.name(letter, f"U+{ord(letter):04X}").lower()


def _plain_letter(letter: str) -> str:
    """How to write a Greek letter or a raised digit."""
    words = unicodedata.name(letter, "").split()
    if words[:1] == ["GREEK"] and "LETTER" in words:
        plain = words[words.index("LETTER") + 1].lower()
        return f"Write {plain.capitalize() if 'CAPITAL' in words else plain}."
    if words[:1] == ["SUPERSCRIPT"] and unicodedata.digit(letter, None) is not None:
        return f"Write ^{unicodedata.digit(letter)}."
    return ""


def refuse_by_limit(limit: str, problem: str, start: int, end: int) -> ExpressionError:
    """A refusal that names its limit."""
    return ExpressionError(problem, start, end, problem, limit=limit)
