"""The words of formulas on several routes: against forces and numbers that are typed by hand."""

import math

import numpy as np
import pytest
import sympy

from coadjoint import elementary, pipeline
from coadjoint.errors import ClaimError, CoadjointError, DerivationError, SpecError
from coadjoint.exact import Field, element_text
from coadjoint.prove import Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import UndecidedError, decide_zero
from coadjoint.solve.folders import load_folder
from tests.kernels import COMPILER
from tests.specs import prove_claims, render_claims, spec

LAW = """
title = "A point in a potential, with its force typed by hand"
routes = ["newton", "canonical", "euler-lagrange"]
[variables]
x = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "x" }
[parameters]
k = { positive = true, default = "0.5" }
n = { default = "2.25" }
[newton]
x = { force = "FORCE" }
[lagrangian]
l = "dot(v, v)/2 - (POTENTIAL)"
[claims]
conserved = ["energy"]
"""


def law(potential, force):
    """The spec of a potential with minus its gradient."""
    return LAW.replace("POTENTIAL", potential).replace("FORCE", force)


#: Potentials, and forces from a table of derivatives.
WORDS = {
    "hyperbolic": (
        "k*cosh(x1) + k*x2*sinh(x1) + log(cosh(x2))",
        "vector(-k*sinh(x1) - k*x2*cosh(x1), -k*sinh(x1) - tanh(x2))",
    ),
    "tanh": ("k*x1*tanh(x2)", "vector(-k*tanh(x2), -k*x1/cosh(x2)^2)"),
    "inverse": (
        "asin(x1/(2 + x1^2)) - k*acos(tanh(x2)/2)",
        "vector(-(2 - x1^2)/((2 + x1^2)*sqrt((2 + x1^2)^2 - x1^2)), "
        "-k*(1 - tanh(x2)^2)/sqrt(4 - tanh(x2)^2))",
    ),
    "inverse hyperbolic": (
        "asinh(k*x1) - atanh(x2/(2 + x2^2))",
        "vector(-k/sqrt(1 + k^2*x1^2), (2 - x2^2)/((2 + x2^2)^2 - x2^2))",
    ),
    "atan": ("x1*atan(x1) - log(1 + x1^2)/2 + k*x2^2/2", "vector(-atan(x1), -k*x2)"),
    "angle": (
        "k*atan2(x2, x1) + dot(x, x)/2",
        "vector(k*x2/dot(x, x) - x1, -k*x1/dot(x, x) - x2)",
    ),
    "power": (
        "(x1^2 + k)^n + k^n*x2^2",
        "vector(-2*n*x1*(x1^2 + k)^(n - 1), -2*exp(n*log(k))*x2)",
    ),
    "half": ("(x1^2 + k)^1.5/3 + x2", "vector(-x1*sqrt(x1^2 + k), -1)"),
    "constants": (
        "cos(2*pi/7)*x1^2 + cos(4*pi/7)*x1^2 + cos(6*pi/7)*x1^2 + pi*x2 + sqrt(5)*x2",
        "vector(x1, -pi - sqrt(5))",
    ),
    "walls": (
        "max(x1 - k, 0)^2/2 + min(x1 + k, 0)^2/2 + abs(x2)^3",
        "vector(-max(x1 - k, 0) - min(x1 + k, 0), -3*x2*abs(x2))",
    ),
    "kink": (
        "abs(x1) + k*abs(x1*x2)",
        "-vector(sign(x1) + k*sign(x1)*abs(x2), k*abs(x1)*sign(x2))",
    ),
}


@pytest.mark.parametrize("name", WORDS)
def test_routes_agree_with_forces_typed_by_hand(name):
    """Newton's law, the canonical equations and Euler and Lagrange's are proved to be one."""
    certificate = prove_claims(spec(law(*WORDS[name])))
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}
    statements = [claim.statement for claim in certificate.claims]
    assert "newton and euler-lagrange give the same motion" in statements
    methods = " ".join(claim.method for claim in certificate.claims)
    assert ("where and while" in methods) == (name in ("angle", "walls", "kink"))


@pytest.mark.parametrize("name", ["inverse", "angle", "kink"])
def test_a_wrong_force_is_not_proved(name):
    """Twice the force is another motion, by a counterexample."""
    potential, force = WORDS[name]
    certificate = prove_claims(spec(law(potential, f"2*{force}")))
    verdicts = {claim.statement: claim.verdict for claim in certificate.claims}
    assert verdicts["newton and euler-lagrange give the same motion"] is Verdict.REFUTED


