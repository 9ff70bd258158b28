"""The domain: a row for each condition and each pivot, lowered exactly, and texts kept apart."""

import dataclasses
import json

import pytest

from coadjoint.derive import derive
from coadjoint.derive.domain import bounds, region
from coadjoint.errors import CrossCheckError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Negate
from coadjoint.pipeline import render
from tests.solve.domains import KEPLER, STONE, SUSLOV
from tests.specs import emitted, spec


def test_conditions_are_what_is_to_be_positive():
    """Left minus right for > and >=, right minus left for < and <=, strict without =."""
    text = STONE.replace('above = "h > 0"', 'a = "h > v"\nb = "h >= v"\nc = "h < v"\nd = "h <= v"')
    equations = derive(spec(text))
    field = equations.setting.field
    difference = field["h"] - field["v"]
    found = {bound.name: (value, bound.strict) for bound, value in bounds(equations)}
    assert found.pop("heavy")[1] is False
    signs = {"a": (1, True), "b": (1, False), "c": (-1, True), "d": (-1, False)}
    assert found == {name: (difference * sign, strict) for name, (sign, strict) in signs.items()}


def test_a_condition_of_the_field_is_no_bound_besides():
    """Claims are looked at where conditions and bounds hold; no inequality stands in both."""
    found = region(derive(spec(STONE)))
    assert [each.strict for each in found.conditions] == [True, False]
    assert found.bounds == ()
    pivots = region(derive(spec(SUSLOV))).bounds
    assert len(pivots) == 4
    assert all(each.strict for each in pivots)


def test_a_bound_names_what_it_depends_on():
    """Through definitions: the velocity v = p/m depends on p and m."""
    ((bound, _), _) = bounds(derive(spec(STONE, ('"h > 0"', '"v < 3"'))))
    assert bound.inputs == ("p", "m")
    assert bounds(derive(spec(KEPLER)))[0][0].inputs == ("r", "closest")


def test_pivots_are_there_for_constrained_motions_alone():
    """Two coupled bodies are free, and their kinetic energy may have any sign."""
    assert bounds(emitted("coupled_bodies")) == ()
    labels = [bound.label for bound, _ in bounds(derive(spec(SUSLOV)))]
    assert labels == [f"pivot of {n}" for n in ("dOmega1_dt", "dOmega2_dt", "dOmega3_dt")] + [
        "pivot of wheels_reaction"
    ]


@pytest.mark.parametrize("text", [STONE, SUSLOV], ids=["conditions", "pivots"])
def test_lowering_a_domain_is_undone_exactly(text):
    """The Program gives the rows back, and one row of the wrong sign is seen."""
    equations = derive(spec(text))
    program = lower(equations)["domain"]
    check_inverse(equations, program)
    *others, last = program.outputs
    turned = dataclasses.replace(last, value=Negate(last.value))
    spoiled = dataclasses.replace(program, outputs=(*others, turned))
    with pytest.raises(CrossCheckError, match="lowering changed domain") as caught:
        check_inverse(equations, spoiled)
    assert caught.value.output == last.label


def test_generated_code_has_the_name_of_a_condition_and_not_its_text():
    """The text stands in the certificate, where messages look it up."""
    texts = render(spec(KEPLER, ("r > closest", "closest+0  <  r"))).texts
    assert json.loads(texts["certificate.json"])["domain"] == {"apart": "closest+0 < r"}
    for name in ("kernel.py", "__init__.py", "kernel.c", "kernel.h", "kernel_python.py"):
        assert "closest+0" not in texts[name]
    assert (
        'Bound("apart", "condition", strict=True, inputs=("r", "closest")),' in texts["__init__.py"]
    )
    assert "sample_domain(" in texts["kernel.h"]
    assert "domain" not in json.loads(render(spec()).texts["certificate.json"])
    assert "DOMAIN" not in render(spec()).texts["__init__.py"]
