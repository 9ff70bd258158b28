"""Velocities that the kernel solves for: definitions, their proof, their derivatives, refusals."""

import dataclasses
from fractions import Fraction

import pytest

from coadjoint.crosscheck.oracle import oracle
from coadjoint.derive import derive, make_setting
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.derive.mechanics.solver import Solve, solve_in_kernel, solver_names
from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError, DerivationError, LimitError
from coadjoint.exact import Field
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Multiply, Number
from coadjoint.prove.certificate import Verdict
from tests.specs import emitted, prove_claims, shipped, spec

BLOCK = (0, 1, 2, 3)
NAMES = ("x1", "x2", "x3", "x4")

#: Four coupled velocities of so(4), two alone; the coupling turns with nothing.
BODY = (
    """
title = "Coupled axes"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(4)"
[variables]
W = { role = "velocity", form = "antisymmetric" }
M = { role = "momentum", form = "antisymmetric" }
[parameters]
a = { shape = [6], positive = true, default = [7, 8, 9, 10, 11, 12] }
b = { default = 1 }
[lagrangian]
l = """
    + '"""'
    + """
  a[1]*W12^2/2 + a[2]*W13^2/2 + a[3]*W14^2/2 + a[4]*W23^2/2 + a[5]*W24^2/2 + a[6]*W34^2/2
+ b*(W12*W13 + W13*W14 + W14*W23)
"""
    + '"""'
    + """
[claims]
conserved = ["energy"]
"""
)


def sample():
    """A symmetric matrix of symbols with a zero, and the field of the solve."""
    entries = [f"a{i}{j}" for i in BLOCK for j in BLOCK[: i + 1]]
    known = [f"b{i}" for i in BLOCK]
    field = Field([*entries, *known, *NAMES, *solver_names(BLOCK)])
    matrix = [
        [field.zero if {i, j} == {0, 2} else field[f"a{max(i, j)}{min(i, j)}"] for j in BLOCK]
        for i in BLOCK
    ]
    return field, Solve(matrix, [field[name] for name in known], BLOCK, NAMES)


def test_definitions_solve_the_equations():
    """L D L^T = A, and what is solved solves A x = b, at exact numbers too."""
    field, solve = sample()
    definitions = solve_in_kernel(field, solve)
    assert not any(map(bool, solution_defects(field, solve, dict(definitions))))
    check_solved(field, solve, definitions)


@pytest.mark.parametrize("place", range(17))
def test_every_spoiled_definition_is_seen(place):
    """Doubling any one definition leaves a defect."""
    field, solve = sample()
    definitions = solve_in_kernel(field, solve)
    name, value = definitions[place]
    assert any(map(bool, solution_defects(field, solve, {**dict(definitions), name: 2 * value})))


def unsymmetric():
    """A matrix of symbols that is not symmetric, with a zero on each side."""
    entries = [f"a{i}{j}" for i in BLOCK for j in BLOCK]
    known = [f"b{i}" for i in BLOCK]
    field = Field([*entries, *known, *NAMES, *solver_names(BLOCK)])
    none = {(0, 2), (3, 1)}
    matrix = [[field.zero if (i, j) in none else field[f"a{i}{j}"] for j in BLOCK] for i in BLOCK]
    sides = [field[name] for name in known]
    return field, Solve(matrix=matrix, known=sides, block=BLOCK, names=NAMES, symmetric=False)


def check_solved(field, solve, definitions):
    """A x = b at exact numbers, which are no solution of anything else."""
    numbers = {name: Fraction(n * n + 2, n + 1) for n, name in enumerate(field.names)}
    for name, value in definitions:
        numbers[name] = field.evaluate(value, numbers, Fraction, None)
    for row, b in zip(solve.matrix, solve.known, strict=True):
        parts = [field.evaluate(entry, numbers, Fraction, None) for entry in row]
        total = sum(a * numbers[x] for a, x in zip(parts, NAMES, strict=True))
        assert total == field.evaluate(b, numbers, Fraction, None)


def test_a_matrix_that_is_not_symmetric_is_solved_too():
    """W U = A has the solution of A x = b; its symmetric part has another one."""
    field, solve = unsymmetric()
    definitions = solve_in_kernel(field, solve)
    check_solved(field, solve, definitions)
    assert not any(map(bool, solution_defects(field, solve, dict(definitions))))
    other = solve_in_kernel(field, dataclasses.replace(solve, symmetric=True))
    with pytest.raises(AssertionError):
        check_solved(field, solve, other)


