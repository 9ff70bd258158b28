"""The solvers of a System, one for each method, order and target, loaded when first asked for.

Comes in: an `Ensemble`. Goes out: the same further on, advanced by the generated ``solver.c``, or
by its NumPy twin where that is asked for or no compiler is there. A fresh object is compared with
the twin before it is used.
Read next: `coadjoint.solve.march`, which shares an ensemble among threads.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from coadjoint.build.compiler import HOW_TO_GET_ONE, Source
from coadjoint.build.library import Library, load_library, tell_processor
from coadjoint.errors import CompilerError, CrossCheckError
from coadjoint.render.targets.c.loader import FLAGS, ROUNDINGS
from coadjoint.render.targets.modules import KernelModule
from coadjoint.render.targets.numpy.loader import NumpyKernel
from coadjoint.render.targets.protocol import Call
from coadjoint.solve.calls import CStepper
from coadjoint.solve.costs import Costs, read_costs
from coadjoint.solve.ensemble import HEAD, ROOM, Ensemble, Inputs, Limits, Record
from coadjoint.solve.kernels import say_once
from coadjoint.solve.ready import make_pack
from coadjoint.solve.steps import DormandPrince8, Lanes, Method, RungeKutta4, Taylor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.system import System

    Array = NDArray[np.float64]

#: Methods that are generated.
GENERATED: Final = ("taylor", "dop853", "rk4")
#: Files that a folder has where its solvers were generated.
FILES: Final = ("solver.c", "solver.h", "solver.py")
#: Members in the longest vectors, those of AVX-512; others have half as many.
LANES: Final = 8
#: Members by which a fresh object is compared with its twin: they fill no whole number of vectors.
PROBES: Final = 11
#: The most steps of each.
MOST_STEPS: Final = 4


@dataclass(frozen=True)
class Choice:
    """A method of integration.

    Attributes:
        name: One of `GENERATED`.
        order: Of the method.
        few: Whether it is for members that fill no more than half of the longest vectors.
    """

    name: str
    order: int
    few: bool = False

    @property
    def defines(self) -> tuple[str, ...]:
        """What chooses it in ``solver.c``."""
        method = f"-DORDER={self.order}" if self.name == "taylor" else f"-D{self.name.upper()}"
        return (method, "-DFEW") if self.few else (method,)

    @property
    def degree(self) -> int:
        """Of the polynomials that are recorded of its steps."""
        return {"dop853": 7, "rk4": 3}.get(self.name, self.order)

    def __str__(self) -> str:
        return self.name


class Stepper(Protocol):
    """Whoever advances members of an ensemble.

    Attributes:
        degree: Of the polynomials that are recorded.
    """

    degree: int

    @property
    def first_work(self) -> int:
        """How many steps of a block a first call may make."""
        ...

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
    """The solvers of one System.

    Attributes:
        system: Whose they are.
        pack: Packs parameters that all members share; None for what has to be looked at closely.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.pack = make_pack(system.PARAMETERS)
        self._loaded: dict[tuple[Choice, str], Stepper] = {}

    @cached_property
    def are_there(self) -> bool:
        """Whether the folder of the system has the files of solvers."""
        return all((self.system.folder / file).is_file() for file in FILES)

    @cached_property
    def costs(self) -> Costs:
        """What steps of this system cost."""
        return read_costs(KernelModule(self.system, "solver.py"), self.system.STATE.size)

    def get(self, choice: Choice, target: str, members: int = LANES) -> Stepper:
        """The solver of a method; its NumPy twin, which is said, where a compiler cannot make it.

        Args:
            choice: The method.
            target: ``"c"``, ``"c-fast"`` or ``"numpy"``.
            members: How many it is for. Half a vector is faster where it holds them.
        """
        if 2 * members <= LANES and target != "numpy" and "avx512f" in tell_processor():
            choice = replace(choice, few=True)
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


def make_source(choice: Choice) -> Source:
    """What the object of a method is compiled from."""
    return Source("solver", choice.defines, is_loops=False)


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
    kind = make_source(choice)
    verify = partial(_verify, system, choice, target)
    library = load_library(system.folder, system.name, system.id, FLAGS[target], verify, kind)
    return CStepper(library, system.STATE.size, choice.degree)


# -- NumPy --------------------------------------------------------------------------------------


