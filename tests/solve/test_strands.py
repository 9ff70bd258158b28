"""Group elements along strands: transport, the holonomy and its trace as an integral."""

import importlib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from coadjoint.derive import derive
from coadjoint.errors import DerivationError, KernelArgumentError
from coadjoint.prove.declaration import find_connections
from coadjoint.solve import strands
from coadjoint.solve.strands import transport
from coadjoint.spec import read_spec_text
from tests.specs import emitted, shipped

LENGTH = 10.0


def hat(x):
    """The matrices of rotations of vectors ``(3, ...)``."""
    zero = np.zeros_like(x[0])
    return np.array([[zero, -x[2], x[1]], [x[2], zero, -x[0]], [-x[1], x[0], zero]])


def strains(count, batch=()):
    """A smooth strain on a circle about all three axes, other than any constant one."""
    s = 2 * np.pi * np.arange(count).reshape(-1, *[1] * len(batch)) / count
    parts = [0.3 + 0 * s, np.sin(s) / 4, np.cos(s) / 5]
    return np.array([np.broadcast_to(each, (count, *batch)) for each in parts])


def start(count):
    """Momenta and strains, row by row."""
    s = 2 * np.pi * np.arange(count) / count
    momenta = [0.3 * np.cos(s), 0.15 * np.sin(s), 0.5 + 0 * s]
    return np.concatenate([*momenta, *strains(count)])


def system(name, count):
    """A shipped system of so many points."""
    return importlib.import_module(f"coadjoint.systems.{name}").system.resize({"s": count})


# -- transport ----------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["left", "right"])
def test_transport_solves_its_equation(side):
    """psi_s = psi X on the left, X psi on the right, by SciPy; the other order differs."""

    def slope(s, psi):
        angle = 2 * np.pi * s / LENGTH
        X = hat(np.array([0.3, np.sin(angle) / 4, np.cos(angle) / 5]))
        psi = psi.reshape(3, 3)
        return (psi @ X if side == "left" else X @ psi).ravel()

    known = solve_ivp(slope, (0, LENGTH), np.eye(3).ravel(), rtol=1e-12, atol=1e-13)
    known = known.y[:, -1].reshape(3, 3)
    frames = transport(hat(strains(64)), LENGTH, side)
    np.testing.assert_allclose(frames[..., -1], known, atol=1e-9)
    other = transport(hat(strains(64)), LENGTH, "right" if side == "left" else "left")
    assert np.abs(other[..., -1] - known).max() > 0.05
    turned = np.einsum("ijs,kjs->iks", frames, frames)
    np.testing.assert_allclose(turned, np.eye(3)[..., None] + 0 * turned, atol=1e-13)


def between_ends(count):
    """The strain of R(s) = Rz(f) Rx(g), and R(0)^T R(s), at points of a line; not periodic."""
    s = np.linspace(0, LENGTH, count)
    f, df, g, dg = np.sin(s / 3), np.cos(s / 3) / 3, s**2 / 40, s / 20
    R = Rotation.from_euler("ZX", np.column_stack([f, g])).as_matrix()
    known = np.einsum("ij,sik->jks", R[0], R)
    return np.array([dg, df * np.sin(g), df * np.cos(g)]), known


@pytest.mark.parametrize("side", ["left", "right"])
def test_transport_between_ends_has_order_six(side):
    """Next to attitudes in closed form; of a circle it is another one."""
    errors = []
    for count in (17, 33):
        Xi, known = between_ends(count)
        known = known if side == "left" else known.transpose(1, 0, 2)
        X = hat(Xi) if side == "left" else hat(-Xi)
        frames = transport(X, LENGTH, side, has_ends=True)
        assert frames.shape == (3, 3, count)
        errors.append(np.abs(frames - known).max())
        around = transport(X, LENGTH, side)[..., :count]
        assert np.abs(around - known).max() > 1e-2
    assert errors[1] < 1e-6
    assert np.log2(errors[0] / errors[1]) > 5.5


