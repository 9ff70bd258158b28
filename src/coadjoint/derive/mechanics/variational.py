r"""Constraints imposed before the variation: the Hamiltonian of the normal extremals.

Among motions with :math:`\xi = B(z)\,\eta + \beta(z)` alone the action :math:`\int l\,dt` is
stationary, if the extremal is normal, for motions of

.. math:: h(\mu, z) = \langle \mu, \xi \rangle - l(\xi, z), \qquad
    B^T \Big( \mu - \frac{\partial l}{\partial \xi} \Big) = 0,

which is the Legendre transform of :math:`l_c(\eta, z) = l(B\eta + \beta, z)` with
:math:`B^T \mu` for its momenta (Holm 2011, section 4.3.4; Montgomery 2002, A Tour of Subriemannian
Geometries, chapter 1). The multipliers of the constraints are what is left of the momenta, so that
these have as many components as without constraints. Abnormal extremals, which the constraints
alone single out, do not come from a Hamiltonian. Lagrange and d'Alembert's principle imposes the
constraints after the variation, and has other motions.
Comes in: a Setting with a Lagrangian and such constraints. Goes out: h and the velocities.
Read next: `coadjoint.prove.variational`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coadjoint.derive.mechanics.configuration import conjugates
from coadjoint.derive.mechanics.distribution import (
    Distribution,
    Equation,
    constraint_of,
    variational_distribution,
)
from coadjoint.derive.mechanics.solver import Definition
from coadjoint.derive.records import Step, write_step
from coadjoint.derive.setting import Setting, fault, lagrangian_fault, once
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import dot


@dataclass(frozen=True)
class NormalExtremals:
    """The motions within the constraints along which the action is stationary.

    Attributes:
        equations: The constraints, as scalar equations.
        within: The velocities that the constraints allow, in terms of independent ones.
        B: Their derivatives by the independent ones, by rows.
        definitions: The velocities by name: independent ones in momenta and positions, then the
            others in terms of these.
        energy: h, in which independent velocities keep their names: it is stationary in them.
    """

    equations: tuple[Equation, ...]
    within: tuple[Element, ...]
    B: tuple[tuple[Element, ...], ...]
    definitions: tuple[Definition, ...]
    energy: Element


@once
def normal_extremals(setting: Setting) -> NormalExtremals:
    """The Hamiltonian within the declared constraints.

    Raises:
        DerivationError: A constraint gives no velocity with a constant factor, or l has no Legendre
            transform within them.
    """
    field, of = setting.field, variational_distribution(setting)
    names = of.frame.velocities
    solved = _solve(of)
    free = [name for name in names if name not in solved]
    xi = [solved.get(name, field[name]) for name in names]
    B = tuple(field.gradient(value, free) for value in xi)
    pairs = zip(setting.momenta, setting.weights, strict=True)
    mu = [field[name] * (1 / weight) for name, weight in pairs]
    along = [dot(mu, column) for column in zip(*B, strict=True)]
    reduced = field.substitute(setting.lagrangian, solved)

    def refuse(problem: str, places: Sequence[int]) -> DerivationError:
        named = ", ".join(free[i] for i in places)
        message = (
            f"within the constraints, the second derivative of the Lagrangian by ({named}) "
            f"{problem}. Add the kinetic energy of every velocity that the constraints allow."
        )
        return lagrangian_fault(setting, message, named)

    eta = zip(free, conjugates(field, reduced, free, along, refuse), strict=True)
    return NormalExtremals(
        equations=of.equations,
        within=tuple(xi),
        B=B,
        definitions=(*eta, *solved.items()),
        energy=dot(mu, xi) - reduced,
    )


def show_extremals(setting: Setting) -> tuple[Step, ...]:
    """The steps that lead to h; none without constraints imposed before the variation."""
    if not setting.spec.variational:
        return ()
    of, known = variational_distribution(setting), normal_extremals(setting)
    return (
        write_step(
            "Lagrangian",
            "l(xi, z)",
            r"l(\xi, z)",
            {"l": setting.lagrangian},
            by="stationary-action",
        ),
        write_step(
            "Constraints, imposed before the variation",
            "left - right = 0",
            r"A \xi = b",
            ((each.name, each.residual) for each in of.equations),
            by="normal-extremals",
        ),
        write_step(
            "Velocities that they allow",
            "xi = B(z) eta + beta(z)",
            r"\xi = B(z) \eta + \beta(z)",
            zip(of.frame.velocities, known.within, strict=True),
            by="normal-extremals",
        ),
        write_step(
            "Legendre transform within them: normal extremals",
            "h = <mu, xi> - l, with <mu - dl/dxi, B> = 0",
            r"h = \langle \mu, \xi \rangle - l, \quad B^\top (\mu - \partial l / \partial \xi) = 0",
            [*known.definitions, ("h", known.energy)],
            by="legendre",
        ),
    )


def _solve(of: Distribution) -> dict[str, Element]:
    """A velocity for each constraint, in terms of those that are left.

    Raises:
        DerivationError: None has a constant factor in it.
    """
    setting, field = of.setting, of.setting.field
    known = dict[str, Element]()
    for equation in of.equations:
        residual = field.substitute(equation.residual, known)
        slopes = field.gradient(residual, of.frame.velocities)
        given = [
            (name, slope)
            for name, slope in zip(of.frame.velocities, slopes, strict=True)
            if slope != 0 and field.as_number(slope) is not None
        ]
        if not given:
            message = (
                f"no velocity has a constant factor in {equation.name}; expected one that it gives "
                "at every point. Divide the constraint, as in vz == x*vy."
            )
            raise fault(setting, constraint_of(of, equation).left, message, equation.name)
        name, slope = given[-1]
        value = field[name] - residual / slope
        known = {n: field.substitute(v, {name: value}) for n, v in known.items()}
        known[name] = value
    return known
