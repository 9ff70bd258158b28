"""Actions of semidirect products against the formulas of Holm (2011), chapters 6 and 7.

As in `tests.sources.test_actions`: formulas typed from the book, generic elements, and a wrong sign
that must be noticed.
"""

import pytest

from coadjoint.exact.dense import product
from coadjoint.theory import matrix_group, trace_pairing
from coadjoint.theory.actions import (
    body_velocity,
    element_rates,
    matrix_rate,
    rate,
    space_velocity,
)
from tests.algebra.laws import lie_poisson_tensor
from tests.sources.forms import (
    JJ,
    R2,
    R3,
    column,
    galilean,
    galilean_inverse,
    galilean_product,
    hat,
    minus,
)
from tests.theory.exactly import (
    block,
    check_agrees,
    cross,
    dot,
    mul,
    on,
    plus,
    same,
    times,
    turned,
)

# -- chapter 6: semidirect products -----------------------------------------------------------


@pytest.fixture
def se3():
    """SE(3) with a generic (R, v)."""
    G = matrix_group("SE(3)", ["g"], ["xi", "eta", "mu"])
    g = G.element("g")
    return G, g, block(g, R3, R3), column(g, 3, R3)


def halves(vector):
    """(xi, alpha) of six components."""
    return vector[:3], vector[3:]


def test_6_1_AD_of_se3():
    """AD_(R,v) (S, w) = (R S R^T, v + R w - R S R^T v)."""
    G = matrix_group("SE(3)", ["g", "h"])
    g, h = G.element("g"), G.element("h")
    (R, v), (S, w) = ((block(e, R3, R3), column(e, 3, R3)) for e in (g, h))
    found, turned_S = G.AD(g, h), mul(mul(R, S), turned(R))
    check_agrees(
        G.field,
        (block(found, R3, R3), column(found, 3, R3)),
        lambda s: (turned_S, plus(v, on(R, w), times(-s, on(turned_S, v)))),
    )


def test_6_2_Ad_of_se3(se3):
    """Ad_(R,v) (xi, alpha) = (R xi, R alpha + v x R xi)."""
    G, g, R, v = se3
    xi, alpha = halves(G.vector("xi"))
    check_agrees(
        G.field,
        G.Ad(g, (*xi, *alpha)),
        lambda s: (*on(R, xi), *plus(on(R, alpha), times(s, cross(v, on(R, xi))))),
    )


def test_6_2_Ad_star_of_se3(se3):
    """Ad*_((R,v)^-1) (mu, beta) = (R mu + v x R beta, R beta)."""
    G, g, R, v = se3
    mu, beta = halves(G.vector("mu"))
    check_agrees(
        G.field,
        G.Ad_star(G.inverse(g), (*mu, *beta)),
        lambda s: (*plus(on(R, mu), times(s, cross(v, on(R, beta)))), *on(R, beta)),
    )


def test_6_3_1_ad_of_se3(se3):
    """ad_(xi,alpha) (xi', alpha') = (xi x xi', xi x alpha' - xi' x alpha)."""
    G = se3[0]
    (xi, alpha), (eta, gamma) = halves(G.vector("xi")), halves(G.vector("eta"))
    check_agrees(
        G.field,
        G.ad(G.vector("xi"), G.vector("eta")),
        lambda s: (*cross(xi, eta), *plus(cross(xi, gamma), times(-s, cross(eta, alpha)))),
    )


def test_6_3_2_ad_star_of_se3(se3):
    """ad*_(xi,alpha) (mu, beta) = (mu x xi + beta x alpha, beta x xi)."""
    G = se3[0]
    (xi, alpha), (mu, beta) = halves(G.vector("xi")), halves(G.vector("mu"))
    check_agrees(
        G.field,
        G.ad_star(G.vector("xi"), G.vector("mu")),
        lambda s: (*plus(cross(mu, xi), times(s, cross(beta, alpha))), *cross(beta, xi)),
    )


@pytest.fixture
def moving_se3():
    """SE(3) on a generic curve: rates of its symbols and of mu are free."""
    spare = matrix_group("SE(3)")
    more = [f"rate_{s}" for s in spare.symbols]
    G = matrix_group("SE(3)", ["g"], ["mu", "change"], more)
    rates = element_rates(G, "g", "rate")
    return G, G.element("g"), rates, matrix_rate(G, G.element("g"), rates)


def test_6_3_3_inversion_exchanges_left_and_right(moving_se3):
    """The body velocity of g^-1 is minus the space velocity of g."""
    G, g, rates, g_dot = moving_se3
    inverse = G.inverse(g)
    found = body_velocity(G, inverse, matrix_rate(G, inverse, rates))
    space = space_velocity(G, g, g_dot)
    check_agrees(G.field, found, lambda s: times(-s, space))


