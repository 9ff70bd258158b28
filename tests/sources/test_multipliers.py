"""Nonholonomic motion by multipliers in coordinates, Frobenius, and what is not such motion.

Holm (2011), Geometric Mechanics II, section 12.1.1: ``M q'' = F + lambda_a omega^a`` with
``omega^a(q') = 0``, written down in coordinates where the engine has frames.
"""

from functools import cache
from itertools import combinations

import mpmath
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.integrability import about_integrability
from tests.conftest import rational_points
from tests.sources.test_equations import emitted
from tests.specs import spec

COS, SIN = sympy.cos, sympy.sin


def written_out(equations):
    """Rates and observables as functions of state and parameters alone, by component."""
    motion = ConstrainedRates(equations)
    found = dict(equations.exact.observables) | motion.rates
    return {n: motion.field.to_sympy(motion.value(e)) for n, e in found.items()}


@cache
def closed(name):
    """The same of a shipped system."""
    return written_out(emitted(name))


# -- Lagrange and d'Alembert's principle by multipliers, in coordinates --------------------


class ByMultipliers:
    """``M q'' = F + lambda_a omega^a`` with ``omega^a(q') = 0``, in coordinates.

    Args:
        energy: The Lagrangian.
        q: Coordinates.
        v: Their rates.
        forms: Components of the constraint forms, a row for each.
    """

    def __init__(self, energy, q, v, forms):
        self.energy, self.q, self.v = energy, list(q), list(v)
        self.mass = sympy.hessian(energy, v)
        slopes = sympy.Matrix([energy]).jacobian(v)
        self.force = sympy.Matrix([energy]).jacobian(q).T - slopes.jacobian(q) * sympy.Matrix(v)
        self.forms = sympy.Matrix(forms)
        self.carried = -(self.forms * sympy.Matrix(v)).jacobian(q) * sympy.Matrix(v)

    def at(self, point):
        """Accelerations and multipliers at a point, to 60 digits."""
        n, m = len(self.q), self.forms.rows
        zeros = sympy.zeros(m, m)
        whole = sympy.BlockMatrix([[self.mass, -self.forms.T], [self.forms, zeros]])
        side = sympy.Matrix([*self.force, *self.carried])
        with mpmath.workdps(60):
            A = mpmath.matrix(whole.as_explicit().subs(point).evalf(60).tolist())
            known = mpmath.matrix(side.subs(point).evalf(60).tolist())
            found = [sympy.Float(e, 60) for e in mpmath.lu_solve(A, known)]
        return found[:n], found[n:]


x, y, z, theta, phi, psi, xi = sympy.symbols("x y z theta phi psi xi")
vx, vy, vz, vtheta, vphi, vpsi, vxi = sympy.symbols("vx vy vz vtheta vphi vpsi vxi")
m, r, I, J, J0, J1, l, a = sympy.symbols("m r I J J0 J1 l a")  # noqa: E741
k, eps, kx, kz, g = sympy.symbols("k eps kx kz g")
v, omega = sympy.symbols("v omega")

UPRIGHT = ByMultipliers(
    m * (vx**2 + vy**2) / 2 + I * vtheta**2 / 2 + J * vphi**2 / 2,
    [theta, phi, x, y],
    [vtheta, vphi, vx, vy],
    [[-r * COS(phi), 0, 1, 0], [-r * SIN(phi), 0, 0, 1]],
)
#: Centre of mass at (x + a cos theta, y + a sin theta).
SLEIGH = ByMultipliers(
    m * ((vx - a * SIN(theta) * vtheta) ** 2 + (vy + a * COS(theta) * vtheta) ** 2) / 2
    + I * vtheta**2 / 2,
    [x, y, theta],
    [vx, vy, vtheta],
    [[-SIN(theta), COS(theta), 0]],
)
#: Bloch, Krishnaprasad, Marsden and Murray (1996), with phi_b = phi and phi_f = -phi.
BOARD = ByMultipliers(
    m * (vx**2 + vy**2) / 2
    + (J * vtheta**2 + J0 * (vtheta + vpsi) ** 2) / 2
    + (J1 * (vtheta + vphi) ** 2 + J1 * (vtheta - vphi) ** 2) / 2,
    [x, y, theta, psi, phi],
    [vx, vy, vtheta, vpsi, vphi],
    [
        [-SIN(theta + phi), COS(theta + phi), -l * COS(phi), 0, 0],
        [-SIN(theta - phi), COS(theta - phi), l * COS(phi), 0, 0],
    ],
)
BLADE = ByMultipliers(
    (vxi**2 + vx**2 + vz**2) / 2
    + k * COS(xi)
    - eps * SIN(2 * xi) / 2
    - (kx * x**2 + kz * z**2) / 2
    + g * x,
    [xi, x, z],
    [vxi, vx, vz],
    [[0, -SIN(xi), COS(xi)]],
)
#: The road, the state in its coordinates, velocities that obey the constraints, and multipliers.
ROADS = {
    "rolling_disk_vertical": (
        UPRIGHT,
        [theta, phi, x, y, vtheta, vphi],
        {vx: r * COS(phi) * vtheta, vy: r * SIN(phi) * vtheta},
        ["rolling_x_reaction", "rolling_y_reaction"],
    ),
    "chaplygin_sleigh": (
        SLEIGH,
        [vx * COS(theta) + vy * SIN(theta), vtheta],
        {vx: v * COS(theta), vy: v * SIN(theta)},
        ["blade_reaction"],
    ),
    "snakeboard": (
        BOARD,
        [
            vx * COS(theta) + vy * SIN(theta),
            vy * COS(theta) - vx * SIN(theta),
            vtheta,
            psi,
            phi,
            vpsi,
            vphi,
        ],
        {
            vx: -l * COS(phi) / SIN(phi) * vtheta * COS(theta),
            vy: -l * COS(phi) / SIN(phi) * vtheta * SIN(theta),
        },
        ["back_reaction", "front_reaction"],
    ),
    "knife_edge_cvt": (
        BLADE,
        [xi, x, z, vxi, vx, vz],
        {vx: v * COS(xi), vz: v * SIN(xi)},
        ["blade_reaction"],
    ),
}


