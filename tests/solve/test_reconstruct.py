"""Attitude and place along a motion: known paths, where they begin, and what is refused."""

from shutil import copytree

import numpy as np
import pytest

from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.events import Event
from coadjoint.solve.folders import load_folder
from coadjoint.solve.reconstruct import turn_upright
from coadjoint.solver_kinds import RECONSTRUCTION
from coadjoint.systems import chaplygin_sleigh, rigid_body
from tests.kernels import COMPILER
from tests.rolling import BALL, DISK, FOLLOWED_SLEIGH, built

needs_compiler = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")

#: Local errors of 1e-10 per step add up to less than this over the times below.
TOLERANCE = 1e-8


def turned(q, v):
    """O v for each sample, by the matrix of a quaternion as books print it."""
    w, x, y, z = q
    return np.array(
        [
            (w * w + x * x - y * y - z * z) * v[0]
            + 2 * (x * y - w * z) * v[1]
            + 2 * (x * z + w * y) * v[2],
            2 * (x * y + w * z) * v[0]
            + (w * w - x * x + y * y - z * z) * v[1]
            + 2 * (y * z - w * x) * v[2],
            2 * (x * z - w * y) * v[0]
            + 2 * (y * z + w * x) * v[1]
            + (w * w - x * x - y * y + z * z) * v[2],
        ]
    )


@pytest.fixture(scope="module")
def ball():
    """A ball with its centre of mass elsewhere, sampled densely."""
    start = [1.0, 2.0, 3.0, 0.0, 0.6, 0.8]
    return built(BALL).simulate(
        start, (0, 2), samples=2001, target="numpy", reconstruct=True, rtol=1e-12
    )


def check_path(solution, velocity):
    """(x, y) is a line from the origin with a constant velocity."""
    assert np.abs(solution["x"]).max() > 0.1, "a path of one point is a line, too"
    for name, rate in zip("xy", velocity, strict=True):
        assert np.abs(solution[name] - rate * solution.time).max() < TOLERANCE


def test_a_homogeneous_ball_rolls_straight():
    """The contact moves by r omega x e_z; omega = O Omega, with O the turn of 0.6, 0.8 about e_x.

    O = ((1, 0, 0), (0, 0.8, -0.6), (0, 0.6, 0.8)) takes Gamma = (0, 0.6, 0.8) to e_z.
    """
    parameters = {"I": [2.0, 2.0, 2.0], "chi": [0.0, 0.0, 0.0], "r": 0.5}
    start = {"Omega": [1.0, 2.0, 3.0], "Gamma": [0.0, 0.6, 0.8]}
    found = built(BALL).simulate(
        start, (0, 5), parameters, samples=50, target="numpy", reconstruct=True
    )
    omega = (1.0, 0.8 * 2 - 0.6 * 3, 0.6 * 2 + 0.8 * 3)
    velocity = (0.5 * omega[1], -0.5 * omega[0])
    check_path(found, velocity)
    seen = turned(found["q"], found["Omega"])
    assert np.abs(seen - np.array(omega)[:, None]).max() < TOLERANCE  # constant in space
    with pytest.raises(AssertionError):
        check_path(found, (-velocity[0], -velocity[1]))


def test_the_attitude_turns_the_normal_upright(ball):
    """O Gamma = e_z along the whole run, and q stays at unit length by the tolerances."""
    up = turned(ball["q"], ball["Gamma"])
    assert np.abs(up - [[0.0], [0.0], [1.0]]).max() < TOLERANCE
    assert 0 < ball.attitude_drift["q"] < 1e-10
    assert ball.summary()["attitude_drift"] == ball.attitude_drift
    assert "|q|^2 - 1" in repr(ball)


