"""Solved velocities: those that a constraint gives, whole or by component; no part of the state.

Comes in: the checked tables, before there are variables, since this decides what the state is. Goes
out: the velocities with their constraints. Read next: `coadjoint.spec.sections.variables`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.tree import Index, Name, Node, walk
from coadjoint.spec.kinds import VARIATIONAL, is_in_frame

_COMPONENT = re.compile(r"(?P<name>.*?)_?\d+(_\d+)?")
_INDICES = re.compile(r"_?\d+(_\d+)?")
_SIDES = 2


def find_solved_velocities(file: Any) -> Mapping[str, tuple[str, int]] | None:
    """The velocities that constraints give, each with its constraint and the side it stands on.

    A constraint gives a velocity, or a component of one, if one side is that name alone and the
    other one does not depend on it, also not through velocities that earlier constraints give; and
    if no force names its reaction, which is then solved for together with the accelerations.

    Args:
        file: The validated tables; formulas that cannot be read yet are passed over.

    Returns:
        Constraint and side (1 for left, -1 for right) by velocity; None where the state has none
        along a frame.
    """
    if not is_in_frame(file):
        return None
    velocities = {name for name, part in file.variables.items() if part.role == "velocity"}
    solved: dict[str, tuple[str, int]] = {}
    reached: dict[str, set[str]] = {}
    acting = [*file.forces.values(), *([file.dissipation.R] if file.dissipation else [])]
    pressing = find_constraints_named(file, acting)
    for constraint, text in constraint_texts(file).items():
        sides = [_parse(side, file) for side in text.split("==")]
        if len(sides) != _SIDES or constraint in pressing:
            continue
        left, right = sides
        for own, other, sign in ((left, right, 1), (right, left, -1)):
            if not isinstance(own, Name) or other is None:
                continue
            if not _is_velocity(file, own.name, velocities) or _meets(own.name, solved):
                continue
            names = {n for n in _list_named(other, file) if _is_velocity(file, n, velocities)}
            names = names.union(*(reached[each] for each in reached if _meets(each, names)))
            if not _meets(own.name, names):
                solved[own.name] = constraint, sign
                reached = {
                    name: {*rest, *names} if _meets(own.name, rest) else rest
                    for name, rest in reached.items()
                }
                reached[own.name] = names
                break
    return solved


def is_component(component: str, name: str) -> bool:
    """Whether a name is one that a component of a quantity may have.

    >>> is_component("Omega12", "Omega"), is_component("v1_2", "v1"), is_component("v12", "v1")
    (True, True, False)
    """
    rest = component.removeprefix(name)
    apart = rest.startswith("_") or not name[-1].isdigit()
    return rest != component and apart and _INDICES.fullmatch(rest) is not None


def _is_velocity(file: Any, name: str, velocities: Iterable[str]) -> bool:
    """Whether a name is that of a velocity or, unless declared otherwise, of a component of one."""
    if any(name in table for table in (file.variables, file.parameters, file.inputs)):
        return name in velocities
    return any(is_component(name, each) for each in velocities)


def _meets(name: str, others: Iterable[str]) -> bool:
    """Whether a velocity, or component, is among others, is part of one or has one as its part."""
    return any(
        name == other or is_component(name, other) or is_component(other, name) for other in others
    )


def constraint_texts(file: Any) -> dict[str, str]:
    """The equations of [constraints] by name, without the key that says when they are imposed."""
    return {name: text for name, text in (file.constraints or {}).items() if name != VARIATIONAL}


def reaction_name(constraint: str) -> str:
    """Name of the multiplier of a constraint.

    >>> reaction_name("plane")
    'plane_reaction'
    """
    return f"{constraint}_reaction"


def find_constraints_named(file: Any, texts: Iterable[str]) -> set[str]:
    """The constraints whose reactions some texts name, also through definitions."""
    names = find_names(file, texts)
    return {name for name in constraint_texts(file) if reaction_name(name) in names}


def find_definitions_with_reactions(file: Any) -> set[str]:
    """Keys of the definitions that name reactions, also through others."""
    return {key for key, text in file.definitions.items() if find_constraints_named(file, [text])}


def find_names(file: Any, texts: Iterable[str]) -> set[str]:
    """What some texts name, whole or by component, also through definitions, and these."""
    trees = (tree for text in texts if (tree := _parse(text, file)) is not None)
    return set[str]().union(*(_find_names(tree, file) for tree in trees))


def _parse(text: str, file: Any) -> Node | None:
    """A tree that may call the definitions with arguments; None where it cannot be read yet."""
    called = [key.split("(")[0].strip() for key in file.definitions if "(" in key]
    try:
        return read_expression(text, called, indexed=True)
    except ExpressionError:
        return None


def _find_names(node: Node, file: Any) -> set[str]:
    """Variables that an expression names, whole or by component, through definitions, and these."""
    names = _list_named(node, file)
    return names | {match["name"] for name in names if (match := _COMPONENT.fullmatch(name))}


def _list_named(node: Node, file: Any) -> set[str]:
    """What an expression names, as it is written, also through definitions, and these."""
    defined = {key.split("(")[0].strip(): text for key, text in file.definitions.items()}
    pending, seen, names = [node], set[str](), set[str]()
    while pending:
        for part in walk(pending.pop()):
            name = str(getattr(part, "name", "") or getattr(part, "function", ""))
            if name in defined and name not in seen:
                seen.add(name)
                names.add(name)
                inner = _parse(defined[name], file)
                pending += [] if inner is None else [inner]
            elif isinstance(part, Name | Index):
                names.add(name)
    return names
