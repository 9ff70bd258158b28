"""Render, families: loops over the members of a family as the templates of each target read them.

Comes in: the `Loops` of a family's functions. Goes out: plain records. Where a name is read is a
text of the target: `PLACES` has one function for each.
Read next: `coadjoint.render.kernels`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final

from coadjoint.declared import Quantity
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
from coadjoint.lower.families import FEWEST, SUM, Loops, Part, Read
from coadjoint.lower.program import Node, Program, Statement
from coadjoint.lower.tableau import dop853
from coadjoint.methods import BY_ENERGY, MAPPED, STRUCTURED, JudgedMethod
from coadjoint.render.environment import names_read, render_templates
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
class ReadText:
    """A name and where it is read, in a target.

    Attributes:
        name: The name.
        place: Its place.
        step: In C, what says whether lanes have values of their own; "" if they always have.
        of: Whose it is: that of the ``member``, of a ``partner``, or of ``all``.
    """

    name: str
    place: str
    step: str = ""
    of: str = "member"


@dataclass(frozen=True)
class SumText:
    """A sum that is read: its name and number."""

    name: str
    place: int


@dataclass(frozen=True)
class OutputText:
    """A result, and in C its place."""

    value: Node
    place: str


@dataclass(frozen=True)
class PartText:
    """A part as the templates read it."""

    reads: tuple[ReadText, ...]
    sums: tuple[SumText, ...]
    statements: tuple[Statement, ...]
    outputs: tuple[OutputText, ...]


@dataclass(frozen=True)
class TotalsText:
    """Terms that are added up in one loop, and the number of the first sum."""

    part: PartText
    over: str
    before: int
    after: int
    first: int


@dataclass(frozen=True)
class SolveText:
    """What is solved for before a function begins, as `Solve` has it."""

    factors: PartText
    blocks: int
    of: int
    level: bool


@dataclass(frozen=True)
class ProductsText:
    """What is computed of matrices before a function begins, as `Products` has it."""

    scale: PartText | None
    product: str
    blocks: int


@dataclass(frozen=True)
class FamilyFunction:
    """A function of a family as the templates read it.

    Attributes:
        name: Its name.
        summary: What it is.
        costs: Its operations, as lines.
        shape: Of its result where that does not depend on N.
        blocks: Rows of its first argument for each member.
        rows: Further rows of it, which all members share.
        reach: Members at both ends of which each is computed alone.
        ends_before: Members at the beginning that have rates of their own.
        ends_after: Such members at the end.
        partners: As `Loops` has it; likewise ``pair_sums``, ``member``, ``ends``, ``totals`` and
            ``finish``.
        solve: What is solved for first.
        products: What is computed of matrices first.
        sums: How many sums there are in a function of sums.
    """

    name: str
    summary: str
    costs: list[str]
    shape: str
    blocks: int
    rows: int
    reach: int
    ends_before: int
    ends_after: int
    partners: PartText | None
    pair_sums: int
    member: PartText | None
    ends: tuple[tuple[int, PartText], ...]
    totals: tuple[TotalsText, ...]
    finish: PartText | None
    solve: SolveText | None
    products: ProductsText | None
    sums: int


def _row(read: Read, member: str) -> str:
    """The row of a name in an array, without zeros: ``2 * size + i``."""
    blocks = "size" if read.blocks == 1 else f"{read.blocks} * size"
    addends = [str(read.rows)] * bool(read.rows) + [blocks] * bool(read.blocks)
    return " + ".join([*addends, member] if member else addends) or "0"


def _fixed_row(read: Read) -> str:
    """The row of what does not depend on i: of all members, or of one at an end."""
    if read.single is None:
        return _row(read, "")
    if read.single >= 0:
        return _row(replace(read, rows=read.rows + read.single), "")
    return f"{_row(replace(read, blocks=read.blocks + 1), '')} - {-read.single}"


def _python_place(read: Read, wraps: bool) -> str:
    """Where Python and NumPy read."""
    if read.array == "sizes":
        return "float(size)"
    if read.shift is None:
        return f"{read.array}[{_fixed_row(read)}]"
    member = "j" if read.of_partner else "i"
    if read.shift:
        sign = "+" if read.shift > 0 else "-"
        member = f"i {sign} {abs(read.shift)}"
        member = f"({member}) % size" if wraps else member
    return f"{read.array}[{_row(read, member)}]"


def _script_place(read: Read, wraps: bool) -> str:
    """Where JavaScript reads; its remainder of a negative number is negative."""
    place = _python_place(read, wraps).replace("float(size)", "size")
    return re.sub(r"\(i - (\d+)\) % size", r"(i + size - \1) % size", place)


def _c_place(read: Read, wraps: bool) -> str:
    """Where C reads, the address of the first lane."""
    row = _fixed_row(read).replace("size", "_run.size")
    if read.shift is not None:
        member = "_j" if read.of_partner else "_run.i"
        if read.shift:
            sign, word = ("+", "after") if read.shift > 0 else ("-", "before")
            member = f"_run.i {sign} {abs(read.shift)}"
            if wraps:
                member = f"{word}(_run.i, {abs(read.shift)}, _run.size)"
        row = _row(read, member).replace("size", "_run.size").replace("_run._run.", "_run.")
    if read.array == "sizes":
        return "_run.sizes"
    if read.array == "time":
        return "_run.time + _run.n * _run.timed"
    if read.array == "state":
        return f"_run.state + ({row}) * _run.stride + _run.n"
    if read.array == "inputs":
        return f"_run.inputs + ({row}) * _run.inputs_row + _run.n * _run.driven"
    return f"_run.parameters + ({row}) * _run.row + _run.n * _run.own"


def _c_step(read: Read) -> str:
    """What says in C whether lanes have values of their own."""
    if read.array == "sizes":
        return "0"
    if read.array == "time":
        return "_run.timed"
    if read.array == "state":
        return "_batch" if read.of_partner or read.shift is None else ""
    if read.array == "inputs":
        alike = read.shift is None or read.of_partner
        return "_run.driven" if alike else "!_batch || _run.driven"
    if read.single is not None:
        return "_indexed"
    return "_shared" if read.shift is None or read.of_partner else "_indexed"


#: Where each target reads a name of a part, in a ring or not.
PLACES: Final[dict[str, Callable[[Read, bool], str]]] = {
    "c": _c_place,
    "numpy": _python_place,
    "python": _python_place,
    "js": _script_place,
}


def arrange_loops(loops: Loops, target: str, summary: str, costs: list[str]) -> FamilyFunction:
    """A function as the templates of a target read it."""
    firsts, count = list[int](), 0
    for each in loops.totals:
        firsts.append(count)
        count += len(each.part.program.outputs)
    reach = max([part.reach for part in loops.parts])
    edges = [reach, *(max(each.before, each.after) for each in loops.totals)]
    edges += [max(place + 1, -place) for place, _ in loops.ends]

    def text(part: Part | None, *, to: str = "") -> PartText | None:
        return None if part is None else _arrange(part, loops.wraps, target, to)

    member, finish = text(loops.member, to="member"), text(loops.finish, to="total")
    return FamilyFunction(
        name=loops.name,
        summary=summary,
        costs=costs,
        shape="" if loops.shape is None else str(loops.shape),
        blocks=loops.blocks,
        rows=loops.rows,
        reach=max(edges),
        ends_before=len(loops.first_ends),
        ends_after=len(loops.last_ends),
        partners=text(loops.partners),
        pair_sums=loops.pair_sums,
        member=member,
        ends=tuple(
            (place, _arrange(part, loops.wraps, target, "member")) for place, part in loops.ends
        ),
        totals=tuple(
            TotalsText(
                part=_arrange(each.part, loops.wraps, target, ""),
                over=each.over,
                before=each.before,
                after=each.after,
                first=first,
            )
            for each, first in zip(loops.totals, firsts, strict=True)
        ),
        finish=finish,
        solve=_arrange_solve(loops, target),
        products=_arrange_products(loops, target),
        sums=count,
    )


def _arrange_solve(loops: Loops, target: str) -> SolveText | None:
    """What is solved for first."""
    solve = loops.solve
    if solve is None:
        return None
    factors = _arrange(solve.factors, loops.wraps, target, "")
    return SolveText(factors, solve.blocks, solve.of, solve.level)


def _arrange_products(loops: Loops, target: str) -> ProductsText | None:
    """What is computed of matrices first."""
    products = loops.products
    if products is None:
        return None
    scale = None
    if products.scale is not None:
        scale = _arrange(products.scale, loops.wraps, target, "")
    return ProductsText(scale, products.product, products.blocks)


def _arrange(part: Part, wraps: bool, target: str, to: str) -> PartText:
    """A part as the templates of a target read it."""
    place, program = PLACES[target], part.program
    names = program.state[len(part.reads) :]
    rows = {"": "", "member": "({n} * _run.size + _run.i)", "total": "{n}"}[to]
    return PartText(
        reads=tuple(
            ReadText(
                name=read.name,
                place=place(read, wraps),
                step=_c_step(read) if target == "c" else "",
                of="all" if read.shift is None else "partner" if read.of_partner else "member",
            )
            for read in part.reads
        ),
        sums=tuple(SumText(name, int(name.removeprefix(SUM))) for name in names),
        statements=program.statements,
        outputs=tuple(
            OutputText(
                output.value,
                f"_run.out + {rows.format(n=n)} * _run.out_stride + _run.n" if to else "",
            )
            for n, output in enumerate(program.outputs)
        ),
    )


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
    own = [] if led_by_python else [every[each.name] for each in context.methods]
    implicit = [each for each in own if each.name in STRUCTURED]
    flows = [name for name in context.loops if name.startswith("flow")]
    places = {name: n for n, name in enumerate(flows or ("flow1", "flow2"))}
    schedules = list_schedules(places)
    count = sum(len(each.components) for each in context.state)
    return {
        "names": {each.macro: (each.file, each.order) for each in implicit},
        "stages": {
            order: list(map(repr, COMPOSITIONS[order]))
            for order in sorted({each.order for each in implicit})
        },
        "spheres": [rows[0] for rows in context.spheres.values()],
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
    entries = (f"{place}: {quote(text)}" for place, text in connection.entries.items())
    ends = ["True"] * connection.has_ends
    return [*names, str(connection.size), "{" + ", ".join(entries) + "}", *ends]


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
