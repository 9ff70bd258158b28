"""`coadjoint prove` shows the certificate, and a counterexample of what is false."""

from __future__ import annotations

import json

import pytest

from tests.constrained import PARTICLE


def test_certificate_of_a_shipped_system(run):
    """Every claim about the heavy top is proved, the equality of its routes among them."""
    result = run("prove", "heavy_top")
    assert result.exit_code == 0, result.stderr
    assert "euler-poincare and lie-poisson give the same motion" in result.stdout
    assert "refuted" not in result.stdout


def test_certificate_as_json(run, rigid_body):
    """The record has statement, verdict, method and time of each claim."""
    record = json.loads(run("prove", rigid_body, "--json").stdout)
    assert record["holds"] is True
    assert {claim["verdict"] for claim in record["claims"]} == {"proved"}
    assert all(claim["method"] and claim["seconds"] >= 0 for claim in record["claims"])
    assert "dot(Pi, Pi) is a Casimir" in [claim["statement"] for claim in record["claims"]]


def test_false_claim_is_refuted_with_a_point(run, false_claim):
    """A false Casimir ends with status 1, the claim and a point where it fails."""
    result = run("prove", false_claim)
    assert result.exit_code == 1
    assert "refuted" in result.stdout
    assert "Pi[1] + Pi[2] is a Casimir" in result.stderr
    assert "At Pi" in result.stderr
    record = json.loads(run("prove", false_claim, "--json").stdout)
    (claim,) = [claim for claim in record["claims"] if claim["verdict"] == "refuted"]
    assert record["holds"] is False
    assert claim["counterexample"]
    assert claim["defect"] != "0"


@pytest.mark.parametrize(
    ("constraint", "found", "place"),
    [
        ('"w = y*u"', "there is no ==", ":17:12: constraints.blade: "),
        ('"w*u == y"', "w*u == y is not linear in the velocities", ":17: constraints.blade: "),
        ('"z == x"', "is one on positions", ":17: constraints.blade: "),
        ('"w == y*u"\nmore = "w == y*u + 1"', "more contradicts", ":18: constraints.more: "),
        ('"w == y*u"\nmore = "2*w == 2*y*u"', "more follows from", ":18: constraints.more: "),
        ('"w == y*u"\n[forces]\nq = "1"', "there is no such velocity as 'q'", ":19:1: forces.q: "),
    ],
)
def test_wrong_constraints_are_wrong_input(run, folder, constraint, found, place):
    """The message names file, line and key, and the exit status is that of wrong input."""
    path = folder / "particle.toml"
    path.write_text(PARTICLE.replace('"w == y*u"', constraint), encoding="utf-8")
    result = run("prove", path)
    assert result.exit_code == 2
    assert f"particle.toml{place}" in result.stderr
    assert found in " ".join(result.stderr.split())
    assert not result.stdout
