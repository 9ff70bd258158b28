"""Vector fields, appendices A and B: what the package computes is what the book states.

The right sides are typed from Holm (2011), Geometric Mechanics II; beside each stands a spoiled
variant that the same comparison must refuse.
"""

from math import factorial

import numpy as np
import pytest
from scipy.linalg import expm

from coadjoint.algebra import algebra_by_name
from coadjoint.exact import Field
from coadjoint.exact.dense import add, apply, cross, dot, product, scale, subtract, transpose
from coadjoint.groups.complex_numbers import Complex
from coadjoint.groups.vector_fields import (
    VectorField,
    cotangent_lift,
    exterior_derivative,
    jacobian,
    lie_derivative,
)
from coadjoint.theory.charts import (
    chart_velocity,
    north_chart,
    north_point,
    south_chart,
    south_point,
    spherical_differential,
    spherical_point,
)
from coadjoint.theory.jets import JetField
from coadjoint.theory.vector_fields import (
    compose,
    curl,
    divergence,
    flow,
    jacobi_lie_bracket,
    lie_derivative_of_one_form,
    lie_series,
    pull_back,
    push_forward,
    tangent_lift,
    vorticity_rate,
)

PLANE = ("x", "y")
SPACE = ("x", "y", "z")


def elements(field, *names):
    """Several symbols."""
    return tuple(field[name] for name in names)


def undetermined(letters, names, order=2):
    """Vector fields whose components are functions that nothing is known about."""
    functions = [f"{letter}{n}" for letter in letters for n in range(len(names))]
    field = JetField(names, functions, order)
    return [
        VectorField(field, names, elements(field, *(f"{letter}{n}" for n in range(len(names)))))
        for letter in letters
    ]


# -- A.1: charts ----------------------------------------------------------------------------------


@pytest.fixture
def sphere():
    """Coordinates of R^3 and of a chart, with their velocities."""
    return Field(["x", "y", "z", "vx", "vy", "vz", "a", "b", "va", "vb"])


def test_a_1_stereographic_charts(sphere):
    """zeta_N = (x + i y)/(1 - z), zeta_S = (x - i y)/(1 + z), zeta_S zeta_N = 1 on the sphere."""
    x, y, z, a, b = elements(sphere, "x", "y", "z", "a", "b")
    assert north_chart((x, y, z)) == Complex(x / (1 - z), y / (1 - z))
    assert south_chart((x, y, z)) == Complex(x / (1 + z), -y / (1 + z))
    point = north_point(Complex(a, b))
    assert dot(point, point) == 1
    assert south_chart(point) * north_chart(point) == 1
    assert south_chart(point).conjugate * north_chart(point) != 1
    assert south_chart((x, y, z)) * north_chart((x, y, z)) != 1, "needs x^2 + y^2 + z^2 = 1"


def test_a_1_inverse_charts(sphere):
    """Each chart undoes its inverse, and the inverse of one is not that of the other."""
    zeta = Complex(*elements(sphere, "a", "b"))
    assert north_chart(north_point(zeta)) == zeta
    assert south_chart(south_point(zeta)) == zeta
    assert north_chart(south_point(zeta)) == zeta.inverse()
    on_sphere = south_point(zeta)
    assert north_point(north_chart(on_sphere)) == on_sphere


def test_a_1_2_tangent_lift_of_a_chart(sphere):
    """zeta_N' = (x' + i y')/(1 - z) + (x + i y) z'/(1 - z)^2, and with x.x' = 0 only in x', y'."""
    x, y, z, vx, vy, vz = elements(sphere, "x", "y", "z", "vx", "vy", "vz")
    found = chart_velocity(sphere, north_chart, SPACE, (vx, vy, vz))
    turning = Complex(x, y) * (vz / (1 - z) ** 2)
    assert found == Complex(vx, vy) / Complex(1 - z) + turning
    assert found != Complex(vx, vy) / Complex(1 - z) - turning
    tangent = {"vz": -(x * vx + y * vy) / z}
    by_hand = Complex(vx, vy) / Complex(1 - z) - Complex(x, y) * (
        (x * vx + y * vy) / (z * (1 - z) ** 2)
    )
    assert Complex(*(sphere.substitute(part, tangent) for part in (found.re, found.im))) == by_hand


