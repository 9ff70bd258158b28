"""Balls that roll without slipping: motions typed by hand, for comparison with ours.

Each function takes the components of state and parameters as flat sequences and returns a flat
list, or values by name. `tests.sources.textbook` has them by system. The accelerations come from
the balance of momentum by the formula of Sherman and Morrison, where the engine eliminates.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tests.sources.components import Vector, cross, dot, hat, over, plus, times


class Ball(NamedTuple):
    """A ball and its motion: I about the centre of mass, chi from the centre to that."""

    Omega: Vector
    Gamma: Vector
    inertia: Vector
    m: Any
    r: Any
    g: Any
    chi: Vector

    @property
    def s(self) -> list[Any]:
        """From the point of contact to the centre of mass."""
        return plus(times(self.r, self.Gamma), self.chi)

    @property
    def Y(self) -> list[Any]:
        """Velocity of the centre of mass: the point of contact is at rest."""
        return cross(self.Omega, self.s)

    @property
    def M(self) -> list[Any]:
        """Angular momentum about the point of contact, I Omega + m s x (Omega x s)."""
        spun = [a * b for a, b in zip(self.inertia, self.Omega, strict=True)]
        return plus(spun, times(self.m, cross(self.s, self.Y)))

    @property
    def turning(self) -> list[Any]:
        """``dGamma/dt = Gamma x Omega``."""
        return cross(self.Gamma, self.Omega)

    @property
    def torque(self) -> list[Any]:
        """``m g Gamma x chi`` (Holm 2011, 12.1.2)."""
        return times(self.m * self.g, cross(self.Gamma, self.chi))

    @property
    def M_rate(self) -> list[Any]:
        """``dM/dt = M x Omega + m ds/dt x (Omega x s) + m g Gamma x chi`` (Holm 2011, 12.2.1)."""
        gained = times(self.m, cross(times(self.r, self.turning), self.Y))
        return plus(cross(self.M, self.Omega), plus(gained, self.torque))

    @property
    def Omega_rate(self) -> list[Any]:
        """The acceleration w: ``(D - m s s^T) w = dM/dt - m d(s x (Omega x s))/dt`` at fixed Omega.

        D = I + m s^2, so that ``w = D^-1 k + D^-1 s m (s . D^-1 k)/(1 - m s . D^-1 s)``.
        """
        moved = times(self.r, self.turning)
        carried = plus(cross(moved, self.Y), cross(self.s, cross(self.Omega, moved)))
        k = plus(self.M_rate, times(-self.m, carried))
        D = [i + self.m * dot(self.s, self.s) for i in self.inertia]
        first, along = over(k, D), over(self.s, D)
        share = self.m * dot(self.s, first) / (1 - self.m * dot(self.s, along))
        return plus(first, times(share, along))

    @property
    def push(self) -> list[Any]:
        """``m (dY/dt + Omega x Y)``: the force of the plane and the weight."""
        moved = cross(self.Omega, times(self.r, self.turning))
        rate = plus(cross(self.Omega_rate, self.s), moved)
        return times(self.m, plus(rate, cross(self.Omega, self.Y)))

    @property
    def energy(self) -> Any:
        """``Omega . I Omega/2 + m Y . Y/2 + m g Gamma . chi``."""
        spun = [a * b for a, b in zip(self.inertia, self.Omega, strict=True)]
        moving = (dot(self.Omega, spun) + self.m * dot(self.Y, self.Y)) / 2
        return moving + self.m * self.g * dot(self.Gamma, self.chi)


def general(state: Vector, parameters: Vector) -> Ball:
    """The centre of mass anywhere."""
    *inertia, m, r, g, chi1, chi2, chi3 = parameters
    return Ball(state[:3], state[3:], inertia, m, r, g, [chi1, chi2, chi3])


def centred(state: Vector, parameters: Vector) -> Ball:
    """The centre of mass at the centre, where weight does not turn."""
    *inertia, m, r = parameters
    return Ball(state[:3], state[3:], inertia, m, r, 0, [0, 0, 0])


def axisymmetric(state: Vector, parameters: Vector) -> Ball:
    """The centre of mass on an axis of symmetry."""
    I1, I3, m, r, g, offset = parameters
    return Ball(state[:3], state[3:], [I1, I1, I3], m, r, g, [0, 0, offset])


BALLS = {
    "chaplygin_ball": general,
    "chaplygin_ball_centred": centred,
    "routh_sphere": axisymmetric,
}


def ball_rates(name: str, state: Vector, parameters: Vector) -> list[Any]:
    """``dOmega/dt`` and ``dGamma/dt``."""
    ball = BALLS[name](state, parameters)
    return [*ball.Omega_rate, *ball.turning]


def ball_tensor(name: str, state: Vector, parameters: Vector) -> list[list[Any]]:
    """``{M, M} = hat(M + m r Gamma x Y)``, ``{M, Gamma} = {Gamma, M} = hat(Gamma)``.

    It gives dM/dt with ``dE/dM = Omega`` and ``-dE/dGamma = m r Y x Omega - m g chi``: for
    ``(Gamma x Omega) x Y + Gamma x (Y x Omega) = (Gamma x Y) x Omega``.
    """
    ball = BALLS[name](state, parameters)
    turned = times(ball.m * ball.r, cross(ball.Gamma, ball.Y))
    rows = zip(hat(plus(ball.M, turned)), hat(ball.Gamma), strict=True)
    return [*([*a, *b] for a, b in rows), *([*row, 0, 0, 0] for row in hat(ball.Gamma))]


def ball_observables(name: str, state: Vector, parameters: Vector) -> dict[str, Any]:
    """Energy, velocity and force of every ball, and what each has of its own."""
    ball = BALLS[name](state, parameters)
    found = {
        "energy": ball.energy,
        **_numbered("Y", ball.Y),
        **_numbered("rolling_reaction", ball.push),
        **_numbered("Omega_momentum", ball.M),
    }
    if name == "routh_sphere":
        spun = [a * b for a, b in zip(ball.inertia, ball.s, strict=True)]
        own = parameters[0] * parameters[1] + ball.m * dot(ball.s, spun)
        found |= {"jellett": dot(ball.M, ball.s), "routh": state[2] ** 2 * own}
    else:
        found["vertical"] = dot(ball.M, ball.Gamma)
    if name != "chaplygin_ball_centred":
        weight = ball.m * ball.g
        found |= _numbered("contact", plus(ball.push, times(weight, ball.Gamma)))
        found["normal_force"] = dot(ball.push, ball.Gamma) + weight
    return found


def _numbered(name: str, parts: Vector) -> dict[str, Any]:
    return {f"{name}{n + 1}": part for n, part in enumerate(parts)}
