"""Sums: elements as sums of products and quotients, on their way into a graph.

Comes in: elements of one Program. Goes out: their nodes. An element is a sum of products in the
order of the field; what depends on parameters alone is gathered into the coefficients, equal
coefficients are factored out, and pairs of factors that recur are shared.
Read next: `coadjoint.lower.lowering`, which makes Programs of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.exact import Element, Field
from coadjoint.exact.factored import place_of
from coadjoint.exact.factors import factors_of, rational_root, to_fraction
from coadjoint.exact.rationals import Written
from coadjoint.lower.graph import Graph
from coadjoint.lower.nesting import COEFFICIENT, Nest, Sum, Term, list_products, nest
from coadjoint.lower.products import Pair, Product, share_pairs
from coadjoint.lower.scales import Scales


@dataclass(frozen=True)
class Ratio:
    """A quotient of sums.

    Attributes:
        groups: Coefficients with the signed products they multiply: numbers, or forms to be added,
            each with its level.
        divisors: Factors of the denominator, each with its exponent.
        nested: The sum of the groups with common factors in front; empty to leave it as it is.
    """

    groups: tuple[tuple[Any, tuple[tuple[int, Product], ...]], ...]
    divisors: tuple[tuple[Form, int], ...]
    nested: Sum = ()


#: What the factors of products are: whatever occurs, so that coefficients are numbers; what moves,
#: next to coefficients of parameters; what depends on the state, next to coefficients that inputs
#: and time may drive.
_FIXED, _DRIVEN, _MEMBER = range(3)
#: The highest power of a sign in an argument that is written by its values on either side.
_SIDED: Final = 2
#: An element as a sum of quotients, one for each denominator that moves with the member.
Form = tuple[Ratio, ...]
#: What to compute before it is shared: coefficients by product, for each such denominator.
_Sums = dict[Any, tuple[list[tuple[Element, int]], dict[Product, Element]]]


@dataclass(frozen=True)
class Square:
    """An argument of a function that is a square.

    Attributes:
        root: What it is the square of.
    """

    root: Element


@dataclass(frozen=True)
class Sided:
    """An argument of a function by its values on either side of a kink.

    ``min(u, 1) = (u + 1 - (u - 1)*s)/2`` with ``s = sign(u - 1)`` is 1 where u is larger, but for
    rounding of ``u + 1``; ``((1 + s) + (1 - s)*u)/2`` is 1 to the bit, so that its ``acos`` has a
    value.

    Attributes:
        sign: The generator of the sign.
        values: What it is for the signs 1 and -1, and for 0 where its square occurs.
    """

    sign: str
    values: Mapping[int, Element | Sided]


class Lowering:
    """Elements of one Program on their way into a graph.

    Args:
        equations: Where the elements come from.
        elements: Everything that the Program will compute, definitions included.
        scales: Of components of the state; none to leave their products as they are.
        nested: Which common factors go in front of sums first; 0 to leave them inside.
    """

    def __init__(
        self,
        equations: Equations,
        elements: Iterable[Element],
        scales: Mapping[str, Element] | None = None,
        nested: int = 0,
    ) -> None:
        self._nested = nested
        self._coefficients: dict[Any, tuple[str, Any]] = {}
        self.field: Field = equations.setting.field
        self._scales = Scales(scales or {})
        self.graph = Graph()
        self._members = equations.moving
        setting = equations.setting
        self._state = self._members.difference(setting.inputs, setting.time)
        self._forms: dict[tuple[int, int], Form] = {}
        self._marks: set[Any] = set()
        self._factors: dict[tuple[str, int], bool] = {}
        self._constants: dict[tuple[Fraction, tuple[tuple[str, int], ...]], Element] = {}
        self._numbers = equations.numbers
        self._kept: list[Element] = []
        self._arguments: dict[str, list[Element | Sided | Square]] = {}
        self._writers = {"sign": _keep, "log": self._write_as_square}
        self._products: dict[int, list[Product]] = {_FIXED: [], _DRIVEN: [], _MEMBER: []}
        written = list(elements)
        self._loops = loops_under(equations, written)
        self._solved: dict[str, int] = {}
        for element in (*written, *(side for each in self._loops for side in each.sides)):
            self._form(element, _MEMBER)
        self._coefficients_by_name = dict(self._coefficients.values())
        self._shared: dict[int, dict[Product, Product]] = {}
        self._pairs: dict[str, Pair] = {}
        for level, products in self._products.items():
            over_pairs, pairs = share_pairs(products, f"_m{level}_{{}}".format)
            self._shared[level] = dict(zip(products, over_pairs, strict=True))
            self._pairs |= pairs

    # -- collecting ---------------------------------------------------------------------

    def _form(self, element: Element, level: int) -> Form:
        """The form of an element, whose products are noted for sharing.

        Args:
            element: What to write as a sum of quotients of sums.
            level: Which factors its products have; the others go into their coefficients.
        """
        key = (id(element), level)
        if key not in self._forms:
            self._kept.append(element)  # so that its id stays its own
            self._forms[key] = tuple(
                self._ratio(coefficients, divisors, level)
                for divisors, coefficients in self._sums(element, level).values()
            )
        return self._forms[key]

    def _sums(self, element: Element, level: int) -> _Sums:
        """The products of an element with their coefficients, by denominator."""
        sums: _Sums = {}
        for written in self.field.quotients(element):
            inner, outer = self._split_denominator(written, level)
            key = tuple((_mark(divisor), power) for divisor, power in outer)
            _, coefficients = sums.setdefault(key, (outer, {}))
            for product, part in self._collect(written, level).items():
                known = coefficients.get(product, self.field.zero)
                coefficients[product] = known + part * inner
        return sums

    def _ratio(
        self,
        coefficients: dict[Product, Element],
        divisors: list[tuple[Element, int]],
        level: int,
    ) -> Ratio:
        """One quotient, equal coefficients factored out."""
        if level == _MEMBER:
            coefficients = self._scales.rewrite(coefficients, _mark) or coefficients
        groups: dict[Any, list[tuple[int, Product]]] = {}
        by_mark: dict[Any, Element] = {}
        for product, part in coefficients.items():
            if part == 0:  # quotients over different parameters may cancel
                continue
            sign, coefficient, mark = self._signed_coefficient(part)
            by_mark.setdefault(mark, coefficient)
            groups.setdefault(mark, []).append((sign, product))
            self._note_functions(product)
        written = {mark: self._coefficient(by_mark[mark]) for mark in groups}
        nested = self._nest(groups, written) if self._nested and level == _MEMBER else ()
        plain = (product for members in groups.values() for _, product in members)
        self._products[level] += list_products(nested) if nested else plain
        return Ratio(
            tuple((written[mark], tuple(group)) for mark, group in groups.items()),
            tuple((self._form(divisor, level), power) for divisor, power in divisors),
            nested,
        )

    def _nest(
        self, groups: Mapping[Any, Sequence[tuple[int, Product]]], written: Mapping[Any, Any]
    ) -> Sum:
        """The sum of some groups with common factors in front; coefficients are factors, too."""
        terms = []
        for mark, members in groups.items():
            name = f"{COEFFICIENT}{len(self._coefficients)}"
            name, _ = self._coefficients.setdefault(mark, (name, written[mark]))
            lead = () if written[mark] == 1 else (name,)
            terms += [Term(sign, (*lead, *product)) for sign, product in members]
        return nest(terms, self._nested)

    def _signed_coefficient(self, coefficient: Element) -> tuple[int, Element, Any]:
        """Sign, what it multiplies, and a hashable mark that equal values share.

        The sign is split off where that leaves a value seen before, or a single positive term; a
        difference such as ``I3 - I1`` keeps the sign it has.
        """
        value, sign = coefficient, 1
        written = self.field.quotients(coefficient)
        single = len(written) == 1 and len(written[0].monomials) == 1
        negative = single and written[0].monomials[0].number < 0
        if _mark(-coefficient) in self._marks or (negative and _mark(value) not in self._marks):
            value, sign = -coefficient, -1
        self._marks.add(_mark(value))
        return sign, value, _mark(value)

    def _coefficient(self, element: Element) -> Fraction | tuple[tuple[int, Form], ...]:
        """A coefficient: a number, or its addends, each with its level.

        ``(I2 - I3)/(I2*I3)`` is computed as ``1/I3 - 1/I2``: fewer roundings, and reciprocals that
        other statements share.
        """
        number = self.field.as_number(element)
        if number is not None:
            return number
        if self._moves(element):
            return ((_DRIVEN, self._form(element, _DRIVEN)),)
        parts = self.field.partial_fractions(element)
        return tuple((_FIXED, self._form(part, _FIXED)) for part in parts)

    def _note_functions(self, product: Product) -> None:
        """Collect the arguments of the elementary functions in a product, too."""
        for name in product:
            if name in self._scales:
                self._coefficient(self._scales.take(name)[0])
            if name in self.field.adjoined:
                for argument in self._list_arguments(name):
                    self._note_argument(argument)

    def _list_arguments(self, name: str) -> list[Element | Sided | Square]:
        """The arguments of a function, by their values on either side of kinks if that is short."""
        if name not in self._arguments:
            known = self.field.adjoined[name]
            write = self._writers.get(known.function, self._write_by_sides)
            self._arguments[name] = [write(argument) for argument in known.arguments]
        return self._arguments[name]

    def _write_as_square(self, argument: Element) -> Element | Sided | Square:
        """An argument as the square that it is: multiplied out it has roundings below zero."""
        top, bottom = self.field.fraction(argument.combine())
        content, factors = factors_of(top)
        number = rational_root(to_fraction(content))
        if bottom or number is None or any(power % 2 for _, power in factors):
            return self._write_by_sides(argument)
        root = self.field.number(number)
        for factor, power in factors:
            root = root * self.field.from_polynomial(factor) ** (power // 2)
        return Square(root)

    def _write_by_sides(self, argument: Element) -> Element | Sided:
        """An argument by its values on either side of a kink, if these have fewer terms."""
        field = self.field
        for name in sorted(field.names_in(argument) & field.adjoined.keys()):
            if field.adjoined[name].function != "sign":
                continue
            try:
                parts = field.coefficients(argument, name)
            except ValueError:  # it stands in a divisor, or in a function
                continue
            most = max(parts)
            if not (min(parts) >= 0 and 0 < most <= _SIDED):
                continue
            values = {
                side: field.sum(part * side**power for power, part in parts.items())
                for side in (1, -1, 0)[: most + 1]
            }
            if sum(map(self._count_terms, values.values())) < self._count_terms(argument):
                return Sided(name, {k: self._write_by_sides(each) for k, each in values.items()})
        return argument

    def _count_terms(self, element: Element) -> int:
        return sum(len(written.monomials) for written in self.field.quotients(element))

    def _note_argument(self, argument: Element | Sided | Square) -> None:
        if isinstance(argument, Square):
            self._note_argument(argument.root)
        elif isinstance(argument, Sided):
            self._note_functions((argument.sign,))
            for value in argument.values.values():
                self._note_argument(value)
        else:
            self._form(argument, self._level(argument))

    def _moves(self, element: Element) -> bool:
        """Whether an element depends on the member, not on parameters alone."""
        return bool(self.field.reach(element) & self._members)

    def _level(self, argument: Element) -> int:
        return _MEMBER if self._moves(argument) else _FIXED

    def _is_factor(self, name: str, level: int) -> bool:
        """Whether a generator belongs into products rather than into coefficients."""
        if (name, level) not in self._factors:
            moving = {_DRIVEN: self._members, _MEMBER: self._state}
            moves = level == _FIXED or self.field.reach(self.field[name]) & moving[level]
            self._factors[name, level] = bool(moves)
        return self._factors[name, level]

    def _collect(self, written: Written, level: int) -> dict[Product, Element]:
        """Numerator terms by their product, with the coefficient polynomial of each."""
        parts: dict[Product, Element] = {}
        for term in written.monomials:
            product: list[str] = []
            rest: list[tuple[str, int]] = []
            for name, power in term.powers:
                if self._is_factor(name, level):
                    product += [name] * power
                else:
                    rest.append((name, power))
            coefficient = self._constant(term.number, tuple(rest))
            known = parts.get(tuple(product))
            parts[tuple(product)] = coefficient if known is None else known + coefficient
        return parts

    def _constant(self, number: Fraction, powers: tuple[tuple[str, int], ...]) -> Element:
        """A number times powers, remembered: few different ones stand in many terms."""
        if (number, powers) not in self._constants:
            made = self.field.number(number)
            for name, power in powers:
                made = made * self.field[name] ** power
            self._constants[number, powers] = made
        return self._constants[number, powers]

    def _split_denominator(
        self, written: Written, level: int
    ) -> tuple[Element, list[tuple[Element, int]]]:
        """The reciprocal of the factors that go into the coefficients, and the other factors."""
        inner, outer = self.field.one, []
        for divisor, power in written.divisors:
            if level == _FIXED or self._moves(divisor):
                outer.append((divisor, power))
            else:
                inner = inner / divisor**power
        return inner, outer

    # -- building -----------------------------------------------------------------------

    def node(self, element: Element) -> int:
        """The graph node of an element given to the constructor."""
        return self._build(self._form(element, _MEMBER), _MEMBER)

    def _build(self, form: Form, level: int) -> int:
        addends: list[int] = []
        for ratio in form:
            terms = self._terms(ratio, level)
            divisor = self.graph.product(
                self._build(inner, level) for inner, power in ratio.divisors for _ in range(power)
            )
            whole = not ratio.divisors
            addends += terms if whole else [self.graph.divide(self.graph.sum(terms), divisor)]
        return self.graph.sum(addends)

    def _terms(self, ratio: Ratio, level: int) -> list[int]:
        """The addends of a numerator."""
        graph, terms = self.graph, list[int]()
        if ratio.nested:
            return self._addends(ratio.nested)
        for coefficient, members in ratio.groups:
            factor = self._build_coefficient(coefficient)
            products = [(sign, self._shared[level][product]) for sign, product in members]
            if len(products) == 1 or coefficient == 1:
                terms += [self._apply_sign(sign, [factor], product) for sign, product in products]
            else:
                inner = graph.sum(self._apply_sign(sign, [], product) for sign, product in products)
                terms.append(graph.multiply(factor, inner))
        return terms

    def _addends(self, nested: Sum) -> list[int]:
        """The addends of a sum with common factors in front."""
        addends = []
        for each in nested:
            if isinstance(each, Nest):
                lead = self._apply_sign(1, [], self._shared[_MEMBER][each.lead])
                inner = self.graph.sum(self._addends(each.inner))
                addends.append(self.graph.multiply(lead, inner))
            else:
                product = self._shared[_MEMBER][each.product]
                addends.append(self._apply_sign(each.sign, [], product))
        return addends

    def _build_coefficient(self, coefficient: Fraction | tuple[tuple[int, Form], ...]) -> int:
        """The node of a coefficient: a number, or its addends added up."""
        if isinstance(coefficient, Fraction):
            return self.graph.number(coefficient)
        return self.graph.sum(self._build(addend, inner) for inner, addend in coefficient)

    def _apply_sign(self, sign: int, lead: list[int], product: Product) -> int:
        node = self.graph.product([*lead, *map(self._factor, product)])
        return node if sign > 0 else self.graph.negate(node)

    def _factor(self, name: str) -> int:
        """The node of a factor: a shared pair, a coefficient, a function, or a symbol."""
        if name.startswith(COEFFICIENT):
            return self._build_coefficient(self._coefficients_by_name[name])
        if name in self._pairs:
            return self.graph.product(map(self._factor, self._pairs[name]))
        if name in self._scales:
            scale, component = self._scales.take(name)
            lead = self._build_coefficient(self._coefficient(scale))
            return self.graph.multiply(lead, self._factor(component))
        known = self.field.adjoined.get(name)
        if known is None:
            for each in self._loops:
                if name in each.loop_symbols:
                    return self._item(each, name)
            return self.graph.node_of_name(name, self._numbers)
        return self.graph.call(known.function, *map(self._argument, self._list_arguments(name)))

    def _argument(self, argument: Element | Sided | Square) -> int:
        """The node of an argument of a function."""
        if isinstance(argument, Square):
            root = self._argument(argument.root)
            return self.graph.multiply(root, root)
        if not isinstance(argument, Sided):
            level = self._level(argument)
            return self._build(self._form(argument, level), level)
        graph, side = self.graph, self._factor(argument.sign)
        one, minus = graph.number(Fraction(1)), graph.negate(side)
        weights = {1: graph.sum([one, side]), -1: graph.sum([one, minus])}
        rest = []
        if 0 in argument.values:
            square = graph.multiply(side, side)
            weights = {1: graph.sum([square, side]), -1: graph.sum([square, minus])}
            others = graph.sum([one, graph.negate(square)])
            rest = [graph.product([others, self._argument(argument.values[0])])]
        parts = [graph.product([weights[k], self._argument(argument.values[k])]) for k in weights]
        return graph.sum([graph.product([graph.number(Fraction(1, 2)), graph.sum(parts)]), *rest])

    def _item(self, solve: Solve, name: str) -> int:
        """The node of what a loop gives."""
        if name not in self._solved:
            factors = self.graph.factors(list(map(self.node, solve.entries)))
            solution = self.graph.solution(factors, list(map(self.node, solve.known)))
            size = range(len(solve.block))
            nodes = [self.graph.item(factors, place_of(n, n)) for n in size]
            nodes += [self.graph.item(solution, n) for n in size]
            self._solved |= zip(solve.loop_symbols, nodes, strict=True)
        return self._solved[name]


def loops_under(equations: Equations, elements: Iterable[Element]) -> list[Solve]:
    """The loops whose symbols elements have."""
    if not equations.loops:
        return []
    names = frozenset[str]().union(*map(equations.setting.field.names_in, elements))
    return [each for each in equations.exact.solves if names.intersection(each.loop_symbols)]


def _keep(argument: Element) -> Element | Sided | Square:
    """An argument as it is."""
    return argument


def _mark(element: Element) -> Any:
    """Something hashable that tells elements apart by how they are written."""
    return tuple((part.numer, tuple(sorted(part.powers.items()))) for part in element.parts)
