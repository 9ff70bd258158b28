"""Holm (2011), chapter 12: balls that roll, typed by hand, and changes that are refuted.

Rates are SymPy sums of slopes along the emitted motion at exact points, where the accelerations
come from the engine's elimination and the laws from the book.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
import sympy

from coadjoint.errors import CoadjointError
from coadjoint.lower.lowering import lower
from coadjoint.prove import Verdict, prove
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.zero import decide_zero
from coadjoint.resources import derivations_folder
from coadjoint.systems import chaplygin_ball, routh_sphere
from tests.conftest import rational_points
from tests.sources.balls import BALLS
from tests.sources.components import cross, dot, plus, times
from tests.sources.test_equations import derived, emitted, values
from tests.specs import spec

OMEGA, GAMMA = (sympy.symbols(f"{name}1:4") for name in ("Omega", "Gamma"))
STATE = [*OMEGA, *GAMMA]


def text_of(name):
    """The text of a shipped spec."""
    return (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")


def total(parts):
    """The sum of vectors."""
    return [sum(column) for column in zip(*parts, strict=True)]


def ball(name):
    """A ball in symbols, its formulas typed by hand."""
    equations = emitted(name)
    return BALLS[name](equations.state, equations.parameters)


def motion_at(equations, changed=None, seed=3):
    """An exact point with what the kernel solves for there, and the rates of the state."""
    names = list(map(str, (*equations.state, *equations.parameters)))
    (point,) = rational_points(names, 1, seed)
    return followed(equations, point | (changed or {}))


def followed(equations, point):
    """A point with its definitions, one after the other, and the rates of the state."""
    to_sympy, point = equations.setting.field.to_sympy, dict(point)
    for name, value in equations.exact.definitions:
        (point[name],) = values([to_sympy(value)], point)
    rates = values(map(to_sympy, equations.exact.rates), point)
    return point, dict(zip(equations.state, rates, strict=True))


def rate_at(point, rates, expressions):
    """Time derivatives by the slopes of expressions in the state."""
    moved = [sum(sympy.diff(e, x) * sympy.Symbol(f"_{x}") for x in rates) for e in expressions]
    return values(moved, point | {f"_{x}": rate for x, rate in rates.items()})


def check_law(equations, momentum, law, changed=None):
    """``d(momentum)/dt`` along the motion is a law, which is not 0, at a point."""
    point, rates = motion_at(equations, changed)
    check_values(rate_at(point, rates, momentum), law, point)


def check_values(found, law, point):
    """Values are those of a law, which is not 0."""
    expected = values(law, point)
    assert any(expected)
    assert found == expected


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
    given = ball(name)
    parts = terms(given)
    point, rates = motion_at(emitted(name))
    found = rate_at(point, rates, given.M)
    check_values(found, total(parts), point)
    for place in range(3):
        for sign in (0, -1):
            spoiled = [times(sign if n == place else 1, part) for n, part in enumerate(parts)]
            with pytest.raises(AssertionError):
                check_values(found, total(spoiled), point)


def test_12_1_2_the_force_of_the_plane_moves_the_ball():
    """In space m dv/dt = R - m g z and d(I omega)/dt = -s x R; not with s x R."""
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
    stated = {f"{name} is conserved" for name in ("the energy", "vertical", "dot(M, M)")}
    assert stated <= proved("chaplygin_ball_centred")
    off = ball("chaplygin_ball")
    with pytest.raises(AssertionError):
        check_law(emitted("chaplygin_ball"), off.M, cross(off.M, off.Omega))


def test_12_2_1_off_centre_these_integrals_are_none():
    """M . Gamma and M . M are refuted with a point at which they move; centred, they are not."""
    for name, verdict in (
        ("chaplygin_ball", Verdict.REFUTED),
        ("chaplygin_ball_centred", Verdict.PROVED),
    ):
        motion = ConstrainedRates(emitted(name))
        M = [dict(emitted(name).exact.observables)[f"Omega_momentum{n}"] for n in (1, 2, 3)]
        up = [motion.field[f"Gamma{n}"] for n in (1, 2, 3)]
        for integral in (dot(M, M), dot(M, up)):
            found = decide_zero([motion.rate(integral)], motion.field)
            assert found.verdict is verdict
            assert bool(found.point) == (verdict is Verdict.REFUTED)


def divergence(equations, point):
    """``sum d(dOmega_i/dt)/dOmega_i``: the accelerations are quadratic in Omega, Gamma turns."""
    found = Fraction(0)
    for name in OMEGA:
        sides = []
        for step in (1, -1):
            _, rates = followed(equations, point | {str(name): point[str(name)] + step})
            sides.append(rates[name])
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
    """About the fixed point J dOmega/dt = J Omega x Omega + m g Gamma x chi."""
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
    """For chi along the third axis, with I1 + m chi^2 and I2 + m chi^2; not with I1."""
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


# -- what is emitted -------------------------------------------------------------------------------


def test_the_rates_of_the_ball_take_at_most_150_operations():
    """For one member, what rests on parameters alone left out; a hand needs about 120."""
    counts = lower(derived("chaplygin_ball")["nonholonomic"])["rhs"].operation_counts()
    assert 100 < sum(counts.values()) <= 150


@pytest.fixture(scope="module")
def run():
    """The ball of the defaults, rolling for ten seconds."""
    return chaplygin_ball.simulate({"Omega": [1, 2, 3], "Gamma": [0, 0.6, 0.8]}, (0, 10))


def test_along_a_run_energy_drifts_as_the_integrator_does(run):
    """To 1e-8 of its value, at a tolerance of 1e-10 a step; M . Gamma, no integral, moves."""
    assert run.status == "OK"
    assert np.ptp(run["energy"]) < 1e-8 * abs(run["energy"][0])
    lengths = np.sum(run["Gamma"] ** 2, axis=0)
    assert np.abs(lengths - 1).max() < 1e-8
    assert np.ptp(run["vertical"]) > 0.1


def test_along_a_run_the_point_of_contact_rests(run):
    """Y = Omega x s to rounding, with s by hand; with s of the other sign it does not."""
    chi = np.array([[0.1], [0.2], [0.3]])
    for sign in (1, -1):
        s = run["Gamma"] + sign * chi
        slip = np.abs(run["Y"] - np.cross(run["Omega"], s, axis=0)).max()
        assert (slip < 1e-13) == (sign == 1)
    states = np.concatenate([run["Omega"], run["Gamma"]])
    assert not chaplygin_ball.constraint_residual(states).any()


def test_numpy_and_c_agree_to_the_last_bit(run):
    """Along a run, odd in number, for all functions."""
    states = np.concatenate([run["Omega"], run["Gamma"]])
    assert states.shape[1] % 2
    for function in ("rhs", "jacobian", "energy", "observables", "poisson_tensor"):
        kernel = getattr(chaplygin_ball, function)
        found = kernel(states, target="c")
        assert np.isfinite(found).all()
        assert found.any()
        assert (found == kernel(states, target="numpy")).all()


def test_a_sleeping_sphere_falls_below_its_threshold():
    """Stable for (I3 + m r h)^2 w^2 > 4 (I1 + m h^2) m g l, h = r + l, to 5 %; no top has that.

    Derived here: with x + i y = exp(i k t) for the tilt, (I1 + m h^2) k^2 + (2 (I1 + m h^2) -
    I3 - m r h) w k + (I1 + m h^2 - I3 - m r h) w^2 + m g l = 0, k real above; r = 0 gives the
    sleeping top.
    """
    I1, I3, m, r, g, offset = 0.4, 0.5, 1.2, 0.9, 9.81, 0.3
    h = r + offset
    fastest = np.sqrt(4 * (I1 + m * h**2) * m * g * offset)
    for inertia, holds in ((I3 + m * r * h, True), (I3, False)):
        growth = []
        for factor in (1.05, 0.95):
            state = [0, 0, factor * fastest / inertia, 0, 0, 1]
            slopes = routh_sphere.jacobian(state, [I1, I3, m, r, g, offset])
            growth.append(np.linalg.eigvals(slopes).real.max())
        # zero to the root of a rounding error: the spin and the length of Gamma are a double zero
        assert (growth[0] < 1e-6 and growth[1] > 0.1) == holds


def test_a_centre_of_mass_outside_the_ball_is_refused():
    """The condition and the offending value are told."""
    with pytest.raises(CoadjointError, match="inside") as caught:
        routh_sphere.simulate([0, 0, 1, 0, 0, 1], (0, 1), {"l": 1.5})
    assert "1.5" in str(caught.value)
