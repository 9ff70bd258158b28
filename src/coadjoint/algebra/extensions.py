"""Extensions of a Lie algebra, and what lies inside it: central, Leibniz, complex, subalgebra.

Comes in: an algebra and what is added or chosen. Goes out: a new `LieAlgebra`, checked like any
other, with faithful matrices where the algebra has some.
Read next: `coadjoint.algebra.catalogue`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra, check_size, from_brackets
from coadjoint.algebra.matrices import Matrix, SparseMatrix, combination, kronecker, size
from coadjoint.algebra.products import Brackets, with_matrices
from coadjoint.errors import AlgebraError
from coadjoint.exact.linear import Span, exact, nullspace


def central_extension(
    algebra: LieAlgebra,
    cocycle: Mapping[tuple[int, int], Any],
    center: str = "Z",
    name: str = "",
) -> LieAlgebra:
    """``[x, y]_new = [x, y] + omega(x, y) Z`` with Z commuting with everything.

    Args:
        algebra: The algebra to extend.
        cocycle: ``{(i, j): omega(e_i, e_j)}``, each pair once in either order.
        center: Name of Z, the last vector of the new basis.
        name: Name of the extension.

    Raises:
        AlgebraError: ``omega(x, [y, z]) + cyclic`` is not zero for the triple that the message
            names, or a pair is given twice.

    >>> from coadjoint.algebra import algebra_by_name
    >>> plane = algebra_by_name("R^2")
    >>> dict(central_extension(plane, {(0, 1): 1}).constants[0, 1])
    {2: 1}
    """
    title = name or f"central extension of {algebra.name}"
    last = algebra.dimension
    omega = _form(title, algebra, cocycle)
    brackets: Brackets = {pair: dict(row) for pair, row in algebra.constants.items()}
    for pair, value in omega.items():
        brackets.setdefault(pair, {})[last] = value
    try:
        whole = from_brackets(title, (*algebra.basis, center), brackets, algebra.blocks)
    except AlgebraError as error:
        # The algebra satisfies the Jacobi identity, so the defect is along Z: it is the coboundary.
        x, y, z = (algebra.basis[i] for i in error.triple)
        raise AlgebraError(
            f"{title}: the form is not a 2-cocycle: omega({x}, [{y}, {z}]) {center} + cyclic = "
            f"{error.defect}; expected 0. Check its values on the brackets of {x}, {y} and {z}.",
            triple=[x, y, z],
            defect=error.defect,
        ) from error
    return with_matrices(whole, _extend_matrices(algebra, omega))


def _form(
    title: str, algebra: LieAlgebra, cocycle: Mapping[tuple[int, int], Any]
) -> dict[tuple[int, int], Any]:
    """The form on pairs i < j.

    Raises:
        AlgebraError: A pair is given twice, or a vector with itself.
    """
    omega: dict[tuple[int, int], Any] = {}
    for (i, j), value in cocycle.items():
        pair = (min(i, j), max(i, j))
        if i == j or pair in omega:
            names = [algebra.basis[i], algebra.basis[j]]
            raise AlgebraError(
                f"{title}: omega({names[0]}, {names[1]}) = {value} is given; expected each pair of "
                "different vectors once, since the form is antisymmetric. Remove it.",
                pair=names,
                found=str(value),
            )
        omega[pair] = value if i < j else -value
    return omega


def _extend_matrices(
    algebra: LieAlgebra, omega: Mapping[tuple[int, int], Any]
) -> tuple[SparseMatrix, ...]:
    """``[[x, 0], [f_x, 0]]`` for rows f_x that make the commutators right, if there are such rows.

    They solve ``f_x y - f_y x = f_[x,y] + omega(x, y) f_Z`` and ``f_Z x = 0``: linear equations.
    """
    n, d = size(algebra.matrices), algebra.dimension
    numbers = [*omega.values(), *(c for *_, c in algebra.structure())]
    if not algebra.matrices or not all(isinstance(c, int | Fraction) for c in numbers):
        return ()
    equations: list[dict[int, Any]] = []
    for i, j in combinations(range(d), 2):
        terms: list[dict[int, Any]] = [{} for _ in range(n)]
        for k, c in (*algebra.constants.get((i, j), {}).items(), (d, omega.get((i, j), 0))):
            for column in range(n):
                terms[column][k * n + column] = c
        for of, matrix, sign in ((i, algebra.matrices[j], -1), (j, algebra.matrices[i], 1)):
            for (row, column), x in matrix.items():
                at = of * n + row
                terms[column][at] = terms[column].get(at, 0) + sign * x
        equations += terms
    for matrix in algebra.matrices:
        rows: list[dict[int, Any]] = [{} for _ in range(n)]
        for (row, column), x in matrix.items():
            rows[column][d * n + row] = x
        equations += rows
    for solution in nullspace(equations, (d + 1) * n):
        if any(at >= d * n for at in solution):
            below: list[Matrix] = [{} for _ in range(d + 1)]
            for at, value in solution.items():
                below[at // n][n, at % n] = exact(value)
            return tuple(
                {**matrix, **row}
                for matrix, row in zip((*algebra.matrices, {}), below, strict=True)
            )
    return ()


def leibniz_extension(algebra: LieAlgebra, order: int, name: str = "") -> LieAlgebra:
    """``g (x) R[eps] / eps^order``: ``[x eps^a, y eps^b] = [x, y] eps^(a+b)``.

    The basis is that of g, then ``x eps`` called ``x_1``, then ``x eps^2`` called ``x_2``, ...
    Of so(3) the extension of order 2 is se(3).

    Raises:
        AlgebraError: The order is below 1.

    >>> from coadjoint.algebra import algebra_by_name, same_constants
    >>> same_constants(leibniz_extension(algebra_by_name("so(3)"), 2), algebra_by_name("se(3)"))
    True
    """
    if order < 1:
        raise AlgebraError(
            f"the Leibniz extension of {algebra.name} of order {order} is empty; expected an order "
            "of at least 1. Order 2 adds one copy of the algebra.",
            found=order,
        )
    title, d = name or f"{algebra.name} (x) R[eps]/eps^{order}", algebra.dimension
    check_size(title, d * order)
    basis = [f"{x}_{a}" if a else x for a in range(order) for x in algebra.basis]
    brackets: Brackets = {}
    for a in range(order):
        for b in range(order - a):
            for i, j, k, c in algebra.structure():
                if a * d + i < b * d + j:
                    row = brackets.setdefault((a * d + i, b * d + j), {})
                    row[(a + b) * d + k] = c
    n = size(algebra.matrices)
    matrices: list[Matrix] = []
    for a in range(order):
        shift = {(row, row + a): 1 for row in range(order - a)}  # the matrix of eps^a
        matrices += [kronecker(shift, x, n) for x in algebra.matrices]
    return from_brackets(title, basis, brackets, algebra.blocks, tuple(matrices))


def complexification(algebra: LieAlgebra, name: str = "") -> LieAlgebra:
    """``g (x) C`` as a real algebra: the basis of g, then i times it, called ``ix``.

    Of so(3) it is so(3,1), the boosts being i times the rotations.

    >>> from coadjoint.algebra import algebra_by_name
    >>> complexification(algebra_by_name("so(3)")).killing_signature()
    (3, 3, 0)
    """
    title, d = name or f"{algebra.name} (x) C", algebra.dimension
    check_size(title, 2 * d)
    brackets: Brackets = {}
    for i, j, k, c in algebra.structure():
        if i < j:
            brackets.setdefault((i, j), {})[k] = c
            brackets.setdefault((d + i, d + j), {})[k] = -c
        brackets.setdefault((i, d + j), {})[d + k] = c
    n = size(algebra.matrices)
    one, i_times = {(0, 0): 1, (1, 1): 1}, {(0, 1): -1, (1, 0): 1}
    matrices = tuple(kronecker(unit, x, n) for unit in (one, i_times) for x in algebra.matrices)
    basis = (*algebra.basis, *(f"i{x}" for x in algebra.basis))
    return from_brackets(title, basis, brackets, algebra.blocks, matrices)


def subalgebra(
    algebra: LieAlgebra, vectors: Mapping[str, Sequence[Any]], name: str = ""
) -> LieAlgebra:
    """The subalgebra spanned by vectors, in the basis that they are.

    Raises:
        AlgebraError: The vectors have the wrong length, are dependent, or a commutator leaves
            their span; the message names it.

    >>> from coadjoint.algebra import algebra_by_name
    >>> axis = [[0, 0, 1]]
    >>> subalgebra(algebra_by_name("so(3)"), {"J": axis[0]}).is_abelian
    True
    """
    title, d = name or f"subalgebra of {algebra.name}", algebra.dimension
    basis = tuple(vectors)
    for label, vector in vectors.items():
        if len(vector) != d:
            raise AlgebraError(
                f"{title}: {label} has {len(vector)} components; expected {d}, one for each vector "
                f"of {algebra.name}.",
                found=len(vector),
                expected=d,
            )
    sparse = [{i: x for i, x in enumerate(vectors[label]) if x != 0} for label in basis]
    span = Span(sparse)
    if span.dependent:
        redundant = [basis[n] for n in span.dependent]
        raise AlgebraError(
            f"{title}: {', '.join(redundant)} depends on the vectors before; expected independent "
            "ones. Remove it.",
            found=redundant,
        )
    brackets: Brackets = {}
    for i, j in combinations(range(len(basis)), 2):
        bracket = algebra.sparse_bracket(sparse[i], sparse[j])
        coordinates = span.coordinates(bracket)
        if coordinates is None:
            value = " + ".join(f"({x}) {algebra.basis[k]}" for k, x in sorted(bracket.items()))
            raise AlgebraError(
                f"{title}: [{basis[i]}, {basis[j]}] = {value} is not in the span of "
                f"{', '.join(basis)}. Add what is missing.",
                pair=[basis[i], basis[j]],
            )
        brackets[i, j] = coordinates
    matrices = tuple(
        combination((x, algebra.matrices[k]) for k, x in row.items())
        for row in (sparse if algebra.matrices else ())
    )
    return from_brackets(title, basis, brackets, matrices=matrices)
