"""Cross-check, the ladder: rungs 3, 4 and 5 for one system, and their figures.

Comes in: Programs, the texts printed from them, the equations, and the loaded system. Goes out: a
`Report`, or a `CrossCheckError` that names function, output, target, point and values.

    rung 3   emitted text, parsed back, equals the Program
    rung 4   every target against 50 digits: k <= 4, or 16 with functions beyond sqrt
    rung 5   NumPy equals every exact target bit for bit; with functions beyond sqrt, within k

The solvers climb the same ladder (`coadjoint.crosscheck.solvers`).
Every rung runs on what was loaded from these very texts, counts what it compared, and fails where
that is nothing: no kernel stands in for another.
Rungs 1 and 2, claims and lowering, are exact and come earlier. NumPy agreeing with C proves almost
nothing by itself: both are printed from one Program.
Read next: `coadjoint.pipeline`, which runs this before anything is written.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

from coadjoint.build.cache import working_folder
from coadjoint.build.compiler import compiler_version
from coadjoint.build.processes import compilers
from coadjoint.crosscheck.bits import compare_chunks, equal_bits
from coadjoint.crosscheck.compare import Figures, against_oracle, exact_points
from coadjoint.crosscheck.oracle import Reference
from coadjoint.crosscheck.parse_back import check_text
from coadjoint.crosscheck.replay import Replayed
from coadjoint.crosscheck.solvers import SolverFigures, check_solvers, start_compiling
from coadjoint.crosscheck.subject import Subject, work
from coadjoint.errors import CrossCheckError
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.program import Program
from coadjoint.render.solvers import select_programs
from coadjoint.render.targets import BUILDS, TARGETS
from coadjoint.solver_kinds import SOLVER, list_kinds

#: How much is optimised what the ladder runs for some points or steps alone, by stem and build.
#: Where the system is loaded next, kernels of the exact build are those that it loads, as they are.
LEVELS: Final = {("kernel", "fast"): 1, (SOLVER.stem, "exact"): 0, (SOLVER.stem, "fast"): 1}
#: The same where texts are written and nothing is loaded: optimisation changes no bit, and every
#: object that users load is compared with its twin when it is compiled.
WRITTEN_LEVELS: Final = {**LEVELS, ("kernel", "exact"): 0}
NO_COMPILER: Final = "not run: no compiler"
#: Points against 50 digits for a whole system: about a second of a processor for a small one.
ORACLE_POINTS: Final = 1000
#: Operations and outputs of one function, all its points together: a large function, of which every
#: point tries many formulas, gets fewer points, and never less than the other number.
ORACLE_OPERATIONS: Final = 20_000
FEWEST_POINTS: Final = 50
#: Points of bitwise comparison for each function, and how many outputs these may be together. A
#: text that has other bits has them at most points; `coadjoint crosscheck` takes more.
BIT_POINTS: Final = 40_000
BIT_OUTPUTS: Final = 10_000_000


@dataclass(frozen=True)
class Report:
    """What the numeric rungs found; a rung that fails raises instead.

    Attributes:
        system: Name of the system.
        rungs: Status by number of the rung: ``"passed"`` or why it was not run.
        threshold: The k that was allowed.
        lines: Lines of the texts of all targets that were read back, by function.
        figures: By function and target, with the points that were compared.
        equal: Points at which a target has the same bits as NumPy, by function and target; none of
            what calls functions beyond sqrt, where libraries may differ in the last bits.
        together: Points at which these were compared within k instead, by function and target.
        solvers: What was compared of its solvers of each kind, by the stem of their files.
    """

    system: str
    rungs: Mapping[int, str]
    threshold: float
    lines: Mapping[str, int]
    figures: Mapping[str, Mapping[str, Figures]]
    equal: Mapping[str, Mapping[str, int]]
    together: Mapping[str, Mapping[str, int]]
    solvers: Mapping[str, SolverFigures]

    @property
    def points(self) -> int:
        """Points compared with the equations, of all functions and targets together."""
        return sum(each.points for targets in self.figures.values() for each in targets.values())

    @property
    def passed(self) -> bool:
        """Whether every rung ran and passed."""
        return all(status == "passed" for status in self.rungs.values())

    @property
    def targets(self) -> tuple[str, ...]:
        """The targets that were checked."""
        return tuple(next(iter(self.figures.values())))

    @property
    def k(self) -> float:
        """The largest k of all functions and targets."""
        return max(each.k for targets in self.figures.values() for each in targets.values())

    def as_record(self) -> dict[str, Any]:
        """The report as plain JSON values; k of fast C may differ from machine to machine."""
        return asdict(self) | {"rungs": {str(rung): status for rung, status in self.rungs.items()}}


def crosscheck(
    programs: Mapping[str, Program],
    texts: Mapping[str, str],
    reference: Reference,
    system: Any,
    targets: Sequence[str] | None = None,
    oracle_points: int = ORACLE_POINTS,
    bit_points: int = BIT_POINTS,
    maps: Sequence[Program] = (),
) -> Report:
    """Run rungs 3, 4 and 5.

    Args:
        programs: The functions by name.
        texts: The rendered files by name.
        reference: The equations.
        system: The loaded system: ``name``, ``PARAMETERS``, ``load_kernels`` and one method per
            function, called with ``state``, ``parameters``, ``target`` and ``out``.
        targets: What to compare; by default all, or those that need no compiler without one.
        oracle_points: Points against 50 digits, shared out among the functions.
        bit_points: Points of bitwise comparison for each function.
        maps: What explicit methods make a step of.

    Raises:
        CompilerError: The compiler does not work, or fails on this kernel.
        CrossCheckError: A rung failed.
    """
    chosen = available_targets() if targets is None else tuple(targets)
    _require(chosen and programs, system.name, "there is no function, or no target", 3)
    subject = Subject(
        programs=programs,
        reference=Replayed(reference),
        system=system,
        targets=chosen,
        maps=tuple(maps),
    )
    share = max(1, oracle_points // len(programs))
    with working_folder() as folder, compilers() as pool:  # compilers work at the same time
        compiling = {
            kind: start_compiling(
                pool,
                texts,
                folder,
                system.name,
                chosen,
                kind,
                hold_sides(select_programs(programs.values(), kind, maps)),
            )
            for kind in list_kinds(programs)
        }
        loading = pool.submit(system.load_kernels, chosen)
        lines = {
            name: sum(
                check_text(program, target, texts[target.kernel], system.name)
                for target in TARGETS.values()
            )
            for name, program in programs.items()
        }
        exact = [exact_points(subject, name, _share(share, p)) for name, p in programs.items()]
        _check_texts(loading.result(), chosen, texts, system.name)
        solvers = {
            kind.stem: check_solvers(subject, texts, made, kind) for kind, made in compiling.items()
        }
    agreements = {points.function: against_oracle(subject, points) for points in exact}
    figures = {name: agreement.figures for name, agreement in agreements.items()}
    together = {name: agreement.together for name, agreement in agreements.items()}
    largest = max(len(program.outputs) for program in programs.values())
    points = max(1, min(bit_points, BIT_OUTPUTS // largest))
    equal = equal_bits(subject, points)
    if "numpy" in chosen:
        _require(
            compare_chunks(subject), system.name, "no member of a second chunk was compared", 5
        )
    rungs = {3: "passed", 4: "passed", 5: "passed"}
    if not set(BUILDS) <= set(chosen):
        rungs[4] = rungs[5] = f"{', '.join(chosen)}; the others {NO_COMPILER}"
    if not subject.exact:
        rungs[5] = "not run: nothing to compare with NumPy"
    report = Report(
        system=system.name,
        rungs=rungs,
        threshold=subject.threshold,
        lines=lines,
        figures=figures,
        equal=equal,
        together=together,
        solvers=solvers,
    )
    for name in programs:
        _check_counts(report, name, subject)
    return report


def _check_texts(
    loaded: Mapping[str, str], targets: Sequence[str], texts: Mapping[str, str], system: str
) -> None:
    """The kernel of each target was loaded from the text that is checked."""
    for target in targets:
        file = BUILDS[target].kernel
        same = loaded.get(target) == hashlib.sha256(texts[file].encode()).hexdigest()
        _require(same, system, f"the target {target} was not loaded from this {file}", 3)


def _check_counts(report: Report, function: str, subject: Subject) -> None:
    """Each rung compared something of a function; passing on nothing is failing."""
    compared = report.equal if subject.has_equal_bits(function) else report.together
    counts = {
        3: [report.lines[function]],
        4: [figures.points for figures in report.figures[function].values()],
        5: [compared[function].get(target, 0) for target in subject.exact],
    }
    for rung, numbers in counts.items():
        _require(
            (numbers or rung == 5) and all(numbers),
            report.system,
            f"nothing of {function} was compared",
            rung,
        )


def _require(held: object, system: str, message: str, rung: int) -> None:
    """A rung that rests on nothing fails."""
    if not held:
        raise CrossCheckError.on(rung, system, message)


def _share(share: int, program: Program) -> int:
    """Points for one function."""
    return min(share, max(FEWEST_POINTS, ORACLE_OPERATIONS // work(program)))


def available_targets() -> tuple[str, ...]:
    """All targets, or those that need no compiler where there is none.

    Raises:
        CompilerError: One was asked for that does not work.
    """
    without = compiler_version() == "none"
    return tuple(build for build, each in BUILDS.items() if not (without and each.needs_compiler))
