"""Rendered texts brought to life without the package's own loader: executed and compiled here.

A spoiled text can so be evaluated as well, which the loader would refuse.
"""

from __future__ import annotations

import ctypes
import hashlib
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from coadjoint.lower.evaluation import run

COMPILER = shutil.which("gcc") or shutil.which("clang") or shutil.which("cc")
STRICT = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic"]
EXACT = ["-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared"]
#: Fused multiply-add, which the exact kernel must not have.
FUSED = [flag.replace("off", "fast") for flag in EXACT]


def compile_text(texts, folder: Path, flags, name="kernel.so") -> Path:
    """Compile ``kernel.c`` with warnings as errors."""
    for file in ("kernel.c", "kernel.h"):
        (folder / file).write_text(texts[file])
    target = folder / name
    command = [COMPILER, *STRICT, *flags, "kernel.c", "-o", str(target), "-lm"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    return target


class TextSystem:
    """Has what `crosscheck` asks of a system: a name, parameters, and a method per function."""

    def __init__(self, context, texts, folder: Path, c_flags=EXACT):
        self.name = context.name
        self.PARAMETERS = {quantity.name: quantity for quantity in context.parameters}
        self.DOMAIN = context.domain
        self.rows = {program.name: program.shape for program in context.programs}
        self.python = {}
        self.texts = texts
        exec(texts["kernel.py"], self.python)
        self.plain = {}
        exec(texts["kernel_python.py"], self.plain)
        self.libraries = {}
        for target, flags in (("c", c_flags), ("c-fast", FUSED)):
            # A folder of its own: dlopen takes a path it has loaded before for the same library.
            path = compile_text(texts, Path(tempfile.mkdtemp(dir=folder)), flags)
            self.libraries[target] = ctypes.CDLL(str(path))

    def load_kernels(self, targets):
        """Everything was compiled when the system was made; the hash of each text."""
        files = {"numpy": "kernel.py", "python": "kernel_python.py"}
        return {
            target: hashlib.sha256(self.texts[files.get(target, "kernel.c")].encode()).hexdigest()
            for target in targets
        }

    def __getattr__(self, function):
        def method(state, parameters, target="c", out=None):
            if target == "numpy":
                return self.python[function](state, parameters, out)
            if target == "python":
                return self._plain(function, state, parameters, out)
            return self._call(function, state, parameters, target, out)

        return method

    def _plain(self, function, state, parameters, out):
        """The plain Python function, one member after the other; NaN where Python has no number."""
        members = state.shape[1]
        out = np.empty((*self.rows[function], members)) if out is None else out
        for member in range(members):
            own = parameters if parameters.ndim == 1 else parameters[:, member]
            try:
                values = self.plain[function](state[:, member].tolist(), own.tolist())
            except (ArithmeticError, ValueError):
                values = np.nan
            out[..., member] = values
        return out

    def _call(self, function, state, parameters, target, out):
        """One call of the C function, as its header declares it."""
        state, parameters = np.ascontiguousarray(state), np.ascontiguousarray(parameters)
        members = state.shape[1]
        out = np.empty((*self.rows[function], members)) if out is None else out
        stride = members if parameters.ndim > 1 else 0
        getattr(self.libraries[target], f"{self.name}_{function}")(
            ctypes.c_size_t(members),
            ctypes.c_void_p(state.ctypes.data),
            ctypes.c_size_t(members),
            ctypes.c_void_p(parameters.ctypes.data),
            ctypes.c_size_t(stride),
            ctypes.c_void_p(out.ctypes.data),
            ctypes.c_size_t(members),
        )
        return out


class ProgramReference:
    """Programs in place of equations, for tests of the comparison itself."""

    def __init__(self, programs):
        self.programs = {program.name: program for program in programs}

    def evaluate(self, function, inputs, number, call):
        """All outputs of one function."""
        return run(self.programs[function], inputs, number, call)
