"""Driven systems: what kernels take, and runs against closed forms and 30 digits."""

import threading

import mpmath
import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.systems import rigid_body
from tests.driven_specs import BELT, BOOST, PENDULUM, POINT, ROD, SUSLOV, TOP, build, rendered

METHODS = (
    "taylor",
    "DOP853",
    "scipy:DOP853",
    "scipy:RK23",
    "scipy:Radau",
    "scipy:BDF",
    "scipy:LSODA",
)


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """Driven systems by text, each built once."""
    built = {}

    def load(text):
        if text not in built:
            name = f"driven{len(built)}"
            folder = tmp_path_factory.mktemp("driven") / name
            built[text] = build(rendered(text, name=name).texts, folder)
        return built[text]

    return load


# -- kernels --------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["numpy", "c", "c-fast", "python"])
@pytest.mark.parametrize("batch", [(), (7,), (3, 5)], ids=str)
def test_inputs_and_time_for_each_member(system, target, batch):
    """Hand-typed rates of the pendulum; parameters, inputs and time shared or one for each."""
    pendulum, source = system(PENDULUM), np.random.default_rng(1)
    (phi, p), (L, g, a, w) = source.normal(size=(2, *batch)), source.uniform(1, 2, (4, *batch))
    u, t = source.normal(size=(1, *batch)), source.normal(size=batch)
    for own in (True, False):
        if not own:
            first = (slice(None), *([0] * len(batch)))
            (L, g, a, w), u = np.array([L, g, a, w])[first], u[first]
            t = float(t[first[1:]])
        v = p / L**2 + a * w * np.sin(w * t) * np.sin(phi) / L
        force = u[0] - L * a * w * np.sin(w * t) * np.cos(phi) * v - g * L * np.sin(phi)
        found = pendulum.rhs([phi, p], [L, g, a, w], u, time=t, target=target)
        np.testing.assert_allclose(found, [v, force], rtol=1e-12, atol=1e-12)


def test_defaults_and_names(system):
    """None is the default; a mapping names quantities or components."""
    top, state = system(TOP), [1.0, 2.0, 3.0, 0.0, 0.6, 0.8]
    default = top.rhs(state)
    assert np.array_equal(default, top.rhs(state, None, [0.0, 0.0, 1.0]))
    assert np.array_equal(default, top.rhs(state, None, {"u": [0.0, 0.0, 1.0]}))
    assert np.array_equal(top.rhs(state, None, {"u1": 2.0}), top.rhs(state, None, [2.0, 0, 1]))
    assert not np.array_equal(default, top.rhs(state, None, [1.0, 0.0, 0.0]))
    assert list(top.INPUTS) == ["u"]
    assert not top.TIME
    assert system(PENDULUM).TIME.components == ("t",)


def test_a_body_under_torques(system):
    """I Omega' = u about the first two axes, Omega3 = 0."""
    found = system(SUSLOV).rhs([0.3, 0.4, 0.0], [1.0, 2.0, 3.0], [5.0, 7.0, 9.0])
    np.testing.assert_allclose(found, [5.0, 3.5, 0.0], rtol=1e-15, atol=1e-15)


REFUSED = [
    (TOP, {"inputs": [1.0, 2.0]}, r"the shape of inputs of \w+ is \(2,\); expected \(3,\)"),
    (TOP, {"inputs": {"w": 1.0}}, "'w' is not one of u"),
    (TOP, {"inputs": np.ones((3, 4))}, r"inputs have the batch shape \(4,\), the state \(\)"),
    (TOP, {"time": 0.0}, "does not depend on time, and found time = 0.0"),
    (PENDULUM, {}, "depends on time, and none is given.*Write time=0.0"),
    (PENDULUM, {"time": [0.0, 1.0]}, r"time has the batch shape \(2,\), the state \(\)"),
    (TOP, {"inputs": "numpy"}, 'has the inputs u, and found .numpy. in their place.*target="c"'),
    (TOP, {"out": np.ones(6), "inputs": np.ones(3) * 1j}, "complex"),
]


