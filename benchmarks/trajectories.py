"""One long trajectory, fixed steps and two threads: generated solvers of the heavy top.

python benchmarks/trajectories.py

- One trajectory from Python, to t = 1000 on a grid of 1001 times, rtol 1e-9, against heyoka's
  integrator of one. Errors at all times of the grid are against heyoka in extended precision; the
  motion is close to a stable rest, so that they do not grow exponentially.
- RK4 in one call of C against the same steps in vectorised NumPy, with the equations by hand, for
  1000 members.
- An ensemble by one thread and by two. That is wall time, and says nothing on a busy machine.

Read next: `ensembles.py`.
"""

from __future__ import annotations

import sys
from os import getloadavg
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import peers
from ensembles import SYSTEMS, errors_of
from figures import Figure
from results import FOLDER, write

from coadjoint.cli.arguments import load_system

NAME, ROUNDS = "heavy_top", 5
PARAMETERS = {"I": (1, 1.5, 2), "m": 1, "g": 1, "chi": (0.1, 0.2, 1)}
STEP, STEPS, MEMBERS, MANY = 0.002, 2000, 1000, 20000


def measure_long() -> list[Figure]:
    """One trajectory, and its error."""
    system, grid = load_system(NAME), np.linspace(0.0, 1000.0, 1001)
    hanging = -np.array([0.1, 0.2, 1.0]) / np.sqrt(1.05)
    state = np.array([0.1, 0.2, 0.3, *hanging])

    def ours() -> Any:
        run = {"method": "taylor", "rtol": 1e-9, "atol": 1e-9, "target": "c-fast"}
        return system.simulate(state, grid, PARAMETERS, **run).state

    if not peers.has("heyoka"):
        return [Figure("heavy_top, one trajectory", "", "heyoka is not installed")]
    peer = peers.Heyoka(NAME, SYSTEMS[NAME][1], 1e-9)

    def theirs() -> Any:
        return peer.propagate_grid(state, grid)

    exact = peers.propagate_exactly_on(NAME, SYSTEMS[NAME][1], state, grid)
    seconds: dict[Any, list[float]] = {ours: [], theirs: []}
    errors = {each: float(errors_of(each(), exact).max()) for each in seconds}
    for _ in range(ROUNDS):
        for each, taken in seconds.items():
            taken.append(peers.seconds_of(each))
    mine, other = (1e3 * median(taken) for taken in seconds.values())
    what = "heavy_top, one trajectory to t = 1000 on a grid"
    target = f"<= {other:.2f} ms, heyoka's"
    worst = f"<= {errors[theirs]:.1e}, heyoka's"
    return [
        Figure(f"{what}: time", target, f"{mine:.2f} ms", mine <= other),
        Figure(
            f"{what}: largest error", worst, f"{errors[ours]:.1e}", errors[ours] <= errors[theirs]
        ),
    ]


def measure_fixed() -> list[Figure]:
    """RK4 in C and in NumPy."""
    system, states = load_system(NAME), peers.initial_states(NAME, MEMBERS)
    given = SYSTEMS[NAME][1]

    def ours(samples: int = 1) -> Any:
        run = {"method": "rk4", "step": STEP, "samples": samples, "target": "c-fast", "threads": 1}
        return system.simulate(states, (0.0, STEP * STEPS), PARAMETERS, **run).state[..., -1]

    def theirs() -> Any:
        x = states
        for _ in range(STEPS):
            k1 = rates(x)
            k2 = rates(x + STEP / 2 * k1)
            k3 = rates(x + STEP / 2 * k2)
            k4 = rates(x + STEP * k3)
            x = x + STEP / 6 * (k1 + 2 * (k2 + k3) + k4)
        return x

    def rates(x: Any) -> Any:
        return np.array(peers.heavy_top(x, given))

    assert np.allclose(ours(), theirs(), rtol=1e-9, atol=1e-11)
    taken: dict[Any, list[float]] = {ours: [], theirs: []}
    for _ in range(ROUNDS):
        for each, times in taken.items():
            times.append(peers.seconds_of(each))
    mine, other = (median(times) / MEMBERS / STEPS * 1e9 for times in taken.values())
    return [
        Figure(
            "heavy_top: RK4 in C against NumPy, times faster",
            ">= 40",
            f"{other / mine:.0f} ({mine:.1f} and {other:.0f} ns a step of a member)",
            other / mine >= 40,
        )
    ]


def measure_threads() -> list[Figure]:
    """One thread and two."""
    system, states = load_system(NAME), peers.initial_states(NAME, MANY)
    taken: dict[int, list[float]] = {1: [], 2: []}
    busy = getloadavg()[0]
    for _ in range(3):
        for threads, times in taken.items():
            start = perf_counter()
            run = {"rtol": 1e-9, "samples": 1, "target": "c-fast", "threads": threads}
            system.simulate(states, (0.0, 20.0), PARAMETERS, method="taylor", **run)
            times.append(perf_counter() - start)
    gain = min(taken[1]) / min(taken[2])
    quiet = busy < 0.5
    note = "" if quiet else f"; {busy:.1f} other processes wanted a processor"
    what = "heavy_top: two threads against one, times faster"
    return [Figure(what, ">= 1.9", f"{gain:.2f}{note}", gain >= 1.9 if quiet else None)]


def measure() -> list[Figure]:
    """All figures; files are written."""
    found = [*measure_long(), *measure_fixed(), *measure_threads()]
    write("trajectories", {"system": NAME, "rounds": ROUNDS, "build": "c-fast"}, (), found)
    return found


if __name__ == "__main__":
    missed = any(figure.met is False for figure in measure())
    print((FOLDER / "trajectories.md").read_text(encoding="utf-8"))
    sys.exit(missed)
