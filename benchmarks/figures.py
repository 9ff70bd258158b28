"""What every benchmark shares: the record of a figure, interleaved timing, and a fresh process.

The machine is noisy, so competitors take turns, and medians count with their spread; results are
compared as well as speed.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import process_time
from typing import NamedTuple

SYSTEMS = ("rigid_body", "heavy_top", "kirchhoff")
#: How a table says whether a target is met.
VERDICTS = {True: "met", False: "MISSED", None: ""}


@dataclass(frozen=True)
class Figure:
    """One line of the table.

    Attributes:
        what: What is measured.
        target: What it should be, as text.
        measured: What it is, as text.
        met: Whether the target is met; None where there is no target or no peer.
    """

    what: str
    target: str
    measured: str
    met: bool | None = None


class Spread(NamedTuple):
    """Seconds of a call over the rounds."""

    median: float
    fastest: float
    slowest: float

    def text(self, unit: float, name: str) -> str:
        """Median and spread in a unit of so many seconds."""
        each = (f"{value / unit:.3g}" for value in self)
        return "{} {} ({} to {})".format(next(each), name, *each)


def take_turns(
    competitors: Mapping[str, Callable[[], object]],
    rounds: int,
    calls: int = 1,
    clock: Callable[[], float] = process_time,
) -> dict[str, Spread]:
    """Seconds of a call of each competitor; they take turns.

    Args:
        competitors: What to call, by name.
        rounds: How often each has its turn.
        calls: Calls in a turn; the mean of a turn counts.
        clock: What counts: processor time, or wall time for what takes microseconds.
    """
    taken: dict[str, list[float]] = {name: [] for name in competitors}
    for _ in range(rounds):
        for name, function in competitors.items():
            start = clock()
            for _ in range(calls):
                function()
            taken[name].append((clock() - start) / calls)
    return {
        name: Spread(statistics.median(each), min(each), max(each)) for name, each in taken.items()
    }


def fresh_process(code: str, runs: int = 5, *, median: bool = False) -> float:
    """Smallest number, or the median, of those that ``code`` prints in several fresh processes."""
    command = [sys.executable, "-P", "-c", code]
    answers = [
        subprocess.run(command, check=True, capture_output=True, text=True).stdout
        for _ in range(runs)
    ]
    return statistics.median(map(float, answers)) if median else min(map(float, answers))


def script(measure: Callable[[], list[Figure]]) -> None:
    """Print the figures of one benchmark."""
    for figure in measure():
        verdict = VERDICTS[figure.met]
        print(f"{figure.what}: {figure.measured} (target {figure.target}) {verdict}".rstrip())
