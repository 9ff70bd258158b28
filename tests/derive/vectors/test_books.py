"""Equations of motion equal those that books print by vectors, worked out in SymPy at a point.

The formulas stand as the sources have them and know nothing of how lines are found: they are
evaluated with the quantities of a random state, and compared with the rates that were derived.
"""

from __future__ import annotations

from random import Random
from types import SimpleNamespace

import pytest
from sympy import (
    Matrix,
    Rational,
    Symbol,
    cos,
    diag,
    eye,
    pi,
    simplify,
    sin,
    sqrt,
    symbols,
    zeros,
)

from coadjoint.derive import derive
from coadjoint.derive.mechanics.noise import noise_fields
from coadjoint.derive.setting import assemble
from tests.specs import shipped

E3 = Matrix([0, 0, 1])


def hat(a):
    """The matrix of a x."""
    return Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def vee(m):
    """The vector of a skew matrix."""
    return Matrix([m[2, 1], m[0, 2], m[1, 0]])


def bracket(a, b):
    """The commutator of matrices."""
    return a * b - b * a


def rotation(a, b, c, d):
    """A rational rotation: that of a quaternion."""
    q = Matrix([b, c, d])
    return eye(3) + (2 * a * hat(q) + 2 * hat(q) ** 2) / (a * a + q.dot(q))


class Point:
    """A random rational state of a system, and what was derived there.

    Attributes:
        q: Declared quantities by name: numbers, columns and matrices.
        rate: Rates of the state by name, of the same shapes; velocities have theirs, where some
            are solved for.
    """

    def __init__(self, system, given=None):
        equations, random = derive(shipped(system)), Random(7)
        spec, setting = equations.spec, equations.setting
        velocities = [n for v in spec.having_role("velocity") for n in v.components]
        names = [*setting.state, *setting.parameters, *setting.inputs, *setting.time]
        names += [n for jet in spec.jets for n in jet.components]
        names += [n for n in velocities if n not in equations.velocities] if spec.space else []
        at = {Symbol(n): Rational(random.randint(2, 30), 17) for n in names}
        at |= {Symbol(n): value for n, value in (given(at) if given else {}).items()}
        for linear in equations.unsolved:
            matrix, right = linear.matrix.xreplace(at), linear.right.xreplace(at)
            at |= zip(linear.unknowns, matrix.LUsolve(right), strict=True)
        for name, value in equations.velocities.items():
            if name.startswith("_"):  # of a solve, whose solution stands in the rates
                continue
            number = value.xreplace(at)
            if Symbol(name) not in at and not number.free_symbols:
                at[Symbol(name)] = number
        at |= {Symbol(n): value.xreplace(at) for n, value in equations.observables.items()}
        self.at = at
        rates = dict(
            zip(equations.variables, (r.xreplace(at) for r in equations.rates), strict=True)
        )
        quantities = (*spec.variables, *spec.parameters, *spec.inputs, *spec.jets)
        own = {n: at[Symbol(n)] for each in quantities for n in each.components if Symbol(n) in at}
        self.q = SimpleNamespace(**{v.name: _put(v, own) for v in quantities if _has(v, own)})
        solved = {n: at[Symbol(f"d{n}_dt")] for n in own if Symbol(f"d{n}_dt") in at}
        moving = {**solved, **rates}
        self.rate = SimpleNamespace(
            **{v.name: _put(v, moving) for v in spec.variables if _has(v, moving)}
        )


def _has(quantity, values):
    return set(quantity.components) <= values.keys()


def _put(quantity, values):
    value = assemble(quantity, values)
    return Matrix(value) if isinstance(value, tuple) else value


def check_equal(found, expected):
    """All entries agree; roots and decimals to 40 digits."""
    difference = Matrix(found) - Matrix(expected)
    assert any(x != 0 for x in Matrix(expected)), "both sides are 0"
    assert all(abs(x.evalf(50)) < 1e-40 for x in difference), difference


def x(a, b):
    """The vector product."""
    return a.cross(b)


def over(a, b):
    """A vector divided entry by entry: diag(b)^-1 a."""
    return Matrix([p / q for p, q in zip(a, b, strict=True)])


