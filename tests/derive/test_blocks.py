"""Quantities on which one block of the algebra acts, by the block's own representation."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.algebra.catalogue import representation_on_block
from coadjoint.derive import derive
from coadjoint.errors import AlgebraError, SpecError
from tests.specs import prove_claims, spec

#: Two tops whose verticals are coupled; the second has an attitude as well.
TOPS = """
title = "Two tops"
routes = ["euler-poincare", "lie-poisson", "hamilton-pontryagin", "clebsch"]
[algebra]
direct_sum = ["so(3)", "so(3)"]
[variables]
O = { role = "velocity", block = "rotation_1" }
W = { role = "velocity", block = "rotation_2" }
Pi = { role = "momentum", block = "rotation_1" }
M = { role = "momentum", block = "rotation_2" }
G = { role = "advected", representation = "vector", block = "rotation_1" }
H = { role = "advected", representation = "vector", block = "rotation_2" }
q = { role = "advected", representation = "quaternion", block = "rotation_2" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
J = { shape = [3], positive = true, default = [1, 2, 4] }
k = { default = 1 }
[lagrangian]
l = "dot(O, diag(I)*O)/2 + dot(W, diag(J)*W)/2 - k*G3*H1"
[claims]
casimirs = ["dot(G, G)", "dot(H, H)", "dot(q, q)"]
"""


def cross(a, b):
    """The vector product, typed by hand."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def test_each_body_turns_its_own_quantities():
    """dPi/dt = Pi x O + (dl/dG) x G, dG/dt = G x O; dq/dt = q [0, W]/2."""
    equations = derive(spec(TOPS))
    field = equations.setting.field

    def vector(name):
        return [field[f"{name}{n}"] for n in (1, 2, 3)]

    k, zero = field["k"], field.zero
    Pi, M, Omega, W, G, H = map(vector, ("Pi", "M", "O", "W", "G", "H"))
    slopes = [zero, zero, -k * H[0]], [-k * G[2], zero, zero]
    q0, q1, q2, q3 = (field[f"q{n}"] for n in range(4))
    w1, w2, w3 = W
    expected = [
        *(a + b for a, b in zip(cross(Pi, Omega), cross(slopes[0], G), strict=True)),
        *(a + b for a, b in zip(cross(M, W), cross(slopes[1], H), strict=True)),
        *cross(G, Omega),
        *cross(H, W),
        -(q1 * w1 + q2 * w2 + q3 * w3) / 2,
        (q0 * w1 + q2 * w3 - q3 * w2) / 2,
        (q0 * w2 + q3 * w1 - q1 * w3) / 2,
        (q0 * w3 + q1 * w2 - q2 * w1) / 2,
    ]
    assert len(equations.exact.rates) == len(expected)
    for rate, by_hand in zip(equations.exact.rates, expected, strict=True):
        assert field.is_zero(rate - by_hand)


def test_all_routes_agree_and_the_wrong_block_is_refuted():
    """G . H is a Casimir exactly if the same body turns both."""
    certificate = prove_claims(spec(TOPS))
    assert certificate.holds, str(certificate)
    assert sum(claim.kind == "equivalence" for claim in certificate.claims) >= 3
    mixed = [('casimirs = ["dot(G, G)"', 'casimirs = ["dot(G, H)", "dot(G, G)"')]
    assert not prove_claims(spec(TOPS, *mixed)).holds
    both = ('H = { role = "advected", representation = "vector", block = "rotation_2" }', "")
    same = 'G = { role = "advected", representation = "vector", block = "rotation_1" }'
    together = (same, f"{same}\n{same.replace('G =', 'H =')}")
    assert prove_claims(spec(TOPS, both, together, *mixed)).holds


def test_the_rest_of_the_algebra_acts_as_zero():
    """Translations of se(3) leave vectors of its rotations alone."""
    turning = representation_on_block(algebra_by_name("se(3)"), (0, 1, 2), "vector")
    assert turning.act([0, 0, 1, 5, 6, 7], [1, 2, 0]) == (-2, 1, 0)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ('["J1_1", "J2_1"]', r"\[J1_1, J2_1\] = .* is not in the span"),
        ('["J1_1", "J2_2"]', "does not act through the block J1_1, J2_2 alone"),
        ('"rotation_3"', "has no block 'rotation_3'"),
    ],
)
def test_a_block_that_cannot_act_alone_is_refused(block, said):
    """It is no subalgebra, commutators with the rest reach it, or there is none."""
    wrong = ('block = "rotation_1" }\nH', f"block = {block} }}\nH")
    with pytest.raises((SpecError, AlgebraError), match=said) as caught:
        spec(TOPS, wrong)
    assert "variables.G.block" in str(caught.value)
