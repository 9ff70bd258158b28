"""Schema: which keys a spec has, and of what kind, before anything is looked up or parsed.

Comes in: the tables that tomllib read. Goes out: a frozen `SpecFile`, or every fault of the file at
once. The same models give the JSON Schema by which editors complete and check a spec.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from coadjoint.spec.values import (
    BRACKET_PATTERN,
    NAME_PATTERN,
    POISSON_PATTERN,
    Block,
    Entry,
    Length,
    License,
    Matrix,
    Names,
    Numbers,
    Prose,
    Title,
    Unit,
    is_unique,
)


def _no_titles(schema: dict[str, Any]) -> None:
    """Drop the titles that pydantic makes of key names; they say nothing."""
    for part in (schema, *schema.get("properties", {}).values()):
        part.pop("title", None)


def _named(pattern: str = NAME_PATTERN) -> dict[str, Any]:
    """What a JSON Schema says about the keys of a table of names."""
    return {"propertyNames": {"pattern": pattern}}


class Part(BaseModel):
    """A table of a spec: unknown keys are refused, nothing is converted."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, json_schema_extra=_no_titles
    )


def _also_text(schema: dict[str, Any]) -> None:
    """The table may be a text alone."""
    _no_titles(schema)
    table = dict(schema)
    schema.clear()
    schema["anyOf"] = [{"type": "string"}, table]


#: The ways to declare an algebra, of which each takes exactly one.
WAYS = (
    "name",
    "brackets",
    "matrices",
    "direct_sum",
    "semidirect",
    "extension",
    "leibniz",
    "complexification",
    "subalgebra",
)


class _Algebra(Part):
    """The ways to declare a Lie algebra."""

    name: str | None = Field(None, description="an algebra by name, such as 'so(3)' or 'sl(2,R)'")
    basis: Names | None = Field(None, description="names of the basis, in order")
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '[e1, e2]' = 'e3', each pair once; the others are 0",
        json_schema_extra=_named(BRACKET_PATTERN),
    )
    matrices: dict[str, Matrix] | None = Field(
        None, description="a matrix for each name of the basis", json_schema_extra=_named()
    )
    direct_sum: Annotated[list[OperandPart], Field(min_length=2)] | None = Field(
        None, description="algebras that commute with each other, as ['so(3)', 'so(3)']"
    )
    semidirect: SemidirectPart | None = Field(
        None, description="an algebra with the spaces, or the ideal, that it acts on"
    )
    extension: ExtensionPart | None = Field(None, description="a central extension by a 2-cocycle")
    leibniz: LeibnizPart | None = Field(
        None, description="an algebra with polynomials in eps, eps^order = 0, as coefficients"
    )
    complexification: OperandPart | None = Field(
        None, description="an algebra with complex coefficients, as a real algebra"
    )
    subalgebra: SubalgebraPart | None = Field(
        None, description="the span of some vectors of an algebra"
    )
    blocks: dict[str, Names] | None = Field(
        None, description="named parts of the basis", json_schema_extra=_named()
    )

    @model_validator(mode="after")
    def _one_way(self) -> _Algebra:
        ways = [way for way in WAYS if getattr(self, way) is not None]
        if len(ways) != 1:
            raise ValueError(f"exactly one of {', '.join(WAYS)}")
        if self.brackets is not None and self.basis is None:
            raise ValueError("a basis beside the brackets, as basis = ['e1', 'e2', 'e3']")
        if self.name is not None and (self.basis is not None or self.blocks is not None):
            raise ValueError("no basis and no blocks beside a name, which has its own")
        if self.basis is not None and ways[0] not in ("brackets", "matrices"):
            raise ValueError(f"no basis beside {ways[0]}, which makes its own")
        return self


class AlgebraPart(_Algebra):
    """The Lie algebra of the velocities."""

    invariance: Literal["left", "right"] = Field(
        "left", description="'left' (body frame, the default) or 'right' (space frame)"
    )


class OperandPart(_Algebra):
    """An algebra that a larger one is made of: its name, or a table."""

    model_config = ConfigDict(json_schema_extra=_also_text)

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"name": value} if isinstance(value, str) else value


class ActionPart(Part):
    """A linear action: the name of a representation, or a table of matrices."""

    model_config = ConfigDict(json_schema_extra=_also_text)

    name: str | None = Field(None, description="a representation by name, such as 'vector'")
    matrices: dict[str, Matrix] | None = Field(
        None,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=_named(),
    )

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"name": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _one_way(self) -> ActionPart:
        if (self.name is None) == (not self.matrices):
            raise ValueError("the name of a representation, or matrices")
        return self


