"""Generated solvers: known motions, batches, threads, inputs, how they end, and their order."""

import signal
import threading

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from coadjoint.build.compiler import CompilerWarning
from coadjoint.errors import CrossCheckError, KernelArgumentError
from coadjoint.solve import comparison, march, solvers
from coadjoint.solve.calls import CStepper
from coadjoint.solve.choices import Choice
from coadjoint.solve.costs import Costs, choose_order
from coadjoint.solve.ensemble import Status
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.folders import load_folder
from coadjoint.solver_kinds import list_kinds
from coadjoint.systems import heavy_top, kepler, rigid_body, so8_body
from tests.driven_specs import PENDULUM, rendered
from tests.driven_specs import build as build_driven
from tests.kernels import COMPILER
from tests.programs import BOUNDED
from tests.solve.runs import drive_members
from tests.solve.systems import POLE, build, one_variable, pendulum
from tests.trees_of_files import ROOT

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
INERTIA = (1.0, 2.0, 3.0)


def free_body(time, start1, start3):
    """Momenta of a free body with Pi2(0) = 0: Landau and Lifshitz, Mechanics, sec. 37."""
    a, b, c = INERTIA
    twice_energy, square = start1**2 / a + start3**2 / c, start1**2 + start3**2
    first, last = twice_energy * c - square, square - twice_energy * a
    assert square > twice_energy * b
    rate = np.sqrt((c - b) * last / (a * b * c))
    sn, cn, dn, _ = ellipj(rate * time, (b - a) * first / ((c - b) * last))
    return np.array(
        [
            a * np.sqrt(first / (a * (c - a))) * cn,
            b * np.sqrt(first / (b * (c - b))) * sn,
            c * np.sqrt(last / (c * (c - a))) * dn,
        ]
    )


@pytest.mark.campaign
def test_solvers_of_every_system_compile_as_users_have_them(system, tmp_path, monkeypatch):
    """All methods, optimised, without a warning, and with the steps of their twins in NumPy.

    The ladder compiles them without optimisation, but for one of each kind.
    """
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path))
    loaded = load_folder(ROOT / "generated" / system)
    for kind in list_kinds(loaded.functions):
        for name, order in (("taylor", 12), ("dop853", 8), ("rk4", 4)):
            assert solvers.load(loaded, Choice(name=name, order=order, kind=kind), "c")


@pytest.mark.parametrize(
    ("options", "close"),
    [
        ({}, 1e-9),
        ({"method": "dop853"}, 1e-9),
        ({"method": "DOP853", "step": 0.05}, 1e-9),
        ({"method": "gauss8", "step": 0.05}, 1e-6),
        ({"method": "taylor", "step": 0.05}, 1e-9),
        ({"method": "rk4", "step": 0.005}, 1e-8),
        ({"target": "numpy"}, 1e-9),
        ({"target": "c-fast"}, 1e-9),
    ],
    ids=str,
)
def test_a_free_body_turns_as_the_elliptic_functions_say(options, close):
    """Each method at all samples, between its steps as well; the energy alone would not show it."""
    start = np.array([[0.5, 0.3], [0.0, 0.0], [1.0, 2.0]])
    found = rigid_body.simulate(start, (0, 20), {"I": INERTIA}, samples=301, **options)
    for member in range(2):
        expected = free_body(found.time, start[0, member], start[2, member])
        assert np.abs(found["Pi"][:, member] - expected).max() < close
    fixed = {"step": "dop853"} if "step" in options else {"": "taylor"}
    assert found.method == options.get("method", *fixed.values()).lower()
    assert (found.status == "OK").all()


