"""Brackets, Casimirs, symmetries and Lax pairs on a section that a motion keeps."""

from dataclasses import replace

import pytest
import sympy

from coadjoint.derive import derive, reductions
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.prove.test_reductions import IN_STEP, UNFORCED
from tests.specs import prove_claims, spec, verdicts_of

#: Two equal bodies that turn alike: the brackets of what vanishes there have rank 2 of 3.
BODIES = """
title = "Two bodies in step"
routes = ["lie-poisson"]
[algebra]
direct_sum = ["so(3)", "so(3)"]
[variables]
A = { role = "momentum", block = "rotation_1" }
B = { role = "momentum", block = "rotation_2" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[hamiltonian]
h = "dot(A, inverse(diag(I))*A)/2 + dot(B, inverse(diag(I))*B)/2"
[reduction]
where = ["A - B"]
section = { B = "A" }
[claims]
casimirs = ["dot(A, A)", "dot(B, B)"]
"""
#: A body in a fluid that does not move: where P = 0, a Poisson submanifold.
AT_REST = """
title = "A body that turns and does not move"
routes = ["lie-poisson"]
[algebra]
name = "se(3)"
[variables]
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
m = { shape = [3], positive = true, default = [1, 2, 3] }
[hamiltonian]
h = "dot(Pi, inverse(diag(I))*Pi)/2 + dot(P, inverse(diag(m))*P)/2"
[reduction]
where = ["P"]
section = { P = "0*Pi" }
[claims]
casimirs = ["dot(P, P)", "dot(Pi, P)"]
brackets = { "{Pi, Pi}" = "hat(Pi)" }
"""
#: A hypersurface, which has no bracket of its own.
HYPERSURFACE = """
title = "A particle that does not move in one direction"
routes = ["canonical"]
[poisson]
canonical = [["q1", "p1"], ["q2", "p2"]]
[variables]
q1 = { role = "coordinate" }
q2 = { role = "coordinate" }
p1 = { role = "coordinate" }
p2 = { role = "coordinate" }
[hamiltonian]
h = "(p1^2 + p2^2 + q1^2)/2"
[reduction]
where = ["p2"]
section = { p2 = "0*p1" }
"""
#: The pair of one oscillator, in variables of both.
MATRICES = 'L = "rows(vector(p1, q1), vector(q2, -p2))"\nM = "rows(vector(0, 1), vector(-1, 0))/2"'
PAIR = f"[lax]\n{MATRICES}\n[reduction]"
#: Those of two, one of each in a block.
BLOCKS = """
L = "rows(vector(p1, q1, 0, 0), vector(q1, -p1, 0, 0), vector(0, 0, p2, q2), vector(0, 0, q2, -p2))"
M = "rows(vector(0, 1, 0, 0), vector(-1, 0, 0, 0), vector(0, 0, 0, 1), vector(0, 0, -1, 0))/2"
"""
WITH_PAIR = (
    UNFORCED,
    ('[inputs]\nu = { default = 0 }\n[time]\nname = "t"\n', ""),
    ('c = { positive = true, default = "0.1" }\n', ""),
    ("[reduction]", PAIR),
)
INDUCED = "the bracket on the section is that of the whole system"
EPSILON = sympy.Matrix(
    3, 3, lambda i, j: sum(sympy.LeviCivita(i, j, k) * sympy.Symbol(f"x{k + 1}") for k in range(3))
)


def expected(name, factor):
    """A multiple of ``eps_ijk x_k``."""
    return (factor * EPSILON).subs({f"x{k}": f"{name}{k}" for k in (1, 2, 3)})


