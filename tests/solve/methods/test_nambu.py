"""Nambu's discrete gradient keeps both functions: a motion written by hand, in C and in NumPy.

``c = x^4/4 + y^2/2 + z^2/2`` and ``h = x^2/2 + y^4/4 + z``; the motion is ``dc x dh``.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from coadjoint.declared import Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.lower.orbits import is_nambu
from coadjoint.solve.methods.nambu_gradient import NambuGradient, multiply_gradients
from tests.kernels import COMPILER
from tests.programs import program
from tests.solve.methods.algebras import make_lanes
from tests.solve.systems import EMPTYING, build

C = "x*x*x*x/4 + y*y/2 + z*z/2"
H = "x*x/2 + y*y*y*y/4 + z"
RATES = "y - z*y*y*y; z*x - x*x*x; x*x*x*y*y*y - y*x"
START, STEP = [0.5, 0.8, 0.3], 0.0625


def write(slope="x*x*x; y; z"):
    """What the files of the system say; the gradient of c can be spoiled."""
    programs = (
        program("rhs", "x y z", "", "", RATES, (3,)),
        program("energy", "x y z", "", "", H, ()),
        program("observables", "x y z", "", "", f"{H}; {C}", (2,)),
        program("energy_gradient", "x y z", "", "", "x; y*y*y; 1", (3,)),
        program(
            "bracket_vector",
            "x y z a b c",
            "",
            "",
            "y*c - z*b; z*a - x*x*x*c; x*x*x*b - y*a",
            (3,),
        ),
        program("distinguished", "x y z", "", "", C, (1,)),
        program("distinguished_gradient", "x y z", "", "", slope, (1, 3)),
    )
    kept = tuple(Quantity(name, (), "1", (name,), conserved=True) for name in ("energy", "c"))
    state = tuple(Quantity(name, (), "1", (name,)) for name in "xyz")
    own = {"state": state, "programs": programs, "observables": kept}
    return replace(EMPTYING, name="quartic", **own)


@pytest.fixture(scope="module")
def quartic(tmp_path_factory):
    """The system."""
    return build(write(), tmp_path_factory.mktemp("quartic"))


def follow(system, method, target="numpy", span=5.0, step=STEP, samples=21):
    """A run from the start."""
    run = system.simulate(
        START, (0, span), method=method, step=step, samples=samples, target=target
    )
    assert run.status == "OK"
    return run


@pytest.mark.parametrize("method", ["nambu_gradient", "nambu_gradient4"])
def test_both_functions_stay(quartic, method):
    """To rounding over 80 steps; the discrete gradient of h alone and Gauss's method move c."""
    run = follow(quartic, method)
    assert run.drift["energy"] < 4e-15
    assert run.drift["c"] < 4e-15
    assert np.ptp(run.state, axis=1).min() > 0.1  # it moves


def test_other_methods_move_them(quartic):
    """The control: what is measured above can be missed."""
    assert follow(quartic, "discrete_gradient").drift["c"] > 1e-6
    assert min(follow(quartic, "gauss4").drift.values()) > 1e-10


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_c_and_numpy_have_the_same_bits(quartic):
    """Of all states at samples; each asks other sweeps whether they change something."""
    one, other = (follow(quartic, "nambu_gradient", target) for target in ("c", "numpy"))
    assert np.array_equal(one.state, other.state)
    assert abs(int(one.sweeps) - int(other.sweeps)) < 2 * one.steps < other.sweeps


@pytest.mark.parametrize(("method", "order"), [("nambu_gradient", 2), ("nambu_gradient4", 4)])
def test_the_order_is_that_of_the_method(quartic, method, order):
    """By the gaps of runs with halved steps."""
    ends = [follow(quartic, method, span=2.0, step=0.25 / 2**k, samples=1).state[:, -1]
            for k in range(3)]  # fmt: skip
    gaps = [np.abs(a - b).max() for a, b in pairwise(ends)]
    assert order - 0.3 < math.log2(gaps[0] / gaps[1]) < order + 0.6


def test_a_step_is_undone_by_one_back(quartic):
    """The method is symmetric: forth and back is the start, to rounding."""

    def values(lanes, after, x):
        return np.concatenate([[quartic.energy(x)], quartic.distinguished(x)])

    def gradients(lanes, after, x):
        return np.concatenate([quartic.energy_gradient(x), quartic.distinguished_gradient(x)[0]])

    method, low = NambuGradient(values=values, gradients=gradients, size=STEP), np.zeros((3, 1))
    start = np.array(START)[:, np.newaxis]
    ends = [start]
    for h in (0.25, -0.25):
        x, _, solved, _ = method.advance(make_lanes(ends[-1]), np.full(1, h), ends[-1], low)
        assert solved.all()
        ends.append(x)
    assert np.abs(ends[1] - start).max() > 0.1
    assert np.abs(ends[2] - start).max() < 1e-15


@pytest.mark.parametrize("n", [3, 4, 6])
def test_the_product_is_orthogonal_to_each_gradient(n):
    """``dx_i/dt = -det(e_i, dh, dc_1, ...)``; for three the cross product."""
    rows = np.random.default_rng(n).uniform(-1, 1, (n - 1, n))
    found = multiply_gradients(rows[:, :, np.newaxis])[:, 0]
    expected = [-np.linalg.det(np.vstack([unit, rows])) for unit in np.eye(n)]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
    assert np.abs(rows @ found).max() < 1e-14
    if n == 3:
        np.testing.assert_allclose(found, np.cross(rows[1], rows[0]), rtol=0, atol=1e-15)


def test_a_motion_that_is_no_product_is_refused(tmp_path):
    """With a wrong gradient of c the rates are not the product, and the method does not apply."""
    spoiled = write("x*x*x; y; 2*z")
    programs = {each.name: each for each in spoiled.programs}
    assert not is_nambu(programs)
    assert is_nambu({each.name: each for each in write().programs})
    with pytest.raises(KernelArgumentError, match="Nambu's bracket alone"):
        follow(build(spoiled, tmp_path), "nambu_gradient")
