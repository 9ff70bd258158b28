"""Gauss's methods by Fourier derivatives: what they keep, their orders, and steps too long."""

from functools import partialmethod

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.errors import KernelArgumentError
from coadjoint.solve import wave_gauss
from coadjoint.solve.folders import load_texts
from coadjoint.solve.stiff_waves import StiffWaves
from coadjoint.solve.wave_gauss import Made, WaveGauss
from coadjoint.spec import read_spec_text
from coadjoint.systems import camassa_holm, euler_2d, kdv, spin_chain, spin_chain_chiral
from tests.fields import cnoidal_wave, precessing_wave
from tests.specs import shipped

N, L = 32, 10.0
OPTIONS = {"samples": 5}


def chain():
    """The spin chain by Fourier derivatives, and a smooth state of all its components."""
    w = 2 * np.pi * np.arange(N) / N
    Pi = [np.cos(w), np.sin(w) / 2, 1 + 0 * w]
    Xi = [0.2 + np.cos(w) / 5, np.sin(w) / 2, 0.1 + 0 * w]
    return spin_chain.system.resize({"s": N}).with_derivatives("fourier"), [*Pi, *Xi]


def start():
    """The state of the chain in a row."""
    return np.concatenate(chain()[1])


def test_the_energy_is_kept_to_rounding_where_it_is_quadratic():
    """Over 200 steps; by the explicit method of SciPy as far as its tolerance."""
    system, _ = chain()
    run = system.simulate(start(), (0, 4), step=0.02, **OPTIONS)
    assert run.settings["method"] == "midpoint"
    assert (run.settings["order"], run.settings["step"]) == (2, 0.02)
    assert "energy" in run.settings["chosen"]
    assert run.drift["energy"] < 1e-13
    explicit = system.simulate(start(), (0, 4), rtol=1e-6, atol=1e-8, **OPTIONS)
    assert explicit.drift["energy"] > 1e-9


def test_a_plane_keeps_energy_and_enstrophy_to_rounding():
    """Both are quadratic, and truncated series keep them; the cube of w is not kept."""
    system = euler_2d.system
    w = np.array([system.STATE.defaults[c] for c in system.STATE.components]).reshape(32, 32)
    run = system.simulate({"w": w}, (0, 15), step=0.1, **OPTIONS)
    assert run.settings["method"] == "midpoint"
    assert max(run.drift.values()) < 1e-13
    assert {*run.drift} == {"energy", "Z"}
    assert np.abs(run["C"] - run["C"][0]).max() > 1e-6


@pytest.mark.parametrize("order", [2, 4, 6])
def test_a_plane_has_gausses_methods(order):
    """Errors fall by their order, and the energy and the enstrophy stay; a tenth of a turn."""
    system = euler_2d.system.resize({"x": 8, "y": 8})
    x, y = np.meshgrid(*[np.arange(8) * np.pi / 4] * 2, indexing="ij")
    w = np.cos(x) + np.sin(y) + 0.5 * np.cos(x + y) + 0.3 * np.sin(2 * y)
    name = {2: "midpoint"}.get(order, f"gauss{order}")
    given = {"rtol": 1e-13, "atol": 1e-14, "method": "scipy:DOP853"}
    known = system.simulate({"w": w}, (0, 2), samples=2, **given).state[:, -1]
    errors = []
    for step in (0.4, 0.2):
        run = system.simulate({"w": w}, (0, 2), samples=2, method=name, step=step)
        assert max(run.drift.values()) < 1e-14, run.drift
        errors.append(np.abs(run.state[:, -1] - known).max())
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.2, errors


def test_errors_fall_with_the_square_of_the_step():
    """Against SciPy's method of order 8."""
    system, _ = chain()
    known = system.simulate(start(), (0, 1), samples=2, rtol=1e-12, atol=1e-13).state[:, -1]
    errors = [
        np.abs(system.simulate(start(), (0, 1), step=h, samples=2).state[:, -1] - known).max()
        for h in (0.05, 0.025)
    ]
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.05


