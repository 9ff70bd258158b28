"""Group actions: quaternions, and the rotations that they are.

Comes in: four components of anything that adds and multiplies. Goes out: `Quaternion`, whose
multiplication table is that of coquaternions (`coadjoint.theory.coquaternions`) up to a sign:

    ``i^2 = -1,  j^2 = k^2 = s,  i j = k,  j k = -s i,  k i = j``;  s = -1 or +1.

Read next: `coadjoint.groups.vector_fields`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import Matrix, Vector, add, hat, identity, product, scale
from coadjoint.groups.complex_numbers import allow_division


@dataclass(frozen=True)
class Hypercomplex:
    """``w + x i + y j + z k``; use one of the two algebras below.

    Attributes:
        w: The scalar part.
        x: The component of i.
        y: The component of j.
        z: The component of k.
        square: What j and k square to.
    """

    w: Any
    x: Any
    y: Any
    z: Any
    square: ClassVar[int]

    def __post_init__(self) -> None:
        for name in "wxyz":
            object.__setattr__(self, name, allow_division(getattr(self, name)))

    @classmethod
    def pure(cls, vector: Sequence[Any]) -> Self:
        """``[0, v]``, the imaginary one with the components of a three-vector."""
        x, y, z = vector
        return cls(0 * x, x, y, z)

    @property
    def components(self) -> Vector:
        """``(w, x, y, z)``; `dataclasses.astuple` would copy each element with its whole ring."""
        return (self.w, self.x, self.y, self.z)

    @property
    def vector(self) -> Vector:
        """The imaginary part as a three-vector."""
        return (self.x, self.y, self.z)

    @property
    def conjugate(self) -> Self:
        """``q* = [w, -v]``."""
        return type(self)(self.w, -self.x, -self.y, -self.z)

    @property
    def norm(self) -> Any:
        """``q q*``: ``w^2 + x^2 -+ (y^2 + z^2)``, multiplicative; the square of the length."""
        planes = self.y * self.y + self.z * self.z
        return self.w * self.w + self.x * self.x - self.square * planes

    def inverse(self) -> Self:
        """``q* / (q q*)``.

        Raises:
            AlgebraError: The norm is zero: q is 0 or, for coquaternions, a zero divisor.
        """
        norm = self.norm
        if norm == 0:
            raise AlgebraError(
                f"{self} has no inverse: its norm w^2 + x^2 {'-+'[self.square < 0]} y^2 "
                f"{'-+'[self.square < 0]} z^2 is 0, and times {self.conjugate} it is 0; expected "
                "a norm other than 0.",
                found=str(self),
            )
        return type(self)(*(component / norm for component in self.conjugate.components))

    def __add__(self, other: Self) -> Self:
        return type(self)(*(a + b for a, b in zip(self.components, other.components, strict=True)))

    def __neg__(self) -> Self:
        return type(self)(*(-a for a in self.components))

    def __sub__(self, other: Self) -> Self:
        return self + -other

    def __mul__(self, other: Self | Any) -> Self:
        if not isinstance(other, Hypercomplex):
            return self.scale(other)
        if type(other) is not type(self):
            raise AlgebraError(
                f"{self} is a {type(self).__name__} and {other} a {type(other).__name__}; "
                "expected two of one algebra.",
                found=type(other).__name__,
            )
        a, b, c, d = self.components
        w, x, y, z = other.components
        s = self.square
        return type(self)(
            a * w - b * x + s * (c * y + d * z),
            a * x + b * w - s * (c * z - d * y),
            a * y + c * w + d * x - b * z,
            a * z + d * w + b * y - c * x,
        )

    def __rmul__(self, factor: Any) -> Self:
        return self.scale(factor)

    def scale(self, factor: Any) -> Self:
        """The product with a real number."""
        return type(self)(*(factor * component for component in self.components))

    @classmethod
    def units(cls) -> tuple[Self, ...]:
        """1, i, j and k."""
        return (cls(1, 0, 0, 0), cls(0, 1, 0, 0), cls(0, 0, 1, 0), cls(0, 0, 0, 1))

    def __str__(self) -> str:
        return f"[{self.w}; {self.x}, {self.y}, {self.z}]"


class Quaternion(Hypercomplex):
    """A quaternion ``[q0, q]`` with ``[q0, q][r0, r] = [q0 r0 - q . r, q0 r + r0 q + q x r]``.

    Source:
        Holm (2011), Geometric Mechanics II, section 3.1.

    >>> one, i, j, k = Quaternion.units()
    >>> i * j == k, i * j * k == -one
    (True, True)
    """

    square = -1


def euler_rodrigues(q: Quaternion) -> Matrix:
    """The matrix of ``v -> q v q^-1``.

    ``R(q) = 1 + (2 q0 hat(q) + 2 hat(q)^2) / (q q*)``, so that R(q) R(p) = R(q p).

    Source:
        Holm (2011), Geometric Mechanics II, section 3.2, there for norm 1.
    """
    cross_q = hat(q.vector)
    turn = add(product(cross_q, cross_q), scale(q.w, cross_q))
    return add(identity(3), scale(2 / allow_division(q.norm), turn))
