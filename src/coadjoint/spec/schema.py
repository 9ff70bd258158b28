"""Schema: which keys a spec has, and of what kind, before anything is looked up or parsed.

Comes in: the tables that tomllib read. Goes out: a frozen `SpecFile`, or every fault of the file at
once. The same models give the JSON Schema by which editors complete and check a spec.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from coadjoint.spec.core.values import (
    DEFINITION_PATTERN,
    POISSON_PATTERN,
    Block,
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
from coadjoint.spec.routes import ROUTES
from coadjoint.spec.sections.algebra_schema import (
    AlgebraPart,
    OperandPart,
    Part,
    also_flag,
    also_text,
    named,
)
from coadjoint.spec.sections.constrained_schema import (
    Accept,
    DissipationPart,
    DoubleBracketPart,
    MetriplecticPart,
    ReconstructedPart,
    RollingPart,
    SectionPart,
)


class PoissonPart(Part):
    """A Poisson bracket of coordinates, in the place of an algebra."""

    nambu: Annotated[list[str], Field(min_length=1)] | None = Field(
        None, description="the n - 2 distinguished functions of n coordinates"
    )
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '{X1, X2}' = '4*X3', each pair once; the others are 0",
        json_schema_extra=named(POISSON_PATTERN),
    )
    canonical: list[Annotated[list[str], Field(min_length=2, max_length=2)]] | None = Field(
        None, description="pairs of a position and its momentum, as [['q', 'p']]"
    )
    magnetic: dict[str, str] | None = Field(
        None,
        description="brackets of canonical momenta, such as '{p1, p2}' = 'B*q3'",
        json_schema_extra=named(POISSON_PATTERN),
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
    """A linear action of the algebra on advected quantities: by matrices, or on matrices."""

    matrices: Annotated[dict[str, Matrix], Field(min_length=1)] | None = Field(
        None,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=named(),
    )
    left: Block | None = Field(
        None, description="the block whose matrices L act as A -> L A on matrices A, row by row"
    )
    right: Block | None = Field(
        None, description="the block whose matrices R act as A -> -A R on matrices A, row by row"
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
    default: Numbers | None = Field(
        None,
        description="where `coadjoint simulate` begins unless told otherwise: a number for all "
        "components, or a list of them",
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class ParameterPart(Part):
    """A constant of the system."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    form: Literal["antisymmetric", "symmetric"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, or those with the diagonal, row by row",
    )
    positive: bool = Field(False, description="whether every component is positive")
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    unit: Unit = Field("1", description="unit, such as 'kg m^2'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class InputPart(Part):
    """What drives the system from outside, as a control or a measured signal."""

    shape: Annotated[list[Length], Field(max_length=2)] = Field(
        [], description="[] for a scalar, [n] for a vector, [n, m] for a matrix"
    )
    default: Numbers | None = Field(
        None, description="exact default: a number for all components, or nested lists of them"
    )
    rate: str | None = Field(
        None, description="the input that is its time derivative, where the motion needs this"
    )
    unit: Unit = Field("1", description="unit, such as 'N m'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")


class TimePart(Part):
    """The time, for formulas that name it."""

    name: str = Field("t", description="its name in formulas")
    unit: Unit = Field("s", description="unit; '1' if dimensionless")
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


class ClebschPart(Part):
    """A canonical pair of the route clebsch, beside those of the advected quantities."""

    representation: str = Field(description="how the algebra acts on it, such as 'adjoint'")


class ReductionPart(Part):
    """A submanifold that the motion keeps, on which some variables follow from the others."""

    section: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="what variables are there, as y = 'cross(x, K*x)'; they are no state any more",
        json_schema_extra=named(),
    )
    where: list[str] = Field([], description="functions of all variables that vanish there")


class ObservablePart(Part):
    """A scalar, vector or matrix emitted beside the dynamics."""

    model_config = ConfigDict(json_schema_extra=also_text)

    expression: str = Field(description="a scalar, vector or matrix of variables and parameters")
    unit: Unit = Field("1", description="unit, such as 'kg m^2/s'; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"expression": value} if isinstance(value, str) else value


class SymmetryPart(Part):
    """An infinitesimal action of a Lie algebra on the state, with its momentum map."""

    algebra: OperandPart = Field(description="the algebra that acts: its name, or a table")
    vector: str | None = Field(
        None,
        description="name of an element of the algebra, as its coefficients along the basis; with "
        "_ and the name of a block, those along the block, as xi_rotation",
    )
    matrix: str | None = Field(
        None, description="name of an element of the algebra, as a matrix of the algebra"
    )
    generators: Annotated[dict[str, str], Field(min_length=1)] | None = Field(
        None,
        description="how variables move, linear in the element: of positions alone, whose momenta "
        "then follow, or of the whole state, where what is left out stands still",
        json_schema_extra=named(),
    )
    linear: Names | None = Field(
        None, description="variables on whose stacked components the algebra's matrices act"
    )
    time: str | None = Field(None, description="how time moves, linear in the element")
    map: str | None = Field(
        None, description="the momentum map paired with the element, where it is not derived"
    )
    side: Literal["left", "right"] = Field("left", description="of the action")
    form: Literal["antisymmetric", "symmetric", "matrix"] | None = Field(
        None, description="the matrix whose entries are the components of the momentum map"
    )
    accept: Accept = None
    unit: Unit = Field("1", description="unit of the momentum map; '1' if dimensionless")
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="after")
    def _one_way(self) -> SymmetryPart:
        if (self.generators is None) == (self.linear is None):
            raise ValueError("either generators or linear")
        formulas = self.generators is not None or self.time is not None or self.map is not None
        if (self.vector is not None) + (self.matrix is not None) != formulas:
            raise ValueError("one name, vector or matrix, where formulas use it")
        return self