@pytest.mark.parametrize(
    ("method", "tolerance", "order", "steps"),
    [
        ("rk4", None, 4, (0.02, 0.01)),
        ("dop853", None, 8, (0.25, 0.125)),
        ("taylor", 0.5, 6, (0.1, 0.05)),
        ("taylor", 0.01, 8, (0.16, 0.08)),
    ],
)
def test_methods_have_their_order(method, tolerance, order, steps):
    """Half a step makes the error 2^order times smaller, against the elliptic functions."""
    source = np.random.default_rng(0)
    one, three = source.uniform(0.4, 1.0, 40), source.uniform(1.8, 2.6, 40)
    start = np.array([one, np.zeros(40), three])
    expected = np.stack([free_body(4.0, *start[[0, 2], n]) for n in range(40)], axis=-1)
    named = {} if tolerance is None else {"rtol": tolerance}
    errors = []
    for step in steps:
        found = rigid_body.simulate(
            start, (0, 4), {"I": INERTIA}, method=method, step=step, samples=1, **named
        )
        errors.append(np.sqrt(((found.state[..., 0] - expected) ** 2).mean()))
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.1, errors


def test_the_order_follows_from_the_tolerance():
    """The order is max(4, ceil(4 - ln(rtol)/2)), and no more than the table of 1/k has."""
    assert [choose_order(rtol) for rtol in (2, 1e-6, 1e-10, 1e-40)] == [4, 12, 16, 40]


@pytest.mark.parametrize(
    "options",
    [{}, {"method": "dop853"}, {"step": 0.1}, {"method": "rk4", "step": 0.1}],
    ids=str,
)
@pytest.mark.parametrize("target", ["c", "numpy"])
def test_a_batch_has_the_bits_of_single_runs(options, target):
    """Of any shape, with parameters of each member, for any number of threads."""
    source = np.random.default_rng(3)
    state, mass = source.normal(size=(6, 5, 7)), source.uniform(1, 2, (5, 7))
    run = {"t": (0, 3), "samples": 11, "target": target, **options}
    alone, shared = (
        heavy_top.simulate(state, parameters={"m": mass}, threads=n, **run) for n in (1, 3)
    )
    assert np.array_equal(alone.state, shared.state)
    assert alone.state.shape == (6, 5, 7, 11)
    assert alone["energy"].shape == alone["Pi2"].shape == (5, 7, 11)
    for place in ((0, 0), (2, 3), (4, 6)):
        one = heavy_top.simulate(state[(slice(None), *place)], parameters={"m": mass[place]}, **run)
        assert np.array_equal(one.state, alone.state[(slice(None), *place)])
        member = alone.member(*place)
        assert np.array_equal(member.state, one.state)
        assert member.drift == one.drift == {n: d[place] for n, d in alone.drift.items()}
        assert one.steps == alone.steps[place]
    end = heavy_top.simulate(state, parameters={"m": mass}, **run | {"samples": 1})
    assert np.array_equal(end.state[..., 0], alone.state[..., -1])
    # the drift at the end alone, though no sample has the start
    values = alone["energy"][..., [0, -1]]
    expected = np.abs(values[..., 1] - values[..., 0]) / np.abs(values).max(axis=-1)
    assert np.array_equal(end.drift["energy"], expected)
    assert end.drift["energy"].max() > 0


@pytest.mark.parametrize(
    "options", [{}, {"method": "dop853"}, {"method": "dop853", "step": 0.1}], ids=str
)
def test_neighbours_and_their_order_change_no_bit(options, monkeypatch):
    """Any number of members in any order, in slices and calls of any length, by any threads.

    Some of them end early, so that lanes are given another member on the way.
    """
    source = np.random.default_rng(8)
    state = source.normal(size=(6, 37)) * np.geomspace(0.1, 30, 37)
    run = {"t": (0, 2), "samples": 5, **options}
    if "step" not in options:
        run["max_steps"] = int(np.median(heavy_top.simulate(state, **run).steps))
    whole = heavy_top.simulate(state, threads=1, **run)
    assert len(set(whole.status)) > 1
    for members, threads, work, slice_ in (
        (source.permutation(37), 1, 1, 256),
        (source.permutation(37), 4, 3, 4),
        (np.arange(37)[::-1], 3, 7, 1),
        (np.arange(9), 2, 16, 8),
        (np.array([5, 5, 36, 0]), 8, 2, 256),
        (np.array([36]), 2, 5, 256),
    ):
        monkeypatch.setattr(CStepper, "first_work", work)
        monkeypatch.setattr(march, "SLICE", slice_)
        found = heavy_top.simulate(state[:, members], threads=threads, **run)
        assert found.state.tobytes() == np.ascontiguousarray(whole.state[:, members]).tobytes()
        for name in ("steps", "rejected", "time_reached", "status"):
            assert np.array_equal(getattr(found, name), getattr(whole, name)[members]), name


