"""Structure: the variables and parameters of a spec, with their shapes.

Comes in: the validated tables, and the algebra where there is one. Goes out: records of
`coadjoint.spec.model`. Read next: `coadjoint.spec.sections.poisson` and
`coadjoint.spec.core.formulas`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from fractions import Fraction
from math import prod
from types import MappingProxyType

from coadjoint.algebra.catalogue import ATTITUDES, REPRESENTATIONS
from coadjoint.algebra.families import so_indefinite
from coadjoint.algebra.lie_algebra import LieAlgebra, SparseMatrix
from coadjoint.algebra.matrices import size
from coadjoint.algebra.representation import Representation
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import FORMS
from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.model import Input, Parameter, Shape, Variable, matrix_size
from coadjoint.spec.schema import InputPart, ParameterPart, VariablePart
from coadjoint.spec.sections.representations import block_places, representation_of

#: Keys that say how large a variable is, and the variables that each is for.
_OWN_KEYS = {
    "block": "velocities and momenta",
    "representation": "advected quantities",
    "shape": "coordinates",
    "of": "velocities and momenta of coordinates",
    "default": "quantities of the state",
}
_KEYS_OF = {
    "velocity": ("block", "of", "default"),
    "momentum": ("block", "of", "default"),
    "advected": ("representation", "default"),
    "coordinate": ("shape", "default"),
}


def read_variable(
    source: Source,
    name: str,
    part: VariablePart,
    algebra: LieAlgebra | None,
    representations: Mapping[str, Representation],
    parts: Mapping[str, VariablePart] = MappingProxyType({}),
    invariance: str = "left",
    solved: Collection[str] | None = None,
) -> Variable:
    """A variable with its place in the algebra, or its shape where there is none.

    Args:
        source: The spec file, for messages.
        name: As declared.
        part: What is declared of it.
        algebra: The algebra of the velocities, if any.
        representations: Declared ones, by name.
        parts: All that is declared, for coordinates that others are velocities of.
        invariance: Of the motion: the side from which an attitude is seen.
        solved: Velocities that constraints give; None without constraints.

    Raises:
        SpecError: A key does not go with the role, the role not with the spec, the block or the
            representation is unknown, or the components fill no matrix of the form.
    """
    key: KeyPath = ("variables", name)
    for alien in _OWN_KEYS:
        if alien not in _KEYS_OF[part.role] and getattr(part, alien) is not None:
            raise _alien_key(source, (*key, alien), part)
    if part.default is not None and not _is_state(name, part, parts, solved):
        raise _alien_key(source, (*key, "default"), part)
    block: tuple[int, ...] = ()
    representation = None
    constrained = solved is not None
    if part.role == "momentum" and constrained:
        raise _constrained_momentum(source, key)
    if part.role == "coordinate" or algebra is None or (constrained and part.of is not None):
        if not constrained or part.role == "advected":
            _check_role(source, key, part, algebra)
        if part.role != "coordinate":
            part = _as_partner(source, key, part, parts)
        count = prod(part.shape or [1])
        flat = bool(part.shape)
    elif part.of is not None:
        raise _alien_key(source, (*key, "of"), part)
    elif part.role == "advected":
        representation = _representation(source, key, part, algebra, representations, invariance)
        count = representation.dimension
        flat = count > 1
    else:
        block = _block(source, (*key, "block"), part, algebra)
        count, flat = len(block), len(block) > 1
    form = part.form or _own_form(representation)
    if form in FORMS and matrix_size(count, form) is None:
        raise _misfit(source, (*key, "form"), count, form)
    elements: tuple[SparseMatrix, ...] = ()
    if form and block and algebra is not None and algebra.elements:
        _check_elements(source, (*key, "form"), algebra, block, form)
        elements = algebra.elements if part.role == "velocity" else ()
    elif form == "antisymmetric" and block and algebra is not None:
        _check_planes(source, (*key, "form"), algebra, block)
    shape: Shape = (count,) if flat or form else ()
    return Variable(
        name,
        part.role,
        shape,
        block,
        representation,
        part.unit,
        part.doc,
        form,
        part.of or "",
        elements,
        read_default(source, (*key, "default"), part.default, shape),
        name not in solved if solved is not None and part.role == "velocity" else None,
    )


def _is_state(
    name: str,
    part: VariablePart,
    parts: Mapping[str, VariablePart],
    solved: Collection[str] | None,
) -> bool:
    """Whether a variable is part of the state; see `quantities.state_of`."""
    if solved is not None:
        return name not in solved
    given = {each.of for each in parts.values() if each.role == "momentum"}
    return part.role != "velocity" or (part.of is not None and part.of not in given)


def _constrained_momentum(source: Source, key: KeyPath) -> CoadjointError:
    return source.fault(
        (*key, "role"),
        f"{key[-1]!r} is a momentum, and the state has velocities on these routes",
        found="momentum",
        expected="velocities, which are the state on the routes nonholonomic and hamel",
        hint="Remove it; the velocities that no constraint gives are the state.",
    )


def _as_partner(
    source: Source, key: KeyPath, part: VariablePart, parts: Mapping[str, VariablePart]
) -> VariablePart:
    """A velocity or momentum with the shape and form of its coordinate."""
    coordinates = [name for name, each in parts.items() if each.role == "coordinate"]
    if part.of is None:
        raise source.fault(
            (*key, "role"),
            f"the {part.role} {key[-1]!r} belongs to no coordinate",
            found=part.role,
            expected=f"of = one of {listed(coordinates)}" if coordinates else "a coordinate",
            hint="Add for instance " + f'of = "{coordinates[0] if coordinates else "q"}".',
        )
    if part.of not in coordinates:
        raise source.fault(
            (*key, "of"),
            f"there is no coordinate {part.of!a}",
            found=part.of,
            expected=f"one of {listed(coordinates)}" if coordinates else "a declared coordinate",
            hint=did_you_mean(part.of, coordinates),
        )
    rivals = [n for n, each in parts.items() if (each.role, each.of) == (part.role, part.of)]
    if rivals[0] != key[-1]:
        raise source.fault(
            (*key, "of"),
            f"{rivals[0]!r} is the {part.role} of {part.of!r} already",
            found=part.of,
            expected=f"one {part.role} for each coordinate",
        )
    whole = parts[part.of]
    return part.model_copy(update={"shape": whole.shape, "form": whole.form})


def _alien_key(source: Source, key: KeyPath, part: VariablePart) -> CoadjointError:
    *_, name, alien = key
    return source.fault(
        key,
        f"the {part.role} {name!r} has a {alien}",
        found=str(getattr(part, str(alien))),
        expected=f"{alien} for {_OWN_KEYS[str(alien)]} alone",
        hint=f"Remove {alien}.",
    )


def _check_role(
    source: Source, key: KeyPath, part: VariablePart, algebra: LieAlgebra | None
) -> None:
    """Coordinates do without an algebra, advected quantities do not."""
    if part.role == "coordinate" and algebra is not None:
        place, roles = "beside [algebra]", "the roles 'velocity', 'momentum' and 'advected'"
    elif part.role == "advected" and algebra is None:
        place, roles = "without [algebra]", "the roles 'coordinate', 'velocity' and 'momentum'"
    else:
        return
    raise source.fault(
        (*key, "role"),
        f"{key[-1]!r} has the role {part.role!r} {place}",
        found=part.role,
        expected=f"{roles} {place}",
    )


def _misfit(source: Source, key: KeyPath, count: int, form: str) -> CoadjointError:
    counts = {"antisymmetric": "n(n - 1)/2", "symmetric": "n(n + 1)/2", "matrix": "n^2"}
    return source.fault(
        key,
        f"{count} components fill no matrix of the form {form!r}",
        found=count,
        expected=f"{counts[form]} components for an n by n matrix",
        hint="Remove form, or choose another block, representation or shape.",
    )


def _check_elements(
    source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...], form: str
) -> None:
    """The matrices of an algebra with a bracket of its own are of the form that is declared."""
    rows = matrix_size(len(block), form)
    sign = -1 if form == "antisymmetric" else 1
    for i in block:
        matrix = algebra.elements[i]
        turned = {(c, r): sign * value for (r, c), value in matrix.items()}
        if form == "matrix" or len(block) < algebra.dimension:
            turned = {}
        if size(algebra.elements) != rows or turned != dict(matrix):
            raise source.fault(
                key,
                f"the matrix of {algebra.basis[i]} is not of the form {form!r}",
                found=algebra.basis[i],
                expected=f"a basis of all {form} matrices with {rows} rows",
                hint="Remove form, or declare the algebra by such matrices.",
            )


def _check_planes(
    source: Source, key: KeyPath, algebra: LieAlgebra, block: tuple[int, ...]
) -> None:
    """Components above a diagonal go along E_12, E_13, ...: the planes of so(n) in their order.

    Along J1, J2, J3 = E_32, E_13, E_21 the equation dM/dt = [M, Omega] would have the other sign,
    and no invariant would show it.
    """
    size = matrix_size(len(block), "antisymmetric")
    assert size is not None, block
    place = {b: n for n, b in enumerate(block)}
    found: dict[tuple[int, int], dict[int | None, object]] = {}
    for (i, j), row in algebra.constants.items():
        if i in place and j in place:
            a, b = place[i], place[j]
            sign = 1 if a < b else -1
            found[min(a, b), max(a, b)] = {place.get(k): sign * c for k, c in row.items()}
    if size > 2 and found != dict(so_indefinite(size, 0).constants):
        names = listed(algebra.basis[b] for b in block)
        raise source.fault(
            key,
            f"the block {names} of {algebra.name} does not commute like the planes of so({size})",
            found=names,
            expected="a basis E12, E13, ... of matrices e_i e_j^T - e_j e_i^T for i < j",
            hint="Leave form out, and write hat(...) where a matrix is meant."
            if size == 3
            else "Leave form out, or declare the algebra by these matrices.",
        )


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
        raise source.fault(
            key,
            f"the advected quantity {key[-1]!r} has no representation",
            found=str(key[-1]),
            expected=f"representation = one of {listed((*REPRESENTATIONS, *declared))}",
            hint='Write representation = "vector".',
        )
    inner = (*key, "representation")
    name = part.representation
    return representation_of(source, inner, algebra, name, declared, invariance)


def _own_form(representation: Representation | None) -> str:
    """The form that an attitude has by itself: a unit quaternion, or a square matrix."""
    if representation is None or representation.name not in ATTITUDES:
        return ""
    if representation.name == "quaternion":
        return "quaternion"
    count = representation.dimension
    return "matrix" if count > 1 and matrix_size(count, "matrix") else ""


def _block(
    source: Source, key: KeyPath, part: VariablePart, algebra: LieAlgebra
) -> tuple[int, ...]:
    """Places in the basis that a velocity or momentum spans."""
    if part.block is None:
        return tuple(range(algebra.dimension))
    return block_places(source, key, part.block, algebra)


def read_parameter(source: Source, name: str, part: ParameterPart) -> Parameter:
    """A parameter with one exact default for each component, or none.

    Raises:
        SpecError: The default does not have the shape, or is not positive where it must be, or the
            components fill no matrix of the form.
    """
    shape, form = tuple(part.shape), part.form or ""
    if form:
        shape = shape or (1,)
        if len(shape) > 1 or matrix_size(shape[0], form) is None:
            raise _misfit(source, ("parameters", name, "form"), prod(shape), form)
    key: KeyPath = ("parameters", name, "default")
    default = read_default(source, key, part.default, shape)
    if default is not None and part.positive and min(default) <= 0:
        raise source.fault(
            key,
            f"the default {min(default)} of {name!r} is not positive",
            found=str(min(default)),
            expected="positive numbers, since positive = true",
        )
    return Parameter(name, shape, part.positive, default, part.unit, part.doc, form)


def read_inputs(source: Source, parts: Mapping[str, InputPart]) -> tuple[Input, ...]:
    """The inputs with one exact default for each component, or none.

    Raises:
        SpecError: A default does not have the shape, or a rate is no input of the same shape.
    """
    found = []
    for name, part in parts.items():
        shape = tuple(part.shape)
        default = read_default(source, ("inputs", name, "default"), part.default, shape)
        _check_rate(source, name, parts)
        found.append(Input(name, shape, default, part.unit, part.doc, part.rate or ""))
    return tuple(found)


def _check_rate(source: Source, name: str, parts: Mapping[str, InputPart]) -> None:
    """What is the rate of an input is another one, of its shape."""
    rate = parts[name].rate
    alike = [other for other in parts if other != name and parts[other].shape == parts[name].shape]
    if rate is not None and rate not in alike:
        raise source.fault(
            ("inputs", name, "rate"),
            f"{rate!a} is no other input of the shape of {name!r}",
            found=rate,
            expected=f"one of {listed(alike)}" if alike else "another input of its shape",
            hint=did_you_mean(rate, alike) or "Declare it in [inputs].",
        )
    chain = [name]
    while (following := parts[chain[-1]].rate or "") in parts:
        if following in chain:
            raise source.fault(
                ("inputs", name, "rate"),
                f"the rates {' -> '.join([*chain, following])} go round in a circle",
                found=rate,
                expected="an input whose rates end at one without",
            )
        chain.append(following)


def read_default(
    source: Source, key: KeyPath, value: object, shape: Shape
) -> tuple[Fraction, ...] | None:
    """The declared default, one number for each component; None if there is none."""
    spread = None if value is None else _spread(value, shape)
    if spread is None and value is not None:
        raise source.fault(
            key,
            f"the default of {str(key[-2])!r} does not have its shape {list(shape)}",
            found=_shape_text(value),
            expected=f"one number for all components, or {_shape_words(shape)}",
        )
    return spread


def _spread(value: object, shape: Shape) -> tuple[Fraction, ...] | None:
    """One number for each component, row by row; None if the shape does not fit."""
    if not isinstance(value, list):
        assert isinstance(value, Fraction), value
        count = 1
        for length in shape:
            count *= length
        return (value,) * count
    if not shape or len(value) != shape[0]:
        return None
    if len(shape) == 1:
        return None if any(isinstance(entry, list) for entry in value) else tuple(value)
    rows = [_spread(row, shape[1:]) for row in value if isinstance(row, list)]
    whole = [row for row in rows if row is not None]
    return tuple(x for row in whole for x in row) if len(whole) == shape[0] else None


def _shape_words(shape: Shape) -> str:
    if not shape:
        return "a single number"
    counts = [f"{shape[0]} numbers"] if len(shape) == 1 else [f"{shape[0]} lists of {shape[1]}"]
    return f"a list of {counts[0]}"


def _shape_text(value: object) -> str:
    """The lengths of nested lists, for a message."""
    if not isinstance(value, list):
        return "a number"
    inner = {len(row) if isinstance(row, list) else 1 for row in value}
    return f"a list of {len(value)}" + (
        f" lists of {listed(map(str, inner))}" if inner != {1} else ""
    )
