"""Cross-check, replay: equations that are evaluated once, and then repeated in any arithmetic.

Comes in: a `Reference`. Goes out: another one of the same values. The first evaluation of a
function is made with marks, which write down what is done to them; it does not depend on values.
All others do the same in the same order, and what would be done twice once; what no output rests on
is left out. Equations are evaluated at thousands of points, and most of that time went into finding
out what to do.
Read next: `coadjoint.crosscheck.oracle`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeVar

from coadjoint.crosscheck.oracle import Reference
from coadjoint.exact.factored import factor

Value = TypeVar("Value")


@dataclass(frozen=True)
class Loop:
    """A step of equations that are solved by what an arithmetic knows of them.

    Attributes:
        place: Which of several numbers is asked for; -1 where equations are solved, -2 where they
            are taken from their entries.
    """

    place: int

    def __call__(self, first: Any, *others: Any) -> Any:
        """The step done to values: equations and right sides, or what has items."""
        if self.place == FACTOR:
            return factor([first, *others])
        return first.solve(others) if self.place == SOLVE else first[self.place]


SOLVE, FACTOR = -1, -2
#: An operation of two values, or a function by its name or a loop, of any number of them.
Operation = Callable[[Any, Any], Any] | str | Loop


class Mark:
    """Stands for a value.

    Args:
        tape: Where is written down what is done to it.
    """

    __slots__ = ("tape",)

    def __init__(self, tape: Tape) -> None:
        self.tape = tape

    def __add__(self, other: Mark) -> Mark:
        return self.tape.note(operator.add, self, other)

    def __mul__(self, other: Mark) -> Mark:
        return self.tape.note(operator.mul, self, other)

    def __truediv__(self, other: Mark) -> Mark:
        return self.tape.note(operator.truediv, self, other)

    def __neg__(self) -> Mark:
        return self.tape.note(_negate, self, self)

    def zero(self) -> Mark:
        """The mark of 0."""
        return self.tape.number(Fraction(0))

    @staticmethod
    def factor(entries: Sequence[Mark]) -> MarkedEquations:
        """What solves symmetric equations; see `coadjoint.exact.factored`."""
        return MarkedEquations(entries[0].tape.note(Loop(FACTOR), *entries))


class MarkedEquations:
    """Symmetric equations of marks.

    Args:
        of: Their mark.
    """

    def __init__(self, of: Mark) -> None:
        self._of = of

    def __getitem__(self, place: int) -> Mark:
        return self._of.tape.note(Loop(place), self._of)

    def solve(self, known: Sequence[Mark]) -> list[Mark]:
        """The marks of the unknowns."""
        found = self._of.tape.note(Loop(SOLVE), self._of, *known)
        return [found.tape.note(Loop(place), found) for place in range(len(known))]


def _negate(value: Any, _: Any) -> Any:
    return -value


@dataclass
class Tape:
    """What is done to values.

    Attributes:
        numbers: Constants.
        steps: Results, by operations and their arguments, in the order in which they were made.
    """

    numbers: dict[Fraction, Mark] = field(default_factory=dict)
    steps: dict[tuple[Operation, tuple[Mark, ...]], Mark] = field(default_factory=dict)

    def number(self, value: Fraction) -> Mark:
        """The mark of a constant."""
        return self.numbers.setdefault(value, Mark(self))

    def note(self, operation: Operation, *arguments: Mark) -> Mark:
        """The mark of a result."""
        return self.steps.setdefault((operation, arguments), Mark(self))


@dataclass
class _Function:
    """A function, ready to be repeated: values have places, inputs first, constants, then results.

    Attributes:
        names: Inputs.
        numbers: Constants.
        steps: Operations with the places of both arguments; -1 in the place of the second one
            where the first ones are all those of a function.
        outputs: Places of what comes out.
        taken: Who took the constants into an arithmetic the last time, and what they are there.
    """

    names: tuple[str, ...]
    numbers: tuple[Fraction, ...]
    steps: list[tuple[Any, Any, int]]
    outputs: list[int]
    taken: tuple[Any, list[Any]] = (None, [])


class Replayed:
    """Equations that are evaluated once, as a `Reference`.

    Args:
        of: The equations.
    """

    def __init__(self, of: Reference) -> None:
        self.of = of
        self._functions: dict[str, _Function] = {}

    def evaluate(
        self,
        function: str,
        inputs: Mapping[str, Value],
        number: Callable[[Fraction], Value],
        call: Callable[..., Value],
    ) -> list[Value]:
        """As `Reference.evaluate`."""
        if function not in self._functions:
            self._functions[function] = _record(self.of, function, inputs)
        known = self._functions[function]
        if known.taken[0] is not number:
            known.taken = number, list(map(number, known.numbers))
        values: list[Any] = [inputs[name] for name in known.names]
        values += known.taken[1]
        for operation, one, other in known.steps:
            if other >= 0:
                values.append(operation(values[one], values[other]))
            elif isinstance(operation, str):
                values.append(call(operation, *[values[place] for place in one]))
            else:
                values.append(operation(*[values[place] for place in one]))
        return [values[place] for place in known.outputs]


def _record(reference: Reference, function: str, inputs: Mapping[str, Any]) -> _Function:
    """What a function does to values."""
    tape, marks = Tape(), dict[str, Mark]()
    for name in inputs:
        marks[name] = Mark(tape)
    found = reference.evaluate(function, marks, tape.number, tape.note)
    needed = _list_needed(tape, found)
    read = {mark for _, arguments in needed for mark in arguments}.union(found)
    names = [name for name, mark in marks.items() if mark in read]
    known = (*(marks[name] for name in names), *tape.numbers.values(), *needed.values())
    places = {mark: place for place, mark in enumerate(known)}
    steps = list[tuple[Any, Any, int]]()
    for operation, arguments in needed:
        at = [places[mark] for mark in arguments]
        one, other = (at, -1) if isinstance(operation, str | Loop) else at
        steps.append((operation, one, other))
    return _Function(
        names=tuple(names),
        numbers=tuple(tape.numbers),
        steps=steps,
        outputs=[places[mark] for mark in found],
    )


def _list_needed(
    tape: Tape, outputs: Sequence[Mark]
) -> dict[tuple[Operation, tuple[Mark, ...]], Mark]:
    """Steps that outputs rest on, and calls: those say where the equations have a value.

    Derivatives of definitions that another rule replaces are half of all steps in some systems.
    """
    read, needed = set(outputs), []
    for step, result in reversed(tape.steps.items()):
        if result in read or isinstance(step[0], str):
            read.update(step[1])
            needed.append((step, result))
    return dict(reversed(needed))
