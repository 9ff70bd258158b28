"""The solvers of a System, one for each method, order and target, loaded when first asked for.

Comes in: an `Ensemble`. Goes out: the same further on, advanced by the generated ``solver.c``, or
by its NumPy twin where that is asked for or no compiler is there. A fresh object is compared with
the twin before it is used.
Read next: `coadjoint.solve.march`, which shares an ensemble among threads.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from coadjoint.build.compiler import HOW_TO_GET_ONE
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, CrossCheckError
from coadjoint.render.targets.c.loader import FLAGS
from coadjoint.solve.comparison import compare_steps
from coadjoint.solve.ensemble import Ensemble, Record
from coadjoint.solve.kernels import say_once
from coadjoint.solve.twins import NumpyStepper

if TYPE_CHECKING:
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.system import System


class Stepper(Protocol):
    """Whoever advances members of an ensemble.

    Attributes:
        degree: Of the polynomials that are recorded.
    """

    degree: int

    @property
    def key(self) -> str:
        """What its bits depend on beyond the files of the system."""
        ...

    def advance(
        self, ensemble: Ensemble, first: int, last: int, work: int, record: Record | None = None
    ) -> int:
        """Go on with the members ``first <= n < last``, by at most ``work`` steps of a block.

        Steps that are accepted are added to a record; the call ends when it is full.

        Returns:
            How many of them still go on.
        """
        ...


class Solvers:
    """The solvers of one System."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._loaded: dict[tuple[Choice, str], Stepper] = {}

    def get(self, choice: Choice, target: str) -> Stepper:
        """The solver of a method; its NumPy twin, which is said, where a compiler cannot make it.

        Args:
            choice: The method.
            target: ``"c"``, ``"c-fast"`` or ``"numpy"``.
        """
        if (choice, target) not in self._loaded:
            self._loaded[choice, target] = self._find(choice, target)
        return self._loaded[choice, target]

    def _find(self, choice: Choice, target: str) -> Stepper:
        twin = NumpyStepper(self.system, choice)
        if target == "numpy":
            return twin
        try:
            return load(self.system, choice, target)
        except (CompilerError, CrossCheckError) as error:
            advice = HOW_TO_GET_ONE if isinstance(error, CompilerError) else ""
            say_once(f"{error} The NumPy solvers are used instead. {advice}".rstrip())
            return twin


def load(system: System, choice: Choice, target: str) -> CStepper:
    """The C solver of a method itself: what is missing or wrong is an error.

    Args:
        system: Whose solver it is.
        choice: The method.
        target: ``"c"`` or ``"c-fast"``.

    Raises:
        CompilerError: It cannot be compiled.
        CrossCheckError: It differs from its NumPy twin.
        OutputError: A file of it cannot be read.
    """

    def verify(library: Library) -> None:
        fresh, twin = CStepper(library, choice), NumpyStepper(system, choice)
        compare_steps(system, choice, target, fresh, twin)

    build, source = FLAGS[target], choice.source
    library = load_library(system.folder, system.name, system.id, build, verify, source)
    return CStepper(library, choice)


# -- C ------------------------------------------------------------------------------------------

_SIZE, _PLACE, _DOUBLE = ctypes.c_size_t, ctypes.c_void_p, ctypes.c_double


class _Run(ctypes.Structure):
    """``NAME_run`` of the headers, field by field."""

    _fields_ = (
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
    )


class CStepper:
    """A solver in C.

    Args:
        library: Its object.
        choice: The method.
    """

    def __init__(self, library: Library, choice: Choice) -> None:
        self.source, self.key, self.degree = library.source, library.key, choice.degree
        self._advance = library.take(choice.kind.advance)

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
    if record is None:
        return advance(ctypes.byref(run))
    run.record, run.record_room = record.rows.ctypes.data, len(record.rows)
    run.recorded = record.count
    on = advance(ctypes.byref(run))
    record.count = run.recorded
    return on


def _describe(ensemble: Ensemble) -> _Run:
    """The arrays of an ensemble, as C takes them; it has to live as long as the result."""
    members, inputs = ensemble.state.shape[1], ensemble.inputs
    names = ("state", "time", "step", "next", "steps", "rejected", "status")
    arrays = {name: getattr(ensemble, name) for name in names}
    arrays |= {"parameters": ensemble.parameters, "samples": ensemble.samples}
    arrays |= {"knots": inputs.knots, "inputs": inputs.values, "slopes": inputs.slopes}
    assert all(array.flags.c_contiguous for array in arrays.values())
    return _Run(
        members=members,
        parameters_stride=0 if ensemble.parameters.ndim == 1 else members,
        pieces=inputs.pieces,
        inputs_stride=members if inputs.own else 0,
        sample_count=len(ensemble.samples),
        out=None if ensemble.out is None else ensemble.out.ctypes.data,
        rtol=ensemble.rtol,
        atol=ensemble.atol,
        size=ensemble.size,
        max_steps=ensemble.max_steps,
        **{name: array.ctypes.data for name, array in arrays.items()},
    )
