"""Systems of equal members: one kernel for any number of them, and refusals of wrong numbers."""

import pickle

import numpy as np
import pytest
from click.testing import CliRunner

from coadjoint import load, pipeline, sizes
from coadjoint.cli.program import main
from coadjoint.errors import CrossCheckError, KernelArgumentError, ResourceError
from coadjoint.solve import family_steps
from coadjoint.solve.choices import Choice
from coadjoint.solve.drift import tell_drift
from coadjoint.solve.family_steps import load as load_steps
from coadjoint.solve.folders import load_folder, load_texts
from coadjoint.spec.reader import read_spec_text
from tests import specs
from tests.families import CHAIN, NECKLACE, RING, TOPS, VORTICES, render


@pytest.fixture(scope="module")
def ring():
    """Spins on a ring."""
    with load_texts(render(RING, "ring").texts) as system:
        yield system


@pytest.fixture(scope="module")
def vortices():
    """Vortices with an outer flow."""
    with load_texts(render(VORTICES, "vortices").texts) as system:
        yield system


def turn(S, J, D):
    """The equations of the ring, typed by hand: {S1, S2} = S3, dS/dt = S x (-dh/dS)."""
    field = J * (np.roll(S, 1, axis=1) + np.roll(S, -1, axis=1))
    field[2] -= 2 * D * S[2]
    return np.cross(S, field, axis=0)


def test_events_name_members_as_specs_do(ring):
    """Members are counted from 0, components from 1; a spin alone turns about its axis."""
    system = ring.resize({"i": 3})
    S = np.array([[1.0, 0.0, 0.0], [0.0, 0.8, 0.0], [0.1, 0.6, 1.0]])
    events = ["S[0, 2] = 0.05", "S2[0] = 0.05", "S2[1] = 0.75", "S[1, 2] = 0.75"]
    given = {"S": S}, (0, 4), {"J": 0.5, "D": [0.2, 0.3, 0.4]}
    there = system.simulate(*given, samples=5)["S"][..., 2]
    distance = float(np.linalg.norm(there[:, 0] - there[:, 1]))
    events += [f"norm(S[0] - S[1]) = {distance:.12f}"]
    motion = system.simulate(*given, events=events, dense=True)
    times = [motion.events[name].time for name in events]
    assert all(map(len, times))
    assert np.array_equal(times[0], times[1])
    assert np.array_equal(times[2], times[3])
    assert np.abs(times[4] - 2).min() < 1e-6
    np.testing.assert_allclose(motion.at(times[0])["S"][1, 0], 0.05, rtol=1e-9)
    np.testing.assert_allclose(motion.at(times[2])["S"][1, 1], 0.75, rtol=1e-9)
    assert len(repr(motion.dense)) < 60


@pytest.mark.parametrize(
    ("formula", "problem"),
    [
        ("S[3, 1]", "no member 3 of S; expected members 0 to 2"),
        ("S[0, 4]", r"S\[0\] is a 3-vector and has no such component"),
        ("S1[0, 1]", r"S1\[0\] is a scalar and has no such component"),
        ("S[0]", "the value is a 3-vector; expected a scalar"),
        ("sum(i, S[i, 1])", "events name an observable"),
    ],
)
def test_events_of_members_that_are_not_there_are_refused(ring, formula, problem):
    """With what there is."""
    system = ring.resize({"i": 3})
    with pytest.raises(KernelArgumentError, match=problem):
        system.simulate({"S": np.eye(3)}, (0, 1), events=formula)


@pytest.mark.parametrize("target", ["c", "numpy", "python"])
@pytest.mark.parametrize("size", [3, 10, 67])
def test_rates_are_those_of_the_equations(ring, size, target):
    """For several numbers of members, by one text."""
    system, source = ring.resize({"i": size}), np.random.default_rng(size)
    S, D = source.normal(size=(3, size)), source.uniform(1, 2, size)
    rates = system.rhs({"S": S}, {"J": 0.7, "D": D}, target=target)
    np.testing.assert_allclose(rates.reshape(3, size), turn(S, 0.7, D), rtol=1e-13, atol=1e-14)


@pytest.fixture(scope="module")
def necklace():
    """Beads on a ring, with springs between neighbours, of which all repel each other."""
    with load_texts(render(NECKLACE, "necklace").texts) as system:
        yield system


