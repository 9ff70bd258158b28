"""Ideals: what is zero where given relations hold, such as ``Pi . Gamma = 0``.

Comes in: the relations, as elements of the field. Goes out: remainders modulo the ideal that their
numerators generate, and points where all of them vanish. A remainder of zero proves that an element
vanishes wherever the relations do and its denominator does not; a counter-example on the zero set
refutes it. Read next: `coadjoint.prove.zero`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from typing import Any

import mpmath
from sympy.polys.groebnertools import groebner
from sympy.polys.orderings import grevlex
from sympy.polys.rings import PolyElement, PolyRing

from coadjoint.exact import Element, Field

#: Steps of Newton's method; it halves an error at least, also where the zero set is singular.
STEPS = 150


class Ideal:
    """The ideal of the numerators of some elements.

    Args:
        field: Where the elements live.
        relations: What is zero.
        text: The relations for people, ``dot(Pi, Gamma) = 0``.
        variables: Symbols that `solved` may solve for; by default all.

    >>> field = Field(["x", "y", "z"])
    >>> x, y, z = field["x"], field["y"], field["z"]
    >>> ideal = Ideal(field, [x * y - z], "x*y = z")
    >>> ideal.contains(x**2 * y / z - x), ideal.contains(x - y)
    (True, False)
    """

    def __init__(
        self,
        field: Field,
        relations: Sequence[Element],
        text: str = "",
        variables: Sequence[str] = (),
    ) -> None:
        self.field = field
        self._variables = frozenset(variables or field.names)
        self.relations = tuple(map(field.normal, relations))
        self.text = text
        numerators = [_numerator(each) for each in self.relations if each != 0]
        self._places = sorted(
            {n for p in numerators for exponents in p for n, e in enumerate(exponents) if e}
        )
        if numerators:
            whole = numerators[0].ring
            symbols = [whole.symbols[n] for n in self._places]
            self._ring = PolyRing(symbols, whole.domain, grevlex)  # half the time of lex
        own = [poly for p in numerators for poly in self._coefficients(p).values()]
        self._basis = _groebner_basis(own)

    def remainder(self, element: Element) -> Element:
        """The remainder of an element's numerator; 0 if and only if the ideal contains it."""
        combined = self.field.normal(element).combined()
        if combined == 0 or not self._basis:
            return combined
        terms: dict[tuple[int, ...], Any] = {}
        for outer, inner in self._coefficients(_numerator(combined)).items():
            for exponents, value in inner.rem(self._basis).terms():
                whole = list(outer)
                for place, exponent in zip(self._places, exponents, strict=True):
                    whole[place] = exponent
                terms[tuple(whole)] = value
        return self.field.polynomial(self.field.names, terms)

    def _coefficients(self, numerator: PolyElement) -> dict[tuple[int, ...], PolyElement]:
        """A polynomial as one in the symbols that no relation has; its coefficients by exponents.

        Each is reduced by itself, among the few symbols of the relations: for two coupled bodies,
        one of 30 symbols whole takes a hundred times as long.
        """
        parts: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
        for exponents, value in numerator.terms():
            outer = [0 if n in self._places else e for n, e in enumerate(exponents)]
            inner = tuple(exponents[n] for n in self._places)
            parts.setdefault(tuple(outer), {})[inner] = value
        return {outer: self._ring.from_dict(terms) for outer, terms in parts.items()}

    def contains(self, element: Element) -> bool:
        """Whether an element vanishes wherever the relations do, as the ideal shows."""
        return bool(self.remainder(element) == 0)

    @cached_property
    def solved(self) -> Mapping[str, Element]:
        """Some symbols in terms of the others, on the zero set.

        A relation is solved for the first symbol in which it is linear; one that is linear in none
        is left, and then these are fewer than the relations.
        """
        known: dict[str, Element] = {}
        for relation in self.relations:
            value = self.field.substitute(relation, known)
            for name in sorted(self.field.names_in(value) & self._variables):
                slope = self.field.derivative(value, name)
                if not self.field.is_zero(slope) and name not in self.field.reach(slope):
                    root = -self.field.substitute(value, {name: self.field.zero}) / slope
                    known = {n: self.field.substitute(v, {name: root}) for n, v in known.items()}
                    known[name] = root
                    break
        return known

    @property
    def is_solved(self) -> bool:
        """Whether `solved` gives all of the zero set, but for where its denominators vanish."""
        return len(self.solved) == len(self.relations)

    def on_zero_set(self, element: Element) -> Element:
        """An element with the solved symbols replaced."""
        return self.field.substitute(element, self.solved)

    def completed(self, point: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """A point of the zero set from values of the symbols that are free.

        Raises:
            ZeroDivisionError: The solved symbols are not defined there.
        """
        values = {
            name: self.field.evaluate(root, point, Fraction, _no_call)
            for name, root in self.solved.items()
        }
        return {**point, **values}

    def near(self, starts: Iterable[Mapping[str, Fraction]]) -> Iterator[dict[str, Any]]:
        """Points of the zero set, to the working precision of mpmath, near rational ones.

        Newton's method along the gradients of the relations; starts from which it does not
        converge, or leaves the domain of a function, are passed over.
        """
        slopes = [self.field.gradient(relation, self.names) for relation in self.relations]
        for start in starts:
            point = {name: mpmath.mpf(x.numerator) / x.denominator for name, x in start.items()}
            with suppress(ZeroDivisionError, ValueError):
                for _ in range(STEPS):
                    rest = mpmath.matrix([self._value(each, point) for each in self.relations])
                    if mpmath.norm(rest, mpmath.inf) < mpmath.mpf(10) ** -(mpmath.mp.dps - 5):
                        yield point
                        break
                    turn = mpmath.matrix([[self._value(s, point) for s in row] for row in slopes])
                    step = turn.T * mpmath.lu_solve(turn * turn.T, rest)
                    moved = zip(self.names, step, strict=True)
                    point = point | {name: point[name] - by for name, by in moved}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The variables that occur in the relations, in the order of the field."""
        present = frozenset[str]().union(*map(self.field.reach, self.relations))
        return tuple(name for name in self.field.names if name in present & self._variables)

    def _value(self, element: Element, point: Mapping[str, Any]) -> Any:
        """The value of an element at a real point, functions included."""
        return self.field.evaluate(
            element, point, lambda x: mpmath.mpf(x.numerator) / x.denominator, real_function
        )


def real_function(function: str, argument: Any) -> Any:
    """A real elementary function, to the working precision of mpmath.

    Raises:
        ValueError: The argument is outside the real domain.
    """
    if (argument < 0 and function in ("sqrt", "log")) or (argument == 0 and function == "log"):
        raise ValueError(f"{function} of {argument}")
    return getattr(mpmath, function)(argument)


def _numerator(element: Element) -> PolyElement:
    """The numerator of a nonzero element."""
    (quotient,) = element.combined().parts
    return quotient.numer


def _groebner_basis(polynomials: Sequence[PolyElement]) -> list[PolyElement]:
    """A Groebner basis; of one polynomial it is that polynomial."""
    if len(polynomials) < 2:
        return list(polynomials)
    return list(groebner(list(polynomials), polynomials[0].ring))


def _no_call(function: str, argument: Fraction) -> Fraction:
    raise ZeroDivisionError(f"{function}({argument}) is not rational")
