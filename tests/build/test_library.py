"""The library: right ids, keys of all that matters, objects that are whole and of no use."""

import errno
import hashlib
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from coadjoint.build import library
from coadjoint.build.cache import fetch, store
from coadjoint.build.compiler import find_compiler
from coadjoint.build.library import Library, load_library
from coadjoint.build.source import one_function
from coadjoint.errors import CompilerError, OutputError
from coadjoint.systems import rigid_body

BODY = rigid_body.system
SOURCES = {file: (BODY.folder / file).read_bytes() for file in ("kernel.c", "kernel.h")}


@pytest.fixture
def cache(monkeypatch, tmp_path):
    """An empty cache."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def load():
    """The exact library of the rigid body, not compared with anything."""
    return load_library(BODY.folder, BODY.name, BODY.id, "exact", lambda _: None)


def test_a_bound_call_computes_what_the_function_does(cache):
    """Arguments packed once, all or all but members, state, parameters and result."""
    state, parameters = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 4.0])
    bound, two = np.zeros(3), np.zeros((3, 2))
    arguments = (1, state.ctypes.data, 1, parameters.ctypes.data, 0, bound.ctypes.data, 1)
    load().bind("rhs", *arguments)()
    both = np.outer(state, [1.0, 2.0])
    load().bind_at("rhs", *arguments)(2, both.ctypes.data, None, two.ctypes.data)
    # dPi1/dt = (1/I3 - 1/I2) Pi2 Pi3 and cyclic, exact in these numbers
    assert bound.tolist() == [-1.5, 2.25, -1.0]
    assert two.tolist() == [[-1.5, -6.0], [2.25, 9.0], [-1.0, -4.0]]
    other = np.array([2.0, 4.0, 8.0])  # twice as heavy, half as fast
    load().bind_at("rhs", *arguments)(2, both.ctypes.data, other.ctypes.data, two.ctypes.data)
    assert two.tolist() == [[-0.75, -3.0], [1.125, 4.5], [-0.5, -2.0]]


def test_an_object_of_another_run_is_refused(cache):
    """Both ids are in the message."""
    with pytest.raises(CompilerError, match=f"carries the id b?'{BODY.id}'.*expected 'f{{16}}'"):
        load_library(BODY.folder, BODY.name, "f" * 16, "exact", lambda _: None)


def test_an_object_of_another_system_is_refused(cache):
    """It lacks the symbols."""
    load()
    (path,) = cache.rglob("*.so")
    with pytest.raises(CompilerError, match=r"kernel of other cannot be loaded.*other_id"):
        Library(path, "other", BODY.id, "exact")


def test_an_object_of_another_build_is_refused_and_replaced(cache):
    """It says which build it is; the fast one under the key of the exact one is compiled anew."""
    fast = load_library(BODY.folder, BODY.name, BODY.id, "fast", lambda _: None)
    assert fast.source == hashlib.sha256(SOURCES["kernel.c"]).hexdigest()
    compiler = find_compiler()
    path = fetch(library.find_key(compiler, SOURCES, "fast"))
    with pytest.raises(CompilerError, match="carries the build 'fast'; expected 'exact'"):
        Library(path, BODY.name, BODY.id, "exact")
    exact = library.find_key(compiler, SOURCES, "exact")
    store(exact, path.read_bytes())
    assert isinstance(load(), Library)
    assert fetch(exact) != path
    Library(fetch(exact), BODY.name, BODY.id, "exact")


def test_a_function_that_is_not_there_is_named(cache):
    """Neither an AttributeError nor a crash."""
    with pytest.raises(CompilerError, match="has no function nothing"):
        load().bind("nothing", *[0] * 7)


@pytest.mark.skipif(sys.platform != "linux", reason="an option of ELF linkers")
def test_all_symbols_are_bound_when_a_library_is_loaded(cache):
    """The object says so itself (DF_BIND_NOW), whoever loads it."""
    load()
    readelf = shutil.which("readelf")
    if readelf is None:
        pytest.skip("no readelf on this machine")
    (path,) = cache.rglob("*.so")
    found = subprocess.run([readelf, "-d", path], capture_output=True, text=True, check=True)
    assert "BIND_NOW" in found.stdout


def test_a_folder_without_a_kernel_is_named(cache, tmp_path):
    """What is missing is in the message, with what to do."""
    with pytest.raises(OutputError, match=r"kernel\.c cannot be read: No such file"):
        load_library(tmp_path, BODY.name, BODY.id, "exact", lambda _: None)


def test_the_key_covers_all_that_an_object_depends_on(monkeypatch):
    """Source, header, build, version, engine and processor: each change is another key."""
    compiler = find_compiler()
    keys = [
        library.find_key(compiler, SOURCES, "exact"),
        library.find_key(compiler, SOURCES | {"kernel.c": b"/* changed */"}, "exact"),
        library.find_key(compiler, SOURCES | {"kernel.h": b"/* changed */"}, "exact"),
        library.find_key(compiler, SOURCES, "fast"),
        library.find_key(replace(compiler, version="another"), SOURCES, "exact"),
        library.find_key(replace(compiler, command=("/bin/true",)), SOURCES, "exact"),
    ]
    for name in ("__version__", "tell_processor", "SUPPORT"):
        with monkeypatch.context() as patch:
            patch.setattr(
                library, name, (lambda: "another") if name == "tell_processor" else "another"
            )
            keys.append(library.find_key(compiler, SOURCES, "exact"))
    assert len(set(keys)) == len(keys) == 9
    assert library.find_key(compiler, SOURCES, "exact") == keys[0]


def test_a_whole_object_that_does_not_load_is_compiled_anew(cache):
    """As after an update of the system: the hash is right, the object of no use."""
    key = library.find_key(find_compiler(), SOURCES, "exact")
    bad = store(key, b"\x7fELF and nothing that the loader would take")
    assert fetch(key) == bad
    assert isinstance(load(), Library)
    assert fetch(key) != bad


def test_a_kernel_that_fails_its_comparison_is_not_kept(cache):
    """What the hook raises is raised, and nothing is cached."""

    def refuse(_):
        raise CompilerError("it differs")

    with pytest.raises(CompilerError, match="it differs"):
        load_library(BODY.folder, BODY.name, BODY.id, "exact", refuse)
    assert not list(cache.rglob("*.so"))


def test_builders_at_one_time_do_not_disturb_one_another(cache):
    """Six processes on an empty cache: all right, no litter, one object served afterwards."""
    script = (
        "from coadjoint.systems import rigid_body\n"
        "print(rigid_body.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0]).tolist())"
    )
    started = [
        subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        for _ in range(6)
    ]
    answers = [process.communicate()[0].strip() for process in started]
    assert answers == ["[-1.5, 2.25, -1.0]"] * 6
    assert not list((cache / "work").iterdir())
    assert fetch(library.find_key(find_compiler(), SOURCES, "exact", one_function("rhs")))


@pytest.mark.parametrize(
    ("number", "said"), [(errno.EMFILE, "ulimit -n"), (errno.ENOENT, "Run `coadjoint regenerate`")]
)
def test_a_source_that_cannot_be_opened_says_what_helps(number, said, tmp_path, monkeypatch):
    """A limit of the session has its remedy; anything else is a folder to generate again."""

    def refuse(self):
        raise OSError(number, os.strerror(number), str(self))

    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(OutputError, match=said):
        load_library(tmp_path, "body", "0", "exact", lambda _: None)
