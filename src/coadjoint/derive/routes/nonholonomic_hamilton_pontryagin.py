r"""The nonholonomic Hamilton-Pontryagin route: velocities, momenta and motions vary on their own.

Principle (Holm 2011, section 12.2): in the action of the unconstrained system

.. math::
    \int l(\xi, z) + \langle \mu, g^{-1}\dot g - \xi \rangle + \langle p, \dot q - v \rangle \, dt

the velocities, the momenta and the motion vary independently. The constraints
:math:`A(z)\,\xi = b` bind the variations of the motion, :math:`A\,g^{-1}\delta g = 0`, and only
afterwards the velocities. So :math:`\mu = \partial l/\partial\xi`, :math:`\dot g = g\xi`, and with
Lagrange's multipliers

.. math::
    \dot\mu_k = F_k(\mu, \xi, z) + f_k + \lambda_e A_{ek}, \qquad
    A\,\dot\xi = \dot b - \dot A\,\xi.

F is read off the action in exponential coordinates about the moving point, as on the route
hamilton-pontryagin. Where a constraint gives a velocity, the second equation is solved for its
rate, and the first one along that velocity for its multiplier; no basis of the distribution, no
bracket and no frame occurs.
Comes in: a Setting with a Lagrangian and constraints. Goes out: Equations in velocities.
Read next: `coadjoint.derive.routes.nonholonomic`, which projects the forces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import Mechanics, mechanics
from coadjoint.derive.mechanics.constrained import emit_motion, start_motion
from coadjoint.derive.mechanics.distribution import Distribution, Row
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.kinematics import multiplier_name, rate_name
from coadjoint.derive.records import Step, write_rates, write_slopes, write_step
from coadjoint.derive.routes import hamilton_pontryagin
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.spec import Spec

ROUTE = "nonholonomic-hamilton-pontryagin"


def symbols(spec: Spec) -> tuple[str, ...]:
    """Coordinates about the moving point, and their rates."""
    return hamilton_pontryagin.symbols(spec) if spec.algebra is not None else ()


def derive(setting: Setting) -> Equations:
    """Equations of motion by the Hamilton-Pontryagin principle with constraints.

    Raises:
        DerivationError: As on the route nonholonomic.
    """
    motion = start_motion(setting)
    distribution = motion.distribution
    forces, moved = _vary(setting)
    momentum = _momentum_equations(distribution, forces, moved)
    constraint = [_rate(distribution, each.residual, moved) for each in distribution.equations]
    given, left = _eliminate(distribution, momentum, constraint)
    field = setting.field
    names = [rate_name(name) for name in distribution.independent]
    mass = tuple(field.gradient(line, names) for line in left)
    rest = dict.fromkeys([*names, *map(multiplier_name, range(len(distribution.kept)))], field.zero)
    known = [-field.substitute(line, rest) for line in left]
    steps = _steps(distribution, forces, momentum, constraint, given)
    reactions = list(given.items())
    return emit_motion(motion, ROUTE, mass, known, lambda _: steps, reactions=reactions)


def _vary(setting: Setting) -> tuple[Row, dict[str, Element]]:
    """F along each velocity by the variation of the motion, and ``dz/dt`` by that of momenta."""
    known, own = mechanics(setting), len(symbols(setting.spec)) // 2
    velocities = setting.elements(known.frame.velocities)
    forces: Row = ()
    moved = dict(zip(setting.positions, velocities[own:], strict=True))
    if own:
        action = hamilton_pontryagin.action_near(setting, known.lagrangian, known.momenta[:own])
        forces = hamilton_pontryagin.momentum_equation(setting, action)
        carried = hamilton_pontryagin.advection(setting, action)
        for variable in setting.advected:
            moved |= zip(variable.components, carried[variable.name], strict=True)
    slopes = (*forces, *setting.field.gradient(known.lagrangian, setting.positions))
    return _vary_contact(known, slopes, moved)


def _vary_contact(
    known: Mechanics, forces: Row, moved: dict[str, Element]
) -> tuple[Row, dict[str, Element]]:
    """The same with the points of contact, which every variation of the motion moves along."""
    touch, frame, field = known.frame.touch, known.frame, known.setting.field
    if touch is None:
        return forces, moved
    names = (*touch.place, *touch.point)
    slopes = dict(zip(names, field.gradient(known.lagrangian, names), strict=True))
    units = (touch.rates(frame.turning(frame.unit(k))) for k in range(len(frame.velocities)))
    gained = [field.sum(slopes[name] * unit[name] for name in names) for unit in units]
    rates = touch.rates(frame.turning(known.setting.elements(frame.velocities)))
    rates = {name: rate + touch.drift.get(name, 0) for name, rate in rates.items()}
    return tuple(a + b for a, b in zip(forces, gained, strict=True)), {**moved, **rates}


def _rate(distribution: Distribution, function: Element, moved: Mapping[str, Element]) -> Element:
    """The time derivative of a function of velocities, positions and time, in accelerations."""
    setting, field = distribution.setting, distribution.setting.field
    accelerations = {v: field[rate_name(v)] for v in distribution.frame.velocities}
    rates = {**moved, **accelerations}
    slopes = zip(field.gradient(function, list(rates)), rates.values(), strict=True)
    own = explicit_rate(setting, function, "a constraint or a momentum")
    return own + field.sum(slope * x for slope, x in slopes if slope != 0)


def _momentum_equations(
    distribution: Distribution, forces: Row, moved: Mapping[str, Element]
) -> dict[str, Element]:
    """``dmu/dt - F - f - A^T lambda`` along each velocity, in accelerations and multipliers.

    Multipliers of constraints that are kept have names of their own, with the other sign: so they
    are told from the reactions that forces name.
    """
    setting, field, names = (
        distribution.setting,
        distribution.setting.field,
        distribution.frame.velocities,
    )
    kept = _kept_reactions(distribution)
    multipliers = [kept.get(e.reaction, field[e.reaction]) for e in distribution.equations]
    lines = {}
    for name, momentum, force, outer, column in zip(
        names,
        mechanics(setting).momenta,
        forces,
        external_forces(setting, names),
        zip(*distribution.A, strict=True) if distribution.A else [()] * len(names),
        strict=True,
    ):
        reaction = field.sum(a * x for a, x in zip(column, multipliers, strict=True))
        lines[name] = _rate(distribution, momentum, moved) - force - outer - reaction
    return lines


def _eliminate(
    distribution: Distribution, momentum: Mapping[str, Element], constraint: Sequence[Element]
) -> tuple[dict[str, Element], list[Element]]:
    """Rates and multipliers that follow, and the momentum equations that are left.

    The velocity that a constraint gives has its rate from that constraint, and the constraint its
    multiplier from the momentum equation along that velocity.
    """
    field = distribution.setting.field
    giving = [
        each for each in zip(distribution.equations, constraint, strict=True) if each[0].solves
    ]
    lines = {rate_name(equation.solves): line for equation, line in giving}
    rates = _solve_affine(distribution, lines)
    left = {name: field.substitute(line, rates) for name, line in momentum.items()}
    multipliers = _solve_affine(
        distribution, {each.reaction: left[each.solves] for each, _ in giving}
    )
    rows = [field.substitute(left[name], multipliers) for name in distribution.independent]
    return {**rates, **_kept_reactions(distribution), **multipliers}, rows


def _kept_reactions(distribution: Distribution) -> dict[str, Element]:
    """The reactions of the constraints that are kept, by the names that the kernel solves for."""
    field = distribution.setting.field
    return {e.reaction: -field[multiplier_name(n)] for n, (e, _) in enumerate(distribution.kept)}


def _solve_affine(distribution: Distribution, lines: Mapping[str, Element]) -> dict[str, Element]:
    """The unknowns of affine equations, one of which belongs to each of them."""
    field, known = distribution.setting.field, dict[str, Element]()
    for name, whole in lines.items():
        line = field.substitute(whole, known)
        value = field[name] - line / field.derivative(line, name)
        known = {n: field.substitute(v, {name: value}) for n, v in known.items()}
        known[name] = value
    return known


def _steps(
    distribution: Distribution,
    forces: Row,
    momentum: Mapping[str, Element],
    constraint: Sequence[Element],
    given: Mapping[str, Element],
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    names, momenta = distribution.frame.velocities, mechanics(distribution.setting).momenta
    equations = [each.name for each in distribution.equations]
    return (
        write_step(
            "Variation of the velocities: the Legendre relation",
            "mu = dl/dxi",
            r"\mu = \partial l / \partial \xi",
            write_slopes("l", names, momenta),
            by="legendre",
        ),
        write_step(
            "Variation of the motion without constraints",
            "F_k from d/dt dL/d(deps/dt) = dL/deps at eps = 0, dl/dq of coordinates",
            r"F_k: \quad \frac{d}{dt} \frac{\partial L}{\partial \dot\epsilon} "
            r"= \frac{\partial L}{\partial \epsilon}",
            zip((f"F_{name}" for name in names), forces, strict=True),
            by="nonholonomic-hamilton-pontryagin",
        ),
        write_step(
            "Variation of the motion within the constraints",
            "dmu/dt - F - f - A^T lambda = 0",
            r"\dot\mu - F - f - A^\top \lambda = 0",
            ((f"E_{name}", value) for name, value in momentum.items()),
            by="nonholonomic-hamilton-pontryagin",
        ),
        write_step(
            "Constraints, imposed after the variation, and their rates",
            "d/dt (left - right) = 0",
            r"\frac{d}{dt}(A \xi - b) = 0",
            write_rates(equations, constraint),
            by="nonholonomic-hamilton-pontryagin",
        ),
        write_step(
            "Rates and multipliers that these equations give",
            "dxi/dt = B deta/dt + c,  lambda",
            r"\dot\xi = B \dot\eta + c, \quad \lambda",
            given,
            by="nonholonomic-hamilton-pontryagin",
        ),
    )
