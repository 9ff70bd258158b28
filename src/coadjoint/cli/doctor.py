"""Command ``doctor``: what this machine has, what is missing, and how to get it.

Comes in: nothing. Goes out: a table of findings. A missing compiler or extra is a remark, since
everything works without, and so is what the next run mends; what is there and does not work is a
failure, exit status 1. Nothing is repaired. Read next: `coadjoint.render.health`.
"""

from __future__ import annotations

import ctypes
import os
import platform
import resource
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

import click

from coadjoint import __version__
from coadjoint.budget import allowed_seconds
from coadjoint.cli.output import json_option, print_json, print_table
from coadjoint.errors import CoadjointError, CompilerError, OutputError
from coadjoint.limits import WORKER_BYTES, WORKER_SECONDS
from coadjoint.resources import systems_folder

PACKAGES: Final = ("sympy", "numpy", "scipy", "mpmath", "jinja2", "pydantic", "click", "rich")
#: Packages of each optional extra.
EXTRAS: Final = {"plot": ("matplotlib",), "data": ("xarray", "pandas"), "c": ("ziglang",)}

#: Limits of the operating system, and what they must allow at the least.
LEAST: Final = (
    (resource.RLIMIT_FSIZE, "the limit of file sizes (ulimit -f)", "bytes", 16 * 2**20),
    (resource.RLIMIT_CPU, "the limit of processor time (ulimit -t)", "seconds", WORKER_SECONDS),
    (resource.RLIMIT_AS, "the limit of memory (ulimit -v)", "bytes", WORKER_BYTES),
    (resource.RLIMIT_NOFILE, "the limit of open files (ulimit -n)", "files", 64),
)
#: Bytes that must be free for temporary files and in the cache, and that are written for a trial.
LEAST_FREE: Final = 64 * 2**20
PROBE_BYTES: Final = 2**16

_RELOAD: Final = "repaired when its spec is next loaded"
PROBE: Final = "int coadjoint_probe(void);\nint coadjoint_probe(void) { return 42; }\n"


@dataclass(frozen=True)
class Finding:
    """One line of the report.

    Attributes:
        what: What was looked at.
        status: ``ok``, ``missing`` (works without), ``heals`` (mended by the next run) or
            ``failed``.
        found: What was found.
        remedy: What to do, or "".
    """

    what: str
    status: str
    found: str
    remedy: str = ""


@click.command("doctor")
@json_option
def command(as_json: bool) -> int:
    """Check compiler, cache, packages, limits and generated files.

    Shows what to do about each problem. The exit status is 1 if something does not work.
    """
    findings = list(examine())
    if as_json:
        print_json([asdict(finding) for finding in findings])
    else:
        print_table(
            ("", "status", "found", "what to do"),
            [(each.what, each.status, each.found, each.remedy) for each in findings],
        )
    return 1 if any(finding.status == "failed" for finding in findings) else 0


def examine() -> Iterator[Finding]:
    """Every finding in turn."""
    yield Finding("coadjoint", "ok", f"{__version__} in {Path(__file__).parents[1]}")
    yield Finding("python", "ok", f"{platform.python_version()}, {sys.executable}")
    yield Finding("machine", "ok", f"{platform.system()} {platform.machine()}")
    for package in PACKAGES:
        yield _package(package)
    yield _attempt("limits", _limits)
    yield _attempt("temporary files", lambda: _room(Path(tempfile.gettempdir())))
    yield _attempt("bounded children", _children)
    yield _attempt("compiler", _compiler)
    yield _attempt("C kernels", _kernels)
    yield _attempt("cache", _cache)
    yield from _cache_state()
    yield from _tree_state()
    for extra, packages in EXTRAS.items():
        yield _extra(extra, packages)


def _package(package: str) -> Finding:
    """A package that coadjoint cannot do without."""
    try:
        return Finding(package, "ok", version(package))
    except PackageNotFoundError:
        return Finding(package, "failed", "not installed", f"pip install {package}")


def _extra(extra: str, packages: tuple[str, ...]) -> Finding:
    """An optional extra."""
    versions = {}
    for package in packages:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            return Finding(
                f"extra {extra}",
                "missing",
                f"{package} is not installed",
                f"pip install 'coadjoint[{extra}]'",
            )
    return Finding(f"extra {extra}", "ok", ", ".join(f"{n} {v}" for n, v in versions.items()))


