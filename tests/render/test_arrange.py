"""NumPy kernels in parts: the bits of the text they come from, for one member and for many."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from coadjoint.render.targets.numpy.arrange import arrange
from coadjoint.render.targets.numpy.runner import Runner
from coadjoint.render.targets.protocol import Call
from coadjoint.resources import systems_folder
from coadjoint.solve.folders import load_folder

SYSTEMS = sorted(folder.name for folder in systems_folder().iterdir() if folder.is_dir())
SYSTEMS = [name for name in SYSTEMS if (systems_folder() / name / "kernel.py").exists()]
TEXT = """def _rhs(state, parameters, out):
    a, _, c = state[0:3]
    d = state[3]
    k, l = parameters
    # fmt: off
    zeros = (
        2,
    )
    # fmt: on
    out[zeros,] = 0.0
    _p1 = 1.0 / k
    _t1 = -(a * c) / (np.sqrt(d) + l * 2.0)
    _t2 = _t1
    out[0] = _t1
    out[1] = _p1
    out[3] = a - (_t2 - np.sin(c - k) * (d / a))
    out[4] = a + np.arctan2(d - c, np.arcsin(c / 9.0) * np.arctan2(k, l))
    out[5] = _t1


def _other():
    pass
"""


def given_to(system, function, members):
    """Arrays for a call: some members at zero, at infinity, at NaN, or with negative signs."""
    source, sizes = np.random.default_rng(members), dict(system.sizes(function))
    state = source.uniform(0.5, 2.0, (sizes.pop("state"), members))
    if members > 4:
        state[:, 0], state[0, 1], state[-1, 2] = 0.0, np.inf, np.nan
        state[:, 3] *= -1.0
    shared = {name: source.uniform(0.5, 2.0, size) for name, size in sizes.items()}
    if members == 2:
        shared["parameters"][:1] = 0.0
    return state, shared.pop("parameters"), shared


def check_bits(found, expected):
    """The same numbers with the same signs; NaN in the same places."""
    np.testing.assert_array_equal(found, expected)
    numbers = ~np.isnan(expected)
    np.testing.assert_array_equal(np.signbit(found[numbers]), np.signbit(expected[numbers]))


@pytest.mark.parametrize("name", SYSTEMS)
def test_parts_have_the_bits_of_the_text(name):
    """Every function of every system gives the bits of its formulas as they stand in the file.

    Those of equal members are loops, which are called as they stand.
    """
    system = load_folder(systems_folder() / name)
    if system.stepwise:
        assert "_member" in (system.folder / "kernel.py").read_text()
        return
    kernel = system._kernels._numpy()
    assert len(system.functions) > 3
    for function, shape in system.functions.items():
        for members in (1, 2, 9):
            state, parameters, driving = given_to(system, function, members)
            call = Call(state, parameters, np.full((*shape, members), np.pi), driving)
            for piece in kernel.calls(function, call):
                assert isinstance(piece.func.__self__, Runner)
                piece()
            check_bits(call.block, kernel.values(function, call))


def run(text, state, parameters):
    """Six results of the text above, in parts."""
    arranged, out = arrange(text, "rhs"), np.full((6, state.shape[1]), np.pi)
    Runner(arranged, 1500).run(state, np.array(parameters), out=out)
    return out


@pytest.mark.parametrize("members", [1, 5, 1024, 1500, 3001])
def test_every_form_of_a_line_is_computed(members):
    """Aliases, results that are shared, rows that are zero, functions, and chunks of any size."""
    state = np.random.default_rng(1).uniform(0.5, 2.0, (4, members))
    a, _, c, d = state
    t = -(a * c) / (np.sqrt(d) + 3.0 * 2.0)
    last = a - (t - np.sin(c - 0.7) * (d / a))
    angle = np.arctan2(d - c, np.arcsin(c / 9.0) * np.arctan2(0.7, 3.0))
    expected = [t, np.full(members, 1.0 / 0.7), 0.0 * a, last, a + angle, t]
    check_bits(run(TEXT, state, (0.7, 3.0)), np.array(expected))


def test_another_formula_gives_another_result():
    """The comparison above can fail: one sign is changed."""
    state = np.random.default_rng(1).uniform(0.5, 2.0, (4, 5))
    spoiled = run(TEXT.replace("c - k", "c + k"), state, (0.7, 3.0))
    assert not np.array_equal(spoiled, run(TEXT, state, (0.7, 3.0)))


@pytest.mark.parametrize("members", [1, 3])
def test_quotients_by_zero_and_roots_of_negative_numbers_are_no_errors(members):
    """They are infinity and NaN, of shared numbers and of a member's, whatever NumPy is set to."""
    state = np.ones((4, members))
    state[3] = -1.0
    with np.errstate(all="raise"):
        assert np.isinf(run(TEXT, state, (0.0, 3.0))[1]).all()
        assert np.isnan(run(TEXT, state, (0.0, 3.0))[0]).all()
        state[3], state[0] = 1.0, 0.0
        assert np.isinf(run(TEXT, state, (0.7, 3.0))[3]).all()
        assert np.geterr()["divide"] == "raise"


@pytest.mark.parametrize("line", ["for i in range(3): out[i] = a", "out[0] = [a][0]", "a += c"])
def test_what_is_no_formula_is_not_arranged(line):
    """A function with a line of another form runs as it stands."""
    assert arrange(TEXT, "rhs") is not None
    assert arrange(TEXT.replace("out[0] = _t1", line), "rhs") is None


def test_a_bound_call_sees_new_parameters():
    """What members share is computed again when the array has other numbers."""
    system = load_folder(systems_folder() / "heavy_top")
    for members in (1, 4):
        state, parameters, _ = given_to(system, "rhs", members)
        out = np.empty_like(state)
        call = system.bind("rhs", state, parameters, out=out, target="numpy")
        call()
        before = out.copy()
        parameters[0] *= 2.0
        call()
        assert not np.array_equal(out, before)
        check_bits(out, system.rhs(state, list(parameters), target="numpy"))
        check_bits(system.rhs(state, parameters, target="numpy"), out)
        parameters[0] *= 2.0
        assert not np.array_equal(system.rhs(state, parameters, target="numpy"), out)


def test_threads_have_rows_of_their_own():
    """Calls at the same time, of different sizes and parameters, give what each gives alone."""
    system = load_folder(systems_folder() / "chaplygin_ball")
    cases = [given_to(system, "rhs", 200 + 50 * (n % 3))[:2] for n in range(12)]
    cases = [(state, parameters * (1.0 + n)) for n, (state, parameters) in enumerate(cases)]
    alone = [system.rhs(*case, target="numpy") for case in cases]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(20):
            together = pool.map(lambda case: system.rhs(*case, target="numpy"), cases)
            for found, expected in zip(together, alone, strict=True):
                check_bits(found, expected)
