"""Assembly of a Setting: all components of a Spec, or those of one role, as symbols of a field.

Comes in: a Spec. Goes out: a `Setting` with room for the function calls of its formulas, and with
the region in which they are looked at. Read next: `coadjoint.derive.routes.euler_poincare`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from random import Random

from coadjoint.derive.interpret import Value
from coadjoint.derive.room import count_calls, count_room
from coadjoint.derive.setting import Named, Setting, assemble, list_components, shape
from coadjoint.exact import Condition, Field, Region
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.sections.domain import Condition as Inequality


def make_setting(spec: Spec, symbols: Sequence[str] = (), room: int = 0) -> Setting:
    """The Setting of a Spec: symbols for all its components, room for all its function calls.

    Args:
        spec: What was declared.
        symbols: Names that the routes need beyond those of the spec.
        room: How many functions are to be called beyond those of the formulas.
    """
    quantities: list[Named] = [*spec.state, *spec.defined, *spec.parameters, *spec.driving]
    quantities += spec.jets
    names = [*list_components(quantities)]
    names += [name for each in spec.reconstruction for name in each.components]
    positive = [name for p in spec.parameters if p.positive for name in p.components]
    positive += [name for each in spec.domain if (name := _positive_name(each)) in names]
    room += count_room(spec, bool(symbols))
    field = Field([*names, *symbols], room, positive)
    field.region = Region(
        parameters=frozenset(list_components(spec.parameters)), defaults=_defaults(quantities)
    )
    values: dict[str, Value] = {name: field[name] for name in names}
    for quantity in quantities:
        values[quantity.name] = assemble(quantity, values)
    for whole in spec.variables:  # also where constraints give some of its components
        values[whole.name] = assemble(whole, values)
    for each in spec.reconstruction:
        values[each.name] = shape([values[name] for name in each.components], each.shape)
    setting = Setting(spec, field, values)
    field.assume(_conditions(setting))
    return setting


def _positive_name(condition: Inequality) -> str:
    """The name that a condition such as ``q > 0`` or ``1 < q`` bounds from below; else empty."""
    smaller, larger = condition.left.tree, condition.right.tree
    if condition.sign.startswith(">"):
        smaller, larger = larger, smaller
    if not isinstance(larger, tree.Name) or not isinstance(smaller, tree.Number):
        return ""
    strict = smaller.value > 0 or (smaller.value == 0 and not condition.sign.endswith("="))
    return larger.name if strict else ""


def _conditions(setting: Setting) -> tuple[Condition, ...]:
    """The declared domain, but for bounds of reactions, which are no functions of the state."""
    conditions = []
    for each in setting.spec.domain:
        nodes = [node for side in (each.left, each.right) for node in tree.walk(side.tree)]
        named = {node.name for node in nodes if isinstance(node, tree.Name | tree.Index)}
        if not named <= setting.values.keys():
            continue
        conditions.append(Condition(setting.excess(each), strict=not each.sign.endswith("=")))
    return tuple(conditions)


def _defaults(quantities: Sequence[Named]) -> dict[str, Fraction]:
    """The default of each component that has one."""
    return {
        name: value
        for each in quantities
        for name, value in zip(each.components, each.default or (), strict=False)
    }


def sampled_setting(spec: Spec, role: str, source: Random) -> Setting:
    """The Setting with random numbers for all quantities but those of one role.

    What a formula depends on in these shows much sooner there than among all the symbols.
    """
    names = list_components(spec.having_role(role))
    field = Field(names, count_calls(spec))
    values: dict[str, Value] = {name: field[name] for name in names}
    quantities: tuple[Named, ...]
    quantities = (*spec.variables, *spec.parameters, *spec.driving, *spec.jets)
    for quantity in quantities:
        for name in quantity.components:
            number = Fraction(source.randint(1, 999), source.randint(1, 999))
            values.setdefault(name, field.number(number))
        values[quantity.name] = assemble(quantity, values)
    return Setting(spec, field, values)