@pytest.mark.parametrize(("text", "named", "problem"), REFUSED)
def test_what_kernels_refuse(system, text, named, problem):
    """Missing time, wrong shapes and names: what was found and what is expected."""
    state = np.ones(system(text).STATE.size)
    with pytest.raises((KernelArgumentError, KernelTypeError), match=problem):
        system(text).rhs(state, **named)


def test_inputs_without_a_default_are_asked_for(tmp_path):
    """They have to be given, by name for instance."""
    texts = rendered(TOP, ("default = [0, 0, 1]", 'doc = "field"')).texts
    top = build(texts, tmp_path / "sample")
    with pytest.raises(KernelArgumentError, match="inputs lacks u1, u2, u3"):
        top.rhs(np.ones(6))
    top.rhs(np.ones(6), None, {"u": [0.0, 0.0, 1.0]})


def test_a_system_without_inputs_has_none():
    """The message shows the spelling of what was meant."""
    with pytest.raises(KernelArgumentError, match="rigid_body has no inputs"):
        rigid_body.rhs([1.0, 2.0, 3.0], None, [1.0])


@pytest.mark.parametrize("target", ["numpy", "c", "python"])
def test_bound_calls_read_inputs_and_time_in_place(system, target):
    """They follow the arrays, as the state is followed."""
    pendulum = system(PENDULUM)
    state, u, t, out = np.array([0.3, 0.4]), np.zeros(1), np.zeros(()), np.empty(2)
    call = pendulum.bind("rhs", state, None, u, time=t, out=out, target=target)
    for u[0], t[...] in ((1.0, 2.0), (3.0, 4.0)):
        call()
        expected = pendulum.rhs(state, None, u.copy(), time=float(t), target=target)
        assert np.array_equal(out, expected)


# -- runs -----------------------------------------------------------------------------------------


def pushed(system, inputs, **options):
    """X and v of the particle of mass 2 from rest, at times up to 3."""
    found = system(POINT).simulate([0.0, 0.0], np.linspace(0, 3, 13), None, inputs, **options)
    assert found.status == "OK", found.message
    return found


