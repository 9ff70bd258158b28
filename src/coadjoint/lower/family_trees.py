"""Lowering, trees of families: SymPy's trees of a member or pair become nodes of a graph.

Comes in: trees, and the names of their symbols. Goes out: their nodes.
Read next: `coadjoint.lower.families`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Final

import sympy

from coadjoint.elementary import ELEMENTARY
from coadjoint.families import Symbol, Tree
from coadjoint.lower.graph import Graph

#: Digits of constants that are no rational numbers, such as pi.
_DIGITS: Final = 60


class Inserting:
    """SymPy's trees as nodes of a graph.

    A denominator that several quotients share becomes one reciprocal, and so does one that both
    members of a pair share.
    """

    def __init__(
        self,
        graph: Graph,
        names: Mapping[Symbol, str],
        own: frozenset[Symbol],
        trees: Sequence[Tree],
        others: Mapping[str, str],
    ) -> None:
        self.graph, self._names, self._own, self._trees = graph, names, own, trees
        self._others, self._exchanged = others, dict[int, int]()
        self._defined: dict[Symbol, int] = {}
        self._quotients: dict[Tree, set[Tree]] = {}
        for tree in trees:
            for each in sympy.preorder_traversal(tree):
                _, _, below = _split(each)
                if below:
                    self._quotients.setdefault(below, set()).add(each)

    def nodes(self, definitions: Sequence[Symbol] = ()) -> Iterable[int]:
        """The node of each tree; the first ones define symbols that later ones read."""
        for symbol, tree in zip(definitions, self._trees, strict=False):
            self._defined[symbol] = self.node(tree)
        return map(self.node, self._trees[len(definitions) :])

    def node(self, tree: Tree) -> int:
        """The node of a tree."""
        graph = self.graph
        if tree in self._defined:
            return self._defined[tree]
        if tree in self._names:
            return graph.symbol(self._names[tree])
        if tree.is_Rational:
            return graph.number(_as_fraction(tree))
        if tree.is_NumberSymbol:
            return graph.number(_as_fraction(tree))
        if tree.is_Add:
            return graph.sum(map(self.node, tree.as_ordered_terms()))
        if tree.is_Mul or tree.is_Pow:
            return self._quotient(tree)
        name = {"Abs": "abs", "Min": "min", "Max": "max"}.get(type(tree).__name__, str(tree.func))
        assert name in ELEMENTARY, tree
        return graph.call(name, *map(self.node, tree.args))

    def _quotient(self, tree: Tree) -> int:
        """A product, perhaps over another one."""
        graph, (number, above, below) = self.graph, _split(tree)
        # what all lanes share comes first: it is computed once for them
        ordered = sorted(above, key=lambda factor: bool(factor.free_symbols & self._own))
        node = graph.product([graph.number(abs(number)), *map(self._power, ordered)])
        if below:
            divisor = graph.product(map(self._power, below))
            if len(self._quotients[below]) > 1 or self._is_shared(node, divisor):
                node = graph.multiply(node, graph.divide(graph.number(1), divisor))
            else:
                node = graph.divide(node, divisor)
        return graph.negate(node) if number < 0 else node

    def _is_shared(self, node: int, divisor: int) -> bool:
        """Whether the other member of a pair has the same divisor, with something else above it."""
        other, below = (
            self.graph.exchange(each, self._others, self._exchanged) for each in (node, divisor)
        )
        return below == divisor and other not in (node, self.graph.negate(node))

    def _power(self, factor: Tree) -> int:
        """A factor, of which the exponent is positive."""
        base, exponent = (factor, sympy.S.One) if factor.is_Function else factor.as_base_exp()
        if exponent == 1:
            return self.node(factor)
        graph = self.graph
        if not (2 * exponent).is_Integer:
            power = graph.multiply(self.node(exponent), graph.call("log", self._base(base)))
            return graph.call("exp", power)
        node = self.node(base)
        whole, half = divmod(int(2 * exponent), 2)
        return graph.product([node] * whole + [graph.call("sqrt", node)] * half)

    def _base(self, base: Tree) -> int:
        """The base of a root, as the square that it is: multiplied out it rounds to below zero."""
        if not base.is_Add:
            return self.node(base)
        number, factors = sympy.sqf_list(base)
        if not sympy.sqrt(number).is_Rational or any(power % 2 for _, power in factors):
            return self.node(base)
        root = sympy.sqrt(number) * sympy.prod(each ** (power // 2) for each, power in factors)
        node = self.node(root)
        return self.graph.multiply(node, node)


def _as_fraction(number: Tree) -> Fraction:
    """A rational number as it is, another one to many digits."""
    if number.is_Rational:
        return Fraction(int(number.p), int(number.q))
    return Fraction(str(number.evalf(_DIGITS)))


def _split(tree: Tree) -> tuple[Fraction, tuple[Tree, ...], tuple[Tree, ...]]:
    """The number, the factors and the divisors of a product; a sum or function is one factor."""
    if not (tree.is_Mul or tree.is_Pow):
        return Fraction(1), (tree,), ()
    number = Fraction(1)
    above, below = list[Tree](), list[Tree]()
    for factor in sympy.Mul.make_args(tree):
        base, exponent = (factor, sympy.S.One) if factor.is_Function else factor.as_base_exp()
        if (base.is_Rational or base.is_NumberSymbol) and exponent.is_Integer:
            number *= _as_fraction(base) ** int(exponent)
        elif exponent.is_negative:
            below.append(base**-exponent)
        else:
            above.append(factor)
    return number, tuple(above), tuple(below)


def factor(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """A sum over the components of a member, and sums within it over the parameters."""
    if tree.is_Add and len(tree.args) > 2:
        tree = sympy.collect(tree, own)
    return tree.replace(
        lambda part: part.is_Add and len(part.args) > 1, lambda part: sympy.collect(part, shared)
    )


def factor_whole(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """The same with what all terms share before the sum."""
    return sympy.factor_terms(factor(tree, own, shared))


def leave(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """The same as it is written."""
    return tree
