"""Newton's method by bands: which members are coupled, and the linear equations of these."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from coadjoint.solve.methods.bands import Bands, improve, solve

SIZES = [
    (n, reach, wraps) for n in range(1, 24) for reach in (0, 1, 2, 4) for wraps in (False, True)
]


@pytest.mark.parametrize("wraps", [False, True])
def test_places_keep_neighbours_together_and_probes_keep_them_apart(wraps):
    """Each place is taken once, and no member is a neighbour of two of one probe."""
    seen = 0
    for n, reach, own in SIZES:
        if own is not wraps:
            continue
        bands = Bands(n, reach, wraps)
        assert sorted(map(bands.place, range(n))) == [*range(n)]
        for i in range(n):
            near = bands.neighbours(i)
            assert all(abs(bands.place(i) - bands.place(j)) <= bands.width for j in near)
            others = combinations({*near}, 2)
            assert all(bands.colour(j) != bands.colour(k) for j, k in others)
            seen += 1
        assert bands.colours <= 4 * reach + 1
    assert seen == 4 * sum(range(1, 24))


def draw(bands, parts, lanes):
    """Random slopes of coupled members, each component of all members, and two vectors."""
    rng, n = np.random.default_rng(bands.members), bands.members
    slopes = np.zeros((parts, n, parts, n, lanes))
    for i in range(n):
        for j in bands.neighbours(i):
            slopes[:, i, :, j] = rng.normal(size=(parts, parts, lanes))
    size = parts * n
    return slopes.reshape(size, size, lanes), *rng.normal(size=(2, size, lanes))


@pytest.mark.parametrize("wraps", [False, True])
@pytest.mark.parametrize(("n", "reach"), [(1, 1), (3, 1), (4, 2), (9, 1), (13, 2), (22, 3)])
def test_a_step_of_newton_is_that_of_the_whole_matrix(n, reach, wraps):
    """Against LAPACK; where a neighbour is left out it is another one."""
    bands = Bands(n, reach, wraps)
    slopes, middle, following = draw(bands, 2, 3)

    def apply(vector):
        return np.einsum("ijn,jn->in", slopes, vector)

    found = improve(middle, following, apply, bands)
    exact = np.stack(
        [
            middle[:, k]
            + np.linalg.solve(np.eye(2 * n) - slopes[..., k], (following - middle)[:, k])
            for k in range(3)
        ],
        axis=1,
    )
    scale = np.abs(exact).max()
    assert np.abs(found - exact).max() <= 1e-10 * scale
    if n > 2 * reach:
        short = improve(middle, following, apply, Bands(n, reach - 1, wraps))
        assert np.abs(short - exact).max() > 1e-3 * scale


def test_pivots_are_the_largest_of_each_lane():
    """A zero on the diagonal of one lane alone; a matrix of zeros has no solution."""
    rng, size, band = np.random.default_rng(3), 12, 2
    whole = np.triu(np.tril(rng.normal(size=(2, size, size)), band), -band)
    whole[0, 0, 0] = 0.0
    known = rng.normal(size=(size, 2))
    matrix = np.zeros((size, 3 * band + 1, 2))
    for i in range(size):
        for k in range(max(0, i - band), min(size, i + band + 1)):
            matrix[i, k - i + band] = whole[:, i, k]
    found = solve(matrix.copy(), known.copy(), band)
    for lane in range(2):
        assert np.abs(whole[lane] @ found[:, lane] - known[:, lane]).max() < 1e-12
    with np.errstate(invalid="ignore", divide="ignore"):
        assert not np.isfinite(solve(np.zeros(matrix.shape), known.copy(), band)).any()
