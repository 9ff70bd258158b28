"""Symmetries: the table [symmetries], infinitesimal actions with their momentum maps.

Comes in: its keys. Goes out: `Symmetry` records, whose formulas fit the variables that they move
and are linear in the element of the algebra. Whether what they say is true is proved later.
Read next: `coadjoint.derive.symmetries`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field, model_validator

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.matrices import size
from coadjoint.spec.core.components import Shape, component_names, matrix_size
from coadjoint.spec.core.degrees import degree_in
from coadjoint.spec.core.faults import ExpressionError, list_names
from coadjoint.spec.core.formulas import Formula, read_fitting
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.parts import Accept, Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.source import Place
from coadjoint.spec.core.values import Names, Prose, Unit, misfit_form
from coadjoint.spec.sections.algebra_keys import OperandPart
from coadjoint.spec.sections.algebras import read_algebra, scalars_of
from coadjoint.spec.sections.momenta import Section
from coadjoint.spec.sections.observables import OBSERVABLES, Observable
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.variables import VARIABLES, state_roles


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
        json_schema_extra=name_pattern(),
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
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")

    @model_validator(mode="after")
    def _one_way(self) -> SymmetryPart:
        if (self.generators is None) == (self.linear is None):
            raise ValueError("either generators or linear")
        formulas = self.generators is not None or self.time is not None or self.map is not None
        if (self.vector is not None) + (self.matrix is not None) != formulas:
            raise ValueError("one name, vector or matrix, where formulas use it")
        return self


@dataclass(frozen=True)
class Symmetry:
    """An infinitesimal action, whose momentum map is emitted with the dynamics.

    Attributes:
        name: Of the momentum map.
        place: Where it is declared.
        algebra: What acts.
        element: Name of its generic element in the formulas; "" if they are none.
        as_matrix: Whether the element is a matrix there, not the vector of its coefficients.
        generators: How variables move, by name.
        linear: Variables on whose stacked components the matrices of the algebra act.
        time: How time moves, or None.
        map: The momentum map paired with the element, where it is declared, or None.
        side: ``"left"`` or ``"right"``.
        form: One of `FORMS` if the components are the entries of a matrix, else "".
        unit: Unit text of the momentum map.
        doc: Free text for documents.
    """

    name: str
    place: Place
    algebra: LieAlgebra
    element: str = ""
    as_matrix: bool = False
    generators: Mapping[str, Formula] = field(default_factory=dict)
    linear: tuple[str, ...] = ()
    time: Formula | None = None
    map: Formula | None = None
    side: str = "left"
    form: str = ""
    unit: str = ""
    doc: str = ""

    @property
    def shape(self) -> Shape:
        """Shape of the components as they are kept: the whole matrix, or a list."""
        if self.form == "matrix":
            return self.value_shape
        return (self.algebra.dimension,) if self.algebra.dimension > 1 or self.form else ()

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components, one for each basis vector."""
        return component_names(self.name, self.shape, "" if self.form == "matrix" else self.form)

    @property
    def value_shape(self) -> Shape:
        """Shape in formulas: that of the whole matrix where there is a form."""
        size = matrix_size(self.algebra.dimension, self.form) if self.form else None
        return self.shape if size is None else (size, size)


def read_symmetries(reading: Reading, parts: Mapping[str, SymmetryPart]) -> tuple[Symmetry, ...]:
    """The declared actions, in order.

    Raises:
        SpecError: A formula does not fit, or is not linear in the element.
        AlgebraError: The algebra is none.
    """
    OBSERVABLES.of(reading)  # whose names elements may not have
    actions = _Actions(reading)
    return tuple(actions.symmetry(name, part) for name, part in parts.items())


def find_moved(reading: Reading, key: KeyPath, name: str) -> Variable:
    """The variable of the state that something moves.

    Raises:
        SpecError: There is none of that name.
    """
    state = _list_movable(reading)
    if name not in state:
        problem = f"{name!a} is not a variable of the state"
        raise reading.unknown(key, problem, name, state)
    return state[name]


def _list_movable(reading: Reading) -> dict[str, Variable]:
    """The variables of the state by name, without those that [reduction] gives."""
    reduction = reading.file.reduction
    given = () if reduction is None else reduction.section
    return {v.name: v for v in state_of(VARIABLES.of(reading)) if v.name not in given}


def read_move(
    reading: Reading, key: KeyPath, name: str, text: str, kind: str, others: Mapping[str, Shape]
) -> Formula:
    """A formula of the shape of the variable of the state that it moves."""
    shape = find_moved(reading, key, name).value_shape
    scope = reading.scope(kind, state_roles(reading), others, driven=("time",))
    return read_fitting(reading.source, key, text, scope, shape, name)


