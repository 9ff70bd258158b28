"""Copies: the tables of a spec with an index, written out for a number of members.

Comes in: a checked file with a table [index]. Goes out: one without, in which each variable,
parameter and input of a member is there for each of them: ``S_0``, ``S_1`` and so on. What acts
along a variable of a member, and a constraint or condition of a member, is there for each, too. The
algebra is a direct sum of equal algebras, and brackets of different members are zero.
Read next: `coadjoint.spec.core.written_out`, which does the same for formulas.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from coadjoint.families import Index
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.members import Members, find_free, member_name, reach
from coadjoint.spec.core.positions import KeyPath, Positions
from coadjoint.spec.core.relations import split_sides
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tokens import Token, read_tokens
from coadjoint.spec.core.tree import Node
from coadjoint.spec.core.values import POISSON_PATTERN
from coadjoint.spec.sections.algebra_keys import OperandPart
from coadjoint.spec.sections.algebras import read_algebra
from coadjoint.spec.sections.matrices import block_places
from coadjoint.spec.sections.turning import TURNING, advect

#: Tables of quantities, each of which may have the index.
QUANTITIES = ("variables", "parameters", "inputs")
#: A bracket of quantities of two members: ``{c[i], c[i+1]}``.
_QUANTITY = r" *([A-Za-z]\w*)\[ *([A-Za-z]\w*) *([-+] *\d{1,6})? *\] *"
_BETWEEN = re.compile(rf"\{{{_QUANTITY},{_QUANTITY}\}}")
#: Roles of variables that take their components from the algebra.
_OVER_ALGEBRA = ("momentum", "velocity", "advected", "attitude", "quaternion", "pose")


def write_out_file(source: Source, file: Any, index: Index, count: int) -> tuple[Source, Any]:
    """The file and its source for so many members."""
    return _Writer(source, file, index, count).written


def make_members(
    file: Any, index: Index, count: int, bound: Mapping[KeyPath, int] | None = None
) -> Members:
    """What formulas need to know of the members."""
    parts = {name: part for table in QUANTITIES for name, part in getattr(file, table).items()}
    defined = {key.split("(")[0].strip() for key in file.definitions}
    return Members(
        index=index.name,
        count=count,
        periodic=index.periodic,
        names=frozenset(name for name, part in parts.items() if part.index is not None),
        bound={} if bound is None else bound,
        first=index.first,
        from_zero=index.from_zero,
        number=index.count,
        keeps_number=index.is_value,
        taken=frozenset({*parts, *defined, *filter(None, [index.count])}),
        scalars=frozenset(
            name for name, part in parts.items() if part.index is None and _is_plain(file, part)
        ),
        singles=frozenset(
            name for name, part in parts.items() if part.index is not None and _is_plain(file, part)
        ),
    )


def _is_plain(file: Any, part: Any) -> bool:
    """Whether a quantity has no components."""
    whole = file.variables.get(getattr(part, "of", None) or "", part)
    return not whole.shape and not whole.form and getattr(whole, "role", "") in ("", "coordinate")


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


class Places:
    """Where the keys of members stand: where the one key of the spec stands."""

    def __init__(self, positions: Positions) -> None:
        self.all = replace(
            positions,
            keys=dict(positions.keys),
            values=dict(positions.values),
            characters=dict(positions.characters),
            repeated=dict(positions.repeated),
        )

    def repeat(self, old: KeyPath, new: KeyPath) -> None:
        """Let a key, and all below it, stand where another one stands."""
        if new != old:
            self.all.repeated[new] = self.all.written(old)
        for table in (self.all.keys, self.all.values, self.all.characters):
            found: dict[KeyPath, Any] = {
                (*new, *path[len(old) :]): value
                for path, value in table.items()
                if path[: len(old)] == old
            }
            table.update(found)

    def forget_characters(self, key: KeyPath) -> None:
        """Let faults point at the whole value: its text is not that of the file."""
        kept = {path: value for path, value in self.all.characters.items() if path != key}
        self.all = replace(self.all, characters=kept)


class _Writer:
    """The tables of one file, written out for so many members."""

    def __init__(self, source: Source, file: Any, index: Index, count: int) -> None:
        self.source, self.file, self.index, self.count = source, file, index, count
        self.places, self.bound = Places(source.positions), dict[KeyPath, int]()
        self.members = make_members(file, index, count, self.bound)

    def name(self, name: str, member: int) -> str:
        """What a quantity is called that has an index; another one keeps its name."""
        return (
            member_name(name, self.index.first_name + member)
            if name in self.members.names
            else name
        )

    @property
    def written(self) -> tuple[Source, Any]:
        """The file and its source."""
        file, update = self.file, dict[str, Any](index={})
        for table in QUANTITIES:
            update[table] = self._write_quantities(table)
        if file.algebra is not None and self.count > 1 and self._repeats_algebra:
            update["algebra"] = _repeat_algebra(file.algebra, self.count)
        if file.representations and self._repeats_algebra:
            update["representations"] = dict(self._write_representations())
        if file.poisson is not None:
            update["poisson"] = self._write_poisson()
        for table in ("forces", "newton"):
            if getattr(file, table, None):
                update[table] = self._write_keyed((table,), getattr(file, table))
        for table, key in (("symmetries", "generators"), ("transformations", "map")):
            if getattr(file, table, None):
                update[table] = {
                    name: self._write_moves((table, name, key), part)
                    for name, part in getattr(file, table).items()
                }
        for table in ("constraints", "domain", "noise"):
            if getattr(file, table, None):
                update[table] = dict(self._write_relations(table))
        source = replace(self.source, positions=self.places.all, members=self.members)
        return source, file.model_copy(update=update)

    # -- quantities ---------------------------------------------------------------------

    @property
    def _repeats_algebra(self) -> bool:
        """Whether each member has a copy of the algebra; else all share it, or have none of it.

        Raises:
            SpecError: Some variables along it have the index and others have none.
        """
        along = {n: p for n, p in self.file.variables.items() if p.role in _OVER_ALGEBRA}
        shared = [name for name, part in along.items() if part.index is None]
        if shared and len(shared) < len(along):
            problem = f"the variable {shared[0]!r} has no index, and others along the algebra have"
            hint = f'Add index = "{self.index.name}".'
            expected = "an index of all variables along the algebra, or of none"
            raise self.source.at_key(("variables", shared[0]), problem, shared[0], expected, hint)
        return not shared

    def _write_quantities(self, table: str) -> dict[str, Any]:
        """The quantities of a table: of each the first member, then the second one."""
        blocks, written = _Blocks(self), dict[str, Any]()
        for name, part in getattr(self.file, table).items():
            if part.index is None:
                written[name] = part
                continue
            for k in range(self.count):
                own, update = self.name(name, k), dict[str, Any](index=None)
                if differs(self.file, part):
                    update["default"] = part.default[k % len(part.default)]
                for key in ("of", "rate"):
                    if getattr(part, key, None) is not None:
                        update[key] = self.name(getattr(part, key), k)
                if table == "variables":
                    update["block"] = blocks.of(name, part, k)
                    if part.representation in self.file.representations and blocks.algebra:
                        update["representation"] = member_name(part.representation, k)
                written[own] = part.model_copy(update=update)
                self.places.repeat((table, name), (table, own))
        return written

    def _write_representations(self) -> Iterator[tuple[str, Any]]:
        """The declared representations of each member's algebra; the others act as zero."""
        blocks = _Blocks(self)
        for name, part in self.file.representations.items():
            for k in range(self.count):
                own = member_name(name, k)
                self.places.repeat(("representations", name), ("representations", own))
                yield own, blocks.place(("representations", name), part, k)

    # -- what is there for each member --------------------------------------------------

    def _write_keyed(self, key: KeyPath, parts: Mapping[str, Any]) -> dict[str, Any]:
        """Entries by the names of variables, for each member that has the variable."""
        written = dict[str, Any]()
        for name, part in parts.items():
            if name not in self.members.names:
                written[name] = part
                continue
            for k in range(self.count):
                written[self.name(name, k)] = part
                self._bind((*key, name), (*key, self.name(name, k)), k)
        return written

    def _bind(self, old: KeyPath, new: KeyPath, member: int) -> None:
        self.bound[new] = member
        self.places.repeat(old, new)

    def _write_moves(self, key: KeyPath, part: Any) -> Any:
        """An action or a map with what it does to the variables of each member."""
        moves = getattr(part, str(key[-1]))
        if moves is None:
            return part
        return part.model_copy(update={key[-1]: self._write_keyed(key, moves)})

    def _write_relations(self, table: str) -> Iterator[tuple[str, Any]]:
        """Constraints, conditions and noise; those of a member are there for each."""
        for name, text in getattr(self.file, table).items():
            trees = list(self._read_sides(text)) if isinstance(text, str) else []
            if not any(self.index.name in find_free(tree, self.members) for tree in trees):
                yield name, text
                continue
            ends = [(0, 0)] if self.index.periodic else []
            ends = ends or [reach(t, self.index.name, self.members.names) for t in trees]
            for k in range(max(a for a, _ in ends), self.count - max(b for _, b in ends)):
                own = member_name(name, self.index.first_name + k)
                self._bind((table, name), (table, own), k)
                plain = self._write_text(text, k) if table == "constraints" else text
                if plain != text:
                    self.places.forget_characters((table, own))
                yield own, plain

    def _read_sides(self, text: str) -> Iterator[Node]:
        """The trees of both sides, as far as they can be read."""
        called = [key.split("(")[0].strip() for key in self.file.definitions if "(" in key]
        for side in split_sides(text):
            try:
                yield read_expression(side, called, indexed=True)
            except ExpressionError:
                continue

    def _write_text(self, text: str, member: int) -> str:
        """A text with the names of a member's quantities, where it has no sums.

        Which velocity a constraint gives is seen in its text, before formulas are read.
        """
        tokens = list(read_tokens(text.replace("==", "  ")))
        if any(token.text == "sum" for token in tokens):
            return text
        for n in range(len(tokens) - 3, -1, -1):
            if (found := self._find_subscript(tokens[n:], member)) is not None:
                start, end, own = found
                text = text[:start] + own + text[end:]
        return text

    def _find_subscript(self, tokens: list[Token], member: int) -> tuple[int, int, str] | None:
        """Where a quantity of a member begins, where its index ends, and what stands for both."""
        name, opening, index, *rest = tokens
        if (opening.kind, index.text) != ("[", self.index.name):
            return None
        if name.text not in self.members.names:
            return None
        shift = 0
        if rest[0].kind in ("+", "-") and rest[1].kind == "number":
            shift = int(rest[1].text) * (1 if rest[0].kind == "+" else -1)
            rest = rest[2:]
        at = self.members.place(member + shift)
        if at is None or rest[0].kind not in ("]", ","):
            return None
        own = self.name(name.text, at)
        return name.start, rest[0].end, own + ("[" if rest[0].kind == "," else "")

    # -- brackets -----------------------------------------------------------------------

    def _write_poisson(self) -> Any:
        """The brackets of each member; those of different members are zero."""
        part, members = self.file.poisson, range(self.count)
        for way in ("nambu", "magnetic"):
            if getattr(part, way) is not None:
                problem = f"there is {way!r} in a spec with [index]"
                raise self.source.fault(("poisson", way), problem, way, "brackets or canonical")
        if part.canonical is not None:
            pairs = [[self.name(n, k) for n in pair] for pair in part.canonical for k in members]
            unique = list(map(list, dict.fromkeys(map(tuple, pairs))))
            return part.model_copy(update={"canonical": unique})
        brackets = dict[str, str]()
        for key, text in part.brackets.items():
            path: KeyPath = ("poisson", "brackets", key)
            if (between := _BETWEEN.fullmatch(key)) is not None:
                brackets |= self._write_between(path, between, text, brackets)
                continue
            match = re.match(POISSON_PATTERN, key)
            if match is None:
                problem, expected = f"{key!a} is not a bracket", "a key such as '{x, y}'"
                raise self.source.at_key(path, problem, key, expected)
            for k in members:
                left, right = (self._component_of(name, k) for name in match.groups())
                own = f"{{{left}, {right}}}"
                brackets[own] = text
                if own != key:
                    self._bind(path, ("poisson", "brackets", own), k)
        return part.model_copy(update={"brackets": brackets})

    def _write_between(
        self, path: KeyPath, key: re.Match[str], text: str, known: Mapping[str, str]
    ) -> dict[str, str]:
        """The brackets of members next to each other, as ``{c[i], c[i+1]}``.

        Raises:
            SpecError: Another index, or two members are neighbours twice.
        """
        left, one, before, right, other, after = key.groups()
        for index in (one, other):
            if index != self.index.name:
                raise self.source.unknown(path, f"there is no index {index!a}", index, [one])
        written, shifts = (
            dict[str, str](),
            [int((s or "0").replace(" ", "")) for s in (before, after)],
        )
        for k in range(self.count):
            places = [self.members.place(k + shift) for shift in shifts]
            if None in places:
                continue
            a, b = (
                self._component_of(n, p or 0) for n, p in zip((left, right), places, strict=True)
            )
            own = f"{{{a}, {b}}}"
            if not {own, f"{{{b}, {a}}}"}.isdisjoint({*known, *written}):
                problem = f"the bracket of {a} and {b} is there twice"
                expected = "each pair once; in a ring of two members neighbours meet twice"
                raise self.source.at_key(path, problem, own, expected, "Choose a larger size.")
            written[own] = text
            self._bind(path, ("poisson", "brackets", own), k)
        return written

    def _component_of(self, component: str, member: int) -> str:
        """The component of a member by that of the generic one."""
        for name, part in self.file.variables.items():
            shape = tuple(part.shape or ())
            names = component_names(name, shape, part.form or "")
            if component in names:
                own = component_names(self.name(name, member), shape, part.form or "")
                return own[names.index(component)]
        return component