def point_on(road, state, allowed, seed=1):
    """A random point with allowed velocities, and the declared state there."""
    whole = sympy.Matrix([road.energy, *road.forms, *road.q, *road.v, *state, *allowed.values()])
    (free,) = rational_points(sorted(map(str, whole.free_symbols)), 1, seed)
    point = {sympy.Symbol(n): sympy.sympify(value) for n, value in free.items()}
    return point | {name: value.subs(point).evalf(80) for name, value in allowed.items()}


def check_road(name, road):
    """The engine's rates and reactions are those of multipliers in coordinates."""
    _, state, allowed, reactions = ROADS[name]
    point = point_on(road, state, allowed)
    accelerations, multipliers = road.at(point)
    moved = {q: point[s] for q, s in zip(road.q, road.v, strict=True)}
    moved |= dict(zip(road.v, accelerations, strict=True))
    names = emitted(name).setting.state
    own = point | {sympy.Symbol(n): e.subs(point) for n, e in zip(names, state, strict=True)}
    rates = [sum(sympy.diff(e, n) * w for n, w in moved.items()).subs(point) for e in state]
    rates = [sympy.sympify(rate).evalf(60) for rate in rates]
    expected = dict(zip((*names, *reactions), (*rates, *multipliers), strict=True))
    assert all(multipliers)
    for component, value in expected.items():
        found = closed(name)[component].subs(own).evalf(50)
        assert abs(found - value) <= 1e-40 * max(1, abs(value)), component


@pytest.mark.parametrize("name", sorted(ROADS))
def test_12_1_1_motion_is_that_of_multipliers(name):
    """Rates and reactions by Lagrange and d'Alembert in coordinates are those in a frame."""
    check_road(name, ROADS[name][0])


@pytest.mark.parametrize("name", sorted(ROADS))
def test_a_wrong_sign_in_a_constraint_form_is_seen(name):
    """Take the form that holds a cosine with the other sign there, and the motion differs."""
    road = ROADS[name][0]
    wrong = road.forms.copy()
    place = next(n for n, e in enumerate(wrong) if e.has(COS))
    wrong[place] = -wrong[place]
    with pytest.raises(AssertionError):
        check_road(name, ByMultipliers(road.energy, road.q, road.v, wrong))


# -- what is not nonholonomic motion ---------------------------------------------------------------


def test_12_1_1_a_constraint_put_in_before_varying_is_another_motion():
    """Varying ``m v^2/2 + (I + m a^2) omega^2/2`` on se(2) gives straight steady motion instead."""
    inertia = I + m * a**2
    p = sympy.Matrix([m * v, 0, inertia * omega])  # along the blade, across it, turning
    before = [omega * p[1] / m, -v * p[1] / inertia]  # p_v' = omega p_u, p_omega' = -v p_u
    found = [closed("chaplygin_sleigh")[name] for name in ("v", "omega")]
    kinetic = [m * v, inertia * omega]
    for rates in (before, found):  # neither is told by its energy
        assert sympy.expand(sum(e * w for e, w in zip(kinetic, rates, strict=True)).simplify()) == 0
    assert before == [0, 0]
    assert sympy.simplify(found[0] - a * omega**2) == 0


