"""Advice: what a message says to do is done, and the spec loads. No advice is left untried."""

import ast
from pathlib import Path

import pytest
from click.testing import CliRunner

import coadjoint.spec
from coadjoint.cli import main
from coadjoint.errors import CoadjointError, SpecError
from tests.constrained import PARTICLE, SLEIGH
from tests.derive import test_bound_momenta
from tests.derive.test_configuration import LAW
from tests.rolling import BALL
from tests.spec.test_charts import CHART, RATES
from tests.spec.test_consistency import KIRCHHOFF, MOMENTA_ONLY
from tests.spec.test_poisson import CANONICAL, NAMBU
from tests.spec.test_routes import OSCILLATOR
from tests.spec.test_symmetries import TEXT as PARTICLES
from tests.spec.test_windows import INDEXED
from tests.spec.texts import BY_BRACKETS, BY_MATRICES
from tests.specs import RIGID_BODY, shipped, spec

SPEC = Path(coadjoint.spec.__file__).parent
TURN = '[transformations.flip]\nmap = { Pi = "-Pi" }\n'
END = "[claims]"
FAST = test_bound_momenta.TOP.split(END)[0]
BARE = """
title = "A Lax pair alone"
routes = ["lax"]
[variables]
x = { role = "coordinate", shape = [3] }
[lax]
L = "hat(x)"
M = "hat(vector(x1, 2*x2, 3*x3))"
"""
#: A velocity in a state that a Hamiltonian moves.
MASSLESS = """
title = "An oscillator whose bracket is declared"
routes = ["poisson"]
[poisson]
canonical = [["q", "v"]]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[hamiltonian]
h = "v^2/2 + q^2/2"
[claims]
"""
WITH_ROTOR = 's = { role = "coordinate" }\nu = { role = "velocity", of = "s" }\n[parameters]'
CANONICAL_ROUTE = 'routes = ["canonical"]'
ENERGY = '[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"\n'
BOTH = 'routes = ["euler-poincare", "lie-poisson"]'
ALONE = 'routes = ["hamilton-pontryagin"]'
#: Coordinates with momenta next to an algebra.
PRODUCT = """
title = "x"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
v = { role = "velocity", of = "q" }
Pi = { role = "momentum" }
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[lagrangian]
l = "dot(Omega, Omega)/2 + v^2/2"
"""
ONE = 'routes = ["euler-poincare"]'
FORCE = '[forces]\nOmega = "-Omega"\n[claims]'
SHAKEN = "[inputs]\nu = { default = 0 }\n[claims]"
TOP = RIGID_BODY.replace(
    'Pi = { role = "momentum" }',
    'Pi = { role = "momentum" }\nGamma = { role = "advected", representation = "vector" }',
)
ISERLES = shipped("bloch_iserles_2").path.read_text(encoding="utf-8")


def write(old, new):
    """A change."""
    return [(old, new)]


def before_claims(lines):
    """Further tables."""
    return write(END, f"{lines}\n{END}")


#: A component of its velocity is given.
BODY_OF_AXES = """
title = "A body that does not turn about its third axis"
routes = ["nonholonomic"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[lagrangian]
l = "dot(Omega, Omega)/2"
[constraints]
plane = "Omega3 == 0"
"""

MOMENTUM = '"momentum"'


def of_unit(text):
    """The momentum with a unit."""
    return write(MOMENTUM, f'{MOMENTUM}, unit = "{text}"')


#: Masses that the next one pulls, also the last one.
PUSHED = """
title = "A row of masses"
routes = ["canonical"]
[index]
i = { size = 5 }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[hamiltonian]
h = "sum(i, p[i]^2/2)"
[forces]
p = "q[i+1] - q[i]"
"""
NOISY_VELOCITY = """
title = "A ball that turns"
routes = ["nonholonomic"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[lagrangian]
l = "dot(Omega, Omega)/2"
[noise]
dW = "Omega1"
"""
#: A top on a submanifold of which one component is told.
RESTRICTED = """
title = "A top"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
M = { role = "momentum", form = "antisymmetric" }
[hamiltonian]
h = "-trace(M*M)/4"
[reduction]
section = { M = "0" }
"""

