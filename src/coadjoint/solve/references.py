"""References to a System: how one process names it and another finds the same.

Comes in: a System that is pickled, or a reference. Goes out: a reference of four texts, or the
System. The kernels do not travel: the other process loads them from the same files, or compiles
them. A reference names the id of these files, so that it never finds another system.
Read next: `coadjoint.solve.system`.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from coadjoint.errors import OutputError

if TYPE_CHECKING:
    from coadjoint.solve.system import System

#: Name, module (or ""), folder and id.
Reference = tuple[str, str, str, str]

#: The Systems of folders that were found in this process, so that two references find one object.
_found: WeakValueDictionary[Reference, System] = WeakValueDictionary()


def refer_to(system: System) -> Reference:
    """The reference to a System: by its module if it has one, else by its folder.

    Raises:
        OutputError: Its folder is gone, or holds another system by now.
    """
    module = next((name for name, held in list(sys.modules.items()) if _holds(held, system)), "")
    reference = (system.name, module, str(system.folder.resolve()), system.id)
    if not module:
        try:
            text = (system.folder / "__init__.py").read_text(encoding="utf-8")
        except OSError as error:
            raise _explain_gone(reference) from error
        if f"# id: {system.id}\n" not in text:
            raise _explain_other(reference, "another one")
        _found[reference] = system
    return reference


def find_system(name: str, module: str, folder: str, identity: str) -> System:
    """The System of a reference, in any process.

    Raises:
        OutputError: Its module or folder is gone, or holds another system by now.
    """
    from coadjoint.solve.folders import load_folder

    reference = (name, module, folder, identity)
    known = _found.get(reference)
    if known is not None:
        return known
    if not module and not (Path(folder) / "__init__.py").is_file():
        raise _explain_gone(reference)
    system = _import_system(name, module) if module else load_folder(Path(folder))
    if system.id != identity:
        raise _explain_other(reference, system.id)
    if not module:
        _found[reference] = system
    return system


def _holds(held: object, system: System) -> bool:
    """Whether a module can be imported by its name elsewhere and has the System as ``system``."""
    # its own names alone: to ask a lazy module for one may import others
    own = vars(held) if isinstance(held, ModuleType) else {}
    return own.get("system") is system and own.get("__name__") != "__main__"


def _import_system(name: str, module: str) -> System:
    """The System of a module.

    Raises:
        OutputError: It cannot be imported, or has none.
    """
    from coadjoint.solve.system import System

    try:
        system = import_module(module).__dict__.get("system")
    except ImportError as error:
        raise OutputError(
            f"the system {name!r} is that of the module {module}, which cannot be imported: "
            f"{error}. Install it here, or put its folder on the import path.",
            path=module,
        ) from error
    if not isinstance(system, System):
        raise OutputError(
            f"the module {module} holds no system; expected {name!r}. Run `coadjoint regenerate`.",
            path=module,
        )
    return system


def _explain_gone(reference: Reference) -> OutputError:
    """What to say of a folder that is not there."""
    name, _, folder, _ = reference
    return OutputError(
        f"the system {name!r} cannot be found: {folder} is gone. "
        "Load its spec again on this machine.",
        path=folder,
    )


def _explain_other(reference: Reference, found: str) -> OutputError:
    """What to say of files with another id."""
    name, module, folder, identity = reference
    return OutputError(
        f"the system {name!r} has changed: {module or folder} has the id {found}; expected "
        f"{identity}. Load it again, and make again what was pickled with it.",
        path=module or folder,
        found=found,
        expected=identity,
    )
