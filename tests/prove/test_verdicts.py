"""Verdicts: a claim holds if it is proved, or supported where its spec accepts that."""

import pytest

from coadjoint import pipeline
from coadjoint.errors import ClaimError, SpecError
from coadjoint.prove import Certificate, Claim, Finding, Verdict
from coadjoint.prove.zero import Decision, Discovery, make_entry, mark_claimed
from tests.specs import RIGID_BODY, prove_claims, spec


def nested(a, b):
    """Zero, as the square of sqrt(a^2 + 1) + sqrt(b^2 + 2) shows; no normal form relates them."""
    whole = f"{a}^2 + {b}^2 + 3 + 2*sqrt(({a}^2 + 1)*({b}^2 + 2))"
    return f"sqrt({whole}) - sqrt({a}^2 + 1) - sqrt({b}^2 + 2)"


HIDDEN = nested("q1", "q2")
PLAIN = 'casimirs = ["dot(Pi, Pi)"]'
#: Claims of each kind with a hidden zero: (claims, statement begins).
PLANE = """
title = "Particle in a plane"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2"
[observables]
P = "p1"
"""


def claim(verdict, accepted=None):
    """A claim with a verdict."""
    return Claim("1 = 1", "conserved", verdict, "a method", accepted=accepted)


@pytest.mark.parametrize(
    ("verdict", "accepted", "holds"),
    [
        (Verdict.PROVED, None, True),
        (Verdict.PROVED, False, True),
        (Verdict.PROVED, True, True),
        (Verdict.SUPPORTED, None, False),
        (Verdict.SUPPORTED, False, False),
        (Verdict.SUPPORTED, True, True),
        (Verdict.REFUTED, None, False),
        (Verdict.REFUTED, False, False),
        (Verdict.REFUTED, True, False),
    ],
)
def test_what_holds(verdict, accepted, holds):
    """Proved, or supported and accepted; and nothing else."""
    certificate = Certificate("sample", (claim(Verdict.PROVED), claim(verdict, accepted)))
    assert certificate.holds is holds
    if holds:
        assert certificate.require() is certificate
    else:
        with pytest.raises(ClaimError, match=r"sample: (not proved|refuted): 1 = 1"):
            certificate.require()


def test_a_certificate_without_claims_holds():
    """Nothing is claimed, so nothing fails; findings decide nothing."""
    found = Finding("3 integrals", "integrals", "ranks", error="below 1e-17")
    assert Certificate("sample", ()).holds
    assert Certificate("sample", (), (found,)).require().holds


def test_a_discovery_becomes_a_finding():
    """What nobody claims is no claim, whoever asks."""
    discovery = Discovery("a rank", "for almost all parameters", "below 1e-17")
    entry = make_entry("rank 3", "casimir", discovery, 0.5)
    assert isinstance(entry, Finding)
    assert entry.as_record() == {
        "statement": "rank 3",
        "kind": "casimir",
        "method": "a rank",
        "scope": "for almost all parameters",
        "error": "below 1e-17",
    }
    ((*_, examine),) = mark_claimed(
        spec(), ("claims", "casimirs", 0), None, [("", "", lambda: discovery)], None
    )
    assert examine() is discovery


def hidden(table):
    """The word of a spec on its claims that are true and not proved."""
    declared = spec(PLANE + table)
    supported = [c for c in prove_claims(declared).claims if c.verdict is Verdict.SUPPORTED]
    assert supported
    (word,) = {each.accepted for each in supported}
    return word


WAYS = {
    "conserved": f'[claims]\nconserved = [{{ claim = "q1*({HIDDEN})"%s }}]\n',
    "casimirs": f'[claims]\ncasimirs = [{{ claim = "q1*({HIDDEN})"%s }}]\n',
    "brackets": f'[claims.brackets]\n"{{q1, p1}}" = {{ claim = "1 + q1*({HIDDEN})"%s }}\n',
    "exchanges": '[transformations.turn]\nmap = { q = "-q", p = "-p" }\n'
    f'exchanges = {{ P = {{ claim = "-P + q1*({HIDDEN})"%s }} }}\n',
}


@pytest.mark.parametrize("way", WAYS)
def test_a_spec_may_accept_support_of_its_claims(way):
    """Without the word the system is refused, with it the claim is counted as supported."""
    assert hidden(WAYS[way] % "") is False
    with pytest.raises(ClaimError, match="not proved: ") as caught:
        prove_claims(spec(PLANE + WAYS[way] % "")).require()
    assert "numerically supported" in str(caught.value)
    assert 'accept = "numerical"' in str(caught.value)  # the advice, which the next lines follow
    accepted = WAYS[way] % ', accept = "numerical"'
    assert hidden(accepted) is True
    assert prove_claims(spec(PLANE + accepted)).require().count(Verdict.SUPPORTED) >= 1


