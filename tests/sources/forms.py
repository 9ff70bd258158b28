"""Small matrices and products as Holm (2011) writes them, for the tests of group actions."""

from tests.theory.exactly import block, mul, on, plus, times, turned

R2, R3 = range(2), range(3)
#: The book's matrix of section 6.4.
JJ = ((0, -1), (1, 0))


def hat(a):
    """``hat(a) b = a x b``, typed from section 2.1.1."""
    a1, a2, a3 = a
    return ((0, -a3, a2), (a3, 0, -a1), (-a2, a1, 0))


def column(matrix, c, rows):
    """Part of a column as a vector."""
    return tuple(matrix[r][c] for r in rows)


def minus(v):
    """``-v``."""
    return times(-1, v)


def galilean(g):
    """(R, v, r, tau) of a matrix ``[[R, v, r], [0, 1, tau], [0, 0, 1]]``."""
    return block(g, R3, R3), column(g, 3, R3), column(g, 4, R3), g[3][4]


def galilean_product(a, b, s=1):
    """(R1 R2, R1 v2 + v1, R1 r2 + v1 tau2 + r1, tau1 + tau2), section 1.2."""
    (Ra, va, ra, ta), (Rb, vb, rb, tb) = a, b
    return (
        *(mul(Ra, Rb), plus(on(Ra, vb), va)),
        *(plus(on(Ra, rb), times(s * tb, va), ra), ta + tb),
    )


def galilean_inverse(a, s=1):
    """(R^T, -R^T v, -R^T (r - v tau), -tau), section 1.2."""
    R, v, r, tau = a
    T = turned(R)
    return T, minus(on(T, v)), minus(on(T, plus(r, times(-s * tau, v)))), -tau
