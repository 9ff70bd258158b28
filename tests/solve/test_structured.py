"""Methods that keep the structure of a motion: order, what they keep, bits, refusals."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import coadjoint
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import STRUCTURED, list_structured
from coadjoint.solve.methods import midpoint
from coadjoint.systems import (
    chaplygin_sleigh,
    heavy_top,
    kapitza_top,
    kepler,
    orbiting_body,
    rigid_body,
    rigid_body_attitude,
    stochastic_rigid_body,
    suslov,
    toda_lattice,
)

TARGETS = ("numpy", "c")

TOP = {"I": [1.0, 1.3, 0.6], "m": 1.0, "g": 1.0, "chi": [0.1, 0.2, 0.6]}
START = np.array([0.4, -0.3, 1.2, 0.6, 0.0, 0.8])
FREE = {"I": [2.0, 1.0, 2 / 3]}
TURNING = np.array([np.cos(1.1), 0.0, np.sin(1.1)])
ORBIT = [1.0, 0.0, 0.0, 0.0, 1.1, 0.2]


def error(method, step, system, start, parameters, end):
    """How far the end of a run is from that of DOP853 with tight tolerances."""
    options = {"samples": 1}
    exact = system.simulate(
        start, (0, end), parameters, method="dop853", rtol=1e-13, atol=1e-14, **options
    )
    run = system.simulate(start, (0, end), parameters, method=method, step=step, **options)
    assert run.status == exact.status == "OK"
    return float(np.abs(run.state - exact.state).max())


@pytest.mark.parametrize("method", ["midpoint", "midpoint4", "midpoint6"])
@pytest.mark.parametrize(
    ("system", "start", "parameters"),
    [(heavy_top, START, TOP), (kepler, ORBIT, {"mu": 1.0}), (kapitza_top, START, {})],
    ids=["heavy_top", "kepler", "kapitza_top"],
)
def test_the_order_is_that_of_the_method(method, system, start, parameters):
    """On nonlinear motions, one of which is driven in time, with steps that are divided by 1.5."""
    order = STRUCTURED[method].order
    steps = {2: (2.0, 3.0), 4: (0.4, 0.6), 6: (0.2, 0.3)}[order]
    scale = 1.0 / (16.0 if order == 2 else 2.0)
    if system is kapitza_top:
        scale /= 16.0
    length = 24 * scale / 8
    errors = [
        error(method, scale / 8 * each / steps[0], system, start, parameters, length)
        for each in steps
    ]
    measured = np.log(errors[1] / errors[0]) / np.log(1.5)
    assert measured == pytest.approx(order, abs=0.25), errors


@pytest.mark.parametrize("method", ["midpoint", "midpoint4"])
def test_quadratic_integrals_are_kept_to_rounding(method):
    """Energy and Casimirs of a top; by RK4 they are not."""
    run = heavy_top.simulate(START, (0, 200), TOP, method=method, step=0.05, samples=3)
    other = heavy_top.simulate(START, (0, 200), TOP, method="rk4", step=0.05, samples=3)
    assert set(run.drift) == {"energy", "casimir1", "casimir2"}
    assert max(run.drift.values()) < 1e-14
    assert min(other.drift.values()) > 1e-9


def test_what_is_not_quadratic_is_kept_only_nearly():
    """The energy of Kepler's motion stays near, its angular momentum is kept."""
    run = kepler.simulate(ORBIT, (0, 100), {"mu": 1.0}, method="midpoint", step=0.05, samples=201)
    assert 1e-6 < run.drift["energy"] < 1e-3
    later = kepler.simulate(
        ORBIT, (0, 1000), {"mu": 1.0}, method="midpoint", step=0.05, samples=2001
    )
    assert later.drift["energy"] < 1.5 * run.drift["energy"]


@pytest.mark.parametrize(
    ("system", "start"), [(chaplygin_sleigh, [0.4, 0.9]), (suslov, [0.429, -0.084, 0.0])]
)
def test_the_energy_of_constrained_motions_is_kept(system, start):
    """It is quadratic in the velocities, and they stay on the constraint."""
    run = system.simulate(
        start,
        (0, 500),
        method="midpoint",
        step=0.1,
        samples=2,
    )
    assert run.drift["energy"] < 2e-14


def test_the_step_is_its_own_adjoint():
    """A step forward and one backward, by turned momenta, end where they began."""
    there = rigid_body.simulate(TURNING, (0, 0.3), FREE, method="midpoint4", step=0.1, samples=1)
    back = rigid_body.simulate(
        -there.state[:, -1], (0, 0.3), FREE, method="midpoint4", step=0.1, samples=1
    )
    assert np.abs(-back.state[:, -1] - TURNING).max() < 1e-15


def test_the_midpoint_is_no_poisson_map():
    """Its derivative takes the bracket elsewhere: a control for methods that are."""
    h, eps = 0.3, 1e-5

    def flow(x):
        run = rigid_body.simulate(x, (0, h), FREE, method="midpoint", step=h, samples=1)
        return run.state[:, -1]

    def tensor(x):
        return rigid_body.poisson_tensor(x, [2.0, 1.0, 2 / 3])

    columns = [(flow(TURNING + eps * e) - flow(TURNING - eps * e)) / (2 * eps) for e in np.eye(3)]
    slope = np.array(columns).T
    defect = slope @ tensor(TURNING) @ slope.T - tensor(flow(TURNING))
    assert np.abs(defect).max() > 1e-6


