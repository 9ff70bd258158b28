"""Loops over members: Programs of one member, of a pair and of sums, and where they read names.

Sums have a stated order, the same in every target (docs/decisions/family-kernels.md). Blocks are
`LANES` members, from 0 on; the rest are those behind the last whole block, and all if they are less
than `FEWEST`. The sum over the partners of a member of a block goes through its own block in order;
the blocks before it in order; the blocks behind it, in `LANES` sums, of which sum l has the partner
l of each block, and which are added in order; the rest. The sum of a member of the rest goes
through all partners from 0 on. A sum over members, or over pairs by their first member, has `LANES`
parts: part l adds up the members l, l + LANES, l + 2 LANES and so on, and then the parts are added
up in order. All begin with 0.0.

The terms of a pair are computed together: those of member i, then those of member j. Where both lie
in whole blocks that differ, i is the one of the first of them. Else each member is member i once,
and takes the first half.
Comes in: nothing. Goes out: the records of a function of equal members. Read next:
`coadjoint.lower.families`, which makes them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from coadjoint.families import LANES
from coadjoint.lower.program import Program

#: The fewest members that are taken in blocks: for less there is nothing to gain.
FEWEST: Final = 5 * LANES
#: What the names of sums begin with; their number follows.
SUM: Final = "_sum"
#: The products of matrices that functions read.
PRODUCTS: Final[Mapping[str, str]] = {
    "rhs": "commutator",
    "jacobian_vector": "commutator",
    "bracket_vector": "commutator",
    "sandwich": "sandwich",
}
#: Functions that are given the vector by which they multiply.
GIVEN: Final = ("bracket_vector", "sandwich")


@dataclass(frozen=True)
class Read:
    """Where a name of a part is read.

    The row is ``rows + blocks * N``, and of indexed arrays the member's number is added to it.

    Attributes:
        name: In texts.
        array: ``state``, ``parameters``, ``inputs``, ``time``, or ``sizes``, which is N.
        rows: Rows before it that do not depend on N.
        blocks: Rows before it for each member.
        shift: How far behind member i the member is that it belongs to; None if all members share
            it.
        of_partner: Whether it belongs to member j of a pair.
        single: The number of the member to which it belongs, whatever i is, counted from 0 or from
            N as -1, -2 and so on; None if it is none of these.
    """

    name: str
    array: str
    rows: int
    blocks: int
    shift: int | None = 0
    of_partner: bool = False
    single: int | None = None


@dataclass(frozen=True)
class Part:
    """What is computed of one member or pair.

    Attributes:
        program: Its statements and outputs; its first argument is all that it reads, in which sums
            follow what is in ``reads``.
        reads: Where the others are.
    """

    program: Program
    reads: tuple[Read, ...]

    @property
    def reach(self) -> int:
        """How far the members are apart that it reads, at the most."""
        return max((abs(read.shift or 0) for read in self.reads), default=0)


@dataclass(frozen=True)
class Totals:
    """Terms of sums over members or pairs that are added up in one loop.

    Attributes:
        part: The terms of member i, or of a pair i < j.
        over: ``members`` or ``pairs``.
        before: The first i.
        after: How many members from the end the last i is.
    """

    part: Part
    over: str
    before: int
    after: int


@dataclass(frozen=True)
class Solve:
    """Components that are solved for before a function begins.

    Each run of ``blocks`` rows for each member that the function is given is followed by one more,
    the solution of ``sum_r a_|r| u[i+r] = m[i]``; rows of parts are those of all together.

    Attributes:
        factors: ``a_0, a_1, ...``, of parameters and N.
        blocks: Rows of a run for each member.
        of: The place in a run of the right side.
        level: Whether it has the mean 0, as in `coadjoint.families.Solved`.
    """

    factors: Part
    blocks: int
    of: int
    level: bool


@dataclass(frozen=True)
class Products:
    """Entries of matrices that are computed before a function begins (`MatrixMotion`).

    The function is given runs of rows, W and, where ``given``, V, for each member. Parts read runs
    of W, V and a product of both. The product of a further run, which is a vector, is that of its W
    and the first V plus that of the first W and its V: the derivative along the vector.

    Attributes:
        scale: The factor of the equation for V; None where V is given.
        product: ``commutator`` for [W, V], ``sandwich`` for V W V, or "" for none.
        surface: Whose Laplacian the equation has, as in `coadjoint.families.Index`.
    """

    scale: Part | None
    product: str
    surface: str

    @property
    def blocks(self) -> int:
        """Rows of a run for each member, as they are given."""
        return 1 if self.scale is not None else 2


@dataclass(frozen=True)
class Loops:
    """One function of a family.

    Attributes:
        name: One of `coadjoint.kernel_functions`.
        wraps: Whether member N-1 is followed by member 0 where neighbours are read.
        blocks: Rows of its first argument for each member.
        rows: Further rows of it, which all members share.
        solve: What is solved for first, if anything.
        products: What is computed first of entries of matrices.
        shape: Of a result that does not depend on N, else None.
        partners: Terms of the sums over partners, if there are any: of member i, then of member j.
        member: The rates of member i.
        ends: Of an open chain, those of members 0, 1, ... and -1, -2, ... in this order.
        totals: What is added up, of a function of sums.
        finish: What follows from the sums, of such a function.
    """

    name: str
    wraps: bool
    blocks: int
    shape: tuple[int, ...] | None
    partners: Part | None = None
    member: Part | None = None
    ends: tuple[tuple[int, Part], ...] = ()
    totals: tuple[Totals, ...] = ()
    finish: Part | None = None
    rows: int = 0
    solve: Solve | None = None
    products: Products | None = None

    @property
    def has_series(self) -> bool:
        """Whether it has recurrences: all that is read is added up of members and pairs."""
        return self.solve is None and self.products is None

    @property
    def pair_sums(self) -> int:
        """How many sums over partners each member has."""
        return 0 if self.partners is None else len(self.partners.program.outputs) // 2

    @property
    def components(self) -> int:
        """How many results each member has."""
        return 0 if self.member is None else len(self.member.program.outputs)

    @property
    def parts(self) -> tuple[Part, ...]:
        """All parts, in order."""
        listed = [self.partners, self.member, *(part for _, part in self.ends)]
        listed += [*(each.part for each in self.totals), self.finish]
        listed += [] if self.solve is None else [self.solve.factors]
        listed += [] if self.products is None else [self.products.scale]
        return tuple(part for part in listed if part is not None)

    @property
    def first_ends(self) -> tuple[Part, ...]:
        """The parts of members 0, 1 and so on."""
        return tuple(part for member, part in self.ends if member >= 0)

    @property
    def last_ends(self) -> tuple[Part, ...]:
        """The parts of the last members, in the order of the members."""
        return tuple(part for member, part in sorted(self.ends, key=_by_member) if member < 0)


def _by_member(end: tuple[int, Part]) -> int:
    return end[0]
