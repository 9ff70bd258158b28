"""Calls that are ready: a short way for what needs no conversion and no explanation.

Comes in: a function of a kernel. Goes out: the same for arrays and parameters as they are, which
looks at all that `coadjoint.solve.arrays` looks at, and at nothing twice. What it does not know,
or what is wrong, is left to that module: it converts, and says what is expected.
Read next: `coadjoint.solve.kernels`, which keeps these functions.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.render.targets.protocol import FEW, Evaluate
from coadjoint.solve.quantities import Quantities

if TYPE_CHECKING:
    from coadjoint.array_types import Array

_FLOAT64 = np.dtype(np.float64)
#: Integers up to here are doubles.
_WHOLE = 2**53
#: What stands for a number; a subclass of these may be anything.
_NUMBERS = (float, int, np.float64)


def make_ready(
    shape: tuple[int, ...], rows: int, parameters: Quantities, evaluate: Evaluate
) -> Callable[[Any, Any, Any], Array | None]:
    """A function of one or a few states, parameters that they share, and a result; None if unsure.

    Ready are: a state ``(n,)`` or ``(n, N)`` and a result that are writable, C-contiguous arrays of
    float64; parameters as an array, a list or a dict of numbers; None for the defaults, or for a
    new result.

    Args:
        shape: Of the result for one member.
        rows: Of the state.
        parameters: What they are.
        evaluate: The function with its defaults, by the kernel.
    """
    single, pack = (rows,), make_pack(parameters)
    has_defaults = len(parameters.defaults) == parameters.size

    def call(state: Any, given: Any = None, out: Any = None) -> Array | None:
        if type(state) is not np.ndarray or state.dtype is not _FLOAT64 or not state.flags.carray:
            return None
        of = state.shape
        if of == single:
            members, wanted = 1, shape
        elif len(of) == 2 and of[0] == rows and 0 < of[1] <= FEW:
            members = of[1]
            wanted = (*shape, members)
        else:
            return None
        packed = None
        if given is not None:
            packed = pack(given)
            if packed is None:
                return None
        elif not has_defaults:
            return None
        if out is None:
            out = np.empty(wanted)
        elif not _can_hold(out, wanted) or _overlap(out, state) or _overlap(out, given):
            return None
        evaluate(members, state, packed, out)
        return out  # type: ignore[no-any-return]

    return call


def _can_hold(out: Any, shape: tuple[int, ...]) -> bool:
    """Whether a result of a shape can be written in place."""
    return (
        type(out) is np.ndarray
        and out.dtype is _FLOAT64
        and out.shape == shape
        and out.flags.carray
        and out.size > 0
    )


def _overlap(out: Array, given: Any) -> bool:
    """Whether what is read may lie where the result is written."""
    return type(given) is np.ndarray and np.may_share_memory(out, given)


def make_pack(quantities: Quantities) -> Callable[[Any], array[float] | None]:
    """A function that packs parameters which all members share, and None for all else.

    The numbers are copied: nobody can change them while a kernel reads them. An array of the same
    bits as the last one gives the same copy.
    """
    last: tuple[bytes | None, array[float]] = (None, array("d"))  # of no bits yet
    size, positive = quantities.size, quantities.positive
    single = (size,)
    defaults = [quantities.defaults.get(name) for name in quantities.components]
    places = {name: _place(quantities, name) for name in (*quantities, *quantities.components)}

    def pack(given: Any) -> array[float] | None:
        nonlocal last
        kind = type(given)
        values: Sequence[Any] | None
        if kind is np.ndarray:
            if given.dtype is not _FLOAT64 or given.shape != single:
                return None
            bits, known = given.tobytes(), last
            if bits == known[0]:
                return known[1]
            values = given.tolist()
        elif kind is dict:
            values = assemble(given)
        else:
            values = given if kind in (list, tuple) and _are_numbers(given, size) else None
        if not values:
            return None
        for row in positive:
            if not values[row] > 0.0:
                return None
        packed = array("d", values)
        if kind is np.ndarray:
            last = bits, packed
        return packed

    def assemble(given: dict[Any, Any]) -> list[Any] | None:
        values, known = defaults.copy(), 0
        for name, value in given.items():
            place = places.get(name)
            if place is None or known & place[2]:  # unknown, or given twice
                return None
            first, count, mask = place
            known |= mask
            if count == 0:
                if not _is_number(value):
                    return None
                values[first] = value
            else:
                if type(value) is np.ndarray and value.dtype is _FLOAT64 and value.ndim == 1:
                    value = value.tolist()
                if type(value) not in (list, tuple) or not _are_numbers(value, count):
                    return None
                values[first : first + count] = value
        return None if None in values else values

    return pack


def _place(quantities: Quantities, name: str) -> tuple[int, int, int] | None:
    """First row, number of rows (0 of a scalar) and their bits; None of a table of rows."""
    rows = quantities.rows(name)
    if isinstance(rows, int):
        return rows, 0, 1 << rows
    count = rows.stop - rows.start
    flat = len(quantities[name].shape) == 1
    return (rows.start, count, (1 << rows.stop) - (1 << rows.start)) if flat else None


def _are_numbers(values: Sequence[Any], count: int) -> bool:
    """Whether values are so many numbers."""
    return len(values) == count and all(map(_is_number, values))


def _is_number(value: Any) -> bool:
    """Whether a value is a double, or an integer that is one."""
    kind = type(value)
    return kind is float or (kind in _NUMBERS and -_WHOLE <= value <= _WHOLE)
