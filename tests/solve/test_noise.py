"""Noise: random words and normals, orders, closed forms, what methods keep, and bad input."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.special import ndtri

from coadjoint.errors import CrossCheckError, KernelArgumentError
from coadjoint.pipeline import render
from coadjoint.solve import stochastic
from coadjoint.solve.choices import Choice
from coadjoint.solve.events import Event
from coadjoint.solve.folders import load_texts
from coadjoint.solve.normals import draw_normals, minus_log, normal_of, philox
from coadjoint.solve.solvers import load as load_solver
from coadjoint.solve.steps import Lanes
from coadjoint.solve.stochastic import Heun, Midpoint, find_bound
from coadjoint.systems import rigid_body
from coadjoint.systems import stochastic_rigid_body as body
from tests.kernels import COMPILER
from tests.prove.test_noise import DRIVEN, TORQUE
from tests.specs import shipped, spec

TARGETS = ["numpy", *(["c"] if COMPILER else [])]
START = np.array([0.6, 0.0, 0.8])
ONES = 0xFFFFFFFF


@pytest.mark.parametrize(
    ("counter", "key", "words"),
    [
        ([0] * 4, (0, 0), "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        ([ONES] * 4, (ONES, ONES), "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        (
            [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344],
            (0xA4093822, 0x299F31D0),
            "d16cfe09 94fdcceb 5001e420 24126ea1",
        ),
    ],
)
def test_words_are_those_of_random123(counter, key, words):
    """The known answers that its authors publish for philox4x32 with 10 rounds."""
    assert " ".join(f"{int(word):08x}" for word in philox(counter, key)) == words


def test_normals_are_the_inverse_of_the_distribution():
    """Against 40 digits in the middle and both tails, and SciPy everywhere."""
    source = np.random.default_rng(0)
    tails = 2.0 ** -np.arange(2.0, 54.0)
    some = np.concatenate([source.random(150), tails, 1 - tails[:-1], [0.075, 0.925, 2.0**-53]])
    with mpmath.workdps(40):
        for p, found in zip(some.tolist(), normal_of(some).tolist(), strict=True):
            x = mpmath.findroot(lambda t, p=p: mpmath.log(mpmath.ncdf(t) / p), float(ndtri(p)))
            assert abs(found - x) <= 1.5e-15 * abs(x) + 1e-17
    many = source.random(100_000)
    assert np.allclose(normal_of(many), ndtri(many), rtol=2e-15, atol=1e-16)
    assert np.allclose(minus_log(many), -np.log(many), rtol=1e-15, atol=0)


def test_numbers_of_different_places_are_independent():
    """Mean, variance, and correlation of seeds, members, steps and processes, within 4.5 sigma."""
    members, steps = (each.ravel() for each in np.indices((400, 100)).astype(np.uint64))
    draws = [
        draw_normals(1, members, steps, 0),
        draw_normals(2, members, steps, 0),
        draw_normals(1, members, steps, 1),
        draw_normals(1, members + np.uint64(400), steps, 0),
        draw_normals(1, members, steps + np.uint64(2**32), 0),
    ]
    size = draws[0].size
    assert np.abs(np.mean(draws, axis=1)).max() < 4.5 / math.sqrt(size)
    off = np.corrcoef(draws) - np.eye(len(draws))
    assert np.abs(off).max() < 4.5 / math.sqrt(size)
    assert np.abs(np.var(draws, axis=1) - 1).max() < 4.5 * math.sqrt(2 / size)


# -- orders ---------------------------------------------------------------------------------------

INERTIA = np.array([1.0, 2.0, 3.0])[:, np.newaxis]


def turn(sigmas):
    """Rates of a body, and ``Pi x sigma`` for each process, as textbooks have them."""

    def rates(lanes, after, x):
        return np.cross(x, x / INERTIA, axis=0)

    def fields(lanes, after, x):
        turned = [np.cross(x, np.array(s)[:, np.newaxis], axis=0) for s in sigmas]
        return np.stack(turned, axis=1)

    return {"rates": rates, "fields": fields}


def follow(kind, system, increments, end):
    """Members that take given increments, ``(w, steps, N)``, in equal steps."""
    processes, steps, members = increments.shape
    h = end / steps

    class Given(kind):
        def find_noise(self, lanes, h, process):
            return increments[process, int(lanes.steps[0])] / h

    method = Given(**system, size=h, seed=0, bound=math.inf)
    x = np.repeat(START[:, np.newaxis], members, axis=1)
    none, place = np.zeros((0, members)), np.arange(members, dtype=np.uint64)
    for n in range(steps):
        lanes = Lanes(
            state=x,
            time=np.full(members, n * h),
            end=np.full(members, math.inf),
            step=np.zeros(members),
            parameters=np.zeros(0),
            driving=none,
            slopes=none,
            member=place,
            steps=np.full(members, n, np.uint64),
        )
        attempt = method.try_step(lanes)
        assert attempt.accepted.all()
        x = attempt.state
    assert processes == len(system["fields"](lanes, 0, x)[0])
    return x


def find_strong_order(kind, sigmas, members, finest, least):
    """The slope of the mean error at the end against the step, over three octaves."""
    counts = least * 2 ** np.arange(4)
    source = np.random.default_rng(5)
    fine = source.normal(size=(len(sigmas), finest, members)) * math.sqrt(1 / finest)
    exact = follow(kind, turn(sigmas), fine, 1.0)
    errors = []
    for steps in counts.tolist():
        coarse = fine.reshape(len(sigmas), steps, -1, members).sum(axis=2)
        end = follow(kind, turn(sigmas), coarse, 1.0)
        errors.append(np.linalg.norm(end - exact, axis=0).mean())
    return np.polyfit(np.log2(counts), -np.log2(errors), 1)[0]


APART = [(0.8, 0, 0), (0, 0.6, 0), (0, 0, 0.7)]


@pytest.mark.parametrize("kind", [Heun, Midpoint])
@pytest.mark.parametrize(("sigmas", "order"), [(APART, 0.5), ([(0.4, -0.3, 0.5)], 1.0)])
def test_the_strong_order_is_half_where_processes_do_not_commute(kind, sigmas, order):
    """Three axes; and one process, which commutes with itself."""
    assert abs(find_strong_order(kind, sigmas, 100, 256, 4) - order) < 0.15


@pytest.mark.campaign
@pytest.mark.parametrize("kind", [Heun, Midpoint])
@pytest.mark.parametrize(("sigmas", "order"), [(APART, 0.5), ([(0.4, -0.3, 0.5)], 1.0)])
def test_the_strong_order_to_a_tenth(kind, sigmas, order):
    """With more paths and a finer reference."""
    assert abs(find_strong_order(kind, sigmas, 1000, 4096, 16) - order) < 0.1


def draw_mean(method, h, members, seed, sigma=1.0, end=1.0):
    """The mean end of paths of a ball that noise turns about all axes."""
    start = np.repeat(START[:, np.newaxis], members, axis=1)
    ball = {"I": [2.0, 2.0, 2.0], "sigma": [sigma] * 3}
    run = body.simulate(start, (0, end), ball, method=method, step=h, seed=seed, samples=1)
    return run.state[:, :, -1].mean(axis=1)


@pytest.mark.parametrize("method", ["heun", "midpoint"])
def test_the_mean_of_a_ball_decays(method):
    """``E[Pi] = Pi0 exp(-sigma^2 t)`` for equal moments and noise about all axes."""
    members = 4000
    found = draw_mean(method, 0.02, members, seed=3, sigma=0.7)
    expected = START * math.exp(-0.49)
    # components have variances below 1; the bias of the step is below a hundredth
    assert np.abs(found - expected).max() < 4.5 / math.sqrt(members) + 0.01
    assert np.abs(found - START).max() > 0.2


@pytest.mark.campaign
@pytest.mark.parametrize("method", ["heun", "midpoint"])
def test_the_weak_order_is_one(method):
    """The error of that mean falls in proportion to the step; longer ones have short tails."""
    exact, sizes = START * math.exp(-1.0), [0.125, 0.0625, 0.03125]
    errors = [np.linalg.norm(draw_mean(method, h, 4_000_000, seed=11) - exact) for h in sizes]
    slope = np.polyfit(np.log2(sizes), np.log2(errors), 1)[0]
    assert abs(slope - 1) < 0.15


@pytest.mark.campaign
def test_a_body_with_double_bracket_and_noise_comes_to_rest_in_the_mean():
    """The density on the sphere in the end is ``exp(-2 theta h/sigma^2)`` (Arnaudon, 2018)."""
    theta, sigma, members, steps = 1.0, 0.8, 4000, 400
    system = turn(np.diag([sigma] * 3))
    free = system["rates"]

    def rates(lanes, after, x):
        turned = free(lanes, after, x)
        return turned + theta * np.cross(x, turned, axis=0)

    increments = np.random.default_rng(2).normal(size=(3, steps, members)) * math.sqrt(0.02)
    end = follow(Midpoint, system | {"rates": rates}, increments, 0.02 * steps)
    points = np.random.default_rng(3).normal(size=(3, 200_000))
    points /= np.linalg.norm(points, axis=0)
    energy = (points**2 / INERTIA).sum(axis=0) / 2
    weights = np.exp(-2 * theta * energy / sigma**2)
    expected = (weights * energy).sum() / weights.sum()
    found = ((end**2 / INERTIA).sum(axis=0) / 2).mean()
    assert abs(found - expected) < 0.01
    assert abs(energy.mean() - expected) > 0.02  # without the bracket all points are alike


def test_one_process_turns_a_ball_about_its_axis():
    """The closed form of each path: a rotation by ``sigma W(t)``, with the very numbers drawn."""
    steps, seed, member = 64, 9, 3
    turned = {"I": [1.0, 1.0, 1.0], "sigma": [0.3, 0.0, 0.0]}
    start = np.repeat(START[:, np.newaxis], 5, axis=1)
    run = body.simulate(start, (0, 1), turned, step=1 / steps, seed=seed, samples=1)
    place, made = np.full(steps, member, np.uint64), np.arange(steps, dtype=np.uint64)
    bound = find_bound("midpoint", 1 / steps)
    W = np.clip(draw_normals(seed, place, made, 0), -bound, bound).sum() / math.sqrt(steps)
    angle = -0.3 * W  # dPi = Pi x e1 sigma o dW turns against e1
    expected = [
        START[0],
        START[1] * math.cos(angle) - START[2] * math.sin(angle),
        START[1] * math.sin(angle) + START[2] * math.cos(angle),
    ]
    assert np.abs(run.state[:, member, -1] - expected).max() < 2e-4
    assert abs(W) > 0.05


# -- what methods keep, and bits ------------------------------------------------------------------


def test_the_midpoint_keeps_the_quadratic_casimir_and_heun_does_not():
    """To rounding, and by far not; each says so."""
    runs = {
        m: body.simulate(START, (0, 20), method=m, step=0.02, seed=1) for m in ("midpoint", "heun")
    }
    assert runs["midpoint"].drift["casimir1"] < 1e-12
    assert runs["heun"].drift["casimir1"] > 1e-5
    assert runs["midpoint"].settings["keeps"].startswith("linear and quadratic integrals")
    assert runs["heun"].settings["keeps"].startswith("linear integrals")
    assert "heun keeps linear integrals" in repr(runs["heun"])
    assert "energy" not in runs["midpoint"].drift


@pytest.mark.parametrize("method", ["heun", "midpoint"])
@pytest.mark.parametrize("target", TARGETS)
def test_a_path_has_the_same_bits_in_any_company(method, target):
    """Other members, threads and targets change nothing; another seed and step do."""
    start = np.random.default_rng(0).normal(size=(3, 40))
    options = {"method": method, "step": 0.125, "samples": 5}
    whole = body.simulate(start, (0, 2), seed=4, target="numpy", **options).state
    again = body.simulate(start, (0, 2), seed=4, target=target, threads=3, **options).state
    assert np.array_equal(whole, again)
    first = body.simulate(start[:, :7], (0, 2), seed=4, target=target, threads=1, **options).state
    assert np.array_equal(whole[:, :7], first)
    alone = body.simulate(start[:, 0], (0, 2), seed=4, target=target, **options).state
    assert np.array_equal(whole[:, 0], alone)
    other = body.simulate(start, (0, 2), seed=5, target=target, **options).state
    assert not np.array_equal(whole, other)


def test_equal_starts_have_paths_of_their_own():
    """Members differ by their place alone."""
    start = np.repeat(START[:, np.newaxis], 3, axis=1)
    end = body.simulate(start, (0, 1), step=0.1, seed=0, samples=1).state[:, :, 0]
    assert len(np.unique(end[0])) == 3


def test_samples_at_the_ends_of_steps_are_the_path():
    """Every fourth step, and all of them."""
    options = {"step": 0.125, "seed": 6}
    all_of_them = body.simulate(START, (0, 4), samples=33, **options).state
    some = body.simulate(START, (0, 4), samples=9, **options).state
    assert np.allclose(all_of_them[:, ::4], some, rtol=0, atol=1e-15)


def test_a_file_keeps_the_seed(tmp_path):
    """The largest one, which no signed number holds, and what the method keeps."""
    run = body.simulate(START, (0, 1), step=0.1, seed=2**64 - 1, samples=11)
    run.to_csv(tmp_path / "run.csv")
    again = type(run).from_csv(body.system, tmp_path / "run.csv")
    assert again.settings == {name: x for name, x in run.settings.items() if name != "chosen"}
    assert again.settings["seed"] == 2**64 - 1


def test_a_checkpoint_goes_on_with_the_same_seed_alone(tmp_path):
    """The same call goes on; another seed is told."""
    options = {"step": 0.1, "samples": 11, "checkpoint": tmp_path / "run.npz"}
    one = body.simulate(START, (0, 1), seed=1, **options)
    assert np.array_equal(body.simulate(START, (0, 1), seed=1, **options).state, one.state)
    with pytest.raises(KernelArgumentError, match="its seed is 1, and that of this run is 2"):
        body.simulate(START, (0, 1), seed=2, **options)


IMPLICIT = ["midpoint", "spherical_midpoint", "coadjoint_mean"]


@pytest.mark.parametrize("method", IMPLICIT)
@pytest.mark.parametrize("step", [4.0, 40.0, 1e200])
def test_a_step_that_is_not_solved_ends_the_path(method, step):
    """No wrong number is returned, and the reason is told, also where sweeps leave all bounds."""
    fast = {"I": [1.0, 2.0, 3.0], "sigma": [0.0, 0.0, 0.0]}
    ended = {}
    for target in TARGETS:
        options = {"step": step, "seed": 0, "samples": 5, "target": target, "method": method}
        run = body.simulate([3.0, 2.0, 1.0], (0, 4 * step), fast, **options)
        ended[target] = (run.status, run.message, len(run))
    assert len(set(ended.values())) == 1
    status, message, _ = ended["numpy"]
    assert status == "NOT_SOLVED"
    assert message.startswith(f"the equation of a step of {step:.12g} was not solved")


def test_a_step_that_is_not_finite_is_no_equation():
    """Of Heun's method, which has none."""
    for target in TARGETS:
        run = body.simulate(START, (0, 3e200), method="heun", step=1e200, seed=0, target=target)
        assert (run.status, run.sweeps) == ("NONFINITE", None)


