"""Algebraic numbers and pi: the coefficients of structure constants that are not rational.

Comes in: numbers as they are written, such as ``sqrt(3)`` and ``cos(2*pi/7)``. Goes out: one real
number field that has them all, SymPy's, in which zero is decided by a normal form; how each of its
numbers is written by the given ones; and its sign. pi is transcendental over every such field
(Lindemann 1882), so it is a generator of the ring over this field, like a parameter.
Read next: `coadjoint.exact.field`, which adopts these numbers as functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import chain, combinations_with_replacement, count
from operator import add, mul
from typing import Any

import mpmath
import sympy
from sympy.polys.domains import QQ
from sympy.polys.polyerrors import CoercionFailed, NotAlgebraic

from coadjoint.elementary import ELEMENTARY, Arithmetic
from coadjoint.exact.factors import to_fraction
from coadjoint.exact.linear import Span
from coadjoint.limits import ALGEBRAIC_DEGREE

#: The generator that pi is.
PI = "pi"
#: Binary digits of the first bounds of a number.
DIGITS = 200

_SYMPY = Arithmetic(
    number=lambda value: sympy.Rational(value.numerator, value.denominator),
    call=lambda function, *arguments: getattr(sympy, function)(*arguments),
)


class NumberError(ValueError):
    """A number that no field of real algebraic numbers has.

    Args:
        number: As it is written.
        problem: What is the matter with it, as a clause about it.
    """

    def __init__(self, number: str, problem: str) -> None:
        super().__init__(f"{number} {problem}")
        self.number = number


@dataclass(frozen=True)
class Written:
    """A number as it is written.

    Attributes:
        text: For people, ``cos(2*pi/7)``.
        value: Its value in any arithmetic.
    """

    text: str
    value: Callable[[Arithmetic], Any]


class Numbers:
    """The smallest real number field that has some algebraic numbers.

    Args:
        written: The numbers; rational multiples of pi and rational numbers may be among them.
        largest: The largest degree that is taken.

    Attributes:
        domain: The field; the rationals where nothing else was written.
        degree: Its dimension over the rationals.

    Raises:
        ValueError: A number is not real, or not known to be algebraic; the message tells which.
        OverflowError: The field would have too large a degree.

    >>> root = Written("sqrt(3)", lambda own: own.call("sqrt", own.number(Fraction(3))))
    >>> numbers = Numbers([root])
    >>> str(numbers.text_symbols(numbers.domain.from_sympy(1 / sympy.sqrt(3))))
    'sqrt(3)/3'
    """

    def __init__(self, written: Iterable[Written], largest: int = ALGEBRAIC_DEGREE) -> None:
        self.domain = QQ
        self._written = list(written)
        self._expressions = [_real(each) for each in self._written]
        irrational = {
            expression: _degree(each, expression)
            for each, expression in zip(self._written, self._expressions, strict=True)
            if not (expression.is_Rational or (expression / sympy.pi).is_Rational)
        }
        generators: list[Any] = []
        for expression in sorted(irrational, key=lambda each: -irrational[each]):
            if self._has(expression):
                continue
            degree = irrational[expression] * (self.domain.mod.degree() if generators else 1)
            if degree > largest:
                raise OverflowError(str(degree))
            generators.append(expression)
            self.domain = QQ.algebraic_field(*generators)
        self.degree = self.domain.mod.degree() if generators else 1
        self._images = {e: self.domain.from_sympy(e) for e in irrational}
        #: How many functions stand in the numbers: each, what it is a function of, and pi.
        self.room = 2 * len(self._written) + 2
        self._products: list[tuple[Written, ...]] = []
        #: A basis over the rationals.
        self.basis: list[Any] = []
        self._span = Span()
        self._choose_products([e in irrational for e in self._expressions])

    def _has(self, expression: Any) -> bool:
        try:
            self.domain.from_sympy(expression)
        except CoercionFailed:
            return False
        return True

    def _choose_products(self, is_irrational: Iterable[bool]) -> None:
        """Products of the written numbers that are a basis over the rationals, short ones first."""
        atoms = [
            (each, self._images[expression])
            for each, expression, chosen in zip(
                self._written, self._expressions, is_irrational, strict=True
            )
            if chosen
        ]
        products = chain.from_iterable(
            combinations_with_replacement(atoms, length) for length in count()
        )
        while self._span.rank < self.degree:
            factors = next(products)
            value = reduce(mul, (x for _, x in factors), self.domain.one)
            if self._span.coordinates(self.powers(value)) is None:
                self._span.add(self.powers(value))
                self.basis.append(value)
                self._products.append(tuple(each for each, _ in factors))

    def powers(self, number: Any) -> Mapping[int, Fraction]:
        """Coordinates of a number along the powers of the field's generator."""
        digits = [number] if self.domain.is_QQ else reversed(number.to_list())
        return {n: to_fraction(c) for n, c in enumerate(digits) if c}

    @property
    def minimal(self) -> list[Fraction]:
        """The minimal polynomial of the field's generator, monic, the highest power first."""
        if self.domain.is_QQ:
            return [Fraction(1), Fraction(0)]
        highest, *rest = map(to_fraction, self.domain.mod.to_list())
        return [Fraction(1), *(c / highest for c in rest)]

    def coordinates(self, number: Any) -> dict[int, Fraction]:
        """The rational coordinates of a number along the basis; zeros left out."""
        result = self._span.coordinates(self.powers(number))
        assert result is not None, number
        return {n: Fraction(x) for n, x in result.items()}

    def terms(self, number: Any) -> list[tuple[Fraction, tuple[Written, ...]]]:
        """A number as a sum of rational multiples of products of the written numbers."""
        return [(x, self._products[n]) for n, x in self.coordinates(number).items()]

    def index(self, place: int) -> tuple[Any, Fraction]:
        """The number written in a place, as one of the field and a multiple of pi."""
        expression = self._expressions[place]
        if expression and (expression / sympy.pi).is_Rational:
            return self.domain.zero, Fraction(str(expression / sympy.pi))
        image = self._images.get(expression)
        return self.domain.from_sympy(expression) if image is None else image, Fraction(0)

    def evaluate(self, number: Any, own: Arithmetic) -> Any:
        """A number of the field in any arithmetic."""
        values = (
            reduce(own.multiply, (each.value(own) for each in factors), own.number(x))
            for x, factors in self.terms(number)
        )
        return reduce(own.add, values, own.number(Fraction(0)))

    def pi(self, own: Arithmetic) -> Any:
        """The number pi in any arithmetic."""
        return own.multiply(own.number(Fraction(4)), own.call("atan", own.number(Fraction(1))))

    def text_symbols(self, number: Any) -> Any:
        """A number as SymPy writes it when each written number is a symbol."""
        values = (
            reduce(mul, (sympy.Symbol(each.text) for each in factors), _SYMPY.number(x))
            for x, factors in self.terms(number)
        )
        return reduce(add, values, sympy.Integer(0))

    def enclose(self, number: Any, digits: int) -> Any:
        """An interval of mpmath around a number of the field."""
        context = _intervals(digits)
        own = Arithmetic(
            number=lambda x: context.mpf(x.numerator) / context.mpf(x.denominator),
            call=lambda name, *u: _enclose_call(context, name, *u),
        )
        return self.evaluate(number, own)


