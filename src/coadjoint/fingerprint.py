"""Fingerprints: what a generated system depends on, as one hash.

Comes in: the files of the engine and of a spec. Goes out: hexadecimal digests. Two equal
fingerprints mean the same engine, templates, dependencies and spec, hence the same output bytes; so
an unchanged system need not be derived again.
"""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

from coadjoint.resources import templates_folder

#: Packages whose version may move the output or its verification.
WATCHED = ("jinja2", "mpmath", "numpy", "sympy")

#: Folders that a wheel carries inside the package; what they hold is input or output.
NOT_ENGINE = ("derivations", "systems", "templates")


@cache
def engine_fingerprint() -> str:
    """Hash of the engine: its sources, its templates, and the versions it works with."""
    package = Path(__file__).parent
    files = {
        f"src/{path.relative_to(package).as_posix()}": _sha256(path)
        for path in sorted((*package.rglob("*.py"), *package.rglob("reserved.txt")))
        if path.relative_to(package).parts[0] not in NOT_ENGINE
    }
    versions = {name: version(name) for name in WATCHED} | {"python": platform.python_version()}
    return digest({"files": files | template_hashes(), "versions": versions})


def template_hashes() -> dict[str, str]:
    """SHA-256 of each template by its path below the templates folder."""
    folder = templates_folder()
    return {
        f"templates/{path.relative_to(folder).as_posix()}": _sha256(path)
        for path in sorted(folder.rglob("*.j2"))
    }


def digest(content: object) -> str:
    """SHA-256 of JSON values, independent of the order of keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
