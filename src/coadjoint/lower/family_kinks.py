"""Lowering, kinks of families: rates of a member with given signs, and what these are the signs of.

Comes in: a Family. Goes out: the same with the sign of each argument that moves as a further symbol
of a member, and these arguments. An argument such as ``q[i+1] - q[i]`` belongs to its first member,
so that both members that it pushes read one sign, as they read other things of a neighbour.
Read next: `coadjoint.lower.families`; for other systems `coadjoint.lower.kinks`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import sympy

from coadjoint.families import Family, Symbol, Tree
from coadjoint.lower.kinks import SIDE

#: What a kink is where a member has none: its sign never changes.
NONE: Final = sympy.Integer(1)


@dataclass(frozen=True)
class HeldFamily:
    """A Family whose rates are those of given signs.

    Attributes:
        family: It, with these signs as ``sides``.
        kinks: What they are the signs of, for member i.
        ends: The same for members at the ends of an open chain, as in `Family.ends`.
    """

    family: Family
    kinks: tuple[Tree, ...]
    ends: Mapping[int, tuple[Tree, ...]]


@dataclass(frozen=True)
class _Side:
    """A sign in the rates of a member.

    Attributes:
        argument: What it is the sign of, for the first member that this names.
        shift: How far that one is behind the member.
        sign: Minus 1 if the sign is that of minus the argument.
    """

    argument: Tree
    shift: int
    sign: int


def hold_family(family: Family) -> HeldFamily | None:
    """The rates with given signs; None where no argument of a sign moves, and with noise.

    Noise crosses a kink at any scale of time.
    """
    if family.noise:
        return None
    return _Holding(family).hold()


def name_kinks(family: Family) -> dict[int | None, tuple[str, ...]]:
    """What is 0 at the kinks of member i, as text, and of those at the ends by their places."""
    held, i = hold_family(family), family.index.name
    if held is None:
        return {}
    names = {each: f"{each.name}[{i}]" for each in family.own}
    for (each, shift), symbol in held.family.neighbours.items():
        names[symbol] = f"{each.name}[{i}{shift:+d}]"
    for (each, number), symbol in family.singles.items():
        names[symbol] = f"{each.name}[{number if number >= 0 else f'N{number}'}]"
    places = {None: held.kinks} | dict(held.ends)
    return {place: tuple(_write(tree, names) for tree in trees) for place, trees in places.items()}


def name_pair_kinks(family: Family) -> tuple[str, ...]:
    """What is 0 at the kinks of the terms of pairs, as text: these signs are not given."""
    i, terms = family.index.name, [each.term for each in family.pair_sums]
    names = {each: f"{each.name}[{i}]" for each in family.own}
    names |= {other: f"{own.name}[{other_index(i)}]" for own, other in family.partners.items()}
    found = _Holding(family).list_signs(terms)
    return tuple(dict.fromkeys(_write(side.argument, names) for side in found.values()))


def other_index(name: str) -> str:
    """The name of the other index of a sum over pairs."""
    return "j" if name != "j" else "k"


def _write(tree: Tree, names: Mapping[Symbol, str]) -> str:
    """A tree in the names of members."""
    shown = {symbol: sympy.Symbol(name) for symbol, name in names.items()}
    return str(tree.xreplace(shown)).replace("**", "^")


class _Holding:
    """The search for the signs of one family."""

    def __init__(self, family: Family) -> None:
        self.family = family
        sums = [each.symbol for each in family.pair_sums]
        inputs = (*family.shared_inputs, *family.indexed_inputs)
        moving = {*family.states, *inputs, *family.time, *sums}
        near = {s for (each, _), s in family.neighbours.items() if each in moving}
        single = {s for (each, _), s in family.singles.items() if each in moving}
        others = {other for each, other in family.partners.items() if each in moving}
        self._moving = moving | near | single | others
        self._places = {each: (each, 0) for each in family.own}
        self._places |= {symbol: key for key, symbol in family.neighbours.items()}
        self._neighbours = dict(family.neighbours)
        self._sides = dict[Tree, Symbol]()

    def hold(self) -> HeldFamily | None:
        """The rates with given signs."""
        family = self.family
        signs: dict[int | None, dict[Tree, _Side]] = {None: self.list_signs(family.rates)}
        for end, rates in family.ends.items():
            signs[end] = self.list_signs(rates)
        for found in signs.values():
            for side in found.values():
                name = f"{SIDE}{len(self._sides) + 1}"
                self._sides.setdefault(side.argument, sympy.Symbol(name))
        if not self._sides:
            return None
        own = replace(
            family,
            rates=self._replace(family.rates, signs[None]),
            ends={each: self._replace(rates, signs[each]) for each, rates in family.ends.items()},
            neighbours=self._neighbours,
            sides=tuple(self._sides.values()),
        )
        bases = {place: _list_bases(found) for place, found in signs.items()}
        before = sum(place >= 0 for place in family.ends)
        used = _Used(bases, before, len(family.ends) - before)
        kinks = tuple(used.choose(each, None) for each in self._sides)
        ends = {
            place: rows
            for place in used.list_places()
            if (rows := tuple(used.choose(each, place) for each in self._sides)) != kinks
        }
        # members in front of one that differs are told apart, too
        firsts = range(max((place + 1 for place in ends if place >= 0), default=0))
        lasts = range(min((place for place in ends if place < 0), default=0), 0)
        ends = {place: ends.get(place, kinks) for place in (*firsts, *reversed(lasts))}
        return HeldFamily(own, kinks, ends)

    def list_signs(self, trees: tuple[Tree, ...] | list[Tree]) -> dict[Tree, _Side]:
        """The signs and absolute values in trees whose argument moves."""
        found = dict[Tree, _Side]()
        for tree in trees:
            atoms = tree.atoms(sympy.sign, sympy.Abs)
            for each in sorted(atoms, key=sympy.default_sort_key):
                if each.args[0].free_symbols & self._moving:
                    found[each] = self._place(each.args[0])
        return found

    def _place(self, argument: Tree) -> _Side:
        """An argument, for the first member that it names, and with the sign that is kept."""
        named = [self._places[each] for each in argument.free_symbols if each in self._places]
        shift = min((shift for _, shift in named), default=0)
        moved = argument.xreplace(
            {
                symbol: self._find(each, own - shift)
                for symbol, (each, own) in self._places.items()
                if symbol in argument.free_symbols
            }
        )
        if moved.could_extract_minus_sign():
            return _Side(-moved, shift, -1)
        return _Side(moved, shift, 1)

    def _find(self, component: Symbol, shift: int) -> Symbol:
        """The symbol of a component of a neighbour."""
        if not shift:
            return component
        key = component, shift
        return self._neighbours.setdefault(key, sympy.Symbol(f"{component}[{shift:+d}]"))

    def _replace(self, rates: tuple[Tree, ...], signs: Mapping[Tree, _Side]) -> tuple[Tree, ...]:
        """Rates with given signs."""
        given = dict[Tree, Tree]()
        for sign, side in signs.items():
            own = side.sign * self._find(self._sides[side.argument], side.shift)
            given[sign] = own * sign.args[0] if isinstance(sign, sympy.Abs) else own
        return tuple(rate.xreplace(given) for rate in rates)


def _list_bases(signs: Mapping[Tree, _Side]) -> dict[Tree, set[int]]:
    """How far the members are behind a member whose signs it reads, by what these are of."""
    found = dict[Tree, set[int]]()
    for side in signs.values():
        found.setdefault(side.argument, set()).add(side.shift)
    return found


@dataclass(frozen=True)
class _Used:
    """Which signs of which members are read.

    Attributes:
        bases: By the place of a member, or None for member i, and by argument: how far the members
            are behind it whose signs it reads.
        before: How many members at the beginning have rates of their own.
        after: How many at the end.
    """

    bases: Mapping[int | None, Mapping[Tree, set[int]]]
    before: int
    after: int

    def choose(self, argument: Tree, place: int | None) -> Tree:
        """An argument where its sign is read, else `NONE`."""
        own = self.bases[None].get(argument, set())
        if place is None:
            return argument if own else NONE
        ends = {
            end + shift
            for end, found in self.bases.items()
            if end is not None and (end >= 0) == (place >= 0)
            for shift in found.get(argument, ())
        }
        if place >= 0:
            among = any(place >= self.before + shift for shift in own)
        else:
            among = any(place < shift - self.after for shift in own)
        return argument if among or place in ends else NONE

    def list_places(self) -> Iterator[int]:
        """The places near both ends at which it may be another one than of member i."""
        if not (self.before or self.after):
            return
        shifts = [s for found in self.bases.values() for own in found.values() for s in own]
        reach = max(map(abs, shifts), default=0)
        yield from range(self.before + reach)
        yield from range(-1, -self.after - reach - 1, -1)