@pytest.mark.parametrize("method", IMPLICIT)
def test_sweeps_are_counted(method):
    """Alike by all targets, more where steps are longer; at the least two in each step."""
    start = np.random.default_rng(0).normal(size=(3, 7))
    counts = {}
    for step in (0.0625, 0.25):
        runs = [
            body.simulate(start, (0, 2), method=method, step=step, seed=1, target=target)
            for target in TARGETS
        ]
        for run in runs:
            assert np.array_equal(run.sweeps, runs[0].sweeps)
        counts[step] = runs[0].sweeps / runs[0].steps
    assert (counts[0.0625] > 2).all()
    assert (counts[0.25] > counts[0.0625]).all()


@pytest.mark.skipif(COMPILER is None, reason="needs a compiler")
@pytest.mark.parametrize("method", IMPLICIT)
def test_wrong_counts_of_sweeps_are_refused(method):
    """By the twin, before any run: sweeps of lanes that are done count as well."""
    texts, right = dict(render(shipped("stochastic_rigid_body")).texts), "choose(done, all(0.0), "
    assert texts["solver.c"].count(right + "all(1.0))") == 1
    texts["solver.c"] = texts["solver.c"].replace(right, "(")
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="differs from its"):
        load_solver(system, Choice(name=method, order=1, is_noisy=True), "c")


