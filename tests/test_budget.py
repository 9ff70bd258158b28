"""Budgets: one setting raises the limit everywhere, and a search stops where its work says so."""

import pytest

from coadjoint import limits
from coadjoint.budget import MOST, VARIABLE, Budget, allowed_seconds
from coadjoint.errors import ResourceError


def test_an_argument_goes_before_the_environment_and_that_before_the_default(monkeypatch):
    """The three sources in their order."""
    monkeypatch.delenv(VARIABLE, raising=False)
    assert allowed_seconds() == limits.WORKER_SECONDS
    monkeypatch.setenv(VARIABLE, " 900 ")
    assert allowed_seconds() == 900
    assert allowed_seconds(1.2) == 2


@pytest.mark.parametrize("given", ["soon", "-1", "0", "nan", "inf", "1e99", str(MOST + 1)])
def test_what_is_no_number_of_seconds_is_refused_by_name(monkeypatch, given):
    """The message names the variable and the value."""
    monkeypatch.setenv(VARIABLE, given)
    with pytest.raises(ResourceError, match=rf"{VARIABLE} is '{given}'"):
        allowed_seconds()


def test_a_search_that_counts_its_work_stops_at_the_same_place():
    """Steps decide before time does, and what is spent stays spent."""
    for _ in range(3):
        budget = Budget(seconds=1000, steps=10)
        assert [budget.take(4) for _ in range(4)] == [True, True, False, False]
        assert (budget.taken, budget.spent()) == (8, True)


def test_processor_time_ends_what_does_not_count():
    """A loop that only asks ends once its seconds are used up."""
    budget = Budget(seconds=0.05)
    assert not budget.spent()
    while not budget.spent():
        pass
    assert budget.used() >= 0.05
    assert not budget.take()
