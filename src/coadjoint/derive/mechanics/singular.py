"""Singular Legendre transforms: what follows from the momenta that no velocities give.

Where ``d2l/dxi2`` has no inverse, momenta with ``n . (mu - dl/dxi(0)) = 0`` alone have velocities,
for n in its kernel. That this lasts asks for more, by the steps of
`coadjoint.derive.mechanics.bound` for the velocities xi at (mu, a).
Comes in: a Lagrangian over an algebra or coordinates, with momenta as the state. Goes out: these
steps, and in words for the message that refuses it.
Read next: `coadjoint.derive.mechanics.legendre`, `coadjoint.derive.mechanics.bound_momenta`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive.mechanics.bound import FACTOR, Constraints, write_direction
from coadjoint.derive.mechanics.configuration import Mechanics
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.exact import Element
from coadjoint.exact.dense import dot


def tell_constraints(of: Mechanics) -> str:
    """What a singular Lagrangian leaves of its motion, step by step, as sentences.

    Empty where its equations are not linear in the velocities at given momenta.
    """
    field, known = of.setting.field, constraints_of(of)
    if known is None:
        return ""
    known.follow()
    way = ""
    if known.is_contradicted():
        end = "no motion satisfies the last one"
    elif known.unsolved is not None:
        end = f"no component has a factor {FACTOR} in the last one"
    elif free := known.free:
        along = (write_direction(field, of.frame.velocities, each) for each in free)
        names = " and ".join(each.replace("d/d", "") for each in along)
        end = f"then nothing gives the velocity along {names}"
    else:
        end = "then all velocities are given, on these momenta alone"
        if of.setting.spec.algebra is not None:
            way = f" Or take the route first-order, on which {list_bound(known)} follow."
    return f" Constraints in their order: {known.chain}; {end}.{way}"


def list_bound(known: Constraints) -> str:
    """What constraints give, in words."""
    return " and ".join(sorted(known.bound))


def constraints_of(of: Mechanics, first: Sequence[str] = ()) -> Constraints | None:
    """``M xi = mu - dl/dxi(0)``; None where rates are not linear in xi.

    Args:
        of: A Lagrangian that is quadratic in the velocities, with a momentum for each.
        first: Of the components of (mu, a), those for which constraints are solved if they can be.
    """
    setting, frame = of.setting, of.frame
    field, names = setting.field, frame.velocities
    if of.bending or len(names) != len(setting.momenta):
        return None
    rest = dict.fromkeys(names, field.zero)
    scaled = zip(setting.momenta, setting.weights, strict=True)
    mu = [field[p] * (1 / weight) for p, weight in scaled]
    moved = (field.substitute(p, rest) for p in of.momenta)
    rates = laws(of)
    slopes = {x: field.gradient(rate, names) for x, rate in rates.items()}
    if any(field.reach(e) & {*names} for row in slopes.values() for e in row):
        return None
    still = {x: field.substitute(rate, rest) for x, rate in rates.items()}
    weights = dict(zip(setting.momenta, setting.weights, strict=True))

    def tangent(value: Element) -> tuple[tuple[Element, ...], Element]:
        along = [
            slope * weights.get(x, 1)
            for x, slope in zip(rates, field.gradient(value, list(rates)), strict=True)
        ]
        columns = zip(*slopes.values(), strict=True)
        own = explicit_rate(setting, value, "what constraints give")
        return tuple(dot(along, column) for column in columns), -own - dot(
            along, list(still.values())
        )

    return Constraints(
        field=field,
        names=tuple(dict.fromkeys((*first, *rates))),
        matrix=of.mass,
        right=tuple(p - slope for p, slope in zip(mu, moved, strict=True)),
        tangent=tangent,
    )


def laws(of: Mechanics) -> dict[str, Element]:
    """The rates of momenta and positions at given velocities, by Poincare's equations."""
    setting, frame = of.setting, of.frame
    scaled = zip(setting.momenta, setting.weights, strict=True)
    mu = [setting.field[p] * (1 / weight) for p, weight in scaled]
    xi = setting.elements(frame.velocities)
    forces = zip(
        frame.inertial(mu, xi),
        frame.slopes(of.lagrangian),
        external_forces(setting, frame.velocities),
        strict=True,
    )
    turned = dict(zip(setting.momenta, (a + b + f for a, b, f in forces), strict=True))
    return turned | frame.rates(xi)
