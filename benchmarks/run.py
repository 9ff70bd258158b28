"""Measure every figure, each table by a script of its own, and print one table at the end.

python benchmarks/run.py [NAME ...]      names of benchmarks; by default all

Each benchmark is a process of its own: a fault in one leaves the others, and Ctrl-C ends it at
once, wherever it is. Files go to `results/`. The exit status is 1 where a target is missed or a
benchmark failed.
"""

from __future__ import annotations

import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

from figures import VERDICTS, Figure

BENCHMARKS = (
    "start",
    "derivation",
    "algebra",
    "rolling",
    "operations",
    "emission",
    "c_kernels",
    "numpy_kernels",
    "call_overhead",
    "families",
    "fields",
    "ensembles",
    "ensembles_jax",
    "trajectories",
    "structure",
    "methods",
    "memory",
)
#: Those that have figures and nothing more: their files are written here.
PLAIN = (
    "start",
    "derivation",
    "algebra",
    "rolling",
    "operations",
    "emission",
    "call_overhead",
    "memory",
)
#: Modules of peers with what pip calls them; `pip install 'coadjoint[bench]'` has all of them.
PEERS = {
    "heyoka": "heyoka",
    "numba": "numba",
    "scipy": "scipy",
    "symengine": "symengine",
    "casadi": "casadi",
    "jax": "jax",
    "diffrax": "diffrax",
    "poisson": "poissongeometry",
}


def main(names: tuple[str, ...]) -> int:
    """Run benchmarks and print their figures."""
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        print(f"unknown: {', '.join(unknown)}; expected {', '.join(BENCHMARKS)}", file=sys.stderr)
        return 2
    print(f"{processor()}, Python {platform.python_version()}")
    for module, package in PEERS.items():
        if find_spec(module) is None:
            print(f"{package} is not installed: pip install {package}")
    figures = [figure for name in names for figure in run(name)]
    print_figures(figures)
    return 1 if any(figure.met is False for figure in figures) else 0


def run(name: str) -> list[Figure]:
    """The figures of a benchmark; one that says so where it failed."""
    start = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "figures.json"
        process = subprocess.Popen(
            [sys.executable, "-P", __file__, "--into", str(answer), name],
            env={**os.environ, "TMPDIR": folder, "PYTHONPATH": str(Path(__file__).parent)},
            process_group=0,  # with whatever it starts
        )
        try:
            status = process.wait()
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            raise
        print(f"{name}: {perf_counter() - start:.0f} s", flush=True)
        if not answer.exists():
            return [Figure(name, "runs", f"failed with the exit status {status}", met=False)]
        return [Figure(**each) for each in json.loads(answer.read_text(encoding="utf-8"))]


def measure(name: str, answer: Path) -> None:
    """Run a benchmark in this process, and write what it found."""
    from results import write

    module = import_module(name)
    figures = module.measure()
    if name in PLAIN:
        write(name, {"what": (module.__doc__ or name).partition("\n")[0]}, (), figures)
    answer.write_text(json.dumps([vars(each) for each in figures]), encoding="utf-8")


def print_figures(figures: list[Figure]) -> None:
    """All figures as one table."""
    from coadjoint.cli.output import print_table

    print_table(
        ("figure", ">target", ">measured", ""),
        [(each.what, each.target, each.measured, VERDICTS[each.met]) for each in figures],
    )


def processor() -> str:
    """The model of the processor, where the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    models = [line.partition(": ")[2] for line in lines if line.startswith("model name")]
    return f"{models[0] if models else platform.machine()}, {len(models)} processors"


if __name__ == "__main__":
    if sys.argv[1:2] == ["--into"]:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        measure(sys.argv[3], Path(sys.argv[2]))
        sys.exit()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C does
    try:
        sys.exit(main(tuple(sys.argv[1:]) or BENCHMARKS))
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        sys.exit(130)
