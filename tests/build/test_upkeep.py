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


def named(word):
    """A key as runs make them, of one word."""
    return hashlib.sha256(word.encode()).hexdigest()


def age(path, seconds):
    """Make a file, or a folder with its files, older."""
    for each in (*path.rglob("*"), path):
        moment = time.time() - seconds
        os.utime(each, (moment, moment))


def filled(folder):
    """Three objects, the first of them the oldest."""
    for n, word in enumerate(("first", "second", "third")):
        key = named(word)
        path = store(key, word.encode() * 4000)  # four pages or more
        for each in (path, path.parent / key):
            age(each, 3000 - 1000 * n)
    return folder


def test_what_was_not_used_for_longest_goes_first(folder):
    """Within the bound nothing goes; beyond it the oldest, until the rest fits."""
    filled(folder)
    evict(folder)
    assert all(fetch(named(word)) for word in ("first", "second", "third"))
    filled(folder)
    evict(folder, 14 * PAGE)
    assert fetch(named("first")) is None
    assert fetch(named("second"))
    assert fetch(named("third"))
    evict(folder, 0)
    assert not [path for path in (folder / "kernels").iterdir() if path.is_file()]


def test_what_is_used_stays(folder):
    """Fetching an object makes it young."""
    filled(folder)
    fetch(named("first"))
    evict(folder, 10 * PAGE)
    assert fetch(named("first"))
    assert fetch(named("second")) is None


def test_a_store_keeps_the_bound(folder, monkeypatch):
    """New objects may drive out old ones."""
    monkeypatch.setattr("coadjoint.build.cache.evict", lambda cache: evict(cache, 12 * PAGE))
    monkeypatch.setattr("coadjoint.build.cache.UNSEEN", 0)
    for n in range(8):
        path = store(named(f"key{n}"), bytes([n]) * (4 * PAGE))
        for each in (path, path.parent / named(f"key{n}")):
            age(each, 100 - n)
    total = sum(path.stat().st_size for path in folder.rglob("*.so"))
    assert 4 * PAGE <= total <= 12 * PAGE
    assert fetch(named("key7"))
    assert fetch(named("key0")) is None


def test_systems_go_whole_and_not_while_they_may_be_read(folder):
    """A system of one's own stays for a day, then goes with all its files."""
    young, old = (folder / "systems" / named(word)[:16] for word in ("young", "old"))
    for place, seconds in ((young, 0), (old, 2 * IN_USE)):
        system = place / "body"
        system.mkdir(parents=True)
        (system / "kernel.c").write_text("x" * 20_000)
        age(place, seconds)
    evict(folder, PAGE)
    assert not old.exists()
    assert (young / "body" / "kernel.c").is_file()


def test_what_no_run_made_stays(folder):
    """Where a cache is put into a folder with files of somebody, these neither count nor go."""
    filled(folder)
    own = [folder / each for each in ("kernels/notes.txt", "systems/mine/data", "verified/a.json")]
    for path in own:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(bytes(20 * PAGE))
        age(path, 2 * IN_USE)
    evict(folder, 14 * PAGE)
    assert fetch(named("third"))
    evict(folder, 0)
    assert fetch(named("third")) is None
    assert all(path.is_file() for path in own)
    assert find_problems(folder) == []


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
    (kernels / named("key")).mkdir()
    litter = folder / "work" / "coadjoint-work-0123"
    litter.mkdir()
    monkeypatch.setattr("coadjoint.build.upkeep.CACHE_BYTES", PAGE)
    found = "\n".join(cache_problems())
    assert f"{damaged} is damaged" in found
    assert f"{kernels / named('key')} is not a file" in found
    assert f"{litter} was left behind by a killed run" in found
    assert "more than its bound" in found
    assert len(found.splitlines()) == 4
    assert litter.is_dir()  # nothing was changed


def test_a_cache_that_is_refused_does_not_heal(folder, monkeypatch):
    """Others may write, or there is no home at all: nothing that would be mended by itself."""
    filled(folder)
    (folder / "kernels" / named("key")).mkdir()
    assert len(cache_problems()) == 1
    folder.chmod(0o777)
    assert cache_problems() == []
    monkeypatch.setattr("coadjoint.build.cache.chosen_folder", lambda: None)
    assert cache_problems() == []


def test_the_bound_is_that_of_the_limits(folder):
    """Sizes are told in MiB; a cache of some kilobytes is within."""
    assert CACHE_BYTES == 256 * 2**20
    assert find_problems(filled(folder)) == []


def test_the_bound_is_looked_at_once_for_many_small_objects(folder, monkeypatch):
    """By the first object of a process, and then after so many bytes."""
    looks = []
    monkeypatch.setattr("coadjoint.build.cache.evict", looks.append)
    monkeypatch.setattr("coadjoint.build.cache.UNSEEN", 100)
    monkeypatch.setattr("coadjoint.build.cache._unseen", [100])
    counts = []
    for n in range(6):
        store(named(f"key{n}"), bytes([n]) * 40)
        counts.append(len(looks))
    assert counts == [1, 1, 1, 2, 2, 2]
