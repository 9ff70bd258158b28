"""Brackets of neighbours: equations, proofs for every number of members, and discrete gradients."""

import json

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.derive import indexed
from coadjoint.errors import AlgebraError, ClaimError, CrossCheckError
from coadjoint.prove import prove
from coadjoint.solve import family_steps
from coadjoint.solve.folders import load_texts
from coadjoint.solve.self_check import check_methods
from coadjoint.spec.reader import read_spec_text

#: M. Toda, Journal of the Physical Society of Japan 22 (1967) 431, in the stretches of the springs.
STRETCHES = """
title = "Toda's lattice by stretches"
routes = ["poisson"]
[index]
i = { size = 12, periodic = true }
[variables]
r = { role = "coordinate", index = "i" }
p = { role = "coordinate", index = "i", default = 1 }
[poisson.brackets]
"{r[i], p[i]}" = "-1"
"{r[i], p[i+1]}" = "1"
[hamiltonian]
h = "sum(i, p[i]^2/2 + exp(-r[i]) + r[i])"
[observables]
P = "sum(i, p[i])"
T = "sum(i, p[i]^3/3 + (p[i] + p[i+1])*exp(-r[i]))"
[claims]
casimirs = ["sum(i, p[i])", "sum(i, r[i])"]
conserved = ["energy", "P", "T"]
"""
#: Volterra's bracket with weights, and an energy of degree 3, of which bits can be compared.
LATTICE = """
title = "Species that feed on the next ones"
routes = ["poisson"]
[index]
i = { size = 9 }
[variables]
c = { role = "coordinate", index = "i", default = 1 }
[parameters]
k = { index = "i", default = 0.3 }
w = { index = "i", default = 1 }
[poisson.brackets]
"{c[i], c[i+1]}" = "w[i]*c[i]*c[i+1]"
[hamiltonian]
h = "sum(i, c[i] + k[i]*c[i]^3) + sum(i, c[i]*c[i+1]/2)"
[claims]
conserved = ["energy"]
"""
N = 7
RANDOM = np.random.default_rng(1)
START = RANDOM.uniform(0.5, 1.5, N)
VALUES = {"k": RANDOM.uniform(0.1, 0.4, N), "w": RANDOM.uniform(0.5, 1.5, N)}


