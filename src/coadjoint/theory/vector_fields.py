r"""Vector fields: brackets, maps, flows, and what they do to forms.

Comes in: vector fields of `coadjoint.groups.vector_fields`. Goes out: their calculus. Two sign
conventions are in use, and each has its own name:

.. math:: \pounds_X Y = (DY) X - (DX) Y = [X, Y]_{operators}, \qquad [X, Y]_{JL} = (DX) Y - (DY) X

the Lie derivative of theorem B.7.1's proof, and the Jacobi-Lie bracket as section B.6 defines it:
they are opposite, and the statement of B.7.1, which calls them equal, has a misprint.
Read next: `coadjoint.theory.central_forces`.

Source:
    Holm (2011), Geometric Mechanics II, appendices A.2, A.3 and B.5 to B.7.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Vector, add, apply, scale, subtract, trace
from coadjoint.groups.vector_fields import VectorField, cotangent_lift, jacobian, lie_derivative


def jacobi_lie_bracket(X: VectorField, Y: VectorField) -> VectorField:
    """``(DX) Y - (DY) X`` (section B.6), minus the commutator of operators.

    >>> field = Field(["x"])
    >>> X, Y = (VectorField(field, ("x",), (c,)) for c in (field.one, field["x"]))
    >>> jacobi_lie_bracket(X, Y).components
    (-1,)
    """
    return X.like(subtract(apply(X.jacobian(), Y.components), apply(Y.jacobian(), X.components)))


def lie_derivative_of_one_form(X: VectorField, alpha: Sequence[Element]) -> Vector:
    """``(L_X alpha)_i = X(alpha_i) + alpha_j dX_j/dx_i``."""
    turned = cotangent_lift(X.field, X.components, X.names, alpha)
    return add(X.rates(alpha), turned)


def compose(
    field: Field, outer: Sequence[Element], names: Sequence[str], inner: Sequence[Element]
) -> Vector:
    """``f o g``: the components of f in the coordinates ``names``, those replaced by g."""
    values = dict(zip(names, inner, strict=True))
    return tuple(field.substitute(component, values) for component in outer)


def tangent_lift(
    field: Field, components: Sequence[Element], names: Sequence[str], velocity: Sequence[Any]
) -> Vector:
    """``Tf(v) = Df v``, a velocity at f(x).

    >>> field = Field(["x", "v"])
    >>> x, v = field["x"], field["v"]
    >>> tangent_lift(field, [x**2], ["x"], [v]) == (2 * x * v,)
    True
    """
    return apply(jacobian(field, components, names), velocity)


def divergence(X: VectorField) -> Element:
    """``div X``, with which the volume form grows: ``L_X d^n x = div X d^n x``."""
    result: Element = trace(X.jacobian())
    return result


# -- maps and flows -------------------------------------------------------------------------------


def push_forward(phi: Sequence[Element], inverse: Sequence[Element], X: VectorField) -> VectorField:
    """``phi_* X = T phi o X o phi^-1`` (section B.5).

    Args:
        phi: Components of an invertible map in the coordinates of X.
        inverse: Components of its inverse in the same coordinates.
        X: The field to carry along.

    Raises:
        AlgebraError: The two maps are not inverse to each other.
    """
    for first, second in ((phi, inverse), (inverse, phi)):
        _check_inverse(X, first, second)
    return X.like(compose(X.field, X.rates(phi), X.names, inverse))


def pull_back(phi: Sequence[Element], inverse: Sequence[Element], Y: VectorField) -> VectorField:
    """``phi^* Y``, the push-forward by the inverse."""
    return push_forward(inverse, phi, Y)


def _check_inverse(X: VectorField, phi: Sequence[Element], psi: Sequence[Element]) -> None:
    for name, component in zip(X.names, compose(X.field, phi, X.names, psi), strict=True):
        if not X.field.is_zero(component - X.field[name]):
            raise AlgebraError(
                f"the map and its inverse, one after the other, take {name} to {component}; "
                f"expected {name} again.",
                coordinate=name,
                found=str(component),
            )


def lie_series(X: VectorField, function: Element, time: Element, order: int) -> Element:
    """``exp(t X) f = sum of t^k X^k(f) / k!`` up to an order: f along the flow of X.

    Where X^k(f) = 0 for some k the series ends and is exact.

    >>> field = Field(["q", "p", "t"])
    >>> q, p, t = (field[name] for name in ("q", "p", "t"))
    >>> fall = VectorField(field, ("q", "p"), (p, -field.one))
    >>> lie_series(fall, q, t, order=5) == q + p * t - t**2 / 2
    True
    """
    total, term = function, function
    for k in range(1, order + 1):
        term = X.derivative(term)
        total = total + term * time**k / factorial(k)
    return total


def flow(X: VectorField, time: Element, order: int) -> Vector:
    """The flow of X after a time, by Lie series up to an order, coordinate by coordinate."""
    return tuple(lie_series(X, X.field[name], time, order) for name in X.names)


# -- motions that come as vector fields -----------------------------------------------------------


def hamiltonian_vector_field(
    field: Field, positions: Sequence[str], momenta: Sequence[str], energy: Element
) -> VectorField:
    """``dq/dt = dH/dp, dp/dt = -dH/dq``, so that ``{F, H} = X_H(F) = F_q . H_p - F_p . H_q``."""
    components = (*field.gradient(energy, momenta), *scale(-1, field.gradient(energy, positions)))
    return VectorField(field, (*positions, *momenta), components)


def curl(u: VectorField) -> VectorField:
    """``rot u`` of a field on R^3."""
    slopes = u.jacobian()
    return u.like([slopes[k][j] - slopes[j][k] for j, k in ((1, 2), (2, 0), (0, 1))])


def vorticity_rate(u: VectorField) -> VectorField:
    """``d omega/dt = -L_u omega`` of an ideal incompressible fluid (section B.7.2).

    With ``div u = 0`` this is ``(omega . grad) u - (u . grad) omega`` for ``omega = curl u``: the
    vorticity is carried along by the flow, and a flow is steady if and only if both commute.
    """
    return -lie_derivative(u, curl(u))
