"""Routes on groups: names of their own, options, and refusals that say what would do."""

import pytest

from coadjoint.derive import derive
from coadjoint.derive.symbols import choose_names
from coadjoint.errors import AlgebraError, DerivationError, SpecError
from coadjoint.spec.spatial import spatial_momenta
from tests.specs import RIGID_BODY, emitted, prove_claims, shipped, spec

KLEIN = RIGID_BODY.replace('"lie-poisson"', '"cayley-klein"').replace(
    'casimirs = ["dot(Pi, Pi)"]', ""
)
PAIRED = RIGID_BODY.replace('"lie-poisson"', '"clebsch"')


def test_names_that_a_spec_has_taken_are_left_to_it():
    """All names of a route change together, and a whole quantity's name counts too."""
    declared = spec(RIGID_BODY, ("I = {", "Q1 = {}\nI = {"))
    assert choose_names(declared, ["Q1", "Q2"]) == ("Q1_0", "Q2_0")
    assert choose_names(declared, ["Q2", "P2"]) == ("Q2", "P2")
    assert choose_names(declared, ["I"]) == ("I_0",)


def test_clebsch_takes_small_letters_beside_a_momentum_p():
    """Kirchhoff's P1 is a momentum: the pair is q, p."""
    equations = emitted("kirchhoff", "clebsch")
    assert equations.variables[:2] == ("q1", "q2")
    assert equations.chart.through == "(Pi, P) = p <> q"


def test_a_pair_of_the_defining_matrices_reaches_a_level_set_of_kirchhoff():
    """On (x, 1) of R^4 the momentum map is P = -w p, Pi = p x x: Pi . P = 0."""
    text = shipped("kirchhoff").path.read_text(encoding="utf-8")
    pair = '[clebsch]\nrepresentation = "defining"\n\n[lagrangian]'
    statements = {
        c.statement for c in prove_claims(spec(text.replace("[lagrangian]", pair))).claims
    }
    reached = "the states that the route clebsch reaches have dimension 5 of 6: dot(Pi, P) = 0"
    assert reached in statements


@pytest.mark.parametrize("algebra", ["so(2,1)", "quaternions"])
def test_cayley_klein_wants_rotations(algebra):
    """The algebra is named, and what would do."""
    with pytest.raises(DerivationError, match=r"cayley-klein.*expected so\(3\)") as caught:
        derive(spec(KLEIN, ("so(3)", algebra)), "cayley-klein")
    assert caught.value.found == algebra


def test_cayley_klein_wants_vectors():
    """A symmetric matrix is no vector."""
    advected = 'S = { role = "advected", representation = "symmetric" }\nPi = {'
    with pytest.raises(DerivationError, match=r"S has the representation 'symmetric'") as caught:
        derive(spec(KLEIN, ("Pi = {", advected)), "cayley-klein")
    assert caught.value.found == "symmetric"
    assert "vectors or the unit quaternion" in caught.value.expected


@pytest.mark.parametrize("invariance", ["left", "right"])
@pytest.mark.parametrize("advected", ["", 'a = { role = "advected", representation = "vector" }'])
def test_quaternions_turn_bodies_on_both_sides(invariance, advected):
    """Cayley-Klein in the declared state and in a chart, with potentials of attitude and vector."""
    attitude = f'q = {{ role = "advected", representation = "quaternion" }}\n{advected}\nPi = {{'
    potential = "- q1*q2^2 + q3" + (" - a1^2*a2" if advected else "")
    text = KLEIN.replace('name = "so(3)"', f'name = "so(3)"\ninvariance = "{invariance}"')
    whole = text.replace("Pi = {", attitude).replace('Omega)/2"', f'Omega)/2 {potential}"')
    assert prove_claims(spec(whole)).holds
    chart = text.replace("Pi = {", f"{advected}\nPi = {{")
    certificate = prove_claims(spec(chart))
    assert certificate.holds
    assert any("double cover" in claim.statement for claim in certificate.claims)


def test_a_quaternion_wants_rotations():
    """se(3) has no unit quaternions; the message names it and the way out."""
    with pytest.raises(AlgebraError, match=r"se\(2\) has no unit quaternions.*'attitude'"):
        spec(
            RIGID_BODY,
            ("so(3)", "se(2)"),
            ("Pi = {", 'q = { role = "advected", representation = "quaternion" }\nPi = {'),
        )


