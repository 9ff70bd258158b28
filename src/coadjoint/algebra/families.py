"""Families of named algebras by their matrices: the bases that books give them.

Comes in: a size. Goes out: a `LieAlgebra` that carries a faithful matrix for each basis vector. All
matrices are real; a complex one A + iB stands as ``[[A, -B], [B, A]]``.
Read next: `coadjoint.algebra.catalogue`, which calls these by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations, combinations_with_replacement, permutations, product

from coadjoint.algebra.lie_algebra import LieAlgebra, from_matrices
from coadjoint.algebra.matrices import Matrix, combination, realify, unit

Generators = Iterator[tuple[str, Matrix]]


def hat(axis: int) -> Matrix:
    """``hat(e_axis)_ij = -epsilon_ijk``, so that ``hat(a) b = a x b`` (Holm 2011, 2.1.1)."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return {(k, j): 1, (j, k): -1}


def label(letter: str, *indices: int) -> str:
    """``E12`` for the places 0 and 1; beyond nine the numbers are kept apart, ``E3_11``."""
    numbers = [str(index + 1) for index in indices]
    return letter + ("_" if max(indices) > 8 else "").join(numbers)


def _algebra(
    name: str, generators: Generators, blocks: Mapping[str, tuple[int, ...]] | None = None
) -> LieAlgebra:
    basis, matrices = zip(*generators, strict=True)
    return from_matrices(name, basis, matrices, blocks)


def _run(start: int, length: int) -> tuple[int, ...]:
    return tuple(range(start, start + length))


# -- rotations and motions ------------------------------------------------------------------------


def _rotations(n: int) -> Generators:
    """J1, J2, J3 in space; in other dimensions the planes ``E_ij``, i < j."""
    if n == 3:
        return ((f"J{axis + 1}", hat(axis)) for axis in range(3))
    planes = combinations(range(n), 2)
    return ((label("E", i, j), {(i, j): 1, (j, i): -1}) for i, j in planes)


def _columns(letter: str, n: int, column: int) -> Generators:
    """``e_i`` in one column next to an n x n block."""
    return ((f"{letter}{i + 1}", unit(i, column)) for i in range(n))


