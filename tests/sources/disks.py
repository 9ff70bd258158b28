"""Disks and other bodies that roll on a plane: motions typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system. The accelerations come from
the balance of momentum by Cramer's rule, where the engine eliminates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tests.sources.components import Vector, cross, dot, hat, plus, times
from tests.sources.points import length, named

UNITS = ([1, 0, 0], [0, 1, 0], [0, 0, 1])
Matrix = Sequence[Vector]


@dataclass(frozen=True)
class Shape:
    """The surface of a body as it rests on the plane with a given vertical.

    Attributes:
        arm: s, from the point of contact to the centre of mass.
        slopes: ds/dGamma1, ds/dGamma2, ds/dGamma3.
        height: Of the centre of mass.
        lift: The slope of the height by Gamma.
    """

    arm: Vector
    slopes: Matrix
    height: Any
    lift: Vector


@dataclass(frozen=True)
class Body:
    """A rolling body and its motion: the inertia is that about the centre of mass."""

    Omega: Vector
    Gamma: Vector
    inertia: Matrix
    m: Any
    g: Any
    shape: Shape

    @property
    def s(self) -> Vector:
        """From the point of contact to the centre of mass."""
        return self.shape.arm

    def moved(self, turning: Vector) -> list[Any]:
        """ds/dt where Gamma has the rate Gamma x turning."""
        found: list[Any] = [0, 0, 0]
        rates = cross(self.Gamma, turning)
        for rate, slope in zip(rates, self.shape.slopes, strict=True):
            found = plus(found, times(rate, slope))
        return found

    def momentum(self, Omega: Vector) -> list[Any]:
        """``I Omega + m s x (Omega x s)``."""
        inner = [dot(row, Omega) for row in self.inertia]
        return plus(inner, times(self.m, cross(self.s, cross(Omega, self.s))))

    @property
    def Y(self) -> list[Any]:
        """Velocity of the centre of mass: the point of contact is at rest."""
        return cross(self.Omega, self.s)

    @property
    def M_rate(self) -> list[Any]:
        """``M x Omega + m ds/dt x (Omega x s) + dV/dGamma`` turned, (Holm 2011, section 12.2.3).

        The weight turns by ``-dV/dGamma x Gamma``, which is ``m g Gamma x s`` where |Gamma| = 1.
        """
        gained = times(self.m, cross(self.moved(self.Omega), self.Y))
        weight = times(-self.m * self.g, cross(self.shape.lift, self.Gamma))
        return plus(cross(self.momentum(self.Omega), self.Omega), plus(gained, weight))

    @property
    def Omega_rate(self) -> list[Any]:
        """From ``dM/dt``, less what M changes by ds/dt, by Cramer's rule."""
        ds = self.moved(self.Omega)
        carried = plus(cross(ds, self.Y), cross(self.s, cross(self.Omega, ds)))
        k = plus(self.M_rate, times(-self.m, carried))
        rows = [self.momentum(unit) for unit in UNITS]  # symmetric
        minors = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])]
        whole = dot(rows[0], minors[0])
        return [dot(k, column) / whole for column in zip(*minors, strict=True)]

    @property
    def push(self) -> list[Any]:
        """``m (dY/dt + Omega x Y)``: the force of the plane and the weight."""
        rate = plus(cross(self.Omega_rate, self.s), cross(self.Omega, self.moved(self.Omega)))
        return times(self.m, plus(rate, cross(self.Omega, self.Y)))

    @property
    def energy(self) -> Any:
        """``Omega . M/2 + m g height``."""
        kinetic = dot(self.Omega, self.momentum(self.Omega)) / 2
        return kinetic + self.m * self.g * self.shape.height


def disk_shape(Gamma: Vector, r: Any) -> Shape:
    """``s = r e`` with e the horizontal part of Gamma made a unit vector."""
    sine = length(Gamma[0] ** 2 + Gamma[1] ** 2)
    c, d = Gamma[0] / sine, Gamma[1] / sine
    around = [times(-r * d / sine, [-d, c, 0]), times(r * c / sine, [-d, c, 0]), [0, 0, 0]]
    return Shape([r * c, r * d, 0], around, r * sine, [r * c, r * d, 0])


def ellipsoid_shape(Gamma: Vector, axes: Vector) -> Shape:
    """``s = dh/dGamma`` of the support function ``h = |diag(a) Gamma|``."""
    bent = [a**2 * x for a, x in zip(axes, Gamma, strict=True)]
    h = length(dot(bent, Gamma))
    s = [b / h for b in bent]
    slopes = [
        plus(times(a**2 / h, unit), times(-s[n] / h, s))
        for n, (a, unit) in enumerate(zip(axes, UNITS, strict=True))
    ]
    return Shape(s, slopes, h, s)


