"""Equations of whole quantities, as they are found and shown.

Comes in: nothing. Goes out: the records `VectorLine` and `VectorForm`. Read next:
`coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from coadjoint.notation.written import Written
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape


@dataclass(frozen=True)
class VectorLine:
    """An equation of a whole quantity.

    Attributes:
        left: Its left side.
        right: Its right side.
    """

    left: tree.Node
    right: tree.Node


@dataclass(frozen=True)
class VectorForm:
    """What was found.

    Attributes:
        lines: The equations.
        missing: Names of whole quantities of the state whose equations stand in components alone.
        shapes: Shapes of whole quantities, for printing.
        written: How some names are written.
        told: What is said of names that stand in the lines alone.
        within: Names of scalars that are entries of matrices whose equations stand in the lines.
    """

    lines: tuple[VectorLine, ...]
    missing: tuple[str, ...]
    shapes: Mapping[str, Shape]
    written: Mapping[str, Written]
    told: str = ""
    within: frozenset[str] = frozenset()


def list_taken(spec: Spec) -> frozenset[str]:
    """Names that letters may not have: of variables and parameters, and of their components."""
    quantities = (*spec.variables, *spec.parameters)
    return frozenset(name for each in quantities for name in (each.name, *each.components))


def rate_of(node: tree.Node) -> tree.Node:
    """The rate of a quantity."""
    return tree.Call(function="rate_of", arguments=(node,))