def pull(q, k, c):
    """The forces on beads, typed by hand."""
    apart = q[:, np.newaxis] - q
    repelled = 2 * np.outer(c, c) * apart / (1 + apart**2) ** 2
    springs = k * (np.roll(q, -1) - q)
    return springs - np.roll(springs, 1) + repelled.sum(axis=1)


@pytest.mark.parametrize("target", ["c", "numpy", "python"])
@pytest.mark.parametrize("size", [4, 39, 40, 53])
def test_springs_and_all_pairs_act_together(necklace, size, target):
    """In a kernel whose vectors end where a ring closes; with blocks of members and without."""
    system, source = necklace.resize({"i": size}), np.random.default_rng(size)
    q, p = source.normal(size=(2, size))
    k, c = source.uniform(1, 2, (2, size))
    found = system.rhs({"q": q, "p": p}, {"k": k, "c": c}, target=target)
    np.testing.assert_allclose(found[:size], p)
    np.testing.assert_allclose(found[size:], pull(q, k, c), rtol=1e-12, atol=1e-12)


@pytest.fixture(scope="module")
def chain():
    """Masses on a line, whose first and last one have one neighbour each."""
    with load_texts(render(CHAIN, "chain").texts) as system:
        yield system


@pytest.mark.parametrize("target", ["c", "numpy", "python"])
@pytest.mark.parametrize("size", [5, 17, 40])
def test_the_energy_of_a_chain_has_terms_of_all_neighbours(chain, size, target):
    """Sums of p_i^2/2, exp(q_i - q_(i+1)) and k_i (q_(i-1) - q_(i+1))^2/2, as far as these are."""
    system, source = chain.resize({"i": size}), np.random.default_rng(size)
    (q, p), k = source.normal(size=(2, size)), source.uniform(1, 2, size)
    springs = k[1:-1] * (q[:-2] - q[2:]) ** 2
    expected = (p**2).sum() / 2 + np.exp(q[:-1] - q[1:]).sum() + springs.sum() / 2
    found = system.energy({"q": q, "p": p}, {"k": k}, target=target)
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_a_batch_has_the_bits_of_its_members(ring):
    """Many trajectories of many members, with parameters of their own or shared."""
    system, source = ring.resize({"i": 20}), np.random.default_rng(0)
    states, own = source.normal(size=(60, 13)), source.uniform(1, 2, (21, 13))
    for function in ("rhs", "energy", "observables"):
        for parameters in (own, own[:, 0].copy()):
            many = system.evaluate(function, states, parameters)
            each = [
                system.evaluate(function, state, p)
                for state, p in zip(
                    states.T.copy(),
                    np.broadcast_to(parameters.T, (13, 21)).copy(),
                    strict=True,
                )
            ]
            assert np.array_equal(many, np.stack(each, axis=-1))


@pytest.mark.parametrize("name", ["chain", "vortices"])
def test_series_of_numpy_follow_the_motion(name, request):
    """Of neighbours with parameters of their own and of all pairs, next to SciPy's order 8."""
    system, source = request.getfixturevalue(name).resize({"i": 6}), np.random.default_rng(6)
    state, own = source.normal(size=12), source.uniform(1, 2, 6)
    given = {"samples": 3, "target": "numpy", "rtol": 1e-11, "atol": 1e-12}
    one, other = (
        system.simulate(state, (0, 0.5), own, method=method, **given)
        for method in ("taylor", "scipy:DOP853")
    )
    assert np.abs(one.state[:, -1] - state).max() > 0.1
    np.testing.assert_allclose(one.state, other.state, atol=1e-8)


@pytest.mark.parametrize("size", [5, 53])
def test_a_batch_with_all_pairs_has_the_bits_of_its_members(vortices, size):
    """No member meets itself, and each pair has both its terms, in blocks and without."""
    system, source = vortices.resize({"i": size}), np.random.default_rng(size)
    states, c = source.normal(size=(2 * size, 3)), source.uniform(1, 2, size)
    many = system.rhs(states, c, target="c")
    for n in range(3):
        alone = system.rhs(states[:, n].copy(), c, target="numpy")
        assert np.isfinite(alone).all()
        np.testing.assert_array_equal(many[:, n], alone)


