"""The tippe top typed by hand: Newton and Euler's equations of a ball that slides on a plane.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system. The normal force N comes from
the vertical acceleration of the contact at N = 0 and at N = 1, where the engine eliminates.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tests.sources.components import Vector, cross, dot, plus, times
from tests.sources.points import length, named


@dataclass(frozen=True)
class TippeTop:
    """A top that slides (Or 1994; Bou-Rabee, Marsden and Romero 2004), in body axes.

    ``m (dY/dt + Omega x Y) = F - m g Gamma``, ``I dOmega/dt = I Omega x Omega - s x F`` with
    ``F = N (Gamma - k v)``, ``k = viscous + coulomb/sqrt(v . v + slow^2)``, ``v = Y - Omega x s``.
    """

    Omega: Vector
    Y: Vector
    Gamma: Vector
    inertia: Vector
    m: Any
    r: Any
    g: Any
    e: Any
    viscous: Any
    coulomb: Any
    slow: Any

    @property
    def s(self) -> list[Any]:
        """From the point of contact to the centre of mass, which lies below the middle."""
        return plus(times(self.r, self.Gamma), [0, 0, -self.e])

    @property
    def v(self) -> list[Any]:
        """Velocity of the body's point at the contact."""
        return plus(self.Y, times(-1, cross(self.Omega, self.s)))

    @property
    def friction(self) -> list[Any]:
        """Over the normal force."""
        v = self.v
        k = self.viscous + self.coulomb / length(dot(v, v) + self.slow**2)
        return times(-k, v)

    def accelerations(self, N: Any) -> tuple[list[Any], list[Any]]:
        """``dOmega/dt`` and ``dY/dt`` where the plane presses with N."""
        F = times(N, plus(self.Gamma, self.friction))
        spun = [i * w for i, w in zip(self.inertia, self.Omega, strict=True)]
        torque = plus(cross(spun, self.Omega), times(-1, cross(self.s, F)))
        weight = times(-self.g, self.Gamma)
        moved = plus(plus(times(1 / self.m, F), weight), times(-1, cross(self.Omega, self.Y)))
        return [t / i for t, i in zip(torque, self.inertia, strict=True)], moved

    def lift(self, N: Any) -> Any:
        """``d(Gamma . v)/dt``: how the point of contact is accelerated off the plane."""
        turned, moved = self.accelerations(N)
        Gamma_rate = cross(self.Gamma, self.Omega)
        carried = plus(cross(turned, self.s), cross(self.Omega, times(self.r, Gamma_rate)))
        return dot(Gamma_rate, self.v) + dot(self.Gamma, plus(moved, times(-1, carried)))

    @property
    def N(self) -> Any:
        """The normal force, with which the contact stays on the plane: the lift is linear in it."""
        free = self.lift(0)
        return -free / (self.lift(1) - free)


def tippe_top(state: Vector, parameters: Vector) -> TippeTop:
    """The top from its components."""
    I1, I3, m, r, g, e, viscous, coulomb, slow = parameters
    return TippeTop(
        Omega=state[:3],
        Y=state[3:6],
        Gamma=state[6:],
        inertia=[I1, I1, I3],
        m=m,
        r=r,
        g=g,
        e=e,
        viscous=viscous,
        coulomb=coulomb,
        slow=slow,
    )


def tippe_rates(state: Vector, parameters: Vector) -> list[Any]:
    """Accelerations, and ``dGamma/dt = Gamma x Omega``."""
    top = tippe_top(state, parameters)
    turned, moved = top.accelerations(top.N)
    return [*turned, *moved, *cross(top.Gamma, top.Omega)]


def tippe_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, Jellett's integral, momenta, slip and forces."""
    top = tippe_top(state, parameters)
    spun = [i * w for i, w in zip(top.inertia, top.Omega, strict=True)]
    kinetic = (dot(spun, top.Omega) + top.m * dot(top.Y, top.Y)) / 2
    return {
        # the height of the centre of mass is r - e Gamma3
        "energy": kinetic - top.m * top.g * top.e * top.Gamma[2],
        "jellett": dot(spun, top.s),
        "plane_reaction": top.N - top.m * top.g,
        "normal_force": top.N,
        **named("friction", times(top.N, top.friction)),
        **named("slip", top.v),
        **named("Omega_momentum", spun),
        **named("Y_momentum", times(top.m, top.Y)),
    }
