"""A body on an orbit typed by hand in axes of space, for comparison with ours.

Each function takes the components of state and parameters as flat sequences, as those of
`tests.sources.textbook`, which has them by system.
"""

from __future__ import annotations

from typing import Any

from tests.sources.components import Vector, cross, dot, over, plus, times
from tests.sources.points import length


def _turn(rows: list[Vector], a: Vector) -> list[Any]:
    """``R a``."""
    return [dot(row, a) for row in rows]


def _parts(x: Vector, given: Vector) -> tuple[Any, ...]:
    """Momenta, the rows of R, the place, and its distance."""
    rows, place = [x[6:9], x[10:13], x[14:17]], [x[9], x[13], x[17]]
    return x[:3], x[3:6], rows, place, length(dot(place, place))


def orbit_rates(x: Vector, given: Vector) -> list[Any]:
    """Newton and Euler, with the force and the torque of second order (Hughes 1986, chapter 8).

    With the matrix of inertia ``J = R diag(I) R^T`` in axes of space and the unit vector e to the
    body, ``F = -(mu m/r^2) e - (3 mu/(2 r^4)) ((tr I - 5 e.Je) e + 2 J e)`` and in body axes the
    torque is ``(3 mu/r^3) c x I c`` with ``c = R^T e``.
    """
    (Pi, P, rows, place, r), (inertia, (m, mu)) = _parts(x, given), (given[:3], given[3:])
    omega, v, columns = over(Pi, inertia), [p / m for p in P], list(zip(*rows, strict=True))
    e = [a / r for a in place]
    c = [dot(column, e) for column in columns]
    Ic = [i * a for i, a in zip(inertia, c, strict=True)]
    Je = _turn(rows, Ic)
    scale = sum(inertia) - 5 * dot(e, Je)
    near = times(-3 * mu / (2 * r**4), plus(times(scale, e), times(2, Je)))
    force = plus(times(-mu * m / r**2, e), near)
    turned = [cross(row, omega) for row in rows]
    moved = _turn(rows, v)
    return [
        *plus(cross(Pi, omega), times(3 * mu / r**3, cross(c, Ic))),
        *plus(cross(P, omega), [dot(column, force) for column in columns]),
        *(value for row, own in zip(turned, moved, strict=True) for value in (*row, own)),
    ]


def orbit_observables(x: Vector, given: Vector) -> dict[str, Any]:
    """MacCullagh's formula for the potential; the angular momentum in axes of space; R R^T."""
    (Pi, P, rows, place, r), (inertia, (m, mu)) = _parts(x, given), (given[:3], given[3:])
    omega, v = over(Pi, inertia), [p / m for p in P]
    c = [dot(column, place) / r for column in zip(*rows, strict=True)]
    about = sum(i * a**2 for i, a in zip(inertia, c, strict=True))  # the moment about the radius
    potential = -mu * m / r - mu * (sum(inertia) - 3 * about) / (2 * r**3)
    J = plus(_turn(rows, Pi), cross(place, _turn(rows, P)))
    cofactors = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])]
    seen = plus(_turn(cofactors, Pi), cross(place, _turn(rows, P)))  # J, where R is a rotation
    gram = {f"g_gram{i + 1}{j + 1}": dot(rows[i], rows[j]) for i in range(3) for j in range(i, 3)}
    return {
        "energy": dot(Pi, omega) / 2 + dot(P, v) / 2 + potential,
        **{f"Omega{n + 1}": value for n, value in enumerate(omega)},
        **{f"v{n + 1}": value for n, value in enumerate(v)},
        **{f"J{n + 1}": value for n, value in enumerate(J)},
        **{f"Pi_spatial{n + 1}": value for n, value in enumerate(seen)},
        **{f"P_spatial{n + 1}": value for n, value in enumerate(_turn(rows, P))},
        **gram,
    }


def orbit_tensor(x: Vector) -> list[list[Any]]:
    """``{F, Pi_k}`` and ``{F, P_k}`` are what axis k of the body turns and moves; g commutes."""
    Pi, P, rows = x[:3], x[3:6], [x[6:9], x[10:13], x[14:17]]
    units = [[int(i == k) for i in range(3)] for k in range(3)]
    columns = []
    for unit in units:  # of Pi_k: as dx/dt with Omega = unit
        turned = (value for row in rows for value in (*cross(row, unit), 0))
        columns.append([*cross(Pi, unit), *cross(P, unit), *turned])
    for k, unit in enumerate(units):  # of P_k: as dx/dt with v = unit
        moved = (value for row in rows for value in (0, 0, 0, row[k]))
        columns.append([*cross(P, unit), 0, 0, 0, *moved])
    whole = [[0] * 18 for _ in range(18)]
    for k, column in enumerate(columns):
        for i, value in enumerate(column):
            whole[i][k], whole[k][i] = value, -value
    return whole
