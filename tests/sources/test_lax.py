"""Lax pairs, Manakov's bodies and the Bloch-Iserles system as Holm (2011) has them.

Sections 2.4.2 to 2.4.5, 2.5.6, C.1.3 and C.4, each with its spoiled twin. Matrices are written as
functions of places here and compared at exact random points.
"""

from fractions import Fraction
from itertools import combinations

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.derive.assembly import make_setting as with_symbols
from coadjoint.derive.integrals import expanded_traces, lax_integrals, pair_of, slope_row
from coadjoint.derive.mechanics.planes import find_pair
from coadjoint.derive.pairs import LaxPair
from coadjoint.errors import AlgebraError, DerivationError
from coadjoint.exact import Field
from coadjoint.exact.dense import combine, commutator, diagonal, product
from coadjoint.exact.ranks import generic_rank
from coadjoint.prove import Verdict
from coadjoint.prove.lax import lax_decision
from tests.specs import RIGID_BODY, prove_claims, shipped, spec, unitless


def text_of(name):
    """The text of a shipped spec, without units, which wrong pairs would not fit."""
    return unitless(shipped(name).path.read_text(encoding="utf-8"))


def changed(name, *changes):
    """A shipped spec with some pieces replaced."""
    return spec(text_of(name), *changes, name=name)


def refuted(declared):
    """What a certificate refutes, as (kind, statement, method)."""
    return [(c.kind, c.statement, c.method) for c in prove_claims(declared).refuted]


def planes(size):
    """The matrices ``e_i e_j^T - e_j e_i^T`` of so(n) as a spec declares them; so(3) has others."""
    tables = []
    for i, j in combinations(range(size), 2):
        rows = [[0] * size for _ in range(size)]
        rows[i][j], rows[j][i] = 1, -1
        tables.append(f"E{i + 1}{j + 1} = {rows}")
    return f"matrices = {{ {', '.join(tables)} }}"


def body(size):
    """Manakov's body in some dimension, found by the route manakov alone."""
    text = text_of("manakov_so4")
    first = text.index("casimirs  =")
    return spec(
        text,
        (text[first : text.index("conserved =")], ""),
        (text[text.index("[lax]") : text.index("[claims]")], ""),
        ('"matrix-euler-poincare", "lie-poisson", "lax", "manakov"', '"manakov"'),
        ('name       = "so(4)"', planes(size)),
        ("= [4]", f"= [{size}]"),
        ("[1, 2, 3, 4]", str(list(range(1, size + 1)))),
        name=f"so{size}",
    )


# -- 2.4.2: Manakov's body ------------------------------------------------------------------------


def test_2_4_2_manakov_body():
    """``M_ij = (a_i + a_j) Omega_ij`` and ``H = -tr(M Omega)/4 = sum M_ij^2/(2 (a_i + a_j))``."""
    setting = make_setting(shipped("manakov_so4"))
    equations, field = derive(setting.spec, setting=setting), setting.field
    total = field.zero
    for i in range(1, 5):
        for j in range(i + 1, 5):
            m, velocity = field[f"M{i}{j}"], dict(equations.exact.definitions)[f"Omega{i}{j}"]
            both = field[f"a{i}"] + field[f"a{j}"]
            assert velocity == m / both
            total = total + m**2 / (2 * both)
    assert equations.exact.energy == total


def test_2_4_2_three_dimensions_have_the_moments_of_the_book():
    """``I_1 = a_2 + a_3`` and so on: the pair of the rigid body has ``2 a_1 = I_2 + I_3 - I_1``."""
    declared = spec(RIGID_BODY, ('"lie-poisson"]', '"manakov"]'))
    setting = make_setting(declared)
    pair, field = find_pair(setting), setting.field
    I = [field[f"I{n}"] for n in (1, 2, 3)]  # noqa: E741 (the book's letter)
    half = sum(I, field.zero) / 2
    for n in range(3):
        assert field.coefficients(pair.M[n][n], "lambda")[1] == half - I[n]
        assert field.coefficients(pair.L[n][n], "lambda")[1] == (half - I[n]) ** 2
    assert pair.L[0][1] == -field["Pi3"]
    assert pair.M[0][1] == -field["Omega3"]
    assert not refuted(declared)


# -- 2.4.3: matrix Euler-Poincare -----------------------------------------------------------------


