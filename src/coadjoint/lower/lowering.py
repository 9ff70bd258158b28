"""Lowering: Equations become Programs, one for each function of the kernels.

Comes in: Equations. Goes out: a Program for each of the `coadjoint.kernel_functions` that the
equations have. An element is a sum of products in the order of the field; what depends on
parameters alone is gathered into the coefficients, equal coefficients are factored out, and pairs
of factors that recur are shared.
Definitions keep their names: a kernel reads like the book.
Read next: `coadjoint.lower.check`, which undoes all this exactly.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import Any

from coadjoint.derive import Equations
from coadjoint.derive.formulas import Rows, rhs, rows_of
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.exact import Element, Field
from coadjoint.exact.rationals import Written
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower.definitions import inline_single_uses, shorten
from coadjoint.lower.graph import Graph
from coadjoint.lower.jacobian import factors_of_solves, jacobian, residual_slopes
from coadjoint.lower.minors import entries_of, find_solve, is_faster, set_factored, solve_by_minors
from coadjoint.lower.naming import Naming
from coadjoint.lower.nesting import COEFFICIENT, ORDERS, Nest, Sum, Term, list_products, nest
from coadjoint.lower.products import Pair, Product, share_pairs
from coadjoint.lower.program import Program
from coadjoint.lower.scales import Scales, cost, find_scales
from coadjoint.lower.tables import (
    UNROLLED_PRODUCTS,
    differentiate_along,
    find_products,
    loop_over,
    loop_rows,
)
from coadjoint.lower.vanishing import find_hidden_zeros

#: Rates that cost more are left with the definitions that they have: each try takes as long as
#: lowering them does.
TRIED_COST = 1000


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
#: An element as a sum of quotients, one for each denominator that moves with the member.
Form = tuple[Ratio, ...]
#: What to compute before it is shared: coefficients by product, for each such denominator.
_Sums = dict[Any, tuple[list[tuple[Element, int]], dict[Product, Element]]]


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
        self._numbers = equations.numbers
        self._kept: list[Element] = []
        self._products: dict[int, list[Product]] = {_FIXED: [], _DRIVEN: [], _MEMBER: []}
        for element in elements:
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
                for argument in self.field.adjoined[name].arguments:
                    self._form(argument, self._level(argument))

    def _moves(self, element: Element) -> bool:
        """Whether an element depends on the member, not on parameters alone."""
        return bool(self.field.reach(element) & self._members)

    def _level(self, argument: Element) -> int:
        return _MEMBER if self._moves(argument) else _FIXED

    def _is_factor(self, name: str, level: int) -> bool:
        """Whether a generator belongs into products rather than into coefficients."""
        moving = {_DRIVEN: self._members, _MEMBER: self._state}
        return level == _FIXED or bool(self.field.reach(self.field[name]) & moving[level])

    def _collect(self, written: Written, level: int) -> dict[Product, Element]:
        """Numerator terms by their product, with the coefficient polynomial of each."""
        parts: dict[Product, Element] = {}
        for term in written.monomials:
            product: list[str] = []
            coefficient = self.field.number(term.number)
            for name, power in term.powers:
                if self._is_factor(name, level):
                    product += [name] * power
                else:
                    coefficient = coefficient * self.field[name] ** power
            known = parts.get(tuple(product))
            parts[tuple(product)] = coefficient if known is None else known + coefficient
        return parts

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
            return self.graph.node_of_name(name, self._numbers)
        levels = [(argument, self._level(argument)) for argument in known.arguments]
        arguments = (self._build(self._form(each, level), level) for each, level in levels)
        return self.graph.call(known.function, *arguments)


def _mark(element: Element) -> Any:
    """Something hashable that tells elements apart by how they are written."""
    return tuple((part.numer, tuple(sorted(part.powers.items()))) for part in element.parts)


def lower(equations: Equations) -> dict[str, Program]:
    """The Programs of all functions of a system's kernels, by name.

    Jacobians are derivatives of the ``rhs`` Program by forward accumulation, so they share the
    definitions and are as cheap as these make them.
    """
    programs: dict[str, Program] = {}
    looped = _loop(equations)
    for name, function in KERNEL_FUNCTIONS.items():
        if function.looped == ("only" if looped is None else "never"):
            continue
        rows = rows_of(equations, name)
        if rows is None:
            continue
        own = None if looped is None else _lower_by_table(name, rows, looped)
        if own is not None:
            programs[name] = own
        elif rows.by:
            programs[name] = _jacobian(name, rows, programs["rhs"])
        else:
            programs[name] = _clear_hidden_zeros(equations, name, rows)
    if looped is None:
        programs["rhs"] = _choose(equations, _scale(equations, programs["rhs"]))
    return programs


def _lower_by_table(name: str, rows: Rows, looped: Program) -> Program | None:
    """A function of a system whose rates are loops as a loop; None where it is none."""
    if name == "rhs":
        return looped
    if rows.along:
        return differentiate_along(looped, rows)
    return loop_rows(rows, name, looped) if name in ("energy", "observables") else None


def _loop(equations: Equations) -> Program | None:
    """The rates as loops over a table of coefficients, where they are many products."""
    products = find_products(equations)
    if sum(map(len, products)) <= UNROLLED_PRODUCTS:
        return None
    rows = rhs(equations)
    definitions = equations.definitions_of(rows.elements)
    lowering = Lowering(equations, [element for _, element in definitions])
    named = [(name, lowering.node(element)) for name, element in definitions]
    needed = [(name, lowering.graph.symbol(name)) for name, _ in definitions]
    program = _name(equations, "rhs", lowering, (named, needed), rows.shape, rows.state)
    return loop_over(program, rows, products)


def _choose(equations: Equations, plain: Program) -> Program:
    """The rates without the definitions that cancel one another, found by trying each of them.

    A name is tried with those of the same letters, ``Y1, Y2, Y3``, as vectors have them. What a
    solve names stays.
    """
    rows, best = rhs(equations), plain
    names = [name for name, _ in equations.definitions_of(rows.elements)]
    closed: frozenset[str] = frozenset()
    if cost(plain) > TRIED_COST:
        return plain
    for _, group in groupby(names, key=lambda name: name.rstrip("0123456789_")):
        tried = closed.union(group)
        if tried & equations.intermediates:
            continue
        with suppress(OverflowError):  # functions of other arguments
            program = _program(equations, "rhs", rows.lines, rows.shape, rows.state, closed=tried)
            if cost(program) < cost(best):
                closed, best = tried, program
    nested = 0
    for order in ORDERS:
        program = _program(
            equations, "rhs", rows.lines, rows.shape, rows.state, closed=closed, nested=order
        )
        if cost(program) < cost(best):
            nested, best = order, program
    return _take_minors(equations, best, closed, nested)


def _take_minors(
    equations: Equations, best: Program, closed: frozenset[str], nested: int
) -> Program:
    """The rates with three unknowns by minors, where that takes less time."""
    rows = rhs(equations)
    if (solve := find_solve(equations, rows.lines)) is None:
        return best
    shape, state = rows.shape, rows.state
    program = _program(
        equations, "rhs", rows.lines, shape, state, closed=closed, solve=solve, nested=nested
    )
    return set_factored(program, best) if is_faster(program, best) else best


def _scale(equations: Equations, plain: Program) -> Program:
    """The rates over products of velocities, where that takes fewer operations.

    Jacobians are made of the rates as they were: each product of momenta has one factor to
    differentiate, and a product of velocities has two.
    """
    scales, rows = find_scales(equations), rhs(equations)
    if not scales or plain.statements_at("member"):
        return plain  # velocities are named already
    scaled = _program(equations, "rhs", rows.lines, rows.shape, rows.state, scales)
    return min(plain, scaled, key=cost)


def _clear_hidden_zeros(equations: Equations, name: str, rows: Rows) -> Program:
    """A Program in which what vanishes everywhere is written as zero, where a row may hide it."""
    program = _program(rows.of, name, rows.lines, rows.shape, rows.state)
    zeros = find_hidden_zeros(program, equations) if rows.may_hide_zeros else []
    if not zeros:
        return program
    lines = list(rows.lines)
    for place in zeros:
        lines[place] = lines[place][0], equations.setting.field.zero
    return _program(rows.of, name, lines, rows.shape, rows.state)


def _jacobian(name: str, rows: Rows, rhs: Program) -> Program:
    """A derivative of the rates: by the state, the inputs or the parameters."""
    equations, field = rows.of, rows.of.setting.field
    slopes = residual_slopes(equations, rows.by)
    labelled = [(f"slope {each.row} by {each.by}", each.slope) for each in slopes]
    labelled += [
        (f"factor {i} {k}", value)
        for own_factors in factors_of_solves(equations)
        for (i, k), value in own_factors.items()
    ]
    # what the residuals name has a derivative, whether or not the rates need it
    inner = dict.fromkeys(each.by for each in slopes if each.by not in rows.by)
    labelled += [(by, field[by]) for by in inner]
    lines = [*rows.lines, *labelled]
    wide = _program(equations, "rhs", lines, (len(lines),), rows.state) if labelled else rhs
    return jacobian(name, wide, equations, rows.by, slopes)


def _program(
    equations: Equations,
    name: str,
    outputs: Sequence[tuple[str, Element]],
    shape: tuple[int, ...],
    state: tuple[str, ...],
    scales: Mapping[str, Element] | None = None,
    closed: frozenset[str] = frozenset(),
    solve: Solve | None = None,
    nested: int = 0,
) -> Program:
    """One Program from labelled elements of names, the state being the first of them."""
    asked = outputs if solve is None else entries_of(solve, outputs)
    shorter = [(label, shorten(equations, element)) for label, element in asked]
    definitions, parts = inline_single_uses(equations, shorter, closed)
    lowering = Lowering(
        equations, [element for _, element in (*definitions, *parts)], scales, nested
    )
    named = [(label, lowering.node(element)) for label, element in definitions]
    results = [(label, lowering.node(element)) for label, element in parts]
    if solve is not None:
        lines, results = solve_by_minors(lowering.graph, solve, dict(results), outputs)
        named += lines
    return _name(equations, name, lowering, (named, results), shape, state)


def _name(
    equations: Equations,
    name: str,
    lowering: Lowering,
    nodes: tuple[Sequence[tuple[str, int]], Sequence[tuple[str, int]]],
    shape: tuple[int, ...],
    state: tuple[str, ...],
) -> Program:
    """One Program from the nodes of definitions and outputs."""
    setting = equations.setting
    naming = Naming(lowering.graph, *nodes, setting.parameters)
    driving = {"inputs": setting.inputs, "time": setting.time}
    return naming.program(name, shape, state=state, parameters=setting.parameters, **driving)
