"""Claims about constrained motions: what is proved of good ones, and what a spoiled one shows."""

import dataclasses
import math
from pathlib import Path

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.derive.mechanics.solver import Solve, solver_names
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.constraints import about_constraints
from coadjoint.prove.zero import decide_zero
from coadjoint.resources import derivations_folder
from tests.constrained import (
    APPELL,
    BALL,
    PARTICLE,
    PENDULUM,
    ROUND,
    SLEIGH,
    STRAIGHT,
    SUSLOV,
    about_routes,
    derived,
    motion,
)
from tests.specs import emitted, prove_claims, spec, verdicts_of

AFFINE = ('"w == y*u"', '"w == y*u + k*y"')
JELLETT = ("[constraints]", '[momenta]\nJ = { section = { Omega = "s" } }\n[constraints]')
CUBIC = ("[claims]", '[dissipation]\nR = "k*(u^2 + v^2)^2"\n[claims]')
DRIVEN = ("[claims]", '[forces]\nw = "3"\n[dissipation]\nR = "k*u^2/2"\n[claims]')


def verdicts(routes):
    """Verdict by statement of the claims that need no search."""
    found = {}
    for statement, kind, examine in about_routes(routes):
        if kind in ("constraint", "equivalence", "conserved"):
            decision = examine()
            if not hasattr(decision, "verdict"):
                decision = decide_zero(decision, routes[0].setting.field)
            found[statement] = decision.verdict
    return found


@pytest.mark.parametrize(
    ("changes", "statement"),
    [
        ((), "the energy is conserved"),
        ((AFFINE,), "the energy changes by the work of the moving constraints"),
        ((DRIVEN,), "the energy changes by the power of the forces and -2 R"),
        ((CUBIC,), "the energy changes by -<dR/dxi, xi>"),
        (
            (AFFINE, DRIVEN),
            "the energy changes by the power of the forces, -2 R and the work of the moving "
            "constraints",
        ),
    ],
)
def test_the_law_of_the_energy(changes, statement):
    """It is proved with the forces that are declared, and with the work of moving constraints."""
    found = verdicts(list(derived(PARTICLE, *changes).values()))
    assert found[statement] is Verdict.PROVED
    if changes:
        of = motion(PARTICLE, *changes)
        assert not of.field.is_zero(of.rate(of.equations.exact.energy))


def test_a_claim_of_energy_is_refuted_where_constraints_move():
    """Its rate along the motion is no zero, and a point shows it."""
    of = motion(PARTICLE, AFFINE)
    decision = decide_zero([of.rate(of.equations.exact.energy)], of.field, of.where)
    assert decision.verdict is Verdict.REFUTED
    assert decision.point


def spoiled(equations, name, change):
    """Equations with one definition changed."""
    definitions = tuple((n, change(v) if n == name else v) for n, v in equations.exact.definitions)
    exact = dataclasses.replace(equations.exact, definitions=definitions)
    return dataclasses.replace(equations, exact=exact)


@pytest.mark.parametrize(
    ("text", "name"),
    [(PARTICLE, "_d1"), (SLEIGH, "domega_dt"), (PENDULUM, "_l3_1"), (SUSLOV, "_z2")],
)
def test_a_wrong_line_of_the_solve_is_seen(text, name):
    """Double one intermediate, and the claim that the kernel solves is refuted."""
    first, second, *_ = derived(text).values()
    wrong = spoiled(first, name, lambda value: 2 * value + 1)
    statement = "the kernel solves for the accelerations: L D L^T = B^T M B"
    assert verdicts([first, second])[statement] is Verdict.PROVED
    assert verdicts([wrong, second])[statement] is Verdict.REFUTED


@pytest.mark.parametrize("text", [PARTICLE, SLEIGH, SUSLOV])
def test_a_wrong_side_of_a_solve_is_seen(text):
    """One force of the other sign on one road, and the roads differ."""
    first, second, *_ = derived(text).values()
    solves = [
        dataclasses.replace(solve, known=[-k for k in solve.known]) for solve in second.exact.solves
    ]
    exact = dataclasses.replace(second.exact, solves=tuple(solves))
    wrong = dataclasses.replace(second, exact=exact)
    statement = "nonholonomic and hamel give the same motion"
    assert verdicts([first, second])[statement] is Verdict.PROVED
    assert verdicts([first, wrong])[statement] is Verdict.REFUTED


def test_kept_constraints_stay():
    """d(x u + y v)/dt = 0 along the motion, and x^2 + y^2 with it where the constraint holds."""
    of = motion(PENDULUM)
    assert verdicts(list(derived(PENDULUM).values()))["the motion keeps rod"] is Verdict.PROVED
    length = of.field["x"] ** 2 + of.field["y"] ** 2
    assert not of.field.is_zero(of.rate(length))
    assert decide_zero([of.rate(length)], of.field, of.where).verdict is Verdict.PROVED


