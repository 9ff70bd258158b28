"""Bands: how far the rates of equal members couple them.

Where members read their neighbours alone, derivatives of the rates have bands, and Newton's method
solves by these. Comes in: the loops of a function. Goes out: how wide bands are.
Read next: `coadjoint.solve.methods.bands`, which solves with them.
"""

from __future__ import annotations

from typing import Any

from coadjoint.lower.loops import Loops


def find_bands(loops: Loops) -> dict[str, Any] | None:
    """How far the rates couple members; None where they couple all of them."""
    if loops.partners or loops.totals or loops.solve or loops.products or loops.member is None:
        return None
    reach = loops.member.reach
    if any(read.single is not None and read.array == "state" for read in loops.member.reads):
        return None
    for place, part in loops.ends:
        for read in part.reads:
            if read.array != "state":
                continue
            if read.single is not None and (read.single < 0) != (place < 0):
                return None
            apart = (read.shift or 0) if read.single is None else read.single - place
            reach = max(reach, abs(apart))
    return {"reach": reach, "wraps": loops.wraps}
