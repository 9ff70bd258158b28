"""Refusals: why a route cannot be followed, at the place in the spec that is to blame.

Comes in: a Setting and what a route found. Goes out: a `DerivationError` that names the route, what
was found, what is expected and the way out.
"""

from __future__ import annotations

from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError
from coadjoint.spec.routes import ROUTES


def refusal(
    setting: Setting, route: str, problem: str, found: str, expected: str, hint: str = ""
) -> DerivationError:
    """The error of a route that the declared system does not allow.

    Args:
        setting: What was declared.
        route: Name of the route.
        problem: What was found, as a clause.
        found: The guilty value.
        expected: What the route could follow.
        hint: A way out, as a sentence; to leave the route is always another one.
    """
    spec = setting.spec
    formula = spec.lagrangian or spec.hamiltonian
    leave = leave_route(setting, route)
    if leave:
        hint = f"{hint[:-1]}, or {leave}." if hint else f"{leave[0].upper()}{leave[1:]}."
    message = f"the route {route} cannot be followed: {problem}; expected {expected}. {hint}"
    message = message.rstrip()
    return DerivationError(
        formula.locate(spec.path, message) if formula else f"{spec.path}: {message}",
        path=str(spec.path),
        line=formula.line if formula is not None else 0,
        route=route,
        found=found,
        expected=expected,
        hint=hint,
    )


def leave_route(setting: Setting, route: str) -> str:
    """How to do without a route, as a clause; "" where nothing else moves the state."""
    spec, table = setting.spec, ROUTES[route].table
    rest = [each for each in spec.routes if each != route]
    needless = table and not any(ROUTES[each].table == table for each in rest)
    also = f" and remove [{table}]" if needless else ""
    if rest and ROUTES[rest[0]].emitted:
        return f'remove "{route}"' + also.replace(" remove", "")
    if not setting.has_energy:
        return ""
    of_coordinates = "canonical" if spec.hamiltonian is None else "poisson"
    other = of_coordinates if spec.algebra is None else "lie-poisson"
    return f'write "{other}" in its place' + also if other not in rest else f'put "{other}" first'
