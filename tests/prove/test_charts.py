"""Charts: a motion in other variables is related to the declared one, or refuted."""

import dataclasses

import pytest

from coadjoint.derive import Chart, Equations, Exact, Relation, assembly, derive
from coadjoint.exact.ranks import CHANCE
from coadjoint.prove import Verdict
from coadjoint.prove.charts import ChartMap, reach
from tests.specs import prove_claims, shipped, spec

OWN = ("Q1", "Q2", "Q3", "P1", "P2", "P3")


def cross(a, b):
    """The vector product of elements."""
    return tuple(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3))


def pair(text_or_spec, image, spoil=lambda rates: rates):
    """The Euler-Poincare route and the motion of two vectors that turn with the body.

    Any two vectors that are constant in space obey dQ/dt = Q x Omega, and Pi = P x Q then obeys
    Euler's equations (Holm 2011, 2.5.5).
    """
    setting = assembly.make_setting(text_or_spec, OWN)
    field = setting.field
    first = derive(text_or_spec, setting=setting)
    Q, P = setting.elements(OWN[:3]), setting.elements(OWN[3:])
    Omega = setting.elements(setting.velocities)
    names = dict(zip(setting.momenta, cross(P, Q), strict=True))
    definitions = tuple((name, field.substitute(v, names)) for name, v in first.exact.definitions)
    rates = spoil((*cross(Q, Omega), *cross(P, Omega)))
    chart = Chart(OWN, image(P, Q), "Pi = P x Q")
    exact = Exact(definitions, rates, None, (), None)
    return first, Equations(setting, "by hand", exact, (), chart)


def test_two_turning_vectors_carry_the_rigid_body():
    """Pi = P x Q obeys Euler's equations, and reaches every Pi."""
    maps = ChartMap(*pair(spec(), lambda P, Q: cross(P, Q)))
    assert maps.decide_related().verdict is Verdict.PROVED
    statement, decision = reach(maps)
    assert decision.verdict is Verdict.PROVED
    assert "open set" in statement


@pytest.mark.parametrize("place", range(6))
def test_one_wrong_sign_among_the_rates_is_refuted(place):
    """A rate with the other sign is not related to the motion, and the point shows it."""
    flipped = lambda rates: tuple(-r if n == place else r for n, r in enumerate(rates))  # noqa: E731
    decision = ChartMap(*pair(spec(), lambda P, Q: cross(P, Q), flipped)).decide_related()
    assert decision.verdict is Verdict.REFUTED
    assert decision.point


def test_wrong_map_is_refuted():
    """Pi = Q x P turns the other way round."""
    decision = ChartMap(*pair(spec(), lambda P, Q: cross(Q, P))).decide_related()
    assert decision.verdict is Verdict.REFUTED


def heavy_top_by_hand(spoil=lambda rates: rates):
    """The Clebsch pair (Gamma, Xi) of the heavy top (Holm 2011, 8.4)."""
    declared = shipped("heavy_top")
    first, other = pair(declared, lambda P, Q: (*cross(P, Q), *Q))
    field, setting = first.setting.field, first.setting
    weight = field["m"] * field["g"]
    rates = list(other.exact.rates)
    for n in range(3):
        rates[3 + n] = rates[3 + n] - weight * field[f"chi{n + 1}"]
    names = dict(zip(setting.state, other.chart.state, strict=True))
    definitions = tuple((name, field.substitute(v, names)) for name, v in first.exact.definitions)
    exact = Exact(definitions, tuple(spoil(rates)), None, (), None)
    return first, dataclasses.replace(other, exact=exact)


def test_submanifold_that_a_map_reaches_is_named():
    """The Clebsch pair of the heavy top reaches Pi . Gamma = 0 alone."""
    maps = ChartMap(*heavy_top_by_hand())
    assert maps.decide_related().verdict is Verdict.PROVED
    statement, decision = reach(maps)
    assert decision.verdict is Verdict.PROVED
    assert "dimension 5 of 6: dot(Pi, Gamma) = 0" in statement


def test_submanifold_is_found_without_a_claim():
    """Where the spec names no Casimir, the relation is found among quadratic polynomials."""
    first, other = heavy_top_by_hand()
    bare = dataclasses.replace(first.setting.spec, casimirs=())
    setting = dataclasses.replace(first.setting, spec=bare)
    maps = ChartMap(dataclasses.replace(first, setting=setting), other)
    (relation,) = maps.image_relations
    assert relation.text == "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3"


