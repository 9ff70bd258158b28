"""Consistency: what must hold between the parts of a spec before any route can be followed.

Comes in: the records of a spec. Goes out: nothing, or a `SpecError` that names what is missing and
how to write it. Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import CoadjointError, LimitError
from coadjoint.limits import PARAMETER_COMPONENTS, STATE_COMPONENTS
from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.names import derived_names, refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import (
    Constraint,
    Input,
    Observable,
    Parameter,
    Reconstructed,
    ReducedMomentum,
    Section,
    Symmetry,
    Time,
    Variable,
    state_of,
)
from coadjoint.spec.routes import STARTS, energies_of, is_in_frame, kinds_of
from coadjoint.spec.schema import SpecFile
from coadjoint.spec.sections.spatial import SpatialMomentum

#: How a missing table is written.
_HOW = {
    "hamiltonian": 'Write [hamiltonian] and below it h = "dot(Pi, inverse(diag(I))*Pi)/2".',
    "lagrangian": 'Write [lagrangian] and below it l = "dot(Omega, diag(I)*Omega)/2".',
}
_ENERGIES = ("hamiltonian", "lagrangian")
#: Tables that are there for routes alone.
_ROUTED = (
    *_ENERGIES,
    *("lax", "newton", "clebsch"),
)
#: Tables that act on the motion, so that every route must know them.
_ACTING = ("constraints", "forces", "dissipation", "double_bracket", "metriplectic")
#: Routes whose matrices neither time nor inputs may change.
UNDRIVEN = ("lax", "manakov")
#: What a kind of spec has, in words.
_KINDS = {
    "algebra": "[algebra]",
    "poisson": "[poisson]",
    "nambu": "nambu functions in [poisson]",
    "canonical": "canonical pairs in [poisson]",
    "configuration": "coordinates with velocities or momenta",
}
#: The key and the name that time may have, and nothing else: solutions call it so, too.
TIME: tuple[KeyPath, str] = (("time", "name"), "t")
#: What is emitted beside the state, or may be named there.
Emitted = (
    Observable | Symmetry | SpatialMomentum | ReducedMomentum | Section | Constraint | Reconstructed
)
_TABLES = {
    Observable: "observables",
    Symmetry: "symmetries",
    Section: "momenta",
    Constraint: "constraints",
    Reconstructed: "reconstruction",
}
#: What has components that are given from outside.
Given = Parameter | Input | Time
#: A declared thing: its key, its name, the names of its components, and the names of its rates.
_Declared = tuple[KeyPath, str, tuple[str, ...], tuple[str, ...]]


def check_names(
    source: Source,
    variables: Sequence[Variable],
    parameters: Sequence[Given],
    observables: Sequence[Emitted] = (),
    others: Mapping[KeyPath, str] = MappingProxyType({}),
) -> None:
    """Every name is free and declared once, components and rates included.

    Args:
        source: The text of the spec.
        variables: The variables.
        parameters: The parameters, the inputs and the time.
        observables: Those whose shape is known, and momentum maps.
        others: Further names at their keys, of things whose components are not known yet.

    Raises:
        SpecError: A reserved or doubled name, with a suggestion.
    """
    owners: dict[str, str] = {}
    declared = [*_declared(variables, parameters, observables)]
    declared += [(key, name, (), ()) for key, name in others.items()]
    for key, name, components, rates in declared:
        for derived in dict.fromkeys((name, *components)):
            refused = None if (key, derived) == TIME else refusal(derived)
            if refused is not None:
                problem, expected, hint = refused
                if derived != name:
                    problem = f"{problem}, and so would be a component of {name!r}"
                    hint = "Choose another name."
                raise _at_key(source, key, problem, derived, expected, hint)
        for derived in dict.fromkeys((name, *components, *rates)):
            if derived in owners:
                problem = f"{derived!r} is doubled: {owners[derived]} has that name too"
                expected, hint = "names and components that differ", _why_doubled(key, derived)
                raise _at_key(source, key, problem, derived, expected, hint)
        for derived in (name, *components, *rates):
            owners[derived] = f"{key[0]}.{name}"


def _why_doubled(key: KeyPath, derived: str) -> str:
    """Where a name that nobody declared comes from."""
    if key[0] == "constraints" and derived != key[1]:
        return f"The multiplier of the constraint {key[1]} is {derived}: rename one of them."
    return "The components of I with shape [3] are I1, I2, I3."


def _declared(
    variables: Sequence[Variable],
    parameters: Sequence[Given],
    observables: Sequence[Emitted],
) -> Iterable[_Declared]:
    for variable in variables:
        moving = variable in state_of(variables)
        rates = tuple(derived_names(variable.components)) if moving else ()
        yield ("variables", variable.name), variable.name, variable.components, rates
    for given in parameters:
        table: KeyPath = (f"{given.role}s", given.name)
        at = ("time", "name") if isinstance(given, Time) else table
        yield at, given.name, given.components, ()
    for entry in observables:
        if isinstance(entry, ReducedMomentum):
            yield ("variables", entry.velocity.name), entry.name, entry.components, ()
            continue
        if isinstance(entry, SpatialMomentum):
            yield ("variables", entry.momentum.name), entry.name, entry.components, ()
            continue
        followed = entry.components if isinstance(entry, Reconstructed) else ()
        rates = tuple(derived_names(followed))
        of_rolling = isinstance(entry, Reconstructed) and entry.of_rolling
        key: KeyPath = ("rolling",) if of_rolling else (_TABLES[type(entry)], entry.name)
        yield key, entry.name, entry.components, rates
        if isinstance(entry, Constraint):
            yield ("constraints", entry.name), entry.reaction, entry.reactions, ()


def check_sizes(
    source: Source,
    variables: Sequence[Variable],
    parameters: Sequence[Parameter],
    inputs: Sequence[Input] = (),
) -> None:
    """The state, the parameters and the inputs are not too many.

    Raises:
        LimitError: More components than the limit.
    """
    state = state_of(variables)
    for key, quantities, limit, most in (
        ("variables", state, "STATE_COMPONENTS", STATE_COMPONENTS),
        ("parameters", parameters, "PARAMETER_COMPONENTS", PARAMETER_COMPONENTS),
        ("inputs", inputs, "PARAMETER_COMPONENTS", PARAMETER_COMPONENTS),
    ):
        count = sum(len(quantity.components) for quantity in quantities)
        if count > most:
            raise source.fault(
                (key,),
                f"the {'state' if key == 'variables' else key} have {count} components",
                found=count,
                expected=f"at most {most} ({limit})",
                kind=LimitError,
                limit=limit,
            )


def check_blocks(source: Source, variables: Sequence[Variable], algebra: LieAlgebra) -> None:
    """Velocities share no direction of the algebra, momenta neither, and both have the same blocks.

    Raises:
        SpecError: Two overlap, or one has no partner.
    """
    of_role = {r: [v for v in variables if v.role == r] for r in ("velocity", "momentum")}
    for role, members in of_role.items():
        owners: dict[int, str] = {}
        for variable in members:
            for place in variable.block:
                if place in owners:
                    problem = (
                        f"{variable.name!r} and {owners[place]!r} both span {algebra.basis[place]}"
                    )
                    expected = f"one {role} for each vector of the basis"
                    hint = f"Blocks of {algebra.name} are {listed(algebra.blocks) or 'undeclared'}."
                    key: KeyPath = ("variables", variable.name)
                    raise _at_key(source, key, problem, variable.name, expected, hint)
                owners[place] = variable.name
    if not of_role["velocity"] or not of_role["momentum"]:
        return
    for role, partner in (("velocity", "momentum"), ("momentum", "velocity")):
        blocks = [variable.block for variable in of_role[partner]]
        for variable in of_role[role]:
            if variable.block not in blocks:
                span = listed(algebra.basis[place] for place in variable.block)
                raise _at_key(
                    source,
                    ("variables", variable.name),
                    f"the {role} {variable.name!r} has no {partner} beside it",
                    variable.name,
                    f"a {partner} of the same block ({span})",
                    "Give both the same block.",
                )


def check_tables(source: Source, file: SpecFile) -> None:
    """There is an algebra, a Poisson bracket or neither, and nothing that goes with another.

    Raises:
        SpecError: Both, or neither and no coordinates; a table or route that goes with the other.
    """
    coordinates = any(part.role == "coordinate" for part in file.variables.values())
    if file.algebra is None and file.poisson is None and not coordinates:
        raise source.fault(
            (),
            "the table 'algebra' is missing",
            found="algebra",
            expected="a table [algebra], or [poisson] or coordinates with velocities for a system "
            "without an algebra",
            hint='Write [algebra] and below it name = "so(3)".',
        )
    if file.algebra is not None and file.poisson is not None:
        raise source.fault(
            ("poisson",),
            "there are both [algebra] and [poisson]",
            found="poisson",
            expected="one of them",
            hint="The bracket on the dual of an algebra follows from it: remove [poisson].",
        )
    if file.algebra is None and file.representations:
        raise source.fault(
            ("representations",),
            "there is a table [representations] without [algebra]",
            found="representations",
            expected="[representations] beside [algebra] alone",
            hint="Remove [representations].",
        )


def check_routes(source: Source, file: SpecFile) -> None:
    """Each route starts from tables that are there, and none is there in vain.

    Raises:
        SpecError: Something is missing for a route, or is used by none.
    """
    kinds = kinds_of(file)
    for place, route in enumerate(file.routes):
        start = STARTS[route]
        if not set(start.kinds) & set(kinds):
            others = [name for name, other in STARTS.items() if set(other.kinds) & set(kinds)]
            starts = " or ".join(_KINDS[kind] for kind in start.kinds)
            raise source.fault(
                ("routes", place),
                f"the route {route} starts from {starts}, which is not there",
                found=route,
                expected=f"one of {listed(others)}",
            )
        if start.table and getattr(file, start.table) is None:
            raise _missing(source, f"the route {route} has no table [{start.table}]", start.table)
        if route in UNDRIVEN and (file.inputs or file.time):
            raise source.fault(
                ("routes", place),
                f"the route {route} knows neither inputs nor time",
                found=route,
                expected="a Lax pair that is the same at all times",
                hint=f'Remove "{route}", or make the inputs parameters.',
            )
        energies = energies_of(route, kinds)
        if start.is_bare:
            _check_bare(source, file, place)
        if energies and not start.is_bare and not any(getattr(file, each) for each in energies):
            names = [each.title() for each in energies]
            lacks = f"no {names[0]}"
            if len(names) > 1:
                lacks = "neither " + " nor ".join(f"a {name}" for name in names)
            raise _missing(source, f"the route {route} has {lacks}", energies[0])
        for table in _ACTING:
            if getattr(file, table) and table not in start.options:
                raise _unknown_to(source, place, route, table, kinds)
    _check_first(source, file)
    _check_use(source, file)


def _is_bare(file: SpecFile) -> bool:
    """Whether a Lax pair alone moves the state."""
    return file.lax is not None and not (file.hamiltonian or file.lagrangian or file.newton)


def _check_bare(source: Source, file: SpecFile, place: int) -> None:
    """A Lax pair moves a state with a bracket and an energy, or coordinates by itself."""
    velocities = [name for name, part in file.variables.items() if part.role == "velocity"]
    if _is_bare(file) and velocities:
        raise source.fault(
            ("variables", velocities[0]),
            f"the velocity {velocities[0]!r} has no energy to follow from",
            found=velocities[0],
            expected="a Lax pair of the state alone, or a table [hamiltonian] beside it",
            hint="Write M in variables of the state, or declare [hamiltonian].",
            at=source.positions.key(("variables", velocities[0])),
        )
    if not _is_bare(file) and kinds_of(file) == ("configuration",):
        raise source.fault(
            ("routes", place),
            f"the route {file.routes[place]} knows no bracket of coordinates with velocities or "
            "momenta",
            found=file.routes[place],
            expected="[algebra] or [poisson] beside an energy",
            hint='Declare the momenta as coordinates, with [poisson] and canonical = [["q", "p"]].',
        )


def _unknown_to(
    source: Source, place: int, route: str, table: str, kinds: tuple[str, ...]
) -> CoadjointError:
    """A route that would leave out what acts on the motion, and so derive another one."""
    others = [
        name
        for name, other in STARTS.items()
        if table in other.options and set(other.kinds) & set(kinds)
    ]
    return source.fault(
        ("routes", place),
        f"the route {route} knows no {table}",
        found=route,
        expected=f"one of {listed(others)} beside [{table}]",
        hint=f'Write "{others[0]}" in its place, or remove [{table}].',
    )


def _check_first(source: Source, file: SpecFile) -> None:
    """The first route gives the rates of the declared state, and all that is emitted."""
    first = file.routes[0]
    if not STARTS[first].emitted:
        kinds, own = set(kinds_of(file)), STARTS[first]
        others = [
            name
            for name, start in STARTS.items()
            if start.emitted
            and set(start.kinds) & kinds
            and (start.table, start.in_frame) == (own.table, own.in_frame)
        ]
        raise source.fault(
            ("routes", 0),
            f"the route {first} cannot be the first: it is there to be proved equal to another",
            found=first,
            expected=f"one of {listed(others)} before it",
            hint=f'Write "{others[0]}" before it.',
        )
    roles = {part.role for part in file.variables.values()}
    paired = file.poisson is not None or "momentum" in roles
    if first == "canonical" and file.lagrangian is not None and not paired:
        raise source.fault(
            ("routes", 0),
            "the route canonical moves momenta, and the state has velocities",
            found=first,
            expected="variables with role = 'momentum', or euler-lagrange before it",
            hint='Write "euler-lagrange" before it.',
        )


def _check_use(source: Source, file: SpecFile) -> None:
    """A Hamiltonian, a Lagrangian or another table that no route reads is a mistake."""
    kinds = kinds_of(file)
    used = {table for route in file.routes for table in energies_of(route, kinds)}
    starts = [STARTS[route] for route in file.routes]
    used |= {name for start in starts for name in (start.table, *start.options)}
    for table in _ROUTED:
        if getattr(file, table) and table not in used:
            readers = [
                name
                for name, start in STARTS.items()
                if table in (*energies_of(name, kinds), start.table, *start.options)
                and set(start.kinds) & set(kinds)
            ]
            raise source.fault(
                (table,),
                f"no route uses the {table.title()}"
                if table in _ENERGIES
                else f"no route uses the table [{table}]",
                found=table,
                expected=f"one of the routes {listed(readers)} beside it"
                if readers
                else f"no table [{table}] here",
                hint=f'Add "{readers[0]}" to routes, or remove [{table}].' if readers else "",
            )


def check_covered(
    source: Source, file: SpecFile, variables: Sequence[Variable], algebra: LieAlgebra | None
) -> None:
    """Momenta and velocities span the algebra, or belong to every coordinate.

    Raises:
        SpecError: Some direction or coordinate has none.
    """
    if algebra is not None:
        if not is_in_frame(file):
            _check_covered(source, "momentum", "Pi", variables, algebra)
        elif any(variable.role == "coordinate" for variable in variables):
            _check_partners(source, file, variables)
        if file.lagrangian is not None:
            _check_covered(source, "velocity", "Omega", variables, algebra)
    elif (file.poisson is None and not _is_bare(file)) or file.lagrangian is not None:
        _check_partners(source, file, variables)


def _check_partners(source: Source, file: SpecFile, variables: Sequence[Variable]) -> None:
    """Every coordinate of a configuration space has a velocity where velocities are asked for."""
    owned = {role: {v.of for v in variables if v.role == role} for role in ("velocity", "momentum")}
    for variable in variables:
        if variable.role != "coordinate":
            continue
        wanted = ["velocity"] if file.lagrangian is not None else ["velocity", "momentum"]
        if not any(variable.name in owned[role] for role in wanted):
            name, role = variable.name, wanted[-1]
            letter = "v" if role == "velocity" else "p"
            raise _at_key(
                source,
                ("variables", name),
                f"the coordinate {name!r} has no {' and no '.join(wanted)}",
                name,
                f"a {role} of each coordinate",
                f'Write for instance {letter} = {{ role = "{role}", of = "{name}" }}.',
            )
        if owned["momentum"] and variable.name not in owned["momentum"]:
            raise _at_key(
                source,
                ("variables", variable.name),
                f"the coordinate {variable.name!r} has no momentum, and others have",
                variable.name,
                "momenta of all coordinates or of none",
                "",
            )


def check_claims(source: Source, file: SpecFile, variables: Sequence[Variable]) -> None:
    """What is claimed of a bracket has one, and Galilean relativity has particles.

    Raises:
        SpecError: Neither an energy nor momenta give a bracket, or no law of particles is there.
    """
    claims = file.claims
    bare = file.algebra is None and file.poisson is None and file.lagrangian is None
    if bare and not any(variable.role == "momentum" for variable in variables):
        for table in ("casimirs", "brackets"):
            if getattr(claims, table):
                raise source.fault(
                    ("claims", table),
                    f"there are {table} without a bracket",
                    found=table,
                    expected="a Lagrangian, momenta or [poisson] that give a bracket",
                    hint=f"Remove {table}, or declare [lagrangian].",
                )
    particles = [variable for variable in variables if variable.role == "coordinate"]
    flat = [q for q in particles if q.value_shape not in ((3,), (3, 3)) or q.form == "symmetric"]
    if claims.galilean.claim and (file.newton is None or flat):
        found = flat[0].name if flat else "newton"
        raise source.fault(
            ("claims", "galilean"),
            f"the coordinate {found!r} is no particle in space" if flat else "there is no [newton]",
            found=found,
            expected="laws in [newton] of coordinates with shape = [3], one for each particle, or "
            'of one with shape = [9] and form = "matrix", a row for each particle',
        )


def _missing(source: Source, problem: str, table: str) -> CoadjointError:
    expected, hint = f"a table [{table}]", _HOW.get(table, "")
    return source.fault(("routes",), problem, found=table, expected=expected, hint=hint)


def _check_covered(
    source: Source, role: str, example: str, variables: Sequence[Variable], algebra: LieAlgebra
) -> None:
    """The variables of a role span the whole algebra."""
    plural = {"momentum": "momenta", "velocity": "velocities"}[role]
    covered = {place for v in variables if v.role == role for place in v.block}
    left = [algebra.basis[place] for place in range(algebra.dimension) if place not in covered]
    if left:
        names = ", ".join(f'"{name}"' for name in left)
        block = f", block = [{names}]" if covered else ""
        raise source.fault(
            ("variables",),
            f"no {role} spans {listed(left)}",
            found=listed(left),
            expected=f"{plural} over the whole of {algebra.name}",
            hint=f'Write for instance {example} = {{ role = "{role}"{block} }}.',
        )


def _at_key(
    source: Source, key: KeyPath, problem: str, found: Any, expected: str, hint: str
) -> CoadjointError:
    """An error that points at a key and not at its value."""
    return source.fault(
        key, problem, found=found, expected=expected, hint=hint, at=source.positions.key(key)
    )
