"""Kinks: where simulated trajectories met the kinks of their rates.

Comes in: an `Ensemble` at its end. Goes out: a table of the kinks, which a `Solution` holds.
Read next: `coadjoint.solve.limits`, which finds them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.ensemble import MET

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.ensemble import Ensemble

    Place = tuple[int, ...]

#: Roundings of time: a kink in time is met again where the time after it is rounded to before it.
ROUNDINGS = 2.0**-47
#: Kinks that are named where all are told of in one line.
SHOWN = 6


@dataclass(frozen=True)
class Kinks:
    """The kinks of the rates, and where trajectories met them.

    Attributes:
        names: What is 0 at each kink, as text in the components of the System.
        counts: How many kinks each trajectory met, of the shape of the batch: steps that ended at
            one. Two kinks that are met at once count once.
        rows: Which trajectory of the batch, counted from 0, which kink, and when, ``(count, 3)``;
            trajectory by trajectory in the order of time.

    >>> Kinks(("x",), np.array(1), np.array([[0.0, 0.0, 2.5]]))
    <Kinks: 1 of x>
    """

    names: tuple[str, ...]
    counts: NDArray[np.uint64]
    rows: Array

    @property
    def member(self) -> NDArray[np.intp]:
        """Which trajectory of the batch met each, ``(count,)``; all are 0 without a batch."""
        return self.rows[:, 0].astype(np.intp)

    @property
    def kink(self) -> NDArray[np.intp]:
        """Which of the kinks each was, as a place in `names`, ``(count,)``."""
        return self.rows[:, 1].astype(np.intp)

    @property
    def time(self) -> Array:
        """When each was met, ``(count,)``."""
        return self.rows[:, 2]

    def __len__(self) -> int:
        return len(self.rows)

    def take(self, place: Place) -> Kinks:
        """Those of one trajectory of the batch."""
        number = int(np.ravel_multi_index(place, self.counts.shape)) if place else 0
        rows = self.rows[self.rows[:, 0] == number].copy()
        rows[:, 0] = 0.0
        return Kinks(self.names, np.asarray(self.counts[place]), rows)

    def as_record(self) -> dict[str, Any]:
        """All of it as JSON values."""
        return {
            "names": list(self.names),
            "counts": self.counts.tolist(),
            "rows": self.rows.tolist(),
        }

    @classmethod
    def read_record(cls, record: dict[str, Any]) -> Kinks:
        """What `as_record` wrote."""
        return cls(
            tuple(record["names"]),
            np.array(record["counts"], np.uint64),
            np.array(record["rows"], np.float64).reshape(-1, 3),
        )

    def __repr__(self) -> str:
        told = [*self.names[:SHOWN], *(["..."] * (len(self.names) > SHOWN))]
        return f"<Kinks: {len(self)} of {', '.join(told)}>"


def list_kinks_met(run: Ensemble, names: tuple[str, ...], batch: Place) -> Kinks | None:
    """The kinks that an ensemble met; None where its rates have none.

    Args:
        run: At its end. What a member met after an event ended it is left out.
        names: What is 0 at each kink. Those of one name are one kink, as of equal members that
            all change with the time.
        batch: The shape of the batch.
    """
    if run.kinks is None:
        return None
    rows, places = run.list_met(), {name: n for n, name in enumerate(dict.fromkeys(names))}
    rows[:, 2] = np.array([places[name] for name in names])[rows[:, 2].astype(np.intp)]
    rows, names = np.unique(rows, axis=0), tuple(places)
    member = rows[:, 0].astype(np.intp)
    rows = rows[rows[:, MET - 1] <= run.time[member]]
    rows = _leave_out_repeated(rows)
    steps = np.unique(rows[:, :2], axis=0)[:, 0].astype(np.intp)
    counts = np.bincount(steps, minlength=run.kinks.size).astype(np.uint64)
    return Kinks(names, counts.reshape(batch), rows[:, [0, 2, 3]])


def _leave_out_repeated(rows: Array) -> Array:
    """Rows by member and step, without kinks that were met again within the roundings of time."""
    rows = rows[np.lexsort((rows[:, 3], rows[:, 2], rows[:, 0]))]
    same = (rows[1:, [0, 2]] == rows[:-1, [0, 2]]).all(axis=1)
    soon = np.diff(rows[:, 3]) <= ROUNDINGS * np.abs(rows[1:, 3])
    rows = rows[np.append(True, ~(same & soon))[: len(rows)]]
    return rows[np.lexsort((rows[:, 2], rows[:, 1], rows[:, 0]))]


def describe_sliding(kinks: Kinks) -> str:
    """Which kinks a trajectory slides along: those that it met last."""
    last = kinks.kink[kinks.time >= kinks.time[-1] - 2.0**-40 * abs(kinks.time[-1])]
    return " and ".join(f"{kinks.names[n]} = 0" for n in sorted({*last.tolist()}))
