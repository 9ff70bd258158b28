"""The judge can say no: certificates that are wrong in one place, and each is caught.

The certificates are written by hand, from the text of the specs alone. The unspoiled ones pass, so
that it is the spoiling that the judge sees. The judge's own formulas are held against closed forms.
"""

import copy
import random

import pytest

from tests.adversary.algebras import constants
from tests.adversary.counts import NoGapError, rank_of
from tests.adversary.judge import judge
from tests.adversary.motion import motion_of
from tests.adversary.reader import UndefinedError, factors_of, mpf, read, value

BODY = """title = "Body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
mu = { role = "momentum" }
[parameters]
a = { positive = true, default = 2 }
[hamiltonian]
h = "mu1^2/2 + mu2^2/2 + a*mu3^2"
[domain]
upper = "mu3 > 1"
[transformations.turn]
map = { mu = "vector(-mu1, -mu2, mu3)" }
[transformations.flip]
map = { mu = "-mu" }
reverses_time = true
[claims]
casimirs = ["dot(mu, mu)", "mu1"]
conserved = ["mu3", "mu1", { integral = "mu1*mu3", where = ["(mu3 - 2)*(mu1^2 + mu2^2)"] }]
brackets = { "{mu1, mu2}" = "-mu3" }
"""


def claim(statement, kind, verdict="proved", method="normal form", **more):
    """A claim of a certificate."""
    return {"statement": statement, "kind": kind, "verdict": verdict, "method": method, **more}


# {mu1, mu2} = -mu3 and cyclic; dh/dmu = (mu1, mu2, 2 a mu3), so dmu1/dt = {mu1, h}
#   = {mu1, mu2} mu2 + {mu1, mu3} 2 a mu3 = -mu3 mu2 + mu2 2 a mu3 = (2a - 1) mu2 mu3.
GOOD = {
    "system": "body",
    "claims": [
        claim("so(3) satisfies the Jacobi identity", "algebra"),
        claim("the Poisson bracket satisfies the Jacobi identity", "jacobi"),
        claim("the energy is conserved", "conserved"),
        claim("dot(mu, mu) is a Casimir", "casimir"),
        claim(
            "mu1 is a Casimir",
            "casimir",
            "refuted",
            "exact counterexample",
            counterexample={"mu3": "2"},
            defect="2",  # {mu2, mu1} = mu3
        ),
        claim("every Casimir is a function of the one known", "casimir"),
        claim("mu3 is conserved", "conserved"),
        claim(
            "mu1 is conserved",
            "conserved",
            "refuted",
            "exact counterexample",
            counterexample={"mu2": "1/3", "mu3": "3", "a": "2"},
            defect="3",
        ),
        claim(
            "mu1*mu3 is conserved where (mu3 - 2)*(mu1^2 + mu2^2) = 0",
            "conserved",
            "refuted",
            "exact counterexample",
            counterexample={"mu1": "1", "mu2": "1", "mu3": "2", "a": "1"},
            defect="4",  # (2a - 1) mu2 mu3^2
        ),
        claim("{mu1, mu2} = -mu3", "bracket"),
        claim("turn takes the motion to itself", "transformation"),
        claim(
            "flip takes the motion to its reverse",
            "transformation",
            "numerically supported",
            "50-digit values at 20 random points",
        ),
    ],
    "findings": [],
}


def place(statement):
    """Where a claim stands."""
    return [each["statement"] for each in GOOD["claims"]].index(statement)


def spoiled(which, **changes):
    """The record with one claim changed."""
    record = copy.deepcopy(GOOD)
    record["claims"][place(which)].update(changes)
    return record


# flip: (-mu) moves with quadratic rates that are even, so -rate = -(rate): the map reverses time.
def test_a_true_certificate_passes():
    """The judge finds no fault in a correct hand-written certificate and counts every claim."""
    report = judge(BODY, GOOD)
    assert report.faults == []
    assert report.unjudged == []
    assert report.verdicts == {
        "proved": 4,
        "refuted": 3,
        "numerically supported": 1,
        "count": 1,
    }


SET = "mu1*mu3 is conserved where (mu3 - 2)*(mu1^2 + mu2^2) = 0"
FALSE = {"mu2": "1/3", "mu3": "3", "a": "2"}