def test_the_targets_have_the_same_bits():
    """Exact C and NumPy, where nothing beyond sqrt is called."""
    state = np.random.default_rng(4).normal(size=(6, 13))
    for options in ({}, {"method": "dop853"}, {"step": 0.2}, {"method": "rk4", "step": 0.2}):
        a, b = (heavy_top.simulate(state, (0, 2), target=t, **options) for t in ("c", "numpy"))
        assert np.array_equal(a.state, b.state)
        assert np.array_equal(a.steps, b.steps)
        assert np.array_equal(a.rejected, b.rejected)


def test_a_member_that_fails_leaves_its_neighbours_alone():
    """A fall from rest at distance 1 ends in the centre at t = pi/sqrt(8); a circle goes on."""
    state = np.array([[1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]], float).T
    found = kepler.simulate(state, (0, 10), samples=101, max_steps=5000)
    assert found.status.tolist() == ["STEP_UNDERFLOW", "OK", "NONFINITE"]
    assert found.time_reached[0] == pytest.approx(np.pi / np.sqrt(8), abs=1e-9)
    assert np.isnan(found.state[:, 0, -1]).all()
    assert np.isfinite([*found.final.values()])[:, 0].all()
    assert np.abs(found["r1"][1] - np.cos(found.time)).max() < 1e-9
    assert "2 of 3 trajectories did not reach the end" in found.message
    assert found.message in repr(found)
    fall = found.member(0)
    assert fall.status == "STEP_UNDERFLOW"
    assert fall.time[-1] == found.time_reached[0]
    few = kepler.simulate(state[:, 1], (0, 1000), max_steps=7)
    assert (few.status, few.steps) == ("MAX_STEPS", 7)
    assert "raise max_steps" in few.message
    bad = kepler.simulate(state[:, :2], (0, 10), max_steps=3)
    assert [Status[name] for name in bad.status] == [Status.MAX_STEPS] * 2


@pytest.mark.parametrize("method", ["taylor", "dop853"])
@pytest.mark.parametrize("kind", ["previous", "linear"])
def test_inputs_over_time_and_of_each_member(tmp_path, method, kind):
    """The pendulum on a moving pivot, hand-typed, by another integrator between the knots."""
    folder = tmp_path / "driven"
    system = build_driven(rendered(PENDULUM, name="driven").texts, folder)
    knots, torque = np.array([0.0, 0.7, 1.1, 2.5]), np.array([0.5, -1.0, 2.0, 0.0])
    a, w, g = 0.1, 5.0, 9.81

    def rates(t, x, u):
        v = x[1] + a * w * np.sin(w * t) * np.sin(x[0])
        return [v, u(t) - a * w * np.sin(w * t) * np.cos(x[0]) * v - g * np.sin(x[0])]

    def follow(start, u, ends):
        run = solve_ivp(rates, ends, start, "DOP853", args=(u,), rtol=1e-12, atol=1e-12)
        return run.y[:, -1]

    start = np.array([[0.3, 1.0], [0.0, -0.5]])
    found = system.simulate(start, (0, 2), None, (knots, [torque], kind), method=method)
    assert found["u"].shape == (2, 1001)
    held = kind == "previous"
    for member in range(2):
        expected = start[:, member]
        for first, last in ((0.0, 0.7), (0.7, 1.1), (1.1, 2.0)):
            fixed = torque[np.searchsorted(knots, first, side="right") - 1]

            def u(t, fixed=fixed):
                return fixed if held else np.interp(t, knots, torque)

            expected = follow(expected, u, (first, last))
        assert np.abs(found.state[:, member, -1] - expected).max() < 1e-8
    own = system.simulate(start, (0, 2), None, {"u": [0.5, -1.0]}, method=method)
    for member, value in enumerate((0.5, -1.0)):
        expected = follow(start[:, member], lambda _, value=value: value, (0.0, 2.0))
        assert np.abs(own.state[:, member, -1] - expected).max() < 1e-8
        one = system.simulate(start[:, member], (0, 2), None, {"u": value}, method=method)
        assert np.array_equal(one.state, own.state[:, member])
        assert np.array_equal(own["energy"][member], one["energy"])
        assert own.member(member)["u"].tolist() == one["u"].tolist()


