"""Methods that keep structure: drifts over many steps, and time per step against RK4.

python benchmarks/structure.py

- Drifts are the largest relative change of an integral at ends of steps, from the start.
- Growth is the exponent p of the best line ``log drift = p log n + c`` through decades of steps,
  of the median of members: 1/2 for roundings that are as often up as down, 1 for a bias.
- Time is processor time per step of a member, of 4096 bodies, as a multiple of RK4 in one call of C
  in the same run.

Read next: `methods.py`, for every method of every system against what is claimed of it.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import warnings
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from figures import Figure, take_turns
from results import Table, write

from coadjoint.build.compiler import CompilerWarning
from coadjoint.cli.arguments import load_system
from coadjoint.errors import CoadjointError
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_folder

INERTIA = {"I": (2.0, 1.0, 2.0 / 3.0)}
BODY = np.array([0.6, 0.4, 0.7])
TOP = {"I": (1, 1.3, 0.6), "m": 1, "g": 1, "chi": (0.1, 0.2, 0.6)}
HANGING = np.array([0.4, -0.3, 1.2, 0.6, 0.0, 0.8])
#: Starts, steps and parameters of motions with constraints; None for the defaults.
ROLLING = {
    "chaplygin_sleigh": ((1.0, 1.0), 0.05, None),
    "suslov": (None, 0.05, None),
    "chaplygin_ball": ((0.7, -0.2, 1.1, 0.0, 0.6, 0.8), 0.01, None),
    "euler_disk": (None, 0.001, None),
    "rattleback": (None, 0.005, None),
}
#: Steps that are timed are so many that starting a run is no part of the figure, which flatters.
MEMBERS, ROUNDS, TIMED = 4096, 5, 4000
#: The text of C of the midpoint, and what it is with plain sums.
PLAIN = (
    (
        """    const V added = rise + *low, total = high + added, other = total - high;
    *low = (high - (total - other)) + (added - other);
    return total;
""",
        """    (void)low;
    return high + rise;
