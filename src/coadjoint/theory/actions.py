"""Motion in a group: translations, curves and invariant vector fields, by formal derivatives.

Comes in: generic elements of a `MatrixGroup` and the rates of their symbols along a curve. Goes
out: velocities in the algebra and time derivatives of whatever depends on the element, exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, product
from coadjoint.theory.group import MatrixGroup, Vector

#: The rate of each symbol that moves.
Rates = Mapping[str, Element]
#: A derivation of functions of matrix entries.
Derivation = Callable[[Any], Any]


def left_translation(g: Matrix) -> Callable[[Matrix], Matrix]:
    """``L_g h = g h`` (Holm 2011, section B.4.1)."""
    return lambda h: product(g, h)


def right_translation(g: Matrix) -> Callable[[Matrix], Matrix]:
    """``R_g h = h g``."""
    return lambda h: product(h, g)


def conjugation(group: MatrixGroup, g: Matrix) -> Callable[[Matrix], Matrix]:
    """``I_g h = g h g^-1``, left translation by g after right translation by its inverse."""
    return lambda h: group.AD(g, h)


def rate(field: Field, value: Element | int, rates: Rates) -> Element:
    """Time derivative along a curve: ``sum of d(value)/ds * s'`` over the symbols s.

    >>> field = Field(["x", "x_dot"])
    >>> rate(field, field["x"] ** 2, {"x": field["x_dot"]})
    2*x*x_dot
    """
    element, total = field.zero + value, field.zero
    for symbol in field.names:
        if symbol in rates:
            total += field.derivative(element, symbol) * rates[symbol]
    return total


def matrix_rate(group: MatrixGroup, g: Matrix, rates: Rates) -> Matrix:
    """``dg/dt`` entry by entry."""
    return tuple(tuple(rate(group.field, entry, rates) for entry in row) for row in g)


def element_rates(group: MatrixGroup, prefix: str, velocity: str) -> dict[str, Element]:
    """Free rates ``velocity_...`` for the symbols of the generic element ``prefix``."""
    return {f"{prefix}_{s}": group.field[f"{velocity}_{s}"] for s in group.symbols}


def body_velocity(group: MatrixGroup, g: Matrix, g_dot: Matrix) -> Vector:
    """``xi = g^-1 dg/dt``, the left-invariant velocity.

    Raises:
        AlgebraError: The product is not in the algebra, so ``g_dot`` is not tangent to the group.
    """
    return group.coordinates(product(group.inverse(g), g_dot))


def space_velocity(group: MatrixGroup, g: Matrix, g_dot: Matrix) -> Vector:
    """``xi = dg/dt g^-1``, the right-invariant velocity.

    Raises:
        AlgebraError: The product is not in the algebra, so ``g_dot`` is not tangent to the group.
    """
    return group.coordinates(product(g_dot, group.inverse(g)))


def coadjoint_motion_defect(
    group: MatrixGroup, g: Matrix, g_dot: Matrix, mu: Vector, mu_dot: Vector, rates: Rates
) -> Vector:
    """``d/dt Ad*_(g^-1) mu - Ad*_(g^-1)(mu' - ad*_xi mu)`` with ``xi = g^-1 dg/dt``.

    It is zero (Holm 2011, Proposition 4.2.2), so ``mu' = ad*_xi mu`` moves on a coadjoint orbit.

    Args:
        group: The group.
        g: An element that depends on the symbols in `rates`.
        g_dot: Its time derivative.
        mu: A covector in symbols of the field.
        mu_dot: Its rate.
        rates: The rates of the symbols of g and mu.
    """
    inverse, xi = group.inverse(g), body_velocity(group, g, g_dot)
    left = [rate(group.field, m, rates) for m in group.Ad_star(inverse, mu)]
    change = tuple(a - b for a, b in zip(mu_dot, group.ad_star(xi, mu), strict=True))
    right = group.Ad_star(inverse, change)
    return tuple(a - b for a, b in zip(left, right, strict=True))


def left_invariant_field(group: MatrixGroup, xi: Vector) -> Callable[[Matrix], Matrix]:
    """``X_xi(g) = g xi`` (Holm 2011, section B.5)."""
    return right_translation(group.matrix(xi))


def right_invariant_field(group: MatrixGroup, xi: Vector) -> Callable[[Matrix], Matrix]:
    """``X_xi(g) = xi g``."""
    return left_translation(group.matrix(xi))


def derivation(field: Field, x: Matrix, x_dot: Matrix) -> Derivation:
    """The operator ``f -> sum of x_dot_ij df/dx_ij`` of a vector field on matrices.

    Args:
        field: Where f lives.
        x: A matrix whose entries are symbols of the field.
        x_dot: The vector field at x.
    """
    rates = {
        str(symbol): field.zero + speed
        for symbols, speeds in zip(x, x_dot, strict=True)
        for symbol, speed in zip(symbols, speeds, strict=True)
    }
    return lambda f: rate(field, f, rates)
