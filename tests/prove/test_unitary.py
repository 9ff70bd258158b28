"""The bracket of u(N) for every N, and what is refuted where it is spoiled."""

from itertools import product
from random import Random

import pytest
import sympy

from coadjoint.algebra.catalogue import algebra_by_name
from coadjoint.prove import Verdict, unitary
from coadjoint.prove.unitary import Entries, claim_sine_bracket, find_phases, list_claims

SCOPE = "for every N >= 2"


def matrix_of(entries, n):
    """``(X - X^T)/2 + i (X + X^T)/2``, by SymPy."""
    X = sympy.Matrix(n, n, entries)
    return (X - X.T) / 2 + sympy.I * (X + X.T) / 2


@pytest.mark.parametrize("n", [2, 3, 5])
def test_other_numbers_of_rows_have_the_commutator(n):
    """By structure constants of u(n), and by products of complex matrices of SymPy."""
    random = Random(n)
    W, V = ([random.randint(-9, 9) for _ in range(n * n)] for _ in "WV")
    rates = algebra_by_name(f"entries({n})").ad_star(V, W)
    one, other = matrix_of(W, n), matrix_of(V, n)
    expected = one * other - other * one
    assert sympy.simplify(
        matrix_of([sympy.nsimplify(x) for x in rates], n) - expected
    ).is_zero_matrix
    assert not expected.is_zero_matrix


def test_brackets_of_entries_have_no_other_rows():
    """What makes 4 rows stand for all: and permuted rows have permuted brackets."""
    n, counted = 5, 0
    algebra = algebra_by_name(f"entries({n})")
    table = {
        (divmod(a, n), divmod(b, n)): {divmod(c, n): x for c, x in row.items()}
        for (a, b), row in algebra.constants.items()
    }
    turn = (3, 0, 4, 1, 2)
    for (a, b), row in table.items():
        assert {m for c in row for m in c} <= {*a, *b}
        moved, other = (tuple(turn[m] for m in place) for place in (a, b))
        sign, pair = (1, (moved, other)) if (moved, other) in table else (-1, (other, moved))
        expected = {tuple(turn[m] for m in c): sign * x for c, x in row.items()}
        assert table[pair] == expected
        counted += 1
    assert counted > 100


def test_every_claim_is_proved():
    """With how many rows it was decided."""
    claims = list_claims("left", SCOPE, "N")
    assert [claim.verdict for claim in claims] == [Verdict.PROVED] * 4
    assert "for 4 rows" in claims[0].method
    assert "for 6 rows" in claims[1].method


def test_the_other_side_has_no_casimirs_claimed():
    """Right invariant motions go the other way, which is seen at a point."""
    claims = list_claims("right", SCOPE, "N")
    assert [claim.verdict for claim in claims] == [Verdict.REFUTED, Verdict.PROVED]
    assert claims[0].counterexample


def test_rates_of_another_product_are_no_multiples_of_gaps(monkeypatch):
    """Of W V + V W the diagonal W leaves less of V as it is."""
    honest = unitary.commute_entries

    def spoiled(field, W, V):
        return tuple(x + W[0] * V[5] for x in honest(field, W, V))

    monkeypatch.setattr(unitary, "commute_entries", spoiled)
    assert any(not Entries("left").field.is_zero(x) for x in Entries("left").at_diagonal())


@pytest.mark.parametrize("n", [3, 5])
def test_a_diagonal_matrix_has_the_rank_that_is_said(n):
    """``n^2 - n`` for different entries, less for equal ones; gradients of traces are n more."""
    algebra = algebra_by_name(f"entries({n})")

    def rank(w):
        W = [w[i] if i == j else 0 for i, j in product(range(n), repeat=2)]
        units = ([int(a == b) for b in range(n * n)] for a in range(n * n))
        rows = [list(map(sympy.nsimplify, algebra.ad_star(unit, W))) for unit in units]
        return (
            sympy.polys.matrices.DomainMatrix.from_list_sympy(n * n, n * n, rows).to_field().rank()
        )

    assert rank(range(1, n + 1)) == n * n - n
    assert rank([1, 1, *range(2, n)]) == n * n - n - 2
    assert sympy.Matrix(n, n, lambda i, k: (i + 1) ** k).rank() == n


def test_the_sine_bracket_is_an_identity_of_phases():
    """With the other sign of m x n it is none."""
    assert claim_sine_bracket("for every odd N >= 3", "N").verdict is Verdict.PROVED
    field, defect = find_phases(-1)
    assert not field.is_zero(defect)
