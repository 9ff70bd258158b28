"""Systems of the book that are declared here and not shipped: derived equations against its own."""

from fractions import Fraction
from itertools import combinations, combinations_with_replacement

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import SpecError
from coadjoint.prove import Verdict
from tests.sources.components import antisymmetric, commutator, cross, dot, hat, plus, times
from tests.sources.test_equations import values
from tests.specs import prove_claims, spec

# -- 2.5.6: a rigid body in a quadratic potential -------------------------------------------------

TOP = """
title = "A body in a quadratic potential"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
S = { role = "advected", representation = "symmetric", form = "symmetric" }
[parameters]
a = { shape = [3], positive = true, default = [1, 2, 3] }
[lagrangian]
l = "((a2 + a3)*Omega1^2 + (a1 + a3)*Omega2^2 + (a1 + a2)*Omega3^2)/2 - trace(S*diag(a))/2"
"""
PACKED = """
title = "A body of four dimensions in a quadratic potential"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
M = { role = "momentum", form = "antisymmetric" }
S = { role = "advected", representation = "symmetric", form = "symmetric" }
[parameters]
a = { shape = [4], positive = true, default = [1, 2, 3, 4] }
[hamiltonian]
h = \"\"\"
  M12^2/(2*(a1 + a2)) + M13^2/(2*(a1 + a3)) + M14^2/(2*(a1 + a4)) + M23^2/(2*(a2 + a3))
+ M24^2/(2*(a2 + a4)) + M34^2/(2*(a3 + a4)) + trace(S*diag(a))/2
\"\"\"
[claims]
casimirs = ["trace(S)", "trace(S*S)"]
"""


def symmetric(entries, n):
    """The matrix with the given entries on and above its diagonal."""
    matrix = [[None] * n for _ in range(n)]
    for (i, j), entry in zip(combinations_with_replacement(range(n), 2), entries, strict=True):
        matrix[i][j] = matrix[j][i] = entry
    return matrix


def points(size, parameters):
    """Rational states and positive parameters."""
    for start in (1, 4):
        yield (
            [Fraction((-1) ** n * (n + start), n % 3 + 1) for n in range(size)],
            [Fraction(n + start, 2) for n in range(1, parameters + 1)],
        )


def book(M, Omega, S, A, sign=1):
    """``[M, Omega] + [A, S]`` and ``[S, Omega]``, for V = + tr(S A)/2."""
    turning, torque = commutator(M, Omega), commutator(A, S)
    rows = zip(turning, torque, strict=True)
    momentum = [plus(row, times(sign, moment)) for row, moment in rows]
    return momentum, commutator(S, Omega)


def diagonal(a):
    """The matrix of second moments."""
    return [[x if i == j else 0 for j in range(len(a))] for i, x in enumerate(a)]


@pytest.mark.parametrize("route", ["euler-poincare", "lie-poisson"])
def test_2_5_6_body_in_a_quadratic_potential(route):
    """By the hat map: M = hat(Pi), I1 = a2 + a3; the other sign of the torque does not pass."""
    equations = derive(spec(TOP), route)
    for x, a in points(9, 3):
        inertia = [a[1] + a[2], a[0] + a[2], a[0] + a[1]]
        Omega = hat([p / i for p, i in zip(x, inertia, strict=False)])
        S = symmetric(x[3:], 3)
        point = dict(zip(map(str, (*equations.state, *equations.parameters)), x + a, strict=True))
        found = values(equations.rates, point)
        M_rate, S_rate = book(hat(x[:3]), Omega, S, diagonal(a))
        assert hat(found[:3]) == M_rate != book(hat(x[:3]), Omega, S, diagonal(a), -1)[0]
        assert symmetric(found[3:], 3) == S_rate
        assert any(map(any, S_rate))


def test_2_5_6_body_of_four_dimensions_in_a_quadratic_potential():
    """The same matrices from packed entries on so(4): off-diagonal slopes of S count twice."""
    equations = derive(spec(PACKED))
    for x, a in points(16, 4):
        entries = zip(x[:6], combinations(a, 2), strict=True)
        Omega = antisymmetric([m / (p + q) for m, (p, q) in entries], 4)
        S = symmetric(x[6:], 4)
        point = dict(zip(map(str, (*equations.state, *equations.parameters)), x + a, strict=True))
        found = values(equations.rates, point)
        M_rate, S_rate = book(antisymmetric(x[:6], 4), Omega, S, diagonal(a))
        assert antisymmetric(found[:6], 4) == M_rate
        assert symmetric(found[6:], 4) == S_rate
        assert M_rate != book(antisymmetric(x[:6], 4), Omega, S, diagonal(a), -1)[0]


