"""The flows of the generic member, read off from a few members.

The energy of equal members is taken apart by components: a part has all the terms that depend on
the same ones, of whatever members. So the parts are those of every number of members. The flow of a
part moves a member by the terms that contain it, as the energy does: the flow of one member of a
few, with names for its neighbours in the place of theirs, is that of all
(`coadjoint.derive.indexed`).

Comes in: the Equations of windows, and their Family. Goes out: the Family with `PartFlow` records,
as far as there are flows, and the windows in the same parts.
Read next: `coadjoint.derive.splittings`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import sympy

from coadjoint.derive.equations import Equations
from coadjoint.derive.setting import STEP
from coadjoint.derive.splittings import Kinds, NoSplitting, Part, Splitting, find_splitting
from coadjoint.derive.window import Window
from coadjoint.exact import Element
from coadjoint.families import Family, PartFlow, Rises
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Windows

#: What rates with corners or jumps have.
_KINKS = (sympy.sign, sympy.Abs, sympy.Min, sympy.Max)


def split_family(
    equations: Equations, family: Family, windows: Sequence[Equations]
) -> tuple[Family, tuple[Splitting, ...]]:
    """The family with its flows, and windows in the same parts; without any where there are none.

    Args:
        equations: Of the first route, for the few members of a spec with an index.
        family: The equations of the generic member.
        windows: Equations of small numbers of members, with which flows are compared.
    """
    declared = equations.spec.family
    assert declared is not None, equations.spec.name
    trees = [tree for rates in (family.rates, *family.ends.values()) for tree in rates]
    if family.pair_sums or any(tree.has(*_KINKS) for tree in trees):
        return family, ()
    found = find_splitting(equations, _list_kinds(equations, declared))
    if isinstance(found, NoSplitting) or _are_shifts(found):
        return family, ()
    reader, parts = _Reader(found.equations), [part.kinds for part in found.parts]
    flows = tuple(map(reader.read, found.parts))
    named = {s for each in flows for own in (each.member, *each.ends.values()) for s in _name(own)}
    neighbours = {
        place: s
        for place, s in reader.neighbours.items()
        if s in named or place in family.neighbours
    }
    step = (sympy.Symbol(STEP),)
    whole = replace(family, flows=flows, neighbours=neighbours, step=step)
    return whole, tuple(split_window(each, declared, parts) for each in windows)


def split_window(window: Equations, declared: Windows, parts: Sequence[Kinds]) -> Splitting:
    """A window in the same parts."""
    found = find_splitting(window, _list_kinds(window, declared), parts)
    assert isinstance(found, Splitting), found
    return found


def _are_shifts(splitting: Splitting) -> bool:
    """Whether parts are T of momenta and V of positions with the canonical bracket.

    Their flows shift one of the two by its rates, which the other decides.
    """
    equations, field = splitting.equations, splitting.equations.setting.field
    rows = [[field.as_number(x) for x in row if x] for row in equations.exact.poisson_tensor or ()]
    roles = {c: each.role for each in equations.spec.state for c in each.components}
    read = [field.reach(part.energy) & roles.keys() for part in splitting.parts]
    is_canonical = all(len(row) == 1 and row[0] in (1, -1) for row in rows)
    return is_canonical and all(len({roles[name] for name in names}) == 1 for names in read)


def _name(rises: Rises) -> Iterator[sympy.Symbol]:
    """Symbols of what is added."""
    for tree in (*rises.trees, *(tree for _, tree in rises.definitions)):
        yield from tree.free_symbols


def _list_kinds(equations: Equations, declared: Windows) -> dict[str, str]:
    """The components of member 0 by those of every member, which are of one kind."""
    state = equations.spec.state
    count = len(state) // len(declared.variables)
    known = {each.name: each.components for each in equations.spec.variables}
    return {
        component: own
        for name in declared.variables
        for k in range(count)
        for component, own in zip(
            known[member_name(name, k)], known[member_name(name, 0)], strict=True
        )
    }


@dataclass(frozen=True)
class _Reader(Window):
    """The reading of the flows of one window."""

    def read(self, part: Part) -> PartFlow:
        """The flow of a part in generic symbols."""
        (first, last), count = self.declared.ends, self.members.count
        ends = [*range(first), *range(-last, 0)]
        return PartFlow(
            member=self._rises_of(part, self.middle),
            ends={end: self._rises_of(part, end % count) for end in ends},
        )

    def _rises_of(self, part: Part, member: int) -> Rises:
        """What the flow of a part adds to a member."""
        field, new = self.equations.setting.field, dict(self.see_around(member))
        there = dict(zip(self.equations.setting.state, part.flow.values, strict=True))
        named = dict(part.flow.define(field))
        new |= {symbol: symbol for symbol in map(sympy.Symbol, (*named, STEP))}
        names = self.names_of(self.declared.variables, member)
        rises = {name: there[name] - field[name] for name in names}
        needed = frozenset[str]().union(*map(field.reach, rises.values()))
        for name, value in reversed(named.items()):
            needed |= field.reach(value) if name in needed else frozenset()
        return Rises(
            definitions=tuple(
                (sympy.Symbol(name), self._see_one(value, new))
                for name, value in named.items()
                if name in needed
            ),
            trees=tuple(
                self._see_one(rise, new, partial(self._write_alone, part, name))
                for name, rise in rises.items()
            ),
        )

    def _write_alone(self, part: Part, name: str) -> list[sympy.Expr]:
        """The rate of a component as the spec writes it where all is 0 that a part has not.

        That is its rate by the part alone if energies of the others are of degree 2 in these.
        """
        own = self.equations.setting.field.reach(part.energy)
        zeros = {sympy.Symbol(x): 0 for x in self.equations.setting.state if x not in own}
        return [rate.xreplace(zeros) for rate in self.written.rates([name])]

    def _see_one(
        self,
        value: Element,
        new: dict[sympy.Symbol, sympy.Symbol],
        written: Callable[[], Sequence[sympy.Expr]] = tuple,
    ) -> sympy.Expr:
        """An element in generic symbols; of what the time multiplies, the time comes first.

        Args:
            value: The element.
            new: The generic symbols.
            written: What may be a shorter form of what the time multiplies.
        """
        field = self.equations.setting.field
        if STEP not in field.reach(value):
            (tree,) = self.see([self.write(value)], new)
            alone = len(tree.free_symbols) == 1 and tree.is_polynomial()
            return sympy.horner(tree) if alone else tree  # the polynomial of a tangent
        (slope,) = self.see([self.write(value / field[STEP])], new, written())
        return sympy.Symbol(STEP) * slope
