"""The System: one generated folder as an object, light to import and complete to use.

Comes in: the declarations in a generated ``__init__.py``. Goes out: functions of state and
parameters by the kernel of a target, and simulations. Only names are held here; arrays,
kernels and integrators load on first use, so that importing a system costs next to nothing.
Read next: `coadjoint.solve.arrays` for what may be passed, `coadjoint.solve.kernels` for who
computes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from coadjoint.declared import CLOCK, Bound, Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.files import read_certificate
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.methods import JudgedMethod
from coadjoint.solve.functions import Functions, Target, by_name
from coadjoint.solve.quantities import Quantities

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from coadjoint.families import Connection, PrincipalSymbol
    from coadjoint.solve.events import Event
    from coadjoint.solve.functions import Values
    from coadjoint.solve.kernels import Kernels
    from coadjoint.solve.ode import Ode
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.solvers import Solvers

    Array = NDArray[Any]

__all__ = ["Bound", "Quantities", "Quantity", "System"]


class System(Functions):
    """A mechanical system with verified kernels.

    All functions are vectorised: a state has shape ``(n,)`` for one member or ``(n, *batch)``, and
    the result has the shape of the function for one member followed by ``batch``.

    Attributes:
        name: Name of the system.
        folder: Where its generated files stand.
        STATE: Quantities of the state, in order.
        PARAMETERS: Quantities of the parameters, in order.
        OBSERVABLES: Quantities of the observables, in order.
        functions: Shape of the result of each function for one member.
        elementary: Functions beyond ``+ - * / sqrt`` that the kernels call.
        id: The id that all files of the folder carry.
        DOMAIN: What the rows of `domain` are; empty where the system is defined everywhere.
        RECONSTRUCTED: What follows from the motion without acting on it, in order.
        RECONSTRUCTED_OBSERVABLES: Quantities of the observables that name what is reconstructed.
        INPUTS: Quantities of the inputs, in order; empty where the system has none.
        TIME: The time, if the system depends on it.
        unit_of_time: The unit of the time, also where the system does not depend on it.
        clock: Symbol and name of the independent variable: the time, or what is in its place.
        written: The index of members that are all written out, and their number; else None.
        METHODS: Methods that keep structure, with what each keeps of this system.
        levels: How much compilers optimise, by stem and build, where that is less than they can;
            see `coadjoint.build.source.Source`.
        wave: Of a field whose waves break, their speed and the name of the length; see
            `coadjoint.solve.shocks`.
        connections: What has transports and a holonomy around a circle; none of most systems.
        symbol: The principal symbol of fields; None of other systems.
    """

    connections: tuple[Connection, ...] = ()
    symbol: PrincipalSymbol | None = None
    levels: Mapping[tuple[str, str], int] = MappingProxyType({})
    wave: tuple[str, ...] = ()

    def __init__(
        self,
        name: str,
        file: str,
        state: Quantities,
        parameters: Quantities,
        observables: Quantities,
        functions: Mapping[str, tuple[int, ...]],
        elementary: Sequence[str],
        identity: str,
        domain: Sequence[Bound] = (),
        reconstructed: Quantities | None = None,
        inputs: Quantities | None = None,
        time: Quantities | None = None,
        unit_of_time: str = "s",
        clock: tuple[str, str] = CLOCK,
        written: tuple[str, int] | None = None,
        methods: Sequence[JudgedMethod] = (),
        reconstructed_observables: Quantities | None = None,
    ) -> None:
        self.name = name
        self.written, self.METHODS = written, tuple(methods)
        self.folder = Path(file).parent
        self.STATE = state
        self.PARAMETERS = parameters
        self.OBSERVABLES = observables
        self.functions: Mapping[str, tuple[int, ...]] = MappingProxyType(dict(functions))
        self.elementary = tuple(elementary)
        self.id = identity
        self.DOMAIN = tuple(domain)
        self.RECONSTRUCTED = Quantities() if reconstructed is None else reconstructed
        self.RECONSTRUCTED_OBSERVABLES = reconstructed_observables or Quantities()
        self.INPUTS = Quantities() if inputs is None else inputs
        self.TIME = Quantities() if time is None else time
        self.unit_of_time, self.clock = unit_of_time, clock

    def resize(self, sizes: Mapping[str, int]) -> System:
        """The system with another number of members, by the name of their index.

        Raises:
            KernelArgumentError: It has no index, or its kernels are those of one number.
        """
        expected, way = "none", "Leave sizes out, or declare [index] in the spec."
        problem = "it has no index"
        if self.written is not None:
            index, size = self.written
            if dict(sizes) == {index: size}:
                return self
            problem, expected = "its members are all written out", f"{{{index!r}: {size}}}"
            way = f"Load its spec with them: coadjoint.load(path, sizes={dict(sizes)!r})."
        raise KernelArgumentError(
            f"sizes of {self.name} are {dict(sizes)!r}, and {problem}; expected {expected}. {way}",
            found=list(sizes),
        )

    @property
    def column_of_time(self) -> str:
        """The name of the independent variable in tables: ``time``, or the symbol of another."""
        symbol, label = self.clock
        return label if label == CLOCK[1] else symbol

    @property
    def names_of_time(self) -> tuple[str, ...]:
        """The names by which solutions know the independent variable."""
        return tuple(dict.fromkeys((*CLOCK, self.column_of_time)))

    @property
    def lengths(self) -> dict[str, str]:
        """The parameters that are lengths of space, by the coordinates of fields; none without."""
        return {}

    def find_coordinates(self, parameters: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Where the points of fields stand, by the names of coordinates; none of what is no field.

        Args:
            parameters: Packed, ``(k,)`` or ``(k, *batch)``.
        """
        return {}

    def with_derivatives(self, derivatives: str) -> System:
        """Fields by ``"differences"``, which the spec declares, or by ``"fourier"`` derivatives.

        Fourier derivatives are exact for smooth periodic fields but for rounding, as soon as there
        are enough points. Python leads the steps between transforms of SciPy, so that methods
        ``scipy:NAME`` apply, and with steps of one length the midpoint and Gauss's methods, to one
        after the other; generated solvers need differences.

        Raises:
            KernelArgumentError: Another name, or a system without fields.
        """
        if derivatives == "differences" and not self.obstacle:  # what most are asked for
            return self
        from coadjoint.solve.spectral import use_derivatives

        return use_derivatives(self, derivatives)

    # -- functions --------------------------------------------------------------------------------

    @property
    def probed(self) -> System:
        """What fresh objects are compared with: itself, but for loops over many members."""
        return self

    @property
    def stretched(self) -> dict[int, float]:
        """By their rows, parameters that are larger there than others: lengths of fields."""
        return {}

    def rows(self, function: str) -> Quantities:
        """What the rows of the first argument of a function are."""
        match KERNEL_FUNCTIONS[function].below:
            case "reconstructed":
                return Quantities(*self.STATE.values(), *self.RECONSTRUCTED.values())
            case "vector":
                return Quantities(*self.STATE.values(), *map(_name_below, self.STATE.values()))
        return self.STATE

    def list_called(self, function: str) -> tuple[str, ...]:
        """What a function of the kernels calls beyond ``+ - * / sqrt``, or what others do."""
        return self.elementary

    def sizes(self, function: str) -> dict[str, int]:
        """How many rows each array has that a function takes."""
        driving = {"inputs": self.INPUTS.size, "time": self.TIME.size}
        given = {"state": self.rows(function).size, "parameters": self.PARAMETERS.size}
        return given | {name: size for name, size in driving.items() if size}

    @by_name
    def evaluate(
        self,
        function: str,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """One of the ``functions`` by name; arguments as in `rhs`."""
        return self._evaluate(function, target, state, parameters, inputs, time, out)

    def _evaluate(
        self, function: str, target: Target, state: Any, parameters: Any, inputs: Any, *rest: Any
    ) -> Array:
        """A function of a state that is ready, at once; or after all checks of the arguments."""
        time, out = rest
        by_default = inputs is None and time is None
        if by_default and (ready := self._kernels.ready.get((function, target))):
            values: Array | None = ready(state, parameters, out)
            if values is not None:
                return values
        from coadjoint.solve.arrays import check_call

        call, result = check_call(self, function, state, parameters, inputs, time=time, out=out)
        self._kernels.run(function, call, target)
        if by_default:
            self._kernels.make_ready(function, call, target)
        return result

    @by_name
    def bind(
        self,
        function: str,
        state: Array,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        out: Array | None = None,
        time: ArrayLike | None = None,
        target: Target = "c",
    ) -> Callable[[], None]:
        """A call without arguments that evaluates ``state`` as it then is into ``out``.

        All checks are made once, here. For loops of your own: a call costs a fraction of a
        microsecond beyond the kernel.

        Args:
            function: Name of a function.
            state: A float64, C-contiguous array, read at each call.
            parameters: As in `rhs`. A packed float64 array is read at each call, as the state is;
                anything else is copied now. Signs are checked now.
            inputs: As in `rhs`, and read as parameters are.
            out: As in `rhs`, and not optional: it is where the results appear.
            time: As in `rhs`; an array of float64, also one without axes, is read at each call.
            target: As in `rhs`.
        """
        from coadjoint.solve.arrays import check_call

        named: dict[str, Any] = {"time": time, "out": out, "bound": True}
        call, _ = check_call(self, function, state, parameters, inputs, **named)
        return self._kernels.bind(function, call, target)

    def pack(self, parameters: Values | None = None) -> Array:
        """Parameters as one array ``(k,)`` or ``(k, *batch)``, defaults filled in."""
        from coadjoint.solve.arrays import pack_parameters

        packed = pack_parameters(self, parameters)
        return packed.copy() if parameters is None else packed

    def simulate(
        self,
        state: Values | None,
        t: ArrayLike,
        parameters: Values | None = None,
        inputs: Any = None,
        *,
        method: str = "auto",
        rtol: float | None = None,
        atol: float | None = None,
        step: float | None = None,
        samples: int = 1001,
        max_steps: int = 1_000_000,
        target: Target = "c",
        threads: int | None = None,
        progress: bool | Callable[[float], object] = True,
        reconstruct: bool | Mapping[str, ArrayLike] = False,
        checkpoint: str | PathLike[str] | None = None,
        events: str | Event | Sequence[str | Event] | None = None,
        dense: bool = False,
        seed: int | None = None,
        newton: bool = False,
    ) -> Solution:
        """Integrate one trajectory, or many at a time.

        Args:
            state: Initial state, ``(n,)`` or by name; of many members ``(n, *batch)``. What is
                left out by name begins at the default of the spec, and with None all does.
            t: ``(start, end)``, or an increasing sequence of three or more times to sample at.
            parameters: As in `rhs`, shared, or of each member.
            inputs: Constants, ``(m,)`` or by name, of a batch also ``(m, *batch)``; samples over
                time as ``(times, values, "previous")``, each of which holds until the next one,
                or ``(times, values, "linear")``, with values ``(m, T)`` or by name, over the whole
                of the run; or a function of time that returns ``(m,)`` or values by name. No step
                crosses a jump of samples. None for the defaults.
            method: ``"taylor"``, of an order that follows from ``rtol``, ``"dop853"`` or ``"rk4"``,
                which are generated; or ``"scipy:DOP853"``, ``"scipy:Radau"`` and so on, of
                `scipy.integrate`, for one trajectory, or by Fourier derivatives a batch. ``"auto"``
                is ``"taylor"``, with ``step`` ``"dop853"``. Where its operations say that it is
                faster, as for a free body on so(8), it is ``"dop853"`` with 1/4096 of the
                tolerances, as far as rounding lets it, for the same errors; not with ``events`` or
                ``dense``. So it is where rates have roots at kinks, and there no series. Where
                inputs are a function it is ``"dop853"`` with steps in Python, and with the target
                ``"python"`` it is ``"scipy:DOP853"``. `Solution.settings` says what it was.
            rtol: Relative tolerance of a step; 1e-10 if none is given.
            atol: Absolute tolerance of a step; 1e-12 if none is given.
            step: A fixed step for a generated method, in the place of tolerances; the order of
                ``"taylor"`` still follows from ``rtol``. The last step before a sample of inputs
                or the end is shorter, or longer by up to a millionth.
            samples: Number of evenly spaced samples when ``t`` is a pair; 1 for the end alone. With
                noise, and of a method that keeps structure, they are the nearest ends of steps,
                no more than there are: between these nothing is known, or kept.
            max_steps: After so many steps a trajectory ends with the status ``MAX_STEPS``.
            target: Kernel that computes the rates, or language of the generated solver.
            threads: How many threads share a batch, at the most; None for one on each processor.
                Their number changes no bit.
            progress: Whether to show a bar on a terminal where a generated solver runs for longer
                than a second; or a function that is told the part that is done, from 0 to 1.
            reconstruct: Whether to integrate ``RECONSTRUCTED`` with the state, to the same
                tolerances: attitude and place of a body, for instance. A mapping says where some
                of it begins, as ``{"x": 1.0}``, for all members or each. Otherwise the rest begins
                at its default, else at zero; an attitude at the identity, that of a rolling body
                turned upright the shortest way. Methods with a Jacobian find it by differences.
                For a momentum in space that stays to rounding the attitude has to be part of the
                state: ``"coadjoint_mean"`` then moves both by one element of the group.
            checkpoint: A file that a generated solver replaces as a whole every ten seconds, less
                often where writing it takes longer than half a second, and at the end. Called again
                with the same arguments, it goes on from there, with the bits and events of a run
                that was not broken off. A finished run stands there, too: remove it to begin anew.
                By Fourier derivatives one trajectory has one, without events and dense output.
            events: What to look for: names of components or scalar quantities, where these are 0;
                formulas such as ``"Gamma3 == 0.5"``; or `Event` records, which have a direction or
                end the trajectory. `Solution.events` has them by name.
            dense: Whether to keep the steps, from which `Solution.at` has the state at any time.
            seed: Of the noise of a system that has some: from 0 to 2^64 - 1. The same seed gives
                the same paths for any number of threads, and for the targets ``"c"`` and
                ``"numpy"`` as far as these agree to the bit. A member has its own by its place in
                the batch. Such a system has the methods ``"heun"`` and ``"midpoint"``, on coadjoint
                orbits ``"coadjoint_mean"`` and on spheres ``"spherical_midpoint"``, with ``step``;
                ``"auto"`` is the first of `METHODS` in rank. Samples lie at the ends of steps.
            newton: Whether Newton's method solves the equations of implicit steps, with the
                generated Jacobian, in the place of sweeps alone: for stiff forces, where these ask
                for much shorter steps. A sweep then takes a linear solution of as many unknowns as
                are searched for. The equations are the same, and so is what a method keeps.
                ``Solution.course.sweeps`` counts them.

        Returns:
            The labelled trajectory or trajectories, with observables and the drift of what is
            conserved. One that could not be followed to the end has a status other than ``OK``: a
            single one ends before; in a batch its samples are NaN from there on, and its
            neighbours go on. Where constraints are kept, one-step methods go on from the
            `projection` of each step, BDF and LSODA remember steps and are left alone, and each
            sample is on the constraints to rounding. Where a trajectory leaves the domain it ends
            with the last point inside, found to 1e-12 of a step; points between the samples and
            the ends of steps are not tried.

        Raises:
            KernelArgumentError: The state is outside the domain or off the constraints, times do
                not increase, a shape or name cannot be right, or the method does not apply.
        """
        from coadjoint.solve.simulate import simulate

        return simulate(
            self,
            state,
            t,
            parameters,
            inputs=inputs,
            method=method,
            rtol=rtol,
            atol=atol,
            step=step,
            samples=samples,
            max_steps=max_steps,
            target=target,
            threads=threads,
            progress=progress,
            reconstruct=reconstruct,
            checkpoint=checkpoint,
            events=events,
            dense=dense,
            seed=seed,
            newton=newton,
        )

    def ode(
        self,
        parameters: Values | None = None,
        inputs: Values | Callable[[float], Values] | None = None,
        *,
        target: Target = "c",
    ) -> Ode:
        """The equations of motion as ``fun(t, y)`` and ``jac(t, y)``, for integrators of others.

        Args:
            parameters: As in `rhs`, shared.
            inputs: As in `simulate`; samples are taken at the time of each call.
            target: Kernel that computes both.

        >>> from coadjoint.systems.rigid_body import system
        >>> system.ode({"I": [1, 2, 3]}).fun(0.0, [1.0, 3.0, 1.0]).tolist()
        [-0.5, 0.6666666666666667, -1.5]
        """
        from coadjoint.solve.ode import Ode

        return Ode(self, parameters, inputs, target)

    # -- what is known about it -------------------------------------------------------------------

    def prepare(self, targets: Sequence[str] = ("c",)) -> None:
        """Compile and load what targets need now instead of at their first call.

        Args:
            targets: What may be given as ``target=``; several are compiled side by side.

        Raises:
            KernelArgumentError: No such target.
        """
        self._kernels.prepare(targets)

    def load_kernels(self, targets: Sequence[str]) -> dict[str, str]:
        """Load the kernels of targets, or fail: unlike in `prepare`, NumPy never stands in for C.

        Args:
            targets: As in `prepare`.

        Returns:
            SHA-256 of the text that each kernel was made from.

        Raises:
            CompilerError: A kernel cannot be compiled.
            CrossCheckError: A compiled kernel differs from the NumPy kernel.
            OutputError: ``kernel.py`` cannot be loaded.
        """
        return self._kernels.load(targets)

    @cached_property
    def _kernels(self) -> Kernels:
        from coadjoint.solve.kernels import Kernels

        return Kernels(self)

    @cached_property
    def _solvers(self) -> Solvers:
        from coadjoint.solve.solvers import Solvers

        return Solvers(self)

    @cached_property
    def certificate(self) -> Mapping[str, Any]:
        """What was proved: ``certificate.json``, with title, source and docs of the spec.

        Empty if the file is missing or damaged; `coadjoint doctor` and `coadjoint list` say so.
        """
        return MappingProxyType(read_certificate(self.folder / "certificate.json"))

    @property
    def title(self) -> str:
        """Title of the spec."""
        return str(self.certificate.get("title") or self.name)

    @property
    def source(self) -> str:
        """Source that the spec names."""
        return str(self.certificate.get("source", ""))

    @property
    def docs(self) -> Mapping[str, str]:
        """Explanations of quantities by name."""
        return dict(self.certificate.get("docs", {}))

    # -- copies and pickles ------------------------------------------------------------------------

    def __reduce__(self) -> tuple[Callable[..., System], tuple[str, ...]]:
        """Pickled by reference: module, or folder, and id; see `coadjoint.solve.references`."""
        from coadjoint.solve.references import find_system, refer_to

        return find_system, refer_to(self)

    def __copy__(self) -> System:
        return self  # nothing about it can be changed

    def __deepcopy__(self, _memory: dict[int, Any]) -> System:
        return self

    def __repr__(self) -> str:
        tables = {"state": self.STATE, "parameters": self.PARAMETERS}
        driving = {"inputs": self.INPUTS, "time": self.TIME}
        tables |= {name: quantities for name, quantities in driving.items() if quantities}
        told = (f"{name} {q.listed or 'none'}" for name, q in tables.items())
        return f"<System {self.name}: {'; '.join(told)}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_system

        return show_system(self)

    def _repr_latex_(self) -> str | None:
        """What a notebook shows that takes no HTML, and an export to LaTeX; None of what is old."""
        from coadjoint.notebook import write_system

        return write_system(self)


def _name_below(quantity: Quantity) -> Quantity:
    """A quantity of the state as what stands below it: the same rows of a vector."""
    name, *components = (f"{each} of the vector" for each in (quantity.name, *quantity.components))
    return replace(quantity, name=name, components=tuple(components))