def by(a, b):
    """diag(a) b."""
    return over(b, a.applyfunc(lambda e: 1 / e))


#: Of each system: where the formula stands, and the rates that it gives. Sections are those of
#: Holm (2011), Geometric Mechanics II, 2nd ed., where no other source is named.
BOOKS = {
    "heavy_top_damped": (
        "8.2, with a torque and -d Omega",
        lambda q: {
            "Pi": x(q.Pi, q.Omega) + q.m * q.g * x(q.Gamma, q.chi) - by(q.d, q.Omega) + q.tau
        },
    ),
    "kapitza_top": (
        "Kapitza (1951): gravity g plus the acceleration of the pivot, at a cos(w t)",
        lambda q: {
            "Pi": x(q.Pi, q.Omega) + q.m * (q.g - q.a * q.w**2 * cos(q.w * q.t)) * x(q.Gamma, q.chi)
        },
    ),
    "two_field_top": (
        "Reyman and Semenov-Tian-Shansky (1987): M' = M x w + a x alpha + b x beta",
        lambda q: {
            "Pi": x(q.Pi, q.Omega)
            - x(q.R[0, :].T, Matrix([q.a, 0, 0]))
            - x(q.R[1, :].T, Matrix([0, q.b, 0])),
            "R": q.R * hat(q.Omega),
        },
    ),
    "coupled_bodies": (
        "C.5: tau = epsilon A(Omega2 x d2) x (Omega1 x d1)",
        lambda q: _coupled(q, q.epsilon * x(q.A * x(q.Omega2, q.d2), x(q.Omega1, q.d1))),
    ),
    "quadratic_potential_so3": (
        "2.5.6: M' = [M, Omega] + [A, S], S' = [S, Omega]",
        lambda q: {
            "M": bracket(q.M, q.Omega) + bracket(diag(*q.a), q.S),
            "S": bracket(q.S, q.Omega),
        },
    ),
    "ellipsoidal_motion": (
        "C.3.2: P' = -(2 V1 Q + V2 det(Q) Q^-T) with V = k s/2 + b/d",
        lambda q: {"Q": q.P, "P": -(q.k * q.Q - q.b / q.Q.det() ** 2 * q.Q.det() * q.Q.inv().T)},
    ),
    "spd_motion": (
        "C.3.1: S' = S P S, P' = -(P S P + p p^T/2), q' = S p",
        lambda q: {"S": q.S * q.P * q.S, "P": -(q.P * q.S * q.P + q.p * q.p.T / 2), "q": q.S * q.p},
    ),
    "se3_strand": (
        "10.2 and Holm and Ivanov (2013), with l_k = -K k and l_e = -A d",
        lambda q: _strand(q),
    ),
    "sp2_strand": (
        "C.4, exercise: T_s = S_t + [T, S]_J, right EP",
        lambda q: _sp2(q, _J()),
    ),
    "two_time_body": (
        "10.2: l_Omega_t + Omega x l_Omega + l_Xi_s + Xi x l_Xi = 0",
        lambda q: {
            "Pi": -x(q.Omega, q.Pi)
            - (by(q.B, q.Omega_s) - by(q.K, q.Xi_s))
            - x(q.Xi, by(q.B, q.Omega) - by(q.K, q.Xi)),
            "Xi": q.Omega_s + x(q.Xi, q.Omega),
        },
    ),
    "quadrotor": (
        "Lee, Leok and McClamroch (2010), in body axes: P' = P x Omega + m g down - f e3",
        lambda q: {
            "Pi": x(q.Pi, q.Omega) + x(q.P, q.v) + q.M,
            "P": x(q.P, q.Omega) + q.m * q.g * q.Gamma[:3, :] - q.f * E3,
        },
    ),
    "n_particles": (
        "1.2.1 and 2.1: Newton's law with forces that attract in pairs",
        lambda q: {"r": q.v, "v": Matrix.vstack(*(_attraction(q, k).T for k in range(3)))},
    ),
    "suslov_so5": (
        "Fedorov and Kozlov (1995): (K + j) w' = (k . w) w - (w . w) k",
        lambda q: {
            "w": over(q.k.dot(q.w) * q.w - q.w.dot(q.w) * q.k, q.K + q.j * Matrix([1, 1, 1, 1]))
        },
    ),
    "se2_pendulum": (
        "6.4: ad*_(xi, alpha)(m, b) = (-b . J alpha, -xi J b)",
        lambda q: {"m": -q.b.dot(_J() * Matrix([1, 0])), "b": -q.m * _J() * q.b},
    ),
    "sl2_r2": (
        "6.5: ad*_(a, u)(mu, beta) = ([a^T, mu] - (beta u^T)_traceless, a^T beta)",
        lambda q: _sl2(q),
    ),
    "sp2_momentum": (
        "C.4: X = (q.q, p.p, q.p) of q' = p/m, p' = -(k + b q.q) q",
        lambda q: {
            "X": Matrix(
                [
                    2 * q.X[2] / q.m,
                    -2 * (q.k + q.b * q.X[0]) * q.X[2],
                    q.X[1] / q.m - (q.k + q.b * q.X[0]) * q.X[0],
                ]
            )
        },
    ),
    "c3_oscillators": (
        "C.2: a' = -2i dh/da*, with N = hat(L), L = q x p",
        lambda q: {
            "q": by(q.w, q.p) + q.c * Matrix([q.p[1], q.p[0], 0]) + q.k * x(x(q.q, q.p), q.q),
            "p": -by(q.w, q.q) - q.c * Matrix([q.q[1], q.q[0], 0]) + q.k * x(x(q.q, q.p), q.p),
        },
    ),
    "maxwell_bloch": (
        "David and Holm (1992): x' = grad c x grad h, c = (x2^2 + x3^2)/2, h = x3 + x1^2/2",
        lambda q: {"x": x(Matrix([0, q.x[1], q.x[2]]), Matrix([q.x[0], 0, 1]))},
    ),
    "orbiting_body": (
        "Hughes (1986), chapter 8: torque 3 mu y x I y/r^5; force of MacCullagh's potential",
        lambda q: _orbit(q),
    ),
}