def test_every_spoiled_definition_of_an_unsymmetric_solve_is_seen():
    """Doubling any one definition leaves a defect; pivots, both factors and the rest."""
    field, solve = unsymmetric()
    definitions = dict(solve_in_kernel(field, solve))
    assert len(definitions) > 25
    for name, value in definitions.items():
        spoiled = solution_defects(field, solve, {**definitions, name: 2 * value})
        assert any(map(bool, spoiled)), name


def test_only_coupled_velocities_are_solved_for():
    """Four of six are; the others are written out, and small systems have no such names."""
    equations = derive(spec(BODY))
    assert [name for name in equations.kept if not name.startswith("_")] == [
        "W23", "W14", "W13", "W12",
    ]  # fmt: skip
    assert dict(equations.exact.definitions)["W34"] == (
        equations.setting.field["M34"] / equations.setting.field["a6"]
    )
    assert not emitted("so8_body").kept
    assert not any(name.startswith("_d") for name in make_setting(shipped("so8_body")).field.names)


def test_everything_is_proved_and_lowered_without_closed_forms():
    """Claims in velocities; Programs modulo a prime; parameter levels apart."""
    declared = spec(BODY)
    certificate = prove_claims(declared)
    assert all(claim.verdict is Verdict.PROVED for claim in certificate.claims)
    assert any("L D L^T" in claim.statement for claim in certificate.claims)
    equations = derive(declared)
    programs = lower(equations)
    for program in programs.values():
        check_inverse(equations, program)
    fixed = {s.name for s in programs["rhs"].statements_at("parameters")}
    assert {"_d1", "_d4", "_l2_1"} <= fixed
    assert not fixed & {"_y1", "W12"}


@pytest.mark.parametrize("function", ["rhs", "jacobian", "energy"])
def test_a_spoiled_statement_is_seen(function):
    """Doubling a statement of a solve changes values modulo a prime."""
    equations = emitted("coupled_bodies")
    program = lower(equations)[function]
    check_inverse(equations, program)
    place = next(n for n, s in enumerate(program.statements) if s.name == "_d5")
    old = program.statements[place]
    new = dataclasses.replace(old, value=Multiply(Number(Fraction(2)), old.value))
    statements = (*program.statements[:place], new, *program.statements[place + 1 :])
    with pytest.raises(CrossCheckError, match=f"changed {function}"):
        check_inverse(equations, dataclasses.replace(program, statements=statements))


def test_a_spoiled_definition_is_refuted():
    """A pivot with a wrong sign contradicts the claim on L D L^T."""
    equations = emitted("coupled_bodies")
    wrong = tuple((n, -v if n == "_d4" else v) for n, v in equations.exact.definitions)
    exact = dataclasses.replace(equations.exact, definitions=wrong)
    certificate = prove_claims(equations.spec, [dataclasses.replace(equations, exact=exact)])
    refuted = [c.statement for c in certificate.claims if c.verdict is Verdict.REFUTED]
    assert any("L D L^T" in statement for statement in refuted)


def test_the_oracle_reaches_through_many_levels():
    """The envelope of a solve stays near its value, so that ordinary points have one."""
    reference = Reference(emitted("coupled_bodies"))
    names = (*reference.state, *reference.parameters)
    point = {name: 1.0 + n % 7 / 8 for n, name in enumerate(names)}
    assert all(b.envelope < 2**40 for b in oracle(reference, "rhs", point))


def test_a_singular_kinetic_energy_is_refused():
    """A coupled block of zero determinant is named."""
    text = BODY.replace("a[1]*W12^2/2", "0*a[1]").replace(
        "+ b*(W12*W13 +", "+ b*(W12*0 + W14*W34 +"
    )
    with pytest.raises(DerivationError, match="W12"):
        derive(spec(text))


def test_a_degenerate_leading_block_is_refused():
    """Pivots are taken in the order of the algebra, so a zero one is refused by name."""
    with pytest.raises(DerivationError, match="kinetic energy of W12 alone is degenerate"):
        derive(spec(BODY.replace("a[1]*W12^2/2 +", "0*a[1] +")))


def test_iterations_for_too_many_velocities_are_refused(monkeypatch):
    """The count, the names, the estimate and the limit are told."""
    monkeypatch.setattr("coadjoint.derive.mechanics.legendre.OPERATIONS", 600)
    said = r"couples 4 velocities .*W12.* about 682 operations; expected at most 600 .OPERATIONS"
    with pytest.raises(LimitError, match=said):
        derive(spec(BODY.replace("b*(W12*W13", "W12^4/4 + b*(W12*W13")))


def test_an_integral_that_names_a_solved_velocity_is_refused():
    """Only momenta have rates that proofs know."""
    text = BODY.replace('conserved = ["energy"]', 'conserved = ["W12^2"]')
    with pytest.raises(Exception, match="W12"):
        prove_claims(spec(text))
