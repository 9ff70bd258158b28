"""Algebras: the Lie algebra that a spec declares, built from its parts, and representations of it.

Comes in: the validated table [algebra], which may hold further algebras, and the parameters that
its constants may depend on. Goes out: an exact `LieAlgebra` and the declared representations; or an
error with file, line, key and counterexample. Read next: `coadjoint.spec.sections.structure`.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any
from weakref import WeakKeyDictionary

from pydantic import BaseModel

from coadjoint.algebra import (
    LieAlgebra,
    Representation,
    algebra_by_name,
    central_extension,
    complexification,
    direct_sum,
    from_bracket,
    from_brackets,
    from_matrices,
    leibniz_extension,
    semidirect_product,
    semidirect_sum,
    subalgebra,
)
from coadjoint.errors import AlgebraError
from coadjoint.limits import STATE_COMPONENTS
from coadjoint.spec.core.coefficients import Scalars, read_coefficient, read_combination
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import HasComponents
from coadjoint.spec.core.pairs import read_pairs
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import BRACKET_PATTERN
from coadjoint.spec.sections.algebra_keys import (
    WAYS,
    ActionPart,
    AlgebraPart,
    ExtensionPart,
    LeibnizPart,
    OperandPart,
    SemidirectPart,
    SubalgebraPart,
)
from coadjoint.spec.sections.inputs import INPUTS
from coadjoint.spec.sections.matrices import (
    by_matrices,
    check_basis_names,
    places_of,
    point_at_faults,
    read_matrices,
    real_form,
    representation_of,
)
from coadjoint.spec.sections.matrix_brackets import read_bracket
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.time import TIME


@dataclass(frozen=True)
class Structure:
    """What the velocities are along.

    Attributes:
        algebra: Their Lie algebra; None without one.
        invariance: ``"left"`` (body, and without an algebra) or ``"right"`` (space).
    """

    algebra: LieAlgebra | None = None
    invariance: str = "left"


def read_structure(reading: Reading, part: AlgebraPart) -> Structure:
    """The Lie algebra of the velocities.

    Raises:
        SpecError, AlgebraError: As `read_algebra`.
    """
    algebra = read_algebra(reading.source, part, reading.name, scalars_of(reading))
    return Structure(algebra, part.invariance)


def scalars_of(reading: Reading) -> Scalars:
    """The parameters that constants may depend on, and what they may not name."""
    if reading not in _KNOWN:
        driving: list[HasComponents] = [*INPUTS.of(reading), *filter(None, [TIME.of(reading)])]
        file = weakref.ref(reading.file)
        _KNOWN[reading] = Scalars(PARAMETERS.of(reading), driving, lambda: _constants(file()))
    return _KNOWN[reading]


#: The scalars of each spec that is being read: all tables with constants share one field.
_KNOWN: WeakKeyDictionary[Reading, Scalars] = WeakKeyDictionary()


def _constants(part: Any) -> Iterator[str]:
    """The texts in the tables that declare algebras and their actions."""
    for key in ("algebra", "representations", "symmetries"):
        yield from _texts(getattr(part, key, None))


def _texts(part: Any) -> Iterator[str]:
    """The texts that may hold a number with a name, in a part or a nest of them."""
    match part:
        case str():
            if any(sign in part for sign in ("(", "pi", "^", "**")):
                yield part
        case Mapping():
            for value in part.values():
                yield from _texts(value)
        case list() | tuple():
            for value in part:
                yield from _texts(value)
        case BaseModel():
            for name in type(part).model_fields:
                yield from _texts(getattr(part, name))


def read_algebra(
    source: Source,
    part: AlgebraPart | OperandPart,
    system: str,
    scalars: Scalars | None = None,
    key: KeyPath = ("algebra",),
) -> LieAlgebra:
    """An algebra of a spec; one declared by brackets or matrices takes the system's name.

    Args:
        source: The text of the spec.
        part: The table, such as [algebra].
        system: Name of the system.
        scalars: The parameters that constants may depend on.
        key: Where the table stands.

    Raises:
        AlgebraError: What is declared makes no Lie algebra, or the name is unknown.
        SpecError: A name of the basis is unknown, or a matrix has the wrong size.
    """
    return _Algebras(source, system, scalars or Scalars()).algebra(part, key)


class _Algebras:
    """The building of one algebra from its parts, each at its key in the file."""

    def __init__(self, source: Source, system: str, scalars: Scalars) -> None:
        self.source, self.system, self.scalars = source, system, scalars

    def algebra(self, part: AlgebraPart | OperandPart, key: KeyPath) -> LieAlgebra:
        """The algebra of a table, or of a name in quotes."""
        (way,) = [way for way in WAYS if getattr(part, way) is not None]
        declared, inner = getattr(part, way), (*key, way)
        if way == "name":
            return self._find_by_name(declared, key)
        if way in ("brackets", "matrices"):
            basis = tuple(part.basis or {**declared, **(part.imaginary or {})})
            check_basis_names(self.source, (*key, "basis"), basis)
            algebra = (
                self._by_brackets(declared, inner, basis)
                if way == "brackets"
                else self._by_matrices(part, inner, basis)
            )
        else:
            algebra = getattr(self, f"_{way}")(declared, inner)
            self._check_single(algebra, inner)
        return self._add_blocks(algebra, part.blocks or {}, key)

    def _find_by_name(self, name: str, key: KeyPath) -> LieAlgebra:
        key = self.source.place_of(key, "name")
        with point_at_faults(self.source, key):
            return algebra_by_name(name, most=STATE_COMPONENTS)

    def _add_blocks(
        self, algebra: LieAlgebra, declared: Mapping[str, list[str]], key: KeyPath
    ) -> LieAlgebra:
        """The algebra with the declared blocks in addition to its own."""
        if not declared:
            return algebra
        blocks = {
            name: places_of(self.source, (*key, "blocks", name), names, algebra.basis)
            for name, names in declared.items()
        }
        return replace(algebra, blocks={**algebra.blocks, **blocks})

    # -- by brackets and by matrices ----------------------------------------------------

    def _by_brackets(
        self, texts: Mapping[str, str], key: KeyPath, basis: tuple[str, ...]
    ) -> LieAlgebra:
        brackets = {
            pair: read_combination(self.source, (*key, text), texts[text], basis, self.scalars)
            for pair, text in self._pairs(key, texts, basis).items()
        }
        with point_at_faults(self.source, key):
            return from_brackets(self.system, basis, brackets)

    def _pairs(
        self, key: KeyPath, texts: Iterable[str], basis: Sequence[str]
    ) -> dict[tuple[int, int], str]:
        """The keys ``[e1, e2]`` of a table by the places of their pairs."""
        return read_pairs(self.source, key, texts, BRACKET_PATTERN, basis, AlgebraError)

    def _by_matrices(
        self,
        part: AlgebraPart | OperandPart,
        key: KeyPath,
        basis: tuple[str, ...],
    ) -> LieAlgebra:
        tables, bracket = part.matrices or {}, part.bracket
        matrices, size = read_matrices(self.source, key, tables, basis, self.scalars)
        if part.imaginary is not None:
            inner = (*key[:-1], "imaginary")
            parts = read_matrices(self.source, inner, part.imaginary, basis, self.scalars)
            if parts[1] != size:
                problem = f"the imaginary parts have {parts[1]} rows"
                raise self.source.fault(inner, problem, str(parts[1]), f"{size}, as the real ones")
            matrices, size = real_form(matrices, parts[0], size), 2 * size
        for name in basis:
            if name not in matrices:
                problem = f"the matrix of {name!r} is missing"
                expected = f"a matrix for each of {list_names(basis)}"
                hint = f"Write {name} = [[...], [...]] among the matrices."
                raise self.source.fault(key, problem, name, expected, hint)
        chosen = [matrices[name] for name in basis]
        if bracket is None:
            with point_at_faults(self.source, key):
                return from_matrices(self.system, basis, chosen)
        inner = (*key[:-1], "bracket")
        of_two = read_bracket(self.source, inner, bracket, size, self.scalars)
        with point_at_faults(self.source, inner):
            return from_bracket(self.system, basis, chosen, of_two)

    # -- products -----------------------------------------------------------------------

    def _direct_sum(self, parts: Sequence[OperandPart], key: KeyPath) -> LieAlgebra:
        summands: list[LieAlgebra] = []
        for place, part in enumerate(parts):
            summands.append(self.algebra(part, (*key, place)))
            self._check_dimension(sum(summand.dimension for summand in summands), key)
        with point_at_faults(self.source, key):
            return direct_sum(summands)

    def _semidirect(self, part: SemidirectPart, key: KeyPath) -> LieAlgebra:
        acting = self.algebra(part.algebra, (*key, "algebra"))
        if part.ideal is not None and part.action is not None:
            ideal = self.algebra(part.ideal, (*key, "ideal"))
            self._check_dimension(acting.dimension + ideal.dimension, key)
            inner = (*key, "action")
            action = self._action(acting, part.action, inner, "action")
            with point_at_faults(self.source, inner):
                return semidirect_sum(acting, ideal, action)
        spaces: list[tuple[str, Representation]] = []
        for prefix, space in (part.representations or {}).items():
            inner = (*key, "representations", prefix)
            check_basis_names(self.source, inner, (prefix,))
            spaces.append((prefix, self._action(acting, space, inner, prefix)))
            self._check_dimension(acting.dimension + sum(s.dimension for _, s in spaces), key)
        with point_at_faults(self.source, key):
            return semidirect_product(acting, spaces)

    def _action(
        self, algebra: LieAlgebra, part: ActionPart, key: KeyPath, name: str
    ) -> Representation:
        """The representation of a name, or by matrices."""
        if part.name is not None:
            at = self.source.place_of(key, "name")
            return representation_of(self.source, at, algebra, part.name)
        inner = (*key, "matrices")
        return by_matrices(self.source, inner, algebra, name, part.matrices or {}, self.scalars)

    def _extension(self, part: ExtensionPart, key: KeyPath) -> LieAlgebra:
        algebra = self.algebra(part.algebra, (*key, "algebra"))
        check_basis_names(self.source, (*key, "center"), (part.center,))
        inner = (*key, "cocycle")
        cocycle = {
            pair: read_coefficient(self.source, (*inner, text), part.cocycle[text], self.scalars)
            for pair, text in self._pairs(inner, part.cocycle, algebra.basis).items()
        }
        with point_at_faults(self.source, inner):
            return central_extension(algebra, cocycle, part.center)

    def _leibniz(self, part: LeibnizPart, key: KeyPath) -> LieAlgebra:
        algebra = self.algebra(part.algebra, (*key, "algebra"))
        self._check_dimension(algebra.dimension * part.order, key)
        with point_at_faults(self.source, key):
            return leibniz_extension(algebra, part.order)

    def _complexification(self, part: OperandPart, key: KeyPath) -> LieAlgebra:
        algebra = self.algebra(part, key)
        self._check_dimension(2 * algebra.dimension, key)
        with point_at_faults(self.source, key):
            return complexification(algebra)

    def _subalgebra(self, part: SubalgebraPart, key: KeyPath) -> LieAlgebra:
        algebra, inner = self.algebra(part.algebra, (*key, "algebra")), (*key, "basis")
        vectors = {}
        for name, text in part.basis.items():
            check_basis_names(self.source, (*inner, name), (name,))
            coefficients = read_combination(
                self.source, (*inner, name), text, algebra.basis, self.scalars
            )
            places = range(algebra.dimension)
            vectors[name] = tuple(coefficients.get(place, Fraction(0)) for place in places)
        with point_at_faults(self.source, inner):
            return subalgebra(algebra, vectors)

    # -- what any product must be -------------------------------------------------------

    def _check_dimension(self, dimension: int, key: KeyPath) -> None:
        """Refuse a product that would be too large before it is built."""
        if dimension > STATE_COMPONENTS:
            problem = f"the algebra would have {dimension} dimensions"
            raise self.source.too_many(key, problem, dimension, "STATE_COMPONENTS")

    def _check_single(self, algebra: LieAlgebra, key: KeyPath) -> None:
        """Refuse a product whose parts bring one name twice."""
        for place, name in enumerate(algebra.basis):
            if name in algebra.basis[:place]:
                problem = f"the basis would have two vectors {name!r}"
                expected, hint = "names that differ", "Choose another name here."
                raise self.source.fault(key, problem, name, expected, hint)


ALGEBRA = Table[Structure](
    "algebra",
    AlgebraPart,
    "the Lie algebra of the velocities",
    read_structure,
    absent=Structure(),
    attribute=None,
)
