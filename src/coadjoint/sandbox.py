"""Bounded children: a function of this package run in a process that can be killed.

Comes in: the name of a function and a JSON value. Goes out: its JSON result, or the error that it
raised, as in this process. Time and memory are limited, since no static limit on a spec keeps every
computation short; a child dies with its parent.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Timer
from typing import IO, Any

from coadjoint.errors import CoadjointError, InternalError, ResourceError, from_record

#: Called with stage, number of stages done, number of stages.
Progress = Callable[[str, int, int], None]

_ROOT = str(Path(__file__).resolve().parents[1])
# -I keeps the working folder and the environment out; the package itself may stand outside
# site-packages, in a checkout, so its place is handed over.
_BOOT = (
    "import sys; sys.path.insert(0, sys.argv[1]); from coadjoint import sandbox; sandbox.child()"
)
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_channel: IO[str] | None = None


def run_bounded(
    target: str,
    argument: Any,
    *,
    seconds: float,
    memory: int,
    on_progress: Progress = lambda *_: None,
) -> Any:
    """Run ``module:function`` of this package on a JSON value in a bounded child.

    Args:
        target: A function of one argument, e.g. ``"coadjoint.regenerate:build_record"``.
        argument: A JSON value.
        seconds: Limit of wall time and of processor time.
        memory: Limit of address space, bytes.
        on_progress: Told what the function reports through `report_progress`.

    Returns:
        The function's JSON result.

    Raises:
        CoadjointError: What the function raised, the same class with the same parts.
        ResourceError: The child ran out of time or memory, or was killed.
        InternalError: The function raised anything else: a fault of ours.
    """
    request = {"target": target, "argument": argument, "seconds": seconds, "memory": memory}
    expired: list[bool] = []
    with tempfile.TemporaryFile() as errors, _started(errors) as process:

        def expire() -> None:
            expired.append(True)
            _kill(process)

        timer = Timer(seconds, expire)
        timer.daemon = True
        timer.start()
        try:
            last = _converse(process, request, on_progress)
            process.wait()
        finally:
            timer.cancel()
            _kill(process)
        if last is None:
            errors.seek(0)
            raise _lost(target, process.returncode, bool(expired), seconds, memory, errors.read())
    if "error" in last:
        raise from_record(last["error"])
    return last["result"]


def _started(errors: IO[bytes]) -> subprocess.Popen[str]:
    """The child, waiting for its request."""
    return subprocess.Popen(
        [sys.executable, "-I", "-c", _BOOT, _ROOT, str(os.getpid())],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        text=True,
        start_new_session=True,
        # One thread: each pool of a numerical library reserves memory of the child's limit.
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    )


def _converse(
    process: subprocess.Popen[str], request: dict[str, Any], on_progress: Progress
) -> dict[str, Any] | None:
    """Send the request, pass progress on, and return the final message, if one comes."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(json.dumps(request))
        process.stdin.close()
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


def _kill(process: subprocess.Popen[str]) -> None:
    """Kill a child and whatever it started; its session is its own."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def _lost(
    target: str, status: int, expired: bool, seconds: float, memory: int, errors: bytes
) -> ResourceError:
    """Why a child ended without a final message."""
    task, tail = target.rpartition(":")[2], errors.decode(errors="replace").strip()[-400:]
    if expired or status == -signal.SIGXCPU:
        return ResourceError(
            f"{task} took more than {seconds:g} s and was stopped. Simplify the spec: fewer or "
            "shorter expressions, fewer coupled variables.",
            limit=seconds,
            task=task,
        )
    found = signal.Signals(-status).name if status < 0 else f"exit status {status}"
    return ResourceError(
        f"{task} was lost ({found}; limit of memory {memory // 2**20} MiB). Simplify the spec, or "
        f"look whether something ended the process. {tail}".rstrip(),
        limit=memory,
        task=task,
        status=status,
    )


# -- in the child ---------------------------------------------------------------------------------


def report_progress(stage: str, done: int, total: int) -> None:
    """Tell the parent how far this child is; nothing happens outside a child."""
    _send({"progress": [stage, done, total]})


def child() -> None:
    """Serve one request and end; the entry point of the child process."""
    global _channel  # one channel for the one request of this process
    _die_with(int(sys.argv[2]))
    _channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what libraries print must not meet the messages
    request = json.load(sys.stdin)
    _limit(resource.RLIMIT_AS, request["memory"])
    _limit(resource.RLIMIT_CPU, int(request["seconds"]) + 1)
    _limit(resource.RLIMIT_CORE, 0)
    try:
        _send({"result": _function(request["target"])(request["argument"])})
    except CoadjointError as error:
        _send({"error": error.as_record()})
    except MemoryError:
        limit = f"{request['memory'] // 2**20} MiB"
        message = f"more than {limit} of memory were needed. Simplify the spec."
        _send({"error": ResourceError(message, limit=request["memory"]).as_record()})
    except Exception as error:
        message = f"a fault of coadjoint itself: {type(error).__name__}: {error}. Please report it."
        trace = traceback.format_exc()
        _send({"error": InternalError(message, traceback=trace).as_record()})


def _function(target: str) -> Callable[[Any], Any]:
    """The function that a request names, of this package alone."""
    module, _, name = target.partition(":")
    assert module.split(".")[0] == "coadjoint", target
    function: Callable[[Any], Any] = getattr(import_module(module), name)
    return function


def _die_with(parent: int) -> None:
    """End this process when its parent ends, also if that has happened already."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _limit(kind: int, value: int) -> None:
    """Lower a limit of this process, never above what it has."""
    _, most = resource.getrlimit(kind)
    if most != resource.RLIM_INFINITY:
        value = min(value, most)
    resource.setrlimit(kind, (value, most if most != resource.RLIM_INFINITY else value))


def _send(message: dict[str, Any]) -> None:
    if _channel is not None:
        _channel.write(json.dumps(message) + "\n")
        _channel.flush()