def egg_shape(Gamma: Vector, A: Any, C: Any, offset: Any) -> Shape:
    """``s = u Gamma + v e3`` with ``u = A^2/h``, ``v = (C^2 - A^2) z/h + l``, ``h h' = c z``."""
    z, c = Gamma[2], C**2 - A**2
    h = length(A**2 + c * z**2)
    u, v = A**2 / h, c * z / h + offset
    du, dv = -(A**2) * c * z / h**3, c * A**2 / h**3
    slopes = [[u, 0, 0], [0, u, 0], plus(times(du, Gamma), [0, 0, u + dv])]
    return Shape(plus(times(u, Gamma), [0, 0, v]), slopes, u + z * v, [0, 0, v])


def diagonal(*entries: Any) -> Matrix:
    """A diagonal inertia."""
    return [times(entry, unit) for entry, unit in zip(entries, UNITS, strict=True)]


def disk(state: Vector, parameters: Vector) -> Body:
    """A thin disk: Holm (2011), section 12.2.3."""
    I1, I3, m, r, g = parameters
    shape = disk_shape(state[3:], r)
    return Body(state[:3], state[3:], diagonal(I1, I1, I3), m, g, shape)


def ellipsoid(state: Vector, parameters: Vector) -> Body:
    """An ellipsoid with its centre of mass in the middle."""
    a, b, c, d, e, f, m, g, *axes = parameters
    inertia = [[a, b, c], [b, d, e], [c, e, f]]
    return Body(state[:3], state[3:], inertia, m, g, ellipsoid_shape(state[3:], axes))


def rattleback(state: Vector, parameters: Vector) -> Body:
    """The same with a product of inertia between the first two axes of the surface."""
    A, B, C, skew, m, g, *axes = parameters
    inertia = [[A, skew, 0], [skew, B, 0], [0, 0, C]]
    return Body(state[:3], state[3:], inertia, m, g, ellipsoid_shape(state[3:], axes))


def egg(state: Vector, parameters: Vector) -> Body:
    """A spheroid with its centre of mass on the axis."""
    I1, I3, m, g, A, C, offset = parameters
    shape = egg_shape(state[3:], A, C, offset)
    return Body(state[:3], state[3:], diagonal(I1, I1, I3), m, g, shape)


ROLLING: dict[str, Callable[[Vector, Vector], Body]] = {
    "rolling_disk": disk,
    "euler_disk": disk,
    "rolling_ellipsoid": ellipsoid,
    "rattleback": rattleback,
    "body_of_revolution": egg,
}


def body_rates(name: str, state: Vector, parameters: Vector) -> list[Any]:
    """``dOmega/dt`` and ``dGamma/dt = Gamma x Omega``."""
    body = ROLLING[name](state, parameters)
    return [*body.Omega_rate, *cross(body.Gamma, body.Omega)]


def body_tensor(name: str, state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{M_i, M_j} = hat(M)_ij + m ((D_j s x Y)_i - (D_i s x Y)_j)``, D_i Gamma = Gamma x e_i.

    With ``dE/dM = Omega`` and ``-dE/dGamma = m (ds/dGamma)^T (Y x Omega) - dV/dGamma`` it gives
    dM/dt: the second part there is ``-m Omega_j (D_i s x Y)_j``, which the first one cancels.
    """
    body = ROLLING[name](state, parameters)
    turned = [times(body.m, cross(body.moved(unit), body.Y)) for unit in UNITS]
    free = hat(body.momentum(body.Omega))
    top = [
        [free[i][j] + turned[j][i] - turned[i][j] for j in range(3)] + hat(body.Gamma)[i]
        for i in range(3)
    ]
    return [*top, *([*row, 0, 0, 0] for row in hat(body.Gamma))]


def body_observables(name: str, state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, momenta, velocity and forces of every body, and what each has of its own."""
    body = ROLLING[name](state, parameters)
    Omega, Gamma, M, push = body.Omega, body.Gamma, body.momentum(body.Omega), body.push
    found = {
        "energy": body.energy,
        **named("Y", body.Y),
        **named("rolling_reaction", push),
        **named("Omega_momentum", M),
        "height": body.shape.height,
        "normal_force": dot(push, Gamma) + body.m * body.g,
    }
    if name in ("rolling_ellipsoid", "rattleback"):
        return found | {"spin": dot(Omega, Gamma)}
    found |= {"L_axis": M[2], "L_vertical": dot(M, Gamma)}
    if name != "body_of_revolution":
        sine = length(Gamma[0] ** 2 + Gamma[1] ** 2)
        found["p"] = (Gamma[0] * Omega[0] + Gamma[1] * Omega[1]) / sine
        found["theta_rate"] = (Gamma[1] * Omega[0] - Gamma[0] * Omega[1]) / sine
    return found
