"""The spin chain as a lattice tends to the strand, by Taylor series in the distance of bodies.

Both motions are derived: of the generic body, and of the field. Between them stands a curve of
attitudes g(s) with g' = g hat(Xi), whose Taylor series in s is typed here.
"""

from functools import cache
from math import comb, factorial

import pytest
import sympy

from coadjoint.derive.indexed import derive_family
from tests.specs import emitted

a, s = sympy.symbols("a s")
#: The strain and its derivatives, as the strand calls them.
STRAIN = [sympy.symbols(f"Xi1{end} Xi2{end} Xi3{end}") for end in ("", "_s", "_ss", "_sss")]
PI = sympy.symbols("Pi1 Pi2 Pi3")


def hat(x):
    """The matrix of the cross product with x."""
    return sympy.Matrix([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def curve(distance, order=4):
    """g(0)^-1 g(s) up to a power of s: derivatives of U' = U hat(Xi) by Leibniz' rule."""
    slopes = [sympy.eye(3)]
    for n in range(order):
        parts = (comb(n, k) * slopes[k] * hat(STRAIN[n - k]) for k in range(n + 1))
        slopes.append(sum(parts, sympy.zeros(3)))
    return sum((u * distance**n / factorial(n) for n, u in enumerate(slopes)), sympy.zeros(3))


@cache
def lattice():
    """The motion of the generic body."""
    return derive_family(emitted("spin_chain_lattice"))


def place(before, here, after):
    """What the attitudes of three bodies are."""
    family, values = lattice(), {}
    for n, symbol in enumerate(family.states[:9]):
        values[symbol] = here[n]
        values[family.neighbours[symbol, -1]] = before[n]
        values[family.neighbours[symbol, 1]] = after[n]
    return values


@pytest.mark.parametrize("turned", [False, True])
def test_rates_are_those_of_the_strand_up_to_the_second_order(turned):
    """Of momenta, symbol by symbol: no term a^-2, a^-1 or a is left, and one a^2 is.

    Where attitudes turn the other way, transposed, the limit is another one.
    """
    around = [curve(-a), sympy.eye(3), curve(a)]
    values = place(*(each.T if turned else each for each in around))
    rates = [rate.xreplace(values) for rate in lattice().rates[9:]]
    equations = emitted("spin_chain")
    known = [equations.setting.field.to_sympy(x) for x in equations.exact.rates[:3]]
    compared, left, misses = 0, 0, 0
    for rate, of_strand in zip(rates, known, strict=True):
        series = sympy.Poly(sympy.expand((rate - of_strand) * a**2), a)
        for power in range(4):
            misses += sympy.expand(series.coeff_monomial(a**power)) != 0
            compared += 1
        left += sympy.expand(series.coeff_monomial(a**4)) != 0
    assert (compared, left) == (12, 3)
    assert (misses == 0) != turned


@pytest.mark.parametrize("sign", [1, -1])
def test_links_close_in_continuous_time(sign):
    """dU/dt = U hat(Omega') - hat(Omega) U for U = R^T R', the zero curvature of a lattice."""
    family = lattice()
    here = sympy.Matrix(3, 3, family.states[:9])
    after = sympy.Matrix(3, 3, [family.neighbours[x, 1] for x in family.states[:9]])
    moments = sympy.symbols("I1 I2 I3")
    momenta = sympy.symbols("Pi1[+1] Pi2[+1] Pi3[+1]")
    Omega = hat([p / moment for p, moment in zip(PI, moments, strict=True)])
    next_Omega = hat([p / moment for p, moment in zip(momenta, moments, strict=True)])
    rates = sympy.Matrix(3, 3, family.rates[:9])
    own = dict(zip([*family.states[:9], *PI], [*after, *momenta], strict=True))
    change = rates.T * after + here.T * rates.xreplace(own)
    link = here.T * after
    rest = (change - link * next_Omega + sign * Omega * link).expand()
    assert (rest == sympy.zeros(3)) == (sign == 1)
