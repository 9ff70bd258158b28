"""Arms: from where a body touches a plane to its centre of mass, by its generated functions.

The velocity of the centre of a body that rolls is ``Y = Omega x s``, that of the point of a sliding
body at its contact is ``Y - Omega x s``, with the arm s a function of the vertical Gamma seen from
the body. Both are linear in Omega: generated functions give s for every Gamma, and no name of a
variable is known. Comes in: a `Solution`, and which variables may be these. Goes out: arms.
Read next: `coadjoint.solve.rolling_bodies`.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import CoadjointError

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Largest part of Y that is no ``Omega x s``: the generated functions round.
ROUNDED: Final = 1e-9


@dataclass(frozen=True)
class Arms:
    """Which variables tell of the arms of a body.

    Attributes:
        vertical: Gamma, part of the state.
        turning: Omega, part of the state.
        moving: The observable that is ``Y``, or ``Y - Omega x s`` of a body that slides.
        sliding: Y of a body that slides, part of the state; "" of one that rolls.
    """

    vertical: str
    turning: str
    moving: str
    sliding: str = ""

    def find(self, solution: Solution, verticals: Array) -> Array | None:
        """The arms for verticals, ``(3, N)``; None where the observable is no such thing."""
        still = np.zeros_like(verticals)
        columns: list[Array] = []
        for axis in np.eye(3):
            column = self.move(solution, verticals, axis[:, None] + still, still)
            if column is None:
                return None
            columns.append(column)
        matrix = np.stack(columns, axis=1)  # (3, 3, N), by the components of Y and of Omega
        size = float(np.abs(matrix).max())
        if not np.isfinite(size) or not size:
            return None
        if np.abs(matrix + matrix.swapaxes(0, 1)).max() > ROUNDED * size:
            return None
        sign = -1.0 if self.sliding else 1.0
        arms: Array = sign * np.stack([-matrix[2, 1], matrix[2, 0], matrix[0, 1]])
        return arms

    def move(
        self, solution: Solution, vertical: Array, turning: Array, sliding: Array
    ) -> Array | None:
        """The observable where variables have these values, ``(3, N)`` each, others as they begin.

        None where it asks for time or inputs, or for verticals that its domain does not have.
        """
        system = solution.system
        state = np.repeat(np.asarray(solution.state)[:, :1], vertical.shape[1], axis=1)
        given = {self.vertical: vertical, self.turning: turning}
        given |= {self.sliding: sliding} if self.sliding else {}
        for name, values in given.items():
            state[system.STATE.rows(name)] = values
        try:
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                found = system.observables(state, solution.parameters, target="numpy")
        except (CoadjointError, TypeError, ValueError):
            return None
        own: Array = np.asarray(found)[system.OBSERVABLES.rows(self.moving)]
        return own


def list_vectors(quantities: Any, but: Sequence[str] = ()) -> list[str]:
    """Names of vectors of three components, some names apart."""
    return [name for name, each in quantities.items() if each.shape == (3,) and name not in but]
