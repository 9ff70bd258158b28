"""Methods for motions with noise, over many members at a time, in NumPy.

Over a step the noise is taken as constant: its increments over the length of the step. So Heun's
method and the implicit midpoint follow ``rhs + noise (dW/h)``, which gives the motion in the sense
of Stratonovich. They are the functions of the generated ``solver.c``, operation by operation.
Heun's keeps linear functions; the midpoint keeps what is linear or quadratic and kept on each path,
as far as the equation of a step is solved, which is to rounding. The coadjoint mean, and on spheres
the spherical midpoint, keep Casimirs and the Poisson bracket: the Hamiltonians of noise times the
increments are a part of the energy of a step.
Comes in: where members are. Goes out: where a step of each leads.
Read next: `coadjoint.solve.normals`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.lower.normals import SWEEPS
from coadjoint.methods import Sphere
from coadjoint.solve.methods import coadjoint_mean
from coadjoint.solve.methods.lie_poisson import Arc, Bracket, Sweep
from coadjoint.solve.methods.spherical_midpoint import Scale
from coadjoint.solve.normals import draw_normals
from coadjoint.solve.runge_kutta import end_where_rates_end
from coadjoint.solve.steps import Attempt, Lanes, Left, find_fixed_step, larger

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array

#: The part of the largest component by which the last sweep of a step may change it.
SOLVED: Final = 2.0**-44
#: Rows of a function of the kernel, some time after that of the lanes.
Function = Callable[[Lanes, "Array", "Array"], "Array"]


def find_bound(name: str, step: float) -> float:
    """The largest size of a normal number: that of an implicit step has to be bounded.

    G. N. Milstein, Yu. M. Repin and M. V. Tretyakov, SIAM Journal on Numerical Analysis 40 (2002)
    1583: ``sqrt(4 |log h|)``, by which the strong order 1 stays. It is 2 for steps above 1/e.
    """
    return math.inf if name == "heun" else math.sqrt(4.0 * max(1.0, -math.log(step)))


@dataclass(frozen=True)
class Orbits:
    """What a motion with noise on coadjoint orbits is made of, for `CoadjointMean`.

    Attributes:
        gradient: The derivative of the energy by the state, ``(n, N)``.
        slopes: Those of the Hamiltonians of noise, ``(n, w, N)``.
        bracket: The Poisson tensor at a state times a vector.
    """

    gradient: Function
    slopes: Function
    bracket: Bracket


class _Noisy:
    """What both methods have in common.

    Args:
        rates: Stratonovich's drift, ``(n, N)``.
        fields: What each Wiener process does, ``(n, w, N)``; None where ``along`` says it.
        along: What all do for a number of each, which stand below the state, ``(n, N)``.
        processes: How many there are, for ``along``.
        size: The step.
        seed: Of the noise.
        bound: The largest size of a normal number.
        branches: Whether the drift has branch points: it has to be finite after each step.
        parts: Of how many numbers the increment of a step is the sum, so that long steps follow
            the path of as many short ones.
        spheres: Rows of vectors on spheres, and of their tangents.
        orbits: Of a motion on coadjoint orbits, what it is made of.
    """

    tries_again = halves = False

    def __init__(
        self,
        *,
        rates: Function,
        fields: Function | None = None,
        along: Function | None = None,
        processes: int = 0,
        size: float,
        seed: int,
        bound: float,
        branches: bool = False,
        parts: int = 1,
        spheres: Sequence[Sphere] = (),
        orbits: Orbits | None = None,
    ) -> None:
        self.spheres, self.orbits, self.parts = spheres, orbits, parts
        self.rates, self.fields, self.along, self.size = rates, fields, along, size
        self.processes = np.arange(processes, dtype=np.uint64)[:, np.newaxis]
        self.seed, self.bound, self.branches = seed, bound, branches

    def find_noise(self, lanes: Lanes, h: Array, process: int | NDArray[np.uint64]) -> Array:
        """The increment of a Wiener process over the length of the step, or those of some."""
        first, total = lanes.steps * np.uint64(self.parts), np.zeros(1)
        for part in range(self.parts):
            normal = draw_normals(self.seed, lanes.member, first + np.uint64(part), process)
            normal = np.where(normal > -self.bound, normal, -self.bound)
            total = total + np.where(normal < self.bound, normal, self.bound)
        return np.asarray(total * np.sqrt(h / self.parts) / h)

    def move(self, lanes: Lanes, h: Array) -> Callable[[Array, Array], Array]:
        """The rates with the noise of a step."""
        noise: list[Array] = []
        fields_of, along = self.fields, self.along
        if along is not None:
            numbers = self.find_noise(lanes, h, self.processes)
            return lambda after, state: (
                self.rates(lanes, after, state)
                + along(lanes, after, np.concatenate([state, numbers]))
            )
        assert fields_of is not None, "one of the two"

        def rates(after: Array, state: Array) -> Array:
            rows, fields = self.rates(lanes, after, state), fields_of(lanes, after, state)
            while len(noise) < fields.shape[1]:
                noise.append(self.find_noise(lanes, h, len(noise)))
            for process, each in enumerate(noise):
                rows = rows + fields[:, process] * each
            return rows

        return rates

    def make_attempt(
        self,
        lanes: Lanes,
        h: Array,
        end: Array,
        accepted: NDArray[np.bool_],
        sweeps: NDArray[np.uint64] | None = None,
    ) -> Attempt:
        """A step that was made, by so many sweeps; between its ends the path is straight."""
        start = lanes.state
        return Attempt(
            left=None if sweeps is None else Left(None, sweeps, accepted),
            took=np.where(accepted, h, 0.0),
            state=end_where_rates_end(self.rates, lanes, h, end) if self.branches else end,
            accepted=accepted,
            path=lambda after: np.asarray(start + after / h * (end - start)),
            coefficients=lambda: np.stack([start, (end - start) / h], axis=1),
        )


class Heun(_Noisy):
    """Heun's method, for Stratonovich's equations: two evaluations of rates and noise a step."""

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `coadjoint.solve.steps.Method.try_step`."""
        h = find_fixed_step(lanes, self.size)
        rates = self.move(lanes, h)
        first = rates(np.zeros(h.shape), lanes.state)
        later = rates(h, lanes.state + h * first)
        end = lanes.state + h * 0.5 * (first + later)
        return self.make_attempt(lanes, h, end, np.ones(h.shape, bool))


