"""Consistency: what must hold between the tables of a spec before any route can be followed.

Comes in: the checked tables of a spec. Goes out: nothing, or a `SpecError` that names what is
missing and how to write it. Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Index, Name, walk
from coadjoint.spec.kinds import is_in_frame, kinds_of
from coadjoint.spec.model import Spec
from coadjoint.spec.routes import ROUTES, energies_of
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.variables import VARIABLES, Variable
from coadjoint.spec.tables import TABLES, how_to_write, list_formulas

_ENERGIES = ("hamiltonian", "lagrangian")
#: What a kind of spec has, in words.
_KINDS = {
    "algebra": "[algebra]",
    "poisson": "[poisson]",
    "nambu": "nambu functions in [poisson]",
    "canonical": "canonical pairs in [poisson]",
    "configuration": "coordinates with velocities or momenta",
}


def check_tables(source: Source, file: Any) -> None:
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


def check_routes(source: Source, file: Any) -> None:
    """Each route starts from tables that are there, and none is there in vain.

    Raises:
        SpecError: Something is missing for a route, or is used by none.
    """
    kinds = kinds_of(file)
    for place, route in enumerate(file.routes):
        start = ROUTES[route]
        if not set(start.kinds) & set(kinds):
            others = [name for name, other in ROUTES.items() if set(other.kinds) & set(kinds)]
            starts = " or ".join(_KINDS[kind] for kind in start.kinds)
            raise source.fault(
                ("routes", place),
                f"the route {route} starts from {starts}, which is not there",
                found=route,
                expected=f"one of {listed(others)}",
            )
        if start.table and not getattr(file, start.table):
            raise _missing(source, f"the route {route} has no table [{start.table}]", start.table)
        if not start.takes_driving and (file.inputs or file.time):
            raise source.fault(
                ("routes", place),
                f"the route {route} knows neither inputs nor time",
                found=route,
                expected="a Lax pair that is the same at all times",
                hint=f'Remove "{route}", or make the inputs parameters.',
            )
        energies = energies_of(route, kinds)
        if energies and not any(getattr(file, each) for each in energies):
            names = [each.title() for each in energies]
            lacks = f"no {names[0]}"
            if len(names) > 1:
                lacks = "neither " + " nor ".join(f"a {name}" for name in names)
            raise _missing(source, f"the route {route} has {lacks}", energies[0])
        for table in TABLES:
            if table.acts and getattr(file, table.key) and table.key not in start.options:
                raise _unknown_to(source, place, route, table.key, kinds)
    _check_first(source, file)
    _check_use(source, file)


def _unknown_to(
    source: Source, place: int, route: str, table: str, kinds: tuple[str, ...]
) -> CoadjointError:
    """A route that would leave out what acts on the motion, and so derive another one."""
    others = [
        name
        for name, other in ROUTES.items()
        if table in other.options and set(other.kinds) & set(kinds)
    ]
    return source.fault(
        ("routes", place),
        f"the route {route} knows no {table}",
        found=route,
        expected=f"one of {listed(others)} beside [{table}]",
        hint=f'Write "{others[0]}" in its place, or remove [{table}].',
    )


def _check_first(source: Source, file: Any) -> None:
    """The first route gives the rates of the declared state, and all that is emitted."""
    first = file.routes[0]
    if not ROUTES[first].emitted:
        kinds, own = set(kinds_of(file)), ROUTES[first]
        others = [
            name
            for name, start in ROUTES.items()
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


def _check_use(source: Source, file: Any) -> None:
    """A Hamiltonian, a Lagrangian or another table that no route reads is a mistake."""
    kinds = kinds_of(file)
    used = {table for route in file.routes for table in energies_of(route, kinds)}
    starts = [ROUTES[route] for route in file.routes]
    used |= {name for start in starts for name in (start.table, *start.options)}
    for table in (each.key for each in TABLES if each.routed):
        if getattr(file, table) and table not in used:
            readers = [
                name
                for name, start in ROUTES.items()
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


def _missing(source: Source, problem: str, table: str) -> CoadjointError:
    expected, hint = f"a table [{table}]", how_to_write(table)
    return source.fault(("routes",), problem, found=table, expected=expected, hint=hint)


def check_used(source: Source, spec: Spec) -> None:
    """Every input, and the time if it is declared, occurs in some formula.

    Raises:
        SpecError: One does not.
    """
    trees = [formula.tree for formula in list_formulas(spec)]
    named = {n.name for tree in trees for n in walk(tree) if isinstance(n, Name | Index)}
    named |= {each.rate for each in spec.inputs}
    for each in spec.driving:
        if not named & {each.name, *each.components}:
            table = "time" if each is spec.time else "inputs"
            key: KeyPath = ("time",) if each is spec.time else ("inputs", each.name)
            raise source.fault(
                key,
                f"{each.name!r} occurs in no formula",
                found=each.name,
                expected=f"a formula that names {listed(each.components)}",
                hint=f"Use it in the energy or a force, or remove it from [{table}].",
                at=source.positions.key(key),
            )


_PLURALS = {"momentum": "momenta", "velocity": "velocities"}


def check_blocks(reading: Reading) -> None:
    """Velocities share no direction of the algebra, momenta neither, and both have the same blocks.

    Raises:
        SpecError: Two overlap, or one has no partner.
    """
    algebra, variables = ALGEBRA.of(reading).algebra, VARIABLES.of(reading)
    if algebra is None:
        return
    of_role = {role: [v for v in variables if v.role == role] for role in _PLURALS}
    for role, members in of_role.items():
        _check_overlaps(reading, role, members, algebra)
    if not all(of_role.values()):
        return
    for role, partner in (("velocity", "momentum"), ("momentum", "velocity")):
        blocks = [variable.block for variable in of_role[partner]]
        for variable in of_role[role]:
            if variable.block not in blocks:
                span = listed(algebra.basis[place] for place in variable.block)
                raise reading.at_key(
                    ("variables", variable.name),
                    f"the {role} {variable.name!r} has no {partner} beside it",
                    variable.name,
                    f"a {partner} of the same block ({span})",
                    "Give both the same block.",
                )


def _check_overlaps(
    reading: Reading, role: str, members: Sequence[Variable], algebra: LieAlgebra
) -> None:
    """No vector of the basis belongs to two variables of a role."""
    owners: dict[int, str] = {}
    for variable in members:
        for place in variable.block:
            if place in owners:
                raise reading.at_key(
                    ("variables", variable.name),
                    f"{variable.name!r} and {owners[place]!r} both span {algebra.basis[place]}",
                    variable.name,
                    f"one {role} for each vector of the basis",
                    f"Blocks of {algebra.name} are {listed(algebra.blocks) or 'undeclared'}.",
                )
            owners[place] = variable.name


def check_covered(reading: Reading) -> None:
    """Momenta and velocities span the algebra, or belong to every coordinate.

    Raises:
        SpecError: Some direction or coordinate has none.
    """
    file, algebra = reading.file, ALGEBRA.of(reading).algebra
    if algebra is not None:
        if not is_in_frame(file):
            _check_spanned(reading, "momentum", "Pi", algebra)
        elif any(variable.role == "coordinate" for variable in VARIABLES.of(reading)):
            _check_partners(reading)
        if file.lagrangian is not None:
            _check_spanned(reading, "velocity", "Omega", algebra)
    elif file.poisson is None or file.lagrangian is not None:
        _check_partners(reading)


def _check_partners(reading: Reading) -> None:
    """Every coordinate of a configuration space has a velocity where velocities are asked for."""
    variables = VARIABLES.of(reading)
    owned = {role: {v.of for v in variables if v.role == role} for role in _PLURALS}
    wanted = ["velocity"] if reading.file.lagrangian is not None else ["velocity", "momentum"]
    for variable in variables:
        name = variable.name
        if variable.role != "coordinate":
            continue
        if not any(name in owned[role] for role in wanted):
            role = wanted[-1]
            raise reading.at_key(
                ("variables", name),
                f"the coordinate {name!r} has no {' and no '.join(wanted)}",
                name,
                f"a {role} of each coordinate",
                f"Write for instance {'v' if role == 'velocity' else 'p'} = "
                f'{{ role = "{role}", of = "{name}" }}.',
            )
        if owned["momentum"] and name not in owned["momentum"]:
            raise reading.at_key(
                ("variables", name),
                f"the coordinate {name!r} has no momentum, and others have",
                name,
                "momenta of all coordinates or of none",
                f'Write for instance p = {{ role = "momentum", of = "{name}" }}.',
            )


def _check_spanned(reading: Reading, role: str, example: str, algebra: LieAlgebra) -> None:
    """The variables of a role span the whole algebra."""
    covered = {place for v in VARIABLES.of(reading) if v.role == role for place in v.block}
    left = [algebra.basis[place] for place in range(algebra.dimension) if place not in covered]
    if left:
        names = ", ".join(f'"{name}"' for name in left)
        block = f", block = [{names}]" if covered else ""
        raise reading.source.fault(
            ("variables",),
            f"no {role} spans {listed(left)}",
            found=listed(left),
            expected=f"{_PLURALS[role]} over the whole of {algebra.name}",
            hint=f'Write for instance {example} = {{ role = "{role}"{block} }}.',
        )
