"""Stars: which products of components looped rates need, and the recurrences that follow."""

from collections import Counter
from fractions import Fraction
from itertools import combinations

import pytest

from coadjoint.lower.evaluation import evaluate, run
from coadjoint.lower.stars import MOST, find_stars, make_looped_jets
from coadjoint.lower.tables import UNROLLED_PRODUCTS
from tests.lower.test_tables import programs
from tests.programs import LOOPED, TABLE

STARS = find_stars(TABLE)


def test_products_of_two_components_are_computed_once():
    """X  y is a factor of three values, y z of two rates; squares are among them."""
    products = [tuple(sorted(pair)) for pair in STARS.products()]
    assert sorted(products) == [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2)]
    assert len(STARS.rows) == 6 + 1  # rates have 2, 2 and 3 terms
    assert STARS.bounds[-1] == len(STARS.rows)
    assert len(STARS.terms) == len(TABLE.entries)


@pytest.mark.parametrize("n", [4, 9])
def test_a_body_needs_each_product_once(n):
    """Of so(n), planes that share an axis: n (n-1) (n-2)/2 products, most in full stars."""
    stars = find_stars(programs(n, 0 if n < 9 else UNROLLED_PRODUCTS)["rhs"].table)
    planes = list(combinations(range(n), 2))
    wanted = {(a, b) for a, b in combinations(range(len(planes)), 2) if {*planes[a]} & {*planes[b]}}
    assert {tuple(sorted(pair)) for pair in stars.products()} == wanted
    assert len(stars.right) == len(stars.rows) == len(wanted) == n * (n - 1) * (n - 2) // 2
    sizes = Counter(b - a for a, b in zip(stars.starts, stars.starts[1:], strict=False))
    assert max(sizes) <= MOST
    if n == 9:
        assert sizes[MOST] > len(wanted) / MOST - 6


def test_the_terms_add_up_to_the_rates():
    """Weights times products are the rates of the Program, exactly."""
    rhs = LOOPED.programs[0]
    jets, weights = make_looped_jets(rhs, STARS)
    given = dict(zip(rhs.names, map(Fraction, (2, -3, 5, 7, 4)), strict=True))
    known = dict(given)
    for statement in (*jets.fixed, *weights):
        known[statement.name] = evaluate(statement.value, known, Fraction, None)
    for cell in jets.cells:
        known[cell.name] = evaluate(cell.value, known, Fraction, None)
    found = [evaluate(rate, known, Fraction, None) for rate, _ in jets.rates]
    assert found == run(rhs, given, Fraction, None)
    assert known["_c1"], known["_c2"] == (Fraction(7, 4), Fraction(3, 2))