#: Of each advice: a spec, what is wrong with it, what the message says, and what it says to do.
ADVICE = [
    *INDEXED,
    (
        RESTRICTED,
        [],
        "Write its entries one by one, as M12.",
        [('M = "0"', 'M12 = "0"')],
    ),
    (
        PUSHED,
        [],
        "A ring has such a neighbour: write periodic = true in [index] i.",
        write("size = 5", "size = 5, periodic = true"),
    ),
    (
        NOISY_VELOCITY,
        [],
        "Declare momenta and take a route that moves them, or remove [noise].",
        [
            ("nonholonomic", "euler-poincare"),
            ("[lagrangian]", 'Pi = { role = "momentum" }\n[lagrangian]'),
            ('"Omega1"', '"Pi1"'),
        ],
    ),
    # -- units
    (
        RIGID_BODY,
        of_unit("J/kg K"),
        "Write K before the sign /, or what is below it in parentheses.",
        write("J/kg K", "J K/kg"),
    ),
    (RIGID_BODY, of_unit("10 m"), "Numbers belong to formulas.", write("10 m", "m")),
    (RIGID_BODY, of_unit("kgg"), "Did you mean 'kg'?", write("kgg", "kg")),
    (RIGID_BODY, of_unit("Nm s"), "Write 'N m'.", write("Nm", "N m")),
    (RIGID_BODY, of_unit("joule sec"), "Write 'J'.", write("joule sec", "J s")),
    (
        RIGID_BODY,
        [*of_unit("kg m^2/s"), ('"velocity"', '"velocity", unit = "m/s"')],
        'Write unit = "1/s".',
        write("m/s", "1/s"),
    ),
    (
        RIGID_BODY.replace(
            "[parameters]", '[time]\nt = {}\n[forces]\nOmega = "-t*Omega"\n[parameters]'
        ),
        [],
        'Write name = "t".',
        write("t = {}", 'name = "t"'),
    ),
    # -- constraints
    (
        BODY_OF_AXES.replace(
            "[constraints]", '[constraints]\nboth = ["Omega1 == 0", "Omega2 == 0"]'
        ),
        [],
        "Write each equation under a name of its own, as both1 and both2.",
        write(
            'both = ["Omega1 == 0", "Omega2 == 0"]', 'both1 = "Omega1 == 0"\nboth2 = "Omega2 == 0"'
        ),
    ),
    (
        BODY_OF_AXES,
        write('"velocity"', '"velocity", default = [1, 2, 3]'),
        "Write 0 in the place of Omega3.",
        write("[1, 2, 3]", "[1, 2, 0]"),
    ),
    # -- forms
    (
        TOP.replace("so(3)", "su(3)").replace('"vector"', '"adjoint"').replace("diag(I)*", ""),
        write('role = "momentum"', 'role = "momentum", form = "matrix"'),
        "Without form, Pi[1] to Pi[8] are along A12, A13, A23, S12,",
        write(', form = "matrix"', ""),
    ),
    # -- blocks
    (
        TOP.replace("[parameters]", '[representations.turn]\nright = "rotation"\n[parameters]'),
        write('representation = "vector"', 'representation = "turn", block = "rotation"'),
        "Remove block.",
        write(', block = "rotation"', ""),
    ),
    # -- routes
    (
        RIGID_BODY,
        write('"lie-poisson"', '"clebsch"') + write(END, FORCE),
        'Remove "clebsch", or remove [forces].',
        write(', "clebsch"', ""),
    ),
    (
        RIGID_BODY,
        write(BOTH, 'routes = ["complexification"]'),
        'Write "euler-poincare" in its place, or write [hamiltonian] and below it '
        'h = "dot(Pi, Pi)/2".',
        write('"complexification"', '"euler-poincare"'),
    ),
    (
        RIGID_BODY,
        write(ENERGY, ""),
        'Write [lagrangian] and below it l = "dot(Omega, Omega)/2".',
        before_claims('[lagrangian]\nl = "dot(Omega, Omega)/2"'),
    ),
    (
        OSCILLATOR,
        write('"canonical"', '"canonical", "euler-lagrange"'),
        'Remove "euler-lagrange".',
        write(', "euler-lagrange"', ""),
    ),
    (
        OSCILLATOR,
        write('[hamiltonian]\nh = "dot(p, p)/2 + dot(q, q)/2"', ""),
        'Write [hamiltonian] and below it h = "dot(p, p)/2".',
        write("[variables]", '[hamiltonian]\nh = "dot(p, p)/2"\n[variables]'),
    ),
    (
        MOMENTA_ONLY,
        write('"lie-poisson"', '"lie-poisson", "manakov"')
        + write("[hamiltonian]", '[time]\nname = "t"\n[hamiltonian]')
        + write("dot(Pi, Pi)/2", "dot(Pi, Pi)*t"),
        'Remove "manakov".',
        write(', "manakov"', ""),
    ),
    (
        RIGID_BODY,
        write('"euler-poincare"', '"clebsch"'),
        'Put "euler-poincare" first.',
        write('"clebsch"', '"euler-poincare", "clebsch"'),
    ),
    (
        RIGID_BODY,
        write(BOTH, ONE) + before_claims('[hamiltonian]\nh = "dot(Pi, Pi)"'),
        'Add "lie-poisson" to routes, or remove [hamiltonian].',
        write(ONE, BOTH),
    ),
    (
        RIGID_BODY,
        before_claims('[newton]\nq = { force = "1" }'),
        "Remove [newton].",
        write('[newton]\nq = { force = "1" }', ""),
    ),
    (
        RIGID_BODY.replace("[algebra]", "").replace('name = "so(3)"', ""),
        [],
        'Write [algebra] and below it name = "so(3)".',
        write("[variables]", '[algebra]\nname = "so(3)"\n[variables]'),
    ),
    (
        RIGID_BODY,
        before_claims('[poisson]\nnambu = ["1"]'),
        "follows from it: remove [poisson].",
        write('[poisson]\nnambu = ["1"]', ""),
    ),
    (
        OSCILLATOR,
        write("[hamiltonian]", '[representations.r]\nleft = "a"\n[hamiltonian]'),
        "Remove [representations].",
        write('[representations.r]\nleft = "a"\n', ""),
    ),
    (
        BARE,
        write("[lax]", 'v = { role = "velocity", of = "x" }\n[lax]'),
        "Write M in variables of the state, or declare [hamiltonian].",
        write('v = { role = "velocity", of = "x" }\n', ""),
    ),
    # -- what acts
    (RIGID_BODY, write(END, SHAKEN), "remove it from [inputs].", write(SHAKEN, END)),
    (
        RIGID_BODY,
        before_claims('[time]\nname = "t"'),
        "Use it in the energy or a force, or remove [time].",
        before_claims('[forces]\nOmega = "t*Omega"'),
    ),
    (
        RIGID_BODY,
        before_claims('[forces]\nOmgea = "-Omega"'),
        "Did you mean 'Omega'?",
        write("Omgea", "Omega"),
    ),
    (
        RIGID_BODY,
        before_claims('[forces]\nPi = "-Omega"'),
        "Write Omega in its place.",
        write('Pi = "-Omega"', 'Omega = "-Omega"'),
    ),
    (
        RIGID_BODY,
        before_claims('[forces]\nwind = "-Omega"'),
        "Remove wind.",
        write('wind = "-Omega"', ""),
    ),
    (
        RIGID_BODY,
        before_claims('[dissipation]\nR = "dot(Pi, Pi)"'),
        "Name Omega in it, or remove [dissipation].",
        write('R = "dot(Pi, Pi)"', 'R = "dot(Omega, Omega)"'),
    ),
    (
        MOMENTA_ONLY,
        write("[hamiltonian]", '[dissipation]\nR = "dot(Pi, Pi)"\n[hamiltonian]'),
        "Write what acts along a momentum in [forces].",
        write('[dissipation]\nR = "dot(Pi, Pi)"', '[forces]\nPi = "-Pi"'),
    ),
    *(
        (
            MASSLESS,
            [
                ('routes = ["poisson"]\n[poisson]\ncanonical = [["q", "v"]]', CANONICAL_ROUTE),
                (END, '[double_bracket]\nG = "1"\n[claims]'),
            ],
            "Declare [lagrangian] and a route that takes it, or [poisson].",
            done,
        )
        for done in (
            [
                (CANONICAL_ROUTE, 'routes = ["euler-lagrange"]'),
                ('[hamiltonian]\nh = "v^2/2 + q^2/2"', '[lagrangian]\nl = "v^2/2 - q^2/2"'),
            ],
            write(CANONICAL_ROUTE, f'{CANONICAL_ROUTE}\n[poisson]\ncanonical = [["q", "v"]]'),
        )
    ),
    *(
        (
            PARTICLE,
            before_claims(table),
            f"Remove {name}, and write dissipation of velocities in [dissipation].",
            write(table, '[dissipation]\nR = "k*(u^2 + v^2)/2"'),
        )
        for name, table in (
            ("[double_bracket]", '[double_bracket]\nG = "m"'),
            ("[metriplectic]", '[metriplectic]\nG = "m"\nS = "m"'),
        )
    ),
    (
        MASSLESS,
        write(END, '[forces]\nv = "-v"\n[claims]'),
        'Write v = { role = "coordinate" } in [variables], and in [forces] what is added to its',
        write('"velocity", of = "q"', '"coordinate"'),
    ),
    (
        MASSLESS,
        write(END, '[dissipation]\nR = "v^2"\n[claims]'),
        'Write v = { role = "coordinate" } in [variables], and in [forces] what is added to its',
        [
            ('"velocity", of = "q"', '"coordinate"'),
            ('[dissipation]\nR = "v^2"', '[forces]\nv = "-v"'),
        ],
    ),
    (
        MOMENTA_ONLY,
        write(
            "[hamiltonian]",
            '[double_bracket]\nG = "1"\n[metriplectic]\nG = "1"\nS = "1"\n[hamiltonian]',
        ),
        "Remove [metriplectic] or [double_bracket].",
        write('[metriplectic]\nG = "1"\nS = "1"\n', ""),
    ),
    # -- noise
    (
        RIGID_BODY,
        write(END, '[noise]\nPi = "I1"\n[claims]'),
        'Write its Hamiltonian: with {q, p} = 1, dW1 = "-a*q" adds a o dW1 to dp.',
        write('Pi = "I1"', 'dW1 = "I1*Pi1"'),
    ),
    (
        CANONICAL,
        write("[hamiltonian]", '[noise]\ndW1 = "vector(0, B)"\n[hamiltonian]'),
        'Write its Hamiltonian: with {q, p} = 1, dW1 = "-a*q" adds a o dW1 to dp.',
        write('"vector(0, B)"', '"-B*q1"'),
    ),
    (
        RIGID_BODY,
        write(END, f'[noise]\ndW1 = "Pi1"\n{TURN}[claims]'),
        "Remove [transformations], or declare it in a spec of its own, without [noise].",
        write(TURN, ""),
    ),
    (
        RIGID_BODY,
        write("= { shape = [3], positive", '= { rate = "v" }\nJ = { shape = [3], positive')
        + write("[parameters]\nI = ", "[inputs]\nu = ")
        + write("diag(I)*Omega", "u*Omega")
        + write("\nJ =", "\n[parameters]\nJ ="),
        "Declare it in [inputs].",
        write('rate = "v" }', 'rate = "v", default = 0 }\nv = { default = 0 }'),
    ),
    (
        MOMENTA_ONLY,
        write("[hamiltonian]", '[momenta.J]\nsection = { Omega = "Pi" }\n[hamiltonian]'),
        "Name the momentum in [observables], and claim it in claims.conserved.",
        write('[momenta.J]\nsection = { Omega = "Pi" }', '[observables]\nJ = "Pi1"')
        + write('h = "dot(Pi, Pi)/2"', 'h = "dot(Pi, Pi)/2"\n[claims]\nconserved = ["J"]'),
    ),
    # -- charts
    (
        CHART,
        write(RATES, ""),
        "Write rates = { r = ... } for every variable.",
        write('p = "B" }', f'p = "B" }}\n{RATES}'),
    ),
    (
        CHART,
        write(RATES, f'{RATES}\npairs = [["A", "B"]]'),
        "Remove pairs.",
        write('pairs = [["A", "B"]]', ""),
    ),
    # -- variables
    (
        KIRCHHOFF,
        write('P = { role = "momentum", block = "translation" }\n', ""),
        "Give both the same block.",
        write(
            'Pi = { role = "momentum", block = "rotation" }',
            'Pi = { role = "momentum", block = "rotation" }\n'
            'P = { role = "momentum", block = "translation" }',
        ),
    ),
    (
        OSCILLATOR,
        write('p = { role = "momentum", of = "q" }', 'p = { role = "coordinate" }'),
        'Write for instance p_q = { role = "momentum", of = "q" }.',
        write('p = { role = "coordinate" }', 'p_q = { role = "momentum", of = "q" }')
        + write("dot(p, p)/2 + ", ""),
    ),
    (
        OSCILLATOR,
        write("[hamiltonian]", 's = { role = "coordinate" }\n[hamiltonian]'),
        'Write for instance p_s = { role = "momentum", of = "s" }.',
        write("[hamiltonian]", 'p_s = { role = "momentum", of = "s" }\n[hamiltonian]'),
    ),
    (
        RIGID_BODY,
        write('Pi = { role = "momentum" }\n', "") + write('casimirs = ["dot(Pi, Pi)"]', ""),
        'Write for instance Pi = { role = "momentum" }.',
        write("[parameters]", 'Pi = { role = "momentum" }\n[parameters]'),
    ),
    (
        MOMENTA_ONLY,
        write('"momentum" }', '"momentum", block = ["J1", "J2"] }'),
        'Write for instance Pi_thing = { role = "momentum", block = ["J3"] }.',
        write("[hamiltonian]", 'Pi_thing = { role = "momentum", block = ["J3"] }\n[hamiltonian]'),
    ),
    (
        OSCILLATOR,
        write(', of = "q"', ""),
        'Add for instance of = "q".',
        write('"momentum" }', '"momentum", of = "q" }'),
    ),
    (
        OSCILLATOR,
        write('q = { role = "coordinate", shape = [2] }\n', "")
        + write(', of = "q"', "")
        + write(" + dot(q, q)/2", "")
        + write("[variables]", '[poisson]\nnambu = ["1"]\n[variables]'),
        'Write q = { role = "coordinate" }, and add of = "q".',
        write('"momentum" }', '"momentum", of = "q" }\nq = { role = "coordinate" }')
        + write('[poisson]\nnambu = ["1"]\n', "")
        + write("dot(p, p)", "p^2"),
    ),
    (
        RIGID_BODY,
        write('Pi = { role = "momentum"', 'Pi = { role = "momentum", shape = [3]'),
        "Remove shape.",
        write(", shape = [3] }\n\n", " }\n\n"),
    ),
    (
        LAW,
        write('x = { role = "coordinate"', 'x = { role = "coordinate", follows = true'),
        "Remove follows.",
        write(", follows = true", ""),
    ),
    *(
        (FAST, write('["Pi1", "Pi2"], default = [0, 0, 2]', wrong), said, write(wrong, right))
        for wrong, said, right in (
            ('["Pi3"], default = [0, 0, 2]', "Write 0 in the place of Pi3.", '["Pi1", "Pi2"]'),
            ('["Pi1", "Pi4"]', "Did you mean", '["Pi1", "Pi2"]'),
            ('["Pi1", "Pi2", "Pi3"]', "Write follows = true.", "true"),
        )
    ),
    (
        FAST,
        write(
            "Gamma = {",
            'x = { role = "advected", representation = "trivial", follows = ["x"] }\nGamma = {',
        ),
        "Write follows = true.",
        write('follows = ["x"]', "follows = true"),
    ),
    (
        TOP,
        write(', representation = "vector"', ""),
        'Write representation = "vector".',
        write('"advected" }', '"advected", representation = "vector" }'),
    ),
    (
        BY_BRACKETS,
        write(', representation = "shift"', "") + write(" + c*a[1]", ""),
        'Write representation = "coadjoint".',
        write('"advected" }', '"advected", representation = "coadjoint" }'),
    ),
    (
        TOP,
        write('representation = "vector"', 'representation = "shear"'),
        "Declare it under [representations.shear].",
        write("[parameters]", '[representations.shear]\nleft = "rotation"\n[parameters]'),
    ),
    (
        TOP,
        write("[parameters]", "[representations.shear]\n[parameters]"),
        'Write for instance right = "rotation".',
        write("[representations.shear]\n", '[representations.shear]\nright = "rotation"\n'),
    ),
    (
        RIGID_BODY,
        write('Pi = { role = "momentum"', 'Pi = { role = "momentum", form = "matrix"')
        + write('casimirs = ["dot(Pi, Pi)"]', ""),
        "Remove form, or choose another block, representation or shape.",
        write(', form = "matrix"', ""),
    ),
    (
        RIGID_BODY,
        write("shape = [3], positive", 'shape = [5], form = "symmetric", positive'),
        "Remove form, or choose another shape.",
        write("shape = [5]", "shape = [6]")
        + write("default = [1, 2, 3]", "default = 1")
        + write("diag(I)", "I"),
    ),
    (
        RIGID_BODY,
        write('Pi = { role = "momentum"', 'Pi = { role = "momentum", form = "antisymmetric"'),
        "Leave form out, and write hat(...) where a matrix is meant.",
        write(', form = "antisymmetric"', ""),
    ),
    (
        PARTICLE,
        write("[parameters]", 'p = { role = "momentum", of = "x" }\n[parameters]'),
        "Remove it; the velocities that no constraint gives are the state.",
        write('p = { role = "momentum", of = "x" }\n', ""),
    ),
    # -- algebras
    (
        BY_BRACKETS,
        write('{ "[e1, e2]" = "e3" }', '{ "[e1, e2]" = "e3", "[e2, e1]" = "-e3" }'),
        "Remove it.",
        write(', "[e2, e1]" = "-e3"', ""),
    ),
    (
        BY_MATRICES,
        write(
            "[algebra.matrices]", '[algebra]\nbasis = ["J1", "J2", "J3", "E"]\n[algebra.matrices]'
        ),
        "Write E = [[...], [...]] among the matrices.",
        write("[variables]", "E = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n[variables]"),
    ),
    (
        BY_BRACKETS,
        write("[variables]", "[parameters]\ne1 = { default = 1 }\n[variables]")
        + write('= "e3" }', '= "e3 + 0*e1" }'),
        "Rename the parameter.",
        write("e1 = { default", "k = { default"),
    ),
    (
        ISERLES,
        write("[parameters.N]", "[parameters.Y]") + write("X*N*Y - Y*N*X", "X*Y - Y*X"),
        "Rename the parameter.",
        write("[parameters.Y]", "[parameters.N]") + write("X*Y - Y*X", "X*N*Y - Y*N*X"),
    ),
    (
        BY_BRACKETS,
        write('= "e3" }', '= "sin(1)*e3" }'),
        'Name a parameter here, with the default "sin(1)"',
        write("sin(1)*e3", "k*e3")
        + write("[variables]", '[parameters]\nk = { default = "sin(1)" }\n[variables]'),
    ),
    (
        BY_BRACKETS,
        write('= "e3" }', '= "cos(2*pi/101)*e3" }'),
        "Name a parameter for one of them",
        write("cos(2*pi/101)*e3", "k*e3")
        + write("[variables]", '[parameters]\nk = { default = "cos(2*pi/101)" }\n[variables]'),
    ),
    (
        BY_BRACKETS,
        write("[variables]", '[time]\nname = "t"\n[variables]') + write('= "e3" }', '= "t*e3" }'),
        "Put a parameter in its place.",
        write('[time]\nname = "t"\n', "[parameters]\nt_0 = { default = 1 }\n")
        + write("t*e3", "t_0*e3"),
    ),
    (
        RIGID_BODY,
        write('name = "so(3)"', 'extension = { algebra = "so(3)", center = "J1", cocycle = {} }')
        + write(BOTH, 'routes = ["lie-poisson"]')
        + write(ENERGY, '[hamiltonian]\nh = "dot(Pi, Pi)"')
        + write('Omega = { role = "velocity" }', ""),
        "Choose another name here.",
        write('center = "J1"', 'center = "Z"'),
    ),
    # -- names
    (
        RIGID_BODY,
        write("I =", "lambda =") + write("diag(I)", "diag(lambda)"),
        "Call it 'lam'.",
        write("lambda", "lam"),
    ),
    (
        RIGID_BODY,
        write("[parameters]", "[parameters]\nPi1 = {}"),
        "Rename one of them",
        write("Pi1 = {}", "P = {}"),
    ),
    (
        RIGID_BODY,
        write("[parameters]", "[parameters]\ncasimir = { shape = [2] }"),
        "Choose another name.",
        write("casimir =", "K ="),
    ),
    # -- definitions and formulas
    (
        RIGID_BODY,
        before_claims('[definitions]\n"f(I)" = "2*I"'),
        "A variable or parameter need not be an argument.",
        write('"f(I)"', "f"),
    ),
    (
        RIGID_BODY,
        write("dot(Omega, diag(I)*Omega)/2", "Omega"),
        "Write dot(a, a) for the square of a vector.",
        write('l = "Omega"', 'l = "dot(Omega, Omega)"'),
    ),
    (
        SLEIGH,
        write('"u == 0"', '"u = 0"'),
        "Write for instance 'Y == cross(Omega, s)'.",
        write('"u = 0"', '"u == 0"'),
    ),
    (
        PARTICLE,
        write("[constraints]", '[definitions]\npull = "blade_reaction"\n[constraints]')
        + write('"w == y*u"', '"w == pull*u"'),
        "Write pull without reactions, or use it in [forces] alone.",
        write('pull = "blade_reaction"', 'pull = "y"'),
    ),
    # -- further tables
    (
        LAW,
        write('y = { force = "k*(x - y)" }\n', ""),
        'Write for instance y = { force = "-y" }.',
        write("[newton]\n", '[newton]\ny = { force = "-y" }\n'),
    ),
    (
        shipped("manakov_so4").path.read_text(encoding="utf-8"),
        write('"M + lambda*diag(a)^2"', '"a"'),
        "Write hat(a) for the matrix of a vector a, diag(a) for a diagonal one.",
        write('"a"', '"diag(a)"'),
    ),
    (
        CANONICAL,
        write("[parameters]", 'k = { role = "coordinate" }\n[parameters]'),
        "Declare a constant as a parameter, or let a force or [metriplectic] move it.",
        write('k = { role = "coordinate" }\n[parameters]', "[parameters]\nk = {}"),
    ),
    (
        PARTICLES,
        write('"{L, q}"  ', '"{L, S}"  '),
        "Take a row or a component of it, as A[1] or A[1, 2].",
        write('"{L, S}"  ', '"{L, S[1, 2]}"  ') + write('"-hat(q)"', '"vector(0, 0, 0)"'),
    ),
    (
        PARTICLES,
        write('matrix     = "A"', 'matrix     = "A"\nform = "matrix"'),
        "Remove form, or choose another algebra.",
        write('\nform = "matrix"', ""),
    ),
    (
        LAW,
        write("[claims]", '[claims]\ncasimirs = ["x"]'),
        "Remove casimirs, or declare [lagrangian] and a route that takes it.",
        write('casimirs = ["x"]', ""),
    ),
    (
        BALL,
        write("[rolling]", '[reconstruction]\nq = { attitude = "quaternion" }\n[rolling]'),
        "The attitude and the point of contact are followed without being declared: remove it.",
        write('q = { attitude = "quaternion" }\n', ""),
    ),
    (
        BALL,
        write("[rolling]", '[observables]\ny = "Omega1"\n[rolling]'),
        "Call it 'y_0'.",
        write('y = "Omega1"', 'y_0 = "Omega1"'),
    ),
    (
        SLEIGH,
        write("[constraints]", '[reconstruction]\nq = { attitude = "quaternion" }\n[constraints]'),
        'Without one, declare an angle: theta = "omega".',
        write('q = { attitude = "quaternion" }', 'theta = "omega"'),
    ),
    (
        RIGID_BODY,
        write(END, '[reconstruction]\nz = "Omega"\n[claims]'),
        "Give its shape, as { rate = ..., shape = [3] }.",
        write('z = "Omega"', 'z = { rate = "Omega", shape = [3] }'),
    ),
    (
        MOMENTA_ONLY,
        write("[hamiltonian]", '[reconstruction]\nq = { attitude = "quaternion" }\n[hamiltonian]'),
        'Write Omega = { role = "velocity", block = ["J1", "J2", "J3"] } in [variables].',
        write(
            "[reconstruction]",
            'Omega = { role = "velocity", block = ["J1", "J2", "J3"] }\n[reconstruction]',
        ),
    ),
    # -- attitudes, and coordinates next to an algebra
    (
        RIGID_BODY.replace("so(3)", "sl(2,R)"),
        write("Pi = {", 'g = { role = "attitude" }\nPi = {'),
        'For another group write role = "advected" and representation = "attitude".',
        write('role = "attitude"', 'role = "advected", representation = "attitude"'),
    ),
    (
        RIGID_BODY,
        write("Pi = {", 'q = { role = "quaternion", default = [1, 1, 0, 0] }\nPi = {'),
        "Leave it out to begin at the identity.",
        write(", default = [1, 1, 0, 0]", ""),
    ),
    (
        RIGID_BODY.replace('Pi = { role = "momentum" }\n', "")
        .replace("dot(Pi, Pi)", "Omega1")
        .replace(BOTH, ALONE),
        write("[parameters]", WITH_ROTOR),
        'With velocities as the state it may: write routes = ["nonholonomic"] at the top.',
        write(ALONE, 'routes = ["nonholonomic"]'),
    ),
    (
        PRODUCT,
        write('"euler-poincare", "lie-poisson"', '"hamilton-pontryagin"'),
        "With momenta it may on the routes euler-poincare and lie-poisson.",
        write('"hamilton-pontryagin"', '"euler-poincare", "lie-poisson"'),
    ),
    # -- form of the file
    (
        RIGID_BODY,
        write(f"{BOTH}\n", ""),
        'Write routes = ["euler-poincare", "lie-poisson"] at the top.',
        write('title = "Free rigid body"', f'title = "Free rigid body"\n{BOTH}'),
    ),
    (
        OSCILLATOR,
        write('routes = ["canonical"]\n', ""),
        'Write routes = ["canonical"] at the top.',
        write('title = "x"', 'title = "x"\nroutes = ["canonical"]'),
    ),
    (
        NAMBU,
        write('routes = ["nambu", "poisson"]\n', ""),
        'Write routes = ["poisson"] at the top.',
        write('title = "x"', 'title = "x"\nroutes = ["poisson"]'),
    ),
    (
        RIGID_BODY,
        write("[parameters]", "[parameter]"),
        "Did you mean 'parameters'?",
        write("[parameter]", "[parameters]"),
    ),
    (
        RIGID_BODY,
        write("positive =", "positve ="),
        "Did you mean 'positive'?",
        write("positve =", "positive ="),
    ),
    (
        RIGID_BODY,
        write('"so(3)"', "so(3)"),
        "Text stands in quotes, a table in one line in { }.",
        write("so(3)", '"so(3)"'),
    ),
]


