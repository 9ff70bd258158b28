"""Steps that were taken: what every kind of them can tell of the states on the way.

Comes in: nothing. Goes out: the protocol of `coadjoint.solve.recording.Polynomials`, the steps of
generated solvers, and `coadjoint.solve.dense_output.Interpolants`, those of SciPy.
Read next: `coadjoint.solve.crossings`, which looks for events in them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]


class Steps(Protocol):
    """Steps that were taken, those of each member in the order of time.

    Attributes:
        member: Whose each is, ``(S,)``; those of one member stand together.
        start: When it begins.
        size: How long it is.
        degree: Of the polynomials of the state.
    """

    @property
    def member(self) -> Places:
        """As above."""
        ...

    @property
    def start(self) -> Array:
        """As above."""
        ...

    @property
    def size(self) -> Array:
        """As above."""
        ...

    @property
    def degree(self) -> int:
        """As above."""
        ...

    def evaluate(self, rows: Places, after: Array) -> Array:
        """States ``(n, R, K)`` of the steps ``rows``, some time ``(R, K)`` after their starts."""
        ...

    def narrow(self, only: Places) -> Callable[[Places, Array], Array]:
        """The same for some components alone."""
        ...

    def bound(self, row: int) -> tuple[Array, Array] | None:
        """A value of a component on each step, and how far others are from it at the most.

        None where no such bounds are known.
        """
        ...


class Bounds(NamedTuple):
    """Bounds of a function on steps, each ``(S,)``.

    Attributes:
        middle: One of its values.
        reach: How far others are from it at the most.
        size: What the size of its terms is at the most.
    """

    middle: Array
    reach: Array
    size: Array
