"""Bounded children: a function of this package run in a process that can be killed.

Comes in: the name of a function and a JSON value. Goes out: its JSON result, or the error that it
raised, as in this process. Processor time and memory are limited, since no static limit on a spec
keeps every computation short; time by the clock only so that nothing waits without end. A child
dies with its parent, and with a child dies what it started.
Read next: `coadjoint.sandbox_child`, the other side.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock, Timer
from typing import IO, Any

from coadjoint.budget import VARIABLE
from coadjoint.ending import kill
from coadjoint.errors import ResourceError, from_record, system_error
from coadjoint.limits import COMPILE_WALL_SECONDS, WALL_FACTOR
from coadjoint.sandbox_child import find_processor_limit

#: Called with stage, number of stages done, number of stages.
Progress = Callable[[str, int, int], None]

_ROOT = str(Path(__file__).resolve().parents[1])
# -I keeps the working folder and the environment out; the package itself may stand outside
# site-packages, in a checkout, so its place is handed over.
_BOOT = (
    "import sys; sys.path.insert(0, sys.argv[1]); "
    "from coadjoint import sandbox_child; sandbox_child.serve()"
)


@dataclass
class _Child:
    """A child that runs or waits for a request.

    Attributes:
        process: It.
        errors: The file of what it complains of.
        used: Processor time of its former requests, seconds.
    """

    process: subprocess.Popen[str]
    errors: IO[bytes]
    used: float = 0.0

    def close(self) -> None:
        """End it and whatever it started, at the latest now."""
        kill(self.process)
        with self.errors, self.process, suppress(BrokenPipeError):
            assert self.process.stdin is not None
            self.process.stdin.close()


class Children:
    """The children of one task: ended together, and one after the other for its requests.

    A child that has answered without an error waits for another request, so that what it has
    imported is there; one that is lost is lost for the request that it worked on alone.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._waiting: list[_Child] = []
        self._stopped = False

    def take(self) -> _Child | None:
        """One that waits, if there is one."""
        with self._lock:
            while self._waiting:
                child = self._waiting.pop()
                if child.process.poll() is None:
                    return child
                child.close()
        return None

    def keep(self, child: _Child) -> None:
        """Let one wait for another request."""
        with self._lock:
            if not self._stopped:
                return self._waiting.append(child)
        return child.close()

    def add(self, process: subprocess.Popen[str]) -> None:
        """Note a child that works; one that comes after the end of the task is ended at once."""
        with self._lock:
            self._running.add(process)
            stopped = self._stopped
        if stopped:
            kill(process)

    def remove(self, process: subprocess.Popen[str]) -> None:
        """Forget a child that works no more."""
        with self._lock:
            self._running.discard(process)

    def stop(self) -> None:
        """End every child and what it started, now and later."""
        with self._lock:
            self._stopped = True
            running, waiting = list(self._running), self._waiting
            self._waiting = []
        for process in running:
            kill(process)
        for child in waiting:
            child.close()


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
        children: The children of one task, of which one that waits serves the request.
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
    request |= {"subject": subject, "again": children is not None}
    task = _Task(
        subject,
        find_processor_limit(seconds),
        WALL_FACTOR * seconds + COMPILE_WALL_SECONDS if wall is None else wall,
        memory,
    )

    def note(stage: str, done: int, total: int) -> None:
        task.stage = stage
        on_progress(stage, done, total)

    noted = children or Children()
    try:
        child = noted.take() or _start()
    except OSError as error:
        refused = system_error(error)
        if refused is None:
            raise
        raise refused from error
    with ExitStack() as stack:
        stack.callback(child.close)
        last = _follow(task, child, request, note, noted)
        if last is None:
            child.errors.seek(0)
            raise task.explain_loss(child.process.returncode, child.errors.read())
        if last["again"]:
            child.used = last["again"]
            stack.pop_all()
            noted.keep(child)
    if "error" in last:
        raise from_record(last["error"])
    return last["result"]


def _follow(
    task: _Task, child: _Child, request: dict[str, Any], note: Progress, noted: Children
) -> dict[str, Any] | None:
    """Have a child do its work; its final message, or none where it is lost."""
    noted.add(child.process)

    def expire() -> None:
        task.expired = True
        kill(child.process)

    timer = Timer(task.wall, expire)
    timer.daemon = True
    timer.start()
    try:
        last = _converse(child.process, request, note)
        if last is None or not last["again"]:
            task.used = _reap(child.process) - child.used
    finally:
        timer.cancel()
        noted.remove(child.process)
    return last


def _start() -> _Child:
    """A child that waits for its request."""
    errors = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the child)
    try:
        process = subprocess.Popen(
            [sys.executable, "-I", *_bytecode(), "-c", _BOOT, _ROOT, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            start_new_session=True,
            # One thread: each pool of a numerical library reserves memory of the child's limit.
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )
    except BaseException:
        errors.close()
        raise
    return _Child(process, errors)


def _bytecode() -> list[str]:
    """Options of Python: under a limit of file sizes it would leave torn bytecode."""
    return [] if resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY else ["-B"]


def _converse(
    process: subprocess.Popen[str], request: dict[str, Any], on_progress: Progress
) -> dict[str, Any] | None:
    """Send the request, pass progress on, and return the final message, if one comes."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
    except BrokenPipeError:
        return None
    for line in process.stdout:
        if not line.endswith("\n"):  # killed in the middle of a message
            return None
        message: dict[str, Any] = json.loads(line)
        if "progress" not in message:
            return message
        on_progress(*message["progress"])
    return None


def _reap(process: subprocess.Popen[str]) -> float:
    """Wait for the end of a child; processor time that it and what it waited for have used."""
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