#: Of formulas: what is wrong, what the message says, and the formula that it leads to.
FORMULAS = [
    ("e = m*c", "Write only the right-hand side; of what is 0 somewhere", "m*c"),
    ("transpose(A)'*a", "a transposed matrix is transpose(A).", "transpose(A)*a"),
    ("|a|", "The length of a vector is norm(a).", "norm(a)"),
    ("A@a", "Write * for products of matrices.", "A*a"),
    ("{m + c}*m", "Group with round parentheses.", "(m + c)*m"),
    ("m % c", "Write a fraction as a/b.", "m/c"),
    ("c!", "Write products out.", "c*(c - 1)"),
    ("a \u00d7 b", "The cross product is cross(a, b).", "cross(a, b)"),
    ("a \u00b7 b", "The dot product is dot(a, b), a product *.", "dot(a, b)"),
    ("m \u2212 c", "Write the minus sign of the keyboard, -.", "m - c"),
    ("sum(a, b)", "Sums over members need [index]; events name an observable.", "dot(a, b)"),
    ("m^2^c", "Write (a^b)^c, or multiply the exponents out.", "(m^2)^2"),
    ("m c", "Write m*c.", "m*c"),
    ("2(m + c)", "Write * for a product.", "2*(m + c)"),
    ("2[1]*m", "Numbers have no subscripts.", "2*m"),
    ("(A*a)[0]", "Components are counted from 1.", "(A*a)[1]"),
    ("m(c + 1)", "m*(...) for a product.", "m*(c + 1)"),
    ("1e-3*m", "Write 0.001.", "0.001*m"),
    ("\u03a9 + m", "Write Omega.", "Omega"),
    ("m\u00b2", "Write ^2.", "m^2"),
    ("a[0]", "Components are counted from 1.", "a[1]"),
    ("a^2", "The square of a vector is dot(a, a).", "dot(a, a)"),
    ("a/A", "Write inverse(A)*x.", "inverse(A)*a"),
    ("a*b", "Write dot(a, b) for the scalar product", "dot(a, b)"),
    ("a*A", "Write transpose(A)*a for a row vector times a matrix.", "transpose(A)*a"),
    ("dot(A, A)", "The product of matrices is trace(transpose(A)*B).", "trace(transpose(A)*A)"),
]
SYMBOLS = (
    "[parameters]",
    "[parameters]\nm = { positive = true }\nc = {}\na = { shape = [3] }\nb = { shape = [3] }\n"
    "A = { shape = [3, 3] }",
)


