"""A run that is broken off: a program that tests start, and that SIGKILL ends.

It stands in a file of its own, so that the process that is killed and the test that goes on after
it ask for the same.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from dataclasses import replace
from functools import cache

import numpy as np

from coadjoint.render.kernels import render_system
from coadjoint.solve import checkpoints, march
from coadjoint.solve.calls import CStepper
from coadjoint.solve.events import Event
from coadjoint.solve.folders import load_folder
from coadjoint.solve.twins import NumpyStepper
from coadjoint.systems import heavy_top
from tests.programs import FOLLOWED
from tests.trees_of_files import folder_until_exit

BATCH = np.random.default_rng(5).normal(size=(6, 43))
#: On the circle of radius 1.
PLACES = np.array([np.cos(np.linspace(1.5, 2.5, 9)), np.sin(np.linspace(1.5, 2.5, 9))])
#: Runs by name: adaptive and fixed steps, all samples and the end alone, both languages, events
#: with all steps, of members and of one, and a path that is reconstructed.
RUNS = {
    "taylor": {"state": BATCH, "t": (0, 40), "samples": 21},
    "dop853 in threads": {
        "state": BATCH,
        "t": np.linspace(0, 1, 9) ** 2 * 30,
        "method": "dop853",
        "parameters": {"m": np.linspace(1, 2, 43)},
    },
    "rk4": {"state": BATCH[:, 0], "t": (0, 50), "method": "rk4", "step": 1e-3, "samples": 1},
    "midpoint": {
        "state": BATCH[:, :9],
        "t": (0, 20),
        "parameters": {"I": [3.0, 4.0, 5.0], "g": 1.0},
        "method": "midpoint",
        "step": 2e-3,
        "samples": 3,
    },
    "numpy": {"state": BATCH[:, :5], "t": (0, 5), "samples": 4, "target": "numpy"},
    "events": {
        "state": BATCH,
        "t": (0, 20),
        "samples": 5,
        "events": ["Pi1 == 0.2", Event("Gamma3 == 0.1", terminal=7, name="end")],
        "dense": True,
    },
    "one with events": {
        "state": BATCH[:, 3],
        "t": (0, 20),
        "samples": 3,
        "method": "dop853",
        "events": ["Pi1 == 0.2", Event("Gamma3 == 0.1", terminal=11, name="end")],
        "dense": True,
    },
    "path": {
        "state": PLACES,
        "t": (0, 9),
        "samples": 4,
        "method": "rk4",
        "step": 0.01,
        "reconstruct": {"x": [*range(9)]},
        "events": ["y == 1", Event("q == p", direction=1)],
        "dense": True,
    },
}


@cache
def followed():
    """An oscillator whose path is reconstructed, without its domain, which it would leave soon."""
    programs = tuple(each for each in FOLLOWED.programs if each.name != "domain")
    folder = folder_until_exit()
    for file, text in render_system(replace(FOLLOWED, programs=programs, domain=())).items():
        (folder / file).write_text(text)
    return load_folder(folder)


def go(name, path=None, **options):
    """The Solution of one of the runs."""
    system = followed() if name == "path" else heavy_top
    return system.simulate(**RUNS[name], checkpoint=path, **options)


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
