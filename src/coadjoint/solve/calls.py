"""Calls of generated solvers in C: the structure that they take, filled from an ensemble.

Comes in: an `Ensemble` and the object of a solver. Goes out: the ensemble further on. Read next:
`coadjoint.solve.solvers`, which loads objects, and ``templates/c/solver.h.j2``.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from coadjoint.solve.ensemble import MET, Ensemble
from coadjoint.solve.step_records import Record

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.build.library import Library
    from coadjoint.solve.choices import Choice

#: What a first call may add up, by the numbers of a path and their orders.
FIRST_SUMS = 2**22
#: What a step with noise, or an implicit one, counts for each component, in such sums.
IMPLICIT_SUMS = 2**10

#: Kinks of which a call of a solver can tell, by how many the rates have.
KINK_ROOM = 512

_SIZE, _PLACE, _DOUBLE = ctypes.c_size_t, ctypes.c_void_p, ctypes.c_double


class _Run(ctypes.Structure):
    """``NAME_run`` of the headers, field by field; then come those of noise, or those of kinks."""

    _fields_: ClassVar[Sequence[tuple[str, Any]]] = (
        ("members", _SIZE),
        ("first", _SIZE),
        ("last", _SIZE),
        ("state", _PLACE),
        ("time", _PLACE),
        ("step", _PLACE),
        ("next", _PLACE),
        ("steps", _PLACE),
        ("rejected", _PLACE),
        ("status", _PLACE),
        ("parameters", _PLACE),
        ("parameters_stride", _SIZE),
        ("knots", _PLACE),
        ("inputs", _PLACE),
        ("slopes", _PLACE),
        ("pieces", _SIZE),
        ("inputs_stride", _SIZE),
        ("samples", _PLACE),
        ("sample_count", _SIZE),
        ("out", _PLACE),
        ("rtol", _DOUBLE),
        ("atol", _DOUBLE),
        ("size", _DOUBLE),
        ("max_steps", _SIZE),
        ("work", _SIZE),
        ("record", _PLACE),
        ("record_room", _SIZE),
        ("recorded", _SIZE),
        ("terms", _PLACE),
        ("term_count", _SIZE),
        ("late", _PLACE),
    )


class _StructuredRun(_Run):
    """With the fields of a system that has methods that keep structure."""

    _fields_ = (("memory", _PLACE), ("sweeps", _PLACE))


class _NoisyRun(_Run):
    """With the fields that a system with noise has in addition."""

    _fields_: ClassVar[Sequence[tuple[str, Any]]] = (
        ("seed", ctypes.c_uint64),
        ("bound", _DOUBLE),
        ("sweeps", _PLACE),
    )


class _KinkedRun(_Run):
    """With the fields that a system with kinks has in addition."""

    _fields_: ClassVar[Sequence[tuple[str, Any]]] = (
        ("kinks", _PLACE),
        ("brief", _PLACE),
        ("met", _PLACE),
        ("met_room", _SIZE),
        ("met_count", _SIZE),
    )


class CStepper:
    """A solver in C.

    Args:
        library: Its object.
        rows: Components of what it integrates.
        choice: The method.
    """

    def __init__(self, library: Library, rows: int, choice: Choice) -> None:
        self.source, self.key, self.degree = library.source, library.key, choice.degree
        self._rows, self._sums = (
            rows,
            IMPLICIT_SUMS if choice.is_noisy or choice.is_implicit else (choice.degree + 1) ** 2,
        )
        self._advance = library.take(choice.kind.advance)

    @property
    def first_work(self) -> int:
        """Steps of a first call, which are to take some hundredths of a second at the most."""
        return max(1, FIRST_SUMS // (self._rows * self._sums))

    def advance(
        self, ensemble: Ensemble, first: int, last: int, work: int, record: Record | None = None
    ) -> int:
        """As `Stepper.advance`; other threads run meanwhile."""
        return call(self._advance, ensemble, slice(first, last), work, record)


def call(
    advance: Callable[[Any], int],
    ensemble: Ensemble,
    members: slice,
    work: int,
    record: Record | None,
) -> int:
    """Call ``NAME_advance`` of an object.

    Args:
        advance: The function, which takes a pointer to its structure.
        ensemble: Whose members go on.
        members: Which of them; from one to another, without gaps.
        work: As `Stepper.advance` takes it.
        record: Likewise.
    """
    run = _describe(ensemble)
    run.first, run.last, run.work = members.start, members.stop, work
    met = np.empty((ensemble.sides * KINK_ROOM, MET))
    if isinstance(run, _KinkedRun):
        run.met, run.met_room = _place(met), len(met)
    if record is not None:
        run.record, run.record_room = record.rows.ctypes.data, len(record.rows)
        run.recorded = record.count
        if record.terms is not None:
            run.terms, run.term_count = _place(record.terms), len(record.terms)
    on = advance(ctypes.byref(run))
    if record is not None:
        record.count = run.recorded
    if isinstance(run, _KinkedRun) and run.met_count:
        ensemble.met.append(met[: run.met_count].copy())
    return on


def _describe(ensemble: Ensemble) -> _Run:
    """The arrays of an ensemble, as C takes them; it has to live as long as the result."""
    members, inputs, parameters = ensemble.state.shape[1], ensemble.inputs, ensemble.parameters
    swept = {"sweeps": None if ensemble.sweeps is None else _place(ensemble.sweeps)}
    further: dict[str, Any] = {"seed": ensemble.seed, "bound": ensemble.bound, **swept}
    kind: type[_Run] = _NoisyRun
    if ensemble.memory is not None:
        kind, further = _StructuredRun, {"memory": _place(ensemble.memory), **swept}
    if ensemble.kinks is not None and ensemble.brief is not None:
        kind = _KinkedRun
        further = {"kinks": _place(ensemble.kinks), "brief": _place(ensemble.brief)}
    return kind(
        members=members,
        state=_place(ensemble.state),
        time=_place(ensemble.time),
        step=_place(ensemble.step),
        next=_place(ensemble.next),
        steps=_place(ensemble.steps),
        rejected=_place(ensemble.rejected),
        status=_place(ensemble.status),
        parameters=_place(parameters),
        parameters_stride=0 if parameters.ndim == 1 else members,
        knots=_place(inputs.knots),
        inputs=_place(inputs.values),
        slopes=_place(inputs.slopes),
        pieces=inputs.pieces,
        inputs_stride=members if inputs.own else 0,
        samples=_place(ensemble.samples),
        sample_count=len(ensemble.samples),
        out=None if ensemble.out is None else _place(ensemble.out),
        rtol=ensemble.rtol,
        atol=ensemble.atol,
        size=ensemble.size,
        max_steps=ensemble.max_steps,
        late=None if ensemble.late is None else _place(ensemble.late),
        **further,
    )


def _place(array: NDArray[Any]) -> int:
    """Where an array begins; `ctypes.data` takes three times as long."""
    assert array.flags.c_contiguous
    if array.size and array.flags.writeable:
        return ctypes.addressof(ctypes.c_char.from_buffer(array.data))
    return array.ctypes.data
