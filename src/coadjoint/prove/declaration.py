"""Proving, declaration: what the generated files of a system say of it.

Comes in: proved Equations and the Programs of its functions. Goes out: a `KernelContext` of names,
units and numbers. Of a spec's free text it holds nothing, nor of the texts of its claims: rewording
these leaves every kernel as it is.
Read next: `coadjoint.render.kernels`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy

from coadjoint.algebra.matrices import size
from coadjoint.declared import KernelContext, Quantity
from coadjoint.derive import Equations
from coadjoint.derive.document import equation_lines
from coadjoint.derive.domain import bounds
from coadjoint.derive.emitted import list_following
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.ends import CLOSURES
from coadjoint.derive.fields.grid import Grid
from coadjoint.derive.fields.jets import jets_of, solved
from coadjoint.derive.fields.profile_texts import write_profiles
from coadjoint.derive.fields.stencils import find_largest
from coadjoint.derive.fields.symbol import find_matrix
from coadjoint.derive.fields.torus import TorusGrid
from coadjoint.derive.pairs import find_matrix_at
from coadjoint.derive.records import Emitted
from coadjoint.derive.setting import Declared
from coadjoint.derive.truncated import tell_motion
from coadjoint.exact import Element, Field, element_text
from coadjoint.families import Connection, Family, PrincipalSymbol
from coadjoint.lower.family_kinks import name_kinks, name_pair_kinks
from coadjoint.lower.loops import Loops
from coadjoint.lower.mapped import Maps
from coadjoint.lower.program import Program
from coadjoint.methods import JudgedMethod
from coadjoint.prove.driven import while_constant
from coadjoint.prove.family_methods import FamilyFacts
from coadjoint.prove.integrals import is_conserved
from coadjoint.prove.strands import list_matrices
from coadjoint.render.families import FamilyContext
from coadjoint.spec import Spec
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Reconstructed


def _tell_file(spec: Spec) -> str:
    """The file of a spec for readers, with its folder where that is called ``derivations``.

    Files that are generated are to be the same wherever the spec lies.
    """
    path = spec.path.absolute()
    return f"derivations/{path.name}" if path.parent.name == "derivations" else path.name


def kernel_context(
    equations: Equations,
    programs: Mapping[str, Program],
    supported: int = 0,
    maps: Maps | None = None,
    methods: Iterable[JudgedMethod] = (),
) -> KernelContext:
    """What the generated files of a system say; of a spec's free text, nothing.

    Args:
        equations: The emitted route.
        programs: Its functions.
        supported: How many claims are numerically supported and not proved.
        maps: What explicit methods make a step of.
        methods: Methods that keep structure, as they are judged.
    """
    spec = equations.spec
    first, *others = spec.routes
    proved = [f"Proved equal to the route {route}." for route in others]
    return KernelContext(
        name=spec.name,
        spec=_tell_file(spec),
        license=spec.license,
        routes=(f"Route {first} {_origin(spec)}.", *proved),
        equations=equation_lines(equations),
        state=tuple(map(_quantity, spec.state)),
        parameters=tuple(map(_quantity, spec.parameters)),
        observables=tuple(_observable(equations, each) for each in equations.exact.emitted),
        programs=tuple(programs.values()),
        supported=supported,
        reconstructed=tuple(_declare_followed(spec, each) for each in spec.reconstruction),
        reconstructed_observables=tuple(map(_quantity, list_following(equations.setting))),
        inputs=tuple(map(_quantity, spec.inputs)),
        time=tuple(map(_quantity, [] if spec.time is None else [spec.time])),
        unit_of_time=spec.units.time,
        clock=(spec.clock.name, spec.clock.label),
        written=(spec.index[0].name, spec.index[0].size or 0) if spec.written else None,
        domain=tuple(bound for bound, _ in bounds(equations)),
        turning=tuple(v.name for v in spec.turning),
        is_bound=bool(equations.exact.residuals),
        maps=() if maps is None else maps.programs,
        refusals=() if maps is None else tuple(maps.refusals.items()),
        methods=tuple(each for each in methods if each.applies),
    )


def family_context(
    equations: Equations,
    family: Family,
    loops: dict[str, Loops],
    supported: int = 0,
    facts: FamilyFacts | None = None,
    methods: Iterable[JudgedMethod] = (),
) -> FamilyContext:
    """What the generated files of a system of equal members say.

    Args:
        equations: Of the first route, for a few members.
        family: Those of the generic member.
        loops: Its functions.
        supported: How many claims are numerically supported and not proved.
        facts: What decides which methods keep structure.
        methods: These, as they are judged.
    """
    spec = equations.spec
    declared = spec.family
    assert declared is not None, spec.name
    first, *others = spec.routes
    quantities = (*spec.variables, *spec.parameters, *spec.inputs)
    known: dict[str, Any] = {each.name: each for each in quantities}
    kept = {each.name: each for each in equations.exact.emitted}

    def name_generic(name: str) -> Quantity:
        """A quantity of member 0 by the name that it has for every member."""
        own = _quantity(known[member_name(name, 0)])
        generic = known[member_name(name, 0)]
        return replace(
            own, name=name, components=component_names(name, generic.shape, generic.form)
        )

    return FamilyContext(
        name=spec.name,
        spec=_tell_file(spec),
        license=spec.license,
        routes=(
            f"Route {first} for every number of {'rows' if family.matrices else 'members'}.",
            *(f"Proved equal to the route {route}." for route in others),
        ),
        equations=family_lines(family),
        index=family.index,
        small=family.small,
        kinks=name_kinks(family),
        pair_kinks=name_pair_kinks(family),
        state=tuple(map(name_generic, declared.variables)),
        shared=tuple(_quantity(known[name]) for name in declared.shared),
        indexed=tuple(map(name_generic, declared.indexed)),
        shared_inputs=tuple(_quantity(known[name]) for name in declared.shared_inputs),
        indexed_inputs=tuple(map(name_generic, declared.indexed_inputs)),
        shared_noise=tuple(map(_name_process, declared.shared_noise)),
        indexed_noise=tuple(map(_name_process, declared.indexed_noise)),
        defaults={
            name: tuple(float(value) for component in values for value in component)
            for name, values in declared.defaults.items()
        },
        repeating=declared.repeating,
        observables=tuple(
            _observable(equations, kept[name])
            for name in (
                *(each.name for each in family.totals if each.name == "energy"),
                *(o.name for o in spec.observables),
                *(each.name for each in spec.symmetries),
            )
        ),
        loops=loops,
        supported=supported,
        unit_of_time=spec.units.time,
        clock=(spec.clock.name, spec.clock.label),
        time=tuple(map(_quantity, [] if spec.time is None else [spec.time])),
        methods=tuple(each for each in methods if each.applies),
        spheres={} if facts is None else {facts.radii[s.rows[0]]: s.rows for s in facts.spheres},
        positions=() if facts is None else facts.positions,
    )


def tell_fields(context: FamilyContext, grid: Grid) -> FamilyContext:
    """The context of fields at the points of a grid, with how they were derived."""
    first = grid.equations
    spec, space = first.spec, first.spec.space
    assert space is not None, spec.name
    own = f"at N points of the circle, by differences of order {space.order}"
    if space.has_ends:
        own = f"at N points between {space.ends} ends, by differences of order {space.order}"
    routes = [
        f"Route {first.route} of fields along {space.name}, {own}.",
        *(f"Proved equal to the route {route}." for route in spec.routes[1:]),
    ]
    lines = ["fields:", *equation_lines(first), f"point {space.name}:", *family_lines(grid.family)]
    wave = tell_wave(first)
    told = replace(context, routes=tuple(routes), equations=tuple(lines))
    return replace(
        told,
        connections=find_connections(first),
        wave=wave,
        spectral=grid.spectral,
        symbol=tell_symbol(first),
        profiles=write_profiles(spec),
    )


def tell_torus(context: FamilyContext, grid: TorusGrid) -> FamilyContext:
    """The context of a field at the points of a plane, with how it was derived."""
    first = grid.equations
    spec, space = first.spec, first.spec.space
    assert space is not None, spec.name
    routes = (
        f"Route {first.route} of a field along {' and '.join(space.coordinates)}, at points of a "
        "plane that closes in both directions, by truncated Fourier series.",
        *(f"Proved equal to the route {route}." for route in spec.routes[1:]),
    )
    lines = ["fields:", *equation_lines(first), "points:", *family_lines(grid.family)]
    return replace(
        context,
        routes=routes,
        equations=tuple(lines),
        torus=grid.torus,
        profiles=write_profiles(spec),
    )


def tell_symbol(first: Equations) -> PrincipalSymbol | None:
    """The principal symbol of fields for differences of the declared order."""
    setting, space = first.setting, first.spec.space
    assert space is not None, first.spec.name
    order, matrix = find_matrix(setting, jets_of(setting), first.exact.rates)
    if not order:
        return None
    rows = {
        a: {b: element_text(setting.field, x) for b, x in zip(setting.state, row, strict=True) if x}
        for a, row in zip(setting.state, matrix, strict=True)
    }
    largest = find_largest(order, space.order)
    if space.has_ends:
        largest = CLOSURES[space.order].largest
    return PrincipalSymbol(space.length, order, largest, rows)


def tell_wave(first: Equations) -> tuple[str, ...]:
    """The speed a of waves and the name of the length, where ``m_t + a(m) m_s = 0``.

    Of Hunter and Saxton's equation, ``m_t + u m_s + 2 u_s m = 0`` with m a multiple of u_ss, it is
    u. Others have waves whose end is not known: ().
    """
    setting, jets, space = first.setting, jets_of(first.setting), first.spec.space
    assert space is not None, first.spec.name
    if len(setting.state) > 1 or space.has_ends:
        return ()
    (m,), (rate,), field = setting.state, first.exact.rates, setting.field
    speed, steepness = -field.derivative(rate, jets.towers[m][1]), field[jets.towers[m][1]]
    for u in solved(first.spec):
        carried = field[u] * steepness + 2 * field[jets.towers[u][1]] * field[m]
        is_level = {*circle.inertia_along(setting)} == {2} and field.is_zero(rate + carried)
        return (u, space.length) if is_level else ()
    others = {*jets.orders} - {m}
    if field.reach(speed) & others or not field.is_zero(rate + speed * steepness):
        return ()
    is_moving = not field.is_zero(field.derivative(speed, m))
    return (element_text(field, speed), space.length) if is_moving else ()


def find_connections(first: Equations) -> tuple[Connection, ...]:
    """The strain of a strand, then L of a declared pair for each of its values.

    Not where matrices of the algebra are not known, and of a pair not between ends, where no trace
    is conserved.

    Raises:
        DerivationError: L has a pole at a value.
    """
    setting, spec = first.setting, first.spec
    field, space = setting.field, spec.space
    if space is None:
        return ()
    found = list[Connection]()
    strains = [each for each in spec.variables if each.strain]
    matrices = list_matrices(setting) if strains else []
    if matrices:
        (strain,) = strains
        entries = _tell_matrix(field, matrices, setting.elements(strain.components))
        velocity = _tell_matrix(field, matrices, _find_velocities(first))
        own = (strain.name, spec.invariance, space.length, size(matrices), entries)
        found.append(Connection(*own, has_ends=space.has_ends, velocity=velocity))
    if spec.lax is not None and not space.has_ends:
        for value in spec.lax.values:
            parts = find_matrix_at(setting, value)
            entries = {place: element_text(field, x) for place, x in parts.items()}
            rows = spec.lax.L.shape[0]
            found.append(Connection(f"L({value})", "left", space.length, rows, entries))
    return tuple(found)


def _find_velocities(first: Equations) -> tuple[Element, ...]:
    """The velocities of a strand by its momenta and strains; none where these do not tell them."""
    setting, energy = first.setting, first.exact.energy
    if energy is None:
        return ()
    found = setting.field.gradient(first.close(energy), setting.momenta)
    known = {*setting.state, *setting.parameters}
    return () if any(setting.field.reach(each) - known for each in found) else tuple(found)


def _tell_matrix(
    field: Field, matrices: Sequence[Mapping[tuple[int, int], Any]], parts: Sequence[Element]
) -> dict[tuple[int, int], str]:
    """A sum of the matrices of an algebra, by row and column as text; empty without parts."""
    sums: dict[tuple[int, int], list[Element]] = {}
    for part, matrix in zip(parts, matrices, strict=bool(parts)):
        for place, value in matrix.items():
            sums.setdefault(place, []).append(part * value)
    return {place: element_text(field, field.sum(own)) for place, own in sums.items()}


def _name_process(name: str) -> Quantity:
    """A Wiener process as the generated package declares it."""
    return Quantity(name=name, shape=(), unit="", components=(name,))


def family_lines(family: Family) -> tuple[str, ...]:
    """The equations of the generic member, one line each, then those of the ends of a chain.

    >>> from coadjoint.families import Index
    >>> q, before = sympy.symbols("q q[-1]")
    >>> ring = Family(
    ...     index=Index("i"),
    ...     states=(q,),
    ...     shifts=(-1,),
    ...     neighbours={(q, -1): before},
    ...     shared=(),
    ...     indexed=(),
    ...     partners={},
    ...     rates=(before - q,),
    ...     pair_sums=(),
    ...     ends={},
    ...     totals=(),
    ...     small=1,
    ... )
    >>> family_lines(ring)
    ('dq[i]/dt = q[i-1] - q[i]',)
    """
    if family.matrices is not None:
        return tuple(f"{left} = {right}" for left, right in tell_motion(family))
    i, own = family.index.name, (*family.own, *family.indexed_noise)

    def name(member: str) -> dict[Any, Any]:
        """Symbols of a member and those next to it, as they are shown."""
        shown = {each: sympy.Symbol(f"{each}[{member}]") for each in own}
        shown |= {
            symbol: sympy.Symbol(f"{each}[{member}{shift:+d}]")
            for (each, shift), symbol in family.neighbours.items()
        }
        return shown

    generic = name(i)
    sums = {
        each.symbol: sympy.Symbol(f"sum(j != {i}, {each.term.xreplace(generic)})")
        for each in family.pair_sums
    }
    lines = list[str]()
    places = [(i, family.rates)]
    places += [(str(k) if k >= 0 else f"N{k}", rates) for k, rates in family.ends.items()]
    for member, rates in places:
        shown = name(member) | sums
        lines += [
            f"d{each}[{member}]/dt = {rate.xreplace(shown)}".replace("**", "^")
            for each, rate in zip(family.states, rates, strict=True)
        ]
    if family.noise:
        lines.append("with noise, in the sense of Stratonovich:")
    for each, moved in zip(family.states, family.noise, strict=False):
        lines.append(f"d{each}[{i}] = ... + {moved.xreplace(generic)}".replace("**", "^"))
    return tuple(lines)


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


def _quantity(declared: Declared | Reconstructed | Emitted, **more: Any) -> Quantity:
    """What is declared or emitted as the generated package declares it."""
    default = getattr(declared, "default", None)
    return Quantity(
        name=declared.name,
        shape=declared.shape,
        unit=declared.unit,
        components=declared.components,
        default=None if default is None else tuple(map(float, default)),
        positive=getattr(declared, "positive", False),
        **more,
    )


def _declare_followed(spec: Spec, each: Reconstructed) -> Quantity:
    """What is reconstructed as the generated package declares it."""
    upright = spec.rolling.normal if spec.rolling and each.attitude and each.of_rolling else ""
    return _quantity(each, upright=upright)


def _observable(equations: Equations, each: Emitted) -> Quantity:
    """What is emitted as the generated package declares it."""
    conserved = is_conserved(equations, each)
    held = conserved and while_constant(equations, each.values)
    return _quantity(each, conserved=conserved, while_constant=bool(held))
