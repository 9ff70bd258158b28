r"""Fluxes: whether fields conserve the integrals of densities.

A density f is conserved if its rate is a total derivative, :math:`\partial_t f + \partial_s F = 0`,
which the variational derivative of the rate decides, and its value for fields that do not depend on
space, since a constant has no variation either. Some are conserved only where the advected
quantities of a strand turn along it, :math:`\partial_s a = -\rho(\Xi) a`, as the momentum along it
is: its rate is a total derivative and :math:`-\langle l_a, \partial_s a + \rho(\Xi) a \rangle`.
Derivatives of a are left out by this equation; it takes what is left from the highest derivative
downwards. That has to be linear in the highest ones, :math:`\sum A_i u_i^{(n)}` with a gradient A
by :math:`u^{(n-1)}`; what has no derivatives is a multiple of that of the energy of a alone, or 0.
Comes in: Equations of fields, and densities. Goes out: decisions, with the fluxes.
Read next: `coadjoint.prove.fields`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from coadjoint.derive import Equations
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.jets import DEGREE, Jets, jets_of, solved
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.witness import is_entire
from coadjoint.prove.certificate import Shown, Verdict
from coadjoint.prove.strands import list_turning, tell_turn, turn_along
from coadjoint.prove.zero import Decision, decide_zero
from coadjoint.spec import Formula

#: Characters of a flux that a certificate shows.
SHOWN = 400


def decide_law(
    equations: Equations, parts: Sequence[Element], formula: Formula | None = None
) -> tuple[Decision, str]:
    """Whether the integrals of densities are conserved, and where.

    That is everywhere, or only where the advected quantities of a strand turn along it.

    Args:
        equations: Of fields.
        parts: The components of the density.
        formula: Where the density is declared; by default it is that of the energy.

    Returns:
        The decision, and " where da/ds = -Xi a", or "".

    Raises:
        DerivationError: The integral of the density has no variation that is a field.
    """
    decision = decide_density(equations, parts, formula)
    turning = list_turning(equations)
    if decision.verdict is Verdict.PROVED or not turning:
        return decision, ""
    texts = list[str]()
    for part in parts:
        flux = _integrate_along(equations, part)
        if flux is None:
            return decision, ""
        texts.append(_tell_flux(equations, [flux]))
    told = [tell_turn(equations, each) for each in turning]
    method = f"its rate + d/ds flux = 0, with {'; '.join(texts)}, where derivatives of "
    method += f"{' and '.join(each.name for each in turning)} are left out by this"
    return Decision(verdict=Verdict.PROVED, method=method), f" where {' and '.join(told)}"


def decide_density(
    equations: Equations, parts: Sequence[Element], formula: Formula | None = None
) -> Decision:
    """Whether the rates of densities are total derivatives; arguments as of `decide_law`."""
    setting, every = equations.setting, jets_of(equations.setting)
    rates = dict(zip(setting.state, equations.exact.rates, strict=True))
    texts, moved = list[str](), solved(setting.spec)
    for part in parts:
        rate, jets = _find_rate(equations, part, rates, formula), every
        if moved and any(every.variation(rate).values()):  # then both fields as those of one
            rate, jets = circle.close(setting, rate), every.only(moved)
        decision = decide_zero([*jets.variation(rate).values()], setting.field)
        if decision.verdict is not Verdict.PROVED:
            method = f"{decision.method} of the variational derivative of its rate"
            return replace(decision, method=method, shown=Shown.VARIATION)
        fluxes = jets.integrate(-rate)
        if fluxes is None:
            decision = _decide_still(jets, rate)
            if decision.verdict is not Verdict.PROVED:
                return decision
            texts.append(
                "a flux, since the Euler operator takes its rate to 0, and it is 0 for fields that "
                "do not depend on space"
            )
            continue
        assert setting.field.is_zero(jets.diverge(fluxes) + rate), equations.spec.name
        texts.append(_tell_flux(equations, fluxes))
    slope = "div" if setting.spec.in_plane else "d/ds"
    law = f"its rate + {slope} flux = 0"
    return Decision(verdict=Verdict.PROVED, method=f"{law}, with {'; '.join(texts)}")


def _decide_still(jets: Jets, rate: Element) -> Decision:
    """Whether a rate without variation is 0 for fields that do not depend on space.

    That tells a total derivative from a constant, which has no variation either. The integral is
    the same for fields that can be deformed into one another where the rate is finite: into one
    that does not depend on space, as intervals bound each symbol; but u and v may wind about the
    zero of u^2 + v^2, and the integral of the derivative of their angle counts how often.
    """
    field = jets.field
    if any(len(field.reach(x) & jets.places.keys()) > 1 for x in _list_bounds(field, rate)):
        method = (
            "the Euler operator takes its rate to 0, and fields may wind about where it has no "
            "value, so that its integral may count how often"
        )
        return Decision(verdict=Verdict.SUPPORTED, method=method)
    try:
        decision = decide_zero([jets.still(rate)], field)
    except ZeroDivisionError:
        method = (
            "the Euler operator takes its rate to 0, and it has no value for fields that do not "
            "depend on space, which would tell it from a constant"
        )
        return Decision(verdict=Verdict.SUPPORTED, method=method)
    method = f"{decision.method} of its rate for fields that do not depend on space"
    return replace(decision, method=method)


def _list_bounds(field: Field, element: Element) -> list[Element]:
    """What stands below lines, and in functions where these are not analytic everywhere."""
    below = [x for quotient in field.quotients(element) for x, _ in quotient.divisors]
    if is_entire(field, [element]):
        return below
    return below + [x for g in field.functions_in(element) for x in field.adjoined[g].arguments]


def _find_rate(
    equations: Equations, part: Element, rates: Mapping[str, Element], formula: Formula | None
) -> Element:
    """The rate of a density, or one with the same integral where A u = m."""
    setting, jets = equations.setting, jets_of(equations.setting)
    if not solved(setting.spec):
        return jets.rate(part, rates)
    return setting.field.sum(
        circle.vary(setting, part, name, formula) * rate for name, rate in rates.items()
    )


def _tell_flux(equations: Equations, fluxes: Sequence[Element]) -> str:
    """A flux as certificates show it."""
    field = equations.setting.field
    text = ", ".join(element_text(field, flux) for flux in fluxes)
    text = f"({text})" if equations.spec.in_plane else text
    count = sum(len(field.terms(flux)) for flux in fluxes)
    return f"the flux {text}" if len(text) <= SHOWN else f"a flux of {count} terms"


def _integrate_along(equations: Equations, density: Element) -> Element | None:
    """The flux of a density where advected quantities turn along the strand; None if not found."""
    setting, jets = equations.setting, jets_of(equations.setting)
    field, turn = setting.field, turn_along(equations)
    rates = dict(zip(setting.state, equations.exact.rates, strict=True))
    turned = {name for each in list_turning(equations) for name in each.components}
    others = jets.only([name for name in jets.rows if name not in turned])
    rate = turn(jets.rate(density, rates))
    rest, flux = -rate, field.zero
    top = max((others.orders[x][1] for x in field.reach(rest) & others.orders.keys()), default=0)
    for order in range(top, 0, -1):
        part = _integrate_highest(others, rest, order)
        if part is None:
            return None
        rest, flux = rest - turn(jets.total(part)), flux + part
        if any(others.orders[x][1] >= order for x in field.reach(rest) & others.orders.keys()):
            return None  # no gradient
    assert equations.exact.energy is not None, equations.spec.name
    alone = field.sum(
        term
        for term in field.terms(equations.exact.energy)
        if not field.reach(term) & others.orders.keys()
    )
    moved = turn(jets.total(alone))
    if not field.is_zero(rest):
        if field.is_zero(moved) or field.reach(rest / moved) & jets.places.keys():
            return None
        flux += rest / moved * alone
    assert field.is_zero(turn(jets.total(flux)) + rate), equations.spec.name
    return flux


def _integrate_highest(jets: Jets, element: Element, order: int) -> Element | None:
    """``P`` of one order less with ``D P`` equal to the highest derivatives of an element.

    None where it is not linear in these, or P is no sum of homogeneous functions.
    """
    field, highest = jets.field, {tower[order]: tower[order - 1] for tower in jets.towers.values()}
    slopes = {below: field.derivative(element, top) for top, below in highest.items()}
    if any(field.reach(slope) & highest.keys() for slope in slopes.values()):
        return None
    scaled = field.sum(
        field[below] * field.substitute(slope, {x: field[DEGREE] * field[x] for x in slopes})
        for below, slope in slopes.items()
    )
    try:
        parts = field.coefficients(scaled, DEGREE)
    except ValueError:
        return None
    return field.sum(part * Fraction(1, n + 1) for n, part in parts.items())
