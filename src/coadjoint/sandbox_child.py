"""Bounded children, the other side: the process that serves requests, under its own limits.

Comes in: requests as lines of JSON on standard input. Goes out: progress and results as lines of
JSON, or errors of this package. Limits of processor time and memory are set before a request is
served.
"""

from __future__ import annotations

import ctypes
import errno
import gc
import json
import math
import os
import re
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import IO, Any

from coadjoint.errors import CoadjointError, InternalError, ResourceError, system_error

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
#: A child that has had this part of its memory serves no other request.
MEMORY_PART = 4
_channel: IO[str] | None = None


def report_progress(stage: str, done: int, total: int) -> None:
    """Tell the parent how far this child is; nothing happens outside a child."""
    _send({"progress": [stage, done, total]})


def serve() -> None:
    """Serve requests, each but the last with a result; the entry point of the child process."""
    global _channel  # one channel for all requests of this process
    _die_with(int(sys.argv[2]))
    _channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what libraries print must not meet the messages
    used = 0
    for line in sys.stdin:
        if not _serve_one(json.loads(line), used):
            return
        used = math.ceil(_measure_use(resource.RUSAGE_SELF))


def _serve_one(request: dict[str, Any], used: int) -> bool:
    """Serve one request after processor time of others; whether another one may follow."""
    _limit(resource.RLIMIT_AS, request["memory"])
    _limit(resource.RLIMIT_CORE, 0)
    # The soft limit alone: what this child starts may be given another one.
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (find_processor_limit(request["seconds"] + used), most))
    again = 0.0
    try:
        function = _function(request["target"])
        # What is imported stays, and elements make no cycles: looking for some in all of it again
        # and again takes a fifth of the time of a large derivation.
        gc.freeze()
        gc.set_threshold(50_000, 10, 10)
        result = function(request["argument"])
        again = _measure_use() if request["again"] and _is_fresh(request["memory"]) else 0.0
        _send({"result": result, "again": again})
    except CoadjointError as error:
        _send({"error": error.as_record(), "again": 0.0})
    except Exception as error:
        _send({"error": _describe(error, request).as_record(), "again": 0.0})
    gc.collect()
    return bool(again)


def _is_fresh(memory: int) -> bool:
    """Whether this process may serve another request as if it were the first.

    A limit of processor time of the whole session is shared out to processes of their own.
    """
    unlimited = resource.getrlimit(resource.RLIMIT_CPU)[1] == resource.RLIM_INFINITY
    return unlimited and _find_peak() < memory / MEMORY_PART


def _find_peak() -> int:
    """The most memory that this process has had, bytes.

    What getrusage says begins with the peak of the process that started this one, which may be a
    large one.
    """
    with suppress(OSError):
        told = re.search(r"VmHWM:\s*(\d+) kB", Path("/proc/self/status").read_text("ascii"))
        if told is not None:
            return int(told[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _measure_use(*whose: int) -> float:
    """Processor time of this process and of what it waited for, or of one of them, seconds."""
    whose = whose or (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(each.ru_utime + each.ru_stime for each in map(resource.getrusage, whose))


def _describe(error: Exception, request: dict[str, Any]) -> CoadjointError:
    """An exception of another library as one of this package; called where it is handled."""
    if _is_want_of_memory(error):
        memory: int = request["memory"]
        message = f"more than {memory // 2**20} MiB of memory were needed. Simplify the spec."
        return ResourceError(f"{request['subject']}: {message}", limit=memory)
    refused = system_error(error)
    if refused is not None:
        return refused
    message = f"a fault of coadjoint itself: {type(error).__name__}: {error}. Please report it."
    return InternalError(message, traceback=traceback.format_exc())


def _is_want_of_memory(error: Exception) -> bool:
    """Whether memory was refused, to Python, by the system, or to a library that was to load."""
    if isinstance(error, ImportError):
        return "failed to map segment" in str(error) or "annot allocate memory" in str(error)
    # A SystemError comes from libraries in C that do not look what they were given.
    refused = isinstance(error, MemoryError | SystemError)
    return refused or getattr(error, "errno", None) == errno.ENOMEM


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


def find_processor_limit(seconds: float) -> int:
    """Whole seconds of processor time, less where this process has a lower limit itself."""
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    whole = max(1, math.ceil(seconds))
    # One less than the hard limit, at which the system kills without saying why.
    return whole if most == resource.RLIM_INFINITY else max(1, min(whole, most - 1))
