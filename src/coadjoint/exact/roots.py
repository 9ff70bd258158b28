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
        if field.adjoined[name].function == "sqrt":
            short = _lift(field, short, name)
    return min(element, short, key=lambda each: _size(field, each))


def _lift(field: Field, element: Element, name: str) -> Element:
    """An element with one root: each of its powers is raised by two as long as that is shorter."""
    square = field.adjoined[name].argument
    try:
        parts = field.coefficients(element, name)
    except ValueError:  # the root stands in a sum in a denominator
        return element
    raised = []
    for power, whole in parts.items():
        while power < 0:
            shorter = field.normal(whole / square)
            if _size(field, shorter) >= _size(field, whole):
                break
            power, whole = power + 2, shorter
        raised.append(whole * field[name] ** power)
    return field.sum(raised)


def _size(field: Field, element: Element) -> int:
    """The number of terms in numerators."""
    return sum(len(quotient.monomials) for quotient in field.quotients(element))
