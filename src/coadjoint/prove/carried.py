r"""The bracket of momenta along a frame, carried over to the velocities that are the state.

With the momenta :math:`M = \partial l_c/\partial\eta` and

.. math:: T = \frac{\partial (M, z)}{\partial (\eta, z)}, \qquad P = T^{-1} J\, T^{-T}

a bracket J of (M, z) is P in (eta, z): the Legendre transform is a change of coordinates, wherever
the mass matrix can be inverted. Without constraints P is Poisson, with constraints almost-Poisson.
Constraints that are kept give some velocities of the state as functions of the others: the bracket
is one of functions on the constraints, in the others and the positions.
What is added to :math:`J \nabla H` in (M, z), as a force f along the velocities, is
:math:`T^{-1} (B^T f, 0)` in (eta, z), and so is minus the explicit rate of M.
Comes in: a motion along a frame. Goes out: the same motion in closed form, with P as its bracket,
so that Casimirs, brackets and momentum maps mean what they do in momenta.
Read next: `coadjoint.prove.brackets`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import combinations

from coadjoint.derive.mechanics.almost_poisson import Tensor
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.setting import once
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, dot, inverse, product
from coadjoint.prove.almost_poisson import ReducedBracket
from coadjoint.prove.completeness import Reach
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.motion import Motion
from coadjoint.prove.reached import list_reached


class CarriedMotion(Motion):
    """A motion along a frame with its bracket, on the constraints.

    Velocities that a constraint gives or could give are definitions, also those of the state. The
    rates under constraints may be long: they are not written out, and `rate` asks the source.

    Args:
        motion: As it is solved in the kernel.
    """

    def __init__(self, motion: ConstrainedRates) -> None:
        bracket = ReducedBracket(motion.equations)
        solved = motion.distribution.solved
        given = (each for each in motion.equations.exact.definitions if each[0] in solved)
        exact = replace(
            motion.equations.exact,
            definitions=(*bracket.basis.eliminated.items(), *given),
            rates=() if motion.spec.constraints else tuple(motion.written_rates.values()),
            poisson_tensor=_carry_tensor(motion, bracket),
            solves=(),
            forces=_carry_added(motion, bracket, bracket.added),
        )
        super().__init__(replace(motion.equations, exact=exact, distribution=None))
        self._source, self._bracket = motion, bracket

    def rate(self, function: Element) -> Element:
        """The time derivative of a function of the state."""
        return self._source.rate(function)

    @property
    def others(self) -> Sequence[Element]:
        """What is added to the rates besides a symmetric bracket."""
        own = _carry_added(self._source, self._bracket, self._bracket.forces)
        return own or (self.field.zero,) * len(self.setting.state)

    @cached_property
    def where(self) -> Ideal:
        """The constraints that are kept, as relations of the state."""
        return self._source.where

    @property
    def acting(self) -> list[str]:
        """What acts in addition to the bracket."""
        drift = ["the drift of the affine constraints"] * any(self._bracket.basis.drift)
        own = ["the explicit dependence on time"] * _depends_on_time(self._bracket)
        return [*super().acting, *drift, *own]

    @cached_property
    def reach(self) -> Reach | None:
        """With constraints, the Hamiltonian fields and their commutators."""
        if not self.spec.constraints:
            return None
        fails = self._bracket.defect_somewhere() is not None
        return Reach(rows=partial(list_reached, self._bracket), is_poisson=not fails)


@once
def carry_over(motion: Motion) -> CarriedMotion:
    """A motion along a frame with its bracket in the state."""
    assert isinstance(motion, ConstrainedRates), "a motion in momenta has that already"
    return CarriedMotion(motion)


def _carry_tensor(motion: ConstrainedRates, bracket: ReducedBracket) -> Tensor:
    """The brackets of the state; zeros for velocities that are functions of the others there.

    Nothing reads these zeros: whatever is bracketed is closed first, and names the others alone.
    """
    back, names, field = inverse(bracket.turn), bracket.names, motion.field
    half = product(back, bracket.tensor)
    upper = {
        (names[i], names[j]): motion.close(dot(half[i], back[j]))
        for i, j in combinations(range(len(names)), 2)
    }
    whole = upper | {(b, a): -value for (a, b), value in upper.items()}
    state = motion.setting.state
    return tuple(tuple(whole.get((a, b), field.zero) for b in state) for a in state)


def _carry_added(
    motion: ConstrainedRates, bracket: ReducedBracket, added: Sequence[Element]
) -> tuple[Element, ...]:
    """What is added to the brackets with H; zeros for velocities that constraints give.

    Args:
        motion: The motion.
        bracket: In momenta and positions.
        added: What is added to the rates of these.
    """
    field, setting = motion.field, motion.setting
    own = [
        motion.in_state(value) - explicit(setting, bracket.momenta.get(name, field.zero))
        for name, value in zip(bracket.names, added, strict=True)
    ]
    if all(map(field.is_zero, own)):
        return ()
    turned = apply(inverse(bracket.turn), list(map(bracket.basis.close, own)))
    named = dict(zip(bracket.names, map(motion.close, turned), strict=True))
    return tuple(named.get(name, field.zero) for name in setting.state)


def _depends_on_time(bracket: ReducedBracket) -> bool:
    """Whether the momenta or their fields have explicit rates."""
    setting = bracket.equations.setting
    entries = (x for along in bracket.basis.fields.values() for x in along)
    return any(explicit(setting, each) for each in (*bracket.momenta.values(), *entries))
