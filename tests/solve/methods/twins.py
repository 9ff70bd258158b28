"""The templates of the methods on coadjoint orbits, compiled for motions written by hand.

Formulas of a motion are text that C and Python read alike, so that NumPy and C compute the same.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from coadjoint.build.compiler import compile_kernel, find_compiler
from coadjoint.build.source import Source
from coadjoint.lower.compositions import COMPOSITIONS
from coadjoint.lower.normals import SWEEPS
from coadjoint.methods import TERMS, Sphere
from coadjoint.render.environment import environment
from coadjoint.solve.methods import coadjoint_mean, spherical_midpoint
from coadjoint.solve.methods.coadjoint_mean import CoadjointMean
from coadjoint.solve.methods.isospectral_midpoint import IsospectralMidpoint
from coadjoint.solve.methods.lie_poisson import STOPPING, LiePoisson
from coadjoint.solve.methods.spherical_midpoint import SphericalMidpoint
from coadjoint.solve.steps import Lanes

Array = Any
#: Macros of the methods, with the file of each and its order.
NAMES = {
    f"{file.upper()}{'' if order == 2 else order}": (file, order)
    for file in ("coadjoint_mean", "spherical_midpoint", "isospectral_midpoint")
    for order in COMPOSITIONS
}


def _cross(x: str, i: int, v: str, j: int) -> list[str]:
    """Rows of a cross product of three rows from i on with three from j on."""
    rows = [(1, 2), (2, 0), (0, 1)]
    return [f"({x}[{i + a}]*{v}[{j + b}] - {x}[{i + b}]*{v}[{j + a}])" for a, b in rows]


def _so(n: int) -> tuple[list[str], list[str]]:
    """``[B, W]`` and ``B W B`` of antisymmetric matrices, in the entries above the diagonal."""
    places = {pair: k for k, pair in enumerate(combinations(range(n), 2))}

    def entry(name: str, i: int, j: int) -> str:
        return f"{name}[{places[i, j]}]" if i < j else f"(-{name}[{places[j, i]}])"

    def product(one: str, other: str, i: int, j: int) -> str:
        inner = [k for k in range(n) if k not in (i, j)]
        return "(" + " + ".join(f"{entry(one, i, k)}*{entry(other, k, j)}" for k in inner) + ")"

    bracket = [f"{product('v', 'x', i, j)} - {product('x', 'v', i, j)}" for i, j in places]
    both = []
    for i, j in places:
        # (B W)_ik: its diagonal does not vanish
        terms = []
        for k in range(n):
            if k == j:
                continue
            inner = [m for m in range(n) if m not in (i, k)]
            left = " + ".join(f"{entry('v', i, m)}*{entry('x', m, k)}" for m in inner)
            terms.append(f"({left})*{entry('v', k, j)}")
        both.append(" + ".join(terms))
    return bracket, both


@dataclass(frozen=True)
class Written:
    """A motion: rows of text of the gradient in x, of others in x and v."""

    gradient: list[str]
    bracket: list[str]
    sandwich: list[str]
    spheres: tuple[Sphere, ...] = ()

    @property
    def size(self) -> int:
        """How many components the state has."""
        return len(self.gradient)

    def evaluate(self, rows: list[str], x: Array, v: Array = None) -> Array:
        """Rows in NumPy."""
        return np.array([eval(row, {"x": x, "v": v}) for row in rows])  # our own text


def _nonlinear(n: int) -> list[str]:
    """A gradient of ``sum x_i^2/(2 (i + 1)) + x_i^2 x_(i+1)/20``."""
    nexts = {**dict(pairwise(range(n))), n - 1: 0}
    before = {b: a for a, b in nexts.items()}
    return [
        f"x[{i}]*(1.0/{i + 1}.0) + 0.1*x[{i}]*x[{nexts[i]}] + 0.05*x[{before[i]}]*x[{before[i]}]"
        for i in range(n)
    ]


def _joined(*parts: list[str]) -> list[str]:
    return [" + ".join(rows) for rows in zip(*parts, strict=True)]


_BRACKET_4, _BOTH_4 = _so(4)
_BRACKET_6, _BOTH_6 = _so(6)
_BRACKET_8, _BOTH_8 = _so(8)
_SE3 = [*_joined(_cross("x", 0, "v", 0), _cross("x", 3, "v", 3)), *_cross("x", 3, "v", 0)]
#: Motions by name.
WRITTEN = {
    "so(3)": Written(_nonlinear(3), _cross("x", 0, "v", 0), [], (Sphere((0, 1, 2)),)),
    "so(3) x so(3)": Written(
        _nonlinear(6),
        [*_cross("x", 0, "v", 0), *_cross("x", 3, "v", 3)],
        [],
        (Sphere((0, 1, 2)), Sphere((3, 4, 5))),
    ),
    "se(3)": Written(_nonlinear(6), _SE3, [], (Sphere((3, 4, 5), (0, 1, 2)),)),
    "free body": Written(
        ["x[0]*1.0", "x[1]*0.5", "x[2]*1.5"], _cross("x", 0, "v", 0), [], (Sphere((0, 1, 2)),)
    ),
    "heavy top": Written(
        ["x[0]*1.0", "x[1]*0.5", "x[2]*1.5", "0.2 + 0.0*x[0]", "0.0*x[0]", "0.7 + 0.0*x[0]"],
        _SE3,
        [],
        (Sphere((3, 4, 5), (0, 1, 2)),),
    ),
    "so(4)": Written(_nonlinear(6), _BRACKET_4, _BOTH_4),
    "so(6)": Written([f"x[{i}]*(1.0/{i + 1}.0)" for i in range(15)], _BRACKET_6, _BOTH_6),
    "so(8)": Written([f"x[{i}]*(1.0/{i + 1}.0)" for i in range(28)], _BRACKET_8, _BOTH_8),
}

_PRELUDE = """
#include "kernel.h"
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#define LANES 4
#define BLOCKS 2
#pragma GCC diagnostic ignored "-Wpsabi"
typedef double V __attribute__((vector_size(8 * LANES)));
typedef int64_t I __attribute__((vector_size(8 * LANES)));
#define INLINE static inline __attribute__((always_inline, unused))
#define EACH(w) for (int w = 0; w < LANES; ++w)
INLINE V all(double a) { V found; EACH(w) found[w] = a; return found; }
INLINE V choose(I mask, V a, V b) { return (V)(((I)a & mask) | ((I)b & ~mask)); }
INLINE V size_of(V a) { return (V)((I)a & INT64_MAX); }
INLINE V larger(V a, V b) { return choose(a > b, a, b); }
INLINE V add_low(V high, V *low, V rise)
{
    const V added = rise + *low, total = high + added, other = total - high;
    *low = (high - (total - other)) + (added - other);
    return total;
}
INLINE int any(I mask) { int64_t found = 0; EACH(w) found |= mask[w]; return found != 0; }
"""
_EPILOGUE = """
void go(double *state, double *memory, uint8_t *solved, double *made, size_t count, double h,
        long steps)
{
    const size_t members = count * LANES;
    for (size_t first = 0; first < count; first += BLOCKS) {
        const int here = count - first < BLOCKS ? (int)(count - first) : BLOCKS;
        Block blocks[BLOCKS] = {0};
        V ends[BLOCKS][STATE], memories[BLOCKS][MEMORY], sweeps[BLOCKS], size[BLOCKS];
        V *left[BLOCKS];
        I fine[BLOCKS];
        for (int b = 0; b < here; ++b) {
            size[b] = all(h);
            left[b] = memories[b];
            for (size_t i = 0; i < MEMORY; ++i) EACH(w) {
                const size_t n = i * members + (first + (size_t)b) * LANES + (size_t)w;
                if (i < STATE)
                    ends[b][i][w] = state[n];
                memories[b][i][w] = memory[n];
            }
        }
        for (long s = 0; s < steps; ++s)
            advance(blocks, here, size, ends, left, 0, fine, sweeps);
        for (int b = 0; b < here; ++b) EACH(w) {
            const size_t m = (first + (size_t)b) * LANES + (size_t)w;
            for (size_t i = 0; i < STATE; ++i)
                state[i * members + m] = ends[b][i][w];
            for (size_t i = 0; i < MEMORY; ++i)
                memory[i * members + m] = memories[b][i][w];
            solved[m] = fine[b][w] != 0;
            made[m] = sweeps[b][w];
        }
    }
}
"""


def render(written: Written) -> str:
    """The text of the methods as a solver includes it."""
    names = {
        macro: (file, order)
        for macro, (file, order) in NAMES.items()
        if (written.spheres or file != "spherical_midpoint")
        and (written.sandwich or file != "isospectral_midpoint")
    }
    return (
        environment()
        .get_template("c/methods/lie_poisson.c.j2")
        .render(
            lie_poisson={
                "names": names,
                "stages": {order: list(map(repr, each)) for order, each in COMPOSITIONS.items()},
                "tableaus": {},
                "stopping": STOPPING,
                "spheres": written.spheres,
                "sweeps": SWEEPS,
                "terms": TERMS,
                "has_bracket": True,
                "known": 0,
                "carriers": (),
                "is_noisy": False,
                "has_newton": False,
                "near": spherical_midpoint.NEAR,
                "roundings": spherical_midpoint.ROUNDINGS,
                "mean": {
                    name: getattr(coadjoint_mean, name) for name in ("TERMS", "LEAST", "PARTS")
                },
            },
        )
    )


def _write_function(name: str, rows: list[str]) -> str:
    lines = [f"    rows[{i}] = {row};" for i, row in enumerate(rows)]
    return "\n".join([
        f"INLINE void find_{name}(const Block *block, V after, const V *x, V *restrict rows)",
        "{",
        "    const V *v = x + STATE;",
        *lines,
        "    (void)v, (void)block, (void)after;",
        "}",
        "",
    ])  # fmt: skip


class Compiled:
    """A method for a motion, in C.

    Args:
        written: The motion.
        macro: The method.
        folder: Where it is compiled.
        spoil: What is replaced in the text, and by what.
    """

    def __init__(self, written: Written, macro: str, folder: Path, *spoil: tuple[str, str]) -> None:
        text = render(written)
        for found, put in spoil:
            assert text.count(found) > 0, found
            text = text.replace(found, put)
        functions = [
            _write_function("energy_gradient", written.gradient),
            _write_function("bracket_vector", written.bracket),
        ]
        if written.sandwich:
            functions.append(_write_function("sandwich", written.sandwich))
        self.parts = 1 + TERMS * len(COMPOSITIONS[NAMES[macro][1]])
        head = f"enum {{ STATE = {written.size}, MEMORY = {self.parts} * STATE }};\n"
        head += "typedef struct { V none; } Block;\n"
        finite = (
            "INLINE I are_finite(const V *rows)\n{\n    I found = rows[0] - rows[0] == 0.0;\n"
            "    for (int i = 1; i < STATE; ++i)\n        found &= rows[i] - rows[i] == 0.0;\n"
            "    return found;\n}\n"
        )
        folder.mkdir(exist_ok=True)
        (folder / "kernel.c").write_text(
            _PRELUDE + head + finite + "\n".join(functions) + text + _EPILOGUE, encoding="ascii"
        )
        (folder / "kernel.h").write_text(
            "#include <stddef.h>\n#include <stdint.h>\n"
            "void go(double *, double *, uint8_t *, double *, size_t, double, long);\n",
            encoding="ascii",
        )
        source = Source("kernel", (f"-D{macro}",), is_loops=False)
        library = ctypes.CDLL(str(compile_kernel(find_compiler(), folder, "exact", source)))
        self._go = library.go

    def run(self, x: Array, h: float, count: int) -> tuple[Array, Array, Array, Array]:
        """States after so many steps, what the last left, where it was solved, sweeps."""
        members = x.shape[1]
        assert members % 4 == 0
        state, memory = np.ascontiguousarray(x), np.zeros((self.parts * len(x), members))
        solved, made = np.zeros(members, np.uint8), np.zeros(members)
        pointers = [ctypes.c_void_p(each.ctypes.data) for each in (state, memory, solved, made)]
        state = state.copy() if state is x else state
        pointers[0] = ctypes.c_void_p(state.ctypes.data)
        self._go(*pointers, ctypes.c_size_t(members // 4), ctypes.c_double(h), ctypes.c_long(count))
        return state, memory, solved.astype(bool), made


def make_twin(written: Written, macro: str) -> LiePoisson:
    """The same method in NumPy."""
    file, order = NAMES[macro]

    def gradient(lanes: Lanes, after: Array, x: Array) -> Array:
        return written.evaluate(written.gradient, x)

    def bracket(lanes: Lanes, after: Array, x: Array, v: Array) -> Array:
        return written.evaluate(written.bracket, x, v)

    def sandwich(lanes: Lanes, after: Array, x: Array, v: Array) -> Array:
        return written.evaluate(written.sandwich, x, v)

    def field(lanes: Lanes, after: Array, x: Array) -> Array:
        return bracket(lanes, after, x, gradient(lanes, after, x))

    if file == "spherical_midpoint":
        return SphericalMidpoint(field=field, size=0.1, spheres=written.spheres, order=order)
    given: dict[str, Any] = {
        "gradient": gradient,
        "bracket": bracket,
        "size": 0.1,
        "order": order,
    }
    if file == "isospectral_midpoint":
        return IsospectralMidpoint(**given, sandwich=sandwich)
    return CoadjointMean(**given)
