"""Twins: the methods in NumPy over the functions of a kernel, for members of an ensemble.

Comes in: a System and a choice. Goes out: who advances an `Ensemble` by it: `NumpyStepper`, the
twin of a solver in C, or `StepwiseStepper`, which asks for inputs and rates at each stage.
Read next: `coadjoint.solve.steps`, the methods.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.build.compiler import compiler_version
from coadjoint.build.library import tell_processor
from coadjoint.methods import ASKED, JACOBIAN, MAPPED, Sphere
from coadjoint.render.targets.modules import KernelModule
from coadjoint.render.targets.numpy.loader import NumpyKernel
from coadjoint.render.targets.protocol import Call
from coadjoint.solve.limits import Limits
from coadjoint.solve.methods.sequence import Maps, make_maps
from coadjoint.solve.methods.structured import Structured
from coadjoint.solve.runge_kutta import DormandPrince8, RungeKutta4
from coadjoint.solve.steps import Taylor
from coadjoint.solve.stochastic import METHODS, Orbits

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.array_types import Array
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.driving import Function
    from coadjoint.solve.ensemble import Ensemble
    from coadjoint.solve.step_records import Record
    from coadjoint.solve.steps import Lanes, Method
    from coadjoint.solve.system import System


class NumpyStepper:
    """The twin of a solver.

    Args:
        system: Whose solver it is.
        choice: The method.

    Raises:
        OutputError: A file of it cannot be loaded.
    """

    first_work = 16
    #: Of how many numbers increments of noise are the sum: more than one compares lengths of steps.
    parts = 1

    def __init__(self, system: System, choice: Choice) -> None:
        self._system, self._choice, self.degree = system, choice, choice.degree
        self._kernel = NumpyKernel(system, "kernel.py")
        functions = (
            *choice.kind.rates,
            "domain",
            "projection",
            "noise",
            "noise_gradient",
            "noise_vector",
            JACOBIAN,
            "jacobian_vector",
            *ASKED,
        )
        self._sizes = {name: system.rows(name).size for name in functions}
        self._expansion, self._branches = None, bool(system.stepwise)
        spheres: tuple[Any, ...] = ()
        self._held, kinks, self._spheres, self._carriers = None, None, spheres, spheres
        if not system.stepwise:
            module = KernelModule(system, choice.kind.files[2])
            self._expansion = module.function("expand")
            self._branches = bool(module.value("BRANCHES"))
            if module.has("SPHERES"):
                self._spheres = module.value("SPHERES")
            if module.has("CARRIERS"):
                self._carriers = module.value("CARRIERS")
            if module.has("KINKS"):
                self._held = module.function("find_rates")
                kinks = partial(self._find_kinks, module.function("find_kinks"))
        self._limits = Limits(
            domain=partial(self._evaluate, ("domain",)) if system.DOMAIN else None,
            strict=tuple(bound.strict for bound in system.DOMAIN),
            projection=self._project if "projection" in system.functions else None,
            kinks=kinks,
            rates=self._rates if kinks is not None else None,
            branches=self._branches,
        )

    @property
    def key(self) -> str:
        """NumPy's own functions differ from one processor to another."""
        return f"numpy {np.__version__} {tell_processor()}"

    def advance(
        self, ensemble: Ensemble, first: int, last: int, work: int, record: Record | None = None
    ) -> int:
        """As `Stepper.advance`; a block is all of the members."""
        method, members = self._method(ensemble), slice(first, last)
        return ensemble.advance(method, work, members, self._limits, record)

    def _method(self, run: Ensemble) -> Method:
        """The method for the tolerances and the step of an ensemble."""
        if self._choice.name == "taylor":
            return Taylor(
                expand=self._expand,
                rates=self._rates,
                order=self._choice.order,
                rtol=run.rtol,
                atol=run.atol,
                size=run.size,
                branches=self._branches,
            )
        if self._choice.name == "dop853":
            return DormandPrince8(
                self._rates, run.rtol, run.atol, run.size, branches=self._branches
            )
        if self._choice.name == "rk4":
            return RungeKutta4(self._rates, run.size, branches=self._branches)
        if self._choice.name in MAPPED:
            module = KernelModule(self._system, self._choice.kind.files[2])
            maps = make_maps(module, self._choice.name)
            compensated = MAPPED[self._choice.name].parts > 0
            return Maps(
                maps,
                self._rates,
                run.size,
                is_compensated=compensated,
                branches=self._branches,
            )
        if self._choice.is_structured:
            functions: dict[str, Any] = {"rates": self._rates, "spheres": self._spheres}
            functions["carriers"] = self._carriers
            energy = partial(self._evaluate, ("energy",))
            functions |= {"gradient": self._element, "bracket": self._bracket, "energy": energy}
            functions |= {"sandwich": self._sandwich, "field": self._field}
            functions |= {"evaluate": self._evaluate, "metric": self._metric}
            functions["jacobian"] = self._slopes
            functions["known"] = self._system.STATE.size
            return Structured(
                self._choice.name,
                run.size,
                functions,
                branches=self._branches,
                newton=self._choice.newton,
            )
        return METHODS[self._choice.name](
            rates=self._rates,
            **self._noise,
            size=run.size,
            seed=run.seed,
            bound=run.bound,
            branches=self._branches,
            parts=self.parts,
            spheres=tuple(Sphere(*each) for each in self._spheres),
        )

    def _expand(self, lanes: Lanes, order: int) -> Array:
        """Coefficients of the motion."""
        assert self._expansion is not None, self._choice.name
        path: Array = self._expansion(lanes.state, lanes.given, lanes.driving, lanes.slopes, order)
        return path

    def _rates(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The rates of all that is integrated, on the sides of the step where there are kinks."""
        if self._held is not None:
            rates: Array = self._held(state, lanes.given, self._drive(lanes, after))
            return rates
        return self._evaluate(self._choice.kind.rates, lanes, after, state)

    def _element(self, lanes: Lanes, after: Array, middle: Array) -> Array:
        """The gradient of the energy, below it the middle where something is reconstructed."""
        found = self._evaluate(("energy_gradient",), lanes, after, middle)
        known = self._system.STATE.size
        return found if len(middle) == known else np.concatenate([found, middle[:known]])

    def _bracket(self, lanes: Lanes, after: Array, state: Array, element: Array) -> Array:
        """The Poisson tensor times a vector; an element moves what is reconstructed, too."""
        n = self._system.STATE.size
        both = np.concatenate([state[:n], element[:n]])
        turned = self._evaluate(("bracket_vector",), lanes, after, both)
        if len(state) == n:
            return turned
        rates = self._rates(lanes, after, np.concatenate([element[n:], state[n:]]))
        return np.concatenate([turned, rates[n:]])

    def _field(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The bracket with the energy."""
        return self._bracket(lanes, after, state, self._element(lanes, after, state))

    def _sandwich(self, lanes: Lanes, after: Array, state: Array, vector: Array) -> Array:
        """The product of matrices of a state and of a vector."""
        return self._evaluate(("sandwich",), lanes, after, np.concatenate([state, vector]))

    def _metric(self, lanes: Lanes, after: Array, state: Array, vector: Array) -> Array:
        """The matrix G of a metriplectic motion times a vector."""
        return self._evaluate(("metric_vector",), lanes, after, np.concatenate([state, vector]))

    def _slopes(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The derivatives of the rates by the state, without what is reconstructed."""
        return self._evaluate((JACOBIAN,), lanes, after, state)

    def _find_kinks(
        self, find: Callable[..., Array], lanes: Lanes, after: Array, state: Array
    ) -> Array:
        """What the sides of kinks are those of."""
        return find(state, lanes.parameters, self._drive(lanes, after))

    @property
    def _noise(self) -> dict[str, Any]:
        """What moves the state with noise, as methods for it take it."""
        slopes = partial(self._evaluate, ("noise_gradient",))
        orbits = Orbits(gradient=self._element, slopes=slopes, bracket=self._bracket)
        return {"fields": partial(self._evaluate, ("noise",)), "orbits": orbits}

    def _project(self, lanes: Lanes, after: Array, state: Array) -> Array:
        """The nearest states on the constraints; what is reconstructed stays."""
        nearest = self._evaluate(("projection",), lanes, after, state)
        return np.concatenate([nearest, state[len(nearest) :]])

    def _evaluate(
        self, functions: tuple[str, ...], lanes: Lanes, after: Array, state: Array
    ) -> Array:
        """Rows of functions of the kernel, one below the other, some time after the lanes."""
        driving, inputs = np.ascontiguousarray(self._drive(lanes, after)), self._system.INPUTS.size
        parameters = np.ascontiguousarray(lanes.parameters)  # as kernels in C read them
        named = {"inputs": driving[:inputs]} if inputs else {}
        if self._system.TIME:
            named["time"] = driving[inputs:]
        named |= self._system.fixed
        rows = []
        for name in functions:
            own = np.ascontiguousarray(state[: self._sizes[name]])
            block = np.empty((*self._system.functions[name], state.shape[1]))
            rows.append(self._find_values(name, Call(own, parameters, block, named)))
        if len(rows) == 1:
            return rows[0]
        return np.concatenate([each.reshape(-1, state.shape[1]) for each in rows])

    def _drive(self, lanes: Lanes, after: Array) -> Array:
        """Inputs, and the time below them."""
        return lanes.driving + after * lanes.slopes

    def _find_values(self, function: str, call: Call) -> Array:
        """What the kernel computes."""
        return self._kernel.values(function, call)


class StepwiseStepper(NumpyStepper):
    """Steps that are made in Python, each stage by a call of the kernel and of the inputs.

    For inputs that are a function of Python, which no compiled solver can call. It has the methods
    of Runge and Kutta: a Taylor series has all orders of the inputs, and a function tells their
    values alone.

    Args:
        system: The System.
        choice: A method other than that of Taylor.
        target: Who computes the rates.
        inputs: Inputs as a function of time; None where they are lines, as in every ensemble.
    """

    def __init__(
        self, system: System, choice: Choice, target: str, inputs: Function | None
    ) -> None:
        super().__init__(system, choice)
        self._target, self._inputs = target, inputs

    @property
    def key(self) -> str:
        """The functions of NumPy and of the target."""
        return f"{super().key} {self._target} {compiler_version()}"

    def _drive(self, lanes: Lanes, after: Array) -> Array:
        """As the function tells; it is asked once for each time, and for none beyond the end."""
        driving = super()._drive(lanes, after)
        if self._inputs is not None:
            time = np.minimum(lanes.time + after, lanes.end)
            time = np.where(np.isfinite(time), time, lanes.time)
            times, places = time, np.zeros(1, np.intp)
            if time.size > 1:
                times, places = np.unique(time, return_inverse=True)
            driving[: self._system.INPUTS.size] = self._inputs.over(times)[:, places]
        return driving

    def _find_values(self, function: str, call: Call) -> Array:
        """What the kernel of the target computes."""
        self._system._kernels.run(function, call, self._target)
        return call.block
