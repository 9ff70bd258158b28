"""Render, templates: the strict Jinja environment of code and of pages.

Comes in: options of Jinja. Goes out: an environment. Templates are files of this package only,
never text of a spec; an undefined name is an error. Pages are made with this module alone, so that
a notebook shows a system without loading the targets of code.
Read next: `coadjoint.render.environment`, which adds the filters of code.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

from jinja2 import FileSystemLoader, StrictUndefined
from jinja2.compiler import CodeGenerator, Frame
from jinja2.sandbox import ImmutableSandboxedEnvironment

from coadjoint.resources import templates_folder


class _Generator(CodeGenerator):
    """Compiles a template, and notes the names that it takes from its context."""

    def enter_frame(self, frame: Frame) -> None:
        """As of the base."""
        super().enter_frame(frame)
        assert isinstance(self.environment, StrictEnvironment)
        for action, name in frame.symbols.loads.values():
            if action == "resolve" and name is not None and name not in self.environment.globals:
                self.environment.read[self.name].add(name)


class StrictEnvironment(ImmutableSandboxedEnvironment):
    """A sandbox that knows which names each template reads, once it has compiled it.

    `jinja2.meta` would compile each a second time, which took a quarter of a second a system.
    """

    code_generator_class = _Generator

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.read = defaultdict[str | None, set[str]](set)


def make_environment(**options: Any) -> StrictEnvironment:
    """An environment of our templates, in which an undefined name is an error.

    The sandbox is a second wall; the first is that specs are not templates.
    """
    return StrictEnvironment(
        loader=FileSystemLoader(templates_folder()),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        **options,
    )
