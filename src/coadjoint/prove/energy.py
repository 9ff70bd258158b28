r"""The balance of energy: what the energy gains and loses along the motion.

.. math::
    \frac{dE}{dt} = \langle f, \xi \rangle
        - \Big\langle \frac{\partial R}{\partial \xi}, \xi \Big\rangle - \lambda \cdot r

with the declared forces f, Rayleigh's function R, and the work of constraints that move, whose
residual at rest is r and whose multipliers are lambda. Where R is quadratic in the velocities its
term is -2 R. A force along a momentum or a coordinate x works by :math:`f\,\partial E/\partial x`.
Comes in: Equations with an energy. Goes out: the law in words, and its terms as elements.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from functools import cached_property

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.external import force_components
from coadjoint.exact import Element, Field
from coadjoint.prove.driven import (
    OWN_CHANGE,
    changes_by_time,
    law_of_change,
    own_change,
    while_constant,
)
from coadjoint.prove.identities import noise_rates
from coadjoint.prove.relaxation import is_dissipative
from coadjoint.spec.model import Variable


def keeps_energy(equations: Equations) -> bool:
    """Whether nothing changes the energy: forces, double brackets, moving constraints or time."""
    spec, distribution = equations.spec, equations.distribution
    acted_on = spec.is_forced or (spec.relaxation is not None and spec.relaxation.S is None)
    moved = distribution is not None and not distribution.is_linear
    free = not acted_on and not moved and not changes_by_time(equations)
    return free and not changes_by_noise(equations)


def changes_by_noise(equations: Equations) -> bool:
    """Whether Wiener processes change the energy."""
    energy = equations.exact.energy
    if energy is None or not equations.spec.noise:
        return False
    return any(not equations.setting.field.is_zero(rate) for rate in noise_rates(equations, energy))


class Balance:
    """The law of the energy of one motion.

    Args:
        equations: With an energy.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.spec, self.setting = equations.spec, equations.setting
        self.field: Field = equations.setting.field

    @property
    def statement(self) -> str:
        """The law in words."""
        held = while_constant(self.equations, [self.energy])
        if keeps_energy(self.equations):
            return f"the energy is conserved{held}"
        if self._only_falls:
            sign = ": the energy never grows" if is_dissipative(self.equations) else ""
            return f"dh/dt = -<P dh, G P dh>{sign}{held}"
        terms = ["the power of the forces"] if self.spec.forces else []
        if self.spec.dissipation is not None:
            terms.append("-2 R" if self._is_quadratic else "-<dR/dxi, xi>")
        if self.spec.relaxation is not None and self.spec.relaxation.S is None:
            terms.append("-<P dh, G P dh>")
        if self._moving:
            terms.append("the work of the moving constraints")
        if changes_by_time(self.equations):
            alone = not terms and self._distribution is None and not self.spec.noise
            terms.append(OWN_CHANGE + f": {law_of_change(self.equations)}" * alone)
        if changes_by_noise(self.equations):
            terms.append("the noise, {h, h_k} o dW_k")
        *others, last = terms
        return f"the energy changes by {', '.join(others)}{' and ' * bool(others)}{last}{held}"

    @property
    def _only_falls(self) -> bool:
        """Whether a double bracket alone changes the energy."""
        double = self.spec.relaxation is not None and self.spec.relaxation.S is None
        alone = double and not self.spec.is_forced and not changes_by_time(self.equations)
        return alone and not changes_by_noise(self.equations)

    @property
    def energy(self) -> Element:
        """What is balanced."""
        energy = self.equations.exact.energy
        assert energy is not None, "only an energy has a balance"
        return energy

    @property
    def power(self) -> Element:
        """What is gained: a function of velocities and state, and of reactions."""
        return self.field.sum(
            [
                *self._work_along_velocities(),
                *self._work_of_constraints(),
                own_change(self.equations),
            ]
        )

    def work_along_state(self, slopes: dict[str, Element]) -> Element:
        """The power of forces along momenta and coordinates.

        Args:
            slopes: Derivatives of the energy by the state.
        """
        return self.field.sum(
            slopes[name] * part
            for variable in self.spec.state
            if variable.role != "velocity"
            for name, part in self._acting_along(variable)
        )

    def _acting_along(self, variable: Variable) -> list[tuple[str, Element]]:
        """The components of a variable that a force acts along, each with what acts."""
        if variable.name not in self.spec.forces:
            return []
        formula = self.spec.forces[variable.name]
        parts = self.setting.components(formula, self.setting.reactions)
        values = force_components(self.setting, variable, parts)
        return list(zip(variable.components, values, strict=True))

    @cached_property
    def _velocities(self) -> tuple[str, ...]:
        distribution, reduction = self._distribution, self.spec.reduction
        if reduction is not None:  # R names those of the whole system
            moving = reduction.whole.having_role("velocity")
            return tuple(name for each in moving for name in each.components)
        if distribution is not None:
            return distribution.frame.velocities
        named = self.setting.conjugates
        return tuple(xi for xi, _, _ in named) if named else self.setting.velocities

    @property
    def _distribution(self) -> Distribution | None:
        return self.equations.distribution

    @property
    def _moving(self) -> bool:
        return self._distribution is not None and not self._distribution.is_linear

    @cached_property
    def _lost(self) -> Element:
        """``<dR/dxi, xi>``."""
        if self.spec.dissipation is None:
            return self.field.zero
        R = self.setting.formula(self.spec.dissipation, self.setting.reactions)
        slopes = self.field.gradient(R, self._velocities)
        pairs = zip(slopes, self.setting.elements(self._velocities), strict=True)
        return self.field.sum(slope * xi for slope, xi in pairs)

    @property
    def _is_quadratic(self) -> bool:
        """Whether ``<dR/dxi, xi> = 2 R``, as of every R quadratic in the velocities."""
        assert self.spec.dissipation is not None, "asked for only where R is declared"
        R = self.setting.formula(self.spec.dissipation, self.setting.reactions)
        return self.field.is_zero(self._lost - 2 * R)

    def _work_along_velocities(self) -> list[Element]:
        """``<f, xi> - <dR/dxi, xi>``, each force with the velocity that it is declared for."""
        terms = [-self._lost]
        for variable in self.spec.having_role("velocity"):
            terms += [f * self.field[xi] for xi, f in self._acting_along(variable)]
        return terms

    def _work_of_constraints(self) -> list[Element]:
        """``-lambda r`` with the residual r of each constraint at rest; and by the contact."""
        distribution = self._distribution
        if distribution is None:
            return []
        rest = dict.fromkeys(distribution.frame.velocities, self.field.zero)
        own = (
            -self.field.substitute(each.residual, rest) * self.field[each.reaction]
            for each in distribution.equations
        )
        return [*own, -distribution.frame.drift(self.setting.lagrangian)]
