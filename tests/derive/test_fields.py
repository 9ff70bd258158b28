"""Fields along space: jets, equations of strands, magnets and motions of the circle."""

import re

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive, make_setting
from coadjoint.derive.fields.circle import close, inertia_along
from coadjoint.derive.fields.jets import DEGREE, Jets, jets_of, list_rows
from coadjoint.derive.fields.operators import Term, adjoint, apply, expand, order_of
from coadjoint.derive.fields.symbol import look_at_symbol
from coadjoint.errors import DerivationError
from coadjoint.exact import Field
from coadjoint.spec import read_spec_text
from tests.specs import emitted, shipped

STRAND = shipped("spin_chain").path.read_text(encoding="utf-8")


def spec_of(text):
    """A spec of a text."""
    return read_spec_text(text, "strand.toml")


def jets_of_u(depth=6):
    """One field and its derivatives."""
    tower = ("u", *(f"u_{'s' * n}" for n in range(1, depth + 1)))
    return Jets(Field([*tower, "c", DEGREE]), {"u": (tower,)})


def test_the_euler_operator_is_the_variational_derivative():
    """Of KdV's third integral u^3/2 - c u_s^2/2 it is 3u^2/2 + c u_ss, as by hand."""
    jets = jets_of_u()
    u, u_s, u_ss, c = (jets.field[x] for x in ("u", "u_s", "u_ss", "c"))
    assert jets.euler(u**3 / 2 - c * u_s**2 / 2, "u") == u**2 * 3 / 2 + c * u_ss


@pytest.mark.parametrize("power", [1, 2, 3])
def test_a_total_derivative_has_no_variation_and_is_integrated(power):
    """E D P = 0, and the homotopy formula finds P again; what is none has a variation."""
    jets = jets_of_u()
    P = jets.field["u"] ** power * jets.field["u_ss"] + jets.field["u_s"] ** 2
    f = jets.total(P)
    assert jets.euler(f, "u") == 0
    assert jets.integrate(f) == (P,)
    assert jets.euler(f + jets.field["u_s"] ** 2, "u") != 0


def test_a_part_of_degree_zero_is_not_integrated():
    """u_s/u is the derivative of a logarithm, about which the formula says nothing."""
    jets = jets_of_u()
    assert jets.integrate(jets.field["u_s"] / jets.field["u"]) is None
    assert jets.integrate(1 / (1 + jets.field["u"] ** 2)) is None
    rows = list_rows("w", ["x", "y"], 2)
    plane = Jets(Field([*(x for row in rows for x in row), DEGREE]), {"w": rows})
    w, *slopes = (plane.field[x] for x in ("w", "w_x", "w_y", "w_xy"))
    assert plane.still(w**2 + plane.field.sum(slopes)) == w**2  # what tells it from a constant


def test_operators_keep_the_order_of_factors():
    """(u D + D u) f = 2 u f_s + u_s f, and it is minus its adjoint."""
    jets, one = jets_of_u(), jets_of_u().field.one
    u, u_s = jets.field["u"], jets.field["u_s"]
    both = ((Term(u, 1, one), Term(one, 1, u)),)
    assert expand(both[0], jets) == {(0, 0): u_s, (1, 0): 2 * u}
    assert apply((both,), [u], jets.total) == (3 * u * u_s,)
    turned = adjoint((both,))[0][0]
    assert expand((*both[0], *turned), jets) == {}


