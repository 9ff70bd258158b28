"""Maps: what explicit and linearly implicit methods make a step of, for one system.

Comes in: Equations. Goes out: the flows of its splitting and the step of Kahan's method, as far as
it has them, and why it has not.
Read next: `coadjoint.lower.flows`, `coadjoint.lower.kahan`, `coadjoint.lower.compositions`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from coadjoint.derive import Equations
from coadjoint.derive.splittings import NoSplitting, find_splitting
from coadjoint.lower.compositions import SINGLE, SPLITTINGS
from coadjoint.lower.exact_body import lower_exact_body
from coadjoint.lower.flows import lower_flows
from coadjoint.lower.kahan import lower_kahan
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.program import ZERO, Program

#: Every method that is a sequence of maps.
COMPOSED: Final = (*SPLITTINGS, *SINGLE)


@dataclass(frozen=True)
class Maps:
    """The maps of a system.

    Attributes:
        programs: The flows, ``flow1`` and so on, ``kahan`` and ``exact_body``, as far as there are
            such.
        refusals: Why there are none, by method.
    """

    programs: tuple[Program, ...]
    refusals: Mapping[str, str]


def lower_maps(equations: Equations, rates: Program) -> Maps:
    """The maps of a system.

    Args:
        equations: The emitted route.
        rates: Its rates as the kernel has them.
    """
    if rates.table is not None:
        return Maps((), dict.fromkeys(COMPOSED, "its rates are loops over a table"))
    if "kinks" in hold_sides({"rates": rates}):
        return Maps((), dict.fromkeys(COMPOSED, "its rates have kinks"))
    refusals, programs = dict[str, str](), list[Program]()
    splitting = find_splitting(equations)
    if isinstance(splitting, NoSplitting):
        refusals |= dict.fromkeys(SPLITTINGS, splitting.reason)
    else:
        programs += lower_flows(splitting)
    for name, found in zip(
        SINGLE, (lower_kahan(equations), lower_exact_body(equations)), strict=True
    ):
        if isinstance(found, str):
            refusals[name] = found
        else:
            programs.append(found)
    return Maps(tuple(programs), refusals)


def list_maps(programs: Iterable[str]) -> list[str]:
    """The names that are those of maps."""
    return [name for name in programs if name in SINGLE or name.startswith("flow")]


def list_moved(maps: Iterable[Program]) -> dict[str, tuple[int, ...]]:
    """The rows of the state to which each map adds something."""
    return {
        each.name: tuple(row for row, out in enumerate(each.outputs) if out.value != ZERO)
        for each in maps
    }
