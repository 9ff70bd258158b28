"""Newton's iteration in the kernel: velocities of momenta whose map has no closed form."""

import math
from dataclasses import replace
from functools import cache, partial

import mpmath
import numpy as np
import pytest

from coadjoint.crosscheck.recurrences import run_recurrences
from coadjoint.derive import derive
from coadjoint.derive.mechanics import iteration, legendre
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CrossCheckError, DerivationError, LimitError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Number
from coadjoint.prove.declaration import kernel_context
from coadjoint.prove.equivalence import LegendreMap
from coadjoint.render.solvers import arrange, select_programs
from tests.kernels import COMPILER
from tests.solve.systems import build
from tests.specs import RIGID_BODY, prove_claims, spec

#: A particle on a line, l = 0 at rest and a spring.
LINE = """
title = "A particle on a line"
routes = ["euler-lagrange", "canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
v = { role = "velocity", of = "q" }
[parameters]
a = { positive = true, default = 1 }
k = { positive = true, default = 1 }
[lagrangian]
l = "v^4/4 + a*v^2/2 - k*q^2/2"
[claims]
conserved = ["energy"]
"""
QUARTIC = "v^4/4 + a*v^2/2"
#: The largest momentum of ``v - v^3``.
FOLD = 2 / (3 * math.sqrt(3))
BODY = ("diag(I)*Omega)/2", "diag(I)*Omega)/2 + dot(Omega, Omega)^2/4")


def line(kinetic):
    """The particle with another kinetic energy."""
    return spec(LINE, (QUARTIC, kinetic))


@cache
def programs(text):
    """The functions of a kernel."""
    return lower(derive(spec(text)))


def call(function, *arguments):
    """An elementary function of numbers as NumPy has it."""
    return getattr(np, ELEMENTARY[function].numpy_name)(*arguments)


def compute(program, *values):
    """A function at some numbers, state and parameters in order."""
    known = dict(zip(program.names, map(np.float64, values), strict=True))
    with np.errstate(all="ignore"):
        return [float(x) for x in run(program, known, np.float64, call)]


def velocity(kinetic, p, a=1.0):
    """dq/dt of the particle with a momentum."""
    text = LINE.replace(QUARTIC, kinetic)
    return compute(programs(text)["rhs"], 0.5, p, a, 1.0)[0]


def test_a_quartic_body_is_proved_on_its_routes_and_moves_as_it_should():
    """Pi = I Omega + |Omega|^2 Omega, dPi/dt = Pi x Omega, by Omega from which Pi is computed."""
    declared = spec(RIGID_BODY, BODY)
    certificate = prove_claims(declared)
    assert certificate.holds, str(certificate)
    texts = [claim.statement for claim in certificate.claims]
    assert any(f"Newton's iteration of {iteration.STEPS} steps from rest" in each for each in texts)
    rhs = lower(derive(declared))["rhs"]
    for size in (1e-9, 0.5, 40.0):
        omega = size * np.array([0.5, -0.25, 0.75])
        pi = np.array([1.0, 2.0, 3.0]) * omega + omega @ omega * omega
        found = compute(rhs, *pi, 1, 2, 3)
        assert found == pytest.approx(np.cross(pi, omega), rel=1e-12)


@pytest.mark.parametrize("p", [0.0, 1e-12, -0.3, 1.0, 30.0, 1000.0])
def test_a_kinetic_energy_with_a_hyperbolic_cosine(p):
    """P = a sinh v."""
    assert velocity("a*cosh(v)", p, 2.0) == pytest.approx(math.asinh(p / 2), rel=1e-14, abs=0)


@pytest.mark.parametrize("p", [0.125, -0.9, 3.0, 25.0, 100.0])
def test_an_iteration_stays_where_the_lagrangian_is_defined(monkeypatch, p):
    """P = v/sqrt(1 - v^2), by Newton's iteration in the place of the closed form."""
    monkeypatch.setattr(legendre, "radial_solution", lambda *_: None)
    rhs = lower(derive(line("-sqrt(1 - v^2)")))["rhs"]
    expected = p / math.sqrt(1 + p * p)
    assert compute(rhs, 0.5, p, 1.0, 1.0)[0] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("p", [0.0, 0.1, -0.3, 0.999 * FOLD])
