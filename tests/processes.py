"""Processes that tests start: what they have computed, and whether they are there.

No test may depend on the clock, since the machine may be busy with other work: what is measured is
processor time.
"""

from __future__ import annotations

import os
import time
from pathlib import Path


def _fields(process: int) -> list[str]:
    """What the system says of a process, from its state on; empty if it is gone."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []


def is_running(process: int) -> bool:
    """Whether a process runs; a zombie does not."""
    return _fields(process)[:1] not in ([], ["Z"])


def processor_seconds(process: int) -> float:
    """Processor time that a process has used so far, without what it has started."""
    user, system = _fields(process)[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def wait_until_gone(process: int) -> None:
    """Wait for the end of a process that was killed."""
    while is_running(process):
        time.sleep(0.05)


def wait_for_work(process: int, seconds: float) -> None:
    """Wait until a process has computed for some seconds, or has ended."""
    while is_running(process) and processor_seconds(process) < seconds:
        time.sleep(0.05)
