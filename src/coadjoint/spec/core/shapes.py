"""Shapes: what the functions and operators of the expression language accept and return.

Comes in: a tree and the shapes of its names. Goes out: the shape of its value, or an
`ExpressionError` that says both shapes in words. A shape is ``()`` for a scalar, ``(n,)`` for a
vector, ``(n, m)`` for a matrix. Read next: `coadjoint.spec.core.sizes`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from coadjoint.elementary import ELEMENTARY
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import did_you_mean, fault_at, list_names
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Index,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Power,
    Sum,
    children,
    evaluate_nodes,
)

#: Functions of scalars by how many they take: those of kernels, and what is written by these.
SCALAR = {each.name: each.arity for each in ELEMENTARY.values()} | {"tan": 1}
#: Functions of scalars that are linear between kinks, where an argument or a difference is 0.
PIECEWISE = ("abs", "min", "max")
#: Determinants and inverses are written out; larger systems are solved inside the kernel.
LARGEST_INVERSE = 3
#: A quaternion in formulas: its real part, then its vector.
QUATERNION = (4,)


def _is_square(a: Shape) -> bool:
    return len(a) == 2 and a[0] == a[1]


def _is_small_square(a: Shape) -> bool:
    return _is_square(a) and a[0] <= LARGEST_INVERSE


def _rotation(a: Shape) -> Shape | None:
    """The turning part: of a quaternion, or of a pose with one column more than rows."""
    if a == QUATERNION:
        return (3, 3)
    return (a[0], a[0]) if _is_pose(a) else None


def _is_pose(a: Shape) -> bool:
    return len(a) == 2 and a[1] == a[0] + 1


_Rule = Callable[..., Shape | None]
#: The shape of a value by the shapes of the arguments; None if these do not fit.
_RULES: Mapping[str, _Rule] = MappingProxyType(
    {
        "dot": lambda a, b: () if len(a) == 1 and a == b else None,
        "cross": lambda a, b: (3,) if a == b == (3,) else None,
        "commutator": lambda a, b: a if _is_square(a) and a == b else None,
        "trace": lambda a: () if _is_square(a) else None,
        "transpose": lambda a: a[::-1] if len(a) == 2 else None,
        "det": lambda a: () if _is_small_square(a) else None,
        "inverse": lambda a: a if _is_small_square(a) else None,
        "complex": lambda a, b: (2 * a[0], 2 * a[1]) if len(a) == 2 and a == b else None,
        "hat": lambda a: (3, 3) if a == (3,) else None,
        "vee": lambda a: (3,) if a == (3, 3) else None,
        "diag": lambda a: a * 2 if len(a) == 1 else a[:1] if _is_square(a) else None,
        "norm": lambda a: () if len(a) == 1 else None,
        "outer": lambda a, b: a + b if len(a) == len(b) == 1 else None,
        "rows": lambda *a: (len(a), *a[0]) if len(a[0]) == 1 and set(a) == {a[0]} else None,
        "vector": lambda *a: None if any(a) else (len(a),),
        "qmul": lambda a, b: a if a == b == QUATERNION else None,
        "conjugate": lambda a: a if a == QUATERNION else None,
        "rotate": lambda a, b: b if a == QUATERNION and b == (3,) else None,
        "rotation": _rotation,
        "translation": lambda a: a[:1] if _is_pose(a) else None,
        **dict.fromkeys((*SCALAR, *PIECEWISE, "pow"), lambda *a: None if any(a) else ()),
    }
)


@dataclass(frozen=True)
class Function:
    """A function of the expression language.

    Attributes:
        arity: Number of arguments; 0 for any number but none.
        takes: The arguments that fit, in words.
        meaning: What it is, for documents.
    """

    arity: int
    takes: str
    meaning: str


_SMALL = f"a square matrix of at most {LARGEST_INVERSE} by {LARGEST_INVERSE}"
FUNCTIONS: Mapping[str, Function] = MappingProxyType(
    {
        "dot": Function(2, "two vectors of one length", "a_i b_i"),
        "cross": Function(2, "two 3-vectors", "a x b"),
        "commutator": Function(2, "two square matrices of one size", "AB - BA"),
        "trace": Function(1, "a square matrix", "A_ii"),
        "transpose": Function(1, "a matrix", "A_ji"),
        "det": Function(1, _SMALL, "determinant"),
        "inverse": Function(1, _SMALL, "inverse matrix"),
        "complex": Function(
            2, "two matrices of one size", "A + iB as the real matrix of A, -B; B, A"
        ),
        "hat": Function(1, "a 3-vector", "the matrix with hat(a)*b = a x b"),
        "diag": Function(
            1, "a vector or a square matrix", "diagonal matrix of a vector, or the reverse"
        ),
        "outer": Function(2, "two vectors", "matrix a_i b_j"),
        "vector": Function(0, "scalars", "vector of these components"),
        "rows": Function(0, "vectors of one length", "matrix with these rows"),
        "norm": Function(1, "a vector", "sqrt(dot(a, a))"),
        "qmul": Function(2, "two quaternions, vectors of 4", "product of quaternions a b"),
        "conjugate": Function(1, "a quaternion, a vector of 4", "conjugate a* of a quaternion"),
        "rotate": Function(
            2,
            "a quaternion and a 3-vector",
            "the vector of a b a*, which is b turned by a where a has length 1",
        ),
        "rotation": Function(
            1,
            "a quaternion, or a pose with one column more than rows",
            "matrix of `rotate(a, b)`, or R of a pose `[R, x]`",
        ),
        "translation": Function(1, "a pose with one column more than rows", "x of a pose `[R, x]`"),
        "tan": Function(1, "a scalar", "tangent"),
        "pow": Function(2, "two scalars", "power with any exponent, of a positive base: a^b"),
        "abs": Function(1, "a scalar", "absolute value"),
        "min": Function(2, "two scalars", "the smaller one"),
        "max": Function(2, "two scalars", "the larger one"),
        **{e.name: Function(e.arity, e.takes, e.meaning) for e in ELEMENTARY.values()},
    }
)


#: Functions that equations are written with, and no formula of a spec may call.
_WRITTEN = {"vee": Function(1, "a 3 by 3 matrix", "the vector whose hat it is")}


def words(shape: Shape) -> str:
    """A shape as a person says it.

    >>> words(()), words((3,)), words((8, 2))
    ('a scalar', 'a 3-vector', 'an 8 by 2 matrix')
    """
    if not shape:
        return "a scalar"
    article = "an" if str(shape[0]).startswith("8") or shape[0] in (11, 18) else "a"
    if len(shape) == 1:
        return f"{article} {shape[0]}-vector"
    return f"{article} {shape[0]} by {shape[1]} matrix"


def shape_of(tree: Node, scope: Mapping[str, Shape]) -> Shape:
    """The shape of an expression; every part of it is checked.

    Args:
        tree: What `coadjoint.spec.core.expressions.read_expression` returned.
        scope: Shape of every name that may occur, whole quantities and components alike.

    Raises:
        ExpressionError: A name is not in scope, or shapes do not fit.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> shape_of(read_expression("diag(I)*Omega"), {"I": (3,), "Omega": (3,)})
    (3,)
    """
    return shapes(tree, scope)[id(tree)]


def shapes(tree: Node, scope: Mapping[str, Shape]) -> dict[int, Shape]:
    """The shape of every node of a tree, by ``id``; what bounds a sum has none.

    Args:
        tree: As for `shape_of`, or a formula of the members of a family.
        scope: Likewise; of what members have, the shape of that of one member.

    Raises:
        ExpressionError: As for `shape_of`.
    """
    return evaluate_nodes(tree, lambda node, below: _shape(node, below, scope), _below)


def _below(node: Node) -> tuple[Node, ...]:
    """What the shape of a node follows from: of a sum its term."""
    return (node.term,) if isinstance(node, Sum) else children(node)


def _shape(node: Node, below: list[Shape], scope: Mapping[str, Shape]) -> Shape:
    """The shape of one node from those of its children."""
    match node:
        case Number():
            return ()
        case Name(name=name):
            return _find_shape(node, name, scope)
        case Index(name=name, indices=indices) | Member(name=name, indices=indices):
            return _component(node, name, indices, _find_shape(node, name, scope))
        case Sum():
            return below[0]
        case Component(name=name, indices=indices):
            return _component(node, name, indices, below[0])
        case Negate():
            return below[0]
        case Power():
            return _power(node, below[0])
        case Binary(operator=operator):
            return _binary(node, operator, *below)
        case Call():
            return _call(node, below)
    raise AssertionError(node)


def _find_shape(node: Node, name: str, scope: Mapping[str, Shape]) -> Shape:
    if name in scope:
        return scope[name]
    problem = f"{name!r} is not declared"
    hint = did_you_mean(name, scope, f"Declared are {list_names(scope)}." if scope else "")
    raise fault_at(node, problem, name, "a variable or parameter of this spec", hint)


def _component(node: Node, name: str, indices: tuple[int, ...], shape: Shape) -> Shape:
    """What is left of a shape behind its subscripts: a scalar, or a row of a matrix."""
    text = f"{name}[{', '.join(map(str, indices))}]"
    if len(shape) < len(indices):
        expected = f"{name}[1]" if shape else f"{name} without a subscript"
        raise fault_at(node, f"{name} is {words(shape)}, found {text}", text, expected)
    for index, length in zip(indices, shape, strict=False):
        if not 1 <= index <= length:
            hint = "Components are counted from 1." if index == 0 else ""
            problem = f"the subscript of {text} is out of range"
            raise fault_at(node, problem, text, f"1 to {length}", hint)
    return shape[len(indices) :]


def _power(node: Power, base: Shape) -> Shape:
    if base == ():
        return base
    if not _is_square(base):
        hint = "The square of a vector is dot(a, a)." if len(base) == 1 else ""
        problem = f"{words(base)} has no power"
        raise fault_at(node, problem, words(base), "a scalar or a square matrix", hint)
    if node.exponent < 0 and not _is_small_square(base):
        raise fault_at(node, f"{words(base)} is inverted", words(base), _SMALL)
    return base


def _binary(node: Node, operator: str, left: Shape, right: Shape) -> Shape:
    if operator in "+-":
        if left == right:
            return left
        problem = f"{words(left)} {operator} {words(right)} do not fit"
        raise fault_at(node, problem, problem, f"two of one shape around {operator}")
    if operator == "/":
        if right == ():
            return left
        hint = "Write inverse(A)*x." if len(right) == 2 else ""
        raise fault_at(node, f"division by {words(right)}", words(right), "a scalar divisor", hint)
    if left == () or right == ():
        return left + right
    if len(left) == 2 and left[1] == right[0]:
        return (left[0], *right[1:])
    problem, hint = f"{words(left)} * {words(right)} do not fit", ""
    if len(left) == len(right) == 1:
        hint = "Write dot(a, b) for the scalar product, cross(a, b) for the vector product."
    elif len(left) == 1:
        hint = "Write transpose(A)*a for a row vector times a matrix."
    raise fault_at(node, problem, problem, "matching sizes around *", hint)


def _call(node: Call, arguments: list[Shape]) -> Shape:
    name = node.function
    function = FUNCTIONS.get(name) or _WRITTEN[name]
    if function.arity not in (0, len(arguments)):
        given = f"{len(arguments)} argument{'s' * (len(arguments) != 1)}"
        raise fault_at(node, f"{name} is given {given}", given, function.takes)
    shape = _RULES[name](*arguments)
    if shape is not None:
        return shape
    given, hint = " and ".join(map(words, arguments)), ""
    if name == "dot" and [len(a) for a in arguments] == [2, 2]:
        hint = "The product of matrices is trace(transpose(A)*B)."
    if name in ("det", "inverse") and _is_square(arguments[0]):
        hint = "Larger systems are solved inside the kernels: give the Lagrangian instead."
    raise fault_at(node, f"{name} is given {given}", given, function.takes, hint)
