"""The distribution of constraints: B, beta and A by hand, and what is no set of constraints."""

import pytest

from coadjoint.errors import DerivationError
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, derived

BLADE = 'blade = "w == y*u"'


def found(text, *changes):
    """The distribution of a changed text."""
    return derived(text, *changes)["nonholonomic"].distribution


def check_annihilated(of):
    """``A B = 0`` and the residuals vanish at ``xi = B eta + beta``, but for what is kept."""
    field = of.setting.field
    given = [(e, row) for e, row in zip(of.equations, of.A, strict=True) if e.solves]
    assert given
    for equation, row in given:
        for column in zip(*of.B, strict=True):
            assert field.is_zero(field.sum(a * b for a, b in zip(row, column, strict=True)))
        at = dict(zip(of.frame.velocities, of.xi, strict=True))
        assert field.is_zero(field.substitute(equation.residual, at)), equation.name


@pytest.mark.parametrize("text", [PARTICLE, SLEIGH, SUSLOV, BALL], ids=lambda t: t.split('"')[1])
def test_constraints_annihilate_the_distribution(text):
    """Their one-forms vanish on the columns of B."""
    check_annihilated(found(text))


def test_affine_constraints_hold_at_rest_of_the_others():
    """On w = y u + k x the velocity at u = v = 0 is beta = (0, 0, k x)."""
    of = found(PARTICLE, (BLADE, 'blade = "w == y*u + k*x"'))
    field = of.setting.field
    check_annihilated(of)
    assert of.beta == (0, 0, field["k"] * field["x"])
    assert not of.is_linear
    assert found(PARTICLE).is_linear


def test_the_ball_rolls_by_the_cross_product():
    """Y = Omega x s: Y1 = Omega2 s3 - Omega3 s2 with s = r Gamma + chi, and so on."""
    of = found(BALL)
    f = of.setting.field
    s = [f["r"] * f[f"Gamma{n}"] + f[f"chi{n}"] for n in (1, 2, 3)]
    zero, one = f.zero, f.one
    assert of.frame.velocities == ("Omega1", "Omega2", "Omega3", "Y1", "Y2", "Y3")
    assert of.independent == ("Omega1", "Omega2", "Omega3")
    assert (
        (one, zero, zero),
        (zero, one, zero),
        (zero, zero, one),
        (zero, s[2], -s[1]),
        (-s[2], zero, s[0]),
        (s[1], -s[0], zero),
    ) == of.B
    assert of.A[0][3] == 1  # the left side is the velocity
    assert of.A[0][1] == -s[2]


def test_constraints_that_give_velocities_through_each_other_are_put_in():
    """With u = k w and w = y v it is u = k y v, in whichever order they are written."""
    for lines in ('c = "u == k*w"\nd = "w == y*v"', 'd = "w == y*v"\nc = "u == k*w"'):
        of = found(PARTICLE, (BLADE, lines))
        f = of.setting.field
        assert of.solved == {"u": f["k"] * f["y"] * f["v"], "w": f["y"] * f["v"]}
        assert of.independent == ("v",)
        check_annihilated(of)


def test_a_cycle_is_kept():
    """With u = k w and w = y u, the second says (1 - k y) w = 0 and gives nothing."""
    of = found(PARTICLE, (BLADE, 'c = "u == k*w"\nd = "w == y*u"'))
    f = of.setting.field
    assert of.solved == {"u": f["k"] * f["w"]}
    assert of.independent == ("v", "w")
    ((equation, residual),) = of.kept
    assert equation.name == "d"
    assert f.is_zero(residual - (1 - f["k"] * f["y"]) * f["w"])


def test_what_gives_no_velocity_is_kept_as_it_is():
    """The rod of a pendulum: solved for neither velocity, since both may have the factor 0."""
    of = found(PENDULUM)
    f = of.setting.field
    assert of.solved == {}
    assert of.kept[0][1] == f["x"] * f["u"] + f["y"] * f["v"]
    assert ((f["x"], f["y"]),) == of.A


def test_the_other_side_turns_the_sign_of_the_residual():
    """Residuals are left minus right."""
    f = found(PARTICLE).setting.field
    assert found(PARTICLE).equations[0].residual == f["w"] - f["y"] * f["u"]
    turned = found(PARTICLE, (BLADE, 'blade = "y*u == w"'))
    f = turned.setting.field
    assert turned.equations[0].residual == f["y"] * f["u"] - f["w"]
    check_annihilated(turned)


@pytest.mark.parametrize(
    ("lines", "line", "name", "said"),
    [
        (BLADE + '\nagain = "2*w == 2*y*u"', 18, "again", "follows from the constraints before it"),
        (BLADE + '\nother = "w == y*u + 1"', 18, "other", "contradicts the constraints before it"),
        ('a = "w == 0"\nb = "w == 1"', 18, "b", "another value of the same combination"),
        ('blade = "w*u == y"', 17, "blade", "derivative by u depends on w"),
        ('blade = "w == sin(u)"', 17, "blade", "is not linear in the velocities"),
        ('blade = "w == norm(vector(u, v))"', 17, "blade", "is not linear in the velocities"),
        ('blade = "z == x*y"', 17, "blade", "is one on positions"),
        ('blade = "z == z"', 17, "blade", "it holds always; expected an equation between"),
        ('blade = "w == w"', 17, "blade", "Remove it."),
        ('a = "vector(u, v) == 0"\nb = "u == y*v"', 17, "b", "(a1, a2"),
    ],
)
def test_what_constrains_no_velocity_is_refused(lines, line, name, said):
    """Dependent, contradicting and nonlinear constraints, and those on positions alone."""
    with pytest.raises(DerivationError) as caught:
        found(PARTICLE, (BLADE, lines))
    message, error = str(caught.value), caught.value
    if name == "b" and "vector" in lines:
        line = 18
    assert message.startswith(f"sample.toml:{line}: constraints.{name}: ")
    assert said in message
    assert error.found == name
    assert "expected" in message
