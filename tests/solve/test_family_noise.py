"""Equal members with noise, one process for all and one of each: paths, bits, means, proofs."""

from dataclasses import replace

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.errors import ClaimError, CrossCheckError, KernelArgumentError
from coadjoint.solve.choices import Choice
from coadjoint.solve.family_steps import load as load_steps
from coadjoint.solve.folders import load_texts
from coadjoint.solve.normals import draw_normals
from coadjoint.solve.self_check import check_methods
from coadjoint.solve.stochastic import find_bound
from coadjoint.spec.reader import read_spec_text
from tests.families import MOVED, SHAKEN, SPRINGS, VORTICES, read, render, write_shaken

METHODS = ["heun", "midpoint"]
SIZE, STEP, SEED = 4, 2.0**-6, 7


@pytest.fixture(scope="module")
def rendered():
    """Spins that are shaken."""
    return render(SHAKEN, "shaken")


@pytest.fixture(scope="module")
def shaken(rendered):
    """The same, loaded."""
    with load_texts(rendered.texts) as system:
        yield system


@pytest.fixture(scope="module")
def whole():
    """Four spins that are written out by hand."""
    with load_texts(pipeline.render(read_spec_text(write_shaken(SIZE), "whole.toml")).texts) as own:
        yield own


def run(system, state, method, end=1.0, parameters=None, **more):
    """A run with noise."""
    given = {"method": method, "step": STEP, "seed": SEED, "samples": 5} | more
    return system.simulate(state, (0, end), parameters, **given)


def draw_spins(n, *batch):
    """Unit vectors."""
    spins = np.random.default_rng(n).normal(size=(3, n, *batch))
    return spins / np.linalg.norm(spins, axis=0)


@pytest.mark.parametrize("method", METHODS)
def test_paths_are_those_of_members_that_are_written_out(shaken, whole, method):
    """The same numbers, and a kernel with a column for each process: another road."""
    spins, strengths = draw_spins(SIZE), [0.3, 0.9, 0.5, 0.7]
    four = shaken.resize({"i": SIZE})
    found = run(four, {"S": spins}, method, parameters={"s": strengths})
    named = {f"S_{k}": spins[:, k] for k in range(SIZE)}
    own = {f"s_{k}": value for k, value in enumerate(strengths)}
    expected = run(whole, named, method, parameters=own, target="numpy")
    for k in range(SIZE):
        np.testing.assert_allclose(found["S"][:, k], expected[f"S_{k}"], rtol=0, atol=1e-12)
    assert np.abs(found["S"][..., -1] - spins).max() > 0.1


@pytest.mark.parametrize("method", METHODS)
def test_a_path_has_the_same_bits_in_c_and_in_any_company(shaken, method):
    """Nine trajectories, and one of them alone in the same place."""
    three = shaken.resize({"i": 3})
    state = draw_spins(3, 9).reshape(9, 9)
    found, expected, alone = (
        run(three, given, method, target=target, threads=2)
        for given, target in ((state, "c"), (state, "numpy"), (state[:, :1], "c"))
    )
    assert np.array_equal(found.state, expected.state)
    assert np.array_equal(found.state[:, :1], alone.state)
    equal = run(three, np.repeat(state[:, :1], 2, axis=1), method)
    assert not np.array_equal(equal.state[:, 0], equal.state[:, 1])