def test_operators_are_expanded_by_the_rule_of_leibniz():
    """D^2 u = u_ss + 2 u_s D + u D^2, and D_x D_y^2 w with the binomials of both."""
    jets, one = jets_of_u(), jets_of_u().field.one
    u, u_s, u_ss = (jets.field[x] for x in ("u", "u_s", "u_ss"))
    assert expand([Term(one, 2, u)], jets) == {(0, 0): u_ss, (1, 0): 2 * u_s, (2, 0): u}
    rows = list_rows("w", ["x", "y"], 4)
    plane = Jets(Field([*(x for row in rows for x in row), DEGREE]), {"w": rows})
    w, w_x, w_y, w_xy, w_yy, w_xyy = (
        plane.field[f"w{end}"] for end in ("", "_x", "_y", "_xy", "_yy", "_xyy")
    )
    known = {(0, 0): w_xyy, (0, 1): 2 * w_xy, (0, 2): w_x, (1, 0): w_yy, (1, 1): 2 * w_y, (1, 2): w}
    term = Term(plane.field.one, 1, w, 2)
    assert expand([term], plane) == known
    assert order_of((((term,),),)) == 3
    assert [Term(w, i, plane.field.one, j).adjoint.left for i, j in ((0, 1), (1, 1))] == [-1, 1]


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("kdv", ["{m, m} before D = -m", "{m, m} behind D = -m", "{m, m} before D^3 = -c"]),
        ("euler_2d", ["{w, w} before D_x = w_y", "{w, w} before D_y = -w_x"]),
        ("burgers", ["{m, m} before D = -m", "{m, m} behind D = -m"]),
        (
            "landau_lifshitz",  # at points, minus epsilon_abc S_c
            ["{S1, S2} = -S3", "{S1, S3} = S2", "{S2, S3} = -S1"],
        ),
    ],
)
def test_brackets_are_shown_term_by_term(name, lines):
    """Above the diagonal alone, each with its derivative and on which side of it it stands."""
    (step,) = (x for x in emitted(name, "lie-poisson").steps if x.title.startswith("Bracket of"))
    assert [f"{left.text} = {value}" for left, value in step.lines] == lines


# -- strands ------------------------------------------------------------------------------


def test_the_spin_chain_is_the_one_of_the_book():
    """I dOmega/dt = I Omega x Omega + K Xi_s + Xi x K Xi, Xi_t = Omega_s + Xi x Omega.

    Holm, Ivanov and Percival 2012, by vector products at rational points.
    """
    equations, source = emitted("spin_chain"), np.random.default_rng(1)
    field = equations.setting.field
    for _ in range(3):
        I, K = source.integers(1, 9, (2, 3))  # noqa: E741
        Pi, Pi_s, Xi, Xi_s = source.integers(-9, 9, (4, 3))
        values = {f"I{n}": I[n - 1] for n in (1, 2, 3)} | {f"K{n}": K[n - 1] for n in (1, 2, 3)}
        for name, rows in (("Pi{}", Pi), ("Pi{}_s", Pi_s), ("Xi{}", Xi), ("Xi{}_s", Xi_s)):
            values |= {name.format(n): rows[n - 1] for n in (1, 2, 3)}
        exact = {name: sympy.Rational(int(value)) for name, value in values.items()}
        number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
        found = [field.evaluate(rate, exact, number) for rate in equations.exact.rates]
        Omega, Omega_s = Pi / I, Pi_s / I
        expected = [*np.cross(Pi, Omega) + K * Xi_s + np.cross(Xi, K * Xi)]
        expected += [*Omega_s + np.cross(Xi, Omega)]
        np.testing.assert_allclose(np.array(found, dtype=float), expected, atol=1e-12)


@pytest.mark.parametrize("invariance", ["left", "right"])
def test_compatibility_is_that_of_mixed_derivatives_of_matrices(invariance):
    """Xi_t - Omega_s from g = 1 + s X + t Y + s t Z, multiplied out to first order.

    With g^-1 = 1 - s X - t Y the parts without Z are -Y X and -X Y for left, and the other way
    round for right invariance.
    """
    text = STRAND.replace('invariance = "left"', f'invariance = "{invariance}"')
    setting = make_setting(spec_of(text))
    rates = [derive(setting.spec, r, setting=setting).exact.rates for r in setting.spec.routes]
    assert rates[0] == rates[1] == rates[2]
    field, hat = setting.field, sympy.Matrix([[0, -3, 2], [3, 0, -1], [-2, 1, 0]])
    X, Y = (
        hat.subs({}),
        sympy.Matrix([[0, -7, 5], [7, 0, -4], [-5, 4, 0]]),
    )  # hat(1,2,3), hat(4,5,7)
    mixed = X * Y - Y * X if invariance == "left" else Y * X - X * Y
    values = {f"Xi{n}": n for n in (1, 2, 3)} | {"Pi1": 4, "Pi2": 5, "Pi3": 7}
    values |= {f"I{n}": 1 for n in (1, 2, 3)} | {f"Pi{n}_s": 0 for n in (1, 2, 3)}
    exact = {name: sympy.Integer(value) for name, value in values.items()}
    number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
    found = [field.evaluate(rate, exact, number) for rate in rates[0][3:]]
    assert found == [mixed[2, 1], mixed[0, 2], mixed[1, 0]]
    assert any(found)