def _J():
    return Matrix([[0, -1], [1, 0]])


def _coupled(q, tau):
    return {
        "Pi1": x(q.Pi1, q.Omega1) + tau,
        "Pi2": x(q.Pi2, q.Omega2) - q.A.T * tau,
        "A": -hat(q.Omega1) * q.A + q.A * hat(q.Omega2),
    }


def _strand(q):
    k, e, k_s, e_s = q.X[:3, :], q.X[3:, :], q.X_s[:3, :], q.X_s[3:, :]
    m, n = by(q.K, k), by(q.A, e - E3)
    return {
        "Pi": x(q.Pi, q.Omega) + x(q.P, q.v) + by(q.K, k_s) + x(k, m) + x(e, n),
        "P": x(q.P, q.Omega) + by(q.A, e_s) + x(k, n),
        "X": Matrix.vstack(q.Omega_s + x(k, q.Omega), q.v_s + x(e, q.Omega) + x(k, q.v)),
    }


def _sp2(q, J):
    """The book's brackets: [T, S]_J = T J S - S J T; l_T = T, l_S = -S."""
    T_s, S_s = (Matrix([[m[0, 0], m[0, 1] / 2], [m[0, 1] / 2, m[1, 1]]]) for m in (q.T_s, q.S_s))
    return {
        "S": T_s - (q.T * J * q.S - q.S * J * q.T),
        "M": S_s + q.T * q.T * J - J * q.T * q.T - (q.S * q.S * J - J * q.S * q.S),
    }


def _attraction(q, k):
    rows = [q.r[i, :].T for i in range(3)]
    others = [(q.m[i], rows[i] - rows[k]) for i in range(3) if i != k]
    return sum((q.G * m * d / sqrt(d.dot(d)) ** 3 for m, d in others), zeros(3, 1))


def _sl2(q):
    """The momenta of diag(1, -1), E12 and E21 with the pairing tr(mu^T a)."""
    a, mu = Matrix([[q.a, q.b], [q.c, -q.a]]), Matrix([[q.h / 2, q.x], [q.y, -q.h / 2]])
    outer = q.p * q.v.T
    moved = bracket(a.T, mu) - (outer - outer.trace() / 2 * eye(2))
    return {"h": 2 * moved[0, 0], "x": moved[0, 1], "y": moved[1, 0], "p": a.T * q.p}


