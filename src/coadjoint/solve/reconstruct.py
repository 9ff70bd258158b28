"""Where what is reconstructed begins: declared, asked for, or an attitude that stands upright.

Comes in: a System, its initial state and what `System.simulate` was asked for. Goes out: the first
values of ``RECONSTRUCTED``, which are integrated with the state.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.arrays import pack

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.declared import Quantity
    from coadjoint.solve.system import System

    Array = NDArray[np.float64]

#: Components of a quaternion.
QUATERNION = 4


def find_start(system: System, state: Array, asked: Any) -> Array:
    """The first values of what is reconstructed, ``(k,)``; none of them if nothing was asked for.

    Args:
        system: The System.
        state: Its initial state, ``(n,)``.
        asked: True or False, or where some of it begins, by name.

    Raises:
        KernelArgumentError: The system reconstructs nothing, or a name, shape or value is wrong.
    """
    if asked is False:
        return np.empty(0)
    if not system.RECONSTRUCTED:
        raise KernelArgumentError(
            f"{system.name} reconstructs nothing; expected reconstruct=False, or a system whose "
            "spec has [rolling] or [reconstruction].",
            found=asked,
            expected=False,
        )
    if not isinstance(asked, bool | Mapping):
        raise KernelArgumentError(
            f"reconstruct is {asked!r}; expected True, False, or where some of "
            f"{', '.join(system.RECONSTRUCTED)} begins, by name.",
            found=str(asked)[:80],
        )
    given = dict(asked) if isinstance(asked, Mapping) else {}
    wanted = {
        name: value
        for name, value in _defaults(system, state).items()
        if name not in given and not set(system.RECONSTRUCTED[name].components) & given.keys()
    }
    first = pack({**wanted, **given}, system.RECONSTRUCTED, "reconstruct")
    if first.shape != (system.RECONSTRUCTED.size,) or not np.isfinite(first).all():
        raise KernelArgumentError(
            f"reconstruct is {asked!r}; expected one finite value for each component.",
            found=str(asked)[:80],
        )
    for quantity in system.RECONSTRUCTED.values():
        if quantity.shape == (QUATERNION,):
            _check_unit(quantity, first[system.RECONSTRUCTED.rows(quantity.name)])
    return first


def _defaults(system: System, state: Array) -> dict[str, Any]:
    """Where each begins if nothing else is said."""
    values: dict[str, Any] = {}
    for name, quantity in system.RECONSTRUCTED.items():
        if quantity.upright and quantity.default is None:
            values[name] = turn_upright(state[system.STATE.rows(quantity.upright)])
        elif quantity.shape == (QUATERNION,):
            values[name] = quantity.default or (1.0, 0.0, 0.0, 0.0)
        else:
            values[name] = quantity.default[0] if quantity.default else 0.0
    return values


def turn_upright(vector: Array) -> Array:
    """The unit quaternion of the shortest rotation that takes a vector of the body to e_z.

    Through the half-way vector: ``q = (1 + c, v x e_z) / |.|`` with ``c = v . e_z``; where v points
    down, half a turn about e_x, since no axis is nearer than another.

    Args:
        vector: Any vector but 0, shape ``(3,)``.

    Raises:
        KernelArgumentError: The vector is 0, which points nowhere.

    >>> [turn_upright(np.array([0.0, 0.0, z])).tolist() for z in (2.0, -1.0)]
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    """
    length = float(np.linalg.norm(vector))
    if not length > 0:
        raise KernelArgumentError(
            "the normal is (0, 0, 0) at the given state; expected a unit vector, which says how "
            "the body stands. Give the state another one.",
            found=[0.0, 0.0, 0.0],
        )
    x, y, z = vector / length
    # 1 + z = (x^2 + y^2)/(1 - z), without the cancellation near the south pole
    real = 1 + z if z > 0 else (x * x + y * y) / (1 - z)
    if x == y == real == 0:
        return np.array([0.0, 1.0, 0.0, 0.0])
    whole = np.array([real, y, 0.0 - x, 0.0])
    return np.asarray(whole / math.hypot(*whole))  # which squares no tiny number


def _check_unit(quantity: Quantity, value: Array) -> None:
    """An attitude begins at a unit quaternion."""
    length = float(np.linalg.norm(value))
    if not abs(length - 1) <= 1e-9:  # digits that were typed
        raise KernelArgumentError(
            f"the attitude {quantity.name} begins at {value.tolist()}, of length {length:.6g}; "
            "expected a quaternion of length 1. Divide it by its length.",
            found=value.tolist(),
            expected=1,
        )
