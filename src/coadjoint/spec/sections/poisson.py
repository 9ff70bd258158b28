"""Poisson: the table [poisson], a declared bracket for systems without a Lie algebra.

Comes in: its keys and the coordinates. Goes out: a `Poisson` record. Whether the bracket satisfies
the Jacobi identity is proved later. Read next: `coadjoint.spec.sections.newton`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from coadjoint.spec.core.components import unpack
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.pairs import read_pairs
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.values import POISSON_PATTERN
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES, state_roles


class PoissonPart(Part):
    """A Poisson bracket of coordinates, in the place of an algebra."""

    nambu: Annotated[list[str], Field(min_length=1)] | None = Field(
        None, description="the n - 2 distinguished functions of n coordinates"
    )
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '{X1, X2}' = '4*X3', each pair once; the others are 0",
        json_schema_extra=name_pattern(POISSON_PATTERN),
    )
    canonical: list[Annotated[list[str], Field(min_length=2, max_length=2)]] | None = Field(
        None, description="pairs of a position and its momentum, as [['q', 'p']]"
    )
    magnetic: dict[str, str] | None = Field(
        None,
        description="brackets of canonical momenta, such as '{p1, p2}' = 'B*q3'",
        json_schema_extra=name_pattern(POISSON_PATTERN),
    )

    @model_validator(mode="after")
    def _one_way(self) -> PoissonPart:
        ways = [self.nambu, self.brackets, self.canonical]
        if sum(way is not None for way in ways) != 1:
            raise ValueError("exactly one of nambu, brackets and canonical")
        if self.magnetic is not None and self.canonical is None:
            raise ValueError("magnetic terms only with canonical")
        return self


@dataclass(frozen=True)
class Poisson:
    """A declared Poisson bracket of the coordinates.

    Attributes:
        kind: ``"nambu"``, ``"brackets"`` or ``"canonical"``.
        functions: The n - 2 distinguished functions of a Nambu bracket, else empty.
        entries: ``(i, j, {x_i, x_j})`` by places among the components of the state, each pair once:
            the declared brackets, or the magnetic terms of a canonical one.
        pairs: ``(i, j)`` of a position and its momentum of a canonical bracket, else empty.
        weights: ``{x_i, x_j}`` of each pair: 1, but 1/2 for an entry of symmetric matrices off
            the diagonal, since there the pairing is ``tr(P dS/dt)``, which counts it twice.
    """

    kind: str
    functions: tuple[Formula, ...] = ()
    entries: tuple[tuple[int, int, Formula], ...] = ()
    pairs: tuple[tuple[int, int], ...] = ()
    weights: tuple[Fraction, ...] = ()


def read_poisson(reading: Reading, part: PoissonPart) -> Poisson:
    """The declared bracket.

    Raises:
        SpecError: A coordinate is unknown, a pair stands twice, or functions are too few or many.
    """
    return _Bracket(reading).poisson(part)


class _Bracket:
    """The reading of one table, with the places of the coordinates."""

    def __init__(self, reading: Reading) -> None:
        self.reading, self.source = reading, reading.source
        variables = state_of(VARIABLES.of(reading))
        self.state = [name for variable in variables for name in variable.components]
        self.forms = {variable.name: variable.form for variable in variables}
        self.places = {variable.name: self._run(variable) for variable in variables}
        self.places |= {name: (place,) for place, name in enumerate(self.state)}
        file = reading.file
        self.alone = {
            name
            for variable in variables
            if file.metriplectic is not None or variable.name in file.forces
            for name in variable.components
        }

    def _run(self, variable: Variable) -> tuple[int, ...]:
        """The places of a whole variable."""
        return tuple(self.state.index(name) for name in variable.components)

    def poisson(self, part: PoissonPart) -> Poisson:
        """The bracket by whichever way it is declared."""
        if part.nambu is not None:
            return Poisson(kind="nambu", functions=self._nambu(part.nambu))
        if part.brackets is not None:
            entries = self._entries("brackets", part.brackets, range(len(self.state)))
            return Poisson(kind="brackets", entries=entries)
        weights = self._canonical(part.canonical or [])
        momenta = [p for _, p in weights]
        entries = self._entries("magnetic", part.magnetic or {}, momenta)
        return Poisson(
            kind="canonical",
            functions=(),
            entries=entries,
            pairs=tuple(weights),
            weights=tuple(weights.values()),
        )

    def _formula(self, key: KeyPath, text: str, kind: str) -> Formula:
        scope = self.reading.scope(kind, state_roles(self.reading), driven=())
        return self.reading.formula(key, text, scope)

    def _nambu(self, texts: Sequence[str]) -> tuple[Formula, ...]:
        """The distinguished functions, two fewer than there are coordinates."""
        n = len(self.state)
        if len(texts) != n - 2:
            raise self.source.fault(
                ("poisson", "nambu"),
                f"{len(texts)} distinguished functions of {n} coordinates",
                len(texts),
                f"{n - 2}, two fewer than there are coordinates"
                if n > 2
                else "at least 3 coordinates",
            )
        return tuple(
            self._formula(("poisson", "nambu", place), text, "a distinguished function")
            for place, text in enumerate(texts)
        )

    def _entries(
        self, way: str, texts: Mapping[str, str], allowed: Sequence[int]
    ) -> tuple[tuple[int, int, Formula], ...]:
        """Brackets of components, each pair once."""
        key, names = ("poisson", way), [self.state[place] for place in allowed]
        pairs = read_pairs(self.source, key, texts, POISSON_PATTERN, names)
        return tuple(
            (allowed[i], allowed[j], self._formula((*key, text), texts[text], "a bracket"))
            for (i, j), text in pairs.items()
        )

    def _canonical(self, names: Sequence[Sequence[str]]) -> dict[tuple[int, int], Fraction]:
        """The places of positions and momenta with their brackets; others commute with all."""
        weights: dict[tuple[int, int], Fraction] = {}
        paired: list[int] = []
        for number, pair in enumerate(names):
            key: KeyPath = ("poisson", "canonical", number)
            q, p = (self._places((*key, side), name) for side, name in enumerate(pair))
            forms = [self.forms.get(name, "") for name in pair]
            if len(q) != len(p) or forms[0] != forms[1]:
                sides = [
                    f"{n!r} {_describe(len(c), f)}"
                    for n, c, f in zip(pair, (q, p), forms, strict=True)
                ]
                problem = " and ".join(sides)
                expected = "a position and a momentum of one shape and form"
                raise self.source.fault(key, problem, list_names(pair), expected)
            paired += (*q, *p)
            weights |= zip(zip(q, p, strict=True), pairing_weights(len(q), forms[0]), strict=True)
        self._check_single(paired)
        return weights

    def _places(self, key: KeyPath, name: str) -> tuple[int, ...]:
        if name not in self.places:
            problem = f"there is no coordinate {name!a}"
            raise self.source.unknown(key, problem, name, self.places)
        return self.places[name]

    def _check_single(self, places: Sequence[int]) -> None:
        """Each coordinate stands in one pair; one that commutes with all is moved by more."""
        for place, name in enumerate(self.state):
            if places.count(place) != 1 and (place in places or name not in self.alone):
                often = "no pair" if place not in places else "more than one pair"
                ways = "Declare a constant as a parameter, or let a force or [metriplectic] move it"
                hint = "" if place in places else f"{ways}."
                problem = f"the coordinate {name!r} is in {often}"
                expected = "each coordinate in one pair"
                raise self.source.fault(("poisson", "canonical"), problem, name, expected, hint)


def _describe(count: int, form: str) -> str:
    """How a variable looks, in words."""
    return f"has {count} components" + (f" of the form {form!r}" if form else "")


def pairing_weights(count: int, form: str) -> list[Fraction]:
    """``{q, p}`` of each component, by the pairing ``tr(P dS/dt)`` of symmetric matrices.

    Antisymmetric ones are paired by ``tr(P^T dQ/dt)/2``, others by ``tr(P^T dQ/dt)``: all 1.
    """
    if form != "symmetric":
        return [Fraction(1)] * count
    rows = unpack(range(count), form)
    diagonal = {rows[n][n] for n in range(len(rows))}
    return [Fraction(1, 1 if n in diagonal else 2) for n in range(count)]


POISSON = Table[Poisson | None](
    "poisson",
    PoissonPart,
    "a Poisson bracket of coordinates, for systems without an algebra",
    read_poisson,
)