def _orbit(q):
    R, place = q.g[:, :3], Matrix([Symbol(f"place{n}") for n in (1, 2, 3)])
    r = sqrt(place.dot(place))
    inertia = R * diag(*q.I) * R.T
    V = (
        -q.mu * q.m / r
        - q.mu * sum(q.I) / (2 * r**3)
        + 3 * q.mu * place.dot(inertia * place) / (2 * r**5)
    )
    at = dict(zip(place, q.g[:, 3], strict=True))
    force = -Matrix([V.diff(each).xreplace(at) for each in place])
    y = R.T * q.g[:, 3]
    return {
        "Pi": x(q.Pi, q.Omega) + 3 * q.mu * x(y, by(q.I, y)) / sqrt(y.dot(y)) ** 5,
        "P": x(q.P, q.Omega) + R.T * force,
    }


TURN = rotation(1, 2, -1, 3)


def _fill(name, matrix):
    """Numbers for the entries of a matrix or a column."""
    rows, columns = matrix.shape
    places = ((i, j) for i in range(rows) for j in range(columns))
    return {f"{name}{i + 1}{j + 1 if columns > 1 else ''}": matrix[i, j] for i, j in places}


def _legendre(at, momentum, velocity, inertia, slope=""):
    """Momenta of velocities with principal moments of inertia, or their slopes along space."""
    rows = ((f"{momentum}{n}{slope}", f"{velocity}{n}{slope}", f"{inertia}{n}") for n in (1, 2, 3))
    return {p: at[Symbol(v)] * at.get(Symbol(i), at.get(Symbol(inertia))) for p, v, i in rows}


def _add(*parts):
    """Numbers by name, added up."""
    return {name: sum(part[name] for part in parts) for name in parts[0]}


def _both(law):
    """Numbers of momenta and of their slopes along space."""
    return lambda at: law(at, "") | law(at, "_s")


#: What is not free in a state: poses turn by rotations, and momenta of fields are those of their
#: velocities, which rates name as well.
GIVEN = {
    "orbiting_body": lambda _: _fill("g", TURN.row_join(Matrix([5, 2, 3]) / 3)),
    "coupled_bodies": lambda _: _fill("A", TURN),
    "se3_strand": _both(
        lambda at, s: _legendre(at, "Pi", "Omega", "I", s) | _legendre(at, "P", "v", "M", s)
    ),
    "two_time_body": _both(
        lambda at, s: _add(_legendre(at, "Pi", "Omega", "I", s), _legendre(at, "Pi", "Xi", "B", s))
    ),
    # the components of T off the diagonal are twice the entries
    "sp2_strand": _both(
        lambda at, s: {
            "N12": 1,  # X N Y - Y N X is that of the matrices J^-1 X, so N is -J
            f"M11{s}": at[Symbol(f"T11{s}")],
            f"M12{s}": at[Symbol(f"T12{s}")] / 2,
            f"M22{s}": at[Symbol(f"T22{s}")],
        }
    ),
}


@pytest.mark.parametrize("system", BOOKS)
def test_rates_are_those_of_the_book(system):
    """The formula of the source gives the rates that were derived."""
    point = Point(system, GIVEN.get(system))
    _, law = BOOKS[system]
    point.q.t = point.at.get(Symbol("t"))
    for name, expected in law(point.q).items():
        found = getattr(point.rate, name)
        check_equal(found if isinstance(found, Matrix) else Matrix([found]), _column(expected))


def _column(value):
    return value if isinstance(value, Matrix) else Matrix([value])


