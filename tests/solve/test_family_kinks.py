"""Kinks of equal members: steps end at the earliest of them, and methods keep their order.

Expected values are closed forms between kinks, joined by hand, and systems that are written out.
"""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import coadjoint
from coadjoint import pipeline
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.errors import CrossCheckError
from coadjoint.lower import families, family_kinks
from coadjoint.lower.families import lower_family
from coadjoint.lower.family_check import check_loops
from coadjoint.solve import ensemble, kernels
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import family_of, read, render
from tests.kernels import COMPILER
from tests.solve.test_kinks import arc

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
HEAD = """
title = "Particles with forces that jump"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { index = "i", default = 1, positive = true }
[hamiltonian]
"""
#: Each is pulled to 0 by the constant force k[i].
FREE = f'{HEAD}h = "sum(i, p[i]^2/2 + k[i]*abs(q[i]))"\n'
#: Each is pulled by a spring as well.
ARCS = f'{HEAD}h = "sum(i, p[i]^2/2 + q[i]^2/2 + k[i]*abs(q[i]))"\n'
#: Springs that only push, stops that only hold, and a force that begins with time, of a chain.
LINKED = f"""{HEAD}
h = \"\"\"sum(i, p[i]^2/2 + k[i]*q[i]^2/2) + sum(i, max(q[i+1] - q[i], 0)^2)
  + sum(i, abs(q[i-1] - q[i+1] - 1))
  + max(t - 1, 0)*sum(i, q[i])\"\"\"
[time]
name = "t"
"""
#: Each is pushed away by a force that is larger beyond 0: who gets there comes back at once.
DIPS = f'{HEAD}h = "sum(i, p[i]^2/2 - 2*q[i] + k[i]*abs(q[i]))"\n'
PAIRS = f'{HEAD}h = "sum(i, p[i]^2/2 + q[i]^2/2) + sum(i, j, i < j, abs(q[i] - q[j]))"\n'
METHODS = ("taylor", "dop853", "rk4")


def load(text):
    """A family by its text."""
    return load_texts(render(text, "kinked").texts)


@pytest.fixture(scope="module")
def free():
    """Particles that move on parabolas."""
    with load(FREE) as system:
        yield system


@pytest.fixture(scope="module", params=["in a loop", "written out"])
def pushed(request):
    """Four particles that are pushed back from beyond 0."""
    size = "size = 4, written_out = true" if request.param == "written out" else "size = 4"
    with load(DIPS.replace("size = 6", size)) as system:
        yield system


def swing(t, amplitude, pull):
    """The motion of ``x'' = -k sign(x)`` from rest: parabolas, with the period 4 sqrt(2 a/k)."""
    quarter = np.sqrt(2 * amplitude / pull)
    parts = np.asarray(t) % (4 * quarter) / quarter
    folded = np.where(parts < 2, parts, 4 - parts)
    return amplitude * np.where(folded < 1, 1 - folded**2, (2 - folded) ** 2 - 1)


@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize("method", METHODS)
def test_parabolas_of_all_members_are_followed(free, method, target):
    """Every kink of every member is met, at its time and by its name."""
    system, n = free.resize({"i": 5}), 5
    amplitudes, pulls = np.linspace(0.5, 1.1, n), np.linspace(1.0, 1.7, n)
    times = np.linspace(0, 30, 31)
    step = {"step": 0.1} if method == "rk4" else {"rtol": 1e-12, "atol": 1e-12}
    given = {"q": amplitudes, "p": np.zeros(n)}
    run = {"parameters": {"k": pulls}, "method": method, "target": target}
    found = system.simulate(given, times, **run, **step)
    expected = swing(times, amplitudes[:, None], pulls[:, None])
    assert np.abs(found["q"] - expected).max() < 1e-9
    quarters = np.sqrt(2 * amplitudes / pulls)
    met = {f"q[{i}]": np.arange(quarters[i], 30, 2 * quarters[i]) for i in range(n)}
    assert len(found.kinks) == sum(map(len, met.values()))
    for place, name in enumerate(found.kinks.names):
        own = found.kinks.time[found.kinks.kink == place]
        np.testing.assert_allclose(own, met[name], rtol=0, atol=1e-9)