def test_a_process_of_all_turns_them_about_its_axis(shaken):
    """By 2 atan(z dW/2) in each step of the midpoint, and by no other angle; Cayley's map."""
    steps, n, z = 64, 45, 0.8
    system, spins = shaken.resize({"i": n}), draw_spins(n)
    motion = run(system, {"S": spins}, "midpoint", parameters={"J": 0, "s": np.zeros(n), "z": z})
    place, made = np.zeros(steps, np.uint64), np.arange(steps, dtype=np.uint64)
    bound = find_bound("midpoint", STEP)
    increments = np.clip(draw_normals(SEED, place, made, 0), -bound, bound) * np.sqrt(STEP)
    angle = np.arctan(z * increments / 2).sum() * 2
    before, after = (spins[0] + 1j * spins[1], motion["S"][..., -1])
    turned = (after[0] + 1j * after[1]) / before
    np.testing.assert_allclose(turned, np.exp(-1j * angle) * np.ones(n), rtol=0, atol=1e-11)
    np.testing.assert_allclose(after[2], spins[2], rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_the_mean_of_members_decays(shaken, method):
    """E[S3] = exp(-s^2 t) and E[S1] = exp(-s^2 t/2) of two processes of each, dX and dY.

    Each process alone gives d<S> = (1/2) s^2 e x (e x <S>) dt. Members are the ensemble.
    """
    n = 4000
    system, start = shaken.resize({"i": n}), np.zeros((3, n))
    start[2, : n // 2] = start[0, n // 2 :] = 1.0
    values = {"J": 0, "s": np.ones(n), "z": 0}
    motion = run(system, {"S": start}, method, 0.5, values, step=2.0**-5, samples=2)
    spins = motion["S"][..., -1]
    four = 4.0 / np.sqrt(n / 2)  # standard deviations of these means are below 1
    assert abs(spins[2, : n // 2].mean() - np.exp(-0.5)) < 0.6 * four
    assert abs(spins[0, n // 2 :].mean() - np.exp(-0.25)) < 0.6 * four
    lag = spins[2, : n // 2] - spins[2, : n // 2].mean()
    assert abs((lag[1:] * lag[:-1]).mean()) < 4 * lag.var() / np.sqrt(n / 2)


def test_the_midpoint_keeps_the_casimir_of_each_and_heun_does_not(shaken):
    """Path by path, for every member."""
    spins = {"S": draw_spins(20)}
    drift = {}
    for method in METHODS:
        motion = run(shaken.resize({"i": 20}), spins, method)
        drift[method] = np.abs((motion["S"] ** 2).sum(axis=0) - 1).max()
    assert drift["midpoint"] < 1e-12
    assert drift["heun"] > 1e-5


def test_what_the_noise_does_is_proved_for_every_number_of_members(rendered):
    """Casimirs of each member on each path; what the noise changes is refused."""
    statements = [each.statement for each in rendered.certificate.claims]
    for said in (
        "the noise keeps dot(S[i], S[i]) on each path: {C, h_k} = 0",
        "dX[i] moves the state by {x, s[i]*S[i, 1]}",
        "dZ moves the state by {x, z*sum(i, S[i, 3])}",
        "the energy changes by the noise, {h, h_k} o dW_k",
    ):
        assert f"{said}, for every N >= 2" in statements
    assert not any("commute" in each for each in statements)
    claimed = SHAKEN + 'conserved = ["M"]\n'
    with pytest.raises(ClaimError, match="M is conserved"):
        pipeline.render(read_spec_text(claimed, "shaken.toml"))
    turned = claimed.replace('dX = "s[i]*S[i, 1]"\n', "").replace("s[i]*S[i, 2]", "s[i]*S[i, 3]")
    found = pipeline.render(read_spec_text(turned, "turned.toml")).certificate.claims
    assert "M is conserved, for every N >= 2" in [each.statement for each in found]


RING = SHAKEN.replace("size = 5", "size = 5, periodic = true")
RING = RING.replace('"s[i]*S[i, 2]"', '"s[i]*t*dot(S[i], S[i+1])"').replace(
    "[noise]", '[time]\nname = "t"\n[noise]'
)


def test_noise_may_couple_neighbours_and_name_the_time():
    """The fields are those of a column for each process, in Python's kernels."""
    n, source = 5, np.random.default_rng(5)
    text = write_shaken(n).replace("[noise]", '[time]\nname = "t"\n[noise]')
    bonds = [f"dot(S_{k}, S_{(k + 1) % n})" for k in range(n)]
    for k in range(n):
        text = text.replace(f'"s_{k}*S_{k}[2]"', f'"s_{k}*t*{bonds[k]}"')
    state, numbers = source.normal(size=3 * n), source.normal(size=1 + 2 * n)
    own = {"time": 0.7, "target": "python"}
    with load_texts(render(RING).texts) as ring:
        found = ring.evaluate("noise_vector", np.concatenate([state, numbers]), **own)
    with load_texts(pipeline.render(read_spec_text(text, "whole.toml")).texts) as whole:
        spins = state.reshape(3, n).T.ravel()
        expected = whole.evaluate("noise", spins, **own) @ numbers
    np.testing.assert_allclose(found.reshape(3, n).T.ravel(), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("hamiltonian", "why"),
    [
        ("sum(i, j, i < j, x[i]*x[j])", "a Hamiltonian of noise has a sum over pairs"),
        ("sum(i, x[i])^2", "a Hamiltonian of noise is not linear in sums over members"),
        ("x[0]", "x stands there of one member alone"),
    ],
)
def test_noise_that_no_member_tells_is_written_out(hamiltonian, why):
    """And the spec says why."""
    noisy = VORTICES.split("[claims]")[0].replace("size = 6", "size = 3")
    assert read(noisy + f'[noise]\ndW = "{hamiltonian}"\n').written == why


def test_noise_of_members_that_are_written_out_is_there_for_each():
    """With a process of its own for each of them."""
    text = SPRINGS.replace("size = 6", "size = 3").replace('"euler-lagrange", ', "")
    text = text.split("[claims]")[0]
    found = read(text + '[noise]\ndW = "c*q[i]"\ndV = "sum(i, q[i])"\n')
    assert found.written == "there are tables [noise] and [lagrangian]"
    assert [each.name for each in found.noise] == ["dW_0", "dW_1", "dW_2", "dV"]


def test_a_run_with_noise_says_what_is_missing(shaken):
    """As of every system with noise."""
    with pytest.raises(KernelArgumentError, match="seed is None"):
        run(shaken, draw_spins(5).ravel(), "heun", seed=None)
    assert "; noise dZ, dX, dY" in repr(shaken)
    numbers = np.zeros((15 + 11, 2))
    assert shaken.noise_vector(numbers, target="python").shape == (15, 2)


def test_inputs_time_and_noise_move_members_together():
    """Six arrays of a call, and steps in C with all that drives them: the bits of NumPy."""
    source = np.random.default_rng(6)
    with load_texts(render(MOVED, "moved").texts) as system:
        three, signal = system.resize({"i": 3}), ([0, 0.5, 1], source.normal(size=(4, 3)), "linear")
        state, inputs = source.normal(size=(9, 5)), source.normal(size=(4, 5))
        found, expected = (
            (
                three.rhs(state, None, inputs, time=0.5, target=target),
                three.simulate(
                    state, (0, 1), None, signal, step=STEP, seed=1, samples=3, target=target
                ).state,
            )
            for target in ("c", "numpy")
        )
    for one, other in zip(found, expected, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("target", ["numpy", "c"])
def test_sweeps_are_counted_and_a_step_without_a_solution_says_so(shaken, target):
    """Heun's method has none."""
    three, state = shaken.resize({"i": 3}), draw_spins(3, 5).reshape(9, 5)
    found = run(three, state, "midpoint", target=target)
    assert np.array_equal(found.sweeps, run(three, state, "midpoint", target="numpy").sweeps)
    assert (found.sweeps > 2 * found.steps).all()
    assert run(three, state, "heun", target=target).sweeps is None
    far = run(three, state, "midpoint", 320.0, step=40.0, target=target)
    assert (far.status == "NOT_SOLVED").all()
    assert not far.steps.any()


def test_methods_of_members_with_noise_are_judged_and_checked(rendered, shaken):
    """Radii of spheres on each path, also without a claim; without the bracket of so(3) none."""
    kept = {each.name: each.exactly for each in shaken.METHODS}
    assert kept == {"midpoint": ("dot(S[i], S[i])",), "heun": ()}
    assert run(shaken, draw_spins(5).ravel(), "auto").settings["method"] == "midpoint"
    found = {each.method.name: each for each in check_methods(shaken, ["all"])}
    assert not [each.failures for each in found.values() if each.failures]
    assert found["midpoint"].drifts["dot(S[i], S[i])"] < 1e-13
    assert found["heun"].drifts["dot(S[i], S[i])"] > 1e-5
    (own,) = (x for x in shaken.METHODS if x.name == "heun")
    wrong = replace(own, exactly=("dot(S[i], S[i])",))
    with load_texts(rendered.texts) as other:
        other.METHODS = (wrong,)
        (failed,) = check_methods(other, ["heun"])
    assert any("dot(S[i], S[i]) drifts by" in each for each in failed.failures)


SPOILED_STEPS = [
    ("(uint32_t)((n + w) / width)", "0", "heun"),
    ("0.5 * (first[n + l] + later[n + l])", "(first[n + l] * 0.25 + 0.75 * later[n + l])", "heun"),
    ("sweep < 100", "sweep < 3", "midpoint"),
    ("++block->made[l];\n                const int small", "const int small", "midpoint"),
    ("block->accepted[l] && block->finite[l]", "block->accepted[l]", "midpoint"),
]


@pytest.mark.parametrize(("old", "new", "method"), SPOILED_STEPS)
def test_steps_that_are_wrong_differ_from_those_of_the_twin(rendered, old, new, method):
    """Numbers, the step itself, and how far its equation is solved."""
    texts = dict(rendered.texts)
    assert old in texts["solver.c"]
    texts["solver.c"] = texts["solver.c"].replace(old, new)
    choice = Choice(name=method, order=2, is_noisy=True)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="differs from its"):
        load_steps(system, choice, "c")


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernel.py", "state[3 * size]", "state[3 * size + 1]"),
        ("kernel_python.py", "state[1 + 4 * size + i]", "state[1 + 3 * size + i]"),
    ],
)
def test_the_ladder_sees_numbers_of_other_processes(rendered, monkeypatch, file, old, new):
    """Also where the template itself takes them."""
    own, texts = rendered.family, dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    with load_texts(texts) as system, pytest.raises(CrossCheckError):
        crosscheck_family(own, texts, system, ["numpy", "python"], texts)


def test_the_ladder_passes(rendered):
    """Fields to 50 digits, bits for several numbers of members, steps of both methods."""
    report = pipeline.verify(rendered)
    assert set(report.rungs.values()) == {"passed"}
    assert all(each.points > 20 for each in report.figures["noise_vector"].values())