def test_the_derivative_along_a_vector_is_that_of_the_rates(vortices):
    """Of sums over partners, too: against differences of rates."""
    system, source = vortices.resize({"i": 9}), np.random.default_rng(1)
    state, vector = source.normal(size=(2, 18))
    step = 1e-6
    ahead, behind = (system.rhs(state + sign * step * vector, target="numpy") for sign in (1, -1))
    slope = system.jacobian_vector(state, vector, target="numpy")
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-6)


def test_rows_have_the_names_of_members(ring):
    """Component after component, the member fastest."""
    system = ring.resize({"i": 2})
    names = ("S1[0]", "S1[1]", "S2[0]", "S2[1]", "S3[0]", "S3[1]")
    assert system.STATE.components == names
    assert system.STATE["S"].shape == (3, 2)
    assert system.PARAMETERS.components == ("J", "D[0]", "D[1]")
    assert "2 members i" in repr(system)
    assert len(repr(ring.resize({"i": 5000}))) < 200


@pytest.mark.parametrize("method", ["rk4", "dop853"])
def test_a_run_keeps_the_energy(ring, method):
    """The steps are those of every system, and the same bits in NumPy and C."""
    system, source = ring.resize({"i": 12}), np.random.default_rng(2)
    state = source.normal(size=36)
    runs = [
        system.simulate(state, (0, 1), step=0.02, method=method, target=target, progress=False)
        for target in ("c", "numpy")
    ]
    assert np.array_equal(*(np.asarray(run.state) for run in runs))
    energy = system.energy(np.asarray(runs[0].state))
    assert np.ptp(energy) < {"rk4": 1e-4, "dop853": 1e-10}[method] * abs(energy[0])
    assert "stepwise" not in {name for name, said in runs[0].settings.items() if said}


@pytest.mark.parametrize("sizes", [{}, {"j": 3}, {"i": 0}, {"i": -1}, {"i": 2.0}, {"i": True}])
def test_a_wrong_size_is_refused(ring, sizes):
    """With the index that there is, or the fewest members."""
    with pytest.raises(KernelArgumentError, match="i"):
        ring.resize(sizes)


def test_too_few_members_are_refused(vortices):
    """A pair needs two."""
    with pytest.raises(KernelArgumentError, match="at least 2"):
        vortices.resize({"i": 1})


def test_memory_is_looked_at_before_work(ring, monkeypatch):
    """Millions of members on a small machine are refused with both numbers of bytes."""
    monkeypatch.setattr(sizes, "find_memory", lambda: 2e9)
    with pytest.raises(ResourceError, match=r"4\.0 GB.*2\.0 GB"):
        ring.resize({"i": 1_000_000})


def test_an_error_of_a_generated_folder_is_told_as_it_is(tmp_path):
    """The advice is its own: to generate the folder again would not make room for members."""
    text = (
        "from coadjoint.errors import ResourceError\nraise ResourceError('Take fewer members.')\n"
    )
    (tmp_path / "__init__.py").write_text(text)
    with pytest.raises(ResourceError, match=r"^Take fewer members\.$"):
        load_folder(tmp_path)


def test_a_system_without_an_index_has_no_size(ring):
    """`load` says so."""
    from coadjoint.systems.rigid_body import system

    with pytest.raises(KernelArgumentError, match="no index"):
        system.resize({"i": 3})


def test_loading_takes_sizes(tmp_path):
    """The number of members is chosen when a spec is loaded, if the spec does not say it."""
    chosen = RING.replace("size = 6, ", "")
    assert chosen != RING
    (tmp_path / "spins.toml").write_text(chosen)
    system = load(tmp_path / "spins.toml", sizes={"i": 40})
    assert system.STATE.size == 120
    with pytest.raises(KernelArgumentError, match=r"for the index i. Choose it, sizes=\{'i': 1000"):
        load(tmp_path / "spins.toml")


def test_pickled_systems_keep_their_size():
    """By reference to the package, and the number of members."""
    pytest.importorskip("coadjoint.systems.heisenberg_lattice")
    from coadjoint.systems.heisenberg_lattice import system

    copy = pickle.loads(pickle.dumps(system.resize({"i": 7})))
    assert copy.STATE.size == 21


