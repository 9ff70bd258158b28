"""Peers of the generated solvers: heyoka and SciPy, with equations of motion written by hand.

The equations are those of the books, in the form that costs least: products of parameters are
folded into numbers, and the matrix of Chaplygin's ball, a diagonal one less a square, is inverted
by the formula of Sherman and Morrison. They run on heyoka's expressions and on NumPy's rows alike.
Read next: `ensembles.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np

#: Components of the state and parameters to their rates.
Equations = Callable[[Sequence[Any], Sequence[float]], list[Any]]
Array = Any


def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The vector product."""
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def rigid_body(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Euler's equations: dPi_1 = (1/I_3 - 1/I_2) Pi_2 Pi_3, and so on."""
    return [(1 / p[i - 1] - 1 / p[i - 2]) * (x[i - 2] * x[i - 1]) for i in range(3)]


def heavy_top(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Parameters I1 I2 I3 m g chi1 chi2 chi3."""
    gamma, weight = x[3:], [p[3] * p[4] * chi for chi in p[5:]]
    torque = cross(gamma, weight)
    omega = [x[i] * (1 / p[i]) for i in range(3)]
    free = rigid_body(x[:3], p[:3])
    return [free[i] + torque[i] for i in range(3)] + cross(gamma, omega)


def kirchhoff(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Parameters I1..I3 M1..M3 D1..D3; here D = 0."""
    assert not any(p[6:])
    pi, momentum = x[:3], x[3:]
    free = rigid_body(pi, p[:3])
    push = rigid_body(momentum, p[3:6])
    omega = [pi[i] * (1 / p[i]) for i in range(3)]
    return [free[i] + push[i] for i in range(3)] + cross(momentum, omega)


def chaplygin_ball(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Parameters I1 I2 I3 m r g chi1 chi2 chi3.

    I dOmega + m s x (dOmega x s) = (I Omega) x Omega - m s x (Omega x ds + Omega x Y + g Gamma)
    with s = r Gamma + chi and Y = Omega x s.
    """
    inertia, m, r, g, chi = p[:3], p[3], p[4], p[5], p[6:]
    omega, gamma = x[:3], x[3:]
    s = [r * gamma[i] + chi[i] for i in range(3)]
    dgamma = cross(gamma, omega)
    speed = cross(omega, s)
    moved = cross(omega, [speed[i] + r * dgamma[i] for i in range(3)])
    arm = cross(s, [moved[i] + g * gamma[i] for i in range(3)])
    gyroscopic = [
        (inertia[i - 2] - inertia[i - 1]) * (omega[i - 2] * omega[i - 1]) for i in range(3)
    ]
    b = [gyroscopic[i] - m * arm[i] for i in range(3)]
    square = m * dot(s, s)
    reciprocals = [1.0 / (inertia[i] + square) for i in range(3)]
    scaled = [s[i] * reciprocals[i] for i in range(3)]
    factor = m * dot(scaled, b) / (1.0 - m * dot(scaled, s))
    return [reciprocals[i] * b[i] + factor * scaled[i] for i in range(3)] + dgamma


def so4_body(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Parameters I1..I3 L1..L3: dM = M x Omega + N x Lambda, dN = N x Omega + M x Lambda."""
    inertia, other, m, n = p[:3], p[3:], x[:3], x[3:]
    free, push = rigid_body(m, inertia), rigid_body(n, other)
    turned = []
    for i in range(3):
        a, b = i - 2, i - 1
        one = (1 / inertia[b] - 1 / other[a]) * (n[a] * m[b])
        turned.append(one + (1 / other[b] - 1 / inertia[a]) * (m[a] * n[b]))
    return [free[i] + push[i] for i in range(3)] + turned


def manakov_body(x: Sequence[Any], p: Sequence[float]) -> list[Any]:
    """Manakov's body: dM_ij = sum_k (1/(a_k + a_j) - 1/(a_i + a_k)) M_ik M_kj."""
    n = len(p)
    pairs = [(i, j) for i in range(n) for j in range(i + 1, n)]
    entry: dict[tuple[int, int], Any] = {}
    for (i, j), value in zip(pairs, x, strict=True):
        entry[i, j], entry[j, i] = (1.0, value), (-1.0, value)

    def term(i: int, j: int, k: int) -> Any:
        factor = 1 / (p[k] + p[j]) - 1 / (p[i] + p[k])
        (one, left), (two, right) = entry[i, k], entry[k, j]
        return (one * two * factor) * (left * right)

    rates = []
    for i, j in pairs:
        total = 0.0
        for k in range(n):
            if k not in (i, j):
                total = total + term(i, j, k)
        rates.append(total)
    return rates


EQUATIONS: dict[str, Equations] = {
    each.__name__: each for each in (rigid_body, heavy_top, kirchhoff, chaplygin_ball, so4_body)
} | dict.fromkeys(("so6_body", "so8_body"), manakov_body)


def has(package: str) -> bool:
    """Whether a peer is installed."""
    return find_spec(package) is not None


class Heyoka:
    """heyoka's Taylor method with a batch of 8 and AVX-512, its fastest mode.

    Args:
        name: Of the system.
        parameters: Their values.
        tolerance: Of both kinds; None for heyoka's own.
        folded: Whether parameters are numbers in its code; else each member has its own.
    """

    BATCH = 8

    def __init__(
        self, name: str, parameters: Sequence[float], tolerance: float | None, folded: bool = True
    ) -> None:
        import heyoka

        options: dict[str, Any] = {} if tolerance is None else {"tol": tolerance}
        variables = heyoka.make_vars(*(f"x{i}" for i in range(len(initial_states(name, 1)))))
        values = [float(each) for each in parameters]
        given = [each if folded or not each else heyoka.par[i] for i, each in enumerate(values)]
        self.integrator = heyoka.taylor_adaptive_batch(
            list(zip(variables, EQUATIONS[name](variables, given), strict=True)),
            np.zeros((len(variables), self.BATCH)),
            force_avx512=True,
            **options,
        )
        self.single: Any = None
        count = len(self.integrator.pars)
        self.integrator.pars[:] = np.array(values[:count])[:, None]

    def propagate(self, states: Array, end: float) -> Array:
        """Final states, one batch after the other."""
        found, integrator = np.empty_like(states), self.integrator
        ends = np.full(self.BATCH, end)
        for n in range(0, states.shape[1], self.BATCH):
            integrator.state[:] = states[:, n : n + self.BATCH]
            integrator.set_time(0.0)
            integrator.propagate_until(ends)
            found[:, n : n + self.BATCH] = integrator.state
        return found

    def propagate_ensemble(self, states: Array, end: float) -> Array:
        """The same by heyoka's own driver of ensembles, on one thread."""
        import heyoka

        batches = states.shape[1] // self.BATCH

        def generate(integrator: Any, i: int) -> Any:
            integrator.state[:] = states[:, self.BATCH * i : self.BATCH * (i + 1)]
            integrator.set_time(0.0)
            return integrator

        answers = heyoka.ensemble_propagate_until_batch(
            self.integrator, end, batches, generate, max_workers=1
        )
        return np.concatenate([answer[0].state for answer in answers], axis=1)

    def propagate_grid(self, state: Array, grid: Array) -> Array:
        """States of one trajectory at times, by the integrator of one."""
        import heyoka

        if self.single is None:
            equations = self.integrator.sys
            self.single = heyoka.taylor_adaptive(
                equations, state, tol=self.integrator.tol, pars=self.integrator.pars[:, 0]
            )
        self.single.state[:] = state
        self.single.time = grid[0]
        return self.single.propagate_grid(grid)[-1].T


def exact_integrator(name: str, parameters: Sequence[float], state: Array) -> Any:
    """The integrator of one in numbers of 64 bits after the point, to 1e-18."""
    import heyoka

    variables = heyoka.make_vars(*(f"x{i}" for i in range(len(state))))
    real = np.longdouble
    exact = [real(value) for value in parameters]
    return heyoka.taylor_adaptive(
        list(zip(variables, EQUATIONS[name](variables, exact), strict=True)),
        state.astype(real),
        tol=real(1e-18),
        fp_type=real,
    )


def propagate_exactly(name: str, parameters: Sequence[float], states: Array, end: float) -> Array:
    """Final states in extended precision."""
    integrator = exact_integrator(name, parameters, states[:, 0])
    found = np.empty(states.shape, np.longdouble)
    for n in range(states.shape[1]):
        integrator.state[:] = states[:, n]
        integrator.time = np.longdouble(0)
        integrator.propagate_until(np.longdouble(end))
        found[:, n] = integrator.state
    return found


def propagate_exactly_on(
    name: str, parameters: Sequence[float], state: Array, grid: Array
) -> Array:
    """States of one trajectory at times, in extended precision."""
    integrator = exact_integrator(name, parameters, state)
    return integrator.propagate_grid(grid.astype(np.longdouble))[-1].T


def propagate_stacked(
    name: str, parameters: Sequence[float], states: Array, end: float, tolerance: float
) -> Array:
    """Final states by SciPy's DOP853 on the states of all members as one."""
    from scipy.integrate import solve_ivp

    equations, shape = EQUATIONS[name], states.shape

    def rates(_: float, flat: Array) -> Array:
        return np.array(equations(flat.reshape(shape), parameters)).ravel()

    answer = solve_ivp(
        rates, (0.0, end), states.ravel(), method="DOP853", rtol=tolerance, atol=tolerance
    )
    return answer.y[:, -1].reshape(shape)


def propagate_each(
    name: str, parameters: Sequence[float], states: Array, end: float, tolerance: float
) -> Array:
    """Final states by SciPy's DOP853, one member after the other."""
    columns = [
        propagate_stacked(name, parameters, states[:, n : n + 1], end, tolerance)
        for n in range(states.shape[1])
    ]
    return np.concatenate(columns, axis=1)


def initial_states(name: str, members: int) -> Array:
    """States to begin with, the same at every run; advected directions are unit vectors."""
    rows = {"rigid_body": 3, "so6_body": 15, "so8_body": 28}.get(name, 6)
    states = np.random.default_rng(0).uniform(-1.0, 1.0, (rows, members))
    if name in ("heavy_top", "chaplygin_ball"):
        states[3:] /= np.sqrt((states[3:] ** 2).sum(axis=0))
    return states


def seconds_of(function: Callable[[], object]) -> float:
    """Processor seconds of one call."""
    start = process_time()
    function()
    return process_time() - start