def read(text, *changes):
    """The spec of a text with changes."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec_text(text, "sample.toml")


def render(text, *changes):
    """Its files."""
    return pipeline.render(read(text, *changes))


@pytest.fixture(scope="module")
def rendered():
    """The files of the species on a line."""
    return render(LATTICE)


@pytest.fixture(scope="module")
def line(rendered):
    """Species on a line."""
    with load_texts(rendered.texts) as system:
        yield system.resize({"i": N})


@pytest.fixture(scope="module")
def ring():
    """Springs on a ring."""
    with load_texts(render(STRETCHES).texts) as system:
        yield system


# -- equations and proofs -------------------------------------------------------------------------


def test_rates_are_those_by_hand(line, ring):
    """With the terms that members at the ends lack, and around a ring."""
    c, k, w = START, VALUES["k"], VALUES["w"]
    slope = 1 + 3 * k * c**2 + (np.append(c[1:], 0) + np.append(0, c[:-1])) / 2
    flow = w[:-1] * c[:-1] * c[1:]
    expected = np.append(flow * slope[1:], 0) - np.append(0, flow * slope[:-1])
    np.testing.assert_allclose(line.rhs(c, VALUES), expected, rtol=1e-14)
    for n in (4, 5, 12):
        r, p = np.random.default_rng(n).normal(size=(2, n))
        rates = [np.roll(p, -1) - p, np.exp(-np.roll(r, 1)) - np.exp(-r)]
        found = ring.resize({"i": n}).rhs(np.concatenate([r, p]))
        np.testing.assert_allclose(found, np.concatenate(rates), atol=1e-14)


def test_what_is_proved_holds_for_every_number_of_members():
    """The bracket, its Casimirs and integrals, from two rings that keep neighbours apart."""
    certificate = prove(read(STRETCHES))
    certificate.require()
    said = {claim.statement for claim in certificate.claims}
    assert {
        f"{what}, for every N >= 4"
        for what in (
            "the Poisson bracket satisfies the Jacobi identity",
            "the energy is conserved",
            "sum(i, r[i]) is a Casimir",
            "T is conserved",
        )
    } <= said
    for old, new in (('"sum(i, r[i])"', '"sum(i, r[i]^2)"'), ("p[i]^3/3", "p[i]^3")):
        with pytest.raises(ClaimError):
            prove(read(STRETCHES, (old, new))).require()


def test_a_bracket_of_three_neighbours_that_is_none_is_refused():
    """Its windows are wide enough for all terms of the Jacobi identity."""
    with pytest.raises(AlgebraError, match="violates the Jacobi identity"):
        render(LATTICE, ("9 }", "9, periodic = true }"), ('c[i+1]"\n[h', 'c[i+1]*c[i+2]"\n[h'))


@pytest.mark.parametrize(
    ("text", "changes", "reason"),
    [
        (STRETCHES, [("size = 12", "size = 3")], "for all from 4 members on"),
        (STRETCHES, [("p[i+1]}", "p[i+5]}")], "members more than 4 apart have a bracket"),
        (LATTICE, [("c[i]*c[i+1]/2", "c[i]*c[i+1]/2) + sum(i, j, i < j, c[i]*c[j]")], "over pairs"),
        (
            LATTICE,
            [("[claims]", '[noise]\nW = "sum(i, c[i])"\n[claims]')],
            "there is a table [noise]",
        ),
    ],
    ids=["few", "far", "pairs", "noise"],
)
def test_what_no_generic_member_tells_is_written_out(text, changes, reason):
    """And says why."""
    assert reason in read(text, *changes).written


# -- steps ----------------------------------------------------------------------------------------


def test_discrete_gradients_are_offered_where_the_energy_is_not_quadratic():
    """Of two brackets; a quadratic energy has the midpoint."""
    for text, changes in ((STRETCHES, ()), (LATTICE, ()), (LATTICE, [("c[i]^3", "c[i]^2")])):
        texts = render(text, *changes).texts
        methods = {x["name"]: x for x in json.loads(texts["certificate.json"])["methods"]}
        found = methods["discrete_gradient"]
        assert bool(found["cost"]) == ("energy" in found["exactly"]) != bool(changes)
        assert ("energy" in methods["midpoint"]["exactly"]) == bool(changes)


def test_the_energy_stays_where_the_midpoint_loses_it(line, ring):
    """To rounding, of few members and of many."""
    springs = ring.resize({"i": 200})
    moved = 0.5 * np.random.default_rng(2).normal(size=400)
    for system, start, values in ((line, START, VALUES), (springs, moved, None)):
        given = {"step": 0.1, "samples": 11}
        kept, lost = (
            system.simulate(start, (0, 40), values, method=name, **given)
            for name in ("discrete_gradient", "midpoint")
        )
        assert kept.status == lost.status == "OK"
        assert kept.drift["energy"] < 1e-14
        assert lost.drift["energy"] > 1e-6


def test_steps_are_those_of_the_members_written_out(line):
    """By loops, and by the solvers of a system without an index, which multiply by its tensor."""
    changes = [("size = 9", f"size = {N}, written_out = true")]
    flat = np.stack([VALUES["k"], VALUES["w"]]).ravel()
    with load_texts(render(LATTICE, *changes).texts) as written:
        for method in ("discrete_gradient", "discrete_gradient4", "average_gradient"):
            given = {"method": method, "step": 0.05, "samples": 5, "target": "numpy"}
            one = line.simulate(START, (0, 1), VALUES, **given)
            other = written.simulate(START, (0, 1), flat, **given)
            assert one.status == other.status == "OK"
            assert np.abs(one.state - START[:, None]).max() > 0.2
            np.testing.assert_allclose(one.state, other.state, atol=1e-13)


@pytest.mark.parametrize("members", [1, 11])
def test_c_has_the_bits_of_numpy(line, members):
    """By one lane and by more than a vector, with counts of sweeps."""
    start = np.random.default_rng(3).uniform(0.5, 1.5, (N, members))
    given = {"method": "discrete_gradient", "step": 0.1, "samples": 3, "parameters": VALUES}
    one, other = (line.simulate(start, (0, 1), target=to, **given) for to in ("c", "numpy"))
    assert np.all(np.asarray(one.status) == "OK")
    assert one.state.tobytes() == other.state.tobytes()
    assert np.array_equal(one.sweeps, other.sweeps)


def test_newtons_method_finds_the_same_steps(line):
    """The linear equations have bands as wide as bracket and energy couple members."""
    given = {"method": "discrete_gradient", "step": 0.02, "samples": 5, "parameters": VALUES}
    one, other = (line.simulate(START, (0, 1), newton=x, **given) for x in (False, True))
    assert other.status == "OK"
    np.testing.assert_allclose(one.state, other.state, atol=1e-13)


def test_orders_defects_and_drifts_are_those_that_are_claimed(ring):
    """As `python -m` measures them."""
    found = list(check_methods(ring.resize({"i": 5}), ["discrete_gradient", "splitting4"]))
    assert not [each.failures for each in found if each.failures]
    assert [each.order is not None for each in found] == [True, True]
    assert found[1].defect is not None


# -- spoiled input --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "spoil"),
    [
        (STRETCHES, lambda own, at: lambda find: own(lambda c, k: find(c, -k))),
        (LATTICE, lambda own, at: lambda find: [x * (1 + (at == 0)) for x in own(find)]),
    ],
    ids=["neighbour", "end"],
)
def test_a_wrong_bracket_is_seen(monkeypatch, text, spoil):
    """That of the other neighbour, and that of the first member, to 50 digits."""
    multiply = indexed._Reader.multiply
    monkeypatch.setattr(indexed._Reader, "multiply", lambda self, at: spoil(multiply(self, at), at))
    with pytest.raises(CrossCheckError, match=r"rung 4: .*: bracket_vector of"):
        pipeline.verify(render(text))


def test_a_tensor_that_is_not_antisymmetric_loses_the_energy(line, monkeypatch):
    """The check of the drift can fail: one member's row is off by a thousandth."""
    evaluate = family_steps.FamilyTwin._evaluate
    weights = np.where(np.arange(N) == 3, 1.001, 1.0)[:, np.newaxis]

    def spoil(self, functions, lanes, after, state):
        found = evaluate(self, functions, lanes, after, state)
        return found * (weights if functions == ("bracket_vector",) else 1.0)

    given = {"method": "discrete_gradient", "step": 0.1, "samples": 5, "target": "numpy"}
    assert line.simulate(START, (0, 4), VALUES, **given).drift["energy"] < 1e-14
    monkeypatch.setattr(family_steps.FamilyTwin, "_evaluate", spoil)
    assert line.simulate(START, (0, 4), VALUES, **given).drift["energy"] > 1e-9
