"""Systems of equal members, written out by hand for a given number of them, and their equations.

The texts here have every member and every term of every sum; nothing of the language of indices is
used, so that the two ways share no step that writes sums out.
"""

from functools import cache
from itertools import combinations
from random import Random

import pytest
import sympy

from coadjoint import pipeline
from coadjoint.derive import derive
from coadjoint.derive.indexed import derive_family
from coadjoint.errors import CrossCheckError
from coadjoint.solve import family_steps
from coadjoint.solve.choices import Choice
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text

RING = """
title = "Spins on a ring"
routes = ["lie-poisson"]
[index]
i = { size = 6, periodic = true }
[algebra]
name = "so(3)"
invariance = "right"
[variables]
S = { role = "momentum", index = "i" }
[parameters]
J = { default = 1 }
D = { index = "i", default = 1 }
[hamiltonian]
h = "-J*sum(i, dot(S[i], S[i+1])) + sum(i, D[i]*S[i, 3]^2)"
[observables]
M = "sum(i, S[i, 3])"
[claims]
casimirs = ["dot(S[i], S[i])"]
conserved = ["energy", "M"]
"""
CHAIN = """
title = "Masses on a line"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { index = "i", default = 1 }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, exp(q[i] - q[i+1])) + sum(i, k[i]*(q[i-1] - q[i+1])^2/2)"
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy", "P"]
"""
VORTICES = """
title = "Vortices"
routes = ["poisson"]
[index]
i = { size = 6 }
[variables]
x = { role = "coordinate", index = "i" }
y = { role = "coordinate", index = "i" }
[parameters]
c = { index = "i", default = 1 }
[poisson.brackets]
"{x, y}" = "1/c[i]"
[hamiltonian]
h = "-sum(i, j, i < j, c[i]*c[j]*log((x[i] - x[j])^2 + (y[i] - y[j])^2)) + sum(i, x[i]^2)"
[observables]
Y = "sum(i, c[i]*y[i])"
[claims]
conserved = ["energy"]
"""
DRAG = """
title = "Particles that repel each other in a fluid"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
c = { index = "i", default = 1 }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, j, i < j, 1/(q[i] - q[j])^2)"
[forces]
p = "-c[i]*p[i]^3"
[observables]
P = "sum(i, p[i])"
"""
SPRINGS = """
title = "Masses with friction between neighbours"
routes = ["euler-lagrange", "canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "q", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
m = { index = "i", positive = true, default = 1 }
c = { default = 1 }
[lagrangian]
l = "sum(i, m[i]*v[i]^2/2) - sum(i, exp(q[i] - q[i+1]))"
[hamiltonian]
h = "sum(i, p[i]^2/(2*m[i])) + sum(i, exp(q[i] - q[i+1]))"
[dissipation]
R = "c*sum(i, (v[i] - v[i+1])^2)/2"
[observables]
P = "sum(i, p[i])"
K = "sum(i, m[i]*v[i]^2/2)"
[claims]
conserved = ["P"]
"""
TOPS = """
title = "Tops in a row"
routes = ["lie-poisson"]
[index]
i = { size = 3 }
[algebra]
name = "so(3)"
[variables]
R = { role = "attitude", index = "i" }
Pi = { role = "momentum", index = "i", default = [0, "0.3", 1] }
[parameters]
w = { index = "i", default = 1 }
[hamiltonian]
h = """
TOPS += (
    '"sum(i, Pi[i, 1]^2/2 + Pi[i, 2]^2/3 + Pi[i, 3]^2/4 - w[i]*R[i, 3, 3]) '
    '- sum(i, trace(transpose(R[i])*R[i+1]))"'
)
TOPS += """
[observables]
J = "sum(i, R[i, 3, 1]*Pi[i, 1] + R[i, 3, 2]*Pi[i, 2] + R[i, 3, 3]*Pi[i, 3])"
[claims]
casimirs = ["det(R[i])"]
conserved = ["energy", "J"]
"""
DRIVEN = """
title = "Oscillators in a row, driven alike"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { default = 1 }
c = { default = 0.5 }
F = { default = 0.3 }
w = { default = 2 }
[time]
name = "t"
[hamiltonian]
h = "sum(i, p[i]^2/2 + k*q[i]^2/2 - F*cos(w*t)*q[i]) + sum(i, c*(q[i+1] - q[i])^2/2)"
[observables]
P = "sum(i, p[i])"
"""
#: Two members stand alone at the first end and one at the last, with parameters of theirs.
WALLS = """
title = "Masses between walls"
routes = ["canonical"]
[index]
i = { size = 7, first = 1, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { index = "i", default = 1 }
c = { default = 1 }
[hamiltonian]
h = '''sum(i, p[i]^2/2) + sum(i, k[i]*(q[i+1] - q[i])^3/3)
    + c*(k[1]*q[1]*q[2]^2 + k[n]*q[n]^4/4)'''
[observables]
length = "q[n] - q[1]"
P = "sum(i, p[i])"
D = "2*sum(i, p[i]^2) - p[1]^2 + k[n-1]*q[n]"
[claims]
conserved = ["energy"]
"""
#: The bond from the last member to the first is another one than those between neighbours.
CLOSED = """
title = "A ring with one weak bond"
routes = ["canonical"]
[index]
i = { size = 6, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
c = { default = 0.5 }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, (q[i+1] - q[i])^4/4) + c*(q[0] - q[n-1])^4/4"
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy", "P"]
"""
#: Of particles that all repel each other the first and the last are held by springs.
HELD = """
title = "Particles of which two are held"
routes = ["canonical"]
[index]
i = { size = 6, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
c = { index = "i", default = 1 }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, j, i < j, c[i]*c[j]/(1 + (q[i] - q[j])^2)) + q[0]^2/2 + q[n-1]^4"
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy"]
"""
#: No Hamiltonian: masses that depend on places, walls, and velocities as the state.
BY_VELOCITIES = """
title = "Masses on a bent wire"
routes = ["euler-lagrange"]
[index]
i = { size = 6, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
v = { role = "velocity", of = "q", index = "i" }
[parameters]
m = { index = "i", positive = true, default = 1 }
[lagrangian]
l = '''sum(i, m[i]*(1 + q[i]^2)*v[i]^2/2) - sum(i, (q[i+1] - q[i])^4/4)
    - q[0]^2/2 - q[n-1]^4/4'''
[claims]
conserved = ["energy"]
"""
#: Charges in a plane: a velocity in the first degree, and pairs.
CHARGES = """
title = "Charges in a magnetic field"
routes = ["euler-lagrange", "canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i", shape = [2] }
v = { role = "velocity", of = "q", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
m = { index = "i", positive = true, default = 1 }
b = { default = 1 }
[lagrangian]
l = '''sum(i, m[i]*dot(v[i], v[i])/2 + b*(q[i, 1]*v[i, 2] - q[i, 2]*v[i, 1])/2)
    - sum(i, j, i < j, m[i]*m[j]/(1 + dot(q[i] - q[j], q[i] - q[j])))'''
[observables]
J = "sum(i, q[i, 1]*p[i, 2] - q[i, 2]*p[i, 1])"
[claims]
conserved = ["energy", "J"]
"""
#: Actions on each member, of which the third has a cocycle.
PLANAR = """
title = "Masses in a plane, tied to a ring"
routes = ["canonical"]
[index]
i = { size = 6, periodic = true }
[variables]
q = { role = "coordinate", index = "i", shape = [2] }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
m = { index = "i", positive = true, default = 1 }
[hamiltonian]
h = "sum(i, dot(p[i], p[i])/(2*m[i])) + sum(i, dot(q[i+1] - q[i], q[i+1] - q[i])^2)"
[symmetries.L]
algebra = "so(2)"
matrix = "A"
generators = { q = "A*q[i]" }
[symmetries.P]
algebra = "R^2"
vector = "a"
generators = { q = "a" }
map = "sum(i, dot(a, p[i]))"
[observables]
centre = "sum(i, m[i]*q[i])/sum(i, m[i])"
turning = "sum(i, q[i, 1]*p[i, 2])*sum(i, p[i, 1])^2 - atan2(sum(i, p[i, 1]), sum(i, m[i]))"
[symmetries.G]
algebra = "R^2"
vector = "b"
generators = { q = "vector(b[1], 0)", p = "vector(b[2], 0)" }
[claims]
conserved = ["energy", "L", "P"]
"""


