"""Where the folders that travel with the package stand: templates, specs, generated systems.

Comes in: nothing. Goes out: three paths. A wheel carries the folders inside the package; in a
source checkout, and so in an editable install or a copied tree, they stand two levels above it.
The place is found from this file and never from the import path, so that a copied tree uses its
own templates.
Read next: `coadjoint.render.environment`.
"""

from __future__ import annotations

from pathlib import Path


def templates_folder() -> Path:
    """The folder of Jinja2 templates: one folder for each target, the package and documents.

    >>> (templates_folder() / "c" / "kernel.c.j2").is_file()
    True
    """
    return _folder(installed="templates", checkout="templates")


def targets_folder() -> Path:
    """The folder of targets, each with its reserved words in a folder of its own.

    >>> (targets_folder() / "c" / "reserved.txt").is_file()
    True
    """
    return Path(__file__).resolve().parent / "render" / "targets"


def reserved_words() -> dict[str, str]:
    """Words that some target reserves, each with what it is there: ``a keyword of C``.

    In the files ``reserved.txt`` of targets, words stand below a line that says what they are.

    >>> reserved_words()["restrict"]
    'a keyword of C'
    """
    words: dict[str, str] = {}
    for path in sorted(targets_folder().glob("*/reserved.txt")):
        kind = ""
        for line in path.read_text(encoding="ascii").splitlines():
            if line.startswith("# "):
                kind = line.removeprefix("# ")
            else:
                words |= {word: kind for word in line.split() if word not in words}
    return words


def derivations_folder() -> Path:
    """The folder of shipped specs.

    >>> derivations_folder().is_dir()
    True
    """
    return _folder(installed="derivations", checkout="derivations")


def systems_folder() -> Path:
    """The folder of generated systems and their manifest.

    >>> systems_folder().is_dir()
    True
    """
    return _folder(installed="systems", checkout="generated")


def _folder(installed: str, checkout: str) -> Path:
    """The folder inside the installed package, or else next to ``src`` in a checkout."""
    package = Path(__file__).resolve().parent
    inside = package / installed
    return inside if inside.is_dir() else package.parents[1] / checkout
