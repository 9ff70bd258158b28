"""Newton-Euler, Kaluza-Klein, Nambu found, complexification, restriction: what they refuse."""

import re

import pytest

from coadjoint.derive import derive
from coadjoint.errors import DerivationError, SpecError
from tests.sources.test_complex import TEXT
from tests.sources.test_tops import BODY, on
from tests.specs import RIGID_BODY, prove_claims, shipped, spec, unitless

TOP = unitless(shipped("heavy_top").path.read_text(encoding="utf-8"))
SO4 = shipped("so4_body").path.read_text(encoding="utf-8")
TWO = '"euler-poincare", "lie-poisson"'


def refusal(declared, route):
    """The message of a route that cannot be followed; it names the route and a line."""
    with pytest.raises(
        DerivationError, match=rf":\d+: \w+\.\w: the route {route} cannot be"
    ) as caught:
        derive(declared, route)
    assert caught.value.route == route
    assert caught.value.exit_status == 2
    return str(caught.value)


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (("m*dot(v, v)/2", "m*dot(v, v)/2 + m*v2^2"), r"v2\^2\*m is left over"),
        (("m*dot(v, cross(Omega, c))", "m*Omega1*v1"), r"Omega1\*v1\*m is left over"),
        ((" - m*g", " + Omega1*c1 - m*g"), r"Omega1\*c1 is left over"),
        (("diag(I)*Omega)/2", "diag(I)*Omega)*(1 + Gamma1)/2"), "Gamma1.* is not constant"),
        (('"se(3)"', '"se(3)"\ninvariance = "right"'), "right-invariant"),
    ],
)
def test_newton_euler_refuses_what_no_mass_points_are(change, found):
    """Added mass, coupled axes, a rotor, inertia that moves, a right-invariant system."""
    message = refusal(spec(BODY, change), "newton-euler")
    assert re.search(found, message), message


def test_newton_euler_refuses_other_algebras():
    """In four dimensions nobody has mass points with a cross product."""
    assert "expected so(3) or se(3)" in refusal(
        spec(SO4, ("routes  = [", 'routes  = ["newton-euler", ')), "newton-euler"
    )


def test_kaluza_klein_refuses_what_is_not_linear():
    """A potential quadratic in Gamma is named with its slope; so is a body without one."""
    square = spec(TOP, ("- m*g*dot(Gamma, chi)", "- m*g*Gamma1^2"))
    assert "dl/dGamma1 = -2*Gamma1*m*g depends on Gamma1" in refusal(square, "kaluza-klein")
    free = spec(RIGID_BODY, (TWO, TWO + ', "kaluza-klein"'))
    assert "nothing is advected" in refusal(free, "kaluza-klein")


@pytest.mark.parametrize("representation", ["adjoint", "coadjoint", "symmetric"])
@pytest.mark.parametrize("invariance", ["left", "right"])
def test_kaluza_klein_follows_every_representation(representation, invariance):
    """Linear potentials of any advected quantity, on both sides, are proved equal."""
    text = RIGID_BODY.replace(TWO, TWO + ', "kaluza-klein"')
    text = text.replace('name = "so(3)"', f'name = "so(3)"\ninvariance = "{invariance}"')
    text = text.replace(
        'Pi = { role = "momentum" }',
        'Pi = { role = "momentum" }\n'
        f'a = {{ role = "advected", representation = "{representation}" }}',
    ).replace('diag(I)*Omega)/2"', 'diag(I)*Omega)/2 - a1*I1 + 2*a3"')
    certificate = prove_claims(spec(text.replace('casimirs = ["dot(Pi, Pi)"]', "")))
    assert certificate.holds, str(certificate)


def test_nambu_refuses_other_dimensions_and_algebras_without_casimirs():
    """Six dimensions, and structure constants with a parameter that is not unimodular."""
    six = spec(TOP, ("routes  = [", 'routes  = ["nambu", '))
    assert "has 6 dimensions" in refusal(six, "nambu")
    basis = 'basis = ["e1", "e2", "e3"]\nbrackets = { "[e3, e1]" = "e1", "[e3, e2]" = "e1 + e2" }'
    message = refusal(on(basis), "nambu")
    assert "not unimodular" in message
    assert "no Casimir" in message


def test_complexification_refuses_real_algebras_and_functions():
    """so(4) is no complexification, and a sine has no continuation here."""
    real = spec(SO4, ("routes  = [", 'routes  = ["complexification", '))
    assert "is not the complexification" in refusal(real, "complexification")
    whole = shipped("complex_rigid_body").path.read_text(encoding="utf-8")
    sine = spec(whole, ('diag(K)*y))/2"\n\n', 'diag(K)*y))/2 + sin(x1)"\n\n'))
    assert "elementary function" in refusal(sine, "complexification")


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("{ y = ", "{ z = ", "'z' is not a variable"),
        ("dot(w, w))*w", "dot(w, w))", "the value is a scalar"),
        ("dot(w, w))*w", "dot(w, w))*y", "'y'"),
        ('"dot(x, y)", ', '"dot(x, q)", ', "'q'"),
    ],
)
def test_a_section_that_is_none_is_refused(old, new, found):
    """An unknown variable, a wrong shape, a section over itself, an unknown name."""
    with pytest.raises(SpecError, match=found) as caught:
        spec(TEXT, (old, new))
    assert caught.value.line > 0


def test_a_restriction_is_by_a_hamiltonian_alone():
    """Of a top with a Lagrangian, whose removal is the advice."""
    text = TOP + '\n[reduction]\nsection = { Gamma = "0*Pi" }\n'
    with pytest.raises(SpecError, match="Remove "):
        spec(text)
