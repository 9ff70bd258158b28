"""Certificates: what holds is proved, what does not is refuted with a point, every time."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import derive, make_setting
from coadjoint.errors import ClaimError
from coadjoint.exact import Field
from coadjoint.poisson.jacobi import schouten_bracket, slopes_by
from coadjoint.prove import Verdict, prove
from coadjoint.prove.identities import antisymmetry_defects, casimir_defects
from coadjoint.prove.zero import decide_zero
from tests.specs import RIGID_BODY, emitted, prove_claims, shipped, spec


def check_claims(system, claims):
    """No claim is refuted, none rests on numbers alone, and no Casimir is missing.

    Args:
        system: A shipped system.
        claims: Kind, statement and verdict of each claim.
    """
    declared = shipped(system)
    assert {verdict for _, _, verdict in claims} == {Verdict.PROVED}
    assert len(claims) >= 7
    kinds = {kind for kind, _, _ in claims}
    bound = emitted(system).distribution is not None  # the kernel solves for accelerations
    bracketed = emitted(system).exact.poisson_tensor is not None and not bound
    expected = {"conserved"} | ({"jacobi", "casimir"} if bracketed else set())
    expected |= {"equivalence"} if len(declared.routes) > 1 or not bound else set()
    expected |= {"reduction"} if declared.reduction else set()
    expected |= {"algebra"} if declared.algebra else set()
    expected |= {"legendre"} if declared.lagrangian and not bound else set()
    expected |= {"constraint"} if bound or declared.variational else set()
    expected |= {"lax"} if declared.lax or "manakov" in declared.routes else set()
    expected |= {"symmetry"} if declared.symmetries else set()
    expected |= {"transformation"} if declared.transformations else set()
    expected |= {"bracket"} if declared.brackets else set()
    expected |= {"galilean"} if declared.galilean else set()
    expected |= {"dissipation"} if declared.relaxation else set()
    expected |= {"noise"} if declared.noise else set()
    expected |= {"attitude"} if declared.turning else set()
    found = {"transformation", "integrals", "measure", "symmetry"}  # also without being claimed
    if not bound:
        assert kinds - found == expected - found
    assert kinds >= expected
    for counted in [statement for kind, statement, _ in claims if kind == "casimir"][-1:]:
        assert counted.startswith(("every Casimir is a function of the", "there are no Casimirs"))
    equalities = [statement for _, statement, _ in claims if "give the same motion" in statement]
    assert len(equalities) == len(declared.routes) - 1 + len(declared.records.get("charts", ()))


@pytest.mark.campaign
def test_every_claim_of_a_shipped_system_is_proved(system):
    """In this process; `tests.test_regenerate` proves them all in every run, too."""
    claims = prove(shipped(system)).claims
    check_claims(system, [(claim.kind, claim.statement, claim.verdict) for claim in claims])


@pytest.mark.parametrize(
    ("claim", "kind"),
    [
        ('casimirs = ["dot(Pi, Pi) + Pi1"]', "casimir"),
        ('conserved = ["Pi1"]', "conserved"),
        ('conserved = ["energy + Omega1"]', "conserved"),
        ('conserved = ["sin(Pi3)"]', "conserved"),
    ],
)
def test_a_false_claim_is_refuted_with_its_point(claim, kind):
    """The counterexample is a point of the state, and the value there is not zero."""
    certificate = prove_claims(spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', claim)))
    (refuted,) = certificate.refuted
    assert refuted.kind == kind
    assert refuted.counterexample
    assert refuted.defect not in ("", "0")
    with pytest.raises(ClaimError, match=r"refuted: .* At .*Pi") as caught:
        certificate.require()
    assert caught.value.exit_status == 1


def test_the_counterexample_is_one():
    """Substituting the printed point into the derivative gives the printed value."""
    sample = spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', 'conserved = ["Pi1"]'))
    (refuted,) = prove_claims(sample).refuted
    point = {sympy.Symbol(n): sympy.Rational(v) for n, v in refuted.counterexample.items()}
    assert derive(sample).rates[0].subs(point) == sympy.Rational(refuted.defect)


def test_a_wrong_hamiltonian_is_refuted_on_three_grounds():
    """A Hamiltonian that is not the Legendre transform is told apart from the Lagrangian's."""
    wrong = '[hamiltonian]\nh = "dot(Pi, diag(I)*Pi)/2"\n\n[claims]'
    certificate = prove_claims(spec(RIGID_BODY, ("[claims]", wrong)))
    statements = [claim.statement for claim in certificate.refuted]
    assert any("h(dl/dxi)" in s and "lie-poisson" in s for s in statements)
    assert any("dh/dmu = xi" in s and "lie-poisson" in s for s in statements)
    assert any("give the same motion" in s for s in statements)


