"""Systems and Solutions travel between processes: by reference, or clearly not at all."""

from __future__ import annotations

import copy
import gc
import multiprocessing
import pickle
import shutil
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve import references
from coadjoint.solve.folders import load_folder
from coadjoint.solve.references import find_system, refer_to
from coadjoint.systems import heavy_top
from tests.rolling import FOLLOWED_SLEIGH, built

PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
START = [1.0, 2.0, 3.0, 0.0, 0.0, 1.0]


@pytest.fixture
def sleigh(tmp_path):
    """A System of a folder of its own, that of no package."""
    folder = tmp_path / "sleigh"
    shutil.copytree(built(FOLLOWED_SLEIGH).folder, folder)
    return load_folder(folder)


@pytest.fixture(scope="module")
def motion():
    """A short run of the heavy top."""
    return heavy_top.simulate(START, (0, 1), samples=5, target="numpy")


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_pickled_system_is_the_same_object(protocol, sleigh):
    """In one process a reference finds the System itself, of a package or of a folder."""
    for system in (heavy_top.system, sleigh):
        assert pickle.loads(pickle.dumps(system, protocol)) is system
        assert pickle.loads(pickle.dumps(system.rhs, protocol)).__self__ is system


def test_a_system_is_named_by_its_package_or_its_folder(sleigh):
    """A package by its module, a folder by its path, and both with their id."""
    assert refer_to(heavy_top.system)[:2] == ("heavy_top", "coadjoint.systems.heavy_top")
    assert refer_to(sleigh) == ("sample", "", str(sleigh.folder), sleigh.id)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_pickled_solution_has_the_same_bits(protocol, motion):
    """Arrays by value, the System by reference, and nothing that can be computed again."""
    motion.drift  # noqa: B018  (which keeps what it computed)
    found = pickle.loads(pickle.dumps(motion, protocol))
    assert found.system is heavy_top.system
    assert not {"drift", "observables"} & vars(found).keys()
    for name in ("time", "state", "parameters"):
        assert getattr(found, name).tobytes() == getattr(motion, name).tobytes()
    assert (found.status, found.message, found.settings) == ("OK", "", motion.settings)
    assert found.drift == motion.drift


def test_copies_share_the_system_and_nothing_else(motion):
    """A deep copy has arrays of its own."""
    found = copy.deepcopy(motion)
    assert found.system is motion.system
    found.state[:] = 0
    assert motion.state[0, 0] == 1
    assert copy.copy(motion.system) is copy.deepcopy(motion.system) is motion.system


def test_quantities_are_pickled_without_what_was_packed():
    """The read-only array of defaults is made again, and nobody can write into it."""
    heavy_top.rhs(START, target="numpy")
    found = pickle.loads(pickle.dumps(heavy_top.PARAMETERS))
    assert found.packed is None
    assert dict(found) == dict(heavy_top.PARAMETERS)


