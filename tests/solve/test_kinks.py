"""Kinks of the rates: steps end at them, and methods keep their order across them.

Expected values are closed forms between kinks, joined by hand.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from coadjoint.declared import Quantity
from coadjoint.derive import derive, interpret
from coadjoint.errors import DerivationError
from coadjoint.lower import kinks, sums
from coadjoint.lower.lowering import lower
from coadjoint.prove.declaration import kernel_context
from coadjoint.solve.costs import LEAST, SHARE
from coadjoint.solve.events import Event
from coadjoint.solve.kinks import Kinks
from tests.kernels import COMPILER
from tests.programs import program
from tests.solve.systems import EMPTYING, build
from tests.specs import spec

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
METHODS = ("taylor", "dop853", "rk4")


def system_of(folder, rates, *, held=True):
    """Equations ``dx/dt, dy/dt = rates``; perhaps with solvers that know no kinks."""
    rows = "; ".join(rates)
    context = replace(
        EMPTYING,
        name="kinked",
        state=(Quantity("x", (), "1", ("x",)), Quantity("y", (), "1", ("y",))),
        programs=(
            program("rhs", "x y", "", "", rows, (2,)),
            program("energy", "x y", "", "", "x", ()),
            program("observables", "x y", "", "", "y", (1,)),
        ),
    )
    with pytest.MonkeyPatch.context() as patch:
        if not held:
            patch.setattr(kinks, "find_kinks", lambda _: ())
        return build(context, folder)


def system_of_spec(folder, text):
    """The system of a spec."""
    equations = derive(spec(text))
    context = replace(kernel_context(equations, lower(equations), 0), name="specified")
    return build(context, folder)


def run_both(system, *given, **options):
    """A run in C, which has the same bits in NumPy."""
    one, other = (system.simulate(*given, target=each, **options) for each in ("c", "numpy"))
    assert np.array_equal(one.state, other.state, equal_nan=True)
    assert np.array_equal(one.time, other.time)
    for name in ("steps", "rejected", "status"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    assert np.array_equal(one.kinks.rows, other.kinks.rows)
    assert np.array_equal(one.kinks.counts, other.kinks.counts)
    return one


def swing(t):
    """The motion of ``x'' = -sign(x)`` from 1/2 at rest: parabolas, with the period 4."""
    t = np.asarray(t) % 4
    parts = 1 / 2 - t**2 / 2, (t - 1) ** 2 / 2 - (t - 1), (t - 3) - (t - 3) ** 2 / 2
    return np.where(t < 1, parts[0], np.where(t < 3, parts[1], parts[2]))


#: Largest error of x over 100 periods, at 1e-12 or with steps of 0.05.
ERRORS = {"taylor": 4e-11, "dop853": 6e-10, "rk4": 1e-9}


@pytest.mark.parametrize("method", METHODS)
def test_parabolas_are_followed_for_100_periods(tmp_path, method):
    """With one step for each, where the method chooses it; a kink is met every half a period."""
    system = system_of(tmp_path, ("y", "-sign(x)"))
    step = {"step": 0.05} if method == "rk4" else {"rtol": 1e-12, "atol": 1e-12}
    found = run_both(system, [0.5, 0], (0, 400), samples=401, method=method, **step)
    assert found.status == "OK"
    assert np.abs(found.state[0] - swing(found.time)).max() < ERRORS[method]
    assert len(found.kinks) == found.kinks.counts == 200
    assert found.kinks.names == ("x",)
    assert np.abs(found.kinks.time - np.arange(1, 400, 2)).max() < ERRORS[method]
    if method == "taylor":
        assert found.steps < 210


def test_without_kinks_parabolas_are_not(tmp_path):
    """The negative control: at the same tolerance no step over a kink is small enough."""
    system = system_of(tmp_path, ("y", "-sign(x)"), held=False)
    found = system.simulate([0.5, 0], (0, 400), samples=401, rtol=1e-12, atol=1e-12)
    assert found.kinks is None
    assert found.status == "STEP_UNDERFLOW"
    assert found.rejected > 1000


def arc(t):
    """The motion of ``x'' = -x - sign(x)`` from 1 at rest: arcs about -1 and 1."""
    quarter = math.acos(0.5)
    speed, phase = math.sin(quarter) * 2.0, t % (4 * quarter)
    if phase < quarter:
        return 2 * math.cos(phase) - 1
    if phase < 3 * quarter:
        return 1 - math.cos(phase - quarter) - speed * math.sin(phase - quarter)
    return math.cos(phase - 3 * quarter) + speed * math.sin(phase - 3 * quarter) - 1


#: Steps of each method, and its order.
ORDERS = {"rk4": ((0.4, 0.1, 0.025, 0.0125), 4), "dop853": ((0.8, 0.4, 0.2, 0.1), 8)}


@pytest.mark.parametrize("held", [True, False], ids=["held", "control"])
@pytest.mark.parametrize("method", ORDERS)
def test_methods_keep_their_order_across_kinks(tmp_path, method, held):
    """The error of a fixed step falls as that of a smooth motion does; else as the step does."""
    system, (steps, order) = system_of(tmp_path, ("y", "-x - sign(x)"), held=held), ORDERS[method]
    errors = []
    for step in steps:
        found = system.simulate([1, 0], (0, 30), samples=301, method=method, step=step)
        errors.append(np.abs(found.state[0] - list(map(arc, found.time))).max())
    slope = math.log(errors[0] / errors[-1]) / math.log(steps[0] / steps[-1])
    if held:
        assert slope > order - 0.1, errors
        assert errors[-1] < {"rk4": 1e-8, "dop853": 1e-11}[method]
    else:
        assert slope < 1.5, errors
        assert errors[-1] > 1e-2


def test_taylor_keeps_its_tolerance_across_kinks(tmp_path):
    """With as many steps as two smooth motions of that length take, and one for each kink."""
    system = system_of(tmp_path, ("y", "-x - sign(x)"))
    found = run_both(system, [1, 0], (0, 30), rtol=1e-12, atol=1e-12)
    assert abs(found.final["x"] - arc(30.0)) < 1e-12
    assert len(found.kinks) == 14
    assert found.steps < 60


@pytest.mark.parametrize("method", METHODS)
def test_a_kink_that_a_step_meets_twice_is_found(tmp_path, method):
    """``y' = -1`` for 0.02 while a step is 0.25 long or more; its ends are on the same side."""
    system = system_of(tmp_path, ("1", "sign((x - 1)*(x - 1) - 1/10000)"))
    step = {"step": 0.25} if method == "rk4" else {}
    found = run_both(system, [0, 0], (0, 2), method=method, **step)
    assert abs(found.final["y"] - 1.96) < 1e-12
    assert np.abs(found.kinks.time - [0.99, 1.01]).max() < 1e-12


