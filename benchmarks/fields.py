"""Fields along a circle: rates against C by hand, orders of differences, and what motions keep.

python benchmarks/fields.py

Rates of `spin_chain` at 4096 points compete with C by hand (`hand/spin_chain.c`, differences of the
same order, in one loop and in two, compiled with each of several sets of options; the fastest
counts) in one run, as those of `families.py` do. Orders are those of the error of the rates of
fields whose rates have a closed form, from 64 points to 128: first derivatives of the precessing
wave of the chiral model, second ones of a helix of `landau_lifshitz`, and third ones of a wave of
`kdv`. What is kept is seen over a time of 10 of `spin_chain` with 128 points: its energy, and the
trace of the holonomy. Writes JSON and Markdown to `results/`.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from c_kernels import FUSED, UNFUSED
from families import LEAST, Contest, check_equal, take_times
from figures import Figure, script
from results import Table, write

from coadjoint.resources import systems_folder
from coadjoint.solve.folders import load_folder

POINTS, CALLS = 4096, 2000
#: By how much an order may miss that of the spec, and the most that holonomies and energies change.
NEAR, HOLONOMY, ROUNDING = 0.1, 1e-9, 1e-12


def load(name: str, size: int) -> Any:
    """A shipped system at so many points."""
    return load_folder(systems_folder() / name).resize({"s": size})


def compete() -> tuple[Figure, Table]:
    """Rates against C by hand."""
    with tempfile.TemporaryDirectory() as folder:
        contest = Contest("spin_chain", POINTS, Path(folder), index="s")
        competitors = contest.competitors()
        check_equal(contest, competitors)
        seconds = take_times(competitors, CALLS)
    times = {name: median(values) for name, values in seconds.items()}
    speed = min(time for name, time in times.items() if name.startswith("hand")) / times["fast"]
    rows = [
        (who, f"{time * 1e6:.4g}", f"{min(seconds[who]) * 1e6:.4g}") for who, time in times.items()
    ]
    what = f"spin_chain, {POINTS} points: speed in units of the best C by hand"
    figure = Figure(what, f">= {LEAST}", f"{speed:.2f}", speed >= LEAST)
    return figure, Table("microseconds", ("who", "median", "fastest"), rows)


def chiral_error(size: int) -> float:
    """The chiral model at F(s - t/2), C - F/2: dPi/dt = -F'/2 and dXi/dt = F'/4."""
    length = 10.0
    angle = 2 * np.pi * np.arange(size) / size
    F = np.array([np.cos(angle) / 2, -np.sin(angle) / 2, np.full(size, 0.25)])
    slope = np.array([-np.sin(angle), -np.cos(angle), 0 * angle]) * np.pi / length
    C = np.array([[0.0], [0.0], [3 * np.pi / (2 * length)]])
    system = load("spin_chain_chiral", size)
    found = system.rhs(np.concatenate([F, C - F / 2]).ravel(), {"L": length})
    return float(np.abs(found - np.concatenate([-slope / 2, slope / 4]).ravel()).max())


def kdv_error(size: int) -> float:
    """Of kdv the field u = cos(k s): du/dt = -3 u u' - c u'''."""
    system = load("kdv", size)
    parameters = {"c": 100.0, "L": 2.0}  # so large that errors are those of u'''
    k = 2 * np.pi / parameters["L"]
    angle = 2 * np.pi * np.arange(size) / size
    u, slope = np.cos(angle), -k * np.sin(angle)
    rate = -3 * u * slope - parameters["c"] * k**3 * np.sin(angle)
    return float(np.abs(system.rhs(u, parameters) - rate).max())


def magnet_error(size: int) -> float:
    """A helix S of landau_lifshitz turns about its axis at (k^2 + a3) S3 + B3."""
    length, a, B = 20.0, 1.0, 0.5
    k, angle = 4 * np.pi / length, 4 * np.pi * np.arange(size) / size
    S = np.array([0.6 * np.cos(angle), 0.6 * np.sin(angle), np.full(size, 0.8)])
    rate = ((k**2 + a) * 0.8 + B) * np.array([-S[1], S[0], 0 * angle])
    system = load("landau_lifshitz", size)
    found = system.rhs(S.ravel(), {"a": [0, 0, a], "B": [0, 0, B], "L": length})
    return float(np.abs(found - rate.ravel()).max())


def find_orders() -> list[Figure]:
    """Orders of differences, by the errors of rates."""
    figures = []
    cases = {  # with the order in the spec
        "spin_chain_chiral, first": (chiral_error, 4),
        "landau_lifshitz, second": (magnet_error, 4),
        "kdv, first and third": (kdv_error, 6),
    }
    for name, (error, expected) in cases.items():
        order = float(np.log2(error(64) / error(128)))
        what = f"{name} derivatives: order of the error of rates"
        met = abs(order - expected) <= NEAR
        figures.append(Figure(what, f"{expected} +- {NEAR}", f"{order:.3f}", met))
    return figures


def find_casimirs() -> list[Figure]:
    """How far all tr W^k of fluids by matrices change, next to the sum of powers of sizes."""
    figures = []
    for name in ("zeitlin_su_n", "zeitlin_torus"):
        system = load_folder(systems_folder() / name)
        n = system.index.size
        for method, most in (("isospectral_midpoint", ROUNDING), ("midpoint", None)):
            found = system.simulate(None, (0, 10), step=0.02, method=method, samples=2)
            ends = (found.state[:, place].reshape(n, n) for place in (0, -1))
            # i W is Hermitian
            one, other = (np.linalg.eigvalsh(1j * (X - X.T) / 2 - (X + X.T) / 2) for X in ends)
            changes = [
                abs(np.sum(other**k) - np.sum(one**k)) / np.sum(np.abs(one) ** k)
                for k in range(2, n + 1)
            ]
            change = float(max(changes))
            what = f"{name}, {n} rows, {method} of step 0.02: largest change of the {len(changes)} "
            what += "Casimirs over t = 10"
            target = "none" if most is None else f"<= {most:g}"
            met = None if most is None else change <= most
            figures.append(Figure(what, target, f"{change:.1e}", met))
    return figures


def find_kept() -> list[Figure]:
    """How far the energy and the trace of the holonomy of a motion change."""
    system = load("spin_chain", 128)
    w = 2 * np.pi * np.arange(128) / 128
    Pi = [np.cos(w), np.sin(w) / 2, 1 + 0 * w]
    Xi = [0.2 + np.cos(w) / 5, np.sin(w) / 2, 0.1 - np.sin(2 * w) / 5]
    state = np.concatenate([*Pi, *Xi])
    exact = {"method": "scipy:DOP853", "rtol": 1e-11, "atol": 1e-12, "samples": 6}
    figures = []
    for derivatives, most in (("fourier", HOLONOMY), ("differences", None)):
        motion = system.with_derivatives(derivatives).simulate(state, (0, 10), **exact)
        traces = np.trace(motion.frames()[:, :, -1])
        change = float(np.abs(traces - traces[0]).max())
        what = f"spin_chain, {derivatives}: change of the trace of the holonomy over t = 10"
        target = "none" if most is None else f"<= {most:g}"
        figures.append(
            Figure(what, target, f"{change:.1e}", None if most is None else change <= most)
        )
    for method, bound in (("midpoint", ROUNDING), ("rk4", None)):
        steps = system.simulate(state, (0, 10), method=method, step=0.02, samples=11)
        drift = float(np.abs(steps.change("energy")).max() / np.abs(steps["energy"][0]))
        what = f"spin_chain, {method} of step 0.02: largest change of the energy over t = 10"
        target = "none" if bound is None else f"<= {bound:g}"
        figures.append(
            Figure(what, target, f"{drift:.1e}", None if bound is None else drift <= bound)
        )
    return figures


def measure() -> list[Figure]:
    """All figures; the file of results is written."""
    speed, table = compete()
    figures = [speed, *find_orders(), *find_kept(), *find_casimirs()]
    options = {f"options {n}": " ".join(flags) for n, flags in enumerate((*FUSED, *UNFUSED))}
    setting = {"what": "fields along a circle, and fluids by matrices", **options}
    write("fields", setting, (), figures, [table])
    return figures


if __name__ == "__main__":
    script(measure)
