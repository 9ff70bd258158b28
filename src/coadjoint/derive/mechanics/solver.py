r"""Solving in the kernel: ``A x = b`` as straight-line definitions instead of an inverse.

A symmetric matrix whose leading minors do not vanish is :math:`A = L D L^T` with ones on the
diagonal of L, so that ``L y = b``, ``D z = y`` and ``L^T x = z`` are solved entry by entry. Each
entry of L, D, y and z becomes a definition with a leading underscore, which no spec can declare;
it is never expanded, since the closed form of a sixth velocity would fill a book. The columns of
W = L D are computed before they are divided, and a pivot that divides several has one reciprocal.
A matrix that is not symmetric, as where friction is proportional to a reaction, is :math:`A = W U`
with ones on the diagonal of U, whose rows are computed with the columns of W; then ``W z = b``
and ``U x = z``. For a symmetric one U is the transpose of L. Pivots are the same quotients of
leading minors. What is identically zero in W, y, z or x is left out, and x is then 0.
More than `WRITTEN` unknowns of a symmetric matrix are not written out: the kernel has a loop
(`coadjoint.exact.factored`), and what it gives are symbols that rest on A and b.
Comes in: elements of A and b. Goes out: definitions.
Read next: `coadjoint.derive.mechanics.decided`, which finds the zeros;
`coadjoint.derive.mechanics.solution_defects`, what must vanish for definitions to be right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.iteration import Newton
from coadjoint.exact import Element, Field
from coadjoint.exact.factored import factor, place_of

#: Unknowns of a symmetric matrix up to which a solve is written out; of more it is a loop
#: (docs/decisions/coupled-velocities.md).
WRITTEN: Final = 12
#: A name and its value, in terms of state, parameters and names defined before.
Definition = tuple[str, Element]
Rows = Sequence[Sequence[Element]]


def pivot_name(i: int) -> str:
    """Name of the entry of D in the place ``i``, counted from 0."""
    return f"_d{i + 1}"


def reciprocal_name(i: int) -> str:
    """Name of one over the entry of D in the place ``i``."""
    return f"_r{i + 1}"


def column_name(i: int, j: int) -> str:
    """Name of the entry of ``W = L D`` in row ``i`` and column ``j`` below the diagonal."""
    return f"_w{i + 1}_{j + 1}"


def factor_name(i: int, j: int) -> str:
    """Name of the entry of L in row ``i`` and column ``j`` below the diagonal."""
    return f"_l{i + 1}_{j + 1}"


def upper_name(i: int, j: int) -> str:
    """Name of the entry of U in row ``i`` and column ``j`` above the diagonal."""
    return f"_u{i + 1}_{j + 1}"


def forward_name(i: int) -> str:
    """Name of the entry of y in the place ``i``."""
    return f"_y{i + 1}"


def solution_name(i: int) -> str:
    """Name of the unknown in the place ``i`` as a loop gives it."""
    return f"_sol{i + 1}"


def loop_pivot_name(i: int) -> str:
    """Name of the entry of D in the place ``i`` as a loop gives it."""
    return f"_piv{i + 1}"


def loop_names(block: Sequence[int]) -> list[str]:
    """Every name that the solve of a block of places needs where it is a loop."""
    makes = (pivot_name, loop_pivot_name, solution_name)
    return [make(i) for make in makes for i in block]


def names_for(block: Sequence[int]) -> list[str]:
    """Every name that the solve of a block with a symmetric matrix needs."""
    return loop_names(block) if len(block) > WRITTEN else solver_names(block)


def solver_names(block: Sequence[int]) -> list[str]:
    """Every name that the solve of a block of places may define where it is written out.

    >>> solver_names((0, 2))
    ['_d1', '_d3', '_r1', '_r3', '_w3_1', '_l3_1', '_u1_3', '_y1', '_y3', '_z1', '_z3']
    """
    pairs = [(i, j) for n, i in enumerate(block) for j in block[:n]]
    of_pairs = [make(*pair) for make in (column_name, factor_name) for pair in pairs]
    of_pairs += [upper_name(j, i) for i, j in pairs]
    pivots, ones, y, z = (
        [make(i) for i in block]
        for make in (pivot_name, reciprocal_name, forward_name, scaled_name)
    )
    return [*pivots, *ones, *of_pairs, *y, *z]


def scaled_name(i: int) -> str:
    """Name of the entry of z in the place ``i``."""
    return f"_z{i + 1}"


@dataclass(frozen=True)
class Solve:
    """``A x = b`` for one block of coupled unknowns.

    Attributes:
        matrix: A, its leading minors not identically zero.
        known: b.
        block: Places of the unknowns, which number the intermediates.
        names: Names of the unknowns.
        symmetric: Whether A is, so that it is read below the diagonal alone.
        newton: What finds the guess that A and b name, where they name one.
    """

    matrix: Rows
    known: Sequence[Element]
    block: Sequence[int]
    names: Sequence[str]
    symmetric: bool = True
    newton: Newton | None = None

    @property
    def is_loop(self) -> bool:
        """Whether the kernel solves by a loop."""
        return self.symmetric and self.newton is None and len(self.block) > WRITTEN

    @property
    def entries(self) -> list[Element]:
        """A on and below the diagonal, row by row."""
        return [entry for i, row in enumerate(self.matrix) for entry in row[: i + 1]]

    @property
    def sides(self) -> list[Element]:
        """What a loop reads: A on and below the diagonal, and b."""
        return [*self.entries, *self.known]

    @property
    def intermediates(self) -> list[str]:
        """The names that stand for what the kernel computes on its way to the unknowns."""
        return loop_names(self.block) if self.is_loop else solver_names(self.block)

    @property
    def operations(self) -> int:
        """About how many operations are written out; none of a loop."""
        cubes = 1 if self.symmetric else 2
        return 0 if self.is_loop else cubes * len(self.block) ** 3 // 3

    @property
    def loop_symbols(self) -> list[str]:
        """The symbols for what a loop gives: the pivots, then the unknowns."""
        return [make(i) for make in (loop_pivot_name, solution_name) for i in self.block]

    def run_loop(self, symbol: str, value: Callable[[Element], Any]) -> dict[str, Any]:
        """What a symbol stands for, and all pivots or all unknowns with it.

        Args:
            symbol: Of a pivot, which rests on A alone, or of an unknown.
            value: Takes elements to an arithmetic.
        """
        factored, count = factor(list(map(value, self.entries))), len(self.block)
        if symbol in self.loop_symbols[:count]:
            pivots = (factored[place_of(n, n)] for n in range(count))
            return dict(zip(self.loop_symbols, pivots, strict=False))
        unknowns = factored.solve(list(map(value, self.known)))
        return dict(zip(self.loop_symbols[count:], unknowns, strict=True))

    @property
    def mirrored(self) -> Rows:
        """The symmetric matrix that agrees with A on and below the diagonal."""
        size = range(len(self.matrix))
        return tuple(tuple(self.matrix[max(i, j)][min(i, j)] for j in size) for i in size)


def solve_in_kernel(field: Field, solve: Solve, decided: Decided | None = None) -> list[Definition]:
    """The definitions that solve ``A x = b``, in the order in which they can be computed.

    Where a pivot is zero at run time, the unknowns are infinite or not a number, as with any other
    division by zero.

    Args:
        field: Where all names are symbols.
        solve: What to solve.
        decided: The definitions on which A and b rest; by default they rest on none.

    >>> field = Field(["a", "b", "c", "u", "v", "x", "y", *solver_names((0, 1))])
    >>> a, b, c, u, v = (field[name] for name in "abcuv")
    >>> solve = Solve(((a, b), (b, c)), (u, v), (0, 1), "xy")
    >>> for name, value in solve_in_kernel(field, solve):
    ...     print(name, "=", value)
    _d1 = a
    _r1 = 1/_d1
    _l2_1 = _r1*b
    _z1 = _r1*u
    _d2 = -_l2_1*b + c
    _y2 = -_z1*b + v
    _z2 = _y2/_d2
    y = _z2
    x = -_l2_1*y + _z1
    """
    decided = decided or Decided(field, ())
    if solve.is_loop:
        return _define_by_loop(field, solve, decided)
    return _Elimination(field, solve, decided).definitions()


def _define_by_loop(field: Field, solve: Solve, decided: Decided) -> list[Definition]:
    """The pivots and the unknowns, which a loop gives."""
    lines, sides = list[Definition](), solve.sides
    for place in solve.block:
        lines.append((pivot_name(place), field.rest(loop_pivot_name(place), solve.entries)))
    for name, place in zip(solve.names, solve.block, strict=True):
        lines.append((name, field.rest(solution_name(place), sides)))
    return [(name, decided.define(name, value)) for name, value in lines]


class _Elimination:
    """A solve in the making: column by column of W and row by row of U, then backward.

    Args:
        field: Where all names are symbols.
        solve: What to solve.
        decided: The definitions so far.
    """

    def __init__(self, field: Field, solve: Solve, decided: Decided) -> None:
        self.field, self.solve, self.decided = field, solve, decided
        self.lines: list[Definition] = []
        #: The name of each polynomial, up to its sign, by its value.
        self._named: dict[Element, Element] = {}
        self._size = range(len(solve.block))
        self._w: dict[tuple[int, int], Element] = {}
        self._u: dict[tuple[int, int], Element] = {}
        self._z: dict[int, Element] = {}

    def definitions(self) -> list[Definition]:
        """Every line, in an order in which they can be computed."""
        for j in self._size:
            self._eliminate(j)
        x: dict[int, Element] = {}
        for i in reversed(self._size):
            after = self.field.sum(self._u[i, k] * x[k] for k in x if (i, k) in self._u)
            x[i] = self._define(self.solve.names[i], self._z.get(i, self.field.zero) - after)
        return self.lines

    def _eliminate(self, j: int) -> None:
        """``d_j``, then what is divided by it: row j of U, and ``y_j = b_j - w_jk z_k``."""
        place, before = self.solve.block[j], [k for k in range(j) if (j, k) in self._w]
        pivot = self._define(pivot_name(place), self._rest(j, j))
        for i in self._size[j + 1 :]:
            name = column_name(self.solve.block[i], place)
            value = self.decided.value(self._rest(i, j))
            if value != 0:
                leaf = self.solve.symmetric and is_leaf(self.field, value)
                self._w[i, j] = value if leaf else self._entry(name, value)
        row = self._row(j)
        taken = self.field.sum(self._w[j, k] * self._z[k] for k in before if k in self._z)
        y = self.decided.value(self.solve.known[j] - taken)
        whole = self._cancel(y, place)
        if whole is None and not _is_product(self.field, y):
            y = self._define(forward_name(place), y)
        share = 1 / pivot
        if len(row) + (whole is None) > 1:
            share = self._define(reciprocal_name(place), share)
        for i, value in row.items():
            other = self.solve.block[i]
            by_symmetry = self.solve.symmetric
            name = factor_name(other, place) if by_symmetry else upper_name(place, other)
            self._u[j, i] = self._entry(name, value * share)
        if y != 0:
            self._z[j] = self._define(scaled_name(place), y * share if whole is None else whole)

    def _row(self, j: int) -> dict[int, Element]:
        """``d_j u_ji`` for every i, zeros left out: column j of W if A is symmetric."""
        after = self._size[j + 1 :]
        if self.solve.symmetric:
            return {i: self._w[i, j] for i in after if (i, j) in self._w}
        values = ((i, self.decided.value(self._rest(j, i))) for i in after)
        return {i: value for i, value in values if value != 0}

    def _cancel(self, y: Element, place: int) -> Element | None:
        """``y/d`` where that leaves no quotient, as of a mass that forces are multiples of."""
        quotient = y / dict(self.lines)[pivot_name(place)]
        return None if any(each.divisors for each in self.field.quotients(quotient)) else quotient

    def _entry(self, name: str, value: Element) -> Element:
        """An entry of W, L or U by its name, or by that of an entry it is up to its sign."""
        value = self.decided.value(value)
        if is_leaf(self.field, value):
            return self._define(name, value)
        if (same := self._find_named(value)) is None:
            return self._define(name, value)
        self._define(name, same)
        return same

    def _find_named(self, value: Element) -> Element | None:
        """The name of an equal value, or minus that of its opposite."""
        if value.is_polynomial:
            return self._named.get(value)
        for known, other in self.lines:
            if value in (other, -other):
                return self.field[known] if value == other else -self.field[known]
        return None

    def _rest(self, i: int, j: int) -> Element:
        """``a_ij`` without what the columns before take: ``a_ij - w_ik u_kj``."""
        places = [k for k in range(min(i, j)) if (i, k) in self._w and (k, j) in self._u]
        shared = (self._w[i, k] * self._u[k, j] for k in places)
        return self.solve.matrix[i][j] - self.field.sum(shared)

    def _define(self, name: str, value: Element) -> Element:
        """Write a line, and return what later lines read: a number, or the name."""
        value = self.decided.define(name, value)
        self.lines.append((name, value))
        if value.is_polynomial:
            self._named.setdefault(value, self.field[name])
            self._named.setdefault(-value, -self.field[name])
        return self.decided.numbers.get(name, self.field[name])


def list_loops(solves: Iterable[Solve]) -> dict[str, Solve]:
    """The solves that are loops, by the symbols for what they give."""
    return {name: each for each in solves if each.is_loop for name in each.loop_symbols}


def definitions_under(
    field: Field, definitions: Sequence[Definition], elements: Iterable[Element]
) -> list[Definition]:
    """The definitions on which elements rest, in their order."""
    wanted = frozenset[str]().union(*map(field.reach, elements))
    needed = []
    for name, value in reversed(definitions):
        if name in wanted:
            wanted |= field.reach(value)
            needed.append((name, value))
    return needed[::-1]


def factors(
    field: Field, solve: Solve, definitions: Mapping[str, Element]
) -> dict[tuple[int, int], Element]:
    """L below the diagonal, U above it, one over D on it, by their names; zeros are left out."""
    entries = {}
    for i, row in enumerate(solve.block):
        pivot, one = definitions[pivot_name(row)], reciprocal_name(row)
        entries[i, i] = field[one] if one in definitions else 1 / pivot
        for k, column in enumerate(solve.block[:i]):
            name = factor_name(row, column)
            if name in definitions:
                value = definitions[name]
                entries[i, k] = value if is_leaf(field, value) else field[name]
                entries[k, i] = entries[i, k]
            if not solve.symmetric and (own := column_name(row, column)) in definitions:
                entries[i, k] = field[own] * entries[k, k]
            if not solve.symmetric and (own := upper_name(column, row)) in definitions:
                entries[k, i] = field[own]
    return entries


def is_leaf(field: Field, value: Element) -> bool:
    """Whether a value costs no operation: a number, or a name up to its sign."""
    if field.as_number(value) is not None:
        return True
    names = field.names_in(value)
    return len(names) == 1 and any(value in (field[name], -field[name]) for name in names)


def _is_product(field: Field, value: Element) -> bool:
    """Whether a value has no sum in it."""
    divisors = [divisor for each in field.quotients(value) for divisor, _ in each.divisors]
    return all(len(field.terms(part)) < 2 for part in (value, *divisors))
