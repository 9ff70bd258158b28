"""What a kernel of a constrained motion computes, in which order and under which names."""

import dataclasses
from fractions import Fraction

import pytest

from coadjoint.derive.mechanics.constrained import start_motion
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.derive.mechanics.solver import Solve, solve_in_kernel, solver_names
from coadjoint.exact import Field
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, derived

BLADE = 'blade = "w == y*u"'


def definitions(text, *changes, route="nonholonomic"):
    """Names and values in the order of the kernel."""
    return dict(derived(text, *changes)[route].exact.definitions)


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
@pytest.mark.parametrize("text", [PARTICLE, SLEIGH, BALL, PENDULUM], ids=lambda t: t.split('"')[1])
def test_definitions_come_before_they_are_used(text, route):
    """Each rests on the state, on parameters and on what stands above it."""
    equations = derived(text)[route]
    field, seen = equations.setting.field, set()
    own = set(definitions(text, route=route))
    for name, value in equations.exact.definitions:
        assert not (field.reach(value) & own) - seen, name
        assert name not in seen
        seen.add(name)
    assert {rate_name(name) for name in equations.distribution.independent} <= seen


def test_the_ball_computes_in_the_order_of_a_careful_hand():
    """s, Y = Omega x s, dGamma/dt, ds/dt = r dGamma/dt, c = Omega x ds/dt, then the solve."""
    equations = derived(BALL)["nonholonomic"]
    known, f = definitions(BALL), equations.setting.field
    s, ds = (
        [f["r"] * f[name.format(n)] + rest for n, rest in zip((1, 2, 3), offset, strict=True)]
        for name, offset in (
            ("Gamma{}", [f[f"chi{n}"] for n in (1, 2, 3)]),
            ("dGamma{}_dt", [f.zero] * 3),
        )
    )
    place = next(n for n in (1, 2, 3) if f.is_zero(known[f"_b{n}"] - s[2]))
    assert f.is_zero(known[f"_e{place}"] - ds[2])
    assert f.is_zero(f.substitute(known["Y1"], known) - (f["Omega2"] * s[2] - f["Omega3"] * s[1]))
    assert f.is_zero(
        f.substitute(known["_c1"], known) - (f["Omega2"] * ds[2] - f["Omega3"] * ds[1])
    )
    assert known["dGamma1_dt"] == f["Gamma2"] * f["Omega3"] - f["Gamma3"] * f["Omega2"]
    names = list(known)
    order = ["_b1", "Y1", "dGamma1_dt", "_e1", "_c1", "_d1", "dOmega1_dt", "dY1_dt"]
    assert sorted(order, key=names.index) == order
    assert names[-1].startswith("rolling_reaction")


def test_a_position_that_a_velocity_moves_needs_no_name():
    """dx/dt = u, so only vectors of an algebra have rates with names."""
    assert not {"dx_dt", "dy_dt", "dz_dt"} & set(definitions(PARTICLE))
    equations = derived(PARTICLE)["nonholonomic"]
    f = equations.setting.field
    assert equations.exact.rates == (f["u"], f["v"], f["w"], f["du_dt"], f["dv_dt"])
    assert definitions(PARTICLE)["_c1"] == f["u"] * f["v"]  # dy/dt u


def test_entries_of_the_moving_part_are_named_too():
    """On w = y u + sin(x): beta = sin(x) moves with cos(x) u, and c is u v + cos(x) u."""
    equations = derived(PARTICLE, (BLADE, 'blade = "w == y*u + sin(x)"'))["nonholonomic"]
    f, known = equations.setting.field, dict(equations.exact.definitions)
    sin, cos = (f.call(name, f["x"]) for name in ("sin", "cos"))
    assert known["_b1"] == sin
    assert f.is_zero(known["_e1"] - cos * f["u"])
    assert f.is_zero(equations.close(f["_c1"]) - (f["u"] * f["v"] + cos * f["u"]))


def test_kept_constraints_are_differentiated():
    """X u + y v = 0 gives x du/dt + y dv/dt = -(u^2 + v^2), beside M, in a symmetric matrix."""
    equations = derived(PENDULUM)["nonholonomic"]
    f = equations.setting.field
    motion = start_motion(equations.setting)
    assert motion.of_kept() == (((f["x"], f["y"]),), (-(f["u"] ** 2) - f["v"] ** 2,))
    (solve,) = equations.exact.solves
    assert solve.matrix == (
        (f["m"], f.zero, f["x"]),
        (f.zero, f["m"], f["y"]),
        (f["x"], f["y"], f.zero),
    )
    assert list(solve.names) == ["du_dt", "dv_dt", "_u1"]
    assert equations.exact.definitions[-1] == ("rod_reaction", -f["_u1"])


def saddle():
    """``[[2, 0, 3], [0, 5, 4], [3, 4, 0]] (x, y, u) = (1, 2, 7)``, by symbols at its corners."""
    block, names = (0, 1, 2), ("x", "y", "u")
    field = Field([*names, *solver_names(block)])
    rows = ((2, 0, 3), (0, 5, 4), (3, 4, 0))
    matrix = tuple(field.vector(row) for row in rows)
    return field, Solve(matrix, field.vector((1, 2, 7)), block, names)


def test_the_solve_of_a_saddle():
    """The last pivot is -(9/2 + 16/5) = -77/10, and (x, y, u) = (97, 62, -39)/77."""
    field, solve = saddle()
    lines = solve_in_kernel(field, solve)
    known = {}
    for name, value in lines:
        known[name] = field.substitute(value, known)
    found = {name: field.as_number(value) for name, value in known.items()}
    assert found["_d3"] == Fraction(-77, 10)
    x, y, u = (found[name] for name in "xyu")
    assert (2 * x + 3 * u, 5 * y + 4 * u, 3 * x + 4 * y) == (1, 2, 7)
    assert u == Fraction(-39, 77)
    assert not any(map(bool, solution_defects(field, solve, dict(lines))))


def test_a_saddle_of_the_other_sign_is_seen():
    """With A in the place of A^T there is no symmetric matrix: the defects say so."""
    field, solve = saddle()
    lines = dict(solve_in_kernel(field, solve))
    turned = dataclasses.replace(solve, matrix=(*solve.matrix[:2], field.vector((-3, -4, 0))))
    assert any(map(bool, solution_defects(field, turned, lines)))


#: v stays zero, so that no rate needs the known side of its equation; w goes with it.
RESTING = """
title = "A particle that rests along y"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "y" }
w = { role = "velocity", of = "z" }
[parameters]
m = { positive = true, default = 1 }
b = { default = 3 }
[lagrangian]
l = "m*(u^2 + v^2 + w^2)/2 - b*x"
[constraints]
slide = "w == cos(x)*v"
rest = "2*v == 0"
"""


def test_a_residual_may_name_what_no_rate_needs():
    """By hand v' = 0 and u' = -b/m; the known side of v, with cos x in it, has a Jacobian yet."""
    equations = derived(RESTING)["nonholonomic"]
    known = dict(equations.exact.definitions)
    f = equations.setting.field
    assert known["dv_dt"] == 0
    assert f.substitute(f.substitute(known["_z1"], known), known) == -f["b"] / f["m"]
    assert known["du_dt"] == f["_z1"]
    for program in lower(equations).values():
        check_inverse(equations, program)
