r"""The product B W B of the matrices of a momentum W and of a vector B.

In an algebra of matrices whose bracket is the commutator let all products :math:`B A B` lie in it
that have A and B in it, as on so(n), so(p,q), sp(2n) and se(n). Then Cayley's transform of B is in
its group, and steps by it stay on coadjoint orbits: the isospectral midpoint takes them. A momentum
is :math:`\mu_k = \mathrm{tr}(W E_k)` with a matrix W, of which nothing else is seen, and neither
is of :math:`B W B`, since :math:`\mathrm{tr}(B W B E_k) = \mathrm{tr}(W B E_k B)`. The step on
matrices W, which is that of gl(n) with an energy that sees :math:`\mu` alone, is a Poisson map, and
so is that on momenta.

Three more kinds of algebra have such products:

- symmetric matrices with the bracket :math:`X N Y - Y N X` of Bloch and Iserles, whose elements act
  as X N: there they are :math:`B N A N B`;
- so(n) with symmetric or antisymmetric matrices S that turn as :math:`S' = [S, \Omega]`, as of a
  body in a quadratic potential: its elements are pairs :math:`\Omega + \varepsilon A` with
  :math:`\varepsilon^2 = 0`, or blocks :math:`(\Omega, A; 0, \Omega)`;
- su(n) and sl(n), on which all B A B lie in the sum of the algebra and of multiples of one matrix Z
  that commutes with it. Energies do not depend on these, and with :math:`W + c Z` in place of W the
  step is that of the larger algebra. It begins and ends at c = 0, so that in its middle
  :math:`c\,\mathrm{tr}(Z Z) = \mathrm{tr}(B (W + c Z) B\, Z)`, B times half the length of the step.

Comes in: Equations. Goes out: Equations with the components of B W B in place of the rates.
Read next: `coadjoint.solve.methods.isospectral_midpoint`.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Final

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.matrices import (
    SparseMatrix,
    combination,
    commutator,
    convert_entries,
    product,
    shift,
    size,
    unit,
)
from coadjoint.algebra.planes import find_planes
from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting, once, vector_names
from coadjoint.derive.times_vector import times_vector
from coadjoint.exact import Field
from coadjoint.exact.ansatz import solve_exactly
from coadjoint.spec.core.components import kept_places

#: Components of a momentum up to which products are written out: those of so(8).
LARGEST: Final = 28
#: Pairs of random elements of which the product is asked whether it lies in the algebra, and whose
#: bracket whether it is the commutator. Both are polynomials of degree 3 at the most.
PAIRS: Final = 3


@dataclass(frozen=True)
class _Basis:
    """Matrices of an algebra, and what pairs with them.

    Attributes:
        matrices: The basis E.
        duals: Of each a matrix that has the trace 1 with it, and none with the others.
        middle: N of the bracket ``X N Y - Y N X``; empty for 1, of the commutator.
        outside: Z, of which products have multiples in addition; None where they have none.
    """

    matrices: tuple[SparseMatrix, ...]
    duals: tuple[SparseMatrix, ...]
    middle: SparseMatrix = field(default_factory=dict)
    outside: SparseMatrix | None = None

    def act(self, B: SparseMatrix) -> tuple[SparseMatrix, SparseMatrix]:
        """N B and B N."""
        return (product(self.middle, B), product(B, self.middle)) if self.middle else (B, B)


@once
def sandwich(equations: Equations) -> Equations | None:
    """``B(v) W(x) B(v)`` in place of the rates; None where the algebra has no such product.

    A sphere has a method of its own, so that so(3) is left out; and where all products are 0, as of
    Heisenberg's matrices, the method is the midpoint.
    """
    setting, algebra = equations.setting, equations.spec.algebra
    if algebra is None or not 2 < len(setting.state) <= LARGEST or setting.driving:
        return None
    if (len(setting.state) == 3 and _is_compact(algebra)) or times_vector(equations) is None:
        return None
    matrices = _list_matrices(equations)
    if len(matrices) != len(setting.state):
        return None
    basis = _find_products(equations, matrices)
    found = None if basis is None else _emit(equations, basis)
    return found if found is not None and any(found.exact.rates) else None


def _is_compact(algebra: LieAlgebra) -> bool:
    """Whether an algebra of three dimensions is so(3)."""
    constants = (value for row in algebra.constants.values() for value in row.values())
    known = all(isinstance(value, int | Fraction) for value in constants)
    return known and algebra.killing_signature() == (0, 3, 0)


def _list_matrices(equations: Equations) -> Sequence[SparseMatrix]:
    """What the components of the state pair with, as matrices; () where they are not known."""
    algebra, setting = equations.spec.algebra, equations.setting
    assert algebra is not None, equations.route
    own = algebra.elements if algebra.middle else algebra.matrices or find_planes(algebra)
    if setting.momenta == setting.state:
        return own
    advected, rows = equations.spec.having_role("advected"), size(own)
    if len(advected) != 1 or advected[0].matrix_size != rows:
        return ()
    (S,), half = advected, Fraction(1, 2)
    if setting.state != (*setting.momenta, *S.components):
        return ()
    other = half if S.form == "symmetric" else -half
    parts = [
        {(i, i): 1} if i == j else {(i, j): half, (j, i): other}
        for i, j in kept_places(rows, S.form)
    ]
    turns = [{**each, **shift(each, rows, rows)} for each in own]
    return [*turns, *(shift(each, 0, rows) for each in parts)]


def _find_duals(
    matrices: Sequence[SparseMatrix], candidates: Sequence[SparseMatrix]
) -> tuple[SparseMatrix, ...] | None:
    """The dual basis by the trace of products; None where there is none, or not of numbers."""
    numbers = [value for each in matrices for value in each.values()]
    if not all(isinstance(value, int | Fraction) for value in numbers):
        return None
    # Of traces times x = y, y first: where y may be anything, each x is a row of the inverse.
    count = len(matrices)
    rows = [
        {i: Fraction(-1)} | {count + j: _trace(a, b) for j, b in enumerate(candidates)}
        for i, a in enumerate(matrices)
    ]
    solved = sorted(solve_exactly(range(count + len(candidates)), rows), key=min)[:count]
    if [min(each) for each in solved] != list(range(count)):
        return None
    return tuple(
        combination((x, candidates[n - count]) for n, x in each.items() if n >= count)
        for each in solved
    )


def _trace(a: SparseMatrix, b: SparseMatrix) -> Any:
    """``tr(A B)``."""
    common = ((x, b[j, i]) for (i, j), x in a.items() if (j, i) in b)
    return sum((x * y for x, y in common), Fraction(0))


def _find_products(equations: Equations, matrices: Sequence[SparseMatrix]) -> _Basis | None:
    """The basis, where the bracket is that of the matrices up to a sign and has all products.

    Or all but for multiples of one matrix that commutes with it, where duals are in the algebra.
    """
    algebra = equations.spec.algebra
    assert algebra is not None, equations.route
    middle = convert_entries(algebra.middle, equations.setting.take_constant)
    places = sorted({(j, i) for each in matrices for i, j in each})
    duals = _find_duals(matrices, matrices)
    is_inside = duals is not None
    duals = duals or _find_duals(matrices, [unit(*place) for place in places])
    if duals is None:
        return None
    basis, source = _Basis(tuple(matrices), duals, middle), random.Random(1)  # noqa: S311
    signs, outside = {-1, 1}, None
    for _ in range(PAIRS):
        signs &= _find_signs(equations, basis, source)
        if not signs:
            return None
        at = {name: Fraction(source.randint(1, 99)) for name in equations.setting.parameters}
        own = replace(basis, middle=_put(equations, middle, at))
        A, B = (
            combination((Fraction(source.randint(-99, 99)), each) for each in matrices)
            for _ in range(2)
        )
        left, right = own.act(B)
        for inner in (A, outside) if outside else (A,):
            rest = _find_rest(product(product(right, inner), left), matrices, duals)
            outside = outside or rest
            if not _is_multiple(rest, outside):
                return None
    if not outside:
        return basis
    commutes = not any(commutator(outside, each) for each in matrices)
    is_seen = is_inside and bool(_trace(outside, outside))
    return replace(basis, outside=outside) if commutes and is_seen else None


def _put(equations: Equations, matrix: SparseMatrix, at: Mapping[str, Fraction]) -> SparseMatrix:
    """A matrix with numbers in the place of parameters."""
    own = equations.setting.field
    numbers = {name: own.number(value) for name, value in at.items()}
    return convert_entries(matrix, lambda value: own.as_number(own.substitute(value, numbers)))


def _find_signs(equations: Equations, basis: _Basis, source: random.Random) -> set[int]:
    """With which signs the bracket of random numbers is that of the matrices."""
    product_of, state = times_vector(equations), equations.setting.state
    assert product_of is not None, equations.route
    own, parameters = product_of.setting.field, equations.setting.parameters
    x, v = ([Fraction(source.randint(-99, 99)) for _ in state] for _ in range(2))
    at = {name: Fraction(source.randint(1, 99)) for name in parameters}
    known = at | dict(zip((*state, *vector_names(len(state))), (*x, *v), strict=True))
    numbers = {name: own.number(number) for name, number in known.items()}
    rows = [own.as_number(own.substitute(rate, numbers)) for rate in product_of.exact.rates]
    W = combination(zip(x, basis.duals, strict=True))
    B = combination(zip(v, basis.matrices, strict=True))
    left, right = replace(basis, middle=_put(equations, basis.middle, at)).act(B)
    turned = combination([(1, product(left, W)), (-1, product(W, right))])
    found = [_trace(turned, each) for each in basis.matrices]
    return {sign for sign in (-1, 1) if rows == [sign * each for each in found]}


def _find_rest(
    whole: SparseMatrix, matrices: Sequence[SparseMatrix], duals: Sequence[SparseMatrix]
) -> SparseMatrix:
    """What of a matrix is not in an algebra; where duals are in it, what is orthogonal to it."""
    parts = ((-_trace(whole, b), a) for a, b in zip(matrices, duals, strict=True))
    return combination([(1, whole), *parts])


def _is_multiple(rest: SparseMatrix, of: SparseMatrix) -> bool:
    """Whether a matrix is a multiple of another, 0 among them."""
    if not rest:
        return True
    place = next(iter(of))
    return not combination([(1, rest), (-Fraction(rest.get(place, 0)) / of[place], of)])


def _emit(equations: Equations, basis: _Basis) -> Equations:
    """The products, the entries of N B, B N and N B W by their names."""
    setting, n = equations.setting, size((*basis.matrices, *basis.duals))
    state, vector = setting.state, vector_names(len(setting.state))
    names = {
        word: [[f"_{word}{i + 1}_{j + 1}" for j in range(n)] for i in range(n)]
        for word in ("nb", "bn", "bw")
    }
    every = (name for table in names.values() for row in table for name in row)
    own = Field([*state, *vector, *setting.parameters, *every, "_bwz"])
    definitions = list[tuple[str, Any]]()

    def name_entries(word: str, matrix: SparseMatrix) -> dict[tuple[int, int], Any]:
        definitions.extend((names[word][i][j], matrix[i, j]) for i, j in sorted(matrix))
        return {(i, j): own[names[word][i][j]] for i, j in matrix}

    W = combination(zip(map(own.__getitem__, state), basis.duals, strict=True))
    B = combination(zip(map(own.__getitem__, vector), basis.matrices, strict=True))
    left = right = B
    if basis.middle:
        middle = convert_entries(basis.middle, own.adopt)
        NB, BN = replace(basis, middle=middle).act(B)
        left, right = name_entries("nb", NB), name_entries("bn", BN)
    whole = product(name_entries("bw", product(left, W)), right)
    rows = [own.zero + _trace(whole, each) for each in basis.matrices]
    if basis.outside is not None:
        turned = product(product(B, basis.outside), B)
        rest = _trace(basis.outside, basis.outside) - _trace(turned, basis.outside)
        definitions.append(("_bwz", _trace(whole, basis.outside) / rest))
        more = [_trace(turned, each) for each in basis.matrices]
        rows = [a + own["_bwz"] * b for a, b in zip(rows, more, strict=True)]
    exact = Exact(
        definitions=tuple(definitions),
        rates=tuple(rows),
        energy=None,
        emitted=(),
        poisson_tensor=None,
    )
    return replace(
        equations, setting=Setting(spec=equations.spec, field=own, values={}), exact=exact, steps=()
    )
