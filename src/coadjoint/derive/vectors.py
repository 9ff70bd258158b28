r"""Equations of whole vectors and matrices, recognised in the components that a route derived.

Components are searched for products of vectors: from a vocabulary of the spec's own vectors, of
gradients of its energy, and of their products, a candidate is taken whose terms are all among those
that remain, times a scalar of the spec; it is subtracted, and so on until nothing remains. What is
printed has thus been subtracted from the derived components, in the exact field, and the rest was
zero: a line is right or it is not there.

Comes in: Equations. Goes out: trees with the left sides that they equal. Read next:
`coadjoint.derive.vocabulary`, which makes the candidates.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from coadjoint.derive.equations import Equations
from coadjoint.derive.gradients import Addend, total_of
from coadjoint.derive.interpret import Value, entries
from coadjoint.derive.vocabulary import Candidate, Vocabulary, make_vocabulary
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import scale, subtract
from coadjoint.spec.core import tree

#: Terms of components beyond which nothing is searched for.
MOST_TERMS = 4000
#: Rows of matrices beyond which products of matrices cost too much.
MOST_ROWS = 10
#: Products that one line may have.
MOST_PRODUCTS = 8


@dataclass(frozen=True)
class VectorLine:
    """An equation of a whole quantity.

    Attributes:
        left: Its left side.
        right: Its right side.
        is_rate: Whether the left side is the rate of it.
    """

    left: tree.Node
    right: tree.Node
    is_rate: bool = True


def vector_lines(equations: Equations) -> tuple[VectorLine, ...]:
    """The equations of motion by whole vectors and matrices; empty where one was not found.

    Scalars next to vectors stand as they are written in the components, so a line for one is not
    needed.
    """
    vocabulary = make_vocabulary(equations)
    lines = list[VectorLine]()
    for target in vocabulary.targets:
        found = recognise(vocabulary, target.value)
        if found is None:
            return ()
        lines.append(VectorLine(target.node, total_of(found)))
    for node, right in vocabulary.named:
        if any(node in tree.walk(line.right) for line in lines):
            lines.append(VectorLine(node, right, is_rate=False))
    return tuple(lines)


def recognise(vocabulary: Vocabulary, value: Value) -> list[Addend] | None:
    """Addends whose sum is a value, exactly; None where none were found.

    Args:
        vocabulary: What may stand in the sum.
        value: A vector or a matrix of elements, closed.
    """
    field, rest, found = vocabulary.field, value, list[Addend]()
    if _count(field, rest) > MOST_TERMS:
        return None
    for level in range(vocabulary.levels):
        while len(found) < MOST_PRODUCTS and any(map(bool, entries(rest))):
            step = _best(vocabulary, vocabulary.candidates(value, level), rest)
            if step is None:
                break
            addend, rest = step
            found.append(addend)
        if not any(map(bool, entries(rest))):
            return found
    return None


def _best(
    vocabulary: Vocabulary, candidates: Iterable[Candidate], rest: Value
) -> tuple[Addend, Value] | None:
    """The candidate that leaves fewest terms, with what it leaves."""
    field, best = vocabulary.field, None
    fewest = _count(field, rest)
    for candidate in candidates:
        for factor in _factors(vocabulary, candidate.value, rest):
            left = subtract(rest, scale(factor, candidate.value))
            count = _count(field, left)
            if count < fewest:
                written = vocabulary.write_scalar(factor)
                if written is None:
                    continue
                fewest, best = count, (_put(written, candidate.node), left)
                if not count:
                    return best
    return best


def _put(scalar: Addend, vector: tree.Node) -> Addend:
    """A scalar times a vector; minus a vector product is the product of the factors exchanged."""
    match vector:
        case tree.Call(function="cross" | "commutator" as function, arguments=(a, b)):
            if scalar.number < 0:
                return replace(scalar, number=-scalar.number, vector=tree.Call(function, (b, a)))
    return Addend(scalar.number, scalar.above, scalar.below, vector)


def _factors(vocabulary: Vocabulary, value: Value, rest: Value) -> list[Element]:
    """Scalars of the spec by which a term of a candidate is a term of what remains."""
    field = vocabulary.field
    for own, wanted in zip(entries(value), entries(rest), strict=True):
        if own and wanted:
            first = field.terms(own)[0]
            ratios = (term / first for term in islice(field.terms(wanted), 12))
            return [each for each in ratios if vocabulary.is_scalar(each)]
        if own:
            # a candidate that has an entry where nothing remains can only add terms
            return []
    return []


def _count(field: Field, value: Value) -> int:
    """The number of terms of all components."""
    return sum(len(field.terms(each)) for each in entries(value) if each)


def spoil(value: Sequence[Element]) -> tuple[Element, ...]:
    """Components with the sign of one of them turned, which no vector equation may match."""
    first, *others = value
    return (-first, *others)
