"""Workplaces: gone at the end, held while in use, and swept after a kill."""

import os
import signal
import subprocess
import sys

import pytest

from coadjoint.build import workplace
from coadjoint.build.workplace import (
    PREFIX,
    keep_folder,
    list_abandoned,
    remove,
    sweep,
    work_file,
    work_folder,
)

KILLED = """
import os, sys
from pathlib import Path
from coadjoint.build.workplace import work_file, work_folder
with work_folder(Path(sys.argv[1])) as folder, work_file(Path(sys.argv[1])):
    (folder / "kernel.c").write_text("half a ker")
    os.kill(os.getpid(), 9)
"""


def test_they_are_gone_at_the_end(tmp_path):
    """A folder with what is in it, a file, also after an error."""
    with work_folder(tmp_path) as folder, work_file(tmp_path) as (path, handle):
        (folder / "inner").mkdir()
        (folder / "inner" / "file").write_text("text")
        os.write(handle, b"text")
        assert path.read_bytes() == b"text"
        assert folder.stat().st_mode & 0o777 == 0o700
    assert not list(tmp_path.iterdir())
    with pytest.raises(RuntimeError), work_folder(tmp_path):
        raise RuntimeError
    assert not list(tmp_path.iterdir())


def test_a_renamed_file_stays(tmp_path):
    """That is how a file takes its place."""
    with work_file(tmp_path) as (path, handle):
        os.write(handle, b"whole")
        path.replace(tmp_path / "object")
    assert (tmp_path / "object").read_bytes() == b"whole"


def test_what_a_killed_run_leaves_is_swept(tmp_path):
    """It is found, and removed; what this process holds and what is not ours stays."""
    status = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False).returncode
    assert status == -signal.SIGKILL
    assert len(list_abandoned(tmp_path)) == 2
    (tmp_path / "a file of the user").write_text("")
    (tmp_path / f"{PREFIX}link").symlink_to(tmp_path / "a file of the user")
    kept = keep_folder(tmp_path)
    with work_folder(tmp_path) as held:
        sweep(tmp_path)
        assert held.is_dir()
        assert list_abandoned(tmp_path) == []
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"a file of the user", f"{PREFIX}link", kept.name}
    sweep(tmp_path / "not there")


def test_a_folder_that_is_swept_before_it_is_locked_is_made_anew(monkeypatch, tmp_path):
    """Between making and locking, another run may take it for litter."""
    whole, taken = workplace._lock, []

    def swept_once(path):
        if not taken:
            taken.append(path)
            remove(path)
        return whole(path)

    monkeypatch.setattr(workplace, "_lock", swept_once)
    with work_folder(tmp_path) as folder:
        assert folder.is_dir()
        assert folder != taken[0]
    with work_file(tmp_path) as (path, _):
        assert path.is_file()
