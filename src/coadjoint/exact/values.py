"""Values of elementary functions that need no function: ``sqrt(4*m^2)`` is ``2*m`` for positive m.

Comes in: a function and its argument. Goes out: the value without that function, where the declared
signs give one. What two functions have to do with each other is for `coadjoint.exact.relations`.
Read next: `coadjoint.exact.signs`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import reduce
from math import floor
from operator import mul
from typing import cast

from coadjoint.elementary import ELEMENTARY, Arithmetic, by_name, evaluate
from coadjoint.exact.element import Element
from coadjoint.exact.factors import factors_of, rational_root, to_fraction
from coadjoint.exact.field import Field
from coadjoint.exact.signs import sign
from coadjoint.limits import EXPONENT

#: Cosine and sine of an inverse function, in its arguments and ``r``.
_OF_INVERSES = {
    "asin": ("r", "u", "1 - u*u"),
    "acos": ("u", "r", "1 - u*u"),
    "atan": ("1/r", "u/r", "1 + u*u"),
    "atan2": ("v/r", "u/r", "u*u + v*v"),
}
#: The same of hyperbolic functions.
_OF_HYPERBOLIC_INVERSES = {
    "asinh": ("r", "u", "1 + u*u"),
    "atanh": ("1/r", "u/r", "1 - u*u"),
}
#: What undoes a function on all of its values.
_UNDONE = {"asinh": "sinh", "atanh": "tanh", "tanh": "atanh"}


def known_value(field: Field, function: str, *arguments: Element) -> Element | None:
    """The value of a function where it is an element without it; else None.

    >>> field = Field(["m", "q"], slots=1, positive=["m"])
    >>> known_value(field, "sqrt", 4 * field["m"] ** 2), known_value(field, "sqrt", field["q"] ** 2)
    (2*m, None)
    """
    argument, at_zero = arguments[0], ELEMENTARY[function].at_zero
    if at_zero is not None and argument == 0:
        return field.number(at_zero)
    match function:
        case "sin" | "cos":
            found = _of_inverse(field, function == "sin", argument, _OF_INVERSES)
            return found or _of_turn(field, function, argument)
        case "sinh" | "cosh":
            return _of_inverse(field, function == "sinh", argument, _OF_HYPERBOLIC_INVERSES)
        case "tanh" | "asinh" | "atanh":
            return _undo(field, function, argument)
        case "sign":
            return _sign(field, argument)
        case "sqrt":
            return _root(field, argument)
        case "log":
            return field.zero if argument == 1 else _exponent(field, argument)
        case "exp":
            return _power(field, argument)
    return None


def _of_inverse(
    field: Field, is_sine: bool, argument: Element, inverses: Mapping[str, tuple[str, str, str]]
) -> Element | None:
    """The sine or cosine of an inverse function: ``cos(asin(u)) = sqrt(1 - u^2)``."""
    for name in field.functions_in(argument):
        known = field.adjoined[name]
        if known.function in inverses and argument == field[name]:
            cosine, sine, square = inverses[known.function]
            own, values = Arithmetic(number=field.number, call=field.call), by_name(known.arguments)
            root = field.call("sqrt", evaluate(square, own, **values))
            return cast(Element, evaluate(sine if is_sine else cosine, own, r=root, **values))
    return None


def _undo(field: Field, function: str, argument: Element) -> Element | None:
    """The u of ``asinh(sinh(u))``, or of ``atanh(sinh(u)/cosh(u))``."""
    for name in sorted(field.functions_in(argument)):
        known = field.adjoined[name]
        if known.function == _UNDONE[function] and argument == field[name]:
            return known.argument
        is_sine = function == "atanh" and known.function == "sinh"
        if is_sine and argument == field[name] / field[known.partner]:
            return known.argument
    return None


def _of_turn(field: Field, function: str, argument: Element) -> Element | None:
    """The cosine or sine of a multiple of pi/3 or pi/2 that is a rational number."""
    half = half_turns(field, argument)
    if half is None:
        return None
    place = (half if function == "cos" else Fraction(1, 2) - half) % 2
    place = min(place, 2 - place)
    value = _COSINES.get(min(place, 1 - place))
    if value is None:
        return None
    return field.number(value if place <= Fraction(1, 2) else -value)


#: Cosines by the part of pi, up to a half.
_COSINES = {Fraction(0): Fraction(1), Fraction(1, 3): Fraction(1, 2), Fraction(1, 2): Fraction(0)}


def half_turns(field: Field, argument: Element) -> Fraction | None:
    """The rational number that pi is multiplied by, ``4*atan(1)``; None of what is none."""
    for name in field.names_in(argument) & field.adjoined.keys():
        if field.adjoined[name].function == "atan" and field.adjoined[name].argument == 1:
            number = field.as_number(argument / field[name])
            return None if number is None else number / 4
    return None


def _sign(field: Field, argument: Element) -> Element | None:
    """The sign of a product of factors, of which each is irreducible; None of a single one.

    Raises:
        ZeroDivisionError: Of 0, where a sign jumps.
    """
    whole = field.normal(argument).combine()
    if whole == 0:
        raise ZeroDivisionError("the sign of 0")
    if (known := sign(field, whole)) != 0:
        return field.number(known)
    top, bottom = field.fraction(whole)
    content, factors = factors_of(top)
    powers = list(factors)
    for divisor, power in bottom:
        powers += [(f, e * power) for f, e in factors_of(divisor)[1]]
    is_single = len(powers) == 1 and powers[0][1] == 1 and content == 1 and not bottom
    if is_single or len(powers) > field.room:  # then it has a generator of its own
        return None
    signs = (field.call("sign", field.from_polynomial(f)) ** e for f, e in powers)
    return field.normal(reduce(mul, signs, field.number(1 if content > 0 else -1)))


def _root(field: Field, argument: Element) -> Element | None:
    """The square root of a square whose root has a declared sign."""
    whole = field.normal(argument).combine()
    if whole == 0:
        return whole
    top, bottom = field.fraction(whole)
    content, factors = factors_of(top)
    number = rational_root(to_fraction(content))
    if number is None:
        return None
    powers = list(factors)
    for divisor, power in bottom:
        content, inner = factors_of(divisor)
        assert content == 1, divisor  # divisors are monic
        powers += [(f, -e * power) for f, e in inner]
    if any(e % 2 for _, e in powers):
        return None
    parts = (field.from_polynomial(f) ** (e // 2) for f, e in powers)
    root = reduce(mul, parts, field.number(number))
    result = sign(field, root, strict=False)
    return root * result if result else None


def _exponent(field: Field, argument: Element) -> Element | None:
    """The argument of the exponential that an element is."""
    for name in field.functions_in(argument):
        if field.adjoined[name].function == "exp" and argument == field[name]:
            return field.adjoined[name].argument
    return None


def _power(field: Field, argument: Element) -> Element | None:
    """``exp((n + a)*log(u) + v) = u^n*exp(a*log(u) + v)`` for whole n, and n + 1/2 alone."""
    for name in sorted(field.names_in(argument) & field.adjoined.keys()):
        known = field.adjoined[name]
        if known.function != "log":
            continue
        numbers = map(field.as_number, field.terms(field.slope(argument, name)))
        slope = sum((number for number in numbers if number is not None), Fraction(0))
        whole = slope if (2 * slope).denominator == 1 else Fraction(floor(slope))
        if not whole or abs(whole) > EXPONENT:
            continue
        rest = field.call("exp", argument - whole * field[name])
        if whole.denominator == 1:
            return rest * known.argument ** int(whole)
        return rest * field.call("sqrt", known.argument) ** int(2 * whole)
    return None
