"""Newton's method for the equations of implicit steps: stiff motions, bits, refusals."""

from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import STRUCTURED
from coadjoint.solve import obstacles
from coadjoint.solve.methods import krylov, newton
from coadjoint.solve.methods.lie_poisson import LiePoisson
from coadjoint.systems import (
    heavy_top,
    heavy_top_damped,
    heisenberg_lattice,
    kepler,
    nambu_body,
    rigid_body,
    so4_body,
    stochastic_rigid_body,
)

#: A top whose friction is a thousand times faster than its fall.
HONEY = {"I": [1.0, 1.3, 2.0], "d": [1000.0, 900.0, 1100.0]}
LEANING = [0.0, 0.0, 0.0, 0.6, 0.0, 0.8]
TURNING = np.array([np.cos(1.1), 0.0, np.sin(1.1)])
ORBIT = [1.0, 0.0, 0.0, 0.0, 1.1, 0.2]
TOP = np.array([0.4, -0.3, 1.2, 0.6, 0.0, 0.8])


def run(system, state, end, method, step, **options):
    """The end of a run."""
    return system.simulate(state, (0, end), method=method, step=step, samples=1, **options)


def solve_both(system, state, end, method, step):
    """The same run by sweeps alone, and by Newton's method, in NumPy, which compiles nothing."""
    given = {"target": "numpy"}
    return [run(system, state, end, method, step, newton=each, **given) for each in (False, True)]


@pytest.mark.parametrize("method", ["midpoint", "gauss4", "discrete_gradient"])
def test_stiff_friction_is_followed_where_sweeps_diverge(method):
    """It comes to where DOP853 comes with steps that are short enough for its stability."""
    given = {"parameters": HONEY, "target": "numpy"}
    expected = heavy_top_damped.simulate(
        LEANING, (0, 5), HONEY, method="dop853", rtol=1e-10, atol=1e-12, samples=1
    )
    assert run(heavy_top_damped, LEANING, 5, method, 0.05, **given).status == "NOT_SOLVED"
    found = run(heavy_top_damped, LEANING, 5, method, 0.05, newton=True, **given)
    assert found.status == expected.status == "OK"
    assert np.abs(found.state - expected.state).max() < 1e-6
    assert found.steps < expected.steps / 5
    assert found.settings["newton"] is True


@pytest.mark.parametrize(
    ("system", "state", "method", "step"),
    [
        (rigid_body, TURNING, "midpoint", 0.5),
        (rigid_body, TURNING, "gauss8", 0.5),
        (rigid_body, TURNING, "spherical_midpoint4", 0.5),
        (rigid_body, TURNING, "coadjoint_mean", 0.5),
        (heavy_top, TOP, "spherical_midpoint", 0.1),
        (heavy_top, TOP, "average_gradient", 0.1),
        (so4_body, [0.3, -0.2, 0.5, 0.1, 0.4, -0.6], "isospectral_midpoint", 0.2),
        (nambu_body, [0.5, 0.6, 0.7], "nambu_gradient", 0.2),
    ],
    ids=lambda each: getattr(each, "name", str(each)[:20]),
)
def test_the_equations_are_those_of_sweeps_and_take_fewer(system, state, method, step):
    """The same solution, to roundings of the search, in fewer sweeps."""
    one, other = solve_both(system, state, 20 * step, method, step)
    assert one.status == other.status == "OK"
    assert np.abs(one.state - other.state).max() < 1e-13
    assert other.sweeps < one.sweeps


@pytest.mark.parametrize(
    "method",
    [
        "gauss4",
        "spherical_midpoint",
        pytest.param("midpoint", marks=pytest.mark.campaign),
        pytest.param("coadjoint_mean", marks=pytest.mark.campaign),
        pytest.param("discrete_gradient", marks=pytest.mark.campaign),
    ],
)
def test_c_and_numpy_have_the_same_bits(method):
    """In members with other pivots and other counts of sweeps, one of which is not solved."""
    states = TURNING[:, np.newaxis] * np.array([1.0, 1.2, 40.0, 0.5, 3.0])
    given = {"parameters": {"I": [2.0, 1.0, 2 / 3]}, "newton": True}
    one, other = (
        run(rigid_body, states, 2, method, 0.5, target=each, **given) for each in ("numpy", "c")
    )
    assert np.array_equal(one.state, other.state)
    assert np.array_equal(one.sweeps, other.sweeps)
    assert list(one.status[[0, 1, 3, 4]]) == ["OK"] * 4


