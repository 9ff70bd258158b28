"""Regions: what may be assumed of the symbols of a field, and where their values are looked at.

Comes in: what a spec declares: its parameters, defaults and the conditions of ``[domain]``. Goes
out: a record that stays with the `Field`, so that nothing is decided outside of the domain.
Read next: `coadjoint.prove.points`, which draws points in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from coadjoint.exact.element import Element


@dataclass(frozen=True)
class Inequality:
    """A value that is positive, or not negative.

    Attributes:
        text: For people, ``q > 0``.
        value: The side that is larger minus the other.
        strict: Whether it may not be zero.
    """

    text: str
    value: Element
    strict: bool


@dataclass(frozen=True)
class Region:
    """Where a system is defined.

    Attributes:
        parameters: The symbols that are parameters: claims hold for almost all of their values.
        defaults: A value for each symbol that has one.
        inequalities: What holds there.
        definitions: Values of further names, each in terms of symbols and of names before it.
        momenta: Momenta in terms of velocities, for functions that are written in velocities.
    """

    parameters: frozenset[str] = frozenset()
    defaults: Mapping[str, Fraction] = field(default_factory=dict)
    inequalities: tuple[Inequality, ...] = ()
    definitions: Mapping[str, Element] = field(default_factory=dict)
    momenta: Mapping[str, Element] = field(default_factory=dict)
