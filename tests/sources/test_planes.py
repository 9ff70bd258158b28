"""Veselova's problem in four dimensions: Newton with multipliers, three dimensions, wrong twins."""

from fractions import Fraction
from itertools import combinations

import sympy

from coadjoint.lower.evaluation import run
from coadjoint.prove import Verdict
from tests.sources import classical, planes
from tests.sources.components import cross, product, turned
from tests.specs import lowered, shipped, spec, verdicts_of

U = (Fraction(1), Fraction(-2), Fraction(3, 2))
MOMENTS = tuple(map(Fraction, (3, 4, 5, 7, 6, 2)))
#: A rotation of four dimensions: its rows are axes of space, seen from the body.
AXES = [
    [Fraction(x, 25) for x in row]
    for row in ((-16, -17, -8, -4), (-7, 16, -16, -8), (8, -4, 4, -23), (16, -8, -17, 4))
]


def rates(state, moments):
    """What the kernel computes, in fractions."""
    program = lowered("veselova_so4")["rhs"]
    names = (*planes.STATE, *planes.PARAMETERS)
    return run(program, dict(zip(names, (*state, *moments), strict=True)), Fraction, None)


def seen_from_space(matrix):
    """``E_i . X E_j``."""
    return product(product(AXES, matrix), turned(AXES))


def newton():
    """``dM/dt = [M, Omega] + sum of lambda_ij E_i ^ E_j`` with ``omega_ij = 0`` for 1 < i < j.

    The six components of dOmega/dt and the three multipliers are solved for at once. As
    ``dE_k/dt = -Omega E_k``, the rate of ``omega_ij`` is ``E_i . dOmega/dt E_j``.
    """
    body = planes.Planes((*U, *AXES[0], *AXES[1]), MOMENTS)
    forbidden = list(combinations((1, 2, 3), 2))
    unknown = sympy.symbols("w:6")
    multipliers = sympy.symbols("lambda:3")
    moved = [[sympy.Integer(0)] * 4 for _ in range(4)]
    for (i, j), x in zip(planes.PAIRS, unknown, strict=True):
        moved[i][j], moved[j][i] = x, -x
    push = planes.added(
        *(
            planes.scaled(x, planes.wedge(AXES[i], AXES[j]))
            for (i, j), x in zip(forbidden, multipliers, strict=True)
        )
    )
    torque = body.gained(moved)
    equations = [torque[i][j] - push[i][j] for i, j in planes.PAIRS]
    held = seen_from_space(moved)
    found = sympy.solve([*equations, *(held[i][j] for i, j in forbidden)], [*unknown, *multipliers])
    values = [Fraction(str(found[x])) for x in (*unknown, *multipliers)]
    return body, values[:6], values[6:]


def test_the_kernel_moves_as_newton_with_multipliers():
    """Exactly, where Gamma is an axis of space and nothing turns in the planes of the others."""
    body, (w12, w13, w14, w23, w24, w34), multipliers = newton()
    space = seen_from_space(body.omega)
    assert all(space[i][j] == 0 for i, j in combinations((1, 2, 3), 2))
    assert all(multipliers)
    found = rates((*U, *AXES[0], *AXES[1]), MOMENTS)
    assert found[:3] == [w34 - w12, -w24 - w13, w23 - w14]  # y + x


def test_momenta_of_space_stay_in_the_planes_with_gamma_alone():
    """``dm_1j/dt = 0``; the torque turns momentum in the other planes."""
    body, *_ = newton()
    torque = seen_from_space(body.accelerate()[1])
    assert [torque[0][j] for j in (1, 2, 3)] == [0, 0, 0]
    assert all(torque[i][j] != 0 for i, j in combinations((1, 2, 3), 2))


def test_a_body_that_stays_in_three_dimensions_moves_as_there():
    """With the fourth axis at rest: ``Pi' = Pi x Omega + lambda Gamma``, ``Omega . Gamma = 0``."""
    gamma = [Fraction(1, 3), Fraction(-2, 3), Fraction(2, 3)]
    w1, w2, w3 = omega = cross(gamma, [Fraction(3), Fraction(1), Fraction(-2)])
    x1, x2, _, _, _, y3 = MOMENTS
    *turning, g1, g2, g3 = classical.veselova_rates([*omega, *gamma], [y3, x2, x1])
    found = rates((w3, -w2, -w1, *gamma, 0, 0, 0, 0, 0), MOMENTS)
    assert found[:3] == [turning[2], -turning[1], -turning[0]]
    assert found[3:] == [g1, g2, g3, 0, 0, 0, 0, 0]
    assert all(turning)


def test_planes_with_an_axis_of_the_body_are_suslovs_problem():
    """The wrong twin: the energy stays, and the momentum of space does not."""
    text = shipped("veselova_so4").path.read_text(encoding="utf-8")
    declared = spec(text, ("-rotate(Gamma, U)/dot(Gamma, Gamma)", "-U"))
    found = verdicts_of(declared)
    assert found["the energy is conserved"] is Verdict.PROVED
    assert found["m is conserved"] is Verdict.REFUTED
