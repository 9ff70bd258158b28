"""Shipped fields as they are called: exact waves, what is kept, and points of other numbers."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_circulant

from coadjoint.cli.simulate import default_state
from coadjoint.errors import CoadjointError, KernelArgumentError, ResourceError, ShockWarning
from coadjoint.families import Profiles
from coadjoint.pipeline import render, verify
from coadjoint.solve.folders import load_texts
from coadjoint.solve.quantities import Quantities
from coadjoint.solve.request import check_state
from coadjoint.spec import read_spec_text
from coadjoint.systems import (
    burgers,
    camassa_holm,
    hunter_saxton,
    kdv,
    landau_lifshitz,
    spin_chain,
    spin_chain_chiral,
)
from tests.fields import (
    WAVES,
)
from tests.specs import shipped


@pytest.mark.parametrize("name", WAVES)
def test_waves_travel_as_they_should(name):
    """Errors fall by 2^4, and by 2^6 with KdV's differences, as the points double.

    In NumPy, whose bits are those of C: a solver in C takes long to compile.
    """
    system, solution, length, parameters = WAVES[name]
    order, errors = 6 if name == "kdv" else 4, []
    end, options = (
        0.5,
        {"method": "dop853", "target": "numpy", "rtol": 1e-12, "atol": 1e-13, "samples": 2},
    )
    for N in (32, 64):
        s = np.arange(N) * length / N
        found = system.resize({"s": N}).simulate(
            solution(s, 0.0)[0].ravel(), (0, end), parameters=parameters, **options
        )
        errors.append(np.abs(found.state[:, -1].reshape(-1, N) - solution(s, end)[0]).max())
    assert errors[1] < 1e-3
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.3  # with the error of the path


@pytest.mark.parametrize(
    ("system", "kept", "parameters"),
    [
        (spin_chain.system, {"energy", "P"}, None),
        (spin_chain_chiral.system, {"energy", "P", "M"}, None),
        (kdv.system, {"energy", "M"}, None),
        (camassa_holm.system, {"energy", "M"}, {"L": 1, "alpha": 0.02}),
        (hunter_saxton.system, {"energy"}, {"L": 60}),  # its M is 0
    ],
    ids=lambda each: getattr(each, "name", ""),
)
def test_the_midpoint_keeps_what_is_quadratic(system, kept, parameters):
    """Energy and momenta to rounding; a method of order 4 without structure loses them."""
    small = system.resize({"s": 32})
    source = np.random.default_rng(3)
    state = source.normal(size=small.STATE.size) / 4
    state -= np.mean(state) * (system is hunter_saxton.system)
    by = {}
    for method in ("midpoint", "rk4"):
        options = {"step": 0.01, "method": method, "target": "numpy", "samples": 2}
        found = small.simulate(state, (0, 0.2), parameters=parameters, **options)
        assert kept <= set(found.drift)
        by[method] = max(np.max(np.abs(found.drift[name])) for name in kept)
    assert by["midpoint"] < 1e-13 < by["rk4"]


def test_spins_keep_their_lengths():
    """The default with a step is the midpoint on spheres, for each point."""
    small = landau_lifshitz.system.resize({"s": 24})
    source = np.random.default_rng(5)
    spins = source.normal(size=(3, 24))
    spins /= np.linalg.norm(spins, axis=0)
    found = small.simulate(spins.ravel(), (0, 0.4), step=0.02, target="numpy", samples=2)
    assert found.settings["method"] == "spherical_midpoint"
    lengths = np.linalg.norm(found.state.reshape(3, 24, -1), axis=0)
    np.testing.assert_allclose(lengths, 1, atol=1e-13)


def test_a_run_without_a_state_begins_at_the_profile():
    """The cosine of Zabusky and Kruskal, at any number of points."""
    for count, system in ((256, kdv.system), (32, kdv.system.resize({"s": 32}))):
        expected = np.cos(2 * np.pi * np.arange(count) / count) / 3
        np.testing.assert_allclose(system.STATE["m"].default, expected, atol=1e-15)


def test_a_field_of_which_nothing_is_said_begins_at_zero():
    """For Python and on the command line, where others begin at profiles; a default is kept."""
    old = spin_chain.system.resize({"s": 32})
    kept = {"Pi": old.profiles.formulas["Pi"]}
    for profiles in (Profiles(old.profiles.lengths, kept), None):
        system = old._copy(old.index, profiles=profiles)
        assert system.counted == "points"
        start = np.reshape(check_state(system, None), (6, 32))
        assert not start[3:].any()
        assert start[:3].any() == (profiles is not None)
        assert default_state(system.STATE) == start.ravel().tolist()
    state, *others = old._declared
    told = Quantities(state["Pi"], replace(state["Xi"], default=(0.5, 0.0, 1.0)))
    old._declared = (told, *others)
    start = np.reshape(check_state(old._copy(old.index, profiles=None), None), (6, 32))
    np.testing.assert_array_equal(start[3:], np.outer([0.5, 0, 1], np.ones(32)))


#: Waves of the group of diffeomorphisms with four derivatives in the energy.
FOURTH = """
title  = "Waves with four derivatives"
routes = ["lie-poisson", "euler-poincare"]
[space]
s = { length = "L", size = 64, order = 4, derivatives = 2 }
[diffeomorphisms]
[variables]
u = { role = "velocity" }
m = { role = "momentum" }
[parameters]
L = { positive = true, default = 10 }
[lagrangian]
l = "u^2/2 + u_s^2 + u_ss^2/2"
[claims]
conserved = ["energy", "m"]
"""


def test_an_operator_of_four_derivatives_is_solved():
    """The wave u = cos k s has m = (1 + k^2)^2 u and the rate 3 k m sin k s, by each target."""
    k = 2 * np.pi / 10
    errors = []
    rendered = render(read_spec_text(FOURTH, "fourth.toml"))
    assert verify(rendered).lines["rhs"] > 0  # of rings that are as wide as the operator
    with load_texts(rendered.texts) as system:
        for count in (64, 128):
            own = system.resize({"s": count})
            s = np.arange(count) * 10 / count
            m = (1 + k**2) ** 2 * np.cos(k * s)
            rate = 3 * k * m * np.sin(k * s)
            for target in ("numpy", "c", "c-fast"):
                errors.append(np.abs(own.rhs(m, target=target) - rate).max() / np.abs(rate).max())
            waves = own.with_derivatives("fourier")
            np.testing.assert_allclose(waves.rhs(m), rate, atol=1e-12)
    assert errors[0] == errors[1] < 2e-4
    assert errors[2] == pytest.approx(errors[0], rel=1e-3)
    assert errors[0] / errors[3] == pytest.approx(16, rel=0.05)


#: A strand in a field that is the same all along it, declared by its default.
TURNED = (
    shipped("spin_chain")
    .path.read_text(encoding="utf-8")
    .replace(
        "[parameters]",
        'Gamma = { role = "advected", representation = "vector", default = [0, "0.6", "0.8"] }\n\n'
        "[parameters]",
    )
)


@pytest.mark.parametrize("profiled", [True, False])
def test_a_field_with_a_default_begins_there(profiled):
    """Next to others that have profiles, and without any, at each number of points."""
    text = TURNED if profiled else re.sub(r"(?s)\[profiles\].*?\n\n", "", TURNED)
    with load_texts(render(read_spec_text(text, "turned.toml")).texts) as system:
        for count in (256, 8):
            own = system.resize({"s": count})
            start = np.reshape(check_state(own, None), (9, count))
            np.testing.assert_array_equal(start[6:], np.outer([0, 0.6, 0.8], np.ones(count)))
            assert start[:6].any() == profiled


def test_too_few_points_for_the_differences_are_refused():
    """Seven points for KdV's differences of order 6 would meet themselves."""
    with pytest.raises(KernelArgumentError, match="at least 9"):
        kdv.system.resize({"s": 8})


