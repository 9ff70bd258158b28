"""A run that is broken off: a program that tests start, and that SIGKILL ends.

It stands in a file of its own, so that the process that is killed and the test that goes on after
it ask for the same.
"""

from __future__ import annotations

import os
import signal
import sys
import time

import numpy as np

from coadjoint.solve import checkpoints, march
from coadjoint.solve.calls import CStepper
from coadjoint.solve.solvers import NumpyStepper
from coadjoint.systems import heavy_top

BATCH = np.random.default_rng(5).normal(size=(6, 43))
#: Runs by name: adaptive and fixed steps, all samples and the end alone, both languages, a fall.
RUNS = {
    "taylor": {"state": BATCH, "t": (0, 40), "samples": 21},
    "dop853 in threads": {
        "state": BATCH,
        "t": np.linspace(0, 1, 9) ** 2 * 30,
        "method": "dop853",
        "parameters": {"m": np.linspace(1, 2, 43)},
    },
    "rk4": {"state": BATCH[:, 0], "t": (0, 50), "method": "rk4", "step": 1e-3, "samples": 1},
    "numpy": {"state": BATCH[:, :5], "t": (0, 5), "samples": 4, "target": "numpy"},
}


def go(name, path=None, **options):
    """The Solution of one of the runs."""
    return heavy_top.simulate(**RUNS[name], checkpoint=path, **options)


def die():
    """End without a chance to do anything else."""
    os.kill(os.getpid(), signal.SIGKILL)


def main(name, path, place, count, threads):
    """Run until SIGKILL comes.

    Args:
        name: One of `RUNS`.
        path: Of the checkpoint.
        place: ``"writing"``: this process kills itself before the last checkpoint is in its place.
            ``"computing"``: it prints a line and is killed by another.
        count: So many checkpoints are written before.
        threads: How many share the run.
    """
    go(name)  # compiled and loaded, which writes files of its own
    CStepper.first_work = NumpyStepper.first_work = 5
    march.GROWTH = 1.0  # short calls,
    checkpoints.SECONDS, checkpoints.SHARE = 0.0, np.inf  # and a checkpoint after each
    march.REPORT_SECONDS = 0.0
    sync, seen = os.fsync, []

    def note(handle):
        sync(handle)
        seen.append(handle)
        if len(seen) > count and place == "writing":
            die()
        if len(seen) > count:
            print("waits", flush=True)
            time.sleep(3600)

    os.fsync = note
    go(name, path, threads=threads)


if __name__ == "__main__":
    main(*sys.argv[1:4], *map(int, sys.argv[4:]))
