"""Group actions: the two stereographic charts of the unit sphere, and spherical coordinates.

Comes in: points of S^2 or of the plane of complex numbers. Goes out: the other, velocities carried
along by the tangent lift, and differentials in angles by the cotangent lift.
Read next: `coadjoint.groups.vector_fields`.

Source:
    Holm (2011), Geometric Mechanics II, appendix A.1 (example A.1.2) and A.2.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Vector
from coadjoint.groups.complex_numbers import Complex
from coadjoint.groups.vector_fields import cotangent_lift
from coadjoint.theory.vector_fields import tangent_lift

Chart = Callable[[Sequence[Any]], Complex]


def north_chart(point: Sequence[Any]) -> Complex:
    """``zeta_N = (x + i y) / (1 - z)``, seen from the north pole, which it leaves out.

    >>> str(north_chart((1, 0, 0)))
    '1 + 0 i'
    """
    x, y, z = point
    return Complex(x, y) / Complex(1 - z)


def south_chart(point: Sequence[Any]) -> Complex:
    """``zeta_S = (x - i y) / (1 + z)``; where both exist, ``zeta_S zeta_N = 1``."""
    x, y, z = point
    return Complex(x, -y) / Complex(1 + z)


def north_point(zeta: Complex) -> Vector:
    """The point of the sphere with ``zeta_N = zeta``."""
    below = zeta.norm + 1
    return (2 * zeta.re / below, 2 * zeta.im / below, (zeta.norm - 1) / below)


def south_point(zeta: Complex) -> Vector:
    """The point of the sphere with ``zeta_S = zeta``."""
    x, y, z = north_point(zeta)
    return (x, -y, -z)


def chart_velocity(
    field: Field, chart: Chart, names: Sequence[str], velocity: Sequence[Any]
) -> Complex:
    """``d zeta/dt``, the tangent lift of a chart at the point whose coordinates are ``names``."""
    zeta = chart([field[name] for name in names])
    return Complex(*tangent_lift(field, (zeta.re, zeta.im), names, velocity))


def spherical_point(field: Field, theta: str, phi: str) -> Vector:
    """``(sin theta cos phi, sin theta sin phi, cos theta)``; takes two slots of the field."""
    polar, azimuth = field[theta], field[phi]
    around = field.call("sin", polar)
    return (
        around * field.call("cos", azimuth),
        around * field.call("sin", azimuth),
        field.call("cos", polar),
    )


def spherical_differential(
    field: Field, gradient: Sequence[Element], theta: str, phi: str
) -> Vector:
    """``(df/dtheta, df/dphi)`` on the sphere, of a function whose gradient in R^3 is given."""
    return cotangent_lift(field, spherical_point(field, theta, phi), (theta, phi), gradient)
