"""Exact solutions of fields and what tests of fields share.

Formulas are typed here from the literature; nothing of the engine's output stands in them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy
from scipy.linalg import solve_circulant
from scipy.special import ellipj, ellipk

from coadjoint.derive import Equations, derive
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.grid import Grid, make_grid
from coadjoint.families import Family
from coadjoint.spec import read_spec_text
from coadjoint.systems import (
    camassa_holm,
    hunter_saxton,
    kdv,
    landau_lifshitz,
    spin_chain_chiral,
)
from tests.specs import emitted, shipped


@cache
def grid_of(name: str) -> Grid:
    """The grid of a shipped system."""
    return make_grid(emitted(name))


@cache
def fields_by_order(name: str, order: int) -> Equations:
    """The Equations of a shipped system, for differences of an order."""
    text = shipped(name).path.read_text(encoding="utf-8")
    old = f"order = {shipped(name).space.order}"
    assert text.count(old) == 1, name
    return derive(read_spec_text(text.replace(old, f"order = {order}"), f"{name}.toml"))


def family_by_order(name: str, order: int) -> Family:
    """The generic point of a shipped system with differences of an order."""
    return GenericPoint(fields_by_order(name, order)).family


def compile_rates(family: Family):
    """The rates of the generic point as a function of arrays of points."""
    given = [*family.states, *family.neighbours.values(), *family.shared, *family.count]
    return sympy.lambdify(given, list(family.rates), "numpy")


def find_rates(family: Family, fields, parameters) -> np.ndarray:
    """Rates at all points of a ring, ``(fields, N)``."""
    count = np.shape(fields)[1]
    known = dict(zip(family.states, np.asarray(fields, dtype=float), strict=True))
    given = [*known.values()]
    values = {**dict(zip(family.shared, parameters, strict=True)), family.count[0]: count}
    for each in family.solved:
        row = np.zeros(count)
        for r, a in enumerate(each.factors):
            row[r] = row[-r] = a.xreplace(values)
        right = known[each.of]
        if each.level:  # the whole matrix, and the mean added to it
            row = 2 * row - np.roll(row, 1) - np.roll(row, -1) + 1 / count
            right = right - np.mean(right)
        known[each.symbol] = solve_circulant(row, right)
    near = [np.roll(known[c], -shift) for c, shift in family.neighbours]
    rates = compile_rates(family)(*given, *near, *parameters, float(count))
    return np.array([np.broadcast_to(rate, (count,)) for rate in rates])


def precessing_wave(s, t, length=10.0, speed=0.5):
    """Omega = F(s - c t), Xi = C - c F, with dF/ds = C x F/(c^2 - 1): fields and their rates.

    The chiral model, dOmega/dt = dXi/ds, dXi/dt = dOmega/ds + Xi x Omega; by substitution.
    """
    rate = 2 * np.pi / length  # F turns once around the circle
    axis = np.array([2.0, -1.0, 2.0]) / 3
    C = axis * rate * abs(speed**2 - 1)
    start = np.array([0.7, 0.1, 0.4])
    along, across = axis * (axis @ start), start - axis * (axis @ start)
    angle = rate * np.sign(speed**2 - 1) * (s - speed * t)
    turned = np.outer(across, np.cos(angle)) + np.outer(np.cross(axis, across), np.sin(angle))
    F = along[:, None] + turned
    dF = np.cross(C, F.T).T / (speed**2 - 1)
    return np.vstack([F, C[:, None] - speed * F]), np.vstack([-speed * dF, speed**2 * dF])


def helix(s, t, length=20.0, a=0.6, B=0.3, turns=2):
    """A helix of 40 degrees about the third axis, which turns at (k^2 + a) cos(theta) + B.

    dS/dt = S x dh/dS with h = S_s.S_s/2 - a S3^2/2 - B S3 (Lakshmanan 2011, time reversed).
    """
    k, theta = 2 * np.pi * turns / length, np.deg2rad(40)
    rate = (k**2 + a) * np.cos(theta) + B
    angle = k * s + rate * t
    S = np.array([np.cos(angle), np.sin(angle), 0 * s]) * np.sin(theta)
    S[2] = np.cos(theta)
    return S, rate * np.array([-S[1], S[0], 0 * s])


def cnoidal_wave(s, t, length=12.0, c=1.3, m=0.5, level=0.2):
    """U = u2 + 4 c b^2 m cn^2(b (s - V t) | m) of u_t + 3 u u_s + c u_sss = 0, and u_t.

    b = 2 K(m)/L and V = 3 u2 + 4 c b^2 (2 m - 1).
    """
    b = 2 * ellipk(m) / length
    speed = 3 * level + 4 * c * b**2 * (2 * m - 1)
    sn, cn, dn, _ = ellipj(b * (s - speed * t), m)
    slope = -8 * c * b**3 * m * cn * sn * dn
    return (level + 4 * c * b**2 * m * cn**2)[None], (-speed * slope)[None]


def smooth_wave(s, t, alpha=0.9, speed=2.0, low=0.7, high=0.95):
    """A wave f(s - c t) of Camassa and Holm's equation: its m, and dm/dt; see `smooth_length`.

    (c - f)^2 (f - alpha^2 f'') = K once integrated, and (alpha f')^2 = (f - a) (b - f) (f - d)/(c -
    f) twice, with d = c - a - b: f = (a + b)/2 - (b - a)/2 cos(theta) turns that into ds/dtheta =
    alpha sqrt((c - f)/(f - d)), a smooth function of theta (derived here).
    """
    modes, rest = smooth_modes(alpha, speed, low, high), speed - low - high
    mean, modes, numbers = modes[0].real, modes[1:], np.arange(1, len(modes))
    goal = np.mod(s - speed * t, 2 * np.pi * mean)
    angle = goal / mean
    for _ in range(30):  # Newton's iteration for s(theta) = goal
        waves = np.exp(1j * np.outer(angle, numbers))
        place = mean * angle + 2 * ((waves - 1) @ (modes / (1j * numbers))).real
        angle = angle - (place - goal) / (mean + 2 * (waves @ modes).real)
    u = (low + high - (high - low) * np.cos(angle)) / 2
    slope = np.sin(angle) * (high - low) / 2 / (alpha * np.sqrt((speed - u) / (u - rest)))
    K = (high**2 - low**2) / 2 / (1 / (speed - high) - 1 / (speed - low))
    return (K / (speed - u) ** 2)[None], (-2 * speed * K * slope / (speed - u) ** 3)[None]


def smooth_modes(alpha=0.9, speed=2.0, low=0.7, high=0.95):
    """Fourier coefficients of ds/dtheta of this wave."""
    u = (low + high - (high - low) * np.cos(2 * np.pi * np.arange(128) / 128)) / 2
    return (np.fft.rfft(alpha * np.sqrt((speed - u) / (u + low + high - speed))) / 128)[:40]


def smooth_length():
    """How long the wave is at the defaults of its numbers."""
    return 2 * np.pi * smooth_modes()[0].real


def breaking_wave(s, t, length=7.0):
    """Hunter and Saxton's equation from A (sin ks + e cos 2ks), with u of mean 0: m, and dm/dt.

    Particles have ds/dx = (cos bt + w sin bt)^2 with w = u0'/(2b) and 4 b^2 the mean of u0'^2
    (Lenells 2007, J. Geom. Phys. 57, 2049), where u(0) = 0; m (ds/dx)^2 is that of the beginning.
    The frame with the mean 0 has moved on by what was the mean of u.
    """
    k, A, e = 2 * np.pi / length, 0.4, 0.1
    b = A * k * np.sqrt((1 + 4 * e**2) / 8)

    def waves(x):
        """u0', its derivative and integral from 0, and the integral of its square."""
        one, two = k * x, 2 * k * x
        slope = A * k * (np.cos(one) - 2 * e * np.sin(two))
        second = -A * k**2 * (np.sin(one) + 4 * e * np.cos(two))
        u = A * (np.sin(one) + e * (np.cos(two) - 1))
        squares = (one / 2 + np.sin(two) / 4) + 4 * e**2 * (one / 2 - np.sin(2 * two) / 8)
        mixed = (1 - np.cos(3 * one)) / 6 + (1 - np.cos(one)) / 2
        return slope, second, u, A**2 * k * (squares - 4 * e * mixed)

    def place(x, t):
        """Where a particle is, how fast, and d^2s/dx dt."""
        cos, sin, (slope, _, u, square) = np.cos(b * t), np.sin(b * t), waves(x)
        at = cos**2 * x + cos * sin * u / b + sin**2 * square / (4 * b**2)
        speed = -2 * b * cos * sin * x + (cos**2 - sin**2) * u + sin * cos * square / (2 * b)
        w = slope / (2 * b)
        return at, speed, 2 * b * (cos + w * sin) * (w * cos - sin)

    def stretch(x, t):
        return (np.cos(b * t) + waves(x)[0] / (2 * b) * np.sin(b * t)) ** 2

    def mean(t):
        """The mean of u where u(0) = 0, by particles."""
        x = np.arange(64) * length / 64
        return np.mean(place(x, t)[1] * stretch(x, t))

    nodes, weights = np.polynomial.legendre.leggauss(20)
    shift = t / 2 * sum(w * mean(t / 2 * (1 + n)) for n, w in zip(nodes, weights, strict=True))
    x = goal = np.asarray(s, dtype=float) + shift
    for _ in range(40):
        x = x - (place(x, t)[0] - goal) / stretch(x, t)
    slope, second, _, _ = waves(x)
    third = -A * k**3 * (np.cos(k * x) - 8 * e * np.sin(2 * k * x))
    _, speed, mixed = place(x, t)
    J, root = stretch(x, t), np.cos(b * t) + slope / (2 * b) * np.sin(b * t)
    J_x = 2 * root * second / (2 * b) * np.sin(b * t)
    moved = (mean(t) - speed) / J  # dx/dt where s stands still
    m = -second / J**2
    rate = (-third / J**2 + 2 * second * J_x / J**3) * moved + 2 * second * mixed / J**3
    return m[None], rate[None]


#: Systems with their exact waves, lengths and parameters.
WAVES = {
    "chiral": (spin_chain_chiral.system, precessing_wave, 10.0, {"L": 10.0}),
    "magnet": (
        landau_lifshitz.system,
        helix,
        20.0,
        {"L": 20.0, "a": [0, 0, 0.6], "B": [0, 0, 0.3]},
    ),
    "kdv": (kdv.system, cnoidal_wave, 12.0, {"L": 12.0, "c": 1.3}),
    "camassa_holm": (
        camassa_holm.system,
        smooth_wave,
        smooth_length(),
        {"L": smooth_length(), "alpha": 0.9},
    ),
    "hunter_saxton": (hunter_saxton.system, breaking_wave, 7.0, {"L": 7.0}),
}
