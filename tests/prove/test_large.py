"""Large constrained motions are proved: no search keeps a user from a kernel."""

import pytest

from coadjoint.prove import prove
from tests.specs import spec

LINKS = 13
CHAIN = f"""
title = "Chain of links with two guides"
routes = ["nonholonomic"]
[variables]
q = {{ role = "coordinate", shape = [{LINKS}] }}
v = {{ role = "velocity", of = "q" }}
[parameters]
m = {{ shape = [{LINKS}], positive = true, default = 1 }}
k = {{ positive = true, default = 1 }}
[lagrangian]
l = "dot(v, diag(m)*v)/2 - k*({" + ".join(f"(q{n + 1} - q{n})^2" for n in range(1, LINKS))})/2"
[constraints]
guide = "v12 == q11*v13"
slot = "v1*q2 == v2*q3"
"""
VESELOVA = """
title = "Veselova's problem on SO(4)"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(4)"
[variables]
Omega = { role = "velocity", form = "antisymmetric" }
e = { role = "advected", representation = "defining" }
f = { role = "advected", representation = "defining" }
[parameters]
J = { shape = [6], positive = true, default = [1, 2, 3, 4, 5, 6] }
[lagrangian]
l = "(J1*Omega12^2 + J2*Omega13^2 + J3*Omega14^2 + J4*Omega23^2 + J5*Omega24^2 + J6*Omega34^2)/2"
[constraints]
twistless = "dot(f, Omega*e) == 0"
"""
ROTORS = """
title = "Ball with three rotors"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
Y = { role = "velocity", block = "translation" }
phi = { role = "coordinate", shape = [3] }
s = { role = "velocity", of = "phi" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
J = { shape = [3], positive = true, default = 1 }
m = { positive = true, default = 1 }
r = { positive = true, default = 1 }
g = { default = "9.81" }
chi = { shape = [3], default = ["0.1", "0.2", "0.3"] }
[definitions]
rotor = "dot(Omega + s, diag(J)*(Omega + s))/2"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + rotor + m*dot(Y, Y)/2 - m*g*dot(Gamma, chi)"
[constraints]
rolling = "Y == cross(Omega, r*Gamma + chi)"
"""


@pytest.mark.campaign
@pytest.mark.parametrize("text", [CHAIN, VESELOVA, ROTORS], ids=["chain", "veselova", "rotors"])
def test_large_motions_are_proved(text):
    """Every claim is proved; a search may end early, and then says so."""
    certificate = prove(spec(text))
    assert certificate.holds, str(certificate)
    assert sum("conserved" in claim.statement for claim in certificate.claims) >= 1
