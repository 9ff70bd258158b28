"""Forms: whether a block of an algebra has the matrices that a declared form means.

Comes in: the algebra, the block and the form. Goes out: nothing, or a `SpecError`.
Read next: `coadjoint.spec.sections.variables`.
"""

from __future__ import annotations

from coadjoint.algebra.families import so_indefinite
from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.matrices import size
from coadjoint.spec.core.components import matrix_size
from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source


def check_elements(
    source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...], form: str
) -> None:
    """The matrices of an algebra with a bracket of its own are of the form that is declared."""
    rows = matrix_size(len(block), form)
    sign = -1 if form == "antisymmetric" else 1
    for i in block:
        matrix = algebra.elements[i]
        turned = {(c, r): sign * value for (r, c), value in matrix.items()}
        if form == "matrix" or len(block) < algebra.dimension:
            turned = {}
        if size(algebra.elements) != rows or turned != dict(matrix):
            raise source.fault(
                key,
                f"the matrix of {algebra.basis[i]} is not of the form {form!r}",
                found=algebra.basis[i],
                expected=f"a basis of all {form} matrices with {rows} rows",
                hint="Remove form, or declare the algebra by such matrices.",
            )


def check_planes(source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...]) -> None:
    """Components above a diagonal go along E_12, E_13, ...: the planes of so(n) in their order.

    Along J1, J2, J3 = E_32, E_13, E_21 the equation dM/dt = [M, Omega] would have the other sign,
    and no invariant would show it.
    """
    size = matrix_size(len(block), "antisymmetric")
    assert size is not None, block
    place = {b: n for n, b in enumerate(block)}
    found: dict[tuple[int, int], dict[int | None, object]] = {}
    for (i, j), row in algebra.constants.items():
        if i in place and j in place:
            a, b = place[i], place[j]
            sign = 1 if a < b else -1
            found[min(a, b), max(a, b)] = {place.get(k): sign * c for k, c in row.items()}
    if size > 2 and found != dict(so_indefinite(size, 0).constants):
        names = listed(algebra.basis[b] for b in block)
        raise source.fault(
            key,
            f"the block {names} of {algebra.name} does not commute like the planes of so({size})",
            found=names,
            expected="a basis E12, E13, ... of matrices e_i e_j^T - e_j e_i^T for i < j",
            hint="Leave form out, and write hat(...) where a matrix is meant."
            if size == 3
            else "Leave form out, or declare the algebra by these matrices.",
        )
