r"""Symmetries of motions under constraints, or without a bracket, and how their momenta change.

The flow of a field X on the state is a symmetry of a motion :math:`\dot x = \Gamma(x)`
if it keeps the constraints and takes motions to motions, that is
:math:`[\Gamma, X] + \partial_t X = 0` where the constraints hold. Of positions q alone X is the
lift of a field :math:`\Sigma(q)`: velocities change by :math:`[\xi, \Sigma] + \partial_t \Sigma`.
With :math:`p = \partial l/\partial\xi` its momentum is :math:`J = \langle p, \Sigma \rangle`. It
need not be conserved, since reactions work along Sigma unless the constraints allow it (Bloch,
Krishnaprasad, Marsden and Murray 1996; Holm 2011, section 12.3.2):

.. math::
    \dot J = \Sigma\, l + \langle p, [\xi, \Sigma] + \partial_t \Sigma \rangle
        + \langle f, \Sigma \rangle + \langle \lambda, A \Sigma \rangle.

With a shift of time tau as well, X is :math:`X - \tau\Gamma`, where velocities change by
:math:`-\dot\tau\xi` in addition, and J is :math:`\langle p, \Sigma \rangle - E \tau`.
Of a field on the whole state the momentum is a declared function, which is conserved or not. So it
is on motions that have no bracket: by Newton's law, by a Lax pair alone, or restricted to a
section.
Comes in: such a motion with declared symmetries. Goes out: claims for the certificate.
Read next: `coadjoint.prove.momenta`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial

from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.driving import explicit
from coadjoint.derive.symmetries import Moves, momentum_maps, moves_of, shifts_of
from coadjoint.exact import Element, element_text
from coadjoint.groups.vector_fields import VectorField, lie_derivative
from coadjoint.poisson.momentum_maps import action_defects
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.driven import while_constant
from coadjoint.prove.energy import Balance
from coadjoint.prove.findings import SHOWN, finding
from coadjoint.prove.momenta import law_along
from coadjoint.prove.motion import Motion
from coadjoint.prove.symmetries import decide_on
from coadjoint.prove.zero import Decision, Examined, decide_zero, mark_claimed
from coadjoint.spec.model import Symmetry


class Action:
    """An action of a Lie algebra on the state of a motion.

    Args:
        motion: The motion.
        symmetry: What is declared.
    """

    def __init__(self, motion: Motion, symmetry: Symmetry) -> None:
        self.motion, self.symmetry, self.field = motion, symmetry, motion.field
        self.moves = moves_of(motion.setting, symmetry)

    @property
    def sections(self) -> list[Row]:
        """Fields of a frame, of which there is none here."""
        return []

    @cached_property
    def shifts(self) -> list[Element]:
        """The shift of time, tau, along each basis vector."""
        return list(map(self.motion.close, shifts_of(self.motion.setting, self.symmetry)))

    def law(self, place: int) -> Element:
        """The rate of the momentum along a section."""
        raise AssertionError(f"component {place} is along no field of a frame")

    @cached_property
    def generators(self) -> list[VectorField]:
        """The field on the state of each basis vector, written in the state."""
        return [self._make_field(*pair) for pair in zip(self.moves, self.shifts, strict=True)]

    def _make_field(self, moves: Moves, tau: Element) -> VectorField:
        """One of them; velocities follow where positions alone are moved."""
        setting, zero = self.motion.setting, self.field.zero
        whole = {name: self.motion.close(x) for name, x in moves.items()}
        partners = dict(zip(setting.positions, setting.velocities, strict=False))
        if partners and whole.keys() <= partners.keys():
            whole |= {v: self.motion.rate(whole.get(q, zero)) for q, v in partners.items()}
        return self._shift(whole, tau)

    def _shift(self, moves: Moves, tau: Element) -> VectorField:
        """``X - tau Gamma``."""
        state, zero = self.motion.setting.state, self.field.zero
        parts = [self.motion.close(moves.get(name, zero)) for name in state]
        if tau:
            rates = self.motion.written_rates.values()
            parts = [x - tau * rate for x, rate in zip(parts, rates, strict=True)]
        return VectorField(self.field, state, tuple(parts))

    def action_defects(self) -> list[Element]:
        """What must vanish for the generators to be those of an action."""
        algebra = self.symmetry.algebra.over(self.motion.setting.take_constant)
        return action_defects(algebra, self.generators, 1 if self.symmetry.side == "left" else -1)

    def constraint_defects(self) -> list[Element]:
        """How the residuals of the constraints that are kept change: the others give velocities."""
        return [X.derivative(f) for X in self.generators for _, f in self.motion.kept]

    def motion_defects(self) -> list[Element]:
        """``[Gamma, X] + dX/dt``."""
        setting, rates = self.motion.setting, tuple(self.motion.written_rates.values())
        whole = VectorField(self.field, setting.state, rates)
        return [
            part + explicit(setting, own)
            for X in self.generators
            for part, own in zip(lie_derivative(whole, X).components, X.components, strict=True)
        ]


class ConstrainedAction(Action):
    """An action on the state of a motion along a frame.

    Args:
        motion: The motion.
        symmetry: What is declared.
    """

    def __init__(self, motion: ConstrainedRates, symmetry: Symmetry) -> None:
        super().__init__(motion, symmetry)
        self.frame, self.equations = motion.distribution.frame, motion.distribution.equations

    @cached_property
    def sections(self) -> list[Row]:
        """The field of the frame of each basis vector; empty where not positions alone move."""
        setting, known = self.motion.setting, {*self.motion.setting.positions}
        known |= {*setting.parameters, *setting.time}
        moved = {name for each in self.moves for name in each}
        values = [value for each in self.moves for value in each.values()]
        reached = {x for value in (*values, *self.shifts) for x in self.field.reach(value)}
        if not moved <= {*setting.positions} or not reached <= known:
            return []
        own = len(self.frame.velocities) - len(setting.positions)
        zero = self.field.zero
        return [
            (*(zero,) * own, *(each.get(name, zero) for name in setting.positions))
            for each in self.moves
        ]

    def lift(self, section: Row, tau: Element) -> dict[str, Element]:
        """How positions and all velocities change: these by ``-xi dtau/dt`` where time does."""
        setting, frame = self.motion.setting, self.frame
        xi = setting.elements(frame.velocities)
        late = self._rate(tau)
        parts = zip(frame.velocities, frame.bracket(xi, section), section, xi, strict=True)
        return frame.rates(section) | {
            name: x + explicit(setting, own) - v * late for name, x, own, v in parts
        }

    @cached_property
    def generators(self) -> list[VectorField]:
        """The field on the state of each basis vector, written in the state."""
        moves: Sequence[Moves] = [*map(self.lift, self.sections, self.shifts)] or self.moves
        return [self._shift(*pair) for pair in zip(moves, self.shifts, strict=True)]

    def law(self, place: int) -> Element:
        """The momentum equation, less the rate of ``E tau``."""
        equations, tau = self.motion.equations, self.shifts[place]
        law, balance = law_along(equations, self.sections[place]), Balance(equations)
        if not tau:
            return law
        return law - balance.energy * self._rate(tau) - tau * balance.power

    def _rate(self, tau: Element) -> Element:
        """``dtau/dt`` in the velocities."""
        setting = self.motion.setting
        xi = setting.elements(self.frame.velocities)
        return self.frame.along(xi, tau) + explicit(setting, tau)

    def constraint_defects(self) -> list[Element]:
        """How the residuals of all constraints change along a lift; else of those kept."""
        if not self.sections:
            return super().constraint_defects()
        rates = []
        for section, tau in zip(self.sections, self.shifts, strict=True):
            changes = self.lift(section, tau)
            X = VectorField(self.field, tuple(changes), tuple(changes.values()))
            own = (explicit(self.motion.setting, each.residual) for each in self.equations)
            parts = zip(self.equations, own, strict=True)
            rates += [X.derivative(each.residual) + tau * late for each, late in parts]
        return list(map(self.motion.close, rates))


def about_motion_symmetries(motion: Motion) -> Iterator[Examined]:
    """Claims about the declared symmetries, and the laws of their momenta."""
    energy = motion.equations.exact.energy
    values = momentum_maps(motion.setting, energy)
    for symmetry in motion.spec.symmetries:
        action = (
            ConstrainedAction(motion, symmetry)
            if isinstance(motion, ConstrainedRates)
            else Action(motion, symmetry)
        )
        examined = [*_about_action(motion, action), *_about_momenta(motion, action, values)]
        key = ("symmetries", symmetry.name)
        yield from mark_claimed(motion.spec, key, symmetry.place, examined, motion.field)


def _about_action(motion: Motion, action: Action) -> Iterator[Examined]:
    """That it is an action, and what it keeps."""
    symmetry = action.symmetry
    name, side = symmetry.name, symmetry.side
    moved = f"the flow of {name}"
    claims = {
        f"the generators of {name} act as {symmetry.algebra.name} from the {side}": (
            action.action_defects
        ),
        f"{moved} keeps the constraints": action.constraint_defects,
        f"{moved} takes motions to motions{motion.at_all_times}": action.motion_defects,
    }
    if not (action.sections or motion.kept):  # these hold for every state
        del claims[f"{moved} keeps the constraints"]
    for statement, defects in claims.items():
        yield statement, "symmetry", partial(decide_on, motion, defects)


def _about_momenta(
    motion: Motion, action: Action, values: dict[str, tuple[Element, ...]]
) -> Iterator[Examined]:
    """The momentum equation of each component, or whether a declared function is conserved."""
    symmetry = action.symmetry
    parts = zip(symmetry.components, values[symmetry.name], strict=True)
    for n, (name, value) in enumerate(parts):
        held = while_constant(motion.equations, [value])
        if action.sections:
            law = action.law(n)
            text = f"{_write_law(motion, name, law, action.shifts[n])}{held}"
            yield text, "momentum", partial(_changes, motion, value, law)
            continue
        yield finding(
            "momentum",
            decide_zero([motion.rate(value)], motion.field, motion.where),
            f"{name} is conserved{held}",
            f"{name} is not conserved",
        )


def _write_law(motion: Motion, name: str, law: Element, tau: Element) -> str:
    """The momentum equation, its right side written out where that is short."""
    if motion.where.contains(motion.in_state(law)):
        return f"{name} is conserved, by its momentum equation"
    text = element_text(motion.field, motion.field.normal(motion.equations.close(law)).combine())
    if len(text) > SHOWN:
        text = "Sigma l + <dl/dxi, [xi, Sigma]> + <lambda, A Sigma>"
        text += " + <f, Sigma>" * motion.spec.is_forced + " - d(E tau)/dt" * bool(tau)
    return f"d{name}/dt = {text}"


def _changes(motion: Motion, value: Element, law: Element) -> Decision:
    """The rate of a momentum minus its law."""
    rest = motion.rate(value) - motion.in_state(law)
    return decide_zero([rest], motion.field, motion.where)
