"""Splittings of equal members by flows of parts of the energy: read off, lowered, and steps."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from coadjoint import pipeline
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.derive import derive
from coadjoint.derive.family_flows import split_family
from coadjoint.errors import CrossCheckError
from coadjoint.lower.families import lower_family
from coadjoint.lower.family_check import check_loops
from coadjoint.solve import family_steps
from coadjoint.solve.choices import Choice
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import CHAIN, DRAG, RING, VORTICES, family_of, render

#: Pendulums in axes of their own, which turn one another: an open chain with rational flows.
PENDULUMS = """
title = "Pendulums in a row"
routes = ["lie-poisson"]
[index]
i = { size = 6 }
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum", index = "i" }
G = { role = "advected", representation = "vector", index = "i" }
[parameters]
w = { index = "i", default = 1 }
k = { default = 0.5 }
[hamiltonian]
h = '''sum(i, Pi[i, 1]^2/2 + Pi[i, 2]^2/3 + Pi[i, 3]^2/4 + w[i]*G[i, 3])
    + k*sum(i, dot(G[i], G[i+1]))'''
[claims]
casimirs = ["dot(G[i], G[i])", "dot(G[i], Pi[i])"]
conserved = ["energy"]
"""
TEXTS = {"ring": RING, "pendulums": PENDULUMS}
ORDERS = {"splitting": 2, "splitting4": 4, "splitting6": 6}


@pytest.fixture(scope="module")
def rendered():
    """Both systems up to their texts."""
    return {name: render(text, name) for name, text in TEXTS.items()}


@pytest.fixture(scope="module")
def pendulums(rendered):
    """The open chain."""
    with load_texts(rendered["pendulums"].texts) as system:
        yield system


@pytest.fixture(scope="module")
def ring(rendered):
    """Spins, each of which turns by exact angles, since these depend on its neighbours."""
    with load_texts(rendered["ring"].texts) as system:
        yield system


def draw(system, size, seed=0):
    """A system of so many members, and a state of it."""
    sized = system.resize({"i": size})
    return sized, np.random.default_rng(seed).normal(size=sized.STATE.size)


def follow(system, part, state, step, **given):
    """What the flow of a part adds in a time, by the plain target."""
    joined = np.append(state, step)
    return system.evaluate(f"flow{part}", joined, **given, target="python")


# -- the flows ------------------------------------------------------------------------------------


def test_the_flow_of_a_component_turns_each_spin_about_its_axis(ring):
    """``{S1, S2} = S3``: by the part of S3 a spin turns at ``dh/dS3`` about the third axis."""
    system, state = draw(ring, 7)
    S, J, D, step = state.reshape(3, 7), 1.25, np.linspace(0.5, 2, 7), 0.3
    moved = []
    for part in (1, 2, 3):
        rises = follow(system, part, state, step, parameters=np.append(J, D)).reshape(3, 7)
        (axis,) = np.flatnonzero((rises == 0).all(axis=1))
        moved.append(axis)
        speed = -J * (np.roll(S[axis], 1) + np.roll(S[axis], -1)) + 2 * D * S[axis] * (axis == 2)
        a, b = S[(axis + 1) % 3], S[(axis + 2) % 3]
        c, s = np.cos(step * speed), np.sin(step * speed)
        turned = np.zeros_like(S)
        turned[(axis + 1) % 3], turned[(axis + 2) % 3] = a * c - b * s, a * s + b * c
        turned[axis] = S[axis]
        np.testing.assert_allclose(S + rises, turned, rtol=0, atol=4e-15)
    assert sorted(moved) == [0, 1, 2]


def test_the_kick_of_pendulums_is_that_of_their_potential(pendulums):
    """``Pi' = G x dV/dG``, with one neighbour at the ends; the first part moves momenta alone."""
    system, state = draw(pendulums, 5)
    G, w, k, step = state.reshape(6, 5)[3:], np.linspace(1, 2, 5), 0.75, 0.3
    force = np.zeros_like(G)
    force[2] = w
    force[:, :-1] += k * G[:, 1:]
    force[:, 1:] += k * G[:, :-1]
    kicks = step * np.cross(G, force, axis=0)
    found = [
        follow(system, part, state, step, parameters=np.append(k, w)).reshape(6, 5)
        for part in (1, 2, 3, 4)
    ]
    (kick,) = [rises for rises in found if not rises[3:].any()]
    np.testing.assert_allclose(kick[:3], kicks, rtol=0, atol=4e-15)


@pytest.mark.parametrize("name", TEXTS)
def test_flows_of_all_members_are_those_of_the_windows(rendered, name):
    """Read off from one member, lowered and printed; 48 points of two sizes."""
    own, texts = rendered[name].family, rendered[name].texts
    assert len(own.family.flows) == {"ring": 3, "pendulums": 4}[name]
    check_loops(own.family, own.context.loops)
    with load_texts(texts) as system:
        report = crosscheck(rendered[name], texts, system)
    for part in range(1, len(own.family.flows) + 1):
        assert report.figures[f"flow{part}"]["numpy"].points > 40


