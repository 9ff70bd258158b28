"""Self-check: methods that keep structure, measured on runs of a system.

Comes in: a System. Goes out: a `Measured` for each of its methods: the order of its distance from
the motion by steps that are halved, the defect of a step from a Poisson map by differences, the
drift of integrals, and what steps miss of laws of energy and entropy. The motion is that of another
method with far shorter steps: runs of one method alone may come closer to each other, and to the
motion of other equations. What its certificate says of a method by theorems is asked of runs here.
With noise the order is that of paths: runs with longer steps take sums of the increments of shorter
ones, and those of two methods have to meet.
Read next: `coadjoint.cli.self_check`, which shows it.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.build.compiler import BUILDS, CompilerWarning
from coadjoint.build.source import KERNEL
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import FALLING, GROWING, PLAIN, STRUCTURED, JudgedMethod
from coadjoint.solve.arrays import pack_inputs, pack_parameters
from coadjoint.solve.choices import Choice
from coadjoint.solve.ensemble import Ensemble, Inputs, Status
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.family_steps import FamilyTwin
from coadjoint.solve.noisy import has_noise
from coadjoint.solve.spectral import list_mean_zero
from coadjoint.solve.stochastic import find_bound
from coadjoint.solve.twins import NumpyStepper
from coadjoint.solver_kinds import SOLVER

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.system import System

    Array = NDArray[np.float64]

#: Members near the default state, drawn so that none is at rest, and by what part of it, the widest
#: first: those in the domain count. They are more than half a vector of C, as are those that
#: differences take, so that one library has both.
MEMBERS: Final = 5
SPREADS: Final = (0.1, 0.01, 0.001)
DRAWN: Final = 16
#: Steps to the nearest state on constraints, and how far off them it may be.
PROJECTED: Final = 5
HELD: Final = 1e-9
#: Steps that the state would need to change by its own size, about.
STEPS: Final = 20
#: How often the step is halved before no motion is said to be followed: of fields the shortest
#: waves bound it, and not the motion.
SHORTER: Final = 5
#: Steps of the longest of the three runs that tell the order, by what part of these those of
#: further runs are, and steps of the run that tells drifts.
HALVED: Final = 8
LATER: Final = (8, 16)
#: By what powers of 2 steps are longer, where those of the first three runs differ by roundings.
SOONER: Final = 3
DRIFTING: Final = 100
#: Components of a state beyond which a compiled solver takes less time than NumPy, with compiling.
LARGE: Final = 8
#: Bytes of a kernel of equal members beyond which optimising takes longer than it saves:
#: `elastic_chain` has 320,000 of them, compiled in 8.7 s and less optimised in 2.6 s, `n_body`
#: 76,000; `zeitlin_torus` has 45,000, and its runs take three times as long without.
LONG: Final = 60_000
#: Files of methods whose compositions take less time in NumPy, with compiling.
QUICK: Final = ("midpoint", "gauss")
#: The method that the motion is found by, and in what part of the step of the longest run.
#: Where Python leads the steps it is that of SciPy.
FINE: Final = 16
#: Members go one after the other there, so that they are fewer.
LED: Final = "scipy:DOP853"
LED_MEMBERS: Final = 2
#: By how much an order may be measured too low. One that is too high is no fault of a method.
SHY: Final = 0.5
#: The same of means over paths with noise, and how many of these there are of each state.
SHY_OF_PATHS: Final = 0.25
PATHS: Final = 64
#: Gaps of runs, relative to the state, that are roundings: no order is read from them.
ROUNDED: Final = 1e-13
#: How far a map may be from a Poisson map by differences, and how far integrals may go that are
#: kept exactly, times the square of the growth of states: near a pole terms of an integral cancel.
DEFECT: Final = 1e-11
DRIFT: Final = 1e-12
#: The same of a law in one step: roundings alone.
LAW: Final = 1e-14
#: Directions that the tensor has, by the size that it has along them.
LEAST: Final = 1e-9
#: Of the noise of runs.
SEED: Final = 1
#: The parts of a state by which differences move it, at most, and their weights: those of order 8
#: (B. Fornberg, Mathematics of Computation 51 (1988) 699) mostly leave roundings alone at the first
#: distance; of stiff motions at the second one.
_DIFFERENCES: Final = (2.0**-7, 2.0**-10)
_WEIGHTS: Final = (4 / 5, -1 / 5, 4 / 105, -1 / 280)


@dataclass(frozen=True)
class Measured:
    """What runs say of a method.

    Attributes:
        method: As it was judged.
        order: The measured order; None where runs differ by roundings alone.
        defect: How far a step is from a Poisson map, relative to the tensor; None without one.
        drifts: The largest drift of each integral.
        exponents: With what power of the number of steps it grows.
        grown: By what factor states grew.
        laws: What steps miss of each law, relative to the size of what it is about.
        compared: How many numbers were compared with what is claimed.
        failures: What contradicts the claims, as clauses.
    """

    method: JudgedMethod
    order: float | None
    defect: float | None
    drifts: dict[str, float]
    exponents: dict[str, float]
    grown: float
    laws: dict[str, float]
    compared: int
    failures: tuple[str, ...]


def check_methods(system: System, names: list[str] | None = None) -> Iterator[Measured]:
    """Methods measured on runs: those that ``"auto"`` takes, in its order, or those that are named.

    Args:
        system: The System.
        names: Methods; ``["all"]`` for all that apply.

    Raises:
        KernelArgumentError: The system has no such method, or no run can be followed.
    """
    known = {each.name: each for each in system.METHODS if each.applies}
    names = [*known] if names == ["all"] else names
    unknown = [name for name in names or () if name not in known]
    if unknown:
        raise KernelArgumentError(
            f"method {unknown[0]!r} does not apply to {system.name}; expected some of "
            f"{', '.join(known) or 'none: no method that keeps structure applies'}.",
            found=unknown[0],
            expected=list(known),
        )
    ranked = sorted((each for each in known.values() if each.rank), key=lambda each: each.rank)
    chosen = [known[name] for name in names] if names else ranked or [*known.values()]
    if not chosen:
        return
    runs = Runs(system)
    for method in chosen:
        yield measure_method(runs, method)


class Runs:
    """Runs of a system from states near its default.

    Args:
        system: The System.
        count: Steps of the longest of the three runs that tell an order.

    Raises:
        KernelArgumentError: None of them can be followed.
    """

    def __init__(self, system: System, count: int = HALVED) -> None:
        self.count = count
        self.system = system = _compile_sooner(system)
        self._ends: dict[float, Array] = {}
        self.at: dict[str, Any] = {"time": 0.0} if system.TIME else {}
        self.is_noisy = has_noise(system)
        states = self._draw([np.array(each.center) for each in system.STATE.values()])
        self.target = "c" if len(states) > LARGE else "numpy"
        if not states.size:
            raise self._fail()
        fast = self._find_speed(np.asarray(system.rhs(states, **self.at)), states)
        if self.is_noisy:  # what it does to a state grows with the root of the time
            fast = max(fast, self._find_speed(self._find_noise(states), states) ** 2)
        self.step = 2.0 ** round(math.log2(1.0 / (STEPS * fast))) if fast > 0 else 0.125
        # by explicit steps, where Python does not lead them
        first = "heun" if self.is_noisy else "midpoint" if system.obstacle else "rk4"
        for _ in range(SHORTER):
            ends = self.run(first, self.step, HALVED, states)
            followed = states[:, np.isfinite(ends).all(axis=0)]
            self.states = followed[:, :LED_MEMBERS] if system.obstacle else followed
            if self.states.size:
                return
            self.step /= 2.0
        raise self._fail()

    def _find_noise(self, states: Array) -> Array:
        """What the processes do to states, ``(n, w, N)``; those of equal members all together."""
        if not isinstance(self.system, FamilySystem):
            return np.asarray(self.system.noise(states, **self.at))
        numbers = np.ones((self.system.NOISE.size, states.shape[1]))
        return np.asarray(self.system.noise_vector(np.concatenate([states, numbers]), **self.at))

    @staticmethod
    def _find_speed(rates: Array, states: Array) -> float:
        """The largest rate of a state, by its size."""
        largest = np.abs(rates).reshape(-1, states.shape[1]).max(axis=0)
        speeds = largest / np.abs(states).max(axis=0)
        return float(np.nanmax(np.where(np.isfinite(speeds), speeds, 0.0), initial=0.0))

    def _fail(self) -> KernelArgumentError:
        """There is nothing to run."""
        name = self.system.name
        return KernelArgumentError(
            f"no motion of {name} near its default state can be followed; expected a default state "
            "inside the domain: give [variables] a default there.",
            found=name,
        )

    def _draw(self, parts: list[Array]) -> Array:
        """States near the default, in the domain and on the constraints that are kept.

        Each quantity is moved by parts of its own size: a place far off moves no attitude. Fields
        of some waves alone, or with the mean 0, are multiplied by numbers.
        """
        source, default = np.random.default_rng(1), np.concatenate(parts)
        if self.system.obstacle or self._has_means():
            factors = [1.0 + s * source.uniform(-1, 1, DRAWN) for s in SPREADS]
            return np.outer(default, np.concatenate(factors))[:, :MEMBERS]
        most = float(np.abs(default).max()) or 1.0
        sizes = [np.full(each.size, np.abs(each).max() or most) for each in parts]
        size = np.concatenate(sizes)[:, np.newaxis]
        moved = [s * size * source.uniform(-1, 1, (default.size, DRAWN)) for s in SPREADS]
        states = default[:, np.newaxis] + np.concatenate(moved, axis=1)
        states = self.project(states)
        inside = np.isfinite(self.system.rhs(states, **self.at)).all(axis=0)
        if "constraint_residual" in self.system.functions:  # from far off it may lead elsewhere
            off = np.abs(np.asarray(self.system.constraint_residual(states, **self.at)))
            inside &= (off < HELD * (1.0 + np.abs(states).max(axis=0)) ** 2).all(axis=0)
        if self.system.DOMAIN:
            inside &= (np.asarray(self.system.domain(states, **self.at)) > 0).all(axis=0)
        return states[:, inside][:, :MEMBERS]

    def _has_means(self) -> bool:
        """Whether the mean of some field has to be 0."""
        return isinstance(self.system, FamilySystem) and bool(list_mean_zero(self.system))

    def project(self, states: Array) -> Array:
        """States moved onto the constraints that are kept."""
        if "projection" in self.system.functions:
            for _ in range(PROJECTED):  # attitudes take a step of Newton's method each time
                states = np.asarray(self.system.projection(states, **self.at))
        return states

    def find_tensor(self, state: Array) -> Array | None:
        """The Poisson tensor at a state; of equal members column by column, None without either."""
        functions = self.system.functions
        if "poisson_tensor" in functions:
            return np.asarray(self.system.poisson_tensor(state, **self.at))
        if "bracket_vector" not in functions:
            return None
        turn = self.system.bracket_vector
        return np.stack([np.asarray(turn(state, e, **self.at)) for e in np.eye(len(state))], axis=1)

    def run(self, method: str, step: float, count: int, states: Array) -> Array:
        """States after so many steps; NaN where they were not reached, as beyond the domain."""
        found = self._simulate(method, step, count, states, samples=1)
        return np.where(np.asarray(found.status) == "OK", found.state[..., -1], np.nan)

    def find_end(self, step: float) -> Array:
        """Where the motion leads in the time of so many steps as `count`, and from `states`."""
        if step not in self._ends:
            time = self.count * step
            if self.system.obstacle:  # one after the other, in Python: the first is enough
                end = np.full(self.states.shape, np.nan)
                end[:, :1] = self._follow(LED, time, self.states[:, :1], rtol=1e-13, atol=1e-15)
            else:
                end = self._follow(PLAIN, time, self.states, step=step / FINE)
            self._ends[step] = end
        return self._ends[step]

    def _follow(self, name: str, time: float, states: Array, **lengths: Any) -> Array:
        """The ends by a method; NaN where they were not reached."""
        found = self.system.simulate(
            states,
            (0.0, time),
            method=name,
            samples=1,
            target=self.target,
            progress=False,
            **lengths,
        )
        return np.where(np.asarray(found.status) == "OK", found.state[..., -1], np.nan)

    def find_gap(self, law: str, method: str) -> float:
        """What steps miss of a law at the most, relative to the energy or the entropy."""
        found = self._simulate(method, self.step, HALVED, self.states, samples=HALVED + 1)
        path = np.moveaxis(found.state, -1, 0)
        missed = [self._miss(law, n, *path[n : n + 2]) for n in range(HALVED)]
        return float(np.nanmax(missed)) if np.isfinite(missed).any() else math.nan

    def _miss(self, law: str, n: int, start: Array, end: Array) -> Array:
        """Of step n: what the energy grows or the entropy falls by, or a gap of the balance.

        The balance is ``h g.(P(m) g + f(m))`` with the discrete gradient g, the mean of the
        gradient along the step corrected along it, the tensor P at the middle m, and f what else
        acts there.
        """
        system = self.system
        at: dict[str, Any] = {"time": (n + 0.5) * self.step} if system.TIME else {}
        value = system.entropy if law == GROWING else system.energy
        before, after = (np.asarray(value(each, **at)) for each in (start, end))
        size = np.maximum(1.0, np.abs([before, after]).max(axis=0))
        if law == GROWING:
            return np.asarray((before - after) / size)
        chord, middle = end - start, 0.5 * (start + end)
        places, weights = np.polynomial.legendre.leggauss(5)
        along = [system.energy_gradient(middle + 0.5 * p * chord, **at) for p in places]
        slope = 0.5 * np.einsum("n,ni...->i...", weights, along)
        square = (chord * chord).sum(axis=0)
        rest = after - before - (slope * chord).sum(axis=0)
        slope = slope + np.where(square > 0, rest / np.where(square > 0, square, 1.0), 0.0) * chord
        more = slope - np.asarray(system.energy_gradient(middle, **at))
        act = np.asarray(system.rhs(middle, **at)) + system.bracket_vector(middle, more, **at)
        gained = self.step * (slope * act).sum(axis=0)
        gap = np.abs(after - before - gained)
        grown = after - before if law == FALLING else 0.0
        return np.asarray(np.maximum(gap, grown) / size)

    def follow_paths(self, method: str, part: int) -> Array:
        """Ends of paths of one noise by steps of a part of the step, a quarter at the least."""
        system, choice = self.system, Choice(name=method, order=1, is_noisy=True)
        stepper = (
            FamilyTwin(system, choice, "numpy")
            if isinstance(system, FamilySystem)
            else NumpyStepper(system, choice)
        )
        stepper.parts = 4 // part
        inputs = np.zeros(0) if not system.INPUTS else pack_inputs(system, None)
        run = Ensemble(
            state=np.repeat(self.states, PATHS, axis=1),
            parameters=pack_parameters(system, None),
            inputs=Inputs(np.zeros(1), inputs[:, np.newaxis], np.zeros((len(inputs), 1))),
            has_time=bool(system.TIME),
            samples=np.array([HALVED * self.step]),
            out=None,
            rtol=0.0,
            atol=0.0,
            size=self.step / part,
            max_steps=HALVED * part,
            seed=SEED,
            bound=find_bound(method, self.step / 4),
            is_implicit=choice.is_implicit,
            has_clock=not isinstance(system, FamilySystem),
        )
        run.begin(0.0)
        stepper.advance(run, 0, run.state.shape[1], HALVED * part)
        return np.where(run.status == Status.OK, run.state, np.nan)

    def step_alike(self, method: str, step: float, states: Array) -> Array:
        """States after one step, with the same noise: that of a first member."""
        if not self.is_noisy:
            return self.run(method, step, 1, states)
        columns = np.split(states, states.shape[1], axis=1)
        return np.concatenate([self.run(method, step, 1, each) for each in columns], axis=1)

    def find_drifts(
        self, method: str, count: int = DRIFTING, target: str = ""
    ) -> tuple[dict[str, float], float, dict[str, float]]:
        """The largest drift of each integral at ends of steps, how states grew, and how drifts did.

        The last are exponents p of the best lines ``log drift = p log n + c`` through numbers n of
        steps that are doubled, of the median of members; what is less than a rounding is half one.
        """
        found = self._simulate(method, self.step, count, self.states, count + 1, target)
        sizes = np.abs(found.state).max(axis=0)
        first = sizes[..., :1]
        growth = float(np.nanmax(sizes / first, initial=1.0))
        drifts = {name: float(np.nanmax(x)) for name, x in found.drift.items()}
        if isinstance(self.system, FamilySystem):
            for name, radii in self.system.find_radii(found.state).items():
                drifts[name] = float(np.nanmax(np.abs(radii / radii[..., :1] - 1.0)))
        exponents = {
            name: _find_exponent(found.change(name)[..., 1:], found[name][..., 1:])
            for name in found.drift
        }
        return drifts, growth, exponents

    def find_target(self, method: str) -> str:
        """Where a run takes less time, with compiling."""
        own = STRUCTURED.get(method)
        is_slow = own is not None and own.stages > 1 and own.file not in QUICK
        return "c" if is_slow else self.target

    def _simulate(
        self, method: str, step: float, count: int, states: Array, samples: int, target: str = ""
    ) -> Any:
        return self.system.simulate(
            states,
            (0.0, count * step),
            method=method,
            step=step,
            samples=samples,
            target=target or self.find_target(method),
            progress=False,
            seed=SEED if self.is_noisy else None,
        )


def _compile_sooner(system: System) -> System:
    """The same system, whose code compilers hardly optimise: it runs for some steps alone.

    Short loops over many members take longer to run than to optimise, and are optimised.
    """
    own = copy(system)
    own.__dict__.pop("_solvers", None)
    levels = {SOLVER.stem: 0}
    if not isinstance(system, FamilySystem) or _is_long(system):
        levels[KERNEL.stem] = 1
    own.levels = {(stem, build): level for stem, level in levels.items() for build in BUILDS}
    return own


def _is_long(system: System) -> bool:
    """Whether a kernel takes more time to optimise than its runs take without."""
    path = system.folder / KERNEL.files[0]
    return path.is_file() and path.stat().st_size > LONG


def measure_method(runs: Runs, method: JudgedMethod, count: int = DRIFTING) -> Measured:
    """A method on the runs of a system, against what is claimed of it.

    Args:
        runs: Of the system.
        method: The method.
        count: Steps of the run that tells drifts.
    """
    order, reached = _find_order(runs, method)
    apart = _find_distance(runs, method) if runs.is_noisy else None
    defect = find_defect(runs, method.name) if method.is_poisson else None
    failures = [] if reached else ["no run reached its end"]
    # of the default method as users have it: its C is compiled, and compared with NumPy
    target = "c" if method.rank == 1 else ""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", "a wrong ", CompilerWarning)
            drifts, growth, exponents = runs.find_drifts(method.name, count, target)
    except CompilerWarning:
        drifts, growth, exponents = runs.find_drifts(method.name, count, "numpy")
        failures.append("its C is another method than its NumPy")
    shy = SHY_OF_PATHS if runs.is_noisy else SHY
    if order is not None and not order > method.order - shy:
        failures.append(f"its order is {order:.1f}, and {method.order} is claimed")
    if defect is not None and not defect < DEFECT:
        failures.append(f"a step is {defect:.1e} from a Poisson map")
    missed = {name: drifts.get(name, math.nan) for name in method.exactly}
    failures += [
        f"{name} drifts by {drift:.1e}"
        for name, drift in missed.items()
        if not drift < DRIFT * growth**2
    ]
    if apart is not None and not apart[0] < apart[1]:
        failures.append(f"its paths end {apart[0]:.1e} from those of {apart[2]}")
    laws = {law: runs.find_gap(law, method.name) for law in method.laws}
    failures += [
        f"{law} is missed by {gap:.1e}" for law, gap in laws.items() if not gap < LAW * growth**2
    ]
    compared = (order is not None) + (apart is not None) + (defect is not None)
    compared += len(missed) + len(laws)
    return Measured(
        method=method,
        order=order,
        defect=defect,
        drifts=drifts,
        exponents=exponents,
        grown=growth,
        laws=laws,
        compared=compared,
        failures=tuple(failures),
    )


def _find_exponent(change: Array, values: Array) -> float:
    """The exponent of the growth of an observable's change, ``(*shape, N, T)`` from step 1 on."""
    count, members = change.shape[-1], change.shape[-2]
    moved = np.abs(change).reshape(-1, members, count).max(axis=0)
    size = np.abs(values).reshape(-1, members, count).max(axis=(0, 2))
    part = moved / np.where(size > 0, size, 1.0)[:, np.newaxis]
    largest = np.nanmedian(np.fmax.accumulate(part, axis=1), axis=0)
    places = 2 ** np.arange(int(math.log2(count)) + 1)
    seen = np.maximum(largest[places - 1], 0.25 * np.finfo(float).eps)
    return float(np.polyfit(np.log(places), np.log(seen), 1)[0])


