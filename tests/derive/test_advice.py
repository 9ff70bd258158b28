"""Advice of derivations: what a message says to do is done, and every route is followed."""

import ast
import re
from pathlib import Path

import pytest

import coadjoint.derive
from coadjoint.derive import derive
from coadjoint.errors import DerivationError, LimitError
from tests.constrained import PARTICLE, SLEIGH
from tests.derive.test_configuration import FREE, LAW, WITHOUT_MOMENTA
from tests.derive.test_lax_alone import TODA, VOLTERRA
from tests.prove.test_reductions import IN_STEP
from tests.spec.test_consistency import MOMENTA_ONLY
from tests.specs import RIGID_BODY, shipped, spec, unitless

FOLDER = Path(coadjoint.derive.__file__).parent
BOTH = 'routes = ["euler-poincare", "lie-poisson"]'
KINETIC = "dot(Omega, diag(I)*Omega)/2"
CANONICAL = 'routes = ["euler-lagrange", "canonical"]'
SHIFTED = (CANONICAL, 'routes = ["canonical"]')
ROW = " + ".join(f"v{n}*v{n + 1}/4" for n in range(1, 13)) + " + v1^4/4"
CHAIN = "v1*v2 + v2*v3 + v3*v4"
PLANES = [('"so(3)"', '"so(4)"'), ('"lie-poisson"]', '"lie-poisson", "manakov"]')]
ADVECTED = ("[hamiltonian]", 'S = { role = "advected", representation = "ROLE" }\n[hamiltonian]')
#: Four velocities that the kinetic energy couples, along a frame.
COUPLED = f"""
title = "A chain"
routes = ["nonholonomic", "hamel"]
[variables]
q = {{ role = "coordinate", shape = [4] }}
v = {{ role = "velocity", of = "q" }}
[parameters]
k = {{ positive = true, default = 1 }}
[lagrangian]
l = "2*dot(v, v) + {CHAIN}"
[claims]
"""
TURN = '\n[symmetries.J]\nalgebra = "so(2)"\nvector = "s"\n'
BY_BRACKETS = (
    'basis = ["A", "B", "C"]\nbrackets = { "[A, B]" = "C", "[B, C]" = "A", "[C, A]" = "B" }'
)
BY_MATRICES = """[algebra.matrices]
A = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
B = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
C = [[0, -1, 0], [1, 0, 0], [0, 0, 0]]"""
COMPLEX = [('"lie-poisson"]', '"lie-poisson", "complexification"]')]
#: Manakov's pair with a quadratic potential, the declared pair left out.
POTENTIAL = unitless(shipped("quadratic_potential_so3").path.read_text(encoding="utf-8"))
POTENTIAL = POTENTIAL[: POTENTIAL.index("[lax]")].replace(
    '["euler-poincare", "matrix-euler-poincare", "lie-poisson", "lax", "manakov"]',
    '["euler-poincare", "manakov"]',
)
MATRIX = """
title = "A symmetric matrix"
routes = ["canonical"]
[variables]
S = { role = "coordinate", shape = [3], form = "symmetric" }
P = { role = "momentum", of = "S" }
[hamiltonian]
h = "trace(P*P)/2"
[symmetries.J]
algebra = "so(2)"
vector = "s"
generators = { S = "s*rows(vector(0, 1), vector(2, 0))" }
"""


def change(old, new):
    """One change."""
    return [(old, new)]


