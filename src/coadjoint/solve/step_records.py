"""Records of steps: each accepted step of some members as polynomials in time.

Comes in: what a solver hands over with each call. Goes out: the same by member, from which events
and dense output are found in one way for all solvers.
Read next: `coadjoint.solve.ensemble`, whose calls fill them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


#: Numbers of a recorded step before its polynomials.
HEAD = 5


#: The fewest steps that a record has room for: one of each lane of the blocks of a solver.
ROOM = 32


@dataclass
class Record:
    """Steps as they are accepted. Those of one member follow one another, others lie between.

    The state at the time t is the sum of ``path[:, k] * (t - begun)**k``, for begun <= t <= begun +
    length. Where constraints are kept, their projection has still to follow. A step that leaves the
    domain is as long as it is inside.

    Attributes:
        rows: ``(room, HEAD + n * (degree + 1))``, one row for each step: its member; how many steps
            that made with it; how many of its steps were rejected until then; when it began; how
            long it is; and, component by component, ``degree + 1`` coefficients.
        degree: Of the polynomials: the order of the Taylor method; 7 for dop853, 3 for rk4.
        count: How many rows hold a step.
        terms: Formulas that are sought, as `coadjoint.solve.terms` writes them; None for none.
            Steps on which none of them comes near zero, and which follow such a step with the same
            signs, need not be recorded: solvers in C leave them out.
    """

    rows: Array
    degree: int
    count: int = 0
    terms: NDArray[np.void] | None = None

    @classmethod
    def make(cls, n: int, degree: int, room: int, terms: NDArray[np.void] | None = None) -> Record:
        """An empty record.

        Args:
            n: Components of the state.
            degree: Of the polynomials.
            room: For how many steps; `ROOM` at the least. A call of a solver ends when it is full.
            terms: Formulas that are sought.
        """
        rows = np.empty((max(room, ROOM), HEAD + n * (degree + 1)))
        return cls(rows, degree, terms=terms)

    def clear(self) -> None:
        """Forget all steps, so that there is room for others."""
        self.count = 0

    def hand_over(self) -> Array:
        """The polynomials, for good: the next steps are recorded elsewhere."""
        if 2 * self.count < len(self.rows):
            return self.path.copy()
        path, self.rows = self.path, np.empty_like(self.rows)
        return path

    @property
    def member(self) -> NDArray[np.intp]:
        """Whose steps they are, ``(count,)``."""
        return self.rows[: self.count, 0].astype(np.intp)

    @property
    def begun(self) -> Array:
        """When they begin, ``(count,)``."""
        return self.rows[: self.count, 3]

    @property
    def length(self) -> Array:
        """How long they are, ``(count,)``."""
        return self.rows[: self.count, 4]

    @property
    def path(self) -> Array:
        """Their polynomials, ``(count, n, degree + 1)``."""
        n = (self.rows.shape[1] - HEAD) // (self.degree + 1)
        return self.rows[: self.count, HEAD:].reshape(self.count, n, self.degree + 1)

    def append(self, head: Array, path: Array) -> None:
        """Add steps: the numbers of each before its polynomials, ``(HEAD, M)``, and these."""
        rows = self.rows[self.count : self.count + head.shape[1]]
        rows[:, :HEAD] = head.T
        rows[:, HEAD:] = path.transpose(2, 0, 1).reshape(len(rows), -1)
        self.count += len(rows)
