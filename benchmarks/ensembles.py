"""Ensembles: generated solvers against heyoka and SciPy, at equal error, on one core.

python benchmarks/ensembles.py [SYSTEM ...]        by default five systems; some minutes

Competitors take turns in one run and processor time counts: the median of the rounds, with the
spread from the fastest to the slowest. Compilation counts nowhere. The error of a member is that of
its final state, relative to the size of the state; the reference is heyoka's in extended precision
at 1e-18 where its code is made in less than a minute, and else our own Taylor method of order 30
at 1e-18. Both stand beside heyoka in doubles at 1e-18, and their distance is printed.
How much faster at equal median error: the curve of time over error, straight between its points in
logarithms, read at the error of the peer. Writes JSON, Markdown and a plot to `results/`.
"""

from __future__ import annotations

import ctypes
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import peers
from figures import Figure
from run import processor

from coadjoint.build.compiler import find_compiler
from coadjoint.resources import systems_folder

#: Final times, and parameters.
SYSTEMS: Mapping[str, tuple[float, Sequence[float]]] = {
    "rigid_body": (100.0, (1, 2, 3)),
    "heavy_top": (100.0, (1, 1.5, 2, 1, 1, 0.1, 0.2, 1)),
    "kirchhoff": (100.0, (1, 2, 3, 2, 3, 4, 0, 0, 0)),
    "chaplygin_ball": (100.0, (1, 1.5, 2, 1, 1, 1, 0.05, 0.1, 0.2)),
    "so8_body": (20.0, (1, 2, 3, 4, 5, 6, 7, 8)),
}
#: Tolerances of heyoka, None for its own, and how many times faster we mean to be.
PEER_TOLERANCES = (1e-6, 1e-9, 1e-12, None)
TARGETS: Mapping[str, Sequence[float]] = {
    "rigid_body": (6, 4, 4, 2.5),
    "heavy_top": (5, 4, 3, 2.5),
    "kirchhoff": (3.3, 3, 2.8, 2.5),
    "chaplygin_ball": (2, 2, 2, 2),
    "so8_body": (2, 2, 2, 2),
}
TOLERANCES = {
    "Taylor": (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 2.2e-16),
    "DOP853": (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
}
MEMBERS, SLOW_MEMBERS, ROUNDS = 512, 32, 5
FLAGS = ("-std=c11", "-O3", "-fno-math-errno", "-ffp-contract=fast", "-march=native")
WIDE = "-mprefer-vector-width=512"
RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Point:
    """A competitor at one tolerance.

    Attributes:
        who: The competitor.
        tolerance: Its tolerance; None for its own.
        order: Of its method; 0 where it has none.
        microseconds: Processor time for each member: median, fastest, slowest round.
        error: Median of the relative errors.
        worst: The largest of them.
    """

    who: str
    tolerance: float | None
    order: int
    microseconds: tuple[float, float, float]
    error: float
    worst: float


class Run(ctypes.Structure):
    """The record ``..._run`` of ``solver.h``."""

    _fields_ = [
        *((name, ctypes.c_size_t) for name in ("members", "first", "last")),
        *((name, ctypes.c_void_p) for name in ("state", "time", "step", "next", "steps")),
        *((name, ctypes.c_void_p) for name in ("rejected", "status", "parameters")),
        ("parameters_stride", ctypes.c_size_t),
        *((name, ctypes.c_void_p) for name in ("knots", "inputs", "slopes")),
        *((name, ctypes.c_size_t) for name in ("pieces", "inputs_stride")),
        ("samples", ctypes.c_void_p),
        ("sample_count", ctypes.c_size_t),
        ("out", ctypes.c_void_p),
        *((name, ctypes.c_double) for name in ("rtol", "atol", "size")),
        *((name, ctypes.c_size_t) for name in ("max_steps", "work")),
    ]


def order_for(tolerance: float) -> int:
    """The order of Taylor's method that a tolerance asks for."""
    return math.ceil(1 - math.log(tolerance) / 2)


def compile_solver(source: Path, name: str, method: str, folder: Path) -> Any:
    """The function that advances members by one method."""
    target = folder / f"{name}{method}.so"
    command = [*find_compiler().command, *FLAGS, WIDE, "-shared", "-fPIC", method]
    subprocess.run([*command, str(source / "solver.c"), "-o", str(target), "-lm"], check=True)
    function = getattr(ctypes.CDLL(str(target)), f"{name}_advance")
    function.restype = ctypes.c_size_t
    return function


def propagate(
    advance: Any, parameters: Sequence[float], states: Any, end: float, tolerance: float
) -> Any:
    """Final states of all members."""
    members, zeros = states.shape[1], np.zeros(states.shape[1])
    arrays = {
        "state": states.copy(),
        "time": zeros.copy(),
        "step": zeros.copy(),
        "next": np.ones(members, np.uint64),
        "steps": np.zeros(members, np.uint64),
        "rejected": np.zeros(members, np.uint64),
        "status": np.zeros(members, np.int8),
        "parameters": np.array(parameters, float),
        "samples": np.array([0.0, end]),
        "knots": np.zeros(1),
    }
    run = Run(members=members, last=members, pieces=1, sample_count=2)
    run.rtol = run.atol = tolerance
    run.max_steps, run.work = 10**7, 2**62
    for name, array in arrays.items():
        setattr(run, name, array.ctypes.data)
    while advance(ctypes.byref(run)):
        pass
    assert (arrays["status"] == 1).all()
    return arrays["state"]


def errors_of(found: Any, reference: Any) -> Any:
    """Relative errors of members."""
    size = np.sqrt((reference**2).sum(axis=0))
    return (np.sqrt(((found - reference) ** 2).sum(axis=0)) / size).astype(float)


def time_at(points: Sequence[Point], error: float) -> float | None:
    """Microseconds to a median error, straight between points in logarithms.

    None where no point is so accurate; what is beyond the least accurate costs as much as that.
    """
    best: float | None = None
    ordered = sorted(points, key=lambda point: point.error)
    for fine, coarse in zip(ordered, [*ordered[1:], ordered[-1]], strict=True):
        if coarse.error <= error:
            candidate = coarse.microseconds[0]
        elif fine.error <= error:
            part = math.log(error / fine.error) / math.log(coarse.error / fine.error)
            logarithms = [math.log(each.microseconds[0]) for each in (fine, coarse)]
            candidate = math.exp(logarithms[0] + part * (logarithms[1] - logarithms[0]))
        else:
            continue
        best = candidate if best is None else min(best, candidate)
    return best


Competitor = tuple[str, float | None, int, int, Callable[[], Any]]


def our_competitors(name: str, source: Path, states: Any, folder: Path) -> list[Competitor]:
    """Generated methods at their tolerances."""
    end, parameters = SYSTEMS[name]
    found: list[Competitor] = []
    for method, tolerances in TOLERANCES.items():
        for tolerance in tolerances:
            order = order_for(tolerance) if method == "Taylor" else 8
            option = f"-DORDER={order}" if method == "Taylor" else "-DDOP853"
            advance = compile_solver(source, name, option, folder)

            def call(advance: Any = advance, tolerance: float = tolerance) -> Any:
                return propagate(advance, parameters, states, end, tolerance)

            found.append((method, tolerance, order, states.shape[1], call))
    return found


def peer_competitors(name: str, states: Any) -> list[Competitor]:
    """heyoka, where it is installed, and SciPy."""
    end, parameters = SYSTEMS[name]
    found: list[Competitor] = []
    for tolerance in PEER_TOLERANCES if peers.has_heyoka() else ():
        for who in ("heyoka", "heyoka, parameters of members"):
            peer = peers.Heyoka(name, parameters, tolerance, folded=who == "heyoka")

            def call(peer: peers.Heyoka = peer) -> Any:
                return peer.propagate(states, end)

            found.append((who, tolerance, peer.integrator.order, states.shape[1], call))
            if who == "heyoka" and tolerance == 1e-9:

                def drive(peer: peers.Heyoka = peer) -> Any:
                    return peer.propagate_ensemble(states, end)

                order = peer.integrator.order
                found.append(("heyoka's ensemble", tolerance, order, states.shape[1], drive))
    few = states[:, :SLOW_MEMBERS]
    one = states[:, :2]
    found += [
        (
            "SciPy, stacked",
            1e-9,
            8,
            few.shape[1],
            lambda: peers.propagate_stacked(name, parameters, few, end, 1e-9),
        ),
        (
            "SciPy, a loop",
            1e-9,
            8,
            one.shape[1],
            lambda: peers.propagate_each(name, parameters, one, end, 1e-9),
        ),
    ]
    return found


def reference_of(name: str, source: Path, states: Any, folder: Path) -> tuple[Any, str]:
    """Exact final states, as far as we know them, and what a second integrator says of them."""
    end, parameters = SYSTEMS[name]
    advance = compile_solver(source, name, "-DORDER=30", folder)
    ours = propagate(advance, parameters, states, end, 1e-18)
    if not peers.has_heyoka():
        return ours, "our own at 1e-18; heyoka is not installed and checks it not"
    peer = peers.Heyoka(name, parameters, 1e-18).propagate(states, end)
    if len(states) > 6:
        apart = errors_of(ours, peer)
        text = f"our own at 1e-18; heyoka in doubles is {median(apart):.1e} away"
        return ours, f"{text} in the median, {max(apart):.1e} at most"
    exact = peers.propagate_exactly(name, parameters, states, end)
    away = [median(errors_of(each, exact)) for each in (ours, peer)]
    text = "heyoka in extended precision at 1e-18; in doubles at 1e-18 "
    return exact, f"{text}ours is {away[0]:.1e} away and heyoka's {away[1]:.1e} in the median"


def measure_system(name: str, folder: Path) -> tuple[list[Point], str]:
    """All competitors on one system."""
    states = peers.initial_states(name, MEMBERS)
    source = systems_folder() / name
    reference, note = reference_of(name, source, states[:, :128], folder)
    competitors = our_competitors(name, source, states, folder) + peer_competitors(name, states)
    results = [each[4]() for each in competitors]
    taken: list[list[float]] = [[] for _ in competitors]
    for round_ in range(ROUNDS):
        for times, (who, _, _, members, call) in zip(taken, competitors, strict=True):
            if round_ == 0 or not who.startswith("SciPy"):
                times.append(peers.seconds_of(call) / members * 1e6)
    points = []
    for times, (who, tolerance, order, _, _), found in zip(
        taken, competitors, results, strict=True
    ):
        count = min(found.shape[1], reference.shape[1])
        away = errors_of(found[:, :count], reference[:, :count])
        spread = (median(times), min(times), max(times))
        points.append(Point(who, tolerance, order, spread, median(away), float(max(away))))
    return points, note


def compare(name: str, points: Sequence[Point]) -> list[Figure]:
    """How many times faster than the peers, at their median errors."""
    mine = [point for point in points if point.who in TOLERANCES]
    found = []
    for peer in points:
        if peer.who in TOLERANCES:
            continue
        each = {
            method: time_at([point for point in mine if point.who == method], peer.error)
            for method in TOLERANCES
        }
        ratios = {m: peer.microseconds[0] / t for m, t in each.items() if t is not None}
        if not ratios:
            sharpest = min(mine, key=lambda point: point.error)
            ratios[f"at {sharpest.error:.1e}, not {peer.error:.1e}, Taylor"] = (
                peer.microseconds[0] / sharpest.microseconds[0]
            )
        own = "its own" if peer.tolerance is None else f"{peer.tolerance:g}"
        is_goal = peer.who.startswith("heyoka") and peer.who != "heyoka's ensemble"
        target = TARGETS[name][PEER_TOLERANCES.index(peer.tolerance)] if is_goal else None
        text = ", ".join(f"{method} {ratio:.2f}" for method, ratio in ratios.items())
        met = None if target is None else max(ratios.values()) >= target
        what = f"{name}: times faster than {peer.who} at {own}"
        found.append(Figure(what, "" if target is None else f">= {target}", text, met))
    return found


def write(name: str, points: Sequence[Point], note: str, figures: Sequence[Figure]) -> None:
    """JSON, Markdown and a plot."""
    RESULTS.mkdir(exist_ok=True)
    stem = RESULTS / f"ensembles_{name}"
    record = {
        "system": name,
        "machine": processor(),
        "compiler": find_compiler().version,
        "flags": [*FLAGS, WIDE],
        "members": MEMBERS,
        "rounds": ROUNDS,
        "end": SYSTEMS[name][0],
        "parameters": SYSTEMS[name][1],
        "reference": note,
        "points": [asdict(point) for point in points],
        "figures": [asdict(figure) for figure in figures],
    }
    stem.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    stem.with_suffix(".md").write_text(markdown(name, points, note, figures), encoding="utf-8")
    plot(name, points, stem.with_suffix(".png"))


def markdown(name: str, points: Sequence[Point], note: str, figures: Sequence[Figure]) -> str:
    """The tables of one system."""
    lines = [
        f"# {name}",
        "",
        f"{processor()}; {find_compiler().version}; {' '.join((*FLAGS, WIDE))}.",
        f"{MEMBERS} members to t = {SYSTEMS[name][0]:g}; {ROUNDS} rounds. Reference: {note}.",
        "",
        "| competitor | tolerance | order | us a member | fastest | slowest | error | worst |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for point in points:
        own = "its own" if point.tolerance is None else f"{point.tolerance:g}"
        times = " | ".join(f"{each:.2f}" for each in point.microseconds)
        ends = f"{point.error:.1e} | {point.worst:.1e}"
        lines.append(f"| {point.who} | {own} | {point.order} | {times} | {ends} |")
    lines += ["", "| at equal median error | target | measured | |", "|---|---|---|---|"]
    verdicts = {True: "met", False: "missed", None: ""}
    lines += [f"| {f.what} | {f.target} | {f.measured} | {verdicts[f.met]} |" for f in figures]
    return "\n".join(lines) + "\n"


def plot(name: str, points: Sequence[Point], path: Path) -> None:
    """Time over error, where matplotlib is installed."""
    try:
        from matplotlib.figure import Figure as Canvas
    except ImportError:
        print(f"{path.name} is not drawn: matplotlib is not installed")
        return
    canvas = Canvas(figsize=(6, 4.5), layout="constrained")
    axes = canvas.add_subplot()
    for who in dict.fromkeys(point.who for point in points):
        some = sorted((p for p in points if p.who == who), key=lambda p: p.error)
        axes.loglog(
            [p.error for p in some], [p.microseconds[0] for p in some], marker="o", label=who
        )
    axes.set(xlabel="median relative error", ylabel="processor time of a member (us)", title=name)
    axes.legend(fontsize="small")
    canvas.savefig(path, dpi=120)


def measure(names: Sequence[str] = tuple(SYSTEMS)) -> list[Figure]:
    """All figures; files are written."""
    found = []
    if not peers.has_heyoka():
        found.append(Figure("heyoka", "", "not installed: pip install heyoka"))
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            if not (systems_folder() / name / "solver.c").exists():
                found.append(Figure(name, "", "has no stored solver: coadjoint regenerate"))
                continue
            points, note = measure_system(name, Path(folder))
            figures = compare(name, points)
            write(name, points, note, figures)
            found += figures
    return found


if __name__ == "__main__":
    chosen = sys.argv[1:] or tuple(SYSTEMS)
    missed = any(figure.met is False for figure in measure(chosen))
    for name in chosen:
        print((RESULTS / f"ensembles_{name}.md").read_text(encoding="utf-8"))
    sys.exit(missed)
