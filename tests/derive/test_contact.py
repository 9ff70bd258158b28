"""A body that rolls on a surface moves as Newton, Euler, Montana and closed forms have it."""

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.domain import bounds
from coadjoint.errors import DerivationError
from coadjoint.lower.lowering import lower
from coadjoint.resources import derivations_folder
from tests.contacts import (
    BALL_INSIDE,
    ELLIPSOID,
    IN_SPHERE,
    ON_PLANE,
    ON_TURNTABLE,
    aligned,
    by_variable,
    rates_at,
    turned,
    values_at,
)
from tests.rolling import derived
from tests.specs import spec


def spec_text(name):
    """The text of a shipped spec."""
    return (derivations_folder() / f"{name}.toml").read_text(encoding="utf-8")


#: Of the ball: I, m, r, b, g.
INERTIA, M, R, B, G = 0.4, 1.0, 1.0, 3.0, 9.81
#: Of the ellipsoid: moments of inertia, semi-axes, and the parameter of the paraboloid.
MOMENTS, AXES, BOWL = np.array([0.05, 0.06, 0.04]), np.array([0.3, 0.25, 0.4]), 2.0
STEP = 1e-5
#: A twist, a direction on the body, a place on the surface and an angular velocity.
CONTACTS = [
    (0.3, (0.2, -0.5, 0.8), (0.4, 0.7), (1.0, 2.0, 3.0)),
    (2.1, (-0.7, 0.1, -0.3), (-0.6, 0.2), (-2.0, 0.5, 1.0)),
    (4.0, (0.5, 0.6, -0.1), (1.5, -1.1), (0.3, -4.0, 2.0)),
]


def in_contact(twist, direction, place, turning):
    """A state in which the normals are opposite, with the rotation from the body to space."""
    s = AXES * direction / np.linalg.norm(direction)
    X = np.array([*place, (place[0] ** 2 + place[1] ** 2) / (2 * BOWL)])
    attitude = aligned(normal_of_body(s), -normal_of_bowl(X), twist)
    return {
        "Omega": np.array(turning),
        "E1": attitude[0],
        "E2": attitude[1],
        "E3": attitude[2],
        "s": s,
        "X": X,
    }, attitude


def normal_of_body(s):
    """Outwards."""
    g = s / AXES**2
    return g / np.linalg.norm(g)


def normal_of_bowl(X):
    """Towards the body: upwards."""
    up = np.array([-X[0], -X[1], BOWL])
    return up / np.linalg.norm(up)


def find_contact(attitude, centre, s):
    """The point of the body where the normals are opposite, for its attitude and centre: Newton."""

    def defect(s):
        across = np.cross(attitude @ normal_of_body(s), normal_of_bowl(centre + attitude @ s))
        return np.array([(s**2 / AXES**2).sum() - 1, *across])

    for _ in range(6):
        slopes = [(defect(s + h) - defect(s - h)) / (2 * STEP) for h in STEP * np.eye(3)]
        s = s - np.linalg.lstsq(np.array(slopes).T, defect(s), rcond=None)[0]
    return s


