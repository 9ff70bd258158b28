"""Integrals of any shape, everywhere and on level sets: proved where they hold, else refuted."""

from fractions import Fraction

import pytest

from coadjoint.errors import ClaimError, SpecError
from coadjoint.prove import Verdict
from coadjoint.prove.certificate import failure_text
from tests.specs import RIGID_BODY, prove_claims, spec

#: I = (4k, 4k, k), weight along chi in the equatorial plane: Goryachev's and Chaplygin's top.
CHAPLYGIN = """
title = "Goryachev-Chaplygin top"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
k = { positive = true, default = 1 }
c = { positive = true, default = 1 }
[definitions]
cubic = "Pi3*(Pi1^2 + Pi2^2) - 4*k*c*Pi1*Gamma3"
[hamiltonian]
h = "(Pi1^2 + Pi2^2)/(8*k) + Pi3^2/(2*k) + c*Gamma1"
[claims]
conserved = [{ claim = "cubic", where = ["dot(Pi, Gamma)"] }]
"""


def verdicts(text, *changes):
    """The claims that something is conserved, but for the energy's."""
    claims = prove_claims(spec(text, *changes)).claims
    return [claim for claim in claims if claim.kind == "conserved"][1:]


def test_chaplygins_integral_is_proved_on_its_level_set():
    """Zhukovskii's remark (1890s): on Pi.Gamma = 0 there is a further, cubic integral."""
    (claim,) = verdicts(CHAPLYGIN)
    assert claim.verdict is Verdict.PROVED
    assert claim.statement == "cubic is conserved where dot(Pi, Gamma) = 0"
    assert "ideal of dot(Pi, Gamma) = 0" in claim.method


@pytest.mark.parametrize(
    "change",
    [
        ("- 4*k*c*Pi1*Gamma3", "+ 4*k*c*Pi1*Gamma3"),
        ("- 4*k*c*Pi1*Gamma3", "- 2*k*c*Pi1*Gamma3"),
        ("/(8*k)", "/(6*k)"),
        ("+ c*Gamma1", "- c*Gamma1"),
    ],
)
def test_a_spoiled_integral_is_refuted_at_a_point_of_the_level_set(change):
    """One sign or factor off, and the message shows a point with Pi.Gamma = 0 where it fails."""
    declared = spec(CHAPLYGIN, change)
    (claim,) = prove_claims(declared).refuted
    point = {name: Fraction(value) for name, value in claim.counterexample.items()}
    assert sum(point[f"Pi{n}"] * point[f"Gamma{n}"] for n in (1, 2, 3)) == 0
    assert Fraction(claim.defect) != 0
    with pytest.raises(ClaimError, match="where dot") as caught:
        prove_claims(declared).require()
    assert caught.value.exit_status == 1


def test_without_the_level_set_the_same_integral_is_refuted():
    """Chaplygin's integral is none of all motions."""
    where = '{ claim = "cubic", where = ["dot(Pi, Gamma)"] }'
    (claim,) = verdicts(CHAPLYGIN, (where, '"cubic"'))
    assert claim.verdict is Verdict.REFUTED
    point = {name: Fraction(value) for name, value in claim.counterexample.items()}
    assert sum(point.get(f"Pi{n}", 0) * point.get(f"Gamma{n}", 0) for n in (1, 2, 3)) != 0
    assert 'where = ["I1 - I2"]' in failure_text(claim)


