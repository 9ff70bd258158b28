"""Bounded children, the other side: the nursery, and the child that it forks for each request.

Comes in: requests as lines of JSON on standard input. Goes out: of a child progress and a result
as lines of JSON, or an error of this package, and of the nursery the child's exit status and
processor time. Limits of processor time and memory are the child's.
"""

from __future__ import annotations

import ctypes
import errno
import gc
import json
import math
import os
import resource
import select
import signal
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from mmap import PAGESIZE, mmap
from typing import IO, Any, Final, TypeVar

from coadjoint.errors import CoadjointError, InternalError, ResourceError, system_error

#: Environment variables that `coadjoint.sandbox` sets for the nursery; its parent may lack them.
OWN: Final = {
    # One thread: a fork takes no other ones along, and each pool of a numerical library reserves
    # memory of the child's limit.
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    # Arrays that are made again and again stay in the heap: the system clears each page that it
    # gives anew, which took a twentieth of the time of a cross-check.
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
    "MALLOC_TRIM_THRESHOLD_": str(2**28),
}
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_channel: IO[str] | None = None
_Function = TypeVar("_Function", bound=Callable[..., Any])


def prepared_by(target: str) -> Callable[[_Function], _Function]:
    """Say what a nursery does before children run this function: they then find it done.

    ``module`` of this package is imported, and of ``module:function`` the function is called.
    """

    def note(function: _Function) -> _Function:
        function.preparation = target  # type: ignore[attr-defined]
        return function

    return note


def report_progress(stage: str, done: int, total: int) -> None:
    """Tell the parent how far this child is; nothing happens outside a child."""
    _send({"progress": [stage, done, total]})


def serve() -> None:
    """Serve requests, each in a child; the entry point of the nursery."""
    global _channel  # one channel for all requests
    _channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what libraries print must not meet the messages
    for line in sys.stdin:
        request = json.loads(line)
        with suppress(Exception):  # a child then meets it within its limits, and tells of it
            _prepare(request["target"])
        try:
            status, used = _fork(request)
        except OSError as error:
            _send({"error": _describe(error, request).as_record()})
            status, used = 0, 0.0
        _send({"status": status, "used": used}, begin="\n")  # a child may have left half a line
    os._exit(0)


def _prepare(target: str) -> None:
    """Import and compute what children need."""
    preparation = getattr(_function(target), "preparation", None)
    if preparation is not None and ":" in preparation:
        _function(preparation)()
    elif preparation is not None:
        import_module(preparation)
    # What is imported stays: looking for cycles in all of it again and again takes a fifth of the
    # time of a large derivation, and would copy the memory that children share.
    gc.freeze()


def _fork(request: dict[str, Any]) -> tuple[int, float]:
    """Serve a request in a child; its exit status and processor time.

    Raises:
        OSError: There is no room for another process.
    """
    nursery = os.getpid()
    ended, end = os.pipe()  # which the system closes with the child
    child = os.fork()
    if child == 0:
        os.close(ended)
        _die_with(nursery)
        _serve_one(request)
        sys.exit()
    os.close(end)
    try:
        # More on standard input is its end: nobody asks for two things at once.
        if sys.stdin.fileno() in select.select([ended, sys.stdin.fileno()], [], [])[0]:
            os.killpg(0, signal.SIGKILL)  # the group of this process: it was made for it
    finally:
        os.close(ended)
    _, status, usage = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime


def _serve_one(request: dict[str, Any]) -> None:
    """Serve a request in this process, with a result or an error."""
    try:
        os.environ.update(request["environment"])
        for name in os.environ.keys() - request["environment"].keys() - OWN.keys():
            del os.environ[name]
        if request["folder"] is not None:
            os.chdir(request["folder"])
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        _limit(resource.RLIMIT_AS, request["memory"])
        mmap(-1, PAGESIZE).close()  # what was imported may be more than the limit already
        _limit(resource.RLIMIT_CORE, 0)
        # The soft limit alone: what this child starts may be given another one.
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        limit = find_processor_limit(request["seconds"])
        resource.setrlimit(resource.RLIMIT_CPU, (limit, most))
        gc.set_threshold(50_000, 10, 10)  # elements make no cycles
        _send({"result": _function(request["target"])(request["argument"])})
    except CoadjointError as error:
        _send({"error": error.as_record()})
    except Exception as error:
        _send({"error": _describe(error, request).as_record()})


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


def _function(target: str) -> Callable[..., Any]:
    """The function that a request names, of this package alone."""
    module, _, name = target.partition(":")
    assert module.split(".")[0] == "coadjoint", target
    function: Callable[..., Any] = getattr(import_module(module), name)
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


def _send(message: dict[str, Any], begin: str = "") -> None:
    if _channel is not None:
        _channel.write(begin + json.dumps(message) + "\n")
        _channel.flush()


def find_processor_limit(seconds: float) -> int:
    """Whole seconds of processor time, less where this process has a lower limit itself."""
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    whole = max(1, math.ceil(seconds))
    # One less than the hard limit, at which the system kills without saying why.
    return whole if most == resource.RLIM_INFINITY else max(1, min(whole, most - 1))
