r"""The velocity on the circle at points of a grid, from the momentum: :math:`A u = m`.

A has the differences :math:`D_{2k}` in the place of derivatives, so that its matrix is circulant
and symmetric,

.. math:: \sum_r a_r u_{i+r} = m_i, \qquad a_{-r} = a_r ,

and half the sum of m u over the points has the gradient u by m: the energy of a grid and its
equation for u belong together.
Comes in: a Setting with such an operator. Goes out: the equation for loops, and the solution in a
ring of a few points. Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Callable
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
    """The factors a_r in an arithmetic.

    Args:
        setting: The spec and its field.
        order: Of the differences.
        inverse: One over the spacing.
        number: How the arithmetic makes numbers.
        value: What an element of parameters is in it.
    """
    found = dict[int, Any]()
    for derivative, factor in circle.inertia(setting).items():
        for r, c in stencil(derivative, order).items():
            part = value(factor) * number(c) * inverse**derivative
            found[r] = found[r] + part if r in found else part
    return dict(sorted(found.items()))


def write_solved(setting: Setting, order: int, inverse: sympy.Expr) -> tuple[Solved, ...]:
    """The equation as loops are made of it; nothing without one."""

    def number(value: Fraction) -> sympy.Rational:
        return sympy.Rational(value.numerator, value.denominator)

    factors = find_factors(setting, order, inverse, number, setting.field.to_sympy)
    every = tuple(a for r, a in factors.items() if r >= 0)
    pairs = zip(solved(setting.spec), setting.state, strict=False)
    return tuple(Solved(sympy.Symbol(u), sympy.Symbol(m), every) for u, m in pairs)


def solve_ring(factors: dict[int, Element], field: Field, momenta: list[Element]) -> list[Element]:
    """The velocities of a ring in its momenta: the inverse is circulant and symmetric, too."""
    size = len(momenta)
    half = range(size // 2 + 1)  # of a symmetric column
    row = [field.zero] * size
    for r, a in factors.items():
        row[r % size] += a
    folded = [[field.zero for _ in half] for _ in half]
    for i, j in product(half, range(size)):
        folded[i][min(j, size - j)] += row[(j - i) % size]
    column = [each[0] for each in inverse_of(tuple(map(tuple, folded)))]
    return [
        field.sum(column[min(r, size - r)] * momenta[i - r] for r in range(size))
        for i in range(size)
    ]
