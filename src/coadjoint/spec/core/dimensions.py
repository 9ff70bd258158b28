"""Dimensions: the units of the parts of an expression, and what they demand of each other.

Comes in: an expression tree, and the units of its names, some of them unknown. Goes out: the unit
of each entry of its value. Every sum, comparison and argument of a function on the way demands
that two units are equal; `Balance` meets such demands one by one by exact linear algebra on the
exponents, so that unknown units are inferred, and tells which one cannot be met.

A number is a pure number, except 0, which has every unit. Read next: `coadjoint.spec.dimensions`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import permutations
from types import MappingProxyType

from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.units import ONE, UNKNOWN, Unit, label_unit, product_of

#: The unit of an entry; None for one that is zero, which has every unit.
Entry = Unit | None


@dataclass(frozen=True)
class Measured:
    """A scalar, a vector or a matrix by the units of its entries, row by row."""

    shape: Shape
    entries: tuple[Entry, ...]

    def rows(self) -> list[tuple[Entry, ...]]:
        """The rows of a matrix, or the entries of a vector as rows of one."""
        width = self.shape[1] if len(self.shape) > 1 else 1
        return [self.entries[at : at + width] for at in range(0, len(self.entries), width)]


@dataclass(frozen=True)
class Demand:
    """Two units that must be equal.

    Attributes:
        found: What is there.
        expected: What it must be.
        what: What is found, as a clause with ``{found}`` and ``{expected}``.
        wanted: What would have been accepted, likewise.
        node: The part of the expression at fault, or None for all of it.
    """

    found: Unit
    expected: Unit
    what: str = "the unit is {found}"
    wanted: str = "{expected}"
    node: tree.Node | None = None


Ask = Callable[[Demand], None]


class Balance:
    """Unknown units, as far as the demands so far tell them.

    Args:
        pure: An unknown that can only be a pure number, if demands tell it.
    """

    def __init__(self, pure: str = "") -> None:
        self.pure = UNKNOWN + pure
        self.known: dict[str, Unit] = {}

    def meet(self, demand: Demand) -> bool:
        """Meet a demand, and say whether it could be met."""
        left = self.reduce(demand.found / demand.expected)
        powers = dict(left.powers)
        free = sorted(left.unknowns, key=lambda name: name == self.pure)
        if not free:
            return left == ONE
        rest = Unit(tuple((name, e) for name, e in left.powers if name != free[0]))
        value = rest ** (-1 / Fraction(powers[free[0]]))
        if free[0] == self.pure and value != ONE:
            return False
        self.known[free[0]] = value
        return True

    def reduce(self, unit: Unit) -> Unit:
        """A unit with all that is known put in."""
        pending = self._list_known(unit)
        while pending:  # what is put in is kept, so that no chain of names is walked twice
            inner = self._list_known(self.known[pending[-1]])
            deeper = [name for name in inner if self._list_known(self.known[name])]
            pending += deeper
            if not deeper:
                name = pending.pop()
                self.known[name] = self._put_in(self.known[name])
        return self._put_in(unit)

    def _list_known(self, unit: Unit) -> list[str]:
        """The unknowns in a unit that are known by now."""
        return [name for name in unit.unknowns if name in self.known]

    def _put_in(self, unit: Unit) -> Unit:
        """A unit with what is known put in once."""
        if not self._list_known(unit):
            return unit
        return product_of(
            (self.known.get(name) or Unit(((name, 1),)), exponent) for name, exponent in unit.powers
        )


@dataclass(frozen=True)
class KnownUnits:
    """The units of the names of a spec, as far as it tells them.

    Attributes:
        names: Whole quantities, components and ``energy``.
        own: The symbols with a factor that the spec uses, in which labels are written.
        time: The text of the unit of time, "s" where no unit is declared.
    """

    names: Mapping[str, Measured]
    own: Mapping[str, Unit]
    time: str = "s"

    def label(self, entries: Iterable[Entry]) -> str:
        """The text of the units of some components, one where they agree; "" if not known."""
        texts = [label_unit(ONE if entry is None else entry, self.own) for entry in entries]
        return texts[0] if len(set(texts)) == 1 else ", ".join(texts) if all(texts) else ""

    def label_value(self, node: tree.Node) -> str:
        """The text of the units of a formula of these names."""
        return self.label(measure(node, self.names, lambda demand: None).entries)


def measure(node: tree.Node, names: Mapping[str, Measured], ask: Ask) -> Measured:
    """The units of the entries of an expression.

    Args:
        node: A parsed expression whose shapes fit.
        names: Units of each name that may occur, whole quantities and components alike.
        ask: Told what the parts demand of each other.
    """
    return tree.fold(node, lambda part, below: _measure(part, below, names, ask))


def is_number(node: tree.Node) -> bool:
    """Whether an expression names nothing."""
    return not any(isinstance(part, tree.Name | tree.Index) for part in tree.walk(node))


def scalar(unit: Entry) -> Measured:
    """A scalar of a unit."""
    return Measured((), (unit,))


def _measure(
    node: tree.Node, below: list[Measured], names: Mapping[str, Measured], ask: Ask
) -> Measured:
    """One node from those below it."""
    match node:
        case tree.Number(value=value):
            return scalar(ONE if value else None)
        case tree.Name(name=name):
            return names[name]
        case tree.Index(name=name, indices=indices):
            return _pick(names[name], indices)
        case tree.Component(indices=indices):
            return _pick(below[0], indices)
        case tree.Negate():
            return below[0]
        case tree.Power(exponent=exponent):
            return _power(_Asking(node, ask), below[0], exponent)
        case tree.Binary(operator="+" | "-" as sign, left=left, right=right):
            return _Asking(node, ask, sign).add(left, right, *below)
        case tree.Binary(operator="/"):
            (divisor,) = below[1].entries
            share = None if divisor is None else divisor**-1
            return Measured(below[0].shape, tuple(_times(e, share) for e in below[0].entries))
        case tree.Binary():
            return _multiply(_Asking(node, ask, "*"), *below)
        case tree.Call(function=function):
            return _RULES[function](_Asking(node, ask, function), *below)
    raise AssertionError(node)


@cache
def _times(a: Entry, b: Entry) -> Entry:
    return None if a is None or b is None else a * b


def _pick(whole: Measured, indices: Sequence[int]) -> Measured:
    """A component, or a row of a matrix."""
    if len(indices) == len(whole.shape):
        place = 0
        for index, length in zip(indices, whole.shape, strict=True):
            place = place * length + index - 1
        return scalar(whole.entries[place])
    return Measured(whole.shape[1:], whole.rows()[indices[0] - 1])


class _Asking:
    """What a node demands of the units of its parts."""

    def __init__(self, node: tree.Node, ask: Ask, name: str = "") -> None:
        self.node, self.ask, self.name = node, ask, name

    def _demand(self, found: Unit, expected: Unit, what: str, wanted: str) -> None:
        self.ask(Demand(found=found, expected=expected, what=what, wanted=wanted, node=self.node))

    def same(self, entries: Iterable[Entry]) -> Entry:
        """The one unit of some terms; that of nothing but zeros is None."""
        first: Entry = None
        for entry in entries:
            if first is None or entry is None or entry == first:
                first = entry if first is None else first
                continue
            what = (
                f"the terms of {self.name or 'a power'} have the units {{expected}} and {{found}}"
            )
            self._demand(entry, first, what, "terms of one unit")
        return first

    def add(self, left: tree.Node, right: tree.Node, a: Measured, b: Measured) -> Measured:
        """A sum or a difference."""
        what = f"{{expected}} {self.name} {{found}} do not fit"
        entries = []
        for one, other in zip(a.entries, b.entries, strict=True):
            if one is not None and other is not None and one != other:
                wanted = f"two of one unit around {self.name}"
                self._demand(other, one, what, wanted)
            entries.append(other if one is None else one)
        return Measured(a.shape, tuple(entries))

    def pure(self, argument: Measured) -> None:
        """The argument of a function is a pure number."""
        (entry,) = argument.entries
        if entry is not None and entry != ONE:
            what = f"the argument of {self.name} has the unit {{found}}"
            self._demand(entry, ONE, what, "a pure number")


def _multiply(asking: _Asking, a: Measured, b: Measured) -> Measured:
    """A scalar times anything, a matrix times a vector or a matrix."""
    if a.shape == () or b.shape == ():
        (factor,) = a.entries if a.shape == () else b.entries
        other = b if a.shape == () else a
        return Measured(other.shape, tuple(_times(factor, entry) for entry in other.entries))
    columns = list(zip(*b.rows(), strict=True))
    entries = [
        asking.same(_times(x, y) for x, y in zip(row, column, strict=True))
        for row in a.rows()
        for column in columns
    ]
    return Measured((a.shape[0], *b.shape[1:]), tuple(entries))


def _power(asking: _Asking, base: Measured, exponent: int) -> Measured:
    """A power of a scalar or a square matrix."""
    if base.shape == ():
        (entry,) = base.entries
        return scalar(ONE if exponent == 0 else None if entry is None else entry**exponent)
    size = base.shape[0]
    if exponent == 0:
        return Measured(base.shape, tuple(ONE if i == j else None for i, j in _places(size)))
    factor = _inverse(asking, base) if exponent < 0 else base
    whole: Measured | None = None
    for bit in reversed(f"{abs(exponent):b}"):  # by squares: 10,000 is a power as well
        if bit == "1":
            whole = factor if whole is None else _multiply(asking, whole, factor)
        factor = _multiply(asking, factor, factor)
    assert whole is not None, exponent
    return whole


def _places(size: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(size) for j in range(size)]


def _determinant(asking: _Asking, rows: Sequence[Sequence[Entry]]) -> Entry:
    """The one unit of the products of a determinant."""
    return asking.same(_products(rows))


def _products(rows: Sequence[Sequence[Entry]]) -> Iterable[Entry]:
    for order in permutations(range(len(rows))):
        whole: Entry = ONE
        for row, column in zip(rows, order, strict=True):
            whole = _times(whole, row[column])
        yield whole


def _inverse(asking: _Asking, a: Measured) -> Measured:
    """By cofactors, whose zeros are those of the inverse."""
    rows, size = a.rows(), a.shape[0]
    whole = _determinant(asking, rows)
    share = None if whole is None else whole**-1
    entries = []
    for i, j in _places(size):
        minor = [row[:i] + row[i + 1 :] for n, row in enumerate(rows) if n != j]
        entries.append(_times(_determinant(asking, minor), share))
    return Measured(a.shape, tuple(entries))


# -- functions ------------------------------------------------------------------------------------


def _dot(asking: _Asking, a: Measured, b: Measured) -> Measured:
    pairs = zip(a.entries, b.entries, strict=True)
    return scalar(asking.same(_times(x, y) for x, y in pairs))


def _cross(asking: _Asking, a: Measured, b: Measured) -> Measured:
    x, y = a.entries, b.entries
    pairs = ((1, 2), (2, 0), (0, 1))
    return Measured(
        (3,), tuple(asking.same((_times(x[i], y[j]), _times(x[j], y[i]))) for i, j in pairs)
    )


def _qmul(asking: _Asking, a: Measured, b: Measured) -> Measured:
    x, y = a.entries, b.entries
    rows = (range(4), (1, 0, 3, 2), (2, 3, 0, 1), (3, 2, 1, 0))
    sums = (asking.same(_times(x[i], y[j]) for i, j in enumerate(row)) for row in rows)
    return Measured(a.shape, tuple(sums))


def _rotation(asking: _Asking, a: Measured) -> Measured:
    """Sums of squares of a quaternion, or a pose without its last column."""
    if len(a.shape) == 2:
        rows = a.shape[:1] * 2
        return Measured(rows, tuple(entry for row in a.rows() for entry in row[:-1]))
    square = asking.same(_times(x, x) for x in a.entries)
    return Measured((3, 3), (square,) * 9)


def _commutator(asking: _Asking, a: Measured, b: Measured) -> Measured:
    both = zip(_multiply(asking, a, b).entries, _multiply(asking, b, a).entries, strict=True)
    return Measured(a.shape, tuple(asking.same(pair) for pair in both))


def _diag(asking: _Asking, a: Measured) -> Measured:
    size = a.shape[0]
    if len(a.shape) == 2:
        return Measured((size,), a.entries[:: size + 1])
    return Measured((size, size), tuple(a.entries[i] if i == j else None for i, j in _places(size)))


def _hat(asking: _Asking, a: Measured) -> Measured:
    x, y, z = a.entries
    return Measured((3, 3), (None, z, y, z, None, x, y, x, None))


def _root(unit: Entry) -> Entry:
    return None if unit is None else unit ** Fraction(1, 2)


def _norm(asking: _Asking, a: Measured) -> Measured:
    return scalar(asking.same(a.entries))


def _outer(asking: _Asking, a: Measured, b: Measured) -> Measured:
    entries = tuple(_times(x, y) for x in a.entries for y in b.entries)
    return Measured(a.shape + b.shape, entries)


def _stack(asking: _Asking, *parts: Measured) -> Measured:
    entries = tuple(entry for part in parts for entry in part.entries)
    return Measured((len(parts), *parts[0].shape), entries)


def _transpose(asking: _Asking, a: Measured) -> Measured:
    columns = zip(*a.rows(), strict=True)
    return Measured(a.shape[::-1], tuple(entry for column in columns for entry in column))


def _of_number(asking: _Asking, a: Measured) -> Measured:
    """A function of a pure number, which is one."""
    asking.pure(a)
    return scalar(ONE)


def _like(asking: _Asking, *parts: Measured) -> Measured:
    """One of some alike, or the size of one."""
    return scalar(asking.same(part.entries[0] for part in parts))


def _ratio(asking: _Asking, *parts: Measured) -> Measured:
    """A pure number of some alike, as an angle by its two sides."""
    _like(asking, *parts)
    return scalar(ONE)


def _complex(asking: _Asking, a: Measured, b: Measured) -> Measured:
    """A real matrix of two parts of one unit."""
    one = asking.same((*a.entries, *b.entries))
    return Measured((2 * a.shape[0], 2 * a.shape[1]), (one,) * (4 * len(a.entries)))


def _any_power(asking: _Asking, base: Measured, exponent: Measured) -> Measured:
    """A power with any exponent: of a pure number, unless the exponent is a literal one."""
    match asking.node:
        case tree.Call(arguments=(_, tree.Number(value=value))):
            entry = base.entries[0]
            return scalar(None if entry is None else entry**value)
    _of_number(asking, base)
    return _of_number(asking, exponent)


_PURE = ("sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh")
_OF_RATIOS = ("asin", "acos", "atan", "asinh", "atanh")
#: The units of a value from those of the arguments, for every function of the language.
_RULES: Mapping[str, Callable[..., Measured]] = MappingProxyType(
    {
        "dot": _dot,
        "cross": _cross,
        "commutator": _commutator,
        "trace": lambda asking, a: scalar(asking.same(_diag(asking, a).entries)),
        "transpose": _transpose,
        "det": lambda asking, a: scalar(_determinant(asking, a.rows())),
        "inverse": _inverse,
        "hat": _hat,
        "diag": _diag,
        "norm": _norm,
        "outer": _outer,
        "qmul": _qmul,
        "conjugate": lambda asking, a: a,
        "rotation": _rotation,
        "rotate": lambda asking, q, v: _multiply(asking, _rotation(asking, q), v),
        "translation": lambda asking, a: Measured(a.shape[:1], tuple(r[-1] for r in a.rows())),
        "rows": _stack,
        "vector": _stack,
        "sqrt": lambda asking, a: scalar(_root(a.entries[0])),
        "complex": _complex,
        "pow": _any_power,
        **dict.fromkeys((*_PURE, *_OF_RATIOS), _of_number),
        **dict.fromkeys(("abs", "min", "max"), _like),
        **dict.fromkeys(("sign", "atan2"), _ratio),
    }
)
