r"""Group actions: Newton's second law through quaternions, for Kepler's problem and the monopole.

Comes in: a force per mass as a function of position and velocity. Goes out: the motion as a vector
field on (r, v), the alignment quaternion ``[alpha, chi]`` with

.. math:: \alpha = r\cdot v/r^2,\quad \chi = r\times v/r^2,\qquad \dot q + q^2 = [\beta, \psi],

and the conserved vectors of the two problems, units of mass one.
Read next: `coadjoint.groups.galilean`.

Source:
    Holm (2011), Geometric Mechanics II, sections 3.1.4 and 3.1.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Vector, add, cross, dot, scale, subtract
from coadjoint.groups.quaternions import Quaternion
from coadjoint.groups.vector_fields import VectorField

POSITION = ("r1", "r2", "r3")
VELOCITY = ("v1", "v2", "v3")


@dataclass(frozen=True)
class PointMotion:
    """Positions, velocities and two strengths, in a field that knows the distance.

    Attributes:
        field: Where everything lives.
        r: Position, three elements; length.
        v: Velocity, three elements.
        distance: ``|r|``, with square r . r.
    """

    field: Field
    r: Vector
    v: Vector
    distance: Element

    def under(self, force: Sequence[Element]) -> VectorField:
        """``dr/dt = v, dv/dt = F(r, v)`` for a force per mass."""
        return VectorField(self.field, POSITION + VELOCITY, (*self.v, *force))

    @property
    def angular_momentum(self) -> Vector:
        """``L = r x v``."""
        return cross(self.r, self.v)

    @property
    def direction(self) -> Vector:
        """``r / |r|``."""
        return scale(1 / self.distance, self.r)


def point_motion(parameters: Sequence[str] = ("mu", "lam")) -> PointMotion:
    """A point in R^3 and named constants: ``mu`` attracts, ``lam`` is the monopole's strength."""
    field = Field([*POSITION, *VELOCITY, *parameters], slots=1)
    r, v = (tuple(field[name] for name in names) for names in (POSITION, VELOCITY))
    return PointMotion(field, r, v, field.call("sqrt", dot(r, r)))


# -- alignment ------------------------------------------------------------------------------------


def alignment(r: Sequence[Element], w: Sequence[Element]) -> Quaternion:
    """``[r . w, r x w] / r^2``: ``[alpha, chi]`` for w = v and ``[beta, psi]`` for w = F."""
    return Quaternion(dot(r, w), *cross(r, w)).scale(1 / dot(r, r))


def alignment_defect(motion: PointMotion, force: Sequence[Element]) -> Quaternion:
    """``dq/dt + q^2 - [beta, psi]``, which is 0 for every force (equation 3.1.33)."""
    q = alignment(motion.r, motion.v)
    rate = Quaternion(*motion.under(force).rates(q.components))
    return rate + q * q - alignment(motion.r, force)


# -- Kepler ---------------------------------------------------------------------------------------


def kepler_force(motion: PointMotion) -> Vector:
    """``-mu r / |r|^3``."""
    return scale(-motion.field["mu"] / motion.distance**3, motion.r)


def kepler_energy(motion: PointMotion) -> Element:
    """``E = v^2/2 - mu/|r|``."""
    kinetic: Element = dot(motion.v, motion.v) / 2
    return kinetic - motion.field["mu"] / motion.distance


def laplace_runge_lenz(motion: PointMotion) -> Vector:
    """``A = v x L - mu r/|r|``; the orbit is ``|r| = (L^2/mu) / (1 + e cos theta)``, e = |A|/mu."""
    centrifugal = cross(motion.v, motion.angular_momentum)
    return subtract(centrifugal, scale(motion.field["mu"], motion.direction))


def hamilton_vector(motion: PointMotion) -> Vector:
    """``K = v - (mu/L^2) L x r/|r|``, with ``A = K x L``; undefined on straight lines, L = 0."""
    L = motion.angular_momentum
    pull = scale(motion.field["mu"] / dot(L, L), cross(L, motion.direction))
    return subtract(motion.v, pull)


# -- the monopole ---------------------------------------------------------------------------------


def monopole_force(motion: PointMotion) -> Vector:
    """``-(lam/|r|^3) L - (mu/|r|^3 - lam^2/|r|^4) r`` (equation 3.1.39)."""
    lam, mu, d = motion.field["lam"], motion.field["mu"], motion.distance
    magnetic = scale(-lam / d**3, motion.angular_momentum)
    return add(magnetic, scale(lam**2 / d**4 - mu / d**3, motion.r))


def monopole_energy(motion: PointMotion) -> Element:
    """``E = v^2/2 - mu/|r| + lam^2/(2 r^2)``."""
    return kepler_energy(motion) + motion.field["lam"] ** 2 / (2 * motion.distance**2)


def poincare_vector(motion: PointMotion) -> Vector:
    """``P = L - lam r/|r|``; ``P . r/|r| = -lam``, so the motion stays on a cone."""
    return subtract(motion.angular_momentum, scale(motion.field["lam"], motion.direction))


def monopole_laplace_runge_lenz(motion: PointMotion) -> Vector:
    """``A = v x P - mu r/|r|``."""
    centrifugal = cross(motion.v, poincare_vector(motion))
    return subtract(centrifugal, scale(motion.field["mu"], motion.direction))


def magnetic_vector_field(motion: PointMotion, energy: Element) -> VectorField:
    """The motion of an energy under ``{r_i, v_j} = delta_ij, {v_i, v_j} = lam eps_ijk r_k/|r|^3``.

    ``dr/dt = E_v`` and ``dv/dt = -E_r + (lam/|r|^3) E_v x r``.
    """
    field = motion.field
    E_r, E_v = (field.gradient(energy, names) for names in (POSITION, VELOCITY))
    magnetic = scale(field["lam"] / motion.distance**3, cross(E_v, motion.r))
    return VectorField(field, POSITION + VELOCITY, (*E_v, *subtract(magnetic, E_r)))
