"""Generated C against C by hand and peers: rates of 1000 members in the cache.

python benchmarks/c_kernels.py [SYSTEM ...]        by default seven systems

Competitors take turns in one run, processor time counts: the median of the rounds, with the spread
from the fastest to the slowest. State and result begin at multiples of 64 bytes. C by hand
(`hand/*.c`) is compiled with each of several sets of options, loops in C, and the fastest counts.
Peers get parameters as numbers in their code, in the equations of `peers.py`. Those of heyoka,
casadi and NumPy are called from Python, and but for NumPy the time of one member is taken off; jax
has a loop of calls in what it compiles. casadi runs in its own machine, and as the C that it
writes, compiled with the options of C by hand; it has the components of a member together.
Writes JSON and Markdown to `results/`.
"""

from __future__ import annotations

import ctypes
import os
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
from figures import Figure, Spread
from results import Table, write

from coadjoint.build.compiler import MACHINES, compile_kernel, find_compiler
from coadjoint.build.library import load_library
from coadjoint.build.source import one_function
from coadjoint.resources import systems_folder
from coadjoint.solve.folders import load_folder

MEMBERS, ROUNDS, SECONDS = 1000, 21, 0.01
HAND = Path(__file__).parent / "hand"
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
        if find_spec("jax") is not None:
            found["jax"] = self.by_jax()
        if find_spec("heyoka") is not None:
            found |= {"heyoka": self.by_heyoka(MEMBERS), "heyoka alone": self.by_heyoka(1)}
        for who, in_c in (("casadi", False), ("casadi's C", True)):
            if find_spec("casadi") is not None:
                given = {who: MEMBERS, f"{who} alone": 1}
                found |= {each: self.by_casadi(n, in_c) for each, n in given.items()}
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

    def _each(self, function: Callable[[], Any]) -> Repeat:
        """Calls from Python; the result of the last is kept."""

        def call(times: int) -> None:
            for _ in range(times):
                rows = function()
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

    def by_jax(self) -> Repeat:
        """A loop of calls, compiled by XLA for doubles and one core."""
        os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false"
        import jax

        jax.config.update("jax_enable_x64", True)
        equations = peers.EQUATIONS[self.name]

        @jax.jit
        def repeat(times: Any, state: Any) -> Any:
            def again(_: Any, carried: Any) -> Any:
                rates = jax.numpy.stack(equations(carried[0], self.values))
                return jax.lax.optimization_barrier((carried[0], rates))  # or it runs once

            return jax.lax.fori_loop(0, times, again, (state, state))[1]

        state = jax.numpy.asarray(self.state)

        def call(times: int) -> None:
            self.out[...] = repeat(times, state)

        return call

    def by_casadi(self, members: int, in_c: bool) -> Repeat:
        """A function of casadi for all members, called with memory of ours."""
        import casadi

        state = casadi.SX.sym("x", self.system.STATE.size)
        names = casadi.vertsplit(state)
        rates = casadi.vertcat(*peers.EQUATIONS[self.name](names, self.values))
        function = casadi.Function("rates", [state], [rates]).map(members)
        if in_c:
            function = self._compile_casadi(function, f"casadi{members}")
        buffer, call = function.buffer()
        given, found = self.state[:, :members].T.copy(), np.empty((members, len(names)))
        buffer.set_arg(0, memoryview(given))
        buffer.set_res(0, memoryview(found))

        def run(times: int) -> None:
            for _ in range(times):
                call()
            if members == MEMBERS:
                self.out[...] = found.T

        run.buffers = buffer, given, found, function  # type: ignore[attr-defined]  # kept
        return run

    def _compile_casadi(self, function: Any, stem: str) -> Any:
        """The same function in C."""
        import casadi

        source = self.folder / f"{self.name}_{stem}.c"
        code = casadi.CodeGenerator(source.name)
        code.add(function)
        code.generate(f"{source.parent}/")
        target = source.with_suffix(".so")
        command = [*find_compiler().command, *FUSED[0], str(source), "-o", str(target)]
        subprocess.run(command, check=True)
        return casadi.external(function.name(), str(target))

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
        if not who.endswith(" alone"):
            contest.out[...] = np.nan
            call(1)
            error = np.abs(contest.out - expected).max()
            assert error <= 1e-12 * size, (contest.name, who, error)


def measure_system(name: str, folder: Path, repeat: Any) -> dict[str, Spread]:
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
    return {who: Spread(median(each), min(each), max(each)) for who, each in rounds.items()}


def compare(name: str, taken: Mapping[str, Spread]) -> list[Figure]:
    """Our speed in units of the others."""
    medians = {who: each[0] for who, each in taken.items()}
    best = {
        kind: min(value for who, value in medians.items() if who.startswith(kind))
        for kind in ("hand", "unfused")
    }
    rows: list[tuple[str, str, float | None, float | None]] = [
        ("fast", "best C by hand", best["hand"], 0.9),
        ("exact", "C by hand without contraction", best["unfused"], 0.9),
        ("fast", "lambdify(cse) with numbers", medians["lambdify"], SYSTEMS[name][1]),
        ("fast", "numba with numbers", medians.get("numba"), 1.2),
    ]
    targets = {"heyoka": ("heyoka cfunc", 2.5), "jax": ("jax", None)}
    targets |= {"casadi": ("casadi", None), "casadi's C": ("casadi's C", None)}
    for who, (what, wanted) in targets.items():
        other = medians[who] - medians.get(f"{who} alone", 0.0) if who in medians else None
        rows.append(("fast", f"{what} with numbers", other, wanted))
    figures = []
    for build, peer, other, target in rows:
        what = f"{name}: {build} C rhs, N = {MEMBERS}, speed against {peer}"
        goal = "none" if target is None else f">= {target:g}"
        if other is None:
            figures.append(Figure(what, goal, "not installed"))
            continue
        ratio, own = other / medians[build], medians[build]
        measured = f"{ratio:.2f} ({own:.0f} ns, peer {other:.0f} ns)"
        figures.append(Figure(what, goal, measured, None if target is None else ratio >= target))
    return figures


def spread_table(taken: Mapping[str, Mapping[str, Spread]]) -> Table:
    """Nanoseconds of all competitors."""
    competitors = list(dict.fromkeys(who for of in taken.values() for who in of))
    rows = [
        [who, *("{:.0f} ({:.0f} to {:.0f})".format(*of[who]) for of in taken.values())]
        for who in competitors
    ]
    return Table("Nanoseconds of a call: median, fastest and slowest round", ["", *taken], rows)


def measure(names: Sequence[str] = tuple(SYSTEMS)) -> list[Figure]:
    """Speed of generated C in units of the others, for each system."""
    taken, figures = {}, []
    with tempfile.TemporaryDirectory() as folder:
        repeat = compiled("repeat", Path(folder)).repeat
        repeat.restype = None
        for name in names:
            taken[name] = measure_system(name, Path(folder), repeat)
            figures += compare(name, taken[name])
            for each in figures[-8:]:
                print(f"{each.what}: {each.measured} (target {each.target})", file=sys.stderr)
    options = {f"hand {n}": " ".join(flags) for n, flags in enumerate(FUSED)}
    options |= {f"unfused {n}": " ".join(flags) for n, flags in enumerate(UNFUSED)}
    setting = {"what": f"rates of {MEMBERS} members", "rounds": ROUNDS, **options}
    write("c_kernels", setting, (), figures, [spread_table(taken)])
    return figures


if __name__ == "__main__":
    measure(tuple(sys.argv[1:]) or tuple(SYSTEMS))
