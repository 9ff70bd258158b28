"""Discrete gradients of equal members and of fields: the energy, whatever it is, to rounding."""

import json

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.derive import action
from coadjoint.errors import CrossCheckError
from coadjoint.solve import family_steps
from coadjoint.solve.folders import load_texts
from coadjoint.solve.self_check import check_methods
from tests.families import (
    CHAIN,
    CLOSED,
    DRAG,
    PEAKONS,
    RING,
    VORTICES,
    read,
    render,
    require_wrong_steps,
    write_ring,
)
from tests.specs import shipped

METHODS = ("discrete_gradient", "discrete_gradient4", "average_gradient")
#: Spins on a ring with an energy of degree 4, which is a polynomial, so that bits can be compared.
QUARTIC = RING.replace("S[i], S[i+1])) +", "S[i], S[i+1])) + sum(i, S[i, 1]^4) +").replace(
    '"energy", "M"]', '"energy"]'
)
#: A strand whose stiffness grows with its turns.
STRAND = (
    shipped("spin_chain")
    .path.read_text(encoding="utf-8")
    .partition("[observables]")[0]
    .replace('"euler-poincare", "lie-poisson", "hamilton-pontryagin"', '"euler-poincare"')
    .replace('diag(K)*Xi)/2"', 'diag(K)*Xi)/2 - (Xi[1] + Xi[2]/2)^4/4"')
)
#: A row of numbers, each of which eats the next one, with an energy of degree 3.
LATTICE = """
title = "Lattice of Volterra with cubes"
routes = ["poisson"]

[index]
i = { size = 7 }

[variables]
c = { role = "coordinate", index = "i", default = 1 }

[poisson.brackets]
"{c[i], c[i+1]}" = "c[i]*c[i+1]"

[hamiltonian]
h = "sum(i, c[i] + c[i]^3)"
"""
FREE = STRAND.replace("order = 4", 'order = 2, ends = "free"')
#: A magnet with an anisotropy of degree 4.
MAGNET = (
    shipped("landau_lifshitz")
    .path.read_text(encoding="utf-8")
    .replace('- dot(B, S)"', '- dot(B, S) + (S[1] + S[3]/2)^4/4"')
    .replace("3*sin(4*pi*s/L)/5, 4/5", "3*sin(4*pi*s/L)/5 + sin(2*pi*s/L)/4, 4/5")
    .replace("order = 4", "order = 2")
)


@pytest.fixture(scope="module")
def texts():
    """The files of the spins."""
    return render(QUARTIC).texts


@pytest.fixture(scope="module")
def ring(texts):
    """Spins on a ring."""
    with load_texts(texts) as system:
        yield system


@pytest.fixture(scope="module")
def chain():
    """Masses on a line, with exponentials."""
    with load_texts(render(CHAIN).texts) as system:
        yield system


def draw_spins(n, members=1):
    """Spins in all directions."""
    spins = np.random.default_rng(n).normal(size=(3, n, members))
    spins = (spins / np.linalg.norm(spins, axis=0)).reshape(3 * n, members)
    return spins if members > 1 else spins[:, 0]


def judge(text):
    """All methods by name, as the certificate has them."""
    found = json.loads(render(text).texts["certificate.json"])["methods"]
    return {each["name"]: each for each in found}


# -- what is proved -------------------------------------------------------------------------------


def test_what_a_theorem_needs_decides():
    """Polynomials and others, Casimirs of degree 2; none is the default."""
    spins, masses = judge(QUARTIC), judge(CHAIN)
    for name in METHODS:
        assert spins[name]["exactly"] == ["energy", "dot(S[i], S[i])"]
        assert not spins[name]["is_poisson"]
        assert not spins[name]["rank"]
    assert masses["discrete_gradient"]["exactly"] == ["energy"]
    assert masses["average_gradient"]["exactly"] == []  # exp is no polynomial
    assert "degree 10 or less" in masses["average_gradient"]["decides"]
    assert "h g.f" in judge(DRAG)["discrete_gradient"]["decides"]


