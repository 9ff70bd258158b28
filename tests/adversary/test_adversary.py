"""The standing adversary: random specs and claims, each certificate judged by independent numbers.

One claim, or one count of Casimirs or integrals, is one case. 500 are tried in every run, 50000 in
campaigns; a case that fails prints its spec, and its seed brings it back.
"""

import pytest

from coadjoint.prove.zero import UndecidedError
from tests.adversary.judge import statements
from tests.adversary.motion import motion_of
from tests.adversary.renamed import permute_variables, rename_variables
from tests.adversary.run import campaign, faults_of, record_of, shorten, without
from tests.adversary.specs import FAMILIES, generate

#: Cases of one test, and specs that are enough for them.
CASES, SPECS = 100, 40
#: Tests of every run, and of campaigns.
REGULAR, WHOLE = 3, 500
#: Kinds of case that every test meets, and the rare ones that the first test meets.
KINDS, RARE = ("proved", "refuted", "count"), ("numerically supported", "integrals")


@pytest.mark.parametrize(
    "part",
    [
        pytest.param(n, marks=() if n < REGULAR else pytest.mark.campaign, id=f"part{n}")
        for n in range(WHOLE)
    ],
)
def test_no_certificate_is_refuted(part, record_property):
    """Proved claims hold at random points, refuted ones fail at theirs; counts match ranks."""
    counts, found = campaign(range(part * SPECS, (part + 1) * SPECS), CASES)
    record_property("adversary", dict(counts))
    print(f"part {part}: {dict(counts)}")
    assert not found, "\n\n".join(found)
    assert sum(counts.values()) >= CASES, counts
    wanted = KINDS if part else (*KINDS, *RARE)
    assert all(counts[kind] for kind in wanted), f"a kind of case is missing: {counts}"
    assert counts["unjudged"] <= CASES // 10, f"too many were not judged: {counts}"


def test_specs_are_reproducible_and_of_every_kind():
    """A seed always gives the same text; different seeds differ, and every family occurs."""
    texts = [generate(seed) for seed in range(REGULAR * SPECS)]
    assert texts == [generate(seed) for seed in range(REGULAR * SPECS)]
    assert len(set(texts)) == len(texts)
    titles = {text.splitlines()[0] for text in texts}
    assert len(titles) >= len(FAMILIES), titles


def test_a_failing_spec_is_reduced_to_the_failing_claim():
    """Claims that the fault does not depend on are removed; the failing claim remains."""
    text = generate(0)
    guilty = next(line for line in text.splitlines() if line.startswith("  "))
    short = shorten(text, lambda shorter: guilty in shorter)
    assert [line for line in short.splitlines() if line.startswith("  ")] == [guilty]
    assert short.startswith(text.partition("[claims]")[0])


def test_a_refused_spec_is_a_fault():
    """Specs that cannot be read would test nothing."""
    faults, counts = faults_of(generate(0).replace("[variables]", "[variable]"))
    assert "the spec is refused" in faults[0]
    assert not counts


PARTICLE = """title = "Particle"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
[hamiltonian]
h = "p^2/2"
[claims]
conserved = [
  { integral = "q", where = ["p^2 + 1"] },
  "sqrt(-p^2 - 1)",
  "p",
]
"""


def test_a_claim_without_real_points_may_be_undecided():
    """p^2 + 1 = 0 and sqrt(-p^2 - 1) have no real points; the claim about p is still checked."""
    faults, counts = faults_of(PARTICLE)
    assert faults == []
    assert counts == {"undecided": 2, "proved": 1, "count": 1, "integrals": 1}


def test_a_claim_with_real_points_must_be_decided(monkeypatch):
    """A prover that misses existing points is reported, and so is one that invents points."""
    for found, words in (("p is conserved", "there are points"), ("h is it", "no line claims")):

        def give_up(text, found=found):
            raise UndecidedError("nothing", found=found)

        monkeypatch.setattr("tests.adversary.run.record_of", give_up)
        (fault,), counts = faults_of(PARTICLE)
        assert words in fault
        assert not counts


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(n, marks=() if n < 2 else pytest.mark.campaign, id=f"from{n * 4}")
        for n in range(80)
    ],
)
def test_no_verdict_depends_on_names_or_on_order(seed):
    """Names from the other end of the alphabet, in reverse order: all verdicts are the same."""
    for n in range(seed * 4, seed * 4 + 4):
        text = generate(n)
        turned = permute_variables(text)
        other = rename_variables(turned)
        before, after = spec_verdicts(text), spec_verdicts(other)
        order = list(statements(motion_of(turned)))
        assert len(before) > 2
        assert order != list(before), "the claims are in another order"
        assert sorted(order) == sorted(before)
        assert [before[each] for each in order] == list(after.values()), f"seed {n}: {other}"


def spec_verdicts(text):
    """The verdicts of a spec's own claims by their statements, in the order of the spec."""
    try:
        found = {claim["statement"]: claim["verdict"] for claim in record_of(text)["claims"]}
    except UndecidedError as error:
        found = spec_verdicts(without(text, error.found)) | {error.found: "undecided"}
    known = {"energy is conserved": "the energy is conserved"}
    return {each: found[known.get(each, each)] for each in statements(motion_of(text))}
