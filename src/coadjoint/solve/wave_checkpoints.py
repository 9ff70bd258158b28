"""Checkpoints of runs by Fourier derivatives, whose steps Python leads.

Comes in: an integrator on its way and what was asked for. Goes out: a file in the form of all
checkpoints; or the same integrator as far as the file has it. What an integrator knows beyond its
state is the size of its next step, or what rounding left out of the last one, so that a run that
goes on has the bits of one that was never broken off.
Read next: `coadjoint.solve.checkpoints`.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from coadjoint.solve.checkpoints import RunFile, describe_request, hash_arrays
from coadjoint.solve.wave_gauss import WaveGauss

if TYPE_CHECKING:
    from pathlib import Path

    from coadjoint.array_types import Array
    from coadjoint.solve.driving import Driving
    from coadjoint.solve.request import Request
    from coadjoint.solve.system import System
    from coadjoint.solve.wave_gauss import Made


class WaveCheckpoint(RunFile):
    """The file of one trajectory.

    Args:
        path: Where it stands, or will stand.
        system: The System.
        request: What was asked for.
        parameters: ``(k,)``.
        times: Of the samples, the start before them where they do not have it.
        followed: Where what is reconstructed begins; ``(0,)`` for nothing.
        driving: Inputs over time.
        made: Where steps and sweeps are counted; None for nowhere.
    """

    def __init__(
        self,
        path: Path,
        system: System,
        request: Request,
        parameters: Array,
        times: Array,
        followed: Array,
        driving: Driving,
        made: Made | None,
    ) -> None:
        asked = describe_request(system, request) | {
            "parameters": hash_arrays(parameters),
            "inputs": hash_arrays(*driving.over(times).values()),
            "samples": hash_arrays(times),
            "reconstruct": hash_arrays(followed),
            "derivatives": system.derivatives,
        }
        build = f"NumPy {np.__version__}, SciPy {scipy.__version__}"
        super().__init__(path, asked, build)
        self._made, self._length = made, times.size
        self._rows, self._begun = system.STATE.size + followed.size, time.monotonic()
        self._taken: dict[str, Any] | None = None

    def find_time(self) -> float | None:
        """When the run that the file has goes on; None where there is no file.

        Raises:
            KernelArgumentError: The file is no checkpoint, or that of another run.
        """
        if (taken := self._take_arrays()) is None:
            return None
        arrays, build = taken
        for name, shape in self._list_shapes(arrays).items():
            found = arrays.get(name, np.empty(0))
            if found.shape != shape or found.dtype != np.float64:
                raise self._explain_unread(f"its {name} has the shape {found.shape}")
        self._tell_build(build, depth=8)
        self._taken = arrays
        return float(arrays["time"])

    def _list_shapes(self, arrays: dict[str, Array]) -> dict[str, tuple[int, ...]]:
        """What stands in a file, by its name."""
        reached = arrays.get("out", np.empty(0)).shape[-1:] or (0,)
        own = {"left_out": (self._rows,)} if self._made else {"slopes": (self._rows,)}
        return {
            "time": (),
            "state": (self._rows,),
            "out": (self._rows, min(*reached, self._length)),
            "counts": (4,),
            "next": (2,),
            **own,
        }

    @property
    def state(self) -> Array:
        """The state that the file has."""
        assert self._taken is not None, "`find_time` has found a file"
        state: Array = self._taken["state"]
        return state

    def resume(self, solver: Any, states: Array) -> tuple[int, int]:
        """Take an integrator that begins at the state of the file to what it knew, and samples.

        Returns:
            How many samples were reached, and how many steps made; one and none without a file.
        """
        if self._taken is None:
            return 1, 0
        known, self._taken = self._taken, None
        reached, steps, *made = map(int, known["counts"])
        states[:, :reached] = known["out"]
        if isinstance(solver, WaveGauss):
            assert self._made is not None, "the method counts sweeps"
            self._made.steps, self._made.sweeps = made
            solver.resume(float(known["next"][0]), int(known["next"][1]), known["left_out"])
        else:
            solver.h_abs, solver.f = float(known["next"][0]), known["slopes"]
        return reached, steps

    def write_sometimes(
        self, solver: Any, states: Array, reached: int, steps: int, *, now: bool
    ) -> None:
        """Replace the file, if that was long ago or is asked for now.

        Raises:
            OutputError: It cannot be written; what stood there before is untouched.
        """
        if not now and time.monotonic() - self._begun < self.seconds:
            return
        made = self._made
        counts = [reached, steps, *((made.steps, made.sweeps) if made else (0, 0))]
        if isinstance(solver, WaveGauss):
            begun, count, left_out = solver.save()
            own: dict[str, Any] = {"next": [begun, float(count)], "left_out": left_out}
        else:
            own = {"next": [solver.h_abs, 0.0], "slopes": solver.f}
        self._write(
            {
                "time": np.float64(solver.t),
                "state": solver.y,
                "out": states[:, :reached],
                "counts": np.array(counts, dtype=np.float64),
                **own,
            }
        )
        self._begun = time.monotonic()
