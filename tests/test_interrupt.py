"""Ctrl-C: a run ends at once, with its children and the compilers that these have started."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.processes import wait_until_gone
from tests.specs import RIGID_BODY

#: A compiler that answers, notes that it was started, takes its time, and notes its end.
SLOW = """#!/bin/sh
if [ "$1" = --version ]; then echo "slow 1.0"; exit 0; fi
echo $$ >> {log}
sleep 20
echo end >> {log}.end
"""
LOAD = """
import sys, coadjoint
try:
    coadjoint.load(sys.argv[1])
except KeyboardInterrupt:
    sys.exit(130)
"""
REGENERATE = (sys.executable, "-P", "-m", "coadjoint.cli", "regenerate", "--jobs", "2")


@pytest.fixture
def project(tmp_path):
    """Two systems, a compiler that is slow, and a cache of their own."""
    (tmp_path / "derivations").mkdir()
    for name in ("first", "second"):
        (tmp_path / "derivations" / f"{name}.toml").write_text(RIGID_BODY)
    compiler = tmp_path / "slow"
    compiler.write_text(SLOW.format(log=tmp_path / "log"))
    compiler.chmod(0o700)
    return tmp_path


def compilers(folder):
    """The compilers that were started."""
    log = folder / "log"
    return [int(line) for line in log.read_text().split()] if log.exists() else []


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (REGENERATE, 2),
        ((sys.executable, "-c", LOAD, "derivations/first.toml"), 1),
    ],
    ids=["regenerate", "load"],
)
def test_an_interrupt_ends_children_and_compilers(project, command, expected):
    """The run ends with what it had started; were it to wait, a compiler would come to its end."""
    settings = {"CC": str(project / "slow"), "COADJOINT_CACHE": str(project / "cache")}
    with subprocess.Popen(
        command, cwd=project, env={**os.environ, **settings}, stderr=subprocess.PIPE, text=True
    ) as run:
        while len(compilers(project)) < expected and run.poll() is None:
            time.sleep(0.05)
        run.send_signal(signal.SIGINT)
        _, errors = run.communicate()
    assert run.returncode == 130, errors
    assert "Traceback" not in errors
    started = compilers(project)
    assert len(started) >= expected
    for process in started:
        wait_until_gone(process)
    assert not (project / "log.end").exists()
