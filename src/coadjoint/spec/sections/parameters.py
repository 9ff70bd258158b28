"""Parameters: the table [parameters], the constants of the system.

Comes in: its keys. Goes out: `Parameter` records with exact defaults.
Read next: `coadjoint.spec.sections.inputs`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import ClassVar, Literal

from pydantic import Field

from coadjoint.spec.core.components import Argument, matrix_size
from coadjoint.spec.core.parts import ArgumentPart
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import misfit_form, read_default


class ParameterPart(ArgumentPart):
    """A constant of the system."""

    form: Literal["antisymmetric", "symmetric"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, or those with the diagonal, row by row",
    )
    positive: bool = Field(False, description="whether every component is positive")


@dataclass(frozen=True)
class Parameter(Argument):
    """A constant of the system.

    Attributes:
        positive: Whether every component may be assumed positive.
        form: ``"antisymmetric"`` or ``"symmetric"`` if it is such a matrix in formulas, else "".
    """

    role: ClassVar[str] = "parameter"

    positive: bool = False
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
        problem = f"the default {min(default)} of {name!r} is not positive"
        expected = "positive numbers, since positive = true"
        raise source.fault(key, problem, str(min(default)), expected)
    return Parameter(
        name=name,
        shape=shape,
        default=default,
        unit=part.unit,
        doc=part.doc,
        positive=part.positive,
        form=form,
    )


PARAMETERS = Table[tuple[Parameter, ...]](
    "parameters",
    ParameterPart,
    "the parameters by name",
    read_parameters,
    many=True,
    quantities=True,
    names=name_each,
)