def test_6_3_3_right_motion_conserves_Ad_star_of_g(moving_se3):
    """With xi = dg/dt g^-1 and (mu, beta)' = -(mu x xi + beta x alpha, beta x xi), Ad*_g rests."""
    G, g, rates, g_dot = moving_se3
    (xi, alpha), (mu, beta) = halves(space_velocity(G, g, g_dot)), halves(G.vector("mu"))
    conserved = G.Ad_star(g, G.vector("mu"))

    def drift(s):
        change = (*plus(cross(mu, xi), cross(beta, alpha)), *cross(beta, xi))
        moved = {f"mu_{n}": -s * c for n, c in zip(G.algebra.basis, change, strict=True)}
        return [rate(G.field, value, rates | moved) for value in conserved]

    assert same(G.field, drift(1), [0] * 6)
    assert not same(G.field, drift(-1), [0] * 6)


@pytest.fixture
def se2():
    """SE(2) with a generic (R, v)."""
    G = matrix_group("SE(2)", ["g", "h"], ["xi", "eta", "mu"])
    g = G.element("g")
    return G, g, block(g, R2, R2), column(g, 2, R2)


def test_6_4_product_and_inverse_of_se2(se2):
    """(R1, v1)(R2, v2) = (R1 R2, R1 v2 + v1) and (R, v)^-1 = (R^T, -R^T v)."""
    G, g, R, v = se2
    h = G.element("h")
    S, w = block(h, R2, R2), column(h, 2, R2)
    check_agrees(
        G.field,
        (block(product(g, h), R2, R2), column(product(g, h), 2, R2)),
        lambda s: (mul(R, S), plus(on(R, w), times(s, v))),
    )
    check_agrees(G.field, column(G.inverse(g), 2, R2), lambda s: times(-s, on(turned(R), v)))


def test_6_4_AD_and_Ad_of_se2(se2):
    """AD leaves the angle; Ad_(R,v) (xi, alpha) = (xi, R alpha - xi JJ v)."""
    G, g, R, v = se2
    h, (xi, *alpha) = G.element("h"), G.vector("xi")
    S, w = block(h, R2, R2), column(h, 2, R2)
    found = G.AD(g, h)
    check_agrees(
        G.field,
        (block(found, R2, R2), column(found, 2, R2)),
        lambda s: (S, plus(v, on(R, w), times(-s, on(S, v)))),
    )
    check_agrees(
        G.field,
        G.Ad(g, (xi, *alpha)),
        lambda s: (xi, *plus(on(R, alpha), times(-s * xi, on(JJ, v)))),
    )


def test_6_4_Ad_star_of_se2(se2):
    """Ad*_(R,v) (m, b) = (m - b.JJ v, R^T b), the dual of the line above."""
    G, g, R, v = se2
    m, *b = G.vector("mu")
    check_agrees(
        G.field, G.Ad_star(g, (m, *b)), lambda s: (m - s * dot(b, on(JJ, v)), *on(turned(R), b))
    )


def test_6_4_ad_and_ad_star_of_se2(se2):
    """Ad (xi, alpha)(eta, gamma) = (0, JJ(xi gamma - eta alpha)); ad* = (-b.JJ alpha, -xi JJ b)."""
    G = se2[0]
    (xi, *alpha), (eta, *gamma), (m, *b) = (G.vector(v) for v in ("xi", "eta", "mu"))
    check_agrees(
        G.field,
        G.ad((xi, *alpha), (eta, *gamma)),
        lambda s: (0, *on(JJ, plus(times(xi, gamma), times(-s * eta, alpha)))),
    )
    check_agrees(
        G.field,
        G.ad_star((xi, *alpha), (m, *b)),
        lambda s: (-dot(b, on(JJ, alpha)), *times(-s * xi, on(JJ, b))),
    )


def test_6_4_bracket_and_casimir_of_se2(se2):
    """{m, b1} = -b2, {m, b2} = b1, {b1, b2} = 0 with the minus bracket; b.b is at rest."""
    G = se2[0]
    mu = G.vector("mu")
    _m, b1, b2 = mu
    tensor = lie_poisson_tensor(G.algebra, mu, number=G.field.number)
    check_agrees(G.field, tensor, lambda s: ((0, -s * b2, b1), (s * b2, 0, 0), (-b1, 0, 0)))
    _dm, d1, d2 = G.ad_star(G.vector("xi"), mu)
    assert G.field.is_zero(b1 * d1 + b2 * d2)
    assert not G.field.is_zero(b1 * d1 - b2 * d2)


