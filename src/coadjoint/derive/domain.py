"""Domain: where a system is defined and regular, as values that are positive there.

Comes in: Equations. Goes out: a bound for each declared condition, the side that is to be larger
minus the other, then, for constrained motions, one for each pivot of the solves in the kernel, with
the sign that it has for a positive kinetic energy: plus for accelerations, minus for multipliers,
since ``[[M, A^T], [A, 0]]`` has the pivots of M and of ``-A M^-1 A^T``. It is one place for every
route, since conditions are the spec's and pivots those of the emitted solves.
Read next: `coadjoint.lower.lowering`, and `coadjoint.solve.domain` for what becomes of it.
"""

from __future__ import annotations

from dataclasses import dataclass

from coadjoint.derive.equations import Equations
from coadjoint.derive.kinematics import multiplier_name
from coadjoint.derive.solver import pivot_name
from coadjoint.exact import Element


@dataclass(frozen=True)
class Bound:
    """A value that is positive, or not negative, where a system is defined.

    Attributes:
        name: Of the condition, of the acceleration or of the reaction.
        kind: ``condition``, ``acceleration`` or ``reaction``.
        element: The value.
        strict: Whether it may not be zero.
        inputs: Components of state and parameters that it depends on.
    """

    name: str
    kind: str
    element: Element
    strict: bool
    inputs: tuple[str, ...]

    @property
    def label(self) -> str:
        """What the row is, for comments and messages."""
        return self.name if self.kind == "condition" else f"pivot of {self.name}"


def bounds(equations: Equations) -> tuple[Bound, ...]:
    """All bounds of a system; none where nothing is declared and nothing is constrained."""
    setting, found = equations.setting, list[Bound]()
    for condition in equations.spec.domain:
        left, right = (
            setting.formula(side, setting.reactions) for side in (condition.left, condition.right)
        )
        value = left - right if condition.sign.startswith(">") else right - left
        strict = not condition.sign.endswith("=")
        inputs = _inputs(equations, value)
        found.append(Bound(condition.name, "condition", value, strict, inputs))
    return (*found, *_pivots(equations))


def _pivots(equations: Equations) -> list[Bound]:
    """A bound for each pivot of the solves of a constrained motion.

    A free motion may have a kinetic energy of either sign, which is regular all the same.
    """
    if equations.distribution is None:
        return []
    kept = enumerate(equations.distribution.kept)
    reactions = {multiplier_name(n): equation.reaction for n, (equation, _) in kept}
    found = []
    for solve in equations.exact.solves:
        for place, name in zip(solve.block, solve.names, strict=True):
            pivot = equations.setting.field[pivot_name(place)]
            kind = "reaction" if name in reactions else "acceleration"
            value = -pivot if name in reactions else pivot
            inputs = _inputs(equations, pivot)
            found.append(Bound(reactions.get(name, name), kind, value, True, inputs))
    return found


def _inputs(equations: Equations, element: Element) -> tuple[str, ...]:
    """Components of state and parameters that a value depends on, through the definitions too."""
    field, setting = equations.setting.field, equations.setting
    reached = set(field.reach(element))
    for name, value in reversed(equations.exact.definitions):
        if name in reached:
            reached |= field.reach(value)
    return tuple(name for name in (*setting.state, *setting.parameters) if name in reached)
