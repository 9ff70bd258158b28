r"""Poincare's route of 1901: quasi-velocities, structure constants and vector fields.

Theorem (Holm 2011, appendix D; Poincare, C. R. Acad. Sci. 132, 1901, p. 369): let the fields
:math:`X_s` with :math:`[e_k, e_s] = c_{ks}^i e_i` act transitively on the configurations, with
:math:`\dot f = \eta_s X_s f`. Then with the kinetic energy T and the force function U

.. math::
    \frac{d}{dt} \frac{\partial T}{\partial \eta_s}
        = \sum_{k, i} c_{ks}^i \eta_k \frac{\partial T}{\partial \eta_i} + X_s (T + U).

Configurations are seen through the advected quantities, on which a left-invariant system has
:math:`X_s a = -\rho(e_s) a`; T + U is the Lagrangian. A right-invariant one has the opposite sign
of both sums. Every sum is written out here; coadjoint operators and diamonds are not used.
Comes in: a Setting with a Lagrangian. Goes out: Equations whose rates are in quasi-velocities.
Read next: `coadjoint.derive.routes.hamilton_pontryagin`.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit_in_momenta
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element


def derive(setting: Setting) -> Equations:
    """Equations of motion by Poincare's theorem.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    fields, slopes = _vector_fields(setting), legendre(setting).momenta
    inertial, forces = _inertial(setting, slopes), _along(setting, fields, setting.lagrangian)
    momentum = [a + b for a, b in zip(inertial, forces, strict=True)]
    rates = setting.in_state_order(momentum, _advection(setting, fields))
    return emit_in_momenta(setting, "poincare", rates, _steps(setting, forces, rates))


#: X_s of every component of the advected quantities, by name, for each s.
_Fields = list[dict[str, Element]]


def _vector_fields(setting: Setting) -> _Fields:
    """``X_s a = -+ rho(e_s) a``."""
    fields: _Fields = [{} for _ in setting.algebra.basis]
    for variable in setting.advected:
        a = setting.elements(variable.components)
        for X, matrix in zip(fields, setting.actions[variable.name].matrices, strict=True):
            for (row, column), entry in sorted(matrix.items()):
                name = variable.components[row]
                X[name] = X.get(name, setting.field.zero) - setting.sign * entry * a[column]
    return fields


def _inertial(setting: Setting, slopes: tuple[Element, ...]) -> list[Element]:
    """``sum c_ks^i eta_k dT/deta_i`` for every s, each constant used for both of its orders."""
    eta = setting.elements(setting.velocities)
    inertial = [setting.field.zero for _ in slopes]
    for (k, s), row in setting.algebra.constants.items():
        for i, c in row.items():
            inertial[s] += setting.sign * c * eta[k] * slopes[i]
            inertial[k] -= setting.sign * c * eta[s] * slopes[i]
    return inertial


def _along(setting: Setting, fields: _Fields, function: Element) -> list[Element]:
    """``X_s f`` for every s."""
    field = setting.field
    moving = sorted({name for X in fields for name in X})
    slopes = dict(zip(moving, field.gradient(function, moving), strict=True))
    return [field.sum(slopes[name] * value for name, value in X.items()) for X in fields]


def _advection(setting: Setting, fields: _Fields) -> dict[str, list[Element]]:
    """``da/dt = eta_s X_s a``."""
    field, eta = setting.field, setting.elements(setting.velocities)

    def advect(name: str) -> Element:
        return field.sum(n * X[name] for n, X in zip(eta, fields, strict=True) if name in X)

    return {each.name: [advect(name) for name in each.components] for each in setting.advected}


def _steps(setting: Setting, forces: list[Element], rates: tuple[Element, ...]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    transform, sign = legendre(setting), "" if setting.sign == 1 else "-"
    fields = [f"X_{name}" for name in setting.algebra.basis]
    return (
        write_step(
            "Kinetic energy and force function",
            "T + U",
            lines={"L": setting.lagrangian},
            by="stationary-action",
        ),
        write_step(
            "Momenta of the quasi-velocities",
            "p_s = dT/deta_s",
            r"p_s = \partial T / \partial \eta_s",
            write_slopes("T", setting.velocities, transform.momenta),
            by="legendre",
        ),
        write_step(
            "Quasi-velocities",
            "eta solved from p = dT/deta",
            r"\eta = \eta(p, a)",
            transform.definitions,
            by="legendre",
        ),
        write_step("Forces", "X_s (T + U)", lines=zip(fields, forces, strict=True), by="poincare"),
        write_step(
            "Poincare's equations",
            f"d/dt dT/deta_s = {sign}sum c_ks^i eta_k dT/deta_i + X_s (T + U),  "
            "da/dt = eta_s X_s a",
            r"\frac{d}{dt} \frac{\partial T}{\partial \eta_s} = "
            rf"{sign}\sum c_{{ks}}^i \eta_k \frac{{\partial T}}{{\partial \eta_i}} + X_s (T + U), "
            r"\qquad \dot a = \eta_s X_s a",
            write_rates(setting.state, rates),
            by="poincare",
        ),
    )