def check_centre(solution, s):
    """d(contact + O s)/dt = O (Omega x s) by differences, and its height is Gamma . s."""
    q, Omega = solution["q"], solution["Omega"]
    contact = np.array([solution["x"], solution["y"], 0 * solution["x"]])
    centre = contact + turned(q, s)
    h = solution.time[1] - solution.time[0]
    slope = (8 * (centre[:, 3:-1] - centre[:, 1:-3]) - (centre[:, 4:] - centre[:, :-4])) / (
        12 * h
    )  # (3, T - 4)
    velocity = turned(q, np.cross(Omega.T, s.T).T)[:, 2:-2]
    np.testing.assert_allclose(slope, velocity, atol=1e-7)  # h^4 and 1e-16/h
    np.testing.assert_allclose(centre[2], (solution["Gamma"] * s).sum(axis=0), atol=TOLERANCE)


def test_the_centre_of_mass_moves_as_its_velocity_says(ball):
    """Contact plus O s moves by O Y; from another point of contact it would not."""
    chi = np.array([[0.1], [0.2], [0.3]])
    check_centre(ball, ball["Gamma"] + chi)
    with pytest.raises(AssertionError):
        check_centre(ball, 1.1 * ball["Gamma"] + chi)


def test_a_leaning_disk_rolls_on_a_circle():
    """Steady motion: the contact runs on a circle of radius r |w - p cot(theta)| sin(theta)/p.

    With p = Omega . e_s and w = Omega3, steady means I1 p^2 cot(theta) - (I3 + m r^2) p w =
    m g r cos(theta) (Holm 2011, 12.2.3); the disk turns about the vertical at n = p/sin(theta) and
    about its axis, relative to that, at w - n cos(theta).
    """
    (i1, i3), (m, r, g), (c, s), p = (0.25, 0.5), (1.0, 1.0, 9.81), (0.28, 0.96), -2.0
    w = (i1 * p**2 * c / s - m * g * r * c) / ((i3 + m * r * r) * p)
    n = p / s
    radius = r * abs((w - n * c) / n)
    period = 2 * np.pi / abs(n)
    found = built(BALL, *DISK).simulate(
        [p, 0.0, w, s, 0.0, c],
        [0, period / 2, period],
        {"I": [i1, i1, i3], "m": m, "r": r, "g": g},
        target="numpy",
        reconstruct=True,
    )
    across = np.hypot(found["x"], found["y"])
    assert abs(across[1] - 2 * radius) < 1e-6
    assert across[2] < 1e-6
    assert radius > 0.5


def follow_sleigh(time, speed, m=2.0, a=0.5):
    """Theta, x and y from (0, 0, 0) of a blade with I = 3 m a^2 that begins without moving forward.

    theta = 2 gd(u), u = k t, and x, y by integration (Chaplygin 1911): v = V tanh(u), omega =
    W / cosh(u) with k = m a V/(I + m a^2), W = 2 k: so cos(theta) is 2/cosh(u)^2 - 1, sin(theta) is
    2 sinh(u)/cosh(u)^2, and x' = v cos(theta), y' = v sin(theta) give x = (V/k) (tanh(u)^2 -
    log(cosh(u))), y = (V/k) (gd(u) - sinh(u)/cosh(u)^2).
    """
    k = m * a * speed / (4 * m * a**2)
    u = k * time
    gd = 2 * np.arctan(np.tanh(u / 2))
    across, along = gd - np.sinh(u) / np.cosh(u) ** 2, np.tanh(u) ** 2 - np.log(np.cosh(u))
    return {"theta": 2 * gd, "x": speed / k * along, "y": speed / k * across}


SLEIGH = {"m": 2.0, "I": 1.5, "a": 0.5}


@pytest.mark.parametrize(
    ("target", "options"),
    [
        ("numpy", {"method": "scipy:DOP853"}),
        ("numpy", {}),
        ("numpy", {"method": "dop853"}),
        pytest.param("c", {}, marks=needs_compiler),
        pytest.param("c", {"method": "rk4", "step": 1e-3}, marks=needs_compiler),
    ],
)
def test_the_blade_of_a_sleigh_follows_the_closed_form(target, options):
    """V = 1.5, by all who integrate."""
    found = built(FOLLOWED_SLEIGH).simulate(
        {"omega": 1.5, "v": 0.0},
        (0, 4),
        SLEIGH,
        samples=40,
        target=target,
        reconstruct={"y": 0.0},
        **options,
    )
    assert found.method == options.get("method", "taylor")
    assert np.abs(found["v"] - 1.5 * np.tanh(0.75 * found.time)).max() < TOLERANCE
    for name, expected in follow_sleigh(found.time, 1.5).items():
        assert np.abs(found[name] - expected).max() < TOLERANCE