def test_the_default_is_what_keeps_most():
    """On spheres their midpoint; where a torque takes the orbits the midpoint, which says so."""
    run = body.simulate(START, (0, 1), step=0.1, seed=1)
    assert run.settings["method"] == "spherical_midpoint"
    assert "its orbits are those of one sphere" in run.settings["chosen"]
    named = body.simulate(START, (0, 1), step=0.1, seed=1, method="spherical_midpoint")
    assert np.array_equal(run.state, named.state)
    assert "chosen" not in named.settings
    pushed = spec(DRIVEN, TORQUE, ('conserved = ["dot(Pi, Pi)"]\n', ""))
    with load_texts(render(pushed).texts) as driven:
        run = driven.simulate(START, (0, 1), step=0.1, seed=1)
    assert run.settings["method"] == "midpoint"
    assert run.settings["chosen"].startswith("it keeps no structure")


#: Events of a path: a component, and a formula that is bent along a straight line.
SOUGHT = ["Pi1 == 0", "Pi1^2 + Pi2^2 == 0.5"]


@pytest.mark.parametrize("method", ["heun", "midpoint"])
def test_events_lie_on_the_straight_lines_between_ends_of_steps(method):
    """Where these meet the level, and with the same bits for any target and threads."""
    start = np.repeat(START[:, None], 20, axis=1)
    again = {"method": method, "step": 0.05, "seed": 1, "samples": 81, "events": SOUGHT}
    runs = [
        body.simulate(start, (0, 4), target=target, threads=threads, **again)
        for threads, target in enumerate(["numpy", *TARGETS], 1)
    ]
    run, *others = runs
    for name in SOUGHT:
        found = run.events[name]
        assert len(found) > 10
        for other in others:
            assert (found.time == other.events[name].time).all()
            assert (found.state == other.events[name].state).all()
    for member in range(20):
        Pi1, found = run.state[0, member], run.events[SOUGHT[0]].of(member).time
        (k,) = np.flatnonzero(Pi1[:-1] * Pi1[1:] < 0)[np.newaxis]
        part = Pi1[k] / (Pi1[k] - Pi1[k + 1])
        assert np.allclose(found, run.time[k] + part * np.diff(run.time)[k], rtol=0, atol=1e-12)
    found = run.events[SOUGHT[1]]
    assert np.allclose((found.state[:2] ** 2).sum(axis=0), 0.5, rtol=0, atol=1e-9)


