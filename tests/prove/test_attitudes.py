"""Attitudes in the state: what is proved of them, and how a wrong one is caught."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from coadjoint.algebra import attitudes, catalogue
from coadjoint.algebra.representation import Representation
from coadjoint.derive import derive, equations
from coadjoint.derive.mechanics import projection
from coadjoint.errors import AlgebraError
from coadjoint.spec import read_spec
from tests.specs import prove_claims, spec
from tests.turning import BY_QUATERNION, LEVEL, SHAKEN, TIED, TOP

EXAMPLES = Path(__file__).parents[2] / "examples"
RIGHT = (
    ('name = "so(3)"', 'name = "so(3)"\ninvariance = "right"'),
    (', "newton-euler"', ""),
    (', "dot(Pi, Gamma)"', ""),
)
#: A body with attitude and quaternion that cannot spin and is pushed, velocities its state.
PUSHED = """
title = "A body that cannot spin about its third axis"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
R = { role = "attitude" }
q = { role = "quaternion" }
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[inputs]
u = { shape = [3], default = 0 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - R[3, 3]"
[forces]
Omega = "transpose(R)*u + rotate(conjugate(q), u)"
[constraints]
spinless = "Omega[3] == 0"
[claims]
conserved = ["dot(q, q)"]
"""
#: One route is enough where routes are not the question.
FEW = (', "hamel", "nonholonomic-hamilton-pontryagin"', "")
#: What solvers do to an attitude R, and that a constraint is met at the moved one.
MOVED_BACK = "the solvers move R back: R_gram = 1 + D becomes 1 + D^2 (D - 3)/4"
FIRST_BACK = (
    "the projection moves R back first, then the state onto the constraints at the moved R, and "
    "this second move leaves R as it is"
)


def verdicts(declared, routes=()):
    """The verdict on each claim by its statement."""
    return {c.statement: c.verdict.value for c in prove_claims(declared, routes).claims}


@pytest.mark.parametrize(
    ("declared", "laws"),
    [
        (
            spec(TOP),
            [
                "dR/dt = R*hat(Omega)",
                "R_gram = R*transpose(R) is conserved",
                "the solvers move R back: R_gram = 1 + D becomes 1 + D^2 (D - 3)/4",
            ],
        ),
        (
            spec(TOP, *BY_QUATERNION),
            [
                "dq/dt = qmul(q, (0, Omega))/2",
                "q_gram = dot(q, q) is conserved",
                "the solvers move q back: q_gram = 1 + D becomes 1 + D^2 (D - 3)/4",
            ],
        ),
        (
            spec(TIED),
            [
                "dg/dt = R*[hat(Omega), v] with g = [R, x]",
                "g_gram = rotation(g)*transpose(rotation(g)) is conserved",
                "R*Pi + cross(x, R*P) is conserved where rotation(g)*transpose(rotation(g)) = 1, "
                "det(rotation(g)) = 1",
            ],
        ),
        (
            spec(TOP.replace("R*transpose(R)", "transpose(R)*R"), *RIGHT),
            ["dR/dt = hat(Omega)*R", "R_gram = transpose(R)*R is conserved"],
        ),
        (
            spec(PUSHED),
            [
                "dR/dt = R*hat(Omega)",
                "dq/dt = qmul(q, (0, Omega))/2",
                "dot(q, q) is conserved",
                "the solvers move q back: q_gram = 1 + D becomes 1 + D^2 (D - 3)/4",
            ],
        ),
        (spec(LEVEL), [FIRST_BACK, MOVED_BACK]),
        (spec(SHAKEN), [MOVED_BACK]),
    ],
    ids=["attitude", "quaternion", "pose", "right", "pushed", "level", "shaken"],
)
def test_attitudes_turn_with_the_body_and_stay_rotations(declared, laws):
    """On every route, next to forces, inputs and constraints."""
    found = verdicts(declared)
    assert set(found.values()) == {"proved"}
    assert found.keys() >= set(laws)


def wrong_side(name):
    """The representation of an attitude by the law of the other side."""
    right = catalogue.ATTITUDES[name]
    return lambda algebra, invariance: right(
        algebra, {"left": "right", "right": "left"}[invariance]
    )


@pytest.mark.parametrize("changes", [(), BY_QUATERNION], ids=["attitude", "quaternion"])
def test_a_product_from_the_wrong_side_is_caught(monkeypatch, changes):
    """dR/dt = -hat(Omega) R and dq/dt = -(0, Omega) q/2 keep rotations, and are refuted."""
    name = "quaternion" if changes else "attitude"
    monkeypatch.setitem(catalogue.ATTITUDES, name, wrong_side(name))
    found = verdicts(spec(TOP, *changes, (', "dot(Pi, Gamma)"', "")))
    refuted = [statement for statement, verdict in found.items() if verdict != "proved"]
    assert refuted[0] == "dq/dt = qmul(q, (0, Omega))/2" if changes else "dR/dt = R*hat(Omega)"


def test_a_quaternion_without_its_half_is_caught(monkeypatch):
    """As a representation, and by the law where only the rates have it."""
    monkeypatch.setattr(attitudes, "Fraction", lambda side, _: Fraction(side))
    with pytest.raises(AlgebraError, match="do not commute like"):
        spec(TOP, *BY_QUATERNION)
    monkeypatch.undo()
    declared = spec(TOP, *BY_QUATERNION)
    right = derive(declared)
    rates = [(1 + (n < 4)) * rate for n, rate in enumerate(right.exact.rates)]
    wrong = replace(right, exact=replace(right.exact, rates=tuple(rates)))
    found = verdicts(declared, [wrong])
    assert found["dq/dt = qmul(q, (0, Omega))/2"] == "refuted"


def test_a_wrong_step_back_is_caught(monkeypatch):
    """The residuals as the step is proved to leave them are not those of half the step."""
    right = projection.turned_back

    def half(setting):
        return {name: (setting.field[name] + x) / 2 for name, x in right(setting).items()}

    monkeypatch.setattr(projection, "turned_back", half)
    found = verdicts(spec(TOP, *BY_QUATERNION))
    refuted = [statement for statement, verdict in found.items() if verdict == "refuted"]
    assert refuted == ["the solvers move q back: q_gram = 1 + D becomes 1 + D^2 (D - 3)/4"]


def too_early(setting, onto):
    """Velocities onto the constraints at the attitude before it is moved."""
    moved = projection.turned_back(setting)
    rates = zip(setting.state, onto.rates, strict=True)
    return replace(onto, rates=tuple(moved.get(name, x) for name, x in rates))


def twice_as_far(setting, onto):
    """A velocity by twice what it lacks."""
    whole = projection.back_then_onto(setting, onto)
    name, value = onto.definitions[-1]
    return replace(whole, definitions=(*whole.definitions[:-1], (name, 2 * value)))


def turned_by_the_solve(setting, onto):
    """A second move that turns R again."""
    whole = projection.back_then_onto(setting, onto)
    return replace(whole, rates=(whole.rates[1], *whole.rates[1:]))


@pytest.mark.parametrize("wrong", [too_early, twice_as_far, turned_by_the_solve])
def test_moves_in_the_wrong_order_are_caught(monkeypatch, wrong):
    """Constraints at the attitude that was left, another solve, and an attitude that is undone."""
    declared = spec(LEVEL, FEW)
    assert verdicts(declared)[FIRST_BACK] == "proved"
    monkeypatch.setattr(equations, "back_then_onto", wrong)
    assert verdicts(declared)[FIRST_BACK] == "refuted"


def test_a_torque_of_the_wrong_sign_is_caught(monkeypatch):
    """By the energy, by the angular momentum in space, and by the routes that know no diamond."""
    diamond = Representation.diamond
    monkeypatch.setattr(
        Representation, "diamond", lambda self, b, a: tuple(-x for x in diamond(self, b, a))
    )
    found = verdicts(spec(TIED, ('"euler-poincare", "lie-poisson"', '"euler-poincare"')))
    refuted = {statement for statement, verdict in found.items() if verdict == "refuted"}
    assert "the energy is conserved" in refuted
    assert any("euler-poincare and newton-euler give the same motion" in each for each in refuted)


def test_a_transposed_matrix_is_caught():
    """The vertical seen from the body is R^T e3."""
    found = verdicts(spec(TOP, ("dot(Pi, Gamma)", "dot(Pi, R*vector(0, 0, 1))")))
    (refuted,) = (statement for statement, verdict in found.items() if verdict == "refuted")
    assert refuted.startswith("dot(Pi, R*vector(0, 0, 1)) is conserved where R*transpose(R) = 1")


def test_a_body_with_an_oscillator_keeps_its_angular_momentum():
    """Its square is a Casimir; that of the body alone is none, and neither is that of a slip."""
    declared = read_spec(EXAMPLES / "body_with_oscillator.toml")
    assert set(verdicts(declared).values()) == {"proved"}
    text = declared.path.read_text(encoding="utf-8")
    for wrong in ('K = "diag(I)*Omega"', 'K = "diag(I)*Omega - m*cross(place, moved)"'):
        spoiled = spec(text, ('K = "diag(I)*Omega + m*cross(place, moved)"', wrong))
        assert verdicts(spoiled)["dot(K, K) is a Casimir"] == "refuted"


def test_an_orbiting_body_keeps_energy_and_angular_momentum():
    """One potential gives force and torque."""
    text = (EXAMPLES / "orbiting_body.toml").read_text(encoding="utf-8")
    found = verdicts(spec(text, ('"lie-poisson", "hamilton-pontryagin", "poincare", ', "")))
    assert set(found.values()) == {"proved"}
    assert any(statement.startswith("L is conserved where") for statement in found)
