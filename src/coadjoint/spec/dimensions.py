"""Dimensions: the units of a spec, checked and inferred over all of its tables.

Comes in: a Spec whose units are as typed. Goes out: the Spec with a unit for each quantity, or an
error at the formula or the unit at fault. Where no unit is declared nothing is checked, and every
quantity has the unit 1. Else a unit that is left out is unknown until the formulas, and the laws
of motion between momenta, velocities, energy and time, tell it; "" if they never do.
Read next: `coadjoint.spec.laws`, which has these laws.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import FORMS, Named, Shape, kept_places, matrix_size
from coadjoint.spec.core.dimensions import (
    Balance,
    Demand,
    Entry,
    KnownUnits,
    Measured,
    is_number,
    measure,
)
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Node
from coadjoint.spec.core.units import (
    BASE,
    ONE,
    Unit,
    UnitError,
    find_own,
    find_symbol,
    is_plain,
    read_unit,
    split_units,
    unknown,
    write_unit,
)
from coadjoint.spec.model import Spec, Time

#: The attributes of a Spec whose records have units, with their tables.
_GROUPS = {
    "variables": "variables",
    "parameters": "parameters",
    "inputs": "inputs",
    "observables": "observables",
    "reconstruction": "reconstruction",
    "sections": "momenta",
    "symmetries": "symmetries",
}
_TIME = "time"


@dataclass(frozen=True)
class Asked:
    """A demand with its place.

    Attributes:
        demand: Two units that must be equal.
        key: Where it stands in the file.
        why: Why they must be, as a sentence.
    """

    demand: Demand
    key: KeyPath
    why: str = ""

    @property
    def is_open(self) -> bool:
        """Whether one of the units is unknown at first."""
        return bool(self.demand.found.unknowns or self.demand.expected.unknowns)


@dataclass(frozen=True)
class _Reaction:
    """The multiplier of a constraint."""

    name: str
    shape: Shape
    components: tuple[str, ...]


class Units:
    """The units of the names of a spec, and what has been demanded of them.

    Args:
        source: The text of the spec.
        spec: The spec.

    Attributes:
        names: The unit of each name, whole quantities and components alike.
        time: The unit of time.
        energy: The unit of the energy.
        asked: All demands, in order.
    """

    def __init__(self, source: Source, spec: Spec) -> None:
        self.source, self.spec = source, spec
        texts = [each.unit for _, each in _list_quantities(spec) if each.unit]
        self.blank: Callable[[str], Unit] = unknown if texts else lambda name: ONE
        self.own = find_own(texts)
        self.asked: list[Asked] = []
        self.energy = self.blank("energy")
        self.time = self._find_time(texts)
        self.names: dict[str, Measured] = {"energy": Measured((), (self.energy,))}
        for key, each in _list_quantities(spec):
            self.declare(each, self._read_declared(key, each))
        for jet in spec.jets:
            along = self.along_space[0] ** jet.order * self.along_space[-1] ** jet.across
            self.declare(jet, [unit / along for unit in self.of(jet.of)])
        for each in spec.constraints:
            reactions = [self.blank(name) for name in each.reactions]
            self.declare(_Reaction(each.reaction, each.shape, each.reactions), reactions)

    def _find_time(self, texts: Sequence[str]) -> Unit:
        """The unit of time: declared, or the only one in which other units have it."""
        declared = self.spec.clock.unit
        if declared:
            return self._read(("time", "unit"), declared, 0)
        symbols = {symbol for text in texts for symbol in re.findall("[A-Za-z]+", text)}
        found = {symbol: find_symbol(symbol) for symbol in symbols}
        timed = [unit for unit in found.values() if unit and "s" in dict(unit.powers)]
        plain = {unit for unit in timed if {n for n, _ in unit.powers} & set(BASE) == {"s"}}
        single = {unit for unit in plain if dict(unit.powers)["s"] == 1}
        if len(single) == 1:
            return single.pop()
        return read_unit("s") if timed else self.blank(_TIME)

    def _read_declared(self, key: KeyPath, each: Any) -> tuple[Unit, ...]:
        """The unit of each component, unknown where none is declared."""
        if each is self.spec.time:
            return (self.time,)
        if not each.unit:
            return tuple(map(self.blank, each.components))
        parts = split_units(each.unit, len(each.components))
        if parts is None:
            problem = f"there are {each.unit.count(',') + 1} units"
            expected = f"one unit, or {len(each.components)}, one for each component"
            raise self.source.fault((*key, "unit"), problem, each.unit, expected)
        return tuple(self._read((*key, "unit"), text, start) for text, start in parts)

    def _read(self, key: KeyPath, text: str, start: int) -> Unit:
        """A unit text, which stands at an offset of a value."""
        try:
            return read_unit(text)
        except UnitError as error:
            at = self.source.within(key, start + error.start, start + error.end)
            expected = "a unit such as 'kg m^2/s', or 1"
            raise self.source.fault(key, error.problem, text, expected, error.hint, at=at) from None

    @cached_property
    def along_space(self) -> tuple[Unit, ...]:
        """The units of the coordinates of space."""
        space = self.spec.space
        return tuple(
            self._read(("space", each.name, "unit"), each.unit, 0)
            if each.unit
            else self.blank("space")
            for each in ((space, space.across) if space is not None else ())
            if each is not None
        )

    @property
    def action(self) -> Unit:
        """Energy times time, as a position times its momentum."""
        return self.energy * self.time

    # -- names --------------------------------------------------------------------------

    def declare(self, each: Any, units: Sequence[Unit]) -> None:
        """The units of a quantity and of its components."""
        self.names |= {
            name: Measured((), (unit,)) for name, unit in zip(each.components, units, strict=True)
        }
        self.names[each.name] = self._assemble(each, units)

    def _assemble(self, each: Any, units: Sequence[Entry]) -> Measured:
        """A quantity as it is in formulas."""
        form = getattr(each, "form", "")
        if getattr(each, "elements", ()):
            size = each.matrix_size
            entries: list[Entry] = [None] * size**2
            for unit, matrix in zip(units, each.elements, strict=True):
                for row, column in matrix:
                    entries[row * size + column] = entries[row * size + column] or unit
            return Measured((size, size), tuple(entries))
        if form in FORMS:
            size = matrix_size(len(units), form) or 0
            kept = dict(zip(kept_places(size, form), units, strict=True))
            mirrored = {(j, i): unit for (i, j), unit in kept.items()} | kept
            places = [(i, j) for i in range(size) for j in range(size)]
            return Measured((size, size), tuple(mirrored.get(place) for place in places))
        return Measured(each.shape, tuple(units))

    def of(self, each: Named) -> tuple[Unit, ...]:
        """The units of the components of a quantity."""
        return tuple(self.names[name].entries[0] or ONE for name in each.components)

    # -- demands ------------------------------------------------------------------------

    def value(
        self, formula: Formula, names: Mapping[str, Measured] | None = None
    ) -> tuple[Entry, ...]:
        """The units of the entries of a formula, whose parts are made to fit."""
        return measure(
            formula.tree,
            self.names if names is None else {**self.names, **names},
            self._ask(formula),
        ).entries

    def _ask(self, formula: Formula) -> Callable[[Demand], None]:
        return lambda demand: self.asked.append(Asked(demand, formula.path))

    def equate(
        self,
        formula: Formula,
        expected: Sequence[Entry],
        why: str = "",
        names: Mapping[str, Measured] | None = None,
        what: str = "the value has the unit {found}",
    ) -> None:
        """The entries of a formula have some units."""
        entries = self.value(formula, names)
        for found, wanted in zip(entries, expected, strict=True):
            self.require(formula.path, found, wanted, why, what)

    def require(
        self,
        key: KeyPath,
        found: Entry,
        expected: Entry,
        why: str = "",
        what: str = "the unit is {found}",
        wanted: str = "{expected}",
    ) -> None:
        """Two units are equal."""
        if found is not None and expected is not None:
            demand = Demand(found=found, expected=expected, what=what, wanted=wanted)
            self.asked.append(Asked(demand, key, why))

    def compare(self, left: Formula, right: Formula) -> None:
        """Two sides fit; a number alone on one of them is in the unit of the other."""
        sides = [self.value(left), self.value(right)]
        if is_number(left.tree) or is_number(right.tree):
            return
        what = "the left side has the unit {expected} and the right side {found}"
        for one, other in zip(*sides, strict=True):
            self.require(left.path, other, one, what=what, wanted="two sides of one unit")

    # -- the end ------------------------------------------------------------------------

    def settle(self) -> Balance:
        """All demands met.

        Raises:
            SpecError: One cannot be met.
        """
        balance = Balance(_TIME)
        # what the declared units alone say goes first, so that a fault is shown where it is typed
        for asked in sorted(self.asked, key=lambda asked: asked.is_open):
            if not balance.meet(asked.demand):
                raise self._explain(asked, balance)
        for name in balance.reduce(self.time).unknowns:  # no unit has a time in it
            balance.known[name] = read_unit("s")
        return balance

    def _explain(self, asked: Asked, balance: Balance) -> CoadjointError:
        """What does not fit, at its place."""
        demand = asked.demand
        units = [balance.reduce(unit) for unit in (demand.found, demand.expected)]
        found, expected = (write_unit(unit, self.own) for unit in units)
        problem = demand.what.format(found=found, expected=expected)
        node: Node | None = demand.node
        names = dict.fromkeys(name[1:] for unit in units for name in unit.unknowns)
        words = [asked.why, *(f"[{name}] is the unit of {name}." for name in names)]
        if not is_plain(units[0] / units[1]) and not names:
            words.append("They differ by a number, and nothing is converted.")
        elif asked.key[-1] == "unit" and not names:
            words.append(f'Write unit = "{expected}".')
        if node is not None and node.within:
            problem = f"in the definition of {node.within}: {problem}"
        at = None if node is None else self.source.within(asked.key, node.start, node.end)
        if asked.key[:2] == ("claims", "brackets"):
            at = self.source.positions.key(asked.key)
        return self.source.fault(
            asked.key,
            problem,
            found,
            demand.wanted.format(found=found, expected=expected),
            " ".join(filter(None, words)),
            at=at,
        )

    def known(self, balance: Balance) -> KnownUnits:
        """All units, with what is inferred put in."""
        names = {
            name: Measured(each.shape, tuple(e and balance.reduce(e) for e in each.entries))
            for name, each in self.names.items()
        }
        known, declared = KnownUnits(names, self.own), self.spec.clock.unit
        if not declared and not self.asked:
            return known
        return replace(known, time=declared or known.label([balance.reduce(self.time)]))


def _list_quantities(spec: Spec) -> Iterator[tuple[KeyPath, Any]]:
    """What has a unit, with its place."""
    for attribute, table in _GROUPS.items():
        for each in getattr(spec, attribute):
            yield (table, each.name), each
    if spec.time is not None:
        yield ("time",), spec.time


def infer_units(source: Source, spec: Spec, demand_laws: Callable[[Units], None]) -> Spec:
    """The spec with a unit for each quantity.

    Args:
        source: The text of the spec.
        spec: What was read, with the units as typed.
        demand_laws: What the tables demand of units.

    Raises:
        SpecError: A text is no unit, or units do not fit.
    """
    units, balance = Units(source, spec), Balance()
    if any(each.unit for _, each in _list_quantities(spec)):
        demand_laws(units)
        balance = units.settle()
    known = units.known(balance)

    def say(each: Any) -> str:
        if isinstance(each, Time):
            return each.unit or known.time
        return each.unit or known.label(known.names[name].entries[0] for name in each.components)

    clock = replace(spec.clock, unit=say(spec.clock))
    return replace(_fill(spec, say), clock=clock, units=known)


def _fill(spec: Spec, unit_of: Callable[[Any], str]) -> Spec:
    """The spec with a unit for each quantity that has none."""
    filled: dict[str, Any] = {
        attribute: tuple(replace(each, unit=unit_of(each)) for each in getattr(spec, attribute))
        for attribute in _GROUPS
    }
    if spec.time is not None:
        filled["time"] = replace(spec.time, unit=unit_of(spec.time))
    return replace(spec, **filled)