def test_a_member_that_stops_has_the_inputs_of_that_time():
    """Between two samples, where a straight line has neither of their values."""
    whole = drive_members(samples=4)
    assert whole.status.tolist() == ["OK", "OK", "NONFINITE"]
    stopped = whole.member(2)
    end = stopped.time[-1]
    assert end not in whole.time
    assert stopped["f"].tolist() == np.interp(stopped.time, [0, 0.5, 1], [1, 3, 2]).tolist()
    assert stopped["f"].shape == stopped.time.shape


def test_elementary_functions_agree_but_for_roundings(tmp_path):
    """A pendulum with friction, in sin, cos and exp: C, NumPy and SciPy."""
    system = pendulum(tmp_path)
    a, b, c = (
        system.simulate([1.0, 0.5], (0, 5), **options)
        for options in ({}, {"target": "numpy"}, {"method": "scipy:DOP853"})
    )
    assert np.abs(a.state - b.state).max() < 1e-11
    assert np.abs(a.state - c.state).max() < 1e-8


@pytest.mark.parametrize(
    ("choice", "old", "new"),
    [
        (Choice(name="taylor", order=5), "1.0 / 3,", "1.0 / 4,"),
        (Choice(name="rk4", order=4), "half = h * 0.5", "half = h * 0.25"),
        (Choice(name="dop853", order=8), "rest = 1.0 - part", "rest = 2.0 - part"),
    ],
    ids=lambda value: str(value),
)
def test_a_solver_that_computes_something_else_is_refused(tmp_path, choice, old, new):
    """The text is spoiled; the twin stands in where a person calls it."""
    system = build(POLE, tmp_path)
    solvers.load(system, choice, "c")
    path = system.folder / "solver.c"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    for target in ("c", "c-fast"):
        with pytest.raises(CrossCheckError, match=f"wrong solver was compiled: {choice.name} of"):
            solvers.load(system, choice, target)
    with pytest.warns(CompilerWarning, match="NumPy solvers are used instead"):
        found = system._solvers.get(choice, "c")
    assert isinstance(found, solvers.NumpyStepper)


#: Sweeps of the midpoint diverge where h is more than 2e-5, and of the second one than 2e-12.
FAST = one_variable("fast", "1 - 100000*y", "-100000")
FASTER = one_variable("faster", "1 - 1000000000000*y", "-1000000000000")
MIDPOINT = Choice(name="midpoint", order=2)


def spoil_rises(system):
    """Make the C of the midpoint go half as far: steps that are not solved do not show it."""
    path = system.folder / "solver.c"
    right = "rise[i] = arc->length * rates[i];"
    assert right in path.read_text()
    path.write_text(path.read_text().replace(right, right.replace("=", "= 0.5 *")))


def test_solvers_are_compared_by_steps_that_are_solved(tmp_path):
    """Steps are shorter where those of other systems are not."""
    system = build(FAST, tmp_path)
    solvers.load(system, MIDPOINT, "c")
    spoil_rises(system)
    with pytest.raises(CrossCheckError, match="wrong solver was compiled: midpoint of fast"):
        solvers.load(system, MIDPOINT, "c")


