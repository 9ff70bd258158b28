"""Products of long polynomials over Q, in whole numbers.

Comes in: polynomials of one SymPy ring. Goes out: their product, as SymPy has it, in a third of the
time. Fractions of plain Python cost ten times what whole numbers do, and monomials are tuples of as
many exponents as a ring has generators. Here both factors are brought to whole coefficients, and
each monomial to one whole number with a byte for each exponent, so that a product of two terms is a
product and a sum of whole numbers.
Read next: `coadjoint.exact.element`.
"""

from __future__ import annotations

from math import lcm

from sympy.external.pythonmpq import PythonMPQ
from sympy.polys.rings import PolyElement

#: Products of terms from which on that pays.
FEWEST = 9


def multiply(a: PolyElement, b: PolyElement) -> PolyElement:
    """``a * b``, term for term what SymPy makes, in the same order.

    >>> from sympy import QQ, ring
    >>> _, x, y = ring("x, y", QQ)
    >>> multiply((x / 2 + y) ** 2, (x - 2 * y) ** 2)
    1/4*x**4 - 2*x**2*y**2 + 4*y**4
    """
    ring = a.ring
    if len(a) * len(b) < FEWEST or ring.domain.dtype is not PythonMPQ:
        return a * b
    try:
        (ones, below, all_of_a), (others, more, all_of_b) = _pack(a), _pack(b)
    except ValueError:  # an exponent beyond a byte
        return a * b
    size = ring.ngens
    if (all_of_a | all_of_b) & int.from_bytes(b"\x80" * size, "little"):
        return a * b  # a sum of exponents may be beyond a byte
    found = dict[int, int]()
    get = found.get
    for one, left in ones:
        for other, right in others:
            monomial = one + other
            found[monomial] = get(monomial, 0) + left * right
    product, common = ring.zero, below * more
    for monomial, value in found.items():
        if value:  # a whole number has no common divisor with 1
            made = PythonMPQ._new(value, 1) if common == 1 else PythonMPQ(value, common)
            product[tuple(monomial.to_bytes(size, "little"))] = made
    return product


def _pack(p: PolyElement) -> tuple[list[tuple[int, int]], int, int]:
    """Monomials with whole coefficients, what these are over, and all bits of the monomials.

    Raises:
        ValueError: An exponent is beyond a byte.
    """
    common, every = lcm(*(value.denominator for value in p.values())), 0
    terms = list[tuple[int, int]]()
    for exponents, value in p.items():
        monomial = int.from_bytes(bytes(exponents), "little")
        every |= monomial
        above = value.numerator
        terms.append((monomial, above if common == 1 else above * (common // value.denominator)))
    return terms, common, every
