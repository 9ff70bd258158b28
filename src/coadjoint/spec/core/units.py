"""Units: what the unit of a formula is, from the units of its names.

Comes in: unit texts such as ``kg m^2/s`` and an expression tree. Goes out: the unit of its value,
or None where the declared units do not tell. Units label results and pictures; they are never
checked or converted, since many specs leave some out. Read next: `coadjoint.pipeline`, which asks
for the units of energy and Casimirs.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

from coadjoint.spec.core import tree

#: Exponents by symbol, zeros left out; empty for a pure number.
Unit = Mapping[str, Fraction]

_FACTOR = re.compile(r"([A-Za-z]+)(?:\^(-?\d+))?|1")
_SAME = ("transpose", "trace", "diag", "hat", "norm", "abs")
_PRODUCT = ("dot", "cross", "commutator", "outer")


def parse_unit(text: str) -> Unit | None:
    """A unit text as exponents; None for what is not a plain product of powers.

    >>> parse_unit("kg m^2/s") == {"kg": 1, "m": 2, "s": -1}
    True
    """
    exponents: dict[str, Fraction] = {}
    pieces = re.split(r"([ */.]+)", text.strip())
    for place, piece in enumerate(pieces[::2]):
        factor = _FACTOR.fullmatch(piece)
        if factor is None:
            return None
        divided = place > 0 and "/" in pieces[2 * place - 1]
        if factor[1]:
            exponent = Fraction(factor[2] or 1) * (-1 if divided else 1)
            exponents[factor[1]] = exponents.get(factor[1], Fraction(0)) + exponent
    return _drop_zeros(exponents)


def unit_text(unit: Unit | None) -> str:
    """A unit as text, ``1`` for a pure number, empty if it is not known.

    >>> unit_text(parse_unit("1/s * kg m^2 / s"))
    'kg m^2/s^2'
    """
    if unit is None:
        return ""
    if any(exponent.denominator != 1 for exponent in unit.values()):
        return ""
    over = [_power(name, exponent) for name, exponent in sorted(unit.items()) if exponent > 0]
    under = [_power(name, -exponent) for name, exponent in sorted(unit.items()) if exponent < 0]
    return "/".join([" ".join(over) or "1", *under])


def unit_of(node: tree.Node, units: Mapping[str, Unit | None]) -> Unit | None:
    """The unit of an expression; None if its parts do not agree or are not known.

    Args:
        node: A parsed expression.
        units: Unit of each name, quantities and components alike.
    """
    return tree.fold(node, lambda part, below: _unit(part, below, units))


def product_of(units: Mapping[str, Unit | None], powers: Iterable[tuple[str, int]]) -> Unit | None:
    """The unit of a product of powers of names; None if one is not known.

    >>> unit_text(product_of({"M": parse_unit("kg m^2/s"), "a": {}}, [("M", 2), ("a", 1)]))
    'kg^2 m^4/s^2'
    """
    whole: Unit | None = {}
    for name, exponent in powers:
        whole = _combine("*", whole, _raise_to(units.get(name), Fraction(exponent)))
    return whole


def _unit(
    node: tree.Node, below: list[Unit | None], units: Mapping[str, Unit | None]
) -> Unit | None:
    """The unit of one node from those of its children."""
    match node:
        case tree.Number():
            return {}
        case tree.Name(name=name) | tree.Index(name=name):
            return units.get(name)
        case tree.Negate() | tree.Component():
            return below[0]
        case tree.Power(exponent=exponent):
            return _raise_to(below[0], Fraction(exponent))
        case tree.Binary(operator=operator):
            return _combine(operator, *below)
        case tree.Call(function=function):
            return _of_call(function, below)
    raise AssertionError(node)


def _of_call(function: str, arguments: list[Unit | None]) -> Unit | None:
    """The unit of a function's value."""
    first = arguments[0]
    if function in _SAME:
        return first
    if function in _PRODUCT:
        return _combine("*", first, arguments[1])
    if function == "sign":
        return {} if first is not None else None
    if function == "atan2":
        return {} if first is not None and first == arguments[1] else None
    if function == "pow":
        return {} if first == arguments[1] == {} else None
    if function in ("rows", "vector", "complex", "min", "max"):
        return first if all(argument == first for argument in arguments) else None
    if function == "inverse":
        return _raise_to(first, Fraction(-1))
    if function == "sqrt":
        return _raise_to(first, Fraction(1, 2))
    # The determinant's unit depends on the size; sin, exp and so on take and give pure numbers.
    return {} if first == {} else None


def _combine(operator: str, left: Unit | None, right: Unit | None) -> Unit | None:
    """The unit of a sum, product or quotient."""
    if left is None or right is None:
        return None
    if operator in "+-":
        return left if left == right else None
    sign = 1 if operator == "*" else -1
    names = left.keys() | right.keys()
    zero = Fraction(0)
    return _drop_zeros(
        {name: left.get(name, zero) + sign * right.get(name, zero) for name in names}
    )


def _raise_to(unit: Unit | None, exponent: Fraction) -> Unit | None:
    """A unit to a power."""
    return None if unit is None else _drop_zeros({name: e * exponent for name, e in unit.items()})


def _drop_zeros(unit: Mapping[str, Fraction]) -> Unit:
    return {name: exponent for name, exponent in unit.items() if exponent}


def _power(name: str, exponent: Fraction) -> str:
    return name if exponent == 1 else f"{name}^{exponent}"
