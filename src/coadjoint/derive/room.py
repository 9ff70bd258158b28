"""Room: how many functions and irrational numbers the field of a spec may need.

Comes in: a Spec. Goes out: a number of places, which a field has to know before it is made.
Read next: `coadjoint.derive.setting`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from coadjoint.elementary import ELEMENTARY
from coadjoint.exact.numbers import room_for
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.tables import list_formulas

#: Functions of which elements are adjoined to the field, and how many each. The others are sums and
#: products.
_ADJOINED = {"tan": 1, "norm": 1, "pow": 2, "abs": 2, "min": 2, "max": 2} | {
    name: 2 if entry.calls_others else 1 for name, entry in ELEMENTARY.items()
}

#: Calls beyond which those of equal arguments are counted once.
COUNTED_CALLS = 200

#: The same for the length of the normal to the surface on which a ball rolls, where it is, where it
#: is projected to, and in claims about that.
BALL = 4


def count_room(spec: Spec, has_symbols: bool) -> int:
    """How many functions and numbers may be adjoined for what a spec says.

    Args:
        spec: What was declared.
        has_symbols: Whether its routes need names beyond those of the spec.
    """
    # a route, and what a transformation makes of a formula, may call its functions with other
    # arguments than the spec does
    more = len(spec.routes) * has_symbols + len(spec.transformations)
    # functions of velocities are functions of momenta, too, where these are the state
    more += bool(spec.having_role("momentum") and spec.having_role("velocity"))
    if spec.in_frame and _calls_of(spec, "parameter"):  # with numbers in their place, twice
        more += 2
    if _calls_of(spec, "velocity"):  # a Legendre transform that is not linear, with numbers as well
        more += 4
    rolls_as_ball = spec.rolling and spec.rolling.contact and spec.rolling.contact.radius
    return count_calls(spec) * (1 + more) + BALL * bool(rolls_as_ball) + _count_numbers(spec)


def count_calls(spec: Spec) -> int:
    """How many functions may be adjoined for those that the formulas of a spec call.

    Among many calls those of equal arguments count once: sums over pairs of members that are
    written out name each angle four times or more, and places that stay empty cost time in every
    product.
    """
    calls = _list_calls(spec)
    if len(calls) > COUNTED_CALLS:
        calls = list({_key(call): call for call in calls}.values())
    return sum(_ADJOINED[call.function] for call in calls)


def _key(call: tree.Call) -> object:
    """What calls share that take one place: sine and cosine do, of a difference and its opposite.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> _key(read_expression("sin(a - b)")) == _key(read_expression("cos(b - a)"))
    True
    >>> _key(read_expression("exp(a - b)")) == _key(read_expression("exp(b - a)"))
    False
    """
    entry = ELEMENTARY.get(call.function)
    if entry is None or not entry.partner:
        return call.function, call.arguments
    names = frozenset({call.function, entry.partner})
    (argument,) = call.arguments
    if isinstance(argument, tree.Binary) and argument.operator == "-":
        return names, frozenset({argument.left, argument.right})
    return names, argument


def _list_calls(spec: Spec) -> list[tree.Call]:
    """The calls of elementary functions in the formulas of a spec."""
    nodes = (node for formula in list_formulas(spec) for node in tree.walk(formula.tree))
    return [node for node in nodes if isinstance(node, tree.Call) and node.function in _ADJOINED]


def _count_numbers(spec: Spec) -> int:
    """How many irrational numbers are in algebras and their actions."""
    algebras = [symmetry.algebra for symmetry in spec.symmetries]
    algebras += [spec.algebra] if spec.algebra is not None else []
    rows: list[Mapping[Any, Any]] = [row for a in algebras for row in a.constants.values()]
    rows += [matrix for a in algebras for matrix in (*a.matrices, *a.elements)]
    actions = (variable.representation for variable in spec.variables)
    rows += [matrix for action in actions if action is not None for matrix in action.matrices]
    values = (x for row in rows for x in row.values() if not isinstance(x, int | Fraction))
    return max((room_for(x) for x in values), default=0)


def _calls_of(spec: Spec, role: str) -> bool:
    """Whether an elementary function is taken of parameters, or of variables of some role."""
    quantities = spec.parameters if role == "parameter" else spec.having_role(role)
    names = {n for each in quantities for n in (each.name, *each.components)}
    inside = (part for call in _list_calls(spec) for part in tree.walk(call))
    return any(isinstance(part, tree.Name) and part.name in names for part in inside)