@pytest.mark.parametrize("method", METHODS)
def test_kinks_within_kinks_are_met(tmp_path, method):
    """``y' = ||x| - 1|`` has corners where |x| is 1 and where x is 0."""
    inner = "(x*sign(x) - 1)"
    system = system_of(tmp_path, ("1", f"{inner}*sign{inner}"))
    step = {"step": 0.25} if method == "rk4" else {}
    found = run_both(system, [-2.3, 0], (0, 4.6), method=method, **step)
    assert abs(found.final["y"] - (1.3**2 + 1)) < 1e-12
    assert np.abs(found.kinks.time - [1.3, 2.3, 3.3]).max() < 1e-12
    assert [found.kinks.names[n] for n in found.kinks.kink] == [
        "x * sign(x) - 1.0",
        "x",
        "x * sign(x) - 1.0",
    ]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("start", [0.5, 0.7, -1.3])
def test_sliding_ends_a_motion(tmp_path, method, start):
    """Both sides of y = 0 push back: rates of -0.7 above it, and of 1.3 below."""
    system = system_of(tmp_path, ("1", "3/10 - sign(y)"))
    step = {"step": 0.07} if method == "rk4" else {}
    found = run_both(system, [0, start], (0, 3), samples=31, method=method, **step)
    end = start / 0.7 if start > 0 else -start / 1.3
    assert found.status == "SLIDING"
    assert abs(found.time_reached - end) < 1e-12
    assert abs(found.final["y"]) < 1e-12
    assert found.message.startswith("the motion slides along y = 0 from t = ")
    assert found.steps < 120
    assert len(found.time) == int(end / 0.1) + 2


