"""The whole flow on one page: from a declared system to verified kernels. Read this first.

    spec file -> read_spec -> Spec          coadjoint.spec
              -> derive -> Equations        coadjoint.derive, one module per route
              -> lower -> Programs          coadjoint.lower, held to the limits of size
              -> prove -> Certificate       coadjoint.prove
              -> render_system -> texts     coadjoint.render, a folder of targets for each target
              -> System                     coadjoint.build and coadjoint.solve: compiled, loaded
              -> crosscheck -> Report       coadjoint.crosscheck

Comes in: a Spec. Goes out: the texts of its generated folder, proved and checked. Read next:
`coadjoint.regenerate`, which runs this for many systems and writes what passed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from coadjoint.crosscheck.ladder import Report, crosscheck
from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.reference import Reference
from coadjoint.lower.check import check_programs, check_sizes
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Program
from coadjoint.prove import Certificate, Verdict, prove
from coadjoint.prove.declaration import kernel_context
from coadjoint.prove.record import certificate_json
from coadjoint.render.kernels import render_system
from coadjoint.solve.system import load_texts
from coadjoint.spec import Spec

#: Called with the name of the stage that begins.
Progress = Callable[[str], None]
STAGES = ("derive", "lower", "prove", "render", "compile and cross-check")


@dataclass(frozen=True)
class Rendered:
    """The emitted route, what is proved of it, its functions, and its generated files by name."""

    equations: Equations
    certificate: Certificate
    programs: dict[str, Program]
    texts: dict[str, str]


def render(spec: Spec, progress: Progress = lambda stage: None) -> Rendered:
    """Derive, prove, lower and render: the exact rungs, each of which raises what it refuses."""
    progress("derive")
    setting = make_setting(spec)
    routes = [derive(spec, route, setting=setting) for route in spec.routes]
    first = routes[0]
    progress("lower")
    programs = lower(first)
    check_sizes(first, programs)  # a system that is too large is refused before it is proved
    progress("prove")
    certificate = prove(spec, routes).require()
    check_programs(first, programs)
    progress("render")
    context = kernel_context(first, programs, certificate.count(Verdict.SUPPORTED))
    texts = {**render_system(context), "certificate.json": certificate_json(spec, certificate)}
    return Rendered(first, certificate, programs, texts)


def verify(rendered: Rendered, progress: Progress = lambda stage: None) -> Report:
    """Compile, load and cross-check: the numeric rungs, each of which raises what it refuses."""
    progress("compile and cross-check")
    with load_texts(rendered.texts) as system:
        reference = Reference(rendered.equations)
        return crosscheck(rendered.programs, rendered.texts, reference, system)
