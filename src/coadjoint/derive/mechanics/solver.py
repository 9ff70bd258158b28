r"""Solving in the kernel: ``A x = b`` as straight-line definitions instead of an inverse.

A symmetric matrix whose leading minors do not vanish is :math:`A = L D L^T` with ones on the
diagonal of L, so that ``L y = b``, ``D z = y`` and ``L^T x = z`` are solved entry by entry. Each
entry of L, D, y and z becomes a definition with a leading underscore, which no spec can declare;
it is never expanded, since the closed form of a sixth velocity would fill a book. The columns of
W = L D are computed before they are divided, and a pivot that divides several has one reciprocal.
What is identically zero in W, y, z or x is left out, and x is then 0.
Comes in: elements of A and b. Goes out: definitions, and what must vanish for them to be right.
Read next: `coadjoint.derive.mechanics.decided`, which finds the zeros;
`coadjoint.derive.mechanics.legendre`, which solves for velocities.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.decided import Decided
from coadjoint.exact import Element, Field

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


def forward_name(i: int) -> str:
    """Name of the entry of y in the place ``i``."""
    return f"_y{i + 1}"


def solver_names(block: Sequence[int]) -> list[str]:
    """Every name that the solve of a block of places may define.

    >>> solver_names((0, 2))
    ['_d1', '_d3', '_r1', '_r3', '_w3_1', '_l3_1', '_y1', '_y3', '_z1', '_z3']
    """
    pairs = [(i, j) for n, i in enumerate(block) for j in block[:n]]
    of_pairs = [make(*pair) for make in (column_name, factor_name) for pair in pairs]
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
        matrix: A, symmetric, its leading minors not identically zero.
        known: b.
        block: Places of the unknowns, which number the intermediates.
        names: Names of the unknowns.
    """

    matrix: Rows
    known: Sequence[Element]
    block: Sequence[int]
    names: Sequence[str]


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
    return _Elimination(field, solve, decided or Decided(field, ())).definitions()


class _Elimination:
    """A solve in the making: column by column of L, then backward.

    Args:
        field: Where all names are symbols.
        solve: What to solve.
        decided: The definitions so far.
    """

    def __init__(self, field: Field, solve: Solve, decided: Decided) -> None:
        self.field, self.solve, self.decided = field, solve, decided
        self.lines: list[Definition] = []
        self._size = range(len(solve.block))
        self._w: dict[tuple[int, int], Element] = {}
        self._l: dict[tuple[int, int], Element] = {}
        self._y: dict[int, Element] = {}
        self._z: dict[int, Element] = {}

    def definitions(self) -> list[Definition]:
        """Every line, in an order in which they can be computed."""
        for j in self._size:
            self._eliminate(j)
        x: dict[int, Element] = {}
        for i in reversed(self._size):
            after = self.field.sum(self._l[k, i] * x[k] for k in x if (k, i) in self._l)
            x[i] = self._define(self.solve.names[i], self._z.get(i, self.field.zero) - after)
        return self.lines

    def _eliminate(self, j: int) -> None:
        """``d_j``, then what is divided by it: column j of W, and ``y_j = b_j - w_jk z_k``."""
        place, before = self.solve.block[j], [k for k in range(j) if (j, k) in self._l]
        pivot = self._define(pivot_name(place), self._rest(j, j, before))
        for i in self._size[j + 1 :]:
            name = column_name(self.solve.block[i], place)
            value = self.decided.value(self._rest(i, j, before))
            if value != 0:
                leaf = _is_leaf(self.field, value)
                self._w[i, j] = value if leaf else self._entry(name, value)
        below = [i for i in self._size[j + 1 :] if (i, j) in self._w]
        taken = self.field.sum(self._w[j, k] * self._z[k] for k in before if k in self._z)
        y = self.decided.value(self.solve.known[j] - taken)
        whole = self._cancelled(y, place)
        if whole is None and not _is_product(self.field, y):
            y = self._define(forward_name(place), y)
        share = 1 / pivot
        if len(below) + (whole is None) > 1:
            share = self._define(reciprocal_name(place), share)
        for i in below:
            name = factor_name(self.solve.block[i], place)
            self._l[i, j] = self._entry(name, self._w[i, j] * share)
        if y != 0:
            self._z[j] = self._define(scaled_name(place), y * share if whole is None else whole)

    def _cancelled(self, y: Element, place: int) -> Element | None:
        """``y/d`` where that leaves no quotient, as of a mass that forces are multiples of."""
        found = y / dict(self.lines)[pivot_name(place)]
        return None if any(each.divisors for each in self.field.quotients(found)) else found

    def _entry(self, name: str, value: Element) -> Element:
        """An entry of W or L by its name, or by that of an entry it is up to its sign."""
        value = self.decided.value(value)
        if _is_leaf(self.field, value):
            return self._define(name, value)
        for known, other in self.lines:
            if value in (other, -other):
                same = self.field[known] if value == other else -self.field[known]
                self._define(name, same)
                return same
        return self._define(name, value)

    def _rest(self, i: int, j: int, before: Sequence[int]) -> Element:
        """``a_ij`` without what the columns before j take: ``a_ij - w_ik l_jk``."""
        shared = (self._w[i, k] * self._l[j, k] for k in before if (i, k) in self._w)
        return self.solve.matrix[i][j] - self.field.sum(shared)

    def _define(self, name: str, value: Element) -> Element:
        """Write a line, and return what later lines read: a number, or the name."""
        value = self.decided.define(name, value)
        self.lines.append((name, value))
        return self.decided.numbers.get(name, self.field[name])


