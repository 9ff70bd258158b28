r"""Generic point: the rates of fields at one point of a grid, as loops are made of them.

Differences are applied to expressions, which are written without being multiplied out, and to
elements of a field that has symbols for the neighbours.
Comes in: Equations of fields. Goes out: a `Family`, and brackets, rates and densities of the point.
Read next: `coadjoint.derive.fields.rings`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from coadjoint.derive.action import Bracket, add_action
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.ends import CLOSURES, EndCalculus, find_weight
from coadjoint.derive.fields.jets import Jets, jets_of, narrow, solved
from coadjoint.derive.fields.lattice import Calculus, Lattice, LatticeField, LatticeTerm, name_at
from coadjoint.derive.fields.operators import Operator
from coadjoint.derive.fields.solved import (
    find_factors,
    is_level,
    multiply_out,
    solve_ring,
    write_solved,
)
from coadjoint.derive.fields.stencils import stencil, width_of
from coadjoint.derive.fields.structure import field_operator
from coadjoint.derive.symbols import choose_names
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field
from coadjoint.families import Family, Sum, Total


class GenericPoint:
    """The motion of fields at one point of a grid, by that of its neighbours.

    Args:
        equations: Of the fields.
    """

    def __init__(self, equations: Equations) -> None:
        assert equations.spec.space is not None, equations.spec.name
        self.equations, self.spec = equations, equations.spec
        self.space, self.setting = equations.spec.space, equations.setting
        self.jets: Jets = jets_of(self.setting)
        self.operator: Operator = field_operator(self.setting)
        (self.count,) = choose_names(self.spec, ["N"])
        self.order = self.space.order

    # -- densities ------------------------------------------------------------------------

    @cached_property
    def densities(self) -> dict[str, Element]:
        """The energy and the observables, by component.

        Raises:
            DerivationError: One has derivatives, and there are ends.
        """
        found = dict(self.equations.exact.observables)
        if not self.space.has_ends:
            return {name: narrow(self.jets, value) for name, value in found.items()}
        jets = {x for name, tower in self.jets.towers.items() for x in tower} - {
            *self.setting.state
        }
        for name, value in found.items():
            named = sorted(self.setting.field.reach(value) & jets)
            if named:
                raise DerivationError(
                    f"{self.spec.path}: {name} has the derivative {named[0]}, and there are "
                    f"{self.space.ends} ends; expected densities of fields alone. Remove it, or "
                    'write ends = "periodic".',
                    found=named[0],
                )
        return found

    @cached_property
    def slopes(self) -> list[list[Element]]:
        """Derivatives of the density of the energy by each field and its derivatives.

        Where A u = m with a symmetric matrix A, half the sum of m u has the gradient u.
        """
        energy = self.densities["energy"]
        return [self.find_slopes(energy, name) for name in self.setting.state]

    def find_slopes(self, density: Element, name: str) -> list[Element]:
        """Derivatives of a density by a field and its derivatives."""
        if not solved(self.spec):
            return self.jets.slopes(density, name)
        own = self.jets.slopes(density, name) or [self.setting.field.zero]
        whole = circle.vary(self.setting, density, name)
        through = whole - self.jets.euler(density, name)
        return [own[0] + through, *own[1:]]

    @property
    def components(self) -> tuple[str, ...]:
        """What has a value at each point: the fields, and what is solved for."""
        return (*self.setting.state, *solved(self.spec))

    @cached_property
    def stencil_reach(self) -> int:
        """The widest difference."""
        orders = {t.order for row in self.operator for entry in row for t in entry}
        for value in self.densities.values():
            orders |= {len(self.jets.slopes(value, name)) - 1 for name in self.setting.state}
        orders |= circle.inertia_along(self.setting).keys()
        return max(width_of(k, self.order) for k in orders if k >= 0)

    # -- at points, in any arithmetic -------------------------------------------------------

    def motion(self, calculus: Calculus, place: Callable[[Element], Lattice]) -> list[Lattice]:
        """The rates of the fields at points."""
        slopes = [calculus.vary([place(x) for x in own]) for own in self.slopes]
        return calculus.compose(self._place_operator(place), slopes)

    def _place_operator(self, place: Callable[[Element], Lattice]) -> list[list[list[LatticeTerm]]]:
        """The operator of the bracket at points."""
        return [
            [[(place(t.left), t.order, place(t.right)) for t in entry] for entry in row]
            for row in self.operator
        ]

    def placer(
        self,
        calculus: Calculus,
        value: Callable[[str, int], Any],
        convert: Callable[[Element, Mapping[str, Any]], Any],
    ) -> Callable[[Element], Lattice]:
        """How an expression in jets is evaluated at points.

        Args:
            calculus: The differences.
            value: A component at a point.
            convert: An expression with values for jets.
        """
        orders = self.jets.orders

        def jet(symbol: str) -> Lattice:
            name, n = orders[symbol]
            return calculus.differentiate(lambda i: value(name, i), n)

        def place(element: Element) -> Lattice:
            named = sorted(self.setting.field.reach(element) & orders.keys())
            values = {symbol: jet(symbol) for symbol in named}
            known = dict[int, Any]()

            def at(i: int) -> Any:
                if i not in known:
                    known[i] = convert(element, {x: f(i) for x, f in values.items()})
                return known[i]

            return at

        return place

    # -- the generic point ------------------------------------------------------------------

    def find_inverse(self, count: Any, length: Any) -> Any:
        """One over the spacing, for N points of a circle, or of a line with two ends."""
        return (count - 1 if self.space.has_ends else count) / length

    @property
    def numbers(self) -> tuple[int, ...]:
        """The points near ends, counted from there."""
        some = len(CLOSURES[self.order].rows) if self.space.has_ends else 0
        return (*range(some), *range(-some, 0))

    def calculate(self, at: int | None, **given: Any) -> Calculus:
        """Differences at points of a circle, inside of a line, or at a point near an end.

        Args:
            at: The number of a point near an end; None for others.
            given: As `Calculus` takes it.
        """
        if not self.space.has_ends:
            return Calculus(order=self.order, **given)
        return EndCalculus(order=self.order, meets=self.meets, place=lambda _: at, **given)

    @cached_property
    def meets(self) -> tuple[bool, ...]:
        """Of the rate of each field, whether it has the derivative of what is 0 at the ends."""
        strains = {c for each in self.setting.advected if each.strain for c in each.components}
        clamped = self.space.ends == "clamped"
        return tuple((name in strains) == clamped for name in self.setting.state)

    @cached_property
    def written(self) -> tuple[list[sympy.Expr], dict[str, sympy.Expr]]:
        """Rates and densities of the generic point as expressions that are not multiplied out."""
        return self._write(None)

    @cached_property
    def written_ends(self) -> dict[int, tuple[sympy.Expr, ...]]:
        """The rates of points near ends; empty on a circle."""
        return {number: tuple(self._write(number)[0]) for number in self.numbers}

    def _write(self, number: int | None) -> tuple[list[sympy.Expr], dict[str, sympy.Expr]]:
        """The same of a point near an end."""
        calculus, place = self._place_in_trees(number)
        rates = [f(0) for f in self.motion(calculus, place)]
        return rates, {name: place(value)(0) for name, value in self.densities.items()}

    def _place_in_trees(self, number: int | None) -> tuple[Calculus, Callable[[Element], Lattice]]:
        """Differences and expressions as SymPy has them."""
        field = self.setting.field
        inverse = self.find_inverse(sympy.Symbol(self.count), sympy.Symbol(self.space.length))
        given = {"inverse": inverse, "number": rational, "tidy": sympy.factor_terms}
        calculus = self.calculate(number, **given)

        def convert(element: Element, values: Mapping[str, Any]) -> Any:
            new = {sympy.Symbol(name): value for name, value in values.items()}
            return field.to_sympy(element).xreplace(new)

        def value(name: str, i: int) -> sympy.Symbol:
            return sympy.Symbol(name_at(name, i))

        return calculus, self.placer(calculus, value, convert)

    @cached_property
    def reach(self) -> int:
        """How far the neighbours are that rates and densities read."""
        named = {s.name for each in self._trees for s in each.free_symbols}
        return max(abs(shift) for _, shift in map(_read_place, named))

    @property
    def _trees(self) -> list[sympy.Expr]:
        """All rates and densities."""
        rates, densities = self.written
        return [
            *rates,
            *densities.values(),
            *(x for own in self.written_ends.values() for x in own),
        ]

    @cached_property
    def lattice(self) -> LatticeField:
        """An exact field for what is proved of the generic point."""
        reach = 4 * self.reach
        symbols = [name_at(c, r) for c in self.components for r in range(-reach, reach + 1)]
        rest = [*self.setting.parameters, self.count]
        slots = len(self.setting.field.adjoined) * (2 * reach + 1)
        positive = [*(self.setting.field.positive & {*rest}), self.count]
        return LatticeField(Field([*symbols, *rest], slots, positive), self.components, reach)

    def calculus_in(self, field: Field, inverse: Element, number: int | None = None) -> Calculus:
        """Differences of elements of a field, with one over the spacing."""
        return self.calculate(number, inverse=inverse, number=field.number)

    def converter(self, field: Field) -> Callable[[Element, Mapping[str, Any]], Any]:
        """Expressions in jets as elements of another field."""
        own = self.setting.field

        def convert(element: Element, values: Mapping[str, Any]) -> Any:
            known = {name: field[name] for name in own.reach(element) if name not in values}
            return own.evaluate(element, {**known, **values}, field.number, field.call)

        return convert

    def place_exactly(
        self, number: int | None = None
    ) -> tuple[Calculus, Callable[[Element], Lattice]]:
        """Differences and expressions in the exact field of the lattice."""
        field = self.lattice.field
        inverse = self.find_inverse(field[self.count], field[self.space.length])
        calculus = self.calculus_in(field, inverse, number)
        convert = self.converter(field)
        return calculus, self.placer(calculus, lambda c, i: field[name_at(c, i)], convert)

    @cached_property
    def brackets(self) -> dict[tuple[str, str, int], Element]:
        """``h {u_a(i), u_b(i + r)}`` by a, b and r."""
        calculus, place = self.place_exactly()
        found = dict[tuple[str, str, int], list[Element]]()
        for a, entries in zip(self.setting.state, self.operator, strict=True):
            for b, entry in zip(self.setting.state, entries, strict=True):
                for term in entry:
                    left, right = place(term.left), place(term.right)
                    for r, c in stencil(term.order, self.order).items():
                        weight = calculus.inverse**term.order * c
                        found.setdefault((a, b, r), []).append(left(0) * right(r) * weight)
        return {key: self.lattice.field.sum(parts) for key, parts in found.items()}

    @cached_property
    def exact_point(self) -> tuple[list[Element], dict[str, Element]]:
        """Rates and densities of the generic point in the exact field of the lattice."""
        calculus, place = self.place_exactly()
        rates = [f(0) for f in self.motion(calculus, place)]
        return rates, {name: place(value)(0) for name, value in self.densities.items()}

    @cached_property
    def exact_ends(self) -> dict[int, tuple[Element, ...]]:
        """The rates of points near ends, likewise; empty on a circle."""
        found = dict[int, tuple[Element, ...]]()
        for number in self.numbers:
            found[number] = tuple(f(0) for f in self.motion(*self.place_exactly(number)))
        return found

    # -- what is solved for -------------------------------------------------------------------

    @cached_property
    def momenta(self) -> dict[str, Element]:
        """The momentum at the generic point in the velocities around it; empty without A."""
        if not solved(self.spec):
            return {}
        (m,), (u,), field = self.setting.state, solved(self.spec), self.lattice.field
        inverse = self.find_inverse(field[self.count], field[self.space.length])
        factors = self._find_factors(field, inverse)
        if is_level(self.setting):
            factors = multiply_out(factors)
        return {m: field.sum(a * field[name_at(u, r)] for r, a in factors.items())}

    def _find_factors(self, field: Field, inverse: Element) -> dict[int, Element]:
        """The factors of the equation for the velocity in a field."""
        convert = self.converter(field)
        return find_factors(
            self.setting, self.order, inverse, field.number, lambda x: convert(x, {})
        )

    def solve(
        self, field: Field, inverse: Element, size: int, names: Mapping[tuple[str, int], str]
    ) -> dict[tuple[str, int], Element]:
        """The velocities of a ring, by their name and point."""
        if not solved(self.spec):
            return {}
        (m,), (u,), factors = (
            self.setting.state,
            solved(self.spec),
            self._find_factors(field, inverse),
        )
        momenta, level = [field[names[m, i]] for i in range(size)], is_level(self.setting)
        found = solve_ring(factors, field, momenta, level=level)
        return {(u, i): value for i, value in enumerate(found)}

    @cached_property
    def family(self) -> Family:
        """The generic point as loops are made of it."""
        rates, densities = self.written
        symbols = {s for each in self._trees for s in each.free_symbols}
        states = tuple(map(sympy.Symbol, self.setting.state))
        neighbours = {
            (sympy.Symbol(name), shift): symbol
            for symbol in sorted(symbols, key=lambda s: (_read_place(s.name)[1], s.name))
            for name, shift in [_read_place(symbol.name)]
            if shift
        }
        count, length = map(sympy.Symbol, (self.count, self.space.length))
        inverse = self.find_inverse(count, length)
        singles = {(c, n): sympy.Symbol(f"{c}({n})") for c in states for n in self.numbers}
        totals = tuple(
            Total(
                name=name,
                formula=(sympy.Symbol(f"{name}_sum") + self._weigh(term, singles)) / inverse,
                sums=(Sum(symbol=sympy.Symbol(f"{name}_sum"), term=term),),
            )
            for name, term in densities.items()
        )
        named = {s for each in totals for s in each.formula.free_symbols}
        family = Family(
            index=self.space.index,
            states=states,
            shifts=tuple(sorted({shift for _, shift in neighbours})),
            neighbours=neighbours,
            shared=tuple(map(sympy.Symbol, self.setting.parameters)),
            indexed=(),
            partners={},
            rates=tuple(rates),
            pair_sums=(),
            ends=self.written_ends,
            totals=totals,
            small=self.least,
            wraps=not self.space.has_ends,
            singles={key: symbol for key, symbol in singles.items() if symbol in named},
            count=(count,),
            solved=write_solved(self.setting, self.order, inverse),
        )
        return add_action(family, self._multiply(None), self._multiply_ends())

    def _multiply_ends(self) -> dict[int, Bracket]:
        """The bracket at points that read one with a weight; empty on a circle."""
        some = len(self.numbers) // 2
        reach = some and some + width_of(1, self.order)
        return {n: self._multiply(n) for n in (*range(reach), *range(-reach, 0))}

    def _multiply(self, number: int | None) -> Bracket:
        """The bracket of a point times a vector: on one over the weights and the spacing."""

        def apply(find: Callable[[str, int], sympy.Symbol]) -> list[sympy.Expr]:
            calculus, place = self._place_in_trees(number if number in self.numbers else None)

            def look_up(name: str) -> Lattice:
                return lambda i: find(name, i) / rational(self._find_weight(number, i))

            vector = list(map(look_up, self.setting.state))
            rows = calculus.compose(self._place_operator(place), vector)
            return [calculus.inverse * f(0) for f in rows]

        return apply

    def _find_weight(self, number: int | None, i: int) -> Fraction:
        """The weight of a point so many points after one near an end."""
        at = None if number is None else number + i
        return find_weight(self.order, at if at in self.numbers else None)

    @property
    def least(self) -> int:
        """The fewest points: no difference meets itself, or points of both ends."""
        between = 2 * self.stencil_reach
        return len(self.numbers) + between if self.space.has_ends else between + 1

    def _weigh(self, term: sympy.Expr, singles: Mapping[tuple[Any, int], Any]) -> sympy.Expr:
        """What the weights of points near ends add to a sum over all points."""
        parts = [
            rational(find_weight(self.order, n) - 1)
            * term.xreplace({c: symbol for (c, k), symbol in singles.items() if k == n})
            for n in self.numbers
        ]
        return sympy.Add(*parts)


def rational(value: Fraction) -> sympy.Rational:
    """A number of SymPy."""
    return sympy.Rational(value.numerator, value.denominator)


def _read_place(name: str) -> tuple[str, int]:
    """A component and how many points away it is, by the name of both."""
    component, _, rest = name.partition("[")
    return component, int(rest.removesuffix("]") or 0)
