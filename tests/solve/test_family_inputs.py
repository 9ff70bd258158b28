"""Equal members with inputs, of each and of all: kernels, signals, steps, proofs for every N."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.errors import ClaimError, CrossCheckError, KernelArgumentError
from coadjoint.solve.choices import Choice
from coadjoint.solve.family_steps import load as load_steps
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from tests.families import PULLED, SPRINGS, read, render, write_pulled

SIZE = 4
RK4, TAYLOR = Choice("rk4", 4), Choice("taylor", 6)
METHODS = [("rk4", 2.0**-6), ("dop853", None), ("taylor", None)]
#: A jump of the input of one member, another one of that of all, and a ramp.
TIMES = [0.0, 0.5, 0.75, 2.0]


@pytest.fixture(scope="module")
def rendered():
    """Beads that are pulled."""
    return render(PULLED, "pulled")


@pytest.fixture(scope="module")
def pulled(rendered):
    """The same, loaded."""
    with load_texts(rendered.texts) as system:
        yield system


@pytest.fixture(scope="module")
def whole():
    """Four beads that are written out by hand."""
    with load_texts(pipeline.render(read_spec_text(write_pulled(SIZE), "whole.toml")).texts) as own:
        yield own


def draw_signal(kind):
    """Samples of all inputs."""
    source = np.random.default_rng(1)
    values = source.normal(size=(SIZE + 2, len(TIMES)))
    values[0, 1] = values[0, 0]
    return TIMES, values, kind


def in_order(rows):
    """Rows of a family, g and f before those of members, as the text by hand has them."""
    return np.concatenate([rows[2:], rows[:2]])


def test_rates_and_energies_are_those_of_members_that_are_written_out(pulled, whole):
    """In every target; inputs of trajectories of their own, and shared ones."""
    four, source = pulled.resize({"i": SIZE}), np.random.default_rng(4)
    state = source.normal(size=(2 * SIZE, 9))
    for shape in ((), (9,)):
        inputs = source.normal(size=(SIZE + 2, *shape))
        for target in ("c", "numpy", "python", "c-fast"):
            for name in ("rhs", "energy"):
                found = four.evaluate(name, state, None, inputs, target=target)
                expected = whole.evaluate(name, state, None, in_order(inputs), target="numpy")
                np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["previous", "linear"])
@pytest.mark.parametrize(("method", "step"), METHODS)
def test_signals_drive_members_as_those_that_are_written_out(pulled, whole, kind, method, step):
    """Held samples and ramps, by each method; C has the bits and the steps of the twin."""
    four, (times, values, _) = pulled.resize({"i": SIZE}), draw_signal(kind)
    start = np.random.default_rng(2).normal(size=2 * SIZE)
    given = {"method": method} | ({"step": step} if step else {"rtol": 1e-11})
    found, twin = (
        four.simulate(start, TIMES, None, (times, values, kind), target=target, **given)
        for target in ("c", "numpy")
    )
    expected = whole.simulate(start, TIMES, None, (times, in_order(values), kind), **given)
    assert np.array_equal(found.state, twin.state)
    assert found.course.steps == twin.course.steps
    np.testing.assert_allclose(found.state, expected.state, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(found["u"][1], expected["u_1"])


def test_trajectories_have_inputs_of_their_own(pulled):
    """Constants of each of nine, C as NumPy to the bit."""
    three, source = pulled.resize({"i": 3}), np.random.default_rng(3)
    state, inputs = source.normal(size=(6, 9)), source.normal(size=(5, 9))
    for method, step in METHODS:
        both = [
            three.simulate(state, (0, 1), None, inputs, method=method, step=step, target=target)
            for target in ("c", "numpy")
        ]
        assert np.array_equal(both[0].state, both[1].state)


@pytest.mark.parametrize("size", [2, 45])
def test_a_force_on_all_has_its_closed_form(pulled, size):
    """Q'' = g - q from rest: t - sin t for g = t, however it is told, and 1 - cos t for g = 1."""
    system, times = pulled.resize({"i": size}), np.linspace(0, 4, 5)
    rest, still = {"q": np.zeros(size), "p": np.zeros(size)}, np.zeros((size, 2))
    ramp = [0, 4], {"u": still, "g": [0, 4], "f": [0, 0]}, "linear"
    function = lambda t: {"u": np.zeros(size), "g": t, "f": 0.0}  # noqa: E731
    for inputs in (ramp, function):
        motion = system.simulate(rest, times, None, inputs)
        np.testing.assert_allclose(motion["q"], [times - np.sin(times)] * size, atol=1e-9)
    assert motion.method == "dop853"
    assert "inputs are a function" in repr(motion)
    held = system.simulate(rest, times, None, {"u": 0 * still[:, 0]})
    np.testing.assert_allclose(held["q"], [1 - np.cos(times)] * size, atol=1e-9)
    with pytest.raises(KernelArgumentError, match="rates of all orders"):
        system.simulate(rest, times, None, function, method="taylor")


def test_events_name_inputs_of_members(pulled):
    """Steps that are recorded know the inputs, too."""
    inputs = [0, 4], {"u": np.zeros((3, 2)), "g": [0, 4], "f": [0, 0]}, "linear"
    motion = pulled.resize({"i": 3}).simulate(
        np.zeros(6), (0, 4), None, inputs, events=["q[1] = 1"], dense=True
    )
    (time,) = motion.events["q[1] = 1"].time
    assert abs(time - np.sin(time) - 1) < 1e-8
    np.testing.assert_allclose(motion.at([2.5])["q"][2], 2.5 - np.sin(2.5), atol=1e-8)


def test_a_size_counts_inputs(pulled):
    """Defaults of members, and what it says of itself."""
    seven = pulled.resize({"i": 7})
    assert seven.INPUTS.components == ("g", "f", *(f"u[{k}]" for k in range(7)))
    assert seven.INPUTS.defaults["u[6]"] == 0.5
    assert repr(seven).endswith("; inputs g, f, u>")
    with pytest.raises(KernelArgumentError, match="inputs"):
        seven.rhs(np.zeros(14), None, np.zeros(6))


def test_the_balance_of_the_energy_is_proved_for_every_number_of_members(rendered):
    """With its scope; a total that the inputs change is refused."""
    statements = [each.statement for each in rendered.certificate.claims]
    balance = "the energy changes by the power of the forces while the inputs are constant"
    assert f"{balance}, for every N >= 2" in statements
    claimed = PULLED + '[claims]\nconserved = ["P"]\n'
    with pytest.raises(ClaimError, match="P"):
        pipeline.render(read_spec_text(claimed, "pulled.toml"))
    free = claimed.replace("- g*q[i]", "").replace("k[i]*q[i]^2/2 ", "0 ").split("[forces]")
    free = free[0].replace("u[i+1]*q[i]*q[i+1]", "u[i+1]*(q[i] - q[i+1])^2") + "[observables]"
    free = free.replace("g = { default = 1 }\nf = { default = 0 }\n", "")
    free = free.replace('k = { index = "i", default = 1 }', "")
    free += PULLED.split("[observables]")[1] + '[claims]\nconserved = ["energy", "P"]\n'
    found = pipeline.render(read_spec_text(free, "free.toml")).certificate.claims
    assert "P is conserved, for every N >= 2" in [each.statement for each in found]
    energy = "the energy is conserved while the inputs are constant, for every N >= 2"
    assert energy in [each.statement for each in found]


FRAMES = """
title = "Free particles, seen from frames that move"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[inputs]
u = { index = "i", rate = "du" }
du = { index = "i" }
[time]
name = "t"
[hamiltonian]
h = "sum(i, p[i]^2/2 - du[i]*p[i])"
[claims]
conserved = ["sum(i, q[i] + u[i] - t*p[i])"]
"""


def test_rates_of_inputs_are_known_in_claims():
    """Of each member that of its own input."""
    claimed = "sum(i, q[i] + u[i] - t*p[i]) is conserved, for every N >= 1"
    found = pipeline.render(read_spec_text(FRAMES, "frames.toml")).certificate.claims
    assert claimed in [each.statement for each in found]
    with pytest.raises(ClaimError, match="is conserved, for every N"):
        pipeline.render(read_spec_text(FRAMES.replace("+ u[i]", "+ 2*u[i]"), "frames.toml"))


def test_inputs_next_to_a_lagrangian_are_written_out():
    """And the spec says why."""
    text = SPRINGS.replace("[lagrangian]", '[inputs]\nu = { index = "i" }\n[lagrangian]')
    text = text.replace("m[i]*v[i]^2/2)", "m[i]*v[i]^2/2 - u[i]*q[i])")
    text = text.replace("p[i]^2/(2*m[i]))", "p[i]^2/(2*m[i]) + u[i]*q[i])")
    assert read(text).written == "there are tables [inputs] and [lagrangian]"


#: How steps lose an input, and by which method that is seen.
SPOILED_STEPS = [
    ("solver.c", "? run->knots[piece + 1] : end", "? end : end", RK4),
    (
        "solver.c",
        "block->accepted[l] && value != ended",
        "block->accepted[l] && value != ended && 0",
        RK4,
    ),
    ("solver.c", "2 + row * size + first, 1, n", "2 + row * size + first, 0, n", TAYLOR),
    ("solver.py", "series[COMPONENTS:, k] = ", "series[COMPONENTS:, k] = (1 - k) * ", TAYLOR),
]


@pytest.mark.parametrize(("file", "old", "new", "choice"), SPOILED_STEPS)
def test_steps_that_lose_an_input_differ_from_those_of_the_twin(rendered, file, old, new, choice):
    """In C or in NumPy, whose texts are two."""
    texts = dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="differs from its"):
        load_steps(system, choice, "c")


def test_the_ladder_passes(rendered):
    """50 digits for three windows, bits for several numbers of members, series and steps."""
    report = pipeline.verify(rendered)
    assert set(report.rungs.values()) == {"passed"}
    assert all(each.points > 20 for each in report.figures["rhs"].values())


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernel.c", "_run.inputs + (2 + _run.i", "_run.inputs + (1 + _run.i"),
        ("kernel.c", "= inputs_stride && !_single", "= inputs_stride && 0"),
        ("kernel.py", "inputs[2 + i]", "inputs[1 + i]"),
    ],
)
def test_the_ladder_sees_an_input_of_another_member(rendered, monkeypatch, file, old, new):
    """Also where the template itself takes it."""
    own, texts = rendered.family, dict(rendered.texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    with load_texts(texts) as system, pytest.raises(CrossCheckError):
        crosscheck_family(own, texts, system, printed=texts)