class SemidirectPart(Part):
    """An algebra that acts on vector spaces, or on an ideal."""

    algebra: OperandPart = Field(description="the algebra that acts")
    representations: dict[str, ActionPart] | None = Field(
        None,
        description="how it acts on spaces, by the lead of their names, as p of p1 p2 p3",
        json_schema_extra=_named(),
    )
    ideal: OperandPart | None = Field(None, description="the algebra that it acts on")
    action: ActionPart | None = Field(None, description="how it acts on the ideal: derivations")

    @model_validator(mode="after")
    def _one_way(self) -> SemidirectPart:
        if bool(self.representations) == (self.ideal is not None):
            raise ValueError("either representations or an ideal")
        if (self.ideal is None) != (self.action is None):
            raise ValueError("ideal and action together")
        return self


class ExtensionPart(Part):
    """A central extension: ``[e_i, e_j]`` gains ``cocycle(e_i, e_j)`` times the center."""

    algebra: OperandPart = Field(description="the algebra that is extended")
    center: str = Field("Z", description="name of the new vector of the basis")
    cocycle: dict[str, Entry] = Field(
        description="values such as '[K1, P1]' = 1, each pair once; the others are 0",
        json_schema_extra=_named(BRACKET_PATTERN),
    )


class LeibnizPart(Part):
    """The algebra with coefficients in R[eps] / eps^order."""

    algebra: OperandPart = Field(description="the algebra of eps = 0")
    order: Length = Field(description="the power of eps that is 0")


class SubalgebraPart(Part):
    """The span of some vectors, which must be closed under the bracket."""

    algebra: OperandPart = Field(description="the algebra that holds it")
    basis: dict[str, str] = Field(
        min_length=1,
        description="vectors by name, such as X1 = 'E12 + E34'",
        json_schema_extra=_named(),
    )


class PoissonPart(Part):
    """A Poisson bracket of coordinates, in the place of an algebra."""

    nambu: Annotated[list[str], Field(min_length=1)] | None = Field(
        None, description="the n - 2 distinguished functions of n coordinates"
    )
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '{X1, X2}' = '4*X3', each pair once; the others are 0",
        json_schema_extra=_named(POISSON_PATTERN),
    )
    canonical: list[Annotated[list[str], Field(min_length=2, max_length=2)]] | None = Field(
        None, description="pairs of a position and its momentum, as [['q', 'p']]"
    )
    magnetic: dict[str, str] | None = Field(
        None,
        description="brackets of canonical momenta, such as '{p1, p2}' = 'B*q3'",
        json_schema_extra=_named(POISSON_PATTERN),
    )

    @model_validator(mode="after")
    def _one_way(self) -> PoissonPart:
        ways = [self.nambu, self.brackets, self.canonical]
        if sum(way is not None for way in ways) != 1:
            raise ValueError("exactly one of nambu, brackets and canonical")
        if self.magnetic is not None and self.canonical is None:
            raise ValueError("magnetic terms beside canonical alone")
        return self


class RepresentationPart(Part):
    """A linear action of the algebra on advected quantities."""

    matrices: dict[str, Matrix] = Field(
        min_length=1,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=_named(),
    )


class VariablePart(Part):
    """A velocity, a momentum, an advected quantity or a coordinate."""

    role: Literal["velocity", "momentum", "advected", "coordinate"] = Field(
        description="'velocity', 'momentum', 'advected' over an algebra; 'coordinate' without one, "
        "with a 'velocity' or 'momentum' of it"
    )
    block: Block | None = Field(
        None, description="the block of the algebra that it spans; by default all of it"
    )
    representation: str | None = Field(
        None,
        description="how the algebra acts on an advected quantity: 'vector', 'adjoint', "
        "'coadjoint' and others, or a declared one",
    )
    shape: Annotated[list[Length], Field(max_length=1)] | None = Field(
        None, description="of a coordinate: [] for a scalar (the default), [n] for n components"
    )
    of: str | None = Field(
        None,
        description="the coordinate whose velocity, or conjugate momentum, it is; its shape and "
        "form are those of the coordinate",
    )
    form: Literal["antisymmetric", "symmetric", "matrix"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, those with the diagonal, or all, row by row",
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class ParameterPart(Part):
    """A constant of the system."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    positive: bool = Field(False, description="whether every component is positive")
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class LagrangianPart(Part):
    """The reduced Lagrangian."""

    l: str = Field(description="l of velocities, advected quantities and parameters")  # noqa: E741


class HamiltonianPart(Part):
    """The reduced Hamiltonian."""

    h: str = Field(description="h of momenta, advected quantities or coordinates, and parameters")


class LaxPart(Part):
    """A Lax pair, ``dL/dt = [L, M]`` for every value of the spectral parameter."""

    spectral: str = Field("lambda", description="name of the spectral parameter in L and M")
    L: str = Field(description="a square matrix of state, parameters and the spectral parameter")
    M: str = Field(description="the same of velocities too: how L turns")


class NewtonPart(Part):
    """Newton's law of one coordinate: ``mass * acceleration = force``."""

    mass: str = Field("1", description="a scalar, or a matrix that multiplies the acceleration")
    force: str = Field(description="the force, of the shape of the coordinate")


class ObservablePart(Part):
    """A scalar emitted beside the dynamics."""

    model_config = ConfigDict(json_schema_extra=_also_text)

    expression: str = Field(description="a scalar of variables and parameters")
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"expression": value} if isinstance(value, str) else value


