"""Coadjoint motions beyond bodies: equations typed by hand from books, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

from typing import Any

from tests.sources.components import Vector, commutator, cross, dot, over, plus, times, turned

# -- Heisenberg: Holm (2011), sections 4.3.3 and 4.3.4 --------------------------------------------


def heisenberg_ad_star(xi: Vector, mu: Vector) -> list[Any]:
    """``ad*_xi mu = (-xi2 mu3, xi1 mu3, 0)``."""
    return [-xi[1] * mu[2], xi[0] * mu[2], 0]


def heisenberg_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dmu/dt = ad*_xi mu`` with ``xi = (mu1, mu2, 0)``."""
    return heisenberg_ad_star([state[0], state[1], 0], state)


def heisenberg_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy of the oscillator and its frequency."""
    return {"energy": (state[0] ** 2 + state[1] ** 2) / 2, "casimir1": state[2]}


# -- pendulum on se(2)*: Holm (2011), section 6.4 --------------------------------------------------


def se2_tensor(state: Vector) -> list[list[Any]]:
    """``{m, b1} = -b2``, ``{m, b2} = b1``, ``{b1, b2} = 0``."""
    _, b1, b2 = state
    return [[0, -b2, b1], [b2, 0, 0], [-b1, 0, 0]]


def se2_pendulum_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``ad*_(xi, alpha) (m, b) = (-b . JJ alpha, -xi JJ b)``, JJ a quarter turn, alpha = (1, 0)."""
    m, b1, b2 = state
    return [-b2, m * b2, -m * b1]


def se2_pendulum_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic and potential energy, square of the length of b."""
    m, b1, b2 = state
    return {"energy": m**2 / 2 + b1, "casimir1": b1**2 + b2**2}


# -- SL(2,R) (s) R^2: Holm (2011), section 6.5 -----------------------------------------------------


def sl2_r2_ad_star(velocity: Vector, state: Vector) -> list[Any]:
    """``ad*_(a, u) (mu, beta) = ([a^T, mu] - (beta u^T) without its trace, a^T beta)``.

    The pairing is ``tr(mu^T a) + beta . u``, so h is the sum of the diagonal of mu with signs.
    """
    (a1, a2, a3, *u), (h, x, y, *beta) = velocity, state
    a_turned = turned([[a1, a2], [a3, -a1]])
    (m11, m12), (m21, m22) = commutator(a_turned, [[h / 2, x], [y, -h / 2]])
    # subtracting the multiple of the unit matrix leaves the difference of the diagonal as it is
    h_rate = (m11 - beta[0] * u[0]) - (m22 - beta[1] * u[1])
    force = [row[0] * beta[0] + row[1] * beta[1] for row in a_turned]
    return [h_rate, m12 - beta[0] * u[1], m21 - beta[1] * u[0], *force]


def sl2_r2_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Coadjoint motion with the velocities ``dh/dmu``."""
    (h, x, y, *p), (i1, i2, i3, m) = state, parameters
    squeeze, turn = (x + y) / i2, (x - y) / i3
    return sl2_r2_ad_star([h / i1, squeeze + turn, squeeze - turn, *(q / m for q in p)], state)


