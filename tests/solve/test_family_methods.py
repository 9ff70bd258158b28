"""Methods that keep the structure of systems of equal members: what is proved, and runs."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import MAPPED, STRUCTURED
from coadjoint.solve import family_steps
from coadjoint.solve.choices import Choice
from coadjoint.solve.folders import load_texts
from coadjoint.solve.self_check import check_methods
from coadjoint.spec.reader import read_spec_text
from coadjoint.systems import (
    elastic_chain,
    heisenberg_lattice,
    n_body,
    point_vortices,
    sphere_vortices,
    spin_chain_lattice,
    toda_lattice,
)
from tests.families import (
    CHAIN,
    DRAG,
    PEAKONS,
    RING,
    SPRINGS,
    VORTICES,
    render,
    require_wrong_steps,
    write_chain,
    write_ring,
)

RADIUS = "dot(S[i], S[i])"


@pytest.fixture(scope="module")
def texts():
    """The files of spins on a ring."""
    return render(RING, "ring").texts


@pytest.fixture(scope="module")
def ring(texts):
    """Spins on a ring."""
    with load_texts(texts) as system:
        yield system


@pytest.fixture(scope="module")
def chain():
    """Masses on a line."""
    with load_texts(render(CHAIN, "chain").texts) as system:
        yield system


def judged(system):
    """Methods of a system by name."""
    return {each.name: each for each in system.METHODS}


def draw_spins(n, members=1):
    """Spins in all directions."""
    spins = np.random.default_rng(n).normal(size=(3, n, members))
    spins /= np.linalg.norm(spins, axis=0)
    return spins.reshape(3 * n, members)[:, : members if members > 1 else None].squeeze()


# -- what is proved -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("system", "default", "exactly", "nearly"),
    [
        (heisenberg_lattice, "spherical_midpoint", {"M", RADIUS}, {"energy"}),
        (sphere_vortices, "spherical_midpoint", {"M", "dot(x[i], x[i])"}, {"energy"}),
        (toda_lattice, "splitting4", {"P"}, {"energy", "T"}),
        (n_body, "splitting4", {"P", "J"}, {"energy"}),
        (spin_chain_lattice, "splitting4", {"J"}, {"energy"}),
        (elastic_chain, "splitting4", {"L", "J"}, {"energy"}),
        (point_vortices, "gauss4", None, None),
    ],
    ids=lambda each: getattr(each, "name", None),
)
def test_the_default_is_what_keeps_the_bracket(system, default, exactly, nearly):
    """Spins on spheres, masses with ``T(p) + V(q)``, bodies by parts; of plane vortices none."""
    methods = judged(system.system)
    if exactly is None:  # not separable: {x, y} = 1/Gamma, and log of both
        assert not {"spherical_midpoint", "splitting4"} & methods.keys()
        assert methods["midpoint"].rank == 1
        assert methods["midpoint"].is_poisson
        assert set(methods["midpoint"].exactly) == {"X", "Y", "I"}
        return
    first = methods[default]
    assert first.rank == 1
    assert first.is_poisson
    assert set(first.exactly) == exactly
    assert set(first.nearly) == nearly


def test_a_quadratic_energy_is_kept_by_the_midpoint_which_is_no_poisson_map():
    """The bracket of spins is linear in them."""
    midpoint = judged(heisenberg_lattice.system)["midpoint"]
    assert set(midpoint.exactly) == {"energy", "M", RADIUS}
    assert not midpoint.is_poisson
    assert judged(n_body.system)["midpoint"].is_poisson  # and that of bodies is constant


@pytest.mark.parametrize(
    ("text", "old", "new", "lost"),
    [
        (RING, "S[i], S[i+1])) +", "S[i], S[i+1])) + sum(i, S[i, 1]^4) +", "midpoint"),
        (CHAIN, "p[i]^2/2", "p[i]^2*(2 + cos(q[i]))/2", "splitting4"),
        (DRAG, "c = {", "c = {", "splitting4"),
        (SPRINGS, "c = {", "c = {", "splitting4"),
        (PEAKONS, "size = 5", "size = 5", "midpoint"),
    ],
    ids=["quartic", "not separable", "forced", "friction", "kinks"],
)
def test_a_theorem_without_its_premise_says_nothing(text, old, new, lost):
    """A quartic term takes the energy from the midpoint; forces and kinks take the methods."""
    assert old in text
    changed = text.replace(old, new).replace('"energy", "P"]', '"energy"]')
    changed = changed.replace('"energy", "M"]', '"energy"]')
    rendered = pipeline.render(read_spec_text(changed, "changed.toml"))
    assert rendered.family is not None
    methods = {each.name: each for each in rendered.family.context.methods}
    if text is RING:
        assert "energy" not in methods[lost].exactly
        assert RADIUS in methods[lost].exactly
    else:
        assert lost not in methods
    assert not [
        name for name, each in methods.items() if each.is_poisson and text in (DRAG, SPRINGS)
    ]


# -- runs -----------------------------------------------------------------------------------------


def test_steps_of_a_ring_are_those_of_the_spins_written_out(ring):
    """Four spins, by loops over members and by the solvers of a system without an index."""
    n = 4
    family = ring.resize({"i": n})
    start = draw_spins(n)
    D = [0.3, 0.1, 0.7, 0.2]
    by_member = start.reshape(3, n).T.ravel()
    with load_texts(
        pipeline.render(read_spec_text(write_ring(n), "written.toml")).texts
    ) as written:
        for method in ("spherical_midpoint", "midpoint4"):
            given = {"method": method, "step": 0.05, "samples": 5, "target": "numpy"}
            one = family.simulate(start, (0, 5), {"J": 0.9, "D": D}, **given)
            other = written.simulate(by_member, (0, 5), np.array([0.9, *D]), **given)
            assert one.status == other.status == "OK"
            expected = other.state.reshape(n, 3, -1).transpose(1, 0, 2).reshape(3 * n, -1)
            assert np.abs(one.state - start[:, None]).max() > 0.5
            np.testing.assert_allclose(one.state, expected, atol=2e-13)


def test_steps_of_a_chain_are_those_of_the_masses_written_out(chain):
    """Six masses: shifts of all positions and all momenta are the flows of T and of V."""
    n = 6
    source = np.random.default_rng(0)
    start, k = source.normal(size=2 * n), source.uniform(0.5, 1.5, n)
    with load_texts(
        pipeline.render(read_spec_text(write_chain(n), "written.toml")).texts
    ) as written:
        for method in ("splitting4", "splitting"):
            given = {"method": method, "step": 0.05, "samples": 5, "target": "numpy"}
            one = chain.resize({"i": n}).simulate(start, (0, 5), {"k": k}, **given)
            other = written.simulate(start, (0, 5), k, **given)
            assert one.status == other.status == "OK"
            # one of them may begin with V; both have the order of the method
            bound = {"splitting4": 1e-5, "splitting": 1e-2}[method]
            np.testing.assert_allclose(one.state, other.state, atol=bound)


@pytest.mark.parametrize("method", ["splitting", "splitting4"])
def test_splittings_of_a_chain_are_those_of_numpy(chain, method):
    """Steps of C and of NumPy, but for what their exponential functions round otherwise."""
    start = np.random.default_rng(1).normal(size=12)
    given = {"method": method, "step": 0.05, "samples": 3}
    one, other = (
        chain.resize({"i": 6}).simulate(start, (0, 2), np.ones(6), target=target, **given)
        for target in ("c", "numpy")
    )
    assert np.abs(one.state[:, -1] - start).max() > 0.1
    np.testing.assert_allclose(one.state, other.state, atol=1e-11)


@pytest.mark.parametrize("method", ["spherical_midpoint", "midpoint6"])
def test_laws_of_ten_thousand_spins(method):
    """Lengths and the total spin to rounding, the energy within a bound; RK4 loses them."""
    system = heisenberg_lattice.system.resize({"i": 10000})
    start = draw_spins(10000)

    def run(name, end):
        found = system.simulate(start, (0, end), method=name, step=0.1, samples=6)
        assert found.status == "OK"
        lengths = found.state.reshape(3, 10000, -1)
        squares = (lengths**2).sum(axis=0)
        return np.abs(squares / squares[:, :1] - 1).max(), found.drift

    radius, drift = run(method, 2)
    assert radius < 4e-15
    assert drift["M"] < 2e-14
    assert drift["energy"] < {"midpoint6": 2e-14, "spherical_midpoint": 0.03}[method]
    lost, others = run("rk4", 2)
    assert lost > 1e-6
    assert others["energy"] > 1e-6


@pytest.mark.parametrize(
    ("system", "methods"),
    [
        (heisenberg_lattice, ("spherical_midpoint4",)),
        (toda_lattice, ("splitting4",)),
        (spin_chain_lattice, ("splitting", "splitting4")),
        (sphere_vortices, ("spherical_midpoint", "midpoint")),
    ],
    ids=lambda each: getattr(each, "name", None),
)
def test_orders_and_drifts_are_those_that_are_claimed(system, methods):
    """As `python -m` measures them."""
    names = [each for each in methods if each in judged(system.system)]
    assert names == list(methods)
    for found in check_methods(system.system, names):
        assert not found.failures, (found.method.name, found.failures)
        assert found.order is not None
        assert found.order > found.method.order - 0.5
        assert found.drifts.keys() >= {*found.method.exactly}


def test_a_step_that_is_too_long_is_not_solved():
    """And says so; the trajectory stays where it was."""
    system = heisenberg_lattice.system.resize({"i": 16})
    start = draw_spins(16)
    for target in ("numpy", "c"):
        found = system.simulate(
            start, (0, 200), method="spherical_midpoint", step=50.0, samples=1, target=target
        )
        assert found.status == "NOT_SOLVED"
        assert "take shorter steps" in found.message
        np.testing.assert_array_equal(found.state[:, -1], start)


def test_events_and_dense_output_of_a_step_are_led_by_the_twin(ring):
    """With the same states."""
    system = ring.resize({"i": 4})
    start = draw_spins(4)
    given = {"method": "spherical_midpoint", "step": 0.05, "samples": 3}
    one = system.simulate(start, (0, 1), **given)
    other = system.simulate(start, (0, 1), events="S[0, 2] = 10", dense=True, **given)
    np.testing.assert_array_equal(one.state, other.state)


def test_what_does_not_apply_is_refused_with_its_reason(ring):
    """And `auto` with a step takes the default."""
    system = ring.resize({"i": 4})
    start = draw_spins(4)
    for name in ("gauss4", "coadjoint_mean", "kahan", "discrete_gradient"):
        with pytest.raises(KernelArgumentError, match="does not apply to its equal members"):
            system.simulate(start, (0, 1), method=name, step=0.1)
    assert set(judged(ring)) <= {*STRUCTURED, *MAPPED}
    found = system.simulate(start, (0, 1), step=0.1)
    assert found.course.method == "spherical_midpoint"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("const double left = 1.5 - part", "const double left = 1.25 - part"),
        ("half[l] = 0.5 * search->length[l]", "half[l] = 0.4375 * search->length[l]"),
        ("change >= turn->last", "change <= turn->last"),
        (
            "(*x - (total - other)) + (added - other)",
            "(*x - (total - other)) - (added - other)",
        ),
    ],
)
def test_a_wrong_step_in_c_is_seen(texts, old, new):
    """Each of these changes some bit of a run."""
    require_wrong_steps(texts, "spherical_midpoint", old, new)


#: Masses that are pulled by roots, which most states of a comparison do not have.
ROOTS = """
title = "R"
routes = ["canonical"]
[index]
i = { size = 10 }
[variables]
q = { role = "coordinate", index = "i", default = 0 }
p = { role = "momentum", of = "q", index = "i", default = "0.1" }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, sqrt(1 + (q[i] - q[i+1])))"
"""


def test_what_ends_a_step_without_a_value_is_the_same_in_c():
    """The equations of a step are not solved there, as of other systems; a wrong status is seen."""
    texts = pipeline.render(read_spec_text(ROOTS, "roots.toml")).texts
    with load_texts(texts) as system:
        family_steps.load(system, Choice(name="midpoint", order=2), "c")
    ends = "if (status != GOES_ON && block->took[l] == 0.0)"
    wrong = "if (status == STEP_UNDERFLOW && block->took[l] == 0.0)"
    require_wrong_steps(texts, "midpoint", ends, wrong)


# -- Newton's method by bands ---------------------------------------------------------------------


def test_texts_say_how_far_members_are_coupled(ring, chain):
    """The masses on a line read two members further, and all pairs have no bands."""
    assert ring.series.value("BANDS") == (1, 1)
    assert chain.series.value("BANDS") == (2, 0)
    pairs = render(VORTICES, "vortices").texts
    assert "BANDS" not in pairs["solver.py"]
    assert "KRYLOV" in pairs["solver.c"]


def test_stiff_springs_are_followed_by_bands(chain):
    """Steps that are far too long for sweeps, in a few each, however many masses there are."""
    made = []
    for n in (100, 400):
        line = chain.resize({"i": n})
        start = np.concatenate([0.1 * np.cos(np.arange(n) / 9), np.zeros(n)])
        given = {"parameters": {"k": np.full(n, 500.0)}, "method": "midpoint", "step": 1.0}
        assert line.simulate(start, (0, 4), samples=1, **given).status == "NOT_SOLVED"
        found = line.simulate(start, (0, 4), samples=1, newton=True, **given)
        assert found.status == "OK"
        scale = np.abs(found.state[n:]).max()
        assert np.abs(found.change("P")).max() < 1e-12 * n * scale
        made.append(int(found.sweeps))
    assert max(made) <= 48


@pytest.mark.parametrize("name", ["ring", "chain"])
def test_bands_have_the_bits_of_numpy(name, request):
    """By one lane, by some of a vector, and by more than one, with counts of sweeps.

    Slopes are above 1, so that rows are exchanged. The masses have exponentials, of which targets
    have their own.
    """
    system, source = request.getfixturevalue(name).resize({"i": 20}), np.random.default_rng(2)
    own = {"J": 8.0} if name == "ring" else {"k": np.full(20, 50.0)}
    method = "spherical_midpoint" if name == "ring" else "midpoint"
    for members in (1, 3, 11):
        start = 0.1 * source.normal(size=(system.STATE.size, members))
        start[-20:] += 1.0 * (name == "ring")
        given = {"method": method, "step": 0.25, "newton": True, "samples": 1, "parameters": own}
        one, other = (system.simulate(start, (0, 1), target=to, **given) for to in ("c", "numpy"))
        assert (one.status == "OK").all()
        if name == "ring":
            assert one.state.tobytes() == other.state.tobytes()
            assert np.array_equal(one.sweeps, other.sweeps)
        else:
            assert np.abs(one.state - other.state).max() < 1e-12


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("at == column ? -slope[l] + 1.0", "at == column ? -slope[l] + 2.0"),
        ("factor[l] = row[l] / own[l]", "factor[l] = row[l] * own[l]"),
        ("const size_t apart = 2 * REACH + 1,", "const size_t apart = 2 * REACH,"),
    ],
)
def test_wrong_bands_in_c_are_seen(texts, old, new):
    """Each of these changes some bit of a run."""
    require_wrong_steps(texts, "spherical_midpoint", old, new, newton=True)
