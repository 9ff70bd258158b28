r"""The Poisson structure: a bracket of functions given by an exact tensor.

.. math:: \{f, h\} = \partial_i f \, J_{ij} \, \partial_j h, \qquad J_{ij} = \{x_i, x_j\}

Comes in: a field and a tensor, mostly from `coadjoint.poisson.brackets`. Goes out: an immutable
`PoissonStructure` that brackets functions and proves its Jacobi identity.
Read next: `coadjoint.poisson.casimirs`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.ranks import generic_rank
from coadjoint.exact.witness import is_nonzero
from coadjoint.poisson.jacobi import Triple, schouten_bracket, slopes_by


@dataclass(frozen=True)
class PoissonStructure:
    """An antisymmetric tensor on named coordinates; `check_jacobi` says whether it is Poisson.

    Attributes:
        field: Where the elements live; coordinates and parameters are among its symbols.
        names: The coordinates ``x_1 ... x_n``.
        tensor: ``tensor[i][j] = {x_i, x_j}``.
        name: For messages, e.g. ``so(3)*``.

    Raises:
        AlgebraError: The tensor is not square or not antisymmetric; the message names the pair.

    >>> field = Field(["q", "p"])
    >>> plane = PoissonStructure(
    ...     field, ("q", "p"), ((field.zero, field.one), (-field.one, field.zero))
    ... )
    >>> plane.bracket(field["q"] ** 2, field["p"])
    2*q
    """

    field: Field
    names: tuple[str, ...]
    tensor: tuple[tuple[Element, ...], ...]
    name: str = ""

    def __post_init__(self) -> None:
        sizes = [len(row) for row in self.tensor]
        if sizes != [len(self.names)] * len(self.names):
            raise AlgebraError(
                f"{self.label}: the tensor has rows of {sizes} entries; expected one row and one "
                f"column for each of {', '.join(self.names)}.",
                found=sizes,
            )
        opposite = set()  # pairs of objects; a Lie-Poisson tensor repeats few objects often
        for i, row in enumerate(self.tensor):
            for j in range(i + 1):
                there, back = row[j], self.tensor[j][i]
                if (id(there), id(back)) in opposite:
                    continue
                if (there or back) and not self.field.is_zero(there + back):
                    a, b = self.names[i], self.names[j]
                    raise AlgebraError(
                        f"{self.label}: {{{a}, {b}}} = {element_text(self.field, there)} and "
                        f"{{{b}, {a}}} = {element_text(self.field, back)}; expected opposite "
                        "values.",
                        pair=[a, b],
                    )
                opposite.add((id(there), id(back)))

    @property
    def label(self) -> str:
        """What messages call the structure."""
        return self.name or f"bracket of {', '.join(self.names)}"

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.names)

    @cached_property
    def _rows(self) -> tuple[tuple[tuple[int, Element], ...], ...]:
        """The entries of each row that are there: most tensors are sparse."""
        return tuple(tuple((j, e) for j, e in enumerate(row) if e) for row in self.tensor)

    def gradient(self, f: Element) -> dict[int, Element]:
        """The derivatives of a function by the coordinates, zeros left out."""
        return dict(slopes_by(self.field, self.names)(f))

    def bracket(self, f: Element, h: Element) -> Element:
        """``{f, h}``."""
        df, dh = self.gradient(f), self.gradient(h)
        terms = [df[i] * self._along(i, dh) for i in df]
        return self.field.normal(sum(terms, self.field.zero))

    def hamiltonian_vector_field(self, h: Element) -> tuple[Element, ...]:
        """The motion ``dx_i/dt = {x_i, h}``."""
        dh = self.gradient(h)
        return tuple(self._along(i, dh) for i in range(self.dimension))

    def _along(self, i: int, slopes: Mapping[int, Element]) -> Element:
        """``J_ij d_j h``."""
        terms = [entry * slopes[j] for j, entry in self._rows[i] if j in slopes]
        return sum(terms[1:], terms[0]) if terms else self.field.zero

    # -- proofs -------------------------------------------------------------------------

    def jacobi_defects(self) -> dict[Triple, Element]:
        """``{x_i, {x_j, x_k}} + cyclic`` by triple i < j < k, where its normal form is not zero."""
        try:
            if self.lie_algebra is not None:
                return {}
        except AlgebraError:
            pass  # the identity fails; the expansion below names every triple
        defects = schouten_bracket(self.tensor, slopes_by(self.field, self.names))
        normal = {triple: self.field.normal(value) for triple, value in defects.items()}
        return {triple: value for triple, value in normal.items() if value != 0}

    def check_jacobi(self) -> None:
        """Prove the Jacobi identity.

        Raises:
            AlgebraError: It fails, or may; the message names the first triple and what is left.
        """
        for triple, defect in self.jacobi_defects().items():
            a, b, c = (self.names[i] for i in triple)
            text = element_text(self.field, defect)
            fails = "violates" if is_nonzero(self.field, defect) else "is not known to satisfy"
            raise AlgebraError(
                f"{self.label}: the bracket {fails} the Jacobi identity: "
                f"{{{a}, {{{b}, {c}}}}} + cyclic = {text}; expected 0. "
                f"Check the brackets between {a}, {b} and {c}.",
                triple=[a, b, c],
                defect=text,
            )

    def casimir_defects(self, f: Element) -> tuple[Element, ...]:
        """``{x_i, f}`` in normal form, one for each coordinate; all zero for a Casimir."""
        return tuple(map(self.field.normal, self.hamiltonian_vector_field(f)))

    def is_casimir(self, f: Element) -> bool:
        """Whether f commutes with every function: ``J grad f = 0``, by normal form."""
        slopes = self.gradient(f)
        return all(self.field.is_zero(self._along(i, slopes)) for i in self._tested_places)

    @cached_property
    def _tested_places(self) -> Sequence[int]:
        """Coordinates that generate the others where Jacobi is proved by constants; else all."""
        try:
            algebra = self.lie_algebra
        except AlgebraError:
            algebra = None
        if algebra is None or algebra.dimension > self.dimension:
            return range(self.dimension)
        rows = algebra.constants.items()
        single = {pair: next(iter(row)) for pair, row in rows if len(row) == 1}
        return find_generators(single, self.dimension)

    def generic_rank(self) -> int:
        """Rank of the tensor at almost every point: even, and the dimension of the leaves."""
        return generic_rank(self.field, [dict(row) for row in self._rows])

    # -- the algebra behind an affine tensor --------------------------------------------

    @cached_property
    def lie_algebra(self) -> LieAlgebra | None:
        """The algebra with ``[x_i, x_j] = J_ij``, if the tensor is affine in the coordinates.

        Constant terms stand with one more generator ``1`` that commutes with all, so that the
        Jacobi identity of the tensor is that of the algebra: arithmetic on numbers.

        Raises:
            AlgebraError: The tensor is affine and violates the Jacobi identity.
        """
        constants: dict[tuple[int, int], dict[int, Fraction | Element]] = {}
        read: dict[int, dict[int, Fraction | Element] | None] = {}  # by object: most are repeated
        for i, row in enumerate(self._rows):
            for j, entry in row:
                if i < j:
                    if id(entry) not in read:
                        read[id(entry)] = self._affine(entry)
                    result = read[id(entry)]
                    if result is None:
                        return None
                    constants[i, j] = result
        central = any(self.dimension in row for row in constants.values())
        basis = (*self.names, "1") if central else self.names
        return LieAlgebra(name=self.label, basis=basis, constants=constants)

    def _affine(self, entry: Element) -> dict[int, Fraction | Element] | None:
        """Coefficients of an entry by the place of their coordinate, the constant one last."""
        field, result, rest = self.field, {}, entry
        for m, slope in self.gradient(entry).items():
            rest = rest - slope * field[self.names[m]]
            result[m] = slope
        if rest:
            result[self.dimension] = rest
        if any(field.reach(value) & set(self.names) for value in result.values()):
            return None
        return {m: _number(field, value) for m, value in result.items()}

    # -- sums ---------------------------------------------------------------------------

    def __add__(self, other: object) -> PoissonStructure:
        if not isinstance(other, PoissonStructure):
            return NotImplemented
        return compatible_sum(self, other)


def compatible_sum(
    first: PoissonStructure, second: PoissonStructure, name: str = ""
) -> PoissonStructure:
    """The sum of two structures on the same coordinates, which is Poisson if they are compatible.

    Raises:
        AlgebraError: The coordinates differ, or the sum violates the Jacobi identity: then the two
            are not compatible, and the message names the triple and the defect.
    """
    if first.names != second.names or first.field is not second.field:
        raise AlgebraError(
            f"{first.label} has the coordinates {', '.join(first.names)} and {second.label} has "
            f"{', '.join(second.names)}; expected the same ones of the same field.",
            found=[list(first.names), list(second.names)],
        )
    rows = zip(first.tensor, second.tensor, strict=True)
    tensor = tuple(tuple(a + b if b else a for a, b in zip(*pair, strict=True)) for pair in rows)
    total = PoissonStructure(
        first.field, first.names, tensor, name or f"{first.label} + {second.label}"
    )
    total.check_jacobi()
    return total


def antisymmetric(
    field: Field, size: int, entries: Mapping[tuple[int, int], Element]
) -> tuple[tuple[Element, ...], ...]:
    """The tensor with given entries and their negatives; the others are one shared zero."""
    zero = field.zero
    rows = [[zero] * size for _ in range(size)]
    opposite = {id(entry): -entry for entry in entries.values()}  # one object for each object
    for (i, j), entry in entries.items():
        rows[i][j], rows[j][i] = entry, opposite[id(entry)]
    return tuple(map(tuple, rows))


def places(names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    """Where some coordinates stand.

    Raises:
        AlgebraError: One is not among the names.
    """
    unknown = [name for name in wanted if name not in names]
    if unknown:
        raise AlgebraError(
            f"{unknown[0]!r} is not a coordinate; expected one of {', '.join(names)}.",
            found=unknown[0],
        )
    return [names.index(name) for name in wanted]


def _number(field: Field, value: Element) -> Fraction | Element:
    """An element as a number where it is one."""
    number = field.as_number(value)
    return value if number is None else number


def find_generators(products: Mapping[tuple[int, int], int], size: int) -> list[int]:
    """The coordinates, in order, that the brackets of those before do not give.

    Only these need be asked whether they commute with a Casimir C: by the Jacobi identity
    ``{x_i, C} = {x_j, C} = 0`` gives ``{{x_i, x_j}, C} = 0``.

    Args:
        products: ``{(i, j): k}`` where ``{x_i, x_j}`` is a nonzero multiple of x_k.
        size: Number of coordinates.

    >>> find_generators({(0, 1): 2, (1, 2): 0, (0, 2): 1}, 4)
    [0, 1, 3]
    """
    partners: list[list[tuple[int, int]]] = [[] for _ in range(size)]
    for (i, j), k in products.items():
        partners[i].append((j, k))
        partners[j].append((i, k))
    reached: set[int] = set()
    kept = []
    for i in range(size):
        if i in reached:
            continue
        kept.append(i)
        waiting = [i]
        while waiting:
            new = waiting.pop()
            if new not in reached:
                reached.add(new)
                waiting += [k for j, k in partners[new] if j in reached]
    return kept
