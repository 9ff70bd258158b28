"""The Program: straight-line statements over a closed set of nodes, no language yet.

Comes in: nothing. Goes out: the records that `coadjoint.lower` fills, every printer prints and
nothing else, which is why two targets can agree to the last bit: each node is one IEEE operation,
operands stand in the order in which they are evaluated, numbers are exact until the printer.
Read next: `coadjoint.lower.evaluation`, and `coadjoint.lower.lowering`, which makes Programs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from typing import Literal

from coadjoint.elementary import ELEMENTARY
from coadjoint.exact.factored import count_factor, count_solve

#: When a statement is computed: once for all members that share parameters, or for each member.
LEVELS = ("parameters", "member")

#: Elementary functions a Program may call; each has the same meaning in every target.
FUNCTIONS = tuple(ELEMENTARY)


#: What a statement depends on.
Level = Literal["parameters", "member"]


@dataclass(frozen=True, slots=True)
class Number:
    """An exact constant; a printer writes the nearest double."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Symbol:
    """An input or an earlier statement by name."""

    name: str


@dataclass(frozen=True, slots=True)
class Negate:
    """``-operand``."""

    operand: Node


@dataclass(frozen=True, slots=True)
class Add:
    """``left + right``; a difference is ``Add(left, Negate(right))``, the same bits in IEEE."""

    left: Node
    right: Node


@dataclass(frozen=True, slots=True)
class Multiply:
    """``left * right``."""

    left: Node
    right: Node


@dataclass(frozen=True, slots=True)
class Divide:
    """``left / right``."""

    left: Node
    right: Node


@dataclass(frozen=True, slots=True)
class Call:
    """``function(argument, other)`` for a function of `FUNCTIONS`, most of which have no other."""

    function: str
    argument: Node
    other: Node | None = None


@dataclass(frozen=True, slots=True)
class Factors:
    """L and D of a symmetric matrix by the loop of `coadjoint.exact.factored`: several numbers.

    It is the value of a statement, and no operand but that of `Solution` and `Item` by its name.

    Attributes:
        size: How many rows the matrix has.
        entries: On and below the diagonal, row by row.
    """

    size: int
    entries: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Solution:
    """The x of ``A x = b`` by the same module: several numbers, the value of a statement.

    Attributes:
        factors: The name of L and D.
        known: b.
    """

    factors: Node
    known: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Item:
    """One of several numbers: an unknown of a solution, or an entry of L and D.

    Attributes:
        of: The name of these numbers.
        place: Which one, counted from 0.
    """

    of: Node
    place: int


Node = Number | Symbol | Negate | Add | Multiply | Divide | Call | Factors | Solution | Item
#: Statements of several numbers.
Several = Factors | Solution
#: The nodes that are operations on others, by the name of what they cost.
OPERATIONS: Mapping[str, type[Add | Multiply | Divide | Negate]] = {
    "add": Add,
    "multiply": Multiply,
    "divide": Divide,
    "negate": Negate,
}
ZERO = Number(Fraction(0))
ONE = Number(Fraction(1))


@dataclass(frozen=True, slots=True)
class Statement:
    """``name = value``; each name is assigned once.

    Attributes:
        name: A name of the spec (``Omega1``) or a temporary (``_p1``, ``_t1``: a spec name cannot
            begin with an underscore).
        value: What is computed, of inputs and earlier statements.
        level: ``"parameters"`` if it depends on parameters alone, and so is computed once for all
            members that share them; else ``"member"``.
    """

    name: str
    value: Node
    level: Level


@dataclass(frozen=True, slots=True)
class Output:
    """One row of the result.

    Attributes:
        label: What it is, for comments and messages: ``dPi1/dt``.
        value: What is computed, of inputs and statements.
    """

    label: str
    value: Node