class Midpoint(_Noisy):
    """The implicit midpoint, its equation solved by sweeps until they change it no more."""

    def try_step(self, lanes: Lanes) -> Attempt:
        """As `coadjoint.solve.steps.Method.try_step`."""
        h = find_fixed_step(lanes, self.size)
        middle, rise, own = lanes.state, np.zeros(lanes.state.shape), self.prepare(lanes, h)
        done, solved = np.zeros(h.shape, bool), np.zeros(h.shape, bool)
        last, made = np.full(h.shape, np.inf), np.zeros(h.shape, np.uint64)
        for _ in range(SWEEPS):
            if done.all():
                break
            made += ~done
            found = own.sweep(middle)
            ends, following = ~np.asarray(found.goes_on), found.middle
            rise = np.where(done, rise, found.rise)
            change, size = np.zeros(h.shape), np.zeros(h.shape)
            for one, other in zip(following, middle, strict=True):
                change, size = larger(np.abs(one - other), change), larger(np.abs(one), size)
            middle = np.where(done, middle, following)
            small = (change <= SOLVED * size) & ends
            solved = np.where(done, solved, small)
            fresh = ((change == 0.0) & ends) | (small & (change >= last))
            last = np.where(done, last, change)
            done |= fresh
        end = own.finish(middle, rise)
        solved &= own.confirm() & np.isfinite(end).all(axis=0)
        return self.make_attempt(lanes, h, np.where(solved, end, lanes.state), solved, made)

    def prepare(self, lanes: Lanes, h: Array) -> _Chord:
        """What finds a better middle of a step."""
        return _Chord(self, lanes, h)


