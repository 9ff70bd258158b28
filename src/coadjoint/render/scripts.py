"""Render, scripts: the kernels of one system in JavaScript, for a web page.

Comes in: what the generated files of a system say. Goes out: the text of ``kernel.js``, which no
generated folder holds. The flows of a splitting stand behind the kernel's functions.
Read next: `coadjoint.render.targets.js`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from coadjoint.declared import KernelContext
from coadjoint.lower.program import ZERO, Program
from coadjoint.render.environment import render_templates
from coadjoint.render.families import FamilyContext, render_family_template
from coadjoint.render.kernels import identify, list_called, rows_of, tell_licence
from coadjoint.render.targets import OTHERS

JS = OTHERS["js"]


def list_scripted(context: KernelContext) -> list[Program]:
    """The functions of the kernel, then the flows; sums over a table are written out."""
    programs = [*context.programs, *(each for each in context.maps if "flow" in each.name)]
    return [replace(each, table=None, factored=None) for each in programs]


def render_script(context: KernelContext) -> str:
    """The kernel of a system in JavaScript."""
    return identify(partial(_render, context))[JS.kernel]


def _render(context: KernelContext, identity: str) -> dict[str, str]:
    """The file, given the id."""
    programs = list_scripted(context)
    all_rows = [(each.name, list(enumerate(each.outputs))) for each in programs]
    values = {
        "name": context.name,
        "spec": context.spec,
        "licence": tell_licence(context.license),
        "id": identity,
        "state": rows_of(context.state),
        "parameters": rows_of(context.parameters),
        "programs": programs,
        "outputs": {name: [(n, v) for n, v in own if v.value != ZERO] for name, own in all_rows},
        "zeros": {name: any(each.value == ZERO for _, each in own) for name, own in all_rows},
        "called": list_called(programs),
        "solves": any(each.solves_by_loop for each in programs),
    }  # fmt: skip
    (template,) = JS.files.values()
    return {JS.kernel: render_templates((template,), values)[template]}


def render_family_script(context: FamilyContext) -> str:
    """The kernel of a system of equal members in JavaScript."""

    def render(identity: str) -> dict[str, str]:
        return {JS.kernel: render_family_template(context, "js/family.js.j2", "js", identity)}

    return identify(render)[JS.kernel]
