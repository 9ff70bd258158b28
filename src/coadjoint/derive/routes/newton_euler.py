r"""The Newton-Euler route: a body as mass points fixed in it, and Newton's law for each of them.

Theorem (Holm 2011, sections 2.1.1 and 2.1.2): a point fixed in the body at X is at
:math:`x = y + RX` in space. With the velocity :math:`V = R^T \dot y` of the body's origin and the
angular velocity :math:`\Omega`, both in body axes, its acceleration is

.. math::
    R^T \ddot x = \dot V + \Omega\times V + \dot\Omega\times X + \Omega\times(\Omega\times X),

and the sum of :math:`m R^T \ddot x` over the points is the force F, that of
:math:`m X \times R^T \ddot x` the torque T. The points enter by their total mass m, their first
moment :math:`\sum m X` and their second moments :math:`S = \sum m X X^T = (\mathrm{tr} I/2) - I`
alone, which are read off the kinetic energy; force and torque are the work of a potential along
small shifts and turns of the body. No bracket and no :math:`\mathrm{ad}^*` occurs.
Comes in: a Setting on so(3), for a body about a fixed point or its centre of mass, or on se(3).
Goes out: Equations in the momenta. Read next: `coadjoint.derive.routes.euler_poincare`, which
needs no mass points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import reduce

from coadjoint.algebra import algebra_by_name, same_constants
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.emission import emit_in_momenta
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, write_rates, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import Matrix, Vector, add, cross, dot, scale, subtract, trace

ROUTE = "newton-euler"
AXES: Matrix = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@dataclass(frozen=True)
class MassPoints:
    """What the sums over the points of a body need to know of them.

    Attributes:
        mass: ``sum m``.
        first: ``sum m X``.
        second: ``sum m X X^T``.
    """

    mass: Element
    first: Vector
    second: Matrix

    def weigh(self, f: Callable[[Vector], Vector]) -> Vector:
        """``sum m f(X)`` for a linear f."""
        return _total(scale(c, f(axis)) for c, axis in zip(self.first, AXES, strict=True))

    def weigh_squares(self, f: Callable[[Vector, Vector], Vector]) -> Vector:
        """``sum m f(X, X)`` for a bilinear f."""
        return _total(
            scale(self.second[i][j], f(AXES[i], AXES[j])) for i in range(3) for j in range(3)
        )


def derive(setting: Setting) -> Equations:
    """Equations of motion by Newton's law for the points of the body.

    Raises:
        DerivationError: The algebra is neither so(3) nor se(3), the system is not left-invariant,
            or no body of mass points has this kinetic energy.
    """
    _check_motions(setting)
    lagrangian = setting.lagrangian
    points, forces = mass_points(setting, lagrangian), _forces(setting, lagrangian)
    rates = _rates(setting, points, forces)
    return emit_in_momenta(setting, ROUTE, rates, _steps(setting, points, forces, rates))


def _check_motions(setting: Setting) -> None:
    """The velocities are those of a rigid body, in body axes."""
    algebra, spec = setting.spec.algebra, setting.spec
    assert algebra is not None, "the reader asks for an algebra on this route"
    known = (algebra_by_name(name) for name in ("so(3)", "se(3)"))
    if not any(a.dimension == algebra.dimension and same_constants(a, algebra) for a in known):
        raise refusal(
            setting,
            ROUTE,
            f"the algebra is {algebra.name}",
            algebra.name,
            "so(3) or se(3), the motions of a rigid body",
        )
    if spec.invariance != "left":
        raise refusal(
            setting,
            ROUTE,
            "the system is right-invariant",
            spec.invariance,
            "a left-invariant one, since mass points are fixed in the body",
            'Write invariance = "left".',
        )


# -- the points -----------------------------------------------------------------------------------


def mass_points(setting: Setting, lagrangian: Element) -> MassPoints:
    """The moments of the mass points that have the kinetic energy of a Lagrangian.

    Raises:
        DerivationError: No points have it: a mass that depends on the direction, a coupling of V to
            Omega other than V . Omega x c, or something that moves inside the body.
    """
    mass = mechanics(setting).mass
    inertia = tuple(tuple(row[:3]) for row in mass[:3])
    half = trace(inertia) / 2
    second = subtract(scale(half, AXES), inertia)
    total, first = setting.field.zero, (setting.field.zero,) * 3
    if len(mass) == 6:  # Omega . D V is V . Omega x c for D_ij = -epsilon_ijk c_k
        total, first = mass[3][3], (mass[2][4], mass[0][5], mass[1][3])
    points = MassPoints(total, first, second)
    _check_points(setting, lagrangian, points)
    return points


def _check_points(setting: Setting, lagrangian: Element, points: MassPoints) -> None:
    """The points have the kinetic energy of the Lagrangian, and are fixed in the body."""
    field = setting.field
    rest = lagrangian - _at_rest(setting, lagrangian) - _kinetic_energy(setting, points)
    moving = {*setting.velocities, *setting.advected_names}
    moments = [points.mass, *points.first, *(x for row in points.second for x in row)]
    problems = [(rest, "is left over")] if rest != 0 else []
    problems += [(x, "is not constant") for x in moments if field.reach(field.zero + x) & moving]
    if problems:
        term, what = element_text(field, problems[0][0]), problems[0][1]
        raise refusal(
            setting,
            ROUTE,
            f"no points fixed in a body have this kinetic energy: {term} {what}",
            term,
            "m*dot(v, v)/2 + dot(v, cross(Omega, c)) + dot(Omega, J*Omega)/2 with constant "
            "m, c, J; a mass that depends on the direction is that of a fluid, too",
        )


def _at_rest(setting: Setting, lagrangian: Element) -> Element:
    """Minus the potential."""
    still = dict.fromkeys(setting.velocities, setting.field.zero)
    return setting.field.substitute(lagrangian, still)


def _kinetic_energy(setting: Setting, points: MassPoints) -> Element:
    """``sum m |V + Omega x X|^2 / 2``."""
    omega, v = _velocities(setting)
    moving = points.mass * dot(v, v) / 2
    both = dot(v, points.weigh(lambda x: cross(omega, x)))
    turning = points.weigh_squares(lambda x, y: (dot(cross(omega, x), cross(omega, y)),))
    energy: Element = moving + both + turning[0] / 2
    return energy


# -- the motion -----------------------------------------------------------------------------------


def _velocities(setting: Setting) -> tuple[Vector, Vector]:
    """Omega and V; on so(3) the body's origin stands still."""
    xi = setting.elements(setting.velocities)
    return xi[:3], xi[3:] or (setting.field.zero,) * 3


