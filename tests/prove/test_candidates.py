"""All integrals up to a degree: what books know is found, and that there is no more is proved."""

from fractions import Fraction

import pytest

from coadjoint.exact.linear import PRIME
from coadjoint.prove import Verdict, candidates, prove
from coadjoint.prove.candidates import (
    CandidateSearch,
    Known,
    about_candidates,
    default_numbers,
    known_integrals,
)
from coadjoint.prove.samples import Samples
from coadjoint.prove.zero import Discovery, decide_zero
from tests.prove.rolling import motion
from tests.specs import spec

#: Specs that claim the energy alone.
SILENT = {
    "chaplygin_ball_centred": (
        '"energy", "dot(Gamma, Gamma)", "vertical", "dot(M, M)"',
        '"energy"',
    ),
    "routh_sphere": (', "jellett", "routh"', ""),
    "veselova": (', "dot(K, K)"', ""),
    "rolling_disk_vertical": (
        ', "vphi*x - r*vtheta*sin(phi)", "vphi*y + r*vtheta*cos(phi)"',
        "",
    ),
}
#: One more parameter.
SLOPE = ("[parameters]", '[parameters]\nalpha = { default = 1, unit = "1", doc = "a number" }')


def about(name, *changes):
    """Statements on the integrals of a system, and how they were decided or found."""
    along = motion(name, *changes)
    return [(statement, examine()) for statement, _, examine in about_candidates(along)]


def dimension(name, *changes):
    """How many independent integrals, constants included, have the degrees (2, 2) at the most."""
    return len(CandidateSearch(motion(name, *changes)).find((2, 2)))


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        ("chaplygin_ball", None, 2),  # 1, E
        ("chaplygin_ball_centred", None, 5),  # 1, E, M.M, M.Gamma and its square
        ("routh_sphere", None, 5),  # 1, E, Jellett's and its square, Routh's
        ("routh_sphere", ("I1*(Omega1^2 + Omega2^2)", "(I1*Omega1^2 + 2*I1*Omega2^2)"), 2),
        ("veselova", None, 3),  # 1, E, K.K
        ("suslov", None, 2),  # 1, E
        ("chaplygin_sleigh", None, 2),  # 1, E
    ],
)
def test_there_are_as_many_integrals_as_books_know(name, change, expected):
    """Chaplygin 1903, Routh 1884, Veselov and Veselova 1986; the ball off centre has E alone."""
    assert dimension(name, *([change] if change else [])) == expected


def test_the_ball_off_centre_is_proved_to_have_the_energy_alone():
    """Nothing of degree (2, 2) is an integral of the generic ball but functions of E."""
    ((statement, decision),) = about("chaplygin_ball")
    assert decision.verdict is Verdict.PROVED
    assert statement == (
        "integrals of degree <= 2 in Omega and <= 2 in Gamma, where dot(Gamma, Gamma) = 1, for "
        "almost all parameters: a space of dimension 2 with constants, all polynomials in energy"
    )


def only_energy(motion):
    """Of what is known the energy alone, so that the momenta of declared sections are found."""
    return [each for each in known_integrals(motion) if each.text == "energy"]


def test_integrals_that_no_spec_claims_are_found_and_proved(monkeypatch):
    """Of the ball, M.Gamma = I Omega . Gamma, written out with I = (1, 2, 3); and one with M.M."""
    monkeypatch.setattr(candidates, "known_integrals", only_energy)
    first, second, last = about("chaplygin_ball_centred", SILENT["chaplygin_ball_centred"])
    assert {decision.verdict for _, decision in (first, second, last)} == {Verdict.PROVED}
    statement = "Omega1*Gamma1 + 2*Omega2*Gamma2 + 3*Omega3*Gamma3 is conserved"
    assert first[0] == f"{statement} at the default parameters"
    assert last[0].endswith(
        "at the default parameters: a space of dimension 5 with constants, all polynomials in "
        "energy, those found"
    )


def test_jellett_and_routh_are_found():
    """Routh's sphere with no integral claimed: the one found first is I1 (Omega . s) + ..."""
    along = motion("routh_sphere", SILENT["routh_sphere"])
    values = default_numbers(along.equations.spec)
    search = CandidateSearch(along, only_energy(along), values)
    found = list(search.find_new((2, 2)))
    assert len(found) == 2
    ring, (i1, i3, length) = along.field, (Fraction(2, 5), Fraction(1, 2), Fraction(-3, 10))
    o, g = ([ring[f"{name}{n}"] for n in (1, 2, 3)] for name in ("Omega", "Gamma"))
    jellett = (o[0] * g[0] + o[1] * g[1]) * i1 + o[2] * (g[2] + length) * i3
    slope = ring.derivative(ring.derivative(found[0], "Omega1"), "Gamma1")
    assert ring.is_zero(found[0] * i1 - jellett * slope)


