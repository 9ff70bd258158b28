"""Tiling: whether velocities and momenta cover the algebra or the coordinates, each place once.

Comes in: the variables that were read. Goes out: nothing, or a `SpecError` that names what is
missing or doubled. Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.reading import Reading
from coadjoint.spec.routes import is_in_frame
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.variables import VARIABLES, Variable

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
