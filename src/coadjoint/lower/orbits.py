"""Orbits: whether a motion is a bracket, and stays on coadjoint orbits, decided by its Programs.

Comes in: the functions of a kernel. Goes out: whether its rates are its bracket with the gradient
of its energy, nothing added, and whether the bracket is linear in the state. Then that is a
coadjoint action, and methods apply that move a state by elements of the group.
Read next: `coadjoint.methods`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from coadjoint.exact.residues import Residue, call_modulo, vanish
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import Program
from coadjoint.methods import ACTION, DISTINGUISHED, RELAXED, Sphere


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
    if not ({*ACTION} <= programs.keys() and _is_linear(programs) and is_bracket(programs)):
        return False
    return _is_of_lie_algebra(programs)


def _is_of_lie_algebra(programs: Mapping[str, Program]) -> bool:
    """Whether a linear bracket obeys the identity of Jacobi, at a point modulo primes.

    Those of motions with constraints may not, and then there is no group that acts. The product of
    vectors is ``[v, w]_k = v . L(e_k) w``, L the tensor, so that x of it is ``v . L(x) w``.
    """
    bracket, state = programs["bracket_vector"], programs["rhs"].state
    places, turned = range(len(state)), bracket.state[len(state) :]
    others = {*bracket.names} - {*state, *turned}
    drawn = {letter: [f"{letter}[{k}]" for k in places] for letter in "xuvw"}

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        x, u, v, w = ([at[name] for name in names] for names in drawn.values())
        given = {name: at[name] for name in others}
        units = [[number(int(k == place)) for k in places] for place in places]

        def act(point: Sequence[Residue], on: Sequence[Residue]) -> list[Residue]:
            names = dict(zip((*state, *turned), (*point, *on), strict=True))
            return list(run(bracket, given | names, number, call_modulo))

        def multiply(one: Sequence[Residue], other: Sequence[Residue]) -> list[Residue]:
            return [dot(one, act(unit, other)) for unit in units]

        def dot(one: Sequence[Residue], other: Sequence[Residue]) -> Residue:
            return sum((a * b for a, b in zip(one, other, strict=True)), number(0))

        cycle = ((u, v, w), (v, w, u), (w, u, v))
        yield sum((dot(a, act(x, multiply(b, c))) for a, b, c in cycle), number(0))

    return vanish(find, [*others, *(name for names in drawn.values() for name in names)])


def _is_linear(programs: Mapping[str, Program]) -> bool:
    """Whether the bracket with a vector is homogeneous of degree 1 in the state."""
    return _is_homogeneous(programs["bracket_vector"], programs["rhs"].state)


def is_carried(programs: Mapping[str, Program]) -> bool:
    """Whether a motion is a coadjoint action, and what it carries along moves linearly.

    Then a step moves both by one element: with the state held, rates that are homogeneous of degree
    1 in what is reconstructed are those of a group that acts on it.

    Args:
        programs: The functions of a kernel by name.
    """
    rates = programs.get("reconstruction")
    if rates is None or not stays_on_orbits(programs):
        return False
    return _is_homogeneous(rates, rates.state[len(programs["rhs"].state) :])


def _is_homogeneous(program: Program, by: Sequence[str]) -> bool:
    """Whether all rows have the degree 1 in some names."""
    inputs = {name: _Degree(int(name in by)) for name in program.names}
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


def is_bracket(programs: Mapping[str, Program]) -> bool:
    """Whether the rates are the bracket with the gradient of the energy, an antisymmetric one.

    It is asked at points modulo primes.

    Args:
        programs: The functions of a kernel by name.
    """
    if not is_product(programs):
        return False
    bracket = programs["bracket_vector"]
    vector = bracket.state[len(programs["rhs"].state) :]

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        turned = run(bracket, at, number, call_modulo)
        yield sum((at[v] * x for v, x in zip(vector, turned, strict=True)), number(0))

    return vanish(find, bracket.names)


def is_noisy_action(programs: Mapping[str, Program]) -> bool:
    """Whether a motion with noise is the coadjoint action of the gradients of its Hamiltonians.

    Those of noise are asked at points modulo primes, as that of the energy.

    Args:
        programs: The functions of a kernel by name.
    """
    still = {name: each for name, each in programs.items() if name != "noise"}
    if not {"noise", "noise_gradient"} <= programs.keys() or not stays_on_orbits(still):
        return False
    fields, slopes = programs["noise"], programs["noise_gradient"]
    bracket, n = programs["bracket_vector"], len(programs["rhs"].state)
    vector = bracket.state[n:]

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        rows, columns = (run(each, at, number, call_modulo) for each in (fields, slopes))
        count = len(rows) // n
        for k in range(count):
            along = at | dict(zip(vector, columns[k::count], strict=True))
            turned = run(bracket, along, number, call_modulo)
            yield from (a + -b for a, b in zip(rows[k::count], turned, strict=True))

    return vanish(find, {*bracket.names, *fields.names, *slopes.names})


def is_product(programs: Mapping[str, Program]) -> bool:
    """Whether the rates are ``bracket_vector`` of the gradient of the energy, likewise."""
    if not {*ACTION} <= programs.keys() or "noise" in programs:
        return False
    rates, slopes, bracket = (programs[name] for name in ("rhs", *ACTION))
    vector = bracket.state[len(rates.state) :]

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        along = at | dict(zip(vector, run(slopes, at, number, call_modulo), strict=True))
        pairs = zip(
            run(rates, at, number, call_modulo),
            run(bracket, along, number, call_modulo),
            strict=True,
        )
        yield from (a + -b for a, b in pairs)

    return vanish(find, bracket.names)


def is_metriplectic(programs: Mapping[str, Program]) -> bool:
    """Whether the rates are ``P dH + G dS``, P antisymmetric, ``P dS = 0`` and ``G dH = 0``.

    It is asked at points modulo primes.

    Args:
        programs: The functions of a kernel by name.
    """
    if not {*ACTION, *RELAXED} <= programs.keys() or "noise" in programs:
        return False
    rates, slopes, bracket = (programs[name] for name in ("rhs", *ACTION))
    entropy, metric = programs["entropy_gradient"], programs["metric_vector"]
    vector = bracket.state[len(rates.state) :]

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        g, s = (run(each, at, number, call_modulo) for each in (slopes, entropy))
        along = [at | dict(zip(vector, each, strict=True)) for each in (g, s)]
        moved, still = (run(bracket, each, number, call_modulo) for each in along)
        resting, relaxed = (run(metric, each, number, call_modulo) for each in along)
        parts = zip(run(rates, at, number, call_modulo), moved, relaxed, strict=True)
        yield from (rate + -(a + b) for rate, a, b in parts)
        yield from (*still, *resting)
        turned = run(bracket, at, number, call_modulo)
        yield sum((at[v] * x for v, x in zip(vector, turned, strict=True)), number(0))

    return vanish(find, {*bracket.names, *rates.names, *slopes.names, *entropy.names})


#: Coordinates beyond which Nambu's product has too many minors: their number doubles with each.
COORDINATES: Final = 6


def is_nambu(programs: Mapping[str, Program]) -> bool:
    """Whether the rates are Nambu's product of the gradients of distinguished functions and energy.

    It is asked at points modulo primes.

    Args:
        programs: The functions of a kernel by name.
    """
    if not {*DISTINGUISHED, "energy_gradient"} <= programs.keys() or "noise" in programs:
        return False
    rates, slopes = programs["rhs"], programs["energy_gradient"]
    others, n = programs["distinguished_gradient"], len(rates.state)
    if n > COORDINATES:
        return False

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        listed = run(others, at, number, call_modulo)
        rows = [listed[first : first + n] for first in range(0, len(listed), n)]
        rows.insert(0, run(slopes, at, number, call_modulo))
        for i, rate in enumerate(run(rates, at, number, call_modulo)):
            cofactor = _expand(rows, [j for j in range(n) if j != i])
            yield rate + (-cofactor if i % 2 else cofactor)

    return vanish(find, {*rates.names, *slopes.names, *others.names})


def _expand(rows: Sequence[Sequence[Residue]], columns: Sequence[int]) -> Residue:
    """A determinant of residues, along the first row."""
    first, *rest = rows
    if not rest:
        return first[columns[0]]
    parts = (first[j] * _expand(rest, [k for k in columns if k != j]) for j in columns)
    signed = [-part if place % 2 else part for place, part in enumerate(parts)]
    return sum(signed[1:], signed[0])


class _Brackets:
    """Brackets of basis vectors ``{x_i, x_j} = c_ij^k x_k``, as entries by k, when asked for.

    Most algebras are none of so(3) and se(3) by their first few.

    Args:
        program: The product of the bracket with a vector, which stands behind the state.
    """

    def __init__(self, program: Program) -> None:
        self.size = len(program.state) // 2
        self._program = program
        self._zeros = dict.fromkeys(program.names, Fraction(0))
        self._columns: dict[int, list[dict[int, Fraction]]] = {}

    def __call__(self, i: int, j: int) -> Mapping[int, Fraction]:
        if j not in self._columns:
            self._columns[j] = self._multiply(j)
        return self._columns[j][i]

    def _multiply(self, j: int) -> list[dict[int, Fraction]]:
        """The product with the vector j, at each basis state, by rows."""
        state, along = self._program.state[: self.size], self._program.state[self.size + j]
        rows: list[dict[int, Fraction]] = [{} for _ in state]
        for k, at in enumerate(state):
            point = self._zeros | {along: Fraction(1), at: Fraction(1)}
            for row, value in zip(rows, run(self._program, point, Fraction, _refuse), strict=True):
                if value:
                    row[k] = value
        return rows


def find_spheres(programs: Mapping[str, Program]) -> tuple[Sphere, ...]:
    """The factors so(3) and se(3) of an algebra of these and of R; none of another one.

    Rows of a factor follow one another in the state, in axes in which its bracket is a multiple of
    the cross product.

    Args:
        programs: The functions of a kernel that moves on coadjoint orbits, by name.
    """
    program = programs["bracket_vector"]
    if {*program.parameters, *program.inputs, *program.time} & program.names_used():
        return ()
    brackets = _Brackets(program)
    n, found, place = brackets.size, list[Sphere](), 0
    while place < n:
        for sphere, size in _list_spheres(place, n):
            if _is_sphere(brackets, sphere, range(place, place + size)):
                found.append(sphere)
                place += size
                break
        else:
            if any(brackets(place, j) or brackets(j, place) for j in range(n)):
                return ()
            place += 1
    return tuple(found)


def find_scales(programs: Mapping[str, Program], spheres: Sequence[Sphere]) -> list[Fraction]:
    """By what multiple of the cross product each of some spheres has its bracket."""
    brackets = _Brackets(programs["bracket_vector"])
    turning = (sphere.turning for sphere in spheres)
    return [brackets(a, b)[c] for a, b, c in turning]


def _refuse(function: str, *_: Fraction) -> Fraction:
    """A bracket that is linear in the state calls no functions of it."""
    raise NotLinearError(function)


def _list_spheres(place: int, n: int) -> list[tuple[Sphere, int]]:
    """Factors that may begin at a place, with their sizes, the larger ones first."""
    first, second = tuple(range(place, place + 3)), tuple(range(place + 3, place + 6))
    larger = [(Sphere(second, first), 6), (Sphere(first, second), 6)] if place + 6 <= n else []
    return [*larger, (Sphere(first), 3)] if place + 3 <= n else []


def _is_sphere(brackets: _Brackets, sphere: Sphere, rows: range) -> bool:
    """Whether the brackets of some rows are those of a factor, and vanish with all others."""
    own, turning = sphere.rows, sphere.turning
    scale = brackets(turning[0], turning[1]).get(turning[2])
    if not scale:
        return False
    expected: dict[tuple[int, int], dict[int, Fraction]] = {}
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        for i, j, sign in ((a, b, scale), (b, a, -scale)):
            expected[turning[i], turning[j]] = {turning[c]: sign}
            if sphere.tangent:
                expected[turning[i], own[j]] = expected[own[i], turning[j]] = {own[c]: sign}
    return all(
        brackets(i, j) == expected.get((i, j), {}) and brackets(j, i) == expected.get((j, i), {})
        for j in range(brackets.size)
        for i in rows
    )
