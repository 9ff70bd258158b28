"""Formulas: expressions read where the names that may occur in them are known.

Comes in: the text at a key of a spec, and a scope. Goes out: a `Formula` whose tree has been
checked for names, shapes and size. Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from coadjoint.spec.expressions import read_expression
from coadjoint.spec.faults import ExpressionError, did_you_mean
from coadjoint.spec.model import Formula, Parameter, Shape, Variable
from coadjoint.spec.positions import KeyPath
from coadjoint.spec.shapes import shape_of, words
from coadjoint.spec.sizes import check_size
from coadjoint.spec.source import Source, dotted
from coadjoint.spec.tree import Binary, Index, Name, Negate, Node, Number, walk, walk_up

#: What each role is called where it is out of place.
_ROLES = {
    "velocity": "a velocity",
    "momentum": "a momentum",
    "advected": "an advected quantity",
    "parameter": "a parameter",
}


@dataclass(frozen=True)
class Scope:
    """The names that one kind of formula may use.

    Attributes:
        kind: ``a Lagrangian``, for messages.
        takes: What it is a function of, in words.
        shapes: Shape of each name in scope, whole quantities and components.
        outside: Names that the spec declares and this kind of formula may not use, with their role.
    """

    kind: str
    takes: str
    shapes: Mapping[str, Shape]
    outside: Mapping[str, str]


def make_scope(
    kind: str,
    roles: tuple[str, ...],
    quantities: Iterable[Variable | Parameter],
    others: Iterable[str] = (),
) -> Scope:
    """The scope of a kind of formula.

    Args:
        kind: ``a Lagrangian``, for messages.
        roles: Roles of variables that it may use; parameters it always may.
        quantities: Everything the spec declares.
        others: Further names of scalars.
    """
    shapes: dict[str, Shape] = dict.fromkeys(others, ())
    outside: dict[str, str] = {}
    for quantity in quantities:
        role = quantity.role if isinstance(quantity, Variable) else "parameter"
        if role == "parameter" or role in roles:
            shapes |= dict.fromkeys(quantity.components, ())
            shapes[quantity.name] = quantity.shape
        else:
            outside |= dict.fromkeys((quantity.name, *quantity.components), role)
    plural = {"velocity": "velocities", "momentum": "momenta", "advected": "advected quantities"}
    takes = " and ".join([", ".join(plural[role] for role in roles), "parameters"])
    return Scope(kind, takes, shapes, outside)


def read_formula(source: Source, key: KeyPath, text: str, scope: Scope) -> Formula:
    """The scalar formula at a key.

    Raises:
        SpecError: A syntax error, a name out of scope, shapes that do not fit, or no scalar.
        LimitError: The expression is too large.
    """
    try:
        tree = read_expression(text)
        _check_roles(tree, scope)
        shape = shape_of(tree, scope.shapes)
        check_size(tree, scope.shapes)
        if shape != ():
            hint = "Write dot(a, a) for the square of a vector." if len(shape) == 1 else ""
            problem = f"the value is {words(shape)}"
            raise ExpressionError(
                problem, 0, len(text), found=words(shape), expected="a scalar", hint=hint
            )
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None
    line = source.line(source.positions.value(key))
    return Formula(text, tree, shape, dotted(key), line)


def _check_roles(tree: Node, scope: Scope) -> None:
    """Refuse a declared name that this kind of formula may not use, saying why."""
    for node in walk(tree):
        if isinstance(node, (Name, Index)) and node.name in scope.outside:
            raise ExpressionError(
                f"{node.name!r} is {_ROLES[scope.outside[node.name]]}",
                node.start,
                node.end,
                found=node.name,
                expected=f"{scope.kind} in terms of {scope.takes}",
                hint=did_you_mean(node.name, scope.shapes),
            )


def read_combination(
    source: Source, key: KeyPath, text: str, basis: tuple[str, ...]
) -> dict[int, Fraction]:
    """A linear combination of basis names with exact coefficients, such as ``-2*e1 + e3/2``.

    Raises:
        SpecError: A syntax error, an unknown name, or no linear combination.
    """
    try:
        tree = read_expression(text)
        scope: dict[str, Shape] = dict.fromkeys(basis, ())
        shape_of(tree, scope)
        check_size(tree, scope)
        return _combination(tree, {name: place for place, name in enumerate(basis)})
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None


_Linear = dict[int | None, Fraction]  # coefficient of each basis vector, None for the constant


def _combination(tree: Node, places: Mapping[str, int]) -> dict[int, Fraction]:
    found: dict[int, _Linear] = {}
    for node in walk_up(tree):
        match node:
            case Number(value=value):
                result: _Linear = {None: value}
            case Name(name=name):
                result = {places[name]: Fraction(1)}
            case Negate(operand=operand):
                result = _times(found[id(operand)], Fraction(-1))
            case Binary(operator=operator, left=left, right=right):
                a, b = found[id(left)], found[id(right)]
                result = _joined(node, operator, a, b)
            case _:
                raise _not_linear(node)
        found[id(node)] = {place: value for place, value in result.items() if value != 0}
    total = found[id(tree)]
    if None in total:
        raise _not_linear(tree)
    return {place: value for place, value in total.items() if place is not None}


def _joined(node: Node, operator: str, a: _Linear, b: _Linear) -> _Linear:
    if operator in "+-":
        sign = 1 if operator == "+" else -1
        return {p: a.get(p, Fraction(0)) + sign * b.get(p, Fraction(0)) for p in a | b}
    if operator == "*" and not b.keys() <= {None}:
        a, b = b, a
    if not b.keys() <= {None}:
        raise _not_linear(node)
    factor = b.get(None, Fraction(0))
    return _times(a, factor if operator == "*" else 1 / factor)


def _times(a: _Linear, factor: Fraction) -> _Linear:
    return {place: value * factor for place, value in a.items()}


def _not_linear(node: Node) -> ExpressionError:
    return ExpressionError(
        "this is no linear combination of the basis",
        node.start,
        node.end,
        found="",
        expected="sums of numbers times basis names, such as -2*e1 + e3/2, or 0",
    )
