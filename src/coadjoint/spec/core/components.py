"""Components: what the entries of vectors and matrices are called, and which ones are kept.

Comes in: names, shapes and forms. Goes out: the names of components in order, and the whole matrix
from the entries that a form keeps. Read next: `coadjoint.spec.model`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, combinations_with_replacement, product
from math import isqrt
from typing import Any, Protocol

Shape = tuple[int, ...]


#: How a matrix is kept as a list: the entries above the diagonal, those with the diagonal, or all.
FORMS = ("antisymmetric", "symmetric", "matrix")


def component_names(name: str, shape: Shape, form: str = "") -> tuple[str, ...]:
    """Names of the components of a quantity, as books write them, row by row.

    >>> component_names("Pi", (3,))
    ('Pi1', 'Pi2', 'Pi3')
    >>> component_names("A", (2, 2))
    ('A11', 'A12', 'A21', 'A22')
    >>> component_names("M", (3,), "antisymmetric")
    ('M12', 'M13', 'M23')
    >>> component_names("Pi1", (2,))  # a digit at the end would run into the index
    ('Pi1_1', 'Pi1_2')
    >>> component_names("q", (4,), "quaternion")  # counted from the real part
    ('q0', 'q1', 'q2', 'q3')
    """
    if not shape:
        return (name,)
    first = 0 if form == "quaternion" else 1
    form = form if form in FORMS else ""
    if form:
        shape = (matrix_size(shape[0], form) or 0,) * 2
    indices = kept_places(shape[0], form) if form else product(*map(range, shape))
    joint = "_" if len(shape) == 2 and max(shape) > 9 else ""
    lead = name + "_" if name[-1].isdigit() or joint else name
    return tuple(lead + joint.join(str(n + first) for n in index) for index in indices)


def kept_places(size: int, form: str) -> list[tuple[int, int]]:
    """Rows and columns, from 0, of the entries that a form keeps."""
    match form:
        case "antisymmetric":
            return list(combinations(range(size), 2))
        case "symmetric":
            return list(combinations_with_replacement(range(size), 2))
    return [(i, j) for i in range(size) for j in range(size)]


def matrix_size(count: int, form: str) -> int | None:
    """Rows of the matrix of a form that has ``count`` entries to keep; None if there is none.

    >>> matrix_size(28, "antisymmetric"), matrix_size(6, "symmetric"), matrix_size(6, "matrix")
    (8, 3, None)
    """
    if form not in FORMS:
        return None
    near = isqrt(2 * count) if form != "matrix" else isqrt(count)
    sizes = (size for size in (near, near + 1) if len(kept_places(size, form)) == count > 0)
    return next(sizes, None)


def unpack(values: Sequence[Any], form: str) -> tuple[tuple[Any, ...], ...]:
    """The rows of the matrix that the kept entries stand for.

    Args:
        values: The kept entries, of any kind that negates and multiplies by 0.
        form: ``"antisymmetric"``, ``"symmetric"`` or ``"matrix"``.

    >>> unpack([3, -2, 1], "antisymmetric")
    ((0, 3, -2), (-3, 0, 1), (2, -1, 0))
    >>> unpack([1, 2, 3], "symmetric")
    ((1, 2), (2, 3))
    """
    size = matrix_size(len(values), form)
    assert size is not None, (len(values), form)
    entries = dict(zip(kept_places(size, form), values, strict=True))
    zero = 0 * values[0]
    for (i, j), value in list(entries.items()):
        if form == "antisymmetric":
            entries[j, i] = -value
        elif form == "symmetric":
            entries[j, i] = value
    return tuple(tuple(entries.get((i, j), zero) for j in range(size)) for i in range(size))


class Named(Protocol):
    """What has a name, a shape and names for its components."""

    @property
    def name(self) -> str:
        """As it is called in formulas."""

    @property
    def shape(self) -> Shape:
        """``()``, ``(n,)`` or ``(n, m)``."""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""


class Components:
    """Names of components and shape in formulas of a record with a name, a shape and a form."""

    name: str
    shape: Shape
    form: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape, self.form)

    @property
    def matrix_size(self) -> int | None:
        """Rows of the matrix that it is in formulas; None for scalars and vectors."""
        return matrix_size(self.shape[0], self.form) if self.form else None

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas: that of the whole matrix where there is a form."""
        return self.shape if self.matrix_size is None else (self.matrix_size,) * 2


@dataclass(frozen=True)
class Argument(Components):
    """An argument that a user gives to every kernel: a parameter or an input.

    Attributes:
        name: As declared, e.g. ``chi``.
        shape: ``()``, ``(n,)`` or ``(n, m)``; with a form ``(n,)`` for the n entries that it keeps.
        default: One exact value per component, row by row; None if the user must give it.
        unit: Unit text, ``"1"`` if dimensionless; inferred where none is declared.
        doc: Free text for documents.
        form: ``"antisymmetric"`` or ``"symmetric"`` if it is such a matrix in formulas, else "".
    """

    name: str
    shape: Shape
    default: tuple[Fraction, ...] | None = None
    unit: str = ""
    doc: str = ""
    form: str = ""
