"""Structure constants as the judge knows them: commutators of matrices written down here.

Comes in: the table [algebra] of a spec. Goes out: names of the basis and constants c[i][j][k] with
[e_i, e_j] = c_ij^k e_k. The bases are those of docs/notation.md; nothing is shared with the engine.
"""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np

from tests.adversary.reader import mpf, number, read, value


def _unit(size, i, j):
    matrix = np.zeros((size, size))
    matrix[i, j] = 1
    return matrix


def _rotations():
    """J1, J2, J3 of so(3) as matrices: J_a b = e_a x b."""
    return [
        _unit(3, (a + 2) % 3, (a + 1) % 3) - _unit(3, (a + 1) % 3, (a + 2) % 3) for a in range(3)
    ]


def _bordered(matrix, size):
    found = np.zeros((size, size))
    found[: len(matrix), : len(matrix)] = matrix
    return found


def _so(n):
    pairs = [(i, j) for i in range(n) for j in range(i + 1, n)]
    names = [f"E{i + 1}{j + 1}" for i, j in pairs]
    return names, [_unit(n, i, j) - _unit(n, j, i) for i, j in pairs]


def _se2():
    turn = _unit(3, 1, 0) - _unit(3, 0, 1)
    return ["J", "P1", "P2"], [turn, _unit(3, 0, 2), _unit(3, 1, 2)]


def _se3():
    moves = [_unit(4, i, 3) for i in range(3)]
    names = ["J1", "J2", "J3", "P1", "P2", "P3"]
    return names, [*(_bordered(m, 4) for m in _rotations()), *moves]


def _sl2():
    return ["H", "X", "Y"], [
        _unit(2, 0, 0) - _unit(2, 1, 1),
        _unit(2, 0, 1),
        _unit(2, 1, 0),
    ]


def _heisenberg():
    return ["A1", "B1", "C"], [_unit(3, 0, 1), _unit(3, 1, 2), _unit(3, 0, 2)]


NAMED = {
    "so(3)": lambda: (["J1", "J2", "J3"], _rotations()),
    "so(4)": lambda: _so(4),
    "so(5)": lambda: _so(5),
    "se(2)": _se2,
    "se(3)": _se3,
    "sl(2,R)": _sl2,
    "h(1)": _heisenberg,
}


def commutators(matrices):
    """Constants of the commutators of independent matrices; they are whole numbers here."""
    flat = np.array([m.ravel() for m in matrices]).T
    size = len(matrices)
    found = np.zeros((size, size, size))
    for i, a in enumerate(matrices):
        for j, b in enumerate(matrices):
            bracket = (a @ b - b @ a).ravel()
            found[i, j], _, rank, _ = np.linalg.lstsq(flat, bracket, rcond=None)
            assert rank == size
            assert np.allclose(flat @ found[i, j], bracket, atol=1e-12)
    whole = np.rint(found)
    assert abs(whole - found).max() < 1e-9
    return whole


def constants(part, parameters):
    """The basis and the constants of an algebra at given parameters.

    Args:
        part: The table of a spec, or the name of an algebra.
        parameters: Values by name.
    """
    if isinstance(part, str):
        part = {"name": part}
    if "name" in part:
        names, matrices = NAMED[part["name"]]()
        return names, [[[mpf(x) for x in row] for row in plane] for plane in commutators(matrices)]
    if "direct_sum" in part:
        return _direct_sum([constants(each, parameters) for each in part["direct_sum"]])
    return list(part["basis"]), _declared(part["basis"], part.get("brackets", {}), parameters)


def basis_of(part):
    """The names of the basis of an algebra."""
    if "basis" in part:
        return list(part["basis"])
    return constants(part, {})[0]


def blocks_of(part, names):
    """The blocks that so(3), se(2) and se(3) have by name: places in the basis."""
    turning = [i for i, name in enumerate(names) if re.fullmatch(r"J\d?", name)]
    moving = [i for i, name in enumerate(names) if re.fullmatch(r"P\d", name)]
    return {"rotation": turning, "translation": moving}


def _empty(size):
    return [[[mpf(0)] * size for _ in range(size)] for _ in range(size)]


def _direct_sum(parts):
    size, found, names, start = sum(len(n) for n, _ in parts), None, [], 0
    found = _empty(size)
    for place, (basis, inner) in enumerate(parts, 1):
        for i, plane in enumerate(inner):
            for j, row in enumerate(plane):
                found[start + i][start + j][start : start + len(row)] = row
        names += [f"{name}_{place}" for name in basis]
        start += len(basis)
    return names, found


def _declared(basis, brackets, parameters):
    size = len(basis)
    found = _empty(size)
    for key, text in brackets.items():
        one, two = (basis.index(name.strip()) for name in key.strip("[] ").split(","))
        for k in range(size):
            units = {name: mpf(n == k) for n, name in enumerate(basis)}
            parameters.update(units)
            slope = value(read(text), parameters)
            found[one][two][k], found[two][one][k] = slope, -slope
    return found


def as_number(default):
    """A default of a spec: a number, a text or a list of them, as a flat list."""
    if isinstance(default, list):
        return [x for part in default for x in as_number(part)]
    return [number(Fraction(str(default)))]