def test_12_1_1_vakonomic_motion_is_another_one():
    """Varying ``l + mu u`` the sleigh turns off from ours, since ``mu' = -m v omega - m a omega'``.

    With mu = 0 at the start both have the same acceleration, and another one right after.
    """
    mu = sympy.Symbol("mu")
    across = m * a * omega + mu
    vakonomic = [omega * across / m, -v * across / (I + m * a**2)]
    mu_rate = -omega * m * v - m * a * vakonomic[1]
    found = [closed("chaplygin_sleigh")[name] for name in ("v", "omega")]
    assert all(
        sympy.simplify(e.subs(mu, 0) - f) == 0 for e, f in zip(vakonomic, found, strict=True)
    )
    state = dict(zip((v, omega), vakonomic, strict=True)) | {mu: mu_rate}
    second = sum(sympy.diff(vakonomic[0], n) * rate for n, rate in state.items()).subs(mu, 0)
    ours = sum(sympy.diff(found[0], n) * state[n].subs(mu, 0) for n in (v, omega))
    apart = sympy.simplify(second - ours)
    assert sympy.simplify(apart - omega * mu_rate.subs(mu, 0) / m) == 0
    assert apart != 0


# -- Frobenius -------------------------------------------------------------------------------------

ON_A_LINE = """
title = "Disk on a line"
routes = ["nonholonomic", "hamel"]

[variables]
theta = { role = "coordinate" }
phi = { role = "coordinate" }
x = { role = "coordinate" }
y = { role = "coordinate" }
vtheta = { role = "velocity", of = "theta" }
vphi = { role = "velocity", of = "phi" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }

[parameters]
r = { positive = true, default = 1 }
slope = { default = "0.5" }

[lagrangian]
l = "(vtheta^2 + vphi^2 + vx^2 + vy^2)/2"

[constraints]
rolling_x = "vx == r*vtheta"
rolling_y = "vy == slope*vx"
"""


def wedge(left, right):
    """The exterior product of forms, each its components by ascending indices."""
    found = {}
    for (one, c), (two, d) in ((p, q) for p in left.items() for q in right.items()):
        places = (*one, *two)
        if len(set(places)) == len(places):
            order = sum(i > j for i, j in combinations(places, 2))
            key = tuple(sorted(places))
            found[key] = found.get(key, 0) + (-1) ** order * c * d
    return {key: e for key, e in found.items() if sympy.simplify(e) != 0}


def derivative(form, q):
    """``d omega`` of a 1-form."""
    found = {}
    for (j,), c in form.items():
        for pair, e in wedge({(i,): sympy.diff(c, x) for i, x in enumerate(q)}, {(j,): 1}).items():
            found[pair] = found.get(pair, 0) + e
    return found


def is_integrable(rows, q):
    """Frobenius: ``d omega^a`` with all the forms wedged to it vanishes."""
    forms = [{(i,): e for i, e in enumerate(row) if e != 0} for row in rows]
    volume = forms[0]
    for form in forms[1:]:
        volume = wedge(volume, form)
    assert volume, "forms that depend on each other are closed under anything"
    return not any(wedge(derivative(form, q), volume) for form in forms)


def check_integrability(equations, expected):
    """Frobenius' test by forms, typed here, and the engine's finding by brackets agree."""
    found, field = equations.distribution, equations.setting.field
    rows = [[field.to_sympy(e) for e in row] for row in found.A]
    assert is_integrable(rows, sympy.symbols(found.frame.positions)) is expected
    statement = next(statement for statement, *_ in about_integrability(equations))
    assert (" not integrable" in statement) is not expected, statement


def test_12_1_1_a_vertical_disk_on_a_line_is_integrable():
    """``dx - r dtheta`` and ``dy - slope dx`` are exact."""
    check_integrability(derive(spec(ON_A_LINE)), True)


@pytest.mark.parametrize("name", ["rolling_disk_vertical", "knife_edge_cvt"])
def test_12_1_1_a_vertical_disk_on_a_plane_is_not(name):
    """``d omega^1 = r sin(phi) dphi ^ dtheta`` is not in the ideal of the forms; nor is a blade."""
    check_integrability(emitted(name), False)


def test_the_check_of_integrability_sees_the_wrong_answer():
    """Expect the opposite and both checks fail."""
    with pytest.raises(AssertionError):
        check_integrability(derive(spec(ON_A_LINE)), False)
    bent = ("slope*vx", "slope*phi*vx")
    with pytest.raises(AssertionError):
        check_integrability(derive(spec(ON_A_LINE, bent)), True)
