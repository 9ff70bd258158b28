"""From a spec to verified kernels on disk, with an empty cache: proofs and cross-check included."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from time import perf_counter

from figures import Figure, script

#: System and the seconds it may take on two processors.
TARGETS = {"so8_body": 15.0, "bargmann": None}
RUNS = 3
#: Seconds for all systems, with nothing remembered and with nothing changed.
ALL_COLD, ALL_WARM = 240.0, 10.0


def measure() -> list[Figure]:
    """Seconds of ``coadjoint regenerate`` for one system, the median of a few cold runs."""
    figures = []
    for system, most in TARGETS.items():
        taken = sorted(_seconds(system) for _ in range(RUNS))[RUNS // 2]
        what = f"{system}: regenerate with an empty cache"
        measured = f"{taken:.1f} s"
        if most is None:
            figures.append(Figure(what, "none", measured))
        else:
            figures.append(Figure(what, f"<= {most:g} s", measured, taken <= most))
    with tempfile.TemporaryDirectory() as folder:
        cold, warm = _regenerate(folder), _regenerate(folder)
    for state, taken, most in (("cold", cold, ALL_COLD), ("warm", warm, ALL_WARM)):
        what = f"all systems: regenerate, {state}"
        figures.append(Figure(what, f"<= {most:g} s", f"{taken:.1f} s", taken <= most))
    return figures


def _seconds(system: str) -> float:
    """One run into a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        return _regenerate(folder, system)


def _regenerate(folder: str, *systems: str) -> float:
    """Seconds of one run with cache and output in a folder; by default of all systems."""
    command = [sys.executable, "-P", "-m", "coadjoint.cli", "regenerate", *systems]
    start = perf_counter()
    subprocess.run(
        [*command, "--output", f"{folder}/generated"],
        env={**os.environ, "COADJOINT_CACHE": f"{folder}/cache"},
        check=True,
        capture_output=True,
    )
    return perf_counter() - start


if __name__ == "__main__":
    script(measure)
