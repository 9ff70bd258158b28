"""Refuted claims are shown where they stand in the spec."""

from dataclasses import replace

import pytest

from coadjoint.errors import ClaimError
from coadjoint.prove import prove
from coadjoint.spec.reader import read_spec_text

TEXT = """title = "Body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6"
[claims]
casimirs = ["dot(Pi, Pi)", "Pi1"]
conserved = [
  "energy",
  { claim = "Pi1^2 + Pi3" },
  "Pi3",
]
brackets = { "{Pi1, Pi2}" = "-Pi3", "{Pi2, Pi3}" = "Pi1" }
"""
#: Statements that are refuted, with line and key of the claims that make them.
PLACES = {
    "Pi1 is a Casimir": (10, "claims.casimirs[2]", '"Pi1"'),
    "Pi1^2 + Pi3 is conserved": (13, "claims.conserved[2].claim", '"Pi1^2 + Pi3"'),
    "Pi3 is conserved": (14, "claims.conserved[3]", '"Pi3"'),
    "{Pi2, Pi3} = Pi1": (16, "claims.brackets.{Pi2, Pi3}", '"Pi1"'),
}


@pytest.fixture(scope="module")
def certificate():
    """Of a body of which much is claimed that is false."""
    return prove(read_spec_text(TEXT, "body.toml"))


def test_each_refuted_claim_is_shown_at_its_line(certificate):
    """With the line itself, carets under the claim, and the point where it fails."""
    with pytest.raises(ClaimError) as caught:
        certificate.require()
    told = str(caught.value)
    assert {each.statement for each in certificate.refuted} == PLACES.keys()
    lines = TEXT.splitlines()
    for statement, (line, key, marked) in PLACES.items():
        begin = f"body.toml:{line}: {key}: refuted: {statement}"
        assert begin in told
        shown, carets = told[told.index(begin) :].splitlines()[1:3]
        assert shown.strip() == lines[line - 1].strip()
        assert len(carets.strip()) == len(marked)
        at = carets.index("^")
        assert shown[at : at + len(marked)] == marked


def test_a_claim_of_the_engine_has_no_place(certificate):
    """It is told by the name of the system; and no other claim lends it its place."""
    first, *rest = certificate.claims
    assert first.made is None
    wrong = certificate.refuted[0].verdict
    spoiled = replace(certificate, claims=(replace(first, verdict=wrong), *rest))
    (text,) = [each for each in spoiled.explain_failures() if first.statement in each]
    assert text.startswith("body: refuted: ")