def test_one_is_the_default_where_no_other_method_keeps_anything():
    """A bracket of neighbours that is not linear, and an energy of degree 3."""
    found = judge(LATTICE)
    assert found["discrete_gradient"]["exactly"] == ["energy"]
    assert [name for name, each in found.items() if each["rank"]] == ["discrete_gradient"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (RING, "its energy is quadratic, so that the gradient at the middle of a step is a "),
        (PEAKONS, "its rates have kinks"),
    ],
    ids=["quadratic", "kinks"],
)
def test_what_has_none_says_why(text, reason):
    """A quadratic energy is told to be that of the midpoint, and has no functions for it."""
    found = judge(text)
    for name in METHODS:
        assert not found[name]["cost"]
        assert reason in found[name]["decides"]
    assert "bracket_vector" not in render(text).texts["kernel.c"]


def test_friction_refuses_steps_back_in_time():
    """Of all compositions, where a dissipation function takes energy."""
    text = CHAIN.replace("[observables]", '[dissipation]\nR = "sum(i, v[i]^2)/2"\n[observables]')
    text = text.replace(
        "[variables]", '[variables]\nv = { role = "velocity", of = "q", index = "i" }'
    )
    text = text.replace('conserved = ["energy", "P"]', "")
    found = judge(text)
    for name in ("midpoint4", "midpoint6", "discrete_gradient4"):
        assert "go back in time" in found[name]["decides"]
    assert found["discrete_gradient"]["rank"] == 1
    assert found["midpoint"]["cost"]


# -- runs -----------------------------------------------------------------------------------------


def test_steps_of_a_ring_are_those_of_the_spins_written_out(ring):
    """Four spins, by loops over members and by the solvers of a system without an index."""
    n, start = 4, draw_spins(4)
    text = write_ring(n).replace('h = "', 'h = "' + "".join(f"S_{k}[1]^4 + " for k in range(n)))
    D, by_member = [0.3, 0.1, 0.7, 0.2], start.reshape(3, n).T.ravel()
    with load_texts(render(text).texts) as written:
        for method in METHODS:
            given = {"method": method, "step": 0.05, "samples": 5, "target": "numpy"}
            one = ring.resize({"i": n}).simulate(start, (0, 1), {"J": 0.9, "D": D}, **given)
            other = written.simulate(by_member, (0, 1), np.array([0.9, *D]), **given)
            assert one.status == other.status == "OK"
            expected = other.state.reshape(n, 3, -1).transpose(1, 0, 2).reshape(3 * n, -1)
            assert np.abs(one.state - start[:, None]).max() > 0.2
            np.testing.assert_allclose(one.state, expected, atol=2e-13)


@pytest.mark.parametrize("members", [1, 3, 11])
def test_c_has_the_bits_of_numpy(ring, members):
    """By one lane, by some of a vector, and by more than one, with counts of sweeps."""
    system = ring.resize({"i": 21})
    start = draw_spins(21, members)
    for method in ("discrete_gradient", "discrete_gradient4", "average_gradient"):
        given = {"method": method, "step": 0.2, "samples": 3}
        one, other = (system.simulate(start, (0, 1), target=to, **given) for to in ("c", "numpy"))
        assert np.all(np.asarray(one.status) == "OK")
        assert one.state.tobytes() == other.state.tobytes()
        assert np.array_equal(one.sweeps, other.sweeps)


@pytest.mark.parametrize("longer", [1, pytest.param(4, marks=pytest.mark.campaign)])
def test_the_energy_stays_where_the_midpoint_loses_it(ring, chain, longer):
    """Over a thousand steps or more, of few members and of many; squared radii stay as well."""
    given = {"step": 0.1, "samples": 11}
    for n, steps in ((16, 1000 * longer), (1000, 25 * longer)):
        system, start = ring.resize({"i": n}), draw_spins(n)
        end = 0.1 * steps
        kept = system.simulate(start, (0, end), method="discrete_gradient", **given)
        lost = system.simulate(start, (0, end), method="midpoint", **given)
        assert kept.status == lost.status == "OK"
        assert kept.drift["energy"] < 1e-13
        assert lost.drift["energy"] > 1e-5
        squares = (kept.state.reshape(3, n, -1) ** 2).sum(axis=0)
        assert np.abs(squares - 1).max() < 1e-12
    line = chain.resize({"i": 12})
    start = np.random.default_rng(3).normal(size=24)
    drift = {
        name: line.simulate(start, (0, 50 * longer), method=name, **given).drift["energy"]
        for name in ("discrete_gradient", "midpoint")
    }
    assert drift["discrete_gradient"] < 1e-13
    assert drift["midpoint"] > 1e-4