def write_velocities(n):
    """So many masses on a wire."""
    terms = [f"m_{k}*(1 + q_{k}^2)*v_{k}^2/2" for k in range(n)]
    terms += [f"-(q_{k + 1} - q_{k})^4/4" for k in range(n - 1)]
    terms += ["-q_0^2/2", f"-q_{n - 1}^4/4"]
    return "\n".join(
        [
            'title = "W"\nroutes = ["euler-lagrange"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'v_{k} = {{ role = "velocity", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"m_{k} = {{ positive = true }}" for k in range(n)),
            f'[lagrangian]\nl = "{" + ".join(terms)}"',
        ]
    )


def write_charges(n):
    """So many charges, by their Hamiltonian: the velocity is (p - b A)/m."""
    terms = [
        f"((p_{k}[1] + b*q_{k}[2]/2)^2 + (p_{k}[2] - b*q_{k}[1]/2)^2)/(2*m_{k})" for k in range(n)
    ]
    for a, c in combinations(range(n), 2):
        terms.append(f"m_{a}*m_{c}/(1 + (q_{a}[1] - q_{c}[1])^2 + (q_{a}[2] - q_{c}[2])^2)")
    return "\n".join(
        [
            'title = "C"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate", shape = [2] }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]\nb = {}",
            *(f"m_{k} = {{ positive = true }}" for k in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(terms)}"',
        ]
    )


def write_masses(n, terms, parameters):
    """So many masses with these terms of the energy, and parameters."""
    kinetic = [f"p_{k}^2/2" for k in range(n)]
    return "\n".join(
        [
            'title = "W"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"{name} = {{ default = 1 }}" for name in parameters),
            f'[hamiltonian]\nh = "{" + ".join([*kinetic, *terms])}"',
        ]
    )


def write_walls(n):
    """So many masses between walls."""
    terms = [f"k_{k}*(q_{k + 1} - q_{k})^3/3" for k in range(n - 1)]
    terms += ["c*k_0*q_0*q_1^2", f"c*k_{n - 1}*q_{n - 1}^4/4"]
    return write_masses(n, terms, ["c", *(f"k_{k}" for k in range(n))])


def write_closed(n):
    """So many masses in a ring with a weak bond."""
    terms = [f"(q_{k + 1} - q_{k})^4/4" for k in range(n - 1)]
    return write_masses(n, [*terms, f"c*(q_{n - 1} - q_0)^4/4"], ["c"])


def write_held(n):
    """So many particles, of which two are held."""
    terms = [f"c_{a}*c_{b}/(1 + (q_{a} - q_{b})^2)" for a, b in combinations(range(n), 2)]
    terms += ["q_0^2/2", f"q_{n - 1}^4"]
    return write_masses(n, terms, [f"c_{k}" for k in range(n)])


PULLED = """
title = "Beads that repel each other, each pulled by an input of its own, all by another one"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { index = "i", default = 1 }
[inputs]
u = { index = "i", default = "0.5" }
g = { default = 1 }
f = { default = 0 }
[hamiltonian]
h = '''sum(i, p[i]^2/2 + k[i]*q[i]^2/2 - g*q[i]) + sum(i, u[i+1]*q[i]*q[i+1])
    + sum(i, j, i < j, u[i]*u[j]/(1 + (q[i] - q[j])^2))'''
[forces]
p = "f*p[i] - u[i]^2*p[i]"
[observables]
P = "sum(i, p[i])"
"""


def write_pulled(n):
    """So many of these beads."""
    terms = [f"p_{k}^2/2 + k_{k}*q_{k}^2/2 - g*q_{k}" for k in range(n)]
    terms += [f"u_{k + 1}*q_{k}*q_{k + 1}" for k in range(n - 1)]
    terms += [f"u_{i}*u_{j}/(1 + (q_{i} - q_{j})^2)" for i, j in combinations(range(n), 2)]
    return "\n".join(
        [
            'title = "P"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"k_{k} = {{ default = 1 }}" for k in range(n)),
            "[inputs]",
            *(f'u_{k} = {{ default = "0.5" }}' for k in range(n)),
            "g = { default = 1 }\nf = { default = 0 }",
            f'[hamiltonian]\nh = "{" + ".join(terms)}"\n[forces]',
            *(f'p_{k} = "f*p_{k} - u_{k}^2*p_{k}"' for k in range(n)),
        ]
    )


SHAKEN = """
title = "Spins in a row, shaken each by itself and all together"
routes = ["lie-poisson"]
[index]
i = { size = 5 }
[algebra]
name = "so(3)"
[variables]
S = { role = "momentum", index = "i", default = [0, "0.6", "0.8"] }
[parameters]
J = { default = 1 }
s = { index = "i", default = "0.5" }
z = { default = "0.2" }
[noise]
dZ = "z*sum(i, S[i, 3])"
dX = "s[i]*S[i, 1]"
dY = "s[i]*S[i, 2]"
[hamiltonian]
h = "J*sum(i, dot(S[i], S[i+1]))"
[observables]
M = "sum(i, S[i, 3])"
[claims]
casimirs = ["dot(S[i], S[i])"]
"""
#: The same with a field along the axis of each, another one that oscillates, and inputs for both.
MOVED = SHAKEN.replace(
    "[noise]", '[time]\nname = "t"\n[inputs]\nu = { index = "i" }\nf = { default = 1 }\n[noise]'
).replace("S[i+1]))", "S[i+1])) + sum(i, (u[i] + f*t)*S[i, 3])")


def write_shaken(n):
    """So many of these spins, with the processes in the order of a family."""
    spins = range(n)
    bonds = " + ".join(f"dot(S_{k}, S_{k + 1})" for k in range(n - 1))
    parts = ", ".join(['"so(3)"'] * n)
    total = " + ".join(f"S_{k}[3]" for k in spins)
    return "\n".join(
        [
            f'title = "S"\nroutes = ["lie-poisson"]\n[algebra]\ndirect_sum = [{parts}]',
            "[variables]",
            *(f'S_{k} = {{ role = "momentum", block = "rotation_{k + 1}" }}' for k in spins),
            "[parameters]\nJ = { default = 1 }",
            *(f's_{k} = {{ default = "0.5" }}' for k in spins),
            f'z = {{ default = "0.2" }}\n[noise]\ndZ = "z*({total})"',
            *(f'dX_{k} = "s_{k}*S_{k}[1]"' for k in spins),
            *(f'dY_{k} = "s_{k}*S_{k}[2]"' for k in spins),
            f'[hamiltonian]\nh = "J*({bonds})"',
        ]
    )


def write_driven(n):
    """So many of these oscillators."""
    terms = [f"p_{k}^2/2 + k*q_{k}^2/2 - F*cos(w*t)*q_{k}" for k in range(n)]
    terms += [f"c*(q_{k + 1} - q_{k})^2/2" for k in range(n - 1)]
    return "\n".join(
        [
            'title = "O"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]\nk = { default = 1 }\nc = { default = 0.5 }",
            'F = { default = 0.3 }\nw = { default = 2 }\n[time]\nname = "t"',
            f'[hamiltonian]\nh = "{" + ".join(terms)}"',
        ]
    )


def write_drag(n):
    """So many particles in a fluid."""
    terms = [f"p_{k}^2/2" for k in range(n)]
    terms += [f"1/(q_{a} - q_{b})^2" for a, b in combinations(range(n), 2)]
    return "\n".join(
        [
            'title = "D"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"c_{k} = {{ default = 1 }}" for k in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(terms)}"\n[forces]',
            *(f'p_{k} = "-c_{k}*p_{k}^3"' for k in range(n)),
        ]
    )


def write_springs(n):
    """So many masses, each of which rubs against the next one."""
    bonds = range(n - 1)
    kinetic = " + ".join(f"p_{k}^2/(2*m_{k})" for k in range(n))
    walls = "".join(f" + exp(q_{k} - q_{k + 1})" for k in bonds)
    pulls = [
        "".join(
            f" + c*(p_{j}/m_{j} - p_{k}/m_{k})" for j in (k - 1, k + 1) if 0 <= j < n
        ).removeprefix(" + ")
        for k in range(n)
    ]
    return "\n".join(
        [
            'title = "S"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"m_{k} = {{ positive = true, default = 1 }}" for k in range(n)),
            "c = { default = 1 }",
            f'[hamiltonian]\nh = "{kinetic}{walls}"\n[forces]',
            *(f'p_{k} = "{pull}"' for k, pull in enumerate(pulls)),
        ]
    )


def write_tops(n):
    """The row with n tops."""
    alone = [f"Pi_{k}[1]^2/2 + Pi_{k}[2]^2/3 + Pi_{k}[3]^2/4 - w_{k}*R_{k}[3, 3]" for k in range(n)]
    bonds = [f" - trace(transpose(R_{k})*R_{k + 1})" for k in range(n - 1)]
    blocks = [f'block = "rotation_{k + 1}"' for k in range(n)]
    parts = ", ".join(['"so(3)"'] * n)
    return "\n".join(
        [
            f'title = "T"\nroutes = ["lie-poisson"]\n[algebra]\ndirect_sum = [{parts}]',
            "[variables]",
            *(f'R_{k} = {{ role = "attitude", {blocks[k]} }}' for k in range(n)),
            *(f'Pi_{k} = {{ role = "momentum", {blocks[k]} }}' for k in range(n)),
            "[parameters]",
            *(f"w_{k} = {{ default = 1 }}" for k in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(alone)}{"".join(bonds)}"',
        ]
    )


#: R. Camassa and D. D. Holm, Physical Review Letters 71 (1993) 1661.
PEAKONS = """
title = "Peakons"
routes = ["canonical"]
[index]
i = { size = 5 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[hamiltonian]
h = "sum(i, p[i]^2/2) + sum(i, j, i < j, p[i]*p[j]*exp(-abs(q[i] - q[j])))"
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy", "P"]
"""
BEADS = """
title = "Beads with springs between neighbours, of which all repel each other"
routes = ["canonical"]
[index]
i = { size = 6 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[parameters]
k = { index = "i", default = 1 }
c = { index = "i", default = 1 }
[hamiltonian]
h = '''sum(i, p[i]^2/2) + sum(i, k[i]*(q[i+1] - q[i])^2/2)
    + sum(i, j, i < j, c[i]*c[j]/(1 + (q[i] - q[j])^2))'''
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy", "P"]
"""
NECKLACE = BEADS.replace("size = 6", "size = 6, periodic = true")


def write_ring(n):
    """The ring with n spins."""
    spins = [f"S_{k}" for k in range(n)]
    bonds = " + ".join(f"dot({a}, {b})" for a, b in zip(spins, spins[1:] + spins[:1], strict=True))
    alone = " + ".join(f"D_{k}*S_{k}[3]^2" for k in range(n))
    parts = ", ".join(['"so(3)"'] * n)
    blocks = [f', block = "rotation_{k + 1}"' if n > 1 else "" for k in range(n)]
    momenta = [f'S_{k} = {{ role = "momentum"{blocks[k]} }}' for k in range(n)]
    algebra = f"direct_sum = [{parts}]" if n > 1 else 'name = "so(3)"'
    return "\n".join(
        [
            'title = "R"\nroutes = ["lie-poisson"]\n[algebra]\ninvariance = "right"',
            algebra,
            "[variables]",
            *momenta,
            "[parameters]\nJ = { default = 1 }",
            *(f"D_{k} = {{ default = 1 }}" for k in range(n)),
            f'[hamiltonian]\nh = "-J*({bonds}) + {alone}"',
        ]
    )


def write_chain(n):
    """The open chain with n masses."""
    terms = [f"p_{k}^2/2" for k in range(n)]
    terms += [f"exp(q_{k} - q_{k + 1})" for k in range(n - 1)]
    terms += [f"k_{k}*(q_{k - 1} - q_{k + 1})^2/2" for k in range(1, n - 1)]
    return "\n".join(
        [
            'title = "C"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{k} = {{ role = "coordinate" }}' for k in range(n)),
            *(f'p_{k} = {{ role = "momentum", of = "q_{k}" }}' for k in range(n)),
            "[parameters]",
            *(f"k_{k} = {{ default = 1 }}" for k in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(terms)}"',
        ]
    )


