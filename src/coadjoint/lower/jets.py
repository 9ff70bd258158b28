"""Jets: the Taylor coefficients of a motion, one order after the other.

Comes in: the Program of the rates. Goes out: `Jets`, the recurrences that every target prints.

Along a motion each value of the Program is a function of time, ``a(t + s) = a[0] + a[1] s + ...``.
What is linear in others has linear combinations of their coefficients. The rest follows from
recurrences (R. E. Moore, Interval Analysis, 1966, ch. 11; Griewank and Walther, Evaluating
Derivatives, 2008, ch. 13)::

    product   p = a b        p[k] = sum_{m=0..k} a[m] b[k-m]
    quotient  q = a / b      q[k] = (a[k] - sum_{m=1..k} b[m] q[k-m]) / b[0]
    sqrt      s = sqrt(a)    s[k] = (a[k] - sum_{m=1..k-1} s[m] s[k-m]) / (2 s[0])
    exp       e = exp(a)     e[k] = sum_{m=1..k} m a[m] e[k-m] / k
    log       l = log(a)     l[k] = (a[k] - sum_{m=1..k-1} m l[m] a[k-m] / k) / a[0]
    sin, cos  s, c of a      s[k] = sum_{m=1..k} m a[m] c[k-m] / k,  c[k] = -sum m a[m] s[k-m] / k

The coefficients of the state are the rates, ``x[k+1] = rate[k] / (k + 1)``. What depends on
parameters alone is its own order 0, and is a factor of sums rather than of each of their terms.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from coadjoint.lower.program import (
    ZERO,
    Add,
    Call,
    Divide,
    Multiply,
    Negate,
    Node,
    Number,
    Program,
    Statement,
    Symbol,
    walk,
)

#: The function that has to stand with another one, whose recurrence reads its coefficients.
PARTNERS = {"sin": "cos", "cos": "sin"}
ONE = Number(Fraction(1))


@dataclass(frozen=True, slots=True)
class Cell:
    """A value along the motion.

    Attributes:
        name: Of its coefficients.
        value: Its order 0, an operation on the order 0 of others.
        tail: Its order k > 0 where that is a combination of coefficients of this order, with
            names of cells for these; None where it follows from the recurrence of ``value``, whose
            operands are names then: a product, a quotient or a function of names.
        depth: How many recurrences stand between it and the state, one upon the other.
        partner: The sine of a cosine, the cosine of a sine; else "".
    """

    name: str
    value: Node
    tail: Node | None
    depth: int
    partner: str = ""


@dataclass(frozen=True)
class Jets:
    """The recurrences of a system, in an order in which they can be computed.

    Attributes:
        state: Component names, whose coefficients the rates give.
        driving: Names of inputs and time, whose coefficients are given.
        parameters: Names of the parameters.
        fixed: Statements that depend on parameters alone.
        cells: What is computed at each order, by depth.
        rates: The rate of each component of the state at order 0, and at orders k > 0.
    """

    state: tuple[str, ...]
    driving: tuple[str, ...]
    parameters: tuple[str, ...]
    fixed: tuple[Statement, ...]
    cells: tuple[Cell, ...]
    rates: tuple[tuple[Node, Node], ...]

    @property
    def moving(self) -> frozenset[str]:
        """Names of all that has coefficients."""
        return frozenset((*self.state, *self.driving, *(cell.name for cell in self.cells)))

    @property
    def kept(self) -> frozenset[str]:
        """Names of cells of which some recurrence reads all orders."""
        found = set[str]()
        for cell in self.cells:
            if cell.tail is None:
                found |= _reads_all_orders(cell)
        return frozenset(found).intersection(cell.name for cell in self.cells)

    @property
    def products(self) -> int:
        """Sums over pairs of coefficients at each order, which are nearly all of the cost."""
        return sum(cell.tail is None for cell in self.cells)


def _reads_all_orders(cell: Cell) -> set[str]:
    """The names of which the recurrence of a cell reads coefficients of all orders."""
    match cell.value:
        case Multiply():
            return set(_names(cell.value))
        case Divide(right=right):
            return {cell.name, *_names(right)}
        case Call(function="sqrt"):
            return {cell.name}
    return {cell.name, *_names(cell.value), *filter(None, [cell.partner])}


def _names(node: Node) -> Iterator[str]:
    """The names that a node reads, as they stand."""
    return (each.name for each in walk(node) if isinstance(each, Symbol))


def make_jets(rhs: Program) -> Jets:
    """The recurrences of the rates of a system.

    Args:
        rhs: The Program of the rates: one output for each component of the state.
    """
    return _Making(rhs).jets()


class _Making:
    """Jets in the making."""

    def __init__(self, rhs: Program) -> None:
        self.rhs = rhs
        self._fixed = list(rhs.statements_at("parameters"))
        self._constant = {*rhs.parameters, *(statement.name for statement in self._fixed)}
        self._depth = dict.fromkeys((*rhs.state, *rhs.inputs, *rhs.time), 0)
        self._cells: list[Cell] = []
        self._known: dict[Node, str] = {}
        self._count = 0

    def jets(self) -> Jets:
        """All of them."""
        for statement in self.rhs.statements_at("member"):
            self._state(statement.name, statement.value)
        rates = [self._combine(output.value) for output in self.rhs.outputs]
        return Jets(
            state=self.rhs.state,
            driving=(*self.rhs.inputs, *self.rhs.time),
            parameters=self.rhs.parameters,
            fixed=tuple(self._fixed),
            cells=tuple(sorted(self._cells, key=lambda cell: cell.depth)),
            rates=tuple(rates),
        )

    # -- cells ------------------------------------------------------------------------------------

    def _state(self, name: str, value: Node) -> None:
        """A statement of the Program as a cell of its own name."""
        whole, tail = self._combine(value)
        last = self._cells[-1] if self._cells else None
        fresh = last is not None and last.name.startswith("_j") and not last.partner
        if last is not None and fresh and whole == Symbol(last.name):
            self._known[last.value] = name  # the recurrence itself has the name
            self._cells[-1] = replace(last, name=name)
            self._depth[name] = last.depth
        else:
            self._append(Cell(name=name, value=whole, tail=tail, depth=self._depth_of(whole)))

    def _append(self, cell: Cell) -> None:
        self._cells.append(cell)
        self._depth[cell.name] = cell.depth

    def _recurrence(self, value: Node) -> Symbol:
        """The cell of an operation on names that no combination gives."""
        if isinstance(value, Multiply) and Multiply(value.right, value.left) in self._known:
            value = Multiply(value.right, value.left)
        if value not in self._known:
            name, partner, depth = self._name(), "", 1 + self._depth_of(value)
            self._known[value] = name
            if isinstance(value, Call) and value.function in PARTNERS:
                partner = self._name()
                other = Call(PARTNERS[value.function], value.argument)
                self._known[other] = partner
                self._append(Cell(name=partner, value=other, tail=None, depth=depth, partner=name))
            self._append(Cell(name=name, value=value, tail=None, depth=depth, partner=partner))
        return Symbol(self._known[value])

    def _name(self) -> str:
        """A name that nothing has yet."""
        self._count += 1
        return f"_j{self._count}"

    def _named(self, node: Node) -> Symbol:
        """What moves, as the name of a cell."""
        if isinstance(node, Symbol):
            return node
        if node not in self._known:
            whole, tail = self._combine(node)
            if isinstance(whole, Symbol):  # a recurrence has made a cell of it
                return whole
            self._known[node] = self._name()
            self._append(
                Cell(name=self._known[node], value=whole, tail=tail, depth=self._depth_of(whole))
            )
        return Symbol(self._known[node])

    def _depth_of(self, node: Node) -> int:
        return max((self._depth.get(name, 0) for name in _names(node)), default=0)

    # -- values -----------------------------------------------------------------------------------

    def _moves(self, node: Node) -> bool:
        """Whether a node depends on more than parameters."""
        return not self._constant.issuperset(_names(node))

    def _combine(self, node: Node) -> tuple[Node, Node]:
        """A node as a combination of names: at order 0, and at orders k > 0."""
        if not self._moves(node):
            return node, ZERO
        match node:
            case Symbol():
                return node, node
            case Negate(operand=operand):
                whole, tail = self._combine(operand)
                return Negate(whole), Negate(tail)
            case Add(left=left, right=right):
                (first, second), (third, fourth) = self._combine(left), self._combine(right)
                return Add(first, third), _add(second, fourth)
            case Multiply():
                return self._multiply(node)
            case Divide(left=left, right=right) if self._moves(right):
                above = self._named(left) if self._moves(left) else left
                quotient = self._recurrence(Divide(above, self._named(right)))
                return quotient, quotient
            case Divide(left=left, right=right):
                whole, tail = self._combine(left)
                return Divide(whole, right), Multiply(tail, self._reciprocal(right))
            case Call(function=function, argument=argument):
                called = self._recurrence(Call(function, self._named(argument)))
                return called, called
        raise AssertionError(node)

    def _multiply(self, node: Multiply) -> tuple[Node, Node]:
        """A product: the constant factors times the product of what moves."""
        factors = list(_factors(node))
        constant = [factor for factor in factors if not self._moves(factor)]
        moving = [factor for factor in factors if self._moves(factor)]
        if len(moving) == 1:
            whole, tail = self._combine(moving[0])
        else:
            product = self._named(moving[0])
            for factor in moving[1:]:
                product = self._recurrence(Multiply(product, self._named(factor)))
            whole = tail = product
        for factor in reversed(constant):
            whole, tail = Multiply(factor, whole), Multiply(factor, tail)
        return whole, tail

    def _reciprocal(self, node: Node) -> Node:
        """One over what is constant, computed once."""
        if isinstance(node, Number):
            return Number(1 / node.value)
        value = Divide(ONE, node)
        for statement in self._fixed:
            if statement.value == value:
                return Symbol(statement.name)
        name = f"_q{len(self._fixed) + 1}"
        self._fixed.append(Statement(name, value, "parameters"))
        self._constant.add(name)
        return Symbol(name)


def _factors(node: Node) -> Iterator[Node]:
    """The factors of a product, from left to right."""
    if isinstance(node, Multiply):
        yield from _factors(node.left)
        yield from _factors(node.right)
    else:
        yield node


def _add(left: Node, right: Node) -> Node:
    """A sum without zeros."""
    if ZERO in (left, right):
        return right if left == ZERO else left
    return Add(left, right)