@pytest.mark.parametrize(
    ("statement", "changes", "words"),
    [
        ("mu1 is conserved", {"verdict": "proved"}, "proved, but false"),
        (
            "mu1 is conserved",
            {"verdict": "numerically supported", "method": "values at 20 random points"},
            "numerically supported, but false",
        ),
        ("mu1 is a Casimir", {"verdict": "proved"}, "proved, but false"),
        (SET, {"verdict": "proved"}, "proved, but false"),
        (
            "mu3 is conserved",
            {"verdict": "refuted", "counterexample": FALSE, "defect": "3"},
            "another difference",
        ),
        (
            "dot(mu, mu) is a Casimir",
            {"verdict": "refuted", "counterexample": FALSE, "defect": "1/7"},
            "another difference",
        ),
        ("mu1 is conserved", {"defect": "-3"}, "another difference"),
        ("mu1 is conserved", {"defect": "0"}, "without a difference"),
        ("mu1 is conserved", {"defect": "v2"}, "without a difference"),
        (
            "mu1 is conserved",
            {"counterexample": {"mu2": "3", "mu3": "1/2", "a": "3/2"}},
            "outside the set or the domain",
        ),
        (
            "mu1 is conserved",
            {"counterexample": {"mu2": "1", "mu3": "3", "a": "-1"}, "defect": "-9"},
            "outside the set or the domain",
        ),
        (
            SET,
            {"counterexample": {"mu1": "1", "mu2": "1", "mu3": "3", "a": "1"}, "defect": "9"},
            "outside the set or the domain",
        ),
        (SET, {"method": "(mu3 - 2)*(mu1^2 + mu2^2) = 0 holds nowhere"}, "the set has points"),
        ("{mu1, mu2} = -mu3", {"statement": "{mu1, mu2} = mu3"}, "the claim is missing"),
        (
            "flip takes the motion to its reverse",
            {"method": "50-digit values at 0 random points"},
            "supported without a point",
        ),
        (
            "flip takes the motion to its reverse",
            {"method": "50-digit values"},
            "supported without a point",
        ),
        (
            "the energy is conserved",
            {"verdict": "refuted", "counterexample": FALSE, "defect": "1"},
            "another difference",
        ),
        (
            "so(3) satisfies the Jacobi identity",
            {"verdict": "refuted", "counterexample": {}, "defect": "1"},
            "a claim of the engine itself",
        ),
        ("mu3 is conserved", {"verdict": "perhaps"}, "unknown verdict"),
        (
            "every Casimir is a function of the one known",
            {"statement": "every Casimir is a function of the 2 known"},
            "the bracket has rank 2",
        ),
        (
            "every Casimir is a function of the one known",
            {"statement": "there are no Casimirs but constants"},
            "the bracket has rank 2",
        ),
        (
            "every Casimir is a function of the one known",
            {"statement": "2 of 1 independent Casimirs are known: luck"},
            "more are known than there are",
        ),
    ],
)
def test_a_wrong_certificate_is_detected(statement, changes, words):
    """The judge names one wrong verdict, point, difference or count."""
    faults = judge(BODY, spoiled(statement, **changes)).faults
    assert any(words in fault for fault in faults), faults


def test_a_missing_claim_is_detected():
    """A claim that the certificate leaves out is a fault."""
    record = copy.deepcopy(GOOD)
    del record["claims"][place("mu3 is conserved")]
    assert any("missing: mu3" in fault for fault in judge(BODY, record).faults)


def test_a_refutation_by_rounding_error_is_detected():
    """A difference of the size of rounding, at a point where it could have come from rounding."""
    record = spoiled(
        "mu3 is conserved",
        verdict="refuted",
        counterexample={"mu1": "1.33333333333333", "mu3": "3"},
        defect="3e-16",
    )
    assert any("rounding" in fault for fault in judge(BODY, record).faults)


FREE = """title = "Skate"
routes = ["nonholonomic"]
[variables]
q = { role = "coordinate", shape = [3] }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "dot(v, v)/2"
[constraints]
c = "v3 - q2*v1 == 0"
[claims]
conserved = ["v2", "energy"]
"""
SLEIGH = """title = "Sleigh"
routes = ["nonholonomic"]
[algebra]
name = "se(2)"
[variables]
v = { role = "velocity", block = ["P1"] }
u = { role = "velocity", block = ["P2"] }
omega = { role = "velocity", block = "rotation" }
[parameters]
m = {}
I = {}
a = {}
[lagrangian]
l = "m*(v^2 + (u + a*omega)^2)/2 + I*omega^2/2"
[constraints]
blade = "u == 0"
"""


