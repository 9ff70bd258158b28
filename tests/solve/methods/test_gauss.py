"""Tests of the methods of Gauss: their tables, orders, what they keep, and what rounding does."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest

from coadjoint.solve.methods import gauss
from coadjoint.solve.methods.gauss import TABLEAUS, Gauss
from tests.solve.methods.algebras import (
    Motion,
    find_defect,
    make_lanes,
    make_memory,
    make_motion,
    step,
)

ORDERS = (4, 6, 8)


def make_method(motion: Motion, order: int) -> Gauss:
    """A method for a motion on the dual of an algebra."""
    return Gauss(rates=lambda lanes, after, x: motion.rates(x), size=0.1, order=order)


def make_start(motion: Motion) -> Any:
    """A state of length 1."""
    x = np.random.default_rng(3).normal(size=(len(motion.constants), 1))
    return x / np.linalg.norm(x)


def find_table(stages: int) -> tuple[list[Any], list[list[Any]], list[Any]]:
    """Nodes, ``a_ij`` and weights from the conditions B(s) and C(s) alone, in 60 digits.

    J. C. Butcher, Mathematics of Computation 18 (1964) 50: the nodes are zeros of Legendre's
    polynomial; a row has ``sum_j a_ij c_j^(k-1) = c_i^k/k``, the weights the same for 1.
    """
    coefficients = {
        2: [6, -6, 1],
        3: [20, -30, 12, -1],
        4: [70, -140, 90, -20, 1],
    }[stages]
    nodes = sorted(mpmath.polyroots(coefficients, maxsteps=500, extraprec=500))
    powers = mpmath.matrix([[c**k for c in nodes] for k in range(stages)])

    def weigh(end: Any) -> list[Any]:
        right = mpmath.matrix([end ** (k + 1) / mpmath.mpf(k + 1) for k in range(stages)])
        return list(mpmath.lu_solve(powers, right))

    return nodes, [weigh(c) for c in nodes], weigh(mpmath.mpf(1))


@pytest.mark.parametrize("order", ORDERS)
def test_tables_are_those_of_the_order_conditions(order: int) -> None:
    """Nodes, lengths and shares are the nearest doubles, or what a partner leaves of 1."""
    with mpmath.workdps(60):
        nodes, rows, weights = find_table(order // 2)
        table = TABLEAUS[order]
        assert list(table.nodes) == [float(c) for c in nodes]
        assert list(table.lengths) == [float(b) for b in weights[: len(table.lengths)]]
        for i, row in enumerate(table.shares):
            for j, share in enumerate(row):
                assert abs(share - rows[i][j] / weights[j]) <= mpmath.mpf(2) ** -53


@pytest.mark.parametrize("order", ORDERS)
def test_shares_of_two_stages_sum_to_one_without_rounding(order: int) -> None:
    """The condition of J. M. Sanz-Serna, BIT 28 (1988) 877, divided by both weights."""
    shares = TABLEAUS[order].shares
    pairs = [(i, j) for i in range(len(shares)) for j in range(len(shares))]
    assert all(shares[i][j] + shares[j][i] == 1.0 for i, j in pairs)
    assert all(abs(1.0 - share) <= 2.0 and share <= 2.0 for row in shares for share in row)


@pytest.mark.parametrize("order", ORDERS)
def test_a_step_is_that_of_sixty_digits(order: int) -> None:
    """One step from the table of the order conditions, its equation solved to 50 digits."""
    inertia, x, h = (2, 1, mpmath.mpf(2) / 3), [0.3, -0.7, 0.9], 0.25
    with mpmath.workdps(60):
        nodes, rows, weights = find_table(order // 2)

        def rates(y: Any) -> Any:
            w = [a / i for a, i in zip(y, inertia, strict=True)]
            return [
                y[1] * w[2] - y[2] * w[1] + mpmath.sin(y[0]),
                y[2] * w[0] - y[0] * w[2],
                y[0] * w[1] - y[1] * w[0],
            ]

        start = [mpmath.mpf(each) for each in x]
        stages = [start for _ in nodes]
        for _ in range(120):
            slopes = [rates(each) for each in stages]
            stages = [
                [a + h * sum(row[j] * slopes[j][i] for j in range(len(nodes)))
                 for i, a in enumerate(start)]
                for row in rows
            ]  # fmt: skip
        slopes = [rates(each) for each in stages]
        end = [a + h * sum(b * k[i] for b, k in zip(weights, slopes, strict=True))
               for i, a in enumerate(start)]  # fmt: skip

    def move(lanes: Any, after: Any, y: Any) -> Any:
        w = y / np.array([2.0, 1.0, 2.0 / 3.0])[:, np.newaxis]
        turn = np.cross(y, w, axis=0)
        return turn + np.stack([np.sin(y[0]), 0.0 * y[0], 0.0 * y[0]])

    method = Gauss(rates=move, size=h, order=order)
    y = np.array(x)[:, np.newaxis]
    found, memory, solved, sweeps = method.advance(
        make_lanes(y), np.array([h]), y, make_memory(method, y)
    )
    low = memory[:3]
    assert solved.all()
    assert 5 < sweeps[0] < 30
    whole = [mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(found[:, 0], low[:, 0], strict=True)]
    assert max(abs(a - b) for a, b in zip(whole, end, strict=True)) < 4e-16


def find_orders(method: Gauss, x: Any, counts: tuple[int, ...]) -> list[float]:
    """By what power of the step the errors of steps up to time 2 fall."""
    ends = []
    for count in counts:
        end = x
        for _ in range(count):
            end = step(method, end, 2.0 / count)
        ends.append(end)
    gaps = [abs(b - a).max() for a, b in pairwise(ends)]
    return [float(np.log2(a / b)) for a, b in pairwise(gaps)]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", ["so(3)", "se(3)"])
def test_order(name: str, order: int) -> None:
    """On nonlinear motions a method has the order it claims, within 0.1."""
    motion = make_motion(name)
    x = 1.5 * make_start(motion).astype(np.longdouble)
    counts = {4: (32, 64, 128), 6: (16, 32, 64), 8: (6, 12, 24)}[order]
    found = find_orders(make_method(motion, order), x, counts)
    assert abs(found[-1] - order) < 0.1


def test_a_wrong_entry_of_a_table_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two shares one part in 1000 moves: the order falls, though their sum is 1 as before."""
    table = TABLEAUS[6]
    shares = [list(row) for row in table.shares]
    shares[1][0] += 1e-3
    shares[0][1] = 1.0 - shares[1][0]
    spoiled = replace(table, shares=tuple(map(tuple, shares)))
    monkeypatch.setattr(gauss, "TABLEAUS", {6: spoiled})
    motion = make_motion("so(3)")
    x = make_start(motion).astype(np.longdouble)
    assert find_orders(make_method(motion, 6), x, (16, 32, 64))[-1] < 5.0


