"""Symmetric equations by a loop: exact numbers, floats within their envelopes, operations."""

import random
from collections import Counter
from fractions import Fraction

import pytest

from coadjoint.crosscheck.oracle import (
    CONTEXT,
    BoundedEquations,
    OutsideDomain,
    error_in_envelopes,
    exact,
    localcontext,
)
from coadjoint.derive.sloped import Sloped
from coadjoint.exact.factored import Loop, count_factor, count_solve, factor, place_of, row_of
from coadjoint.exact.residues import Residue

SIZE = 5


def sample(size=SIZE, seed=1):
    """A positive definite matrix on and below its diagonal, and a right side: small integers."""
    source = random.Random(seed)
    root = [[source.randint(-4, 4) for _ in range(size)] for _ in range(size)]
    entries = [
        Fraction(sum(a * b for a, b in zip(root[i], root[j], strict=True)) + (i == j))
        for i in range(size)
        for j in range(i + 1)
    ]
    return entries, [Fraction(source.randint(-9, 9)) for _ in range(size)]


def check_solution(entries, known, x):
    """``A x = b``, entry by entry."""
    size = range(len(known))
    assert any(known), "zero solves every matrix"
    for i in size:
        row = (entries[place_of(max(i, j), min(i, j))] * x[j] for j in size)
        assert sum(row) == known[i]


def test_the_loop_solves_equations_exactly():
    """Rational numbers, where nothing is rounded; pivots are quotients of leading minors."""
    entries, known = sample()
    factored = Loop(entries)
    check_solution(entries, known, factored.solve(known))
    assert factored[0] == entries[0]
    assert factored[2] == entries[2] - entries[1] ** 2 / entries[0]


def test_a_wrong_entry_is_seen():
    """The check above can fail."""
    entries, known = sample()
    x = Loop([*entries[:-1], entries[-1] + 1]).solve(known)
    with pytest.raises(AssertionError):
        check_solution(entries, known, x)


def test_places_go_row_by_row():
    """The row of each place, and back."""
    places = [(i, j) for i in range(6) for j in range(i + 1)]
    assert [place_of(*each) for each in places] == list(range(21))
    assert [row_of(n) for n in range(21)] == [i for i, _ in places]


class Counting:
    """Numbers that count what is done with them."""

    def __init__(self, counts):
        self.counts = counts

    def _count(self, kind):
        self.counts[kind] += 1
        return self

    def __add__(self, other):
        return self._count("add")

    def __mul__(self, other):
        return self._count("multiply")

    def __truediv__(self, other):
        return self._count("divide")

    def __neg__(self):
        return self


@pytest.mark.parametrize("size", [1, 2, 5])
def test_operations_are_counted(size):
    """Those of both steps are as many as the formulas say."""
    counts = Counter()
    number = Counting(counts)
    loop = Loop([number] * place_of(size, 0))
    assert counts == Counter(count_factor(size))
    counts.clear()
    loop.solve([number] * size)
    assert counts == Counter(count_solve(size))


@pytest.mark.parametrize(("size", "power"), [(4, 0), (7, 0), (12, 8)])
def test_floats_are_within_the_envelope(size, power):
    """The same loop in floats, also of a matrix with a condition number of 10^16; and pivots."""
    entries, known = sample(size, seed=size)
    scales = [Fraction(10) ** (-power * i // size) for i in range(size)]
    entries = [
        e * scales[row_of(n)] * scales[n - place_of(row_of(n), 0)] for n, e in enumerate(entries)
    ]
    plain, sides = list(map(float, entries)), list(map(float, known))
    with localcontext(CONTEXT):
        whole = BoundedEquations(list(map(exact, plain)))
        exactly = whole.solve(list(map(exact, sides)))
    loop = Loop(plain)
    errors = list(map(error_in_envelopes, loop.solve(sides), exactly))
    errors += [error_in_envelopes(loop[place_of(n, n)], whole[place_of(n, n)]) for n in range(size)]
    assert max(errors) < 2
    true = Loop(list(map(Fraction, plain))).solve(list(map(Fraction, sides)))
    assert all(
        abs(Fraction(a.value) - b) < Fraction(1, 10**45) * (1 + abs(b))
        for a, b in zip(exactly, true, strict=True)
    )
    wrong = Loop([*plain[:-1], plain[-1] * (1 + 1e-9)]).solve(sides)
    assert max(map(error_in_envelopes, wrong, exactly)) > 100


def test_equations_without_a_certain_solution_are_outside_of_the_domain():
    """A pivot that may be nothing but rounding."""
    near = [exact(1.0), exact(1.0), exact(1.0 + 2.0**-45)]
    with localcontext(CONTEXT), pytest.raises(OutsideDomain):
        factor(near)


def test_slopes_are_those_of_the_implicit_function():
    """``A x' = b' - A' x``, compared with a difference quotient in exact numbers."""
    entries, known = sample(3)
    steps = [Fraction(n + 1, 7) for n in range(len(entries) + len(known))]
    sloped = [Sloped(x, {0: h}) for x, h in zip((*entries, *known), steps, strict=True)]
    found = factor(sloped[:6]).solve(sloped[6:])
    small = Fraction(1, 10**9)
    sides = [
        [x + sign * small * h for x, h in zip((*entries, *known), steps, strict=True)]
        for sign in (1, -1)
    ]
    after, before = (Loop(each[:6]).solve(each[6:]) for each in sides)
    for x, a, b in zip(found, after, before, strict=True):
        assert abs(x.slopes[0] - (a - b) / (2 * small)) < Fraction(1, 10**12)


def test_a_pivot_of_zero_stops_the_loop():
    """As any other quotient by zero, in residues too."""
    with pytest.raises(ZeroDivisionError):
        Loop([Residue(0), Residue(1), Residue(2)])
