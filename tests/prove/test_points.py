"""Points: claims are looked at where they have values, and a number of points is one of points."""

import math
import re
from fractions import Fraction

import mpmath
import pytest

from coadjoint.exact import Condition, Field, Region
from coadjoint.prove import Verdict
from coadjoint.prove import zero as deciding
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.points import DIGITS, Branch, Points
from coadjoint.prove.zero import UndecidedError, decide_zero
from tests.solve.domains import KEPLER
from tests.specs import prove_claims, spec

PLANE = """
title = "A particle in a plane"
routes = ["poisson"]
[poisson]
canonical = [["q1", "p1"], ["q2", "p2"]]
[variables]
q1 = { role = "coordinate" }
q2 = { role = "coordinate" }
p1 = { role = "coordinate" }
p2 = { role = "coordinate" }
[parameters]
a = { positive = true, default = 1 }
[hamiltonian]
h = "H"
[domain]
DOMAIN
[claims]
conserved = ["CLAIM"]
"""


def claimed(h, claim, *domain):
    """The claim that something is conserved, in a domain."""
    lines = "\n".join(f'condition{n} = "{each}"' for n, each in enumerate(domain))
    text = PLANE.replace('h = "H"', f'h = "{h}"').replace("DOMAIN", lines)
    claims = prove_claims(spec(text.replace("CLAIM", claim))).claims
    (found,) = (each for each in claims if each.statement == f"{claim} is conserved")
    return found


def at(claim):
    """The point of a refutation as real numbers."""
    return {name: float(Fraction(value)) for name, value in claim.counterexample.items()}


FREE = "p1^2/2 + p2^2/2"


@pytest.mark.parametrize(
    ("claim", "rate", "inside"),
    [
        (
            "q1*sqrt(q1 - 100)",
            lambda x: x["p1"] * (math.sqrt(x["q1"] - 100) + x["q1"] / 2 / math.sqrt(x["q1"] - 100)),
            lambda x: x["q1"] > 100,
        ),
        ("q1 + log(-q1 - 5000)", None, lambda x: x["q1"] < -5000),
        ("q1 + log(q1 - 1000000)", None, lambda x: x["q1"] > 10**6),
        ("q1*sqrt(q1 - 1.99)*log(2 - q1)", None, lambda x: 1.99 < x["q1"] < 2),
        (
            "q1 + sqrt(1 - q1^2 - q2^2 - p1^2)",
            None,
            lambda x: x["q1"] ** 2 + x["q2"] ** 2 + x["p1"] ** 2 < 1,
        ),
        ("q1 + log(log(q1))", None, lambda x: x["q1"] > 1),
        ("q1 + sqrt(sqrt(q1 - 50) - 10)", None, lambda x: x["q1"] > 150),
    ],
)
def test_a_false_claim_is_refuted_where_it_has_a_value(claim, rate, inside):
    """Wherever its functions live: points are moved there, and the number shown is the value."""
    found = claimed(FREE, claim)
    assert found.verdict is Verdict.REFUTED
    point = at(found)
    assert inside(point)
    if rate is not None:
        assert float(Fraction(found.defect)) == pytest.approx(rate(point), rel=1e-12)


@pytest.mark.parametrize(
    "claim", ["sqrt(-1 - q1^2)", "p1*log(-a)", "sqrt(-1 - p1^2)", "log(0*q1 - 1)"]
)
def test_a_claim_without_real_values_is_not_decided(claim):
    """Neither p1 as a factor nor a rate of 0 makes it true, nor is it supported at 20 points."""
    with pytest.raises(UndecidedError, match="no point is found at which it has a value"):
        claimed(FREE, claim)


def test_a_casimir_without_real_values_is_not_decided():
    """A constant of functions that are nowhere real says nothing."""
    text = PLANE.replace('h = "H"', f'h = "{FREE}"').replace("[domain]\nDOMAIN\n", "")
    with pytest.raises(UndecidedError, match="is a Casimir: no point is found"):
        prove_claims(spec(text.replace('conserved = ["CLAIM"]', 'casimirs = ["sqrt(-1 - a^2)"]')))


def test_a_true_claim_of_a_domain_is_not_refuted_outside():
    """Where q > 0 the energy p^2/2 + sqrt(q^2) is p^2/2 + q; elsewhere it is not."""
    h = "p1^2/2 + sqrt(q1^2)"
    assert claimed(h, "p1^2/2 + q1", "q1 > 0").verdict is not Verdict.REFUTED
    assert claimed(h, "p1^2/2 + q1", "2 < q1", "q1 < 3").verdict is not Verdict.REFUTED
    for domain in ([], ["q1 < 0"], ["q1 > -1/10", "q1 < 1/10"]):
        found = claimed(h, "p1^2/2 + q1", *domain)
        assert found.verdict is Verdict.REFUTED
        assert at(found).get("q1", -1) < 0


