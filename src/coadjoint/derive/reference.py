"""The equations themselves, evaluated in any arithmetic: what every kernel is measured against.

Comes in: Equations. Goes out: a `Reference` that computes each function of the kernels straight
from the field elements, never from the Programs, so that a fault of lowering, printing or compiling
shows. A Jacobian is the derivative of the rates as they are written: rates are evaluated in
numbers that carry their slopes, by the product, quotient and chain rules. The derivative as an
element of the field would be brought to a common denominator, where terms cancel that no formula of
doubles can cancel without rounding (docs/decisions/envelope.md). Definitions are evaluated in their
order and never put into one another: there may be many levels of them where velocities are solved
for.
Read next: `coadjoint.lower.check` and `coadjoint.crosscheck.oracle`, which supply the arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from operator import add, mul, truediv
from typing import Generic, TypeVar

from coadjoint.derive.domain import bounds
from coadjoint.derive.equations import Equations
from coadjoint.exact import Element

Value = TypeVar("Value")
Number = Callable[[Fraction], Value]
Apply = Callable[[str, Value], Value]


class Reference:
    """The functions of a system's kernels, from its equations."""

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.state = equations.setting.state
        self.parameters = equations.setting.parameters
        self._functions: dict[str, tuple[Sequence[Element], list[tuple[str, Element]]]] = {}

    def evaluate(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """All outputs of one function, row by row.

        Args:
            function: ``rhs``, ``jacobian``, ``input_jacobian``, ``parameter_jacobian``,
                ``energy``, ``observables``,
                ``poisson_tensor``, ``constraint_residual``, ``projection``, ``reconstruction`` or
                ``domain``.
            inputs: State, parameters, inputs and time by component.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function by name.
        """
        if function == "projection":
            return self._projection.evaluate("rhs", inputs, number, call)
        if function not in self._functions:
            elements = self._elements(function)
            self._functions[function] = elements, self.equations.definitions_of(elements)
        if function in self.equations.derivatives:
            return self._jacobian(function, inputs, number, call)
        return self._values(function, inputs, number, call)

    def _values(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """What the elements of a function are, definitions first."""
        elements, definitions = self._functions[function]
        field, known, factors = self.equations.setting.field, dict(inputs), dict[int, Value]()

        def value(element: Element) -> Value:
            return field.evaluate(element, known, number, call, factors)

        for name, definition in definitions:
            known[name] = value(definition)
        return [value(element) for element in elements]

    def _elements(self, function: str) -> Sequence[Element]:
        """What a function computes; of a Jacobian, what it is the derivative of."""
        exact = self.equations.exact
        match function:
            case "rhs" | "jacobian" | "input_jacobian" | "parameter_jacobian":
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

    def _jacobian(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """``d rate_i / d x_j``, row by row, by state, inputs or parameters x."""
        names = self.equations.derivatives[function]
        one, zero = number(Fraction(1)), number(Fraction(0))
        known = {name: Sloped(value, {}) for name, value in inputs.items()}
        for j, name in enumerate(names):
            known[name] = Sloped(inputs[name], {j: one})

        def constant(value: Fraction) -> Sloped[Value]:
            return Sloped(number(value), {})

        def apply(function: str, argument: Sloped[Value]) -> Sloped[Value]:
            return _applied(function, argument, number, call)

        rates = self._values(function, known, constant, apply)
        return [rate.slopes.get(j, zero) for rate in rates for j in range(len(names))]

    @cached_property
    def _projection(self) -> Reference:
        assert self.equations.projection is not None, "asked for only where constraints are kept"
        return Reference(self.equations.projection)


class Sloped(Generic[Value]):
    """A value with its slopes by some variables, and the arithmetic of both.

    Args:
        value: The value, in any arithmetic that has ``+ * /`` and ``-u``.
        slopes: Derivatives by the place of the variable; one that is left out is zero.
        factors: What the value is the product of, itself by default: the slope of ``1/D^2`` is
            ``-2 D'/D / D^2``, where the rule for a quotient would say ``-2 D D' / (D^2 D^2)``.
    """

    __slots__ = ("factors", "slopes", "value")

    def __init__(
        self,
        value: Value,
        slopes: Mapping[int, Value],
        factors: tuple[Sloped[Value], ...] = (),
    ) -> None:
        self.value, self.slopes = value, slopes
        self.factors = factors or (self,)

    def __add__(self, other: Sloped[Value]) -> Sloped[Value]:
        return Sloped(add(self.value, other.value), _together(self.slopes, other.slopes))

    def __mul__(self, other: Sloped[Value]) -> Sloped[Value]:
        slopes = _together(_scaled(self.slopes, other.value), _scaled(other.slopes, self.value))
        return Sloped(mul(self.value, other.value), slopes, self.factors + other.factors)

    def __truediv__(self, other: Sloped[Value]) -> Sloped[Value]:
        quotient = truediv(self.value, other.value)
        slopes = {j: truediv(slope, other.value) for j, slope in self.slopes.items()}
        for factor in other.factors:
            part = {
                j: _negative(mul(quotient, truediv(slope, factor.value)))
                for j, slope in factor.slopes.items()
            }
            slopes = _together(slopes, part)
        return Sloped(quotient, slopes)

    def __neg__(self) -> Sloped[Value]:
        return Sloped(
            _negative(self.value), {j: _negative(slope) for j, slope in self.slopes.items()}
        )


def _negative(value: Value) -> Value:
    return -value  # type: ignore[operator, no-any-return]


def _together(one: Mapping[int, Value], other: Mapping[int, Value]) -> dict[int, Value]:
    """The sums of two sets of slopes."""
    total = dict(one)
    for j, slope in other.items():
        total[j] = add(total[j], slope) if j in total else slope
    return total


def _scaled(slopes: Mapping[int, Value], factor: Value) -> dict[int, Value]:
    return {j: mul(slope, factor) for j, slope in slopes.items()}


def _applied(
    function: str, argument: Sloped[Value], number: Number[Value], call: Apply[Value]
) -> Sloped[Value]:
    """``f(u)`` with the slopes ``f'(u) u'``."""
    u = argument.value
    value = call(function, u)

    match function:
        case "sqrt":
            slopes = _scaled(argument.slopes, truediv(number(Fraction(1, 2)), value))
        case "sin":
            slopes = _scaled(argument.slopes, call("cos", u))
        case "cos":
            slopes = _scaled(argument.slopes, _negative(call("sin", u)))
        case "exp":
            slopes = _scaled(argument.slopes, value)
        case _:
            assert function == "log", function
            slopes = {j: truediv(slope, u) for j, slope in argument.slopes.items()}
    return Sloped(value, slopes)
