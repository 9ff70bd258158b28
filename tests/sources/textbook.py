"""Equations of motion typed by hand from books, in any arithmetic, by system.

The formulas are in `tests.sources.bodies` and `tests.sources.motions`; cross products and matrix
commutators of the shipped systems are written out there and nowhere else. Where the book states
``ad*``, the tensor of the minus bracket is read off it by units.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, combinations_with_replacement
from typing import Any

from tests.sources.bodies import (
    heavy_top_observables,
    heavy_top_rates,
    kirchhoff_observables,
    kirchhoff_rates,
    nambu_body_observables,
    nambu_pendulum_observables,
    nambu_pendulum_tensor,
    rigid_body_observables,
    rigid_body_rates,
    rigid_body_tensor,
    se3_tensor,
    so4_ad_star,
    so4_body_observables,
    so4_body_rates,
    so_n_ad_star,
    so_n_observables,
    so_n_rates,
)
from tests.sources.components import Vector, minus_bracket
from tests.sources.motions import (
    affine_line_observables,
    affine_line_rates,
    bargmann_ad_star,
    bargmann_observables,
    bargmann_rates,
    galilei_ad_star,
    galilei_observables,
    galilei_rates,
    heisenberg_ad_star,
    heisenberg_observables,
    heisenberg_rates,
    se2_pendulum_observables,
    se2_pendulum_rates,
    se2_tensor,
    sl2_r2_ad_star,
    sl2_r2_observables,
    sl2_r2_rates,
    sp2_momentum_observables,
    sp2_momentum_rates,
    sp2_tensor,
)
from tests.sources.phase_spaces import (
    ellipsoid_observables,
    ellipsoid_rates,
    oscillator_observables,
    oscillator_rates,
    paired,
    spd_observables,
    spd_rates,
    spd_tensor,
)


def numbered(name: str, count: int) -> tuple[str, ...]:
    """``Pi1, Pi2, ...``."""
    return tuple(f"{name}{n + 1}" for n in range(count))


def upper(name: str, size: int) -> tuple[str, ...]:
    """``M12, M13, ..., M23, ...``: the entries above the diagonal, row by row."""
    return tuple(f"{name}{i}{j}" for i, j in combinations(range(1, size + 1), 2))


def kept(name: str, size: int) -> tuple[str, ...]:
    """``S11, S12, ..., S22, ...``: the entries on and above the diagonal, row by row."""
    places = combinations_with_replacement(range(1, size + 1), 2)
    return tuple(f"{name}{i}{j}" for i, j in places)


def square(name: str, size: int) -> tuple[str, ...]:
    """``A11, A12, ...``: all entries, row by row."""
    places = range(1, size + 1)
    return tuple(f"{name}{i}{j}" for i in places for j in places)


#: Positive symmetric matrices, by their size.
SPD = {"spd_motion": 2, "spd_motion_3": 3}
#: Systems whose rates are quotients, which no central difference meets exactly.
QUOTIENTS = ("ellipsoidal_motion",)
BODIES = {f"so{n}_body": n for n in (5, 6, 8)}
RATES = {
    "rigid_body": rigid_body_rates,
    "heavy_top": heavy_top_rates,
    "kirchhoff": kirchhoff_rates,
    "heisenberg": heisenberg_rates,
    "se2_pendulum": se2_pendulum_rates,
    "sl2_r2": sl2_r2_rates,
    "so4_body": so4_body_rates,
    "galilei": galilei_rates,
    "bargmann": bargmann_rates,
    "nambu_body": rigid_body_rates,
    "nambu_pendulum": rigid_body_rates,
    "affine_line": affine_line_rates,
    "sp2_momentum": sp2_momentum_rates,
    "ellipsoidal_motion": ellipsoid_rates,
    "c3_oscillators": oscillator_rates,
    **{name: spd_rates(n) for name, n in SPD.items()},
    **dict.fromkeys(BODIES, so_n_rates),
}
OBSERVABLES = {
    "rigid_body": rigid_body_observables,
    "heavy_top": heavy_top_observables,
    "kirchhoff": kirchhoff_observables,
    "heisenberg": heisenberg_observables,
    "se2_pendulum": se2_pendulum_observables,
    "sl2_r2": sl2_r2_observables,
    "so4_body": so4_body_observables,
    "galilei": galilei_observables,
    "bargmann": bargmann_observables,
    "nambu_body": nambu_body_observables,
    "nambu_pendulum": nambu_pendulum_observables,
    "affine_line": affine_line_observables,
    "sp2_momentum": sp2_momentum_observables,
    "ellipsoidal_motion": ellipsoid_observables,
    "c3_oscillators": oscillator_observables,
    **{name: spd_observables(n) for name, n in SPD.items()},
    **dict.fromkeys(BODIES, so_n_observables),
}
#: Brackets by the state; that of the pendulum on a cylinder knows the parameters too.
TENSORS: dict[str, Callable[[Vector, Vector], list[list[Any]]]] = {
    "rigid_body": lambda x, p: rigid_body_tensor(x),
    "heavy_top": lambda x, p: se3_tensor(x),
    "kirchhoff": lambda x, p: se3_tensor(x),
    "heisenberg": lambda x, p: minus_bracket(heisenberg_ad_star, x),
    "se2_pendulum": lambda x, p: se2_tensor(x),
    "sl2_r2": lambda x, p: minus_bracket(sl2_r2_ad_star, x),
    "so4_body": lambda x, p: minus_bracket(so4_ad_star, x),
    "galilei": lambda x, p: minus_bracket(galilei_ad_star, x),
    "bargmann": lambda x, p: minus_bracket(bargmann_ad_star, x),
    "nambu_body": lambda x, p: rigid_body_tensor(x),
    "nambu_pendulum": nambu_pendulum_tensor,
    "affine_line": lambda x, p: [[0, -x[1]], [x[1], 0]],
    "sp2_momentum": lambda x, p: sp2_tensor(x),
    "ellipsoidal_motion": lambda x, p: paired([1] * 9),
    "c3_oscillators": lambda x, p: paired([1] * 3),
    "spd_motion": lambda x, p: spd_tensor(2),
    "spd_motion_3": lambda x, p: spd_tensor(3),
    **dict.fromkeys(BODIES, lambda x, p: minus_bracket(so_n_ad_star(len(p)), x)),
}
GALILEI = (*numbered("J", 3), *numbered("K", 3), *numbered("P", 3), "E")
STATES = {
    "rigid_body": numbered("Pi", 3),
    "heavy_top": (*numbered("Pi", 3), *numbered("Gamma", 3)),
    "kirchhoff": (*numbered("Pi", 3), *numbered("P", 3)),
    "heisenberg": ("mu1", "mu2", "mu3"),
    "se2_pendulum": ("m", "b1", "b2"),
    "sl2_r2": ("h", "x", "y", "p1", "p2"),
    "so4_body": ("M1", "M2", "M3", "N1", "N2", "N3"),
    "galilei": GALILEI,
    "bargmann": (*GALILEI, "M"),
    "nambu_body": ("x1", "x2", "x3"),
    "nambu_pendulum": ("x1", "x2", "x3"),
    "affine_line": ("mu1", "mu2"),
    "sp2_momentum": ("X1", "X2", "X3"),
    "ellipsoidal_motion": (*square("Q", 3), *square("P", 3)),
    "c3_oscillators": (*numbered("q", 3), *numbered("p", 3)),
    **{
        name: (*kept("S", n), *kept("P", n), *numbered("q", n), *numbered("p", n))
        for name, n in SPD.items()
    },
    **{name: upper("M", n) for name, n in BODIES.items()},
}
INERTIAS = (*numbered("I", 3), *numbered("A", 3), *numbered("B", 3), "c")
PARAMETERS = {
    "rigid_body": numbered("I", 3),
    "heavy_top": (*numbered("I", 3), "m", "g", *numbered("chi", 3)),
    "kirchhoff": (*numbered("I", 3), *numbered("M", 3), *numbered("D", 3)),
    "heisenberg": (),
    "se2_pendulum": (),
    "sl2_r2": (*numbered("I", 3), "m"),
    "so4_body": (*numbered("I", 3), *numbered("L", 3)),
    "galilei": INERTIAS,
    "bargmann": INERTIAS,
    "nambu_body": numbered("I", 3),
    "nambu_pendulum": numbered("I", 3),
    "affine_line": (),
    "sp2_momentum": ("m", "k", "b"),
    "ellipsoidal_motion": ("k", "b"),
    "c3_oscillators": (*numbered("w", 3), "c", "k"),
    **dict.fromkeys(SPD, ()),
    **{name: numbered("a", n) for name, n in BODIES.items()},
}
