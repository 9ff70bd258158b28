"""Routes by matrices and Lax pairs: what they give beside the books, and what they refuse."""

import dataclasses

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive.integrals import lax_integrals
from coadjoint.derive.mechanics.planes import find_pair
from coadjoint.derive.pairs import LaxPair
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict
from coadjoint.prove import lax as examined
from coadjoint.prove.zero import Discovery
from tests.specs import RIGID_BODY, prove_claims, shipped, spec, unitless


def text_of(name):
    """The text of a shipped spec, without units, which wrong pairs would not fit."""
    return unitless(shipped(name).path.read_text(encoding="utf-8"))


def manakov(*changes):
    """The rigid body with the route manakov and some pieces replaced."""
    return spec(RIGID_BODY, ('"lie-poisson"]', '"manakov"]'), *changes)


KINETIC = "dot(Omega, diag(I)*Omega)/2"
GAMMA = 'Pi = { role = "momentum" }\n'


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([(KINETIC, f"{KINETIC} + I1*Omega1*Omega2/5")], "Omega1 depends on Omega2"),
        ([(KINETIC, f"{KINETIC} + I1*Omega3")], "is not a square of Omega3"),
        (
            [(GAMMA, GAMMA + 'Gamma = { role = "advected", representation = "vector" }\n')],
            "by the representation 'vector'",
        ),
        (
            [
                (GAMMA, GAMMA + 'S = { role = "advected", representation = "symmetric" }\n'),
                (KINETIC, f"{KINETIC} + S2"),
            ],
            "derivative of the potential by S2 is 1",
        ),
        (
            [
                (GAMMA, GAMMA + 'S = { role = "advected", representation = "symmetric" }\n'),
                (KINETIC, f"{KINETIC} + S1"),
            ],
            r"c_i - c_j = sigma*(a_i - a_j)",
        ),
        ([('name = "so(3)"', 'name = "sl(2,R)"')], "the matrix of H spans no plane"),
        ([('name = "so(3)"', 'name = "quaternions"')], "the matrix of i spans no plane"),
    ],
)
def test_manakov_refuses_what_is_no_such_body(changes, said):
    """Coupled axes, gyroscopes, other fields and other algebras are named, with a way out."""
    with pytest.raises(DerivationError) as caught:
        derive(manakov(*changes), "manakov")
    assert said in str(caught.value)
    assert "the route manakov cannot be followed" in str(caught.value)
    assert 'emove "manakov".' in str(caught.value)


def test_manakov_takes_a_hamiltonian_and_the_right_invariant_motion():
    """The pair is found from ``h`` too, and turns the other way for a right-invariant motion."""
    text = text_of("so5_body").replace('"lie-poisson"', '"lie-poisson", "manakov"')
    assert not prove_claims(spec(text)).refuted
    right = spec(text, ('invariance = "left"', 'invariance = "right"'))
    assert not prove_claims(right).refuted
    assert find_pair(make_setting(right)).texts[1].startswith("-(Omega + lambda*diag(")


@pytest.mark.parametrize(
    ("pair", "said"),
    [
        (("M + lambda*diag(a)^2", "M12*M + lambda*diag(a)"), "not affine in the state"),
        (("M + lambda*diag(a)^2", "lambda*diag(a)"), "L does not determine M12"),
    ],
)
def test_lax_refuses_a_pair_that_gives_no_rates(pair, said):
    """An L that is not affine in the state, or lacks components of it, is refused by name."""
    with pytest.raises(DerivationError, match="the route lax cannot be followed") as caught:
        derive(spec(text_of("manakov_so4"), pair), "lax")
    assert said in str(caught.value)


def test_the_spectral_parameter_stands_in_no_function():
    """Powers of it are told apart; those of exp(lambda) are not."""
    declared = spec(text_of("manakov_so4"), ('"M + lambda*diag', '"exp(lambda)*M + lambda*diag'))
    with pytest.raises(DerivationError, match="lambda occurs in a function"):
        derive(declared, "lax")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            [(GAMMA, GAMMA + 'b = { role = "advected", representation = "coadjoint" }\n')],
            "by the representation 'coadjoint'",
        ),
        (
            [
                (
                    'name = "so(3)"',
                    'basis = ["A", "B", "C"]\nbrackets = { "[A, B]" = "C", "[B, C]" = "A", '
                    '"[C, A]" = "B" }',
                )
            ],
            "has no matrices",
        ),
    ],
)
def test_matrices_are_asked_for(changes, said):
    """Algebras without matrices, and representations that are no products, have other routes."""
    declared = spec(RIGID_BODY, ('"lie-poisson"]', '"matrix-euler-poincare"]'), *changes)
    with pytest.raises(DerivationError, match="the route matrix-euler-poincare") as caught:
        derive(declared, "matrix-euler-poincare")
    assert said in str(caught.value)
    assert "euler-poincare" in str(caught.value)


