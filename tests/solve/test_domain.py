"""The domain of a system: its rows, what is refused at the start, and where a motion ends."""

import json
from io import StringIO
from math import acos, sqrt

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.system import Bound
from coadjoint.solve.tables import write_table
from coadjoint.systems import relativistic_particle, rigid_body
from tests.derive.test_newton import LINE
from tests.solve.domains import BALL, BENT, DISK, KEPLER, STONE, SUSLOV, built

#: Steps of 1e-10 and a bisection to 1e-12 of a step; a stone crosses a distance d in d/2 seconds.
CLOSE = 1e-9
UPRIGHT = {"Omega": [0, 0, 0], "Gamma": [0, 0.6, 0.8]}


def simulate(system, state, end, parameters=None, **options):
    """A trajectory by the NumPy kernel."""
    return system.simulate(state, (0, end), parameters, target="numpy", **options)


def test_rows_are_the_larger_side_minus_the_other():
    """The row of h > 0 is h, that of m >= g is m - g, for every member, in declared order."""
    stone = built(STONE)
    above, heavy = stone.DOMAIN
    assert above == Bound("above", "condition", strict=True, inputs=("h",))
    assert heavy == Bound("heavy", "condition", strict=False, inputs=("m", "g"))
    rows = stone.domain(np.array([[3.0, -2.0], [0, 0]]), {"m": 5.0, "g": 7.0}, target="numpy")
    assert rows.tolist() == [[3.0, -2.0], [-2.0, -2.0]]
    turned = built(STONE, ('"h > 0"', '"0 < h"'), ('"m >= g"', '"g <= m"'))
    found = turned.domain(np.array([[3.0, -2.0], [0, 0]]), {"m": 5.0, "g": 7.0}, target="numpy")
    assert found.tolist() == rows.tolist()


def test_a_momentum_that_the_iteration_does_not_reach_is_refused_before_any_work():
    """P = v - v^3 has v = 1/2 for p = 3/8, and no v near rest for p = 1; d2l/dv2 = 1 - 3 v^2."""
    folded = built(LINE, ("v^4/4 +", "-v^4/4 +"))
    (bound,) = folded.DOMAIN
    assert bound == Bound("v", "iteration", strict=True, inputs=("p", "a"))
    rows = folded.domain(np.array([[0.0, 0.0], [0.375, 1.0]]), target="numpy")
    assert rows[0].tolist() == pytest.approx([0.25, np.nan], rel=1e-14, nan_ok=True)
    said = r"finds no v of these momenta.*: the pivot of v in d2l/dxi2 is nan; .*p = 1"
    with pytest.raises(KernelArgumentError, match=said):
        simulate(folded, [0, 1], 1)


def test_a_motion_whose_velocity_an_iteration_finds_keeps_its_energy():
    """(3 v^2 + 1) v' = -q from q = 0, v = 2 on: 3 v^4/4 + v^2/2 + q^2/2 stays 14."""
    quartic = built(LINE)
    for method in ("taylor", "dop853"):
        run = simulate(quartic, [0, 10], 3, method=method)
        q, p, v = run["q"], run["p"], run["v"]
        assert v**3 + v == pytest.approx(p, rel=1e-12, abs=1e-12)
        assert 3 * v**4 / 4 + v**2 / 2 + q**2 / 2 == pytest.approx(14, rel=1e-9)


def test_a_momentum_that_no_velocity_has_is_refused_before_any_work():
    """Of p = v/sqrt(1 + v^2), v = p/sqrt(1 - p^2) has a value for p^2 < 1 alone."""
    bent = built(BENT)
    (bound,) = bent.DOMAIN
    assert bound == Bound("v", "transform", strict=True, inputs=("p",))
    rows = bent.domain(np.array([[0.0, 0.0], [0.5, 2.0]]), target="numpy")
    assert rows.tolist() == [[0.75, -3.0]]
    with pytest.raises(KernelArgumentError, match=r"no v has these momenta.* is -3; .*p = 2"):
        simulate(bent, [0, 2], 1)
    assert "argument of a root in v" in simulate(bent, [0, 0.5], 5).message


def test_a_transform_that_always_has_a_solution_is_no_bound():
    """Momenta of a relativistic particle may have any size."""
    assert relativistic_particle.system.DOMAIN == ()


def test_a_system_without_conditions_or_constraints_has_no_domain():
    """No function, no rows, and the shipped ones say so."""
    assert rigid_body.system.DOMAIN == ()
    assert "domain" not in rigid_body.system.functions


@pytest.mark.parametrize(
    "method", ["auto", "scipy:RK45", "scipy:Radau", "scipy:BDF", "scipy:LSODA"]
)
def test_a_falling_stone_ends_on_the_ground(method):
    """From h = 2 with g = 1 after 2 seconds with p = -2, at the last point above the ground."""
    found = simulate(built(STONE), [2, 0], 3, method=method)
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - 2) < CLOSE
    assert abs(found.final["p"] + 2) < CLOSE
    assert 0 < found.final["h"] < CLOSE
    assert f"above, h > 0, does not hold after t = {found.time_reached:.12g}" in found.message
    assert f"h = {found.final['h']:.6g}" in found.message