CHAIN_OF_SPINS = shipped("spin_chain").path.read_text(encoding="utf-8")
STRAND = "dot(Omega, diag(I)*Omega)/2 - dot(Xi, diag(K)*Xi)/2"
#: A bead that touches a wall.
BEAD = """
title = "A bead"
routes = ["canonical"]
[variables]
q = { role = "coordinate", default = -1 }
p = { role = "momentum", of = "q", default = 1 }
[hamiltonian]
h = "p^2/2 + max(q, 0)^2*sqrt(max(q, 0))"
"""
#: Shortest curves of Heisenberg's group, whose third velocity costs nothing.
HEISENBERG = """
title = "Heisenberg's group"
routes = ["euler-poincare"]
[algebra]
name = "h(1)"
[variables]
xi = { role = "velocity" }
mu = { role = "momentum" }
[lagrangian]
l = "(xi1^2 + xi2^2)/2"
"""
#: A spec, what is wrong with it, what the message says, and what it says to do.
ADVICE = [
    (
        HEISENBERG,
        [],
        "write [constraints] with xi3 == 0 and variational = true, and take the route lie-poisson.",
        [
            ("euler-poincare", "lie-poisson"),
            ("[lagrangian]", '[constraints]\nflat = "xi3 == 0"\nvariational = true\n[lagrangian]'),
        ],
    ),
    (
        BEAD,
        [],
        "Write max(x, 0)^(5/2) in the place of max(x, 0)^2*sqrt(max(x, 0)).",
        [("max(q, 0)^2*sqrt(max(q, 0))", "max(q, 0)^(5/2)")],
    ),
    # -- fields
    *(
        (
            CHAIN_OF_SPINS,
            change(STRAND, f"{STRAND} {more}"),
            "Give [hamiltonian] and the route lie-poisson instead.",
            [
                ('["euler-poincare", "lie-poisson", "hamilton-pontryagin"]', '["lie-poisson"]'),
                (f'[lagrangian]\nl = "{STRAND} {more}"', '[hamiltonian]\nh = "dot(Pi, Pi)/2"'),
            ],
        )
        for more in ("+ Omega1^4", "- Xi1_s^2")
    ),
    # -- kinetic energies
    (
        FREE,
        [WITHOUT_MOMENTA, ("dot(v, v)/2", "(v1^2 + v2^2 + v3^2)/2")],
        "Add the missing kinetic term of v4.",
        change("(v1^2 + v2^2 + v3^2)/2", "(v1^2 + v2^2 + v3^2)/2 + v4^2"),
    ),
    (
        RIGID_BODY,
        change(KINETIC, "Omega1^2/2"),
        "Add the missing kinetic term of Omega2.",
        change("Omega1^2/2", "(Omega1^2 + Omega2^2 + Omega3^2)/2"),
    ),
    (
        RIGID_BODY,
        change(KINETIC, "dot(Omega, Omega)^2"),
        "Give a [hamiltonian] and the route lie-poisson instead, or ",
        [
            (BOTH, 'routes = ["lie-poisson"]'),
            ('[lagrangian]\nl = "dot(Omega, Omega)^2"', '[hamiltonian]\nh = "dot(Pi, Pi)/2"'),
        ],
    ),
    (
        RIGID_BODY,
        change(KINETIC, "dot(Omega, Omega)^2"),
        "or remove Pi and take the route nonholonomic, where velocities are the state.",
        [
            (BOTH, 'routes = ["nonholonomic"]'),
            ('Pi = { role = "momentum" }\n', ""),
            ('\n[claims]\ncasimirs = ["dot(Pi, Pi)"]', ""),
        ],
    ),
    (
        FREE,
        [SHIFTED, ("dot(v, v)/2", CHAIN)],
        "Give a [hamiltonian] and the route canonical instead.",
        change(f'[lagrangian]\nl = "{CHAIN} - dot(q, q)/2"', '[hamiltonian]\nh = "dot(p, p)/2"'),
    ),
    (
        FREE,
        [SHIFTED, ("[4]", "[13]"), ("dot(v, v)/2", f"dot(v, v)/2 + {ROW}")],
        "Choose axes that decouple them, or give a [hamiltonian] and the route canonical.",
        change(f" + {ROW}", ""),
    ),
    (
        PARTICLE,
        change("u^2 + v^2 + w^2", "v^2"),
        "Add the missing kinetic term, or constrain the velocity.",
        change("m*(v^2)", "m*(v^2 + u^2)"),
    ),
    (
        FREE.replace("[lagrangian]\nl", "[hamiltonian]\nh"),
        [WITHOUT_MOMENTA, SHIFTED],
        'Declare momenta with role = "momentum", or the bracket, as [poisson] canonical = ',
        change("[variables]", '[poisson]\ncanonical = [["q", "v"]]\n[variables]'),
    ),
    # -- constraints
    (
        SLEIGH,
        change('blade = "u == 0"', 'blade = "u == 0"\nagain = "u + 0*v == 0"'),
        "Remove again.",
        change('\nagain = "u + 0*v == 0"', ""),
    ),
    (
        PARTICLE,
        change('"w == y*u"', '"w == y*u"\nalways = "0*w == 0"'),
        "Remove it.",
        change('\nalways = "0*w == 0"', ""),
    ),
    (
        PARTICLE,
        change('"w == y*u"', '"z == x*y"'),
        "Write its time derivative.",
        change('"z == x*y"', '"w == u*y + x*v"'),
    ),
    # -- Lax pairs
    (TODA, change("a2, b3)", "a2, b2)"), "Put it into L.", change("a2, b2)", "a2, b3)")),
    (
        TODA,
        change("vector(b1, a1", "vector(b1^2, a1"),
        "Choose the entries of L as variables.",
        change("vector(b1^2, a1", "vector(b1, a1"),
    ),
    (
        VOLTERRA,
        [("a1/lambda", "a1/exp(lambda)"), ("vector(lambda, a3", "vector(exp(lambda), a3")],
        "Choose another parameter than lambda.",
        [("a1/exp(lambda)", "a1/lambda"), ("vector(exp(lambda), a3", "vector(lambda, a3")],
    ),
    (
        MOMENTA_ONLY,
        [('"so(3)"', '"sl(2,R)"'), PLANES[1]],
        'Write name = "so(4)", or declare a pair under [lax] for the route lax',
        change('"sl(2,R)"', '"so(4)"'),
    ),
    (
        MOMENTA_ONLY,
        [*PLANES, ("dot(Pi, Pi)/2", "dot(Pi, Pi)/2 + Pi[1]*Pi[2]/4")],
        "Choose axes that decouple the planes, or declare a pair under [lax]",
        change(" + Pi[1]*Pi[2]/4", ""),
    ),
    (
        POTENTIAL,
        [
            ('representation = "symmetric", form = "symmetric"', 'representation = "vector"'),
            (" - trace(S*diag(a))/2", ""),
        ],
        'Write representation = "symmetric", or declare a pair under [lax]',
        [
            ('representation = "vector"', 'representation = "symmetric", form = "symmetric"'),
            ('*diag(a)*Omega)/2"', '*diag(a)*Omega)/2 - trace(S*diag(a))/2"'),
        ],
    ),
    (
        POTENTIAL,
        change("trace(S*diag(a))/2", "trace(S*diag(a))/2 - S[1, 2]"),
        "Choose axes in which it is diagonal, or declare a pair under [lax]",
        change(" - S[1, 2]", ""),
    ),
    # -- algebras and sides
    (
        RIGID_BODY,
        [('"so(3)"', '"so(3)"\ninvariance = "right"'), ('"lie-poisson"]', '"newton-euler"]')],
        'Write invariance = "left"',
        change('"right"', '"left"'),
    ),
    (
        RIGID_BODY,
        [('name = "so(3)"', BY_BRACKETS), ('"lie-poisson"]', '"matrix-euler-poincare"]')],
        "Declare it by matrices",
        change(BY_BRACKETS, BY_MATRICES),
    ),
    (
        MOMENTA_ONLY,
        COMPLEX,
        'Write [algebra] complexification = "so(3)"',
        change('name = "so(3)"', 'complexification = "so(3)"'),
    ),
    (
        MOMENTA_ONLY,
        [
            *COMPLEX,
            ('name = "so(3)"', 'complexification = "so(3)"'),
            (ADVECTED[0], ADVECTED[1].replace("ROLE", "adjoint")),
        ],
        "Put the advected quantity into the algebra: a semidirect product has a complexification",
        [
            ('S = { role = "advected", representation = "adjoint" }\n', ""),
            ('complexification = "so(3)"', 'complexification = "se(3)"'),
        ],
    ),
    # -- restricted motions, symmetries
    (
        IN_STEP,
        change("k*(q1 - q2)^4", "k/(q1 - q2)"),
        "Correct [reduction], or the Hamiltonian.",
        change("k/(q1 - q2)", "k*(q1 - q2)^2"),
    ),
    (
        MATRIX,
        [],
        "the value is not symmetric. Correct the formula.",
        change("vector(2, 0)", "vector(1, 0)"),
    ),
    (
        LAW,
        change("[newton]", f'{TURN}generators = {{ x = "s*x" }}\nmap = "s"\ntime = "s"\n[newton]'),
        "Leave time out.",
        change('\ntime = "s"', ""),
    ),
    (
        COUPLED,
        change("[claims]", '[double_bracket]\nG = "k"\n[claims]'),
        "Write dissipation of velocities in [dissipation].",
        change('[double_bracket]\nG = "k"', '[dissipation]\nR = "k*dot(v, v)/2"'),
    ),
]