@pytest.mark.parametrize("order", ORDERS)
def test_steps_backwards_lead_back(order: int) -> None:
    """Each method is its own adjoint."""
    motion = make_motion("se(3)")
    x, method = make_start(motion), make_method(motion, order)
    size = np.array([0.1])
    there, memory, _, _ = method.advance(make_lanes(x), size, x, make_memory(method, x))
    back, _, _, _ = method.advance(make_lanes(there), -size, there, memory)
    assert abs(back - x).max() < 1e-15


@pytest.mark.parametrize("order", ORDERS)
def test_is_no_poisson_map(order: int) -> None:
    """On the dual of so(3) with an energy that is not quadratic a step moves the bracket."""
    motion = make_motion("so(3)")
    x, method = 4.0 * make_start(motion)[:, 0], make_method(motion, order)
    assert find_defect(motion, lambda y: step(method, y, 0.5), x) > 1e-9


def run_body(table_order: int, count: int) -> tuple[float, float]:
    """How far energy and Casimir of free bodies went, relative, in the mean of 64 bodies."""
    inertia = np.array([2.0, 1.0, 2.0 / 3.0])[:, np.newaxis]

    def rates(lanes: Any, after: Any, y: Any) -> Any:
        w = y / inertia
        return np.stack([
            y[1] * w[2] - y[2] * w[1], y[2] * w[0] - y[0] * w[2], y[0] * w[1] - y[1] * w[0],
        ])  # fmt: skip

    x = np.random.default_rng(5).normal(size=(3, 64))
    method, h = Gauss(rates=rates, size=0.2, order=table_order), np.full(64, 0.2)
    memory = make_memory(method, x)
    integrals = [lambda y: (y * y / inertia).sum(axis=0), lambda y: (y * y).sum(axis=0)]

    def find(y: Any, rest: Any) -> list[Any]:
        whole = y.astype(np.longdouble) + rest
        return [integral(whole) for integral in integrals]

    before = find(x, memory[:3])
    for _ in range(count):
        x, memory, solved, _ = method.advance(make_lanes(x), h, x, memory)
        assert solved.all()
    after = find(x, memory[:3])
    energy, casimir = (float(abs((b - a) / a).max()) for a, b in zip(before, after, strict=True))
    return energy, casimir


@pytest.mark.parametrize("order", ORDERS)
def test_keeps_quadratic_integrals(order: int) -> None:
    """Energy and Casimir of free bodies stay within what 500 compensated steps may lose."""
    assert max(run_body(order, 500)) < 3e-15


def test_shares_that_do_not_sum_to_one_lose_quadratic_integrals(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An error of 1e-13 in one share has one sign in every step, and is seen after 500."""
    table = TABLEAUS[6]
    shares = [list(row) for row in table.shares]
    shares[1][1] += 1e-13
    spoiled = replace(table, shares=tuple(map(tuple, shares)))
    monkeypatch.setattr(gauss, "TABLEAUS", {6: spoiled})
    assert max(run_body(6, 500)) > 3e-15


def test_a_step_that_is_too_long_is_not_solved() -> None:
    """Sweeps that do not converge are told, in the lanes where they do not."""
    motion = make_motion("so(3)")
    x = np.concatenate([make_start(motion), 400 * make_start(motion)], axis=1)
    with np.errstate(all="ignore"):
        method, h = make_method(motion, 6), np.full(2, 0.2)
        found = method.advance(make_lanes(x), h, x, make_memory(method, x))
    assert found[2].tolist() == [True, False]
