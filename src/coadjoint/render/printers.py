"""Render, printing: a node of a Program becomes text of one language.

Comes in: nodes. Goes out: an expression or an assignment that the language evaluates in exactly
the order of the tree, with no parenthesis that it does not need; long ones are broken at their
operators the way our Python formatter breaks them. What targets share stands here: ``+ - * /`` and
unary minus bind alike in Python and in C.
Read next: `coadjoint.render.targets.c.printer`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, Final

from coadjoint.errors import SpecError
from coadjoint.lower.program import (
    Add,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Negate,
    Node,
    Number,
    Several,
    Solution,
    Symbol,
    children,
    write_entries,
)

WIDTH: Final = 100

# How tightly each form binds; an operand that binds less tightly than its place asks for is
# parenthesised.
SUM, PRODUCT, SIGN, ATOM = range(4)

Compound = Add | Multiply | Divide
#: One operand of a sum or product, after the operator that joins it to what stands before.
Link = tuple[str, Node]


def number_text(value: Fraction) -> str:
    """The shortest text that reads back to the double nearest to ``value``.

    Raises:
        SpecError: No finite double is near: ``value`` is too large, or not zero and too small.

    >>> number_text(Fraction(2)), number_text(Fraction(1, 3)), number_text(Fraction(-1, 10**7))
    ('2.0', '0.3333333333333333', '-1e-07')
    """
    try:
        nearest = float(value)  # correctly rounded
    except OverflowError:
        nearest = math.inf
    if math.isinf(nearest) or (nearest == 0) != (value == 0):
        size = "above 1.8e308" if nearest else "below 4.9e-324"
        raise SpecError(
            f"the constant {_brief(value)} has no double near it: its magnitude is {size}; "
            "expected a number of ordinary size. Choose other units.",
            found=_brief(value),
            expected="a magnitude between 4.9e-324 and 1.8e308",
        )
    return repr(nearest)


def _brief(value: Fraction) -> str:
    """A fraction as text, or the power of ten that is near it where that is long."""
    bits = value.numerator.bit_length() - value.denominator.bit_length()
    return str(value) if abs(bits) < 100 else f"{'-' if value < 0 else ''}1e{round(bits * 0.30103)}"


@dataclass(frozen=True)
class Printer:
    """Writes nodes in one language; assignments in Python.

    Attributes:
        function_prefix: What stands before the name of an elementary function.
        function_suffix: What stands behind it.
        names: Names of functions that have others than ours.
        ends_with_comma: Whether one stands behind the last of arguments on lines of their own.

    >>> x, y = Symbol("x"), Symbol("y")
    >>> Printer("np.").text(Add(Multiply(x, Add(x, y)), Negate(Call("sqrt", y))))
    'x * (x + y) - np.sqrt(y)'
    """

    function_prefix: str
    function_suffix: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    ends_with_comma: bool = True
    #: What stands before the names of the loops that solve equations.
    loop_prefix: ClassVar[str] = ""

    def text(self, node: Node) -> str:
        """``node`` on one line."""
        match node:
            case Number(value=value):
                return number_text(value)
            case Symbol(name=name):
                return name
            case Call(function=function):
                arguments = ", ".join(map(self.argument, children(node)))
                return f"{self._name(function)}({arguments})"
            case Item(of=of, place=place):
                return f"{self.text(of)}[{place}]"
            case Negate(operand=operand):
                return "-" + self._operand(operand, ATOM)  # so never "--x", a decrement in C
            case Add() | Multiply() | Divide():
                return self._chain_text(node)
        raise AssertionError(node)  # a loop, which is no expression

    def argument(self, node: Node) -> str:
        """``node`` as the argument of a function."""
        return self.text(node)

    def _name(self, function: str) -> str:
        own = self.names.get(function, function)
        return f"{self.function_prefix}{own}{self.function_suffix}"

    def _chain_text(self, node: Compound) -> str:
        (_, first), *rest = _chain(node)
        place = _binding(node)
        text = self._operand(first, place)
        return text + "".join(f" {sign} {self._operand(right, place + 1)}" for sign, right in rest)

    def _operand(self, node: Node, place: int) -> str:
        """``node`` on one line, in parentheses if it binds less tightly than ``place`` asks for."""
        text = self.text(node)
        return text if _binding(node) >= place else f"({text})"

    def assignment(self, node: Node, to: str, column: int = 4, comment: str = "") -> str:
        """``to = node``, broken as our formatter breaks it; the first line is not indented.

        >>> Printer("np.").assignment(Symbol("Pi1"), "out[0]", 4, "dPi1/dt")
        'out[0] = Pi1  # dPi1/dt'
        """
        if isinstance(node, Several):
            return self.loop(node, to, column)
        note = f"  # {comment}" if comment else ""
        line = f"{to} = {self.text(node)}"
        if column + len(line) + len(note) <= WIDTH or isinstance(node, Symbol | Number):
            return line + note
        if not note and not _is_long_chain(node):
            # The formatter would move these parentheses onto an operand; a comment holds them.
            note = "  # in this order"
        inner = self.break_lines(node, WIDTH - column - 4)
        return indent([f"{to} = ({note}", *("    " + text for text in inner), ")"], column)

    def loop(self, node: Several, to: str, column: int) -> str:
        """A list with its entries, and the loop over them that puts its results in their place.

        >>> print(Printer("").loop(Factors(1, (Symbol("a"),)), "f", column=0))
        f = [0.0] * 1
        f[0] = a
        _factor(f, 1)
        """
        lines = self._write_loop(node, to, column)
        return indent([f"{to} = [0.0] * {len(lines) - 1}", *lines], column)

    def _write_loop(self, node: Several, name: str, column: int) -> list[str]:
        """The lines that fill an array, and the call of the loop."""
        *entries, (_, last) = write_entries(name, node)
        given = f"{name}, {last.size}" if isinstance(last, Factors) else ""
        if isinstance(last, Solution):
            given = f"{self.text(last.factors)}, {name}, {len(entries)}"
        called = "factor" if isinstance(last, Factors) else "solve"
        return [
            *(self.assignment(value, to, column) for to, value in entries),
            f"{self.loop_prefix}_{called}({given})",
        ]

    def break_lines(self, node: Node, width: int) -> list[str]:
        """``node`` on lines of at most ``width`` columns where it can be, one operand to a line."""
        return self._break_operand(node, SUM, width, lead="")

    def _break_operand(self, node: Node, place: int, width: int, lead: str) -> list[str]:
        """The same for an operand at its place; ``lead`` begins the first line."""
        text = lead + self._operand(node, place)
        if len(text) <= width:
            return [text]
        if _binding(node) < place:
            return self._bracket(lead + "(", node, width)
        match node:
            case Call(function=function, argument=argument, other=None):
                return self._bracket(f"{lead}{self._name(function)}(", argument, width)
            case Call(function=function):
                return self._break_call(f"{lead}{self._name(function)}(", children(node), width)
            case Negate(operand=operand):
                return self._break_operand(operand, ATOM, width, lead + "-")
            case Add() | Multiply() | Divide():
                return self._break_chain(node, width, lead)
        return [text]

    def _bracket(self, opening: str, node: Node, width: int) -> list[str]:
        inner = self._break_operand(node, SUM, width - 4, lead="")
        return [opening, *("    " + line for line in inner), ")"]

    def _break_call(self, opening: str, arguments: Sequence[Node], width: int) -> list[str]:
        """A call of a function of several arguments, on one line of their own or one line each."""
        joined = ", ".join(map(self.argument, arguments))
        if len(joined) <= width - 4:
            return [opening, "    " + joined, ")"]
        lines = [self._break_operand(each, SUM, width - 5, lead="") for each in arguments]
        for each in lines[: None if self.ends_with_comma else -1]:
            each[-1] += ","
        return [opening, *("    " + line for each in lines for line in each), ")"]

    def _break_chain(self, node: Compound, width: int, lead: str) -> list[str]:
        (_, first), *rest = _chain(node)
        place = _binding(node)
        lines = self._break_operand(first, place, width, lead)
        for sign, right in rest:
            lines += self._break_operand(right, place + 1, width, f"{sign} ")
        return lines


def python_call(arguments: Sequence[str], to: str, column: int, end: str = "") -> str:
    """``to(arguments)`` and ``end``, broken as our formatter breaks it.

    >>> python_call(['"m"', "shape=()"], to="Quantity", column=4, end=",")
    'Quantity("m", shape=()),'
    """
    joined = ", ".join(arguments)
    if column + len(f"{to}({joined}){end}") <= WIDTH:
        return f"{to}({joined}){end}"
    if column + 4 + len(joined) <= WIDTH:
        return indent([f"{to}(", "    " + joined, f"){end}"], column)
    lines = ["    " + line for entry in arguments for line in _entry_lines(entry, column + 4)]
    return indent([f"{to}(", *lines, f"){end}"], column)


def _entry_lines(entry: str, column: int) -> list[str]:
    """``entry,``; a flat tuple that is too long stands one item to a line."""
    if column + len(entry) + 1 <= WIDTH or not entry.endswith(")"):
        return [entry + ","]
    opening, items = entry[:-1].split("(", 1)
    return [f"{opening}(", *(f"    {item}," for item in items.split(", ")), "),"]


def indent(lines: list[str], column: int) -> str:
    """Lines as one text, all but the first moved to ``column``."""
    return ("\n" + " " * column).join(lines)


def _binding(node: Node) -> int:
    """How tightly the text of ``node`` binds."""
    match node:
        case Add():
            return SUM
        case Multiply() | Divide():
            return PRODUCT
        case Negate():
            return SIGN
        case Number(value=value) if value < 0:
            return SIGN
    return ATOM


def _is_long_chain(node: Node) -> bool:
    """Whether a sum or product has three operands or more."""
    return isinstance(node, Compound) and len(_chain(node)) > 2


def _chain(node: Compound) -> list[Link]:
    """The operands of a left-nested sum or product, in order, the first with an empty operator."""
    links: list[Link] = []
    current: Node = node
    while isinstance(current, Compound) and _binding(current) == _binding(node):
        links.append(_link(current))
        current = current.left
    return [("", current), *reversed(links)]


def _link(node: Compound) -> Link:
    """The last operator of ``node`` and its right operand; ``a + (-b)`` reads ``a - b``."""
    match node:
        case Add(right=Negate(operand=operand)):
            return "-", operand
        case Add(right=Number(value=value)) if value < 0:
            return "-", Number(-value)
        case Add(right=right):
            return "+", right
        case Multiply(right=right):
            return "*", right
    return "/", node.right
