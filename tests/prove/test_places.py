"""Refuted claims are shown where they stand in the spec."""

from dataclasses import replace

import pytest

from coadjoint.errors import ClaimError, DerivationError
from coadjoint.prove import prove
from coadjoint.resources import derivations_folder
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
    assert first.place is None
    wrong = certificate.refuted[0].verdict
    spoiled = replace(certificate, claims=(replace(first, verdict=wrong), *rest))
    (text,) = [each for each in spoiled.explain_failures() if first.statement in each]
    assert text.startswith("body: refuted: ")


PARTICLE = """title = "Particle in a plane"
routes = ["poisson", "lax"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "coordinate", shape = [2] }
[poisson]
canonical = [["q", "p"]]
[hamiltonian]
h = "dot(p, p)/2 + dot(q, q)/2"
[lax]
L = "rows(vector(p1, q1, 0, 0), vector(q1, -p1, 0, 0), vector(0, 0, p2, q2), vector(0, 0, q2, -p2))"
M = "rows(vector(0, 1, 0, 0), vector(-1, 0, 0, 0), vector(0, 0, 0, 1), vector(0, 0, -1, 0))/2"
[symmetries]
J = { algebra = "so(2)", vector = "e", generators = { q = "e*vector(-q2, q1)" } }
[transformations]
mirror = { map = { q = "vector(-q1, q2)", p = "vector(-p1, p2)" }, exchanges = { J = "-J" } }
"""
#: Changes that make a claim false: what is refuted, with the line and key of what declares it.
WRONG = {
    "pair": ("0, -1, 0))/2", "0, -1, 0))", "dL/dt = [L, M] for every lambda", 11, "lax.L"),
    "momentum map": (
        '"e*vector(-q2, q1)" }',
        '"e*vector(-q2, q1)" }, map = "e*(q1*p2 + q2*p1)"',
        "J is their momentum map",
        14,
        "symmetries.J",
    ),
    "map": (
        '"vector(-q1',
        '"vector(-2*q1',
        "mirror takes the motion to itself",
        16,
        "transformations.mirror.map.q",
    ),
    "exchange": ('"-J"', '"J"', "mirror takes J to J", 16, "transformations.mirror.exchanges.J"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_refuted_pairs_symmetries_and_maps_are_shown_at_their_lines(wrong):
    """Of a table without a formula the table is shown; the right spec has nothing to show."""
    old, new, statement, line, key = WRONG[wrong]
    assert PARTICLE.count(old) == 1
    assert prove(read_spec_text(PARTICLE, "plane.toml")).holds
    told = [*prove(read_spec_text(PARTICLE.replace(old, new), "plane.toml")).explain_failures()]
    (shown,) = [text for text in told if f"refuted: {statement}" in text]
    assert shown.startswith(f"plane.toml:{line}: {key}: refuted: ")
    assert len(shown.splitlines()) == 3
    assert shown.splitlines()[2].strip("^ ") == ""


@pytest.mark.parametrize(
    ("system", "density", "said"),
    [
        ("euler_2d", "psi^2", "by psi is no multiple of w; expected one of w"),
        ("camassa_holm", "u^3", "by u is no multiple of m; expected one of m"),
    ],
)
def test_a_density_that_cannot_be_varied_is_shown_at_its_claim(system, density, said):
    """And not at the Lagrangian, which is right; the message has the claim as attributes, too."""
    text = (derivations_folder() / f"{system}.toml").read_text()
    text = text.replace('conserved = ["energy"', f'conserved = ["energy", "{density}"')
    with pytest.raises(DerivationError, match=said) as caught:
        prove(read_spec_text(text, f"{system}.toml"))
    line = next(n for n, row in enumerate(text.splitlines(), 1) if row.startswith("conserved"))
    assert str(caught.value).startswith(f"{system}.toml:{line}: claims.conserved[2]: ")
    assert (caught.value.line, caught.value.found) == (line, density)