def test_rates_are_those_of_the_whole_motion():
    """d(m u^2)/dt = 2 m u du/dt: with du/dt of the other sign another value."""
    of = ConstrainedRates(derived(PARTICLE)["nonholonomic"])
    m, y, u, v = (of.field[name] for name in "myuv")
    found = of.rate(m * u**2)
    assert of.field.is_zero(found + 2 * m * y * u**2 * v / (1 + y**2))
    assert not of.field.is_zero(found - 2 * m * y * u**2 * v / (1 + y**2))


def test_a_false_claim_beside_a_constraint_with_functions_is_refuted():
    """Where cos(x) u = sin(x) v holds, dx/dt is not 0; the point says what v is there."""
    of = motion(PENDULUM, ('"x*u + y*v == 0"', '"cos(x)*u - sin(x)*v == 0"'))
    decision = decide_zero([of.rate(of.field["x"])], of.field, of.where)
    assert decision.verdict is Verdict.REFUTED
    x, u, v = (float(sympy.sympify(decision.point[name])) for name in "xuv")
    assert math.cos(x) * u == pytest.approx(math.sin(x) * v)
    energy = of.rate(of.equations.exact.energy)
    assert decide_zero([energy], of.field, of.where).verdict is Verdict.PROVED


def test_combinations_of_rows_give_what_determinants_give(monkeypatch):
    """The rate of the energy and of a momentum is the same by both roads, and spoiled ones not."""
    of = motion(BALL, JELLETT)
    functions = [of.equations.exact.energy, dict(of.equations.exact.observables)["J"]]
    short = [of.value(weighted(of, f)) for f in functions]
    monkeypatch.setattr(ConstrainedRates, "_weights", lambda *_: iter(()))
    for function, value in zip(functions, short, strict=True):
        assert of.field.is_zero(of.value(weighted(of, function)) - value)
    monkeypatch.setattr(ConstrainedRates, "_along", lambda self, block, *_: block.known[0])
    assert not of.field.is_zero(of.value(weighted(of, functions[0])) - short[0])


def test_the_rate_of_the_energy_needs_no_determinant_where_a_constraint_is_kept(monkeypatch):
    """On the constraint it is that by determinants; beyond, where no motion is, it need not be."""
    of = motion(PENDULUM)
    energy = of.equations.exact.energy
    short = of.value(weighted(of, energy))
    (written,) = of.field.quotients(short)
    assert not written.divisors
    monkeypatch.setattr(ConstrainedRates, "_weights", lambda *_: iter(()))
    whole = of.value(weighted(of, energy))
    assert decide_zero([whole - short], of.field, of.where).verdict is Verdict.PROVED
    assert not of.field.is_zero(whole - short)


def weighted(of, function):
    """The part of a rate that the accelerations have."""
    names = of.distribution.independent
    slopes = of.field.gradient(of.close(function), names)
    return of.field.sum(s * of.field[f"d{name}_dt"] for s, name in zip(slopes, names, strict=True))


def test_a_reaction_is_an_integral_only_where_it_is_constant():
    """The push m u v/(1 + y^2) of the particle changes; that of a flat blade is 0 and does not."""
    claimed = (
        "[claims]\nconserved = [",
        '[observables]\npush = "blade_reaction"\n[claims]\nconserved = ["push", ',
    )
    flat = ("w == y*u", "w == k*u")
    verdict = verdicts_of(PARTICLE, claimed)
    assert verdict["push is conserved"] is Verdict.REFUTED
    verdict = verdicts_of(PARTICLE, claimed, flat)
    assert verdict["push is conserved"] is Verdict.PROVED


def test_the_energy_is_said_to_be_conserved_once():
    """A spec that claims it adds nothing; one whose forces change it is refuted."""
    for changes, texts in (((), ["the energy is conserved"]), ((DRIVEN,), ["energy is conserved"])):
        claims = prove_claims(spec(PARTICLE, *changes)).claims
        found = [c for c in claims if c.statement.endswith("energy is conserved")]
        assert [c.statement for c in found] == texts
        assert found[0].verdict is (Verdict.REFUTED if changes else Verdict.PROVED)


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("veselova", "wherever Gamma1^2 + Gamma2^2 + Gamma3^2 is not 0"),
        ("suslov", "wherever a1^2 + a2^2 + a3^2 is not 0"),
        ("knife_edge_cvt", "everywhere"),
        ("chaplygin_sleigh", "everywhere, each gives a velocity"),
    ],
)
def test_where_the_rank_drops_is_said(name, where):
    """A blade has a direction at every angle, a normal of length 0 is none."""
    statement, *_ = next(about_constraints(ConstrainedRates(emitted(name))))
    assert statement == f"the constraint is independent: rank 1 {where}"


@pytest.mark.parametrize(
    ("factor", "where", "method"),
    [
        ("(1 + x + y^3)", "almost every point", "at random points modulo a prime"),
        ("exp(x + y)", "almost every point", "at a real point, with bounds that exclude zero"),
        (
            "log(x + y - 7)",
            "almost every point of a connected part of the domain",
            "at a real point, with bounds that exclude zero",
        ),
    ],
)
def test_where_a_rank_is_certain_is_said(factor, where, method):
    """A constraint with long coefficients: analytic ones have full rank at almost every point."""
    text = (Path(derivations_folder()) / "knife_edge_cvt.toml").read_text()
    old = next(line for line in text.splitlines() if line.startswith("blade"))
    new = f'blade = "{factor}*vx*(x + 2*z) + vz*(x^2 + {factor.replace("y", "x")}) + vxi*x == 0"'
    declared = spec(text, (old, new.replace("y", "z")), name="knife_edge_cvt")
    statement, _, examine = next(about_constraints(ConstrainedRates(derive(declared))))
    assert statement == f"the constraint is independent: rank 1 at {where}"
    assert examine().method == f"rank of A {method}"