def test_without_dependence_on_space_the_chain_is_the_rigid_body():
    """With Xi = 0 and no derivatives it is Euler's equation of the shipped free body."""
    chain, body = emitted("spin_chain"), emitted("rigid_body")
    field = chain.setting.field
    still = {
        f"{name}{n}{end}": field.zero
        for name, end in (("Xi", ""), ("Xi", "_s"), ("Pi", "_s"))
        for n in (1, 2, 3)
    }
    own = [str(field.substitute(rate, still)) for rate in chain.exact.rates]
    closed = [str(body.close(rate)) for rate in body.exact.rates]
    assert own == [*closed, "0", "0", "0"]


def test_a_wave_of_equal_fields_solves_the_chiral_model():
    """Omega = Xi = f(s + t) for any f, and the spin chain with other inertia lacks it."""
    for name, solves in (("spin_chain_chiral", True), ("spin_chain", False)):
        equations = emitted(name)
        field = equations.setting.field
        equal = {f"Pi{n}{end}": field[f"Xi{n}{end}"] for n in (1, 2, 3) for end in ("", "_s")}
        rates = [field.substitute(rate, equal) for rate in equations.exact.rates]
        wave = [field[f"Xi{n}_s"] for n in (1, 2, 3)] * 2
        assert all(map(field.is_zero, map(lambda a, b: a - b, rates, wave))) is solves


def test_landau_and_lifshitz_turn_about_the_field():
    """dS/dt = S x (-S_ss - a S - B) for the minus bracket, first component by hand."""
    equations = emitted("landau_lifshitz")
    field = equations.setting.field
    S2, S3, a2, a3, B2, B3 = (field[x] for x in ("S2", "S3", "a2", "a3", "B2", "B3"))
    S2_ss, S3_ss = field["S2_ss"], field["S3_ss"]
    expected = S2 * (-S3_ss - a3 * S3 - B3) - S3 * (-S2_ss - a2 * S2 - B2)
    assert equations.exact.rates[0] == expected


def test_korteweg_and_de_vries():
    """m_t = -3 m m_s - c m_sss by both routes (Ovsienko and Khesin 1987, the signs of P5)."""
    spec = shipped("kdv")
    setting = make_setting(spec)
    m, m_s, m_sss, c = (setting.field[x] for x in ("m", "m_s", "m_sss", "c"))
    for route in spec.routes:
        assert derive(spec, route, setting=setting).exact.rates == (-3 * m * m_s - c * m_sss,)


def test_a_velocity_has_a_mass_and_a_drift():
    """With l = 3 u^2/2 + c u the velocity is (m - c)/3, by both routes: 2 u_s m + u m_s with it."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    text = text.replace('l = "u^2/2"', 'l = "3*u^2/2 + c*u"').replace('central = "c"', "")
    setting = make_setting(spec_of(text.replace('"energy", "M", "J"', '"energy"')))
    m, m_s, c = (setting.field[x] for x in ("m", "m_s", "c"))
    for route in setting.spec.routes:
        (rate,) = derive(setting.spec, route, setting=setting).exact.rates
        assert rate == -(2 * m * m_s + m_s * (m - c)) / 3


def test_advected_quantities_turn_along_a_strand():
    """Of a chain of tops the three routes agree, and the torque is l_Gamma x Gamma."""
    text = STRAND.replace(
        "[parameters]",
        'Gamma = { role = "advected", representation = "vector" }\n\n[parameters]\n'
        "w = { default = 1 }",
    )
    text = text.replace("diag(K)*Xi)/2", "diag(K)*Xi)/2 - w*Gamma3").replace('"P"]', "]")
    setting = make_setting(spec_of(text.replace('"energy", ]', '"energy"]')))
    rates = [derive(setting.spec, r, setting=setting).exact.rates for r in setting.spec.routes]
    assert rates[0] == rates[1] == rates[2]
    field = setting.field
    torque = [field.derivative(rate, "w") for rate in rates[0][:3]]
    assert torque == [field["Gamma2"], -field["Gamma1"], field.zero]  # -e3 x Gamma


# -- refusals -----------------------------------------------------------------------------


def test_an_energy_of_strains_with_the_wrong_sign_is_ill_posed():
    """The message shows how fast waves grow: sqrt(K/I) k, here with sqrt(3)."""
    text = STRAND.replace("- dot(Xi, diag(K)*Xi)/2", "+ dot(Xi, diag(K)*Xi)/2")
    with pytest.raises(DerivationError, match=r"ill posed.*exp\(1\.73\*k\*t\), with k = 10") as e:
        derive(spec_of(text))
    assert "lagrangian.l" in str(e.value)
    assert "Change the sign" in str(e.value)


def test_waves_that_grow_about_all_fields_are_said_to():
    """Without parameters and fields in the symbol there is no place to name."""
    text = STRAND.replace("- dot(Xi, diag(K)*Xi)/2", "+ dot(Xi, Xi)/2")
    text = text.replace("dot(Omega, diag(I)*Omega)/2", "dot(Omega, Omega)/2")
    with pytest.raises(DerivationError, match=r"like exp\(10\*t\), about any fields; expected"):
        derive(spec_of(text))


def test_a_magnet_has_waves_of_imaginary_eigenvalues():
    """Landau and Lifshitz's equation is posed; with a gradient flow backwards it is not."""
    jets, setting = jets_of(emitted("landau_lifshitz").setting), emitted("landau_lifshitz").setting
    rates = list(emitted("landau_lifshitz").exact.rates)
    assert look_at_symbol(setting, jets, rates).growth is None
    assert look_at_symbol(setting, jets, rates).points
    rates[0] -= setting.field["S1_ss"]  # heat that flows from cold to hot
    assert look_at_symbol(setting, jets, rates).growth is not None


