"""From a spec to proved equations by all its routes, imports not counted; a peer beside it.

The peer is ``sympy.physics.mechanics.KanesMethod``: the same heavy top, with body-fixed speeds and
three angles, to its mass matrix and forces. It proves nothing; its accelerations at one point are
compared with ours.
"""

from __future__ import annotations

from figures import SYSTEMS, Figure, fresh_process, script

# In a fresh process, since a second derivation finds caches warm.
CODE = """
import time
from coadjoint.derive import derive
from coadjoint.prove import prove
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec
path = derivations_folder() / "{system}.toml"
start = time.perf_counter()
certificate = prove(read_spec(path))
taken = time.perf_counter() - start
assert certificate.holds and len(certificate.claims) >= 4
print(taken)
"""

KANE = """
import time
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod, Point, ReferenceFrame, RigidBody, dynamicsymbols, inertia,
)
start = time.perf_counter()
q, u = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
I, chi = sp.symbols("I1:4"), sp.symbols("chi1:4")
m, g = sp.symbols("m g")
space, body = ReferenceFrame("N"), ReferenceFrame("B")
body.orient_body_fixed(space, q, "XYZ")
turning = body.ang_vel_in(space)
axes = (body.x, body.y, body.z)
kinematics = [speed - turning.dot(axis) for speed, axis in zip(u, axes)]
body.set_ang_vel(space, sum((s * a for s, a in zip(u, axes)), 0 * body.x))
fixed = Point("O")
fixed.set_vel(space, 0)
centre = fixed.locatenew("G", sum((c * a for c, a in zip(chi, axes)), 0 * body.x))
centre.v2pt_theory(fixed, space, body)
top = RigidBody("top", centre, body, m, (inertia(body, *I), fixed))
method = KanesMethod(space, q, u, kinematics)
method.kanes_equations([top], [(centre, -m * g * space.z)])
mass, force = method.mass_matrix, method.forcing
taken = time.perf_counter() - start

from coadjoint.systems import heavy_top
angles, speeds, moments = (0.3, -0.4, 0.5), (0.7, -0.2, 1.1), (1.0, 2.0, 3.5)
lever = (0.1, -0.3, 0.8)
at = dict(zip((*q, *u, *I, *chi, m, g), (*angles, *speeds, *moments, *lever, 1.3, 9.81)))
rates = sp.Matrix(mass.subs(at)).LUsolve(sp.Matrix(force.subs(at)))
vertical = [space.z.dot(axis).subs(at) for axis in axes]
momentum = [i * w for i, w in zip(moments, speeds)]
ours = heavy_top.rhs([*momentum, *map(float, vertical)], [*moments, 1.3, 9.81, *lever])
assert all(abs(float(r) - d / i) < 1e-12 for r, d, i in zip(rates, ours, moments)), (rates, ours)
print(taken)
"""


def measure() -> list[Figure]:
    """Seconds from the file to its certificate, all routes included; the peer's beside it."""
    figures = []
    for system in SYSTEMS:
        taken = fresh_process(CODE.format(system=system), runs=3)
        what = f"{system}: spec to proved equations by all routes"
        if system == "heavy_top":  # the target is the heavy top's; the others are for comparison
            figures.append(Figure(what, "<= 0.30 s", f"{taken:.3f} s", taken <= 0.3))
            peer = fresh_process(KANE, runs=3)
            what = "heavy_top: sympy's KanesMethod, one route, nothing proved"
            figures.append(Figure(what, "none", f"{peer:.3f} s, {peer / taken:.1f} times ours"))
        else:
            figures.append(Figure(what, "none", f"{taken:.3f} s"))
    return figures


if __name__ == "__main__":
    script(measure)
