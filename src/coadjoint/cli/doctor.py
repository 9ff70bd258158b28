"""Command ``doctor``: what this machine has, what is missing, and how to get it.

Comes in: nothing. Goes out: a table of findings. A missing compiler or extra is a remark, since
everything works without; what is there and does not work is a failure, exit status 1.
"""

from __future__ import annotations

import ctypes
import platform
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
from coadjoint.cli.output import json_option, print_json, print_table
from coadjoint.errors import CoadjointError, CompilerError

PACKAGES: Final = (
    "sympy",
    "numpy",
    "scipy",
    "mpmath",
    "jinja2",
    "pydantic",
    "click",
    "rich",
)
#: Packages of each optional extra.
EXTRAS: Final = {"plot": ("matplotlib",), "data": ("xarray", "h5netcdf", "h5py"), "c": ("ziglang",)}

PROBE: Final = "int coadjoint_probe(void);\nint coadjoint_probe(void) { return 42; }\n"


@dataclass(frozen=True)
class Finding:
    """One line of the report.

    Attributes:
        what: What was looked at.
        status: ``ok``, ``missing`` (works without) or ``failed``.
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
    """Look for compiler, cache and packages.

    What is missing is shown with the way to get it; exit status 1 if something does not work.
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
    yield _attempt("compiler", _compiler)
    yield _attempt("C kernels", _kernels)
    yield _attempt("cache", _cache)
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
    found = {}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            return Finding(
                f"extra {extra}",
                "missing",
                f"{package} is not installed",
                f"pip install 'coadjoint[{extra}]'",
            )
    return Finding(f"extra {extra}", "ok", ", ".join(f"{n} {v}" for n, v in found.items()))


def _attempt(what: str, look: Callable[[], str]) -> Finding:
    """A finding of a function that may raise; its message says what to do."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return Finding(what, "ok", look())
    except CompilerError as error:
        # No compiler at all: the NumPy kernels do the same. One that is there and fails is a fault.
        status = "missing" if error.parts.get("found") == "" else "failed"
        return Finding(what, status, str(error), "NumPy kernels are used meanwhile")
    except (CoadjointError, UserWarning, OSError) as error:
        return Finding(what, "failed", str(error))


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
            f"a compiled kernel answered {answer}; expected 42. Set CC to another compiler.",
            found=str(answer),
        )
    return "compiled, loaded and called"


def _cache() -> str:
    """The cache folder and what it holds."""
    from coadjoint.build.cache import cache_folder

    folder = cache_folder()
    kernels = [path.stat().st_size for path in folder.glob("kernels/*.so")]
    systems = len(list(folder.glob("systems/*/manifest.json")))
    return f"{folder}: {len(kernels)} kernels, {sum(kernels) / 1e6:.1f} MB, {systems} own systems"