def test_the_branch_is_the_one_from_rest(p):
    """P = v - v^3: of three roots the smallest, ``2/sqrt(3) sin(asin(p/FOLD)/3)``."""
    expected = 2 / math.sqrt(3) * math.sin(math.asin(p / FOLD) / 3)
    assert velocity("-v^4/4 + a*v^2/2", p) == pytest.approx(expected, rel=1e-12, abs=0)


@pytest.mark.parametrize("p", [1.001 * FOLD, -0.5, 1.0, 50.0, 1e6])
def test_a_momentum_that_no_velocity_of_the_branch_has_is_not_computed(p):
    """V - v^3 has another root there, at which d2l/dv2 is negative: the result is no number."""
    own = programs(LINE.replace(QUARTIC, "-v^4/4 + a*v^2/2"))
    assert math.isnan(velocity("-v^4/4 + a*v^2/2", p))
    assert not compute(own["domain"], 0.5, p, 1.0, 1.0)[0] > 0
    assert math.isnan(compute(own["energy"], 0.5, p, 1.0, 1.0)[0])


def test_an_iteration_that_has_not_come_to_its_end_is_no_number(monkeypatch):
    """With the same tolerance and too few steps; with enough of them it is one."""
    monkeypatch.setattr(iteration, "STEPS", 3)
    monkeypatch.setattr(iteration, "APPROACH", 0)
    rhs = lower(derive(line(QUARTIC)))["rhs"]
    assert math.isnan(compute(rhs, 0.5, 10.0, 1.0, 1.0)[0])
    monkeypatch.undo()
    assert velocity(QUARTIC, 10.0) == pytest.approx(2.0, rel=1e-15)


def test_derivatives_are_those_of_the_implicit_function():
    """dv/dp = 1/(3 v^2 + a), dv/da = -v/(3 v^2 + a), at v = 2."""
    own = programs(LINE)
    jacobian = compute(own["jacobian"], 0.5, 10.0, 1.0, 1.0)
    assert jacobian == pytest.approx([0, 1 / 13, -1, 0], rel=1e-14)
    by_parameters = compute(own["parameter_jacobian"], 0.5, 10.0, 1.0, 1.0)
    assert by_parameters == pytest.approx([-2 / 13, 0, 0, -0.5], rel=1e-14)


def test_recurrences_begin_with_what_the_iteration_finds():
    """Q' = v, p' = -k q, v' = p'/(3 v^2 + a), q'' = v' and q''' = -(k v + 6 v v'^2)/(3 v^2 + a)."""
    text = arrange(select_programs(programs(LINE).values()))
    number = partial(float)
    given = {"a": (1.0,), "k": (1.0,)}
    found = run_recurrences(text, {"q": 0.5, "p": 10.0}, given, 3, number, call)
    slope = -0.5 / 13
    third = -(2 + 12 * slope**2) / 13
    assert found["q"] == pytest.approx([0.5, 2.0, slope / 2, third / 6], rel=1e-14)
    assert found["p"] == pytest.approx([10.0, -0.5, -1.0, -slope / 6], rel=1e-14)


def test_another_hessian_or_momentum_is_refuted():
    """What the kernel iterates on is compared with dl/dv and d2l/dv2."""
    equations = derive(line(QUARTIC))
    (solve,) = equations.exact.solves
    field, own = equations.setting.field, solve.newton
    assert not any(LegendreMap(equations).solution_defects(equations))
    two = field.number(2)
    for wrong in (
        replace(own, hessian=((own.hessian[0][0] * two,),)),
        replace(own, slopes=(own.slopes[0] + field["a"],)),
    ):
        exact = replace(equations.exact, solves=(replace(solve, newton=wrong),))
        assert any(LegendreMap(equations).solution_defects(replace(equations, exact=exact)))


