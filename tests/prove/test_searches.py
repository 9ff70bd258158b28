"""Searches end after their budget, at the same place every time, and say so."""

import pytest

from coadjoint.exact import BudgetSpent, Field
from coadjoint.prove import Verdict, prove, searches
from coadjoint.prove.searches import within_budget
from coadjoint.prove.zero import Decision, Discovery
from tests.specs import shipped

FOUND = Discovery("a rank")


def sums(field, size):
    """The sum of the first symbols of a field."""
    return field.sum(field[name] for name in field.names[:size])


def test_work_is_counted_in_products_of_terms():
    """(a + b + c)(a + b) takes six products: five are too few."""
    field = Field(["a", "b", "c"])
    left, right = sums(field, 3), sums(field, 2)
    with field.budget(6):
        _ = left * right
    with pytest.raises(BudgetSpent), field.budget(5):
        _ = left * right
    _ = left * right  # outside there is no bound


def test_a_budget_inside_another_is_bounded_by_it():
    """What the inner block does counts in the outer one; the smaller bound ends it."""
    field = Field(["a", "b", "c"])
    whole = sums(field, 3)

    def twice():
        with field.budget(100):
            _ = whole * whole  # 9
        _ = whole * whole  # 18

    with pytest.raises(BudgetSpent), field.budget(17):
        twice()
    with field.budget(18):
        twice()
    with field.budget(100), pytest.raises(BudgetSpent), field.budget(8):
        _ = whole * whole
    with pytest.raises(BudgetSpent), field.budget(8), field.budget(100):
        _ = whole * whole


def entries(field, seen):
    """Three statements, of which each takes nine products."""
    whole = sums(field, 3)
    for n in range(3):
        seen.append(n)
        _ = whole * whole
        yield f"statement {n}", "casimir", lambda: FOUND


@pytest.mark.parametrize(("work", "reached"), [(8, 0), (9, 1), (17, 1), (18, 2), (26, 2), (27, 3)])
def test_a_search_keeps_what_it_reached(work, reached):
    """Statements up to the end stand; after them it is said that there was no further search."""
    field = Field(["a", "b", "c"])
    found = list(within_budget(field, "casimir", "Casimirs", entries(field, []), work))
    assert [s for s, _, _ in found[:reached]] == [f"statement {n}" for n in range(reached)]
    assert all(examine() is FOUND for _, _, examine in found[:reached])
    ends = [(s, examine()) for s, _, examine in found[reached:]]
    if reached == 3:
        assert ends == []
    else:
        ((statement, end),) = ends
        assert statement == "Casimirs: not searched further"
        assert end.method == f"the search ended after {work} operations of exact arithmetic"


def test_work_is_done_inside_the_budget():
    """A search that was begun before would not be counted; a decision is made inside, too."""
    field, seen = Field(["a", "b", "c"]), []
    examined = entries(field, seen)
    assert seen == []
    list(within_budget(field, "casimir", "Casimirs", examined, 100))
    assert seen == [0, 1, 2]
    whole = sums(field, 3)

    def hard():
        return [whole * whole - whole * whole]

    ((_, _, examine),) = within_budget(field, "", "", [("", "", hard)], 100)
    assert isinstance(examine(), Decision)
    ((statement, _, _),) = within_budget(field, "", "squares", [("", "", hard)], 17)
    assert statement == "squares: not searched further"


@pytest.mark.parametrize("name", ["heavy_top", "routh_sphere"])
def test_a_search_that_ends_early_keeps_no_claim_from_its_proof(name, monkeypatch):
    """With hardly any budget every claim of a spec is still proved, and the certificate holds."""
    monkeypatch.setattr(searches.within_budget, "__defaults__", (10,))
    certificate = prove(shipped(name))
    assert certificate.holds
    assert certificate.count(Verdict.PROVED) >= 5
    ended = [each for each in certificate.findings if "not searched further" in each.statement]
    assert ended
    assert all("10 operations" in each.method for each in ended)


def test_a_search_without_room_for_its_functions_ends():
    """The field holds a few functions; one more ends the search, with a finding."""
    field = Field(["x"], slots=2)

    def examine():
        yield "first", "integrals", lambda: FOUND
        _ = [field.call("exp", field["x"] ** n) for n in range(1, 100)]
        yield "second", "integrals", lambda: FOUND

    *reached, (statement, kind, end) = within_budget(field, "integrals", "integrals", examine())
    assert [text for text, _, _ in reached] == ["first"]
    assert (statement, kind) == ("integrals: not searched further", "integrals")
    assert end().method == searches.CROWDED
