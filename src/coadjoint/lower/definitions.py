"""Definitions: which of them a Program keeps, and which are written out before it is made.

Comes in: labelled elements of names. Goes out: the definitions that they need, and the elements,
over fewer names where that is cheaper.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.solver import forward_name, scaled_name
from coadjoint.exact import Element, Field

#: Names with their values: definitions or outputs.
Lines = list[tuple[str, Element]]


def inline_single_uses(
    equations: Equations, outputs: Lines, closed: frozenset[str] = frozenset()
) -> tuple[Lines, Lines]:
    """Definitions and outputs, intermediate products that are used once being substituted.

    ``_b1 = r*cos(phi)`` goes into ``vx = vtheta*_b1``, where ``r*vtheta`` may be shared. What the
    equations of a solve name stays, since the Jacobian asks for its derivative; so do factors.
    """
    field, solves = equations.setting.field, equations.exact.solves
    rows = [entry for solve in solves for row in (*solve.matrix, solve.known) for entry in row]
    columns = (make(i) for make in (forward_name, scaled_name) for s in solves for i in s.block)
    stays = equations.intermediates.difference(columns).union(*map(field.reach, rows))
    definitions = _definitions_of(equations, [element for _, element in outputs], closed)
    uses = Counter[str]()
    for _, element in (*definitions, *outputs):
        uses.update(_uses(field, element))
    put: dict[str, Element] = {}
    kept: Lines = []
    for name, element in definitions:
        value = field.substitute(element, put)
        single = uses[name] == 1 and name.startswith("_") and name not in stays
        if single and len(field.terms(value)) == 1 and not _has_sum_below(field, value):
            put[name] = value
        else:
            kept.append((name, value))
    return kept, [(label, field.substitute(element, put)) for label, element in outputs]


def _definitions_of(
    equations: Equations, elements: Iterable[Element], closed: frozenset[str]
) -> Lines:
    """Definitions that elements need, in an order in which they can be computed.

    Args:
        equations: Where they are defined.
        elements: What needs them.
        closed: Names that are written out, over state, inputs and parameters.
    """
    field, elements = equations.setting.field, list(elements)
    needed = set[str]().union(*map(field.reach, elements))
    kept: Lines = []
    for name, value in reversed(equations.definitions_of(elements)):
        if name in needed:
            written = equations.close(value) if name in closed else value
            kept.append((name, written))
            needed |= field.reach(written)
    return kept[::-1]


def _has_sum_below(field: Field, element: Element) -> bool:
    """Whether a denominator of an element has several terms."""
    divisors = (divisor for each in field.quotients(element) for divisor, _ in each.divisors)
    return any(len(field.terms(divisor)) > 1 for divisor in divisors)


def _uses(field: Field, element: Element) -> Counter[str]:
    """How often names are factors; what stands in a sum below or in a function counts twice."""
    uses = Counter[str]()
    for written in field.quotients(element):
        for monomial in written.monomials:
            uses.update(dict(monomial.powers))
        for divisor, power in written.divisors:
            in_sum = len(field.terms(divisor)) > 1
            uses.update(dict.fromkeys(field.reach(divisor), power + in_sum))
    for generator in field.functions_in(element):
        uses.update(dict.fromkeys(field.reach(field[generator]), 2))
    return uses


def shorten(equations: Equations, element: Element) -> Element:
    """An element with its definitions multiplied out where that leaves fewer terms in the state.

    ``Pi2*Omega3 - Pi3*Omega2`` becomes ``(1/I3 - 1/I2)*Pi2*Pi3``, whose coefficient depends on
    parameters alone: half the operations, and again what the book writes.
    """
    field, members = equations.setting.field, equations.moving
    try:
        closed = equations.close(element)
    except OverflowError:  # functions of other arguments, for which the field has no room
        return element

    def terms(of: Element) -> int:
        products = {
            tuple(p for p in monomial.powers if p[0] in members)
            for written in field.quotients(of)
            for monomial in written.monomials
        }
        return len(products)

    divisors = (divisor for written in field.quotients(closed) for divisor, _ in written.divisors)
    moving = any(field.reach(divisor) & members for divisor in divisors)
    return closed if terms(closed) < terms(element) and not moving else element
