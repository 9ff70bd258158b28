"""A few members that are written out, and the names of the generic member for what they have.

Comes in: the Equations of a window. Goes out: its members, and the symbols of member i, of those
next to it, of a partner and of members at the ends, by the symbols of the window.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from coadjoint.derive.differences import tidy
from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.written import Written, choose
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.spec import Formula
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import Members, member_name
from coadjoint.spec.core.totals import put_term, split_sums
from coadjoint.spec.model import Windows


@dataclass(frozen=True)
class Window:
    """A system of a few members.

    Attributes:
        equations: Its Equations.
    """

    equations: Equations

    @cached_property
    def declared(self) -> Windows:
        """What is known of the other members."""
        family = self.equations.spec.family
        assert family is not None, self.equations.spec.name
        return family

    @cached_property
    def members(self) -> Members:
        """The members that are written out."""
        declared = self.declared
        spec = self.equations.spec
        count = len(spec.state) // len(declared.variables)
        moving = (each.name.rpartition("_")[0] for each in spec.variables)  # velocities among them
        return Members(
            index=declared.index.name,
            count=count,
            periodic=declared.index.periodic,
            names=frozenset((*moving, *declared.indexed, *declared.indexed_inputs)),
            first=declared.index.first,
            number=declared.index.count,
            from_zero=True,
            keeps_number=declared.index.is_value,
        )

    @property
    def count(self) -> tuple[sympy.Symbol, ...]:
        """The symbol of N, if formulas name it."""
        index = self.declared.index
        return (sympy.Symbol(index.count),) if index.is_value else ()

    @cached_property
    def shared(self) -> tuple[str, ...]:
        """Components of the parameters that all members share."""
        known = {each.name: each for each in self.equations.spec.parameters}
        return tuple(c for name in self.declared.shared for c in known[name].components)

    @property
    def time(self) -> tuple[sympy.Symbol, ...]:
        """The symbol of the time, if the spec declares it."""
        time = self.equations.spec.time
        return () if time is None else (sympy.Symbol(time.name),)

    @cached_property
    def shared_inputs(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the inputs that all members share."""
        names = self.declared.shared_inputs
        return tuple(sympy.Symbol(c) for name in names for c in self.known[name].components)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Generic names of all that a member has."""
        declared = self.declared
        return (*declared.variables, *declared.indexed, *declared.indexed_inputs)

    @cached_property
    def known(self) -> dict[str, Any]:
        """All quantities of the window by name."""
        spec = self.equations.spec
        return {each.name: each for each in (*spec.variables, *spec.parameters, *spec.inputs)}

    @cached_property
    def components(self) -> dict[str, tuple[str, ...]]:
        """The components of what a member has, of its generic name, by component."""
        generic = dict[str, tuple[str, ...]]()
        for name in self.names:
            each = self.known[member_name(name, 0)]
            generic[name] = component_names(name, each.shape, each.form)
        return generic

    def names_of(self, names: Sequence[str], member: int) -> list[str]:
        """Components of quantities of one member of the window."""
        return [c for name in names for c in self.known[member_name(name, member)].components]

    def generic(self, names: Sequence[str]) -> tuple[sympy.Symbol, ...]:
        """Symbols of the components of generic quantities."""
        return tuple(sympy.Symbol(c) for name in names for c in self.components[name])

    @cached_property
    def states(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the state of member i."""
        return self.generic(self.declared.variables)

    @cached_property
    def indexed(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the parameters of member i."""
        return self.generic(self.declared.indexed)

    @cached_property
    def indexed_inputs(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the inputs of member i."""
        return self.generic(self.declared.indexed_inputs)

    @cached_property
    def own(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of all that member i has."""
        return self.generic(self.names)

    @cached_property
    def increments(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the increments of the Wiener processes of member i."""
        return tuple(map(sympy.Symbol, self.declared.indexed_noise))

    @cached_property
    def partners(self) -> dict[sympy.Symbol, sympy.Symbol]:
        """Symbols of member j of a pair."""
        if not self.declared.pairs:
            return {}
        return {each: sympy.Symbol(f"{each.name}[j]") for each in self.own}

    @cached_property
    def neighbours(self) -> dict[tuple[sympy.Symbol, int], sympy.Symbol]:
        """Symbols of the neighbours of member i, as far as the window has them."""
        most = self.members.count
        return {
            (each, shift): sympy.Symbol(f"{each.name}[{shift:+d}]")
            for shift in range(-most, most + 1)
            if shift
            for each in (*self.own, *self.increments)
        }

    @cached_property
    def singles(self) -> dict[tuple[sympy.Symbol, int], sympy.Symbol]:
        """Symbols of members at the ends, by number."""
        most = self.members.count
        return {
            (each, number): sympy.Symbol(f"{each.name}[{'N' * (number < 0)}{number}]")
            for number in range(-most, most)
            for each in self.own
        }

    def rename(
        self, member: int, before: int, after: int, *, around: bool = False
    ) -> dict[sympy.Symbol, sympy.Symbol]:
        """The generic symbols by those of the window, seen from one of its members.

        Args:
            member: Its place.
            before: How many members are seen before it.
            after: How many are seen after it.
            around: Whether those before the first are the last ones, and the other way round.
        """
        own, count = self.own, self.members.count
        new = dict[sympy.Symbol, sympy.Symbol]()
        for shift in range(-before, after + 1):
            at = (member + shift) % count if around else self.members.place(member + shift)
            if at is not None:
                seen = own if shift == 0 else [self.neighbours[each, shift] for each in own]
                old = map(sympy.Symbol, self.names_of(self.names, at))
                new |= zip(old, seen, strict=True)
                for name, each in zip(self.declared.indexed_noise, self.increments, strict=True):
                    process = sympy.Symbol(member_name(name, at))
                    new[process] = self.neighbours[each, shift] if shift else each
        return new

    @property
    def middle(self) -> int:
        """A member that has all its neighbours."""
        return self.declared.ends[0]

    def see_around(self, member: int) -> dict[sympy.Symbol, sympy.Symbol]:
        """The generic symbols of all members on which the rate of a member may depend."""
        reach, (first, last) = self.declared.reach, self.declared.alone
        before, after = member, self.members.count - 1 - member
        if before < first:
            return self.rename(member, before + last, max(reach, first - 1 - before), around=True)
        if after < last:
            return self.rename(member, max(reach, last - 1 - after), after + first, around=True)
        return self.rename(member, reach, reach)

    # -- expressions --------------------------------------------------------------------

    @cached_property
    def written(self) -> Written:
        """What the spec says, not multiplied out."""
        return Written(self.equations)

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
        left = value.free_symbols - {*new, *map(sympy.Symbol, shared)}
        left -= {*self.shared_inputs, *self.time, *self.count}
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