def test_trajectories_of_a_batch_meet_kinks_of_their_own(free):
    """A batch has the bits of its trajectories."""
    system = free.resize({"i": 3})
    state = np.concatenate([np.random.default_rng(3).uniform(0.5, 1.5, (3, 4)), np.zeros((3, 4))])
    both = system.simulate(state, (0, 9), samples=4, method="dop853", target="numpy")
    assert both.kinks.counts.min() > 6
    for n in range(4):
        one = system.simulate(state[:, n].copy(), (0, 9), samples=4, method="dop853")
        assert np.array_equal(one.state, both.state[:, n])
        assert one.kinks.counts == both.kinks.counts[n]


def dip(t, met, speed):
    """The motion of ``x'' = 2 - sign(x)`` that meets 0 when asked to, and back again: parabolas."""
    low = 2 * speed / 3
    after = t - met - low
    below = (after + low) * (1.5 * (after + low) - speed)
    above = np.where(after < 0, -after - low, after)
    return np.where((-low < after) & (after < 0), below, above * (speed + above / 2))


@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize("method", METHODS)
def test_a_kink_from_which_a_step_comes_back_ends_it(pushed, method, target):
    """Brief ways beyond 0 inside steps of length 1, the first of them too, and some just not."""
    met = np.array([[0.53, 0.13, 0.66], [0.31, 0.93, 0.74], [0.49, 0.27, 2.61]])
    speed = np.array([[0.06, 0.03, 0.015], [0.03, 0.06, 0.015], [0.06, 0.015, 0.03]])
    back = np.array([[0.3, 0.4, 0.8]])  # these turn at 1e-4 above 0
    start = np.concatenate([dip(0, met, speed), 1e-4 + back**2 / 2, -speed - met, -back])
    times = np.linspace(0, 4, 5)
    step = {"step": 1.0} if method == "rk4" else {"rtol": 1e-12, "atol": 1e-12}
    found = pushed.simulate(start, times, method=method, target=target, **step)
    expected = dip(times, met[..., None], speed[..., None])
    assert np.abs(found.state[:3] - expected).max() < 1e-9
    assert np.all(found.kinks.counts == 6)
    for n in range(3):
        own = found.kinks.time[found.kinks.member == n]
        known = np.sort([met[:, n], met[:, n] + 2 * speed[:, n] / 3], axis=None)
        np.testing.assert_allclose(own, known, rtol=0, atol=1e-9)


@pytest.mark.parametrize("held", [True, False], ids=["held", "control"])
def test_methods_keep_their_order_across_kinks(monkeypatch, held):
    """The error of a fixed step falls as that of a smooth motion does; else as the step does."""
    if not held:
        for module in (families, family_kinks):
            monkeypatch.setattr(module, "hold_family", lambda _: None)
    late = np.array([0.0, 0.3])  # the second particle is ahead of the first one
    with load_texts(pipeline.render(read(ARCS)).texts) as system:
        pair = system.resize({"i": 2})
        start = [arc(t) for t in late]
        assert all(x > 0 for x in start)
        speeds = [-2 * math.sin(t) for t in late]
        for method, steps, order in (("rk4", (0.4, 0.1, 0.025), 4), ("dop853", (0.8, 0.4, 0.2), 8)):
            errors = []
            for step in steps:
                run = {"samples": 61, "method": method, "step": step}
                found = pair.simulate({"q": start, "p": speeds}, (0, 30), **run)
                exact = [[arc(t + shift) for t in found.time] for shift in late]
                errors.append(np.abs(found["q"] - exact).max())
            slope = math.log(errors[0] / errors[-1]) / math.log(steps[0] / steps[-1])
            assert slope > order - 0.5 if held else slope < 1.6, errors
            assert (found.kinks is None) is not held


