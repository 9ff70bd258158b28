r"""Inverses of functions of one variable, in closed form: Legendre transforms of one velocity.

An equation :math:`f(x) = y` is taken apart from outside. If f names x in one function alone,
:math:`f = (a\,F(u) + b)/(c\,F(u) + d)`, then :math:`F(u)` is a quotient in y, and :math:`u(x)` is
the inverse of F there: one step of the same kind further in. It ends where f is itself such a
quotient of x, or a power :math:`f = b + a\,w^r` of a positive w that is linear in x. So
:math:`\log x + 1 = y` has :math:`x = e^{y - 1}`, and :math:`\arctan x = y` has :math:`x = \tan y`.
Functions with several inverses, as sines, are left alone.

An inverse may be defined for more y than f has as values: :math:`\tan y` has a value beyond
:math:`\pi/2`. What is positive on the range of f comes with it.
Comes in: f. Goes out: x in terms of y. Read next: `coadjoint.derive.mechanics.legendre`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from types import MappingProxyType

from coadjoint.exact import Element, Field
from coadjoint.exact.signs import sign


@dataclass(frozen=True)
class Inverse:
    """The solution of ``f(x) = y``.

    Attributes:
        value: x in terms of y.
        known: Functions of x that are simpler in y, by their generators: ``log(x)`` is ``y - 1``.
        range: What is positive for y that are values of f, where x does not ask for it by itself.
    """

    value: Element
    known: Mapping[str, Element]
    range: tuple[Element, ...]


def find_inverse(
    field: Field, function: Element, name: str, value: Element, asked: Iterable[Element] = ()
) -> Inverse | None:
    """The solution of ``f(x) = y`` for x; None where this module has none.

    What comes out is put into f, and f into it: it is the only solution, whatever led to it.

    Args:
        field: Where everything lives.
        function: f.
        name: x, a symbol.
        value: y, a symbol times a number.
        asked: What else is positive wherever x has a meaning.

    >>> field = Field(["v", "m", "p"], slots=6, positive=["m"])
    >>> v, m, p = (field[name] for name in "vmp")
    >>> found = find_inverse(field, m * field.call("log", v) + m, "v", p)
    >>> field.to_sympy(found.value)
    exp((-m + p)/m)
    """
    with suppress(ZeroDivisionError, OverflowError, ValueError):
        found = _solve(field, function, name, value)
        if found is None:
            return None
        there = field.substitute(function, dict(found.known) | {name: found.value})
        (symbol,) = field.names_in(value)
        forth = {symbol: field[symbol] * function / value}
        back = field.substitute(found.value, forth)
        if field.is_zero(there - value) and field.is_zero(back - field[name]):
            at = {name: found.value}
            wanted = [field.substitute(each, at) for each in asked if sign(field, each) != 1]
            known = [field.domain_of(field.adjoined[g]) for g in field.functions_in(found.value)]
            return replace(found, range=_lacking(field, [*found.range, *wanted], known))
    return None


def _solve(field: Field, function: Element, name: str, value: Element) -> Inverse | None:
    """One step further in."""
    whole = field.normal(function)
    called = field.names_in(whole) & field.adjoined.keys()
    outer = [g for g in called if name in field.reach(field[g])]
    if not outer:
        root = _solve_quotient(field, whole, name, name, value)
        if root is not None:
            return Inverse(value=root, known={}, range=())
        return _solve_power(field, whole, name, value)
    if len(outer) == 1 and name not in field.names_in(whole):
        (generator,) = outer
        known = field.adjoined[generator]
        image = _solve_quotient(field, whole, generator, name, value)
        undo = _INVERSES.get(known.function)
        if image is not None and undo is not None:
            inner, bounds = undo(field, image)
            if (found := _solve(field, known.argument, name, inner)) is not None:
                images = {**found.known, generator: image}
                return replace(found, known=images, range=(*bounds, *found.range))
    if (ratio := _solve_ratio(field, whole, outer, name, value)) is not None:
        return ratio
    return _solve_power(field, whole, name, value)


def _lacking(
    field: Field, wanted: Iterable[Element], known: Iterable[Element | None]
) -> tuple[Element, ...]:
    """What may not be positive where other elements are."""
    given, lacking = [each for each in known if each is not None], list[Element]()
    for each in map(field.normal, wanted):
        if sign(field, each) != 1 and not any(sign(field, each / a) == 1 for a in given):
            given.append(each)
            lacking.append(each.combine())
    return tuple(lacking)


def _solve_quotient(
    field: Field, whole: Element, generator: str, name: str, value: Element
) -> Element | None:
    """The g from ``(a g + b)/(c g + d) = y``, where x is in g alone; None of anything else."""
    (quotient,) = field.quotients(whole.combine())
    below = field.one
    for divisor, exponent in quotient.divisors:
        below *= divisor**exponent
    try:
        top, bottom = (
            field.coefficients(field.normal(e), generator) for e in (whole * below, below)
        )
    except ValueError:  # a function of the generator
        return None
    if not (top.keys() | bottom.keys()) <= {0, 1}:
        return None
    a, b, c, d = (e.get(n, field.zero) for e in (top, bottom) for n in (1, 0))
    if any(name in field.reach(each) for each in (a, b, c, d)):
        return None
    return (value * d - b) / (a - value * c)


def _solve_ratio(
    field: Field, whole: Element, outer: list[str], name: str, value: Element
) -> Inverse | None:
    """A hyperbolic tangent that is written as the quotient of sine and cosine."""
    sines = [g for g in outer if field.adjoined[g].function == "sinh"]
    if len(sines) != 1 or {sines[0], field.adjoined[sines[0]].partner} != {*outer}:
        return None
    if name in field.names_in(whole):
        return None
    (sine,), cosine = sines, field.adjoined[sines[0]].partner
    in_tangent = field.normal(field.substitute(whole, {sine: field[name] * field[cosine]}))
    if cosine in field.names_in(in_tangent):
        return None
    tangent = _solve_quotient(field, in_tangent, name, name, value)
    if tangent is None:
        return None
    return _solve(field, field.adjoined[sine].argument, name, field.call("atanh", tangent))


def _solve_power(field: Field, whole: Element, name: str, value: Element) -> Inverse | None:
    """``w^r`` from ``b + a w^r = y``, for a positive w that is linear in x.

    Slopes of f where w is 1 give r, a and b, and whether f is such a power shows in the end.
    """
    slope = field.derivative(whole, name)
    bend = field.derivative(slope, name)
    if bend == 0:
        return None
    for w in _bases(field, whole, slope / bend, name):
        along = field.normal(field.derivative(w, name))
        if along == 0 or name in field.reach(along):
            continue
        one = {name: field.normal(field[name] + (1 - w) / along)}
        exponent = field.normal(field.substitute(bend / (slope * along), one)) + 1
        factor = field.normal(field.substitute(slope / (exponent * along), one))
        rest = field.normal(field.substitute(whole, one) - factor)
        power = (value - rest) / factor
        root = field.call("exp", field.call("log", power) / exponent)
        solution = field.normal(field[name] + (root - w) / along)
        return Inverse(value=solution, known={}, range=(power,))
    return None


def _bases(field: Field, whole: Element, ratio: Element, name: str) -> list[Element]:
    """What is positive and may be the base of a power: in a root or logarithm, or by its sign."""
    called = (field.adjoined[g] for g in sorted(field.functions_in(whole)))
    bases = [known.argument for known in called if known.function in ("sqrt", "log")]
    along = field.derivative(ratio := field.normal(ratio), name)
    if along != 0 and name not in field.reach(along) and sign(field, ratio / along) == 1:
        bases.append(ratio / along)
    return [each for each in bases if name in field.reach(each)]


#: An inverse at a value of the function, and what is positive where that is one.
Undo = Callable[[Field, Element], tuple[Element, tuple[Element, ...]]]


def _call(function: str) -> Undo:
    """A function that has a value nowhere but on the range."""
    return lambda field, z: (field.call(function, z), ())


def _undo_atan(field: Field, z: Element) -> tuple[Element, tuple[Element, ...]]:
    """``u = tan(z)``, for angles between -pi/2 and pi/2."""
    quarter = 2 * field.call("atan", field.one)
    return field.call("tan", z), (quarter**2 - z**2,)


_INVERSES: Mapping[str, Undo] = MappingProxyType(
    {
        "exp": _call("log"),
        "log": _call("exp"),
        "sinh": _call("asinh"),
        "tanh": _call("atanh"),
        "asinh": _call("sinh"),
        "atanh": _call("tanh"),
        "atan": _undo_atan,
        "sqrt": lambda field, z: (z**2, (z,)),
    }
)