@pytest.mark.parametrize("method", ["rk4", "dop853", "taylor"])
def test_wrong_steps_are_not_taken(tmp_path, method):
    """A fresh object whose steps are not those of the twin is refused before it is used."""
    texts = render(RING, "ring").texts
    wrong = {
        "rk4": ("+ half[l] * k[n + l]", "+ half[l] * k[n]"),
        "dop853": ("five[l] + a * a", "five[l] + a * b"),
        "taylor": ("row[-places] = row[find_member(size, 0, -places)]", "row[-places] = row[0]"),
    }
    assert wrong[method][0] in texts["solver.c"]
    for file, text in texts.items():
        (tmp_path / file).write_text(text.replace(*wrong[method]) if file == "solver.c" else text)
    system = load_folder(tmp_path)
    with pytest.raises(CrossCheckError, match="a wrong solver was compiled"):
        load_steps(system, Choice(name=method, order={"rk4": 4}.get(method, 8)), "c")


@pytest.mark.parametrize(("method", "size"), [("taylor", 5), ("taylor", 8), ("dop853", 5)])
def test_a_batch_has_steps_of_its_own(vortices, method, size):
    """Lanes are members of one trajectory, or trajectories; all have the bits of NumPy.

    So have any number of threads.
    """
    system, source = vortices.resize({"i": size}), np.random.default_rng(size)
    states = source.normal(size=(2 * size, 11))
    options = {"t": (0, 0.03), "method": method, "samples": 3, "progress": False}
    how = [("c", 1), ("c", 3), ("numpy", 1)]
    runs = [system.simulate(states, target=each, threads=n, **options) for each, n in how]
    for run in runs[1:]:
        assert np.array_equal(runs[0].state, run.state)
        assert np.array_equal(runs[0].steps, run.steps)
    assert np.ptp(runs[0].steps) > 0
    alone = system.simulate(states[:, 3].copy(), target="c", **options)
    assert np.array_equal(alone.state, runs[0].state[:, 3])
    dense = system.simulate(states[:, 3].copy(), target="c", dense=True, **options)
    assert np.array_equal(dense.state, alone.state)
    assert dense.settings["stepwise"]


def test_series_follow_the_tolerance(ring):
    """The error is below it, against a motion that other steps tell; nobody has to ask for it."""
    system, source = ring.resize({"i": 12}), np.random.default_rng(2)
    state = source.normal(size=36)
    options = {"t": (0, 2), "samples": 1, "progress": False}
    exact = system.simulate(state, method="dop853", rtol=1e-13, atol=1e-14, **options).state
    for rtol in (1e-6, 1e-9):
        run = system.simulate(state, rtol=rtol, atol=rtol, **options)
        assert run.settings["method"] == "taylor"
        np.testing.assert_allclose(run.state, exact, rtol=0, atol=rtol)


def test_series_that_do_not_fit_are_refused(vortices, monkeypatch):
    """Series of all pairs grow with the square of the members: another method is named."""
    system, state = vortices.resize({"i": 400}), np.random.default_rng(0).normal(size=800)
    monkeypatch.setattr(family_steps, "find_memory", lambda: 1e8)
    with pytest.raises(KernelArgumentError, match=r"0\.2 GB.*0\.1 GB.*dop853"):
        system.simulate(state, (0, 0.1), method="taylor", progress=False)
    run = system.simulate(state, (0, 1e-6), progress=False, samples=1)
    assert run.settings["method"] == "dop853"


def test_a_run_of_many_steps_stops_where_rates_are_not_finite(vortices):
    """Two vortices in one place: sweeps of steps in C leave that to the twin, which says so."""
    system = vortices.resize({"i": 5})
    state = np.array([0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 1.0, 0.0])
    run = system.simulate(state, (0, 1), step=0.01, method="rk4", progress=False)
    assert run.status == "NONFINITE"


@pytest.fixture(scope="module")
def tops():
    """Texts of tops in a row, whose attitudes are part of the state."""
    return render(TOPS, "tops").texts


