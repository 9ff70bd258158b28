"""Formulas of the state: text to a NumPy function of states, parameters, inputs and time.

Comes in: the text of a formula, in the language of specs, and the names of a System. Goes out: a
`Formula`, which evaluates it at many points at a time. The text is read by the reader of specs and
never executed.
Read next: `coadjoint.solve.events`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import KernelArgumentError
from coadjoint.spec.core import tree
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.shapes import shape_of, words

if TYPE_CHECKING:
    from coadjoint.array_types import Array

    Shape = tuple[int, ...]


@dataclass(frozen=True)
class Rows:
    """What a name with the number of a member stands for: ``r`` and ``r2``, in ``r2[0]``.

    Attributes:
        quantity: The quantity of all members that it belongs to.
        place: Which component it is, counted from 0; empty for all.
        numbers: How many numbers a member has: two of a point of a plane, ``w[3, 5]``.
    """

    quantity: str
    place: tuple[int, ...] = ()
    numbers: int = 1


class Formula:
    """A scalar expression in names that a System declares.

    Args:
        text: The expression.
        scope: The shape of each name that may occur.
        label: What the formula is, for messages.
        members: What a name with the number of a member stands for, in a system of equal members.

    Attributes:
        text: As given.
        names: The names that occur.
        terms: The terms of the sum that it is.

    Raises:
        KernelArgumentError: A syntax error, an unknown name, or a value that is no scalar.
    """

    def __init__(
        self,
        text: str,
        scope: Mapping[str, Shape],
        label: str,
        members: Mapping[str, Rows] = MappingProxyType({}),
    ) -> None:
        try:
            self._tree = _place_members(read_expression(text), scope, members)
            shape = shape_of(self._tree, scope)
        except ExpressionError as error:
            raise _explain(error, text, label) from error
        if shape:
            raise KernelArgumentError(
                f"{label}: the value is {words(shape)}; expected a scalar. Take a component, such "
                "as v[1], or norm(v).",
                found=text,
            )
        self.text = text
        parts = tree.walk(self._tree)
        self.names = frozenset(p.name for p in parts if isinstance(p, tree.Name | tree.Index))
        self.terms = tuple(_list_terms(self._tree))

    def evaluate(self, values: Mapping[str, Array]) -> tuple[Array, Array]:
        """The value at points, and its size: the sum of the magnitudes of its terms.

        Args:
            values: The value of each name that occurs, ``(*shape, P)``: numbers, or objects that
                add, multiply and have the functions of the language, such as an `Enclosure`.

        Returns:
            Two arrays, ``(P,)`` or ``(1,)`` where nothing depends on the point.
        """
        known = tree.evaluate_nodes(self._tree, lambda node, below: _value(node, below, values))
        size = reduce(np.add, (np.abs(known[id(term)]) for term in self.terms))
        return known[id(self._tree)], size


def _place_members(
    whole: tree.Node, scope: Mapping[str, Shape], members: Mapping[str, Rows]
) -> tree.Node:
    """A tree with rows of all members in the place of quantities of one member.

    As in specs, members are counted from 0 and components from 1: of a vector r, ``r[0]`` is that
    of member 0, and ``r[0, 2]`` its second component, which is also ``r2[0]``.
    """

    def place(node: tree.Node, below: list[tree.Node]) -> tree.Node:
        if isinstance(node, tree.Index) and node.name in members:
            return _list_rows(node, members[node.name], scope[members[node.name].quantity])
        return tree.rebuild(node, below)

    return tree.fold(whole, place) if members else whole


def _list_rows(node: tree.Index, rows: Rows, whole: Shape) -> tree.Node:
    """A component of a member, or a vector or matrix of them."""
    shape, counts = whole[: -rows.numbers], whole[-rows.numbers :]
    members, component = node.indices[: rows.numbers], node.indices[rows.numbers :]
    told = ", ".join(map(str, members))
    if len(members) < rows.numbers or any(
        not 0 <= n < count for n, count in zip(members, counts, strict=True)
    ):
        problem = f"there is no member {told} of {node.name}"
        most = ", ".join(str(count - 1) for count in counts)
        first = ", ".join("0" for _ in counts)
        raise fault_at(node, problem, expected=f"members {first} to {most}")
    given = (*rows.place, *(index - 1 for index in component))
    if len(given) > len(shape) or any(not 0 <= k < n for k, n in zip(given, shape, strict=False)):
        own = tuple(shape[len(rows.place) :])
        problem = f"{node.name}[{told}] is {words(own)} and has no such component"
        raise fault_at(node, problem, expected="components counted from 1")
    start, end = node.start, node.end

    def build(above: tuple[int, ...]) -> tree.Node:
        if len(above) == len(shape):
            indices = tuple(index + 1 for index in (*above, *members))
            return tree.Index(name=rows.quantity, indices=indices, start=start, end=end)
        parts = tuple(build((*above, k)) for k in range(shape[len(above)]))
        function = "vector" if len(above) == len(shape) - 1 else "rows"
        return tree.Call(function=function, arguments=parts, start=start, end=end)

    return build(given)


def _explain(error: ExpressionError, text: str, label: str) -> KernelArgumentError:
    """A fault of an expression as the error of an argument."""
    expected = f"; expected {error.expected}" if error.expected else ""
    return KernelArgumentError(
        f"{label}: {error.problem}{expected}. {error.hint}".rstrip(), found=text
    )


def _list_terms(node: tree.Node) -> Iterable[tree.Node]:
    """The terms of the sum that an expression is."""
    match node:
        case tree.Binary(operator="+" | "-", left=left, right=right):
            return [*_list_terms(left), *_list_terms(right)]
        case tree.Negate(operand=operand):
            return _list_terms(operand)
    return [node]


def _value(node: tree.Node, below: list[Array], values: Mapping[str, Array]) -> Array:
    """The value of one node from those of its children; points are the last axis."""
    match node:
        case tree.Number(value=value):
            return np.array([float(value)])
        case tree.Name(name=name):
            return values[name]
        case tree.Index(name=name, indices=indices):
            entry: Array = values[name][tuple(index - 1 for index in indices)]
            return entry
        case tree.Component(indices=indices):
            part: Array = below[0][tuple(index - 1 for index in indices)]
            return part
        case tree.Negate():
            return -below[0]
        case tree.Power(exponent=exponent):
            return _power(below[0], exponent)
        case tree.Binary(operator=operator):
            return _BINARY[operator](*below)
        case tree.Call(function=function):
            return _FUNCTIONS[function](*below)
    raise AssertionError(node)


# -- vectors and matrices of arrays ---------------------------------------------------------------
# Sums are written out, so that a value has the same bits among any number of others.


def _stack(parts: Iterable[Array]) -> Array:
    """Parts as the rows of one array."""
    return np.stack(np.broadcast_arrays(*parts))


def _dot(a: Iterable[Array], b: Iterable[Array]) -> Array:
    return reduce(np.add, (x * y for x, y in zip(a, b, strict=True)))


def _multiply(a: Array, b: Array) -> Array:
    """A scalar times anything, a matrix times a vector or a matrix."""
    if a.ndim == 1 or b.ndim == 1:
        return a * b
    if b.ndim == 2:
        return _stack(_dot(row, b) for row in a)
    return _stack(_stack(_dot(row, column) for column in b.swapaxes(0, 1)) for row in a)


def _power(base: Array, exponent: int) -> Array:
    """A power of a scalar or a square matrix, by products."""
    if exponent < 0:
        base = 1.0 / base if base.ndim == 1 else _inverse(base)
    one = np.ones(1) if base.ndim == 1 else _diag(np.ones((len(base), 1)))
    return reduce(_multiply, [base] * abs(exponent)) if exponent else one


def _complex(a: Array, b: Array) -> Array:
    """A complex matrix as a real one of twice the size."""
    a, b = np.broadcast_arrays(a, b)
    above, below = np.concatenate([a, -b], axis=1), np.concatenate([b, a], axis=1)
    return np.concatenate([above, below], axis=0)


def _cross(a: Sequence[Array] | Array, b: Sequence[Array] | Array) -> Array:
    pairs = ((1, 2), (2, 0), (0, 1))
    return _stack(a[i] * b[j] - a[j] * b[i] for i, j in pairs)


def _multiply_quaternions(a: Array, b: Array) -> Array:
    """The real part, then the vector."""
    (s, *v), (t, *w) = a, b
    sums = (s * y + t * x + z for x, y, z in zip(v, w, _cross(v, w), strict=True))
    return _stack([s * t - _dot(v, w), *sums])


def _conjugate(a: Array) -> Array:
    return _stack([a[0], *(-x for x in a[1:])])


def _rotate(a: Array, v: Array) -> Array:
    """The vector of ``a v a*``."""
    turned = _multiply_quaternions(
        _multiply_quaternions(a, _stack([np.zeros(1), *v])), _conjugate(a)
    )
    return turned[1:]


def _rotation(a: Array) -> Array:
    """The matrix by which a quaternion rotates, or the turning part of a pose."""
    if a.ndim == 3:
        return a[:, :-1]
    return _stack(_rotate(a, axis) for axis in np.eye(3)[..., np.newaxis]).swapaxes(0, 1)


def _hat(a: Array) -> Array:
    zero = np.zeros(1)
    rows = ((zero, -a[2], a[1]), (a[2], zero, -a[0]), (-a[1], a[0], zero))
    return _stack(_stack(row) for row in rows)


def _diag(a: Array) -> Array:
    """A vector as a diagonal matrix; the diagonal of a matrix as a vector."""
    places, zero = range(len(a)), np.zeros(1)
    if a.ndim == 3:
        return _stack(a[i, i] for i in places)
    return _stack(_stack(a[i] if i == j else zero for j in places) for i in places)


def _determinant(a: Array) -> Array:
    """By the first row."""
    if len(a) == 1:
        return np.asarray(a[0, 0])
    minors = (_determinant(_remove(a, 0, j)) for j in range(len(a)))
    return reduce(np.add, ((-1) ** j * a[0, j] * minor for j, minor in enumerate(minors)))


def _inverse(a: Array) -> Array:
    """By cofactors."""
    places, share = range(len(a)), 1.0 / _determinant(a)
    if len(a) == 1:
        return share[np.newaxis, np.newaxis]
    return _stack(
        _stack((-1) ** (i + j) * _determinant(_remove(a, j, i)) * share for j in places)
        for i in places
    )


def _remove(a: Array, row: int, column: int) -> Array:
    """A matrix without a row and a column."""
    return np.delete(np.delete(a, row, axis=0), column, axis=1)


_BINARY: dict[str, Callable[[Array, Array], Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": _multiply,
    "/": np.divide,
}
_FUNCTIONS: dict[str, Callable[..., Array]] = {
    "dot": _dot,
    "cross": _cross,
    "commutator": lambda a, b: _multiply(a, b) - _multiply(b, a),
    "trace": lambda a: reduce(np.add, _diag(a)),
    "transpose": lambda a: a.swapaxes(0, 1),
    "det": _determinant,
    "inverse": _inverse,
    "hat": _hat,
    "diag": _diag,
    "norm": lambda a: np.sqrt(_dot(a, a)),
    "outer": lambda a, b: _stack(_stack(x * y for y in b) for x in a),
    "rows": lambda *rows: _stack(rows),
    "vector": lambda *components: _stack(components),
    "complex": _complex,
    "qmul": _multiply_quaternions,
    "conjugate": _conjugate,
    "rotate": _rotate,
    "rotation": _rotation,
    "translation": lambda a: a[:, -1],
    "tan": np.tan,
    "pow": np.power,
    "abs": np.abs,
    "min": np.minimum,
    "max": np.maximum,
    **{name: getattr(np, each.numpy_name) for name, each in ELEMENTARY.items()},
}
