"""Generated C against C by hand, heyoka, numba and SymPy: rates of 1000 members in the cache.

python benchmarks/c_kernels.py [SYSTEM ...]        by default seven systems

Competitors take turns in one run, processor time counts: the median of the rounds, with the spread
from the fastest to the slowest. State and result begin at multiples of 64 bytes. C by hand
(`hand/*.c`) is compiled with each of several sets of options, loops in C, and the fastest counts.
Peers get parameters as numbers in their code, in the equations of `peers.py`; those of heyoka and
NumPy are called from Python, and of heyoka the time of one member is taken off.
Writes JSON and Markdown to `results/`.
"""

from __future__ import annotations

import ctypes
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
import peers
import sympy
from figures import Figure
from run import processor

from coadjoint.build.compiler import MACHINES, compile_kernel, find_compiler, one_function
from coadjoint.build.library import load_library
from coadjoint.resources import systems_folder
from coadjoint.solve.system import load_folder

MEMBERS, ROUNDS, SECONDS = 1000, 21, 0.01
HAND = Path(__file__).parent / "hand"
RESULTS = Path(__file__).parent / "results"
#: Parameters, and how many times SymPy's time we mean to be faster.
SYSTEMS: Mapping[str, tuple[Sequence[float], float]] = {
    "rigid_body": ((1, 2, 3), 8),
    "heavy_top": ((1, 1.5, 2, 1, 1, 0.1, 0.2, 1), 20),
    "kirchhoff": ((1, 2, 3, 2, 3, 4, 0, 0, 0), 20),
    "chaplygin_ball": ((1, 1.5, 2, 1, 1, 1, 0.05, 0.1, 0.2), 20),
    "so4_body": ((1, 2, 3, 4, 5, 6), 20),
    "so6_body": ((1, 2, 3, 4, 5, 6), 20),
    "so8_body": ((1, 2, 3, 4, 5, 6, 7, 8), 20),
}
#: Options that somebody who writes C by hand would try.
_BASE = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fPIC", "-shared")
_WIDE = MACHINES[0][1:]
FUSED = (
    *((*_BASE, *more, "-ffp-contract=fast") for more in (_WIDE, (), (*_WIDE, "-funroll-loops"))),
    (*_BASE, *_WIDE, "-ffast-math"),
)
UNFUSED = tuple((*_BASE, *more, "-ffp-contract=off") for more in (_WIDE, ()))
#: Calls so many times, so that one call from Python is not what is measured.
Repeat = Callable[[int], object]


def compiled(name: str, folder: Path) -> ctypes.CDLL:
    """A file of ``hand/``, compiled as generated kernels are."""
    place = folder / name
    place.mkdir()
    (place / "kernel.c").write_bytes((HAND / f"{name}.c").read_bytes())
    return ctypes.CDLL(str(compile_kernel(find_compiler(), place, "exact")))


