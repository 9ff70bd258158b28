"""Fields by Fourier derivatives: exact waves, what is kept, holonomies, and what is refused."""

import importlib
import pickle
import warnings

import numpy as np
import pytest

import coadjoint
from coadjoint import pipeline
from coadjoint.errors import KernelArgumentError, PeriodicityWarning
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_texts
from coadjoint.solve.spectral import SpectralSystem, find_jump
from coadjoint.solve.strands import transport
from coadjoint.spec import read_spec_text
from coadjoint.systems import (
    camassa_holm,
    kdv,
    landau_lifshitz,
    rigid_body,
    spin_chain,
    spin_chain_chiral,
)
from tests.fields import (
    WAVES,
)

#: Enough points of the exact waves for rounding to show; elsewhere 31 and 32.
POINTS = {"camassa_holm": (47, 48), "hunter_saxton": (63, 64)}


def read_file(system):
    """The spec of a shipped system."""
    return (derivations_folder() / f"{system.name}.toml").read_text(encoding="utf-8")


def fourier(system, N):
    """A system of so many points."""
    return system.resize({"s": N}).with_derivatives("fourier")


@pytest.mark.parametrize("name", WAVES)
def test_rates_of_exact_waves_are_right_to_rounding(name):
    """For odd and even numbers of points, of which differences of order 4 miss 1e-6."""
    system, solution, length, parameters = WAVES[name]
    for N in POINTS.get(name, (31, 32)):
        fields, rates = solution(np.arange(N) * length / N, 0.3)
        own = fourier(system, N)
        found = own.rhs(fields.ravel(), parameters).reshape(-1, N)
        np.testing.assert_allclose(found, rates, atol=1e-12 * np.abs(rates).max())
        by_differences = own.differences.rhs(fields.ravel(), parameters).reshape(-1, N)
        assert np.abs(by_differences - rates).max() > 1e-6


@pytest.mark.parametrize("name", WAVES)
def test_the_energy_is_kept_for_any_fields(name):
    """Its rate along the motion is 0 at random fields, and along another vector it is not."""
    system, _, _, parameters = WAVES[name]
    for N in POINTS.get(name, (31, 32)):
        own, source = fourier(system, N), np.random.default_rng(N)
        state = source.normal(size=own.STATE.size)
        rate, step = own.rhs(state, parameters), 1e-3
        rate /= np.abs(rate).max()

        def change(along, own=own, state=state, step=step):
            """The energies are quadratic, so that this difference is exact."""
            ahead, behind = state + step * along, state - step * along
            energies = (own.energy(x, parameters) for x in (ahead, behind))
            return (next(energies) - next(energies)) / (2 * step)

        size = own.energy(state, parameters)
        assert abs(change(rate)) < 1e-11 * abs(size)
        assert abs(change(np.abs(rate))) > 1e-5 * abs(size)