""",
    ),
    ("arc->state[i] + (arc->low[i] + half * rates[i])", "arc->state[i] + half * rates[i]"),
)
#: How many times as long a step with compensated sums may take.
COMPENSATED = 1.2
#: Steps per body as multiples of RK4 that are asked for.
MULTIPLES = {"kahan": 1, "splitting": 3, "midpoint": 4, "spherical_midpoint": 6}


def find_default(system: Any) -> Any:
    """The default state, on the constraints; an attitude without one is the identity."""
    parts = []
    for each in system.STATE.values():
        own = np.ones(len(each.components)) if each.default is None else np.ravel(each.default)
        if each.default is None and len(each.shape) == 2 and np.prod(each.shape) == own.size:
            own = np.eye(*each.shape).ravel()
        parts.append(own)
    state = np.concatenate(parts).astype(float)
    return np.asarray(system.projection(state)) if "projection" in system.functions else state


def find_start(name: str, system: Any) -> Any:
    """A state in general position, a tenth of each quantity from the default, on the constraints.

    Motions of complex numbers come to poles, but those of a real body at times off the real ones:
    they are functions of the time with real periods. So are steps, where the real motion turns back
    on itself by the change of a sign: there it begins with a zero.
    """
    state, rng = find_default(system), np.random.default_rng(1)
    size = np.ones(state.shape)
    for label, each in system.STATE.items():
        rows = system.STATE.rows(label)
        if len(each.shape) < 2:  # attitudes have the size 1, whatever places stand beside them
            size[rows] = np.abs(state[rows]).max()
    state = state + 0.1 * size * rng.uniform(-1, 1, state.shape)
    for _ in range(8 if "projection" in system.functions else 0):  # attitudes, by Newton
        state = np.asarray(system.projection(state))
    if name == "complex_rigid_body":
        state[0] = 0.0
        state = follow_imaginary_time(system, state, 0.25)
    return state


def follow_imaginary_time(system: Any, state: Any, time: float) -> Any:
    """Where a real motion, with its real parts above the imaginary ones, is at ``i time``."""

    def find(x: Any) -> Any:
        real, imaginary = np.split(np.asarray(system.rhs(x)), 2)
        return np.concatenate([-imaginary, real])

    half = len(state) // 2
    state, h = np.concatenate([state[:half], np.zeros(half)]), time / 100
    for _ in range(100):
        one = find(state)
        two = find(state + 0.5 * h * one)
        three = find(state + 0.5 * h * two)
        state = state + h / 6 * (one + 2 * two + 2 * three + find(state + h * three))
    return state


def run(name: str, state: Any, parameters: Any, method: str, step: float, times: Any) -> Any:
    """The Solution at times that are ends of steps."""
    found = load_system(name).simulate(
        state,
        np.asarray(times, float) * step,
        parameters,
        method=method,
        step=step,
        max_steps=10**9,
        target="c",
        progress=False,
    )
    assert (np.asarray(found.status) == "OK").all(), (name, method, found.status)
    return found


def drift(name: str, state: Any, parameters: Any, method: str, step: float, count: int) -> Any:
    """The largest drift of each integral over so many steps."""
    times = np.arange(101) * (count // 100)
    return run(name, state, parameters, method, step, times).drift


def find_drifts(found: Any, names: Any) -> dict[str, float]:
    """Drifts of some integrals. Real and imaginary parts of one number have its size."""
    drifts = {name: found.drift[name] for name in names}
    for name in {"ImC", "casimir2"} & {*names} if "ImC" in drifts else ():
        drifts[name] = float(np.abs(found.change(name)).max() / np.abs(found["ReC"]).max())
    return drifts


def measure_body() -> list[Figure]:
    """A free body for long."""
    figures = []
    for title, method, most in (
        ("default, spherical_midpoint", "spherical_midpoint", 1e-12),
        ("accuracy, gauss8", "gauss8", 3e-14),
    ):
        found = drift("rigid_body", BODY, INERTIA, method, 0.1, 10**6)
        worst = max(found.values())
        what = f"rigid body to t = 1e5, {title}: drift of energy and Casimir"
        figures.append(Figure(what, f"<= {most:.0e}", f"{worst:.1e}", worst <= most))
    return figures


def measure_growth() -> tuple[list[Figure], Table]:
    """Drifts of eight bodies over decades of steps, and their growth."""
    rng = np.random.default_rng(4)
    states = BODY[:, np.newaxis] + 0.2 * rng.uniform(-1, 1, (3, 8))
    decades = np.unique(np.round(10.0 ** np.arange(0, 8.01, 0.25))).astype(int)
    rows, figures = [], []
    for method in ("midpoint", "spherical_midpoint"):
        start = process_time()
        found = run("rigid_body", states, INERTIA, method, 0.05, (0, *decades))
        taken = process_time() - start
        for name in ("energy", "casimir1"):
            values = np.asarray(found[name])
            changes = np.abs(values / values[:, :1] - 1)[:, 1:]
            largest = np.maximum.accumulate(changes, axis=1)
            at = {n: float(np.median(largest[:, decades == n])) for n in (10**5, 10**7, 10**8)}
            late = decades >= 10**4
            p = float(
                np.polyfit(np.log(decades[late]), np.log(np.median(largest, axis=0)[late]), 1)[0]
            )
            rows.append([method, name, *(f"{x:.1e}" for x in at.values()), f"{p:.2f}"])
            what = f"rigid body, h = 0.05, {method}: {name}"
            figures += [
                Figure(f"{what}, growth to 1e8 steps", "<= 0.55", f"{p:.2f}", p <= 0.55),
                Figure(f"{what}, 1e7 steps", "<= 2e-14", f"{at[10**7]:.1e}", at[10**7] <= 2e-14),
                Figure(f"{what}, 1e8 steps", "<= 1e-13", f"{at[10**8]:.1e}", at[10**8] <= 1e-13),
            ]
        rows[-1].append(f"{taken / 8e8 * 1e9:.0f} ns")
        rows[-2].append("")
    columns = ("method", "integral", "1e5 steps", "1e7 steps", "1e8 steps", "growth", "a step")
    return figures, Table("Eight bodies, median drift", columns, rows)


def measure_top() -> list[Figure]:
    """A heavy top by explicit steps."""
    step = 0.05
    short = drift("heavy_top", HANGING, TOP, "splitting4", step, 20_000)
    long = drift("heavy_top", HANGING, TOP, "splitting4", step, 10**7)
    casimirs, later = (max(x["casimir1"], x["casimir2"]) for x in (short, long))
    what = "heavy top, h = 0.05, splitting4"
    return [
        Figure(f"{what}, t = 1000: energy", "<= 5e-8", f"{short['energy']:.1e}",
               short["energy"] <= 5e-8),
        Figure(f"{what}, t = 1000: Casimirs", "<= 1e-13", f"{casimirs:.1e}", casimirs <= 1e-13),
        Figure(f"{what}, 1e7 steps: Casimirs", "<= 1e-12", f"{later:.1e}", later <= 1e-12),
    ]  # fmt: skip


def measure_spectrum() -> list[Figure]:
    """The spectrum of a body on so(8), where the implicit midpoint loses it."""
    name, figures = "so8_body", []
    rng, rows = np.random.default_rng(6), np.triu_indices(8, 1)
    state = rng.uniform(-1, 1, len(rows[0]))

    def find(values: Any) -> Any:
        matrix = np.zeros((8, 8))
        matrix[rows] = values
        return np.sort(np.linalg.eigvalsh(1j * (matrix - matrix.T)))

    for method, most in (("isospectral_midpoint4", 1e-13), ("midpoint4", None)):
        found = run(name, state, None, method, 0.1, np.arange(101) * 100)
        first = find(state)
        off = max(float(np.abs(find(each) - first).max()) for each in found.state.T)
        part = off / float(np.abs(first).max())
        what = f"so(8) body, h = 0.1, 1e4 steps, {method}: spectrum"
        target, met = ("none", None) if most is None else (f"<= {most:.0e}", part <= most)
        figures.append(Figure(what, target, f"{part:.1e}", met))
    return figures


def is_eliminated(system: Any, parameters: Any) -> bool:
    """Whether every state obeys the constraints, as where velocities are solved for: any one."""
    anywhere = np.random.default_rng(7).normal(size=system.STATE.size)
    return not np.any(system.constraint_residual(anywhere, parameters))


def measure_rolling() -> tuple[list[Figure], Table]:
    """Motions with constraints by their defaults."""
    rows, figures = [], []
    for name, (state, step, parameters) in ROLLING.items():
        system = load_system(name)
        start = find_default(system) if state is None else np.array(state)
        (method, *_) = sorted((x for x in system.METHODS if x.rank), key=lambda x: x.rank)
        found = run(name, start, parameters, method.name, step, np.arange(101) * 1000)
        energy, held = found.drift["energy"], "eliminated"
        if not is_eliminated(system, found.parameters):
            residual = system.constraint_residual(found.state, found.parameters)
            off = float(np.abs(residual).max() / np.abs(found.state).max())
            held = f"{off:.1e}"
            what = f"{name}, {method.name}, h = {step:g}, 1e5 steps: constraints"
            figures.append(Figure(what, "<= 1e-13", held, off <= 1e-13))
        rows.append([name, method.name, f"{step:g}", f"{energy:.1e}", held])
        what = f"{name}, {method.name}, h = {step:g}, 1e5 steps: energy"
        figures.append(Figure(what, "<= 1e-13", f"{energy:.1e}", energy <= 1e-13))
    cvt = load_system("knife_edge_cvt")
    found = run("knife_edge_cvt", find_default(cvt), None, "gauss4", 0.05, np.arange(101) * 1000)
    rows.append(["knife_edge_cvt", "gauss4", "0.05", f"{found.drift['energy']:.1e}", "projected"])
    columns = ("system", "method", "step", "energy", "constraints")
    return figures, Table("Motions with constraints, 1e5 steps", columns, rows)


def measure_algebras() -> tuple[list[Figure], Table]:
    """Casimirs by the coadjoint mean, on every system that has it and Casimirs."""
    rows, worst = [], 0.0
    for path in sorted(derivations_folder().glob("*.toml")):
        system = import_module(f"coadjoint.systems.{path.stem}").system
        judged = next((x for x in system.METHODS if x.name == "coadjoint_mean"), None)
        if judged is None or not judged.applies or not judged.exactly or system.INPUTS:
            continue
        state = find_start(path.stem, system)
        at = {"time": 0.0} if system.TIME else {}
        speed = np.abs(system.rhs(state, **at)).max() / np.abs(state).max()
        step = float(2.0 ** np.floor(np.log2(0.1 / speed)))
        try:
            found = run(path.stem, state, None, "coadjoint_mean", step, np.arange(101) * 10**4)
        except (AssertionError, CoadjointError) as error:
            rows.append([path.stem, f"{step:g}", "", f"ended: {error}"[:60]])
            continue
        kept = find_drifts(found, judged.exactly)
        largest = max(kept.values())
        worst = max(worst, largest)
        rows.append([path.stem, f"{step:g}", ", ".join(kept), f"{largest:.1e}"])
    what = f"coadjoint_mean, 1e6 steps, {len(rows)} systems: Casimirs"
    columns = ("system", "step", "Casimirs", "drift")
    figure = Figure(what, "<= 1e-12", f"{worst:.1e}", worst <= 1e-12)
    return [figure], Table("Coadjoint mean, 1e6 steps", columns, rows)


def measure_speed() -> list[Figure]:
    """Steps of 4096 bodies as multiples of those of RK4."""
    system, rng = load_system("rigid_body"), np.random.default_rng(2)
    states = BODY[:, np.newaxis] + 0.2 * rng.uniform(-1, 1, (3, MEMBERS))

    def make(method: str) -> Any:
        def go() -> Any:
            return system.simulate(
                states, (0.0, 0.1 * TIMED), INERTIA, method=method, step=0.1, samples=1,
                target="c-fast", threads=1, progress=False,
            )  # fmt: skip

        go()
        return go

    methods = ("rk4", *MULTIPLES, "spherical_midpoint4", "gauss4", "coadjoint_mean",
               "discrete_gradient", "exact_body")  # fmt: skip
    taken = take_turns({name: make(name) for name in methods}, ROUNDS)
    unit, figures = taken["rk4"].median, []
    for name in methods[1:]:
        times, most = taken[name].median / unit, MULTIPLES.get(name)
        nanoseconds = taken[name].median / MEMBERS / TIMED * 1e9
        figures.append(
            Figure(
                f"4096 bodies, h = 0.1: a step of {name}, in steps of RK4",
                "none" if most is None else f"<= {most}",
                f"{times:.1f} ({nanoseconds:.1f} ns)",
                None if most is None else times <= most,
            )
        )
    return figures


def write_plain(folder: Path) -> Any:
    """The rigid body in a folder, its sums in C without what rounding took of them."""
    shutil.copytree(load_system("rigid_body").folder, folder)
    solver = folder / "solver.c"
    text = solver.read_text(encoding="utf-8")
    for found, put in PLAIN:
        assert text.count(found) == 1, found
        text = text.replace(found, put)
    solver.write_text(text, encoding="utf-8")
    return load_folder(folder)


def measure_compensation() -> list[Figure]:
    """What compensated sums cost: the midpoint of 4096 bodies, and the same C with plain sums."""
    rng, step, count = np.random.default_rng(2), 0.1, TIMED
    states = BODY[:, np.newaxis] + 0.2 * rng.uniform(-1, 1, (3, MEMBERS))
    with tempfile.TemporaryDirectory() as place, warnings.catch_warnings():
        warnings.simplefilter("error", CompilerWarning)  # NumPy in the place of C is no measure
        systems = {
            "compensated": load_system("rigid_body"),
            "plain": write_plain(Path(place) / "x"),
        }
        drifts = dict[str, float]()

        def make(name: str) -> Any:
            def go() -> Any:
                found = systems[name].simulate(
                    states, (0.0, step * count), INERTIA, method="midpoint", step=step, samples=1,
                    target="c-fast", threads=1, progress=False,
                )  # fmt: skip
                drifts[name] = float(np.median(found.drift["energy"]))
                sweeps[name] = float(np.mean(found.sweeps)) / count

            go()
            return go

        sweeps = dict[str, float]()
        taken = take_turns({name: make(name) for name in systems}, ROUNDS)
    assert drifts["plain"] > drifts["compensated"], "the edit took nothing away"
    times = taken["compensated"].median / taken["plain"].median
    what = "4096 bodies, midpoint, h = 0.1: a step with compensated sums, in steps with plain ones"
    told = ", ".join(f"{n} {drifts[n]:.0e} and {sweeps[n]:.2f} sweeps" for n in systems)
    return [
        Figure(what, f"<= {COMPENSATED}", f"{times:.2f} (energy: {told})", times <= COMPENSATED)
    ]


def measure() -> list[Figure]:
    """All figures; files are written."""
    growth, growing = measure_growth()
    rolling, held = measure_rolling()
    algebras, means = measure_algebras()
    found = [
        *measure_body(),
        *growth,
        *measure_top(),
        *measure_spectrum(),
        *rolling,
        *algebras,
        *measure_speed(),
        *measure_compensation(),
    ]
    write("structure", {"rounds": ROUNDS}, (), found, (growing, held, means))
    return found


if __name__ == "__main__":
    missed = any(figure.met is False for figure in measure())
    sys.exit(missed)
