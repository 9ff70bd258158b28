"""The equations themselves, evaluated in any arithmetic: what every kernel is measured against.

Comes in: Equations. Goes out: a `Reference` that computes each function of the kernels straight
from the field elements, never from the Programs, so that a fault of lowering, printing or compiling
shows. A Jacobian is the derivative of the rates as they are written: rates are evaluated in
numbers that carry their slopes, by the product, quotient and chain rules. The derivative as an
element of the field would be brought to a common denominator, where terms cancel that no formula of
doubles can cancel without rounding (docs/decisions/envelope.md). Definitions are evaluated in their
order and never put into one another: there may be many levels of them where velocities are solved
for. What a kernel solves by a loop is solved here by what the arithmetic knows of such equations.
Read next: `coadjoint.lower.check` and `coadjoint.crosscheck.oracle`, which supply the arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property, partial, reduce
from typing import Any, TypeVar

from coadjoint.derive.equations import Equations
from coadjoint.derive.formulas import Rows, rows_of
from coadjoint.derive.implicit import ImplicitSolve
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST, STEPS
from coadjoint.derive.sloped import Sloped, add_slopes, scale
from coadjoint.elementary import Arithmetic, slopes_of
from coadjoint.exact import Element
from coadjoint.kernel_functions import KERNEL_FUNCTIONS

Value = TypeVar("Value")
Number = Callable[[Fraction], Value]
Apply = Callable[..., Value]


class Reference:
    """The functions of a system's kernels, from its equations.

    Args:
        equations: The equations.
        implicit: How solutions x of ``A x = k`` are differentiated by inputs and parameters: as
            their definitions are written, or by ``A x' = k' - A' x``. Both are the same function.
            A kernel uses the second formula, since the first one takes twice the operations, and
            its rounding errors are those of that formula, where ``k'`` and ``A' x`` may cancel.
    """

    def __init__(self, equations: Equations, *, implicit: bool = True) -> None:
        self.equations, self.implicit = equations, implicit
        self.state = equations.setting.state
        self.parameters = equations.setting.parameters
        self._functions: dict[str, tuple[Rows, list[tuple[str, Element]]]] = {}

    def evaluate(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """All outputs of one function, row by row.

        Args:
            function: One of `coadjoint.kernel_functions`.
            inputs: State, parameters, inputs and time by component.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function by name.
        """
        if function not in self._functions:
            rows = rows_of(self.equations, function)
            assert rows is not None, function
            self._functions[function] = rows, self._needed_definitions(function, rows)
        rows, _ = self._functions[function]
        if rows.by:
            return self._slopes(function, inputs, number, call)
        return self._values(function, inputs, number, call)

    def _needed_definitions(self, function: str, rows: Rows) -> list[tuple[str, Element]]:
        """The definitions on which a function rests, in their order."""
        inner = [e for solve in self._implicit_solves(function) for e in solve.elements]
        return rows.of.definitions_of([*rows.elements, *inner])

    def _values(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """What the elements of a function are, definitions first."""
        rows, definitions = self._functions[function]
        field, factors = rows.of.setting.field, dict[int, Value]()
        known: dict[str, Any] = dict(inputs)

        def value(element: Element) -> Any:
            return field.evaluate(element, known, number, call, factors)

        reached = set[str]().union(*(field.reach(each) for _, each in definitions))
        for solve in self.equations.exact.solves:
            if solve.newton is not None and reached.intersection(solve.newton.names):
                known |= solve.newton.find(field, known, number, call, partial(_settle, call))
        implied = {solve.last: solve for solve in self._implicit_solves(function)}
        loops = rows.of.loops
        for name, definition in definitions:
            for symbol in field.names_in(definition) & loops.keys() - known.keys():
                known |= loops[symbol].run_loop(symbol, value) if symbol not in known else {}
            known[name] = value(definition)
            if name in implied:
                known |= implied[name].differentiate(known, value)
        return [value(element) for element in rows.elements]

    def _implicit_solves(self, function: str) -> list[ImplicitSolve]:
        """The solves whose solutions are differentiated by the rule for implicit functions."""
        if not self.implicit or KERNEL_FUNCTIONS[function].by not in ("inputs", "parameters"):
            return []
        return self._solves

    @cached_property
    def _solves(self) -> list[ImplicitSolve]:
        """All solves, with their factors."""
        solves = (each for each in self.equations.exact.solves if not each.is_loop)
        return [ImplicitSolve.of(self.equations, each) for each in solves]

    def _slopes(
        self, function: str, inputs: Mapping[str, Value], number: Number[Value], call: Apply[Value]
    ) -> list[Value]:
        """``d rate_i / d x_j``, row by row, by state, inputs or parameters x; or along a vector."""
        names, along = self._functions[function][0].by, self._functions[function][0].along
        one, zero = number(Fraction(1)), number(Fraction(0))
        known = {name: Sloped(value, {}) for name, value in inputs.items()}
        for j, name in enumerate(names):
            known[name] = Sloped(inputs[name], {0: inputs[along[j]]} if along else {j: one})

        def constant(value: Fraction) -> Sloped[Value]:
            return Sloped(number(value), {})

        def apply(function: str, *arguments: Sloped[Value]) -> Sloped[Value]:
            return _apply(function, arguments, number, call)

        rates = self._values(function, known, constant, apply)
        columns = 1 if along else len(names)
        return [rate.slopes.get(j, zero) for rate in rates for j in range(columns)]


def _settle(call: Apply[Value], step: int, _place: int, value: Value) -> Value:
    """A value that is taken as it is, however it came about."""
    return call(SETTLE if step < STEPS else SETTLE_LAST, value)


def _apply(
    function: str,
    arguments: tuple[Sloped[Value], ...],
    number: Number[Value],
    call: Apply[Value],
) -> Sloped[Value]:
    """``f(u)`` with the slopes ``f'(u) u'``."""
    values = tuple(argument.value for argument in arguments)
    value = call(function, *values)
    if function in (SETTLE, SETTLE_LAST):
        return Sloped(value, {})
    slopes = slopes_of(function, values, value, Arithmetic(number=number, call=call))
    parts = (scale(each.slopes, slope) for each, slope in zip(arguments, slopes, strict=True))
    return Sloped(value, reduce(add_slopes, parts))
