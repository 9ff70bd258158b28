"""Poisson: a declared bracket of coordinates, for systems without a Lie algebra.

Comes in: the validated table [poisson] and the coordinates. Goes out: a `Poisson` record whose
functions have been parsed in the scope of coordinates and parameters. Whether the bracket satisfies
the Jacobi identity is proved later. Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction

from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.formulas import Quantity, make_scope, read_formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import POISSON_PATTERN
from coadjoint.spec.model import (
    Definition,
    Formula,
    Input,
    Parameter,
    Poisson,
    Time,
    Variable,
    unpacked,
)
from coadjoint.spec.schema import PoissonPart

_BRACKET = re.compile(POISSON_PATTERN, re.ASCII)


def read_poisson(
    source: Source,
    part: PoissonPart,
    variables: Sequence[Variable],
    constants: Sequence[Parameter | Input | Time | Definition],
    moved: Collection[str] = (),
) -> Poisson:
    """The bracket of a spec.

    Args:
        source: The text of the spec.
        part: The table [poisson].
        variables: The state.
        constants: What its functions may use beside the state.
        moved: Variables that may be in no canonical pair, since more than the bracket moves them.

    Raises:
        SpecError: A coordinate is unknown, a pair stands twice, or functions are too few or many.
    """
    return _Reading(source, variables, constants, moved).poisson(part)


class _Reading:
    """The reading of one table, with the places of the coordinates."""

    def __init__(
        self,
        source: Source,
        variables: Sequence[Variable],
        constants: Sequence[Parameter | Input | Time | Definition],
        moved: Collection[str],
    ) -> None:
        self.source = source
        self.alone = {c for each in variables if each.name in moved for c in each.components}
        self.quantities: tuple[Quantity, ...] = (*variables, *constants)
        self.roles = tuple(dict.fromkeys(variable.role for variable in variables))
        self.state = [name for variable in variables for name in variable.components]
        self.forms = {variable.name: variable.form for variable in variables}
        self.places = {variable.name: self._run(variable) for variable in variables}
        self.places |= {name: (place,) for place, name in enumerate(self.state)}

    def _run(self, variable: Variable) -> tuple[int, ...]:
        """The places of a whole variable."""
        return tuple(self.state.index(name) for name in variable.components)

    def poisson(self, part: PoissonPart) -> Poisson:
        """The bracket by whichever way it is declared."""
        if part.nambu is not None:
            return Poisson("nambu", functions=self._nambu(part.nambu))
        if part.brackets is not None:
            entries = self._entries("brackets", part.brackets, range(len(self.state)))
            return Poisson("brackets", entries=entries)
        weights = self._canonical(part.canonical or [])
        momenta = [p for _, p in weights]
        entries = self._entries("magnetic", part.magnetic or {}, momenta)
        return Poisson("canonical", (), entries, tuple(weights), tuple(weights.values()))

    def _formula(self, key: KeyPath, text: str, kind: str) -> Formula:
        return read_formula(self.source, key, text, make_scope(kind, self.roles, self.quantities))

    def _nambu(self, texts: Sequence[str]) -> tuple[Formula, ...]:
        """The distinguished functions, two fewer than there are coordinates."""
        n = len(self.state)
        if len(texts) != n - 2:
            raise self.source.fault(
                ("poisson", "nambu"),
                f"{len(texts)} distinguished functions of {n} coordinates",
                found=len(texts),
                expected=f"{n - 2}, two fewer than there are coordinates"
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
        entries: dict[tuple[int, int], Formula] = {}
        for text, value in texts.items():
            key: KeyPath = ("poisson", way, text)
            i, j = self._pair(key, text, allowed)
            if i == j or (i, j) in entries or (j, i) in entries:
                raise self.source.fault(
                    key,
                    f"{text!a} is {'declared twice' if i != j else '0 and needs no declaration'}",
                    found=text,
                    expected="each pair of two components once, in either order",
                    at=self.source.positions.key(key),
                )
            entries[i, j] = self._formula(key, value, "a bracket")
        return tuple((i, j, formula) for (i, j), formula in entries.items())

    def _pair(self, key: KeyPath, text: str, allowed: Sequence[int]) -> tuple[int, int]:
        """The places of X1 and X2 in a key ``{X1, X2}``."""
        names = [self.state[place] for place in allowed]
        found = _BRACKET.fullmatch(text)
        unknown = [name for name in found.groups() if name not in names] if found else [text]
        if found is None or unknown:
            example = listed(names[:2]) if len(names) > 1 else "X1, X2"
            raise self.source.fault(
                key,
                f"{text!a} is no bracket of these components",
                found=unknown[0],
                expected=f"a key such as '{{{example}}}' with components among {listed(names)}",
                hint=did_you_mean(unknown[0], names),
                at=self.source.positions.key(key),
            )
        return self.state.index(found[1]), self.state.index(found[2])

    def _canonical(self, names: Sequence[Sequence[str]]) -> dict[tuple[int, int], Fraction]:
        """The places of positions and momenta with their brackets; others commute with all."""
        weights: dict[tuple[int, int], Fraction] = {}
        paired: list[int] = []
        for number, pair in enumerate(names):
            key: KeyPath = ("poisson", "canonical", number)
            q, p = (self._places((*key, side), name) for side, name in enumerate(pair))
            forms = [self.forms.get(name, "") for name in pair]
            if len(q) != len(p) or forms[0] != forms[1]:
                found = [
                    f"{n!r} {_like(len(c), f)}" for n, c, f in zip(pair, (q, p), forms, strict=True)
                ]
                raise self.source.fault(
                    key,
                    " and ".join(found),
                    found=listed(pair),
                    expected="a position and a momentum of one shape and form",
                )
            paired += (*q, *p)
            weights |= zip(zip(q, p, strict=True), pairing_weights(len(q), forms[0]), strict=True)
        self._check_single(paired)
        return weights

    def _places(self, key: KeyPath, name: str) -> tuple[int, ...]:
        if name not in self.places:
            raise self.source.fault(
                key,
                f"there is no coordinate {name!a}",
                found=name,
                expected=f"coordinates or their components: {listed(self.places)}",
                hint=did_you_mean(name, self.places),
            )
        return self.places[name]

    def _check_single(self, places: Sequence[int]) -> None:
        """Each coordinate stands in one pair; one that commutes with all is moved by more."""
        for place, name in enumerate(self.state):
            if places.count(place) != 1 and (place in places or name not in self.alone):
                often = "no pair" if place not in places else "more than one pair"
                ways = "Declare a constant as a parameter, or let a force or [metriplectic] move it"
                hint = "" if place in places else f"{ways}."
                raise self.source.fault(
                    ("poisson", "canonical"),
                    f"the coordinate {name!r} is in {often}",
                    found=name,
                    expected="each coordinate in one pair",
                    hint=hint,
                )


def _like(count: int, form: str) -> str:
    """How a variable looks, in words."""
    return f"has {count} components" + (f" of the form {form!r}" if form else "")


def pairing_weights(count: int, form: str) -> list[Fraction]:
    """``{q, p}`` of each component, by the pairing ``tr(P dS/dt)`` of symmetric matrices.

    Antisymmetric ones are paired by ``tr(P^T dQ/dt)/2``, others by ``tr(P^T dQ/dt)``: all 1.
    """
    if form != "symmetric":
        return [Fraction(1)] * count
    rows = unpacked(range(count), form)
    diagonal = {rows[n][n] for n in range(len(rows))}
    return [Fraction(1, 1 if n in diagonal else 2) for n in range(count)]
