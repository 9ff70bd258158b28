"""Constrained motion: the records of constraints, forces, domains and what is reconstructed.

Comes in: what `coadjoint.spec.sections.constraints` read. Goes out: frozen records, parts of a
Spec.
Read next: `coadjoint.derive.routes.nonholonomic`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from coadjoint.spec.core.components import Shape, component_names

if TYPE_CHECKING:
    from coadjoint.spec.model import Formula
    from coadjoint.spec.sections.quantities import Variable


@dataclass(frozen=True)
class Constraint:
    """An equation between velocities, ``left == right``, linear or affine in them.

    Attributes:
        name: As declared; its multiplier is emitted as ``NAME_reaction``.
        left: One side.
        right: The other side, of the same shape.
        solves: The velocity that it gives, if one side is that velocity alone; else "".
        sign: 1 if that velocity is the left side, -1 if it is the right one.
    """

    name: str
    left: Formula
    right: Formula
    solves: str = ""
    sign: int = 1

    @property
    def shape(self) -> Shape:
        """Shape of both sides."""
        return self.left.shape

    @property
    def components(self) -> tuple[str, ...]:
        """Names of its scalar equations."""
        return component_names(self.name, self.shape)

    @property
    def reaction(self) -> str:
        """Name of its multiplier."""
        return reaction_name(self.name)

    @property
    def reactions(self) -> tuple[str, ...]:
        """Names of the components of its multiplier."""
        return component_names(self.reaction, self.shape)

    @property
    def in_one_line(self) -> str:
        """The equation without its line breaks."""
        return self.left.in_one_line


def reaction_name(constraint: str) -> str:
    """Name of the multiplier of a constraint.

    >>> reaction_name("plane")
    'plane_reaction'
    """
    return f"{constraint}_reaction"


def reaction_shapes(constraints: Sequence[Constraint]) -> dict[str, Shape]:
    """Shapes of the multipliers, whole and by component."""
    names = {each.reaction: each.shape for each in constraints}
    return {name: () for each in constraints for name in each.reactions} | names


@dataclass(frozen=True)
class Relaxation:
    """Dissipation by a symmetric bracket beside the Poisson bracket P.

    Attributes:
        G: Symmetric and positive semidefinite: a scalar, times the unit matrix, or a matrix with a
            row for each component of the state.
        S: The entropy of a metriplectic motion, ``dx/dt = P dh + G dS``; None for a double
            bracket, ``dx/dt = P dh + P G P dh``.
    """

    G: Formula
    S: Formula | None = None

    @property
    def table(self) -> str:
        """The table of a spec that declares it."""
        return "double_bracket" if self.S is None else "metriplectic"

    @property
    def added(self) -> str:
        """What it adds to the rates of the state."""
        return "P G P dh" if self.S is None else "G dS"


@dataclass(frozen=True)
class Condition:
    """An inequality that bounds where a system is defined.

    Attributes:
        name: As declared.
        left: One side, a scalar.
        sign: ``>``, ``>=``, ``<`` or ``<=``.
        right: The other side.
    """

    name: str
    left: Formula
    sign: str
    right: Formula

    @property
    def in_one_line(self) -> str:
        """The inequality without its line breaks."""
        return self.left.in_one_line


@dataclass(frozen=True)
class Rolling:
    """A body that rolls on a plane without slipping, for its height and the trace that it leaves.

    Attributes:
        arm: From the point of contact to the centre of mass, seen from the body.
        normal: Name of the advected vector normal to the plane, seen from the body.
        turning: Name of the angular velocity.
        velocity: Name of the velocity of the centre of mass, seen from the body.
    """

    arm: Formula
    normal: str
    turning: str
    velocity: str


@dataclass(frozen=True)
class Reconstructed:
    """A variable that follows from the motion and does not act on it.

    Attributes:
        name: As declared.
        rate: Its time derivative; None for an attitude and for a point of contact.
        attitude: ``"quaternion"`` if it is the attitude that the angular velocity turns; else "".
        shape: Shape of its value.
        default: Where it begins, one exact value per component.
        unit: Unit text.
        doc: Free text for documents.
        of_rolling: Whether it is followed for a body that rolls, and not declared.
    """

    name: str
    rate: Formula | None
    attitude: str = ""
    shape: Shape = ()
    default: tuple[Fraction, ...] | None = None
    unit: str = "1"
    doc: str = ""
    of_rolling: bool = False

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, in order."""
        return component_names(self.name, self.shape, self.attitude)


@dataclass(frozen=True)
class ReducedMomentum:
    """The momentum along the distribution that belongs to an independent velocity.

    Attributes:
        velocity: The velocity; its momentum is emitted as ``Omega_momentum``.
    """

    velocity: Variable

    @property
    def name(self) -> str:
        """Name of the observable."""
        return f"{self.velocity.name}_momentum"

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, as those of the velocity."""
        return component_names(self.name, self.velocity.shape, self.velocity.form)


@dataclass(frozen=True)
class Section:
    """A section of the constraint distribution, whose momentum is emitted.

    Attributes:
        name: Of the momentum ``<dl/dxi, section>``.
        section: Its component along each independent velocity, by the name of that; the others are
            zero.
        unit: Unit of the momentum.
        doc: Free text for documents.
    """

    name: str
    section: Mapping[str, Formula]
    unit: str = "1"
    doc: str = ""

    @property
    def shape(self) -> Shape:
        """A momentum along a section is a scalar."""
        return ()

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)