@pytest.mark.parametrize("target", TARGETS)
def test_a_member_has_the_same_bits_in_any_company(target):
    """Other members, threads and targets change nothing."""
    start = TURNING[:, np.newaxis] + 0.1 * np.random.default_rng(0).normal(size=(3, 41))
    options = {"method": "midpoint4", "step": 0.125, "samples": 5}
    whole = rigid_body.simulate(start, (0, 2), FREE, target="numpy", **options).state
    again = rigid_body.simulate(start, (0, 2), FREE, target=target, threads=3, **options).state
    assert np.array_equal(whole, again)
    alone = rigid_body.simulate(start[:, 7], (0, 2), FREE, target=target, **options).state
    assert np.array_equal(whole[:, 7], alone)


@pytest.mark.parametrize("method", ["midpoint", "spherical_midpoint", "gauss4"])
def test_steps_by_as_many_sweeps_as_most_have_the_same_bits(method):
    """Of bodies of which some need many more than others, through changes of what most need.

    C sweeps on after the sweep that changes nothing, and makes some steps again whose sweeps were
    too few. Shorter steps need less, so that it has to come down, and counts show that it does.
    """
    start = TURNING[:, np.newaxis] * np.linspace(0.1, 1.4, 70)
    more = {}
    for step, count in ((0.125, 300), (0.0078125, 800)):
        options = {"method": method, "step": step, "samples": 7}
        one, other = (
            rigid_body.simulate(start, (0, step * count), FREE, target=t, **options)
            for t in ("c", "numpy")
        )
        assert (one.status == "OK").all()
        assert np.array_equal(one.state, other.state)
        assert (one.sweeps >= other.sweeps - one.steps).all()
        more[step] = float(np.max(one.sweeps / other.sweeps.max()))
    assert max(more.values()) < 1.25


def test_a_step_that_is_not_solved_ends_its_member_alone():
    """The member that turns fast has no solution that sweeps find; the others come to the end."""
    start = TURNING[:, np.newaxis] * np.array([1.0, 40.0, 0.5])
    run = rigid_body.simulate(start, (0, 10), FREE, method="midpoint", step=0.5, samples=1)
    assert list(np.ravel(run.status)) == ["OK", "NOT_SOLVED", "OK"]
    assert "1 NOT_SOLVED" in run.message
    alone = rigid_body.simulate(40 * TURNING, (0, 10), FREE, method="midpoint", step=0.5, samples=1)
    assert alone.message == (
        "the equation of a step of 0.5 was not solved near t = 0; take shorter steps, "
        "or newton=True, which solves stiff ones"
    )
    assert np.array_equal(alone.state[:, -1], 40 * TURNING)


@pytest.mark.parametrize("method", ["midpoint", "midpoint4", "gauss4", "discrete_gradient"])
def test_sweeps_that_solve_nothing_are_counted(method):
    """Of a first step, too, in C as in NumPy; the steps before one that fails keep theirs."""
    start = TURNING[:, np.newaxis] * np.array([40.0, 1.0])
    options = {"method": method, "step": 0.5, "samples": 1}
    runs = [rigid_body.simulate(start, (0, 10), FREE, target=t, **options) for t in TARGETS]
    assert [str(each) for each in np.ravel(runs[0].status)] == ["NOT_SOLVED", "OK"]
    assert runs[0].steps[0] == 0
    assert runs[0].sweeps[0] > 0
    assert runs[0].sweeps.tolist() == runs[1].sweeps.tolist()


def test_what_a_method_keeps_is_said():
    """In the settings and the representation of a run."""
    run = rigid_body.simulate(TURNING, (0, 1), FREE, method="midpoint", step=0.1)
    assert run.settings["keeps"] == STRUCTURED["midpoint"].keeps
    assert "midpoint keeps linear and quadratic integrals" in repr(run)
    assert "of what each path keeps" not in repr(run)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({}, "method 'midpoint' has no estimate of its error; expected step="),
        ({"step": 0.1, "rtol": 1e-9}, "tolerances are given"),
        ({"step": 0.1, "target": "python"}, "they are written for the targets c, c-fast and numpy"),
        ({"step": 0.1, "seed": 1}, "rigid_body has none"),
    ],
)
def test_arguments_that_do_not_go_with_it(arguments, said):
    """Each is told with what is missing."""
    with pytest.raises(KernelArgumentError, match=said):
        rigid_body.simulate(TURNING, (0, 1), FREE, method="midpoint", **arguments)


def test_names_are_read_in_any_case_and_with_hyphens():
    """As the other methods, and as people write them."""
    runs = [
        rigid_body.simulate(TURNING, (0, 1), FREE, method=each, step=0.1, samples=1).state
        for each in ("midpoint4", "MidPoint4")
    ]
    assert np.array_equal(*runs)


