"""Residues: integers modulo a prime, an arithmetic in which a `Field` evaluates elements.

Comes in: integers and rational numbers. Goes out: `Residue`. It loads no SymPy.
Read next: `coadjoint.exact.ranks`.
"""

from __future__ import annotations

import random
from fractions import Fraction

from coadjoint.exact.linear import PRIME


class Residue:
    """An integer modulo a prime, with what evaluation needs.

    Args:
        value: The integer, reduced.
        prime: The prime.
    """

    __slots__ = ("prime", "value")

    def __init__(self, value: int, prime: int = PRIME) -> None:
        self.value, self.prime = value, prime

    def __repr__(self) -> str:
        return f"Residue({self.value}, {self.prime})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Residue):
            return NotImplemented
        return (self.value, self.prime) == (other.value, other.prime)

    def __hash__(self) -> int:
        return hash(self.value)

    def __add__(self, other: Residue) -> Residue:
        return Residue((self.value + other.value) % self.prime, self.prime)

    def __mul__(self, other: Residue) -> Residue:
        return Residue(self.value * other.value % self.prime, self.prime)

    def __neg__(self) -> Residue:
        return Residue(-self.value % self.prime, self.prime)

    def __truediv__(self, other: Residue) -> Residue:
        if not other.value:
            raise ZeroDivisionError(f"division by zero modulo {self.prime}")
        return Residue(self.value * pow(other.value, -1, self.prime) % self.prime, self.prime)


def residue(number: Fraction | int, prime: int = PRIME) -> Residue:
    """A rational number modulo a prime.

    Raises:
        ZeroDivisionError: The prime divides the denominator.
    """
    top, bottom = Residue(number.numerator % prime, prime), number.denominator
    return top if bottom == 1 else top / Residue(bottom % prime, prime)


def draw(seed: str, prime: int = PRIME) -> Residue:
    """A random residue other than 0, the same one for the same seed."""
    return Residue(random.Random(seed).randrange(1, prime), prime)  # noqa: S311 (not for secrets)


def square_root(number: Residue) -> Residue:
    """A square root modulo a prime that is 3 modulo 4.

    Raises:
        ZeroDivisionError: There is none.
    """
    prime = number.prime
    root = Residue(pow(number.value, (prime + 1) // 4, prime), prime)
    if root * root != number:
        raise ZeroDivisionError(f"no square root of {number.value} modulo {prime}")
    return root
