"""Rates of many equal members: generated C against C by hand, for one trajectory.

python benchmarks/families.py

Ten thousand spins on a ring, and ten thousand vortices of which every two act on each other. C by
hand (`hand/heisenberg_lattice.c`, `hand/point_vortices.c`) is compiled with each of several sets of
options, and the fastest counts; for vortices in two ways, each vortex through all others, and each
pair once. Competitors take turns in one run; processor time counts, the median of the rounds.
State and result begin at multiples of 64 bytes. Writes JSON and Markdown to `results/`.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
from c_kernels import FUSED, HAND, UNFUSED, aligned
from figures import Figure, script
from results import Table, write

from coadjoint.build.compiler import find_compiler
from coadjoint.resources import systems_folder
from coadjoint.solve.folders import load_folder

ROUNDS = 7
#: The least speed, in units of the best C by hand of any form and options.
LEAST = 0.8
#: Members, and calls in a round.
SYSTEMS: Mapping[str, tuple[int, int]] = {
    "heisenberg_lattice": (10_000, 1000),
    "point_vortices": (10_000, 1),
}
#: What C by hand is compiled with beyond its options, by its name.
WAYS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "heisenberg_lattice": {"hand": ()},
    "point_vortices": {"hand": (), "each pair once": ("-DONCE",)},
    "spin_chain": {"hand": (), "hand, two loops": ("-DAPART",)},
}
HEADS = ("system", "members", "us a call", "best C by hand", "exact build", "each pair once")


class Contest:
    """The competitors of one system; all write into the same result."""

    def __init__(self, name: str, size: int, folder: Path, index: str = "i") -> None:
        self.name, self.size, self.folder = name, size, folder
        self.system = load_folder(systems_folder() / name).resize({index: size})  # type: ignore[attr-defined]
        source = np.random.default_rng(0)
        self.state = aligned(source.normal(size=self.system.STATE.size))
        self.parameters = aligned(source.uniform(0.5, 2.0, self.system.PARAMETERS.size))
        self.out = aligned(np.zeros_like(self.state))

    def competitors(
        self, options: Sequence[tuple[str, ...]] = (*FUSED, *UNFUSED)
    ) -> dict[str, Callable[[], object]]:
        """All of them by name, C by hand with each of some sets of options."""
        found: dict[str, Callable[[], object]] = {
            build: self.system.bind("rhs", self.state, self.parameters, out=self.out, target=target)
            for build, target in (("fast", "c-fast"), ("exact", "c"))
        }
        for way, defines in WAYS[self.name].items():
            for n, flags in enumerate(options):
                found[f"{way} {n}"] = self.by_hand((*flags, *defines), f"{len(found)}")
        return found

    def by_hand(self, flags: tuple[str, ...], stem: str) -> Callable[[], object]:
        """The kernel by hand, with some options."""
        target = self.folder / f"{self.name}-{stem}.so"
        source = HAND / f"{self.name}.c"
        command = [*find_compiler().command, *flags, str(source), "-o", str(target)]
        subprocess.run(command, check=True)
        function = ctypes.CDLL(str(target)).hand_rhs
        places = (self.state, self.parameters, self.out)
        given = [ctypes.c_void_p(array.ctypes.data) for array in places]
        return lambda: function(ctypes.c_size_t(self.size), *given)


def check_equal(contest: Contest, competitors: Mapping[str, Callable[[], object]]) -> None:
    """All compute what the exact kernel does, to rounding.

    Raises:
        AssertionError: One does not.
    """
    competitors["exact"]()
    expected = contest.out.copy()
    most = np.abs(expected).max()
    for name, call in competitors.items():
        contest.out[...] = np.nan
        call()
        np.testing.assert_allclose(contest.out, expected, rtol=0, atol=1e-9 * most, err_msg=name)


def take_times(
    competitors: Mapping[str, Callable[[], object]], calls: int
) -> dict[str, list[float]]:
    """Seconds of processor time of a call, in each round."""
    seconds: dict[str, list[float]] = {name: [] for name in competitors}
    for _ in range(ROUNDS):
        for name, call in competitors.items():
            begun = process_time()
            for _ in range(calls):
                call()
            seconds[name].append((process_time() - begun) / calls)
    return seconds


def measure() -> list[Figure]:
    """Speed in units of the best C by hand of any form; tables are written."""
    rows, medians, figures = [], list[tuple[str, ...]](), list[Figure]()
    with tempfile.TemporaryDirectory() as folder:
        for name, (size, calls) in SYSTEMS.items():
            contest = Contest(name, size, Path(folder))
            competitors = contest.competitors()
            check_equal(contest, competitors)
            seconds = take_times(competitors, calls)
            times = {each: median(values) for each, values in seconds.items()}
            medians += [
                (name, who, f"{time * 1e6:.4g}", f"{min(seconds[who]) * 1e6:.4g}")
                for who, time in times.items()
            ]
            ours, hand = times["fast"], min(t for n, t in times.items() if n.startswith("hand"))
            once = [t for n, t in times.items() if n.startswith("each")]
            speed = min((hand, *once)) / ours
            what = f"{name}, {size} members: speed in units of the best C by hand"
            figures.append(Figure(what, f">= {LEAST}", f"{speed:.2f}", speed >= LEAST))
            rows.append(
                (
                    name,
                    str(size),
                    f"{ours * 1e6:.4g}",
                    f"{hand / ours:.2f}",
                    f"{hand / times['exact']:.2f}",
                    f"{min(once) / ours:.2f}" if once else "",
                )
            )
    options = {f"options {n}": " ".join(flags) for n, flags in enumerate((*FUSED, *UNFUSED))}
    setting = {"what": "rates of many equal members", "rounds": ROUNDS, **options}
    tables = [
        Table("speed in units of C by hand", HEADS, rows),
        Table("microseconds", ("system", "who", "median", "fastest"), medians),
    ]
    write("families", setting, (), figures, tables)
    return figures


if __name__ == "__main__":
    script(measure)