@pytest.mark.parametrize("count", [2, 4])
def test_few_points_have_a_polynomial_of_their_own(count):
    """Of a strain that is linear along the line, about one axis: half the square."""
    s = np.linspace(0, 2.0, count)
    frames = transport(hat(np.array([s, 0 * s, 0 * s])), 2.0, has_ends=True)
    angle = np.arctan2(frames[2, 1], frames[1, 1])
    np.testing.assert_allclose(angle, s**2 / 2, atol=1e-14)


def test_a_uniform_strain_is_an_exponential():
    """psi(s) = exp(s X), for any matrices and a batch of lengths."""
    X = np.array([[0.3, 1.0], [-0.2, -0.1]])
    lengths = np.array([1.0, 2.5])
    frames = transport(np.broadcast_to(X[..., None, None], (2, 2, 5, 2)), lengths)
    for n, length in enumerate(lengths):
        for j in range(6):
            np.testing.assert_allclose(frames[:, :, j, n], expm(j / 5 * length * X), rtol=1e-13)


def test_transport_is_of_order_six():
    """For a field that few points have exactly, so that nothing but the steps is wrong."""
    known = transport(hat(strains(256)), LENGTH)[..., -1]
    errors = [
        np.abs(transport(hat(strains(n)), LENGTH)[..., -1] - known).max() for n in (8, 16, 32)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders[-1] == pytest.approx(6, abs=0.3)


# -- the holonomy of a motion -------------------------------------------------------------


def run(count):
    """A motion of the body with two times."""
    return system("two_time_body", count).simulate(
        start(count),
        (0.0, 10.0),
        samples=3,
        method="dop853",
        rtol=1e-10,
        atol=1e-11,
        target="numpy",
    )


def test_the_trace_of_the_holonomy_is_conserved_to_the_order_of_differences():
    """M_t = [M, Omega(0)]; with psi_s = -psi Xi the trace changes by more than a tenth."""
    changes, wrong = [], []
    for count in (64, 128):
        motion = run(count)
        traces = np.trace(motion.frames()[:, :, -1])
        changes.append(np.abs(traces - traces[0]).max())
        turned = np.trace(transport(hat(-motion["Xi"]), LENGTH)[:, :, -1])
        wrong.append(np.abs(turned - turned[0]).max())
        assert np.abs(traces).max() < 2.9
        assert np.abs(motion["Xi"][..., -1] - motion["Xi"][..., 0]).max() > 0.1
    assert changes[1] < 1e-5
    assert np.log2(changes[0] / changes[1]) == pytest.approx(4, abs=0.3)
    assert min(wrong) > 0.1


def slope_in_time(frames, spacing):
    """Derivatives of order 6 at inner samples, by central differences."""
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    count = frames.shape[-1]
    return (
        sum(
            w * (frames[..., 3 + k : count - 3 + k] - frames[..., 3 - k : count - 3 - k])
            for k, w in weights.items()
        )
        / spacing
    )


@pytest.mark.parametrize("name", ["spin_chain", "two_time_body"])
def test_all_points_move_by_their_velocities(name):
    """g^T dg/dt is Omega at each point, though the first one alone was followed in time."""
    own, samples = system(name, 64), 81
    given = {"method": "dop853", "rtol": 1e-11, "atol": 1e-12, "target": "numpy"}
    motion = own.simulate(start(64), (0.0, 4.0), samples=samples, **given)
    known = dict(zip(own.PARAMETERS.components, motion.parameters, strict=True))
    inertia, B = (np.array([known.get(f"{x}{n}", 0.0) for n in (1, 2, 3)]) for x in "IB")
    Omega = (motion["Pi"] - B[:, None, None] * motion["Xi"]) / inertia[:, None, None]
    frames = motion.frames(moving=True)
    np.testing.assert_array_equal(frames[..., 0], motion.frames()[..., 0])
    for point in (0, 20, 64):
        g = frames[:, :, point]
        found = np.einsum("jit,jkt->ikt", g[..., 3:-3], slope_in_time(g, 4.0 / (samples - 1)))
        expected = hat(Omega[:, point % 64, 3:-3])
        np.testing.assert_allclose(found, expected, atol=2e-5)
        assert np.abs(found - hat(Omega[:, 32, 3:-3])).max() > 0.05


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_first_point_is_followed_with_order_six(side):
    """dg/dt = g Omega on the left, Omega g on the right, by SciPy, at uneven times."""

    def turn(t):
        return hat(np.array([np.sin(t), 0.5 * np.cos(2 * t), 0.3 + 0 * t]))

    def slope(t, g):
        g = g.reshape(3, 3)
        return (g @ turn(t) if side == "left" else turn(t) @ g).ravel()

    errors = []
    for count in (21, 41):
        times = np.linspace(0, 2, count) ** 1.2
        known = solve_ivp(slope, (0, times[-1]), np.eye(3).ravel(), rtol=1e-12, atol=1e-13)
        found = strands._follow(turn(times), times, side)
        assert found.shape == (3, 3, count)
        errors.append(np.abs(found[..., -1] - known.y[:, -1].reshape(3, 3)).max())
        other = strands._follow(turn(times), times, {"left": "right", "right": "left"}[side])
        assert np.abs(other[..., -1] - known.y[:, -1].reshape(3, 3)).max() > 0.1
    assert errors[1] < 1e-7
    assert np.log2(errors[0] / errors[1]) > 5


def test_a_single_sample_leaves_nothing_to_follow():
    """And the message asks for more."""
    motion = system("spin_chain", 16).simulate(start(16), (0.0, 0.1), samples=1, target="numpy")
    assert motion.frames().shape[-1] == 1
    with pytest.raises(KernelArgumentError, match="Ask simulate for more samples"):
        motion.frames(moving=True)


def test_frames_of_a_batch_are_those_of_its_members():
    """``(n, n, N + 1, *batch, T)``, with a length of each."""
    own = system("two_time_body", 16)
    lengths = np.array([10.0, 12.0])
    given = {"L": lengths, "I": [3, 3, 2], "B": [0.5, 0.5, 0.25], "K": [1, 1, 1]}
    states = np.stack([start(16), start(16)], axis=-1)
    motion = own.simulate(states, (0.0, 1.0), samples=4, parameters=given, target="numpy")
    frames = motion.frames()
    assert frames.shape == (3, 3, 17, 2, 4)
    for n, length in enumerate(lengths):
        alone = transport(hat(motion["Xi"][:, :, n]), length)
        np.testing.assert_allclose(frames[:, :, :, n], alone, atol=1e-14)
    assert np.abs(frames[..., 0, 0] - frames[..., 1, 0]).max() > 0.1


@pytest.mark.parametrize(("name", "is_kept"), [("spin_chain_chiral", True), ("spin_chain", False)])
def test_the_chiral_model_has_an_integral_for_each_spectral_parameter(name, is_kept):
    """The trace of M of ``U = (Xi + lam Omega)/(1 - lam^2)``; others keep lam = 0."""
    motion = system(name, 64).simulate(
        start(64), (0.0, 5.0), samples=3, method="dop853", rtol=1e-9, atol=1e-10, target="numpy"
    )
    Omega = motion["Pi"] / (1 if is_kept else np.array([1, 2, 3]).reshape(3, 1, 1))
    for lam, kept in ((0.0, True), (0.5, is_kept), (-0.3, is_kept)):
        U = hat((motion["Xi"] + lam * Omega) / (1 - lam**2))
        traces = np.trace(transport(U, LENGTH)[:, :, -1])
        assert bool(np.abs(traces - traces[0]).max() < 1e-4) is kept


# -- what has frames ----------------------------------------------------------------------


def test_the_strain_is_that_of_the_spec():
    """Field, side, length, and its matrix."""
    (strand,) = find_connections(emitted("se3_strand"))
    assert (strand.name, strand.side, strand.length, strand.size) == ("X", "left", "L", 4)
    assert strand.entries[1, 2] == "-X1"
    assert strand.entries[2, 1] == "X1"
    assert strand.entries[2, 3] == "X6"
    assert [each.name for each in system("two_time_body", 8).connections] == ["Xi"]
    (right,) = find_connections(emitted("sp2_strand"))
    assert (right.name, right.side, right.size) == ("S", "right", 2)
    S, N = np.array([[0.3, -0.7], [-0.7, 1.1]]), np.array([[0.0, 2.0], [-2.0, 0.0]])
    known = {"S11": S[0, 0], "S12": 2 * S[0, 1], "S22": S[1, 1], "N12": 2.0}
    found = [[eval(right.entries[i, j], {}, known) for j in (0, 1)] for i in (0, 1)]
    np.testing.assert_allclose(found, N @ S)
    assert find_connections(emitted("kdv")) == ()


def test_traces_are_those_of_the_strain_and_of_the_pair_at_its_values():
    """With lam = (mu - 1)/(mu + 1), mu = 1/2 and 3 are lam = -1/3 and 1/2."""
    motion = system("spin_chain_chiral", 64).simulate(
        start(64), (0.0, 2.0), samples=3, method="dop853", rtol=1e-9, atol=1e-10, target="numpy"
    )
    traces = motion.traces()
    assert [*traces] == ["Xi", "L(1/2)", "L(3)"]
    np.testing.assert_array_equal(traces["Xi"], np.trace(motion.frames()[:, :, -1]))
    for name, lam in (("L(1/2)", -1 / 3), ("L(3)", 1 / 2)):
        U = hat((motion["Xi"] + lam * motion["Pi"]) / (1 - lam**2))
        expected = np.trace(transport(U, LENGTH)[:, :, -1])
        np.testing.assert_allclose(traces[name], expected, atol=1e-12)
        assert np.abs(traces[name] - traces[name][0]).max() < 1e-4
        assert np.abs(traces[name] - traces["Xi"]).max() > 0.1


def test_connections_of_the_pair_have_its_entries_at_the_values():
    """``(Xi + lam Pi)/(1 - lam^2)`` about each axis, lam = (mu - 1)/(mu + 1)."""
    Xi, Pi = np.array([0.3, -0.7, 1.1]), np.array([0.9, 0.2, -0.4])
    known = {f"{name}{n + 1}": x[n] for name, x in (("Xi", Xi), ("Pi", Pi)) for n in range(3)}
    found = {each.name: each for each in find_connections(emitted("spin_chain_chiral"))}
    assert [*found] == ["Xi", "L(1/2)", "L(3)"]
    for name, lam in (("L(1/2)", -1 / 3), ("L(3)", 1 / 2)):
        connection = found[name]
        assert (connection.side, connection.length, connection.size) == ("left", "L", 3)
        matrix = np.zeros((3, 3))
        for place, text in connection.entries.items():
            matrix[place] = eval(text, {}, known)
        np.testing.assert_allclose(matrix, hat((Xi + lam * Pi) / (1 - lam**2)), atol=1e-14)


def test_a_chain_with_ends_has_connections_of_its_strain_alone():
    """From one end to the other; nothing goes around it, of which a trace of L were conserved."""
    chain = emitted("spin_chain_chiral")
    open_space = replace(chain.spec.space, ends="fixed")
    assert open_space.has_ends
    spec = replace(chain.spec, space=open_space)
    (found,) = find_connections(
        SimpleNamespace(setting=chain.setting, spec=spec, exact=chain.exact, close=chain.close)
    )
    assert (found.name, found.has_ends) == ("Xi", True)
    around = find_connections(chain)
    assert [each.has_ends for each in around] == [False] * 3


def test_a_strand_on_symmetric_matrices_keeps_the_trace_of_the_product_with_n():
    """Of ``psi' = N S psi``, N the inverse of J: g_s g^-1 with S = J g_s g^-1 (Holm 2011, C.4).

    Without N the trace changes by more than a tenth, though S is what is declared.
    """
    strand = system("sp2_strand", 48).with_derivatives("fourier")
    w = 2 * np.pi * np.arange(48) / 48
    M = [np.cos(w) / 2, 0.3 * np.sin(w), 0.5 + 0 * w]
    S = [0.3 + 0.2 * np.cos(w), np.sin(w) / 2, 0.1 - 0.2 * np.sin(2 * w)]
    options = {"samples": 3, "method": "scipy:DOP853", "rtol": 1e-10, "atol": 1e-11}
    motion = strand.simulate(np.concatenate(M + S), (0.0, 1.0), **options)
    trace = motion.traces()["S"]
    np.testing.assert_allclose(trace, trace[0], rtol=1e-8)
    assert motion.frames().shape == (2, 2, 49, 3)
    dets = np.linalg.det(np.moveaxis(motion.frames(), (0, 1), (-2, -1)))
    np.testing.assert_allclose(dets, 1, atol=1e-8)
    J, S11, S12, S22 = np.array([[0, -1], [1, 0]]), *motion.state.reshape(6, 48, 3)[3:]
    declared = np.array([[S11, S12 / 2], [S12 / 2, S22]])
    known = np.einsum("ij,jk...->ik...", np.linalg.inv(J), declared)
    expected = np.trace(transport(known, 10.0, "right")[:, :, -1])
    np.testing.assert_allclose(trace, expected, rtol=1e-12)
    wrong = np.trace(transport(declared, 10.0, "right")[:, :, -1])
    assert np.ptp(wrong) > 0.1


def test_a_pole_of_the_pair_is_no_value():
    """L of the chiral model has 1/mu."""
    text = shipped("spin_chain_chiral").path.read_text(encoding="utf-8")
    first = derive(read_spec_text(text.replace("[0.5, 3]", "[3, 0]"), "chain.toml"), "lax")
    with pytest.raises(DerivationError, match=r"L has a pole at mu = 0.*Remove 0 from values"):
        find_connections(first)


def test_traces_of_a_batch_are_those_of_its_trajectories():
    """With lengths of their own."""
    chain, both = system("spin_chain_chiral", 16), np.stack([start(16), 0.7 * start(16)], axis=-1)
    options = {"samples": 2, "method": "dop853", "rtol": 1e-8, "target": "numpy"}
    lengths = np.array([[10.0, 12.0]])
    together = chain.simulate(both, (0.0, 0.5), lengths, **options).traces()
    for n in range(2):
        alone = chain.simulate(both[:, n], (0.0, 0.5), lengths[:, n], **options).traces()
        for name, trace in alone.items():
            np.testing.assert_allclose(together[name][n], trace, atol=1e-12)


def test_what_has_no_connection_has_no_traces():
    """The advice: a strain on matrices, or values of a pair."""
    motion = system("kdv", 32).simulate(
        np.ones(32), (0.0, 0.02), samples=2, method="rk4", step=0.01, target="numpy"
    )
    with pytest.raises(KernelArgumentError, match=r"no connection.*values = \[0\.5\]"):
        motion.traces()


def test_what_is_no_strand_has_no_frames():
    """The message says what a strand is, and what is declared so is one."""
    motion = system("kdv", 32).simulate(
        np.ones(32), (0.0, 0.02), samples=2, method="rk4", step=0.01, target="numpy"
    )
    with pytest.raises(KernelArgumentError, match=r'kdv has no strain.*role = "strain"') as caught:
        motion.frames()
    assert caught.value.parts["found"] == "kdv"
    assert find_connections(emitted("spin_chain"))