@pytest.mark.parametrize(
    ("v", "caught"), [("0.777281587757401253796206295193", False), ("0.7773", True)]
)
def test_coordinates_of_thirty_digits_lie_on_their_set(v, caught):
    """At omega = 1/4 the set v^2 + omega^2 = 2/3 holds up to rounding, and u = 0 is not shown.

    There dv/dt = a*omega^2 = 1/32, since I + m*a^2 = 1, and v = sqrt(29/48).
    """
    where = "(m*v^2 + (I + m*a^2)*omega^2 - 1)*(energy - 1/3)"
    text = SLEIGH + f'[claims]\nconserved = [{{ integral = "v", where = ["{where}"] }}]\n'
    point = {"v": v, "omega": "0.25", "m": "1", "I": "0.75", "a": "0.5"}
    statement = f"v is conserved where {where} = 0"
    found = claim(statement, "conserved", "refuted", counterexample=point, defect="0.03125")
    faults = judge(text, {"claims": [found]}).faults
    assert any("outside the set" in fault for fault in faults) is caught
    assert bool(faults) is caught


SPACE = "integrals of degree <= {}: a space of dimension {} with constants"
#: What the certificate of the skate claims beside counts.
SKATE = (
    claim("v2 is conserved", "conserved"),
    claim("the energy is conserved", "conserved"),
)
IN_V = "2 in v1, v2"
SOME = "polynomials in v2; all are functions of v2 and of 1 more of them"
WITH_Q = "2 in v1, v2 and <= 0 in q1"


def counted(statement, kind="integrals"):
    """What the judge says of the skate with one more finding."""
    entry = {"statement": statement, "kind": kind, "method": "ranks", "scope": "x", "error": ""}
    return judge(FREE, {"claims": list(SKATE), "findings": [entry]})


@pytest.mark.parametrize(
    ("text", "caught"),
    [
        (f"{SPACE.format(IN_V, 3)}, all polynomials in v2", False),
        (f"{SPACE.format('2 in v', 4)}, all polynomials in v2, energy", False),
        (f"{SPACE.format('2 in v', 3)}, all polynomials in v2", True),
        (f"{SPACE.format(WITH_Q, 3)}, all polynomials in v2", False),
        (f"{SPACE.format(IN_V, 2)}, all polynomials in v2", True),
        (f"{SPACE.format(IN_V, 4)}, all polynomials in v2", True),
        (f"integrals of degree <= {IN_V}: none but constants", True),
        ("integrals of degree <= 0 in v1: none but constants", False),
        (f"{SPACE.format(IN_V, 3)}, 3 of it polynomials in v2; all are functions of v2", False),
        (f"{SPACE.format(IN_V, 4)}, 3 of it polynomials in v2; all are functions of v2", True),
        (f"{SPACE.format(IN_V, 4)} at the most, 3 of it {SOME}", False),
        (f"{SPACE.format(IN_V, 2)} at the most, 2 of it {SOME}", True),
        (f"{SPACE.format(IN_V, 5)} at the most, 4 of it {SOME}", True),
        (f"{SPACE.format('2 in v1, u9', 3)}, all polynomials in v2", True),
        (f"{SPACE.format(IN_V, 3)}, what a luck", True),
    ],
)
def test_the_dimension_of_a_space_of_integrals_is_counted(text, caught):
    """In v1 and v2 there are 1, v2 and v2^2; with v3 = q2 v1 also v1^2 + v3^2."""
    report = counted(text)
    assert bool(report.faults) is caught, report.faults
    assert caught or report.verdicts["integrals"] == 1


@pytest.mark.parametrize(
    ("statement", "kind", "caught"),
    [
        ("integrals: not searched further", "integrals", False),
        ("Casimirs: not searched further", "casimir", False),
        ("integrals other than energy were not searched for: no points", "integrals", False),
        ("integrals of degree <= 2 in the velocities are all known", "integrals", True),
        ("there is no further integral", "integrals", True),
        ("all Casimirs are known", "casimir", True),
    ],
)
def test_every_count_is_checked(statement, kind, caught):
    """A statement of unknown form fails, unless it says that nothing was counted."""
    report = counted(statement, kind)
    assert bool(report.faults) is caught, report.faults


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"method": "ranks; an error has a probability below 1e-9"}, "proved with luck"),
        ({"error": "1e-9"}, "proved with luck"),
        ({"method": ""}, "no method"),
    ],
)
def test_a_proved_claim_has_no_error_probability(changes, words):
    """Only findings may have an error probability."""
    faults = judge(BODY, spoiled("mu3 is conserved", **changes)).faults
    assert any(words in fault for fault in faults), faults


