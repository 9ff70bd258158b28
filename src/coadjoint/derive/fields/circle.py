r"""Diffeomorphisms: their Euler-Poincare equation, from the variation of a velocity.

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

The maps of a plane that keep areas, closed in both directions, have a stream function
:math:`\psi` with the velocity :math:`(\psi_y, -\psi_x)`. The commutator of two velocities has the
stream function :math:`-\{\psi, \eta\}`, :math:`\{f, g\} = f_x g_y - f_y g_x`, so that
:math:`\delta \psi = \eta_t - \{\psi, \eta\}` and, with :math:`w = \delta l/\delta \psi`,

.. math:: w_t = E_\eta (-w \{\psi, \eta\}) = \{\psi, w\} .

For :math:`l = |\nabla \psi|^2/2` that is Euler's equation, w being the vorticity (Arnold 1966).
Comes in: a Setting with a Lagrangian. Goes out: Equations in jets of m, and of u with such an A.
Read next: `coadjoint.derive.fields.structure`, where the bracket is.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.emission import emit_fields
from coadjoint.derive.fields.jets import Jets, Rows, jets_of, list_rows, solved
from coadjoint.derive.fields.structure import central_charge
from coadjoint.derive.records import write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting, fault, lagrangian_fault, once
from coadjoint.exact import Element
from coadjoint.spec import Formula, Spec

#: The variation of the motion, whose derivatives are symbols like those of a field.
VARIED = "_eta"


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the variation and its derivatives."""
    return tuple(name for row in _rows(spec) for name in row)


def _rows(spec: Spec) -> Rows:
    """The same row by row; of these a variation reads the first derivatives alone."""
    if spec.diffeomorphisms is None or spec.space is None:
        return ()
    return list_rows(VARIED, spec.space.coordinates, 1)


def euler_poincare(setting: Setting, route: str) -> Equations:
    """The Euler-Poincare equation on the circle or the plane.

    Raises:
        DerivationError: The velocity is no function of the momentum at each point.
    """
    u, (m,) = velocity(setting), setting.elements(setting.state)
    jets, rows = jets_of(setting), _rows(setting.spec)
    eta, eta_s = setting.elements(rows[0])
    if setting.spec.in_plane:
        (eta_y,) = setting.elements(rows[1])
        integrand = -m * (jets.total(u) * eta_y - jets.total(u, 0, 1) * eta_s)
    else:
        charge = central_charge(setting)
        integrand = m * (u * eta_s - jets.total(u) * eta) + charge * eta_s * jets.total(u, 2)
    rate = Jets(setting.field, {**jets.rows, VARIED: rows}).euler(integrand, VARIED)
    steps = (
        write_step("Lagrangian", "l(u)", "l(u)", {"l": setting.lagrangian}, by="stationary-action"),
        write_step(
            "Momentum",
            "m = dl/du",
            r"m = \partial l / \partial u",
            write_slopes("l", [_name(setting)], [_slope(setting)]),
            by="legendre",
        ),
        write_step(*_tell_variation(setting), write_rates(setting.state, [rate]), by="epdiff"),
    )
    return emit_fields(setting, route, [rate], steps, energy(setting))


