r"""Time reversal: whether the motion runs back when its velocities are turned round.

The map :math:`(\eta, z) \mapsto (-\eta, z)` takes a motion to its reverse if and only if
accelerations are even and rates of positions odd in the velocities, and constraints that are kept
hold on both sides. The kernel solves :math:`\mathcal{M}(z)\,\dot\eta = k(\eta, z)`, so that k is to
be even. Dissipation, forces linear in velocities and moving constraints break it.
Comes in: rates along a constrained motion. Goes out: a finding for the certificate.
Read next: `coadjoint.prove.constrained`.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.derive.kinematics import rate_name
from coadjoint.exact import Element
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.findings import Finding, finding, first_nonzero


def about_reversal(motion: ConstrainedRates) -> Iterator[Finding]:
    """Whether the motion is time reversible."""
    values = reversal_defects(motion)
    name, decision = first_nonzero(values, motion.field, motion.where)
    names = [v.name for v in motion.equations.spec.state if v.role == "velocity"]
    turned = ", ".join(f"{name} -> -{name}" for name in names)
    yield finding(
        "transformation",
        decision,
        f"the motion is time reversible: it runs back with {turned}",
        f"the motion is not time reversible by {turned}: {name}",
    )


def reversal_defects(motion: ConstrainedRates) -> dict[str, Element]:
    """What is zero if the motion is reversible, by what it is."""
    field, equations, found = motion.field, motion.equations, motion.distribution
    back = {name: -field[name] for name in found.independent}
    values = {}
    for solve in equations.exact.solves:
        for name, known in zip(solve.names, solve.known, strict=True):
            force = equations.closed(known)
            values[f"the force of {name} is not even in them"] = force - field.substitute(
                force, back
            )
    for name, rate in motion.rates.items():
        if name not in back:
            values[f"{rate_name(name)} is not odd in them"] = rate + field.substitute(rate, back)
    for equation, residual in found.kept:
        turned = residual + field.substitute(residual, back)
        values[f"{equation.name} is not odd in them"] = turned
    return values
