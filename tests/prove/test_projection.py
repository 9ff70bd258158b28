"""Claims about projections: proved of what is derived, refuted of what is spoiled."""

import dataclasses

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.projection import about_projection
from coadjoint.prove.zero import Decision, decide_zero
from tests.constrained import PARTICLE, PENDULUM, derived
from tests.specs import emitted

ARRIVES, LEAST, STAYS = (
    "the projection moves every state onto rod, where its equations are regular",
    "the projection changes velocities alone, and the kinetic energy of the change is "
    "stationary: the least one where kinetic energy is positive",
    "the projection leaves a state on the constraints",
)
AFFINE = ('"x*u + y*v == 0"', '"x*u + y*v == g"')


def verdicts(equations):
    """Verdict by statement."""
    found = {}
    for statement, kind, examine in about_projection(equations):
        assert kind == "constraint"
        decision = examine()
        if not isinstance(decision, Decision):
            assert len(decision) > 1, "an empty list of defects proves everything"
            decision = decide_zero(decision, equations.setting.field)
        found[statement] = decision.verdict
    return found


@pytest.mark.parametrize("changes", [(), (AFFINE,)])
@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
def test_the_three_claims_are_proved(route, changes):
    """By either road, for linear and affine constraints."""
    found = verdicts(derived(PENDULUM, *changes)[route])
    assert found == dict.fromkeys((ARRIVES, LEAST, STAYS), Verdict.PROVED)


@pytest.mark.parametrize("name", ["suslov", "veselova", "snakeboard", "knife_edge_cvt"])
def test_shipped_projections_are_proved(name):
    """Coefficients of parameters, of positions and with functions; and two constraints at once."""
    assert set(verdicts(emitted(name)).values()) == {Verdict.PROVED}


def test_nothing_is_claimed_where_nothing_is_kept():
    """Where each constraint gives a velocity there is no projection."""
    assert not list(about_projection(derived(PARTICLE)["nonholonomic"]))


def spoiled(change):
    """The pendulum with a changed projection; ``change`` takes its Exact and the field."""
    equations = dataclasses.replace(derived(PENDULUM)["nonholonomic"])
    projection = equations.projection
    exact = change(projection.exact, projection.setting.field)
    wrong = dataclasses.replace(projection, exact=exact)
    equations.__dict__["projection"] = wrong  # where the property keeps it
    return equations


def line(name, change):
    """A spoiled definition."""

    def made(exact, field):
        lines = tuple((n, change(v, field) if n == name else v) for n, v in exact.definitions)
        assert lines != exact.definitions
        return dataclasses.replace(exact, definitions=lines)

    return made


def side(change):
    """A spoiled right side, the lines of the solve as they were."""

    def made(exact, field):
        (solve,) = exact.solves
        known = [change(k, field) for k in solve.known]
        return dataclasses.replace(exact, solves=(dataclasses.replace(solve, known=known),))

    return made


def matrix(exact, _field):
    """Masses doubled in one direction: another metric."""
    (solve,) = exact.solves
    rows = [list(row) for row in solve.matrix]
    rows[0][0] = 2 * rows[0][0]
    return dataclasses.replace(exact, solves=(dataclasses.replace(solve, matrix=rows),))


def position(exact, field):
    """A projection that also moves x."""
    first, *others = exact.rates
    return dataclasses.replace(exact, rates=(first + field["_s1"], *others))


@pytest.mark.parametrize(
    ("change", "refuted"),
    [
        (line("_s1", lambda value, _: 2 * value), {ARRIVES}),
        (line("_y3", lambda value, _: -value), {ARRIVES}),
        (line("_d3", lambda value, field: value + field["m"]), {ARRIVES}),
        (side(lambda known, _: -known), {ARRIVES}),
        (side(lambda known, field: known + field["g"]), {ARRIVES, LEAST, STAYS}),
        (matrix, {ARRIVES, LEAST}),
        (position, {ARRIVES, LEAST}),
    ],
)
def test_a_spoiled_projection_is_refuted(change, refuted):
    """One wrong line, side, mass or component, and the claims it breaks say so."""
    found = verdicts(spoiled(change))
    assert {statement for statement, v in found.items() if v is Verdict.REFUTED} == refuted
    assert set(found.values()) <= {Verdict.REFUTED, Verdict.PROVED}
