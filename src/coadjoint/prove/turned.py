"""Turned: integrals that steps keep where attitudes in the state are rotations.

The momentum in space of a body in a field is one. The energy depends on the attitude there, so that
only symmetries of the energy keep it, and those of motions on rotations alone.
Comes in: facts of a system, and functions of its state. Goes out: points with rotations, and
whether the coadjoint mean keeps the functions, asked modulo primes.
Read next: `coadjoint.prove.methods`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from coadjoint.exact import Element
from coadjoint.exact.residues import Residue, call_modulo, draw, vanish
from coadjoint.lower.evaluation import run
from coadjoint.spec.model import Variable

if TYPE_CHECKING:
    from coadjoint.prove.facts import Facts

#: Takes a number into the arithmetic.
Numbers = Callable[..., Residue]


def with_rotations(
    variables: Sequence[Variable], at: Mapping[str, Residue], number: Numbers
) -> dict[str, Residue]:
    """A point whose attitudes are rotations, made from the numbers that it has in their place.

    Args:
        variables: The attitudes.
        at: Any point.
        number: What makes numbers of others.

    Raises:
        ZeroDivisionError: The numbers make none.
    """
    found = dict(at)
    for each in variables:
        own = [at[name] for name in each.components]
        if each.turning == "quaternion":
            square = sum((x * x for x in own[1:]), number(0))
            below = number(1) + square  # the sphere from its pole
            whole = [(number(1) + -square) / below, *(number(2) * x / below for x in own[1:])]
            found |= zip(each.components, whole, strict=True)
            continue
        rows, columns = each.shape
        matrix = [[number(int(i == j)) for j in range(rows)] for i in range(rows)]
        for n, (i, j) in enumerate(combinations(range(rows), 2)):
            half = own[n % len(own)]
            below = number(1) + half * half
            c, s = (number(1) + -(half * half)) / below, number(2) * half / below
            for row in matrix:
                row[i], row[j] = row[i] * c + row[j] * s, row[j] * c + -(row[i] * s)
        for i, row in enumerate(matrix):
            found |= zip(each.components[i * columns : i * columns + rows], row, strict=True)
    return found


def are_linear_symmetries(facts: Facts, values: Sequence[Element]) -> bool:
    """Whether functions are momenta of linear symmetries of the energy, where attitudes turn.

    The tensor times the gradient of F is ``L x`` there, L constant, and the energy has no slope
    along ``L x`` at any x. Along ``x(t) = exp(t A(xi)) x``, where attitudes stay rotations, F
    changes at the rate ``-xi . L x(t)``: in a step of the coadjoint mean by ``-h xi . L m``, m the
    mean of x(t), and xi is the gradient of the energy at m.

    Args:
        facts: Of the system, a motion on coadjoint orbits.
        values: The functions.
    """
    bracket, field, state = facts.programs.get("bracket_vector"), facts.field, facts.state
    turning, n = facts.spec.turning, len(facts.state)
    named = {*state, *facts.equations.setting.parameters}
    reached = frozenset[str]().union(*(field.reach(x) for x in values))
    if bracket is None or facts.energy is None or not turning or reached - named:
        return False
    slopes = [field.gradient(value, state) for value in values]
    energy = field.gradient(facts.energy, state)

    def find(at: dict[str, Residue], number: Numbers) -> Iterator[Residue]:
        prime = number(0).prime
        points = [
            with_rotations(turning, at | {x: draw(f"{x} {k}", prime) for x in state}, number)
            for k in range(n + 2)
        ]
        for slope in slopes:
            turned = list[list[Residue]]()
            for point in points:
                rises = (field.evaluate(x, dict(point), number, call_modulo) for x in slope)
                along = dict(zip(bracket.state[n:], rises, strict=True))
                turned.append([*run(bracket, point | along, number, call_modulo)])
            known = [[point[x] for x in state] for point in points]
            linear, rest = fit(known, turned, number)
            yield from rest
            moved = [_multiply(column, [at[x] for x in state], number) for column in linear]
            along_energy = [field.evaluate(x, dict(at), number, call_modulo) for x in energy]
            yield _multiply(moved, along_energy, number)

    return vanish(find, {*bracket.names, *named})


def fit(
    points: Sequence[Sequence[Residue]], values: Sequence[Sequence[Residue]], number: Numbers
) -> tuple[list[list[Residue]], list[Residue]]:
    """The linear map that takes points to values, row by row, and what it leaves of the values.

    >>> from functools import partial
    >>> from coadjoint.exact.residues import residue
    >>> a, b, c = map(residue, (1, 2, 3))
    >>> linear, rest = fit([[a, a], [a, b], [b, c]], [[a], [a], [b]], residue)
    >>> [x.value for row in linear for x in row], [x.value for x in rest]
    ([1, 0], [0])
    """
    width, rows = len(points[0]), [[*x, *y] for x, y in zip(points, values, strict=True)]
    pivots = list[int]()
    for column in range(width):
        top = len(pivots)
        found = next((k for k in range(top, len(rows)) if rows[k][column].value), None)
        if found is None:
            continue
        rows[top], rows[found] = rows[found], rows[top]
        scale = number(1) / rows[top][column]
        rows[top] = [x * scale for x in rows[top]]
        for k, row in enumerate(rows):
            if k != top and row[column].value:
                factor = -row[column]
                rows[k] = [x + factor * y for x, y in zip(row, rows[top], strict=True)]
        pivots.append(column)
    linear = [[number(0)] * width for _ in values[0]]
    for row, column in zip(rows, pivots, strict=False):
        for place, value in enumerate(row[width:]):
            linear[place][column] = value
    return linear, [x for row in rows[len(pivots) :] for x in row[width:]]


def _multiply(one: Sequence[Residue], other: Sequence[Residue], number: Numbers) -> Residue:
    return sum((a * b for a, b in zip(one, other, strict=True)), number(0))