@pytest.mark.parametrize(
    ("text", "tensor", "word"),
    [
        (IN_STEP, sympy.Matrix([[0, 1], [-1, 0]]) / 2, "Bracket on it, Dirac's"),
        # X = (A + B)/2 is in involution with A - B where A = B, and {X, X} = -hat(A)/2 there
        (BODIES, expected("A", sympy.Rational(-1, 2)), "do not commute with all"),
        (AT_REST, expected("Pi", -1), "a Poisson submanifold"),
    ],
)
def test_the_bracket_of_a_section_is_typed_by_hand(text, tensor, word):
    """Of Dirac, of a degenerate section, and restricted; all claims about it are proved."""
    declared = spec(text)
    found = derive(declared)
    assert sympy.Matrix(found.poisson_tensor) == tensor
    assert any(step.title.endswith(word) for step in found.steps)
    told = verdicts_of(text)
    assert set(told.values()) == {Verdict.PROVED}
    assert sum(each.startswith(INDUCED) for each in told) == 1
    assert "the Poisson bracket satisfies the Jacobi identity" in told


def test_casimirs_of_the_whole_are_integrals_on_the_section():
    """They are Casimirs of the whole, and of the bracket on the section where it has one."""
    found = verdicts_of(BODIES)
    for name in ("dot(A, A)", "dot(B, B)"):
        assert found[f"{name} is a Casimir of the whole system"] is Verdict.PROVED
        assert found[f"{name} is a Casimir"] is Verdict.PROVED
    bare = HYPERSURFACE + '[claims]\nconserved = ["q2"]\n'
    assert set(verdicts_of(bare).values()) == {Verdict.PROVED}


PT = (derivations_folder() / "pt_rigid_body.toml").read_text()
COMPLEX = (
    '[claims]\nconserved = ["energy", "dot(x, x) - dot(y, y)"]',
    '[claims]\ncasimirs = ["dot(x, x) - dot(y, y)", "dot(x, y)"]',
)


def test_casimirs_on_a_section_without_a_bracket():
    """Those of the complex rigid body are integrals; its section is a level set of an energy."""
    found = verdicts_of(PT, COMPLEX)
    assert set(found.values()) == {Verdict.PROVED}
    kept = "dot(x, x) - dot(y, y), restricted to the section, is conserved"
    assert {kept, "dot(x, y) is a Casimir of the whole system"} <= found.keys()
    assert not any(each.startswith(INDUCED) for each in found)


@pytest.mark.parametrize(
    ("text", "change", "statement"),
    [
        (BODIES, ('"dot(B, B)"]', '"B1^2"]'), "B1^2 is a Casimir of the whole system"),
        (BODIES, ('"dot(B, B)"]', '"B1^2"]'), "B1^2 is a Casimir"),
        (PT, (COMPLEX[0], '[claims]\ncasimirs = ["x1"]'), "x1 is a Casimir of the whole system"),
        (
            PT,
            (COMPLEX[0], '[claims]\ncasimirs = ["x1"]'),
            "x1, restricted to the section, is conserved",
        ),
        (AT_REST, ('"hat(Pi)"', '"-hat(Pi)"'), "{Pi, Pi} = -hat(Pi)"),
    ],
)
def test_wrong_claims_are_refuted(text, change, statement):
    """With a point."""
    assert verdicts_of(text, change)[statement] is Verdict.REFUTED


@pytest.mark.parametrize("factor", [0, 2, -1])
@pytest.mark.parametrize("text", [IN_STEP, BODIES, AT_REST])
def test_a_spoiled_bracket_is_refuted(text, factor, monkeypatch):
    """It is Poisson, and not the one that the whole induces; nor does it give the motion."""
    true = reductions.induced_bracket

    def spoil(restriction):
        found = true(restriction)
        return replace(found, tensor=tuple(tuple(factor * x for x in r) for r in found.tensor))

    monkeypatch.setattr(reductions, "induced_bracket", spoil)
    found = verdicts_of(text)
    (induced,) = (verdict for each, verdict in found.items() if each.startswith(INDUCED))
    assert induced is Verdict.REFUTED
    (motion,) = (verdict for each, verdict in found.items() if " is {x, h}" in each)
    assert motion is Verdict.REFUTED