@pytest.mark.parametrize(("text", "wrong", "said", "done"), ADVICE)
def test_advice_that_is_followed_leads_to_a_spec(text, wrong, said, done):
    """The message says it, and after it is done the spec loads."""
    for old, new in wrong:
        assert old in text, old
        text = text.replace(old, new)
    with pytest.raises(CoadjointError) as caught:
        spec(text)
    assert said in str(caught.value)
    assert spec(text, *done)


@pytest.mark.parametrize(("formula", "said", "better"), FORMULAS)
def test_advice_about_a_formula_leads_to_one(formula, said, better):
    """What is written in its place is read."""
    observed = (END, f'[observables]\nfound = "{formula}"\n[claims]')
    with pytest.raises(SpecError) as caught:
        spec(RIGID_BODY, SYMBOLS, observed)
    assert said in str(caught.value)
    assert spec(RIGID_BODY, SYMBOLS, (END, f'[observables]\nfound = "{better}"\n[claims]'))


#: Advice that is followed in other tests, or that large specs alone are given.
ELSEWHERE = {
    "Rename the file to ": "test_names.py",
    "Give the file that it points to: ": "test_reader.py",
    "Write one with: coadjoint new NAME.": "tests/cli/test_new.py",
    "Replace some of the parameters by numbers.": "more than PARAMETRIC_TERMS terms",
    "Declare the algebra by its brackets.": "more than MATRIX_ENTRIES numbers",
    "Larger systems are solved inside the kernels": "a route that solves for velocities",
    "Leave form out, or declare the algebra by these matrices.": "needs 6 dimensions",
    "Remove form, or declare the algebra by such matrices.": "test_lax.py",
    "Declare it in a spec of the whole system.": "another spec",
    "Write diag(m) for a mass of each row.": "test_newton.py",
    "Write vector(": "tests/derive/test_external.py",
    "Remove the momentum ": "below",
    "Declare an angle, as theta = ": "test_followed.py",
    "Leave sizes out, or declare [index].": "test_windows.py",
    'Write [space] and below it s = { length = "L" }.': "test_space.py",
    "Write derivatives = ": "test_space.py",
    "Remove the others.": "test_space.py",
    "Write x and y, so that w_xxy is a derivative.": "test_space.py",
    "Remove central.": "test_space.py",
    'Write ["lie-poisson"].': "test_truncated.py",
    "Remove values, or write [space] without ends.": "test_space.py",
    ", or write [diffeomorphisms].": "test_space.py",
    "Fourier derivatives around both circles": "what is expected there",
    "Remove where.": "test_space.py",
    "Write order = 4.": "test_space.py",
    'Write ends = "periodic".': "test_space.py",
    "the ends of a strand": "what is expected there",
    "Remove them.": "test_space.py",
    " = { positive = true, default = 1 }": "test_space.py",
    "Remove [profiles].": "test_space.py",
    "Write vector(a, b, c) for the components.": "test_space.py",
    "] and below it ": "test_space.py",
    "The first is in line ": "names the place",
    "Blocks of ": "names what there is",
    "Declared are ": "names what there is",
    "is not part of the language": "a problem and no advice",
    "there is no such ": "a problem and no advice",
    " do not fit": "a problem and no advice",
}


