"""Holm (2011), chapter 12: balls that roll, typed by hand, and changes that are refuted.

Rates are SymPy sums of slopes along the emitted motion at exact points, where the accelerations
come from the engine's elimination and the laws from the book.
"""

from fractions import Fraction
from functools import cache

import pytest
import sympy

from coadjoint.algebra import algebra_by_name
from coadjoint.derive import derive
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict, prove
from coadjoint.resources import derivations_folder
from tests.conftest import rational_points
from tests.sources.balls import BALLS
from tests.sources.components import cross, dot, hat, plus, times
from tests.sources.test_equations import derived, emitted, solved, values
from tests.specs import spec

#: A body with everything coupled that rolls on any arm s: 12.2 holds for every l and s.
ANY_BODY = """
title = "A body with any kinetic energy on any arm"
routes = ["nonholonomic", "hamel"]

[algebra]
name = "se(3)"

[variables]
Omega = { role = "velocity", block = "rotation" }
Y     = { role = "velocity", block = "translation" }
Gamma = { role = "advected", representation = "vector" }

[parameters]
A = { shape = [6], form = "symmetric" }
B = { shape = [6], form = "symmetric" }
C = { shape = [6], form = "symmetric" }
b = { shape = [3] }
c = { shape = [3] }
d = { shape = [3] }

[definitions]
s = "dot(Gamma, b)*Gamma + cross(Gamma, c) + d"
V = "Gamma1^2*Gamma2 + 3*Gamma3 + dot(b, Gamma)*Gamma2"

[lagrangian]
l = "dot(Omega, A*Omega)/2 + dot(Omega, B*Y) + dot(Y, C*Y)/2 + dot(Gamma, c)*dot(Y, Y) - V"

[constraints]
rolling = "Y == cross(Omega, s)"
"""
OMEGA, Y, GAMMA = (sympy.symbols(f"{name}1:4") for name in ("Omega", "Y", "Gamma"))
STATE = [*OMEGA, *GAMMA]


def symbols(*names):
    """Symbols of one or of three components each."""
    return [sympy.symbols(f"{n[:-1]}1:4") if n[-1] == "*" else sympy.Symbol(n) for n in names]


