"""Kernels: who computes, in which pieces, and how a stand-in is announced."""

import gc
import shutil
import stat
import warnings
import weakref
from functools import partial
from time import process_time

import numpy as np
import pytest

from coadjoint.build import compiler, library
from coadjoint.build.compiler import CompilerWarning, find_compiler
from coadjoint.errors import CompilerError, OutputError
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.render.kernels import render_system
from coadjoint.render.targets import BUILDS
from coadjoint.render.targets.c import loader
from coadjoint.render.targets.protocol import FEW
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder
from coadjoint.systems import heavy_top, kirchhoff, quadrotor, rigid_body
from tests.programs import HEAVY_TOP
from tests.solve.systems import pendulum


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """A shipped system as if for the first time: its own folder, an empty cache, nothing said."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(kernels, "_said", set())
    compiler._find.cache_clear()

    def load(module):
        folder = tmp_path / module.system.name
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(module.system.folder, folder, ignore=ignored)
        return load_folder(folder)

    yield load
    compiler._find.cache_clear()


def test_a_missing_compiler_is_said_once_for_all_systems(monkeypatch, fresh):
    """One warning in a process, with the pip command; right results from each system."""
    monkeypatch.setenv("CC", "no-such-compiler")
    body, top = fresh(rigid_body), fresh(heavy_top)
    with pytest.warns(CompilerWarning, match=r"coadjoint\[c\]") as said:
        found = body.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
    assert said[0].filename == __file__
    assert found.tolist() == [-1.5, 2.25, -1.0]
    state = np.arange(1.0, 7.0)
    for target in ("c", "c-fast"):  # another warning would be an error
        assert np.array_equal(top.rhs(state, target=target), top.rhs(state, target="numpy"))


def test_a_bound_call_works_without_a_compiler(monkeypatch, fresh):
    """The NumPy kernel reads and writes in place, too."""
    monkeypatch.setenv("CC", "no-such-compiler")
    state, out = np.array([1.0, 2.0, 3.0]), np.empty(3)
    with pytest.warns(CompilerWarning):
        call = fresh(rigid_body).bind("rhs", state, [1.0, 2.0, 4.0], out=out)
    call()
    assert out.tolist() == [-1.5, 2.25, -1.0]


@pytest.mark.parametrize(
    ("function", "spoil"),
    [
        # one entry of the Poisson tensor, in both branches
        ("poisson_tensor", "s/= -Gamma2;/= Gamma2;/"),
        ("rhs", "0,/Omega2 = _p2 [*] Pi2/s//Omega2 = _p2 * Pi1/"),  # shared only
        ("rhs", "s/parameters.3 [*] parameters_stride/parameters[2 * parameters_stride/"),  # own
        # the last member is left out, of rows that are zero and of others
        ("jacobian", "s/_n < count/_n + 1 < count/;s/_n < _last/_n + 1 < _last/"),
    ],
)
def test_every_branch_of_a_wrong_kernel_is_noticed(monkeypatch, fresh, tmp_path, function, spoil):
    """Shared and own parameters, any function, all members: compared before caching."""
    real, script = find_compiler().command[0], tmp_path / "traitor"
    script.write_text(
        f"#!/bin/sh\n[ -f kernel.c ] && sed -i '{spoil}' kernel.c\nexec {real} \"$@\""
    )
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    system = fresh(heavy_top)
    text = (system.folder / "kernel.c").read_text()
    monkeypatch.setenv("CC", str(script))
    with pytest.warns(CompilerWarning, match=rf"a wrong kernel was compiled: heavy_top.{function}"):
        system.evaluate(function, np.ones(6))
    assert (system.folder / "kernel.c").read_text() == text


def test_what_is_called_first_is_compiled_first(monkeypatch, fresh):
    """Each function is an object of its own, until all of them are asked for as one."""
    compiled = []
    real = library.compile_kernel

    def record(compiler, folder, build, source):
        compiled.append(source.defines)
        return real(compiler, folder, build, source)

    monkeypatch.setattr(library, "compile_kernel", record)
    again = fresh(heavy_top)
    rendered = render_system(HEAVY_TOP)
    for name, text in rendered.items():
        (again.folder / name).write_text(text)
    again = load_folder(again.folder)
    state = np.arange(1.0, 7.0)
    expected = {name: again.evaluate(name, state, target="numpy") for name in again.functions}
    assert np.array_equal(again.rhs(state), expected["rhs"])
    assert compiled == [("-DCOADJOINT_ONLY", "-DCOADJOINT_ONLY_RHS")]
    own = again._kernels._loaded["c"]._libraries["rhs"]
    with pytest.raises(CompilerError, match="has no function energy"):
        own.find("energy")
    again.energy(state)
    again.rhs(state)
    assert compiled[1:] == [("-DCOADJOINT_ONLY", "-DCOADJOINT_ONLY_ENERGY")]
    again.prepare()
    assert compiled[2:] == [()]
    another = load_folder(again.folder)
    for name, value in expected.items():
        assert np.array_equal(another.evaluate(name, state), value)
    assert len(compiled) == 3
    assert len(set(another._kernels._loaded["c"]._libraries.values())) == 1


def test_a_function_that_cannot_be_compiled_leaves_the_others_alone(monkeypatch, fresh, tmp_path):
    """NumPy stands in for what failed, and C computes what was compiled."""
    real, script = find_compiler().command[0], tmp_path / "weak"
    script.write_text(
        '#!/bin/sh\ncase "$*" in *ONLY_ENERGY*) exit 1;; esac\n' + f'exec {real} "$@"'
    )
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("CC", str(script))
    system, state = fresh(heavy_top), np.ones(6)
    with pytest.warns(CompilerWarning, match="weak failed on kernel.c"):
        assert np.array_equal(system.energy(state), system.energy(state, target="numpy"))
    assert np.array_equal(system.rhs(state), system.rhs(state, target="numpy"))
    chosen = system._kernels._chosen
    assert chosen["energy", "c"] is chosen["energy", "numpy"]
    assert chosen["rhs", "c"] is not chosen["rhs", "numpy"]


@pytest.mark.parametrize("size", [1, 7, 500, 10_000])
def test_large_batches_are_computed_in_pieces(monkeypatch, size):
    """Ctrl-C is heard between pieces, called or bound; the pieces fit together."""
    monkeypatch.setattr(loader, "CHUNK", size)
    source = np.random.default_rng(0)
    state = source.normal(size=(6, 50))
    own = source.uniform(0.5, 2.0, size=(kirchhoff.PARAMETERS.size, 50))
    for parameters in (None, own):
        expected = kirchhoff.jacobian(state, parameters, target="numpy")
        assert np.array_equal(kirchhoff.jacobian(state, parameters), expected)
        out = np.zeros_like(expected)
        kirchhoff.bind("jacobian", state, parameters, out=out)()
        assert np.array_equal(out, expected)


@pytest.mark.parametrize("target", list(BUILDS))
@pytest.mark.parametrize("system", [heavy_top.system, quadrotor.system], ids=lambda s: s.name)
def test_a_ready_state_gives_what_the_checks_give(system, target):
    """The second call of each function with defaults takes the short way: the same bits."""
    source = np.random.default_rng(2)
    for function in system.functions:
        for batch in ((), (1,), (7,), (2, 3)):
            state = source.uniform(0.5, 2.0, (system.rows(function).size, *batch))
            evaluate = partial(getattr(system, function), target=target)
            if KERNEL_FUNCTIONS[function].below == "vector":  # which is in the array already
                evaluate = partial(system.evaluate, function, target=target)
            expected = evaluate(state, system.pack())
            evaluate(state)
            ready = system._kernels.ready[function, target](state)
            assert (ready is None) == (batch == (2, 3))
            assert np.array_equal(evaluate(state), expected, equal_nan=True)
            assert ready is None or np.array_equal(ready, expected, equal_nan=True)
            assert evaluate(state) is not evaluate(state)


@pytest.mark.parametrize(
    "state",
    [
        [1.0, 2.0, 3.0],
        np.ones(3, dtype=np.float32),
        np.ones(3, dtype=">f8"),
        np.ones(6)[::2],
        np.ones((4, 3)).T,
        np.broadcast_to(np.ones((3, 1)), (3, 2)),
        np.ones((3, 0)),
        np.ones((3, FEW + 1)),
        np.ones((3, 1, 2)),
        np.ones((1, 3)),
        np.ones(4),
        np.float64(1.0),
        np.ma.masked_array(np.ones(3)),
        np.ones(3).view(np.matrix),
        None,
    ],
    ids=str,
)
def test_the_short_way_is_for_ready_arrays_alone(state):
    """Whatever else is passed goes through the checks, and is converted or refused there."""
    rigid_body.rhs(np.ones(3))
    ready = rigid_body.system._kernels.ready["rhs", "c"]
    assert ready(state) is None
    assert ready(np.ones(3)).tolist() == rigid_body.rhs([1.0, 1.0, 1.0]).tolist()


def test_a_kernel_that_is_loaded_anew_is_what_the_short_way_calls(fresh):
    """Nothing of the kernel before stays."""
    system = fresh(rigid_body)
    system.rhs(np.ones(3), target="numpy")
    assert system._kernels.ready
    system.load_kernels(["numpy"])
    assert not system._kernels.ready


def test_a_short_call_keeps_no_batch_alive():
    """A first call with a large batch leaves nothing of it behind."""
    state = np.ones((6, 100_001))
    before = weakref.ref(state)
    kirchhoff.energy(state)
    del state
    gc.collect()
    assert before() is None
    assert ("energy", "c") in kirchhoff.system._kernels.ready


def test_one_call_is_short_enough_to_be_interrupted():
    """The largest piece of the largest function computes for less than a second."""
    state = np.ones((6, loader.CHUNK // (6 + 36 + 1)))
    out = np.empty((6, 6, state.shape[1]))
    call = heavy_top.bind("jacobian", state, None, out=out)
    start = process_time()
    call()
    assert process_time() - start < 1


def test_functions_beyond_the_square_root_agree_but_for_roundings(fresh, tmp_path):
    """sin, cos and exp: C and NumPy within a few units in the last place, also when bound."""
    system = pendulum(tmp_path)
    assert set(system.elementary) == {"sin", "cos", "exp"}
    state = np.random.default_rng(1).normal(size=(2, 1001))
    for function in ("rhs", "energy"):
        expected = getattr(system, function)(state, target="numpy")
        for target in ("c", "c-fast"):
            found = getattr(system, function)(state, target=target)
            assert np.abs(found - expected).max() <= 2**-50 * np.abs(expected).max()
            assert found.any()
    # by hand, at one point
    q, p, k = 0.5, -0.25, 2.0
    by_hand = [p, -k * np.sin(q) - np.exp(-q * q) * p]
    assert np.abs(system.rhs([q, p], [k]) - by_hand).max() < 1e-15


def test_agreement_is_strict_where_bits_are_promised():
    """One last bit, one NaN or one infinity in the wrong place is a difference."""
    exact = np.array([1.0, np.nan, np.inf, 0.0])
    for row, value in enumerate((np.nextafter(1.0, 2.0), 1.0, -np.inf, np.nan)):
        spoiled = exact.copy()
        spoiled[row] = value
        assert not loader._agree(spoiled, exact, exact=True)
        assert loader._agree(spoiled, exact, exact=False) == (row == 0)
    assert loader._agree(exact.copy(), exact, exact=True)
    assert loader._agree(exact.copy(), exact, exact=False)


def test_a_kernel_that_was_verified_says_nothing(fresh):
    """The ordinary way is silent."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fresh(rigid_body).rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0]).tolist() == [
            -1.5,
            2.25,
            -1.0,
        ]


@pytest.mark.parametrize(
    ("good", "bad", "message"),
    [
        ("import math\n", "import math (\n", "cannot be loaded: SyntaxError"),
        ("import math\n", "import no_such_module\n", "cannot be loaded: ModuleNotFoundError"),
        ("ID = ", "NAME = ", "cannot be loaded: AttributeError.*ID"),
        ("def rhs(", "def other(", "has no function rhs"),
        ("out = np.empty(shape + batch)", "out = missing", "does not run: rhs: NameError"),
    ],
)
def test_a_broken_numpy_kernel_is_not_the_fault_of_the_compiler(fresh, good, bad, message):
    """A first call of C compares with kernel.py: what is wrong with that file is said of it."""
    system = fresh(rigid_body)
    path = system.folder / "kernel.py"
    text = path.read_text()
    assert good in text
    path.write_text(text.replace(good, bad))
    with pytest.raises(OutputError, match=rf"kernel\.py {message}.*Run `coadjoint regenerate`"):
        system.rhs([1.0, 2.0, 3.0])  # a CompilerWarning would be an error
