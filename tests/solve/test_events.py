"""Events of simulations against closed forms: elliptic functions, falls, circles."""

import pickle
from functools import partial

import numpy as np
import pytest
from scipy.special import ellipk

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.events import Event
from coadjoint.systems import heavy_top, rigid_body
from tests.constrained import PENDULUM as ROD
from tests.driven_specs import PENDULUM, rendered
from tests.driven_specs import build as build_driven
from tests.solve.domains import STONE, built
from tests.solve.systems import FALL, OSCILLATOR, SWING, build

PI = np.pi
#: Methods for systems that no compiler has seen yet.
METHODS = [
    {"target": "numpy"},
    {"method": "dop853", "target": "numpy"},
    {"method": "scipy:DOP853"},
]
#: All that find events; those with fixed steps are as exact as their step makes them.
ALL = [
    {},
    {"method": "dop853"},
    {"method": "dop853", "step": 0.05},
    {"method": "rk4", "step": 0.005},
    *METHODS,
]


@pytest.fixture(scope="module")
def systems(tmp_path_factory):
    """The hand-typed systems by name."""
    folder = tmp_path_factory.mktemp("systems")
    return {context.name: build(context, folder) for context in (FALL, OSCILLATOR, SWING)}


@pytest.mark.parametrize("options", ALL, ids=str)
def test_a_free_body_crosses_its_plane_as_the_elliptic_functions_say(options):
    """Pi2 is a multiple of sn(k t): zero at 2 K/k, 4 K/k and so on, up and down in turn."""
    a, b, c = 1.0, 2.0, 3.0
    twice_energy, square = 0.5**2 / a + 1.0 / c, 0.5**2 + 1.0
    first, last = twice_energy * c - square, square - twice_energy * a
    rate = np.sqrt((c - b) * last / (a * b * c))
    between = 2 * ellipk((b - a) * first / ((c - b) * last)) / rate
    found = rigid_body.simulate([0.5, 0.0, 1.0], (0, 100), events="Pi2", **options)
    (events,) = found.events.values()
    count = int(100 / between)
    assert count > 6
    assert np.abs(events.time - between * np.arange(1, count + 1)).max() < 1e-7
    # it rises at the start, by Pi1 Pi3 (1/I1 - 1/I3), and falls at the first crossing
    assert events.direction.tolist() == [(-1) ** (n + 1) for n in range(count)]
    assert np.abs(events["Pi2"]).max() < 1e-12
    assert np.abs(np.abs(events["Pi1"]) - 0.5).max() < 1e-7
    assert events["energy"] == pytest.approx(twice_energy / 2, rel=1e-8)


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_a_pendulum_swings_with_its_period(systems, options):
    """4 K(sin^2(q0/2)): it is at rest every half of that, and at the bottom in between."""
    for start in (0.1, 1.5, 3.0):
        period = 4 * ellipk(np.sin(start / 2) ** 2)
        found = systems["swing"].simulate([start, 0.0], (0, 40), events=["p", "q == 0"], **options)
        halves = np.arange(1, int(40 / period * 2) + 1) * period / 2
        assert np.abs(found.events["p"].time - halves).max() < 1e-7
        quarters = np.arange(1, int(40 / period * 4) + 1, 2) * period / 4
        assert np.abs(found.events["q == 0"].time - quarters).max() < 1e-7
        assert found.status == "OK"


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_a_fall_ends_on_the_ground(systems, options):
    """At sqrt(2 y/g), with the speed sqrt(2 y g): the trajectory ends there, in a last sample."""
    ground = Event("y", direction=-1, terminal=True, name="ground")
    given = {"parameters": {"g": 9.81}, "samples": 11, "events": [ground, "v == -5"]}
    found = systems["fall"].simulate([20.0, 0.0], (0, 10), **given, **options)
    end = np.sqrt(40 / 9.81)
    assert found.status == "EVENT"
    assert found.message == f"the event 'ground' ended it at t = {found.time[-1]:.12g}"
    assert found.time[-1] == pytest.approx(end, abs=1e-12)
    assert found.time.tolist()[:-1] == [0.0, 1.0, 2.0]
    assert found["y"][-1] == pytest.approx(0, abs=1e-13)
    assert found["v"][-1] == pytest.approx(-np.sqrt(40 * 9.81), abs=1e-11)
    assert found.events["v == -5"].time == pytest.approx([5 / 9.81], abs=1e-13)
    # where it goes on from, it stands on the ground: that is no new event
    again = systems["fall"].simulate([0.0, 3.0], (0, 10), **given, **options)
    assert again.time[-1] == pytest.approx(6 / 9.81, abs=1e-13)
    up = systems["fall"].simulate(
        [20.0, 0.0], (0, 10), **(given | {"events": Event("y", 0, 1)}), **options
    )
    assert (up.status, len(up.events["y"])) == ("OK", 0)
    assert repr(up.events["y"]) == "<no event 'y'>"


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_a_double_root_is_found_and_filtered_by_direction(systems, options):
    """X = sin(t) touches 1 at pi/2 and every turn later, and crosses no value there."""
    asked = [
        "x == 1",
        "sin(t) = 1",
        Event("x", value=1.0, direction=1, name="up"),
        Event("x", value=1.0, direction=-1, name="down"),
        Event("x == 1.0001", name="beyond"),
        Event("x == 1.0001", tolerance=0.001, name="nearly"),
    ]
    found = systems["oscillator"].simulate([0.0, 1.0], (0, 20), events=asked, **options)
    touches = PI / 2 + 2 * PI * np.arange(3)
    for name in ("x == 1", "sin(t) = 1", "nearly"):
        assert np.abs(found.events[name].time - touches).max() < 1e-7
        assert found.events[name].direction.tolist() == [0, 0, 0]
    for name in ("up", "down", "beyond"):
        assert len(found.events[name]) == 0


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_a_number_of_occurrences_ends_a_trajectory(systems, options):
    """The third upward crossing of x, at 6 pi; events later than that are left out."""
    third = Event("x", direction=1, terminal=3)
    found = systems["oscillator"].simulate([0.0, 1.0], (0, 50), events=[third, "v"], **options)
    assert found.time_reached == pytest.approx(6 * PI, abs=1e-8)
    assert np.abs(found.events["x"].time - 2 * PI * np.arange(1, 4)).max() < 1e-8
    assert np.abs(found.events["v"].time - PI * (np.arange(6) + 0.5)).max() < 1e-8
    assert (found.time <= found.time_reached).all()


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_events_at_one_time_are_all_found(systems, options):
    """Where x is zero -3 x is; and of two that end the trajectory at one time either may."""
    asked = ["x", "v*x", "-x == 2*x", Event("x", terminal=2, name="second"),
             Event("v*x", terminal=4, name="fourth")]  # fmt: skip
    found = systems["oscillator"].simulate([0.0, 1.0], (0, 50), events=asked, **options)
    assert "'second' ended it" in found.message or "'fourth' ended it" in found.message
    assert found.time_reached == pytest.approx(2 * PI, abs=1e-8)
    assert np.abs(found.events["-x == 2*x"].time - found.events["x"].time).max() < 1e-12
    assert found.events["-x == 2*x"].direction.tolist() == [1, -1]
    assert np.abs(found.events["v*x"].time - PI / 2 * np.arange(1, 5)).max() < 1e-8


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_a_formula_that_is_undefined_on_the_way_says_since_when(systems, options):
    """sqrt(x) is defined while x = sin(t) is not negative: from 0 to pi, and from 2 pi on."""
    found = systems["oscillator"].simulate(
        [0.0, 1.0], (0, 10), events=["sqrt(x) == 0.5", "1/x == 0"], **options
    )
    first = np.arcsin(0.25)
    times = [first, PI - first, 2 * PI + first, 3 * PI - first]
    roots = found.events["sqrt(x) == 0.5"]
    assert np.abs(roots.time - times).max() < 1e-8
    assert roots.direction.tolist() == [1, -1, 1, -1]
    assert float(roots.undefined) == pytest.approx(PI, abs=1e-2)
    assert len(found.events["1/x == 0"]) == 0  # its sign changes at poles


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_events_of_inputs_and_of_a_declared_time(tmp_path, options):
    """A line crosses a level where it does; a jump across zero is an event where it jumps."""
    system = build_driven(rendered(PENDULUM, name="driven").texts, tmp_path / "driven")
    knots = [0.0, 1.0, 3.0]
    line = (knots, [[0.0, 2.0, -2.0]], "linear")
    found = system.simulate(
        [0.3, 0.0], (0, 3), None, line, events=["u - 1", "t*g/g == 1"], **options
    )
    assert np.abs(found.events["u - 1"].time - [0.5, 1.5]).max() < 1e-12
    assert found.events["t*g/g == 1"].time == pytest.approx([1.0], abs=1e-12)
    assert found.events["u - 1"].inputs == pytest.approx(np.ones((1, 2)), abs=1e-12)
    step = (knots, [[-1.0, 2.0, -2.0]], "previous")
    found = system.simulate([0.3, 0.0], (0, 3), None, step, events="u", **options)
    assert found.events["u"].time.tolist() == [1.0]
    assert found.events["u"].direction.tolist() == [1]


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_dense_output_has_the_states_of_samples(systems, options):
    """At any time of the span, its ends among them; to the bit for Taylor's method and SciPy."""
    run = {"state": [1.0, 0.5], "parameters": {"g": 2.0}, **options}
    times = np.sort(np.append(np.random.default_rng(2).uniform(0, 20, 50), [0.0, 20.0]))
    sampled = systems["swing"].simulate(t=times, **run)
    dense = systems["swing"].simulate(t=(0, 20), samples=1, dense=True, **run)
    found = dense.at(times)
    if found.method in ("taylor", "scipy:DOP853"):
        assert found.state.tobytes() == sampled.state.tobytes()
        assert found["energy"].tobytes() == sampled["energy"].tobytes()
        assert found.drift == sampled.drift
    assert np.abs(found.state - sampled.state).max() < 1e-13
    assert dense.at(times[::-1]).state.tobytes() == found.state[:, ::-1].tobytes()
    assert dense.at(7.0)["q"].shape == (1,)
    again = pickle.loads(pickle.dumps(dense))
    assert again.at(times).state.tobytes() == found.state.tobytes()
    assert dense.dense.nbytes > 0
    for wrong, offending in ((-1e-9, "t is -1e-09"), ([1, 21], "t is 21"), (np.nan, "t is nan")):
        with pytest.raises(KernelArgumentError, match=offending):
            dense.at(wrong)
    with pytest.raises(KernelArgumentError, match="in one axis"):
        dense.at([[1.0]])
    with pytest.raises(KernelArgumentError, match="dense=True"):
        sampled.at(1.0)


