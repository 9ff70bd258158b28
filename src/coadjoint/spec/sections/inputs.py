"""Inputs: the table [inputs], what drives the system from outside.

Comes in: its keys. Goes out: `Input` records with exact defaults.
Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from coadjoint.spec.core.components import Argument
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.parts import ArgumentPart, read_argument
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Source


class InputPart(ArgumentPart):
    """What drives the system from outside, as a control or a measured signal."""

    index: str | None = Field(
        None, description="the index of [index] that counts the members that have it"
    )
    rate: str | None = Field(
        None, description="the input that is its time derivative, where the motion needs this"
    )


@dataclass(frozen=True)
class Input(Argument):
    """What drives the system from outside: an argument of every kernel, any function of time.

    Attributes:
        rate: The input that is its time derivative, or "".
    """

    role: ClassVar[str] = "input"

    rate: str = ""


def read_inputs(reading: Reading, parts: Mapping[str, InputPart]) -> tuple[Input, ...]:
    """The inputs with one exact default for each component, or none.

    Raises:
        SpecError: A default does not have the shape, or a rate is not an input of the same shape.
        LimitError: There are too many.
    """
    source = reading.source
    inputs = []
    for name, part in parts.items():
        given = read_argument(source, ("inputs", name), part)
        _check_rate(source, name, parts)
        inputs.append(Input(**given, rate=part.rate or ""))
    reading.check_count("inputs", "inputs", inputs, "PARAMETER_COMPONENTS")
    return tuple(inputs)


def _check_rate(source: Source, name: str, parts: Mapping[str, InputPart]) -> None:
    """What is the rate of an input is another one, of its shape."""
    rate, size = parts[name].rate, (parts[name].shape, parts[name].form)
    same = [other for other, each in parts.items() if (each.shape, each.form) == size]
    alike = [other for other in same if other != name]
    if rate is not None and rate not in alike:
        problem = f"{rate!a} is not another input with the shape of {name!r}"
        expected = f"one of {list_names(alike)}" if alike else "another input of its shape"
        hint = did_you_mean(rate, alike) or "Declare it in [inputs]."
        raise source.fault(("inputs", name, "rate"), problem, rate, expected, hint)
    chain = [name]
    while (following := parts[chain[-1]].rate or "") in parts:
        if following in chain:
            problem = f"the rates {' -> '.join([*chain, following])} form a circle"
            expected = "an input whose rates end at one without"
            raise source.fault(("inputs", name, "rate"), problem, rate, expected)
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