@pytest.mark.parametrize("name", ["manakov_so4", "quadratic_potential_so3"])
def test_2_4_3_matrix_euler_poincare(name):
    """``dM/dt = M Omega - Omega M (+ A S - S A)``, entry by entry, from products of matrices."""
    setting = make_setting(shipped(name))
    equations, field = derive(setting.spec, "matrix-euler-poincare", setting=setting), setting.field
    M, Omega = setting.values["M"], setting.values["Omega"]
    size = range(len(M))
    rates = dict(zip(setting.state, equations.exact.rates, strict=True))
    for i in size:
        for j in size[i + 1 :]:
            torque = field.zero
            if "S" in setting.values:
                a, S = setting.values["a"], setting.values["S"]
                torque = (a[i] - a[j]) * S[i][j]
            turned = sum((M[i][k] * Omega[k][j] - Omega[i][k] * M[k][j] for k in size), field.zero)
            assert rates[f"M{i + 1}{j + 1}"] == turned + torque
            assert turned != 0


def test_c_1_3_body_in_four_dimensions_by_matrices():
    """``dM/dt = M x Omega + N x Lambda``, ``dN/dt = N x Omega + M x Lambda``, by 4 x 4 matrices."""
    planes = {"J1": (3, 2), "J2": (1, 3), "J3": (2, 1), "K1": (1, 4), "K2": (2, 4), "K3": (3, 4)}
    tables = []
    for name, (i, j) in planes.items():
        rows = [[0] * 4 for _ in range(4)]
        rows[i - 1][j - 1], rows[j - 1][i - 1] = 1, -1
        tables.append(f"{name} = {rows}")
    text = "\n".join(
        (
            'title = "Body in R^4"\nroutes = ["euler-poincare", "matrix-euler-poincare"]',
            "[algebra.blocks]\nJ = ['J1', 'J2', 'J3']\nK = ['K1', 'K2', 'K3']\n[algebra.matrices]",
            *tables,
            '[variables]\nOmega = { role = "velocity", block = "J" }',
            'Lambda = { role = "velocity", block = "K" }\nM = { role = "momentum", block = "J" }',
            'N = { role = "momentum", block = "K" }\n[parameters]\nI = { shape = [6] }',
            "[lagrangian]\nl = '''(I1*Omega1^2 + I2*Omega2^2 + I3*Omega3^2",
            "+ I4*Lambda1^2 + I5*Lambda2^2 + I6*Lambda3^2)/2'''",
        )
    )
    setting = make_setting(spec(text, name="four"))
    found = derive(setting.spec, "matrix-euler-poincare", setting=setting).exact.rates
    M, N, Omega, Lambda = (
        [setting.field[f"{name}{n}"] for n in (1, 2, 3)] for name in ("M", "N", "Omega", "Lambda")
    )

    def cross(a, b, n):
        i, j = (n + 1) % 3, (n + 2) % 3
        return a[i] * b[j] - a[j] * b[i]

    for n in range(3):
        assert found[n] == cross(M, Omega, n) + cross(N, Lambda, n)
        assert found[n + 3] == cross(N, Omega, n) + cross(M, Lambda, n)
    assert not refuted(setting.spec)


# -- 2.4.4: the isospectral problem ---------------------------------------------------------------


def test_2_4_4_isospectral():
    """``d(M + lambda A^2)/dt = [M + lambda A^2, Omega + lambda A]`` for every lambda."""
    setting = make_setting(shipped("manakov_so4"))
    field, lam = setting.field, setting.field["lambda"]
    M, Omega, a = (setting.values[name] for name in ("M", "Omega", "a"))
    size = range(4)
    L = [[M[i][j] + (lam * a[i] ** 2 if i == j else 0) for j in size] for i in size]
    B = [[Omega[i][j] + (lam * a[i] if i == j else 0) for j in size] for i in size]
    pair = pair_of(setting)
    assert [list(row) for row in pair.L] == L
    assert [list(row) for row in pair.M] == B
    first = derive(setting.spec, setting=setting)
    rates = dict(zip(setting.state, first.exact.rates, strict=True))
    for i in size:
        for j in size[i + 1 :]:
            turned = sum((L[i][k] * B[k][j] - B[i][k] * L[k][j] for k in size), field.zero)
            assert first.close(turned - rates[f"M{i + 1}{j + 1}"]) == 0