def test_fields_are_told_by_their_points():
    """What is printed, wrong names of a size, and methods that do not apply."""
    system = kdv.system.resize({"s": 32})
    assert repr(system) == "<System kdv: 32 points along s; state m; parameters c, L>"
    assert "32 points along s" in repr(system.with_derivatives("fourier"))
    message = (
        r"expected a number of points along s\. .*\[space\] s = \{ length = \.\.\., size = 1000"
    )
    with pytest.raises(KernelArgumentError, match=message):
        system.resize({"i": 32})
    with pytest.raises(KernelArgumentError, match="does not apply to its points"):
        system.simulate(None, (0, 1), method="gauss4", step=0.1)


def test_fields_of_unequal_lengths_are_refused():
    """Momenta at 32 points, strains at 16."""
    ring = spin_chain.system.resize({"s": 32})
    state = {"Pi": np.ones((3, 32)), "Xi": np.ones((3, 16))}
    message = r"state\['Xi'\] has the shape \(3, 16\); expected \(3, 32\)"
    with pytest.raises(KernelArgumentError, match=message):
        ring.simulate(state, (0, 1))


def test_fields_beyond_the_memory_are_refused_before_any_work():
    """So many points, and so many samples of few."""
    with pytest.raises(ResourceError, match=r"take about .* GB; .* Choose a smaller size of s\.$"):
        spin_chain.system.resize({"s": 10**12})
    with pytest.raises(KernelArgumentError, match=r"samples take .* GB, and this machine has"):
        spin_chain.system.resize({"s": 32}).simulate(None, (0, 1), samples=10**12)


