"""An expression graph in which equal values are one node, and its derivative.

Comes in: calls that build sums, products and quotients. Goes out: node numbers; equal trees get the
same number, so shared values are found by construction. Constants fold exactly, signs move outward,
and nothing is reordered: the operand order of the caller is the order of evaluation. Only where
names change places (`Graph.exchange`) operands follow the nodes that there are.
Read next: `coadjoint.lower.naming`, which turns a graph into statements.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce

from coadjoint.elementary import Arithmetic, slopes_of
from coadjoint.lower.program import (
    Call,
    Factors,
    Item,
    Node,
    Number,
    Solution,
    Symbol,
    children,
    operation,
)


class Graph:
    """Nodes by number; the kinds are those of `coadjoint.lower.program`."""

    def __init__(self) -> None:
        self.kinds: list[str] = []
        self.operands: list[tuple[int, ...]] = []
        self.payload: list[str | Fraction] = []
        self._numbers: dict[tuple[str, tuple[int, ...], str | Fraction], int] = {}

    def _intern(self, kind: str, operands: tuple[int, ...], payload: str | Fraction = "") -> int:
        key = (kind, operands, payload)
        if key not in self._numbers:
            self._numbers[key] = len(self.kinds)
            self.kinds.append(kind)
            self.operands.append(operands)
            self.payload.append(payload)
        return self._numbers[key]

    # -- leaves -------------------------------------------------------------------------

    def number(self, value: Fraction | int) -> int:
        """An exact constant; negative ones are the negation of their magnitude."""
        if value < 0:
            return self._intern("negate", (self.number(-value),))
        return self._intern("number", (), Fraction(value))

    def symbol(self, name: str) -> int:
        """An input or statement."""
        return self._intern("symbol", (), name)

    def node_of_name(self, name: str, numbers: Mapping[str, Fraction]) -> int:
        """The number that a name stands for, or its symbol."""
        return self.number(numbers[name]) if name in numbers else self.symbol(name)

    def _constant(self, node: int) -> Fraction | None:
        """The value of a constant node, else None."""
        if self.kinds[node] == "negate":
            inner = self._constant(self.operands[node][0])
            return None if inner is None else -inner
        value = self.payload[node]
        return value if self.kinds[node] == "number" and isinstance(value, Fraction) else None

    def is_zero(self, node: int) -> bool:
        """Whether a node is the constant 0."""
        return self._constant(node) == 0

    # -- operations ---------------------------------------------------------------------

    def negate(self, a: int) -> int:
        """``-a``."""
        if self.kinds[a] == "negate":
            return self.operands[a][0]
        return a if self.is_zero(a) else self._intern("negate", (a,))

    def add(self, a: int, b: int) -> int:
        """``a + b``."""
        if self.is_zero(a):
            return b
        if self.is_zero(b):
            return a
        x, y = self._constant(a), self._constant(b)
        if x is not None and y is not None:
            return self.number(x + y)
        if self.kinds[a] == "negate" and self.kinds[b] == "negate":
            return self.negate(self.add(self.operands[a][0], self.operands[b][0]))
        if self.kinds[a] == "negate":  # b - a reads better than -a + b; the bits are the same
            a, b = b, a
        if ("add", (b, a), "") in self._numbers:
            a, b = b, a
        elif self.kinds[b] == "negate":  # b - a where there is a - b
            opposite = self._numbers.get(("add", (self.operands[b][0], self.negate(a)), ""))
            if opposite is not None:
                return self.negate(opposite)
        return self._intern("add", (a, b))

    def multiply(self, a: int, b: int) -> int:
        """``a * b``."""
        x, y = self._constant(a), self._constant(b)
        if x is not None and y is not None:
            return self.number(x * y)
        if x == 0 or y == 0:
            return self.number(0)
        if x == 1:
            return b
        if y == 1:
            return a
        if self.kinds[a] == "negate":
            return self.negate(self.multiply(self.operands[a][0], b))
        if self.kinds[b] == "negate":
            return self.negate(self.multiply(a, self.operands[b][0]))
        return self._intern("multiply", (a, b))

    def divide(self, a: int, b: int) -> int:
        """``a / b``."""
        x, y = self._constant(a), self._constant(b)
        if x == 0 or y == 1:
            return a
        if x is not None and y is not None and y != 0:
            return self.number(x / y)
        if self.kinds[a] == "negate":
            return self.negate(self.divide(self.operands[a][0], b))
        if self.kinds[b] == "negate":
            return self.negate(self.divide(a, self.operands[b][0]))
        return self._intern("divide", (a, b))

    def call(self, function: str, *arguments: int) -> int:
        """``function(arguments)``."""
        return self._intern("call", arguments, function)

    # -- loops --------------------------------------------------------------------------

    def factors(self, entries: Sequence[int]) -> int:
        """L and D of a symmetric matrix, given on and below the diagonal."""
        return self._intern("factors", tuple(entries))

    def solution(self, factors: int, known: Sequence[int]) -> int:
        """The unknowns of symmetric equations."""
        return self._intern("solution", (factors, *known))

    def item(self, several: int, place: int) -> int:
        """One of several numbers."""
        return self._intern("item", (several,), Fraction(place))

    # -- sums and products --------------------------------------------------------------

    def sum(self, terms: Iterable[int]) -> int:
        """Terms in pairs, pairs of pairs and so on, a term without a minus sign first.

        Half as deep as from left to right, so fewer roundings meet one term; four terms read as
        two cross products do: ``a*b - c*d + (e*f - g*h)``.
        """
        ordered = list(terms)
        if not ordered:
            return self.number(0)
        plain = next((n for n, term in enumerate(ordered) if self.kinds[term] != "negate"), 0)
        return self._pairwise([ordered[plain], *ordered[:plain], *ordered[plain + 1 :]])

    def _pairwise(self, terms: list[int]) -> int:
        if len(terms) == 1:
            return terms[0]
        half = 1 << (len(terms) - 1).bit_length() - 1  # the largest power of two below the number
        return self.add(self._pairwise(terms[:half]), self._pairwise(terms[half:]))

    def product(self, factors: Iterable[int]) -> int:
        """Factors from left to right."""
        total = self.number(1)
        for factor in factors:
            total = self.multiply(total, factor)
        return total

    # -- to and from trees --------------------------------------------------------------

    def insert(self, tree: Node, values: Mapping[str, int]) -> int:
        """The number of a Program's node, with some names replaced by nodes."""
        match tree:
            case Number(value=value):
                return self.number(value)
            case Symbol(name=name):
                return values[name] if name in values else self.symbol(name)
            case Call(function=function):
                return self.call(function, *(self.insert(each, values) for each in children(tree)))
        operands = [self.insert(child, values) for child in children(tree)]
        match tree:
            case Factors():
                return self.factors(operands)
            case Solution():
                return self.solution(operands[0], operands[1:])
            case Item(place=place):
                return self.item(operands[0], place)
        return int(getattr(self, str(operation(tree)))(*operands))

    # -- names that change places -------------------------------------------------------

    def exchange(self, node: int, names: Mapping[str, str], known: dict[int, int]) -> int:
        """A node in which names change places.

        What an existing node is but for its sign and the order of two operands is made of that one.

        Args:
            node: The node.
            names: The other name of each that changes.
            known: Nodes that are exchanged already; filled on the way.
        """
        if node not in known:
            kind, payload = self.kinds[node], self.payload[node]
            operands = [self.exchange(each, names, known) for each in self.operands[node]]
            if kind == "symbol":
                known[node] = self.symbol(names.get(str(payload), str(payload)))
            elif kind == "number":
                known[node] = node
            elif kind == "call":
                known[node] = self.call(str(payload), *operands)
            elif kind == "add":
                known[node] = self._find_sum(*operands)
            elif kind == "multiply":
                known[node] = self._find_product(*operands)
            else:
                known[node] = int(getattr(self, kind)(*operands))
        return known[node]

    def _find_sum(self, a: int, b: int) -> int:
        """``a + b`` by the sum that there is: that, ``b + a``, or the negative of one of these."""
        if ("add", (b, a), "") in self._numbers:
            return self.add(b, a)
        others = self.negate(a), self.negate(b)
        for pair in (others, others[::-1]):
            if ("add", pair, "") in self._numbers:
                return self.negate(self._numbers["add", pair, ""])
        return self.add(a, b)

    def _find_product(self, a: int, b: int) -> int:
        """``a * b`` by the product that there is, but for its sign."""
        plain = tuple(self.operands[x][0] if self.kinds[x] == "negate" else x for x in (a, b))
        product = self.multiply(b, a) if ("multiply", plain[::-1], "") in self._numbers else None
        return self.multiply(a, b) if product is None else product

    # -- derivative ---------------------------------------------------------------------

    def derivative(self, node: int, slopes: dict[int, dict[str, int]]) -> dict[str, int]:
        """Derivatives of a node by every variable, by forward accumulation; zeros left out.

        Args:
            node: What to differentiate.
            slopes: Derivatives already known by node number, at least those of the variables and of
                named statements; filled on the way.
        """
        if node not in slopes:
            parts = [self.derivative(operand, slopes) for operand in self.operands[node]]
            variables = dict.fromkeys(name for part in parts for name in part)
            own = {name: self._slope(node, name, parts) for name in variables}
            slopes[node] = {name: s for name, s in own.items() if not self.is_zero(s)}
        return slopes[node]

    def _slope(self, node: int, name: str, parts: list[dict[str, int]]) -> int:
        """Derivative of a node by one variable from those of its operands."""
        zero = self.number(0)
        da = parts[0].get(name, zero)
        a = self.operands[node][0]
        match self.kinds[node]:
            case "negate":
                return self.negate(da)
            case "call":
                return self._call_slope(node, [part.get(name, zero) for part in parts])
        db, b = parts[1].get(name, zero), self.operands[node][1]
        match self.kinds[node]:
            case "add":
                return self.add(da, db)
            case "multiply":
                return self.add(self.multiply(da, b), self.multiply(a, db))
        # (a/b)' = (a' - (a/b) b') / b, which shares the quotient with the value
        return self.divide(self.add(da, self.negate(self.multiply(node, db))), b)

    def _call_slope(self, node: int, inner: Sequence[int]) -> int:
        """The derivative of a call from those of its arguments."""
        own = Arithmetic(
            number=self.number,
            call=self.call,
            add=self.add,
            multiply=self.multiply,
            divide=self.divide,
            negate=self.negate,
        )
        outer = slopes_of(str(self.payload[node]), self.operands[node], node, own)
        terms = map(self.multiply, outer, inner)
        return reduce(self.add, terms)