def test_members_of_a_chain_move_as_those_that_are_written_out():
    """Kinks between neighbours, at the ends of the chain and in time, in both targets."""
    texts = {f"q_{n}": f'q_{n} = {{ role = "coordinate" }}' for n in range(4)}
    texts |= {f"p_{n}": f'p_{n} = {{ role = "momentum", of = "q_{n}" }}' for n in range(4)}
    energy = [f"p_{n}^2/2 + q_{n}^2/2 + max(t - 1, 0)*q_{n}" for n in range(4)]
    energy += [f"max(q_{n + 1} - q_{n}, 0)^2" for n in range(3)]
    energy += [f"abs(q_{n} - q_{n + 2} - 1)" for n in range(2)]
    written = f"""
title = "The same, written out"
routes = ["canonical"]
[variables]
{chr(10).join(texts.values())}
[hamiltonian]
h = "{" + ".join(energy)}"
[time]
name = "t"
"""
    start = np.array([0.3, -0.4, 0.9, -1.2, 0.0, 0.8, 0.0, -0.5])
    run = {"rtol": 1e-11, "atol": 1e-11}
    with load(written) as single, load(LINKED) as chain:
        names = dict(zip(texts, start.tolist(), strict=True))
        expected = single.simulate(names, (0, 12), **run)
        assert len(expected.kinks) > 15
        four = chain.resize({"i": 4})
        for target in ("c", "numpy"):
            found = four.simulate(start, (0, 12), target=target, **run)
            np.testing.assert_allclose(found.state[:4, -1], expected.state[:4, -1], atol=1e-8)
            np.testing.assert_allclose(found.kinks.time, expected.kinks.time, atol=1e-8)
        met = {found.kinks.names[n] for n in found.kinks.kink}
        assert {"t - 1"} < met <= {"t - 1", *four.kink_names}


def test_a_kink_between_neighbours_belongs_to_one_of_them():
    """Both read its sign; the last member of a chain has none."""
    held = family_kinks.hold_family(family_of(read(LINKED)))
    assert held is not None
    assert len(held.kinks) == 3
    names = family_kinks.name_kinks(family_of(read(LINKED)))
    assert [name.count("[i]") for name in names[None]].count(1) == 2
    assert [row.count("1") for row in (names[-1], names[-2])] == [2, 1]


@pytest.mark.parametrize("place", [None, -1])
def test_a_wrong_kink_is_seen(place):
    """Where an argument is another one, or missing at an end at which it is read."""
    family = family_of(read(LINKED))
    loops = lower_family(family)
    check_loops(family, loops)
    kinks = loops["kinks"]
    first, *others = kinks.member.program.outputs
    turned = replace(kinks.member.program, outputs=(*others, first))
    if place is None:
        wrong = replace(kinks, member=replace(kinks.member, program=turned))
    else:
        last = dict(kinks.ends)[-1]
        wrong = replace(kinks, ends=((-1, last), (-2, last)))
    with pytest.raises(CrossCheckError, match=r"rung 2: (kinks|sided_rhs)"):
        check_loops(family, {**loops, "kinks": wrong})


def test_wrong_rates_of_a_side_are_seen():
    """Two results change places, or a sign is read at another member."""
    family = family_of(read(FREE))
    loops = lower_family(family)
    rates = loops["sided_rhs"]
    turned = replace(rates.member.program, outputs=rates.member.program.outputs[::-1])
    wrong = replace(rates, member=replace(rates.member, program=turned))
    with pytest.raises(CrossCheckError, match="rung 2: sided_rhs"):
        check_loops(family, {**loops, "sided_rhs": wrong})


@pytest.mark.parametrize("targets", [("numpy",), pytest.param(None, marks=pytest.mark.campaign)])
def test_the_ladder_is_climbed(targets):
    """Rungs 3 to 5 of rates with given signs, and of what these are the signs of."""
    rendered = render(LINKED, "kinked")
    own = rendered.family
    with load_texts(rendered.texts) as system:
        report = crosscheck_family(own, rendered.texts, system, targets)
    for name in ("sided_rhs", "kinks"):
        assert report.lines[name] > 0
        assert all(figures.points > 20 for figures in report.figures[name].values())


def test_kinks_of_pairs_are_told_of():
    """Steps cross them, which is not silent; those of members are met all the same."""
    run = {"t": (0, 0.1), "method": "rk4", "step": 0.01}
    kernels._said.clear()
    with load(PAIRS) as system:
        with pytest.warns(coadjoint.KinkWarning, match=r"where q\[i\] - q\[j\] is 0"):
            found = system.simulate(np.linspace(0.1, 1, 12), **run)
        assert found.kinks is None
        kernels._said.clear()
        with warnings.catch_warnings():
            warnings.simplefilter("error", coadjoint.KinkWarning)
            for _ in range(2):  # the second run as well
                with pytest.raises(coadjoint.KinkWarning, match="a sum that is smooth"):
                    system.simulate(np.linspace(0.1, 1, 12), **run)


