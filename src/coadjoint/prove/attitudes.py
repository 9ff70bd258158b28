r"""Attitudes: that what is declared as one turns with the body, and stays one.

Comes in: a motion whose state has attitudes, quaternions or poses. Goes out: claims for the
certificate: the kinematics, compared with products of matrices and quaternions, and that
:math:`R R^T` (from the right :math:`R^T R`) or :math:`|q|^2` is conserved.
Read next: `coadjoint.derive.mechanics.turning`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from coadjoint.derive.mechanics.turning import gram, kinematics
from coadjoint.exact import Element
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero
from coadjoint.spec.model import Variable
from coadjoint.spec.spatial import describe_gram, gram_name


def about_attitudes(motion: Motion) -> Iterator[Examined]:
    """The claims about each attitude; none where a bracket that dissipates moves them, too."""
    if motion.spec.relaxation is not None:
        return
    for law, rates in kinematics(motion.setting):
        yield law, "attitude", partial(_moves_so, motion, rates)
    for variable in motion.spec.turning:
        text = f"{gram_name(variable)} = {describe_gram(motion.spec, variable)} is conserved"
        yield text, "attitude", partial(_stays, motion, variable)


def _moves_so(motion: Motion, expected: Mapping[str, Element]) -> Decision:
    """The rates are those of the law."""
    rates = [motion.rate(motion.field[n]) - motion.in_state(x) for n, x in expected.items()]
    return decide_zero(rates, motion.field, motion.where)


def _stays(motion: Motion, variable: Variable) -> Decision:
    """The product is conserved."""
    rates = list(map(motion.rate, gram(motion.setting, variable)))
    return decide_zero(rates, motion.field, motion.where)
