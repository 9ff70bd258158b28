"""Motions: rates of functions along the equations of one route, as functions of the state alone.

Comes in: Equations, constrained or free. Goes out: a `Motion`, over which every claim and every
finding is made. With constraints, `coadjoint.prove.constrained` computes the rates.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import Any, Self

from coadjoint.derive import Equations
from coadjoint.derive.emitted import list_following
from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.distribution import Equation, Row
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.prove.completeness import Reach
from coadjoint.prove.energy import Balance
from coadjoint.prove.equivalence import in_velocities, kept_velocities
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.identities import drift, gradient
from coadjoint.prove.reductions import restriction_of
from coadjoint.prove.relaxation import lost
from coadjoint.spec import Spec

#: The roles of variables in which positions are not: polynomials have a degree of their own there.
FIBRE = ("velocity", "momentum")


class Motion:
    """A motion by one route.

    Args:
        equations: What one route derived.
        numbers: Values of all parameters, where the motion is looked at for these alone.

    Attributes:
        built: What functions under `coadjoint.derive.setting.once` have built of this motion.
    """

    def __init__(
        self, equations: Equations, numbers: Mapping[str, Fraction] = MappingProxyType({})
    ) -> None:
        self.equations, self.field = equations, equations.setting.field
        self.built: dict[Any, object] = {}
        self._numbers = {name: self.field.number(x) for name, x in numbers.items()}

    def at(self, numbers: Mapping[str, Fraction]) -> Self:
        """The motion at given parameters, whose rates are much shorter."""
        return type(self)(self.equations, numbers)

    @property
    def spec(self) -> Spec:
        """What was declared."""
        return self.equations.spec

    @property
    def setting(self) -> Setting:
        """The spec and its field."""
        return self.equations.setting

    # -- the state ------------------------------------------------------------------------

    @cached_property
    def fibre(self) -> tuple[str, ...]:
        """The velocities or momenta in the state; the whole state where there are none."""
        names = (x for v in self.spec.state if v.role in FIBRE for x in v.components)
        return tuple(names) or self.setting.state

    @property
    def fibre_word(self) -> str:
        """What these are."""
        roles = {v.role for v in self.spec.state if {*v.components} & {*self.fibre}}
        words = {"velocity": "velocities", "momentum": "momenta"}
        return words.get(roles.pop(), "the state") if len(roles) == 1 else "the state"

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """The rest of the state."""
        return tuple(name for name in self.setting.state if name not in self.fibre)

    @property
    def kept(self) -> tuple[tuple[Equation, Element], ...]:
        """The constraints that give no velocity, with their residuals."""
        return ()

    @property
    def kept_rows(self) -> list[Row]:
        """The same as rows of coefficients of the velocities, the constant last."""
        return []

    @cached_property
    def where(self) -> Ideal:
        """The relations of the state that the motion keeps by constraints."""
        return Ideal(self.field, [])

    # -- rates ----------------------------------------------------------------------------

    def close(self, element: Element) -> Element:
        """An element in what equations know by name, with the numbers of the parameters if given.

        With constraints that is the state and the accelerations.
        """
        return self.put(self.equations.close(element))

    def put(self, element: Element) -> Element:
        """An element with the numbers of the parameters, where these are given."""
        return self.field.substitute(element, self._numbers) if self._numbers else element

    @cached_property
    def rates(self) -> dict[str, Element]:
        """``dx/dt`` of the state, with the names that the kernel solves for."""
        names = self.setting.state
        return dict(zip(names, map(self.close, self.equations.exact.rates), strict=True))

    def rate(self, function: Element) -> Element:
        """The time derivative of a function of state and time, inputs held constant."""
        return self.put(drift(self.equations, function)[0])

    @cached_property
    def decidable_rates(self) -> dict[str, Element]:
        """The same with a decidable zero: in the state, or in velocities in its place."""
        return {name: self.rate(self.field[name]) for name in self.setting.state}

    @property
    def written_rates(self) -> dict[str, Element]:
        """The same written in the state, where that can be done."""
        return self.rates

    def write(self, function: Element) -> Element:
        """A function written in the state, where that can be done."""
        return self.close(function)

    def in_state(self, function: Element) -> Element:
        """A function with a decidable zero: of the state alone, or of velocities in its place."""
        return self.put(in_velocities(self.equations, [function])[0])

    @property
    def acting(self) -> list[str]:
        """What acts in addition to the bracket, as a statement has it."""
        return ["forces", "dissipation"] if self.spec.is_driven else []

    @property
    def reach(self) -> Reach | None:
        """What bounds the number of Casimirs where the bracket is almost-Poisson."""
        return None

    def energy_balance(self) -> Element:
        """``dE/dt`` minus what the energy gains by all that acts, on a section where it is one."""
        energy = Balance(self.equations).energy
        if self.spec.reduction is None:
            power = _power(self.equations)
        else:
            restriction = restriction_of(self.equations)
            power = restriction.on_section(_power(restriction.whole))
        return self.rate(energy) - self.in_state(power)

    # -- matrices -------------------------------------------------------------------------

    @property
    def is_explicit(self) -> bool:
        """Whether the rates are functions of the state that can be written down."""
        return not self.equations.kept

    @property
    def solved_velocities(self) -> Sequence[str]:
        """The velocities that the kernel solves for, in which momenta are written."""
        return kept_velocities(self.equations)

    @property
    def determinant(self) -> str:
        """What the determinant of the whole matrix below is called."""
        return "det(d2l/dv2)"

    @cached_property
    def matrices(self) -> list[tuple[Row, ...]]:
        """The matrices that accelerations are solved with, here ``d2l/dv2``."""
        spec = self.spec
        if self.setting.momenta or spec.lagrangian is None or spec.is_first_order:
            return []
        return [tuple(tuple(map(self.put, row)) for row in mechanics(self.setting).mass)]

    @cached_property
    def divergence(self) -> Element | None:
        """``div X``; None where the rates are not written down and do not show it.

        The Hamiltonian part is that of the bracket, ``d{x_i, x_j}/dx_i dh/dx_j``.
        """
        names, tensor = self.setting.state, self.equations.exact.poisson_tensor
        if self.is_explicit:
            rates = self.rates.items()
            return self.field.sum(self.field.derivative(rate, name) for name, rate in rates)
        if tensor is None or self.spec.is_driven:
            return None
        columns = [
            self.field.sum(map(self.field.derivative, map(self.close, column), names))
            for column in zip(*tensor, strict=True)
        ]
        return None if any(columns) else self.field.zero

    def grow(self, powers: Sequence[tuple[Element, Fraction]]) -> Element:
        """``div X + d ln rho/dt`` of a product of powers, zero if it is an invariant density."""
        assert self.divergence is not None, self.equations.route
        growth = [self.rate(factor) / factor * x for factor, x in powers]
        return self.field.sum([self.divergence, *growth])

    # -- names ----------------------------------------------------------------------------

    @cached_property
    def emitted(self) -> dict[str, Value]:
        """The energy and the observables, by the names that claims use."""
        known: dict[str, Value] = dict(self.equations.exact.observables)
        following = list_following(self.setting)
        parts = (zip(each.components, each.values, strict=True) for each in following)
        known |= {name: value for pairs in parts for name, value in pairs}
        emitted = (*self.equations.exact.emitted, *following)
        return known | {each.name: each.whole for each in emitted}

    @property
    def at_all_times(self) -> str:
        """That time and inputs may have any values, as the end of a statement; "" without them."""
        parts = ["for all inputs"] * bool(self.setting.inputs)
        parts += ["at all times"] * bool(self.setting.time)
        return ", " + " and ".join(parts) if parts else ""

    @property
    def almost_always(self) -> str:
        """The scope of what was found at random parameters, as the end of a statement."""
        almost = ", for almost all parameters" if self.setting.parameters else ""
        return almost + self.at_all_times


def _power(equations: Equations) -> Element:
    """What changes the energy, and by how much."""
    balance = Balance(equations)
    slopes = dict(zip(equations.setting.state, gradient(equations, balance.energy), strict=True))
    return balance.power + balance.work_along_state(slopes) + lost(equations, balance.energy)


def vector_names(motion: Motion, names: Sequence[str]) -> list[str]:
    """Names of components as a statement has them: whole variables by their name."""
    left, shown = dict.fromkeys(names), list[str]()
    for each in motion.spec.state:
        if len(each.components) > 1 and left.keys() >= {*each.components}:
            shown.append(each.name)
            left = {name: None for name in left if name not in each.components}
    return [*shown, *left]