#: Which argument of a call is the hint, where it is not named.
HINTS = dict.fromkeys(("fault", "at_key", "unknown", "fault_at", "_fault", "misfit"), 4)
HINTS |= {"ExpressionError": 5, "file_fault": 3}


def find_advice(folder):
    """The constant pieces of every hint in a folder of modules, by place."""
    found = {}
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [
                getattr(n, "id", "") for t in getattr(node, "targets", []) for n in ast.walk(t)
            ]
            is_hint = getattr(node, "arg", "") == "hint" and isinstance(node, ast.keyword)
            value = node.value if is_hint or "hint" in names else None
            called = getattr(node, "func", None)
            place = HINTS.get(getattr(called, "attr", "") or getattr(called, "id", ""))
            if place is not None and node.args[place:]:
                value = node.args[place]
            if value is not None:
                found[f"{path.name}:{value.lineno}"] = [
                    piece.value
                    for piece in ast.walk(value)
                    if isinstance(piece, ast.Constant)
                    and isinstance(piece.value, str)
                    and len(piece.value.split()) > 1
                ]
    return found


def test_no_advice_is_left_untried():
    """Every hint of the package is among those that are followed, here or elsewhere."""
    said = [entry[2] for entry in ADVICE] + [entry[1] for entry in FORMULAS] + list(ELSEWHERE)
    pieces = find_advice(SPEC)
    assert len(pieces) > 50
    untried = {
        place: texts
        for place, texts in pieces.items()
        if texts and not any(a in b or b in a for a in texts for b in said)
    }
    assert untried == {}


