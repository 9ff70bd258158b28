"""Common factors in front of sums: the same sum with fewer products, and as it was without any."""

from collections import Counter
from random import Random

import pytest

from coadjoint.derive import derive
from coadjoint.derive.formulas import rhs
from coadjoint.lower import lowering
from coadjoint.lower.nesting import ORDERS, Nest, Term, complete, list_products, nest
from coadjoint.lower.scales import cost
from tests.specs import shipped


def multiply_out(addends, lead=()):
    """Signs by product of a nested sum, terms that occur twice counted twice."""
    total = Counter()
    for each in addends:
        if isinstance(each, Nest):
            total += multiply_out(each.inner, (*lead, *each.lead))
        else:
            total[each.sign, tuple(sorted((*lead, *each.product)))] += 1
    return total


def check_is_same_sum(addends, terms):
    """Multiplied out, a nested sum has the terms that it was made of."""
    assert multiply_out(addends) == multiply_out(terms)


@pytest.mark.parametrize("order", ORDERS)
def test_a_nested_sum_is_the_sum(order):
    """Of random terms with powers and equal ones among them; a lead that is lost is seen."""
    draw = Random(3)
    terms = [
        Term(draw.choice((1, -1)), tuple(draw.choices(("@0", "x", "y", "z"), k=draw.randint(0, 4))))
        for _ in range(25)
    ]
    nested = nest(terms, order)
    check_is_same_sum(nested, terms)
    first = next(each for each in nested if isinstance(each, Nest))
    spoiled = [Nest(each.lead[1:], each.inner) if each is first else each for each in nested]
    with pytest.raises(AssertionError):
        check_is_same_sum(spoiled, terms)


def test_products_without_common_factors_stay():
    """So does a sum of one term, and one of none."""
    terms = Term(1, ("x", "y")), Term(-1, ("z", "z"))
    assert nest(terms, 1) == terms
    assert nest(terms[1:], 1) == terms[1:]
    assert nest((), 1) == ()


def test_all_that_terms_have_in_common_goes_in_front_at_once():
    """``2 x x y - 2 x x z = (2 x x) (y - z)``: the products that are left can share pairs."""
    (found,) = nest([Term(1, ("@2", "x", "x", "y")), Term(-1, ("@2", "x", "x", "z"))], 1)
    assert found == Nest(("@2", "x", "x"), (Term(1, ("y",)), Term(-1, ("z",))))
    assert list(list_products([found])) == [("@2", "x", "x"), ("y",), ("z",)]


def lacking(size, k="k"):
    """``(k . w) w - (w . w) k`` by components, without the two products that cancel."""
    axes = range(size)
    return [
        nest(
            [
                *(Term(1, (f"k{j}", f"w{i}", f"w{j}")) for j in axes if j != i),
                *(Term(-1, (f"{k}{i}", f"w{j}", f"w{j}")) for j in axes if j != i),
            ],
            1,
        )
        for i in axes
    ]


def by_product(addends):
    """Coefficients of the products of a nested sum, multiplied out."""
    total = Counter()
    for (sign, product), count in multiply_out(addends).items():
        total[product] += sign * count
    return {product: count for product, count in total.items() if count}


def test_sums_that_lack_what_cancels_are_completed():
    """Each component gets ``k . w`` and ``w . w``, and is the same sum as before."""
    before = lacking(4)
    after = complete(before)
    assert len({frozenset(each.inner) for addends in before for each in addends}) == 8
    assert len({each.inner for addends in after for each in addends}) == 2
    assert [by_product(each) for each in after] == [by_product(each) for each in before]


@pytest.mark.parametrize("sums", [lacking(4, "l"), lacking(4)[:2], lacking(2)])
def test_sums_stay_where_nothing_cancels_or_too_few_agree(sums):
    """Of ``(k . w) w - (w . w) l``, of two components of four, of sums of one product."""
    assert complete(sums) == sums


@pytest.mark.parametrize(("name", "most"), [("guiding_centre", 0.6), ("suslov_so5", 0.6)])
def test_rates_with_many_common_factors_take_fewer_operations(name, most, monkeypatch):
    """Than without; where nothing is tried, the rates are what they were."""
    equations = derive(shipped(name))
    rows = rhs(equations)
    plain = lowering._program(equations, "rhs", rows.lines, rows.shape, rows.state)
    nested = lowering._choose(equations, plain)
    assert cost(nested) <= most * cost(plain)
    monkeypatch.setattr(lowering, "ORDERS", ())
    assert cost(lowering._choose(equations, plain)) > cost(nested)