def fall(places, speeds, end):
    """Sheets that attract each other by a force of any distance, from one meeting to the next.

    Between meetings each falls with the number of those to its right minus those to its left.
    """
    q, v, left, meetings = np.array(places), np.array(speeds), end, 0
    while True:
        pull = np.array([np.sign(q - x + 1e-12 * (v - u)).sum() for x, u in zip(q, v, strict=True)])
        after, pairs = left, [(i, j) for i in range(len(q)) for j in range(i)]
        for i, j in pairs:  # of x + u t + a t^2/2 the first root that is later than now
            roots = np.roots([(pull[i] - pull[j]) / 2, v[i] - v[j], q[i] - q[j]])
            later = [root.real for root in roots if not root.imag and root.real > 1e-6]
            after = min([after, *later])
        q, v, left = q + v * after + pull * after**2 / 2, v + pull * after, left - after
        if not left:
            return q, meetings
        meetings += 1


def test_steps_end_at_kinks_of_pairs_that_are_written_out():
    """Sheets of mass one, whose motion is known: fixed steps are exact, in a loop they are not."""
    sheets = HEAD.replace("size = 6", "size = 4") + (
        'h = "sum(i, p[i]^2/2) + sum(i, j, i < j, abs(q[i] - q[j]))"\n'
    )
    written = sheets.replace("size = 4", "size = 4, written_out = true")
    spec = read_spec_text(written, "kinked.toml")
    assert spec.written == "written_out = true asks for it"
    places, speeds = [-1.1, -0.2, 0.45, 1.3], [0.3, -0.1, 0.2, -0.45]
    expected, meetings = fall(places, speeds, 5.0)
    assert meetings > 10
    errors, run = [], {"method": "rk4", "step": 0.04, "t": (0, 5)}
    for text in (written, sheets):
        with load(text) as system, warnings.catch_warnings():
            warnings.simplefilter("ignore", coadjoint.KinkWarning)
            found = system.simulate(np.array(places + speeds), **run)
            errors.append(np.abs(found.state[:4, -1] - expected).max())
            if text == written:
                assert len(found.kinks) == meetings
    assert errors[0] < 1e-8 < 1e-4 < errors[1], errors


def test_smooth_sums_over_pairs_give_no_warning():
    """The advice of the warning: with the sum made smooth, there is none."""
    kernels._said.clear()
    smooth = PAIRS.replace("abs(q[i] - q[j])", "sqrt((q[i] - q[j])^2 + 1/100)")
    assert smooth != PAIRS
    with load(smooth) as system, warnings.catch_warnings():
        warnings.simplefilter("error", coadjoint.KinkWarning)
        found = system.simulate(np.linspace(0.1, 1, 12), (0, 0.1), method="rk4", step=0.01)
        assert abs(found.drift["energy"]) < 1e-6


#: Beads in a row that touch after Hertz, a chain of Nesterenko.
BEADS = HEAD + 'h = "sum(i, p[i]^2/(2*k[i])) + sum(i, 2/5*max(q[i] - q[i+1], 0)^(5/2))"\n'


def test_a_chain_of_beads_has_forces_after_hertz():
    """``F = max(q[i] - q[i+1], 0)^(3/2)``, also where beads just touch, and no force beyond."""
    source = np.random.default_rng(5)
    q, p, k = source.normal(size=6), source.normal(size=6), source.uniform(1, 2, 6)
    q[2] = q[1]
    force = np.maximum(q[:-1] - q[1:], 0) ** 1.5
    expected = [*(p / k), *(np.append(0, force) - np.append(force, 0))]
    with load(BEADS) as system:
        for target in ("numpy", "c"):
            found = system.rhs([*q, *p], {"k": k}, target=target)
            assert np.allclose(found, expected, rtol=1e-12, atol=1e-14), target


