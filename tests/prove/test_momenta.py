"""Momentum equations against those written by hand."""

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.momenta import _changes, about_momenta, momentum_law
from tests.constrained import BALL, PARTICLE, SLEIGH, motion

JELLETT = '[momenta]\njellett = { section = { Omega = "s" } }\n'
#: The ball with an axis of symmetry through its centre of mass: Routh's sphere.
AXIAL = (
    ("diag(I)*Omega", "vector(I1*Omega1, I1*Omega2, I3*Omega3)"),
    ("dot(Gamma, chi)", "chi3*Gamma3"),
    ('s = "r*Gamma + chi"', 's = "r*Gamma + vector(0, 0, chi3)"'),
)


def examined(text, *changes):
    """Statement and verdict of each momentum equation."""
    rates = motion(text, *changes)
    claims = list(about_momenta(rates))
    assert {kind for _, kind, _ in claims} <= {"momentum"}
    return [(statement, examine().verdict) for statement, _, examine in claims]


def test_jelletts_integral_is_a_momentum():
    """M . s of Routh's sphere is conserved by its momentum equation (Routh 1905, article 243)."""
    assert examined(BALL + JELLETT, *AXIAL) == [
        ("jellett is conserved, by its momentum equation", Verdict.PROVED)
    ]


def test_without_an_axis_jelletts_momentum_changes():
    """The generic ball has the same momentum, and it is not conserved."""
    ((statement, verdict),) = examined(BALL + JELLETT)
    assert statement == "djellett/dt = Sigma l + <dl/dxi, [xi, Sigma]>"
    assert verdict is Verdict.PROVED


def test_the_momentum_of_the_particle_by_hand():
    """Along D_u the momentum m (u + y w) = m (1 + y^2) u changes by m w v = m y u v."""
    section = '[momenta]\nalong = { section = { u = "1" } }\n'
    assert examined(PARTICLE + section) == [("dalong/dt = y*u*v*m", Verdict.PROVED)]


def test_forces_work_along_a_section():
    """A force k along v of the sleigh enters the momentum of v: m v' = m a omega^2 + k."""
    section = '[momenta]\nahead = { section = { v = "1" } }\n[forces]\nv = "k"\n'
    assert examined(SLEIGH + section) == [("dahead/dt = omega^2*m*a + k", Verdict.PROVED)]


def test_a_claim_may_name_a_momentum():
    """A momentum is an observable, so that a claim conserved = ["jellett"] may name it."""
    rates = motion(BALL + JELLETT + '[claims]\nconserved = ["jellett"]\n', *AXIAL)
    observables = dict(rates.equations.exact.observables)
    assert rates.field.is_zero(rates.rate(observables["jellett"]))


@pytest.mark.parametrize("changes", [(), AXIAL])
def test_a_wrong_law_is_refuted(changes):
    """A law with the work of gravity counted twice is not that of the momentum."""
    rates = motion(BALL + JELLETT, *changes)
    (section,) = rates.equations.spec.sections
    law = momentum_law(rates.equations, section)
    weight = rates.field["m"] * rates.field["g"] * rates.field["Gamma1"]
    assert _changes(rates, section, law).verdict is Verdict.PROVED
    assert _changes(rates, section, law + weight).verdict is Verdict.REFUTED