def test_what_is_found_completes_what_is_known():
    """With the integral of Veselova's top that the spec leaves out found, there are no others."""
    (_, found), (last, decision) = about("veselova", SILENT["veselova"])
    assert found.verdict is decision.verdict is Verdict.PROVED
    assert last.endswith("dimension 3 with constants, all polynomials in energy, those found")


def test_a_count_without_a_proof_is_a_finding_that_says_what_is_certain():
    """(g^2 + h^2 - r^2 vtheta^2)/vphi and vtheta times that are no polynomials in the known ones.

    Here g and h are vphi times the coordinates of the centre; the quotient is a polynomial, so
    that there are 17 integrals and 15 polynomials in vtheta, vphi, g and h.
    """
    ((statement, found),) = about("rolling_disk_vertical")
    assert isinstance(found, Discovery)
    assert "in vtheta, vphi and <= 2 in theta, x, y, cos(phi), sin(phi)" in statement
    assert "a space of dimension 17 with constants at the most, 15 of it polynomials" in statement
    assert "all are functions of energy, vtheta, vphi" in statement
    assert found.error == (
        "the bound, and that there are so many polynomials, are exact; for the rest an error has a "
        "probability below 1e-9"
    )


#: A slope, a surd and a prime in the place of the radius: the motion is that of another radius.
RADII = ["r*cos(alpha)", "r*sqrt(3)", "r*sqrt(alpha)", f"{PRIME}*r", "r*exp(alpha)*exp(-alpha)"]


@pytest.mark.parametrize("radius", RADII)
def test_the_count_does_not_depend_on_how_a_constant_is_written(radius):
    """Functions of parameters do not move, every surd has a prime, and a prime is a number."""
    changes = [(f"r*{f}(phi)*vtheta", f"{radius}*{f}(phi)*vtheta") for f in ("cos", "sin")]
    claims = SILENT["rolling_disk_vertical"]
    search = CandidateSearch(motion("rolling_disk_vertical", *changes, claims, SLOPE))
    assert search.samples.obstacle == ""
    assert len(search.find((2, 2))) == 17
    assert search.is_bounded((2, 2))


def test_constraints_with_a_common_factor_bound_too():
    """The snakeboard's constraints say that 2 cos(phi) v2 = 0, so that v2 = 0 is a relation."""
    search = CandidateSearch(motion("snakeboard"))
    assert search.is_bounded((1, 1))
    zero = search.field["v2"]
    search._relations = [each for each in search._relations if each != search._terms(zero)]
    assert not search.is_bounded((1, 1))


def test_a_bound_needs_every_relation():
    """Without dot(Gamma, Gamma) = 1 among the relations the monomials might be independent."""
    search = CandidateSearch(motion("chaplygin_ball"))
    assert search.is_bounded((2, 2))
    search._relations = []
    assert not search.is_bounded((2, 2))


def test_nothing_is_proved_without_a_bound_from_above(monkeypatch):
    """Both integrals of the sleigh are certain; that there are no others is not, if b is not."""
    monkeypatch.setattr(CandidateSearch, "is_bounded", lambda *_: False)
    ((statement, found),) = about("chaplygin_sleigh")
    assert isinstance(found, Discovery)
    assert "a space of dimension 2 with constants, 2 of it polynomials in energy" in statement
    assert found.error.startswith("that there are so many polynomials is exact; for the rest")


def test_what_is_not_conserved_is_no_bound():
    """Of the energy and a false integral, which is wrongly called known, only the first counts."""
    along = motion("chaplygin_ball_centred")
    energy, wrong = along.equations.exact.energy, along.field["Omega1"]
    known = [Known("energy", (along.close(energy),)), Known("false", (wrong,))]
    assert CandidateSearch(along, known).polynomials((2, 2)) == (2, ["energy"])
    assert CandidateSearch(along, known[1:]).polynomials((2, 2)) == (1, [])


