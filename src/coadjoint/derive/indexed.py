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

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import sympy

from coadjoint.derive.action import Bracket, add_action
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.mechanics.turning import step_back, turning_residuals
from coadjoint.derive.setting import once
from coadjoint.derive.totals import TotalsReader
from coadjoint.derive.truncated import derive_truncated
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.families import Family, Sum
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Variable
from coadjoint.spec.spatial import turning_rows


@once
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
    if declared.truncation:
        return derive_truncated(equations)
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
    family = Family(
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
        count=reader.count,
    )
    return family if reader.brackets is None else add_action(family, *reader.brackets)


@dataclass(frozen=True)
class _Reader(TotalsReader):
    """The reading of one window: rates of its members."""

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

    # -- the bracket --------------------------------------------------------------------

    def tensor_of(self, member: int) -> list[dict[str, Element]]:
        """Rows of the bracket of a member, by the components of all members."""
        equations, names = self.equations, self.names_of(self.declared.variables, member)
        tensor, state = equations.exact.poisson_tensor, equations.variables
        assert tensor is not None, equations.route
        rows = (map(equations.close, tensor[state.index(name)]) for name in names)
        zero = equations.setting.field.is_zero
        return [{c: x for c, x in zip(state, row, strict=True) if not zero(x)} for row in rows]

    def has_bracket(self, names: Iterable[str]) -> bool:
        """Whether there is a bracket, and that of a member is one of some components alone."""
        equations = self.equations
        if equations.exact.poisson_tensor is None or equations.distribution is not None:
            return False
        named = {*names, *self.shared, *map(str, self.count)}
        own, reach = named, equations.setting.field.reach
        rows = self.tensor_of(self.middle)
        return all({c} | reach(x) <= own for row in rows for c, x in row.items())

    @property
    def brackets(self) -> tuple[Bracket, dict[int, Bracket]] | None:
        """The bracket of a member, and of those at the ends, where neighbours have one with it."""
        if not self.has_bracket(symbol.name for symbol in self.see_around(self.middle)):
            return None
        is_alone = self.has_bracket(self.names_of(self.names, self.middle))
        ends, count = () if is_alone else self.ends, self.members.count
        return self.multiply(self.middle), {end: self.multiply(end % count) for end in ends}

    def multiply(self, member: int) -> Bracket:
        """The bracket of a member times a vector, whose components are given by their names."""
        new = self.see_around(member)
        places = {symbol: (each.name, shift) for (each, shift), symbol in self.neighbours.items()}
        places |= {symbol: (symbol.name, 0) for symbol in self.states}
        rows = [
            [(self._rename(self.write(x), new), places[new[sympy.Symbol(c)]]) for c, x in own]
            for own in map(dict.items, self.tensor_of(member))
        ]
        return lambda find: [sympy.Add(*(x * find(*place) for x, place in row)) for row in rows]

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

    # -- pairs --------------------------------------------------------------------------

    def pair_energy(self, i: int, j: int) -> Element:
        """What the sums over pairs have of two members."""
        assert self.energy is not None, self.equations.spec.name
        values = list[Element]()
        for each, term in self.sums_of(self.energy):
            if len(each.indices) > 1:
                values += self.value(self.place_pair(each, term, (i, j)))
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
                self.value(self.place_pair(each, term, at)) for at in ((0, 1), (1, 0))
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
                sums[state] = Sum(symbol=symbol, term=self.see_pair(term), over="partners")
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
