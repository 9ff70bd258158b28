"""Claims: the table [claims], what is claimed of the motion and proved at every regeneration.

Comes in: its keys. Goes out: `Claims`, whose fields are attributes of the `Spec`.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

from pydantic import ConfigDict, Field, model_validator

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.formulas import Formula, Scope, misfit
from coadjoint.spec.core.parts import Accept, ClaimPart, Part, TextPart, or_alone
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Place
from coadjoint.spec.core.tree import Name
from coadjoint.spec.sections.momenta import MOMENTA
from coadjoint.spec.sections.observables import OBSERVABLES
from coadjoint.spec.sections.reconstruction import RECONSTRUCTION, followed_shapes
from coadjoint.spec.sections.symmetries import emitted_shapes, shapes_in_claims
from coadjoint.spec.sections.variables import VARIABLES, motion_roles, state_roles


class FlagPart(TextPart):
    """A claim without an expression: whether it is made, or a table."""

    model_config = ConfigDict(json_schema_extra=partial(or_alone, "boolean"))
    alone = "claim"
    alone_kind = bool

    claim: bool = Field(description="whether this is claimed")
    accept: Accept = None


class IntegralPart(ClaimPart):
    """An integral of the motion, everywhere or on a level set."""

    where: Annotated[list[str], Field(min_length=1)] = Field(
        [], description="functions that are zero on the level set where it is conserved"
    )

    @model_validator(mode="before")
    @classmethod
    def _from_former_name(cls, value: object) -> object:
        if isinstance(value, dict) and "integral" in value and "claim" not in value:
            return {"claim" if key == "integral" else key: x for key, x in value.items()}
        return value


class ClaimsPart(Part):
    """What is claimed of the motion and proved at every regeneration."""

    casimirs: list[ClaimPart] = Field(
        [], description="Casimirs of the bracket: scalars, or vectors of them, of the state"
    )
    conserved: list[IntegralPart] = Field(
        [], description="integrals of the motion; 'energy' and observables have their names here"
    )
    brackets: dict[str, ClaimPart] = Field(
        {},
        description="brackets such as '{L, A}' = '-hat(A)', of two expressions that are scalars or "
        "vectors",
    )
    galilean: FlagPart = Field(
        default_factory=lambda: FlagPart(claim=False),
        description="whether every Galilean transformation takes Newton's law to itself",
    )


def _no_claims() -> ClaimsPart:
    return ClaimsPart(casimirs=[], conserved=[], brackets={}, galilean=FlagPart(claim=False))


@dataclass(frozen=True)
class Integral:
    """A claimed integral of the motion: everywhere, or where some functions vanish.

    Attributes:
        formula: What is conserved, of any shape; it may name the energy and observables.
        where: The functions that are zero on the level set; empty for an integral everywhere.
    """

    formula: Formula
    where: tuple[Formula, ...] = ()

    @property
    def everywhere(self) -> str:
        """The name of what is conserved everywhere; "" on a level set, and of a longer formula."""
        tree = self.formula.tree
        return tree.name if isinstance(tree, Name) and not self.where else ""


@dataclass(frozen=True)
class ClaimedBracket:
    """``{left, right} = value``, of scalars or vectors."""

    left: Formula
    right: Formula
    value: Formula


@dataclass(frozen=True)
class Claims:
    """What is claimed.

    Attributes:
        casimirs: Casimirs of the bracket, scalars or vectors of them.
        conserved: Integrals of the motion, some of them on a level set alone.
        brackets: Brackets of observables, momentum maps and state.
        galilean: Where Newton's law is claimed to be that of every Galilean observer.
    """

    casimirs: tuple[Formula, ...] = ()
    conserved: tuple[Integral, ...] = ()
    brackets: tuple[ClaimedBracket, ...] = ()
    galilean: Place | None = None


def read_claims(reading: Reading, part: ClaimsPart) -> Claims:
    """All claims.

    Raises:
        SpecError: A formula does not fit; neither an energy nor momenta give a bracket, or no law
            of particles is there.
    """
    _check_claims(reading)
    return Claims(
        casimirs=_read_casimirs(reading),
        conserved=_read_conserved(reading),
        brackets=tuple(
            _read_bracket(reading, text, each.claim) for text, each in part.brackets.items()
        ),
        galilean=reading.source.place(("claims", "galilean")) if part.galilean.claim else None,
    )


def _read_casimirs(reading: Reading) -> tuple[Formula, ...]:
    scope = reading.scope("a Casimir", state_roles(reading), driven=())
    return tuple(
        _read_claim(reading, ("claims", "casimirs", place), part, scope)
        for place, part in enumerate(reading.file.claims.casimirs)
    )


def _read_conserved(reading: Reading) -> tuple[Integral, ...]:
    named = {**shapes_in_claims(reading), **emitted_shapes(MOMENTA.of(reading))}
    named |= followed_shapes(RECONSTRUCTION.of(reading))
    named |= emitted_shapes([each for each in OBSERVABLES.of(reading) if each.follows])
    if reading.file.hamiltonian is None and reading.file.lagrangian is None:
        del named["energy"]
    scope = reading.scope("an integral", motion_roles(reading), named)
    integrals = []
    for place, part in enumerate(reading.file.claims.conserved):
        key: KeyPath = ("claims", "conserved", place)
        formula = _read_claim(reading, key, part, scope)
        where = tuple(
            reading.formula((*key, "where", number), text, scope, any_shape=True)
            for number, text in enumerate(part.where)
        )
        integrals.append(Integral(formula, where))
    return tuple(integrals)


def _read_claim(reading: Reading, key: KeyPath, part: ClaimPart, scope: Scope) -> Formula:
    """A claimed formula, which may stand alone or in a table."""
    at = reading.source.place_of(key, "claim", "integral")  # integral: its former name
    return reading.formula(at, part.claim, scope, any_shape=True)


def _read_any(reading: Reading, key: KeyPath, text: str, kind: str) -> Formula:
    """A formula of any shape that may name what is emitted."""
    scope = reading.scope(kind, state_roles(reading), shapes_in_claims(reading))
    return reading.formula(key, text, scope, any_shape=True)


def _read_bracket(reading: Reading, text: str, value: str) -> ClaimedBracket:
    key: KeyPath = ("claims", "brackets", text)
    left, right = (
        _read_side(reading, key, text, side) for side in _split_sides(reading, key, text)
    )
    key = reading.source.place_of(key, "claim")
    formula = _read_any(reading, key, value, "a bracket")
    shape = left.shape + right.shape
    if formula.shape != shape:
        raise misfit(reading.source, key, formula, f"{words(shape)}, as {text} is")
    return ClaimedBracket(left, right, formula)


def _split_sides(reading: Reading, key: KeyPath, text: str) -> tuple[str, str]:
    """The two expressions of a key ``{f, g}``: it is cut at the comma outside parentheses."""
    inner = text.strip()
    if inner.startswith("{") and inner.endswith("}"):
        inner, depth = inner[1:-1], 0
        for place, letter in enumerate(inner):
            depth += (letter in "([") - (letter in ")]")
            if letter == "," and depth == 0:
                return inner[:place].strip(), inner[place + 1 :].strip()
    problem, expected = f"{text!a} is not a bracket", "a key such as '{L, A}'"
    raise reading.at_key(key, problem, text, expected)


def _read_side(reading: Reading, key: KeyPath, text: str, side: str) -> Formula:
    """One side of a bracket; faults point at the key, in which it stands."""
    at = reading.source.positions.key(key)
    try:
        formula = _read_any(reading, key, side, "a side of a bracket")
    except CoadjointError as error:
        problem = str(error).splitlines()[0].partition(f"{text}: ")[2] or str(error)
        raise reading.fault(
            key, f"{side!a}: {problem}".rstrip("."), error.parts.get("found"), at=at
        ) from None
    if len(formula.shape) > 1:
        problem = f"{side!a} is {words(formula.shape)}"
        expected = "scalars and vectors in a bracket"
        hint = "Take a row or a component of it, as A[1] or A[1, 2]."
        raise reading.fault(key, problem, side, expected, hint, at=at)
    return formula


def _check_claims(reading: Reading) -> None:
    """What is claimed of a bracket has one, and Galilean relativity has particles."""
    source, file, variables = reading.source, reading.file, VARIABLES.of(reading)
    claims = file.claims
    bare = file.algebra is None and file.poisson is None and file.lagrangian is None
    if bare and not any(variable.role == "momentum" for variable in variables):
        for table in ("casimirs", "brackets"):
            if getattr(claims, table):
                problem = f"there are {table} without a bracket"
                expected = "a Lagrangian, momenta or [poisson] that give a bracket"
                hint = f"Remove {table}, or declare [lagrangian] and a route that takes it."
                raise source.fault(("claims", table), problem, table, expected, hint)
    particles = [variable for variable in variables if variable.role == "coordinate"]
    flat = [q for q in particles if q.value_shape not in ((3,), (3, 3)) or q.form == "symmetric"]
    if claims.galilean.claim and (file.newton is None or flat):
        name = flat[0].name if flat else "newton"
        raise source.fault(
            ("claims", "galilean"),
            f"the coordinate {name!r} is not a particle in space"
            if flat
            else "there is no [newton]",
            name,
            "laws in [newton] of coordinates with shape = [3], one for each particle, or "
            'of one with shape = [9] and form = "matrix", a row for each particle',
        )


_ABOUT = "what is proved of the motion"
CLAIMS = Table[Claims](
    "claims",
    ClaimsPart,
    _ABOUT,
    read_claims,
    field=(ClaimsPart, Field(default_factory=_no_claims, description=_ABOUT)),
    attribute=None,
)
