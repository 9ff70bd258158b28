"""Tests of discrete gradients: a motion written by hand, by NumPy alone and as `simulate` has it.

``H = sqrt(1 + x^2) + y^2/2 + y^4/4 + z^2 (1 + y^2)/2``; J is that of the cross product with
``(1/2, z/2, 1 + x^2/4)``, whose product with its curl does not vanish: Jacobi's identity fails.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from coadjoint.build.compiler import CompilerWarning
from coadjoint.declared import KernelContext, Quantity
from coadjoint.render.kernels import render_system
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder
from coadjoint.solve.methods.average_gradient import AverageGradient
from coadjoint.solve.methods.discrete_gradient import DiscreteGradient
from coadjoint.solve.system import System
from tests.programs import program
from tests.solve.methods.algebras import make_lanes, make_memory, make_motion, step

Array = Any
KINDS = ("average", "discrete")


class Swing:
    """The motion ``J(x) dH + f`` with friction; a sign of J can be spoiled."""

    def __init__(self, friction: float = 0.0, sign: float = -1.0) -> None:
        self.friction, self.sign = friction, sign

    def energy(self, lanes: Any, after: Array, x: Array) -> Array:
        """One row."""
        q, p, z = x
        return np.stack([np.sqrt(1 + q**2) + p**2 / 2 + p**4 / 4 + z**2 * (1 + p**2) / 2])

    def gradient(self, lanes: Any, after: Array, x: Array) -> Array:
        """Its derivative."""
        q, p, z = x
        return np.stack([q / np.sqrt(1 + q**2), p + p**3 + z**2 * p, z * (1 + p**2)])

    def bracket(self, lanes: Any, after: Array, x: Array, v: Array) -> Array:
        """The cross product with a vector."""
        a, b, c = np.full(x.shape[1], 0.5), x[2] / 2, 1 + x[0] ** 2 / 4
        return np.stack([b * v[2] - c * v[1], c * v[0] - a * v[2], a * v[1] + self.sign * b * v[0]])

    def force(self, x: Array) -> Array:
        """Friction along the second component."""
        return -self.friction * np.stack([0 * x[0], x[1], 0 * x[2]])

    def rates(self, lanes: Any, after: Array, x: Array) -> Array:
        """The motion."""
        turn = self.bracket(lanes, after, x, self.gradient(lanes, after, x))
        return turn + self.force(x)


def make_method(kind: str, swing: Any, order: int = 2) -> AverageGradient:
    """A method for a motion."""
    given = {"rates": swing.rates, "gradient": swing.gradient, "bracket": swing.bracket}
    if kind == "discrete":
        return DiscreteGradient(energy=swing.energy, **given, size=0.1, order=order)
    return AverageGradient(**given, size=0.1, order=order)


def make_states() -> Array:
    """Swings of several sizes."""
    return np.array([[0.5, 1.5, 2.0, 0.1], [0.3, -0.5, 0.1, 0.2], [0.4, -0.2, 0.7, 0.0]])


def find_change(method: AverageGradient, swing: Swing, count: int = 500) -> float:
    """How far the energy goes, relative, in so many steps."""
    x = make_states()
    memory, h = make_memory(method, x), np.full(x.shape[1], 0.05)
    first, most = swing.energy(None, h, x)[0], 0.0
    for _ in range(count):
        x, memory, solved, _ = method.advance(make_lanes(x), h, x, memory)
        assert solved.all()
        most = max(most, float(abs(swing.energy(None, h, x)[0] / first - 1).max()))
    return most


@pytest.mark.parametrize("order", [2, 4])
def test_the_energy_is_kept(order: int) -> None:
    """Of a bracket that fails Jacobi's identity too, and of an energy that is no polynomial."""
    swing = Swing()
    assert find_change(make_method("discrete", swing, order), swing) < 1e-14


def test_the_mean_of_the_gradient_keeps_what_is_nearly_a_polynomial() -> None:
    """The root is one of degree 10 up to an error that does not grow."""
    swing = Swing()
    found = find_change(make_method("average", swing), swing, 250)
    assert find_change(make_method("average", swing), swing, 1000) < 3 * max(found, 1e-14) < 1e-10


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


