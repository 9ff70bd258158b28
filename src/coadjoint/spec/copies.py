"""Copies: the tables of a spec with an index, written out for a few members.

Comes in: a checked file with a table [index]. Goes out: one without, in which each variable and
parameter of a member is there for each of them: ``S_0``, ``S_1`` and so on. The algebra is a direct
sum of equal algebras, and brackets of different members are zero.
Read next: `coadjoint.spec.core.members`, which does the same for formulas.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from coadjoint.families import Index
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import Members, member_name
from coadjoint.spec.core.positions import KeyPath, Positions
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import POISSON_PATTERN
from coadjoint.spec.sections.algebra_keys import OperandPart
from coadjoint.spec.sections.algebras import read_algebra
from coadjoint.spec.sections.matrices import block_places
from coadjoint.spec.sections.turning import TURNING, advect


def write_out_file(source: Source, file: Any, index: Index, count: int) -> tuple[Source, Any]:
    """The file and its source for so many members."""
    places = _Places(source.positions)
    variables = _write_variables(source, file, index, count, places)
    parameters = dict[str, Any]()
    for name, part in file.parameters.items():
        if part.index is None:
            parameters[name] = part
            continue
        for k in range(count):
            default = part.default
            if differs(file, part):
                default = default[k % len(default)]
            own = part.model_copy(update={"index": None, "default": default})
            parameters[member_name(name, k)] = own
            places.repeat(("parameters", name), ("parameters", member_name(name, k)))
    update = {"index": {}, "variables": variables, "parameters": parameters}
    if file.algebra is not None and count > 1:
        update["algebra"] = _repeat_algebra(file.algebra, count)
    bound: dict[KeyPath, int] = {}
    if file.poisson is not None:
        update["poisson"] = _write_poisson(source, file, count, places, bound)
    indexed = [*file.variables, *(n for n, p in file.parameters.items() if p.index is not None)]
    members = Members(
        index=index.name,
        count=count,
        periodic=index.periodic,
        names=frozenset(indexed),
        bound=bound,
    )
    return replace(source, positions=places.all, members=members), file.model_copy(update=update)


def differs(file: Any, part: Any) -> bool:
    """Whether a default has an entry for each member: it is one level deeper than that of one."""
    depth, entry = 0, part.default
    while isinstance(entry, list):
        depth, entry = depth + 1, entry[0] if entry else None
    whole = file.variables.get(getattr(part, "of", None), part)
    role = getattr(whole, "role", "")
    matrix = role in ("attitude", "pose")
    along = role in ("velocity", "momentum", "advected", "quaternion")
    return depth > (2 if matrix else 1 if along else len(whole.shape or ()))


class _Places:
    """Where the keys of members stand: where the one key of the spec stands."""

    def __init__(self, positions: Positions) -> None:
        self.all = replace(
            positions,
            keys=dict(positions.keys),
            values=dict(positions.values),
            characters=dict(positions.characters),
        )

    def repeat(self, old: KeyPath, new: KeyPath) -> None:
        """Let a key, and all below it, stand where another one stands."""
        for table in (self.all.keys, self.all.values, self.all.characters):
            found: dict[KeyPath, Any] = {
                (*new, *path[len(old) :]): value
                for path, value in table.items()
                if path[: len(old)] == old
            }
            table.update(found)


def _write_variables(
    source: Source, file: Any, index: Index, count: int, places: _Places
) -> dict[str, Any]:
    """The variables of all members: the first one of each, then the second one."""
    blocks = _Blocks(source, file, count)
    variables = dict[str, Any]()
    for name, part in file.variables.items():
        for k in range(count):
            own = member_name(name, k)
            update: dict[str, Any] = {"index": None, "block": blocks.of(name, part, k)}
            if differs(file, part):
                update["default"] = part.default[k % len(part.default)]
            if part.of is not None:
                update["of"] = member_name(part.of, k)
            variables[own] = part.model_copy(update=update)
            places.repeat(("variables", name), ("variables", own))
    return variables


class _Blocks:
    """Which vectors of the basis the variables of a member span, or act on them."""

    def __init__(self, source: Source, file: Any, count: int) -> None:
        self.source, self.count, self.algebra = source, count, None
        if file.algebra is not None:
            self.algebra = read_algebra(source, file.algebra, "member")
            whole = file.algebra if count == 1 else _repeat_algebra(file.algebra, count)
            self.basis = read_algebra(source, whole, "members").basis

    def of(self, name: str, part: Any, member: int) -> Any:
        """Names of the basis, for the key ``block``."""
        if self.algebra is None or part.role not in ("momentum", "velocity", "advected", *TURNING):
            return part.block
        block = advect(part, self.algebra).block if part.role in TURNING else part.block
        own = tuple(range(self.algebra.dimension))
        if block is not None:
            own = block_places(self.source, ("variables", name, "block"), block, self.algebra)
        start = member * self.algebra.dimension
        return [self.basis[start + place] for place in own]


def _repeat_algebra(part: Any, count: int) -> Any:
    """The direct sum of equal algebras."""
    ways = {name: getattr(part, name) for name in OperandPart.model_fields}
    operand = OperandPart.model_construct(**ways)
    update = dict.fromkeys(OperandPart.model_fields) | {"direct_sum": [operand] * count}
    return part.model_copy(update=update)


def _write_poisson(
    source: Source, file: Any, count: int, places: _Places, bound: dict[KeyPath, int]
) -> Any:
    """The brackets of each member; those of different members are zero."""
    part = file.poisson
    for way in ("nambu", "magnetic"):
        if getattr(part, way) is not None:
            problem = f"there is {way!r} in a spec with [index]"
            raise source.fault(("poisson", way), problem, way, "brackets or canonical")
    if part.canonical is not None:
        pairs = [[member_name(n, k) for n in pair] for pair in part.canonical for k in range(count)]
        return part.model_copy(update={"canonical": pairs})
    brackets = {}
    for key, text in part.brackets.items():
        match = re.match(POISSON_PATTERN, key)
        if match is None:
            problem, expected = f"{key!a} is not a bracket", "a key such as '{x, y}'"
            raise source.at_key(("poisson", "brackets", key), problem, key, expected)
        for k in range(count):
            left, right = (_component_of(file, name, k) for name in match.groups())
            own = f"{{{left}, {right}}}"
            brackets[own] = text
            bound["poisson", "brackets", own] = k
            places.repeat(("poisson", "brackets", key), ("poisson", "brackets", own))
    return part.model_copy(update={"brackets": brackets})


def _component_of(file: Any, component: str, member: int) -> str:
    """The component of a member by that of the generic one."""
    for name, part in file.variables.items():
        shape = tuple(part.shape or ())
        names = component_names(name, shape, part.form or "")
        if component in names:
            own = component_names(member_name(name, member), shape, part.form or "")
            return own[names.index(component)]
    return component