@pytest.mark.parametrize(
    ("statement", "changes", "caught"),
    [
        ("the motion is reversible", {}, True),
        ("the motion is reversible", {"scope": "near almost every point"}, False),
        ("the motion is reversible", {"error": "numbers at some points"}, False),
        ("the motion is reversible", {"error": "numbers", "method": ""}, True),
        ("an invariant measure was not searched for: no points", {}, False),
        ("no invariant measure was found with a density that depends on velocities", {}, False),
    ],
)
def test_a_finding_has_a_scope_or_an_error(statement, changes, caught):
    """A finding states its scope or its error probability."""
    entry = {"statement": statement, "kind": "x", "method": "ranks", "scope": "", "error": ""}
    record = copy.deepcopy(GOOD) | {"findings": [entry | changes]}
    assert bool(judge(BODY, record).faults) is caught


@pytest.mark.parametrize(("density", "caught"), [("|omega|^(-1)", False), ("|omega|", True)])
def test_invariant_measures_are_checked(density, caught):
    """The sleigh keeps dv domega/|omega|: div X = -k v, and d ln omega/dt = -k v as well."""
    text = SLEIGH + '[claims]\nconserved = ["energy"]\n'
    statement = f"an invariant measure, where its density is finite: {density} dv domega"
    record = {
        "claims": [claim("the energy is conserved", "conserved"), claim(statement, "measure")]
    }
    assert bool(judge(text, record).faults) is caught


@pytest.mark.parametrize(("energy", "caught"), [("m*a*omega*u", False), ("0*m*a*omega*u", True)])
def test_absence_of_an_invariant_measure_is_checked(energy, caught):
    """The sleigh has the divergence -k v; without its arm there is none, and 1 is a density."""
    text = SLEIGH.replace("m*(v^2 + (u + a*omega)^2)/2", f"m*(v^2 + u^2)/2 + {energy}")
    statement = "no measure rho dv domega with a constant rho is invariant on any open set: so"
    record = {
        "claims": [claim("the energy is conserved", "conserved"), claim(statement, "measure")]
    }
    report = judge(text, record)
    assert bool(report.faults) is caught, report.faults
    assert report.verdicts["no measure"] == (not caught)


def test_the_reader_knows_quaternions_and_poses():
    """A third of a turn about (1, 1, 1) takes the axes into each other; i j = k, j i = -k."""
    turn = [mpf(1) / 2] * 4
    g = [[mpf(0), mpf(0), mpf(1), mpf(7)], [mpf(1), mpf(0), mpf(0), mpf(8)]]
    g.append([mpf(0), mpf(1), mpf(0), mpf(9)])
    names = {"q": turn, "g": g, "v": [mpf(1), mpf(2), mpf(3)]}
    for text, expected in {
        "rotate(q, v)": [3, 1, 2],
        "rotate(conjugate(q), v)": [2, 3, 1],
        "rotation(q)*v": [3, 1, 2],
        "rotation(g)*v + translation(g)": [10, 9, 11],
        "qmul(vector(0, 1, 0, 0), vector(0, 0, 1, 0))": [0, 0, 0, 1],
        "qmul(vector(0, 0, 1, 0), vector(0, 1, 0, 0))": [0, 0, 0, -1],
        "qmul(q, qmul(q, q))": [-1, 0, 0, 0],
        "qmul(q, conjugate(q))": [1, 0, 0, 0],
    }.items():
        assert value(read(text), names) == expected, text


