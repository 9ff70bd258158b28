"""What every benchmark shares: the record of a figure, interleaved timing, and a fresh process.

The machine is noisy, so competitors take turns and the best of many rounds counts; results are
compared as well as speed.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

SYSTEMS = ("rigid_body", "heavy_top", "kirchhoff")


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


def best_of(
    competitors: Mapping[str, Callable[[], object]], rounds: int, calls: int = 1
) -> dict[str, float]:
    """Seconds of the fastest call of each competitor; they take turns.

    Args:
        competitors: What to call, by name.
        rounds: How often each has its turn.
        calls: Calls in a turn; the mean of a turn counts.
    """
    best = dict.fromkeys(competitors, float("inf"))
    for _ in range(rounds):
        for name, function in competitors.items():
            start = perf_counter()
            for _ in range(calls):
                function()
            best[name] = min(best[name], (perf_counter() - start) / calls)
    return best


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
        verdict = {True: "met", False: "MISSED", None: ""}[figure.met]
        print(f"{figure.what}: {figure.measured} (target {figure.target}) {verdict}".rstrip())
