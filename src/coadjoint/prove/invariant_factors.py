r"""Invariant factors: functions F of a motion whose rate is a multiple of themselves.

.. math:: \dot F = K F

They are called Darboux polynomials, or second integrals, and K the cofactor. Their zero sets are
invariant. A product of their powers is the density of an invariant measure if the sum of exponents
times cofactors is :math:`-\operatorname{div} X`: for the exponents this is a linear equation at
each point.
Candidates are the velocities, the factors of their rates, and the factors of the determinant of
:math:`\eta, \dot\eta, \ddot\eta, \dots`, which every invariant linear function of the velocities
divides (the extactic polynomial of Lagutinskii; Christopher, Llibre and Pereira 2007).
Comes in: a motion. Goes out: factors, each of which passed the test.
Read next: `coadjoint.prove.measures`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property, reduce

from coadjoint.exact import Element
from coadjoint.exact.denominators import remove_factor
from coadjoint.exact.dense import determinant
from coadjoint.exact.element import numerator
from coadjoint.exact.factors import common_divisor
from coadjoint.exact.irreducible import find_factors
from coadjoint.prove.motion import Motion
from coadjoint.prove.samples import leading

#: Terms of a polynomial that is factored, and symbols of the state in it: more may take minutes.
TERMS = 60
SYMBOLS = 4
#: Terms of a rate up to which its common divisor with the others is computed.
LONGEST = 200
#: Velocities up to which the determinant is taken.
SIZE = 3


class InvariantFactors:
    """The search for invariant factors of one motion.

    Args:
        motion: The motion.
        allowed: The velocities that kept constraints give in terms of the others.
    """

    def __init__(self, motion: Motion, allowed: Mapping[str, Element]) -> None:
        self.motion, self.field, self.allowed = motion, motion.field, allowed
        self.free = [n for n in motion.fibre if n not in allowed]

    def short(self) -> list[Element]:
        """Those among the velocities and the factors of the common divisor of their rates."""
        velocities = [self.field[name] for name in self.free]
        return self._choose_invariant([*velocities, *self._common_factors(velocities)])

    def all(self) -> list[Element]:
        """Those among all candidates that are not too large to be factored."""
        return self._choose_invariant([*self.short(), *self._factors()])

    def _choose_invariant(self, candidates: Iterable[Element]) -> list[Element]:
        """Candidates that depend on velocities and are invariant, each once."""
        known = list[Element]()
        for candidate in candidates:
            factor = -candidate if leading(candidate) < 0 else candidate
            moving = self.field.reach(factor) & set(self.free)
            if moving and factor not in known and self.is_invariant(factor):
                known.append(factor)
        return known

    def is_invariant(self, factor: Element) -> bool:
        """Whether a polynomial divides its rate, which is not zero.

        Of an integral every power is one, and none of them changes a measure.
        """
        rate = self._rate(factor)
        return rate != 0 and remove_factor(numerator(rate), numerator(factor), 1)[0] == 1

    def _rate(self, function: Element) -> Element:
        """The rate of a function on the constraints that are kept."""
        return self.field.normal(self.field.substitute(self.motion.rate(function), self.allowed))

    @cached_property
    def rates(self) -> list[Element]:
        """The rates of the free velocities."""
        return [self._rate(self.field[name]) for name in self.free]

    def _common_factors(self, velocities: Sequence[Element]) -> list[Element]:
        """The factors of the greatest common divisor of the rates."""
        numerators = [numerator(rate) for rate in self.rates if rate != 0]
        if not numerators or max(map(len, numerators)) > LONGEST:
            return []
        divisor = reduce(common_divisor, numerators)
        whole = self.field.from_polynomial(divisor)
        return find_factors(self.field, whole, velocities) if len(divisor) <= TERMS else [whole]

    def _factors(self) -> Iterator[Element]:
        """The factors of the rates and of the determinant."""
        for element in (*self.rates, *self._determinant()):
            if self._is_short(element):
                yield from find_factors(self.field, element)

    def _is_short(self, element: Element) -> bool:
        """Whether a function can be factored in little time."""
        moving = {*self.motion.equations.setting.state} & self.field.reach(element)
        return element != 0 and len(numerator(element)) <= TERMS and len(moving) <= SYMBOLS

    def _determinant(self) -> Iterator[Element]:
        """``det(eta, d eta/dt, ...)``, if there are few velocities with short rates."""
        short = all(self._is_short(rate) for rate in self.rates if rate != 0)
        if not 1 < len(self.rates) <= SIZE or not short:
            return
        rows = [tuple(self.field[name] for name in self.free)]
        while len(rows) < len(self.free):
            rows.append(tuple(self._rate(value) for value in rows[-1]))
        yield self.field.normal(determinant(tuple(rows)))