@pytest.mark.parametrize(
    ("method", "step"), [("rk4", 0.05), ("dop853", 0.05), ("dop853", None), ("taylor", None)]
)
def test_attitudes_of_members_stay_rotations(tops, method, step):
    """All steps move them back, in C, fixed ones among it, with the bits of the twin."""
    with load_texts(tops) as system:
        start = np.array([system.STATE.defaults[name] for name in system.STATE.components])
        start[system.STATE.rows("Pi")] += np.linspace(0, 1, 9)
        named = {"method": method, "step": step, "progress": False, "samples": 5}
        runs = [system.simulate(start, (0, 20), target=t, **named) for t in ("c", "numpy")]
        assert np.array_equal(*(np.asarray(run.state) for run in runs))
        assert "stepwise" not in runs[0].settings
        end = np.asarray(runs[0].state)[:, -1]
        assert np.abs(system.constraint_residual(end)).max() < 1e-14
        assert not np.allclose(end[:27], start[:27])
        R = end[:27].reshape(3, 3, 3).transpose(2, 0, 1)
        np.testing.assert_allclose(R @ R.transpose(0, 2, 1), [np.eye(3)] * 3, atol=1e-14)


def test_a_start_that_is_no_rotation_is_refused_by_member(tops):
    """The message names the member; roundings are moved back."""
    with load_texts(tops) as system:
        start = np.array([system.STATE.defaults[name] for name in system.STATE.components])
        off = start.copy()
        off[system.STATE.components.index("R11[2]")] = 1.1
        with pytest.raises(KernelArgumentError, match=r"of member 2, does not hold") as caught:
            system.simulate(off, (0, 1), target="numpy", progress=False)
        assert "R[i]*transpose(R[i]) == 1" in str(caught.value)
        assert "R11[2] = 1:" in str(caught.value)
        near = start + 1e-12
        run = system.simulate(near, (0, 0.1), target="numpy", progress=False)
        first = np.asarray(run.state)[:, 0]
        assert np.abs(system.constraint_residual(first, target="numpy")).max() < 1e-15


@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("dop853", 8), ("taylor", 12)])
def test_steps_that_leave_attitudes_are_not_taken(tops, tmp_path, method, order):
    """An object that forgets to move them back is refused."""
    kept = "memcpy(moved, state, run->rows * run->count * sizeof *moved);"
    spoiled = tops["solver.c"].replace(
        "    run->projection(", f"    {kept}\n    if (0) run->projection("
    )
    assert spoiled != tops["solver.c"]
    for file, text in (tops | {"solver.c": spoiled}).items():
        (tmp_path / file).write_text(text)
    with pytest.raises(CrossCheckError, match="a wrong solver was compiled"):
        load_steps(load_folder(tmp_path), Choice(name=method, order=order), "c")


FIELDS = [[0, 0, k] for k in range(6)]


@pytest.mark.parametrize(
    ("default", "expected", "resized"),
    [
        (FIELDS, [0.0] * 12 + [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], False),
        ([1, 2, 3], [1.0] * 6 + [2.0] * 6 + [3.0] * 6, True),
    ],
)
def test_defaults_may_differ_from_member_to_member(default, expected, resized):
    """A vector for each spin, or one for all; another number of members has none of the former."""
    field = f'B = {{ shape = [3], index = "i", default = {default} }}\n[hamiltonian]'
    text = RING.replace("[hamiltonian]", field)
    with load_texts(pipeline.render(read_spec_text(text, "ring.toml")).texts) as system:
        known = system.PARAMETERS.defaults
        assert [known[f"B{c}[{i}]"] for c in (1, 2, 3) for i in range(6)] == expected
        assert ("B1[0]" in system.resize({"i": 7}).PARAMETERS.defaults) == resized


def test_spins_begin_as_a_wave_of_any_number_of_waves():
    """It turns with the frequency 2 J cos(theta) (1 - cos(k)), k = pi/4 and cos(theta) = 4/5."""
    with load_texts(specs.rendered("heisenberg_lattice").texts) as system:
        waves = system.resize({"i": 24})
        start = np.array(list(waves.STATE.defaults.values())).reshape(3, 24)
        rates = waves.rhs(start.ravel(), target="numpy").reshape(3, 24)
        assert not system.resize({"i": 12}).STATE.defaults
    frequency = 1.6 * (1 - np.sqrt(0.5))
    np.testing.assert_allclose(start[0], 0.6 * np.cos(np.pi * np.arange(24) / 4), atol=1e-14)
    wave = [frequency * start[1], -frequency * start[0], 0 * start[2]]
    np.testing.assert_allclose(rates, wave, atol=1e-14)