def sl2_r2_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, the cubic Casimir ``p . eps mu p`` with eps the quarter turn, and velocities."""
    (h, x, y, p1, p2), (i1, i2, i3, m) = state, parameters
    return {
        "energy": (h**2 / i1 + (x + y) ** 2 / i2 + (x - y) ** 2 / i3 + (p1**2 + p2**2) / m) / 2,
        "casimir1": p2 * (h * p1 + x * p2) - p1 * (y * p1),
        "a": h / i1,
        "b": (x + y) / i2 + (x - y) / i3,
        "c": (x + y) / i2 - (x - y) / i3,
        "v1": p1 / m,
        "v2": p2 / m,
    }


# -- Galilei and Bargmann: Holm (2011), sections 1.7 and 6.6 ---------------------------------------


def galilei_ad_star(velocity: Vector, state: Vector) -> list[Any]:
    """From the commutator of ``[[hat xi, nu, alpha], [0, 0, sigma], [0, 0, 0]]``, derived here.

    ``[a, a'] = (xi x xi', xi x nu' - xi' x nu, xi x alpha' - xi' x alpha + sigma' nu - sigma nu',
    0)``; paired with (J, K, P, E) and sorted by a', by ``a . b x c = c . a x b``.
    """
    xi, nu, alpha, sigma = velocity[:3], velocity[3:6], velocity[6:9], velocity[9]
    J, K, P = state[:3], state[3:6], state[6:9]
    return [
        *plus(plus(cross(J, xi), cross(K, nu)), cross(P, alpha)),
        *plus(cross(K, xi), times(-sigma, P)),
        *cross(P, xi),
        dot(P, nu),
    ]


def bargmann_ad_star(velocity: Vector, state: Vector) -> list[Any]:
    """The same with the mass M, where ``[a, a']`` has the part ``nu . alpha' - nu' . alpha``."""
    nu, alpha, M = velocity[3:6], velocity[6:9], state[10]
    J, K, P, E = (lambda f: (f[:3], f[3:6], f[6:9], f[9:]))(galilei_ad_star(velocity, state))
    return [*J, *plus(K, times(-M, alpha)), *plus(P, times(M, nu)), *E, 0]


def galilei_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Left-invariant geodesics with a diagonal inertia."""
    return galilei_ad_star(over(state, parameters), state)


def bargmann_rates(state: Vector, parameters: Vector) -> list[Any]:
    """The energy does not depend on the mass."""
    return bargmann_ad_star([*over(state[:10], parameters), 0], state)


def galilei_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, the Casimirs ``P . P`` and ``|K x P|^2``, and velocities."""
    moment, velocity = cross(state[3:6], state[6:9]), over(state, parameters)
    names = [f"{name}{n}" for name in ("Omega", "a", "v") for n in (1, 2, 3)]
    return {
        "energy": sum(p * v for p, v in zip(state, velocity, strict=True)) / 2,
        "casimir1": dot(state[6:9], state[6:9]),
        "casimir2": dot(moment, moment),
        **dict(zip((*names, "tau"), velocity, strict=True)),
    }


def bargmann_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, mass, inner energy and square of the spin, the last two times M or M^2."""
    K, P, E, M = state[3:6], state[6:9], state[9], state[10]
    spin = plus(times(M, state[:3]), cross(P, K))
    return {
        "energy": galilei_observables(state[:10], parameters)["energy"],
        "casimir1": M,
        "casimir2": dot(P, P) - 2 * M * E,
        "casimir3": dot(spin, spin),
    }


# -- aff(1): Holm (2011), section 9.1 --------------------------------------------------------------


def affine_line_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``ad*_xi mu = (-xi2 mu2, xi1 mu2)`` for ``[e1, e2] = e2``, with xi = mu."""
    return [-(state[1] ** 2), state[0] * state[1]]


def affine_line_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy and velocities, which are the momenta."""
    mu1, mu2 = state
    return {"energy": (mu1**2 + mu2**2) / 2, "xi1": mu1, "xi2": mu2}


# -- momentum map to sp(2)*: Holm (2011), appendix C.4 ---------------------------------------------


def sp2_tensor(state: Vector) -> list[list[Any]]:
    """``{X1, X2} = 4 X3``, ``{X2, X3} = -2 X2``, ``{X3, X1} = -2 X1``."""
    x1, x2, x3 = state
    return [[0, 4 * x3, 2 * x1], [-4 * x3, 0, -2 * x2], [-2 * x1, 2 * x2, 0]]


def sp2_momentum_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Rates of q.q, p.p, q.p by Newton: ``dq/dt = p/m``, ``dp/dt = -(k + b q.q) q``."""
    (x1, x2, x3), (m, k, b) = state, parameters
    spring = k + b * x1
    return [2 * x3 / m, -2 * spring * x3, x2 / m - spring * x1]


def sp2_momentum_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy of the particle, and ``|q x p|^2``."""
    (x1, x2, x3), (m, k, b) = state, parameters
    return {"energy": x2 / m / 2 + k * x1 / 2 + b * x1**2 / 4, "casimir1": x1 * x2 - x3**2}
