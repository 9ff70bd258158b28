"""Equations of motion typed by hand from books, in any arithmetic, by system.

The formulas are in `tests.sources.bodies` and `tests.sources.motions`; cross products and matrix
commutators of the shipped systems are written out there and nowhere else. Where the book states
``ad*``, the tensor of the minus bracket is read off it by units.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from itertools import combinations, combinations_with_replacement
from typing import Any

from tests.sources import classical, driven, extremals, fields, fluids, machines, rods
from tests.sources.balls import BALLS, ball_observables, ball_rates, ball_tensor
from tests.sources.bodies import (
    heavy_top_observables,
    heavy_top_rates,
    kirchhoff_observables,
    kirchhoff_rates,
    nambu_body_observables,
    nambu_pendulum_observables,
    nambu_pendulum_tensor,
    rigid_body_attitude_observables,
    rigid_body_attitude_rates,
    rigid_body_attitude_tensor,
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
from tests.sources.coupled import (
    coupled_observables,
    coupled_rates,
    coupled_tensor,
    vehicle_observables,
    vehicle_rates,
    vehicle_tensor,
)
from tests.sources.disks import ROLLING, body_observables, body_rates, body_tensor
from tests.sources.isospectral import (
    BLOCH_ISERLES,
    LAX_BODIES,
    QUADRATIC_BODIES,
    bloch_iserles_ad_star,
    bloch_iserles_observables,
    bloch_iserles_rates,
    manakov_observables,
    quadratic_ad_star,
    quadratic_observables,
    quadratic_rates,
)
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
from tests.sources.points import (
    Rounded,
    disk_observables,
    disk_rates,
    disk_tensor,
    kepler_observables,
    kepler_rates,
    monopole_observables,
    monopole_rates,
    monopole_tensor,
    particles_observables,
    particles_rates,
    particles_tensor,
)
from tests.sources.sliding import tippe_observables, tippe_rates
from tests.sources.tops import (
    clebsch_as_kirchhoff,
    clebsch_observables,
    complex_body_observables,
    complex_body_rates,
    complex_body_tensor,
    equatorial_as_heavy,
    goryachev_chaplygin_observables,
    kovalevskaya_observables,
    lagrange_as_heavy,
    lagrange_observables,
    pt_body_observables,
    pt_body_rates,
)


def within(name: str, point: dict[str, Any]) -> dict[str, Any]:
    """A point moved to where the system is defined.

    The height of a spheroid is real for every Gamma3 if it is longer than wide. Large friction jams
    a top that slides.
    """
    if name == "body_of_revolution":
        return point | {"C": abs(point["A"]) + abs(point["C"])}
    if name == "darwin_charges":
        return point | {"k": point["k"] / 1024}
    if name == "tippe_top":
        return point | {each: point[each] / 1024 for each in ("viscous", "coulomb")}
    return point


def rational(name: str, point: dict[str, Any]) -> dict[str, Any]:
    """A point moved to where the heights of rolling bodies, and fields, have rational roots.

    ``1 + (4/3)^2 = (5/3)^2`` of a disk, ``1 + 2^2 + 2^2 = 3^2`` of an ellipsoid and of lines that
    are screws, and ``A^2 (1 - z^2) + (A z/2)^2 z^2 = A^2 (1 - z^2/2)^2`` of a spheroid.
    """
    if name in ("rolling_disk", "euler_disk"):
        return point | {"Gamma2": point["Gamma1"] * 4 / 3}
    if name in ("rolling_ellipsoid", "rattleback"):
        long = 2 * point["axes1"] * point["Gamma1"]
        return point | {f"axes{n}": long / point[f"Gamma{n}"] for n in (2, 3)}
    if name == "body_of_revolution":
        return point | {"C": point["A"] * point["Gamma3"] / 2}
    if name == "darwin_charges":  # near each other, and as fractions that do not grow
        x, y, m, n, c = (abs(point[each]) + 1 for each in ("x1", "x2", "m1", "m2", "c"))
        far = {"x1": x, "x2": -y, "m1": m, "m2": n, "c": c, "k": point["k"] / 200}
        return {each: Rounded(value) for each, value in (point | far).items()}
    if name == "guiding_centre_twisted":
        place = 2 / Fraction(point["k"])
        return point | {"X1": place, "X2": -place, "B0": abs(point["B0"])}
    return point


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
#: Systems with roots, sines and cosines of what moves, which are typed to 80 digits.
CONFIGURATIONS = (
    "kapitza_top",
    "kepler",
    "monopole_kepler",
    "n_particles",
    "orbiting_body",
    "rocking_disk",
    *classical.CONFIGURATIONS,
    *extremals.CONFIGURATIONS,
    *fields.CONFIGURATIONS,
    *machines.CONFIGURATIONS,
    *ROLLING,
    "tippe_top",
)
#: Systems whose rates are quotients, which no central difference meets exactly.
QUOTIENTS = (
    "ellipsoidal_motion",
    "coupled_bodies",
    "pt_rigid_body",
    *BALLS,
    *CONFIGURATIONS,
    *classical.QUOTIENTS,
    *machines.QUOTIENTS,
)
#: Constrained motions: their bracket moves momenta, and Jacobi's identity fails.
CONSTRAINED = (*BALLS, *ROLLING, *classical.TENSORS, *machines.TENSORS)
BODIES = {f"so{n}_body": n for n in (5, 6, 8)}
#: Parameters of integrable tops as those of the heavy top.
TOPS = {
    "heavy_top_lagrange": lagrange_as_heavy,
    "heavy_top_kovalevskaya": equatorial_as_heavy(2),
    "heavy_top_goryachev_chaplygin": equatorial_as_heavy(4),
}
RATES = {
    "rigid_body": rigid_body_rates,
    "rigid_body_attitude": rigid_body_attitude_rates,
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
    "coupled_bodies": coupled_rates,
    "underwater_vehicle": vehicle_rates,
    "kepler": kepler_rates,
    "monopole_kepler": monopole_rates,
    "n_particles": particles_rates,
    "rocking_disk": disk_rates,
    **{
        name: lambda x, p, given=given: heavy_top_rates(x, given(p)) for name, given in TOPS.items()
    },
    "kirchhoff_clebsch": lambda x, p: kirchhoff_rates(x, clebsch_as_kirchhoff(p)),
    "complex_rigid_body": complex_body_rates,
    "pt_rigid_body": pt_body_rates,
    **{name: spd_rates(n) for name, n in SPD.items()},
    **dict.fromkeys((*BODIES, *LAX_BODIES), so_n_rates),
    **dict.fromkeys(QUADRATIC_BODIES, quadratic_rates),
    **{name: bloch_iserles_rates(n) for name, n in BLOCH_ISERLES.items()},
    **classical.RATES,
    **driven.RATES,
    **extremals.RATES,
    **fields.RATES,
    **fluids.RATES,
    **machines.RATES,
    **rods.RATES,
    **{name: partial(ball_rates, name) for name in BALLS},
    **{name: partial(body_rates, name) for name in ROLLING},
    "tippe_top": tippe_rates,
}
OBSERVABLES = {
    "rigid_body": rigid_body_observables,
    "rigid_body_attitude": rigid_body_attitude_observables,
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
    "coupled_bodies": coupled_observables,
    "underwater_vehicle": vehicle_observables,
    "kepler": kepler_observables,
    "monopole_kepler": monopole_observables,
    "n_particles": particles_observables,
    "rocking_disk": disk_observables,
    "heavy_top_lagrange": lagrange_observables,
    "heavy_top_kovalevskaya": kovalevskaya_observables,
    "heavy_top_goryachev_chaplygin": goryachev_chaplygin_observables,
    "kirchhoff_clebsch": clebsch_observables,
    "complex_rigid_body": complex_body_observables,
    "pt_rigid_body": pt_body_observables,
    **{name: spd_observables(n) for name, n in SPD.items()},
    **dict.fromkeys(BODIES, so_n_observables),
    **dict.fromkeys(LAX_BODIES, manakov_observables),
    **dict.fromkeys(QUADRATIC_BODIES, quadratic_observables),
    **{name: bloch_iserles_observables(n) for name, n in BLOCH_ISERLES.items()},
    **classical.OBSERVABLES,
    **driven.OBSERVABLES,
    **extremals.OBSERVABLES,
    **fields.OBSERVABLES,
    **fluids.OBSERVABLES,
    **machines.OBSERVABLES,
    **rods.OBSERVABLES,
    **{name: partial(ball_observables, name) for name in BALLS},
    **{name: partial(body_observables, name) for name in ROLLING},
    "tippe_top": tippe_observables,
}
#: Brackets by the state; that of the pendulum on a cylinder knows the parameters too.
TENSORS: dict[str, Callable[[Vector, Vector], list[list[Any]]]] = {
    "rigid_body": lambda x, p: rigid_body_tensor(x),
    "rigid_body_attitude": lambda x, p: rigid_body_attitude_tensor(x),
    "heavy_top": lambda x, p: se3_tensor(x),
    "kirchhoff": lambda x, p: se3_tensor(x),
    **dict.fromkeys((*TOPS, "kirchhoff_clebsch"), lambda x, p: se3_tensor(x)),
    "complex_rigid_body": lambda x, p: complex_body_tensor(x),
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
    "coupled_bodies": lambda x, p: coupled_tensor(x),
    "underwater_vehicle": lambda x, p: vehicle_tensor(x),
    "kepler": lambda x, p: paired([1] * 3),
    "monopole_kepler": monopole_tensor,
    "n_particles": particles_tensor,
    "rocking_disk": disk_tensor,
    "spd_motion": lambda x, p: spd_tensor(2),
    "spd_motion_3": lambda x, p: spd_tensor(3),
    **dict.fromkeys((*BODIES, *LAX_BODIES), lambda x, p: minus_bracket(so_n_ad_star(len(p)), x)),
    **dict.fromkeys(QUADRATIC_BODIES, lambda x, p: minus_bracket(quadratic_ad_star(len(p)), x)),
    "bloch_iserles_2": lambda x, p: minus_bracket(bloch_iserles_ad_star(2, p), x),
    "bloch_iserles_3": lambda x, p: minus_bracket(bloch_iserles_ad_star(3, p), x),
    **classical.TENSORS,
    **driven.TENSORS,
    **extremals.TENSORS,
    **fields.TENSORS,
    **fluids.TENSORS,
    **machines.TENSORS,
    **rods.TENSORS,
    **{name: partial(ball_tensor, name) for name in BALLS},
    **{name: partial(body_tensor, name) for name in ROLLING},
}
GALILEI = (*numbered("J", 3), *numbered("K", 3), *numbered("P", 3), "E")
STATES = {
    "rigid_body": numbered("Pi", 3),
    "rigid_body_attitude": ("q0", "q1", "q2", "q3", *numbered("Pi", 3)),
    "heavy_top": (*numbered("Pi", 3), *numbered("Gamma", 3)),
    "kirchhoff": (*numbered("Pi", 3), *numbered("P", 3)),
    "kirchhoff_clebsch": (*numbered("Pi", 3), *numbered("P", 3)),
    **dict.fromkeys(TOPS, (*numbered("Pi", 3), *numbered("Gamma", 3))),
    "complex_rigid_body": (*numbered("x", 3), *numbered("y", 3)),
    "pt_rigid_body": numbered("x", 3),
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
    "coupled_bodies": (*numbered("Pi1_", 3), *numbered("Pi2_", 3), *square("A", 3)),
    "underwater_vehicle": (*numbered("Pi", 3), *numbered("P", 3), *numbered("Gamma", 3)),
    "kepler": (*numbered("r", 3), *numbered("v", 3)),
    "monopole_kepler": (*numbered("r", 3), *numbered("v", 3)),
    "n_particles": (*square("r", 3), *square("v", 3)),
    "rocking_disk": ("phi", "phidot"),
    **{
        name: (*kept("S", n), *kept("P", n), *numbered("q", n), *numbered("p", n))
        for name, n in SPD.items()
    },
    **{name: upper("M", n) for name, n in (BODIES | LAX_BODIES).items()},
    **{name: (*upper("M", n), *kept("S", n)) for name, n in QUADRATIC_BODIES.items()},
    **{name: kept("X", n) for name, n in BLOCH_ISERLES.items()},
    **classical.STATES,
    **driven.STATES,
    **extremals.STATES,
    **fields.STATES,
    **fluids.STATES,
    **machines.STATES,
    **rods.STATES,
    **dict.fromkeys((*BALLS, *ROLLING), (*numbered("Omega", 3), *numbered("Gamma", 3))),
    "tippe_top": (*numbered("Omega", 3), *numbered("Y", 3), *numbered("Gamma", 3)),
}
INERTIAS = (*numbered("I", 3), *numbered("A", 3), *numbered("B", 3), "c")
PARAMETERS = {
    "rigid_body": numbered("I", 3),
    "rigid_body_attitude": numbered("I", 3),
    "heavy_top": (*numbered("I", 3), "m", "g", *numbered("chi", 3)),
    "kirchhoff": (*numbered("I", 3), *numbered("M", 3), *numbered("D", 3)),
    "kirchhoff_clebsch": (*numbered("I", 3), "M", "theta"),
    **dict.fromkeys(TOPS, ("I3", "m", "g", "chi")),
    "heavy_top_lagrange": ("I1", "I3", "m", "g", "chi"),
    "complex_rigid_body": numbered("K", 3),
    "pt_rigid_body": numbered("K", 3),
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
    "coupled_bodies": (
        *(name for block in ("I1_", "I2_", "d1_", "d2_") for name in numbered(block, 3)),
        "epsilon",
    ),
    "underwater_vehicle": (*numbered("I", 3), *numbered("M", 3), "m", "g", *numbered("chi", 3)),
    "kepler": ("mu",),
    "monopole_kepler": ("mu", "lam"),
    "n_particles": (*numbered("m", 3), "G"),
    "rocking_disk": ("m", "r", "l", "I", "g"),
    **dict.fromkeys(SPD, ()),
    **{name: numbered("a", n) for name, n in (BODIES | LAX_BODIES | QUADRATIC_BODIES).items()},
    **{name: upper("N", n) for name, n in BLOCH_ISERLES.items()},
    **classical.PARAMETERS,
    **driven.PARAMETERS,
    **extremals.PARAMETERS,
    **fields.PARAMETERS,
    **fluids.PARAMETERS,
    **machines.PARAMETERS,
    **rods.PARAMETERS,
    "chaplygin_ball": (*numbered("I", 3), "m", "r", "g", *numbered("chi", 3)),
    "chaplygin_ball_centred": (*numbered("I", 3), "m", "r"),
    "routh_sphere": ("I1", "I3", "m", "r", "g", "l"),
    **dict.fromkeys(("rolling_disk", "euler_disk"), ("I1", "I3", "m", "r", "g")),
    "rolling_ellipsoid": (*kept("I", 3), "m", "g", *numbered("axes", 3)),
    "rattleback": (*numbered("I", 3), "skew", "m", "g", *numbered("axes", 3)),
    "tippe_top": ("I1", "I3", "m", "r", "g", "e", "viscous", "coulomb", "slow"),
    "body_of_revolution": ("I1", "I3", "m", "g", "A", "C", "l"),
}
DRIVING = driven.DRIVING
#: What the formulas take beside the state: parameters, inputs and time.
GIVEN = {name: (*own, *DRIVING.get(name, ())) for name, own in PARAMETERS.items()}
