"""Render, families: loops over the members of a family as the templates of each target read them.

Comes in: the `Loops` of a family's functions. Goes out: files. Read next:
`coadjoint.render.family_parts`, which has functions in the words of a target.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Final

from coadjoint.declared import CLOCK, Quantity
from coadjoint.families import (
    LANES,
    Connection,
    Index,
    PrincipalSymbol,
    Spectral,
    Torus,
    WrittenProfiles,
)
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.lower import normals
from coadjoint.lower.bands import find_bands
from coadjoint.lower.compositions import COMPOSITIONS, list_schedules
from coadjoint.lower.loops import FEWEST, Loops
from coadjoint.lower.program import Program
from coadjoint.lower.tableau import dop853
from coadjoint.methods import BY_ENERGY, MAPPED, NOISY, STRUCTURED, JudgedMethod
from coadjoint.render.environment import names_read, render_templates
from coadjoint.render.family_parts import arrange_loops
from coadjoint.render.family_solvers import Counts, arrange_family
from coadjoint.render.kernels import (
    declaration,
    elementary_functions,
    identify,
    list_called,
    note_unproved,
    quote,
    rows_of,
    tell_licence,
    tuple_text,
    wrap,
)
from coadjoint.render.solvers import list_normals
from coadjoint.render.tables import fill
from coadjoint.solve.methods import krylov, spherical_midpoint
from coadjoint.solve.methods.discrete_gradient import GRADIENTS
from coadjoint.solve.methods.lie_poisson import STOPPING


@dataclass(frozen=True)
class FamilyContext:
    """All that the generated files of a family say.

    Attributes:
        name: Name of the system, the prefix of its C functions.
        spec: Path of the spec for readers, relative.
        license: SPDX expression of the spec's licence, or "".
        routes: How the equations were derived, one line each.
        equations: The equations of the generic member, one line each.
        index: The index, and how many members there are if nothing else is said.
        small: The fewest members for which the equations hold.
        state: Quantities of a member, in order.
        shared: Quantities of the parameters that members share, in order.
        indexed: Quantities of the parameters of a member, in order.
        observables: Quantities that the function ``observables`` returns, in order.
        loops: The functions by name.
        defaults: Of quantities that differ from member to member: component after component
            a number for each of the members of the declared size, or of some that repeat.
        repeating: Names of the quantities of which they repeat.
        supported: How many claims are numerically supported and not proved.
        unit_of_time: The unit of the time.
        clock: Symbol and name of the independent variable.
        time: The time, if the functions take it.
        shared_inputs: Quantities of the inputs that members share, in order.
        indexed_inputs: Quantities of the inputs of a member, in order.
        shared_noise: Wiener processes that move all members, in order.
        indexed_noise: Those of each member, in order.
        methods: Methods that keep structure and apply, as they are judged.
        spheres: The components of a member that are a vector on a sphere, by the name of the square
            of its radius.
        positions: Those that are positions, where the energy is ``T(p) + V(q)``.
        kinks: What is zero at the kinks of member i, and of those at the ends by their places.
        pair_kinks: What is zero at the kinks of the terms of pairs.
        connections: What has transports and a holonomy around the circle.
        spectral: Of fields, what is computed where derivatives are those of Fourier series.
        symbol: Of fields, their principal symbol.
        torus: Of a field in a plane, what is computed around its points.
        wave: Of a field that is carried by itself, the speed of its waves and the name of the
            length of its circle; empty for others.
    """

    name: str
    spec: str
    license: str
    routes: tuple[str, ...]
    equations: tuple[str, ...]
    index: Index
    small: int
    state: tuple[Quantity, ...]
    shared: tuple[Quantity, ...]
    indexed: tuple[Quantity, ...]
    observables: tuple[Quantity, ...]
    loops: dict[str, Loops]
    defaults: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    repeating: tuple[str, ...] = ()
    supported: int = 0
    unit_of_time: str = "s"
    clock: tuple[str, str] = CLOCK
    time: tuple[Quantity, ...] = ()
    shared_inputs: tuple[Quantity, ...] = ()
    indexed_inputs: tuple[Quantity, ...] = ()
    shared_noise: tuple[Quantity, ...] = ()
    indexed_noise: tuple[Quantity, ...] = ()
    methods: tuple[JudgedMethod, ...] = ()
    spheres: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    positions: tuple[int, ...] = ()
    kinks: Mapping[int | None, tuple[str, ...]] = field(default_factory=dict)
    pair_kinks: tuple[str, ...] = ()
    connections: tuple[Connection, ...] = ()
    wave: tuple[str, ...] = ()
    spectral: Spectral | None = None
    symbol: PrincipalSymbol | None = None
    torus: Torus | None = None
    profiles: WrittenProfiles | None = None

    @property
    def held(self) -> Loops:
        """The rates as solvers integrate them: with given signs where there are kinks."""
        return self.loops.get("sided_rhs", self.loops["rhs"])

    @property
    def counts(self) -> Counts:
        """How many rows of parameters there are, and of what drives members."""
        groups = (self.shared, self.indexed, self.shared_inputs, self.indexed_inputs)
        rows = (sum(len(each.components) for each in group) for group in groups)
        shared, indexed, inputs_before, inputs = rows
        return Counts(
            shared=shared,
            indexed=indexed,
            inputs_before=inputs_before,
            inputs=inputs,
            time=len(self.time),
        )


#: Template of each file of a family, and the target in whose words it says where names are read.
FAMILY_FILES: Final = {
    "__init__.py": ("package/family.py.j2", "numpy"),
    "__main__.py": ("package/__main__.py.j2", "numpy"),
    "kernel.py": ("numpy/family.py.j2", "numpy"),
    "kernel.c": ("c/family.c.j2", "c"),
    "kernel.h": ("c/family.h.j2", "c"),
    "solver.c": ("c/family_solver.c.j2", "c"),
    "solver.h": ("c/family_solver.h.j2", "c"),
    "solver.py": ("numpy/family_solver.py.j2", "numpy"),
    "kernel_python.py": ("python/family_python.py.j2", "python"),
}


def render_family(context: FamilyContext) -> dict[str, str]:
    """The kernels of the generated folder of a family and the package that declares them."""

    def render(identity: str) -> dict[str, str]:
        return {
            file: render_family_template(context, template, target, identity)
            for file, (template, target) in FAMILY_FILES.items()
            if context.torus is None or not file.startswith("solver")  # Python leads its steps
        }

    return identify(render)


def render_family_template(
    context: FamilyContext, template: str, target: str, identity: str
) -> str:
    """One file, given the id."""
    parts = [part for loops in context.loops.values() for part in loops.parts]
    programs = [part.program for part in parts]
    elementary, by_flows = _list_elementary(context)
    shared, table = rows_of(context.shared), dop853()
    indexed = rows_of(context.indexed, len(shared))
    shared_inputs = rows_of(context.shared_inputs)
    has_inputs = context.shared_inputs or context.indexed_inputs
    inputs, time = ", inputs" if has_inputs else "", ", time" if context.time else ""
    values: dict[str, Any] = {
        "name": context.name,
        "spec": context.spec,
        "licence": tell_licence(context.license),
        "id": identity,
        "lanes": LANES,
        "solves": any(loops.solve for loops in context.loops.values()),
        "level": any(loops.solve and loops.solve.level for loops in context.loops.values()),
        "surface": context.index.surface,
        "multiplies": any(loops.products for loops in context.loops.values()),
        "turns": "projection" in context.loops,
        "fewest": FEWEST,
        "inputs": inputs,
        "time": time,
        "driving": inputs + time,
        "noise": bool(context.shared_noise or context.indexed_noise),
        "counted": any(r.array == "sizes" for p in parts for r in p.reads),
        "input_rows": shared_inputs,
        "indexed_input_rows": rows_of(context.indexed_inputs, len(shared_inputs)),
        "routes": wrap([*context.routes, *note_unproved(context.supported)]),
        "equations": wrap(context.equations),
        "state": rows_of(context.state),
        "parameters": shared,
        "indexed": indexed,
        "called": list_called(programs),
        "elementary": tuple_text(map(quote, elementary)),
        "functions": [
            arrange_loops(loops, target, tell_summary(loops), count_costs(loops))
            for loops in context.loops.values()
        ],
        "declared": {
            "STATE": list(map(declaration, context.state)),
            "SHARED": list(map(declaration, context.shared)),
            "INDEXED": list(map(declaration, context.indexed)),
            "OBSERVABLES": list(map(declaration, context.observables)),
            **_declare_driving(context),
        },
        "shapes": [
            f"{quote(name)}: {tell_shape(loops, context)}" for name, loops in context.loops.items()
        ],
        "system": [
            quote(context.name),
            "__file__",
            "INDEX",
            *("STATE", "SHARED", "INDEXED", "OBSERVABLES", "FUNCTIONS", "ELEMENTARY"),
            quote(identity),
            *([f"unit_of_time={quote(context.unit_of_time)}"] * (context.unit_of_time != "s")),
            *([f"clock={tuple_text(map(quote, context.clock))}"] * (context.clock != CLOCK)),
            *(f"{name.lower()}={name}" for name in _declare_driving(context)),
            *(["methods=METHODS"] * bool(context.methods)),
            *(["kinks=KINKS"] * bool(context.kinks)),
            *(
                [f"pair_kinks={tuple_text(map(quote, context.pair_kinks))}"]
                * bool(context.pair_kinks)
            ),
            *([f"wave={tuple_text(map(quote, context.wave))}"] * bool(context.wave)),
            *([f"spheres={_tell_spheres(context)}"] * bool(context.spheres)),
            *([f"positions={context.positions}"] * bool(context.positions)),
            *([f"called_by_flows={tuple_text(map(quote, by_flows))}"] * bool(by_flows)),
            *(["connections=CONNECTIONS"] * bool(context.connections)),
            *(["spectral=SPECTRAL"] * bool(context.spectral)),
            *(["symbol=SYMBOL"] * bool(context.symbol)),
            *(["torus=TORUS"] * bool(context.torus)),
            *(["profiles=PROFILES"] * bool(context.profiles)),
            *(["defaults=DEFAULTS"] * bool(context.defaults and not context.profiles)),
            *([f"repeating={tuple_text(map(quote, context.repeating))}"] * bool(context.repeating)),
        ],
        "methods": list(map(declaration, context.methods)),
        "kinks": {place: tuple_text(map(quote, own)) for place, own in context.kinks.items()},
        "connections": list(map(_tell_connection, context.connections)),
        "spectral": _tell_texts(context.spectral),
        "symbol": _tell_texts(context.symbol),
        "torus": _tell_texts(context.torus),
        "steps": describe_steps(context),
        "defaults": {}
        if context.profiles
        else {quote(n): fill(map(repr, own)) for n, own in context.defaults.items()},
        "profiles": _tell_profiles(context.profiles),
        "dop853": {each.name: fill(map(repr, getattr(table, each.name))) for each in fields(table)},
        "index": (
            f"Index({quote(context.index.name)}, {context.index.size}, "
            f"periodic={context.index.periodic}{_tell_surface(context.index)}), "
            f"{context.small}"
        ),
    }
    names = names_read(template)
    if "solver" in names:
        values["solver"] = arrange_family(context.held, context.counts)
    if "normals" in names:
        values |= {"normals": list_normals(), "sweeps": normals.SWEEPS}
    return render_templates((template,), {name: values[name] for name in names})[template]


def _list_elementary(context: FamilyContext) -> tuple[tuple[str, ...], list[str]]:
    """What functions but flows call beyond ``+ - * / sqrt``, and what flows call in addition."""
    parts: dict[bool, list[Program]] = {False: [], True: []}
    for name, loops in context.loops.items():
        parts[name.startswith("flow")] += [part.program for part in loops.parts]
    others, flows = (elementary_functions(parts[is_flow]) for is_flow in (False, True))
    return others, [name for name in flows if name not in others]


def _declare_driving(context: FamilyContext) -> dict[str, list[list[str]]]:
    """What drives the members, by its names in the package, as far as there is any."""
    groups = {
        "SHARED_INPUTS": context.shared_inputs,
        "INDEXED_INPUTS": context.indexed_inputs,
        "TIME": context.time,
        "SHARED_NOISE": context.shared_noise,
        "INDEXED_NOISE": context.indexed_noise,
    }
    return {name: list(map(declaration, group)) for name, group in groups.items() if group}


def describe_steps(context: FamilyContext) -> dict[str, Any]:
    """What the solver in C reads of methods that keep structure."""
    every = {**STRUCTURED, **MAPPED}
    led_by_python = context.torus is not None
    is_noisy = bool(context.shared_noise or context.indexed_noise)
    own = [] if led_by_python or is_noisy else [every[each.name] for each in context.methods]
    implicit = [each for each in own if each.name in STRUCTURED]
    flows = [name for name in context.loops if name.startswith("flow")]
    places = {name: n for n, name in enumerate(flows or ("flow1", "flow2"))}
    schedules = list_schedules(places)
    count = sum(len(each.components) for each in context.state)
    return {
        "methods": [NOISY[each.name] for each in context.methods] if is_noisy else own,
        "names": {each.macro: (each.file, each.order) for each in implicit},
        "stages": {
            order: list(map(repr, COMPOSITIONS[order]))
            for order in sorted({each.order for each in implicit})
        },
        "spheres": [] if is_noisy else [rows[0] for rows in context.spheres.values()],
        "matrices": any(loops.products for loops in context.loops.values()),
        "schedules": {
            each.macro: [(places[flow], repr(part)) for flow, part in schedules[each.name]]
            for each in own
            if each.name in MAPPED
        },
        "flows": flows,
        "positions": [int(n in context.positions) for n in range(count)],
        "sweeps": normals.SWEEPS,
        "stopping": STOPPING,
        "bands": find_bands(context.loops["jacobian_vector"]) if implicit else None,
        "krylov": {name: getattr(krylov, name) for name in ("MOST", "LEAST", "SUMS")},
        "near": spherical_midpoint.NEAR,
        "roundings": spherical_midpoint.ROUNDINGS,
        "acts": "energy_gradient" in context.loops,
        "gradients": GRADIENTS if any(each.file in BY_ENERGY for each in implicit) else None,
    }


def _tell_surface(index: Index) -> str:
    """On what matrices stand for functions, as a generated package declares it."""
    return f", surface={quote(index.surface)}" if index.surface else ""


def _tell_spheres(context: FamilyContext) -> str:
    """The vectors on spheres, as a generated package declares them."""
    entries = (f"{quote(name)}: {rows}" for name, rows in context.spheres.items())
    return "{" + ", ".join(entries) + "}"


def _tell_connection(connection: Connection) -> list[str]:
    """A connection, as a generated package declares it."""
    names = map(quote, (connection.name, connection.side, connection.length))
    tables = [
        "{" + ", ".join(f"{place}: {quote(text)}" for place, text in entries.items()) + "}"
        for entries in (connection.entries, connection.velocity)
    ]
    ends = ["True"] * connection.has_ends
    velocity = [f"velocity={tables[1]}"] if connection.velocity else []
    return [*names, str(connection.size), tables[0], *ends, *velocity]


def _tell_texts(record: Spectral | PrincipalSymbol | Torus | None) -> dict[str, Any]:
    """A record with texts of fields, as a generated package declares it; empty without."""

    def tell(value: Any) -> str:
        match value:
            case str():
                return quote(value)
            case tuple():
                return f"({', '.join(map(tell, value))})"
            case Mapping():
                return "{" + ", ".join(f"{tell(k)}: {tell(x)}" for k, x in value.items()) + "}"
        return repr(value)

    return {
        name: {tell(k): tell(x) for k, x in value.items()}
        if isinstance(value, Mapping)
        else tell(value)
        for name, value in ({} if record is None else vars(record)).items()
    }


def _tell_profiles(profiles: WrittenProfiles | None) -> dict[str, Any]:
    """Where fields begin, as a generated package declares it; empty without."""
    if profiles is None:
        return {}
    return {
        "called": ", ".join(profiles.called),
        "lengths": tuple_text(map(quote, profiles.lengths)),
        "arguments": ", ".join(profiles.arguments),
        "texts": {quote(name): own for name, own in profiles.texts.items()},
    }


def tell_shape(loops: Loops, context: FamilyContext) -> str:
    """The shape of a result: None of one like the state, or rows for each member."""
    if loops.member is None:
        return str(loops.shape)
    rows = len(loops.member.program.outputs)
    return str(None if rows == sum(len(each.components) for each in context.state) else rows)


def tell_summary(loops: Loops) -> str:
    """One sentence on a function."""
    rows = "rows * N" if loops.shape is None else ", ".join(map(str, loops.shape))
    if loops.member:
        rows = f"{len(loops.member.program.outputs)} * N"
    shape = ", ".join([rows, "..."] if rows else ["..."])
    function = KERNEL_FUNCTIONS[loops.name]
    return f"{function.turning or function.summary}, shape ({shape})."


def count_costs(loops: Loops) -> list[str]:
    """What a call costs, for each member or pair."""
    told = [("pair of members, for both of them", loops.partners)]
    told += [("member without its pairs" if loops.partners else "member", loops.member)]
    told += [
        ("member" if each.over == "members" else "pair of members", each.part)
        for each in loops.totals
    ]
    lines = [
        f"Operations per {what}: "
        + (
            ", ".join(f"{n} {kind}" for kind, n in part.program.operation_counts().items())
            or "none"
        )
        + "."
        for what, part in told
        if part is not None
    ]
    return wrap(lines)