@pytest.mark.parametrize("contact", CONTACTS, ids=["first", "second", "third"])
def test_an_ellipsoid_in_a_paraboloid_obeys_newton_and_euler(contact):
    """The contact is found at attitudes a little before and after, and the force by multipliers."""
    state, attitude = in_contact(*contact)
    rates = rates_at(derived(ELLIPSOID), state)
    s, Omega = state["s"], state["Omega"]
    arm, w = attitude @ s, attitude @ Omega
    centre, v = state["X"] - arm, -np.cross(w, arm)
    near = [
        (find_contact(turned(h * w) @ attitude, centre + h * v, s), turned(h * w) @ attitude)
        for h in (STEP, -STEP)
    ]
    s_rate = (near[0][0] - near[1][0]) / (2 * STEP)
    arm_rate = (near[0][1] @ near[0][0] - near[1][1] @ near[1][0]) / (2 * STEP)
    np.testing.assert_allclose(rates["s"], s_rate, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(rates["X"], v + arm_rate, rtol=1e-5, atol=1e-7)
    # unknown: dw/dt, dv/dt and the force of the surface, all in space
    inertia = attitude @ np.diag(MOMENTS) @ attitude.T
    hat = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
    none = np.zeros((3, 3))
    matrix = np.block(
        [[inertia, none, -hat], [none, np.eye(3), -np.eye(3)], [-hat, np.eye(3), none]]
    )
    known = [-np.cross(w, inertia @ w), np.array([0, 0, -G]), -np.cross(w, arm_rate)]
    found = np.linalg.solve(matrix, np.concatenate(known))[:3]
    np.testing.assert_allclose(rates["Omega"], attitude.T @ found, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("contact", CONTACTS, ids=["first", "second", "third"])
def test_points_of_contact_move_by_montana_s_equations(contact):
    """Along the body by (K_f + K_o)^-1 (-w_y, w_x), with curvature forms of differences."""
    state, attitude = in_contact(*contact)
    n = attitude @ normal_of_body(state["s"])
    x = np.cross(n, [1.0, 0.0, 0.0])
    frame = np.array([x / np.linalg.norm(x), np.cross(n, x) / np.linalg.norm(x)])

    def form(normal, point, sides):
        """How a unit normal changes along a surface, in the frame of the contact."""
        changes = [normal(point + STEP * u) - normal(point - STEP * u) for u in sides]
        return np.array(changes) @ frame.T / (2 * STEP)

    bowl = form(normal_of_bowl, state["X"], frame)
    body = form(lambda s: attitude @ normal_of_body(s), state["s"], frame @ attitude)
    w = attitude @ state["Omega"]
    # d(n)/dt = w x n is made up by the change along both surfaces
    along = np.linalg.solve(body + bowl, -frame @ np.cross(w, n))
    rates = rates_at(derived(ELLIPSOID), state)
    np.testing.assert_allclose(frame @ attitude @ rates["s"], along, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(rates["X"], attitude @ rates["s"], rtol=1e-12, atol=1e-14)


def test_an_ellipsoid_on_a_plane_has_the_rates_of_the_closed_form():
    """The shipped rolling ellipsoid has no point of contact as state: s = -B Gamma/h(Gamma)."""
    axes = '["0.2", "0.03", "0.02"]'
    changes = [
        ('["0.05", "0.06", "0.04"]', '["0.0002", "0.0016", "0.0017"]'),
        ('["0.3", "0.25", "0.4"]', axes),
    ]
    shipped = spec_text("rolling_ellipsoid")
    assert axes in shipped
    other = derived(shipped, ('"-0.00002"', "0"))
    semi = np.array([0.2, 0.03, 0.02])
    up = np.array([0.36, 0.48, 0.8])
    s = -(semi**2) * up / np.sqrt((semi**2 * up**2).sum())
    attitude = aligned(up, np.array([0.0, 0.0, 1.0]), 0.7)
    state = {"Omega": np.array([0.4, -1.0, 5.0]), "s": s, "X": np.array([0.3, 0.1, 0.0])}
    state |= {"E1": attitude[0], "E2": attitude[1], "E3": attitude[2]}
    ours = rates_at(derived(ELLIPSOID, *ON_PLANE, *changes), state)
    theirs = rates_at(other, {"Omega": state["Omega"], "Gamma": up})
    np.testing.assert_allclose(ours["Omega"], theirs["Omega"], rtol=1e-11)
    np.testing.assert_allclose(ours["E3"], theirs["Gamma"], rtol=1e-12)


def test_a_ball_in_a_cylinder_swings_and_does_not_fall():
    """The height has z'' + nu^2 (z - z_c) = 0 with nu^2 = (2/7) phi'^2; phi' is constant."""
    angle, z, w = 0.8, 0.3, np.array([0.4, -1.2, 5.0])
    n = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-n[1], n[0], 0.0])
    state = {"omega": w, "c": (B - R) * n + [0, 0, z], "X": B * n + [0, 0, z]}
    rates = rates_at(derived(BALL_INSIDE), state)
    turn = -R * w[2] / (B - R)
    share = INERTIA / (INERTIA + M * R**2)
    assert share == pytest.approx(2 / 7)
    centre = z - R * (w @ n) / turn - M * G * R**2 / (INERTIA * turn**2)
    np.testing.assert_allclose(rates["c"], [*(turn * (B - R) * across)[:2], R * (w @ across)])
    # z'' = r d(omega . e_phi)/dt, and e_phi' = -phi' n
    rise = R * (rates["omega"] @ across - turn * (w @ n))
    assert rise == pytest.approx(-share * turn**2 * (z - centre), rel=1e-12)
    assert rates["omega"][2] == pytest.approx(0, abs=1e-13)
    np.testing.assert_allclose(rates["X"][:2], B * turn * across[:2], atol=1e-13)


def test_a_ball_in_a_sphere_moves_as_the_shipped_one():
    """Its centre is at a n, with n of ball_in_sphere; b = a here."""
    n = np.array([0.6, 0.0, -0.8])
    w = np.array([1.0, -2.0, 5.0])
    other = rates_at(derived(spec_text("ball_in_sphere")), {"omega": w, "n": n})
    ours = rates_at(derived(BALL_INSIDE, *IN_SPHERE), {"omega": w, "c": B * n, "X": (B + R) * n})
    np.testing.assert_allclose(ours["omega"], other["omega"], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(ours["c"], B * other["n"], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(ours["X"], (B + R) * other["n"], rtol=1e-12, atol=1e-13)


def test_a_ball_on_a_turntable_moves_as_the_shipped_one():
    """The height is that of the plane, and the turntable turns at the rate W."""
    changes = [
        ('default = "0.0004"', 'default = "0.4"'),
        ('default = "0.0316227766"', "default = 1"),
        ("W = { default = 1,", 'W = { default = "0.7",'),
    ]
    w, x = np.array([1.5, -2.0, 0.5]), np.array([0.4, 1.1])
    other = rates_at(derived(spec_text("ball_on_turntable"), *changes), {"omega": w, "x": x})
    state = {"omega": w, "c": np.array([*x, R]), "X": np.array([*x, 0.0])}
    ours = rates_at(derived(BALL_INSIDE, *ON_TURNTABLE), state)
    np.testing.assert_allclose(ours["omega"], other["omega"], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(ours["c"], [*other["x"], 0], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(ours["X"], ours["c"], rtol=1e-12, atol=1e-13)


def test_a_state_near_contact_is_projected_onto_it():
    """Each step squares the distance; what is in contact stays, and so does the body."""
    equations = derived(ELLIPSOID)
    state, _ = in_contact(*CONTACTS[0])
    assert np.abs(values_at(equations, state, "constraint_residual")[3:]).max() < 1e-15
    moved = state | {"s": state["s"] + [1e-3, -2e-3, 1e-3], "X": state["X"] + [2e-3, 1e-3, -1e-3]}
    sizes = []
    for _ in range(4):
        sizes.append(np.abs(values_at(equations, moved, "constraint_residual")[3:]).max())
        moved |= by_variable(equations, values_at(equations, moved, "projection"))
    assert sizes[0] > 1e-3
    for found, bound in zip(sizes[1:], (1e-5, 1e-8, 1e-14), strict=True):
        assert found < bound
    np.testing.assert_array_equal(moved["E1"], state["E1"])
    again = by_variable(equations, values_at(equations, state, "projection"))
    np.testing.assert_allclose(again["s"], state["s"], atol=1e-14)
    np.testing.assert_allclose(again["X"], state["X"], atol=1e-14)


def test_surfaces_touch_at_one_point_where_the_domain_says_so():
    """Not where the normals agree, nor where the body is flatter than the bowl."""
    equations = derived(ELLIPSOID)
    names = [bound.name for bound, _ in bounds(equations)][:3]
    assert names == ["rolling_apart", "rolling_outside", "rolling_facing"]
    state, attitude = in_contact(*CONTACTS[0])
    assert min(values_at(equations, state, "domain")[:3]) > 0
    inside = {**state, **{name: -state[name] for name in ("E1", "E2", "E3")}}  # as of the far side
    assert values_at(equations, inside, "domain")[2] < 0
    tight = derived(ELLIPSOID, ("b = { positive = true, default = 2", 'b = { default = "0.1"'))
    low = {**state, "X": np.zeros(3)}
    attitude = aligned(normal_of_body(state["s"]), np.array([0.0, 0.0, -1.0]), 0.2)
    low |= {"E1": attitude[0], "E2": attitude[1], "E3": attitude[2]}
    apart, outside, facing = values_at(tight, low, "domain")[:3]
    assert facing > 0
    assert min(apart, outside) < 0


def test_surfaces_that_touch_along_a_line_are_refused():
    """A cylinder that rolls on a plane has no point of contact."""
    flat = ("(a2*a3*s1)^2 + (a1*a3*s2)^2 + (a1*a2*s3)^2 - (a1*a2*a3)^2", "s1^2 + s2^2 - a1^2")
    with pytest.raises(DerivationError, match="touch along a line or a whole face") as caught:
        derive(spec(ELLIPSOID, *ON_PLANE, flat))
    assert "rolling.surface" in str(caught.value)


def test_a_projection_computes_each_step_once():
    """A step of Newton is a few hundred operations, so that a compiler has little to do."""
    projection = lower(derived(ELLIPSOID))["projection"]
    assert 100 < sum(projection.operation_counts().values()) < 1000
