"""Systems: targets agree, binding, light imports, threads, forks, odd numbers."""

import inspect
import os
import resource
import shutil
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from coadjoint.declared import Quantity
from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve.folders import load_folder
from coadjoint.solve.quantities import Quantities
from coadjoint.systems import heavy_top, kirchhoff, rigid_body
from tests.processes import processor_seconds, wait_for_work

SYSTEMS = (rigid_body, heavy_top, kirchhoff)
FUNCTIONS = ("rhs", "jacobian", "energy", "observables", "poisson_tensor")
BATCHES = ((), (1,), (2,), (7,), (1001,), (3, 5))


def inputs(module, batch, seed=0):
    """Random states and parameters."""
    source = np.random.default_rng(seed)
    state = source.normal(size=(module.STATE.size, *batch))
    return state, np.abs(source.normal(size=(module.PARAMETERS.size, *batch))) + 0.5


@pytest.mark.parametrize("batch", BATCHES, ids=str)
@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("module", SYSTEMS, ids=lambda m: m.system.name)
def test_c_equals_numpy_to_the_last_bit(module, function, batch):
    """Every function, odd batch sizes, shared and own parameters; shapes follow the batch."""
    state, own = inputs(module, batch)
    for parameters in (None, own):
        c = getattr(module, function)(state, parameters, target="c")
        numpy = getattr(module, function)(state, parameters, target="numpy")
        assert c.shape == module.system.functions[function] + batch
        assert np.array_equal(c.view(np.int64), numpy.view(np.int64))
        assert c.any()


@pytest.mark.parametrize("module", SYSTEMS, ids=lambda m: m.system.name)
def test_odd_numbers_pass_alike(module):
    """NaN, infinities, subnormals, signed zeros: the same pattern, the same bits elsewhere."""
    odd = [np.nan, np.inf, -np.inf, 5e-324, -0.0, 0.0, 1e308, -1e-308]
    state = np.resize(odd, (module.STATE.size, 64)) * 1.0
    state[0] = np.linspace(-1, 1, 64)
    c, numpy = (module.rhs(state, target=target) for target in ("c", "numpy"))
    assert np.isnan(c).any()
    assert np.array_equal(np.isnan(c), np.isnan(numpy))
    same = ~np.isnan(c)
    assert np.array_equal(c[same].view(np.int64), numpy[same].view(np.int64))


def test_a_bound_call_reads_and_writes_in_place():
    """State changes are seen, results appear in out, for every target."""
    for target in ("c", "numpy", "c-fast"):
        state, out = np.array([1.0, 2.0, 3.0]), np.empty(3)
        call = rigid_body.bind("rhs", state, {"I": [1.0, 2.0, 4.0]}, out=out, target=target)
        call()
        first = out.copy()
        state *= 2
        call()
        assert np.array_equal(out, 4 * first)


def test_bound_calls_ask_for_arrays_they_can_use_in_place():
    """A list, a view with strides, or no out cannot be bound."""
    with pytest.raises(KernelArgumentError, match="in place"):
        rigid_body.bind("rhs", [1.0, 2.0, 3.0], out=np.empty(3))
    with pytest.raises(KernelArgumentError, match="in place"):
        rigid_body.bind("rhs", np.ones(6)[::2], out=np.empty(3))
    with pytest.raises(KernelArgumentError, match="writes into out"):
        rigid_body.bind("rhs", np.ones(3))


