"""Motions on the duals of Lie algebras, written by hand from matrices of these algebras."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from coadjoint.methods import TERMS
from coadjoint.solve.methods.lie_poisson import Bracket, LiePoisson
from coadjoint.solve.steps import Lanes

Matrix = Any


def _unit(size: int, *entries: tuple[int, int, float]) -> Matrix:
    matrix = np.zeros((size, size))
    for row, column, value in entries:
        matrix[row, column] = value
    return matrix


def so(n: int) -> list[Matrix]:
    """Matrices of the planes; of three dimensions those of the axes."""
    if n == 3:
        return [_unit(3, (k, j, 1), (j, k, -1)) for j, k in ((1, 2), (2, 0), (0, 1))]
    return [_unit(n, (i, j, 1), (j, i, -1)) for i, j in combinations(range(n), 2)]


def se(n: int) -> list[Matrix]:
    """Matrices of the rotations, then of the translations."""
    turns = [np.pad(each, ((0, 1), (0, 1))) for each in so(n)]
    return turns + [_unit(n + 1, (i, n, 1)) for i in range(n)]


def _join(*algebras: list[Matrix]) -> list[Matrix]:
    sizes = [len(each[0]) for each in algebras]
    joined = []
    for place, each in enumerate(algebras):
        start, size = sum(sizes[:place]), sum(sizes)
        for matrix in each:
            whole = np.zeros((size, size))
            whole[start : start + len(matrix), start : start + len(matrix)] = matrix
            joined.append(whole)
    return joined


#: Matrices of a basis by the name of the algebra.
ALGEBRAS: dict[str, list[Matrix]] = {
    "so(3)": so(3),
    "so(4)": so(4),
    "so(6)": so(6),
    "so(8)": so(8),
    "so(3) x so(3)": _join(so(3), so(3)),
    "se(2)": se(2),
    "se(3)": se(3),
    "sl(2)": [_unit(2, (0, 0, 1), (1, 1, -1)), _unit(2, (0, 1, 1)), _unit(2, (1, 0, 1))],
    "Heisenberg": [_unit(3, (0, 1, 1)), _unit(3, (1, 2, 1)), _unit(3, (0, 2, 1))],
    "aff(1)": [_unit(2, (0, 0, 1)), _unit(2, (0, 1, 1))],
    "sim(2)": [*se(2), _unit(3, (0, 0, 1), (1, 1, 1))],
    "so(3) with two vectors": [
        *(np.pad(each, ((0, 2), (0, 2))) for each in so(3)),
        *(_unit(5, (i, c, 1)) for c in (3, 4) for i in range(3)),
    ],
}


def find_constants(basis: list[Matrix]) -> Matrix:
    """``[e_i, e_j] = sum_k c[i, j, k] e_k``."""
    flat = np.array([each.ravel() for each in basis]).T
    products = [[a @ b - b @ a for b in basis] for a in basis]
    flats = np.array([[each.ravel() for each in row] for row in products])
    found = np.linalg.lstsq(flat, flats.reshape(-1, len(flat)).T, rcond=None)[0].T
    assert abs(found @ flat.T - flats.reshape(-1, len(flat))).max() < 1e-12
    return np.round(found.reshape(len(basis), len(basis), -1), 12)


@dataclass
class Motion:
    """A motion ``x' = J(x) dH``, ``J_ij = {x_i, x_j} = -c_ij^k x_k`` as for body axes.

    Attributes:
        constants: Of the algebra.
        energy: Of a state ``(n, N)``.
        gradient: Its derivative.
    """

    constants: Matrix
    energy: Callable[[Matrix], Matrix]
    gradient: Callable[[Matrix], Matrix]

    def tensor(self, x: Matrix) -> Matrix:
        """The brackets of the components."""
        return -np.tensordot(self.constants, x, axes=(2, 0))

    def bracket(self, lanes: Lanes, after: Matrix, x: Matrix, v: Matrix) -> Matrix:
        """The tensor times a vector."""
        return (self.tensor(x) * v[np.newaxis]).sum(axis=1)

    def slope(self, lanes: Lanes, after: Matrix, x: Matrix) -> Matrix:
        """The gradient, as methods ask for it."""
        return self.gradient(x)

    def rates(self, x: Matrix) -> Matrix:
        """The motion."""
        return (self.tensor(x) * self.gradient(x)[np.newaxis]).sum(axis=1)

    def field(self, lanes: Lanes, after: Matrix, x: Matrix) -> Matrix:
        """The motion, as methods ask for it."""
        return self.rates(x)


def make_motion(name: str, seed: int = 1, quadratic: bool = False) -> Motion:
    """A motion with the energy ``x.Qx/2 + sin(a.x)`` for a random positive Q and a random a."""
    rng = np.random.default_rng(seed)
    constants = find_constants(ALGEBRAS[name])
    n = len(constants)
    root = rng.normal(size=(n, n)) * 0.4
    q, a = root @ root.T + np.eye(n), rng.normal(size=n) * (0.0 if quadratic else 0.5)

    def energy(x: Matrix) -> Matrix:
        return 0.5 * (x * np.tensordot(q, x, 1)).sum(axis=0) + np.sin(np.tensordot(a, x, 1))

    def gradient(x: Matrix) -> Matrix:
        return np.tensordot(q, x, 1) + np.multiply.outer(a, np.cos(np.tensordot(a, x, 1)))

    return Motion(constants, energy, gradient)


def make_lanes(x: Matrix) -> Lanes:
    """Lanes at a state; the methods read nothing else of them here."""
    zeros = np.zeros(x.shape[1])
    whole = zeros.astype(np.uint64)
    return Lanes(
        state=x,
        time=zeros,
        end=zeros + np.inf,
        step=zeros,
        parameters=np.zeros(0),
        driving=np.zeros((0, x.shape[1])),
        slopes=np.zeros((0, x.shape[1])),
        member=whole,
        steps=whole,
    )


def make_memory(method: LiePoisson, x: Matrix) -> Matrix:
    """What a first step is told of those before it: nothing."""
    rows = len(x) * (1 + TERMS * len(method.stages))
    return np.zeros((rows, x.shape[1]), x.dtype)


def step(method: LiePoisson, x: Matrix, h: float) -> Matrix:
    """The state after one step; what rounding took is added, for numbers of more digits."""
    size = np.full(x.shape[1], h, dtype=x.dtype)
    end, memory, solved, _ = method.advance(make_lanes(x), size, x, make_memory(method, x))
    assert solved.all()
    return end + memory[: len(x)]


def run(method: LiePoisson, x: Matrix, h: float, count: int) -> Matrix:
    """The state after many steps, compensated."""
    memory, size = make_memory(method, x), np.full(x.shape[1], h)
    for _ in range(count):
        x, memory, solved, _ = method.advance(make_lanes(x), size, x, memory)
        assert solved.all()
    return x


def find_derivative(move: Callable[[Matrix], Matrix], x: Matrix) -> Matrix:
    """The Jacobian of a map at a state ``(n,)``, in long doubles."""
    n, d = len(x), np.longdouble(2.0**-8)
    points = np.array(
        [x + s * m * d * np.eye(n)[:, j] for m in range(1, 5) for s in (1, -1) for j in range(n)],
        dtype=np.longdouble,
    ).T
    ends = move(points).reshape(n, 4, 2, n)
    weights = [np.longdouble(4) / 5, -np.longdouble(1) / 5, np.longdouble(4) / 105]
    weights.append(-np.longdouble(1) / 280)
    return sum(w / d * (ends[:, m, 0] - ends[:, m, 1]) for m, w in enumerate(weights))


def find_defect(motion: Motion, move: Callable[[Matrix], Matrix], x: Matrix) -> float:
    """How far a map is from a Poisson map: ``max |D J(x) D^T - J(move(x))|``."""
    x = np.asarray(x, dtype=np.longdouble)
    d, end = find_derivative(move, x), move(x[:, np.newaxis])[:, 0]
    return float(abs(d @ motion.tensor(x) @ d.T - motion.tensor(end)).max())


def make_sandwich(name: str) -> Bracket:
    """``B W B`` in coordinates ``x_i = tr(W e_i)``, from matrices."""
    basis = np.array(ALGEBRAS[name])
    inverse = np.linalg.inv(np.einsum("iab,jba->ij", basis, basis))

    def sandwich(lanes: Lanes, after: Matrix, x: Matrix, v: Matrix) -> Matrix:
        w = np.einsum("il,iab->lab", inverse.astype(x.dtype) @ x, basis)
        b = np.einsum("il,iab->lab", v, basis)
        return np.einsum("lab,iba->il", b @ w @ b, basis)

    return sandwich