def test_a_spoiled_derivative_is_not_proved(monkeypatch):
    """With a wrong sign in the table, the Lagrangian's motion is not that of the force."""
    entry = elementary.ELEMENTARY["atan2"]
    spoiled = type(entry)(**{**vars(entry), "slopes": ("v/(u*u + v*v)", "u/(u*u + v*v)")})
    monkeypatch.setitem(elementary._TABLE, "atan2", spoiled)
    with pytest.raises(ClaimError, match="newton and euler-lagrange give the same motion"):
        render_claims(spec(law(*WORDS["angle"])))


ALL = (
    "atan2(x1, 2 + k) + asin(tanh(x1)/2)*cosh(x1/4) + abs(x1 - k)*max(x1, -k) + (k + x1^2)^n"
    " + cos(2*pi/7)*atan(x1)*sinh(x1/3) - acos(x1/9) + x2^2/2"
)


def value(x1, x2, k=0.5, n=2.25):
    """The potential of `ALL`, in Python."""
    return (
        math.atan2(x1, 2 + k)
        + math.asin(math.tanh(x1) / 2) * math.cosh(x1 / 4)
        + abs(x1 - k) * max(x1, -k)
        + (k + x1**2) ** n
        + math.cos(2 * math.pi / 7) * math.atan(x1) * math.sinh(x1 / 3)
        - math.acos(x1 / 9)
        + x2**2 / 2
    )


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_kernels_and_solvers_have_all_words(tmp_path):
    """The ladder passes, and energy and force are those of Python's own functions."""
    text = law(ALL, "vector(0, 0)").replace(
        'routes = ["newton", "canonical", "eul', 'routes = ["eul'
    )
    rendered = render_claims(spec(text.replace('[newton]\nx = { force = "vector(0, 0)" }\n', "")))
    assert pipeline.verify(rendered).passed
    for name, content in rendered.texts.items():
        (tmp_path / name).write_text(content)
    system, step = load_folder(tmp_path), 1e-5
    for x1, x2 in ((0.3, -0.7), (1.7, 2.2), (-1.1, -0.2)):
        state = np.array([x1, x2, 0.25, -0.5])
        for target in ("numpy", "c", "python"):
            energy = system.evaluate("energy", state, [0.5, 2.25], target=target)
            assert energy == pytest.approx((0.25**2 + 0.5**2) / 2 + value(x1, x2), rel=1e-14)
            rates = system.evaluate("rhs", state, [0.5, 2.25], target=target)
            slopes = (
                (value(x1 + step, x2) - value(x1 - step, x2)) / (2 * step),
                (value(x1, x2 + step) - value(x1, x2 - step)) / (2 * step),
            )  # an error of about step^2
            np.testing.assert_allclose(rates[2:], [-each for each in slopes], rtol=1e-8)
    ends = [
        system.simulate([0.3, -0.7, 0.25, -0.5], (0, 2), method=method, target=target).final
        for method, target in (("taylor", "c"), ("dop853", "c"), ("taylor", "numpy"))
    ]
    for end in ends[1:]:
        assert end["x1"] == pytest.approx(ends[0]["x1"], abs=1e-6)  # of the default tolerances


def loaded(formula, *more):
    """The certificate of a one-dimensional motion in a potential."""
    text = f"""
title = "A point on a line"
routes = ["euler-lagrange"]
[variables]
q = {{ role = "coordinate" }}
v = {{ role = "velocity", of = "q" }}
[parameters]
a = {{ default = 2 }}
[lagrangian]
l = "v^2/2 - ({formula})"
{chr(10).join(more)}
"""
    return prove_claims(spec(text))


