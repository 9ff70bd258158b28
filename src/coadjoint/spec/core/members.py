"""Members: how many of them an index counts, and what formulas name of them.

Comes in: a tree with sums over members and with quantities of a member. Goes out: the indices that
no sum counts, and how far the neighbours are that a term reads.
Read next: `coadjoint.spec.core.written_out`, which writes formulas out for a number of members.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.tree import (
    Call,
    Index,
    Member,
    Name,
    Node,
    Sum,
    children,
    walk,
)


def member_name(name: str, member: int) -> str:
    """What a quantity of one member is called where all members are written out.

    >>> member_name("S", 3)
    'S_3'
    """
    return f"{name}_{member}"


@dataclass(frozen=True)
class Members:
    """How many members there are, and what each of them has.

    Members have places from 0 on; in formulas the first one has the number ``first``.

    Attributes:
        index: The index that counts them.
        count: How many are written out.
        periodic: Whether the last one is followed by the first.
        names: What each member has: variables and parameters.
        bound: Of keys that are written out for each member, the place of the member.
        first: The number of the first member.
        number: What formulas call the number of members; "" for nothing.
        taken: What the spec declares, so that no index has its name.
        scalars: What has neither an index nor components.
        singles: What has an index and one component of each member.
        from_zero: Whether names count from 0 all the same: these are a few of N members.
        keeps_number: Whether formulas keep their name of the number, which is that of all members.
    """

    index: str
    count: int
    periodic: bool
    names: frozenset[str]
    bound: Mapping[KeyPath, int] = field(default_factory=dict)
    first: int = 0
    number: str = ""
    taken: frozenset[str] = frozenset()
    scalars: frozenset[str] = frozenset()
    singles: frozenset[str] = frozenset()
    from_zero: bool = False
    keeps_number: bool = False

    def place(self, member: int) -> int | None:
        """The member at a place from 0; None beyond the end of an open chain."""
        if self.periodic:
            return member % self.count
        return member if 0 <= member < self.count else None

    @property
    def last(self) -> str:
        """What formulas call the last member: a few stand for any number of them."""
        if not self.from_zero:
            return str(self.first + self.count - 1)
        return (self.number or "N") + " - 1" * (self.first == 0)

    def find_alone(self, node: Node) -> int | None:
        """The number of a member that a node names, and no sum counts; None if it names none.

        It counts from 0, or from N as -1, -2 and so on, as formulas do.
        """
        match node:
            case Index(name=name, indices=(number, *_)) if name in self.names:
                return number - self.first
            case Member(name=name, index=index, shift=shift) if name in self.names:
                return shift - self.first if index and index == self.number else None
        return None

    def run(self, node: Node, index: str = "") -> range:
        """The members for which a term reads no neighbour beyond the end of an open chain."""
        before, after = (0, 0) if self.periodic else reach(node, index, self.names)
        return range(before, self.count - after)

    def member_of(self, key: KeyPath) -> int | None:
        """The place of the member that a key is written out for."""
        keys = (key[:length] for length in range(len(key), 0, -1))
        return next((self.bound[each] for each in keys if each in self.bound), None)


def reach(node: Node, index: str = "", names: Collection[str] = ()) -> tuple[int, int]:
    """How many members a term reads before the one that the index counts, and after it."""
    parts = (part for part in walk(node) if isinstance(part, Member))
    own = (p for p in parts if index in ("", p.index) and (not names or p.name in names))
    shifts = [0, *(part.shift for part in own)]
    return -min(shifts), max(shifts)


def find_free(tree: Node, members: Members) -> dict[str, Node]:
    """Indices that no sum around them counts, each where it stands first."""
    free: dict[str, Node] = {}
    pending: list[tuple[Node, frozenset[str]]] = [(tree, frozenset())]
    while pending:
        node, bound = pending.pop()
        index = node.index if isinstance(node, Member) else ""
        if isinstance(node, Name) and node.name == members.index:
            index = node.name
        if index and index not in (*bound, members.number):
            free.setdefault(index, node)
        if isinstance(node, Sum):
            bound |= {*node.indices}
        elif _is_band(node):
            bound |= {members.index}
        pending.extend((each, bound) for each in reversed(children(node)))
    return free


def tell_count(members: Members, name: str = "n") -> str:
    """How the number of members, and so the last one, is named."""
    if members.number or name == members.index:
        return ""
    last = f"x[{name}]" if members.first else f"x[{name}-1]"
    told = f"{name} is the number of members, and {last} of the last."
    return f'With count = "{name}" in [index], {told}'


def _is_band(node: Node) -> bool:
    return isinstance(node, Call) and node.function == "tridiagonal"
