"""A body that rolls on a surface neither slips nor leaves it, or the claim is refuted."""

import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.contact import Touch
from coadjoint.errors import ClaimError
from coadjoint.exact.dense import scale
from coadjoint.prove import prove
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.rolling import about_rolling
from coadjoint.prove.zero import UndecidedError
from tests.contacts import BALL_INSIDE, ELLIPSOID, IN_SPHERE, ON_PLANE, ON_TURNTABLE
from tests.rolling import derived
from tests.specs import prove_claims, spec

#: What each claim turns on.
WORDS = (
    "at rest",
    "moves with",
    "stays on the surface",
    "stays on the body",
    "stay opposite",
    "stays at the radius",
    "is constant",
    "goes over into itself",
    "step of Newton",
    "as they are",
    "moves the centre",
)
BALL = ["at rest", "stays on the surface", "stays at the radius"]
TURNED = ["moves with", "stays on the surface", "stays at the radius", "goes over into itself"]
BODY = ["at rest", "stays on the surface", "stays on the body", "stay opposite", "is constant"]
PROJECTED = ["step of Newton", "as they are"]
CENTRED = [*PROJECTED, "moves the centre"]


def verdicts(equations):
    """The verdict of each claim, by the word that it turns on."""
    found = {}
    for statement, kind, decide in about_rolling(ConstrainedRates(equations)):
        assert kind == "rolling"
        (word,) = (word for word in WORDS if word in statement)
        found[word] = str(decide().verdict)
    return found


def refuted(text, *changes):
    """The claims that are refuted."""
    return [
        word for word, verdict in verdicts(derived(text, *changes)).items() if verdict != "proved"
    ]


@pytest.mark.parametrize(
    ("text", "changes", "claims"),
    [
        (BALL_INSIDE, (), BALL + CENTRED),
        (BALL_INSIDE, IN_SPHERE, BALL + CENTRED),
        (BALL_INSIDE, ON_TURNTABLE, TURNED + CENTRED),
        (ELLIPSOID, (), BODY + PROJECTED),
        (ELLIPSOID, ON_PLANE, BODY + PROJECTED),
    ],
    ids=["cylinder", "sphere", "turntable", "paraboloid", "plane"],
)
def test_bodies_stay_in_contact(text, changes, claims):
    """All claims are proved, for balls and for other bodies."""
    assert verdicts(derived(text, *changes)) == dict.fromkeys(claims, "proved")


@pytest.mark.parametrize("text", [BALL_INSIDE, ELLIPSOID], ids=["ball", "ellipsoid"])
def test_a_wrong_sign_of_the_curvature_is_refuted(text, monkeypatch):
    """With that of the surface taken for the other side the ball loses its distance."""
    hessian = Touch._hessian

    def flipped(self, slopes, names):
        rows = hessian(self, slopes, names)
        return scale(self.setting.field.number(-1), rows) if names == self.place else rows

    monkeypatch.setattr(Touch, "_hessian", flipped)
    word = "stays at the radius" if text == BALL_INSIDE else "stay opposite"
    assert verdicts(derive(spec(text)))[word] == "refuted"


@pytest.mark.parametrize("text", [BALL_INSIDE, ELLIPSOID], ids=["ball", "ellipsoid"])
def test_a_wrong_normal_is_refuted(text, monkeypatch):
    """A normal that points to the other side moves the contact backwards."""
    spread = Touch.spread

    def backwards(self, moved):
        return spread(self, scale(self.setting.field.number(-1), moved))

    monkeypatch.setattr(Touch, "spread", backwards)
    word = "stays at the radius" if text == BALL_INSIDE else "stay opposite"
    assert verdicts(derive(spec(text)))[word] == "refuted"


def test_a_surface_whose_turning_is_forgotten_is_refuted():
    """With [rolling] at rest the constraint of a turntable slips, and the other way round."""
    _, constraint, turns = ON_TURNTABLE
    plane = ON_TURNTABLE[0]
    assert "at rest" in refuted(BALL_INSIDE, plane, constraint)
    assert "moves with" in refuted(BALL_INSIDE, plane, turns)


def test_a_surface_that_does_not_go_over_into_itself_is_refuted():
    """An inclined plane that turns about the vertical is another plane later."""
    found = refuted(BALL_INSIDE, ("b^2 - X1^2 - X2^2", "X3 - X1/5"), *ON_TURNTABLE[1:])
    assert "goes over into itself" in found


def test_an_arm_to_the_other_side_is_refuted():
    """With Y = Omega x s and the arm s the point -s is at rest, which is not the contact."""
    found = refuted(
        ELLIPSOID, ('"Y == cross(s, Omega)"', '"Y == cross(Omega, s)"'), ('"-s"', '"s"')
    )
    assert found == ["is constant"]


def test_the_energy_and_both_routes_of_an_ellipsoid_are_proved():
    """No curvature is written out; the certificate says nothing of what would need it."""
    certificate = prove(spec(ELLIPSOID))
    statements = {claim.statement: str(claim.verdict) for claim in certificate.claims}
    assert statements["the energy is conserved"] == "proved"
    assert statements["nonholonomic and hamel give the same motion"] == "proved"
    assert set(statements.values()) == {"proved"}
    assert not any("reversible" in each or "invariant measure" in each for each in statements)
    with pytest.raises(ClaimError, match="is conserved"):
        prove(spec(ELLIPSOID, ('["energy"]', '["energy", "X3"]'))).require()


def test_the_work_of_a_turntable_is_that_of_its_constraint():
    """The energy is not conserved, and its rate is proved."""
    certificate = prove(spec(BALL_INSIDE, *ON_TURNTABLE))
    certificate.require()  # that all routes are equal, too
    claims = certificate.claims
    found = [(c.statement, str(c.verdict)) for c in claims if c.statement.startswith("the energy")]
    assert found == [("the energy changes by the work of the moving constraints", "proved")]


def test_a_surface_without_points_is_pointed_at():
    """The message of an undecided claim has the line of the surface, and carets below it."""
    with pytest.raises(UndecidedError) as caught:
        prove_claims(spec(BALL_INSIDE, ("b^2 - X1^2 - X2^2", "b^2 + X1^2 + X2^2")))
    error = caught.value
    first, *_, line, carets = str(error).splitlines()
    assert first.startswith(f"sample.toml:{error.line}: rolling.surface: undecided: ")
    assert "holds nowhere" in first
    assert line[carets.index("^") : len(carets)] == '"b^2 + X1^2 + X2^2"'
    assert BALL_INSIDE.splitlines()[error.line - 1].startswith("surface = ")
