"""Findings: statements that say what was found, so that what is found is what is proved.

Nobody claims that constraints are integrable or a motion reversible; the engine finds out. What is
zero is proved as ever; what is not is proved by a point where it is not.
Comes in: elements that are zero or not. Goes out: the decision for the certificate.
Read next: `coadjoint.prove.integrability`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from coadjoint.exact import Element, Field, element_text
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import Decision, decide_zero

#: (statement, kind, the decision already made)
Finding = tuple[str, str, Callable[[], Decision]]
#: Longest value that a statement shows; beyond it a point shows as much.
SHOWN = 72


def finding(kind: str, decision: Decision, zero: str, nonzero: str) -> Finding:
    """What was found: that something is zero, or that it is not.

    Args:
        kind: Of the claim.
        decision: Whether it is zero.
        zero: The statement if it is.
        nonzero: The statement if it is not, proved by the point that refutes the other.
    """
    if decision.verdict is not Verdict.REFUTED:
        return zero, kind, lambda: decision
    proof = Decision(Verdict.PROVED, nonzero_at(decision.defect, decision.point))
    return nonzero, kind, lambda: proof


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


def shown(field: Field, value: Element) -> str:
    """`` = value`` where that is short, else that it is not zero."""
    text = element_text(field, field.normal(value).combined())
    return f" = {text}" if len(text) <= SHOWN else " is not zero"
