"""How long one waits before anything begins: imports, the help of the program, a first call."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from statistics import median

from figures import Figure, fresh_process, script

IMPORT = """
import sys, time
import coadjoint.systems.heavy_top
assert "sympy" not in sys.modules and "numpy" not in sys.modules
print(time.process_time())
"""
HELP = """
import contextlib, io, sys, time
from coadjoint.cli import main
with contextlib.redirect_stdout(io.StringIO()) as text:
    main(["--help"], standalone_mode=False)
assert "regenerate" in text.getvalue() and "sympy" not in sys.modules
print(time.process_time())
"""


#: Processor seconds of a first call beyond importing NumPy, those of the compiler included. They
#: are those of one thread: the threads of NumPy's BLAS spin for some time after its import.
FIRST = """
import sys
from resource import RUSAGE_CHILDREN, RUSAGE_THREAD, getrusage
import numpy as np
def seconds():
    return sum(sum(getrusage(who)[:2]) for who in (RUSAGE_THREAD, RUSAGE_CHILDREN))
start = seconds()
from importlib import import_module
system = import_module(f"coadjoint.systems.{sys.argv[1]}").system
system.rhs(np.ones(system.STATE.size))
assert "sympy" not in sys.modules
print(seconds() - start)
"""
#: Seconds on a new machine and in a second process, for each system.
FIRST_TARGETS = {"heavy_top": (1.5, 0.05), "so8_body": (1.5, 0.05)}


def first_calls(name: str, runs: int = 5) -> tuple[float, float]:
    """Seconds of the first ``rhs`` with an empty cache, and in processes after that: medians."""
    fresh, again = [], []
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as cache:
            for taken in (fresh, again):
                done = subprocess.run(
                    [sys.executable, "-P", "-c", FIRST, name],
                    env={**os.environ, "COADJOINT_CACHE": f"{cache}/cache"},
                    check=True,
                    capture_output=True,
                    text=True,
                )
                taken.append(float(done.stdout))
    return median(fresh), median(again)


def first_figures() -> list[Figure]:
    """How long the first call takes."""
    figures = []
    for name, targets in FIRST_TARGETS.items():
        cases = ("with an empty cache", "in a second process")
        for case, most, taken in zip(cases, targets, first_calls(name), strict=True):
            what = f"{name}: first rhs beyond importing NumPy, {case}"
            figures.append(Figure(what, f"<= {most:g} s", f"{taken:.3f} s", taken <= most))
    return figures


def measure() -> list[Figure]:
    """Processor time of a fresh process, Python's own start included."""
    system, program = fresh_process(IMPORT), fresh_process(HELP)
    return [
        *first_figures(),
        Figure(
            "import coadjoint.systems.heavy_top", "<= 0.15 s", f"{system:.3f} s", system <= 0.15
        ),
        Figure("coadjoint --help", "<= 0.20 s", f"{program:.3f} s", program <= 0.2),
    ]


if __name__ == "__main__":
    script(measure)
