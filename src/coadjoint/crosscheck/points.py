"""Cross-check, points: where kernels are compared, random and hard, the same in every run.

Comes in: names, signs and a seed. Goes out: batches of state, parameters, inputs and time,
component first. The hard families are those in which faults of floating-point code show: outputs
near cancellation, nearly equal parameters, zeros and small integers, huge and tiny magnitudes; and,
for comparisons of bits alone, overflow, infinities, NaN and subnormals.
Read next: `coadjoint.crosscheck.ladder`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import accumulate
from typing import Final

import numpy as np
from numpy.typing import NDArray

from coadjoint.array_types import Array
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import Program

#: Evaluates one function.
Evaluate = Callable[["Batch"], Array]

SEED: Final = 20110707
#: Families of finite points.
FAMILIES: Final = ("random", "nearly equal", "integers", "huge and tiny")
#: Batches that end in the middle of any vector register, and the single member.
ODD_SIZES: Final = (1, 2, 3, 7, 8, 15, 17, 1001)

SPECIAL: Final = np.array(
    [
        *(0.0, -0.0, 1.0, -1.0, 1.5, np.inf, -np.inf, np.nan),
        *(2.0**-1074, -(2.0**-1074), 2.0**-1030, 2.0**-1022, -(2.0**-1022)),
        *(np.finfo(np.float64).max, -np.finfo(np.float64).max, 1e200, -1e160, 1e-170, -1e-200),
    ]
)


@dataclass(frozen=True)
class Batch:
    """Members on which a kernel is evaluated.

    Attributes:
        arrays: By name, in this order: state, ``(n, N)``; parameters, ``(k,)`` if shared, else
            ``(k, N)``; and in the same form inputs and time, one row of this, as far as the system
            has them.
    """

    arrays: Mapping[str, Array]

    @property
    def state(self) -> Array:
        """Shape ``(n, N)``."""
        return self.arrays["state"]

    @property
    def parameters(self) -> Array:
        """Shape ``(k,)`` or ``(k, N)``."""
        return self.arrays["parameters"]

    @property
    def size(self) -> int:
        """Number of members."""
        return int(self.state.shape[1])

    @property
    def driving(self) -> tuple[str, ...]:
        """Which of inputs and time there are."""
        return tuple(self.arrays)[2:]

    def share(self, *names: str) -> Batch:
        """The same with the first member's parameters, inputs or time for all."""
        firsts = {name: np.ascontiguousarray(self.arrays[name][:, 0]) for name in names}
        return Batch({**self.arrays, **firsts})

    def arguments(self, states: int) -> tuple[list[Array], dict[str, Array]]:
        """What a function of so many rows of state takes, by position and by name."""
        given = {**self.arrays, "state": self.state[:states]}
        named = {"time": given.pop("time")[0]} if "time" in given else {}
        return list(given.values()), named

    def rows(self) -> tuple[Array, ...]:
        """Every row of state, parameters, inputs and time."""
        return tuple(row for array in self.arrays.values() for row in array)

    def with_members(self, members: NDArray[np.intp], other: Batch) -> Batch:
        """The same, some members replaced by those of another batch."""
        merged = {name: array.copy() for name, array in self.arrays.items()}
        for name, array in merged.items():
            array[:, members] = other.arrays[name]
        return Batch(merged)

    def join(self, other: Batch) -> Batch:
        """The members of this batch and those of another."""
        pairs = ((name, [array, other.arrays[name]]) for name, array in self.arrays.items())
        return Batch({name: np.concatenate(pair, axis=1) for name, pair in pairs})

    def repeat(self, start: Batch, *names: str) -> Batch:
        """The same, all with the parameters, inputs or time of the first member of another."""
        firsts = {name: start.arrays[name][:, :1] for name in names}
        repeated = {name: np.repeat(a, self.size, axis=1) for name, a in firsts.items()}
        return Batch({**self.arrays, **repeated})

    def take(self, chosen: NDArray[np.intp] | slice) -> Batch:
        """Some of the members; what is shared stays so."""
        return Batch({n: a[:, chosen] if a.ndim > 1 else a for n, a in self.arrays.items()})


