"""A rolling body that the plane would have to pull leaves it, and its simulation ends there."""

from math import sqrt

import pytest

from coadjoint.derive import derive
from coadjoint.derive.domain import bounds
from coadjoint.errors import KernelArgumentError, SpecError
from tests.solve.domains import BALL, built
from tests.specs import spec

GUARD = ('inside = "', 'on_plane = "dot(Gamma, rolling_reaction) + m*g >= 0"\ninside = "')
#: A sphere of equal moments 2/5, mass and radius 1, with its centre of mass 1/2 off its centre.
OFF = {"I": [0.4, 0, 0, 0.4, 0, 0.4], "chi": [0, 0, 0.5]}
G = 9.81


def rolling(w, up):
    """Rolling about the first axis with the centre of mass at the top or the bottom."""
    return {"Omega": [w, 0, 0], "Gamma": [0, 0, 1 if up else -1]}


def test_the_plane_pushes_until_the_centre_of_mass_falls_faster_than_g():
    """At the top z = r + l cos(phi) has z'' = -l w^2, so that N = m (g - l w^2)."""
    ball, limit = built(BALL, GUARD), sqrt(G / 0.5)
    place = [bound.name for bound in ball.DOMAIN].index("on_plane")
    for factor in (0.5, 0.99, 1.01):
        rows = ball.domain(rolling(factor * limit, up=True), OFF, target="numpy")
        assert abs(rows[place] - G * (1 - factor**2)) < 1e-12
    with pytest.raises(KernelArgumentError, match=r"on_plane, .*rolling_reaction.* does not hold"):
        ball.simulate(rolling(1.01 * limit, up=True), (0, 1), OFF, target="numpy")


def test_a_ball_that_rolls_too_fast_leaves_the_plane():
    """It ends with a finite state, pushed no more; slower it rolls on, unguarded it would go on.

    From 13/20 w^2 = 53/20 w_top^2 + 4 g l the top is passed with l w_top^2 > g if w > 10.5.
    """
    ball = built(BALL, GUARD)
    thrown = ball.simulate(rolling(12, up=False), (0, 2), OFF, target="numpy")
    assert thrown.status == "DOMAIN"
    place = [bound.name for bound in ball.DOMAIN].index("on_plane")
    rows = ball.domain(thrown.state[:, -1], OFF, target="numpy")
    assert 0 <= rows[place] < 1e-6
    assert "on_plane" in thrown.message
    assert ball.simulate(rolling(7, up=False), (0, 2), OFF, target="numpy").status == "OK"
    bound_to = built(BALL).simulate(rolling(12, up=False), (0, 2), OFF, target="numpy")
    assert bound_to.status == "OK"


def test_a_condition_knows_what_a_reaction_depends_on():
    """The reaction is computed from all of the state, through the solve."""
    found = {bound.name: bound for bound, _ in bounds(derive(spec(BALL, GUARD)))}
    assert {"Omega1", "Omega3", "Gamma1", "Gamma3", "m", "chi3"} <= set(found["on_plane"].inputs)


def test_a_reaction_that_no_constraint_has_is_not_declared():
    """Only constraints have reactions."""
    with pytest.raises(SpecError, match="'sliding_reaction' is not declared"):
        spec(BALL, ('inside = "', 'a = "sliding_reaction[1] > 0"\ninside = "'))
