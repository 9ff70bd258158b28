"""The rigid body in Lagrange's form, and the heavy top's bracket from that of the rotations."""

import pytest

from coadjoint.derive import derive
from tests.specs import RIGID_BODY, prove_claims, spec

#: T*SO(3) x R^3 inside pairs of matrices: Holm (2011), sections 8.3 and 8.3.1. The turning of the
#: body, O -> O exp(xi), has the momentum map Pi, and the vertical z is seen from the body as Gamma.
ROTATIONS = """
title = "turning body"
routes = ["poisson"]
[poisson]
canonical = [["O", "P"]]
[variables]
O = { role = "coordinate", shape = [9], form = "matrix" }
P = { role = "coordinate", shape = [9], form = "matrix" }
[parameters]
z = { shape = [3] }
I = { shape = [3], positive = true }
w = {}
[symmetries.Pi]
algebra = "so(3)"
vector = "xi"
side = "right"
generators = { O = "O*hat(xi)" }
[hamiltonian]
h = "w*dot(transpose(O)*z, z)"
[observables]
Gamma = "transpose(O)*z"
[claims.brackets]
"{Pi, Pi}" = "hat(Pi)"
"{Pi, Gamma}" = "hat(Gamma)"
"{Gamma, Gamma}" = "0*hat(Gamma)"
"""


def brackets(*changes):
    """The verdicts on the claimed brackets."""
    claims = prove_claims(spec(ROTATIONS, *changes)).claims
    return {claim.statement: str(claim.verdict) for claim in claims if claim.kind == "bracket"}


def test_2_4_rigid_body_in_lagrangian_form():
    """From l = Omega . I Omega/2 follow Pi = I Omega and dPi/dt = Pi x Omega."""
    found = derive(spec(RIGID_BODY), "euler-poincare")
    field, (I1, I2, I3) = found.setting.field, (found.setting.field[f"I{n}"] for n in (1, 2, 3))
    Pi1, Pi2, Pi3 = (field[f"Pi{n}"] for n in (1, 2, 3))
    book = (
        Pi2 * Pi3 / I3 - Pi3 * Pi2 / I2,
        Pi3 * Pi1 / I1 - Pi1 * Pi3 / I3,
        Pi1 * Pi2 / I2 - Pi2 * Pi1 / I1,
    )
    rates = [found.close(rate) for rate in found.exact.rates]
    assert all(rate == value for rate, value in zip(rates, book, strict=True))
    assert not any(rate == -value for rate, value in zip(rates, book, strict=True))


def test_8_3_and_8_3_1_body_momentum_and_vertical_close_like_se3():
    """{Pi_i, Pi_j} = -eps_ijk Pi_k, {Pi_i, Gamma_j} = -eps_ijk Gamma_k, {Gamma, Gamma} = 0.

    hat(a)_ij = -eps_ijk a_k, so the minus bracket of se(3)* reads hat(Pi), hat(Gamma), 0.
    """
    assert set(brackets().values()) == {"proved"}
    assert len(brackets()) == 3


@pytest.mark.parametrize(
    ("change", "culprit"),
    [
        (('"hat(Pi)"', '"-hat(Pi)"'), "{Pi, Pi} = -hat(Pi)"),
        (('"{Pi, Gamma}" = "hat', '"{Pi, Gamma}" = "-hat'), "{Pi, Gamma} = -hat(Gamma)"),
        (('Gamma = "transpose(O)*z"', 'Gamma = "O*z"'), "{Pi, Gamma} = hat(Gamma)"),
    ],
)
def test_8_3_spoiled(change, culprit):
    """Another sign, or the vertical turned the wrong way, is refuted."""
    assert brackets(change)[culprit] == "refuted"