@pytest.mark.parametrize("inputs", [None, [3.0, 0.0, 1.0], {"f": 3.0}, lambda t: {"f": 3.0}])
def test_constant_force(system, inputs):
    """X = f t^2/(2 m)."""
    found = pushed(system, inputs)
    np.testing.assert_allclose(found["x"], 3 * found.time**2 / 4, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("method", METHODS)
def test_no_step_crosses_a_jump(system, method):
    """F = 0, 4, -2 from t = 0, 1, 5/4: parabolas, which loose tolerances leave exact.

    A step across a jump would be wrong by about its length, at any of these tolerances.
    """
    times, f = np.array([0.0, 1.0, 1.25, 4.0]), np.array([0.0, 4.0, -2.0, 7.0])
    samples = (times, np.array([f, 0 * f, 0 * f]), "previous")
    loose = {"rtol": 1e-3, "atol": 1e-6} if method not in ("scipy:BDF", "scipy:LSODA") else {}
    found = pushed(system, samples, method=method, **loose)
    t, one = found.time, np.clip(found.time - 1, 0, None)
    two = np.clip(t - 1.25, 0, None)
    expected = (4 * one**2 - 6 * two**2) / 4
    close = 1e-11 if not loose else 1e-13
    np.testing.assert_allclose(found["x"], expected, rtol=0, atol=close if loose else 1e-6)
    np.testing.assert_allclose(found["f"], np.where(t < 1, 0, np.where(t < 1.25, 4, -2)))


def test_linear_samples(system):
    """F = 2 t: x = t^3/6, also by name."""
    samples = (np.array([0.0, 1.0, 3.0]), {"f": [0.0, 2.0, 6.0]}, "linear")
    found = pushed(system, samples)
    np.testing.assert_allclose(found["x"], found.time**3 / 6, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(found["f"], 2 * found.time, rtol=1e-15)


def test_a_function_of_time(system):
    """F = cos t: x = (1 - cos t)/2."""
    found = pushed(system, lambda t: [np.cos(t), 0.0, 0.0])
    np.testing.assert_allclose(found["x"], (1 - np.cos(found.time)) / 2, rtol=0, atol=1e-9)


def test_a_driven_pendulum_against_thirty_digits(system):
    """Phi'' = -(g - a w^2 cos(w t)) sin(phi)/L + sin(3 t)/L^2, typed by hand, by Taylor series."""
    found = system(PENDULUM).simulate([0.5, 0.0], [0.0, 0.4, 0.8], None, lambda t: np.sin(3 * t))
    with mpmath.workdps(30):
        L, g, a, w = 1, mpmath.mpf("9.81"), mpmath.mpf("0.1"), 5

        def rates(t, y):
            phi, v = y
            pull = (g - a * w**2 * mpmath.cos(w * t)) / L
            return [v, -pull * mpmath.sin(phi) + mpmath.sin(3 * t) / L**2]

        exact = mpmath.odefun(rates, 0, [mpmath.mpf("0.5"), 0])
        expected = [float(exact(t)[0]) for t in (mpmath.mpf("0.4"), mpmath.mpf("0.8"))]
    np.testing.assert_allclose(found["phi"][1:], expected, rtol=0, atol=1e-9)


def test_drift_of_what_depends_on_time(system):
    """K = t P - m r stays what it is along a free motion; its value at 0 is -m r."""
    found = system(BOOST).simulate([1.0, 2.0, 3.0, 0.4, 0.5, 0.6], (0.0, 5.0), {"m": 2.0})
    assert found.drift["K"] < 1e-13
    np.testing.assert_allclose(found["K"][:, -1], [-2.0, -4.0, -6.0], rtol=1e-12)
    assert np.ptp(found["r1"]) > 0.5


def test_energy_is_an_invariant_while_inputs_are_constant(system):
    """Its drift is shown then, and not where the field changes."""
    top, state = system(TOP), [1.0, 2.0, 3.0, 0.0, 0.6, 0.8]
    still = top.simulate(state, (0.0, 2.0), None, [0.0, 1.0, 2.0])
    assert still.drift["energy"] < 1e-9
    moving = top.simulate(state, (0.0, 2.0), None, lambda t: [0.0, np.cos(t), 1.0])
    assert "energy" not in moving.drift
    assert moving.drift["casimir1"] < 1e-9
    assert np.ptp(moving["energy"]) > 0.1
    assert "energy" not in system(PENDULUM).simulate([0.5, 0.0], (0.0, 1.0)).drift


def test_a_constraint_that_moves_is_followed(system):
    """Vy = t^2 vx + sin t; (1 + t^4) vx' = f - t^2 (2 t vx + cos t) by another integrator."""
    from scipy.integrate import solve_ivp

    found = system(ROD).simulate([0.0, 0.0, 1.0], (0.0, 2.0), None, [0.5], samples=5)

    def rates(t, y):
        vx = y[2]
        return [vx, t**2 * vx + np.sin(t), (0.5 - t**2 * (2 * t * vx + np.cos(t))) / (1 + t**4)]

    expected = solve_ivp(rates, (0, 2), [0.0, 0.0, 1.0], "Radau", found.time, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.state, expected.y, rtol=0, atol=1e-7)


def test_an_input_with_its_rate_moves_a_constraint(system):
    """With b = sin t and db = cos t, the belt moves the bead as the function of time does."""
    run = ([0.0, 0.0, 1.0], np.linspace(0, 2, 5), None)
    expected = system(ROD).simulate(*run, [0.5], method="dop853")
    found = system(BELT).simulate(*run, lambda t: {"f": 0.5, "b": np.sin(t), "db": np.cos(t)})
    np.testing.assert_allclose(found.state, expected.state, rtol=0, atol=1e-12)


WRONG = [
    (lambda t: [1.0, 2.0], r"at t = 0: .*\(2,\); expected \(3,\)"),
    (lambda t: [np.nan, 0.0, 0.0], "the input f of the function inputs at t = 0 is nan; expected"),
    (lambda t: [1.0 if t < 1 else np.inf, 0.0, 0.0], r"the input f .* at t = [12].* is inf;"),
    (lambda t: [1.0, 0.0, 0.0] if t < 1 else [1.0], r"at t = [12].*\(1,\); expected \(3,\)"),
    (lambda t: None, "the function inputs returns None at t = 0; expected .3,.: f, k1, k2"),
    (([0, 1], np.ones((2, 3)), "linear"), r"samples .* shape .2, 3.; expected .3, 2., one row"),
    (
        ([0, 1], {"f": [1, 2, 3], "k": np.ones((2, 2))}, "linear"),
        r"fit together: .3,., .2,., .2,.\.$",
    ),
    ([1.0, np.nan, 0.0], "the input k1 is nan; expected a finite number"),
    (np.ones((3, 2)), r"the shape \(3, 2\), expected \(3,\): f, k1, k2"),
    (([0.0, 4.0], np.ones((3, 2))), "tuple of 2 with the interpolation None; expected samples as"),
    (([0.0, 4.0], np.ones((3, 2)), "cubic"), "interpolation 'cubic'"),
    (
        ([0.0, 2.0], np.ones((3, 2)), "linear"),
        "sampled from t = 0 to 2, and the run is from 0",
    ),
    (([1.0, 4.0], np.ones((3, 2)), "previous"), "beyond its range is refused"),
    (([0.0, 4.0], np.ones((3, 3)), "linear"), r"have shape \(3, 3\).* of shape \(3, 2\)"),
    (([0.0, 4.0], np.full((3, 2), np.nan), "linear"), "are not all finite"),
    (([4.0, 0.0], np.ones((3, 2)), "linear"), "increasing finite times"),
]


@pytest.mark.parametrize(("inputs", "problem"), WRONG, ids=range(len(WRONG)))
def test_what_runs_refuse(system, inputs, problem):
    """Before they start, or with the time at which a function went wrong."""
    with pytest.raises(KernelArgumentError, match=problem):
        pushed(system, inputs)


def test_a_run_without_inputs_takes_none():
    """A system that has none refuses them."""
    with pytest.raises(KernelArgumentError, match="rigid_body has no inputs"):
        rigid_body.simulate([1.0, 2.0, 3.0], (0.0, 1.0), None, lambda t: [t])


def test_a_domain_that_moves(tmp_path):
    """X = 3 t^2/4 < f + t, with f = 3, until t = (1 + sqrt(10))/1.5; the message has f and t."""
    bounded = (
        POINT.replace(', unit = "N"', "") + '[time]\nname = "t"\n[domain]\nahead = "x < f + t"\n'
    )
    found = build(rendered(bounded).texts, tmp_path / "sample").simulate([0.0, 0.0], (0.0, 4.0))
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - (1 + np.sqrt(10)) / 1.5) < 1e-9
    assert "f = 3" in found.message
    assert "t = 2.77485" in found.message


@pytest.mark.parametrize("method", ["scipy:Radau", "scipy:BDF", "scipy:LSODA"])
def test_jacobians_are_those_of_the_moment(system, method):
    """Implicit methods, which use them at the times of their steps, find the explicit run."""
    run = (system(PENDULUM), [0.5, 0.0], (0.0, 2.0), None, lambda t: np.cos(t))
    expected, found = (
        run[0].simulate(*run[1:], method=each, rtol=1e-9, atol=1e-12, samples=5)
        for each in ("scipy:DOP853", method)
    )
    assert found.status == "OK"
    np.testing.assert_allclose(found.state, expected.state, rtol=0, atol=1e-6)


# -- functions of Python, by the methods of Runge and Kutta ---------------------------------------


def drive(t):
    """A force of degree 3 in time; the places of its other part are still."""
    return [t**3 - 2 * t, 0.0, 0.0]


@pytest.mark.parametrize("target", ["c", "numpy", "c-fast"])
@pytest.mark.parametrize(("method", "step"), [("dop853", None), ("dop853", 0.5), ("rk4", 0.01)])
def test_generated_methods_ask_a_function(system, target, method, step):
    """X'' = (t^3 - 2 t)/2, so that x = t^5/40 - t^3/6; method of order 4 and 8, and says so."""
    found = pushed(system, drive, method=method, step=step, target=target)
    expected = found.time**5 / 40 - found.time**3 / 6
    close = 1e-13 if method == "dop853" else 1e-9
    np.testing.assert_allclose(found["x"], expected, rtol=0, atol=close)
    np.testing.assert_allclose(found["f"], found.time**3 - 2 * found.time, rtol=1e-15)
    assert found.method == method
    assert "inputs are a function of Python" in found.settings["stepwise"]
    assert "Python led the steps: inputs are a function" in repr(found)
    lines = ([0.0, 4.0], np.zeros((3, 2)), "linear")
    assert "stepwise" not in pushed(system, lines, method="dop853").settings


def test_members_ask_a_function_as_one_does(system):
    """Bits of each alone, in both languages, at times of its own; parameters of each."""
    state = np.random.default_rng(2).normal(size=(2, 5))
    run = {"t": (0.0, 3.0), "inputs": drive, "samples": 4}
    masses = np.linspace(1, 3, 5)
    found = system(POINT).simulate(state, parameters={"m": masses}, **run)
    assert (found.status == "OK").all()
    assert found.inputs.shape == (3, 4)
    t = found.time
    expected = state[0][:, None] + state[1][:, None] * t
    expected = expected + (t**5 / 20 - t**3 / 3) / masses[:, None]
    np.testing.assert_allclose(found["x"], expected, rtol=0, atol=1e-10)
    other = system(POINT).simulate(state, parameters={"m": masses}, target="numpy", **run)
    assert found.state.tobytes() == other.state.tobytes()
    for n in range(5):
        one = system(POINT).simulate(state[:, n], parameters={"m": masses[n]}, **run)
        assert one.state.tobytes() == found.member(n).state.tobytes()
        assert one.steps == found.steps[n]


def test_a_function_is_asked_by_one_thread_and_never_beyond_the_run(system):
    """It may look into a table that ends there."""
    asked = []

    def look(t):
        asked.append((t, threading.get_ident()))
        return [np.cos(t), 0.0, 0.0]

    state = np.random.default_rng(2).normal(size=(2, 40))
    found = system(POINT).simulate(
        state, (0.1, 0.7), None, look, samples=3, threads=4, events="x == 0", dense=True
    )
    times, threads = zip(*asked, strict=True)
    assert (min(times), max(times)) == (0.1, 0.7)
    assert set(threads) == {threading.get_ident()}
    assert sum(found.events["x == 0"].count) > 0
    assert (found.at(0.7)["f"] == np.cos(0.7)).all()


def test_a_function_leaves_and_keeps_what_others_do(system, tmp_path):
    """Domain, constraints that move, checkpoint and file have the inputs of the moment."""
    bounded = (
        POINT.replace(', unit = "N"', "") + '[time]\nname = "t"\n[domain]\nahead = "x < f + t"\n'
    )
    found = build(rendered(bounded).texts, tmp_path / "sample").simulate(
        [0.0, 0.0], (0.0, 4.0), None, lambda t: {"f": 3.0}
    )
    assert found.method == "dop853"
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - (1 + np.sqrt(10)) / 1.5) < 1e-9
    run = {"samples": 5, "checkpoint": tmp_path / "run.npz", "method": "dop853"}
    first = pushed(system, drive, **run)
    assert pushed(system, drive, **run).state.tobytes() == first.state.tobytes()
    with pytest.raises(KernelArgumentError, match="its inputs has the hash"):
        pushed(system, lambda t: [t, 0.0, 0.0], **run)
    first.to_csv(tmp_path / "run.csv")
    read = type(first).from_csv(system(POINT), tmp_path / "run.csv")
    assert read.settings == first.settings


def test_taylor_asks_no_function(system):
    """The message has the reason, and the methods that fit."""
    with pytest.raises(KernelArgumentError, match=r"tells their values alone. Expected 'auto', 'd"):
        pushed(system, drive, method="taylor")
    with pytest.raises(KernelArgumentError, match=r"\(3, 2\), expected \(3,\): f, k1, k2, which"):
        system(POINT).simulate(np.zeros((2, 2)), (0, 1), None, lambda t: np.ones((3, 2)))
