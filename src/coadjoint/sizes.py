"""Sizes: how many members a system of equal members may have, or fields points.

Comes in: a number that somebody asks for, in a spec or of a System. Goes out: nothing, or an error
that names it with what would be accepted. Read next: `coadjoint.families`.
"""

from __future__ import annotations

import os
from typing import Final

from coadjoint.errors import KernelArgumentError, ResourceError
from coadjoint.limits import WORKER_BYTES

#: Bytes of memory for each row of the state and of the parameters: its name and its place among
#: them, and some arrays of a run (measured: docs/decisions/family-kernels.md).
ROW_BYTES: Final = 1000
#: The largest part of the memory of a machine that a System may take.
SHARE: Final = 0.5
#: Why there is a least number.
HOLD, MOVES = "its equations hold", "a wave moves"


def check_least(
    name: str, index: str, size: object, least: int, why: str = HOLD, *, where: str = ""
) -> int:
    """The number of members or points that is asked for.

    Args:
        name: The system.
        index: What counts them.
        size: What is asked for.
        least: The fewest that there may be.
        why: What is so from this number on.
        where: The file that says so, if one does.

    Raises:
        KernelArgumentError: There are too few, or it is no whole number.
    """
    if isinstance(size, int) and not isinstance(size, bool) and size >= least:
        return size
    raise KernelArgumentError(
        f"{where and where + ': '}the size of {index} of {name} is {size!r}; expected a whole "
        f"number of at least {least}, from which on {why}.",
        found=size,
        expected=least,
    )


def check_memory(name: str, index: str, rows: int) -> None:
    """So many rows fit into memory.

    Raises:
        ResourceError: They do not.
    """
    needed, there = rows * ROW_BYTES, find_memory()
    if needed > there * SHARE:
        raise ResourceError(
            f"{name} has {rows} rows at the size of {index} that is chosen, which take about "
            f"{needed / 1e9:.1f} GB; expected at most half of the {there / 1e9:.1f} GB of this "
            f"machine. Choose a smaller size of {index}.",
            found=needed,
            expected=int(there * SHARE),
        )


def check_declared_memory(name: str, index: str, rows: int) -> None:
    """So many rows that a spec declares fit into the memory in which specs are worked on.

    Raises:
        ResourceError: They do not.
    """
    check_memory(name, index, rows)
    needed, most = rows * ROW_BYTES, int(WORKER_BYTES * SHARE)
    if needed > most:
        raise ResourceError(
            f"{name} has {rows} rows at the size of {index} that its spec declares, which take "
            f"about {needed / 1e9:.1f} GB; expected at most half of the {WORKER_BYTES / 1e9:.1f} "
            f"GB in which a spec is derived and checked. Declare a smaller size of {index}, and "
            "choose the larger one when the system is loaded.",
            found=needed,
            expected=most,
        )


def find_memory() -> float:
    """The memory of this machine in bytes; no bound where it does not tell."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return float("inf")
