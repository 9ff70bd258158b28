"""Undetermined functions, for proofs that hold for every function.

Comes in: names of variables and of functions of them. Goes out: a `JetField`, in which a function
and each of its partial derivatives is a symbol of its own, and `derivative` by a variable is the
total derivative: the chain rule leads from each symbol to the next.
Read next: `coadjoint.groups.vector_fields`, `coadjoint.theory.nambu`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

from coadjoint.exact.element import Element
from coadjoint.exact.field import Field


class JetField(Field):
    """Rational functions of variables and of undetermined smooth functions of them.

    Args:
        variables: Names of the variables.
        functions: Names of the functions; each depends on all variables.
        order: The highest derivative that a proof may reach; the symbols grow fast with it.
        parameters: Names of constants.

    >>> field = JetField(["x", "y"], ["f"], order=2)
    >>> field.derivative(field["x"] * field["f"], "x") == field["f"] + field["x"] * field["f_x"]
    True
    """

    def __init__(
        self,
        variables: Sequence[str],
        functions: Sequence[str],
        order: int,
        parameters: Sequence[str] = (),
    ) -> None:
        self.variables = tuple(variables)
        self._jets = {
            _jet_name(function, places): (function, places)
            for count in range(order + 1)
            for function in functions
            for places in combinations_with_replacement(variables, count)
        }
        super().__init__([*variables, *parameters, *self._jets])

    def derivative(self, element: Element, name: str) -> Element:
        """The total derivative by a variable; by any other symbol, the partial one.

        Raises:
            KeyError: The proof needs a derivative beyond the order of the field.
        """
        result = super().derivative(element, name)
        if name in self.variables:
            for jet in sorted(self.names_in(element) & self._jets.keys()):
                result += super().derivative(element, jet) * self[self._next(jet, name)]
        return result

    def reach(self, element: Element) -> frozenset[str]:
        """Symbols that occur, and all variables where a function does, since it depends on them."""
        names = super().reach(element)
        return names | frozenset(self.variables) if names & self._jets.keys() else names

    def _next(self, jet: str, name: str) -> str:
        """The symbol of the derivative of a symbol; partial derivatives commute."""
        function, places = self._jets[jet]
        return _jet_name(function, sorted((*places, name), key=self.variables.index))


def _jet_name(function: str, places: Sequence[str]) -> str:
    return "_".join((function, *places))