@pytest.mark.parametrize("options", METHODS, ids=str)
def test_dense_output_ends_where_an_event_ends_the_trajectory(systems, options):
    """At the event itself the state is that of the event; later times are refused."""
    found = systems["fall"].simulate(
        [20.0, 0.0], (0, 10), events=Event("y", terminal=True), dense=True, **options
    )
    end = found.time_reached
    assert np.abs(found.at(end).state[:, 0] - found.state[:, -1]).max() < 1e-14
    assert found.at(end / 2)["y"][0] == pytest.approx(20 - (end / 2) ** 2 / 2, abs=1e-11)
    with pytest.raises(KernelArgumentError, match="expected times from 0 to"):
        found.at(end + 1e-6)


@pytest.mark.parametrize(
    ("events", "offending"),
    [
        ("Pj == 1", "'Pj' is not declared"),
        ("Pi", "3-vector"),
        ("energy", "the motion conserves energy"),
        ("energy*I1 == 3", "the motion conserves energy"),
        ("I1 - 2", "it names no variable"),
        ("Pi1 > 0", "an event is where two sides are equal"),
        ("Pi1 = 1 = 2", "one equals sign"),
        ("= 2", "one equals sign"),
        (["Pi1", "Pi1"], "two events have the name 'Pi1'"),
        (3, "events is '3'"),
        ([3], "an event is '3'"),
        (Event("Pi1", direction=2), "direction is 2"),
        (Event("Pi1", terminal=-1), "terminal is -1"),
        (Event("Pi1", value=np.inf), "value is inf"),
        (Event("Pi1", tolerance=0.0), "tolerance is 0.0"),
        (Event("Pi1 == 2", value=1.0), "is an equation, and its value is 1.0"),
    ],
    ids=str,
)
def test_events_that_cannot_be_right_are_refused(events, offending):
    """Before anything is computed: the method, too, would be refused later."""
    with pytest.raises(KernelArgumentError) as caught:
        rigid_body.simulate([1.0, 2.0, 3.0], (0, 1), events=events)
    assert offending in str(caught.value)