@pytest.mark.parametrize("N", [5, 6, 40, 257])
@pytest.mark.parametrize("alpha", [1e-3, 1.0, 300.0])
def test_the_energy_of_camassa_and_holm_solves_its_equation(N, alpha):
    """L/N sum m u/2 with u from a circulant matrix of SciPy, whatever alpha and N are."""
    source, L = np.random.default_rng(N), 3.0
    m, weight = source.normal(size=N), (alpha * N / L) ** 2
    row = np.zeros(N)
    for r, c in ((0, 1 + 2.5 * weight), (1, -4 / 3 * weight), (2, weight / 12)):
        for place in {r, -r % N}:
            row[place] += c
    u = solve_circulant(row, m)
    found = camassa_holm.system.resize({"s": N}).evaluate("energy", m, [alpha, L], target="numpy")
    condition = 1 + 16 / 3 * weight  # of the matrix, whose entries are rounded
    np.testing.assert_allclose(found, L / N * np.sum(m * u) / 2, rtol=1e-15 * (10 + condition))


@pytest.mark.parametrize("N", [5, 6, 40, 257])
def test_a_level_velocity_solves_its_equation(N):
    """L/N sum m u/2 with u from the pseudoinverse of the matrix -D_2, m having any mean."""
    m, L = np.random.default_rng(N).normal(size=N), 3.0
    matrix = sum(
        c * (np.roll(np.eye(N), r, axis=1) + np.roll(np.eye(N), -r, axis=1))
        for r, c in ((0, 5 / 4), (1, -4 / 3), (2, 1 / 12))
    )
    u = np.linalg.pinv(matrix, rcond=1e-9) @ m * (L / N) ** 2
    small = hunter_saxton.system.resize({"s": N})
    for target in ("numpy", "c"):
        found = small.evaluate("energy", m, [L], target=target)
        np.testing.assert_allclose(found, L / N * np.sum(m * u) / 2, rtol=1e-15 * N**2)


def test_a_momentum_with_a_mean_has_no_level_velocity():
    """Hunter and Saxton's m is a derivative; the advice is followed, for each of a batch."""
    small = hunter_saxton.system.resize({"s": 16})
    m = np.random.default_rng(0).normal(size=(16, 2)) + 1
    m[:, 0] -= m[:, 0].mean()
    options = {"target": "numpy", "samples": 2}
    with pytest.raises(KernelArgumentError, match="mean of m of hunter_saxton is") as error:
        small.simulate(m, (0, 0.1), **options)
    assert error.value.found == pytest.approx(m[:, 1].mean())
    assert "Subtract the mean" in str(error.value)
    with pytest.raises(KernelArgumentError, match="mean of m of hunter_saxton is -"):
        small.simulate(-m, (0, 0.1), **options)
    found = small.simulate(m - m.mean(axis=0), (0, 0.1), **options)
    assert np.abs(found.state.mean(axis=0)).max() < 1e-12


def test_trajectories_of_a_batch_are_solved_as_each_alone():
    """Shifts end after different numbers of doublings; each column has the bits of a single run."""
    small = camassa_holm.system.resize({"s": 24})
    source = np.random.default_rng(2)
    m, parameters = source.normal(size=(24, 3)), np.array([[0.01, 1.0, 40.0], [3.0, 3.0, 3.0]])
    found = small.evaluate("rhs", m, parameters, target="numpy")
    for n in range(3):
        alone = small.evaluate("rhs", m[:, n], parameters[:, n], target="numpy")
        np.testing.assert_array_equal(found[:, n], alone)


def test_an_equation_without_finite_factors_gives_no_numbers():
    """One whose factors are too large for doubles is not solved, and no rate is a number."""
    small = camassa_holm.system.resize({"s": 8})
    rates = small.evaluate("rhs", np.ones(8), [1e200, 1.0], target="numpy")
    assert np.isnan(rates).all()


