"""Steps of families: the steps of a generated ``solver.c``, made for a twin in NumPy.

Comes in: a System of equal members and a choice. Goes out: who advances an `Ensemble`. Times,
samples and what is recorded are the twin's affair; C makes what takes time, with the same bits: all
steps of a fixed length up to the next sample, and the stages of a step that follows tolerances.
What is not finite is left to the twin, which says so.
Read next: `coadjoint.solve.twins`.
"""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, CrossCheckError
from coadjoint.lower.tableau import STAGES
from coadjoint.render.targets.c.loader import FLAGS
from coadjoint.solve.ensemble import Ensemble, Inputs, Status
from coadjoint.solve.kernels import say_once
from coadjoint.solve.runge_kutta import DormandPrince8
from coadjoint.solve.twins import StepwiseStepper

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.choices import Choice
    from coadjoint.solve.ensemble import Record
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.steps import Lanes, Method
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]

#: Numbers that one call of C works on, about: it ends within a tenth of a second.
CALL: Final = 1 << 24
#: States that the work has room for.
ROOM: Final = {"rk4": 5, "dop853": STAGES + 2}
_SIZE, _PLACE, _DOUBLE = ctypes.c_size_t, ctypes.c_void_p, ctypes.c_double


#: ``NAME_solver_run`` of the header, field by field, after the functions that it calls.
_FIELDS: Final = (
    ("rows", _SIZE),
    ("count", _SIZE),
    ("parameters", _PLACE),
    ("parameters_stride", _SIZE),
    ("sizes", _PLACE),
    ("state", _PLACE),
    ("work", _PLACE),
    ("step", _DOUBLE),
    ("steps", _SIZE),
    ("rtol", _DOUBLE),
    ("atol", _DOUBLE),
    ("five", _DOUBLE),
    ("three", _DOUBLE),
)


class _Run(ctypes.Structure):
    """``NAME_solver_run`` of a system."""

    _fields_ = (("rates", _PLACE), *_FIELDS)


class _TurningRun(ctypes.Structure):
    """The same of a system with attitudes."""

    _fields_ = (("rates", _PLACE), ("projection", _PLACE), *_FIELDS)