@pytest.mark.parametrize("target", ["numpy", pytest.param("c", marks=needs_compiler)])
def test_members_are_reconstructed_as_each_alone(target, tmp_path):
    """Each from a place of its own, along its closed form; files keep what they hold."""
    speeds, places = np.array([1.5, 0.5, 2.0]), np.array([0.0, 10.0, -3.0])
    system, run = built(FOLLOWED_SLEIGH), {"parameters": SLEIGH, "target": target}
    state = np.array([speeds, 0 * speeds])
    found = system.simulate(
        state, (0, 4), samples=9, reconstruct={"x": places, "y": 0.0}, dense=True, **run
    )
    assert found["x"].shape == (3, 9)
    end = system.simulate(state, (0, 4), samples=1, reconstruct={"x": places, "y": 0.0}, **run)
    assert end.first("x").tolist() == places[:, None].tolist()
    for n, speed in enumerate(speeds):
        for name, expected in follow_sleigh(found.time, speed).items():
            begun = places[n] if name == "x" else 0.0
            assert np.abs(found[name][n] - begun - expected).max() < TOLERANCE
        one = system.simulate(
            state[:, n], (0, 4), samples=9, reconstruct={"x": places[n], "y": 0.0}, **run
        )
        for other in (found.member(n), found.at(found.time).member(n)):
            assert other.reconstructed.tobytes() == one.reconstructed.tobytes()
        assert end.member(n)["x"].tolist() == one["x"][-1:].tolist()
    end.to_csv(tmp_path / "end.csv")
    read = type(end).from_csv(system, tmp_path / "end.csv")
    assert read["x"].tobytes() == end["x"].tobytes()
    assert read.first("x").tolist() == places[:, None].tolist()


@needs_compiler
def test_c_and_numpy_reconstruct_the_same_bits():
    """A rolling ball by each method: what ends members early ends all of it."""
    system, source = built(BALL), np.random.default_rng(3)
    state = np.concatenate([source.normal(size=(3, 11)), source.normal(size=(3, 11))])
    state[3:] /= np.linalg.norm(state[3:], axis=0)
    for options in ({}, {"method": "dop853"}, {"method": "rk4", "step": 0.01, "max_steps": 60}):
        run = {"t": (0, 0.5), "samples": 3, "reconstruct": True, **options}
        one, other = (system.simulate(state, target=each, **run) for each in ("numpy", "c"))
        assert one.reconstructed.tobytes() == other.reconstructed.tobytes()
        assert one.state.tobytes() == other.state.tobytes()
        assert other.attitude_drift["q"] < 1e-9
        alone = system.simulate(state[:, 7], **run)
        assert alone.reconstructed.tobytes() == other.member(7).reconstructed.tobytes()
    short = system.simulate(
        state, (0, 0.5), samples=3, reconstruct=True, method="rk4", step=0.1, max_steps=5
    )
    assert (short.status == "OK").all()


def test_auto_with_a_step_follows_the_place_by_the_default_of_the_system():
    """A sleigh goes by its default, of order 4, and so does its place; DOP853 says where it is."""
    run = {"t": (0, 4), "samples": 5, "reconstruct": True}
    known = chaplygin_sleigh.simulate([1, 1], method="dop853", rtol=1e-13, **run)
    errors = []
    for step in (0.1, 0.05):
        found = [
            chaplygin_sleigh.simulate([1, 1], method="auto", step=step, target=each, **run)
            for each in (("numpy", "c") if COMPILER else ("numpy",))
        ]
        assert all(each.method == "gauss4" and each.settings["step"] == step for each in found)
        assert all(each.settings["chosen"].startswith("the default") for each in found)
        assert len({each.reconstructed.tobytes() for each in found}) == 1
        assert all(each.drift["energy"] < 1e-14 for each in found)
        errors.append(np.abs(found[0].reconstructed - known.reconstructed).max())
    assert errors[1] < 1e-6
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.3


