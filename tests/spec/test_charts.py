"""The table [charts]: what is missing, too much or of another shape is shown at its place."""

import pytest

from coadjoint.errors import SpecError
from tests.constrained import SUSLOV
from tests.specs import spec

CHART = """
title = "x"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [2] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2 + dot(q, q)/2"
[charts.other]
variables = { A = [2], B = [2] }
map = { q = "A", p = "B" }
rates = { A = "B", B = "-A" }
"""
RATES = 'rates = { A = "B", B = "-A" }'


def test_a_chart_is_read_with_its_shapes():
    """Variables have components, and formulas the shapes of what they stand for."""
    (chart,) = spec(CHART).records["charts"]
    assert [v.components for v in chart.variables] == [("A1", "A2"), ("B1", "B2")]
    assert (chart.kind, list(chart.map), list(chart.motion)) == ("rates", ["q", "p"], ["A", "B"])
    assert chart.map["q"].shape == (2,)


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        ((RATES, ""), "charts.other", "exactly one of"),
        ((RATES, RATES + '\nhamiltonian = "dot(A, B)"'), "charts.other", "exactly one of"),
        ((RATES, RATES + '\npairs = [["A", "B"]]'), "charts.other.pairs", "Remove pairs"),
        ((', B = "-A"', ""), "charts.other.rates", "B is missing"),
        ((', p = "B"', ""), "charts.other.map", "p is missing"),
        (('q = "A"', 'x = "A"'), "charts.other.map.x", "there is no variable"),
        (('B = "-A"', 'B = "-A1"'), "charts.other.rates.B", "expected a 2-vector"),
        (('B = "-A"', 'B = "-q"'), "charts.other.rates.B", "a coordinate"),
        ((RATES, 'hamiltonian = "dot(A, B)"'), "charts.other", "is missing"),
        (
            (RATES, 'hamiltonian = "dot(A, B)"\npairs = [["A", "A"]]'),
            "charts.other.pairs",
            "in one pair",
        ),
        (
            (RATES, 'hamiltonian = "dot(A, B)"\npairs = [["A", "C"]]'),
            "charts.other.pairs",
            "in one pair",
        ),
        (("A = [2]", "A = [0]"), "charts.other.variables.A[1]", "greater than or equal to 1"),
    ],
)
def test_a_fault_of_a_chart_is_shown_at_its_place(change, key, said):
    """The key, and what was expected."""
    with pytest.raises(SpecError) as caught:
        spec(CHART, change)
    assert caught.value.key == key
    assert said in str(caught.value)


def test_a_chart_gives_what_constraints_leave():
    """The velocity that the wheel keeps at 0 is no part of the state."""
    chart = '[charts.c]\nvariables = { A = [2] }\nmap = { turn = "A" }\nrates = { A = "A" }\n'
    assert [*spec(SUSLOV + chart).records["charts"][0].map] == ["turn"]
    with pytest.raises(SpecError, match="there is no variable 'spin'"):
        spec(SUSLOV + chart.replace('turn = "A"', 'turn = "A", spin = "0"'))


def test_names_of_a_chart_are_its_own():
    """A variable of the state cannot be one of a chart, too."""
    with pytest.raises(SpecError, match="'q' is doubled") as caught:
        spec(CHART.replace("A", "q"))
    assert caught.value.key == "charts.other.variables.q"
