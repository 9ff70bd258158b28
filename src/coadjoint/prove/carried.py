r"""The bracket of momenta along a frame, carried over to the velocities that are the state.

With the momenta :math:`M = \partial l_c/\partial\eta` and

.. math:: T = \frac{\partial (M, z)}{\partial (\eta, z)}, \qquad P = T^{-1} J\, T^{-T}

a bracket J of (M, z) is P in (eta, z): the Legendre transform is a change of coordinates, wherever
the mass matrix can be inverted. Without constraints P is Poisson, with linear ones that give
velocities almost-Poisson. A force f along the velocities adds :math:`T^{-1} (B^T f, 0)` to the
rates.
Comes in: a motion along a frame. Goes out: the same motion in closed form, with P as its bracket,
so that Casimirs, brackets and momentum maps mean what they do in momenta.
Read next: `coadjoint.prove.brackets`.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive.mechanics.external import external_forces
from coadjoint.errors import DerivationError
from coadjoint.exact.dense import apply, inverse, product, transpose
from coadjoint.prove.almost_poisson import ReducedBracket
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.motion import Motion


def carry_over(motion: Motion) -> Motion:
    """The motion with its bracket in the state; a motion in momenta has that already.

    Raises:
        DerivationError: There is no bracket: a constraint has an affine term.
    """
    if not isinstance(motion, ConstrainedRates):
        return motion
    equations, distribution = motion.equations, motion.distribution
    if equations.exact.poisson_tensor is None:
        path = str(motion.spec.path)
        raise DerivationError(
            f"{path}: Casimirs or brackets are claimed, and the motion has none: a constraint has "
            "an affine term; expected constraints that allow rest. Name what is conserved in "
            "claims.conserved.",
            path=path,
            found="claims",
        )
    reduced = ReducedBracket(equations)
    back = inverse(reduced.turn)
    tensor = product(product(back, reduced.tensor), transpose(back))
    acting = external_forces(motion.setting, distribution.frame.velocities)
    values = apply(transpose(distribution.B), acting)
    along = dict(zip(distribution.independent, values, strict=True))
    zero = motion.field.zero
    forces = apply(back, [along.get(name, zero) for name in reduced.names])
    exact = replace(
        equations.exact,
        definitions=tuple(
            each for each in equations.exact.definitions if each[0] in distribution.solved
        ),
        rates=tuple(motion.written_rates.values()),
        poisson_tensor=tuple(tuple(map(motion.close, row)) for row in tensor),
        solves=(),
        forces=tuple(map(motion.close, forces)) if any(forces) else (),
    )
    return Motion(replace(equations, exact=exact, distribution=None))
