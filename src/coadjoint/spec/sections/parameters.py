"""Parameters: the table [parameters], the constants of the system.

Comes in: its keys. Goes out: `Parameter` records with exact defaults.
Read next: `coadjoint.spec.sections.inputs`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from coadjoint.spec.core.components import Components, Shape, matrix_size
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import Length, Numbers, Prose, Unit, misfit_form, read_default


class ParameterPart(Part):
    """A constant of the system."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    form: Literal["antisymmetric", "symmetric"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, or those with the diagonal, row by row",
    )
    positive: bool = Field(False, description="whether every component is positive")
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Parameter(Components):
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


def read_parameters(reading: Reading, parts: Mapping[str, ParameterPart]) -> tuple[Parameter, ...]:
    """The parameters, in declared order.

    Raises:
        SpecError: A default does not have the shape, or is not positive where it must be, or the
            components fill no matrix of the form.
        LimitError: There are too many.
    """
    parameters = tuple(_read_parameter(reading.source, name, part) for name, part in parts.items())
    reading.check_count("parameters", "parameters", parameters, "PARAMETER_COMPONENTS")
    return parameters


def _read_parameter(source: Source, name: str, part: ParameterPart) -> Parameter:
    """A parameter with one exact default for each component, or none."""
    shape, form = tuple(part.shape), part.form or ""
    if form:
        shape = shape or (1,)
        if len(shape) > 1 or matrix_size(shape[0], form) is None:
            raise misfit_form(source, ("parameters", name, "form"), prod(shape), form)
    key: KeyPath = ("parameters", name, "default")
    default = read_default(source, key, part.default, shape)
    if default is not None and part.positive and min(default) <= 0:
        raise source.fault(
            key,
            f"the default {min(default)} of {name!r} is not positive",
            found=str(min(default)),
            expected="positive numbers, since positive = true",
        )
    return Parameter(name, shape, part.positive, default, part.unit, part.doc, form)


PARAMETERS = Table[tuple[Parameter, ...]](
    "parameters",
    ParameterPart,
    "the parameters by name",
    read_parameters,
    many=True,
    quantities=True,
    names=name_each,
)
