"""The spin chain as a lattice of bodies: its limit, its ring, and what it keeps."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coadjoint.systems import spin_chain, spin_chain_lattice

I, K = np.array([1.0, 2.0, 3.0]), np.array([3.0, 2.0, 1.0])  # noqa: E741
L = 10.0


def smooth_ring(N):
    """Attitudes R(s) = Rz(f) Rx(g) at N points of a circle, their strain and its slope.

    transpose(R) dR/ds is g' about x, and f' about z as seen after the turn about x.
    """
    w = 2 * np.pi / L
    s = np.arange(N) * L / N
    f, df, ddf = (x * 0.6 for x in (np.sin(w * s), w * np.cos(w * s), -(w**2) * np.sin(w * s)))
    g = 0.4 * np.cos(2 * w * s) + 0.3
    dg, ddg = -0.8 * w * np.sin(2 * w * s), -1.6 * w**2 * np.cos(2 * w * s)
    R = Rotation.from_euler("ZX", np.column_stack([f, g])).as_matrix()
    Xi = np.array([dg, df * np.sin(g), df * np.cos(g)])
    slope = [ddg, ddf * np.sin(g) + df * np.cos(g) * dg, ddf * np.cos(g) - df * np.sin(g) * dg]
    Pi = np.array([np.cos(w * s), np.sin(w * s) / 2, 1 + 0 * s])
    return R, Pi, Xi, np.array(slope)


def state_of(R, Pi):
    """Components of attitudes by rows, then those of momenta; members fastest."""
    return np.concatenate([R.transpose(1, 2, 0).reshape(9, -1), Pi]).ravel()


def lattice(N):
    """So many bodies."""
    return spin_chain_lattice.system.resize({"i": N})


def error_of(N):
    """How far rates of momenta are from Pi x Omega + K Xi_s + Xi x K Xi (Holm, chapter 10)."""
    R, Pi, Xi, slope = smooth_ring(N)
    found = lattice(N).rhs(state_of(R, Pi), [*I, *K, L / N], target="numpy").reshape(12, N)
    stress = K[:, None] * Xi
    expected = np.cross(Pi.T, (Pi / I[:, None]).T) + np.cross(Xi.T, stress.T)
    return np.abs(found[9:] - expected.T - K[:, None] * slope).max()


def test_rates_tend_to_those_of_the_chain():
    """With order 2 in the distance of bodies."""
    errors = [error_of(N) for N in (32, 64, 128)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 1e-2
    np.testing.assert_allclose(orders[-1], 2, atol=0.1)


def test_motions_tend_to_those_of_the_chain():
    """Momenta after a time, of the chain by Fourier derivatives, with order 2."""
    chain = spin_chain.system.resize({"s": 64}).with_derivatives("fourier")
    _, Pi, Xi, _ = smooth_ring(64)
    given = {"I": I, "K": K, "L": L}
    whole = chain.simulate(np.vstack([Pi, Xi]).ravel(), (0, 1), parameters=given, samples=2)
    known = whole["Pi"][:, ::4, -1]
    errors = []
    for N in (16, 32, 64):
        R, Pi, _, _ = smooth_ring(N)
        options = {"method": "dop853", "target": "numpy", "samples": 2, "rtol": 1e-8}
        found = lattice(N).simulate(
            state_of(R, Pi), (0, 1), parameters={"I": I, "K": K, "a": L / N}, **options
        )
        errors.append(np.abs(found["Pi"][:, :: N // 16, -1] - known).max())
    np.testing.assert_allclose(np.log2(errors[1] / errors[2]), 2, atol=0.2)


def test_the_total_angular_momentum_is_kept():
    """By a method without structure as far as it is accurate; that of another sign is not."""
    R, Pi, _, _ = smooth_ring(16)
    options = {"method": "dop853", "target": "numpy", "samples": 5, "rtol": 1e-11, "atol": 1e-12}
    found = lattice(16).simulate(
        state_of(R, Pi), (0, 2), parameters={"I": I, "K": K, "a": L / 16}, **options
    )
    assert np.abs(found.drift["J"]).max() < 1e-9
    assert np.abs(found.drift["energy"]).max() < 1e-9
    body = found["Pi"].sum(axis=1)
    assert np.ptp(body, axis=-1).max() > 1e-2


@pytest.mark.parametrize("order", ["R", "transposed"])
def test_the_ring_closes_exactly(order):
    """The product of all turns to the next body is 1 to rounding, in their order alone."""
    R, Pi, _, _ = smooth_ring(16)
    options = {"method": "dop853", "target": "numpy", "samples": 2}
    found = lattice(16).simulate(
        state_of(R, Pi), (0, 1), parameters={"I": I, "K": K, "a": L / 16}, **options
    )
    frames = np.moveaxis(found["R"][..., -1], 2, 0)
    turns = [a.T @ b for a, b in zip(frames, np.roll(frames, -1, axis=0), strict=True)]
    whole = np.linalg.multi_dot(turns if order == "R" else turns[::-1])
    assert (np.abs(whole - np.eye(3)).max() < 1e-12) == (order == "R")
