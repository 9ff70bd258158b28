"""Sizes that the number of members gives: algebras and shapes of the size that is chosen."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import LimitError, SpecError
from coadjoint.prove import prove
from coadjoint.prove.certificate import Verdict
from tests.families import read

BODY = """
title = "Rigid body in n dimensions"
routes = ["lie-poisson"]
[index]
i = { size = 4, first = 1, count = "n" }
[algebra]
name = "so(n)"
[variables]
M = { role = "momentum", form = "antisymmetric" }
[parameters]
a = { shape = ["n"], positive = true, default = [1, 2, 3, 4] }
b = { shape = ["2n", "n-1"], default = 1 }
[hamiltonian]
h = "sum(i, j, i < j, M[i, j]^2/(2*(a[i] + a[j])))"
[claims]
conserved = ["energy", "trace(M*M*diag(a)*diag(a))", "trace(M*M*diag(a))"]
"""


@pytest.mark.parametrize("n", [4, 5])
def test_the_body_turns_as_manakov_says(n):
    """dM/dt = [M, Omega] with Omega_ij = M_ij/(a_i + a_j), by matrices of its own."""
    equations = derive(read(BODY, sizes={"i": n}))
    assert len(equations.rates) == n * (n - 1) // 2
    a = sympy.symbols(f"a1:{n + 1}")
    known = {x.name: x for x in equations.state}

    def entry(i, j):
        x = known[f"M{min(i, j) + 1}{max(i, j) + 1}"] if i != j else sympy.S.Zero
        return x if i < j else -x

    M = sympy.Matrix(n, n, entry)
    Omega = sympy.Matrix(n, n, lambda i, j: M[i, j] / (a[i] + a[j]))
    turned = M * Omega - Omega * M
    for name, rate in zip(equations.variables, equations.rates, strict=True):
        i, j = int(name[1]) - 1, int(name[2]) - 1
        assert sympy.simplify(rate - turned[i, j]) == 0, name


def test_claims_say_the_size():
    """Manakov's integral is proved and a wrong one refuted, each for the size that is loaded."""
    claims = prove(read(BODY)).claims
    said = {claim.statement: claim.verdict for claim in claims}
    assert all(statement.endswith("for n = 4") for statement in said)
    assert said["trace(M*M*diag(a)*diag(a)) is conserved, for n = 4"] is Verdict.PROVED
    assert said["trace(M*M*diag(a)) is conserved, for n = 4"] is Verdict.REFUTED


def test_a_list_of_defaults_is_one_for_the_declared_size_alone():
    """One number is a default for every size."""
    (a, b), (other, _) = (read(BODY, sizes={"i": n}).parameters for n in (4, 5))
    assert a.default == tuple(map(Fraction, range(1, 5)))
    assert (b.shape, set(b.default)) == ((8, 3), {Fraction(1)})
    assert other.default is None


def test_any_name_of_an_algebra_may_have_the_number():
    """Also within another one, in an action, and times a factor."""
    changes = ('name = "so(n)"', 'direct_sum = ["sp(2n)", "R^n"]'), (', form = "antisymmetric"', "")
    energy = "sum(i, j, i < j, M[i, j]^2/(2*(a[i] + a[j])))", "dot(M, M)"
    plain = BODY.split("[claims]")[0].replace('shape = ["n"]', "shape = [4]")
    spec = read(plain, *changes, energy, sizes={"i": 2})
    assert len(spec.state[0].components) == 10 + 2


BAD = [
    (('["n"]', '["m"]'), {}, "the size 'm' is no number; expected a number, or n"),
    (("so(n)", "so(m)"), {}, "the size 'm' is no number"),
    (('"n-1"', '"n-4"'), {}, "the size 'n-4' is 0; expected 1 or more"),
    (("size = 4, ", ""), {}, "a size in the name of an algebra or in a shape counts them; no size"),
    (('i = { size = 4, first = 1, count = "n" }', "i = { size = 4 }"), {}, "no number"),
]


@pytest.mark.parametrize(("change", "sizes", "said"), BAD)
def test_bad_sizes_are_refused_at_their_place(change, sizes, said):
    """With what was found."""
    with pytest.raises(SpecError) as caught:
        read(BODY, change, sizes=sizes)
    assert said in str(caught.value)
    assert caught.value.line > 1


def test_without_an_index_nothing_is_counted():
    """The advice declares one, and more members than a state may have are refused."""
    index = '[index]\ni = { size = 4, first = 1, count = "n" }\n'
    with pytest.raises(SpecError, match=r"Declare what it counts: \[index\] i = \{ size = 8"):
        read(BODY, (index, ""), ('name = "so(n)"', 'name = "so(4)"'))
    with pytest.raises(LimitError, match="STATE_COMPONENTS"):
        read(BODY, sizes={"i": 5000})
