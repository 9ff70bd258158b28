"""Stars: the jets of rates that loop over a table of coefficients.

Comes in: a `Table`. Goes out: the products of components that a Taylor series needs, and Jets.

Each value of a table is a component of the state, or one times what depends on parameters alone.
So products with the same two components differ by constants: they are computed once at each order,
and the terms of the rates are such products with weights that are found before. A star is a few
products that share a component, whose coefficients are loaded once.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce
from itertools import accumulate
from typing import Final

from coadjoint.lower.jets import Cell, Jets
from coadjoint.lower.program import Add, Multiply, Node, Number, Program, Statement, Symbol, Table

#: Products of a star at the most (measured: docs/decisions/coefficient-tables.md).
MOST: Final = 6
#: Two components, the one of the lower number first.
_Pair = tuple[int, int]


@dataclass(frozen=True)
class Stars:
    """Products of two components, star by star, and the terms of the rates.

    Attributes:
        starts: Where the products of each star begin, and where those of the last one end.
        left: The component that the products of each star share.
        right: The other component of each product.
        bounds: Where the terms of each product begin, and where those of the last one end.
        rows: The rate that each term is added to.
        terms: The term that each entry of the table belongs to.
    """

    starts: tuple[int, ...]
    left: tuple[int, ...]
    right: tuple[int, ...]
    bounds: tuple[int, ...]
    rows: tuple[int, ...]
    terms: tuple[int, ...]

    def products(self) -> Iterator[tuple[int, int]]:
        """Both components of each product."""
        for star, left in enumerate(self.left):
            for place in range(self.starts[star], self.starts[star + 1]):
                yield left, self.right[place]


def find_stars(table: Table) -> Stars:
    """The products that the rows of a table need, by stars."""
    size = len(table.vectors[0]) - len(table.scaled)
    component = (*range(size), *table.scaled)
    pairs = [_sort(component[j], component[k]) for _, j, k, _ in table.entries]
    stars = list(_gather(pairs))
    products = [_sort(left, right) for left, rights in stars for right in rights]
    rows: dict[_Pair, list[int]] = {pair: [] for pair in products}
    for pair, (i, *_) in zip(pairs, table.entries, strict=True):
        if i not in rows[pair]:
            rows[pair].append(i)
    terms = {(pair, i): q for q, (pair, i) in enumerate((p, i) for p in products for i in rows[p])}
    return Stars(
        starts=tuple(accumulate((len(rights) for _, rights in stars), initial=0)),
        left=tuple(left for left, _ in stars),
        right=tuple(right for _, rights in stars for right in rights),
        bounds=tuple(accumulate((len(rows[pair]) for pair in products), initial=0)),
        rows=tuple(i for pair in products for i in rows[pair]),
        terms=tuple(terms[p, entry[0]] for p, entry in zip(pairs, table.entries, strict=True)),
    )


def _sort(a: int, b: int) -> _Pair:
    return (a, b) if a < b else (b, a)


def _gather(pairs: list[_Pair]) -> Iterator[tuple[int, list[int]]]:
    """All pairs as stars: a component and up to `MOST` others.

    The component is the one that most pairs have. The others are those with the fewest, so that
    few stars are small.
    """
    others: dict[int, set[int]] = {}
    for a, b in pairs:
        others.setdefault(a, set()).add(b)
        others.setdefault(b, set()).add(a)
    while others:
        left = max(others, key=lambda each: (len(others[each]), -each))
        chosen = sorted(others[left], key=lambda each: (len(others[each]), each))[:MOST]
        for right in chosen:
            others[left].discard(right)
            others[right].discard(left)
        for each in (left, *chosen):
            if each in others and not others[each]:
                del others[each]
        yield left, sorted(chosen)


def make_looped_jets(
    rhs: Program, stars: Stars, *, is_written_out: bool = True
) -> tuple[Jets, tuple[Statement, ...]]:
    """The recurrences of rates that loop over a table, and the weights of terms.

    What depends on parameters alone ends with the scales of the values that are scaled.

    Args:
        rhs: The Program of the rates.
        stars: Those of its table.
        is_written_out: Whether to write out what loops are, recurrences and weights.
    """
    table = rhs.table
    assert table is not None, rhs.name
    scales = tuple(
        Statement(f"_c{n}", scale, "parameters") for n, scale in enumerate(table.scales, 1)
    )
    jets = Jets(
        state=rhs.state,
        driving=(*rhs.inputs, *rhs.time),
        fixed=(*rhs.statements_at("parameters"), *scales),
        cells=(),
        rates=(),
    )
    if not is_written_out:
        return jets, ()
    products = [Multiply(Symbol(rhs.state[a]), Symbol(rhs.state[b])) for a, b in stars.products()]
    names = [f"_j{n}" for n, _ in enumerate(products, 1)]
    weights = _weigh(table, stars, [statement.name for statement in scales])
    sums: dict[int, Node] = {}
    for place, name in enumerate(names):
        for term in range(stars.bounds[place], stars.bounds[place + 1]):
            row, part = stars.rows[term], Multiply(Symbol(weights[term].name), Symbol(name))
            sums[row] = Add(sums[row], part) if row in sums else part
    cells = tuple(
        Cell(name=name, value=value, tail=None, depth=1)
        for name, value in zip(names, products, strict=True)
    )
    rates = tuple((sums[row], sums[row]) for row in range(len(rhs.outputs)))
    return replace(jets, cells=cells, rates=rates), weights


def _weigh(table: Table, stars: Stars, scales: list[str]) -> tuple[Statement, ...]:
    """The weight of each term: coefficients of the table, each times the scales of its factors."""
    size = len(table.vectors[0]) - len(scales)
    parts: dict[int, list[Node]] = {}
    for term, (_, j, k, c) in zip(stars.terms, table.entries, strict=True):
        part: Node = Number(c)
        for place in (j, k):
            part = Multiply(part, Symbol(scales[place - size])) if place >= size else part
        parts.setdefault(term, []).append(part)
    return tuple(
        Statement(f"_w{term + 1}", reduce(Add, parts[term]), "parameters")
        for term in range(len(stars.rows))
    )
