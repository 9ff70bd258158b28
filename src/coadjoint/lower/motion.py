"""Motion: how few products of what moves give the rates of a system.

Comes in: the Program of the rates. Goes out: a `Plan`: what is kept as a value of its own, and what
each of these is: a polynomial in others, a quotient or a function of them.

At each order of a Taylor series a linear combination costs a few operations, a product of things
that move a sum over all orders below. So the Program's own intermediate values are not the best
ones: ``P x (A Pi - D P)`` has 6 products as it stands, and when it is multiplied out as many as
there are pairs of components that other rates need as well. Each sum is kept, or multiplied out
where it is a factor, whichever leaves fewer products in all. A difference of like things is kept.
Read next: `coadjoint.lower.jets`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from coadjoint.elementary import ELEMENTARY, Arithmetic, slopes_of
from coadjoint.lower.polynomials import (
    Polynomial,
    Product,
    TooLongError,
    add,
    is_difference,
    moving,
    multiply,
    node_of,
    scaled,
)
from coadjoint.lower.products import Pair, share_pairs
from coadjoint.lower.program import (
    ONE,
    Add,
    Call,
    Divide,
    Factors,
    Item,
    Multiply,
    Negate,
    Node,
    Number,
    Program,
    Solution,
    Statement,
    Symbol,
    children,
    list_names,
    walk,
    with_children,
)

#: Functions whose recurrence needs nothing else: a root, signs, and what stands with a partner.
ALONE = (
    "sqrt",
    *(name for name, each in ELEMENTARY.items() if each.partner or each.is_locally_constant),
)
#: What makes nodes of the texts of functions.
NODES = Arithmetic(
    number=Number, call=Call, add=Add, multiply=Multiply, divide=Divide, negate=Negate
)
#: What a term of a linear combination costs, where a product costs 1.
TERM = 0.02
#: Plans are tried while their number times the size of the Program is below.
EFFORT = 20000


@dataclass(frozen=True)
class Quotient:
    """What moves, or one, over what moves.

    Attributes:
        above: The name of the numerator; None for one.
        below: The name of the denominator.
    """

    above: str | None
    below: str


@dataclass(frozen=True)
class Function:
    """A function of what moves.

    Attributes:
        name: The function.
        of: The names of its arguments.
        factors: By argument, what its rate is multiplied by in the rate of the function, and
            whether with a minus: a name, or "" for one.
        divisor: The name of what their sum is divided by, or "".
    """

    name: str
    of: tuple[str, ...]
    factors: tuple[tuple[str, bool], ...] = ()
    divisor: str = ""


@dataclass(frozen=True)
class Coupled:
    """What solves symmetric equations by a loop.

    Attributes:
        factors: The name of L and D.
        entries: Of the matrix, on and below the diagonal; each is a name, or does not move.
        known: The right side.
        unknowns: The names of what solves them.
    """

    factors: str
    entries: tuple[Polynomial, ...]
    known: tuple[Polynomial, ...]
    unknowns: tuple[str, ...]


@dataclass(frozen=True)
class Unknown:
    """One of the numbers that solve equations.

    Attributes:
        of: The name of all of them.
        place: Which one.
    """

    of: str
    place: int


Meaning = Polynomial | Quotient | Function | Coupled | Unknown


@dataclass(frozen=True)
class Plan:
    """The rates as polynomials in what is kept.

    Attributes:
        fixed: What depends on parameters alone.
        meanings: What each kept name is; the state and what drives it are left out.
        rates: One for each component of the state.
        pairs: Products of two that others are made of, by name.
        products: Each product that moves, of two or more, in names and pairs.
        cost: Sums over orders, and a little for linear terms.
    """

    fixed: tuple[Statement, ...]
    meanings: dict[str, Meaning]
    rates: tuple[Polynomial, ...]
    pairs: dict[str, Pair]
    products: dict[Product, Product]
    cost: float


@lru_cache(maxsize=4)
def find_plan(rhs: Program) -> Plan:
    """The plan that costs least of those that were tried; solvers are printed and checked by it.

    First all statements from one on are kept, each in turn; then each is changed alone.
    """
    rhs = _with_names(rhs)
    names = [statement.name for statement in rhs.statements_at("member")]
    tries = EFFORT // sum(1 for value in rhs.values() for _ in walk(value))
    starts = [frozenset(names[place:]) for place in range(min(len(names), tries) + 1)]
    best, kept = _try(rhs, starts[0]), starts[0]
    for start in (*starts[1:], frozenset[str]()):
        other = _try(rhs, start, best.cost)
        if other.cost < best.cost:
            best, kept = other, start
    for name in names[:tries]:
        other = _try(rhs, kept ^ {name}, best.cost)
        if other.cost < best.cost:
            best, kept = other, kept ^ {name}
    return best


def _with_names(rhs: Program) -> Program:
    """The Program with a name for each sum that is a factor."""
    statements, known = list[Statement](), dict[Node, str]()
    constants = {*rhs.parameters, *(each.name for each in rhs.statements_at("parameters"))}

    def named(node: Node) -> Node:
        found = with_children(node, map(named, children(node)))
        if isinstance(found, Multiply):
            return with_children(found, map(name_sum, children(found)))
        return found

    def name_sum(node: Node) -> Node:
        read = set(list_names(node))
        if not isinstance(node, Add) or read <= constants:
            return node
        if node not in known:
            known[node] = f"_js{len(known) + 1}"
            statements.append(Statement(known[node], node, "member"))
        return Symbol(known[node])

    for statement in rhs.statements:
        value = statement.value if statement.level == "parameters" else named(statement.value)
        statements.append(replace(statement, value=value))
    outputs = tuple(replace(output, value=named(output.value)) for output in rhs.outputs)
    return replace(rhs, statements=tuple(statements), outputs=outputs)


def _try(rhs: Program, kept: frozenset[str], most: float = float("inf")) -> Plan:
    """The plan in which some statements are kept; its cost is infinite where it is beyond `most`.

    Where products are too long it is, too. A sum that is multiplied out may have as many terms as
    there are paths through a factorisation, so that a plan is left as soon as it is too large.
    """
    try:
        return _Planning(rhs, kept, most).plan()
    except TooLongError:
        return Plan(fixed=(), meanings={}, rates=(), pairs={}, products={}, cost=float("inf"))


class _Planning:
    """A plan in the making; `TooLongError` ends it when it is certain to cost more than `most`."""

    def __init__(self, rhs: Program, kept: frozenset[str], most: float) -> None:
        self.rhs, self.kept, self.most = rhs, kept, most
        self.fixed = list(rhs.statements_at("parameters"))
        self._reciprocals = {each.value: each.name for each in self.fixed}
        constants = (*rhs.parameters, *(statement.name for statement in self.fixed))
        self._values: dict[str, Polynomial] = {
            name: scaled(Fraction(1), (name,)) for name in constants
        }
        driven = (*rhs.state, *rhs.inputs, *rhs.time)
        self._values |= {name: moving(name) for name in driven}
        self._meanings: dict[str, Meaning] = {}
        self._names: dict[object, str] = {}
        self._matrices: dict[str, tuple[Polynomial, ...]] = {}

    def plan(self) -> Plan:
        """All of it."""
        for statement in self.rhs.statements_at("member"):
            if isinstance(statement.value, Factors | Solution):
                self._keep_loop(statement.name, statement.value)
            else:
                self._values[statement.name] = self._keep(statement)
        rates = tuple(self._polynomial(output.value) for output in self.rhs.outputs)
        meanings = {name: self._meanings[name] for name in self._read(rates)}
        polynomials = [*(m for m in meanings.values() if isinstance(m, dict)), *rates]
        polynomials += [p for m in meanings.values() if isinstance(m, Coupled) for p in m.known]
        terms = [product for each in polynomials for product, _ in each]
        products = [product for product in terms if len(product) > 1]
        # each of them takes a product of its own, however much they share
        self._hold(len(set(products)) + TERM * (len(terms) + len(meanings)))
        made, pairs = share_pairs(products, lambda n: f"_m{n}")
        distinct = dict(zip(products, made, strict=True))
        cost = len(pairs) + sum(len(product) - 1 for product in distinct.values())
        cost += sum(1 + isinstance(m, Function) for m in meanings.values() if not _is_sum(m))
        return Plan(
            fixed=tuple(self.fixed),
            meanings=meanings,
            rates=rates,
            pairs=pairs,
            products=distinct,
            cost=cost + TERM * (len(terms) + len(meanings)),
        )

    def _hold(self, least: float) -> None:
        """Leave the plan where what it costs at least is too much."""
        if least > self.most:
            raise TooLongError

    def _read(self, rates: Sequence[Polynomial]) -> Iterator[str]:
        """Names that the rates need, each after those it needs itself."""
        done = set[str]()

        def visit(names: Iterator[str]) -> Iterator[str]:
            for name in names:
                if name in self._meanings and name not in done:
                    done.add(name)
                    yield from visit(_names_in(self._meanings[name]))
                    yield name
                    yield from visit(_names_behind(self._meanings[name]))

        for rate in rates:
            yield from visit(_names_in(rate))

    def _keep(self, statement: Statement) -> Polynomial:
        """A statement as a value of its own, or as what it is."""
        whole = self._polynomial(statement.value)
        self._hold(len({product for product, _ in whole if len(product) > 1}))
        moves = sum(1 for product, _ in whole if product)
        if moves == 0 or (moves == 1 and _is_linear(whole) and not is_difference(whole)):
            return whole
        if statement.name not in self.kept and not is_difference(whole):
            return whole
        return self._name(whole, statement.name)

    def _keep_loop(self, name: str, value: Factors | Solution) -> None:
        """The entries of a matrix under names; the unknowns of equations as values of their own."""
        wholes = [self._polynomial(each) for each in children(value)[isinstance(value, Solution) :]]
        if isinstance(value, Factors):
            moving_ones = ((moving(self._as_name(w)) if _moves(w) else w) for w in wholes)
            self._matrices[name] = tuple(moving_ones)
            return
        assert isinstance(value.factors, Symbol), value
        factors = value.factors.name
        unknowns = tuple(f"{name}_{place + 1}" for place in range(len(wholes)))
        entries, known = self._matrices[factors], tuple(wholes)
        self._meanings[name] = Coupled(factors, entries, known, unknowns)
        for place, own in enumerate(unknowns):
            self._meanings[own] = Unknown(name, place)

    def _name(self, whole: Polynomial, name: str) -> Polynomial:
        """A polynomial under a name, or under the one that it has."""
        key = frozenset(whole.items())
        if key not in self._names:
            self._names[key], self._meanings[name] = name, whole
        return moving(self._names[key])

    def _as_name(self, whole: Polynomial) -> str:
        """The name of a polynomial that moves."""
        match list(whole.items()):
            case [(((name,), ()), factor)] if factor == 1:
                return name
        named = self._name(whole, f"_jv{len(self._names) + 1}")
        return next(iter(named))[0][0]

    def _polynomial(self, node: Node) -> Polynomial:
        """A node as a polynomial in what is kept."""
        match node:
            case Number(value=value):
                return scaled(value)
            case Symbol(name=name):
                return self._values[name]
            case Negate(operand=operand):
                return multiply(scaled(Fraction(-1)), self._polynomial(operand))
            case Add(left=left, right=right):
                return add(self._polynomial(left), self._polynomial(right))
            case Multiply(left=left, right=right):
                return self._multiply(self._polynomial(left), self._polynomial(right))
            case Divide(left=left, right=right):
                return self._divide(self._polynomial(left), right)
            case Call(function=function):
                wholes = list(map(self._polynomial, children(node)))
                if not any(map(_moves, wholes)):
                    return self._fixed(Call(function, *map(_constant_node, wholes)))
                return self._function(function, tuple(map(self._as_name, wholes)))
            case Item(of=Symbol(name=of), place=place):
                return moving(f"{of}_{place + 1}")
        raise AssertionError(node)

    def _function(self, function: str, arguments: tuple[str, ...]) -> Polynomial:
        """A function under its name, with names for what its rate is made of."""
        meaning = Function(function, arguments)
        whole = self._meant(meaning)
        name = self._as_name(whole)
        if self._meanings[name] == meaning and function not in ALONE:
            self._values |= {each: moving(each) for each in (*arguments, name)}
            slopes = slopes_of(function, tuple(map(Symbol, arguments)), Symbol(name), NODES)
            parts = [_parts_of_slope(slope) for slope in slopes]
            factors = tuple((self._part(above), minus) for minus, above, _ in parts)
            self._meanings[name] = replace(
                meaning, factors=factors, divisor=self._part(parts[0][2])
            )
        return whole

    def _part(self, node: Node) -> str:
        """The name of a factor or divisor of a slope; "" for one."""
        return "" if node == ONE else self._as_name(self._polynomial(node))

    def _meant(self, meaning: Quotient | Function) -> Polynomial:
        """A quotient or a function under its name."""
        if meaning not in self._names:
            self._names[meaning] = f"_jv{len(self._names) + 1}"
            self._meanings[self._names[meaning]] = meaning
        return moving(self._names[meaning])

    def _multiply(self, left: Polynomial, right: Polynomial) -> Polynomial:
        """A product; one over what moves, times something, is a quotient."""
        for whole, other in ((left, right), (right, left)):
            match list(whole.items()):
                case [(((name,), rest), factor)] if _moves(other):
                    meaning = self._meanings.get(name)
                    if isinstance(meaning, Quotient) and meaning.above is None:
                        over = self._over(other, meaning.below)
                        return multiply(scaled(factor, rest), over)
        return multiply(left, right)

    def _divide(self, above: Polynomial, node: Node) -> Polynomial:
        """A quotient."""
        below = self._polynomial(node)
        if _moves(below):
            return self._over(above, self._as_name(below))
        match list(below.items()):
            case [(((), ()), factor)]:
                return multiply(above, scaled(1 / factor))
        return multiply(above, self._fixed(Divide(ONE, _constant_node(below))))

    def _over(self, above: Polynomial, below: str) -> Polynomial:
        """A polynomial over a name; factors that are constant stand before the quotient."""
        if not _moves(above):
            return multiply(above, self._meant(Quotient(None, below)))
        scale: Polynomial = scaled(Fraction(1))
        match list(above.items()):
            case [((product, rest), factor)]:
                scale, above = scaled(factor, rest), {(product, ()): Fraction(1)}
        return multiply(scale, self._meant(Quotient(self._as_name(above), below)))

    def _fixed(self, node: Node) -> Polynomial:
        """What depends on parameters alone, computed once."""
        if node not in self._reciprocals:
            self._reciprocals[node] = f"_q{len(self.fixed) + 1}"
            self.fixed.append(Statement(self._reciprocals[node], node, "parameters"))
        return scaled(Fraction(1), (self._reciprocals[node],))


def _names_behind(meaning: Meaning) -> Iterator[str]:
    """The names that a meaning reads of which orders below are enough: they may depend on it."""
    if isinstance(meaning, Function) and not meaning.divisor:
        yield from (name for name, _ in meaning.factors if name)
    if isinstance(meaning, Coupled):  # each of its sums has all of them
        yield from meaning.unknowns


def _parts_of_slope(slope: Node) -> tuple[bool, Node, Node]:
    """Whether a derivative begins with a minus, its numerator and its denominator."""
    match slope:
        case Negate(operand=operand):
            return True, *_parts_of_slope(operand)[1:]
        case Divide(left=left, right=right):
            minus = isinstance(left, Negate)
            return minus, left.operand if isinstance(left, Negate) else left, right
    return False, slope, ONE


def _constant_node(whole: Polynomial) -> Node:
    return node_of({rest: factor for (_, rest), factor in whole.items()})


def _is_sum(meaning: Meaning) -> bool:
    return isinstance(meaning, dict)


def _moves(whole: Polynomial) -> bool:
    return any(product for product, _ in whole)


def _is_linear(whole: Polynomial) -> bool:
    return all(len(product) < 2 for product, _ in whole)


def _names_in(meaning: Meaning) -> Iterator[str]:
    """The names that a meaning reads."""
    match meaning:
        case Quotient(above=above, below=below):
            yield from filter(None, [above, below])
        case Unknown(of=of):
            yield of
        case Coupled(entries=entries, known=known):
            yield from (name for each in (*entries, *known) for name in _names_in(each))
        case Function(of=names, factors=factors, divisor=divisor):
            yield from names
            if divisor:  # it does not depend on the value
                yield divisor
                yield from (name for name, _ in factors if name)
        case _:
            for product, _ in meaning:
                yield from product
