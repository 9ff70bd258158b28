"""Undetermined functions: symbols for a function and its derivatives, and the chain rule.

Comes in: names of functions. Goes out: a field in which each function and each of its partial
derivatives is a symbol of its own. What is zero there is zero for every smooth function: a proof
for all of them, where an example would speak for itself only.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

from coadjoint.exact import Element, Field


class Jet:
    """Functions of n coordinates that nothing is known of, up to their second derivatives.

    Args:
        functions: Their names; ``c`` has the derivatives ``c_1, c_2, c_11, c_12, ...``.
        size: Number of coordinates.

    >>> jet = Jet(["c"], 2)
    >>> jet.slopes(jet["c"] ** 2)
    [(0, 2*c*c_1), (1, 2*c*c_2)]
    """

    def __init__(self, functions: Sequence[str], size: int) -> None:
        self.size = size
        self._raised: dict[str, list[str]] = {}
        names: list[str] = []
        for function in functions:
            for order in range(3):
                for places in combinations_with_replacement(range(size), order):
                    name = _name(function, places)
                    names.append(name)
                    if order < 2:
                        further = [_name(function, (*places, m)) for m in range(size)]
                        self._raised[name] = further
        self.field = Field(names)

    def __getitem__(self, name: str) -> Element:
        return self.field[name]

    def gradient(self, function: str) -> tuple[Element, ...]:
        """The symbols of its first derivatives."""
        return tuple(self.field[name] for name in self._raised[function])

    def slopes(self, element: Element) -> list[tuple[int, Element]]:
        """Total derivatives by the coordinates, by the chain rule; zeros are left out."""
        totals = [self.field.zero] * self.size
        for name in sorted(self.field.reach(element)):
            assert name in self._raised, f"the derivative of {name} is beyond the second order"
            outer = self.field.derivative(element, name)
            for m, further in enumerate(self._raised[name]):
                totals[m] = totals[m] + outer * self.field[further]
        return [(m, total) for m, total in enumerate(totals) if total]


def _name(function: str, places: Sequence[int]) -> str:
    """``c_12`` for the derivative of c by the first and second coordinate, in either order."""
    digits = "".join(str(m + 1) for m in sorted(places))
    return f"{function}_{digits}" if digits else function
