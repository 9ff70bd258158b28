"""Square roots in denominators, with what they are roots of above them.

Comes in: elements as derivatives leave them. Goes out: the same with fewer terms. The height of a
spheroid is ``(a^2*(1 - z^2) + c^2*z^2)/h``, which is h; its slope is over the third power of h.
Read next: `coadjoint.derive.routes.nonholonomic`, whose forces are such slopes.
"""

from __future__ import annotations

from coadjoint.exact.element import Element
from coadjoint.exact.field import Field


def simplify_roots(field: Field, element: Element) -> Element:
    """An element with ``u/sqrt(u)^k`` written as ``1/sqrt(u)^(k - 2)``, if that has fewer terms.

    >>> field = Field(["x", "y"], slots=1)
    >>> x, y = field["x"], field["y"]
    >>> h = field.call("sqrt", x**2 + y)
    >>> field.terms(simplify_roots(field, y * (x**2 + y) / h**3))
    (y/_f1,)
    """
    short = field.normal(element)
    for name in sorted(field.functions_in(element)):
        known = field.adjoined[name]
        while known.function == "sqrt":
            shorter = short * field[name] ** 2 / known.argument
            if _size(field, shorter) >= _size(field, short):
                break
            short = shorter
    return min(element, short, key=lambda each: _size(field, each))


def _size(field: Field, element: Element) -> int:
    """The number of terms in numerators."""
    return sum(len(quotient.monomials) for quotient in field.quotients(element))
