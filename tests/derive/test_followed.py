"""Rates of what follows: attitudes from both sides, contacts of rolling bodies, declared ones."""

from fractions import Fraction

import pytest

from coadjoint.derive.reference import Reference
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from tests.conftest import rational_points
from tests.rolling import BALL, DISK, FOLLOWED_SLEIGH, derived
from tests.specs import RIGID_BODY

FOLLOWED_BODY = RIGID_BODY + '[reconstruction]\nq = { attitude = "quaternion" }\n'
RIGHT = ('name = "so(3)"', 'name = "so(3)"\ninvariance = "right"')


def at(equations, point):
    """The rates at a rational point, by name."""
    values = Reference(equations).evaluate("reconstruction", point, Fraction, None)
    return dict(zip((name for name, _ in equations.followed), values, strict=True))


def points(equations):
    """Some rational points."""
    names = (*equations.setting.state, *(name for name, _ in equations.followed))
    return rational_points((*names, *equations.setting.parameters), 3)


@pytest.mark.parametrize(("changes", "side"), [((), 1), ((RIGHT,), -1)])
def test_attitudes_turn_by_the_product_with_half_the_angular_velocity(changes, side):
    """dq/dt = q (0, Omega)/2, and (0, Omega) q/2 if right-invariant: Hamilton's table by hand."""
    equations = derived(FOLLOWED_BODY, *changes)
    for p in points(equations):
        w, x, y, z = (p[f"q{n}"] for n in range(4))
        a, b, c = (p[f"Pi{n}"] / p[f"I{n}"] for n in (1, 2, 3))
        assert list(at(equations, p).values()) == [
            (-x * a - y * b - z * c) / 2,
            (w * a + side * (y * c - z * b)) / 2,
            (w * b + side * (z * a - x * c)) / 2,
            (w * c + side * (x * b - y * a)) / 2,
        ]


def cross(a, b):
    """The cross product, by hand."""
    return [a[n - 2] * b[n - 1] - a[n - 1] * b[n - 2] for n in range(3)]


def turned(p, v):
    """O v, by the matrix of a quaternion as books print it."""
    w, x, y, z = (p[f"q{n}"] for n in range(4))
    matrix = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return [sum(m * c for m, c in zip(row, v, strict=True)) for row in matrix]


def check_contact_of_the_ball(equations, sign):
    """d(x, y)/dt = -O ds/dt with ds/dt = r Gamma x Omega."""
    for p in points(equations):
        Gamma, Omega = ([p[f"{v}{n}"] for n in (1, 2, 3)] for v in ("Gamma", "Omega"))
        moved = turned(p, [sign * p["r"] * c for c in cross(Gamma, Omega)])
        found = at(equations, p)
        assert [found["x"], found["y"]] == moved[:2]


def test_the_contact_of_a_ball_moves_by_minus_the_turned_rate_of_the_arm():
    """By hand; the other sign would be caught."""
    check_contact_of_the_ball(derived(BALL), -1)
    with pytest.raises(AssertionError):
        check_contact_of_the_ball(derived(BALL), 1)


def test_declared_rates_are_the_formulas():
    """The program gives back what was typed, as d(x)/dt = v cos(theta)."""
    equations = derived(FOLLOWED_SLEIGH)
    theta, x, y = (str(equations.setting.field.to_sympy(rate)) for _, rate in equations.followed)
    assert (theta, x, y) == ("omega", "v*cos(theta)", "v*sin(theta)")


@pytest.mark.parametrize("changes", [(), DISK], ids=["ball", "disk"])
def test_the_program_computes_the_rates_without_the_solve(changes):
    """Lowering is undone exactly; accelerations and factors of the solve are not computed."""
    equations = derived(BALL, *changes)
    program = lower(equations)["reconstruction"]
    check_inverse(equations, program)
    assert program.state[-6:] == ("q0", "q1", "q2", "q3", "x", "y")
    assert program.shape == (6,)
    names = {statement.name for statement in program.statements}
    assert not names & {*equations.intermediates, "dOmega1_dt"}
    assert sum(program.operation_counts().values()) < 100


def test_without_tables_there_is_no_such_function():
    """A free body as it is shipped has no function reconstruction."""
    assert "reconstruction" not in lower(derived(RIGID_BODY))