@dataclass(frozen=True)
class Table:
    """Sums of products of two values, with one table of coefficients.

    Row i is the sum of ``c * left[j] * right[k]`` over the entries ``(i, j, k, c)``, from left to
    right: over all entries with the first pair of vectors, then with the next pair.

    Attributes:
        entries: i, j, k and c, by rows, of which each has at least one entry. The place after the
            last value of a vector stands for the number 1.
        vectors: Names of the values, and of what else products are of, in the same order: those of
            rows of the first argument, then those of member statements ``scale * row``.
        scaled: Of each of these statements, the place of its row in a vector.
        scales: The numbers or names of parameters and their statements that stand before these.
        passes: Left and right vector of each pass over the entries.
    """

    entries: tuple[tuple[int, int, int, Fraction], ...]
    vectors: tuple[tuple[str, ...], ...]
    scaled: tuple[int, ...]
    scales: tuple[Number | Symbol, ...]
    passes: tuple[tuple[int, int], ...]

    @property
    def names(self) -> frozenset[str]:
        """Names of all factors."""
        return frozenset(name for names in self.vectors for name in names)

    def columns(self) -> dict[str, tuple[float, ...]]:
        """The table as texts have it, by name.

        These are where the entries of each row begin and where those of the last one end, places of
        left and right factors, coefficients, and rows that are scaled.
        """
        counts = Counter(i for i, *_ in self.entries)
        return {
            "table_starts": tuple(accumulate((counts[i] for i in range(len(counts))), initial=0)),
            "table_left": tuple(j for _, j, _, _ in self.entries),
            "table_right": tuple(k for _, _, k, _ in self.entries),
            "table_coefficients": tuple(float(c) for *_, c in self.entries),
            "table_scaled": self.scaled,
        }

    def sums(self) -> list[Node]:
        """The rows, written out."""
        rows: dict[int, Node] = {}
        for left, right in self.passes:
            a, b = (self._factors(place) for place in (left, right))
            lefts = {(c, j): Multiply(Number(c), a[j]) for _, j, _, c in self.entries}
            for i, j, k, c in self.entries:
                term = Multiply(lefts[c, j], b[k])
                rows[i] = Add(rows[i], term) if i in rows else term
        return list(rows.values())

    def _factors(self, vector: int) -> tuple[Node, ...]:
        """The values of a vector, and the number 1."""
        return (*map(Symbol, self.vectors[vector]), ONE)

    def products(self) -> list[tuple[str, Node]]:
        """The statements ``scale * row`` by name, vector by vector."""
        count = len(self.scaled)
        return [
            (name, Multiply(scale, Symbol(names[place])))
            for names in self.vectors
            for name, place, scale in zip(names[-count:], self.scaled, self.scales, strict=True)
        ]