def test_a_new_hint_would_be_seen(tmp_path):
    """The check above can fail."""
    (tmp_path / "module.py").write_text('fault(hint="Turn it off and on again.")')
    assert find_advice(tmp_path) == {"module.py:1": ["Turn it off and on again."]}
    (tmp_path / "module.py").write_text('source.fault(key, a, b, c, "Turn it off and on again.")')
    assert find_advice(tmp_path) == {"module.py:1": ["Turn it off and on again."]}


#: Bad input of what drives and damps: refused when the spec is read, with place and fix.
BAD = [
    ("[inputs]\nu = { default = 0 }", "inputs.u", "u", "remove it from [inputs]"),
    ('[forces]\nwind = "Omega"', "forces.wind", "wind", "one of Omega"),
    ('[forces]\nOmega = "Omega1"', "forces.Omega", "a scalar", "a 3-vector, as 'Omega' is"),
    ('[double_bracket]\nG = "Pi"', "double_bracket.G", "a 3-vector", "a 3 x 3 matrix"),
    ('[friction]\nR = "1"', "friction", "friction", "dissipation, double_bracket"),
    ('[noise]\ndW1 = "Pi"', "noise.dW1", "Pi", "need not keep the bracket"),
    ('[noise]\ndW1 = "Omega1"', "noise.dW1", "Omega1", "a Hamiltonian of noise"),
    ('[noise]\ndPi2 = "Pi2"', "noise.dPi2", "dPi2", "the name of a Wiener process"),
    ('[noise]\nPi2 = "1"', "noise.Pi2", "Pi2", "the name of a Wiener process"),
    ('[noise]\nI = "Pi1"', "noise.I", "I", "has that name too"),
    ('[dissipation]\nr = "1"', "dissipation.r", "r", "one of R. Did you mean 'R'?"),
]


@pytest.mark.parametrize(("lines", "key", "found", "said"), BAD)
def test_bad_input_is_refused_when_it_is_read(lines, key, found, said):
    """Where, what was found, and what is expected; the exit status is 2."""
    with pytest.raises(SpecError) as caught:
        spec(RIGID_BODY, (END, f"{lines}\n{END}"))
    assert (caught.value.key, caught.value.found) == (key, found)
    assert caught.value.exit_status == 2
    assert said in str(caught.value)


def test_bad_input_ends_the_command_before_work_starts(tmp_path):
    """The message is on standard error, and nothing is derived."""
    path = tmp_path / "sample.toml"
    path.write_text(RIGID_BODY.replace(END, f"{BAD[0][0]}\n{END}"))
    result = CliRunner().invoke(main, ["prove", str(path)])
    assert result.exit_code == 2
    assert "inputs.u" in result.stderr
    assert result.stdout == ""
