"""Orbits: whether a motion stays on coadjoint orbits, decided by its Programs.

Comes in: the functions of a kernel. Goes out: whether its rates are its bracket with the gradient
of its energy, nothing added, and the bracket is linear in the state. Then that is a coadjoint
action, and methods apply that move a state by elements of the group.
Read next: `coadjoint.methods`.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import Final

from coadjoint.exact.linear import primes
from coadjoint.exact.residues import Residue, draw, residue
from coadjoint.lower.program import Program, run
from coadjoint.methods import ACTION

#: Points modulo a prime, of 61 bits, at which rates are compared, and those that are tried.
POINTS: Final = 2
TRIES: Final = 20


class NotLinearError(Exception):
    """A sum of values of two degrees, or a function or a quotient of the state."""


@dataclass(frozen=True)
class _Degree:
    """The degree of a homogeneous value in the state, an arithmetic for `run`; None of zero."""

    of: int | None

    def __add__(self, other: _Degree) -> _Degree:
        if self.of is None or other.of is None:
            return other if self.of is None else self
        if self.of != other.of:
            raise NotLinearError
        return self

    def __mul__(self, other: _Degree) -> _Degree:
        if self.of is None or other.of is None:
            return _Degree(None)
        return _Degree(self.of + other.of)

    def __truediv__(self, other: _Degree) -> _Degree:
        if other.of:
            raise NotLinearError
        return self

    def __neg__(self) -> _Degree:
        return self


def stays_on_orbits(programs: Mapping[str, Program]) -> bool:
    """Whether a motion is the coadjoint action of the gradient of its energy on its state.

    Args:
        programs: The functions of a kernel by name.
    """
    if not {*ACTION} <= programs.keys() or "noise" in programs:
        return False
    return _is_linear(programs) and _is_bracket(programs)


def _is_linear(programs: Mapping[str, Program]) -> bool:
    """Whether the bracket with a vector is homogeneous of degree 1 in the state."""
    program, state = programs["bracket_vector"], {*programs["rhs"].state}
    inputs = {name: _Degree(int(name in state)) for name in program.names}
    try:
        rows = run(program, inputs, _constant, _call_degree)
    except NotLinearError:
        return False
    return all(row.of in (None, 1) for row in rows)


def _constant(value: Fraction) -> _Degree:
    return _Degree(0 if value else None)


def _call_degree(_: str, *of: _Degree) -> _Degree:
    if any(each.of for each in of):
        raise NotLinearError
    return _Degree(0)


def _is_bracket(programs: Mapping[str, Program]) -> bool:
    """Whether the rates are the bracket with the gradient, at points modulo primes.

    Two functions of degree d that differ agree at such a point with a chance of ``d / 2^61``.
    """
    source, reached = random.Random(1), 0  # noqa: S311
    rates, slopes, bracket = (
        programs[name] for name in ("rhs", "energy_gradient", "bracket_vector")
    )
    vector = bracket.state[len(rates.state) :]
    for prime in islice(primes(), TRIES):
        number, call = partial(residue, prime=prime), partial(_call, prime=prime)
        point = {name: Residue(source.randrange(1, prime), prime) for name in rates.names}
        try:
            expected = run(rates, point, number, call)
            known = point | dict(zip(vector, run(slopes, point, number, call), strict=True))
            found = run(bracket, known, number, call)
        except ZeroDivisionError:
            continue
        if any((a + -b).value for a, b in zip(expected, found, strict=True)):
            return False
        reached += 1
        if reached == POINTS:
            return True
    return False


def _call(function: str, *arguments: Residue, prime: int) -> Residue:
    """A number that a function has at an argument: any, but always the same."""
    return draw(f"{function} {' '.join(str(each.value) for each in arguments)}", prime)