def test_2_5_6_is_proved():
    """Both routes agree, traces of powers of S are Casimirs; tr M^2 is none where S turns too."""
    assert prove_claims(spec(TOP)).holds
    assert prove_claims(spec(PACKED)).holds
    (refuted,) = prove_claims(spec(PACKED, ('"trace(S)"', '"trace(M*M)"'))).refuted
    assert refuted.statement == "trace(M*M) is a Casimir"


# -- 2.4.2 and 2.4.3: packed matrices of so(3) ----------------------------------------------------

THREE = """
title = "Manakov's body of three dimensions"
routes = ["lie-poisson"]
[algebra]
{algebra}
[variables]
M = { role = "momentum", form = "antisymmetric" }
[parameters]
a = { shape = [3], positive = true, default = [1, 2, 3] }
[hamiltonian]
h = "M12^2/(2*(a1 + a2)) + M13^2/(2*(a1 + a3)) + M23^2/(2*(a2 + a3))"
[claims]
casimirs = ["trace(M*M)"]
"""
ROTATIONS = """
[algebra.subalgebra]
algebra = "so(4)"
basis = { E12 = "E12", E13 = "E13", E23 = "E23" }
"""


def test_2_4_3_packed_matrices_go_along_planes():
    """M_ij along E_ij gives dM/dt = [M, Omega]; along J1, J2, J3 = E32, E13, E21 it is refused.

    It would be dM/dt = -[M, Omega] there: (Pi1, Pi2, Pi3) read as (M12, M13, M23) is the hat map of
    no rotation, and the invariants are the same.
    """
    with pytest.raises(SpecError, match=r"J1, J2, J3.*hat\("):
        spec(THREE.replace("{algebra}", 'name = "so(3)"'))
    equations = derive(spec(THREE.replace("{algebra}", ROTATIONS)))
    assert prove_claims(equations.spec).holds
    for x, a in points(3, 3):
        sums = [p + q for p, q in combinations(a, 2)]
        M, Omega = (
            antisymmetric(x, 3),
            antisymmetric([m / s for m, s in zip(x, sums, strict=True)], 3),
        )
        point = dict(zip(map(str, (*equations.state, *equations.parameters)), x + a, strict=True))
        found = antisymmetric(values(equations.rates, point), 3)
        assert found == commutator(M, Omega)
        assert any(map(any, found))


def test_2_4_2_three_dimensions_are_the_rigid_body():
    """With Pi = (-M23, M13, -M12) and I1 = a2 + a3 it is dPi/dt = Pi x Omega."""
    equations = derive(spec(THREE.replace("{algebra}", ROTATIONS)))
    for x, a in points(3, 3):
        point = dict(zip(map(str, (*equations.state, *equations.parameters)), x + a, strict=True))
        m12, m13, m23 = values(equations.rates, point)
        Pi = [-x[2], x[1], -x[0]]
        inertia = [a[1] + a[2], a[0] + a[2], a[0] + a[1]]
        Omega = [p / i for p, i in zip(Pi, inertia, strict=True)]
        assert [-m23, m13, -m12] == cross(Pi, Omega)


# -- 3.1.5, exercise: Kepler's problem with a monopole --------------------------------------------

KEPLER = """
title = "Kepler's problem with a magnetic monopole"
routes = ["poisson"]
[poisson]
canonical = [["r", "v"]]
[poisson.magnetic]
"{v1, v2}" = "k*r3/norm(r)^3"
"{v2, v3}" = "k*r1/norm(r)^3"
"{v3, v1}" = "k*r2/norm(r)^3"
[variables]
r = { role = "coordinate", shape = [3] }
v = { role = "coordinate", shape = [3] }
[parameters]
mu = { default = 1 }
k = { default = "1/2" }
[hamiltonian]
h = "dot(v, v)/2 - mu/norm(r) + k^2/(2*dot(r, r))"
[claims]
conserved = ["energy"]
"""

CYCLES = ((1, 2, 3), (2, 3, 1), (3, 1, 2))