def test_the_drift_of_what_begins_at_zero_is_told_as_it_is():
    """Momentum of the figure eight: a ratio to its own roundings says nothing."""
    with load_texts(specs.rendered("n_body").texts) as system:
        start = [system.STATE.defaults[name] for name in system.STATE.components]
        run = system.simulate(start, (0.0, 1.0), target="numpy", samples=5)
        many = system.simulate(np.transpose([start] * 2), (0.0, 1.0), target="numpy", samples=5)
        for solution in (run, many):
            told = {name: tell_drift(solution, name) for name in solution.conserved}
            assert told["P"].endswith("e-16 absolute") or told["P"] == "0.0e+00"
            assert float(told["energy"]) == float(f"{np.max(solution.drift['energy']):.1e}") > 0


@pytest.mark.parametrize(("text", "pair"), [(VORTICES, 18), (RING, 0)])
def test_operations_of_a_pair_are_counted(text, pair):
    """Those of both members together, and none where there are no pairs."""
    rendered = pipeline.render(read_spec_text(text, "sample.toml"))
    assert rendered.pair_operations == pair
    assert (
        "Operations per pair of members, for both of them" in rendered.texts["kernel.c"]
    ) == bool(pair)


def test_starts_may_differ_from_member_to_member():
    """Three bodies on the figure eight of Chenciner and Montgomery come back after its period."""
    with load_texts(specs.rendered("n_body").texts) as system:
        start = [system.STATE.defaults[name] for name in system.STATE.components]
        run = system.simulate(start, (0.0, 6.32591398), target="numpy", rtol=1e-11, samples=1)
        np.testing.assert_allclose(run.state[:, -1], start, atol=2e-7)
        assert np.ptp(start) > 1
        assert not system.resize({"i": 4}).STATE.defaults


def test_members_that_are_written_out_are_derived_for_the_size_that_is_chosen(tmp_path):
    """Another size needs another load, which the message says; the command line chooses it, too."""
    path = tmp_path / "walls.toml"
    path.write_text(
        'title = "W"\nroutes = ["canonical"]\n[index]\ni = { size = 3 }\n[variables]\n'
        'q = { role = "coordinate", index = "i" }\n'
        'p = { role = "momentum", of = "q", index = "i" }\n'
        '[hamiltonian]\nh = "sum(i, p[i]^2)/2 + sum(i, q[i])^2/2"\n'
        '[claims]\nconserved = ["energy"]\n'
    )
    system = load(path, sizes={"i": 2})
    assert system.written == ("i", 2)
    assert system.rhs([1.0, 2.0, 3.0, 4.0]).tolist() == [3.0, 4.0, -3.0, -3.0]
    assert system.resize({"i": 2}) is system
    with pytest.raises(KernelArgumentError, match=r"coadjoint.load\(path, sizes=\{'i': 4\}\)"):
        system.resize({"i": 4})
    given = ["prove", str(path), "--size", "i=4"]
    outcome = CliRunner().invoke(main, given)
    assert outcome.exit_code == 0, outcome.output
    assert "for N = 4" in " ".join(outcome.output.split())
    assert CliRunner().invoke(main, [*given[:3], "i=x"]).exit_code == 2


def test_fresh_kernels_are_compared_for_few_members():
    """Of many pairs NumPy would take minutes; and few have blocks, whose faults are seen."""
    texts = dict(render(VORTICES, "vortices").texts)
    with load_texts(texts) as system:
        assert [system.resize({"i": n}).probed.size for n in (9, 51, 100_000)] == [9, 51, 51]
    right, wrong = "_j = _run.i + LANES; _j < _whole", "_j = _run.i + 2 * LANES; _j < _whole"
    assert right in texts["kernel.c"]
    texts["kernel.c"] = texts["kernel.c"].replace(right, wrong)
    refused = pytest.raises(CrossCheckError, match="a wrong kernel was compiled")
    with load_texts(texts) as system, refused:
        system.resize({"i": 100_000}).find_kernel("c")
