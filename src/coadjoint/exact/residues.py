"""Residues: integers modulo a prime, an arithmetic in which a `Field` evaluates elements.

Comes in: integers and rational numbers. Goes out: `Residue`. It loads no SymPy.
Read next: `coadjoint.exact.ranks`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import Final

from coadjoint.exact.linear import PRIME, primes

#: Points, each modulo another prime of 61 bits, at which functions are asked whether they vanish,
#: and those that are tried: half of all numbers have no root modulo a prime.
POINTS: Final = 2
TRIES: Final = 60


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


def call_modulo(function: str, *arguments: Residue) -> Residue:
    """A value of an elementary function that satisfies the relations of a `Field`.

    Raises:
        ZeroDivisionError: The argument has no square root.
    """
    argument = arguments[0]
    prime, one = argument.prime, Residue(1, argument.prime)
    if function == "sqrt":
        return square_root(argument)
    if function in ("sin", "cos"):  # a point of the circle, the same one for both
        half = draw(f"half of {argument.value}", prime)
        top = half + half if function == "sin" else one + -(half * half)
        return top / (one + half * half)
    if function in ("sinh", "cosh", "tanh"):  # by one exponential
        power, half = draw(f"exp {argument.value}", prime), one / (one + one)
        cosh, sinh = (power + one / power) * half, (power + -(one / power)) * half
        return {"sinh": sinh, "cosh": cosh}.get(function) or sinh / cosh
    if function == "sign":
        return Residue((-1) ** draw(f"sign {argument.value}", prime).value % prime, prime)
    return draw(f"{function} {' '.join(str(each.value) for each in arguments)}", prime)


def vanish(
    find: Callable[[dict[str, Residue], Callable[..., Residue]], Iterable[Residue]],
    names: Iterable[str],
) -> bool:
    """Whether functions vanish at points modulo primes.

    A rational function of degree d that is not zero vanishes at one with a chance of ``d / 2^61``.

    Args:
        find: Their values, from a value of each name and what makes numbers of others. It raises
            ZeroDivisionError at a pole, or where a number has no root.
        names: What they are functions of.

    >>> vanish(lambda at, number: [at["x"] * at["y"] + -(at["y"] * at["x"])], ["x", "y"])
    True
    >>> vanish(lambda at, number: [at["x"] + -number(3)], ["x"])
    False
    """
    source, reached, drawn = random.Random(1), 0, sorted({*names})  # noqa: S311
    for prime in islice(primes(), TRIES):
        number = partial(residue, prime=prime)
        try:
            values = [*find({name: number(source.randrange(1, prime)) for name in drawn}, number)]
        except ZeroDivisionError:
            continue
        if any(each.value for each in values):
            return False
        reached += 1
        if reached == POINTS:
            return True
    return False
