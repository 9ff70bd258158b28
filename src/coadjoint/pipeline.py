"""The whole flow on one page: from a declared system to verified kernels. Read this first.

    spec file -> read_spec -> Spec          coadjoint.spec
              -> derive -> Equations        coadjoint.derive, one module per route
              -> prove -> Certificate       coadjoint.prove
              -> lower -> Programs          coadjoint.lower
              -> render_system -> texts     coadjoint.render and templates/
              -> System                     coadjoint.build and coadjoint.solve: compiled, loaded
              -> crosscheck -> Report       coadjoint.crosscheck

Comes in: a Spec. Goes out: the texts of its generated folder, proved and checked; they are written
elsewhere. Read next: `coadjoint.regenerate`, which runs this for many systems in bounded children
and writes what passed.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from coadjoint.build.cache import working_folder
from coadjoint.crosscheck.ladder import Report, crosscheck
from coadjoint.declared import Quantity
from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.document import equation_lines
from coadjoint.derive.domain import bounds
from coadjoint.derive.records import Emitted
from coadjoint.derive.reference import Reference
from coadjoint.derive.setting import Declared
from coadjoint.lower.check import check_inverse, check_size
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Program
from coadjoint.prove import Certificate, Verdict, prove
from coadjoint.prove.driven import while_constant
from coadjoint.prove.energy import is_conserved
from coadjoint.render.kernels import KernelContext, render_system
from coadjoint.solve.system import load_folder
from coadjoint.spec import Spec
from coadjoint.spec.model import Reconstructed

#: Called with the name of the stage that begins.
Progress = Callable[[str], None]
STAGES = ("derive", "prove", "lower", "render", "compile and cross-check")


@dataclass(frozen=True)
class Rendered:
    """A system as text, with everything that can be proved without running it.

    Attributes:
        equations: The emitted route.
        certificate: What was proved about it.
        programs: Its functions.
        texts: Text of each file of its generated folder.
    """

    equations: Equations
    certificate: Certificate
    programs: dict[str, Program]
    texts: dict[str, str]


def render(spec: Spec, progress: Progress = lambda stage: None) -> Rendered:
    """Derive, prove, lower and render one system: the exact rungs.

    Raises:
        DerivationError: A route cannot be followed.
        ClaimError: A claim is false; the message shows where.
        CrossCheckError: Lowering changed a value.
    """
    progress("derive")
    setting = make_setting(spec)
    routes = [derive(spec, route, setting=setting) for route in spec.routes]
    first = routes[0]
    progress("prove")
    certificate = prove(spec, routes).require()
    progress("lower")
    programs = lower(first)
    for program in programs.values():
        check_size(first, program)
        check_inverse(first, program)
    progress("render")
    extra = {"certificate.json": certificate_json(spec, certificate)}
    supported = certificate.count(Verdict.SUPPORTED)
    texts = render_system(kernel_context(first, programs, supported), extra)
    return Rendered(first, certificate, programs, texts)


def verify(rendered: Rendered, progress: Progress = lambda stage: None) -> Report:
    """Compile, load and cross-check a rendered system: the numeric rungs.

    Args:
        rendered: What `render` returned.
        progress: Told of each stage.

    Raises:
        CompilerError: The compiler failed.
        CrossCheckError: Two forms of one function disagree.
    """
    progress("compile and cross-check")
    with working_folder() as folder:
        for name, text in rendered.texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        system = load_folder(folder)
        reference = Reference(rendered.equations)
        return crosscheck(rendered.programs, rendered.texts, reference, system)


def kernel_context(
    equations: Equations, programs: dict[str, Program], supported: int = 0
) -> KernelContext:
    """What the generated files of a system say; of a spec's free text, nothing.

    Args:
        equations: The emitted route.
        programs: Its functions.
        supported: How many claims are numerically supported and not proved.
    """
    spec = equations.spec
    first, *others = spec.routes
    proved = [f"Proved equal to the route {route}." for route in others]
    return KernelContext(
        name=spec.name,
        spec=f"derivations/{spec.name}.toml",
        spec_sha256=spec.sha256,
        license=spec.license,
        routes=(f"Route {first} {_origin(spec)}.", *proved),
        equations=equation_lines(equations),
        state=tuple(map(_quantity, spec.state)),
        parameters=tuple(map(_quantity, spec.parameters)),
        observables=tuple(_observable(equations, each) for each in equations.exact.emitted),
        programs=tuple(programs.values()),
        supported=supported,
        reconstructed=tuple(_followed(spec, each) for each in spec.reconstruction),
        inputs=tuple(map(_quantity, spec.inputs)),
        time=tuple(map(_quantity, [] if spec.time is None else [spec.time])),
        domain=tuple(bound for bound, _ in bounds(equations)),
    )


def _origin(spec: Spec) -> str:
    """Where the bracket of a system comes from, for the head of its files."""
    if spec.algebra is not None:
        return f"on {spec.algebra.name}, {spec.invariance} invariant"
    if spec.reduction is not None:
        return f"{_origin(spec.reduction.whole)}, restricted"
    if spec.poisson is None:
        return "on the space of " + ", ".join(q.name for q in spec.having_role("coordinate"))
    return {
        "nambu": "with the Nambu bracket of its distinguished functions",
        "brackets": "with the declared brackets",
        "canonical": "with the canonical bracket",
    }[spec.poisson.kind]


def _quantity(declared: Declared) -> Quantity:
    """What is declared as the generated package declares it."""
    default = getattr(declared, "default", None)
    return Quantity(
        declared.name,
        declared.shape,
        declared.unit,
        declared.components,
        None if default is None else tuple(map(float, default)),
        getattr(declared, "positive", False),
    )


def _followed(spec: Spec, each: Reconstructed) -> Quantity:
    """What is reconstructed as the generated package declares it."""
    upright = spec.rolling.normal if spec.rolling and each.attitude and each.of_rolling else ""
    default = None if each.default is None else tuple(map(float, each.default))
    return Quantity(each.name, each.shape, each.unit, each.components, default, upright=upright)


def _observable(equations: Equations, each: Emitted) -> Quantity:
    """What is emitted as the generated package declares it."""
    conserved = is_conserved(equations, each)
    held = conserved and while_constant(equations, each.values)
    return Quantity(
        name=each.name,
        shape=each.shape,
        unit=each.unit,
        components=each.components,
        conserved=conserved,
        while_constant=bool(held),
    )


def certificate_json(spec: Spec, certificate: Certificate) -> str:
    """The certificate with the spec's free text, for programs and documents."""
    quantities: Sequence[Declared] = (*spec.variables, *spec.parameters, *spec.driving)
    record: dict[str, Any] = {
        "title": spec.title,
        "source": spec.source,
        "description": spec.description,
        "docs": {quantity.name: quantity.doc for quantity in quantities if quantity.doc}
        | {entry.name: entry.doc for entry in spec.observables if entry.doc}
        | {entry.name: entry.doc for entry in spec.symmetries if entry.doc}
        | {entry.name: entry.doc for entry in spec.reconstruction if entry.doc},
        "casimirs": [formula.in_one_line for formula in spec.casimirs],
        "routes": list(spec.routes),
        "claims": certificate.as_record()["claims"],
        "findings": certificate.as_record()["findings"],
    }
    if spec.definitions:  # the texts of casimirs and claims may hold them
        record["definitions"] = {d.signature: d.in_one_line for d in spec.definitions}
    if spec.constraints:  # in the order of the rows of the function constraint_residual
        record["constraints"] = {
            name: each.in_one_line for each in spec.constraints for name in each.components
        }
    if spec.domain:  # generated code names conditions; their text stands here
        record["domain"] = {condition.name: condition.in_one_line for condition in spec.domain}
    return json.dumps(record, indent=2, ensure_ascii=True) + "\n"
