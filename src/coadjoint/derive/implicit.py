"""Implicit: derivatives of what the kernel solves for, by the rule for implicit functions.

Where ``A x = k``, the derivative of x solves ``A x' = k' - A' x``, with A's factors L, D and U.
Comes in: a solve, and values with their slopes. Goes out: the unknowns with theirs.
Read next: `coadjoint.derive.reference`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add, mul
from typing import Any

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.solver import Solve, factors
from coadjoint.derive.sloped import Sloped, negative
from coadjoint.exact import Element

#: Evaluates an element, with its slopes.
Evaluate = Callable[[Element], Sloped[Any]]


@dataclass(frozen=True)
class ImplicitSolve:
    """A solve with its factors.

    Attributes:
        solve: A, k and the names of x.
        factors: L below the diagonal, U above it and one over D on it, zeros left out.
        unknowns: x as symbols.
        last: The name of the unknown that is defined last.
    """

    solve: Solve
    factors: Mapping[tuple[int, int], Element]
    unknowns: tuple[Element, ...]
    last: str

    @classmethod
    def of(cls, equations: Equations, solve: Solve) -> ImplicitSolve:
        """A solve of a motion."""
        definitions = dict(equations.exact.definitions)
        last = [name for name in definitions if name in solve.names][-1]
        unknowns = equations.setting.elements(solve.names)
        factored = factors(equations.setting.field, solve, definitions)
        return cls(solve, factored, unknowns, last)

    @property
    def elements(self) -> list[Element]:
        """Everything that has to be known for it."""
        rows = [entry for row in self.solve.matrix for entry in row]
        return [*rows, *self.solve.known, *self.factors.values(), *self.unknowns]

    def differentiate(
        self, known: Mapping[str, Sloped[Any]], value: Evaluate
    ) -> dict[str, Sloped[Any]]:
        """The unknowns with their slopes.

        Args:
            known: Values by name, those of the unknowns among them.
            value: Evaluates an element of them.
        """
        names = self.solve.names
        x = [known[name].value for name in names]
        rows = [self._residual(i, x, value) for i in range(len(names))]
        weights = {place: value(factor).value for place, factor in self.factors.items()}
        slopes: list[dict[int, Any]] = [{} for _ in names]
        for variable in sorted(set().union(*rows)):
            column = [row.get(variable) for row in rows]
            for i, slope in enumerate(self._substitute(column, weights)):
                if slope is not None:
                    slopes[i][variable] = slope
        return {name: Sloped(x[i], slopes[i]) for i, name in enumerate(names)}

    def _residual(self, i: int, x: list[Any], value: Evaluate) -> dict[int, Any]:
        """``(k' - A' x)_i`` by each variable."""
        total = dict(value(self.solve.known[i]).slopes)
        for entry, unknown in zip(self.solve.matrix[i], x, strict=True):
            slopes = value(entry).slopes if entry != 0 else {}
            for variable, slope in slopes.items():
                part = negative(mul(slope, unknown))
                total[variable] = add(total[variable], part) if variable in total else part
        return total

    def _substitute(self, column: list[Any], weights: Mapping[tuple[int, int], Any]) -> list[Any]:
        """``A^-1 r`` by L, D and U; None is zero."""
        size = range(len(column))
        y: list[Any] = []
        for i in size:
            before = [(weights[i, k], y[k]) for k in size[:i] if (i, k) in weights]
            y.append(_subtract_products(column[i], before))
        solution: list[Any] = [None] * len(column)
        for i in reversed(size):
            after = [(weights[i, k], solution[k]) for k in size[i + 1 :] if (i, k) in weights]
            scaled = None if y[i] is None else mul(y[i], weights[i, i])
            solution[i] = _subtract_products(scaled, after)
        return solution


def _subtract_products(start: Any, products: list[tuple[Any, Any]]) -> Any:
    """A value minus some products; None is zero."""
    parts = [] if start is None else [start]
    parts += [negative(mul(a, b)) for a, b in products if b is not None]
    return reduce(add, parts) if parts else None
