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

#: Every target by the name of its folder.
TARGETS: Final[dict[str, Target]] = {
    folder: import_module(f"{__name__}.{folder}").TARGET for folder in FOLDERS
}
#: The target of each build, which is what a person gives as ``target=``.
BUILDS: Final = {build: target for target in TARGETS.values() for build in target.builds}
