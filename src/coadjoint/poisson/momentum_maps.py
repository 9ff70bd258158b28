r"""Momentum maps: symmetries of a phase space and the functions that generate them.

.. math:: \{f, J^\xi\} = \xi_P(f), \qquad
          \{J^\xi, J^\eta\} = \pm J^{[\xi, \eta]} + \Sigma(\xi, \eta)

Comes in: a bracket and the vector field by which each basis vector of a Lie algebra acts, from the
left (+) or from the right (-). Goes out: a `MomentumMap` with every law that it should obey as
elements that must be zero, and the 2-cocycle Sigma by which it may fail to be equivariant.
Read next: `coadjoint.derive.symmetries`, which makes one of a spec.

Signs: the generators of a left action have commutators of operators opposite to those of the
algebra (`coadjoint.groups.vector_fields`), and ``{f, h} = X_h(f)``; the two signs cancel.

Source:
    Holm (2011), Geometric Mechanics II, sections 9.4.1 and 11.1 to 11.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.linear import Span
from coadjoint.groups.vector_fields import (
    VectorField,
    cotangent_lift,
    exterior_derivative,
    lie_derivative,
)
from coadjoint.poisson.structure import PoissonStructure

#: A position, its momentum and ``{q, p}``, which is 1 but for entries of symmetric matrices.
Pair = tuple[str, str, Element]


def action_defects(
    algebra: LieAlgebra, generators: Sequence[VectorField], sign: int
) -> list[Element]:
    """``[xi_P, eta_P] +- [xi, eta]_P``: whether the generators are those of an action.

    Args:
        algebra: What acts.
        generators: ``xi_P`` of each basis vector.
        sign: +1 for a left action, -1 for a right one.
    """
    defects: list[Element] = []
    for i, j in combinations(range(algebra.dimension), 2):
        result = lie_derivative(generators[i], generators[j])
        expected = _in_algebra(algebra, sign, i, j).items()
        for n, component in enumerate(result.components):
            moved = result.field.sum(c * generators[k].components[n] for k, c in expected)
            defects.append(component + moved)
    return defects


def _in_algebra(algebra: LieAlgebra, sign: int, i: int, j: int) -> dict[int, Any]:
    """``+-[e_i, e_j]`` by basis vectors, the sign that of the side."""
    flip = sign if i < j else -sign
    row = algebra.constants.get((min(i, j), max(i, j)), {})
    return {k: flip * value for k, value in row.items()}


@dataclass(frozen=True)
class MomentumMap:
    """``J: P -> g*`` of an infinitesimal action, one component for each basis vector.

    Attributes:
        algebra: The Lie algebra g that acts.
        structure: The bracket of P.
        generators: ``xi_P`` of each basis vector, in the coordinates of the bracket.
        values: ``J^xi`` of each basis vector.
        sign: +1 for a left action, -1 for a right one.

    >>> from coadjoint.algebra import algebra_by_name
    >>> from coadjoint.poisson import canonical
    >>> field = Field(["x", "px", "y", "py"])
    >>> plane = canonical(field, [("x", "px"), ("y", "py")])
    >>> pairs = [("x", "px", field.one), ("y", "py", field.one)]
    >>> turn = {"x": -field["y"], "y": field["x"]}
    >>> field_of_turn = lift(plane, pairs, turn)
    >>> value = generating_function(plane, field_of_turn)
    >>> J = MomentumMap(algebra_by_name("so(2)"), plane, (field_of_turn,), (value,))
    >>> J.values, any(J.field_defects()), J.rates(field["x"] ** 2 + field["y"] ** 2)
    ((-px*y + py*x,), False, (0,))
    """

    algebra: LieAlgebra
    structure: PoissonStructure
    generators: tuple[VectorField, ...]
    values: tuple[Element, ...]
    sign: int = 1

    def __post_init__(self) -> None:
        counts = len(self.generators), len(self.values)
        if counts != (self.algebra.dimension,) * 2:
            raise AlgebraError(
                f"a momentum map for {self.algebra.name} is given {counts[0]} generators and "
                f"{counts[1]} values; expected {self.algebra.dimension} of each, one for each "
                "basis vector.",
                found=list(counts),
            )

    def _pairs(self) -> Iterator[tuple[int, int]]:
        return combinations(range(self.algebra.dimension), 2)

    def _along(self, i: int, j: int) -> Element:
        """``+-J^[e_i, e_j]``."""
        field, row = self.structure.field, _in_algebra(self.algebra, self.sign, i, j)
        return field.sum(c * self.values[k] for k, c in row.items())

    # -- laws, each as elements that must be zero ---------------------------------------

    def action_defects(self) -> list[Element]:
        """``[xi_P, eta_P] +- [xi, eta]_P``: whether the generators are those of an action."""
        return action_defects(self.algebra, self.generators, self.sign)

    def bracket_defects(self) -> list[Element]:
        """``xi_P{x_a, x_b} - {xi_P x_a, x_b} - {x_a, xi_P x_b}``: the flow keeps the bracket."""
        space, places = self.structure, range(self.structure.dimension)
        defects: list[Element] = []
        for X in self.generators:
            # row a of {xi_P x_a, x_b} at once; the third term is its transpose
            moved = [
                [-value for value in space.hamiltonian_vector_field(component)]
                for component in X.components
            ]
            defects += [
                X.derivative(space.tensor[a][b]) - moved[a][b] + moved[b][a]
                for a, b in combinations(places, 2)
            ]
        return defects

    def field_defects(self) -> list[Element]:
        """``{x_a, J^xi} - xi_P x_a``: whether J generates the action."""
        defects: list[Element] = []
        for X, value in zip(self.generators, self.values, strict=True):
            motion = self.structure.hamiltonian_vector_field(value)
            defects += [a - b for a, b in zip(motion, X.components, strict=True)]
        return defects

    @cached_property
    def cocycle(self) -> Mapping[tuple[int, int], Element]:
        """``Sigma(e_i, e_j) = {J_i, J_j} -+ J_[i, j]`` for i < j, where it is not zero."""
        field = self.structure.field
        result = {
            (i, j): field.normal(
                self.structure.bracket(self.values[i], self.values[j]) - self._along(i, j)
            )
            for i, j in self._pairs()
        }
        return {pair: value for pair, value in result.items() if value != 0}

    def constancy_defects(self) -> list[Element]:
        """``{x_a, Sigma}``: the cocycle is constant on each symplectic leaf."""
        return [
            defect
            for value in self.cocycle.values()
            for defect in self.structure.hamiltonian_vector_field(value)
        ]

    def cocycle_defects(self) -> list[Element]:
        """``Sigma([e_i, e_j], e_k) + cyclic``: the identity of a 2-cocycle."""
        field = self.structure.field

        def sigma(a: int, b: int) -> Element:
            value = self.cocycle.get((min(a, b), max(a, b)), field.zero)
            return value if a < b else -value

        return [
            field.sum(
                c * sigma(m, z)
                for x, y, z in ((i, j, k), (j, k, i), (k, i, j))
                for m, c in _in_algebra(self.algebra, self.sign, x, y).items()
            )
            for i, j, k in combinations(range(self.algebra.dimension), 3)
        ]

    def rates(self, h: Element) -> tuple[Element, ...]:
        """``xi_P h`` of each basis vector, in normal form; 0 where h is invariant."""
        field = self.structure.field
        return tuple(field.normal(X.derivative(h)) for X in self.generators)


# -- the map of an action -------------------------------------------------------------------------


def lift(
    structure: PoissonStructure, pairs: Sequence[Pair], generator: Mapping[str, Element]
) -> VectorField:
    """The cotangent lift of a vector field on positions: ``dp/ds = -(D xi_Q)^T p``.

    Args:
        structure: The canonical bracket, without magnetic terms.
        pairs: Positions and momenta; the covector that pairs with ``dq`` is ``p / {q, p}``.
        generator: The component of ``xi_Q`` along each position.
    """
    field, positions = structure.field, [q for q, _, _ in pairs]
    covector = [field[p] / weight for _, p, weight in pairs]
    moved = [field.zero + generator.get(q, 0) for q in positions]
    turned = cotangent_lift(field, moved, positions, covector)
    components = dict(zip(positions, moved, strict=True))
    for (_, p, weight), value in zip(pairs, turned, strict=True):
        components[p] = -value * weight
    return VectorField(field, structure.names, tuple(components[x] for x in structure.names))


def generating_function(structure: PoissonStructure, X: VectorField) -> Element:
    """J with ``X = {., J}`` and ``J(0) = 0``, for a polynomial X on a bracket of full rank.

    ``dJ`` solves ``tensor . dJ = X``, and ``J(x) = integral of x . dJ(s x) ds`` from 0 to 1.

    Raises:
        AlgebraError: There is no such function, or this method does not find it.

    >>> from coadjoint.poisson import canonical
    >>> field = Field(["q", "p"])
    >>> plane = canonical(field, [("q", "p")])
    >>> generating_function(plane, VectorField(field, ("q", "p"), (field["p"], -field["q"])))
    p**2/2 + q**2/2
    """
    field, names = structure.field, structure.names
    columns = [
        {i: row[j] for i, row in enumerate(structure.tensor) if row[j]} for j in range(len(names))
    ]
    span = Span(columns)
    result = span.coordinates({i: x for i, x in enumerate(X.components) if x})
    if span.dependent or result is None:
        raise AlgebraError(
            f"{structure.label}: the bracket is degenerate, so a generator does not say its "
            "momentum map; expected the map together with the generators.",
            found=len(span.dependent),
        )
    slopes = [field.zero + result.get(j, 0) for j in range(len(names))]
    if any(not field.is_zero(x) for row in exterior_derivative(field, names, slopes) for x in row):
        raise AlgebraError(
            f"{structure.label}: a generator does not preserve the bracket: no function "
            "generates it; expected a symmetry of the bracket.",
            found=str(X.components[0]),
        )
    return field.sum(
        field[name] * term / (_degree(field, term, names) + 1)
        for name, slope in zip(names, slopes, strict=True)
        for term in field.terms(slope)
    )


def _degree(field: Field, term: Element, names: Sequence[str]) -> int:
    """The degree of a single term in the coordinates."""
    (written,) = field.quotients(term)
    (monomial,) = written.monomials
    bottom = frozenset[str]().union(*(field.reach(divisor) for divisor, _ in written.divisors))
    if not field.is_function_free(term) or bottom & set(names):
        raise AlgebraError(
            f"the generator with {term} is not a polynomial of the coordinates; expected the "
            "momentum map together with it.",
            found=str(term),
        )
    return sum(power for name, power in monomial.powers if name in names)
