"""Matrix groups by name, each with its Lie algebra, its linear part and a field for its elements.

Comes in: a name as books write it, and what generic elements and vectors are called. Goes out: a
`MatrixGroup` whose field has a symbol for each of their coordinates.
Read next: `coadjoint.theory.actions`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from typing import Any

from coadjoint.algebra import LieAlgebra, algebra_by_name, from_matrices
from coadjoint.algebra.matrices import size
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import Matrix, diagonal, identity, weighted_sum
from coadjoint.theory.group import MatrixGroup
from coadjoint.theory.linear_part import InvertibleMatrices, Isometries, LinearPart

#: What a name stands for: the algebra, the linear part, and how many generators that has.
Parts = tuple[LieAlgebra, LinearPart, int]


def _isometries(algebra: LieAlgebra, count: int, form: Matrix, **more: Any) -> Parts:
    """A group whose first generators keep a form."""
    part = Isometries(
        size=len(form),
        symbols=algebra.basis[:count],
        generators=algebra.matrices[:count],
        form=form,
        **more,
    )
    return algebra, part, count


def _whole(algebra: LieAlgebra, form: Matrix, **more: Any) -> Parts:
    """A group of isometries and nothing else."""
    return _isometries(algebra, algebra.dimension, form, **more)


def _symplectic(n: int, size: int) -> Matrix:
    """``J = [[0, 1], [-1, 0]]`` on the first 2 n axes, 1 on the others."""
    upper = [{(k, k + n): 1, (k + n, k): -1} for k in range(n)]
    rest = [{(k, k): 1} for k in range(2 * n, size)]
    return weighted_sum([1] * (n + size - 2 * n), [*upper, *rest], size)


def _complex_structure(n: int) -> Matrix:
    """Multiplication by i of ``A + i B -> [[A, -B], [B, A]]``."""
    return weighted_sum([-1], [_sparse(_symplectic(n, 2 * n))], 2 * n)


def _sparse(matrix: Matrix) -> dict[tuple[int, int], Any]:
    return {(r, c): x for r, row in enumerate(matrix) for c, x in enumerate(row) if x}


def _so(n: int) -> Parts:
    return _whole(algebra_by_name(f"so({n})"), identity(n), special=True)


def _so_pq(p: int, q: int) -> Parts:
    algebra = algebra_by_name(f"so({p},{q})")  # first: it refuses sizes that would explode
    return _whole(algebra, diagonal([*[1] * p, *[-1] * q]), special=True)


def _sp(n: int) -> Parts:
    return _whole(algebra_by_name(f"sp({n})"), _symplectic(n // 2, n))


def _u(n: int) -> Parts:
    return _whole(algebra_by_name(f"u({n})"), identity(2 * n), structure=_complex_structure(n))


def _su(n: int) -> Parts:
    algebra = algebra_by_name(f"su({n})")
    first = diagonal([int(k % n == 0) for k in range(2 * n)])
    return _whole(
        algebra,
        identity(2 * n),
        structure=_complex_structure(n),
        special=True,
        column=first if n > 2 else (),  # det(1 - X) is real on su(2)
    )


def _sl(n: int) -> Parts:
    algebra = algebra_by_name(f"sl({n},R)")
    return algebra, InvertibleMatrices(n, n, special=True), algebra.dimension


def _gl(n: int) -> Parts:
    algebra = algebra_by_name(f"gl({n})")
    return algebra, InvertibleMatrices(n, n), algebra.dimension


def _se(n: int) -> Parts:
    return _rotating_group(algebra_by_name(f"se({n})"), n * (n - 1) // 2)


def _rotating_group(algebra: LieAlgebra, count: int = 3) -> Parts:
    """Rotations, which come first in the basis, and nilpotent generators."""
    return _isometries(algebra, count, identity(size(algebra.matrices)), special=True)


def _unipotent(algebra: LieAlgebra) -> Parts:
    """A nilpotent group: no linear part."""
    return _isometries(algebra, 0, identity(size(algebra.matrices)))


def _aff1() -> Parts:
    return algebra_by_name("aff(1)"), InvertibleMatrices(2, 1), 1


def _sl2_r2() -> Parts:
    """``[[A, v], [0, 1]]`` with det A = 1 (Holm 2011, section 6.5)."""
    sl2 = algebra_by_name("sl(2,R)")
    matrices = [*sl2.matrices, {(0, 2): 1}, {(1, 2): 1}]
    blocks = {"linear": (0, 1, 2), "translation": (3, 4)}
    algebra = from_matrices("sl(2,R) (s) R^2", (*sl2.basis, "P1", "P2"), matrices, blocks)
    return algebra, InvertibleMatrices(3, 2, special=True), 3


def _unit_quaternions() -> Parts:
    """Left multiplications by unit quaternions; they commute with all right multiplications."""
    by_i = weighted_sum([1, 1], [{(1, 0): 1, (0, 1): -1}, {(2, 3): 1, (3, 2): -1}], 4)
    by_j = weighted_sum([1, 1], [{(2, 0): 1, (0, 2): -1}, {(3, 1): 1, (1, 3): -1}], 4)
    return _whole(algebra_by_name("quaternions"), identity(4), structure=by_i, commuting=(by_j,))


#: Patterns of names with what they build, each with an example that messages show.
CATALOGUE: tuple[tuple[str, str, Callable[..., Parts]], ...] = (
    (r"SO\((\d+)\)", "SO(3)", _so),
    (r"SO\((\d+),(\d+)\)", "SO(2,1)", _so_pq),
    (r"SU\((\d+)\)", "SU(2)", _su),
    (r"U\((\d+)\)", "U(2)", _u),
    (r"SL\((\d+)(?:,R)?\)", "SL(2,R)", _sl),
    (r"GL\((\d+)(?:,R)?\)", "GL(2)", _gl),
    (r"Sp\((\d+)(?:,R)?\)", "Sp(4)", _sp),
    (r"SE\((\d+)\)", "SE(3)", _se),
    (r"H\((\d+)\)", "H(1)", lambda n: _unipotent(algebra_by_name(f"h({n})"))),
    (r"R\^(\d+)", "R^3", lambda n: _unipotent(algebra_by_name(f"R^{n}"))),
    (r"G\(3\)", "G(3)", lambda: _rotating_group(algebra_by_name("g(3)"))),
    (r"Bargmann", "Bargmann", lambda: _rotating_group(algebra_by_name("bargmann"))),
    (r"Aff\(1\)", "Aff(1)", _aff1),
    (r"SL\(2,R\)\(s\)R\^2", "SL(2,R)(s)R^2", _sl2_r2),
    (r"unitquaternions", "unit quaternions", _unit_quaternions),
    (
        r"unitcoquaternions",
        "unit coquaternions",
        lambda: _whole(algebra_by_name("coquaternions"), _symplectic(1, 2)),
    ),
)


def matrix_group(
    name: str,
    elements: Iterable[str] = (),
    vectors: Iterable[str] = (),
    more: Iterable[str] = (),
    slots: int = 0,
) -> MatrixGroup:
    """A matrix group by name, over a field with symbols for generic elements and vectors.

    Args:
        name: As books write it, spaces do not matter.
        elements: Prefixes of generic group elements; ``element(prefix)`` gives the matrix.
        vectors: Prefixes of generic vectors and covectors; ``vector(prefix)`` gives the components.
        more: Further symbols of the field.
        slots: How many elementary functions the field may adjoin.

    Raises:
        AlgebraError: No group of that name, or no such size; the message shows the nearest name.

    >>> SE2 = matrix_group("SE(2)", vectors=["xi", "mu"])
    >>> SE2.ad_star(SE2.vector("xi"), SE2.vector("mu"))
    (mu_P1*xi_P2 - mu_P2*xi_P1, mu_P2*xi_J, -mu_P1*xi_J)
    """
    algebra, linear, count = _parts(name)
    nilpotent = tuple(range(count, algebra.dimension))
    coordinates = (*linear.symbols, *(algebra.basis[i] for i in nilpotent))
    names = [f"{prefix}_{symbol}" for prefix in elements for symbol in coordinates]
    names += [f"{prefix}_{member}" for prefix in vectors for member in algebra.basis]
    return MatrixGroup(
        name=name,
        algebra=algebra,
        linear=linear,
        nilpotent=nilpotent,
        field=Field([*names, *more], slots),
    )


def _parts(name: str) -> Parts:
    """The algebra and linear part that a name stands for."""
    for pattern, _, build in CATALOGUE:
        match = re.fullmatch(pattern, name.replace(" ", ""))
        if match:
            return build(*map(int, match.groups()))
    examples = [example for _, example, _ in CATALOGUE]
    near = get_close_matches(name, examples, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else "Sizes may be others than those shown."
    raise AlgebraError(
        f"no group is called {name!r}; expected one like {', '.join(examples)}. {hint}", found=name
    )
