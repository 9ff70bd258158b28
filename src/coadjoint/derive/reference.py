"""The equations themselves, evaluated in any arithmetic: what every kernel is measured against.

Comes in: Equations. Goes out: a `Reference` that computes each function of the kernels straight
from the field elements, never from the Programs, so that a fault of lowering, printing or compiling
shows. The Jacobian is the exact derivative of the elements, by the chain rule through the
definitions, which are evaluated in their order and never put into one another: there may be many
levels of them where velocities are solved for.
Read next: `coadjoint.lower.check` and `coadjoint.crosscheck.oracle`, which supply the arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from operator import add, mul
from typing import TypeVar

from coadjoint.derive.domain import bounds
from coadjoint.derive.equations import Equations
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
        self.deep = bool(equations.kept)
        self._functions: dict[str, tuple[Sequence[Element], list[tuple[str, Element]]]] = {}

    def evaluate(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """All outputs of one function, row by row.

        Args:
            function: ``rhs``, ``jacobian``, ``energy``, ``observables``,
                ``poisson_tensor``, ``constraint_residual``, ``projection``, ``reconstruction`` or
                ``domain``.
            inputs: State and parameter components by name.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function by name.
        """
        if function == "projection":
            return self._projection.evaluate("rhs", inputs, number, call)
        if function not in self._functions:
            elements = self._elements(function)
            self._functions[function] = elements, self.equations.definitions_of(elements)
        elements, definitions = self._functions[function]
        field, known, factors = self.equations.setting.field, dict(inputs), dict[int, Value]()

        def value(element: Element) -> Value:
            return field.evaluate(element, known, number, call, factors)

        for name, definition in definitions:
            known[name] = value(definition)
        if function == "jacobian":
            return self._jacobian(value, number)
        return [value(element) for element in elements]

    def _elements(self, function: str) -> Sequence[Element]:
        """What a function computes; of the Jacobian, what it is the derivative of."""
        exact = self.equations.exact
        match function:
            case "rhs" | "jacobian":
                return exact.rates
            case "energy" if exact.energy is not None:
                return (exact.energy,)
            case "observables":
                return [observable for _, observable in exact.observables]
            case "poisson_tensor" if exact.poisson_tensor is not None:
                return [entry for row in exact.poisson_tensor for entry in row]
            case "constraint_residual":
                return [residual for _, residual in exact.residuals]
            case "reconstruction":
                return [rate for _, rate in self.equations.followed]
            case "domain":
                return [bound.element for bound in bounds(self.equations)]
        raise AssertionError(function)

    def _jacobian(self, value: Callable[[Element], Value], number: Number[Value]) -> list[Value]:
        """``d rate_i / d x_j`` through the definitions, one after the other."""
        known: dict[str, dict[int, Value]] = {}
        for name, slopes in self._definition_slopes:
            known[name] = _chained(slopes, known, value)
        rates = [_chained(slopes, known, value) for slopes in self._rate_slopes]
        places = range(len(self.state))
        return [rate[j] if j in rate else number(ZERO) for rate in rates for j in places]

    @cached_property
    def _projection(self) -> Reference:
        assert self.equations.projection is not None, "asked for only where constraints are kept"
        return Reference(self.equations.projection)

    @cached_property
    def _definition_slopes(self) -> list[tuple[str, _Slopes]]:
        definitions = self.equations.definitions_of(self.equations.exact.rates)
        return [(name, self._slopes(value)) for name, value in definitions]

    @cached_property
    def _rate_slopes(self) -> list[_Slopes]:
        return [self._slopes(rate) for rate in self.equations.exact.rates]

    def _slopes(self, element: Element) -> _Slopes:
        """The partial derivatives of an element, zeros left out."""
        field, reached = self.equations.setting.field, self.equations.setting.field.reach(element)
        direct = [(j, field.derivative(element, x)) for j, x in enumerate(self.state)]
        names = [name for name, _ in self.equations.exact.definitions if name in reached]
        through = [(name, field.derivative(element, name)) for name in names]
        return _Slopes(
            tuple((j, slope) for j, slope in direct if slope != 0),
            tuple((name, slope) for name, slope in through if slope != 0),
        )


@dataclass(frozen=True)
class _Slopes:
    """Partial derivatives of an element: by places of the state, and by definitions."""

    direct: tuple[tuple[int, Element], ...]
    through: tuple[tuple[str, Element], ...]


def _chained(
    slopes: _Slopes, known: Mapping[str, Mapping[int, Value]], value: Callable[[Element], Value]
) -> dict[int, Value]:
    """Total derivatives by the state from those of the definitions, by the chain rule."""
    total = {j: value(slope) for j, slope in slopes.direct}
    for name, slope in slopes.through:
        outer = value(slope)
        for j, inner in known[name].items():
            product = mul(outer, inner)
            total[j] = add(total[j], product) if j in total else product
    return total
