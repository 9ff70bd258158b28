"""The longest stable step of explicit methods for waves of fields."""

import re
import warnings

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.errors import StabilityWarning
from coadjoint.solve.folders import load_texts
from coadjoint.solve.stability import find_interval, find_rates
from coadjoint.systems import (
    camassa_holm,
    kdv,
    landau_lifshitz,
    rigid_body,
    spin_chain,
    spin_chain_chiral,
)
from tests.derive.test_ends import spec_of

#: Intervals on the imaginary axis by roots of |R(i y)|^2 - 1 to 50 digits, by order.
TAYLOR = {
    3: 3**0.5,
    4: 8**0.5,
    7: 1.7644,
    8: 3.3951,
    11: 1.7012,
    12: 3.3794,
    15: 1.6687,
    16: 3.3248,
    20: 3.2903,
    24: 3.2667,
}
CHAIN = spin_chain_chiral.system.resize({"s": 32})


def warnings_of(run):
    """What a run says of its steps."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = run()
    return found, [str(each.message) for each in told if each.category is StabilityWarning]


@pytest.mark.parametrize("order", TAYLOR)
def test_intervals_of_the_method_of_taylor(order):
    """Of orders that are a multiple of 4, or one less."""
    assert abs(find_interval("taylor", order) - TAYLOR[order]) < 1e-4


@pytest.mark.parametrize("order", [1, 2, 5, 6, 9, 10, 13, 14, 18, 22])
def test_other_orders_of_taylor_have_none(order):
    """|R(i y)|^2 - 1 begins with a positive term, which doubles do not show for high orders."""
    assert find_interval("taylor", order) == 0


def test_intervals_of_runge_and_kutta():
    """2 sqrt(2) of the classical method, and 5.9604 of that of order 8."""
    assert abs(find_interval("rk4", 4) - 8**0.5) < 1e-8
    assert abs(find_interval("dop853", 8) - 5.9604) < 1e-4


def test_rates_of_the_shortest_waves():
    """For sqrt(K/I), 3 u, S k^2 and c k^3 by hand, times what differences have at most."""
    N, L = 32, 10.0
    I, K = np.array([1.0, 2.0, 3.0]), np.array([3.0, 2.0, 1.0])  # noqa: E741
    chain = find_rates(
        spin_chain.system.resize({"s": N}), np.ones((6 * N, 1)), np.array([*I, *K, L])
    )
    np.testing.assert_allclose(chain, np.sqrt(3) * 1.37222 * N / L, rtol=1e-6)
    own, parameters = landau_lifshitz.system.resize({"s": N}), np.array([0, 0, 1, 0, 0, 0, L])
    S = np.repeat([[0.0], [3.0], [4.0]], N, axis=0).reshape(-1, 1)
    np.testing.assert_allclose(find_rates(own, S, parameters), 5 * 16 / 3 * (N / L) ** 2, rtol=1e-5)
    waves = find_rates(kdv.system.resize({"s": N}), np.zeros((N, 1)), np.array([0.7, L]))
    t = np.linspace(0, np.pi, 200001)  # D_3 of order 6
    waves_of = (-61 / 30, 169 / 120, -3 / 10, 7 / 240)
    size = np.abs(sum(2 * c * np.sin(r * t) for r, c in enumerate(waves_of, 1))).max()
    np.testing.assert_allclose(waves, 0.7 * size * (N / L) ** 3, rtol=1e-5)


@pytest.mark.parametrize(("order", "largest"), [(2, 2**0.5), (4, 1.93633)])
def test_rates_of_waves_between_ends(order, largest):
    """With L/(N - 1) between points: sqrt(3) times the spectral radius of the differences."""
    with load_texts(dict(pipeline.render(spec_of("free", order)).texts)) as system:
        own = system.resize({"s": 17})
        found = find_rates(own, np.ones((102, 1)), np.array([1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 10.0]))
    np.testing.assert_allclose(found, np.sqrt(3) * largest * 16 / 10, rtol=1e-5)


@pytest.mark.parametrize(("method", "interval"), [("rk4", 8**0.5), ("dop853", 5.9604)])
def test_the_bound_is_sharp(method, interval):
    """Small waves of the chiral chain stay with 0.95 of the bound, and with 1.05 they explode."""
    source, bound = np.random.default_rng(0), interval * 10 / 32 / 1.37222
    state = 1e-6 * source.normal(size=192)
    sizes = {}
    for part in (0.95, 1.05):
        step = part * bound
        options = {"method": method, "step": step, "target": "numpy", "samples": 2}

        def run(step=step, options=options):
            return CHAIN.simulate(state, (0, 100 * step), parameters=[10.0], **options)

        found, told = warnings_of(run)
        sizes[part] = np.abs(found.state[:, -1]).max()
        assert len(told) == (part > 1)
    assert sizes[0.95] < 1e-5 < 1e2 < sizes[1.05]


def test_a_step_that_is_too_long_is_told_and_the_advice_works():
    """Before the run, with the step up to which it is stable."""
    state = np.random.default_rng(0).normal(size=192)
    options = {"method": "rk4", "target": "numpy", "samples": 2, "parameters": [10.0]}
    _, (told,) = warnings_of(lambda: CHAIN.simulate(state, (0, 2), step=1.0, **options))
    assert "the step 1 is longer than 0.644" in told
    assert "at t = 0;" in told
    advice = float(re.search(r"Take step=([\d.]+)", told)[1])
    assert not warnings_of(lambda: CHAIN.simulate(state, (0, 2), step=advice, **options))[1]
    implicit = {**options, "method": "midpoint"}
    assert not warnings_of(lambda: CHAIN.simulate(state, (0, 2), step=1.0, **implicit))[1]


def test_waves_that_become_faster_are_told_afterwards():
    """The hump of Camassa and Holm's equation grows, so that a step that was short is too long."""
    system = camassa_holm.system.resize({"s": 128})
    state = 0.1 + np.exp(-((np.arange(128) * 40 / 128 - 10) ** 2) / 8)
    options = {"method": "rk4", "target": "numpy", "step": 0.6, "samples": 11}
    _, (told,) = warnings_of(lambda: system.simulate(state, (0, 12), **options))
    assert float(re.search(r"at t = ([\d.]+)", told)[1]) > 5
    assert not warnings_of(lambda: system.simulate(state, (0, 0.6), **options))[1]


def test_orders_of_taylor_are_those_with_an_interval():
    """A tolerance of 1e-5 asks for the order 10, and of fields for 12."""
    options = {"method": "taylor", "rtol": 1e-5, "target": "numpy", "samples": 2}
    state = np.random.default_rng(0).normal(size=192)
    found = CHAIN.simulate(state, (0, 0.1), parameters=[10.0], **options)
    assert found.settings["order"] == 12
    other = rigid_body.system.simulate([1.0, 2.0, 3.0], (0, 0.1), **options)
    assert other.settings["order"] == 10
