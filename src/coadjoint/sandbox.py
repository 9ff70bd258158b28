"""Bounded children: a function of this package run in a process that can be killed.

Comes in: the name of a function and a JSON value. Goes out: its JSON result, or the error that it
raised, as in this process. Processor time and memory are limited, since no static limit on a spec
keeps every computation short; time by the clock only so that nothing waits without end. Children
come from a nursery: a process that has imported what they need, which takes longer than many of
them work, and that waits for a while for the next request. They die with their parent, and with
them dies what they started.
Read next: `coadjoint.sandbox_child`, the other side.
"""

from __future__ import annotations

import atexit
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock, Timer
from typing import IO, Any, Final

from coadjoint.budget import VARIABLE
from coadjoint.ending import kill
from coadjoint.errors import ResourceError, from_record, system_error
from coadjoint.limits import COMPILE_WALL_SECONDS, WALL_FACTOR
from coadjoint.sandbox_child import OWN, find_processor_limit

#: Called with stage, number of stages done, number of stages.
Progress = Callable[[str, int, int], None]

_ROOT = str(Path(__file__).resolve().parents[1])
# -I keeps the working folder and the environment out; the package itself may stand outside
# site-packages, in a checkout, so its place is handed over.
_BOOT = (
    "import sys; sys.path.insert(0, sys.argv[1]); "
    "from coadjoint import sandbox_child; sandbox_child.serve()"
)

#: Seconds for which a nursery waits for another request.
PATIENCE: Final = 60
#: Limits of the system that children inherit.
_LIMITS = tuple(sorted({getattr(resource, each) for each in dir(resource) if "RLIMIT_" in each}))


@dataclass(eq=False)
class _Nursery:
    """A process that forks a child for each request.

    Attributes:
        process: It.
        errors: The file of what children complain of.
        surroundings: What it inherited and cannot be told; see `_find_surroundings`.
        patience: What ends it while it waits.
    """

    process: subprocess.Popen[str]
    errors: IO[bytes]
    surroundings: object
    patience: Timer | None = None

    def close(self) -> None:
        """End it and whatever it started, at the latest now."""
        kill(self.process)
        self.retire()

    def retire(self) -> None:
        """Wait for its end, which comes while it waits as soon as nobody can ask any more."""
        with self.errors, self.process, suppress(BrokenPipeError):
            assert self.process.stdin is not None
            self.process.stdin.close()


class _Waiting:
    """The nurseries of this process that have no work."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._nurseries: list[_Nursery] = []
        self._strange: list[_Nursery] = []

    def take(self, surroundings: object) -> _Nursery | None:
        """One that would not differ from a new one, if there is one."""
        with self._lock:
            found = [each for each in self._nurseries if each.surroundings == surroundings]
            for nursery in found[-1:]:
                self._nurseries.remove(nursery)
                if nursery.patience is not None:
                    nursery.patience.cancel()
                if nursery.process.poll() is None:
                    return nursery
                nursery.close()
        return None

    def keep(self, nursery: _Nursery) -> None:
        """Let one wait, for some time."""
        nursery.patience = timer = Timer(PATIENCE, self._retire, [nursery])
        timer.daemon = True
        with self._lock:
            self._nurseries.append(nursery)
        timer.start()

    def retire_all(self) -> None:
        """End them with this process."""
        for nursery in list(self._nurseries):
            self._retire(nursery)

    def _retire(self, nursery: _Nursery) -> None:
        with self._lock:
            if nursery not in self._nurseries:
                return
            self._nurseries.remove(nursery)
        if nursery.patience is not None:
            nursery.patience.cancel()
        nursery.retire()

    def disown(self) -> None:
        """Leave them to the process that this one was forked from."""
        self._lock = Lock()  # which a thread of that process may have held
        self._strange += self._nurseries  # or their finalisers would wait for them
        self._nurseries = []


_waiting = _Waiting()
atexit.register(_waiting.retire_all)
os.register_at_fork(after_in_child=_waiting.disown)


class Children:
    """The children of one task, ended together."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def add(self, process: subprocess.Popen[str]) -> None:
        """Note a nursery at work; one that comes after the end of the task is ended at once."""
        with self._lock:
            self._running.add(process)
            stopped = self._stopped
        if stopped:
            kill(process)

    def remove(self, process: subprocess.Popen[str]) -> None:
        """Forget one that works no more."""
        with self._lock:
            self._running.discard(process)

    def stop(self) -> None:
        """End every child and what it started, now and later."""
        with self._lock:
            self._stopped = True
            running = list(self._running)
        for process in running:
            kill(process)


