"""Tests of the methods on coadjoint orbits, on motions written by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.methods import Sphere
from coadjoint.solve.methods.coadjoint_mean import CoadjointMean
from coadjoint.solve.methods.isospectral_midpoint import IsospectralMidpoint
from coadjoint.solve.methods.lie_poisson import LiePoisson
from coadjoint.solve.methods.spherical_midpoint import Scale, SphericalMidpoint
from tests.solve.methods.algebras import (
    ALGEBRAS,
    Motion,
    find_defect,
    make_lanes,
    make_memory,
    make_motion,
    make_sandwich,
    run,
    so,
    step,
)

SPHERES = {
    "so(3)": (Sphere((0, 1, 2)),),
    "so(3) x so(3)": (Sphere((0, 1, 2)), Sphere((3, 4, 5))),
    "se(3)": (Sphere((3, 4, 5), (0, 1, 2)),),
}
MATRICES = ("so(3)", "so(4)", "so(6)", "sl(2)", "so(3) x so(3)")
SMALL = tuple(name for name in ALGEBRAS if name not in ("so(6)", "so(8)"))

Make = Callable[..., LiePoisson]


def make_method(kind: str, name: str, motion: Motion, order: int = 2) -> LiePoisson:
    """A method for a motion on the dual of an algebra."""
    if kind == "spherical":
        return SphericalMidpoint(field=motion.field, size=0.1, spheres=SPHERES[name], order=order)
    given: dict[str, Any] = {
        "gradient": motion.slope,
        "bracket": motion.bracket,
        "size": 0.1,
        "order": order,
    }
    if kind == "isospectral":
        return IsospectralMidpoint(**given, sandwich=make_sandwich(name))
    return CoadjointMean(**given)


def make_start(motion: Motion) -> Any:
    """A state of length 1."""
    x = np.random.default_rng(3).normal(size=len(motion.constants))
    return x / np.linalg.norm(x)


CASES = [
    *(("mean", name) for name in SMALL),
    *(("spherical", name) for name in SPHERES),
    *(("isospectral", name) for name in MATRICES),
]


@pytest.mark.parametrize(("kind", "name"), CASES)
def test_is_a_poisson_map(kind: str, name: str) -> None:
    """Each method carries the bracket along: its derivative D has ``D J D^T = J`` at the end."""
    motion = make_motion(name)
    x, method = make_start(motion), make_method(kind, name, motion)
    assert find_defect(motion, lambda y: step(method, y, 0.2), x) < 1e-11


@pytest.mark.parametrize("name", ["so(3)", "so(4)", "se(3)", "sl(2)", "sim(2)"])
def test_similar_steps_are_no_poisson_maps(name: str) -> None:
    """The implicit midpoint, and exp at a midpoint without the mean, have a defect that is seen."""
    motion = make_motion(name)
    x = make_start(motion)

    def midpoint(y: Any) -> Any:
        middle = y
        for _ in range(60):
            middle = y + np.longdouble(0.1) * motion.rates(middle)
        return 2 * middle - y

    def turn(y: Any, xi: Any, h: float) -> Any:
        total, term = y, y
        for k in range(1, 30):
            term = np.longdouble(h) / k * motion.bracket(None, None, term, xi)  # type: ignore[arg-type]
            total = total + term
        return total

    def naive(y: Any) -> Any:
        xi = motion.gradient(y)
        for _ in range(60):
            xi = motion.gradient(turn(y, xi, 0.1))
        return turn(y, xi, 0.2)

    assert find_defect(motion, midpoint, x) > 1e-6
    assert find_defect(motion, naive, x) > 1e-6


@cache
def follow(name: str, end: float) -> Any:
    """The motion itself, by many steps of the classical method of Runge and Kutta."""
    motion = make_motion(name)
    x = make_start(motion)[:, np.newaxis].astype(np.longdouble)
    count = 800
    h = np.longdouble(end) / count
    for _ in range(count):
        one = motion.rates(x)
        two = motion.rates(x + h / 2 * one)
        three = motion.rates(x + h / 2 * two)
        x = x + h / 6 * (one + 2 * two + 2 * three + motion.rates(x + h * three))
    return x


@pytest.mark.parametrize("order", COMPOSITIONS)
@pytest.mark.parametrize(
    ("kind", "name"),
    [("mean", "so(3)"), ("mean", "se(3)"), ("mean", "sim(2)"), ("spherical", "so(3) x so(3)"),
     ("spherical", "se(3)"), ("isospectral", "so(4)"), ("isospectral", "so(6)")],
)  # fmt: skip
def test_order(kind: str, name: str, order: int) -> None:
    """On nonlinear motions a method has the order it claims, within 0.1."""
    counts, whole = ((4, 8, 16), 0.1) if name == "so(6)" else ((8, 16, 32), 0.8)
    motion = make_motion(name)
    method = make_method(kind, name, motion, order)
    x = make_start(motion)[:, np.newaxis].astype(np.longdouble)
    ends = []
    for count in counts:
        end = x
        for _ in range(count):
            end = step(method, end, whole / count)
        ends.append(end)
    measured = np.log2(float(abs(ends[0] - ends[1]).max() / abs(ends[1] - ends[2]).max()))
    assert measured == pytest.approx(order, abs=0.1)
    exact = follow(name, whole)
    gaps = [float(abs(end - exact).max()) for end in ends]
    assert gaps[2] < 0.3 * gaps[1] < 0.1 * gaps[0] + 1e-12


def test_compositions_satisfy_the_conditions_of_their_order() -> None:
    """Sums of powers: of parts 1, of cubes 0 from order 4 on, of fifth powers 0 at order 6."""
    for order, stages in COMPOSITIONS.items():
        exact = [Fraction(stage) for stage in stages]
        assert list(stages) == list(reversed(stages)), order
        assert abs(float(sum(exact)) - 1) < 1e-15
        for power in range(3, order, 2):
            assert abs(float(sum(stage**power for stage in exact))) < 2e-15, (order, power)
    spoiled = [Fraction(0.39), *map(Fraction, COMPOSITIONS[6][1:])]
    assert abs(float(sum(stage**3 for stage in spoiled))) > 1e-4


@pytest.mark.parametrize("order", COMPOSITIONS)
@pytest.mark.parametrize(("kind", "name"), CASES)
def test_a_step_backwards_undoes_a_step(kind: str, name: str, order: int) -> None:
    """Each method is its own adjoint."""
    motion = make_motion(name)
    method, x = make_method(kind, name, motion, order), make_start(motion)[:, np.newaxis]
    assert abs(step(method, step(method, x, 0.05), -0.05) - x).max() < 1e-14


CASIMIRS: dict[str, list[Callable[[Any], Any]]] = {
    "so(3)": [lambda x: (x * x).sum(axis=0)],
    "so(3) x so(3)": [lambda x: (x[:3] ** 2).sum(axis=0), lambda x: (x[3:] ** 2).sum(axis=0)],
    "se(3)": [lambda x: (x[3:] ** 2).sum(axis=0), lambda x: (x[3:] * x[:3]).sum(axis=0)],
    "se(2)": [lambda x: (x[1:] ** 2).sum(axis=0)],
    "sl(2)": [lambda x: x[0] ** 2 / 4 + x[1] * x[2]],
    "Heisenberg": [lambda x: x[2]],
    "so(3) with two vectors": [
        lambda x: (x[3:6] ** 2).sum(axis=0),
        lambda x: (x[3:6] * x[6:]).sum(axis=0),
    ],
    "so(4)": [
        lambda x: (x * x).sum(axis=0),
        lambda x: x[0] * x[5] - x[1] * x[4] + x[2] * x[3],
    ],
}


@pytest.mark.parametrize(("kind", "name"), [case for case in CASES if case[1] in CASIMIRS])
def test_casimirs_stay(kind: str, name: str) -> None:
    """Casimirs stay to the rounding of many steps, and others do not."""
    motion = make_motion(name)
    method, x = make_method(kind, name, motion), make_start(motion)[:, np.newaxis]
    end = run(method, x, 0.1, 150)
    for casimir in CASIMIRS[name]:
        assert abs(casimir(end) - casimir(x)).max() < 1e-14
        assert abs(casimir(end * (1 + 1e-11)) - casimir(x)).max() > 1e-14


def test_spherical_midpoint_keeps_the_energy_of_a_free_body() -> None:
    """One sphere and a quadratic energy: it stays, as of no other method here."""
    motion = make_motion("so(3)", quadratic=True)
    x = make_start(motion)[:, np.newaxis]
    drift = {}
    for kind in ("spherical", "mean", "isospectral"):
        end = run(make_method(kind, "so(3)", motion), x, 0.1, 300)
        drift[kind] = float(abs(motion.energy(end) - motion.energy(x)).max())
    assert drift["spherical"] < 1e-14
    assert min(drift["mean"], drift["isospectral"]) > 1e-7


def test_the_step_of_dual_numbers_is_a_limit_of_two_spheres() -> None:
    """With e^2 = d^2 the algebra is so(3) twice; the step there tends to that with e^2 = 0."""
    dual = make_motion("se(3)")
    x = make_start(dual)[:, np.newaxis].astype(np.longdouble)
    limit = step(make_method("spherical", "se(3)", dual), x, 0.1)
    gaps = []
    for d in map(np.longdouble, (2.0**-4, 2.0**-5, 2.0**-6)):
        # w = Gamma + d Pi and Gamma - d Pi, in which the bracket is that of so(3) times 2 d, -2 d
        two = make_motion("so(3) x so(3)")
        signs = np.repeat([2 * d, -2 * d], 3)

        def gradient(w: Any, d: Any = d) -> Any:
            whole = np.concatenate([(w[:3] - w[3:]) / (2 * d), (w[:3] + w[3:]) / 2])
            own = dual.gradient(whole)
            return np.concatenate([own[:3] / d + own[3:], own[3:] - own[:3] / d]) / 2

        scaled = replace(two, gradient=gradient, constants=two.constants * signs[:, None, None])
        pi, gamma = x[:3], x[3:]
        start = np.concatenate([gamma + d * pi, gamma - d * pi])
        w = step(make_method("spherical", "so(3) x so(3)", scaled), start, 0.1)
        end = np.concatenate([(w[:3] - w[3:]) / (2 * d), (w[:3] + w[3:]) / 2])
        gaps.append(float(abs(end - limit).max()))
    assert gaps[0] / gaps[1] == pytest.approx(4, abs=0.1)
    assert gaps[1] / gaps[2] == pytest.approx(4, abs=0.1)


def _spectrum(n: int, x: Any) -> Any:
    basis = np.array(ALGEBRAS[f"so({n})"])
    return np.sort(np.linalg.eigvalsh(1j * np.einsum("i,iab->ab", x[:, 0], basis)))


@pytest.mark.parametrize("n", [6, 8])
def test_isospectral_midpoint_keeps_the_spectrum(n: int) -> None:
    """Of matrices with six rows and more, of which the implicit midpoint loses it."""
    name = f"so({n})"
    motion = make_motion(name, quadratic=True)
    motion = replace(motion, gradient=lambda x: x / np.arange(1, 1 + len(x))[:, np.newaxis])
    x = make_start(motion)[:, np.newaxis]
    end = run(make_method("isospectral", name, motion), x, 0.1, 300)
    assert abs(_spectrum(n, end) - _spectrum(n, x)).max() < 1e-14
    assert abs(end - x).max() > 0.01
    y = x
    for _ in range(1000):
        middle = y
        for _ in range(20):
            middle = y + 0.05 * motion.rates(middle)
        y = 2 * middle - y
    assert abs((y * y).sum() - (x * x).sum()) < 1e-13
    assert abs(_spectrum(n, y) - _spectrum(n, x)).max() > 1e-9


@pytest.mark.parametrize("name", SMALL)
def test_long_arcs_are_followed_in_parts(name: str) -> None:
    """A linear energy moves states by one exponential, however long the arc is."""
    motion = make_motion(name)
    rng = np.random.default_rng(5)
    slope = rng.normal(size=len(motion.constants))
    motion = replace(motion, gradient=lambda x: slope[:, np.newaxis] + 0 * x)
    x = make_start(motion)[:, np.newaxis]
    action = np.einsum("ijk,j->ik", -motion.constants, slope)
    for h in (0.1, 3.0, 12.0):
        expected = scipy.linalg.expm(h * action) @ x
        end = step(make_method("mean", name, motion), x, h)
        assert abs(end - expected).max() < 1e-12 * abs(expected).max()


def test_a_step_that_is_not_solved_is_none() -> None:
    """Where sweeps do not settle, no state is given for the end of a step; others go on."""
    motion = make_motion("so(3)")
    x = make_start(motion)[:, np.newaxis] * np.array([1.0, 200.0])
    for kind in ("mean", "spherical", "isospectral"):
        lanes = make_lanes(x)
        with np.errstate(all="ignore"):
            method, size = make_method(kind, "so(3)", motion), np.full(2, 0.1)
            _, _, solved, _ = method.advance(lanes, size, x, make_memory(method, x))
        assert solved.tolist() == [True, False], kind


def test_false_roots_of_a_quotient_are_refused() -> None:
    """Zero and minus the quotient satisfy its equation, and none of them is one."""
    sphere = Sphere((0, 1, 2))
    start = np.array([[0.6], [0.0], [0.8]])
    for scale, good in ((1.0, True), (0.0, False), (-1.0, False)):
        quotient = Scale(start, 0.0 * start, sphere)
        quotient.scale = np.array([scale])
        quotient.apply(start, 0.0 * start, start.copy())
        assert quotient.is_root().tolist() == [good], scale
    assert Scale(0 * start, start, sphere).is_root().tolist() == [True]


def test_lanes_do_not_move_each_other() -> None:
    """The bits of a member are those that it has alone."""
    motion = make_motion("se(3)")
    x = np.random.default_rng(7).normal(size=(6, 5))
    for kind in ("mean", "spherical"):
        method = make_method(kind, "se(3)", motion)
        for member in range(5):
            alone = step(method, x[:, member : member + 1].copy(), 0.05)
            # sums of the motion written by hand run over members, one by one
            assert abs(alone - step(method, x, 0.05)[:, member : member + 1]).max() < 1e-15


def test_a_spoiled_sphere_is_caught() -> None:
    """A sphere of other rows gives a map that is no Poisson map."""
    motion = make_motion("se(3)")
    x = make_start(motion)
    method = SphericalMidpoint(
        field=motion.field,
        size=0.1,
        spheres=(Sphere((0, 1, 2)), Sphere((3, 4, 5))),
    )
    assert find_defect(motion, lambda y: step(method, y, 0.1), x) > 1e-6


def test_matrices_of_planes_are_a_basis() -> None:
    """The hand-written algebras have the dimensions they should."""
    assert [len(so(n)) for n in (3, 4, 6, 8)] == [3, 6, 15, 28]
