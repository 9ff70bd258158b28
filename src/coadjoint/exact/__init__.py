"""Exact arithmetic: the field of rational functions in which every derivation and proof happens.

SymPy's sparse polynomial rings do the work and stay hidden here. Read next:
`coadjoint.exact.element`, then `coadjoint.exact.field`.
"""

from coadjoint.exact.element import BudgetSpent, Element
from coadjoint.exact.field import Field
from coadjoint.exact.jets import JetField
from coadjoint.exact.region import Condition, Region
from coadjoint.exact.text import element_text

__all__ = ["BudgetSpent", "Condition", "Element", "Field", "JetField", "Region", "element_text"]
