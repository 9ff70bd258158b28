"""Copies of the source tree in which tests change files, and commands run on them."""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]


def folder_until_exit() -> Path:
    """A folder for what a process makes once for all of its tests; it goes when that ends."""
    folder = Path(tempfile.mkdtemp(prefix="coadjoint-test-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def copy_source(folder: Path, *systems: str) -> Path:
    """A checkout with the engine, the templates, and the specs of some systems."""
    for name in ("src", "templates"):
        shutil.copytree(ROOT / name, folder / name)
    (folder / "derivations").mkdir()
    for system in systems:
        shutil.copy(ROOT / "derivations" / f"{system}.toml", folder / "derivations")
    return folder


def environment(folder: Path) -> dict[str, str]:
    """Variables with which a copied tree's own engine runs, with a cache of its own."""
    return {
        **os.environ,
        "PYTHONPATH": str(folder / "src"),
        "COADJOINT_CACHE": str(folder / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def coadjoint(folder: Path, *arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    """A command of a copied tree, run in it."""
    return subprocess.run(
        [sys.executable, "-m", "coadjoint.cli", *arguments],
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        check=False,
        **options,
    )


def tree(folder: Path) -> dict[str, bytes]:
    """Every file below a folder but the lock and bytecode."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock" and "__pycache__" not in path.parts
    }
