"""A finite-dimensional Lie algebra as sparse exact structure constants, with ad and ad*.

Comes in: a bracket table or a basis of matrices. Goes out: an immutable `LieAlgebra` that has
passed the Jacobi identity, which is arithmetic on the constants and nothing else.
Read next: `coadjoint.algebra.representation`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import combinations, combinations_with_replacement, product
from types import MappingProxyType
from typing import Any

from coadjoint.algebra.invariants import Invariants
from coadjoint.algebra.matrices import (
    Matrix,
    SparseMatrix,
    combination,
    commutator,
    convert_entries,
    entries_text,
    size,
    take_image,
    unit,
)
from coadjoint.algebra.matrices import product as multiply
from coadjoint.errors import AlgebraError, LimitError
from coadjoint.exact.bilinear import sum_products
from coadjoint.exact.dense import total
from coadjoint.exact.linear import Span, exact
from coadjoint.limits import GENERATORS

__all__ = [
    "Constants",
    "LieAlgebra",
    "SparseMatrix",
    "check_size",
    "from_bracket",
    "from_brackets",
    "from_matrices",
    "multiply_constant",
    "same_constants",
    "wrong_commutators",
]

#: [e_i, e_j] = sum of value * e_k over the items k: value; pairs with i < j only, zeros left out.
#: Values are exact: `int` where integral (the fast case), `Fraction`, or elements of a field of
#: declared parameters.
Constants = Mapping[tuple[int, int], Mapping[int, Any]]


def multiply_constant(value: Any, factor: Any) -> Any:
    """``factor * value`` for values that know integers but not fractions, such as floats."""
    if isinstance(factor, int) and abs(factor) == 1:
        return value if factor == 1 else -value
    if not isinstance(factor, Fraction) or isinstance(value, int):
        return value * factor
    return value * factor.numerator / factor.denominator


def _sum(terms: Sequence[tuple[Any, Any, Any]]) -> Any:
    """The sum of ``c x y`` over terms ``(c, x, y)``, for values of any kind."""
    found = sum_products(terms)
    return total([multiply_constant(x * y, c) for c, x, y in terms]) if found is None else found


@dataclass(frozen=True)
class LieAlgebra(Invariants):
    """A Lie algebra with a basis: ``[e_i, e_j] = c_ij^k e_k``.

    Vectors of the algebra and covectors of its dual are plain sequences of ``dimension`` values of
    any kind that adds and multiplies. What depends on the constants alone (Killing form, center,
    series, rank) is in `coadjoint.algebra.invariants`.

    Attributes:
        name: As books write it, ``so(3)``, or the name of the spec that declared it.
        basis: Names of the basis vectors.
        constants: ``{(i, j): {k: c_ij^k}}`` for i < j, exact, zeros left out.
        blocks: Named runs of the basis, e.g. ``rotation`` and ``translation`` of se(3).
        matrices: A matrix for each basis vector where a matrix form is known, else empty.
        elements: The matrices that the basis vectors are, where the bracket is not their
            commutator; else empty.
        middle: The matrix N where it is ``X N Y - Y N X``; else empty.

    Raises:
        AlgebraError: The constants violate the Jacobi identity; the message names the triple.
    """

    name: str
    basis: tuple[str, ...]
    constants: Constants
    blocks: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    matrices: tuple[SparseMatrix, ...] = ()
    elements: tuple[SparseMatrix, ...] = ()
    middle: SparseMatrix = field(default_factory=dict)

    def __repr__(self) -> str:
        listed = ", ".join(self.basis[:8]) + ", ..." * (len(self.basis) > 8)
        return f"<LieAlgebra {self.name}: dimension {len(self.basis)}, basis {listed}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_algebra

        return show_algebra(self)

    def __post_init__(self) -> None:
        frozen = {
            pair: MappingProxyType({k: exact(c) for k, c in sorted(row.items()) if c != 0})
            for pair, row in sorted(self.constants.items())
        }
        kept = {pair: row for pair, row in frozen.items() if row}
        object.__setattr__(self, "constants", MappingProxyType(kept))
        object.__setattr__(self, "blocks", MappingProxyType(dict(self.blocks)))
        check_size(self.name, self.dimension)
        self.check_jacobi()

    def over(self, convert: Callable[[Any], Any]) -> LieAlgebra:
        """The algebra with every constant that holds parameters converted; rationals stay.

        It moves parameters and irrational numbers into another field, or puts numbers for them.
        """
        rows: list[Mapping[Any, Any]]
        rows = [*self.constants.values(), *self.matrices, *self.elements, self.middle]
        if all(isinstance(value, int | Fraction) for row in rows for value in row.values()):
            return self
        constants = {
            pair: MappingProxyType(image)
            for pair, row in self.constants.items()
            if (image := convert_entries(row, convert))
        }
        matrices = tuple(convert_entries(matrix, convert) for matrix in self.matrices)
        elements = tuple(convert_entries(matrix, convert) for matrix in self.elements)
        return take_image(
            self,
            constants=MappingProxyType(constants),
            matrices=matrices,
            elements=elements,
            middle=convert_entries(self.middle, convert),
        )

    def bracket(self, xi: Sequence[Any], eta: Sequence[Any]) -> tuple[Any, ...]:
        """``[xi, eta]^k = c_ij^k xi^i eta^j``."""
        result: list[Any] = [0] * self.dimension
        for i, j, k, c in self.structure():
            result[k] = result[k] + multiply_constant(xi[i] * eta[j], c)
        return tuple(result)

    def ad_star(self, xi: Sequence[Any], mu: Sequence[Any]) -> tuple[Any, ...]:
        """``<ad*_xi mu, eta> = <mu, [xi, eta]>``, so ``(ad*_xi mu)_j = c_ij^k xi^i mu_k``.

        On so(3) this is ``mu x xi`` (Holm 2011, section 5.1.3).
        """
        rows: list[list[tuple[Any, Any, Any]]] = [[] for _ in self.basis]
        for i, j, k, c in self.structure():
            rows[j].append((c, xi[i], mu[k]))
        return tuple(map(_sum, rows))

    # -- checks ---------------------------------------------------------------------------

    def jacobi_violation(self) -> tuple[tuple[int, int, int], dict[int, Any]] | None:
        """The first i < j < k with ``[e_i, [e_j, e_k]] + cyclic != 0`` and that sum, or None.

        Only brackets that are there are visited: the time goes with the nonzero constants, not with
        the cube of the dimension.
        """
        acting: list[list[tuple[int, int, Any]]] = [[] for _ in self.basis]
        for a, m, n, constant in self.structure():
            acting[m].append((a, n, constant))  # [e_a, e_m] = constant e_n + ...
        defects: dict[tuple[int, int, int, int], Any] = {}
        for (b, c), row in self.constants.items():
            for m, inner in row.items():
                for a, n, outer in acting[m]:
                    # A triple with two equal members satisfies the identity. Where a stands between
                    # b and c, the cyclic order has their bracket the other way round.
                    if a < b:
                        place, term = (a, b, c, n), inner * outer
                    elif a > c:
                        place, term = (b, c, a, n), inner * outer
                    elif b < a < c:
                        place, term = (b, a, c, n), -inner * outer
                    else:
                        continue
                    defects[place] = defects.get(place, 0) + term
        wrong = sorted(place for place, value in defects.items() if value != 0)
        if not wrong:
            return None
        i, j, k, _ = wrong[0]
        return (i, j, k), {at[3]: exact(defects[at]) for at in wrong if at[:3] == (i, j, k)}

    def check_jacobi(self) -> None:
        """Check that ``[e_i, [e_j, e_k]] + cyclic = 0`` for every triple.

        Raises:
            AlgebraError: It is not; the message names the first triple and the defect.
        """
        violation = self.jacobi_violation()
        if violation is None:
            return
        triple, defect = violation
        a, b, c = (self.basis[i] for i in triple)
        total = " + ".join(f"({value}) {self.basis[k]}" for k, value in sorted(defect.items()))
        raise AlgebraError(
            f"{self.name}: the brackets violate the Jacobi identity: "
            f"[{a}, [{b}, {c}]] + cyclic = {total}; expected 0. "
            f"Check the signs of the brackets between {a}, {b} and {c}.",
            triple=list(triple),
            defect=total,
        )

    def check_matrices(self) -> None:
        """Check that the matrices are independent and commute by the structure constants.

        Raises:
            AlgebraError: They do not, or there are none; the message names the pair at fault.
        """
        if len(self.matrices) != self.dimension:
            raise AlgebraError(
                f"{self.name} carries {len(self.matrices)} matrices; expected {self.dimension}. "
                "Declare the algebra by matrices.",
                found=len(self.matrices),
            )
        _independent(self.name, self.basis, self.matrices)
        for i, j, result, expected in wrong_commutators(self, self.matrices):
            pair = [self.basis[i], self.basis[j]]
            raise AlgebraError(
                f"{self.name}: the matrices of {pair[0]} and {pair[1]} have a commutator with the "
                f"entries {entries_text(result)}; expected {entries_text(expected)}. "
                f"Check [{pair[0]}, {pair[1]}].",
                pair=pair,
            )


def wrong_commutators(
    algebra: LieAlgebra, matrices: Sequence[SparseMatrix]
) -> Iterator[tuple[int, int, Matrix, Matrix]]:
    """Pairs of matrices that do not commute like the basis, their commutator, and the right one."""
    for i, j in combinations(range(algebra.dimension), 2):
        row = algebra.constants.get((i, j), {})
        expected = combination((c, matrices[k]) for k, c in row.items())
        result = commutator(matrices[i], matrices[j])
        if result != expected:
            yield i, j, result, expected


def check_size(name: str, generators: int, most: int = GENERATORS) -> None:
    """Refuse an algebra that would take too long, before it is built.

    Raises:
        LimitError: There are too many generators; the message says what they would cost.
    """
    if generators > most:
        pairs = generators * (generators - 1) // 2
        raise LimitError(
            f"{name} has {generators} generators and {pairs} brackets between them; expected at "
            f"most {most} generators (GENERATORS is {GENERATORS}). Take a smaller algebra.",
            found=generators,
            limit=most,
            brackets=pairs,
        )


def same_constants(a: LieAlgebra, b: LieAlgebra) -> bool:
    """Whether two algebras are equal up to the names of their bases."""
    return a.dimension == b.dimension and a.constants == b.constants


def from_brackets(
    name: str,
    basis: Sequence[str],
    brackets: Mapping[tuple[int, int], Mapping[int, Any]],
    blocks: Mapping[str, tuple[int, ...]] | None = None,
    matrices: tuple[SparseMatrix, ...] = (),
) -> LieAlgebra:
    """A Lie algebra from the brackets of its basis, each pair given once in either order.

    Args:
        name: Name for messages and documents.
        basis: Names of the basis vectors.
        brackets: ``{(i, j): {k: c_ij^k}}``; pairs left out commute.
        blocks: Named runs of the basis.
        matrices: A faithful matrix form, if there is one.

    Raises:
        AlgebraError: A pair is given twice or a bracket ``[e_i, e_i]`` is not zero, or the Jacobi
            identity fails.
    """
    constants: dict[tuple[int, int], dict[int, Any]] = {}
    for (i, j), row in brackets.items():
        if i == j:
            raise AlgebraError(
                f"{name}: [{basis[i]}, {basis[i]}] is declared; a bracket with itself is zero. "
                "Remove it.",
                pair=[basis[i], basis[j]],
            )
        pair, sign = ((i, j), 1) if i < j else ((j, i), -1)
        if pair in constants:
            raise AlgebraError(
                f"{name}: the bracket of {basis[i]} and {basis[j]} is declared twice; "
                "expected once, in either order.",
                pair=[basis[i], basis[j]],
            )
        constants[pair] = {k: sign * c for k, c in row.items()}
    return LieAlgebra(
        name=name, basis=tuple(basis), constants=constants, blocks=blocks or {}, matrices=matrices
    )


def from_matrices(
    name: str,
    basis: Sequence[str],
    matrices: Sequence[SparseMatrix],
    blocks: Mapping[str, tuple[int, ...]] | None = None,
) -> LieAlgebra:
    """The Lie algebra spanned by matrices under the commutator, by an exact linear solve.

    Raises:
        AlgebraError: The matrices are linearly dependent, or a commutator leaves their span.
    """
    span = _independent(name, basis, matrices)
    rows = [{row for row, _ in matrix} for matrix in matrices]
    columns = [{column for _, column in matrix} for matrix in matrices]
    brackets = {}
    for i, j in combinations(range(len(basis)), 2):
        if columns[i] & rows[j] or columns[j] & rows[i]:  # else both products are zero
            product = commutator(matrices[i], matrices[j])
            brackets[i, j] = _coordinates(name, span, (basis[i], basis[j]), product)
    return from_brackets(name, basis, brackets, blocks, tuple(dict(m) for m in matrices))


def from_bracket(
    name: str,
    basis: Sequence[str],
    elements: Sequence[SparseMatrix],
    bracket: Callable[[SparseMatrix, SparseMatrix], SparseMatrix],
) -> LieAlgebra:
    """The Lie algebra spanned by matrices under a bilinear bracket of matrices.

    Such as ``[X, Y] = X N Y - Y N X`` of symmetric X and Y with a fixed antisymmetric N (Bloch and
    Iserles 2006; Holm 2011, appendix C.4).

    Raises:
        AlgebraError: The matrices are linearly dependent, the bracket is not antisymmetric, leaves
            their span, or violates the Jacobi identity.

    >>> from coadjoint.algebra.matrices import commutator
    >>> turns = [{(1, 2): -1, (2, 1): 1}, {(0, 2): 1, (2, 0): -1}, {(0, 1): -1, (1, 0): 1}]
    >>> from_bracket("turns", ("J1", "J2", "J3"), turns, commutator).constants[0, 1]
    mappingproxy({2: 1})
    """
    span = _independent(name, basis, elements)
    brackets = {}
    for i, j in combinations_with_replacement(range(len(basis)), 2):
        product = dict(bracket(elements[i], elements[j]))
        if combination([(1, product), (1, bracket(elements[j], elements[i]))]):
            raise AlgebraError(
                f"{name}: [{basis[i]}, {basis[j]}] + [{basis[j]}, {basis[i]}] is not zero: "
                f"[{basis[i]}, {basis[j]}] has the entries {entries_text(product)}; expected an "
                "antisymmetric bracket. Subtract what it is with X and Y exchanged.",
                pair=[basis[i], basis[j]],
            )
        coordinates = _coordinates(name, span, (basis[i], basis[j]), product)
        if i < j:
            brackets[i, j] = coordinates
    made = from_brackets(name, basis, brackets)
    middle = _find_middle(elements, bracket)
    return replace(made, elements=tuple(dict(matrix) for matrix in elements), middle=middle)


def _find_middle(
    elements: Sequence[SparseMatrix],
    bracket: Callable[[SparseMatrix, SparseMatrix], SparseMatrix],
) -> SparseMatrix:
    """The N of a bracket ``X N Y - Y N X`` of these matrices; empty where it is another.

    Of X = e_r e_a^T and Y = e_b e_b^T the first product alone has the entry ``N_ab``, at (r, b).
    """
    count = size(elements)
    if count < 2:
        return {}
    middle = dict[tuple[int, int], Any]()
    for a, b in product(range(count), repeat=2):
        r = (b + 1) % count
        if value := bracket(unit(r, a), unit(b, b)).get((r, b)):
            middle[a, b] = value
    for X, Y in combinations(elements, 2):
        first, other = (multiply(multiply(one, middle), two) for one, two in ((X, Y), (Y, X)))
        if combination([(1, first), (-1, other), (-1, bracket(X, Y))]):
            return {}
    return middle


def _independent(name: str, basis: Sequence[str], matrices: Sequence[SparseMatrix]) -> Span:
    """The span of matrices that must be a basis of it."""
    span = Span(matrices)
    if span.dependent:
        redundant = [basis[n] for n in span.dependent]
        raise AlgebraError(
            f"{name}: the matrices of the basis are linearly dependent; expected a basis. "
            f"Remove {', '.join(redundant)}.",
            basis=list(basis),
            found=redundant,
        )
    return span


def _coordinates(
    name: str, span: Span, pair: tuple[str, str], product: SparseMatrix
) -> dict[int, Any]:
    """The coordinates of a bracket of two basis vectors."""
    coordinates = span.coordinates(product)
    if coordinates is None:
        raise AlgebraError(
            f"{name}: the bracket of {pair[0]} and {pair[1]} is not in the span of the basis; it "
            f"has the entries {entries_text(product)}. Add what is missing to the basis.",
            pair=list(pair),
        )
    return coordinates
