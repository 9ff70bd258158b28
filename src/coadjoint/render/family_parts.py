"""Functions of equal members in the words of a target: their parts, and where these read names.

Comes in: `coadjoint.lower.loops` records. Goes out: records that templates of families print.
Where a name is read is a text of the target:
`PLACES` has one function for each. Read next: `coadjoint.render.kernels`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from coadjoint.lower.loops import SUM, Loops, Part, Read
from coadjoint.lower.program import Node, Statement


@dataclass(frozen=True)
class ReadText:
    """A name and where it is read, in a target.

    Attributes:
        name: The name.
        place: Its place.
        step: In C, what says whether lanes have values of their own; "" if they always have.
        of: Whose it is: that of the ``member``, of a ``partner``, or of ``all``.
    """

    name: str
    place: str
    step: str = ""
    of: str = "member"


@dataclass(frozen=True)
class SumText:
    """A sum that is read: its name and number."""

    name: str
    place: int


@dataclass(frozen=True)
class OutputText:
    """A result, and in C its place."""

    value: Node
    place: str


@dataclass(frozen=True)
class PartText:
    """A part as the templates read it."""

    reads: tuple[ReadText, ...]
    sums: tuple[SumText, ...]
    statements: tuple[Statement, ...]
    outputs: tuple[OutputText, ...]


@dataclass(frozen=True)
class TotalsText:
    """Terms that are added up in one loop, and the number of the first sum."""

    part: PartText
    over: str
    before: int
    after: int
    first: int


@dataclass(frozen=True)
class SolveText:
    """What is solved for before a function begins, as `Solve` has it."""

    factors: PartText
    blocks: int
    of: int
    level: bool


@dataclass(frozen=True)
class ProductsText:
    """What is computed of matrices before a function begins, as `Products` has it."""

    scale: PartText | None
    product: str
    blocks: int


@dataclass(frozen=True)
class FamilyFunction:
    """A function of a family as the templates read it.

    Attributes:
        name: Its name.
        summary: What it is.
        costs: Its operations, as lines.
        shape: Of its result where that does not depend on N.
        blocks: Rows of its first argument for each member.
        rows: Further rows of it, which all members share.
        reach: Members at both ends of which each is computed alone.
        ends_before: Members at the beginning that have rates of their own.
        ends_after: Such members at the end.
        partners: As `Loops` has it; likewise ``pair_sums``, ``member``, ``ends``, ``totals`` and
            ``finish``.
        solve: What is solved for first.
        products: What is computed of matrices first.
        sums: How many sums there are in a function of sums.
    """

    name: str
    summary: str
    costs: list[str]
    shape: str
    blocks: int
    rows: int
    reach: int
    ends_before: int
    ends_after: int
    partners: PartText | None
    pair_sums: int
    member: PartText | None
    ends: tuple[tuple[int, PartText], ...]
    totals: tuple[TotalsText, ...]
    finish: PartText | None
    solve: SolveText | None
    products: ProductsText | None
    sums: int


def _row(read: Read, member: str) -> str:
    """The row of a name in an array, without zeros: ``2 * size + i``."""
    blocks = "size" if read.blocks == 1 else f"{read.blocks} * size"
    addends = [str(read.rows)] * bool(read.rows) + [blocks] * bool(read.blocks)
    return " + ".join([*addends, member] if member else addends) or "0"


def _fixed_row(read: Read) -> str:
    """The row of what does not depend on i: of all members, or of one at an end."""
    if read.single is None:
        return _row(read, "")
    if read.single >= 0:
        return _row(replace(read, rows=read.rows + read.single), "")
    return f"{_row(replace(read, blocks=read.blocks + 1), '')} - {-read.single}"


def _python_place(read: Read, wraps: bool) -> str:
    """Where Python and NumPy read."""
    if read.array == "sizes":
        return "float(size)"
    if read.shift is None:
        return f"{read.array}[{_fixed_row(read)}]"
    member = "j" if read.of_partner else "i"
    if read.shift:
        sign = "+" if read.shift > 0 else "-"
        member = f"i {sign} {abs(read.shift)}"
        member = f"({member}) % size" if wraps else member
    return f"{read.array}[{_row(read, member)}]"


def _script_place(read: Read, wraps: bool) -> str:
    """Where JavaScript reads; its remainder of a negative number is negative."""
    place = _python_place(read, wraps).replace("float(size)", "size")
    return re.sub(r"\(i - (\d+)\) % size", r"(i + size - \1) % size", place)


def _c_place(read: Read, wraps: bool) -> str:
    """Where C reads, the address of the first lane."""
    row = _fixed_row(read).replace("size", "_run.size")
    if read.shift is not None:
        member = "_j" if read.of_partner else "_run.i"
        if read.shift:
            sign, word = ("+", "after") if read.shift > 0 else ("-", "before")
            member = f"_run.i {sign} {abs(read.shift)}"
            if wraps:
                member = f"{word}(_run.i, {abs(read.shift)}, _run.size)"
        row = _row(read, member).replace("size", "_run.size").replace("_run._run.", "_run.")
    if read.array == "sizes":
        return "_run.sizes"
    if read.array == "time":
        return "_run.time + _run.n * _run.timed"
    if read.array == "state":
        return f"_run.state + ({row}) * _run.stride + _run.n"
    if read.array == "inputs":
        return f"_run.inputs + ({row}) * _run.inputs_row + _run.n * _run.driven"
    return f"_run.parameters + ({row}) * _run.row + _run.n * _run.own"


def _c_step(read: Read) -> str:
    """What says in C whether lanes have values of their own."""
    if read.array == "sizes":
        return "0"
    if read.array == "time":
        return "_run.timed"
    if read.array == "state":
        return "_batch" if read.of_partner or read.shift is None else ""
    if read.array == "inputs":
        alike = read.shift is None or read.of_partner
        return "_run.driven" if alike else "!_batch || _run.driven"
    if read.single is not None:
        return "_indexed"
    return "_shared" if read.shift is None or read.of_partner else "_indexed"


#: Where each target reads a name of a part, in a ring or not.
PLACES: Final[dict[str, Callable[[Read, bool], str]]] = {
    "c": _c_place,
    "numpy": _python_place,
    "python": _python_place,
    "js": _script_place,
}


def arrange_loops(loops: Loops, target: str, summary: str, costs: list[str]) -> FamilyFunction:
    """A function as the templates of a target read it."""
    firsts, count = list[int](), 0
    for each in loops.totals:
        firsts.append(count)
        count += len(each.part.program.outputs)
    reach = max([part.reach for part in loops.parts])
    edges = [reach, *(max(each.before, each.after) for each in loops.totals)]
    edges += [max(place + 1, -place) for place, _ in loops.ends]

    def text(part: Part | None, *, to: str = "") -> PartText | None:
        return None if part is None else _arrange(part, loops.wraps, target, to)

    member, finish = text(loops.member, to="member"), text(loops.finish, to="total")
    return FamilyFunction(
        name=loops.name,
        summary=summary,
        costs=costs,
        shape="" if loops.shape is None else str(loops.shape),
        blocks=loops.blocks,
        rows=loops.rows,
        reach=max(edges),
        ends_before=len(loops.first_ends),
        ends_after=len(loops.last_ends),
        partners=text(loops.partners),
        pair_sums=loops.pair_sums,
        member=member,
        ends=tuple(
            (place, _arrange(part, loops.wraps, target, "member")) for place, part in loops.ends
        ),
        totals=tuple(
            TotalsText(
                part=_arrange(each.part, loops.wraps, target, ""),
                over=each.over,
                before=each.before,
                after=each.after,
                first=first,
            )
            for each, first in zip(loops.totals, firsts, strict=True)
        ),
        finish=finish,
        solve=_arrange_solve(loops, target),
        products=_arrange_products(loops, target),
        sums=count,
    )


def _arrange_solve(loops: Loops, target: str) -> SolveText | None:
    """What is solved for first."""
    solve = loops.solve
    if solve is None:
        return None
    factors = _arrange(solve.factors, loops.wraps, target, "")
    return SolveText(factors, solve.blocks, solve.of, solve.level)


def _arrange_products(loops: Loops, target: str) -> ProductsText | None:
    """What is computed of matrices first."""
    products = loops.products
    if products is None:
        return None
    scale = None
    if products.scale is not None:
        scale = _arrange(products.scale, loops.wraps, target, "")
    return ProductsText(scale, products.product, products.blocks)


def _arrange(part: Part, wraps: bool, target: str, to: str) -> PartText:
    """A part as the templates of a target read it."""
    place, program = PLACES[target], part.program
    names = program.state[len(part.reads) :]
    rows = {"": "", "member": "({n} * _run.size + _run.i)", "total": "{n}"}[to]
    return PartText(
        reads=tuple(
            ReadText(
                name=read.name,
                place=place(read, wraps),
                step=_c_step(read) if target == "c" else "",
                of="all" if read.shift is None else "partner" if read.of_partner else "member",
            )
            for read in part.reads
        ),
        sums=tuple(SumText(name, int(name.removeprefix(SUM))) for name in names),
        statements=program.statements,
        outputs=tuple(
            OutputText(
                output.value,
                f"_run.out + {rows.format(n=n)} * _run.out_stride + _run.n" if to else "",
            )
            for n, output in enumerate(program.outputs)
        ),
    )
