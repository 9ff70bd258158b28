"""The check of a system by ``python -m``: what its methods do on runs, against what is claimed."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.cli.self_check import main
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import BALANCED, FALLING, GROWING, tell_order
from coadjoint.solve import self_check
from coadjoint.solve.folders import load_texts
from coadjoint.solve.self_check import check_methods
from coadjoint.systems import (
    double_bracket_body,
    elastic_chain,
    euler_2d,
    euler_disk,
    heavy_top,
    heavy_top_damped,
    hunter_saxton,
    metriplectic_body,
    rigid_body,
    rolling_ellipsoid,
    so8_body,
    stochastic_rigid_body,
    suslov,
    two_field_top,
)

PACKAGE = "coadjoint.systems.rigid_body"


def check(*arguments, package=PACKAGE):
    """The command, run as a person does."""
    command = [sys.executable, "-m", package, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_system_checks_its_methods():
    """Those that "auto" takes, each with its order, its defect and its drifts."""
    result = check("--check")
    assert result.returncode == 0, result.stderr
    assert "4 of 4 methods do what is claimed; 13 numbers were compared" in result.stdout
    assert "spherical_midpoint       2        2.0" in result.stdout


def test_without_check_it_says_how():
    """Usage, and the status of wrong arguments."""
    result = check()
    assert result.returncode == 2
    assert f"usage: python -m {PACKAGE} [-h] [--check [METHOD ...]]" in result.stderr


def test_a_method_that_does_not_apply_is_refused(capsys):
    """With those that do."""
    assert main(suslov.system, "here", ["--check", "splitting4"]) == 2
    said = capsys.readouterr().err
    assert "python -m here: method 'splitting4' does not apply to suslov; expected some" in said
    assert "gauss4" in said


def test_one_number_is_told_as_one(monkeypatch, capsys):
    """Where nothing but the order is compared."""
    system = rigid_body.system
    plain = tuple(replace(x, exactly=()) for x in system.METHODS if x.name == "midpoint")
    monkeypatch.setattr(system, "METHODS", plain)
    assert main(system, PACKAGE, ["--check", "all"]) == 0
    assert "; 1 number was compared with claims." in capsys.readouterr().out


def test_the_spectrum_of_a_body_on_so8_is_seen():
    """By the trace of the fourth power, which the midpoint does not keep."""
    found = {
        x.method.name: x
        for x in check_methods(so8_body.system, ["midpoint", "isospectral_midpoint"])
    }
    assert "casimir2" in found["isospectral_midpoint"].method.exactly
    assert found["isospectral_midpoint"].drifts["casimir2"] < 1e-14
    assert found["midpoint"].drifts["casimir2"] > 1e-8
    assert found["isospectral_midpoint"].defect < 1e-12
    assert self_check.find_defect(self_check.Runs(so8_body.system), "midpoint") > 1e-6


def test_high_orders_are_measured_in_longer_steps():
    """Where runs differ by roundings alone; what is exact has no order at any length."""
    found = {x.method.name: x for x in check_methods(rigid_body.system, ["gauss8", "exact_body"])}
    assert found["gauss8"].order == pytest.approx(8, abs=0.3)
    assert found["exact_body"].order is None
    assert tell_order("exact_body", found["exact_body"].method.order) == "exact"


def test_attitudes_are_rotations_where_runs_begin():
    """Of poses too, whose places are far from 0."""
    states = self_check.Runs(elastic_chain.system).states
    assert states.shape[1] == self_check.MEMBERS
    assert np.abs(elastic_chain.system.constraint_residual(states)).max() < 1e-12


def test_differences_along_the_leaf_find_the_defect():
    """Of the coadjoint mean none, of the midpoint what its order leaves."""
    mean, midpoint = (
        self_check.find_defect(runs, name)
        for runs in (self_check.Runs(two_field_top.system),)
        for name in ("coadjoint_mean", "midpoint")
    )
    assert mean < 1e-12
    assert midpoint > 1e-6


def test_methods_for_noise_are_checked_on_paths():
    """Order, drift, and the bracket with one noise for all differences; Heun's keeps nothing."""
    found = {
        each.method.name: each for each in check_methods(stochastic_rigid_body.system, ["all"])
    }
    assert not [each.failures for each in found.values() if each.failures]
    for name in ("midpoint", "coadjoint_mean", "spherical_midpoint"):
        assert found[name].drifts["casimir1"] < 1e-14
    assert found["spherical_midpoint"].defect < 1e-9
    assert found["heun"].drifts["casimir1"] > 1e-5
    assert all(abs(each.order - 0.5) < 0.2 for each in found.values())


