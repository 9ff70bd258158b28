"""Units of formulas of the state: events are checked as the formulas of a spec are.

Comes in: a `Formula` and the quantities that it may name. Goes out: nothing, or an error with the
units that do not fit. A unit that the spec does not tell fits everything, and nothing is checked
where all quantities are pure numbers. A number that is a term of its own, as in ``x - 0.5``, is in
the unit of the rest.
Read next: `coadjoint.spec.core.dimensions`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from coadjoint.declared import component_units
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.formulas import Formula
from coadjoint.spec.core.dimensions import Balance, Demand, Measured, is_number, measure
from coadjoint.spec.core.units import Unit, UnitError, read_unit, unknown, write_unit


def check_units(formula: Formula, quantities: Iterable[Any], unit_of_time: str, label: str) -> None:
    """Refuse a formula whose parts do not fit.

    Args:
        formula: A scalar formula.
        quantities: What it may name; the first of a name counts.
        unit_of_time: The unit of ``t`` and ``time``.
        label: What the formula is, for messages.

    Raises:
        KernelArgumentError: A sum of unlike units, or a function of what is no pure number.
    """
    named = list(quantities)
    if all(text in ("", "1") for each in named for text in component_units(each)):
        return
    asked: list[Demand] = []
    names = _list_units(named, unit_of_time)
    terms = [term for term in formula.terms if not is_number(term)]
    units = [measure(term, names, asked.append).entries[0] for term in terms]
    known = [unit for unit in units if unit is not None]
    what = "its terms have the units {expected} and {found}"
    asked += [
        Demand(found=unit, expected=known[0], what=what, wanted="terms of one unit")
        for unit in known[1:]
    ]
    balance = Balance()
    for demand in asked:
        if not balance.meet(demand):
            found, expected = (
                write_unit(balance.reduce(unit)) for unit in (demand.found, demand.expected)
            )
            problem = demand.what.format(found=found, expected=expected)
            wanted = demand.wanted.format(found=found, expected=expected)
            raise KernelArgumentError(
                f"{label}: {problem}; expected {wanted}.", found=formula.text, unit=found
            )


def _list_units(quantities: Iterable[Any], unit_of_time: str) -> dict[str, Measured]:
    """The units of names, whole quantities and components."""
    names: dict[str, Measured] = {}
    for each in quantities:
        parts = zip(each.components, component_units(each), strict=True)
        units = tuple(_read(text, name) for name, text in parts)
        names.setdefault(each.name, Measured(each.shape, units))
        for name, unit in zip(each.components, units, strict=True):
            names.setdefault(name, Measured((), (unit,)))
    for name in ("t", "time"):
        names.setdefault(name, Measured((), (_read(unit_of_time, name),)))
    return names


def _read(text: str, name: str) -> Unit:
    """A unit; unknown where the spec does not tell it."""
    try:
        return read_unit(text) if text else unknown(name)
    except UnitError:  # of a system that was generated before units were checked
        return unknown(name)
