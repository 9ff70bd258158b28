"""The compiler: found, asked for its version, and run on one kernel within limits.

Comes in: a folder with ``kernel.c`` and ``kernel.h``. Goes out: a shared object in it. Nothing here
passes through a shell, and ``CC`` is a program's name and nothing more.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from coadjoint.errors import CompilerError
from coadjoint.limits import COMPILE_BYTES, COMPILE_SECONDS

CANDIDATES = ("cc", "gcc", "clang")
HOW_TO_GET_ONE = "Install one: `apt install gcc`, or `pip install 'coadjoint[c]'` anywhere."
#: What ``CC`` may be: a name or path; a leading - or @ would be an option of another program.
_PLAIN_PROGRAM = re.compile(r"[A-Za-z0-9_./+][A-Za-z0-9_./+-]*")

#: Contraction of a*b + c into one rounding is the only difference between the builds: without it
#: every operation rounds as NumPy's does. -fno-math-errno lets sqrt be vectorised, same value.
BUILDS: Mapping[str, str] = {"exact": "-ffp-contract=off", "fast": "-ffp-contract=fast"}
_FLAGS = ("-std=c11", "-O3", "-fno-math-errno", "-Wall", "-Wextra", "-Werror", "-pedantic")
_NATIVE = "-march=native"
#: Passes of GCC that take more than half of its time on long straight loops and gain nothing there
#: (docs/decisions/compiler.md has the figures). The last leaves the members that fill no vector to
#: scalar code, in the place of a second and third copy of the loop with shorter vectors.
_GNU = (
    "-fno-gcse-after-reload",
    "-fno-tree-loop-distribution",
    "-fno-tree-slp-vectorize",
    "--param=vect-epilogues-nomask=0",
)
_SHARED = ("-fPIC", "-shared")


class CompilerWarning(UserWarning):
    """Kernels are not what they could be: another processor's, or NumPy's instead of C."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler that answered.

    Attributes:
        command: Program and leading arguments.
        version: First line of its ``--version``.
        is_gnu: Whether it is GCC, which has options of its own.
    """

    command: tuple[str, ...]
    version: str
    is_gnu: bool = False

    def flags(self, build: str, *, native: bool = True) -> tuple[str, ...]:
        """Options for one build, ``exact`` or ``fast``."""
        own = _GNU if self.is_gnu else ()
        return (*_FLAGS, *own, *([_NATIVE] if native else []), BUILDS[build], *_SHARED)


def find_compiler() -> Compiler:
    """The compiler of ``CC``, or the first of cc, gcc, clang and the one of the extra ``c``.

    Raises:
        CompilerError: ``CC`` is no plain program name or is not there, or no compiler is found.
    """
    return _find(os.environ.get("CC", ""), os.environ.get("PATH", ""))


@cache
def _find(chosen: str, path: str) -> Compiler:
    """The search, remembered for each setting of the environment."""
    if chosen:
        if not _PLAIN_PROGRAM.fullmatch(chosen):
            raise CompilerError(
                f"CC is {chosen!r}; expected the name or path of one program, without arguments. "
                "Unset CC, or set it to gcc or clang.",
                found=chosen,
            )
        program = shutil.which(chosen, path=path)
        if program is None:
            raise CompilerError(
                f"CC is {chosen!r}, which is not found; expected a compiler on the PATH. "
                "Unset CC to search for one.",
                found=chosen,
            )
        command: tuple[str, ...] = (os.path.abspath(program),)  # noqa: PTH100 (links stay: clang is named by one)
        return _compiler(command)
    for candidate in CANDIDATES:
        program = shutil.which(candidate, path=path)
        if program is not None:
            return _compiler((program,))
    if find_spec("ziglang") is not None:
        command = (sys.executable, "-I", "-m", "ziglang", "cc")
        return _compiler(command)
    raise CompilerError(
        f"no C compiler is found (looked for {', '.join(CANDIDATES)}, ziglang). {HOW_TO_GET_ONE}",
        found="",
    )


def _compiler(command: tuple[str, ...]) -> Compiler:
    """A compiler by what it says of itself.

    Raises:
        CompilerError: It does not answer.
    """
    status, output = _run((*command, "--version"), Path(tempfile.gettempdir()), seconds=30)
    if status != 0 or not output.strip():
        raise CompilerError(
            f"{' '.join(command)} --version ended with status {status} and said "
            f"{output.strip()[:200]!r}; expected a version. Set CC to a working compiler.",
            found=command[0],
            status=status,
        )
    return Compiler(command, output.strip().splitlines()[0], "Free Software Foundation" in output)


def compile_kernel(compiler: Compiler, folder: Path, build: str) -> Path:
    """Compile ``kernel.c`` in a folder to ``kernel.so`` beside it.

    Args:
        compiler: What `find_compiler` returned.
        folder: A private folder with ``kernel.c`` and ``kernel.h``.
        build: ``exact`` or ``fast``.

    Raises:
        CompilerError: The compiler failed, hung, or made no shared object.
    """
    result = folder / "kernel.so"
    status, output = _attempt(compiler, folder, build, native=True)
    if status != 0 and _attempt(compiler, folder, build, native=False)[0] == 0:
        status = 0  # some compilers and machines do not know -march=native
        warnings.warn(
            f"{compiler.command[0]} refuses {_NATIVE}; kernels are compiled without it, which may "
            "be slower.",
            CompilerWarning,
            stacklevel=2,
        )
    if status != 0:
        raise CompilerError(
            f"{compiler.command[0]} failed on kernel.c with status {status}: "
            f"{output.strip()[:600] or 'it said nothing'}. Set CC to another compiler.",
            found=compiler.command[0],
            status=status,
        )
    if not result.is_file() or result.read_bytes()[:4] not in _MAGIC:
        raise CompilerError(
            f"{compiler.command[0]} ended with status 0 but made no shared object. "
            "Set CC to another compiler.",
            found=compiler.command[0],
            status=0,
        )
    return result


#: First bytes of shared objects: ELF, and Mach-O in its 64-bit and universal forms.
_MAGIC = (b"\x7fELF", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe")


def _attempt(compiler: Compiler, folder: Path, build: str, *, native: bool) -> tuple[int, str]:
    """One run of the compiler; status and what it said."""
    flags = compiler.flags(build, native=native)
    return _run((*compiler.command, *flags, "kernel.c", "-o", "kernel.so", "-lm"), folder)


def _run(
    command: tuple[str, ...], folder: Path, seconds: float = COMPILE_SECONDS
) -> tuple[int, str]:
    """Run a program in a folder within limits; status and output, standard error included.

    Raises:
        CompilerError: It took too long, or could not be started.
    """
    kept = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env={**kept, "LC_ALL": "C", "TMPDIR": str(folder)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    except OSError as error:
        raise CompilerError(
            f"{command[0]} could not be started: {error.strerror}. Set CC to another compiler.",
            found=command[0],
        ) from error
    _limit_memory(process.pid)
    try:
        output, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        raise CompilerError(
            f"{command[0]} did not end within {seconds:g} s and was stopped. "
            "Set CC to another compiler.",
            found=command[0],
            limit=seconds,
        ) from None
    finally:
        _kill_group(process)
    return process.returncode, output.decode(errors="replace")


def _limit_memory(process: int) -> None:
    """Bound the address space of a child where the system can do that from outside."""
    if hasattr(resource, "prlimit"):
        # It may have ended already, or have inherited a lower limit.
        with suppress(ProcessLookupError, ValueError, PermissionError):
            resource.prlimit(process, resource.RLIMIT_AS, (COMPILE_BYTES, COMPILE_BYTES))


def _kill_group(process: subprocess.Popen[bytes]) -> None:
    """End a child and everything it started."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdout is not None:
        process.stdout.close()
