"""Searches: what is found in addition to the claims, each with its own budget.

Integrals, measures, Casimirs and growth vectors are searched for, though they are not claimed.
Such a search may take very long, and must not keep a user from a proved kernel; so it ends after
a given amount of work, and the certificate says that it did. Work is counted and not timed
(`coadjoint.exact.denominators.Factors.budget`), so that a certificate is the same on every machine.
Comes in: the statements of a search, not yet computed. Goes out: those that it reached, decided.
Read next: `coadjoint.prove.claims`, which runs the searches.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from coadjoint.exact import BudgetSpent, Field
from coadjoint.limits import SEARCH_WORK
from coadjoint.prove.zero import Decision, Discovery, Examined, UndecidedError, decide_zero

#: The method of a search that ended early.
ENDED = "the search ended after {work} operations of exact arithmetic"
#: The method of a search that needed more elementary functions than the field holds.
CROWDED = "the search needs more elementary functions than the field holds"


def within_budget(
    field: Field, kind: str, subject: str, examined: Iterable[Examined], work: int = SEARCH_WORK
) -> Iterator[Examined]:
    """The statements of a search, decided, until its budget is spent.

    Args:
        field: Whose arithmetic is counted.
        kind: Of the finding that says where the search ended.
        subject: What is searched for, in the plural: ``integrals``.
        examined: The statements; a generator, so that none of its work is done before.
        work: The budget.
    """
    results = list[Examined]()
    try:
        with field.budget(work):
            for statement, of_kind, examine in examined:
                result = examine()
                if not isinstance(result, Decision | Discovery):
                    result = decide_zero(result, field)
                results.append((statement, of_kind, lambda result=result: result))  # type: ignore[misc]
    except (BudgetSpent, UndecidedError, OverflowError) as error:
        end = Discovery(_why_ended(error, work), "no statement beyond those above")
        results.append((f"{subject}: not searched further", kind, lambda: end))
    yield from results


def _why_ended(error: Exception, work: int) -> str:
    """The method of a search that could not go on."""
    if isinstance(error, BudgetSpent):
        return ENDED.format(work=work)
    if isinstance(error, OverflowError):  # numbers for parameters make new functions of old ones
        return CROWDED
    return f"undecided: {error}"