def is_number(value: Any) -> bool:
    """Whether a structure constant is a number: rational, algebraic, or in pi; no parameter.

    >>> is_number(Fraction(1, 2))
    True
    """
    if isinstance(value, int | Fraction):
        return True
    return all(str(symbol) == PI for symbol in _symbols(value))


def room_for(value: Any) -> int:
    """How many functions a field has room for that adopts a structure constant and its like."""
    numbers = None if isinstance(value, int | Fraction) else value.factors.numbers
    return 0 if numbers is None else numbers.room


def algebraic(value: Any) -> Any | None:
    """A structure constant as a number of its field; None with parameters or pi."""
    parts = value.parts
    if not parts:
        return value.factors.ring.domain.zero
    if len(parts) > 1 or parts[0].powers or not parts[0].numer.is_ground:
        return None
    return parts[0].numer.LC


def as_rational(value: Any) -> Fraction | None:
    """The rational number that a structure constant is, if it is one."""
    if isinstance(value, int | Fraction):
        return Fraction(value)
    numbers, number = value.factors.numbers, algebraic(value)
    if value == 0 or numbers is None or number is None:
        return None if value else Fraction(0)
    coordinates = numbers.coordinates(number)  # the first of the basis is 1
    return coordinates[0] if coordinates.keys() == {0} else None