def _find_order(runs: Runs, method: JudgedMethod) -> tuple[float | None, bool]:
    """The order by runs with steps that are halved, and whether some reached the end.

    It is that of their distance from the motion. Where it is too low, steps may be too long for it:
    those of a run more are half as long. Where there are roundings alone, those of a run more are
    twice as long, as far as they are solved; of an order that is too low there, gaps between runs
    with shorter steps tell whether these are too long. Roundings make the last distance larger, and
    the order smaller.
    """
    if runs.is_noisy:
        return _compare([runs.follow_paths(method.name, part) for part in (1, 2, 4)], mean=True)
    first = runs.step * (2.0 if method.order > 4 else 1.0)
    count, enough, end = runs.count, method.order - SHY, runs.find_end(first)
    ends = [runs.run(method.name, first / part, count * part, runs.states) for part in (1, 2, 4)]
    order, reached = _approach(ends, end)
    for power in range(1, SOONER + 1):
        if order is not None or not reached or not count >> power:
            break
        longer = runs.run(method.name, first * 2**power, count >> power, runs.states)
        order, _ = _approach([longer, *ends[:2]], end)
        if order is not None:
            shorter, _ = (order, True) if order > enough else _compare(ends, rounded=0.0)
            return None if shorter is None else max(order, shorter), True
        ends = [longer, *ends[:2]]
    for part in LATER:
        if order is None or order > enough:
            break
        ends = [*ends[1:], runs.run(method.name, first / part, count * part, runs.states)]
        again, _ = _approach(ends, end)
        order = order if again is None else again
    return order, reached


