"""Strands between two ends as they are called: standing waves, the energy, refusals."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.folders import load_texts
from coadjoint.solve.panels import list_panels
from coadjoint.solve.spectral import find_densities
from tests.derive.test_ends import spec_of

#: Inertia and stiffness about the third axis, and the length.
I3, K3, L = 3.0, 1.0, 10.0


@pytest.fixture(scope="module", params=[("free", 2), ("clamped", 4)], ids=str)
def strand(request):
    """The spin chain between ends, and their kind and order."""
    rendered = pipeline.render(spec_of(*request.param))
    with load_texts(dict(rendered.texts)) as system:
        yield (system, *request.param)


def standing_wave(ends, N, t):
    """Pi3 and Xi3 of an angle about the third axis, which obeys I3 phi_tt = K3 phi_ss."""
    s, k = np.arange(N) * L / (N - 1), 3 * np.pi / L
    w = k * np.sqrt(K3 / I3)
    if ends == "free":
        return -w * I3 * np.cos(k * s) * np.sin(w * t), -k * np.sin(k * s) * np.cos(w * t)
    return -w * I3 * np.sin(k * s) * np.sin(w * t), k * np.cos(k * s) * np.cos(w * t)


def test_waves_stand_between_ends(strand):
    """Errors fall with order 2, and with at least 3 by differences of order 4."""
    system, ends, order = strand
    errors = []
    for N in (33, 65):
        state = np.zeros((6, N))
        state[2], state[5] = standing_wave(ends, N, 0.0)
        options = {"method": "dop853", "target": "numpy", "samples": 2, "rtol": 1e-9}
        found = system.resize({"s": N}).simulate(state.ravel(), (0, 3), **options)
        Pi3, Xi3 = standing_wave(ends, N, 3.0)
        state = found.state[:, -1].reshape(6, N)
        errors.append(np.sqrt(np.mean((state[2] - Pi3) ** 2 + (state[5] - Xi3) ** 2)))
    assert errors[1] < 0.02
    assert np.log2(errors[0] / errors[1]) > {2: 1.9, 4: 3.0}[order]


def test_the_energy_has_a_density(strand):
    """Of rotation and of strain at each point; the sum of these, with halves at ends, is all."""
    system, _, order = strand
    start = np.random.default_rng(7).normal(size=(6, 33))
    options = {"method": "dop853", "target": "numpy", "samples": 3}
    found = system.resize({"s": 33}).simulate(start.ravel(), (0, 0.1), **options)
    inertia, stiffness = (np.array(each).reshape(3, 1, 1) for each in ([1, 2, 3], [3, 2, 1]))
    known = (found["Pi"] ** 2 / inertia + stiffness * found["Xi"] ** 2).sum(axis=0) / 2
    density = find_densities(found)["energy"]
    np.testing.assert_allclose(density, known, rtol=1e-13)
    assert [each.label for each in list_panels(found)][-1] == "energy\ndensity"
    if order == 2:
        weights = np.array([0.5, *[1.0] * 31, 0.5])[:, None] * L / 32
        np.testing.assert_allclose((weights * density).sum(axis=0), found["energy"], rtol=1e-13)
        assert np.abs(density.sum(axis=0) * L / 32 - found["energy"]).min() > 1e-3


def test_the_holonomy_turns_with_the_ends(strand):
    """About the third axis by phi(L) - phi(0): 2 cos(w t) between free ends, 0 between clamped."""
    system, ends, order = strand
    state = np.zeros((6, 65))
    state[2], state[5] = standing_wave(ends, 65, 0.0)
    options = {"method": "dop853", "target": "numpy", "samples": 4, "rtol": 1e-9}
    found = system.resize({"s": 65}).simulate(state.ravel(), (0, 3), **options)
    frames = found.frames()
    assert frames.shape == (3, 3, 65, 4)
    angle = np.arctan2(frames[1, 0, -1], frames[0, 0, -1])
    w = 3 * np.pi / L * np.sqrt(K3 / I3)
    known = -2 * np.cos(w * found.time) if ends == "free" else 0 * found.time
    np.testing.assert_allclose(angle, known, atol={2: 2e-2, 4: 1e-3}[order])
    with pytest.raises(KernelArgumentError, match=r"has ends.*frames\(\)\[:, :, -1\]"):
        found.traces()


def test_the_energy_is_kept_for_any_fields(strand):
    """Its rate is 0 at random fields; the midpoint keeps it to rounding."""
    system, _, _ = strand
    small, source = system.resize({"s": 24}), np.random.default_rng(0)
    state, step = source.normal(size=144), 1e-3
    rate = small.rhs(state, target="numpy")
    energies = [small.energy(state + x * step * rate, target="numpy") for x in (1, -1)]
    assert abs(energies[0] - energies[1]) < 1e-11 * energies[0]
    options = {"method": "midpoint", "step": 0.01, "target": "numpy", "samples": 2}
    found = small.simulate(state / 4, (0, 0.2), **options)
    assert np.abs(found.drift["energy"]).max() < 1e-13


def test_what_needs_a_circle_is_refused(strand):
    """Fourier derivatives, and group elements by Fourier series."""
    system, _, _ = strand
    with pytest.raises(KernelArgumentError, match="no fields along a circle"):
        system.with_derivatives("fourier")
    with pytest.raises(KernelArgumentError, match="at least"):
        system.resize({"s": 3})


def test_profiles_reach_both_ends(strand):
    """The last point is at s = L."""
    system, _, _ = strand
    Pi = np.reshape(system.STATE["Pi"].default, (3, -1))
    np.testing.assert_allclose(Pi[:, -1], [1, 0, 1], atol=1e-12)
