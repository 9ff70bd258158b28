"""Exact complex numbers: a field, and their matrices as real ones."""

import random
from fractions import Fraction

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import product, transpose
from coadjoint.groups.complex_numbers import Complex, I, adjoint, realify


def test_complex_numbers_calculate_as_pythons():
    """Sums, products and quotients of small integers equal those of Python's complex numbers."""
    source = random.Random(2)
    for _ in range(50):
        a, b, c, d = (source.randint(-9, 9) or 1 for _ in range(4))
        z, w = Complex(a, b), Complex(c, d)
        for found, expected in (
            (z + w, complex(a, b) + complex(c, d)),
            (z - w, complex(a, b) - complex(c, d)),
            (z * w, complex(a, b) * complex(c, d)),
            (z / w, complex(a, b) / complex(c, d)),
            (3 - z, 3 - complex(a, b)),
        ):
            assert abs(complex(found.re, found.im) - expected) < 1e-12
    assert Complex(1, 1) / 3 == Complex(Fraction(1, 3), Fraction(1, 3))
    assert Complex(1, 1) != Complex(1, -1)


def test_zero_has_no_inverse():
    """The inverse of 0 is refused, and the message shows what was found."""
    with pytest.raises(AlgebraError, match=r"0 \+ 0 i has no inverse"):
        Complex(1) / Complex(0, 0)


def test_realified_matrices_multiply_alike():
    """A + iB -> [[A, -B], [B, A]] preserves products and turns adjoints into transposes."""
    field = Field([f"{letter}{n}" for letter in "ab" for n in range(8)])

    def generic(letter):
        parts = [field[f"{letter}{n}"] for n in range(8)]
        a, b, c, d = (Complex(parts[n], parts[n + 1]) for n in (0, 2, 4, 6))
        return ((a, b), (c, d))

    A, B = generic("a"), generic("b")
    assert realify(product(A, B)) == product(realify(A), realify(B))
    assert realify(product(A, B)) != product(realify(B), realify(A))
    assert realify(adjoint(A)) == transpose(realify(A))
    assert realify(((I, 0), (0, I))) == (
        (0, 0, -1, 0),
        (0, 0, 0, -1),
        (1, 0, 0, 0),
        (0, 1, 0, 0),
    )
