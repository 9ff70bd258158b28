"""Arrays: what may be passed to a kernel, and how it is laid out.

Comes in: whatever a person passes. Goes out: a `Call` of float64, C-contiguous, component-first
arrays, or an error that says what was found and what is expected. Nothing is cast with loss.
Read next: `coadjoint.render.targets.protocol`, which has the `Call`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.errors import KernelArgumentError, KernelTypeError
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.render.targets.protocol import Call
from coadjoint.solve.quantities import Quantities

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from coadjoint.array_types import Array
    from coadjoint.solve.functions import Values
    from coadjoint.solve.system import System

#: Names of what is missing that a message lists at the most.
MOST_NAMES = 12


def check_call(
    system: System,
    function: str,
    state: Values,
    parameters: Values | None,
    inputs: Values | None,
    *,
    time: ArrayLike | None = None,
    out: Array | None = None,
    bound: bool = False,
) -> tuple[Call, Array]:
    """One evaluation, checked, and its result in full shape.

    Args:
        system: Whose function it is.
        function: Name of the function.
        state: State as `System.rhs` takes it.
        parameters: Parameters as `System.rhs` takes them.
        inputs: Inputs as `System.rhs` takes them.
        time: Time as `System.rhs` takes it.
        out: Result array, or None for a new one.
        bound: Whether ``state`` and ``out`` must be used in place.

    Raises:
        KernelArgumentError: Something has a wrong shape, name, sign, or overlaps.
        KernelTypeError: Something is not numeric in a way that float64 can hold.
    """
    check_function(system, function)
    rows = system.rows(function)
    packed = as_float64(state, "state") if bound else pack(state, rows, "state")
    if bound and packed is not state:
        raise KernelArgumentError(
            "bind reads the state in place; expected a C-contiguous float64 array.",
            found=str(type(state).__name__),
        )
    check_rows(packed, rows, "state", system.name)
    batch = packed.shape[1:]
    given = {
        "parameters": pack_parameters(system, parameters),
        **_inputs(system, inputs),
        **_time(system, time),
        **system.fixed,
    }
    for name, array in given.items():
        if array.shape[1:] not in ((), batch):
            raise KernelArgumentError(
                f"{name} {'has' if name == 'time' else 'have'} the batch shape "
                f"{array.shape[1:]}, the state {batch}; expected the same, or {name} shared "
                "by all members.",
                found=list(array.shape[1:]),
                expected=list(batch),
            )
    shape = system.functions[function] + batch
    if bound and out is None:
        raise KernelArgumentError(
            f"bind writes into out; expected an array of shape {shape}.", expected=list(shape)
        )
    result = np.empty(shape) if out is None else _check_out(out, shape)
    members = math.prod(batch)
    by_member = {
        name: array if array.ndim == 1 else array.reshape(array.shape[0], members)
        for name, array in given.items()
    }
    block = result.reshape(*system.functions[function], members)
    call = Call(packed.reshape(rows.size, members), by_member.pop("parameters"), block, by_member)
    for name, array in call.given.items() if out is not None else ():
        if np.shares_memory(out, array):
            raise KernelArgumentError(
                f"out shares memory with {name}; the kernel would read what it has written. "
                "Pass an array of its own.",
                found=name,
            )
    return call, result


def check_function(system: System, function: str) -> None:
    """A function that a system has.

    Raises:
        KernelArgumentError: It has not; the message names those that it has.
    """
    if function in system.functions:
        return
    known = KERNEL_FUNCTIONS.get(function)
    large = known is not None and known.looped == "never" and "jacobian_vector" in system.functions
    advice = (
        " Matrices of its size are not written out: take jacobian_vector(state, vector), the "
        "Jacobian times a vector."
    )
    raise KernelArgumentError(
        f"{system.name} has no function {function!r}; expected one of "
        f"{', '.join(system.functions)}.{advice if large else ''}",
        found=function,
    )


def stack_vector(system: Any, function: str, state: Values, vector: Values) -> Array:
    """A state with a vector below it, ``(2*n, *batch)``.

    Raises:
        KernelArgumentError: The system has no such function, or the shapes differ.
    """
    check_function(system, function)
    packed = [
        pack(each, system.STATE, name) for each, name in ((state, "state"), (vector, "vector"))
    ]
    for each, name in zip(packed, ("state", "vector"), strict=True):
        check_rows(each, system.STATE, name, system.name)
    if packed[0].shape != packed[1].shape:
        raise KernelArgumentError(
            f"the state has the shape {packed[0].shape}, the vector {packed[1].shape}; expected "
            "the same.",
            found=list(packed[1].shape),
            expected=list(packed[0].shape),
        )
    return np.concatenate(packed)


def find_slopes(system: System, state: Array, *given: Any, **named: Any) -> Array:
    """The Jacobian ``(n, n)`` of a system at one state, column by column where it has no matrix."""
    if "jacobian" in system.functions:
        return system.evaluate("jacobian", state, *given, **named)
    columns = np.identity(len(state))
    states = np.repeat(state[:, None], len(state), axis=1)
    stacked = np.concatenate([states, columns])
    return system.evaluate("jacobian_vector", stacked, *given, **named)


def as_float64(value: Any, name: str) -> Array:
    """A value as a C-contiguous float64 array; the same object if it is one already.

    Raises:
        KernelTypeError: It is complex, text, object, or would lose digits.
        KernelArgumentError: It is ragged.
    """
    if _is_ready(value):
        return value  # type: ignore[no-any-return]
    if isinstance(value, np.ma.MaskedArray):
        raise KernelTypeError(
            f"{name} is a masked array; expected plain numbers, since kernels would ignore the "
            "mask. Pass its .filled(...) or .compressed().",
            found="masked array",
            expected="float64",
        )
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise KernelArgumentError(
            f"{name} is ragged: {error}. Expected rows of one length.", found=name
        ) from error
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8:
        is_number = array.dtype.kind in "biufc"
        shows_type = is_number or isinstance(value, np.ndarray)
        found = f"has the type {array.dtype}" if shows_type else f"is {_short(value)}"
        raise KernelTypeError(
            f"{name} {found}; expected real numbers that float64 holds."
            + " Convert it yourself if a loss is meant." * is_number,
            found=str(array.dtype),
            expected="float64",
        )
    converted = np.ascontiguousarray(array, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind in "iu" and not _are_doubles(array):
        raise KernelTypeError(
            f"{name} ({array.dtype}) contains integers beyond 2^53, which float64 would round. "
            "Convert it yourself if a loss is meant.",
            found=str(array.dtype),
            expected="float64",
        )
    return converted


def _is_ready(value: Any) -> bool:
    """Whether a kernel can read a value in place."""
    return (
        type(value) is np.ndarray
        and value.dtype == np.float64
        and value.dtype.isnative
        and value.flags.c_contiguous
        and value.flags.aligned
    )


def _are_doubles(array: NDArray[Any]) -> bool:
    """Whether integers keep their value."""
    if array.dtype.itemsize < 8:
        return True
    most = 2**53
    inside = array <= most if array.dtype.kind == "u" else (-most <= array) & (array <= most)
    return bool(inside.all())


def pack(
    values: Any, quantities: Quantities, name: str, defaults: Mapping[str, float] | None = None
) -> Array:
    """A packed array, or one put together from a mapping by quantity or component.

    Args:
        values: As given.
        quantities: What the rows are.
        name: What messages call it.
        defaults: Of components that a mapping leaves out; without any, all have to be given.

    Raises:
        KernelArgumentError: A name is unknown, missing, or has the wrong shape.
    """
    if not isinstance(values, Mapping):
        return as_float64(values, name)
    return _assemble(defaults or {}, values, quantities, name)


def pack_parameters(system: System, parameters: Any) -> Array:
    """Parameters as ``(k,)`` or ``(k, *batch)``, defaults filled in and signs checked.

    Raises:
        KernelArgumentError: As for `pack`, or a value that must be positive is not.
    """
    quantities = system.PARAMETERS
    known: Array | None = quantities.packed
    if parameters is None and known is not None:
        return known
    if parameters is None or isinstance(parameters, Mapping):
        packed = _assemble(quantities.defaults, parameters or {}, quantities, "parameters")
    else:
        packed = as_float64(parameters, "parameters")
        check_rows(packed, quantities, "parameters", system.name)
    signed = packed[list(quantities.positive)]
    if not (signed > 0).all():  # a NaN is not positive either
        place = np.argwhere(~(signed > 0))[0]
        component = quantities.components[quantities.positive[place[0]]]
        value = float(signed[tuple(place)])
        raise KernelArgumentError(
            f"parameter {component}{tell_member(place)} of {system.name} is {value:g}; expected a "
            "positive value.",
            found=value,
            component=component,
        )
    return packed if parameters is not None else _keep(packed, quantities)


def tell_member(place: NDArray[np.intp]) -> str:
    """Where in a batch something is, given its row and member; "" without a batch.

    >>> tell_member(np.array([0, 4])), tell_member(np.array([0, 4, 1])), tell_member(np.array([0]))
    (' of member 4', ' of member (4, 1)', '')
    """
    member = tuple(place[1:].tolist())
    return f" of member {member[0] if len(member) == 1 else member}" if member else ""


def pack_inputs(system: System, inputs: Any) -> Array:
    """Inputs as ``(m,)`` or ``(m, *batch)``, defaults filled in.

    Raises:
        KernelArgumentError: As for `pack`, or the system has no inputs.
    """
    quantities = system.INPUTS
    if inputs is not None and (not quantities or isinstance(inputs, str)):
        has = f"has the inputs {', '.join(quantities)}" if quantities else "has no inputs"
        expected = "an array, or values by name" if quantities else "None"
        raise KernelArgumentError(
            f"{system.name} {has}, and found {_short(inputs)} in their place; expected {expected}. "
            'Where target or out was meant, write target="c", out=out.',
            found=_short(inputs),
        )
    known: Array | None = quantities.packed
    if inputs is None and known is not None:
        return known
    if inputs is None:
        return _keep(_assemble(quantities.defaults, {}, quantities, "inputs"), quantities)
    if isinstance(inputs, Mapping):
        return _assemble(quantities.defaults, inputs, quantities, "inputs")
    packed = as_float64(inputs, "inputs")
    check_rows(packed, quantities, "inputs", system.name)
    return packed


def _inputs(system: System, inputs: Any) -> dict[str, Array]:
    """The array of inputs, where a system has some."""
    if not system.INPUTS and inputs is None:
        return {}
    return {"inputs": pack_inputs(system, inputs)}


def _time(system: System, time: Any) -> dict[str, Array]:
    """The time as an array of one row, where the functions of a system take it.

    Raises:
        KernelArgumentError: It is missing, or there is nothing that depends on it.
    """
    if not system.TIME:
        if time is None:
            return {}
        raise KernelArgumentError(
            f"{system.name} does not depend on time, and found time = {_short(time)}. "
            "Leave it out.",
            found=_short(time),
        )
    if time is None:
        raise KernelArgumentError(
            f"{system.name} depends on time, and none is given; expected a number, or one for "
            "each member. Write time=0.0.",
            found=None,
        )
    return {"time": as_float64(time, "time")[np.newaxis]}


def _short(value: Any) -> str:
    """A value in a message."""
    return f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else repr(value)[:80]


def _keep(packed: Array, quantities: Quantities) -> Array:
    """Defaults that are packed once and for all, which nobody can write into."""
    packed.flags.writeable = False
    quantities.packed = packed
    return packed


def _assemble(
    defaults: Mapping[str, float], given: Mapping[str, Any], quantities: Quantities, name: str
) -> Array:
    """One array from defaults and named values, all broadcast to one batch shape."""
    parts: dict[str, Any] = {}
    for key, value in given.items():
        for component, array in _components(key, value, quantities, name).items():
            if component in parts:
                raise KernelArgumentError(
                    f"{name} gives {component} twice, alone and within its vector; expected one "
                    "value. Leave one of them out.",
                    found=component,
                )
            parts[component] = array
    parts = {**defaults, **parts}
    missing = [component for component in quantities.components if component not in parts]
    if missing:
        more = f" and {len(missing) - MOST_NAMES} more" * (len(missing) > MOST_NAMES)
        raise KernelArgumentError(
            f"{name} lacks {', '.join(missing[:MOST_NAMES])}{more}; expected a value of each. "
            f"Pass them by name, e.g. {{{missing[0]!r}: 1.0}}.",
            found=missing,
        )
    ordered = [parts[component] for component in quantities.components]
    if not any(map(np.ndim, ordered)):
        return np.array(ordered, np.float64)
    try:
        batch = np.broadcast_shapes(*(np.shape(part) for part in ordered))
    except ValueError as error:
        raise KernelArgumentError(
            f"the batch shapes of {name} do not fit together: "
            f"{', '.join(str(np.shape(part)) for part in ordered)}.",
            found=name,
        ) from error
    packed = np.empty((len(ordered), *batch))
    for row, part in enumerate(ordered):
        packed[row] = part
    return packed


def _components(key: str, value: Any, quantities: Quantities, name: str) -> dict[str, Array]:
    """The rows that one named value stands for, by component."""
    rows = quantities.rows(key)
    array = as_float64(value, f"{name}[{key!r}]")
    if isinstance(rows, int):
        return {quantities.components[rows]: array}
    quantity = quantities[key]
    if array.shape[: len(quantity.shape)] != quantity.shape:
        raise KernelArgumentError(
            f"{name}[{key!r}] has the shape {array.shape}; expected {quantity.shape}, "
            "followed by the batch if it differs from member to member.",
            found=list(array.shape),
            expected=list(quantity.shape),
        )
    flat = array.reshape(len(quantity.components), *array.shape[len(quantity.shape) :])
    return dict(zip(quantity.components, flat, strict=True))


def check_rows(array: Array, quantities: Quantities, name: str, system: str) -> None:
    """The first axis must have one row per component."""
    if array.ndim == 0 or array.shape[0] != quantities.size:
        raise KernelArgumentError(
            f"the shape of {name} of {system} is {array.shape}; expected ({quantities.size},) or "
            f"({quantities.size}, *batch), the rows being {quantities.listed}."
            f"{suggest_axes(array.shape, quantities.size, name)}",
            found=list(array.shape),
            expected=quantities.size,
        )


def suggest_axes(shape: tuple[int, ...], rows: int, name: str) -> str:
    """What to do with an array whose components are not on the first axis; "" for other faults.

    >>> suggest_axes((9, 6), 6, "state")
    ' It looks transposed: pass state.T.'
    >>> suggest_axes((2, 6, 9), 6, "state")
    ' Components come first: pass np.moveaxis(state, 1, 0).'
    """
    if rows not in shape[1:]:
        return ""
    if len(shape) == 2:
        return f" It looks transposed: pass {name}.T."
    axis = len(shape) - 1 - shape[::-1].index(rows)
    return f" Components come first: pass np.moveaxis({name}, {axis}, 0)."


def _check_out(out: Any, shape: tuple[int, ...]) -> Array:
    """A result array that can be written in place."""
    if not isinstance(out, np.ndarray) or out.dtype != np.float64 or not out.dtype.isnative:
        kind = str(out.dtype) if isinstance(out, np.ndarray) else type(out).__name__
        raise KernelTypeError(
            f"out has the type {kind}; expected a float64 array.", found=kind, expected="float64"
        )
    problem = (
        f"has the shape {out.shape}"
        if out.shape != shape
        else "is read-only"
        if not out.flags.writeable
        else "is not C-contiguous"
        if not out.flags.c_contiguous
        else ""
    )
    if problem:
        raise KernelArgumentError(
            f"out {problem}; expected a writeable, C-contiguous array of shape {shape}.",
            found=problem,
            expected=list(shape),
        )
    return out