@pytest.mark.parametrize("representation", ["vector", "columns", "rows", "symmetric"])
@pytest.mark.parametrize("invariance", ["left", "right"])
def test_matrices_move_advected_quantities_as_representations_do(representation, invariance):
    """Products with xi, and torques by traces, equal rho and diamond: two roads, one motion."""
    sizes = {"vector": 2, "columns": 4, "rows": 4, "symmetric": 3}
    potential = " + ".join(f"b{n}^2*k{n}/2" for n in range(1, sizes[representation] + 1))
    declared = spec(
        RIGID_BODY,
        ('"lie-poisson"]', '"matrix-euler-poincare"]'),
        ('name = "so(3)"', f'name = "sl(2,R)"\ninvariance = "{invariance}"'),
        (GAMMA, GAMMA + f'b = {{ role = "advected", representation = "{representation}" }}\n'),
        ("[parameters]", f"[parameters]\nk = {{ shape = [{sizes[representation]}] }}"),
        (KINETIC, f"{KINETIC} - ({potential})"),
        ('casimirs = ["dot(Pi, Pi)"]', ""),
    )
    certificate = prove_claims(declared)
    assert not certificate.refuted
    assert any(
        "matrix-euler-poincare give the same motion" in c.statement for c in certificate.claims
    )


def test_long_integrals_are_conserved_by_the_trace_identity(monkeypatch):
    """The Lax equation is asked for then: a spoiled pair gives nothing."""
    monkeypatch.setattr(examined, "LONGEST", 5)
    declared = shipped("manakov_so4")
    (claim,) = [c for c in prove_claims(declared).claims if c.statement.startswith("integral1")]
    assert (claim.verdict, claim.method) == (Verdict.PROVED, examined.TRACE_IDENTITY)
    spoiled = spec(text_of("manakov_so4"), ('"Omega + lambda*diag(a)"', '"Omega - lambda*diag(a)"'))
    (claim,) = [c for c in prove_claims(spoiled).claims if c.statement.startswith("integral1")]
    assert claim.verdict is Verdict.REFUTED


def test_a_long_integral_that_no_trace_has_is_refuted(monkeypatch):
    """The trace identity speaks of the coefficient alone, not of what is emitted in its place."""
    monkeypatch.setattr(examined, "LONGEST", 5)
    setting = make_setting(shipped("manakov_so4"))
    routes = [derive(setting.spec, route, setting=setting) for route in setting.spec.routes]
    field, first = setting.field, routes[0]
    emitted = tuple(
        dataclasses.replace(each, values=(each.values[0] + field["M12"],))
        if each.name == "integral1"
        else each
        for each in first.exact.emitted
    )
    exact = dataclasses.replace(first.exact, emitted=emitted)
    spoiled = [dataclasses.replace(first, exact=exact), *routes[1:]]
    examine = {text: decide for text, _, decide in examined.about_pairs(spoiled)}
    (decide,) = [decide for text, decide in examine.items() if text.startswith("integral1, from")]
    assert decide().verdict is Verdict.REFUTED


def test_an_integral_that_is_missing_is_noticed():
    """The count is that of the coefficients, so one that is not emitted refutes it."""
    setting = make_setting(shipped("manakov_so4"))
    first, found = derive(setting.spec, setting=setting), lax_integrals(setting)
    assert isinstance(examined._complete(first, found, 4), Discovery)
    less = type(found)(found.pair, found.coefficients, ())
    assert examined._complete(first, less, 4).verdict is Verdict.REFUTED
    twice = type(found)(found.pair, found.coefficients, found.emitted * 2)
    (one,) = (each for each in first.exact.emitted if each.name == "integral1")
    again = dataclasses.replace(one, name="integral2", components=("integral2",))
    exact = dataclasses.replace(first.exact, emitted=(*first.exact.emitted, again))
    first = dataclasses.replace(first, exact=exact)
    assert examined._complete(first, twice, 4).verdict is Verdict.REFUTED


def test_involution_is_examined():
    """Two functions that do not commute are seen."""
    setting = make_setting(shipped("manakov_so4"))
    first, field = derive(setting.spec, setting=setting), setting.field
    assert examined._bracket(first, field["M12"], field["M13"]) == field["M23"]
    assert isinstance(find_pair(setting), LaxPair)
