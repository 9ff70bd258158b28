"""Lowering, trees compared: whether two of SymPy's have one value.

Comes in: two trees. Goes out: whether they are equal, as polynomials and quotients where they call
no function, else at points to 60 digits. Read next: `coadjoint.lower.family_check`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import sympy
from sympy.polys import lex
from sympy.polys.rings import PolyRing

from coadjoint.families import Symbol, Tree

#: Digits of the comparison where functions are called, and how much of them has to agree.
_DIGITS: Final = 60
_CLOSE: Final = sympy.Float(10) ** -45
#: Points of it, and how many are tried: some have no value.
_POINTS, _TRIES = 5, 40


@dataclass(frozen=True)
class Polynomials:
    """Trees as polynomials with rational coefficients.

    They take a tenth of the time of trees that SymPy expands or differentiates.

    Attributes:
        values: The polynomials.
        ring: Theirs.
        relations: What stands for a divisor or a root, which is a symbol there: the power that it
            is known by, -1 or 2, and what this power is. Later ones may name earlier symbols.
    """

    values: list[Any]
    ring: PolyRing
    relations: Mapping[Symbol, tuple[int, Tree]]

    @property
    def inverses(self) -> dict[Symbol, Tree]:
        """The inverses of divisors, by their symbols."""
        return {own: 1 / base for own, (power, base) in self.relations.items() if power < 0}

    @property
    def divisors(self) -> set[Symbol]:
        """Symbols in divisors."""
        return {s for inverse in self.inverses.values() for s in inverse.free_symbols}

    def is_same(self) -> bool:
        """Whether two have one value: divisors and roots are taken out of their difference.

        False also where it is not known, since these call functions.
        """
        one, other = self.values
        difference = one - other
        for own, (power, base) in reversed([*self.relations.items()]):
            if not difference:
                return True
            try:
                symbol, known = self.ring(own), self.ring.from_expr(base)
            except ValueError:
                return False
            place = self.ring.index(symbol)
            most, left = difference.degree(symbol), self.ring.zero
            for exponents, coefficient in difference.terms():
                k = exponents[place]
                times, rest = (most - k, 0) if power < 0 else divmod(k, power)
                exponents = (*exponents[:place], rest, *exponents[place + 1 :])
                left += self.ring.term_new(exponents, coefficient) * known**times
            difference = left
        return not difference


def find_polynomials(
    trees: Sequence[Tree], others: Iterable[Symbol] = (), *, roots: bool = False
) -> Polynomials | None:
    """Trees as polynomials in all their symbols, in inverses and, if so, in square roots.

    None where they call functions, or have roots that are not wanted.

    Args:
        trees: The trees.
        others: Symbols that the ring has as well.
        roots: Whether square roots are wanted.
    """
    relations, known = dict[Symbol, tuple[int, Tree]](), dict[tuple[int, Tree], Symbol]()

    def relate(power: int, base: Tree) -> Symbol:
        symbol = known.setdefault((power, base), sympy.Dummy())
        relations.setdefault(symbol, (power, base))
        return symbol

    def stand_in(tree: Tree) -> Tree:
        base, power = tree.base.expand(), tree.exp
        if power.q == 2:
            base, power = relate(2, base), 2 * power
        return base**power if power > 0 else relate(-1, base) ** -power

    def is_replaced(tree: Tree) -> bool:
        if not (tree.is_Pow and tree.exp.is_Rational):
            return False
        return bool(tree.exp < 0) if tree.exp.is_Integer else roots and tree.exp.q == 2

    plain = [tree.replace(is_replaced, stand_in) for tree in trees]
    bases = [base for _, base in relations.values()]
    symbols = {*others}.union(*(tree.free_symbols for tree in (*plain, *bases)))
    if not symbols:
        return None
    ring = PolyRing(sorted(symbols, key=str), sympy.QQ, lex)
    try:
        values = [ring.from_expr(tree) for tree in plain]
    except ValueError:
        return None
    return Polynomials(values, ring, relations)


def are_equal(found: Tree, wanted: Tree) -> bool:
    """Whether two trees have one value.

    It is told by polynomials and quotients where they call no function, else at points.
    """
    if found == wanted:
        return True
    polynomials = find_polynomials([found, wanted], roots=True)
    if polynomials and polynomials.is_same():
        return True
    difference = found - wanted
    if not difference.has(sympy.Function) and not difference.atoms(sympy.NumberSymbol):
        return difference.expand() == 0 or bool(sympy.cancel(sympy.together(difference)) == 0)
    names = sorted(found.free_symbols | wanted.free_symbols, key=str)
    source, compared = random.Random(1), 0  # noqa: S311
    for _ in range(_TRIES):
        # in no order, so that what is larger on one side of a kink is smaller on the other
        at = {s: sympy.Rational(source.randrange(1, 64), source.randrange(8, 32)) for s in names}
        one, other = (each.xreplace(at).evalf(_DIGITS) for each in (found, wanted))
        if not other.is_finite:  # as a slope of sqrt(max(x, 0)) below 0
            continue
        if not (one.is_finite and abs(one - other) <= _CLOSE * (1 + abs(other))):
            return False
        compared += 1
        if compared == _POINTS:
            return True
    return False
