"""Frames: fields commute as their brackets say, on algebras of both sides and on coordinates."""

import itertools

import pytest

from coadjoint.derive import make_setting
from coadjoint.derive.mechanics.frames import Frame
from tests.constrained import BALL, PARTICLE, SLEIGH
from tests.specs import spec

RIGHT = ('name = "se(3)"', 'name = "se(3)"\ninvariance = "right"')
#: A rotor on the sleigh: a coordinate beside an algebra.
ROTOR = (
    '[parameters]',
    'phi = { role = "coordinate" }\nq = { role = "velocity", of = "phi" }\n[parameters]',
)  # fmt: skip
FRAMES = [(BALL,), (BALL, RIGHT), (PARTICLE,), (SLEIGH, ROTOR)]


def frame(text, *changes):
    """The frame of a changed text."""
    return Frame(make_setting(spec(text, *changes)))


def rates(found):
    """The rates of the positions in the velocities themselves."""
    return found.rates(found.setting.elements(found.velocities))


def units(found):
    """Its vectors, one after the other."""
    return [found.unit(k) for k in range(len(found.velocities))]


def check_commutators(found, bracket):
    """``X (Y f) - Y (X f) = [X, Y] f`` for all fields and all positions f."""
    field = found.setting.field
    nonzero = 0
    for X, Y in itertools.combinations(units(found), 2):
        for name in found.positions:
            f = field[name]
            twice = found.along(X, found.along(Y, f)) - found.along(Y, found.along(X, f))
            assert field.is_zero(twice - found.along(bracket(X, Y), f)), (X, Y, name)
            nonzero += twice != 0
    assert nonzero or not found.setting.advected


@pytest.mark.parametrize("of", FRAMES, ids=lambda of: of[0].split('"')[1])
def test_fields_commute_as_their_brackets_say(of):
    """As operators on positions, whose action and whose brackets come by different roads."""
    found = frame(*of)
    check_commutators(found, found.structure)


def test_the_check_sees_a_bracket_of_the_other_side():
    """A right invariant frame has the other sign: the left one's brackets fail there."""
    left, right = frame(BALL), frame(BALL, RIGHT)
    with pytest.raises(AssertionError):
        check_commutators(right, lambda X, Y: tuple(-x for x in right.structure(X, Y)))
    assert left.structure(left.unit(0), left.unit(1))[2] == 1
    assert right.structure(right.unit(0), right.unit(1))[2] == -1


def test_fields_with_moving_components_commute_by_leibniz():
    """[f X, Y] = f [X, Y] - (Y f) X, here with f = Gamma1 and the first two axes."""
    found = frame(BALL)
    field = found.setting.field
    X, Y = found.unit(0), found.unit(1)
    f = field["Gamma1"]
    moving = tuple(f * x for x in X)
    rate = found.along(Y, f)  # dGamma/dt = Gamma x e2: -Gamma3 along the first axis
    assert rate == -field["Gamma3"]
    expected = tuple(f * c - rate * x for c, x in zip(found.structure(X, Y), X, strict=True))
    assert found.bracket(moving, Y) == expected
    assert found.bracket(Y, moving) == tuple(-x for x in expected)
    assert found.bracket(moving, Y) != tuple(f * c for c in found.structure(X, Y))


def test_positions_move_with_the_velocities():
    """The vertical turns backwards, seen from the body: dGamma/dt = Gamma x Omega; dx/dt = u."""
    ball, particle = frame(BALL), frame(PARTICLE)
    of = ball.setting.field
    assert rates(ball)["Gamma1"] == of["Gamma2"] * of["Omega3"] - of["Gamma3"] * of["Omega2"]
    turned = frame(BALL, RIGHT)
    of = turned.setting.field
    assert rates(turned)["Gamma1"] == of["Gamma3"] * of["Omega2"] - of["Gamma2"] * of["Omega3"]
    of = particle.setting.field
    assert rates(particle) == {"x": of["u"], "y": of["v"], "z": of["w"]}


def test_velocities_of_coordinates_come_after_those_of_the_algebra():
    """They commute with everything, and no inertial force acts along them."""
    found = frame(SLEIGH, ROTOR)
    assert found.velocities == ("omega", "v", "u", "q")
    assert found.positions == ("phi",)
    momenta = found.setting.elements(found.velocities)
    assert found.inertial(momenta, found.unit(0))[3] == 0
    assert all(entry == 0 for entry in found.structure(found.unit(0), found.unit(3)))


@pytest.mark.parametrize("changes", [(), (RIGHT,)])
def test_inertial_forces_pair_momenta_with_brackets(changes):
    """<p, [xi, X_k]> for every k: ad* and the brackets say the same."""
    found = frame(BALL, *changes)
    field = found.setting.field
    xi = found.setting.elements(found.velocities)
    p = tuple(field[f"I{n}"] for n in (1, 2, 3)) + tuple(field[f"chi{n}"] for n in (1, 2, 3))
    forces = found.inertial(p, xi)
    assert forces[0] != 0
    for k, force in enumerate(forces):
        turned = found.structure(xi, found.unit(k))
        assert field.is_zero(force - field.sum(a * b for a, b in zip(p, turned, strict=True)))
