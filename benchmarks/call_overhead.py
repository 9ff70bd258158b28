"""What one call of a C kernel costs from Python beyond the kernel itself, for one member."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from c_kernels import compiled
from figures import Figure, script, take_turns

from coadjoint.build.library import load_library
from coadjoint.resources import systems_folder
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System

#: Microseconds that each way of calling may cost beyond the kernel; None where none is demanded.
TARGETS = {
    "bound call": 0.25,
    "rhs(state)": 3.0,
    "rhs(state, array)": None,
    "rhs(state, dict)": None,
    "rhs(state, array, out=out)": None,
}


def ways(system: System, state: Any, out: Any) -> dict[str, Callable[[], object]]:
    """The ways of calling a kernel, by name."""
    packed = system.pack(None).copy()
    named = {"I": [1.0, 2.0, 3.0], "m": 1.0, "chi": [0.0, 0.0, 1.0]}
    return {
        "bound call": system.bind("rhs", state, packed, out=out),
        "rhs(state)": lambda: system.rhs(state),
        "rhs(state, array)": lambda: system.rhs(state, packed),
        "rhs(state, dict)": lambda: system.rhs(state, named),
        "rhs(state, array, out=out)": lambda: system.rhs(state, packed, out=out),
    }


def kernel_seconds(system: System, state: Any, out: Any) -> float:
    """Seconds of the same kernel called from C."""
    parameters, times = system.pack(None), 100_000
    kernel = load_library(system.folder, system.name, system.id, "exact", lambda _: None)
    size, address = ctypes.c_size_t, ctypes.c_void_p
    with tempfile.TemporaryDirectory() as folder:
        repeat = compiled("repeat", Path(folder)).repeat
        arguments = (
            address(kernel.find("rhs")),
            *(size(1), address(state.ctypes.data), size(1)),
            *(address(parameters.ctypes.data), size(0), address(out.ctypes.data), size(1)),
        )
        return take_turns({"c": lambda: repeat(size(times), *arguments)}, 31)["c"].median / times


def measure() -> list[Figure]:
    """Microseconds of a call in each way, less those of the kernel."""
    system = load_folder(systems_folder() / "heavy_top")
    state = np.random.default_rng(0).normal(size=system.STATE.size)
    out = np.empty_like(state)
    alone = kernel_seconds(system, state, out)
    called = ways(system, state, out)
    for call in called.values():
        call()
    taken = take_turns(called, rounds=41, calls=5_000)
    figures = []
    for name, most in TARGETS.items():
        extra = (taken[name].median - alone) * 1e6
        what = f"heavy_top: {name} in C at N = 1 from Python, beyond the kernel"
        whole = taken[name].text(1e-6, "us")
        measured = f"{extra:.2f} us, of {whole}; kernel {alone * 1e9:.0f} ns"
        target = "none" if most is None else f"<= {most:g} us"
        figures.append(Figure(what, target, measured, None if most is None else extra <= most))
    return figures


if __name__ == "__main__":
    script(measure)
