"""Exact linear solves, and the Jacobi check that visits only the brackets that are there."""

import random
from fractions import Fraction
from itertools import combinations, islice

import pytest
from sympy import isprime

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.exact.linear import PRIME, Span, nullspace, primes, rank_modulo


def test_coordinates_of_several_targets_come_from_one_elimination():
    """3 a - b/2 has the coordinates (3, -1/2); a target outside the span has none."""
    span = Span([{"x": 1, "y": 2}, {"y": Fraction(4)}])
    assert span.coordinates({"x": Fraction(3), "y": 4}) == {0: 3, 1: Fraction(-1, 2)}
    assert span.coordinates({"z": 1}) is None
    assert span.coordinates({}) == {}


def test_dependent_vectors_are_named_and_take_no_part():
    """Of two multiples of one vector the second is no member of the basis."""
    span = Span([{"x": 1}, {"x": 2}, {"y": 1, "x": 5}])
    assert (span.dependent, span.rank) == ([1], 2)
    assert span.coordinates({"y": 2}) == {0: -10, 2: 2}


def random_rows(source, unknowns, count, relations):
    """Random sparse equations, some of them combinations of the others."""
    rows = [
        {
            source.randrange(unknowns): Fraction(source.randint(-9, 9), source.randint(1, 5))
            for _ in range(3)
        }
        for _ in range(count)
    ]
    for _ in range(relations):
        a, b = source.sample(rows, 2)
        rows.append({c: a.get(c, 0) + 7 * b.get(c, 0) for c in a.keys() | b.keys()})
    return rows


def test_null_space_is_the_one_that_elimination_over_the_rationals_gives():
    """The basis solves every equation, is reduced, and rank plus nullity is the unknowns."""
    source = random.Random(3)
    sizes = set()
    for _ in range(40):
        n = source.randint(3, 9)
        rows = random_rows(source, n, source.randint(1, n), 2 * (n > 4))
        basis = nullspace(rows, n)
        for vector in basis:
            for row in rows:
                assert sum(value * vector.get(c, 0) for c, value in row.items()) == 0
        assert Span(rows).rank == n - len(basis)
        assert [Span([v]).rows[0] for v in basis] == basis == Span(basis).rows
        sizes.add(len(basis))
    assert len(sizes) > 3, "the trials differ"


def test_null_space_with_long_numbers_takes_a_larger_prime():
    """Numbers of a hundred digits come back exactly, which no prime of 61 bits can hold."""
    long = 10**100 + 267
    assert nullspace([{0: long, 1: -1}], 2) == [{0: 1, 1: long}]
    assert nullspace([{0: 2**61 - 1, 1: 1}], 3) == [{0: 1, 1: 1 - 2**61}, {2: 1}]


def test_null_space_refuses_numbers_that_no_prime_holds():
    """The limit is in the message."""
    with pytest.raises(LimitError, match="null space of 1 equations has numbers of more than 2000"):
        nullspace([{0: 1, 1: 3**2000}], 2)


def test_rank_modulo_a_prime_may_only_fall():
    """A matrix whose determinant is the prime loses one."""
    rows = [{0: 7, 1: 0}, {1: 1}]
    assert Span([{0: 7, 1: 1}, {0: 7, 1: 8}]).rank == 2
    assert rank_modulo([{0: 1, 1: 1}, {0: 1, 1: 8}], 7) == 1
    assert rank_modulo(rows) == 2


def test_primes_are_prime_and_none_is_left_out():
    """SymPy, with an algorithm of its own, finds the same ones among numbers 3 modulo 4."""
    found = list(islice(primes(), 12))
    expected = [n for n in range(found[-1], PRIME + 1) if n % 4 == 3 and isprime(n)]
    assert found == expected[::-1]
    assert found[0] == PRIME == 2**61 - 1


def test_a_float_is_refused():
    """0.5 is not exact; the message says what is."""
    with pytest.raises(AlgebraError, match=r"0\.5 is a floating-point number.*Fraction"):
        Span([{0: 0.5}])


def by_definition(algebra):
    """The first violation by running over all triples, as the identity is written down."""
    size = range(algebra.dimension)
    basis = [[Fraction(int(i == j)) for j in size] for i in size]
    for triple in combinations(size, 3):
        e = [basis[n] for n in triple]
        cyclic = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        terms = [algebra.bracket(e[a], algebra.bracket(e[b], e[c])) for a, b, c in cyclic]
        total = {n: sum(column) for n, column in enumerate(zip(*terms, strict=True)) if sum(column)}
        if total:
            return triple, total
    return None


def unchecked(dimension, constants):
    """An algebra whose identity has not been checked, since it may fail."""
    algebra = object.__new__(LieAlgebra)
    for name, value in {
        "name": "trial",
        "basis": tuple(f"e{n}" for n in range(dimension)),
        "constants": constants,
        "blocks": {},
        "matrices": (),
    }.items():
        object.__setattr__(algebra, name, value)
    return algebra


def test_jacobi_violation_is_the_one_by_definition():
    """On random constants, nearly all of which violate the identity, triple and sum agree."""
    source, violated = random.Random(1), 0
    for _ in range(60):
        n = source.randint(3, 6)
        constants = {
            pair: {k: Fraction(source.randint(-2, 2) or 1) for k in source.sample(range(n), 2)}
            for pair in combinations(range(n), 2)
            if source.random() < 0.5
        }
        algebra = unchecked(n, constants)
        assert algebra.jacobi_violation() == by_definition(algebra)
        violated += algebra.jacobi_violation() is not None
    assert violated > 20


def test_jacobi_identity_holds_in_the_catalogue_by_definition():
    """so(3) and se(3) satisfy the identity on both roads."""
    for name in ("so(3)", "se(3)"):
        assert by_definition(algebra_by_name(name)) is None
        assert algebra_by_name(name).jacobi_violation() is None