def test_without_its_guard_the_stone_goes_on_through_the_ground():
    """The end above is the guard's doing: at t = 3 the same stone is at h = 2 - 9/2."""
    found = simulate(built(STONE, ('above = "h > 0"', "")), [2, 0], 3)
    assert found.status == "OK"
    assert abs(found.final["h"] + 2.5) < CLOSE


def test_a_trajectory_that_ends_early_is_a_whole_solution():
    """Samples before the end as without it, then the end; drift, table and summary are finite."""
    free = simulate(built(STONE, ('above = "h > 0"', "")), [2, 0], 3, samples=31)
    found = simulate(built(STONE), [2, 0], 3, samples=31)
    assert len(found) == 20 + 1 + (free.time[20] < 2)
    assert np.abs(found.state[:, :20] - free.state[:, :20]).max() < CLOSE
    assert (np.diff(found.time) > 0).all()
    assert found.drift["energy"] < CLOSE
    assert all(np.isfinite(values).all() for values in (found.state, found.observables))
    assert json.loads(json.dumps(found.summary()))["status"] == "DOMAIN"
    write_table(found, table := StringIO())
    assert len([line for line in table.getvalue().splitlines() if line[0] != "#"]) == 1 + len(found)


@pytest.mark.parametrize("state", [[-1.0, 0.0], [0.0, 0.0]])
def test_a_start_outside_is_refused(state):
    """With the condition, the value and what it depends on; a strict 0 is outside."""
    with pytest.raises(KernelArgumentError, match=r"condition above, h > 0, does not") as caught:
        simulate(built(STONE), state, 1)
    assert f"h = {state[0]:g}: change one of them" in str(caught.value)
    assert (caught.value.found, caught.value.bound) == (state[0], "above")


def test_a_condition_on_parameters_alone_is_checked():
    """The bound m >= g holds at equality, and not beyond; the message has both values."""
    assert simulate(built(STONE), [2, 0], 1, {"m": 1.5, "g": 1.5}).status == "OK"
    with pytest.raises(KernelArgumentError, match=r"m >= g.* is -0\.5.*m = 1\.5, g = 2"):
        simulate(built(STONE), [2, 0], 1, {"m": 1.5, "g": 2.0})


def test_a_centre_of_mass_outside_its_ball_is_refused():
    """Chaplygin's ball with |chi| > r; at |chi| = r it may roll."""
    state = {"Omega": [1, 2, 3], "Gamma": [0, 0, 1]}
    with pytest.raises(KernelArgumentError, match=r"dot\(chi, chi\) <= r\^2") as caught:
        simulate(built(BALL), state, 1, {"chi": [0, 0, 2]})
    assert "chi3 = 2" in str(caught.value)
    assert caught.value.found == 1 - 4
    assert simulate(built(BALL), state, 0.1, {"chi": [0, 0, 1]}).status == "OK"


def test_a_fall_to_a_centre_ends_at_its_guard():
    """From r = 2 to c: t = 2 (acos(sqrt(c/2)) + sqrt(c/2 (1 - c/2))) with k = m = 1."""
    part = 0.1 / 2
    found = simulate(built(KEPLER), [2, 0], 4, {"closest": 0.1})
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - 2 * (acos(sqrt(part)) + sqrt(part * (1 - part)))) < CLOSE
    assert abs(found.final["p"] + sqrt(2 * (1 / 0.1 - 1 / 2))) < 10 * CLOSE


def test_a_fall_into_the_centre_itself_stops_finite_and_says_where():
    """No step passes the pole at r = 0: the reason has the state, and no number is infinite."""
    found = simulate(built(KEPLER), [2, 0], 4)
    assert found.status in ("STEP_UNDERFLOW", "NONFINITE")
    assert "near t = 3.14159; there the larger side of apart minus the other is" in found.message
    assert np.isfinite(found.state).all()
    assert np.isfinite(found.observables).all()


def test_a_disk_that_falls_flat_ends_above_the_plane():
    """At sin = 0.01, with I1 + m r^2 = 2 and the speed that the energy gives it."""
    found = simulate(built(DISK), UPRIGHT, 3)
    assert found.status == "DOMAIN"
    assert "tilted, Gamma1^2 + Gamma2^2 > margin, does not hold" in found.message
    assert abs(found.final["Gamma2"] - 0.01) < CLOSE
    assert abs(found.final["Omega1"] ** 2 - 2 * 9.81 * (0.6 - 0.01) / 2) < 100 * CLOSE
    assert np.isfinite(found.observables).all()


