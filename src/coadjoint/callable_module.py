"""Modules that can be called, for the two whose name is also that of their main function.

``coadjoint.derive`` is the folder of routes and, for users, the function; whichever of the two the
import system has bound to the name, ``coadjoint.derive(spec)`` works.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


def make_callable(module: str, function: str) -> None:
    """Let calls of a module go to one of its functions.

    Args:
        module: Full name of a module that is being imported.
        function: Name of the function in it.
    """

    class Callable(ModuleType):
        def __call__(self, *arguments: Any, **options: Any) -> Any:
            return getattr(self, function)(*arguments, **options)

    sys.modules[module].__class__ = Callable