def test_runs_count_their_steps_and_sweeps():
    """Of a linear rate by hand: sweeps of y' = -y/10 by steps of 1 gain a factor 1/20 each."""
    made = Made()
    solver = WaveGauss(lambda _, y: -0.1 * y, 0.0, np.ones(1), 3.0, step=1.0, made=made)
    while solver.status == "running":
        assert solver.step() is None
    np.testing.assert_allclose(solver.y, (0.95 / 1.05) ** 3, rtol=1e-15)
    least = int(np.ceil(np.log(2.0**-53) / np.log(1 / 20)))
    assert made.steps == 3
    assert 3 * least <= made.sweeps <= 3 * (least + 3)
    system, _ = chain()
    run = system.simulate(start(), (0, 0.2), step=0.02, **OPTIONS)
    assert run.steps == 10
    assert 30 <= run.sweeps <= 500
    assert system.simulate(start(), (0, 0.2), **OPTIONS).sweeps is None


def test_paths_between_steps_are_cubics():
    """In the middle of a step, half of both ends and an eighth of the slopes between them."""
    h, first = 0.4, np.array([1.0, 0.0])
    solver = WaveGauss(lambda _, y: np.array([y[1], -y[0]]), 0.0, first, h, step=h)
    assert solver.step() is None
    path, last = solver.dense_output(), solver.y
    middle = (first + last) / 2 + h / 8 * np.array([first[1] - last[1], last[0] - first[0]])
    np.testing.assert_allclose(path(h / 2), middle, atol=1e-15)
    np.testing.assert_array_equal(path(h), last)
    assert path(np.array([0.0, h / 2, h])).shape == (2, 3)


@pytest.mark.parametrize("order", [2, 4])
def test_roundings_of_steps_do_not_add_up(order):
    """Of an oscillator over 4000 steps; without what steps leave out its energy drifts more."""

    def drift(*, is_kept):
        first = np.array([1.0, 0.3])
        rates = lambda _, y: np.array([y[1], -y[0]])  # noqa: E731
        solver = WaveGauss(rates, 0.0, first, 1e9, step=0.05, order=order)
        sizes = []
        for _ in range(4000):
            solver.step()
            solver._left_out *= is_kept
            sizes.append(solver.y @ solver.y)
        return np.abs(np.array(sizes) / (first @ first) - 1).max()

    assert drift(is_kept=True) < 1.5e-15 < drift(is_kept=False)


def test_the_last_step_ends_where_the_run_does():
    """An end that is no whole number of steps."""
    system, _ = chain()
    run = system.simulate(start(), (0, 0.25), step=0.1, samples=4)
    assert run.time[-1] == 0.25
    assert run.status == "OK"
    given = system.simulate(start(), [0, 0.05, 0.25], step=0.1)
    np.testing.assert_array_equal(given.state[:, -1], run.state[:, -1])


#: Points, the length and the central charge of the wave of Korteweg and de Vries.
POINTS, CIRCLE, CHARGE = 128, 12.0, 1.3


def cnoidal(h, end, points=POINTS, method="midpoint"):
    """A run along the wave, and by how much it misses the wave at its end."""
    s = np.arange(points) * CIRCLE / points
    system = kdv.system.resize({"s": points}).with_derivatives("fourier")
    start, given = cnoidal_wave(s, 0.0)[0].ravel(), {"c": CHARGE, "L": CIRCLE}
    options = {"step": h, "samples": 3, "method": method}
    run = system.simulate(start, (0, end), parameters=given, **options)
    return run, np.abs(run.state[:, -1] - cnoidal_wave(s, end)[0].ravel()).max()


def spoil(monkeypatch, factor):
    """Direct sweeps by a multiple of the linear part of the motion."""
    find = StiffWaves.find_matrices
    monkeypatch.setattr(StiffWaves, "find_matrices", lambda self, state: factor * find(self, state))


def test_steps_are_long_where_third_derivatives_are_stiff(monkeypatch):
    """Hundreds of times as long as plain sweeps solve; error of order 2, energy and mass kept."""
    errors = []
    for h in (0.04, 0.02):
        run, error = cnoidal(h, 0.8)
        assert run.status == "OK"
        assert run.drift["energy"] < 1e-14
        np.testing.assert_allclose(run["M"], run["M"][0], rtol=1e-14)
        errors.append(error)
    assert errors[1] < 1e-6
    assert abs(np.log2(errors[0] / errors[1]) - 2) < 0.01
    spoil(monkeypatch, 0)
    assert cnoidal(2e-4, 4e-3)[0].status == "NOT_SOLVED"
    assert cnoidal(3e-5, 6e-4)[0].status == "OK"


