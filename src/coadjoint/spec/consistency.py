"""Consistency: what must hold between the tables of a spec before any route can be followed.

Comes in: the checked tables of a spec. Goes out: nothing, or a `SpecError` that names what is
missing and how to write it. Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import Index, Name, walk
from coadjoint.spec.kinds import (
    is_first_order,
    is_in_frame,
    is_on_product,
    is_variational,
    kinds_of,
)
from coadjoint.spec.model import Spec, Time
from coadjoint.spec.routes import ROUTES, Route, energies_of
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.noise import check_noise
from coadjoint.spec.sections.state import Variable
from coadjoint.spec.sections.variables import VARIABLES
from coadjoint.spec.tables import BY_KEY, TABLES, list_formulas

_ENERGIES = ("hamiltonian", "lagrangian")
#: What a kind of spec has, in words.
_KINDS = {
    "algebra": "[algebra]",
    "poisson": "[poisson]",
    "nambu": "nambu functions in [poisson]",
    "canonical": "canonical pairs in [poisson]",
    "configuration": "coordinates with velocities or momenta",
    "diffeomorphisms": "[diffeomorphisms]",
}


def check_tables(source: Source, file: Any) -> None:
    """There is an algebra, a Poisson bracket or neither, and nothing that goes with another.

    Raises:
        SpecError: Both, or neither and no coordinates; a table or route that goes with the other.
    """
    coordinates = any(part.role == "coordinate" for part in file.variables.values())
    if file.algebra is not None and file.diffeomorphisms is not None:
        problem, expected = "there are both [algebra] and [diffeomorphisms]", "one of them"
        raise source.fault(("diffeomorphisms",), problem, "diffeomorphisms", expected)
    nowhere = file.algebra is None and file.poisson is None and file.diffeomorphisms is None
    if nowhere and not coordinates:
        raise source.fault(
            (),
            "the table 'algebra' is missing",
            "algebra",
            "a table [algebra], or [poisson] or coordinates with velocities for a system "
            "without an algebra",
            'Write [algebra] and below it name = "so(3)".',
        )
    if file.algebra is not None and file.poisson is not None:
        problem, expected = "there are both [algebra] and [poisson]", "one of them"
        hint = "The bracket on the dual of an algebra follows from it: remove [poisson]."
        raise source.fault(("poisson",), problem, "poisson", expected, hint)
    if file.algebra is None and file.representations:
        problem = "there is a table [representations] without [algebra]"
        expected, hint = "[representations] only with [algebra]", "Remove [representations]."
        raise source.fault(("representations",), problem, "representations", expected, hint)
    check_noise(source, file)


@dataclass(frozen=True)
class _Obstacle:
    """Why a route cannot be followed.

    Attributes:
        problem: A predicate, such as ``has no Lagrangian``.
        missing: Tables of which one would remove it.
        cure: What would remove it, as a clause; "" if nothing else does.
    """

    problem: str
    missing: tuple[str, ...] = ()
    cure: str = ""


def check_routes(reading: Reading) -> None:
    """Each route starts from tables that are there, and every table is used by a route.

    Raises:
        SpecError: Something is missing for a route, or is used by none.
    """
    file = reading.file
    _check_bare(reading)
    for place, route in enumerate(file.routes):
        obstacles = list(_find_obstacles(file, route))
        if obstacles:
            others = _list_fitting(file)
            problem = f"the route {route} {obstacles[0].problem}"
            expected = f"one of {list_names(others)}" if others else "a route that fits the tables"
            hint = _advise(reading, obstacles, others)
            raise reading.fault(("routes", place), problem, route, expected, hint)
    _check_first(reading.source, file)
    _check_use(reading.source, file)


def _find_obstacles(file: Any, route: str) -> Iterator[_Obstacle]:
    """Why a route cannot be followed with the tables of a spec."""
    start, kinds = ROUTES[route], kinds_of(file)
    if not set(start.kinds) & set(kinds):
        starts = " or ".join(_KINDS[kind] for kind in start.kinds)
        yield _Obstacle(f"starts from {starts}, which is missing")
    if start.table and not getattr(file, start.table):
        yield _Obstacle(f"has no table [{start.table}]", (start.table,))
    if not start.takes_driving and (file.inputs or file.time):
        yield _Obstacle("does not accept inputs or time")
    if file.space and not start.moves_fields:
        yield _Obstacle("moves no fields", cure="remove [space]")
    energies = energies_of(route, kinds)
    if not start.needs_energy:
        if not _is_bare(file) and kinds == ("configuration",):
            yield _Obstacle(
                "has no bracket of coordinates with velocities or momenta",
                cure="declare the momenta as coordinates, with [poisson] and "
                'canonical = [["q", "p"]]',
            )
    elif energies and not any(getattr(file, each) for each in energies):
        names = [each.title() for each in energies]
        one_of = f"no {names[0]}" if len(names) == 1 else f"neither a {' nor a '.join(names)}"
        yield _Obstacle(f"has {one_of}", energies)
    if is_in_frame(file) and not start.in_frame and kinds == ("algebra",):
        yield _Obstacle("moves momenta, and the state has velocities")
    if is_first_order(file) and not _moves_first_order(start):
        yield _Obstacle("moves velocities or momenta, and here all velocities follow")
    variational = is_variational(file)
    if variational and start.is_hamiltonian and file.lagrangian is None:
        yield _Obstacle("has no Lagrangian to vary within the constraints", ("lagrangian",))
    for key in ("forces", "dissipation", "double_bracket", "metriplectic"):
        if variational and getattr(file, key):
            yield _Obstacle(
                f"comes from a variation, which knows no [{key}]", cure=f"remove [{key}]"
            )
    for table in TABLES:
        options = {*start.options}
        if is_first_order(file) and not start.is_first_order:
            options = set()  # what forces do is solved for with the two-form
        if variational:
            options = options - {"constraints"} | (
                {"constraints"} if start.is_hamiltonian else set()
            )
        if table.acts and getattr(file, table.key) and table.key not in options:
            cure = f"remove [{table.key}]"
            if table.key == "noise" and start.in_frame:
                cure = f"declare momenta and take a route that moves them, or {cure}"
            yield _Obstacle(f"does not accept [{table.key}]", cure=cure)


def _moves_first_order(route: Route) -> bool:
    """Whether a route gives velocities as rates of the state: also by a declared bracket."""
    return route.is_first_order or ("poisson" in route.kinds and not route.table)


def _is_bare(file: Any) -> bool:
    """Whether a Lax pair alone moves the state."""
    return bool(file.lax) and not (file.hamiltonian or file.lagrangian or file.newton)


def _check_bare(reading: Reading) -> None:
    """Where a Lax pair alone moves the state, there are no velocities."""
    velocities = [each.name for each in VARIABLES.of(reading) if each.role == "velocity"]
    if _is_bare(reading.file) and velocities:
        problem = f"the velocity {velocities[0]!r} has no energy to follow from"
        expected = "a Lax pair of the state alone, or a table [hamiltonian] with it"
        hint = "Write M in variables of the state, or declare [hamiltonian]."
        raise reading.at_key(("variables", velocities[0]), problem, velocities[0], expected, hint)


def _list_fitting(file: Any, *, first: bool = False) -> list[str]:
    """The routes that can be followed with the tables of a spec, or that can be the first.

    They move the same state: velocities along a frame, or momenta and coordinates.
    """
    moves = [
        name
        for name, each in ROUTES.items()
        if each.in_frame == is_in_frame(file)
        and (_moves_first_order(each) if is_first_order(file) else not each.is_first_order)
    ]
    if first:
        roles = {part.role for part in file.variables.values()}
        paired = file.poisson is not None or "momentum" in roles or file.lagrangian is None
        moves = [name for name in moves if ROUTES[name].emitted]
        moves = [name for name in moves if name != "canonical" or paired]
    return [name for name in moves if not any(_find_obstacles(file, name))]


def _advise(reading: Reading, obstacles: Sequence[_Obstacle], others: Sequence[str]) -> str:
    """What to do about a route that cannot be followed; a single obstacle may be removed."""
    routes = reading.file.routes
    route = next(each for each in routes if any(_find_obstacles(reading.file, each)))
    ways = [f'remove "{route}"'] if any(each in others for each in routes) else []
    if not ways and others:
        ways = [f'write "{others[0]}" in its place']
    (obstacle, *more) = obstacles
    if not more:
        ways += list(filter(None, (_write_table(reading, each) for each in obstacle.missing)))[:1]
        ways += [obstacle.cure] if obstacle.cure else []
    text = ", or ".join(ways)
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _write_table(reading: Reading, table: str) -> str:
    """How a missing table is written, with the names of the spec; "" without an example."""
    role = {"lagrangian": "velocity", "hamiltonian": "momentum"}.get(table)
    example = BY_KEY[table].example
    if role is not None:
        squares = [_square(each) for each in VARIABLES.of(reading) if each.role == role]
        example = f'{example[0]} = "{" + ".join(squares)}"' if squares else ""
    return f"write [{table}] and below it {example}" if example else ""


def _square(variable: Variable) -> str:
    """Half the square of a variable, as a formula."""
    name, rank = variable.name, len(variable.value_shape)
    return (f"{name}^2/2", f"dot({name}, {name})/2", f"trace(transpose({name})*{name})/2")[rank]


def _check_first(source: Source, file: Any) -> None:
    """The first route gives the rates of the declared state, and all that is emitted."""
    first, fitting = file.routes[0], _list_fitting(file, first=True)
    if first in fitting:
        return
    problem = "cannot be the first: it is there to be proved equal to another"
    if ROUTES[first].emitted:
        follows = is_in_frame(file) and first != "canonical"
        problem = "cannot be the first: here it is there to be proved equal to another"
        problem = problem if follows else "moves momenta, and the state has velocities"
    problem, expected = f"the route {first} {problem}", f"one of {list_names(fitting)} before it"
    hint = f'Put "{fitting[0]}" first.' if fitting else ""
    raise source.fault(("routes", 0), problem, first, expected, hint)


def _check_use(source: Source, file: Any) -> None:
    """A Hamiltonian, a Lagrangian or another table that no route reads is a mistake."""
    kinds = kinds_of(file)
    takes = {
        name: {*energies_of(name, kinds), each.table, *each.options}
        for name, each in ROUTES.items()
    }
    for table in TABLES:
        if table.routed and getattr(file, table.key):
            key = table.key
            if key == "lax" and (source.members is not None or file.reduction):
                continue  # of equal members and on a section, it is a claim about the motion
            if any(key in takes[route] for route in file.routes):
                continue
            readers = [name for name in _list_fitting(file) if key in takes[name]]
            add = f'Add "{readers[0]}" to routes, or remove' if readers else "Remove"
            raise source.fault(
                (key,),
                f"no route uses the {key.title() if key in _ENERGIES else f'table [{key}]'}",
                key,
                f"one of the routes {list_names(readers)}" if readers else f"no table [{key}] here",
                f"{add} [{key}].",
            )


def check_used(source: Source, spec: Spec) -> None:
    """Every input, and the time if it is declared as such, occurs in some formula.

    Raises:
        SpecError: One does not.
    """
    named = _list_named(spec)
    for each in spec.driving:
        is_other = each is spec.time and spec.time.label != Time.label
        if not is_other and not named & {each.name, *each.components}:
            key: KeyPath = ("time",) if each is spec.time else ("inputs", each.name)
            rest = "remove [time]" if each is spec.time else "remove it from [inputs]"
            problem = f"{each.name!r} occurs in no formula"
            expected = f"a formula that names {list_names(each.components)}"
            hint = f"Use it in the energy or a force, or {rest}."
            raise source.at_key(key, problem, each.name, expected, hint)


def set_clock(spec: Spec) -> Spec:
    """The spec with its independent variable, which drives what has formulas that name it."""
    if spec.time is None:
        return spec
    time = spec.time if spec.time.name in _list_named(spec) else None
    return replace(spec, clock=spec.time, time=time)


def _list_named(spec: Spec) -> set[str]:
    """The names in all formulas, and rates of inputs."""
    trees = [formula.tree for formula in list_formulas(spec)]
    named = {n.name for tree in trees for n in walk(tree) if isinstance(n, Name | Index)}
    return named | {each.rate for each in spec.inputs}


_PLURALS = {"momentum": "momenta", "velocity": "velocities"}


def check_blocks(reading: Reading) -> None:
    """Velocities share no direction of the algebra, momenta neither, and both have the same blocks.

    Raises:
        SpecError: Two overlap, or one has no partner.
    """
    algebra, variables = ALGEBRA.of(reading).algebra, VARIABLES.of(reading)
    if algebra is None:
        return
    of_role = {role: [v for v in variables if v.role == role and not v.of] for role in _PLURALS}
    for role, members in of_role.items():
        _check_overlaps(reading, role, members, algebra)
    if not all(of_role.values()):
        return
    for role, partner in (("velocity", "momentum"), ("momentum", "velocity")):
        blocks = [variable.block for variable in of_role[partner]]
        for variable in of_role[role]:
            if variable.block not in blocks:
                span = list_names(algebra.basis[place] for place in variable.block)
                raise reading.at_key(
                    ("variables", variable.name),
                    f"the {role} {variable.name!r} has no {partner} of the same block",
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
                    f"Blocks of {algebra.name} are {list_names(algebra.blocks) or 'undeclared'}.",
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
            _check_partners(reading)
        elif any(variable.role == "coordinate" for variable in VARIABLES.of(reading)):
            _check_partners(reading)
        if file.lagrangian is not None:
            _check_spanned(reading, "velocity", "Omega", algebra)
    elif (file.poisson is None and not _is_bare(file)) or file.lagrangian is not None:
        _check_partners(reading)


def _check_partners(reading: Reading) -> None:
    """Every coordinate of a configuration space has a velocity where velocities are asked for."""
    variables = VARIABLES.of(reading)
    owned = {role: {v.of for v in variables if v.role == role} for role in _PLURALS}
    product = is_on_product(reading.file)
    wanted = ["velocity"] if reading.file.lagrangian is not None else ["velocity", "momentum"]
    wanted = ["momentum"] if product else wanted
    for variable in variables:
        name = variable.name
        if variable.role != "coordinate":
            continue
        lacking = not any(name in owned[role] for role in wanted)
        some = owned["momentum"] and not is_first_order(reading.file)
        slow = product and reading.file.lagrangian is not None and name not in owned["velocity"]
        if slow and not lacking:
            raise _lacks(reading, name, "velocity", "velocity", "a velocity of each coordinate")
        if lacking or (some and name not in owned["momentum"]):
            role = wanted[-1] if lacking else "momentum"
            problem = " and no ".join(wanted) if lacking else "momentum, and others have"
            expected = f"a {role} of each coordinate" if lacking else "momenta of all coordinates"
            raise _lacks(reading, name, problem, role, expected)


def _lacks(reading: Reading, name: str, what: str, role: str, expected: str) -> CoadjointError:
    """A coordinate without a partner."""
    partner = reading.free_name("v" if role == "velocity" else "p", name)
    problem = f"the coordinate {name!r} has no {what}"
    hint = f'Write for instance {partner} = {{ role = "{role}", of = "{name}" }}.'
    return reading.at_key(("variables", name), problem, name, expected, hint)


def _check_spanned(reading: Reading, role: str, example: str, algebra: LieAlgebra) -> None:
    """The variables of a role span the whole algebra."""
    covered = {place for v in VARIABLES.of(reading) if v.role == role for place in v.block}
    left = [algebra.basis[place] for place in range(algebra.dimension) if place not in covered]
    if left:
        names = ", ".join(f'"{name}"' for name in left)
        block = f", block = [{names}]" if covered else ""
        problem = f"no {role} spans {list_names(left)}"
        expected = f"{_PLURALS[role]} over the whole of {algebra.name}"
        hint = f'Write for instance {reading.free_name(example)} = {{ role = "{role}"{block} }}.'
        raise reading.fault(("variables",), problem, list_names(left), expected, hint)
