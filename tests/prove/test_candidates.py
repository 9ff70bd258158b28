"""All integrals up to a degree: what books know is found, and that there is no more is proved."""

from fractions import Fraction

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.candidates import (
    CandidateSearch,
    about_candidates,
    default_numbers,
    known_integrals,
)
from coadjoint.prove.samples import AtNumbers, Samples
from coadjoint.prove.zero import decide_zero
from tests.prove.rolling import motion

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


def about(name, *changes):
    """Statements and verdicts on the integrals of a system."""
    along = motion(name, *changes)
    names = dict(along.equations.exact.observables)
    return [
        (statement, examine().verdict)
        for statement, _, examine in about_candidates(along, known_integrals(along, names))
    ]


def dimension(name, *changes):
    """How many independent integrals, constants included, have the degrees (2, 2) at the most."""
    return len(CandidateSearch(motion(name, *changes)).found((2, 2)))


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
    ((statement, verdict),) = about("chaplygin_ball")
    assert verdict is Verdict.PROVED
    assert "dimension 2 with constants, all functions of energy, dot(Gamma, Gamma)" in statement
    assert "<= 2 in the velocities and <= 2 in the positions, where dot(Gamma, Gamma) = 1" in (
        statement
    )


def test_integrals_that_no_spec_claims_are_found_and_proved():
    """Of the ball, M.Gamma = I Omega . Gamma, written out with I = (1, 2, 3); and one with M.M."""
    first, second, last = about("chaplygin_ball_centred", SILENT["chaplygin_ball_centred"])
    assert {verdict for _, verdict in (first, second, last)} == {Verdict.PROVED}
    statement = "Omega1*Gamma1 + 2*Omega2*Gamma2 + 3*Omega3*Gamma3 is conserved"
    assert first[0] == f"{statement} at the default parameters"
    assert last[0].endswith("all functions of energy, those found")


def test_jellett_and_routh_are_found():
    """Routh's sphere with no integral claimed: the one found first is I1 (Omega . s) + ..."""
    along = motion("routh_sphere", SILENT["routh_sphere"])
    names = dict(along.equations.exact.observables)
    values = default_numbers(along.equations.spec)
    search = CandidateSearch(along, known_integrals(along, names), values)
    found = list(search.new((2, 2)))
    assert len(found) == 2
    ring, (i1, i3, length) = along.field, (Fraction(2, 5), Fraction(1, 2), Fraction(-3, 10))
    o, g = ([ring[f"{name}{n}"] for n in (1, 2, 3)] for name in ("Omega", "Gamma"))
    jellett = (o[0] * g[0] + o[1] * g[1]) * i1 + o[2] * (g[2] + length) * i3
    slope = ring.derivative(ring.derivative(found[0], "Omega1"), "Gamma1")
    assert ring.is_zero(found[0] * i1 - jellett * slope)


@pytest.mark.parametrize(("name", "count"), [("veselova", 1), ("rolling_disk_vertical", 2)])
def test_what_is_found_completes_what_is_known(name, count):
    """With the integral that a spec leaves out found, all are functions of known ones."""
    *found, (last, verdict) = about(name, SILENT[name])
    assert len(found) == count
    assert {verdict for _, verdict in found} == {Verdict.PROVED}
    assert verdict is Verdict.PROVED
    assert "all functions of energy" in last
    assert last.endswith("those found")


def test_a_wrong_integral_is_refuted():
    """One coefficient off, and the proof at numbers shows where it fails."""
    along = motion("chaplygin_ball_centred")
    numeric = AtNumbers(along, default_numbers(along.equations.spec))
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
    assert len(search.found((2, 2))) == 1
    names = {"energy": along.equations.exact.energy}
    assert [each.text for each in known_integrals(along, names)] == ["dot(Gamma, Gamma)"]


def test_related_functions_are_not_searched():
    """Sines of phi and of 2*phi are related; the certificate says that nothing was looked for."""
    change = ("vx == r*cos(phi)*vtheta", "vx == r*cos(2*phi)*vtheta")
    ((statement, verdict),) = about("rolling_disk_vertical", change)
    assert verdict is Verdict.SUPPORTED
    assert "were not looked for: functions of 2 arguments occur" in statement