def text_of(name):
    """The text of a shipped spec."""
    return (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")


@cache
def any_body():
    """The equations of the general body by both routes."""
    sample = spec(ANY_BODY)
    return {route: derive(sample, route) for route in sample.routes}


def ball(name):
    """A ball in symbols, its formulas typed by hand."""
    equations = emitted(name)
    return BALLS[name](equations.state, equations.parameters)


def motion_at(equations, changed=None, seed=3):
    """An exact point with what the kernel solves for there, and the rates of the state."""
    names = list(map(str, (*equations.state, *equations.parameters)))
    (point,) = rational_points(names, 1, seed)
    point = solved(equations, point | (changed or {}))
    return point, dict(zip(equations.state, values(equations.rates, point), strict=True))


def rate_at(point, rates, expressions):
    """Time derivatives by the slopes of expressions in the state."""
    moved = [sum(sympy.diff(e, x) * sympy.Symbol(f"_{x}") for x in rates) for e in expressions]
    return values(moved, point | {f"_{x}": rate for x, rate in rates.items()})


def check_law(equations, momentum, law, changed=None):
    """``d(momentum)/dt`` along the motion is a law, which is not 0, at a point."""
    point, rates = motion_at(equations, changed)
    expected = values(law, point)
    assert any(expected)
    assert rate_at(point, rates, momentum) == expected


# -- 12.1.2 the ball with its mass off centre ------------------------------------------------------


def terms(given):
    """The three terms of ``dM/dt = M x Omega + m ds/dt x (Omega x s) + m g Gamma x chi``."""
    moved = times(given.r, cross(given.Gamma, given.Omega))
    return (
        cross(given.M, given.Omega),
        times(given.m, cross(moved, cross(given.Omega, given.s))),
        times(given.m * given.g, cross(given.Gamma, given.chi)),
    )


@pytest.mark.parametrize("name", ["chaplygin_ball", "routh_sphere"])
def test_12_1_2_angular_momentum_about_the_contact(name):
    """Its balance has three terms; none may be missing or of the other sign."""
    given, equations = ball(name), emitted(name)
    parts = terms(given)
    check_law(equations, given.M, [sum(column) for column in zip(*parts, strict=True)])
    for place in range(3):
        for sign in (0, -1):
            spoiled = [times(sign if n == place else 1, part) for n, part in enumerate(parts)]
            law = [sum(column) for column in zip(*spoiled, strict=True)]
            with pytest.raises(AssertionError):
                check_law(equations, given.M, law)


def test_12_1_2_the_force_of_the_plane_moves_the_ball():
    """m dv/dt = R - m g z and d(I omega)/dt = -s x R in space; not with s x R."""
    equations, given = emitted("chaplygin_ball"), ball("chaplygin_ball")
    point, rates = motion_at(equations)
    R = values([equations.observables[f"contact{n}"] for n in (1, 2, 3)], point)
    at = BALLS["chaplygin_ball"](*(values(part, point) for part in (STATE, equations.parameters)))
    weight = times(at.m * at.g, at.Gamma)
    pushed = plus(rate_at(point, rates, given.Y), cross(at.Omega, at.Y))
    assert times(at.m, pushed) == plus(R, times(-1, weight))
    spun = [i * w for i, w in zip(given.inertia, given.Omega, strict=True)]
    turning = plus(rate_at(point, rates, spun), cross(at.Omega, values(spun, point)))
    assert turning == times(-1, cross(at.s, R))
    assert turning != cross(at.s, R)
    assert values([equations.observables["normal_force"]], point) != [dot(R, at.Gamma)]
    upright = {"Gamma1": Fraction(3, 5), "Gamma2": Fraction(0), "Gamma3": Fraction(-4, 5)}
    point, _ = motion_at(equations, upright)
    R = values([equations.observables[f"contact{n}"] for n in (1, 2, 3)], point)
    assert values([equations.observables["normal_force"]], point) == [dot(R, values(GAMMA, point))]


# -- 12.2 the principle of Hamilton and Pontryagin -------------------------------------------------


def variation(given, sign=1):
    """``dl . (variations of Omega, Y and Gamma) - d(Sigma . P)/dt + Sigma . (law)``.

    With P = l_Omega + s x l_Y and the law ``DP - ds/dt x l_Y - l_Gamma x Gamma``; Y = Omega x s.
    """
    l_Omega, l_Y, l_Gamma, s, Sigma = (given[n] for n in ("lO*", "lY*", "lG*", "s*", "S*"))
    Omega, moved = given["O*"], given["ds*"]
    Yaw = cross(Omega, s)
    # with O^-1 dO = Sigma and O^-1 dx = Sigma x s
    reached, speed = cross(Sigma, s), plus(cross(given["dS*"], s), cross(Sigma, moved))
    by_turn = plus(given["dS*"], cross(Omega, Sigma))
    by_shift = plus(plus(speed, cross(Omega, reached)), times(sign, cross(Yaw, Sigma)))
    varied = dot(l_Omega, by_turn) + dot(l_Y, by_shift) + dot(l_Gamma, cross(given["G*"], Sigma))
    P = plus(l_Omega, cross(s, l_Y))
    dP = plus(given["dlO*"], plus(cross(moved, l_Y), cross(s, given["dlY*"])))
    law = plus(dP, cross(Omega, P))
    law = plus(law, times(-1, plus(cross(moved, l_Y), cross(l_Gamma, given["G*"]))))
    return sympy.expand(varied - dot(given["dS*"], P) - dot(Sigma, dP) + dot(Sigma, law))


def test_12_2_the_constraint_enters_after_the_variation():
    """dl + Sigma . (D(l_Omega + s x l_Y) - s' x l_Y - l_Gamma x Gamma) is a time derivative."""
    names = ("lO*", "lY*", "lG*", "s*", "S*", "O*", "G*", "dS*", "ds*", "dlO*", "dlY*")
    given = dict(zip(names, symbols(*names), strict=True))
    assert variation(given) == 0
    assert variation(given, sign=-1) != 0


def in_slopes(put_in):
    """``l_Omega + s x l_Y``, ``s``, ``l_Y`` and ``l_Gamma`` of the general body, by SymPy.

    Args:
        put_in: Whether the constraint is put into l before its slopes are taken, which is wrong.
    """
    A, B, C = map(symmetric, "ABC")
    b, c, d = symbols("b*", "c*", "d*")
    s = plus(plus(times(dot(GAMMA, b), GAMMA), cross(GAMMA, c)), d)
    V = GAMMA[0] ** 2 * GAMMA[1] + 3 * GAMMA[2] + dot(b, GAMMA) * GAMMA[1]
    kinetic = (
        dot(OMEGA, A * sympy.Matrix(OMEGA)) / 2
        + dot(OMEGA, B * sympy.Matrix(Y))
        + dot(Y, C * sympy.Matrix(Y)) / 2
        + dot(GAMMA, c) * dot(Y, Y)
    )
    rolling = dict(zip(Y, cross(OMEGA, s), strict=True))
    lagrangian = (kinetic - V).xreplace(rolling) if put_in else kinetic - V
    slopes = [[sympy.diff(lagrangian, x).xreplace(rolling) for x in v] for v in (OMEGA, Y, GAMMA)]
    return plus(slopes[0], cross(s, slopes[1])), s, slopes[1], slopes[2]


def symmetric(name):
    """A symmetric matrix of symbols."""
    return sympy.Matrix(
        3, 3, lambda i, j: sympy.Symbol(f"{name}{min(i, j) + 1}{max(i, j) + 1}")
    )


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_12_2_the_law_for_any_lagrangian_and_any_arm(route):
    """P' + Omega x P = s' x l_Y + l_Gamma x Gamma, P = l_Omega + s x l_Y, by both routes."""
    P, s, l_Y, l_Gamma = in_slopes(put_in=False)
    moved = along(s)
    parts = [cross(P, OMEGA), cross(moved, l_Y), cross(l_Gamma, GAMMA)]
    check_law(any_body()[route], P, total(parts))
    for spoiled in (
        [*parts[:1], parts[2]],  # no s' x l_Y
        [*parts[:2], times(-1, parts[2])],  # Gamma x l_Gamma
        [times(-1, parts[0]), *parts[1:]],
    ):
        with pytest.raises(AssertionError):
            check_law(any_body()[route], P, total(spoiled))


def along(expressions):
    """Rates of functions of Gamma, which moves by Gamma x Omega."""
    turning = cross(GAMMA, OMEGA)
    return [
        sum(sympy.diff(e, x) * v for x, v in zip(GAMMA, turning, strict=True)) for e in expressions
    ]


def total(parts):
    """The sum of vectors."""
    return [sum(column) for column in zip(*parts, strict=True)]


# -- 12.2.1 the ball of Chaplygin ------------------------------------------------------------------


@cache
def certificate(name):
    """What is proved about a shipped ball."""
    return prove(spec(text_of(name), name=name))


def proved(name):
    """Statements of a certificate that are proved."""
    assert certificate(name).holds, str(certificate(name))
    return {c.statement for c in certificate(name).claims if c.verdict is Verdict.PROVED}


def test_12_2_1_momentum_of_the_centred_ball_is_constant_in_space():
    """dM/dt = M x Omega, so that M . M and M . Gamma stay; M x Omega is not that off centre."""
    given = ball("chaplygin_ball_centred")
    check_law(emitted("chaplygin_ball_centred"), given.M, cross(given.M, given.Omega))
    stated = {f"{name} is conserved" for name in ("energy", "vertical", "dot(M, M)")}
    assert stated <= proved("chaplygin_ball_centred")
    off = ball("chaplygin_ball")
    with pytest.raises(AssertionError):
        check_law(emitted("chaplygin_ball"), off.M, cross(off.M, off.Omega))


def test_12_2_1_off_centre_these_integrals_are_none():
    """M . Gamma and M . M are refuted with a point at which they move."""
    claims = 'conserved = ["energy", "vertical", "dot(M, M)"]'
    sample = spec(
        text_of("chaplygin_ball"),
        ('conserved = ["energy", "dot(Gamma, Gamma)"]', claims),
        ("[lagrangian]\n", 'M = "diag(I)*Omega + m*cross(s, Y)"\n\n[lagrangian]\n'),
    )
    found = [c for c in prove(sample).claims if c.verdict is Verdict.REFUTED]
    statements = [f"{f} is conserved" for f in ("vertical", "dot(M, M)")]
    assert [c.statement for c in found] == statements
    assert all(c.counterexample for c in found)


def divergence(equations, point):
    """``sum d(dOmega_i/dt)/dOmega_i``: the accelerations are quadratic in Omega, Gamma turns."""
    found = Fraction(0)
    for name, acceleration in zip(OMEGA, equations.rates[:3], strict=True):
        sides = []
        for step in (1, -1):
            moved = solved(equations, point | {str(name): point[str(name)] + step})
            sides += values([acceleration], moved)
        found += (sides[0] - sides[1]) / 2
    return found


def check_measure(name, power):
    """``det K^power`` dOmega dGamma is invariant, K = I + m (s^2 - s s^T) typed by hand."""
    equations, given = emitted(name), ball(name)
    squared = given.m * dot(given.s, given.s)
    K = sympy.diag(*(i + squared for i in given.inertia)) - given.m * outer(given.s)
    density = K.det(method="berkowitz")
    point, rates = motion_at(equations)
    ((moved,), (value,)) = rate_at(point, rates, [density]), values([density], point)
    assert moved != 0
    names = {str(symbol) for symbol in (*equations.state, *equations.parameters)}
    assert power * moved / value + divergence(equations, {n: point[n] for n in names}) == 0


def test_12_2_1_invariant_measure_of_the_centred_ball():
    """sqrt(det K) dOmega dGamma: Chaplygin's (1 - m r^2 Gamma . (I + m r^2)^-1 Gamma)^(-1/2) dM.

    For ``det K = det(I + m r^2) (1 - m r^2 Gamma . (I + m r^2)^-1 Gamma)`` and dM = det K dOmega.
    """
    check_measure("chaplygin_ball_centred", Fraction(1, 2))
    for name, power in (("chaplygin_ball_centred", 1), ("chaplygin_ball", Fraction(1, 2))):
        with pytest.raises(AssertionError):
            check_measure(name, Fraction(power))


def test_12_2_1_a_homogeneous_ball_rolls_straight():
    """Constant angular velocity, in the body and so in space, and no force but the weight's."""
    equations = emitted("chaplygin_ball")
    same = {"I2": Fraction(7, 3), "I1": Fraction(7, 3), "I3": Fraction(7, 3)}
    centred = same | {f"chi{n}": Fraction(0) for n in (1, 2, 3)}
    point, rates = motion_at(equations, centred)
    assert not any(list(rates.values())[:3])
    push = [equations.observables[f"rolling_reaction{n}"] for n in (1, 2, 3)]
    assert not any(values(push, point))
    point, rates = motion_at(equations, centred | {"I1": Fraction(1)})
    assert any(list(rates.values())[:3])
    assert any(values(push, point))


def test_12_2_1_without_radius_the_ball_is_a_heavy_top():
    """r = 0: about the fixed point, J dOmega/dt = J Omega x Omega + m g Gamma x chi."""
    equations, given = emitted("chaplygin_ball"), ball("chaplygin_ball")
    chi, m = given.chi, given.m
    J = sympy.diag(*given.inertia) + m * (dot(chi, chi) * sympy.eye(3) - outer(chi))
    spun = list(J * sympy.Matrix(given.Omega))
    law = plus(cross(spun, given.Omega), times(m * given.g, cross(given.Gamma, chi)))
    check_law(equations, spun, law, {"r": Fraction(0)})
    with pytest.raises(AssertionError):
        check_law(equations, spun, law, {"r": Fraction(1, 2)})


def outer(a):
    """``a a^T``."""
    return sympy.Matrix(a) * sympy.Matrix(a).T


def test_12_2_1_without_radius_the_equations_are_those_of_heavy_top():
    """r = 0 and chi along the third axis, with I1 + m chi^2 and I2 + m chi^2; not with I1."""
    ours, tops = emitted("chaplygin_ball"), emitted("heavy_top")
    zero = dict.fromkeys(("r", "chi1", "chi2"), Fraction(0))
    point, rates = motion_at(ours, zero)
    steiner = point["m"] * point["chi3"] ** 2
    for added in (steiner, Fraction(0)):
        about = {f"I{n}": point[f"I{n}"] + added for n in (1, 2)} | {"I3": point["I3"]}
        spin = {f"Pi{n}": about[f"I{n}"] * point[f"Omega{n}"] for n in (1, 2, 3)}
        known = {n: point[n] for n in ("m", "g", "chi1", "chi2", "chi3", *map(str, GAMMA))}
        found = values(tops.rates, known | about | spin)
        expected = [about[f"I{n}"] * rates[OMEGA[n - 1]] for n in (1, 2, 3)]
        assert (found[:3] == expected) == (added == steiner)
        assert found[3:] == [rates[x] for x in GAMMA]


# -- 12.2.1 special case: an axis of symmetry ------------------------------------------------------


def test_12_2_1_sp_integrals_of_jellett_and_routh():
    """M . s and Omega3^2 (I1 I3 + m s . I s) stay; with m I1 s . s, and M . Gamma, move."""
    assert {"jellett is conserved", "routh is conserved"} <= proved("routh_sphere")
    equations, given = emitted("routh_sphere"), ball("routh_sphere")
    spun = dot(given.s, [i * x for i, x in zip(given.inertia, given.s, strict=True)])
    I1, _, I3 = given.inertia
    routh = given.Omega[2] ** 2 * (I1 * I3 + given.m * spun)
    point, rates = motion_at(equations)
    assert rate_at(point, rates, [dot(given.M, given.s), routh]) == [0, 0]
    spoiled = given.Omega[2] ** 2 * (I1 * I3 + given.m * dot(given.s, given.s) * I1)
    assert all(rate_at(point, rates, [dot(given.M, given.Gamma), spoiled]))


def test_12_2_1_sp_is_the_ball_with_two_equal_moments():
    """The motion of chaplygin_ball at I1 = I2, chi = l e3; with I1 != I2 Jellett's moves."""
    ours, general = emitted("routh_sphere"), emitted("chaplygin_ball")
    point, rates = motion_at(ours)
    known = {n: point[n] for n in ("m", "r", "g", "I1", "I3", *map(str, STATE))}
    known |= {"I2": known["I1"], "chi1": Fraction(0), "chi2": Fraction(0), "chi3": point["l"]}
    at, moved = motion_at(general, known)
    assert moved == rates
    given = ball("chaplygin_ball")
    assert rate_at(at, moved, [dot(given.M, given.s)]) == [0]
    at, moved = motion_at(general, known | {"I2": known["I1"] + 1})
    assert rate_at(at, moved, [dot(given.M, given.s)]) != [0]


# -- 12.2.2 the rocking disk as a plane motion of the ball -----------------------------------------


@pytest.mark.parametrize("swapped", [False, True])
def test_12_2_2_the_rocking_disk_is_a_plane_motion_of_the_ball(swapped):
    """Omega = -phi' e2, Gamma = (sin phi, 0, cos phi), chi = -l e3 give phi'' of rocking_disk.

    With its centre of mass above (chi = l e3) they do not.
    """
    ours, disk = emitted("chaplygin_ball"), emitted("rocking_disk")
    c, s, speed, offset = Fraction(3, 5), Fraction(4, 5), Fraction(7, 4), Fraction(1, 3)
    zero = dict.fromkeys(("Omega1", "Omega3", "Gamma2", "chi1", "chi2"), Fraction(0))
    plane = {"Omega2": -speed, "Gamma1": s, "Gamma3": c, "chi3": offset if swapped else -offset}
    point, rates = motion_at(ours, zero | plane)
    assert [rates[OMEGA[n]] for n in (0, 2)] == [0, 0] == [rates[GAMMA[1]], 0]
    assert (rates[GAMMA[0]], rates[GAMMA[2]]) == (speed * c, -speed * s)
    phi = sympy.Symbol("phi")
    acceleration = disk.rates[1].xreplace({sympy.cos(phi): c, sympy.sin(phi): s})
    at = {n: point[n] for n in ("m", "r", "g")}
    at |= {"I": point["I2"], "l": offset, "phidot": speed}
    assert (values([acceleration], at) == [-rates[OMEGA[1]]]) == (not swapped)


# -- 12.3 nonholonomic motion on semidirect products -----------------------------------------------


def test_12_3_1_velocities_of_se3_in_body_axes():
    """(O, x)^-1 d(O, x)/dt = (hat(Omega), O^-1 dx/dt), and Gamma = O^-1 z turns by Gamma x Omega.

    At a rotation with O' = O hat(Omega); with O' = hat(Omega) O the velocities are not these.
    """
    O = sympy.Matrix([[1, -2, 2], [2, -1, -2], [2, 2, 1]]) / 3
    assert O * O.T == sympy.eye(3)
    assert O.det() == 1
    speed = sympy.Matrix(sympy.symbols("v1:4"))
    g = O.row_join(sympy.Matrix([5, 7, 11])).col_join(sympy.Matrix([[0, 0, 0, 1]]))
    algebra, W = algebra_by_name("se(3)"), sympy.Matrix(hat(OMEGA))
    eta = [*OMEGA, *(O.T * speed)]
    expected = sympy.zeros(4)
    for place, matrix in enumerate(algebra.matrices):
        for entry, value in matrix.items():
            expected[entry] += sympy.Rational(str(value)) * eta[place]
    up = sympy.Matrix([0, 0, 1])
    for moved in (O * W, W * O):
        rate = moved.row_join(speed).col_join(sympy.zeros(1, 4))
        body = (g.inv() * rate - expected).applyfunc(sympy.expand)
        turning = (moved.T * up - sympy.Matrix(cross(O.T * up, OMEGA))).applyfunc(sympy.expand)
        assert (body == sympy.zeros(4)) == (moved == O * W) == (turning == sympy.zeros(3, 1))


def energy_of_any_body():
    """``P . Omega/2 + V``, for P . Omega = l_Omega . Omega + l_Y . (Omega x s)."""
    P, *_ = in_slopes(put_in=False)
    (b,) = symbols("b*")
    return dot(P, OMEGA) / 2 + GAMMA[0] ** 2 * GAMMA[1] + 3 * GAMMA[2] + dot(b, GAMMA) * GAMMA[1]


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_12_3_2_energy_stays_for_any_lagrangian_and_any_arm(route):
    """Its rate is 0 by both routes, and is not when an acceleration is spoiled."""
    equations = any_body()[route]
    point, rates = motion_at(equations)
    energy = energy_of_any_body()
    assert values([equations.energy], point) == values([energy], point)
    assert rate_at(point, rates, [energy]) == [0]
    assert rate_at(point, rates | {OMEGA[0]: rates[OMEGA[0]] + 1}, [energy]) != [0]


def test_12_3_3_the_constrained_lagrangian_misses_a_force():
    """Plain Euler-Poincare of l_c lacks m r (Gamma x Y) x Omega, which has no power."""
    for name in BALLS:
        given, equations = ball(name), emitted(name)
        reduced = given.energy - 2 * given.m * given.g * dot(given.Gamma, given.chi)  # l_c
        M = [sympy.diff(reduced, x) for x in given.Omega]
        plain = plus(
            cross(M, given.Omega), cross([sympy.diff(reduced, x) for x in given.Gamma], given.Gamma)
        )
        missing = times(given.m * given.r, cross(cross(given.Gamma, given.Y), given.Omega))
        assert sympy.expand(dot(missing, given.Omega)) == 0
        check_law(equations, M, plus(plain, missing))
        with pytest.raises(AssertionError):
            check_law(equations, M, plain)


def test_12_3_3_the_wrong_motion_keeps_energy_and_vertical_momentum_too():
    """For the centred ball the missing force has no part along Gamma: invariants see nothing."""
    given = ball("chaplygin_ball_centred")
    missing = cross(cross(given.Gamma, given.Y), given.Omega)
    assert sympy.expand(dot(missing, given.Gamma)) == 0
    assert any(sympy.expand(part) != 0 for part in missing)
    off = ball("chaplygin_ball")
    assert sympy.expand(dot(cross(cross(off.Gamma, off.Y), off.Omega), off.Gamma)) != 0


def test_12_3_3_the_road_by_the_constrained_lagrangian_is_hamel_s():
    """With the force it gives the motion of the principle, for each ball and any body."""
    for name in BALLS:
        assert "nonholonomic and hamel give the same motion" in proved(name)
    one, two = (motion_at(equations)[1] for equations in any_body().values())
    assert one == two
    assert any(one.values())
    P, _, _, l_Gamma = in_slopes(put_in=True)
    with pytest.raises(AssertionError):
        check_law(any_body()["hamel"], P, plus(cross(P, OMEGA), cross(l_Gamma, GAMMA)))


# -- what is emitted -------------------------------------------------------------------------------


def test_the_rates_of_the_ball_take_at_most_150_operations():
    """For one member, what rests on parameters alone left out; a hand needs about 120."""
    counts = lower(derived("chaplygin_ball")["nonholonomic"])["rhs"].operation_counts()
    assert 100 < sum(counts.values()) <= 150
