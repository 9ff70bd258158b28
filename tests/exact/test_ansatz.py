"""The ansatz search: solutions of linear conditions, lifted, with bounds that hold."""

from fractions import Fraction
from math import comb

from coadjoint.exact.ansatz import (
    Solution,
    conditions_on,
    monomials,
    solve,
    solve_exactly,
    solve_with_right_side,
)
from coadjoint.exact.linear import PRIME, SpanModulo, rank_modulo, whole_numbers

#: Images of x^2, x*y, y^2 under the rotation x d/dy - y d/dx, by their terms.
ROTATED = [{"xy": -2}, {"xx": 1, "yy": -1}, {"xy": 2}]


def test_the_quadratic_invariant_of_rotations_is_found():
    """Of all quadratic forms of the plane, multiples of x^2 + y^2 alone are invariant."""
    (found,) = solve_exactly(["x^2", "x*y", "y^2"], conditions_on(ROTATED))
    assert found == {"x^2": 1, "y^2": 1}


def test_a_wrong_sign_leaves_no_invariant_form():
    """The test above can fail: with one image spoiled the solution is another one."""
    spoiled = [{"xy": 2}, *ROTATED[1:]]
    assert solve_exactly(["x^2", "x*y", "y^2"], conditions_on(spoiled)) == [{"x^2": 1, "y^2": -1}]


def test_values_at_points_bound_the_solutions_from_above():
    """Each condition more leaves at most as many solutions, never fewer than there are."""
    points = [(2, 3), (1, 5), (7, 1)]
    rows = [[-2 * x * y % PRIME, (x**2 - y**2) % PRIME, 2 * x * y] for x, y in points]
    counts = [len(solve(range(3), rows[:k], PRIME)) for k in range(4)]
    assert counts == [3, 2, 1, 1]


def test_solutions_are_lifted_to_the_numbers_they_are_images_of():
    """5/7 and -3 come back from their residues; a residue of no small fraction does not."""
    row = [7, PRIME - 5, 0]
    (first, second) = solve("abc", [row], PRIME)
    assert first.lift() == {"a": 1, "b": Fraction(7, 5)}
    assert second.lift() == {"c": 1}
    assert Solution({"a": 1, "b": 3**39 % PRIME}, PRIME).lift() is None


def test_exponents_of_a_product_solve_their_equation_or_there_are_none():
    """u/2 + 3 v = 7/2 has a solution, with a second equation u = 2 another, with a third none."""
    half = pow(2, -1, PRIME)
    rows = [[half, 3, 7 * half], [1, 0, 1], [1, 1, 5]]
    assert solve_with_right_side("uv", rows[:1], PRIME).lift() == {"u": 7}
    assert solve_with_right_side("uv", rows[:2], PRIME).lift() == {"u": 1, "v": 1}
    assert solve_with_right_side("uv", rows, PRIME) is None


def test_there_are_as_many_monomials_as_binomials_say():
    """In n symbols there are (n + d over d) monomials up to degree d, each once."""
    for size, degree in [(1, 4), (3, 2), (4, 3)]:
        found = list(monomials(size, degree))
        assert len(found) == len(set(found)) == comb(size + degree, degree)
        assert [sum(e) for e in found] == sorted(sum(e) for e in found)


def test_a_span_modulo_a_prime_keeps_independent_rows_alone():
    """A row in the span changes nothing, and the rank is that of all rows at once."""
    rows = [{0: 1, 3: 2}, {1: 5}, {0: 2, 1: 5, 3: 4}, {3: 1}, {0: 7}, {}]
    span = SpanModulo(PRIME)
    assert span.add_independent(rows) == [0, 1, 3]
    assert span.rank == rank_modulo(rows) == 3
    assert not span.add({0: PRIME})
    assert SpanModulo(7, [{0: 7, 1: 1}]).add_independent([{1: 3}, {0: 1}]) == [1]


def test_whole_numbers_have_no_common_factor_and_keep_signs():
    """(-2/3, 4/9) is (-3, 2) times 2/9."""
    assert whole_numbers({"a": Fraction(-2, 3), "b": Fraction(4, 9)}) == {"a": -3, "b": 2}
    assert whole_numbers({0: 6, 1: -4}) == {0: 3, 1: -2}
