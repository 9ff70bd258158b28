"""Formulas: expressions read where the names that may occur in them are known.

Comes in: the text at a key of a spec, and a scope. Goes out: a `Formula` whose tree has been
checked for names, shapes and size. Read next: `coadjoint.spec.core.reading`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Protocol

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import Named, Shape
from coadjoint.spec.core.definitions import Definition, expand, functions
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, did_you_mean, fault_at
from coadjoint.spec.core.members import Members, tell_count
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import shape_of, words
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.source import Place, Source
from coadjoint.spec.core.tree import Index, Name, Node, walk
from coadjoint.spec.core.written_out import write_out


class HasComponents(Named, Protocol):
    """What is declared and has components: a variable, a parameter, an input or the time."""

    @property
    def role(self) -> str:
        """One of `ROLES`."""

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas."""


@dataclass(frozen=True)
class Formula(Place):
    """A parsed expression, its text as typed (for messages and documents) and where it stands.

    Attributes:
        text: As typed, ASCII; used in messages, JSON and documents only.
        typed: The parsed tree, in which definitions are names: documents show it.
        tree: The shape-checked tree, with definitions expanded.
        shape: Shape of its value.
        sums: In a spec with an index, the tree with its sums over members; else None.
    """

    text: str
    typed: Node
    tree: Node
    shape: Shape
    sums: Node | None = None

    @property
    def in_one_line(self) -> str:
        """The text without its line breaks, for statements and tables."""
        return " ".join(self.text.split())


#: What a spec declares and a formula may use.
Declared = HasComponents | Definition
#: What the variables of each role are called together.
PLURALS = {
    "velocity": "velocities",
    "momentum": "momenta",
    "advected": "advected quantities",
    "coordinate": "coordinates",
    "contact": "points of contact",
    "input": "inputs",
    "time": "time",
}
#: Roles that few kinds of formulas may use: what acts on the motion, or is measured along it.
DRIVING = ("input", "time")
#: What each role is called where it is out of place.
ROLES = {
    "velocity": "a velocity",
    "momentum": "a momentum",
    "advected": "an advected quantity",
    "coordinate": "a coordinate",
    "contact": "a point of contact",
    "parameter": "a parameter",
    "input": "an input",
    "time": "the time",
}


#: The highest derivative of a field that formulas may name.
MOST_DERIVATIVES: Final = 4


@dataclass(frozen=True)
class Scope:
    """The names that one kind of formula may use.

    Attributes:
        kind: ``a Lagrangian``, for messages.
        takes: What it is a function of, in words.
        shapes: Shape of each name in scope, whole quantities and components.
        outside: Names that the spec declares and this kind of formula may not use, with their role.
        definitions: What may be expanded, by name.
        coordinates: The coordinates of space along which fields have derivatives.
    """

    kind: str
    takes: str
    shapes: Mapping[str, Shape]
    outside: Mapping[str, str]
    definitions: Mapping[str, Definition] = field(default_factory=dict)
    coordinates: frozenset[str] = frozenset()


def make_scope(
    kind: str,
    roles: tuple[str, ...],
    quantities: Iterable[Declared],
    others: Mapping[str, Shape] | Iterable[str] = (),
    *,
    driven: Sequence[str] = (),
) -> Scope:
    """The scope of a kind of formula.

    Args:
        kind: ``a Lagrangian``, for messages.
        roles: Roles of variables that it may use; parameters it always may.
        quantities: Everything the spec declares.
        others: Further names with their shapes, or of scalars.
        driven: Which of `DRIVING` it may use.
    """
    shapes = dict(others) if isinstance(others, Mapping) else dict.fromkeys(others, ())
    outside: dict[str, str] = {}
    definitions: dict[str, Definition] = {}
    present: dict[str, None] = {}
    coordinates = set[str]()
    for quantity in quantities:
        coordinates |= {getattr(quantity, key, "") for key in ("coordinate", "second")} - {""}
        if isinstance(quantity, Definition):
            definitions[quantity.name] = quantity
            continue
        role = quantity.role
        if role in driven:
            present[role] = None
        if role in present or role == "parameter" or role in roles:
            shapes |= dict.fromkeys(quantity.components, ())
            shapes[quantity.name] = quantity.value_shape
        else:
            outside |= dict.fromkeys((quantity.name, *quantity.components), role)
    plurals = [PLURALS[role] for role in roles]
    plurals += ["parameters", *(PLURALS[role] for role in present)]
    takes = " and ".join(filter(None, [", ".join(plurals[:-1]), plurals[-1]]))
    return Scope(
        kind=kind,
        takes=takes,
        shapes=shapes,
        outside=outside,
        definitions=definitions,
        coordinates=frozenset(coordinates),
    )


