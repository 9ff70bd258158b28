"""Cross-check, objects of solvers: the texts brought to life, in NumPy and compiled.

Comes in: the texts of the solvers of a kind. Goes out: functions that
advance an `Ensemble`. Each is made from the very text that is checked: an object in the cache is
named after the hash of its text.
Read next: `coadjoint.crosscheck.solver_steps`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np

from coadjoint.array_types import Array
from coadjoint.build.cache import fetch, store
from coadjoint.build.compiler import compile_kernel, find_compiler
from coadjoint.build.library import find_key
from coadjoint.build.source import Source
from coadjoint.errors import OutputError
from coadjoint.lower.compositions import list_schedules
from coadjoint.lower.mapped import list_maps
from coadjoint.lower.program import Program
from coadjoint.methods import JACOBIAN, MAPPED, list_structured
from coadjoint.methods import STRUCTURED as KEEPING
from coadjoint.render.solvers import describe_structured
from coadjoint.solve.calls import call
from coadjoint.solve.choices import Choice
from coadjoint.solve.ensemble import Ensemble
from coadjoint.solve.limits import Limits
from coadjoint.solve.methods.sequence import Maps
from coadjoint.solve.methods.structured import Structured
from coadjoint.solve.runge_kutta import DormandPrince8, RungeKutta4
from coadjoint.solve.step_records import Record
from coadjoint.solve.steps import Lanes, Method, Taylor
from coadjoint.solve.stochastic import METHODS, Orbits
from coadjoint.solver_kinds import SOLVER, SolverKind

#: The order of the Taylor method that is compared: odd, and so low that it is quickly computed.
ORDER: Final = 7
#: Each method as it is chosen for users.
CHOICES: Final = {
    "taylor": Choice(name="taylor", order=ORDER),
    "dop853": Choice(name="dop853", order=8),
    "rk4": Choice(name="rk4", order=4),
}
#: Those of systems with noise, in addition.
NOISY: Final = {
    name: Choice(name=name, order=2, is_noisy=True)
    for name in ("heun", "midpoint", "coadjoint_mean")
}
#: Those that keep structure and are compared for every system that has them; compositions of them
#: take the same steps, of other lengths.
STRUCTURED: Final = {"midpoint": Choice(name="midpoint", order=2)}
#: What Newton's method solves, where the text has the Jacobian: a method of each kind, so that both
#: their equations and their slopes are compared.
NEWTON: Final = {
    f"{name}_newton": Choice(name=name, order=order, newton=True)
    for name, order in (
        ("midpoint", 2),
        ("gauss4", 4),
        ("coadjoint_mean", 2),
        ("discrete_gradient", 2),
        ("nambu_gradient", 2),
        ("metriplectic_gradient", 2),
    )
}
#: Facts of a motion that some methods need in addition to functions of its kernel.
_MARKS: Final = ("orbits", "nambu", "metriplectic")
#: Those whose steps are implicit.
IMPLICIT: Final = STRUCTURED | NEWTON
#: Those that are a sequence of maps. Compilers make those that have all the maps.
MAPS: Final = {name: Choice(name=name, order=each.order) for name, each in MAPPED.items()}
COMPILED_MAPS: Final = ("splitting4", "kahan", "exact_body")


def list_choices(functions: Collection[str]) -> dict[str, Choice]:
    """The methods that are compared, as far as the names of the functions of solvers allow them."""
    if "noise" in functions:
        return CHOICES | NOISY
    own = {each.name for each in list_structured([*functions, *_MARKS])}
    own |= list_schedules(list_maps(functions)).keys()
    newton = NEWTON if JACOBIAN in functions else {}
    return CHOICES | {
        n: each for n, each in (STRUCTURED | MAPS | newton).items() if each.name in own
    }


def list_compared(programs: Mapping[str, Program]) -> dict[str, Choice]:
    """The methods of a system that are compared: those that its solvers have.

    Args:
        programs: As `coadjoint.render.solvers.select_programs` has them, with kinks; none for those
            of every system.
    """
    if not programs:
        return dict(CHOICES)
    own = describe_structured(programs)["structured"]
    able = {each.name for each in own["methods"]}
    return {
        name: each
        for name, each in list_choices(programs).items()
        if own["is_noisy"] or each.name in able or not _needs_mark(each.name)
    }


def _needs_mark(method: str) -> bool:
    """Whether functions of the kernel alone do not tell that a motion has a method."""
    return method in KEEPING and not {*_MARKS}.isdisjoint(KEEPING[method].needs)


class Advance(Protocol):
    """Goes on with all members of an ensemble for so many steps at most; how many still go on."""

    def __call__(self, ensemble: Ensemble, work: int, record: Record | None = None) -> int:
        """Accepted steps are added to a record; the call ends when it is full."""
        ...


#: A file of one method in an object of several: its macros, its functions by names of its own.
_PART: Final = """{defines}
#define {advance} {advance}_{method}
#define {label} {label}_{method}
#include "{file}"
"""


def compile_solvers(
    texts: Mapping[str, str],
    folder: Path,
    system: str,
    methods: Sequence[str],
    build: str,
    what: SolverKind = SOLVER,
) -> Path:
    """An object of some methods: the exact build is not optimised, which changes no bit.

    The fast one is optimised less than that of users, which takes longer to compile. Each method is
    compiled alone, as users have it; one run of the compiler for several costs less than many.

    Args:
        texts: The files of the solver in C.
        folder: A private folder, where others may be compiled at the same time.
        system: The name of the system.
        methods: Of those that are compared.
        build: ``exact`` or ``fast``.
        what: What it integrates.

    Raises:
        CompilerError: The compiler failed.
    """
    level = 0 if build == "exact" else 1  # sums and products are fused from there on
    every = CHOICES | NOISY | IMPLICIT | MAPS
    compiler, kind = find_compiler(), Source(what.stem, is_loops=False, level=level)
    work = folder / f"{what.stem}-{methods[0]}-{build}"
    work.mkdir()
    sources = {file: texts[file].encode() for file in kind.files}
    parts = dict[str, bytes]()
    for method in methods:
        defines = replace(every[method], kind=what).source.defines
        marks = (each.removeprefix("-D").replace("=", " ") for each in defines)
        parts[f"{method}.c"] = _PART.format(
            defines="\n".join(f"#define {mark}" for mark in marks),
            advance=f"{system}_{what.advance}",
            label=kind.label(system),
            method=method,
            file=kind.files[0],
        ).encode()
    sources |= parts
    # of its own name: an object that is not verified yet is never one that users load
    key = find_key(compiler, {**sources, "made for": b"the cross-check"}, build, kind)
    cached = fetch(key)
    if cached is not None:
        return cached
    for file, content in sources.items():
        (work / file).write_bytes(content)
    made = compile_kernel(compiler, work, build, kind, tuple(parts))
    with suppress(OSError, OutputError):
        store(key, made.read_bytes())
    return made


def load_solver(path: Path, system: str, method: str, kind: SolverKind = SOLVER) -> Advance:
    """The function of a method in an object."""
    function = ctypes.CDLL(str(path))[f"{system}_{kind.advance}_{method}"]
    function.restype, function.argtypes = ctypes.c_size_t, [ctypes.c_void_p]

    def advance(ensemble: Ensemble, work: int, record: Record | None = None) -> int:
        members = slice(0, ensemble.state.shape[1])
        return int(call(function, ensemble, members, work, record))

    return advance


#: A function of the NumPy kernel: state, parameters, inputs with the time below them.
Function = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True)
class NumpySolver:
    """The methods in NumPy.

    Attributes:
        module: What names of ``solver.py`` stand for.
        functions: Functions of the NumPy kernel, by their names in ``solver.c``.
        strict: Whether each row of the domain may not be zero.
        known: Rows of the state above what is reconstructed; None for all.
    """

    module: Mapping[str, Any]
    functions: Mapping[str, Function]
    strict: tuple[bool, ...] = ()
    known: int | None = None

    @property
    def branches(self) -> bool:
        """Whether the rates have branch points."""
        return bool(self.module["BRANCHES"])

    def method(self, name: str, ensemble: Ensemble) -> Method:
        """A method for the tolerances and the step of an ensemble."""
        rtol, atol, size = ensemble.rtol, ensemble.atol, ensemble.size
        rates = self._hold if "KINKS" in self.module else partial(self._evaluate, "rates")
        if name == "taylor":
            return Taylor(
                expand=self._expand,
                rates=rates,
                order=ORDER,
                rtol=rtol,
                atol=atol,
                size=size,
                branches=self.branches,
            )
        if name == "dop853":
            return DormandPrince8(rates, rtol, atol, size, branches=self.branches)
        if name == "rk4":
            return RungeKutta4(rates, size, branches=self.branches)
        if name in MAPS:
            parts, moved = self.module["SCHEDULES"][name], self.module["MOVED"]
            maps = [(self.module[f"find_{each}"], part, moved[each]) for each, part in parts]
            compensated = MAPPED[name].parts > 0
            return Maps(maps, rates, size, is_compensated=compensated, branches=self.branches)
        if name in IMPLICIT and not self.is_noisy:
            functions: dict[str, Any] = {"rates": rates, JACOBIAN: self._find_slopes}
            functions |= {"gradient": self._find_element, "bracket": self._turn}
            functions |= {"energy": partial(self._evaluate, "energy")}
            functions |= {"evaluate": self._evaluate_all, "metric": self._relax}
            own, functions["known"] = IMPLICIT[name], self.known
            return Structured(own.name, size, functions, branches=self.branches, newton=own.newton)
        return METHODS[name](
            rates=rates,
            fields=self._fields,
            size=size,
            seed=ensemble.seed,
            bound=ensemble.bound,
            branches=self.branches,
            orbits=Orbits(self._find_element, self._find_noise_slopes, self._turn),
        )

    def advance(self, name: str) -> Advance:
        """What goes on by a method."""
        domain, projection = (
            partial(self._evaluate, each) if each in self.functions else None
            for each in ("domain", "projection")
        )
        kinks = self._find_kinks if "KINKS" in self.module else None
        limits = Limits(domain=domain, strict=self.strict, projection=projection, kinks=kinks)

        def go(ensemble: Ensemble, work: int, record: Record | None = None) -> int:
            method = self.method(name, ensemble)
            return ensemble.advance(method, work, limits=limits, record=record)

        return go

    def _expand(self, lanes: Lanes, order: int) -> Array:
        path: Array = self.module["expand"](
            lanes.state, lanes.given, lanes.driving, lanes.slopes, order
        )
        return path

    def _hold(self, lanes: Lanes, after: Array, state: Array) -> Array:
        driving = lanes.driving + after * lanes.slopes
        rates: Array = self.module["find_rates"](state, lanes.given, driving)
        return rates

    def _find_kinks(self, lanes: Lanes, after: Array, state: Array) -> Array:
        driving = lanes.driving + after * lanes.slopes
        rows: Array = self.module["find_kinks"](state, lanes.parameters, driving)
        return rows

    @property
    def is_noisy(self) -> bool:
        """Whether Wiener processes move the state."""
        return "noise" in self.functions

    def _find_slopes(self, lanes: Lanes, after: Array, state: Array) -> Array:
        rows = self._evaluate(JACOBIAN, lanes, after, state)
        size = math.isqrt(len(rows))
        return rows.reshape(size, size, -1)

    def _find_element(self, lanes: Lanes, after: Array, middle: Array) -> Array:
        found = self._evaluate("energy_gradient", lanes, after, middle)
        known = len(found)
        return found if known == len(middle) else np.concatenate([found, middle[:known]])

    def _turn(self, lanes: Lanes, after: Array, state: Array, element: Array) -> Array:
        n = len(element) if len(element) == len(state) else len(element) // 2
        both = np.concatenate([state[:n], element[:n]])
        turned = self._evaluate("bracket_vector", lanes, after, both)
        if n == len(state):
            return turned
        rates = self._evaluate("rates", lanes, after, np.concatenate([element[n:], state[n:]]))
        return np.concatenate([turned, rates[n:]])

    def _relax(self, lanes: Lanes, after: Array, state: Array, vector: Array) -> Array:
        return self._evaluate("metric_vector", lanes, after, np.concatenate([state, vector]))

    def _evaluate_all(
        self, functions: Sequence[str], lanes: Lanes, after: Array, state: Array
    ) -> Array:
        return np.concatenate([self._evaluate(each, lanes, after, state) for each in functions])

    def _find_noise_slopes(self, lanes: Lanes, after: Array, state: Array) -> Array:
        rows = self._evaluate("noise_gradient", lanes, after, state)
        return rows.reshape(len(state), -1, state.shape[1])

    def _fields(self, lanes: Lanes, after: Array, state: Array) -> Array:
        rows = self._evaluate("noise", lanes, after, state)
        return rows.reshape(len(state), -1, state.shape[1])

    def _evaluate(self, function: str, lanes: Lanes, after: Array, state: Array) -> Array:
        driving = lanes.driving + after * lanes.slopes
        return self.functions[function](np.ascontiguousarray(state), lanes.parameters, driving)


def load_numpy(text: str) -> dict[str, Any]:
    """What names of the text of a kernel or solver in NumPy stand for."""
    module: dict[str, Any] = {}
    exec(compile(text, "solver.py", "exec"), module)  # noqa: S102 (it is a module)
    return module
