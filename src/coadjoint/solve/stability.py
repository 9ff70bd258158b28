r"""Stability: the longest step with which an explicit method does not make waves of fields grow.

Short waves about any fields have imaginary rates: those of the principal symbol
:math:`A = \partial \dot u/\partial(\partial_s^n u)`, of which the eigenvalue c, times what the
difference of it multiplies a wave by, :math:`\sigma (N/L)^n` at the most. A method
with the stability polynomial R leaves a wave bounded if :math:`|R(i y)| \le 1` for its step times
its rate y. With this interval, [0, Y],

.. math:: h \le \frac{Y}{c\, \sigma} \Big(\frac{L}{N}\Big)^n .

c changes along the motion, where A depends on fields. Methods of Taylor whose order is 1 or 2 more
than a multiple of 4 have Y = 0: the first term of :math:`|R|^2 - 1` is positive.
Comes in: a run with steps of one length. Goes out: a warning. Read next:
`coadjoint.solve.simulate`.

Source:
    Hairer and Wanner (1996), Solving Ordinary Differential Equations II, 2nd ed., section IV.2.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from math import factorial
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from coadjoint.errors import StabilityWarning
from coadjoint.lower.tableau import END, STAGES, dop853
from coadjoint.solve.arrays import pack_parameters

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.request import Request
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: Explicit methods of generated solvers.
EXPLICIT: Final = ("taylor", "dop853", "rk4")
#: Samples of a run at which waves are looked at.
SAMPLES: Final = 50
#: The distance of the places at which an interval is looked for, and the last one.
_STEP, _LAST = 1e-2, 50.0


def is_of_waves(system: System) -> bool:
    """Whether a system has fields with a principal symbol."""
    return system.symbol is not None


def watch_waves(system: System, request: Request) -> Callable[[Solution], None]:
    """Warn of steps that are too long for the waves at the beginning; else of a run, afterwards.

    Returns:
        What looks at the Solution.
    """
    watched = is_of_waves(system) and request.step is not None and request.method in EXPLICIT
    if not watched or _warn(system, request, request.state[..., np.newaxis], [request.start]):
        return lambda _: None

    def look(solution: Solution) -> None:
        places = np.unique(np.linspace(0, solution.time.size - 1, SAMPLES).astype(int))
        _warn(system, request, solution.state[..., places], solution.time[places].tolist())

    return look


def _warn(system: System, request: Request, states: Array, times: Sequence[float]) -> bool:
    """Whether a step is too long at one of some times, states ``(n, *batch, T)``; that is said."""
    family = cast("FamilySystem", system)
    assert request.step is not None, request.method
    interval = find_interval(request.method, request.choice.order)
    rates = find_rates(family, states, pack_parameters(system, request.parameters))
    fastest = np.nanmax(rates.reshape(-1, len(times)), axis=0)  # of the batch
    place = int(np.argmax(fastest))
    bound = interval / fastest[place] if fastest[place] else np.inf
    if not request.step > bound:
        return False
    warnings.warn(
        f"the step {request.step:.6g} is longer than {bound:.3g}, up to which {request.method!r} "
        f"does not make the shortest waves of {system.name} grow, with its fields at "
        f"{system.clock[0]} = {times[place]:.6g}; expected a shorter one. Take "
        f"step={0.9 * bound:.2g}, fewer points, or an implicit method.",
        StabilityWarning,
        stacklevel=5,
    )
    return True


def find_rates(system: FamilySystem, states: Array, parameters: Array) -> Array:
    """The rates of the shortest waves at states ``(n, *batch, T)``, ``(*batch, T)``."""
    from coadjoint.solve.spectral import solve_velocities  # which reads specs

    assert system.symbol is not None, system.name
    symbol, shape = system.symbol, (system.size, *states.shape[1:])
    fields = dict(zip(system.own_state, states.reshape(-1, *shape), strict=True))
    rows = parameters.reshape(len(parameters), *parameters.shape[1:], 1)
    known = dict(zip(system.PARAMETERS.components, rows, strict=True))
    spacing = known[symbol.length] / (system.size - (not system.index.periodic))
    velocities = solve_velocities(system, known, fields)  # by Fourier series, which are near enough
    speeds = _find_speeds(system, known | fields | velocities, shape)
    rates: Array = np.max(speeds, axis=0) * symbol.largest / spacing**symbol.order
    return np.broadcast_to(rates, shape[1:])


def _find_speeds(system: FamilySystem, known: dict[str, Array], shape: tuple[int, ...]) -> Array:
    """The largest size of an eigenvalue of the symbol at each point."""
    from coadjoint.solve.formulas import Formula  # it reads specs, which few runs need

    assert system.symbol is not None, system.name
    names, scope = system.own_state, dict.fromkeys(known, ())
    matrix = np.zeros((len(names), len(names), *shape))
    varies = False
    for a, row in system.symbol.matrix.items():
        for b, text in row.items():
            formula = Formula(text, scope, "the principal symbol")
            own = {x: np.broadcast_to(known[x], shape).reshape(-1) for x in formula.names}
            value, _ = formula.evaluate(own)
            matrix[names.index(a), names.index(b)] = np.broadcast_to(
                value, (int(np.prod(shape)),)
            ).reshape(shape)
            varies = varies or bool({*formula.names} - {*system.PARAMETERS.components})
    if not varies:  # one point is like the others
        matrix = matrix[:, :, :1]
    with np.errstate(all="ignore"):
        finite = np.nan_to_num(np.moveaxis(matrix, (0, 1), (-2, -1)))
        return np.asarray(np.abs(np.linalg.eigvals(finite)).max(axis=-1))


@cache
def find_interval(method: str, order: int) -> float:
    """The Y up to which ``|R(i y)| <= 1`` for an explicit method.

    >>> round(find_interval("rk4", 4), 4), round(find_interval("dop853", 8), 4)
    (2.8284, 5.9604)
    >>> [round(find_interval("taylor", order), 4) for order in (3, 4, 12, 16, 14)]
    [1.7321, 2.8284, 3.3794, 3.3248, 0.0]
    """
    factors = [Fraction(1, factorial(k)) for k in range(order + 1)]
    if method == "dop853":
        factors += _multiply_out()[order + 1 :]
    # |R(i y)|^2 - 1 in powers of y^2, exactly: of high orders it is far below rounding
    excess = [Fraction(0)] * len(factors)
    for k, a in enumerate(factors):
        for j, b in enumerate(factors):
            if (k - j) % 2 == 0:
                excess[(k + j) // 2] += a * b * (-1) ** (abs(k - j) // 2)
    excess[0] -= 1
    first = next(n for n, x in enumerate(excess) if x)
    if excess[first] > 0:
        return 0.0
    polynomial = np.polynomial.Polynomial([float(x) for x in excess[first:]])
    places = np.arange(_STEP, _LAST, _STEP)
    low = float(places[int(np.argmax(polynomial(places**2) > 0))]) - _STEP
    high = low + _STEP
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (low, middle) if polynomial(middle**2) > 0 else (middle, high)
    return low


def _multiply_out() -> list[Fraction]:
    """The stability polynomial of the method of order 8 by its table."""
    table, stages = dop853(), list[list[Fraction]]()
    for row in (*range(STAGES), END):
        own = [Fraction(0)] * (STAGES + 1)
        for weight, column in table.row(row):
            for k, x in enumerate(stages[column]):
                own[k] += Fraction(weight) * x
        stages.append([Fraction(1), *own[:STAGES]])
    return stages[-1]