def test_slopes_are_the_derivatives_of_sweeps():
    """Against differences, where they are exact: on spheres with tangents, and of stages."""
    from coadjoint.methods import Sphere
    from coadjoint.solve.methods.gauss import Gauss
    from coadjoint.solve.methods.lie_poisson import Arc
    from coadjoint.solve.methods.midpoint import Midpoint
    from coadjoint.solve.methods.spherical_midpoint import SphericalMidpoint

    def rates(_lanes, _after, x):
        return heavy_top.rhs(np.ascontiguousarray(x))

    def jacobian(_lanes, _after, x):
        return heavy_top.jacobian(np.ascontiguousarray(x))

    state, h = TOP[:, np.newaxis], np.array([0.3])
    arc = Arc(SimpleNamespace(), 0.5 * h, h, state, np.zeros(state.shape))
    sphere = Sphere((3, 4, 5), (0, 1, 2))
    methods = {
        1: [Midpoint(rates=rates, size=0.3)],
        2: [Gauss(rates=rates, size=0.3, order=4)],
        0: [SphericalMidpoint(field=rates, size=0.3, spheres=(sphere,))],
    }
    for count, (method,) in methods.items():
        method.jacobian = jacobian
        middle = np.concatenate([state + 0.05] * max(1, count))

        def settle(m, method=method, middle=middle):
            kept = method.prepare(arc, middle)
            for _ in range(6):  # quotients of lengths are solved by sweeps as well
                found = method.sweep(arc, m, kept).middle
            return found, kept

        following, kept = settle(middle)
        slopes = method.linearise(arc, middle, following, kept)[..., 0]
        columns = []
        for unit in np.eye(len(middle)):
            step = 1e-6 * unit[:, np.newaxis]
            columns.append((settle(middle + step)[0] - settle(middle - step)[0])[:, 0] / 2e-6)
        assert np.abs(slopes).max() > 0.1
        assert np.abs(slopes - np.array(columns).T).max() < 1e-8, type(method)


def test_elimination_takes_the_largest_pivots():
    """Against LAPACK, with zeros on the diagonal; a singular matrix gives no finite solution."""
    rng = np.random.default_rng(3)
    matrix, known = rng.normal(size=(5, 5, 4)), rng.normal(size=(5, 4))
    matrix[0, 0] = matrix[2, 2] = 0.0
    expected = [np.linalg.solve(matrix[..., n], known[:, n]) for n in range(4)]
    found = newton.solve(matrix.copy(), known.copy())
    assert np.abs(found - np.array(expected).T).max() < 1e-12
    with np.errstate(all="ignore"):
        assert not np.isfinite(newton.solve(np.zeros((2, 2, 1)), np.ones((2, 1)))).any()


def solve_one(rows, right):
    """The same elimination of one lane, number by number, as the text in C has it."""
    size, a, x = len(right), [list(row) for row in rows], list(right)
    for j in range(size):
        for i in range(j + 1, size):
            if abs(a[i][j]) > abs(a[j][j]):
                a[i], a[j], x[i], x[j] = a[j], a[i], x[j], x[i]
        for i in range(j + 1, size):
            factor = a[i][j] / a[j][j]
            for k in range(j + 1, size):
                a[i][k] -= factor * a[j][k]
            x[i] -= factor * x[j]
    for i in reversed(range(size)):
        for k in range(i + 1, size):
            x[i] -= a[i][k] * x[k]
        x[i] /= a[i][i]
    return x


def test_elimination_has_the_bits_of_each_lane_alone():
    """Whether rows are exchanged in all lanes, in some or in none."""
    rng = np.random.default_rng(4)
    for scale in (1.0, 0.2, 0.01):
        matrix = np.eye(6)[:, :, np.newaxis] + scale * rng.normal(size=(6, 6, 9))
        known = rng.normal(size=(6, 9))
        expected = [solve_one(matrix[..., n].tolist(), known[:, n].tolist()) for n in range(9)]
        found = newton.solve(matrix.copy(), known.copy())
        assert found.tobytes() == np.array(expected).T.tobytes()


def test_wrong_slopes_are_seen(monkeypatch):
    """With slopes of the other sign the stiff motion is not solved."""
    linearise = LiePoisson.linearise
    monkeypatch.setattr(LiePoisson, "linearise", lambda self, *given: -linearise(self, *given))
    given = {"parameters": HONEY, "newton": True, "target": "numpy"}
    assert run(heavy_top_damped, LEANING, 1, "midpoint", 0.05, **given).status == "NOT_SOLVED"


def test_a_failure_is_a_status_that_says_what_helps():
    """Where sweeps fail Newton's method is named; where it fails as well, shorter steps are."""
    fast = 200 * TURNING
    given = {"target": "numpy"}
    failed = run(rigid_body, fast, 1, "spherical_midpoint", 0.5, **given)
    assert failed.status == "NOT_SOLVED"
    assert failed.message.endswith("take shorter steps, or newton=True, which solves stiff ones")
    again = run(rigid_body, fast, 1, "spherical_midpoint", 0.5, newton=True, **given)
    assert again.status == "NOT_SOLVED"
    assert again.message.endswith("take shorter steps")