class ClaimPart(Part):
    """A claim: its expression, or a table that also says what is enough for it."""

    model_config = ConfigDict(json_schema_extra=also_text)

    claim: str = Field(description="what is claimed")
    accept: Accept = None

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: object) -> object:
        return {"claim": value} if isinstance(value, str) else value


class FlagPart(Part):
    """A claim without an expression: whether it is made, or a table."""

    model_config = ConfigDict(json_schema_extra=also_flag)

    claim: bool = Field(description="whether this is claimed")
    accept: Accept = None

    @model_validator(mode="before")
    @classmethod
    def _from_flag(cls, value: object) -> object:
        return {"claim": value} if isinstance(value, bool) else value


class TransformationPart(Part):
    """A map of the state that takes the motion to itself, or to its reverse."""

    map: Annotated[dict[str, str], Field(min_length=1)] = Field(
        description="what variables become; those left out stay", json_schema_extra=named()
    )
    reverses_time: bool = Field(False, description="whether it takes the motion to its reverse")
    exchanges: dict[str, ClaimPart] = Field(
        {},
        description="what observables and momentum maps become, as J_L = 'J_R'",
        json_schema_extra=named(),
    )
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


if TYPE_CHECKING:
    RouteName = str
else:
    RouteName = Literal[tuple(ROUTES)]


def _no_claims() -> ClaimsPart:
    return ClaimsPart(casimirs=[], conserved=[], brackets={}, galilean=FlagPart(claim=False))


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
        {}, description="declared representations", json_schema_extra=named()
    )
    variables: dict[str, VariablePart] = Field(
        min_length=1, description="the variables by name", json_schema_extra=named()
    )
    parameters: dict[str, ParameterPart] = Field(
        {}, description="the parameters by name", json_schema_extra=named()
    )
    inputs: dict[str, InputPart] = Field(
        {}, description="what drives the system, by name", json_schema_extra=named()
    )
    time: TimePart | None = Field(None, description="the time, where formulas name it")
    definitions: dict[str, str] = Field(
        {},
        description="short names for expressions, such as u = 'A*b' and 'V(s, d)' = 's^2 - d'",
        json_schema_extra=named(DEFINITION_PATTERN),
    )
    lagrangian: LagrangianPart | None = Field(None, description="the reduced Lagrangian")
    hamiltonian: HamiltonianPart | None = Field(None, description="the reduced Hamiltonian")
    clebsch: ClebschPart | None = Field(
        None, description="a canonical pair of its own for the route clebsch"
    )
    lax: LaxPart | None = Field(None, description="a Lax pair of the motion")
    newton: Annotated[dict[str, NewtonPart], Field(min_length=1)] | None = Field(
        None, description="Newton's law, by the names of coordinates", json_schema_extra=named()
    )
    reduction: ReductionPart | None = Field(
        None, description="the submanifold to which the motion is restricted"
    )
    constraints: Annotated[dict[str, str], Field(min_length=1)] | None = Field(
        None,
        description="equations between velocities, as rolling = 'Y == cross(Omega, s)'",
        json_schema_extra=named(),
    )
    forces: dict[str, str] = Field(
        {},
        description="forces beside the energy, by the names of the velocities they work on",
        json_schema_extra=named(),
    )
    dissipation: DissipationPart | None = Field(None, description="dissipation by a function R")
    double_bracket: DoubleBracketPart | None = Field(
        None, description="dissipation that keeps Casimirs, dx/dt = P dh + P G P dh"
    )
    metriplectic: MetriplecticPart | None = Field(
        None, description="dissipation that keeps the energy, dx/dt = P dh + G dS"
    )
    domain: dict[str, str] = Field(
        {},
        description="where the system is defined, as tilted = 'Gamma3^2 < 1'",
        json_schema_extra=named(),
    )
    rolling: RollingPart | None = Field(None, description="a body that rolls on a plane")
    reconstruction: dict[str, ReconstructedPart] = Field(
        {}, description="what follows from the motion, as x = 'v'", json_schema_extra=named()
    )
    momenta: dict[str, SectionPart] = Field(
        {},
        description="momenta along sections of the constraint distribution, by name",
        json_schema_extra=named(),
    )
    observables: dict[str, ObservablePart] = Field(
        {}, description="what is emitted beside the dynamics", json_schema_extra=named()
    )
    symmetries: dict[str, SymmetryPart] = Field(
        {}, description="symmetries by the names of their momentum maps", json_schema_extra=named()
    )
    transformations: dict[str, TransformationPart] = Field(
        {}, description="maps that keep the motion, by name", json_schema_extra=named()
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