def test_first_events_are_those_of_a_walk():
    """A ball that turns about its third axis by s W: the first passage of W through 1, by time 1.

    At the ends of steps its probability is that of the level 1 + 0.5826 sqrt(h), up to terms of
    the order h: D. Siegmund, Sequential Analysis (1985), section X.2. That of the whole path is
    0.317, which is missed by far.
    """
    ball, level = {"I": [1.0, 1, 1], "sigma": [0.0, 0.0, 0.5]}, np.sin(0.5)
    start, event = np.repeat(np.array([[1.0], [0], [0]]), 20_000, axis=1), Event("Pi2", level)
    options = {"step": 1 / 16, "seed": 3, "samples": 1, "events": event, "target": "numpy"}
    run = body.simulate(start, (0, 1), ball, method="heun", **options)
    (name,) = run.events
    part = (np.bincount(run.events[name].member, minlength=20_000) > 0).mean()
    assert part == pytest.approx(math.erfc((1 + 0.5826 / 4) / math.sqrt(2)), abs=0.012)
    ended = body.simulate(
        start, (0, 1), ball, method="heun", **{**options, "events": replace(event, terminal=True)}
    )
    assert (ended.status == "EVENT").mean() == part


def test_ordinary_integrators_are_refused():
    """They would follow the drift alone."""
    with pytest.raises(KernelArgumentError, match="expected a system without noise"):
        body.ode()