def test_a_wrong_integral_is_refuted():
    """One coefficient off, and the proof at numbers shows where it fails."""
    along = motion("chaplygin_ball_centred")
    numeric = along.at(default_numbers(along.equations.spec))
    ring, where = along.field, Samples(along).where
    parts = [ring[f"Omega{n}"] * ring[f"Gamma{n}"] for n in (1, 2, 3)]
    right = parts[0] + 2 * parts[1] + 3 * parts[2]
    assert decide_zero([numeric.rate(right)], ring, where).verdict is Verdict.PROVED
    decision = decide_zero([numeric.rate(right + parts[2])], ring, where)
    assert decision.verdict is Verdict.REFUTED
    assert decision.point.keys() >= {"Omega1", "Gamma2"}


def test_friction_leaves_constants_alone():
    """A ball with resistance has no reverse, no parity to search by, and keeps no energy."""
    change = ("[lagrangian]", '[forces]\nOmega = "-k*Omega"\n\n[lagrangian]')
    given = ("[parameters.m]", "[parameters.k]\ndefault = 1\n\n[parameters.m]")
    along = motion("chaplygin_ball", change, given)
    search = CandidateSearch(along)
    assert not search.reversible
    assert len(search.sectors((2, 2))) == 1
    assert len(search.find((2, 2))) == 1
    assert [each.text for each in known_integrals(along)] == ["dot(Gamma, Gamma)"]


def test_multiples_of_angles_are_searched():
    """Where cos(2 phi) and sin(phi) occur, vphi is left of four, and the energy stays as it is."""
    change = ("vx == r*cos(phi)*vtheta", "vx == r*cos(2*phi)*vtheta")
    along = motion("rolling_disk_vertical", change)
    known = known_integrals(along)
    assert [each.text for each in known] == ["energy", "vphi"]
    assert len(CandidateSearch(along, known).find((1, 1))) == 2


def test_functions_that_may_be_related_are_not_searched():
    """Of exp(sin(phi)) no theorem says that it is free; nothing is looked for, and that is said."""
    change = ("vx == r*cos(phi)*vtheta", "vx == r*exp(sin(phi))*vtheta")
    ((statement, found),) = about("rolling_disk_vertical", change)
    assert found == Discovery("no search")
    assert "were not searched for: exp is taken of functions" in statement


#: Two wheels and a belt that slides where a is 0: u = v, and with d = x - y and E = 3 u^2/2 + k x
#: the integrals of degree (2, 2) are 1, d, d^2, E and E d.
BELT = """
title = "Two wheels and a belt"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
u = { role = "velocity", of = "x" }
y = { role = "coordinate" }
v = { role = "velocity", of = "y" }
[parameters]
R = { positive = true, default = 2 }
a = { default = 0 }
k = { positive = true, default = 1 }
[lagrangian]
l = "u^2/2 + v^2 - k*x"
[constraints]
belt = "a*u == a*v"
"""


def test_a_count_says_how_many_integrals_the_others_are_functions_of():
    """No constraint is left at a = 0, the default, so that d is not found; d is not made of E."""
    certificate = prove(spec(BELT))
    (found,) = [each for each in certificate.findings if each.kind == "integrals"]
    assert "a space of dimension 5 with constants at the most, 2 of it polynomials in energy" in (
        found.statement
    )
    assert found.statement.endswith("; all are functions of energy and of 1 more of them")


@pytest.mark.parametrize("turned", [False, True])
def test_a_solved_constraint_may_have_a_pole_at_the_defaults(turned):
    """R u = a v gives v = R u/a, or u = a v/R: either velocity may be declared first."""
    head, x, rest = BELT.partition('x = { role = "coordinate" }')
    u, y, rest = rest.partition('y = { role = "coordinate" }')
    v, parameters, rest = rest.partition("[parameters]")
    blocks = (y + v, x + u) if turned else (x + u, y + v)
    text = head + "".join(blocks) + parameters + rest
    certificate = prove(spec(text.replace("a*u == a*v", "R*u == a*v")))
    assert certificate.holds
    assert any(each.kind == "integrals" for each in (*certificate.claims, *certificate.findings))


@pytest.mark.parametrize("name", ["chaplygin_ball", "routh_sphere", "veselova"])
@pytest.mark.parametrize("degrees", [(0, 0), (1, 0), (2, 1), (3, 2)])
def test_monomials_are_counted_without_a_list(name, degrees):
    """There may be more than memory holds."""
    search = CandidateSearch(motion(name))
    assert search.count_largest(degrees) == max(map(len, search.sectors(degrees)))
