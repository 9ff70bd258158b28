r"""Group actions: vector fields, their Lie derivatives, and what maps do to covectors.

Comes in: components as elements of a field in named coordinates. Goes out: `VectorField` and its
calculus, Jacobian matrices and cotangent lifts:

.. math:: \pounds_X Y = (DY) X - (DX) Y = [X, Y]_{operators}

Read next: `coadjoint.theory.vector_fields`, which has the Jacobi-Lie bracket of the other sign.

Source:
    Holm (2011), Geometric Mechanics II, appendices A.2, A.3 and B.5 to B.7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import Matrix, Vector, add, apply, dot, scale, subtract, transpose


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


def lie_derivative(X: VectorField, Y: VectorField) -> VectorField:
    """``(DY) X - (DX) Y``, the rate of change of Y along the flow of X.

    The operator with these components is the commutator X Y - Y X.

    >>> field = Field(["x"])
    >>> X, Y = (VectorField(field, ("x",), (c,)) for c in (field.one, field["x"]))
    >>> lie_derivative(X, Y).components
    (1,)
    """
    return X.like(subtract(apply(Y.jacobian(), X.components), apply(X.jacobian(), Y.components)))


def exterior_derivative(field: Field, names: Sequence[str], alpha: Sequence[Element]) -> Any:
    """The matrix ``(d alpha)_ij = d alpha_j/dx_i - d alpha_i/dx_j`` of a one-form."""
    slopes = jacobian(field, alpha, names)
    places = range(len(names))
    return tuple(tuple(slopes[j][i] - slopes[i][j] for j in places) for i in places)
