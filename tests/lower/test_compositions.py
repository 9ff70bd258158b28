"""Compositions: order conditions in the free algebra, word by word, to 40 digits."""

from decimal import Decimal
from itertools import groupby

import mpmath
import pytest

from coadjoint.lower.compositions import PAIRS, find_sweeps, schedule
from tests.lower.maps import flows, measure_order, split_step, take
from tests.lower.order_conditions import (
    compare_series,
    find_pair_errors,
    find_sweep_errors,
    multiply_exponentials,
)


@pytest.mark.parametrize("order", PAIRS)
def test_products_of_two_flows_have_their_order_and_no_more(order):
    """All words in A and B agree up to the order: 31 of order 4, 127 of order 6."""
    a, b = PAIRS[order]()
    with mpmath.workdps(50):
        errors = find_pair_errors(a, b, order)
        assert len(errors) == 2 ** (order + 1) - 1
        assert max(map(abs, errors)) < 1e-40
        assert max(map(abs, find_pair_errors(a, b, order + 1))) > 1e-6
    assert (a, b) == (tuple(reversed(a)), tuple(reversed(b)))


@pytest.mark.parametrize("order", PAIRS)
def test_sweeps_through_any_number_of_flows_have_the_order_of_pairs(order):
    """All words in the terms of the logarithm of a sweep, each with its power of the step."""
    with mpmath.workdps(50):
        sweeps = find_sweeps(*PAIRS[order]())
        errors = find_sweep_errors(sweeps, order)
        assert len(errors) == 2**order  # compositions of numbers up to the order
        assert max(map(abs, errors)) < 1e-40
        assert max(map(abs, find_sweep_errors(sweeps, order + 1))) > 1e-4
        gaps = [one - other for one, other in zip(sweeps, reversed(sweeps), strict=True)]
        assert max(map(abs, gaps)) < 1e-40


def test_a_wrong_coefficient_or_order_of_coefficients_is_caught():
    """One that is off by 1e-12, two that change places, and sweeps that all go forth."""
    with mpmath.workdps(50):
        a, b = PAIRS[4]()
        wrong = (a[0] + Decimal("1e-12"), *a[1:])
        assert max(map(abs, find_pair_errors(wrong, b, 4))) > 1e-13
        swapped = (a[1], a[0], *a[2:-2], a[-1], a[-2])
        assert max(map(abs, find_pair_errors(swapped, b, 4))) > 1e-2
        weights = tuple(range(1, 5))
        sweeps = [mpmath.mpf(str(c)) for c in find_sweeps(a, b)]
        forth = [{(n,): c**w for n, w in enumerate(weights)} for c in sweeps]
        found = multiply_exponentials(forth, weights, 4)
        assert max(map(abs, compare_series(found, {(0,): 1}, weights, 4))) > 1e-3


def test_the_published_digits_are_those():
    """S6 and S10 of Blanes and Moan (2002), tables 2 and 3."""
    a, b = PAIRS[4]()
    assert float(a[1]) == pytest.approx(0.353172906049774, abs=2e-15)
    assert float(b[0]) == pytest.approx(0.209515106613362, abs=2e-15)
    a, b = PAIRS[6]()
    assert float(a[4]) == pytest.approx(0.541960678450780, abs=2e-15)
    assert float(b[3]) == pytest.approx(0.432666402578175, abs=2e-15)


def test_a_coefficient_of_a_schedule_that_is_changed_lowers_the_order(monkeypatch):
    """By a thousandth: the order that is measured is 1 and not 4."""
    state, parameters = take("rigid_body", ("0.4", "0.9", "-0.3"))
    good = schedule(len(flows("rigid_body")), 4)
    (part, time), *rest = good
    monkeypatch.setattr(
        "tests.lower.maps.schedule", lambda parts, order: ((part, time + 1e-3), *rest)
    )
    step = lambda name, x, p, h: split_step(name, 4, x, p, h)  # noqa: E731
    assert measure_order(step, "rigid_body", state, parameters, 32) < 1.5


@pytest.mark.parametrize("parts", [2, 3, 4, 6])
@pytest.mark.parametrize("order", PAIRS)
def test_a_schedule_is_symmetric_and_each_flow_takes_one_step(parts, order):
    """Doubles are symmetric exactly, sums are 1 to a rounding, no flow follows itself."""
    found = schedule(parts, order)
    assert found == found[::-1]
    assert [len(list(group)) for _, group in groupby(part for part, _ in found)] == [1] * len(found)
    for part in range(parts):
        with mpmath.workdps(50):
            total = mpmath.fsum(time for own, time in found if own == part)
            assert abs(total - 1) < 2**-52
    assert len(found) == {2: 2, 4: 12, 6: 20}[order] * (parts - 1) + 1
