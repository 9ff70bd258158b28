"""The list of long cases: each is a case, and beside each a shorter one is run by `make test`."""

import pytest

from tests.conftest import COLLECTED, LONG_CASES


def list_mistakes(listed, collected):
    """Lines that name nothing of what was collected, and tests of which no case is left.

    Tests of files that were not collected say nothing.
    """
    files = {name.partition("::")[0] for name in collected}
    known = {name for name in listed if name.partition("::")[0] in files}
    left = {name.partition("[")[0] for name in collected - listed}
    emptied = {name.partition("[")[0] for name in known & collected} - left
    return sorted(f"{name} is no test" for name in known - collected) + sorted(
        f"{name} has no case left" for name in emptied
    )


def test_beside_each_long_case_is_a_shorter_one(request):
    """A case that is renamed, or a list that leaves nothing of a test, would be a hole."""
    assert len(LONG_CASES) > 100
    if any("::" in each for each in request.config.args):
        pytest.skip("of some files, single tests were asked for")
    assert not list_mistakes(LONG_CASES, request.config.stash[COLLECTED])


def test_mistakes_in_the_list_are_seen():
    """A name of no case, and a test all of whose cases are long; other files are not asked."""
    collected = frozenset(f"tests/test_top.py::test_energy[{n}]" for n in (1, 2, 3))
    longest = {"tests/test_top.py::test_energy[3]", "tests/test_body.py::test_energy[1]"}
    assert not list_mistakes(longest, collected)
    wrong = {"tests/test_top.py::test_energy[4]"}
    assert list_mistakes(longest | wrong, collected) == [
        "tests/test_top.py::test_energy[4] is no test"
    ]
    assert list_mistakes(collected, collected) == [
        "tests/test_top.py::test_energy has no case left"
    ]
