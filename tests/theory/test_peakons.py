"""Peakons: the weak form, the momentum map, and two peaks in closed form."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad

from coadjoint.derive import derive
from coadjoint.systems import peakons
from coadjoint.theory.peakons import (
    energy_defect,
    momentum_map_defect,
    peaks_of,
    read_in_order,
    weak_defects,
)
from tests.specs import shipped


@cache
def peaks_in_order(window):
    """The peaks of a window of the shipped system, their rates in order, and the energy."""
    equations = derive(shipped("peakons").family.windows[window])
    peaks = peaks_of(equations)
    rates = {
        name: read_in_order(peaks, equations, rate)
        for name, rate in zip(equations.setting.state, equations.exact.rates, strict=True)
    }
    return peaks, rates, read_in_order(peaks, equations, equations.exact.energy)


@pytest.mark.parametrize(("window", "count"), [(0, 2), (1, 3)])
def test_peakons_solve_the_weak_form(window, count):
    """Two and three peaks in order; both sides are sums over pairs, so that every N follows."""
    peaks, rates, energy = peaks_in_order(window)
    assert len(peaks.places) == count
    defects = dict(weak_defects(peaks, rates))
    assert len(defects) == 5 * count
    assert [name for name, defect in defects.items() if not peaks.field.is_zero(defect)] == []
    assert peaks.field.is_zero(energy_defect(peaks, energy))


@pytest.mark.parametrize("name", ["q_0", "p_0"])
def test_peaks_that_move_otherwise_do_not(name):
    """With one rate of the other sign the condition of this rate alone is refuted."""
    peaks, rates, _ = peaks_in_order(0)
    defects = weak_defects(peaks, {**rates, name: -rates[name]})
    wrong = [statement for statement, defect in defects if not peaks.field.is_zero(defect)]
    assert len(wrong) == 1
    assert f"d{name}/dt" in wrong[0]


def test_peaks_move_by_a_poisson_map():
    """{J^v, J^w} = J^(w v_s - v w_s) for all v and w, which is not so of w v_s + v w_s."""
    assert momentum_map_defect() == 0
    assert str(momentum_map_defect(("v", "v"))) == "0"


def kernel(x, alpha, L):
    """G of the circle, 0 <= x <= L."""
    return np.cosh((x - L / 2) / alpha) / (2 * alpha * np.sinh(L / (2 * alpha)))


def test_one_peak_travels_at_the_speed_of_its_top():
    """The speed is p coth(L/2 alpha)/(2 alpha), and the momentum stays; the other peak has none."""
    rates = peakons.system.resize({"i": 2}).rhs([1.0, 3.0, 3.0, 0.0], [0.7, 5.0])
    np.testing.assert_allclose(rates[[0, 2, 3]], [3 / np.tanh(5 / 1.4) / 1.4, 0, 0], rtol=1e-14)


def test_two_peaks_turn_back_where_their_closed_form_does():
    """(dQ/dt)^2 = 4 (G0 - G(Q)) (H - P^2 (G0 + G(Q))/4) all the way, Q = q1 - q0 (derived here).

    H = (p0^2 + p1^2) G0/2 + p0 p1 G(Q) and dQ/dt = (p1 - p0) (G0 - G(Q)), where (p1 - p0)^2 G0 +
    (p1 - p0)^2 (-G(Q)) = 4 H - P^2 (G0 + G(Q)) by p0^2 + p1^2 = (P^2 + (p1 - p0)^2)/2.
    """
    alpha, L = 0.8, 6.0
    pair = peakons.system.resize({"i": 2})
    start = [0.0, 3.0, 2.5, 1.0]
    found = pair.simulate(
        start, (0, 12.0), parameters=[alpha, L], samples=241, rtol=1e-12, target="numpy"
    )
    q0, q1, p0, p1 = found.state
    Q, P = q1 - q0, p0 + p1
    G0, G = kernel(0, alpha, L), kernel(Q, alpha, L)
    H = (2.5**2 + 1) * G0 / 2 + 2.5 * kernel(3.0, alpha, L)
    rate = (p1 - p0) * (G0 - G)
    np.testing.assert_allclose(P, 3.5, rtol=1e-10)
    np.testing.assert_allclose(rate**2, 4 * (G0 - G) * (H - P**2 * (G0 + G) / 4), atol=1e-9)
    least = L / 2 - alpha * np.arccosh((4 * H / 3.5**2 - G0) * 2 * alpha * np.sinh(L / 2 / alpha))
    assert abs(Q.min() - least) < 2e-3  # samples beside the turning point
    assert Q.min() > least - 1e-9
    assert Q.max() < L

    def speed(x):
        """How fast Q shrinks."""
        mean = G0 + kernel(x, alpha, L)
        return 2 * np.sqrt((G0 - kernel(x, alpha, L)) * (H - P[0] ** 2 * mean / 4))

    place = int(np.argmin(Q)) // 2  # on the way to the turning point
    needed, _ = quad(lambda x: 1 / speed(x), Q[place], 3.0)
    np.testing.assert_allclose(found.time[place], needed, rtol=1e-8)
    assert (p1 > p0).any()
    assert (p1 < p0).any()


def opposite(x):
    """(dQ/dt)^2/4 of two peaks of momenta 1 and -1 that begin at a distance of 2, with P = 0."""
    G0, start = kernel(0, 1.0, 10.0), kernel(2.0, 1.0, 10.0)
    return (G0 - start) * (G0 - kernel(x, 1.0, 10.0))


@pytest.mark.parametrize(
    ("end", "status"),
    [(3.4, "OK"), pytest.param(9.0, "STEP_UNDERFLOW", marks=pytest.mark.campaign)],
)
def test_peaks_of_opposite_momenta_collide_when_their_closed_form_says(end, status):
    """At 3.5655, the integral of dQ/(2 sqrt(H (G0 - G))), where a run says that it ends."""
    pair = peakons.system.resize({"i": 2})
    options = {"method": "dop853", "rtol": 1e-9, "samples": 2, "target": "numpy"}
    found = pair.simulate([0, 2, 1, -1], (0, end), parameters=[1.0, 10.0], **options)
    distance = found.state[1, -1] - found.state[0, -1]
    needed, _ = quad(lambda x: 1 / (2 * np.sqrt(opposite(x))), distance, 2)
    assert found.status == status
    np.testing.assert_allclose(found.time[-1], needed, rtol=1e-6)