def test_what_is_not_known_at_events_is_named():
    """With the names that are."""
    found = rigid_body.simulate([1.0, 0.1, 0.3], (0, 9), events="Pi1", method="scipy:DOP853")
    assert found.events["Pi1"]["Omega"].shape[0] == 3
    with pytest.raises(KernelArgumentError, match="'Pj' is not known at events"):
        found.events["Pi1"]["Pj"]


# -- many members ---------------------------------------------------------------------------------

SECTION = [Event("x", direction=1, name="up"), "x == 0.9", Event("v", terminal=5, name="turns")]


def test_members_have_as_many_events_as_their_motions(systems):
    """For x = sin(w t)/w: each member ends at its fifth turn, after two passages upwards."""
    rate = np.array([[0.5, 1.0, 3.0], [0.02, 2.0, 7.0]])
    start = np.array([np.zeros((2, 3)), np.ones((2, 3))])
    simulate = partial(systems["oscillator"].simulate, target="numpy")
    found = simulate(start, (0, 30), {"g": rate**2}, events=SECTION, samples=7, dense=True)
    turns = found.events["turns"]
    assert turns.count.tolist() == [[5, 5, 5], [0, 5, 5]]
    ends = 4.5 * PI / rate
    assert found.status.tolist() == [["EVENT"] * 3, ["OK", "EVENT", "EVENT"]]
    assert np.abs(np.where(ends < 30, found.time_reached - ends, 0)).max() < 1e-7
    assert found.message == "5 of 6 trajectories did not reach the end: 5 EVENT"
    assert found.events["up"].count.tolist() == [[2, 2, 2], [0, 2, 2]]
    # the amplitude is 1/w, which is above 0.9 for three of them
    assert found.events["x == 0.9"].count.tolist() == [[5, 5, 0], [1, 0, 0]]
    for place in np.ndindex(2, 3):
        own, at = turns.of(*place), (slice(None), *place)
        times = (np.arange(len(own)) + 0.5) * PI / rate[place]
        assert np.abs(own.time - times).max(initial=0) < 1e-7
        assert np.isnan(found["x"][place][found.time > found.time_reached[place]]).all()
        member = found.member(*place)
        assert member.events["turns"].time.tobytes() == own.time.tobytes()
        alone = systems["oscillator"].simulate(
            start[(slice(None), *place)],
            (0, 30),
            {"g": rate[place] ** 2},
            events=SECTION,
            samples=7,
        )
        assert alone.time_reached == member.time_reached
        assert alone.state.tobytes() == member.state.tobytes()
        assert (alone.steps, alone.rejected) == (member.steps, member.rejected)
        for name, each in alone.events.items():
            assert each.time.tobytes() == member.events[name].time.tobytes()
        assert member.at(0.3).state.tobytes() == found.at(0.3).state[at].tobytes()
    assert np.isnan(found.at(found.time_reached.max())["x"]).sum() == 5


