"""Consistency: what must hold between the parts of a spec before any route can be followed.

Comes in: the records of a spec. Goes out: nothing, or a `SpecError` that names what is missing and
how to write it. Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.errors import CoadjointError, LimitError
from coadjoint.limits import PARAMETER_COMPONENTS, STATE_COMPONENTS
from coadjoint.spec.faults import listed
from coadjoint.spec.model import Parameter, Variable
from coadjoint.spec.names import derived_names, refusal
from coadjoint.spec.positions import KeyPath
from coadjoint.spec.schema import SpecFile
from coadjoint.spec.source import Source

#: A declared thing: its key, its name, the names of its components, and the names of its rates.
_Declared = tuple[KeyPath, str, tuple[str, ...], tuple[str, ...]]


def check_names(
    source: Source,
    variables: Sequence[Variable],
    parameters: Sequence[Parameter],
    observables: Iterable[str],
) -> None:
    """Every name is free and declared once, components and rates included.

    Raises:
        SpecError: A reserved or doubled name, with a suggestion.
    """
    owners: dict[str, str] = {}
    for key, name, components, rates in _declared(variables, parameters, observables):
        for derived in dict.fromkeys((name, *components)):
            refused = refusal(derived)
            if refused is not None:
                problem, expected, hint = refused
                if derived != name:
                    problem = f"{problem}, and so would be a component of {name!r}"
                    hint = "Choose another name."
                raise _at_key(source, key, problem, derived, expected, hint)
        for derived in dict.fromkeys((name, *components, *rates)):
            if derived in owners:
                problem = f"{derived!r} is doubled: {owners[derived]} has that name too"
                hint = "The components of I with shape [3] are I1, I2, I3."
                raise _at_key(
                    source, key, problem, derived, "names and components that differ", hint
                )
        for derived in (name, *components, *rates):
            owners[derived] = f"{key[0]}.{name}"


def _declared(
    variables: Sequence[Variable], parameters: Sequence[Parameter], observables: Iterable[str]
) -> Iterable[_Declared]:
    for variable in variables:
        rates = () if variable.role == "velocity" else tuple(derived_names(variable.components))
        yield ("variables", variable.name), variable.name, variable.components, rates
    for parameter in parameters:
        yield ("parameters", parameter.name), parameter.name, parameter.components, ()
    for name in observables:
        yield ("observables", name), name, (), ()


def check_sizes(
    source: Source, variables: Sequence[Variable], parameters: Sequence[Parameter]
) -> None:
    """The state and the parameters are not too many.

    Raises:
        LimitError: More components than the limit.
    """
    state = [variable for variable in variables if variable.role != "velocity"]
    for key, quantities, limit, most in (
        ("variables", state, "STATE_COMPONENTS", STATE_COMPONENTS),
        ("parameters", parameters, "PARAMETER_COMPONENTS", PARAMETER_COMPONENTS),
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
    """There is an algebra or a Poisson bracket, not both, and nothing of the one beside the other.

    Raises:
        SpecError: Neither, both, or a table or route that goes with the other.
    """
    if file.algebra is None and file.poisson is None:
        raise source.fault(
            (),
            "the table 'algebra' is missing",
            found="algebra",
            expected="a table [algebra], or [poisson] for a system without an algebra",
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
    _check_roads(source, file)
    for table in ("representations", "lagrangian"):
        if file.poisson is not None and getattr(file, table):
            raise source.fault(
                (table,),
                f"there is a table [{table}] beside [poisson]",
                found=table,
                expected=f"[{table}] beside [algebra] alone",
                hint=f"Remove [{table}].",
            )


def _check_roads(source: Source, file: SpecFile) -> None:
    """Each route starts from a table that is there."""
    nambu = file.poisson is not None and file.poisson.nambu is not None
    starts = {
        "algebra": (file.algebra is not None, ("euler-poincare", "lie-poisson")),
        "poisson": (file.poisson is not None, ("poisson", "nambu") if nambu else ("poisson",)),
    }
    routes = next(routes for is_there, routes in starts.values() if is_there)
    for place, route in enumerate(file.routes):
        if route not in routes:
            missing = "nambu functions in [poisson]" if file.poisson is not None else "[poisson]"
            if route in starts["algebra"][1]:
                missing = "[algebra]"
            raise source.fault(
                ("routes", place),
                f"the route {route} starts from {missing}, which is not there",
                found=route,
                expected=f"one of {listed(routes)}",
            )


def check_routes(
    source: Source, file: SpecFile, variables: Sequence[Variable], algebra: LieAlgebra | None
) -> None:
    """Each route finds the variables and the energy that it starts from.

    Raises:
        SpecError: Something is missing for a route, or is used by none.
    """
    if algebra is None:
        if file.hamiltonian is None:
            raise _missing(
                source,
                f"the route {file.routes[0]} has no Hamiltonian",
                "hamiltonian",
                'Write [hamiltonian] and below it h = "dot(p, p)/2".',
            )
        return
    _check_energies(source, file)
    _check_covered(source, "momentum", "Pi", variables, algebra)
    if file.lagrangian is not None:
        _check_covered(source, "velocity", "Omega", variables, algebra)


def _check_energies(source: Source, file: SpecFile) -> None:
    """A Lagrangian or a Hamiltonian where a route needs it, and no Hamiltonian in vain."""
    if file.lagrangian is None and "euler-poincare" in file.routes:
        raise _missing(
            source,
            "the route euler-poincare has no Lagrangian",
            "lagrangian",
            'Write [lagrangian] and below it l = "dot(Omega, diag(I)*Omega)/2".',
        )
    if file.lagrangian is None and file.hamiltonian is None:
        raise _missing(
            source,
            "the route lie-poisson has neither a Hamiltonian nor a Lagrangian",
            "hamiltonian",
            'Write [hamiltonian] and below it h = "dot(Pi, inverse(diag(I))*Pi)/2".',
        )
    if file.hamiltonian is not None and "lie-poisson" not in file.routes:
        raise source.fault(
            ("hamiltonian",),
            "no route uses the Hamiltonian",
            found="hamiltonian",
            expected="the route lie-poisson beside it",
            hint='Add "lie-poisson" to routes, or remove [hamiltonian].',
        )


def _missing(source: Source, problem: str, found: str, hint: str) -> CoadjointError:
    expected = f"a table [{found}]"
    return source.fault(("routes",), problem, found=found, expected=expected, hint=hint)


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
