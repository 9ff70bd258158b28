"""A fluid on the sphere by matrices of any number of rows, against closed forms and plain NumPy."""

import pickle

import numpy as np
import pytest
import sympy

from coadjoint.errors import KernelArgumentError, ResourceError
from coadjoint.pipeline import render
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec_text
from coadjoint.systems import zeitlin_su_4, zeitlin_su_n
from tests.kernels import COMPILER
from tests.specs import shipped
from tests.truncated import (
    POLYNOMIALS,
    find_stream,
    harmonic,
    laplacian,
    pack,
    quantize,
    spectrum,
    spins,
    unpack,
)

FLUID = zeitlin_su_n.system
TARGET = "c" if COMPILER else "numpy"


def random_state(n, seed=0):
    """A skew-Hermitian matrix without a trace."""
    source = np.random.default_rng(seed)
    A = source.normal(size=(n, n)) + 1j * source.normal(size=(n, n))
    W = A - A.conj().T
    return pack(W - np.trace(W) / n * np.eye(n))


def check_casimirs(fluid, state, method, *, keeps, target):
    """Of 9 rows the spectrum stays to 1e-13 of its size, and so does tr W^k; or it does not."""
    n = 9
    motion = fluid.resize({"N": n}).simulate(
        state, (0, 2), step=0.1, method=method, samples=2, target=target
    )
    assert motion.status == "OK"
    before, after = spectrum(state), spectrum(motion.state[:, -1])
    change = np.abs(after - before).max() / np.abs(before).max()
    assert bool(change < 1e-13) is keeps, change
    for k in range(2, n + 1):
        one, other = (np.sum(x**k) for x in (before, after))
        assert not keeps or abs(one - other) < 1e-12 * np.sum(np.abs(before) ** k)
    assert np.abs(motion.state[:, -1] - state).max() > 0.1


@pytest.mark.parametrize("n", [2, 5, 8, 11])
def test_rates_are_those_of_zeitlins_equation(n):
    """``dW/dt = [P, W]/hbar``, the Laplacian of P being W; a wrong sign of P is seen."""
    system, state = FLUID.resize({"N": n}), random_state(n)
    W, hbar = unpack(state), 2 / np.sqrt(n**2 - 1)
    P = find_stream(W)
    np.testing.assert_allclose(laplacian(P), W, atol=1e-11)
    expected = pack((P @ W - W @ P) / hbar)
    found = system.rhs(state, [])
    np.testing.assert_allclose(found, expected, atol=1e-11 * n)
    assert np.abs(expected).max() > 0.1 or n == 2
    assert n == 2 or np.abs(found + expected).max() > 0.1
    energy = np.trace(P @ W).real / (2 * hbar)
    assert system.energy(state, []) == pytest.approx(energy, rel=1e-12)
    assert energy > 0


def turn(W, angle):
    """The vorticity turned about the axis z."""
    levels = np.diag(spins(len(W))[2])
    return np.exp(-1j * angle * levels)[:, None] * W * np.exp(1j * angle * levels)


def test_an_inertia_may_be_a_number_for_each_degree():
    """With 3 l (l + 1) the motion is that with hbar l (l + 1), hbar/3 times as fast."""
    text = shipped("zeitlin_su_n").path.read_text(encoding="utf-8")
    new = text.replace("2*l*(l + 1)/sqrt(N^2 - 1)", "3*l*(l + 1)")
    assert new != text
    state, slower = random_state(5), 2 / np.sqrt(24) / 3
    expected = slower * FLUID.resize({"N": 5}).rhs(state)
    with load_texts(render(read_spec_text(new, "fluid.toml")).texts) as system:
        for target in dict.fromkeys(("numpy", TARGET)):
            found = system.resize({"N": 5}).rhs(state, target=target)
            np.testing.assert_allclose(found, expected, atol=1e-13)