@pytest.mark.parametrize("system", ["tippe_top", "chaplygin_ball", "body_of_revolution"])
def test_a_body_on_a_plane_obeys_newton_and_euler(system):
    """12.1.2: all force F acts at -s, so that I Omega' = I Omega x Omega - s x F."""
    point = Point(system, FREE.get(system))
    q, rate = point.q, point.rate
    inertia = q.I if hasattr(q, "I") else Matrix([q.I1, q.I1, q.I3])
    if system == "tippe_top":
        s, Y, rate_Y = q.r * q.Gamma - q.e * E3, q.Y, rate.Y
    else:
        s = SHAPES[system](q)
        Y = x(q.Omega, s)
        moved = SHAPES[system](SimpleNamespace(**{**vars(q), "Gamma": q.Gamma + STEP * rate.Gamma}))
        rate_Y = x(rate.Omega, s) + x(q.Omega, moved.diff(STEP).subs(STEP, 0))
    force = q.m * (rate_Y + x(q.Omega, Y)) + q.m * q.g * q.Gamma
    check_equal(by(inertia, rate.Omega), x(by(inertia, q.Omega), q.Omega) - x(s, force))
    if system == "tippe_top":  # Bou-Rabee, Marsden and Romero (2004): F = N (Gamma - mu v)
        v = Y - x(q.Omega, s)
        normal = point.at[Symbol("normal_force")]
        drag = q.viscous + q.coulomb / sqrt(v.dot(v) + q.slow**2)
        check_equal(force, normal * (q.Gamma - drag * v))
        check_equal(
            [rate.Gamma.dot(v)],
            [-q.Gamma.dot(rate_Y - x(rate.Omega, s) - q.r * x(q.Omega, rate.Gamma))],
        )


STEP = Symbol("step")
#: From the point of contact to the centre of mass.
SHAPES = {
    "chaplygin_ball": lambda q: q.r * q.Gamma + q.chi,
    "body_of_revolution": lambda q: _egg(q, q.Gamma, q.Gamma[2]),
}


def _upright(_):
    """A vertical of length 1."""
    return {"Gamma1": Rational(2, 7), "Gamma2": Rational(3, 7), "Gamma3": Rational(6, 7)}


#: What is not free in states of bodies whose surface or friction asks for a vertical of length 1.
FREE = {"body_of_revolution": _upright, "tippe_top": _upright}


def _egg(q, Gamma, z):
    h = sqrt(q.A**2 * (1 - z**2) + q.C**2 * z**2)
    return q.A**2 / h * Gamma + ((q.C**2 - q.A**2) * z / h + q.l) * E3


def test_a_ball_in_a_sphere_obeys_newton_and_euler():
    """Routh (1905): the force F acts at r n from the centre a n, and a n' = r n x omega."""
    point = Point("ball_in_sphere")
    q, rate = point.q, point.rate
    n_rate = q.r / q.a * x(q.n, q.omega)
    check_equal(rate.n, n_rate)
    again = q.r / q.a * (x(n_rate, q.omega) + x(q.n, rate.omega))
    force = q.m * q.a * again + q.m * q.g * E3
    check_equal(q.I * rate.omega, q.r * x(q.n, force))


def test_a_ball_on_a_turntable_goes_round_a_circle():
    """Fasso and Sansonetto (2016): v' = nu e3 x v with nu = W I/(I + m r^2), omega3 is constant."""
    point = Point("ball_on_turntable")
    q, rate = point.q, point.rate
    v = Matrix([q.r * q.omega[1] - q.W * q.x[1], -q.r * q.omega[0] + q.W * q.x[0]])
    check_equal(rate.x, v)
    again = Matrix([q.r * rate.omega[1] - q.W * v[1], -q.r * rate.omega[0] + q.W * v[0]])
    check_equal(again, q.W * q.I / (q.I + q.m * q.r**2) * _J() * v)
    check_equal(q.I * rate.omega, -q.r * x(E3, Matrix([*(q.m * again), 0])))


def test_rods_of_a_double_pendulum_pull_along_themselves():
    """Newton's law for both masses: what is left after gravity is a tension along each rod."""
    point = Point("double_spherical_pendulum")
    q, rate = point.q, point.rate
    first = q.l1 * rate.v1
    second = first + q.l2 * rate.v2
    lower = q.m2 * second + q.m2 * q.g * E3
    upper = q.m1 * first + q.m1 * q.g * E3 + lower
    assert lower.dot(lower) != 0
    assert not any(x(lower, q.gamma2))
    assert not any(x(upper, q.gamma1))
    check_equal([rate.v1.dot(q.gamma1), rate.v2.dot(q.gamma2)], [-q.v1.dot(q.v1), -q.v2.dot(q.v2)])


