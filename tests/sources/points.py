"""Points and disks: motions on configuration spaces typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

import mpmath

from tests.sources.components import Vector, cross, dot, hat, plus, times
from tests.sources.phase_spaces import paired

#: Digits of what is not rational: enough for central differences with steps of 1e-20.
DIGITS = 80


def length(square: Any) -> Any:
    """The root of a square, to 80 digits; of a float as floats have it."""
    if isinstance(square, float):
        return math.sqrt(square)
    square = Fraction(square)
    exact = Fraction(isqrt(square.numerator), isqrt(square.denominator))
    if exact**2 == square:
        return exact
    return Fraction(isqrt(square.numerator * 10 ** (2 * DIGITS) // square.denominator), 10**DIGITS)


class Rounded(Fraction):
    """A fraction whose sums, differences, products and quotients are rounded to `BITS`.

    For what is iterated: exact fractions would have several times as many digits after each step.
    """

    __slots__ = ()


#: Bits of rounded fractions: twice as many as are compared.
BITS = 540


def _round_after(operation: str) -> Any:
    """An operation of fractions, and a rounding."""
    exactly = getattr(Fraction, operation)

    def compute(a: Fraction, b: Any) -> Any:
        exact = exactly(a, b)
        if exact is NotImplemented or exact == 0:
            return exact
        shift = BITS + exact.denominator.bit_length() - exact.numerator.bit_length()
        one = Fraction(2) ** shift
        return Rounded(Fraction(round(exact * one)) / one)

    return compute


for _name in ("add", "sub", "mul", "truediv"):
    for _side in ("", "r"):
        setattr(Rounded, f"__{_side}{_name}__", _round_after(f"__{_side}{_name}__"))


def circular(function: str, angle: Any) -> Any:
    """``sin`` or ``cos`` of an angle, to 80 digits; of a float as floats have it."""
    if isinstance(angle, float):
        return getattr(math, function)(angle)
    with mpmath.workdps(DIGITS):
        value = getattr(mpmath, function)(mpmath.mpf(angle.numerator) / angle.denominator)
        return Fraction(int(mpmath.nint(value * mpmath.mpf(10) ** DIGITS)), 10**DIGITS)


def to_digits(function: str, argument: Any) -> Any:
    """An elementary function of a fraction, to 80 digits."""
    return length(argument) if function == "sqrt" else circular(function, argument)


# -- Kepler and the monopole: Holm (2011), section 3.1.5 and exercise 3.1.39 -----------------------


def kepler_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dv/dt = -mu r/|r|^3``."""
    return monopole_rates(state, [*parameters, 0])


def monopole_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dv/dt = -(lam/r^3) L - (mu/r^3 - lam^2/r^4) r`` (equation 3.1.39)."""
    (mu, lam), r, v = parameters, state[:3], state[3:]
    d = length(dot(r, r))
    pull = times(lam**2 / d**4 - mu / d**3, r)
    return [*v, *plus(pull, times(-lam / d**3, cross(r, v)))]


def kepler_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """E, L = r x v and A = v x L - mu r/|r|; |A|/mu, L^2/mu, L x A/L^2."""
    found = monopole_observables(state, [*parameters, 0])
    L, A = ([found[f"{name}{n}"] for n in (1, 2, 3)] for name in "LA")
    return {name: value for name, value in found.items() if name[0] != "P"} | {
        "e": length(dot(A, A)) / parameters[0],
        "p": dot(L, L) / parameters[0],
        **named("u", times(1 / Fraction(dot(L, L)), cross(L, A))),
    }


def monopole_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """E, L, P = L - lam r/|r| and A = v x P - mu r/|r|."""
    (mu, lam), r, v = parameters, state[:3], state[3:]
    d = length(dot(r, r))
    L = cross(r, v)
    P = plus(L, times(-lam / d, r))
    A = plus(cross(v, P), times(-mu / d, r))
    return {
        "energy": dot(v, v) / 2 - mu / d + lam**2 / (2 * d * d),
        **named("L", L),
        **named("A", A),
        **named("P", P),
    }


def monopole_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{r_i, v_j} = delta_ij`` and ``{v_i, v_j} = lam eps_ijk r_k/|r|^3``."""
    r, lam = state[:3], parameters[1]
    d = length(dot(r, r))
    rows = paired([1, 1, 1])
    for i, row in enumerate(hat(times(-lam / d**3, r))):
        rows[3 + i][3:] = row
    return rows