def test_an_iteration_that_is_lowered_wrongly_is_found():
    """Another number in one of its steps."""
    equations, rhs = derive(line(QUARTIC)), programs(LINE)["rhs"]
    check_inverse(equations, rhs)
    place = next(n for n, each in enumerate(rhs.statements) if each.name == "_x1_7")
    statements = list(rhs.statements)
    statements[place] = replace(statements[place], value=Number(1))
    with pytest.raises(CrossCheckError, match="lowering changed rhs"):
        check_inverse(equations, replace(rhs, statements=tuple(statements)))


@pytest.mark.parametrize(
    ("kinetic", "message"),
    [
        ("v^4/4 - a*v^2/2", "not positive definite"),
        ("v^4/4 + a*v^3", "not positive definite"),
        ("v^4/4 + a*v^2/2 + sqrt(v)", "momenta are not defined there"),
        ("v*log(v) + v^2", "d2l/dxi2 is not defined there"),
        ("sqrt(v^2)^3", "d2l/dxi2 is not defined there"),
    ],
)
def test_what_cannot_begin_at_rest_is_refused(kinetic, message):
    """The message says why, and what it advises is followed in the end: no momenta."""
    with pytest.raises(DerivationError, match=message) as caught:
        derive(line(kinetic))
    assert "remove p and take the route euler-lagrange" in str(caught.value)
    changes = (('p = { role = "momentum", of = "q" }\n', ""), (', "canonical"', ""))
    assert derive(spec(LINE, (QUARTIC, kinetic), *changes)).setting.state == ("q", "v")


def test_too_many_coupled_velocities_are_refused():
    """As many as the kernel solves for, and one more."""
    many = LINE.replace('"coordinate"', '"coordinate", shape = [17]')
    changes = ((QUARTIC, "dot(v, v)^2/4 + a*dot(v, v)/2 + v1^6"), ("k*q^2", "k*dot(q, q)"))
    with pytest.raises(LimitError, match=r"couples 17 velocities"):
        derive(spec(many, *changes))


DRIFTING = LINE.replace(QUARTIC, "v^4/4 + a*(2 + sin(t))*v^2/2 + v*cos(t)").replace(
    "[lagrangian]", '[time]\nname = "t"\n[lagrangian]'
)


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_momenta_may_depend_on_time(tmp_path, method):
    """A free particle keeps p; ``v^3 + a (2 + sin t) v + cos t = p``, and v integrates to q."""
    text = DRIFTING.replace(" - k*q^2/2", "").replace("k = { positive = true, default = 1 }\n", "")
    equations = derive(spec(text.split("[claims]")[0]))
    system = build(kernel_context(equations, lower(equations), 0), tmp_path)

    def cubic(t, p, a):
        h, r = a * (2 + mpmath.sin(t)), p - mpmath.cos(t)
        size = 2 * mpmath.sqrt(h / 3)
        return size * mpmath.sinh(mpmath.asinh(3 * r / (h * size)) / 3)

    end = mpmath.quad(lambda t: cubic(t, 1.5, 0.7), np.linspace(0, 7, 15).tolist())
    run = system.simulate([0.25, 1.5], (0, 7), {"a": 0.7}, method=method, rtol=1e-12, atol=1e-12)
    assert run.status == "OK"
    assert run.final["p"] == 1.5
    assert run.final["q"] == pytest.approx(0.25 + float(end), abs=1e-11)
    assert run["v"][-1] == pytest.approx(float(cubic(7, 1.5, 0.7)), abs=1e-13)


def test_time_in_momenta_is_proved_on_both_routes():
    """The bracket gives the motion, and the energy changes by its explicit dependence on time."""
    proved = prove_claims(spec(DRIFTING.replace('"energy"', ""))).claims
    assert all(claim.verdict.name == "PROVED" for claim in proved)
    assert any("explicit dependence on time" in claim.statement for claim in proved)


STEERED = LINE.replace(QUARTIC, "v^4/4 + (a + u)*v^2/2 + w*v").replace(
    "[parameters]",
    """[domain]
convex = "a + u > 0"
[inputs]
u = { default = 1 }
w = { default = 0 }
[parameters]""",
)


@cache
def steer():
    """A free particle, ``v^3 + (a + u) v + w = p``: its equations and functions."""
    text = STEERED.replace(" - k*q^2/2", "").replace("k = { positive = true, default = 1 }\n", "")
    equations = derive(spec(text.split("[claims]")[0]))
    return equations, lower(equations)


