"""Steps of families: the steps of a generated ``solver.c``, made for a twin in NumPy.

Comes in: a System of equal members and a choice. Goes out: who advances an `Ensemble`, with the
bits of the twin. Steps that are recorded are led by the twin; C makes their series, or their stages
for one trajectory.
Read next: `coadjoint.solve.twins`.
"""

from __future__ import annotations

import ctypes
import threading
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE
from coadjoint.build.library import Library, load_library
from coadjoint.errors import CompilerError, CrossCheckError, KinkWarning
from coadjoint.lower.compositions import list_schedules
from coadjoint.lower.tableau import STAGES
from coadjoint.methods import ACTION, MAPPED, STRUCTURED
from coadjoint.render.targets.c.loader import FLAGS
from coadjoint.render.targets.protocol import Call
from coadjoint.sizes import SHARE, find_memory
from coadjoint.solve.ensemble import MET, Ensemble
from coadjoint.solve.family_comparison import compare_steps, find_probed, list_left
from coadjoint.solve.kernels import say_once
from coadjoint.solve.methods.bands import Bands
from coadjoint.solve.methods.sequence import Maps
from coadjoint.solve.methods.structured import Structured
from coadjoint.solve.runge_kutta import DormandPrince8
from coadjoint.solve.twins import StepwiseStepper

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.driving import Function
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.methods.sequence import Part
    from coadjoint.solve.step_records import Record
    from coadjoint.solve.steps import Lanes, Method

#: Numbers that a first call works on, about: it ends within some hundredths of a second.
FIRST_NUMBERS: Final = 1 << 14
#: What the objects of methods have in addition to what all have.
FUNCTIONS: Final = {
    "rk4": (),
    "dop853": ("try",),
    "taylor": ("expand", "room"),
    "heun": (),
    "midpoint": (),
}
#: Arrays of an ensemble that are handed over.
ARRAYS: Final = ("state", "time", "step", "next", "steps", "rejected", "status", "parameters")
#: Bytes of series of pairs of one trajectory beyond which ``dop853`` is faster:
#: docs/decisions/family-kernels.md.
KEPT_NEAR: Final = 1 << 17
#: Kinks of which a call can tell: so many steps that meet all of them, and further ones.
KINK_ROOM, MET_ROOM = 8, 1 << 12
_SIZE, _PLACE, _DOUBLE = ctypes.c_size_t, ctypes.c_void_p, ctypes.c_double


#: ``NAME_solver_run`` of the header, field by field, after the functions that it calls.
_RUN: Final = (
    ("rows", _SIZE),
    ("count", _SIZE),
    ("parameters", _PLACE),
    ("parameters_stride", _SIZE),
    ("sizes", _PLACE),
    ("state", _PLACE),
    ("work", _PLACE),
    ("step", _DOUBLE),
    ("rtol", _DOUBLE),
    ("atol", _DOUBLE),
    ("five", _DOUBLE),
    ("three", _DOUBLE),
    ("path", _PLACE),
    ("path_row", _SIZE),
    ("path_order", _SIZE),
)
#: What it has in addition where inputs or the time drive the members.
_DRIVEN_RUN: Final = (
    ("driving_rows", _SIZE),
    ("driving", _PLACE),
    ("slopes", _PLACE),
    ("now", _PLACE),
)
#: And where there are kinks.
_SIDED_RUN: Final = (("joined", _PLACE),)
#: ``NAME_solver_ensemble``, likewise.
_ENSEMBLE: Final = (
    ("sizes", _PLACE),
    *((name, _SIZE) for name in ("rows", "parameter_rows", "members", "first", "last")),
    *((name, _PLACE) for name in ("state", "time", "step", "next", "steps", "rejected")),
    ("status", _PLACE),
    ("parameters", _PLACE),
    ("parameters_stride", _SIZE),
    ("samples", _PLACE),
    ("sample_count", _SIZE),
    ("out", _PLACE),
    *((name, _DOUBLE) for name in ("rtol", "atol", "size")),
    ("max_steps", _SIZE),
    ("work", _SIZE),
    ("scratch", _PLACE),
    ("memory", _PLACE),
    ("sweeps", _PLACE),
)
#: What moves members with noise.
_NOISE: Final = (("processes", _SIZE), ("seed", ctypes.c_uint64), ("bound", _DOUBLE))
#: Likewise, and the lines of inputs.
_DRIVEN: Final = (("driving_rows", _SIZE),)
_KINKED: Final = (
    *((name, _PLACE) for name in ("crossed", "brief", "met")),
    *((name, _SIZE) for name in ("met_room", "met_count")),
)
_INPUTS: Final = (
    *((name, _PLACE) for name in ("knots", "inputs", "input_slopes")),
    ("pieces", _SIZE),
    ("inputs_stride", _SIZE),
)