@pytest.mark.parametrize("options", [{}, {"method": "dop853"}], ids=str)
def test_events_have_the_same_bits_for_any_threads_and_target(monkeypatch, options):
    """And for calls of any length, and records of any room."""
    state = np.random.default_rng(8).normal(size=(3, 37))
    asked = [Event("Pi2", direction=1, name="up"), "Pi1*Pi3 - 0.1",
             Event("Pi1", terminal=3, name="end")]  # fmt: skip

    def simulate(**given):
        return rigid_body.simulate(state, (0, 30), events=asked, samples=4, dense=True,
                                   **options, **given)  # fmt: skip

    first = simulate(threads=1)
    others = [simulate(threads=3), simulate(target="numpy")]
    monkeypatch.setattr("coadjoint.solve.march.RECORDED", 1)
    others.append(simulate(threads=2))
    assert 5 < (first.status == "EVENT").sum() < 37
    for other in others:
        for name in ("state", "steps", "rejected", "time_reached"):
            assert getattr(first, name).tobytes() == getattr(other, name).tobytes(), name
        for name, events in first.events.items():
            for part in ("time", "member", "direction", "state"):
                assert (
                    getattr(events, part).tobytes() == getattr(other.events[name], part).tobytes()
                )
        assert other.at([0.1, 3.3]).state.tobytes() == first.at([0.1, 3.3]).state.tobytes()
    assert len(first.events["up"]) > 50


