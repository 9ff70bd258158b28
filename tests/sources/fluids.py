"""Zeitlin's fluid on the sphere typed by hand, by products of spin matrices.

Harmonics are written as polynomials of x, y and z, and become matrices by the mean over all orders
of their factors. So nothing here is made by raising and lowering, as the engine's basis is.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cache, reduce
from itertools import permutations
from typing import Any

from tests.sources.components import Vector
from tests.sources.points import named

#: A polynomial: its coefficient by the factors of each term; and a matrix by its nonzero entries.
Polynomial = dict[str, Any]
Matrix = dict[tuple[int, int], Any]
#: Solid harmonics by their names, by names as C_lm and S_lm have.
HARMONICS: dict[str, Polynomial] = {
    "C1_0": {"z": 1},
    "C1_1": {"x": 1},
    "S1_1": {"y": 1},
    "C2_0": {"zz": 2, "xx": -1, "yy": -1},
    "C2_1": {"xz": 1},
    "S2_1": {"yz": 1},
    "C2_2": {"xx": 1, "yy": -1},
    "S2_2": {"xy": 2},
    "C3_0": {"zzz": 2, "xxz": -3, "yyz": -3},
    "C3_1": {"xzz": 4, "xxx": -1, "xyy": -1},
    "S3_1": {"yzz": 4, "xxy": -1, "yyy": -1},
    "C3_2": {"xxz": 1, "yyz": -1},
    "S3_2": {"xyz": 2},
    "C3_3": {"xxx": 1, "xyy": -3},
    "S3_3": {"xxy": 3, "yyy": -1},
}


def add(terms: Iterable[tuple[Any, Matrix]]) -> Matrix:
    """A sum of multiples of matrices."""
    found: Matrix = {}
    for factor, matrix in terms:
        for place, value in matrix.items():
            found[place] = found[place] + factor * value if place in found else factor * value
    return found


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """``A B``."""
    found: Matrix = {}
    for (i, k), x in a.items():
        for (row, j), y in b.items():
            if k == row:
                found[i, j] = found[i, j] + x * y if (i, j) in found else x * y
    return found


def commute(a: Matrix, b: Matrix) -> Matrix:
    """``A B - B A``."""
    return add([(1, multiply(a, b)), (-1, multiply(b, a))])


def half_trace(a: Matrix, b: Matrix) -> Any:
    """``tr(A B)/2``: the real part of the trace of complex matrices that stand as real ones."""
    found = [x * b[j, i] for (i, j), x in a.items() if (j, i) in b]
    return sum(found) / 2 if found else 0


@cache
def spins(n: int) -> dict[str, Matrix]:
    """S_x, S_y and S_z of n rows as real matrices ``((A, -B), (B, A))``, and i times 1.

    ``S_x = (S_+ + S_-)/2``, ``S_y = (S_+ - S_-)/(2 i)``; rows are scaled so that S_+ and S_- have
    the entries j and n - j, whose product is that of Hermitian ones.
    """
    half = Fraction(1, 2)
    up = {(j - 1, j): Fraction(j) for j in range(1, n)}
    down = {(j, j - 1): Fraction(n - j) for j in range(1, n)}
    i = {(n + k, k): 1 for k in range(n)} | {(k, n + k): -1 for k in range(n)}

    def double(a: Matrix) -> Matrix:
        return a | {(r + n, c + n): x for (r, c), x in a.items()}

    x = double(add([(half, up), (half, down)]))
    y = multiply(i, double(add([(-half, up), (half, down)])))
    return {"x": x, "y": y, "z": double({(k, k): half * (n - 1) - k for k in range(n)}), "i": i}


@cache
def matrix_of(name: str, n: int) -> Matrix:
    """I times the matrix of a harmonic."""
    S, terms = spins(n), list[tuple[Any, Matrix]]()
    for factors, coefficient in HARMONICS[name].items():
        orders = list(permutations(factors))
        factor = Fraction(coefficient, len(orders))
        terms += [(factor, reduce(multiply, (S[each] for each in order))) for order in orders]
    return {place: value for place, value in multiply(S["i"], add(terms)).items() if value}


#: What the engine's matrices of four rows are, times those of the harmonics.
FACTORS = {
    **dict.fromkeys(("C1_0", "C1_1", "S1_1", "C2_1", "S2_1", "C3_2", "S3_2"), Fraction(2)),
    **dict.fromkeys(("C2_2", "S2_2", "C3_1", "S3_1"), Fraction(1)),
    **dict.fromkeys(("C2_0", "C3_3", "S3_3"), Fraction(1, 3)),
    "C3_0": Fraction(2, 3),
}


@cache
def basis() -> tuple[Matrix, ...]:
    """The matrices E_k of four rows."""
    return tuple(add([(FACTORS[name], matrix_of(name, 4))]) for name in HARMONICS)


def degrees() -> list[int]:
    """The degree of each harmonic."""
    return [int(name[1]) for name in HARMONICS]


def vorticity(w: Vector) -> Matrix:
    """``W = sum w_k E_k/g_k``, so that ``w_k = -tr(W E_k)``."""
    own = basis()
    return add((x / -half_trace(E, E), E) for x, E in zip(w, own, strict=True))


def stream(w: Vector) -> Matrix:
    """P: the vorticity of degree l over ``-l (l + 1)``."""
    return vorticity([x / -(d * (d + 1)) for x, d in zip(w, degrees(), strict=True)])


def fluid_rates(w: Vector, parameters: Vector) -> list[Any]:
    """``dW/dt = [P, W]/hbar``."""
    turned = commute(stream(w), vorticity(w))
    return [-half_trace(turned, E) / parameters[0] for E in basis()]


def fluid_observables(w: Vector, parameters: Vector) -> dict[str, Any]:
    """``tr(P W)/(2 hbar)``, -tr W^2 and i tr W^3, and minus the stream function over hbar."""
    W, P, (hbar,) = vorticity(w), stream(w), parameters
    square = multiply(W, W)
    return {
        "energy": half_trace(P, W) / (2 * hbar),
        "casimir1": -half_trace(W, W),
        "casimir2": half_trace(multiply(square, W), spins(4)["i"]),
        **named(
            "Psi",
            [
                x / (-half_trace(E, E) * d * (d + 1) * hbar)
                for x, d, E in zip(w, degrees(), basis(), strict=True)
            ],
        ),
        **named("L", w[:3]),
    }


def fluid_tensor(w: Vector) -> list[list[Any]]:
    """``{w_i, w_j} = -<W, [E_i, E_j]>`` with ``<W, Y> = -tr(W Y)``."""
    W, own = vorticity(w), basis()
    return [[half_trace(W, commute(a, b)) for b in own] for a in own]


RATES = {"zeitlin_su_4": fluid_rates}
OBSERVABLES = {"zeitlin_su_4": fluid_observables}
TENSORS = {"zeitlin_su_4": lambda w, p: fluid_tensor(w)}
STATES = {"zeitlin_su_4": tuple(f"w{n}" for n in range(1, 16))}
PARAMETERS = {"zeitlin_su_4": ("hbar",)}
