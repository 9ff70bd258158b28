"""Fluids on the sphere by matrices, in NumPy: nothing here is from coadjoint.

Spin matrices of N rows, Hermitian matrices of harmonic polynomials by symmetrized products, and the
Laplacian of Hoppe and Yau (Communications in Mathematical Physics 195 (1998) 67).
"""

from functools import reduce
from itertools import permutations

import numpy as np
import sympy

#: Harmonic polynomials with their terms: a factor and its letters.
POLYNOMIALS = {
    "C1_0": [(1, "z")],
    "C1_1": [(1, "x")],
    "S1_1": [(1, "y")],
    "C2_0": [(2, "zz"), (-1, "xx"), (-1, "yy")],
    "C2_1": [(1, "xz")],
    "S2_1": [(1, "yz")],
    "C2_2": [(1, "xx"), (-1, "yy")],
    "S2_2": [(1, "xy")],
    "C3_0": [(2, "zzz"), (-3, "xxz"), (-3, "yyz")],
    "C3_1": [(4, "xzz"), (-1, "xxx"), (-1, "xyy")],
    "S3_1": [(4, "yzz"), (-1, "xxy"), (-1, "yyy")],
    "C3_2": [(1, "xxz"), (-1, "yyz")],
    "S3_2": [(1, "xyz")],
    "C3_3": [(1, "xxx"), (-3, "xyy")],
    "S3_3": [(3, "xxy"), (-1, "yyy")],
}


def spins(n):
    """``S_x, S_y, S_z`` with ``[S_x, S_y] = i S_z``."""
    rows = np.arange(n - 1)
    up = np.diag(np.sqrt((rows + 1) * (n - 1 - rows)), 1).astype(complex)
    return (up + up.T) / 2, (up - up.T) / 2j, np.diag((n - 1) / 2 - np.arange(n)).astype(complex)


def harmonic(name, n):
    """The Hermitian matrix of a harmonic with the mean square 1 over 4 pi."""
    spin = dict(zip("xyz", spins(n), strict=True))
    total = np.zeros((n, n), complex)
    for factor, letters in POLYNOMIALS[name]:
        orders = list(permutations(letters))
        products = [reduce(np.matmul, [spin[each] for each in order]) for order in orders]
        total += factor * sum(products) / len(orders)
    return total * np.sqrt(n / (4 * np.pi * np.trace(total @ total).real))


def quantize(polynomial, letters, n):
    """The Hermitian matrix of a polynomial in x, y and z by symmetrized products of ``hbar S``."""
    spin = [2 / np.sqrt(n**2 - 1) * each for each in spins(n)]
    total = np.zeros((n, n), complex)
    for powers, factor in sympy.Poly(polynomial, *letters).terms():
        word = [each for each, power in zip(spin, powers, strict=True) for _ in range(power)]
        products = [reduce(np.matmul, order) for order in permutations(word)]
        total += float(factor) * sum(products) / len(products)
    return total


def laplacian(P):
    """``-sum [S_a, [S_a, P]]``."""
    return -sum(s @ (s @ P - P @ s) - (s @ P - P @ s) @ s for s in spins(len(P)))


def find_stream(W):
    """P with ``laplacian(P) = W``, from the matrix of the Laplacian as a whole."""
    n, unit = len(W), np.eye(len(W))
    whole = np.zeros((n * n, n * n), complex)
    for s in spins(n):
        turn = np.kron(s, unit) - np.kron(unit, s.T)
        whole -= turn @ turn
    return (np.linalg.pinv(whole) @ W.ravel()).reshape(n, n)


def pack(W):
    """The real numbers that stand for a skew-Hermitian matrix."""
    return (W.real + W.imag).ravel()


def unpack(state):
    """The matrix that they stand for."""
    n = round(len(state) ** 0.5)
    X = state.reshape(n, n)
    return (X - X.T) / 2 + 1j * (X + X.T) / 2


def spectrum(state):
    """Eigenvalues of W over i, in order."""
    return np.linalg.eigvalsh(unpack(state) / 1j)
