"""Quantities: variables, parameters, inputs and time of a spec, with shapes and component names.

Comes in: what `coadjoint.spec.sections.structure` read. Goes out: frozen records, and which
variables make the state. Read next: `coadjoint.spec.model`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from coadjoint.algebra.lie_algebra import SparseMatrix
from coadjoint.algebra.representation import Representation
from coadjoint.spec.core.components import Shape, component_names, matrix_size


@dataclass(frozen=True)
class Variable:
    """A velocity, momentum or advected quantity, or a coordinate of a space with a bracket.

    Attributes:
        name: As declared, e.g. ``Omega``.
        role: ``"velocity"``, ``"momentum"``, ``"advected"`` or ``"coordinate"``.
        shape: ``()`` for a block of one basis element, else ``(n,)``, also where it is a matrix.
        block: Places in the algebra's basis that a velocity or momentum spans; empty if advected.
        representation: How the algebra acts on an advected quantity; None otherwise.
        unit: Unit text of the restricted unit alphabet, ``"1"`` if dimensionless.
        doc: Free text for documents.
        form: One of `FORMS` if the components are the entries of a matrix, else "".
        of: The coordinate whose velocity or momentum it is; "" over an algebra.
        elements: Matrices of which a velocity is the sum, weighted by its components, in formulas;
            empty where the form says it all.
        default: Where a simulation begins, one exact value per component; None if nothing is said.
        independent: Under constraints, whether a velocity is part of the state; None without any.
    """

    name: str
    role: str
    shape: Shape
    block: tuple[int, ...] = ()
    representation: Representation | None = None
    unit: str = "1"
    doc: str = ""
    form: str = ""
    of: str = ""
    elements: tuple[SparseMatrix, ...] = ()
    default: tuple[Fraction, ...] | None = None
    independent: bool | None = None

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


def state_of(variables: Sequence[Variable]) -> tuple[Variable, ...]:
    """The variables that make the state, in declared order; see `Spec.state`."""
    given = {variable.of for variable in variables if variable.role == "momentum"}
    return tuple(
        variable
        for variable in variables
        if variable.independent
        or variable.role != "velocity"
        or (variable.independent is None and variable.of and variable.of not in given)
    )


@dataclass(frozen=True)
class Parameter:
    """A constant of the system.

    Attributes:
        name: As declared, e.g. ``chi``.
        shape: ``()``, ``(n,)`` or ``(n, m)``; with a form ``(n,)`` for the n entries that it keeps.
        positive: Whether every component may be assumed positive.
        default: One exact value per component, row by row; None if the user must give it.
        unit: Unit text, ``"1"`` if dimensionless.
        doc: Free text for documents.
        form: ``"antisymmetric"`` or ``"symmetric"`` if it is such a matrix in formulas, else "".
    """

    role: ClassVar[str] = "parameter"

    name: str
    shape: Shape
    positive: bool = False
    default: tuple[Fraction, ...] | None = None
    unit: str = "1"
    doc: str = ""
    form: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape, self.form)

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas: that of the whole matrix where there is a form."""
        size = matrix_size(self.shape[0], self.form) if self.form else None
        return self.shape if size is None else (size, size)


@dataclass(frozen=True)
class Input:
    """What drives the system from outside: an argument of every kernel, any function of time.

    Attributes:
        name: As declared, e.g. ``u``.
        shape: ``()``, ``(n,)`` or ``(n, m)``.
        default: One exact value per component, row by row; None if the user must give it.
        unit: Unit text, ``"1"`` if dimensionless.
        doc: Free text for documents.
        rate: The input that is its time derivative, or "".
    """

    role: ClassVar[str] = "input"

    name: str
    shape: Shape
    default: tuple[Fraction, ...] | None = None
    unit: str = "1"
    doc: str = ""
    rate: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape)

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas."""
        return self.shape


@dataclass(frozen=True)
class Time:
    """The time, where formulas name it: a scalar argument of every kernel.

    Attributes:
        name: As declared, e.g. ``t``.
        unit: Unit text.
        doc: Free text for documents.
    """

    role: ClassVar[str] = "time"
    shape: ClassVar[Shape] = ()
    value_shape: ClassVar[Shape] = ()
    default: ClassVar[None] = None

    name: str
    unit: str = "s"
    doc: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)
