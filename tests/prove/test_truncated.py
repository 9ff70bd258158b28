"""The certificate of matrices of any number of rows, and false motions that it refutes."""

from dataclasses import replace

import pytest

from coadjoint.prove import Verdict, prove, truncated
from coadjoint.prove.claims import _certify
from tests.specs import shipped

FLUID, TORUS = "zeitlin_su_n", "zeitlin_torus"


def test_every_claim_is_proved_and_says_for_which_rows():
    """For the few that are written out, or for all."""
    claims = prove(shipped(FLUID)).require().claims
    assert {claim.verdict for claim in claims} == {Verdict.PROVED}
    scopes = {claim.statement.rpartition(", for ")[2] for claim in claims}
    assert scopes == {"N = 3 and 4", "every N >= 2"}
    always = [claim.statement for claim in claims if claim.statement.endswith("every N >= 2")]
    assert [each.partition(",")[0] for each in always] == [
        "the motion by any h is the commutator [W",
        "the bracket of u(N) satisfies the Jacobi identity",
        "tr W^k is a Casimir",
        "every Casimir is a function of these N",
        "the energy is conserved",
    ]
    assert "the algebra u(N) satisfies the Jacobi identity, for N = 3 and 4" in {
        claim.statement for claim in claims
    }
    assert sum(claim.kind == "conserved" for claim in claims) == 1
    assert any("every Casimir is a function of the N known" in each.statement for each in claims)


@pytest.mark.parametrize("sign", [-1, 2])
def test_another_product_than_the_commutator_is_refuted(monkeypatch, sign):
    """Nothing is said of every N then."""
    honest = truncated.multiply_out

    def spoiled(equations):
        return tuple(sign * each for each in honest(equations))

    monkeypatch.setattr(truncated, "multiply_out", spoiled)
    certificate = prove(shipped(FLUID))
    wrong = [claim for claim in certificate.claims if claim.verdict is Verdict.REFUTED]
    assert [claim.kind for claim in wrong] == ["equivalence"]
    assert "the commutator [W, V]" in wrong[0].statement
    assert not any("every N" in claim.statement for claim in certificate.claims)


@pytest.mark.parametrize("window", [0, 1])
def test_the_weakest_of_the_few_decides(window):
    """What is refuted for one number of rows is refuted for the few, and nothing follows."""
    spec = shipped(FLUID)
    certificates = [_certify(each, searched=False) for each in spec.family.windows]
    claims = list(certificates[window].claims)
    (place,) = (n for n, claim in enumerate(claims) if claim.kind == "algebra")
    claims[place] = replace(claims[place], verdict=Verdict.REFUTED)
    certificates[window] = replace(certificates[window], claims=tuple(claims))
    found = truncated.extend_truncated(spec, certificates)
    wrong = [claim for claim in found.claims if claim.verdict is Verdict.REFUTED]
    assert [claim.kind for claim in wrong] == ["algebra"]
    assert not any("every N" in claim.statement for claim in found.claims)


def test_a_bracket_of_the_other_side_is_refuted():
    """Right invariant motions go the other way: ``dW/dt = [V, W]``."""
    spec = shipped(FLUID)
    windows = tuple(replace(each, invariance="right") for each in spec.family.windows)
    certificate = prove(replace(spec, family=replace(spec.family, windows=windows)))
    wrong = [claim.kind for claim in certificate.claims if claim.verdict is Verdict.REFUTED]
    assert wrong == ["equivalence"]
    assert not any("every N" in claim.statement for claim in certificate.claims)


def test_on_the_torus_the_sine_bracket_is_proved_and_odd_rows_are_named():
    """That of degree 5 is not looked for among polynomials; all are known for every N."""
    claims = prove(shipped(TORUS)).require().claims
    assert {claim.verdict for claim in claims} == {Verdict.PROVED}
    scopes = {claim.statement.rpartition(", for ")[2] for claim in claims}
    assert scopes == {"N = 3 and 5", "N = 3", "every odd N >= 3"}
    least = [claim.statement for claim in claims if claim.statement.endswith("for N = 3")]
    assert [each.partition(",")[0] for each in least] == [
        "every Casimir is a function of the N known",
        "the rates are those by the sine bracket",
    ]
    always = [claim.kind for claim in claims if claim.statement.endswith("every odd N >= 3")]
    assert always == ["equivalence", "jacobi", "casimir", "casimir", "bracket", "conserved"]


def test_another_bracket_of_waves_is_refuted(monkeypatch):
    """Nothing is said of every N then."""
    spec = shipped(TORUS)
    honest = truncated.multiply_waves
    monkeypatch.setattr(truncated, "multiply_waves", lambda *given: [-x for x in honest(*given)])
    family = replace(spec.family, windows=spec.family.windows[:1])
    certificate = prove(replace(spec, family=family))
    wrong = [claim for claim in certificate.claims if claim.verdict is Verdict.REFUTED]
    assert [claim.kind for claim in wrong] == ["equivalence"]
    assert "the sine bracket" in wrong[0].statement
    assert not any("every odd N" in claim.statement for claim in certificate.claims)
