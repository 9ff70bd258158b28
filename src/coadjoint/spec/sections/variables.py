"""Variables: the table [variables], with shapes, blocks of the algebra and the state.

Comes in: its keys, and the algebra where there is one. Goes out: `Variable` records.
Read next: `coadjoint.spec.sections.definitions`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from math import prod
from typing import Annotated, Any, Literal

from pydantic import Field

from coadjoint.algebra.catalogue import ATTITUDES
from coadjoint.algebra.catalogue import REPRESENTATIONS as KNOWN
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix
from coadjoint.algebra.representation import Representation
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import FORMS, Shape, matrix_size
from coadjoint.spec.core.faults import did_you_mean, list_names
from coadjoint.spec.core.names import derived_names
from coadjoint.spec.core.parts import Part, name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Naming, Reading, Table
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import (
    Block,
    Numbers,
    Prose,
    Side,
    Unit,
    misfit_form,
    read_default,
)
from coadjoint.spec.kinds import is_first_order, is_on_product
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.following import bind_velocity, let_follow
from coadjoint.spec.sections.matrices import (
    block_places,
    check_elements,
    check_planes,
    representation_of,
)
from coadjoint.spec.sections.representations import REPRESENTATIONS
from coadjoint.spec.sections.solved import find_solved_velocities
from coadjoint.spec.sections.state import Variable, state_of
from coadjoint.spec.sections.turning import TURNING, advect, find_shape, read_rotation

#: Keys that say how large a variable is, and the variables that each is for.
_OWN_KEYS = {
    "block": "velocities, momenta and advected quantities",
    "representation": "advected quantities",
    "shape": "coordinates",
    "of": "velocities and momenta of coordinates",
    "form": "velocities, momenta, advected quantities and coordinates",
    "default": "quantities of the state",
    "follows": "coordinates, momenta and advected quantities",
}
_KEYS_OF = {
    "velocity": ("block", "of", "form", "default"),
    "momentum": ("block", "of", "form", "default", "follows"),
    "advected": ("representation", "block", "form", "default", "follows"),
    "coordinate": ("shape", "form", "default", "follows"),
    "attitude": ("block", "default"),
    "quaternion": ("block", "default"),
    "pose": ("block", "default"),
    "strain": ("form", "default"),
    "contact": ("default",),
}

#: Components of a point of contact.
SPACE = 3


class VariablePart(Part):
    """A velocity, a momentum, an advected quantity, a coordinate, an attitude or a contact."""

    role: Literal[
        "velocity",
        "momentum",
        "advected",
        "coordinate",
        "attitude",
        "quaternion",
        "pose",
        "strain",
        "contact",
    ] = Field(
        description="'velocity', 'momentum', 'advected' over an algebra; 'coordinate' without one, "
        "with a 'velocity' or 'momentum' of it; 'attitude' for a rotation matrix R, 'quaternion' "
        "for a unit quaternion, 'pose' for the matrix [R, x] of attitude and position; 'strain' "
        "for the field g^-1 dg/ds of a strand in [space]; 'contact' for a point at which "
        "[rolling] has a body touch a surface"
    )
    block: Block | None = Field(
        None,
        description="the block of the algebra that it spans or, of an advected quantity, that "
        "acts on it by its own representation; by default all of it",
    )
    representation: str | None = Field(
        None,
        description="how the algebra acts on an advected quantity: 'vector', 'adjoint', "
        "'coadjoint' and others, or a declared one",
    )
    shape: Annotated[list[Side], Field(max_length=1)] | None = Field(
        None, description="of a coordinate: [] for a scalar (the default), [n] for n components"
    )
    of: str | None = Field(
        None,
        description="the coordinate whose velocity, or conjugate momentum, it is; its shape and "
        "form are those of the coordinate",
    )
    form: Literal["antisymmetric", "symmetric", "matrix"] | None = Field(
        None,
        description="the square matrix that it is in formulas: its components are the entries "
        "above the diagonal, those with the diagonal, or all, row by row",
    )
    follows: bool | list[str] | None = Field(
        None,
        description="true for a coordinate, momentum or advected quantity that the constraints of "
        "a singular Lagrangian give in terms of the others, on the route first-order; or a list of "
        "those of its components that they give",
    )
    default: Numbers | None = Field(
        None,
        description="where `coadjoint simulate` begins unless told otherwise: a number for all "
        "components, or a list of them",
    )
    index: str | None = Field(
        None, description="the index of [index] that counts the members that have it"
    )
    repeats: bool = Field(
        False,
        description="whether the entries of its default, of which N is a multiple, are taken again "
        "and again along the members",
    )
    unit: Unit = ""
    doc: Prose = Field("", description="what it is, for documents")


def read_variables(reading: Reading, parts: Mapping[str, VariablePart]) -> tuple[Variable, ...]:
    """The variables, each with its place in the algebra, or its shape where there is none.

    Raises:
        SpecError: A key does not go with the role, the role not with the spec, the block or the
            representation is unknown, or the components fill no matrix of the form.
        LimitError: The state has too many components.
    """
    solved = find_solved_velocities(reading.file)
    variables = tuple(_read_variable(reading, name, part, solved) for name, part in parts.items())
    reading.check_count("state", "variables", state_of(variables), "STATE_COMPONENTS")
    return variables


def _read_variable(
    reading: Reading, name: str, part: VariablePart, solved: Mapping[str, Any] | None
) -> Variable:
    """One variable; velocities that constraints give are not part of the state."""
    source, parts = reading.source, reading.file.variables
    algebra, invariance = ALGEBRA.of(reading).algebra, ALGEBRA.of(reading).invariance
    key: KeyPath = ("variables", name)
    for alien in _OWN_KEYS:
        if alien not in _KEYS_OF[part.role] and getattr(part, alien) is not None:
            raise _alien_key(source, (*key, alien), part)
    follows = bool(part.follows) or (part.role == "velocity" and is_first_order(reading.file))
    if part.follows and not is_first_order(reading.file):
        problem = f"{name!r} follows from constraints that only the route first-order finds"
        expected = 'routes = ["first-order"], or a coordinate of the state'
        raise source.fault((*key, "follows"), problem, "true", expected, "Remove follows.")
    if part.follows and reading.file.poisson is not None:
        problem = f"{name!r} follows, and the bracket of [poisson] is one of all coordinates"
        expected = "a state of all of them, or no [poisson]"
        raise source.fault((*key, "follows"), problem, "true", expected, "Remove follows.")
    whole = follows and not isinstance(part.follows, list)
    if part.default is not None and (whole or not _is_state(name, part, parts, solved)):
        raise _alien_key(source, (*key, "default"), part)
    turning = part.role if part.role in TURNING else ""
    if turning and algebra is not None:
        part = advect(part, algebra)
    strain = part.role == "strain"
    if strain:
        _check_strain(source, key, part, reading.file)
        part = part.model_copy(update={"role": "advected", "representation": "adjoint"})
    block: tuple[int, ...] = ()
    given: Shape = ()
    representation = None
    constrained = solved is not None
    paired = constrained or is_on_product(reading.file)
    belongs = part.of is not None and any(x.role == "coordinate" for x in parts.values())
    if part.role == "momentum" and constrained:
        raise _constrained_momentum(source, key)
    if part.role == "contact":
        _check_rolling(reading, key)
        count, flat = SPACE, True
    elif reading.file.diffeomorphisms is not None:
        count, flat = 1, False
    elif part.role == "coordinate" or algebra is None or (paired and belongs):
        if not paired or part.role in ("advected", *TURNING):
            _check_role(source, key, part, algebra)
        if part.role != "coordinate":
            part = _as_partner(source, key, part, parts)
        count = prod(part.shape or [1])
        flat = bool(part.shape)
    elif part.of is not None:
        if part.of in parts:  # a coordinate, which these routes do not move
            _check_role(source, ("variables", part.of), parts[part.of], algebra)
        raise _alien_key(source, (*key, "of"), part)
    elif part.role == "advected":
        representation = _representation(
            source, key, part, algebra, REPRESENTATIONS.of(reading), invariance
        )
        count = representation.dimension
        flat = count > 1
    else:
        block = tuple(range(algebra.dimension))
        if part.block is not None:
            block = block_places(source, (*key, "block"), part.block, algebra)
        count, flat = len(block), len(block) > 1
    form = part.form or _own_form(part.representation, count)
    if turning and representation is not None:
        given = find_shape(source, key, turning, representation, invariance)
        form = form if turning == "quaternion" else ""
    if form in FORMS and matrix_size(count, form) is None:
        along = [algebra.basis[place] for place in block] if algebra is not None else ()
        raise misfit_form(source, (*key, "form"), count, form, along)
    elements: tuple[SparseMatrix, ...] = ()
    spanned = block
    if strain and algebra is not None:
        spanned = tuple(range(algebra.dimension))
    if form and spanned and algebra is not None and algebra.elements:
        check_elements(source, (*key, "form"), algebra, spanned, form)
        elements = algebra.elements if part.role == "velocity" or strain else ()
    elif form == "antisymmetric" and block and algebra is not None:
        check_planes(source, (*key, "form"), algebra, block)
    shape: Shape = (count,) if flat or form else ()
    read_start = partial(read_rotation, role=turning) if turning else read_default
    shape = given or shape
    variable = Variable(
        name=name,
        role=part.role,
        shape=shape,
        block=block,
        representation=representation,
        unit=part.unit,
        doc=part.doc,
        form=form,
        of=part.of or "",
        elements=elements,
        default=read_start(source, (*key, "default"), part.default, shape),
        turning=turning,
        follows=follows,
        strain=strain,
    )
    if isinstance(part.follows, list):
        return let_follow(reading, variable, part.follows)
    return variable if part.role != "velocity" else bind_velocity(reading, variable, solved)


def _check_strain(source: Source, key: KeyPath, part: VariablePart, file: Any) -> None:
    """A strain is along a strand: an algebra and a coordinate of space are there."""
    for table, example in (("space", 's = { length = "L" }'), ("algebra", 'name = "so(3)"')):
        if not getattr(file, table):
            problem = f"the strain {key[-1]!r} stands without [{table}]"
            hint = f"Write [{table}] and below it {example}."
            raise source.fault((*key, "role"), problem, part.role, f"a table [{table}]", hint)


def _check_rolling(reading: Reading, key: KeyPath) -> None:
    """A point of contact has a table that says of which surfaces."""
    rolling = reading.file.rolling
    if rolling is None or key[-1] not in (rolling.contact, rolling.point):
        problem = f"nothing says which surfaces touch at {key[-1]!r}"
        expected = f'[rolling] with contact = "{key[-1]}", in space, or with point, on the body'
        raise reading.fault((*key, "role"), problem, "contact", expected)


def _is_state(
    name: str, part: VariablePart, parts: Mapping[str, VariablePart], solved: Collection[str] | None
) -> bool:
    """Whether a variable is part of the state; see `quantities.state_of`."""
    if solved is not None:
        return name not in solved
    given = {each.of for each in parts.values() if each.role == "momentum"}
    return part.role != "velocity" or (part.of is not None and part.of not in given)


def _constrained_momentum(source: Source, key: KeyPath) -> CoadjointError:
    problem = f"{key[-1]!r} is a momentum, and the state has velocities on these routes"
    expected = "velocities, which are the state on the routes nonholonomic and hamel"
    hint = "Remove it; the velocities that no constraint gives are the state."
    return source.fault((*key, "role"), problem, "momentum", expected, hint)


def _as_partner(
    source: Source, key: KeyPath, part: VariablePart, parts: Mapping[str, VariablePart]
) -> VariablePart:
    """A velocity or momentum with the shape and form of its coordinate."""
    coordinates = [name for name, each in parts.items() if each.role == "coordinate"]
    if part.of is None:
        problem = f"the {part.role} {key[-1]!r} belongs to no coordinate"
        expected = f"of = one of {list_names(coordinates)}" if coordinates else "a coordinate"
        hint = _advise_partner(part.role, parts, coordinates)
        raise source.fault((*key, "role"), problem, part.role, expected, hint)
    if part.of not in coordinates:
        problem = f"there is no coordinate {part.of!a}"
        expected = f"one of {list_names(coordinates)}" if coordinates else "a declared coordinate"
        hint = did_you_mean(part.of, coordinates)
        raise source.fault((*key, "of"), problem, part.of, expected, hint)
    rivals = [n for n, each in parts.items() if (each.role, each.of) == (part.role, part.of)]
    if rivals[0] != key[-1]:
        problem = f"{rivals[0]!r} is the {part.role} of {part.of!r} already"
        expected = f"one {part.role} for each coordinate"
        raise source.fault((*key, "of"), problem, part.of, expected)
    whole = parts[part.of]
    return part.model_copy(update={"shape": whole.shape, "form": whole.form})


def _advise_partner(
    role: str, parts: Mapping[str, VariablePart], coordinates: Sequence[str]
) -> str:
    """How a velocity or momentum says what it belongs to."""
    taken = {each.of for each in parts.values() if each.role == role}
    free = [name for name in coordinates if name not in taken]
    if free:
        return f'Add for instance of = "{free[0]}".'
    name = "q" if "q" not in parts else "q_0"
    return f'Write {name} = {{ role = "coordinate" }}, and add of = "{name}".'


def _alien_key(source: Source, key: KeyPath, part: VariablePart) -> CoadjointError:
    *_, name, alien = key
    problem = f"the {part.role} {name!r} has a {alien}"
    expected = f"{alien} for {_OWN_KEYS[str(alien)]} alone"
    return source.fault(key, problem, str(getattr(part, str(alien))), expected, f"Remove {alien}.")


def _check_role(
    source: Source, key: KeyPath, part: VariablePart, algebra: LieAlgebra | None
) -> None:
    """Coordinates do without an algebra, advected quantities do not."""
    hint = ""
    if part.role == "coordinate" and algebra is not None:
        place, roles = "with [algebra]", "the roles 'velocity', 'momentum' and 'advected'"
        hint = 'With velocities as the state it may: write routes = ["nonholonomic"] at the top.'
        hint += " With momenta it may on the routes euler-poincare and lie-poisson."
    elif part.role in ("advected", *TURNING) and algebra is None:
        place, roles = "without [algebra]", "the roles 'coordinate', 'velocity' and 'momentum'"
    else:
        return
    problem = f"{key[-1]!r} has the role {part.role!r} {place}"
    raise source.fault((*key, "role"), problem, part.role, f"{roles} {place}", hint)


def _representation(
    source: Source,
    key: KeyPath,
    part: VariablePart,
    algebra: LieAlgebra,
    declared: Mapping[str, Representation],
    invariance: str,
) -> Representation:
    """The action on an advected quantity."""
    if part.representation is None:
        problem = f"the advected quantity {key[-1]!r} has no representation"
        expected = f"representation = one of {list_names((*KNOWN, *declared))}"
        hint = f'Write representation = "{"vector" if algebra.matrices else "coadjoint"}".'
        raise source.fault(key, problem, str(key[-1]), expected, hint)
    inner, name, places = (*key, "representation"), part.representation, tuple[int, ...]()
    if part.block is not None:
        if name in declared:
            problem = f"{key[-1]!r} has a block, and {name!r} is declared for the whole algebra"
            expected = f"a representation that every algebra has: {list_names(KNOWN)}"
            raise source.fault((*key, "block"), problem, part.block, expected, "Remove block.")
        places = block_places(source, (*key, "block"), part.block, algebra)
        inner = (*key, "block")
    return representation_of(source, inner, algebra, name, declared, invariance, places)


def _own_form(representation: str | None, count: int) -> str:
    """The form that an attitude has by itself: a unit quaternion, or a square matrix."""
    if representation not in ATTITUDES:
        return ""
    if representation == "quaternion":
        return "quaternion"
    return "matrix" if count > 1 and matrix_size(count, "matrix") else ""


def _name_all(table: str, variables: Sequence[Variable]) -> Iterator[Naming]:
    """The names of variables, of their components, and of the rates of the state."""
    state = {name for each in state_of(variables) for name in each.components}
    for each in variables:
        rates = tuple(derived_names(x for x in each.components if x in state))
        yield Naming(
            key=(table, each.name), name=each.name, components=each.components, rates=rates
        )


def state_roles(reading: Reading) -> tuple[str, ...]:
    """Roles of the state: momenta or, of coordinates without them, velocities, and positions."""
    return tuple(dict.fromkeys(each.role for each in state_of(VARIABLES.of(reading))))


def motion_roles(reading: Reading) -> tuple[str, ...]:
    """Roles of the state and of the velocities."""
    return tuple(dict.fromkeys(("velocity", *(each.role for each in VARIABLES.of(reading)))))


def position_roles(reading: Reading) -> tuple[str, ...]:
    """Roles of the positions: what a Lagrangian is a function of, apart from the velocities."""
    roles = motion_roles(reading)
    default = "coordinate" if ALGEBRA.of(reading).algebra is None else "advected"
    return tuple(each for each in roles if each not in ("velocity", "momentum")) or (default,)


VARIABLES = Table[tuple[Variable, ...]](
    "variables",
    VariablePart,
    "the variables by name",
    read_variables,
    many=True,
    field=(
        dict[str, VariablePart],
        Field(min_length=1, description="the variables by name", json_schema_extra=name_pattern()),
    ),
    quantities=True,
    names=_name_all,
    example='Pi = { role = "momentum" }',
)