def test_a_place_beyond_a_terminal_event_is_not_there():
    """What is reconstructed ends where the state does, and events may name it."""
    speeds = np.array([1.5, 0.4])
    found = built(FOLLOWED_SLEIGH).simulate(
        np.array([speeds, 0 * speeds]),
        (0, 4),
        SLEIGH,
        samples=9,
        target="numpy",
        reconstruct={"y": 0.0},
        events=Event("theta == 1.5", terminal=True, name="turned"),
    )
    when = 2 * np.arctanh(np.tan(0.375)) / 0.75  # gd(u) = 3/4
    assert found.status.tolist() == ["EVENT", "OK"]
    assert abs(found.time_reached[0] - when) < 1e-9
    assert np.isnan(found["x"][0]).tolist() == (found.time > when).tolist()
    last = follow_sleigh(when, 1.5)
    one = found.member(0)
    for name, value in last.items():
        assert abs(one[name][-1] - value) < TOLERANCE
        assert abs(found.events["turned"][name][0] - value) < TOLERANCE


def test_defaults_and_given_beginnings():
    """A declared default, zero without one, and what is asked for is stronger."""
    system = built(FOLLOWED_SLEIGH)
    first = system.simulate([1, 1], (0, 1), target="numpy", reconstruct=True, samples=2)
    assert [first[name][0] for name in ("theta", "x", "y")] == [0.0, 0.0, 3.0]
    given = system.simulate([1, 1], (0, 1), target="numpy", reconstruct={"x": -1}, samples=2)
    assert [given[name][0] for name in ("theta", "x", "y")] == [0.0, -1.0, 3.0]


def test_the_motion_itself_is_not_changed():
    """Without reconstruct the state alone is there, and the error says how to have more."""
    system = built(FOLLOWED_SLEIGH)
    alone = system.simulate([1, 1], (0, 1), target="numpy", samples=5)
    beside = system.simulate([1, 1], (0, 1), target="numpy", samples=5, reconstruct=True)
    assert np.abs(alone.state - beside.state).max() < TOLERANCE
    assert alone.reconstructed is None
    assert "x" not in alone
    assert "x" in beside
    assert beside.unit("x") == "m"
    with pytest.raises(KernelArgumentError, match=r"'x' is not in.* reconstruct=True for theta, x"):
        alone["x"]


@pytest.mark.parametrize("method", ["scipy:Radau", "scipy:LSODA"])
def test_methods_with_a_jacobian_work_too(method):
    """They take it by differences."""
    found = built(FOLLOWED_SLEIGH).simulate(
        [1, 1], (0, 1), target="numpy", samples=3, method=method, rtol=1e-6, reconstruct=True
    )
    assert found.status == "OK"
    assert abs(found["theta"][-1]) > 0.1


@pytest.mark.parametrize("method", ["discrete_gradient", "splitting"])
def test_methods_that_follow_no_rates_say_so(method):
    """They move states as a whole; the sleigh has the first one without what is reconstructed."""
    with pytest.raises(KernelArgumentError, match="it moves the state alone, and what is recon"):
        chaplygin_sleigh.simulate([1, 1], (0, 1), method=method, step=0.1, reconstruct=True)
    run = chaplygin_sleigh.simulate([1, 1], (0, 1), method="midpoint", step=0.1, reconstruct=True)
    assert run.drift["energy"] < 1e-15