def test_the_reader_knows_the_language():
    """Precedence, powers, vectors and functions, against closed forms."""
    names = {"x": mpf(2), "a": [mpf(1), mpf(2), mpf(3)], "b": [mpf(0), mpf(1), mpf(-1)]}
    for text, expected in {
        "-x^2": -4,
        "2*x^(-1) + 1/4": mpf(5) / 4,
        "x**3 - 2*-x": 12,
        "dot(a, b)": -1,
        "cross(a, b)[1]": None,
        "norm(b)^2": 2,
        "trace(outer(a, b))": -1,
        "det(rows(a, b, cross(a, b)))": 27,
        "exp(log(x)) + 1.5": mpf(7) / 2,
        "a[2]*x": 4,
    }.items():
        if expected is None:
            with pytest.raises(ValueError, match="no formula"):
                read(text)
        else:
            assert abs(value(read(text), names) - expected) < mpf(10) ** -45, text
    # a x b of (1, 2, 3) and (0, 1, -1) is (-5, 1, 1)
    assert value(read("cross(a, b)"), names) == [-5, 1, 1]
    assert value(read("hat(a)*b"), names) == [-5, 1, 1]
    assert value(read("inverse(diag(a))*a"), names) == [1, 1, 1]
    with pytest.raises(UndefinedError):
        value(read("sqrt(1 - x)"), names)
    assert factors_of(read("-2*x^2*(a + b)")) == [read("x"), read("a + b")]


def test_the_constants_of_so3_are_those_of_the_cross_product():
    """[J1, J2] = J3 and cyclic."""
    _, c = constants("so(3)", {})
    assert [[[int(x) for x in row] for row in plane] for plane in c] == [
        [[0, 0, 0], [0, 0, 1], [0, -1, 0]],
        [[0, 0, -1], [0, 0, 0], [1, 0, 0]],
        [[0, 1, 0], [-1, 0, 0], [0, 0, 0]],
    ]


def test_the_rates_are_those_of_euler():
    """dmu1/dt = (2a - 1) mu2 mu3 as above; d mu3/dt = 0."""
    motion = motion_of(BODY)
    point = {"mu1": mpf(1), "mu2": mpf(2), "mu3": mpf(3), "a": mpf(5)}
    rates = motion.rates(point)
    assert abs(rates["mu1"] - 54) < mpf(10) ** -25
    assert abs(rates["mu2"] + 27) < mpf(10) ** -25
    assert abs(rates["mu3"]) < mpf(10) ** -25


def test_the_accelerations_are_those_of_a_sleigh():
    """Chaplygin 1911: dv/dt = a omega^2, domega/dt = -m a v omega/(I + m a^2)."""
    motion = motion_of(SLEIGH)
    point = dict.fromkeys(["v", "u", "omega", "m", "I", "a"], mpf(0))
    point |= {"v": mpf(3), "omega": mpf(2), "m": mpf(5), "I": mpf(7), "a": mpf(1) / 2}
    rates = motion.rates(point)
    assert abs(rates["v"] - 2) < mpf(10) ** -25
    assert abs(rates["omega"] + mpf(15) / (7 + mpf(5) / 4)) < mpf(10) ** -25
    assert abs(rates["u"]) < mpf(10) ** -25


def test_points_of_a_product_lie_on_every_branch():
    """Of (mu3 - 2) (mu1^2 + mu2^2) = 0 the plane is found, and of mu1 mu2 = 0 both planes."""
    motion = motion_of(BODY.replace('upper = "mu3 > 1"', 'upper = "mu3 < 9"'))
    found = list(motion.points(random.Random(3), ("mu1*mu2",), 12))
    assert {n for point in found for n in ("mu1", "mu2") if not abs(point[n]) > 1e-30} == {
        "mu1",
        "mu2",
    }


def test_ranks_need_a_gap_in_the_singular_values():
    """A rank is given only where the singular values have a clear gap."""
    assert rank_of([[1, 2], [2, 4]]) == 1
    assert rank_of([[1, 2], [2, 5]]) == 2
    with pytest.raises(NoGapError):
        rank_of([[1, 1], [1, 1 + 1e-7]])


@pytest.mark.parametrize(("more", "caught"), [("", False), (" + q/1000", True)])
def test_lost_digits_are_not_a_counterexample(more, caught):
    """``sqrt(exp(2x) + 1 + 2 exp(x)) = exp(x) + 1``, and at x = 200 p no 50 digits show it."""
    hidden = "sqrt(exp(400*p) + 1 + 2*exp(200*p)) - exp(200*p) - 1"
    text = f"""title = "Particle"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = {{ role = "coordinate" }}
p = {{ role = "coordinate" }}
[hamiltonian]
h = "p^2/2"
[claims]
conserved = ["p + q*({hidden}){more}"]
"""
    record = {"claims": [claim(f"p + q*({hidden}){more} is conserved", "conserved")]}
    faults = judge(text, record).faults
    assert any("but false" in fault for fault in faults) == caught, faults
