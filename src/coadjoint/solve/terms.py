"""Terms: the formulas of events as programs, with which solvers in C leave out steps.

Comes in: events. Goes out: an array of terms, each of terms before it, that the function
``are_near`` of ``solver.c`` follows with enclosures of its own: so a step without an event costs no
record. The formulas, and the observables of the kernel that they name, are evaluated with objects
that write down what is done to them.
Read next: `coadjoint.solve.recording`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.events import Sought
    from coadjoint.solve.surroundings import Surroundings

#: ``NAME_term`` of ``solver.h``.
TERM: Final = np.dtype(
    [("kind", "i4"), ("left", "i4"), ("right", "i4"), ("row", "i4"), ("value", "f8")]
)
#: ``TERMS_MOST`` and ``SOUGHT_MOST`` of ``solver.c``.
TERMS_MOST, SOUGHT_MOST = 64, 4


class Kind(IntEnum):
    """What a term does: the names of ``solver.c``."""

    CONSTANT = 0
    COMPONENT = 1
    PARAMETER = 2
    INPUT = 3
    TIME = 4
    ADD = 5
    SUBTRACT = 6
    MULTIPLY = 7
    INVERT = 8
    SHIFT = 9
    SCALE = 10
    ROOT = 11
    SIZE = 12
    SOUGHT = 13
    UNKNOWN = 14  # to solvers


class UnknownTermError(Exception):
    """A formula has a function that no term is for, or it is too long."""


@dataclass(frozen=True, eq=False)
class Term:
    """A value that is written down.

    Attributes:
        kind: What makes it.
        of: The terms of which it is made.
        row: Of a component, parameter or input.
        value: A number, if it has one.
    """

    kind: Kind
    of: tuple[Term, ...] = ()
    row: int = 0
    value: float = 0.0

    def _with(self, kind: Kind, shift: Kind, other: Any) -> Term:
        """This and another, or a number."""
        if isinstance(other, Term):
            return Term(kind, (self, other))
        return Term(shift, (self,), value=float(other))

    def __add__(self, other: Any) -> Term:
        return self._with(Kind.ADD, Kind.SHIFT, other)

    __radd__ = __add__

    def __neg__(self) -> Term:
        return Term(Kind.SCALE, (self,), value=-1.0)

    def __sub__(self, other: Any) -> Term:
        if isinstance(other, Term):
            return Term(Kind.SUBTRACT, (self, other))
        return Term(Kind.SHIFT, (self,), value=-float(other))

    def __rsub__(self, other: Any) -> Term:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Term:
        return self._with(Kind.MULTIPLY, Kind.SCALE, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Term:
        if isinstance(other, Term):
            return Term(Kind.MULTIPLY, (self, Term(Kind.INVERT, (other,))))
        return Term(Kind.SCALE, (self,), value=1.0 / float(other))

    def __rtruediv__(self, other: Any) -> Term:
        return Term(Kind.INVERT, (self,)).__mul__(other)

    def __abs__(self) -> Term:
        return Term(Kind.SIZE, (self,))

    def sqrt(self) -> Term:
        """The square root, which NumPy calls by this name."""
        return Term(Kind.ROOT, (self,))

    def _apply(self) -> Term:
        """A function that solvers do not know."""
        return Term(Kind.UNKNOWN, (self,))

    sin = cos = tan = exp = log = _apply


def write_terms(sought: Sequence[Sought], around: Surroundings) -> NDArray[np.void] | None:
    """The program of all formulas that are sought; None where there is none.

    There is none if states are moved onto constraints after a step, if inputs are no straight
    lines over steps, if a formula has a function other than a square root, or if it is long.
    """
    moved = "projection" in around.system.functions
    curved = around.driven is not None and not around.driven.are_lines
    curved |= not all(around.is_plain(each.formula) for each in sought)
    if not sought or len(sought) > SOUGHT_MOST or moved or curved or around.followed:
        return None
    listed: dict[int, tuple[int, Term]] = {}
    columns = around.name_all()
    try:
        for each in sought:
            values = around.find_values(each.formula.names, columns)
            found, size = (part[0] for part in each.formula.evaluate(values))
            level, given = float(each.event.value), each.event.tolerance
            pair = (found - level, size + abs(level))
            if not all(isinstance(part, Term) for part in pair):
                return None
            _list(Term(Kind.SOUGHT, pair, value=-1.0 if given is None else given), listed)
    except UnknownTermError:
        return None
    rows = []
    for _, term in listed.values():
        left, right = [*(listed[id(part)][0] for part in term.of), 0, 0][:2]
        rows.append((term.kind, left, right, term.row, term.value))
    return np.array(rows, TERM)


def list_components(found: object) -> set[int]:
    """The rows of the state that a value is made of."""
    pending, seen = [found], dict[int, Term]()
    while pending:
        term = pending.pop()
        if isinstance(term, Term) and id(term) not in seen:
            seen[id(term)] = term
            pending += term.of
    return {term.row for term in seen.values() if term.kind == Kind.COMPONENT}


def _list(term: Term, listed: dict[int, tuple[int, Term]], depth: int = 0) -> None:
    """List a term after all of which it is made.

    Raises:
        UnknownTermError: They are too many, or one is unknown.
    """
    if id(term) in listed:
        return
    for part in term.of:
        if depth < TERMS_MOST:
            _list(part, listed, depth + 1)
    if len(listed) >= TERMS_MOST or depth >= TERMS_MOST or term.kind == Kind.UNKNOWN:
        raise UnknownTermError
    listed[id(term)] = (len(listed), term)
