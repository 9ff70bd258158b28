"""The library: C of a generated folder, compiled or taken from the cache, and loaded.

Comes in: a folder with ``kernel.c`` and ``kernel.h``, or with those of a solver. Goes out: a
`Library` whose functions ctypes can call. A fresh object is compared with its NumPy twin before it
enters the cache, so that a compiler that lies is noticed once and for all.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import platform
import shutil
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

from coadjoint import __version__
from coadjoint.build.cache import fetch, store, working_folder
from coadjoint.build.calling import CALL, CALL_AT, LABEL, SUPPORT
from coadjoint.build.compiler import Compiler, compile_kernel, find_compiler
from coadjoint.build.processes import ANOTHER
from coadjoint.build.source import KERNEL, Source
from coadjoint.errors import CompilerError, OutputError, remedy_for, system_error

_SIZE, _ADDRESS = ctypes.c_size_t, ctypes.c_void_p


class Library:
    """A loaded kernel or solver.

    Args:
        path: The shared object.
        name: Name of the system, the prefix of its functions.
        identity: The id that the object must carry.
        build: The build that it must say it is, ``exact`` or ``fast``.
        source: SHA-256 of the C file that it was compiled from.
        kind: What that file is.
        key: Hash of all that the object depends on.

    Raises:
        CompilerError: It cannot be loaded, carries another id, or is another build.
    """

    def __init__(
        self,
        path: Path,
        name: str,
        identity: str,
        build: str,
        source: str = "",
        kind: Source = KERNEL,
        key: str = "",
    ) -> None:
        self.name, self.source, self.key = name, source, key
        self._places: dict[str, int] = {}
        try:
            # CDLL, not PyDLL: calls release the interpreter lock.
            self._handle = ctypes.CDLL(str(path))
            labels = [("id", kind.label(name), identity), ("build", LABEL, build)]
            carried = [(what, self._text(each, wanted), wanted) for what, each, wanted in labels]
            self._call, self._call_at = self._handle[CALL], self._handle[CALL_AT]
        except (OSError, ValueError, AttributeError) as error:
            raise CompilerError(
                f"the compiled {kind.stem} of {name} cannot be loaded: {error}. "
                f"{remedy_for(str(error)) or ANOTHER}",
                found=str(error),
            ) from error
        for what, label, expected in carried:
            if label != expected:
                raise CompilerError(
                    f"the compiled {kind.stem} of {name} carries the {what} {label!r}; expected "
                    f"{expected!r}. Run `coadjoint regenerate`.",
                    found=label,
                    expected=expected,
                )
        self._call.restype = self._call_at.restype = None
        self._call_at.argtypes = [_ADDRESS, _SIZE, _ADDRESS, _ADDRESS, _ADDRESS]

    def _text(self, symbol: str, expected: str) -> str:
        """A string of the object, no further than one character beyond what is expected."""
        characters = (ctypes.c_char * (len(expected) + 1)).in_dll(self._handle, symbol)
        return bytes(characters).split(b"\0")[0].decode("ascii", "replace")

    def bind(self, function: str, *arguments: int) -> Callable[[], None]:
        """A call of a function with its arguments, packed once.

        Args:
            function: Its bare name.
            arguments: Members, then place and stride of each array: state, parameters, inputs and
                time where there are some, the number of equal members, result.
        """
        return partial(self._call, self._pack(function, arguments))

    def bind_at(self, function: str, *arguments: int) -> Callable[[int, Any, Any, Any], None]:
        """The same for other members: number, state, parameters and result are given at each call.

        They are passed as `ctypes.byref` makes them, without gaps between the rows; parameters
        that are None are those of the arguments, others are shared in the same way.
        """
        return partial(self._call_at, self._pack(function, arguments))

    def take(self, function: str) -> Callable[[Any], int]:
        """A function of the object that takes a pointer to a structure and returns a size.

        Raises:
            CompilerError: The object has none of this name.
        """
        return ctypes.CFUNCTYPE(_SIZE, _ADDRESS)(self.find(function))

    def _pack(self, function: str, arguments: Sequence[int]) -> Any:
        """A pointer to packed arguments, as the second file of an object takes them."""
        arrays, rest = divmod(len(arguments), 2)
        assert rest == 1, len(arguments)
        assert 3 <= arrays <= 6, len(arguments)
        words = (self.find(function), arrays, *arguments)
        return ctypes.byref((_SIZE * len(words))(*words))

    def find(self, function: str) -> int:
        """The address of a function of the object, by its bare name.

        Raises:
            CompilerError: The object has none.
        """
        try:
            if function not in self._places:
                symbol = self._handle[f"{self.name}_{function}"]
                self._places[function] = ctypes.cast(symbol, _ADDRESS).value or 0
            return self._places[function]
        except AttributeError as error:
            raise CompilerError(
                f"the compiled kernel of {self.name} has no function {function}. "
                "Run `coadjoint regenerate`.",
                found=function,
            ) from error


def load_library(
    folder: Path,
    name: str,
    identity: str,
    build: str,
    verify: Callable[[Library], None],
    kind: Source = KERNEL,
) -> Library:
    """Load C of a generated folder, compiling it unless the cache has it.

    Args:
        folder: The generated folder.
        name: Name of the system.
        identity: The id of its files.
        build: ``exact`` or ``fast``.
        verify: Raises if a fresh library computes something else than its NumPy twin.
        kind: What is compiled: the kernel, or another source.

    Raises:
        CompilerError: There is no compiler, it failed, its object is wrong, or there is no place
            where it could work.
        OutputError: The folder has no such source.
    """
    kept = find_library(folder, name, identity, build, kind)
    if kept is not None:
        return kept
    compiler, sources = find_compiler(), _sources(folder, kind)
    key, source = find_key(compiler, sources, build, kind), _hash(sources[kind.files[0]])
    with ExitStack() as stack:
        try:
            work = stack.enter_context(working_folder())
            for file, content in sources.items():
                (work / file).write_bytes(content)
            fresh = compile_kernel(compiler, work, build, kind)
        except (OSError, OutputError) as error:
            reason = system_error(error) or error
            raise CompilerError(
                f"the {kind.stem} of {name} cannot be compiled here: {reason}", found=str(reason)
            ) from error
        library = Library(fresh, name, identity, build, source, kind, key)
        verify(library)
        with suppress(OSError, OutputError):  # it is good; the next process compiles again
            store(key, fresh.read_bytes())
        return library


def find_library(
    folder: Path, name: str, identity: str, build: str, kind: Source = KERNEL
) -> Library | None:
    """Load C of a generated folder if the cache has it compiled; arguments as in `load_library`.

    Raises:
        CompilerError: There is no compiler.
        OutputError: The folder has no such source.
    """
    sources = _sources(folder, kind)
    key = find_key(find_compiler(), sources, build, kind)
    cached = fetch(key)
    if cached is not None:
        with suppress(CompilerError):  # whole, and yet of no use here: compile it anew
            source = _hash(sources[kind.files[0]])
            return Library(cached, name, identity, build, source, kind, key)
    return None


def _sources(folder: Path, kind: Source) -> dict[str, bytes]:
    """The C files of a generated folder.

    Raises:
        OutputError: One cannot be read.
    """
    try:
        return {file: (folder / file).read_bytes() for file in kind.files}
    except OSError as error:
        raise system_error(error) or OutputError(
            f"{error.filename} cannot be read: {error.strerror}; expected the C {kind.stem} of a "
            "generated system. Run `coadjoint regenerate`.",
            path=str(error.filename),
        ) from error


def find_key(
    compiler: Compiler, sources: dict[str, bytes], build: str, kind: Source = KERNEL
) -> str:
    """Hash of all that an object depends on, the processor of ``-march=native`` included."""
    content = {
        "sources": {file: _hash(text) for file, text in sources.items()},
        "command": [shutil.which(compiler.command[0]), *compiler.command[1:]],
        "version": compiler.version,
        "flags": compiler.flags(build, kind),
        "support": SUPPORT,
        "engine": __version__,
        "machine": [platform.system(), platform.machine(), tell_processor()],
    }
    return _hash(json.dumps(content, sort_keys=True).encode())


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@cache
def tell_processor() -> str:
    """What tells processors apart that share a home folder."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    wanted = ("model name", "flags", "Features", "CPU part")
    return "\n".join(dict.fromkeys(line for line in lines if line.startswith(wanted)))