@pytest.mark.parametrize(("n", "name"), [(4, "C2_1"), (9, "S3_2"), (16, "C3_3"), (33, "S2_2")])
def test_waves_of_rossby_and_haurwitz_turn_about_the_axis(n, name):
    """``W = i (2 w hbar S_z + Y)``: Y of degree l turns by ``w (1 - 2/(l (l + 1))) t``.

    It is exact for every N; the wave goes on in the sense of w, and not against it.
    """
    w, time, hbar, degree = 0.7, 1.5, 2 / np.sqrt(n**2 - 1), int(name[1])
    W = 1j * (2 * w * hbar * spins(n)[2] + 0.4 * harmonic(name, n))
    motion = FLUID.resize({"N": n}).simulate(
        pack(W), (0, time), method="dop853", rtol=1e-12, atol=1e-13, samples=2, target="numpy"
    )
    angle = w * (1 - 2 / (degree * (degree + 1))) * time
    found = unpack(motion.state[:, -1])
    np.testing.assert_allclose(found, turn(W, angle), atol=1e-11)
    assert np.abs(found - turn(W, -angle)).max() > 0.01


@pytest.mark.parametrize("name", ["C1_0", "C1_1", "S1_1"])
def test_the_angular_momentum_turns_nothing(name):
    """Degree 1 alone is at rest, and its part of any vorticity stays."""
    n = 7
    system, E = FLUID.resize({"N": n}), harmonic(name, n)
    np.testing.assert_allclose(system.rhs(pack(1j * E), []), 0, atol=1e-14)
    rate = unpack(system.rhs(random_state(n), []))
    assert abs(np.trace(rate @ E)) < 1e-12 < np.abs(rate).max()


@pytest.mark.parametrize(
    ("method", "keeps", "target"),
    [
        ("isospectral_midpoint", True, TARGET),
        ("isospectral_midpoint4", True, "numpy"),
        ("midpoint", False, "numpy"),
        ("rk4", False, "numpy"),
    ],
)
def test_the_isospectral_midpoint_keeps_all_casimirs(method, keeps, target):
    """The spectrum of 9 rows to 1e-13 of its size, and so tr W^k, k = 2 to 9; others do not."""
    check_casimirs(FLUID, random_state(9) / 4, method, keeps=keeps, target=target)


@pytest.mark.parametrize(("method", "order"), [("isospectral_midpoint", 2), ("rk4", 4)])
def test_errors_fall_with_the_order_of_the_method(method, order):
    """Against DOP853 with tight tolerances."""
    system, state = FLUID.resize({"N": 6}), random_state(6) / 4

    def end(**options):
        options |= {"samples": 2, "target": "numpy"}
        return system.simulate(state, (0, 1), **options).state[:, -1]

    exact = end(method="dop853", rtol=1e-13, atol=1e-13)
    errors = [np.abs(end(method=method, step=h) - exact).max() for h in (0.05, 0.025)]
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.2


def test_the_default_with_a_step_is_isospectral():
    """So Casimirs are kept without asking for it."""
    methods = {each.rank: each.name for each in FLUID.METHODS if each.rank}
    assert methods[1] == "isospectral_midpoint4"
    assert next(x for x in FLUID.METHODS if x.name == methods[1]).is_poisson


def test_newtons_method_finds_the_same_middles():
    """By products of the derivative with vectors, where sweeps alone would do as well."""
    system, state = FLUID.resize({"N": 5}), random_state(5) / 4
    options = {"step": 0.05, "method": "isospectral_midpoint", "samples": 2, "target": "numpy"}
    one, other = (
        system.simulate(state, (0, 1), newton=newton, **options).state for newton in (False, True)
    )
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)


def test_the_derivative_along_a_vector_is_that_of_the_rates():
    """Rates are quadratic, so that a central difference is exact but for rounding."""
    system = FLUID.resize({"N": 6})
    state, vector = random_state(6), random_state(6, 1)
    found = system.jacobian_vector(state, vector, [])
    ahead, behind = (system.rhs(state + s * vector, []) for s in (0.5, -0.5))
    np.testing.assert_allclose(found, ahead - behind, atol=1e-11)


def test_a_batch_is_its_trajectories():
    """Kernels and steps of nine vorticities at once have the bits of each alone."""
    system = FLUID.resize({"N": 5})
    states = np.stack([random_state(5, seed) / 4 for seed in range(9)], axis=1)
    options = {"step": 0.1, "samples": 3, "target": TARGET, "method": "isospectral_midpoint"}
    both = system.simulate(states, (0, 0.5), **options).state
    for n in range(9):
        one = system.simulate(states[:, n], (0, 0.5), **options).state
        np.testing.assert_array_equal(both[:, n], one)