def crosscheck(rendered, texts, system):
    """The ladder without a compiler."""
    own = rendered.family
    return crosscheck_family(own, texts, system, ("numpy", "python"), texts)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("ring", "S3[+1]", "S3"),  # itself in the place of a neighbour
        ("ring", "J", "2*J"),
        ("pendulums", "G3[-1]", "G3[+1]"),
        ("pendulums", "_h", "_h/2"),
    ],
)
def test_the_ladder_sees_a_wrong_flow(rendered, name, old, new, monkeypatch):
    """What is wrong in the family, and so in its loops and texts, differs from the windows."""
    family = rendered[name].family.family

    def spoil(rises):
        own = (*family.neighbours.values(), *family.states, *family.shared, *family.step)
        known = {s.name: s for s in own}
        factor, _, place = new.rpartition("*")
        value = known[place.partition("/")[0]] * sympy.Rational(factor or 1)
        value = value / 2 if new.endswith("/2") else value
        change = {known[old]: value}
        return replace(
            rises,
            definitions=tuple((s, tree.xreplace(change)) for s, tree in rises.definitions),
            trees=tuple(tree.xreplace(change) for tree in rises.trees),
        )

    flows = tuple(replace(each, member=spoil(each.member)) for each in family.flows)
    assert flows != family.flows
    context = rendered[name].family.context
    loops = lower_family(replace(family, flows=flows))
    texts = pipeline.render_family(replace(context, loops=loops))
    own = replace(rendered[name].family, context=replace(context, loops=loops))
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match=r"rung 4: .*flow"):
        crosscheck(replace(rendered[name], family=own), texts, system)


def test_a_wrong_loop_over_a_flow_is_seen(rendered):
    """By the trees of the family, before anything is printed."""
    family, loops = rendered["ring"].family.family, rendered["ring"].family.context.loops
    with pytest.raises(CrossCheckError, match="rung 2: flow1"):
        check_loops(family, {**loops, "flow1": replace(loops["flow2"], name="flow1")})


@pytest.mark.parametrize("text", [CHAIN, DRAG, VORTICES], ids=["shifts", "friction", "pairs"])
def test_others_have_no_flows_of_their_own(text):
    """Shifts of positions and momenta are the rates; what else acts or couples has none."""
    spec = read_spec_text(text, "sample.toml")
    family, splittings = split_family(derive(spec), family_of(spec), ())
    assert (family.flows, family.step, splittings) == ((), (), ())


# -- steps ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TEXTS)
def test_steps_have_their_orders_and_keep_what_is_claimed(request, name):
    """Errors fall by the power of the step; squares of vectors stay, and so does the energy."""
    system, state = draw(request.getfixturevalue(name), 5, 1)
    given = {"rtol": 1e-13, "atol": 1e-13, "target": "numpy"}
    near = system.simulate(state, (0, 0.5), method="dop853", **given).state[:, -1]
    for method, order in ORDERS.items():
        judged = next(each for each in system.METHODS if each.name == method)
        assert judged.is_poisson
        assert judged.exactly == (("dot(S[i], S[i])",) if name == "ring" else ())
        assert "energy" in judged.nearly
        errors = []
        for count in (8, 16):
            given = {"method": method, "step": 0.5 / count, "target": "numpy"}
            run = system.simulate(state, (0, 0.5), **given)
            errors.append(np.abs(run.state[:, -1] - near).max())
        assert np.log2(errors[0] / errors[1]) > order - 0.5, (method, errors)
    given = {"method": "splitting", "step": 1 / 64, "target": "numpy"}
    run = system.simulate(state, (0, 10), samples=3, **given)
    vectors = run.state.reshape(-1, 3, 5, 3)[-1]
    squares = (vectors**2).sum(axis=0)
    np.testing.assert_allclose(squares, np.repeat(squares[:, :1], 3, axis=1), rtol=2e-15)
    assert 1e-9 < run.drift["energy"] < 0.01


@pytest.mark.parametrize("members", [1, 3, 15])
def test_c_and_numpy_make_the_same_steps(pendulums, members):
    """Bit for bit, also the last step, which is shorter."""
    system, _ = draw(pendulums, 11)
    start = np.random.default_rng(2).normal(size=(system.STATE.size, members))
    given = {"method": "splitting4", "step": 0.03, "samples": 2}
    one, other = (
        system.simulate(start, (0, 1), target=target, **given).state for target in ("c", "numpy")
    )
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("add_low(x + n, low + n, rises[n])", "add_low(x + n, low + n, -rises[n])"),
        ("add_low(x + n, low + n, rises[n])", "x[n] = x[n] + rises[n]"),
        ("h[l] = block->took[l] * flows[s].part", "h[l] = block->took[l]"),
        ("every[flows[s].flow](own", "every[0](own"),
    ],
)
def test_a_wrong_step_in_c_is_seen(rendered, old, new):
    """Each of these changes some bit of a run."""
    texts = rendered["pendulums"].texts
    assert texts["solver.c"].count(old) == 1
    changed = {**texts, "solver.c": texts["solver.c"].replace(old, new)}
    with load_texts(changed) as system, pytest.raises(CrossCheckError, match="NumPy twin"):
        family_steps.load(system, Choice(name="splitting", order=2), "c")


def test_what_flows_call_does_not_loosen_the_other_checks(ring, pendulums):
    """Rates of spins have the same bits everywhere, though their flows call sine and cosine."""
    assert ring.list_called("rhs") == ring.elementary == ()
    assert ring.list_called("flow1") == ring.resize({"i": 9}).list_called("flow2") == ("sin", "cos")
    assert pendulums.list_called("flow1") == ()