def _approach(ends: list[Array], end: Array) -> tuple[float | None, bool]:
    """The order by the ends of runs and that of the motion, and whether some reached it.

    It is that of the last two distances that are no roundings; None where there are none.

    Args:
        ends: States, with halved steps.
        end: Those of the motion.
    """
    reached = np.isfinite([*ends, end]).all(axis=(0, 1))
    if not reached.any():
        return None, False
    end = end[:, reached]
    far = [float(np.abs(each[:, reached] - end).max()) for each in ends]
    seen = [pair for pair in pairwise(far) if pair[1] > ROUNDED * float(np.abs(end).max())]
    return (math.log2(seen[-1][0] / seen[-1][1]) if seen else None), True


def _find_distance(runs: Runs, method: JudgedMethod) -> tuple[float, float, str]:
    """How far paths end from those of another method, how far they may, and the other's name.

    Both come closer to the path by as much as halved steps move them, about.
    """
    other = "midpoint" if method.name == "heun" else "heun"
    ends = [[runs.follow_paths(x, part) for part in (2, 4)] for x in (method.name, other)]
    reached = np.isfinite(ends).all(axis=(0, 1, 2))
    if not reached.any():
        return math.nan, 0.0, other
    (two, four), (others, last) = ([x[:, reached] for x in pair] for pair in ends)
    moved = np.mean(np.abs(two - four)) + np.mean(np.abs(others - last))
    return float(np.mean(np.abs(four - last))), float(2.0 * moved), other