def test_a_1_2_tangent_lift_undoes_that_of_the_inverse_chart(sphere):
    """T(zeta_N) T(zeta_N^-1) = 1, and v.v = 4 |zeta'|^2/(1 + |zeta|^2)^2 on the sphere."""
    a, b, va, vb = elements(sphere, "a", "b", "va", "vb")
    point = north_point(Complex(a, b))
    velocity = tangent_lift(sphere, point, ("a", "b"), (va, vb))
    assert dot(point, velocity) == 0
    values = dict(zip(SPACE, point, strict=True))
    lifted = chart_velocity(sphere, north_chart, SPACE, velocity)
    parts = [sphere.substitute(part, values) for part in (lifted.re, lifted.im)]
    assert parts == [va, vb]
    assert dot(velocity, velocity) == 4 * (va**2 + vb**2) / (1 + a**2 + b**2) ** 2
    assert dot(velocity, velocity) != 2 * (va**2 + vb**2) / (1 + a**2 + b**2) ** 2


# -- A.2: flows and differentials -----------------------------------------------------------------


def test_a_2_1_the_flow_property():
    """phi_(t+s) = phi_t phi_s and d phi_t/dt = X(phi_t), exactly where the series ends."""
    field = Field(["x", "y", "z", "t", "s"])
    x, y, _, t, s = elements(field, *SPACE, "t", "s")
    X = VectorField(field, SPACE, (field.one, x, x * y))
    at_t, at_s, at_both = (flow(X, time, order=6) for time in (t, s, t + s))
    assert flow(X, t, order=7) == at_t, "the series must have ended"
    assert compose(field, at_t, SPACE, at_s) == at_both
    velocity = tuple(field.derivative(component, "t") for component in at_t)
    assert velocity == compose(field, X.components, SPACE, at_t)
    cut = flow(X, t, order=2)
    assert compose(field, cut, SPACE, flow(X, s, order=2)) != flow(X, t + s, order=2)


MATRIX = ((1, -2, 0), (3, 0, 1), (0, 1, -1))


def test_2_3_2_lie_series_of_a_linear_field():
    """The term t^k of the flow of x' = A x is A^k x / k!, and the sum is expm(t A) x."""
    field = Field([*SPACE, "t"])
    x, t = elements(field, *SPACE), field["t"]
    X = VectorField(field, SPACE, apply(MATRIX, x))
    series, term = x, x
    for k in range(1, 25):
        term = apply(MATRIX, term)
        series = add(series, scale(t**k / factorial(k), term))
    found = flow(X, t, order=24)
    assert found == series
    assert found != flow(-X, t, order=24)
    start = np.array([0.5, -1.0, 2.0])
    point = dict(zip([*SPACE, "t"], [*start, 0.5], strict=True))
    numbers = [field.evaluate(component, point, float, None) for component in found]
    # The remainder is below (t |A|)^25/25! = 1e-18; the sum of 25 terms rounds a few times.
    assert np.abs(np.array(numbers) - expm(0.5 * np.array(MATRIX)) @ start).max() < 1e-13


def test_a_2_2_differential_in_spherical_coordinates():
    """``df`` = f_theta dtheta + f_phi dphi by the chain rule, for any function f of the sphere."""
    field = Field(["fx", "fy", "fz", "theta", "phi"], slots=2)
    fx, fy, fz = gradient = elements(field, "fx", "fy", "fz")
    d_theta, d_phi = spherical_differential(field, gradient, "theta", "phi")
    st, sp = (field.call("sin", field[name]) for name in ("theta", "phi"))
    ct, cp = (field.call("cos", field[name]) for name in ("theta", "phi"))
    assert field.is_zero(d_theta - (ct * cp * fx + ct * sp * fy - st * fz))
    assert field.is_zero(d_phi - (-st * sp * fx + st * cp * fy))
    assert not field.is_zero(d_theta - (ct * cp * fx + ct * sp * fy + st * fz))
    point = spherical_point(field, "theta", "phi")
    assert field.is_zero(dot(point, point) - 1)


# -- A.3: lifts -----------------------------------------------------------------------------------


@pytest.fixture
def maps():
    """Two polynomial maps of the plane, a velocity and a covector."""
    field = Field(["x", "y", "v", "w", "p", "q"])
    x, y = elements(field, "x", "y")
    return field, (x + y**2, x * y), (x**2 - y, x + 3 * y)


