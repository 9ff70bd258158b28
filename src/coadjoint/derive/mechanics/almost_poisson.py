r"""The almost-Poisson bracket of a constrained motion, in the momenta along its distribution.

Theorem (van der Schaft and Maschke 1994; Holm 2011, section 12.3.3): let :math:`D_k = B_k^l X_l`
span the distribution, let :math:`M_k = \langle \partial l/\partial\xi, D_k \rangle =
\partial l_c/\partial\eta^k` and let :math:`H = M_k \eta^k - l_c`. With

.. math::
    \{z, M_k\} = D_k z, \qquad
    \{M_i, M_j\} = -\Big\langle \frac{\partial l}{\partial\xi}, [D_i, D_j] \Big\rangle

the motion of (M, z) is :math:`J \nabla H`, since :math:`\partial H/\partial M = \eta`,
:math:`\partial H/\partial z = -\partial l_c/\partial z` and Hamel's equations are
:math:`\dot M_k = D_k l_c + \eta^i \langle p, [D_i, D_k] \rangle`. The bracket is antisymmetric, so
that energy is kept exactly; the Jacobi identity it need not satisfy, because the brackets of the
fields leave the distribution. All is written at the state (eta, z): no matrix is inverted.
Comes in: a Setting. Goes out: momenta and tensor.
Read next: `coadjoint.derive.routes.hamel`, `coadjoint.prove.almost_poisson`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Distribution, Row, distribution
from coadjoint.derive.setting import Setting, once
from coadjoint.exact import Element

Tensor = tuple[Row, ...]


def momenta_along(setting: Setting, fields: Sequence[Sequence[Element]]) -> Row:
    """``<dl/dxi, D>`` along fields D of the frame, in all velocities."""
    field, p = setting.field, mechanics(setting).momenta
    return tuple(
        field.sum(a * b for a, b in zip(p, along, strict=True) if a and b) for along in fields
    )


def reduced_momenta(distribution: Distribution) -> list[tuple[str, Element]]:
    """``Omega_momentum``, ...: the momenta along the columns of B, by name, in state order."""
    columns = list(zip(*distribution.B, strict=True))
    values = dict(
        zip(distribution.independent, momenta_along(distribution.setting, columns), strict=True)
    )
    return [
        (name, values[velocity])
        for each in distribution.setting.spec.reduced_momenta
        for name, velocity in zip(each.components, each.of.components, strict=True)
    ]


@once
def almost_poisson(setting: Setting) -> Tensor | None:
    """Brackets of the state, velocities standing for their momenta; None where there are none.

    Constraints that are kept give the momenta no free rates, and affine ones make the energy
    another function than H. Those of a point of contact on two curved surfaces would fill pages.
    """
    allowed = distribution(setting)
    touch = allowed.frame.touch
    if allowed.kept or not allowed.is_linear or (touch is not None and touch.point):
        return None
    columns = zip(*allowed.B, strict=True)
    return brackets(allowed, dict(zip(allowed.independent, columns, strict=True)), setting.state)


def brackets(
    distribution: Distribution,
    fields: Mapping[str, Sequence[Element]],
    names: Sequence[str],
) -> Tensor:
    """The matrix of the brackets of some positions and momenta.

    Args:
        distribution: Where the fields live.
        fields: D_k by the name that stands for M_k.
        names: What rows and columns are: names of fields, or positions.
    """
    field, frame = distribution.setting.field, distribution.frame
    moved = {name: frame.rates(along) for name, along in fields.items()}

    def bracket(a: str, b: str) -> Element:
        if a in fields and b in fields:
            turned = frame.bracket(fields[a], fields[b])
            return -momenta_along(distribution.setting, [turned])[0]
        if a in fields:
            return -moved[a][b]
        return moved[b][a] if b in fields else field.zero

    return tuple(tuple(field.zero if a == b else bracket(a, b) for b in names) for a in names)
