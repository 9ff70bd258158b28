"""The compiler: found, asked for its version, and run on one kernel or solver.

Comes in: a folder with a C file and its header. Goes out: a shared object in it. Nothing here
passes through a shell, and ``CC`` is a program's name and nothing more.
Read next: `coadjoint.build.processes`, which runs it within limits.
"""

from __future__ import annotations

import os
import platform
import re
import shutil
import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from coadjoint.build.calling import SUPPORT
from coadjoint.build.processes import ANOTHER, advise, run_program, with_signal
from coadjoint.build.source import KERNEL, Source
from coadjoint.build.versions import keep_version, recall_version
from coadjoint.errors import CompilerError, errno_of

CANDIDATES = ("cc", "gcc", "clang")
HOW_TO_GET_ONE = "Install one: `apt install gcc`, or `pip install 'coadjoint[c]'` anywhere."
#: What ``CC`` may be: a name or path; a leading - or @ would be an option of another program.
_PLAIN_PROGRAM = re.compile(r"[A-Za-z0-9_./+][A-Za-z0-9_./+-]*")

#: Contraction of a*b + c into one rounding is the only difference between the builds: without it
#: every operation rounds as NumPy's does. -fno-math-errno lets sqrt be vectorised, same value.
BUILDS: Mapping[str, str] = {"exact": "-ffp-contract=off", "fast": "-ffp-contract=fast"}
_FLAGS = ("-std=c11", "-fno-math-errno", "-Wall", "-Wextra", "-Werror", "-pedantic")
#: What suits this processor, tried in this order. GCC and clang know registers of 512 bits and
#: prefer 256 on many processors that have them; without such registers the option says nothing
#: (docs/decisions/vector-width.md has the figures). Compilers of other processors refuse it.
_NATIVE, _WIDE = "-march=native", "-mprefer-vector-width=512"
_IS_X86 = platform.machine().lower() in ("x86_64", "amd64")
MACHINES = (*(((_NATIVE, _WIDE),) if _IS_X86 else ()), (_NATIVE,), ())
#: The environment variable that lowers how much is optimised, and its values.
OPTIMIZE = "COADJOINT_OPTIMIZE"
_LEVELS = ("0", "1", "2", "3")
#: Passes of GCC that take more than half of its time on long straight loops and gain nothing there
#: (docs/decisions/compiler.md has the figures). The last leaves the members that fill no vector to
#: scalar code, in the place of a second and third copy of the loop with shorter vectors.
_GNU = (
    "-fno-gcse-after-reload",
    "-fno-tree-loop-distribution",
    "-fno-tree-slp-vectorize",
    "--param=vect-epilogues-nomask=0",
)
#: GCC takes rows that one loop fills and another reads for uninitialised where it does not see that
#: both have the same length: that depends on the processor and on what stands in one function.
_UNSURE = ("-Wno-maybe-uninitialized",)
#: It fuses a product and a sum with the first alone of all that the second level has in addition.
_FUSING = ("-fexpensive-optimizations",)
#: What is run for some points alone, and fused, needs none of the first level's other passes, and
#: no registers that are shared out with care (docs/decisions/compiler.md has the figures): as many
#: operations are fused without them.
_SPARED_PASSES = (
    "tree-loop-optimize tree-dse dse tree-fre tree-dominator-opts tree-sink tree-vrp tree-ccp "
    "tree-copy-prop tree-pta forward-propagate cprop-registers if-conversion if-conversion2 "
    "combine-stack-adjustments move-loop-invariants ssa-phiopt guess-branch-probability "
    "reorder-blocks split-wide-types caller-saves ipa-icf ipa-vrp ipa-pure-const ipa-reference "
    "ira-share-spill-slots"
)
_HASTY = (
    "-fira-region=one",
    "-fira-algorithm=priority",
    *(f"-fno-{each}" for each in _SPARED_PASSES.split()),
)
#: ``-z now``: a symbol that is missing is missed when the library is loaded, not in a first call.
_SHARED = ("-fPIC", "-shared", *(("-Wl,-z,now",) if sys.platform == "linux" else ()))
#: Seconds in which a compiler tells its version.
VERSION_SECONDS = 30


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

    def flags(
        self, build: str, source: Source = KERNEL, *, machine: tuple[str, ...] = MACHINES[0]
    ) -> tuple[str, ...]:
        """Options for one build of a source, ``exact`` or ``fast``, on one of `MACHINES`.

        Raises:
            CompilerError: The environment asks for no level of optimisation.
        """
        own = _UNSURE * self.is_gnu + _GNU * (self.is_gnu and source.is_loops)
        lowest = int(build == "fast")  # without optimisation nothing is fused
        level = min(source.level, max(_allowed_level(), lowest))
        fusing = _FUSING if self.is_gnu and level == 1 else ()
        hasty = _HASTY if fusing and source.level == 1 else ()  # the cross-check, never users
        suited = (f"-O{level}", *fusing, *hasty, *own, *machine)
        return (*_FLAGS, *suited, BUILDS[build], *source.defines, *_SHARED)


