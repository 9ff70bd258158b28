"""Singular Lagrangians: that the motion makes the action stationary.

Lagrange's equations are written down once more, from the declared Lagrangian and the rates alone;
nothing of the one-form and its bracket is used.
Comes in: a motion in which all velocities follow. Goes out: a claim for the certificate.
Read next: `coadjoint.derive.mechanics.first_order`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.exact import Element
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Examined


def about_stationarity(motion: Motion) -> Iterator[Examined]:
    """Lagrange's equations hold along the motion, and momenta are what they are declared to be."""
    text = "d/dt dl/dv = dl/dq along the motion"
    if motion.setting.momenta:
        text += ", with p = dl/dv of the declared momenta"
    yield text, "legendre", partial(_defects, motion)


def _defects(motion: Motion) -> list[Element]:
    """``d/dt dl/dv - dl/dq``, and ``p - dl/dv``, at the velocities of the motion."""
    setting, known = motion.setting, mechanics(motion.setting)
    momenta = [motion.close(each) for each in known.momenta]
    forces = [motion.close(each) for each in known.slopes]
    defects = [motion.rate(p) - f for p, f in zip(momenta, forces, strict=True)]
    declared = dict(zip(setting.momenta, setting.weights, strict=True))
    for variable in motion.spec.having_role("momentum"):
        whole = motion.spec.partner("momentum", variable.of)
        position = next(q for q in motion.spec.having_role("coordinate") if q.name == variable.of)
        assert whole is variable, "each coordinate has one momentum"
        for p, q in zip(variable.components, position.components, strict=True):
            slope = momenta[setting.positions.index(q)]
            own = motion.close(setting.field[p])
            defects.append(own * (1 / declared[p]) - slope)
    return defects