def test_with_a_guard_that_always_holds_the_disk_passes_through_the_plane():
    """With sin^2 > -1 nothing stops it where it lies flat, and it rises on the other side.

    The method of Taylor ends there: the square root of the formula has a branch point.
    """
    found = simulate(built(DISK), UPRIGHT, 1, {"margin": -1}, method="dop853")
    assert found.status == "OK"
    assert found.final["Gamma2"] < -0.1


def test_pivots_are_those_of_the_reduced_mass_matrix():
    """Leading minors of I + m (|s|^2 1 - s s^T), typed here, are products of the first pivots."""
    ball, source = built(BALL), np.random.default_rng(5)
    assert [(b.name, b.kind) for b in ball.DOMAIN[1:]] == [
        (f"dOmega{n}_dt", "acceleration") for n in (1, 2, 3)
    ]
    for _ in range(5):
        root, chi, gamma = source.normal(size=(3, 3)), source.normal(size=3), source.normal(size=3)
        inertia, m, r = root @ root.T, *source.uniform(0.5, 2, 2)
        s = r * gamma + chi
        mass = inertia + m * (s @ s * np.eye(3) - np.outer(s, s))
        parameters = {"I": inertia[np.triu_indices(3)], "m": m, "r": r, "chi": chi}
        state = {"Omega": [1, 2, 3], "Gamma": gamma}
        inside, *pivots = ball.domain(state, parameters, target="numpy")
        assert inside == pytest.approx(r * r - chi @ chi, rel=1e-12)
        minors = [np.linalg.det(mass[:n, :n]) for n in (1, 2, 3)]
        np.testing.assert_allclose(np.cumprod(pivots), minors, rtol=1e-9)
        assert min(pivots) > 0


def test_a_singular_mass_matrix_is_refused():
    """I = diag(1, 1, 3) but for I12 = 1, and no radius: nothing resists Omega = (1, -1, 0)."""
    singular = {"I": [1, 1, 0, 1, 0, 3], "r": 0, "chi": [0, 0, 0]}
    state = {"Omega": [1, 2, 3], "Gamma": [0, 0, 1]}
    with pytest.raises(KernelArgumentError, match="reduced mass matrix is singular") as caught:
        simulate(built(BALL), state, 1, singular)
    assert "the pivot of dOmega2_dt is 0; expected a finite value above 0" in str(caught.value)
    assert "I12 = 1" in str(caught.value)
    regular = singular | {"I": [1, 0.9, 0, 1, 0, 3]}
    assert simulate(built(BALL), state, 0.1, regular).status == "OK"


def test_an_indefinite_mass_matrix_is_refused():
    """I33 = -3 without radius: the third pivot is -3."""
    indefinite = {"I": [1, 0, 0, 2, 0, -3], "r": 0, "chi": [0, 0, 0]}
    with pytest.raises(KernelArgumentError, match=r"not positive.*pivot of dOmega3_dt is -3"):
        simulate(built(BALL), {"Omega": [1, 2, 3], "Gamma": [0, 0, 1]}, 1, indefinite)


def test_pivots_of_multipliers_have_their_sign_turned():
    """Of [[M, a], [a, 0]] with M = diag(1, 2, 3), a = (1, 2, 2), the last is -(1 + 4/2 + 4/3)."""
    suslov = built(SUSLOV)
    rows = dict(
        zip(
            [bound.name for bound in suslov.DOMAIN],
            suslov.domain([1, 0, 0], target="numpy").tolist(),
            strict=True,
        )
    )
    expected = {"dOmega1_dt": 1, "dOmega2_dt": 2, "dOmega3_dt": 3}
    assert rows == pytest.approx(expected | {"wheels_reaction": 1 + 4 / 2 + 4 / 3}, rel=1e-14)


def test_a_constraint_that_vanishes_is_refused():
    """With a = 0 its reaction is undetermined."""
    with pytest.raises(KernelArgumentError, match="wheels_reaction is undetermined"):
        simulate(built(SUSLOV), [1, 0, 0], 1, {"a": [0, 0, 0]})


def test_what_is_not_a_number_is_outside():
    """A pivot or side that overflows to NaN or infinity is refused, not passed over."""
    with pytest.raises(KernelArgumentError, match="is inf; expected a finite value above 0"):
        simulate(built(BALL), {"Omega": [1, 2, 3], "Gamma": [0, 0, 1e200]}, 1)
    with pytest.raises(KernelArgumentError, match="r of the parameters is nan"):
        simulate(built(BALL), {"Omega": [1, 2, 3], "Gamma": [0, 0, 1]}, 1, {"r": np.nan})


def test_beyond_the_domain_the_kernel_itself_asks_nothing():
    """A batch gets its rates everywhere, infinite at r = 0, and its rows tell the members."""
    states = np.array([[1.0, 0.0, -1.0], [0, 0, 0]])
    rates = built(KEPLER).rhs(states, target="numpy")
    assert rates[1].tolist() == [-1.0, -np.inf, -1.0]
    assert built(KEPLER).domain(states, target="numpy").tolist() == [[1.0, 0.0, -1.0]]