def strike(system, n, speed=1.0, **given):
    """Beads at rest, all in touch, of which the first one is struck."""
    p = np.zeros(n)
    p[0] = speed
    return system.simulate({"q": np.zeros(n), "p": p}, **given)


def test_a_struck_chain_of_touching_beads_has_a_solitary_wave():
    """Times scale by ``v^(-1/5)``, so that Nesterenko's wave has a speed ~ ``v^(1/5)``."""
    n, times = 30, np.linspace(0, 60, 9)

    def rates(_, y):
        force = np.maximum(y[: n - 1] - y[1:n], 0) ** 1.5
        return [*y[n:], *(np.append(0, force) - np.append(force, 0))]

    start = np.zeros(2 * n)
    start[n] = 1.0
    expected = solve_ivp(rates, (0, 60), start, "DOP853", times, rtol=1e-12, atol=1e-15)
    with load(BEADS) as small:
        system = small.resize({"i": n})
        found = strike(system, n, t=times)
        assert found.status == "OK"
        assert found.settings["method"] == "dop853"
        assert found.steps < 1000
        assert np.abs(found.state - expected.y).max() < 1e-7
        assert found.drift["energy"] < 1e-9
        assert abs(found["p"][:, -1].sum() - 1) < 1e-12
        passed = []
        for speed in (1.0, 32.0):
            given = {"t": (0, 14 / speed**0.2), "events": ["p[3] - p[4]", "p[7] - p[8]"]}
            wave = strike(system, n, speed, **given)
            begun, ended = (wave.events[each].time[0] for each in given["events"])
            passed.append(4 / (ended - begun))
        assert abs(passed[1] / passed[0] - 2) < 1e-8
        fixed = strike(system, n, t=(0, 5), method="rk4", step=1 / 128, target="numpy")
        assert fixed.status == "OK"
        assert fixed.drift["energy"] < 1e-7
        stopped = strike(system, n, t=(0, 1), method="taylor", target="numpy")
        assert stopped.status == "STEP_UNDERFLOW"
        assert "take method='dop853'" in stopped.message


def test_beads_with_gaps_are_followed_through_exact_touches():
    """The base of a root is a square as a whole, so that no rounding of it is below zero."""
    with load(BEADS.replace("max(q[i] - q[i+1], 0)", "max(q[i] - q[i+1] + 1/10, 0)")) as small:
        system = small.resize({"i": 20})
        touching = np.append(-0.1, np.zeros(19))
        assert np.isfinite(system.rhs(np.append(touching, np.zeros(20)))).all()
        found = strike(system, 20, t=(0, 15))
        assert found.status == "OK"
        assert found.drift["energy"] < 1e-8


def test_kinks_that_no_tolerance_sees_end_no_step(monkeypatch):
    """If all of them did, beads that touch by roundings of their places would slide."""
    with load(BEADS) as small:
        system = small.resize({"i": 10})
        assert strike(system, 10, t=(0, 2), target="numpy").status == "OK"
        monkeypatch.setattr(ensemble, "ALIKE", 0.0)
        assert strike(system, 10, t=(0, 2), target="numpy").status == "SLIDING"


@pytest.mark.parametrize("index", ["size = 6", "size = 6, written_out = true"])
def test_springs_that_touch_have_the_same_bits_in_c_and_numpy(index):
    """Rates are compared on both sides of kinks, for one trajectory and for some at a time."""
    chain = f'{HEAD}h = "sum(i, p[i]^2/(2*k[i])) + sum(i, max(q[i] - q[i+1], 0)^2)"\n'
    starts = np.zeros((12, 5))
    starts[6] = [1, 2, 0.5, 1e-3, 1]
    with load(chain.replace("size = 6", index)) as system:
        for own in (starts, starts[:, 0]):
            for method in ({}, {"method": "dop853"}, {"method": "rk4", "step": 0.01}):
                runs = [system.simulate(own, (0, 4), target=t, **method) for t in ("c", "numpy")]
                assert np.all(runs[0].status == "OK"), method
                assert np.array_equal(runs[0].state, runs[1].state), method
                assert len(runs[0].kinks.rows) > 5
                assert np.array_equal(runs[0].kinks.rows, runs[1].kinks.rows), method
                assert np.max(runs[0].drift["energy"]) < 1e-6, method
