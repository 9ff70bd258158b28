"""Ensembles: generated solvers against diffrax, at equal error, on one core.

python benchmarks/ensembles_jax.py [SYSTEM ...]    by default the rigid body and the heavy top

diffrax has its method of order 8, Dopri8, with a step of its own for each member, in doubles; the
equations are those of `peers.py`, with numbers for parameters. Compilation counts nowhere. What is
measured, and how curves are compared, is said in `ensembles.py`.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from statistics import median
from typing import Any

import numpy as np
import peers
from ensembles import ROUNDS, SYSTEMS, check_equations, errors_of, reference_of, time_at
from ensembles import our_competitors as generated
from figures import Figure
from results import Point, write

NAMES, MEMBERS = ("rigid_body", "heavy_top"), 512
PEER_TOLERANCES = (1e-6, 1e-9, 1e-12)
Run = tuple[str, float | None, int, int, Callable[[], Any]]


def diffrax_competitors(name: str, states: Any) -> list[Run]:
    """The runs of diffrax at its tolerances; nothing where it is not installed."""
    if not (peers.has("diffrax") and peers.has("jax")):
        return []
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false"
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    end, parameters = SYSTEMS[name]

    def rates(_time: Any, state: Any, _given: Any) -> Any:
        return jax.numpy.stack(peers.EQUATIONS[name](state, parameters))

    def compiled(tolerance: float) -> Callable[[], Any]:
        def advance(state: Any) -> Any:
            return diffrax.diffeqsolve(
                diffrax.ODETerm(rates),
                diffrax.Dopri8(),
                t0=0.0,
                t1=end,
                dt0=None,
                y0=state,
                stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
                saveat=diffrax.SaveAt(t1=True),
                max_steps=None,
            ).ys[0]

        advance_all, given = jax.jit(jax.vmap(advance)), jax.numpy.asarray(states.T)
        return lambda: np.asarray(advance_all(given)).T

    count = states.shape[1]
    return [("diffrax", each, 8, count, compiled(each)) for each in PEER_TOLERANCES]


def measure_system(name: str) -> tuple[list[Point], str]:
    """All competitors on one system."""
    states = peers.initial_states(name, MEMBERS)
    check_equations(name, states)
    reference, note = reference_of(name, states[:, :128])
    competitors = generated(name, states) + diffrax_competitors(name, states)
    found = [call() for *_, call in competitors]
    taken: list[list[float]] = [[] for _ in competitors]
    for _ in range(ROUNDS):
        for times, (*_, call) in zip(taken, competitors, strict=True):
            times.append(peers.seconds_of(call) / MEMBERS * 1e6)
    points = []
    for times, (who, tolerance, order, *_), states_found in zip(
        taken, competitors, found, strict=True
    ):
        away = errors_of(states_found[:, : reference.shape[1]], reference)
        points.append(
            Point(
                who=who,
                tolerance=tolerance,
                order=order,
                microseconds=(median(times), min(times), max(times)),
                error=float(median(away)),
                worst=float(max(away)),
            )
        )
    return points, note


def compare(name: str, points: Sequence[Point]) -> list[Figure]:
    """How many times faster than diffrax, at its median errors."""
    figures = []
    for peer in points:
        if peer.who != "diffrax":
            continue
        ratios = {}
        for method in ("taylor", "dop853"):
            ours = time_at([point for point in points if point.who == method], peer.error)
            if ours is not None:
                ratios[method] = f"{method} {peer.microseconds[0] / ours:.1f}"
        what = f"{name}: times faster than diffrax at {peer.tolerance:g}"
        figures.append(Figure(what, "none", ", ".join(ratios.values())))
    return figures


def measure(names: Sequence[str] = NAMES) -> list[Figure]:
    """All figures; files are written."""
    found = []
    if not (peers.has("diffrax") and peers.has("jax")):
        return [Figure("ensembles against diffrax", "none", "not installed: pip install diffrax")]
    for name in names:
        points, note = measure_system(name)
        figures = compare(name, points)
        end, parameters = SYSTEMS[name]
        setting = {"members": MEMBERS, "rounds": ROUNDS, "end": end, "parameters": parameters}
        setting |= {"build": "c-fast"}
        write(f"ensembles_jax_{name}", {**setting, "reference": note}, points, figures)
        found += figures
    return found


if __name__ == "__main__":
    for figure in measure(tuple(sys.argv[1:]) or NAMES):
        print(figure.what, figure.target, figure.measured, sep=" | ")