def test_energy_with_the_wrong_sign_of_gravity_is_refuted():
    """The sign of gravity: with -m g Gamma.chi in both h and l, the routes differ."""
    heavy = shipped("heavy_top")
    text = heavy.path.read_text(encoding="utf-8")
    good = "+ m*g*dot(Gamma, chi)"
    assert good in text
    assert prove_claims(spec(text, (good, "- m*g*dot(Gamma, chi)"))).refuted


def test_jacobi_of_a_tensor_can_fail():
    """The so(3) tensor passes; with one entry squared it does not."""
    field = Field(["x", "y", "z"])
    x, y, z = (field[n] for n in field.names)
    tensor = [[field.zero, -z, y], [z, field.zero, -x], [-y, x, field.zero]]
    slopes = slopes_by(field, field.names)
    # In three dimensions a Poisson tensor times any function is one; without it all terms of the
    # sum would be zero one by one.
    dense = [[(x + 2 * y) * entry for entry in row] for row in tensor]
    defects = list(schouten_bracket(dense, slopes).values())
    assert len(defects) == 1
    assert decide_zero(defects, field).verdict == "proved"
    spoiled = [list(row) for row in tensor]
    spoiled[0][1], spoiled[1][0] = -z + y, z - y
    spoiled[0][2], spoiled[2][0] = y * x, -y * x
    defects = list(schouten_bracket(spoiled, slopes).values())
    assert decide_zero(defects, field).verdict == "refuted"


def test_antisymmetry_can_fail():
    """A symmetric entry is seen."""
    field = Field(["x"])
    tensor = [[field.zero, field["x"]], [field["x"], field.zero]]
    assert decide_zero(antisymmetry_defects(tensor), field).verdict == "refuted"


def test_positive_parameters_stay_positive_in_counterexamples():
    """The printed point respects the declared signs."""
    certificate = prove_claims(
        spec(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', 'conserved = ["Pi1"]'))
    )
    (refuted,) = certificate.refuted
    inertia = [v for n, v in refuted.counterexample.items() if n.startswith("I")]
    assert inertia
    assert all(Fraction(v) > 0 for v in inertia)


def test_hidden_zeros_are_supported_numerically_and_say_so():
    """The square of sqrt(x^2 + 1) + sqrt(y^2 + 2) has a root that no relation here knows."""
    field = Field(["x", "y"], slots=4)
    x, y = field["x"], field["y"]
    a, b = field.call("sqrt", x**2 + 1), field.call("sqrt", y**2 + 2)
    whole = field.call("sqrt", x**2 + y**2 + 3 + 2 * field.call("sqrt", (x**2 + 1) * (y**2 + 2)))
    decision = decide_zero([whole - a - b], field)
    assert decision.verdict is Verdict.SUPPORTED
    assert "50-digit" in decision.method


@pytest.mark.parametrize(
    ("claimed", "holds"),
    [
        ("(1 + sqrt(2))*q^4 + (sqrt(5) + 1)*q^2/8", True),
        ("(1 - sqrt(2))*q^4 + (sqrt(5) + 1)*q^2/8", False),
        ("(1 + sqrt(2))*q^4 + (sqrt(5) - 1)*q^2/8", False),
    ],
)
def test_roots_and_cosines_of_numbers_are_related_in_formulas(claimed, holds):
    """``sqrt(3 + 2 sqrt(2)) = 1 + sqrt(2)`` and ``4 cos(pi/5) = sqrt(5) + 1``; no other sign."""
    text = f"""
title = "Oscillator"
source = "exercise"
routes = ["canonical"]
[variables]
q = {{ role = "coordinate" }}
p = {{ role = "momentum", of = "q" }}
[hamiltonian]
h = "p^2/2 + sqrt(3 + 2*sqrt(2))*q^4 + cos(pi/5)*q^2/2"
[claims]
conserved = ["p^2/2 + {claimed}"]
"""
    certificate = prove_claims(spec(text))
    assert next(c.verdict for c in certificate.claims if claimed in c.statement) is (
        Verdict.PROVED if holds else Verdict.REFUTED
    )


def test_casimirs_are_judged_by_the_bracket_alone():
    """The energy is conserved, but it is no Casimir."""
    setting = make_setting(spec())
    equations = derive(spec(), setting=setting)
    decision = decide_zero(casimir_defects(equations, equations.exact.energy), setting.field)
    assert decision.verdict is Verdict.REFUTED


def test_a_certificate_reads_as_a_table():
    """The text shows verdict, statement and method of each claim."""
    shown = str(prove_claims(spec()))
    assert shown.startswith("Certificate of sample")
    assert "dot(Pi, Pi) is a Casimir" in shown
    assert " ms)" in shown


def test_times_are_not_stored():
    """A certificate's record is the same in every run."""
    first, second = prove_claims(spec()).as_record(), prove_claims(spec()).as_record()
    assert first == second
    assert "seconds" not in str(first)
