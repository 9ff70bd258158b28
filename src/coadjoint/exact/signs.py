"""Signs that hold at every point of a domain, from declared signs and sums of positive terms.

Comes in: an element, in a field that knows which symbols and elements are positive. Goes out: its
sign where it is certain. Where none is, the element may have any sign: nothing is guessed.
Read next: `coadjoint.exact.relations`, `coadjoint.prove.equivalence`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from sympy.polys.rings import PolyElement

from coadjoint.exact.element import Element
from coadjoint.exact.factors import factors_of
from coadjoint.exact.field import Field

#: The sign of a generator by its place in the ring: 1 or 0 for not known.
KnownSign = Callable[[int], int]


def sign_of_sum(p: PolyElement, known: KnownSign, *, strict: bool) -> int:
    """The common sign of the terms of a polynomial; 0 if there is none.

    Args:
        p: Not zero.
        known: Signs of generators; of one that has none, even powers are not negative.
        strict: Whether the sum may nowhere be 0: one term at least is a product of positive ones.
    """
    signs, certain = set[int](), False
    for exponents, coefficient in p.terms():
        odd = [n for n, e in enumerate(exponents) if e % 2]
        if not all(known(n) for n in odd):
            return 0
        signs.add(1 if coefficient > 0 else -1)
        certain = certain or all(known(n) for n, e in enumerate(exponents) if e)
    return signs.pop() if len(signs) == 1 and (certain or not strict) else 0


def sign(field: Field, element: Element, *, strict: bool = True) -> int:
    """The sign of an element wherever it is defined and the conditions of its field hold.

    Args:
        field: What knows the signs.
        element: Any element.
        strict: Whether it may nowhere be 0. Otherwise the sign is that of all its other values.

    Returns:
        1 or -1, or 0 where no sign is certain.

    >>> field = Field(["m", "q", "v"], slots=2, positive=["m"])
    >>> m, q, v = (field[name] for name in "mqv")
    >>> sign(field, m + q**2), sign(field, m * q**2), sign(field, m * q**2, strict=False)
    (1, 0, 1)
    >>> sign(field, m + m * field.call("sin", q) ** 2), sign(field, m - q**2)
    (1, 0)
    """
    whole = field.normal(element)
    if whole == 0:
        return 0
    return Signs(field, strict=strict).of(whole.combined())


class Signs:
    """What a field knows of signs.

    Args:
        field: The field.
        strict: Whether values may nowhere be 0.
    """

    def __init__(self, field: Field, *, strict: bool) -> None:
        self.field, self.strict = field, strict
        self._of_names: dict[str, int] = {}
        self._given = list(self._conditions())

    def of(self, element: Element) -> int:
        """The sign of a nonzero element that is one quotient."""
        top, bottom = self.field.fraction(element)
        found = self._of_polynomial(top)
        for factor, exponent in bottom:  # nowhere 0 where the element is defined
            if exponent % 2:
                found *= Signs(self.field, strict=False)._of_polynomial(factor)
        return found

    def known(self, place: int) -> int:
        """The sign of a generator, which is 1 or not known."""
        name = self.field.generators[place]
        if name not in self._of_names:
            self._of_names[name] = self._of_generator(name)
        return self._of_names[name]

    def _of_generator(self, name: str) -> int:
        adjoined = self.field.adjoined.get(name)
        if adjoined is None:
            return int(name in self.field.positive)
        if adjoined.function == "sqrt":
            argument = self.field.normal(adjoined.argument).combined()
            return int(not self.strict or self.of(argument) == 1)
        return int(adjoined.function == "exp")

    def _conditions(self) -> Iterator[PolyElement]:
        """Monic factors that the conditions of the field say are positive, and minus the others."""
        for condition in self.field.conditions:
            if self.strict and not condition.strict:
                continue
            element = self.field.normal(condition.element).combined()
            if element == 0:
                continue
            top, bottom = self.field.fraction(element)
            if not bottom and not top.is_ground:
                yield top.monic() if top.LC > 0 else -top.monic()

    def _of_polynomial(self, p: PolyElement) -> int:
        """The sign of a nonzero polynomial: of the whole, else the product of its factors'."""
        found = self._plain(p)
        if found:
            return found
        content, factors = factors_of(p)
        found = 1 if content > 0 else -1
        for factor, exponent in factors:
            if exponent % 2 or self.strict:
                single = self._plain(factor)
                found *= single if exponent % 2 else abs(single)
        return found

    def _plain(self, p: PolyElement) -> int:
        """The sign of a polynomial that conditions or its terms give."""
        monic, lead = p.monic(), 1 if p.LC > 0 else -1
        if monic in self._given:
            return lead
        if -monic in self._given:
            return -lead
        for each in self._forms(p):
            if found := sign_of_sum(each, self.known, strict=self.strict):
                return found
        return 0

    def _forms(self, p: PolyElement) -> Sequence[PolyElement]:
        """A polynomial as it is, and with squares of cosines written by those of sines."""
        swapped = self.field.in_sines(p)
        return [p] if swapped == p else [p, swapped]