@pytest.mark.parametrize(
    ("change", "where"),
    [
        (('"Omega + lambda*diag(a)"', '"Omega - lambda*diag(a)"'), "lambda^1"),
        (('"Omega + lambda*diag(a)"', '"-Omega + lambda*diag(a)"'), "lambda^0"),
        (('"M + lambda*diag(a)^2"', '"M + lambda*diag(a)"'), "lambda^1"),
        (('"Omega + lambda*diag(a)"', '"Omega + lambda^2*diag(a)"'), "lambda^1"),
    ],
)
def test_2_4_4_another_pair_is_refuted(change, where):
    """A wrong sign or power in either matrix is refuted, with its entry and its power."""
    found = [method for kind, _, method in refuted(changed("manakov_so4", change)) if kind == "lax"]
    assert len(found) == 1
    assert f"in the entry (1, 2) at {where} of dL/dt - [L, M]" in found[0]


# -- 2.4.5: Manakov's integrals, and P1 -----------------------------------------------------------


@pytest.mark.parametrize(("size", "count"), [(2, 1), (3, 2), (4, 4), (5, 6), (6, 9)])
def test_2_4_5_manakov_integrals(size, count):
    """In n = 2, ..., 6 dimensions the pair has 1, 2, 4, 6, 9 independent integrals."""
    setting = make_setting(body(size))
    found = lax_integrals(setting)
    rows = [slope_row(setting, each.value) for each in found.coefficients]
    assert generic_rank(setting.field, rows) == count
    # the energy is one of them, so one less is emitted beside it
    assert len(found.emitted) == count - 1
    # nontrivial are k - p even and at least 2
    assert {(e.trace, e.power) for e in found.coefficients} == {
        (k, p) for k in range(2, size + 1) for p in range(k - 1) if (k - p) % 2 == 0
    }


def test_2_4_5_the_count_of_integrals_is_found_with_its_scope():
    """That coefficients depend on the emitted ones rests on ranks: no proof, an error in words."""
    (finding,) = prove_claims(shipped("manakov_so4")).findings
    assert finding.statement.startswith("4 independent integrals: the coefficients of tr L^k")
    assert finding.scope == "near almost every point, for almost all parameters"
    assert "probability below" in finding.error


def test_2_4_5_manakov_integrals_in_seven_dimensions():
    """There are 12, here with a_i = 1, ..., 7, for which the traces are short enough to expand."""
    setting = make_setting(body(7))
    field, pair = setting.field, find_pair(setting)
    numbers = {f"a{n}": field.number(n) for n in range(1, 8)}
    L = tuple(tuple(field.substitute(entry, numbers) for entry in row) for row in pair.L)
    found = expanded_traces(setting, LaxPair(pair.spectral, L, pair.M, pair.texts))
    rows = [slope_row(setting, each.value) for each in found]
    assert len(rows) == generic_rank(field, rows) == 12


def test_2_4_5_equal_moments_have_fewer_integrals():
    """The count is a property of the pair: it falls where the a_i are equal."""
    setting = make_setting(shipped("manakov_so4"))
    same = {f"a{n}": setting.field["a1"] for n in (2, 3, 4)}
    values = [setting.field.substitute(e.value, same) for e in lax_integrals(setting).coefficients]
    rows = [slope_row(setting, value) for value in values]
    assert generic_rank(setting.field, rows) == 2


def test_p1_the_integral_of_the_fourth_power():
    """``4 tr A^4 M^2 + 2 tr A^2 M A^2 M`` is conserved; the printed 2, 4 with A in place is not."""
    right = "4*trace(diag(a)^4*M*M) + 2*trace(diag(a)^2*M*diag(a)^2*M)"
    printed = "2*trace(diag(a)^4*M*M) + 4*trace(diag(a)^2*M*diag(a)^2*M)"
    unsquared = "4*trace(diag(a)^2*M*M) + 2*trace(diag(a)*M*diag(a)*M)"
    first = "trace(diag(a)*M*M)"
    for formula, holds in ((right, True), (printed, False), (unsquared, False), (first, False)):
        old = 'conserved = ["energy"]'
        declared = changed("manakov_so4", (old, f'conserved = ["energy", "{formula}"]'))
        found = [statement for _, statement, _ in refuted(declared)]
        assert found == ([] if holds else [f"{formula} is conserved"])


# -- 2.5.6: the quadratic potential, and P2 -------------------------------------------------------


@pytest.mark.parametrize("name", ["quadratic_potential_so3", "quadratic_potential_so4"])
def test_2_5_6_quadratic_potential(name):
    """``-S + lambda M + lambda^2 A^2`` turns by ``Omega + lambda A``: n(n - 1)/2 more integrals."""
    setting = make_setting(shipped(name))
    found, declared = find_pair(setting), pair_of(setting)
    assert found.L == declared.L
    assert found.M == declared.M
    lam, field = setting.field["lambda"], setting.field
    size = len(found.L)
    for i in range(size):
        for j in range(size):
            S, M = setting.values["S"][i][j], setting.values["M"][i][j]
            square = setting.values["a"][i] ** 2 if i == j else field.zero
            assert found.L[i][j] == -S + lam * M + lam**2 * square
    assert len(lax_integrals(setting).emitted) == size * (size - 1) // 2 - 1  # one is the energy