def test_a_batch_and_every_target_have_the_same_rates():
    """Columns of a batch, with parameters of their own, and targets."""
    own, source = fourier(camassa_holm.system, 24), np.random.default_rng(2)
    m, parameters = source.normal(size=(24, 3)), np.array([[0.1, 1.0, 9.0], [3.0, 3.0, 4.0]])
    found = own.rhs(m, parameters)
    for n in range(3):
        alone = own.rhs(m[:, n], parameters[:, n], target="numpy")
        np.testing.assert_allclose(found[:, n], alone, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(own.rhs(m, parameters, target="python"), found)


def test_the_trace_of_the_holonomy_of_the_spin_chain_is_kept():
    """To 1e-9 over t = 10, of a smooth field at 128 points; that of psi' = -psi Xi is not.

    By differences of order 4 it changes by more than 1e-6.
    """
    N, L = 128, 10.0
    w = 2 * np.pi * np.arange(N) / N
    Pi = [np.cos(w), np.sin(w) / 2, 1 + 0 * w]
    Xi = [0.2 + np.cos(w) / 5, np.sin(w) / 2, 0.1 - np.sin(2 * w) / 5]
    own = fourier(spin_chain.system, N)
    state = np.concatenate([*Pi, *Xi])
    options = {"method": "scipy:DOP853", "rtol": 1e-11, "atol": 1e-12, "samples": 6}
    found = own.simulate(state, (0, 10), **options)
    traces = np.trace(found.frames()[:, :, -1])
    assert abs(traces[0]) < 2.9
    assert np.abs(traces - traces[0]).max() < 1e-9
    assert np.abs(found.drift["energy"]).max() < 1e-9
    zero, (a, b, c) = np.zeros((N, 6)), found["Xi"]
    hat = np.array([[zero, -c, b], [c, zero, -a], [-b, a, zero]])
    wrong = np.trace(transport(-hat, L)[:, :, -1])
    assert np.abs(wrong - wrong[0]).max() > 1e-2
    others = own.differences.simulate(state, (0, 10), **options)
    traces = np.trace(others.frames()[:, :, -1])
    assert np.abs(traces - traces[0]).max() > 1e-6


@pytest.mark.parametrize(
    "options",
    [
        {"method": "taylor"},
        {"method": "dop853"},
        {"method": "coadjoint_mean", "step": 0.1},
    ],
    ids=lambda each: str(each),
)
def test_generated_solvers_are_refused_with_the_reason(options):
    """They need differences; the advice is followed."""
    own = fourier(kdv.system, 32)
    with pytest.raises(KernelArgumentError, match="derivatives are those of Fourier series"):
        own.simulate(np.zeros(32), (0, 1), **options)
    found = own.simulate(np.zeros(32), (0, 1), method="scipy:DOP853", samples=2)
    assert not found.state.any()
    settings = own.simulate(np.zeros(32), (0, 1), samples=2).settings
    assert (settings["method"], settings["derivatives"]) == ("scipy:DOP853", "fourier")
    assert "derivatives" not in rigid_body.system.simulate([1.0, 2.0, 3.0], (0, 1)).settings


@pytest.mark.parametrize("method", ["discrete_gradient", "average_gradient", "discrete_gradient4"])
def test_the_midpoint_is_the_discrete_gradient_of_a_quadratic_energy(method):
    """That is the reason of the refusal, and the advice keeps the energy to rounding."""
    own = fourier(kdv.system, 32)
    state = np.cos(2 * np.pi * np.arange(32) / 32) / 3
    run = {"step": 0.01, "samples": 2}
    with pytest.raises(KernelArgumentError, match="'midpoint' is this method, and keeps") as error:
        own.simulate(state, (0, 1), method=method, **run)
    assert "energy is quadratic" in str(error.value)
    assert own.simulate(state, (0, 1), method="midpoint", **run).drift["energy"] < 1e-13


def test_a_discrete_gradient_needs_the_bracket_and_the_gradient_apart():
    """Of an energy of degree 4 the refusal says so, and names no method that would lose it."""
    text = read_file(landau_lifshitz.system)
    old = "dot(S_s, S_s)/2 -"
    assert old in text
    spec = read_spec_text(text.replace(old, "S3^2*dot(S_s, S_s)/2 -"), "magnet.toml")
    with load_texts(pipeline.render(spec).texts) as system:
        own = fourier(system, 16)
        with pytest.raises(KernelArgumentError, match="needs the bracket and the gradient") as no:
            own.simulate(None, (0, 1), method="discrete_gradient", step=0.1)
    assert "midpoint' is this method" not in str(no.value)


@pytest.mark.campaign
def test_a_spec_is_loaded_with_them(tmp_path):
    """With a number of points."""
    path = tmp_path / "waves.toml"
    path.write_text(read_file(kdv.system), encoding="utf-8")
    loaded = coadjoint.load(path, sizes={"s": 32}, derivatives="fourier")
    assert isinstance(loaded, SpectralSystem)
    assert loaded.size == 32


def test_fourier_derivatives_need_no_more_points_than_a_wave():
    """Three; differences of so few points have no equations, and are not gone back to."""
    few = kdv.system.with_derivatives("fourier").resize({"s": 3})
    m = np.array([0.3, -0.1, 0.2])
    k = np.pi * np.arange(2)  # of a circle of length 2
    slope = lambda f, n: np.fft.irfft((1j * k) ** n * np.fft.rfft(f), 3)  # noqa: E731
    expected = -(m * slope(m, 1) + slope(m * m, 1)) - 0.000484 * slope(m, 3)
    np.testing.assert_allclose(few.rhs(m), expected, rtol=1e-12)
    assert pickle.loads(pickle.dumps(few)).size == 3
    with pytest.raises(KernelArgumentError, match=r"is 2; expected .* at least 3, from which on a"):
        few.resize({"s": 2})
    with pytest.raises(
        KernelArgumentError, match=r"is 3; expected .* at least 9, from which on its"
    ):
        few.with_derivatives("differences")


@pytest.mark.parametrize("N", [12, 13])
@pytest.mark.parametrize(
    ("name", "total", "is_kept"),
    [
        ("kdv", "M", True),
        ("kdv", "J", False),
        ("spin_chain", "P", True),
        ("spin_chain_chiral", "M", True),
        ("sp2_strand", "p", True),
    ],
)
def test_sums_are_kept_as_certificates_say(name, total, is_kept, N):
    """Rates of sums along the motion at rough fields, by an exact slope of quadratic ones."""
    system = importlib.import_module(f"coadjoint.systems.{name}").system.resize({"s": N})
    system = system.with_derivatives("fourier")
    state = np.random.default_rng(N).normal(size=system.STATE.size)
    rate = system.rhs(state)
    after, before = (system.observables(state + sign * rate)[None] for sign in (1, -1))
    rows = np.atleast_1d(np.arange(after.shape[1])[system.OBSERVABLES.rows(total)])
    sizes = np.abs(after[0, rows]) + np.abs(before[0, rows])
    assert (np.abs(after - before)[0, rows] < 1e-10 * sizes).all() == is_kept


def test_the_drift_of_a_run_is_that_of_the_energy_alone():
    """J is kept by the field and not by points, so that its change is no error of a method."""
    own, w = fourier(kdv.system, 32), 2 * np.pi * np.arange(32) / 32
    assert {*own.differences.simulate(np.cos(w) / 3, (0, 0.01), samples=2).drift} == {"energy", "M"}
    assert {*own.simulate(np.cos(w) / 3, (0, 0.01), samples=2).drift} == {"energy"}


@pytest.mark.parametrize(
    ("name", "sizes", "total"),
    [("kdv", {"s": 12}, "J"), ("euler_2d", {"x": 8, "y": 8}, "C")],
)
def test_an_event_may_name_an_observable(name, sizes, total):
    """One that points do not keep, of rough fields; it has the value in the states of the event."""
    system = importlib.import_module(f"coadjoint.systems.{name}").system.resize(sizes)
    system, own = system.with_derivatives("fourier"), system.OBSERVABLES.rows(total)
    start = np.random.default_rng(3).normal(size=system.STATE.size)
    if name == "euler_2d":  # waves up to 2 move, and the mean is 0
        waves = np.fft.rfft2(start.reshape(8, 8))
        waves[0, 0], waves[3:6], waves[:, 3:] = 0, 0, 0
        start = np.fft.irfft2(waves, (8, 8)).ravel()
    for options in (
        {"method": "scipy:DOP853", "rtol": 1e-9},
        {"method": "midpoint", "step": 1 / 64},
    ):
        first = system.simulate(start, (0.0, 1.0), samples=9, **options)
        level = float(np.mean(first.observables[own]))
        event = f"{total} = {level!r}"
        run = system.simulate(start, (0.0, 1.0), samples=2, events=[event], **options)
        (found,) = run.events.values()
        assert len(found.time) > 0
        np.testing.assert_allclose(system.observables(found.state)[own], level, rtol=1e-7)
        assert np.ptp(first.observables[own]) > 1e-3 * abs(level)


def test_other_names_and_systems_are_refused():
    """A name that is none, and a system without fields."""
    with pytest.raises(KernelArgumentError, match="'chebyshev'; expected 'differences'"):
        kdv.system.with_derivatives("chebyshev")
    with pytest.raises(KernelArgumentError, match="rigid_body has no fields"):
        rigid_body.system.with_derivatives("fourier")
    assert rigid_body.system.with_derivatives("differences") is rigid_body.system


@pytest.mark.parametrize("jump", [0.0, 0.5])
def test_a_field_that_jumps_at_the_ends_is_told(jump):
    """With the size of the jump; a periodic field is not."""
    own, s = fourier(kdv.system, 64), np.arange(64) / 64
    state = np.cos(2 * np.pi * s) / 5 + jump * s
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        own.simulate(state, (0, 1e-4), samples=2, parameters={"L": 9.0})
    told = [each for each in told if each.category is PeriodicityWarning]
    assert len(told) == (jump > 0)
    for each in told:
        assert "field m of kdv jumps by 0.5" in str(each.message)
        assert "derivatives='differences'" in str(each.message)


def test_rough_and_constant_fields_do_not_jump():
    """Only the ends are judged, by what is usual elsewhere."""
    source = np.random.default_rng(1)
    assert not find_jump(source.normal(size=(64, 1)))
    assert not find_jump(np.ones((64, 1)))
    assert find_jump(np.linspace(0, 1, 64)[:, None]) > 1


def test_a_system_goes_back_and_is_pickled():
    """With its number of points and its derivatives."""
    own = fourier(kdv.system, 40)
    assert own.with_derivatives("differences") is own.differences
    assert own.with_derivatives("fourier").size == own.resize({"s": 40}).size == 40
    again = pickle.loads(pickle.dumps(own))
    assert isinstance(again, SpectralSystem)
    assert again.size == 40
    assert "Fourier" in repr(again)


def test_the_chiral_model_keeps_a_trace_for_each_spectral_parameter():
    """To 1e-9 over t = 10, of ``U = (Xi + lam Omega)/(1 - lam^2)``; without the divisor it is not.

    By differences of order 4 those of the same field change by more than 1e-8.
    """
    N, L = 64, 10.0
    w = 2 * np.pi * np.arange(N) / N
    Pi = [0.3 * np.cos(w), 0.15 * np.sin(w), 0.5 + 0 * w]
    Xi = [0.3 + 0 * w, np.sin(w) / 4, np.cos(w) / 5]
    own = fourier(spin_chain_chiral.system, N)
    state = np.concatenate([*Pi, *Xi])
    options = {"method": "scipy:DOP853", "rtol": 1e-11, "atol": 1e-12, "samples": 6}

    def change(found, lam, divisor):
        """By how much the trace changes at most."""
        a, b, c = (found["Xi"] + lam * found["Pi"]) / divisor
        U = np.array([[0 * a, -c, b], [c, 0 * a, -a], [-b, a, 0 * a]])
        traces = np.trace(transport(U, L)[:, :, -1])
        return np.abs(traces - traces[0]).max()

    found = own.simulate(state, (0, 10), **options)
    others = own.differences.simulate(state, (0, 10), **options)
    for lam in (-0.3, 0.0, 0.5, 2.0):
        assert change(found, lam, 1 - lam**2) < 1e-9
        assert change(others, lam, 1 - lam**2) > 1e-8
        if lam:
            assert change(found, lam, 1.0) > 1e-3
