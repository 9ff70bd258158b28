"""The cache: private, verified, and any damage is a miss."""

import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from coadjoint.build import cache
from coadjoint.build.cache import CacheWarning, cache_folder, check_private, fetch, store
from coadjoint.build.compiler import CompilerWarning
from coadjoint.errors import OutputError
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder
from coadjoint.systems import rigid_body


@pytest.fixture
def folder(monkeypatch, tmp_path):
    """An empty cache."""
    path = tmp_path / "cache"
    monkeypatch.setenv("COADJOINT_CACHE", str(path))
    return path


def body(tmp_path):
    """The rigid body, loaded as if for the first time in this process."""
    target = tmp_path / "rigid_body"
    if not target.exists():
        shutil.copytree(rigid_body.system.folder, target)
    return load_folder(target)


def test_an_object_comes_back_as_it_was_stored(folder):
    """Same bytes under the key, none under another."""
    path = store("key", b"content")
    assert fetch("key") == path
    assert path.read_bytes() == b"content"
    assert fetch("other") is None


@pytest.mark.parametrize(
    "damage",
    ["empty", "half", "flip", "gone", "link", "key", "folder", "folders"],
)
def test_every_damage_is_a_miss_and_heals(folder, damage):
    """Emptied, halved, one bit flipped, removed, a link, a folder, a garbled key; then stored."""
    path = store("key", b"content of an object")
    whole = path.read_bytes()
    match damage:
        case "empty":
            path.write_bytes(b"")
        case "half":
            path.write_bytes(whole[: len(whole) // 2])
        case "flip":
            path.write_bytes(bytes([whole[0] ^ 1]) + whole[1:])
        case "gone":
            path.unlink()
        case "link":
            path.rename(path.with_name("moved"))
            path.symlink_to(path.with_name("moved"))
        case "folder":
            path.unlink()
            (path / "inner").mkdir(parents=True)
        case "folders":
            for each in (path, path.parent / "key"):
                each.unlink()
                each.mkdir()
        case "key":
            (path.parent / "key").write_bytes(b"\xff../../etc/passwd")
    assert fetch("key") is None
    assert fetch("key") is None
    assert store("key", whole).read_bytes() == whole
    assert fetch("key") == path


@pytest.mark.parametrize("name", ["kernels", "verified", "systems", "work"])
@pytest.mark.parametrize("is_link", [False, True])
def test_what_no_run_made_is_never_removed(folder, name, is_link):
    """A file or a link in the place of a folder of the cache: refused by name, and it stays."""
    folder.mkdir(mode=0o700)
    (folder / name).symlink_to(folder / "nowhere") if is_link else (folder / name).write_text("own")
    with pytest.raises(OutputError, match=f"no run of coadjoint made '{name}', which stands in it"):
        check_private(folder)
    if name in ("kernels", "work"):
        cache._make_usable.cache_clear()
        with pytest.raises(OSError, match=name):
            cache.replace_file(folder / "kernels" / "key", b"content")
    place = folder / name
    assert place.is_symlink() if is_link else place.read_text() == "own"


def test_a_damaged_kernel_is_rebuilt(folder, tmp_path):
    """After damage the same results, from a new object."""
    state = np.array([1.0, 2.0, 3.0])
    expected = body(tmp_path).rhs(state)
    objects = list(folder.rglob("*.so"))
    assert objects
    for path in objects:
        path.write_bytes(b"damaged")
    assert np.array_equal(body(tmp_path).rhs(state), expected)
    assert all(path.read_bytes() != b"damaged" for path in folder.rglob("*.so"))


def test_a_second_load_does_not_compile(folder, tmp_path, monkeypatch):
    """The cached object serves; the compiler is not called."""
    body(tmp_path).rhs(np.ones(3))
    monkeypatch.setattr(
        "coadjoint.build.library.compile_kernel", lambda *_: pytest.fail("compiled again")
    )
    body(tmp_path).rhs(np.ones(3))


def test_the_folder_is_private(folder):
    """0700, whatever the umask."""
    assert cache_folder() == folder
    assert folder.stat().st_mode & 0o777 == 0o700


def test_a_folder_that_others_may_write_is_refused(tmp_path):
    """The mode and the remedy are in the message."""
    tmp_path.chmod(0o777)
    with pytest.raises(
        OutputError, match=r"other users may write to it \(mode 777\), run `chmod 700"
    ):
        check_private(tmp_path)


def test_a_link_in_place_of_the_folder_is_refused(tmp_path):
    """A symlink could lead anywhere."""
    (tmp_path / "real").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    with pytest.raises(OutputError, match="not a real folder"):
        check_private(tmp_path / "link")


def test_a_folder_of_another_user_is_refused(tmp_path, monkeypatch):
    """The owner is named."""
    owner = os.getuid()
    monkeypatch.setattr(cache.os, "getuid", lambda: owner + 1)
    with pytest.raises(OutputError, match=f"belongs to user {owner}"):
        check_private(tmp_path)


def test_an_unusable_cache_is_replaced_for_this_process_and_said_once(monkeypatch, tmp_path):
    """Kernels still work, in a temporary folder."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "file"))
    with pytest.warns(CacheWarning, match="COADJOINT_CACHE"):
        first = cache_folder()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache_folder() == first
    assert first.is_dir()
    shutil.rmtree(first)


def test_the_temporary_folder_ends_with_its_process(tmp_path):
    """Where the home cannot be used, kernels work and nothing is left behind."""
    (tmp_path / "file").write_text("")
    (tmp_path / "temporary").mkdir()
    script = (
        "import warnings\n"
        "from coadjoint.build.cache import cache_folder\n"
        "warnings.simplefilter('ignore')\n"
        "from coadjoint.systems import rigid_body\n"
        "print(rigid_body.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0]).tolist())\n"
        "print(len(list(cache_folder().rglob('*.so'))), cache_folder())"
    )
    found = subprocess.run(
        [sys.executable, "-c", script],
        env={
            **os.environ,
            "COADJOINT_CACHE": str(tmp_path / "file"),
            "TMPDIR": str(tmp_path / "temporary"),
        },
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    assert found[0] == "[-1.5, 2.25, -1.0]"
    assert found[1].startswith(f"1 {tmp_path / 'temporary'}")
    assert not list((tmp_path / "temporary").iterdir())


KILLED = """
import os
from coadjoint.build import cache
cache.os.fsync = lambda _: os.kill(os.getpid(), 9)
cache.store("key", b"content")
"""


def test_a_killed_writer_leaves_nothing_past_the_next_run(folder):
    """What it wrote is no object, and the next process that looks into the cache removes it."""
    assert subprocess.run([sys.executable, "-c", KILLED], check=False).returncode == -9
    assert [path for path in folder.rglob("*") if path.is_file()]
    look = "from coadjoint.build.cache import fetch; assert fetch('key') is None"
    subprocess.run([sys.executable, "-c", look], check=True)
    assert not [path for path in folder.rglob("*") if path.is_file()]


def test_without_a_home_the_cache_is_temporary(monkeypatch, tmp_path):
    """No HOME, and a user whom the system does not know: said as what it is."""

    def unknown():
        raise RuntimeError("Could not determine home directory.")

    for name in ("COADJOINT_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(Path, "home", unknown)
    cache._make_usable.cache_clear()
    with pytest.warns(
        CacheWarning, match="no home folder is set, so there is no place for the cache. Set HOME"
    ):
        found = cache_folder()
    shutil.rmtree(found)
    cache._make_usable.cache_clear()


NOWHERE = """
import resource, sys
from coadjoint.systems import rigid_body
import numpy, warnings
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    print(rigid_body.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0]).tolist())
print(*(each.message for each in said))
"""


def test_where_no_file_can_be_written_numpy_stands_in(folder):
    """A first call under a file size limit of zero: the right numbers, and why they come slowly.

    Python writes no bytecode, which it would leave torn for whoever comes next.
    """
    found = subprocess.run(
        [sys.executable, "-B", "-c", NOWHERE], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert found[0] == "[-1.5, 2.25, -1.0]"  # (1/I3 - 1/I2) Pi2 Pi3 and cyclic
    assert "cannot be compiled here" in found[1]
    assert "NumPy kernels are used" in found[1]


def test_without_any_temporary_folder_numpy_stands_in(monkeypatch, tmp_path):
    """No cache and no temporary folder: as without a compiler."""
    (tmp_path / "file").write_text("")

    def none():
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "file"))
    monkeypatch.setattr(cache.tempfile, "gettempdir", none)
    monkeypatch.setattr(kernels, "_said", set())
    system = body(tmp_path)
    with pytest.warns(CompilerWarning, match="no temporary folder can be written"):
        found = system.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
    assert found.tolist() == [-1.5, 2.25, -1.0]
    with pytest.raises(OutputError, match="No temporary folder can be written either"):
        cache_folder()


def test_a_full_disk_leaves_the_old_object(folder, monkeypatch):
    """A failing write is an error that names the folder; what was there still is."""
    store("key", b"old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cache.os, "fsync", full)
    with pytest.raises(OutputError, match="No space left on device"):
        store("key", b"new")
    monkeypatch.undo()
    monkeypatch.setenv("COADJOINT_CACHE", str(folder))
    assert fetch("key").read_bytes() == b"old"
    assert not list((folder / "work").iterdir())