def write_beads(n, *, periodic=False):
    """So many beads in a row, or in a ring."""
    terms = [f"p_{i}^2/2" for i in range(n)]
    terms += [f"k_{i}*(q_{(i + 1) % n} - q_{i})^2/2" for i in range(n if periodic else n - 1)]
    terms += [f"c_{i}*c_{j}/(1 + (q_{i} - q_{j})^2)" for i, j in combinations(range(n), 2)]
    return "\n".join(
        [
            'title = "B"\nroutes = ["canonical"]\n[variables]',
            *(f'q_{i} = {{ role = "coordinate" }}' for i in range(n)),
            *(f'p_{i} = {{ role = "momentum", of = "q_{i}" }}' for i in range(n)),
            "[parameters]",
            *(f"{c}_{i} = {{ default = 1 }}" for c in "kc" for i in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(terms)}"',
        ]
    )


def write_necklace(n):
    """So many beads in a ring."""
    return write_beads(n, periodic=True)


def write_vortices(n):
    """So many vortices."""
    pairs = [
        f"-c_{a}*c_{b}*log((x_{a} - x_{b})^2 + (y_{a} - y_{b})^2)"
        for a, b in combinations(range(n), 2)
    ]
    terms = [*pairs, *(f"x_{k}^2" for k in range(n))]
    return "\n".join(
        [
            'title = "V"\nroutes = ["poisson"]\n[variables]',
            *(f'{c}_{k} = {{ role = "coordinate" }}' for c in "xy" for k in range(n)),
            "[parameters]",
            *(f"c_{k} = {{ default = 1 }}" for k in range(n)),
            "[poisson.brackets]",
            *(f'"{{x_{k}, y_{k}}}" = "1/c_{k}"' for k in range(n)),
            f'[hamiltonian]\nh = "{" + ".join(terms)}"',
        ]
    )


