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

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from coadjoint.crosscheck.families import RenderedFamily, crosscheck_family
from coadjoint.crosscheck.ladder import LEVELS, WRITTEN_LEVELS, Report, crosscheck
from coadjoint.declared import KernelContext
from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.family_flows import split_family
from coadjoint.derive.fields.grid import Grid, make_grid
from coadjoint.derive.fields.torus import TorusGrid, make_torus
from coadjoint.derive.indexed import derive_family
from coadjoint.derive.motion import motion_sections
from coadjoint.derive.reference import Reference
from coadjoint.derive.splittings import Splitting
from coadjoint.lower.check import check_programs, check_sizes
from coadjoint.lower.families import lower_family
from coadjoint.lower.family_check import check_loops
from coadjoint.lower.lowering import lower
from coadjoint.lower.mapped import lower_maps
from coadjoint.lower.program import Program
from coadjoint.methods import JudgedMethod
from coadjoint.prove import Certificate, Verdict, prove
from coadjoint.prove.declaration import family_context, kernel_context, tell_fields, tell_torus
from coadjoint.prove.family_methods import judge_family
from coadjoint.prove.methods import judge_methods
from coadjoint.prove.record import certificate_json
from coadjoint.render.environment import compile_templates
from coadjoint.render.families import render_family
from coadjoint.render.kernels import render_system
from coadjoint.solve.folders import load_texts
from coadjoint.spec import Spec

#: Called with the name of the stage that begins.
Progress = Callable[[str], None]
STAGES = ("derive", "lower", "prove", "render", "compile and cross-check")


@dataclass(frozen=True)
class Rendered:
    """The emitted route, what is proved of it, its functions, its files by name, and its maps.

    Of a system that is no family also what the files say, and its methods of integration, judged.
    """

    equations: Equations
    certificate: Certificate
    programs: dict[str, Program]
    texts: dict[str, str]
    family: RenderedFamily | None = None
    maps: tuple[Program, ...] = ()
    context: KernelContext | None = None
    methods: tuple[JudgedMethod, ...] = ()

    @property
    def pair_operations(self) -> int:
        """Operations of a pair of equal members in ``rhs``; 0 without pairs."""
        pairs = None if self.family is None else self.family.context.loops["rhs"].partners
        return 0 if pairs is None else sum(pairs.program.operation_counts().values())


def render(spec: Spec, progress: Progress = lambda stage: None) -> Rendered:
    """Derive, prove, lower and render: the exact rungs, each of which raises what it refuses."""
    progress("derive")
    setting = make_setting(spec)
    routes = [derive(spec, route, setting=setting) for route in spec.routes]
    first = routes[0]
    if spec.family is not None or spec.space is not None:
        return _render_family(spec, routes, progress)
    progress("lower")
    programs = lower(first)
    check_sizes(first, programs)  # a system that is too large is refused before it is proved
    progress("prove")
    certificate = prove(spec, routes).require()
    check_programs(first, programs)
    progress("render")
    maps = lower_maps(first, programs["rhs"])
    facts, methods = judge_methods(first, certificate, programs, maps)
    context = kernel_context(first, programs, certificate.count(Verdict.SUPPORTED), maps, methods)
    record = certificate_json(spec, certificate, facts.as_record(), methods, motion_sections(first))
    texts = {**render_system(context), "certificate.json": record}
    return Rendered(
        equations=first,
        certificate=certificate,
        programs=programs,
        texts=texts,
        maps=maps.programs,
        context=context,
        methods=methods,
    )


def prepare() -> None:
    """What a process does once for all the systems that it works on."""
    compile_templates()


def _render_family(spec: Spec, routes: Sequence[Equations], progress: Progress) -> Rendered:
    """The same for a system of equal members, whose functions are loops over them.

    So are fields, at the points of a grid.
    """
    first = routes[0]
    grid: Grid | TorusGrid | None = None
    splittings: tuple[Splitting, ...] = ()
    if spec.space is not None:
        grid = make_torus(first) if spec.in_plane else make_grid(first)
        windows, declared, family = grid.windows, grid.declared, grid.family
    else:
        assert spec.family is not None, spec.name
        declared = spec.family
        windows = tuple(derive(each, spec.routes[0]) for each in declared.windows)
        family, splittings = split_family(first, derive_family(first), windows)
    progress("lower")
    loops = lower_family(family)
    progress("prove")
    certificate = prove(spec, list(routes)).require()
    check_loops(family, loops)
    progress("render")
    plane = [n for n, kept in grid.exact.items() if kept] if isinstance(grid, TorusGrid) else None
    over = "equal members" if grid is None else "points"
    given = (windows, declared, family, loops, certificate)
    facts, methods = judge_family(*given, over=over, in_plane=plane, splittings=splittings)
    supported = certificate.count(Verdict.SUPPORTED)
    own = first if grid is None else windows[-1]
    context = family_context(own, family, loops, supported, facts, methods)
    if isinstance(grid, TorusGrid):
        context = tell_torus(context, grid)
    elif grid is not None:
        context = tell_fields(context, grid)
    told = facts.as_record() | {"over": over}
    record = certificate_json(spec, certificate, told, methods, motion_sections(first))
    texts = {**render_family(context), "certificate.json": record}
    member = loops["rhs"].member
    assert member is not None, spec.name
    return Rendered(
        equations=first,
        certificate=certificate,
        programs={"rhs": replace(member.program, state=tuple(map(str, family.states)))},
        texts=texts,
        family=RenderedFamily(
            windows=windows,
            declared=declared,
            family=family,
            context=context,
            splittings=splittings,
        ),
    )


def verify(
    rendered: Rendered, progress: Progress = lambda stage: None, *, loads: bool = True
) -> Report:
    """Compile, load and cross-check: the numeric rungs, each of which raises what it refuses.

    Args:
        rendered: What `render` made.
        progress: Called with the name of the stage.
        loads: Whether the system is loaded next: its kernels are compiled as users run them.
    """
    progress("compile and cross-check")
    with load_texts(rendered.texts, LEVELS if loads else WRITTEN_LEVELS) as system:
        if (own := rendered.family) is not None:
            return crosscheck_family(own, rendered.texts, system)
        reference = Reference(rendered.equations)
        maps = rendered.maps
        return crosscheck(rendered.programs, rendered.texts, reference, system, maps=maps)