def _tell_variation(setting: Setting) -> tuple[str, str, str]:
    """What the variation is, and what follows from it."""
    if setting.spec.in_plane:
        psi, (w,) = _name(setting), setting.state
        return (
            f"Variation: delta {psi} = eta_t - {{{psi}, eta}}, {{f, g}} = f_x g_y - f_y g_x, "
            "integrated by parts",
            f"d{w}/dt = E_eta(-{w} {{{psi}, eta}}) = {{{psi}, {w}}}",
            r"\dot w = E_\eta (-w \{\psi, \eta\}) = \{\psi, w\}",
        )
    has_charge = bool(central_charge(setting))
    cocycle, cocycle_latex = (
        (" + c eta_s u_ss", r" + c\, \eta_s u_{ss}") if has_charge else ("", "")
    )
    return (
        "Variation: delta u = eta_t + u eta_s - u_s eta, integrated by parts",
        f"dm/dt = E_eta(m (u eta_s - u_s eta){cocycle})",
        rf"\dot m = E_\eta (m (u \eta_s - u_s \eta){cocycle_latex})",
    )


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
def inertia(setting: Setting) -> Mapping[tuple[int, int], Element]:
    """The coefficients of ``D_x^i D_y^j`` in the operator A with m = A u; on a circle j is 0.

    Empty without derivatives. That of u itself may be missing.

    Raises:
        DerivationError: The Lagrangian is no sum of squares with constant positive factors.
    """
    if not solved(setting.spec):
        return {}
    field, formula, name = setting.field, setting.spec.lagrangian, _name(setting)
    assert formula is not None, "the reader asks for a Lagrangian on this route"
    jets, slope = jets_of(setting), _slope(setting)
    reached = field.reach(slope)
    found = {
        (i, j): x
        for symbol, (of, i, j) in jets.places.items()
        if of == name and symbol in reached and (x := field.derivative(slope, symbol))
    }
    is_linear = not any(field.reach(x) & {*jets.places} for x in found.values())
    whole = field.sum(x * field[jets.rows[name][j][i]] for (i, j), x in found.items())
    if not is_linear or not field.is_zero(slope - whole):
        message = (
            f"the momentum dl/d{name} is no linear operator of {name} with constant factors; "
            f"expected a sum of squares of {name} and its derivatives."
        )
        raise fault(setting, formula, message, formula.text)
    for (i, j), x in found.items():
        if i % 2 or j % 2:
            message = (
                f"the momentum dl/d{name} has the derivative {jets.rows[name][j][i]}; expected "
                "even ones along each coordinate, those of a sum of squares of derivatives of "
                f"{name}."
            )
            raise fault(setting, formula, message, formula.text)
        at = field.evaluate(x, field.region.defaults, Fraction) * (-1) ** ((i + j) // 2)
        if at <= 0:
            square = jets.rows[name][j // 2][i // 2]
            message = (
                f"the factor of {square}^2 is {at / 2} at the defaults of the parameters; expected "
                f"a positive one, so that the momentum determines {name}."
            )
            raise fault(setting, formula, message, formula.text)
    return found


def inertia_along(setting: Setting) -> Mapping[int, Element]:
    """The coefficients of ``d^k/ds^k`` in A, on a circle."""
    return {i: x for (i, _), x in inertia(setting).items()}


def vary(setting: Setting, density: Element, name: str, formula: Formula | None = None) -> Element:
    """The variational derivative by a field, the velocity being a function of the momentum.

    Where A u = m, a density that names u has the part ``A^-1 (dh/du)`` in addition, which is c u
    for ``dh/du = c m``.

    Args:
        setting: What was declared.
        density: Whose integral is varied.
        name: The field.
        formula: Where the density is declared; by default it is that of the energy.

    Raises:
        DerivationError: ``dh/du`` is anything else.
    """
    field, jets = setting.field, jets_of(setting)
    found = jets.euler(density, name)
    if not inertia(setting):
        return found
    u, through = _name(setting), jets.euler(density, _name(setting))
    factor = field.derivative(through, name)
    if field.reach(factor) & {*jets.places} or not field.is_zero(through - factor * field[name]):
        message = (
            f"a density names {u} such that its derivative by {u} is no multiple of {name}; "
            f"expected one of {name} and its derivatives, or the energy."
        )
        if formula is None:
            raise lagrangian_fault(setting, message)
        raise fault(setting, formula, message, formula.text)
    return found + factor * field[u]


def close(setting: Setting, element: Element) -> Element:
    """An element in derivatives of u alone where m = A u; else itself."""
    operator, field, jets = inertia(setting), setting.field, jets_of(setting)
    if not operator:
        return element
    (m,), rows, reached = setting.state, jets.rows[_name(setting)], field.reach(element)
    values = {
        symbol: field.sum(x * field[rows[b + j][a + i]] for (i, j), x in operator.items())
        for symbol, (of, a, b) in jets.places.items()
        if of == m and symbol in reached
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