def test_a_comparison_of_failures_alone_is_told(tmp_path, monkeypatch):
    """Nothing was found wrong, and nothing was solved; the cache of other runs knows it as good."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    with pytest.warns(CompilerWarning, match="midpoint of faster .* every step that was compared"):
        solvers.load(build(FASTER, tmp_path), MIDPOINT, "c")


def test_every_shipped_system_is_compared_by_steps_that_are_solved():
    """Attitudes are near rotations and domains are met; one method tells for all."""
    folders = sorted(each.parent for each in (ROOT / "generated").glob("*/certificate.json"))
    compared = [
        system
        for system in map(load_folder, folders)
        if not isinstance(system, FamilySystem) and not system.stepwise
    ]
    assert len(compared) > 80
    for system in compared:
        choice = Choice(name="rk4", order=4)
        run = comparison._probe(system, choice, 2.0**-7, comparison.MOST_STEPS)
        solvers.NumpyStepper(system, choice).advance(run, 0, comparison.PROBES, 100)
        whole = (run.status == Status.OK) & (run.steps == 3)
        assert whole.sum() > comparison.PROBES // 3, system.name


def test_ctrl_c_ends_a_run_and_its_threads():
    """At once, whatever is left: these runs would go on for a hundred million steps."""
    before = threading.active_count()

    def interrupt(*_):
        raise KeyboardInterrupt

    kept = signal.signal(signal.SIGALRM, interrupt)
    try:
        for threads in (1, 2):
            rigid_body.simulate(np.ones((3, 32)), (0, 1), step=0.5)
            signal.setitimer(signal.ITIMER_REAL, 0.2)
            with pytest.raises(KeyboardInterrupt):
                rigid_body.simulate(
                    np.ones((3, 32)),
                    (0, 1e5),
                    step=1e-3,
                    samples=1,
                    max_steps=10**8,
                    threads=threads,
                )
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, kept)
    assert threading.active_count() == before


def test_progress_is_told_up_to_the_end():
    """Parts grow to 1; a call that fails ends the run."""
    told = []
    rigid_body.simulate([1.0, 0.2, 0.5], (0, 2000), step=1e-3, samples=1, max_steps=10**8,
                        progress=told.append)  # fmt: skip
    assert told == sorted(told)
    assert told[-1] == 1.0

    def fail(_):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        rigid_body.simulate([1.0, 0.2, 0.5], (0, 1), progress=fail)


def test_what_is_of_one_trajectory_is_refused_for_a_batch():
    """With the spelling that works."""
    found = rigid_body.simulate(np.ones((3, 2)), (0, 1), samples=3)
    for call in (found.plot, found.summary, found.trace):
        with pytest.raises(KernelArgumentError, match=r"Take solution.member\(0\)"):
            call()
    with pytest.raises(KernelArgumentError, match="is not in a batch"):
        found.member(2)
    assert found.member(-1).summary()["status"] == "OK"


def test_a_solution_says_which_method_it_was():
    """SciPy stands in where a generated solver does not apply, and is named."""
    start = [1.0, 0.3, -0.8]
    assert rigid_body.simulate(start, (0, 1)).method == "taylor"
    plain = rigid_body.simulate(start, (0, 1), target="python", samples=1)
    assert plain.method == "scipy:DOP853"
    assert plain.state.shape == (3, 1)
    assert plain.drift["energy"] == pytest.approx(0.0, abs=1e-9)


def test_an_ode_is_taken_by_another_integrator():
    """The rates and the Jacobian of a free body, for an implicit method."""
    ode = rigid_body.system.ode({"I": INERTIA})
    run = solve_ivp(ode.fun, (0, 5), [0.5, 0.0, 1.0], "Radau", jac=ode.jac, rtol=1e-9, atol=1e-11)
    assert np.abs(run.y[:, -1] - free_body(5.0, 0.5, 1.0)).max() < 1e-6
    expected = [[0, 1 / 3 - 1 / 2, 0], [1 - 1 / 3, 0, 1 - 1 / 3], [0, 1 / 2 - 1, 0]]
    found = ode.jac(0.0, np.array([1.0, 0.0, 1.0]))
    np.testing.assert_allclose(found, expected, atol=1e-15)
    with pytest.raises(KernelArgumentError, match="which all members share"):
        rigid_body.system.ode({"I": np.ones((3, 2))})


def test_inputs_of_an_ode_are_those_of_the_time(tmp_path):
    """Samples hold until the next, and are not guessed beyond the last."""
    system = build_driven(rendered(PENDULUM, name="driven").texts, tmp_path / "driven")
    ode = system.ode(None, ([0.0, 1.0, 2.0], [[1.0, 3.0, 5.0]], "previous"))
    slow = [ode.fun(t, [0.0, 0.0])[1] for t in (0.0, 0.9, 1.0, 2.0)]
    # at phi = p = 0 the momentum grows by the torque alone
    assert slow == [1.0, 1.0, 3.0, 5.0]
    with pytest.raises(KernelArgumentError, match=r"asked for at t = 2\.5"):
        ode.fun(2.5, [0.0, 0.0])


@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize("method", ["taylor", "dop853", "rk4"])
def test_members_end_where_each_leaves_the_domain(tmp_path, target, method):
    """On a circle of radius 1, q = sin(t + a) reaches 1/2 + cos(t + a) at a known angle.

    Samples before are on the circle and in the domain; a start below cos(a) = -3/4 is refused.
    """
    system = build(BOUNDED, tmp_path)
    angles = np.array([0.0, 0.5, -2.0, 3.8])
    start = np.array([np.sin(angles), np.cos(angles)])
    named = {"method": method, "target": target} | ({"step": 0.02} if method == "rk4" else {})
    with pytest.raises(KernelArgumentError, match=r"member 3: .*condition two"):
        system.simulate(start, (0, 4), **named)
    found = system.simulate(start[:, :3], (0, 4), samples=401, **named)
    edge = np.pi / 4 + np.arcsin(np.sqrt(1 / 8))  # sin - cos = sqrt(2) sin(. - pi/4) = 1/2
    assert (found.status == "DOMAIN").all()
    close = 1e-6 if method == "rk4" else 1e-9
    assert np.abs(found.time_reached - (edge - angles[:3])).max() < close
    q, p = found.state
    inside = np.isfinite(q)
    assert (inside.sum(axis=-1) == np.floor(found.time_reached * 100 + 1)).all()
    assert np.abs((q**2 + p**2)[inside] - 1).max() < 1e-15
    assert (0.5 + p - q)[inside].min() > 0
    one = system.simulate(start[:, 0], (0, 4), **named)
    assert one.status == "DOMAIN"
    assert "the condition one does not hold after t = 1.1467" in one.message


@pytest.mark.parametrize(
    ("rtol", "options", "method"),
    [
        (1e-6, {}, "dop853"),
        (1e-6, {"dense": True}, "taylor"),
        (1e-6, {"method": "taylor"}, "taylor"),
        (1e-13, {}, "taylor"),
    ],
)
def test_the_faster_method_is_chosen_for_the_same_errors(rtol, options, method):
    """By operations; the tolerances that it is given are told, and errors are as small."""
    state = np.random.default_rng(3).normal(size=(28, 4))
    run = {"t": (0.0, 2.0), "parameters": np.arange(1.0, 9.0), "samples": 1, "target": "numpy"}
    found = so8_body.simulate(state, rtol=rtol, atol=rtol, **run, **options)
    assert found.method == method
    share = 2.0**-12 if method == "dop853" else 1.0
    assert found.settings["rtol"] == pytest.approx(rtol * share)
    assert found.settings["atol"] == pytest.approx(rtol * share)
    exact = so8_body.simulate(state, rtol=1e-15, atol=1e-15, method="taylor", **run)
    assert np.abs(found.state - exact.state).max() < rtol


def test_small_systems_and_branch_points_are_of_taylor():
    """A step of few products is cheap, and ``dop853`` looks for no branch points."""
    assert heavy_top.simulate(np.ones(6), (0, 1), samples=1).method == "taylor"
    assert Costs(rows=28, products=168, operations=398, branches=False).is_dop853_faster(1e-8)
    assert not Costs(rows=28, products=168, operations=398, branches=True).is_dop853_faster(1e-8)


def test_no_step_is_judged_by_less_than_rounding():
    """A component at zero of a large state; and nothing depends on the other members."""
    state = np.random.default_rng(3).normal(size=(28, 3)) * np.array([1e6, 1.0, 1e-6])
    state[0] = 0.0
    run = {"t": (0, 1e-6), "parameters": np.arange(1.0, 9.0), "samples": 1, "target": "numpy"}
    many = so8_body.simulate(state, **run)
    assert many.method == "dop853"
    assert (many.status == "OK").all()
    assert many.steps.max() < 200
    alone = so8_body.simulate(state[:, 1], **run)
    assert alone.state.tobytes() == many.member(1).state.tobytes()
