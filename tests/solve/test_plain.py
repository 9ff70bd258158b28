"""The target Python: a file to paste, and a System that loops over its members."""

import ast
import subprocess
import sys

import numpy as np
import pytest

from coadjoint.errors import OutputError
from coadjoint.render.kernels import render_system
from coadjoint.solve.folders import load_folder
from tests.programs import HEAVY_TOP
from tests.solve.systems import EMPTYING, POLE, build, one_variable

#: I, m, g, chi of a top.
TOP = [1.0, 2.0, 4.0, 0.5, 10.0, 0.0, 0.0, 1.0]


@pytest.fixture
def top(tmp_path):
    """The heavy top of the book."""
    return build(HEAVY_TOP, tmp_path)


def test_the_file_needs_nothing_but_python(tmp_path):
    """Pasted into a folder of its own, it runs without NumPy and without this package."""
    (tmp_path / "pasted.py").write_text(render_system(HEAVY_TOP)["kernel_python.py"])
    script = (
        "import sys, pasted\n"
        "state, top = [1.0, 2.0, 3.0, 0.0, 0.6, 0.8], [1.0, 2.0, 4.0, 0.5, 10.0, 0.0, 0.0, 1.0]\n"
        "print(pasted.rhs(state, top))\nprint(pasted.energy(state, top))\n"
        "print(pasted.poisson_tensor(state, top)[0])\n"
        "assert not {'numpy', 'coadjoint'} & set(sys.modules)\n"
        "try:\n    pasted.rhs(state, [0.0] + top[1:])\n"
        "except ZeroDivisionError:\n    print('no inertia')\n"
    )
    found = subprocess.run(
        [sys.executable, "-S", "-c", script], cwd=tmp_path, check=True, capture_output=True
    )
    rates, energy, row, error = found.stdout.decode().splitlines()
    # dPi/dt = Pi x Omega + m g Gamma x chi with Omega = (1, 1, 3/4); dGamma/dt = Gamma x Omega
    assert ast.literal_eval(rates) == pytest.approx([1.5, 2.25, -1.0, -0.35, 0.8, -0.6])
    assert ast.literal_eval(energy) == pytest.approx(6.625)
    assert ast.literal_eval(row) == [0.0, -3.0, 2.0, 0.0, -0.8, 0.6]
    assert error == "no inertia"


@pytest.mark.parametrize("batch", [(), (1,), (5,), (2, 3), (0,)], ids=str)
@pytest.mark.parametrize("function", ["rhs", "energy", "poisson_tensor"])
def test_a_system_has_the_same_bits_by_both_python_kernels(top, function, batch):
    """One member or a batch, parameters shared or one set for each."""
    source = np.random.default_rng(4)
    state = source.normal(size=(6, *batch))
    for parameters in (np.array(TOP), source.uniform(1, 2, (8, *batch))):
        found, expected = (
            top.evaluate(function, state, parameters, target=target)
            for target in ("python", "numpy")
        )
        assert found.shape == expected.shape
        assert found.tobytes() == expected.tobytes()


def test_results_go_where_they_are_wanted(top):
    """A bound call reads the state as it then is and writes in place."""
    state, out = np.ones(6), np.empty(6)
    call = top.bind("rhs", state, TOP, out=out, target="python")
    call()
    state[0] = 3.0
    call()
    assert np.array_equal(out, top.rhs(state, TOP, target="numpy"))


def test_a_member_without_a_number_is_nan_and_the_others_are_not(tmp_path):
    """The root of a negative number and a quotient by zero stop Python at one member."""
    system = build(EMPTYING, tmp_path)
    states = np.array([[4.0, -1.0, 0.0, 9.0]])
    assert system.rhs(states, target="python").tolist()[0][::3] == [-2.0, -3.0]
    assert np.isnan(system.rhs(states, target="python")).tolist() == [[False, True, False, False]]
    slopes = system.jacobian(states, target="python")[0, 0]
    assert np.isnan(slopes).tolist() == [False, True, True, False]
    assert slopes[0] == -0.25


def test_an_exponential_that_is_too_large_is_nan(tmp_path):
    """Where C has an infinity, Python raises an error, which a batch survives."""
    system = build(one_variable("growing", "exp(y)", "exp(y)"), tmp_path)
    states = np.array([[0.0, 1000.0]])
    assert system.rhs(states, target="numpy").tolist() == [[1.0, np.inf]]
    one, nan = system.rhs(states, target="python")[0]
    assert one == 1.0
    assert np.isnan(nan)


def test_a_trajectory_by_plain_python(tmp_path):
    """Y' = y^2 is y0/(1 - y0 t), and the same steps are taken as with NumPy."""
    system = build(POLE, tmp_path)
    plain, numpy = (
        system.simulate([1.0], (0, 0.5), method="scipy:DOP853", target=target)
        for target in ("python", "numpy")
    )
    assert plain.status == "OK"
    assert plain["y"][-1] == pytest.approx(2.0, rel=1e-9)
    assert np.array_equal(plain.state, numpy.state)


def test_a_file_that_is_missing_or_of_another_run_is_named(tmp_path):
    """A folder that an older version wrote has no such file."""
    folder = build(POLE, tmp_path).folder
    path = folder / "kernel_python.py"
    text = path.read_text()
    path.write_text(text.replace('ID = "', 'ID = "0'))
    with pytest.raises(OutputError, match=r"kernel_python.py carries the id"):
        load_folder(folder).rhs([1.0], target="python")
    path.unlink()
    with pytest.raises(OutputError, match=r"kernel_python.py cannot be loaded.*regenerate"):
        load_folder(folder).rhs([1.0], target="python")
    assert load_folder(folder).rhs([2.0], target="numpy").tolist() == [4.0]
