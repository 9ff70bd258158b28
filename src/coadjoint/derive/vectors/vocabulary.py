"""Products of the vectors and matrices of a vocabulary, each with its exact value.

Comes in: words with their values. Goes out: candidates for what a rate is made of, by how simple
they are. Read next: `coadjoint.derive.vectors.words`, which finds the words of Equations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as attribute
from fractions import Fraction
from functools import cached_property
from itertools import product as pairs

from coadjoint.derive.interpret import Value, entries, interpret
from coadjoint.derive.vectors.attitudes import drop_rotations
from coadjoint.derive.vectors.gradients import Addend
from coadjoint.exact import Element, Field, dense
from coadjoint.groups.quaternions import Quaternion
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape

#: Rows of matrices beyond which products of matrices cost too much.
MOST_ROWS = 10
#: Matrices beyond which their products are too many.
MOST_MATRICES = 8
#: Rows of matrices beyond which products of three cost too much.
MOST_TRIPLE = 2
#: Terms of factors, multiplied, up to which any product is tried; and how many times the terms of
#: what is looked for they may be. Products of longer factors would take minutes.
MOST_CROSSED = 200
MOST_SPREAD = 4
#: Vectors beyond which products of three are too many.
MOST_PLAIN = 8


@dataclass(frozen=True)
class Candidate:
    """A vector or matrix as a tree, and its value in the field, definitions put in."""

    node: tree.Node
    value: Value


@dataclass(frozen=True)
class Part:
    """A part of a quantity that has a short name.

    Attributes:
        rate: The name, with the value of its rate.
        components: The components of the quantity that it is made of.
    """

    rate: Candidate
    components: tuple[str, ...]


@dataclass
class Vocabulary:
    """What may stand in equations of whole quantities.

    Attributes:
        field: Where the values live.
        targets: The whole quantities of the state, each with the value of its rate.
        words: Vectors and matrices, the simplest first.
        scalars: Names that may stand before a vector: parameters, inputs and parts of the state,
            without components.
        named: Further names and what they stand for.
        shapes: Shapes of whole quantities.
        values: The value of each name that a printed tree may hold.
        parts: Of a quantity, the parts that have short names.
        levels: How many kinds of candidates there are, the simplest first.
        moving: Names of the components of the state.
        attitudes: Names of rotations.
        shorten: Puts short names into a formula.
        products: Products of two vectors that were made, by the trees of both.
    """

    field: Field
    targets: tuple[Candidate, ...]
    words: tuple[Candidate, ...]
    scalars: frozenset[str]
    named: tuple[tuple[tree.Node, tree.Node], ...] = ()
    shapes: Mapping[str, Shape] = attribute(default_factory=dict)
    values: Mapping[str, Value] = attribute(default_factory=dict)
    parts: Mapping[str, Sequence[Part]] = attribute(default_factory=dict)
    levels: int = 4
    moving: frozenset[str] = frozenset()
    attitudes: frozenset[tree.Node] = frozenset()
    shorten: Callable[[tree.Node], tree.Node] = lambda node: node
    products: dict[tuple[tree.Node, tree.Node], Candidate] = attribute(default_factory=dict)

    def evaluate(self, node: tree.Node) -> Value:
        """The value of a printed tree, from that of each name in it."""
        return evaluate(node, self.values, self.field)

    def settle(self, addend: Addend) -> Addend:
        """An addend as it is printed: with ``R^T R = 1``, and with short names."""
        if not self.attitudes:
            return addend
        scope = {"pi": (), **self.shapes}

        def settled(node: tree.Node) -> tree.Node:
            return self.shorten(drop_rotations(node, self.attitudes, scope))

        return replace(
            addend,
            above=tuple(map(settled, addend.above)),
            below=tuple(map(settled, addend.below)),
            vector=None if addend.vector is None else settled(addend.vector),
        )

    def candidates(self, like: Value, level: int, *, whole: bool) -> Iterator[Candidate]:
        """Candidates of the shape of a value: the words; their products; products of products.

        Args:
            like: The value.
            level: How far from simple words.
            whole: Whether all terms of a candidate are among those of the value, so that words
                of other quantities of the state alone are not asked for.
        """
        words = self.words
        if whole:
            reached = self._reach(like)
            owned = [(word, self._reach(word.value) & self.moving) for word in words]
            words = tuple(word for word, own in owned if not own or own & reached)
        if isinstance(like[0], tuple):
            yield from self._matrices(words, like, level)
            return
        if len(like) == 1:
            yield from self._dots(words, level)
            return
        same = [word for word in words if measure(word.value) == measure(like)]
        own = [word for word in same if level > 1 or not _is_sum(word.node)]
        # a product of the spec's is no simpler than those of level 1
        yield from (word for word in own if level or not _is_cross(word.node))
        if level and len(like) == 4:
            yield from self._turns(own, words)
        if level:
            yield from self._applied(words, like)
        if level and len(like) == 3:
            most = MOST_CROSSED + MOST_SPREAD * self._count(like) if whole else None
            yield from self._crosses(own, own, most)
        if level > 1 and len(like) != 3:
            yield from self._weighted(own)
        if level > 2 and len(like) == 3:
            plain = [word for word in own if isinstance(word.node, tree.Name | tree.Member)]
            plain = plain[:MOST_PLAIN]
            yield from self._crosses(plain, list(self._crosses(plain, plain)))

    def _crosses(
        self, left: list[Candidate], right: list[Candidate], most: int | None = None
    ) -> Iterator[Candidate]:
        """Products of vectors; none that would have far more terms than some number."""
        counts = {id(word): self._count(word.value) for word in (*left, *right)} if most else {}
        for n, a in enumerate(left):
            for b in right[n + 1 :] if right is left else right:
                if most and counts[id(a)] * counts[id(b)] > most:
                    continue
                found = self._cross(a, b)
                if any(map(bool, found.value)):
                    yield found

    @staticmethod
    def _dots(words: Sequence[Candidate], level: int) -> Iterator[Candidate]:
        """Scalar products, those of vectors with names first."""
        own = [word for word in words if len(measure(word.value)) == 1]
        if level == 0:
            own = [word for word in own if isinstance(word.node, tree.Name)]
        for n, a in enumerate(own if level < 2 else ()):
            for b in own[n:]:
                if measure(a.value) == measure(b.value):
                    node = tree.Call(function="dot", arguments=(a.node, b.node))
                    yield Candidate(node, (dense.dot(a.value, b.value),))

    def _count(self, value: Value) -> int:
        """The number of terms of all components."""
        return sum(self.field.count_terms(each) for each in entries(value))

    def _cross(self, a: Candidate, b: Candidate) -> Candidate:
        """A product, made once: each level of each search begins with the same."""
        known = self.products.get((a.node, b.node))
        if known is None:
            node = tree.Call(function="cross", arguments=(a.node, b.node))
            known = self.products[a.node, b.node] = Candidate(node, dense.cross(a.value, b.value))
        return known

    @staticmethod
    def _applied(words: Sequence[Candidate], like: Value) -> Iterator[Candidate]:
        """Matrices by their names, times vectors by theirs."""
        plain = [word for word in words if isinstance(word.node, tree.Name)]
        for a, b in pairs(plain, plain):
            if measure(a.value) == (len(like), *measure(b.value)):
                node = tree.Binary(operator="*", left=a.node, right=b.node)
                yield Candidate(node, dense.apply(a.value, b.value))

    def _weighted(self, own: list[Candidate]) -> Iterator[Candidate]:
        """Vectors by diagonal matrices, and by scalar products of others, of any length."""
        plain = [word for word in own if isinstance(word.node, tree.Name)][:MOST_PLAIN]
        for n, a in enumerate(plain):  # what is declared first is the state
            for b in plain[:n]:
                node = tree.Call(function="diag", arguments=(a.node,))
                value = tuple(x * y for x, y in zip(a.value, b.value, strict=True))
                yield Candidate(tree.Binary(operator="*", left=node, right=b.node), value)
        for n, a in enumerate(plain):
            for b, c in pairs(plain[n:], plain):
                node = tree.Call(function="dot", arguments=(a.node, b.node))
                value = dense.scale(dense.dot(a.value, b.value), c.value)
                yield Candidate(tree.Binary(operator="*", left=node, right=c.node), value)

    @staticmethod
    def _turns(own: list[Candidate], words: Sequence[Candidate]) -> Iterator[Candidate]:
        """Quaternions times vectors, from either side."""
        for q, w in pairs(own, words):
            if measure(w.value) == (3,):
                a, b = Quaternion(*q.value), Quaternion.pure(w.value)
                yield Candidate(
                    tree.Call(function="qmul", arguments=(q.node, w.node)), (a * b).components
                )
                yield Candidate(
                    tree.Call(function="qmul", arguments=(w.node, q.node)), (b * a).components
                )

    def _matrices(self, words: Sequence[Candidate], like: Value, level: int) -> Iterator[Candidate]:
        own = [w for w in words if measure(w.value) == measure(like)]
        own = [w for w in own if level > 1 or not _is_sum(w.node)]
        if len(like) == 3:
            reached = self._reach(like)
            vectors = [w for w in words if measure(w.value) == (3,)]
            vectors = [w for w in vectors if self._reach(w.value) & self.moving <= reached]
            own += [
                Candidate(tree.Call(function="hat", arguments=(w.node,)), dense.hat(w.value))
                for w in vectors
            ]
        yield from own
        if not level or not len(like[0]) == len(like) <= MOST_ROWS:
            return
        own = own[:MOST_MATRICES]
        if level > 1:
            squares = [
                Candidate(tree.Power(base=w.node, exponent=2), dense.product(w.value, w.value))
                for w in own
            ]
            own += squares
        most = len(like) * (MOST_CROSSED + MOST_SPREAD * self._count(like))
        counts = {id(word): self._count(word.value) for word in own}
        small = [ab for ab in pairs(own, own) if counts[id(ab[0])] * counts[id(ab[1])] <= most]
        places = {id(word): n for n, word in enumerate(own)}
        for a, b in small:
            if places[id(a)] < places[id(b)]:
                value = dense.commutator(a.value, b.value)
                yield Candidate(tree.Call(function="commutator", arguments=(a.node, b.node)), value)
        yield from (self._product(a, b) for a, b in small)
        if level > 2 and len(like) <= MOST_TRIPLE:
            plain = [w for w in own if isinstance(w.node, tree.Name)]
            for a, b, c in pairs(plain, plain, plain):
                whole, turned = (
                    self._product(self._product(*sides), last)
                    for *sides, last in ((a, b, c), (c, b, a))
                )
                yield whole
                node = tree.Binary(operator="-", left=whole.node, right=turned.node)
                yield Candidate(node, dense.subtract(whole.value, turned.value))

    def _reach(self, value: Value) -> frozenset[str]:
        """The names in a value."""
        return frozenset[str]().union(*map(self.field.reach, entries(value)))

    def _product(self, a: Candidate, b: Candidate) -> Candidate:
        node = tree.Binary(operator="*", left=a.node, right=b.node)
        return Candidate(node, dense.product(a.value, b.value))

    def powers_outside(self, term: Element) -> list[int]:
        """Exponents of what is no scalar, of one term: those of its ratio to another are 0."""
        return self.field.powers_in(term, self._outside)

    @cached_property
    def _outside(self) -> list[int]:
        """Places of the symbols that are no scalars."""
        names = enumerate(self.field.names)
        return [place for place, name in names if name not in self.scalars]

    def is_scalar(self, factor: Element) -> bool:
        """Whether a factor is made of scalars of the spec alone, one term over others."""
        return self.field.reach(factor) <= self.scalars and len(self.field.terms(factor)) == 1

    def write_scalar(self, factor: Element) -> Addend | None:
        """A factor as a number times names over names."""
        parts = self.field.quotients(factor)
        if len(parts) != 1 or len(parts[0].monomials) != 1:
            return None
        (monomial,), below = parts[0].monomials, list[tree.Node]()
        for divisor, exponent in parts[0].divisors:
            name = next((n for n in self.scalars if self.field[n] == divisor), None)
            if name is None:
                return None
            below.append(_power(tree.Name(name), exponent))
        if any(name in self.field.adjoined for name, _ in monomial.powers):
            return None
        above = tuple(_power(tree.Name(name), e) for name, e in monomial.powers)
        return Addend(Fraction(monomial.number), above, tuple(below))


def _is_cross(node: tree.Node) -> bool:
    """Whether a vector is a product of two."""
    return isinstance(node, tree.Call) and node.function == "cross"


def _is_sum(node: tree.Node) -> bool:
    """Whether a vector is a sum, which is written addend by addend where that goes."""
    while isinstance(node, tree.Negate):
        node = node.operand
    return isinstance(node, tree.Binary) and node.operator in "+-"


def _power(base: tree.Node, exponent: int) -> tree.Node:
    return base if exponent == 1 else tree.Power(base=base, exponent=exponent)


def measure(value: Value) -> Shape:
    """The shape of a vector or a matrix."""
    return (len(value), len(value[0])) if isinstance(value[0], tuple) else (len(value),)


def evaluate(node: tree.Node, values: Mapping[str, Value], field: Field) -> Value:
    """The value of a printed tree, from that of each name in it."""
    names, spare = dict(values), list[tree.Node]()

    def plain(part: tree.Node) -> tree.Node:
        rebuilt = tree.rebuild(part, [plain(each) for each in tree.children(part)])
        match rebuilt:
            case tree.Call(function="qmul", arguments=(a, b)):
                sides = (interpret(each, names, field) for each in (a, b))
                left, right = (
                    Quaternion(*x) if len(x) == len("wxyz") else Quaternion.pure(x) for x in sides
                )
                value = (left * right).components
            case tree.Call(function="vee", arguments=(a,)):
                skew = interpret(a, names, field)
                value = (skew[2][1], skew[0][2], skew[1][0])
            case _:
                return rebuilt
        spare.append(rebuilt)
        names[f"_q{len(spare)}"] = value
        return tree.Name(f"_q{len(spare)}")

    return interpret(plain(node), names, field)
