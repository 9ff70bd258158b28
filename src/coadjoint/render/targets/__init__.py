"""Targets: the languages that kernels are written in, a folder for each of them.

A folder holds templates, printer, reader, loader and reserved words, and its ``__init__.py`` makes
them one `Target`. For another language add a folder, and its name below. Importing this loads no
template, no NumPy and no compiler.
Read next: `coadjoint.render.targets.protocol`.
"""

from __future__ import annotations

from importlib import import_module
from typing import Final

from coadjoint.render.targets.protocol import Target

#: The folder of each target.
FOLDERS: Final = ("numpy", "c", "python")

#: The folder of each target whose files are rendered on demand, and stand in no generated folder.
ON_DEMAND: Final = ("js",)


def _import(folder: str) -> Target:
    """The target of a folder."""
    target: Target = import_module(f"{__name__}.{folder}").TARGET
    return target


#: Every target of a generated folder by the name of its own.
TARGETS: Final[dict[str, Target]] = {folder: _import(folder) for folder in FOLDERS}
#: The others.
OTHERS: Final[dict[str, Target]] = {folder: _import(folder) for folder in ON_DEMAND}
#: The target of each build, which is what a person gives as ``target=``.
BUILDS: Final = {build: target for target in TARGETS.values() for build in target.builds}
