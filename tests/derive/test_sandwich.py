"""Tests of B W B, the product of matrices that the isospectral midpoint takes."""

from itertools import combinations

import numpy as np
import pytest

from coadjoint.derive import sandwich as module
from coadjoint.derive.formulas import rows_of
from coadjoint.derive.sandwich import sandwich
from coadjoint.lower.program import run
from tests.specs import emitted, lowered

SYSTEMS = {"manakov_so4": 4, "so5_body": 5, "manakov_so6": 6, "so8_body": 8}


def to_matrix(values, n):
    """An antisymmetric matrix from its entries above the diagonal, up to the signs of its rows."""
    matrix = np.zeros((n, n))
    for value, (i, j) in zip(values, combinations(range(n), 2), strict=True):
        matrix[i, j], matrix[j, i] = value, -value
    return matrix


@pytest.mark.parametrize("system", SYSTEMS)
def test_it_is_the_product_of_matrices(system):
    """With the planes of the basis in order, in NumPy."""
    program, n = lowered(system)["sandwich"], SYSTEMS[system]
    count = len(program.state) // 2
    rng = np.random.default_rng(3)
    for _ in range(3):
        x, v = rng.normal(size=(2, count))
        known = dict(zip(program.state, (*x, *v), strict=True))
        known |= dict.fromkeys(program.parameters, 1.0)
        rows = run(program, known, float, None)
        W, B = to_matrix(x, n), to_matrix(v, n)
        expected = (B @ W @ B)[np.triu_indices(n, 1)]
        assert abs(np.array(rows) - expected).max() < 1e-12 * abs(expected).max()


@pytest.mark.parametrize(
    "system", ["rigid_body", "heavy_top", "bloch_iserles_3", "sl2_r2", "kepler", "suslov_so5"]
)
def test_other_motions_have_none(system):
    """Spheres, vectors next to an algebra, matrices that are not antisymmetric, constraints."""
    assert rows_of(emitted(system), "sandwich") is None


def test_a_bracket_that_is_no_commutator_is_seen(monkeypatch):
    """One matrix has another sign than the bracket has it."""
    equations = emitted("so5_body")
    matrices = equations.spec.algebra.matrices
    assert module._is_commutator(equations, matrices)
    first = {place: -x for place, x in matrices[0].items()}
    assert not module._is_commutator(equations, (first, *matrices[1:]))
    monkeypatch.setattr(module, "_is_commutator", lambda *_: False)
    assert sandwich.__wrapped__(equations) is None
