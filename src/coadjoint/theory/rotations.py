"""Group actions: rotations by quaternions, their parameters and their kinematics.

Comes in: a quaternion or a curve of them. Goes out: its action on three-vectors (Euler-Rodrigues),
the adjoint and coadjoint actions, and the body angular velocity. The rotation of a quaternion is
that of the unit quaternion on its ray, so identities proved here need no side condition.
Read next: `coadjoint.theory.hopf`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Vector, scale
from coadjoint.groups.quaternions import Hypercomplex, Quaternion
from coadjoint.theory.maps import HALF

Either = TypeVar("Either", bound=Hypercomplex)


def unit_quaternion(p: Either) -> Either:
    """``p (p*)^-1``, of norm 1: rational, and onto all units but -1 as ``p = [1, a]``.

    >>> str(unit_quaternion(Quaternion(1, 1, 0, 0)))
    '[0; 1, 0, 0]'
    """
    return p * p.conjugate.inverse()


# -- the action on three-vectors ------------------------------------------------------------------


def parallel_and_perpendicular(v: Sequence[Any], axis: Sequence[Any]) -> tuple[Vector, Vector]:
    """The parts of v along and across a unit axis: ``(v -+ n v n) / 2`` (section 3.1.3)."""
    n, whole = Quaternion.pure(axis), Quaternion.pure(v)
    mirrored = n * whole * n
    return scale(HALF, (whole - mirrored).vector), scale(HALF, (whole + mirrored).vector)


def cayley_klein(field: Field, angle: Element, axis: Sequence[Any]) -> Quaternion:
    """``[cos(angle/2), sin(angle/2) n]``, which turns by ``angle`` about the unit vector n.

    Its Pauli matrix is ``exp(-i angle n . sigma / 2)``. Sine and cosine take one slot of the field.

    Source:
        Holm (2011), Geometric Mechanics II, section 3.2.1.
    """
    cosine, sine = (field.call(function, angle / 2) for function in ("cos", "sin"))
    return Quaternion(cosine, *scale(sine, axis))


# -- adjoint and coadjoint actions ----------------------------------------------------------------


def AD(q: Either, r: Either) -> Either:
    """Conjugation ``q r q^-1`` (section 4.2.1); `Ad` is the same on imaginary ones."""
    return q * r * q.inverse()


def Ad_star(q: Either, mu: Either) -> Either:
    """``q^-1 mu q``: ``<Ad*_q mu, xi> = <mu, Ad_q xi>`` under ``<mu, xi> = mu . xi``."""
    return q.inverse() * mu * q


def ad(xi: Either, eta: Either) -> Either:
    """``xi eta - eta xi``, that is ``2 xi x eta`` for quaternions (the basis i, j, k)."""
    return xi * eta - eta * xi


def ad_star(xi: Quaternion, mu: Quaternion) -> Quaternion:
    """``mu xi - xi mu``, that is ``-2 xi x mu``: ``<ad*_xi mu, eta> = <mu, ad_xi eta>``."""
    return mu * xi - xi * mu


# -- kinematics -----------------------------------------------------------------------------------


def quaternion_rate(q: Quaternion, Omega: Sequence[Any]) -> Quaternion:
    """``dq/dt = q [0, Omega] / 2`` for the body angular velocity Omega; it keeps the norm."""
    return (q * Quaternion.pure(Omega)).scale(HALF)


def body_angular_velocity(q: Quaternion, q_dot: Quaternion) -> Vector:
    """``Omega = 2 Im(q^-1 dq/dt)``, which is 2 Im(q* dq/dt) on units (section 4.1)."""
    return scale(2, (q.inverse() * q_dot).vector)
