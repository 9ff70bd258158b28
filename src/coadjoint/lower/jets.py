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
parameters alone is its own order 0.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from coadjoint.lower.motion import Function, Meaning, Plan, Quotient, find_plan
from coadjoint.lower.polynomials import (
    Constant,
    Polynomial,
    Product,
    by_product,
    node_of,
    sum_of,
)
from coadjoint.lower.program import (
    ONE,
    Call,
    Divide,
    Multiply,
    Node,
    Number,
    Program,
    Statement,
    Symbol,
    walk,
)

#: The function that has to stand with another one, whose recurrence reads its coefficients.
PARTNERS = {"sin": "cos", "cos": "sin"}


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
    return _Making(rhs, find_plan(rhs)).jets()


class _Making:
    """Jets in the making."""

    def __init__(self, rhs: Program, plan: Plan) -> None:
        self.rhs, self.plan = rhs, plan
        self._fixed = list(plan.fixed)
        self._depth = dict.fromkeys((*rhs.state, *rhs.inputs, *rhs.time), 0)
        self._cells: list[Cell] = []
        self._known: dict[Node, str] = {}
        self._count = 0

    def jets(self) -> Jets:
        """All of them."""
        for name, meaning in self.plan.meanings.items():
            self._make(name, meaning)
        rates = [self._combine(rate) for rate in self.plan.rates]
        return Jets(
            state=self.rhs.state,
            driving=(*self.rhs.inputs, *self.rhs.time),
            parameters=self.rhs.parameters,
            fixed=tuple(self._fixed),
            cells=tuple(sorted(self._cells, key=lambda cell: cell.depth)),
            rates=tuple(rates),
        )

    # -- cells ------------------------------------------------------------------------------------

    def _make(self, name: str, meaning: Meaning) -> None:
        """A kept value as a cell of its own name."""
        match meaning:
            case Quotient(above=above, below=below):
                over = ONE if above is None else Symbol(above)
                self._recurrence(Divide(over, Symbol(below)), name)
            case Function(name=function, of=argument):
                self._recurrence(Call(function, Symbol(argument)), name)
            case _:
                self._make_sum(name, meaning)

    def _make_sum(self, name: str, meaning: Polynomial) -> None:
        """A kept polynomial; where it is a product alone, the recurrence has the name."""
        match list(meaning.items()):
            case [((product, ()), factor)] if factor == 1 and len(product) > 1:
                made = self._product(product, name)
                if made == name:
                    return
        whole, tail = self._combine(meaning)
        self._append(Cell(name=name, value=whole, tail=tail, depth=self._depth_of(whole)))

    def _append(self, cell: Cell) -> None:
        self._cells.append(cell)
        self._depth[cell.name] = cell.depth

    def _recurrence(self, value: Node, name: str = "") -> str:
        """The cell of an operation on names that no combination gives."""
        if value not in self._known:
            name, partner, depth = name or self._name(), "", 1 + self._depth_of(value)
            self._known[value] = name
            if isinstance(value, Call) and value.function in PARTNERS:
                partner = self._partner(value, name, depth)
            self._append(Cell(name=name, value=value, tail=None, depth=depth, partner=partner))
        elif name and self._known[value] != name:  # the partner of another has it
            same = Symbol(self._known[value])
            self._append(Cell(name=name, value=same, tail=same, depth=self._depth_of(same)))
        return self._known[value]

    def _partner(self, value: Call, name: str, depth: int) -> str:
        """The name of the cosine of a sine, or the sine of a cosine, which is made."""
        other = Call(PARTNERS[value.function], value.argument)
        partner = self._known[other] = self._name()
        self._append(Cell(name=partner, value=other, tail=None, depth=depth, partner=name))
        return partner

    def _name(self) -> str:
        """A name that nothing has yet."""
        self._count += 1
        return f"_j{self._count}"

    def _product(self, product: Product, name: str = "") -> str:
        """The cell of a product, by pairs."""
        if len(product) < 2:
            return product[0]
        first, *rest = (self._factor(factor) for factor in self.plan.products[product])
        for place, factor in enumerate(rest, 1):
            node = Multiply(Symbol(first), Symbol(factor))
            known = self._known.get(node) or self._known.get(Multiply(node.right, node.left))
            first = known or self._recurrence(node, name if place == len(rest) else "")
        return first

    def _factor(self, name: str) -> str:
        """The cell of a name, which is kept, or a pair."""
        if name not in self.plan.pairs:
            return name
        left, right = map(self._factor, self.plan.pairs[name])
        node = Multiply(Symbol(left), Symbol(right))
        other = Multiply(node.right, node.left)
        return self._known.get(other) or self._recurrence(node)

    def _depth_of(self, node: Node) -> int:
        return max((self._depth.get(name, 0) for name in _names(node)), default=0)

    # -- sums -------------------------------------------------------------------------------------

    def _combine(self, polynomial: Polynomial) -> tuple[Node, Node]:
        """A polynomial as a combination of cells: at order 0, and at orders k > 0."""
        parts = by_product(polynomial)
        rest = parts.pop((), None)
        signed = [(*self._constant(value), self._product(each)) for each, value in parts.items()]
        factors = list(dict.fromkeys(factor for _, factor, _ in signed))
        if len(factors) == 1:
            names: list[tuple[bool, Node]] = [(minus, Symbol(name)) for minus, _, name in signed]
            tail = _times(factors[0], sum_of(names))
        else:
            tail = sum_of((minus, _times(factor, Symbol(name))) for minus, factor, name in signed)
        if rest is None:
            return tail, tail
        minus, factor = self._constant(rest)
        whole = sum_of([(False, tail), (minus, factor)]) if parts else sum_of([(minus, factor)])
        return whole, tail

    def _constant(self, value: Constant) -> tuple[bool, Node]:
        """Whether a coefficient begins with a minus, and what it is with the other sign then."""
        minus = next(iter(value.values())) < 0
        size = {names: -factor if minus else factor for names, factor in value.items()}
        match list(size.items()):
            case [((), factor)]:
                return minus, Number(factor)
            case [((name,), factor)] if factor == 1:
                return minus, Symbol(name)
        node = node_of(size)
        for statement in self._fixed:
            if statement.value == node:
                return minus, Symbol(statement.name)
        self._fixed.append(Statement(f"_q{len(self._fixed) + 1}", node, "parameters"))
        return minus, Symbol(self._fixed[-1].name)


def _times(factor: Node, node: Node) -> Node:
    """A product, where the factor is not 1."""
    return node if factor == ONE else Multiply(factor, node)
