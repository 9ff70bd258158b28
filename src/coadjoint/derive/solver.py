r"""Solving in the kernel: ``A x = b`` as straight-line definitions instead of an inverse.

A symmetric matrix whose leading minors do not vanish is :math:`A = L D L^T` with ones on the
diagonal of L, so that ``L y = b``, ``D z = y`` and ``L^T x = z`` are solved entry by entry. Each
entry of L, D, y and z becomes a definition with a leading underscore, which no spec can declare;
it is never expanded, since the closed form of a sixth velocity would fill a book. What is zero in
y and z before any number is put in, as behind zeros of b, is left out.
Comes in: elements of A and b. Goes out: definitions, and what must vanish for them to be right.
Read next: `coadjoint.derive.legendre`, which solves for velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coadjoint.exact import Element, Field

#: A name and its value, in terms of state, parameters and names defined before.
Definition = tuple[str, Element]
Rows = Sequence[Sequence[Element]]


def pivot_name(i: int) -> str:
    """Name of the entry of D in the place ``i``, counted from 0."""
    return f"_d{i + 1}"


def factor_name(i: int, j: int) -> str:
    """Name of the entry of L in row ``i`` and column ``j`` below the diagonal."""
    return f"_l{i + 1}_{j + 1}"


def forward_name(i: int) -> str:
    """Name of the entry of y in the place ``i``."""
    return f"_y{i + 1}"


def solver_names(block: Sequence[int]) -> list[str]:
    """Every name that the solve of a block of places may define.

    >>> solver_names((0, 2))
    ['_d1', '_d3', '_l3_1', '_y1', '_y3', '_z1', '_z3']
    """
    factors = [factor_name(i, j) for n, i in enumerate(block) for j in block[:n]]
    of_each = [[make(i) for i in block] for make in (pivot_name, forward_name, scaled_name)]
    return [*of_each[0], *factors, *of_each[1], *of_each[2]]


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


def solve_in_kernel(field: Field, solve: Solve) -> list[Definition]:
    """The definitions that solve ``A x = b``, in the order in which they can be computed.

    Where a pivot is zero at run time, the unknowns are infinite or not a number, as with any other
    division by zero.

    Args:
        field: Where all names are symbols.
        solve: What to solve.

    >>> field = Field(["a", "b", "c", "u", "v", "x", "y", *solver_names((0, 1))])
    >>> a, b, c, u, v = (field[name] for name in "abcuv")
    >>> solve = Solve(((a, b), (b, c)), (u, v), (0, 1), "xy")
    >>> for name, value in solve_in_kernel(field, solve):
    ...     print(name, "=", value)
    _d1 = a
    _l2_1 = b/_d1
    _d2 = -_d1*_l2_1**2 + c
    _y1 = u
    _z1 = _y1/_d1
    _y2 = -_l2_1*_y1 + v
    _z2 = _y2/_d2
    y = _z2
    x = -_l2_1*y + _z1
    """
    known, block, names = solve.known, solve.block, solve.names
    definitions, factors = _factorised(field, solve.matrix, block)
    y: dict[int, Element] = {}
    size = range(len(block))
    for i in size:
        before = field.sum(factors[i, k] * y[k] for k in y if (i, k) in factors)
        value = known[i] - before
        if value == 0:
            continue
        y[i] = field[forward_name(block[i])]
        definitions.append((forward_name(block[i]), value))
        definitions.append((scaled_name(block[i]), y[i] / field[pivot_name(block[i])]))
    for i in reversed(size):
        z = field[scaled_name(block[i])] if i in y else field.zero
        after = (factors[k, i] * field[names[k]] for k in size[i + 1 :] if (k, i) in factors)
        definitions.append((names[i], z - field.sum(after)))
    return definitions


def _factorised(
    field: Field, matrix: Rows, block: Sequence[int]
) -> tuple[list[Definition], dict[tuple[int, int], Element]]:
    """Definitions of L and D, and the symbols of those entries of L that are not zero."""
    definitions: list[Definition] = []
    factors: dict[tuple[int, int], Element] = {}
    pivots = [field[pivot_name(i)] for i in block]
    for j in range(len(block)):
        for i in range(j, len(block)):
            shared = [k for k in range(j) if (i, k) in factors and (j, k) in factors]
            removed = field.sum(factors[i, k] * factors[j, k] * pivots[k] for k in shared)
            rest = matrix[i][j] - removed
            if i == j:
                definitions.append((pivot_name(block[j]), rest))
            elif rest != 0:
                name = factor_name(block[i], block[j])
                definitions.append((name, rest / pivots[j]))
                factors[i, j] = field[name]
    return definitions, factors


def solution_defects(
    field: Field, solve: Solve, definitions: Mapping[str, Element]
) -> list[Element]:
    """Entries of ``L D L^T - A``, ``L y - b``, ``D z - y``, ``L^T x - z``: 0 for a solution.

    In each entry, the name that is defined last is replaced by its definition, and no other: that
    is enough for a proof, and no closed form is ever written out.
    """
    matrix, known, block, names = solve.matrix, solve.known, solve.block, solve.names
    factors = _entries_of_factor(field, definitions, block)
    size = range(len(block))
    d = [field[pivot_name(i)] for i in block]
    y, z = (
        [field[name] if name in definitions else field.zero for name in map(make, block)]
        for make in (forward_name, scaled_name)
    )

    def row(i: int, k: int) -> Element:
        return factors.get((i, k), field.zero)

    left = [
        (
            pivot_name(block[j]) if i == j else factor_name(block[i], block[j]),
            field.sum(row(i, k) * row(j, k) * d[k] for k in size[: j + 1]) - matrix[i][j],
        )
        for i in size
        for j in size[: i + 1]
    ]
    left += [
        (forward_name(block[i]), field.sum(row(i, k) * y[k] for k in size[: i + 1]) - known[i])
        for i in size
    ]
    left += [(scaled_name(block[i]), d[i] * z[i] - y[i]) for i in size]
    left += [
        (names[i], field.sum(row(k, i) * field[names[k]] for k in size[i:]) - z[i]) for i in size
    ]
    return [
        field.substitute(defect, {last: definitions[last]}) if last in definitions else defect
        for last, defect in left
    ]


def _entries_of_factor(
    field: Field, definitions: Mapping[str, Element], block: Sequence[int]
) -> dict[tuple[int, int], Element]:
    """L as the definitions have it: ones on the diagonal, and zero where nothing is defined."""
    entries = {(i, i): field.one for i in range(len(block))}
    for i, row in enumerate(block):
        for j, column in enumerate(block[:i]):
            name = factor_name(row, column)
            if name in definitions:
                entries[i, j] = field[name]
    return entries
