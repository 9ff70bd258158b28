"""Hamel's equations: the gyroscopic force that the constrained Lagrangian misses."""

import pytest

from coadjoint.prove.constrained import ConstrainedRates
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, derived, motion


def fields_of(equations):
    """The columns D_k of B."""
    return list(zip(*equations.distribution.B, strict=True))


def test_the_brackets_of_the_particle_leave_its_distribution():
    """D1 = d/dx + y d/dz and D2 = d/dy: [D1, D2] = -d/dz."""
    equations = derived(PARTICLE)["hamel"]
    one, two = fields_of(equations)
    f = equations.setting.field
    assert (one, two) == ((f.one, f.zero, f["y"]), (f.zero, f.one, f.zero))
    assert equations.distribution.frame.bracket(one, two) == (0, 0, -1)


def test_the_constrained_lagrangian_alone_gives_another_motion():
    """Of l_c = m ((1 + y^2) u^2 + v^2)/2, d/dt dl_c/du = 0 has -2 y u v: twice the right one."""
    of = motion(PARTICLE, route="hamel")
    (y, u, v) = (of.field[name] for name in "yuv")
    found = of.value(of.field["du_dt"])
    assert of.field.is_zero(found * (1 + y**2) + y * u * v)
    alone = -2 * y * u * v / (1 + y**2)
    gyroscopic = y * u * v / (1 + y**2)
    assert of.field.is_zero(found - (alone + gyroscopic))
    assert not of.field.is_zero(found - alone)


@pytest.mark.parametrize(
    "text", [PARTICLE, SLEIGH, SUSLOV, BALL, PENDULUM], ids=lambda t: t.split('"')[1]
)
def test_both_roads_solve_the_same_equations(text):
    """B^T M B and the right side, entry by entry, though one never sees l_c and the other not M."""
    routes = derived(text)
    projected, hamel = (
        [
            [*map(equations.close, (*(e for row in solve.matrix for e in row), *solve.known))]
            for solve in equations.exact.solves
        ]
        for equations in (routes["nonholonomic"], routes["hamel"])
    )
    f = routes["hamel"].setting.field
    for one, two in zip(projected, hamel, strict=True):
        assert all(f.is_zero(a - b) for a, b in zip(one, two, strict=True))
    assert any(entry != 0 for entry in hamel[0])


def test_the_sleigh_is_driven_by_the_bracket_of_turning_and_gliding():
    """[D_omega, D_v] = [J, P1] = P2, across the blade, where the momentum is m a omega."""
    equations = derived(SLEIGH)["hamel"]
    found, f = equations.distribution, equations.setting.field
    assert found.frame.velocities == ("omega", "v", "u")
    turning, gliding = fields_of(equations)
    assert found.frame.bracket(turning, gliding) == (0, 0, 1)
    of = ConstrainedRates(equations)
    assert of.field.is_zero(of.value(f["dv_dt"]) - f["a"] * f["omega"] ** 2)
