"""Specs with an index whose members are all written out: against the same written by hand."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import ClaimError, LimitError, SpecError
from coadjoint.prove import Verdict, prove
from coadjoint.prove.almost_poisson import about_reduced_jacobi
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.zero import Discovery
from coadjoint.spec.reader import read_spec
from tests.families import are_equal, read
from tests.specs import shipped

CHAIN = """
title = "Links"
routes = ["euler-lagrange"]
[index]
i = { size = 2, first = 1, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "q", index = "i" }
[parameters]
m = { index = "i", positive = true }
l = { index = "i", positive = true }
g = {}
[definitions]
x = "sum(j, j <= i, l[j]*cos(q[j])*v[j])"
y = "sum(j, j <= i, l[j]*sin(q[j])*v[j])"
[lagrangian]
l = "sum(i, m[i]*(x^2 + y^2))/2 + g*sum(i, m[i]*sum(j, j <= i, l[j]*cos(q[j])))"
[claims]
conserved = ["energy"]
"""
#: The double pendulum as Landau and Lifshitz have it (Mechanics, section 5, problem 1).
DOUBLE = """
title = "D"
routes = ["euler-lagrange"]
[variables]
q_1 = { role = "coordinate" }
q_2 = { role = "coordinate" }
v_1 = { role = "velocity", of = "q_1" }
v_2 = { role = "velocity", of = "q_2" }
[parameters]
m_1 = { positive = true }
m_2 = { positive = true }
l_1 = { positive = true }
l_2 = { positive = true }
g = {}
[lagrangian]
l = \"\"\"
(m_1 + m_2)*l_1^2*v_1^2/2 + m_2*l_2^2*v_2^2/2 + m_2*l_1*l_2*v_1*v_2*cos(q_1 - q_2)
+ (m_1 + m_2)*g*l_1*cos(q_1) + m_2*g*l_2*cos(q_2)
\"\"\"
"""
#: Masses and springs between two walls, on a bracket; the index is written in many ways.
WALLS = """
title = "W"
routes = ["canonical"]
[index]
i = { size = 3 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = {}
[hamiltonian]
h = "sum(i, p[i]^2)/2 + V"
"""
PLAIN = "k*(q_0^2 + (q_1 - q_0)^2 + (q_2 - q_1)^2 + q_2^2)/2"


def by_hand(expression):
    """The same of three masses, without an index."""
    momenta = "p_0^2/2 + p_1^2/2 + p_2^2/2"
    return sympy.sympify(f"{momenta} + {expression}".replace("^", "**"))


@pytest.mark.parametrize(
    ("written", "plain"),
    [
        ("k*(q[0]^2 + sum(i, (q[i+1] - q[i])^2) + q[2]^2)/2", PLAIN),
        ("k*(sum(i, i == 0, q[i]^2) + sum(i, (q[i+1] - q[i])^2) + sum(i, i > 1, q[i]^2))/2", PLAIN),
        ("sum(i, j, i <= j, q[i]*q[j])", "q_0^2+q_1^2+q_2^2+q_0*q_1+q_0*q_2+q_1*q_2"),
        ("sum(i, j, i < j, (j - i)*q[i]*q[j])", "q_0*q_1 + q_1*q_2 + 2*q_0*q_2"),
        ("sum(i, j, i != j, q[i]*q[j]^2)", "(q_0+q_1+q_2)*(q_0^2+q_1^2+q_2^2)-q_0^3-q_1^3-q_2^3"),
        ("sum(i, j, q[i]*q[j]/(1 + i + j))", "q_0^2+q_0*q_1+2*q_0*q_2/3+q_1^2/3+q_1*q_2/2+q_2^2/5"),
        ("sum(i, 2^i*q[i]^(i + 1))", "q_0 + 2*q_1^2 + 4*q_2^3"),
        ("sum(i, max(1, i)*abs(i - 1)*q[2 - i])", "q_2 + 2*q_0"),
        ("sum(i, q[i])^2*k", "k*(q_0 + q_1 + q_2)^2"),
        ("sum(i, j, i < j, sum(l, l > j, q[i]*q[j]*q[l]))", "q_0*q_1*q_2"),
        ("sum(i, i > 5, q[i])", "0"),
    ],
)
def test_indices_are_numbers_and_sums_have_conditions(written, plain):
    """Each as the same is written with names of the members."""
    spec = read(WALLS, ("V", written))
    assert spec.written
    assert are_equal(derive(spec).energy, by_hand(plain))


def test_a_wrong_condition_is_another_energy():
    """So that the comparison above can fail."""
    spec = read(WALLS, ("V", "sum(i, j, i < j, q[i]*q[j])"))
    assert not are_equal(derive(spec).energy, by_hand("q_0^2+q_1^2+q_2^2+q_0*q_1+q_0*q_2+q_1*q_2"))


def test_two_links_are_the_double_pendulum():
    """Every rate, with masses and lengths of their own, by sums that stand in sums."""
    found, known = derive(read(CHAIN)), derive(read(DOUBLE))
    assert found.variables == known.variables == ("q_1", "q_2", "v_1", "v_2")
    assert all(map(are_equal, found.rates, known.rates))
    wrong = derive(read(CHAIN, ("j <= i, l[j]*cos(q[j])*v[j]", "j < i, l[j]*cos(q[j])*v[j]")))
    assert not all(map(are_equal, wrong.rates, known.rates))


def test_every_statement_has_the_size():
    """Proved for that one, and said so."""
    claims = prove(read(CHAIN)).claims
    assert claims
    assert all(each.statement.endswith(", for n = 2") for each in claims)
    assert all(each.verdict is Verdict.PROVED for each in claims)
    wrong = read(CHAIN, ('["energy"]', '["energy", "sum(i, v[i])"]'))
    refuted = [each for each in prove(wrong).claims if each.verdict is Verdict.REFUTED]
    assert refuted[0].statement == "sum(i, v[i]) is conserved, for n = 2"


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_chain_hangs_with_the_roots_of_laguerre(n):
    """Squares of the frequencies are ``(g/l)`` times the roots of ``L_n``, by the rates at rest."""
    equations = derive(read_spec(shipped("n_link_chain").path, {"i": n}))
    rates = dict(zip(equations.variables, equations.rates, strict=True))
    angles = sympy.symbols([f"theta_{k}" for k in range(1, n + 1)])
    rest = dict.fromkeys(map(sympy.Symbol, equations.variables), 0)
    slopes = sympy.Matrix(
        [
            [sympy.diff(rates[f"omega_{k}"], angle).xreplace(rest) for angle in angles]
            for k in range(1, n + 1)
        ]
    )
    square, g, length = sympy.symbols("s g l")
    found = sympy.simplify(-slopes * length / g).charpoly(square)
    assert found.as_expr() == sympy.Poly(sympy.laguerre(n, square), square).monic().as_expr()


def test_size_is_needed_and_limited():
    """The message says why all members are written out."""
    with pytest.raises(SpecError, match=r"since a sum stands in a sum; no size is given"):
        read(CHAIN, ("size = 2, ", ""))
    with pytest.raises(LimitError, match="STATE_COMPONENTS"):
        read(CHAIN, sizes={"i": 1000})
    with pytest.raises(LimitError, match="WRITTEN_PARTS"):
        read(WALLS, ("V", "sum(i, j, k2, l, q[i]*q[j]*q[k2]*q[l])"), sizes={"i": 60})


#: M. Kac and P. van Moerbeke, Advances in Mathematics 16 (1975) 160.
VOLTERRA = """
title = "Volterra's lattice"
routes = ["poisson"]
[index]
i = { size = 5, periodic = true, written_out = true }
[variables]
c = { role = "coordinate", index = "i", default = 1 }
[poisson.brackets]
"{c[i], c[i+1]}" = "c[i]*c[i+1]"
[hamiltonian]
h = "sum(i, c[i])"
[claims]
casimirs = ["c[0]*c[1]*c[2]*c[3]*c[4]"]
conserved = ["energy", "sum(i, c[i]^2/2 + c[i]*c[i+1])"]
"""


def test_members_may_have_brackets_with_their_neighbours():
    """Volterra's lattice: dc_i/dt = c_i (c_(i+1) - c_(i-1)), also with two ends."""
    ring, chain = read(VOLTERRA), read(VOLTERRA.split("[claims]")[0], (", periodic = true", ""))
    assert ring.written == chain.written == "written_out = true asks for it"
    c = sympy.symbols("c_:5")
    turned = [c[i] * (c[(i + 1) % 5] - c[i - 1]) for i in range(5)]
    assert [sympy.expand(a - b) for a, b in zip(derive(ring).rates, turned, strict=True)] == [0] * 5
    assert sympy.expand(derive(chain).rates[0] - c[0] * c[1]) == 0
    assert sympy.expand(derive(chain).rates[4] + c[3] * c[4]) == 0
    prove(ring).require()
    with pytest.raises(ClaimError, match="for N = 5"):
        prove(read(VOLTERRA, ("c[i]^2/2", "c[i]^2"))).require()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("size = 5", "size = 2"), "the bracket of c_1 and c_0 is there twice"),
        (("{c[i], c[i+1]}", "{c[i], c[k+1]}"), "there is no index 'k'"),
    ],
)
@pytest.mark.parametrize("asked", [", written_out = true", ""])
def test_bad_brackets_of_neighbours_are_refused(change, said, asked):
    """With the key, and advice that works."""
    with pytest.raises(SpecError) as caught:
        read(VOLTERRA.split("[claims]")[0], (", written_out = true", asked), change)
    assert said in str(caught.value)
    assert "poisson.brackets" in str(caught.value)