def test_numpy_and_c_agree_in_every_bit():
    """The function of state and attitude, on an odd batch, with parameters of each member."""
    system, source = built(BALL), np.random.default_rng(5)
    state, own = source.normal(size=(12, 37)), source.uniform(0.5, 2, (9, 37))
    one = system.reconstruction(state, own, target="numpy")
    assert one.shape == (6, 37)
    assert not find_differing_bits(one, system.reconstruction(state, own, target="c")).any()
    assert np.abs(one).min() > 0
    named = {"Omega": state[:3], "Gamma": state[3:6], "q": state[6:10]}
    named |= {"x": state[10], "y": state[11]}
    assert not find_differing_bits(one, system.reconstruction(named, own)).any()


@pytest.mark.parametrize(
    "vector",
    [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.48, -0.6, 0.64), (1e-9, 0, -1), (3e-200, 1e-200, -1)],
)
def test_any_normal_is_turned_upright_the_shortest_way(vector):
    """O v = e_z with no turn about e_z, also close to and at the south pole."""
    v = np.array(vector, float) / np.linalg.norm(vector)
    q = turn_upright(v)
    assert np.abs(turned(q, v) - [0, 0, 1]).max() < 1e-15
    assert abs(np.linalg.norm(q) - 1) < 1e-15
    assert q[3] == 0
    assert q[0] >= 0


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"z": 1.0}, "'z' is not one of theta, x, y"),
        ({"x": np.nan}, "expected one finite value"),
        ({"x": [1.0, 2.0]}, "expected one finite value"),
        (3.0, "reconstruct is 3.0; expected True, False"),
    ],
)
def test_what_cannot_begin_so_is_refused(asked, said):
    """A message with the offending value."""
    with pytest.raises(KernelArgumentError, match=said):
        built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 1), target="numpy", reconstruct=asked)


def test_attitudes_have_length_1_and_normals_a_direction():
    """A quaternion of length 2, and a normal of length 0, are refused with their values."""
    system = built(BALL)
    start = [1.0, 0, 0, 0, 0, 1.0]
    with pytest.raises(KernelArgumentError, match=r"\[2.0, 0.0, 0.0, 0.0\], of length 2"):
        system.simulate(start, (0, 1), target="numpy", reconstruct={"q": [2, 0, 0, 0]})
    with pytest.raises(KernelArgumentError, match=r"the normal is \(0, 0, 0\) at the given state"):
        system.simulate([1.0, 0, 0, 0, 0, 0], (0, 1), target="numpy", reconstruct=True)


def test_a_system_that_reconstructs_nothing_says_so():
    """The free rigid body follows its momentum alone."""
    for chosen in ({}, {"method": "rk4", "step": 0.1}, {"method": "coadjoint_mean", "step": 0.1}):
        with pytest.raises(KernelArgumentError, match="rigid_body reconstructs nothing"):
            rigid_body.simulate([1, 2, 3], (0, 1), reconstruct=True, **chosen)


def test_the_end_alone_still_has_its_start():
    """What is reconstructed begins where it did, though no sample has it; a file keeps it."""
    run = {"target": "numpy", "reconstruct": True}
    whole = built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 2), samples=7, **run)
    end = built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 2), samples=1, **run)
    for name in ("x", "y", "theta"):
        assert end.first(name).tolist() == whole[name][:1].tolist()
        assert np.array_equal(end[name], whole[name][-1:])
    assert end.first("y") == 3


def test_starts_of_members_are_checked_before_anything_is_computed():
    """Other shapes, a length that is not 1 and a normal that is 0 are named with their member."""
    system, start = built(BALL), np.tile([[1.0], [0], [0], [0], [0], [1.0]], 3)
    turned = np.tile([[1.0], [0], [0], [0]], 3)
    turned[1, 2] = 1.0
    for asked, message in (
        ({"x": [1.0, 2.0]}, r"x has the shape \(2,\); expected one .*, or one for each of the mem"),
        ({"q": turned}, r"attitude q of member 2 begins at \[1.0, 1.0, 0.0, 0.0\], of length 1.41"),
        ({"y": [0, np.inf, 1]}, "expected one finite value"),
    ):
        with pytest.raises(KernelArgumentError, match=message):
            system.simulate(start, (0, 1), target="numpy", reconstruct=asked)
    start[5, 1] = 0
    with pytest.raises(KernelArgumentError, match=r"normal of member 1 is \(0, 0, 0\)"):
        system.simulate(start, (0, 1), target="numpy", reconstruct=True)


