"""Nambu's route: cofactors of gradients, against the bracket and against sums typed by hand."""

from itertools import permutations

import pytest
import sympy
from sympy.combinatorics import Permutation

from coadjoint.derive import derive
from coadjoint.derive.routes import nambu
from tests.specs import emitted, prove_claims, shipped, spec, unitless

FOUR = """
title = "four coordinates"
routes = ["nambu", "poisson"]
[poisson]
nambu = ["x1^2/2 + x2*x4", "dot(x, x)/2"]
[variables]
x = { role = "coordinate", shape = [4] }
[parameters]
k = { default = 1 }
[hamiltonian]
h = "k*x3^2*x1 + x2"
"""
FIVE = (
    ('"dot(x, x)/2"]', '"dot(x, x)/2", "k*x1*x5 + x3"]'),
    ("shape = [4]", "shape = [5]"),
)
BODY = """
title = "rigid body by a table"
routes = ["poisson"]
[poisson.brackets]
"{x1, x2}" = "-x3"
"{x2, x3}" = "-x1"
"{x3, x1}" = "-x2"
[variables]
x = { role = "coordinate", shape = [3] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[hamiltonian]
h = "dot(x, inverse(diag(I))*x)/2"
[claims]
casimirs = ["dot(x, x)"]
"""
X = sympy.symbols("x1:6")


def by_permutations(*functions):
    """``dx_i/dt = -sum of sign(i j k ...) d_j h d_k c_1 ...``, h first, then the c."""
    n = len(functions) + 1
    rates = [sympy.S.Zero] * n
    for order in permutations(range(n)):
        sign = Permutation(order).signature()
        slopes = (sympy.diff(f, X[j]) for f, j in zip(functions, order[1:], strict=True))
        rates[order[0]] -= sign * sympy.Mul(*slopes)
    return rates


def same(found, expected):
    """Whether two lists of polynomials are equal."""
    return [sympy.expand(a - b) for a, b in zip(found, expected, strict=True)] == [0] * len(found)


def test_three_coordinates_have_a_cross_product():
    """For any c and h: grad c x grad h, in this order."""
    c, h = X[0] ** 2 * X[1] + X[2] ** 3, X[0] * X[2] + X[1] ** 2
    changes = [
        ('nambu = ["dot(x, x)/2"]', 'nambu = ["x1^2*x2 + x3^3"]'),
        ('"dot(x, inverse(diag(I))*x)/2"', '"x1*x3 + x2^2"'),
        ('casimirs  = ["dot(x, x)"]', "casimirs = []"),
    ]
    rates = derive(spec(unitless(shipped("nambu_body").path.read_text()), *changes)).rates
    dc, dh = (sympy.Matrix([f.diff(x) for x in X[:3]]) for f in (c, h))
    assert same(rates, dc.cross(dh))
    assert not same(rates, dh.cross(dc))
    assert same(rates, by_permutations(h, c))


@pytest.mark.parametrize("changes", [(), FIVE], ids=["R^4", "R^5"])
@pytest.mark.parametrize("route", ["nambu", "poisson"])
def test_more_coordinates_have_a_determinant(route, changes):
    """Both routes equal -det(e_i, grad h, grad c_1, ...) as a sum over permutations."""
    x1, x2, x3, x4, x5 = X
    k = sympy.Symbol("k")
    h = k * x3**2 * x1 + x2
    c = [x1**2 / 2 + x2 * x4, sum(x**2 for x in X[: 5 if changes else 4]) / 2]
    if changes:
        c.append(k * x1 * x5 + x3)
    rates = derive(spec(FOUR, *changes), route).rates
    assert any(rates)
    assert same(rates, by_permutations(h, *c))
    assert not same(rates, by_permutations(h, *c[:-2], c[-1], c[-2]))


@pytest.mark.parametrize("changes", [(), FIVE], ids=["R^4", "R^5"])
def test_routes_agree_beyond_three_coordinates(changes):
    """The motion and all n - 2 Casimirs are proved."""
    certificate = prove_claims(spec(FOUR, *changes))
    assert certificate.holds, str(certificate)
    statements = [claim.statement for claim in certificate.claims]
    assert "nambu and poisson give the same motion" in statements
    count = f"every Casimir is a function of the {2 + len(changes) // 2} known"
    assert any(statement.startswith(count) for statement in statements)


@pytest.mark.parametrize("name", ["nambu_body", "nambu_pendulum"])
def test_a_reversed_cross_product_is_refuted(name, monkeypatch):
    """The bracket shares no sign with the route: each of the two comparisons sees it."""
    right = nambu.generalised_cross_product
    monkeypatch.setattr(
        nambu, "generalised_cross_product", lambda rows: [-rate for rate in right(rows)]
    )
    refuted = {claim.statement for claim in prove_claims(shipped(name)).refuted}
    assert refuted == {
        "nambu and poisson give the same motion",
        "the motion by nambu is {x, h}",
    }


def test_a_function_of_the_wrong_sign_runs_backwards():
    """With -c every law still holds, by both routes; only the rates tell."""
    text = shipped("nambu_body").path.read_text()
    wrong = spec(text, ('nambu = ["dot(x, x)/2"]', 'nambu = ["-dot(x, x)/2"]'))
    assert prove_claims(wrong).holds
    for route in ("nambu", "poisson"):
        right = emitted("nambu_body", route).rates
        assert same(derive(wrong, route).rates, [-rate for rate in right])
        assert not same(derive(wrong, route).rates, right)


def test_a_cylinder_of_the_wrong_sign_is_refuted():
    """1 + I3/I1 in the place of 1 - I3/I1: the rigid body's sphere is no longer conserved."""
    text = shipped("nambu_pendulum").path.read_text()
    claimed = text[: text.index("[claims]")] + '[claims]\nconserved = ["dot(x, x)"]\n'
    assert prove_claims(spec(claimed)).holds
    refuted = prove_claims(spec(claimed, ("(1 - I3/I1)*x1^2/2", "(1 + I3/I1)*x1^2/2"))).refuted
    assert refuted[0].statement == "dot(x, x) is conserved"


def test_a_table_gives_the_same_body():
    """{x_i, x_j} = -epsilon_ijk x_k, typed as a table, is the bracket of c = x.x/2."""
    table = derive(spec(BODY))
    assert same(table.rates, emitted("nambu_body").rates)
    assert table.poisson_tensor == emitted("nambu_body").poisson_tensor


@pytest.mark.parametrize("place", ['"{x1, x2}" = "-', '"{x2, x3}" = "-', '"{x3, x1}" = "-'])
def test_one_wrong_sign_in_a_table_is_refuted(place):
    """Two minus signs and a plus are so(2,1): Jacobi holds, the sphere is no Casimir."""
    (refuted,) = prove_claims(spec(BODY, (place, place[:-1]))).refuted
    assert refuted.statement == "dot(x, x) is a Casimir"
