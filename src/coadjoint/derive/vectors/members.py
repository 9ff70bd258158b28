"""The equations of the generic member by vectors, from those of a window.

Comes in: Equations of a few members. Goes out: the vector form of member i, with sums over its
partners j. Read next: `coadjoint.derive.vectors.recognise`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from coadjoint.derive.equations import Equations
from coadjoint.derive.vectors.attitudes import name_poses, tell_attitudes
from coadjoint.derive.vectors.gradients import Addend, total_of
from coadjoint.derive.vectors.lines import VectorForm, VectorLine, rate_of
from coadjoint.derive.vectors.recognise import owner_name, recognise
from coadjoint.derive.vectors.shared import name_shared
from coadjoint.derive.vectors.words import make_vocabulary
from coadjoint.spec.core import tree


def member_form(equations: Equations) -> VectorForm:
    """The equations of the generic member, from a member of the window that has all neighbours."""
    declared, vocabulary = equations.spec.family, make_vocabulary(equations)
    assert declared is not None, equations.spec.name
    own, count = declared.ends[0], len(equations.spec.state) // len(declared.variables)
    wanted = {f"{each}_{own}" for each in declared.variables}
    lines, missing = list[VectorLine](), list[str]()
    rename = _Rename(equations, own, count)
    for target in vocabulary.targets:
        label = owner_name(target.node)
        if label not in wanted:
            continue
        for part in [each.rate for each in vocabulary.parts.get(label, ())] or [target]:
            found = recognise(vocabulary, part.value)
            generic = None if found is None else rename.gather(found)
            if generic is None:
                missing.append(label.rpartition("_")[0])
                continue
            lines.append(VectorLine(rate_of(rename.node(part.node)), generic))
    shapes = dict(vocabulary.shapes)
    for label, own_shape in list(shapes.items()):
        shapes.setdefault(label.rpartition("_")[0], own_shape)
    taken = {*shapes, *(q.name for q in equations.spec.parameters)}
    lines, named = name_shared(lines, shapes, taken)
    told = tell_attitudes(equations.spec, lines)
    return VectorForm(
        lines=tuple(lines),
        missing=tuple(missing),
        shapes={**shapes, **named},
        written={},
        told="; ".join(told),
    )


class _Rename:
    """Names of members of a window as those of member i, its neighbours or a partner j."""

    def __init__(self, equations: Equations, own: int, count: int) -> None:
        declared = equations.spec.family
        assert declared is not None, equations.spec.name
        self.index, self.pairs = declared.index.name, declared.pairs
        self.own, self.count = own, count
        self.ring = declared.index.periodic
        self.other = "j" if self.index != "j" else "k"
        self.bases = {*declared.variables, *declared.indexed, *declared.indexed_inputs}
        for pose in name_poses(equations.spec):
            self.bases |= {name.rpartition("_")[0] for name in pose.names}

    def member_of(self, label: str) -> tuple[str, int] | None:
        """The quantity and the member that a name means."""
        base, _, number = label.rpartition("_")
        return (base, int(number)) if base in self.bases and number.isdigit() else None

    def node(self, node: tree.Node, partner: int | None = None) -> tree.Node:
        """A tree in names of member i, of its neighbours, and of member j for a partner."""
        if isinstance(node, tree.Name):
            found = self.member_of(node.name)
            if found is None:
                return node
            base, number = found
            if number == partner:
                return tree.Member(name=base, index=self.other, shift=0, indices=())
            shift = number - self.own
            if self.ring and shift > self.count // 2:
                shift -= self.count
            return tree.Member(name=base, index=self.index, shift=shift, indices=())
        below = [self.node(each, partner) for each in tree.children(node)]
        return tree.rebuild(node, below)

    def gather(self, found: Sequence[Addend]) -> tree.Node | None:
        """The sum of addends; those of each partner, equal but for its name, as a sum over j."""
        if not self.pairs:
            return self.node(total_of(list(found)))
        alone, groups = list[Addend](), dict[int, list[Addend]]()
        parts = (_split([each]) if len(self._partners(each)) > 1 else [each] for each in found)
        for each in chain.from_iterable(parts):
            partners = self._partners(each)
            if len(partners) > 1:
                return None
            (groups.setdefault(partners.pop(), []) if partners else alone).append(each)
        if not groups:
            return self.node(total_of(alone))
        sums = [self.node(total_of(group), partner) for partner, group in groups.items()]
        if len(groups) != self.count - 1 or any(each != sums[0] for each in sums):
            return None
        whole, minus = sums[0], isinstance(sums[0], tree.Negate)
        sides = (tree.Name(self.other), tree.Name(self.index))
        operand = whole.operand if isinstance(whole, tree.Negate) else whole
        total: tree.Node = tree.Sum(indices=(self.other,), term=operand, sides=sides, sign="!=")
        total = tree.Negate(total) if minus else total
        if not alone:
            return total
        return tree.Binary(operator="+", left=self.node(total_of(alone)), right=total)

    def _partners(self, addend: Addend) -> set[int]:
        """The members other than the own one that an addend names."""
        names = (n.name for n in tree.walk(addend.tree) if isinstance(n, tree.Name))
        members = (self.member_of(each) for each in names)
        return {each[1] for each in members if each is not None and each[1] != self.own}


def _split(found: Sequence[Addend]) -> list[Addend]:
    """Addends of which none is a number times a sum."""
    split = list[Addend]()
    for each in found:
        vector = each.vector
        match vector:
            case tree.Binary(operator="+" | "-" as sign, left=a, right=b):
                turned = -each.number if sign == "-" else each.number
                pair = [replace(each, vector=a), replace(each, vector=b, number=turned)]
                split += _split(pair)
            case tree.Negate(operand=a):
                split += _split([replace(each, vector=a, number=-each.number)])
            case _:
                split.append(each)
    return split
