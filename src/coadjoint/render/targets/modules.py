"""Targets, modules: a kernel that is a Python file, executed once.

Comes in: a System and the name of a file in its folder. Goes out: its functions, or an error that
names the file. Read next: `coadjoint.render.targets.numpy.loader`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from types import CodeType, ModuleType
from typing import Any

from coadjoint.errors import OutputError, system_error
from coadjoint.render.targets.protocol import Generated, Kernel


@lru_cache(maxsize=64)
def _compile(content: bytes, path: str) -> CodeType:
    """The code of a file; each run of a simulation asks for that of its kernel."""
    return compile(content, path, "exec")


class KernelModule(Kernel):
    """The functions of a file.

    Args:
        system: Whose kernel it is.
        file: The file in its folder.

    Raises:
        OutputError: The file cannot be loaded, or carries another id than the System.
    """

    def __init__(self, system: Generated, file: str) -> None:
        self.path = system.folder / file
        module = ModuleType(f"_coadjoint_{system.name}_{self.path.stem}")
        try:
            content = self.path.read_bytes()
            exec(_compile(content, str(self.path)), module.__dict__)  # noqa: S102 (it is a module)
            identity = module.ID
        except Exception as error:
            raise system_error(error) or self.explain_broken(
                f"cannot be loaded: {type(error).__name__}: {error}"
            ) from error
        if identity != system.id:
            raise self.explain_broken(
                f"carries the id {identity!r}, its system {system.id!r}; expected one id",
                found=identity,
                expected=system.id,
            )
        self.text = content.decode()
        self.source = hashlib.sha256(content).hexdigest()
        self._module = module

    def function(self, name: str) -> Callable[..., Any]:
        """A function of the file.

        Raises:
            OutputError: It has none of this name.
        """
        function: Callable[..., Any] = self.value(name)
        return function

    def has(self, name: str) -> bool:
        """Whether the file has a name."""
        return hasattr(self._module, name)

    def value(self, name: str) -> Any:
        """What a name of the file stands for.

        Raises:
            OutputError: It has no such name.
        """
        if not self.has(name):
            raise self.explain_broken(f"has no function {name}")
        return getattr(self._module, name)

    def explain_broken(self, problem: str, **parts: Any) -> OutputError:
        """What is wrong with the file."""
        path = str(self.path)
        return OutputError(f"{path} {problem}. Run `coadjoint regenerate`.", path=path, **parts)