@dataclass(frozen=True)
class Points:
    """A source of batches for one system.

    Attributes:
        states: Number of state components.
        positive: For each parameter component, whether it must be positive.
        exponent: Binary exponent that magnitudes may reach, so that no product leaves the range.
        driving: Number of rows of inputs and time, by name.
    """

    states: int
    positive: tuple[bool, ...]
    exponent: int
    driving: Mapping[str, int] = field(default_factory=dict)

    @property
    def _rows(self) -> int:
        return self.states + len(self.positive) + sum(self.driving.values())

    def families(self, seed: int, count: int) -> Mapping[str, Batch]:
        """Finite points with results in range, ``count`` of each family."""
        return {family: self.draw(family, seed, count) for family in FAMILIES}

    def draw(self, family: str, seed: int, count: int) -> Batch:
        """Points of one of `FAMILIES`, the same as among all of them."""
        makers = (self._random, self._nearly_equal, self._integers, self._huge_and_tiny)
        number = FAMILIES.index(family)
        generator = np.random.default_rng([SEED, seed, number])
        return self._batch(makers[number](generator, (self._rows, count)))

    def draw_around(self, centres: Array, seed: int, count: int) -> Batch:
        """Points near some others, at distances of six decades.

        Args:
            centres: Shape ``(rows, N)``, all that a batch has; NaN for components that may be any.
            seed: Chooses the points.
            count: How many.
        """
        generator = np.random.default_rng([SEED, seed, 98])
        start = centres[:, np.arange(count) % centres.shape[1]]
        sizes = 2.0 ** generator.uniform(-20, 0, count)
        near = start * (1 + sizes * generator.normal(size=start.shape))
        return self._batch(np.where(np.isnan(start), generator.normal(size=start.shape), near))

    def draw_special(self, seed: int, count: int) -> Batch:
        """Overflow, infinities, NaN, subnormals and signed zeros among ordinary numbers."""
        generator = np.random.default_rng([SEED, seed, 99])
        shape = (self._rows, count)
        ordinary = generator.normal(size=shape)
        strange = generator.choice(SPECIAL, size=shape)
        return self._batch(np.where(generator.random(shape) < 0.3, strange, ordinary))

    def _batch(self, rows: Array) -> Batch:
        """Rows as state, parameters, inputs and time, those declared positive made so."""
        state, parameters, *others = np.split(rows, self._ends)
        signs = np.array(self.positive, dtype=bool)[:, np.newaxis]
        positive = np.where(np.abs(parameters) > 0, np.abs(parameters), 1.0)
        parameters = np.where(signs, positive, parameters)
        driving = dict(zip(self.driving, others, strict=True))
        return Batch({"state": state, "parameters": parameters, **driving})

    @property
    def _ends(self) -> list[int]:
        """Where each array ends but the last."""
        counts = [self.states, len(self.positive), *self.driving.values()]
        return list(accumulate(counts))[:-1]

    def _random(self, generator: np.random.Generator, shape: tuple[int, int]) -> Array:
        """Normal numbers in one half of the members, six decades of magnitude in the other."""
        normal = generator.normal(size=shape)
        wide = np.copysign(10.0 ** generator.uniform(-3, 3, shape), normal)
        return np.where(np.arange(shape[1]) % 2 == 0, normal, wide)

    def _nearly_equal(self, generator: np.random.Generator, shape: tuple[int, int]) -> Array:
        """All components of a member equal up to sign and a few units in the last place."""
        base = np.exp(generator.normal(size=(1, shape[1])))
        nudge = 1 + generator.integers(-4, 5, shape) * 2.0**-52
        return np.asarray(base * nudge * generator.choice([-1.0, 1.0], shape))

    def _integers(self, generator: np.random.Generator, shape: tuple[int, int]) -> Array:
        return generator.choice([-2.0, -1.0, -0.0, 0.0, 1.0, 2.0, 3.0], size=shape)

    def _huge_and_tiny(self, generator: np.random.Generator, shape: tuple[int, int]) -> Array:
        """Each component of its own magnitude, over the whole range that stays finite."""
        powers = generator.integers(-self.exponent, self.exponent + 1, shape)
        return np.ldexp(
            generator.choice([-1.0, 1.0], shape) * generator.uniform(1, 2, shape), powers
        )


def move_to_cancellation(evaluate: Evaluate, batch: Batch, seed: int) -> Batch:
    """Move one state component of each member so that one output nearly cancels.

    Args:
        evaluate: The function, e.g. its NumPy kernel.
        batch: Where to start, with parameters for each member.
        seed: Chooses the outputs and components.
    """
    generator = np.random.default_rng([SEED, seed, 7])
    members = np.arange(batch.size)
    outputs = evaluate(batch).reshape(-1, members.size).shape[0]
    row = generator.integers(outputs, size=members.size)
    column = generator.integers(batch.state.shape[0], size=members.size)

    def move(component: Array) -> Batch:
        state = batch.state.copy()
        state[column, members] = component
        return Batch({**batch.arrays, "state": state})

    def output(component: Array) -> Array:
        values = evaluate(move(component)).reshape(-1, members.size)
        return np.asarray(values[row, members])

    start = batch.state[column, members]
    with np.errstate(all="ignore"):
        root = _secant(output, start, start * 1.001 + 1e-3)
        usable = np.isfinite(root) & (np.abs(root) < 1e3 * (1 + np.abs(start)))
    return move(np.where(usable, root, start))


def _secant(f: Callable[[Array], Array], x0: Array, x1: Array, steps: int = 4) -> Array:
    """A few secant steps towards a zero; a step that is not finite is not taken."""
    f0, f1 = f(x0), f(x1)
    for _ in range(steps):
        step = f1 * (x1 - x0) / (f1 - f0)
        x0, f0, x1 = x1, f1, x1 - np.where(np.isfinite(step), step, 0.0)
        f1 = f(x1)
    return x1


@dataclass(frozen=True, slots=True)
class _Degree:
    """How many inputs an intermediate result may multiply or divide; an arithmetic for `run`."""

    degree: int

    def __add__(self, other: _Degree) -> _Degree:
        return _Degree(max(self.degree, other.degree))

    def __mul__(self, other: _Degree) -> _Degree:
        return _Degree(self.degree + other.degree)

    __truediv__ = __mul__

    def __neg__(self) -> _Degree:
        return self


def safe_exponent(programs: Mapping[str, Program], elementary: bool) -> int:
    """The binary exponent e such that inputs in ``2^-e .. 2^e`` keep every result in range.

    Args:
        programs: All functions of a system.
        elementary: Whether they call functions beyond sqrt, which leave any range quickly.
    """
    largest = max(
        (degree for program in programs.values() for degree in _degrees(program)), default=1
    )
    return 5 if elementary else 900 // max(largest, 1)


def _degrees(program: Program) -> Iterator[int]:
    """Degrees of the outputs; what an output is made of has no larger one."""
    inputs = {name: _Degree(1) for name in program.names}
    outputs = run(program, inputs, _constant, lambda _, *of: max(of, key=lambda u: u.degree))
    return (output.degree for output in outputs)


def _constant(value: Fraction) -> _Degree:
    return _Degree(0)
