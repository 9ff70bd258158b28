"""The Field of a system: named symbols, adjoined functions, calculus and evaluation.

Comes in: names of the symbols. Goes out: elements with a decidable zero. Elementary functions
are adjoined as new generators with their derivative and, for roots and the pairs sin, cos and sinh,
cosh, the relation that reduces them, as `coadjoint.elementary` has it.
Read next: `coadjoint.derive.assembly`, which makes the Field of a Spec.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, NoReturn, TypeVar, cast

import sympy
from sympy.polys.rings import PolyElement

from coadjoint.elementary import ELEMENTARY, Arithmetic, domain_of, evaluate, slopes_of
from coadjoint.exact.dense import total
from coadjoint.exact.element import Element, split_by_powers
from coadjoint.exact.numbers import PI, Numbers
from coadjoint.exact.rationals import Rationals
from coadjoint.exact.region import Condition, Region

Value = TypeVar("Value")


@dataclass(frozen=True)
class Adjoined:
    """A generator that stands for ``function(argument)``.

    Attributes:
        generator: Its name.
        function: The name of one of `coadjoint.elementary`.
        arguments: Elements of generators adjoined before.
        partner: The generator of the cosine for a sine and the other way round, else empty.
    """

    generator: str
    function: str
    arguments: tuple[Element, ...]
    partner: str = ""

    @property
    def argument(self) -> Element:
        """The argument of a function of one."""
        (only,) = self.arguments
        return only


def refuse_call(function: str, *arguments: Any) -> NoReturn:
    """No arithmetic for functions: the elements have none."""
    raise AssertionError(f"{function}{arguments} in a function-free element")


SYMPY_FUNCTIONS = {name: getattr(sympy, name) for name in ELEMENTARY}


class Field(Rationals):
    """Rational functions over Q in named symbols and in elementary functions of them.

    Args:
        names: The symbols, in the order that fixes the normal form.
        slots: How many elementary functions may be adjoined.
        positive: The symbols that may be assumed positive.
        numbers: As in `Rationals`.

    Attributes:
        region: What else may be assumed, and where values are looked at.
        has_called: Whether any function was called, so that zeros may rest on relations of
            functions that are gone: ``sin(-x) + sin(x)`` has none left.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> field.is_zero((x**2 - y**2) / (x - y) - (x + y))
    True
    """

    def __init__(
        self,
        names: Sequence[str],
        slots: int = 0,
        positive: Iterable[str] = (),
        numbers: Numbers | None = None,
    ) -> None:
        super().__init__(names, 2 * slots, numbers)  # sine and cosine come together
        self.positive = frozenset(positive)
        self.region = Region()
        self._factors.is_hidden_zero = self._is_hidden_zero
        self.adjoined: dict[str, Adjoined] = {}
        self.has_called = False
        #: Those of polynomials without functions, by function and arguments.
        self._called: dict[tuple[str, tuple[Element, ...]], str] = {}
        self._plain: set[str] = set()
        #: What `coadjoint.exact.relations` knows of functions, by their generators.
        self.relations: dict[frozenset[str], object] = {}
        #: Algebraic numbers that were looked for, by how they are written.
        self.constants: dict[tuple[str, ...], Numbers | None] = {}
        self._slopes: dict[str, list[Element]] = {}
        self._derivatives: dict[tuple[str, str], Element] = {}
        #: The order in which functions were adjoined, and what they reach.
        self._turns: dict[str, int] = {}
        self._reached: dict[str, frozenset[str]] = {}
        self._rests: dict[str, frozenset[str]] = {}

    def assume(self, conditions: Iterable[Condition]) -> None:
        """Assume further conditions."""
        self.region = replace(self.region, conditions=(*self.region.conditions, *conditions))
        self.relations.clear()
        self._slopes.clear()
        self._derivatives.clear()

    def _take_numbers(self, known: Numbers, own: Sequence[str], p: PolyElement) -> Element:
        """A polynomial over algebraic numbers, each written by functions of this field."""
        result = self.zero
        for exponents, number in p.terms():
            term = known.evaluate(number, self.arithmetic)
            for name, exponent in zip(own, exponents, strict=True):
                if exponent:
                    base = known.pi(self.arithmetic) if name == PI else self[name]
                    term = term * base**exponent
            result += term
        return self.normal(result)

    # -- elementary functions -----------------------------------------------------------

    def call(self, function: str, *arguments: Element) -> Element:
        """A function of elements, adjoining a generator unless one stands for it already.

        ``tan`` becomes ``sin / cos``, ``sin(-x)`` is ``-sin(x)``, and the square root of a square
        is its root where that has a declared sign.

        Raises:
            OverflowError: There are more functions than the field has room for.
        """
        from coadjoint.exact.values import known_value  # which needs fields

        self.has_called = True
        if function == "tan":
            return self.call("sin", *arguments) / self.call("cos", *arguments)
        entry, first = ELEMENTARY[function], arguments[0]
        if entry.parity and first and first.parts[0].numer.LC < 0:
            return self.call(function, -first) * entry.parity
        if (called := self._find_called(function, arguments)) is not None:
            return self[called]
        if (value := known_value(self, function, *arguments)) is not None:
            return value
        if len(self._free) < 1 + bool(entry.partner):
            raise OverflowError(f"no room left for {function}")
        if entry.partner:  # always both: each has the derivative of the other
            names, own = self._free[:2], sorted((function, entry.partner))
            for each, partner in zip(own, reversed(names), strict=True):
                self._adjoin(each, arguments, partner)
            return self[names[own.index(function)]]
        result = self._adjoin(function, arguments)
        if entry.calls_others:  # now, while there is room
            self._slopes_of(self.adjoined[str(result)])
        return result

    def _find_called(self, function: str, arguments: tuple[Element, ...]) -> str | None:
        """The generator of a function of these arguments, if one was adjoined.

        Polynomials without functions are equal or not as they stand, and have their places: looking
        at each function that is known would take quadratic time.
        """
        plain = all(map(self._is_plain, arguments))
        if plain and (function, arguments) in self._called:
            return self._called[function, arguments]
        for name, known in self.adjoined.items():
            if known.function != function or (plain and name in self._plain):
                continue
            if all(self.is_zero(a - b) for a, b in zip(known.arguments, arguments, strict=True)):
                return name
        return None

    def _is_plain(self, element: Element) -> bool:
        """Whether an element is a polynomial without functions."""
        return element.is_polynomial and self.is_function_free(element)

    @property
    def room(self) -> int:
        """How many generators are left for functions; sines and cosines take two."""
        return len(self._free)

    def _adjoin(self, function: str, arguments: tuple[Element, ...], partner: str = "") -> Element:
        generator = self._free.pop(0)
        self._turns[generator] = len(self._turns)
        self.adjoined[generator] = Adjoined(generator, function, arguments, partner)
        if all(map(self._is_plain, arguments)):
            self._called[function, arguments] = generator
            self._plain.add(generator)
        return self[generator]

    @property
    def arithmetic(self) -> Arithmetic:
        """What texts of the table of functions are computed with."""
        return Arithmetic(number=self.number, call=self.call)

    def domain_of(self, known: Adjoined) -> Element | None:
        """What is positive where an adjoined function is analytic; None where it is everywhere."""
        return cast("Element | None", domain_of(known.function, known.arguments, self.arithmetic))

    def normal(self, element: Element) -> Element:
        """Normal form: even powers of square roots and of sines in the numerator are replaced.

        With functions the element is one quotient: a common denominator brings new squares. It is
        0 also where other relations of the functions show that (`coadjoint.exact.relations`).
        """
        if not self.adjoined or self.is_function_free(element):
            return element
        called = self.functions_in(element)
        for known in reversed(self.adjoined.values()):
            square = self.square_of(known)
            if square is not None:
                element = self.reduce_squares(element.combine(), known.generator, square)
        short = element.combine()
        if self.is_function_free(short):
            return short
        from coadjoint.exact.relations import vanish_by_relations  # which needs fields

        hidden = vanish_by_relations(self, short, called | self.functions_in(short))
        return self.zero if hidden else short

    def square_of(self, known: Adjoined) -> Element | None:
        """What the square of an adjoined generator equals, where there is such a relation."""
        text = ELEMENTARY[known.function].square
        if not text:
            return None
        partner = self[known.partner] if known.partner else None
        values = {"u": known.arguments[0], "p": partner}
        return cast(Element, evaluate(text, self.arithmetic, **values))

    def reduce_squares(self, element: Element, generator: str, square: Element) -> Element:
        """A single quotient with ``generator ** 2`` replaced in its numerator."""
        place, ring = self._position[generator], self._ring
        if not element or element.parts[0].numer.degree(place) < 2:
            return element
        (quotient,) = element.parts
        parts: dict[int, PolyElement] = {}
        for power, part in split_by_powers(quotient.numer, place).items():
            odd = part * ring.gens[place] ** (power % 2)
            parts[power // 2] = parts.get(power // 2, ring.zero) + odd
        numer = sum((self.from_polynomial(p) * square**k for k, p in parts.items()), self.zero)
        return numer * Element(self._factors, [(ring.one, quotient.powers)])

    def reduce_modulo(
        self, element: Element, generator: str, coefficients: Sequence[Fraction]
    ) -> Element:
        """A single quotient whose numerator is reduced by a monic polynomial in a generator.

        Args:
            element: The quotient.
            generator: A root of the polynomial.
            coefficients: Those of the polynomial, the highest power first.
        """
        place, ring = self._position[generator], self._ring
        degree = len(coefficients) - 1
        if not element or element.parts[0].numer.degree(place) < degree:
            return element
        (quotient,) = element.parts
        parts, root = split_by_powers(quotient.numer, place), ring.gens[place]
        for power in range(max(parts), degree - 1, -1):
            top = parts.pop(power, ring.zero)
            for n, number in enumerate(coefficients[1:], 1):
                ground = ring.domain(number.numerator, number.denominator)
                parts[power - n] = parts.get(power - n, ring.zero) - top * ground
        numer = sum((part * root**power for power, part in parts.items()), ring.zero)
        return Element(self._factors, [(numer, quotient.powers)])

    def is_zero(self, element: Element) -> bool:
        """Whether the normal form is 0: exact for rational functions, and a proof of zero always.

        With adjoined functions a nonzero normal form may still be a hidden zero, such as
        ``sqrt(q + 1 + 2*sqrt(q)) - 1 - sqrt(q)``; `coadjoint.exact.witness` says what is not zero.
        """
        return bool(self.normal(element) == 0)

    def _is_hidden_zero(self, divisor: Element) -> bool:
        """Whether a divisor that is a single quotient is zero by the relations of its functions."""
        if not self.adjoined or len(divisor.parts[0].numer) == 1:
            return False
        return self.is_zero(divisor)

    def is_function_free(self, element: Element) -> bool:
        """Whether no adjoined function occurs, so that the normal form decides both ways."""
        return not any(name in self.adjoined for name in self.names_in(element))

    def coefficients(self, element: Element, name: str) -> dict[int, Element]:
        """The coefficients of a (Laurent) polynomial in a symbol, by its powers.

        Raises:
            ValueError: The symbol stands in a sum in a denominator, or in a function.

        >>> field = Field(["x", "a"])
        >>> field.coefficients(field["a"] * field["x"] ** 2 + 3 - 1 / field["x"], "x")
        {-1: -1, 0: 3, 2: a}
        """
        place, result = self._position[name], dict[int, list[Element]]()
        if any(name in self.reach(self[g]) for g in self._calls_in(element)):
            raise ValueError(f"{name} occurs in a function")
        for quotient in element.parts:
            lowered, powers = 0, {}
            for number, exponent in quotient.powers.items():
                factor = self._factors.known[number]
                if factor == self._ring.gens[place]:
                    lowered = exponent
                elif factor.degree(self._ring.gens[place]) > 0:
                    raise ValueError(f"{name} stands in a sum in a denominator")
                else:
                    powers[number] = exponent
            for power, part in split_by_powers(quotient.numer, place).items():
                whole = Element(self._factors, [(part, powers)])
                result.setdefault(power - lowered, []).append(whole)
        return {power: value for power in sorted(result) if (value := self.sum(result[power]))}

    def functions_in(self, element: Element) -> frozenset[str]:
        """Generators of the functions that occur in an element or in their arguments."""
        result = set(self._calls_in(element))
        for generator in self._calls_in(element):
            for argument in self.adjoined[generator].arguments:
                result |= self.functions_in(argument)
        return frozenset(result)

    # -- calculus -----------------------------------------------------------------------

    def slope(self, element: Element, generator: str) -> Element:
        """Partial derivative by a generator as if functions were symbols."""
        return element.diff(self._position[generator])

    def derivative(self, element: Element, name: str) -> Element:
        """Partial derivative by a symbol, through adjoined functions by the chain rule."""
        here = name in self.names_in(element)
        parts = [element.diff(self._position[name])] if here else []
        for generator in self._calls_in(element):
            inner = self._derivative_of(self.adjoined[generator], name)
            if inner != 0:  # most functions are of other symbols where there are many
                parts.append(self.slope(element, generator) * inner)
        return self.sum(parts)

    def _derivative_of(self, known: Adjoined, name: str) -> Element:
        """Derivative of an adjoined function by a symbol, remembered."""
        place = (known.generator, name)
        if place not in self._derivatives:
            self._derivatives[place] = self._differentiate(known, name)
        return self._derivatives[place]

    def _differentiate(self, known: Adjoined, name: str) -> Element:
        """The same by the chain rule."""
        inner = [self.derivative(argument, name) for argument in known.arguments]
        if all(each == 0 for each in inner):
            return self.zero
        pairs = zip(inner, self._slopes_of(known), strict=True)
        return self.sum(each * slope for each, slope in pairs)

    def _slopes_of(self, known: Adjoined) -> list[Element]:
        """Derivatives of an adjoined function by its arguments."""
        if known.generator not in self._slopes:
            own = self[known.generator]
            found = slopes_of(known.function, known.arguments, own, self.arithmetic)
            self._slopes[known.generator] = found
        return self._slopes[known.generator]

    def gradient(self, element: Element, names: Iterable[str]) -> tuple[Element, ...]:
        """Partial derivatives by several symbols."""
        within = self.reach(element)
        return tuple(self.derivative(element, n) if n in within else self.zero for n in names)

    # -- evaluation ---------------------------------------------------------------------

    def evaluate(
        self,
        element: Element,
        values: Mapping[str, Value],
        number: Callable[[Fraction], Value],
        call: Callable[..., Value] = refuse_call,
        factors: dict[int, Value] | None = None,
    ) -> Value:
        """The value of an element in any arithmetic with ``+ * /``: term by term, as it is written.

        Args:
            element: What to evaluate.
            values: Values of the symbols that occur; of functions, too, that are not to be called.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function by name; left out where there is none.
            factors: Remembers the factors of denominators, for many elements at the same values.
        """
        factors = {} if factors is None else factors
        calls = [name for name in self._calls_in(element) if name not in values]
        known = dict(values) if calls else values
        for generator in calls:
            arguments = self.adjoined[generator].arguments
            inner = (self.evaluate(each, known, number, call, factors) for each in arguments)
            known[generator] = call(self.adjoined[generator].function, *inner)  # type: ignore[index]
        quotients = [self._quotient(q, known, number, factors) for q in element.parts]
        return total(quotients) if quotients else number(Fraction(0))

    def _calls_in(self, element: Element) -> list[str]:
        """Adjoined generators that occur, in the order in which they were adjoined."""
        present = self.names_in(element) & self.adjoined.keys() if self.adjoined else ()
        return sorted(present, key=self._turns.__getitem__)

    def substitute(self, element: Element, values: Mapping[str, Element]) -> Element:
        """The element with symbols replaced by elements; symbols not named stay.

        So are functions that are named by their generators, wherever they stand.
        """
        called = self.functions_in(element) if values.keys() & self.adjoined.keys() else frozenset()
        if not (self.reach(element) | called) & values.keys():
            return element
        new = {name: values[name] for name in self.names if name in values}
        for generator in self._calls_in(element):
            if generator in values:
                new[generator] = values[generator]
                continue
            known = self.adjoined[generator]
            arguments = tuple(self.substitute(each, values) for each in known.arguments)
            if any(a is not b for a, b in zip(arguments, known.arguments, strict=True)):
                new[generator] = self.call(known.function, *arguments)
        return self._replace(element, new)

    def reach(self, element: Element) -> frozenset[str]:
        """Symbols that occur in an element or in the arguments of its functions.

        With a symbol come those on which it rests: see `rest`.
        """
        names = self.names_in(element)
        called = names & self.adjoined.keys()
        if called:
            names = (names - called).union(*map(self._reach_of, called))
        return names.union(*(self._rests[each] for each in names & self._rests.keys()))

    def _reach_of(self, generator: str) -> frozenset[str]:
        """The same of the arguments of a function, remembered."""
        if generator not in self._reached:
            arguments = self.adjoined[generator].arguments
            self._reached[generator] = frozenset[str]().union(*map(self.reach, arguments))
        return self._reached[generator]

    def rest(self, name: str, elements: Iterable[Element]) -> Element:
        """A symbol for what a kernel computes of some elements by a loop, without a formula."""
        known = self._rests.get(name, frozenset())
        self._rests[name] = known.union(*map(self.reach, elements))
        self._reached.clear()
        return self[name]

    def write_in_sines(self, p: PolyElement) -> PolyElement:
        """A polynomial with even powers of cosines written by sines: ``1 - cos^2`` as ``sin^2``."""
        element = self.from_polynomial(p)
        for name, known in self.adjoined.items():
            if known.function == "cos" and name in self.names_in(element):
                element = self.reduce_squares(element, name, self.one - self[known.partner] ** 2)
        return element.parts[0].numer if element.parts else self._ring.zero

    def to_sympy(self, element: Element) -> sympy.Expr:
        """The element as a SymPy expression of plain symbols, for people to read and use."""
        functions = {
            sympy.Symbol(generator): SYMPY_FUNCTIONS[self.adjoined[generator].function](
                *map(self.to_sympy, self.adjoined[generator].arguments)
            )
            for generator in self._calls_in(element)
        }
        return sympy.sympify(element).xreplace(functions)
