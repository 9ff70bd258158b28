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

and where members are counted by an index, as another ``atom``,

    NAME "[" sum {"," sum} "]"                     whole numbers, of indices and their number
    "sum" "(" INDEX {"," INDEX} "," [sum RELATION sum ","] sum ")"

Read next: `coadjoint.spec.core.shapes`, which says what the names and functions mean.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any, TypeGuard

from coadjoint import limits
from coadjoint.spec.core.faults import ExpressionError, did_you_mean
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.core.tokens import (
    RELATIONS,
    Token,
    read_tokens,
    refuse_by_limit,
    unknown_character,
)
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Entry,
    Index,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Power,
    Sum,
)

#: Functions of what has an index: sums over members, and matrices with a row for each.
OVER_MEMBERS = ("sum", "tridiagonal")
#: Subscripts of an entry of a matrix.
MOST_SUBSCRIPTS = 2
_BINDING = {"+": 1, "-": 1, "*": 2, "/": 2}
_POWERS = ("^", "**")


def read_expression(text: str, defined: Collection[str] = (), *, indexed: bool = False) -> Node:
    """The tree of an expression.

    Args:
        text: What stands in the spec.
        defined: Functions that it may call in addition to those of the language.
        indexed: Whether it may hold sums over members, and quantities of a member.

    Raises:
        ExpressionError: A syntax error, with what was probably meant, or a limit passed.

    >>> read_expression("2*x")
    Binary(start=0, end=3, operator='*', left=Number(start=0, end=1, value=Fraction(2, 1)), \
right=Name(start=2, end=3, name='x'))
    """
    if len(text) > limits.EXPRESSION_CHARACTERS:
        raise refuse_by_limit(
            "EXPRESSION_CHARACTERS", f"the expression has {len(text)} characters", 0, len(text)
        )
    return _Reader(text, defined, indexed=indexed).expression()


