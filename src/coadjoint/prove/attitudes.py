r"""Attitudes: that what is declared as one turns with the body, and stays one.

Comes in: a motion whose state has attitudes, quaternions or poses. Goes out: claims for the
certificate: the kinematics, compared with products of matrices and quaternions, and that
:math:`R R^T` (from the right :math:`R^T R`) or :math:`|q|^2` is conserved.
Read next: `coadjoint.derive.mechanics.turning`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.turning import gram, gram_matrix, kinematics
from coadjoint.exact import Element
from coadjoint.exact.dense import add, identity, product, scale, subtract
from coadjoint.prove.identities import noise_rates
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero
from coadjoint.spec.model import Variable
from coadjoint.spec.spatial import describe_gram, gram_name


def about_attitudes(motion: Motion) -> Iterator[Examined]:
    """The claims about each attitude; none where a bracket that dissipates moves them, too."""
    if motion.spec.relaxation is not None:
        return
    apart = ", apart from the noise" if motion.spec.noise else ""
    for law, rates in kinematics(motion.setting):
        yield law + apart, "attitude", partial(_moves_so, motion, rates)
    for variable in motion.spec.turning:
        text = f"{gram_name(variable)} = {describe_gram(motion.spec, variable)} is conserved"
        yield text, "attitude", partial(_stays, motion, variable)
        yield (
            f"the solvers move {variable.name} back: {gram_name(variable)} = 1 + D becomes "
            "1 + D^2 (D - 3)/4",
            "attitude",
            partial(_is_moved_back, motion.equations, variable),
        )


def _moves_so(motion: Motion, expected: Mapping[str, Element]) -> Decision:
    """The rates are those of the law."""
    rates = [motion.rate(motion.field[n]) - motion.in_state(x) for n, x in expected.items()]
    return decide_zero(rates, motion.field, motion.where)


def _is_moved_back(equations: Equations, variable: Variable) -> list[Element]:
    """The product after the step minus what it is to be, row by row."""
    back = equations.projection
    assert back is not None, "there is an attitude"
    setting, before = back.setting, gram_matrix(back.setting, variable)
    moved = dict(zip(setting.state, map(back.close, back.exact.rates), strict=True))
    after = [setting.field.substitute(x, moved) for row in before for x in row]
    one = identity(len(before))
    defect = subtract(before, one)
    change = product(product(defect, defect), subtract(defect, scale(3, one)))
    expected = [x for row in add(one, scale(Fraction(1, 4), change)) for x in row]
    return [x - y for x, y in zip(after, expected, strict=True)]


def _stays(motion: Motion, variable: Variable) -> Decision:
    """The product is conserved."""
    values = gram(motion.setting, variable)
    rates = list(map(motion.rate, values))
    rates += [rate for value in values for rate in noise_rates(motion.equations, value)]
    return decide_zero(rates, motion.field, motion.where)
