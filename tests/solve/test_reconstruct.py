"""Attitude and place along a motion: known paths, where they begin, and what is refused."""

import numpy as np
import pytest

from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.reconstruct import turn_upright
from coadjoint.systems import rigid_body
from tests.rolling import BALL, DISK, FOLLOWED_SLEIGH, built

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


def test_the_blade_of_a_sleigh_follows_the_closed_form():
    """I = 3 m a^2: theta = 2 gd(u), u = k t, and x, y by integration (Chaplygin 1911).

    v = V tanh(u), omega = W / cosh(u) with k = m a V/(I + m a^2), W = 2 k: so cos(theta) is
    2/cosh(u)^2 - 1, sin(theta) is 2 sinh(u)/cosh(u)^2, and x' = v cos(theta), y' = v sin(theta)
    give x = (V/k) (tanh(u)^2 - log(cosh(u))), y = (V/k) (gd(u) - sinh(u)/cosh(u)^2).
    """
    V, m, a = 1.5, 2.0, 0.5
    inertia = 3 * m * a**2
    k = m * a * V / (inertia + m * a**2)
    found = built(FOLLOWED_SLEIGH).simulate(
        {"omega": 2 * k, "v": 0.0},
        (0, 4),
        {"m": m, "I": inertia, "a": a},
        samples=40,
        target="numpy",
        reconstruct={"y": 0.0},
    )
    u = k * found.time
    gd = 2 * np.arctan(np.tanh(u / 2))
    assert np.abs(found["v"] - V * np.tanh(u)).max() < TOLERANCE
    assert np.abs(found["theta"] - 2 * gd).max() < TOLERANCE
    assert np.abs(found["x"] - V / k * (np.tanh(u) ** 2 - np.log(np.cosh(u)))).max() < TOLERANCE
    assert np.abs(found["y"] - V / k * (gd - np.sinh(u) / np.cosh(u) ** 2)).max() < TOLERANCE


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
    with pytest.raises(KernelArgumentError, match="rigid_body reconstructs nothing"):
        rigid_body.simulate([1, 2, 3], (0, 1), reconstruct=True)


def test_the_end_alone_still_has_its_start():
    """What is reconstructed begins where it did, though no sample has it; a file keeps it."""
    run = {"target": "numpy", "reconstruct": True}
    whole = built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 2), samples=7, **run)
    end = built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 2), samples=1, **run)
    for name in ("x", "y", "theta"):
        assert end.first(name).tolist() == whole[name][:1].tolist()
        assert np.array_equal(end[name], whole[name][-1:])
    assert end.first("y") == 3
