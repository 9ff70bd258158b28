r"""Time reversal: whether the motion runs back when its velocities are turned round.

The map :math:`(\eta, z) \mapsto (-\eta, z)` takes a motion to its reverse if and only if
accelerations are even and rates of positions odd in the velocities, and constraints that are kept
hold on both sides. The kernel solves :math:`\mathcal{M}\,\dot\eta = k`, so that it is enough
that k is even, and :math:`\mathcal{M}` where forces proportional to reactions make it depend on
velocities. Dissipation, forces linear in velocities and moving constraints break it.
Comes in: rates along a constrained motion. Goes out: a finding for the certificate.
Read next: `coadjoint.prove.constrained`.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.mechanics.kinematics import multiplier_name, rate_name
from coadjoint.exact import Element
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.findings import finding, first_nonzero, for_parameters, nonzero_at_a_point
from coadjoint.prove.zero import Examined


def about_reversal(motion: ConstrainedRates) -> Iterator[Examined]:
    """Whether the motion is time reversible."""
    if all(solve.symmetric for solve in motion.equations.exact.solves):
        values = reversal_defects(motion)
        name, decision = first_nonzero(values, motion.field, motion.where)
        if name and motion.distribution.kept:  # a force along a constraint is lost in its reaction
            values = rate_defects(motion)
            name, decision = first_nonzero(values, motion.field, motion.where)
    else:  # normal forms of accelerations with friction take minutes
        values = rate_defects(motion)
        name, decision = nonzero_at_a_point(values, motion.field, motion.where)
    names = [v.name for v in motion.equations.spec.state if v.role == "velocity"]
    turned = ", ".join(f"{name} -> -{name}" for name in names)
    scope = for_parameters(motion.equations.setting, [values.get(name, motion.field.zero)])
    yield finding(
        "transformation",
        decision,
        f"the motion is time reversible: it runs back with {turned}",
        f"the motion is not time reversible by {turned}{scope}: {name}",
    )


def rate_defects(motion: ConstrainedRates) -> dict[str, Element]:
    """What is zero if and only if the motion is reversible: of accelerations, not of forces."""
    field, found = motion.field, motion.distribution
    back = {name: -field[name] for name in found.independent}
    values = {}
    for name in motion.rates:
        rate = motion.rate(field[name])
        turned = field.substitute(rate, back)
        parity = "even" if name in back else "odd"
        defect = rate - turned if name in back else rate + turned
        values[f"{rate_name(name)} is not {parity} in them"] = defect
    return values | _kept_defects(motion)


def reversal_defects(motion: ConstrainedRates) -> dict[str, Element]:
    """What is zero if the motion is reversible, by what it is."""
    field, equations, found = motion.field, motion.equations, motion.distribution
    back = {name: -field[name] for name in found.independent}
    values = {}
    for solve in equations.exact.solves:
        for name, known, row in zip(solve.names, solve.known, solve.matrix, strict=True):
            shares = dict(zip(solve.names, row, strict=True)) if not solve.symmetric else {}
            parts = {"": known} | {
                f", as far as it is a multiple of {found.kept[n][0].reaction},": shares[unknown]
                for n in range(len(found.kept))
                if (unknown := multiplier_name(n)) in shares
            }
            for which, part in parts.items():
                force = equations.closed(part)
                defect = force - field.substitute(force, back)
                values[f"the force of {name}{which} is not even in them"] = defect
    for name, rate in motion.rates.items():
        if name not in back:
            values[f"{rate_name(name)} is not odd in them"] = rate + field.substitute(rate, back)
    return values | _kept_defects(motion)


def _kept_defects(motion: ConstrainedRates) -> dict[str, Element]:
    """What is zero if kept constraints hold on both sides."""
    field, found = motion.field, motion.distribution
    back = {name: -field[name] for name in found.independent}
    return {
        f"{equation.name} is not odd in them": residual + field.substitute(residual, back)
        for equation, residual in found.kept
    }