def test_a_3_tangent_lifts_are_functorial(maps):
    """T(f o g) = Tf o Tg; T(g o f) is another map."""
    field, f, g = maps
    v = elements(field, "v", "w")
    lifted = tangent_lift(field, compose(field, f, PLANE, g), PLANE, v)
    inner = tangent_lift(field, g, PLANE, v)
    Df_at_g = tuple(compose(field, row, PLANE, g) for row in jacobian(field, f, PLANE))
    assert lifted == apply(Df_at_g, inner)
    assert lifted != tangent_lift(field, compose(field, g, PLANE, f), PLANE, v)


def test_a_3_cotangent_lifts_are_functorial_and_dual(maps):
    """<T*f(alpha), v> = <alpha, Tf(v)> and T*(f o g) = T*g o T*f; Df in place of Df^T is not."""
    field, f, g = maps
    v, alpha = elements(field, "v", "w"), elements(field, "p", "q")
    back = cotangent_lift(field, f, PLANE, alpha)
    assert dot(back, v) == dot(alpha, tangent_lift(field, f, PLANE, v))
    assert dot(tangent_lift(field, f, PLANE, alpha), v) != dot(back, v)
    Df_at_g = tuple(compose(field, row, PLANE, g) for row in jacobian(field, f, PLANE))
    whole = cotangent_lift(field, compose(field, f, PLANE, g), PLANE, alpha)
    assert whole == cotangent_lift(field, g, PLANE, apply(transpose(Df_at_g), alpha))


# -- B.5 to B.7 -----------------------------------------------------------------------------------


@pytest.fixture
def plane():
    """A plane with a shear, which is its own kind of inverse, and two polynomial fields."""
    field = Field(["x", "y", "a", "b", "c", "d", "t"])
    x, y, a, b, c, d, _ = elements(field, *PLANE, "a", "b", "c", "d", "t")
    shear, back = (x + a * y**2, y), (x - a * y**2, y)
    X = VectorField(field, PLANE, (b * x * y, c * x - y**2))
    Y = VectorField(field, PLANE, (d * x**2 + y, b * y - a))
    return field, shear, back, X, Y


def test_b_5_push_forward(plane):
    """phi_* X = T phi o X o phi^-1; leaving out the return to phi^-1 gives something else."""
    field, shear, back, X, _ = plane
    a, y = elements(field, "a", "y")
    moved = push_forward(shear, back, X)
    X1, X2 = compose(field, X.components, PLANE, back)
    assert moved.components == (X1 + 2 * a * y * X2, X2)
    assert moved.components != tangent_lift(field, shear, PLANE, X.components)
    assert pull_back(shear, back, moved) == X


def test_b_5_push_forward_keeps_brackets(plane):
    """phi_* [X, Y] = [phi_* X, phi_* Y], for the bracket in either convention."""
    _, shear, back, X, Y = plane
    for bracket in (lie_derivative, jacobi_lie_bracket):
        moved = bracket(push_forward(shear, back, X), push_forward(shear, back, Y))
        assert moved == push_forward(shear, back, bracket(X, Y))
        assert moved != bracket(push_forward(shear, back, X), Y)


def test_b_5_left_invariant_fields():
    """X_xi(g) = g xi are kept by left translation and close as the algebra, on matrices of R^3."""
    entries = tuple(f"g{i}{j}" for i in range(3) for j in range(3))
    field = Field([*entries, "h1", "h2", "h3"])
    g = tuple(tuple(field[f"g{i}{j}"] for j in range(3)) for i in range(3))
    algebra = algebra_by_name("so(3)")

    def dense(coordinates):
        total = [[0] * 3 for _ in range(3)]
        for value, matrix in zip(coordinates, algebra.matrices, strict=True):
            for (row, column), entry in matrix.items():
                total[row][column] += value * entry
        return tuple(map(tuple, total))

    def invariant(coordinates, left=True):
        matrix = dense(coordinates)
        moved = product(g, matrix) if left else product(matrix, g)
        return VectorField(field, entries, tuple(sum(moved, ())))

    xi, eta = (1, 2, 3), (-1, 0, 5)
    both = algebra.bracket(xi, eta)
    assert lie_derivative(invariant(xi), invariant(eta)) == invariant(both)
    assert jacobi_lie_bracket(invariant(xi), invariant(eta)) == -invariant(both)
    right = lie_derivative(invariant(xi, left=False), invariant(eta, left=False))
    assert right == -invariant(both, left=False)
    shear = ((1, field["h1"], field["h2"]), (0, 1, field["h3"]), (0, 0, 1))
    translated = tuple(sum(product(shear, g), ()))
    lifted = tangent_lift(field, translated, entries, invariant(xi).components)
    assert lifted == compose(field, invariant(xi).components, entries, translated)
    other = invariant(xi, left=False).components
    assert tangent_lift(field, translated, entries, other) != compose(
        field, other, entries, translated
    )


