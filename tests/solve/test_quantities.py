"""Quantities: rows by name, in order, and tables for people."""

import pytest

from coadjoint.declared import Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.quantities import Quantities

STATE = Quantities(
    Quantity("Pi", (2,), "kg m^2/s", ("Pi1", "Pi2")),
    Quantity("R", (2, 2), "1", ("R11", "R12", "R21", "R22")),
    Quantity("s", (), "1", ("s",), default=(0.5,)),
)


def test_rows_follow_the_order_of_declaration():
    """Whole quantities are slices, components and scalars are numbers."""
    assert STATE.components == ("Pi1", "Pi2", "R11", "R12", "R21", "R22", "s")
    assert STATE.size == 7
    assert [STATE.components[STATE.rows(name)] for name in STATE.components] == list(
        STATE.components
    )
    assert STATE.components[STATE.rows("R")] == ("R11", "R12", "R21", "R22")
    assert STATE.rows("s") == 6


def test_quantities_are_a_mapping_that_cannot_be_changed():
    """Names in order, and no assignment."""
    assert list(STATE) == ["Pi", "R", "s"]
    assert len(STATE) == 3
    assert STATE["R"].shape == (2, 2)
    assert STATE.of_component("R12") is STATE.of_component("R") is STATE["R"]
    with pytest.raises(TypeError):
        STATE["Pi"] = STATE["s"]


@pytest.mark.parametrize(("name", "near"), [("R13", "R11"), ("Pi11", "Pi1"), (3, None)])
def test_unknown_names_are_refused_with_the_nearest(name, near):
    """The name, what there is, and a suggestion where one is near."""
    with pytest.raises(KernelArgumentError, match=f"{name!r} is not one of Pi, R, s") as caught:
        STATE.rows(name)
    assert (near is None) == ("Did you mean" not in str(caught.value))
    assert near is None or f"Did you mean '{near[:1]}" in str(caught.value)


def test_the_table_has_a_line_for_each_quantity():
    """Shape, unit and default beside the name."""
    lines = repr(STATE).splitlines()
    assert len(lines) == 4
    assert lines[1].split() == ["Pi", "(2,)", "kg", "m^2/s"]
    assert lines[3].split() == ["s", "()", "1", "0.5"]