def test_without_the_correction_long_steps_lose_the_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the mean misses is what the correction along the chord adds."""
    swing, x = Swing(), 2.0 * make_states()
    h = np.full(x.shape[1], 0.25)

    def miss(kind: str) -> float:
        method = make_method(kind, swing)
        y, _, solved, _ = method.advance(make_lanes(x), h, x, make_memory(method, x))
        assert solved.all()
        return float(abs(swing.energy(None, h, y) / swing.energy(None, h, x) - 1).max())

    assert miss("discrete") < 2e-14
    assert miss("average") > 1e-12
    monkeypatch.setattr("coadjoint.solve.methods.discrete_gradient.ROUNDINGS", np.inf)
    assert miss("discrete") > 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_forces_take_their_power_and_no_more(kind: str) -> None:
    """``H(y) - H(x) = h g.f(m)`` with g by twenty nodes, along the one component of the force."""
    swing, h = Swing(friction=0.3), 0.1
    x = make_states()
    y = step(make_method(kind, swing), x, h)
    m, chord = (x + y) / 2, y - x
    before, after = (swing.energy(None, h, each)[0] for each in (x, y))
    nodes, weights = np.polynomial.legendre.leggauss(20)
    g = sum(
        w / 2 * swing.gradient(None, h, x + (1 + c) / 2 * chord)
        for c, w in zip(nodes, weights, strict=True)
    )
    power = h * (g * swing.force(m)).sum(axis=0)
    assert abs(power).min() > 1e-5
    assert abs(after - before - power).max() < 2e-13


@pytest.mark.parametrize(("kind", "order"), [("average", 2), ("discrete", 2), ("discrete", 4)])
def test_order(kind: str, order: int) -> None:
    """On a motion that is not quadratic."""
    swing, ends = Swing(friction=0.1), []
    method = make_method(kind, swing, order)
    for count in (40, 80, 160):
        x = make_states()
        for _ in range(count):
            x = step(method, x, 2.0 / count)
        ends.append(x)
    gaps = [abs(b - a).max() for a, b in pairwise(ends)]
    assert abs(np.log2(gaps[0] / gaps[1]) - order) < 0.15


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
        method = make_method(kind, swing)
        y, _, solved, _ = method.advance(make_lanes(x), np.full(2, 0.5), x, make_memory(method, x))
    assert solved.tolist() == [True, False]
    assert not y[:, 0].any()


# -- as `simulate` has them -----------------------------------------------------------------------

_SLOPES = ("x/sqrt(1 + x*x)", "y + y*y*y + z*z*y", "z*(1 + y*y)")
_CROSS = "{b}*({w}) - {c}*({v}); {c}*({u}) - 0.5*({w}); 0.5*({v}) - {b}*({u})"
_AXES = {"b": "z/2", "c": "(1 + x*x/4)"}
METHODS = ("discrete_gradient", "discrete_gradient4", "average_gradient")


def make_context() -> KernelContext:
    """The swing without friction."""
    energy = "sqrt(1 + x*x) + y*y/2 + y*y*y*y/4 + z*z*(1 + y*y)/2"
    rates = _CROSS.format(**_AXES, **dict(zip("uvw", _SLOPES, strict=True)))
    parts = [("rhs", rates, (3,)), ("energy", energy, ()), ("observables", energy, (1,)),
             ("energy_gradient", "; ".join(_SLOPES), (3,))]  # fmt: skip
    turned = _CROSS.format(**_AXES, u="_h1", v="_h2", w="_h3")
    programs = [program(name, "x y z", "", "", text, shape) for name, text, shape in parts]
    programs.append(program("bracket_vector", "x y z _h1 _h2 _h3", "", "", turned, (3,)))
    return KernelContext(
        name="swing",
        spec="derivations/swing.toml",
        license="",
        routes=("Typed by hand.",),
        equations=("dx/dt = z/2 z (1 + y^2) - ...",),
        state=tuple(Quantity(each, (), "1", (each,)) for each in "xyz"),
        parameters=(),
        observables=(Quantity("energy", (), "1", ("energy",), conserved=True),),
        programs=tuple(programs),
    )


def write(place: Path, spoil: tuple[str, str] | None = None) -> System:
    """The System in a folder, with something else in its solver in C."""
    place.mkdir()
    for file, text in render_system(make_context()).items():
        if spoil and file == "solver.c":
            assert spoil[0] in text, spoil[0]
            text = text.replace(*spoil)
        (place / file).write_text(text)
    return load_folder(place)


def draw_states(count: int = 21) -> Array:
    """States of several sizes, one of them at rest."""
    states = np.random.default_rng(2).normal(size=(3, count)) * np.linspace(0.1, 0.8, count)
    states[:, 4] = 0.0
    return states


@pytest.mark.parametrize("method", METHODS)
def test_c_has_the_bits_of_numpy(method: str, tmp_path: Path) -> None:
    """States at ends of steps and, by the cubic, between them; and the energy is kept."""
    system = write(tmp_path / "swing")
    given = {"method": method, "step": 0.1, "samples": 33}
    one = system.simulate(draw_states(), (0, 10), target="c", **given)
    other = system.simulate(draw_states(), (0, 10), target="numpy", **given)
    assert (one.status == "OK").all()
    assert one.state.tobytes() == other.state.tobytes()
    assert abs(one.state[:, 5:, -1] - one.state[:, 5:, 0]).min() > 0
    energies = system.energy(one.state[..., -1])
    most = 1e-6 if method == "average_gradient" else 1e-14
    assert abs(energies / system.energy(draw_states()) - 1).max() < most


@pytest.mark.parametrize(
    ("method", "found", "put"),
    [
        ("average_gradient", "nodes[k][1] * (near[r]", "nodes[k][0] * (near[r]"),
        ("average_gradient", "0.5 * rise[i]", "0.25 * rise[i]"),
        ("average_gradient", "- 2.0 * slope[r]", "- 1.0 * slope[r]"),
        ("discrete_gradient", "(last - first) - along", "(last - first) + along"),
        ("discrete_gradient4", "arc->low[i] + 0.5", "0.0 * arc->low[i] + 0.5"),
    ],
)
def test_spoiled_text_is_caught(
    method: str, found: str, put: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another node, sum or factor in the template has other bits than NumPy."""
    monkeypatch.setattr(kernels, "_said", set())
    system = write(tmp_path / "swing", (found, put))
    with pytest.warns(CompilerWarning, match=f"{method} of swing.*differs from its NumPy twin"):
        system.simulate(draw_states(), (0, 10), target="c", method=method, step=0.2, samples=9)


def test_a_spoiled_correction_is_caught(tmp_path: Path) -> None:
    """It matters in long steps alone, longer than those that are tried when an object is loaded."""
    wrong = ("factor * chord[i]", "0.5 * factor * chord[i]")
    given = {"method": "discrete_gradient", "step": 0.2, "samples": 9}
    states = 1.5 * draw_states()
    for name, spoil, same in (("right", None, True), ("wrong", wrong, False)):
        system = write(tmp_path / name, spoil)
        one, other = (system.simulate(states, (0, 4), target=t, **given) for t in ("c", "numpy"))
        assert (one.state.tobytes() == other.state.tobytes()) is same, name