INSIDE = {
    "q1 > 1000": lambda x: x["q1"] > 1000,
    "q1 < -1000": lambda x: x["q1"] < -1000,
    "p1 > 7": lambda x: x["p1"] > 7,
    "q1^2 + q2^2 < 0.0001": lambda x: x["q1"] ** 2 + x["q2"] ** 2 < 1e-4,
    "q1*q2 > 50": lambda x: x["q1"] * x["q2"] > 50,
    "q1 + q2 < -30": lambda x: x["q1"] + x["q2"] < -30,
    "q1 > 100*a": lambda x: x["q1"] > 100 * x["a"],
    "p1^2/2 + p2^2/2 < q1": lambda x: x["p1"] ** 2 / 2 + x["p2"] ** 2 / 2 < x["q1"],
    "sqrt(q1) > 40": lambda x: x["q1"] > 1600,
    "cos(q1) > 0.999": lambda x: math.cos(x["q1"]) > 0.999,
    "q1 > 5": lambda x: x["q1"] > 5,
}


@pytest.mark.parametrize(
    "domain",
    [
        ["q1 > 1000"],
        ["q1 < -1000", "p1 > 7"],
        ["q1^2 + q2^2 < 0.0001"],
        ["q1*q2 > 50", "q1 + q2 < -30"],
        ["q1 > 100*a", "p1 > 7"],
        ["p1^2/2 + p2^2/2 < q1"],
        ["sqrt(q1) > 40"],
        ["cos(q1) > 0.999", "q1 > 5"],
    ],
)
def test_points_of_refutations_lie_in_the_domain(domain):
    """A false claim is refuted at a point where every condition of [domain] holds."""
    claim = "q1*q2*p1*p2*a + q1^2 + q2^2"  # whose rate depends on all that is drawn
    found = claimed(FREE, claim, *domain)
    assert found.verdict is Verdict.REFUTED
    assert all(INSIDE[each](at(found)) for each in domain)


def test_conditions_on_momenta_hold_for_what_is_written_in_velocities():
    """The straight fall of Kepler's problem beyond r > closest, and a false claim about it."""
    text = KEPLER.replace('apart = "r > closest"', 'fast = "p > 50*m"\nfar = "r > 1000"')
    claims = prove_claims(spec(text + '\n[claims]\nconserved = ["p"]\n')).refuted
    (found,) = (each for each in claims if each.statement == "p is conserved")
    point = at(found)
    assert point["r"] > 1000
    assert float(Fraction(found.defect)) == pytest.approx(-point["k"] / point["r"] ** 2)


def test_a_number_of_points_is_that_of_values(monkeypatch):
    """A nested root is zero at each point that counts, and these are counted."""
    monkeypatch.setattr(deciding, "POINTS", 7)
    field = Field(["x"], slots=4)
    x = field["x"]
    root = field.call("sqrt", x**2 + 2 * field.call("sqrt", x**2 + 1) + 2)  # 1 + sqrt(x^2 + 1)
    hidden = root - 1 - field.call("sqrt", x**2 + 1)
    assert not field.is_zero(hidden), "choose one that the field does not know"
    seen = []
    value = deciding._value
    monkeypatch.setattr(deciding, "_value", lambda *each: seen.append(value(*each)) or seen[-1])
    decision = decide_zero([hidden], field)
    assert decision.verdict is Verdict.SUPPORTED
    (count,) = map(int, re.findall(r"at (\d+) random points", decision.method))
    assert count == 7 == sum(each is not None for each in seen)


def test_a_zero_of_the_last_digits_is_no_refutation_and_a_tiny_value_is_one():
    """What cancels to 30 digits is zero to working precision; 10^-20 beside 1 is not."""
    field = Field(["x"], slots=2)
    x = field["x"]
    sine = field.call("sin", x)
    tiny = field.number(Fraction(1, 10**20))
    assert decide_zero([sine * tiny], field).verdict is Verdict.REFUTED
    assert decide_zero([sine + tiny - sine], field).verdict is Verdict.REFUTED


