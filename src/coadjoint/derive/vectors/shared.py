"""Names for long vectors that equations by vectors have more than once.

Comes in: lines. Goes out: the same with names, and what these stand for. Read next:
`coadjoint.derive.vectors.members`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from coadjoint.derive.vectors.gradients import count_nodes
from coadjoint.derive.vectors.lines import VectorLine
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.shapes import shape_of, shapes

#: Names in the order in which they are given.
LETTERS = ("n", "k", "b", "c", "u", "w")
#: Nodes of a vector from which it has a name.
LONG = 8


def name_shared(
    lines: Sequence[VectorLine], known: Mapping[str, Shape], taken: Collection[str]
) -> tuple[list[VectorLine], dict[str, Shape]]:
    """Lines in which long vectors that are there twice have names, and the shapes of these.

    Those of a member and of its neighbour are one vector, seen from two places.
    """
    lines, added, named = list(lines), list[VectorLine](), dict[str, Shape]()
    for letter in (each for each in LETTERS if each not in taken):
        scope = {"pi": (), **known, **named}
        vectors = [v for line in (*lines, *added) for v in _list_vectors(line.right, scope)]
        counts = dict[tree.Node, int]()
        for each in vectors:
            own = _at_member(each)
            counts[own] = counts.get(own, 0) + 1
        shared = [each for each, count in counts.items() if count > 1 and count_nodes(each) >= LONG]
        if not shared:
            break
        longest = max(shared, key=count_nodes)
        index = next((n.index for n in tree.walk(longest) if isinstance(n, tree.Member)), None)
        lines, added = (
            [replace(each, right=_put(each.right, longest, letter, index)) for each in some]
            for some in (lines, added)
        )
        added.append(VectorLine(_call(letter, index, 0), longest))
        named[letter] = shape_of(longest, scope)
    return [*lines, *added], named


def _call(letter: str, index: str | None, shift: int) -> tree.Node:
    """A vector by its letter: of a member at some distance, or of none."""
    if index is None:
        return tree.Name(letter)
    return tree.Member(name=letter, index=index, shift=shift, indices=())


def _list_vectors(node: tree.Node, scope: Mapping[str, Shape]) -> Iterator[tree.Node]:
    """The vectors in a formula, without signs and sums, which stay outside of what has a name."""
    known = shapes(node, scope)
    for each in tree.walk(node):
        if len(known.get(id(each), ())) == 1 and not isinstance(each, tree.Negate | tree.Sum):
            yield each


def _at_member(node: tree.Node) -> tree.Node:
    """A formula as it is at the member whose neighbours it names last, at none of them before."""
    shifts = [each.shift for each in tree.walk(node) if isinstance(each, tree.Member)]
    return _shift(node, -min(shifts)) if shifts else node


def _shift(node: tree.Node, by: int) -> tree.Node:
    """A formula of another member."""
    if isinstance(node, tree.Member):
        return replace(node, shift=node.shift + by)
    below = tree.children(node)
    return tree.rebuild(node, [_shift(each, by) for each in below]) if below else node


def _put(node: tree.Node, vector: tree.Node, letter: str, index: str | None) -> tree.Node:
    """A formula with a letter in the place of a vector."""
    if _at_member(node) == vector:
        shifts = [each.shift for each in tree.walk(node) if isinstance(each, tree.Member)]
        return _call(letter, index, min(shifts, default=0))
    below = tree.children(node)
    return (
        tree.rebuild(node, [_put(each, vector, letter, index) for each in below]) if below else node
    )