def test_a_folder_from_before_goes_the_old_way(tmp_path):
    """Without the files of these solvers, SciPy follows one, and the reason is said for a batch."""
    folder = tmp_path / "sample"
    copytree(built(FOLLOWED_SLEIGH).folder, folder)
    for file in RECONSTRUCTION.files:
        (folder / file).unlink()
    system = load_folder(folder)
    run = {"t": (0, 1), "samples": 3, "target": "numpy"}
    assert system.simulate([1, 1], reconstruct=True, **run).method == "scipy:DOP853"
    assert system.simulate([1, 1], **run).method == "taylor"
    with pytest.raises(KernelArgumentError, match="generated without them: run `coadjoint regen"):
        system.simulate(np.ones((2, 3)), reconstruct=True, **run)


#: A body whose energy is no quadratic form: nothing but its element keeps the momentum in space.
BODY = """
title = "A body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum", default = [0.4, -0.3, 1.2] }
Omega = { role = "velocity" }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6 + Pi1^4/8 + Pi2*Pi3/7"
[reconstruction]
q = { attitude = "quaternion" }
[observables]
spatial = "rotate(q, Pi)"
"""


@needs_compiler
@pytest.mark.parametrize(
    ("method", "steps", "newton"),
    [
        ("coadjoint_mean", 100_000, False),
        ("coadjoint_mean4", 10_000, False),
        ("coadjoint_mean", 10_000, True),
        ("spherical_midpoint", 30_000, False),
        ("spherical_midpoint4", 10_000, False),
        ("spherical_midpoint", 10_000, True),
    ],
)
def test_the_element_of_a_step_moves_the_attitude(method, steps, newton):
    """Up to 10^5 steps keep the momentum in space to rounding, with the bits of NumPy."""
    body = built(BODY)
    given = {"method": method, "newton": newton, "step": 0.1, "samples": 5, "reconstruct": True}
    run = body.simulate({}, (0, steps / 10), **given)
    assert run.status == "OK"
    assert np.ptp(run["spatial"], axis=1).max() < 5e-14
    assert run.attitude_drift["q"] < 1e-14
    short = [body.simulate({}, (0, 5), target=target, **given) for target in ("c", "numpy")]
    for one, other in zip(*[(each.state, each["q"]) for each in short], strict=True):
        assert not find_differing_bits(one, other).any()


def test_the_midpoint_does_not_keep_the_momentum_in_space():
    """The same body."""
    run = built(BODY).simulate({}, (0, 100), method="midpoint", step=0.1, reconstruct=True)
    assert np.ptp(run["spatial"], axis=1).max() > 1e-5


def test_what_is_carried_along_nonlinearly_has_no_element():
    """The angle about the third axis moves by its velocity, whatever it is."""
    text = BODY.replace('q = { attitude = "quaternion" }', 'angle = "Omega3*cos(angle)"')
    text = text[: text.index("[observables]")]
    with pytest.raises(
        KernelArgumentError,
        match=r"coadjoint_mean. with a fixed step is a generated solver, which does not",
    ):
        built(text).simulate(
            {}, (0, 1), method="coadjoint_mean", step=0.1, reconstruct=True, target="numpy"
        )


