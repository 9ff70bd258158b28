"""The course of a simulation: the method, its tolerances, and how each trajectory ended.

Comes in: what a solver knows at its end. Goes out: a record that a `Solution` holds.
Read next: `coadjoint.solve.solution`.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.ensemble import Status
from coadjoint.solve.kinks import Kinks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array

    Place = tuple[int, ...]


@dataclass(frozen=True)
class Start:
    """Where trajectories began, if no sample has it.

    Attributes:
        time: When.
        state: Where, ``(n, *batch)``.
        inputs: Inputs then, as a Solution of one sample has them.
        varies: Whether inputs change later.
        reconstructed: What is reconstructed, ``(k, *batch)``; None if nothing is.
    """

    time: float
    state: Array
    inputs: Array | None
    varies: bool
    reconstructed: Array | None = None


@dataclass(frozen=True)
class Course:
    """How a Solution was computed; what is of each trajectory has the shape of the batch.

    Attributes:
        method: ``taylor``, ``dop853``, ``rk4``, or ``scipy:NAME``.
        order: Of a generated method.
        rtol: Relative tolerance; None if the method does not look at it.
        atol: Absolute tolerance; likewise.
        step: The fixed step, if there was one.
        codes: How each trajectory ended, as `Status`; None from SciPy.
        steps: Steps that were taken; likewise.
        rejected: Steps that were tried in vain; likewise.
        sweeps: Sweeps by which the equations of all steps were solved, and those of a last one that
            was not; None of explicit methods.
        reached: The time that each trajectory reached; likewise.
        last: The state there, ``(n, *batch)``; likewise.
        below: What is reconstructed there, ``(k, *batch)``; None if nothing is.
        driven: Inputs there, ``(m, *batch)``; None if they are constant.
        stepwise: Why Python led the steps; empty where a solver made them all.
        seed: Of the noise; None without any.
        keeps: What the method keeps by itself, of a motion with noise on each path, by its own
            update; empty without noise.
        projection: Onto what states are moved, and when; empty where they are not.
        chosen: Why the method was taken, where it was left to us and steps are fixed.
        newton: Whether Newton's method solved the equations of steps.
        start: Where the trajectories began, if no sample has it.
        kinks: The kinks that they met; None where the rates have none, or from SciPy.
    """

    method: str
    order: int | None
    rtol: float | None
    atol: float | None
    step: float | None
    codes: NDArray[np.int8] | None = None
    steps: NDArray[np.uint64] | None = None
    rejected: NDArray[np.uint64] | None = None
    sweeps: NDArray[np.uint64] | None = None
    reached: Array | None = None
    last: Array | None = None
    below: Array | None = None
    driven: Array | None = None
    stepwise: str = ""
    seed: int | None = None
    keeps: str = ""
    projection: str = ""
    chosen: str = ""
    start: Start | None = None
    newton: bool = False
    kinks: Kinks | None = None

    def tell_stepwise(self) -> str:
        """That Python led the steps, and why: C may have made some in a row; "" elsewhere."""
        return f"Python led the steps: {self.stepwise}" if self.stepwise else ""

    def tell_keeps(self) -> str:
        """What the method keeps by itself; "" for nothing."""
        whose = "of what each path keeps, " if self.seed is not None else ""
        return f"{whose}{self.method} keeps {self.keeps}" if self.keeps else ""

    def tell_chosen(self) -> str:
        """Why the method was taken; "" where it was named."""
        return f"{self.method} was taken: {self.chosen}" if self.chosen else ""

    @property
    def status(self) -> str:
        """How one trajectory ended."""
        assert self.codes is not None, "asked for only where a generated solver told it"
        return Status(int(self.codes)).name

    def take(self, place: Place) -> Course:
        """The course of one trajectory of a batch."""
        at: Any = (slice(None), *place)
        start = self.start
        if start is not None:
            inputs = start.inputs
            if inputs is not None and inputs.ndim > 2:
                inputs = inputs[at][:, 0]
            below = None if start.reconstructed is None else start.reconstructed[at]
            start = replace(start, state=start.state[at], inputs=inputs, reconstructed=below)
        of_each: dict[str, Any] = {
            name: np.asarray(values[place])
            for name in ("codes", "steps", "rejected", "sweeps", "reached")
            if (values := getattr(self, name)) is not None
        }
        of_each |= {
            name: values[at]
            for name in ("last", "below", "driven")
            if (values := getattr(self, name)) is not None
        }
        kinks = None if self.kinks is None else self.kinks.take(place)
        return replace(self, **of_each, start=start, kinks=kinks)

    def as_record(self) -> dict[str, Any]:
        """What no sample of a Solution shows, as JSON values."""
        record: dict[str, Any] = {
            name: values.tolist() for name in _ARRAYS if (values := getattr(self, name)) is not None
        }
        if self.start is not None:
            start = asdict(self.start)
            record["start"] = {
                name: value.tolist() if isinstance(value, np.ndarray) else value
                for name, value in start.items()
            }
        if self.kinks is not None:
            record["kinks"] = self.kinks.as_record()
        return record


#: Arrays of a course that a file keeps, with their types.
_ARRAYS = {
    "steps": np.uint64,
    "rejected": np.uint64,
    "sweeps": np.uint64,
    "reached": np.float64,
    "last": np.float64,
    "below": np.float64,
    "driven": np.float64,
}


def read_record(record: dict[str, Any]) -> dict[str, Any]:
    """What `Course.as_record` wrote, as arguments of a Course."""
    found: dict[str, Any] = {
        name: np.array(record[name], kind) for name, kind in _ARRAYS.items() if name in record
    }
    if "start" in record:
        arrays = {
            name: None if value is None else np.array(value, np.float64)
            for name, value in record["start"].items()
            if name in ("state", "inputs", "reconstructed")
        }
        found["start"] = Start(**(record["start"] | arrays))
    if "kinks" in record:
        found["kinks"] = Kinks.read_record(record["kinks"])
    return found


#: Of a Solution that was put together by hand.
UNTOLD = Course(method="", order=None, rtol=None, atol=None, step=None)
