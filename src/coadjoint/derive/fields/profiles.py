"""Profiles: the fields at the beginning, evaluated at points of the circle or the plane.

Comes in: a Spec with [profiles]. Goes out: numbers at the defaults of the parameters, computed to
50 digits and rounded to doubles. Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any, cast

import mpmath

from coadjoint.derive.interpret import Values, entries, interpret
from coadjoint.derive.setting import Setting, assemble, fault
from coadjoint.errors import DerivationError
from coadjoint.exact import Field
from coadjoint.spec import Spec

#: Digits of the arithmetic.
DIGITS = 50


class _Numbers(Values):
    """Numbers of many digits."""

    zero, one = mpmath.mpf(0), mpmath.mpf(1)

    def number(self, value: Fraction) -> Any:
        """A rational number."""
        return mpmath.mpf(value.numerator) / value.denominator

    def is_zero(self, value: Any) -> bool:
        """Whether a number is 0."""
        return bool(value == 0)

    def call(self, function: str, *arguments: Any) -> Any:
        """An elementary function."""
        return getattr(mpmath, function)(*arguments)

    def absolute(self, value: Any) -> Any:
        """The absolute value."""
        return abs(value)

    def power(self, base: Any, exponent: Any) -> Any:
        """A power with any exponent."""
        return base**exponent


def evaluate_profile(spec: Spec, name: str, *parts: Fraction) -> tuple[Fraction, ...]:
    """The components of a field at a part of the way around the circle, or around both circles.

    Args:
        spec: With a profile of the field.
        name: The field.
        parts: From 0 to 1, one for each coordinate.
    """
    space, numbers = spec.space, _Numbers()
    assert space is not None, spec.name
    with mpmath.workdps(DIGITS):
        values = dict[str, Any]()
        for each in spec.parameters:
            own = [numbers.number(x) for x in each.default or ()]
            values |= zip(each.components, own, strict=True)
            values[each.name] = assemble(each, values)
        for along, part in zip((space, space.across), parts, strict=False):
            assert along is not None, spec.name
            values[along.name] = numbers.number(part) * values[along.length]
        value = interpret(spec.profiles[name].tree, values, cast("Field", numbers))
        numbers_of: Any = entries(value)
        return tuple(Fraction(float(x)) for x in numbers_of)


def check_profiles(setting: Setting) -> None:
    """Each profile has a value at the first point, which all numbers of points have.

    Raises:
        DerivationError: One has none, as ``1/s``.
    """
    spec = setting.spec
    assert spec.space is not None, spec.name
    origin = [Fraction(0)] * len(spec.space.coordinates)
    for name, formula in spec.profiles.items():
        try:
            evaluate_profile(spec, name, *origin)
        except (DerivationError, ArithmeticError, ValueError, TypeError) as error:
            where = " and ".join(f"{each} = 0" for each in spec.space.coordinates)
            message = f"the profile of {name} has no value at {where}; expected one at each point."
            raise fault(setting, formula, message, formula.text) from error


def sample_profiles(spec: Spec) -> dict[str, tuple[tuple[Fraction, ...], ...]]:
    """The fields at the beginning at the declared points, by component; nothing without a number.

    In a plane points follow each other along the second coordinate first.
    """
    space = spec.space
    assert space is not None, spec.name
    sizes = [each.size or 0 for each in (space, space.across) if each is not None]
    steps = [size - space.has_ends for size in sizes]  # a line has a point at each end
    places = [*product(*map(range, sizes))]
    found = dict[str, tuple[tuple[Fraction, ...], ...]]()
    for name in spec.profiles if all(sizes) else ():
        points = (evaluate_profile(spec, name, *map(Fraction, place, steps)) for place in places)
        found[name] = tuple(zip(*points, strict=True))
    return found
