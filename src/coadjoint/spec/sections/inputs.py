"""Inputs: the table [inputs], what drives the system from outside.

Comes in: its keys. Goes out: `Input` records with exact defaults.
Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, ClassVar

from pydantic import Field

from coadjoint.spec.core.components import Components, Shape
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.parts import Part
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import Length, Numbers, Prose, Unit, read_default


class InputPart(Part):
    """What drives the system from outside, as a control or a measured signal."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    rate: str | None = Field(
        None, description="the input that is its time derivative, where the motion needs this"
    )
    unit: Unit = Field("1", description="unit, such as 'N m'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Input(Components):
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


def read_inputs(reading: Reading, parts: Mapping[str, InputPart]) -> tuple[Input, ...]:
    """The inputs with one exact default for each component, or none.

    Raises:
        SpecError: A default does not have the shape, or a rate is no input of the same shape.
        LimitError: There are too many.
    """
    source = reading.source
    inputs = []
    for name, part in parts.items():
        shape = tuple(part.shape)
        default = read_default(source, ("inputs", name, "default"), part.default, shape)
        _check_rate(source, name, parts)
        inputs.append(Input(name, shape, default, part.unit, part.doc, part.rate or ""))
    reading.check_count("inputs", "inputs", inputs, "PARAMETER_COMPONENTS")
    return tuple(inputs)


def _check_rate(source: Source, name: str, parts: Mapping[str, InputPart]) -> None:
    """What is the rate of an input is another one, of its shape."""
    rate = parts[name].rate
    alike = [other for other in parts if other != name and parts[other].shape == parts[name].shape]
    if rate is not None and rate not in alike:
        raise source.fault(
            ("inputs", name, "rate"),
            f"{rate!a} is not another input with the shape of {name!r}",
            found=rate,
            expected=f"one of {list_names(alike)}" if alike else "another input of its shape",
            hint=did_you_mean(rate, alike) or "Declare it in [inputs].",
        )
    chain = [name]
    while (following := parts[chain[-1]].rate or "") in parts:
        if following in chain:
            raise source.fault(
                ("inputs", name, "rate"),
                f"the rates {' -> '.join([*chain, following])} form a circle",
                found=rate,
                expected="an input whose rates end at one without",
            )
        chain.append(following)


INPUTS = Table[tuple[Input, ...]](
    "inputs",
    InputPart,
    "what drives the system, by name",
    read_inputs,
    many=True,
    quantities=True,
    names=name_each,
)