@pytest.mark.parametrize("names", [PLANE, SPACE], ids=["plane", "space"])
@pytest.mark.parametrize("bracket", [jacobi_lie_bracket, lie_derivative])
def test_b_6_1_the_bracket_is_a_lie_bracket(names, bracket):
    """Bilinear, skew and Jacobi for undetermined X, Y, Z: the proof holds for all smooth fields."""
    X, Y, Z = undetermined("XYZ", names)
    assert bracket(X, Y) == -bracket(Y, X)
    assert not bracket(X, Y).is_zero()
    assert bracket(2 * X + Y, Z) == 2 * bracket(X, Z) + bracket(Y, Z)
    cycle = [bracket(X, bracket(Y, Z)), bracket(Y, bracket(Z, X)), bracket(Z, bracket(X, Y))]
    assert (cycle[0] + cycle[1] + cycle[2]).is_zero()
    assert not (cycle[0] + cycle[1] - cycle[2]).is_zero()


def test_b_6_without_one_term_is_no_lie_bracket():
    """(DX) Y alone, the bracket without its second half, is neither skew nor satisfies Jacobi."""
    X, Y, Z = undetermined("XYZ", PLANE)

    def half(A, B):
        return A.like(apply(A.jacobian(), B.components))

    assert half(X, Y) != -half(Y, X)
    assert not (half(X, half(Y, Z)) + half(Y, half(Z, X)) + half(Z, half(X, Y))).is_zero()


def test_b_6_the_two_sign_conventions():
    """[X, Y]_JL = (DX)Y - (DY)X = -L_X Y, and L_X Y is the commutator of operators, not minus it.

    The statement of theorem B.7.1 sets both equal; its proof, and this one, give opposite signs.
    """
    X, Y = undetermined("XY", SPACE, order=2)
    field = X.field
    assert jacobi_lie_bracket(X, Y) == -lie_derivative(X, Y)
    assert jacobi_lie_bracket(X, Y) != lie_derivative(X, Y)
    by_hand = subtract(apply(X.jacobian(), Y.components), apply(Y.jacobian(), X.components))
    assert jacobi_lie_bracket(X, Y).components == by_hand
    f = field["x"] * field["y"] ** 2 + field["z"]
    commutator = X.derivative(Y.derivative(f)) - Y.derivative(X.derivative(f))
    assert lie_derivative(X, Y).derivative(f) == commutator
    assert jacobi_lie_bracket(X, Y).derivative(f) != commutator


def test_b_7_1_lie_derivative_is_the_rate_of_pull_back():
    """d/dt phi_t^* Y at t = 0 is (DY)X - (DX)Y, for quadratic X and Y with free coefficients.

    Only terms of first order in t are needed: phi_t = x + t X and its inverse x - t X.
    """
    coefficients = [f"{letter}{n}{k}" for letter in "XY" for n in (1, 2) for k in range(6)]
    field = Field([*PLANE, "t", *coefficients])
    x, y, t = elements(field, *PLANE, "t")
    monomials = (field.one, x, y, x**2, x * y, y**2)

    def generic(letter):
        rows = [[field[f"{letter}{n}{k}"] for k in range(6)] for n in (1, 2)]
        return VectorField(field, PLANE, tuple(dot(row, monomials) for row in rows))

    X, Y = generic("X"), generic("Y")
    forward, back = (flow(X, time, order=1) for time in (t, -t))
    D_back = tuple(compose(field, row, PLANE, forward) for row in jacobian(field, back, PLANE))
    pulled = apply(D_back, compose(field, Y.components, PLANE, forward))
    rate = tuple(
        field.substitute(field.derivative(component, "t"), {"t": field.zero})
        for component in pulled
    )
    assert rate == lie_derivative(X, Y).components
    assert rate != jacobi_lie_bracket(X, Y).components