@pytest.fixture
def sl2_r2():
    """SL(2,R) (s) R^2 with a generic (A, v) and the pairing tr(mu^T a) + beta.u."""
    G = matrix_group("SL(2,R)(s)R^2", ["g", "h"], ["xi", "eta", "mu"])
    return G, trace_pairing(G.algebra, "tr(mu^T xi)")


def linear_part(matrix):
    """(a, u) of ``[[a, u], [0, .]]``."""
    return block(matrix, R2, R2), column(matrix, 2, R2)


def inverse2(A):
    """The inverse of a matrix of determinant 1."""
    (a, b), (c, d) = A
    return ((d, -b), (-c, a))


def difference(A, B, s=1):
    """``A - s B``."""
    return tuple(plus(row, times(-s, other)) for row, other in zip(A, B, strict=True))


def traceless(A):
    """A without its trace."""
    half = (A[0][0] + A[1][1]) / 2
    return ((A[0][0] - half, A[0][1]), (A[1][0], A[1][1] - half))


def test_6_5_1_product_and_Ad_of_sl2_r2(sl2_r2):
    """(A1 A2, A1 v2 + v1); Ad_(A,v) (a, u) = (A a A^-1, A u - A a A^-1 v)."""
    G, _ = sl2_r2
    g, h = G.element("g"), G.element("h")
    (A, v), (B, w), (a, u) = (linear_part(m) for m in (g, h, G.matrix(G.vector("xi"))))
    check_agrees(
        G.field,
        linear_part(product(g, h)),
        lambda s: (mul(A, B), plus(on(A, w), times(s, v))),
    )
    aA = mul(mul(A, a), inverse2(A))
    check_agrees(
        G.field,
        linear_part(G.matrix(G.Ad(g, G.vector("xi")))),
        lambda s: (aA, plus(on(A, u), times(-s, on(aA, v)))),
    )


def test_6_5_2_ad_of_sl2_r2(sl2_r2):
    """ad_(a,u) (b, w) = ([a, b], a w - b u)."""
    G, _ = sl2_r2
    xi, eta = G.vector("xi"), G.vector("eta")
    (a, u), (b, w) = (linear_part(G.matrix(x)) for x in (xi, eta))
    check_agrees(
        G.field,
        linear_part(G.matrix(G.ad(xi, eta))),
        lambda s: (difference(mul(a, b), mul(b, a)), plus(on(a, w), times(-s, on(b, u)))),
    )


def test_6_5_3_Ad_star_of_sl2_r2(sl2_r2):
    """Ad*_(A,v) (mu, beta) = (A^T (mu - (beta v^T)_traceless) A^-T, A^T beta)."""
    G, pairing = sl2_r2
    g = G.element("g")
    A, v = linear_part(g)
    mu, beta = linear_part(pairing.matrix(G.vector("mu")))
    AT, AiT = turned(A), turned(inverse2(A))
    dyad = traceless(tuple(times(b, v) for b in beta))
    check_agrees(
        G.field,
        linear_part(pairing.matrix(G.Ad_star(g, G.vector("mu")))),
        lambda s: (mul(mul(AT, difference(mu, dyad, s)), AiT), on(AT, beta)),
    )


def test_6_5_3_ad_star_of_sl2_r2(sl2_r2):
    """ad*_(a,u) (mu, beta) = ([a^T, mu] - (beta u^T)_traceless, a^T beta)."""
    G, pairing = sl2_r2
    a, u = linear_part(G.matrix(G.vector("xi")))
    mu, beta = linear_part(pairing.matrix(G.vector("mu")))
    aT = turned(a)
    dyad = traceless(tuple(times(b, u) for b in beta))
    check_agrees(
        G.field,
        linear_part(pairing.matrix(G.ad_star(G.vector("xi"), G.vector("mu")))),
        lambda s: (
            difference(difference(mul(aT, mu), mul(mu, aT)), dyad, s),
            on(aT, beta),
        ),
    )


def test_6_5_4_coadjoint_motion_of_sl2_r2():
    """Along A' = A a, v' = A u and (mu, beta)' as above, A^-T beta is at rest."""
    spare = matrix_group("SL(2,R)(s)R^2")
    more = [f"rate_{s}" for s in spare.symbols]
    G = matrix_group("SL(2,R)(s)R^2", ["g"], ["mu"], more)
    g, mu, rates = G.element("g"), G.vector("mu"), element_rates(G, "g", "rate")
    (A, v), pairing = linear_part(g), trace_pairing(G.algebra, "tr(mu^T xi)")
    xi = body_velocity(G, g, matrix_rate(G, g, rates))
    for sign, rests in ((1, True), (-1, False)):
        change = zip(G.algebra.basis, G.ad_star(xi, mu), strict=True)
        moved = rates | {f"mu_{n}": sign * c for n, c in change}
        momentum, beta = linear_part(pairing.matrix(mu))
        AiT = turned(inverse2(A))
        spatial = on(AiT, beta)
        dyad = traceless(tuple(times(b, v) for b in spatial))
        # Ad*_(g^-1) (mu, beta) = (A^-T mu A^T + (A^-T beta v^T)_traceless, A^-T beta)
        other = difference(mul(mul(AiT, momentum), turned(A)), dyad, -1)
        drift = [rate(G.field, x, moved) for row in (spatial, *other) for x in row]
        assert same(G.field, drift, [0] * 6) == rests