def test_relations_too_few_for_what_is_missing_prove_no_dimension():
    """Pi = (t^2, t^3, t^2) has Pi1 = Pi3, and its cubic relation is beyond what is looked for."""
    first, other = pair(spec(), lambda P, Q: (Q[0] ** 2, Q[0] ** 3, Q[0] ** 2))
    statement, found = reach(ChartMap(first, other))
    assert "have dimension at least 1 of 3: " in statement
    assert statement.count(" = 0") == 1
    assert found.error == CHANCE


@pytest.mark.parametrize("number", [1, 0])
def test_a_rank_is_taken_where_the_relation_holds(number):
    """Pi = Q (Q.Q - 1) is 0 on the sphere, and off it has the rank three.

    On Q.Q = 0, which has no points but Q = 0, nothing is known of the rank.
    """
    first, other = pair(spec(), lambda P, Q: cross(P, Q))
    field = first.setting.field
    Q = first.setting.elements(OWN[:3])
    rest = field.sum(q * q for q in Q) - number
    chart = dataclasses.replace(
        other.chart, relations=(Relation("it = 0", rest),), state=tuple(q * rest for q in Q)
    )
    maps = ChartMap(first, dataclasses.replace(other, chart=chart))
    statement, found = reach(maps)
    assert maps.is_certain == bool(number)
    if number:
        assert statement.endswith("have dimension 0 of 3: Pi1 = 0, Pi2 = 0, Pi3 = 0")
        assert found.verdict is Verdict.PROVED
    else:
        assert found.error == "that the relations are no more than they seem is not proved"


def test_weight_with_the_other_sign_is_refuted():
    """A top that falls upwards is another motion."""
    wrong = lambda rates: [  # noqa: E731
        rate if n < 3 else -rate for n, rate in enumerate(rates)
    ]
    assert ChartMap(*heavy_top_by_hand(wrong)).decide_related().verdict is Verdict.REFUTED


def test_relation_that_the_motion_leaves_is_refuted():
    """Q . P = 0 is kept by two turning vectors, Q1 = P1 is not."""
    first, other = pair(spec(), lambda P, Q: cross(P, Q))
    field = first.setting.field
    Q, P = (first.setting.elements(OWN[n : n + 3]) for n in (0, 3))
    for element, verdict in (
        (field.sum(q * p for q, p in zip(Q, P, strict=True)), Verdict.PROVED),
        (Q[0] - P[0], Verdict.REFUTED),
    ):
        chart = dataclasses.replace(other.chart, relations=(Relation("it = 0", element),))
        maps = ChartMap(first, dataclasses.replace(other, chart=chart))
        assert maps.decide_kept().verdict is verdict
        assert maps.decide_related().verdict is Verdict.PROVED
        assert maps.rank == 3


def test_certificate_lists_the_chart():
    """The claims about a chart stand in the certificate, with their words."""
    declared = spec()
    certificate = prove_claims(declared, pair(declared, lambda P, Q: cross(P, Q)))
    statements = [claim.statement for claim in certificate.claims if claim.kind == "equivalence"]
    assert "euler-poincare and by hand give the same motion, through Pi = P x Q" in statements
    assert "the route by hand reaches an open set of states" in statements
    assert certificate.holds


def test_relations_are_independent_where_they_hold():
    """Gamma's pair alone gives the vehicle P = 0: dot(P, P) = 0 says it, but bounds no dimension.

    Its gradient vanishes there, so it must not stand among the four relations that are counted.
    """
    declared = dataclasses.replace(shipped("underwater_vehicle"), clebsch=None)
    claims = [
        claim for claim in prove_claims(declared).claims if "clebsch reaches" in claim.statement
    ]
    (claim,) = claims
    assert claim.verdict is Verdict.PROVED
    assert "dot(P, P) = 0" not in claim.statement
    assert claim.statement.count(" = 0") == 4
    assert "P1 = 0, P2 = 0" in claim.statement
    assert "Pi1*Gamma1 + Pi2*Gamma2 + Pi3*Gamma3 = 0" in claim.statement