@pytest.mark.parametrize("options", [{}, {"method": "dop853"}, {"method": "scipy:DOP853"}], ids=str)
def test_states_at_events_keep_the_constraints(options):
    """A particle on a rod swings as a pendulum: at its lowest point x is 0 and y is -1."""
    system = built(ROD)
    run = {"t": (0, 20), "target": "numpy", **options}
    start = [np.sin(1.5), -np.cos(1.5), 0.0, 0.0]
    found = system.simulate(start, events=["x", "u"], samples=41, dense=True, **run)
    quarter = ellipk(np.sin(0.75) ** 2)
    lowest = found.events["x"]
    assert np.abs(lowest.time - quarter * np.arange(1, 2 * len(lowest), 2)).max() < 1e-7
    assert np.abs(lowest["y"] + 1).max() < 1e-8
    for states in (lowest.state, found.events["u"].state, found.at([0.3, 7.7]).state):
        assert np.abs(system.constraint_residual(states, target="numpy")).max() < 1e-14
    assert np.abs(found.at(found.time).state - found.state).max() < 1e-12


@pytest.mark.parametrize("options", [{}, {"method": "dop853"}, {"method": "scipy:DOP853"}], ids=str)
def test_events_before_the_edge_of_a_domain_are_found(options):
    """A stone passes h = 1 after sqrt(2), and leaves the domain after 2: later events are none."""
    system = built(STONE)
    asked = ["h == 1", "h == -0.5", "t == 1.9"]
    found = system.simulate([2.0, 0.0], (0, 5), events=asked, target="numpy", dense=True, **options)
    assert found.status == "DOMAIN"
    assert found.events["h == 1"].time == pytest.approx([np.sqrt(2)], abs=1e-9)
    assert found.events["t == 1.9"]["h"] == pytest.approx([2 - 1.9**2 / 2], abs=1e-9)
    assert len(found.events["h == -0.5"]) == 0
    assert found.at(found.time_reached)["h"][0] == pytest.approx(0, abs=1e-9)
    early = system.simulate(
        [2.0, 0.0], (0, 5), events=Event("h == 1", terminal=True), target="numpy", **options
    )
    assert (early.status, early["h"][-1]) == ("EVENT", pytest.approx(1.0, abs=1e-12))


def test_events_are_the_changes_of_sign_of_samples():
    """Of formulas typed by hand in NumPy, on a grid so fine that none hides between its times."""
    state = np.random.default_rng(1).normal(size=(6, 6))
    state[3:] /= np.linalg.norm(state[3:], axis=0)
    times = np.linspace(0, 4, 8001)
    sampled = heavy_top.simulate(state, times)
    g, chi3, I2 = (
        sampled.parameters[heavy_top.PARAMETERS.components.index(name)]
        for name in ("g", "chi3", "I2")
    )
    swing = np.sin(np.sqrt(g / chi3) * times)
    pi, gamma, omega = sampled["Pi"], sampled["Gamma"], sampled["Omega"]
    values = {
        "Gamma3 - 0.1": gamma[2] - 0.1,
        "Pi1*Gamma2 - 0.3": pi[0] * gamma[1] - 0.3,
        "sin(sqrt(g/chi3)*t)*Gamma3 - Gamma1": swing * gamma[2] - gamma[0],
        "exp(Gamma1) - 1.5": np.exp(gamma[0]) - 1.5,
        "m*norm(cross(Pi, Gamma))/m - 1": np.linalg.norm(np.cross(pi, gamma, axis=0), axis=0) - 1,
        "energy - Pi2^2/I2": sampled["energy"] - pi[1] ** 2 / I2,
        "Omega1/(2 + Gamma3) == 0.2": omega[0] / (2 + gamma[2]) - 0.2,
    }
    found = heavy_top.simulate(state, (0, 4), events=list(values), samples=1).events
    for name, value in values.items():
        for member in range(6):
            change = np.flatnonzero(value[member, 1:] * value[member, :-1] < 0)
            own = found[name].of(member)
            assert len(own) == len(change), (name, member)
            assert ((times[change] <= own.time) & (own.time <= times[change + 1])).all()
            assert np.array_equal(own.direction, np.sign(np.diff(value[member])[change]))
        assert len(found[name]) >= 5, name
