"""Statements that depend on whether something is zero: what is found is what is proved.

Nobody claims that constraints are integrable or a motion reversible; the engine finds out. What is
zero is proved as ever; what is not is proved by a point where it is not: an analytic function that
is not zero there is not zero at almost every point, and on no open set. What numbers alone support
is a finding.
Comes in: elements that are zero or not. Goes out: the entry for the certificate.
Read next: `coadjoint.prove.integrability`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from coadjoint.derive import Setting
from coadjoint.exact import Element, Field, element_text
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import (
    Decision,
    Discovery,
    Examined,
    decide_zero,
    refute_at_a_point,
)

#: Longest value that a statement shows; beyond it a point shows as much.
SHOWN = 72
#: How a finding may be wrong that no proof and no counterexample decides.
NUMBERS = "numbers at some points, no proof"


def finding(kind: str, decision: Decision, zero: str, nonzero: str) -> Examined:
    """What was found: that something is zero, or that it is not.

    Args:
        kind: Of the claim.
        decision: Whether it is zero.
        zero: The statement if it is.
        nonzero: The statement if it is not, proved by the point that refutes the other.
    """
    if decision.verdict is Verdict.REFUTED:
        proof = Decision(verdict=Verdict.PROVED, method=nonzero_at(decision.defect, decision.point))
        return nonzero, kind, lambda: proof
    result = decision if decision.verdict is Verdict.PROVED else guess(decision)
    return zero, kind, lambda: result


def guess(decision: Decision) -> Discovery:
    """What numbers alone support, as a finding."""
    return Discovery(decision.method, error=NUMBERS)


def for_parameters(setting: Setting, values: Iterable[Element]) -> str:
    """The scope of what is not zero: almost all parameters, where it depends on such."""
    reached = frozenset[str]().union(*map(setting.field.reach, values))
    return ", for almost all parameters" if reached & {*setting.parameters} else ""


def nonzero_at(value: str, point: Mapping[str, str]) -> str:
    """The method of what is not zero: its value at a point."""
    where = ", ".join(f"{name} = {number}" for name, number in point.items())
    return f"the value {value} at {where}" if where else f"the value {value}"


def first_nonzero(
    values: Mapping[str, Element], field: Field, where: Ideal | None = None
) -> tuple[str, Decision]:
    """The first of some named values that is not zero, with its refutation.

    Returns:
        Its name and the decision that refutes it; "" and a proof, if all are zero.
    """
    decision = decide_zero(list(values.values()), field, where)
    if decision.verdict is not Verdict.REFUTED:
        return "", decision
    for name, value in values.items():
        own = decide_zero([value], field, where)
        if own.verdict is Verdict.REFUTED:
            return name, own
    raise AssertionError("one of several values is not zero, and each of them is")


def nonzero_at_a_point(
    values: Mapping[str, Element], field: Field, where: Ideal
) -> tuple[str, Decision]:
    """The same, where a point is searched for before any normal form is taken."""
    for name, value in values.items():
        refutation = refute_at_a_point(value, field, where)
        if refutation is not None:
            return name, refutation
    return first_nonzero(values, field, where)


def show_value(field: Field, value: Element) -> str:
    """`` = value`` where that is short, else that it is not zero."""
    text = element_text(field, field.normal(value).combine())
    return f" = {text}" if len(text) <= SHOWN else " is not zero"