def run_bounded(
    target: str,
    argument: Any,
    *,
    seconds: float,
    memory: int,
    on_progress: Progress = lambda *_: None,
    children: Children | None = None,
    wall: float | None = None,
    subject: str = "",
) -> Any:
    """Run ``module:function`` of this package on a JSON value in a bounded child.

    Args:
        target: A function of one argument, e.g. ``"coadjoint.regenerate:build_record"``.
        argument: A JSON value.
        seconds: Limit of processor time of the child itself; a compiler that it runs has limits of
            its own. Rounded up to whole seconds.
        memory: Limit of address space, bytes.
        on_progress: Told what the function reports through `report_progress`.
        children: The children of one task, which can be stopped together.
        wall: Limit of time by the clock; by default `WALL_FACTOR` times ``seconds``, and what a
            compiler may take.
        subject: What it is about, for messages: the path of a spec. By default the function.

    Returns:
        The function's JSON result.

    Raises:
        CoadjointError: What the function raised, the same class with the same parts.
        ResourceError: The child ran out of time or memory, or was killed.
        OutputError: The operating system refuses what the child needs, e.g. a temporary file.
        InternalError: The function raised anything else: a fault of ours.
    """
    subject = subject or target.rpartition(":")[2]
    request = {"target": target, "argument": argument, "seconds": seconds, "memory": memory}
    request |= {"subject": subject, "environment": {**os.environ}, "folder": _find_folder()}
    task = _Task(
        subject,
        find_processor_limit(seconds),
        WALL_FACTOR * seconds + COMPILE_WALL_SECONDS if wall is None else wall,
        memory,
    )

    def note(stage: str, done: int, total: int) -> None:
        task.stage = stage
        on_progress(stage, done, total)

    try:
        nursery = _waiting.take(_find_surroundings()) or _start()
    except OSError as error:
        refused = system_error(error)
        if refused is None:
            raise
        raise refused from error
    begin = nursery.errors.seek(0, os.SEEK_END)
    try:
        last, end = _follow(task, nursery, request, note, children or Children())
    except BaseException:
        nursery.close()
        raise
    if end is not None:
        task.used = end["used"]
    if last is None:
        status = nursery.process.wait() if end is None else end["status"]
        nursery.errors.seek(begin)
        errors = nursery.errors.read()
    if end is None or request["folder"] is None:
        nursery.close()
    else:
        _waiting.keep(nursery)
    if last is None:
        raise task.explain_loss(status, errors)
    if "error" in last:
        raise from_record(last["error"])
    return last["result"]


def _follow(
    task: _Task, nursery: _Nursery, request: dict[str, Any], note: Progress, noted: Children
) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Have a child do its work; its final message, and what its nursery says of its end.

    None stands for what did not come.
    """
    process = nursery.process
    noted.add(process)

    def expire() -> None:
        task.expired = True
        kill(process)

    timer = Timer(task.wall, expire)
    timer.daemon = True
    timer.start()
    try:
        found = _converse(process, request, note)
        if found[1] is None:
            task.used = _reap(process)
    finally:
        timer.cancel()
        noted.remove(process)
    return found


def _find_folder() -> str | None:
    """The working folder, or None where it is gone."""
    with suppress(OSError):
        return str(Path.cwd())
    return None


def _find_surroundings() -> object:
    """What a nursery inherits when it is started, and its children with it."""
    return _BOOT, _find_folder() is None, tuple(map(resource.getrlimit, _LIMITS))


def _start() -> _Nursery:
    """A nursery that waits for its first request."""
    errors = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the nursery)
    try:
        process = subprocess.Popen(
            [sys.executable, "-I", *_bytecode(), "-c", _BOOT, _ROOT],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            start_new_session=True,
            env={**os.environ, **OWN},
        )
    except BaseException:
        errors.close()
        raise
    return _Nursery(process, errors, _find_surroundings())


def _bytecode() -> list[str]:
    """Options of Python: under a limit of file sizes it would leave torn bytecode."""
    return [] if resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY else ["-B"]


def _converse(
    process: subprocess.Popen[str], request: dict[str, Any], on_progress: Progress
) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Send the request, pass progress on; the final message and the end, if they come."""
    assert process.stdin is not None
    assert process.stdout is not None
    last = None
    with suppress(BrokenPipeError):
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
    for line in process.stdout:
        try:
            message: dict[str, Any] = json.loads(line)
        except ValueError:  # of a child that was killed in the middle of it
            continue
        if "status" in message:
            return last, message
        if "progress" in message:
            on_progress(*message["progress"])
        else:
            last = message
    return last, None


def _reap(process: subprocess.Popen[str]) -> float:
    """Wait for the end of a nursery; processor time that it and what it waited for have used."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime


class _Task:
    """What is known of one child, to say why it was lost."""

    def __init__(self, subject: str, seconds: int, wall: float, memory: int) -> None:
        self.subject, self.seconds, self.wall, self.memory = subject, seconds, wall, memory
        self.stage, self.used, self.expired = "", 0.0, False

    def explain_loss(self, status: int, errors: bytes) -> ResourceError:
        """The error of a child that ended without a final message."""
        if status == -signal.SIGXCPU:
            message, limit = self._out_of_time(), float(self.seconds)
        elif self.expired:
            message, limit = self._out_of_patience(), self.wall
        else:
            message, limit = self._explain_end(status, errors), self.memory
        message = f"{self.subject}: {message}"
        return ResourceError(
            message, limit=limit, task=self.subject, stage=self.stage, used=self.used, status=status
        )

    @property
    def _where(self) -> str:
        return f" in the stage {self.stage!r}" if self.stage else ""

    def _out_of_time(self) -> str:
        """The limit of processor time was reached."""
        return (
            f"stopped{self._where} after {self.seconds} s of processor time, which is the limit. "
            f"Allow more with --seconds {10 * self.seconds}, in a program with "
            f"seconds={10 * self.seconds}, or with the environment variable {VARIABLE}; or "
            "simplify the spec: fewer or shorter expressions, fewer coupled variables."
        )

    def _out_of_patience(self) -> str:
        """The limit of time by the clock was reached."""
        return (
            f"stopped{self._where} after {self.wall:g} s of wall time, of which it computed "
            f"for {self.used:.1f} s. It waits for something that does not answer, or the machine "
            "is busy: try again later, or allow more with --seconds (the limit on wall time is "
            f"{WALL_FACTOR} times that), seconds=, or {VARIABLE}."
        )

    def _explain_end(self, status: int, errors: bytes) -> str:
        """A signal or an exit that was not requested here."""
        end = signal.Signals(-status).name if status < 0 else f"exit status {status}"
        tail = errors.decode(errors="replace").strip()[-400:]
        return (
            f"lost{self._where} ({end}, after {self.used:.1f} s of processor time; limit of "
            f"memory {self.memory // 2**20} MiB). Simplify the spec, or check whether something "
            f"ended the process. {tail}".rstrip()
        )