def test_the_torque_of_veselova_is_along_gamma():
    """Veselov and Veselova (1988): Pi' = Pi x Omega + lambda Gamma, Omega . Gamma = 0."""
    point = Point("veselova")
    q, rate = point.q, point.rate
    rest = by(q.I, rate.Omega) - x(by(q.I, q.Omega), q.Omega)
    assert not any(x(rest, q.Gamma))
    assert rate.Omega.dot(q.Gamma) + q.Omega.dot(rate.Gamma) == 0
    assert any(rest)


def test_veselova_moves_as_the_multiplier_says():
    """Omega' . Gamma = 0 gives lambda = -Gamma . I^-1 (I Omega x Omega)/(Gamma . I^-1 Gamma)."""
    point = Point("veselova")
    q = point.q
    free = x(by(q.I, q.Omega), q.Omega)
    multiplier = -q.Gamma.dot(over(free, q.I)) / q.Gamma.dot(over(q.Gamma, q.I))
    check_equal(point.rate.Omega, over(free + multiplier * q.Gamma, q.I))
    with pytest.raises(AssertionError):
        check_equal(point.rate.Omega, over(free - multiplier * q.Gamma, q.I))


def test_noise_turns_the_momentum_about_each_axis():
    """Arnaudon, De Castro and Holm: dPi = Pi x Omega dt + sum_k Pi x (sigma_k e_k) o dW_k."""
    point = Point("stochastic_rigid_body")
    q, setting = point.q, derive(shipped("stochastic_rigid_body")).setting
    check_equal(point.rate.Pi, x(q.Pi, over(q.Pi, q.I)))
    fields = noise_fields(setting)
    assert [each.name for each in fields] == ["dW1", "dW2", "dW3"]
    for k, each in enumerate(fields):
        found = [setting.field.to_sympy(entry).xreplace(point.at) for entry in each.field]
        axis = q.sigma[k] * eye(3)[:, k]
        check_equal(found, x(q.Pi, axis))
        with pytest.raises(AssertionError):
            check_equal(found, x(axis, q.Pi))


def test_truncated_vorticity_moves_by_its_stream_function():
    """Zeitlin (1991): W' = [P, W]/hbar, -Delta P = W with the Laplacian of Hoppe and Yau (1998)."""
    point = Point("zeitlin_su_4")
    q, algebra = point.q, derive(shipped("zeitlin_su_4")).setting.algebra
    # complex matrices as real ones of twice their size
    basis = [Matrix(8, 8, lambda i, j, e=e: e.get((i, j), 0)) for e in algebra.matrices]

    def laplacian(matrix):
        """The sum of double commutators with spins: half of the first three over i."""
        return -sum((bracket(s, bracket(s, matrix)) for s in basis[:3]), zeros(8, 8)) / 4

    degrees = [1] * 3 + [2] * 5 + [3] * 7
    assert [laplacian(e) - d * (d + 1) * e for e, d in zip(basis, degrees, strict=True)] == [
        zeros(8, 8)
    ] * 15
    gram = Matrix(15, 15, lambda i, j: -(basis[i] * basis[j]).trace() / 2)
    parts = gram.LUsolve(q.w)
    W = sum((c * e for c, e in zip(parts, basis, strict=True)), zeros(8, 8))
    P = sum(
        (-c / (d * (d + 1)) * e for c, d, e in zip(parts, degrees, basis, strict=True)), zeros(8, 8)
    )
    assert laplacian(P) == -W
    rate = bracket(P, W) / q.hbar
    check_equal(point.rate.w, [-(rate * e).trace() / 2 for e in basis])
    V = sum((c * e for c, e in zip(q.Psi, basis, strict=True)), zeros(8, 8))
    check_equal(bracket(W, V), rate)
    with pytest.raises(AssertionError):
        check_equal(bracket(V, W), rate)