def test_b_7_1_along_an_exact_flow(plane):
    """d/dt phi_t^* Y = phi_t^* L_X Y at every t, for a shear flow whose series ends."""
    field, _, _, _, Y = plane
    y, t = elements(field, "y", "t")
    X = VectorField(field, PLANE, (y**2, field.zero))
    forward, back = (flow(X, time, order=3) for time in (t, -t))
    pulled = pull_back(forward, back, Y)
    rate = Y.like([field.derivative(component, "t") for component in pulled.components])
    assert rate == pull_back(forward, back, lie_derivative(X, Y))
    assert rate != pull_back(forward, back, jacobi_lie_bracket(X, Y))


def test_b_7_lie_derivative_of_functions_and_forms():
    """Cartan: L_X alpha = i_X d alpha + d(alpha(X)); Leibniz: X(alpha(Y)) = both parts."""
    names = SPACE
    field = JetField(names, [f"{letter}{n}" for letter in "XYA" for n in range(3)], 2)
    X, Y = (
        VectorField(field, names, elements(field, *(f"{s}{n}" for n in range(3)))) for s in "XY"
    )
    alpha = elements(field, "A0", "A1", "A2")
    found = lie_derivative_of_one_form(X, alpha)
    d_alpha = exterior_derivative(field, names, alpha)
    inner = apply(transpose(d_alpha), X.components)
    exact_part = field.gradient(dot(alpha, X.components), names)
    assert found == add(inner, exact_part)
    assert found != subtract(exact_part, inner)
    pairing = X.derivative(dot(alpha, Y.components))
    moved = lie_derivative(X, Y).components
    assert pairing == dot(found, Y.components) + dot(alpha, moved)
    assert pairing != dot(found, Y.components) - dot(alpha, moved)


def test_b_7_the_volume_form_grows_by_the_divergence():
    """d/dt det D phi_t at t = 0 is div X, and volumes of a field without divergence stay."""
    (X,) = undetermined("X", SPACE)
    field = X.field
    assert divergence(X) == field["X0_x"] + field["X1_y"] + field["X2_z"]
    assert divergence(curl(X)) == 0
    shift = Field([*SPACE, "t"])
    x, y, z, t = elements(shift, *SPACE, "t")
    for components, expected in (((x * y, z, x - z), y - 1), ((y, z**2, x), shift.zero)):
        W = VectorField(shift, SPACE, components)
        a, b, c = jacobian(shift, flow(W, t, order=1), SPACE)
        volume = dot(a, cross(b, c))
        rate = shift.substitute(shift.derivative(volume, "t"), {"t": shift.zero})
        assert rate == divergence(W) == expected


def test_b_7_lie_series_moves_functions():
    """f(phi_t) = exp(tX) f, composition with the flow, for a flow whose series ends."""
    field = Field([*PLANE, "t"])
    x, y, t = elements(field, *PLANE, "t")
    X = VectorField(field, PLANE, (y, field.number(3)))
    f = x**2 * y - x
    (moved,) = compose(field, (f,), PLANE, flow(X, t, order=4))
    assert lie_series(X, f, t, order=12) == moved
    assert lie_series(X, f, -t, order=12) != moved


# -- B.7.2: ideal fluids --------------------------------------------------------------------------


def test_b_7_2_the_vorticity_equation():
    """The curl of Euler's equation is d omega/dt + (u.grad) omega - (omega.grad) u = 0, div u = 0.

    u and p are undetermined; what is left over is omega div u, so that the divergence matters.
    """
    names = (*SPACE,)
    field = JetField(names, ["u0", "u1", "u2", "p"], 3)
    u = VectorField(field, names, elements(field, "u0", "u1", "u2"))
    omega = curl(u)
    gradient = field.gradient(field["p"], names)
    acceleration = u.like(scale(-1, add(u.rates(u.components), gradient)))
    by_hand = subtract(omega.rates(u.components), u.rates(omega.components))
    assert vorticity_rate(u).components == by_hand
    stretched = u.like(scale(divergence(u), omega.components))
    assert curl(acceleration) == vorticity_rate(u) - stretched
    assert curl(acceleration) != vorticity_rate(u) + stretched
    assert curl(acceleration) != vorticity_rate(u)


