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
from coadjoint.lower.compositions import Schedule, schedule
from coadjoint.lower.flows import lower_flows
from coadjoint.lower.kahan import lower_kahan
from coadjoint.lower.program import Program

#: Methods that are compositions of flows, with their orders; Kahan's is one of a single map.
SPLITTINGS: Final = {"splitting": 2, "splitting4": 4, "splitting6": 6}
KAHAN: Final = "kahan"
#: Every method that is a sequence of maps.
COMPOSED: Final = (*SPLITTINGS, KAHAN)


@dataclass(frozen=True)
class Maps:
    """The maps of a system.

    Attributes:
        programs: The flows, ``flow1`` and so on, and ``kahan``, as far as there are these.
        refusals: Why there are none, by method.
    """

    programs: tuple[Program, ...]
    refusals: Mapping[str, str]


def lower_maps(equations: Equations, *, is_looped: bool) -> Maps:
    """The maps of a system.

    Args:
        equations: The emitted route.
        is_looped: Whether its rates are loops over a table.
    """
    if is_looped:
        reason = "its rates are loops over a table"
        return Maps((), dict.fromkeys(COMPOSED, reason))
    refusals, programs = dict[str, str](), list[Program]()
    splitting, kahan = find_splitting(equations), lower_kahan(equations)
    if isinstance(splitting, NoSplitting):
        refusals |= dict.fromkeys(SPLITTINGS, splitting.reason)
    else:
        programs += lower_flows(splitting)
    if isinstance(kahan, str):
        refusals[KAHAN] = kahan
    else:
        programs.append(kahan)
    return Maps(tuple(programs), refusals)


def list_maps(programs: Iterable[str]) -> list[str]:
    """The names that are those of maps."""
    return [name for name in programs if name == KAHAN or name.startswith("flow")]


def list_schedules(maps: Iterable[str]) -> dict[str, tuple[tuple[str, float], ...]]:
    """The methods of a system: which map acts for which part of a step, in order.

    Args:
        maps: The names of its maps.
    """
    names = tuple(maps)
    flows = [name for name in names if name.startswith("flow")]
    found: dict[str, tuple[tuple[str, float], ...]] = {}
    for method, order in SPLITTINGS.items() if flows else ():
        own: Schedule = schedule(len(flows), order) if len(flows) > 1 else ((0, 1.0),)
        found[method] = tuple((flows[part], time) for part, time in own)
    if KAHAN in names:
        found[KAHAN] = ((KAHAN, 1.0),)
    return found
