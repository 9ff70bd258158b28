"""Brackets of matrices: what ``bracket = "X*N*Y - Y*N*X"`` makes of two matrices of a basis.

Comes in: the expression, the parameters, and the size of the matrices. Goes out: a function of two
sparse matrices, linear in each; whether it is a Lie bracket is found out by
`coadjoint.algebra.lie_algebra.from_bracket`. Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from coadjoint.algebra.matrices import (
    Matrix,
    SparseMatrix,
    combination,
    commutator,
    product,
    transpose,
)
from coadjoint.spec.core.coefficients import Scalars
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.degrees import degree_in
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import shape_of, words
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Index,
    Name,
    Negate,
    Node,
    Number,
    Power,
    fold,
    walk,
)

#: What the two matrices are called.
PAIR = ("X", "Y")
_EXPECTED = "sums of products such as X*N*Y - Y*N*X, in which X and Y occur once each"


def read_bracket(
    source: Source, key: KeyPath, text: str, size: int, scalars: Scalars
) -> Callable[[SparseMatrix, SparseMatrix], Matrix]:
    """The bracket of two matrices.

    Raises:
        SpecError: A syntax error, an unknown name, another shape, or not linear in X and in Y.
        LimitError: It is too large.
    """
    try:
        tree = read_expression(text)
        scalars.check_names(tree)
        scope: Mapping[str, Shape] = {**scalars.shapes, **dict.fromkeys(PAIR, (size, size))}
        _check_free(tree, scalars)
        shape = shape_of(tree, scope)
        if shape != (size, size):
            problem = f"the value is {words(shape)}"
            raise fault_at(tree, problem, words(shape), words((size, size)))
        scalars.check_terms(tree, check_size(tree, scope))
        if any(degree_in(tree, (name,)) != 1 for name in PAIR):
            raise fault_at(tree, "this is not linear in X and in Y", expected=_EXPECTED)
        evaluation = _Evaluation(scalars)
        zero: SparseMatrix = {}
        evaluation.value(tree, dict.fromkeys(PAIR, zero))  # what cannot be evaluated is refused now
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None
    return lambda x, y: evaluation.value(tree, dict(zip(PAIR, (x, y), strict=True)))


def _check_free(tree: Node, scalars: Scalars) -> None:
    """X and Y are the matrices, so no parameter may have these names."""
    for node in walk(tree):
        if isinstance(node, Name) and node.name in PAIR and node.name in scalars.shapes:
            problem = f"{node.name!r} is a parameter, and stands for a matrix of the algebra here"
            expected, hint = "parameters with other names than X and Y", "Rename the parameter."
            raise fault_at(node, problem, node.name, expected, hint)


class _Evaluation:
    """The value of an expression for two matrices: numbers, parameters and sparse matrices."""

    def __init__(self, scalars: Scalars) -> None:
        self.scalars = scalars

    def value(self, tree: Node, pair: Mapping[str, SparseMatrix]) -> Matrix:
        result: Matrix = fold(tree, lambda node, below: self._evaluate(node, below, pair))
        return {place: value for place, value in result.items() if value != 0}

    def _evaluate(self, node: Node, below: list[Any], pair: Mapping[str, SparseMatrix]) -> Any:
        match node:
            case Number(value=value):
                return value
            case Name(name=name) if name in pair:
                return pair[name]
            case Name(name=name):
                return self._parameter(node, name)
            case Index(name=name, indices=indices):
                return self._require_value(node, self.scalars.value(name, indices))
            case Negate():
                return _multiply(below[0], Fraction(-1))
            case Power(exponent=exponent) if exponent > 0:
                result = below[0]
                for _ in range(exponent - 1):
                    result = _multiply(result, below[0])
                return result
            case Binary(operator="*"):
                return _multiply(below[0], below[1])
            case Binary(operator="+" | "-" as operator):
                return _add(below[0], below[1], 1 if operator == "+" else -1)
            case Binary(operator="/") if isinstance(below[1], Fraction) and below[1]:
                return _multiply(below[0], 1 / below[1])
            case Call(function="transpose"):
                return transpose(below[0])
            case Call(function="commutator"):
                return commutator(below[0], below[1])
        raise fault_at(node, "this cannot stand in a bracket of matrices", expected=_EXPECTED)

    def _parameter(self, node: Node, name: str) -> Any:
        """A scalar, or a matrix entry by entry."""
        shape = self.scalars.shapes[name]
        if len(shape) != 2:
            return self._require_value(node, self.scalars.value(name))
        places = [(i, j) for i in range(shape[0]) for j in range(shape[1])]
        entries = {(i, j): self.scalars.value(name, (i + 1, j + 1)) for i, j in places}
        return {place: value for place, value in entries.items() if value != 0}

    def _require_value(self, node: Node, value: Any) -> Any:
        if value is None:
            raise fault_at(node, "this is neither a scalar nor a matrix", expected=_EXPECTED)
        return value


def _multiply(a: Any, b: Any) -> Any:
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return product(a, b)
    if isinstance(b, Mapping):
        a, b = b, a
    return combination([(b, a)]) if isinstance(a, Mapping) else a * b


def _add(a: Any, b: Any, sign: int) -> Any:
    return combination([(1, a), (sign, b)]) if isinstance(a, Mapping) else a + sign * b
