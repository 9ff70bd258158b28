"""The rates of a member by the energy as it is written: fewer operations than its products have.

The exact field multiplies out: the square of ``C*(x*u + y*v)`` has many terms, whose derivatives
share nothing. Here the energy keeps its form, and what its derivatives have in common stays whole.
Comes in: Equations with a bracket, for a few members. Goes out: rates, which whoever takes them has
to compare with those of the exact field.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, cast

import sympy

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import interpret
from coadjoint.exact import Element, Field
from coadjoint.exact.field import SYMPY_FUNCTIONS
from coadjoint.spec.core import tree

#: Functions that ask for the sign of what they are called with.
_SIGNED = frozenset({"abs", "min", "max", "pow", "sign"})


class _AsWritten:
    """What `interpret` asks of a field, of SymPy's expressions, which it leaves as they are.

    The same tree has been interpreted in the exact field, which has found no divisor of zero.
    """

    zero, one = sympy.S.Zero, sympy.S.One

    def number(self, value: Fraction) -> sympy.Expr:
        """A rational number."""
        return sympy.Rational(value.numerator, value.denominator)

    def is_zero(self, value: sympy.Expr) -> bool:
        """Whether an expression is written as zero."""
        return bool(value == 0)

    def is_function_free(self, value: sympy.Expr) -> bool:
        """Said of every divisor, which is known to be none of zero."""
        return True

    def call(self, function: str, *arguments: sympy.Expr) -> sympy.Expr:
        """An elementary function."""
        return SYMPY_FUNCTIONS[function](*arguments)


@dataclass(frozen=True)
class Written:
    """Expressions of a spec in SymPy, as they are written.

    Attributes:
        equations: Of a few members.
    """

    equations: Equations

    @cached_property
    def _values(self) -> dict[str, Any]:
        """The values of names."""
        setting = self.equations.setting
        return {name: _write(setting.field, value) for name, value in setting.values.items()}

    def value(self, node: tree.Node, known: Mapping[str, Any] | None = None) -> Any:
        """The value of a tree, of any shape; of one that asks for signs none, ``()``.

        Args:
            node: The tree.
            known: Values of further names.
        """
        called = (part.function for part in tree.walk(node) if isinstance(part, tree.Call))
        if not _SIGNED.isdisjoint(called):
            return ()
        return interpret(node, {**self._values, **(known or {})}, cast("Field", _AsWritten()))

    @cached_property
    def _energy(self) -> sympy.Expr | None:
        """The energy, if there is one that does not ask for signs."""
        energy = self.equations.spec.hamiltonian
        return None if energy is None else self.value(energy.tree) or None

    @cached_property
    def _velocities(self) -> dict[sympy.Symbol, sympy.Expr]:
        """What velocities are in the state, by their symbols."""
        field, known = self.equations.setting.field, dict[sympy.Symbol, sympy.Expr]()
        for name, value in self.equations.exact.definitions:
            known[sympy.Symbol(name)] = field.to_sympy(value).xreplace(known)
        return known

    def with_velocities(self, element: Element) -> sympy.Expr:
        """An element in which velocities are put as they are defined, and not multiplied out."""
        return self.equations.setting.field.to_sympy(element).xreplace(self._velocities)

    def rates(self, names: Iterable[str]) -> list[sympy.Expr]:
        """The rates of components of the state by the bracket; none where there is none.

        Without a Hamiltonian they are those of the route, in which velocities have names.
        """
        equations = self.equations
        tensor, state = equations.exact.poisson_tensor, equations.variables
        if equations.spec.hamiltonian is None:
            known = dict(zip(state, equations.exact.rates, strict=True))
            return [self.with_velocities(known[name]) for name in names]
        if self._energy is None or tensor is None:
            return []
        field, rates = equations.setting.field, list[sympy.Expr]()
        for name in names:
            row = zip(tensor[state.index(name)], equations.state, strict=True)
            kept = [(field.to_sympy(equations.close(p)), x) for p, x in row if p != 0]
            rates.append(sympy.Add(*(p * sympy.diff(self._energy, x) for p, x in kept)))
        return rates


def _write(field: Field, value: Any) -> Any:
    """A value of any shape as SymPy has it."""
    if isinstance(value, tuple):
        return tuple(_write(field, each) for each in value)
    return field.to_sympy(value)


def are_equal(left: sympy.Expr, right: sympy.Expr) -> bool:
    """Whether two quotients of polynomials, in symbols and functions, are certainly equal."""
    if bool((left - right).expand() == 0):
        return True
    above, _ = sympy.fraction(sympy.together(left - right))
    return bool(sympy.expand(above) == 0)


def choose(
    plain: Sequence[sympy.Expr], written: Sequence[sympy.Expr], most: float = 1.0
) -> tuple[sympy.Expr, ...]:
    """Expressions as they are written, where that is shorter and certainly the same; else none.

    Args:
        plain: As the exact field has them.
        written: As the spec has them.
        most: Which part of the operations of the others they may have.
    """
    lengths = [sum(map(sympy.count_ops, values)) for values in (plain, written)]
    if not written or lengths[1] >= most * lengths[0]:
        return ()
    same = all(are_equal(a, b) for a, b in zip(plain, written, strict=True))
    return tuple(written) if same else ()