def parameters_in(value: Any) -> list[str]:
    """Names of the parameters in a structure constant, in their order."""
    if isinstance(value, int | Fraction):
        return []
    return [str(symbol) for symbol in _symbols(value) if str(symbol) != PI]


def _symbols(value: Any) -> list[Any]:
    """The symbols that occur in an element."""
    ring, used = value.factors.ring, set[int]()
    for part in value.parts:
        for p in (part.numer, *(value.factors.known[n] for n in part.powers)):
            used |= {n for n, degree in enumerate(p.degrees()) if degree > 0}
    return [ring.symbols[n] for n in sorted(used)]


def sign(value: Any) -> int:
    """The sign of a structure constant that is a number, certain: -1, 0 or 1.

    Zero is decided by the normal form. A number that is not zero is bounded with more and more
    digits, until its bounds exclude zero.
    """
    if isinstance(value, int | Fraction):
        return (value > 0) - (value < 0)
    if value == 0:
        return 0
    digits = DIGITS
    while True:
        bounds = _enclose_element(value, digits)
        if bounds is not None and (bounds.a > 0 or bounds.b < 0):
            return 1 if bounds.a > 0 else -1
        digits *= 2


def _enclose_element(value: Any, digits: int) -> Any | None:
    """Bounds of a number; None where a divisor is not known to differ from zero."""
    numbers, context = value.factors.numbers, _intervals(digits)
    assert numbers is not None, value
    places = [str(symbol) for symbol in value.factors.ring.symbols]

    def bounds(p: Any) -> Any:
        total = context.mpf(0)
        for exponents, c in p.terms():
            exponent = sum(e for e, name in zip(exponents, places, strict=True) if name == PI)
            total = total + numbers.enclose(c, digits) * context.pi**exponent
        return total

    result = context.mpf(0)
    for part in value.parts:
        bottom = context.mpf(1)
        for n, exponent in part.powers.items():
            bottom = bottom * bounds(value.factors.known[n]) ** exponent
        if bottom.a <= 0 <= bottom.b:
            return None
        result = result + bounds(part.numer) / bottom
    return result


def _intervals(digits: int) -> Any:
    """Interval arithmetic with so many binary digits."""
    context = mpmath.ctx_iv.MPIntervalContext()
    context.prec = digits
    return context


def _enclose_call(context: Any, name: str, *arguments: Any) -> Any:
    """Bounds of a function of numbers."""
    if text := ELEMENTARY[name].enclosed if name in ELEMENTARY else "":
        from coadjoint.elementary import by_name, evaluate

        own = Arithmetic(
            number=lambda x: context.mpf(x.numerator) / context.mpf(x.denominator),
            call=lambda function, *u: _enclose_call(context, function, *u),
        )
        return evaluate(text, own, **by_name(arguments))
    return getattr(context, name)(*arguments)


def _real(written: Written) -> Any:
    """The expression of a real number."""
    expression = written.value(_SYMPY)
    if expression.is_real is not True:
        raise NumberError(written.text, "is not a real number")
    return expression


def _degree(written: Written, expression: Any) -> int:
    """The degree of a number over the rationals."""
    for angle in (each.args[0] / sympy.pi for each in expression.atoms(sympy.sin, sympy.cos)):
        if not angle.is_Rational:
            raise NumberError(written.text, "is not known to be an algebraic number")
        if sympy.totient(angle.q) > 2 * ALGEBRAIC_DEGREE:
            raise OverflowError(str(sympy.totient(angle.q)))
    for exponent in (each.exp for each in expression.atoms(sympy.Pow) if each.exp.is_Rational):
        if exponent.q > ALGEBRAIC_DEGREE:
            raise OverflowError(str(exponent.q))
    try:
        polynomial = sympy.minimal_polynomial(expression, sympy.Symbol("x"), polys=True)
    except (NotAlgebraic, NotImplementedError):
        raise NumberError(written.text, "is not known to be an algebraic number") from None
    return int(polynomial.degree())
