r"""The alignment route: Newton's law of one particle in R^3 as a Riccati equation of quaternions.

Theorem (Holm 2011, section 3.1.4, equation 3.1.33): with

.. math:: \alpha = \frac{r\cdot v}{r^2}, \quad \chi = \frac{r\times v}{r^2}, \quad
          \beta = \frac{r\cdot F}{r^2}, \quad \psi = \frac{r\times F}{r^2},

the velocity is :math:`v = \alpha r + \chi\times r`, and Newton's law :math:`\dot v = F` becomes

.. math:: \dot q + q^2 = [\beta, \psi], \qquad q = [\alpha, \chi], \qquad \chi\cdot r = 0.

The product is that of quaternions. Without the relation :math:`\chi\cdot r = 0` it is false.
Comes in: a Setting with [newton] of one three-vector. Goes out: Equations in r, alpha and chi.
Read next: `coadjoint.groups.quaternions`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.charts import in_chart
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.forces import accelerations
from coadjoint.derive.records import Relation, Step, write_rates, write_step
from coadjoint.derive.refusals import leave_route
from coadjoint.derive.setting import Setting, fault
from coadjoint.derive.symbols import choose_names
from coadjoint.exact.dense import Vector, add, cross, dot, scale
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec import Spec

ROUTE = "alignment"


def derive(setting: Setting) -> Equations:
    """The motion of the alignment quaternion.

    Raises:
        DerivationError: There is not one particle in three dimensions, or a mass is zero.
    """
    _check_particle(setting)
    field, r = setting.field, setting.elements(setting.positions)
    own = symbols(setting.spec)
    alpha, *chi = setting.elements(own)
    v = add(scale(alpha, r), cross(chi, r))
    moved = dict(zip(setting.velocities, v, strict=True))
    force = tuple(field.substitute(f, moved) for f in accelerations(setting))
    source = Quaternion(dot(r, force), *cross(r, force)).scale(1 / dot(r, r))
    q = Quaternion(alpha, *chi)
    rates = zip((*setting.positions, *own), (*v, *(source - q * q).components), strict=True)
    relation = Relation("chi . r = 0", dot(chi, r))
    motion = in_chart(
        setting, ROUTE, dict(rates), moved, "v = alpha r + chi x r", relations=[relation]
    )
    return replace(motion, steps=_steps(motion, v, source))


def symbols(spec: Spec) -> tuple[str, ...]:
    """``alpha`` and the three components of ``chi``."""
    return choose_names(spec, ("alpha", "chi1", "chi2", "chi3"))


def _check_particle(setting: Setting) -> None:
    """One position in R^3."""
    laws = setting.spec.newton
    if len(laws) != 1 or len(setting.positions) != 3 or laws[0].force.shape != (3,):
        coordinates = ", ".join(setting.positions)
        raise fault(
            setting,
            laws[0].force,
            f"the route alignment is that of one particle in three dimensions, and the coordinates "
            f"are {coordinates}; expected one coordinate with shape = [3]. "
            f"{leave_route(setting, 'alignment').capitalize()}.",
            coordinates,
        )


def _steps(motion: Equations, v: Vector, source: Quaternion) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    return (
        write_step(
            "Velocity by its components along and across r",
            "v = alpha r + chi x r,  chi . r = 0",
            r"v = \alpha r + \chi \times r, \quad \chi \cdot r = 0",
            zip(("v1", "v2", "v3"), v, strict=True),
            by="alignment",
        ),
        write_step(
            "Force along and across r",
            "beta = r . F/r^2,  psi = r x F/r^2",
            r"\beta = r \cdot F / r^2, \quad \psi = r \times F / r^2",
            zip(("beta", "psi1", "psi2", "psi3"), source.components, strict=True),
            by="alignment",
        ),
        write_step(
            "Riccati equation of quaternions",
            "dr/dt = v,  d[alpha, chi]/dt = [beta, psi] - [alpha, chi]^2",
            r"\dot r = v, \quad \frac{d}{dt}[\alpha, \chi] = [\beta, \psi] - [\alpha, \chi]^2",
            write_rates(motion.variables, motion.exact.rates),
            by="alignment",
        ),
    )