def _forces(setting: Setting, lagrangian: Element) -> Vector:
    """Torque and force along the body's axes, by virtual work.

    A small turn or shift ``eps e_j`` of the body takes what is fixed in space from a to
    ``a - eps rho(e_j) a``, as the body sees it; the work is ``-dU = F_j eps``.
    """
    field, potential = setting.field, -_at_rest(setting, lagrangian)
    forces = [field.zero] * len(setting.velocities)
    for variable in setting.advected:
        slopes = field.gradient(potential, variable.components)
        seen = setting.elements(variable.components)
        for j in range(len(forces)):
            shift = setting.actions[variable.name].act(_axis(len(forces), j), seen)
            forces[j] += field.sum(slope * x for slope, x in zip(slopes, shift, strict=True) if x)
    return tuple(forces)


def _rates(setting: Setting, points: MassPoints, forces: Vector) -> tuple[Element, ...]:
    """``d/dt sum m X x (V + Omega x X)`` and ``d/dt sum m (V + Omega x X)``.

    The parts of the accelerations with dV/dt and dOmega/dt make these; the others go over to the
    side of torque and force.
    """
    omega, v = _velocities(setting)
    torque, force = forces[:3], forces[3:]
    turning = add(
        points.weigh(lambda x: cross(x, cross(omega, v))),
        points.weigh_squares(lambda x, y: cross(x, cross(omega, cross(omega, y)))),
    )
    rates = subtract(torque, turning)
    if force:
        inner = points.weigh(lambda x: cross(omega, cross(omega, x)))
        rates += subtract(force, add(scale(points.mass, cross(omega, v)), inner))
    advected = {
        variable.name: scale(
            -1,
            setting.actions[variable.name].act(
                setting.elements(setting.velocities), setting.elements(variable.components)
            ),
        )
        for variable in setting.advected
    }
    return setting.in_state_order(rates, advected)


def _axis(count: int, place: int) -> tuple[int, ...]:
    return tuple(int(n == place) for n in range(count))


def _total(vectors: Iterable[Vector]) -> Vector:
    return reduce(add, vectors)


def _steps(
    setting: Setting, points: MassPoints, forces: Vector, rates: tuple[Element, ...]
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    moments = {
        **{f"c{n}": x for n, x in enumerate(points.first, 1)},
        **{f"S{i}{j}": x for i, r in enumerate(points.second, 1) for j, x in enumerate(r, 1)},
    }
    lines = {name: setting.field.zero + x for name, x in moments.items() if x != 0}
    if forces[3:]:
        lines = {"m": points.mass, **lines}
    works = zip(("T1", "T2", "T3", "F1", "F2", "F3"), forces, strict=False)
    return (
        write_step(
            "Moments of the mass points",
            "m = sum m,  c = sum m X,  S = sum m X X^T = (tr I/2) - I",
            r"m = \sum m, \quad c = \sum m X, \quad S = \sum m X X^\top "
            r"= \tfrac12 \mathrm{tr} I - I",
            lines,
            by="angular-velocity",
        ),
        write_step(
            "Torque and force by virtual work",
            "T_j = -dU(a - theta rho(e_j) a)/dtheta",
            r"T_j = -\partial U(a - \theta \rho(e_j) a) / \partial\theta",
            works,
            by="newton-euler",
        ),
        write_step(
            "Velocities from momenta",
            "Pi = sum m X x (V + Omega x X),  P = sum m (V + Omega x X)",
            r"\Pi = \sum m X \times (V + \Omega \times X), \quad P = \sum m (V + \Omega \times X)",
            legendre(setting).definitions,
            by="rotation",
        ),
        write_step(
            "Newton's law, summed over the points",
            "dPi/dt = T - sum m X x (Omega x V + Omega x (Omega x X)),  "
            "dP/dt = F - sum m (Omega x V + Omega x (Omega x X))",
            r"\dot\Pi = T - \sum m X \times (\Omega \times V + \Omega \times (\Omega \times X)), "
            r"\quad \dot P = F - \sum m (\Omega \times V + \Omega \times (\Omega \times X))",
            write_rates(setting.state, rates),
            by="newton-euler",
        ),
    )
