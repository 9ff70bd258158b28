r"""The product B W B of the matrices of a momentum W and of a vector B.

An algebra of antisymmetric matrices :math:`E_k`, orthogonal to one another, has the momentum
:math:`\mu` as the matrix W with :math:`\mu_k = \mathrm{tr}(W^T E_k)`, and the coadjoint action is a
commutator, :math:`\pm [B, W]`. Where B W B lies in the algebra for all B and W, as on so(n), steps
by Cayley's transform stay on coadjoint orbits: the isospectral midpoint takes them.
Comes in: Equations. Goes out: Equations with the components of B W B in place of the rates.
Read next: `coadjoint.solve.methods.isospectral_midpoint`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, Final

from coadjoint.algebra.matrices import SparseMatrix, size
from coadjoint.algebra.planes import find_planes
from coadjoint.derive.equations import Equations
from coadjoint.derive.records import Exact
from coadjoint.derive.setting import Setting, once, vector_names
from coadjoint.derive.times_vector import times_vector
from coadjoint.exact import Field

#: Components of a momentum up to which products are written out: those of so(8).
LARGEST: Final = 28
#: Pairs of random elements of which the product is asked whether it lies in the algebra, and whose
#: bracket whether it is the commutator. Both are polynomials of degree 3 at the most.
PAIRS: Final = 3


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
    if len(matrices) != len(setting.state) or not _are_orthogonal(matrices):
        return None
    if not _is_commutator(equations, matrices):
        return None
    return _emit(equations, matrices)


def _are_orthogonal(matrices: Sequence[SparseMatrix]) -> bool:
    """Whether matrices of numbers are antisymmetric, and orthogonal to one another."""
    numbers = (value for each in matrices for value in each.values())
    if not all(isinstance(value, int | Fraction) for value in numbers):
        return False
    turned = all(each.get((j, i), 0) == -x for each in matrices for (i, j), x in each.items())
    return turned and all(not _trace(a, b) for n, a in enumerate(matrices) for b in matrices[:n])


def _trace(a: SparseMatrix, b: SparseMatrix) -> Fraction:
    """``tr(A^T B)``."""
    return sum((Fraction(x) * b.get(place, 0) for place, x in a.items()), Fraction(0))


def _combine(parts: Sequence[Fraction], matrices: Sequence[SparseMatrix]) -> list[list[Fraction]]:
    """A combination of matrices."""
    n = size(matrices)
    found = [[Fraction(0)] * n for _ in range(n)]
    for part, each in zip(parts, matrices, strict=True):
        for (i, j), x in each.items():
            found[i][j] += part * x
    return found


def _multiply(a: list[list[Any]], b: list[list[Any]]) -> list[list[Any]]:
    columns = list(zip(*b, strict=True))
    return [[sum(x * y for x, y in zip(row, c, strict=True)) for c in columns] for row in a]


def _is_commutator(equations: Equations, matrices: Sequence[SparseMatrix]) -> bool:
    """Whether the bracket is ``[B, W]`` or ``[W, B]``, and ``B W B`` lies in the algebra."""
    own, source = times_vector(equations), random.Random(1)  # noqa: S311
    assert own is not None, equations.route
    field, state = own.setting.field, equations.setting.state
    squares = [_trace(each, each) for each in matrices]
    signs = {-1, 1}
    for _ in range(PAIRS):
        x, v = ([Fraction(source.randint(-99, 99)) for _ in state] for _ in range(2))
        W = _combine([a / b for a, b in zip(x, squares, strict=True)], matrices)
        B = _combine(v, matrices)
        both, other = _multiply(B, W), _multiply(W, B)
        turned = [
            [a - b for a, b in zip(*rows, strict=True)] for rows in zip(both, other, strict=True)
        ]
        known = dict(zip((*state, *vector_names(len(state))), (*x, *v), strict=True))
        at = {name: field.number(number) for name, number in known.items()}
        rows = [field.as_number(field.substitute(rate, at)) for rate in own.exact.rates]
        found = _measure(turned, matrices)
        signs &= {sign for sign in signs if rows == [sign * each for each in found]}
        product = _multiply(both, B)
        inside = [a / b for a, b in zip(_measure(product, matrices), squares, strict=True)]
        if not signs or _combine(inside, matrices) != product:
            return False
    return True


def _measure(matrix: list[list[Any]], matrices: Sequence[SparseMatrix]) -> list[Any]:
    """``tr(M^T E_k)`` for each k."""
    return [sum(matrix[i][j] * x for (i, j), x in each.items()) for each in matrices]


def _emit(equations: Equations, matrices: Sequence[SparseMatrix]) -> Equations:
    """The products, the entries of B W by their names."""
    setting, n = equations.setting, size(matrices)
    state, vector = setting.state, vector_names(len(setting.state))
    names = [[f"_bw{i + 1}_{j + 1}" for j in range(n)] for i in range(n)]
    field = Field([*state, *vector, *setting.parameters, *(x for row in names for x in row)])
    squares = [_trace(each, each) for each in matrices]

    def write(parts: Sequence[str], scale: Sequence[Fraction]) -> list[list[Any]]:
        found = [[field.zero] * n for _ in range(n)]
        for part, by, each in zip(parts, scale, matrices, strict=True):
            for (i, j), x in each.items():
                found[i][j] = found[i][j] + field[part] * (Fraction(x) / by)
        return found

    W, B = write(state, squares), write(vector, [Fraction(1)] * len(matrices))
    both = _multiply(B, W)
    named = [[field[name] for name in row] for row in names]
    product = _multiply(named, B)
    own = Exact(
        definitions=tuple(
            (names[i][j], both[i][j]) for i in range(n) for j in range(n) if both[i][j] != 0
        ),
        rates=tuple(_measure(product, matrices)),
        energy=None,
        emitted=(),
        poisson_tensor=None,
    )
    return replace(
        equations, setting=Setting(spec=equations.spec, field=field, values={}), exact=own, steps=()
    )
