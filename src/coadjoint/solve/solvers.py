"""The solvers of a System, one for each method, order and target, loaded when first asked for.

Comes in: an `Ensemble`. Goes out: the same further on, advanced by the generated ``solver.c``, or
by its NumPy twin where that is asked for or no compiler is there. A fresh object is compared with
the twin before it is used.
Read next: `coadjoint.solve.march`, which shares an ensemble among threads.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Final, Protocol

from coadjoint.build.compiler import HOW_TO_GET_ONE
from coadjoint.build.library import Library, load_library, tell_processor
from coadjoint.errors import CompilerError, CrossCheckError
from coadjoint.methods import MAPPED
from coadjoint.render.targets.c.loader import FLAGS
from coadjoint.render.targets.modules import KernelModule
from coadjoint.solve.calls import CStepper
from coadjoint.solve.comparison import compare_steps, count_rows
from coadjoint.solve.costs import Costs, read_costs
from coadjoint.solve.ensemble import Ensemble
from coadjoint.solve.kernels import say_once
from coadjoint.solve.ready import make_pack
from coadjoint.solve.step_records import Record
from coadjoint.solve.twins import NumpyStepper
from coadjoint.solver_kinds import SOLVER

if TYPE_CHECKING:
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.system import System
    from coadjoint.solver_kinds import SolverKind

#: Members in the longest vectors, those of AVX-512; others have half as many.
LANES: Final = 8


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
        self._there: dict[SolverKind, bool] = {}
        self._costs: dict[SolverKind, Costs] = {}

    def has_files(self, kind: SolverKind) -> bool:
        """Whether the folder of the system has the files of a kind of solvers."""
        if kind not in self._there:
            self._there[kind] = all((self.system.folder / file).is_file() for file in kind.files)
        return self._there[kind]

    @cached_property
    def refusals(self) -> dict[str, str]:
        """Why methods that are a sequence of maps do not apply, as far as they do not."""
        module = KernelModule(self.system, SOLVER.files[2])
        known, found = (
            module.value(name) if module.has(name) else {} for name in ("REFUSALS", "SCHEDULES")
        )
        missing = "its folder was generated without them: run `coadjoint regenerate`"
        return {name: known.get(name, missing) for name in MAPPED if name not in found}

    def find_costs(self, kind: SolverKind) -> Costs:
        """What steps of a kind of solvers cost."""
        if kind not in self._costs:
            rows = self.system.rows(kind.rates[-1]).size
            self._costs[kind] = read_costs(KernelModule(self.system, kind.files[2]), rows)
        return self._costs[kind]

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

    def make(library: Library) -> CStepper:
        return CStepper(library, count_rows(system, choice), choice)

    def verify(library: Library) -> None:
        compare_steps(system, choice, target, make(library), NumpyStepper(system, choice))

    build = FLAGS[target]
    source = choice.source.at(system.levels, build)
    return make(load_library(system.folder, system.name, system.id, build, verify, source))