def test_families_and_noise_have_methods_of_their_own():
    """A family says why; with noise, the midpoint follows the noise."""
    state = {"q": np.arange(8.0), "p": np.zeros(8)}
    with pytest.raises(KernelArgumentError, match="does not apply to its equal members"):
        toda_lattice.system.resize({"i": 8}).simulate(state, (0, 1), method="gauss4")
    with pytest.raises(KernelArgumentError, match="'midpoint4'"):
        stochastic_rigid_body.simulate(TURNING, (0, 1), method="midpoint4", step=0.1, seed=1)
    assert list_structured(["rhs", "kinks"]) == ()


def test_a_broken_rule_of_the_end_is_caught(monkeypatch):
    """Where sweeps change the middle by half of what they should, the order is lost."""

    def sweep(self, arc, middle, kept):
        rise = arc.length * self.rates(arc.lanes, arc.middle, middle)
        return midpoint.Sweep(arc.state + 0.4 * rise, rise, False)

    monkeypatch.setattr(midpoint.Midpoint, "sweep", sweep)
    run = heavy_top.simulate(
        START, (0, 20), TOP, method="midpoint", step=0.05, samples=3, target="numpy"
    )
    assert max(run.drift.values()) > 1e-4


def test_a_loaded_system_has_them(tmp_path):
    """As those that are shipped."""
    path = tmp_path / "swing.toml"
    path.write_text(
        'title = "Pendulum"\nsource = "a test"\nlicense = "MIT"\nroutes = ["canonical"]\n'
        '[variables]\nq = { role = "coordinate" }\np = { role = "momentum", of = "q" }\n'
        '[hamiltonian]\nh = "p^2/2 - cos(q)"\n[claims]\nconserved = ["energy"]\n'
    )
    swing = coadjoint.load(path)
    run = swing.simulate([1.0, 0.0], (0, 300), method="midpoint6", step=0.1, samples=301)
    assert run.drift["energy"] < 1e-7


def test_attitudes_are_turned_by_the_element_that_moves_the_momentum():
    """So the momentum in space stays; with the element of the end of each step it drifts."""
    start, h, inertia = [1.0, 0.0, 0.0, 0.0, *TURNING], 0.125, np.array(FREE["I"])
    run = rigid_body_attitude.simulate(
        start, (0, 25), FREE, method="coadjoint_mean", step=h, samples=201, target="numpy"
    )
    assert run.drift["Pi_spatial"] < 1e-14
    assert run.drift["energy"] > 1e-6
    turned = Rotation.identity()
    for momentum in run["Pi"].T[1:]:
        turned *= Rotation.from_rotvec(h * momentum / inertia)
    assert abs(turned.apply(run["Pi"][:, -1]) - TURNING).max() > 1e-3


@pytest.mark.parametrize(
    ("method", "least", "most"),
    [("coadjoint_mean", 0, 2e-14), ("splitting", 0, 5e-14), ("midpoint", 1e-4, 1)],
)
def test_momenta_in_space_stay_where_forces_depend_on_the_attitude(method, least, most):
    """By the symmetry of the energy under rotations of space, which the midpoint does not see."""
    start = [0.4, -0.3, 1.2, 0.1, 1.0, -0.2, *np.eye(3, 4).ravel()]
    start[9] = 8.0  # so far that it stays off the centre
    run = orbiting_body.simulate(
        start, (0, 10), method=method, step=0.25, samples=11, target="numpy"
    )
    assert least <= run.drift["J"] < most
    assert run.drift["energy"] > 1e-6


KIRCHHOFF = """
title = "A body in a fluid"
routes = ["lie-poisson"]
[algebra]
name = "se(3)"
[variables]
L = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[hamiltonian]
h = "L1^2/2 + L2^2/4 + L3^2/6 + P1^2/2 + P2^2/3 + P3^2/4 + L1*P1/9"
"""


def test_a_body_without_impulse_turns_as_one_on_its_sphere(tmp_path):
    """Where P is 0 the orbit is the sphere of L, and the step that of a free body."""
    (tmp_path / "kirchhoff_own.toml").write_text(KIRCHHOFF)
    fluid = coadjoint.load(tmp_path / "kirchhoff_own.toml")
    start = np.array([[0.3, 0.5, 0.9, 0, 0, 0], [0.3, 0.5, 0.9, 0.1, 0.2, 0.3], [0.0] * 6]).T
    given = {"method": "spherical_midpoint", "step": 0.1, "samples": 101}
    runs = [fluid.simulate(start, (0, 10), target=target, **given) for target in ("c", "numpy")]
    assert (runs[0].status == "OK").all()
    assert (runs[0].state == runs[1].state).all()
    free = rigid_body.simulate([0.3, 0.5, 0.9], (0, 10), {"I": [1, 2, 3]}, **given)
    assert runs[0].state[:3, 0] == pytest.approx(free.state, abs=1e-14)
    assert not runs[0].state[3:, 0].any()
    assert (
        np.abs(runs[0].state[:3, 1] - free.state).max() > 1e-3
    )  # with impulse it is another motion
