"""Totals of a family, read off from a few members: the energy, observables and momentum maps.

Comes in: the Equations of a window. Goes out: a `Total` of each number of the whole system: the
generic terms of its sums, and what follows from these and from members at the ends.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.symmetries import evaluate_map, share_of
from coadjoint.derive.window import Window
from coadjoint.exact import Element
from coadjoint.exact.dense import dot
from coadjoint.families import Sum, Total
from coadjoint.spec import Formula
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import reach
from coadjoint.spec.core.totals import find_alone, is_linear, keep_rest
from coadjoint.spec.core.written_out import place_at
from coadjoint.spec.model import Symmetry


@dataclass(frozen=True)
class TotalsReader(Window):
    """The reading of what a window has as sums."""

    @property
    def totals(self) -> Iterator[Total]:
        """The energy and the observables."""
        spec = self.equations.spec
        if self.energy is not None:
            yield from self._total("energy", (), self.energy)
        for each in spec.observables:
            assert each.formula.sums is not None, each.name
            find = (
                self._total
                if is_linear(each.formula.sums, self.members)
                else self._function_of_sums
            )
            yield from find(each.name, each.shape, each.formula)
        for symmetry in spec.symmetries:
            yield from self._momentum_map(symmetry)

    def _momentum_map(self, symmetry: Symmetry) -> Iterator[Total]:
        """The components of the momentum map of an action that moves each member by itself."""
        if symmetry.map is not None:
            shares = self._declared_map(symmetry, symmetry.map)
        else:
            names = self.names_of(self.declared.variables, self.middle)
            shares = share_of(self.equations.setting, symmetry, names)
        terms = self.see(map(self.write, shares), self.rename(self.middle, 0, 0))
        for component, term in zip(symmetry.components, terms, strict=True):
            symbol = sympy.Symbol(f"{component}_sum1_1")
            yield Total(component, symbol, (Sum(symbol=symbol, term=term),))

    def _declared_map(self, symmetry: Symmetry, formula: Formula) -> tuple[Element, ...]:
        """The share of the member in the middle, along each basis vector."""
        setting = self.equations.setting

        def evaluate(known: Mapping[str, Any]) -> Element:
            places = [
                place_at(term, {each.indices[0]: self.middle}, self.members)
                for each, term in self.sums_of(formula)
            ]
            values = {**setting.values, **known}
            return setting.field.sum(interpret(each, values, setting.field) for each in places)

        return evaluate_map(setting, symmetry, evaluate)

    @property
    def energy(self) -> Formula | None:
        """The Hamiltonian, or the Lagrangian of which it is the Legendre transform."""
        spec = self.equations.spec
        return spec.lagrangian if spec.hamiltonian is None else spec.hamiltonian

    def transform(self, formula: Formula, values: Iterable[Element]) -> list[Element]:
        """``v . dl/dv - l`` of parts of a Lagrangian, in the state; else parts as they are."""
        setting = self.equations.setting
        if formula is not setting.spec.lagrangian:
            return list(values)
        field, names = setting.field, mechanics(setting).frame.velocities
        v = setting.elements(names)
        return [dot(field.gradient(part, names), v) - part for part in values]

    def _total(self, name: str, shape: tuple[int, ...], formula: Formula) -> Iterator[Total]:
        """The components of a total."""
        rest = self._see_rest(formula)
        sums = [
            self._add_up(f"{name}_sum{number}", each, self._terms(formula, each, term))
            for number, (each, term) in enumerate(self.sums_of(formula), 1)
        ]
        for n, component in enumerate(component_names(name, shape)):
            parts = tuple(each[n] for each in sums)
            values = [*(each.symbol for each in parts), *rest[n : n + 1]]
            yield Total(component, sympy.Add(*values), parts)

    def _add_up(self, name: str, each: tree.Sum, terms: Sequence[sympy.Expr]) -> list[Sum]:
        """The components of a sum."""
        before, after = reach(each.term)
        return [
            Sum(
                symbol=sympy.Symbol(f"{name}_{place}"),
                term=term,
                over="members" if len(each.indices) == 1 else "pairs",
                before=before,
                after=after,
            )
            for place, term in enumerate(terms, 1)
        ]

    def _function_of_sums(
        self, name: str, shape: tuple[int, ...], formula: Formula
    ) -> Iterator[Total]:
        """The components of a function that is not linear in its sums; the first has them all."""
        setting, known, sums = self.equations.setting, dict[str, Any](), list[Sum]()

        def put(node: tree.Node, below: list[tree.Node]) -> tree.Node:
            if not isinstance(node, tree.Sum):
                return tree.rebuild(node, below)
            own = f"{name}_sum{len(known) + 1}"
            parts = self._add_up(own, node, self._terms(formula, node, node.term))
            at = dict(zip(node.indices, (self.middle, self.middle + 1), strict=False))
            value = interpret(place_at(node.term, at, self.members), setting.values, setting.field)
            symbols = iter([part.symbol for part in parts])
            known[own] = _fill(value, symbols)
            sums.extend(parts)
            return tree.Name(own)

        assert formula.sums is not None, formula.key
        whole = tree.fold(formula.sums, put, _list_outside)
        values: Any = entries(self.written.value(place_at(whole, {}, self.members), known))
        new = self._name_alone(formula.sums)
        for n, (component, value) in enumerate(
            zip(component_names(name, shape), values, strict=True)
        ):
            yield Total(component, value.xreplace(new), () if n else tuple(sums))

    def _name_alone(self, whole: tree.Node) -> dict[sympy.Symbol, sympy.Symbol]:
        """Symbols of the members that stand alone in a tree, by those of the window."""
        new = dict[sympy.Symbol, sympy.Symbol]()
        for number in sorted(find_alone(whole, self.members)):
            own = map(sympy.Symbol, self.names_of(self.names, number % self.members.count))
            seen = (self.singles[each, number] for each in self.own)
            new |= zip(own, seen, strict=True)
        return new

    def _place_rest(self, formula: Formula) -> tree.Node | None:
        """What a total has outside of its sums, in the window."""
        assert formula.sums is not None, formula.key
        rest = keep_rest(formula.sums)
        return None if rest is None else place_at(rest, {}, self.members)

    def _see_rest(self, formula: Formula) -> tuple[sympy.Expr, ...]:
        """The components of what a total has outside of its sums, in symbols of single members."""
        placed = self._place_rest(formula)
        if placed is None:
            return ()
        assert formula.sums is not None, formula.key
        return self._see_terms(formula, placed, self._name_alone(formula.sums))

    def _see_terms(
        self, formula: Formula, placed: tree.Node, new: Mapping[Any, Any]
    ) -> tuple[sympy.Expr, ...]:
        """The components of a part of a formula in the window, in generic symbols."""
        values = self.transform(formula, self.value(placed))
        if formula is self.equations.spec.lagrangian:
            written: Sequence[Any] = [self.written.with_velocities(value) for value in values]
        else:
            written = entries(self.written.value(placed))
        return self.see(map(self.write, values), new, written)

    def _terms(self, formula: Formula, each: tree.Sum, term: tree.Node) -> Sequence[sympy.Expr]:
        """The components of the term of a sum, in generic symbols."""
        if len(each.indices) > 1:
            values = self.transform(formula, self.value(self.place_pair(each, term)))
            return [self.see_pair(value) for value in values]
        before, after = reach(each.term)
        at = 0 if self.members.periodic else before
        placed = place_at(term, {each.indices[0]: at}, self.members)
        return self._see_terms(formula, placed, self.rename(at, before, after))

    def singles_of(self, totals: Iterable[Total]) -> dict[tuple[sympy.Symbol, int], sympy.Symbol]:
        """Those that totals name."""
        named = {s for total in totals for s in total.formula.free_symbols}
        return {place: symbol for place, symbol in self.singles.items() if symbol in named}

    def place_pair(
        self, each: tree.Sum, term: tree.Node, at: tuple[int, int] = (0, 1)
    ) -> tree.Node:
        """The term of two members."""
        return place_at(term, dict(zip(each.indices, at, strict=True)), self.members)

    def see_pair(self, value: Element) -> sympy.Expr:
        """An element of the first two members in the symbols of a member and its partner."""
        new = dict(zip(map(sympy.Symbol, self.names_of(self.names, 0)), self.own, strict=True))
        others = [self.partners[each] for each in self.own]
        new |= zip(map(sympy.Symbol, self.names_of(self.names, 1)), others, strict=True)
        return self.see([self.write(value)], new)[0]


def _list_outside(node: tree.Node) -> Sequence[tree.Node]:
    """What is below a node, but not what is below a sum."""
    return () if isinstance(node, tree.Sum) else tree.children(node)


def _fill(value: Any, symbols: Iterator[sympy.Symbol]) -> Any:
    """Symbols in the shape of a value."""
    if isinstance(value, tuple):
        return tuple(_fill(each, symbols) for each in value)
    return next(symbols)