def test_a_map_and_a_symmetry_accept_support_in_their_tables():
    """Where a claim has no text of its own, its table says it."""
    turned = f'[transformations.turn]\nmap = {{ q = "-q + q*({HIDDEN})", p = "-p" }}\n'
    assert hidden(turned) is False
    assert hidden(turned + 'accept = "numerical"\n') is True
    line = PLANE.replace("shape = [2]", "shape = []").replace("dot(p, p)/2", "p").replace("p1", "p")
    moved = '[symmetries.J]\nalgebra = "R^1"\nvector = "s"\nmap = "s*p"\n'
    moved += f'generators = {{ q = "s + s*({nested("q", "q")})", p = "0*s*p" }}\n'
    declared = prove_claims(spec(line + moved))
    supported = [c for c in declared.claims if c.verdict is Verdict.SUPPORTED]
    assert {c.kind for c in supported} == {"symmetry"}
    assert not declared.holds
    assert prove_claims(spec(line + moved + 'accept = "numerical"\n')).holds


def test_the_engine_never_accepts_support_of_its_own_claims():
    """Their failure has other advice, and there is no key for all claims at once."""
    certificate = Certificate("sample", (claim(Verdict.SUPPORTED),))
    with pytest.raises(ClaimError) as caught:
        certificate.require()
    assert "The engine never accepts numbers for this claim" in str(caught.value)
    assert 'accept = "numerical"' not in str(caught.value)
    with pytest.raises(SpecError, match="accept"):
        spec(PLANE + '[claims]\naccept = "numerical"\n')


@pytest.mark.parametrize("word", ['"yes"', "true", '"numeric"', '""'])
def test_another_word_is_refused(word):
    """The message names what would be accepted."""
    with pytest.raises(SpecError, match="numerical"):
        spec(PLANE + f'[claims]\nconserved = [{{ claim = "p1", accept = {word} }}]\n')


def test_acceptance_does_not_save_a_false_claim():
    """What is refuted is refuted."""
    wrong = '[claims]\nconserved = [{ claim = "q1", accept = "numerical" }]\n'
    assert not prove_claims(spec(PLANE + wrong)).holds


def test_the_former_name_of_a_claim_is_read():
    """`integral` was the name of `claim` among conserved quantities; both at once are refused."""
    old = spec(PLANE + '[claims]\nconserved = [{ integral = "p1" }]\n')
    new = spec(PLANE + '[claims]\nconserved = [{ claim = "p1" }]\n')
    assert old.conserved[0].formula.tree == new.conserved[0].formula.tree
    with pytest.raises(SpecError, match="integral"):
        spec(PLANE + '[claims]\nconserved = [{ integral = "p1", claim = "p2" }]\n')


def test_generated_heads_say_what_is_not_proved():
    """All kernels count the claims that are only supported; where all are proved they say none."""
    claims = (
        f'casimirs = ["dot(Pi, Pi)", {{ claim = "{nested("Pi1", "Pi2")}", accept = "numerical" }}]'
    )
    rendered = pipeline.render(spec(RIGID_BODY, (PLAIN, claims)))
    line = "1 claim is numerically supported and NOT proved: see certificate.json."
    for name in ("kernel.py", "kernel.c", "kernel_python.py"):
        assert line in rendered.texts[name]
    assert '"accepted": true' in rendered.texts["certificate.json"]
    assert "NOT proved" not in pipeline.render(spec()).texts["kernel.c"]


def test_a_decision_without_a_spec_is_the_engines():
    """Only claims that a spec makes carry its word."""
    assert Decision(Verdict.PROVED, "").accepted is None
    assert {c.accepted for c in prove_claims(spec()).claims} == {None, False}


@pytest.mark.parametrize(
    ("integral", "method"),
    [
        ("q1*p2 - q2*p1", "normal form in the field of rational functions"),
        ("p1 + (sin(-q1) + sin(q1))*p2", "normal form modulo the relations of the elementary"),
        ("p1 + (sqrt(4) - 2)*q1", "normal form modulo the relations of the elementary"),
    ],
)
def test_the_method_names_relations_of_functions_that_are_gone(integral, method):
    """What is zero shows no function, but -sin(q) = sin(-q) was needed to see that it is."""
    found = prove_claims(spec(PLANE + f'[claims]\nconserved = ["{integral}"]\n')).claims
    (one,) = (each for each in found if each.statement == f"{integral} is conserved")
    assert one.verdict is Verdict.PROVED
    assert one.method.startswith(method)


def with_metric(G):
    """A rigid body with a double bracket."""
    return spec(RIGID_BODY, ("[claims]", f'[double_bracket]\nG = "{G}"\n[claims]'))


@pytest.mark.parametrize(
    ("G", "said"),
    [
        ("-I1", r"semidefinite\. At I1 = \S+ the smallest eigenvalue is -\S+; expected none below"),
        ("rows(vector(1, 1, 0), vector(0, 1, 0), vector(0, 0, 1))", "the difference is -1; expect"),
    ],
)
def test_a_refuted_metric_says_which_number_is_wrong(G, said):
    """An eigenvalue is to be no less than 0, and a difference is to be 0."""
    with pytest.raises(ClaimError, match=said):
        prove_claims(with_metric(G)).require()


def test_the_advice_about_a_metric_names_its_table():
    """What is only supported is accepted in [double_bracket], as the message says."""
    G = "I1 + I1*sin(Pi1)^3"
    with pytest.raises(ClaimError, match=r'accept = "numerical" in .* in \[double_bracket\]'):
        prove_claims(with_metric(G)).require()
    assert prove_claims(with_metric(f'{G}"\naccept = "numerical')).require()