@pytest.mark.parametrize(
    ("system", "state", "options", "said"),
    [
        (kepler, ORBIT, {"method": "rk4", "step": 0.1}, "'rk4' have no equation"),
        (kepler, ORBIT, {"method": "splitting4", "step": 0.1}, "'splitting4' have no equation"),
        (kepler, ORBIT, {}, "'taylor' have no equation"),
        (
            kepler,
            ORBIT,
            {"method": "midpoint", "step": 0.1, "newton": "yes"},
            "'yes'; expected True",
        ),
        (stochastic_rigid_body, TURNING, {"step": 0.1, "seed": 1}, "with noise are solved by"),
    ],
)
def test_where_there_is_nothing_to_solve_it_is_refused(system, state, options, said):
    """With the reason."""
    with pytest.raises(KernelArgumentError, match=said):
        system.simulate(state, (0, 1), **{"newton": True} | options)


def test_every_implicit_method_takes_it():
    """None is left out that the free body has."""
    names = [each.name for each in rigid_body.METHODS if each.name in STRUCTURED and each.applies]
    assert len(names) >= 12
    for name in names:
        assert run(rigid_body, TURNING, 0.4, name, 0.2, newton=True, target="numpy").status == "OK"


# -- systems of equal members ---------------------------------------------------------------------


def make_wave(n):
    """Spins of a wave that is long against their distance: it is slow, and neighbours are not."""
    phase = 4 * np.pi * np.arange(n) / n
    tilt = 0.9 + 0.2 * np.cos(phase)
    return np.concatenate(
        [np.sin(tilt) * np.cos(phase), np.sin(tilt) * np.sin(phase), np.cos(tilt)]
    )


@pytest.mark.parametrize("method", ["midpoint", "spherical_midpoint"])
def test_stiff_neighbours_are_followed(method):
    """A wave by steps eight times longer than sweeps converge with, against DOP853."""
    ring = heisenberg_lattice.system.resize({"i": 400})
    wave = make_wave(400)
    assert run(ring, wave, 4, method, 2.0).status == "NOT_SOLVED"
    found = run(ring, wave, 4, method, 2.0, newton=True)
    expected = ring.simulate(wave, (0, 4), method="dop853", rtol=1e-10, atol=1e-12, samples=1)
    assert found.status == "OK"
    assert np.abs(expected.state[:, 0] - wave).max() > 1e-3
    assert np.abs(found.state - expected.state).max() < 1e-6
    assert found.drift["M"] < 1e-14


@pytest.mark.parametrize("method", ["midpoint", "spherical_midpoint"])
@pytest.mark.parametrize("members", [1, 3, 11])
def test_members_in_any_company_have_the_bits_of_numpy(method, members):
    """By one lane, by some of a vector, and by more than one: with counts of sweeps."""
    ring = heisenberg_lattice.system.resize({"i": 21})
    spins = np.random.default_rng(1).normal(size=(3, 21, members))
    spins = (spins / np.linalg.norm(spins, axis=0)).reshape(63, members)
    one, other = (
        run(ring, spins, 0.8, method, 0.4, newton=True, target=each) for each in ("numpy", "c")
    )
    assert np.array_equal(one.state, other.state)
    assert np.array_equal(one.sweeps, other.sweeps)
    alone = run(ring, spins[:, 0], 0.8, method, 0.4, newton=True)
    assert np.array_equal(alone.state[..., -1], one.state[:, 0, -1])


def test_krylov_spaces_solve_linear_equations():
    """Against LAPACK, with lanes that need different numbers of vectors; one needs none."""
    rng = np.random.default_rng(5)
    slopes = rng.normal(size=(12, 12, 3)) / 6
    slopes[..., 1] *= 0.01
    middle, following = rng.normal(size=(2, 12, 3))
    following[:, 2] = middle[:, 2]

    def apply(vector):
        return np.einsum("ijn,jn->in", slopes, vector)

    with np.errstate(invalid="ignore"):
        found = krylov.improve(middle, following, apply)
    for n in range(3):
        rest = following[:, n] - middle[:, n]
        exact = middle[:, n] + np.linalg.solve(np.eye(12) - slopes[..., n], rest)
        assert np.abs(found[:, n] - exact).max() <= 1e-3 * np.abs(rest).max()
    assert np.array_equal(found[:, 2], middle[:, 2])


def test_a_system_without_a_jacobian_says_so():
    """Rates that loop over a table of coefficients have none that is written out."""
    table = SimpleNamespace(name="so9_body", functions=("rhs",), NOISE=())
    with pytest.raises(KernelArgumentError, match="so9_body has no Jacobian in closed form; expec"):
        obstacles.check_newton_applies(table, False)