class FamilyStepper(StepwiseStepper):
    """Steps of a family in C.

    Args:
        system: Whose steps they are.
        choice: ``rk4`` or ``dop853``.
        target: ``"c"`` or ``"c-fast"``: who computes the rates. The steps have no fused operations.
        library: The object of the solver.
    """

    def __init__(self, system: System, choice: Choice, target: str, library: Library) -> None:
        super().__init__(system, choice, target, None)
        self._called = {"rates": system._kernels.find(target, "rhs")}
        if "projection" in system.functions:
            self._called["projection"] = system._kernels.find(target, "projection")
        self._march = library.take("solver_march")
        self._try = library.take("solver_try") if choice.name == "dop853" else None
        self.library, self._members = library, system.fixed["sizes"]
        self._work = np.empty(0)

    def advance(
        self, ensemble: Ensemble, first: int, last: int, work: int, record: Record | None = None
    ) -> int:
        """As `Stepper.advance`."""
        members = slice(first, last)
        while work > 0:
            made = 0
            if record is None and ensemble.size > 0 and work > 1:
                made = self._sweep(ensemble, members, work - 1)
            going = super().advance(ensemble, first, last, 1, record)
            work -= made + 1
            if not going or (record is not None and len(record.rows) - record.count < going):
                return going
        return int((ensemble.status[members] == Status.GOES_ON).sum())

    def _sweep(self, run: Ensemble, members: slice, most: int) -> int:
        """Steps of all members up to the last before a sample or an end; how many were made."""
        time, following = run.time[members], run.next[members]
        same = (time == time[0]).all() and (following == following[0]).all()
        if not same or (run.status[members] != Status.GOES_ON).any():
            return 0
        state = np.ascontiguousarray(run.state[:, members])
        most = min(
            most, max(1, CALL // state.size), run.max_steps - int(run.steps[members].max()) - 1
        )
        steps, end = _count_steps(float(time[0]), run.size, float(run.samples[following[0]]), most)
        if steps < 1:
            return 0
        state = state.copy() if state is run.state or state.base is run.state else state
        self._call(self._march, run, state, members, run.size, steps)
        if not np.isfinite(state).all():
            return 0
        run.state[:, members] = state
        run.time[members] = end
        run.steps[members] += np.uint64(steps)
        return steps

    def _call(
        self, function: Any, run: Ensemble, state: Array, members: slice, step: float, steps: int
    ) -> Any:
        """Call a function of the solver for a state, which it may write to."""
        size = ROOM[self._choice.name] * state.size
        if self._work.size < size:
            self._work = np.empty(size)
        parameters = run.parameters
        if parameters.ndim > 1:
            parameters = np.ascontiguousarray(parameters[:, members])
        given = (_TurningRun if "projection" in self._called else _Run)(
            **self._called,
            rows=len(state),
            count=state.shape[1],
            parameters=parameters.ctypes.data,
            parameters_stride=0 if parameters.ndim == 1 else state.shape[1],
            sizes=self._members.ctypes.data,
            state=state.ctypes.data,
            work=self._work.ctypes.data,
            step=step,
            steps=steps,
            rtol=run.rtol,
            atol=run.atol,
        )
        function(ctypes.byref(given))
        return given

    def _method(self, run: Ensemble) -> Method:
        """The method, of which C makes the stages for one trajectory."""
        if self._try is None or run.state.shape[1] != 1 or run.size > 0:
            return super()._method(run)
        return _Stages(self, run)


class _Stages(DormandPrince8):
    """DOP853 for one trajectory with stages in C; see `DormandPrince8`."""

    def __init__(self, stepper: FamilyStepper, run: Ensemble) -> None:
        super().__init__(stepper._rates, run.rtol, run.atol, run.size, branches=True)
        self._stepper, self._run = stepper, run
        self._errors = 0.0, 0.0

    def _find_stages(self, lanes: Lanes, h: Array) -> tuple[list[Array], Array]:
        """As `DormandPrince8` does."""
        stepper, state = self._stepper, np.ascontiguousarray(lanes.state)
        made = stepper._call(stepper._try, self._run, state, slice(None), float(h[0]), 1)
        self._errors = made.five, made.three
        rows = stepper._work[: (STAGES + 1) * state.size].reshape(STAGES + 1, *state.shape)
        return list(rows[:STAGES]), rows[STAGES].copy()

    def _find_errors(self, lanes: Lanes, k: list[Array], end: Array) -> tuple[Array, Array]:
        """As `DormandPrince8` does, of the stages that were made last."""
        five, three = self._errors
        return np.array([five]), np.array([three])


def _count_steps(time: float, size: float, until: float, most: int) -> tuple[int, float]:
    """Steps that end before a time, the last of them left out, and when they end."""
    steps = 0
    while steps < most and until - time >= 2.0 * size * 1.000001:
        time, steps = time + size, steps + 1
    return steps, time


def load(system: FamilySystem, choice: Choice, target: str) -> FamilyStepper:
    """The steps of a family in C: what is missing or wrong is an error.

    Raises:
        CompilerError: It cannot be compiled.
        CrossCheckError: It differs from the twin.
    """

    def verify(library: Library) -> None:
        compare_steps(system, choice, target, library)

    given = (system.folder, system.name, system.id, "exact", verify, choice.source)
    return FamilyStepper(system, choice, target, load_library(*given))


def compare_steps(system: FamilySystem, choice: Choice, target: str, library: Library) -> None:
    """A fresh object makes the steps of the twin, bit for bit: both ask one kernel for rates.

    Raises:
        CrossCheckError: It does not.
    """
    sized = system.resize({system.index.name: system.small + 6})
    fresh, twin = (
        FamilyStepper(sized, choice, target, library),
        StepwiseStepper(sized, choice, target, None),
    )
    lengths = [(3, 2.0**-7), *([(1, 0.0)] if choice.name == "dop853" else [])]
    for members, step in lengths:
        found, expected = (_probe(sized, members, step) for _ in range(2))
        fresh.advance(found, 0, members, 12)
        twin.advance(expected, 0, members, 12)
        for name in ("state", "time", "step", "steps", "status"):
            if not np.array_equal(getattr(found, name), getattr(expected, name), equal_nan=True):
                raise CrossCheckError(
                    f"a wrong solver was compiled: {choice} of {system.name}, solver.c, differs "
                    "from its NumPy twin. Set CC to another compiler, or run `coadjoint "
                    "crosscheck` to see whether the files are at fault.",
                    rung=5,
                    system=system.name,
                    target=target,
                )


def _probe(system: FamilySystem, members: int, step: float) -> Ensemble:
    """A few trajectories at the start of twelve steps, with two samples on the way."""
    source = np.random.default_rng(0)
    end = 12 * (step or 2.0**-7)
    state = source.uniform(0.5, 2.0, (system.STATE.size, members))
    if "projection" in system.functions:  # far from rotations it leads away
        near = [
            quantity.default or (0.0,) * len(quantity.components)
            for quantity in system.STATE.values()
        ]
        state = np.concatenate(near)[:, None] + 0.01 * state
    run = Ensemble(
        state=state,
        parameters=source.uniform(0.5, 2.0, system.PARAMETERS.size),
        inputs=Inputs(np.zeros(1), np.zeros((0, 1)), np.zeros((0, 1))),
        has_time=False,
        samples=np.array([0.0, 0.55 * end, end]),
        out=np.zeros((system.STATE.size, members, 3)),
        rtol=1e-9,
        atol=1e-12,
        size=step,
        max_steps=1000,
    )
    run.begin(0.0)
    return run


def find_stepper(system: FamilySystem, choice: Choice, target: str) -> StepwiseStepper:
    """Who makes the steps of a family: C, or its twin where that is asked for or C fails."""
    if target in FLAGS:
        try:
            return load(system, choice, target)
        except (CompilerError, CrossCheckError) as error:
            advice = HOW_TO_GET_ONE if isinstance(error, CompilerError) else ""
            say_once(f"{error} The NumPy steps are used instead. {advice}".rstrip())
    return StepwiseStepper(system, choice, target, None)