def test_another_process_computes_the_same(motion, sleigh):
    """Functions go to a spawned process and Solutions come back, of packages and of folders."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        again = pool.apply(heavy_top.simulate, (START, (0, 1)), {"samples": 5, "target": "numpy"})
        rates = pool.apply(sleigh.rhs, ([1.0, 2.0],), {"target": "numpy"})
        with pytest.raises(KernelArgumentError, match="'Pj' is not one of"):  # errors travel, too
            pool.apply(heavy_top.rhs, ({"Pj": 1},), {"target": "numpy"})
    assert again.state.tobytes() == motion.state.tobytes()
    assert again.system is heavy_top.system
    np.testing.assert_array_equal(rates, sleigh.rhs([1.0, 2.0], target="numpy"))


@pytest.mark.parametrize("way", ["fork", "spawn", "forkserver"])
def test_members_are_shared_among_processes(way):
    """Solutions of parts of a batch have the bits of the whole, also after threads have run."""
    state = np.random.default_rng(2).normal(size=(6, 24))
    whole = heavy_top.simulate(state, (0, 2), samples=3, threads=2)
    with warnings.catch_warnings(), multiprocessing.get_context(way).Pool(2) as pool:
        warnings.simplefilter("ignore", DeprecationWarning)  # a fork where there were threads
        calls = [(state[:, n : n + 8], (0, 2)) for n in (0, 8, 16)]
        given = {"samples": 3, "threads": 2}
        running = [pool.apply_async(heavy_top.simulate, call, given) for call in calls]
        parts = [each.get(timeout=240) for each in running]
    assert np.array_equal(np.concatenate([part.state for part in parts], axis=1), whole.state)
    assert np.array_equal(np.concatenate([part.steps for part in parts]), whole.steps)
    for part in parts:
        assert part.system is heavy_top.system
        assert (part.status == "OK").all()
        assert part.member(7).final == {n: v[7] for n, v in part.final.items()}


def test_joblib_runs_simulations(motion):
    """In worker processes, which pickle by value what they can, as those of dask do."""
    joblib = pytest.importorskip("joblib", reason="joblib is not installed")
    call = joblib.delayed(heavy_top.simulate)
    given = {"samples": 5, "target": "numpy"}
    found = joblib.Parallel(2)(call(START, (0, 1), **given) for _ in range(2))
    assert [each.state.tobytes() for each in found] == [motion.state.tobytes()] * 2


def test_closures_travel_by_cloudpickle(sleigh):
    """Dask and joblib send functions of a script so: systems within them stay references."""
    cloudpickle = pytest.importorskip("cloudpickle", reason="it comes with joblib")
    rates = sleigh.rhs([1.0, 2.0], target="numpy")

    def ask():
        return sleigh.rhs([1.0, 2.0], target="numpy")

    sent = cloudpickle.dumps(ask)
    assert len(sent) < 4000
    assert np.array_equal(pickle.loads(sent)(), rates)


def test_a_folder_that_is_gone_is_named(sleigh):
    """Before pickling, and in another process after it."""
    reference, folder = refer_to(sleigh), sleigh.folder
    shutil.rmtree(folder)
    with pytest.raises(OutputError, match=f"'sample' cannot be found: {folder} is gone"):
        pickle.dumps(sleigh)
    references._found.clear()  # as in another process
    with pytest.raises(OutputError, match=r"is gone\. Load its spec again on this machine"):
        find_system(*reference)


def test_a_folder_with_another_id_is_refused(sleigh):
    """A spec that has changed since is another system."""
    reference, text = refer_to(sleigh), sleigh.folder / "__init__.py"
    text.write_text(text.read_text().replace(sleigh.id, "0123456789abcdef"))
    with pytest.raises(OutputError, match=r"has changed: .* has the id another one; expected"):
        pickle.dumps(sleigh)
    references._found.clear()
    with pytest.raises(OutputError, match=f"has the id 0123456789abcdef; expected {sleigh.id}"):
        find_system(*reference)


def test_a_module_that_is_missing_or_other_is_refused(monkeypatch):
    """What cannot be imported, what holds no system, and another id."""
    name, module, folder, identity = refer_to(heavy_top.system)
    with pytest.raises(OutputError, match=r"the module nowhere\.top, which cannot be imported"):
        find_system(name, "nowhere.top", folder, identity)
    with pytest.raises(OutputError, match="the module json holds no system"):
        find_system(name, "json", folder, identity)
    with pytest.raises(OutputError, match=f"has the id {identity}; expected 00"):
        find_system(name, module, folder, "00")


def test_a_system_that_nobody_holds_is_forgotten(tmp_path):
    """The table of what was found keeps no System alive."""
    folder = tmp_path / "sleigh"
    shutil.copytree(built(FOLLOWED_SLEIGH).folder, folder)
    reference = refer_to(load_folder(folder))
    gc.collect()
    assert reference not in references._found
    assert find_system(*reference).folder == Path(reference[2])
    assert "sleigh" not in sys.modules
