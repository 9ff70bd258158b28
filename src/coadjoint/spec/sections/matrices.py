"""Matrices over the basis of an algebra, and the representations that they are.

Comes in: tables of matrices and names of representations. Goes out: exact `Representation` records
that have been checked to commute like the algebra, and forms of variables that have been checked
to fit the basis; or an error with file, line and key.
Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

from coadjoint.algebra.catalogue import (
    REPRESENTATIONS,
    representation_by_name,
    representation_on_block,
)
from coadjoint.algebra.families import so, so_indefinite
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix
from coadjoint.algebra.matrices import size
from coadjoint.algebra.representation import Representation
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.limits import MATRIX_ENTRIES, STATE_COMPONENTS
from coadjoint.spec.core.coefficients import Scalars, read_coefficient
from coadjoint.spec.core.components import matrix_size
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source


@contextmanager
def point_at_faults(source: Source, key: KeyPath) -> Iterator[None]:
    """Tell where in the file an error about an algebra comes from."""
    try:
        yield
    except (AlgebraError, LimitError) as error:
        kind, parts = type(error), dict(error.parts)
        value = parts.pop("found", "")
        parts.pop("expected", None)  # the message says it already
        raise source.fault(key, str(error), value, kind=kind, **parts) from None


def places_of(
    source: Source, key: KeyPath, names: Sequence[str], basis: Sequence[str]
) -> tuple[int, ...]:
    """Places of names in the basis.

    Raises:
        SpecError: A name is not in it.
    """
    for place, name in enumerate(names):
        if name not in basis:
            raise source.unknown((*key, place), f"{name!a} is not in the basis", name, basis)
    return tuple(basis.index(name) for name in names)


def block_places(
    source: Source, key: KeyPath, block: str | list[str], algebra: LieAlgebra
) -> tuple[int, ...]:
    """Places of a block of an algebra: a named one, or names of its basis.

    Raises:
        SpecError: There is no such block, or a name stands twice.
    """
    if isinstance(block, list):
        places = places_of(source, key, block, algebra.basis)
        if len(set(places)) < len(places):
            problem = "a name of the basis stands twice"
            raise source.fault(key, problem, list_names(block), "each name once")
        return places
    if block in algebra.blocks:
        return algebra.blocks[block]
    if block in algebra.basis:
        return (algebra.basis.index(block),)
    known = (*algebra.blocks, *algebra.basis)
    raise source.unknown(key, f"{algebra.name} has no block {block!a}", block, known)


def check_basis_names(source: Source, key: KeyPath, names: Sequence[str]) -> None:
    """Refuse a basis that is too long, and names that are none."""
    if len(names) > STATE_COMPONENTS:
        problem = f"the basis has {len(names)} vectors"
        raise source.too_many(key, problem, len(names), "STATE_COMPONENTS")
    for place, name in enumerate(names):
        if not NAME.fullmatch(name):
            raise source.fault(
                (*key, place) if (*key, place) in source.positions.values else key,
                f"{name!a} is not a name",
                name,
                "a letter, then letters and digits, such as e1",
            )


def read_matrices(
    source: Source,
    key: KeyPath,
    tables: Mapping[str, list[list[Fraction | str]]],
    basis: Sequence[str],
    scalars: Scalars,
) -> tuple[dict[str, SparseMatrix], int]:
    """Sparse matrices by name of the basis, and their common size.

    Raises:
        SpecError: A name is not in the basis, or a matrix has another size or other entries.
        LimitError: There are too many entries.
    """
    size = len(next(iter(tables.values()), []))
    entries = sum(len(row) for rows in tables.values() for row in rows)
    if entries > MATRIX_ENTRIES:
        problem, hint = (
            f"the matrices have {entries} numbers",
            "Declare the algebra by its brackets.",
        )
        raise source.too_many(key, problem, entries, "MATRIX_ENTRIES", hint=hint)
    for name, rows in tables.items():
        if name not in basis:
            problem = f"{name!a} is not in the basis"
            expected = f"names of the basis: {list_names(basis)}"
            raise source.at_key((*key, name), problem, name, expected, did_you_mean(name, basis))
        lengths = [len(row) for row in rows]
        if not size or lengths != [size] * size:
            problem = f"the matrix of {name!r} has rows of {list_names(map(str, lengths))} numbers"
            expected = f"{size or 1} rows of {size or 1} numbers, like the first matrix"
            raise source.fault((*key, name), problem, list_names(map(str, lengths)), expected)
    return {
        name: _read_matrix(source, (*key, name), rows, scalars) for name, rows in tables.items()
    }, size


def _read_matrix(
    source: Source, key: KeyPath, rows: list[list[Fraction | str]], scalars: Scalars
) -> SparseMatrix:
    entries = {
        (r, c): read_coefficient(source, (*key, r, c), entry, scalars)
        for r, row in enumerate(rows)
        for c, entry in enumerate(row)
    }
    return {place: value for place, value in entries.items() if value != 0}


def real_form(
    real: Mapping[str, SparseMatrix], imaginary: Mapping[str, SparseMatrix], size: int
) -> dict[str, SparseMatrix]:
    """Complex matrices ``A + iB`` as the real ones ``[[A, -B], [B, A]]``, of twice the size.

    >>> real_form({}, {"J": {(0, 0): Fraction(1)}}, 1)
    {'J': {(1, 0): Fraction(1, 1), (0, 1): Fraction(-1, 1)}}
    """
    result = dict[str, SparseMatrix]()
    for name in {**real, **imaginary}:
        a, b = real.get(name, {}), imaginary.get(name, {})
        result[name] = {
            **a,
            **{(r + size, c + size): value for (r, c), value in a.items()},
            **{(r + size, c): value for (r, c), value in b.items()},
            **{(r, c + size): value * Fraction(-1) for (r, c), value in b.items()},
        }
    return result


def by_matrices(
    source: Source,
    key: KeyPath,
    algebra: LieAlgebra,
    name: str,
    tables: Mapping[str, list[list[Any]]],
    scalars: Scalars,
) -> Representation:
    """A representation by matrices; those left out act as zero."""
    matrices, size = read_matrices(source, key, tables, algebra.basis, scalars)
    with point_at_faults(source, key):
        acting = tuple(matrices.get(vector, {}) for vector in algebra.basis)
        return Representation(algebra, name, size, acting)


def representation_of(
    source: Source,
    key: KeyPath,
    algebra: LieAlgebra,
    name: str,
    declared: Mapping[str, Representation] | None = None,
    invariance: str = "left",
    places: Sequence[int] = (),
) -> Representation:
    """The representation of a name: a declared one, or one that every algebra has.

    By that of a block, at some places, the rest of the algebra acts as zero.

    Raises:
        AlgebraError: The algebra has none of that name, since it has no matrices.
        SpecError: The name is unknown.
    """
    declared = declared or {}
    known = (*REPRESENTATIONS, *declared)
    if name not in known:
        problem = f"the representation {name!a} is not known"
        hint = f"Declare it under [representations.{name}]."
        raise source.unknown(key, problem, name, known, hint)
    if name in declared:
        return declared[name]
    with point_at_faults(source, key):
        if places:
            return representation_on_block(algebra, places, name, invariance)
        return representation_by_name(algebra, name, invariance)


def check_elements(
    source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...], form: str
) -> None:
    """The matrices of an algebra with a bracket of its own are of the form that is declared."""
    rows = matrix_size(len(block), form)
    sign = -1 if form == "antisymmetric" else 1
    for i in block:
        matrix = algebra.elements[i]
        turned = {(c, r): sign * value for (r, c), value in matrix.items()}
        if form == "matrix" or len(block) < algebra.dimension:
            turned = {}
        if size(algebra.elements) != rows or turned != dict(matrix):
            problem = f"the matrix of {algebra.basis[i]} is not of the form {form!r}"
            expected = f"a basis of all {form} matrices with {rows} rows"
            hint = "Remove form, or declare the algebra by such matrices."
            raise source.fault(key, problem, algebra.basis[i], expected, hint)


def check_planes(source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...]) -> None:
    """Components above a diagonal go along E_12, E_13, ...: the planes of so(n) in their order.

    Along J1, J2, J3 = E_32, E_13, E_21 the equation dM/dt = [M, Omega] would have the other sign,
    and no invariant would show it.
    """
    size = matrix_size(len(block), "antisymmetric")
    assert size is not None, block
    place = {b: n for n, b in enumerate(block)}
    constants: dict[tuple[int, int], dict[int | None, object]] = {}
    for (i, j), row in algebra.constants.items():
        if i in place and j in place:
            a, b = place[i], place[j]
            sign = 1 if a < b else -1
            constants[min(a, b), max(a, b)] = {place.get(k): sign * c for k, c in row.items()}
    planes = so_indefinite(3, 0) if size == 3 else so(size)  # so(3) has other axes
    if size > 2 and constants != dict(planes.constants):
        names = list_names(algebra.basis[b] for b in block)
        raise source.fault(
            key,
            f"the block {names} of {algebra.name} does not commute like the planes of so({size})",
            names,
            "a basis E12, E13, ... of matrices e_i e_j^T - e_j e_i^T for i < j",
            "Leave form out, and write hat(...) where a matrix is meant."
            if size == 3
            else "Leave form out, or declare the algebra by these matrices.",
        )
