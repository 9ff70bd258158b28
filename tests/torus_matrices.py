"""Fluids on the torus by matrices, in NumPy: nothing here is from coadjoint.

Clock and shift matrices of N rows, N odd, as Zeitlin (Physica D 49 (1991) 353) has them, and the
Laplacian by traces with the matrices of waves.
"""

from itertools import product

import numpy as np


def wave(k1, k2, n):
    """``T_k = exp(2 pi i k1 k2/n) g^k1 h^k2``, by powers of the clock and the shift."""
    clock = np.diag(np.exp(4j * np.pi * np.arange(n) / n))
    shift = np.roll(np.eye(n), 1, axis=1)
    powers = (np.linalg.matrix_power(each, k % n) for each, k in ((clock, k1), (shift, k2)))
    return np.exp(2j * np.pi * k1 * k2 / n) * np.matmul(*powers)


def waves(n):
    """Numbers of waves, from -(n - 1)/2 to (n - 1)/2."""
    most = (n - 1) // 2
    return list(product(range(-most, most + 1), repeat=2))


def find_parts(W):
    """``w_k`` of ``W = i sum w_k T_k``, by traces."""
    n = len(W)
    return {k: np.trace(wave(*k, n).conj().T @ W) / (1j * n) for k in waves(n)}


def add_waves(parts, n):
    """The matrix ``i sum w_k T_k``."""
    return 1j * sum(part * wave(*k, n) for k, part in parts.items())


def find_velocity(W):
    """V with ``4 pi |k|^2 v_k = n w_k``."""
    n = len(W)
    parts = {k: w / (k[0] ** 2 + k[1] ** 2) for k, w in find_parts(W).items() if k != (0, 0)}
    return n / (4 * np.pi) * add_waves(parts, n)


def sample(terms, n):
    """The matrix of a sum of cosines and sines: ``{(k1, k2): (c, s)}``."""
    parts = {}
    for (k1, k2), (c, s) in terms.items():
        parts[k1, k2] = parts.get((k1, k2), 0) + (c - 1j * s) / 2
        parts[-k1, -k2] = parts.get((-k1, -k2), 0) + (c + 1j * s) / 2
    return add_waves(parts, n)
