r"""The velocity on the circle at points of a grid, from the momentum: :math:`A u = m`.

A has the differences :math:`D_{2k}` in the place of derivatives, so that its matrix is circulant
and symmetric,

.. math:: \sum_r a_r u_{i+r} = m_i, \qquad a_{-r} = a_r ,

and half the sum of m u over the points has the gradient u by m: the energy of a grid and its
equation for u belong together. An A that takes constants to 0 is a product with :math:`2 - E -
E^{-1}`, E being the shift to the next point, and its inverse is that on the fields with the mean 0.
Comes in: a Setting with such an operator. Goes out: the equation for loops, and the solution in a
ring of a few points. Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import product
from typing import Any

import sympy

from coadjoint.derive.fields import circle
from coadjoint.derive.fields.jets import solved
from coadjoint.derive.fields.stencils import stencil
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import inverse as inverse_of
from coadjoint.families import Solved


def find_factors(
    setting: Setting,
    order: int,
    inverse: Any,
    number: Callable[[Fraction], Any],
    value: Callable[[Element], Any],
) -> dict[int, Any]:
    """The factors a_r in an arithmetic; of an A that takes constants to 0, of its other factor.

    Args:
        setting: The spec and its field.
        order: Of the differences.
        inverse: One over the spacing.
        number: How the arithmetic makes numbers.
        value: What an element of parameters is in it.
    """
    found: dict[int, Any] = {}
    level = is_level(setting)
    for derivative, factor in circle.inertia_along(setting).items():
        known = stencil(derivative, order)
        for r, c in (_divide(known) if level else known).items():
            part = value(factor) * number(c) * inverse**derivative
            found[r] = found[r] + part if r in found else part
    return dict(sorted(found.items()))


def is_level(setting: Setting) -> bool:
    """Whether A takes constants to 0."""
    operator = circle.inertia_along(setting)
    return bool(operator) and 0 not in operator


def _divide(factors: Mapping[int, Fraction]) -> dict[int, Fraction]:
    """The b with ``sum a_r E^r = (2 - E - E^-1) sum b_r E^r``, of a symmetric a with the sum 0.

    >>> {r: str(b) for r, b in _divide(stencil(2, 4)).items()}
    {-1: '1/12', 0: '-7/6', 1: '1/12'}
    """
    width, zero = max(factors), Fraction(0)
    b = dict.fromkeys(range(width + 2), zero)
    for r in range(width, 0, -1):
        b[r - 1] = 2 * b[r] - b[r + 1] - factors.get(r, zero)
    assert factors.get(0, zero) == 2 * (b[0] - b[1]), "a sum that is not 0"
    return {r: b[abs(r)] for r in range(-width + 1, width)}


def write_solved(setting: Setting, order: int, inverse: sympy.Expr) -> tuple[Solved, ...]:
    """The equation as loops are made of it; nothing without one."""

    def number(value: Fraction) -> sympy.Rational:
        return sympy.Rational(value.numerator, value.denominator)

    factors = find_factors(setting, order, inverse, number, setting.field.to_sympy)
    every = tuple(a for r, a in factors.items() if r >= 0)
    pairs, level = zip(solved(setting.spec), setting.state, strict=False), is_level(setting)
    return tuple(Solved(sympy.Symbol(u), sympy.Symbol(m), every, level) for u, m in pairs)


def multiply_out(factors: Mapping[int, Any]) -> dict[int, Any]:
    """The factors of A by those of its other factor than ``2 - E - E^-1``."""
    found: dict[int, Any] = {}
    for r, b in factors.items():
        for place, value in ((r, b * 2), (r - 1, -b), (r + 1, -b)):
            found[place] = found[place] + value if place in found else value
    return found


def solve_ring(
    factors: dict[int, Element], field: Field, momenta: list[Element], *, level: bool
) -> list[Element]:
    """The velocities of a ring in its momenta: the inverse is circulant and symmetric, too.

    A level one is that of A and the mean, without the mean.
    """
    size = len(momenta)
    half = range(size // 2 + 1)  # of a symmetric column
    mean = field.number(Fraction(level, size))
    row = [mean] * size
    for r, a in (multiply_out(factors) if level else factors).items():
        row[r % size] += a
    folded = [[field.zero for _ in half] for _ in half]
    for i, j in product(half, range(size)):
        folded[i][min(j, size - j)] += row[(j - i) % size]
    column = [each[0] - mean for each in inverse_of(tuple(map(tuple, folded)))]
    return [
        field.sum(column[min(r, size - r)] * momenta[i - r] for r in range(size))
        for i in range(size)
    ]