def test_heat_that_flows_backwards_grows_with_the_square_of_the_wave_number():
    """S_t = -2 S_ss: e^(iks) has the factor exp(2 k^2 t), with k = 10 exp(200 t)."""
    setting = emitted("landau_lifshitz").setting
    rates = [-2 * setting.field[f"S{n}_ss"] for n in (1, 2, 3)]
    growth = look_at_symbol(setting, jets_of(setting), rates).growth
    assert growth.told.endswith("grows like exp(2*k^2*t), with k = 10 like exp(200*t)")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("diag(K)*Xi)/2", "diag(K)*Xi)/2 - dot(Xi_s, Xi_s)", "names the derivative Xi1_s"),
        (
            "dot(Omega, diag(I)*Omega)/2",
            "dot(Omega, diag(I)*Omega)/2 + Omega1^4",
            "velocities Omega1 have no closed form",
        ),
    ],
)
def test_lagrangians_of_strands_that_are_refused(old, new, message):
    """Each with the way out, the route lie-poisson with a Hamiltonian."""
    assert old in STRAND
    spec = spec_of(STRAND.replace(old, new))
    for route in spec.routes:
        with pytest.raises(DerivationError, match=re.escape(message)) as error:
            derive(spec, route)
        assert "lie-poisson" in str(error.value)


@pytest.mark.parametrize(
    ("l", "message"),
    [
        ("u^4", "no multiple of u at each point"),
        ("L", "no kinetic energy"),
        ("u^2/2 + u*u_s^2", "no linear operator"),
        ("u^2/2 - u_s^2/2", "factor of u_s^2 is -1/2 at the defaults"),
        ("(c - 121/250000)*u^2 + u_s^2/2", "factor of u^2 is 0 at the defaults"),
    ],
)
def test_lagrangians_of_the_circle_that_are_refused(l, message):  # noqa: E741
    """No kinetic energy, none that is a square, and momenta that do not determine the velocity."""
    text = shipped("kdv").path.read_text(encoding="utf-8").replace('l = "u^2/2"', f'l = "{l}"')
    with pytest.raises(DerivationError, match=r"lagrangian\.l: .*expected") as error:
        derive(read_spec_text(text, "kdv.toml"))
    assert message in str(error.value)


def test_camassa_and_holm():
    """m_t + u m_s + 2 m u_s = 0 by both routes, m = u - alpha^2 u_ss (Camassa and Holm 1993)."""
    spec = shipped("camassa_holm")
    setting = make_setting(spec)
    field = setting.field
    m, m_s, u, u_s, u_ss, u_sss = (field[x] for x in ("m", "m_s", "u", "u_s", "u_ss", "u_sss"))
    for route in spec.routes:
        equations = derive(spec, route, setting=setting)
        assert equations.exact.rates == (-u * m_s - 2 * m * u_s,)
        assert equations.exact.energy == m * u / 2
    square = field["alpha"] ** 2
    assert inertia_along(setting) == {0: field.one, 2: -square}
    assert close(setting, m) == u - square * u_ss
    assert close(setting, m_s) == u_s - square * u_sss


