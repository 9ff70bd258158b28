"""Fixed cases: the expected verdicts, and what the judge has to say of each certificate."""

import re
from fractions import Fraction
from pathlib import Path

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import CoadjointError
from coadjoint.pipeline import render
from coadjoint.prove import Verdict, prove
from coadjoint.prove.examination import examine
from coadjoint.spec import read_spec_text
from tests.adversary.fixed import (
    CASES,
    DEGENERATE,
    FREE,
    REFUTED,
    canonical,
    conserved,
    free,
    spins,
)
from tests.adversary.judge import judge
from tests.adversary.run import record_of

#: Cases with too few points inside a domain, or with numbers of too different sizes, for a rank of
#: numbers to count the integrals.
UNCOUNTED = (
    "the same with a domain",
    "a bracket that is defined far away alone",
    "a prime as a factor",
)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_fixed_case_has_the_verdict_that_is_true(case):
    """The verdict is the one known by hand, and the judge accepts every statement."""
    record = record_of(case.text)
    found = {claim["statement"]: claim for claim in record["claims"]}
    for statement, verdict in case.verdicts.items():
        assert found[statement]["verdict"] == verdict, found[statement]
    texts = [entry["statement"] for entry in (*record["claims"], *record.get("findings", ()))]
    for piece in case.says:
        assert any(piece in text for text in texts), texts
    for piece in case.never:
        assert not any(piece in text for text in texts), texts
    report = judge(case.text, record)
    assert not report.faults, "\n".join(report.faults)
    counts = case.name in UNCOUNTED
    assert [each for each in report.unjudged if not (counts and "integrals" in each)] == []
    assert bool(report.unjudged) == counts


def test_fixed_cases_contain_true_and_false_claims():
    """A prover that always answers yes, or always no, fails some case."""
    verdicts = [verdict for case in CASES for verdict in case.verdicts.values()]
    assert verdicts.count("proved") >= 20
    assert verdicts.count("refuted") >= 20
    assert len({case.name for case in CASES}) == len(CASES)


def test_a_singular_mass_matrix_has_no_proved_legendre_transform():
    """The mass matrix has the determinant exp(2q) - exp(q)^2 = 0: the spec is refused."""
    with pytest.raises(CoadjointError, match=r"singular|invertible|degenerate|determin"):
        record_of(DEGENERATE)


@pytest.mark.parametrize(
    ("constraint", "count"),
    [("v1 + v2 == 0", 2), ("3*v1 - 2*v2 == 0", 2), ("v1 + v2 + v3 == 0", 3)],
)
def test_a_kept_constraint_on_free_motion_has_kernels(constraint, count):
    """Free motion has no acceleration; the lowered kernel computes it all the same."""
    energy = " + ".join(f"v{n}^2/2" for n in range(1, count + 1))
    text = free(constraint, energy, count=count)
    rendered = render(read_spec_text(text, Path("sample.toml")))
    assert rendered.certificate.holds
    assert "kernel.c" in rendered.texts


def test_a_body_of_unit_inertia_may_not_turn_about_an_axis():
    """3 w1 = 2 w2 on a body of unit inertia, whose free motion has no acceleration."""
    text = """title = "Body"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
w = { role = "velocity" }
[lagrangian]
l = "dot(w, w)/2"
[constraints]
c = "3*w1 == 2*w2"
[claims]
conserved = ["w3", "w1"]
"""
    rendered = render(read_spec_text(text, Path("sample.toml")))
    assert rendered.certificate.holds
    assert not judge(text, rendered.certificate.as_record()).faults


def test_every_spin_of_a_chain_has_a_quadratic_casimir_of_its_own():
    """Twenty spins: 20 Casimirs of three squares each, and not power sums of high degree."""
    record = record_of(spins(20))
    casimirs = [
        claim["statement"]
        for claim in record["claims"]
        if claim["statement"].endswith(" is a Casimir")
    ]
    assert len(casimirs) == 20
    assert all(len(re.findall(r"\^2", text)) == 3 for text in casimirs), casimirs
    texts = [entry["statement"] for entry in (*record["claims"], *record.get("findings", ()))]
    assert any("function of the 20 known" in text for text in texts), texts


@pytest.mark.parametrize("name", ["so(3)", "se(2)", "se(3)", "so(4)", "sl(2,R)", "h(1)", "so(5)"])
def test_an_examined_algebra_has_the_rank_of_its_matrices(name):
    """The rank of c_ij^k mu_k by singular values, from commutators of matrices written here."""
    import random

    from tests.adversary.algebras import constants
    from tests.adversary.counts import rank_of

    names, c = constants(name, {})
    source = random.Random(name)
    mu = [source.uniform(1, 2) for _ in names]
    tensor = [[sum(x * m for x, m in zip(row, mu, strict=True)) for row in plane] for plane in c]
    found = examine(algebra_by_name(name))
    assert found.rank == rank_of(tensor)
    assert found.casimirs.expected == len(names) - found.rank


def test_supported_claims_hold_only_where_accepted():
    """A claim with the verdict supported counts as holding only if the spec accepts it."""
    claim = "(log(6) - log(2) - log(3))*q1"
    text = canonical(FREE, conserved(claim))
    certificate = prove(read_spec_text(text, Path("sample.toml")))
    (found,) = [each for each in certificate.claims if each.statement == f"{claim} is conserved"]
    assert found.verdict in (Verdict.SUPPORTED, Verdict.PROVED)
    assert certificate.holds is (found.verdict is Verdict.PROVED)
    accepted = f'[claims]\nconserved = [{{ claim = "{claim}", accept = "numerical" }}]'
    assert prove(read_spec_text(canonical(FREE, accepted), Path("sample.toml"))).holds
    false = f'[claims]\nconserved = [{{ claim = "q1 + {claim}", accept = "numerical" }}]'
    refuted = prove(read_spec_text(canonical(FREE, false), Path("sample.toml")))
    assert not refuted.holds
    assert any(claim.verdict == REFUTED for claim in refuted.claims)


def test_a_certificate_without_claims_of_its_spec_holds():
    """Nothing is claimed, nothing is refuted: the engine's own claims are proved."""
    assert prove(read_spec_text(canonical(FREE, ""), Path("sample.toml"))).holds


def test_a_shown_point_satisfies_the_set_exactly():
    """On mu1 = 0, the branch where the claim fails, the point's product is zero as text."""
    case = next(case for case in CASES if case.name.startswith("a product of momenta"))
    (claim,) = [c for c in record_of(case.text)["claims"] if c["verdict"] == REFUTED]
    point = {name: Fraction(text) for name, text in claim["counterexample"].items()}
    names = re.findall(r"mu\d", claim["statement"].partition(" where ")[2])
    assert Fraction(0) in {point[name] for name in names}