@pytest.fixture(scope="module")
def steered(tmp_path_factory):
    """Its system."""
    return build(kernel_context(*steer(), 0), tmp_path_factory.mktemp("steered"))


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize(
    ("method", "target"), [("taylor", "c"), ("taylor", "numpy"), ("dop853", "c")]
)
def test_momenta_may_depend_on_inputs(steered, method, target):
    """Along ramps of both inputs p is kept, and v, the root of a cubic, integrates to q."""
    times, u, w = [0, 2, 3], [0, 4, 1], [0.5, 0.5, -1]

    def cubic(t):
        h = 0.7 + mpmath.mpf(np.interp(float(t), times, u))
        r, size = 1.5 - mpmath.mpf(np.interp(float(t), times, w)), 2 * mpmath.sqrt(h / 3)
        return size * mpmath.sinh(mpmath.asinh(3 * r / (h * size)) / 3)

    end = mpmath.quad(cubic, [0, 1, 2, 2.5, 3])
    run = steered.simulate(
        *([0.25, 1.5], (0, 3), {"a": 0.7}, (times, [u, w], "linear")),
        **{"method": method, "target": target, "rtol": 1e-12, "atol": 1e-12},
    )
    assert run.status == "OK"
    assert run.final["p"] == 1.5
    assert run.final["q"] == pytest.approx(0.25 + float(end), abs=1e-11)


def test_recurrences_have_the_rates_of_inputs():
    """V' = -(u' v + w')/(3 v^2 + a + u) at v = 1, and of another sign of w' it is not that."""
    text = arrange(select_programs(steer()[1].values()))
    given = {"a": (1.0,), "u": (2.0, 0.5), "w": (0.25, -2.0)}
    found = run_recurrences(text, {"q": 0.5, "p": 4.25}, given, 2, partial(float), call)
    assert found["q"] == pytest.approx([0.5, 1.0, (2.0 - 0.5) / 6 / 2], rel=1e-14)
    other = run_recurrences(
        text, {"q": 0.5, "p": 4.25}, given | {"w": (0.25, 2.0)}, 2, partial(float), call
    )
    assert other["q"][2] == pytest.approx((-2.0 - 0.5) / 6 / 2, rel=1e-14)


def test_inputs_in_momenta_are_proved_on_both_routes():
    """The energy is kept while the inputs are constant."""
    proved = prove_claims(spec(STEERED)).claims
    assert all(claim.verdict.name == "PROVED" for claim in proved)
    assert any("while the inputs are constant" in claim.statement for claim in proved)


@pytest.fixture(scope="module")
def folding(tmp_path_factory):
    """A force F pushes a particle, ``a v - v^3 = p``, past the largest momentum."""
    text = LINE.replace(QUARTIC, "-v^4/4 + a*v^2/2").replace("- k*q^2/2", "+ k*q")
    equations = derive(spec(text.split("[claims]")[0]))
    return build(kernel_context(equations, lower(equations), 0), tmp_path_factory.mktemp("folding"))


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize(
    ("method", "ends"),
    [("taylor", {"DOMAIN"}), ("rk4", {"NONFINITE"}), ("midpoint", {"NOT_SOLVED", "NONFINITE"})],
)
def test_a_member_past_the_last_momentum_ends_alone(folding, method, ends, target):
    """The member that is pushed less goes on to the end, and has the velocity of its momentum."""
    own = {} if method == "taylor" else {"step": 0.015625}
    run = folding.simulate(
        *(np.zeros((2, 2)), (0, 1), {"k": np.array([0.125, 0.5])}),
        **{"method": method, "target": target, **own},
    )
    assert run.status[0] == "OK"
    assert run.status[1] in ends
    assert run.final["p"] == pytest.approx([0.125, FOLD], abs=0.008)
    assert run.final["p"][1] <= FOLD + 1e-12
    found = folding.rhs([run.final["q"], run.final["p"]], target=target)[0]
    assert found[0] == pytest.approx(velocity("-v^4/4 + a*v^2/2", 0.125), rel=1e-12)