def named(name: str, values: Vector) -> dict[str, Any]:
    """``L1, L2, L3``."""
    return {f"{name}{n + 1}": value for n, value in enumerate(values)}


# -- three particles: Holm (2011), sections 1.2.1 and 2.1 ------------------------------------------

PAIRS = ((0, 1), (1, 2), (0, 2))


def triples(values: Vector) -> list[Vector]:
    """The rows of a matrix with three columns."""
    return [values[n : n + 3] for n in range(0, len(values), 3)]


def separation(r: Sequence[Vector], i: int, j: int) -> tuple[list[Any], Any]:
    """From particle i to particle j, and how far that is."""
    d = plus(r[j], times(-1, r[i]))
    return d, length(dot(d, d))


def particles_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dv_i/dt = sum over j of G m_j (r_j - r_i)/|r_j - r_i|^3``."""
    (*m, G), r = parameters, triples(state[:9])
    moved = [[0, 0, 0] for _ in m]
    for i, j in PAIRS:
        d, apart = separation(r, i, j)
        moved[i] = plus(moved[i], times(G * m[j] / apart**3, d))
        moved[j] = plus(moved[j], times(-G * m[i] / apart**3, d))
    return [*state[9:], *(a for row in moved for a in row)]


def particles_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, centre of mass, total and angular momentum, and ``K = -sum m r``."""
    (*m, G), r, v = parameters, triples(state[:9]), triples(state[9:])
    energy = sum(mass * dot(u, u) / 2 for mass, u in zip(m, v, strict=True))
    for i, j in PAIRS:
        energy -= G * m[i] * m[j] / separation(r, i, j)[1]
    moment = weighted(m, r)
    turning = weighted(m, [cross(x, u) for x, u in zip(r, v, strict=True)])
    return {
        "energy": energy,
        **named("centre", times(1 / Fraction(sum(m)), moment)),
        **named("P", weighted(m, v)),
        **named("J", turning),
        **named("K", times(-1, moment)),
    }


def weighted(masses: Vector, vectors: Sequence[Vector]) -> list[Any]:
    """The sum of mass times vector."""
    total: list[Any] = [0, 0, 0]
    for mass, vector in zip(masses, vectors, strict=True):
        total = plus(total, times(mass, vector))
    return total


def particles_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{r_i, v_i} = 1/m_i``."""
    return paired([1 / mass for mass in parameters[:3] for _ in range(3)])


# -- rocking disk: Holm (2011), section 12.2.2 -----------------------------------------------------


def disk_inertia(phi: Any, parameters: Vector) -> Any:
    """``I + m (r^2 + l^2 - 2 r l cos phi)``: about the point of contact."""
    m, r, l, inertia, _ = parameters  # noqa: E741
    return inertia + m * (r**2 + l**2 - 2 * r * l * circular("cos", phi))


def disk_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``J phi'' + m r l sin(phi) phi'^2 + m g l sin(phi) = 0``."""
    phi, speed = state
    m, r, l, _, g = parameters  # noqa: E741
    torque = -m * l * circular("sin", phi) * (r * speed**2 + g)
    return [speed, torque / disk_inertia(phi, parameters)]


def disk_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Kinetic energy of rolling, potential energy, and the point of contact."""
    phi, speed = state
    m, r, l, _, g = parameters  # noqa: E741
    kinetic = disk_inertia(phi, parameters) * speed**2 / 2
    return {"energy": kinetic - m * g * l * circular("cos", phi), "contact": r * phi}


def disk_tensor(state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{phi, phi'} = 1/J``."""
    return paired([1 / disk_inertia(state[0], parameters)])
