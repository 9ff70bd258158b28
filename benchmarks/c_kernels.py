"""Generated C against C by hand (`hand/*.c`): rhs of 1000 members, the same compiler flags."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from figures import SYSTEMS, Figure, best_of, script

from coadjoint.build.compiler import compile_kernel, find_compiler
from coadjoint.build.library import load_library
from coadjoint.resources import systems_folder
from coadjoint.solve.system import System, load_folder

MEMBERS = 1000
CALLS = 1000
HAND = Path(__file__).parent / "hand"


def compiled(name: str, folder: Path) -> ctypes.CDLL:
    """A file of ``hand/``, compiled as generated kernels are."""
    place = folder / name
    place.mkdir()
    (place / "kernel.c").write_bytes((HAND / f"{name}.c").read_bytes())
    return ctypes.CDLL(str(compile_kernel(find_compiler(), place, "exact")))


def contest(system: System, hand: Any, repeat: Any) -> dict[str, float]:
    """Seconds of one call of the generated and of the hand-written kernel.

    Raises:
        AssertionError: They do not compute the same.
    """
    library = load_library(system.folder, system.name, system.id, "exact", lambda _: None)
    by_hand = ctypes.cast(hand, ctypes.c_void_p).value
    kernels = {"generated": library.find("rhs"), "by hand": by_hand}
    state = np.random.default_rng(0).normal(size=(system.STATE.size, MEMBERS))
    # One result array for both: where an array lies decides how its rows share the cache.
    parameters, out = system.pack(None), np.empty_like(state)
    size, address = ctypes.c_size_t, ctypes.c_void_p
    arguments = (
        *(size(MEMBERS), address(state.ctypes.data), size(MEMBERS)),
        *(address(parameters.ctypes.data), size(0), address(out.ctypes.data), size(MEMBERS)),
    )

    def caller(name: str, times: int) -> Callable[[], None]:
        pointer = address(kernels[name])
        return lambda: repeat(size(times), pointer, *arguments)

    results = {}
    for name in kernels:
        out[:] = np.nan
        caller(name, 1)()
        results[name] = out.copy()
    scale = np.abs(results["by hand"]).max()
    assert scale > 0
    assert np.abs(results["generated"] - results["by hand"]).max() <= 1e-13 * scale
    taken = best_of({name: caller(name, CALLS) for name in kernels}, rounds=60)
    return {name: seconds / CALLS for name, seconds in taken.items()}


def measure() -> list[Figure]:
    """Speed of generated C in units of hand-written C, for each system."""
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        repeat = compiled("repeat", Path(folder)).repeat
        repeat.restype = None
        for name in SYSTEMS:
            hand = compiled(name, Path(folder)).hand_rhs
            taken = contest(load_folder(systems_folder() / name), hand, repeat)
            ratio = taken["by hand"] / taken["generated"]
            nanoseconds = {which: seconds * 1e9 for which, seconds in taken.items()}
            measured = (
                f"{ratio:.2f} ({nanoseconds['generated']:.0f} ns, by hand "
                f"{nanoseconds['by hand']:.0f} ns)"
            )
            what = f"{name}: C rhs, N = {MEMBERS}, speed against C by hand"
            figures.append(Figure(what, ">= 0.90", measured, ratio >= 0.9))
    return figures


if __name__ == "__main__":
    script(measure)
