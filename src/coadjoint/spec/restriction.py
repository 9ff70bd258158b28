"""Restriction: a Spec of the motion on a submanifold that it keeps.

Comes in: a Spec that has been read whole, and its submanifold. Goes out: the Spec of what is left,
where the other variables follow from the state as velocities do.
Read next: `coadjoint.derive.reductions`, `coadjoint.prove.reductions`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.spec.model import Reduction, Spec
from coadjoint.spec.sections.reduction import Submanifold


def restrict(whole: Spec, submanifold: Submanifold) -> Spec:
    """The Spec of the motion on a submanifold.

    Args:
        whole: The spec without it.
        submanifold: What some of its variables are there.
    """
    section, where = submanifold.section, submanifold.where
    # what follows from the state is named and emitted as velocities are
    variables = tuple(
        replace(
            variable,
            role="velocity" if variable.name in section else "coordinate",
            block=(),
            representation=None,
        )
        for variable in whole.variables
    )
    before = replace(whole, observables=(), conserved=(), reduction=None)
    return replace(
        whole,
        algebra=None,
        poisson=None,
        invariance="left",
        variables=variables,
        reduction=Reduction(section, where, whole=before),
    )
