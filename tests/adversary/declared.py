"""Random specs with a submanifold or a symmetry, true and false by construction.

Goes out: the text of a spec and whether what it declares is true. Two equal bodies that start alike
move alike, two that differ do not; a motion has a momentum map where its Lagrangian does not change
by its flow. Read next: `tests.adversary.specs`, whose specs have neither.
"""

from __future__ import annotations

import random


def alike(seed, is_true):
    """Two bodies on so(3)* with one law, on the submanifold of equal momenta."""
    source = random.Random(f"alike {seed}")
    a, b, c = (source.choice(("1/2", "a", "2*a", "3", "sqrt(2)", "cos(a)")) for _ in range(3))
    body = f"({a})*{{0}}1^2 + ({b})*{{0}}2^2 + ({c} + 5)*{{0}}3^2"
    more = source.choice(("", f" + ({b})*dot(x, y)"))
    extra = "" if is_true else source.choice((" + y1", " + y2^2/7", " + x3*y1/9"))
    return f"""title = "Two bodies alike"
routes = ["lie-poisson"]
[algebra]
direct_sum = ["so(3)", "so(3)"]
[variables]
x = {{ role = "momentum", block = ["J1_1", "J2_1", "J3_1"] }}
y = {{ role = "momentum", block = ["J1_2", "J2_2", "J3_2"] }}
[parameters]
a = {{ positive = true, default = "1/3" }}
[hamiltonian]
h = "{body.format("x")} + {body.format("y")}{more}{extra}"
[reduction]
where = ["x1 - y1", "x2 - y2", "x3 - y3"]
section = {{ y = "x" }}
[claims]
conserved = ["dot(x, x)"]
"""


def symmetric(seed, is_true):
    """A particle in the plane: translation or rotation, with a shift of time or without."""
    source = random.Random(f"symmetric {seed}")
    c = source.choice(("1", "k", "sqrt(2)", "exp(k)"))
    turned = source.random() < 0.5
    moves = "vector(-q2, q1)" if turned else "vector(1, 0)"
    same = (
        ("dot(q, q)/2", "sqrt(1 + dot(q, q))", "cos(k)*dot(q, q)^2")
        if turned
        else (
            "q2^2/2",
            "sin(q2)",
            "exp(k*q2)",
        )
    )
    spoil = "" if is_true else source.choice((" + q1/3", " + sin(q1)", " + q1*q2"))
    shift = source.random() < 0.5
    algebra, time = ("R^2", 'time = "xi[2]"\n') if shift else ("R^1", "")
    part = "xi[1]" if shift else "xi"  # a vector of one component is a number
    return f"""title = "Particle with a symmetry"
routes = ["euler-lagrange"]
[variables]
q = {{ role = "coordinate", shape = [2] }}
v = {{ role = "velocity", of = "q" }}
[parameters]
k = {{ positive = true, default = "1/2" }}
[lagrangian]
l = "{c}*dot(v, v)/2 - {source.choice(same)}{spoil}"
[symmetries.J]
algebra = "{algebra}"
vector = "xi"
generators = {{ q = "{part}*{moves}" }}
{time}[claims]
conserved = ["J"]
"""


def mirrored(seed, is_true):
    """A body on so(3)* with a half turn and a motion back: true without mixed terms."""
    source = random.Random(f"mirrored {seed}")
    a, b, c = (source.choice(("1/2", "a", "a^2 + 1", "sqrt(3)", "sin(a)")) for _ in range(3))
    spoil = "" if is_true else source.choice((" + mu1", " + mu2/3 + mu1/5"))
    return f"""title = "Body with half turns"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
mu = {{ role = "momentum" }}
[parameters]
a = {{ positive = true, default = "1/3" }}
[hamiltonian]
h = "({a})*mu1^2 + ({b})*mu2^2 + ({c} + 7)*mu3^2{spoil}"
[transformations.turn]
map = {{ mu = "vector(-mu1, -mu2, mu3)" }}
[transformations.back]
map = {{ mu = "-mu" }}
reverses_time = true
[claims]
conserved = ["energy"]
"""


#: Each with the kinds of claims that are refuted where it is false.
DECLARED = {alike: "reduction", symmetric: "conserved", mirrored: "transformation"}