def test_bound_calls_keep_their_arrays_alive():
    """Temporaries passed to bind are not freed under the call."""
    out = np.empty(3)
    call = rigid_body.bind("rhs", np.array([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0], out=out)
    np.ones((100, 1000))
    call()
    assert out.tolist() == pytest.approx([-1.0, 2.0, -1.0])


def test_unknown_functions_and_targets_are_refused():
    """With what there is."""
    with pytest.raises(KernelArgumentError, match="no function 'rsh'; expected one of rhs"):
        rigid_body.system.evaluate("rsh", np.ones(3))
    with pytest.raises(
        KernelArgumentError, match="target is 'rust'; expected 'numpy', 'c', 'c-fast' or 'python'"
    ):
        rigid_body.rhs(np.ones(3), target="rust")


def test_a_mixed_tree_is_refused(tmp_path):
    """Files of two runs in one folder carry different ids."""
    folder = tmp_path / "heavy_top"
    shutil.copytree(heavy_top.system.folder, folder)
    kernel = folder / "kernel.py"
    kernel.write_text(kernel.read_text().replace(heavy_top.system.id, "f" * 16))
    with pytest.raises(OutputError, match=r"'ffffffffffffffff'.*coadjoint regenerate"):
        load_folder(folder).rhs(np.ones(6), target="numpy")


def test_a_folder_without_a_system_is_refused(tmp_path):
    """The message names the folder."""
    with pytest.raises(OutputError, match="contains no generated system"):
        load_folder(tmp_path)


def test_eight_threads_get_eight_right_answers():
    """Kernels have no state, and calls release the interpreter lock."""
    batches = [inputs(heavy_top, (5000,), seed)[0] for seed in range(8)]
    expected = [heavy_top.rhs(state, target="numpy") for state in batches]
    with ThreadPoolExecutor(8) as pool:
        for _ in range(5):
            for found, right in zip(pool.map(heavy_top.rhs, batches), expected, strict=True):
                assert np.array_equal(found, right)


@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_a_forked_child_computes():
    """No thread pool of ours hangs after a fork."""
    heavy_top.rhs(np.ones(6))
    child = os.fork()
    if child == 0:
        signal.alarm(600)  # what hangs, hangs for ever
        right = np.array_equal(heavy_top.rhs(np.ones(6)), heavy_top.rhs(np.ones(6), target="numpy"))
        os._exit(0 if right else 1)
    assert os.waitpid(child, 0)[1] == 0


def test_ctrl_c_ends_a_long_call():
    """SIGINT during a large evaluation raises KeyboardInterrupt before much more is computed."""
    script = (
        "import numpy as np, sys\n"
        "from coadjoint.systems import heavy_top\n"
        "state = np.ones((6, 1 << 21))\n"
        "heavy_top.rhs(state[:, :1].copy())\n"
        "print('ready', flush=True)\n"
        "while True:\n    heavy_top.jacobian(state)\n"
    )
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "ready\n"
        wait_for_work(process.pid, processor_seconds(process.pid) + 0.5)
        computed = processor_seconds(process.pid)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert "KeyboardInterrupt" in errors
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    in_all = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert in_all - computed < 5  # an evaluation and the end of Python


@pytest.mark.parametrize(
    "module", ["coadjoint", "coadjoint.solve.system", "coadjoint.systems.heavy_top"]
)
def test_importing_loads_no_heavy_library(module):
    """Neither SymPy nor NumPy nor SciPy nor pydantic comes with the import."""
    script = f"import sys, {module}\nprint(sorted(sys.modules))"
    found = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout
    assert f"'{module}'" in found
    for heavy in ("sympy", "numpy", "scipy", "pydantic", "jinja2", "mpmath", "matplotlib"):
        assert f"'{heavy}'" not in found


def test_using_a_system_loads_numpy_alone():
    """Evaluation and simulation run without SymPy, SciPy and the reader of specs."""
    script = (
        "import sys\n"
        "from coadjoint.systems import heavy_top\n"
        "top = heavy_top.simulate([0.1, 0.2, 3, 0, 0, 1], (0, 0.1))\n"
        "top['energy']; top.drift\n"
        "print('sympy' in sys.modules, 'pydantic' in sys.modules, 'scipy' in sys.modules)"
    )
    found = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert found.stdout.split() == ["False"] * 3


def test_systems_describe_themselves():
    """Names, shapes, units and defaults, title and source."""
    assert heavy_top.STATE.components == ("Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3")
    assert heavy_top.PARAMETERS["chi"].shape == (3,)
    assert heavy_top.PARAMETERS["m"].unit == "kg"
    assert rigid_body.PARAMETERS["I"].default == (1.0, 2.0, 3.0)
    assert "Holm" in heavy_top.system.source
    assert "heavy_top" in repr(heavy_top.system)
    assert "kg" in repr(heavy_top.PARAMETERS)
    assert "<td>chi</td>" in heavy_top.PARAMETERS._repr_html_()


def test_packed_parameters_of_a_bound_call_are_read_at_each_call():
    """A packed array is used in place, a mapping is copied."""
    state, inertia, out = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 4.0]), np.empty(3)
    call = rigid_body.bind("rhs", state, inertia, out=out)
    call()
    assert out.tolist() == [-1.5, 2.25, -1.0]
    inertia[2] = 2.0
    call()
    assert out.tolist() == [0.0, 1.5, -1.0]


def test_quantities_are_escaped_in_notebooks():
    """A unit cannot bring markup."""
    assert "<b>" not in Quantities(Quantity("x", (), "<b>", ("x",)))._repr_html_()


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        ("rhs", ([1.0, 2.0, 3.0], None, "numpy")),
        ("jacobian", ([1.0, 2.0, 3.0], None, "c", np.empty((3, 3)))),
        ("evaluate", ("energy", [1.0, 2.0, 3.0], None, "numpy")),
        ("bind", ("rhs", np.ones(3), None, np.empty(3))),
    ],
)
def test_target_and_out_go_by_name(function, arguments):
    """The former positional use is refused with the spelling that works."""
    with pytest.raises(KernelArgumentError, match='target="c", out=out'):
        getattr(rigid_body.system, function)(*arguments)


def test_signatures_show_what_goes_by_name():
    """What an editor shows is the signature of the method, not that of its guard."""
    shown = inspect.signature(rigid_body.rhs)
    assert list(shown.parameters) == ["state", "parameters", "inputs", "time", "target", "out"]
    assert shown.parameters["target"].kind is inspect.Parameter.KEYWORD_ONLY
