"""Crossings of known functions: single, double and triple roots, at any place of any step."""

import numpy as np
import pytest

from coadjoint.solve import crossings, roots
from coadjoint.solve.roots import find_knots, find_roots
from tests.solve.exact_steps import find_crossings

PI = np.pi
#: Steps on whose ends roots fall, and steps on whose ends they do not.
EDGES = {
    "between": [0, 1, 2, 3, 4, 5, 6.5, 7.5, 8.2, 9, 10, 11, 12, 12.8],
    "on ends": [0, PI / 2, PI, 2 * PI, 5 * PI / 2, 3 * PI, 4 * PI, 12.8],
    "long": [0, 4.2, 8.4, 12.8],
}
#: Functions of time, their roots up to 12.8, and the directions of these.
CASES = {
    "single": (np.sin, [PI, 2 * PI, 3 * PI, 4 * PI], [-1, 1, -1, 1]),
    "double": (lambda t: np.sin(t) - 1, [PI / 2, 5 * PI / 2], [0, 0]),
    # rounding has put the double root above zero: two roots 1e-5 apart are one touch
    "double, above": (lambda t: np.sin(t) - 1 + 2e-11, [PI / 2, 5 * PI / 2], [0, 0]),
    "double, below": (lambda t: np.sin(t) - 1 - 2e-11, [PI / 2, 5 * PI / 2], [0, 0]),
    "two": (lambda t: (t - 3) * (t - 3.001), [3, 3.001], [-1, 1]),
    "triple": (lambda t: (t - 3) ** 3, [3], [1]),
    "fourfold": (lambda t: (t - 5) ** 4, [5], [0]),
    "near": (lambda t: np.sin(t) - 1 - 1e-7, [], []),
    "pole": (lambda t: 1 / (t - 3.3), [], []),
    "decay": (lambda t: np.exp(-3 * t), [], []),
    "zero": (lambda t: 0 * t, [], []),
    "noise": (lambda t: 1e-14 * np.sin(1e9 * t), [], []),
    "kink": (lambda t: np.abs(t - 3.3), [3.3], [0]),
    "fast": (lambda t: np.sin(40 * t + 0.1), (np.arange(1, 164) * PI - 0.1) / 40, None),
    "undefined before": (lambda t: np.sqrt(t - 2) - 1, [3], [1]),
}


@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("case", CASES)
def test_roots_of_known_functions_are_found(case, edges):
    """Each once, wherever steps end and however many come in a call, with the same bits."""
    function, times, directions = CASES[case]
    found = find_crossings(lambda t, _: function(t), EDGES[edges])
    assert len(found.time) == len(times), found.time
    # a fourfold root is as flat as its tolerance is wide, 1e-10^(1/4), a kink as narrow
    flat = {"fourfold": 5e-3, "kink": 2e-10}.get(case, 1e-7 if "double" in case else 1e-12)
    assert np.abs(found.time - times).max(initial=0) < flat
    if directions is not None:
        assert found.direction.tolist() == directions
    for few in (1, 2):
        again = find_crossings(lambda t, _: function(t), EDGES[edges], at_a_time=few)
        assert again.time.tobytes() == found.time.tobytes()
        assert again.state.tobytes() == found.state.tobytes()
        assert again.direction.tolist() == found.direction.tolist()


def test_a_start_on_zero_is_no_crossing_and_an_end_is_one():
    """From pi to 3 pi the sine crosses zero at 2 pi, and at the end."""
    found = find_crossings(lambda t, _: np.sin(t), [PI, 5, 3 * PI])
    assert np.abs(found.time - [2 * PI, 3 * PI]).max() < 1e-12
    assert found.direction.tolist() == [1, -1]
    assert not find_crossings(lambda t, _: np.sin(t) - 1, [PI / 2, 3]).time.size


def test_members_have_as_many_roots_as_their_functions():
    """One, two and three times as fast, and none; in any grouping and among any neighbours."""
    rate = np.array([1.0, 2.0, 3.0, 0.01])
    edges = EDGES["between"]
    found = find_crossings(lambda t, m: np.sin(rate[m] * t + 0.1), edges, 4)
    assert np.bincount(found.member, minlength=4).tolist() == [4, 8, 12, 0]
    turns = (rate[found.member] * found.time + 0.1) / PI
    assert np.abs(turns - np.round(turns)).max() < 1e-13
    for member in range(4):
        alone = find_crossings(lambda t, _, m=member: np.sin(rate[m] * t + 0.1), edges, 1, 1)
        assert alone.time.tobytes() == found.time[found.member == member].tobytes()


def test_a_search_by_signs_alone_misses_the_double_root(monkeypatch):
    """Spoiled: a finder that looks at the ends of steps alone. The cases above see it."""

    def look_at_ends(function, count, degree, band_of):
        rows = np.repeat(np.arange(count), 2)
        part = np.tile([0.0, 1.0], count)
        value, size = function(np.arange(count))(np.tile([[0.0], [1.0]], count))
        knots = roots.Knots(rows, part, value.T.ravel(), rows)
        return knots, band_of(size.max(axis=0))

    monkeypatch.setattr(crossings, "find_knots", look_at_ends)
    edges = EDGES["between"]
    assert len(find_crossings(lambda t, _: np.sin(t), edges).time) == 4
    for case in ("double", "two", "fast"):
        function, times, _ = CASES[case]
        assert len(find_crossings(lambda t, _, f=function: f(t), edges).time) < len(times)


def test_a_piece_that_is_called_monotone_is_so():
    """Between two knots of a piece a polynomial of the degree has no turning point inside."""
    source = np.random.default_rng(5)
    wild = source.normal(size=(200, 14))

    def function(rows):
        def evaluate(part):
            found = np.zeros(part.shape)
            for k in range(13, -1, -1):
                found = found * part + wild[rows, k]
            return found, np.full(part.shape, 10.0)

        return evaluate

    knots, _ = find_knots(function, 200, 13, lambda size: 1e-12 * size)
    assert (np.bincount(knots.row, minlength=200) >= 2).all()
    checked = 0
    for place in np.flatnonzero(knots.piece[1:] == knots.piece[:-1]):
        ends = knots.part[place : place + 2]
        inner = np.linspace(*ends, 21)[:, np.newaxis]
        values = function(knots.row[place : place + 1])(inner)[0][:, 0]
        steps, signs = np.diff(values), np.sign(values)
        monotone = (steps >= -1e-12).all() or (steps <= 1e-12).all()
        changes = int((signs[1:] != signs[:-1]).sum())
        assert monotone or changes == 0 or (changes == 1 and signs[0] == -signs[-1])
        checked += monotone
    assert checked > 100


def test_roots_are_found_to_the_last_digits():
    """Of x^3 - c, whose root is known; where an end is the root it is that end."""
    c = np.array([2.0, 0.1, 7.0, 8.0, 0.0])

    def cube(active):
        return lambda x: x**3 - c[active]

    left, right = np.zeros(5), np.full(5, 2.0)
    found, values = find_roots(cube, left, right, left**3 - c, right**3 - c, np.zeros(5))
    assert np.abs(found - np.cbrt(c)).max() < 1e-15
    assert values.tolist() == (found**3 - c).tolist()
    assert found[3:].tolist() == [2.0, 0.0]
