"""Jets: the Taylor coefficients of a motion, one order after the other.

Comes in: the Program of the rates. Goes out: `Jets`, the recurrences that every target prints.

Along a motion each value of the Program is a function of time, ``a(t + s) = a[0] + a[1] s + ...``.
What is linear in others has linear combinations of their coefficients. The rest follows from
recurrences (R. E. Moore, Interval Analysis, 1966, ch. 11; Griewank and Walther, Evaluating
Derivatives, 2008, ch. 13)::

    product   p = a b        p[k] = sum_{m=0..k} a[m] b[k-m]
    quotient  q = a / b      q[k] = (a[k] - sum_{m=1..k} b[m] q[k-m]) / b[0]
    sqrt      s = sqrt(a)    s[k] = (a[k] - sum_{m=1..k-1} s[m] s[k-m]) / (2 s[0])
    function  f' = p a'      f[k] = sum_{m=1..k} m a[m] p[k-m] / k
    function  d f' = a'      f[k] = (a[k] - sum_{m=1..k-1} m f[m] d[k-m] / k) / d[0]
    atan2     d f' = x y' - y x'
    solve     A x = b        A[0] x[k] = b[k] - sum_{m=1..k} A[m] x[k-m]

The table of functions gives p, as ``f`` of ``exp`` and ``cos(a)`` of ``sin``, or d, as ``a`` of
``log`` and ``sqrt(1 - a*a)`` of ``asin``. Equations that a loop solves are factored at order 0
alone. The coefficients of the state are the rates, ``x[k+1] = rate[k] / (k + 1)``. What depends on
parameters alone is its own order 0.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from coadjoint.elementary import ELEMENTARY
from coadjoint.exact.factored import place_of, rows_of
from coadjoint.lower.motion import (
    Coupled,
    Function,
    Meaning,
    Plan,
    Quotient,
    Unknown,
    find_plan,
)
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
    ZERO,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Node,
    Number,
    Program,
    Solution,
    Statement,
    Symbol,
    list_names,
)


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
        factors: Of a function other than a root, by argument, what multiplies its rate in the rate
            of the function, and whether with a minus: a name, or "" for one.
        divisor: What the sum of these is divided by: a name, or "".
        entries: Of a solution, the matrix on and below the diagonal, in names of cells.
        tails: Of a solution, the right side at orders k > 0.
    """

    name: str
    value: Node
    tail: Node | None
    depth: int
    factors: tuple[tuple[str, bool], ...] = ()
    divisor: str = ""
    entries: tuple[Node, ...] = ()
    tails: tuple[Node, ...] = ()

    @property
    def unknowns(self) -> list[str]:
        """Of a solution, the names of the numbers that it has."""
        return [f"{self.name}_{place + 1}" for place in range(len(self.tails))]

    def list_products(self, moving: frozenset[str]) -> list[list[tuple[str, str]]]:
        """Of a solution, entries that move times unknowns, row by row."""
        size = range(len(self.tails))
        rows = [[self.entries[place_of(max(i, j), min(i, j))] for j in size] for i in size]
        return [
            [
                (entry.name, unknown)
                for entry, unknown in zip(row, self.unknowns, strict=True)
                if isinstance(entry, Symbol) and entry.name in moving
            ]
            for row in rows
        ]


@dataclass(frozen=True)
class Jets:
    """The recurrences of a system, in an order in which they can be computed.

    Attributes:
        state: Component names, whose coefficients the rates give.
        driving: Names of inputs and time, whose coefficients are given.
        fixed: Statements that depend on parameters alone.
        cells: What is computed at each order, by depth.
        rates: The rate of each component of the state at order 0, and at orders k > 0.
    """

    state: tuple[str, ...]
    driving: tuple[str, ...]
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
            if cell.tail is None or isinstance(cell.value, Factors):
                found |= _reads_all_orders(cell)
        return frozenset(found).intersection(cell.name for cell in self.cells)

    @property
    def products(self) -> int:
        """Sums over pairs of coefficients at each order, which are nearly all of the cost."""
        pairs = (cell.list_products(self.moving) for cell in self.cells if cell.tails)
        loops = sum(len(row) for rows in pairs for row in rows)
        return loops + sum(cell.tail is None and not cell.tails for cell in self.cells)