def vector_claims(sign):
    """P = L -+ k r/|r| and A = v x P - mu r/|r|, component by component."""
    P = [f"r{j}*v{m} - r{m}*v{j} {sign} k*r{i}/norm(r)" for i, j, m in CYCLES]
    A = [f"v{j}*({P[m - 1]}) - v{m}*({P[j - 1]}) - mu*r{i}/norm(r)" for i, j, m in CYCLES]
    return P, A


def claiming(integrals, *changes):
    """The spec with these claims."""
    listed = ", ".join(f'"{text}"' for text in ("energy", *integrals))
    return spec(KEPLER, ('conserved = ["energy"]', f"conserved = [{listed}]"), *changes)


@pytest.mark.parametrize("r", [(1, 2, 2), (2, 3, 6), (4, -4, 7)])
def test_3_1_5_monopole_equations(r):
    """``r'' + (k/r^3) L + (mu/r^3 - k^2/r^4) r = 0`` where |r| is a whole number."""
    equations = derive(spec(KEPLER))
    length = Fraction({(1, 2, 2): 3, (2, 3, 6): 7, (4, -4, 7): 9}[r])
    v, mu, k = [Fraction(3, 2), Fraction(-1), Fraction(5)], Fraction(2, 3), Fraction(7, 4)
    assert dot(r, r) == length**2
    L = cross(r, v)
    force = times(-(mu / length**3 - k**2 / length**4), r)
    expected = [*v, *plus(times(-k / length**3, L), force)]
    names = [str(symbol) for symbol in (*equations.state, *equations.parameters)]
    point = dict(zip(names, map(Fraction, (*r, *v, mu, k)), strict=True))
    assert values(equations.rates, point) == expected
    assert values(equations.rates, point) != [*v, *plus(times(k / length**3, L), force)]


def test_3_1_5_monopole_integrals_are_proved():
    """P, A and E are conserved, exactly; nothing rests on numbers."""
    P, A = vector_claims("-")
    certificate = prove_claims(claiming(P + A))
    assert certificate.holds, str(certificate)
    assert certificate.count(Verdict.PROVED) == len(certificate.claims)
    # each component of P and A, and the energy once
    assert sum(claim.kind == "conserved" for claim in certificate.claims) == 7


def test_3_1_5_monopole_integrals_of_the_wrong_sign_are_refuted():
    """L + k r/|r|, L itself, and P in the opposite field are not conserved; |L| is."""
    P, A = vector_claims("+")
    assert refuted_integrals(claiming(P + A)) == 6
    right, _ = vector_claims("-")
    flips = [(f'= "k*r{n}/norm', f'= "-k*r{n}/norm') for n in (1, 2, 3)]
    assert refuted_integrals(claiming(right, *flips)) == 3
    L = ["r2*v3 - r3*v2", "dot(cross(r, v), cross(r, v))"]
    refuted = prove_claims(claiming(L)).refuted
    assert [each.statement for each in refuted if each.kind == "conserved"] == [
        f"{L[0]} is conserved"
    ]


def refuted_integrals(declared):
    """How many integrals are refuted; the flow of each is then refuted as a symmetry, too."""
    kinds = [claim.kind for claim in prove_claims(declared).refuted]
    assert kinds.count("symmetry") == kinds.count("conserved") == len(kinds) / 2
    return kinds.count("conserved")


# -- 2.5.4: the motion of a quadratic pair --------------------------------------------------------


def test_2_5_4_brackets_of_a_quadratic_casimir():
    """{x_i, x_j} = -epsilon_ijk C_kl x_l for c = x.Cx/2, from a spec with the entries of C."""
    text = """
title = "A quadratic Casimir"
routes = ["nambu", "poisson"]
[poisson]
nambu = ["dot(x, (C + transpose(C))*x)/4"]
[variables]
x = { role = "coordinate", shape = [3] }
[parameters]
C = { shape = [3, 3] }
[hamiltonian]
h = "x1"
"""
    equations = derive(spec(text))
    x = sympy.Matrix(equations.state)
    C = sympy.Matrix(3, 3, equations.parameters)
    slopes = (C + C.T) * x / 2
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        assert sympy.expand(equations.poisson_tensor[i, j] + slopes[k]) == 0
        assert sympy.expand(equations.poisson_tensor[i, j] - slopes[k]) != 0
    assert prove_claims(spec(text)).holds