def test_the_bound_of_normals():
    """``sqrt(4 |log h|)``, at least 2, and none for Heun's method."""
    assert find_bound("midpoint", math.exp(-4)) == 4.0
    assert find_bound("midpoint", 5.0) == 2.0
    assert find_bound("heun", 0.01) == math.inf
    assert stochastic.SWEEPS == 100


BAD = [
    ({"step": None}, "expected step="),
    ({"seed": None}, "expected seed=, a whole number from 0 to 2^64 - 1"),
    ({"seed": -1}, "expected seed="),
    ({"seed": 2**64}, "expected seed="),
    ({"seed": 1.5}, "expected seed="),
    ({"seed": True}, "expected seed="),
    ({"method": "taylor"}, "expected one of 'auto', 'heun', 'spherical_midpoint'"),
    ({"method": "DOP853"}, "Wiener processes move the state of stochastic_rigid_body"),
    ({"method": "scipy:Radau"}, "expected one of 'auto', 'heun', 'spherical_midpoint'"),
    ({"rtol": 1e-6}, "expected no rtol or atol"),
    ({"dense": True}, "expected no dense"),
    ({"target": "python"}, "they are written for the targets c, c-fast and numpy"),
    ({"step": 1e-9}, "max_steps"),
]


@pytest.mark.parametrize(("changes", "said"), BAD)
def test_bad_input_is_refused_before_the_first_step(changes, said):
    """What was found and what is expected."""
    options = {"step": 0.1, "seed": 1, "samples": 11} | changes
    with pytest.raises(KernelArgumentError) as caught:
        body.simulate(START, (0, 1), **options)
    assert said in str(caught.value)


