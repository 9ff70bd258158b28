"""A body that rolls stays on the plane and does not slip, or the claim is refuted."""

import pytest

from coadjoint.errors import ClaimError
from coadjoint.prove import Certificate, Claim
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.rolling import about_rolling
from coadjoint.prove.zero import Decision
from tests.rolling import BALL, DISK, FOLLOWED_SLEIGH, derived

#: s = u Gamma + v e3 of a spheroid with semi-axes 2, 2, 1: h u = 4, h v = -3 Gamma3.
SPHEROID = (
    "r*Gamma + chi",
    "r*(4*Gamma + vector(0, 0, -3*Gamma3))/sqrt(4*(1 - Gamma3^2) + Gamma3^2)",
)
#: u' + Gamma3 v' = Gamma3 r, not 0.
WRONG = ("r*Gamma + chi", "r*Gamma + vector(0, 0, r*Gamma3)")


def decisions(*changes):
    """The decision of each claim, by the word it turns on."""
    found = {}
    for statement, kind, decide in about_rolling(ConstrainedRates(derived(BALL, *changes))):
        assert kind == "rolling"
        decision = decide()
        assert isinstance(decision, Decision)
        word = next(w for w in ("at rest", "on the plane", "height") if w in statement)
        found[word] = (str(decision.verdict), statement, decision)
    return found


def verdicts(*changes):
    """The three verdicts in order."""
    return [verdict for verdict, *_ in decisions(*changes).values()]


@pytest.mark.parametrize("changes", [(), DISK, (SPHEROID,)], ids=["ball", "disk", "spheroid"])
def test_round_bodies_roll_on_the_plane(changes):
    """The point at the contact is at rest, Gamma . ds/dt = 0, and the height has rate Gamma . Y."""
    assert verdicts(*changes) == ["proved", "proved", "proved"]


def test_a_wrong_profile_leaves_the_plane():
    """That u' + Gamma3 v' is not 0 is refuted with a point; the likely fix is said."""
    verdict, statement, decision = decisions(WRONG)["on the plane"]
    assert verdict == "refuted"
    assert decision.point
    claim = Claim(
        statement, "rolling", decision.verdict, decision.method, 0, decision.point, decision.defect
    )
    with pytest.raises(ClaimError, match="leaves what it rolls on: correct the arm") as caught:
        Certificate("ball", (claim,)).require()
    assert "refuted: the body stays on the plane: dot(Gamma, d(s)/dt) = 0" in str(caught.value)
    assert "Gamma3 = " in str(caught.value)


def test_another_arm_than_that_of_the_constraint_slips():
    """With Y = Omega x s and the arm r Gamma the point at r Gamma moves, at the rate of chi."""
    found = verdicts(('arm = "s"', 'arm = "r*Gamma"'))
    assert found == ["refuted", "proved", "refuted"]


def test_other_systems_make_no_such_claims():
    """A sleigh does not roll."""
    assert list(about_rolling(ConstrainedRates(derived(FOLLOWED_SLEIGH)))) == []
