"""Structure: the algebra, its representations, and the variables and parameters over it.

Comes in: the validated tables. Goes out: records of `coadjoint.spec.model` and the exact algebra
that they refer to. Read next: `coadjoint.spec.formulas`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction

from coadjoint.algebra.catalogue import algebra_by_name, representation_by_name
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix, from_brackets, from_matrices
from coadjoint.algebra.representation import Representation
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.limits import MATRIX_ENTRIES, STATE_COMPONENTS
from coadjoint.spec.faults import did_you_mean, listed
from coadjoint.spec.formulas import read_combination
from coadjoint.spec.model import Parameter, Shape, Variable
from coadjoint.spec.names import NAME
from coadjoint.spec.positions import KeyPath
from coadjoint.spec.schema import AlgebraPart, ParameterPart, RepresentationPart, VariablePart
from coadjoint.spec.source import Source

_BRACKET = re.compile(r"\[ *([A-Za-z]\w*) *, *([A-Za-z]\w*) *\]", re.ASCII)
_COMMON = ("vector", "adjoint", "coadjoint")


@contextmanager
def _located(source: Source, key: KeyPath) -> Iterator[None]:
    """Tell where in the file an error about an algebra comes from."""
    try:
        yield
    except AlgebraError as error:
        raise source.fault(key, str(error), kind=AlgebraError, **error.parts) from None


# -- the algebra ----------------------------------------------------------------------------------


def read_algebra(source: Source, part: AlgebraPart, system: str) -> LieAlgebra:
    """The algebra of a spec; one declared by brackets or matrices takes the system's name.

    Raises:
        AlgebraError: The brackets or matrices make no Lie algebra, or the name is unknown.
        SpecError: A name of the basis is unknown, or a matrix has the wrong size.
    """
    if part.name is not None:
        with _located(source, ("algebra", "name")):
            return algebra_by_name(part.name)
    basis = tuple(part.basis or part.matrices or ())
    _check_basis(source, basis)
    blocks = {
        name: _places(source, ("algebra", "blocks", name), names, basis)
        for name, names in (part.blocks or {}).items()
    }
    if part.brackets is not None:
        key: KeyPath = ("algebra", "brackets")
        brackets = {
            _pair(source, (*key, pair), pair, basis): read_combination(
                source, (*key, pair), text, basis
            )
            for pair, text in part.brackets.items()
        }
        with _located(source, key):
            return from_brackets(system, basis, brackets, blocks)
    key = ("algebra", "matrices")
    matrices, _ = _matrices(source, key, part.matrices or {}, basis)
    _check_complete(source, key, matrices, basis)
    with _located(source, key):
        return from_matrices(system, basis, [matrices[name] for name in basis], blocks)


def _check_basis(source: Source, basis: Sequence[str]) -> None:
    key: KeyPath = ("algebra", "basis")
    if len(basis) > STATE_COMPONENTS:
        raise source.fault(
            key,
            f"the basis has {len(basis)} vectors",
            found=len(basis),
            expected=f"at most {STATE_COMPONENTS} (STATE_COMPONENTS)",
            kind=LimitError,
            limit="STATE_COMPONENTS",
        )
    for place, name in enumerate(basis):
        if not NAME.fullmatch(name):
            raise source.fault(
                (*key, place),
                f"{name!a} is not a name",
                found=name,
                expected="a letter, then letters and digits, such as e1",
            )


def _places(
    source: Source, key: KeyPath, names: Sequence[str], basis: Sequence[str]
) -> tuple[int, ...]:
    """Places of names in the basis."""
    for place, name in enumerate(names):
        if name not in basis:
            raise source.fault(
                (*key, place),
                f"{name!a} is not in the basis",
                found=name,
                expected=f"names of the basis: {listed(basis)}",
                hint=did_you_mean(name, basis),
            )
    return tuple(basis.index(name) for name in names)


def _pair(source: Source, key: KeyPath, text: str, basis: Sequence[str]) -> tuple[int, int]:
    """The places of e1 and e2 in a key ``[e1, e2]``."""
    found = _BRACKET.fullmatch(text)
    unknown = [name for name in found.groups() if name not in basis] if found else [text]
    if found is None or unknown:
        raise source.fault(
            key,
            f"{text!a} is no bracket of the basis",
            found=unknown[0],
            expected="a key such as '[e1, e2]' with names of the basis",
            hint=did_you_mean(unknown[0], basis),
            at=source.positions.key(key),
        )
    return basis.index(found[1]), basis.index(found[2])


# -- matrices -------------------------------------------------------------------------------------


def _matrices(
    source: Source,
    key: KeyPath,
    tables: Mapping[str, list[list[Fraction]]],
    basis: Sequence[str],
) -> tuple[dict[str, SparseMatrix], int]:
    """Sparse matrices by name of the basis, and their common size."""
    size = len(next(iter(tables.values()), []))
    entries = sum(len(row) for rows in tables.values() for row in rows)
    if entries > MATRIX_ENTRIES:
        raise source.fault(
            key,
            f"the matrices have {entries} numbers",
            found=entries,
            expected=f"at most {MATRIX_ENTRIES} (MATRIX_ENTRIES)",
            hint="Declare the algebra by its brackets.",
            kind=LimitError,
            limit="MATRIX_ENTRIES",
        )
    for name, rows in tables.items():
        if name not in basis:
            raise source.fault(
                (*key, name),
                f"{name!a} is not in the basis",
                found=name,
                expected=f"names of the basis: {listed(basis)}",
                hint=did_you_mean(name, basis),
                at=source.positions.key((*key, name)),
            )
        lengths = [len(row) for row in rows]
        if not size or lengths != [size] * size:
            raise source.fault(
                (*key, name),
                f"the matrix of {name!r} has rows of {listed(map(str, lengths))} numbers",
                found=listed(map(str, lengths)),
                expected=f"{size or 1} rows of {size or 1} numbers, like the first matrix",
            )
    return {name: _sparse(rows) for name, rows in tables.items()}, size


def _sparse(rows: list[list[Fraction]]) -> SparseMatrix:
    return {(r, c): x for r, row in enumerate(rows) for c, x in enumerate(row) if x != 0}


def _check_complete(
    source: Source, key: KeyPath, matrices: Mapping[str, SparseMatrix], basis: Sequence[str]
) -> None:
    for name in basis:
        if name not in matrices:
            raise source.fault(
                key,
                f"the matrix of {name!r} is missing",
                found=name,
                expected=f"a matrix for each of {listed(basis)}",
                hint=f"Write {name} = [[...], [...]] among the matrices.",
            )


def read_representations(
    source: Source, parts: Mapping[str, RepresentationPart], algebra: LieAlgebra
) -> dict[str, Representation]:
    """The declared representations by name.

    Raises:
        AlgebraError: The matrices do not commute like the algebra.
        SpecError: A name is taken or unknown, or a matrix has the wrong size.
    """
    found = {}
    for name, part in parts.items():
        key: KeyPath = ("representations", name)
        if not NAME.fullmatch(name) or name in _COMMON:
            raise source.fault(
                key,
                f"{name!a} cannot name a representation",
                found=name,
                expected=f"a name other than {', '.join(_COMMON)}, which every algebra has",
                at=source.positions.key(key),
            )
        matrices, size = _matrices(source, (*key, "matrices"), part.matrices, algebra.basis)
        with _located(source, key):
            acting = tuple(matrices.get(b, {}) for b in algebra.basis)
            found[name] = Representation(algebra, name, size, acting)
    return found


# -- variables and parameters ---------------------------------------------------------------------


def read_variable(
    source: Source,
    name: str,
    part: VariablePart,
    algebra: LieAlgebra,
    representations: Mapping[str, Representation],
) -> Variable:
    """A variable with its place in the algebra.

    Raises:
        SpecError: The block or the representation is unknown, or does not go with the role.
    """
    key: KeyPath = ("variables", name)
    alien = "block" if part.role == "advected" else "representation"
    if getattr(part, alien) is not None:
        rightful = "velocities and momenta" if alien == "block" else "advected quantities"
        raise source.fault(
            (*key, alien),
            f"the {part.role} {name!r} has a {alien}",
            found=str(getattr(part, alien)),
            expected=f"{alien} for {rightful} alone",
            hint=f"Remove {alien}.",
        )
    if part.role == "advected":
        representation = _representation(source, key, part, algebra, representations)
        shape: Shape = () if representation.dimension == 1 else (representation.dimension,)
        return Variable(name, part.role, shape, (), representation, part.unit, part.doc)
    block = _block(source, (*key, "block"), part, algebra)
    shape = () if len(block) == 1 else (len(block),)
    return Variable(name, part.role, shape, block, None, part.unit, part.doc)


def _representation(
    source: Source,
    key: KeyPath,
    part: VariablePart,
    algebra: LieAlgebra,
    declared: Mapping[str, Representation],
) -> Representation:
    """The action on an advected quantity."""
    known = (*_COMMON, *declared)
    name = part.representation
    if name is None:
        raise source.fault(
            key,
            f"the advected quantity {key[-1]!r} has no representation",
            found=str(key[-1]),
            expected=f"representation = one of {listed(known)}",
            hint='Write representation = "vector".',
        )
    if name not in known:
        raise source.fault(
            (*key, "representation"),
            f"there is no representation {name!a}",
            found=name,
            expected=f"one of {listed(known)}",
            hint=did_you_mean(name, known, f"Declare it under [representations.{name}]."),
        )
    if name in declared:
        return declared[name]
    with _located(source, (*key, "representation")):
        return representation_by_name(algebra, name)


def _block(
    source: Source, key: KeyPath, part: VariablePart, algebra: LieAlgebra
) -> tuple[int, ...]:
    """Places in the basis that a velocity or momentum spans."""
    if part.block is None:
        return tuple(range(algebra.dimension))
    if isinstance(part.block, list):
        places = _places(source, key, part.block, algebra.basis)
        if len(set(places)) < len(places):
            raise source.fault(
                key,
                "a name of the basis stands twice",
                found=listed(part.block),
                expected="each name once",
            )
        return places
    if part.block in algebra.blocks:
        return algebra.blocks[part.block]
    if part.block in algebra.basis:
        return (algebra.basis.index(part.block),)
    known = (*algebra.blocks, *algebra.basis)
    raise source.fault(
        key,
        f"{algebra.name} has no block {part.block!a}",
        found=part.block,
        expected=f"one of {listed(known)}",
        hint=did_you_mean(part.block, known),
    )


def read_parameter(source: Source, name: str, part: ParameterPart) -> Parameter:
    """A parameter with one exact default for each component, or none.

    Raises:
        SpecError: The default does not have the shape, or is not positive where it must be.
    """
    shape = tuple(part.shape)
    key: KeyPath = ("parameters", name, "default")
    default = None
    if part.default is not None:
        default = _spread(part.default, shape)
        if default is None:
            raise source.fault(
                key,
                f"the default of {name!r} does not have its shape {list(shape)}",
                found=_shape_text(part.default),
                expected=f"one number for all components, or {_shape_words(shape)}",
            )
        if part.positive and min(default) <= 0:
            raise source.fault(
                key,
                f"the default {min(default)} of {name!r} is not positive",
                found=str(min(default)),
                expected="positive numbers, since positive = true",
            )
    return Parameter(name, shape, part.positive, default, part.unit, part.doc)


def _spread(value: object, shape: Shape) -> tuple[Fraction, ...] | None:
    """One number for each component, row by row; None if the shape does not fit."""
    if not isinstance(value, list):
        assert isinstance(value, Fraction), value
        count = 1
        for length in shape:
            count *= length
        return (value,) * count
    if not shape or len(value) != shape[0]:
        return None
    if len(shape) == 1:
        return None if any(isinstance(entry, list) for entry in value) else tuple(value)
    rows = [_spread(row, shape[1:]) for row in value if isinstance(row, list)]
    whole = [row for row in rows if row is not None]
    return tuple(x for row in whole for x in row) if len(whole) == shape[0] else None


def _shape_words(shape: Shape) -> str:
    if not shape:
        return "a single number"
    counts = [f"{shape[0]} numbers"] if len(shape) == 1 else [f"{shape[0]} lists of {shape[1]}"]
    return f"a list of {counts[0]}"


def _shape_text(value: object) -> str:
    """The lengths of nested lists, for a message."""
    if not isinstance(value, list):
        return "a number"
    inner = {len(row) if isinstance(row, list) else 1 for row in value}
    return f"a list of {len(value)}" + (
        f" lists of {listed(map(str, inner))}" if inner != {1} else ""
    )
