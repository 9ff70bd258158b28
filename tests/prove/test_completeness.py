"""Completeness: Casimirs that a spec leaves out are found, and what cannot be found is told."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import prove
from coadjoint.prove.completeness import bracket_of, completeness, described, independent
from tests.derive.test_nambu import FOUR
from tests.specs import RIGID_BODY, shipped, spec

CLAIM = 'casimirs  = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]'
#: [e1, e2] = e2, [e1, e3] = a e3 has the Casimir e3/e2^a, which is rational for no general a.
SPIRAL = """
title = "one scaling, two weights"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
[algebra.brackets]
"[e1, e2]" = "e2"
"[e1, e3]" = "{a}*e3"
[variables]
mu = { role = "momentum" }
[parameters]
a = { default = 3 }
[hamiltonian]
h = "a*dot(mu, mu)/2"
"""


def heavy_top(claim):
    """The heavy top with other claims about Casimirs."""
    return spec(shipped("heavy_top").path.read_text(), (CLAIM, claim))


def about_casimirs(certificate):
    """Statements of the claims about Casimirs, in order."""
    return [claim.statement for claim in certificate.claims if claim.kind == "casimir"]


def spiral(weight):
    """The spec with a weight put in."""
    return spec(SPIRAL.replace("{a}", weight))


def test_all_claimed_casimirs_are_counted():
    """As many as dimension minus rank: nothing is searched."""
    assert about_casimirs(prove(shipped("heavy_top"))) == [
        "dot(Gamma, Gamma) is a Casimir",
        "dot(Pi, Gamma) is a Casimir",
        "every Casimir is a function of the 2 known",
    ]


@pytest.mark.parametrize(
    ("claimed", "missing"),
    [
        ("dot(Pi, Gamma)", "Gamma1^2 + Gamma2^2 + Gamma3^2 is a Casimir"),
        ("dot(Gamma, Gamma)", "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 is a Casimir"),
    ],
)
def test_a_casimir_left_out_is_found_and_proved(claimed, missing):
    """Under the names of the state, beside the one that is claimed."""
    certificate = prove(heavy_top(f'casimirs = ["{claimed}"]'))
    assert certificate.holds
    assert about_casimirs(certificate) == [
        f"{claimed} is a Casimir",
        missing,
        "every Casimir is a function of the 2 known",
    ]


def test_without_claims_all_are_found():
    """Two of them, independent of one another."""
    found = completeness(derive(heavy_top("casimirs = []")))
    assert (len(found.found), found.known, found.expected, found.missing) == (2, 2, 2, "")


def test_functions_of_one_casimir_count_once():
    """(Gamma.Gamma)^2 beside Gamma.Gamma is no second one."""
    claim = 'casimirs = ["dot(Gamma, Gamma)", "dot(Gamma, Gamma)^2 + 1"]'
    certificate = prove(heavy_top(claim))
    assert certificate.holds
    statements = about_casimirs(certificate)
    assert statements[2:] == [
        "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 is a Casimir",
        "every Casimir is a function of the 2 known",
    ]


@pytest.mark.parametrize("wrong", ["dot(Pi, Pi)", "dot(Pi, Gamma) + Pi1", "g"])
def test_a_wrong_claim_is_refuted_whatever_the_count(wrong):
    """A function that does not commute is refuted; a constant does, and counts for nothing."""
    certificate = prove(heavy_top(f'casimirs = ["dot(Gamma, Gamma)", "{wrong}"]'))
    refuted = [claim.statement for claim in certificate.refuted]
    assert refuted == ([] if wrong == "g" else [f"{wrong} is a Casimir"])
    assert ("Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 is a Casimir" in about_casimirs(certificate)) is (
        wrong == "g"
    )


def test_a_bracket_without_casimirs_says_so():
    """aff(1) has rank 2."""
    assert about_casimirs(prove(shipped("affine_line"))) == ["there are no Casimirs but constants"]


def test_one_casimir_is_told_in_the_singular():
    """The rigid body's sphere, found."""
    certificate = prove(spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', "")))
    assert about_casimirs(certificate) == [
        "Pi1^2 + Pi2^2 + Pi3^2 is a Casimir",
        "every Casimir is a function of the one known",
    ]


def test_the_functions_of_a_nambu_bracket_need_no_search():
    """They are Casimirs even where parameters forbid a search."""
    assert about_casimirs(prove(spec(FOUR, ("x1^2/2", "k*x1^2/2")))) == [
        "1/2*x1^2*k + x2*x4 is a Casimir",
        "1/2*x1^2 + 1/2*x2^2 + 1/2*x3^2 + 1/2*x4^2 is a Casimir",
        "every Casimir is a function of the 2 known",
    ]


# -- what cannot be found -------------------------------------------------------------------------


def test_a_rational_casimir_is_found_for_a_weight_that_is_a_number():
    """mu3/mu2^3 of weights 1 and 3: a quotient of semi-invariants."""
    certificate = prove(spiral("3"))
    assert certificate.holds
    assert about_casimirs(certificate)[-1] == "every Casimir is a function of the one known"
    assert completeness(derive(spiral("3"))).known == 1


def test_a_casimir_that_a_parameter_hides_is_missing_and_told():
    """With a weight that is a parameter there is no search; the certificate names the bracket."""
    certificate = prove(spiral("a"))
    assert certificate.holds
    (statement,) = about_casimirs(certificate)
    assert statement.startswith("0 of 1 independent Casimirs are known: they were not looked for")
    assert "[e1, e3]" in statement
    assert "a; expected rational numbers" in statement


def test_a_table_with_parameters_is_not_searched_and_says_so():
    """A declared bracket k x3: the message names the parameter; a claim is proved all the same."""
    text = """
title = "a table"
routes = ["poisson"]
[poisson.brackets]
"{x1, x2}" = "k*x3"
"{x2, x3}" = "x1"
"{x3, x1}" = "x2"
[variables]
x = { role = "coordinate", shape = [3] }
[parameters]
k = { default = 1 }
[hamiltonian]
h = "x1^2"
"""
    (statement,) = about_casimirs(prove(spec(text)))
    assert statement.startswith("0 of 1 independent Casimirs are known")
    assert "'k' is no coordinate" in statement
    claimed = text + '[claims]\ncasimirs = ["x1^2 + x2^2 + k*x3^2"]\n'
    assert about_casimirs(prove(spec(claimed)))[1:] == [
        "every Casimir is a function of the one known"
    ]
    assert prove(spec(claimed, ("x2^2 + k", "x2^2 - k"))).refuted


def test_a_casimir_of_a_higher_degree_is_missing_and_told():
    """X1 X2 - X3^2 has degree 2: a search up to degree 1 says how far it looked."""
    text = shipped("sp2_momentum").path.read_text()
    equations = derive(spec(text, ('casimirs  = ["X1*X2 - X3^2"]', "casimirs = []")))
    found = completeness(equations, degree=1)
    assert (found.found, found.known, found.expected) == ((), 0, 1)
    assert found.statement.startswith("0 of 1 independent Casimirs are known: 1 not found")
    assert "degree 1" in found.statement
    assert completeness(equations, degree=2).statement.startswith("every Casimir")


def test_a_search_that_is_too_large_is_told():
    """Too many monomials of too many coordinates: counted, not tried."""
    text = """
title = "much"
routes = ["lie-poisson"]
[algebra]
direct_sum = ["so(3)", "R^30"]
[variables]
mu = { role = "momentum" }
[hamiltonian]
h = "mu1^2"
"""
    (statement,) = about_casimirs(prove(spec(text)))
    assert statement.startswith("0 of 31 independent Casimirs are known: they were not looked for")
    assert "expected at most 20000 (MONOMIALS)" in statement


# -- parts ----------------------------------------------------------------------------------------


def test_independence_is_of_gradients():
    """x, y and x y: the third depends on the first two; constants have no gradient."""
    setting = make_setting(spec())
    structure = bracket_of(derive(spec(), setting=setting))
    x, y = setting.field["Pi1"], setting.field["Pi2"]
    assert independent(structure, [setting.field.one, x, y, x * y]) == [x, y]
    assert independent(structure, [x * y, x, y**2]) == [x * y, x]


def test_a_long_casimir_is_described_by_its_size():
    """A statement stays readable: the number of terms and the first one."""
    field = make_setting(shipped("so8_body")).field
    whole = sum((field[name] for name in field.names[:28]), field.zero) ** 2
    text = described(field, whole)
    assert text == f"a function with {28 * 29 // 2} terms that begins with M12^2"
    assert described(field, field["M12"]) == "M12"


@pytest.mark.parametrize(("function", "verdict"), [("exp", "proved"), ("log", "numerically")])
def test_ranks_with_functions_are_proved_where_these_are_rational(function, verdict):
    """A mass exp(x) is 1 at x = 0, so that no Casimir is proved; log(x) is known by numbers."""
    text = f"""
title = "a mass that depends on the place"
routes = ["euler-lagrange"]
[variables]
x = {{ role = "coordinate" }}
v = {{ role = "velocity", of = "x" }}
[lagrangian]
l = "{function}(x)*v^2/2"
"""
    claims = {claim.statement: claim for claim in prove(spec(text)).claims}
    none = claims["there are no Casimirs but constants"]
    assert none.verdict.value.startswith(verdict)
    assert ("50-digit" in none.method) == (function == "log")
