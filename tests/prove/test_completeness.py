"""Completeness: Casimirs that a spec leaves out are found, and what cannot be found is told."""

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.poisson.casimirs import select_independent
from coadjoint.prove.completeness import ALMOST, IN_PART, bracket_of, completeness, describe
from coadjoint.prove.zero import Decision, Discovery
from tests.derive.test_nambu import FOUR
from tests.specs import RIGID_BODY, prove_claims, shipped, spec

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
    """Statements about Casimirs, the claims before the findings."""
    entries = (*certificate.claims, *certificate.findings)
    return [entry.statement for entry in entries if entry.kind == "casimir"]


def spiral(weight):
    """The spec with a weight put in."""
    return spec(SPIRAL.replace("{a}", weight))


def test_all_claimed_casimirs_are_counted():
    """As many as dimension minus rank: nothing is searched."""
    assert about_casimirs(prove_claims(shipped("heavy_top"))) == [
        "dot(Gamma, Gamma) is a Casimir",
        "dot(Pi, Gamma) is a Casimir",
        f"every Casimir is a function of the 2 known, {ALMOST}",
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
    certificate = prove_claims(heavy_top(f'casimirs = ["{claimed}"]'))
    assert certificate.holds
    assert about_casimirs(certificate) == [
        f"{claimed} is a Casimir",
        missing,
        f"every Casimir is a function of the 2 known, {ALMOST}",
    ]


def test_without_claims_all_are_found():
    """Two of them, independent of one another."""
    found = completeness(derive(heavy_top("casimirs = []")))
    assert (len(found.found), found.known, found.expected, found.missing) == (2, 2, 2, "")


def test_functions_of_one_casimir_count_once():
    """(Gamma.Gamma)^2 beside Gamma.Gamma is no second one."""
    claim = 'casimirs = ["dot(Gamma, Gamma)", "dot(Gamma, Gamma)^2 + 1"]'
    certificate = prove_claims(heavy_top(claim))
    assert certificate.holds
    statements = about_casimirs(certificate)
    assert statements[2:] == [
        "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 is a Casimir",
        f"every Casimir is a function of the 2 known, {ALMOST}",
    ]


@pytest.mark.parametrize("wrong", ["dot(Pi, Pi)", "dot(Pi, Gamma) + Pi1", "g"])
def test_a_wrong_claim_counts_for_nothing(wrong):
    """A function that does not commute is refuted, a constant does: the second one is found."""
    certificate = prove_claims(heavy_top(f'casimirs = ["dot(Gamma, Gamma)", "{wrong}"]'))
    refuted = [claim.statement for claim in certificate.refuted]
    assert refuted == ([] if wrong == "g" else [f"{wrong} is a Casimir"])
    assert about_casimirs(certificate)[2:] == [
        "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 is a Casimir",
        f"every Casimir is a function of the 2 known, {ALMOST}",
    ]


def test_two_wrong_claims_complete_nothing():
    """On se(3)* two claims of which none holds leave two Casimirs to be found."""
    certificate = prove_claims(heavy_top('casimirs = ["dot(Pi, Pi)", "Gamma1"]'))
    assert len(certificate.refuted) == 2
    found = completeness(derive(heavy_top('casimirs = ["dot(Pi, Pi)", "Gamma1"]')), degree=1)
    assert (found.known, found.expected, found.found) == (0, 2, ())


def test_a_bracket_without_casimirs_says_so():
    """aff(1) has rank 2."""
    assert about_casimirs(prove_claims(shipped("affine_line"))) == [
        f"there are no Casimirs but constants, {ALMOST}"
    ]


def test_one_casimir_is_told_in_the_singular():
    """The rigid body's sphere, found."""
    certificate = prove_claims(spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', "")))
    assert about_casimirs(certificate) == [
        "Pi1^2 + Pi2^2 + Pi3^2 is a Casimir",
        f"every Casimir is a function of the one known, {ALMOST}",
    ]


def test_the_functions_of_a_nambu_bracket_need_no_search():
    """They are Casimirs even where parameters forbid a search."""
    assert about_casimirs(prove_claims(spec(FOUR, ("x1^2/2", "k*x1^2/2")))) == [
        "1/2*x1^2*k + x2*x4 is a Casimir",
        "1/2*x1^2 + 1/2*x2^2 + 1/2*x3^2 + 1/2*x4^2 is a Casimir",
        f"every Casimir is a function of the 2 known, {ALMOST}, for almost all parameters",
    ]


# -- what cannot be found -------------------------------------------------------------------------


def test_a_rational_casimir_is_found_for_a_weight_that_is_a_number():
    """mu3/mu2^3 of weights 1 and 3: a quotient of semi-invariants."""
    certificate = prove_claims(spiral("3"))
    assert certificate.holds
    assert (
        about_casimirs(certificate)[-1] == f"every Casimir is a function of the one known, {ALMOST}"
    )
    assert completeness(derive(spiral("3"))).known == 1


def test_a_casimir_that_a_parameter_hides_is_missing_and_told():
    """Mu3/mu2^a is no polynomial; the certificate says what was searched."""
    certificate = prove_claims(spiral("a"))
    assert certificate.holds
    (statement,) = about_casimirs(certificate)
    assert statement.startswith(
        "0 of 1 independent Casimirs are known: 1 not found among polynomials of degree <= "
    )
    assert "at random parameters" in statement
    (finding,) = (f for f in certificate.findings if f.kind == "casimir")
    assert finding.scope == f"{ALMOST}, for almost all parameters"
    assert "probability below" in finding.error


def test_a_table_with_parameters_is_searched():
    """A declared bracket k x3: the coefficient of x3^2 is k; a claim is proved all the same."""
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
    assert about_casimirs(prove_claims(spec(text))) == [
        "x1^2 + x2^2 + x3^2*k is a Casimir",
        f"every Casimir is a function of the one known, {ALMOST}, for almost all parameters",
    ]
    claimed = text + '[claims]\ncasimirs = ["x1^2 + x2^2 + k*x3^2"]\n'
    assert about_casimirs(prove_claims(spec(claimed)))[1:] == [
        f"every Casimir is a function of the one known, {ALMOST}, for almost all parameters"
    ]
    assert prove_claims(spec(claimed, ("x2^2 + k", "x2^2 - k"))).refuted


def test_a_casimir_of_a_higher_degree_is_missing_and_told():
    """X1 X2 - X3^2 has degree 2: a search up to degree 1 says how far it looked."""
    text = shipped("sp2_momentum").path.read_text()
    equations = derive(spec(text, ('casimirs  = ["X1*X2 - X3^2"]', "casimirs = []")))
    found = completeness(equations, degree=1)
    assert (found.found, found.known, found.expected) == ((), 0, 1)
    assert found.statement == (
        "0 of 1 independent Casimirs are known: 1 not found among all polynomials of degree <= 1 "
        "and products of powers of semi-invariants of degree <= 1; every polynomial Casimir "
        "of degree <= 1 is constant"
    )
    assert isinstance(found.decision, Discovery)
    whole = completeness(equations, degree=2)
    assert whole.statement == f"every Casimir is a function of the one known, {ALMOST}"
    assert isinstance(whole.decision, Decision)


def test_a_search_that_is_too_large_is_made_to_a_lower_degree():
    """so(6) with six vectors, 51 coordinates: degree 3 and 4 are not searched, and that is told."""
    text = f"""
title = "much"
routes = ["lie-poisson"]
[algebra]
name = "so(6)"
[variables]
mu = {{ role = "momentum" }}
{"".join(f'a{n} = {{ role = "advected", representation = "vector" }}' + chr(10) for n in range(6))}
[hamiltonian]
h = "mu1^2"
"""
    *proved, counted = about_casimirs(prove_claims(spec(text)))
    assert len(proved) == 21  # the products of two vectors
    assert counted == f"every Casimir is a function of the 21 known, {ALMOST}"
    found = completeness(derive(spec(text)), degree=1)
    assert (found.known, found.expected) == (0, 21)


SPINS = """
title = "spins"
routes = ["lie-poisson"]
[algebra]
direct_sum = [SUMMANDS]
[variables]
mu = { role = "momentum" }
[hamiltonian]
h = "mu1^2"
"""


def spins(*summands):
    """A system on the dual of a direct sum."""
    return spec(SPINS.replace("SUMMANDS", ", ".join(f'"{name}"' for name in summands)))


def test_each_of_twenty_spins_has_its_own_casimir():
    """The squares of the spins, and nothing else: no power sums of them."""
    squares = (" + ".join(f"mu{3 * n + i}^2" for i in (1, 2, 3)) for n in range(20))
    assert about_casimirs(prove_claims(spins(*["so(3)"] * 20))) == [
        *(f"{square} is a Casimir" for square in squares),
        f"every Casimir is a function of the 20 known, {ALMOST}",
    ]


def test_summands_are_searched_apart_and_what_is_missing_is_told_of_each():
    """g(3) has a Casimir of degree 4: to degree 3 both copies miss theirs, so(3) misses none."""
    found = completeness(derive(spins("g(3)", "so(3)", "g(3)")), degree=3)
    assert (found.known, found.expected) == (3, 5)
    assert found.missing == (
        "of each of 2 direct summands such as (mu1, mu2, mu3, ...) 1 not found among all "
        "polynomials of degree <= 3"
    )
    assert found.statement.endswith(
        "; every polynomial Casimir of degree <= 3 is a function of the 3 known"
    )


def test_a_parameter_hides_the_casimir_of_its_own_summand_alone():
    """A spiral beside a free spin: the spin's square is found."""
    text = (
        SPIRAL.replace("{a}", "a")
        .replace('"e3"]', '"e3", "s1", "s2", "s3"]')
        .replace(
            "[variables]", '"[s1, s2]" = "s3"\n"[s2, s3]" = "s1"\n"[s3, s1]" = "s2"\n[variables]'
        )
    )
    found = completeness(derive(spec(text)))
    assert (found.known, found.expected) == (1, 2)
    start = "of the direct summand (mu1, mu2, mu3) 1 not found among polynomials of degree"
    assert found.missing.startswith(start)


def test_a_claim_that_no_search_finds_completes_its_own_summand():
    """Of two g(3) the quartic Casimir of one is claimed: one is missing, that of the other."""
    whole = completeness(derive(spins("g(3)", "g(3)")), degree=4)
    quartic = str(whole.found[1])
    text = SPINS.replace("SUMMANDS", '"g(3)", "g(3)"')
    claimed = f'[claims]\ncasimirs = ["{quartic.replace("**", "^")}"]\n'
    found = completeness(derive(spec(text + claimed)), degree=3)
    assert (found.known, found.expected) == (3, 4)
    assert found.missing.startswith("of the direct summand (mu11, mu12, mu13, ...) 1 not found")


# -- parts ----------------------------------------------------------------------------------------


def test_independence_is_of_gradients():
    """x, y and x y: the third depends on the first two; constants have no gradient."""
    setting = make_setting(spec())
    structure = bracket_of(derive(spec(), setting=setting))
    x, y = setting.field["Pi1"], setting.field["Pi2"]
    assert select_independent(structure, [setting.field.one, x, y, x * y]) == [x, y]
    assert select_independent(structure, [x * y, x, y**2]) == [x * y, x]


def test_a_long_casimir_is_described_by_its_size():
    """A statement stays readable: the number of terms and the first one."""
    field = make_setting(shipped("so8_body")).field
    whole = sum((field[name] for name in field.names[:28]), field.zero) ** 2
    text = describe(field, whole)
    assert text == f"a function with {28 * 29 // 2} terms that begins with M12^2"
    assert describe(field, field["M12"]) == "M12"


@pytest.mark.parametrize(
    ("function", "where"),
    [("exp(x)", ALMOST), ("log(x)", IN_PART), ("sqrt(3)*x", IN_PART), ("sqrt(x^2 + 7)", IN_PART)],
)
def test_ranks_with_functions_are_proved_by_bounds(function, where):
    """A mass that is a function of the place leaves the plane of x and p without a Casimir."""
    text = f"""
title = "a mass that depends on the place"
routes = ["euler-lagrange"]
[variables]
x = {{ role = "coordinate" }}
v = {{ role = "velocity", of = "x" }}
[lagrangian]
l = "{function}*v^2/2"
"""
    claims = {claim.statement: claim for claim in prove_claims(spec(text)).claims}
    none = claims[f"there are no Casimirs but constants, {where}"]
    assert none.verdict.value == "proved"


@pytest.mark.parametrize("entry", ["log(x - 2)", "sqrt(x - 2)*sqrt(3)", "log(x - 2)*exp(-x)"])
def test_ranks_are_taken_inside_the_domain(entry):
    """{x, y} = log(x - 2) with x > 3 is defined far from the numbers near 1, and has rank two."""
    text = f"""
title = "a bracket that is defined beyond a wall"
routes = ["poisson"]
[poisson.brackets]
"{{x, y}}" = "{entry}"
[variables]
x = {{ role = "coordinate", default = 4 }}
y = {{ role = "coordinate" }}
[domain]
beyond = "x > 3"
[hamiltonian]
h = "x + y"
"""
    certificate = prove_claims(spec(text))
    start = "there are no Casimirs but constants"
    (none,) = (claim for claim in certificate.claims if claim.statement.startswith(start))
    assert none.verdict.value == "proved"
    assert none.method.endswith("at a real point, with bounds that exclude zero")