@cache
def so(n: int) -> LieAlgebra:
    """Rotations of R^n; in space ``[J_i, J_j] = epsilon_ijk J_k``."""
    return _algebra(f"so({n})", _rotations(n), {"rotation": _run(0, n * (n - 1) // 2)})


@cache
def so_indefinite(p: int, q: int) -> LieAlgebra:
    """``X^T K + K X = 0`` for K = diag(1, ..., 1, -1, ..., -1) with p and q entries."""
    planes = combinations(range(p + q), 2)
    generators = (
        (label("E", i, j), {(i, j): 1, (j, i): -1 if (i < p) == (j < p) else 1}) for i, j in planes
    )
    return _algebra(f"so({p},{q})", generators)


def se(n: int) -> LieAlgebra:
    """Rigid motions of R^n by matrices ``[[xi, alpha], [0, 0]]`` (Holm 2011, 1.6)."""
    # In the plane J turns e1 to e2, which is minus E_12.
    turning: Generators = iter([("J", {(0, 1): -1, (1, 0): 1})]) if n == 2 else _rotations(n)
    moves = [*turning, *_columns("P", n, n)]
    turns = len(moves) - n
    blocks = {"rotation": _run(0, turns), "translation": _run(turns, n)}
    return _algebra(f"se({n})", iter(moves), blocks)


def translations(n: int) -> LieAlgebra:
    """The abelian algebra of R^n, by affine matrices."""
    return _algebra(f"R^{n}", _columns("P", n, n), {"translation": _run(0, n)})


_GALILEAN_BLOCKS = {
    "rotation": (0, 1, 2),
    "boost": (3, 4, 5),
    "translation": (6, 7, 8),
    "time": (9,),
}


def galilei(_: int = 3) -> LieAlgebra:
    """``[[hat xi, nu, alpha], [0, 0, tau], [0, 0, 0]]``, so ``[K_i, E] = P_i`` (Holm 2011, 1.7)."""
    moves = [*_rotations(3), *_columns("K", 3, 3), *_columns("P", 3, 4), ("E", unit(3, 4))]
    return _algebra("g(3)", iter(moves), _GALILEAN_BLOCKS)


def bargmann(_: int = 3) -> LieAlgebra:
    """The central extension of g(3) by the mass, ``[K_i, P_j] = delta_ij M``.

    It acts on (x, t, s, 1), where s changes by ``v . x`` under a boost by v.
    """
    boosts = [(f"K{i + 1}", {(i, 3): 1, (4, i): 1}) for i in range(3)]
    moves = [*_rotations(3), *boosts, *_columns("P", 3, 5), ("E", unit(3, 5)), ("M", unit(4, 5))]
    return _algebra("bargmann", iter(moves), {**_GALILEAN_BLOCKS, "mass": (10,)})


# -- linear and symplectic ------------------------------------------------------------------------


def gl(n: int) -> LieAlgebra:
    """All matrices, ``E_ij`` row by row."""
    places = product(range(n), repeat=2)
    return _algebra(f"gl({n})", ((label("E", i, j), unit(i, j)) for i, j in places))


def sl(n: int) -> LieAlgebra:
    """Matrices of trace zero: ``H_k = E_kk - E_(k+1,k+1)``, then ``E_ij``; H, X, Y for n = 2."""
    diagonal = [(f"H{k + 1}", {(k, k): 1, (k + 1, k + 1): -1}) for k in range(n - 1)]
    others = [(label("E", i, j), unit(i, j)) for i, j in permutations(range(n), 2)]
    generators = [*diagonal, *others]
    if n == 2:
        generators = [(letter, m) for letter, (_, m) in zip("HXY", generators, strict=True)]
    return _algebra(f"sl({n},R)", iter(generators))


def sp(size: int) -> LieAlgebra:
    """``X^T J + J X = 0`` for ``J = [[0, 1], [-1, 0]]``: A_ij, then symmetric B_ij and C_ij."""
    n = size // 2

    def generators() -> Generators:
        for i, j in product(range(n), repeat=2):
            yield label("A", i, j), {(i, j): 1, (n + j, n + i): -1}
        for letter, row, column in (("B", 0, n), ("C", n, 0)):
            for i, j in combinations_with_replacement(range(n), 2):
                yield label(letter, i, j), {(row + i, column + j): 1, (row + j, column + i): 1}

    return _algebra(f"sp({size})", generators())


def heisenberg(n: int) -> LieAlgebra:
    """``[A_i, B_i] = C``, by matrices ``[[0, a, c], [0, 0, b], [0, 0, 0]]``."""
    a = [(f"A{i + 1}", unit(0, i + 1)) for i in range(n)]
    b = [(f"B{i + 1}", unit(i + 1, n + 1)) for i in range(n)]
    return _algebra(f"h({n})", iter([*a, *b, ("C", unit(0, n + 1))]))


def affine(_: int = 1) -> LieAlgebra:
    """Affine maps of the line: ``[e1, e2] = e2``."""
    return _algebra("aff(1)", iter([("e1", unit(0, 0)), ("e2", unit(0, 1))]))


# -- unitary and quaternions ----------------------------------------------------------------------


def _unitary(n: int, diagonal: Sequence[Matrix]) -> Generators:
    """Antisymmetric, then i times symmetric, then i times diagonal matrices."""
    pairs = list(combinations(range(n), 2))
    for i, j in pairs:
        yield label("A", i, j), realify({(i, j): 1, (j, i): -1}, {}, n)
    for i, j in pairs:
        yield label("S", i, j), realify({}, {(i, j): 1, (j, i): 1}, n)
    for k, matrix in enumerate(diagonal):
        yield f"D{k + 1}", realify({}, matrix, n)


def u(n: int) -> LieAlgebra:
    """``X* + X = 0`` for complex X."""
    return _algebra(f"u({n})", _unitary(n, [unit(k, k) for k in range(n)]))


def entries(n: int) -> LieAlgebra:
    """u(n) in a basis in which an element is a real matrix X, ``(X - X^T)/2 + i (X + X^T)/2``.

    It is orthonormal by minus the trace of products, so that momenta are entries as well.
    """
    return _algebra(f"entries({n})", _list_entries(n))


def _list_entries(n: int) -> Generators:
    half = Fraction(1, 2)
    for i, j in product(range(n), repeat=2):
        here, there = unit(i, j), unit(j, i)
        turned = combination([(half, here), (-half, there)])
        yield label("X", i, j), realify(turned, combination([(half, here), (half, there)]), n)


def su(n: int) -> LieAlgebra:
    """``X* + X = 0`` and trace zero; for n = 2, ``T_a = -(i/2) sigma_a``: [T1, T2] = T3, cyclic."""
    if n == 2:
        half = Fraction(1, 2)
        spin: list[tuple[Matrix, Matrix]] = [
            ({}, {(0, 1): -half, (1, 0): -half}),
            ({(0, 1): -half, (1, 0): half}, {}),
            ({}, {(0, 0): -half, (1, 1): half}),
        ]
        return _algebra("su(2)", ((f"T{k + 1}", realify(*spin[k], 2)) for k in range(3)))
    diagonal: list[Matrix] = [{(k, k): 1, (k + 1, k + 1): -1} for k in range(n - 1)]
    return _algebra(f"su({n})", _unitary(n, diagonal))


def quaternions(_: int = 0) -> LieAlgebra:
    """Imaginary quaternions by left multiplication of (1, i, j, k): ``[i, j] = 2 k``, cyclic."""
    units = ((letter, quaternion_unit(axis)) for axis, letter in enumerate("ijk"))
    return _algebra("quaternions", units)


def quaternion_unit(axis: int, side: int = 1) -> Matrix:
    """The product with i, j or k in the basis 1, i, j, k: from the left, or from the right (-1)."""
    j, k = 1 + (axis + 1) % 3, 1 + (axis + 2) % 3
    return {(1 + axis, 0): 1, (0, 1 + axis): -1, (k, j): side, (j, k): -side}


def coquaternions(_: int = 0) -> LieAlgebra:
    """Imaginary coquaternions: ``i^2 = -1``, ``j^2 = k^2 = 1``, ``ij = k = -ji``."""
    i: Matrix = {(0, 1): -1, (1, 0): 1}
    j: Matrix = {(0, 0): 1, (1, 1): -1}
    k: Matrix = {(0, 1): 1, (1, 0): 1}
    return _algebra("coquaternions", iter([("i", i), ("j", j), ("k", k)]))
