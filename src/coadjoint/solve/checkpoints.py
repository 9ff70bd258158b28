"""Checkpoints: a run on its way in a file, from which another process goes on.

Comes in: an `Ensemble` on its way and what it was asked for. Goes out: a file, replaced as a whole
now and then; or the same ensemble as far as the file has it. All that is known of a member stands
in the arrays of an ensemble, and of its events and steps in those of a `Recording`, so that a run
that goes on has the bits of one that was never broken off.
Read next: `coadjoint.solve.march`, which writes it.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping
from dataclasses import fields
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from zipfile import BadZipFile

import numpy as np

from coadjoint.errors import KernelArgumentError
from coadjoint.files import check_writable, write_whole
from coadjoint.solve.driving import Function
from coadjoint.solve.ensemble import MET, Ensemble
from coadjoint.solve.kernels import say_once
from coadjoint.solve.lookout import take_below

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.driving import Signal
    from coadjoint.solve.recording import Recording
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System

    Array = NDArray[Any]

#: Seconds between two checkpoints; more where writing one takes more than a twentieth of that.
SECONDS: Final = 10.0
SHARE: Final = 0.05
#: Names in a file, next to those of an ensemble.
_HEAD: Final = "head"
_FORM: Final = 3
#: What stands before the names of what is known of events and steps.
_RECORDING: Final = "recording"
#: The name of the kinks that were met.
_MET: Final = "met"


def check_checkpoint(path: Any) -> Path | None:
    """The path of a checkpoint, where one can be written and read.

    Raises:
        KernelArgumentError: It is no path, or something other than a file stands there.
        OutputError: Its folder is missing or not writable.
    """
    if path is None:
        return None
    if not isinstance(path, str | os.PathLike):
        raise KernelArgumentError(
            f"checkpoint is {path!r}; expected the path of a file.", found=str(path)[:80]
        )
    place = Path(os.fsdecode(path))
    check_writable(place)
    if place.exists() and not place.is_file():
        raise KernelArgumentError(
            f"checkpoint is {place}, which is no file that can be read again; expected a file, or "
            "a path where nothing stands yet.",
            path=str(place),
        )
    return place


class RunFile:
    """A file of arrays that belongs to one run.

    Args:
        path: Where it stands, or will stand.
        asked: What was asked for, as JSON values.
        build: What the bits depend on beyond the files of the system; "" if nothing.

    Attributes:
        path: The same.
        seconds: How long to compute before the next one is written.
    """

    def __init__(self, path: Path, asked: dict[str, Any], build: str) -> None:
        self.path, self.seconds = path, SECONDS
        self._asked, self._build = asked, build

    def _take_arrays(self) -> tuple[dict[str, Array], str] | None:
        """What the file has, and the build that wrote it; None where there is no file.

        Raises:
            KernelArgumentError: The file is no checkpoint, or that of another run.
        """
        if not self.path.exists():
            return None
        arrays, head = self._read()
        self._check(head)
        return arrays, head["build"]

    def _tell_build(self, build: str, depth: int) -> None:
        """Say that another build may have other bits."""
        if build != self._build:
            say_once(
                f"{self.path} was written by another build of the solver (compiler, processor or "
                "NumPy). The run goes on from there, and its bits may differ from those of a run "
                "that was not broken off.",
                depth=depth,
            )

    def _write(self, arrays: Mapping[str, Any]) -> None:
        """Replace the file: whole, or not at all.

        Raises:
            OutputError: It cannot be written; what stood there before is untouched.
        """
        begun = time.monotonic()
        head = json.dumps({"form": _FORM, "build": self._build, "asked": self._asked})
        whole: dict[str, Any] = {_HEAD: np.array(head), **arrays}
        with write_whole(self.path) as place, place.open("wb") as file:
            np.savez(file, **whole)
            file.flush()
            os.fsync(file.fileno())
        self.seconds = max(SECONDS, (time.monotonic() - begun) / SHARE)

    def _read(self) -> tuple[dict[str, Array], dict[str, Any]]:
        """The arrays of the file and what it says of itself.

        Raises:
            KernelArgumentError: It is no checkpoint.
        """
        try:
            with self.path.open("rb") as file, np.load(file, allow_pickle=False) as held:
                arrays = {name: held[name] for name in held.files}
            head = json.loads(str(arrays.pop(_HEAD)))
            asked, build, form = head["asked"], head["build"], head["form"]
        except (
            OSError,
            ValueError,
            KeyError,
            TypeError,
            EOFError,
            AttributeError,
            BadZipFile,
        ) as e:
            raise self._explain_unread(getattr(e, "strerror", None) or e) from e
        if form != _FORM:
            raise self._explain_unread(f"its form is {form}, not {_FORM}")
        return arrays, {"asked": asked, "build": build}

    def _check(self, head: dict[str, Any]) -> None:
        """The file is of this run.

        Raises:
            KernelArgumentError: Something else was asked for.
        """
        for name, expected in self._asked.items():
            found = head["asked"].get(name)
            if found != expected:
                raise KernelArgumentError(
                    f"{self.path} is the checkpoint of another run: its {name} {_tell(found)}, and "
                    f"that of this run {_tell(expected)}. Ask for the same, name another file, or "
                    "remove this one to begin anew.",
                    found=found,
                    expected=expected,
                    name=name,
                    path=str(self.path),
                )

    def _explain_unread(self, reason: object) -> KernelArgumentError:
        """What to say of a file that is no checkpoint."""
        return KernelArgumentError(
            f"{self.path} is no checkpoint that can be read: {reason}. Name another file, or "
            "remove this one to begin anew.",
            path=str(self.path),
        )


class Checkpoint(RunFile):
    """The file of a run.

    Args:
        path: Where it stands, or will stand.
        system: The System.
        request: What was asked for.
        run: Its members, begun.
        build: What the bits depend on beyond the files of the system; "" if nothing.
        recording: Who looks at the steps; None for nobody.
        signal: Inputs over time, or constants of each member; None without inputs.
    """

    def __init__(
        self,
        path: Path,
        system: System,
        request: Request,
        run: Ensemble,
        build: str,
        recording: Recording | None,
        signal: Signal | Array | None,
    ) -> None:
        super().__init__(path, _describe(system, request, run, signal), build)
        self._recording = recording

    def resume(self, run: Ensemble) -> None:
        """Take a run to where the file has it; nothing where there is no file.

        Raises:
            KernelArgumentError: The file is no checkpoint, or that of another run.
        """
        taken = self._take_arrays()
        if taken is None:
            return
        arrays, build = taken
        for name, array in _arrays(run).items():
            found = arrays.get(name, np.empty(0))
            if (found.shape, found.dtype) != (array.shape, array.dtype):
                raise self._explain_unread(f"its {name} has the shape {found.shape}")
            array[...] = found
        if run.kinks is not None:
            met = arrays.get(_MET, np.empty(0))
            if met.shape[1:] != (MET,) or met.dtype != np.float64:
                raise self._explain_unread(f"its {_MET} has the shape {met.shape}")
            run.met[:] = [met]
        if self._recording is not None:
            try:
                self._recording.restore(take_below(arrays, _RECORDING))
            except (KeyError, ValueError, TypeError, IndexError) as error:
                raise self._explain_unread(f"its record is damaged: {error}") from error
        self._tell_build(build, depth=9)

    def write(self, run: Ensemble) -> None:
        """Replace the file by what a run is now: whole, or not at all.

        Raises:
            OutputError: It cannot be written; what stood there before is untouched.
        """
        arrays: dict[str, Any] = _arrays(run)
        arrays |= {_MET: run.list_met()} if "kinks" in arrays else {}
        known = {} if self._recording is None else self._recording.save()
        self._write(arrays | {f"{_RECORDING}.{name}": array for name, array in known.items()})


def _arrays(run: Ensemble) -> dict[str, Array]:
    """The arrays of an ensemble that change on its way."""
    changing = ("state", "out", *(each.name for each in fields(run) if not each.init))
    found = {name: getattr(run, name) for name in changing if name != _MET}
    return {name: array for name, array in found.items() if array is not None}


def _describe(
    system: System, request: Request, run: Ensemble, signal: Signal | Array | None
) -> dict[str, Any]:
    """What was asked for, as JSON values; arrays by their hash.

    A function of Python is known by its values at the start and at the samples.
    """
    times = np.append(request.start, run.samples)
    asked = [signal.over(times)] if isinstance(signal, Function) else []
    inputs = run.inputs
    return describe_request(system, request) | {
        "parameters": hash_arrays(run.parameters),
        "inputs": hash_arrays(inputs.knots, inputs.values, inputs.slopes, *asked),
        "samples": hash_arrays(run.samples, np.array(run.out is None)),
        "reconstruct": hash_arrays(run.state[system.STATE.size :])
        if len(run.state) > system.STATE.size
        else "no",
    }


def describe_request(system: System, request: Request) -> dict[str, Any]:
    """What every run is asked for, as JSON values."""
    choice = request.choice
    return {
        "system": system.name,
        "id": system.id,
        "method": str(choice),
        "order": choice.order,
        "target": request.target,
        "rtol": request.rtol,
        "atol": request.atol,
        "step": request.step,
        "seed": request.seed,
        "max_steps": request.max_steps,
        "initial state": hash_arrays(request.state),
        "start": request.start,
        "events": [str(each.event) for each in request.events],
        "dense": request.dense,
    }


def hash_arrays(*arrays: Array) -> str:
    """One hash of the shapes and bits of arrays."""
    whole = sha256()
    for array in arrays:
        whole.update(f"{array.shape} {array.dtype.str} ".encode())
        whole.update(np.ascontiguousarray(array).data)
    return whole.hexdigest()


def _tell(value: Any) -> str:
    """A value in a message; of a hash that it is another one."""
    is_hash = isinstance(value, str) and len(value) == 64
    return f"has the hash {value[:8]}" if is_hash else f"is {value!r}"
