"""Refusals: why a route cannot be followed, at the place in the spec that is to blame.

Comes in: a Setting and what a route found. Goes out: a `DerivationError` that names the route, what
was found, what is expected and the way out.
"""

from __future__ import annotations

from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError


def refusal(
    setting: Setting, route: str, problem: str, found: str, expected: str, hint: str
) -> DerivationError:
    """The error of a route that the declared system does not allow.

    Args:
        setting: What was declared.
        route: Name of the route.
        problem: What was found, as a clause.
        found: The guilty value.
        expected: What the route could follow.
        hint: The way out, as a sentence.
    """
    spec = setting.spec
    formula = spec.lagrangian or spec.hamiltonian
    place = f"{spec.path}:{formula.line}" if formula is not None else str(spec.path)
    return DerivationError(
        f"{place}: the route {route} cannot be followed: {problem}; expected {expected}. {hint}",
        path=str(spec.path),
        line=formula.line if formula is not None else 0,
        route=route,
        found=found,
        expected=expected,
        hint=hint,
    )
