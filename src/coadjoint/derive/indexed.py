r"""The equations of the generic member, read off from a few members.

The rate of a member follows from the terms of the energy that contain it,

.. math:: \dot x_i = P(x_i) \frac{\partial}{\partial x_i} \sum_k h(x_k, \ldots, x_{k+r}),

and these are the same for every number of members that keeps neighbours apart. So the route of the
spec is followed for a few members, and the rate of one of them, with names for its neighbours in
the place of theirs, is that of all. In a ring with fewer members some neighbours are one and the
same: by the chain rule the formula holds there too. A sum over pairs is linear in its terms: the
partner's share is the bracket with the term of one pair.

Comes in: the Equations of the window. Goes out: a `Family`.
Read next: `coadjoint.families`, then `coadjoint.prove.indexed`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from coadjoint.derive.differences import tidy
from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.mechanics.turning import step_back, turning_residuals
from coadjoint.derive.symmetries import evaluate_map, share_of
from coadjoint.derive.window import Window
from coadjoint.derive.written import Written, choose
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import dot
from coadjoint.families import Family, Sum, Total
from coadjoint.spec import Formula
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import member_name, place_at, reach
from coadjoint.spec.core.totals import find_alone, keep_rest, put_term, split_sums
from coadjoint.spec.model import Symmetry, Variable
from coadjoint.spec.spatial import turning_rows


def derive_family(equations: Equations) -> Family:
    """The equations of the generic member.

    Args:
        equations: Of the first route, for the few members of a spec with an index.

    Raises:
        DerivationError: A member's rate depends on more than its neighbours, or the term of a pair
            changes when its members change places.
    """
    reader = _Reader(equations)
    declared = reader.declared
    (before, after), totals = declared.ends, tuple(reader.totals)
    alone = [n + 1 if n >= 0 else -n for _, n in reader.singles_of(totals)]
    small = max([before + after, 2 if declared.pairs else 1, *alone])
    pairs = tuple(reader.pair_sums.values()) if declared.pairs else ()
    rates = reader.rates_of(reader.middle)
    named = {s for each in totals for one in each.sums for s in one.term.free_symbols}
    noise, noise_ends = reader.noise_of(reader.middle), reader.noise_ends
    ends = (*reader.ends.values(), *noise_ends.values())
    every = (*rates, *noise, *(rate for end in ends for rate in end))
    named |= {s for rate in every for s in rate.free_symbols}
    neighbours = {place: s for place, s in reader.neighbours.items() if s in named}
    return Family(
        index=declared.index,
        states=reader.states,
        shifts=tuple(sorted({shift for _, shift in neighbours})),
        neighbours=neighbours,
        shared=tuple(map(sympy.Symbol, reader.shared)),
        indexed=reader.indexed,
        partners=reader.partners,
        rates=rates,
        pair_sums=pairs,
        ends=reader.ends,
        totals=totals,
        small=small,
        turned=reader.turned,
        residuals=reader.residuals,
        time=reader.time,
        shared_inputs=reader.shared_inputs,
        indexed_inputs=reader.indexed_inputs,
        noise=noise,
        noise_ends=noise_ends,
        shared_noise=tuple(map(sympy.Symbol, declared.shared_noise)),
        indexed_noise=reader.increments,
        singles=reader.singles_of(totals),
        wraps=declared.index.periodic or reader.is_closed,
    )


@dataclass(frozen=True)
class _Reader(Window):
    """The reading of one window."""

    @cached_property
    def written(self) -> Written:
        """What the spec says, not multiplied out."""
        return Written(self.equations)

    # -- expressions of a member --------------------------------------------------------

    def see(
        self, values: Iterable[sympy.Expr], new: Mapping[Any, Any], written: Iterable[Any] = ()
    ) -> tuple[sympy.Expr, ...]:
        """Expressions of the window in generic symbols.

        Args:
            values: As the exact field has them.
            new: The generic symbols.
            written: The same as the spec writes them, if that is known.

        Raises:
            DerivationError: They depend on members that are not seen.
        """
        plain = [self._rename(value, new) for value in values]
        seen = [value.xreplace(new) for value in written]
        short = choose(plain, seen, most=0.5)  # to tidy up what is multiplied out takes long
        if short:
            return short
        plain = [tidy(value, self.groups) for value in plain]
        return choose(plain, seen) or tuple(plain)

    def _rename(self, value: sympy.Expr, new: Mapping[Any, Any]) -> sympy.Expr:
        """An expression in generic symbols."""
        shared = (*self.shared, *self.declared.shared_noise)
        alike = {*map(sympy.Symbol, shared), *self.shared_inputs, *self.time}
        left = value.free_symbols - {*new, *alike}
        if left:
            spec, names = self.equations.spec, ", ".join(sorted(each.name for each in left))
            raise DerivationError(
                f"{spec.path}: the rate of one member depends on {names}, which is none of its "
                "neighbours; expected an energy that couples neighbours or pairs. Write the energy "
                "as sums over members.",
                found=names,
            )
        return value.xreplace(new)

    @cached_property
    def groups(self) -> list[list[sympy.Symbol]]:
        """Symbols of each component of the state: of member i, its neighbours and its partner."""
        groups = {each: [each] for each in self.states}
        for (each, _), seen in self.neighbours.items():
            if each in groups:
                groups[each].append(seen)
        for each, seen in self.partners.items():
            if each in groups:
                groups[each].append(seen)
        return list(groups.values())

    # -- rates --------------------------------------------------------------------------

    def rates_of(self, member: int) -> tuple[sympy.Expr, ...]:
        """The rates of a member in generic symbols, and in those of sums over its partners."""
        if self.declared.pairs:
            return tuple(self._rates_with_pairs(member))
        new, names = self.see_around(member), self.names_of(self.declared.variables, member)
        by_name = dict(zip(self.equations.variables, self.equations.rates, strict=True))
        return self.see((by_name[name] for name in names), new, self.written.rates(names))

    @cached_property
    def ends(self) -> dict[int, tuple[sympy.Expr, ...]]:
        """The rates of the members of an open chain that lack neighbours, or are pushed alone."""
        (first, last), count = self.declared.ends, self.members.count
        starts = {k: self.rates_of(k) for k in range(first)}
        return starts | {-k: self.rates_of(count - k) for k in range(last, 0, -1)}

    @property
    def is_closed(self) -> bool:
        """Whether the rate of a member at one end depends on members at the other end."""
        places = {symbol: shift for (_, shift), symbol in self.neighbours.items()}
        for end, rates in self.ends.items():
            shifts = [places.get(s, 0) for rate in rates for s in rate.free_symbols]
            if min([0, *shifts]) < -end <= 0 or max([0, *shifts]) >= -end > 0:
                return True
        return False

    # -- noise --------------------------------------------------------------------------

    def noise_of(self, member: int) -> tuple[sympy.Expr, ...]:
        """What increments of Wiener processes do to a member; nothing without noise."""
        fields = noise_fields(self.equations.setting)
        if not fields:
            return ()
        reach, state = self.declared.reach, self.equations.variables
        zero = self.equations.setting.field.is_zero
        rows = [state.index(name) for name in self.names_of(self.declared.variables, member)]
        moved = (
            sympy.Add(
                *(
                    self.write(each.field[row]) * sympy.Symbol(each.name)
                    for each in fields
                    if not zero(each.field[row])
                )
            )
            for row in rows
        )
        return self.see(moved, self.rename(member, reach, reach))

    @cached_property
    def noise_ends(self) -> dict[int, tuple[sympy.Expr, ...]]:
        """The same of the members of an open chain that lack neighbours."""
        if not self.equations.spec.noise:
            return {}
        count = self.members.count
        return {end: self.noise_of(end if end >= 0 else count + end) for end in self.ends}

    # -- attitudes ----------------------------------------------------------------------

    @cached_property
    def turning(self) -> list[Variable]:
        """The attitudes of the member in the middle."""
        names = {member_name(name, self.middle) for name in self.declared.variables}
        return [each for each in self.equations.spec.turning if each.name in names]

    @property
    def turned(self) -> tuple[sympy.Expr, ...]:
        """The state of a member with its attitudes moved back; empty without attitudes."""
        back, new = self.equations.projection, self.rename(self.middle, 0, 0)
        if back is None:
            return ()
        known = dict(zip(back.variables, back.rates, strict=True))
        written = {name: sympy.Symbol(name) for name in back.variables}
        for each in self.turning:
            symbols = [written[name] for name in each.components]
            written |= zip(each.components, step_back(each, symbols), strict=True)
        names = self.names_of(self.declared.variables, self.middle)
        return self.see((known[name] for name in names), new, (written[name] for name in names))

    @property
    def residuals(self) -> tuple[sympy.Expr, ...]:
        """What is zero where the attitudes of a member are rotations."""
        known = dict(turning_residuals(self.equations.setting))
        new = self.rename(self.middle, 0, 0)
        rows = (name for each in self.turning for name in turning_rows(self.equations.spec, each))
        return self.see((self.write(known[name]) for name in rows if known), new)

    # -- sums ---------------------------------------------------------------------------

    def singles_of(self, totals: Iterable[Total]) -> dict[tuple[sympy.Symbol, int], sympy.Symbol]:
        """Those that totals name."""
        named = {s for total in totals for s in total.formula.free_symbols}
        return {place: symbol for place, symbol in self.singles.items() if symbol in named}

    def value(self, node: tree.Node) -> tuple[Element, ...]:
        """The components of a tree of the window."""
        setting = self.equations.setting
        return entries(interpret(node, setting.values, setting.field))

    def write(self, element: Element) -> sympy.Expr:
        """An element as SymPy has it."""
        return self.equations.setting.field.to_sympy(self.equations.close(element))

    def sums_of(self, formula: Formula) -> Iterator[tuple[tree.Sum, tree.Node]]:
        """The sums of a formula, each with its term and the constant factor before it."""
        assert formula.sums is not None, formula.key
        for each, alone in split_sums(formula.sums):
            yield each, put_term(alone, each)

    @property
    def totals(self) -> Iterator[Total]:
        """The energy and the observables."""
        spec = self.equations.spec
        if self.energy is not None:
            yield from self._total("energy", (), self.energy)
        for each in spec.observables:
            yield from self._total(each.name, each.shape, each.formula)
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
        sums, rest = list[list[Sum]](), self._see_rest(formula)
        for number, (each, term) in enumerate(self.sums_of(formula), 1):
            sums.append([])
            for place, value in enumerate(self._terms(formula, each, term)):
                symbol = sympy.Symbol(f"{name}_sum{number}_{place + 1}")
                before, after = reach(each.term)
                sums[-1].append(
                    Sum(
                        symbol=symbol,
                        term=value,
                        over="members" if len(each.indices) == 1 else "pairs",
                        before=before,
                        after=after,
                    )
                )
        for n, component in enumerate(component_names(name, shape)):
            parts = tuple(each[n] for each in sums)
            values = [*(each.symbol for each in parts), *rest[n : n + 1]]
            yield Total(component, sympy.Add(*values), parts)

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
        new = dict[sympy.Symbol, sympy.Symbol]()
        names = (*self.declared.variables, *self.declared.indexed)
        for number in sorted(find_alone(formula.sums, self.members)):
            own = map(sympy.Symbol, self.names_of(names, number % self.members.count))
            seen = (self.singles[each, number] for each in (*self.states, *self.indexed))
            new |= zip(own, seen, strict=True)
        return self._see_terms(formula, placed, new)

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
            values = self.transform(formula, self.value(self._place_pair(each, term)))
            return [self._see_pair(value) for value in values]
        before, after = reach(each.term)
        at = 0 if self.members.periodic else before
        placed = place_at(term, {each.indices[0]: at}, self.members)
        return self._see_terms(formula, placed, self.rename(at, before, after))

    # -- pairs --------------------------------------------------------------------------

    def _place_pair(
        self, each: tree.Sum, term: tree.Node, at: tuple[int, int] = (0, 1)
    ) -> tree.Node:
        """The term of two members."""
        return place_at(term, dict(zip(each.indices, at, strict=True)), self.members)

    def _see_pair(self, value: Element) -> sympy.Expr:
        """An element of the first two members in the symbols of a member and its partner."""
        new = dict(zip(map(sympy.Symbol, self.names_of(self.names, 0)), self.own, strict=True))
        others = [self.partners[each] for each in self.own]
        new |= zip(map(sympy.Symbol, self.names_of(self.names, 1)), others, strict=True)
        return self.see([self.write(value)], new)[0]

    def pair_energy(self, i: int, j: int) -> Element:
        """What the sums over pairs have of two members."""
        assert self.energy is not None, self.equations.spec.name
        values = list[Element]()
        for each, term in self.sums_of(self.energy):
            if len(each.indices) > 1:
                values += self.value(self._place_pair(each, term, (i, j)))
        return self.equations.setting.field.sum(self.transform(self.energy, values))

    def check_pairs(self) -> None:
        """The term of each sum over pairs in the energy is the same for both orders.

        Raises:
            DerivationError: One changes when its members change places.
        """
        spec, field, energy = self.equations.spec, self.equations.setting.field, self.energy
        assert energy is not None, spec.name
        for each, term in self.sums_of(energy):
            if len(each.indices) == 1:
                continue
            (value,), (turned,) = (
                self.value(self._place_pair(each, term, at)) for at in ((0, 1), (1, 0))
            )
            if not field.is_zero(value - turned):
                i, j = each.indices
                raise DerivationError(
                    f"{spec.path}: {energy.key}: the term of a pair changes when {i} and {j} "
                    "change places; expected a term that is the same for both orders. Write it as "
                    "half the sum of both.",
                    found=energy.in_one_line,
                )

    def _flow(self, energy: Element, member: int = 0) -> list[Element]:
        """The brackets of a member's state with a function."""
        tensor, field = self.equations.exact.poisson_tensor, self.equations.setting.field
        state, names = self.equations.variables, self.names_of(self.declared.variables, member)
        assert tensor is not None, self.equations.route
        slopes = field.gradient(energy, state)
        rows = [state.index(name) for name in names]
        return [
            field.sum(p * s for p, s in zip(tensor[row], slopes, strict=True) if p and s)
            for row in rows
        ]

    @cached_property
    def pair_sums(self) -> dict[sympy.Symbol, Sum]:
        """What the partners add to the rates of a member, by the components to which they add."""
        field, sums = self.equations.setting.field, dict[sympy.Symbol, Sum]()
        self.check_pairs()
        flow = self._flow(self.pair_energy(0, 1))
        for state, term in zip(self.states, flow, strict=True):
            if not field.is_zero(term):
                symbol = sympy.Symbol(f"{state.name}_pairs")
                sums[state] = Sum(symbol=symbol, term=self._see_pair(term), over="partners")
        return sums

    def _rates_with_pairs(self, member: int) -> Iterator[sympy.Expr]:
        """The rates of a member with sums over its partners.

        What is left without the pairs is the member's own share: what members and neighbours do,
        and forces.
        """
        equations, new = self.equations, self.see_around(member)
        known = dict(zip(equations.variables, equations.exact.rates, strict=True))
        names = self.names_of(self.declared.variables, member)
        own = [equations.close(known[name]) for name in names]
        for other in range(self.members.count):
            if other != member:
                flow = self._flow(self.pair_energy(*sorted((member, other))), member)
                own = [a - b for a, b in zip(own, flow, strict=True)]
        for state, total in zip(self.states, self.see(map(self.write, own), new), strict=True):
            pairs = self.pair_sums.get(state)
            yield total if pairs is None else total + pairs.symbol
