"""Expressions: text to a plain tree, by a small reader of our own.

Comes in: the text of one formula, at most ASCII. Goes out: a tree of `coadjoint.spec.core.tree`, or
an `ExpressionError` that points at the characters at fault and guesses what was meant. No part of
the text is ever executed, evaluated or passed on: numbers become fractions, names stay names.

    sum      = term {("+" | "-") term}
    term     = unary {("*" | "/") unary}
    unary    = ("+" | "-") unary | power
    power    = atom [("^" | "**") exponent]        so that -x^2 is -(x^2)
    exponent = ["-"] atom                          an integer is a product, all else pow(base, it)
    atom     = NUMBER | "pi" | NAME ["[" INTEGER ["," INTEGER] "]"]
             | FUNCTION "(" sum {"," sum} ")" | "(" sum ")"

Read next: `coadjoint.spec.core.shapes`, which says what the names and functions mean.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction

from coadjoint import limits
from coadjoint.spec.core.faults import ExpressionError, did_you_mean
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.core.tree import Binary, Call, Index, Name, Negate, Node, Number, Power

_TOKEN = re.compile(
    r"(?P<space>[ \t\n]+)"
    r"|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*)"
    r"|(?P<operator>\*\*|[-+*/^(),\[\]])",
    re.ASCII,
)
_SCIENTIFIC = re.compile(r"\d+(?:\.\d+)?[eE][-+]?\d{1,3}(?![\w.])", re.ASCII)
_BINDING = {"+": 1, "-": 1, "*": 2, "/": 2}
_POWERS = ("^", "**")

#: What people mean by characters that the language does not have.
_MEANT = {
    "=": "Write only the right-hand side.",
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


def read_expression(text: str, defined: Collection[str] = ()) -> Node:
    """The tree of an expression.

    Args:
        text: What stands in the spec.
        defined: Functions that it may call in addition to those of the language.

    Raises:
        ExpressionError: A syntax error, with what was probably meant, or a limit passed.

    >>> read_expression("2*x")
    Binary(start=0, end=3, operator='*', left=Number(start=0, end=1, value=Fraction(2, 1)), \
right=Name(start=2, end=3, name='x'))
    """
    if len(text) > limits.EXPRESSION_CHARACTERS:
        raise _limit(
            "EXPRESSION_CHARACTERS", f"the expression has {len(text)} characters", 0, len(text)
        )
    return _Reader(text, defined).expression()


@dataclass(frozen=True)
class _Token:
    kind: str  # "number", "name", an operator, or "" at the end
    text: str
    start: int
    end: int


class _Reader:
    """One reading of one text, by precedence climbing."""

    def __init__(self, text: str, defined: Collection[str]) -> None:
        self.text = text
        self.functions = {*FUNCTIONS, *defined}
        self.tokens = list(_tokens(text))
        self.at = self.nodes = self.depth = 0

    def expression(self) -> Node:
        """The whole text as one tree."""
        if self.next.kind == "":
            raise ExpressionError(
                "the expression is empty", 0, len(self.text), expected="a formula"
            )
        node = self._climb(0)
        if self.next.kind != "":
            raise self._unexpected()
        return node

    @property
    def next(self) -> _Token:
        return self.tokens[self.at]

    def _take(self) -> _Token:
        token = self.next
        self.at += 1
        return token

    # -- the grammar --------------------------------------------------------------------

    def _climb(self, binding: int) -> Node:
        """Operands joined by operators that bind tighter than ``binding``."""
        left = self._unary()
        while _BINDING.get(self.next.kind, 0) > binding:
            operator = self._take().kind
            right = self._climb(_BINDING[operator])
            left = self._count(
                Binary(operator=operator, left=left, right=right, start=left.start, end=right.end)
            )
        return left

    def _unary(self) -> Node:
        if self.next.kind not in ("+", "-"):
            return self._power()
        sign = self._take()
        with self._nest(sign):
            operand = self._unary()
        if sign.kind == "+":
            return operand
        return self._count(Negate(operand, start=sign.start, end=operand.end))

    def _power(self) -> Node:
        base = self._atom()
        if self.next.kind not in _POWERS:
            return base
        self._take()
        is_integer = self._is_integer()
        exponent = self._integer() if is_integer else self._exponent()
        if self.next.kind in _POWERS:
            problem = "a power of a power is ambiguous"
            hint = "Write (a^b)^c, or multiply the exponents out."
            raise self._fault(problem, base.start, self.next.end, "parentheses", hint)
        end = self.tokens[self.at - 1].end
        if isinstance(exponent, int):
            return self._count(Power(base=base, exponent=exponent, start=base.start, end=end))
        both = (base, exponent)
        return self._count(Call(function="pow", arguments=both, start=base.start, end=end))

    def _is_integer(self) -> bool:
        """Whether a literal integer is next, perhaps with a minus, perhaps in parentheses."""
        kinds = [token.kind for token in self.tokens[self.at : self.at + 4]]
        for form in (["number"], ["-", "number"], ["(", "number", ")"], ["(", "-", "number", ")"]):
            if kinds[: len(form)] == form:
                return "." not in self.tokens[self.at + form.index("number")].text
        return False

    def _exponent(self) -> Node:
        """An exponent that is not a literal integer: an atom, perhaps with a minus."""
        if self.next.kind != "-":
            return self._atom()
        sign = self._take()
        operand = self._atom()
        return self._count(Negate(operand, start=sign.start, end=operand.end))

    def _integer(self) -> int:
        """A literal integer, perhaps with a minus, perhaps in parentheses."""
        closing = self._take() if self.next.kind == "(" else None
        sign = -1 if self.next.kind == "-" else 1
        if sign < 0:
            self._take()
        number = self._take()
        if closing is not None:
            self._take()
        if len(number.text) > 9 or int(number.text) > limits.EXPONENT:
            raise _limit(
                "EXPONENT", f"the exponent is {number.text[:40]}", number.start, number.end
            )
        return sign * int(number.text)

    def _atom(self) -> Node:
        token = self.next
        match token.kind:
            case "number":
                self._take()
                return self._number(token)
            case "name":
                self._take()
                return self._read_name(token)
            case "(":
                self._take()
                with self._nest(token):
                    inner = self._climb(0)
                self._close(token, ")")
                return inner
        raise self._unexpected()

    def _number(self, token: _Token) -> Node:
        whole, _, decimals = token.text.partition(".")
        for digits, limit in ((whole, "INTEGER_DIGITS"), (decimals, "DECIMAL_DIGITS")):
            if len(digits) > getattr(limits, limit):
                raise _limit(limit, f"the number has {len(digits)} digits", token.start, token.end)
        return self._count(Number(Fraction(token.text), start=token.start, end=token.end))

    def _read_name(self, name: _Token) -> Node:
        """A name, a component of it, or a function of something."""
        if name.text == "pi":
            return self._circle_constant(name)
        if self.next.kind == "(":
            return self._call(name)
        if name.text in self.functions:
            problem, expected = f"the function {name.text!r} has no argument", f"{name.text}(...)"
            raise self._fault(problem, name.start, name.end, expected)
        if self.next.kind == "[":
            return self._index(name)
        return self._count(Name(name.text, start=name.start, end=name.end))

    def _circle_constant(self, name: _Token) -> Node:
        """The number pi, as what it is exactly: ``4*atan(1)``."""
        start, end = name.start, name.end
        one, four = (Number(Fraction(number), start=start, end=end) for number in (1, 4))
        part = Call(function="atan", arguments=(one,), start=start, end=end)
        return self._count(Binary(operator="*", left=four, right=part, start=start, end=end))

    def _call(self, name: _Token) -> Node:
        if name.text not in self.functions:
            expected = f"one of {', '.join(sorted(self.functions))}"
            plain = f"Write {name.text}[1] for a component, {name.text}*(...) for a product."
            hint = did_you_mean(name.text, self.functions, plain)
            problem = f"{name.text!r} is not a function"
            raise self._fault(problem, name.start, name.end, expected, hint)
        opening = self._take()
        with self._nest(opening):
            arguments = [self._climb(0)]
            while self.next.kind == ",":
                self._take()
                arguments.append(self._climb(0))
        closing = self._close(opening, ")")
        return self._count(
            Call(function=name.text, arguments=tuple(arguments), start=name.start, end=closing.end)
        )

    def _index(self, name: _Token) -> Node:
        opening = self._take()
        indices = [self._subscript(opening)]
        if self.next.kind == ",":
            self._take()
            indices.append(self._subscript(opening))
        closing = self._close(opening, "]")
        if self.next.kind == "[":
            start, end = self.next.start, self.next.end
            raise self._fault("two subscripts in a row", start, end, f"{name.text}[1, 2]")
        return self._count(
            Index(name=name.text, indices=tuple(indices), start=name.start, end=closing.end)
        )

    def _subscript(self, opening: _Token) -> int:
        token = self.next
        if token.kind != "number" or "." in token.text or len(token.text) > 9:
            raise ExpressionError(
                f"the subscript {token.text[:40]!r} is not a literal integer",
                min(token.start, len(self.text)),
                max(token.end, opening.end),
                token.text,
                "an integer counted from 1",
            )
        self._take()
        return int(token.text)

    # -- faults and limits --------------------------------------------------------------

    def _count(self, node: Node) -> Node:
        """``node``, counted."""
        self.nodes += 1
        if self.nodes > limits.EXPRESSION_NODES:
            problem = f"the expression has more than {limits.EXPRESSION_NODES} parts"
            raise _limit("EXPRESSION_NODES", problem, node.start, node.end)
        return node

    @contextmanager
    def _nest(self, token: _Token) -> Iterator[None]:
        """One level of nesting; so the reader cannot run out of stack."""
        self.depth += 1
        if self.depth > limits.EXPRESSION_NESTING:
            problem = f"the expression nests deeper than {limits.EXPRESSION_NESTING} levels"
            raise _limit("EXPRESSION_NESTING", problem, token.start, token.end)
        yield
        self.depth -= 1

    def _close(self, opening: _Token, mark: str) -> _Token:
        if self.next.kind == mark:
            return self._take()
        if self.next.kind == "":
            problem, expected = f"{opening.text!r} is never closed", f"a {mark!r} after it"
            raise self._fault(problem, opening.start, opening.end, expected)
        raise self._unexpected()

    def _unexpected(self) -> ExpressionError:
        """What stands where it cannot."""
        token = self.next
        before = self.tokens[self.at - 1] if self.at else _Token("", "", 0, 0)
        ends = before.kind in ("number", "name", ")", "]")
        where = token.start, token.end
        if ends and token.kind in ("number", "name", "("):
            simple = before.kind in ("number", "name") and token.kind == "name"
            hint = f"Write {before.text}*{token.text}." if simple else "Write * for a product."
            return self._fault(f"no operator before {token.text!r}", *where, "an operator", hint)
        if token.kind == ")" and ends:
            return self._fault("')' closes nothing", *where, "a '(' before it")
        if ends:
            hint = "Only names have subscripts." if token.kind == "[" else ""
            problem = f"{token.text!r} is misplaced"
            return self._fault(problem, *where, "an operator or the end", hint)
        problem = f"{token.text!r} is misplaced" if token.kind else "the expression ends too early"
        if not token.kind:
            where = before.start, before.end
        return self._fault(problem, *where, "a number, a name or '('")

    def _fault(
        self, problem: str, start: int, end: int, expected: str, hint: str = ""
    ) -> ExpressionError:
        """A fault of what stands between two places."""
        return ExpressionError(problem, start, end, self.text[start:end], expected, hint)


def _tokens(text: str) -> Iterator[_Token]:
    """The tokens of a text, and an empty one at its end."""
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise _unknown_character(text, at)
        kind, token = str(match.lastgroup), match[0]
        if kind == "number":
            _check_number(text, at)
        if kind == "name" and text.startswith("_", match.end()):
            raise _unknown_character(text, match.end())
        if kind == "name" and len(token) > limits.NAME_CHARACTERS:
            problem = f"the name {token[:40]!r} has {len(token)} characters"
            raise _limit("NAME_CHARACTERS", problem, at, match.end())
        if kind != "space":
            yield _Token(token if kind == "operator" else kind, token, at, match.end())
        at = match.end()
    yield _Token("", "", len(text), len(text))


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


def _unknown_character(text: str, at: int) -> ExpressionError:
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


def _limit(limit: str, problem: str, start: int, end: int) -> ExpressionError:
    """A refusal that names its limit."""
    return ExpressionError(problem, start, end, problem, limit=limit)