def test_more_derivatives_make_another_operator():
    """Of l = (u^2 + u_s^2 + 3 u_ss^2)/2 it is m = u - u_ss + 3 u_ssss."""
    text = shipped("camassa_holm").path.read_text(encoding="utf-8")
    text = text.replace("order = 4", "order = 4, derivatives = 2")
    text = text.replace("u^2/2 + alpha^2*u_s^2/2", "u^2/2 + u_s^2/2 + 3*u_ss^2/2")
    setting = make_setting(read_spec_text(text, "c.toml"))
    one = setting.field.one
    assert inertia_along(setting) == {0: one, 2: -one, 4: 3 * one}


def evaluate(equations, values):
    """Rates at rational points."""
    exact = {name: sympy.Rational(int(value)) for name, value in values.items()}
    field, number = equations.setting.field, lambda x: sympy.Rational(x.numerator, x.denominator)
    return [field.evaluate(rate, exact, number) for rate in equations.exact.rates]


def test_the_rod_is_that_of_simo():
    """Pi_t = Pi x w + P x v + m_s + k x m + e x n, P_t = P x w + n_s + k x n, and k, e likewise.

    With m = K k and n = A (e - e3): Simo, Marsden and Krishnaprasad 1988, by vector products.
    """
    equations, source = emitted("se3_strand"), np.random.default_rng(2)
    I, K, A = source.integers(1, 9, (3, 3))  # noqa: E741
    w, v, k, e, w_s, v_s, k_s, e_s = source.integers(-9, 9, (8, 3))
    values = {"M": 3} | {
        f"{x}{n}": y[n - 1] for x, y in zip("IKA", (I, K, A), strict=True) for n in (1, 2, 3)
    }
    rows = {"Pi{}": I * w, "P{}": 3 * v, "Pi{}_s": I * w_s, "P{}_s": 3 * v_s}
    values |= {name.format(n): row[n - 1] for name, row in rows.items() for n in (1, 2, 3)}
    strains = {"X{}": (*k, *e), "X{}_s": (*k_s, *e_s)}
    values |= {name.format(n): row[n - 1] for name, row in strains.items() for n in range(1, 7)}
    m, n, x = K * k, A * (e - [0, 0, 1]), np.cross
    expected = [
        *(x(I * w, w) + x(3 * v, v) + K * k_s + x(k, m) + x(e, n)),
        *(x(3 * v, w) + A * e_s + x(k, n)),
        *(w_s + x(k, w)),
        *(v_s + x(k, v) + x(e, w)),
    ]
    assert evaluate(equations, values) == [*map(int, expected)]
    assert all(expected)


def test_the_strand_of_symplectic_matrices_is_that_of_the_book():
    """l_T,t + l_S,s = l_T T J - J T l_T + l_S S J - J S l_S, S_t = T_s - [T, S]_J (Holm, C.4).

    Right invariant, by products of matrices; the pairing is tr(A B), so that l_T = T, l_S = -S.
    """
    equations, source = emitted("sp2_strand"), np.random.default_rng(4)
    numbers = source.integers(-9, 9, (4, 3))
    T, T_s, S, S_s = (np.array([[a, b], [b, c]]) for a, b, c in numbers)
    values = {"N12": 1}
    for name, matrix in (("M{}", T), ("M{}_s", T_s), ("S{}", S), ("S{}_s", S_s)):
        twice = 2 if name.startswith("S") else 1  # the component is that along E12, half a unit
        parts = {"11": matrix[0, 0], "12": twice * matrix[0, 1], "22": matrix[1, 1]}
        values |= {name.format(place): part for place, part in parts.items()}
    J = np.array([[0, -1], [1, 0]])
    rate = S_s + T @ T @ J - J @ T @ T - S @ S @ J + J @ S @ S
    strain = T_s - (T @ J @ S - S @ J @ T)
    expected = [rate[0, 0], rate[0, 1], rate[1, 1], strain[0, 0], 2 * strain[0, 1], strain[1, 1]]
    assert evaluate(equations, values) == [*map(int, expected)]
    assert any(expected)


