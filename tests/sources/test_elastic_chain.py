"""The chain of elastic rods moves by Newton and Euler's equations, typed by hand in space.

The bond from a piece to the next has the strain s = R^T (x' - x)/a - e3 and the energies
a s . C s/2 and, with the axes d_c of the two pieces, (K_a + K_b - K_c) (1 - d_c . d_c')/(2 a).
"""

import numpy as np
import pytest

from coadjoint.derive.indexed import derive_family
from coadjoint.lower.families import lower_family
from coadjoint.prove.declaration import family_context
from coadjoint.render.families import render_family
from coadjoint.solve.folders import load_texts
from tests.specs import emitted

#: Parameters in which no two numbers are equal.
NUMBERS = {
    "m": 1.3,
    "I1": 0.4,
    "I2": 0.7,
    "I3": 0.9,
    "a": 0.8,
    "C1": 20.0,
    "C2": 30.0,
    "C3": 50.0,
    "K1": 5.0,
    "K2": 6.0,
    "K3": 7.0,
}


@pytest.fixture(scope="module")
def chain():
    """The kernels in NumPy, from the texts that are rendered; claims are proved elsewhere."""
    equations = emitted("elastic_chain")
    family = derive_family(equations)
    texts = render_family(family_context(equations, family, lower_family(family)))
    with load_texts(texts) as system:
        yield system


def write_parameters(system):
    """The numbers as a System takes them."""
    return np.array([NUMBERS[name] for name in system.PARAMETERS.components])


def move(x, R, P, Pi):
    """Rates of place, attitude and momenta in body axes, of bodies one after the other."""
    m, a = NUMBERS["m"], NUMBERS["a"]
    inertia, C, K = (np.array([NUMBERS[f"{n}{c}"] for c in (1, 2, 3)]) for n in "ICK")
    force, torque = np.zeros_like(x), np.zeros_like(x)
    for i in range(len(x) - 1):
        step = x[i + 1] - x[i]
        pull = R[i] @ (C * (R[i].T @ step / a - [0, 0, 1]))
        force[i] += pull
        force[i + 1] -= pull
        torque[i] += np.cross(step, pull)
        for c in range(3):
            stiffness = (K.sum() - 2 * K[c]) / (2 * a)
            bend = stiffness * np.cross(R[i][:, c], R[i + 1][:, c])
            torque[i] += bend
            torque[i + 1] -= bend
    Omega = Pi / inertia
    hats = [np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]]) for a, b, c in Omega]
    return (
        np.array([r @ p for r, p in zip(R, P, strict=True)]) / m,
        np.array([r @ h for r, h in zip(R, hats, strict=True)]),
        np.cross(P, Omega) + np.array([r.T @ f for r, f in zip(R, force, strict=True)]),
        np.cross(Pi, Omega) + np.array([r.T @ t for r, t in zip(R, torque, strict=True)]),
    )


def pack(x, R, P, Pi):
    """Rows of the state: the entries of [R, x], then Pi and P, the member fastest."""
    poses = np.concatenate([R, x[:, :, None]], axis=2).reshape(len(x), 12)
    return np.concatenate([poses, Pi, P], axis=1).T.ravel()


def draw(source, count):
    """Bodies in general position."""
    R = np.array([np.linalg.qr(source.normal(size=(3, 3)))[0] for _ in range(count)])
    R *= np.linalg.det(R)[:, None, None]
    return (source.normal(size=(count, 3)), R, *source.normal(size=(2, count, 3)))


@pytest.mark.parametrize("count", [2, 3, 7])
def test_rates_are_those_of_newton_and_euler(chain, count):
    """Of two bodies, which have no neighbour on one side, and of more."""
    system, bodies = chain.resize({"i": count}), draw(np.random.default_rng(count), count)
    rates = system.rhs(pack(*bodies), write_parameters(system), target="numpy")
    np.testing.assert_allclose(rates, pack(*move(*bodies)), rtol=1e-12, atol=1e-11)


def test_wrong_forces_are_seen(chain, monkeypatch):
    """The comparison can fail: by a stiffness of the wrong axis."""
    bodies = draw(np.random.default_rng(0), 3)
    rates = chain.resize({"i": 3}).rhs(pack(*bodies), write_parameters(chain), target="numpy")
    monkeypatch.setitem(NUMBERS, "K1", NUMBERS["K2"])
    assert not np.allclose(rates, pack(*move(*bodies)), rtol=1e-3)


@pytest.mark.parametrize("mode", [1, 2, 5])
def test_a_straight_chain_stretches_at_the_rates_of_the_book(chain, mode):
    """Free masses and springs: omega = 2 sqrt(k/m) sin(mode pi/(2 N)), k = C3/a, cosines for shape.

    Along the axis the energy is quadratic, so that waves of any height move so.
    """
    count, height = 6, 0.2
    system = chain.resize({"i": count})
    a, k = NUMBERS["a"], NUMBERS["C3"] / NUMBERS["a"]
    omega = 2 * np.sqrt(k / NUMBERS["m"]) * np.sin(mode * np.pi / (2 * count))
    places = np.arange(count)
    shape = np.cos(mode * np.pi * (places + 0.5) / count)
    x = np.zeros((count, 3))
    x[:, 2] = a * places + height * shape
    at_rest = np.zeros((count, 3))
    start = pack(x, np.array([np.eye(3)] * count), at_rest, at_rest)
    end = 1.0
    run = system.simulate(
        start, (0, end), write_parameters(system), target="numpy", rtol=1e-11, samples=1
    )
    last = np.asarray(run.state)[:, -1].reshape(18, count)
    np.testing.assert_allclose(
        last[11], a * places + height * np.cos(omega * end) * shape, atol=1e-9
    )
    np.testing.assert_allclose(
        last[17], -NUMBERS["m"] * height * omega * np.sin(omega * end) * shape, atol=1e-8
    )


def test_a_run_keeps_momenta_and_rotations(chain):
    """Of a chain that is thrown and twisted: energy and momenta, and rotations to roundings."""
    system = chain
    start = [system.STATE.defaults[name] for name in system.STATE.components]
    run = system.simulate(start, (0, 3), target="numpy", rtol=1e-11, samples=3)
    state = np.asarray(run.state)
    kept = system.observables(state, target="numpy")
    assert len(kept) == 1 + 3 + 3
    np.testing.assert_allclose(kept, kept[:, :1] + np.zeros_like(kept), atol=1e-8)
    assert np.abs(system.constraint_residual(state, target="numpy")).max() < 1e-14
    assert np.abs(state[:, -1] - state[:, 0]).max() > 0.1
