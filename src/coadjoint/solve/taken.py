"""Steps that were taken: what every kind of them can tell of the states on the way.

Comes in: nothing. Goes out: the protocol of `coadjoint.solve.recording.Polynomials`, the steps of
generated solvers, and `coadjoint.solve.dense_output.Interpolants`, those of SciPy.
Read next: `coadjoint.solve.crossings`, which looks for events in them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from coadjoint.array_types import Array, Places
    from coadjoint.solve.enclosures import Enclosure


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

    def follow(self, rows: Places, only: Places | None = None) -> Callable[[Array], Array]:
        """States ``(n, ..., R)`` of the steps ``rows``, some time ``(..., R)`` after their starts.

        Args:
            rows: The steps, ``(R,)``.
            only: The components that are wanted; None for all.
        """
        ...

    def enclose(self, row: int) -> Enclosure | None:
        """The enclosure of a component over all steps; None where none is known."""
        ...


class Enclosed(NamedTuple):
    """What is known of a function over steps.

    Attributes:
        value: Its enclosure.
        size: What the size of its terms is at the most, ``(S,)``.
    """

    value: Enclosure
    size: Array
