"""Group actions: smooth maps given by components, their tangent and their cotangent lifts.

Comes in: components of a map as elements in named coordinates. Goes out: Jacobian matrices, and
what the map does to velocities (forward) and to covectors (backward).
Read next: `coadjoint.groups.vector_fields`.

Source:
    Holm (2011), Geometric Mechanics II, appendix A.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, Vector, apply, transpose


def jacobian(field: Field, components: Sequence[Element], names: Sequence[str]) -> Matrix:
    """``Df``: row i holds the partial derivatives of component i."""
    return tuple(field.gradient(component, names) for component in components)


def cotangent_lift(
    field: Field, components: Sequence[Element], names: Sequence[str], covector: Sequence[Any]
) -> Vector:
    """``T*f(alpha) = Df^T alpha``, a covector at x from one at f(x).

    ``<T*f(alpha), v> = <alpha, Tf(v)>`` defines it.
    """
    return apply(transpose(jacobian(field, components, names)), covector)
