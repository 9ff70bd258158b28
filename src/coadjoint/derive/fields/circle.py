r"""Diffeomorphisms of the circle: their Euler-Poincare equation, from the variation of a velocity.

The velocity :math:`u = \dot g \circ g^{-1}` of a motion g of the circle varies by
:math:`\delta u = \eta_t + u \eta_s - u_s \eta`, with :math:`\eta = \delta g \circ g^{-1}`. So the
integral of :math:`\langle m, \delta u \rangle`, :math:`m = \partial l/\partial u`, is stationary if

.. math:: m_t = E_\eta (m (u \eta_s - u_s \eta) + c\, \eta_s u_{ss})
    = -(u m_s + 2 u_s m) - c\, u_{sss},

with the Euler operator by eta, and the cocycle of Virasoro's algebra for a central charge c
(Khesin and Wendt 2009, The Geometry of Infinite-Dimensional Groups, section II.2).
A Lagrangian with derivatives, :math:`l = \tfrac12 \sum a_k (\partial_s^k u)^2`, makes m a
differential operator of u, :math:`m = A u` with :math:`A = \sum (-1)^k a_k \partial_s^{2k}`. Then
both are symbols with their derivatives, and equations hold as polynomials in these. Where a law
needs the equation between them, m is replaced by A u. Without the square of u itself, as in Hunter
and Saxton's equation, A takes constants to 0: m has the mean 0 and says nothing of the mean of u,
which is 0 here. Another mean is the same motion seen by someone who goes around the circle.
Comes in: a Setting with a Lagrangian. Goes out: Equations in jets of m, and of u with such an A.
Read next: `coadjoint.derive.fields.structure`, where the bracket is.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.emission import emit_fields
from coadjoint.derive.fields.jets import Jets, depth, jets_of, solved
from coadjoint.derive.fields.structure import central_charge
from coadjoint.derive.records import write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.exact import Element
from coadjoint.spec import Spec
from coadjoint.spec.sections.space import jet_name

#: The variation of the motion, whose derivatives are symbols like those of a field.
VARIED = "_eta"


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the variation and its derivatives."""
    if spec.diffeomorphisms is None or spec.space is None:
        return ()
    return tuple(jet_name(VARIED, spec.space.name, n) for n in range(depth(spec) + 1))


def euler_poincare(setting: Setting, route: str) -> Equations:
    """The Euler-Poincare equation on the circle.

    Raises:
        DerivationError: The velocity is no function of the momentum at each point.
    """
    u, (m,) = velocity(setting), setting.elements(setting.state)
    jets = jets_of(setting)
    varied = symbols(setting.spec)
    eta, eta_s = setting.elements(varied[:2])
    charge = central_charge(setting)
    integrand = m * (u * eta_s - jets.total(u) * eta) + charge * eta_s * jets.total(u, 2)
    both = Jets(setting.field, {**jets.towers, VARIED: varied})
    rate = both.euler(integrand, VARIED)
    steps = (
        write_step("Lagrangian", "l(u)", "l(u)", {"l": setting.lagrangian}),
        write_step(
            "Momentum",
            "m = dl/du",
            r"m = \partial l / \partial u",
            write_slopes("l", [_name(setting)], [_slope(setting)]),
        ),
        write_step(
            "Variation: delta u = eta_t + u eta_s - u_s eta, integrated by parts",
            "dm/dt = E_eta(m (u eta_s - u_s eta) + c eta_s u_ss)",
            r"\dot m = E_\eta (m (u \eta_s - u_s \eta) + c\, \eta_s u_{ss})",
            write_rates(setting.state, [rate]),
        ),
    )
    return emit_fields(setting, route, [rate], steps, energy(setting))


def _name(setting: Setting) -> str:
    """The name of the velocity."""
    (velocity,) = setting.spec.having_role("velocity")
    return velocity.name


def _slope(setting: Setting) -> Element:
    """``dl/du``, with all derivatives of u."""
    if not solved(setting.spec):
        return setting.field.derivative(setting.lagrangian, _name(setting))
    return jets_of(setting).euler(setting.lagrangian, _name(setting))