def test_long_steps_need_the_energies_at_both_ends(chain, monkeypatch):
    """Of exponentials Gauss's formula is no discrete gradient: the correction keeps the energy."""
    line = chain.resize({"i": 6})
    start = np.random.default_rng(4).normal(size=12)

    def drift(method):
        given = {"method": method, "step": 0.25, "samples": 11, "target": "numpy"}
        found = line.simulate(start, (0, 4), **given)
        assert found.status == "OK"
        return found.drift["energy"]

    assert drift("discrete_gradient") < 1e-13
    assert drift("average_gradient") > 1e-11
    monkeypatch.setattr("coadjoint.solve.methods.discrete_gradient.ROUNDINGS", np.inf)
    assert drift("discrete_gradient") > 1e-11


def test_roundings_of_many_members_decide_nothing(chain, monkeypatch):
    """Steps are so short that the mean of the gradient has nothing to correct."""
    n = 1000
    line, k = chain.resize({"i": n}), {"k": np.zeros(n)}
    start = np.concatenate([0.8 * np.arange(n), np.random.default_rng(1).normal(size=n)])

    def run(method):
        given = {"method": method, "step": 0.1, "samples": 1, "target": "numpy"}
        return line.simulate(start, (0, 3), k, **given).state

    mean = run("average_gradient")
    np.testing.assert_array_equal(run("discrete_gradient"), mean)
    monkeypatch.setattr("coadjoint.solve.methods.discrete_gradient.LANES", np.inf)
    assert (run("discrete_gradient") != mean).any()


def test_orders_and_drifts_are_those_that_are_claimed(ring):
    """As `python -m` measures them: 2 and 4."""
    for found in check_methods(ring.resize({"i": 5}), list(METHODS)):
        assert not found.failures, (found.method.name, found.failures)
        assert found.order is not None
        assert abs(found.order - found.method.order) < 0.5


def test_a_spoiled_bracket_loses_the_energy(ring, monkeypatch):
    """The check of the drift can fail: a bracket that is off by a thousandth."""
    evaluate = family_steps.FamilyTwin._evaluate

    def spoil(self, functions, lanes, after, state):
        found = evaluate(self, functions, lanes, after, state)
        return found * (1.001 if functions == ("bracket_vector",) else 1.0)

    system = ring.resize({"i": 5})
    given = {"method": "discrete_gradient", "step": 0.2, "samples": 5, "target": "numpy"}
    assert system.simulate(draw_spins(5), (0, 4), **given).drift["energy"] < 1e-13
    monkeypatch.setattr(family_steps.FamilyTwin, "_evaluate", spoil)
    assert system.simulate(draw_spins(5), (0, 4), **given).drift["energy"] > 1e-9


def test_without_friction_a_driven_motion_keeps_its_energy():
    """Forces are those of a coefficient, which is 0 for one trajectory."""
    with load_texts(render(DRAG).texts) as system:
        sized = system.resize({"i": 3})
        start = np.array([0.0, 2.0, 3.5, 0.3, -0.2, 0.1])
        given = {"method": "discrete_gradient", "step": 0.05, "samples": 11}
        free, slowed = (
            np.ravel(sized.simulate(start, (0, 20), {"c": [c] * 3}, **given).change("energy"))
            for c in (0.0, 1.0)
        )
        assert np.abs(free).max() < 1e-14
        assert slowed[-1] < -1e-3


def test_steps_that_are_too_long_are_not_solved(ring):
    """And say so, by either target; the trajectory stays where it was."""
    system, start = ring.resize({"i": 6}), draw_spins(6)
    for target in ("numpy", "c"):
        given = {"method": "discrete_gradient", "step": 50.0, "samples": 1, "target": target}
        found = system.simulate(start, (0, 200), **given)
        assert found.status == "NOT_SOLVED"
        np.testing.assert_array_equal(found.state[:, -1], start)