class NumpyStepper:
    """The twin of a solver.

    Args:
        system: Whose solver it is.
        choice: The method.

    Raises:
        OutputError: ``solver.py`` or ``kernel.py`` cannot be loaded.
    """

    first_work = 16

    def __init__(self, system: System, choice: Choice) -> None:
        self._system, self._choice, self.degree = system, choice, choice.degree
        self._kernel = NumpyKernel(system, "kernel.py")
        self._rates = partial(self._evaluate, "rhs", system.STATE.size)
        module = KernelModule(system, "solver.py")
        self._expansion = module.function("expand")
        self._branches = bool(module.value("BRANCHES"))
        self._limits = Limits(
            domain=partial(self._evaluate, "domain", len(system.DOMAIN)) if system.DOMAIN else None,
            strict=tuple(bound.strict for bound in system.DOMAIN),
            projection=partial(self._evaluate, "projection", system.STATE.size)
            if "projection" in system.functions
            else None,
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
        return RungeKutta4(self._rates, run.size, branches=self._branches)

    def _expand(self, lanes: Lanes, order: int) -> Array:
        """Coefficients of the motion."""
        path: Array = self._expansion(
            lanes.state, lanes.parameters, lanes.driving, lanes.slopes, order
        )
        return path

    def _evaluate(
        self, function: str, rows: int, lanes: Lanes, after: Array, state: Array
    ) -> Array:
        """A function of the kernel some time after that of the lanes."""
        driving, inputs = lanes.driving + after * lanes.slopes, self._system.INPUTS.size
        named = {"inputs": driving[:inputs]} if inputs else {}
        if self._system.TIME:
            named["time"] = driving[inputs:]
        block = np.empty((rows, state.shape[1]))
        call = Call(np.ascontiguousarray(state), lanes.parameters, block, named)
        return self._kernel.values(function, call)


# -- comparison ---------------------------------------------------------------------------------


def _verify(system: System, choice: Choice, target: str, library: Library) -> None:
    """Compare a fresh object with its NumPy twin by a few steps of a few members.

    Steps that follow tolerances are compared where bits are promised; elsewhere a rounding may
    decide whether a step is accepted, so that steps are fixed. Where nobody records them, C makes
    several fixed steps before it looks at them; this is compared as well.

    Raises:
        CrossCheckError: They differ.
        OutputError: The NumPy twin does not run.
    """
    exact = target == "c" and not system.elementary
    fresh, twin = CStepper(library, system.STATE.size, choice.degree), NumpyStepper(system, choice)
    adaptive = exact and choice.name != "rk4"
    runs = [*([(0.0, MOST_STEPS, True)] if adaptive else []), (2.0**-7, MOST_STEPS, True)]
    for size, most, keeps in [*runs, *([] if choice.name == "taylor" else [(2.0**-9, 9, False)])]:
        found, expected = (_probe(system, size, most) for _ in range(2))
        room = most * PROBES + ROOM
        one, other = (Record.make(system.STATE.size, choice.degree, room) for _ in range(2))
        while fresh.advance(found, 0, PROBES, 2 if keeps else 6, one if keeps else None):
            pass  # calls that break off now and then, so that this is compared as well
        twin.advance(expected, 0, PROBES, 1000, other if keeps else None)
        if not (_agree(found, expected, exact=exact) and _agree_steps(one, other, exact=exact)):
            raise CrossCheckError(
                f"a wrong solver was compiled: {choice} of {system.name} for the target {target} "
                "differs from its NumPy twin. Set CC to another compiler, or run `coadjoint "
                "crosscheck` to see whether the files are at fault.",
                rung=5,
                system=system.name,
                function=choice.name,
                target=target,
            )


def _probe(system: System, size: float, most: int) -> Ensemble:
    """A few members at the start of a few steps, driven by two lines, with four samples."""
    source = np.random.default_rng(0)
    samples = np.array([0.0, 2.0**-8, 2.0**-6, 5 * 2.0**-8])

    def draw(*shape: int) -> Array:
        return source.uniform(0.5, 2.0, shape)

    run = Ensemble(
        state=draw(system.STATE.size, PROBES),
        parameters=draw(system.PARAMETERS.size, PROBES),
        inputs=Inputs(
            knots=np.array([0.0, 3 * 2.0**-8]),
            values=draw(system.INPUTS.size, 2),
            slopes=draw(system.INPUTS.size, 2),
        ),
        has_time=bool(system.TIME),
        samples=samples,
        out=np.full((system.STATE.size, PROBES, samples.size), np.nan),
        rtol=1e-9,
        atol=1e-9,
        size=size,
        max_steps=most,
    )
    run.begin(0.0)
    return run


def _agree(found: Ensemble, expected: Ensemble, *, exact: bool) -> bool:
    """Whether two ensembles went the same way: to the bit, or but for roundings."""
    counts = ("status", "steps", "rejected", "next")
    if not all(np.array_equal(getattr(found, n), getattr(expected, n)) for n in counts):
        return False
    pairs: Any = [(getattr(found, n), getattr(expected, n)) for n in ("state", "time", "step")]
    pairs.append((found.out, expected.out))
    if exact:
        return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)
    return all(_are_close(a, b) for a, b in pairs)


def _agree_steps(found: Record, expected: Record, *, exact: bool) -> bool:
    """Whether two records have the same steps, whatever the order of the members."""
    if found.count != expected.count:
        return False
    if not found.count:
        return True
    pair = [
        Record(each.rows[np.argsort(each.member, kind="stable")], each.degree, each.count)
        for each in (found, expected)
    ]
    if exact:
        return np.array_equal(pair[0].rows, pair[1].rows, equal_nan=True)
    heads = np.array_equal(pair[0].rows[:, :HEAD], pair[1].rows[:, :HEAD])
    # what each order comes to at the end of its step, against the largest of the component
    ends = [each.path * each.length[:, None, None] ** np.arange(each.degree + 1) for each in pair]
    rows = zip(*(end.transpose(1, 0, 2) for end in ends), strict=True)
    return heads and all(_are_close(a, b) for a, b in rows)


def _are_close(found: Array, expected: Array) -> bool:
    """Whether arrays are equal but for roundings; NaN equals NaN."""
    with np.errstate(all="ignore"):
        size = np.abs(expected[np.isfinite(expected)]).max(initial=0.0)
        close = np.abs(found - expected) <= ROUNDINGS * size
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    return bool((close | same).all())