def _make_structure(called: tuple[str, ...], fields: Any) -> type[ctypes.Structure]:
    """A structure of the header that begins with the functions of the kernel that are called."""
    functions = ((name, _PLACE) for name in called)
    return type("_Given", (ctypes.Structure,), {"_fields_": (*functions, *fields)})


class FamilyTwin(StepwiseStepper):
    """Steps of a family in NumPy, with the kernel of a target.

    Args:
        system: Whose steps they are.
        choice: A generated method.
        target: Who computes the rates.
        inputs: Inputs as a function of time; None where they are lines, as in every ensemble.
    """

    def __init__(
        self, system: FamilySystem, choice: Choice, target: str, inputs: Function | None = None
    ) -> None:
        super().__init__(system, choice, target, inputs)
        self._members, self._family = system.fixed["sizes"], system
        #: Rows of inputs, and the time below them.
        self.driving_rows = system.INPUTS.size + system.TIME.size
        #: Which rates are integrated: those of given signs where there are kinks.
        self._rates_name = "sided_rhs" if "kinks" in system.functions else "rhs"
        if "kinks" in system.functions:
            self._sizes |= {n: system.rows(n).size for n in ("kinks", "sided_rhs")}
            kinks, branches = (
                partial(self._evaluate, ("kinks",)),
                bool(system.series.value("BRANCHES")),
            )
            self._limits = replace(self._limits, kinks=kinks, rates=self._rates, branches=branches)
        #: The flows of which steps of splittings are products; without any these are shifts.
        self._flows = tuple(name for name in system.functions if name.startswith("flow"))
        if choice.name == "taylor":
            module = system.series
            self._series = module.function("expand")
            self._branches = bool(module.value("BRANCHES"))

    @property
    def _noise(self) -> dict[str, Any]:
        """As `NumpyStepper` has it: of equal members all processes act together."""
        return {
            "along": partial(self._evaluate, ("noise_vector",)),
            "processes": self._family.NOISE.size,
        }

    def _rates(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The rates, on the sides of the step where there are kinks."""
        if lanes.sides is not None:
            state = np.concatenate([state, lanes.sides])
        return self._evaluate((self._rates_name,), lanes, after, state)

    def _method(self, run: Ensemble) -> Method:
        """As `NumpyStepper` does; rates are the bracket with the energy.

        Flows are functions of the kernel, or shifts.
        """
        choice, family = self._choice, self._family
        if choice.is_structured:
            spheres = [(tuple(family.rows_of(rows)),) for rows in family.spheres.values()]
            functions: dict[str, Any] = {"rates": self._rates, "field": self._rates}
            functions |= {"spheres": spheres, "bracket": self._bracket, "sandwich": self._sandwich}
            functions["gradient"] = partial(self._evaluate, ("energy_gradient",))
            functions["energy"] = partial(self._evaluate, ("energy",))
            functions["members"] = family.size
            if choice.newton and family.series.has("BANDS"):
                reach, wraps = family.series.value("BANDS")
                functions["bands"] = Bands(family.size, reach, bool(wraps))
            return Structured(
                choice.name,
                run.size,
                {**functions, "along": self._along},
                branches=self._branches,
                newton=choice.newton,
            )
        if choice.name in MAPPED and self._flows:
            all_rows = (slice(family.STATE.size),)
            maps: list[Part] = [
                (partial(self._flow, flow), h, all_rows)
                for flow, h in list_schedules(self._flows)[choice.name]
            ]
            return Maps(maps, self._rates, run.size, is_compensated=True, branches=self._branches)
        if choice.name in MAPPED:
            count = len(family.STATE.components) // family.size
            moving = set(family.positions), set(range(count)).difference(family.positions)
            flows = {
                f"flow{n}": tuple(family.rows_of(sorted(own))) for n, own in enumerate(moving, 1)
            }
            steps = [
                (self._shift, h, flows[flow]) for flow, h in list_schedules(flows)[choice.name]
            ]
            return Maps(steps, self._rates, run.size, is_compensated=True, branches=self._branches)
        return super()._method(run)

    def _along(self, lanes: Lanes, after: Array, state: Array, vector: Array) -> Array:
        """The derivative of the rates along a vector."""
        return self._evaluate(("jacobian_vector",), lanes, after, np.concatenate([state, vector]))

    def _flow(self, name: str, state: Array, parameters: Array, after: Array) -> Array:
        """What the flow of a part of the energy adds to a state."""
        joined, given = np.concatenate([state, after[None]]), np.ascontiguousarray(parameters)
        call = Call(joined, given, np.empty(state.shape), {"sizes": self._members})
        return np.asarray(self._find_values(name, call))

    def _shift(self, state: Array, parameters: Array, after: Array) -> Array:
        """What a flow adds to the rows that it moves, by their rates, which the others decide."""
        there, given = map(np.ascontiguousarray, (state, parameters))
        call = Call(there, given, np.empty(state.shape), {"sizes": self._members})
        return np.asarray(after * self._find_values("rhs", call))

    def _expand(self, lanes: Lanes, order: int) -> Array:
        """Coefficients of the motion."""
        driven = (lanes.driving, lanes.slopes) if self.driving_rows else ()
        given = (lanes.state, lanes.given, *driven, self._members)
        path: Array = self._series(*given, order)
        return path


class FamilyStepper(FamilyTwin):
    """Steps of a family in C.

    Args:
        system: Whose steps they are.
        choice: A generated method.
        target: ``"c"`` or ``"c-fast"``: who computes the rates. The steps have no fused operations.
        library: The object of the solver.
    """

    def __init__(self, system: FamilySystem, choice: Choice, target: str, library: Library) -> None:
        super().__init__(system, choice, target)
        last = "sandwich" if "sandwich" in system.functions else "energy"
        acting = (*ACTION, last) if {*ACTION} <= system.functions.keys() else ()
        others = ("projection", "noise_vector", "kinks", *acting, *self._flows)
        called = {"rates": self._rates_name}
        called |= {n: n for n in others if n in system.functions}
        self._called = {n: system._kernels.find(target, of) for n, of in called.items()}
        self._vector = system._kernels.find(target, "jacobian_vector") if choice.newton else None
        is_driven, has_inputs = bool(self.driving_rows), bool(system.INPUTS)
        has_kinks = self._limits.kinks is not None
        parts = (*_RUN, *_DRIVEN_RUN * is_driven, *_SIDED_RUN * has_kinks)
        self._run_type = _make_structure(tuple(called), parts)
        has_noise = bool(system.NOISE)
        is_implicit = not has_noise and any(each.name in STRUCTURED for each in system.METHODS)
        fields: tuple[Any, ...] = (
            *_ENSEMBLE,
            *_DRIVEN * is_driven,
            *_INPUTS * has_inputs,
            *_NOISE * has_noise,
            *_KINKED * has_kinks,
        )
        fields += (("along", _PLACE),) * is_implicit
        self._ensemble_type = _make_structure(tuple(called), fields)
        names = ("advance", "work", *FUNCTIONS.get(choice.name, ()))
        self._functions = {name: library.take(f"solver_{name}") for name in names}
        self.library, self._own = library, threading.local()
        self.first_work = max(1, FIRST_NUMBERS // system.STATE.size)

    def advance(
        self, ensemble: Ensemble, first: int, last: int, work: int, record: Record | None = None
    ) -> int:
        """As `Stepper.advance`; the twin leads steps that are recorded."""
        if record is not None:
            return super().advance(ensemble, first, last, work, record)
        given = self._describe(ensemble, first, last)
        given.work = work
        given.scratch = self._provide(self._functions["work"](ctypes.byref(given)))
        met = np.empty((ensemble.sides * KINK_ROOM + MET_ROOM * bool(ensemble.sides), MET))
        if ensemble.sides:
            given.met, given.met_room = met.ctypes.data, len(met)
        on = self._functions["advance"](ctypes.byref(given))
        if ensemble.sides and given.met_count:
            ensemble.met.append(met[: given.met_count].copy())
        return int(on)

    def _describe(self, run: Ensemble, first: int, last: int) -> Any:
        """The arrays of an ensemble, as C takes them; it has to live as long as the result."""
        given = self._ensemble_type(
            **self._called,
            sizes=self._members.ctypes.data,
            rows=len(run.state),
            parameter_rows=len(run.parameters),
            members=run.state.shape[1],
            first=first,
            last=last,
            parameters_stride=0 if run.parameters.ndim == 1 else run.state.shape[1],
            samples=run.samples.ctypes.data,
            sample_count=len(run.samples),
            out=None if run.out is None else run.out.ctypes.data,
            rtol=run.rtol,
            atol=run.atol,
            size=run.size,
            max_steps=run.max_steps,
        )
        if self._vector is not None:
            given.along = self._vector
        if self.driving_rows:
            given.driving_rows = self.driving_rows
        if self._family.NOISE:
            given.processes = self._family.NOISE.size
            given.seed, given.bound = run.seed, run.bound
        if len(run.inputs.values):
            given.pieces = run.inputs.pieces
            given.inputs_stride = run.inputs.values.shape[1] if run.inputs.own else 0
            lines = {"knots": run.inputs.knots, "inputs": run.inputs.values}
            for name, array in (lines | {"input_slopes": run.inputs.slopes}).items():
                assert array.flags.c_contiguous, name
                setattr(given, name, array.ctypes.data)
        if run.kinks is not None and run.brief is not None:
            given.crossed, given.brief = run.kinks.ctypes.data, run.brief.ctypes.data
        for name in (*ARRAYS, *list_left(run)):
            array = getattr(run, name)
            assert array.flags.c_contiguous, name
            setattr(given, name, array.ctypes.data)
        return given

    def _give(self, lanes: Lanes) -> Any:
        """What every function of the solver takes, from contiguous arrays that live meanwhile."""
        state, parameters = lanes.state, lanes.parameters
        given = self._run_type(
            **self._called,
            rows=len(state),
            count=state.shape[1],
            parameters=parameters.ctypes.data,
            parameters_stride=0 if parameters.ndim == 1 else state.shape[1],
            sizes=self._members.ctypes.data,
            state=state.ctypes.data,
        )
        if self.driving_rows:
            given.driving_rows = self.driving_rows
            given.driving, given.slopes = lanes.driving.ctypes.data, lanes.slopes.ctypes.data
        if lanes.sides is not None:
            lanes.joined = np.concatenate([state, lanes.sides])
            given.joined = lanes.joined.ctypes.data
        return given

    def _provide(self, size: int) -> int:
        """Where this thread has memory for so many numbers to work with."""
        room: Array | None = getattr(self._own, "room", None)
        if room is None or room.size < size:
            room = self._own.room = np.empty(size)
        return room.ctypes.data

    def _find_stages(self, run: Ensemble, lanes: Lanes, step: float) -> tuple[Any, Array]:
        """The stages of a step of one trajectory, and its end below them."""
        own = _make_contiguous(lanes)
        own.parameters = np.ascontiguousarray(run.parameters.reshape(len(run.parameters)))
        given = self._give(own)
        given.step, given.rtol, given.atol = step, run.rtol, run.atol
        rows, now = np.empty((STAGES + 2, *own.state.shape)), np.empty(self.driving_rows)
        given.work = rows.ctypes.data
        if self.driving_rows:
            given.now = now.ctypes.data
        self._functions["try"](ctypes.byref(given))
        return given, rows

    def _expand(self, lanes: Lanes, order: int) -> Array:
        """Coefficients of the motion."""
        own = _make_contiguous(lanes)
        path = np.empty((len(own.state), order + 1, own.state.shape[1]))
        given = self._give(own)
        given.path = path.ctypes.data
        given.work = self._provide(self._functions["room"](ctypes.byref(given)))
        self._functions["expand"](ctypes.byref(given))
        return path

    def _method(self, run: Ensemble) -> Method:
        """The method, of which C makes the stages for one trajectory."""
        if "try" not in self._functions or run.state.shape[1] != 1 or run.size > 0:
            return super()._method(run)
        return _Stages(self, run)


def _make_contiguous(lanes: Lanes) -> Lanes:
    """Lanes whose arrays C can read."""
    names = ("state", "parameters", "driving", "slopes")
    return replace(lanes, **{name: np.ascontiguousarray(getattr(lanes, name)) for name in names})


class _Stages(DormandPrince8):
    """DOP853 for one trajectory with stages in C; see `DormandPrince8`."""

    def __init__(self, stepper: FamilyStepper, run: Ensemble) -> None:
        super().__init__(stepper._rates, run.rtol, run.atol, run.size, branches=True)
        self._stepper, self._run = stepper, run
        self._errors = 0.0, 0.0

    def _find_stages(self, lanes: Lanes, h: Array) -> tuple[list[Array], Array]:
        """As `DormandPrince8` does."""
        made, rows = self._stepper._find_stages(self._run, lanes, float(h[0]))
        self._errors = made.five, made.three
        return list(rows[:STAGES]), rows[STAGES]

    def _find_errors(self, lanes: Lanes, k: list[Array], end: Array) -> tuple[Array, Array]:
        """As `DormandPrince8` does, of the stages that were made last."""
        five, three = self._errors
        return np.array([five]), np.array([three])


def load(system: FamilySystem, choice: Choice, target: str) -> FamilyStepper:
    """The steps of a family in C: what is missing or wrong is an error.

    Raises:
        CompilerError: It cannot be compiled.
        CrossCheckError: It differs from the twin.
    """

    def verify(library: Library) -> None:
        compare(system, choice, target, library)

    source = choice.source.at(system.levels, "exact")
    given = (system.folder, system.name, system.id, "exact", verify, source)
    return FamilyStepper(system, choice, target, load_library(*given))


def compare(system: FamilySystem, choice: Choice, target: str, library: Library) -> None:
    """A fresh object makes the steps of the twin, for a few members.

    Raises:
        CrossCheckError: It does not.
    """
    few = find_probed(system)
    fresh, twin = FamilyStepper(few, choice, target, library), FamilyTwin(few, choice, target)
    compare_steps(few, choice, target, fresh, twin)


def tell_series_obstacle(system: FamilySystem, order: int, members: int, *, is_auto: bool) -> str:
    """Why the method of Taylor does not apply to a family, as a clause; "" where it does.

    Args:
        system: The family.
        order: Of the method.
        members: How many trajectories there are.
        is_auto: Whether it does not apply either where ``dop853`` is faster.
    """
    if not (system.folder / "solver.py").is_file():
        return "its folder was generated without series: run `coadjoint regenerate`"
    if system.series.has("SOLVES"):
        return "it needs rates of all orders, and these contain the solution of a linear equation"
    own, pairs = system.count_series(order, members)
    most = SHARE * find_memory()
    if own + pairs > most:
        return (
            f"its series of {system.size} members {system.index.name} take "
            f"{(own + pairs) / 1e9:.1f} GB, and at most {most / 1e9:.1f} GB are taken"
        )
    if is_auto and system.count_series(order, 1)[1] > KEPT_NEAR:
        return "dop853 is faster for so many pairs"
    return ""


def find_stepper(
    system: FamilySystem, choice: Choice, target: str, inputs: Function | None = None
) -> FamilyTwin:
    """Who makes the steps of a family: C, or its twin where that is asked for or C fails.

    Args:
        system: The family.
        choice: A generated method.
        target: Who computes the rates.
        inputs: A function of Python, which only the twin can call.
    """
    if system.pair_kinks:
        say_once(
            f"steps of {system.name} do not end at the kinks of pairs of members, where "
            f"{' or '.join(system.pair_kinks)} is 0: they cross them with an error, and with fixed "
            "steps a method loses its order there. Take tolerances that fit the jump, or a sum "
            "that is smooth; or write few members out, with written_out = true in [index]: then "
            "steps end there.",
            category=KinkWarning,
        )
    if inputs is not None:
        return FamilyTwin(system, choice, target, inputs)
    if (choice, target) not in system.steppers:
        system.steppers[choice, target] = _find_stepper(system, choice, target)
    return system.steppers[choice, target]


def _find_stepper(system: FamilySystem, choice: Choice, target: str) -> FamilyTwin:
    """The same, of a system that has none yet."""
    if target in FLAGS:
        try:
            return load(system, choice, target)
        except (CompilerError, CrossCheckError) as error:
            advice = HOW_TO_GET_ONE if isinstance(error, CompilerError) else ""
            say_once(f"{error} The NumPy steps are used instead. {advice}".rstrip())
    return FamilyTwin(system, choice, target)