def test_2_5_6_torque_in_three_dimensions():
    """``[A, S]`` is the torque ((a3 - a2) S23, (a1 - a3) S31, (a2 - a1) S12) along J1, J2, J3."""
    setting = make_setting(shipped("quadratic_potential_so3"))
    field = setting.field
    rates = derive(setting.spec, setting=setting).exact.rates
    still = dict.fromkeys(("M12", "M13", "M23"), field.zero)
    torque = [
        field.substitute(rate, still | {f"Omega{n}": field.zero for n in (12, 13, 23)})
        for rate in rates[:3]
    ]
    a, S = setting.values["a"], setting.values["S"]
    # J3 = E21, J2 = E13, J1 = E32
    assert torque[0] == -(a[1] - a[0]) * S[0][1]
    assert torque[1] == (a[0] - a[2]) * S[2][0]
    assert torque[2] == -(a[2] - a[1]) * S[1][2]


def test_p2_the_sign_of_the_potential():
    """The printed ``+S`` is refuted for ``V = +tr(SA)/2``, and proved for ``V = -tr(SA)/2``."""
    printed = ('"-S + lambda*M', '"S + lambda*M')
    kinds = [kind for kind, *_ in refuted(changed("quadratic_potential_so3", printed))]
    assert "lax" in kinds
    other = ("- trace(S*diag(a))/2", "+ trace(S*diag(a))/2")
    assert not refuted(changed("quadratic_potential_so3", printed, other))


def test_2_5_6_exercise_unitary_analogue():
    """With M in u(n) and S Hermitian, as real matrices, the same pair holds and M stays in u(n)."""
    # M + iN is [[M, -N], [N, M]]: the pair on such 4 x 4 matrices with A = diag(a1, a2, a1, a2)
    names = ["m", "n1", "n2", "n3", "s1", "s2", "s3", "s4", "a1", "a2", "lambda"]
    field = Field(names)
    m, n1, n2, n3, s1, s2, s3, s4, a1, a2, lam = (field[name] for name in names)
    zero = field.zero

    def real(x, y):
        """``x + iy`` for 2 x 2 matrices."""
        top = [(*x[i], *(-value for value in y[i])) for i in range(2)]
        return (*top, *((*y[i], *x[i]) for i in range(2)))

    M = real(((zero, m), (-m, zero)), ((n1, n2), (n2, n3)))  # anti-Hermitian
    S = real(((s1, s2), (s2, s3)), ((zero, s4), (-s4, zero)))  # Hermitian
    a = (a1, a2, a1, a2)
    A, square = diagonal(a), diagonal([x**2 for x in a])
    Omega = tuple(tuple(M[i][j] / (a[i] + a[j]) for j in range(4)) for i in range(4))
    one = field.one
    dM = combine((one, commutator(M, Omega)), (one, commutator(A, S)))
    dS = commutator(S, Omega)
    L = combine((-one, S), (lam, M), (lam**2, square))
    B = combine((one, Omega), (lam, A))
    left = combine((-one, dS), (lam, dM))
    assert commutator(L, B) == left
    spoiled = combine((one, S), (lam, M), (lam**2, square))
    assert commutator(spoiled, B) != combine((one, dS), (lam, dM))
    for matrix, sign in ((dM, -1), (dS, 1)):  # anti-Hermitian and Hermitian, as real matrices
        assert any(x != 0 for row in matrix for x in row)
        assert all(matrix[i][j] == sign * matrix[j][i] for i in range(4) for j in range(4))


# -- C.4: Bloch-Iserles, and P3 -------------------------------------------------------------------


@pytest.mark.parametrize(("name", "size"), [("bloch_iserles_2", 2), ("bloch_iserles_3", 3)])
def test_c_4_bloch_iserles(name, size):
    """``dX/dt = X^2 N - N X^2`` by every route, and the pair with ``lambda N^2``."""
    setting = make_setting(shipped(name))
    X, N = setting.values["X"], setting.values["N"]
    square = product(X, X)
    expected = commutator(square, N)
    for route in setting.spec.routes:
        equations = derive(setting.spec, route, setting=setting)
        rates = iter(equations.exact.rates)
        for i in range(size):
            for j in range(i, size):
                assert equations.close(next(rates)) == expected[i][j] != 0


