"""Tables of steps: the dense output of a solution as a record, from which it is read back.

Comes in: a `Dense`. Goes out: a record of JSON values and arrays from which the same dense output
is made, to the last bit. The steps of generated solvers are arrays; those of SciPy are the arrays
and numbers of its interpolants, by the names of their classes.
Read next: `coadjoint.solve.carried`, which has the records in files of solutions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.solve.dense_output import Dense, Interpolants
from coadjoint.solve.driving import Linear, Previous, Signal
from coadjoint.solve.recording import Polynomials

if TYPE_CHECKING:
    from coadjoint.array_types import Array

#: Inputs that are samples, by name.
SAMPLED: Final = {"previous": Previous, "linear": Linear}


def describe_dense(dense: Dense | None) -> dict[str, Any] | None:
    """The record of a dense output; None if there is none, or inputs are a function of Python."""
    if dense is None:
        return None
    record: dict[str, Any] = {"start": dense.start}
    signal = dense.signal
    if isinstance(signal, np.ndarray):
        record |= {"signal": "of each", "values": signal}
    elif isinstance(signal, Previous | Linear):
        kind = "previous" if isinstance(signal, Previous) else "linear"
        record |= {"signal": kind, "times": signal.times, "values": signal.values}
    elif type(signal) is Signal:
        record |= {"signal": "constant", "values": signal.values}
    elif signal is not None:
        return None
    steps = dense.steps
    if isinstance(steps, Interpolants):
        paths = [{"class": type(path).__name__} | _describe_path(path) for path in steps.paths]
        named = {"member": steps.member, "begun": steps.start, "size": steps.size}
        return record | named | {"paths": paths}
    assert isinstance(steps, Polynomials), "there are no others"
    named = {"member": steps.member, "begun": steps.start, "size": steps.size}
    return record | named | {"coefficients": steps.path}


def _describe_path(path: Any) -> dict[str, Any]:
    """What an interpolant of SciPy has: arrays with their types, and numbers."""
    return {
        name: {"type": value.dtype.name, "values": value}
        if isinstance(value, np.ndarray)
        else _as_plain(value)
        for name, value in vars(path).items()
    }


def _as_plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def as_json(value: Any) -> Any:
    """What JSON has for an array of a record: for ``json.dumps(..., default=as_json)``."""
    return value.tolist()


def read_dense(record: Mapping[str, Any]) -> Dense:
    """The dense output of a record, whose arrays may be lists.

    Raises:
        KeyError: A part is missing.
        TypeError: One is of another kind.
        ValueError: One has another shape.
    """
    begun, size = (np.array(record[name], np.float64) for name in ("begun", "size"))
    if size.shape != begun.shape or begun.ndim != 1:
        raise ValueError("steps begin, and are long, in arrays of one length")
    steps: Interpolants | Polynomials
    if "paths" in record:
        paths = [_read_path(path) for path in record["paths"]]
        member = np.array(record["member"], np.intp)
        steps = Interpolants(paths=paths, start=begun, size=size, member=member)
        good = len(steps.paths) == len(begun) == len(steps.member)
    else:
        path = np.array(record["coefficients"], np.float64)
        path = path if path.size else np.empty((len(path), 1, 1))
        member = np.array(record["member"], np.intp)
        steps = Polynomials(
            member=member,
            start=begun,
            size=size,
            lots=(path,),
            place=np.arange(len(begun)),
        )
        good = len(path) == len(begun) == len(member) and path.ndim == 3
    if not good:
        raise ValueError("there are not as many steps as begin")
    return Dense(steps, _read_signal(record), float(record["start"]))


def _read_signal(record: Mapping[str, Any]) -> Signal | Array | None:
    """The inputs of a record."""
    if "signal" not in record:
        return None
    values = np.array(record["values"], np.float64)
    if record["signal"] in SAMPLED:
        return SAMPLED[record["signal"]](np.array(record["times"], np.float64), values)
    return values if record["signal"] == "of each" else Signal(values)


def _read_path(said: Mapping[str, Any]) -> Any:
    """An interpolant of SciPy: an object of one of its classes, with arrays and numbers alone."""
    from scipy.integrate import DenseOutput

    from coadjoint.solve.wave_gauss import Cubic

    known: dict[str, Any] = {each.__name__: each for each in (*DenseOutput.__subclasses__(), Cubic)}
    path: Any = object.__new__(known[said["class"]])
    for name, value in said.items():
        if name != "class":
            is_array = isinstance(value, Mapping)
            held = np.array(value["values"], value["type"]) if is_array else value
            setattr(path, name, held)
    return path