def aligned(values: Any) -> Any:
    """A copy that begins at a multiple of 64 bytes."""
    room = np.empty(values.size + 8)
    first = -(room.ctypes.data // 8) % 8
    result = room[first : first + values.size].reshape(values.shape)
    result[...] = values
    return result


class Contest:
    """The competitors of one system; all write into the same result."""

    def __init__(self, name: str, folder: Path, repeat: Any) -> None:
        self.name, self.folder, self.repeat = name, folder, repeat
        self.system = load_folder(systems_folder() / name)
        self.values = [float(each) for each in SYSTEMS[name][0]]
        self.parameters = np.array(self.values)
        source = np.random.default_rng(0)
        self.state = aligned(source.normal(size=(self.system.STATE.size, MEMBERS)))
        self.out = aligned(np.zeros_like(self.state))

    def competitors(self) -> dict[str, Repeat]:
        """All that are there, by name."""
        found = {"fast": self.generated("fast"), "exact": self.generated("exact")}
        for n, flags in enumerate(FUSED):
            found[f"hand {n}"] = self.by_hand(flags, f"hand{n}")
        for n, flags in enumerate(UNFUSED):
            found[f"unfused {n}"] = self.by_hand(flags, f"unfused{n}")
        found["lambdify"] = self.by_sympy()
        if find_spec("numba") is not None:
            found["numba"] = self.by_numba()
        if find_spec("heyoka") is not None:
            found |= {"heyoka": self.by_heyoka(MEMBERS), "heyoka alone": self.by_heyoka(1)}
        return found

    def _call(self, place: int) -> Repeat:
        """Calls of a C function."""
        size, address = ctypes.c_size_t, ctypes.c_void_p
        arguments = (
            *(size(MEMBERS), address(self.state.ctypes.data), size(MEMBERS)),
            *(address(self.parameters.ctypes.data), size(0)),
            *(address(self.out.ctypes.data), size(MEMBERS)),
        )
        return lambda times: self.repeat(size(times), address(place), *arguments)

    def generated(self, build: str) -> Repeat:
        """Our kernel."""
        system, rates = self.system, one_function("rhs")
        given = (system.folder, system.name, system.id, build)
        return self._call(load_library(*given, lambda _: None, rates).find("rhs"))

    def by_hand(self, flags: Sequence[str], stem: str) -> Repeat:
        """The kernel by hand, with some options."""
        target = self.folder / f"{self.name}-{stem}.so"
        source = HAND / f"{self.name}.c"
        command = [*find_compiler().command, *flags, str(source), "-o", str(target)]
        subprocess.run(command, check=True)
        function = ctypes.CDLL(str(target)).hand_rhs
        return self._call(ctypes.cast(function, ctypes.c_void_p).value or 0)

    def _symbols(self) -> tuple[list[Any], list[Any]]:
        """State and rates in SymPy, parameters as numbers."""
        names = sympy.symbols(f"s:{self.system.STATE.size}")  # cse has x0, x1, ...
        return list(names), peers.EQUATIONS[self.name](names, self.values)

    def by_sympy(self) -> Repeat:
        """``lambdify`` with ``cse``, over arrays."""
        names, rates = self._symbols()
        function = sympy.lambdify(names, rates, modules="numpy", cse=True)
        return self._each(lambda: function(*self.state))

    def _each(self, function: Callable[[], Sequence[Any]]) -> Repeat:
        """Calls from Python; the result of the last is kept."""

        def call(times: int) -> None:
            for _ in range(times):
                rows = function()
            if rows is not self.out:
                self.out[...] = rows

        return call

    def by_numba(self) -> Repeat:
        """A loop over members, compiled by numba with all liberties of arithmetic."""
        import numba

        names, rates = self._symbols()
        shared, reduced = sympy.cse(rates)
        code = ["def rates(times, state, out):", " for _ in range(times):"]
        code += ["  for n in range(state.shape[1]):"]
        code += [f"   {name} = state[{row}, n]" for row, name in enumerate(names)]
        code += [f"   {name} = {value}" for name, value in shared]
        code += [f"   out[{row}, n] = {value}" for row, value in enumerate(reduced)]
        scope: dict[str, Any] = {}
        exec("\n".join(code), scope)
        fast = numba.njit(fastmath=True)(scope["rates"])
        return lambda times: fast(times, self.state, self.out)

    def by_heyoka(self, members: int) -> Repeat:
        """A compiled function of heyoka, for vectors of 512 bits."""
        import heyoka

        variables = heyoka.make_vars(*(f"x{i}" for i in range(self.system.STATE.size)))
        rates = peers.EQUATIONS[self.name](variables, self.values)
        function = heyoka.cfunc(rates, vars=variables, force_avx512=True)
        state = np.ascontiguousarray(self.state[:, :members])
        out = self.out if members == MEMBERS else np.empty_like(state)
        return self._each_in_place(lambda: function(state, outputs=out))

    def _each_in_place(self, function: Callable[[], object]) -> Repeat:
        """Calls from Python that write where they should."""

        def call(times: int) -> None:
            for _ in range(times):
                function()

        return call


def check_equal(contest: Contest, competitors: Mapping[str, Repeat]) -> None:
    """All compute what the exact kernel does, to rounding.

    Raises:
        AssertionError: One does not.
    """
    competitors["exact"](1)
    expected = contest.out.copy()
    size = np.abs(expected).max()
    assert size > 0
    for who, call in competitors.items():
        if who != "heyoka alone":
            contest.out[...] = np.nan
            call(1)
            error = np.abs(contest.out - expected).max()
            assert error <= 1e-12 * size, (contest.name, who, error)


def measure_system(name: str, folder: Path, repeat: Any) -> dict[str, tuple[float, float, float]]:
    """Nanoseconds of a call by each competitor: median, fastest and slowest round."""
    contest = Contest(name, folder, repeat)
    competitors, times = contest.competitors(), {}
    check_equal(contest, competitors)
    for who, call in competitors.items():
        start = process_time()
        call(10)
        times[who] = max(1, int(SECONDS * 10 / max(process_time() - start, 1e-6)))
    rounds: dict[str, list[float]] = {who: [] for who in competitors}
    for _ in range(ROUNDS):
        for who, call in competitors.items():
            start = process_time()
            call(times[who])
            rounds[who].append((process_time() - start) / times[who] * 1e9)
    return {who: (median(each), min(each), max(each)) for who, each in rounds.items()}


def compare(name: str, taken: Mapping[str, tuple[float, float, float]]) -> list[Figure]:
    """Our speed in units of the others."""
    medians = {who: each[0] for who, each in taken.items()}
    best = {
        kind: min(value for who, value in medians.items() if who.startswith(kind))
        for kind in ("hand", "unfused")
    }
    rows: list[tuple[str, str, float | None, float]] = [
        ("fast", "best C by hand", best["hand"], 0.9),
        ("exact", "C by hand without contraction", best["unfused"], 0.9),
        ("fast", "lambdify(cse) with numbers", medians["lambdify"], SYSTEMS[name][1]),
        ("fast", "numba with numbers", medians.get("numba"), 1.2),
    ]
    heyoka = medians["heyoka"] - medians["heyoka alone"] if "heyoka" in medians else None
    rows.append(("fast", "heyoka cfunc with numbers", heyoka, 2.5))
    figures = []
    for build, peer, other, target in rows:
        what = f"{name}: {build} C rhs, N = {MEMBERS}, speed against {peer}"
        if other is None:
            figures.append(Figure(what, f">= {target:g}", "not installed"))
            continue
        ratio, own = other / medians[build], medians[build]
        measured = f"{ratio:.2f} ({own:.0f} ns, peer {other:.0f} ns)"
        figures.append(Figure(what, f">= {target:g}", measured, ratio >= target))
    return figures


def write(taken: Mapping[str, Mapping[str, Any]], figures: Sequence[Figure]) -> None:
    """The files of ``results/``."""
    RESULTS.mkdir(exist_ok=True)
    compiler = find_compiler().version
    record = {
        "machine": processor(),
        "compiler": compiler,
        "members": MEMBERS,
        "rounds": ROUNDS,
        "nanoseconds": taken,
        "figures": [vars(each) for each in figures],
    }
    text = json.dumps(record, indent=1) + "\n"
    (RESULTS / "c_kernels.json").write_text(text, encoding="utf-8")
    lines = [
        f"# Rates of {MEMBERS} members in C",
        "",
        f"{processor()}; {compiler}. Processor time of one core, medians of {ROUNDS} interleaved",
        "rounds. `benchmarks/c_kernels.py` says what is measured.",
        "",
        "| figure | target | measured | |",
        "|---|---|---|---|",
    ]
    verdicts = {True: "met", False: "MISSED", None: ""}
    for each in figures:
        lines.append(f"| {each.what} | {each.target} | {each.measured} | {verdicts[each.met]} |")
    lines += ["", "Nanoseconds of a call: median, fastest and slowest round.", ""]
    competitors = list(dict.fromkeys(who for of in taken.values() for who in of))
    lines += [f"| | {' | '.join(competitors)} |", "|---|" + "---|" * len(competitors)]
    for name, of in taken.items():
        cells = ["{:.0f} ({:.0f} to {:.0f})".format(*of[who]) for who in competitors]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    (RESULTS / "c_kernels.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def measure(names: Sequence[str] = tuple(SYSTEMS)) -> list[Figure]:
    """Speed of generated C in units of the others, for each system."""
    taken, figures = {}, []
    with tempfile.TemporaryDirectory() as folder:
        repeat = compiled("repeat", Path(folder)).repeat
        repeat.restype = None
        for name in names:
            taken[name] = measure_system(name, Path(folder), repeat)
            figures += compare(name, taken[name])
            for each in figures[-5:]:
                print(f"{each.what}: {each.measured} (target {each.target})", file=sys.stderr)
    write(taken, figures)
    return figures


if __name__ == "__main__":
    measure(tuple(sys.argv[1:]) or tuple(SYSTEMS))
