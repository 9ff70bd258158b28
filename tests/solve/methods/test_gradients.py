"""Tests of discrete gradients, on motions written by hand."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from coadjoint.solve.methods.gradients import AverageGradient, DiscreteGradient
from tests.solve.methods.algebras import make_lanes, make_motion, step

Array = Any
KINDS = ("average", "discrete")


class Swing:
    """A motion ``J(x) dH + f`` with a tensor that depends on the state, and friction.

    ``H = 3 - 2 cos x + y^2/2 + y^4/4 + z^2 (1 + y^2)/2``; J is that of the cross product with
    ``(1/2, z/2, 1 + sin(x)^2/4)``, whose product with its curl does not vanish: Jacobi's identity
    fails.
    """

    def __init__(self, friction: float = 0.0, sign: float = -1.0) -> None:
        self.friction, self.sign = friction, sign

    def energy(self, lanes: Any, after: Array, x: Array) -> Array:
        """One row."""
        q, p, z = x
        return np.stack([3 - 2 * np.cos(q) + p**2 / 2 + p**4 / 4 + z**2 * (1 + p**2) / 2])

    def gradient(self, lanes: Any, after: Array, x: Array) -> Array:
        """Its derivative."""
        q, p, z = x
        return np.stack([2 * np.sin(q), p + p**3 + z**2 * p, z * (1 + p**2)])

    def bracket(self, lanes: Any, after: Array, x: Array, v: Array) -> Array:
        """The cross product with a vector; a sign can be spoiled."""
        a, b, c = np.full(x.shape[1], 0.5), x[2] / 2, 1 + np.sin(x[0]) ** 2 / 4
        return np.stack([b * v[2] - c * v[1], c * v[0] - a * v[2], a * v[1] + self.sign * b * v[0]])

    def force(self, x: Array) -> Array:
        """Friction along the second component."""
        return -self.friction * np.stack([0 * x[0], x[1], 0 * x[2]])

    def rates(self, lanes: Any, after: Array, x: Array) -> Array:
        """The motion."""
        turn = self.bracket(lanes, after, x, self.gradient(lanes, after, x))
        return turn + self.force(x)


def make_method(kind: str, swing: Any) -> AverageGradient:
    """A method for a motion."""
    given = {"rates": swing.rates, "gradient": swing.gradient, "bracket": swing.bracket}
    if kind == "discrete":
        return DiscreteGradient(energy=swing.energy, **given, size=0.1)
    return AverageGradient(**given, size=0.1)


def make_states() -> Array:
    """Swings of several sizes."""
    return np.array([[0.5, 1.5, 2.0, 0.1], [0.3, -0.5, 0.1, 0.2], [0.4, -0.2, 0.7, 0.0]])


def find_change(method: AverageGradient, swing: Swing, count: int = 2000) -> float:
    """How far the energy goes, relative, in so many steps."""
    x = make_states()
    low, h = np.zeros(x.shape), np.full(x.shape[1], 0.05)
    first, most = swing.energy(None, h, x)[0], 0.0
    for _ in range(count):
        x, low, solved, _ = method.advance(make_lanes(x), h, x, low)
        assert solved.all()
        most = max(most, float(abs(swing.energy(None, h, x)[0] / first - 1).max()))
    return most


@pytest.mark.parametrize(("kind", "most"), [("discrete", 2e-14), ("average", 2e-13)])
def test_the_energy_is_kept(kind: str, most: float) -> None:
    """Of a bracket that fails Jacobi's identity too."""
    swing = Swing()
    assert find_change(make_method(kind, swing), swing) < most


@pytest.mark.parametrize("kind", KINDS)
def test_a_wrong_sign_in_the_tensor_loses_the_energy(kind: str) -> None:
    """One entry of the tensor has the other sign, so that it is not antisymmetric."""
    swing = Swing(sign=1.0)
    assert find_change(make_method(kind, swing), swing, 10) > 1e-6


def test_a_wrong_gradient_is_seen() -> None:
    """The mean of a gradient that is not the energy's keeps something else."""
    swing = Swing()
    method = make_method("average", swing)
    method.gradient = lambda lanes, after, x: 1.001 * swing.gradient(lanes, after, x)
    assert find_change(method, swing, 200) > 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_forces_take_their_power_and_no_more(kind: str) -> None:
    """``H(y) - H(x) = h g.f(m)``, with g found from the step itself: ``J(m) g = (y - x)/h - f(m)``.

    Only g along the force is needed, and along it Gonzalez's formula and the mean are written out.
    """
    swing, h = Swing(friction=0.3), 0.1
    x = make_states()
    y = step(make_method(kind, swing), x, h)
    m, chord = (x + y) / 2, y - x
    before, after = (swing.energy(None, h, each)[0] for each in (x, y))
    g = swing.gradient(None, h, m)
    if kind == "discrete":
        missing = after - before - (g * chord).sum(axis=0)
        g = g + missing / (chord * chord).sum(axis=0) * chord
    else:
        nodes, weights = np.polynomial.legendre.leggauss(20)
        g = sum(
            w / 2 * swing.gradient(None, h, x + (1 + c) / 2 * chord)
            for c, w in zip(nodes, weights, strict=True)
        )
    power = h * (g * swing.force(m)).sum(axis=0)
    assert abs(power).min() > 1e-5
    assert abs(after - before - power).max() < 2e-14


@pytest.mark.parametrize("kind", KINDS)
def test_order(kind: str) -> None:
    """Two, on a motion that is not quadratic."""
    swing, ends = Swing(friction=0.1), []
    method = make_method(kind, swing)
    for count in (40, 80, 160):
        x = make_states()
        for _ in range(count):
            x = step(method, x, 2.0 / count)
        ends.append(x)
    gaps = [abs(b - a).max() for a, b in pairwise(ends)]
    assert abs(np.log2(gaps[0] / gaps[1]) - 2) < 0.1


@pytest.mark.parametrize("kind", KINDS)
def test_of_quadratic_energies_it_is_the_midpoint(kind: str) -> None:
    """There the gradient at the middle is a discrete gradient already."""
    motion = make_motion("so(3)", quadratic=True)
    x = np.random.default_rng(3).normal(size=(3, 5))

    class Body:
        """The motion, as methods ask for it."""

        gradient, bracket = staticmethod(motion.slope), staticmethod(motion.bracket)

        @staticmethod
        def rates(lanes: Any, after: Array, y: Array) -> Array:
            """The rates."""
            return motion.rates(y)

        @staticmethod
        def energy(lanes: Any, after: Array, y: Array) -> Array:
            """One row."""
            return motion.energy(y)[np.newaxis]

    y = step(make_method(kind, Body), x, 0.1)
    middle = x
    for _ in range(100):
        middle = x + 0.05 * motion.rates(middle)
    assert abs(y - (2 * middle - x)).max() < 1e-14


@pytest.mark.parametrize("kind", KINDS)
def test_rest_stays_and_too_long_steps_are_told(kind: str) -> None:
    """A state at rest does not move; sweeps that do not converge are no step."""
    swing = Swing()
    x = np.array([[0.0, 9.0], [0.0, 40.0], [0.0, 30.0]])
    with np.errstate(all="ignore"):
        y, _, solved, _ = make_method(kind, swing).advance(
            make_lanes(x), np.full(2, 0.5), x, np.zeros(x.shape)
        )
    assert solved.tolist() == [True, False]
    assert not y[:, 0].any()