def follow(text, changes):
    """Every route of a spec."""
    declared = spec(text, *changes)
    return [derive(declared, route).exact.rates for route in declared.routes]


@pytest.mark.parametrize(("text", "wrong", "said", "done"), ADVICE)
def test_advice_that_is_followed_leads_to_equations(text, wrong, said, done):
    """The message says it, and after it is done every route is derived."""
    for old, new in wrong:
        assert old in text, old
        text = text.replace(old, new)
    with pytest.raises((DerivationError, LimitError)) as caught:
        follow(text, [])
    assert said in str(caught.value)
    assert all(follow(text, done))


def test_a_route_that_is_not_declared_is_added_as_advised():
    """It can be derived once the spec lists it."""
    with pytest.raises(DerivationError, match="Add it to routes to have it proved too"):
        derive(spec(), "poincare")
    assert derive(spec(RIGID_BODY, ('"lie-poisson"]', '"poincare"]')), "poincare").rates


#: Advice that is followed in other tests.
ELSEWHERE = {
    "Add it there, with its source": "test_theorems.py",
    "Write it as ": "test_truncated.py",
    "Correct the Lagrangian": "test_first_order.py: what contradicts itself has no other way out",
    "Solve it by hand, and write what it gives in the Lagrangian": "test_first_order.py",
    "Add the term that determines it, or leave that combination out": "test_first_order.py",
    "Write follows = ": "test_first_order.py, test_bound_momenta.py",
    "Remove follows of ": "test_first_order.py, test_bound_momenta.py",
    "Or take the route first-order, on which": "test_bound_momenta.py",
    "Give the energy of the velocities in simpler terms": "test_bound_momenta.py",
    "Write one that is.": "test_bound_momenta.py",
    "Add the kinetic energy of these velocities": "test_bound_momenta.py",
    "Choose other coordinates": "where the brackets of constraints have no inverse",
    "Declare the momentum of": "test_first_order.py",
    "Take euler-lagrange if it is regular": "test_first_order.py",
    "Let time and inputs act in the potential": "test_first_order.py",
    "take the route first-order, without the momenta": "test_first_order.py",
    "Choose coordinates that decouple them": "test_first_order.py",
    "Write the Lagrangian in simpler functions": "where no point shows that a form is regular",
    "Write abs, sign, min and max of positions and parameters alone": "test_words.py",
    "Add the kinetic energy of every velocity that the constraints allow": "test_variational.py",
    "Divide the constraint, as in vz == x*vy": "test_variational.py",
    "Write it in simpler functions": "where no normal form decides whether something is zero",
    "Write the kinetic energy in simpler functions": "the same",
    "Add it to routes to have it proved too.": "above",
    "Write constraints as Y == ..., which gives velocities.": "test_nonholonomic.py",
    "Write what presses as a scalar constraint of its own": "test_friction.py",
    "Add the square of a slip speed to": "test_friction.py",
    "Remove ": "above, and test_friction.py",
    "Declare that input and name it": "test_driving.py",
    "Declare the functions: [poisson] nambu = [...].": "test_nambu.py",
    "Declare the momentum map as map.": "test_bound_symmetries.py",
    "Correct the surface or the body.": "test_contact.py",
    "Write it as half the sum of both.": "test_indexed.py",
    "Write the energy as sums over members.": "where the reader let other members into the energy",
}
VERBS = "Write|Add|Declare|Give|Choose|Put|Correct|Leave|Remove"
START = re.compile(rf"(?:^|[.;] )((?:{VERBS})\b[^\n]*)")


def find_advice(folder):
    """The advice in the texts of modules: sentences that begin with what to do, by place."""
    found = {}
    for path in sorted(folder.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        prose = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}
        for node in ast.walk(tree):
            text = node.value if isinstance(node, ast.Constant) and id(node) not in prose else None
            match = START.search(text) if isinstance(text, str) else None
            if match:
                found[f"{path.name}:{node.lineno}"] = match[1]
    return found


def test_no_advice_is_left_untried():
    """Every advice of the package is among those that are followed, here or elsewhere."""
    said = [entry[2] for entry in ADVICE] + list(ELSEWHERE)
    pieces = find_advice(FOLDER)
    assert len(pieces) > 25
    assert {
        place: text
        for place, text in pieces.items()
        if not any(text.strip(". ") in each or each in text for each in said)
    } == {}


def test_a_new_advice_would_be_seen(tmp_path):
    """The check above can fail; documentation is no advice."""
    (tmp_path / "module.py").write_text('"""Write it."""\nx = f"it is {0}. Declare it twice."\n')
    assert find_advice(tmp_path) == {"module.py:2": "Declare it twice."}