class _Blocks:
    """Which vectors of the basis the variables of a member span, or act on them."""

    def __init__(self, writer: _Writer) -> None:
        self.source, self.algebra, file = writer.source, None, writer.file
        self.declared = frozenset(file.representations)
        if file.algebra is not None and writer._repeats_algebra:
            self.algebra = read_algebra(self.source, file.algebra, "member")
            whole = (
                file.algebra if writer.count == 1 else _repeat_algebra(file.algebra, writer.count)
            )
            self.basis = read_algebra(self.source, whole, "members").basis

    def of(self, name: str, part: Any, member: int) -> Any:
        """Names of the basis, for the key ``block``."""
        if self.algebra is None or part.role not in _OVER_ALGEBRA:
            return part.block
        if part.representation in self.declared:
            return part.block
        block = advect(part, self.algebra).block if part.role in TURNING else part.block
        return self._name(("variables", name, "block"), block, member)

    def _name(self, key: KeyPath, block: Any, member: int) -> list[str]:
        """Names of the basis that a member has for a block, or for all of its algebra."""
        assert self.algebra is not None, key
        own = tuple(range(self.algebra.dimension))
        if block is not None:
            own = block_places(self.source, key, block, self.algebra)
        start = member * self.algebra.dimension
        return [self.basis[start + place] for place in own]

    def place(self, key: KeyPath, part: Any, member: int) -> Any:
        """A representation of one member's algebra as one of all members together."""
        update = dict[str, Any]()
        for side in ("left", "right"):
            if getattr(part, side) is not None:
                update[side] = self._name((*key, side), getattr(part, side), member)
        if part.matrices is not None and self.algebra is not None:
            names = dict(zip(self.algebra.basis, self._name(key, None, member), strict=True))
            update["matrices"] = {names.get(n, n): rows for n, rows in part.matrices.items()}
        return part.model_copy(update=update)


def _repeat_algebra(part: Any, count: int) -> Any:
    """The direct sum of equal algebras."""
    ways = {name: getattr(part, name) for name in OperandPart.model_fields}
    operand = OperandPart.model_construct(**ways)
    update = dict.fromkeys(OperandPart.model_fields) | {"direct_sum": [operand] * count}
    return part.model_copy(update=update)