MEMBERS = [
    ('[forces]\nv = "-g*v[i]"\n[claims]', "forces", ["v_1", "v_2"]),
    ('[domain]\nup = "cos(q[i]) > 0"\n[claims]', "domain", ["up_1", "up_2"]),
]


@pytest.mark.parametrize(("text", "table", "names"), MEMBERS)
def test_what_is_along_a_member_is_there_for_each(text, table, names):
    """Forces by the names of velocities, conditions where the index is free."""
    spec = read(CHAIN, ("[claims]", text), ('conserved = ["energy"]', "conserved = []"))
    found = getattr(spec, table)
    assert [getattr(each, "name", each) for each in found] == names


def test_a_constraint_of_each_member_gives_its_velocity():
    """Wheels in a row, each rolling by its own radius: ``v_k = r_k w_k``."""
    text = """
title = "Wheels"
routes = ["nonholonomic"]
[index]
i = { size = 3, first = 1 }
[variables]
x = { role = "coordinate", index = "i" }
a = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "x", index = "i" }
w = { role = "velocity", of = "a", index = "i" }
[parameters]
r = { index = "i", positive = true }
k = {}
[lagrangian]
l = "sum(i, v[i]^2 + w[i]^2)/2 - k*sum(i, (x[i+1] - x[i])^2)/2"
[constraints]
rolling = "v[i] == r[i]*w[i]"
[claims]
conserved = ["energy"]
"""
    spec = read(text)
    assert [each.name for each in spec.constraints] == ["rolling_1", "rolling_2", "rolling_3"]
    assert {c for v in spec.state for c in v.components} == {
        f"{name}_{n}" for name in "xaw" for n in (1, 2, 3)
    }
    equations = derive(spec)
    rates = dict(zip(equations.variables, equations.rates, strict=True))
    r, x1, x2, k = sympy.symbols("r_1 x_1 x_2 k")
    assert are_equal(rates["w_1"], k * r * (x2 - x1) / (1 + r**2))