def test_an_attitude_wants_matrices():
    """An algebra declared by brackets has none."""
    brackets = '\nbasis = ["a", "b", "c"]\n[algebra.brackets]\n"[a, b]" = "c"\n'
    with pytest.raises(AlgebraError, match="no 'attitude' representation"):
        spec(
            RIGID_BODY,
            ('name = "so(3)"\n', brackets),
            ("Pi = {", 'g = { role = "advected", representation = "attitude" }\nPi = {'),
        )


def test_a_name_that_the_spatial_momentum_needs_is_refused():
    """Pi_spatial is emitted beside an attitude, so nothing else may be called that."""
    text = RIGID_BODY.replace(
        "Pi = {", 'q = { role = "advected", representation = "quaternion" }\nPi = {'
    )
    with pytest.raises(SpecError, match="'Pi_spatial1' is doubled"):
        spec(text, ("I = {", "Pi_spatial1 = {}\nI = {"))


def test_a_clebsch_table_without_the_route_is_refused():
    """Nothing would read it; the message says what would."""
    table = '[clebsch]\nrepresentation = "vector"\n[lagrangian]'
    with pytest.raises(SpecError, match=r"no route uses the table \[clebsch\].*clebsch") as caught:
        spec(RIGID_BODY, ("[lagrangian]", table))
    assert caught.value.found == "clebsch"


def test_an_unknown_representation_of_the_pair_is_refused():
    """With a suggestion, at its line."""
    table = '[clebsch]\nrepresentation = "vectr"\n[lagrangian]'
    with pytest.raises(SpecError, match=r"'vectr'.*Did you mean 'vector'"):
        spec(PAIRED, ("[lagrangian]", table))


@pytest.mark.parametrize("route", ["hamilton-pontryagin", "clebsch", "poincare", "cayley-klein"])
def test_a_singular_lagrangian_is_refused_on_every_route(route):
    """The missing kinetic term is named."""
    text = RIGID_BODY.replace('"lie-poisson"', f'"{route}"')
    with pytest.raises(DerivationError, match="Omega3") as caught:
        derive(spec(text, ("dot(Omega, diag(I)*Omega)/2", "I1*Omega1^2 + I2*Omega2^2")), route)
    assert caught.value.velocity == "Omega3"


def test_elementary_functions_pass_through_every_route():
    """A potential sin(Gamma3) sqrt(1 + Gamma1^2): torques come out of its derivative."""
    routes = '"lie-poisson", "hamilton-pontryagin", "clebsch", "poincare", "cayley-klein"'
    text = RIGID_BODY.replace('"lie-poisson"', routes).replace(
        "Pi = {", 'Gamma = { role = "advected", representation = "vector" }\nPi = {'
    )
    text = text.replace('Omega)/2"', 'Omega)/2 - sin(Gamma3)*sqrt(1 + Gamma1^2)"')
    text = text.replace('"dot(Pi, Pi)"', '"dot(Pi, Gamma)"')
    certificate = prove_claims(spec(text))
    assert not certificate.refuted, str(certificate)


def test_the_attitude_of_se3_has_no_last_row():
    """[R | x] from the left; the whole matrix from the right, since x moves by the last row."""
    text = RIGID_BODY.replace("so(3)", "se(2)").replace(
        "Pi = {", 'g = { role = "advected", representation = "attitude" }\nPi = {'
    )
    text = text.replace('casimirs = ["dot(Pi, Pi)"]', "")
    left = spec(text)
    right = spec(text, ('name = "se(2)"', 'name = "se(2)"\ninvariance = "right"'))
    assert left.attitude.shape == (6,)
    assert right.attitude.components[-1] == "g33"
    assert prove_claims(left).holds
    seen = next(c for c in prove_claims(right).claims if c.statement == "Pi_spatial is conserved")
    assert seen.verdict.value == "proved"
    assert "g33 = 1" in seen.method


def test_no_spatial_momentum_where_the_group_is_a_surface_of_matrices():
    """Most 3 x 3 matrices are not in SO(2, 1), whose inverse no formula gives for all: no claim."""
    text = RIGID_BODY.replace("so(3)", "so(2,1)").replace(
        "Pi = {", 'g = { role = "advected", representation = "attitude" }\nPi = {'
    )
    assert spatial_momenta(spec(text.replace('["dot(Pi, Pi)"]', "[]"))) == ()