class _Reader:
    """One reading of one text, by precedence climbing."""

    def __init__(self, text: str, defined: Collection[str], *, indexed: bool) -> None:
        self.text, self.indexed = text, indexed
        self.functions = {*FUNCTIONS, *defined, *(OVER_MEMBERS if indexed else [])}
        self.tokens = list(read_tokens(text))
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
    def next(self) -> Token:
        return self.tokens[self.at]

    def _take(self) -> Token:
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
            raise refuse_by_limit(
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
                closing = self._close(token, ")")
                return self._component_of(inner, token.start, closing.end)
        raise self._unexpected()

    def _number(self, token: Token) -> Node:
        whole, _, decimals = token.text.partition(".")
        for digits, limit in ((whole, "INTEGER_DIGITS"), (decimals, "DECIMAL_DIGITS")):
            if len(digits) > getattr(limits, limit):
                raise refuse_by_limit(
                    limit, f"the number has {len(digits)} digits", token.start, token.end
                )
        return self._count(Number(Fraction(token.text), start=token.start, end=token.end))

    def _read_name(self, name: Token) -> Node:
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

    def _circle_constant(self, name: Token) -> Node:
        """The number pi, as what it is exactly: ``4*atan(1)``."""
        start, end = name.start, name.end
        one, four = (Number(Fraction(number), start=start, end=end) for number in (1, 4))
        part = Call(function="atan", arguments=(one,), start=start, end=end)
        return self._count(Binary(operator="*", left=four, right=part, start=start, end=end))

    def _call(self, name: Token) -> Node:
        if name.text not in self.functions:
            expected = f"one of {', '.join(sorted(self.functions))}"
            plain = f"Write {name.text}[1] for a component, {name.text}*(...) for a product."
            if name.text == "sum":
                plain = "Sums over members need [index]; events name an observable."
            hint = did_you_mean(name.text, self.functions, plain)
            problem = f"{name.text!r} is not a function"
            raise self._fault(problem, name.start, name.end, expected, hint)
        opening = self._take()
        if name.text == "sum":
            return self._sum(name, opening)
        with self._nest(opening):
            arguments = [self._climb(0)]
            while self.next.kind == ",":
                self._take()
                arguments.append(self._climb(0))
        closing = self._close(opening, ")")
        called = self._count(
            Call(function=name.text, arguments=tuple(arguments), start=name.start, end=closing.end)
        )
        return self._component_of(called, name.start, closing.end)

    def _sum(self, name: Token, opening: Token) -> Node:
        """A sum over the members that an index counts, over their pairs, or over some of these."""
        indices = list[str]()
        while [token.kind for token in self.tokens[self.at : self.at + 2]] == ["name", ","]:
            indices.append(self._take().text)
            self._take()
        if not indices:
            problem, expected = "the sum has no index", "sum(i, ...) or sum(i, j, i < j, ...)"
            raise self._fault(problem, name.start, opening.end, expected)
        with self._nest(opening):
            term, sides, sign = self._climb(0), tuple[Node, ...](), ""
            if self.next.kind in RELATIONS:
                sign = self._take().kind
                sides = (term, self._climb(0))
                self._close(opening, ",")
                term = self._climb(0)
        end = self._close(opening, ")").end
        return self._count(
            Sum(
                indices=tuple(indices),
                term=term,
                sides=sides,
                sign=sign,
                start=name.start,
                end=end,
            )
        )

    def _index(self, name: Token) -> Node:
        opening = self._take()
        subscripts = [self._place(opening)]
        while self.next.kind == "," and (self.indexed or len(subscripts) < MOST_SUBSCRIPTS):
            self._take()
            subscripts.append(self._place(opening))
        closing = self._end_subscripts(opening, name.text)
        return self._count(_make_entry(name.text, subscripts, name.start, closing.end))

    def _component_of(self, whole: Node, start: int, end: int) -> Node:
        """What stands in parentheses or comes of a function, or a component of it."""
        if self.next.kind != "[":
            return whole
        opening, text = self._take(), self.text[start:end]
        indices = [self._subscript(opening)]
        while self.next.kind == "," and len(indices) < MOST_SUBSCRIPTS:
            self._take()
            indices.append(self._subscript(opening))
        closing = self._end_subscripts(opening, text)
        return self._count(
            Component(
                name=text, operand=whole, indices=tuple(indices), start=start, end=closing.end
            )
        )

    def _end_subscripts(self, opening: Token, name: str) -> Token:
        """The bracket that closes subscripts, behind which there is no other one."""
        closing = self._close(opening, "]")
        if self.next.kind == "[":
            start, end = self.next.start, self.next.end
            raise self._fault("two subscripts in a row", start, end, f"{name}[1, 2]")
        return closing

    def _place(self, opening: Token) -> Node:
        """A subscript: an integer or, where members are counted, what can be worked out."""
        kinds = [token.kind for token in self.tokens[self.at : self.at + 2]]
        literal = kinds[1:] and kinds[1] in (",", "]") and kinds[0] != "name"
        if not self.indexed or literal:
            at = self.next
            return Number(Fraction(self._subscript(opening)), start=at.start, end=at.end)
        with self._nest(opening):
            return self._climb(0)

    def _subscript(self, opening: Token) -> int:
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
            raise refuse_by_limit("EXPRESSION_NODES", problem, node.start, node.end)
        return node

    @contextmanager
    def _nest(self, token: Token) -> Iterator[None]:
        """One level of nesting; so the reader cannot run out of stack."""
        self.depth += 1
        if self.depth > limits.EXPRESSION_NESTING:
            problem = f"the expression nests deeper than {limits.EXPRESSION_NESTING} levels"
            raise refuse_by_limit("EXPRESSION_NESTING", problem, token.start, token.end)
        yield
        self.depth -= 1

    def _close(self, opening: Token, mark: str) -> Token:
        if self.next.kind == mark:
            return self._take()
        if self.next.kind == "":
            problem, expected = f"{opening.text!r} is never closed", f"a {mark!r} after it"
            raise self._fault(problem, opening.start, opening.end, expected)
        raise self._unexpected()

    def _unexpected(self) -> ExpressionError:
        """What stands where it cannot."""
        token = self.next
        if token.kind in RELATIONS and not self.indexed:
            return unknown_character(self.text, token.start)
        before = self.tokens[self.at - 1] if self.at else Token("", "", 0, 0)
        ends = before.kind in ("number", "name", ")", "]")
        where = token.start, token.end
        if ends and token.kind in ("number", "name", "("):
            simple = before.kind in ("number", "name") and token.kind == "name"
            hint = f"Write {before.text}*{token.text}." if simple else "Write * for a product."
            return self._fault(f"no operator before {token.text!r}", *where, "an operator", hint)
        if token.kind == ")" and ends:
            return self._fault("')' closes nothing", *where, "a '(' before it")
        if ends:
            hint = "Numbers have no subscripts." if token.kind == "[" else ""
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


def _make_entry(name: str, subscripts: list[Node], start: int, end: int) -> Node:
    """A quantity with subscripts: a component, a quantity of a member, or one to be worked out."""
    where: dict[str, Any] = {"start": start, "end": end}
    first, *rest = subscripts
    numbers = tuple(int(each.value) for each in rest if _is_whole(each))
    if len(numbers) == len(rest):
        match first:
            case Number(value=value) if _is_whole(first):
                return Index(name=name, indices=(int(value), *numbers), **where)
            case Name(name=index):
                return Member(name=name, index=index, shift=0, indices=numbers, **where)
            case Binary(operator="+" | "-" as sign, left=Name(name=index), right=Number() as by):
                if _is_whole(by):
                    shift = int(by.value) * (1 if sign == "+" else -1)
                    return Member(name=name, index=index, shift=shift, indices=numbers, **where)
    return Entry(name=name, subscripts=tuple(subscripts), **where)


def _is_whole(node: Node) -> TypeGuard[Number]:
    """Whether a node is a whole number."""
    return isinstance(node, Number) and node.value.denominator == 1
