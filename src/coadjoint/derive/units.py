"""Units of what is emitted, as far as the declared units tell.

Comes in: a Setting, and a formula, a variable or an element. Goes out: unit text, "" where the
declared units do not tell. Read next: `coadjoint.spec.core.units`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.declared import component_units
from coadjoint.derive.setting import Declared, Setting, once
from coadjoint.exact import Element
from coadjoint.spec import Formula
from coadjoint.spec.core.units import Unit, parse_unit, product_of, unit_of, unit_text
from coadjoint.spec.model import Constraint, Variable


@once
def declared_units(setting: Setting) -> Mapping[str, Unit | None]:
    """The unit of every declared name."""
    spec = setting.spec
    quantities: Sequence[Declared] = (*spec.variables, *spec.parameters, *spec.driving)
    return {
        name: parse_unit(unit)
        for quantity in quantities
        for name, unit in (
            (quantity.name, quantity.unit),
            *zip(quantity.components, component_units(quantity), strict=True),
        )
    }


def of_formula(setting: Setting, formula: Formula) -> str:
    """The unit of a formula."""
    return unit_text(unit_of(formula.tree, declared_units(setting)))


@once
def of_energy(setting: Setting) -> str:
    """The unit of the declared Hamiltonian or Lagrangian."""
    formula = setting.spec.hamiltonian or setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian or a Hamiltonian"
    return of_formula(setting, formula)


def of_reaction(setting: Setting, constraint: Constraint) -> str:
    """The unit of a multiplier: with the residual of its constraint it makes a power."""
    units, energy = declared_units(setting), setting.spec.lagrangian
    assert energy is not None, "the reader asks for a Lagrangian with constraints"
    known = {
        "energy": unit_of(energy.tree, units),
        "time": parse_unit("s"),
        "residual": unit_of(constraint.left.tree, units) or unit_of(constraint.right.tree, units),
    }
    return unit_text(product_of(known, [("energy", 1), ("time", -1), ("residual", -1)]))


def of_momentum(setting: Setting, velocity: Variable) -> str:
    """The unit of a momentum: that of the Lagrangian over that of its velocity."""
    lagrangian = setting.spec.lagrangian
    assert lagrangian is not None, "the reader asks for a Lagrangian"
    whole = unit_of(lagrangian.tree, declared_units(setting))
    units = {"l": whole, "v": parse_unit(velocity.unit)}
    return unit_text(product_of(units, [("l", 1), ("v", -1)]))


def of_value(setting: Setting, element: Element) -> str:
    """The unit of an element, as its first addend tells it."""
    field, units = setting.field, declared_units(setting)
    written = field.quotients(field.terms(element)[0])[0]
    factors = [power for monomial in written.monomials for power in monomial.powers]
    if written.divisors or not all(name in units for name, _ in factors):
        return ""
    return unit_text(product_of(units, factors))