@pytest.mark.parametrize(
    ("name", "claim", "expected"),
    [
        ("midpoint", {"order": 1}, "and 1 is claimed"),
        ("heun", {"is_poisson": True}, "from a Poisson map"),
        ("heun", {"exactly": ("casimir1",)}, "casimir1 drifts by"),
    ],
)
def test_a_false_claim_about_noise_is_caught(name, claim, expected, monkeypatch):
    """An order that processes that do not commute do not allow, the bracket, and a Casimir."""
    system = stochastic_rigid_body.system
    wrong = tuple(replace(x, **claim) if x.name == name else x for x in system.METHODS)
    monkeypatch.setattr(system, "METHODS", wrong)
    (found,) = check_methods(system, [name])
    assert [each for each in found.failures if expected in each]


def test_without_methods_there_is_nothing_to_check(capsys, monkeypatch):
    """And says so."""
    monkeypatch.setattr(rigid_body.system, "METHODS", ())
    assert main(rigid_body.system, "here", ["--check"]) == 0
    said = "No method that keeps structure applies to rigid_body"
    assert said in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "claim", "expected"),
    [
        ("midpoint", {"order": 4}, "its order is 2.0, and 4 is claimed"),
        ("midpoint", {"is_poisson": True}, "from a Poisson map"),
        ("kahan", {"exactly": ("energy",)}, "energy drifts by"),
        ("coadjoint_mean", {"exactly": ("energy",)}, "energy drifts by"),
    ],
)
def test_a_false_claim_is_caught(name, claim, expected, monkeypatch, capsys):
    """A higher order, a bracket or an integral that a method does not keep."""
    system = rigid_body.system
    wrong = tuple(replace(x, **claim) if x.name == name else x for x in system.METHODS)
    monkeypatch.setattr(system, "METHODS", wrong)
    (found,) = check_methods(system, [name])
    assert [each for each in found.failures if expected in each]
    assert main(system, PACKAGE, ["--check", name]) == 1
    assert expected in capsys.readouterr().out


@pytest.mark.parametrize("order", [7, 8])
def test_an_order_that_longer_steps_alone_show_is_compared(order, monkeypatch):
    """Of short steps roundings alone are seen: gauss6 has the order 6, whatever is claimed."""
    system = heavy_top.system
    wrong = tuple(replace(x, order=order) if x.name == "gauss6" else x for x in system.METHODS)
    monkeypatch.setattr(system, "METHODS", wrong)
    (found,) = check_methods(system, ["gauss6"])
    assert found.order == pytest.approx(6, abs=0.2)
    assert f"its order is 6.0, and {order} is claimed" in found.failures


def test_longer_steps_than_a_method_allows_accuse_nobody():
    """Their order is 4.3: that of shorter ones counts, 2e-13 to 4e-16, roundings and all."""
    ends = {4.0: 4.2004e-12, 2.0: 2.004e-13, 1.0: 4e-16, 0.5: 0.0}
    runs = SimpleNamespace(is_noisy=False, step=1.0, count=8, states=None)
    runs.run = lambda name, step, count, states: np.array([[1.0], [ends[step]]])
    runs.find_end = lambda step: np.array([[1.0], [0.0]])
    order, reached = self_check._find_order(runs, SimpleNamespace(name="gauss8", order=8))
    assert reached
    assert order == pytest.approx(np.log2(2e-13 / 4e-16))


def test_members_are_drawn_inside_the_domain():
    """A disk whose plane would have to pull is none."""
    (found,) = check_methods(euler_disk.system)
    assert found.method.name == "discrete_gradient"
    assert not found.failures
    assert found.compared == 2


@pytest.mark.parametrize("system", [euler_2d.system, hunter_saxton.system])
@pytest.mark.filterwarnings("ignore::coadjoint.ShockWarning")
def test_fields_with_conditions_begin_where_these_hold(system):
    """Of some waves alone, or with the mean 0; states of any other kind are refused."""
    runs = self_check.Runs(system)
    (found,) = check_methods(system)
    assert not found.failures
    assert found.compared >= 3
    anywhere = runs.states + 0.01 * np.random.default_rng(1).uniform(size=runs.states.shape)
    with pytest.raises(KernelArgumentError):
        runs.run("midpoint", runs.step, 1, anywhere)


