"""Compositions: order conditions in the free algebra, word by word, to 40 digits."""

from itertools import groupby

import mpmath
import pytest

from coadjoint.lower import compositions
from coadjoint.lower.compositions import (
    find_pair_errors,
    find_symmetric_errors,
    schedule,
)

ORDERS = {"suzuki4": 4, "yoshida4": 4, "yoshida6": 6, "kahan_li6": 6}
PAIRS = {"blanes_moan4": 4, "blanes_moan6": 6}


@pytest.mark.parametrize("name", ORDERS)
def test_steps_of_symmetric_methods_have_their_order_and_no_more(name):
    """All words in X, Y of weight 3 and Z of weight 5 agree up to the order."""
    steps, order = getattr(compositions, name)(), ORDERS[name]
    with mpmath.workdps(50):
        errors = find_symmetric_errors(steps, order)
        assert len(errors) > order
        assert max(map(abs, errors)) < 1e-40
        assert max(map(abs, find_symmetric_errors(steps, order + 1))) > 1e-4
    assert steps == tuple(reversed(steps))


@pytest.mark.parametrize("name", PAIRS)
def test_products_of_two_flows_have_their_order_and_no_more(name):
    """All words in A and B agree up to the order: 30 of order 4, 126 of order 6."""
    (a, b), order = getattr(compositions, name)(), PAIRS[name]
    with mpmath.workdps(50):
        errors = find_pair_errors(a, b, order)
        assert len(errors) == 2 ** (order + 1) - 1
        assert max(map(abs, errors)) < 1e-40
        assert max(map(abs, find_pair_errors(a, b, order + 1))) > 1e-6
    assert (a, b) == (tuple(reversed(a)), tuple(reversed(b)))


def test_a_wrong_coefficient_or_order_of_coefficients_is_caught():
    """One that is off by 1e-12, two that change places, and Yoshida's list from the inside out."""
    with mpmath.workdps(50):
        a, b = compositions.blanes_moan4()
        wrong = (a[0] + mpmath.mpf("1e-12"), *a[1:])
        assert max(map(abs, find_pair_errors(wrong, b, 4))) > 1e-13
        swapped = (a[1], a[0], *a[2:-2], a[-1], a[-2])
        assert max(map(abs, find_pair_errors(swapped, b, 4))) > 1e-2
        w = compositions.yoshida6()
        inward = (w[2], w[1], w[0], w[3], w[0], w[1], w[2])
        assert max(map(abs, find_symmetric_errors(inward, 6))) > 1e-3


def test_the_published_digits_are_those():
    """S6 and S10 of Blanes and Moan (2002), s9odr6a of Kahan and Li (1997), Yoshida's A (1990)."""
    a, b = compositions.blanes_moan6()
    assert float(a[4]) == pytest.approx(0.541960678450780, abs=1e-14)
    assert float(b[3]) == pytest.approx(0.432666402578175, abs=1e-14)
    assert float(compositions.kahan_li6()[4]) == pytest.approx(0.798543990934829963, abs=1e-15)
    assert float(compositions.yoshida6()[3]) == pytest.approx(1.31518632068391, abs=1e-13)
    assert float(compositions.suzuki4()[0]) == 1 / (4 - 4 ** (1 / 3))


@pytest.mark.parametrize("parts", [2, 3, 4, 6])
@pytest.mark.parametrize("order", [2, 4, 6])
def test_a_schedule_is_symmetric_and_each_flow_takes_one_step(parts, order):
    """Doubles are symmetric exactly, sums are 1 to a rounding, no flow follows itself."""
    flows = schedule(parts, order)
    assert flows == flows[::-1]
    assert [len(list(group)) for _, group in groupby(part for part, _ in flows)] == [1] * len(flows)
    for part in range(parts):
        with mpmath.workdps(50):
            total = mpmath.fsum(time for own, time in flows if own == part)
            assert abs(total - 1) < 2**-52
    strang = 2 * parts - 1
    assert (
        len(flows)
        == {
            2: strang,
            4: 13 if parts == 2 else 5 * (strang - 1) + 1,
            6: 21 if parts == 2 else 9 * (strang - 1) + 1,
        }[order]
    )
