"""What one call of a bound C kernel costs from Python beyond the kernel itself, for one member."""

from __future__ import annotations

import ctypes
import tempfile
from pathlib import Path

import numpy as np
from c_kernels import compiled
from figures import Figure, best_of, script

from coadjoint.build.library import load_library
from coadjoint.resources import systems_folder
from coadjoint.solve.system import load_folder


def measure() -> list[Figure]:
    """Microseconds of a bound call less those of the same kernel called from C."""
    system = load_folder(systems_folder() / "heavy_top")
    state = np.random.default_rng(0).normal(size=system.STATE.size)
    out, parameters = np.empty_like(state), system.pack(None)
    call = system.bind("rhs", state, None, out=out)
    kernel = load_library(system.folder, system.name, system.id, "exact", lambda _: None)
    with tempfile.TemporaryDirectory() as folder:
        repeat = compiled("repeat", Path(folder)).repeat
        size, address = ctypes.c_size_t, ctypes.c_void_p
        arguments = (
            address(kernel.find("rhs")),
            *(size(1), address(state.ctypes.data), size(1)),
            *(address(parameters.ctypes.data), size(0), address(out.ctypes.data), size(1)),
        )
        times = 100_000
        bound = best_of({"bound": call}, rounds=30, calls=20_000)["bound"]
        alone = best_of({"c": lambda: repeat(size(times), *arguments)}, rounds=30)["c"] / times
    extra = (bound - alone) * 1e6
    measured = f"{extra:.2f} us (kernel {alone * 1e9:.0f} ns)"
    what = "heavy_top: bound C rhs at N = 1 from Python, beyond the kernel"
    return [Figure(what, "<= 1 us", measured, extra <= 1.0)]


if __name__ == "__main__":
    script(measure)
