"""Maps of a step from the Programs of their flows, in 40 digits, and what is measured of them.

The motion that they are compared with is that of the equations typed by hand from books, integrated
by Taylor's series of mpmath.
"""

from __future__ import annotations

from functools import cache

import mpmath

from coadjoint.derive.splittings import Splitting, find_splitting
from coadjoint.lower.compositions import schedule
from coadjoint.lower.evaluation import run
from coadjoint.lower.flows import lower_flows
from coadjoint.lower.kahan import lower_kahan
from tests import specs
from tests.sources import textbook

mp = mpmath.mp.clone()
mp.dps = 40


@cache
def splitting(name: str) -> Splitting:
    """The splitting of a shipped system."""
    found = find_splitting(specs.emitted(name))
    assert isinstance(found, Splitting), found
    return found


@cache
def flows(name: str):
    """Its flows."""
    return lower_flows(splitting(name))


@cache
def kahan(name: str):
    """The step of Kahan's method."""
    found = lower_kahan(specs.emitted(name))
    assert not isinstance(found, str), found
    return found


def number(value):
    """A fraction with 40 digits."""
    return mp.mpf(value.numerator) / value.denominator


def call(name, *given):
    """An elementary function."""
    return getattr(mp, name)(*given)


def apply(program, state, parameters, h):
    """A map of one Program."""
    values = dict(zip(program.names, [*state, h, *parameters], strict=True))
    rises = run(program, values, number, call)
    return [a + rise for a, rise in zip(state, rises, strict=True)]


def split_step(name, order, state, parameters, h):
    """A step of a composition of the flows."""
    for part, time in schedule(len(flows(name)), order):
        state = apply(flows(name)[part], state, parameters, h * mp.mpf(time))
    return state


def kahan_step(name, state, parameters, h):
    """A step of Kahan's method."""
    return apply(kahan(name), state, parameters, h)


def follow(step, name, state, parameters, h, steps):
    """Several steps."""
    for _ in range(steps):
        state = step(name, state, parameters, h)
    return state


def exact_motion(name, state, parameters, time):
    """The motion of the textbook."""
    return _follow_exactly(name, tuple(state), tuple(parameters), time)


@cache
def _follow_exactly(name, state, parameters, time):
    """Several methods begin at one point."""
    rates = textbook.RATES[name]
    motion = mp.odefun(lambda t, x: rates(list(x), parameters), 0, list(state), tol=1e-30)
    return list(motion(time))


def measure_order(step, name, state, parameters, steps, time=1):
    """The order that errors at two lengths of steps show."""
    end = exact_motion(name, state, parameters, mp.mpf(time))
    errors = []
    for count in (steps, 2 * steps):
        came = follow(step, name, state, parameters, mp.mpf(time) / count, count)
        errors.append(max(abs(a - b) for a, b in zip(came, end, strict=True)))
    return float(mp.log(errors[0] / errors[1], 2))


def find_slopes(move, state):
    """The matrix of derivatives of a map, by differences of 40 digits: to 1e-26."""
    small, columns = mp.mpf(10) ** -13, []
    for n in range(len(state)):
        ends = [
            move([each + sign * small * (k == n) for k, each in enumerate(state)])
            for sign in (1, -1)
        ]
        columns.append([(a - b) / (2 * small) for a, b in zip(*ends, strict=True)])
    return mp.matrix(columns).T


def find_defect(name, move, state, parameters):
    """The largest entry of ``D L(x) D^T - L(phi(x))``, with the tensor of the equations."""
    equations = splitting(name).equations
    field, names = equations.setting.field, equations.setting.state

    def tensor(at):
        values = dict(zip((*names, *equations.setting.parameters), [*at, *parameters], strict=True))
        rows = equations.exact.poisson_tensor
        return mp.matrix(
            [
                [field.evaluate(equations.close(e), values, number, call) for e in row]
                for row in rows
            ]
        )

    slopes = find_slopes(move, state)
    gap = slopes * tensor(state) * slopes.T - tensor(move(state))
    return float(max(abs(each) for each in gap))


def take(name, state):
    """A state with the default parameters, in 40 digits."""
    given = [v for p in specs.shipped(name).parameters for v in p.default or ()]
    return [mp.mpf(each) for each in state], list(map(number, given))
