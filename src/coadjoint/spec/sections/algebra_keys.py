"""Keys of algebras: the tables that declare a Lie algebra, alone or inside one another.

Comes in: the tables that tomllib read. Goes out: frozen parts of a `SpecFile`.
Read next: `coadjoint.spec.sections.algebras`, which reads them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from coadjoint.spec.core.parts import Part, TextPart, name_pattern
from coadjoint.spec.core.values import BRACKET_PATTERN, Entry, Length, Matrix, Names

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

    name: str | None = Field(
        None,
        description="an algebra by name, such as 'so(3)' or 'sl(2,R)'; 'so(n)' and 'sp(2n)' with "
        "the number of members of an [index], n",
    )
    basis: Names | None = Field(None, description="names of the basis, in order")
    brackets: dict[str, str] | None = Field(
        None,
        description="brackets such as '[e1, e2]' = 'e3', each pair once; the others are 0",
        json_schema_extra=name_pattern(BRACKET_PATTERN),
    )
    matrices: dict[str, Matrix] | None = Field(
        None, description="a matrix for each name of the basis", json_schema_extra=name_pattern()
    )
    imaginary: Annotated[dict[str, Matrix], Field(min_length=1)] | None = Field(
        None,
        description="imaginary parts B of the matrices, whose real parts are A: the algebra is "
        "that of the real matrices [[A, -B], [B, A]]; what one table leaves out is 0 there",
        json_schema_extra=name_pattern(),
    )
    bracket: str | None = Field(
        None,
        description="the bracket of two matrices X and Y of their span, such as 'X*N*Y - Y*N*X'; "
        "by default the commutator",
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
        None, description="named parts of the basis", json_schema_extra=name_pattern()
    )

    @model_validator(mode="after")
    def _one_way(self) -> _Algebra:
        ways = [way for way in WAYS if getattr(self, way) is not None]
        if len(ways) != 1:
            raise ValueError(f"exactly one of {', '.join(WAYS)}")
        if self.brackets is not None and self.basis is None:
            raise ValueError("a basis with the brackets, as basis = ['e1', 'e2', 'e3']")
        if self.imaginary is not None and self.matrices is None:
            raise ValueError("imaginary parts only with matrices, which are the real ones")
        if self.bracket is not None and self.matrices is None:
            raise ValueError("a bracket of X and Y only with matrices")
        if self.name is not None and (self.basis is not None or self.blocks is not None):
            raise ValueError("no basis and no blocks with a name, which has its own")
        if self.basis is not None and ways[0] not in ("brackets", "matrices"):
            raise ValueError(f"no basis with {ways[0]}, which makes its own")
        return self


class AlgebraPart(_Algebra):
    """The Lie algebra of the velocities."""

    invariance: Literal["left", "right"] = Field(
        "left", description="'left' (body frame, the default) or 'right' (space frame)"
    )


class OperandPart(_Algebra, TextPart):
    """An algebra that a larger one is made of: its name, or a table."""

    alone = "name"


class ActionPart(TextPart):
    """A linear action: the name of a representation, or a table of matrices."""

    alone = "name"

    name: str | None = Field(None, description="a representation by name, such as 'vector'")
    matrices: dict[str, Matrix] | None = Field(
        None,
        description="a matrix for each name of the basis; those left out act as zero",
        json_schema_extra=name_pattern(),
    )

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
        json_schema_extra=name_pattern(),
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
        json_schema_extra=name_pattern(BRACKET_PATTERN),
    )


class LeibnizPart(Part):
    """The algebra with coefficients in R[eps] / eps^order."""

    algebra: OperandPart = Field(description="the algebra of eps = 0")
    order: Length = Field(description="the power of eps that is 0")


class SubalgebraPart(Part):
    """The span of some vectors, which must be closed under the bracket."""

    algebra: OperandPart = Field(description="the algebra that contains it")
    basis: dict[str, str] = Field(
        min_length=1,
        description="vectors by name, such as X1 = 'E12 + E34'",
        json_schema_extra=name_pattern(),
    )


# Algebras are made of algebras: names that came later are looked up now, for `model_fields`.
for _part in (AlgebraPart, OperandPart, SemidirectPart, ExtensionPart, LeibnizPart, SubalgebraPart):
    _part.model_rebuild(force=True)