def read_formula(
    source: Source, key: KeyPath, text: str, scope: Scope, *, any_shape: bool = False
) -> Formula:
    """The formula at a key, with its definitions expanded.

    Args:
        source: The text of the spec.
        key: Where the expression stands.
        text: The expression.
        scope: The names that it may use.
        any_shape: Whether it may be a vector or a matrix, too.

    Raises:
        SpecError: A syntax error, a name out of scope, shapes that do not fit, or no scalar.
        LimitError: The expression is too large.
    """
    try:
        members = source.members
        called = functions(scope.definitions)
        typed = read_expression(text, called, indexed=members is not None)
        whole = expand(typed, scope.definitions, source.spent)
        tree = whole if members is None else write_out(whole, members, key)
        _check_roles(tree, scope)
        _check_derivatives(tree, scope)
        if members is not None:
            _check_number(tree, scope, members)
        shape = shape_of(tree, scope.shapes)
        check_size(tree, scope.shapes)
        if shape != () and not any_shape:
            hint = "Write dot(a, a) for the square of a vector." if len(shape) == 1 else ""
            problem = f"the value is {words(shape)}"
            raise ExpressionError(problem, 0, len(text), words(shape), "a scalar", hint)
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None
    place = source.place(key)
    return Formula(
        text=text,
        typed=typed,
        tree=tree,
        shape=shape,
        path=key,
        line=place.line,
        excerpt=place.excerpt,
        sums=None if members is None else whole,
    )


def _check_number(tree: Node, scope: Scope, members: Members) -> None:
    """Say how the number of members gets its usual name, where that is not declared."""
    for node in walk(tree):
        if isinstance(node, Name) and node.name in ("n", "N") and node.name not in scope.shapes:
            hint = did_you_mean(node.name, scope.shapes, tell_count(members, node.name))
            expected = "a variable or parameter of this spec"
            raise fault_at(node, f"{node.name!r} is not declared", node.name, expected, hint)


def _check_roles(tree: Node, scope: Scope) -> None:
    """Refuse a declared name that this kind of formula may not use, saying why."""
    for node in walk(tree):
        if isinstance(node, (Name, Index)) and node.name in scope.outside:
            role = scope.outside[node.name]
            problem = f"{node.name!r} is {ROLES[role]}"
            expected = f"{scope.kind} in terms of {scope.takes}"
            constant = "Put a parameter in its place." if role in DRIVING else ""
            hint = did_you_mean(node.name, scope.shapes, constant)
            raise fault_at(node, problem, node.name, expected, hint)


def _check_derivatives(tree: Node, scope: Scope) -> None:
    """Refuse a derivative along space that is higher than those that have names, saying so."""
    along = "|".join(map(re.escape, sorted(scope.coordinates)))
    for node in walk(tree):
        if not along or not isinstance(node, (Name, Index)) or node.name in scope.shapes:
            continue
        field, _, word = node.name.rpartition("_")
        if field in scope.shapes and re.fullmatch(f"({along})+", word):
            order = len(re.findall(along, word))
            problem = f"{node.name!r} is a derivative of order {order}, and fewer are named"
            hint = f"Write derivatives = {order} in [space]." if order <= MOST_DERIVATIVES else ""
            expected = f"derivatives up to {MOST_DERIVATIVES} at the most"
            raise fault_at(node, problem, node.name, expected, hint)


def read_fitting(
    source: Source, key: KeyPath, text: str, scope: Scope, shape: Shape, name: str, hint: str = ""
) -> Formula:
    """The formula at a key, of the shape of the quantity of some name.

    Raises:
        SpecError: As `read_formula`, or the value has another shape.
    """
    formula = read_formula(source, key, text, scope, any_shape=True)
    if formula.shape != shape:
        raise misfit(source, key, formula, f"{words(shape)}, as {name!r} is", hint)
    return formula


def misfit(
    source: Source, key: KeyPath, formula: Formula, expected: str, hint: str = ""
) -> CoadjointError:
    """A formula whose value has another shape than it may have."""
    value = words(formula.shape)
    return source.fault(key, f"the value is {value}", value, expected, hint)