#: Formulas that are refused, what is said, and what is written instead.
REFUSED = [
    ("q^a", "base of a power with the exponent a is q", "(q^2 + 1)^a"),
    ("a^q", "Say in [domain] that the base is > 0", "(a^2 + 1)^q"),
    ("q^(1/3)", "or a literal integer as exponent", "q^3"),
    ("sign(q - q)", "the sign of 0; expected what is not 0", "sign(q)"),
    ("v*abs(v)", "Write abs, sign, min and max of positions and parameters alone", "abs(q)"),
    ("max(v, q)", "has a kink where q - v is 0", "max(a, q)"),
    (
        "asin(2)",
        "asin of 2 is not a real number; expected an argument between -1 and 1",
        "asin(0.5)",
    ),
    ("acos(1)", "acos of 1 is written without a function", "acos(0.25)"),
    ("atan2(0, 0)", "expected a point other than the origin", "atan2(0, 1)"),
    ("q/sin(pi)", "divides by zero identically", "q/sin(pi/2)"),
    ("q/(cos(2*pi/7) + cos(4*pi/7) + cos(6*pi/7) + 0.5)", "divides by zero", "q/cos(2*pi/7)"),
    ("sinh(q, q)", "sinh is given 2 arguments", "sinh(q)"),
    ("atan2(q)", "two scalars", "atan2(q, a)"),
    ("pi*pie", "'pie' is not declared", "pi^2"),
]


@pytest.mark.parametrize(("formula", "said", "better"), REFUSED)
def test_what_has_no_value_is_refused_with_advice(formula, said, better):
    """What is written in its place loads and is proved."""
    with pytest.raises((SpecError, DerivationError, CoadjointError)) as caught:
        loaded(formula)
    assert said in str(caught.value)
    verdicts = {claim.verdict for claim in loaded(better).claims}
    assert verdicts == {Verdict.PROVED}


def test_a_domain_makes_a_base_positive():
    """The advice: a condition in [domain]."""
    certificate = loaded("q^a", '[domain]\nright = "q > 0"')
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}


#: Claims that are true on both sides of a kink or a jump, and what is false.
CLAIMED = [
    ("abs(q)", "sign(q)*q - abs(q)", Verdict.PROVED),
    ("abs(q)", "sign(q)^2", Verdict.PROVED),  # while q is not 0
    ("abs(q)", "sign(q)*v", Verdict.REFUTED),
    ("abs(q)", "v^2/2 + q", Verdict.REFUTED),
    ("max(q, 0)^2", "v^2/2 + q^2*(1 + sign(q))/2", Verdict.PROVED),
    ("max(q, 0)^2", "v", Verdict.REFUTED),
]


@pytest.mark.parametrize(("potential", "claim", "verdict"), CLAIMED)
def test_claims_say_that_they_hold_between_kinks(potential, claim, verdict):
    """What is proved of signs is proved where and while their arguments are not 0."""
    observed = f'[observables]\nfound = "{claim}"\n[claims]\nconserved = ["found"]'
    (found,) = [
        each
        for each in loaded(potential, observed).claims
        if each.statement == "found is conserved"
    ]
    assert found.verdict is verdict
    assert verdict is Verdict.REFUTED or "where and while q is not 0" in found.method


def test_nothing_is_proved_on_a_kink():
    """Where q = 0, ``sign(q)^2`` is 0, and not the 1 of its normal form."""
    field = Field(["q", "p"], slots=6)
    q, p, sign = field["q"], field["p"], field.call("sign", field["q"])
    assert decide_zero([sign**2 * p - p], field).verdict is Verdict.PROVED  # while q is not 0
    for element in (sign**2 * p - p, sign * p, sign):
        with pytest.raises(UndecidedError):
            decide_zero([element], field, Ideal(field, [q]))
    assert decide_zero([sign - 1], field, Ideal(field, [q - 3])).verdict is Verdict.PROVED
    field = Field(["q", "p"], slots=6)
    q, p = field["q"], field["p"]
    angle, turn = field.call("atan2", q, p), 4 * field.call("atan", field.one)
    assert decide_zero([angle - turn], field, Ideal(field, [q])).verdict is Verdict.REFUTED


def test_documents_write_words_as_books_do():
    """The circle's number is pi, also to a power, and functions have all their arguments."""
    field = Field(["q", "k"], slots=8)
    q, k, turn = field["q"], field["k"], 4 * field.call("atan", field.one)
    assert element_text(field, turn**2 * q / 3) == "1/3*q*pi^2"
    assert element_text(field, field.call("cos", 2 * turn / 7)) == "cos(2/7*pi)"
    assert element_text(field, field.call("atan2", q, k + 1)) == "atan2(q, k + 1)"
    shown = sympy.latex(field.to_sympy(field.call("sinh", turn * q) + field.call("sign", q)))
    assert shown == r"\sinh{\left(\pi q \right)} + \operatorname{sign}{\left(q \right)}"
