"""Invariant measures: those of books are found, and what excludes one is said with its scope."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.exact import element_text
from coadjoint.prove import Verdict, measures
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.densities import Measure
from coadjoint.prove.invariant_factors import InvariantFactors
from coadjoint.prove.measures import about_measure
from coadjoint.prove.samples import Samples
from coadjoint.prove.zero import Discovery, decide_zero
from coadjoint.systems import chaplygin_ball
from tests.constrained import PARTICLE
from tests.constrained import motion as small
from tests.contacts import BALL_INSIDE
from tests.prove.rolling import motion
from tests.specs import spec, unitless

#: Suslov's problem with an axis of the constraint that is an eigenvector of the inertia.
PRINCIPAL = [
    (
        'shape = [6], form = "symmetric", default = [2, "0.1", "0.3", 3, "0.4", 4]',
        "shape = [3], default = [2, 3, 4]",
    ),
    ("I*Omega", "diag(I)*Omega"),
    ("dot(a, Omega)", "2*Omega3"),
]


def entries(along):
    """Statements on the measure of a motion with their decisions."""
    found = list(about_measure(along))
    assert {kind for _, kind, _ in found} == {"measure"}
    return [(statement, examine()) for statement, _, examine in found]


def about(name, *changes):
    """Statement and verdict on the one measure of a system."""
    ((statement, decision),) = entries(motion(name, *changes))
    return statement, decision.verdict


def refused(along):
    """What is proved to have no density of the positions, and what was found instead."""
    (none, proof), (other, found) = entries(along)
    assert none.startswith("no measure rho ")
    assert proof.verdict is Verdict.PROVED
    return none, other, found


def test_a_long_factor_has_a_letter(monkeypatch):
    """What is too long for the product is told behind it, and the power stays with its letter."""
    monkeypatch.setattr("coadjoint.prove.completeness.SHOWN", 20)
    statement, verdict = about("veselova")
    assert statement == (
        "an invariant measure: |f1|^(1/2) dOmega dGamma on twistless = 0; where f1 is a function "
        "with 3 terms that begins with Gamma1^2*I2*I3"
    )
    assert verdict is Verdict.PROVED


def test_the_ball_has_chaplygins_measure():
    """Chaplygin 1903: (1 - m r^2 Gamma.J^-1 Gamma)^(-1/2) dM dGamma, dM = det(B^T M B) dOmega."""
    statement, verdict = about("chaplygin_ball_centred")
    assert statement == "an invariant measure: det(B^T M B)^(1/2) dOmega dGamma"
    assert verdict is Verdict.PROVED


def test_veselovas_problem_has_a_measure():
    """Veselov and Veselova 1986: (Gamma . I^-1 Gamma)^(1/2), here times (I1 I2 I3)^(1/2)."""
    statement, verdict = about("veselova")
    factor = "Gamma1^2*I2*I3 + Gamma2^2*I1*I3 + Gamma3^2*I1*I2"
    assert statement == (f"an invariant measure: |{factor}|^(1/2) dOmega dGamma on twistless = 0")
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
        f"an invariant measure: |{element_text(ring, first)}| "
        f"|{element_text(ring, rest)}|^(1/2) dOmega dGamma"
    )


def test_the_volume_itself_is_kept_by_disks():
    """Vertical and rolling disk: div X = 0 (on the way of Gamma, s^2 and s.Is are constants)."""
    for name, volume in (
        ("rolling_disk_vertical", "dtheta dphi dx dy dvtheta dvphi"),
        ("rolling_disk", "dOmega dGamma"),
    ):
        assert about(name) == (f"an invariant measure: {volume}", Verdict.PROVED)


def test_the_ball_off_centre_has_no_density_of_the_attitude():
    """What is proved is said: of densities rho(Gamma), on the unit sphere, at almost all values."""
    none, other, found = refused(motion("chaplygin_ball"))
    assert none == (
        "no measure rho dOmega dGamma with a smooth positive density rho(Gamma) is invariant on "
        "any open set of states where dot(Gamma, Gamma) = 1, for almost all parameters: the "
        "conditions along Omega1, Omega2, Omega3 have no solution"
    )
    assert other == "no invariant measure was found with a density that depends on velocities"
    assert isinstance(found, Discovery)
    assert "velocities, the common divisor of rates" in found.method


def test_the_sleigh_keeps_a_measure_with_a_density_in_its_turning():
    """The measure is dv domega/|omega|, since (I + m a^2) domega/dt = -m a v omega."""
    none, other, found = refused(motion("chaplygin_sleigh"))
    assert "rho dv domega with a constant rho is invariant on any open set of states, for" in none
    assert other == "an invariant measure, where its density is finite: |omega|^(-1) dv domega"
    assert found.verdict is Verdict.PROVED


def test_suslovs_problem_keeps_a_measure_beside_the_line_of_rest():
    """With a = e3 the body rests where I13 Omega1 + I23 Omega2 = 0; over it the plane is kept."""
    none, other, found = refused(motion("suslov", ("dot(a, Omega)", "2*Omega3")))
    assert "rho dOmega on wheels = 0 with a constant rho is invariant" in none
    assert other == (
        "an invariant measure, where its density is finite: |Omega1*I13 + Omega2*I23|^(-1) dOmega "
        "on wheels = 0"
    )
    assert found.verdict is Verdict.PROVED


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


@pytest.mark.parametrize(
    ("force", "reason", "power"),
    [
        ("-r*vtheta", "the conditions at rest have no solution", "-1"),
        ("-r*vtheta^3", "div X is not affine in velocities", "-3"),
    ],
)
def test_friction_has_no_measure_of_positions(force, reason, power):
    """A disk with resistance shrinks volumes, where no density of positions changes.

    dv = -k v^n dt has the measure v^-n dv.
    """
    change = ("[constraints]", f'[forces]\nvtheta = "{force}"\n\n[constraints]')
    none, other, found = refused(motion("rolling_disk_vertical", change))
    assert "a smooth positive density rho(theta, phi, x, y) is invariant on any open set" in none
    assert none.endswith(reason)
    volume = "dtheta dphi dx dy dvtheta dvphi"
    assert other == (
        f"an invariant measure, where its density is finite: |vtheta|^({power}) {volume}"
    )
    assert found.verdict is Verdict.PROVED


#: Linear forces with the eigenvalues 2 and -1, whose left eigenvectors are 2 u + v and u - v.
SADDLE = [
    ("w == y*u", "w == 0"),
    ("[constraints]", '[forces]\nu = "m*(u + v)"\nv = "2*m*u"\n' + "[constraints]"),
]


def test_invariant_lines_that_divide_no_rate_are_found():
    """With du/dt = u + v, dv/dt = 2 u the determinant of both has the invariant lines."""
    along = small(PARTICLE, *SADDLE)
    search = InvariantFactors(along, {})
    u, v = along.field["u"], along.field["v"]
    assert search.short() == []
    assert sorted(map(str, search.all())) == sorted(map(str, [2 * u + v, u - v]))
    assert not search.is_invariant(u + v)
    _, other, found = refused(along)
    assert found.verdict is Verdict.PROVED
    assert other.startswith("an invariant measure: |u - v| dx dy dz du dv")


def test_an_integral_is_no_invariant_factor():
    """Its powers change no measure: the disk keeps vtheta and vphi."""
    along = motion("rolling_disk_vertical")
    search = InvariantFactors(along, {})
    assert not search.is_invariant(along.field["vtheta"])
    sleigh = motion("chaplygin_sleigh")
    assert InvariantFactors(sleigh, {}).is_invariant(sleigh.field["omega"])
    assert not InvariantFactors(sleigh, {}).is_invariant(sleigh.field["v"])


def test_wrong_densities_in_velocities_are_refuted():
    """|omega| to another power, or a power of v, is no density of the sleigh."""
    along = motion("chaplygin_sleigh")
    omega, v = along.field["omega"], along.field["v"]

    def verdict(*powers):
        return decide_zero([along.grow(powers)], along.field).verdict

    assert verdict((omega, Fraction(-1))) is Verdict.PROVED
    assert verdict((omega, Fraction(1))) is Verdict.REFUTED
    assert verdict((v, Fraction(-1))) is Verdict.REFUTED


def test_a_contradiction_of_fields_that_could_have_a_larger_rank_is_found_not_proved():
    """A density of Gamma whose fields have rank 2 of 3: without the unit length luck is in it."""
    along = motion("chaplygin_ball", ('default = [0, "0.6", "0.8"]', "default = [0, 1, 1]"))
    (none, found), *_ = entries(along)
    assert none.startswith("no measure rho dOmega dGamma")
    assert isinstance(found, Discovery)
    assert "probability below" in found.error


def test_what_is_not_looked_for_is_told(monkeypatch):
    """More coupled velocities than determinants can take: no silence, and no claim."""
    monkeypatch.setattr("coadjoint.prove.measures.SIZE", 2)
    ((statement, found),) = entries(motion("chaplygin_ball_centred"))
    assert statement == (
        "an invariant measure was not searched for: 3 unknowns are solved for together, more than 2"
    )
    assert isinstance(found, Discovery)


def test_wrong_densities_are_refuted():
    """Another exponent of the ball's determinant, or the right one for another motion, fails."""
    along = motion("chaplygin_ball_centred")
    measure, where = Measure(along), Samples(along).where
    whole = measure.minors[0]

    def verdict(exponent):
        return decide_zero([along.grow([(whole, exponent)])], along.field, where).verdict

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


def test_conditions_that_are_too_long_leave_the_measure_undecided(monkeypatch):
    """Of a ball in a cone: work is counted, so that the verdict is the same on every machine."""
    cone = unitless(BALL_INSIDE).replace("b^2 - X1^2 - X2^2", "b^2*X3^2 - X1^2 - X2^2")
    declared = spec(cone)
    along = ConstrainedRates(derive(declared, setting=make_setting(declared)))
    monkeypatch.setattr(measures, "BRACKET_WORK", 500)
    ((statement, found),) = entries(along)
    assert statement.startswith("whether an invariant measure rho domega dc dX exists")
    assert "is not decided; no formula was found" in statement
    assert isinstance(found, Discovery)
    assert "more than 500 operations of exact arithmetic" in found.method
    assert found.scope == "no statement"


def test_the_budget_of_brackets_hides_no_measure_that_is_known(monkeypatch):
    """A formula needs no brackets, and is found and proved without any."""
    monkeypatch.setattr(measures, "BRACKET_WORK", 0)
    statement, verdict = about("chaplygin_ball_centred")
    assert statement == "an invariant measure: det(B^T M B)^(1/2) dOmega dGamma"
    assert verdict is Verdict.PROVED
