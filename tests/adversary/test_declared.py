"""Submanifolds, symmetries and transformations, true and false by construction, and spoiled."""

import copy

import pytest

from tests.adversary.declared import DECLARED
from tests.adversary.judge import judge
from tests.adversary.run import record_of

SEEDS = range(3)
CASES = [
    pytest.param(family, kind, seed, id=f"{family.__name__}{seed}")
    for family, kind in DECLARED.items()
    for seed in SEEDS
]


def verdicts(record, kind):
    """The verdicts of claims of a kind."""
    return [claim["verdict"] for claim in record["claims"] if claim["kind"] == kind]


@pytest.mark.parametrize(("family", "kind", "seed"), CASES)
def test_true_declarations_are_proved(family, kind, seed):
    """Every claim is proved and the judge agrees; it objects when one is reported as refuted."""
    text = family(seed, True)
    record = record_of(text)
    assert set(verdicts(record, kind)) == {"proved"}
    report = judge(text, record)
    assert not report.faults, report.faults
    assert not report.unjudged, report.unjudged
    spoiled = copy.deepcopy(record)
    claim = next(each for each in spoiled["claims"] if each["kind"] == kind)
    claim.update(verdict="refuted", counterexample={}, defect="1")
    assert any("another difference" in each for each in judge(text, spoiled).faults)


@pytest.mark.parametrize(("family", "kind", "seed"), CASES)
def test_false_declarations_are_refuted(family, kind, seed):
    """Some claim is refuted and the judge agrees; it objects when it is reported as proved."""
    text = family(seed, False)
    record = record_of(text)
    assert "refuted" in verdicts(record, kind)
    report = judge(text, record)
    assert not report.faults, report.faults
    spoiled = copy.deepcopy(record)
    for claim in spoiled["claims"]:
        if claim["kind"] == kind:
            claim["verdict"] = "proved"
    assert any("proved, but false" in each for each in judge(text, spoiled).faults)


def test_a_true_symmetry_is_not_refuted():
    """Claims about a declared symmetry may be refuted where the motion has none, and only there."""
    symmetric = next(family for family in DECLARED if family.__name__ == "symmetric")
    for truth in (True, False):
        text = symmetric(1, truth)
        record = copy.deepcopy(record_of(text))
        claim = next(
            each
            for each in record["claims"]
            if each["kind"] == "symmetry" and " act as " in each["statement"]
        )
        claim.update(verdict="refuted", counterexample={}, defect="1")
        objected = any("a claim of the engine" in each for each in judge(text, record).faults)
        assert objected is truth