def test_forces_by_definitions_next_to_a_constraint_of_one_member():
    """A definition names another member in each force; the one that is held has a reaction."""
    text = """
title = "Blocks on a belt"
routes = ["nonholonomic"]
[index]
i = { size = 3 }
[variables]
x = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "x", index = "i" }
[parameters]
c = {}
w = {}
[definitions]
slip = "v[i] - w"
[lagrangian]
l = "sum(i, v[i]^2)/2 - sum(i, (x[i+1] - x[i])^2)/2"
[forces]
v = "-c*slip"
[constraints]
rest = "v[0] == w"
"""
    equations = derive(read(text))
    rates = dict(zip(equations.variables, equations.rates, strict=True))
    c, w, x0, x1, x2, v1, v2 = sympy.symbols("c w x_0 x_1 x_2 v_1 v_2")
    assert are_equal(rates["v_0"], sympy.Integer(0))
    assert are_equal(rates["v_1"], x0 - 2 * x1 + x2 - c * (v1 - w))
    assert are_equal(rates["v_2"], x1 - x2 - c * (v2 - w))


def test_a_cart_without_an_index_and_pendulums_with_one():
    """The cart is shared: its momentum is conserved, and each pendulum pulls it."""
    text = """
title = "Cart"
routes = ["euler-lagrange"]
[index]
i = { size = 2 }
[variables]
x = { role = "coordinate" }
q = { role = "coordinate", index = "i" }
u = { role = "velocity", of = "x" }
v = { role = "velocity", of = "q", index = "i" }
[parameters]
g = {}
[lagrangian]
l = "u^2/2 + sum(i, u^2 + v[i]^2 + 2*u*v[i]*cos(q[i]))/2 + g*sum(i, cos(q[i]))"
[observables]
P = "u + sum(i, u + v[i]*cos(q[i]))"
[claims]
conserved = ["energy", "P"]
"""
    assert all(each.verdict is Verdict.PROVED for each in prove(read(text)).claims)


def test_the_bracket_of_many_coupled_links_is_not_examined(monkeypatch):
    """It would take minutes; the certificate says that it was not, and why."""
    monkeypatch.setattr("coadjoint.prove.almost_poisson.SOLVED", 3)
    motion = motion_of(derive(shipped("n_link_chain")))
    ((statement, kind, examine),) = about_reduced_jacobi(motion)
    assert kind == "jacobi"
    assert "not examined: 4 unknowns are solved for together, more than 3" in statement
    assert examine() == Discovery("no search")
