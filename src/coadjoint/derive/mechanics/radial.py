r"""Legendre transforms of functions of one quadratic form, in closed form.

A function :math:`f(x) = \Phi(T) + b \cdot x` with :math:`T = \tfrac12 x \cdot K x` and
:math:`\Phi'(0) = 1` has :math:`y = \partial f/\partial x = \Phi'(T) K x + b`. With
:math:`w = K^{-1}(y - b)` that is :math:`w = \Phi'(T)\, x`, so that

.. math:: \Phi'(T)^2\, T = \tfrac12\, w \cdot K w

is one equation for the number T, and then :math:`x = w/\Phi'(T)`. It is solved where
:math:`\Phi'^2` is rational and the equation linear in T, as of a relativistic particle in a field,
:math:`f = -m c^2 \sqrt{1 - v^2/c^2} + q A \cdot v`. What comes out is put into y, so that it is a
solution whatever led to it.
Comes in: the slopes of f. Goes out: x in terms of y. Read next:
`coadjoint.derive.mechanics.configuration`, which asks where x and y are not linear in each other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import combinations

from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, apply, dot


def radial_solution(
    field: Field,
    slopes: Sequence[Element],
    names: Sequence[str],
    values: Sequence[Element],
    invert: Callable[[Matrix], Matrix],
) -> tuple[Element, ...] | None:
    """``x(y)`` from ``y = df/dx``; None where f is no function whose equation for T is linear.

    Args:
        field: Where everything lives.
        slopes: ``df/dx``.
        names: x, symbols.
        values: y.
        invert: Inverts K, or raises a DerivationError.

    >>> from coadjoint.exact.dense import inverse
    >>> field = Field(["v", "w", "m", "p", "r"], slots=2, positive=["m"])
    >>> v, w, m = (field[name] for name in "vwm")
    >>> slopes = field.gradient(-m * field.call("sqrt", 1 - v**2 - w**2), "vw")
    >>> x, _ = radial_solution(field, slopes, "vw", (field["p"], field["r"]), inverse)
    >>> field.to_sympy(x)
    p/(m*sqrt((m**2 + p**2 + r**2)/m**2))
    """
    rest = dict.fromkeys(names, field.zero)
    x = tuple(field[name] for name in names)
    with suppress(ZeroDivisionError, OverflowError, DerivationError):
        b = [field.substitute(slope, rest) for slope in slopes]
        K = tuple(
            tuple(field.substitute(entry, rest) for entry in field.gradient(slope, names))
            for slope in slopes
        )
        r, q = apply(K, x), [slope - at for slope, at in zip(slopes, b, strict=True)]
        pairs = combinations(range(len(names)), 2)
        if not all(field.is_zero(q[i] * r[j] - q[j] * r[i]) for i, j in pairs):
            return None
        w = apply(invert(K), [y - at for y, at in zip(values, b, strict=True)])
        place = next(i for i, row in enumerate(K) if row[i] != 0)
        others = {name: field.zero for i, name in enumerate(names) if i != place}
        along = field.substitute(q[place] / r[place], others)
        size = _slope_at(field, along**2, names[place], K[place][place], dot(w, apply(K, w)))
        if size is None:
            return None
        solution = tuple(each / size for each in w)
        back = dict(zip(names, solution, strict=True))
        defects = (field.substitute(s, back) - y for s, y in zip(slopes, values, strict=True))
        return solution if all(map(field.is_zero, defects)) else None
    return None


def _slope_at(
    field: Field, square: Element, name: str, k: Element, known: Element
) -> Element | None:
    """``Phi'(T)`` from ``Phi'^2 T``, if that is linear in T.

    Args:
        field: Where everything lives.
        square: ``Phi'(T)^2`` along one component, where ``T = k x^2/2``.
        name: x.
        k: Of T.
        known: ``2 Phi'^2 T``.
    """
    (quotient,) = field.quotients(field.normal(square).combine())
    below = field.one
    for divisor, exponent in quotient.divisors:
        below *= divisor**exponent
    above, below = (field.normal(each) for each in (square * below, below))
    try:
        left = field.coefficients(above * k * field[name] ** 2 - below * known, name)
        halves = [field.coefficients(each, name) for each in (above, below)]
    except ValueError:  # the component is left in a function
        return None
    if (
        2 not in left
        or not left.keys() <= {0, 2}
        or any(power % 2 for each in halves for power in each)
    ):
        return None
    root = -left.get(0, field.zero) / left[2]
    above, below = (field.sum(c * root ** (n // 2) for n, c in each.items()) for each in halves)
    return field.call("sqrt", above / below)
