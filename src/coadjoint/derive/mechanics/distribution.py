r"""The constraint distribution: the velocities that constraints allow.

Constraints are equations :math:`A(z)\,\xi = b(z)` between the velocities of a frame. Those that a
spec writes as ``Y == ...`` give velocities outright, and

.. math:: \xi = B(z)\,\eta + \beta(z)

with the others, eta, which are the state; where every constraint is of this kind, the columns of B
span the distribution and its rank is certain at every point. The rest, ``dot(Gamma, Omega) == 0``,
is kept as :math:`A_\eta \eta = b_\eta` between these, since to solve it for one of them would put
a pole where none is. The rank of A is a claim of the certificate.
Comes in: a Setting with constraints. Goes out: a `Distribution`.
Read next: `coadjoint.derive.routes.nonholonomic`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.interpret import entries
from coadjoint.derive.mechanics.frames import Frame, frame_of
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.exact import Element
from coadjoint.exact.ranks import generic_rank
from coadjoint.spec.model import Constraint

Row = tuple[Element, ...]


@dataclass(frozen=True)
class Equation:
    """One scalar constraint, ``residual = 0``.

    Attributes:
        name: Of the constraint, with its component.
        reaction: Name of its multiplier.
        residual: Left side minus right side, in all velocities of the frame.
        solves: The velocity that it gives, or "".
    """

    name: str
    reaction: str
    residual: Element
    solves: str


@dataclass(frozen=True)
class Distribution:
    """The velocities that the constraints of a spec allow.

    Attributes:
        frame: The velocities and their fields.
        equations: The scalar constraints in declared order.
    """

    frame: Frame
    equations: tuple[Equation, ...]

    @property
    def setting(self) -> Setting:
        """The spec and its field."""
        return self.frame.setting

    @cached_property
    def independent(self) -> tuple[str, ...]:
        """The velocities eta that are the state, in the order of the frame."""
        state = set(self.setting.state)
        return tuple(name for name in self.frame.velocities if name in state)

    @cached_property
    def solved(self) -> Mapping[str, Element]:
        """The other velocities in terms of eta and the positions."""
        field, known = self.setting.field, dict[str, Element]()
        for equation in self.equations:
            if not equation.solves:
                continue
            name, residual = equation.solves, field.substitute(equation.residual, known)
            value = field[name] - residual / field.derivative(residual, name)
            known = {n: field.substitute(v, {name: value}) for n, v in known.items()}
            known[name] = value
        return known

    @cached_property
    def B(self) -> tuple[Row, ...]:
        """``d xi_l / d eta_k``: a row for each velocity of the frame."""
        field = self.setting.field
        return tuple(field.gradient(value, self.independent) for value in self.xi)

    @cached_property
    def xi(self) -> Row:
        """All velocities of the frame in terms of eta."""
        field = self.setting.field
        return tuple(self.solved.get(name, field[name]) for name in self.frame.velocities)

    @cached_property
    def beta(self) -> Row:
        """What the velocities are where eta = 0: nonzero on moving surfaces."""
        field = self.setting.field
        rest = dict.fromkeys(self.independent, field.zero)
        return tuple(field.substitute(value, rest) for value in self.xi)

    @cached_property
    def A(self) -> tuple[Row, ...]:
        """``d residual / d xi``: a row for each constraint, in all velocities."""
        field = self.setting.field
        return tuple(
            field.gradient(each.residual, self.frame.velocities) for each in self.equations
        )

    @cached_property
    def kept(self) -> tuple[tuple[Equation, Element], ...]:
        """The constraints that give no velocity, with their residuals in eta."""
        field = self.setting.field
        return tuple(
            (each, field.substitute(each.residual, self.solved))
            for each in self.equations
            if not each.solves
        )

    @cached_property
    def kept_rows(self) -> list[Row]:
        """``(A, -b)`` of these constraints, in eta."""
        field, names = self.setting.field, self.independent
        rest = dict.fromkeys(names, field.zero)
        residuals = [residual for _, residual in self.kept]
        return [(*field.gradient(each, names), field.substitute(each, rest)) for each in residuals]

    @cached_property
    def is_linear(self) -> bool:
        """Whether no constraint has an affine term: rest is allowed, and energy keeps its value."""
        field = self.setting.field
        rest = dict.fromkeys(self.frame.velocities, field.zero)
        return all(field.is_zero(field.substitute(e.residual, rest)) for e in self.equations)


@once
def distribution(setting: Setting) -> Distribution:
    """The distribution of the declared constraints.

    Raises:
        DerivationError: A constraint is not linear in the velocities, or the constraints depend on
            each other or contradict each other.
    """
    return _distribution_of(setting, setting.spec.constraints)


@once
def variational_distribution(setting: Setting) -> Distribution:
    """The same of the constraints that are imposed before the variation.

    Raises:
        DerivationError: As of the others.
    """
    return _distribution_of(setting, setting.spec.variational)


def _distribution_of(setting: Setting, constraints: Sequence[Constraint]) -> Distribution:
    frame = frame_of(setting)
    equations = [
        equation
        for constraint in constraints
        for equation in _equations(setting, frame, constraint)
    ]
    whole = Distribution(frame, tuple(equations))
    _check_rank(whole)
    return whole


def _equations(setting: Setting, frame: Frame, constraint: Constraint) -> list[Equation]:
    """The scalar equations of one constraint."""
    field = setting.field
    sides = [list(entries(setting.value(side))) for side in (constraint.left, constraint.right)]
    left, right = (
        [field.zero] * len(constraint.components) if len(side) == 1 and side[0] == 0 else side
        for side in sides
    )
    variable = next((v for v in setting.spec.defined if v.name == constraint.solves), None)
    given = variable.components if variable is not None else ("",) * len(left)
    parts = zip(constraint.components, constraint.reactions, left, right, given, strict=True)
    equations = [Equation(name, reaction, a - b, solves) for name, reaction, a, b, solves in parts]
    for equation in equations:
        _check_linear(setting, frame, constraint, equation)
    return equations


def _check_linear(
    setting: Setting, frame: Frame, constraint: Constraint, equation: Equation
) -> None:
    """A constraint is linear or affine in the velocities, and has some."""
    field, names = setting.field, set(frame.velocities)
    slopes = field.gradient(equation.residual, frame.velocities)
    for name, slope in zip(frame.velocities, slopes, strict=True):
        bent = sorted(field.reach(slope) & names)
        if bent:
            raise fault(
                setting,
                constraint.left,
                f"the constraint {constraint.in_one_line} is not linear in the velocities: its "
                f"derivative by {name} depends on {', '.join(bent)}; expected an equation linear "
                "or affine in them, to which the principles of mechanics apply.",
                equation.name,
            )
    if all(field.is_zero(slope) for slope in slopes):
        holds = field.is_zero(equation.residual)
        raise fault(
            setting,
            constraint.left,
            f"the constraint {constraint.in_one_line} has no velocity in its component "
            f"{equation.name}: it {'holds always' if holds else 'is one on positions'}; expected "
            "an equation between velocities. "
            + ("Remove it." if holds else "Write its time derivative."),
            equation.name,
        )


def _check_rank(distribution: Distribution) -> None:
    """No constraint follows from those before it, or contradicts them."""
    field = distribution.setting.field
    rest = dict.fromkeys(distribution.frame.velocities, field.zero)
    rows = [dict(enumerate(row)) for row in distribution.A]
    last = len(distribution.frame.velocities)
    whole = [
        row | {last: field.substitute(each.residual, rest)}
        for row, each in zip(rows, distribution.equations, strict=True)
    ]
    if _rank(distribution, rows) == len(rows):
        return
    for count in range(1, len(rows) + 1):
        if _rank(distribution, rows[:count]) == count:
            continue
        equation = distribution.equations[count - 1]
        inconsistent = _rank(distribution, whole[:count]) == count
        constraint = constraint_of(distribution, equation)
        others = ", ".join(each.name for each in distribution.equations[: count - 1])
        problem = (
            f"contradicts the constraints before it ({others}): it asks for another value of the "
            "same combination of velocities"
            if inconsistent
            else f"follows from the constraints before it ({others})"
        )
        raise fault(
            distribution.setting,
            constraint.left,
            f"the constraint {equation.name} {problem}; expected independent constraints. "
            f"Remove {equation.name}.",
            equation.name,
        )


def _rank(distribution: Distribution, rows: Sequence[Mapping[int, Element]]) -> int:
    nonzero = [{k: entry for k, entry in row.items() if entry != 0} for row in rows]
    return generic_rank(distribution.setting.field, nonzero)


def constraint_of(distribution: Distribution, equation: Equation) -> Constraint:
    """The declared constraint of which a scalar equation is a component."""
    spec = distribution.setting.spec
    declared = (*spec.constraints, *spec.variational)
    return next(each for each in declared if equation.name in each.components)
