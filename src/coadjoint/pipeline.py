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
from dataclasses import dataclass, replace
from typing import Any

from coadjoint.build.cache import working_folder
from coadjoint.crosscheck.ladder import Report, crosscheck
from coadjoint.derive import Equations, derive, make_setting
from coadjoint.derive.document import equation_lines
from coadjoint.derive.domain import bounds
from coadjoint.derive.reference import Reference
from coadjoint.derive.setting import Declared
from coadjoint.exact import Element
from coadjoint.lower.check import check_inverse, check_size
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Program
from coadjoint.prove import Certificate, Verdict, prove
from coadjoint.prove.driven import while_constant
from coadjoint.prove.energy import keeps_energy
from coadjoint.render.kernels import Bound, KernelContext, Quantity, render_system
from coadjoint.solve.system import load_folder
from coadjoint.spec import Formula, Spec, Variable
from coadjoint.spec.core.units import Unit, parse_unit, product_of, unit_of, unit_text
from coadjoint.spec.model import Constraint, Reconstructed, Shape, component_names

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
        observables=_observables(equations),
        programs=tuple(programs.values()),
        supported=supported,
        reconstructed=tuple(_followed(spec, each) for each in spec.reconstruction),
        inputs=tuple(map(_quantity, spec.inputs)),
        time=tuple(map(_quantity, [] if spec.time is None else [spec.time])),
        domain=tuple(
            Bound(each.name, each.kind, each.strict, each.inputs) for each in bounds(equations)
        ),
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


def _observables(equations: Equations) -> tuple[Quantity, ...]:
    """What the function ``observables`` returns, in the order of `coadjoint.derive.observables`."""
    spec, found = equations.spec, equations.setting.integrals
    stated = {claim.name for claim in spec.conserved}
    energy = [
        _emitted("energy", _unit(spec, formula), conserved=keeps_energy(equations))
        for formula in (spec.hamiltonian or spec.lagrangian,)
        if equations.exact.energy is not None
    ]
    casimirs = [
        _emitted(
            f"casimir{n}",
            _unit(spec, casimir),
            casimir.shape,
            conserved=all(
                equations.setting.field.is_zero(equations.work(part))
                for part in equations.setting.components(casimir)
            ),
        )
        for n, casimir in enumerate(spec.casimirs, 1)
    ]
    declared = [
        _emitted(entry.name, entry.unit, entry.shape, conserved=entry.name in stated)
        for entry in spec.observables
    ]
    maps = [
        Quantity(each.name, each.shape, each.unit, each.components, conserved=each.name in stated)
        for each in spec.symmetries
    ]
    of_pair = [
        _emitted(name, _unit_of_value(equations, value), conserved=True)
        for name, value in (found.named if found is not None else ())
    ]
    of_space = [
        Quantity(
            each.name,
            each.momentum.shape,
            each.momentum.unit,
            each.components,
            conserved=each.conserved,
        )
        for each in spec.spatial
    ]
    velocities = map(_quantity, spec.defined)
    reactions = [
        _emitted(each.reaction, _unit_of_reaction(spec, each), each.shape, conserved=False)
        for each in spec.constraints
    ]
    momenta = [
        Quantity(each.name, each.velocity.shape, _unit_along(spec, each.velocity), each.components)
        for each in spec.reduced_momenta
    ]
    momenta += [
        _emitted(each.name, each.unit, conserved=each.name in stated) for each in spec.sections
    ]
    emitted = (
        *energy,
        *casimirs,
        *velocities,
        *reactions,
        *momenta,
        *declared,
        *maps,
        *of_pair,
        *of_space,
    )
    return tuple(_held(equations, each) if each.conserved else each for each in emitted)


def _held(equations: Equations, quantity: Quantity) -> Quantity:
    """A conserved quantity, marked if it is one only while the inputs are constant."""
    values = dict(equations.exact.observables)
    named = [values[name] for name in quantity.components if name in values]
    return replace(quantity, while_constant=bool(while_constant(equations, named)))


def _emitted(name: str, unit: str, shape: Shape = (), *, conserved: bool) -> Quantity:
    return Quantity(name, shape, unit, component_names(name, shape), conserved=conserved)


def _unit(spec: Spec, formula: Formula | None) -> str:
    """The unit of a formula, as far as the declared units tell."""
    assert formula is not None, "the reader asks for a Lagrangian or a Hamiltonian"
    return unit_text(unit_of(formula.tree, _units(spec)))


def _unit_of_reaction(spec: Spec, constraint: Constraint) -> str:
    """The unit of a multiplier: with the residual of its constraint it makes a power."""
    units, energy = _units(spec), spec.lagrangian
    assert energy is not None, "the reader asks for a Lagrangian beside constraints"
    known = {
        "energy": unit_of(energy.tree, units),
        "time": parse_unit("s"),
        "residual": unit_of(constraint.left.tree, units) or unit_of(constraint.right.tree, units),
    }
    return unit_text(product_of(known, [("energy", 1), ("time", -1), ("residual", -1)]))


def _unit_along(spec: Spec, velocity: Variable) -> str:
    """The unit of a momentum: that of the Lagrangian over that of its velocity."""
    assert spec.lagrangian is not None, "the reader asks for a Lagrangian"
    units = {"l": unit_of(spec.lagrangian.tree, _units(spec)), "v": parse_unit(velocity.unit)}
    return unit_text(product_of(units, [("l", 1), ("v", -1)]))


def _unit_of_value(equations: Equations, element: Element) -> str:
    """The unit of an element, as its first addend tells it."""
    field, units = equations.setting.field, _units(equations.spec)
    written = field.quotients(field.terms(element)[0])[0]
    factors = [power for monomial in written.monomials for power in monomial.powers]
    if written.divisors or not all(name in units for name, _ in factors):
        return ""
    return unit_text(product_of(units, factors))


def _units(spec: Spec) -> dict[str, Unit | None]:
    """The unit of every declared name."""
    quantities: Sequence[Declared] = (*spec.variables, *spec.parameters, *spec.driving)
    return {
        name: parse_unit(quantity.unit)
        for quantity in quantities
        for name in (quantity.name, *quantity.components)
    }


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
