"""Exact arithmetic: the field of rational functions in which every derivation and proof happens.

SymPy's sparse polynomial rings do the work and stay hidden here; the names below load SymPy on
first use, so that the reader of specs can use the linear algebra without it. Read next:
`coadjoint.exact.element`, then `coadjoint.exact.field`; `coadjoint.exact.linear` for vectors of
numbers.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from coadjoint.exact.denominators import BudgetSpent
    from coadjoint.exact.element import Element
    from coadjoint.exact.field import Field
    from coadjoint.exact.region import Condition, Region
    from coadjoint.exact.text import element_text

__all__ = ["BudgetSpent", "Condition", "Element", "Field", "Region", "element_text"]

#: Module of each name.
_HOMES = {
    "BudgetSpent": "denominators",
    "Condition": "region",
    "Element": "element",
    "Field": "field",
    "Region": "region",
    "element_text": "text",
}


def __getattr__(name: str) -> Any:
    """A public name, from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