#: Steps at which orders show above rounding, along the waves of `cnoidal` and `precessing`.
STEPS = {"gauss4": (0.04, 0.05), "gauss6": (0.08, 0.2), "gauss8": (0.16, 1.0)}


def precessing(h, end, method):
    """A run along the precessing wave of the chiral model, and by how much it misses the wave."""
    s = np.arange(N) * L / N
    system = spin_chain_chiral.system.resize({"s": N}).with_derivatives("fourier")
    start = precessing_wave(s, 0.0, L)[0].ravel()
    run = system.simulate(start, (0, end), step=h, samples=2, method=method)
    return run, np.abs(run.state[:, -1] - precessing_wave(s, end, L)[0].ravel()).max()


@pytest.mark.parametrize("method", STEPS)
def test_errors_along_exact_waves_fall_with_the_order(method):
    """By 2^p with half the step, with the energy to rounding; of KdV however stiff it is."""
    order, (stiff, mild) = int(method[-1]), STEPS[method]
    runs = [precessing(h, 2.0, method) for h in (mild, mild / 2)]
    assert np.log2(runs[0][1] / runs[1][1]) == pytest.approx(order, abs=0.02 * order)
    runs += [cnoidal(stiff, 0.8, 64, method)]
    for run, error in runs:
        assert run.status == "OK"
        assert run.settings["order"] == order
        assert run.drift["energy"] < 2e-15
        assert error < 1e-8


def test_the_order_four_of_a_stiff_wave_is_that_of_the_method():
    """Of KdV with steps far beyond those of explicit methods; the mass is kept as well."""
    (run, large), (_, small) = (cnoidal(h, 0.8, 64, "gauss4") for h in (0.08, 0.04))
    assert np.log2(large / small) == pytest.approx(4, abs=0.02)
    np.testing.assert_allclose(run["M"], run["M"][0], rtol=1e-14)


def test_another_tableau_has_another_order(monkeypatch):
    """Radau IA, of order 3 with two stages, loses the energy that Gauss's method keeps."""
    radau = np.array([[1, -1], [1, 5 / 3]]) / 4, np.array([1, 3]) / 4
    right = [precessing(h, 1.0, "gauss4") for h in (0.2, 0.1)]
    monkeypatch.setattr(wave_gauss, "list_weights", lambda _: radau)
    wrong = [precessing(h, 1.0, "gauss4") for h in (0.2, 0.1)]
    assert np.log2(wrong[0][1] / wrong[1][1]) == pytest.approx(3, abs=0.1)
    assert wrong[0][1] > 50 * right[0][1]
    assert wrong[0][0].drift["energy"] > 1e-9


def test_stiff_sweeps_are_of_all_stages_together(monkeypatch):
    """With the part of each stage alone there are more than twice as many, to the same stages."""
    own, made = StiffWaves.direct, list[int]()

    def count(self, state, scaled, *, alone):
        correct = own(self, state, np.diag(np.diag(scaled)) if alone else scaled)
        return lambda residual: made.append(alone) or correct(residual)

    states = []
    for alone in (False, True):
        monkeypatch.setattr(StiffWaves, "direct", partialmethod(count, alone=alone))
        states.append(cnoidal(0.05, 0.1, 64, "gauss4")[0].state)
    np.testing.assert_allclose(*states, rtol=1e-11)
    assert made.count(True) > 2 * made.count(False) > 0


def test_the_traces_of_the_chiral_chain_are_kept_by_order_four():
    """Of a field that is no wave: the holonomy, and L at two parameters, to errors of the step.

    With half the step they change by a 16th, and by much less than by the midpoint.
    """
    w, changes = 2 * np.pi * np.arange(N) / N, {}
    Pi = [0.3 * np.cos(w), 0.15 * np.sin(w), 0.5 + 0 * w]
    Xi = [0.3 + 0 * w, np.sin(w) / 4, np.cos(w) / 5]
    system = spin_chain_chiral.system.resize({"s": N}).with_derivatives("fourier")
    for method, h in (("gauss4", 0.2), ("gauss4", 0.1), ("midpoint", 0.1)):
        options = {"step": h, "method": method, "samples": 2}
        run = system.simulate(np.concatenate([*Pi, *Xi]), (0, 2), **options)
        assert run.drift["energy"] < 2e-15
        changes[method, h] = [np.abs(x - x[0]).max() for x in run.traces().values()]
    assert len(changes["gauss4", 0.1]) == 3
    for large, small, low in zip(*changes.values(), strict=True):
        assert small < 1e-6
        assert large / small == pytest.approx(16, rel=0.15)
        assert low > 100 * small