@once
def inertia(setting: Setting) -> Mapping[int, Element]:
    """The coefficients of ``d^k/ds^k`` in the operator A with m = A u; empty without derivatives.

    That of u itself may be missing.

    Raises:
        DerivationError: The Lagrangian is no sum of squares with constant positive factors.
    """
    if not solved(setting.spec):
        return {}
    field, formula, name = setting.field, setting.spec.lagrangian, _name(setting)
    assert formula is not None, "the reader asks for a Lagrangian on this route"
    jets, slope = jets_of(setting), _slope(setting)
    found = {n: x for n, x in enumerate(jets.slopes(slope, name)) if not field.is_zero(x)}
    jet_names = {*jets.orders}
    is_linear = not any(field.reach(x) & jet_names for x in found.values())
    whole = field.sum(x * field[jets.towers[name][n]] for n, x in found.items())
    if not is_linear or not field.is_zero(slope - whole):
        message = (
            f"the momentum dl/d{name} is no linear operator of {name} with constant factors; "
            f"expected a sum of squares of {name} and its derivatives."
        )
        raise fault(setting, formula, message, formula.text)
    for n, x in found.items():
        at = field.evaluate(x, field.region.defaults, Fraction) * (-1) ** (n // 2)
        if at <= 0:
            square = jets.towers[name][n // 2]
            message = (
                f"the factor of {square}^2 is {at / 2} at the defaults of the parameters; expected "
                f"a positive one, so that the momentum determines {name}."
            )
            raise fault(setting, formula, message, formula.text)
    return found


def vary(setting: Setting, density: Element, name: str) -> Element:
    """The variational derivative by a field, the velocity being a function of the momentum.

    Where A u = m, a density that names u has the part ``A^-1 (dh/du)`` in addition, which is c u
    for ``dh/du = c m``.

    Raises:
        DerivationError: ``dh/du`` is anything else.
    """
    field, jets = setting.field, jets_of(setting)
    found = jets.euler(density, name)
    if not inertia(setting):
        return found
    u, through = _name(setting), jets.euler(density, _name(setting))
    factor = field.derivative(through, name)
    if field.reach(factor) & {*jets.orders} or not field.is_zero(through - factor * field[name]):
        message = (
            f"a density names {u} such that its derivative by {u} is no multiple of {name}; "
            f"expected one of {name} and its derivatives, or the energy."
        )
        formula = setting.spec.lagrangian
        assert formula is not None, "the reader asks for a Lagrangian on this route"
        raise fault(setting, formula, message, formula.text)
    return found + factor * field[u]


def close(setting: Setting, element: Element) -> Element:
    """An element in derivatives of u alone where m = A u; else itself."""
    operator, field, jets = inertia(setting), setting.field, jets_of(setting)
    if not operator:
        return element
    (m,), tower = setting.state, jets.towers[_name(setting)]
    values = {
        symbol: field.sum(x * field[tower[n + k]] for n, x in operator.items())
        for k, symbol in enumerate(jets.towers[m])
        if symbol in field.reach(element)
    }
    return field.substitute(element, values)


@once
def velocity(setting: Setting) -> Element:
    """The velocity in terms of the momentum, or itself where A u = m.

    Raises:
        DerivationError: It is no function of the momentum at each point.
    """
    field, name, formula = setting.field, _name(setting), setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian on this route"
    if inertia(setting):
        return field[name]
    slope = _slope(setting)
    named = {c for each in setting.spec.jets for c in each.components}
    mass = field.derivative(slope, name)
    if field.reach(setting.lagrangian) & named or field.reach(mass) & {name, *setting.state}:
        message = (
            f"the momentum dl/d{name} is no multiple of {name} at each point; expected a "
            f"Lagrangian that is quadratic in {name}, without its derivatives."
        )
        raise fault(setting, formula, message, formula.text)
    if field.is_zero(mass):
        message = f"the Lagrangian has no kinetic energy of {name}; expected one."
        raise fault(setting, formula, message, formula.text)
    (m,) = setting.elements(setting.state)
    return (m - field.substitute(slope, {name: field.zero})) / mass


@once
def energy(setting: Setting) -> Element:
    """The density of the energy, ``m u - l``; where A u = m, ``m u/2``, which has this integral."""
    u, (m,) = velocity(setting), setting.elements(setting.state)
    if inertia(setting):
        return m * u / 2
    return m * u - setting.field.substitute(setting.lagrangian, {_name(setting): u})
