"""Ending: a process killed together with everything that it started.

Comes in: a process of ours that leads a group of its own. Goes out: nothing; it and all below it
have ended. Read next: `coadjoint.sandbox`.
"""

from __future__ import annotations

import os
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path


def kill(process: subprocess.Popen[str]) -> None:
    """Kill a child and whatever it started, in sessions of their own too."""
    if process.returncode is None:
        for started in _freeze(process.pid):
            with suppress(ProcessLookupError, PermissionError):
                os.kill(started, signal.SIGKILL)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


def _freeze(ancestor: int) -> set[int]:
    """A process and all below it, stopped: what runs could start another meanwhile."""
    frozen, running = set[int](), {ancestor}
    while running:
        for each in running:
            with suppress(ProcessLookupError, PermissionError):
                os.kill(each, signal.SIGSTOP)
        frozen |= running
        for _ in range(250):  # half a second, where a kernel thread waits for a disk
            if not any(map(_is_active, frozen)):
                break
            time.sleep(0.002)
        running = set(_descendants(ancestor)) - frozen
    return frozen


def _is_active(process: int) -> bool:
    """Whether some thread of a process runs or waits, and has not stopped yet."""
    for path in Path(f"/proc/{process}/task").glob("*/stat"):
        with suppress(OSError, IndexError):
            if path.read_text(errors="replace").rpartition(")")[2].split()[0] in "RS":
                return True
    return False


def _descendants(ancestor: int) -> list[int]:
    """Processes below one, where the system shows them in /proc."""
    below: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError, ValueError, IndexError):  # it may have ended meanwhile
            parent = path.read_text(errors="replace").rpartition(")")[2].split()[1]
            below.setdefault(int(parent), []).append(int(path.parent.name))
    descendants, waiting = [], [ancestor]
    while waiting:
        children = below.get(waiting.pop(), [])
        descendants += children
        waiting += children
    return descendants
