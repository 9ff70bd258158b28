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
    """The folder of Jinja2 templates, one folder per language in it.

    >>> (templates_folder() / "numpy" / "kernel.py.j2").is_file()
    True
    """
    return _folder(installed="templates", checkout="templates")


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
    """The folder inside the installed package, or else beside ``src`` in a checkout."""
    package = Path(__file__).resolve().parent
    inside = package / installed
    return inside if inside.is_dir() else package.parents[1] / checkout
