"""Rates of a member in a form to compute with: by differences of neighbours, common factors out.

The exact field writes a squared distance as ``r^2 - 2*r*s + s^2``, in which digits cancel where
two members are close and far from the origin; here it is ``(r - s)^2`` again. Comes in: an
expression of the generic member. Goes out: an equal one.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy

#: Symbols of one component, that of member i first.
Group = Sequence[sympy.Symbol]


def tidy(value: sympy.Expr, groups: Sequence[Group]) -> sympy.Expr:
    """An equal expression in differences where that is possible, with common factors taken out.

    >>> r, s, m = sympy.symbols("r s m")
    >>> tidy(sympy.sqrt(r**2 - 2 * r * s + s**2 + m), [(r, s)])
    sqrt(m + (-r + s)**2)
    """
    if not value.args:
        return value
    if not (value.is_Add and value.is_polynomial(*value.free_symbols)):
        return value.func(*(tidy(each, groups) for each in value.args))
    steps = dict[sympy.Symbol, sympy.Expr]()
    for base, *others in groups:
        value = _by_differences(value, base, others, steps)
    value = value.xreplace(steps)
    own = [group[0] for group in groups if group[0] in value.free_symbols]
    return sympy.collect(sympy.factor_terms(value), own) if _is_plain(value) else value


def _is_plain(value: sympy.Expr) -> bool:
    """Whether a sum has products of symbols for its terms."""
    return not any(part.is_Add for term in value.args for part in sympy.preorder_traversal(term))


def _by_differences(
    value: sympy.Expr,
    base: sympy.Symbol,
    others: Group,
    steps: dict[sympy.Symbol, sympy.Expr],
) -> sympy.Expr:
    """A polynomial in differences from a symbol, if it is one; their symbols join the steps."""
    present = [each for each in others if each in value.free_symbols]
    if not present or base not in value.free_symbols:
        return value
    new = {each: sympy.Dummy(each.name) for each in present}
    moved = sympy.expand(value.xreplace({each: base + step for each, step in new.items()}))
    if base in moved.free_symbols:
        return value
    steps |= {step: each - base for each, step in new.items()}
    return moved
