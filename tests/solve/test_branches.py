"""The Taylor method and branch points, where its series goes on and the motion does not.

The series of ``(1 - t/2)^2`` solves ``dy/dt = -sqrt(y)`` up to t = 2, and ``sqrt(y)`` beyond.
"""

from dataclasses import replace

import numpy as np
import pytest

from coadjoint.declared import Quantity
from coadjoint.solve.steps import Taylor
from tests.kernels import COMPILER
from tests.programs import program
from tests.solve.systems import EMPTYING, build

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")


def system_of(name, rates):
    """Equations ``dx/dt, dy/dt = rates``."""
    rows = "; ".join(rates)
    return replace(
        EMPTYING,
        name=name,
        state=(Quantity("x", (), "1", ("x",)), Quantity("y", (), "1", ("y",))),
        programs=(
            program("rhs", "x y", "", "", rows, (2,)),
            program("energy", "x y", "", "", "x", ()),
            program("observables", "x y", "", "", "y", (1,)),
        ),
    )


SIDES = "(x - 1)*(x - 2)"


def rise(t):
    """The integral of |(x - 1)(x - 2)|, which turns twice."""
    signed = 2 * t - 1.5 * t**2 + t**3 / 3
    return np.where(t < 1, signed, np.where(t < 2, 5 / 3 - signed, signed + 1 / 3))


#: Rates of x and y, their start, and x and y at all times at which there is a motion.
PASSED = {
    "root": (("-sqrt(x)", "1"), [1, 0], lambda t: [np.maximum(1 - t / 2, 0) ** 2, t]),
    "size": (("-1", "sqrt(x*x)"), [1, 0], lambda t: [1 - t, (1 + (t - 1) * abs(t - 1)) / 2]),
    "twice": (("1", f"sqrt({SIDES}*({SIDES}))"), [0, 0], lambda t: [t, rise(t)]),
}
#: The same, and when it ends.
ENDING = {
    "alone": (("-sqrt(x)", "0"), [1, 0], lambda t: [(1 - t / 2) ** 2, 0 * t], 2),
    "power": (("-4*exp(3*log(x)/4)", "0"), [1, 0], lambda t: [(1 - t) ** 4, 0 * t], 1),
    "log": (("-1", "log(x)"), [1, 0], lambda t: [1 - t, -t - (1 - t) * np.log1p(-t)], 1),
    "pole": (("x*x", "sqrt(x)"), [1, 0], lambda t: [1 / (1 - t), 2 - 2 * np.sqrt(1 - t)], 1),
}


@pytest.mark.parametrize(("name", "target"), [("root", "c"), *((n, "numpy") for n in PASSED)])
def test_a_motion_that_goes_on_is_followed(tmp_path, name, target):
    """To the tolerance on both sides of the branch point, where its series are different ones."""
    rates, start, exact = PASSED[name]
    system = build(system_of(name, rates), tmp_path)
    found = system.simulate(start, (0, 3.3), samples=34, target=target, rtol=1e-7, atol=1e-8)
    assert found.status == "OK"
    assert np.abs(found.state - np.array(exact(found.time))).max() < 1e-5
    assert found.rejected > 0


@pytest.mark.parametrize(("name", "target"), [("alone", "c"), *((n, "numpy") for n in ENDING)])
def test_a_motion_ends_at_a_branch_point(tmp_path, name, target):
    """Its last state is close to it, and its samples are those of the closed form."""
    rates, start, exact, end = ENDING[name]
    system = build(system_of(name, rates), tmp_path)
    found = system.simulate(start, (0, 3.3), samples=34, target=target)
    assert found.status == "STEP_UNDERFLOW"
    assert end - 1e-3 < found.time_reached <= end + 1e-9
    before = found.time < end - 1e-3
    assert before.sum() == round(10 * end)
    expected = np.array(exact(found.time[before]))
    assert np.abs(found.state[:, before] - expected).max() < 1e-8
    assert found.rejected < 200


