"""The Hopf map: its inverse up to a phase, and a numerical motion on the sphere."""

import numpy as np

from coadjoint.exact import Field
from coadjoint.exact.dense import apply, product, scale
from coadjoint.groups.complex_numbers import adjoint
from coadjoint.theory.hopf import amplitudes, coherence_matrix, hopf_map, reduced_motion


def test_the_amplitudes_come_back_up_to_a_phase():
    """Where two amplitudes have one Q, b (b*.a) = n0 a: b differs from a by a phase only."""
    field = Field(["q1", "q2", "p1", "p2"])
    a = amplitudes(field)
    Q, n0 = coherence_matrix(a), hopf_map(a)[0]
    assert apply(Q, a) == scale(n0, a)
    assert product(Q, Q) == tuple(scale(n0, row) for row in Q)
    assert adjoint(Q) == Q
    assert apply(Q, (a[1], a[0])) != scale(n0, (a[1], a[0]))


def moved(h, tau):
    """Poincare vector after a time tau of i a' = 2 dH/da*, H = h.n, by exact exponentials."""
    sigma = np.array([[[0, 1], [1, 0]], [[0, -1j], [1j, 0]], [[1, 0], [0, -1]]])
    values, vectors = np.linalg.eigh(np.tensordot(h, sigma, 1))
    a = np.array([0.3 + 0.4j, -0.7 + 0.1j])
    U = vectors @ np.diag(np.exp(-2j * tau * values)) @ vectors.conj().T
    return np.array([(U @ a).conj() @ s @ (U @ a) for s in sigma]).real


def test_reduced_motion_is_that_of_the_amplitudes():
    """The difference quotient of n along a' = -2i dH/da* is -4 n x h, and not 4 n x h."""
    h, step = np.array([0.2, -0.5, 0.9]), 1e-5
    slope = (moved(h, step) - moved(h, -step)) / (2 * step)
    rate = np.array(reduced_motion(moved(h, 0.0), h))
    # Central differences: step^2 times third derivatives of size 100, and rounding / step.
    assert np.abs(slope - rate).max() < 1e-7
    assert np.abs(slope + rate).max() > 1
