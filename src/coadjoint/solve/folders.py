"""Folders: the System of a generated folder, outside any package.

Comes in: a folder, or the texts of its files. Goes out: the System that its ``__init__.py`` makes.
Read next: `coadjoint.solve.system`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import MappingProxyType
from typing import Any

from coadjoint.errors import CoadjointError, OutputError, system_error
from coadjoint.solve.system import System


def load_folder(folder: Path) -> System:
    """The System of a generated folder outside any package.

    Raises:
        OutputError: The folder holds no generated system.
        ResourceError: Its members do not fit into memory.
    """
    spec = spec_from_file_location(f"_coadjoint_{folder.name}", folder / "__init__.py")
    try:
        module = _execute(folder, spec)
    except CoadjointError:  # as of members that do not fit into memory
        raise
    except Exception as error:
        raise system_error(error) or OutputError(
            f"{folder / '__init__.py'} cannot be loaded: {type(error).__name__}: {error}. "
            "Run `coadjoint regenerate`.",
            path=str(folder),
        ) from error
    if not isinstance(getattr(module, "system", None), System):
        raise OutputError(
            f"{folder} contains no generated system; expected an __init__.py written by "
            "`coadjoint regenerate`. Run it again.",
            path=str(folder),
        )
    return module.system  # type: ignore[no-any-return]


@contextmanager
def load_texts(
    texts: Mapping[str, str], levels: Mapping[tuple[str, str], int] = MappingProxyType({})
) -> Iterator[System]:
    """The System of generated files that are only texts yet, for the length of a block.

    Args:
        texts: The files by name.
        levels: How much compilers optimise, as in `System`.
    """
    from coadjoint.build.cache import working_folder

    with working_folder() as folder:
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        system = load_folder(folder)
        system.levels = levels
        yield system


def _execute(folder: Path, spec: ModuleSpec | None) -> Any:
    """Run a generated ``__init__.py`` without leaving bytecode next to it."""
    if spec is None or spec.loader is None or not (folder / "__init__.py").is_file():
        return None
    module = module_from_spec(spec)
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        spec.loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = before
    return module