class ClaimsPart(Part):
    """What is claimed of the motion and proved at every regeneration."""

    casimirs: list[str] = Field([], description="Casimirs of the bracket: scalars of the state")
    conserved: list[str] = Field(
        [], description="integrals of the motion; 'energy' and observables have their names here"
    )


RouteName = Literal[
    "euler-poincare",
    "lie-poisson",
    "hamilton-pontryagin",
    "clebsch",
    "poincare",
    "matrix-euler-poincare",
    "newton-euler",
    "cayley-klein",
    "kaluza-klein",
    "complexification",
    "manakov",
    "lax",
    "nambu",
    "poisson",
    "canonical",
    "euler-lagrange",
    "newton",
    "alignment",
]


def _no_claims() -> ClaimsPart:
    return ClaimsPart(casimirs=[], conserved=[])


class SpecFile(Part):
    """A declared system: its algebra, its variables and parameters, its energy."""

    title: Title = Field(description="the system's name as a book has it")
    source: Prose = Field("", description="where the equations can be looked up")
    description: Prose = Field("", description="free text for documents")
    license: License = Field(
        "", description="SPDX expression of the licence of this file and of what is generated"
    )
    routes: Annotated[
        list[RouteName],
        Field(min_length=1),
        AfterValidator(is_unique),
    ] = Field(description="routes to derive by; the first is emitted, the others proved equal")
    algebra: AlgebraPart | None = Field(None, description="the Lie algebra of the velocities")
    poisson: PoissonPart | None = Field(
        None, description="a Poisson bracket of coordinates, where there is no algebra"
    )
    representations: dict[str, RepresentationPart] = Field(
        {}, description="declared representations", json_schema_extra=_named()
    )
    variables: dict[str, VariablePart] = Field(
        min_length=1, description="the variables by name", json_schema_extra=_named()
    )
    parameters: dict[str, ParameterPart] = Field(
        {}, description="the parameters by name", json_schema_extra=_named()
    )
    lagrangian: LagrangianPart | None = Field(None, description="the reduced Lagrangian")
    hamiltonian: HamiltonianPart | None = Field(None, description="the reduced Hamiltonian")
    lax: LaxPart | None = Field(None, description="a Lax pair of the motion")
    newton: Annotated[dict[str, NewtonPart], Field(min_length=1)] | None = Field(
        None, description="Newton's law, by the names of coordinates", json_schema_extra=_named()
    )
    observables: dict[str, ObservablePart] = Field(
        {}, description="scalars emitted beside the dynamics", json_schema_extra=_named()
    )
    claims: ClaimsPart = Field(
        default_factory=_no_claims, description="what is proved of the motion"
    )


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a spec, for editors; ``#:schema`` in a spec's first line names it."""
    schema = _without_null(SpecFile.model_json_schema())
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "coadjoint spec"}
    return {**head, **schema}


def _without_null(schema: Any) -> Any:
    """A schema without the null that pydantic allows for optional keys; TOML has none."""
    if isinstance(schema, list):
        return [_without_null(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    kept = {k: _without_null(v) for k, v in schema.items() if (k, v) != ("default", None)}
    if len(kept.get("anyOf", "  ")) == 1:
        kept |= kept.pop("anyOf")[0]
    return kept


# Algebras are made of algebras: names that came later are looked up now, for `model_fields`.
for _part in (AlgebraPart, OperandPart, SemidirectPart, ExtensionPart, LeibnizPart, SubalgebraPart):
    _part.model_rebuild(force=True)