def _compare(
    ends: list[Array], *, mean: bool = False, rounded: float = ROUNDED
) -> tuple[float | None, bool]:
    """The order by the ends of three runs; None where they differ by roundings alone.

    Args:
        ends: States, with halved steps.
        mean: Whether the mean gap counts, and not the largest one.
        rounded: Gaps up to that, relative to the state, are roundings.
    """
    reached = np.isfinite(ends).all(axis=(0, 1))
    if not reached.any():
        return None, False
    one, two, three = (each[:, reached] for each in ends)
    size = float(np.abs(three).max())
    find = np.mean if mean else np.max
    gaps = float(find(np.abs(one - two))), float(find(np.abs(two - three)))
    if not gaps[1] > rounded * size:
        return None, True
    return math.log2(gaps[0] / gaps[1]), True


def find_defect(runs: Runs, method: str, part: float = 1.0) -> float | None:
    """``max |D J D^T - J|`` of a step with the derivative D, relative to J; by differences.

    They are along the leaf, whose directions are those of J: constraints hold there. None without
    a tensor.

    Args:
        runs: Of the system.
        method: The name of the method.
        part: The length of the step, in those of the runs.
    """
    column = runs.states[:, :1]
    state = column[:, 0]
    start = runs.find_tensor(state)
    if start is None:
        return None
    along, sizes, _ = np.linalg.svd(start)
    along = along[:, sizes > LEAST * sizes[0]]
    inner, defects = along.T @ start @ along, list[float]()
    for distance in _DIFFERENCES:
        eps = distance * float(np.abs(state).max())
        moves = [m * eps * along for n in range(1, len(_WEIGHTS) + 1) for m in (n, -n)]
        given = np.concatenate([column, *(column + move for move in moves)], axis=1)
        ends = runs.step_alike(method, part * runs.step, runs.project(given))
        pairs = ends[:, 1:].reshape(len(ends), len(_WEIGHTS), 2, along.shape[1])
        slope = np.einsum("n,inj->ij", _WEIGHTS, pairs[:, :, 0] - pairs[:, :, 1]) / eps
        end = runs.find_tensor(ends[:, 0])
        assert end is not None
        off = np.abs(slope @ inner @ slope.T - end).max() / np.abs(end).max()
        defects.append(float(off))
        if off < DEFECT:
            break
    return min(defects)