def test_samples_of_a_span_are_ends_of_steps():
    """The nearest ones, no more than there are, with values of the path; given times are kept."""
    few, all_of_them = (
        body.simulate(START, (0, 1), step=0.25, seed=1, samples=n) for n in (4, 1001)
    )
    assert all_of_them.time.tolist() == [0, 0.25, 0.5, 0.75, 1]
    assert few.time.tolist() == [0, 0.25, 0.75, 1]
    assert np.array_equal(few.state, all_of_them.state[:, [0, 1, 3, 4]])
    with pytest.raises(KernelArgumentError, match=r"sample at t = 0\.3 lies between the ends") as e:
        body.simulate(START, [0, 0.3, 1], step=0.25, seed=1)
    assert "give t as a pair" in str(e.value)


@pytest.mark.parametrize("options", [{"seed": 1}, {"method": "heun", "step": 0.1}])
def test_a_system_without_noise_refuses_seeds_and_methods_of_noise(options):
    """They would do nothing."""
    with pytest.raises(KernelArgumentError, match="rigid_body has none"):
        rigid_body.simulate(START, (0, 1), **options)


# -- inputs ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def driven():
    """A ball that a hand turns by u and a Wiener process by ``a s``, both about one axis."""
    with load_texts(render(spec(DRIVEN)).texts) as system:
        yield system


KNOTS = np.array([0.0, 0.5, 1.0])
#: Inputs, and the integral of u from 0 to 1; a is 2.
INPUTS = [
    ((KNOTS, np.array([[0.0, 1, 3], [2, 2, 2]]), "linear"), 1.25),
    ((KNOTS, np.array([[1.0, 3, 5], [2, 2, 2]]), "previous"), 2.0),
    ([1.0, 2.0], 1.0),
    (lambda time: [2 * time, 2.0], 1.0),
]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("method", ["midpoint", "heun"])
@pytest.mark.parametrize(("inputs", "turn"), INPUTS)
def test_a_driven_path_is_a_rotation(inputs, turn, method, target, driven):
    """The closed form: by the integral of u and by ``2 s W(t)``, with the very numbers drawn."""
    steps, seed = 64, 9
    run = driven.simulate(
        START,
        (0, 1),
        step=1 / steps,
        seed=seed,
        samples=1,
        method=method,
        target=target,
        inputs=inputs,
    )
    made = np.arange(steps, dtype=np.uint64)
    bound = find_bound(method, 1 / steps)
    drawn = draw_normals(seed, np.zeros(steps, np.uint64), made, 0)
    W = np.clip(drawn, -bound, bound).sum() / math.sqrt(steps)
    angle = turn + 2 * 0.3 * W
    expected = [START[0], START[2] * math.sin(angle), START[2] * math.cos(angle)]
    assert np.abs(run.state[:, -1] - expected).max() < 6e-3
    assert abs(2 * 0.3 * W) > 0.05
    if method == "midpoint":
        assert run.drift["casimir1"] < 1e-14


def test_inputs_change_at_the_ends_of_steps(driven):
    """A step that ended at a sample of inputs would have another increment; the advice works."""
    values, options = np.array([[1.0, 2, 3]] * 2), {"step": 0.25, "seed": 1, "samples": 1}
    with pytest.raises(KernelArgumentError, match=r"inputs change at t = 0\.6, between the ends"):
        driven.simulate(
            START,
            (0, 1),
            inputs=(np.array([0, 0.6, 1]), 2 * values * [1, 2, 3], "linear"),
            **options,
        )
    run = driven.simulate(START, (0, 1), inputs=(KNOTS, values * [1, 2, 3], "linear"), **options)
    assert np.isfinite(run.state).all()


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_driven_paths_have_the_same_bits_in_c(driven):
    """With samples of inputs, for members and threads."""
    start = np.random.default_rng(0).normal(size=(3, 13))
    options = {"step": 1 / 8, "seed": 4, "samples": 5, "inputs": INPUTS[0][0]}
    numpy, c = (driven.simulate(start, (0, 1), target=t, **options).state for t in ("numpy", "c"))
    assert np.array_equal(numpy, c)
