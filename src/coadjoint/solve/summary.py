"""The summary of one trajectory: where it ended and what it kept, as JSON values.

Comes in: a Solution. Goes out: what `coadjoint simulate --json` prints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coadjoint.solve.solution import Solution


def summarize(solution: Solution) -> dict[str, Any]:
    """Final state, inputs and drift of one trajectory."""
    system, inputs = solution.system, solution.system.INPUTS.components
    parameters = zip(system.PARAMETERS.components, solution.parameters.tolist(), strict=True)
    record = {
        "system": system.name,
        "status": solution.status,
        "message": solution.message,
        "time": solution.time_reached,
        "samples": len(solution),
        "parameters": dict(parameters),
        "final": solution.final,
        "drift": solution.drift,
        "absolute_drift": [*solution.absolute_drift],
    }
    if solution.inputs is not None:
        record["inputs"] = {name: float(solution[name][-1]) for name in inputs}
    if solution.course.stepwise:
        record["stepwise"] = solution.course.stepwise
    if solution.attitude_drift:
        record["attitude_drift"] = solution.attitude_drift
    return record
