"""Driven systems for tests: specs with inputs and time, as text."""

#: A pendulum whose pivot moves up and down by a cos(w t), driven by a torque u.
PENDULUM = """
title = "Driven pendulum"
routes = ["euler-lagrange", "canonical"]
[variables]
phi = { role = "coordinate", unit = "rad" }
v = { role = "velocity", of = "phi" }
p = { role = "momentum", of = "phi" }
[parameters]
L = { positive = true, default = 1 }
g = { positive = true, default = "9.81" }
a = { default = "0.1" }
w = { positive = true, default = 5 }
[inputs]
u = { default = 0, unit = "1/s^2", doc = "torque" }
[time]
name = "t"
[lagrangian]
l = "(L*v)^2/2 - L*a*w*sin(w*t)*sin(phi)*v + g*L*cos(phi) + u*phi"
"""
#: A free particle with the integral of Galilean boosts, K = t P - m r.
BOOST = """
title = "Free particle"
routes = ["canonical"]
[variables]
r = { role = "coordinate", shape = [3] }
P = { role = "momentum", of = "r" }
[parameters]
m = { positive = true, default = 2 }
[time]
name = "t"
[hamiltonian]
h = "dot(P, P)/(2*m)"
[observables]
K = "t*P - m*r"
[claims]
conserved = ["energy", "K"]
"""
#: A heavy body in a field that is an input.
TOP = """
title = "Heavy top in a field that changes"
routes = ["euler-poincare", "lie-poisson", "hamilton-pontryagin", "poincare", "newton-euler"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[inputs]
u = { shape = [3], default = [0, 0, 1] }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - dot(u, Gamma)"
[claims]
casimirs = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
conserved = ["energy", "dot(Pi, Gamma)"]
"""
#: Suslov's body, driven by a torque.
SUSLOV = """
title = "Suslov's body with a torque"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[inputs]
u = { shape = [3], default = 0, unit = "N m" }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"
[constraints]
knife = "Omega[3] == 0"
[forces]
Omega = "u"
"""
