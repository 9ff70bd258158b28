"""The warden: runs a program for as long as somebody waits for it. A script, not for import.

Comes in: ``warden.py MEMORY SECONDS PROGRAM ARGUMENT...``, and as standard input a pipe that the
caller keeps open and never writes to. Goes out: the exit status of the program, 128 plus the number
of a signal. When the pipe ends, because the caller was killed, everything that was started here is
killed, too: no compiler outlives the run that asked for it. It starts in ten milliseconds, so it
imports next to nothing. Read next: `coadjoint.build.processes`, which calls it.
"""

from __future__ import annotations

import os
import resource
import select
import sys

_KILL = 9  # SIGKILL on every system; the module `signal` takes longer to load than all of this
#: Seconds between two looks, the first and the longest: most programs end soon or not at once.
_FIRST, _LONGEST = 0.001, 0.05


def main(memory: int, seconds: int, command: list[str]) -> int:
    """Run a command within limits; its exit status."""
    _limit(resource.RLIMIT_AS, memory)
    _limit(resource.RLIMIT_CPU, seconds, beyond=5)  # first a signal that says why, then the end
    _limit(resource.RLIMIT_CORE, 0)
    nothing = [(os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0)]
    try:
        child = os.posix_spawn(command[0], command, os.environ, file_actions=nothing)
    except (OSError, MemoryError) as error:
        print(f"{command[0]} could not be started: {error}", file=sys.stderr)
        return 127
    pause = _FIRST
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
            return code if code >= 0 else 128 - code
        if select.select([0], [], [], pause)[0]:
            os.killpg(0, _KILL)  # the group of this process: it was made for it
        pause = min(2 * pause, _LONGEST)


def _limit(kind: int, value: int, beyond: int = 0) -> None:
    """Lower a limit of this process, never above what it has."""
    _, most = resource.getrlimit(kind)
    last = value + beyond
    if most != resource.RLIM_INFINITY:
        value, last = min(value, most), min(last, most)
    resource.setrlimit(kind, (value, last))


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]))
