"""Render, solvers of families: the recurrences of a member as the templates of solvers read them.

Comes in: the rates of a family as loops. Goes out: a `FamilySolverText`, plain records that
templates loop over. Names of coefficients are written with their order, as in all solvers.
Read next: ``templates/c/family_solver.c.j2`` and ``templates/numpy/family_solver.py.j2``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from coadjoint.elementary import ELEMENTARY
from coadjoint.lower.family_jets import PartJets, is_constant, make_family_jets
from coadjoint.lower.loops import SUM, Loops, Read
from coadjoint.lower.program import Call, list_names, walk
from coadjoint.render.recurrences import (
    Line,
    Stage,
    arrange_first,
    arrange_stages,
    set_order,
)

#: What parts compute, by the beginnings of their names.
_SUMMARIES = {
    "partners": "Terms of sums over partners",
    "member": "Rates of a member",
    "end": "Rates of a member at an end",
}


@dataclass(frozen=True)
class Place:
    """Where a name of a part is read: ``near(0, -1)`` is the first component of the member before.

    Attributes:
        name: The name.
        function: Which kind of place it is.
        arguments: Which one of these.
        moves: Whether it has a coefficient of each order.
    """

    name: str
    function: str
    arguments: tuple[int, ...]
    moves: bool

    @property
    def text(self) -> str:
        """Its arguments as they are printed."""
        return ", ".join(map(str, self.arguments))


@dataclass(frozen=True)
class PartText:
    """The recurrences of a part as templates print them.

    Attributes:
        name: In texts.
        summary: What it computes.
        places: Where its names are read.
        kept: Names of arrays of coefficients.
        fixed: What depends on parameters alone.
        first: Order 0, results among it.
        stages: Each order k > 0.
        results: Results at an order k > 0.
        single: Names of what is computed at order 0 and read at later ones.
        count: How many results there are.
        products: How many sums over orders there are.
    """

    name: str
    summary: str
    places: tuple[Place, ...]
    kept: tuple[str, ...]
    fixed: tuple[Line, ...]
    first: tuple[Line, ...]
    stages: tuple[Stage, ...]
    results: tuple[Line, ...]
    single: tuple[str, ...]
    count: int
    products: int


@dataclass(frozen=True)
class FamilySolverText:
    """The recurrences of a family as templates print them.

    Attributes:
        partners: Terms of pairs, or None.
        member: Rates of a member.
        ends: Rates of those at the ends of an open chain, with their numbers.
        before: How many members at the beginning have rates of their own.
        after: How many at the end.
        components: Rows of the state for each member.
        inputs: Inputs of each member, whose coefficients stand below those of the state.
        inputs_before: Inputs that all members share.
        driving: Rows of what drives all members alike: these inputs, and the time below them.
        shared: Parameters that all members share.
        indexed: Parameters of each member.
        sides: Signs at the kinks of each member, which stand below these.
        reach: How far the members are apart that a part reads, at the most.
        wraps: Whether the last member is followed by the first where neighbours are read.
        functions: Elementary functions that are called, with their arguments, sqrt left out.
        orders: Whether factors k are read.
        branches: Whether rates have branch points or jumps.
        solves: Whether something is solved for first, so that there are no recurrences.
    """

    partners: PartText | None
    member: PartText
    ends: tuple[tuple[int, PartText], ...]
    before: int
    after: int
    components: int
    inputs: int
    inputs_before: int
    driving: int
    shared: int
    indexed: int
    sides: int
    reach: int
    wraps: bool
    functions: tuple[tuple[str, str], ...]
    orders: bool
    branches: bool
    solves: bool

    @property
    def parts(self) -> tuple[PartText, ...]:
        """All of them, in order; none where there are no recurrences."""
        if self.solves:
            return ()
        pairs = () if self.partners is None else (self.partners,)
        return (*pairs, self.member, *(part for _, part in self.ends))


@dataclass(frozen=True)
class Counts:
    """How many rows arrays have that all members share, and for each member.

    Attributes:
        shared: Parameters that all members share.
        indexed: Parameters of each member.
        inputs_before: Inputs that all members share.
        inputs: Inputs of each member.
        time: 1 where kernels take the time.
    """

    shared: int
    indexed: int
    inputs_before: int = 0
    inputs: int = 0
    time: int = 0


def arrange_family(rates: Loops, counts: Counts) -> FamilySolverText:
    """The recurrences of rates.

    Args:
        rates: The function ``rhs`` of a family, or ``sided_rhs``.
        counts: What else it reads.
    """
    parts = [_arrange_part(each, counts, rates.components) for each in make_family_jets(rates)]
    by_name = {part.name: part for part in parts}
    lines = [line for part in parts for line in list_lines(part)]
    calls = {n.function for line in lines for n in walk(line.value) if isinstance(n, Call)}
    read = {name for line in lines for name in list_names(line.value)}
    return FamilySolverText(
        partners=by_name.get("partners"),
        member=by_name["member"],
        ends=tuple((place, by_name[f"end_{n}"]) for n, (place, _) in enumerate(rates.ends)),
        before=len(rates.first_ends),
        after=len(rates.last_ends),
        components=rates.components,
        sides=rates.blocks - rates.components,
        inputs=counts.inputs,
        inputs_before=counts.inputs_before,
        driving=counts.inputs_before + counts.time,
        shared=counts.shared,
        indexed=counts.indexed,
        reach=max(part.reach for part in rates.parts),
        wraps=rates.wraps,
        functions=tuple((f, "ab"[: ELEMENTARY[f].arity]) for f in sorted(calls - {"sqrt"})),
        orders="_orders[_m]" in read,
        solves=not rates.has_series,
        branches=any(ELEMENTARY[each].positive or ELEMENTARY[each].jumps[0] for each in calls),
    )


def list_lines(part: PartText) -> Iterator[Line]:
    """All lines of a part, in order."""
    yield from (*part.fixed, *part.first)
    for stage in part.stages:
        yield from (*stage.starts, *stage.terms, *stage.lines)
    yield from part.results


def _arrange_part(part: PartJets, counts: Counts, components: int) -> PartText:
    """The recurrences of a part."""
    jets = part.jets
    moving = jets.kept.union(jets.state)
    first = [*arrange_first(replace(jets, rates=()), moving)]
    results = [(f"_out[{n}]", rate) for n, rate in enumerate(jets.rates)]
    first += [Line(name, set_order(whole, "0", moving)) for name, (whole, _) in results]
    later = tuple(Line(name, set_order(tail, "_k", moving)) for name, (_, tail) in results)
    stages = tuple(arrange_stages(jets, moving, is_one_loop=False))
    fixed = tuple(Line(each.name, each.value) for each in jets.fixed)
    text = PartText(
        name=part.name,
        summary=_SUMMARIES[part.name.split("_")[0]],
        places=tuple(_list_places(part, counts, components)),
        kept=tuple(cell.name for cell in jets.cells if cell.name in moving),
        fixed=fixed,
        first=tuple(first),
        stages=stages,
        results=later,
        single=(),
        count=len(results),
        products=jets.products,
    )
    read = _read(later, *((*s.starts, *s.terms, *s.lines) for s in stages))
    kept, needed = list[Line](), set(read)
    for line in reversed((*fixed, *first)):
        if not line.is_new or line.name in needed:
            kept.append(line)
            needed |= set(list_names(line.value))
    early = kept[::-1]
    names = {line.name for line in fixed}
    again = {line.name for stage in stages for line in (*stage.starts, *stage.lines)}
    return replace(
        text,
        fixed=tuple(line for line in early if line.name in names),
        first=tuple(line for line in early if line.name not in names),
        single=tuple(line.name for line in early if line.is_new and line.name in read - again),
    )


def _read(*groups: Iterable[Line]) -> frozenset[str]:
    """The names that lines read."""
    return frozenset(name for lines in groups for line in lines for name in list_names(line.value))


def _list_places(part: PartJets, counts: Counts, components: int) -> Iterator[Place]:
    """Where the names of a part are read, as far as its recurrences read them."""
    jets = part.jets
    nodes = [each.value for each in jets.fixed]
    nodes += [node for cell in jets.cells for node in (cell.value, cell.tail) if node is not None]
    nodes += [node for rate in jets.rates for node in rate]
    read = {name for node in nodes for name in list_names(node)}
    for place in (_find_place(each, counts, components) for each in part.part.reads):
        if place.name in read:
            yield place
    for name in part.program.state:
        if name.startswith(SUM) and name in read:
            yield Place(name, "total", (int(name.removeprefix(SUM)),), moves=True)


def _find_place(read: Read, counts: Counts, components: int) -> Place:
    """Where one name is read."""
    if read.array == "sizes":
        return Place(read.name, "counted", (read.rows,), moves=False)
    if read.array == "time":
        return Place(read.name, "driving", (counts.inputs_before,), moves=True)
    if read.shift is None:
        moves = read.array == "inputs"
        return Place(read.name, "driving" if moves else "shared", (read.rows,), moves)
    moves, function = not is_constant(read, components), "partner" if read.of_partner else "own"
    before = {"state": 0, "parameters": counts.shared, "inputs": counts.inputs_before}
    assert read.rows == before[read.array], read
    block = read.blocks + (components if read.array == "inputs" else 0)
    if read.array == "state" and not moves:  # a given sign, below the parameters
        block += counts.indexed - components
    arguments: tuple[int, ...] = (block,)
    if read.shift and not read.of_partner:
        function, arguments = "near", (block, read.shift)
    return Place(read.name, function if moves else f"{function}_value", arguments, moves)
