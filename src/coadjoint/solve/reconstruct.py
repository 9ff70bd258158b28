"""Where what is reconstructed begins: declared, asked for, or an attitude that stands upright.

Comes in: a System, its initial states and what `System.simulate` was asked for. Goes out: the first
values of ``RECONSTRUCTED``, which are integrated with the state.
Read next: `coadjoint.solve.generated`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import pack, tell_member

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.declared import Quantity
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.system import System


def is_asked(asked: Any) -> bool:
    """Whether something is to be reconstructed."""
    return not (asked is None or (isinstance(asked, bool | np.bool_) and not asked))


def find_start(system: System, state: Array, asked: Any) -> Array:
    """The first values of what is reconstructed, ``(k, *batch)``; no rows if nothing was asked for.

    Args:
        system: The System.
        state: Its initial state, ``(n, *batch)``.
        asked: True or False, or where some of it begins, by name: for all members, or of each.

    Raises:
        KernelArgumentError: The system reconstructs nothing, or a name, shape or value is wrong.
    """
    batch = state.shape[1:]
    if not is_asked(asked):
        return np.empty((0, *batch))
    check_asked(system, asked)
    given = dict(asked) if isinstance(asked, Mapping) else {}
    wanted = {
        name: value
        for name, value in _defaults(system, state).items()
        if name not in given and not set(system.RECONSTRUCTED[name].components) & given.keys()
    }
    each = f", or one for each of the members {batch}" if batch else ""
    expected = f"expected one finite value for each component{each}."
    _check_shapes(system, given, batch, expected)
    size = system.RECONSTRUCTED.size
    first = pack({**wanted, **given}, system.RECONSTRUCTED, "reconstruct")
    if first.shape not in ((size,), (size, *batch)) or not np.isfinite(first).all():
        raise KernelArgumentError(
            f"reconstruct is {str(asked)[:200]}; {expected}", found=str(asked)[:80]
        )
    first = first.reshape(size, *(first.shape[1:] or (1,) * len(batch)))
    first = np.broadcast_to(first, (size, *batch)).copy()
    for quantity in system.RECONSTRUCTED.values():
        if quantity.is_quaternion:
            _check_unit(quantity, first[system.RECONSTRUCTED.rows(quantity.name)])
    return first


def check_asked(system: System, asked: Any) -> Quantities:
    """What is reconstructed, where there is something and what was asked for is of the right kind.

    Raises:
        KernelArgumentError: It is not.
    """
    if not system.RECONSTRUCTED:
        raise KernelArgumentError(
            f"{system.name} reconstructs nothing; expected reconstruct=False, or a system whose "
            "spec has [rolling] or [reconstruction].",
            found=asked,
            expected=False,
        )
    if not isinstance(asked, bool | np.bool_ | Mapping):
        raise KernelArgumentError(
            f"reconstruct is {asked!r}; expected True, False, or where some of "
            f"{', '.join(system.RECONSTRUCTED)} begins, by name.",
            found=str(asked)[:80],
        )
    return system.RECONSTRUCTED


def _check_shapes(
    system: System, given: Mapping[str, Any], batch: tuple[int, ...], expected: str
) -> None:
    """What is given has the shape of its quantity, or that for each member.

    Raises:
        KernelArgumentError: It has another shape.
    """
    for name, value in given.items():
        own = system.RECONSTRUCTED[name].shape if name in system.RECONSTRUCTED else ()
        shape = np.shape(value)
        if shape not in (own, (*own, *batch)):
            raise KernelArgumentError(
                f"reconstruct: {name} has the shape {shape}; {expected}",
                found=list(shape),
                expected=list(own),
            )


def _defaults(system: System, state: Array) -> dict[str, Any]:
    """Where each begins if nothing else is said."""
    values: dict[str, Any] = {}
    for name, quantity in system.RECONSTRUCTED.items():
        if quantity.upright and quantity.default is None:
            values[name] = turn_upright(state[system.STATE.rows(quantity.upright)])
        elif quantity.is_quaternion:
            values[name] = quantity.default or (1.0, 0.0, 0.0, 0.0)
        else:
            first = np.array(quantity.default or (0.0,) * len(quantity.components))
            values[name] = first.reshape(quantity.shape)
    return values


def turn_upright(vectors: Array) -> Array:
    """The unit quaternions of the shortest rotations that take vectors of bodies to e_z.

    Through the half-way vector: ``q = (1 + c, v x e_z) / |.|`` with ``c = v . e_z``; where v points
    down, half a turn about e_x, since no axis is nearer than another.

    Args:
        vectors: Any vectors but 0, ``(3, *batch)``.

    Raises:
        KernelArgumentError: A vector is 0, which points nowhere.

    >>> [turn_upright(np.array([0.0, 0.0, z])).tolist() for z in (2.0, -1.0)]
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    """
    length = np.hypot(np.hypot(*vectors[:2]), vectors[2])
    if not (length > 0).all():
        place = np.argwhere(~(length > 0)[np.newaxis])[0]
        raise KernelArgumentError(
            f"the normal{tell_member(place)} is (0, 0, 0) at the given state; expected a "
            "unit vector, which says how the body stands. Give the state another one.",
            found=[0.0, 0.0, 0.0],
        )
    x, y, z = vectors / length
    # 1 + z = (x^2 + y^2)/(1 - z), without the cancellation near the south pole
    with np.errstate(all="ignore"):
        real = np.where(z > 0, 1 + z, (x * x + y * y) / (1 - z))
    down = (x == 0) & (y == 0) & (real == 0)
    whole = np.array([real, np.where(down, 1.0, y), 0.0 - x, np.zeros(real.shape)])
    whole = np.where(down, whole[[0, 1, 3, 3]], whole)
    return np.asarray(whole / np.hypot(np.hypot(*whole[:2]), whole[2]))  # squares no tiny number


def _check_unit(quantity: Quantity, values: Array) -> None:
    """Attitudes begin at unit quaternions."""
    lengths = np.sqrt((values**2).sum(axis=0))
    wrong = ~(np.abs(lengths - 1) <= 1e-9)[np.newaxis]  # digits that were typed
    if wrong.any():
        place = np.argwhere(wrong)[0]
        member = tuple(place[1:].tolist())
        value, length = values[(slice(None), *member)].tolist(), lengths[member]
        raise KernelArgumentError(
            f"the attitude {quantity.name}{tell_member(place)} begins at {value}, of length "
            f"{length:.6g}; expected a quaternion of length 1. Divide it by its length.",
            found=value,
            expected=1,
        )
