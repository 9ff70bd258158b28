"""The variables of a system as records, and which of them are its state.

Comes in: nothing. Goes out: `Variable`. Read next: `coadjoint.spec.sections.variables`, which reads
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from coadjoint.algebra.lie_algebra import SparseMatrix
from coadjoint.algebra.representation import Representation
from coadjoint.spec.core.components import Components, Shape
from coadjoint.spec.core.units import split_units


@dataclass(frozen=True)
class Variable(Components):
    """A velocity, a momentum, an advected quantity, a coordinate or a point of contact.

    Attributes:
        name: As declared, e.g. ``Omega``.
        role: ``"velocity"``, ``"momentum"``, ``"advected"``, ``"coordinate"`` or ``"contact"``.
        shape: ``()`` for a block of one basis element, else ``(n,)``, also where it is a matrix.
        block: Places in the algebra's basis that a velocity or momentum spans; empty if advected.
        representation: How the algebra acts on an advected quantity; None otherwise.
        unit: Unit text, ``"1"`` if dimensionless; inferred where none is declared.
        doc: Free text for documents.
        form: One of `FORMS` if the components are the entries of a matrix, else "".
        of: The coordinate whose velocity or momentum it is; "" over an algebra.
        elements: Matrices of which a velocity is the sum, weighted by its components, in formulas;
            empty where the form says it all.
        default: Where a simulation begins, one exact value per component; None if nothing is said.
        independent: Under constraints, whether a velocity is part of the state; None without any.
        turning: Of an advected quantity that was declared with a role of `TURNING`, this role.
        given: The components that constraints give one by one, or a section those of a coordinate;
            the others are state by themselves.
        follows: Whether a singular Lagrangian gives it in the state, or those of its components
            that are given: a velocity, or what is declared to follow.
        strain: Whether it is ``g^-1 dg/ds`` of a strand: advected by the adjoint representation,
            and moved by the derivative of the velocity along space.
    """

    name: str
    role: str
    shape: Shape
    block: tuple[int, ...] = ()
    representation: Representation | None = None
    unit: str = ""
    doc: str = ""
    form: str = ""
    of: str = ""
    elements: tuple[SparseMatrix, ...] = ()
    default: tuple[Fraction, ...] | None = None
    independent: bool | None = None
    turning: str = ""
    given: tuple[str, ...] = ()
    follows: bool = False
    strain: bool = False

    @property
    def parts(self) -> tuple[Variable, ...]:
        """The variable; its components, each a variable, where constraints give some of them."""
        if not self.given:
            return (self,)
        units = split_units(self.unit, len(self.components)) or ()
        restricted = self.role == "coordinate" and not self.follows
        return tuple(
            replace(
                self,
                name=name,
                role="velocity" if restricted and name in self.given else self.role,
                shape=(),
                form="",
                elements=(),
                block=self.block[n : n + 1],
                unit=units[n][0] if units else self.unit,
                default=self.default and self.default[n : n + 1],
                independent=None if self.independent is None else name not in self.given,
                follows=self.follows and name in self.given,
                given=(),
            )
            for n, name in enumerate(self.components)
        )


def state_of(variables: Sequence[Variable]) -> tuple[Variable, ...]:
    """The variables that make the state, in declared order; see `Spec.state`."""
    given = {variable.of for variable in variables if variable.role == "momentum"}
    return tuple(
        variable
        for whole in variables
        for variable in whole.parts
        if not variable.follows
        and (
            variable.independent
            or variable.role != "velocity"
            or (variable.independent is None and variable.of and variable.of not in given)
        )
    )


def find_defined(variables: Sequence[Variable]) -> tuple[Variable, ...]:
    """The variables, or components of them, that follow from the state."""
    state = state_of(variables)
    parts = (part for each in variables for part in each.parts)
    return tuple(part for part in parts if part not in state)
