"""Observables: the table [observables], what is emitted with the dynamics.

Comes in: expressions. Goes out: `Observable` records of scalars, vectors and matrices.
Read next: `coadjoint.spec.sections.symmetries`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import Field

from coadjoint.spec.core.components import Shape, component_names
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.parts import TextPart
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.tree import Name, walk
from coadjoint.spec.core.values import Prose, Unit
from coadjoint.spec.sections.constraints import list_reactions
from coadjoint.spec.sections.reconstruction import RECONSTRUCTION, followed_shapes
from coadjoint.spec.sections.variables import motion_roles


class ObservablePart(TextPart):
    """A scalar, vector or matrix emitted with the dynamics."""

    alone = "expression"

    expression: str = Field(description="a scalar, vector or matrix of variables and parameters")
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")


@dataclass(frozen=True)
class Observable:
    """A declared scalar, vector or matrix emitted with the dynamics.

    Attributes:
        name: As declared.
        formula: Its value.
        unit: Unit text.
        doc: Free text for documents.
        follows: Whether it names what is reconstructed, so that the state alone does not give it.
    """

    name: str
    formula: Formula
    unit: str = ""
    doc: str = ""
    follows: bool = False

    @property
    def shape(self) -> Shape:
        """Shape of its value."""
        return self.formula.shape

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, row by row."""
        return component_names(self.name, self.shape)


def read_observables(
    reading: Reading, parts: Mapping[str, ObservablePart]
) -> tuple[Observable, ...]:
    """The observables, which may name multipliers of constraints and what is reconstructed."""
    reactions, followed = list_reactions(reading), followed_shapes(RECONSTRUCTION.of(reading))
    scope = reading.scope("an observable", motion_roles(reading), {**reactions, **followed})
    observables = []
    for name, part in parts.items():
        key = reading.source.place_of(("observables", name), "expression")
        formula = reading.formula(key, part.expression, scope, any_shape=True)
        follows = any(
            isinstance(each, Name) and each.name in followed for each in walk(formula.tree)
        )
        observables.append(
            Observable(name=name, formula=formula, unit=part.unit, doc=part.doc, follows=follows)
        )
    return tuple(observables)


OBSERVABLES = Table[tuple[Observable, ...]](
    "observables",
    ObservablePart,
    "what is emitted with the dynamics",
    read_observables,
    many=True,
    names=name_each,
)