#: Momenta in space of other motions by method: each turns by an element of its own form.
SPACE = {
    "top": (
        "spherical_midpoint",
        ("one",),
        """
title = "A top"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum", default = [0.4, -0.3, 1.2] }
Omega = { role = "velocity" }
Gamma = { role = "advected", representation = "vector", default = [0.6, 0, 0.8] }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6 + Pi1^4/8 + Gamma3 + Gamma1^2"
[reconstruction]
q = { attitude = "quaternion" }
[observables]
one = "rotate(q, Gamma)"
""",
    ),
    "two bodies": (
        "spherical_midpoint",
        ("one", "other"),
        """
title = "Two bodies with a joint energy"
routes = ["lie-poisson"]
[algebra]
direct_sum = ["so(3)", "so(3)"]
[variables]
P = { role = "momentum", block = "rotation_1", default = [0.4, -0.3, 1.2] }
U = { role = "velocity", block = "rotation_1" }
Q = { role = "momentum", block = "rotation_2", default = [-0.7, 0.5, 0.2] }
V = { role = "velocity", block = "rotation_2" }
[hamiltonian]
h = "P1^2/2 + P2^2/4 + P3^2/6 + P1^4/8 + Q1^2/3 + Q2^2/5 + Q3^2/2 + P1*Q2/4"
[reconstruction]
R = { rate = "R*hat(U)", shape = [3, 3], default = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }
q = { rate = "qmul(q, vector(0, V1, V2, V3))/2", shape = [4], default = [1, 0, 0, 0] }
[observables]
one = "R*P"
other = "rotate(q, Q)"
""",
    ),
    "so(4)": (
        "isospectral_midpoint",
        ("one",),
        """
title = "A body in four dimensions"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
M = { role = "momentum", default = [0.4, -0.3, 1.2, 0.5, 0.2, -0.6] }
W = { role = "velocity" }
[hamiltonian]
h = "M1^2/2 + M2^2/4 + M3^2/6 + M4^2/3 + M5^2/7 + M6^2/5 + M1^4/8 + M2*M3/7"
[reconstruction]
R = { rate = "R*B", shape = [4, 4], default = IDENTITY }
[observables]
one = "R*A*transpose(R)"
[definitions]
A = '''rows(
    vector(0, M1, M2, M3), vector(-M1, 0, M4, M5),
    vector(-M2, -M4, 0, M6), vector(-M3, -M5, -M6, 0))'''
B = '''rows(
    vector(0, W1, W2, W3), vector(-W1, 0, W4, W5),
    vector(-W2, -W4, 0, W6), vector(-W3, -W5, -W6, 0))'''
""",
    ),
}


@needs_compiler
@pytest.mark.parametrize("name", SPACE)
def test_momenta_in_space_stay_by_the_element_of_a_step(name):
    """By spherical and isospectral midpoints, with the bits of NumPy; the midpoint loses them."""
    (method, names, text), given = SPACE[name], {"samples": 5, "reconstruct": True}
    text = text.replace("IDENTITY", "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]")
    system = built(text)

    def drift(run):
        assert run.status == "OK"
        return max(np.ptp(run[each], axis=-1).max() for each in names)

    assert drift(system.simulate({}, (0, 1000), method=method, step=0.1, **given)) < 2e-14
    assert drift(system.simulate({}, (0, 100), method="midpoint", step=0.1, **given)) > 1e-5
    one, other = (
        system.simulate({}, (0, 5), method=method, step=0.1, target=to, **given)
        for to in ("c", "numpy")
    )
    for rows in ("state", "reconstructed"):
        assert not find_differing_bits(getattr(one, rows), getattr(other, rows)).any()


@pytest.mark.parametrize("rate", ["vector(0, Omega1, Omega2, 2*Omega3)", "vector(0, Omega)*3"])
def test_what_turns_otherwise_is_not_carried_by_a_sphere(rate):
    """Rates that are no turn by the velocity; the coadjoint mean takes any linear ones."""
    rate = rate.replace("vector(0, Omega)", "vector(0, Omega1, Omega2, Omega3)")
    own = f'q = {{ rate = "qmul(q, {rate})/2", shape = [4], default = [1, 0, 0, 0] }}'
    system = built(BODY.replace('q = { attitude = "quaternion" }', own))
    given = {"t": (0, 1), "step": 0.1, "reconstruct": True, "target": "numpy"}
    with pytest.raises(KernelArgumentError, match="it moves the state alone, and what is recon"):
        system.simulate({}, method="spherical_midpoint", **given)
    assert system.simulate({}, method="coadjoint_mean", **given).status == "OK"