def test_routes_that_move_positions_otherwise_are_told_apart():
    """The second carries the normal the other way, with equal equations for accelerations."""
    first, second, *_ = derived(BALL).values()
    same = "nonholonomic and hamel give the same motion"
    assert verdicts([first, second])[same] is Verdict.PROVED
    wrong = spoiled(second, "dGamma1_dt", lambda rate: -rate)
    assert verdicts([first, wrong])[same] is Verdict.REFUTED


SAME = "nonholonomic and hamel give the same motion"
SOLVED = "the kernel solves for the accelerations: L D L^T = B^T M B"


def test_the_wheel_of_appell_and_its_heading_are_two_blocks():
    """Cos sin - sin cos = 0 couples them on no road; one force of the other sign is seen.

    By hand ((M + m) a^2 + m b^2 + I) phi'' = (M + m) a rho psi'^2 - m g b.
    """
    first, second, *_ = derived(APPELL).values()
    assert [list(solve.names) for solve in first.exact.solves] == [["dvpsi_dt"], ["dvphi_dt"]]
    found = verdicts([first, second])
    assert found[SAME] is found[SOLVED] is Verdict.PROVED
    f = first.setting.field
    m, M, inertia, a, b, rho, g, spin = (
        f[name] for name in ("m", "M", "I", "a", "b", "rho", "g", "vpsi")
    )
    known = (M + m) * a * rho * spin**2 - m * g * b
    mass = (M + m) * a**2 + m * b**2 + inertia
    for equations in (first, second):
        block = equations.exact.solves[1]
        assert f.is_zero(equations.close(block.matrix[0][0]) - mass)
        assert f.is_zero(equations.close(block.known[0]) - known)


def whole(equations):
    """The same linear equations, their blocks written as one."""
    solves, zero = equations.exact.solves, equations.setting.field.zero
    block = tuple(place for solve in solves for place in solve.block)
    entries = {
        (i, j): entry
        for solve in solves
        for i, row in zip(solve.block, solve.matrix, strict=True)
        for j, entry in zip(solve.block, row, strict=True)
    }
    matrix = tuple(tuple(entries.get((i, j), zero) for j in block) for i in block)
    known = [value for solve in solves for value in solve.known]
    names = [name for solve in solves for name in solve.names]
    return Solve(matrix, known, block, names)


def with_solves(equations, *solves):
    """Equations with other linear equations."""
    exact = dataclasses.replace(equations.exact, solves=solves)
    return dataclasses.replace(equations, exact=exact)


def test_routes_are_compared_entry_by_entry_whatever_their_blocks():
    """One block of both is the same motion; with a coupling in it, it is another."""
    first, second, *_ = derived(APPELL).values()
    joined = whole(second)
    assert verdicts([first, with_solves(second, joined)])[SAME] is Verdict.PROVED
    one = second.setting.field.one
    (a, _), (_, d) = joined.matrix
    coupled = dataclasses.replace(joined, matrix=((a, one), (one, d)))
    assert verdicts([first, with_solves(second, coupled)])[SAME] is Verdict.REFUTED
    assert verdicts([with_solves(first, coupled), second])[SAME] is Verdict.REFUTED


def test_a_solve_that_is_left_out_is_seen():
    """A route that forgets a block gives another motion."""
    first, second, *_ = derived(APPELL).values()
    assert verdicts([first, with_solves(second, second.exact.solves[0])])[SAME] is Verdict.REFUTED


@pytest.mark.parametrize("text", [STRAIGHT, ROUND])
def test_motions_without_acceleration_are_proved(text):
    """Everything claimed of them is true; a force of the constraint out of nothing is refuted."""
    first, second, *_ = derived(text).values()
    assert set(verdicts([first, second]).values()) == {Verdict.PROVED}
    wrong = spoiled(first, "_u1", lambda value: value + 1)
    assert verdicts([wrong, second])[SOLVED] is Verdict.REFUTED
    assert prove_claims(spec(text)).holds


@pytest.mark.parametrize("name", ["chaplygin_ball_centred", "snakeboard"])
def test_every_spoiled_line_of_a_shipped_solve_is_seen(name):
    """Reciprocals, columns and what is left out as zero: double any line, and a defect is left."""
    first = emitted(name)
    definitions, (solve, *_) = dict(first.exact.definitions), first.exact.solves
    own = [line for line in solver_names(solve.block) if line in definitions]
    assert len(own) > 8
    field = first.setting.field
    assert not any(solution_defects(field, solve, definitions))
    for line in own:
        wrong = definitions | {line: 2 * definitions[line]}
        assert any(solution_defects(field, solve, wrong)), line