def test_a_symbol_with_a_jordan_block_is_told_apart():
    """Waves of u_t = v_s, v_t = 0 grow linearly: all eigenvalues are 0, of one block."""
    equations = emitted("spin_chain")
    setting, jets = equations.setting, jets_of(equations.setting)
    rates = list(equations.exact.rates)
    assert look_at_symbol(setting, jets, rates).is_diagonalizable
    rates[3] = setting.field.zero
    seen = look_at_symbol(setting, jets, rates)
    assert seen.growth is None
    assert not seen.is_diagonalizable


@pytest.mark.parametrize(
    ("sign", "slopes", "growth"),
    [("+", "Xi", ""), ("-", "Xi", r"exp\(1\*k\^2\*t\)"), ("-", "Pi", r"exp\(1\*k\^2\*t\)")],
)
def test_orders_that_differ_by_rows_are_weighed(sign, slopes, growth):
    """With h = (Pi^2 + Xi^2 - Xi_s^2)/2 w^2 = k^2 - k^4, though the symbol of order 3 is nilpotent.

    With the derivatives of Pi it is the same; with the other sign all frequencies are real.
    """
    text = STRAND[: STRAND.index("[lagrangian]")].replace('"euler-poincare", ', "")
    text = text.replace(', "hamilton-pontryagin"', "").replace(
        "order = 4", "order = 4, derivatives = 1"
    )
    text += (
        f'[hamiltonian]\nh = "dot(Pi, Pi)/2 + dot(Xi, Xi)/2 {sign} dot({slopes}_s, {slopes}_s)/2"\n'
    )
    if not growth:
        assert derive(spec_of(text)).exact.rates
        return
    with pytest.raises(DerivationError, match=f"terms of all orders, are complex.*{growth}"):
        derive(spec_of(text))


def test_a_travelling_rotation_solves_the_chain_of_any_bodies():
    """Omega = W(t - s/c), Xi = -W/c with J dW/dt = J W x W, J = I - K/c^2, for any I, K, W and c.

    It tests the terms of the momentum equation for general I and K at random rational points.
    """
    equations, source = emitted("spin_chain"), np.random.default_rng(6)
    number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
    for _ in range(2):
        I, K, W = (sympy.Matrix([int(x) for x in row]) for row in source.integers(1, 9, (3, 3)))  # noqa: E741
        c = sympy.Integer(11)
        J = sympy.Matrix([i - k / c**2 for i, k in zip(I, K, strict=True)])
        JW = J.multiply_elementwise(W)
        slope = JW.cross(W).multiply_elementwise(J.applyfunc(lambda x: 1 / x))  # dW/dt
        values = {"L": sympy.Integer(1)}
        for n in range(3):
            values |= {f"I{n + 1}": I[n], f"K{n + 1}": K[n]}
            values |= {f"Pi{n + 1}": I[n] * W[n], f"Pi{n + 1}_s": -I[n] * slope[n] / c}
            values |= {f"Xi{n + 1}": -W[n] / c, f"Xi{n + 1}_s": slope[n] / c**2}
        rates = [equations.setting.field.evaluate(r, values, number) for r in equations.exact.rates]
        assert rates == [*I.multiply_elementwise(slope), *(-slope / c)]
        assert any(slope)


def test_the_law_of_a_strand_is_shown_as_in_the_chapter():
    """dmu/dt = ad*_xi mu + ad*_Xi nu - d nu/ds, without a torque where nothing is advected."""
    laws = [step.text for step in emitted("spin_chain").steps]
    (law,) = (each for each in laws if "d nu/ds" in each)
    assert law.startswith("dmu/dt = ad*_xi mu + ad*_Xi nu - d nu/ds,")
    text = STRAND.replace(
        "[parameters]",
        'Gamma = { role = "advected", representation = "vector" }\n\n[parameters]\n'
        "w = { default = 1 }",
    )
    text = text.replace("diag(K)*Xi)/2", "diag(K)*Xi)/2 - w*Gamma3").replace(
        '["energy", "P"]', "[]"
    )
    assert any("+ dl/da <> a - d nu/ds" in step.text for step in derive(spec_of(text)).steps)


# -- two times ----------------------------------------------------------------------------