@dataclass(frozen=True)
class Program:
    """One function of a kernel.

    Attributes:
        name: One of `coadjoint.kernel_functions`.
        state: Component names of the state, in order, and of what follows it in the same array.
        parameters: Component names of the parameters, in order.
        statements: In the order of evaluation, those of level ``parameters`` first.
        outputs: One per row of the result, row by row.
        shape: Shape of the result for one member, e.g. ``(6,)``, ``(6, 6)``, ``()``.
        inputs: Component names of the inputs, in order; empty where the spec declares none.
        time: The name of the time; empty where the spec declares none.
        table: What the outputs are the sums of, where targets print loops in their place.
        factored: The same function in fewer products that move, where there is one: recurrences are
            made of it. It begins with the same statements of level ``parameters``.
    """

    name: str
    state: tuple[str, ...]
    parameters: tuple[str, ...]
    statements: tuple[Statement, ...]
    outputs: tuple[Output, ...]
    shape: tuple[int, ...]
    inputs: tuple[str, ...] = ()
    time: tuple[str, ...] = ()
    table: Table | None = None
    factored: Program | None = None

    @property
    def arrays(self) -> dict[str, tuple[str, ...]]:
        """The arrays that the function takes, each with the names of its rows.

        Those of inputs and time are there only where the spec declares some.
        """
        driving = {"inputs": self.inputs, "time": self.time}
        given = {"state": self.state, "parameters": self.parameters}
        return given | {name: rows for name, rows in driving.items() if rows}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all rows of all arrays."""
        return tuple(name for rows in self.arrays.values() for name in rows)

    def statements_at(self, level: str) -> tuple[Statement, ...]:
        """The statements of one level."""
        return tuple(statement for statement in self.statements if statement.level == level)

    def values(self) -> Iterator[Node]:
        """The values of all statements and outputs, in order; the sums of a table are left out."""
        yield from (statement.value for statement in self.statements)
        if self.table is None:
            yield from (output.value for output in self.outputs)

    @property
    def solves_by_loop(self) -> bool:
        """Whether a statement is a loop that solves equations."""
        return any(isinstance(statement.value, Factors) for statement in self.statements)

    def names_used(self) -> frozenset[str]:
        """Names that some statement or output reads."""
        nodes = (node for value in self.values() for node in walk(value))
        names = frozenset(node.name for node in nodes if isinstance(node, Symbol))
        return names if self.table is None else names | self.table.names

    def operation_counts(self, level: str = "member") -> dict[str, int]:
        """Floating-point operations by kind; outputs count as ``member``.

        A negation inside a sum is a subtraction and costs nothing of its own.
        """
        counts = dict.fromkeys((*OPERATIONS, *FUNCTIONS), 0)
        values = [statement.value for statement in self.statements_at(level)]
        if level == "member" and self.table is None:
            values += [output.value for output in self.outputs]
        elif level == "member" and self.table is not None:
            products = len(self.table.entries) * len(self.table.passes)
            counts |= {"add": products - len(self.outputs), "multiply": 2 * products}
        for value in values:
            for node in walk(value):
                for loop, own in count_loop(node).items():
                    counts[loop] += own
                kind = operation(node)
                if kind:
                    counts[kind] += 1
                if isinstance(node, Add) and isinstance(node.right, Negate):
                    counts["negate"] -= 1
        return {kind: count for kind, count in counts.items() if count}


def count_loop(node: Node) -> dict[str, int]:
    """Operations of the loop that a node is, by kind; none of other nodes."""
    match node:
        case Factors(size=size):
            return count_factor(size)
        case Solution(known=known):
            return count_solve(len(known))
    return {}


def operation(node: Node) -> str | None:
    """The operation that a node costs, or None for a leaf and for a loop."""
    if isinstance(node, Call):
        return node.function
    return next((name for name, kind in OPERATIONS.items() if isinstance(node, kind)), None)


def children(node: Node) -> tuple[Node, ...]:
    """Operands of a node, in the order of evaluation."""
    match node:
        case Add(left, right) | Multiply(left, right) | Divide(left, right):
            return (left, right)
        case Call(argument=argument, other=other):
            return (argument,) if other is None else (argument, other)
        case Negate(operand=operand) | Item(of=operand):
            return (operand,)
        case Factors(entries=entries):
            return entries
        case Solution(factors=factors, known=known):
            return (factors, *known)
    return ()


def write_entries(name: str, value: Node) -> list[tuple[str, Node]]:
    """A statement as texts have it: operands of a loop one by one, then the loop without them.

    >>> write_entries("x", ONE)
    [('x', Number(value=Fraction(1, 1)))]
    """
    match value:
        case Factors(size=size, entries=entries):
            last: Node = Factors(size, ())
        case Solution(factors=factors, known=entries):
            last = Solution(factors, ())
        case _:
            return [(name, value)]
    return [*((f"{name}[{n}]", each) for n, each in enumerate(entries)), (name, last)]


def with_children(node: Node, operands: Iterable[Node]) -> Node:
    """The operation of a node on other operands; a leaf as it is."""
    match node:
        case Call(function=function):
            return Call(function, *operands)
        case Factors(size=size):
            return Factors(size, tuple(operands))
        case Solution():
            factors, *known = operands
            return Solution(factors, tuple(known))
        case Item(place=place):
            (of,) = operands
            return Item(of, place)
    return node if isinstance(node, Number | Symbol) else type(node)(*operands)


def walk(node: Node) -> Iterator[Node]:
    """``node`` and every node below it, parents first."""
    yield node
    for child in children(node):
        yield from walk(child)


def list_names(node: Node) -> Iterator[str]:
    """The names that a node reads, as they stand."""
    return (each.name for each in walk(node) if isinstance(each, Symbol))