def _allowed_level() -> int:
    """How much the environment lets compilers optimise.

    Raises:
        CompilerError: It says something else than a level.
    """
    text = os.environ.get(OPTIMIZE, "").strip() or _LEVELS[-1]
    if text not in _LEVELS:
        raise CompilerError(
            f"{OPTIMIZE} is {text[:40]!r}; expected {', '.join(_LEVELS[:-1])} or {_LEVELS[-1]}. "
            "Unset it for kernels as fast as they can be; 1 compiles in a third of the time.",
            found=text[:40],
        )
    return int(text)


def find_compiler() -> Compiler:
    """The compiler of ``CC``, or the first of cc, gcc, clang and the one of the extra ``c``.

    Raises:
        CompilerError: ``CC`` is not a plain program name or is not there, or no compiler is found.
    """
    compiler = _find(os.environ.get("CC", ""), os.environ.get("PATH", ""))
    if isinstance(compiler, CompilerError):
        raise CompilerError(str(compiler), **compiler.parts)
    return compiler


def compiler_version() -> str:
    """The version of the compiler, or "none" where there is none.

    Raises:
        CompilerError: There is one that does not work, or one was asked for that is not there.
    """
    try:
        return find_compiler().version
    except CompilerError as error:
        if error.found:
            raise
        return "none"


@cache
def _find(chosen: str, path: str) -> Compiler | CompilerError:
    """What the search ends in, remembered for each setting of the environment.

    A failure is remembered, too: a compiler that hangs is asked once in a process.
    """
    try:
        return _search(chosen, path)
    except CompilerError as error:
        return error


def _search(chosen: str, path: str) -> Compiler:
    """The compiler that is chosen, else the first that is there."""
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
            return _compiler((os.path.abspath(program),))  # noqa: PTH100 (as above)
    if find_spec("ziglang") is not None:
        command = (sys.executable, "-I", "-m", "ziglang", "cc")
        return _compiler(command)
    raise CompilerError(
        f"no C compiler was found (searched for {', '.join(CANDIDATES)}, ziglang). "
        f"{HOW_TO_GET_ONE}",
        found="",
    )


def _compiler(command: tuple[str, ...]) -> Compiler:
    """A compiler by what it says of itself.

    Raises:
        CompilerError: It does not answer.
    """
    known = recall_version(command)
    if known is not None:
        return Compiler(command, *known)
    status, output = run_program(
        (*command, "--version"), Path("/"), VERSION_SECONDS, VERSION_SECONDS
    )
    if status != 0 or not output.strip():
        said = with_signal(output, status)
        raise CompilerError(
            f"{' '.join(command)} --version ended with status {status} and said "
            f"{output.strip()[:200]!r}; expected a version. {advise(said)}",
            found=command[0],
            status=status,
        )
    found = output.strip().splitlines()[0], "Free Software Foundation" in output
    keep_version(command, found)
    return Compiler(command, *found)


def compile_kernel(
    compiler: Compiler,
    folder: Path,
    build: str,
    source: Source = KERNEL,
    parts: Sequence[str] = (),
) -> Path:
    """Compile ``kernel.c`` to ``kernel.so`` in the same folder, with the name of the build in it.

    Args:
        compiler: What `find_compiler` returned.
        folder: A private folder with ``kernel.c`` and ``kernel.h``, or those of another source.
        build: ``exact`` or ``fast``.
        source: What is compiled.
        parts: Files that are compiled in its place, and read it; what calls kernels is left out.

    Raises:
        CompilerError: The compiler failed, hung, or made no shared object.
    """
    result = folder / f"{source.stem}.so"
    if not parts:
        text = SUPPORT.replace("SOURCE", source.files[0]).replace("BUILD", build)
        (folder / "build.c").write_text(text, encoding="ascii")
    files = parts or ("build.c",)

    def attempt(machine: tuple[str, ...]) -> tuple[int, str]:
        flags = compiler.flags(build, source, machine=machine)
        return run_program((*compiler.command, *flags, *files, "-o", result.name, "-lm"), folder)

    status, output = attempt(MACHINES[0])
    said = with_signal(output, status)
    if status != 0 and not errno_of(said):  # it failed itself, and met no limit
        for machine in MACHINES[1:]:
            if attempt(machine)[0] == 0:
                status = 0
                _tell_refused(compiler, machine)
                break
    if status != 0:
        raise CompilerError(
            f"{compiler.command[0]} failed on {source.files[0]} with status {status}: "
            f"{output.strip()[:600] or 'no output'}. {advise(said)}",
            found=compiler.command[0],
            status=status,
        )
    if not result.is_file() or result.read_bytes()[:4] not in _MAGIC:
        raise CompilerError(
            f"{compiler.command[0]} exited with status 0 but produced no shared object. {ANOTHER}",
            found=compiler.command[0],
            status=0,
        )
    return result


def _tell_refused(compiler: Compiler, machine: tuple[str, ...]) -> None:
    """Warn that kernels are compiled with fewer options for this processor."""
    refused = [option for option in MACHINES[0] if option not in machine]
    warnings.warn(
        f"{compiler.command[0]} refuses {' '.join(refused)}; kernels are compiled without it, "
        "which may be slower.",
        CompilerWarning,
        stacklevel=3,
    )


#: First bytes of shared objects: ELF, and Mach-O in its 64-bit and universal forms.
_MAGIC = (b"\x7fELF", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe")
