"""Exact linear solves, and the Jacobi check that visits only the brackets that are there."""

import random
from fractions import Fraction
from itertools import combinations

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.linear import solve_exactly


def unit(place, value=1):
    """A matrix with one entry."""
    return {place: Fraction(value)}


def test_coordinates_of_several_targets_come_from_one_elimination():
    """3 a - b/2 has the coordinates (3, -1/2); a target outside the span has none."""
    a, b = {(0, 0): Fraction(1), (0, 1): Fraction(2)}, {(0, 1): Fraction(4)}
    target = {(0, 0): Fraction(3), (0, 1): Fraction(4)}
    assert solve_exactly([a, b], [target, unit((1, 1)), {}]) == [
        [Fraction(3), Fraction(-1, 2)],
        None,
        [Fraction(0), Fraction(0)],
    ]


def test_dependent_vectors_have_no_coordinates():
    """Two multiples of one matrix are no basis."""
    assert solve_exactly([unit((0, 0)), unit((0, 0), 2)], [unit((0, 0))]) is None


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
