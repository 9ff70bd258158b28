"""Group actions: exact complex numbers, for Pauli matrices and charts of the sphere.

Comes in: real and imaginary parts of anything that adds and multiplies. Goes out: `Complex`, and
complex matrices written as real ones of twice the size.
Read next: `coadjoint.theory.maps`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import Matrix


def allow_division(value: Any) -> Any:
    """The value, integers as fractions, so that a division stays exact."""
    return Fraction(value) if isinstance(value, int) else value


@dataclass(frozen=True)
class Complex:
    """``re + i im``; Python's own complex numbers know floats only.

    Attributes:
        re: Real part.
        im: Imaginary part.

    >>> Complex(1, 2) * Complex(1, -2) == 5
    True
    """

    re: Any
    im: Any = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "re", allow_division(self.re))
        object.__setattr__(self, "im", allow_division(self.im))

    @property
    def conjugate(self) -> Complex:
        """``re - i im``."""
        return Complex(self.re, -self.im)

    @property
    def norm(self) -> Any:
        """``re^2 + im^2``."""
        return self.re * self.re + self.im * self.im

    def inverse(self) -> Complex:
        """``1 / self``.

        Raises:
            AlgebraError: The number is zero.
        """
        if self.norm == 0:
            raise AlgebraError(
                f"{self} has no inverse; expected a complex number other than 0.", found=str(self)
            )
        return Complex(self.re / self.norm, -self.im / self.norm)

    def __add__(self, other: Any) -> Complex:
        right = _complex(other)
        return Complex(self.re + right.re, self.im + right.im)

    def __mul__(self, other: Any) -> Complex:
        right = _complex(other)
        return Complex(
            self.re * right.re - self.im * right.im, self.re * right.im + self.im * right.re
        )

    __radd__ = __add__
    __rmul__ = __mul__

    def __neg__(self) -> Complex:
        return Complex(-self.re, -self.im)

    def __sub__(self, other: Any) -> Complex:
        return self + -_complex(other)

    def __rsub__(self, other: Any) -> Complex:
        return _complex(other) - self

    def __truediv__(self, other: Any) -> Complex:
        return self * _complex(other).inverse()

    def __eq__(self, other: object) -> bool:
        right = _complex(other)
        return bool(self.re == right.re and self.im == right.im)

    __hash__ = None  # type: ignore[assignment]  # equal elements need not have equal hashes

    def __str__(self) -> str:
        return f"{self.re} + {self.im} i"


#: The imaginary unit.
I = Complex(0, 1)  # noqa: E741 (the letter of the books)


def _complex(value: Any) -> Complex:
    """A real value as a complex number."""
    return value if isinstance(value, Complex) else Complex(value)


def adjoint(matrix: Matrix) -> Matrix:
    """The conjugate transpose of a matrix of complex numbers."""
    return tuple(tuple(z.conjugate for z in column) for column in zip(*matrix, strict=True))


def realify(matrix: Matrix) -> Matrix:
    """The real matrix ``[[A, -B], [B, A]]`` of a complex one ``A + i B``.

    >>> realify(((I,),)) == ((0, -1), (1, 0))
    True
    """
    rows = tuple(tuple(map(_complex, row)) for row in matrix)
    upper = tuple((*(z.re for z in row), *(-z.im for z in row)) for row in rows)
    return upper + tuple((*(z.im for z in row), *(z.re for z in row)) for row in rows)
