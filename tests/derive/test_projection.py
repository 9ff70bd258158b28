"""Projection: the nearest state by hand, in the kinetic metric, and lowering undone."""

import dataclasses
from fractions import Fraction

import pytest

from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Negate
from tests.constrained import CYLINDER, PARTICLE, PENDULUM, ROUND, STRAIGHT, SUSLOV, derived

#: Two masses, so that the least kinetic energy is not the least length.
UNEVEN = ('"m*(u^2 + v^2)/2 - m*g*y"', '"m*u^2/2 + m*g*v^2/2"')
AFFINE = ('"x*u + y*v == 0"', '"x*u + y*v == g"')
POINT = {name: Fraction(n, 7) for name, n in zip("xyuvmg", (3, 4, 5, -2, 1, 9), strict=True)}


def nearest(equations, point=POINT):
    """The projected state at a point."""
    return Reference(equations).evaluate("projection", point, Fraction, None)


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
@pytest.mark.parametrize("changes", [(), (AFFINE,), (UNEVEN,), (UNEVEN, AFFINE)])
def test_the_change_is_a_multiple_of_the_normal_over_the_masses(route, changes):
    """From (u, v) by -R (x/m1, y/m2)/(x^2/m1 + y^2/m2), R = x u + y v - b; (x, y) stays."""
    x, y, u, v, m, g = (POINT[name] for name in "xyuvmg")
    masses = (m, m * g) if UNEVEN in changes else (m, m)
    residual = x * u + y * v - (g if AFFINE in changes else 0)
    normal = (x / masses[0], y / masses[1])
    share = residual / (x * normal[0] + y * normal[1])
    expected = [x, y, u - share * normal[0], v - share * normal[1]]
    found = nearest(derived(PENDULUM, *changes)[route])
    assert found == expected
    assert found[2:] != [u, v]


def test_a_projected_state_stays():
    """Exactly, and only on the constraints does a state stay."""
    equations = derived(PENDULUM, UNEVEN, AFFINE)["nonholonomic"]
    once = nearest(equations)
    assert nearest(equations, {**POINT, **dict(zip("xyuv", once, strict=True))}) == once
    assert once != [POINT[name] for name in "xyuv"]


def test_a_product_of_inertia_carries_the_change_over():
    """With b turn1 spin in the energy, spin loses 3/2 and turn1 gains 3/2 b/I1; turn2 stays.

    The constraint is 2 spin = 3 here; written so, it gives no velocity.
    """
    point = dict.fromkeys(("turn1", "turn2", "spin"), Fraction(3))
    point |= {
        name: Fraction(n) for name, n in zip(("I1", "I2", "I3", "b"), (7, 11, 13, 2), strict=True)
    }
    found = nearest(derived(SUSLOV, ('"spin == 0"', '"2*spin == 3"'))["nonholonomic"], point)
    assert found == [3 + Fraction(3, 7), 3, Fraction(3, 2)]


def test_motions_that_keep_nothing_have_no_projection():
    """Where each constraint gives a velocity every state is on it."""
    equations = derived(PARTICLE)["nonholonomic"]
    assert equations.projection is None
    assert "projection" not in lower(equations)


def test_lowering_a_projection_is_undone_exactly():
    """The Program gives the state back, and one component of the wrong sign is seen."""
    equations = derived(PENDULUM, UNEVEN, AFFINE)["nonholonomic"]
    program = lower(equations)["projection"]
    check_inverse(equations, program)
    assert program.shape == (4,)
    assert [output.label for output in program.outputs] == list("xyuv")
    *others, last = program.outputs
    spoiled = dataclasses.replace(
        program, outputs=(*others, dataclasses.replace(last, value=Negate(last.value)))
    )
    with pytest.raises(CrossCheckError, match="lowering changed projection") as caught:
        check_inverse(equations, spoiled)
    assert caught.value.output == "v"


def test_a_projection_solves_for_no_acceleration():
    """Its lines are those of the matrix and of the new right side alone."""
    program = lower(derived(PENDULUM)["nonholonomic"])["projection"]
    names = {statement.name for statement in program.statements}
    assert {"_d3", "_y3", "_u1"} <= names
    assert not names & {"_y1", "_z1", "du_dt", "dv_dt"}


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_a_line_without_a_force_is_reached_all_the_same(route):
    """From (u, v) by -(u + k v) (1, k)/(1 + k^2); nothing accelerates, and no force is needed."""
    point = {name: Fraction(n) for name, n in zip("xyuvmk", (1, 2, 7, 5, 3, 2), strict=True)}
    equations = derived(STRAIGHT)[route]
    share = Fraction(7 + 2 * 5, 1 + 2**2)
    assert nearest(equations, point) == [1, 2, 7 - share, 5 - 2 * share]
    assert all(equations.numbers[name] == 0 for name in ("du_dt", "dv_dt", "_u1"))


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_a_gear_on_a_round_body_is_reached(route):
    """From w by -(3 w1 - 2 w2) (3, -2, 0)/13; the free body has no acceleration."""
    point = {"w1": Fraction(5), "w2": Fraction(-1), "w3": Fraction(4)}
    share = Fraction(3 * 5 + 2, 13)
    assert nearest(derived(ROUND)[route], point) == [5 - 3 * share, -1 + 2 * share, 4]


@pytest.mark.parametrize(
    "text", [STRAIGHT, ROUND, CYLINDER, PENDULUM], ids=lambda t: t.split('"')[1]
)
def test_no_name_of_a_projection_is_defined_twice(text):
    """Its definitions are those on which matrix and residuals rest, then its own solve."""
    equations = derived(text)["nonholonomic"]
    names = [name for name, _ in equations.projection.exact.definitions]
    assert len({*names}) == len(names) > 0
    check_inverse(equations, lower(equations)["projection"])


def test_a_ball_in_an_upright_cylinder_keeps_its_turn():
    """du/dt = 0: only along the cylinder does weight act; the projected state stays so."""
    equations = derived(CYLINDER)["nonholonomic"]
    assert equations.numbers["du_dt"] == equations.numbers["ds3_dt"] == 0
    assert "dw_dt" not in equations.numbers
