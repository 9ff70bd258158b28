"""Coupled motions of Holm (2011), by section: 7.2 (extension) and appendix C.5."""

from fractions import Fraction
from pathlib import Path

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive.reference import Reference
from coadjoint.prove.certificate import Verdict
from coadjoint.resources import derivations_folder
from tests.conftest import rational_points
from tests.sources import coupled, textbook
from tests.specs import prove_claims, shipped, spec


def rotation(a, b, c):
    """A rational rotation by Cayley's formula, row by row."""
    q = [Fraction(1), *map(Fraction, (a, b, c))]
    n = sum(x * x for x in q)
    w, x, y, z = q
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return [entry / n for row in rows for entry in row]


def rates(A):
    """Derived rates of two coupled bodies at a point with a given A, and the point."""
    name = "coupled_bodies"
    names = (*textbook.STATES[name], *textbook.PARAMETERS[name])
    (point,) = rational_points(names, 1)
    point |= dict(zip(textbook.STATES[name][6:], A, strict=True))
    reference = Reference(derive(shipped(name)))
    found = reference.evaluate("rhs", point, Fraction, None)
    values = [point[n] for n in names]
    return found, values[:15], values[15:]


def test_C_5_two_coupled_rigid_bodies():
    """On rotations A, the printed equations: torques tau and -A^T tau."""
    found, state, parameters = rates(rotation(2, -3, Fraction(1, 2)))
    assert found == coupled.book_rates(state, parameters)
    assert found != coupled.book_rates(state, parameters, sign=-1)


def test_C_5_the_printed_torque_is_for_rotations():
    """Where A is no rotation the second torque is e w2 x (A^T w1) with a minus, not -A^T tau."""
    found, state, parameters = rates([1, 2, 0, 0, 1, 3, -1, 0, 2])
    assert found == coupled.coupled_rates(state, parameters)
    assert found != coupled.book_rates(state, parameters)


def verdict(name, claims, statement):
    """The verdict on one statement about a shipped system with other claims."""
    certificate = prove_claims(claiming(name, claims))
    (claim,) = (c for c in certificate.claims if c.statement == statement)
    return claim.verdict


def claiming(name, claims):
    """A shipped spec with its claims replaced."""
    text = (Path(derivations_folder()) / f"{name}.toml").read_text()
    return spec(text[: text.index("[claims]")] + claims)


@pytest.mark.parametrize("casimir", ["dot(P, P)", "dot(P, Gamma)", "dot(Gamma, Gamma)"])
def test_7_2_vehicle_with_noncoincident_centres(casimir):
    """P.P, P.Gamma and Gamma.Gamma are Casimirs of the nine-dimensional bracket."""
    claims = f'[claims]\ncasimirs = ["{casimir}"]\n'
    assert verdict("underwater_vehicle", claims, f"{casimir} is a Casimir") is Verdict.PROVED


@pytest.mark.parametrize("function", ["dot(Pi, P)", "dot(Pi, Gamma)"])
def test_7_2_products_with_the_angular_impulse_are_no_casimirs(function):
    """Pi.P and Pi.Gamma, Casimirs with one vector, are none with two."""
    claims = f'[claims]\ncasimirs = ["{function}"]\n'
    assert verdict("underwater_vehicle", claims, f"{function} is a Casimir") is Verdict.REFUTED


def test_C_5_total_momentum_needs_a_proper_rotation():
    """The length of Pi1 + A Pi2 is not conserved where A is any matrix."""
    claims = '[claims]\nconserved = ["dot(total, total)"]\n'
    found = verdict("coupled_bodies", claims, "dot(total, total) is conserved")
    assert found is Verdict.REFUTED
    assert make_setting(shipped("coupled_bodies")).state[6:] == textbook.square("A", 3)