def test_vorticity_in_the_plane_is_carried_by_the_fluid():
    """The curl of Euler's equation u' + (u . grad) u = -grad p, for u = (psi_y, -psi_x)."""
    a, b = symbols("x y")
    psi = sin(a) * cos(2 * b) + cos(a + 3 * b) / 2 + a**2 * b
    u = (psi.diff(b), -psi.diff(a))
    along = [sum(v * part.diff(at) for v, at in zip(u, (a, b), strict=True)) for part in u]
    expected = -(along[1].diff(a) - along[0].diff(b))  # the pressure has no curl
    w = u[1].diff(a) - u[0].diff(b)
    (rate,) = derive(shipped("euler_2d")).rates
    given = {f"{n}_{at}": f.diff(at) for n, f in (("psi", psi), ("w", w)) for at in (a, b)}
    found = rate.xreplace({Symbol(name): value for name, value in given.items()})
    assert simplify(found - expected) == 0
    assert simplify(found + expected) != 0


@pytest.mark.parametrize("system", ["spin_chain_lattice", "elastic_chain"])
def test_a_chain_of_bodies_is_the_discrete_rod(system):
    """Holm, chapter 10, by differences: m from <V_A, hat(eta) A>, n = V_r, for A = R^T R'."""
    point = Point(system, _turn_chain(system))
    q, rate = point.q, point.rate
    rigid = system == "elastic_chain"
    D = diag(*(sum(q.K) - 2 * k for k in q.K)) / (2 * q.a if rigid else 2 * q.a**2)

    def pose(i):
        g = getattr(q, f"g_{i}" if rigid else f"R_{i}")
        return (g[:, :3], g[:, 3]) if rigid else (g, zeros(3, 1))

    def steps(i):
        """The turn to the next body, the moment and the force on the first of both."""
        (R, place), (other, far) = pose(i), pose(i + 1)
        r = R.T * (far - place)
        n = by(q.C, r / q.a - E3) if rigid else zeros(3, 1)
        A = R.T * other
        return A, r, vee(A * D - D * A.T), n

    _, r, m, n = steps(1)
    A0, _, m0, n0 = steps(0)
    Pi = q.Pi_1
    Omega = over(Pi, q.I)
    check_equal(rate.Pi_1, x(Pi, Omega) + x(r, n) + m - A0.T * m0)
    if rigid:
        P = q.P_1
        check_equal(rate.P_1, x(P, Omega) + n - A0.T * n0)


def _turn_chain(system):
    def given(_):
        turns = (rotation(1, 2, -1, 3), rotation(2, 1, 1, -1), rotation(3, -1, 2, 2))
        if system == "elastic_chain":
            places = (Matrix([0, 1, 2]), Matrix([1, 3, -1]), Matrix([2, 2, 5]))
            pairs = enumerate(zip(turns, places, strict=True))
            return {
                k: v for i, (R, at) in pairs for k, v in _fill(f"g_{i}_", R.row_join(at)).items()
            }
        return {k: v for i, R in enumerate(turns) for k, v in _fill(f"R_{i}_", R).items()}

    return given


def test_vortices_on_a_sphere_move_as_bogomolov_says():
    """x_j' = (1/4 pi R) sum Gamma_k x_k x x_j/(R^2 - x_j . x_k); Newton (2001), chapter 4."""
    point = Point("sphere_vortices")
    q = point.q
    vortices = [each for each in vars(q) if each.startswith("x_")]
    own = q.x_0
    expected = zeros(3, 1)
    for name in vortices[1:]:
        other, strength = getattr(q, name), getattr(q, name.replace("x", "Gamma"))
        expected += strength * x(other, own) / (4 * pi * q.R * (q.R**2 - own.dot(other)))
    assert len(vortices) > 1
    check_equal(point.rate.x_0, expected)


def test_a_wrong_sign_in_the_book_is_seen():
    """The comparison can fail: Gamma x Omega turned round is not the motion of Gamma."""
    point = Point("heavy_top")
    check_equal(point.rate.Gamma, x(point.q.Gamma, point.q.Omega))
    with pytest.raises(AssertionError):
        check_equal(point.rate.Gamma, x(point.q.Omega, point.q.Gamma))
