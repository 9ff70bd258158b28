"""How elements are written: quotients of sums of named monomials, and what a generator stands for.

Comes in: nothing. Goes out: the records that a `Field` hands to those who print or lower elements.
Read next: `coadjoint.exact.field`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from coadjoint.exact.element import Element


@dataclass(frozen=True)
class Adjoined:
    """A generator that stands for ``function(argument)``.

    Attributes:
        generator: Its name.
        function: ``sqrt``, ``sin``, ``cos``, ``exp`` or ``log``.
        argument: An element of generators adjoined before.
        partner: The generator of the cosine for a sine and the other way round, else empty.
    """

    generator: str
    function: str
    argument: Element
    partner: str = ""


@dataclass(frozen=True)
class Monomial:
    """A rational number times powers of generators, by name and in the order of the field."""

    number: Fraction
    powers: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Written:
    """A quotient as it is written: addends of the numerator over powers of divisors."""

    monomials: tuple[Monomial, ...]
    divisors: tuple[tuple[Element, int], ...]
