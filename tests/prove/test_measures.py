"""Invariant measures: those of books are found and proved, and where none is, that is proved."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.exact import element_text
from coadjoint.prove import Verdict
from coadjoint.prove.invariant_factors import factors
from coadjoint.prove.measures import Measure, about_measure
from coadjoint.prove.samples import Samples
from coadjoint.prove.zero import decide_zero
from coadjoint.systems import chaplygin_ball
from tests.prove.rolling import motion

#: Suslov's problem with an axis of the constraint that is an eigenvector of the inertia.
PRINCIPAL = [
    (
        'shape = [6], form = "symmetric", default = [2, "0.1", "0.3", 3, "0.4", 4]',
        "shape = [3], default = [2, 3, 4]",
    ),
    ("I*Omega", "diag(I)*Omega"),
    ("dot(a, Omega)", "Omega3"),
]


def about(name, *changes):
    """Statement and verdict on the measure of a system."""
    ((statement, kind, examine),) = about_measure(motion(name, *changes))
    assert kind == "measure"
    return statement, examine().verdict


def test_the_ball_has_chaplygins_measure():
    """Chaplygin 1903: (1 - m r^2 Gamma.J^-1 Gamma)^(-1/2) dM dGamma, dM = det(B^T M B) dOmega."""
    statement, verdict = about("chaplygin_ball_centred")
    assert statement == "an invariant measure: det(B^T M B)^(1/2) dOmega dGamma"
    assert verdict is Verdict.PROVED


def test_veselovas_problem_has_a_measure():
    """Veselov and Veselova 1986: (Gamma . I^-1 Gamma)^(1/2), here times (I1 I2 I3)^(1/2)."""
    statement, verdict = about("veselova")
    factor = "Gamma1^2*I2*I3 + Gamma2^2*I1*I3 + Gamma3^2*I1*I2"
    assert statement == (f"an invariant measure: ({factor})^(1/2) dOmega dGamma on twistless = 0")
    assert verdict is Verdict.PROVED


def test_rouths_sphere_has_the_measure_of_bodies_of_revolution():
    """Borisov and Mamaev 2002: (I1 I3 + m s.I s)^(-1/2) dM dGamma, det = (I1 + m s^2)(...)."""
    along = motion("routh_sphere")
    ring = along.field
    i1, i3, m, r, a = (ring[name] for name in ("I1", "I3", "m", "r", "l"))
    g = [ring[f"Gamma{n}"] for n in (1, 2, 3)]
    s = [r * g[0], r * g[1], r * g[2] + a]
    rest = i1 * i3 + m * (i1 * (s[0] ** 2 + s[1] ** 2) + i3 * s[2] ** 2)
    first = i1 + m * (s[0] ** 2 + s[1] ** 2 + s[2] ** 2)
    statement, verdict = about("routh_sphere")
    assert verdict is Verdict.PROVED
    assert statement == (
        f"an invariant measure: ({element_text(ring, first)}) "
        f"({element_text(ring, rest)})^(1/2) dOmega dGamma"
    )


def test_the_volume_itself_is_kept_by_disks():
    """Vertical and rolling disk: div X = 0 (on the way of Gamma, s^2 and s.Is are constants)."""
    for name, volume in (
        ("rolling_disk_vertical", "dtheta dphi dx dy dvtheta dvphi"),
        ("rolling_disk", "dOmega dGamma"),
    ):
        assert about(name) == (f"an invariant measure: {volume}", Verdict.PROVED)


@pytest.mark.parametrize(
    ("name", "changes", "along"),
    [
        ("chaplygin_ball", [], "Omega1, Omega2, Omega3"),
        ("chaplygin_sleigh", [], "v"),
        ("suslov", [], "Omega"),
    ],
)
def test_where_there_is_no_measure_that_is_proved(name, changes, along):
    """Kozlov 1987: Suslov's problem; the sleigh slows down to an axis; the ball off centre."""
    statement, verdict = about(name, *changes)
    assert verdict is Verdict.PROVED
    assert statement.startswith("no invariant measure rho ")
    assert f"along {along}" in statement


@pytest.mark.parametrize(
    ("name", "changes", "volume"),
    [
        ("suslov", PRINCIPAL, "dOmega on wheels = 0"),
        ("chaplygin_sleigh", [("u + a*omega", "u")], "dv domega"),
    ],
)
def test_the_exceptions_have_one(name, changes, volume):
    """Kozlov 1987: an axis that is an eigenvector; the sleigh with its mass above the blade."""
    assert about(name, *changes) == (f"an invariant measure: {volume}", Verdict.PROVED)


def test_friction_has_no_measure_of_positions():
    """A vertical disk with resistance shrinks volumes at rest, where no density changes."""
    change = ("[constraints]", '[forces]\nvtheta = "-r*vtheta"\n\n[constraints]')
    statement, verdict = about("rolling_disk_vertical", change)
    assert statement.startswith("no invariant measure rho ")
    assert "along rest contradicts itself" in statement
    assert verdict is Verdict.PROVED
    cubic = ("[constraints]", '[forces]\nvtheta = "-r*vtheta^3"\n\n[constraints]')
    statement, verdict = about("rolling_disk_vertical", cubic)
    assert statement.endswith("div X is not affine in the velocities")
    assert verdict is Verdict.PROVED


def test_wrong_densities_are_refuted():
    """Another exponent of the ball's determinant, or the right one for another motion, fails."""
    along = motion("chaplygin_ball_centred")
    measure, where = Measure(along), Samples(along).where
    whole = measure.minors[0]

    def verdict(exponent):
        return decide_zero([measure.defect([(whole, exponent)])], along.field, where).verdict

    assert verdict(Fraction(1, 2)) is Verdict.PROVED
    assert verdict(Fraction(-1, 2)) is Verdict.REFUTED
    assert verdict(Fraction(1, 3)) is Verdict.REFUTED


def test_the_divergence_is_the_trace_of_the_jacobian():
    """Cramer's rule gives the trace of the slopes that the kernel computes."""
    along = motion("chaplygin_ball")
    ring, names = along.field, along.equations.setting
    state = [Fraction(n, 7) for n in (3, -2, 5, 2, 3, 6)]
    numbers = {"I1": 1, "I2": 2, "I3": 3, "m": 1, "r": 1, "g": 9, "chi1": 0, "chi2": 1, "chi3": 0}
    numbers = {name: Fraction(value, 4) for name, value in numbers.items()}
    point = dict(zip(names.state, state, strict=True)) | numbers
    found = ring.evaluate(Measure(along).divergence, point, Fraction, None)
    parameters = [float(numbers[name]) for name in names.parameters]
    slopes = chaplygin_ball.jacobian(np.array(state, dtype=float), parameters, target="numpy")
    assert found != 0
    assert np.trace(slopes) == pytest.approx(float(found), rel=1e-12)  # a few roundings


def test_factors_are_found_among_the_symbols_that_occur():
    """a(a + b) has two factors; a sum that does not factor has one; a number none."""
    ring = motion("chaplygin_ball").field
    a, b = ring["Gamma1"], ring["Gamma2"]
    assert len(factors(ring, a**2 + a * b)) == 2
    assert factors(ring, a**2 + b**2) == [a**2 + b**2]
    assert factors(ring, ring.number(3)) == factors(ring, ring.zero) == []
