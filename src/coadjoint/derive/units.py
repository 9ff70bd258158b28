"""Units of what is emitted, as far as the spec tells them.

Comes in: a Setting, and a formula, a variable or an element. Goes out: unit text, "" where the
spec does not tell. Read next: `coadjoint.spec.dimensions`, which checks and infers units.
"""

from __future__ import annotations

from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.spec import Formula
from coadjoint.spec.core.units import ONE, product_of
from coadjoint.spec.model import Constraint, Variable


def of_formula(setting: Setting, formula: Formula) -> str:
    """The unit of a formula."""
    return setting.spec.units.label_value(formula.tree)


def of_energy(setting: Setting) -> str:
    """The unit of the energy."""
    units = setting.spec.units
    return units.label(units.names["energy"].entries)


def of_reaction(setting: Setting, constraint: Constraint) -> str:
    """The unit of a multiplier: with the residual of its constraint it makes a power."""
    units = setting.spec.units
    return units.label(units.names[constraint.reaction].entries)


def of_momentum(setting: Setting, velocity: Variable) -> str:
    """The unit of a momentum: that of the energy over that of its velocity."""
    units = setting.spec.units
    (energy,) = units.names["energy"].entries
    along = [units.names[name].entries[0] for name in velocity.components]
    return units.label((energy or ONE) / (each or ONE) for each in along)


def of_value(setting: Setting, element: Element) -> str:
    """The unit of an element, as its first addend tells it."""
    field, units = setting.field, setting.spec.units
    written = field.quotients(field.terms(element)[0])[0]
    factors = [power for monomial in written.monomials for power in monomial.powers]
    if written.divisors or not all(name in units.names for name, _ in factors):
        return ""
    return units.label([product_of((units.names[n].entries[0] or ONE, e) for n, e in factors)])
