"""Upkeep: the cache keeps within its bound, and tells what is wrong with it."""

import hashlib
import os
import time

import pytest

from coadjoint.build.cache import cache_problems, fetch, store
from coadjoint.build.upkeep import IN_USE, PAGE, evict, find_problems
from coadjoint.limits import CACHE_BYTES


@pytest.fixture
def folder(monkeypatch, tmp_path):
    """An empty cache."""
    path = tmp_path / "cache"
    monkeypatch.setenv("COADJOINT_CACHE", str(path))
    return path


def age(path, seconds):
    """Make a file, or a folder with its files, older."""
    for each in (*path.rglob("*"), path):
        moment = time.time() - seconds
        os.utime(each, (moment, moment))


def filled(folder):
    """Three objects, the first of them the oldest."""
    for n, key in enumerate(("first", "second", "third")):
        path = store(key, key.encode() * 4000)  # four pages or more
        for each in (path, path.parent / key):
            age(each, 3000 - 1000 * n)
    return folder


def test_what_was_not_used_for_longest_goes_first(folder):
    """Within the bound nothing goes; beyond it the oldest, until the rest fits."""
    filled(folder)
    evict(folder)
    assert all(fetch(key) for key in ("first", "second", "third"))
    filled(folder)
    evict(folder, 14 * PAGE)
    assert fetch("first") is None
    assert fetch("second")
    assert fetch("third")
    evict(folder, 0)
    assert not [path for path in (folder / "kernels").iterdir() if path.is_file()]


def test_what_is_used_stays(folder):
    """Fetching an object makes it young."""
    filled(folder)
    fetch("first")
    evict(folder, 10 * PAGE)
    assert fetch("first")
    assert fetch("second") is None


def test_a_store_keeps_the_bound(folder, monkeypatch):
    """Each new object may drive out old ones."""
    monkeypatch.setattr("coadjoint.build.cache.evict", lambda cache: evict(cache, 12 * PAGE))
    for n in range(8):
        path = store(f"key{n}", bytes([n]) * (4 * PAGE))
        for each in (path, path.parent / f"key{n}"):
            age(each, 100 - n)
    total = sum(path.stat().st_size for path in folder.rglob("*.so"))
    assert 4 * PAGE <= total <= 12 * PAGE
    assert fetch("key7")
    assert fetch("key0") is None


def test_systems_go_whole_and_not_while_they_may_be_read(folder):
    """A system of one's own stays for a day, then goes with all its files."""
    for name, seconds in (("young", 0), ("old", 2 * IN_USE)):
        system = folder / "systems" / name / "body"
        system.mkdir(parents=True)
        (system / "kernel.c").write_text("x" * 20_000)
        age(folder / "systems" / name, seconds)
    evict(folder, PAGE)
    assert not (folder / "systems" / "old").exists()
    assert (folder / "systems" / "young" / "body" / "kernel.c").is_file()


def test_a_whole_cache_has_no_problem(folder):
    """Neither one that is not there yet."""
    assert cache_problems() == []
    assert not folder.exists()
    filled(folder)
    assert cache_problems() == []


def test_every_state_is_told(folder, monkeypatch):
    """A damaged object, a folder in the place of one, litter, and a cache that is too large."""
    filled(folder)
    kernels = folder / "kernels"
    damaged = kernels / f"{hashlib.sha256(b'one').hexdigest()}.so"
    damaged.write_bytes(b"another")
    (kernels / "0123").mkdir()
    litter = folder / "work" / "coadjoint-work-0123"
    litter.mkdir()
    monkeypatch.setattr("coadjoint.build.upkeep.CACHE_BYTES", PAGE)
    found = "\n".join(cache_problems())
    assert f"{damaged} is damaged" in found
    assert f"{kernels / '0123'} is not a file" in found
    assert f"{litter} was left by a run that was killed" in found
    assert "more than its bound" in found
    assert len(found.splitlines()) == 4
    assert litter.is_dir()  # nothing was changed


def test_a_cache_that_is_refused_is_told(folder, monkeypatch):
    """Others may write, or there is no home at all."""
    folder.mkdir()
    folder.chmod(0o777)
    assert "others may write" in cache_problems()[0]
    monkeypatch.setattr("coadjoint.build.cache.chosen_folder", lambda: None)
    assert "no home folder" in cache_problems()[0]


def test_the_bound_is_that_of_the_limits(folder):
    """Sizes are told in MiB; a cache of some kilobytes is within."""
    assert CACHE_BYTES == 256 * 2**20
    assert find_problems(filled(folder)) == []