def test_newtons_method_finds_the_same_step(chain):
    """Slopes of the first order lead to the same middles, for steps that sweeps do not solve."""
    line = chain.resize({"i": 30})
    start = np.concatenate([0.1 * np.cos(np.arange(30) / 3), np.zeros(30)])
    given = {"method": "discrete_gradient", "parameters": {"k": np.full(30, 100.0)}, "samples": 5}
    assert line.simulate(start, (0, 2), step=0.5, **given).status == "NOT_SOLVED"
    found = line.simulate(start, (0, 2), step=0.5, newton=True, **given)
    assert found.status == "OK"
    assert found.drift["energy"] < 1e-12
    short = [line.simulate(start, (0, 2), step=0.01, newton=x, **given) for x in (False, True)]
    np.testing.assert_allclose(short[0].state, short[1].state, atol=1e-12)


# -- fields ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [MAGNET, FREE], ids=["circle", "ends"])
def test_fields_keep_their_energy(text):
    """Around a circle and between two ends, where the bracket has weights of points."""
    with load_texts(render(text).texts) as system:
        points = system.resize({"s": 16})
        drift = {
            name: points.simulate(None, (0, 20), method=name, step=0.1, samples=5).drift["energy"]
            for name in ("discrete_gradient", "midpoint")
        }
    assert drift["discrete_gradient"] < 1e-14
    assert drift["midpoint"] > 1e-6


@pytest.mark.campaign
@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("ends", ["", "free", "clamped"], ids=lambda x: x or "circle")
def test_brackets_and_gradients_of_strands_are_those_of_rings(ends, order):
    """To 50 digits, of points that are written out, with the tensor of all of them."""
    more = f'{order}, ends = "{ends}"' if ends else str(order)
    rendered = render(STRAND.replace("order = 4", f"order = {more}"))
    assert {3, 4, 5} <= pipeline.verify(rendered).rungs.keys()


# -- spoiled texts --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(own->near[n] + own->far[n] - 2.0", "(own->near[n] + own->far[n] - 1.5"),
        ("1.0 - nodes[k][0]", "1.0 + nodes[k][0]"),
        ("2.0 * ((search->middle[n]", "1.0 * ((search->middle[n]"),
        ("search->rates[n] + added[n]", "search->rates[n] - added[n]"),
        (
            "along[l] = along[l] + (own->slope[n + l] + excess[n + l])",
            "along[l] = along[l] + 2.0 * (own->slope[n + l] + excess[n + l])",
        ),
    ],
)
def test_a_wrong_step_in_c_is_seen(texts, old, new):
    """Each of these changes some bit of a run."""
    require_wrong_steps(texts, "discrete_gradient", old, new)


@pytest.mark.parametrize(
    ("name", "spoil", "text"),
    [
        ("_weigh", lambda old: lambda self, own: 2 * old(self, own), VORTICES),
        ("_shift", lambda old: lambda self, tree, by: old(self, tree, 0), QUARTIC),
        ("_list_alone", lambda old: lambda self, row, end: (), CLOSED),
    ],
    ids=["pairs", "neighbours", "alone"],
)
def test_a_wrong_gradient_is_seen(monkeypatch, name, spoil, text):
    """By the members that are written out, to 50 digits."""
    monkeypatch.setattr(action._Terms, name, spoil(getattr(action._Terms, name)))
    rendered = pipeline.render(read(text))
    with pytest.raises(CrossCheckError, match=r"rung 4: .*: energy_gradient of"):
        pipeline.verify(rendered)


def test_a_wrong_bracket_is_seen(monkeypatch):
    """Likewise: a vector that is twice as long."""

    def spoil(family, bracket, ends):
        return action.add_action(family, lambda find: bracket(lambda c, k: 2 * find(c, k)), ends)

    monkeypatch.setattr("coadjoint.derive.indexed.add_action", spoil)
    with pytest.raises(CrossCheckError, match=r"rung 4: .*: bracket_vector of"):
        pipeline.verify(pipeline.render(read(VORTICES)))