@pytest.mark.parametrize("method", METHODS)
def test_kinks_that_follow_one_another_without_end_end_a_motion(tmp_path, method):
    """Each swing is a third of the one before, so that infinitely many end after some time."""
    system = system_of(tmp_path, ("y", "-sign(x) - sign(y)/2"))
    step = {"step": 0.07} if method == "rk4" else {}
    found = run_both(system, [0.5, 0], (0, 20), method=method, **step)
    end = math.sqrt(0.5) * (8 / 3) / (1 - 1 / math.sqrt(3))
    assert found.status == "SLIDING"
    assert abs(found.time_reached - end) < 1e-8
    assert max(map(abs, found.final.values())) < 1e-8


def test_a_motion_may_rest_on_a_kink(tmp_path):
    """Where the rates on it keep it there; and it leaves a kink that pushes it away."""
    one, other = (tmp_path / name for name in ("one", "other"))
    one.mkdir(), other.mkdir()
    found = run_both(system_of(one, ("y", "-sign(x)")), [0, 0], (0, 5))
    assert (found.status, found.final, len(found.kinks)) == ("OK", {"x": 0, "y": 0}, 0)
    found = run_both(system_of(other, ("1", "2 + sign(y)")), [0, 0], (0, 2))
    assert found.final["y"] == pytest.approx(6, abs=1e-9)


BELT = """
title = "A block on a belt that moves, held by a spring"
routes = ["canonical"]
[variables]
x = { role = "coordinate" }
p = { role = "momentum", of = "x" }
[parameters]
f = { positive = true, default = "0.5" }
w = { default = "0.25" }
[hamiltonian]
h = "p^2/2 + x^2/2"
[forces]
p = "-f*sign(p - w)"
"""


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_block_sticks_to_a_belt(tmp_path, method):
    """It overtakes the belt, falls back to its speed, and sticks where the spring is weaker."""
    found = run_both(
        system_of_spec(tmp_path, BELT), [-1, 0], (0, 9), method=method, rtol=1e-12, atol=1e-12
    )
    first = math.asin(0.25 / 1.5)  # x = 1/2 - 3/2 cos(t) until the speed is that of the belt
    place = 0.5 - 1.5 * math.cos(first)
    second = first + 2 * math.atan((-0.5 - place) / 0.25)  # half of an arc about -1/2, twice
    assert found.status == "SLIDING"
    assert np.abs(found.kinks.time[:2] - [first, second]).max() < 5e-12
    assert abs(found.final["x"] + 1 + place) < 5e-12
    assert abs(found.final["p"] - 0.25) < 1e-12
    assert "p - w = 0" in found.message


ROW = """
title = "Two blocks on a belt, of which the first one rests on it"
routes = ["nonholonomic"]
[index]
i = { size = 2 }
[variables]
x = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "x", index = "i" }
[parameters]
f = { positive = true, default = "0.5" }
w = { default = "0.25" }
[definitions]
slip = "sign(v[1] - w)"
[lagrangian]
l = "sum(i, v[i]^2/2 - x[i]^2/2) - sum(i, (x[i+1] - x[i])^2/8)"
[forces]
v_1 = "-f*slip"
[constraints]
rest_0 = "v[0] == w"
[domain]
forward = "rest_0_reaction < f"
backward = "rest_0_reaction > -f"
"""


def test_one_of_several_blocks_is_held(tmp_path):
    """The other one slides along a cosine, until both springs pull the first one off."""
    system = system_of_spec(tmp_path, ROW)
    rate, push = math.sqrt(1.25), 0.5 / 1.25  # of the second one, towards which friction pushes

    def place(t):
        drift = 0.25 * 0.25 / 1.25
        turning = (1 + push) * math.cos(rate * t) + (1 + drift) / rate * math.sin(rate * t)
        return drift * t + push - turning

    end = brentq(lambda t: 1.25 * 0.25 * t - 0.25 * place(t) - 0.5, 0, 1, xtol=1e-14)
    found = run_both(system, [0, -1, 0.25, -1], (0, 9), rtol=1e-12, atol=1e-12)
    assert system.STATE.components == ("x_0", "x_1", "v_0", "v_1")
    assert found.status == "DOMAIN"
    assert 0.3 < end < 0.6
    assert abs(found.time_reached - end) < 1e-10
    expected = [0.25 * end, place(end), 0.25]
    assert np.abs(found.state[:3, -1] - expected).max() < 1e-10


