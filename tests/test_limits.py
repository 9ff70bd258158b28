"""The limits: the table for users is the table of constants."""

import re

from coadjoint import limits
from coadjoint.resources import derivations_folder

ROW = re.compile(r"^\| `([A-Z_]+)` \| (\d+) \|", re.MULTILINE)


def documented():
    """The table of docs/limits.md."""
    text = (derivations_folder().parent / "docs" / "limits.md").read_text(encoding="utf-8")
    return {name: int(value) for name, value in ROW.findall(text)}


def constants():
    """The constants of the module."""
    return {name: value for name, value in vars(limits).items() if name.isupper()}


def test_documented_limits_are_the_constants():
    """docs/limits.md names every limit with its value, and no other."""
    assert len(constants()) >= 20
    assert documented() == constants()


def test_limits_comparison_sees_a_changed_value():
    """The check above can fail: another value is another table."""
    assert documented() != {**constants(), "EXPONENT": 33}
