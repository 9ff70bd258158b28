"""Processes: compilers run within limits, and end with whoever waits for them.

Comes in: a command, and the folder where it works. Goes out: its status and what it said. Compilers
end at once on Ctrl-C, and when this process is killed (`coadjoint.build.warden`).
"""

from __future__ import annotations

import errno
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from coadjoint.build import warden
from coadjoint.errors import CompilerError, errno_of, remedy_for
from coadjoint.limits import COMPILE_BYTES, COMPILE_SECONDS, COMPILE_WALL_SECONDS

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

ANOTHER = "Set CC to another compiler."
#: What to do where one takes too long.
SMALLER = (
    "Long texts take long: a system with fewer coupled variables, members or observables has "
    "shorter ones. Where the text is short, the compiler hangs: set CC to another one."
)
#: What a driver says of a program that ran out of processor time.
_OUT_OF_TIME = "CPU time limit exceeded"


@contextmanager
def compilers() -> Iterator[ThreadPoolExecutor]:
    """Threads in which compilers are waited for; Ctrl-C ends what runs, and the wait with it."""
    from concurrent.futures import ThreadPoolExecutor  # nothing waits where all is compiled

    pool = ThreadPoolExecutor()
    with _lock:
        _pools.add(pool)
    try:
        yield pool
    except Exception:
        pool.shutdown(cancel_futures=True)
        raise
    except BaseException:  # Ctrl-C
        _stop()
        pool.shutdown(cancel_futures=True)
        raise
    finally:
        pool.shutdown()
        with _lock:
            _pools.discard(pool)
            _stopped.intersection_update(_pools)


#: Compilers that run, pools that are in use, and those of them that were interrupted.
_running: set[subprocess.Popen[bytes]] = set()
_pools: set[ThreadPoolExecutor] = set()
_stopped: set[ThreadPoolExecutor] = set()
_lock = Lock()


def _stop() -> None:
    """End every compiler of this process; none starts again until the pools have ended."""
    with _lock:
        _stopped.update(_pools)
        for process in _running:
            _kill(process)


def run_program(
    command: tuple[str, ...],
    folder: Path,
    seconds: int = COMPILE_SECONDS,
    wall_seconds: int = COMPILE_WALL_SECONDS,
) -> tuple[int, str]:
    """Run a program in a folder within limits; status and output, standard error included.

    Args:
        command: Its absolute path and its arguments.
        folder: Where it works.
        seconds: Limit of processor time.
        wall_seconds: Limit of wall time, for programs that hang.

    Raises:
        CompilerError: It took too long, was interrupted, or could not be started.
    """
    kept = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
    limits = (str(COMPILE_BYTES), str(seconds))
    ours, theirs = -1, -1
    try:
        theirs, ours = os.pipe()
        with _lock:
            if _stopped:
                raise _interruption_error(command)
            process = subprocess.Popen(
                (sys.executable, "-I", "-S", warden.__file__, *limits, *command),
                cwd=folder,
                env={**kept, "LC_ALL": "C", "TMPDIR": str(folder)},
                stdin=theirs,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            _running.add(process)
        try:
            output = process.communicate(timeout=wall_seconds)[0].decode(errors="replace")
        except subprocess.TimeoutExpired as error:
            said = (error.output or b"").decode(errors="replace")
            advice = remedy_for(said) or SMALLER
            raise _timeout_error(command, folder, wall_seconds, "", advice) from None
        finally:
            with _lock:
                _running.discard(process)
            _kill_group(process)
        if _stopped:
            raise _interruption_error(command)
    except OSError as error:
        raise CompilerError(
            f"{command[0]} could not be started: {error.strerror}. {remedy_for(error) or ANOTHER}",
            found=command[0],
        ) from error
    finally:
        for end in (ours, theirs):
            if end >= 0:
                os.close(end)
    if process.returncode == 128 + signal.SIGXCPU or _OUT_OF_TIME in output:
        most = resource.getrlimit(resource.RLIMIT_CPU)[1]
        kind, advice = " of processor time", SMALLER
        if 0 <= most < seconds:  # RLIM_INFINITY is -1 on some systems
            seconds, advice = most, "Raise the limit of processor time (ulimit -t)."
        raise _timeout_error(command, folder, seconds, kind, advice)
    return process.returncode, output


def with_signal(output: str, status: int) -> str:
    """What a compiler said, and the name of the signal that ended it."""
    return f"{output}\n{signal.strsignal(status - 128)}" if status > 128 else output


def advise(said: str) -> str:
    """What to do: against the limit that a compiler spoke of, else take another compiler."""
    if errno_of(said) == errno.ENOMEM:
        most = COMPILE_BYTES / 2**30
        return (
            f"{remedy_for(said)} A compiler may take {most:.3g} GiB; a smaller system needs less."
        )
    return remedy_for(said) or ANOTHER


def _timeout_error(
    command: tuple[str, ...], folder: Path, seconds: float, kind: str, advice: str
) -> CompilerError:
    """The compiler took too long, for a text whose size is told."""
    at_work = ""
    if any(each.endswith(".c") for each in command):
        given = (each for each in folder.glob("*.c") if each.name != "build.c")
        size, name = max(((each.stat().st_size, each.name) for each in given), default=(0, ""))
        # that of the system: its parts are a few lines each
        at_work = f" while it compiled {name} of {size / 1024:.0f} KiB" if name else ""
    return CompilerError(
        f"the compiler did not finish in {seconds:g} s{kind}: {command[0]} was stopped{at_work}. "
        f"{advice}",
        found=command[0],
        limit=seconds,
    )


def _interruption_error(command: tuple[str, ...]) -> CompilerError:
    return CompilerError(f"the compiler {command[0]} was interrupted.", found=command[0])


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Kill a child and everything it started; its session is its own."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


def _kill_group(process: subprocess.Popen[bytes]) -> None:
    """End a child and everything it started."""
    _kill(process)
    process.wait()
    if process.stdout is not None:
        process.stdout.close()