def rates_with_two_times(values):
    """dPi/dt = Pi x Omega + N x Xi - N_s, dXi/dt = Omega_s + Xi x Omega (Holm, C.1.1), by products.

    Pi = I Omega + B Xi and N = B Omega - K Xi.
    """
    I, B, K, W, V, W_s, V_s = (sympy.Matrix(row) for row in values)  # noqa: E741
    Pi, N, N_s = (
        a.multiply_elementwise(x) + sign * b.multiply_elementwise(y)
        for a, x, sign, b, y in ((I, W, 1, B, V), (B, W, -1, K, V), (B, W_s, -1, K, V_s))
    )
    return [*(Pi.cross(W) + N.cross(V) - N_s), *(W_s + V.cross(W))]


def at_two_times(values):
    """The rates of the shipped system at these velocities."""
    I, B, K, W, V, W_s, V_s = values  # noqa: E741
    rows = {"I": I, "B": B, "K": K, "Xi": V, "Xi{}_s": V_s}
    rows["Pi"] = [i * w + b * v for i, b, w, v in zip(I, B, W, V, strict=True)]
    rows["Pi{}_s"] = [i * w + b * v for i, b, w, v in zip(I, B, W_s, V_s, strict=True)]
    named = {(k if "{" in k else k + "{}"): row for k, row in rows.items()}
    exact = {k.format(n): sympy.Rational(row[n - 1]) for k, row in named.items() for n in (1, 2, 3)}
    field = emitted("two_time_body").setting.field
    number = lambda x: sympy.Rational(x.numerator, x.denominator)  # noqa: E731
    return [field.evaluate(r, exact, number) for r in emitted("two_time_body").exact.rates]


def test_the_body_with_two_times_is_that_of_the_book():
    """At random velocities; with the coupling of the other sign it is another motion."""
    source = np.random.default_rng(8)
    for _ in range(3):
        I, B, K = source.integers(1, 9, (3, 3)).tolist()  # noqa: E741
        values = [I, B, K, *source.integers(-9, 9, (4, 3)).tolist()]
        assert at_two_times(values) == rates_with_two_times(values)
        values[1] = [-b for b in B]
        assert at_two_times(values) != rates_with_two_times([I, B, *values[2:]])


def test_both_times_have_the_same_part():
    """With the rates in t, the same equations hold with s and t, and I and -K, exchanged.

    Then Omega is the strain and Xi the velocity; all derivatives by s are those by t.
    """
    source = np.random.default_rng(9)
    I, B, K = source.integers(1, 9, (3, 3)).tolist()  # noqa: E741
    W, V, W_s, V_s = source.integers(-9, 9, (4, 3)).tolist()
    rates = at_two_times([I, B, K, W, V, W_s, V_s])
    V_t = rates[3:]
    W_t = [(p - b * v) / i for p, b, v, i in zip(rates[:3], B, V_t, I, strict=True)]
    negative = [[-x for x in row] for row in (K, I)]
    swapped = at_two_times([negative[0], B, negative[1], V, W, V_t, W_t])
    N_s = [b * w - k * v for b, w, k, v in zip(B, W_s, K, V_s, strict=True)]
    assert swapped == [*N_s, *W_s]
    swapped = at_two_times([negative[0], B, K, V, W, V_t, W_t])
    assert swapped != [*N_s, *W_s]


def test_a_body_turns_by_one_time_minus_the_other():
    """Omega = W(t - s/c), Xi = -W/c solves it iff J dW/dt = J W x W, J = I - 2 B/c - K/c^2."""
    source, c = np.random.default_rng(10), sympy.Rational(7, 2)
    I, B, K = (sympy.Matrix(row.tolist()) for row in source.integers(1, 9, (3, 3)))  # noqa: E741
    W = sympy.Matrix([3, -2, 5])
    for J, solves in ((I - 2 * B / c - K / c**2, True), (I - K / c**2, False)):
        turned = J.multiply_elementwise(W).cross(W)
        W_t = turned.multiply_elementwise(J.applyfunc(lambda x: 1 / x))
        values = [list(x) for x in (I, B, K, W, -W / c, -W_t / c, W_t / c**2)]
        Pi_t = (I - B / c).multiply_elementwise(W_t)
        assert (at_two_times(values) == [*Pi_t, *(-W_t / c)]) is solves