def test_c_4_the_velocity_is_the_sum_over_the_basis():
    """V is ``sum V_ij e_ij``, so its entry (1, 2) is ``V12/2`` and equals ``X12``."""
    setting = make_setting(shipped("bloch_iserles_2"))
    field = setting.field
    assert setting.values["V"][0][1] == field["V12"] / 2
    assert setting.values["V"][0][0] == field["V11"]
    definitions = dict(derive(setting.spec, setting=setting).exact.definitions)
    assert definitions["V12"] == 2 * field["X12"]


@pytest.mark.parametrize(
    ("name", "noticed"), [("bloch_iserles_2", False), ("bloch_iserles_3", True)]
)
def test_p3_the_printed_power_of_lambda(name, noticed):
    """``lambda^2 N^2`` for ``lambda N^2`` is refuted for n = 3; with n = 2 nobody notices."""
    found = refuted(changed(name, ('lambda*N^2"', 'lambda^2*N^2"')))
    assert ["lax"] * noticed == [kind for kind, *_ in found]
    if noticed:
        assert "at lambda^1 of dL/dt - [L, M]" in found[0][2]


@pytest.mark.parametrize("bracket_", ["X*N*Y + Y*N*X", "X*N*Y", "X*Y - Y*X", "Y*N*X - 2*X*N*Y"])
def test_c_4_another_bracket_is_no_lie_algebra(bracket_):
    """Brackets that are not antisymmetric, or leave the symmetric matrices, are refused."""
    with pytest.raises(AlgebraError, match=r"E1\d.*E"):
        changed("bloch_iserles_2", ("X*N*Y - Y*N*X", bracket_))


# -- what is found, and what is not ---------------------------------------------------------------


def test_a_pair_is_found_for_every_inertia_of_manakov():
    """``I_ij = (b_i - b_j)/(a_i - a_j)`` is more than ``a_i + a_j``, and has its pair, too."""
    inertia = "+".join(
        f"(b{i} - b{j})/(a{i} - a{j})*Omega{i}{j}^2/2" for i in range(1, 5) for j in range(i + 1, 5)
    )
    declared = changed(
        "manakov_so4",
        ("trace(transpose(Omega)*diag(a)*Omega)/2", inertia),
        ("[lagrangian]", "[parameters.b]\nshape = [4]\n\n[lagrangian]"),
        (LAX_OF_SO4, ""),
        (', "lax", "manakov"', ""),
    )
    setting = with_symbols(declared, ("lambda",))  # its traces are long, and not wanted here
    pair = find_pair(setting)
    assert setting.field.coefficients(pair.M[3][3], "lambda") != {}
    assert lax_decision(derive(declared, setting=setting), pair).verdict is Verdict.PROVED


LAX_OF_SO4 = text_of("manakov_so4")[
    text_of("manakov_so4").index("[lax]") : text_of("manakov_so4").index("[claims]")
]


def test_a_body_without_a_pair_is_refused():
    """Six moments of inertia at will have no pair in four dimensions: the last plane says so."""
    inertia = "+".join(
        f"b{n}*Omega{place}^2/2" for n, place in enumerate((12, 13, 14, 23, 24, 34), 1)
    )
    declared = changed(
        "manakov_so4",
        ("trace(transpose(Omega)*diag(a)*Omega)/2", inertia),
        ("[lagrangian]", "[parameters.b]\nshape = [6]\n\n[lagrangian]"),
        (LAX_OF_SO4, ""),
        ('"lax", ', ""),
    )
    with pytest.raises(
        DerivationError, match=r"I_ij\*\(a_i - a_j\) = b_i - b_j.*\(3, 4\).*I_34 = b6"
    ):
        derive(declared, "manakov")


def test_a_pair_that_was_found_is_examined():
    """The claim holds the found pair against the emitted rates: a spoiled one is refuted."""
    setting = make_setting(shipped("manakov_so4"))
    first, pair = derive(setting.spec, setting=setting), find_pair(setting)
    assert lax_decision(first, pair).verdict is Verdict.PROVED
    spoiled = LaxPair(
        pair.spectral,
        pair.L,
        combine((setting.field.number(-1), pair.M)),
        pair.texts,
    )
    decision = lax_decision(first, spoiled)
    assert decision.verdict is Verdict.REFUTED
    assert Fraction(decision.defect) != 0
