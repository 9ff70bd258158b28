"""The names of a window: what a few members that are written out have, as one of them sees it.

Comes in: the Equations of a few members. Goes out: symbols of the generic member and of those next
to it, and expressions of the window in these.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from coadjoint.derive.differences import tidy
from coadjoint.derive.equations import Equations
from coadjoint.derive.written import Written, choose
from coadjoint.errors import DerivationError
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import Members, member_name
from coadjoint.spec.model import Windows


@dataclass(frozen=True)
class Window:
    """A few members that are written out, and what generic symbols call what they have.

    Attributes:
        equations: Of these members.
    """

    equations: Equations

    # -- what there is ------------------------------------------------------------------

    @cached_property
    def declared(self) -> Windows:
        """What is known of the other members."""
        family = self.equations.spec.family
        assert family is not None, self.equations.spec.name
        return family

    @cached_property
    def written(self) -> Written:
        """What the spec says, not multiplied out."""
        return Written(self.equations)

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
        )

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
        known = {each.name: each for each in self.equations.spec.inputs}
        names = self.declared.shared_inputs
        return tuple(sympy.Symbol(c) for name in names for c in known[name].components)

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

    # -- expressions of a member --------------------------------------------------------

    def rename(self, member: int, before: int, after: int) -> dict[sympy.Symbol, sympy.Symbol]:
        """The generic symbols by those of the window, seen from one of its members."""
        own, new = self.own, dict[sympy.Symbol, sympy.Symbol]()
        for shift in range(-before, after + 1):
            at = self.members.place(member + shift)
            if at is not None:
                seen = own if shift == 0 else [self.neighbours[each, shift] for each in own]
                old = map(sympy.Symbol, self.names_of(self.names, at))
                new |= zip(old, seen, strict=True)
                for name, each in zip(self.declared.indexed_noise, self.increments, strict=True):
                    process = sympy.Symbol(member_name(name, at))
                    new[process] = self.neighbours[each, shift] if shift else each
        return new

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

    @property
    def middle(self) -> int:
        """A member that has all its neighbours."""
        return 0 if self.declared.index.periodic else self.declared.reach
