r"""Group actions: vector fields, their brackets, flows and what they do to forms.

Comes in: components as elements of a field in named coordinates. Goes out: `VectorField` and its
calculus. Two sign conventions are in use, and each has its own name here:

.. math:: \pounds_X Y = (DY) X - (DX) Y = [X, Y]_{operators}, \qquad [X, Y]_{JL} = (DX) Y - (DY) X

the Lie derivative of theorem B.7.1's proof, and the Jacobi-Lie bracket as section B.6 defines it:
they are opposite, and the statement of B.7.1, which calls them equal, has a misprint.
Read next: `coadjoint.groups.central_forces`.

Source:
    Holm (2011), Geometric Mechanics II, appendices A.2 and B.5 to B.7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Vector, add, apply, dot, scale, subtract
from coadjoint.groups.lifts import compose, cotangent_lift, jacobian


@dataclass(frozen=True)
class VectorField:
    """``X = X_i d/dx_i`` on R^n; a system of differential equations ``dx_i/dt = X_i``.

    Attributes:
        field: Where the components live.
        names: The coordinates.
        components: One element for each coordinate.

    Raises:
        AlgebraError: There are more or fewer components than coordinates.

    >>> field = Field(["x", "y"])
    >>> x, y = field["x"], field["y"]
    >>> VectorField(field, ("x", "y"), (-y, x)).derivative(x**2 + y**2) == 0
    True
    """

    field: Field
    names: tuple[str, ...]
    components: tuple[Element, ...]

    def __post_init__(self) -> None:
        if len(self.names) != len(self.components):
            raise AlgebraError(
                f"a vector field in ({', '.join(self.names)}) has {len(self.components)} "
                f"components; expected {len(self.names)}, one for each coordinate.",
                found=len(self.components),
            )
        object.__setattr__(self, "components", self.field.vector(self.components))

    def like(self, components: Sequence[Element]) -> VectorField:
        """A vector field in the same coordinates."""
        return VectorField(self.field, self.names, tuple(components))

    def derivative(self, function: Element) -> Element:
        """``X(f) = X_i df/dx_i``: the Lie derivative of a function, or its rate along the flow."""
        total: Element = dot(self.components, self.field.gradient(function, self.names))
        return total

    def rates(self, functions: Sequence[Element]) -> Vector:
        """`derivative` of several functions."""
        return tuple(map(self.derivative, functions))

    def jacobian(self) -> tuple[Vector, ...]:
        """``DX``."""
        return jacobian(self.field, self.components, self.names)

    def __add__(self, other: VectorField) -> VectorField:
        return self.like(add(self.components, other.components))

    def __sub__(self, other: VectorField) -> VectorField:
        return self.like(subtract(self.components, other.components))

    def __neg__(self) -> VectorField:
        return self.like(scale(-1, self.components))

    def __rmul__(self, factor: Any) -> VectorField:
        return self.like(scale(factor, self.components))

    def is_zero(self) -> bool:
        """Whether every component is zero."""
        return all(map(self.field.is_zero, self.components))


# -- brackets -------------------------------------------------------------------------------------


def lie_derivative(X: VectorField, Y: VectorField) -> VectorField:
    """``(DY) X - (DX) Y``, the rate of change of Y along the flow of X.

    The operator with these components is the commutator X Y - Y X.

    >>> field = Field(["x"])
    >>> X, Y = (VectorField(field, ("x",), (c,)) for c in (field.one, field["x"]))
    >>> lie_derivative(X, Y).components
    (1,)
    """
    return X.like(subtract(apply(Y.jacobian(), X.components), apply(X.jacobian(), Y.components)))


def jacobi_lie_bracket(X: VectorField, Y: VectorField) -> VectorField:
    """``(DX) Y - (DY) X`` (section B.6), minus the commutator of operators.

    >>> field = Field(["x"])
    >>> X, Y = (VectorField(field, ("x",), (c,)) for c in (field.one, field["x"]))
    >>> jacobi_lie_bracket(X, Y).components
    (-1,)
    """
    return X.like(subtract(apply(X.jacobian(), Y.components), apply(Y.jacobian(), X.components)))


# -- forms ----------------------------------------------------------------------------------------


def lie_derivative_of_one_form(X: VectorField, alpha: Sequence[Element]) -> Vector:
    """``(L_X alpha)_i = X(alpha_i) + alpha_j dX_j/dx_i``."""
    turned = cotangent_lift(X.field, X.components, X.names, alpha)
    return add(X.rates(alpha), turned)


def exterior_derivative(field: Field, names: Sequence[str], alpha: Sequence[Element]) -> Any:
    """The matrix ``(d alpha)_ij = d alpha_j/dx_i - d alpha_i/dx_j`` of a one-form."""
    slopes = jacobian(field, alpha, names)
    places = range(len(names))
    return tuple(tuple(slopes[j][i] - slopes[i][j] for j in places) for i in places)


def divergence(X: VectorField) -> Element:
    """``div X``, with which the volume form grows: ``L_X d^n x = div X d^n x``."""
    return sum((row[n] for n, row in enumerate(X.jacobian())), X.field.zero)


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

    It ends by itself, and is then exact, where X^k(f) = 0 for some k.

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
    vorticity is carried along by the flow, and a flow is steady just where both commute.
    """
    return -lie_derivative(u, curl(u))
