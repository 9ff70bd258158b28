"""Charts: the table [charts], the same motion in other variables.

Comes in: for each chart its variables, the map from them to the state, and how they move. Goes out:
`DeclaredChart` records. That the map takes the motion of the chart to the emitted one is proved.
Read next: `coadjoint.derive.charts`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import Shape, component_names
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import Formula, Scope, read_fitting
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.sections.reduction import REDUCTION, list_left
from coadjoint.spec.sections.state import state_of
from coadjoint.spec.sections.variables import VARIABLES

#: Ways to say how a chart moves.
_MOTIONS = ("rates", "hamiltonian", "lagrangian")
_Count = Annotated[int, Field(ge=1, le=256)]
_Pair = Annotated[list[str], Field(min_length=2, max_length=2)]


class ChartPart(Part):
    """The same motion in other variables."""

    variables: Annotated[dict[str, list[_Count]], Field(min_length=1)] = Field(
        description="shapes by name: [] of a scalar, [3] of a vector",
        json_schema_extra=name_pattern(),
    )
    map: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="each variable of the state in terms of these", json_schema_extra=name_pattern()
    )
    where: list[str] = Field([], description="functions of these variables that are 0 throughout")
    rates: dict[str, str] = Field(
        {}, description="the time derivative of each", json_schema_extra=name_pattern()
    )
    hamiltonian: str = Field("", description="h of positions and momenta, in place of rates")
    lagrangian: str = Field("", description="l of positions and velocities, in place of rates")
    pairs: list[_Pair] = Field(
        [], description="positions with their momenta or velocities, with h or l"
    )


@dataclass(frozen=True)
class ChartVariable:
    """A variable of a chart."""

    name: str
    shape: Shape

    @property
    def components(self) -> tuple[str, ...]:
        """Names of its components, row by row."""
        return component_names(self.name, self.shape)


@dataclass(frozen=True)
class DeclaredChart:
    """The same motion in other variables.

    Attributes:
        name: As declared.
        variables: What moves.
        map: Each variable of the state in terms of these.
        where: Functions that are zero throughout.
        kind: ``rates``, ``hamiltonian`` or ``lagrangian``: how the motion is given.
        motion: The rates by variable, or h or l by its kind.
        pairs: Positions with their momenta or velocities, with h or l.
    """

    name: str
    variables: tuple[ChartVariable, ...]
    map: Mapping[str, Formula]
    where: tuple[Formula, ...]
    kind: str
    motion: Mapping[str, Formula]
    pairs: tuple[tuple[str, str], ...] = ()


def read_charts(reading: Reading, parts: Mapping[str, ChartPart]) -> tuple[DeclaredChart, ...]:
    """The declared charts, in order.

    Raises:
        SpecError: A formula does not fit, or something is missing or too much.
    """
    return tuple(_read_chart(reading, name, part) for name, part in parts.items())


def _read_chart(reading: Reading, name: str, part: ChartPart) -> DeclaredChart:
    """One chart."""
    key: KeyPath = ("charts", name)
    variables = tuple(ChartVariable(n, tuple(shape)) for n, shape in part.variables.items())
    own = {v.name: v.shape for v in variables}
    shapes = own | {c: () for v in variables for c in v.components if v.shape}
    scope = reading.scope("a chart", (), shapes)
    for v in variables:
        reading.declare(
            Naming(key=(*key, "variables", v.name), name=v.name, components=v.components)
        )
    reduction = REDUCTION.of(reading)
    fixed = {} if reduction is None else reduction.section
    left = list_left(state_of(VARIABLES.of(reading)), fixed)
    state = {v.name: v.value_shape for v in left}
    given = [each for each in _MOTIONS if getattr(part, each)]
    if len(given) != 1:
        problem = f"the chart has {list_names(given) or 'no motion'}"
        expected = f"exactly one of {list_names(_MOTIONS)}"
        hint = "Write rates = { r = ... } for every variable."
        raise reading.at_key(key, problem, list_names(given), expected, hint)
    (kind,) = given
    if kind == "rates" and part.pairs:
        problem = "there are pairs with rates"
        expected = "pairs only with a Hamiltonian or a Lagrangian"
        raise reading.at_key((*key, "pairs"), problem, "pairs", expected, "Remove pairs.")
    if kind == "rates":
        motion = _read_each(reading, (*key, "rates"), part.rates, scope, own)
    else:
        motion = {kind: reading.formula((*key, kind), getattr(part, kind), scope)}
        _check_pairs(reading, key, part, own)
    return DeclaredChart(
        name=name,
        variables=variables,
        map=_read_each(reading, (*key, "map"), part.map, scope, state),
        where=tuple(
            reading.formula((*key, "where", place), text, scope)
            for place, text in enumerate(part.where)
        ),
        kind=kind,
        motion=motion,
        pairs=tuple((q, p) for q, p in part.pairs),
    )


def _read_each(
    reading: Reading,
    key: KeyPath,
    texts: Mapping[str, str],
    scope: Scope,
    shapes: Mapping[str, Shape],
) -> dict[str, Formula]:
    """A formula for each name, of its shape."""
    for name in texts:
        if name not in shapes:
            problem = f"there is no variable {name!a}"
            raise reading.unknown((*key, name), problem, name, shapes, is_key=True)
    missing = [name for name in shapes if name not in texts]
    if missing:
        raise _incomplete(reading, key, missing)
    return {
        name: read_fitting(reading.source, (*key, name), texts[name], scope, shape, name)
        for name, shape in shapes.items()
    }


def _check_pairs(reading: Reading, key: KeyPath, part: ChartPart, own: Mapping[str, Shape]) -> None:
    """Each variable is in one pair, with one of its shape."""
    paired = [name for pair in part.pairs for name in pair]
    wrong = [name for name in paired if name not in own or paired.count(name) > 1]
    wrong += [q for q, p in part.pairs if q in own and p in own and own[q] != own[p]]
    if wrong:
        problem = f"{wrong[0]!r} is in no pair of one shape, or in two"
        expected = f"each of {list_names(own)} in one pair"
        raise reading.at_key((*key, "pairs") if part.pairs else key, problem, wrong[0], expected)
    missing = [name for name in own if name not in paired]
    if missing:
        raise _incomplete(reading, (*key, "pairs") if part.pairs else key, missing)


def _incomplete(reading: Reading, key: KeyPath, missing: list[str]) -> CoadjointError:
    """Something is said of some variables and not of others."""
    return reading.at_key(
        key, f"{list_names(missing)} is missing", list_names(missing), "every variable"
    )


CHARTS = Table[tuple[DeclaredChart, ...]](
    "charts",
    ChartPart,
    "the same motion in other variables, by name",
    read_charts,
    many=True,
)
