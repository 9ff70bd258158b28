"""Closed: what the kernel solves for, as expressions of state, parameters, inputs and time.

A kernel solves ``A x = b`` by ``L D L^T``, with names for all intermediates. People read the
solution: by Cramer's rule, its determinants not multiplied out, for up to `LARGEST` unknowns. More
of them would fill pages; then the equations themselves are given.
Comes in: exact equations. Goes out: SymPy expressions by name, and the equations left over.
Velocities that Newton's iteration finds keep their names.
Read next: `coadjoint.derive.equations`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import sympy

from coadjoint.derive.records import Exact
from coadjoint.exact import Element

#: Largest number of unknowns that are written out: two velocities, say, and two multipliers.
LARGEST = 4
Rows = Sequence[Sequence[sympy.Expr]]


@dataclass(frozen=True)
class LinearEquations:
    """Equations ``matrix * unknowns = right`` with too many unknowns to write the solution out.

    Attributes:
        unknowns: Velocities; or accelerations, and minus the multipliers of constraints.
        matrix: In state, parameters, inputs and time; symmetric where no force names a reaction.
        right: A column of the same.
    """

    unknowns: tuple[sympy.Symbol, ...]
    matrix: sympy.ImmutableMatrix
    right: sympy.ImmutableMatrix


@dataclass(frozen=True)
class ClosedForms:
    """What the kernel solves for.

    Attributes:
        values: Solutions and what rests on them, by name.
        unsolved: What is not written out; `values` name their unknowns.
    """

    values: dict[sympy.Symbol, sympy.Expr]
    unsolved: tuple[LinearEquations, ...]


def closed_forms(
    exact: Exact, named: Collection[str], write: Callable[[Element], sympy.Expr]
) -> ClosedForms:
    """The closed forms of solutions, and of definitions that rest on them.

    Args:
        exact: The equations.
        named: Definitions that rest on solutions, without the intermediates of these.
        write: Makes an element an expression that names nothing else that is defined.
    """
    values, unsolved = dict[sympy.Symbol, sympy.Expr](), list[LinearEquations]()
    for solve in exact.solves:
        if solve.newton is not None:  # they solve mu = dl/dxi, and keep their names
            continue
        names = tuple(map(sympy.Symbol, solve.names))
        matrix = [[write(entry).xreplace(values) for entry in row] for row in solve.matrix]
        right = [write(entry).xreplace(values) for entry in solve.known]
        if len(names) <= LARGEST:
            values |= zip(names, _cramer(matrix, right), strict=True)
        else:
            column = sympy.ImmutableMatrix([[entry] for entry in right])
            unsolved.append(LinearEquations(names, sympy.ImmutableMatrix(matrix), column))
    solved = {name for solve in exact.solves for name in solve.names}
    for name, value in exact.definitions:
        if name in named and name not in solved:
            values[sympy.Symbol(name)] = write(value).xreplace(values)
    return ClosedForms(values, tuple(unsolved))


def _cramer(matrix: Rows, right: Sequence[sympy.Expr]) -> list[sympy.Expr]:
    """The solution of ``matrix * x = right``."""
    whole = _determinant(matrix)
    return [
        _determinant([[*row[:n], b, *row[n + 1 :]] for row, b in zip(matrix, right, strict=True)])
        / whole
        for n in range(len(right))
    ]


def _determinant(matrix: Rows) -> sympy.Expr:
    """The expansion along the first row, its zeros left out."""
    if not matrix:
        return sympy.Integer(1)
    first, *rest = matrix
    return sympy.Add(
        *(
            (-1) ** n * entry * _determinant([[*row[:n], *row[n + 1 :]] for row in rest])
            for n, entry in enumerate(first)
            if entry != 0
        )
    )
