"""Denominators: the polynomials in them, numbered, and how often each divides another one.

Comes in: polynomials of one SymPy ring. Goes out: their powers of known factors, and what is left,
found by trial division: no polynomial gcd is ever taken.
Read next: `coadjoint.exact.element`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import reduce
from heapq import heapify, heappop, heappush
from operator import add, le, mul, neg, sub
from typing import TYPE_CHECKING, Any

from sympy.polys.rings import PolyElement, PolyRing

if TYPE_CHECKING:
    from coadjoint.exact.element import Element
    from coadjoint.exact.numbers import Numbers


class BudgetSpent(Exception):  # noqa: N818 (no error: a search ends early)
    """A computation inside `Factors.budget` took more work than it was given."""


class Factors:
    """The polynomials that occur in denominators, numbered in the order of first use.

    Args:
        ring: Where they live.
        functions: How many of the last generators stand for functions. Quotients over different
            ones stay apart, like those over different factors: the forces between three particles
            have three distances, and over a common denominator all of them would be long.
    """

    def __init__(self, ring: PolyRing, functions: int = 0) -> None:
        self.ring = ring
        #: The algebraic numbers that coefficients may be; None for the rationals alone.
        self.numbers: Numbers | None = None
        self._functions = frozenset(ring.gens[ring.ngens - functions :])
        self.known: list[PolyElement] = []
        self.monomial: list[bool] = []
        self._occurring: list[frozenset[int]] = []
        #: Of each factor that is a single generator its place, of others -1.
        self.places: list[int] = []
        #: Whether an element that is not the polynomial 0 is zero all the same; a field says.
        self.is_hidden_zero: Callable[[Element], bool] = lambda _: False
        self._numbers: dict[PolyElement, int] = {}
        self._slopes: dict[tuple[int, int], PolyElement] = {}
        self._left: int | None = None

    @contextmanager
    def budget(self, work: int) -> Iterator[None]:
        """A block in which arithmetic ends after so much work.

        Work is counted in products of two terms and in terms that are evaluated, about a
        microsecond each, and not in seconds: a search ends at the same place on every machine.

        Raises:
            BudgetSpent: In the block, when the work is done.
        """
        outer = self._left
        self._left = work if outer is None else min(work, outer)
        given = self._left
        try:
            yield
        finally:
            self._left = None if outer is None else outer - (given - self._left)

    def spend(self, work: int) -> None:
        """Count work that is about to be done.

        Raises:
            BudgetSpent: There is a budget, and this is more than is left of it.
        """
        if self._left is not None:
            if work > self._left:
                self._left = 0
                raise BudgetSpent
            self._left -= work

    def split(self, p: PolyElement) -> tuple[Any, dict[int, int]]:
        """``p = constant * product of known factors``, registering what is new.

        Powers of single generators are split off, then factors seen before; what is left becomes a
        new factor, whole: it need not be irreducible.
        """
        powers: dict[int, int] = {}
        least = tuple(map(min, zip(*p, strict=True)))
        for generator, count in zip(self.ring.gens, least, strict=True):
            if count:
                powers[self._number(generator)] = count
        p = p.quo_term((least, self.ring.domain.one))
        whole = self._numbers.get(p.monic())
        if whole is not None:  # none of the factors before it divides it
            powers[whole] = powers.get(whole, 0) + 1
            return p.LC, powers
        occurring = _generators_in(p)
        for number, factor in enumerate(self.known):
            if not self._occurring[number] <= occurring:
                continue
            count, p = remove_factor(p, factor)
            if count:
                powers[number] = powers.get(number, 0) + count
                occurring = _generators_in(p)
        constant = p.LC
        if not p.is_ground:
            powers[self._number(p.monic())] = 1
        return constant, powers

    def remove(self, p: PolyElement, number: int, most: int) -> tuple[int, PolyElement]:
        """As `remove_factor`, of a known factor; most of them are single generators."""
        place = self.places[number]
        if place < 0:
            return remove_factor(p, self.known[number], most)
        count = most
        for monomial in p:
            count = min(count, monomial[place])
            if count <= 0:
                return 0, p
        left = p.ring.zero
        for monomial, value in p.items():
            rest = monomial[place] - count
            left[(*monomial[:place], rest, *monomial[place + 1 :])] = value
        return count, left

    def product(self, powers: Mapping[int, int]) -> PolyElement:
        """The product of powers of known factors."""
        return reduce(mul, (self.known[n] ** e for n, e in sorted(powers.items())), self.ring.one)

    def slope(self, number: int, place: int) -> PolyElement:
        """Derivative of a known factor by the generator at a place, remembered."""
        if (number, place) not in self._slopes:
            self._slopes[number, place] = self.known[number].diff(place)
        return self._slopes[number, place]

    def _number(self, factor: PolyElement) -> int:
        if factor not in self._numbers:
            self._numbers[factor] = len(self.known)
            self.known.append(factor)
            self._occurring.append(_generators_in(factor))
            place = self.ring.gens.index(factor) if factor.is_generator else -1
            self.places.append(place)
            self.monomial.append(len(factor) == 1 and factor not in self._functions)
        return self._numbers[factor]


def _generators_in(p: PolyElement) -> frozenset[int]:
    """Places of the generators that occur in a nonzero polynomial."""
    return frozenset(place for place, degree in enumerate(p.degrees()) if degree > 0)


def remove_factor(
    p: PolyElement, factor: PolyElement, most: int = 10**6
) -> tuple[int, PolyElement]:
    """How often, up to a number of times, a factor divides a nonzero polynomial; what is left."""
    count = 0
    while count < most and (quotient := _quotient(p, factor)) is not None:
        count, p = count + 1, quotient
    return count, p


def _quotient(p: PolyElement, factor: PolyElement) -> PolyElement | None:
    """``p / factor`` if the division is exact, else None, mostly found at the first look.

    Nearly every trial fails, and SymPy's `div` would go on to a remainder that is not needed:
    this loop ends at the first term that the factor does not divide.
    """
    if len(factor) == 1:
        if not all(_divides(factor.LM, monomial) for monomial in p):
            return None
        return p.quo_term((factor.LM, factor.LC))
    if not (_divides(factor.LM, max(p)) and _divides(min(factor), min(p))):
        return None
    leading, scale = factor.LT
    others = [(monomial, value) for monomial, value in factor.items() if monomial != leading]
    quotient, rest = p.ring.zero, dict(p)
    heap = [tuple(map(neg, monomial)) for monomial in rest]  # the largest one comes first
    heapify(heap)
    while heap:
        lead = tuple(map(neg, heappop(heap)))
        value = rest.pop(lead, None)
        if value is None:  # it was cancelled
            continue
        if not _divides(leading, lead):
            return None
        step, times = tuple(map(sub, lead, leading)), value / scale
        quotient[step] = times
        for monomial, other in others:
            place = tuple(map(add, monomial, step))
            if place not in rest:
                rest[place] = -times * other
                heappush(heap, tuple(map(neg, place)))
            elif new := rest[place] - times * other:
                rest[place] = new
            else:
                del rest[place]
    return quotient


def _divides(a: tuple[int, ...], b: tuple[int, ...]) -> bool:
    """Whether one monomial divides another; in the order lex, tuples compare as monomials do."""
    return all(map(le, a, b))
