"""Ensembles: generated solvers against heyoka and SciPy, at equal error, on one core.

python benchmarks/ensembles.py [SYSTEM ...]        by default all seven; some minutes

Ours are of the build `c-fast`, as a person gets it. Competitors take turns in one run and processor
time counts: the median of the rounds, with the spread from the fastest to the slowest. Compilation
counts nowhere. The error of a member is that of its final state, relative to the size of the state;
the reference is heyoka's in extended precision at 1e-18 where its code is made in less than a
minute, and else our own Taylor method of order 30 at 1e-18. Both stand beside heyoka in doubles at
1e-18, and their distance is printed. How much faster at equal median error: the curve of time over
error, straight between its points in logarithms, read at the error of the peer. Writes JSON,
Markdown and a plot to `results/`.
Read next: `results.py`, which writes, `peers.py` and `trajectories.py`.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from statistics import median
from typing import Any

import numpy as np
import peers
from figures import Figure
from results import Point, write

from coadjoint.cli.arguments import load_system
from coadjoint.errors import CoadjointError
from coadjoint.solve.choices import Choice
from coadjoint.solve.costs import choose_order
from coadjoint.solve.ensemble import Ensemble, Inputs, Status
from coadjoint.solve.solvers import Stepper, load

#: Final times, and parameters.
SYSTEMS: Mapping[str, tuple[float, Sequence[float]]] = {
    "rigid_body": (100.0, (1, 2, 3)),
    "heavy_top": (100.0, (1, 1.5, 2, 1, 1, 0.1, 0.2, 1)),
    "kirchhoff": (100.0, (1, 2, 3, 2, 3, 4, 0, 0, 0)),
    "chaplygin_ball": (100.0, (1, 1.5, 2, 1, 1, 1, 0.05, 0.1, 0.2)),
    "so4_body": (100.0, (1, 2, 3, 4, 5, 6)),
    "so6_body": (40.0, (1, 2, 3, 4, 5, 6)),
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
#: The same against other peers, by the beginning of their names.
OTHERS = {"heyoka's ensemble": 10, "SciPy, stacked": 65, "SciPy, a loop": 3000}
TOLERANCES = {
    "taylor": (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16),
    "dop853": (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15),
}
MEMBERS, SLOW_MEMBERS, ROUNDS = 512, 32, 5


def propagate(stepper: Stepper, name: str, states: Any, tolerance: float) -> Any:
    """Final states of all members."""
    end, parameters = SYSTEMS[name]
    nothing = np.zeros((0, 1))
    ensemble = Ensemble(
        state=states.copy(),
        parameters=np.array(parameters, float),
        inputs=Inputs(np.zeros(1), nothing, nothing),
        has_time=False,
        samples=np.array([0.0, end]),
        out=None,
        rtol=tolerance,
        atol=tolerance,
        size=0.0,
        max_steps=10**7,
    )
    ensemble.begin(0.0)
    stepper.advance(ensemble, 0, states.shape[1], 2**62)
    assert (ensemble.status == Status.OK).all()
    return ensemble.state


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


def our_competitors(name: str, states: Any) -> list[Competitor]:
    """Generated methods at their tolerances."""
    system, found = load_system(name), list[Competitor]()
    for method, tolerances in TOLERANCES.items():
        for tolerance in tolerances:
            order = choose_order(tolerance) if method == "taylor" else 8
            stepper = load(system, Choice(name=method, order=order), "c-fast")

            def call(stepper: Stepper = stepper, tolerance: float = tolerance) -> Any:
                return propagate(stepper, name, states, tolerance)

            found.append((method, tolerance, order, states.shape[1], call))
    return found


def peer_competitors(name: str, states: Any) -> list[Competitor]:
    """Peers, where they are installed."""
    end, parameters = SYSTEMS[name]
    found: list[Competitor] = []
    for tolerance in PEER_TOLERANCES if peers.has("heyoka") else ():
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
    few = {"SciPy, stacked": states[:, :SLOW_MEMBERS], "SciPy, a loop": states[:, :2]}
    drivers = {"SciPy, stacked": peers.propagate_stacked, "SciPy, a loop": peers.propagate_each}
    for who, drive_all in drivers.items() if peers.has("scipy") else ():

        def solve(drive_all: Any = drive_all, some: Any = few[who]) -> Any:
            return drive_all(name, parameters, some, end, 1e-9)

        found.append((who, 1e-9, 8, few[who].shape[1], solve))
    return found


def reference_of(name: str, states: Any) -> tuple[Any, str]:
    """Exact final states, as far as we know them, and what a second integrator says of them."""
    end, parameters = SYSTEMS[name]
    ours = propagate(
        load(load_system(name), Choice(name="taylor", order=30), "c-fast"), name, states, 1e-18
    )
    if not peers.has("heyoka"):
        return ours, "our own at 1e-18; heyoka is not installed and does not check it"
    peer = peers.Heyoka(name, parameters, 1e-18).propagate(states, end)
    if len(states) > 6:
        apart = errors_of(ours, peer)
        text = f"our own at 1e-18; heyoka in doubles is {median(apart):.1e} away"
        return ours, f"{text} in the median, {max(apart):.1e} at most"
    exact = peers.propagate_exactly(name, parameters, states, end)
    away = [median(errors_of(each, exact)) for each in (ours, peer)]
    text = "heyoka in extended precision at 1e-18; in doubles at 1e-18 "
    return exact, f"{text}ours is {away[0]:.1e} away and heyoka's {away[1]:.1e} in the median"


def check_equations(name: str, states: Any) -> None:
    """The equations by hand are those of the system."""
    parameters = SYSTEMS[name][1]
    expected = load_system(name).rhs(states, np.array(parameters, float), target="numpy")
    found = np.array(peers.EQUATIONS[name](states, parameters))
    assert np.allclose(found, expected, rtol=1e-12, atol=1e-12), name


def measure_system(name: str) -> tuple[list[Point], str]:
    """All competitors on one system."""
    states = peers.initial_states(name, MEMBERS)
    check_equations(name, states)
    reference, note = reference_of(name, states[:, :128])
    competitors = our_competitors(name, states) + peer_competitors(name, states)
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
        points.append(
            Point(
                who=who,
                tolerance=tolerance,
                order=order,
                microseconds=spread,
                error=float(median(away)),
                worst=float(max(away)),
            )
        )
    return points, note


def compare(name: str, points: Sequence[Point]) -> list[Figure]:
    """How many times faster than the peers, at their median errors, and whose worst is worse."""
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
        sharpest = min(mine, key=lambda point: point.error)
        text = ", ".join(f"{method} {ratio:.2f}" for method, ratio in ratios.items())
        if not ratios:
            ratio = peer.microseconds[0] / sharpest.microseconds[0]
            text = f"taylor {ratio:.2f} at {sharpest.error:.1e}, not at {peer.error:.1e}"
        own = "its own" if peer.tolerance is None else f"{peer.tolerance:g}"
        target: float | None = OTHERS.get(peer.who)
        if target is None and name in TARGETS:
            target = TARGETS[name][PEER_TOLERANCES.index(peer.tolerance)]
        best = max(ratios.values(), default=0.0)
        found.append(
            Figure(
                f"{name}: times faster than {peer.who} at {own}",
                f">= {target:g}" if target else "",
                text,
                best >= target if target else None,
            )
        )
    return found + compare_worst(name, mine, points)


def compare_worst(name: str, mine: Sequence[Point], points: Sequence[Point]) -> list[Figure]:
    """The worst trajectories of Taylor's method and of heyoka at the same tolerance."""
    own = {point.tolerance: point for point in mine if point.who == "taylor"}
    return [
        Figure(
            f"{name}: worst error at {peer.tolerance:g}",
            f"<= {peer.worst:.1e}, heyoka's",
            f"{own[peer.tolerance].worst:.1e}",
            own[peer.tolerance].worst <= peer.worst,
        )
        for peer in points
        if peer.who == "heyoka" and peer.tolerance in own and peer.tolerance is not None
    ]


def measure(names: Sequence[str] = tuple(SYSTEMS)) -> list[Figure]:
    """All figures; files are written."""
    absent = [peer for peer in ("heyoka", "scipy") if not peers.has(peer)]
    found = [Figure(peer, "", f"not installed: pip install {peer}") for peer in absent]
    for name in names:
        try:
            points, note = measure_system(name)
        except CoadjointError as error:
            found.append(Figure(name, "", f"has no solver: {error}"))
            continue
        figures = compare(name, points)
        end, parameters = SYSTEMS[name]
        setting = {"members": MEMBERS, "rounds": ROUNDS, "end": end, "parameters": parameters}
        setting |= {"build": "c-fast"}
        write(f"ensembles_{name}", {**setting, "reference": note}, points, figures)
        found += figures
    return found


if __name__ == "__main__":
    chosen = sys.argv[1:] or tuple(SYSTEMS)
    measured = measure(chosen)
    for figure in measured:
        print(figure.what, figure.target, figure.measured, sep=" | ")
    sys.exit(any(figure.met is False for figure in measured))
