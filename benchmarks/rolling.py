"""What the off-centre rolling ball costs, beside what SymPy makes of it.

The peers are ``sympy.physics.mechanics.KanesMethod`` with a dependent speed for each velocity that
rolling gives, for its time, and ``sympy.cse`` of the accelerations solved symbolically, for its
operations. The accelerations of all three agree at one point. A careful hand has 120 operations.
"""

from __future__ import annotations

from figures import Figure, fresh_process, script

OURS = """
import time
from coadjoint.derive import derive
from coadjoint.lower.lowering import lower
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec
path = derivations_folder() / "chaplygin_ball.toml"
start = time.perf_counter()
programs = lower(derive(read_spec(path)))
taken = time.perf_counter() - start
"""
TIME = OURS + "print(taken)"
OPERATIONS = OURS + "print(sum(programs['rhs'].operation_counts('member').values()))"

KANE = """
import time
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod, Point, ReferenceFrame, RigidBody, dynamicsymbols, inertia,
)
start = time.perf_counter()
q, u = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
v, x = dynamicsymbols("v1:4"), dynamicsymbols("x1:4")
I, chi = sp.symbols("I1:4"), sp.symbols("chi1:4")
m, g, r = sp.symbols("m g r")
space, body = ReferenceFrame("N"), ReferenceFrame("B")
body.orient_body_fixed(space, q, "XYZ")
turning = body.ang_vel_in(space)
axes = (body.x, body.y, body.z)
kinematics = [speed - turning.dot(axis) for speed, axis in zip(u, axes)]
body.set_ang_vel(space, sum((s * a for s, a in zip(u, axes)), 0 * body.x))
origin, centre = Point("O"), Point("G")
origin.set_vel(space, 0)
centre.set_vel(space, sum((s * a for s, a in zip(v, axes)), 0 * body.x))
kinematics += [
    s - sum((d.diff() * a.dot(b) for d, a in zip(x, (space.x, space.y, space.z))), 0)
    for s, b in zip(v, axes)
]
arm = r * space.z + sum((c * a for c, a in zip(chi, axes)), 0 * body.x)
rolling = body.ang_vel_in(space).cross(arm)
constraints = [s - rolling.dot(axis) for s, axis in zip(v, axes)]
ball = RigidBody("ball", centre, body, m, (inertia(body, *I), centre))
method = KanesMethod(
    space, [*q, *x], u, kinematics, u_dependent=v, velocity_constraints=constraints
)
method.kanes_equations([ball], [(centre, -m * g * space.z)])
mass, force = method.mass_matrix, method.forcing
taken = time.perf_counter() - start

from coadjoint.systems import chaplygin_ball
angles, speeds, moments = (0.3, -0.4, 0.5), (0.7, -0.2, 1.1), (1.0, 2.0, 2.5)
lever = (0.1, -0.3, 0.2)
at = dict(zip((*q, *u, *I, *chi, m, g, r), (*angles, *speeds, *moments, *lever, 1.3, 9.81, 0.8)))
vertical = [float(space.z.dot(axis).subs(at)) for axis in axes]
s = [0.8 * a + b for a, b in zip(vertical, lever)]
cross = lambda a, b: [a[1]*b[2] - a[2]*b[1], a[2]*b[0] - a[0]*b[2], a[0]*b[1] - a[1]*b[0]]
at |= dict(zip(v, cross(speeds, s)))
rates = sp.Matrix(mass.subs(at)).LUsolve(sp.Matrix(force.subs(at)))
ours = chaplygin_ball.rhs(
    {"Omega": speeds, "Gamma": vertical},
    {"I": moments, "m": 1.3, "r": 0.8, "g": 9.81, "chi": lever},
)
assert all(abs(float(a) - b) < 1e-11 for a, b in zip(rates[:3], ours[:3])), (rates, ours)
print(taken)
"""

EXPANDED = """
import sympy as sp
I, chi, w, n = (sp.symbols(f"{name}1:4") for name in ("I", "chi", "Omega", "Gamma"))
m, g, r = sp.symbols("m g r")
W, N, C = map(sp.Matrix, (w, n, chi))
s, J = r * N + C, sp.diag(*I)
turned = N.cross(W)
mass = J + m * (s.dot(s) * sp.eye(3) - s * s.T)
force = (J * W).cross(W) + m * g * N.cross(C)
force += m * s.cross((W.cross(s) + r * turned).cross(W))
rates = mass.adjugate() * force / mass.det()
names, values = sp.cse([*rates, *turned])
print(sum(sp.count_ops(value) for _, value in names) + sum(map(sp.count_ops, values)))
from coadjoint.systems import chaplygin_ball
at = dict(zip((*I, *chi, *w, *n, m, g, r), (1, 2, 2.5, 0.1, -0.3, 0.2, 0.7, -0.2, 1.1, 0, 0.6, 0.8,
    1.3, 9.81, 0.8)))
state, parameters = [0.7, -0.2, 1.1, 0, 0.6, 0.8], [1, 2, 2.5, 1.3, 0.8, 9.81, 0.1, -0.3, 0.2]
ours = chaplygin_ball.rhs(state, parameters)
assert all(abs(float(a.subs(at)) - b) < 1e-11 for a, b in zip(rates, ours)), (rates.subs(at), ours)
"""


def measure() -> list[Figure]:
    """Operations of the rates for one member, and seconds from the file to the kernels' program."""
    ours = fresh_process(OPERATIONS, runs=1)
    peer = fresh_process(EXPANDED, runs=1)
    taken = fresh_process(TIME, runs=3)
    kane = fresh_process(KANE, runs=1)
    return [
        Figure("chaplygin_ball: operations of rhs", "<= 150", f"{ours:.0f}", ours <= 150),
        Figure("sympy.cse of the solved form", "none", f"{peer:.0f}, {peer / ours:.1f} times ours"),
        Figure("chaplygin_ball: spec to program", "none", f"{taken:.3f} s"),
        Figure(
            "sympy's KanesMethod, to mass matrix and forces",
            "none",
            f"{kane:.3f} s, {kane / taken:.1f} times ours",
        ),
    ]


if __name__ == "__main__":
    script(measure)