def definitions_under(
    field: Field, definitions: Sequence[Definition], elements: Iterable[Element]
) -> list[Definition]:
    """The definitions on which elements rest, in their order."""
    wanted = frozenset[str]().union(*map(field.reach, elements))
    found = []
    for name, value in reversed(definitions):
        if name in wanted:
            wanted |= field.reach(value)
            found.append((name, value))
    return found[::-1]


def factors(
    field: Field, solve: Solve, definitions: Mapping[str, Element]
) -> dict[tuple[int, int], Element]:
    """L below the diagonal, zeros left out, and one over D on it, as the definitions name them."""
    found = {}
    for i, row in enumerate(solve.block):
        pivot, one = definitions[pivot_name(row)], reciprocal_name(row)
        found[i, i] = field[one] if one in definitions else 1 / pivot
        for k, column in enumerate(solve.block[:i]):
            name = factor_name(row, column)
            if name in definitions:
                value = definitions[name]
                found[i, k] = value if _is_leaf(field, value) else field[name]
    return found


def _is_leaf(field: Field, value: Element) -> bool:
    """Whether a value costs no operation: a number, or a name up to its sign."""
    if field.as_number(value) is not None:
        return True
    names = field.names_in(value)
    return len(names) == 1 and any(value in (field[name], -field[name]) for name in names)


def _is_product(field: Field, value: Element) -> bool:
    """Whether a value has no sum in it."""
    divisors = [divisor for each in field.quotients(value) for divisor, _ in each.divisors]
    return all(len(field.terms(part)) < 2 for part in (value, *divisors))


def solution_defects(
    field: Field, solve: Solve, definitions: Mapping[str, Element]
) -> list[Element]:
    """Entries of ``W - L D``, ``W L^T - A``, ``W z - b``, ``D z - y``, ``L^T x - z``.

    All are 0 for a solution. In each entry the name that is defined last is replaced by its
    definition, and reciprocals of pivots are: that is enough for a proof, and no closed form is
    written out. Only where something was left out as identically zero, all definitions are put in.
    """
    return _Defects(field, solve, definitions).entries()


class _Defects:
    """The equations of `solution_defects`, with the definitions put in as far as is needed."""

    def __init__(self, field: Field, solve: Solve, definitions: Mapping[str, Element]) -> None:
        self.field, self.solve, self.definitions = field, solve, definitions
        self._size = range(len(solve.block))
        own = {name for name in solver_names(solve.block) if name in definitions}
        # entries that are others up to their sign, and pivots that are parameters
        self._same = {name: v for name in own if _is_leaf(field, v := definitions[name])}
        ones = map(reciprocal_name, solve.block)
        self._ones = {name: definitions[name] for name in ones if name in definitions}
        self._d = [self._value(pivot_name(place)) for place in solve.block]

    def _value(self, name: str) -> Element:
        """The symbol of a name; zero where nothing is defined."""
        return self.field[name] if name in self.definitions else self.field.zero

    def _l(self, i: int, j: int) -> Element:
        if i == j:
            return self.field.one
        return self._value(factor_name(self.solve.block[i], self.solve.block[j]))

    def _w(self, i: int, j: int) -> Element:
        """An entry of W by its name; by those of L and D where it has none."""
        name = column_name(self.solve.block[i], self.solve.block[j])
        if i == j:
            return self._d[j]
        if name in self.definitions:
            return self.field[name]
        own = factor_name(self.solve.block[i], self.solve.block[j])
        return self._reduced(own, self._l(i, j) * self._d[j])

    def entries(self) -> list[Element]:
        """All defects, row by row."""
        field, block, size = self.field, self.solve.block, self._size
        z = [self._value(scaled_name(place)) for place in block]
        x = [field[name] for name in self.solve.names]
        found = []
        for i in size:
            for j in size[:i]:
                own = factor_name(block[i], block[j])
                found.append((own, self._w(i, j) - self._l(i, j) * self._d[j]))
            for j in size[: i + 1]:
                total = field.sum(self._w(i, k) * self._l(j, k) for k in size[: j + 1])
                own = pivot_name(block[i]) if i == j else column_name(block[i], block[j])
                found.append((own, total - self.solve.matrix[i][j]))
            y, own = self._d[i] * z[i], scaled_name(block[i])
            if forward_name(block[i]) in self.definitions:
                y = field[forward_name(block[i])]
                found.append((own, self._d[i] * z[i] - y))
                own = forward_name(block[i])
            before = field.sum(self._w(i, k) * z[k] for k in size[:i])
            found.append((own, before + y - self.solve.known[i]))
            total = field.sum(self._l(k, i) * x[k] for k in size[i:])
            found.append((self.solve.names[i], total - z[i]))
        return [self._decided(last, defect) for last, defect in found]

    def _reduced(self, last: str, element: Element) -> Element:
        """An element with one name and the reciprocals replaced by their definitions."""
        if last in self._same:
            element = self.field.substitute(element, {last: self._same[last]})
            last = next(iter(self.field.reach(self._same[last])), "")
        own = {last: self.definitions[last]} if last in self.definitions else {}
        put = self.field.substitute(self.field.substitute(element, own), self._ones)
        return self.field.substitute(put, self._same)

    def _decided(self, last: str, defect: Element) -> Element:
        """Zero where the last definition shows it, or all of them do."""
        value = self._reduced(last, defect)
        return self.field.zero if self.field.is_zero(value) else self._known.value(value)

    @cached_property
    def _known(self) -> Decided:
        """All definitions in their order."""
        known = Decided(self.field, ())
        for name, value in self.definitions.items():
            known.define(name, value)
        return known