DRIVEN = """
title = "A valve that opens with time and with an input"
routes = ["canonical"]
[variables]
x = { role = "coordinate" }
p = { role = "momentum", of = "x" }
[inputs]
u = { default = 0 }
[time]
name = "t"
[hamiltonian]
h = "p - x*abs(t - 1) - max(u, 0)*x"
[domain]
below = "p < 4"
"""


@pytest.mark.parametrize("method", METHODS)
def test_kinks_in_time_and_inputs_are_met(tmp_path, method):
    """dp/dt = |t - 1| + max(u, 0), where u = t - 2; the motion leaves the domain after that."""
    system = system_of_spec(tmp_path, DRIVEN)
    inputs = (np.array([0.0, 10.0]), np.array([[-2.0, 8.0]]), "linear")
    step = {"step": 0.13} if method == "rk4" else {}
    found = run_both(system, [0, 0], (0, 10), inputs=inputs, method=method, **step)
    # 1/2 + (t - 1)^2/2 + (t - 2)^2/2 = 4
    end = (3 + math.sqrt(13)) / 2
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - end) < 1e-9
    assert np.abs(found.kinks.time - [1, 2]).max() < 1e-12


def test_members_of_a_batch_meet_their_own_kinks(tmp_path):
    """Threads, neighbours and samples change no bit; one member has those that it has alone."""
    system = system_of(tmp_path, ("y", "-sign(x)"))
    start = np.stack([np.linspace(0.1, 2, 300), np.zeros(300)])
    options = {"samples": 61, "rtol": 1e-12, "atol": 1e-12}
    found = run_both(system, start, (0, 30), threads=1, **options)
    other = system.simulate(start, (0, 30), threads=2, **options)
    assert np.array_equal(found.state, other.state)
    assert np.array_equal(found.kinks.rows, other.kinks.rows)
    size = 2 * start[0][:, None]
    assert np.abs(found.state[0] - size * swing(found.time / np.sqrt(size))).max() < 1e-11
    alone, seventh = system.simulate(start[:, 7], (0, 30), **options), found.member(7).kinks
    assert np.array_equal(alone.kinks.rows, seventh.rows)
    assert seventh.counts == found.kinks.counts[7] == len(seventh)
    assert (found.kinks.member == np.repeat(np.arange(300), found.kinks.counts.astype(int))).all()
    again = Kinks.read_record(found.kinks.as_record())
    assert np.array_equal(again.rows, found.kinks.rows)
    assert np.array_equal(again.counts, found.kinks.counts)


def test_an_event_ends_a_motion_before_its_kinks(tmp_path):
    """What was met after it is left out, though the solver went beyond it."""
    system = system_of(tmp_path, ("y", "-sign(x)"))
    whole = system.simulate([0.5, 0], (0, 40))
    found = system.simulate([0.5, 0], (0, 40), events=Event("x - 1/4", terminal=True))
    assert len(whole.kinks) == 20
    assert found.time_reached == pytest.approx(math.sqrt(0.5))
    assert len(found.kinks) == found.kinks.counts == 0


def test_a_run_that_was_broken_off_keeps_its_kinks(tmp_path, monkeypatch):
    """The checkpoint has those that were met before."""
    system = system_of(tmp_path, ("y", "-sign(x)"))
    whole = system.simulate([0.5, 0], (0, 400), target="numpy")
    place = tmp_path / "run.npz"

    def stop(stepper, run, start, threads, progress, checkpoint, watch):
        stepper.advance(run, 0, 1, 50)
        checkpoint.write(run)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("coadjoint.solve.generated.march", stop)
        with pytest.raises(KeyboardInterrupt):
            system.simulate([0.5, 0], (0, 400), checkpoint=place, target="numpy")
    found = system.simulate([0.5, 0], (0, 400), checkpoint=place, target="numpy")
    assert np.array_equal(found.kinks.rows, whole.kinks.rows)
    assert np.array_equal(found.state, whole.state)


