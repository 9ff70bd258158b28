"""Versions of compilers: asked once, and again when the compiler is another one."""

import os
import stat

import pytest

from coadjoint.build import compiler, versions
from coadjoint.build.cache import cache_folder
from coadjoint.build.compiler import find_compiler
from coadjoint.build.upkeep import COMPILERS


@pytest.fixture
def fake(monkeypatch, tmp_path):
    """A compiler that notes when it is asked, and an empty cache."""
    path, log = tmp_path / "fake", tmp_path / "log"
    path.write_text(f"#!/bin/sh\necho asked >> {log}\necho fake 1.0\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("CC", str(path))
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    yield path
    compiler._find.cache_clear()


def ask():
    """The compiler as a new process finds it."""
    compiler._find.cache_clear()
    return find_compiler()


def test_a_version_is_asked_once_in_all_processes(fake):
    """The second process reads what the first one was told."""
    first = ask()
    assert (first.version, first.is_gnu) == ("fake 1.0", False)
    assert ask() == first
    assert (fake.parent / "log").read_text() == "asked\n"


def test_a_compiler_that_changed_is_asked_again(fake):
    """An update changes its file, and the version is that of the new one."""
    ask()
    fake.write_text(fake.read_text().replace("1.0", "2.0 Free Software Foundation"))
    found = ask()
    assert found.version == "fake 2.0 Free Software Foundation"
    assert found.is_gnu
    before = fake.stat()
    os.utime(fake, ns=(before.st_atime_ns, before.st_mtime_ns + 1))
    ask()
    assert (fake.parent / "log").read_text() == "asked\n" * 3


@pytest.mark.parametrize("content", ["", "{}", "[]", '{"version": 1, "is_gnu": true}', "\xff"])
def test_a_damaged_record_is_asked_for_again(fake, content):
    """Whatever stands there, the version is right, and the record is replaced."""
    ask()
    (record,) = (cache_folder() / COMPILERS).iterdir()
    record.write_text(content, encoding="latin-1")
    assert ask().version == "fake 1.0"
    assert versions.recall_version((str(fake),)) == ("fake 1.0", False)
    assert (fake.parent / "log").read_text() == "asked\n" * 2


def test_a_link_in_its_place_is_not_followed(fake, tmp_path):
    """What another file says is no version."""
    ask()
    (record,) = (cache_folder() / COMPILERS).iterdir()
    other = tmp_path / "other"
    other.write_text('{"version": "wrong", "is_gnu": true}')
    record.unlink()
    record.symlink_to(other)
    assert ask().version == "fake 1.0"


def test_a_command_without_a_file_is_not_kept(fake):
    """There is nothing by which a change could be seen."""
    versions.keep_version(("/no/such/compiler",), ("1.0", False))
    assert versions.recall_version(("/no/such/compiler",)) is None
