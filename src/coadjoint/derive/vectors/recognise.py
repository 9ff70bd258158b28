r"""The search for products of vectors in components, term by term.

Components are searched for products of vectors: from a vocabulary of the spec's own vectors, of
gradients of its energy, and of their products, a candidate is taken whose terms are all among those
that remain, times a scalar of the spec; it is subtracted, and so on until nothing remains. The tree
that is printed is evaluated once more, and found equal to the components in the exact field: a line
is right or it is not there.

Comes in: a vocabulary and the value of a rate. Goes out: addends. Read next:
`coadjoint.derive.vectors.vocabulary`, which makes the candidates.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import tee

from coadjoint.derive.interpret import Value, entries
from coadjoint.derive.vectors.gradients import Addend, count_nodes, over, times, total_of
from coadjoint.derive.vectors.vocabulary import Candidate, Vocabulary
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import scale, subtract
from coadjoint.spec.core import tree
from coadjoint.spec.core.shapes import shapes

#: Terms of components beyond which nothing is searched for.
MOST_TERMS = 4000
#: Nodes of a formula beyond which it is no shorter than its components.
LONGEST = 70
#: Nodes of a product of two names: none is shorter.
SHORTEST = 3
#: Words beyond which products whose terms cancel are not searched for.
MOST_WORDS = 20
#: Products that one line may have.
MOST_PRODUCTS = 8
#: Terms of what remains with which a term of a candidate is compared.
MOST_RATIOS = 12
#: A component that is not there.
ZERO = tree.Number(Fraction(0))


def owner_name(node: tree.Node) -> str:
    """The name of a whole quantity, or of what has the row."""
    assert isinstance(node, tree.Name | tree.Index), node
    return node.name


def is_short(node: tree.Node) -> bool:
    """Whether a formula can be read at one look."""
    return count_nodes(node) <= LONGEST


def recognise(vocabulary: Vocabulary, value: Value) -> list[Addend] | None:
    """Addends whose sum is a value, exactly; None where none were found.

    Args:
        vocabulary: What may stand in the sum.
        value: A vector or a matrix of elements, closed.
    """
    field = vocabulary.field
    if _count(field, value) > MOST_TERMS:
        return None
    # products of which every term is there; else those whose terms cancel with one another's
    matrix, words = isinstance(value[0], tuple), len(vocabulary.words)
    for whole in (True, False) if not matrix and words <= MOST_WORDS else (True,):
        found = _search(vocabulary, value, whole=whole)
        if found == [] or (found and vocabulary.evaluate(total_of(found)) == value):
            return _begin_with_plus(map(vocabulary.settle, found))
    return None


def recognise_scalar(vocabulary: Vocabulary, value: Element) -> list[Addend] | None:
    """Scalar products whose sum is a scalar, exactly; None where none were found."""
    if not value or vocabulary.field.count_terms(value) > MOST_TERMS:
        return None
    found = _search(vocabulary, (value,), whole=True)
    if found and vocabulary.evaluate(total_of(found)) == value:
        return _begin_with_plus(map(vocabulary.settle, found))
    return None


def _begin_with_plus(found: Iterable[Addend]) -> list[Addend]:
    """Addends, first of them one that is not subtracted, where there is one."""
    addends = list(found)
    place = next((n for n, each in enumerate(addends) if each.number > 0), 0)
    return [*addends[place : place + 1], *addends[:place], *addends[place + 1 :]]


def _search(vocabulary: Vocabulary, rest: Value, *, whole: bool) -> list[Addend] | None:
    """Addends taken one by one, the simplest kind of product first."""
    like, found = rest, list[Addend]()
    for level in range(vocabulary.levels):
        candidates = vocabulary.candidates(like, level, whole=whole)
        while len(found) < MOST_PRODUCTS and any(map(bool, entries(rest))):
            candidates, again = tee(candidates)  # which are made once, and only as far as asked for
            step = _best(vocabulary, again, rest, whole=whole)
            if step is None:
                break
            addend, rest = step
            found.append(addend)
        if not any(map(bool, entries(rest))):
            return found
    return None


def _best(
    vocabulary: Vocabulary, candidates: Iterable[Candidate], rest: Value, *, whole: bool
) -> tuple[Addend, Value] | None:
    """The candidate that leaves fewest terms, the shortest of them, with what it leaves."""
    field, best = vocabulary.field, None
    before = _count(field, rest)
    fewest, shortest = before - 1, LONGEST
    wanted = [
        [(term, vocabulary.powers_outside(term)) for term in field.terms(each)[:MOST_RATIOS]]
        for each in entries(rest)
    ]
    for candidate in candidates:
        for factor in _factors(vocabulary, candidate.value, wanted, whole=whole):
            left = subtract(rest, scale(factor, candidate.value))
            count = _count(field, left)
            if count > fewest or (whole and before - count < _count(field, candidate.value)):
                continue
            written = vocabulary.write_scalar(factor)
            if written is None:
                continue
            addend = _put(vocabulary, written, candidate.node)
            length = count_nodes(addend.tree)
            if (count, length) >= (fewest, shortest):
                continue
            fewest, shortest, best = count, length, (addend, left)
            if not count and length <= SHORTEST:
                return best
    return best


def _put(vocabulary: Vocabulary, scalar: Addend, vector: tree.Node) -> Addend:
    """A scalar times a vector; minus a vector product is the product of the factors exchanged."""
    whole = _take_scalars(vocabulary, scalar, vector)
    match whole.vector:
        case tree.Call(function="cross" | "commutator" as function, arguments=(a, b)):
            for side in (a, b):
                whole = _take_scalars(vocabulary, whole, side)
            a, b = (_bare(vocabulary, side) for side in (a, b))
            sides = (a, b) if whole.number > 0 else (b, a)
            product = tree.Call(function=function, arguments=sides)
            return replace(whole, number=abs(whole.number), vector=product)
    return whole


def _bare(vocabulary: Vocabulary, node: tree.Node) -> tree.Node:
    """A vector without its scalars."""
    bare = _take_scalars(vocabulary, Addend(), node).vector
    assert bare is not None, node
    return bare


def _take_scalars(vocabulary: Vocabulary, scalar: Addend, node: tree.Node) -> Addend:
    """A scalar times a vector, of which all that stands before it or below it is taken out."""

    def is_scalar(part: tree.Node) -> bool:
        return not shapes(part, {"pi": (), **vocabulary.shapes})[id(part)]

    match node:
        case tree.Negate(operand=operand):
            return _take_scalars(vocabulary, replace(scalar, number=-scalar.number), operand)
        case tree.Binary(operator="*", left=left, right=right) if is_scalar(left):
            return _take_scalars(vocabulary, times(scalar, left), right)
        case tree.Binary(operator="/", left=left, right=right):
            return _take_scalars(vocabulary, over(scalar, right), left)
        case tree.Call(function="vector", arguments=parts) if any(map(_is_minus, parts)):
            plain = [_turn_sign(each) if _is_minus(each) else each for each in parts]
            if all(_is_minus(each) or each == ZERO for each in parts):
                turned = tree.Call(function="vector", arguments=tuple(plain))
                return replace(scalar, number=-scalar.number, vector=turned)
    return replace(scalar, vector=node)


def _is_minus(node: tree.Node) -> bool:
    """Whether every addend of a formula has a minus."""
    match node:
        case tree.Binary(operator="+", left=left, right=right):
            return _is_minus(left) and _is_minus(right)
        case tree.Binary(operator="-", left=left):
            return _is_minus(left)
    return isinstance(node, tree.Negate)


def _turn_sign(node: tree.Node) -> tree.Node:
    """Minus a formula of which every addend has a minus."""
    match node:
        case tree.Negate(operand=operand):
            return operand
        case tree.Binary(operator="+" | "-" as sign, left=left, right=right):
            right = _turn_sign(right) if sign == "+" else right
            return tree.Binary(operator="+", left=_turn_sign(left), right=right)
    raise AssertionError(node)


def _factors(
    vocabulary: Vocabulary,
    value: Value,
    wanted: Sequence[Sequence[tuple[Element, list[int]]]],
    *,
    whole: bool,
) -> list[Element]:
    """Scalars of the spec by which a term of a candidate is a term of what remains.

    Terms of what remains stand with the powers of what is no scalar, as `powers_outside` has them.
    A candidate of which every term remains is known by its first one.
    """
    field = vocabulary.field
    for own, terms in zip(entries(value), wanted, strict=True):
        if own and terms:
            found = list[Element]()
            for first in [field.first_term(own)] if whole else field.terms(own)[:MOST_RATIOS]:
                inverse, powers = first.inverse(), vocabulary.powers_outside(first)
                ratios = (term * inverse for term, outside in terms if outside == powers)
                found += (each for each in ratios if vocabulary.is_scalar(each))
            return list(dict.fromkeys(found))
        if own:
            # a candidate that has an entry where nothing remains can only add terms
            return []
    return []


def _count(field: Field, value: Value) -> int:
    """The number of terms of all components."""
    return sum(field.count_terms(each) for each in entries(value))
