"""Cross-check, sums over partners: blocks and tiles give what a plain loop over all pairs gives.

Comes in: the `Loops` of rates and the loaded system. Goes out: the largest difference, or a
`CrossCheckError`. The windows of a family have a few members, and no blocks. Here each member of
many takes the terms of all others, one after the other, as Programs have them; how kernels group
members is not known here. Terms that a kernel adds to the second member of a pair are not read:
each member is the first one.
Read next: `coadjoint.crosscheck.families`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CrossCheckError
from coadjoint.lower.evaluation import run
from coadjoint.lower.loops import FEWEST, SUM, Loops, Part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

#: Members: some blocks, and three members behind the last.
MEMBERS: Final = FEWEST + 3
#: What roundings may be of the largest value.
_CLOSE: Final = 1e-11


def check_blocks(system: Any, loops: Loops) -> float:
    """Rates of many members in NumPy are those of a plain loop, but for roundings.

    Returns:
        The largest difference, in units of the largest value.

    Raises:
        CrossCheckError: They differ.
    """
    sized, source = system.resize({system.index.name: MEMBERS}), np.random.default_rng(MEMBERS)
    state = source.normal(size=loops.blocks * MEMBERS)
    parameters = source.uniform(0.5, 2.0, sized.PARAMETERS.size)
    time = source.normal(size=1) if sized.TIME else None
    inputs = source.normal(size=sized.INPUTS.size) if sized.INPUTS else None
    arrays = {"state": state, "parameters": parameters, "inputs": inputs, "time": time}
    arrays["sizes"] = np.array([float(MEMBERS)])
    now = None if time is None else time[0]
    values = sized.evaluate(loops.name, state, parameters, inputs, time=now, target="numpy")
    found = np.reshape(values, (-1, MEMBERS))
    expected = np.stack([_find_rates(loops, arrays, i) for i in range(MEMBERS)], axis=1)
    has_values = np.isfinite(expected).all(axis=0)
    if not has_values.any():
        raise CrossCheckError.on(4, system.name, f"{loops.name}: no member has rates")
    difference = np.abs(found - expected)[:, has_values].max()
    difference /= np.abs(expected[:, has_values]).max(initial=1.0)
    if not difference <= _CLOSE:
        problem = f"of {MEMBERS} members differs from a loop over all pairs by {difference:.3g}"
        raise CrossCheckError.on(4, system.name, f"{loops.name} {problem} of the largest value")
    return float(difference)


def _find_rates(loops: Loops, arrays: Mapping[str, Array], i: int) -> Array:
    """The rates of a member."""
    assert loops.partners is not None, loops.name
    others = np.delete(np.arange(MEMBERS), i)
    terms = _evaluate(loops.partners, arrays, i, others, ())[: loops.pair_sums]
    sums = tuple(np.sum(np.broadcast_to(term, others.shape)) for term in terms)
    place = {member % MEMBERS: part for member, part in loops.ends}
    part = place.get(i, loops.member)
    assert part is not None, loops.name
    return np.array([float(value) for value in _evaluate(part, arrays, i, others, sums)])


def _evaluate(
    part: Part, arrays: Mapping[str, Array], i: int, others: NDArray[np.int_], sums: tuple[Any, ...]
) -> list[Any]:
    """The outputs of a part for a member, and all its partners at once."""
    values: dict[str, Any] = {}
    for read in part.reads:
        member: Any = others if read.of_partner else (i + (read.shift or 0)) % MEMBERS
        row = read.rows + read.blocks * MEMBERS + (0 if read.shift is None else member)
        values[read.name] = arrays[read.array][row]
    for name in part.program.state[len(part.reads) :]:
        values[name] = sums[int(name.removeprefix(SUM))]
    with np.errstate(all="ignore"):
        return run(part.program, values, _number, _call)


def _number(value: Fraction) -> Any:
    return np.float64(value)


def _call(function: str, *arguments: Any) -> Any:
    return getattr(np, ELEMENTARY[function].numpy_name)(*arguments)