def plane_flow():
    """The flow u = (-psi_y, psi_x) of an undetermined stream function, what is 0, and curl u."""
    field = JetField([*SPACE], ["psi"], 4)
    psi_x, psi_y = elements(field, "psi_x", "psi_y")
    still = {name: field.zero for name in field.names if name.startswith("psi_") and "z" in name}
    w = field.derivative(psi_x, "x") + field.derivative(psi_y, "y")
    return VectorField(field, SPACE, (-psi_y, psi_x, field.zero)), still, w


def test_b_7_2_plane_flows():
    """The vorticity is Laplace psi, and its rate -{psi, Laplace psi} = psi_y w_x - psi_x w_y."""
    u, still, w = plane_flow()
    field = u.field
    assert [field.substitute(x, still) for x in curl(u).components] == [0, 0, w]
    w_x, w_y = (field.derivative(w, name) for name in ("x", "y"))
    (psi_x, psi_y) = elements(field, "psi_x", "psi_y")
    expected = psi_y * w_x - psi_x * w_y
    assert [field.substitute(x, still) for x in vorticity_rate(u).components] == [0, 0, expected]


@pytest.mark.parametrize(("second", "steady"), [((3, 4), True), ((3, 3), False)])
def test_b_7_2_cellular_flows_are_steady(second, steady):
    """Waves of one length, |k| = 5: Laplace psi = -25 psi; with another length they move."""
    field = Field([*SPACE, "A", "B"], slots=2)
    x, y, A, B = elements(field, "x", "y", "A", "B")
    waves = [field.call("sin", 5 * x), field.call("sin", second[0] * x + second[1] * y)]
    psi = A * waves[0] + B * waves[1]
    psi_x, psi_y = (field.derivative(psi, name) for name in ("x", "y"))
    u = VectorField(field, SPACE, (-psi_y, psi_x, field.zero))
    assert divergence(u) == 0
    assert (curl(u).components[2] + 25 * psi == 0) is steady
    assert vorticity_rate(u).is_zero() is steady


def test_b_7_2_energy_and_all_functions_of_the_vorticity_are_kept_in_the_plane():
    """Rates are divergences: F(w)_t = -div(F(w) u) for F = w^2 and w^3, psi w_t = -div(psi w u).

    The energy is -psi w/2 but for a divergence, and its rate -psi w_t.
    """
    u, still, w = plane_flow()
    field, psi, (ux, uy, _) = u.field, u.field["psi"], u.components
    rate = field.substitute(vorticity_rate(u).components[2], still)

    def flow_out(density):
        return field.derivative(density * ux, "x") + field.derivative(density * uy, "y")

    for power in (2, 3):
        assert power * w ** (power - 1) * rate == -flow_out(w**power)
    assert psi * rate == -flow_out(psi * w)
    assert psi * rate != flow_out(psi * w)


def abc_flow(doubled):
    """The ABC flow; one amplitude of the third component may be doubled, to spoil it."""
    field = Field([*SPACE, "A", "B", "C"], slots=3)
    sin, cos = ([field.call(f, field[name]) for name in SPACE] for f in ("sin", "cos"))
    A, B, C = elements(field, "A", "B", "C")
    components = (
        A * sin[2] + C * cos[1],
        B * sin[0] + A * cos[2],
        C * sin[1] + doubled * B * cos[0],
    )
    return VectorField(field, SPACE, components)


def test_b_7_2_beltrami_flow_is_steady():
    """The ABC flow has curl u = u, div u = 0 and [u, omega] = 0; with an amplitude off it moves."""
    u = abc_flow(1)
    assert divergence(u) == 0
    assert (curl(u) - u).is_zero()
    assert vorticity_rate(u).is_zero()
    assert vorticity_rate(u).components == scale(-1, lie_derivative(u, curl(u)).components)
    spoiled = abc_flow(2)
    assert divergence(spoiled) == 0
    assert not (curl(spoiled) - spoiled).is_zero()
    assert not vorticity_rate(spoiled).is_zero()


def test_b_7_2_a_steady_flow_that_is_not_beltrami():
    """A rigid rotation has omega along its axis, not along u, and yet [u, omega] = 0."""
    field = Field(SPACE)
    x, y, z = elements(field, *SPACE)
    u = VectorField(field, SPACE, (-y, x, field.zero))
    assert curl(u).components == (0, 0, 2)
    assert vorticity_rate(u).is_zero()
    strained = VectorField(field, SPACE, (-y - x, x - y, 2 * z))
    assert divergence(strained) == 0
    assert vorticity_rate(strained).components == (0, 0, 4)