def test_a_fixed_step_does_not_cross_one(tmp_path):
    """Steps of 0.3 end before t = 2: the one from 1.8 goes beyond."""
    system = build(EMPTYING, tmp_path)
    found = system.simulate([1.0], (0, 3), method="taylor", step=0.3, target="numpy")
    assert found.status == "STEP_UNDERFLOW"
    assert found.time_reached == pytest.approx(1.8)
    assert "0.3" in found.message


def test_without_the_comparison_it_bounces(tmp_path, monkeypatch):
    """The same run in NumPy goes through zero and rises again, and says that all is well."""
    system = build(EMPTYING, tmp_path)
    monkeypatch.setattr(Taylor, "_is_followed", lambda self, *given: np.ones(1, bool))
    found = system.simulate([1.0], (0, 3.3), target="numpy")
    assert found.status == "OK"
    assert found.final["y"] > 0.1


def test_smooth_roots_cost_no_step(tmp_path):
    """A root that stays away from zero is followed without a rejected step, to the bit in C.

    ``dx/dt = y, dy/dt = -x/sqrt(x^2 + y^2)`` turns with the rate 1 where x^2 + y^2 = 1.
    """
    system = build(system_of("turning", ("y", "-x/sqrt(x*x + y*y)")), tmp_path)
    start = np.array([[0.0, 0.6], [1.0, 0.8]])
    a, b = (system.simulate(start, (0, 50), target=each) for each in ("c", "numpy"))
    assert np.array_equal(a.state, b.state)
    assert (a.status == "OK").all()
    assert a.rejected.max() == 0
    assert np.abs(a.state[0, 0] - np.sin(a.time)).max() < 1e-8


RUNGE_KUTTA = [
    {"method": "dop853"},
    {"method": "dop853", "rtol": 1e-3, "atol": 1e-5},
    {"method": "dop853", "step": 0.5},
    {"method": "dop853", "step": 0.03},
    {"method": "rk4", "step": 0.3},
]


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """``dy/dt = -sqrt(y)``: it is empty at 2 sqrt(y(0))."""
    return build(EMPTYING, tmp_path_factory.mktemp("tank"))


def empty(tank, **options):
    """The runs of tanks of many depths: some steps end where the rates are not real."""
    start = np.linspace(0.05, 2.2, 431)[np.newaxis] ** 2
    return tank.simulate(start, (0, 5), samples=6, **options), 2 * np.sqrt(start[0])


@pytest.mark.parametrize("options", RUNGE_KUTTA, ids=str)
def test_no_step_ends_beyond_a_branch_point(tank, options):
    """The last good state has rates, is in time, and is the same for both targets to the bit."""
    found, ends = empty(tank, **options)
    assert {*found.status} <= {"NONFINITE", "STEP_UNDERFLOW"}
    assert (found.course.last >= 0).all()
    # an error of the depth moves the end by its root
    late = 0.1 * options["step"] if "step" in options else 3 * options.get("rtol", 1e-10) ** 0.5
    assert (found.time_reached - ends).max() < late
    early = 2 * options["step"] if "step" in options else late
    assert (found.time_reached > ends - early - 1e-9).all()
    other, _ = empty(tank, target="numpy", **options)
    for name in ("state", "time_reached", "steps", "rejected"):
        assert getattr(found, name).tobytes() == getattr(other, name).tobytes()
    assert found.course.last.tobytes() == other.course.last.tobytes()


@pytest.mark.parametrize("options", RUNGE_KUTTA[1:4], ids=str)
def test_without_a_look_at_the_end_they_go_beyond(tank, monkeypatch, options):
    """Spoiled: a step may end where the rates are not finite, with a depth below zero."""
    monkeypatch.setattr(
        "coadjoint.solve.runge_kutta.end_where_rates_end", lambda rates, lanes, h, state: state
    )
    found, _ = empty(tank, target="numpy", **options)
    assert (found.course.last < 0).any()