@pytest.mark.parametrize(
    ("where", "holds"),
    [
        ('["Pi1", "Pi2"]', True),  # turning about a principal axis goes on
        ('["Pi1"]', False),  # the motion leaves it
        ('["Pi1 - Pi2", "Pi3"]', False),
    ],
)
def test_the_motion_must_stay_on_the_level_set(where, holds):
    """Pi3 stands still where Pi1 = Pi2 = 0; where only Pi1 = 0, the motion goes elsewhere."""
    claim = f'conserved = [{{ claim = "Pi3", where = {where} }}]'
    (found,) = verdicts(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', claim))
    assert found.verdict is (Verdict.PROVED if holds else Verdict.REFUTED)
    assert " = 0" in found.statement


@pytest.mark.parametrize("integral", ["Pi3", "dot(Pi, Pi)"])
@pytest.mark.parametrize("where", ['["Pi1", "Pi1 - 1"]', '["dot(Pi, Pi) + 1"]', '["I1*Pi1^2 + 1"]'])
def test_on_an_empty_level_set_nothing_is_decided(integral, where):
    """Functions that never vanish together would let every claim pass, and nothing refutes it."""
    claim = f'conserved = [{{ claim = "{integral}", where = {where} }}]'
    with pytest.raises(
        ClaimError, match=r"sample.toml:\d+: claims.*: undecided: .* is conserved where .* = 0: "
    ):
        verdicts(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', claim))


def test_a_level_set_that_is_linear_in_nothing_has_points_too():
    """Pi3 moves on the sphere Pi . Pi = 1, and the point that shows it lies there."""
    claim = 'conserved = [{ claim = "Pi3", where = ["dot(Pi, Pi) - 1"] }]'
    declared = spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', claim))
    (found,) = prove_claims(declared).refuted
    length = sum(float(found.counterexample[f"Pi{n}"]) ** 2 for n in (1, 2, 3))
    assert length == pytest.approx(1, abs=1e-13)
    with pytest.raises(ClaimError, match="where dot"):
        prove_claims(declared).require()


def test_every_component_of_a_claim_is_proved():
    """A vector of integrals is one claim; one component that moves refutes it."""
    good = ('casimirs = ["dot(Pi, Pi)"]', 'conserved = ["rows(Pi, 3*Pi)*Pi"]')
    assert verdicts(RIGID_BODY, good)[0].verdict is Verdict.PROVED
    bad = ('casimirs = ["dot(Pi, Pi)"]', 'conserved = ["rows(Pi, Omega, I)*Pi"]')
    (found,) = verdicts(RIGID_BODY, bad)
    assert found.verdict is Verdict.REFUTED
    assert {"Pi1", "Pi2", "Pi3"} <= found.counterexample.keys()


def test_a_vector_of_casimirs_is_one_claim_of_all():
    """Both components are Casimirs of so(3)*; with Omega among them they are not."""
    vector = 'casimirs = ["rows(Pi, 2*Pi)*Pi"]'
    certificate = prove_claims(spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', vector)))
    assert certificate.holds
    assert "every Casimir is a function of the one known" in str(certificate)
    vector = 'casimirs = ["rows(Pi, I)*Pi"]'
    (refuted,) = prove_claims(spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', vector))).refuted
    assert refuted.statement == "rows(Pi, I)*Pi is a Casimir"


@pytest.mark.parametrize(
    ("claim", "key", "found", "said"),
    [
        ('{ claim = "Pi9" }', "claims.conserved[1].claim", "Pi9", "not declared"),
        (
            '{ claim = "Pi3", where = ["Pi9"] }',
            "claims.conserved[1].where[1]",
            "Pi9",
            "not declared",
        ),
        ('{ claim = "Pi3", where = [] }', "claims.conserved[1].where", None, "at least 1 item"),
        ('{ where = ["Pi1"] }', "claims.conserved[1]", "claim", "'claim' is missing"),
        ('{ claim = "Pi3", when = ["Pi1"] }', "claims.conserved[1].when", "when", "'where'?"),
        ("3", "claims.conserved[1]", 3, "a table"),
    ],
)
def test_a_slip_in_a_claim_is_refused_at_its_place(claim, key, found, said):
    """Key, guilty value and fix are in the message."""
    with pytest.raises(SpecError) as caught:
        spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', f"conserved = [{claim}]"))
    assert (caught.value.key, said in str(caught.value)) == (key, True), str(caught.value)
    assert found is None or caught.value.found == found
