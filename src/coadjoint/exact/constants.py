"""Algebraic numbers among the functions of a field: all of them in one number field.

Comes in: functions of numbers, as ``sqrt(3 + 2*sqrt(2))``, ``cos(2*pi/5)`` and ``2^(1/3)``, which
is ``exp(log(2)/3)``. Goes out: each as a polynomial in one real number, so that every relation
between them is one of polynomials. Roots of rational numbers alone need no such field:
`coadjoint.exact.products` relates any number of them.
Read next: `coadjoint.exact.relations`, which rewrites functions so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import sympy
from sympy.polys.numberfields.minpoly import minimal_polynomial

from coadjoint.elementary import Arithmetic
from coadjoint.exact.element import Element
from coadjoint.exact.field import Adjoined, Field
from coadjoint.exact.numbers import NumberError, Numbers, Written

#: Degree of the largest field; one of degree 12 takes two seconds to find, of degree 16 six.
LARGEST_DEGREE = 12


def algebraic_functions(field: Field, called: Iterable[Adjoined]) -> list[Adjoined]:
    """The functions that are roots and powers of algebraic numbers, in their order."""
    chosen: dict[str, Adjoined] = {}
    cosines = _cosines(field)
    for each in called:
        if each.function == "sqrt":
            inner: Iterable[Element] = [each.argument]
        elif each.function == "exp" and (bases := _logarithms(field, each.argument)):
            inner = bases
        else:
            continue
        if all(field.names_in(part) <= chosen.keys() | cosines for part in inner):
            chosen[each.generator] = each
    return list(chosen.values())


def _cosines(field: Field) -> set[str]:
    """Generators of sines and cosines of rational multiples of pi."""
    from coadjoint.exact.values import half_turns  # which needs fields

    return {
        name
        for name, known in field.adjoined.items()
        if known.function in ("sin", "cos") and half_turns(field, known.argument) is not None
    }


def _logarithms(field: Field, exponent: Element) -> list[Element]:
    """What an exponent is a sum of rational multiples of logarithms of; empty for another one."""
    names = field.names_in(exponent)
    logarithms = [field.adjoined[name] for name in names & field.adjoined.keys()]
    if len(logarithms) < len(names) or any(known.function != "log" for known in logarithms):
        return []
    slopes = [field.as_number(field.slope(exponent, known.generator)) for known in logarithms]
    rest = exponent - field.sum(
        field[known.generator] * slope
        for known, slope in zip(logarithms, slopes, strict=True)
        if slope is not None
    )
    return [known.argument for known in logarithms] if None not in slopes and rest == 0 else []


@dataclass(frozen=True)
class Constants:
    """Algebraic functions of numbers, and a cosine, as polynomials in one number.

    Attributes:
        roots: Generators of roots and powers.
        numbers: The field that has them; the cosine stands behind the roots.
    """

    roots: tuple[str, ...]
    numbers: Numbers

    def powers_of(self, place: int) -> Mapping[int, Fraction]:
        """Coefficients of the powers of the number in what stands in a place."""
        number, _ = self.numbers.index(place)
        return self.numbers.powers(number)


def find_constants(field: Field, called: Sequence[Adjoined], parts: int) -> Constants | None:
    """The algebraic numbers among some functions; None where other relations have them all.

    Args:
        field: Where the functions live.
        called: The functions.
        parts: Of a half turn, whose cosine occurs; 0 for none.
    """
    roots = algebraic_functions(field, called)
    simple = all(known.function == "sqrt" and not field.names_in(known.argument) for known in roots)
    if not roots or (simple and not parts):
        return None
    elements = [field[known.generator] for known in roots]
    written = [Written(str(each), partial(_value, field, each)) for each in elements]
    if parts:
        written.append(Written(f"cos(pi/{parts})", partial(_cosine_of_part, parts)))
    key = tuple(each.text for each in written)
    if key not in field.constants:
        field.constants[key] = _find_field(written)
    numbers = field.constants[key]
    return None if numbers is None else Constants(key[: len(roots)], numbers)


def _find_field(written: Sequence[Written]) -> Numbers | None:
    """The number field of some numbers; None where it is too large or SymPy finds none."""
    try:
        return Numbers(written, LARGEST_DEGREE)
    except (OverflowError, NumberError):  # then each is what it is by itself
        return None


def minimal_of_cosine(parts: int) -> list[Fraction]:
    """The minimal polynomial of the cosine of a part of a half turn, the highest power first."""
    cosine = sympy.cos(sympy.pi / parts)
    minimal = minimal_polynomial(cosine, sympy.Symbol("x"), polys=True).monic()
    return [Fraction(int(c.p), int(c.q)) for c in minimal.all_coeffs()]


def _value(field: Field, element: Element, own: Arithmetic) -> Any:
    """A number of a field in any arithmetic."""
    return field.evaluate(element, {}, own.number, own.call)


def _cosine_of_part(parts: int, own: Arithmetic) -> Any:
    """The cosine of a part of a half turn in any arithmetic."""
    turn = own.multiply(own.number(Fraction(4, parts)), own.call("atan", own.number(Fraction(1))))
    return own.call("cos", turn)