#: A bead that meets another one at rest, after Hertz.
BEAD = """
title = "A bead"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "p^2/2 + max(q, 0)^(5/2)"
"""


@pytest.mark.parametrize("method", METHODS)
def test_a_bead_bounces_after_hertz(tmp_path, method):
    """With E = 1/2 it is in touch for a time ``4/5 (1/2)^(2/5) B(2/5, 1/2)``, and flies back."""
    system = system_of_spec(tmp_path, BEAD)
    assert np.array_equal(system.rhs([[-1.0, 0.0, 4.0], [1.0] * 3])[1], [0.0, 0.0, -20.0])
    touch = 0.8 * 0.5**0.4 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
    step = {"step": 2.0**-10} if method == "rk4" else {}
    found = system.simulate([-1, 1], (0, 4), method=method, **step)
    assert found.status == "OK"
    assert abs(found.final["p"] + 1) < 1e-6
    assert abs(found.final["q"] + (4 - 1 - touch)) < 1e-6


def test_a_bead_that_touches_is_followed_from_there(tmp_path):
    """On a kink there is no series of a root: the methods left to us are others."""
    system = system_of_spec(tmp_path, BEAD)
    touch = 0.8 * 0.5**0.4 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
    found = system.simulate([0, 1], (0, 4))
    assert (found.status, found.settings["method"]) == ("OK", "dop853")
    assert abs(found.final["q"] + (4 - touch)) < 1e-9
    assert found.drift["energy"] < 1e-9
    stopped = system.simulate([0, 1], (0, 4), method="taylor")
    assert stopped.status == "STEP_UNDERFLOW"
    assert "take method='dop853'" in stopped.message


def test_roots_at_kinks_are_followed_as_well_as_by_series(tmp_path):
    """A step whose middle is a kink looks better to ``dop853`` than it is.

    So the tolerances are tighter where the method is left to us, and those that were given where
    it is named.
    """
    system = system_of_spec(tmp_path, BEAD.replace("max(q, 0)", "abs(q)"))
    found, named = (system.simulate([1, 0.3], (0, 100), method=m) for m in ("auto", "dop853"))
    assert (found.settings["rtol"], named.settings["rtol"]) == (1e-10 * SHARE, 1e-10)
    assert found.settings["method"] == "dop853"
    assert found.drift["energy"] < 2e-9
    assert named.drift["energy"] > 2e-8
    least = system.simulate([1, 0.3], (0, 1), rtol=1e-13)
    assert least.settings["rtol"] == LEAST


def test_roots_of_squares_have_no_roundings_below_zero(tmp_path, monkeypatch):
    """``(q + 1/10)^2`` multiplied out is -2e-18 at -0.1, where its logarithm has no value."""
    text = BEAD.replace("max(q, 0)", "max(q + 1/10, 0)")
    assert text != BEAD
    system = system_of_spec(tmp_path, text)
    for target in ("c", "numpy"):
        assert system.rhs([-0.1, 1.0], target=target)[1] == 0.0
    monkeypatch.setattr(sums, "rational_root", lambda number: None)
    other = tmp_path / "multiplied_out"
    other.mkdir()
    spoiled = system_of_spec(other, text)
    assert np.isnan(spoiled.rhs([-0.1, 1.0], target="numpy")[1])


def test_powers_of_what_is_cut_off_need_no_positive_base(monkeypatch):
    """Of ``max(x, 0)`` and ``abs(x)``, above 1; of others, and below, there is no real value."""
    for written in ("max(q, 0)^(3/2)", "max(0, 1 - 2*q)^(7/3)", "abs(q + 1)^(5/2)"):
        assert derive(spec(BEAD.replace("max(q, 0)^(5/2)", written)))
    for written in ("max(q, 0)^(1/2)", "max(q, 1 - q^2)^(5/2)", "(q + max(q, 0))^(5/2)"):
        with pytest.raises(DerivationError, match="not known to be positive"):
            derive(spec(BEAD.replace("max(q, 0)^(5/2)", written)))
    monkeypatch.setattr(interpret, "find_clamped", lambda base, field: None)
    with pytest.raises(DerivationError, match="not known to be positive"):
        derive(spec(BEAD))