class _Actions:
    """The reading of the declared actions."""

    def __init__(self, reading: Reading) -> None:
        self.reading, self.source = reading, reading.source
        self.scalars = scalars_of(reading)
        self.state = _list_movable(reading)

    def symmetry(self, name: str, part: SymmetryPart) -> Symmetry:
        """One declared action."""
        key: KeyPath = ("symmetries", name)
        algebra = read_algebra(
            self.source, part.algebra, self.reading.name, self.scalars, (*key, "algebra")
        )
        form = part.form or ""
        if form and matrix_size(algebra.dimension, form) is None:
            raise misfit_form(self.source, (*key, "form"), algebra.dimension, form)
        element = part.vector or part.matrix or ""
        shapes = self._element(part, key, algebra) if element else {}
        if part.linear is not None:
            self._check_linear(key, part.linear, algebra)
        generators = {
            variable: self._read_generator(key, variable, text, shapes)
            for variable, text in (part.generators or {}).items()
        }
        scalar = {
            table: self._read_scalar((*key, table), getattr(part, table), shapes)
            for table in ("time", "map")
            if getattr(part, table) is not None
        }
        return Symmetry(
            name=name,
            place=self.source.place(key),
            algebra=algebra,
            element=element,
            as_matrix=part.matrix is not None,
            generators=generators,
            linear=tuple(part.linear or ()),
            time=scalar.get("time"),
            map=scalar.get("map"),
            side=part.side,
            form=form,
            unit=part.unit,
            doc=part.doc,
        )

    def _element(self, part: SymmetryPart, key: KeyPath, algebra: LieAlgebra) -> dict[str, Shape]:
        """The name of the generic element and those of its blocks, with their shapes."""
        way = "vector" if part.vector is not None else "matrix"
        name = getattr(part, way)
        names = {name, *(f"{name}_{block}" for block in algebra.blocks)}
        if not NAME.fullmatch(name) or names & (self.reading.owners.keys() | {"energy"}):
            problem = f"{name!a} cannot name an element of {algebra.name}"
            expected = "a name that nothing else has, such as 'xi'"
            raise self.source.fault((*key, way), problem, name, expected)
        if way == "vector":
            parts = {f"{name}_{block}": len(run) for block, run in algebra.blocks.items()}
            counts = {name: algebra.dimension, **parts}
            return {each: (count,) if count > 1 else () for each, count in counts.items()}
        self._check_matrices((*key, way), algebra)
        return {name: (size(algebra.matrices),) * 2}

    def _check_matrices(self, key: KeyPath, algebra: LieAlgebra) -> None:
        """The algebra has matrices, which its elements are, or which act on the state."""
        if not algebra.matrices:
            problem = f"{algebra.name} has no matrices"
            expected = "an algebra that is declared by matrices, or by name"
            hint = f"Write {'generators' if key[-1] == 'linear' else 'vector'} in its place."
            raise self.source.fault(key, problem, algebra.name, expected, hint)

    def _check_linear(self, key: KeyPath, names: Sequence[str], algebra: LieAlgebra) -> None:
        """The matrices fit the stacked components."""
        for place, name in enumerate(names):
            find_moved(self.reading, (*key, "linear", place), name)
        self._check_matrices((*key, "linear"), algebra)
        count = sum(len(self.state[name].components) for name in names)
        rows = size(algebra.matrices)
        if count != rows:
            raise self.source.fault(
                (*key, "linear"),
                f"{list_names(names)} have {count} components, and the matrices of {algebra.name} "
                f"have {rows} rows",
                count,
                f"variables with {rows} components together",
            )

    def _read_generator(
        self, key: KeyPath, name: str, text: str, shapes: Mapping[str, Shape]
    ) -> Formula:
        """How a variable moves under the element."""
        key = (*key, "generators", name)
        formula = read_move(self.reading, key, name, text, "a generator", shapes)
        return self._require_linear(key, formula, shapes)

    def _read_scalar(self, key: KeyPath, text: str, shapes: Mapping[str, Shape]) -> Formula:
        kind = f"a {key[-1]} of a symmetry"
        scope = self.reading.scope(kind, state_roles(self.reading), shapes, driven=("time",))
        return self._require_linear(key, self.reading.formula(key, text, scope), shapes)

    def _require_linear(self, key: KeyPath, formula: Formula, names: Iterable[str]) -> Formula:
        """The formula, if it is linear in the element."""
        element, *_ = names
        try:
            degree = degree_in(formula.tree, tuple(names))
            if degree not in (1, None):
                problem = f"the value is of degree {degree} in {element!r}"
                expected = f"a formula that is linear in {element}"
                raise ExpressionError(problem, 0, len(formula.text), element, expected)
        except ExpressionError as error:
            raise self.source.expression_fault(key, error) from None
        return formula


SYMMETRIES = Table[tuple[Symmetry, ...]](
    "symmetries",
    SymmetryPart,
    "symmetries by the names of their momentum maps",
    read_symmetries,
    many=True,
    names=name_each,
)


def emitted_shapes(entries: Iterable[Observable | Symmetry | Section]) -> dict[str, Shape]:
    """Shapes of the energy, of observables and momentum maps, and of their components."""
    named: dict[str, Shape] = {"energy": ()}
    for entry in entries:
        shape = entry.value_shape if isinstance(entry, Symmetry) else entry.shape
        named |= {**dict.fromkeys(entry.components, ()), entry.name: shape}
    return named


def shapes_in_claims(reading: Reading) -> Mapping[str, Shape]:
    """What claims about symmetries may name in addition to the state."""
    named = [each for each in OBSERVABLES.of(reading) if not each.follows]
    return emitted_shapes([*named, *SYMMETRIES.of(reading)])
