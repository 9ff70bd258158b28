"""Methods for motions with noise, over many members at a time, in NumPy.

Over a step the noise is taken as constant: its increments over the length of the step. So Heun's
method and the implicit midpoint follow ``rhs + noise (dW/h)``, which gives the motion in the sense
of Stratonovich. They are the functions of the generated ``solver.c``, operation by operation.
Heun's keeps nothing exactly; the midpoint keeps what is linear or quadratic and kept on each path,
as far as the equation of a step is solved, which is to rounding. On spheres the spherical midpoint
keeps Casimirs and the Poisson bracket.
Comes in: where members are. Goes out: where a step of each leads.
Read next: `coadjoint.solve.normals`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.lower.normals import SWEEPS
from coadjoint.methods import Sphere
from coadjoint.solve.methods.spherical_midpoint import Scale
from coadjoint.solve.normals import draw_normals
from coadjoint.solve.runge_kutta import end_where_rates_end
from coadjoint.solve.steps import Attempt, Lanes, find_fixed_step, larger

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

#: The part of the largest component by which the last sweep of a step may change it.
SOLVED: Final = 2.0**-44
#: Rows of a function of the kernel, some time after that of the lanes.
Function = Callable[[Lanes, "Array", "Array"], "Array"]


def find_bound(name: str, step: float) -> float:
    """The largest size of a normal number: that of an implicit step has to be bounded.

    G. N. Milstein, Yu. M. Repin and M. V. Tretyakov, SIAM Journal on Numerical Analysis 39 (2002)
    2066: ``sqrt(4 |log h|)``, by which the strong order 1 stays. It is 2 for steps above 1/e.
    """
    return math.inf if name == "heun" else math.sqrt(4.0 * max(1.0, -math.log(step)))


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
        spheres: Rows of vectors on spheres, and of their tangents.
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
        spheres: Sequence[Sphere] = (),
    ) -> None:
        self.spheres = spheres
        self.rates, self.fields, self.along, self.size = rates, fields, along, size
        self.processes = np.arange(processes, dtype=np.uint64)[:, np.newaxis]
        self.seed, self.bound, self.branches = seed, bound, branches

    def find_noise(self, lanes: Lanes, h: Array, process: int | NDArray[np.uint64]) -> Array:
        """The increment of a Wiener process over the length of the step, or those of some."""
        normal = draw_normals(self.seed, lanes.member, lanes.steps, process)
        normal = np.where(normal > -self.bound, normal, -self.bound)
        normal = np.where(normal < self.bound, normal, self.bound)
        return np.asarray(normal * np.sqrt(h) / h)

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
        self, lanes: Lanes, h: Array, end: Array, accepted: NDArray[np.bool_]
    ) -> Attempt:
        """A step that was made; between its ends the path is straight."""
        start = lanes.state
        return Attempt(
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
        rates, half, middle = self.move(lanes, h), h * 0.5, lanes.state
        done, solved = np.zeros(h.shape, bool), np.zeros(h.shape, bool)
        last, kept = np.full(h.shape, np.inf), self.prepare(lanes.state)
        rows = np.zeros(middle.shape)
        for _ in range(SWEEPS):
            if done.all():
                break
            found = rates(half, middle)
            following = lanes.state + half * found
            rows = np.where(done, rows, found)
            for each in kept:
                each.apply(lanes.state, half * found, following)
            change, size = np.zeros(h.shape), np.zeros(h.shape)
            for one, other in zip(following, middle, strict=True):
                change, size = larger(np.abs(one - other), change), larger(np.abs(one), size)
            middle = np.where(done, middle, following)
            small = change <= SOLVED * size
            solved = np.where(done, solved, small)
            fresh = (change == 0.0) | (small & (change >= last))
            last = np.where(done, last, change)
            done |= fresh
        if not kept:
            return self.make_attempt(lanes, h, 2.0 * middle - lanes.state, solved)
        for each in kept:
            solved &= each.is_root()
        return self.make_attempt(lanes, h, lanes.state + h * rows, solved)

    def prepare(self, state: Array) -> list[Scale]:
        """What moves vectors to spheres: nothing."""
        return []


class SphericalMidpoint(Midpoint):
    """The spherical midpoint, with the noise of a step as part of its energy.

    It keeps what the spherical midpoint keeps, path by path: Casimirs and the Poisson bracket.
    """

    def prepare(self, state: Array) -> list[Scale]:
        """As of `Midpoint`: of each sphere the quotient of lengths."""
        return [Scale(state, 0.0 * state, each) for each in self.spheres]


#: The methods by name.
METHODS: Final[Mapping[str, type[Heun] | type[Midpoint]]] = MappingProxyType(
    {"heun": Heun, "midpoint": Midpoint, "spherical_midpoint": SphericalMidpoint}
)
