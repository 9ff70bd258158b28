"""Regions: where values of the functions of a field are looked at.

Comes in: what a spec declares: its parameters, defaults and the conditions of ``[domain]``. Goes
out: a record that stays with the `Field`, so that nothing is decided outside of the domain. The
field itself knows only which symbols are positive.
Read next: `coadjoint.prove.points`, which draws points in it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Protocol

from coadjoint.exact.element import Element


@dataclass(frozen=True)
class Condition:
    """An element that is positive, or not negative, wherever something is asked for.

    Attributes:
        element: The element.
        strict: Whether it is never 0.
    """

    element: Element
    strict: bool


class Loop(Protocol):
    """Equations that have no written solution: see `coadjoint.exact.factored`."""

    @property
    def sides(self) -> Sequence[Element]:
        """Both sides."""

    def run_loop(self, symbol: str, value: Callable[[Element], Any]) -> dict[str, Any]:
        """Values of a symbol and others, given what takes elements into an arithmetic."""


@dataclass(frozen=True)
class Region:
    """Where a system is defined and its motion has values.

    Attributes:
        parameters: The symbols that are parameters: claims hold for almost all of their values.
        defaults: A value for each symbol that has one.
        conditions: What holds wherever anything in the field is asked for, as ``cos(phi) > 0``;
            normal forms rest on it. `Field.assume` adds to it.
        bounds: What also holds where claims are looked at, of reactions and pivots for example;
            normal forms know nothing of it.
        definitions: Values of further names, each in terms of symbols and of names before it.
        momenta: Momenta in terms of velocities, for functions that are written in velocities.
        loops: What gives symbols that definitions name and that have no formula.
    """

    parameters: frozenset[str] = frozenset()
    defaults: Mapping[str, Fraction] = field(default_factory=dict)
    conditions: tuple[Condition, ...] = ()
    bounds: tuple[Condition, ...] = ()
    definitions: Mapping[str, Element] = field(default_factory=dict)
    momenta: Mapping[str, Element] = field(default_factory=dict)
    loops: Mapping[str, Loop] = field(default_factory=dict)