@pytest.fixture
def g3():
    """G(3) with generic elements."""
    G = matrix_group("G(3)", ["g", "h"], ["xi", "eta"])
    return G, G.element("g")


def parts(vector):
    """(xi, nu, alpha, sigma) of ten components."""
    return vector[:3], vector[3:6], vector[6:9], vector[9]


def test_6_6_1_AD_of_g3(g3):
    """AD by the book's product and inverse of (R, v, r, tau)."""
    G, g = g3
    a, b = galilean(g), galilean(G.element("h"))
    check_agrees(
        G.field,
        galilean(G.AD(g, G.element("h"))),
        lambda s: galilean_product(galilean_product(a, b), galilean_inverse(a, s)),
    )


def test_6_6_1_Ad_of_g3(g3):
    """Xi' = R xi, nu' = R nu - R xi x v, alpha' = R alpha + sigma v - R xi x r - tau nu'."""
    G, g = g3
    R, v, r, tau = galilean(g)
    xi, nu, alpha, sigma = parts(G.vector("xi"))
    boosted = plus(on(R, nu), minus(cross(on(R, xi), v)))
    shifted = (on(R, alpha), times(sigma, v), minus(cross(on(R, xi), r)))
    check_agrees(
        G.field,
        G.Ad(g, G.vector("xi")),
        lambda s: (on(R, xi), boosted, plus(*shifted, times(-s * tau, boosted)), sigma),
    )


def test_6_6_2_ad_of_g3(g3):
    """(xi x xi', xi x nu' - xi' x nu, xi x alpha' - xi' x alpha + nu tau' - nu' tau, 0)."""
    G, _ = g3
    x, n, a, t = parts(G.vector("xi"))
    y, m, b, u = parts(G.vector("eta"))
    check_agrees(
        G.field,
        G.ad(G.vector("xi"), G.vector("eta")),
        lambda s: (
            *(cross(x, y), plus(cross(x, m), minus(cross(y, n)))),
            *(plus(cross(x, b), minus(cross(y, a)), times(u, n), times(-s * t, m)), 0),
        ),
    )


def test_6_7_g3_is_an_iterated_semidirect_product(g3):
    """((R, v), (r, tau)): rotations act on boosts, and both on space-time by [[R, v], [0, 1]]."""
    G, g = g3
    h = G.element("h")

    def split(e):
        R, v, r, tau = galilean(e)
        return R, v, (*r, tau)

    (Rg, vg, wg), (Rh, vh, wh) = split(g), split(h)
    lorentz = (*((*row, v) for row, v in zip(Rg, vg, strict=True)), (0, 0, 0, 1))
    check_agrees(
        G.field,
        split(product(g, h)),
        lambda s: (mul(Rg, Rh), plus(on(Rg, vh), vg), plus(on(lorentz, wh), times(s, wg))),
    )


# -- section 7.1.3: coadjoint motion on se(3)* --------------------------------------------------


def test_7_1_3_coadjoint_motion_on_se3(moving_se3):
    """Where R' = R hat(xi), x' = R alpha: R beta and R mu + x x R beta are at rest."""
    G, g, rates, g_dot = moving_se3
    R, x = block(g, R3, R3), column(g, 3, R3)
    xi, alpha = halves(body_velocity(G, g, g_dot))
    assert same(G.field, block(g_dot, R3, R3), mul(R, hat(xi)))
    assert same(G.field, column(g_dot, 3, R3), on(R, alpha))
    mu, beta = halves(G.vector("mu"))
    conserved = (*on(R, beta), *plus(on(R, mu), cross(x, on(R, beta))))
    for sign, rests in ((1, True), (-1, False)):
        change = (*plus(cross(mu, xi), times(sign, cross(beta, alpha))), *cross(beta, xi))
        moved = rates | {f"mu_{n}": c for n, c in zip(G.algebra.basis, change, strict=True)}
        drift = [rate(G.field, value, moved) for value in conserved]
        assert same(G.field, drift, [0] * 6) == rests
