"""Specs with attitudes, quaternions and poses, for tests."""

#: A heavy top whose attitude is the state.
TOP = """
title = "Heavy top by its attitude"
routes = ["euler-poincare", "lie-poisson", "hamilton-pontryagin", "poincare", "newton-euler"]
[algebra]
name = "so(3)"
[variables]
R = { role = "attitude" }
Omega = { role = "velocity" }
Pi = { role = "momentum", default = [1, 2, 3] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
w = { default = 1 }
chi = { shape = [3], default = [1, 2, 3] }
[definitions]
Gamma = "transpose(R)*vector(0, 0, 1)"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - w*dot(Gamma, chi)"
[claims]
conserved = ["energy", "dot(Pi, Gamma)", "R*transpose(R)"]
"""
#: The same by a quaternion.
BY_QUATERNION = (
    ('R = { role = "attitude" }', 'q = { role = "quaternion" }'),
    ("transpose(R)*vector(0, 0, 1)", "rotate(conjugate(q), vector(0, 0, 1))"),
    ("R*transpose(R)", "dot(q, q)"),
)
#: A body whose attitude and position are the state, in a potential that turns with space.
TIED = """
title = "A body tied to the origin"
routes = ["euler-poincare", "lie-poisson", "newton-euler"]
[algebra]
name = "se(3)"
[variables]
g = { role = "pose" }
Omega = { role = "velocity", block = "rotation" }
v = { role = "velocity", block = "translation" }
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { positive = true, default = 1 }
k = { default = 1 }
a = { shape = [3], default = [1, 2, 3] }
[definitions]
R = "rotation(g)"
x = "translation(g)"
s = "x + R*a"
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + m*dot(v, v)/2 - k*dot(s, s)/2"
[claims]
conserved = ["energy", "R*Pi + cross(x, R*P)"]
"""
#: A body that does not turn about the vertical: Veselova's. Its constraint depends on its attitude.
LEVEL = """
title = "A body that does not turn about the vertical"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(3)"
[variables]
R = { role = "attitude" }
Omega = { role = "velocity", default = [1, 2, 0] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[constraints]
level = "dot(transpose(R)*vector(0, 0, 1), Omega) == 0"
[claims]
conserved = ["energy"]
"""
#: A ball whose attitude is the state, turned about its third axis at random.
SHAKEN = """
title = "A ball by its attitude, turned at random"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
R = { role = "attitude" }
Pi = { role = "momentum", default = [1, 2, 3] }
[hamiltonian]
h = "dot(Pi, Pi)/2"
[noise]
dW1 = "0.5*Pi[3]"
"""
