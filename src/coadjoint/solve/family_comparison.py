"""A fresh object of the steps of a family, compared with its twin.

Comes in: both, for a few members. Goes out: nothing, or a `CrossCheckError`. Read next:
`coadjoint.solve.comparison`, which does it for other systems.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.errors import CrossCheckError
from coadjoint.solve.comparison import DRAWN, move_near
from coadjoint.solve.ensemble import Ensemble, Inputs

if TYPE_CHECKING:
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.solvers import Stepper

#: What two runs have alike.
COMPARED: Final = ("out", "state", "time", "step", "steps", "rejected", "status")
#: And of methods that keep structure, as far as they have them.
LEFT: Final = ("memory", "sweeps")
#: How near states are whose functions have other roundings.
CLOSE: Final = 1e-9


def list_left(run: Ensemble) -> list[str]:
    """What the steps of a run leave."""
    return [name for name in LEFT if getattr(run, name) is not None]


def find_probed(system: FamilySystem) -> FamilySystem:
    """The system with so many members that fifteen trajectories are computed together."""
    return system.resize({system.index.name: 8 * -(-(system.small + 5) // 8) + 1})


def compare_steps(
    system: FamilySystem, choice: Choice, target: str, fresh: Stepper, twin: Stepper
) -> None:
    """A fresh object makes the steps of the twin, bit for bit.

    Args:
        system: A few members, as `find_probed` says.
        choice: The method.
        target: Of the object.
        fresh: Makes its steps.
        twin: Makes those of NumPy.

    States are near, 1e-9 of the largest, where series call functions beyond sqrt, or operations are
    fused: differently for one trajectory and for many.

    Raises:
        CrossCheckError: It does not.
    """
    # where roundings differ, one may decide on the length of a step
    exact = target == "c" and (choice.name != "taylor" or not system.elementary)
    lengths = [(3, 2.0**-7), (15, 2.0**-7)]
    if exact and choice.name in ("dop853", "taylor"):
        lengths += [(1, 0.0), (15, 0.0)]
    if choice.is_implicit and exact:  # other roundings have other sweeps, and other rests of sums
        lengths += [(1, 2.0**-7), (1, 64.0)]  # the last one has no solution
    for members, step in lengths:
        found, expected = (_probe(system, choice, members, step) for _ in range(2))
        for stepper, run in ((fresh, found), (twin, expected)):
            while stepper.advance(run, 0, members, 5):
                pass
        kinked = ("kinks", "brief") if system.kinks else ()
        for name in (*COMPARED, *(list_left(found) if exact else ()), *kinked):
            one, other = (np.asarray(getattr(run, name)) for run in (found, expected))
            tolerance = 0.0 if exact else CLOSE * np.abs(other[np.isfinite(other)]).max(initial=1.0)
            if not np.allclose(one, other, rtol=0.0, atol=tolerance, equal_nan=True):
                raise CrossCheckError(
                    f"a wrong solver was compiled: {choice} of {system.name}, solver.c, differs "
                    "from its NumPy twin. Set CC to another compiler, or run `coadjoint "
                    "crosscheck` to see whether the files are at fault.",
                    rung=5,
                    system=system.name,
                    target=target,
                )


def _probe(system: FamilySystem, choice: Choice, members: int, step: float) -> Ensemble:
    """A few trajectories at the start of twelve steps, with two samples on the way."""
    source = np.random.default_rng(0)
    end = 12 * (step or 2.0**-7)
    state = source.uniform(*DRAWN, (system.STATE.size, members))
    if "projection" in system.functions:  # far from rotations it leads away
        state = move_near(state, system.STATE)
    run = Ensemble(
        state=state,
        parameters=source.uniform(*DRAWN, system.PARAMETERS.size),
        inputs=_probe_inputs(system, source, end),
        has_time=bool(system.TIME),
        samples=np.array([0.0, 0.55 * end, end]),
        out=np.zeros((system.STATE.size, members, 3)),
        rtol=1e-9,
        atol=1e-12,
        size=step,
        max_steps=60,
        seed=1,
        bound=2.0,
        remembered=choice.count_memory(system.STATE.size, searches=False),
        is_implicit=choice.is_implicit,
        has_clock=False,
        sides=len(system.kink_names),
    )
    run.begin(0.0)
    return run


def _probe_inputs(system: FamilySystem, source: np.random.Generator, end: float) -> Inputs:
    """Lines of inputs, of which the second begins within a step."""
    values, slopes = (source.uniform(*DRAWN, (system.INPUTS.size, 2)) for _ in range(2))
    knots = np.array([0.0, 0.3 * end])
    if not system.INPUTS:
        knots, values, slopes = knots[:1], values[:, :1], slopes[:, :1]
    return Inputs(knots, values, slopes)