def test_the_method_of_taylor_is_refused_where_an_equation_is_solved():
    """Rates contain the solution of a linear equation; auto takes another method."""
    small = camassa_holm.system.resize({"s": 16})
    with pytest.raises(CoadjointError, match="solution of a linear equation"):
        small.simulate(np.ones(16), (0, 0.1), method="taylor", target="numpy")
    found = small.simulate(np.ones(16), (0, 0.1), target="numpy", samples=2)
    assert found.settings["method"] == "dop853"
    np.testing.assert_allclose(found.state, 1, rtol=1e-14)


@pytest.mark.parametrize(("amplitude", "end", "warns"), [(1.0, 0.33, False), (2.0, 0.2, True)])
def test_a_run_says_when_its_shock_comes(amplitude, end, warns):
    """u_t + 3 u u_s = 0 with A sin s breaks at 1/(3 A), by its characteristics s + 3 u t."""
    system, found = burgers.system, []
    state = amplitude * np.sin(2 * np.pi * np.arange(128) / 128)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", ShockWarning)
        found = system.simulate(state, (0, end), samples=2, target="numpy", method="rk4", step=1e-3)
    assert found.state.shape == (128, 2)
    messages = [str(each.message) for each in told if each.category is ShockWarning]
    assert len(messages) == warns
    if warns:
        said = float(re.search(r"shock near t = ([\d.]+)", messages[0])[1])
        np.testing.assert_allclose(said, 1 / (3 * amplitude), rtol=1e-3)
        assert "earlier end" in messages[0]


def test_the_steepest_fall_tells_the_time_of_a_shock():
    """Of u = sin s + 0.3 sin 2 s that is 0.8083 at cos s = -1/2.4; the steepest rise is 1.6.

    The time is that after the beginning of a run, which is at t = 2.
    """
    s, place = 2 * np.pi * np.arange(128) / 128, -1 / 2.4
    steepest = -(place + 0.6 * (2 * place**2 - 1))
    state = np.sin(s) + 0.3 * np.sin(2 * s)
    options = {"samples": 2, "target": "numpy", "method": "rk4", "step": 2e-3}
    with pytest.warns(ShockWarning) as told:
        burgers.system.simulate(state, (2, 2.5), **options)
    (message,) = (str(each.message) for each in told if each.category is ShockWarning)
    said = float(re.search(r"shock near t = ([\d.]+)", message)[1])
    np.testing.assert_allclose(said - 2, 1 / (3 * steepest), rtol=1e-3)


def test_before_its_shock_the_motion_is_that_of_characteristics():
    """At half of the time u(s + 3 u t) = sin s; a field that falls nowhere has no shock."""
    N, t = 128, 1 / 6
    s = 2 * np.pi * np.arange(N) / N
    found = burgers.system.simulate(
        np.sin(s), (0, t), samples=2, target="numpy", method="rk4", step=2e-3
    )
    label = s - 3 * t * np.sin(s)
    for _ in range(60):
        label -= (label + 3 * t * np.sin(label) - s) / (1 + 3 * t * np.cos(label))
    np.testing.assert_allclose(found.state[:, -1], np.sin(label), atol=2e-4)
    burgers.system.simulate(np.ones(N), (0, 1), samples=2, target="numpy", method="rk4", step=0.02)


@pytest.mark.parametrize("part", [0.9, 1.1])
def test_hunter_and_saxton_break_when_books_say(part):
    """The sine with u0' from -1 to 1: b = 1/sqrt(8), (pi/2 - arctan(sqrt(2)))/b = 1.7408."""
    assert hunter_saxton.system.wave == ("u", "L")
    breaks = (np.pi / 2 - np.arctan(2**0.5)) * 8**0.5
    options = {"samples": 2, "target": "numpy", "method": "rk4", "step": 0.02}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", ShockWarning)
        hunter_saxton.system.simulate(None, (0, part * breaks), **options)
    messages = [str(each.message) for each in told if each.category is ShockWarning]
    assert len(messages) == (part > 1)
    for each in messages:
        said = float(re.search(r"shock near t = ([\d.]+)", each)[1])
        np.testing.assert_allclose(said, breaks, rtol=1e-5)


def test_other_fields_have_no_such_time():
    """The waves of Camassa and Holm's equation and those that disperse are not carried alone."""
    assert burgers.system.wave == ("3*m", "L")
    assert not camassa_holm.system.wave
    assert not kdv.system.wave