def test_forces_are_projected_along_the_section():
    """Where each oscillator is driven by another force, their mean is what acts: by hand -c p."""
    uneven = (
        ('p1 = "-c*p1 + u*sin(t)"', 'p1 = "-c*p2"'),
        ('p2 = "-c*p2 + u*sin(t)"', 'q2 = "0*q1"\np2 = "-c*p1"'),
        ('[inputs]\nu = { default = 0 }\n[time]\nname = "t"\n', ""),
    )
    assert set(verdicts_of(IN_STEP, *uneven).values()) == {Verdict.PROVED}
    found = derive(spec(IN_STEP, *uneven))
    p, c = sympy.symbols("p1 c")
    force = [found.setting.field.normal(x) for x in found.exact.forces]
    assert [sympy.sympify(str(x).replace("^", "**")) for x in force] == [0, -c * p]


def test_a_hypersurface_has_no_bracket():
    """Its motion is proved without; a claimed bracket is refused, and integrals are the advice."""
    assert derive(spec(HYPERSURFACE)).poisson_tensor is None
    assert set(verdicts_of(HYPERSURFACE).values()) == {Verdict.PROVED}
    claim = HYPERSURFACE + '[claims]\nbrackets = { "{q1, p1}" = "1" }\n'
    with pytest.raises(
        DerivationError, match=r"no bracket of its own.*Claim the bracket in a spec"
    ):
        derive(spec(claim))
    whole = claim.replace('[reduction]\nwhere = ["p2"]\nsection = { p2 = "0*p1" }\n', "")
    assert set(verdicts_of(whole).values()) == {Verdict.PROVED}


@pytest.mark.parametrize(("scale", "said"), [("", "generates"), ("/2", "does not generate")])
def test_what_a_symmetry_generates_on_the_section(scale, said):
    """With {q, p} = 1/2 the function of a turn is q^2 + p^2, and not half of it."""
    turn = (
        "[reduction]",
        f'[symmetries.J]\nalgebra = "so(2)"\nvector = "s"\nmap = "s*(q1^2 + p2^2){scale}"\n'
        'generators = { q1 = "s*p2", p1 = "-s*q1" }\n[reduction]',
    )
    found = verdicts_of(IN_STEP, *WITH_PAIR[:3], turn)
    assert set(found.values()) == {Verdict.PROVED}
    (told,) = (each for each in found if "its flow by the bracket" in each)
    assert said in told


def test_a_lax_pair_is_proved_on_the_section():
    """It holds there alone: the spring of the whole is in no pair."""
    certificate = prove_claims(spec(IN_STEP, *WITH_PAIR))
    found = {each.statement: each.verdict for each in certificate.claims}
    assert set(found.values()) == {Verdict.PROVED}
    (pair,) = (each for each in found if each.startswith("dL/dt = [L, M]"))
    assert pair.endswith("on the route canonical")
    third = (PAIR, PAIR.replace("/2", "/3"))
    (wrong,) = (
        v
        for s, v in verdicts_of(IN_STEP, *WITH_PAIR, third).items()
        if s == pair.replace("/2", "/3")
    )
    assert wrong is Verdict.REFUTED


def test_the_lax_route_of_the_whole_is_restricted():
    """Of two oscillators without a spring, each with a block of L; both routes agree."""
    whole = (MATRICES, BLOCKS)
    routes = ('["canonical", "poisson"]', '["canonical", "lax"]')
    spring = (("k = { positive = true, default = 1 }\n", ""), (" + k*(q1 - q2)^4", ""))
    none = ("[parameters]\n", "")
    changes = (*WITH_PAIR, whole, routes, *spring, none)
    found = verdicts_of(IN_STEP, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    assert "canonical and lax give the same motion" in found
    assert any(s.startswith("dL/dt = [L, M]") and s.endswith("the route lax") for s in found)
    q, p = sympy.symbols("q1 p1")
    assert list(derive(spec(IN_STEP, *changes), "lax").rates) == [p, -q]
