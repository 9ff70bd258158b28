r"""Gradients of a spec's formulas as trees: of ``m*g*dot(Gamma, chi)`` by Gamma, ``m*g*chi``.

The adjoint of a formula runs down its tree: below :math:`\langle g, Ax\rangle` stands
:math:`A^Tg`, below :math:`\langle g, a\times b\rangle` stand :math:`b\times g` and
:math:`g\times a`. What it gives is shown only after it was found equal to what was derived, so
this module proves nothing and may give up.

Comes in: the tree of a scalar, and the name of a variable. Goes out: addends, or None.
Read next: `coadjoint.derive.vectors`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from coadjoint.derive.vectors.transposes import (
    drop_transposes,
    multiply,
    pull_trace,
    turn,
    turn_products,
)
from coadjoint.exact import Element, Field
from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.shapes import shapes

#: Derivatives of functions of one scalar.
_SLOPES: Mapping[str, Callable[[tree.Node], tree.Node]] = {
    "exp": lambda u: tree.Call(function="exp", arguments=(u,)),
    "sin": lambda u: tree.Call(function="cos", arguments=(u,)),
    "cos": lambda u: tree.Negate(operand=tree.Call(function="sin", arguments=(u,))),
    "log": lambda u: tree.Power(base=u, exponent=-1),
}


class _GivesUpError(Exception):
    """The formula holds something of which no adjoint is known here."""


@dataclass(frozen=True)
class Addend:
    """A number times scalars over scalars, times a vector or a matrix; None for a scalar alone."""

    number: Fraction = Fraction(1)
    above: tuple[tree.Node, ...] = ()
    below: tuple[tree.Node, ...] = ()
    vector: tree.Node | None = None

    @property
    def tree(self) -> tree.Node:
        """The addend as one tree, without its sign."""
        size, upper = _write_turns(abs(self.number), self.above, 4)
        size, under = _write_turns(size, self.below, Fraction(1, 4))
        parts = list(upper) + ([] if self.vector is None else [self.vector])
        if size.numerator != 1 or not parts:
            parts.insert(0, tree.Number(Fraction(size.numerator)))
        whole = parts[0]
        for part in parts[1:]:
            whole = tree.Binary(operator="*", left=whole, right=part)
        lower = list[tree.Node]()
        if size.denominator != 1:
            lower.append(tree.Number(Fraction(size.denominator)))
        lower += sorted(under, key=lambda each: each != tree.Name("pi"))
        if lower:
            bottom = lower[0]
            for part in lower[1:]:
                bottom = tree.Binary(operator="*", left=bottom, right=part)
            whole = tree.Binary(operator="/", left=whole, right=bottom)
        return whole


def _write_turns(
    size: Fraction, factors: tuple[tree.Node, ...], four: Fraction | int
) -> tuple[Fraction, list[tree.Node]]:
    """Factors with pi in the place of atan(1), which is a quarter of it."""
    written = [tree.Name("pi") if each == _EIGHTH else each for each in factors]
    for each in factors:
        size = size / four if each == _EIGHTH else size
    return size, written


_EIGHTH = tree.Call(function="atan", arguments=(tree.Number(Fraction(1)),))


def count_nodes(node: tree.Node) -> int:
    """How long a formula is."""
    return sum(1 for _ in tree.walk(node))


def total_of(addends: list[Addend]) -> tree.Node:
    """The sum of addends."""
    signed = [(each.number < 0, each.tree) for each in addends]
    (minus, whole), *others = signed or [(False, tree.Number(Fraction(0)))]
    whole = tree.Negate(whole) if minus else whole
    for minus, part in others:
        whole = tree.Binary(operator="-" if minus else "+", left=whole, right=part)
    return whole


def write_polynomial(field: Field, value: Element, first: Collection[str] = ()) -> tree.Node | None:
    """A polynomial in symbols as a tree, some of these before others; None for anything else."""
    found = list[Addend]()
    for part in field.quotients(value) if value else ():
        for monomial in part.monomials:
            if part.divisors or any(name in field.adjoined for name, _ in monomial.powers):
                return None
            powers = (
                tree.Name(name) if e == 1 else tree.Power(base=tree.Name(name), exponent=e)
                for name, e in sorted(monomial.powers, key=lambda power: power[0] not in first)
            )
            found.append(Addend(Fraction(monomial.number), tuple(powers)))
    return total_of(found)


def gradient(
    formula: tree.Node,
    by: tree.Node,
    parts: Sequence[str],
    scope: Mapping[str, Shape],
    symmetric: Collection[str] = (),
) -> list[Addend] | None:
    """The gradient of a scalar formula by a whole variable; None where it is not found.

    Args:
        formula: The tree.
        by: The variable: a name.
        parts: Names of its components, by which formulas may be written too.
        scope: Shapes of quantities and components.
        symmetric: Names of matrices that are symmetric.
    """
    try:
        known = shapes(formula, scope)
        pulled = _pull(formula, Addend(), by, known)
        found = _collect(_simplify(each, symmetric, scope) for each in pulled)
        slopes = [
            _collect(map(_put_entries_last, _pull(formula, Addend(), tree.Name(each), known)))
            for each in parts
        ]
    except (_GivesUpError, AssertionError, ExpressionError):
        return None
    if any(slopes):
        sizes = {abs(each.number) for slope in slopes for each in slope}
        size = sizes.pop() if len(sizes) == 1 else Fraction(1)
        plain = ([replace(each, number=each.number / size) for each in slope] for slope in slopes)
        vector = tree.Call(function="vector", arguments=tuple(map(total_of, plain)))
        found.append(Addend(number=size, vector=vector))
    return found


def _put_entries_last(addend: Addend) -> Addend:
    """An addend whose scalars stand before the components of vectors."""
    above = sorted(addend.above, key=lambda factor: isinstance(factor, tree.Index))
    return replace(addend, above=tuple(above))


def _simplify(addend: Addend, symmetric: Collection[str], scope: Mapping[str, Shape]) -> Addend:
    """An addend without transposes of products, and of matrices that are symmetric."""
    if addend.vector is None:
        return addend
    vector = turn_products(addend.vector, shapes(addend.vector, scope))
    return replace(addend, vector=drop_transposes(vector, symmetric) if symmetric else vector)


def _collect(addends: Iterable[Addend]) -> list[Addend]:
    """Addends that differ by their numbers alone, added up."""
    found = dict[tuple[object, ...], Addend]()
    for each in addends:
        key = (each.above, each.below, each.vector)
        number = each.number + (found[key].number if key in found else 0)
        found[key] = replace(each, number=number)
    return [each for each in found.values() if each.number]


def _is_it(node: tree.Node, by: tree.Node) -> bool:
    """Whether a node is the variable; a component may be written with a subscript."""
    if isinstance(node, tree.Index) and isinstance(by, tree.Name):
        return by.name in component_names(node.name, node.indices)
    return node == by


def component_names(name: str, indices: Sequence[int]) -> tuple[str, str]:
    """What a component may be called: ``Pi1``, and of a name that ends in a digit ``R1_1``."""
    places = "".join(map(str, indices))
    return name + places, f"{name}_{places}"


def _names(node: tree.Node, by: tree.Node) -> bool:
    """Whether a formula names a variable."""
    return any(_is_it(each, by) for each in tree.walk(node))


def _pull(
    node: tree.Node, adjoint: Addend, by: tree.Node, known: Mapping[int, Shape]
) -> Iterator[Addend]:
    """What an adjoint gives below a node."""
    if _is_it(node, by):
        yield adjoint
        return
    if not _names(node, by):
        return
    down = partial(_pull, by=by, known=known)
    match node:
        case tree.Negate(operand=operand):
            yield from down(operand, replace(adjoint, number=-adjoint.number))
        case tree.Binary(operator="+" | "-" as sign, left=left, right=right):
            yield from down(left, adjoint)
            turned = replace(adjoint, number=-adjoint.number if sign == "-" else adjoint.number)
            yield from down(right, turned)
        case tree.Binary(operator="/", left=left, right=right):
            yield from down(left, over(adjoint, right))
            if _names(right, by):
                grown = _by_factor(over(over(adjoint, right), right), left, known[id(left)])
                yield from down(right, replace(grown, number=-grown.number))
        case tree.Binary(operator="*", left=left, right=right):
            yield from _pull_product(left, right, adjoint, down, known, by)
        case tree.Power(base=base, exponent=n) if not known[id(base)]:
            slope = replace(adjoint, number=adjoint.number * n)
            if n != 1:
                raised = base if n == 2 else tree.Power(base=base, exponent=abs(n - 1))
                slope = over(slope, raised) if n < 1 else times(slope, raised)
            yield from down(base, slope)
        case tree.Call(function="dot", arguments=(a, b)):
            yield from down(a, _with(adjoint, b))
            yield from down(b, _with(adjoint, a))
        case tree.Call(function="vector", arguments=parts):
            for place, part in enumerate(parts, 1):
                yield from down(part, _entry_of(adjoint, place))
        case tree.Call(function="cross", arguments=(a, b)):
            g = _vector_of(adjoint)
            yield from down(
                a, replace(adjoint, vector=tree.Call(function="cross", arguments=(b, g)))
            )
            yield from down(
                b, replace(adjoint, vector=tree.Call(function="cross", arguments=(g, a)))
            )
        case tree.Call(function="rotate", arguments=(q, a)) if not _names(q, by):
            back = tree.Call(function="conjugate", arguments=(q,))
            pulled = tree.Call(function="rotate", arguments=(back, _vector_of(adjoint)))
            yield from down(a, replace(adjoint, vector=pulled))
        case tree.Call(function="trace", arguments=(a,)) if adjoint.vector is None:
            yield from _pull_traces(a, adjoint, down, known)
        case tree.Call(function="diag", arguments=(a,)) if len(known[id(a)]) == 2:
            along = tree.Call(function="diag", arguments=(_vector_of(adjoint),))
            yield from down(a, replace(adjoint, vector=along))
        case tree.Call(function="det", arguments=(a,)) if adjoint.vector is None:
            cofactors = tree.Call(function="inverse", arguments=(turn(a),))
            yield from down(a, replace(times(adjoint, node), vector=cofactors))
        case tree.Call(function="transpose", arguments=(a,)):
            yield from down(a, replace(adjoint, vector=turn(_vector_of(adjoint))))
        case tree.Call(function="norm", arguments=(a,)):
            yield from down(a, over(_with(adjoint, a), node))
        case tree.Call(function=function, arguments=(a,)) if function in _SLOPES:
            yield from down(a, times(adjoint, _SLOPES[function](a)))
        case tree.Call(function="sqrt", arguments=(a,)):
            yield from down(a, over(replace(adjoint, number=adjoint.number / 2), node))
        case _:
            raise _GivesUpError


def _pull_product(
    left: tree.Node,
    right: tree.Node,
    adjoint: Addend,
    down: Callable[[tree.Node, Addend], Iterator[Addend]],
    known: Mapping[int, Shape],
    by: tree.Node,
) -> Iterator[Addend]:
    """A product: of scalars and anything, or a matrix times a vector."""
    first, second = known[id(left)], known[id(right)]
    if not first:
        yield from down(right, times(adjoint, left))
        if _names(left, by):
            yield from down(left, _by_factor(adjoint, right, second))
    elif not second:
        yield from down(left, times(adjoint, right))
        if _names(right, by):
            yield from down(right, _by_factor(adjoint, left, first))
    elif len(first) == 2 and len(second) == 1:
        g = _vector_of(adjoint)
        if _names(right, by):
            yield from down(right, replace(adjoint, vector=multiply(turn(left), g)))
        if _names(left, by):
            outer = tree.Call(function="outer", arguments=(g, right))
            yield from down(left, replace(adjoint, vector=outer))
    elif len(first) == len(second) == 2:
        g = _vector_of(adjoint)
        if _names(left, by):
            yield from down(left, replace(adjoint, vector=multiply(g, turn(right))))
        if _names(right, by):
            yield from down(right, replace(adjoint, vector=multiply(turn(left), g)))
    else:
        raise _GivesUpError


def _pull_traces(
    node: tree.Node,
    adjoint: Addend,
    down: Callable[[tree.Node, Addend], Iterator[Addend]],
    known: Mapping[int, Shape],
) -> Iterator[Addend]:
    """The trace of a product of matrices, of multiples and of sums of them."""
    match node:
        case tree.Negate(operand=a):
            yield from _pull_traces(a, replace(adjoint, number=-adjoint.number), down, known)
        case tree.Binary(operator="+" | "-" as sign, left=a, right=b):
            yield from _pull_traces(a, adjoint, down, known)
            turned = replace(adjoint, number=-adjoint.number if sign == "-" else adjoint.number)
            yield from _pull_traces(b, turned, down, known)
        case _:
            found = list(pull_trace(node, known))
            if not found:
                raise _GivesUpError
            for factor, slope in found:
                yield from down(factor, replace(adjoint, vector=slope))


def _vector_of(adjoint: Addend) -> tree.Node:
    if adjoint.vector is None:
        raise _GivesUpError
    return adjoint.vector


def _entry_of(adjoint: Addend, place: int) -> Addend:
    """What an adjoint by its name has at one place of a vector that is written out."""
    vector = _vector_of(adjoint)
    if not isinstance(vector, tree.Name):
        raise _GivesUpError
    entry = tree.Index(name=vector.name, indices=(place,))
    return times(replace(adjoint, vector=None), entry)


def _with(adjoint: Addend, vector: tree.Node) -> Addend:
    """A scalar adjoint times a vector."""
    if adjoint.vector is not None:
        raise _GivesUpError
    sign = 1
    while isinstance(vector, tree.Negate):
        vector, sign = vector.operand, -sign
    return replace(adjoint, vector=vector, number=sign * adjoint.number)


def _by_factor(adjoint: Addend, value: tree.Node, shape: Shape) -> Addend:
    """The adjoint of a scalar factor: the product of the adjoint with what it multiplies."""
    if not shape:
        return times(adjoint, value)
    if len(shape) != 1:
        raise _GivesUpError
    product = tree.Call(function="dot", arguments=(_vector_of(adjoint), value))
    return times(replace(adjoint, vector=None), product)


def times(adjoint: Addend, factor: tree.Node) -> Addend:
    """An addend times a scalar, numbers kept apart."""
    match factor:
        case tree.Number(value=value):
            return replace(adjoint, number=adjoint.number * value)
        case tree.Negate(operand=operand):
            return times(replace(adjoint, number=-adjoint.number), operand)
        case tree.Binary(operator="*", left=left, right=right):
            return times(times(adjoint, left), right)
        case tree.Binary(operator="/", left=left, right=right):
            return over(times(adjoint, left), right)
    base, exponent = _split_power(factor)
    return _raise(adjoint, base, exponent)


def over(adjoint: Addend, divisor: tree.Node) -> Addend:
    """An addend over a scalar; equal divisors become a power."""
    match divisor:
        case tree.Number(value=value):
            return replace(adjoint, number=adjoint.number / value)
        case tree.Binary(operator="*", left=left, right=right):
            return over(over(adjoint, left), right)
        case tree.Binary(operator="/", left=left, right=right):
            return times(over(adjoint, left), right)
    base, exponent = _split_power(divisor)
    return _raise(adjoint, base, -exponent)


def _split_power(node: tree.Node) -> tuple[tree.Node, int]:
    """A base and its exponent."""
    return (node.base, node.exponent) if isinstance(node, tree.Power) else (node, 1)


def _raise(adjoint: Addend, base: tree.Node, exponent: int) -> Addend:
    """An addend times a power; of one base there is one power, above or below."""

    def find(factors: tuple[tree.Node, ...], sign: int) -> tuple[int, int]:
        for n, each in enumerate(factors):
            own, power = _split_power(each)
            if own == base:
                return n, sign * power
        return len(factors), 0

    up, above = find(adjoint.above, 1)
    down, below = find(adjoint.below, -1)
    total = above + below + exponent
    power = [base if abs(total) == 1 else tree.Power(base=base, exponent=abs(total))]
    return replace(
        adjoint,
        above=(*adjoint.above[:up], *(power * (total > 0)), *adjoint.above[up + 1 :]),
        below=(*adjoint.below[:down], *(power * (total < 0)), *adjoint.below[down + 1 :]),
    )
