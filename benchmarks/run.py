"""Measure every figure and print one table; exit status 1 if a target is missed.

python benchmarks/run.py [NAME ...]      names of benchmarks; by default all
"""

from __future__ import annotations

import platform
import sys
from importlib import import_module
from pathlib import Path

from coadjoint.cli.output import print_table

BENCHMARKS = (
    "start",
    "derivation",
    "algebra",
    "rolling",
    "emission",
    "c_kernels",
    "numpy_kernels",
    "call_overhead",
    "ensembles",
    "trajectories",
    "memory",
)


def main(names: tuple[str, ...]) -> int:
    """Run benchmarks and print their figures."""
    figures = [figure for name in names for figure in import_module(name).measure()]
    verdicts = {True: "met", False: "MISSED", None: ""}
    machine = f"{processor()}, Python {platform.python_version()}"
    print(f"{machine}; best of interleaved rounds, medians of processes")
    print_table(
        ("figure", ">target", ">measured", ""),
        [(each.what, each.target, each.measured, verdicts[each.met]) for each in figures],
    )
    return 1 if any(figure.met is False for figure in figures) else 0


def processor() -> str:
    """The model of the processor, where the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    models = [line.partition(": ")[2] for line in lines if line.startswith("model name")]
    return f"{models[0] if models else platform.machine()}, {len(models)} processors"


if __name__ == "__main__":
    sys.exit(main(tuple(sys.argv[1:]) or BENCHMARKS))
