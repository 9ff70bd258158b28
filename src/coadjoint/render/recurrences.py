"""Render, recurrences: coefficients of a motion by their orders, as lines of text.

Comes in: the jets of the rates. Goes out: a `Line` for each coefficient of order 0, a `Stage` for
each order above it, and the loops of their sums. Names are written with their order, ``Pi1[_k]``.
Read next: `coadjoint.render.solvers`, which arranges them for the templates.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice

from coadjoint.lower.jets import Cell, Jets
from coadjoint.lower.polynomials import product_of, sum_of
from coadjoint.lower.program import (
    ONE,
    ZERO,
    Add,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Negate,
    Node,
    Number,
    Solution,
    Symbol,
    children,
    list_names,
    walk,
    with_children,
)

#: Sums that one loop runs over: as many as vector registers hold with their factors.
SUMS = 16
#: Sums among which the next one of a loop is looked for.
NEAR = 40
#: The factor m of the sums of logarithms, exponentials, sines and cosines.
_WEIGHT = Symbol("_orders[_m]")


@dataclass(frozen=True)
class Line:
    """``name = value``.

    Attributes:
        name: What is assigned: a name of its own, or an entry of an array.
        value: What is computed.
    """

    name: str
    value: Node

    @property
    def is_new(self) -> bool:
        """Whether the name is one of its own, which C declares."""
        return "[" not in self.name


@dataclass(frozen=True)
class Stage:
    """What is computed at an order k > 0 in one loop, and after it.

    Attributes:
        starts: Sums, which are zero.
        terms: Sums with what is added for each 0 < m < k.
        lines: What follows from them.
    """

    starts: tuple[Line, ...]
    terms: tuple[Line, ...]
    lines: tuple[Line, ...]


def list_reads(lines: Iterable[Line]) -> frozenset[str]:
    """The names that lines read, without their orders."""
    nodes = (node for line in lines for node in walk(line.value))
    return frozenset(node.name.split("[")[0] for node in nodes if isinstance(node, Symbol))


def set_order(node: Node, order: str, arrays: frozenset[str]) -> Node:
    """A node with the coefficients of one order in the place of names."""
    match node:
        case Symbol(name=name):
            return Symbol(f"{name}[{order}]") if name in arrays else node
        case Negate(operand=operand):
            return Negate(set_order(operand, order, arrays))
        case Call(function=function):
            return Call(function, *(set_order(each, order, arrays) for each in children(node)))
        case Add(left=left, right=right) | Multiply(left=left, right=right):
            return type(node)(set_order(left, order, arrays), set_order(right, order, arrays))
        case Divide(left=left, right=right):
            return Divide(set_order(left, order, arrays), set_order(right, order, arrays))
        case Factors() | Solution() | Item():
            return with_children(node, (set_order(each, order, arrays) for each in children(node)))
    return node


def find_next(tail: Node, arrays: frozenset[str]) -> Node:
    """A coefficient of the state, from its rate; zero where the rate is constant."""
    if tail == ZERO:
        return ZERO
    return Multiply(Symbol("_parts[_k + 1]"), set_order(tail, "_k", arrays))


def arrange_first(jets: Jets, arrays: frozenset[str]) -> Iterator[Line]:
    """Order 0 of all cells, and the rates."""
    for cell in jets.cells:
        yield _line(cell.name, "0", set_order(cell.value, "0", arrays), arrays)
        divisor = _divisor(cell)
        if divisor is not None:
            yield Line(f"{cell.name}_r", Divide(ONE, set_order(divisor, "0", arrays)))
    for name, (whole, _) in zip(jets.state, jets.rates, strict=bool(jets.rates)):
        yield Line(f"{name}[1]", set_order(whole, "0", arrays))


def _divisor(cell: Cell) -> Node | None:
    """What all later orders of a cell are divided by; None for no such thing."""
    match cell.value:
        case Divide(right=right) if cell.tail is None:
            return right
        case Call(function="sqrt"):
            return Multiply(Number(Fraction(2)), Symbol(cell.name))
        case Call() if cell.divisor:
            return Symbol(cell.divisor)
    return None


def _line(name: str, order: str, value: Node, arrays: frozenset[str]) -> Line:
    """An entry of an array where all orders are kept, else a name."""
    return Line(f"{name}[{order}]" if name in arrays else name, value)


def arrange_stages(jets: Jets, arrays: frozenset[str], *, is_one_loop: bool) -> Iterator[Stage]:
    """The loops of an order k > 0, and the coefficients that follow from their sums.

    The terms of a loop are known when the order begins, whatever depends on what.
    """
    terms, lines = dict[str, Node](), list[Line]()
    for cell in jets.cells:
        if isinstance(cell.value, Factors):  # those of order 0 serve all orders
            continue
        if isinstance(cell.value, Solution):
            own, value = _solve_order(cell, cell.value, jets, arrays)
            terms |= own
        elif cell.tail is None:
            total = f"{cell.name}_s"
            terms[total], value = _recurrence(cell, Symbol(total), jets, arrays)
        else:
            value = set_order(cell.tail, "_k", arrays)
        lines.append(_line(cell.name, "_k", value, arrays))
    for loop in [list(terms.items())] if is_one_loop else _loops(terms):
        sums = tuple(Line(name, Add(Symbol(name), term)) for name, term in loop)
        yield Stage(tuple(Line(name, ZERO) for name, _ in loop), sums, ())
    yield Stage((), (), tuple(_without_unread(lines, [*terms.values(), *_rates(jets, arrays)])))


def _rates(jets: Jets, arrays: frozenset[str]) -> Iterator[Node]:
    """The rates of the state at an order k > 0."""
    return (set_order(tail, "_k", arrays) for _, tail in jets.rates)


def _without_unread(lines: list[Line], others: list[Node]) -> list[Line]:
    """Lines but for names that nothing reads, as the arguments of signs at orders k > 0."""
    kept, read = list[Line](), {name for node in others for name in list_names(node)}
    for line in reversed(lines):
        if not line.is_new or line.name in read:
            kept.append(line)
            read.update(list_names(line.value))
    return kept[::-1]


def _loops(terms: dict[str, Node]) -> Iterator[list[tuple[str, Node]]]:
    """Terms by loops, those together that read the same coefficients, which are loaded once."""
    rest = {
        name: [(form, frozenset(list_names(form))) for form in (term, *_turned(term))]
        for name, term in terms.items()
    }
    while rest:
        loop, loaded = list[tuple[str, Node]](), frozenset[str]()
        while rest and len(loop) < SUMS:
            near = islice(rest.items(), NEAR)
            candidates = ((name, *form) for name, forms in near for form in forms)
            name, term, read = min(candidates, key=lambda each: len(each[2] - loaded))
            loop.append((name, term))
            loaded |= read
            del rest[name]
        yield loop


def _turned(term: Node) -> Iterator[Node]:
    """The same sum from its other end, where no weight tells the ends apart."""
    match term:
        case Multiply(left=Symbol(name=a), right=Symbol(name=b)):
            first, second = a.removesuffix("[_m]"), b.removesuffix("[_k - _m]")
            yield Multiply(Symbol(f"{second}[_m]"), Symbol(f"{first}[_k - _m]"))


def _recurrence(cell: Cell, total: Symbol, jets: Jets, arrays: frozenset[str]) -> tuple[Node, Node]:
    """What is added to the sum of a cell for each m < k, and the coefficient that follows.

    What is known last comes last: a processor can add the rest while it waits.
    """
    name, reciprocal, part = cell.name, Symbol(f"{cell.name}_r"), Symbol("_parts[_k]")

    def term(left: str, right: str, *weight: Symbol) -> Node:
        return product_of([*weight, Symbol(f"{left}[_m]"), Symbol(f"{right}[_k - _m]")])

    def ends(left: str, right: str) -> Node:
        return Multiply(Symbol(f"{left}[_k]"), Symbol(f"{right}[0]"))

    match cell.value:
        case Multiply(left=Symbol(name=a), right=Symbol(name=b)):
            return term(a, b), Add(Add(total, ends(b, a)), ends(a, b))
        case Divide(left=above, right=Symbol(name=b)):
            moves = isinstance(above, Symbol) and above.name in jets.moving
            known = Add(set_order(above, "_k", arrays), Negate(total)) if moves else Negate(total)
            return term(b, name), Multiply(Add(known, Negate(ends(b, name))), reciprocal)
        case Call(function="sqrt", argument=argument):
            rest = Add(set_order(argument, "_k", arrays), Negate(total))
            return term(name, name), Multiply(rest, reciprocal)
        case Call(argument=Symbol(name=a), other=None):
            ((factor, minus),) = cell.factors
            if not cell.divisor:
                whole = Add(Multiply(part, total), ends(a, factor))
                return term(a, factor, _WEIGHT), Negate(whole) if minus else whole
            if not factor:
                left = sum_of([(minus, Symbol(f"{a}[_k]")), (True, Multiply(part, total))])
                return term(name, cell.divisor, _WEIGHT), Multiply(left, reciprocal)
        case Call() if cell.divisor:
            pairs = list(zip(children(cell.value), cell.factors, strict=True))
            added = [(minus, term(_name_of(a), factor)) for a, (factor, minus) in pairs]
            last = [(minus, ends(_name_of(a), factor)) for a, (factor, minus) in pairs]
            inner = sum_of([*added, (True, term(name, cell.divisor))])
            whole = Add(Multiply(part, total), sum_of(last))
            return Multiply(_WEIGHT, inner), Multiply(whole, reciprocal)
    raise AssertionError(cell)


def _solve_order(
    cell: Cell, solution: Solution, jets: Jets, arrays: frozenset[str]
) -> tuple[dict[str, Node], Node]:
    """The sums of a solution by their names, and the equations of an order k > 0 with them."""
    terms, known = dict[str, Node](), list[Node]()
    for n, (row, tail) in enumerate(
        zip(cell.list_products(jets.moving), cell.tails, strict=True), 1
    ):
        side = set_order(tail, "_k", arrays)
        if row:
            total: Node = Symbol(f"{cell.name}_s{n}")
            inner = (Multiply(Symbol(f"{a}[_m]"), Symbol(f"{x}[_k - _m]")) for a, x in row)
            terms[f"{cell.name}_s{n}"] = sum_of((False, each) for each in inner)
            for a, x in row:
                total = Add(total, Multiply(Symbol(f"{a}[_k]"), Symbol(f"{x}[0]")))
            side = Negate(total) if side == ZERO else Add(side, Negate(total))
        known.append(side)
    return terms, Solution(solution.factors, tuple(known))


def _name_of(node: Node) -> str:
    """The name that a node is."""
    assert isinstance(node, Symbol), node
    return node.name