@pytest.mark.parametrize(
    ("relation", "residual"),
    [
        (lambda x, y: x**2 + y**2 - 1, lambda x, y: x**2 + y**2 - 1),
        (lambda x, y: x**2 - 2 * y**2, lambda x, y: x**2 - 2 * y**2),
        (lambda x, y: x**3 + y**3 - 5 * x * y, lambda x, y: x**3 + y**3 - 5 * x * y),
        (
            lambda x, y: (x**2 + y**2 - 1) ** 2 - x**2 * y**3,
            lambda x, y: (x**2 + y**2 - 1) ** 2 - x**2 * y**3,
        ),
    ],
)
def test_points_of_a_zero_set_lie_on_it(relation, residual):
    """To working precision, also where nothing is linear; and in the domain."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    field.region = Region(conditions=(Condition(x - y, strict=True),))
    (branch,) = Ideal(field, [relation(x, y)], "these = 0").branches
    points = [point for point, _ in zip(Points(field, [x, y], branch), range(5), strict=False)]
    assert len(points) == 5
    for point in points:
        with mpmath.workdps(2 * DIGITS):
            assert abs(residual(point["x"], point["y"])) < mpmath.mpf(10) ** (20 - DIGITS)
            assert point["x"] > point["y"]


def test_points_that_would_lie_off_the_set_are_not_points():
    """The check above can fail: nothing is found on a set without real points."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    nowhere = Branch(rest=(x**4 + y**4 - x * y + 5,))
    assert not list(Points(field, [x], nowhere))


#: An odd order and an even one are tried in every run; each takes four seconds.
ZEROS = [(order, function) for function in ("exp", "log") for order in (5, 6, 7, 9)]


@pytest.mark.parametrize(
    ("order", "function"),
    [
        pytest.param(*zero, marks=() if zero in ((5, "exp"), (6, "log")) else pytest.mark.campaign)
        for zero in ZEROS
    ],
)
def test_a_zero_of_high_order_is_not_missed_by_a_little(order, function):
    """Newton's steps become small beside such a zero, too; what vanishes at it is not refuted."""
    field = Field(["x", "y"], slots=2)
    x, y = field["x"], field["y"]
    if function == "exp":  # exp(x) less its Taylor polynomial, of the sign of x^order
        least = field.call("exp", x)
        terms = [-(x**k) * Fraction(1, math.factorial(k)) for k in range(order)]
    else:  # log(1 + x^2) - x^2 + ..., the same in x^2
        least = field.call("log", 1 + x**2)
        terms = [x ** (2 * k) * Fraction((-1) ** k, k) for k in range(1, order - 2)]
    relation = field.sum([least, *terms])
    try:
        decision = decide_zero([x * y], field, Ideal(field, [relation], "this = 0"))
    except UndecidedError:
        return
    assert decision.verdict is Verdict.SUPPORTED


def test_redundant_relations_are_no_obstacle():
    """An orthogonal matrix satisfies nine equations of which six are independent."""
    names = [f"A{n}" for n in range(9)]
    field = Field(names)
    rows = [[field[name] for name in names[k : k + 3]] for k in (0, 3, 6)]
    relations = [
        field.sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) - (1 if i == j else 0)
        for i in range(3)
        for j in range(3)
    ]
    points = Points(field, [field["A0"]], Branch(rest=tuple(relations)))
    point = next(iter(points))
    with mpmath.workdps(DIGITS):
        size = max(abs(points.value(each, point)) for each in relations)
    assert size < mpmath.mpf(10) ** (20 - DIGITS)


def test_remainders_keep_functions():
    """sin(q1)^2 where sin(q1) = q2 is q2^2, and log(q1)*q2 is no multiple of q2 - 1 alone."""
    field = Field(["q1", "q2"], slots=4)
    q1, q2 = field["q1"], field["q2"]
    sine, log = field.call("sin", q1), field.call("log", q1)
    where = Ideal(field, [sine - q2], "sin(q1) = q2")
    assert where.contains(sine - q2)
    assert where.contains(sine**2 - q2**2)
    assert where.contains(1 - field.call("cos", q1) ** 2 - q2**2)
    assert not where.contains(sine)
    assert field.is_zero(where.remainder(sine) - where.remainder(q2))
    unit = Ideal(field, [q2 - 1], "q2 = 1")
    assert field.is_zero(unit.remainder(log * q2) - log)
    assert decide_zero([sine - q2], field, where).verdict is Verdict.PROVED
    refuted = decide_zero([log * q2], field, unit)
    value = math.log(Fraction(refuted.point["q1"]))
    assert float(refuted.point["q2"]) == 1
    assert float(Fraction(refuted.defect)) == pytest.approx(value, rel=1e-14)


def test_the_difference_of_a_refutation_is_that_of_the_claim():
    """On the circle c^2 + s^2 = 1 the value of c^3/s - c is shown, not that of a remainder."""
    field = Field(["c", "s"])
    c, s = field["c"], field["s"]
    circle = Ideal(field, [c**2 + s**2 - 1], "c^2 + s^2 = 1")
    found = decide_zero([c**3 / s - c], field, circle)
    x, y = (float(Fraction(found.point[name])) for name in "cs")
    assert float(Fraction(found.defect)) == pytest.approx(x**3 / y - x, rel=1e-9)
