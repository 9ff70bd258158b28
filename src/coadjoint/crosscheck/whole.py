"""Cross-check, the whole: what solvers integrate together, as a subject of its own.

Comes in: a `Subject`, and the Programs of a kind of solvers. Goes out: a Subject whose rates are
those of all that is integrated, by the equations and by the Programs.
Read next: `coadjoint.crosscheck.solvers`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from coadjoint.array_types import Array
from coadjoint.crosscheck.oracle import Reference
from coadjoint.crosscheck.points import Batch
from coadjoint.crosscheck.subject import Subject
from coadjoint.lower.program import Program
from coadjoint.solver_kinds import SOLVER, SolverKind


@dataclass(frozen=True)
class WholeReference:
    """The equations of all that is integrated.

    Attributes:
        of: The equations of the system.
        kind: Whose functions are the rates.
        rest: Names of what is reconstructed.
    """

    of: Reference
    kind: SolverKind
    rest: tuple[str, ...]

    def evaluate(
        self,
        function: str,
        values: Mapping[str, Any],
        number: Callable[[Fraction], Any],
        call: Callable[[str, Any], Any],
    ) -> list[Any]:
        """A function of the equations; of the rates all rows, of a projection the rest as it is."""
        names = self.kind.rates if function == "rhs" else (function,)
        rows = [row for name in names for row in self.of.evaluate(name, values, number, call)]
        return rows + [values[name] for name in self.rest if function == "projection"]


@dataclass(frozen=True)
class WholeSubject(Subject):
    """A system with all that is integrated as its state.

    Attributes:
        base: The system; where its domain is, is known of its state alone.
    """

    base: Subject

    @property
    def inside(self) -> Array:
        """As `Subject.inside`."""
        return self.base.find_inside(self._widest.names)

    def evaluate(self, function: str, batch: Batch, target: str) -> Array:
        """As `Subject.evaluate`, of a function of the kernel."""
        return self.base.evaluate(function, batch, target)


def make_whole(subject: Subject, programs: Mapping[str, Program], kind: SolverKind) -> Subject:
    """What solvers of a kind integrate.

    Args:
        subject: The system.
        programs: As `select_programs` has them.
        kind: What is integrated.
    """
    if kind == SOLVER:
        return subject
    rates, n = programs["rates"], len(subject.programs["rhs"].state)
    bounds = {name: each for name, each in programs.items() if name != "rates"}
    return WholeSubject(
        programs={"rhs": rates} | bounds,
        reference=WholeReference(subject.reference, kind, rates.state[n:]),
        system=subject.system,
        targets=subject.targets,
        base=subject,
    )
