"""The march: an ensemble to its end, by one thread or several.

Comes in: an `Ensemble` and a solver. Goes out: the same ensemble, every member at its end or where
it came. Members do not know of each other, so that the number of threads changes no bit. Each call
of a solver is short, so that Ctrl-C is heard and progress is told. Read next:
`coadjoint.solve.generated`.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event
from typing import TYPE_CHECKING, Protocol

import numpy as np

from coadjoint.solve.ensemble import Status
from coadjoint.solve.step_records import Record

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.checkpoints import Checkpoint
    from coadjoint.solve.ensemble import Ensemble
    from coadjoint.solve.solvers import Stepper

#: Told now and then: the part of the way that is done, from 0 to 1.
Progress = Callable[[float], object]
#: Seconds that one call of a solver is to take, and those between two reports.
CALL_SECONDS, REPORT_SECONDS = 0.05, 0.1
#: Seconds after which a bar appears.
BAR_SECONDS = 1.0
#: Members of a slice, at the least, where threads share a batch: the last ones of a slice leave
#: lanes idle.
SLICE = 256
#: How many more steps of a block a call may try than the one before, and the most of a call.
GROWTH, MOST_WORK = 4.0, 2**40
#: Numbers that a record of steps holds, about: 8 MB.
RECORDED = 2**20


def count_threads() -> int:
    """Processors that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Watch(Protocol):
    """Who looks at steps.

    Attributes:
        terms: As `Record` has them.
    """

    terms: NDArray[np.void] | None

    def look(self, record: Record) -> None:
        """Look at the steps of a call, in the thread that made them; stop members of these."""
        ...


@dataclass(frozen=True)
class _Going:
    """Who advances what.

    Attributes:
        stepper: Who advances it.
        run: Its members.
        watch: Shown all steps; None for nobody.
        until: When a round of calls ends. Each slice has one call at the least, however late it is
            begun, so that a busy machine goes on as well.
        stop: Set where all have to end at once.
    """

    stepper: Stepper
    run: Ensemble
    watch: Watch | None
    until: float
    stop: Event


def march(
    stepper: Stepper,
    run: Ensemble,
    start: float,
    threads: int,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
    watch: Watch | None = None,
) -> None:
    """Advance an ensemble to its end.

    Args:
        stepper: Who advances it.
        run: Its members, begun.
        start: When they began.
        threads: How many threads share it, at the most.
        progress: Told how far it is; None for nobody.
        checkpoint: Written now and then, and at the end; None for none.
        watch: Shown all steps that are made; None for nobody. It is called by several threads.

    Raises:
        KeyboardInterrupt: Ctrl-C; members stand where they came.
        OutputError: The checkpoint cannot be written.
    """
    slices = _cut(run.state.shape[1], threads)

    def report() -> None:
        if progress is not None:
            progress(_find_part(run, start))

    while (run.status == Status.GOES_ON).any():
        seconds = math.inf if checkpoint is None else checkpoint.seconds
        going = _Going(
            stepper=stepper, run=run, watch=watch, until=time.monotonic() + seconds, stop=Event()
        )
        _go_on(going, slices, threads, report)
        if checkpoint is not None:
            checkpoint.write(run)
    report()


def _go_on(
    going: _Going,
    slices: list[tuple[int, int]],
    threads: int,
    report: Callable[[], None],
) -> None:
    """Advance all slices to the end, or for a round; nobody computes any more when it returns."""
    if len(slices) > 1:
        _share(going, slices, threads, report)
        return
    reported = time.monotonic()
    for now in _advance(going, *slices[0]):
        if now - reported > REPORT_SECONDS:
            report()
            reported = now


def _share(
    going: _Going,
    slices: list[tuple[int, int]],
    threads: int,
    report: Callable[[], None],
) -> None:
    """Have threads take one slice after the other; each ends soon where this one is interrupted."""

    def work(first: int, last: int) -> None:
        for _ in _advance(going, first, last):
            pass

    with ThreadPoolExecutor(min(threads, len(slices))) as pool:
        try:
            left = {pool.submit(work, *each) for each in slices}
            while left:
                done, left = wait(left, REPORT_SECONDS, FIRST_EXCEPTION)
                for each in done:
                    each.result()
                report()
        except BaseException:  # Ctrl-C among them
            going.stop.set()
            pool.shutdown(cancel_futures=True)
            raise


def _advance(going: _Going, first: int, last: int) -> Iterator[float]:
    """Advance a slice, one short call after the other; yields the time after each."""
    work, run, record = going.stepper.first_work, going.run, None
    if going.watch is not None:
        n, degree = len(run.state), going.stepper.degree
        record = Record.make(n, degree, RECORDED // (n * (degree + 1)), going.watch.terms)
    while not going.stop.is_set():
        begun = time.perf_counter()
        on = going.stepper.advance(run, first, last, work, record)
        took = max(time.perf_counter() - begun, 1e-9)
        if going.watch is not None and record is not None:
            going.watch.look(record)
            record.clear()
            on = int((run.status[first:last] == Status.GOES_ON).sum())
        if not on:
            return
        work = min(max(1, int(work * min(GROWTH, CALL_SECONDS / took))), MOST_WORK)
        now = time.monotonic()
        yield now
        if now >= going.until:
            return


def _cut(members: int, threads: int) -> list[tuple[int, int]]:
    """Slices of a batch: some for each thread, of whole blocks."""
    if threads == 1 or members < 2 * SLICE:
        count = 1 if threads == 1 else min(threads, -(-members // 8))
    else:
        count = max(threads, min(4 * threads, members // SLICE))
    size = max(1, -(-members // count))
    size = -(-size // 8) * 8 if count > 1 else size
    return [(first, min(first + size, members)) for first in range(0, members, size)]


def _find_part(run: Ensemble, start: float) -> float:
    """The part of the way that is done, from 0 to 1."""
    gone = (run.time - start) / (run.end - start)
    return float(np.where(run.status == Status.GOES_ON, gone, 1.0).mean())


@contextmanager
def progress_bar() -> Iterator[Progress | None]:
    """A bar on standard error for runs that take longer than a second, if it is a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    begun = time.monotonic()
    with Bar(console=Console(stderr=True), transient=True, auto_refresh=False) as bar:
        task = bar.add_task("simulating", total=1.0, visible=False)

        def tell(part: float) -> None:
            late = time.monotonic() - begun > BAR_SECONDS
            bar.update(task, completed=part, visible=late, refresh=late)

        yield tell