@pytest.mark.parametrize(
    ("factor", "solved"), [(0.7, True), (1.4, True), (1e20, False), (-1, False)]
)
def test_another_linear_part_finds_the_same_or_nothing(monkeypatch, factor, solved):
    """One that is a bit off needs more sweeps; one that leads nowhere is a status."""
    right, _ = cnoidal(0.01, 0.02)
    spoil(monkeypatch, factor)
    run, _ = cnoidal(0.01, 0.02)
    assert run.status == ("OK" if solved else "NOT_SOLVED")
    if solved:
        np.testing.assert_allclose(run.state, right.state, rtol=1e-11)
    else:
        assert run.time[-1] == 0


def test_steps_that_are_solved_to_rounding_of_short_waves_are_taken():
    """Of 2048 points, where rounding of third derivatives over a step is beyond 1e-12."""
    run, _ = cnoidal(0.01, 0.02, points=2048)
    assert run.status == "OK"
    assert run.drift["energy"] < 1e-13


def test_steps_that_are_too_long_are_a_status():
    """Too long for what is not linear; shorter ones are solved, as the advice says."""
    system = kdv.system.resize({"s": 32}).with_derivatives("fourier")
    m = np.cos(2 * np.pi * np.arange(32) / 32) / 3
    run = system.simulate(m, (0, 1), step=1.0, samples=2)
    assert run.status == "NOT_SOLVED"
    assert "Shorten steps" in run.message
    assert system.simulate(m, (0, 0.1), step=0.01, samples=2).status == "OK"


@pytest.fixture(scope="module")
def heavy():
    """Camassa and Holm's equation with m = 2 u - a^2 u_ss, whose mean is twice that of u."""
    text = shipped("camassa_holm").path.read_text(encoding="utf-8").replace('"u^2/2 +', '"u^2 +')
    with load_texts(pipeline.render(read_spec_text(text, "heavy.toml")).texts) as system:
        yield system


@pytest.mark.parametrize("name", ["kdv", "camassa_holm", "spin_chain", "heavy"])
@pytest.mark.parametrize("count", [9, 10])
def test_the_linear_part_is_that_of_rates(name, count, request):
    """About constant fields: differences are exact, since rates are of degree 2."""
    known = {each.name: each for each in (kdv.system, camassa_holm.system, spin_chain.system)}
    system = known.get(name) or request.getfixturevalue(name)
    own = system.resize({"s": count}).with_derivatives("fourier")
    source, fields = np.random.default_rng(count), len(own.own_state)
    parameters = source.uniform(1, 2, size=own.PARAMETERS.size)
    means = np.repeat(source.normal(size=fields), count)
    found = StiffWaves(own, parameters).find_matrices(means)
    for b in range(fields):
        unit = np.zeros((fields, count))
        unit[b, 0] = 1.0
        change = own.rhs(means + unit.ravel(), parameters) - own.rhs(
            means - unit.ravel(), parameters
        )
        waves = np.fft.rfft(change.reshape(fields, count) / 2, axis=1)
        np.testing.assert_allclose(found[:, :, b].T, waves, atol=1e-11 * np.abs(waves).max())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "midpoint"}, "expected step="),
        ({"step": 0.1, "newton": True}, "expected newton=False"),
        (
            {"method": "rk4", "step": 0.1},
            "'midpoint', 'gauss4', 'gauss6', 'gauss8', 'scipy:DOP853'",
        ),
        ({"method": "midpoint", "step": 0.1, "rtol": 1e-3}, "one or the other"),
    ],
)
def test_what_does_not_go_with_it_is_refused(options, message):
    """With what there is instead."""
    system, _ = chain()
    with pytest.raises(KernelArgumentError, match=message):
        system.simulate(start(), (0, 1), **options)
