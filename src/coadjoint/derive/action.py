r"""The bracket and the gradient of the energy of a generic member, for discrete gradients.

The energy is a sum of terms of members next to each other, and of pairs. Member i stands in the
terms of members i - r, so that its derivative is

.. math:: \frac{\partial H}{\partial x_i} = \sum_r
    \frac{\partial h(x_{i-r}, x_{i-r+1}, \ldots)}{\partial x_i} + \sum_{j \ne i}
    \frac{\partial h_2(x_i, x_j)}{\partial x_i},

the first sum over the terms that there are: of members at the ends of an open chain some are
missing. A quadratic energy is left out: its gradient at the middle of a chord is a discrete
gradient, so that the midpoint keeps it.
Comes in: a `Family`, and the bracket applied to a vector. Goes out: the same `Family` with an
`Action`, where there is one. Read next: `coadjoint.lower.families`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType

import sympy

from coadjoint.families import Action, Family, Sum, Total

#: The tensor times a vector, whose components are given by those of member i and the neighbour.
Bracket = Callable[[Callable[[str, int], sympy.Symbol]], Sequence[sympy.Expr]]


def add_action(
    family: Family, bracket: Bracket, ends: Mapping[int, Bracket] = MappingProxyType({})
) -> Family:
    """A family with the bracket and the gradient of its energy, if this is not quadratic.

    Args:
        family: Without.
        bracket: The tensor times a vector.
        ends: That of members at the ends of an open chain, where it is another one.
    """
    energies = [each for each in family.totals if each.name == "energy"]
    if not energies or family.noise or family.solved or family.matrices is not None:
        return family
    terms = _Terms(family, energies[0])
    if any(tree.has(sympy.Abs, sympy.sign) for tree in terms.trees):
        return family  # steps end at kinks, and those of discrete gradients do not
    if not terms.covers or terms.is_quadratic:
        return family
    known, vector = {s.name: s for s in family.states}, dict[sympy.Symbol, sympy.Symbol]()

    def find(component: str, shift: int) -> sympy.Symbol:
        symbol = terms.find(known[component], shift)
        return vector.setdefault(symbol, sympy.Symbol(f"h {symbol}"))

    action = Action(
        gradient=terms.gradient,
        gradient_ends=terms.ends,
        pair_sums=tuple(terms.pair_sums.values()),
        bracket=tuple(bracket(find)),
        bracket_ends={end: tuple(own(find)) for end, own in ends.items()},
        vector=vector,
    )
    rows = (*action.gradient, *(x for own in action.gradient_ends.values() for x in own))
    named = {s for tree in rows for s in tree.free_symbols} | vector.keys()
    new = {place: s for place, s in terms.neighbours.items() if s in named}
    return replace(family, action=action, neighbours={**family.neighbours, **new})


class _Terms:
    """Derivatives of the terms of an energy.

    Args:
        family: Whose energy it is.
        energy: A function of sums, which is linear in them.

    Attributes:
        neighbours: As of the family, with further ones.
    """

    def __init__(self, family: Family, energy: Total) -> None:
        self.family, self.energy = family, energy
        self.neighbours = dict(family.neighbours)
        self._places = {s: place for place, s in family.neighbours.items()}
        self._places |= {s: (s, 0) for s in family.own}

    @property
    def trees(self) -> tuple[sympy.Expr, ...]:
        """Terms, and what stands outside of sums."""
        return (self.energy.formula, *(each.term for each in self.energy.sums))

    def find(self, component: sympy.Symbol, shift: int) -> sympy.Symbol:
        """The symbol of a component of a neighbour."""
        if not shift:
            return component
        if (component, shift) not in self.neighbours:
            symbol = sympy.Symbol(f"{component.name}[{shift:+d}]")
            self.neighbours[component, shift] = symbol
            self._places[symbol] = component, shift
        return self.neighbours[component, shift]

    def _shift(self, tree: sympy.Expr, by: int) -> sympy.Expr:
        """What an expression of a member is, seen from the one so many places before it."""
        named = ((s, self._places[s]) for s in tree.free_symbols if s in self._places)
        return tree.xreplace({s: self.find(c, shift + by) for s, (c, shift) in named})

    def _weigh(self, own: Sum) -> sympy.Expr:
        """By what the energy multiplies a sum."""
        return sympy.diff(self.energy.formula, own.symbol)

    def _list_members(self, row: sympy.Symbol, end: int | None) -> Iterable[sympy.Expr]:
        """What the terms of sums over members give to the derivative by a component.

        Args:
            row: A component of member i.
            end: The number of a member at an end, which lacks some terms; None of all others.
        """
        for own in self.energy.sums:
            for symbol in sorted(own.term.free_symbols, key=str) * (own.over == "members"):
                component, shift = self._places.get(symbol, (None, 0))
                if component == row and self._has_term(own, shift, end):
                    slope = sympy.diff(own.term, symbol)
                    yield self._weigh(own) * self._shift(slope, -shift)

    def _has_term(self, own: Sum, shift: int, end: int | None) -> bool:
        """Whether there is a term so many places before a member."""
        if end is None or self.family.index.periodic:
            return True
        at = end - shift
        return at >= own.before if end >= 0 else at < -own.after

    @property
    def covers(self) -> bool:
        """Whether all members that lack a term, or stand alone, are among those at the ends."""
        lacking = {
            end
            for own in self.energy.sums
            for symbol in own.term.free_symbols & self._places.keys()
            for end in range(-self.family.small - 1, self.family.small + 1)
            if not self._has_term(own, self._places[symbol][1], end)
        }
        named = self.energy.formula.free_symbols
        alone = {end for (_, end), symbol in self.family.singles.items() if symbol in named}
        return lacking | alone <= self.family.ends.keys()

    @cached_property
    def pair_sums(self) -> dict[sympy.Symbol, Sum]:
        """What the partners of a member give, by its components."""
        pairs = [own for own in self.energy.sums if own.over == "pairs"]
        found = dict[sympy.Symbol, Sum]()
        for row in self.family.states:
            term = sympy.Add(*(self._weigh(own) * sympy.diff(own.term, row) for own in pairs))
            if term != 0:
                symbol = sympy.Symbol(f"{row.name}_slopes")
                found[row] = Sum(symbol=symbol, term=term, over="partners")
        return found

    def _differentiate(self, end: int | None) -> tuple[sympy.Expr, ...]:
        """The derivatives by the components of a member."""
        found = list[sympy.Expr]()
        for row in self.family.states:
            parts = [*self._list_members(row, end), *self._list_alone(row, end)]
            parts += [each.symbol for own, each in self.pair_sums.items() if own == row]
            found.append(sympy.Add(*map(sympy.factor_terms, parts)))
        return tuple(found)

    def _list_alone(self, row: sympy.Symbol, end: int | None) -> Iterable[sympy.Expr]:
        """What the energy has of a member at an end alone, outside of its sums.

        A member at the other end is the one before the first, or after the last.
        """
        places = {s: place for place, s in self.family.singles.items()}
        if end is not None and (row, end) in self.family.singles:
            slope = sympy.diff(self.energy.formula, self.family.singles[row, end])
            named = ((s, places[s]) for s in slope.free_symbols if s in places)
            yield slope.xreplace({s: self.find(c, number - end) for s, (c, number) in named})

    @cached_property
    def gradient(self) -> tuple[sympy.Expr, ...]:
        """Of a member that has all its neighbours."""
        return self._differentiate(None)

    @cached_property
    def ends(self) -> dict[int, tuple[sympy.Expr, ...]]:
        """Of those at the ends."""
        return {end: self._differentiate(end) for end in self.family.ends}

    @property
    def is_quadratic(self) -> bool:
        """Whether all derivatives are seen to be of degree 1 at the most in the state."""
        rows = [*self.gradient, *(x for own in self.ends.values() for x in own)]
        rows += [each.term for each in self.pair_sums.values()]
        states = {*self.family.states, *self.family.partners.values()}
        states |= {s for (c, _), s in self.neighbours.items() if c in states}
        return all(_is_linear(row, states) for row in rows)


def _is_linear(tree: sympy.Expr, state: set[sympy.Symbol]) -> bool:
    """Whether an expression is seen to be a polynomial of degree 1 at the most."""
    named = sorted(tree.free_symbols & state, key=str)
    if not named:
        return True
    return bool(tree.is_polynomial(*named)) and sympy.Poly(tree, *named).total_degree() <= 1