def read(text, *changes, sizes=None):
    """The spec of a text with changes."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec_text(text, "sample.toml", sizes or {})


@cache
def render(text, name="sample"):
    """Its files, proved; made once in a process, for tests that change nothing of the engine."""
    return pipeline.render(read_spec_text(text, f"{name}.toml"))


def family_of(spec):
    """The equations of the generic member."""
    return derive_family(derive(spec))


def member(symbol, k):
    """What a component of a member is called in the texts above."""
    name = symbol.name
    base = name.rstrip("0123456789")
    return sympy.Symbol(f"{base}_{k}{'_' if base != name else ''}{name[len(base) :]}")


def rates_of_members(family, n):
    """The rates of n members by the equations of the generic one, in their own symbols."""
    return [[_place(family, tree, k, n) for tree in _trees(family, k, n)] for k in range(n)]


def _trees(family, k, n):
    return family.ends.get(k, family.ends.get(k - n, family.rates))


def _place(family, tree, k, n):
    """A rate of the generic member as that of member k."""
    own = {each: member(each, k) for each in (*family.states, *family.indexed)}
    own |= {s: member(c, (k + d) % n) for (c, d), s in family.neighbours.items()}
    for pairs in family.pair_sums:
        others = [j for j in range(n) if j != k]
        total = sum(
            pairs.term.xreplace(own | {s: member(c, j) for c, s in family.partners.items()})
            for j in others
        )
        own[pairs.symbol] = total
    return tree.xreplace(own)


def value_of(family, total, n):
    """A total of n members in their own symbols."""
    values = {}
    for each in total.sums:
        ring = family.index.periodic
        run = range(n) if ring else range(each.before, n - each.after)
        places = [(k, None) for k in run]
        if each.over == "pairs":
            places = list(combinations(range(n), 2))
        parts = []
        for k, j in places:
            own = {one: member(one, k) for one in (*family.states, *family.indexed)}
            own |= {s: member(c, (k + d) % n) for (c, d), s in family.neighbours.items()}
            if j is not None:
                own |= {s: member(c, j) for c, s in family.partners.items()}
            parts.append(each.term.xreplace(own))
        values[each.symbol] = sum(parts)
    for (c, number), symbol in family.singles.items():
        values[symbol] = member(c, number % n)
    return total.formula.xreplace(values)


def check_rates(family, text, n):
    """The rates of n members are those of the text that has them all."""
    equations = derive(read_spec_text(text, "whole.toml"))
    known = dict(zip(equations.variables, equations.rates, strict=True))
    assert len(known) == n * len(family.states)
    for k, rates in enumerate(rates_of_members(family, n)):
        for symbol, rate in zip(family.states, rates, strict=True):
            name = member(symbol, k).name
            assert are_equal(rate, known[name]), (n, name)


def are_equal(left, right):
    """Whether two expressions have one value at three points, to 25 digits."""
    left, right = map(sympy.sympify, (left, right))
    names = sorted(left.free_symbols | right.free_symbols, key=str)
    draw = Random(7)
    for _ in range(3):
        point = {each: sympy.Rational(draw.randint(1, 99), 50) for each in names}
        a, b = (each.evalf(40, subs=point) for each in (left, right))
        if abs(a - b) > sympy.Rational(1, 10**25) * (1 + abs(a)):
            return False
    return True


def require_wrong_steps(texts, method, old, new, **how):
    """A change of ``solver.c`` changes some bit of a run, so that a fresh object is refused."""
    text = texts["solver.c"]
    assert old in text
    refused = pytest.raises(CrossCheckError, match="differs from its NumPy twin")
    with load_texts({**texts, "solver.c": text.replace(old, new)}) as system, refused:
        family_steps.load(system, Choice(name=method, order=2, **how), "c")
