"""Parameters: the table [parameters], the constants of the system.

Comes in: its keys. Goes out: `Parameter` records with exact defaults.
Read next: `coadjoint.spec.sections.inputs`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from coadjoint.spec.core.components import Argument
from coadjoint.spec.core.parts import ArgumentPart, read_argument
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Source


class ParameterPart(ArgumentPart):
    """A constant of the system."""

    positive: bool = Field(False, description="whether every component is positive")
    index: str | None = Field(
        None,
        description="the index of [index] that counts the members that have it; its default is "
        "then one for all members, or a list with an entry for each",
    )
    repeats: bool = Field(
        False,
        description="whether the entries of its default, of which N is a multiple, are taken again "
        "and again along the members",
    )


@dataclass(frozen=True)
class Parameter(Argument):
    """A constant of the system.

    Attributes:
        positive: Whether every component may be assumed positive.
    """

    role: ClassVar[str] = "parameter"

    positive: bool = False


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
    given = read_argument(source, ("parameters", name), part)
    parameter = Parameter(**given, positive=part.positive)
    if parameter.default is not None and part.positive and min(parameter.default) <= 0:
        least = min(parameter.default)
        problem = f"the default {least} of {name!r} is not positive"
        expected = "positive numbers, since positive = true"
        raise source.fault(("parameters", name, "default"), problem, str(least), expected)
    return parameter


PARAMETERS = Table[tuple[Parameter, ...]](
    "parameters",
    ParameterPart,
    "the parameters by name",
    read_parameters,
    many=True,
    quantities=True,
    names=name_each,
)
