"""Irreducible factors: those of SymPy, found in another way."""

import random
from math import prod

from sympy import QQ, symbols
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyRing

from coadjoint.exact import Field
from coadjoint.exact.irreducible import all_factors, factors_of, find_factors


def test_factors_are_those_of_sympy():
    """Random products of small polynomials, with squares and common factors."""
    ring = PolyRing(symbols("x y z w"), QQ, lex)
    source = random.Random(5)

    def small():
        addends = [
            prod(source.choices(ring.gens, k=source.randint(0, 2)), start=ring.one)
            * source.choice([-3, -1, 1, 2, QQ(1, 2)])
            for _ in range(source.randint(1, 4))
        ]
        return sum(addends, ring.zero)

    several = 0
    for _ in range(60):
        product = prod((small() ** source.randint(1, 2) for _ in range(2)), start=ring.one)
        if product:
            known = sorted(str(factor) for factor, _ in product.factor_list()[1])
            found = {str(factor) for factor in factors_of(product)}
            assert known == sorted(found), product
            several += len(known) > 1
    assert several > 20


def test_factors_are_found_among_the_symbols_that_occur():
    """a(a + b) has two factors; a sum that does not factor has one; a number none."""
    ring = Field([f"p{n}" for n in range(90)] + ["Gamma1", "Gamma2"])
    a, b = ring["Gamma1"], ring["Gamma2"]
    assert len(find_factors(ring, a**2 + a * b)) == 2
    assert find_factors(ring, a**2 + b**2) == [a**2 + b**2]
    assert find_factors(ring, ring.number(3)) == find_factors(ring, ring.zero) == []


def test_relations_of_functions_show_more_factors():
    """x^2 - y^2 + y^2 sin(q)^2 is (x - y cos(q)) (x + y cos(q)); x^2 + sin(q)^2 is no product."""
    ring = Field(["x", "y", "q"], slots=2)
    x, y, q = (ring[name] for name in "xyq")
    sine, cosine = ring.call("sin", q), ring.call("cos", q)
    found = list(all_factors(ring, x**2 - y**2 + y**2 * sine**2))
    assert len(found) == 2
    assert ring.is_zero(found[0] * found[1] - x**2 + (y * cosine) ** 2)
    assert len(list(all_factors(ring, x**2 + sine**2))) == 1