def test_four_rows_are_the_shipped_system_that_is_written_out():
    """``zeitlin_su_4`` on harmonics(4): one motion, in two bases and by two derivations."""
    w = np.array([4, 0.2, -0.3, 0.5, 0, 0.1, 0.3, 0, 0.4, 0, 0, 2, 0.7, 0, 0.1])
    hbar = [2 / np.sqrt(15)]
    names = list(POLYNOMIALS)
    E = {name: harmonic(name, 4) for name in names}
    # of a component the part along the harmonic of its name: energies of unit vorticities
    written, sizes = zeitlin_su_4.system, []
    for k, name in enumerate(names):
        degree = int(name[1])
        unit = np.zeros(15)
        unit[k] = 1.0
        ours = 1 / (degree * (degree + 1) * hbar[0]) / 2 * np.trace(E[name] @ E[name]).real
        sizes.append(np.sqrt(written.energy(unit, hbar) / ours))
    W = sum(1j * part * size * E[name] for part, size, name in zip(w, sizes, names, strict=True))
    system = FLUID.resize({"N": 4})
    assert system.energy(pack(W), []) == pytest.approx(float(written.energy(w, hbar)), rel=1e-13)
    rate = unpack(system.rhs(pack(W), []))
    expected = written.rhs(w, hbar)
    norms = [np.trace(each @ each).real for each in E.values()]
    found = [
        np.trace(rate @ E[name]).imag / norm / size
        for name, norm, size in zip(names, norms, sizes, strict=True)
    ]
    np.testing.assert_allclose(found, expected, atol=1e-13)
    assert np.abs(expected).max() > 0.1


def test_the_default_is_a_wave_with_a_disturbance():
    """Parts of harmonics as the spec has them, degree by degree, for the size of the spec."""
    state = FLUID.STATE["W"].default
    W = unpack(np.array(state))
    n = FLUID.index.size
    parts = {"C1_0": 2, "C2_1": 0, "C2_2": 0.3, "C3_2": 1, "S3_3": 0.1}
    expected = sum(1j * part * harmonic(name, n) for name, part in parts.items())
    np.testing.assert_allclose(W, expected, atol=1e-13)
    assert FLUID.resize({"N": 9}).STATE["W"].default is None


def test_a_size_counts_rows():
    """N rows have N^2 entries; messages say so."""
    system = FLUID.resize({"N": 6})
    assert (system.STATE.size, system.index.size, system.size) == (36, 6, 36)
    assert "36 entries of 6 rows" in repr(system)
    assert pickle.loads(pickle.dumps(system)).index == system.index
    with pytest.raises(KernelArgumentError, match=r"a number of rows for the index N"):
        FLUID.resize({"i": 6})
    with pytest.raises(KernelArgumentError, match="at least 2"):
        FLUID.resize({"N": 1})
    with pytest.raises(ResourceError, match="rows"):
        FLUID.resize({"N": 10**6})


def test_the_limit_of_many_rows_is_the_fluid():
    """Rates are those of ``w_t = -{psi, w}``, ``{f, g} = x . grad f x grad g``, up to O(1/N^2).

    Both by polynomials, which symmetrized products of ``hbar S`` stand for; with the other sign of
    the bracket nothing tends to anything.
    """
    x = sympy.symbols("x y z")
    harmonics = {2: x[0] * x[2], 3: 3 * x[0] ** 2 * x[1] - x[1] ** 3}
    w = sum(harmonics.values())
    psi = -sum(f / (degree * (degree + 1)) for degree, f in harmonics.items())
    slopes = [[f.diff(each) for each in x] for f in (psi, w)]
    rate = -sympy.Matrix(x).dot(sympy.Matrix(slopes[0]).cross(sympy.Matrix(slopes[1])))
    misses, opposite = [], []
    for n in (17, 33, 65):
        W = 1j * quantize(w, x, n)
        found = unpack(FLUID.resize({"N": n}).rhs(pack(W), []))
        expected = 1j * quantize(rate, x, n)
        size = np.linalg.norm(expected)
        misses.append(np.linalg.norm(found - expected) / size)
        opposite.append(np.linalg.norm(found + expected) / size)
    orders = np.log(np.divide(misses[:-1], misses[1:])) / np.log([33 / 17, 65 / 33])
    np.testing.assert_allclose(orders, 2, atol=0.1)
    assert misses[-1] < 0.02
    assert min(opposite) > 1