def _reads_all_orders(cell: Cell) -> set[str]:
    """The names of which the recurrence of a cell reads coefficients of all orders."""
    match cell.value:
        case Factors():
            return set(list_names(cell.value))
        case Solution():
            return set(cell.unknowns)
        case Multiply():
            return set(list_names(cell.value))
        case Divide(right=right):
            return {cell.name, *list_names(right)}
        case Call(function="sqrt"):
            return {cell.name}
    others = {cell.divisor, *(name for name, _ in cell.factors)}
    return {cell.name, *list_names(cell.value), *others} - {""}


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
            case Function(name=function, of=arguments):
                self._recurrence(Call(function, *map(Symbol, arguments)), name, meaning)
            case Coupled():
                self._make_solution(name, meaning)
            case Unknown(of=of, place=place):
                own = Item(Symbol(of), place)
                self._append(Cell(name=name, value=own, tail=own, depth=self._depth[of]))
            case _:
                self._make_sum(name, meaning)

    def _make_solution(self, name: str, meaning: Coupled) -> None:
        """The cells of L and D, once, and of what solves equations with them."""
        entries = tuple(self._combine(each)[0] for each in meaning.entries)
        value = Factors(rows_of(len(entries)), entries)
        if meaning.factors not in self._depth:
            depth = self._depth_of(value)
            self._append(Cell(name=meaning.factors, value=value, tail=ZERO, depth=depth))
        sides = [self._combine(each) for each in meaning.known]
        known = Solution(Symbol(meaning.factors), tuple(whole for whole, _ in sides))
        depth = 1 + max(self._depth_of(known), self._depth_of(value))
        tails = tuple(tail for _, tail in sides)
        self._append(
            Cell(name=name, value=known, tail=None, depth=depth, entries=entries, tails=tails)
        )

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

    def _recurrence(self, value: Node, name: str = "", meaning: Function | None = None) -> str:
        """The cell of an operation on names that no combination gives."""
        if value not in self._known:
            name, depth = name or self._name(), 1 + self._depth_of(value)
            self._known[value] = name
            cell = Cell(name=name, value=value, tail=None, depth=depth)
            if meaning is not None and meaning.factors:
                cell = self._with_factors(cell, meaning)
            elif isinstance(value, Call) and ELEMENTARY[value.function].partner:
                cell = self._with_partner(cell, value)
            elif isinstance(value, Call) and ELEMENTARY[value.function].is_locally_constant:
                cell = replace(cell, tail=ZERO)
            self._append(cell)
        elif name and self._known[value] != name:  # the partner of another has it
            same = Symbol(self._known[value])
            self._append(Cell(name=name, value=same, tail=same, depth=self._depth_of(same)))
        return self._known[value]

    def _with_factors(self, cell: Cell, meaning: Function) -> Cell:
        """The cell of a function with what its recurrence reads."""
        before = (
            [meaning.divisor, *(name for name, _ in meaning.factors)] if meaning.divisor else []
        )
        depth = max(cell.depth, *(1 + self._depth.get(name, 0) for name in before), 0)
        return replace(cell, depth=depth, factors=meaning.factors, divisor=meaning.divisor)

    def _with_partner(self, cell: Cell, value: Call) -> Cell:
        """The cell of a sine with its cosine, or the other way round, which is made."""
        own, name = ELEMENTARY[value.function], self._name()
        other = Call(own.partner, value.argument)
        self._known[other] = name
        factors = ((cell.name, ELEMENTARY[own.partner].slopes[0].startswith("-")),)
        self._append(replace(cell, name=name, value=other, factors=factors))
        return replace(cell, factors=((name, own.slopes[0].startswith("-")),))

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
        return max((self._depth.get(name, 0) for name in list_names(node)), default=0)

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
