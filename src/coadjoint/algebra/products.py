"""Products of Lie algebras: direct and semidirect, with vectors or with another algebra.

Comes in: algebras and representations. Goes out: a new `LieAlgebra`, checked like any other, with
faithful matrices where the parts give some.
Read next: `coadjoint.algebra.extensions`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra, check_size, from_brackets
from coadjoint.algebra.matrices import Matrix, SparseMatrix, block_diagonal, unit
from coadjoint.algebra.representation import Representation, adjoint
from coadjoint.errors import AlgebraError
from coadjoint.exact.linear import Span

Blocks = dict[str, tuple[int, ...]]
Brackets = dict[tuple[int, int], dict[int, Any]]


def direct_sum(algebras: Sequence[LieAlgebra], name: str = "") -> LieAlgebra:
    """``g1 + g2 + ...``, which commute with one another.

    Names that two parts share get the number of their part: ``J1_1`` and ``J1_2``.

    >>> from coadjoint.algebra import algebra_by_name
    >>> direct_sum([algebra_by_name("so(3)"), algebra_by_name("aff(1)")]).basis
    ('J1', 'J2', 'J3', 'e1', 'e2')
    """
    check_size(name or "the direct sum", sum(algebra.dimension for algebra in algebras))
    basis, blocks = _join(algebras)
    brackets: Brackets = {}
    parts: list[tuple[SparseMatrix, ...]] = []
    start, dimension = 0, len(basis)
    for algebra in algebras:
        brackets |= _shift(algebra, start)
        after = dimension - start - algebra.dimension
        parts.append((*_zeros(start), *algebra.matrices, *_zeros(after)))
        start += algebra.dimension
    carried = bool(parts) and all(algebra.matrices for algebra in algebras)
    matrices = block_diagonal(parts) if carried else ()
    title = name or " + ".join(algebra.name for algebra in algebras)
    return from_brackets(title, basis, brackets, blocks, matrices)


def semidirect_product(
    algebra: LieAlgebra,
    representations: Sequence[tuple[str, Representation]],
    name: str = "",
) -> LieAlgebra:
    """``g (s) V``: ``[(xi, u), (eta, w)] = ([xi, eta], rho(xi) w - rho(eta) u)``.

    Args:
        algebra: g.
        representations: Pairs (prefix of the new basis names, representation on V); several give
            the product with their direct sum.
        name: Name of the product; by default ``g (s) R^n``.

    The matrices are affine, ``[[rho(xi), u], [0, 0]]``, with those of g as a further block
    if rho alone is not faithful.

    Raises:
        AlgebraError: A representation is one of another algebra.
    """
    for _, representation in representations:
        _check_action(representation, algebra)
    basis, blocks = list(algebra.basis), dict(algebra.blocks)
    brackets: Brackets = {pair: dict(row) for pair, row in algebra.constants.items()}
    for prefix, representation in representations:
        start = len(basis)
        basis += [f"{prefix}{n + 1}" for n in range(representation.dimension)]
        blocks[prefix] = tuple(range(start, len(basis)))
        for i, matrix in enumerate(representation.matrices):
            for (row, column), value in matrix.items():
                brackets.setdefault((i, start + column), {})[start + row] = value
    extra = len(basis) - algebra.dimension
    matrices = _affine(algebra, [representation for _, representation in representations])
    title = name or f"{algebra.name} (s) R^{extra}"
    return from_brackets(title, basis, brackets, blocks, matrices)


def semidirect_sum(
    acting: LieAlgebra, ideal: LieAlgebra, action: Representation, name: str = ""
) -> LieAlgebra:
    """``g1 (s) g2``: ``[(X1, Y1), (X2, Y2)] = ([X1, X2], X1.Y2 - X2.Y1 + [Y1, Y2])``.

    Repeated, it builds iterated products such as g(3) = (so(3) (s) R^3) (s) R^4 (Holm 2011, 6.7).

    Args:
        acting: g1.
        ideal: g2.
        action: How g1 acts on g2, a representation on the coordinates of g2.
        name: Name of the sum.

    Matrices are affine where g2 is abelian, else the adjoint representation of the sum, with those
    of g1 as a further block if need be; where the center of g2 spoils this, there are none.

    Raises:
        AlgebraError: The action is not one of g1 on g2, or not by derivations:
            ``X.[u, v] = [X.u, v] + [u, X.v]`` fails for the triple that the message names.
    """
    _check_action(action, acting, ideal)
    check_size(name or "the semidirect sum", acting.dimension + ideal.dimension)
    start = acting.dimension
    basis, blocks = _join([acting, ideal])
    brackets = _shift(acting, 0) | _shift(ideal, start)
    for i, matrix in enumerate(action.matrices):
        for (row, column), value in matrix.items():
            brackets.setdefault((i, start + column), {})[start + row] = value
    title = name or f"{acting.name} (s) {ideal.name}"
    try:
        whole = from_brackets(title, basis, brackets, blocks)
    except AlgebraError as error:
        # The parts satisfy the Jacobi identity and the action is a representation, so what fails is
        # [X, [u, v]] + cyclic, the law of a derivation.
        x, u, v = (basis[i] for i in error.triple)
        raise AlgebraError(
            f"{title}: {x} does not act on {ideal.name} by a derivation: "
            f"{x}.[{u}, {v}] - [{x}.{u}, {v}] - [{u}, {x}.{v}] = {error.defect}; expected 0. "
            f"Check the matrix of {x} in {action.name!r}.",
            triple=[x, u, v],
            defect=error.defect,
        ) from error
    if ideal.is_abelian:
        return with_matrices(whole, _affine(acting, [action]))
    padded = (*acting.matrices, *_zeros(ideal.dimension))
    own = block_diagonal([padded, adjoint(whole).matrices]) if acting.matrices else ()
    return with_matrices(whole, first_faithful([adjoint(whole).matrices, own]))


def _check_action(
    action: Representation, acting: LieAlgebra, space: LieAlgebra | None = None
) -> None:
    """The action must be one of the acting algebra, on the space if that is an algebra too."""
    fits = space is None or action.dimension == space.dimension
    if action.algebra == acting and fits:
        return
    wanted = f" on {space.name}, which has {space.dimension} dimensions" if space else ""
    raise AlgebraError(
        f"the representation {action.name!r} is one of {action.algebra.name} on "
        f"R^{action.dimension}; expected one of {acting.name}{wanted}. "
        "Give an action of the first algebra.",
        found=[action.algebra.name, action.dimension],
    )


# -- shared ---------------------------------------------------------------------------------------


def with_matrices(algebra: LieAlgebra, matrices: Sequence[SparseMatrix]) -> LieAlgebra:
    """The same algebra carrying matrices."""
    return LieAlgebra(
        name=algebra.name,
        basis=algebra.basis,
        constants=algebra.constants,
        blocks=algebra.blocks,
        matrices=tuple(matrices),
    )


def first_faithful(candidates: Iterable[Sequence[SparseMatrix]]) -> tuple[SparseMatrix, ...]:
    """The first matrices that are independent, or none."""
    for matrices in candidates:
        if matrices and not Span(matrices).dependent:
            return tuple(matrices)
    return ()


def _affine(
    algebra: LieAlgebra, representations: Sequence[Representation]
) -> tuple[SparseMatrix, ...]:
    """``[[rho(xi), u], [0, 0]]``, one block for each representation, if faithful."""
    extra = sum(representation.dimension for representation in representations)
    parts: list[Sequence[SparseMatrix]] = []
    before = 0
    for representation in representations:
        n = representation.dimension
        moves: list[Matrix] = [unit(row, n) for row in range(n)]
        zeros = _zeros(before), _zeros(extra - before - n)
        parts.append((*representation.matrices, *zeros[0], *moves, *zeros[1]))
        before += n
    padded = (*algebra.matrices, *_zeros(extra))
    wider = [*parts, padded] if algebra.matrices else parts
    return first_faithful(block_diagonal(blocks) for blocks in (parts, wider))


def _zeros(count: int) -> tuple[Matrix, ...]:
    return tuple({} for _ in range(count))


def _shift(algebra: LieAlgebra, start: int) -> Brackets:
    """The brackets of a part whose basis begins further on."""
    return {
        (i + start, j + start): {k + start: c for k, c in row.items()}
        for (i, j), row in algebra.constants.items()
    }


def _join(parts: Sequence[LieAlgebra]) -> tuple[list[str], Blocks]:
    """Bases and blocks one after the other; names that occur twice get the number of the part."""
    names = [name for part in parts for name in part.basis]
    labels = [label for part in parts for label in part.blocks]
    basis: list[str] = []
    blocks: Blocks = {}
    for n, part in enumerate(parts, start=1):
        start = len(basis)
        for label, places in part.blocks.items():
            own = f"{label}_{n}" if labels.count(label) > 1 else label
            blocks[own] = tuple(start + place for place in places)
        basis += [f"{name}_{n}" if names.count(name) > 1 else name for name in part.basis]
    return basis, blocks
