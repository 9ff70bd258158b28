"""Solution defects: what must vanish for the definitions of a solve in the kernel to be right.

Comes in: a `Solve` and the definitions of its names, whoever wrote them. Goes out: elements that
are 0 for a solution.
Read next: `coadjoint.prove.constrained`, which decides them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.solver import (
    Solve,
    column_name,
    factor_name,
    forward_name,
    is_leaf,
    pivot_name,
    reciprocal_name,
    scaled_name,
    solver_names,
    upper_name,
)
from coadjoint.exact import Element, Field


def solution_defects(
    field: Field, solve: Solve, definitions: Mapping[str, Element]
) -> list[Element]:
    """Entries of ``W - L D``, ``W U - A``, ``W z - b``, ``D z - y``, ``U x - z``.

    All are 0 for a solution; U is the transpose of L where A is symmetric, and else there is no L.
    In each entry the name that is defined last is replaced by its definition, and reciprocals of
    pivots are: that is enough for a proof, and no closed form is written out. Only where something
    was left out as identically zero, all definitions are substituted. A loop has no defects: it
    solves any equations whose leading minors do not vanish.
    """
    if solve.is_loop:
        return []
    return _Defects(field, solve, definitions).entries()


class _Defects:
    """The equations of `solution_defects`, with the definitions substituted as far as is needed."""

    def __init__(self, field: Field, solve: Solve, definitions: Mapping[str, Element]) -> None:
        self.field, self.solve, self.definitions = field, solve, definitions
        self._size = range(len(solve.block))
        own = {name for name in solver_names(solve.block) if name in definitions}
        # entries that are others up to their sign, and pivots that are parameters
        self._same = {name: v for name in own if is_leaf(field, v := definitions[name])}
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

    def _u(self, i: int, j: int) -> Element:
        """An entry of U on or above the diagonal."""
        if i == j or self.solve.symmetric:
            return self._l(j, i)
        return self._value(upper_name(self.solve.block[i], self.solve.block[j]))

    def _w(self, i: int, j: int) -> Element:
        """An entry of W by its name; by those of L and D where it has none."""
        name = column_name(self.solve.block[i], self.solve.block[j])
        if i == j:
            return self._d[j]
        if name in self.definitions or not self.solve.symmetric:
            return self._value(name)
        own = factor_name(self.solve.block[i], self.solve.block[j])
        return self._reduce(own, self._l(i, j) * self._d[j])

    def entries(self) -> list[Element]:
        """All defects, row by row."""
        field, block, size = self.field, self.solve.block, self._size
        z = [self._value(scaled_name(place)) for place in block]
        x = [field[name] for name in self.solve.names]
        defects = []
        for i in size:
            for j in size[:i] if self.solve.symmetric else ():
                own = factor_name(block[i], block[j])
                defects.append((own, self._w(i, j) - self._l(i, j) * self._d[j]))
            for j in size[: i + 1] if self.solve.symmetric else size:
                last = min(i, j)
                total = field.sum(self._w(i, k) * self._u(k, j) for k in size[: last + 1])
                own = pivot_name(block[i]) if i == j else column_name(block[i], block[j])
                own = upper_name(block[i], block[j]) if i < j else own
                defects.append((own, total - self.solve.matrix[i][j]))
            y, own = self._d[i] * z[i], scaled_name(block[i])
            if forward_name(block[i]) in self.definitions:
                y = field[forward_name(block[i])]
                defects.append((own, self._d[i] * z[i] - y))
                own = forward_name(block[i])
            before = field.sum(self._w(i, k) * z[k] for k in size[:i])
            defects.append((own, before + y - self.solve.known[i]))
            total = field.sum(self._u(i, k) * x[k] for k in size[i:])
            defects.append((self.solve.names[i], total - z[i]))
        return [self._decide(last, defect) for last, defect in defects]

    def _reduce(self, last: str, element: Element) -> Element:
        """An element with one name and the reciprocals replaced by their definitions."""
        if last in self._same:
            element = self.field.substitute(element, {last: self._same[last]})
            last = next(iter(self.field.reach(self._same[last])), "")
        own = {last: self.definitions[last]} if last in self.definitions else {}
        put = self.field.substitute(self.field.substitute(element, own), self._ones)
        return self.field.substitute(put, self._same)

    def _decide(self, last: str, defect: Element) -> Element:
        """Zero where the last definition shows it, or all of them do."""
        value = self._reduce(last, defect)
        return self.field.zero if self.field.is_zero(value) else self._known.value(value)

    @cached_property
    def _known(self) -> Decided:
        """All definitions in their order."""
        known = Decided(self.field, ())
        for name, value in self.definitions.items():
            known.define(name, value)
        return known
