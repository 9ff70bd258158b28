"""The equations themselves, evaluated in any arithmetic: what every kernel is measured against.

Comes in: Equations. Goes out: a `Reference` that computes each function of the kernels straight
from the field elements, never from the Programs, so that a fault of lowering, printing or compiling
shows. The Jacobian is the exact derivative of the elements, by the chain rule through the
definitions; the kernels get theirs by forward accumulation.
Read next: `coadjoint.crosscheck.oracle`, which supplies 50 digits with an error envelope.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property, reduce
from operator import add, mul
from typing import TypeVar

from coadjoint.derive import Equations
from coadjoint.exact import Element

Value = TypeVar("Value")
Number = Callable[[Fraction], Value]
Apply = Callable[[str, Value], Value]
ZERO = Fraction(0)


class Reference:
    """The functions of a system's kernels, from its equations."""

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.state = equations.setting.state
        self.parameters = equations.setting.parameters

    def evaluate(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """All outputs of one function, row by row.

        Args:
            function: ``rhs``, ``jacobian``, ``energy``, ``observables`` or ``poisson_tensor``.
            inputs: State and parameter components by name.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function by name.
        """
        field, exact = self.equations.setting.field, self.equations.exact
        known, factors = dict(inputs), dict[int, Value]()

        def value(element: Element) -> Value:
            return field.evaluate(element, known, number, call, factors)

        for name, definition in exact.definitions:
            known[name] = value(definition)
        match function:
            case "rhs":
                return [value(rate) for rate in exact.rates]
            case "energy":
                return [value(exact.energy)]
            case "observables":
                return [value(observable) for _, observable in exact.observables]
            case "poisson_tensor":
                return [value(entry) for row in exact.poisson_tensor for entry in row]
        assert function == "jacobian", function
        return self._jacobian(value, number)

    def _jacobian(self, value: Callable[[Element], Value], number: Number[Value]) -> list[Value]:
        """``d rate_i / d x_j`` through the definitions."""
        return [
            reduce(add, (reduce(mul, map(value, product)) for product in products), number(ZERO))
            for products in self._slopes
        ]

    @cached_property
    def _slopes(self) -> list[list[tuple[Element, ...]]]:
        """Each entry of the Jacobian as a sum of products of elements, zeros left out."""
        field, exact = self.equations.setting.field, self.equations.exact
        inner = {
            name: field.gradient(definition, self.state) for name, definition in exact.definitions
        }
        entries = []
        for rate in exact.rates:
            direct = field.gradient(rate, self.state)
            outer = {name: field.derivative(rate, name) for name in inner}
            for j in range(len(self.state)):
                products = [(direct[j],), *((outer[n], inner[n][j]) for n in inner)]
                entries.append([p for p in products if all(e != 0 for e in p)])
        return entries