class _Chord:
    """The middle of the chord of a step.

    Args:
        method: Whose step it is.
        lanes: Where it begins.
        h: How long it is.
    """

    def __init__(self, method: _Noisy, lanes: Lanes, h: Array) -> None:
        self.rates, self.start, self.length = method.move(lanes, h), lanes.state, h
        self.half = h * 0.5

    def sweep(self, middle: Array) -> Sweep:
        """A better middle, and what the step adds with the rates at the one before."""
        rates = self.rates(self.half, middle)
        return Sweep(self.start + self.half * rates, self.length * rates)

    def confirm(self) -> NDArray[np.bool_] | bool:
        """Where what sweeps share is that of a solution."""
        return True

    def finish(self, middle: Array, rise: Array) -> Array:
        """The end of a step from what was found last."""
        return 2.0 * middle - self.start


class SphericalMidpoint(Midpoint):
    """The spherical midpoint, with the noise of a step as part of its energy.

    It keeps what the spherical midpoint keeps, path by path: Casimirs and the Poisson bracket.
    """

    def prepare(self, lanes: Lanes, h: Array) -> _Chord:
        """As of `Midpoint`: its middle is on the spheres."""
        return _OnSpheres(self, lanes, h)


class _OnSpheres(_Chord):
    """The same, moved to the spheres of the state."""

    def __init__(self, method: _Noisy, lanes: Lanes, h: Array) -> None:
        super().__init__(method, lanes, h)
        state = lanes.state
        self.kept = [Scale(state, 0.0 * state, each) for each in method.spheres]

    def sweep(self, middle: Array) -> Sweep:
        """As of `_Chord`."""
        rates = self.rates(self.half, middle)
        chord = self.half * rates
        following = self.start + chord
        for each in self.kept:
            each.apply(self.start, chord, following)
        return Sweep(following, self.length * rates)

    def confirm(self) -> NDArray[np.bool_] | bool:
        """Quotients of lengths are solved."""
        return np.asarray(np.all([each.is_root() for each in self.kept], axis=0))

    def finish(self, middle: Array, rise: Array) -> Array:
        """What the step adds is what the last sweep found."""
        return self.start + rise


class CoadjointMean(Midpoint):
    """The coadjoint mean, with the noise of a step as part of its energy.

    Its element is ``xi = dH + sum_k dH_k dW_k/h`` at the mean of the arc, so that a path keeps
    Casimirs and the Poisson bracket as without noise.
    """

    def prepare(self, lanes: Lanes, h: Array) -> _Chord:
        """As of `Midpoint`: its middle is the mean of an arc."""
        return _AlongOrbits(self, lanes, h)


class _AlongOrbits(_Chord):
    """The mean of the arc of a coadjoint action."""

    def __init__(self, method: _Noisy, lanes: Lanes, h: Array) -> None:
        super().__init__(method, lanes, h)
        orbits = method.orbits
        assert orbits is not None, "asked for of motions on orbits alone"
        noise: list[Array] = []

        def element(lanes: Lanes, after: Array, middle: Array) -> Array:
            xi = orbits.gradient(lanes, after, middle)
            slopes = orbits.slopes(lanes, after, middle)
            while len(noise) < slopes.shape[1]:
                noise.append(method.find_noise(lanes, h, len(noise)))
            for process, each in enumerate(noise):
                xi = xi + slopes[:, process] * each
            return xi

        self.method = coadjoint_mean.CoadjointMean(
            gradient=element, bracket=orbits.bracket, size=method.size
        )
        low = np.zeros(lanes.state.shape)
        self.arc = Arc(lanes=lanes, middle=self.half, length=h, state=lanes.state, low=low)
        self.kept = self.method.prepare(self.arc, lanes.state)

    def sweep(self, middle: Array) -> Sweep:
        """As of `_Chord`."""
        return self.method.sweep(self.arc, middle, self.kept)

    def finish(self, middle: Array, rise: Array) -> Array:
        """What the step adds is what the last sweep found."""
        return self.start + rise


#: The methods by name.
METHODS: Final[Mapping[str, type[Heun] | type[Midpoint]]] = MappingProxyType(
    {
        "heun": Heun,
        "midpoint": Midpoint,
        "spherical_midpoint": SphericalMidpoint,
        "coadjoint_mean": CoadjointMean,
    }
)
