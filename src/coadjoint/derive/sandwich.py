r"""The product B W B of the matrices of a momentum W and of a vector B.

An algebra of matrices :math:`E_k` on which :math:`\mathrm{tr}(A B)` is not degenerate has the
momentum :math:`\mu` as the one W in it with :math:`\mu_k = \mathrm{tr}(W E_k)`, and the coadjoint
action is a commutator, :math:`\pm [B, W]`. Where B W B lies in the algebra for all B and W, as on
so(n), so(p,q) and sp(2n), steps by Cayley's transform stay on coadjoint orbits: the isospectral
midpoint takes them.

On su(n) and sl(n) all B W B lie in the sum of the algebra and of multiples of one matrix Z that
commutes with it. Energies do not depend on these, and with :math:`W + c Z` in place of W the step
is that of the larger algebra. It begins and ends at c = 0, so that in its middle
:math:`c\,\mathrm{tr}(Z Z) = \mathrm{tr}(B (W + c Z) B\, Z)`, B times half the length of the step.
Comes in: Equations. Goes out: Equations with the components of B W B in place of the rates.
Read next: `coadjoint.solve.methods.isospectral_midpoint`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Final

from coadjoint.algebra.matrices import SparseMatrix, combination, commutator, product, size
from coadjoint.algebra.planes import find_planes
from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting, once, vector_names
from coadjoint.derive.times_vector import times_vector
from coadjoint.exact import Field
from coadjoint.exact.ansatz import solve_exactly

#: Components of a momentum up to which products are written out: those of so(8).
LARGEST: Final = 28
#: Pairs of random elements of which the product is asked whether it lies in the algebra, and whose
#: bracket whether it is the commutator. Both are polynomials of degree 3 at the most.
PAIRS: Final = 3


@dataclass(frozen=True)
class _Basis:
    """Matrices of an algebra, and what pairs with them.

    Attributes:
        matrices: The basis.
        duals: Of each the matrix of the algebra with which it alone has a trace, 1.
        outside: Z, of which products have multiples in addition; None where they have none.
    """

    matrices: tuple[SparseMatrix, ...]
    duals: tuple[SparseMatrix, ...]
    outside: SparseMatrix | None = None


@once
def sandwich(equations: Equations) -> Equations | None:
    """``B(v) W(x) B(v)`` in place of the rates; None where the algebra has no such product.

    A sphere has a method of its own, so that algebras of three dimensions are left out.
    """
    setting, algebra = equations.setting, equations.spec.algebra
    if algebra is None or not 3 < len(setting.state) <= LARGEST or setting.driving:
        return None
    if setting.momenta != setting.state or times_vector(equations) is None:
        return None
    matrices = algebra.matrices or find_planes(algebra)
    if len(matrices) != len(setting.state):
        return None
    basis = _find_products(equations, matrices)
    return None if basis is None else _emit(equations, basis)


def _find_duals(matrices: Sequence[SparseMatrix]) -> tuple[SparseMatrix, ...] | None:
    """The dual basis by the trace of products; None where that is degenerate, or not of numbers."""
    numbers = [value for each in matrices for value in each.values()]
    if not all(isinstance(value, int | Fraction) for value in numbers):
        return None
    # Of traces times x = y, y first: where y may be anything, each x is a row of the inverse.
    count = len(matrices)
    rows = [
        {i: Fraction(-1)} | {count + j: _trace(a, b) for j, b in enumerate(matrices)}
        for i, a in enumerate(matrices)
    ]
    solved = sorted(solve_exactly(range(2 * count), rows), key=min)
    if [min(each) for each in solved] != list(range(count)):
        return None
    return tuple(
        combination((x, matrices[n - count]) for n, x in each.items() if n >= count)
        for each in solved
    )


def _trace(a: SparseMatrix, b: SparseMatrix) -> Any:
    """``tr(A B)``."""
    common = ((x, b[j, i]) for (i, j), x in a.items() if (j, i) in b)
    return sum((x * y for x, y in common), Fraction(0))


def _find_products(equations: Equations, matrices: Sequence[SparseMatrix]) -> _Basis | None:
    """The basis, where the bracket is ``[B, W]`` or ``[W, B]`` and all ``B W B`` lie in it.

    Or in it and in multiples of one matrix that commutes with it.
    """
    own, source = times_vector(equations), random.Random(1)  # noqa: S311
    assert own is not None, equations.route
    field, state = own.setting.field, equations.setting.state
    duals = _find_duals(matrices)
    if duals is None:
        return None
    signs, outside = {-1, 1}, None
    for _ in range(PAIRS):
        x, v = ([Fraction(source.randint(-99, 99)) for _ in state] for _ in range(2))
        W, B = combination(zip(x, duals, strict=True)), combination(zip(v, matrices, strict=True))
        known = dict(zip((*state, *vector_names(len(state))), (*x, *v), strict=True))
        at = {name: field.number(number) for name, number in known.items()}
        rows = [field.as_number(field.substitute(rate, at)) for rate in own.exact.rates]
        turned = commutator(B, W)
        found = [_trace(turned, each) for each in matrices]
        signs &= {sign for sign in signs if rows == [sign * each for each in found]}
        if not signs:
            return None
        for middle in (W, outside) if outside else (W,):
            rest = _find_rest(product(product(B, middle), B), matrices, duals)
            outside = outside or rest
            if not _is_multiple(rest, outside):
                return None
    if not outside:
        return _Basis(tuple(matrices), duals)
    commutes = not any(commutator(outside, each) for each in matrices)
    is_seen = bool(_trace(outside, outside))
    return _Basis(tuple(matrices), duals, outside) if commutes and is_seen else None


def _find_rest(
    whole: SparseMatrix, matrices: Sequence[SparseMatrix], duals: Sequence[SparseMatrix]
) -> SparseMatrix:
    """What of a matrix is orthogonal to an algebra."""
    parts = ((-_trace(whole, a), b) for a, b in zip(matrices, duals, strict=True))
    return combination([(1, whole), *parts])


def _is_multiple(rest: SparseMatrix, of: SparseMatrix) -> bool:
    """Whether a matrix is a multiple of another, 0 among them."""
    if not rest:
        return True
    place = next(iter(of))
    return not combination([(1, rest), (-Fraction(rest.get(place, 0)) / of[place], of)])


def _emit(equations: Equations, basis: _Basis) -> Equations:
    """The products, the entries of B W by their names."""
    setting, n = equations.setting, size(basis.matrices)
    state, vector = setting.state, vector_names(len(setting.state))
    names = [[f"_bw{i + 1}_{j + 1}" for j in range(n)] for i in range(n)]
    field = Field(
        [*state, *vector, *setting.parameters, *(x for row in names for x in row), "_bwz"]
    )

    W = combination(zip(map(field.__getitem__, state), basis.duals, strict=True))
    B = combination(zip(map(field.__getitem__, vector), basis.matrices, strict=True))
    both = product(B, W)
    named = {(i, j): field[names[i][j]] for i, j in both}
    whole = product(named, B)
    rows = [_trace(whole, each) for each in basis.matrices]
    definitions = [(names[i][j], both[i, j]) for i, j in sorted(both)]
    if basis.outside is not None:
        turned = product(product(B, basis.outside), B)
        rest = _trace(basis.outside, basis.outside) - _trace(turned, basis.outside)
        definitions.append(("_bwz", _trace(whole, basis.outside) / rest))
        more = [_trace(turned, each) for each in basis.matrices]
        rows = [a + field["_bwz"] * b for a, b in zip(rows, more, strict=True)]
    own = Exact(
        definitions=tuple(definitions),
        rates=tuple(rows),
        energy=None,
        emitted=(),
        poisson_tensor=None,
    )
    return replace(
        equations, setting=Setting(spec=equations.spec, field=field, values={}), exact=own, steps=()
    )
