"""A fluid on the torus by matrices of any odd number of rows, against plain NumPy and euler_2d."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.matrix_functions import show_on_torus
from coadjoint.systems import euler_2d, zeitlin_torus
from tests.kernels import COMPILER
from tests.solve.test_truncated import check_casimirs, random_state
from tests.torus_matrices import find_parts, find_velocity, sample, wave, waves
from tests.truncated import pack, unpack

FLUID = zeitlin_torus.system
TARGET = "c" if COMPILER else "numpy"
#: A few waves, by their cosines and sines.
TERMS = {(1, 0): (0.7, 0.2), (0, 2): (1.0, 0.0), (1, 1): (0.0, -0.4), (1, -2): (0.3, 0.5)}


def test_waves_have_the_sine_bracket():
    """Of the matrices that the expected values are made of."""
    n = 5
    for m in waves(n):
        for k in waves(n):
            A, B = wave(*m, n), wave(*k, n)
            expected = -2j * np.sin(2 * np.pi * (m[0] * k[1] - m[1] * k[0]) / n)
            expected = expected * wave(m[0] + k[0], m[1] + k[1], n)
            np.testing.assert_allclose(A @ B - B @ A, expected, atol=1e-13)


@pytest.mark.parametrize("n", [3, 5, 9, 17])
def test_rates_are_those_of_zeitlins_equation(n):
    """``dW/dt = [W, V]``, and the energy; with the other sign of V they are seen to be wrong."""
    system, state = FLUID.resize({"N": n}), random_state(n)
    W = unpack(state)
    V = find_velocity(W)
    expected = pack(W @ V - V @ W)
    found = system.rhs(state, [])
    np.testing.assert_allclose(found, expected, atol=1e-11 * n)
    assert np.abs(found + expected).max() > 0.1
    energy = -np.trace(W @ V).real / 2
    assert system.energy(state, []) == pytest.approx(energy, rel=1e-12)
    assert energy > 0


@pytest.mark.parametrize("n", [5, 9])
def test_rates_are_those_by_the_sine_bracket(n):
    """``dw_k/dt = 2 sum sin(2 pi m x n/N) w_m v_n``, without a product of matrices."""
    state = random_state(n, 3)
    found = find_parts(unpack(FLUID.resize({"N": n}).rhs(state, [])))
    w, expected = find_parts(unpack(state)), dict.fromkeys(waves(n), 0)
    half = n // 2
    for m in waves(n):
        for k in waves(n):
            if k != (0, 0):
                both = tuple((a + b + half) % n - half for a, b in zip(m, k, strict=True))
                sine = np.sin(2 * np.pi * (m[0] * k[1] - m[1] * k[0]) / n)
                size = 4 * np.pi * (k[0] ** 2 + k[1] ** 2) / n
                expected[both] += 2 * sine * w[m] * w[k] / size
    for k in waves(n):
        assert found[k] == pytest.approx(expected[k], abs=1e-11)
    assert max(map(abs, expected.values())) > 0.1


@pytest.mark.parametrize(
    "terms",
    [
        {(1, 2): (1, 0.5), (2, -1): (0.3, 2), (2, 1): (1, 1)},
        {(1, 1): (1, 0), (2, 2): (0.4, 1), (3, 3): (0, 2)},
    ],
)
def test_waves_of_one_length_and_layers_are_at_rest(terms):
    """Stream function and vorticity are functions of one another, for every N."""
    for n in (7, 9):
        W = sample(terms, n)
        np.testing.assert_allclose(FLUID.resize({"N": n}).rhs(pack(W), []), 0, atol=1e-13)
    other = sample({**terms, (0, 1): (1, 0)}, 9)
    assert np.abs(FLUID.resize({"N": 9}).rhs(pack(other), [])).max() > 0.1


@pytest.mark.parametrize(
    ("method", "keeps", "target"),
    [("isospectral_midpoint", True, TARGET), ("midpoint", False, "numpy"), ("rk4", False, "numpy")],
)
def test_the_isospectral_midpoint_keeps_all_casimirs(method, keeps, target):
    """The spectrum of 9 rows to 1e-13 of its size, and so tr W^k, k = 2 to 9; others do not."""
    check_casimirs(FLUID, random_state(9), method, keeps=keeps, target=target)


def on_grid(count, terms):
    """The sum of waves at points of a plane, by x and y."""
    x = 2 * np.pi * np.arange(count) / count
    angles = ((k1 * x[:, None] + k2 * x, *parts) for (k1, k2), parts in terms.items())
    return sum(c * np.cos(angle) + s * np.sin(angle) for angle, c, s in angles)


def test_matrices_are_shown_as_the_functions_that_they_stand_for():
    """At N points along x and y; with the other sign of a wave they are not."""
    for n in (5, 9):
        X = pack(sample(TERMS, n)).reshape(n, n)
        np.testing.assert_allclose(show_on_torus(X), on_grid(n, TERMS), atol=1e-13)
        assert np.abs(show_on_torus(X.T) - on_grid(n, TERMS)).max() > 0.1


def test_the_limit_of_many_rows_is_the_fluid():
    """Rates tend to those of ``euler_2d`` as 1/N^2; those of the other sign to nothing."""
    count = 16
    fluid = euler_2d.system.resize({"x": count, "y": count})
    flat = fluid.evaluate("rhs", on_grid(count, TERMS).ravel(), target="numpy")
    rates = np.fft.fft2(np.reshape(flat, (count, count)), norm="forward")
    limit = {k: rates[k] for k in waves(count - 1)}
    size, misses, opposite = np.linalg.norm(list(limit.values())), [], []
    for n in (17, 33, 65):
        state = pack(sample(TERMS, n))
        X = FLUID.resize({"N": n}).rhs(state, []).reshape(n, n)
        found = np.fft.fft2(show_on_torus(X), norm="forward")
        misses.append(np.linalg.norm([found[k] - limit[k] for k in limit]) / size)
        opposite.append(np.linalg.norm([found[k] + limit[k] for k in limit]) / size)
    orders = np.log(np.divide(misses[:-1], misses[1:])) / np.log([33 / 17, 65 / 33])
    np.testing.assert_allclose(orders, 2, atol=0.05)
    assert misses[-1] < 0.01
    assert min(opposite) > 1


def test_the_default_is_that_of_the_plane():
    """Layers with a disturbance, as `euler_2d` begins."""
    n = FLUID.index.size
    X = np.reshape(FLUID.STATE["W"].default, (n, n))
    terms = {(0, 2): (2 / 3, 0), (1, 0): (1 / 30, 0), (1, 1): (0, 1 / 30)}
    np.testing.assert_allclose(show_on_torus(X), on_grid(n, terms), atol=1e-14)
    begun = np.reshape(euler_2d.system.STATE["w"].default, (32, 32))
    np.testing.assert_allclose(begun, on_grid(32, terms), atol=1e-14)


def test_the_number_of_rows_is_odd():
    """Or the message says which ones are."""
    with pytest.raises(KernelArgumentError, match=r"expected an odd number.*Take 7 or 9") as error:
        FLUID.resize({"N": 8})
    assert error.value.parts["expected"] == (7, 9)
    with pytest.raises(KernelArgumentError, match="at least 3"):
        FLUID.resize({"N": 1})
    assert FLUID.resize({"N": 9}).STATE.size == 81
