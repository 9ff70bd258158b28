"""Dense vectors and matrices: tuples, and tuples of rows, of anything that adds and multiplies.

Comes in and goes out: nests of fractions, floats, complex numbers of this package, elements of a
field, or bounds. It loads no SymPy, and NumPy's object arrays would cost 0.15 s of import for a
dozen three-vectors. Sparse rows stand in `coadjoint.exact.linear`, sparse matrices in
`coadjoint.algebra.matrices`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from typing import Any, TypeVar

from coadjoint.exact.linear import quotient

Entry = TypeVar("Entry")
Value = TypeVar("Value")
#: Components of any kind that adds and multiplies.
Vector = tuple[Any, ...]
#: Rows of equal length.
Matrix = tuple[Vector, ...]


def total(addends: Sequence[Any]) -> Any:
    """The sum, added in pairs: a long sum of elements takes no quadratic time.

    >>> total([1, 2, 3]), total([])
    (6, 0)
    """
    left = list(addends)
    while len(left) > 1:
        pairs = [a + b for a, b in zip(left[::2], left[1::2], strict=False)]
        left = pairs + left[2 * len(pairs) :]
    return left[0] if left else 0


# -- sums, of any shape ---------------------------------------------------------------------------


def add(a: Value, b: Value) -> Value:
    """``a + b`` of two values of one shape.

    >>> add((1, 2), (3, 4)), add(((1,), (2,)), ((3,), (4,)))
    ((4, 6), ((4,), (6,)))
    """
    result: Value = _join(operator.add, a, b)
    return result


def subtract(a: Value, b: Value) -> Value:
    """``a - b`` of two values of one shape."""
    result: Value = _join(operator.sub, a, b)
    return result


def _join(operation: Callable[[Any, Any], Any], a: Any, b: Any) -> Any:
    """An operation on the entries of two values of one shape."""
    if isinstance(a, tuple | list):
        return tuple(_join(operation, x, y) for x, y in zip(a, b, strict=True))
    return operation(a, b)


def scale(factor: Any, a: Value) -> Value:
    """``factor * a`` of a value of any shape."""
    if isinstance(a, tuple | list):
        result: Any = tuple(scale(factor, x) for x in a)
    else:
        result = factor * a
    return result  # type: ignore[no-any-return]


def combine(*terms: tuple[Any, Matrix]) -> Matrix:
    """The sum of multiples of matrices.

    >>> combine((2, ((1, 0),)), (3, ((0, 1),)))
    ((2, 3),)
    """
    factors, matrices = zip(*terms, strict=True)
    return tuple(
        tuple(total([f * x for f, x in zip(factors, entries, strict=True)]) for entries in columns)
        for columns in (zip(*rows, strict=True) for rows in zip(*matrices, strict=True))
    )


def weighted_sum(
    weights: Sequence[Any],
    matrices: Sequence[Mapping[tuple[int, int], Any]],
    size: int,
    zero: Any = 0,
) -> Matrix:
    """``sum of weight_i matrix_i`` for sparse square matrices.

    >>> weighted_sum([2, 3], [{(0, 1): 1}, {(1, 0): -1}], 2)
    ((0, 2), (-3, 0))
    """
    entries: dict[tuple[int, int], Any] = {}
    for weight, matrix in zip(weights, matrices, strict=True):
        for place, value in matrix.items():
            entries[place] = entries.get(place, 0) + weight * value
    return tuple(tuple(entries.get((i, j), zero) for j in range(size)) for i in range(size))


# -- products -------------------------------------------------------------------------------------


def dot(a: Iterable[Entry], b: Iterable[Any]) -> Entry:
    """``a . b``; products with a zero are passed over.

    >>> dot((1, 2, 3), (4, 5, 6))
    32
    """
    pairs = list(zip(a, b, strict=True))
    products = [x * y for x, y in pairs if x and y]
    result: Entry = total(products or [x * y for x, y in pairs[:1]])
    return result


def cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    """``a x b`` in R^3.

    >>> cross((1, 0, 0), (0, 1, 0))
    (0, 0, 1)
    """
    a1, a2, a3 = a
    b1, b2, b3 = b
    return (a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1)


def hat(a: Sequence[Any]) -> Matrix:
    """The matrix with ``hat(a) b = a x b``, that is ``hat(a)_ij = -epsilon_ijk a_k``.

    Source:
        Holm (2011), Geometric Mechanics II, section 2.1.1.

    >>> hat((1, 2, 3))
    ((0, -3, 2), (3, 0, -1), (-2, 1, 0))
    """
    a1, a2, a3 = a
    zero = 0 * a1
    return ((zero, -a3, a2), (a3, zero, -a1), (-a2, a1, zero))


def apply(matrix: Sequence[Sequence[Entry]], a: Sequence[Any]) -> tuple[Entry, ...]:
    """The matrix times a column."""
    return tuple(dot(row, a) for row in matrix)


def product(*factors: Matrix) -> Matrix:
    """The product of matrices.

    >>> product(((1, 2), (0, 1)), ((1, 3), (0, 1)))
    ((1, 5), (0, 1))
    """
    return reduce(_product, factors)


def _product(a: Matrix, b: Matrix) -> Matrix:
    columns = transpose(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def commutator(a: Matrix, b: Matrix) -> Matrix:
    """``a b - b a``."""
    return subtract(_product(a, b), _product(b, a))


def transpose(a: Sequence[Sequence[Any]]) -> Matrix:
    """Rows as columns."""
    return tuple(zip(*a, strict=True))


def trace(a: Sequence[Sequence[Any]]) -> Any:
    """The sum of the diagonal."""
    return total([row[n] for n, row in enumerate(a)])


def identity(size: int) -> Matrix:
    """The unit matrix of integers, which mix with values of every kind."""
    return tuple(tuple(int(i == j) for j in range(size)) for i in range(size))


def diagonal(values: Sequence[Any]) -> Matrix:
    """The diagonal matrix of some values."""
    return tuple(
        tuple(x if i == j else 0 * x for j in range(len(values))) for i, x in enumerate(values)
    )


# -- minors ---------------------------------------------------------------------------------------


#: Minors by their rows and columns.
_Minors = dict[tuple[tuple[int, ...], tuple[int, ...]], Any]


def minor(a: Sequence[Sequence[Entry]], rows: Sequence[int], columns: Sequence[int]) -> Entry:
    """The determinant of some rows and columns."""
    result: Entry = _expand(a, tuple(rows), tuple(columns), {})
    return result


def determinant(a: Sequence[Sequence[Entry]]) -> Entry:
    """The determinant, by expansion along the first row: no division, for small matrices.

    >>> determinant(((2, 1), (3, 4)))
    5
    """
    return minor(a, range(len(a)), range(len(a)))


def pfaffian(a: Sequence[Sequence[Any]]) -> Any:
    """The root of the determinant of an antisymmetric matrix, by expansion along the first row.

    >>> pfaffian(((0, 1, 2, 3), (-1, 0, 4, 5), (-2, -4, 0, 6), (-3, -5, -6, 0)))
    8
    """
    if len(a) % 2:
        return 0 * a[0][0]
    result: Any = 1
    if a:
        places = range(1, len(a))
        rests = ([k for k in places if k != j] for j in places)
        inner = ([[a[i][k] for k in rest] for i in rest] for rest in rests)
        signed = zip(places, inner, strict=True)
        result = total([(-1) ** (j - 1) * a[0][j] * pfaffian(m) for j, m in signed if a[0][j] != 0])
    return result


def _expand(
    a: Sequence[Sequence[Any]], rows: tuple[int, ...], columns: tuple[int, ...], known: _Minors
) -> Any:
    """A minor by expansion along its first row, with the minors in it that are known."""
    first = a[rows[0]]
    if len(rows) == 1:
        return first[columns[0]]
    if (rows, columns) not in known:
        result = 0 * first[columns[0]]
        for j, column in enumerate(columns):
            if first[column] != 0:
                rest = _expand(a, rows[1:], columns[:j] + columns[j + 1 :], known)
                result = result + (-1) ** j * first[column] * rest
        known[rows, columns] = result
    return known[rows, columns]


def inverse(a: Matrix) -> Matrix:
    """The inverse by cofactors, of a matrix whose entries divide exactly.

    Raises:
        ZeroDivisionError: The determinant is zero.
    """
    size, known = tuple(range(len(a))), _Minors()
    share = quotient(1, _expand(a, size, size, known))
    return tuple(tuple(entry * share for entry in row) for row in _adjugate(a, known))


def adjugate(a: Sequence[Sequence[Any]]) -> Matrix:
    """The transpose of the cofactors, whose product with the matrix is the determinant.

    >>> adjugate(((2, 1), (3, 4)))
    ((4, -1), (-3, 2))
    """
    return _adjugate(a, {})


def _adjugate(a: Sequence[Sequence[Any]], known: _Minors) -> Matrix:
    size = tuple(range(len(a)))
    if len(a) == 1:
        return ((1,),)
    return tuple(
        tuple((-1) ** (i + j) * _expand(a, _skip(size, j), _skip(size, i), known) for j in size)
        for i in size
    )


def _skip(places: tuple[int, ...], place: int) -> tuple[int, ...]:
    """All places but one, of as many as there are."""
    return places[:place] + places[place + 1 :]