def _attempt(what: str, look: Callable[[], str]) -> Finding:
    """A finding of a function that may raise; its message says what to do."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return Finding(what, "ok", look())
    except CompilerError as error:
        # No compiler at all: the NumPy kernels do the same. One that is there and fails is a fault.
        status = "missing" if error.parts.get("found") == "" else "failed"
        return Finding(what, status, str(error), "NumPy kernels are used instead")
    except (CoadjointError, UserWarning, OSError, AttributeError) as error:
        return Finding(what, "failed", str(error))


def _limits() -> str:
    """Limits of this session and settings that would end a derivation early."""
    low = [
        f"{name} allows {allowed} {unit}; expected {least} or more"
        for kind, name, unit, least in LEAST
        if (allowed := resource.getrlimit(kind)[0]) not in (resource.RLIM_INFINITY, -1)
        and allowed < least
    ]
    if low:
        raise OutputError(f"{'; '.join(low)}. Raise the limits of the shell.", found=low)
    return (
        f"{allowed_seconds()} s of processor time and {WORKER_BYTES // 2**20} MiB for each system"
    )


def _room(folder: Path) -> str:
    """Write a file in a folder, and look how much more it takes."""
    with tempfile.TemporaryFile(dir=folder) as file:
        file.write(bytes(PROBE_BYTES))
        file.flush()
        os.fsync(file.fileno())
    free = shutil.disk_usage(folder).free
    if free < LEAST_FREE:
        raise OutputError(
            f"{folder} has {free // 2**20} MiB left; expected {LEAST_FREE // 2**20} or more. Free "
            "some space.",
            path=str(folder),
            found=free,
        )
    return f"{folder}: {free // 2**20} MiB free"


def _children() -> str:
    """Have a child compute something, within its limits."""
    from coadjoint.sandbox import run_bounded

    run_bounded("coadjoint.fingerprint:digest", [], seconds=allowed_seconds(), memory=WORKER_BYTES)
    return "started, limited and answered"


def _compiler() -> str:
    """The compiler and the options it is given."""
    from coadjoint.build.compiler import find_compiler

    compiler = find_compiler()
    return f"{compiler.version} ({' '.join([*compiler.command, *compiler.flags('exact')])})"


def _kernels() -> str:
    """Compile a tiny kernel, load it and call it."""
    from coadjoint.build.compiler import CompilerWarning, compile_kernel, find_compiler

    # One that refuses an option is a compiler that works.
    warnings.simplefilter("ignore", CompilerWarning)
    with tempfile.TemporaryDirectory(prefix="coadjoint-") as folder:
        (Path(folder) / "kernel.c").write_text(PROBE, encoding="ascii")
        library = ctypes.CDLL(str(compile_kernel(find_compiler(), Path(folder), "exact")))
        answer = library.coadjoint_probe()
    if answer != 42:
        raise CompilerError(
            f"a compiled kernel returned {answer}; expected 42. Set CC to another compiler.",
            found=str(answer),
        )
    return "compiled, loaded and called"


def _cache() -> str:
    """The cache folder and what it holds."""
    from coadjoint.build.cache import cache_folder

    folder = cache_folder()
    _room(folder)
    kernels = [path.stat().st_size for path in folder.glob("kernels/*.so")]
    systems = len(list(folder.glob("systems/*/manifest.json")))
    return f"{folder}: {len(kernels)} kernels, {sum(kernels) / 1e6:.1f} MB, {systems} own systems"


def _cache_state() -> Iterator[Finding]:
    """What is damaged or left over in the cache, and in the user's own systems there."""
    from coadjoint.build.cache import cache_problems, chosen_folder
    from coadjoint.build.upkeep import SYSTEMS, list_kept

    for problem in cache_problems():
        yield Finding("cache", "heals", problem, "repaired at its next use")
    folder = chosen_folder()
    for path in list_kept(folder / SYSTEMS) if folder is not None else ():
        yield from _tree("own system", path, is_shipped=False, reloads=True)


def _tree_state() -> Iterator[Finding]:
    """What is damaged in the generated folder of the project at hand, else the shipped one."""
    here = Path("derivations").is_dir()
    folder = Path("generated") if here else systems_folder()
    problems = list(_tree("generated", folder, is_shipped=not here))
    yield from problems
    if not problems:
        yield Finding("generated", "ok", f"{folder}: unchanged since it was written")


def _tree(what: str, folder: Path, *, is_shipped: bool, reloads: bool = False) -> Iterator[Finding]:
    """Findings about a generated tree; one that ``reloads`` is regenerated with its spec."""
    from coadjoint.render.health import tree_problems

    try:
        for problem in tree_problems(folder, is_shipped=is_shipped):
            again = reloads and problem.regenerates
            status = "heals" if problem.heals or again else "failed"
            yield Finding(what, status, problem.found, _RELOAD if again else problem.remedy)
    except OSError as error:
        yield Finding(what, "failed", f"{folder} cannot be read: {error.strerror or error}")
