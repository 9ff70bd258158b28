r"""Sums over the points of a grid: which of them differences keep, decided at the generic point.

Comes in: a `GenericPoint`. Goes out: what vanishes where a sum is kept, and why another is not.
Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.jets import solved
from coadjoint.derive.fields.lattice import LatticeField, name_at
from coadjoint.exact import Element

# -- all derivatives that sum by parts ----------------------------------------------------------


def find_bracket_defects(point: GenericPoint) -> list[Element]:
    """What vanishes if the bracket is antisymmetric for all derivatives that sum by parts.

    Of a matrix D_k with the transpose (-1)^k D_k a term ``f D_k g`` is, at the points i and j,
    f(i) g(j) times its entry there: so is the term that is minus its adjoint.
    """
    _, place = point.place_exactly()
    found: dict[tuple[int, int, int], list[Element]] = {}
    for i, entries in enumerate(point.operator):
        for j, entry in enumerate(entries):
            for term in entry:
                left, right = place(term.left), place(term.right)
                other, sign = min(term.order, 1), (-1) ** term.order  # D_0 is the identity
                found.setdefault((i, j, term.order), []).append(left(0) * right(other))
                found.setdefault((j, i, term.order), []).append(left(other) * right(0) * sign)
    return [point.lattice.field.sum(parts) for parts in found.values()]


def find_sum_defects(point: GenericPoint, components: Iterable[str]) -> list[Element] | None:
    """What vanishes if sums of densities are kept with all derivatives that sum by parts.

    The rate of such a sum is that of terms ``f(i) D_k[i, j] g(j)``, with a matrix that has the
    transpose (-1)^k D_k and takes constants to 0. So it is 0 where the sum of ``f(i) g(j)`` and
    (-1)^k times the same with i and j exchanged is one of functions of i and of j.

    Returns:
        None where densities or the energy have derivatives, or a velocity is solved for.
    """
    state, field, lattice = point.setting.state, point.setting.field, point.lattice.field
    values = [point.densities[name] for name in components]
    named = frozenset[str]().union(*map(field.reach, values)) & point.jets.orders.keys()
    has_derivatives = not named <= {*state} or any(len(own) > 1 for own in point.slopes)
    if solved(point.spec) or has_derivatives:
        return None
    _, place = point.place_exactly()
    slopes = [own[0] if own else field.zero for own in point.slopes]
    defects = list[Element]()
    for value in values:
        forms = dict[int, list[Element]]()
        for a, entries in zip(state, point.operator, strict=True):
            slope = field.derivative(value, a)
            for entry, other in zip(entries, slopes, strict=True):
                for t in entry:
                    f, g = place(slope * t.left), place(t.right * other)
                    near, sign = min(t.order, 1), (-1) ** t.order
                    both = f(0) * g(near) + f(near) * g(0) * sign
                    forms.setdefault(t.order, []).append(both)
        for order, parts in forms.items():
            whole = lattice.sum(parts)
            here, there = ([name_at(c, n) for c in state] for n in (0, 1))
            slopes_here = lattice.gradient(whole, here if order else ())
            mixed = [x for each in slopes_here for x in lattice.gradient(each, there)]
            defects += mixed if order else [whole]
    return defects


# -- central differences ------------------------------------------------------------------------


def explain_change(point: GenericPoint, name: str) -> str:
    """Why the sum of an observable over the points is not said to be kept exactly.

    Returns:
        Empty where it is kept: the variation of its rate is 0, and so is its rate at equal fields.
    """
    if point.space.has_ends:
        return "" if name == "energy" else "it flows through the ends"
    (each,) = (x for x in point.equations.exact.emitted if x.name == name)
    field, lattice = point.setting.field, _lattice_of_rates(point)
    if solved(point.spec) and any(map(field.functions_in, each.values)):
        return "its rate has functions of all velocities, and was not examined"
    rates = [_rate_of_sum(point, component) for component in each.components]
    if not all(lattice.field.is_zero(x) for rate in rates for x in lattice.vary(rate).values()):
        return "the variation of its rate over the points is not 0"
    try:
        is_kept = all(lattice.field.is_zero(lattice.still(rate)) for rate in rates)
    except ZeroDivisionError:
        return "its rate has no value at equal fields, which would tell it from a constant"
    return "" if is_kept else "its rate is not 0 at equal fields"


def _lattice_of_rates(point: GenericPoint) -> LatticeField:
    """In which the rates of sums are: where A u = m, all is a function of the velocities."""
    return replace(point.lattice, components=solved(point.spec) or point.lattice.components)


def _rate_of_sum(point: GenericPoint, component: str) -> Element:
    """What has the sum of the rates of a density as its sum over all points."""
    rates, densities = point.exact_point
    lattice, field = point.lattice, point.lattice.field
    if point.momenta:
        return _rate_by_velocities(point, component)
    density, parts = densities[component], list[Element]()
    for name, rate in zip(point.setting.state, rates, strict=True):
        for r in range(-point.reach, point.reach + 1):
            slope = field.derivative(density, name_at(name, r))
            if slope:
                parts.append(slope * lattice.shift(rate, r))
    return field.sum(parts)


def _rate_by_velocities(point: GenericPoint, component: str) -> Element:
    """The same where A u = m."""
    calculus, place = point.place_exactly()
    field, parts = point.lattice.field, list[Element]()
    rates, _ = point.exact_point
    for name, rate in zip(point.setting.state, rates, strict=True):
        slopes = point.find_slopes(point.densities[component], name)
        parts.append(calculus.vary([place(x) for x in slopes])(0) * rate)
    whole = field.sum(parts)
    for m, value in point.momenta.items():
        known = {
            name_at(m, r): point.lattice.shift(value, r)
            for r in range(-point.lattice.reach, point.lattice.reach + 1)
            if name_at(m, r) in field.reach(whole)
        }
        whole = field.substitute(whole, known)
    return whole