def test_members_that_leave_the_domain_tell_no_order():
    """They end where they leave it, between steps, which would be read as an order of 4."""
    system = rolling_ellipsoid.system
    runs = self_check.Runs(system, 4)
    drawn = runs._draw([np.array(each.center) for each in system.STATE.values()])
    given = {"method": "rk4", "step": runs.step, "samples": 1, "target": "numpy"}
    found = system.simulate(drawn, (0, 8 * runs.step), progress=False, **given)
    left = np.asarray(found.status) != "OK"
    assert left.any()
    assert np.isfinite(found.state[..., -1]).all()
    assert np.array_equal(np.isnan(runs.run("rk4", runs.step, 8, drawn)).all(axis=0), left)
    np.testing.assert_array_equal(runs.states, drawn[:, ~left])


@pytest.mark.parametrize(
    ("system", "file", "old", "new", "method", "expected"),
    [
        # all of a part of the energy, and 1/1000 more: such steps meet, on another motion
        (
            rigid_body,
            "solver.py",
            '("flow1", 0.5)',
            '("flow1", 0.501)',
            "splitting",
            "its order is 0.0, and 2 is claimed",
        ),
        (
            rigid_body,
            "kernel.py",
            "Pi2 * _h3 - Pi3 * _h2",
            "0.99 * (Pi2 * _h3 - Pi3 * _h2)",
            "coadjoint_mean",
            "from a Poisson map",
        ),
        (
            rigid_body,
            "solver.c",
            "const V rest = 1.5 - part * both;",
            "const V rest = 1.5001 - part * both;",
            "spherical_midpoint",
            "its C is another method than its NumPy",
        ),
        (
            stochastic_rigid_body,
            "kernel.py",
            "out[4] = sigma2",
            "out[4] = 2.0 * sigma2",
            "coadjoint_mean",
            "its paths end",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore:a wrong solver was compiled")
def test_a_spoiled_text_is_caught(system, file, old, new, method, expected):
    """A file of a package that somebody changed; the method of the shipped one passes."""
    texts = {each.name: each.read_text() for each in system.system.folder.glob("*.*")}
    assert old in texts[file]
    with load_texts(texts | {file: texts[file].replace(old, new, 1)}) as spoiled:
        (found,) = check_methods(spoiled, [method])
    assert [each for each in found.failures if expected in each], found.failures
    (sound,) = check_methods(system.system, [method])
    assert not sound.failures


@pytest.mark.parametrize(
    ("system", "law", "name"),
    [
        (heavy_top_damped, BALANCED, "discrete_gradient"),
        (double_bracket_body, FALLING, "discrete_gradient"),
        (double_bracket_body, FALLING, "average_gradient"),
    ],
)
def test_laws_of_the_energy_are_measured_in_each_step(system, law, name, monkeypatch):
    """The power of friction and of a double bracket, which the method of Gauss misses."""
    claimed = tuple(replace(each, exactly=(), laws=(law,)) for each in system.system.METHODS)
    monkeypatch.setattr(system.system, "METHODS", claimed)
    sound, failed = check_methods(system.system, [name, "gauss4"])
    assert not sound.failures
    assert sound.compared == 2
    assert 0.0 <= sound.laws[law] < 1e-14
    assert [each for each in failed.failures if f"{law} is missed by" in each]


def test_an_entropy_that_falls_is_seen(monkeypatch):
    """Minus the entropy does, in each step."""
    system = metriplectic_body.system
    judged = tuple(replace(each, laws=(GROWING,)) for each in system.METHODS)
    monkeypatch.setattr(system, "METHODS", judged)
    (found,) = check_methods(system, ["metriplectic_gradient"])
    assert not found.failures
    assert found.laws[GROWING] < 0.0
    entropy = system.entropy
    monkeypatch.setattr(type(system), "entropy", lambda self, x: -entropy(x), raising=False)
    (found,) = check_methods(system, ["metriplectic_gradient"])
    assert [each for each in found.failures if f"{GROWING} is missed by" in each]


def test_growth_is_counted_from_the_first_step():
    """A drift that is proportional to the number of steps grows with the power 1."""
    numbers = np.arange(1.0, 101.0)
    values = np.ones((1, 100))
    assert self_check._find_exponent(1e-14 * numbers[np.newaxis], values) == pytest.approx(1.0)
