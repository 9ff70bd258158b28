"""Following: components of variables that constraints give, which are no part of the state.

Comes in: a `Variable`. Goes out: the same with the components that follow.
Read next: `coadjoint.spec.sections.variables`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading
from coadjoint.spec.sections.state import Variable


def let_follow(reading: Reading, variable: Variable, names: Sequence[str]) -> Variable:
    """A variable of which constraints give some components.

    Raises:
        SpecError: It has no such component, or a default where it follows; or all follow.
    """
    key: KeyPath = ("variables", variable.name, "follows")
    for name in names:
        if name not in variable.components or not variable.shape:
            has = variable.shape and f"the components {list_names(variable.components)}"
            problem = f"{variable.name!r} has no component {name!a}"
            expected = f"some of {list_names(variable.components)}" if has else "true, of a number"
            hint = did_you_mean(name, variable.components) if has else "Write follows = true."
            raise reading.fault(key, problem, name, expected, hint)
    if {*names} == {*variable.components}:
        problem = f"all components of {variable.name!r} follow"
        raise reading.fault(key, problem, names[0], "true", "Write follows = true.")
    given = tuple(x for x in variable.components if x in names)
    _check_default(reading, variable, dict.fromkeys(given, "a constraint of the Lagrangian"))
    return replace(variable, given=given)


def bind_velocity(
    reading: Reading, variable: Variable, solved: Mapping[str, Any] | None
) -> Variable:
    """A velocity with what constraints give of it.

    Raises:
        SpecError: A component that a constraint gives has a default.
    """
    if solved is None:
        return variable
    given = tuple(x for x in variable.components if x in solved and variable.shape)
    _check_default(reading, variable, {x: f"the constraint {solved[x][0]}" for x in given})
    free = variable.name not in solved and given != variable.components
    return replace(variable, independent=free, given=given)


def _check_default(reading: Reading, variable: Variable, given: Mapping[str, str]) -> None:
    """No component that follows has a default but 0; what gives it is known by its name."""
    for name, value in zip(variable.components, variable.default or (), strict=False):
        if name in given and value:
            raise reading.fault(
                ("variables", variable.name, "default"),
                f"{name} has the default {value}, and {given[name]} gives it",
                str(value),
                f"0 in the place of {name}, which is not part of the state",
                f"Write 0 in the place of {name}.",
            )
