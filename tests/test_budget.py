"""Budgets: one setting raises the limit of processor time everywhere."""

import pytest

from coadjoint import limits
from coadjoint.budget import MOST, VARIABLE, allowed_seconds
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
