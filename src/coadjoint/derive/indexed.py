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

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.mechanics.turning import step_back, turning_residuals
from coadjoint.derive.window_names import Window
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.families import Family, Sum, Total
from coadjoint.spec import Formula
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import member_name, place_at, reach
from coadjoint.spec.core.totals import put_term, split_sums
from coadjoint.spec.model import Variable
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
    small = max(1 if declared.index.periodic else 2 * declared.reach, 2 if declared.pairs else 1)
    pairs = tuple(reader.pair_sums.values()) if declared.pairs else ()
    rates = reader.rates_of(reader.middle)
    totals = tuple(reader.totals)
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
    )


@dataclass(frozen=True)
class _Reader(Window):
    """The reading of one window."""

    # -- rates --------------------------------------------------------------------------

    def rates_of(self, member: int) -> tuple[sympy.Expr, ...]:
        """The rates of a member in generic symbols, and in those of sums over its partners."""
        if self.declared.pairs:
            return tuple(self._rates_with_pairs(member))
        reach, names = self.declared.reach, self.names_of(self.declared.variables, member)
        new = self.rename(member, reach, reach)
        by_name = dict(zip(self.equations.variables, self.equations.rates, strict=True))
        return self.see((by_name[name] for name in names), new, self.written.rates(names))

    @cached_property
    def ends(self) -> dict[int, tuple[sympy.Expr, ...]]:
        """The rates of the members of an open chain that lack neighbours."""
        if self.declared.index.periodic:
            return {}
        reach, count = self.declared.reach, self.members.count
        starts = {k: self.rates_of(k) for k in range(reach)}
        return starts | {-k: self.rates_of(count - k) for k in range(reach, 0, -1)}

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
        if spec.hamiltonian is not None:
            yield from self._total("energy", (), spec.hamiltonian)
        for each in spec.observables:
            yield from self._total(each.name, each.shape, each.formula)

    def _total(self, name: str, shape: tuple[int, ...], formula: Formula) -> Iterator[Total]:
        """The components of a total."""
        sums = list[list[Sum]]()
        for number, (each, term) in enumerate(self.sums_of(formula), 1):
            sums.append([])
            for place, value in enumerate(self._terms(each, term)):
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
        for component, parts in zip(
            component_names(name, shape), zip(*sums, strict=True), strict=True
        ):
            yield Total(component, sympy.Add(*(each.symbol for each in parts)), tuple(parts))

    def _terms(self, each: tree.Sum, term: tree.Node) -> Sequence[sympy.Expr]:
        """The components of the term of a sum, in generic symbols."""
        if len(each.indices) > 1:
            return [self._see_pair(value) for value in self.value(self._place_pair(each, term))]
        before, after = reach(each.term)
        at = 0 if self.members.periodic else before
        placed = place_at(term, {each.indices[0]: at}, self.members)
        new = self.rename(at, before, after)
        written = entries(self.written.value(placed))
        return self.see(map(self.write, self.value(placed)), new, written)

    # -- pairs --------------------------------------------------------------------------

    def _place_pair(self, each: tree.Sum, term: tree.Node, *, turned: bool = False) -> tree.Node:
        """The term of the first two members, or of the same in the other order."""
        at = (1, 0) if turned else (0, 1)
        return place_at(term, dict(zip(each.indices, at, strict=True)), self.members)

    def _see_pair(self, value: Element) -> sympy.Expr:
        """An element of the first two members in the symbols of a member and its partner."""
        new = dict(zip(map(sympy.Symbol, self.names_of(self.names, 0)), self.own, strict=True))
        others = [self.partners[each] for each in self.own]
        new |= zip(map(sympy.Symbol, self.names_of(self.names, 1)), others, strict=True)
        return self.see([self.write(value)], new)[0]

    @cached_property
    def pair_energies(self) -> list[Element]:
        """The term of the first two members, of each sum over pairs in the energy.

        Raises:
            DerivationError: One changes when its members change places.
        """
        spec, field = self.equations.spec, self.equations.setting.field
        assert spec.hamiltonian is not None, spec.name
        terms = list[Element]()
        for each, term in self.sums_of(spec.hamiltonian):
            if len(each.indices) == 1:
                continue
            (value,), (turned,) = (
                self.value(self._place_pair(each, term, turned=t)) for t in (False, True)
            )
            if not field.is_zero(value - turned):
                i, j = each.indices
                raise DerivationError(
                    f"{spec.path}: hamiltonian.h: the term of a pair changes when {i} and {j} "
                    "change places; expected a term that is the same for both orders. Write it as "
                    "half the sum of both.",
                    found=spec.hamiltonian.in_one_line,
                )
            terms.append(value)
        return terms

    def _flow(self, energy: Element, member: int = 0) -> list[Element]:
        """The brackets of a member's state with a function."""
        tensor, field = self.equations.exact.poisson_tensor, self.equations.setting.field
        assert tensor is not None, self.equations.route
        state = self.equations.variables
        slopes = field.gradient(energy, state)
        rows = [state.index(name) for name in self.names_of(self.declared.variables, member)]
        return [
            field.sum(p * s for p, s in zip(tensor[row], slopes, strict=True) if p and s)
            for row in rows
        ]

    @cached_property
    def pair_sums(self) -> dict[sympy.Symbol, Sum]:
        """What the partners add to the rates of a member, by the components to which they add."""
        field, sums = self.equations.setting.field, dict[sympy.Symbol, Sum]()
        flows = [self._flow(energy) for energy in self.pair_energies]
        for n, state in enumerate(self.states):
            term = field.sum(flow[n] for flow in flows)
            if not field.is_zero(term):
                symbol = sympy.Symbol(f"{state.name}_pairs")
                sums[state] = Sum(symbol=symbol, term=self._see_pair(term), over="partners")
        return sums

    @cached_property
    def own_energy(self) -> Element:
        """What the sums over members give to the energy of the window."""
        spec, values = self.equations.spec, list[Element]()
        assert spec.hamiltonian is not None, spec.name
        for each, term in self.sums_of(spec.hamiltonian):
            if len(each.indices) == 1:
                before, after = (0, 0) if self.members.periodic else reach(each.term)
                for at in range(before, self.members.count - after):
                    values += self.value(place_at(term, {each.indices[0]: at}, self.members))
        return self.equations.setting.field.sum(values)

    def _forces(self, member: int) -> list[Element]:
        """What forces add to the rates of a member."""
        known = dict(zip(self.equations.variables, self.equations.exact.forces, strict=False))
        zero = self.equations.setting.field.zero
        return [known.get(name, zero) for name in self.names_of(self.declared.variables, member)]

    def _rates_with_pairs(self, member: int) -> Iterator[sympy.Expr]:
        """The rates of a member with sums over its partners.

        What the energy of members and neighbours gives is the member's own share, and so are
        forces.
        """
        width = self.declared.reach
        new = self.rename(member, width, width)
        flow, forces = self._flow(self.own_energy, member), self._forces(member)
        own = (self.write(a + b) for a, b in zip(flow, forces, strict=True))
        for state, total in zip(self.states, self.see(own, new), strict=True):
            pairs = self.pair_sums.get(state)
            yield total if pairs is None else total + pairs.symbol
